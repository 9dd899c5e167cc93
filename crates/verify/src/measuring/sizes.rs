//! All sizes of a part, as its drawing would have them.
//!
//! The edges of the half-section run with the material to their left: outer surfaces against Z, bores along it, front
//! faces outwards. A groove is where an edge comes nearest to the axis and both ways lead out of it again; likewise with
//! the roles of the axes changed for bores and faces. What lies in the rectangle of a thread is the thread's.

use turnwright_geometry::{Bounds, Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::ThreadMark;

use super::{Thread, threads};

/// Edges that are less inclined than this are level or upright, mm: a nanometre.
const LEVEL_MM: f64 = 1e-6;

/// A groove that is less deep is none, mm: what tools leave where they meet.
const GROOVE_MM: f64 = 5e-3;

/// A stretch of one diameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Its diameter, mm.
    pub diameter_mm: f64,
    /// Higher and lower Z.
    pub z_mm: (f64, f64),
    /// A bore.
    pub is_inside: bool,
}

/// A cone: a taper, a chamfer, the point of a drill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Diameters at its front and its back end, mm.
    pub diameters_mm: (f64, f64),
    /// Higher and lower Z.
    pub z_mm: (f64, f64),
    /// A bore.
    pub is_inside: bool,
}

impl Taper {
    /// Between its side and the axis, degrees.
    pub fn angle_deg(&self) -> f64 {
        let dx = (self.diameters_mm.0 - self.diameters_mm.1).abs() / 2.0;
        libm::atan2(dx, self.z_mm.0 - self.z_mm.1).to_degrees()
    }
}

/// An arc in the section: a rounding or a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// The radius, mm.
    pub radius_mm: f64,
    /// Diameters at its front and its back end, mm.
    pub diameters_mm: (f64, f64),
    /// Higher and lower Z.
    pub z_mm: (f64, f64),
    /// The material bulges out.
    pub is_convex: bool,
}

/// Where a groove opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// To the outside.
    Outside,
    /// Into the bore.
    Inside,
    /// To the front face.
    Front,
    /// To the back.
    Back,
}

/// A groove or recess.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Groove {
    /// Where it opens.
    pub opening: Opening,
    /// Of its bottom: a diameter outside and inside, a Z in a face, mm.
    pub bottom_mm: f64,
    /// How deep it is below the lower of its two sides, mm.
    pub depth_mm: f64,
    /// At that side: higher and lower Z, in a face larger and smaller diameter, mm.
    pub from_to_mm: (f64, f64),
    /// Of its bottom, mm; 0 when it is pointed or round.
    pub bottom_width_mm: f64,
}

impl Groove {
    /// Its width where it opens, mm.
    pub fn width_mm(&self) -> f64 {
        let width = self.from_to_mm.0 - self.from_to_mm.1;
        match self.opening {
            Opening::Outside | Opening::Inside => width,
            Opening::Front | Opening::Back => width / 2.0,
        }
    }
}

/// All sizes of a part, from the front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sizes {
    /// Outside and inside.
    pub cylinders: Vec<Cylinder>,
    /// Cones.
    pub tapers: Vec<Taper>,
    /// Arcs.
    pub radii: Vec<Radius>,
    /// Z of the plane faces, each once.
    pub faces_mm: Vec<f64>,
    /// Grooves and recesses.
    pub grooves: Vec<Groove>,
    /// Threads.
    pub threads: Vec<Thread>,
    /// Greatest diameter, mm.
    pub diameter_mm: f64,
    /// Higher and lower Z of the whole, mm.
    pub z_mm: (f64, f64),
    /// What it holds, mm³.
    pub volume_mm3: f64,
}

