//! Laws of nose compensation on dice contours of lines and arcs: the nose touches what it cuts and never enters it,
//! and a contour that is mirrored, shifted, reversed or written in inches gives the same path mirrored, shifted,
//! reversed or in millimetres.

mod support;

use std::sync::OnceLock;

use support::{Conditions, Run, run_on};
use turnwright_canon::{Action, Shape, Turn};
use turnwright_control::Control;
use turnwright_dice::Dice;
use turnwright_geometry::{Bend, Point, Segment, centre_from_radius, sweep_rad};

/// A contour: where it starts, and its elements: end, radius of an arc (below zero more than half a circle), clockwise.
#[derive(Clone, Debug)]
struct Contour {
    start: Point,
    elements: Vec<(Point, Option<(f64, bool)>)>,
    left: bool,
    radius_mm: f64,
    tip: u8,
}

/// Half an increment on each axis, of the contour's ends and of the path's, and an increment for joints that are passed over.
const NEAR_MM: f64 = 0.001_5;

fn to_increment(mm: f64) -> f64 {
    (mm * 1000.0).round() / 1000.0
}

fn on_grid(point: Point) -> Point {
    Point::new(to_increment(2.0 * point.x) / 2.0, to_increment(point.z))
}

/// A contour whose directions wander, some corners tangent, some sharp; elements as short as the nose or much longer.
fn contour(dice: &mut Dice, sharpest_deg: f64, shortest_mm: f64) -> Contour {
    let radius_mm = [0.2, 0.4, 0.8, 1.2][(dice.roll() % 4) as usize];
    let mut at = on_grid(Point::new(dice.between(20.0, 60.0), dice.between(-20.0, 20.0)));
    let start = at;
    let mut heading = dice.between(0.0, 360.0);
    let mut elements = Vec::new();
    for _ in 0..2 + dice.roll() % 6 {
        let length = dice.between(shortest_mm, 12.0);
        if dice.one_in(3) {
            let turn = dice.between(10.0, 170.0);
            let clockwise = dice.one_in(2);
            let arc_radius = length / 2.0 / (turn / 2.0).to_radians().sin();
            let sense = if clockwise { -1.0 } else { 1.0 };
            let chord = (heading + sense * turn / 2.0).to_radians();
            let end = on_grid(Point::new(at.x + length * chord.sin(), at.z + length * chord.cos()));
            let arc_radius = to_increment(arc_radius).max(at.distance(end) / 2.0 + 0.001);
            elements.push((end, Some((to_increment(arc_radius + 0.000_4), clockwise))));
            at = end;
            heading += sense * turn;
        } else {
            let angle = heading.to_radians();
            at = on_grid(Point::new(at.x + length * angle.sin(), at.z + length * angle.cos()));
            elements.push((at, None));
        }
        if !dice.one_in(4) {
            heading += dice.between(-sharpest_deg, sharpest_deg);
        }
    }
    Contour { start, elements, left: dice.one_in(2), radius_mm, tip: (dice.roll() % 10) as u8 }
}

impl Contour {
    fn segments(&self) -> Vec<Segment> {
        let mut at = self.start;
        self.elements
            .iter()
            .map(|(end, arc)| {
                let start = std::mem::replace(&mut at, *end);
                let bend = arc.map(|(radius_mm, clockwise)| {
                    let centre =
                        centre_from_radius(start, *end, radius_mm, clockwise, 0.001).expect("an arc");
                    Bend { centre, clockwise }
                });
                Segment { start, end: *end, bend }
            })
            .collect()
    }

    /// A place beside the first or the last point, on the side of the nose.
    fn beside(&self, at: Point, direction: Point) -> Point {
        let side = if self.left { 8.0 } else { -8.0 };
        on_grid(Point::new(at.x + side * direction.z, at.z - side * direction.x))
    }

    /// The program; elements are lines 5 and on. Lengths are divided by `unit_mm`.
    fn program(&self, unit_mm: f64, places: usize) -> String {
        let segments = self.segments();
        let last = &segments[segments.len() - 1];
        let from = self.beside(self.start, direction(&segments[0], segments[0].start));
        let to = self.beside(last.end, direction(last, last.end));
        let word =
            |point: Point| format!("X{:.places$} Z{:.places$}", 2.0 * point.x / unit_mm, point.z / unit_mm);
        let units = if unit_mm == 1.0 { "G21" } else { "G20" };
        let mut text = format!("{units}\nG98 F100. T0101\nG00 {}\n", word(from));
        text.push_str(&format!("G{} G01 {}\n", if self.left { 41 } else { 42 }, word(self.start)));
        for (end, arc) in &self.elements {
            match arc {
                None => text.push_str(&format!("G01 {}\n", word(*end))),
                Some((radius_mm, clockwise)) => {
                    let code = if *clockwise { 2 } else { 3 };
                    let radius = radius_mm / unit_mm;
                    text.push_str(&format!("G0{code} {} R{radius:.places$}\n", word(*end)));
                }
            }
        }
        text.push_str(&format!("G40 G01 {}\nM30\n", word(to)));
        text
    }

