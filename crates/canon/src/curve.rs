//! Cuts that are neither straight nor circular.
//!
//! In: exact data of a conic. Out: [`Curve`], and its [`CurvePath`] between two positions, which consumers turn into
//! arcs within a tolerance of their own. The frame is that of the command: Z to the right, X up as a radius.

use turnwright_geometry::{Conic, CurvePath, Point};
use turnwright_units::{Angle, Length, Position, WorkTip};

use crate::Turn;

/// A part of an ellipse or a parabola. Start and end of the cut are exact; centre and vertex are computed and
/// rounded to the nanometre, and the hair's breadth between them is spread evenly over the cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// `(u / half_along)² + (v / half_across)² = 1` about the centre, where u runs along the tilt and v a quarter
    /// turn counter-clockwise from it. The part between start and end is at most half of it.
    Ellipse {
        /// Which way, seen with Z to the right and X up.
        turn: Turn,
        /// Its centre.
        centre: Position<WorkTip>,
        /// Half axis along the tilt.
        half_along: Length,
        /// Half axis across the tilt.
        half_across: Length,
        /// From +Z to the axis of `half_along`, counter-clockwise, 0 to below 180 degrees.
        tilt: Angle,
    },
    /// `v² = 2 · focal_parameter · u` from the vertex, u along the tilt and v a quarter turn counter-clockwise
    /// from it: the parabola opens along the tilt.
    Parabola {
        /// Which way, seen with Z to the right and X up: clockwise is towards growing v.
        turn: Turn,
        /// Its vertex.
        vertex: Position<WorkTip>,
        /// From focus to directrix, more than zero.
        focal_parameter: Length,
        /// From +Z to the axis, counter-clockwise, 0 to below 360 degrees.
        tilt: Angle,
    },
}

impl Curve {
    /// Which way the cut turns.
    pub const fn turn(&self) -> Turn {
        match self {
            Self::Ellipse { turn, .. } | Self::Parabola { turn, .. } => *turn,
        }
    }

    /// The part between two positions, in millimetres.
    pub fn path(&self, from: Position<WorkTip>, to: Position<WorkTip>) -> CurvePath {
        let point = |place: Position<WorkTip>| Point::new(place.x.to_mm(), place.z.to_mm());
        let (conic, origin, tilt) = match self {
            Self::Ellipse { centre, half_along, half_across, tilt, .. } => {
                let (along_mm, across_mm) = (half_along.to_mm(), half_across.to_mm());
                (Conic::Ellipse { along_mm, across_mm }, *centre, tilt)
            }
            Self::Parabola { vertex, focal_parameter, tilt, .. } => {
                (Conic::Parabola { focal_parameter_mm: focal_parameter.to_mm() }, *vertex, tilt)
            }
        };
        let clockwise = self.turn() == Turn::Clockwise;
        CurvePath::new(point(from), point(to), conic, point(origin), tilt.to_radians(), clockwise)
    }
}

impl Turn {
    /// The turn of a way round that is clockwise or not.
    pub const fn clockwise_if(is_clockwise: bool) -> Self {
        if is_clockwise { Self::Clockwise } else { Self::CounterClockwise }
    }
}
