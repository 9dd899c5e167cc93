//! Plane geometry of the half-section.
//!
//! In and out: `f64` millimetres, X as a radius. Every approximation takes its tolerance as an argument.
//! Deliberately not here: frames, words, control state, rounding to increments.
//!
//! The plane is seen with Z to the right and X up; angles are counter-clockwise from +Z.

mod arc;
mod corner;
mod curve;
mod line;
mod offset;
mod outline;
mod segment;
mod track;
mod vector;

pub use arc::{ArcFault, centre_from_radius, sweep_rad};
pub use corner::{Breaking, Corner, CornerFault, break_corner};
pub use curve::{Conic, CurveArc, CurveArcs, CurvePath, circle_through, ellipse_centre, parabola_vertex};
pub use line::Line;
pub use offset::{Joint, JointFault, Joints, Offset, Side, StartUp};
pub use outline::{Bounds, CORNER_MM, OUTLINE_MM_MAX, OUTLINE_SEGMENTS_MAX, Outline, OutlineFault};
pub use segment::{Bend, Segment};
pub use vector::Vector;

/// A place in the half-section.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Point {
    /// Distance from the spindle axis, mm (radius).
    pub x: f64,
    /// Distance along the spindle axis, mm.
    pub z: f64,
}

impl Point {
    /// A place.
    pub const fn new(x: f64, z: f64) -> Self {
        Self { x, z }
    }

    /// Straight distance to another place, mm.
    ///
    /// Lengths of a lathe neither overflow nor vanish when squared, and a square root is the same on every machine.
    #[inline]
    pub fn distance(self, other: Self) -> f64 {
        Vector::between(other, self).length()
    }
}
