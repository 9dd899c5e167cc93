//! Where time could be saved: each piece of advice with a program that gets it, and one that does not.

mod support;

use turnwright_control::Setup;
use turnwright_motion::{Gear, Gears, MachineRates, Schedule};
use turnwright_stock::machining::RapidRates;
use turnwright_verify::advice::{Advice, Advisor};
use turnwright_verify::part::PartRun;

fn setup() -> Setup {
    Setup::parse(
        "[stock]\ndiameter_mm = 50\nlength_mm = 80\n[tools.1]\ninsert = \"CNMG120408\"\n\
         [tools.2]\ninsert = \"CNMG120408\"\n",
    )
    .expect("a setup")
}

/// Key, line and seconds of the advice on a program for a bar of 50 by 80 mm.
fn advised(program: &str) -> Vec<(&'static str, u32, f64)> {
    advised_on(program, MachineRates::default())
}

fn advised_on(program: &str, rates: MachineRates) -> Vec<(&'static str, u32, f64)> {
    let setup = setup();
    let run = support::run(program, "fanuc-0i-tf", &setup);
    assert_eq!(run.alarm, None);
    let rapid = RapidRates { x_mm_per_min: rates.rapid_x_mm_per_min, z_mm_per_min: rates.rapid_z_mm_per_min };
    let mut part = PartRun::new(&setup, &setup, run.start, rapid).expect("a setup").expect("a stock");
    let mut schedule = Schedule::new(run.start, rates);
    let mut advisor = Advisor::new(&setup, rates);
    let mut removed = std::collections::VecDeque::new();
    for command in &run.commands {
        removed.push_back(part.add(command));
        schedule.push(command.clone());
    }
    schedule.finish();
    while let Some((command, timing)) = schedule.next_known() {
        advisor.add(&command, &timing, removed.pop_front().flatten().as_ref());
    }
    let told =
        |one: Advice| (one.diagnostic.key, one.diagnostic.place.map_or(0, |place| place.line), one.seconds);
    advisor.finish().into_iter().map(told).collect()
}

fn keys(program: &str) -> Vec<(&'static str, u32)> {
    advised(program).into_iter().map(|(key, line, _)| (key, line)).collect()
}

const HEAD: &str = "T0101\nG97 S1000 M03\nG99 F0.2\n";

#[test]
fn a_cut_through_air_is_told_and_one_that_takes_material_is_not() {
    // 40 mm at 200 mm/min are 12 s; the way at rapid takes 0.3 s.
    let air = advised(&format!("{HEAD}G00 X60. Z1.\nG01 Z-39.\nG00 X80.\nZ50.\nM30\n"));
    assert_eq!(air.len(), 1);
    let (key, line, seconds) = air[0];
    assert_eq!((key, line), ("advice-air-cut", 5));
    assert!((seconds - 11.7).abs() < 0.1, "{seconds}");
    assert_eq!(keys(&format!("{HEAD}G00 X46. Z1.\nG01 Z-39.\nG00 X80.\nZ50.\nM30\n")), []);
    // The same way once more is a spring cut.
    let twice = "G00 X46. Z1.\nG01 Z-39.\nX52.\nG00 Z1.\nX46.\nG01 Z-39.\nX52.\nG00 Z1.\n";
    assert_eq!(keys(&format!("{HEAD}{twice}G00 X80. Z50.\nM30\n")), []);
    // A tool of which nobody knows the shape takes nothing away, and nothing is said of it.
    let unknown = HEAD.replace("T0101", "T0909");
    assert_eq!(keys(&format!("{unknown}G00 X60. Z1.\nG01 Z-39.\nG00 X80.\nM30\n")), []);
}

#[test]
fn a_start_far_out_is_told() {
    // 20 mm before the face at 200 mm/min; 2 mm are enough: 18 mm are 5.4 s.
    let far = advised(&format!("{HEAD}G00 X46. Z20.\nG01 Z-30.\nG00 X80.\nM30\n"));
    assert_eq!(far.len(), 1);
    assert_eq!((far[0].0, far[0].1), ("advice-far-start", 5));
    assert!((far[0].2 - 5.4).abs() < 0.5, "{}", far[0].2);
    assert_eq!(keys(&format!("{HEAD}G00 X46. Z3.\nG01 Z-30.\nG00 X80.\nM30\n")), []);
}

#[test]
fn a_chip_too_thin_is_told_of_roughing_only() {
    let cut = |feed: &str, x: &str| format!("{HEAD}G00 X{x} Z2.\nG01 Z-30. F{feed}\nG00 X80.\nM30\n");
    // 2 mm deep with a nose of 0.8: at least 0.1 mm/rev.
    assert_eq!(keys(&cut("0.05", "46.")), [("advice-slow-feed", 5)]);
    assert_eq!(keys(&cut("0.1", "46.")), []);
    // A finishing cut of 0.2 mm may be as fine as it likes.
    assert_eq!(keys(&cut("0.05", "49.6")), []);
}

#[test]
fn a_clamp_below_what_the_machine_can_is_told_at_its_block() {
    let cut = |limit: &str| {
        format!("T0101\nG50 S{limit}\nG96 S250 M03\nG99 F0.2\nG00 X46. Z2.\nG01 Z-60.\nG00 X80.\nM30\n")
    };
    // 250 m/min on 46 mm ask for 1730 rpm.
    assert_eq!(keys(&cut("1000")), [("advice-speed-clamp", 3)]);
    assert_eq!(keys(&cut("2000")), []);
    // What the machine cannot do is not asked for, nor what its gear cannot.
    assert_eq!(keys(&cut("9000").replace("S250", "S900")), []);
    let gear = |code, rpm_max| Gear { code, rpm_min: 0.0, rpm_max, ramp_rpm_per_s: 1000.0 };
    let gears = Gears::new([gear(41, 900.0), gear(42, 4000.0)]);
    let rates = MachineRates { gears, ..MachineRates::default() };
    assert!(advised_on(&cut("1000"), rates).is_empty());
    let in_second = cut("1000").replace("G50", "M42\nG50");
    assert_eq!(advised_on(&in_second, rates)[0].0, "advice-speed-clamp");
}

#[test]
fn a_long_dwell_behind_a_cut_is_told_and_one_behind_an_m_code_is_not() {
    let dwell = |before: &str, seconds: &str| {
        format!("{HEAD}G00 X52. Z-20.\nG01 X46.\n{before}G04 X{seconds}\nG00 X80.\nM30\n")
    };
    assert_eq!(keys(&dwell("", "2.")), [("advice-long-dwell", 6)]);
    // Three turns at 1000 rpm are 0.18 s.
    assert_eq!(keys(&dwell("", "0.3")), []);
    assert_eq!(keys(&dwell("M10\n", "2.")), []);
}

#[test]
fn a_way_to_the_turret_and_back_without_a_reason_is_told() {
    let way = |out_there: &str| {
        format!(
            "{HEAD}G00 X46. Z2.\nG01 Z-30.\nG00 X200. Z200.\n{out_there}X42. Z2.\nG01 Z-30.\nG00 X80.\nM30\n"
        )
    };
    assert_eq!(keys(&way("")), [("advice-needless-return", 6)]);
    assert_eq!(keys(&way("M00\n")), []);
    assert_eq!(keys(&way("T0202\n")), []);
}
