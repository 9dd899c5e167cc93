//! The edges of the material as closed loops, for drawings, solids and measuring.
//!
//! Every floor runs along Z, every roof against it, so that the material lies to the left. At an upright line between
//! slabs, edges arrive and depart; sorted by X, each two neighbours of a piece belong together, and the way between them
//! is an upright face where there is one. Pieces that touch in a point have loops of their own.

use turnwright_geometry::{Bend, Point, Segment, Vector};

use crate::WELD_MM;
use crate::curve::Curve;
use crate::section::Section;

/// Steps of upright faces lower than this are not shown: a nanometre.
const STEP_MM: f64 = 1e-6;

/// A closed loop of lines and arcs with the material to its left: counter-clockwise round a piece, clockwise round a
/// cavity. Each segment starts exactly where the one before ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contour {
    /// Its lines and arcs.
    pub segments: Vec<Segment>,
}

/// An edge with its way: a floor from lower to higher Z, a roof the other way.
#[derive(Clone, Copy, Debug)]
struct Way {
    edge: Curve,
    from: f64,
    to: f64,
    piece: usize,
    next: usize,
}

/// The end of a way on an upright line.
#[derive(Clone, Copy, Debug)]
struct End {
    x: f64,
    way: usize,
    piece: usize,
    arrives: bool,
}

impl Contour {
    /// What it encloses, mm²; below zero for a cavity.
    pub fn area_mm2(&self) -> f64 {
        self.segments.iter().map(Segment::area_beside_axis_mm2).sum()
    }

    /// Adds a segment; one that goes on as the last does is put to it.
    fn push(&mut self, segment: Segment) {
        match self.segments.last_mut().filter(|last| goes_on(last, &segment)) {
            Some(last) => last.end = segment.end,
            None => self.segments.push(segment),
        }
    }

    /// Closes the loop: the last segment may go on in the first.
    fn close(&mut self) {
        if let (Some(first), Some(last)) = (self.segments.first().copied(), self.segments.last().copied())
            && self.segments.len() > 2
            && goes_on(&last, &first)
        {
            self.segments[0].start = last.start;
            self.segments.pop();
        }
        if let [first, .., last] = self.segments.as_mut_slice() {
            meet(last, first);
        }
    }
}

impl Section {
    /// The loops round all pieces and cavities.
    pub fn contours(&self) -> Vec<Contour> {
        let (_, owners) = self.bonded();
        let mut owners = owners.into_iter();
        let mut ways: Vec<Way> = Vec::new();
        let mut ends: Vec<End> = Vec::new();
        let mut last_to = f64::NEG_INFINITY;
        for (slab, bands) in self.row.slabs() {
            if last_to != slab.from {
                join(&mut ends, &mut ways);
            }
            let first = ways.len();
            for (band, piece) in bands.iter().zip(&mut owners) {
                ways.push(Way { edge: band.floor, from: slab.from, to: slab.to, piece, next: 0 });
                ways.push(Way { edge: band.roof, from: slab.to, to: slab.from, piece, next: 0 });
            }
            let added = first..ways.len();
            ends.extend(added.clone().map(|way| End::new(&ways, way, slab.from)));
            join(&mut ends, &mut ways);
            ends.extend(added.map(|way| End::new(&ways, way, slab.to)));
            last_to = slab.to;
        }
        join(&mut ends, &mut ways);
        trace(&ways)
    }
}

impl End {
    fn new(ways: &[Way], way: usize, z: f64) -> Self {
        let Way { edge, to, piece, .. } = ways[way];
        Self { x: edge.at(z), way, piece, arrives: to == z }
    }
}

/// Leads every way that arrives at an upright line on to one that departs.
fn join(ends: &mut Vec<End>, ways: &mut [Way]) {
    ends.sort_by(|a, b| a.piece.cmp(&b.piece).then(a.x.total_cmp(&b.x)));
    for index in (0..ends.len()).step_by(2) {
        let arrives = ends[index].arrives;
        // Where edges meet in one point, rounding may have put them in an order that no material has.
        if let Some(other) = (index + 1..ends.len()).find(|other| ends[*other].arrives != arrives) {
            ends[index + 1..=other].rotate_right(1);
            let (one, other) = (ends[index], ends[index + 1]);
            let (from, to) = if arrives { (one, other) } else { (other, one) };
            ways[from.way].next = to.way;
        }
    }
    ends.clear();
}

/// Follows the ways until each has been gone once.
fn trace(ways: &[Way]) -> Vec<Contour> {
    let mut is_gone = vec![false; ways.len()];
    let mut contours = Vec::new();
    for start in 0..ways.len() {
        let mut contour = Contour::default();
        let mut place: Option<Point> = None;
        let mut way = start;
        while !std::mem::replace(&mut is_gone[way], true) {
            let Way { edge, from, to, next, .. } = ways[way];
            place = Some(contour.follow(place, &edge, from, to));
            way = next;
        }
        let first = contour.segments.first().map(|first| first.start);
        if let (Some(place), Some(first)) = (place, first) {
            contour.step(place, first);
            contour.close();
            contours.push(contour);
        }
    }
    contours
}

impl Contour {
    /// An upright face, unless it is lower than a step; gives where it ends.
    fn step(&mut self, from: Point, to: Point) -> Point {
        if from.distance(to) <= STEP_MM {
            return from;
        }
        let to = Point { z: from.z, ..to };
        self.push(Segment { start: from, end: to, bend: None });
        to
    }

    /// An edge, after the upright face that leads to it.
    fn follow(&mut self, place: Option<Point>, edge: &Curve, from: f64, to: f64) -> Point {
        let start = place.map_or(edge.point(from), |place| self.step(place, edge.point(from)));
        let end = edge.point(to);
        let bend = match *edge {
            Curve::Line { .. } => None,
            Curve::Arc { z, x, radius } => {
                Some(Bend { centre: Point { x, z }, clockwise: (radius > 0.0) == (from < to) })
            }
        };
        let mut segment = Segment { start, end, bend };
        if let Some(last) = self.segments.last_mut().filter(|last| last.end == start) {
            segment.start = edge.point(from);
            meet(last, &mut segment);
        }
        self.push(segment);
        end
    }
}

/// Lets two segments meet in one point: that of the line, where only one is a line. Where an arc stands upright, its X
/// follows from Z to half the digits only.
fn meet(last: &mut Segment, next: &mut Segment) {
    if last.bend.is_some() && next.bend.is_none() {
        last.end = next.start;
    } else {
        next.start = last.end;
    }
}

/// Whether two segments, one behind the other, are one line or one arc.
fn goes_on(last: &Segment, next: &Segment) -> bool {
    match (last.bend, next.bend) {
        (None, None) => {
            let (way, on) = (Vector::between(last.start, last.end), Vector::between(next.start, next.end));
            let (length, on_length) = (way.length(), on.length());
            // How far the corner lies off, were both one.
            way.cross(on).abs() <= WELD_MM * length.max(on_length) && way.x * on.x + way.z * on.z > 0.0
        }
        (Some(bend), Some(other)) => {
            let radius = |segment: &Segment, bend: &Bend| bend.centre.distance(segment.end);
            let both = last.sweep_rad() + next.sweep_rad();
            bend.clockwise == other.clockwise
                && bend.centre.distance(other.centre) <= WELD_MM
                && (radius(last, &bend) - radius(next, &other)).abs() <= STEP_MM
                && both.abs() < std::f64::consts::TAU - 1e-6
        }
        _ => false,
    }
}
