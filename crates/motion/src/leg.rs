//! A leg: one block's way in the space of the axes.
//!
//! Straight lines of all axes, and arcs in one plane with the other axes spread evenly along them. In: places in mm
//! and degrees. Out: places and directions anywhere on the way, exact up to rounding.

use turnwright_geometry::Point;

use crate::dynamics::AXIS_COUNT;
use crate::path::ArcPath;

/// X (as a radius), Z, Y in mm, C and B in degrees, the virtual axis in mm.
pub type Place = [f64; AXIS_COUNT];

/// Index of X in a [`Place`].
pub const X: usize = 0;
/// Index of Z.
pub const Z: usize = 1;
/// Index of Y.
pub const Y: usize = 2;
/// Index of C.
pub const C: usize = 3;
/// Index of B.
pub const B: usize = 4;
/// Index of the virtual axis.
pub const V: usize = 5;

/// An arc in a plane of two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegArc {
    /// The axes that are right and up in the plane.
    pub(crate) axes: [usize; 2],
    pub(crate) path: ArcPath,
}

/// Where a way goes at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heading {
    /// How much each axis moves on the next millimetre.
    pub(crate) direction: Place,
    /// How the direction changes on the next millimetre.
    pub(crate) curvature: Place,
    /// It changes at all.
    pub(crate) is_bent: bool,
}

/// One block's way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    pub(crate) from: Place,
    pub(crate) to: Place,
    pub(crate) arc: Option<LegArc>,
    /// The length that feed is measured along, mm.
    pub(crate) length_mm: f64,
}

impl Leg {
    /// The place after a part (0 to 1) of the way. Both ends are exact.
    pub(crate) fn place(&self, part: f64) -> Place {
        if part >= 1.0 {
            return self.to;
        }
        let mut place = self.from;
        for (axis, to) in place.iter_mut().zip(self.to) {
            *axis += (to - *axis) * part;
        }
        if let Some(LegArc { axes: [right, up], path }) = &self.arc {
            let Point { x, z } = path.point(part);
            (place[*right], place[*up]) = (z, x);
        }
        place
    }

    /// Where it goes, at the start or the end.
    pub(crate) fn heading(&self, part: f64) -> Heading {
        let per_mm = 1.0 / self.length_mm;
        let direction = std::array::from_fn(|axis| (self.to[axis] - self.from[axis]) * per_mm);
        let mut heading = Heading { direction, curvature: Place::default(), is_bent: false };
        if let Some(LegArc { axes: [right, up], path }) = &self.arc {
            let (sine, cosine) = libm::sincos(path.start_rad + path.sweep_rad * part);
            let turning = path.sweep_rad * per_mm;
            let speed = turning * path.radius_at(part);
            (heading.direction[*right], heading.direction[*up]) = (-speed * sine, speed * cosine);
            let size = -turning * speed;
            (heading.curvature[*right], heading.curvature[*up]) = (size * cosine, size * sine);
            heading.is_bent = true;
        }
        heading
    }

    /// How near it comes to the axis of the spindle, mm.
    pub(crate) fn nearest_mm(&self) -> f64 {
        let (mut least, mut most) = (self.from[X].min(self.to[X]), self.from[X].max(self.to[X]));
        if let Some(LegArc { axes, path }) = &self.arc {
            let points = path.turning_points();
            for x in points.map(|point| if axes[0] == X { point.z } else { point.x }) {
                if axes.contains(&X) {
                    (least, most) = (least.min(x), most.max(x));
                }
            }
        }
        if least < 0.0 && most > 0.0 { 0.0 } else { least.abs().min(most.abs()) }
    }

    /// The smaller of the radii at both ends of an arc.
    pub(crate) fn radius_mm(&self) -> Option<f64> {
        self.arc.map(|arc| arc.path.start_radius_mm.min(arc.path.end_radius_mm))
    }
}
