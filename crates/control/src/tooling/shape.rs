//! The outlines of tools, relative to the point that the program moves.
//!
//! Everything is drawn as an outside right-hand tool first (tip number 3: the work below, the chuck to the left) and
//! then mirrored to where the tool stands.

use turnwright_geometry::{Outline, OutlineFault, Point, Vector};

use super::Flank;
use super::designation::{Form, Holder, TurningInsert, reach_mm};
use crate::outline::rounded;

/// How much of the insert's edge the head of a holder goes along.
const HEAD_PART: f64 = 0.9;

/// How far the head of a holder stands back behind the edges of its insert, mm.
const SETBACK_MM: f64 = 0.5;

/// Where a tool stands in relation to the drawing of an outside right-hand tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stance {
    /// Its work lies above: boring.
    pub(super) is_above: bool,
    /// It works away from the chuck.
    pub(super) is_left: bool,
    /// X and Z are exchanged: it feeds into a face.
    pub(super) is_face: bool,
    /// Where the imaginary tip lies from the centre of the nose, X and Z, each −1, 0 or 1.
    pub(super) tip: (i8, i8),
}

/// The directions of the imaginary tip from the centre of the nose by tip number, X and Z.
pub(super) const fn tip_direction(tip: u8) -> (i8, i8) {
    match tip {
        1 => (1, 1),
        2 => (1, -1),
        3 => (-1, -1),
        4 => (-1, 1),
        5 => (0, 1),
        6 => (1, 0),
        7 => (0, -1),
        8 => (-1, 0),
        _ => (0, 0),
    }
}

impl Stance {
    /// The centre of the nose in the drawing, from the programmed point.
    fn centre(self, radius_mm: f64) -> Point {
        let (x, z) = (-f64::from(self.tip.0), -f64::from(self.tip.1));
        let (x, z) = if self.is_face { (z, x) } else { (x, z) };
        let x = if self.is_above { -x } else { x };
        let z = if self.is_left { -z } else { z };
        Point::new(x * radius_mm, z * radius_mm)
    }

    /// A place or a way of the drawing as the tool stands; for tools that do not feed into a face.
    fn turned(self, x: f64, z: f64) -> (f64, f64) {
        (if self.is_above { -x } else { x }, if self.is_left { -z } else { z })
    }

    /// A drawing as the tool stands.
    fn placed(self, drawing: Outline) -> Outline {
        let drawing = if self.is_above { drawing.mirrored_in_x() } else { drawing };
        let drawing = if self.is_left { drawing.mirrored_in_z() } else { drawing };
        if self.is_face { transposed(&drawing) } else { drawing }
    }
}

/// X and Z exchanged.
fn transposed(outline: &Outline) -> Outline {
    let image = |point: Point| Point::new(point.z, point.x);
    let segments = outline.segments().iter().map(|segment| {
        let mut segment = segment.reversed();
        segment.start = image(segment.start);
        segment.end = image(segment.end);
        // Turned round by the exchange and back by being run the other way.
        if let Some(bend) = &mut segment.bend {
            bend.centre = image(bend.centre);
            bend.clockwise = !bend.clockwise;
        }
        segment
    });
    let mut segments: Vec<_> = segments.collect();
    segments.reverse();
    Outline::new(segments).unwrap_or_else(|fault| unreachable!("a mirrored outline is one: {fault:?}"))
}

/// The way along an edge that makes an angle with the direction of feed, towards the chuck.
fn edge(angle_deg: f64) -> Vector {
    let angle = angle_deg.to_radians();
    Vector { x: libm::sin(angle), z: -libm::cos(angle) }
}

fn corner(at: Point) -> (Point, f64) {
    (at, 0.0)
}

/// A turning insert: the two edges of its cutting corner touch the nose.
pub(super) fn insert(
    insert: &TurningInsert,
    entering_angle_deg: f64,
    nose_mm: f64,
    stance: Stance,
) -> Result<Outline, OutlineFault> {
    let centre = stance.centre(nose_mm);
    if insert.form == Form::Round {
        return Outline::circle(centre, nose_mm).map(|drawing| stance.placed(drawing));
    }
    let (major, minor) = (edge(entering_angle_deg), edge(entering_angle_deg + insert.angle_deg));
    let apex = apex(centre, nose_mm, insert.angle_deg, entering_angle_deg);
    let length = insert.edge_mm();
    let along = |from: Point, way: Vector| way.times(length).from(from);
    let corners: Vec<Point> = match insert.form {
        Form::Triangle => vec![apex, along(apex, minor), along(apex, major)],
        Form::Trigon => {
            // Six edges; corners of the cutting angle and blunt ones take turns.
            let blunt_turn = 120.0 - (180.0 - insert.angle_deg);
            let mut corners = vec![apex];
            let mut angle_deg = entering_angle_deg + insert.angle_deg;
            for step in 0..5 {
                let last = corners[corners.len() - 1];
                corners.push(along(last, edge(angle_deg)));
                angle_deg -= if step % 2 == 0 { blunt_turn } else { 180.0 - insert.angle_deg };
            }
            corners
        }
        Form::Rhombus | Form::Round => {
            let right = along(apex, minor);
            vec![apex, right, along(right, major), along(apex, major)]
        }
    };
    let corners: Vec<_> = corners.into_iter().map(|corner| (corner, nose_mm)).collect();
    rounded(&corners).map(|drawing| stance.placed(drawing))
}

