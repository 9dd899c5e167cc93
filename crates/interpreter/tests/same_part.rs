//! The same part, written in different ways, gives the same commands: no oracle needed.

mod support;

use support::{Conditions, run};
use turnwright_canon::Action;

/// Moves without their origin: kind, diameter and Z in nanometres.
fn moves(text: &str, conditions: &Conditions) -> Vec<String> {
    let run = run(text.as_bytes(), conditions);
    assert!(run.alarm.is_none(), "{:?}\n{text}", run.alarm);
    run.commands
        .iter()
        .filter(|command| command.action.end_point().is_some())
        .map(|command| format!("{:?}", command.action))
        .collect()
}

fn tf() -> Conditions {
    Conditions::on("fanuc-0i-tf")
}

const ABSOLUTE: &str = "O1\nG98 M3 S800\nG0 X50. Z2.\nG1 Z-20. F100.\nX60. Z-25.\nG2 X70. Z-30. R5.\nG1 Z-40.\nG0 X80. Z5.\nM30\n";

#[test]
fn absolute_incremental_and_mixed() {
    let incremental = "O1\nG98 M3 S800\nG0 X50. Z2.\nG1 W-22. F100.\nU10. W-5.\nG2 U10. W-5. R5.\nG1 W-10.\nG0 U10. W45.\nM30\n";
    let mixed = "O1\nG98 M3 S800\nG0 X50. Z2.\nG1 W-22. F100.\nX60. W-5.\nG2 U10. Z-30. R5.\nG1 Z-40.\nG0 U10. Z5.\nM30\n";
    assert_eq!(moves(ABSOLUTE, &tf()), moves(incremental, &tf()));
    assert_eq!(moves(ABSOLUTE, &tf()), moves(mixed, &tf()));
}

#[test]
fn with_and_without_decimal_points() {
    let counted = "O1\nG98 M3 S800\nG0 X50000 Z2000\nG1 Z-20000 F100\nX60000 Z-25000\nG2 X70000 Z-30000 R5000\nG1 Z-40000\nG0 X80000 Z5000\nM30\n";
    assert_eq!(moves(ABSOLUTE, &tf()), moves(counted, &tf()));
    let calculator = ABSOLUTE.replace(". ", " ").replace(".\n", "\n");
    assert_eq!(moves(ABSOLUTE, &tf()), moves(&calculator, &tf().with("3401#0", "1")));
}

#[test]
fn centre_or_radius_of_an_arc() {
    let by_centre = ABSOLUTE.replace("R5.", "I5. K0");
    assert_eq!(moves(ABSOLUTE, &tf()), moves(&by_centre, &tf()));
}

#[test]
fn code_systems_a_b_and_c() {
    let a = "O1\nG21 G98 M3 S800\nG0 X50. Z2.\nG90 X46. Z-20. F100.\nX42.\nG94 X20. Z-1.\nG92 X40. Z-10. F1.5\nG71 U2. R0.5\nG71 P1 Q2 U0.4 W0.1 F100.\nN1 G0 X30.\nG1 Z-10.\nN2 X50.\nG70 P1 Q2\nG32 Z-5. F2.\nM30\n";
    let b = a
        .replace("G98", "G94")
        .replace("G94 X20.", "G79 X20.")
        .replace("G90 X46.", "G77 X46.")
        .replace("G92 X40.", "G78 X40.")
        .replace("G32", "G33");
    let c = a
        .replace("G21 G98", "G71 G94")
        .replace("G94 X20.", "G24 X20.")
        .replace("G90 X46.", "G20 X46.")
        .replace("G92 X40.", "G21 X40.")
        .replace("\nG71", "\nG73")
        .replace("G70 P1", "G72 P1")
        .replace("G32", "G33");
    let expected = moves(a, &tf());
    assert!(expected.len() > 30);
    assert_eq!(expected, moves(&b, &tf().with("3401#6", "1")));
    assert_eq!(expected, moves(&c, &tf().with("3401#7", "1")));
    // Absolute and incremental are codes in B and C.
    let incremental = "O1\nG94 M3 S800\nG90 G0 X50. Z2.\nG91 G1 Z-22. F100.\nX10. Z-5.\nG2 X10. Z-5. R5.\nG1 Z-10.\nG0 X10. Z45.\nM30\n";
    assert_eq!(moves(ABSOLUTE, &tf()), moves(incremental, &tf().with("3401#6", "1")));
}

