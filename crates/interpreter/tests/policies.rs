//! Readings of policies that none of the controls has as delivered: a machine may differ.

mod support;

use support::{Conditions, Run, run_on};
use turnwright_control::Control;
use turnwright_control::policy::{
    CycleForm, CylinderRoughing, CylinderRoughingSign, CylinderRoughingTotal, CylinderRoughingWords,
    FeedPerRevolution, FinishingFigure, GrooveWithoutPeck, MissingPoint, NestedComment, OneShotWithMotion,
    PeckModeWord, Policies, RepeatedAddress, RunOutLengthAlone, RunOutWordsKept, SingleCycleSide,
    SpeedLimitAtReset, StoppingCodes,
};

fn run_with(text: &str, restarts: u32, change: impl FnOnce(&mut Policies)) -> Run {
    let mut control = Control::load("fanuc-0i-tf").expect("a control");
    change(&mut control.policies);
    run_on(control, text.as_bytes(), &Conditions { restarts, ..Conditions::on("fanuc-0i-tf") })
}

#[test]
fn a_length_may_need_its_point() {
    let change = |policies: &mut Policies| policies.missing_point = MissingPoint::Alarm;
    assert_eq!(run_with("G00 X20. Z0\nM30\n", 0, change).diagnostics(), "");
    let run = run_with("G00 X20. Z5\nM30\n", 0, change);
    assert_eq!(run.diagnostics(), "alarm PS5073 point-required 1:10-12\n");
}

#[test]
fn feed_per_revolution_may_be_an_option() {
    let run = run_with("G98 G01 X20. F100.\nG99 X30. F0.2\nM30\n", 0, |policies| {
        policies.feed_per_revolution = FeedPerRevolution::Alarm;
    });
    assert_eq!(run.diagnostics(), "alarm PS0014 feed-per-revolution-unavailable 2:1-4\n");
}

#[test]
fn one_address_twice_may_be_refused() {
    let run = run_with("G00 X10. X20. Z0\nM30\n", 0, |policies| {
        policies.repeated_address = RepeatedAddress::Alarm;
    });
    assert_eq!(run.diagnostics(), "alarm PS5074 duplicate-word 1:10-14\n");
}

#[test]
fn a_code_that_acts_once_may_refuse_a_motion_code() {
    let change = |policies: &mut Policies| policies.one_shot_with_motion = OneShotWithMotion::Alarm;
    let run = run_with("G01 G04 X2.\nM30\n", 0, change);
    assert_eq!(run.alarm.expect("an alarm").key, "one-shot-with-motion-code");
    assert!(run_with("G04 X2.\nG00 X5.\nM30\n", 0, change).alarm.is_none());
}

#[test]
fn a_bracket_inside_a_remark_may_be_refused() {
    let run = run_with("(A (B) C)\nG00 X20.\nM30\n", 0, |policies| {
        policies.nested_comment = NestedComment::Alarm;
    });
    assert_eq!(run.alarm.expect("an alarm").key, "nested-comment");
}

#[test]
fn stopping_codes_may_act_with_the_move() {
    let text = "S500 M03\nG00 X20. Z2. M05\nX30. M09\nM30\n";
    let with = run_with(text, 0, |policies| policies.stopping_codes = StoppingCodes::WithTheMove);
    let expected = "spindle cw 500rpm\nspindle stop 500rpm\nrapid d20 z2\ncoolant off\nrapid d30 z2\nend\n";
    assert_eq!(with.listing(), expected);
    let behind = run_with(text, 0, |_| {});
    let expected = "spindle cw 500rpm\nrapid d20 z2\nspindle stop 500rpm\nrapid d30 z2\ncoolant off\nend\n";
    assert_eq!(behind.listing(), expected);
}

