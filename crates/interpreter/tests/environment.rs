//! What a program asks of the world: other programs, signals, the calendar, where the axes are.

mod support;

use support::Conditions;
use turnwright_canon::{Action, write_listing};
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_interpreter::{
    DateTime, Environment, Interpreter, Options, ProgramName, ReadFault, Step, SyncReason,
};

/// A machine beside the control.
#[derive(Default)]
struct Machine {
    /// The program in work, then those in other files.
    texts: Vec<&'static str>,
    /// Which of them a name or number means.
    names: Vec<(&'static str, u32)>,
    inputs: u32,
    outputs: u32,
    now: Option<DateTime>,
    uptime_ms: u64,
    /// Before which blocks, counted while interrupts are allowed, the signal comes.
    interrupts: Vec<u32>,
    asked: u32,
}

impl Machine {
    fn with(text: &'static str) -> Self {
        Self { texts: vec![text], ..Self::default() }
    }

    fn and(mut self, name: &'static str, text: &'static str) -> Self {
        self.names.push((name, self.texts.len() as u32));
        self.texts.push(text);
        self
    }
}

impl Environment for Machine {
    fn read(&mut self, source: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let text = self.texts.get(source.0 as usize).ok_or(ReadFault)?.as_bytes();
        let rest = text.get(offset as usize..).unwrap_or(&[]);
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }

    fn program(&mut self, name: ProgramName<'_>) -> Option<SourceId> {
        let wanted = match name {
            ProgramName::Number(number) => number.to_string(),
            ProgramName::Text(text) => text.to_string(),
        };
        self.names.iter().find(|(known, _)| *known == wanted).map(|(_, source)| SourceId(*source))
    }

    fn now(&self) -> Option<DateTime> {
        self.now
    }

    fn uptime_ms(&self) -> u64 {
        self.uptime_ms
    }

    fn macro_input(&self, signal: u8) -> bool {
        self.inputs >> signal & 1 == 1
    }

    fn set_macro_output(&mut self, signal: u8, is_on: bool) {
        self.outputs = self.outputs & !(1 << signal) | u32::from(is_on) << signal;
    }

    fn interrupts(&mut self) -> bool {
        self.asked += 1;
        self.interrupts.contains(&self.asked)
    }
}

/// What a run gives, one word or command a line: waits and the alarm are told too.
fn told(machine: &mut Machine, control: &str) -> Vec<String> {
    told_with(machine, &Conditions::on(control))
}

fn told_with(machine: &mut Machine, conditions: &Conditions) -> Vec<String> {
    let mut control = Control::load(&conditions.control).expect("known");
    for (number, value) in &conditions.parameters {
        control.parameters.set(number, value).expect("a parameter");
    }
    let setup = Setup::parse("").expect("empty");
    let options = Options { blocks_max: 10_000, idle_blocks_max: 10_000 };
    let mut interpreter = Interpreter::new(control, &setup, SourceId(0), options).expect("starts");
    let mut told = Vec::new();
    loop {
        match interpreter.step(machine) {
            Step::Emit(command) => {
                let mut line = Vec::new();
                write_listing(&mut line, &command, 3);
                told.push(String::from_utf8(line).expect("text"));
            }
            Step::NeedSync(SyncReason::MovesDone) => told.push("wait".to_string()),
            Step::NeedSync(SyncReason::CycleStart) => told.push("cycle start".to_string()),
            Step::Alarm(alarm) => {
                let line = alarm.place.map_or(0, |place| place.line);
                told.push(format!("alarm {} line {line} of text {}", alarm.key, source(&alarm)));
                return told;
            }
            Step::End => return told,
        }
        assert!(told.len() < 1_000, "{told:?}");
    }
}

fn source(diagnostic: &turnwright_diagnostics::Diagnostic) -> u32 {
    diagnostic.place.map_or(0, |place| place.source.0)
}

#[test]
fn programs_in_other_files() {
    let mut machine = Machine::with("O1\nG0 X50. Z2.\nM98 P20\nG65 P30 A7.\nM98 P20 L2\nM30\n")
        .and("20", "%\nO20 (IN ITS OWN FILE)\nU-1.\nM99\n%\n")
        .and("30", "#2=#1\nX#2\nM98 P40\nM99\n")
        .and("40", "O41\nX99.\nM99\nO40\nX4.\nM99\n");
    let expected =
        ["rapid d50 z2", "rapid d49 z2", "rapid d7 z2", "rapid d4 z2", "rapid d3 z2", "rapid d2 z2", "end"];
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), expected);
    let mut machine = Machine::with("O1\nG0 X50. Z2.\nM98 P[SHAFT]\nG65 P[FLANGE.CNC] A7\nM30\n")
        .and("SHAFT", "U-1\nM99\n")
        .and("FLANGE.CNC", "X#1\nM99\n");
    let expected = ["rapid d50 z2", "rapid d49 z2", "rapid d7 z2", "end"];
    assert_eq!(told(&mut machine, "gsk-988ta"), expected);
}

