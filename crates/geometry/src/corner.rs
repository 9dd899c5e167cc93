//! Corners between two elements of a path: a fillet that touches both, or a straight chamfer.
//!
//! The elements are lines or arcs; the first ends where the second starts, at the unbroken corner. What comes
//! out is where the first element now ends, where the second now starts, and how the way between runs.
//!
//! A fillet lies on the side that the path turns to and has both elements as tangents. A chamfer takes the same
//! straight distance from the corner on both elements.

use crate::Point;

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

/// How a corner is broken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Breaking {
    /// A tangent arc with this radius, mm.
    Fillet(f64),
    /// A straight chamfer that starts this far before the corner, mm.
    ChamferFromCorner(f64),
    /// A straight chamfer of this length, mm.
    ChamferOfLength(f64),
}

/// A corner that was broken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// New end of the first element.
    pub from: Point,
    /// New start of the second element.
    pub to: Point,
    /// The bend of a fillet, `None` for a chamfer.
    pub bend: Option<Bend>,
}

/// Why a corner could not be broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerFault {
    /// The elements go on in one direction, or straight back: there is no corner.
    Straight,
    /// What would be cut off is longer than an element.
    TooLong,
}

/// A vector of the half-section.
#[derive(Clone, Copy)]
struct Vector {
    x: f64,
    z: f64,
}

impl Vector {
    fn between(from: Point, to: Point) -> Self {
        Self { x: to.x - from.x, z: to.z - from.z }
    }

    fn length(self) -> f64 {
        self.x.hypot(self.z)
    }

    /// With length 1; nothing when it has no length.
    fn unit(self) -> Option<Self> {
        let length = self.length();
        (length > 0.0).then(|| self.times(1.0 / length))
    }

    fn times(self, factor: f64) -> Self {
        Self { x: self.x * factor, z: self.z * factor }
    }

    /// Turned a quarter counter-clockwise.
    fn left(self) -> Self {
        Self { x: self.z, z: -self.x }
    }

    fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.z * other.z
    }

    /// Positive when `other` points to the left.
    fn cross(self, other: Self) -> f64 {
        self.z * other.x - self.x * other.z
    }

    fn from(self, point: Point) -> Point {
        Point { x: point.x + self.x, z: point.z + self.z }
    }
}

impl Bend {
    /// 1 when counter-clockwise, −1 when clockwise.
    fn sense(self) -> f64 {
        if self.clockwise { -1.0 } else { 1.0 }
    }
}

impl Segment {
    fn radius(&self) -> f64 {
        self.bend.map_or(0.0, |bend| bend.centre.distance(self.start))
    }

    /// Direction of travel at a point of the element.
    fn tangent(&self, at: Point) -> Option<Vector> {
        match self.bend {
            None => Vector::between(self.start, self.end).unit(),
            Some(bend) => Vector::between(bend.centre, at).left().times(bend.sense()).unit(),
        }
    }

    /// Curvature, positive to the left, per mm.
    fn curvature(&self) -> f64 {
        self.bend.map_or(0.0, |bend| bend.sense() / self.radius())
    }

    /// Angle travelled about the centre between two points of an arc, 0 to a full turn.
    fn travelled(&self, bend: Bend, from: Point, to: Point) -> f64 {
        let angle = |point: Point| libm::atan2(point.x - bend.centre.x, point.z - bend.centre.z);
        let turned = ((angle(to) - angle(from)) * bend.sense()).rem_euclid(std::f64::consts::TAU);
        // Just short of a full turn is rounding: the points are one.
        if turned > std::f64::consts::TAU - 1e-9 { 0.0 } else { turned }
    }

    /// The whole angle of an arc; a closed one goes all the way round.
    fn sweep(&self, bend: Bend) -> f64 {
        match self.travelled(bend, self.start, self.end) {
            0.0 => std::f64::consts::TAU,
            sweep => sweep,
        }
    }

