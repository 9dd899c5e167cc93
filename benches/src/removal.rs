//! Material removal beside a polyline library with true arcs (goals R1, R3 and R4).
//!
//! The job: a half-section of 100 by 50 mm, and passes of many ways of 0.1 mm of a tool with a nose of 0.4 mm along a
//! wavy line, each pass deeper than the one before. The same swept shapes are subtracted here and there, and the areas
//! compared.

use std::sync::LazyLock;
use std::time::Instant;

use cavalier_contours::polyline::{BooleanOp, PlineSource, PlineSourceMut, Polyline};
use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_stock::{Cutter, Section, Sweep};

use crate::board::Board;

const RADIUS_MM: f64 = 50.0;
const STEP_MM: f64 = 0.1;
const NOSE_MM: f64 = 0.4;
const HEIGHT_MM: f64 = 60.0;
const DEPTH_MM: f64 = 2.0;
/// How often both sides are timed in turn.
const ROUNDS: usize = 5;

/// Times both, and prints ways a second and what the areas differ by.
pub fn run(ways: usize, passes: usize, board: &mut Board) -> Result<(), String> {
    println!("{passes} passes of {ways} ways each");
    let (insert_per_s, _) = ours(&insert()?, ways, passes, STEP_MM)?;
    println!("an insert with edges of 12 mm: {insert_per_s:.0} ways/s");
    let finger = finger()?;
    let (mut rates, mut their_rates, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let (mut section, mut their_mm2) = (Section::default(), 0.0);
    for _ in 0..ROUNDS {
        let (per_s, left) = ours(&finger, ways, passes, STEP_MM)?;
        let (their_per_s, their_left_mm2) = theirs(ways, passes)?;
        rates.push(per_s);
        their_rates.push(their_per_s);
        ratios.push(per_s / their_per_s);
        (section, their_mm2) = (left, their_left_mm2);
    }
    let (per_s, their_per_s, ratio) = (median(rates), median(their_rates), median(ratios));
    let off = (section.area_mm2() / their_mm2 - 1.0).abs();
    println!(
        "a nose with upright sides: {per_s:.0} ways/s, {} slabs, {:.9} mm²",
        section.slab_count(),
        section.area_mm2()
    );
    println!("cavalier_contours: {their_per_s:.0} ways/s, {their_mm2:.9} mm²");
    println!("R1 {ratio:.1} times as fast (floor 20, goal 50); R4 areas differ by {off:.1e} (goal 1e-9)");
    board.note("R1", ratio);
    board.note("R4", off);
    for (goal, name, of_peer) in [
        ("R2 geo", "geo", with_geo as fn(usize, usize) -> f64),
        ("R2 i_overlay", "i_overlay", with_i_overlay),
    ] {
        let peer_per_s = of_peer(ways, passes);
        println!(
            "{name}, chords: {peer_per_s:.0} ways/s: {:.0} times as fast (goal 150)",
            per_s / peer_per_s
        );
        board.note(goal, per_s / peer_per_s);
    }
    Ok(())
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// How much slower a way is in a section of many edges than in one of few (R3).
pub fn growth(ways: usize, passes: usize, board: &mut Board) -> Result<(), String> {
    let finger = finger()?;
    let (few, _) = ours(&finger, ways / 100, passes, STEP_MM)?;
    let (many, section) = ours(&finger, ways, passes, STEP_MM)?;
    let (fine, _) = ours(&finger, ways, passes, STEP_MM / 10.0)?;
    println!(
        "R3 {} ways: {few:.0} ways/s; {} ways: {many:.0} ways/s, {} slabs; {:.2} of the rate (floor 0.3, goal 0.8)",
        ways / 100 * passes,
        ways * passes,
        section.slab_count(),
        many / few
    );
    board.note("R3", many / few);
    println!("as many ten times as close together: {fine:.0} ways/s");
    Ok(())
}

/// Seconds that this program was busy, whatever else the machine did; without Linux's counter, those since the first call.
fn busy_s() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let counter = std::fs::read_to_string("/proc/self/schedstat").ok();
    let busy_ns = counter.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    busy_ns.map_or_else(|| START.elapsed().as_secs_f64(), |ns| ns / 1e9)
}

/// The places of a pass, from the face inwards.
fn places(ways: usize, pass: usize, step_mm: f64) -> impl Iterator<Item = Point> {
    (0..=ways).map(move |index| {
        // No two passes share a Z: the peer loses shapes whose upright sides lie on each other.
        let z = -step_mm * (index as f64 - 0.037 * pass as f64);
        let wave = 0.25 * (z * 1.3 + pass as f64).sin() + 0.1 * (z * 7.1).sin();
        Point::new(RADIUS_MM - DEPTH_MM * (pass + 1) as f64 + wave, z)
    })
}

/// A nose with upright sides, from its centre.
pub fn finger() -> Result<Outline, String> {
    let (left, right) = (Point::new(0.0, -NOSE_MM), Point::new(0.0, NOSE_MM));
    let (top_left, top_right) = (Point::new(HEIGHT_MM, -NOSE_MM), Point::new(HEIGHT_MM, NOSE_MM));
    let bend = Some(Bend { centre: Point::new(0.0, 0.0), clockwise: false });
    let line = |start, end| Segment { start, end, bend: None };
    Outline::new(vec![
        Segment { start: left, end: right, bend },
        line(right, top_right),
        line(top_right, top_left),
        line(top_left, left),
    ])
    .map_err(|fault| format!("{fault:?}"))
}

/// An insert of 80 degrees with edges of 12 mm, from its nose centre, its main edge at 95 degrees to the axis.
pub fn insert() -> Result<Outline, String> {
    let ray = |degrees: f64, length: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Point::new(length * sine, length * cosine)
    };
    let plus = |a: Point, b: Point| Point::new(a.x + b.x, a.z + b.z);
    // Edges at 5 and 85 degrees from +Z, outwards.
    let (low, high) = (ray(-85.0, NOSE_MM), ray(175.0, NOSE_MM));
    let (low_end, high_end) = (plus(low, ray(5.0, 12.0)), plus(high, ray(85.0, 12.0)));
    let back = plus(low_end, ray(85.0, 12.0));
    let bend = Some(Bend { centre: Point::new(0.0, 0.0), clockwise: false });
    let line = |start, end| Segment { start, end, bend: None };
    Outline::new(vec![
        Segment { start: high, end: low, bend },
        line(low, low_end),
        line(low_end, back),
        line(back, high_end),
        line(high_end, high),
    ])
    .map_err(|fault| format!("{fault:?}"))
}