#[test]
fn a_reset_may_cancel_the_speed_limit() {
    let text = "G00 X40. Z2.\nG96 S120 M03\nG50 S2000\nM30\n";
    let cancelled =
        run_with(text, 1, |policies| policies.speed_limit_at_reset = SpeedLimitAtReset::Cancelled);
    let second = cancelled.listing().rsplit("end\n").nth(1).expect("two runs").to_string();
    assert_eq!(second, "spindle cw 120m/min\nspindle cw 120m/min max2000\n");
    let kept = run_with(text, 1, |_| {}).listing();
    assert_eq!(kept.rsplit("end\n").nth(1), Some("spindle cw 120m/min max2000\n"));
}

#[test]
fn a_program_without_o_takes_its_first_sequence_number() {
    let text = b"N1234 G00 X20. Z2.\nN10 X10.\nM30\n";
    let number = |name: &str| {
        let control = Control::load(name).expect("a control");
        let run = run_on(control, text, &Conditions::on(name));
        run.commands.iter().map(|command| command.origin.program).collect::<Vec<_>>()
    };
    assert_eq!(number("fanuc-0i-tc"), [Some(1234); 3]);
    assert_eq!(number("fanuc-0i-td"), [None; 3]);
}

#[test]
fn cycles_may_be_read_in_one_form_only() {
    let one = "G0 X50. Z2. M3 S500\nG75 X40. I5. F0.1\nM30\n";
    let two = "G0 X50. Z2. M3 S500\nG75 X40. P5000 F0.1\nM30\n";
    let run = |text: &str, is_one_block: &str| {
        let conditions = Conditions::on("fanuc-0i-tf").with("0001#1", is_one_block);
        let mut control = Control::load("fanuc-0i-tf").expect("a control");
        control.policies.cycle_form = CycleForm::ByParameter;
        run_on(control, text.as_bytes(), &conditions).diagnostics()
    };
    assert_eq!(run(one, "0"), "alarm PS0066 cycle-word-illegal 2:10-13\n");
    assert_eq!(run(two, "1"), "alarm PS0066 cycle-word-illegal 2:10-15\n");
    assert_eq!((run(one, "1"), run(two, "0")), (String::new(), String::new()));
}

#[test]
fn pockets_may_be_limited() {
    // Two pockets, at Z-12 and Z-32.
    let text = "G98 F100. T0101\nG00 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4\nN10 G00 X50. W0\nG01 Z-10.\n\
                X44. Z-12.\nX50. Z-14.\nZ-30.\nX44. Z-32.\nX50. Z-34.\nN20 X60.\nM30\n";
    let run = |pockets_max: u32| {
        let mut control = Control::load("fanuc-0i-tf").expect("a control");
        control.limits.pockets_max = pockets_max;
        run_on(control, text.as_bytes(), &Conditions::on("fanuc-0i-tf"))
    };
    assert_eq!(run(1).diagnostics().lines().last(), Some("alarm T332 too-many-pockets 4:1-4"));
    for enough in [0, 2, 30] {
        assert!(run(enough).alarm.is_none(), "{}", run(enough).diagnostics());
    }
}

#[test]
fn a_run_out_may_be_as_deep_as_long() {
    let text = "S600 M03\nG00 X25 Z5\nG92 X20 Z-20 F2 K2\nM30\n";
    let run = |policy| {
        let mut control = Control::load("gsk-980tdi").expect("a control");
        control.policies.run_out_length_alone = policy;
        run_on(control, text.as_bytes(), &Conditions::on("gsk-980tdi")).listing()
    };
    assert!(
        run(RunOutLengthAlone::AsDeepAsLong).contains("thread d20 z-18 lead2  G92 thread 1\nthread d24 z-20")
    );
    assert!(run(RunOutLengthAlone::NoRunOut).contains("thread d20 z-20 lead2  G92 thread 1\nrapid d25 z-20"));
}

#[test]
fn a_groove_without_its_peck_may_plunge_in_one_go() {
    let text = "G0 X50. Z-5. M3 S500\nG75 X20. F0.1\nM30\n";
    let run = run_with(text, 0, |policies| policies.groove_without_peck = GrooveWithoutPeck::OnePlunge);
    assert_eq!(run.diagnostics(), "warning T069 groove-step-omitted 2:1-14\n");
    assert!(run.listing().contains("feed d20 z-5 f0.1/rev  G75 peck 1\n"), "{}", run.listing());
}

