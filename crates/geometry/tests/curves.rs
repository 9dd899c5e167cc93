//! Laws of curves on seeded random input: equations are checked in their own words, not by the code under test.

use std::f64::consts::{PI, TAU};

use turnwright_dice::Dice;
use turnwright_geometry::{
    Bend, Conic, CurvePath, Point, circle_through, ellipse_centre, parabola_vertex, sweep_rad,
};

fn place(dice: &mut Dice) -> Point {
    Point::new(dice.between(-50.0, 150.0), dice.between(-300.0, 50.0))
}

/// Along and across a direction, from `origin`: the frame of a conic, written out once more.
fn seen_from(origin: Point, tilt_rad: f64, place: Point) -> (f64, f64) {
    let (z, x) = (place.z - origin.z, place.x - origin.x);
    (z * tilt_rad.cos() + x * tilt_rad.sin(), -z * tilt_rad.sin() + x * tilt_rad.cos())
}

/// The way round of three places that follow one another: twice the signed area, positive counter-clockwise.
fn area(a: Point, b: Point, c: Point) -> f64 {
    (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z)
}

const SHARES: [f64; 9] = [0.05, 0.15, 0.3, 0.45, 0.5, 0.6, 0.75, 0.9, 0.98];

/// What every path owes: its ends to the last bit, its turn, and arcs that join up and stay near it.
fn check_path(path: &CurvePath, (start, end): (Point, Point), clockwise: bool, tolerance_mm: f64) {
    assert_eq!((path.point_at(0.0), path.point_at(1.0)), (start, end));
    let turn = area(start, path.point_at(0.5), end);
    assert!((turn < 0.0) == clockwise, "{path:?}: turn {turn}");
    let pieces: Vec<_> = path.arcs(tolerance_mm).collect();
    let mut at = start;
    for piece in &pieces {
        if let Some(Bend { centre, clockwise: turns }) = piece.bend {
            let (begins, ends) = (centre.distance(at), centre.distance(piece.end));
            assert!((begins - ends).abs() < 1e-6 * begins.max(1.0), "{begins} {ends}");
            assert_eq!(turns, clockwise, "a conic bends one way only");
        }
        at = piece.end;
    }
    assert_eq!(at, end);
    // Places of the curve against the nearest arc, found without its parameter.
    for step in 1..100 {
        let place = path.point_at(f64::from(step) / 100.0);
        let mut from = start;
        let mut nearest = f64::INFINITY;
        for piece in &pieces {
            nearest = nearest.min(distance_to(place, from, piece.end, piece.bend));
            from = piece.end;
        }
        assert!(nearest <= tolerance_mm, "{path:?}: {} arcs, {nearest}", pieces.len());
    }
}

fn distance_to(place: Point, from: Point, to: Point, bend: Option<Bend>) -> f64 {
    let ends = place.distance(from).min(place.distance(to));
    match bend {
        Some(Bend { centre, clockwise }) => {
            let whole = sweep_rad(from, to, centre, clockwise).abs();
            let part = sweep_rad(from, place, centre, clockwise).abs();
            if part <= whole { (place.distance(centre) - centre.distance(from)).abs() } else { ends }
        }
        None => {
            let (z, x) = (to.z - from.z, to.x - from.x);
            let share = ((place.z - from.z) * z + (place.x - from.x) * x) / (z * z + x * x);
            if (0.0..=1.0).contains(&share) { area(from, to, place).abs() / z.hypot(x) } else { ends }
        }
    }
}

#[test]
fn ellipses_satisfy_their_equation() {
    let mut dice = Dice::new(5);
    let mut made = 0;
    while made < 1_000 {
        let (start, end) = (place(&mut dice), place(&mut dice));
        let (along, across) = (dice.between(0.5, 200.0), dice.between(0.5, 200.0));
        let (tilt, clockwise) = (dice.between(-PI, TAU), dice.one_in(2));
        let Ok(centre) = ellipse_centre(start, end, (along, across), tilt, clockwise, 0.0) else { continue };
        made += 1;
        let conic = Conic::Ellipse { along_mm: along, across_mm: across };
        let path = CurvePath::new(start, end, conic, centre, tilt, clockwise);
        for share in SHARES.into_iter().chain([0.0, 1.0]) {
            let (u, v) = seen_from(centre, tilt, path.point_at(share));
            let one = (u / along).powi(2) + (v / across).powi(2);
            assert!((one - 1.0).abs() < 1e-9, "{path:?} at {share}: {one}");
        }
        // At most half of it: the start seen through the centre is not passed.
        let (u0, v0) = seen_from(centre, tilt, start);
        let (u1, v1) = seen_from(centre, tilt, end);
        let turned = (u0 / along) * (v1 / across) - (v0 / across) * (u1 / along);
        assert!(if clockwise { turned <= 1e-9 } else { turned >= -1e-9 }, "{path:?}: {turned}");
        check_path(&path, (start, end), clockwise, if made % 2 == 0 { 1e-3 } else { 1e-5 });
    }
}

#[test]
fn parabolas_satisfy_their_equation() {
    let mut dice = Dice::new(7);
    let mut made = 0;
    while made < 1_000 {
        let (start, end) = (place(&mut dice), place(&mut dice));
        let (parameter, tilt) = (dice.between(0.5, 300.0), dice.between(-PI, TAU));
        let clockwise = dice.one_in(2);
        let Some((vertex, opens_back)) = parabola_vertex(start, end, parameter, tilt, clockwise) else {
            continue;
        };
        // A chord nearly along the axis reaches far out; the equation is checked where digits are left.
        if vertex.distance(start) > 1e4 {
            continue;
        }
        made += 1;
        let opening = if opens_back { tilt + PI } else { tilt };
        let conic = Conic::Parabola { focal_parameter_mm: parameter };
        let path = CurvePath::new(start, end, conic, vertex, opening, clockwise);
        for share in SHARES.into_iter().chain([0.0, 1.0]) {
            let (u, v) = seen_from(vertex, opening, path.point_at(share));
            let gap = v * v - 2.0 * parameter * u;
            assert!(gap.abs() < 1e-8 * (v * v + parameter * u.abs()).max(1.0), "{path:?} at {share}: {gap}");
        }
        check_path(&path, (start, end), clockwise, if made % 2 == 0 { 1e-3 } else { 1e-4 });
    }
}

#[test]
fn circles_pass_through_their_three_points_in_order() {
    let mut dice = Dice::new(11);
    for _ in 0..20_000 {
        let (start, middle, end) = (place(&mut dice), place(&mut dice), place(&mut dice));
        if area(start, middle, end).abs() < 10.0 {
            continue;
        }
        let (centre, clockwise) = circle_through(start, middle, end).expect("no line");
        let radius = centre.distance(start);
        for place in [middle, end] {
            assert!((centre.distance(place) - radius).abs() < 1e-6 * radius.max(1.0));
        }
        let whole = sweep_rad(start, end, centre, clockwise).abs();
        let part = sweep_rad(start, middle, centre, clockwise).abs();
        assert!(part < whole, "{start:?} {middle:?} {end:?}");
    }
}