#[test]
fn jumps_and_loops_stay_in_their_file() {
    let mut machine = Machine::with("O1\nG0 X50. Z2.\nM98 P20 L2\nGOTO 5\nX99.\nN5 X5.\nM30\n").and(
        "20",
        "O20\n#1=0\nN5 U-1.\n#1=#1+1\nIF[#1 LT 2]GOTO 5\nWHILE[#1 LT 4]DO1\n#1=#1+1\nW1.\nEND1\nM99\n",
    );
    let round = |x: i32, z: i32| {
        [(x - 1, z), (x - 2, z), (x - 2, z + 1), (x - 2, z + 2)].map(|(x, z)| format!("rapid d{x} z{z}"))
    };
    let mut expected = vec!["rapid d50 z2".to_string()];
    expected.extend(round(50, 2));
    expected.extend(round(48, 4));
    expected.extend(["rapid d5 z6".to_string(), "end".to_string()]);
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), expected);
}

#[test]
fn an_alarm_names_the_file_it_is_in() {
    let mut machine = Machine::with("O1\nM98 P20\nM30\n").and("20", "O20\n\n#1=1/0\nM99\n");
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["alarm divide-by-zero line 3 of text 1"]);
    let mut machine = Machine::with("O1\nM98 P20\nM30\n").and("20", "O20\nU1.\n");
    let told = told(&mut machine, "fanuc-0i-tf");
    assert!(told[1].starts_with("alarm end-of-record-without-end"), "{told:?}");
}

#[test]
fn programs_from_outside_do_not_call_further_ones() {
    let inside = "O1\nM198 P20\nM30\nO20\nG0 X99. Z0\nM99\n";
    let mut machine = Machine::with(inside).and("20", "O20\nG0 X1. Z2.\nM99\n");
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["rapid d1 z2", "end"], "the memory is not looked at");
    for (control, _) in [("fanuc-0i-tf", "PS0210"), ("gsk-988ta", "GSK-SUB-EXTERNAL")] {
        let mut machine =
            Machine::with("O1\nM198 P20\nM30\n").and("20", "O20\nM198 P30\nM99\n").and("30", "M99\n");
        assert_eq!(told(&mut machine, control), ["alarm external-call-not-allowed line 2 of text 1"]);
    }
}

#[test]
fn signals_of_the_machine() {
    let text = "O1\nG0 X#1000 Z#1003\nX#1032\nX[#1004+2]\n#1101=1\n#1100=#1003\n#1102=0\nG4 P#1132\n#1132=65\nG4 P#1106\nM30\n";
    let mut machine = Machine { inputs: 0b1_0000_0000_0000_1000, ..Machine::with(text) };
    let expected = ["rapid d0 z1", "rapid d8 z1", "rapid d2 z1", "dwell 0.003s", "dwell 0.001s", "end"];
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), expected);
    assert_eq!(machine.outputs, 65);
}

#[test]
fn m_codes_by_parameter_stop_reading_ahead() {
    let text = "O1\nM50\nG0 X1. Z2.\nM51\nX2.\nM62\nX3.\nM64\nM30\n";
    let conditions = Conditions::on("fanuc-0i-tf").with("3420", "51").with("3421", "60").with("3422", "63");
    let told = told_with(&mut Machine::with(text), &conditions);
    let waits: Vec<_> = told.windows(2).filter(|pair| pair[1] == "wait").map(|pair| &pair[0]).collect();
    assert_eq!(waits, ["auxiliary 51", "auxiliary 62"]);
    assert_eq!(told.last().map(String::as_str), Some("end"));
}

