//! The part as triangles, for the formats that know nothing rounder.
//!
//! In: the solids of a [`PartShape`] and a tolerance. Out: a [`Mesh`]: of a part that is the same all round its strips,
//! chords of the profile with the surface's normals at their ends, and the directions in which each is turned round the
//! axis ([`Turned`]); of one whose threads wind the triangles of `wound.rs`.
//!
//! Invariants: the corners lie on the part, and nothing of the mesh farther from it than the tolerance it tells; strips
//! that meet have the very same corners, so that the mesh is closed; none has more than [`TRIANGLES_MAX`] triangles: for
//! a part that would need more, the tolerance is widened.

use std::f64::consts::{FRAC_PI_3, PI, TAU};

use turnwright_geometry::{Point, Segment, Vector};

use crate::part::PartShape;
use crate::solid::{Shell, bodies};
use crate::wound::Wound;

/// How far a mesh may lie off the part when nothing else is asked for: a hundredth of a millimetre.
pub const CHORD_MM: f64 = 0.01;

/// Triangles of a mesh; 50 MB as STL.
pub const TRIANGLES_MAX: usize = 1_000_000;

/// Corners nearer than this are one, mm: a tenth of a micrometre, which single precision still tells apart.
const MERGE_MM: f64 = 1e-4;

/// Fewest and most corners of a circle.
const SIDES_MIN: usize = 24;
const SIDES_MAX: usize = 1440;

/// A closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
pub enum Mesh {
    /// The same all round; threads, if there are any, are plain surfaces.
    Turned(Turned),
    /// With threads that wind.
    Wound(Wound),
}

/// A closed surface of triangles that is the same all round.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// Its strips, one behind the other along each profile.
    pub strips: Vec<Strip>,
    /// Cosine and sine of the directions round the axis.
    pub directions: Vec<(f64, f64)>,
    /// How far it may lie off the part, mm.
    pub chord_mm: f64,
}

/// A chord of the profile, turned round the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// Where it starts.
    pub start: Corner,
    /// Where it ends; the material lies to the left of the way there.
    pub end: Corner,
    /// It is the crest of a thread.
    pub is_thread: bool,
}

/// An end of a chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is.
    pub place: Point,
    /// Out of the material, square to the surface, of length 1.
    pub normal: Vector,
}

impl Mesh {
    /// The mesh of a part whose threads are plain surfaces; see [`Turned::new`].
    pub fn new(shape: &PartShape, chord_mm: f64) -> Option<Self> {
        Turned::new(shape, chord_mm).map(Self::Turned)
    }

    /// How many triangles it has.
    pub fn triangle_count(&self) -> usize {
        match self {
            Self::Turned(turned) => turned.triangle_count(),
            Self::Wound(wound) => wound.facets.len(),
        }
    }

    /// How far it may lie off the part, mm.
    pub fn chord_mm(&self) -> f64 {
        match self {
            Self::Turned(turned) => turned.chord_mm,
            Self::Wound(wound) => wound.chord_mm,
        }
    }
}

impl Turned {
    /// The mesh of a part, no farther from it than `chord_mm` unless it had too many triangles; nothing when the part
    /// has no solid.
    pub fn new(shape: &PartShape, chord_mm: f64) -> Option<Self> {
        const DOUBLINGS: u32 = 20;
        let bodies = bodies(shape);
        let shells: Vec<&Shell> = bodies.iter().flat_map(|body| body.shells()).collect();
        if shells.is_empty() {
            return None;
        }
        let is_thread = |edge: &Segment| shape.thread_of(edge).is_some();
        (0..DOUBLINGS).find_map(|doublings| {
            let chord_mm = chord_mm * f64::from(1 << doublings);
            // One half of the tolerance for each of the two ways in which the surface bends.
            let sides = sides(shape.diameter_mm / 2.0, chord_mm / 2.0);
            let strips: Vec<Strip> = shells
                .iter()
                .flat_map(|shell| chords_of(&shell.profile, chord_mm / 2.0, is_thread))
                .collect();
            let directions = (0..sides).map(|side| {
                let angle = TAU * side as f64 / sides as f64;
                (angle.cos(), angle.sin())
            });
            let mesh = Self { strips, directions: directions.collect(), chord_mm };
            (mesh.triangle_count() <= TRIANGLES_MAX).then_some(mesh)
        })
    }