#[test]
fn with_and_without_a_subprogram() {
    let whole =
        "O1\nG98 M3 S800\nG0 X50. Z2.\nG1 W-5. F100.\nU2.\nG1 W-5. F100.\nU2.\nG1 W-5. F100.\nU2.\nM30\n";
    let called = "O1\nG98 M3 S800\nG0 X50. Z2.\nM98 P30002\nM30\nO2\nG1 W-5. F100.\nU2.\nM99\n";
    let counted = called.replace("P30002", "P2 L3");
    assert_eq!(moves(whole, &tf()), moves(called, &tf()));
    assert_eq!(moves(whole, &tf()), moves(&counted, &tf()));
}

/// The part of `with_and_without_a_subprogram`, block by block.
const STEPS: &str =
    "O1\nG98 M3 S800\nG0 X50. Z2.\nG1 W-5. F100.\nU2.\nG1 W-5. F100.\nU2.\nG1 W-5. F100.\nU2.\nM30\n";

#[test]
fn variables_for_coordinates() {
    // The variable whose number #2 holds is #2 itself.
    let variables = "O1\n#1=50\n#2=2\n#3=-5\n#100=#2\nG98 M3 S[400*#2]\nG0 X#1 Z#2\nG1 W#3 F[#1*#2]\nU#100\n\
                     G1 W[#2-7] F100.\nU[#1/25]\nG1 W-[ABS[#3]] F100.\nU##2\nM30\n";
    for control in ["fanuc-0i-mate-tb", "fanuc-0i-td", "gsk-980tdi", "gsk-988ta"] {
        assert_eq!(
            moves(STEPS, &Conditions::on(control)),
            moves(variables, &Conditions::on(control)),
            "{control}"
        );
    }
}

#[test]
fn loops_for_repeated_blocks() {
    let head = "O1\nG98 M3 S800\nG0 X50. Z2.\n#1=0\n";
    let body = "G1 W-5. F100.\nU2.\n#1=#1+1\n";
    let loops = [
        format!("{head}WHILE[#1 LT 3]DO1\n{body}END1\nM30\n"),
        format!("{head}DO2\n{body}IF[#1 EQ 3]GOTO 9\nEND2\nN9 M30\n"),
        format!("{head}N5 {body}IF[#1 NE 3]GOTO 5\nM30\n"),
        format!("{head}GOTO 7\nN6 M30\nN7 {body}IF[#1 GE 3]GOTO 6\nGOTO 7\n"),
    ];
    for control in ["fanuc-0i-mate-tb", "fanuc-0i-tf", "gsk-980tdi", "gsk-988tb"] {
        for text in &loops {
            assert_eq!(
                moves(STEPS, &Conditions::on(control)),
                moves(text, &Conditions::on(control)),
                "{text}"
            );
        }
    }
    let old = format!("{head}N5 {body}G65 H84 P5 Q#1 R3\nM30\n");
    let gsk = Conditions::on("gsk-980tdi");
    assert_eq!(moves(STEPS, &gsk), moves(&old, &gsk));
}

#[test]
fn macros_for_repeated_blocks() {
    let head = "O1\nG98 M3 S800\nG0 X50. Z2.\n";
    let step = "O9100\nG1 W-#23 F#9\nU#21\nM99\n";
    let calls = [
        format!("{head}G65 P9100 L3 W5. U2. F100.\nM30\n{step}"),
        format!("{head}#1=9100\nG65 P#1 W5. U2. F100.\nG65 P#1 L2 W5. U[1+1] F[50*2]\nM30\n{step}"),
        format!("{head}G66 P9101 U2.\nG1 W-5. F100.\nW-5.\nW-5.\nG67\nM30\nO9101\nG1 U#21\nM99\n"),
    ];
    for control in ["fanuc-0i-tc", "fanuc-0i-tf", "gsk-980tdi", "gsk-988ta"] {
        for text in &calls {
            assert_eq!(
                moves(STEPS, &Conditions::on(control)),
                moves(text, &Conditions::on(control)),
                "{text}"
            );
        }
    }
    let by_code = format!("{head}G100 L3 W5. U2. F100.\nM30\n{}", step.replace("9100", "9010"));
    assert_eq!(moves(STEPS, &tf()), moves(&by_code, &tf().with("6050", "100")));
}