impl Sizes {
    /// Measures a part; nothing when there is no material.
    pub fn new(section: &Section, marks: &[ThreadMark]) -> Option<Self> {
        let bounds = section.bounds()?;
        let mut sizes = Self {
            diameter_mm: 2.0 * bounds.max.x,
            z_mm: (bounds.max.z, bounds.min.z),
            volume_mm3: section.volume_mm3(),
            threads: threads(section, marks),
            ..Self::default()
        };
        let rectangles: Vec<Bounds> = marks.iter().map(|mark| mark.bounds).collect();
        for contour in section.contours() {
            for edge in &contour.segments {
                sizes.add(edge, &rectangles);
            }
            let corners = corners(&contour.segments);
            sizes.find_grooves(&corners, &rectangles);
        }
        sizes.faces_mm.sort_by(|a, b| b.total_cmp(a));
        sizes.faces_mm.dedup_by(|next, face| (*face - *next).abs() < LEVEL_MM);
        sizes.cylinders.sort_by(|a, b| b.z_mm.0.total_cmp(&a.z_mm.0));
        sizes.tapers.sort_by(|a, b| b.z_mm.0.total_cmp(&a.z_mm.0));
        sizes.radii.sort_by(|a, b| b.z_mm.0.total_cmp(&a.z_mm.0));
        sizes.grooves.sort_by(|a, b| b.from_to_mm.0.total_cmp(&a.from_to_mm.0));
        Some(sizes)
    }

    /// How long it is, mm.
    pub fn length_mm(&self) -> f64 {
        self.z_mm.0 - self.z_mm.1
    }

    fn add(&mut self, edge: &Segment, threads: &[Bounds]) {
        let (start, end) = (edge.start, edge.end);
        let (dx, dz) = (end.x - start.x, end.z - start.z);
        let on_axis = start.x.max(end.x) < LEVEL_MM;
        if on_axis || threads.iter().any(|thread| holds(thread, start) && holds(thread, end)) {
            return;
        }
        let (front, back) = if dz < 0.0 { (start, end) } else { (end, start) };
        let z_mm = (front.z, back.z);
        let diameters_mm = (2.0 * front.x, 2.0 * back.x);
        // Bores run along Z.
        let is_inside = dz > 0.0;
        match edge.bend {
            Some(bend) => self.radii.push(Radius {
                radius_mm: bend.centre.distance(start),
                diameters_mm,
                z_mm,
                is_convex: !bend.clockwise,
            }),
            None if dx.abs() <= LEVEL_MM => {
                self.cylinders.push(Cylinder { diameter_mm: diameters_mm.0, z_mm, is_inside });
            }
            None if dz.abs() <= LEVEL_MM => self.faces_mm.push(start.z),
            None => self.tapers.push(Taper { diameters_mm, z_mm, is_inside }),
        }
    }

    fn find_grooves(&mut self, corners: &[Point], threads: &[Bounds]) {
        let (x, z) = (|place: Point| place.x, |place: Point| place.z);
        let searches: [(Opening, Axis, f64); 4] = [
            (Opening::Outside, Axis { level: x, along: z }, 1.0),
            (Opening::Inside, Axis { level: x, along: z }, -1.0),
            (Opening::Front, Axis { level: z, along: x }, 1.0),
            (Opening::Back, Axis { level: z, along: x }, -1.0),
        ];
        for (opening, axis, sign) in searches {
            // The way of the edges at the bottom: outside against Z, in a front face away from the axis.
            let way = if matches!(opening, Opening::Outside | Opening::Back) { -1.0 } else { 1.0 };
            for dip in dips(corners, axis, sign, way) {
                let is_thread = threads.iter().any(|thread| holds(thread, dip.place));
                if dip.depth < GROOVE_MM || is_thread || dip.place.x < LEVEL_MM {
                    continue;
                }
                let factor = if matches!(opening, Opening::Front | Opening::Back) { 2.0 } else { 1.0 };
                let (high, low) = (dip.from.max(dip.to) * factor, dip.from.min(dip.to) * factor);
                let bottom = (axis.level)(dip.place);
                let bottom_mm = if factor == 1.0 { 2.0 * bottom } else { bottom };
                self.grooves.push(Groove {
                    opening,
                    bottom_mm,
                    depth_mm: dip.depth,
                    from_to_mm: (high, low),
                    bottom_width_mm: dip.width,
                });
            }
        }
    }
}

/// Whether a place lies in a rectangle, give or take a nanometre.
fn holds(bounds: &Bounds, place: Point) -> bool {
    (bounds.min.z - LEVEL_MM..=bounds.max.z + LEVEL_MM).contains(&place.z)
        && (bounds.min.x - LEVEL_MM..=bounds.max.x + LEVEL_MM).contains(&place.x)
}