    fn run(&self, unit_mm: f64, places: usize) -> Run {
        static CONTROL: OnceLock<Control> = OnceLock::new();
        let control = CONTROL.get_or_init(|| Control::load("fanuc-0i-tf").expect("a control"));
        // Arcs without tolerance; offsets keep their size in inches.
        let mut conditions = Conditions::default().with("3410", "0").with("5006#0", "1");
        conditions.setup =
            format!("[offsets.1]\ngeometry = {{ r = {} }}\ntip = {}\n", self.radius_mm, self.tip);
        run_on(control.clone(), self.program(unit_mm, places).as_bytes(), &conditions)
    }
}

/// Direction of travel at a point of a segment.
fn direction(segment: &Segment, at: Point) -> Point {
    let (z, x) = match segment.bend {
        None => (segment.end.z - segment.start.z, segment.end.x - segment.start.x),
        Some(Bend { centre, clockwise: true }) => (at.x - centre.x, centre.z - at.z),
        Some(Bend { centre, clockwise: false }) => (centre.x - at.x, at.z - centre.z),
    };
    let length = z.hypot(x);
    Point::new(x / length, z / length)
}

/// A move of the nose centre.
#[derive(Clone, Debug)]
struct NoseMove {
    segment: Segment,
    line: u32,
}

/// Moves of the nose centre on the contour: behind the start-up and before the cancel.
fn nose_moves(run: &Run, contour: &Contour) -> Vec<NoseMove> {
    let last_line = 4 + contour.elements.len() as u32;
    let mut at: Option<Point> = None;
    let mut moves = Vec::new();
    for command in &run.commands {
        let Some(nose) = &command.nose else { continue };
        let end = Point::new(nose.x.to_mm(), nose.z.to_mm());
        let tip = command.action.end_point().expect("a move");
        let bend = match &command.action {
            Action::Feed { shape: Shape::Arc { turn, centre }, .. } => Some(Bend {
                // The tip's circle is that of the centre moved.
                centre: Point::new(
                    centre.x.to_mm() - tip.x.to_mm() + end.x,
                    centre.z.to_mm() - tip.z.to_mm() + end.z,
                ),
                clockwise: *turn == Turn::Clockwise,
            }),
            _ => None,
        };
        let line = command.origin.line;
        if let Some(start) = at.replace(end)
            && (5..=last_line).contains(&line)
        {
            moves.push(NoseMove { segment: Segment { start, end, bend }, line });
        }
    }
    moves
}

fn sample(segment: &Segment, share: f64) -> Point {
    let Some(bend) = segment.bend else {
        return Point::new(
            segment.start.x + share * (segment.end.x - segment.start.x),
            segment.start.z + share * (segment.end.z - segment.start.z),
        );
    };
    let sweep = sweep_rad(segment.start, segment.end, bend.centre, bend.clockwise);
    let from = (segment.start.x - bend.centre.x).atan2(segment.start.z - bend.centre.z);
    let radius = bend.centre.distance(segment.start);
    let angle = from + share * sweep;
    Point::new(bend.centre.x + radius * angle.sin(), bend.centre.z + radius * angle.cos())
}

/// Distance of a point from a segment.
fn distance(segment: &Segment, point: Point) -> f64 {
    let ends = segment.start.distance(point).min(segment.end.distance(point));
    match segment.bend {
        None => {
            let (z, x) = (segment.end.z - segment.start.z, segment.end.x - segment.start.x);
            let square = z * z + x * x;
            let along = (z * (point.z - segment.start.z) + x * (point.x - segment.start.x)) / square;
            if (0.0..=1.0).contains(&along) {
                (z * (point.x - segment.start.x) - x * (point.z - segment.start.z)).abs() / square.sqrt()
            } else {
                ends
            }
        }
        Some(bend) => {
            let whole = sweep_rad(segment.start, segment.end, bend.centre, bend.clockwise).abs();
            let part = sweep_rad(segment.start, point, bend.centre, bend.clockwise).abs();
            if part <= whole {
                (bend.centre.distance(point) - bend.centre.distance(segment.start)).abs()
            } else {
                ends
            }
        }
    }
}

/// Distance of a point from the line or circle that a segment is part of.
fn off_track(segment: &Segment, point: Point) -> f64 {
    match segment.bend {
        None => {
            let (z, x) = (segment.end.z - segment.start.z, segment.end.x - segment.start.x);
            (z * (point.x - segment.start.x) - x * (point.z - segment.start.z)).abs() / z.hypot(x)
        }
        Some(bend) => (bend.centre.distance(point) - bend.centre.distance(segment.start)).abs(),
    }
}

