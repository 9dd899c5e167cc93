//! The way of a cutting move: its length, and how far it reaches.

use std::f64::consts::TAU;

use turnwright_canon::{Shape, Turn};
use turnwright_geometry::{Point, sweep_rad};
use turnwright_units::{Length, Position, WorkTip};

/// A command's position as a point of the half-section, mm.
pub(crate) fn point(position: Position<WorkTip>) -> Point {
    Point::new(position.x.to_mm(), position.z.to_mm())
}

/// A computed place as an exact length, rounded to the nanometre.
pub(crate) fn length_from_mm(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// An arc in polar form about its centre. When start and end lie at different distances from the centre, the
/// distance changes evenly with the angle (a spiral); the hair's breadth of rounded centres is treated alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcPath {
    /// Centre of the circle, mm.
    pub centre: Point,
    /// Distance of the start from the centre, mm.
    pub start_radius_mm: f64,
    /// Distance of the end from the centre, mm.
    pub end_radius_mm: f64,
    /// Angle of the start, counter-clockwise from +Z, rad.
    pub start_rad: f64,
    /// Signed angle from start to end, rad; negative when clockwise, a full turn when the points coincide.
    pub sweep_rad: f64,
}

impl ArcPath {
    /// The arc between two points.
    pub fn new(
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        centre: Position<WorkTip>,
        turn: Turn,
    ) -> Self {
        Self::between(point(from), point(to), point(centre), turn == Turn::Clockwise)
    }

    /// The arc between two points of any plane; X is its upward, Z its rightward axis.
    pub(crate) fn between(start: Point, end: Point, centre: Point, clockwise: bool) -> Self {
        Self {
            centre,
            start_radius_mm: way_mm(start.x - centre.x, start.z - centre.z),
            end_radius_mm: way_mm(end.x - centre.x, end.z - centre.z),
            start_rad: libm::atan2(start.x - centre.x, start.z - centre.z),
            sweep_rad: sweep_rad(start, end, centre, clockwise),
        }
    }

    /// Distance from the centre after `share` (0 to 1) of the sweep, mm.
    pub(crate) fn radius_at(&self, share: f64) -> f64 {
        self.start_radius_mm + (self.end_radius_mm - self.start_radius_mm) * share
    }

    /// The point after `share` (0 to 1) of the sweep.
    pub(crate) fn point(&self, share: f64) -> Point {
        let (angle, radius) = (self.start_rad + self.sweep_rad * share, self.radius_at(share));
        Point::new(self.centre.x + radius * libm::sin(angle), self.centre.z + radius * libm::cos(angle))
    }

    /// Pieces of constant radius that stand for this arc: 1 for a circle.
    ///
    /// With a relative change of radius δ and pieces of angle h the time is wrong by about δ·h²/12.
    fn pieces(&self) -> u32 {
        let mean = (self.start_radius_mm + self.end_radius_mm) / 2.0;
        let change = (self.end_radius_mm - self.start_radius_mm).abs();
        if change <= mean * 1e-12 {
            return 1;
        }
        let ratio = change / mean;
        let pieces = (self.sweep_rad.abs() * (ratio / 12e-6).sqrt()).max(ratio * 512.0);
        (pieces.ceil() as u32).clamp(1, 4096)
    }

    /// The circular pieces of the arc, in order.
    pub(crate) fn circles(self) -> impl Iterator<Item = Circle> {
        let count = self.pieces();
        let share = 1.0 / f64::from(count);
        let growth_mm_per_rad = (self.end_radius_mm - self.start_radius_mm) / self.sweep_rad;
        (0..count).map(move |index| {
            let radius_mm = self.radius_at((f64::from(index) + 0.5) * share);
            Circle {
                centre_x_mm: self.centre.x,
                radius_mm,
                path_mm_per_rad: libm::hypot(radius_mm, growth_mm_per_rad),
                start_rad: self.start_rad + self.sweep_rad * share * f64::from(index),
                sweep_rad: self.sweep_rad * share,
            }
        })
    }

    /// Length of the path, mm.
    pub fn length_mm(&self) -> f64 {
        if self.pieces() == 1 {
            let growth_mm = self.end_radius_mm - self.start_radius_mm;
            return way_mm(self.radius_at(0.5) * self.sweep_rad, growth_mm);
        }
        self.circles().map(|circle| circle.path_mm_per_rad * circle.sweep_rad.abs()).sum()
    }