#[test]
fn a_program_waits_for_a_signal_by_looping() {
    let mut machine = Machine::with("O1\nN5 IF[#1002 EQ 0]GOTO 5\nG0 X1. Z2.\nM30\n");
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["alarm loop-without-motion line 2 of text 0"]);
    machine.inputs = 4;
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["rapid d1 z2", "end"]);
}

#[test]
fn the_calendar() {
    let text = "O1\nG0 X[#3011/10000] Z[#3012/10000]\n#3011=1\nM30\n";
    let now = DateTime { year: 2026, month: 11, day: 22, hour: 7, minute: 8, second: 45 };
    let mut machine = Machine { now: Some(now), ..Machine::with(text) };
    let expected = ["rapid d2026.112 z7.085", "alarm variable-write-protected line 3 of text 0"];
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), expected);
    let mut machine = Machine::with("O1\nG0 X#3011 Z#3012\nX1.\nM30\n");
    assert_eq!(told(&mut machine, "fanuc-0i-tf").first().map(String::as_str), Some("rapid d0 z0"));
}

#[test]
fn the_clock() {
    let text = "O1\nG4 P#3001\n#3001=0\nG4 P[#3001+5]\nM30\n";
    let mut machine = Machine { uptime_ms: 1_234, ..Machine::with(text) };
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["dwell 1.234s", "dwell 0.005s", "end"]);
    let mut machine = Machine { uptime_ms: 7_200_000, ..Machine::with("O1\nG4 P#3002\nM30\n") };
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), ["dwell 0.002s", "end"], "hours");
    let mut machine = Machine { uptime_ms: 7_200, ..Machine::with("O1\nG4 P#3001\n#3001=0\nM30\n") };
    let expected = ["dwell 0.007s", "alarm variable-write-protected line 3 of text 0"];
    assert_eq!(told(&mut machine, "gsk-980tdi"), expected, "seconds, to be read only");
}

#[test]
fn whoever_asks_where_the_axes_are_waits() {
    let text = "O1\nG0 X50. Z2.\n#1=#5041\n#2=#5042\nX[#1-10] Z[#5042+1]\nX[#5001-1]\nIF[#5021 LT 0]GOTO 9\nX1.\nN9 M30\n";
    let mut machine = Machine::with(text);
    let told = told(&mut machine, "fanuc-0i-tf");
    let expected = ["rapid d50 z2", "wait", "rapid d40 z3", "rapid d39 z3", "wait", "end"];
    // The machine stands below its reference point, or above: the last move shows it.
    let without_last: Vec<_> = told.iter().filter(|line| *line != "rapid d1 z3").cloned().collect();
    assert_eq!(without_last, expected);
    let looping = "O1\nG0 X50. Z2.\nN5 U-1.\nIF[#5041 GT 48]GOTO 5\nM30\n";
    let expected = ["rapid d50 z2", "rapid d49 z2", "wait", "rapid d48 z2", "wait", "end"];
    assert_eq!(told_with(&mut Machine::with(looping), &Conditions::on("fanuc-0i-tf")), expected);
}

#[test]
fn a_stop_with_a_message_waits_for_cycle_start() {
    let mut machine = Machine::with("O1\n#3006=1(TURN THE PART)\nG0 X1. Z2.\nM30\n");
    let expected = ["message TURN THE PART", "stop", "cycle start", "rapid d1 z2", "end"];
    assert_eq!(told(&mut machine, "fanuc-0i-tf"), expected);
}

