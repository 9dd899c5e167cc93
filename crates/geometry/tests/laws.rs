//! Laws of broken corners on dice paths: fillets touch both elements, chamfers are as long as asked for.

use turnwright_dice::Dice;
use turnwright_geometry::{Bend, Breaking, Corner, CornerFault, Point, Segment, break_corner};

fn point(dice: &mut Dice) -> Point {
    Point::new(dice.between(0.0, 50.0), dice.between(-80.0, 20.0))
}

/// An element between two points: a line, or an arc of less than three quarters of a turn.
fn element(dice: &mut Dice, start: Point, end: Point) -> Segment {
    let kind = dice.between(0.0, 3.0);
    if kind < 1.0 {
        return Segment { start, end, bend: None };
    }
    let half = start.distance(end) / 2.0;
    let rise = dice.between(-0.4, 3.0) * half;
    let (z, x) = ((end.z - start.z) / (2.0 * half), (end.x - start.x) / (2.0 * half));
    let clockwise = kind < 2.0;
    let side = if clockwise { -rise } else { rise };
    let centre = Point::new((start.x + end.x) / 2.0 + side * z, (start.z + end.z) / 2.0 - side * x);
    Segment { start, end, bend: Some(Bend { centre, clockwise }) }
}

/// How far a point is from the line or circle of an element.
fn off(element: &Segment, point: Point) -> f64 {
    match element.bend {
        Some(bend) => (bend.centre.distance(point) - bend.centre.distance(element.start)).abs(),
        None => {
            let (z, x) = (element.end.z - element.start.z, element.end.x - element.start.x);
            ((point.z - element.start.z) * x - (point.x - element.start.x) * z).abs() / z.hypot(x)
        }
    }
}

/// The direction of travel at a point, as the angle from +Z.
fn heading(element: &Segment, at: Point) -> f64 {
    match element.bend {
        None => (element.end.x - element.start.x).atan2(element.end.z - element.start.z),
        Some(bend) => {
            let arm = (at.x - bend.centre.x).atan2(at.z - bend.centre.z);
            arm + std::f64::consts::FRAC_PI_2 * if bend.clockwise { -1.0 } else { 1.0 }
        }
    }
}

fn differ(one: f64, other: f64) -> f64 {
    let turned = (one - other).rem_euclid(std::f64::consts::TAU);
    turned.min(std::f64::consts::TAU - turned)
}

const NEAR_MM: f64 = 1e-6;

fn check_fillet(first: &Segment, second: &Segment, radius: f64, corner: &Corner) {
    let bend = corner.bend.expect("a fillet is an arc");
    let arc = Segment { start: corner.from, end: corner.to, bend: Some(bend) };
    for (element, touch) in [(first, corner.from), (second, corner.to)] {
        assert!(off(element, touch) < NEAR_MM, "{first:?} {second:?} {corner:?}");
        assert!((bend.centre.distance(touch) - radius).abs() < NEAR_MM);
        // The same heading on both sides of the joint: no kink.
        assert!(
            differ(heading(element, touch), heading(&arc, touch)) < 1e-5,
            "{first:?} {second:?} {corner:?}"
        );
    }
}

#[test]
fn random_corners_are_broken_as_asked_for() {
    let mut dice = Dice::new(20_261_122);
    let (mut fillets, mut chamfers, mut refused) = (0, 0, 0);
    for _ in 0..20_000 {
        let (start, corner_point, end) = (point(&mut dice), point(&mut dice), point(&mut dice));
        let first = element(&mut dice, start, corner_point);
        let second = element(&mut dice, corner_point, end);
        let size = dice.between(0.05, 20.0);
        for breaking in
            [Breaking::Fillet(size), Breaking::ChamferFromCorner(size), Breaking::ChamferOfLength(size)]
        {
            match (break_corner(&first, &second, breaking, 0.01, 1e-9), breaking) {
                (Ok(corner), Breaking::Fillet(radius)) => {
                    check_fillet(&first, &second, radius, &corner);
                    fillets += 1;
                }
                (Ok(corner), Breaking::ChamferFromCorner(distance)) => {
                    for (element, point) in [(&first, corner.from), (&second, corner.to)] {
                        assert!(off(element, point) < NEAR_MM);
                        assert!((point.distance(corner_point) - distance).abs() < NEAR_MM);
                    }
                    chamfers += 1;
                }
                (Ok(corner), Breaking::ChamferOfLength(length)) => {
                    assert!((corner.from.distance(corner.to) - length).abs() < NEAR_MM);
                    let legs = [corner.from, corner.to].map(|point| point.distance(corner_point));
                    assert!((legs[0] - legs[1]).abs() < NEAR_MM);
                    chamfers += 1;
                }
                (Err(CornerFault::TooLong | CornerFault::Straight), _) => refused += 1,
            }
        }
    }
    // The law holds for something.
    assert!(fillets > 5_000 && chamfers > 10_000 && refused > 1_000, "{fillets} {chamfers} {refused}");
}

#[test]
fn a_corner_and_its_way_back_are_the_same() {
    let turned = |element: &Segment| Segment {
        start: element.end,
        end: element.start,
        bend: element.bend.map(|bend| Bend { clockwise: !bend.clockwise, ..bend }),
    };
    let mut dice = Dice::new(7);
    let mut compared = 0;
    for _ in 0..5_000 {
        let (start, corner, end) = (point(&mut dice), point(&mut dice), point(&mut dice));
        let (first, second) = (element(&mut dice, start, corner), element(&mut dice, corner, end));
        let radius = dice.between(0.05, 10.0);
        let forth = break_corner(&first, &second, Breaking::Fillet(radius), 0.01, 1e-9);
        let back = break_corner(&turned(&second), &turned(&first), Breaking::Fillet(radius), 0.01, 1e-9);
        if let (Ok(forth), Ok(back)) = (forth, back) {
            assert!(forth.from.distance(back.to) < NEAR_MM && forth.to.distance(back.from) < NEAR_MM);
            compared += 1;
        }
    }
    assert!(compared > 1_000, "{compared}");
}