    /// The points where the arc turns round in X or Z, ends not included: at most four.
    pub fn turning_points(&self) -> impl Iterator<Item = Point> {
        let arc = *self;
        (0..4).filter_map(move |quarter| {
            let angle = f64::from(quarter) * (TAU / 4.0);
            let way = way_to(arc.start_rad, arc.sweep_rad, angle);
            (way < arc.sweep_rad.abs()).then(|| {
                let radius = arc.radius_at(way / arc.sweep_rad.abs());
                let (z, x) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][quarter as usize];
                Point::new(arc.centre.x + radius * x, arc.centre.z + radius * z)
            })
        })
    }
}

/// How near the arcs that stand for an ellipse or a parabola stay to it, mm.
const CURVE_TOLERANCE_MM: f64 = 1e-5;

/// A stretch of a cutting move: straight or one arc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub(crate) start: Point,
    pub(crate) end: Point,
    pub(crate) arc: Option<ArcPath>,
}

impl Stretch {
    pub(crate) fn length_mm(&self) -> f64 {
        let (start, end) = (self.start, self.end);
        self.arc.map_or_else(|| way_mm(end.x - start.x, end.z - start.z), |arc| arc.length_mm())
    }
}

/// Length of a way in two directions, mm. Ways of programs are far from the sizes at which squares would overflow.
pub(crate) fn way_mm(x_mm: f64, z_mm: f64) -> f64 {
    (x_mm * x_mm + z_mm * z_mm).sqrt()
}

/// The way of a cutting move in the section, measured once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutPath {
    pub(crate) start: Point,
    pub(crate) end: Point,
    pub(crate) arc: Option<ArcPath>,
    /// An ellipse or a parabola: measured as arcs.
    pub(crate) is_curve: bool,
    pub(crate) length_mm: f64,
}

impl CutPath {
    pub(crate) fn new(from: Position<WorkTip>, to: Position<WorkTip>, shape: &Shape) -> Self {
        let (start, end) = (point(from), point(to));
        let straight_mm = way_mm(end.x - start.x, end.z - start.z);
        let (arc, is_curve, length_mm) = match shape {
            // Of an arc across the section the path sees the chord.
            Shape::Line | Shape::SideArc { .. } => (None, false, straight_mm),
            Shape::Arc { turn, centre } => {
                let arc = ArcPath::between(start, end, point(*centre), *turn == Turn::Clockwise);
                (Some(arc), false, arc.length_mm())
            }
            Shape::Curve(_) => (None, true, stretches(from, to, shape).map(|piece| piece.length_mm()).sum()),
        };
        Self { start, end, arc, is_curve, length_mm }
    }
}

/// The stretches of a cutting move, in order: one, or for an ellipse and a parabola as many as it takes.
pub(crate) fn stretches(
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    shape: &Shape,
) -> impl Iterator<Item = Stretch> {
    let (start, end) = (point(from), point(to));
    let (single, curve) = match shape {
        // Of an arc across the section the path sees the chord.
        Shape::Line | Shape::SideArc { .. } => (Some(Stretch { start, end, arc: None }), None),
        Shape::Arc { turn, centre } => {
            (Some(Stretch { start, end, arc: Some(ArcPath::new(from, to, *centre, *turn)) }), None)
        }
        Shape::Curve(curve) => (None, Some(curve.path(from, to).arcs(CURVE_TOLERANCE_MM))),
    };
    let pieces = curve.into_iter().flatten().scan(start, |start, piece| {
        let bend = piece.bend;
        let arc = bend.map(|bend| ArcPath::between(*start, piece.end, bend.centre, bend.clockwise));
        Some(Stretch { start: std::mem::replace(start, piece.end), end: piece.end, arc })
    });
    single.into_iter().chain(pieces)
}

/// A piece of a circle, for integrals over X: x = centre + radius · sin(angle).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    /// X of the centre, mm of radius.
    pub(crate) centre_x_mm: f64,
    /// Radius, mm.
    pub(crate) radius_mm: f64,
    /// Path per angle, mm per rad: the radius, more when the piece stands for a part of a spiral.
    pub(crate) path_mm_per_rad: f64,
    /// Angle of the start, rad.
    pub(crate) start_rad: f64,
    /// Signed angle, rad.
    pub(crate) sweep_rad: f64,
}

/// How far a sweep has gone, rad and not negative, when it first reaches `angle`; 0 to a full turn.
pub(crate) fn way_to(start_rad: f64, sweep_rad: f64, angle: f64) -> f64 {
    let way = if sweep_rad < 0.0 { start_rad - angle } else { angle - start_rad };
    let way = way % TAU;
    if way < 0.0 { way + TAU } else { way }
}