#[test]
fn the_finishing_cycle_may_take_the_figure_that_was_roughed() {
    // Two figures with the same numbers: the second one is roughed, then finished.
    let text = "G98 F100. M03 S500\nN10 G00 X20.\nN20 G01 Z-5.\nG00 X50. Z2.\nG71 U5. R1.\nG71 P10 Q20\n\
                N10 G00 X30.\nN20 G01 Z-9.\nG70 P10 Q20\nM30\n";
    let finished = |policy| {
        let run = run_with(text, 0, |policies| policies.finishing_figure = policy);
        assert!(run.alarm.is_none(), "{}", run.diagnostics());
        let finish = run.listing();
        finish.lines().find(|line| line.contains("G70 finish")).unwrap_or_default().to_string()
    };
    assert!(finished(FinishingFigure::Remembered).starts_with("rapid d30"));
    assert!(finished(FinishingFigure::Searched).starts_with("rapid d20"));
}

#[test]
fn compensation_may_shift_a_turning_cycle_by_its_code() {
    let setup = "[offsets.1]\ngeometry = { r = 1 }\n";
    let text = |code: &str| {
        format!("G98 F100. T0101\nG00 X60. Z2.\n{code} G90 X40. Z-20. R-5.\nG40 G00 X80.\nM30\n")
    };
    let run = |code: &str, policy| {
        let mut control = Control::load("fanuc-0i-tf").expect("a control");
        control.policies.single_cycle_side = policy;
        let conditions = Conditions { setup: setup.to_string(), ..Conditions::on("fanuc-0i-tf") };
        run_on(control, text(code).as_bytes(), &conditions).listing()
    };
    let (left, right) = ("G41", "G42");
    assert_eq!(run(left, SingleCycleSide::Start), run(right, SingleCycleSide::Start));
    assert_eq!(run(right, SingleCycleSide::Code), run(right, SingleCycleSide::Start), "outside it is G42");
    // With G41 the nose is on the other side of the cone, twice as far away as the slant makes its radius.
    let end = |listing: String| {
        let cut = listing.lines().find(|line| line.contains("G90 cut")).unwrap_or_default().to_string();
        cut.split(['d', ' ']).find_map(|word| word.parse::<f64>().ok()).expect("X")
    };
    let (start, code) = (end(run(left, SingleCycleSide::Start)), end(run(left, SingleCycleSide::Code)));
    let slanted = 2.0 * (5.0_f64.hypot(22.0) / 22.0);
    assert!(
        (start - 40.0 - slanted).abs() < 0.002 && (40.0 - code - slanted).abs() < 0.002,
        "{start} {code}"
    );
}

#[test]
fn the_word_for_the_way_of_pecking_may_be_the_other_way_round() {
    let text = "G0 X0 Z2 M3 S500\nG83 Z-5 Q5000 R1 J1 F100\nM30\n";
    let mut control = Control::load("gsk-980tdi").expect("a control");
    control.policies.peck_mode_word = PeckModeWord::OneIsShort;
    let run = run_on(control, text.as_bytes(), &Conditions::on("gsk-980tdi"));
    assert!(run.listing().contains("rapid d0 z-2  G83 back 1\nfeed d0 z-5"), "{}", run.listing());
}

/// Surface, levels, last pass and level of the start, diameters, of roughing a cylinder from X40.
fn cylinder_levels(words: &str, change: impl FnOnce(&mut Policies)) -> Vec<String> {
    let mut control = Control::load("gsk-980tdi").expect("a control");
    change(&mut control.policies);
    let conditions =
        Conditions { setup: "machine = \"turn-mill\"\n".to_string(), ..Conditions::on("gsk-980tdi") };
    let text = format!("G98 G01 X40 Z0 F100\nG07.1 C20 {words}\nZ-5\nG07.1 C0\nM30\n");
    let listing = run_on(control, text.as_bytes(), &conditions).listing();
    let moves = listing.lines().filter(|line| line.contains("approach") || line.contains("infeed"));
    moves.filter_map(|line| line.split_whitespace().nth(1)).map(str::to_string).collect()
}