/// Whether the contour comes back to itself: no nose fits between there, and the control compares only the ends of each
/// element.
fn comes_back(contour: &Contour) -> bool {
    // The centre stands up to 1.6 radii from an inside corner.
    let wide = 2.7 * contour.radius_mm;
    let segments = contour.segments();
    let is_near = |one: &Segment, other: &Segment, joint: Option<Point>| {
        (0..=32).map(|part| sample(one, f64::from(part) / 32.0)).any(|point| {
            joint.is_none_or(|joint| point.distance(joint) > 1.2 * wide) && distance(other, point) < wide
        })
    };
    let pairs = (0..segments.len()).flat_map(|one| (one + 1..segments.len()).map(move |other| (one, other)));
    pairs.into_iter().any(|(one, other)| {
        let joint = (other == one + 1).then_some(segments[one].end);
        is_near(&segments[one], &segments[other], joint) || is_near(&segments[other], &segments[one], joint)
    })
}

#[test]
fn the_nose_touches_what_it_cuts_and_never_enters_it() {
    let mut dice = Dice::new(11);
    let (mut checked, mut refused, mut clear) = (0, 0, 0);
    for round in 0..10_000 {
        let contour = contour(&mut dice, 100.0, 4.0);
        let run = contour.run(1.0, 3);
        if let Some(alarm) = &run.alarm {
            assert!(is_refusal(alarm.key), "{contour:?}\n{alarm:?}");
            refused += 1;
            continue;
        }
        let told = || format!("round {round}\n{}\n{contour:?}\n{}", contour.program(1.0, 3), run.listing());
        let segments = contour.segments();
        let moves = nose_moves(&run, &contour);
        let comes_back = comes_back(&contour);
        for (index, step) in moves.iter().enumerate() {
            let cut = &segments[step.line as usize - 5];
            let near = if comes_back { std::slice::from_ref(cut) } else { &segments[..] };
            for centre in (0..=16).map(|part| sample(&step.segment, f64::from(part) / 16.0)) {
                for segment in near {
                    let apart = distance(segment, centre);
                    let enters = apart < contour.radius_mm - NEAR_MM;
                    assert!(!enters, "{apart} from {segment:?} at {centre:?} of {step:?}\n{}", told());
                }
            }
            // Of an arc that the joints at its ends use up only the way to it is left.
            let is_last = moves.get(index + 1).is_none_or(|next| next.line != step.line);
            if is_last && cut.bend.is_some() == step.segment.bend.is_some() {
                for end in [step.segment.start, step.segment.end] {
                    let off = off_track(cut, end);
                    assert!((off - contour.radius_mm).abs() <= NEAR_MM, "{off} of {step:?}\n{}", told());
                }
            }
        }
        checked += 1;
        clear += usize::from(!comes_back);
    }
    assert!(checked > 5_000 && clear > 2_000, "{checked} checked, {clear} against all, {refused} refused");
}

fn is_refusal(key: &str) -> bool {
    matches!(key, "compensation-interference" | "no-compensated-intersection")
}

#[test]
fn elements_shorter_than_the_nose_end_in_a_path_or_an_alarm() {
    let mut dice = Dice::new(12);
    let (mut cut, mut refused) = (0, 0);
    for _ in 0..6_000 {
        let contour = contour(&mut dice, 175.0, 0.003);
        let run = contour.run(1.0, 3);
        match &run.alarm {
            Some(alarm) => {
                assert!(is_refusal(alarm.key), "{contour:?}\n{alarm:?}");
                refused += 1;
            }
            None => {
                // Joints reach no further than a few radii from where they are, unless elements meet at a sharp angle.
                let moves = nose_moves(&run, &contour);
                assert!(!moves.is_empty());
                cut += 1;
            }
        }
    }
    assert!(cut > 500 && refused > 500, "{cut} cut, {refused} refused");
}

/// The places where the nose centre's moves on the contour end, with the first start.
fn places(run: &Run, contour: &Contour) -> Vec<Point> {
    let moves = nose_moves(run, contour);
    let first = moves.first().map(|step| step.segment.start);
    first.into_iter().chain(moves.iter().map(|step| step.segment.end)).collect()
}