#[test]
fn inch_and_millimetre_lengths_that_are_equal() {
    // 25.4 mm is 1 inch: every length here is exact in both.
    let mm = "O1\nG21 G98 M3 S800\nG0 X50.8 Z2.54\nG1 Z-25.4 F127.\nX76.2 Z-50.8\nM30\n";
    let inch = "O1\nG20 G98 M3 S800\nG0 X2. Z0.1\nG1 Z-1. F5.\nX3. Z-2.\nM30\n";
    assert_eq!(moves(mm, &tf()), moves(inch, &tf()));
}

#[test]
fn the_negative_side_is_the_mirror_image() {
    let program = |sign: &str| {
        format!(
            "O1\nG98 M3 S800\nG0 X{sign}60. Z2.\nG71 U3. R0.5\nG71 P1 Q2 U{sign}0.4 W0.1 F100.\nN1 G0 X{sign}30.\n\
             G1 Z-10.\nX{sign}40. Z-20.\nN2 X{sign}60.\nM30\n"
        )
    };
    let positive = run(program("").as_bytes(), &tf());
    let negative = run(program("-").as_bytes(), &tf());
    assert!(positive.alarm.is_none() && negative.alarm.is_none());
    // The first move comes from the reference point on both.
    let ends = |run: &support::Run| -> Vec<_> {
        run.commands
            .iter()
            .filter_map(|command| command.action.end_point())
            .map(|to| (to.x.0, to.z))
            .collect()
    };
    let mirrored: Vec<_> = ends(&negative).into_iter().map(|(x, z)| (-x, z)).collect();
    assert_eq!(ends(&positive), mirrored);
}

#[test]
fn the_finishing_cycle_is_the_figure_itself() {
    let by_hand =
        "O1\nG98 M3 S800\nG0 X60. Z2.\nG0 X30.\nG1 Z-10. F100.\nX40. Z-20.\nX60.\nG0 X60. Z2.\nM30\n";
    let by_cycle =
        "O1\nG98 M3 S800\nG0 X60. Z2.\nG70 P1 Q2\nM30\nN1 G0 X30.\nG1 Z-10. F100.\nX40. Z-20.\nN2 X60.\n";
    assert_eq!(moves(by_hand, &tf()), moves(by_cycle, &tf()));
}

#[test]
fn drawing_dimensions_are_the_points_they_stand_for() {
    let figure = |drawn: &str| {
        format!(
            "O1\nG98 M3 S800\nG0 X92. Z2.\nG71 U3. R0.5\nG71 P1 Q2 U0.4 W0.1 F100.\n\
             N1 G0 X20.\nG1 Z0\n{drawn}\nX90.\nN2 Z-70.\nG70 P1 Q2\nM30\n"
        )
    };
    // 135 and 170 degrees, with a chamfer of 3 between them; the last line is 20 long at 150 degrees.
    let by_points = figure("X47.194 Z-13.597\nX52.479 Z-18.673\nX60. Z-40.\nX83.094 Z-60.");
    let by_angles = figure(",A135. ,C3.\nX60. Z-40. ,A170.\nZ-60. ,A150.");
    assert_eq!(moves(&by_points, &tf()), moves(&by_angles, &tf()));
}

#[test]
fn layout_of_the_text_does_not_matter() {
    let dense = ABSOLUTE.replace(' ', "");
    let lower = ABSOLUTE.to_lowercase();
    let windows = ABSOLUTE.replace('\n', "\r\n");
    let old = ABSOLUTE.replace('\n', "\r");
    let taped = format!("%LEADER\n{ABSOLUTE}%\n");
    let marked = format!("\u{feff}{}\x1a", ABSOLUTE.replace('\n', ";\n"));
    for text in [dense, lower, windows, old, taped, marked] {
        assert_eq!(moves(ABSOLUTE, &tf()), moves(&text, &tf()), "{text:?}");
    }
}

#[test]
fn every_move_has_a_length() {
    let run = run(b"O1\nG98 M3\nG0 X50. Z2.\nX50.\nG1 Z2. F100.\nU0 W0\nX50. Z2.\nM30\n", &tf());
    let count = run
        .commands
        .iter()
        .filter(|c| matches!(c.action, Action::Rapid { .. } | Action::Feed { .. }))
        .count();
    assert_eq!(count, 1);
}
