//! Laws of corners on random programs: fillets touch both lines, chamfers have the legs that were written, both
//! within the rounding of the points to the least increment.

mod support;

use support::{Conditions, run};
use turnwright_canon::{Action, Shape, Turn};
use turnwright_dice::Dice;
use turnwright_units::{Position, WorkTip};

/// X as a radius, and Z.
type Place = (f64, f64);

/// Thousandths between `low` and `high`.
fn mm(dice: &mut Dice, low: i64, high: i64) -> f64 {
    dice.whole(low * 1_000, high * 1_000 - 1) as f64 / 1_000.0
}

fn place(position: Position<WorkTip>) -> Place {
    (position.x.to_mm(), position.z.to_mm())
}

fn apart(one: Place, other: Place) -> f64 {
    (one.0 - other.0).hypot(one.1 - other.1)
}

/// Distance of a point from the line through two others.
fn off(line: (Place, Place), point: Place) -> f64 {
    let ((x, z), (to_x, to_z)) = line;
    let (dx, dz) = (to_x - x, to_z - z);
    ((point.0 - x) * dz - (point.1 - z) * dx).abs() / dx.hypot(dz)
}

/// Half an increment on each axis, and the centre moved between the rounded ends.
const ROUNDING_MM: f64 = 0.001_5;

/// Runs `G01` from `start` over `corner` with a corner word to `end`; the moves behind the positioning.
fn moves(control: &str, start: Place, corner: Place, word: &str, end: Place) -> Option<Vec<Action>> {
    let text = format!(
        "O1\nG98 S800 M03 F200.\nG00 X{:.3} Z{:.3}\nG01 X{:.3} Z{:.3} {word}\nX{:.3} Z{:.3}\nM30\n",
        2.0 * start.0,
        start.1,
        2.0 * corner.0,
        corner.1,
        2.0 * end.0,
        end.1
    );
    let run = run(
        text.as_bytes(),
        &Conditions::on(control).with(if control.starts_with("gsk") { "181#0" } else { "3410" }, "0"),
    );
    match &run.alarm {
        None => {}
        Some(alarm) if alarm.key == "corner-longer-than-move" => return None,
        Some(alarm) => panic!("{text}\n{alarm:?}"),
    }
    let moves = run.commands.iter().filter(|command| matches!(command.action, Action::Feed { .. }));
    Some(moves.map(|command| command.action.clone()).collect())
}

fn random_path(dice: &mut Dice) -> [Place; 3] {
    [(); 3].map(|()| (mm(dice, 1, 60), mm(dice, -90, 10)))
}

#[test]
fn a_fillet_touches_both_lines() {
    let mut dice = Dice::new(1);
    let mut checked = 0;
    for round in 0..3_000 {
        let [start, corner, end] = random_path(&mut dice);
        let radius = mm(&mut dice, 0, 12) + 0.001;
        let (control, word) = if round % 2 == 0 {
            ("fanuc-0i-tf", format!(",R{radius:.3}"))
        } else {
            ("gsk-980tdi", format!("D{radius:.3}"))
        };
        let Some(moves) = moves(control, start, corner, &word, end) else { continue };
        let arcs = moves.iter().enumerate().filter_map(|(at, action)| match action {
            Action::Feed { to, shape: Shape::Arc { turn, centre }, .. } => Some((at, *to, *turn, *centre)),
            _ => None,
        });
        for (at, to, turn, centre) in arcs {
            let (to, centre) = (place(to), place(centre));
            let from =
                at.checked_sub(1).map_or(start, |before| place(moves[before].end_point().expect("a move")));
            for line in [(start, corner), (corner, end)] {
                assert!(
                    (off(line, centre) - radius).abs() < ROUNDING_MM,
                    "{start:?} {corner:?} {end:?} {word}"
                );
            }
            assert!(off((start, corner), from) < ROUNDING_MM && off((corner, end), to) < ROUNDING_MM);
            let ends = (apart(centre, from) - apart(centre, to)).abs();
            assert!(ends < ROUNDING_MM, "{start:?} {corner:?} {end:?} {word}");
            if apart(from, to) > 1.2 * radius {
                assert!(ends < 1e-5, "both ends lie on one circle");
            }
            // To the left when the path turns left.
            let left = (corner.1 - start.1) * (end.0 - corner.0) > (corner.0 - start.0) * (end.1 - corner.1);
            assert_eq!(turn == Turn::CounterClockwise, left);
            checked += 1;
        }
    }
    assert!(checked > 1_000, "{checked}");
}

#[test]
fn a_chamfer_has_the_legs_that_were_written() {
    let mut dice = Dice::new(2);
    let mut checked = 0;
    for round in 0..3_000 {
        let [start, corner, end] = random_path(&mut dice);
        let size = mm(&mut dice, 0, 12) + 0.01;
        let is_length = round % 2 == 1;
        let (control, word) = if is_length {
            ("gsk-980tdc", format!("L{size:.3}"))
        } else {
            ("fanuc-0i-td", format!(",C{size:.3}"))
        };
        let Some(moves) = moves(control, start, corner, &word, end) else { continue };
        let ends: Vec<Place> = moves.iter().filter_map(Action::end_point).map(place).collect();
        let [from, to, last] = ends[..] else { continue };
        assert_eq!(last, end);
        assert!(off((start, corner), from) < ROUNDING_MM && off((corner, end), to) < ROUNDING_MM);
        let (one, other) = (apart(from, corner), apart(to, corner));
        assert!((one - other).abs() < ROUNDING_MM, "{start:?} {corner:?} {end:?} {word}");
        let measured = if is_length { apart(from, to) } else { one };
        assert!((measured - size).abs() < ROUNDING_MM, "{start:?} {corner:?} {end:?} {word}");
        checked += 1;
    }
    assert!(checked > 1_000, "{checked}");
}

#[test]
fn a_line_given_by_its_angle_is_the_line_given_by_its_end() {
    let mut dice = Dice::new(3);
    let mut checked = 0;
    for _ in 0..1_000 {
        let [start, corner, end] = random_path(&mut dice);
        let angle = |from: Place, to: Place| (to.0 - from.0).atan2(to.1 - from.1).to_degrees();
        let (one, other) = (angle(start, corner), angle(corner, end));
        let turned = (one - other).to_radians().sin().abs();
        if turned < 0.2 {
            continue;
        }
        let text = format!(
            "O1\nG98 S800 M03 F200.\nG00 X{:.3} Z{:.3}\nG01 ,A{one:.9}\nX{:.3} Z{:.3} ,A{other:.9}\nM30\n",
            2.0 * start.0,
            start.1,
            2.0 * end.0,
            end.1
        );
        let run = run(text.as_bytes(), &Conditions::on("fanuc-0i-tf"));
        assert!(run.alarm.is_none(), "{text}\n{:?}", run.alarm);
        let ends: Vec<Place> = run.commands.iter().filter_map(|c| c.action.end_point()).map(place).collect();
        assert!(apart(ends[1], corner) < 0.001 && ends[2] == end, "{text} {ends:?}");
        assert!(run.warnings.is_empty(), "{text} {:?}", run.warnings);
        checked += 1;
    }
    assert!(checked > 500, "{checked}");
}
