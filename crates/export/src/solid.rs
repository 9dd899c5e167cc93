//! The part as solids: what its half-section is when it turns round the axis.
//!
//! In: the loops of a [`PartShape`]. Out: [`Body`]s, each a closed surface and perhaps cavities; a surface is a
//! [`Shell`], the profile whose every edge turns into one face: a plane, a cylinder, a cone, a sphere or a torus.
//! Edges on the axis turn into nothing; where a loop comes to the axis, its profile ends.
//!
//! Invariants: each segment of a profile starts where the one before ends; the material is to its left; a profile is
//! closed or both its ends lie on the axis; no coordinate is below zero.

use turnwright_geometry::{Bend, Point, Segment};

use crate::part::PartShape;

/// Sections of more edges are no turned part that anybody would draw; no solid is made of them.
pub const EDGES_MAX: usize = 20_000;

/// What lies nearer to the axis is on it: a nanometre, the rounding of exact lengths.
const AXIS_MM: f64 = 1e-6;

/// A piece of the part.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its surface.
    pub outer: Shell,
    /// The surfaces of cavities that have no way out.
    pub voids: Vec<Shell>,
}

/// A closed surface of revolution.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// Its profile.
    pub profile: Vec<Segment>,
    /// What it encloses, mm³; below zero for a cavity.
    pub volume_mm3: f64,
}

/// What an edge turns into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// An upright edge.
    Plane,
    /// A level edge.
    Cylinder,
    /// Another straight edge.
    Cone,
    /// An arc whose centre is on the axis.
    Sphere,
    /// An arc whose circle stays clear of the axis.
    Torus,
    /// An arc whose circle crosses the axis, off its centre: a torus that would pass through itself.
    SpindleTorus,
}

impl Surface {
    /// The surface of an edge.
    pub fn of(edge: &Segment) -> Self {
        match edge.bend {
            None if edge.start.z == edge.end.z => Self::Plane,
            None if edge.start.x == edge.end.x => Self::Cylinder,
            None => Self::Cone,
            Some(bend) if bend.centre.x.abs() <= AXIS_MM => Self::Sphere,
            Some(bend) if bend.centre.x > bend.centre.distance(edge.start) + AXIS_MM => Self::Torus,
            Some(_) => Self::SpindleTorus,
        }
    }
}

/// Whether solids are made of a part: not when it has more than [`EDGES_MAX`] edges.
pub fn has_solid(shape: &PartShape) -> bool {
    shape.loops.iter().map(Vec::len).sum::<usize>() <= EDGES_MAX
}

/// The solids of a part; none unless it [has some](has_solid).
pub fn bodies(shape: &PartShape) -> Vec<Body> {
    if !has_solid(shape) {
        return Vec::new();
    }
    let (outers, voids): (Vec<Shell>, Vec<Shell>) =
        shells(&shape.loops).partition(|shell| shell.volume_mm3 > 0.0);
    let mut bodies: Vec<Body> = outers.into_iter().map(|outer| Body { outer, voids: Vec::new() }).collect();
    for void in voids {
        let Some(place) = void.profile.first().map(|edge| edge.at(0.5)) else { continue };
        let around = bodies.iter_mut().filter(|body| body.outer.contains(place));
        let nearest = around.min_by(|a, b| a.outer.volume_mm3.total_cmp(&b.outer.volume_mm3));
        if let Some(body) = nearest {
            body.voids.push(void);
        }
    }
    bodies
}

/// The surfaces of loops.
pub(crate) fn shells(loops: &[Vec<Segment>]) -> impl Iterator<Item = Shell> {
    loops.iter().flat_map(|edges| profiles(edges)).map(Shell::new)
}

impl Body {
    /// All its surfaces.
    pub fn shells(&self) -> impl Iterator<Item = &Shell> {
        [&self.outer].into_iter().chain(&self.voids)
    }
}

impl Shell {
    fn new(profile: Vec<Segment>) -> Self {
        let volume_mm3 = profile.iter().map(Segment::volume_round_axis_mm3).sum();
        Self { profile, volume_mm3 }
    }

    /// Whether the profile comes back to its start, without the axis.
    pub fn is_ring(&self) -> bool {
        self.profile.first().is_some_and(|first| first.start.x > 0.0)
    }

    fn contains(&self, place: Point) -> bool {
        self.profile.iter().map(|edge| edge.crossings_above(place)).sum::<usize>() % 2 == 1
    }
}

/// The profiles of a loop: all of it, or what lies between its places on the axis.
fn profiles(edges: &[Segment]) -> Vec<Vec<Segment>> {
    let mut parted: Vec<Segment> = edges.iter().flat_map(|edge| on_axis(*edge)).collect();
    parted.retain(|edge| edge.bend.is_some() || edge.start != edge.end);
    let is_on_axis = |place: Point| place.x == 0.0;
    let Some(first) = parted.iter().position(|edge| is_on_axis(edge.start)) else { return vec![parted] };
    parted.rotate_left(first);
    let off_axis = |edge: &&Segment| !(is_on_axis(edge.start) && is_on_axis(edge.end) && edge.bend.is_none());
    let mut profiles: Vec<Vec<Segment>> = Vec::new();
    for edge in parted.iter().filter(off_axis) {
        match profiles.last_mut().filter(|_| !is_on_axis(edge.start)) {
            Some(profile) => profile.push(*edge),
            None => profiles.push(vec![*edge]),
        }
    }
    profiles
}

/// An edge with its ends on the axis where they are as good as there; one that only touches it in two.
fn on_axis(edge: Segment) -> impl Iterator<Item = Segment> {
    let snapped = |place: Point| if place.x <= AXIS_MM { Point { x: 0.0, ..place } } else { place };
    let edge = Segment { start: snapped(edge.start), end: snapped(edge.end), ..edge };
    let touch = edge.bend.and_then(|Bend { centre, .. }| {
        let lowest = Point { x: centre.x - centre.distance(edge.start), z: centre.z };
        let is_touch = lowest.x.abs() <= AXIS_MM && centre.x > AXIS_MM;
        let is_inner = edge.distance(lowest) <= AXIS_MM && edge.start.x > 0.0 && edge.end.x > 0.0;
        (is_touch && is_inner).then_some(Point { x: 0.0, ..lowest })
    });
    let rest = touch.map(|touch| Segment { start: touch, ..edge });
    [Segment { end: touch.unwrap_or(edge.end), ..edge }].into_iter().chain(rest)
}
