//! Running a program text in memory, for tests.
#![allow(dead_code, reason = "not every test uses everything")]

use turnwright_canon::Command;
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::{Diagnostic, Severity, SourceId};
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};
use turnwright_units::{Position, WorkTip};
use turnwright_verify::{Checks, TextChecks};

struct Memory<'a>(&'a [u8]);

impl Environment for Memory<'_> {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = self.0.get(offset as usize..).unwrap_or(&[]);
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

/// What a run gave.
pub struct Run {
    pub start: Position<WorkTip>,
    pub commands: Vec<Command>,
    pub text: Vec<Diagnostic>,
    pub alarm: Option<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
}

/// Everything that `check` tells of a run: keys of the alarm, of warnings and of checks. Notes are no faults.
pub fn checked_keys(run: &Run, setup: &Setup) -> Vec<&'static str> {
    let mut checks = Checks::new(run.start);
    run.commands.iter().for_each(|command| checks.add(command));
    let found = checks.finish(setup).findings;
    let told = run.warnings.iter().chain(&run.alarm).chain(&run.text).chain(&found);
    told.filter(|diagnostic| diagnostic.severity > Severity::Note).map(|diagnostic| diagnostic.key).collect()
}

/// Runs a program on a control with a setup.
pub fn run(text: &str, control: &str, setup: &Setup) -> Run {
    run_with(text, control, setup, |interpreter| interpreter)
}

/// The same with sharp tools.
pub fn run_sharp(text: &str, control: &str, setup: &Setup) -> Run {
    run_with(text, control, setup, Interpreter::with_sharp_noses)
}

fn run_with(text: &str, control: &str, setup: &Setup, kind: fn(Interpreter) -> Interpreter) -> Run {
    let mut control = Control::load(control).unwrap_or_else(|fault| panic!("{fault:?}"));
    for (number, value) in setup.parameter_words() {
        control.parameters.set(&number, &value).unwrap_or_else(|fault| panic!("{fault:?}"));
    }
    let options = Options { blocks_max: 100_000, idle_blocks_max: 100_000 };
    let interpreter =
        Interpreter::new(control, setup, SourceId(0), options).unwrap_or_else(|fault| panic!("{fault:?}"));
    let mut interpreter = kind(interpreter);
    let mut checks = TextChecks::default();
    text.lines().for_each(|line| checks.add(line.as_bytes()));
    let mut run = Run {
        start: interpreter.position(),
        commands: Vec::new(),
        text: checks.finish(),
        alarm: None,
        warnings: Vec::new(),
    };
    loop {
        match interpreter.step(&mut Memory(text.as_bytes())) {
            Step::Emit(command) => run.commands.push(command),
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => {
                run.alarm = Some(*alarm);
                break;
            }
            Step::End => break,
        }
    }
    run.warnings = interpreter.take_warnings();
    run
}
