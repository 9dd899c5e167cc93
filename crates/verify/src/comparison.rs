//! Two sections beside each other: what only one of them has, how far it reaches, and where.
//!
//! In: two sections in the same coordinates. Out: the pieces that only the first, or only the second has, each with its
//! exact area and its deviation: how far its edge comes away from the surface of the other.
//!
//! Invariant: comparing the other way round gives the same pieces with the roles changed.

use turnwright_geometry::{Bounds, Point, Segment};
use turnwright_stock::Section;

/// Pieces that are told; those of the least area are left out.
pub const PIECES_MAX: usize = 200;

/// Surfaces that lie nearer are one, mm: a nanometre, the grain of exact lengths.
pub const GRAIN_MM: f64 = 1e-6;

/// Places on an edge at which its distance is looked at.
const LOOKS: u32 = 12;

/// Material that one section has and the other has not.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its edges.
    pub edges: Vec<Segment>,
    /// The rectangle round it.
    pub bounds: Bounds,
    /// What it covers in the half-section, mm².
    pub area_mm2: f64,
    /// How far it comes away from the surface of the other section, mm.
    pub deviation_mm: f64,
    /// Where that is.
    pub place: Point,
}

/// What differs between two sections; the greatest areas first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// What only the first has.
    pub only_first: Vec<Piece>,
    /// What only the second has.
    pub only_second: Vec<Piece>,
}

impl Comparison {
    /// Compares two sections; pieces that deviate less than `least_mm` are passed over.
    pub fn new(first: &Section, second: &Section, least_mm: f64) -> Self {
        Self { only_first: beyond(first, second, least_mm), only_second: beyond(second, first, least_mm) }
    }

    /// Whether nothing differs.
    pub fn is_empty(&self) -> bool {
        self.only_first.is_empty() && self.only_second.is_empty()
    }
}

/// What a section has beyond another.
fn beyond(section: &Section, other: &Section, least_mm: f64) -> Vec<Piece> {
    let mut rest = section.clone();
    rest.cut_section(other);
    let surface = surface(other);
    pieces(&rest, &surface, least_mm)
}

/// The pieces of a section that deviate from a surface by more than `least_mm`; the greatest areas first.
pub(crate) fn pieces(section: &Section, surface: &[Segment], least_mm: f64) -> Vec<Piece> {
    let loops = section.contours().into_iter().filter(|contour| contour.area_mm2() > 0.0);
    let mut pieces: Vec<Piece> =
        loops.map(|contour| (contour.area_mm2(), contour.segments)).map(Piece::outline).collect();
    pieces.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2).then(a.bounds.min.z.total_cmp(&b.bounds.min.z)));
    pieces.truncate(PIECES_MAX);
    pieces.iter_mut().for_each(|piece| piece.look(surface));
    pieces.retain(|piece| piece.deviation_mm > least_mm.max(GRAIN_MM));
    pieces
}

/// The edges of a section that are its surface.
pub(crate) fn surface(section: &Section) -> Vec<Segment> {
    section.contours().into_iter().flat_map(|contour| contour.segments).filter(off_axis).collect()
}

/// The axis is no surface.
fn off_axis(edge: &Segment) -> bool {
    edge.start.x.max(edge.end.x) > GRAIN_MM
}

impl Piece {
    fn outline((area_mm2, edges): (f64, Vec<Segment>)) -> Self {
        let first = edges.first().map_or(Point::default(), |edge| edge.start);
        let none = Bounds { min: first, max: first };
        let parts = [0.25, 0.5, 0.75, 1.0];
        let places = edges.iter().flat_map(|edge| parts.map(|part| edge.at(part)));
        let bounds = places.fold(none, Bounds::with);
        Self { edges, bounds, area_mm2, deviation_mm: 0.0, place: first }
    }