#[test]
fn roughing_on_a_cylinder_may_be_read_in_other_ways() {
    let words = "J-2 K0.2 R1 L2";
    assert_eq!(cylinder_levels(words, |_| {}), ["d46.2", "d42.2", "d40.2", "d40"]);
    let levels = |change: fn(&mut Policies)| cylinder_levels(words, change);
    let surface = levels(|policies| policies.cylinder_roughing = CylinderRoughing::SurfaceAtStart);
    assert_eq!(surface, ["d42", "d38", "d36", "d35.8"]);
    let radii = levels(|policies| policies.cylinder_roughing_words = CylinderRoughingWords::Radii);
    assert_eq!(radii, ["d46.4", "d42.4", "d40.4", "d40"]);
    let diameters = levels(|policies| policies.cylinder_roughing_words = CylinderRoughingWords::Diameters);
    assert_eq!(diameters, ["d43.2", "d41.2", "d40.2", "d40"]);
    let total = levels(|policies| policies.cylinder_roughing_total = CylinderRoughingTotal::WithAllowance);
    assert_eq!(total, ["d46", "d42.1", "d40.2", "d40"]);
    let way_out = |policies: &mut Policies| policies.cylinder_roughing_sign = CylinderRoughingSign::WayOut;
    assert_eq!(cylinder_levels("J2 K0.2 R1 L2", way_out), ["d46.2", "d42.2", "d40.2", "d40"]);
    assert_eq!(cylinder_levels(words, way_out), ["d33.8", "d37.8", "d39.8", "d40"]);
}

#[test]
fn an_allowance_may_leave_nothing_to_rough_on_a_cylinder() {
    let mut control = Control::load("gsk-980tdi").expect("a control");
    control.policies.cylinder_roughing_total = CylinderRoughingTotal::WithAllowance;
    let conditions =
        Conditions { setup: "machine = \"turn-mill\"\n".to_string(), ..Conditions::on("gsk-980tdi") };
    let text = b"G98 G01 X40 Z0 F100\nG07.1 C20 J-2 K4 R1 L2\nZ-5\nG07.1 C0\nM30\n";
    let run = run_on(control, text, &conditions);
    assert_eq!(run.alarm.expect("an alarm").key, "cylinder-roughing-zero");
}

#[test]
fn run_out_words_of_a_thread_may_stay() {
    let text = b"S500 M03\nG00 X20. Z2.\nG32 Z-10. F2 J2 K2\nG00 X40.\nZ2.\nX20.\nG32 Z-10. F2\nG00 X40.\nZ2.\nX20.\n\
                 G32 Z-10. F2 J0\nG00 X40.\nZ2.\nX20.\nG32 Z-10. F2\nM30\n";
    let run = |kept| {
        let mut control = Control::load("gsk-980tdi").expect("a control");
        control.policies.run_out_words_kept = kept;
        let run = run_on(control, text, &Conditions::on("gsk-980tdi"));
        let listing = run.listing();
        let threads: Vec<String> =
            listing.lines().filter(|line| line.starts_with("thread")).map(str::to_string).collect();
        (threads.join("; "), run.diagnostics())
    };
    let own = "thread d20 z-8 lead2; thread d24 z-10 lead2 chained";
    let plain = "thread d20 z-10 lead2";
    let (threads, words) = run(RunOutWordsKept::OwnBlock);
    assert_eq!(threads, [own, plain, plain, plain].join("; "));
    assert_eq!(words, "warning T428 run-out-may-stay 7:1-13\n");
    // The second thread is left as the first; J0 of the third counts for the fourth.
    let (threads, words) = run(RunOutWordsKept::UntilChanged);
    assert_eq!(threads, [own, own, plain, plain].join("; "));
    assert_eq!(words, "");
}