    /// Whether a point of the element's line or circle lies on the element, give or take `slack_mm`.
    fn holds(&self, point: Point, slack_mm: f64) -> bool {
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

    /// Straight distance from one end to the point furthest from it, as far as distances grow steadily.
    fn reach(&self) -> f64 {
        match self.bend {
            None => self.start.distance(self.end),
            Some(bend) if self.sweep(bend) < std::f64::consts::PI => self.start.distance(self.end),
            Some(_) => 2.0 * self.radius(),
        }
    }

    /// The point at a straight distance from the element's start.
    fn ahead(&self, distance: f64) -> Point {
        self.away(self.start, distance, 1.0)
    }

    /// The point at a straight distance from the element's end.
    fn back(&self, distance: f64) -> Point {
        self.away(self.end, distance, -1.0)
    }

    fn away(&self, end: Point, distance: f64, way: f64) -> Point {
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

/// Breaks the corner between two elements.
///
/// Elements whose directions differ by no more than `straight_rad` have no corner; what is cut off may be longer
/// than the element by `slack_mm` (the rounding of its ends).
///
/// # Errors
/// [`CornerFault`] when there is no corner, or no room.
pub fn break_corner(
    first: &Segment,
    second: &Segment,
    breaking: Breaking,
    straight_rad: f64,
    slack_mm: f64,
) -> Result<Corner, CornerFault> {
    let (Some(inward), Some(outward)) = (first.tangent(first.end), second.tangent(second.start)) else {
        return Err(CornerFault::TooLong);
    };
    let cross = inward.cross(outward);
    let is_cusp = cross.abs() < libm::sin(straight_rad);
    // At a cusp the path turns to the side that its second element lies on.
    let opening = first.curvature() + second.curvature();
    if is_cusp && (inward.dot(outward) > 0.0 || opening == 0.0) {
        return Err(CornerFault::Straight);
    }
    let left = if is_cusp { opening < 0.0 } else { cross > 0.0 };
    match breaking {
        Breaking::Fillet(radius) => fillet(first, second, radius, left, slack_mm),
        Breaking::ChamferFromCorner(distance) => chamfer(first, second, distance, slack_mm),
        Breaking::ChamferOfLength(length) => {
            let distance = chamfer_distance(first, second, length, slack_mm)?;
            chamfer(first, second, distance, slack_mm)
        }
    }
}

fn chamfer(first: &Segment, second: &Segment, distance: f64, slack_mm: f64) -> Result<Corner, CornerFault> {
    if distance > first.reach() + slack_mm || distance > second.reach() + slack_mm {
        return Err(CornerFault::TooLong);
    }
    Ok(Corner { from: first.back(distance), to: second.ahead(distance), bend: None })
}

/// The distance from the corner at which a chamfer has a length.
fn chamfer_distance(
    first: &Segment,
    second: &Segment,
    length: f64,
    slack_mm: f64,
) -> Result<f64, CornerFault> {
    // Halvings of the interval: far below a nanometre for any path that fits a machine.
    const HALVINGS: usize = 60;
    if first.bend.is_none()
        && second.bend.is_none()
        && let (Some(inward), Some(outward)) = (first.tangent(first.end), second.tangent(second.start))
    {
        let sum = Vector { x: inward.x + outward.x, z: inward.z + outward.z };
        return Ok(length / sum.length());
    }
    let wide = |distance: f64| first.back(distance).distance(second.ahead(distance));
    let (mut low, mut high) = (0.0, first.reach().min(second.reach()) + slack_mm);
    if wide(high) < length {
        return Err(CornerFault::TooLong);
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if wide(middle) < length { low = middle } else { high = middle }
    }
    Ok(high)
}

fn fillet(
    first: &Segment,
    second: &Segment,
    radius: f64,
    left: bool,
    slack_mm: f64,
) -> Result<Corner, CornerFault> {
    let side = if left { radius } else { -radius };
    let (Some(a), Some(b)) = (Track::beside(first, side), Track::beside(second, side)) else {
        return Err(CornerFault::TooLong);
    };
    let corner = first.end;
    a.crossings(&b)
        .into_iter()
        .flatten()
        .map(|centre| (a.touch(centre), b.touch(centre), centre))
        .filter(|(from, to, _)| first.holds(*from, slack_mm) && second.holds(*to, slack_mm))
        .min_by(|one, other| {
            let cut = |(from, to, _): &(Point, Point, Point)| from.distance(corner) + to.distance(corner);
            cut(one).total_cmp(&cut(other))
        })
        .map(|(from, to, centre)| Corner { from, to, bend: Some(Bend { centre, clockwise: !left }) })
        .ok_or(CornerFault::TooLong)
}

/// Where the centres of fillets that touch an element lie: beside a line, or round the centre of an arc.
enum Track {
    Straight { through: Point, along: Vector, side: f64 },
    Round { centre: Point, radius: f64, touch_radius: f64 },
}

impl Track {
    /// Beside an element, `side` to its left; `None` where a fillet finds no room inside an arc.
    fn beside(segment: &Segment, side: f64) -> Option<Self> {
        match segment.bend {
            None => {
                let along = Vector::between(segment.start, segment.end).unit()?;
                let through = along.left().times(side).from(segment.start);
                Some(Self::Straight { through, along, side })
            }
            Some(bend) => {
                let touch_radius = segment.radius();
                let radius = touch_radius - bend.sense() * side;
                (radius > 0.0).then_some(Self::Round { centre: bend.centre, radius, touch_radius })
            }
        }
    }

    /// Where a fillet about `centre` touches the element.
    fn touch(&self, centre: Point) -> Point {
        match *self {
            Self::Straight { along, side, .. } => along.left().times(-side).from(centre),
            Self::Round { centre: middle, radius, touch_radius } => {
                Vector::between(middle, centre).times(touch_radius / radius).from(middle)
            }
        }
    }

    fn crossings(&self, other: &Self) -> [Option<Point>; 2] {
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

#[cfg(test)]
mod tests {
    use super::*;

    const NEAR: f64 = 1e-9;
    const STRAIGHT: f64 = 0.001;

    fn point(x: f64, z: f64) -> Point {
        Point::new(x, z)
    }

    fn line(start: Point, end: Point) -> Segment {
        Segment { start, end, bend: None }
    }

    fn arc(start: Point, end: Point, centre: Point, clockwise: bool) -> Segment {
        Segment { start, end, bend: Some(Bend { centre, clockwise }) }
    }

    fn near(one: Point, other: Point) -> bool {
        one.distance(other) < NEAR
    }

    fn broken(first: &Segment, second: &Segment, breaking: Breaking) -> Result<Corner, CornerFault> {
        break_corner(first, second, breaking, STRAIGHT, NEAR)
    }

    #[test]
    fn a_right_angle_is_rounded_by_a_quarter() {
        // Facing outward, then along Z into the chuck: X0 to X20, then to Z-25, with 5 mm.
        let corner = broken(
            &line(point(0., 0.), point(10., 0.)),
            &line(point(10., 0.), point(10., -25.)),
            Breaking::Fillet(5.),
        )
        .expect("room");
        assert!(near(corner.from, point(5., 0.)) && near(corner.to, point(10., -5.)), "{corner:?}");
        let bend = corner.bend.expect("an arc");
        assert!(near(bend.centre, point(5., -5.)) && !bend.clockwise, "{bend:?}");
    }

    #[test]
    fn a_chamfer_is_given_by_its_legs_or_by_its_length() {
        let (first, second) = (line(point(0., 0.), point(10., 0.)), line(point(10., 0.), point(10., -25.)));
        let legs = broken(&first, &second, Breaking::ChamferFromCorner(2.)).expect("room");
        assert!(near(legs.from, point(8., 0.)) && near(legs.to, point(10., -2.)), "{legs:?}");
        let length = broken(&first, &second, Breaking::ChamferOfLength(2.0 * 2f64.sqrt())).expect("room");
        assert!(near(length.from, legs.from) && near(length.to, legs.to), "{length:?}");
    }

    #[test]
    fn a_fillet_between_a_line_and_an_arc_touches_both() {
        // Along Z to the corner, then out on a ball of 10 mm about its centre beyond.
        let first = line(point(6., 10.), point(6., -2.));
        let second = arc(point(6., -2.), point(10., -10.), point(0., -10.), true);
        for radius in [0.1, 0.5, 1.0] {
            let corner = broken(&first, &second, Breaking::Fillet(radius)).expect("room");
            let bend = corner.bend.expect("an arc");
            assert!((bend.centre.distance(corner.from) - radius).abs() < NEAR);
            assert!((bend.centre.distance(corner.to) - radius).abs() < NEAR);
            assert!((corner.from.x - 6.).abs() < NEAR && (corner.from.z - bend.centre.z).abs() < NEAR);
            // On the ball, and the centres are as far apart as the radii tell.
            assert!((corner.to.distance(point(0., -10.)) - 10.).abs() < NEAR);
            let apart = bend.centre.distance(point(0., -10.));
            assert!(
                (apart - (10. + radius)).abs() < NEAR || (apart - (10. - radius)).abs() < NEAR,
                "{apart}"
            );
        }
    }

    #[test]
    fn a_fillet_between_two_arcs_touches_both() {
        // Two bulges of 10 mm side by side, cut from right to left, with a notch between them.
        let first = arc(point(10., 0.), point(8., -6.), point(0., 0.), false);
        let second = arc(point(8., -6.), point(10., -12.), point(0., -12.), false);
        let corner = broken(&first, &second, Breaking::Fillet(1.0)).expect("room");
        let bend = corner.bend.expect("an arc");
        assert!(bend.clockwise, "a notch turns back");
        assert!((bend.centre.distance(point(0., 0.)) - 11.).abs() < NEAR);
        assert!((bend.centre.distance(point(0., -12.)) - 11.).abs() < NEAR);
        assert!((corner.from.distance(point(0., 0.)) - 10.).abs() < NEAR);
        assert!((corner.to.distance(point(0., -12.)) - 10.).abs() < NEAR);
    }

    #[test]
    fn a_chamfer_on_arcs_takes_the_same_straight_distance() {
        let first = arc(point(10., 0.), point(8., -6.), point(0., 0.), false);
        let second = line(point(8., -6.), point(20., -6.));
        let corner = broken(&first, &second, Breaking::ChamferFromCorner(1.5)).expect("room");
        assert!((corner.from.distance(point(8., -6.)) - 1.5).abs() < NEAR);
        assert!((corner.from.distance(point(0., 0.)) - 10.).abs() < NEAR);
        assert!(near(corner.to, point(9.5, -6.)));
        let length = broken(&first, &second, Breaking::ChamferOfLength(2.)).expect("room");
        assert!((length.from.distance(length.to) - 2.).abs() < NEAR);
        let (one, other) = (length.from.distance(point(8., -6.)), length.to.distance(point(8., -6.)));
        assert!((one - other).abs() < NEAR);
    }

    #[test]
    fn no_corner_and_no_room_are_told_apart() {
        let first = line(point(0., 0.), point(10., 0.));
        let straight_on = line(point(10., 0.), point(20., 0.));
        let back = line(point(10., 0.), point(5., 0.));
        let short = line(point(10., 0.), point(10., -1.));
        for breaking in [Breaking::Fillet(2.), Breaking::ChamferFromCorner(2.), Breaking::ChamferOfLength(4.)]
        {
            assert_eq!(broken(&first, &straight_on, breaking), Err(CornerFault::Straight));
            assert_eq!(broken(&first, &back, breaking), Err(CornerFault::Straight));
            assert_eq!(broken(&first, &short, breaking), Err(CornerFault::TooLong));
        }
        // As long as the line itself is allowed.
        assert!(broken(&first, &short, Breaking::Fillet(1.)).is_ok());
        // A line that runs into an arc as its tangent.
        let along = line(point(10., 5.), point(10., 0.));
        let into = arc(point(10., 0.), point(5., -5.), point(5., 0.), false);
        assert_eq!(broken(&along, &into, Breaking::Fillet(1.)), Err(CornerFault::Straight));
    }

    #[test]
    fn an_arc_that_turns_back_on_its_line_leaves_a_tongue_that_is_rounded() {
        // Outward in X, then back inward on an arc that has the line as its tangent.
        let first = line(point(0., 0.), point(10., 0.));
        let second = arc(point(10., 0.), point(5., -5.), point(10., -5.), true);
        let corner = broken(&first, &second, Breaking::Fillet(0.1)).expect("room");
        let bend = corner.bend.expect("an arc");
        assert!((bend.centre.distance(corner.from) - 0.1).abs() < NEAR);
        assert!((bend.centre.distance(corner.to) - 0.1).abs() < NEAR);
        assert!((corner.to.distance(point(10., -5.)) - 5.).abs() < NEAR, "{corner:?}");
    }
}