/// Both runs end alike, and the path of the second is that of the first, each place moved.
fn assert_same(
    one: (&Contour, &Run),
    other: (&Contour, &Run),
    near_mm: f64,
    moved: impl Fn(Point) -> Point,
) -> bool {
    let told = || {
        let program = |(contour, run): (&Contour, &Run)| {
            format!("{}\n{}\n{}", contour.program(1.0, 3), run.listing(), run.diagnostics())
        };
        format!("{}\n{}", program(one), program(other))
    };
    assert_eq!(
        one.1.alarm.as_ref().map(|alarm| (alarm.key, alarm.place.map(|place| place.line))),
        other.1.alarm.as_ref().map(|alarm| (alarm.key, alarm.place.map(|place| place.line))),
        "{}",
        told()
    );
    if one.1.alarm.is_some() {
        return false;
    }
    let (places, others) = (places(one.1, one.0), places(other.1, other.0));
    if places.len() != others.len() {
        // A move that is as long as the rounding is there once and not the other time.
        return false;
    }
    for (place, other) in places.iter().zip(&others) {
        assert!(moved(*place).distance(*other) <= near_mm, "{place:?} {other:?}\n{}", told());
    }
    true
}

#[test]
fn a_mirrored_or_shifted_contour_has_a_mirrored_or_shifted_path() {
    let mut dice = Dice::new(13);
    let mut checked = 0;
    for _ in 0..2_000 {
        let contour = contour(&mut dice, 140.0, 1.0);
        let run = contour.run(1.0, 3);
        let flip = |point: Point| Point::new(point.x, -point.z);
        let tip = [0, 2, 1, 4, 3, 7, 6, 5, 8, 9][usize::from(contour.tip)];
        let turned = |(end, arc): &(Point, Option<(f64, bool)>)| {
            (flip(*end), arc.map(|(radius_mm, clockwise)| (radius_mm, !clockwise)))
        };
        let mirrored = Contour {
            start: flip(contour.start),
            elements: contour.elements.iter().map(turned).collect(),
            left: !contour.left,
            tip,
            ..contour.clone()
        };
        let same = assert_same((&contour, &run), (&mirrored, &mirrored.run(1.0, 3)), NEAR_MM, flip);
        let shift = |point: Point| Point::new(point.x + 7.0, point.z - 111.0);
        let shifted = Contour {
            start: shift(contour.start),
            elements: contour.elements.iter().map(|(end, arc)| (shift(*end), *arc)).collect(),
            ..contour.clone()
        };
        let also = assert_same((&contour, &run), (&shifted, &shifted.run(1.0, 3)), NEAR_MM, shift);
        checked += usize::from(same && also);
    }
    assert!(checked > 700, "{checked}");
}

#[test]
fn a_contour_cut_backwards_on_the_other_side_has_the_same_path_backwards() {
    let mut dice = Dice::new(14);
    let mut checked = 0;
    for _ in 0..3_000 {
        let contour = contour(&mut dice, 140.0, 4.0);
        let run = contour.run(1.0, 3);
        let mut ends: Vec<Point> = vec![contour.start];
        ends.extend(contour.elements.iter().map(|(end, _)| *end));
        let elements = contour.elements.iter().zip(&ends).rev();
        let back = Contour {
            start: ends[ends.len() - 1],
            elements: elements
                .map(|((_, arc), start)| (*start, arc.map(|(radius_mm, clockwise)| (radius_mm, !clockwise))))
                .collect(),
            left: !contour.left,
            ..contour.clone()
        };
        let other = back.run(1.0, 3);
        // Which block is blamed depends on where the control comes from.
        if run.alarm.is_some() || other.alarm.is_some() {
            assert_eq!(run.alarm.is_some(), other.alarm.is_some(), "{contour:?}");
            continue;
        }
        let (mut places, others) = (places(&run, &contour), places(&other, &back));
        places.reverse();
        if places.len() != others.len() {
            continue;
        }
        for (place, other) in places.iter().zip(&others) {
            assert!(place.distance(*other) <= NEAR_MM, "{place:?} {other:?} {contour:?}");
        }
        checked += 1;
    }
    assert!(checked > 1_000, "{checked}");
}

#[test]
fn inches_and_millimetres_give_the_same_path() {
    /// Rounding to an increment of 0.0001 inch.
    const INCH_NEAR_MM: f64 = 0.004;
    let mut dice = Dice::new(15);
    let mut checked = 0;
    for _ in 0..1_500 {
        let mut contour = contour(&mut dice, 110.0, 4.0);
        // Places that both systems can write: hundredths of an inch.
        let written = |mm: f64| (mm / 0.254).round() * 0.254;
        let grid = |point: Point| Point::new(written(point.x), written(point.z));
        contour.start = grid(contour.start);
        for (end, arc) in &mut contour.elements {
            *end = grid(*end);
            *arc = None;
        }
        contour.radius_mm = 0.762;
        let (metric, inch) = (contour.run(1.0, 3), contour.run(25.4, 4));
        checked +=
            usize::from(assert_same((&contour, &metric), (&contour, &inch), INCH_NEAR_MM, |place| place));
    }
    assert!(checked > 500, "{checked}");
}
