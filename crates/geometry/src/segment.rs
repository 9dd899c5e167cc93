//! The elements of a path: lines and arcs.

use crate::Point;
use crate::vector::Vector;

/// The bend of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Centre of its circle.
    pub centre: Point,
    /// Clockwise, seen with Z to the right and X up.
    pub clockwise: bool,
}

/// A line or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it starts.
    pub start: Point,
    /// Where it ends.
    pub end: Point,
    /// `None` for a line.
    pub bend: Option<Bend>,
}

impl Bend {
    /// 1 when counter-clockwise, −1 when clockwise.
    pub(crate) fn sense(self) -> f64 {
        if self.clockwise { -1.0 } else { 1.0 }
    }

    /// With the centre as far from one place as from the other, next to a centre that is nearly so.
    #[must_use]
    pub fn evened(self, from: Point, to: Point) -> Self {
        let chord = Vector::between(from, to);
        let length = chord.length();
        // Places that are one have no middle between them.
        if length <= 1e-9 {
            return self;
        }
        let off = Vector::between(chord.times(0.5).from(from), self.centre);
        let along = off.dot(chord) / length;
        Self { centre: chord.times(-along / length).from(self.centre), ..self }
    }
}

impl Segment {
    pub(crate) fn radius(&self) -> f64 {
        self.bend.map_or(0.0, |bend| bend.centre.distance(self.start))
    }

    /// Direction of travel at a point of the element.
    pub(crate) fn tangent(&self, at: Point) -> Option<Vector> {
        match self.bend {
            None => Vector::between(self.start, self.end).unit(),
            Some(bend) => Vector::between(bend.centre, at).left().times(bend.sense()).unit(),
        }
    }

    /// Curvature, positive to the left, per mm.
    pub(crate) fn curvature(&self) -> f64 {
        self.bend.map_or(0.0, |bend| bend.sense() / self.radius())
    }

    /// Angle travelled about the centre between two points of an arc, 0 to a full turn.
    pub(crate) fn travelled(&self, bend: Bend, from: Point, to: Point) -> f64 {
        let angle = |point: Point| libm::atan2(point.x - bend.centre.x, point.z - bend.centre.z);
        let turned = ((angle(to) - angle(from)) * bend.sense()).rem_euclid(std::f64::consts::TAU);
        // Just short of a full turn is rounding: the points are one.
        if turned > std::f64::consts::TAU - 1e-9 { 0.0 } else { turned }
    }

    /// The whole angle of an arc; a closed one goes all the way round.
    pub(crate) fn sweep(&self, bend: Bend) -> f64 {
        match self.travelled(bend, self.start, self.end) {
            0.0 => std::f64::consts::TAU,
            sweep => sweep,
        }
    }

    /// Whether a point of the element's line or circle lies on the element, give or take `slack_mm`.
    pub(crate) fn holds(&self, point: Point, slack_mm: f64) -> bool {
        match self.bend {
            None => {
                let way = Vector::between(self.start, self.end);
                let length = way.length();
                let at = way.dot(Vector::between(self.start, point)) / length;
                at >= -slack_mm && at <= length + slack_mm
            }
            Some(bend) => {
                let slack_rad = slack_mm / self.radius();
                let travelled = self.travelled(bend, self.start, point);
                travelled <= self.sweep(bend) + slack_rad || travelled >= std::f64::consts::TAU - slack_rad
            }
        }
    }

    /// Distance of a point from the element, mm.
    pub fn distance(&self, point: Point) -> f64 {
        let to_ends = self.start.distance(point).min(self.end.distance(point));
        if !self.holds(point, 0.0) {
            return to_ends;
        }
        let across = match self.bend {
            None => {
                let way = Vector::between(self.start, self.end);
                way.cross(Vector::between(self.start, point)).abs() / way.length()
            }
            Some(bend) => (bend.centre.distance(point) - self.radius()).abs(),
        };
        // An element without length has no line.
        if across.is_finite() { across } else { to_ends }
    }

    /// The place after a part of the way, 0 to 1.
    pub fn at(&self, part: f64) -> Point {
        let Some(bend) = self.bend else {
            let way = Vector::between(self.start, self.end);
            return way.times(part).from(self.start);
        };
        let angle = self.sweep(bend) * bend.sense() * part;
        let arm = Vector::between(bend.centre, self.start);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let turned = Vector { z: arm.z * cosine - arm.x * sine, x: arm.z * sine + arm.x * cosine };
        turned.from(bend.centre)
    }

    /// Straight distance from one end to the point furthest from it, as far as distances grow steadily.
    pub(crate) fn reach(&self) -> f64 {
        match self.bend {
            None => self.start.distance(self.end),
            Some(bend) if self.sweep(bend) < std::f64::consts::PI => self.start.distance(self.end),
            Some(_) => 2.0 * self.radius(),
        }
    }

    /// The point at a straight distance from the element's start.
    pub(crate) fn ahead(&self, distance: f64) -> Point {
        self.away(self.start, distance, 1.0)
    }

    /// The point at a straight distance from the element's end.
    pub(crate) fn back(&self, distance: f64) -> Point {
        self.away(self.end, distance, -1.0)
    }

    pub(crate) fn away(&self, end: Point, distance: f64, way: f64) -> Point {
        let Some(bend) = self.bend else {
            let unit = Vector::between(self.start, self.end).unit();
            return unit.map_or(end, |unit| unit.times(way * distance).from(end));
        };
        let radius = self.radius();
        let angle = 2.0 * libm::asin((distance / (2.0 * radius)).min(1.0)) * bend.sense() * way;
        let arm = Vector::between(bend.centre, end);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let turned = Vector { z: arm.z * cosine - arm.x * sine, x: arm.z * sine + arm.x * cosine };
        turned.from(bend.centre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_end_where_the_element_does() {
        let line = Segment { start: Point::new(0.0, 0.0), end: Point::new(0.0, 4.0), bend: None };
        for (x, z, distance) in [(3.0, 2.0, 3.0), (-1.0, 0.0, 1.0), (3.0, 8.0, 5.0), (0.0, -2.0, 2.0)] {
            assert!((line.distance(Point::new(x, z)) - distance).abs() < 1e-12, "{x} {z}");
        }
        // A quarter about the origin, from +Z counter-clockwise to +X.
        let bend = Some(Bend { centre: Point::new(0.0, 0.0), clockwise: false });
        let arc = Segment { start: Point::new(0.0, 2.0), end: Point::new(2.0, 0.0), bend };
        for (x, z, distance) in
            [(3.0, 3.0, 18.0_f64.sqrt() - 2.0), (0.0, -1.0, 5.0_f64.sqrt()), (0.0, 5.0, 3.0)]
        {
            assert!((arc.distance(Point::new(x, z)) - distance).abs() < 1e-12, "{x} {z}");
        }
        let middle = arc.at(0.5);
        assert!((middle.x - 2.0_f64.sqrt()).abs() < 1e-12 && (middle.z - middle.x).abs() < 1e-12);
        let nothing = Segment { end: line.start, ..line };
        assert_eq!(nothing.distance(Point::new(3.0, 4.0)), 5.0);
    }
}