fn ours(outline: &Outline, ways: usize, passes: usize, step_mm: f64) -> Result<(f64, Section), String> {
    let cutter = Cutter::new(outline);
    let mut section =
        Section::bar(RADIUS_MM, -step_mm * ways as f64, 0.0).map_err(|fault| format!("{fault:?}"))?;
    let mut sweep = Sweep::new();
    let ways: Vec<Vec<Point>> = (0..passes).map(|pass| places(ways, pass, step_mm).collect()).collect();
    let blank = section.clone();
    let (begin, mut rounds) = (busy_s(), 0);
    let mut removed_mm2 = 0.0;
    // The counter moves in steps of some milliseconds.
    while rounds == 0 || busy_s() - begin < 0.2 {
        section.clone_from(&blank);
        removed_mm2 = 0.0;
        for pass in &ways {
            for pair in pass.windows(2) {
                removed_mm2 += section.cut(sweep.line(&cutter, pair[0], pair[1])).area_mm2;
            }
        }
        rounds += 1;
    }
    let seconds = (busy_s() - begin) / f64::from(rounds);
    let whole_mm2 = blank.area_mm2();
    let lost = (section.area_mm2() + removed_mm2) / whole_mm2 - 1.0;
    if lost.abs() > 1e-9 {
        return Err(format!("what was taken and what is left differ from the whole by {lost:e}"));
    }
    Ok((passes as f64 * (ways[0].len() - 1) as f64 / seconds, section))
}

fn theirs(ways: usize, passes: usize) -> Result<(f64, f64), String> {
    let mut bar = Polyline::new_closed();
    let length_mm = STEP_MM * ways as f64;
    for (z, x) in [(-length_mm, 0.0), (0.0, 0.0), (0.0, RADIUS_MM), (-length_mm, RADIUS_MM)] {
        bar.add(z, x, 0.0);
    }
    let begin = busy_s();
    for pass in 0..passes {
        let places: Vec<Point> = places(ways, pass, STEP_MM).collect();
        for pair in places.windows(2) {
            let left = bar.boolean(&swept_finger(pair[1], pair[0]), BooleanOp::Not).pos_plines;
            let largest = left
                .into_iter()
                .map(|found| found.pline)
                .max_by(|a, b| a.area().abs().total_cmp(&b.area().abs()));
            bar = largest.ok_or("the peer lost the whole part")?;
        }
    }
    Ok(((passes * ways) as f64 / (busy_s() - begin), bar.area().abs()))
}