/// One of the two edges that touch the nose: the minor one, which trails, or the major one, which leads.
pub(super) fn flank(
    insert: &TurningInsert,
    entering_angle_deg: f64,
    nose_mm: f64,
    stance: Stance,
    trails: bool,
) -> Flank {
    let centre = stance.centre(nose_mm);
    let way = edge(if trails { entering_angle_deg + insert.angle_deg } else { entering_angle_deg });
    // A quarter turn off the edge, away from the insert.
    let outward = if trails { Vector { x: -way.z, z: way.x } } else { Vector { x: way.z, z: -way.x } };
    let near = outward.times(nose_mm).from(centre);
    let apex = apex(centre, nose_mm, insert.angle_deg, entering_angle_deg);
    let far = way.times(HEAD_PART * insert.edge_mm()).from(apex);
    let place = |at: Point| {
        let (x, z) = stance.turned(at.x, at.z);
        Point { x, z }
    };
    let (x, z) = stance.turned(outward.x, outward.z);
    Flank { near: place(near), far: place(far), outward: Vector { x, z } }
}

/// Where the two edges that touch the nose would meet.
fn apex(centre: Point, nose_mm: f64, angle_deg: f64, entering_angle_deg: f64) -> Point {
    let back = nose_mm / libm::sin(angle_deg.to_radians());
    let both = edge(entering_angle_deg).plus(edge(entering_angle_deg + angle_deg));
    both.times(-back).from(centre)
}

/// What holds a turning insert: a square shank that comes from above, or a bar along Z.
pub(super) fn turning_holder(
    insert: &TurningInsert,
    holder: &Holder,
    nose_mm: f64,
    stance: Stance,
) -> Result<Outline, OutlineFault> {
    let (entering, angle) = (holder.entering_angle_deg, insert.angle_deg);
    let (major, minor) = (edge(entering), edge(entering + angle));
    let centre = stance.centre(nose_mm);
    let sharp = apex(centre, nose_mm, angle, entering);
    // A round insert has no corner for the head to end in: the head begins at its middle.
    let setback = if insert.form == Form::Round {
        nose_mm
    } else {
        SETBACK_MM + nose_mm * (1.0 - libm::sin(angle.to_radians() / 2.0))
    };
    let head = major.plus(minor).times(setback / libm::sin(angle.to_radians())).from(sharp);
    let reach = reach_mm(holder.shank_mm, holder.is_inside);
    // Along an edge of the head until it meets a line across; never further than the tool is long.
    let until_z = |way: Vector, z: f64| {
        let part = (z - head.z) / way.z;
        if part > 0.0 && part * way.length() < holder.length_mm { part } else { holder.length_mm / 2.0 }
    };
    let until_x = |way: Vector, x: f64| {
        let part = (x - head.x) / way.x;
        if part > 0.0 && part < holder.length_mm { part } else { holder.length_mm / 2.0 }
    };
    let corners = if holder.is_inside {
        let (under, over) = (reach - holder.shank_mm / 2.0, reach + holder.shank_mm / 2.0);
        let front = major.times(until_x(major, over)).from(head);
        let (back, length) = (minor.times(until_x(minor, under)).from(head), holder.length_mm);
        if under > head.x && back.z > front.z && back.z < length {
            vec![head, back, Point::new(under, length), Point::new(over, length), Point::new(over, front.z)]
        } else {
            vec![head, Point::new(head.x, length), Point::new(over, length), Point::new(over, front.z)]
        }
    } else {
        let (left, right) = if holder.is_neutral {
            (-holder.shank_mm / 2.0, holder.shank_mm / 2.0)
        } else {
            (major.times(HEAD_PART * insert.edge_mm()).from(head).z, reach)
        };
        let right_end = minor.times(until_z(minor, right)).from(head);
        let left_end = if holder.is_neutral {
            major.times(until_z(major, left)).from(head)
        } else {
            major.times(HEAD_PART * insert.edge_mm()).from(head)
        };
        let top = holder.length_mm.max(right_end.x + 1.0).max(left_end.x + 1.0);
        vec![head, right_end, Point::new(top, right_end.z), Point::new(top, left_end.z), left_end]
    };
    Outline::polygon(&corners).map(|drawing| stance.placed(drawing))
}

