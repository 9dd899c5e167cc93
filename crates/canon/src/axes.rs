//! Axes beyond X and Z, and moves in a plane that only exists in the control.
//!
//! A *side axis* stands across both X and Z: the Y axis of the machine, or, while [`Interpolation`] says so, a
//! virtual axis that the rotary axis stands for. Moves then carry the place on it exactly, as the program gave
//! it; [`Interpolation::axes_at`] is the one way from there to where X and the rotary axis really are.
//!
//! Invariants: boxes of [`OtherAxes`] are only made for moves that take such an axis along; angles of the
//! rotary axis count on over full turns.

use turnwright_units::{Angle, Length, Position, Radius, WorkTip};

use crate::{Action, Shape, Turn};

/// Ends of the axes beyond X and Z in a move; `None` for one that stays where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OtherAxes {
    /// The rotary axis about Z. Where `v` is given too, this angle follows from it.
    pub c: Option<Angle>,
    /// The linear axis across X and Z.
    pub y: Option<Length>,
    /// The rotary axis about Y.
    pub b: Option<Angle>,
    /// The virtual axis of polar or cylindrical interpolation.
    pub v: Option<Length>,
    /// Way of one degree in the feed of this move: feed counts `c` (without `v`) and `b` as lengths, a degree
    /// as a millimetre, in inch input as an inch.
    pub per_degree: Length,
}

impl OtherAxes {
    /// The place on the side axis, virtual or real.
    pub fn side(&self) -> Option<Length> {
        self.v.or(self.y)
    }
}

/// A plane that holds the side axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SidePlane {
    /// Across the spindle: X to the right, side axis up.
    Face,
    /// Along the spindle: side axis to the right, Z up.
    Flank,
    /// As `Flank`, but seen from the other side: Z to the right, side axis up.
    Wall,
}

/// A place in a [`SidePlane`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SidePoint {
    /// Place on X (as a radius) in the plane [`SidePlane::Face`], else on Z.
    pub along: Length,
    /// Place on the side axis.
    pub side: Length,
}

impl SidePlane {
    /// A position as a point of this plane.
    pub const fn point(self, position: Position<WorkTip>, side: Length) -> SidePoint {
        match self {
            Self::Face => SidePoint { along: position.x.0, side },
            Self::Flank | Self::Wall => SidePoint { along: position.z, side },
        }
    }

    /// The millimetres of a point to the right and up.
    pub fn right_and_up(self, point: SidePoint) -> (f64, f64) {
        match self {
            Self::Face | Self::Wall => (point.along.to_mm(), point.side.to_mm()),
            Self::Flank => (point.side.to_mm(), point.along.to_mm()),
        }
    }
}

/// A coupling of another rotation to the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpeedRatio {
    /// Turns of the spindle ...
    pub spindle: u32,
    /// ... for so many turns of the other; negative against the usual direction.
    pub other: i32,
}

/// What the coordinates of moves mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// X, Z and the other axes themselves.
    #[default]
    Normal,
    /// X and the virtual axis are a plane across the spindle, with its zero on the spindle axis; the rotary axis
    /// and X make its points.
    Polar {
        /// Where the rotary axis stands when the virtual axis is at zero.
        zero: Angle,
        /// X stays below the spindle axis.
        is_below: bool,
    },
    /// The virtual axis runs round a cylinder about Z; feeds are those on its surface.
    Cylindrical {
        /// Of the cylinder.
        radius: Radius,
    },
}

impl Interpolation {
    /// Place on the virtual axis of a cylinder where the rotary axis stands at `angle`: the way round its
    /// surface, rounded to the nanometre.
    pub fn unrolled(radius: Radius, angle: Angle) -> Length {
        Length::from_nm((radius.to_mm() * angle.to_radians() * 1e6).round() as i64)
    }

    /// Where X and the rotary axis really are at the end of a move to `to` and `v`; `before` is the angle at its
    /// start. Computed, and rounded once to the nanometre and the billionth of a degree.
    ///
    /// Along a line, and along an arc beside the spindle axis, the rotary axis turns by less than half a turn;
    /// along an arc around the spindle axis it follows the arc.
    pub fn axes_at(
        self,
        to: Position<WorkTip>,
        v: Length,
        shape: &Shape,
        before: Angle,
    ) -> (Position<WorkTip>, Angle) {
        match self {
            Self::Normal => (to, before),
            Self::Cylindrical { radius } => {
                let radius_mm = radius.to_mm();
                let turned = if radius_mm > 0.0 { v.to_mm() / radius_mm } else { 0.0 };
                (to, Angle::from_radians_rounded(turned))
            }
            Self::Polar { zero, is_below } => {
                let sign = if is_below { -1.0 } else { 1.0 };
                let (x_mm, v_mm) = (to.x.to_mm(), v.to_mm());
                let radius_mm = sign * libm::hypot(x_mm, v_mm);
                let place = Position::new(Radius(Length::from_nm((radius_mm * 1e6).round() as i64)), to.z);
                if to.x.0.is_zero() && v.is_zero() {
                    return (place, before);
                }
                let direction = zero + Angle::from_radians_rounded(libm::atan2(sign * v_mm, sign * x_mm));
                (place, turn_to(direction, before, shape, to, v))
            }
        }
    }
}