/// What the finger passes over, its round end in eight chords on each side: places of Z and X.
fn chorded_finger(left: Point, right: Point) -> Vec<[f64; 2]> {
    let shape = swept_finger(left, right);
    let mut places = Vec::new();
    for (one, next) in shape.iter_vertexes().zip(shape.iter_vertexes().cycle().skip(1)) {
        places.push([one.x, one.y]);
        if one.bulge != 0.0 {
            // From the angle of the arc to places on it: the nose's centre is one of the ends of the way.
            let angle = 4.0 * one.bulge.atan();
            let (dx, dy) = (next.x - one.x, next.y - one.y);
            let radius = dx.hypot(dy) / 2.0 / (angle / 2.0).sin().abs();
            let half = radius * (angle / 2.0).cos();
            let (mx, my) = (f64::midpoint(one.x, next.x), f64::midpoint(one.y, next.y));
            let side = angle.signum() / dx.hypot(dy);
            let centre = [mx - dy * half * side, my + dx * half * side];
            let start = (one.y - centre[1]).atan2(one.x - centre[0]);
            for chord in 1..8 {
                let at = start + angle * f64::from(chord) / 8.0;
                places.push([centre[0] + radius * at.cos(), centre[1] + radius * at.sin()]);
            }
        }
    }
    places
}

/// Ways a second of a peer whose section is given and taken.
fn timed<T>(ways: usize, passes: usize, bar: T, mut cut: impl FnMut(T, &[[f64; 2]]) -> T) -> f64 {
    let begin = busy_s();
    let mut bar = bar;
    for pass in 0..passes {
        let places: Vec<Point> = places(ways, pass, STEP_MM).collect();
        for pair in places.windows(2) {
            bar = cut(bar, &chorded_finger(pair[1], pair[0]));
        }
    }
    std::hint::black_box(bar);
    (passes * ways) as f64 / (busy_s() - begin)
}

fn corners(ways: usize) -> [[f64; 2]; 4] {
    let length_mm = STEP_MM * ways as f64;
    [[-length_mm, 0.0], [0.0, 0.0], [0.0, RADIUS_MM], [-length_mm, RADIUS_MM]]
}

fn with_geo(ways: usize, passes: usize) -> f64 {
    use geo::{BooleanOps, LineString, MultiPolygon, Polygon};
    let polygon = |places: &[[f64; 2]]| {
        Polygon::new(LineString::from(places.iter().map(|[z, x]| (*z, *x)).collect::<Vec<_>>()), Vec::new())
    };
    let bar = MultiPolygon::new(vec![polygon(&corners(ways))]);
    timed(ways, passes, bar, |bar, swept| bar.difference(&polygon(swept)))
}

fn with_i_overlay(ways: usize, passes: usize) -> f64 {
    use i_overlay::core::fill_rule::FillRule;
    use i_overlay::core::overlay_rule::OverlayRule;
    use i_overlay::float::single::SingleFloatOverlay;
    let bar = vec![vec![corners(ways).to_vec()]];
    timed(ways, passes, bar, |bar, swept| {
        bar.overlay(&swept.to_vec(), OverlayRule::Difference, FillRule::EvenOdd)
    })
}

/// What the finger passes over between two places, from left to right.
fn swept_finger(left: Point, right: Point) -> Polyline<f64> {
    let (dz, dx) = (right.z - left.z, right.x - left.x);
    let length = dz.hypot(dx);
    // Where the way is the tangent of the nose, seen from its centre.
    let (z, x) = (dx / length * NOSE_MM, -dz / length * NOSE_MM);
    let bulge = |from: f64, to: f64| ((to - from) / 4.0).tan();
    let touch = x.atan2(z);
    let (start, end) = (-std::f64::consts::PI, 0.0);
    let mut swept = Polyline::new_closed();
    swept.add(left.z - NOSE_MM, left.x, bulge(start, touch));
    swept.add(left.z + z, left.x + x, 0.0);
    swept.add(right.z + z, right.x + x, bulge(touch, end));
    swept.add(right.z + NOSE_MM, right.x, 0.0);
    swept.add(right.z + NOSE_MM, right.x + HEIGHT_MM, 0.0);
    swept.add(left.z - NOSE_MM, left.x + HEIGHT_MM, 0.0);
    swept
}