/// A blade with two cutting corners: a width, a reach, sides that lean back.
pub(super) fn blade(
    width_mm: f64,
    reach_mm: f64,
    clearance_deg: f64,
    nose_mm: f64,
    stance: Stance,
) -> Result<Outline, OutlineFault> {
    let left = blade_left(width_mm, nose_mm, stance);
    let lean = reach_mm * libm::tan(clearance_deg.to_radians());
    let bottom = stance.centre(nose_mm).x - nose_mm;
    let nose = nose_mm.min(width_mm / 2.0);
    let corners = [
        (Point::new(bottom, left), nose),
        (Point::new(bottom, left + width_mm), nose),
        corner(Point::new(bottom + reach_mm, left + width_mm - lean)),
        corner(Point::new(bottom + reach_mm, left + lean)),
    ];
    rounded(&corners).map(|drawing| stance.placed(drawing))
}

/// The Z of a blade's left side in the drawing.
fn blade_left(width_mm: f64, nose_mm: f64, stance: Stance) -> f64 {
    let along = if stance.is_face { stance.tip.0 } else { stance.tip.1 };
    if along == 0 { -width_mm / 2.0 } else { stance.centre(nose_mm).z - nose_mm }
}

/// What holds a blade or a threading insert: a block behind it, or a bar along Z.
pub(super) fn block(
    left_mm: f64,
    from_mm: f64,
    shank_mm: f64,
    length_mm: f64,
    is_bar: bool,
    stance: Stance,
) -> Result<Outline, OutlineFault> {
    let (low, high) = if is_bar {
        (Point::new(from_mm, left_mm), Point::new(from_mm + shank_mm, length_mm))
    } else {
        (Point::new(from_mm, left_mm), Point::new(from_mm + length_mm, left_mm + shank_mm))
    };
    Outline::rectangle(low, high).map(|drawing| stance.placed(drawing))
}

/// Where a blade's block begins along Z.
pub(super) fn block_left(width_mm: f64, nose_mm: f64, stance: Stance) -> f64 {
    blade_left(width_mm, nose_mm, stance) + SETBACK_MM.min(width_mm / 4.0)
}

/// A pointed insert for threads, as high as it is wide.
pub(super) fn pointed(
    angle_deg: f64,
    width_mm: f64,
    nose_mm: f64,
    stance: Stance,
) -> Result<Outline, OutlineFault> {
    let half = (angle_deg / 2.0).to_radians();
    let centre = stance.centre(nose_mm);
    let tip = Point::new(centre.x - nose_mm / libm::sin(half), centre.z);
    let height = width_mm / 2.0 / libm::tan(half);
    let corners = [
        (tip, nose_mm),
        corner(Point::new(tip.x + height, tip.z + width_mm / 2.0)),
        corner(Point::new(tip.x + height, tip.z - width_mm / 2.0)),
    ];
    rounded(&corners).map(|drawing| stance.placed(drawing))
}

/// A drill with its point at the programmed point: on both sides of its axis.
pub(super) fn drill(diameter_mm: f64, point_angle_deg: f64, length_mm: f64) -> Result<Outline, OutlineFault> {
    let radius = diameter_mm / 2.0;
    let cone = radius / libm::tan((point_angle_deg / 2.0).to_radians());
    let at = Point::new;
    if cone < 1e-6 {
        return Outline::rectangle(at(-radius, 0.0), at(radius, length_mm));
    }
    let length = length_mm.max(cone + 1.0);
    Outline::polygon(&[
        at(0.0, 0.0),
        at(-radius, cone),
        at(-radius, length),
        at(radius, length),
        at(radius, cone),
    ])
}

/// What holds a drill: a sleeve behind its flutes.
pub(super) fn sleeve(drill_mm: f64, flutes_mm: f64) -> Result<Outline, OutlineFault> {
    let radius = (drill_mm / 2.0 + 5.0).max(12.5);
    Outline::rectangle(Point::new(-radius, flutes_mm), Point::new(radius, flutes_mm + 60.0))
}