/// The corners of a loop, with the places where arcs reach furthest along an axis between them.
fn corners(edges: &[Segment]) -> Vec<Point> {
    let mut corners = Vec::with_capacity(edges.len());
    for edge in edges {
        corners.push(edge.start);
        let Some(bend) = edge.bend else { continue };
        let radius = bend.centre.distance(edge.start);
        let Point { x, z } = bend.centre;
        let poles = [(radius, 0.0), (0.0, radius), (-radius, 0.0), (0.0, -radius)];
        let poles = poles.map(|(up, right)| Point::new(x + up, z + right));
        let mut between: Vec<(f64, Point)> = poles
            .into_iter()
            .filter(|pole| edge.distance(*pole) < LEVEL_MM)
            .map(|pole| (turned(edge, pole), pole))
            .filter(|(part, _)| (1e-9..1.0 - 1e-9).contains(part))
            .collect();
        between.sort_by(|a, b| a.0.total_cmp(&b.0));
        corners.extend(between.into_iter().map(|(_, pole)| pole));
    }
    corners
}

/// Which part of an arc lies before a place on it.
fn turned(edge: &Segment, place: Point) -> f64 {
    let Some(bend) = edge.bend else { return 0.0 };
    let to = Segment { end: place, ..*edge };
    let full = Segment { bend: Some(bend), ..*edge };
    (to.sweep_rad() / full.sweep_rad()).abs()
}

#[derive(Clone, Copy)]
struct Axis {
    /// Across the surface.
    level: fn(Point) -> f64,
    /// Along it.
    along: fn(Point) -> f64,
}

/// A place that both ways lead out of.
struct Dip {
    place: Point,
    depth: f64,
    /// Where it opens, along the surface.
    from: f64,
    to: f64,
    /// Of its level bottom.
    width: f64,
}

/// The dips of a loop: `sign` is 1 where low levels are deep, `way` the direction in which the bottom runs.
fn dips(corners: &[Point], axis: Axis, sign: f64, way: f64) -> Vec<Dip> {
    let count = corners.len();
    let level = |index: usize| sign * (axis.level)(corners[index % count]);
    let along = |index: usize| (axis.along)(corners[index % count]);
    let mut dips = Vec::new();
    for first in 0..count {
        // A bottom begins where the way down ends.
        if level(first + count - 1) <= level(first) + LEVEL_MM {
            continue;
        }
        let mut last = first;
        while last < first + count && (level(last + 1) - level(first)).abs() <= LEVEL_MM {
            last += 1;
        }
        if level(last + 1) <= level(last) || last >= first + count {
            continue;
        }
        // Up both ways until the edge turns down.
        let climb = |from: usize, step: usize| {
            let mut at = from;
            for _ in 0..count {
                let next = (at + step) % count;
                if level(next) < level(at) - LEVEL_MM {
                    break;
                }
                at = next;
            }
            at
        };
        let (before, behind) = (climb(first % count, count - 1), climb(last % count, 1));
        let top = level(before).min(level(behind));
        let from = reach(&|index| level(index), &along, first, count - 1, top, count);
        let to = reach(&|index| level(index), &along, last, 1, top, count);
        if (to - from) * way <= 0.0 {
            continue;
        }
        dips.push(Dip {
            place: corners[first % count],
            depth: top - level(first),
            from,
            to,
            width: (along(last) - along(first)).abs(),
        });
    }
    dips
}

/// Where the way up from a bottom reaches a level.
fn reach(
    level: &dyn Fn(usize) -> f64,
    along: &dyn Fn(usize) -> f64,
    bottom: usize,
    step: usize,
    top: f64,
    count: usize,
) -> f64 {
    let mut at = bottom % count;
    for _ in 0..count {
        let next = (at + step) % count;
        let (low, high) = (level(at), level(next));
        if high >= top - LEVEL_MM {
            let share =
                if high - low > LEVEL_MM { ((top - low) / (high - low)).clamp(0.0, 1.0) } else { 1.0 };
            return along(at) + (along(next) - along(at)) * share;
        }
        at = next;
    }
    along(at)
}