#[test]
fn an_interrupt_runs_its_program_between_two_blocks() {
    let text = "O1\nG0 X50. Z2.\nM96 P8\nX40.\nX30.\nM97\nX20.\nM30\nO8\nW1.\nM99\n";
    // Asked before X40., before X30. and before M97.
    let expected = |place: usize| {
        let mut moves = vec!["rapid d50 z2", "rapid d40 z2", "rapid d30 z2", "rapid d20 z2", "end"];
        let (at, after): (_, &[&str]) = match place {
            1 => ("rapid d50 z3", &["rapid d40 z3", "rapid d30 z3", "rapid d20 z3"]),
            2 => ("rapid d40 z3", &["rapid d30 z3", "rapid d20 z3"]),
            _ => ("rapid d30 z3", &["rapid d20 z3"]),
        };
        moves.truncate(place);
        moves.push(at);
        moves.extend(after);
        moves.push("end");
        moves
    };
    for control in ["fanuc-0i-mate-tb", "fanuc-0i-tf", "gsk-988ta"] {
        for place in 1..=3 {
            let mut machine = Machine { interrupts: vec![place], ..Machine::with(text) };
            assert_eq!(told(&mut machine, control), expected(place as usize), "{control} {place}");
        }
        let mut machine = Machine { interrupts: (20..99).collect(), ..Machine::with(text) };
        let calm = told(&mut machine, control);
        assert_eq!(calm.len(), 5, "behind M97 nothing asks: {calm:?}");
    }
}

#[test]
fn an_interrupt_comes_between_kept_blocks_and_blocks_of_one_line() {
    let text = "O1\nG0 X50. Z2.\nM96 P8\n#1=0\nN5 #1=#1+1;U-1.;IF[#1 LT 4]GOTO 5\nM97\nM30\nO8\nW1.\nM99\n";
    let calm = told(&mut Machine::with(text), "fanuc-0i-tf");
    assert_eq!(calm, ["rapid d50 z2", "rapid d49 z2", "rapid d48 z2", "rapid d47 z2", "rapid d46 z2", "end"]);
    for place in 1..=12 {
        let mut machine = Machine { interrupts: vec![place], ..Machine::with(text) };
        let told = told(&mut machine, "fanuc-0i-tf");
        let raised = told.iter().filter(|line| line.ends_with("z3")).count();
        assert_eq!(told.len(), calm.len() + 1, "{place}: {told:?}");
        assert!(raised > 0 && told[told.len() - 2] == "rapid d46 z3", "{place}: {told:?}");
    }
}

#[test]
fn no_interrupt_inside_a_figure() {
    let text =
        "O1\nG98 G0 X60. Z2.\nM96 P8\nG70 P1 Q2\nM97\nM30\nN1 G0 X30.\nG1 Z-10. F100.\nN2 X60.\nO8\nM99\n";
    let mut machine = Machine { interrupts: vec![3], ..Machine::with(text) };
    let told = told(&mut machine, "fanuc-0i-tf");
    assert_eq!(
        told.last().map(String::as_str),
        Some("alarm macro-interrupt-in-cycle line 7 of text 0"),
        "{told:?}"
    );
}

#[test]
fn a_kept_block_reads_signals_anew() {
    // The output is what the next round asks for.
    let text =
        "O1\nG0 X50. Z2.\n#1=0\nN5 #1=#1+1\n#1100=#1-2*FIX[#1/2]\nX[#1100+#1*10]\nIF[#1 LT 4]GOTO 5\nM30\n";
    let mut machine = Machine::with(text);
    let expected = ["rapid d50 z2", "rapid d11 z2", "rapid d20 z2", "rapid d31 z2", "rapid d40 z2", "end"];
    assert_eq!(told(&mut machine, "fanuc-0i-mate-tb"), expected);
    assert_eq!(machine.outputs, 0);
}

#[test]
fn output_is_a_command() {
    let mut machine = Machine::with("O1\nPOPEN\n#1=2.5\nDPRNT[X#1[22]]\nPCLOS\nM30\n");
    let control = Control::load("fanuc-0i-tf").expect("known");
    let setup = Setup::parse("").expect("empty");
    let mut interpreter = Interpreter::new(control, &setup, SourceId(0), Options::default()).expect("starts");
    match interpreter.step(&mut machine) {
        Step::Emit(command) => {
            assert_eq!(command.action, Action::Output("X  2.50".into()));
            assert_eq!(command.origin.line, 4);
        }
        other => panic!("{other:?}"),
    }
}
