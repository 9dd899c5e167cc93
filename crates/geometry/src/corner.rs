//! Corners between two elements of a path: a fillet that touches both, or a straight chamfer.
//!
//! The elements are lines or arcs; the first ends where the second starts, at the unbroken corner. What comes
//! out is where the first element now ends, where the second now starts, and how the way between runs.
//!
//! A fillet lies on the side that the path turns to and has both elements as tangents. A chamfer takes the same
//! straight distance from the corner on both elements.

use crate::track::Track;
use crate::vector::Vector;
use crate::{Bend, Point, Segment};

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