/// Follows commands and knows where moves end in the section: at which distance from the spindle axis, at which
/// Z. That differs from the end point in polar interpolation only.
#[derive(Clone, Copy, Debug, Default)]
pub struct SectionPlace {
    interpolation: Interpolation,
    v: Length,
}

impl SectionPlace {
    /// The end of a move in the section, `None` for everything else.
    #[inline]
    pub fn end_of(&mut self, action: &Action) -> Option<Position<WorkTip>> {
        if let Action::Interpolation(interpolation) = action {
            *self = Self { interpolation: *interpolation, v: Length::ZERO };
        }
        let to = action.end_point()?;
        Some(if self.is_polar() { self.polar_end(action, to) } else { to })
    }

    /// Whether end points are places of a plane across the spindle.
    pub const fn is_polar(&self) -> bool {
        matches!(self.interpolation, Interpolation::Polar { .. })
    }

    #[cold]
    fn polar_end(&mut self, action: &Action, to: Position<WorkTip>) -> Position<WorkTip> {
        self.v = action.others().and_then(|others| others.v).unwrap_or(self.v);
        self.interpolation.axes_at(to, self.v, &Shape::Line, Angle::ZERO).0
    }
}

/// The angle of `direction` that a polar move reaches.
fn turn_to(direction: Angle, before: Angle, shape: &Shape, to: Position<WorkTip>, v: Length) -> Angle {
    let around = match shape {
        Shape::SideArc { plane: SidePlane::Face, turn, centre } => {
            let (x_mm, side_mm) = (centre.along.to_mm(), centre.side.to_mm());
            let radius_mm = libm::hypot(to.x.to_mm() - x_mm, v.to_mm() - side_mm);
            (libm::hypot(x_mm, side_mm) < radius_mm).then_some(*turn)
        }
        _ => None,
    };
    // Below a thousandth of a degree the two angles are one, and the arc a full circle.
    let full = |way: Angle| if way.millidegrees() == 0 { Angle::TURN } else { way };
    match around {
        None => direction.nearest_to(before, Angle::TURN),
        Some(Turn::CounterClockwise) => before + full((direction - before).within(Angle::TURN)),
        Some(Turn::Clockwise) => before - full((before - direction).within(Angle::TURN)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(radius_mm: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_mm(radius_mm)), Length::ZERO)
    }

    fn degrees(degrees: i64) -> Angle {
        Angle::from_millidegrees(degrees * 1_000)
    }

    const POLAR: Interpolation = Interpolation::Polar { zero: Angle::ZERO, is_below: false };

    #[test]
    fn the_corners_of_a_square_about_the_spindle_axis() {
        // Half side 20: corners at 20·√2 = 28.284271 and 45, 135, 225, 315 degrees.
        let mut angle = Angle::ZERO;
        for (x, v, expected) in [(20, 20, 45), (-20, 20, 135), (-20, -20, 225), (20, -20, 315), (20, 0, 360)]
        {
            let (place, c) = POLAR.axes_at(at(x), Length::from_mm(v), &Shape::Line, angle);
            assert_eq!(c, degrees(expected));
            assert_eq!(place.x.0.nm(), if v == 0 { 20_000_000 } else { 28_284_271 });
            angle = c;
        }
    }

    #[test]
    fn arcs_around_the_spindle_axis_are_followed_and_arcs_beside_it_are_not() {
        let arc = |turn, along, side| Shape::SideArc {
            plane: SidePlane::Face,
            turn,
            centre: SidePoint { along: Length::from_mm(along), side: Length::from_mm(side) },
        };
        let around = arc(Turn::CounterClockwise, 0, 0);
        let half = POLAR.axes_at(at(-10), Length::ZERO, &around, Angle::ZERO);
        assert_eq!(half, (at(10), degrees(180)));
        assert_eq!(POLAR.axes_at(at(10), Length::ZERO, &around, Angle::ZERO).1, degrees(360));
        let back = arc(Turn::Clockwise, 0, 0);
        assert_eq!(POLAR.axes_at(at(0), Length::from_mm(10), &back, degrees(0)).1, degrees(-270));
        // A full circle beside the axis comes back to the same angle.
        let beside = arc(Turn::CounterClockwise, 40, 0);
        assert_eq!(POLAR.axes_at(at(30), Length::ZERO, &beside, Angle::ZERO).1, Angle::ZERO);
    }

    #[test]
    fn below_the_spindle_axis_x_stays_there() {
        let below = Interpolation::Polar { zero: degrees(90), is_below: true };
        let start = below.axes_at(at(-20), Length::ZERO, &Shape::Line, degrees(90));
        assert_eq!(start, (at(-20), degrees(90)));
        let (place, c) = below.axes_at(at(0), Length::from_mm(-20), &Shape::Line, degrees(90));
        assert_eq!((place, c), (at(-20), degrees(180)));
    }

    #[test]
    fn on_a_cylinder_the_way_is_the_angle_times_the_radius() {
        // 2·π·57.29577951 = 360 to nine digits: one degree is one millimetre.
        let radius = Radius(Length::from_nm(57_295_780));
        let (_, c) = Interpolation::Cylindrical { radius }.axes_at(
            at(57),
            Length::from_mm(30),
            &Shape::Line,
            Angle::ZERO,
        );
        assert_eq!(c.millidegrees(), 30_000);
    }
}
