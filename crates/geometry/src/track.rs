//! Where a circle may roll along an element.

use crate::vector::Vector;
use crate::{Point, Segment};

/// Where the centres of circles that touch an element lie: beside a line, or round the centre of an arc.
pub(crate) enum Track {
    Straight { through: Point, along: Vector, side: f64 },
    Round { centre: Point, radius: f64, touch_radius: f64 },
}

impl Track {
    /// Beside an element, `side` to its left; `None` where a circle finds no room inside an arc.
    pub(crate) fn beside(segment: &Segment, side: f64) -> Option<Self> {
        Self::through(segment, segment.start, side).filter(|track| match track {
            Self::Straight { .. } => true,
            Self::Round { radius, .. } => *radius > 0.0,
        })
    }

    /// As [`Track::beside`], of an arc that is taken to pass through `at`; its radius may be zero or less.
    pub(crate) fn through(segment: &Segment, at: Point, side: f64) -> Option<Self> {
        match segment.bend {
            None => {
                let along = Vector::between(segment.start, segment.end).unit()?;
                let through = along.left().times(side).from(segment.start);
                Some(Self::Straight { through, along, side })
            }
            Some(bend) => {
                let touch_radius = bend.centre.distance(at);
                let radius = touch_radius - bend.sense() * side;
                Some(Self::Round { centre: bend.centre, radius, touch_radius })
            }
        }
    }

    /// Where a circle about `centre` touches the element.
    pub(crate) fn touch(&self, centre: Point) -> Point {
        match *self {
            Self::Straight { along, side, .. } => along.left().times(-side).from(centre),
            Self::Round { centre: middle, radius, touch_radius } => {
                Vector::between(middle, centre).times(touch_radius / radius).from(middle)
            }
        }
    }

    pub(crate) fn crossings(&self, other: &Self) -> [Option<Point>; 2] {
        match (self, other) {
            (Self::Straight { through, along, .. }, Self::Straight { through: b, along: other, .. }) => {
                let way = Vector::between(*through, *b).cross(*other) / along.cross(*other);
                [way.is_finite().then(|| along.times(way).from(*through)), None]
            }
            (Self::Straight { through, along, .. }, Self::Round { centre, radius, .. })
            | (Self::Round { centre, radius, .. }, Self::Straight { through, along, .. }) => {
                let foot = along.times(along.dot(Vector::between(*through, *centre))).from(*through);
                on_both_sides(foot, *along, *radius, foot.distance(*centre))
            }
            (
                Self::Round { centre, radius, .. },
                Self::Round { centre: other_centre, radius: other_radius, .. },
            ) => {
                let across = Vector::between(*centre, *other_centre);
                let distance = across.length();
                let Some(across) = across.unit() else { return [None; 2] };
                let foot_way =
                    (distance * distance + radius * radius - other_radius * other_radius) / (2.0 * distance);
                on_both_sides(across.times(foot_way).from(*centre), across.left(), *radius, foot_way)
            }
        }
    }
}

impl Track {
    /// Where two tracks come nearest to each other, when they miss by no more than `gap_mm`.
    pub(crate) fn nearly_meets(&self, other: &Self, gap_mm: f64) -> Option<Point> {
        match (self, other) {
            (Self::Straight { .. }, Self::Straight { .. }) => None,
            (Self::Straight { through, along, .. }, Self::Round { centre, radius, .. })
            | (Self::Round { centre, radius, .. }, Self::Straight { through, along, .. }) => {
                let foot = along.times(along.dot(Vector::between(*through, *centre))).from(*through);
                (foot.distance(*centre) - radius.abs() <= gap_mm).then_some(foot)
            }
            (
                Self::Round { centre, radius, .. },
                Self::Round { centre: other_centre, radius: other_radius, .. },
            ) => {
                let across = Vector::between(*centre, *other_centre);
                let (distance, unit) = (across.length(), across.unit()?);
                let apart = distance - (radius + other_radius);
                let inside = (radius - other_radius).abs() - distance;
                let way = if inside > apart && other_radius > radius { -radius } else { *radius };
                (apart.max(inside) <= gap_mm).then(|| unit.times(way).from(*centre))
            }
        }
    }
}

/// The points of a circle at `radius` whose middle lies `offset` away from `foot`, along a line through it.
fn on_both_sides(foot: Point, along: Vector, radius: f64, offset: f64) -> [Option<Point>; 2] {
    let squared = radius * radius - offset * offset;
    // A line that just touches the circle may miss it by the rounding of the numbers.
    if squared < -1e-9 * radius * radius {
        return [None; 2];
    }
    let half = squared.max(0.0).sqrt();
    [Some(along.times(half).from(foot)), Some(along.times(-half).from(foot))]
}