    /// Finds where it comes away furthest.
    fn look(&mut self, surface: &[Segment]) {
        if surface.is_empty() {
            // Against nothing, all of it deviates.
            let (min, max) = (self.bounds.min, self.bounds.max);
            (self.deviation_mm, self.place) = (max.x - min.x, max);
            return;
        }
        // Whatever is nearest to a place in the piece is not much farther from its middle than what is nearest to that.
        let Bounds { min, max } = self.bounds;
        let middle = Point::new((min.x + max.x) / 2.0, (min.z + max.z) / 2.0);
        let to_middle = |edge: &Segment| edge.distance(middle);
        let nearest = surface.iter().map(to_middle).fold(f64::INFINITY, f64::min);
        let reach = nearest + min.distance(max) + GRAIN_MM;
        let near: Vec<&Segment> = surface.iter().filter(|edge| to_middle(edge) <= reach).collect();
        let places = self
            .edges
            .iter()
            .flat_map(|edge| (0..LOOKS).map(move |look| edge.at(f64::from(look) / f64::from(LOOKS))));
        for place in places.collect::<Vec<_>>() {
            let nearest = near.iter().map(|edge| edge.distance(place)).fold(f64::INFINITY, f64::min);
            if nearest > self.deviation_mm {
                (self.deviation_mm, self.place) = (nearest, place);
            }
        }
    }

    /// Lowest and highest X of it at a Z.
    pub fn reach_at(&self, z: f64) -> Option<(f64, f64)> {
        let mut reach: Option<(f64, f64)> = None;
        for edge in &self.edges {
            for look in 0..=LOOKS {
                let place = edge.at(f64::from(look) / f64::from(LOOKS));
                let next = edge.at(f64::from((look + 1).min(LOOKS)) / f64::from(LOOKS));
                let (low, high) = (place.z.min(next.z), place.z.max(next.z));
                if (low - GRAIN_MM..=high + GRAIN_MM).contains(&z) {
                    let share = if high - low > GRAIN_MM { (z - place.z) / (next.z - place.z) } else { 0.0 };
                    let x = place.x + (next.x - place.x) * share;
                    reach = Some(reach.map_or((x, x), |(a, b)| (a.min(x), b.max(x))));
                }
            }
        }
        reach
    }
}

/// How a surface has moved between an old and a new part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shift {
    /// An outer diameter, from old to new, mm.
    Diameter(f64, f64),
    /// A bore, from old to new, mm.
    Bore(f64, f64),
    /// A face, the Z from old to new.
    Face(f64, f64),
}

/// How the surface at a piece has moved; `of_old` when the old part has it, else the new one. Nothing where the piece
/// stands alone, as one that was cut off.
pub fn shift(piece: &Piece, of_old: bool, old: &Section, new: &Section) -> Option<Shift> {
    if old.bounds().is_none() || new.bounds().is_none() {
        return None;
    }
    let ordered = |has: f64, lacks: f64| if of_old { (has, lacks) } else { (lacks, has) };
    let both = |place: Point| place.x > 0.0 && old.contains(place) && new.contains(place);
    let Bounds { min, max } = piece.bounds;
    let step = 1e-4;
    if max.z - min.z < max.x - min.x {
        let x = (min.x + max.x) / 2.0;
        let (behind, in_front) = (both(Point::new(x, min.z - step)), both(Point::new(x, max.z + step)));
        match (behind, in_front) {
            (true, false) => return Some(ordered(max.z, min.z)).map(|(a, b)| Shift::Face(a, b)),
            (false, true) => return Some(ordered(min.z, max.z)).map(|(a, b)| Shift::Face(a, b)),
            _ => {}
        }
    }
    // A little inside, for at an end of the piece a face may stand.
    let inset = ((max.z - min.z) / 2.0).min(1e-3);
    let z = piece.place.z.clamp(min.z + inset, max.z - inset);
    let (low, high) = piece.reach_at(z)?;
    let below = low <= GRAIN_MM || both(Point::new(low - step, z));
    let above = both(Point::new(high + step, z));
    match (below, above) {
        (true, false) => Some(ordered(2.0 * high, 2.0 * low)).map(|(a, b)| Shift::Diameter(a, b)),
        (false, true) => Some(ordered(2.0 * low, 2.0 * high)).map(|(a, b)| Shift::Bore(a, b)),
        _ => None,
    }
}
