//! Areas beside an independent boolean with true arcs: one cut each, of shapes that are also built by hand there.
//!
//! Everything lies at places without pattern, because the peer gets lost where edges lie on each other; such places are
//! the subject of `laws.rs`.

mod random;

use cavalier_contours::polyline::{BooleanOp, PlineSource, PlineSourceMut, Polyline};
use random::{Random, point};
use turnwright_geometry::{Bend, Outline, Point, Segment, Vector, sweep_rad};
use turnwright_stock::{Cutter, Section, Sweep};

/// A loop of segments as the peer's polyline.
fn polyline(segments: &[Segment]) -> Polyline<f64> {
    let mut polyline = Polyline::new_closed();
    for segment in segments {
        let sweep = segment
            .bend
            .map_or(0.0, |bend| sweep_rad(segment.start, segment.end, bend.centre, bend.clockwise));
        polyline.add(segment.start.z, segment.start.x, (sweep / 4.0).tan());
    }
    polyline
}

fn common_mm2(one: &Polyline<f64>, other: &Polyline<f64>) -> f64 {
    let common = one.boolean(other, BooleanOp::And);
    let area = |found: &[cavalier_contours::polyline::BooleanResultPline<Polyline<f64>>]| {
        found.iter().map(|found| found.pline.area().abs()).sum::<f64>()
    };
    area(&common.pos_plines) - area(&common.neg_plines)
}

fn line(start: Point, end: Point) -> Segment {
    Segment { start, end, bend: None }
}

fn arc(start: Point, end: Point, centre: Point, clockwise: bool) -> Segment {
    Segment { start, end, bend: Some(Bend { centre, clockwise }) }
}

/// A turned part with steps, a groove, a shoulder that hangs over, and arcs.
fn blank(random: &mut Random) -> Outline {
    let mut off = || random.between(-0.4, 0.4);
    let corners = [
        point(3.1 + off().abs(), -41.3),
        point(3.3, 0.7 + off()),
        point(9.2 + off(), 0.4),
        point(9.7 + off(), -7.1),
        point(14.6 + off(), -5.3 + off()),
        point(14.9 + off(), -16.2),
        point(11.3 + off(), -17.4),
        point(11.8 + off(), -21.6),
        point(19.1 + off(), -19.7),
        point(19.6 + off(), -40.9),
    ];
    let mut segments: Vec<Segment> =
        (0..corners.len()).map(|index| line(corners[index], corners[(index + 1) % corners.len()])).collect();
    // Two of them bend.
    for (index, bulge) in [(3, 1.7), (8, -9.3)] {
        let Segment { start, end, .. } = segments[index];
        let (way, middle) = (Vector::between(start, end), Vector::between(start, end).times(0.5).from(start));
        let side = Vector { x: way.z, z: -way.x }.times(bulge / way.length());
        let centre = side.from(middle);
        segments[index] = arc(start, end, centre, bulge < 0.0);
    }
    Outline::new(segments).expect("a blank")
}

/// A disc along a line: two half circles and two lines.
fn capsule(from: Point, to: Point, radius: f64) -> Vec<Segment> {
    let way = Vector::between(from, to);
    let side = Vector { x: way.z, z: -way.x }.times(radius / way.length());
    let (left, right) = (side, side.times(-1.0));
    vec![
        line(right.from(from), right.from(to)),
        arc(right.from(to), left.from(to), to, false),
        line(left.from(to), left.from(from)),
        arc(left.from(from), right.from(from), from, false),
    ]
}

/// A disc along an arc of less than half a turn, with a radius that is larger: four arcs.
fn bow(from: Point, to: Point, bend: Bend, radius: f64) -> Vec<Segment> {
    let along = |place: Point, by: f64| {
        let arm = Vector::between(bend.centre, place);
        arm.times(1.0 + by / arm.length()).from(bend.centre)
    };
    let (from, to) = if bend.clockwise { (to, from) } else { (from, to) };
    vec![
        arc(along(from, radius), along(to, radius), bend.centre, false),
        arc(along(to, radius), along(to, -radius), to, false),
        arc(along(to, -radius), along(from, -radius), bend.centre, true),
        arc(along(from, -radius), along(from, radius), from, false),
    ]
}

fn disc(radius: f64) -> Cutter {
    Cutter::new(&Outline::circle(point(0., 0.), radius).expect("a disc"))
}

fn compare(seed: u64, blank: &Outline, sweep: &Sweep, swept: &[Segment]) {
    let mut section = Section::new(blank).expect("a blank");
    let removed = section.cut(sweep);
    let expected = common_mm2(&polyline(blank.segments()), &polyline(swept));
    let off = removed.area_mm2 - expected;
    assert!(off.abs() <= 1e-9 * blank.area_mm2(), "seed {seed}: {} instead of {expected}", removed.area_mm2);
    let whole = section.area_mm2() + removed.area_mm2;
    assert!((whole / blank.area_mm2() - 1.0).abs() < 1e-12, "seed {seed}");
}

#[test]
fn discs_along_lines_and_arcs() {
    let mut sweep = Sweep::new();
    let mut compared = 0;
    for seed in 1..=2_000 {
        let mut random = Random::new(seed);
        let blank = blank(&mut random);
        let mut place = || point(random.between(4.0, 24.0), random.between(-45.0, 4.0));
        let (from, to) = (place(), place());
        let radius = random.between(0.1, 3.0);
        compare(seed, &blank, sweep.line(&disc(radius), from, to), &capsule(from, to, radius));
        // The same radius about a centre on the middle line of both ends.
        let chord = Vector::between(from, to);
        let middle = chord.times(0.5).from(from);
        let rise = random.between(-20.0, 20.0) / chord.length();
        let bend = Bend {
            centre: Vector { x: chord.z, z: -chord.x }.times(rise).from(middle),
            clockwise: random.chance(2),
        };
        let turned = sweep_rad(from, to, bend.centre, bend.clockwise).abs();
        sweep.arc(&disc(radius), from, to, bend);
        // What a tool passes over below the axis it takes from above, too; the peer's shape does not.
        let is_above = sweep.bounds().is_some_and(|bounds| bounds.min.x > 0.0);
        if is_above && turned < 3.0 && bend.centre.distance(from) > radius + 0.1 {
            compare(seed, &blank, &sweep, &bow(from, to, bend, radius));
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn tools_at_rest() {
    let mut sweep = Sweep::new();
    for seed in 1..=1_000 {
        let mut random = Random::new(seed);
        let blank = blank(&mut random);
        let (tool, way) =
            (random.tool(), Vector { x: random.between(4.0, 24.0), z: random.between(-45.0, 4.0) });
        if tool.bounds().min.x + way.x > 0.1 {
            sweep.rest(&Cutter::new(&tool), way.from(Point::default()));
            compare(seed, &blank, &sweep, tool.moved(way).segments());
        }
    }
}
