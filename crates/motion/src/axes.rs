//! The ways of the axes beyond X and Z, and moves in virtual planes.
//!
//! A cutting move of a rotary axis together with lengths takes its feed along the root of all squares, degrees
//! counted as the lengths that [`OtherAxes::per_degree`] names; that is what controls do. In polar and
//! cylindrical interpolation the feed is that of the virtual path, and the rotary axis only follows.

use turnwright_canon::{Interpolation, OtherAxes, Shape, SidePlane, Turn};
use turnwright_geometry::Point;
use turnwright_units::{Angle, Length, Position, WorkTip};

use crate::leg::{B, C, Place, V, Y};
use crate::path::ArcPath;
use crate::{Dynamics, MachineRates};

/// Where the axes beyond X and Z are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AxisPlaces {
    c: Angle,
    b: Angle,
    y: Length,
    v: Length,
}

/// What the other axes add to a move.
pub(crate) struct AxisWay {
    /// Length of the path, mm, degrees left out.
    pub(crate) length_mm: f64,
    /// Length that the feed is measured along, mm.
    pub(crate) feed_mm: f64,
    /// Minutes below which an axis would be too fast; `None` when its rate is no rate.
    pub(crate) minutes_min: Option<f64>,
}

impl AxisPlaces {
    /// Their places among those of all axes; X and Z are not known here.
    pub(crate) fn places(&self) -> Place {
        [0.0, 0.0, self.y.to_mm(), self.c.to_degrees(), self.b.to_degrees(), self.v.to_mm()]
    }

    /// New meaning of the coordinates; the virtual axis begins where the next move or the rotary axis says.
    pub(crate) fn interpolate(&mut self, interpolation: Interpolation) {
        self.v = match interpolation {
            Interpolation::Cylindrical { radius } => Interpolation::unrolled(radius, self.c),
            Interpolation::Normal | Interpolation::Polar { .. } => Length::ZERO,
        };
    }

    /// Follows a move or a change of coordinates.
    pub(crate) fn follow(&mut self, others: &OtherAxes) {
        self.c = others.c.unwrap_or(self.c);
        self.b = others.b.unwrap_or(self.b);
        self.y = others.y.unwrap_or(self.y);
        self.v = others.v.unwrap_or(self.v);
    }

    /// Way along the side axis, mm.
    fn side_mm(&self, others: &OtherAxes) -> f64 {
        let y = others.y.map_or(0.0, |y| (y - self.y).to_mm());
        let v = others.v.map_or(0.0, |v| (v - self.v).to_mm());
        libm::hypot(y, v)
    }

    fn degrees(from: Angle, to: Option<Angle>) -> f64 {
        to.map_or(0.0, |to| (to - from).to_degrees().abs())
    }

    /// A cutting move whose way in X and Z is `length_mm`.
    pub(crate) fn cut(
        &self,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        shape: &Shape,
        length_mm: f64,
        others: &OtherAxes,
        rates: &MachineRates,
    ) -> AxisWay {
        let length_mm = match shape {
            Shape::SideArc { plane, turn, centre } => {
                let place = |at: Position<WorkTip>, side: Option<Length>, present: Length| {
                    let (right, up) = plane.right_and_up(plane.point(at, side.unwrap_or(present)));
                    Point::new(up, right)
                };
                let present = if others.v.is_some() { self.v } else { self.y };
                let (right, up) = plane.right_and_up(*centre);
                let arc = ArcPath::between(
                    place(from, None, present),
                    place(to, others.side(), present),
                    Point::new(up, right),
                    *turn == Turn::Clockwise,
                );
                let outside = match plane {
                    SidePlane::Face => to.z - from.z,
                    SidePlane::Flank | SidePlane::Wall => to.x.0 - from.x.0,
                };
                libm::hypot(arc.length_mm(), outside.to_mm())
            }
            _ => libm::hypot(length_mm, self.side_mm(others)),
        };
        let per_degree = others.per_degree.to_mm();
        let c_degrees = Self::degrees(self.c, others.c);
        let b = Self::degrees(self.b, others.b) * per_degree;
        // The rotary axis of a virtual plane follows the path; it is no way of its own.
        let c = if others.v.is_some() { 0.0 } else { c_degrees * per_degree };
        AxisWay {
            length_mm,
            feed_mm: libm::hypot(length_mm, libm::hypot(c, b)),
            minutes_min: at_rate(c_degrees, rates.cutting_max_c_deg_per_min)
                .zip(at_rate(length_mm, rates.cutting_max_mm_per_min))
                .map(|(turning, moving)| turning.max(moving)),
        }
    }

    /// A rapid move whose way in X and Z is `length_mm`.
    pub(crate) fn rapid(
        &self,
        length_mm: f64,
        others: &OtherAxes,
        rates: &Place,
        dynamics: Option<&Dynamics>,
    ) -> AxisWay {
        let side_mm = self.side_mm(others);
        let length_mm = libm::hypot(length_mm, side_mm);
        let side = if others.v.is_some() { V } else { Y };
        let minutes_min =
            [(side, side_mm), (C, Self::degrees(self.c, others.c)), (B, Self::degrees(self.b, others.b))]
                .map(|(axis, way)| match dynamics {
                    Some(dynamics) if way > 0.0 => dynamics.axes[axis].minutes(way, rates[axis]),
                    _ => at_rate(way, rates[axis]),
                })
                .into_iter()
                .try_fold(0.0, |longest: f64, minutes| Some(longest.max(minutes?)));
        AxisWay { length_mm, feed_mm: length_mm, minutes_min }
    }
}

/// Minutes for a way at a rate; no way takes no time at any rate.
fn at_rate(way: f64, per_minute: f64) -> Option<f64> {
    if way == 0.0 {
        Some(0.0)
    } else {
        Some(way / per_minute).filter(|minutes| minutes.is_finite() && *minutes > 0.0)
    }
}
