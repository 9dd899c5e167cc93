//! Exact places to points of the plane, where geometry computes, and back.

use turnwright_geometry::Point;
use turnwright_units::{Diameter, Length, Position, Radius, WorkTip};

use crate::machine::Core;
use crate::report::Alarm;

/// The point of an exact place.
pub(crate) fn point(position: Position<WorkTip>) -> Point {
    Point::new(position.x.to_mm(), position.z.to_mm())
}

/// A computed place, to the nanometre: centres are not commanded and so not rounded to the increment.
pub(crate) fn place(point: Point) -> Option<Position<WorkTip>> {
    let nm = |mm: f64| (mm.abs() < 1e9).then(|| Length::from_nm((mm * 1e6).round() as i64));
    Some(Position::new(Radius(nm(point.x)?), nm(point.z)?))
}

/// The centre, moved so that both rounded ends lie on one circle. Ends so close together that this would take more
/// than their rounding leave it where it is.
pub(crate) fn between_ends(centre: Point, start: Point, end: Point, rounding_mm: f64) -> Point {
    let (z, x) = (end.z - start.z, end.x - start.x);
    let chord = z.hypot(x);
    let middle = Point::new((start.x + end.x) / 2.0, (start.z + end.z) / 2.0);
    let off = ((centre.z - middle.z) * z + (centre.x - middle.x) * x) / chord;
    if off.abs() <= rounding_mm {
        Point::new(centre.x - off * x / chord, centre.z - off * z / chord)
    } else {
        centre
    }
}

impl Core {
    /// A computed place that the tool is sent to: rounded to the least increment of the words, X as a diameter.
    pub(crate) fn snapped(&self, point: Point) -> Result<Position<WorkTip>, Alarm> {
        let increment = self.modal.increment(&self.settings);
        let x = Length::from_mm_rounded(2.0 * point.x, increment);
        let z = Length::from_mm_rounded(point.z, increment);
        match (x, z) {
            (Some(x), Some(z)) => self.in_range(Position::new(Diameter(x).to_radius(), z)),
            _ => Err(self.alarm_block("position-out-of-range")),
        }
    }
}