    /// How many triangles it has.
    pub fn triangle_count(&self) -> usize {
        let of_strip =
            |strip: &Strip| usize::from(strip.start.place.x > 0.0) + usize::from(strip.end.place.x > 0.0);
        self.strips.iter().map(of_strip).sum::<usize>() * self.directions.len()
    }

    /// The triangles of a strip by their corners: an end, and the number of the direction; counter-clockwise seen from
    /// outside.
    pub fn triangles(&self, strip: &Strip) -> impl Iterator<Item = [(End, usize); 3]> + use<> {
        let (has_start, has_end) = (strip.start.place.x > 0.0, strip.end.place.x > 0.0);
        let count = self.directions.len();
        (0..count).flat_map(move |side| {
            let next = (side + 1) % count;
            let at_end = has_end.then_some([(End::Start, side), (End::End, side), (End::End, next)]);
            let at_start = has_start.then_some([(End::Start, side), (End::End, next), (End::Start, next)]);
            at_end.into_iter().chain(at_start)
        })
    }
}

/// An end of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Where it starts.
    Start,
    /// Where it ends.
    End,
}

/// Corners of a circle, a multiple of four.
pub(crate) fn sides(radius_mm: f64, chord_mm: f64) -> usize {
    let sides = (PI / half_angle(radius_mm, chord_mm)).ceil() as usize;
    sides.next_multiple_of(4).clamp(SIDES_MIN, SIDES_MAX)
}

/// Half the angle of a chord that stays this near to its arc.
fn half_angle(radius_mm: f64, chord_mm: f64) -> f64 {
    (1.0 - (chord_mm / radius_mm).min(1.0)).acos()
}

/// A profile as chords, each end to end with the next; too short ones go to their neighbours.
pub(crate) fn chords_of(
    profile: &[Segment],
    chord_mm: f64,
    is_thread: impl Fn(&Segment) -> bool,
) -> Vec<Strip> {
    let snapped = |place: Point| if place.x < MERGE_MM { Point { x: 0.0, ..place } } else { place };
    let mut strips: Vec<Strip> = Vec::with_capacity(profile.len());
    let Some(first) = profile.first().map(|edge| snapped(edge.start)) else { return strips };
    let mut from = first;
    for edge in profile {
        let is_thread = is_thread(edge);
        let chords = chords(edge, chord_mm);
        let mut start_part = 0.0;
        for chord in 1..=chords {
            let part = chord as f64 / chords as f64;
            let to = snapped(if chord == chords { edge.end } else { edge.at(part) });
            if from.distance(to) < MERGE_MM {
                continue;
            }
            let start = Corner { place: from, normal: normal(edge, start_part) };
            strips.push(Strip { start, end: Corner { place: to, normal: normal(edge, part) }, is_thread });
            (from, start_part) = (to, part);
        }
    }
    // What was too short at the end goes to the last chord.
    let last = profile.last().map_or(first, |edge| snapped(edge.end));
    if let Some(strip) = strips.last_mut() {
        strip.end.place = last;
    }
    strips
}

/// Chords of an edge; an arc has one for every sixth of a circle at least.
fn chords(edge: &Segment, chord_mm: f64) -> usize {
    let Some(bend) = edge.bend else { return 1 };
    let sweep = edge.sweep_rad().abs();
    let step = (2.0 * half_angle(bend.centre.distance(edge.start), chord_mm)).min(FRAC_PI_3);
    (sweep / step).ceil().max(1.0) as usize
}

/// Out of the material at a part of the way.
fn normal(edge: &Segment, part: f64) -> Vector {
    let out = match edge.bend {
        None => {
            let way = Vector::between(edge.start, edge.end);
            Vector { x: -way.z, z: way.x }
        }
        Some(bend) => {
            let arm = Vector::between(bend.centre, edge.at(part));
            if bend.clockwise { arm.times(-1.0) } else { arm }
        }
    };
    out.times(1.0 / out.length())
}
