//! Running a program text in memory, for tests.
#![allow(clippy::disallowed_methods, dead_code, reason = "tests read files; not every test uses everything")]

use turnwright_canon::{Command, write_listing};
use turnwright_control::{AxisPair, Control, Language, Messages, Setup};
use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, SignalMove, Step};
use turnwright_units::{Position, WorkTip};

/// A text in memory, and switches.
pub struct Memory<'a> {
    pub text: &'a [u8],
    pub skips: &'a [u8],
    pub setup: Option<&'a Setup>,
    /// Most bytes given at once; 0 is as many as are asked for.
    pub bytes_at_once: usize,
}

impl Environment for Memory<'_> {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = self.text.get(offset as usize..).unwrap_or(&[]);
        let most = if self.bytes_at_once == 0 { usize::MAX } else { self.bytes_at_once };
        let length = rest.len().min(buffer.len()).min(most);
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, switch: u8) -> bool {
        self.skips.contains(&switch)
    }

    fn signal(&mut self, wait: &SignalMove) -> Option<f64> {
        let pair =
            |place: Position<WorkTip>| AxisPair { x: place.x.to_diameter().0.to_mm(), z: place.z.to_mm() };
        self.setup?.signal(wait.line, wait.input, pair(wait.from), pair(wait.to))
    }
}

/// What a run gave.
pub struct Run {
    pub commands: Vec<Command>,
    pub alarm: Option<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
    pub control: Control,
    pub decimals: u8,
}

/// How a program is run.
#[derive(Clone, Default)]
pub struct Conditions {
    pub control: String,
    pub parameters: Vec<(String, String)>,
    pub skips: Vec<u8>,
    pub setup: String,
    pub machine: Option<String>,
    /// Cycle starts after the end of the program.
    pub restarts: u32,
    /// Most bytes of the text that are read at once; 0 is as many as are asked for.
    pub bytes_at_once: usize,
    /// Blocks executed at most; 0 is the bound of all tests.
    pub blocks_max: u64,
}

impl Conditions {
    pub fn on(control: &str) -> Self {
        Self { control: control.to_string(), ..Self::default() }
    }

    pub fn with(mut self, number: &str, value: &str) -> Self {
        self.parameters.push((number.to_string(), value.to_string()));
        self
    }
}

/// Runs a program to its end; refuses to run for ever.
pub fn run(text: &[u8], conditions: &Conditions) -> Run {
    let control = Control::load(&conditions.control).unwrap_or_else(|fault| panic!("{fault:?}"));
    run_on(control, text, conditions)
}

/// As [`run`], on a control whose policies the caller has changed.
pub fn run_on(mut control: Control, text: &[u8], conditions: &Conditions) -> Run {
    let mut setup = Setup::parse(&conditions.setup).unwrap_or_else(|fault| panic!("{fault:?}"));
    if conditions.machine.is_some() {
        setup.machine.clone_from(&conditions.machine);
    }
    for (number, value) in setup.parameter_words().iter().chain(&conditions.parameters) {
        control.parameters.set(number, value).unwrap_or_else(|fault| panic!("{fault:?}"));
    }
    let blocks_max = if conditions.blocks_max == 0 { 200_000 } else { conditions.blocks_max };
    let options = Options { blocks_max, idle_blocks_max: blocks_max };
    let mut interpreter = Interpreter::new(control.clone(), &setup, SourceId(0), options)
        .unwrap_or_else(|fault| panic!("{fault:?}"));
    let decimals = interpreter.decimals();
    let mut environment = Memory {
        text,
        skips: &conditions.skips,
        setup: Some(&setup),
        bytes_at_once: conditions.bytes_at_once,
    };
    let mut run = Run { commands: Vec::new(), alarm: None, warnings: Vec::new(), control, decimals };
    let mut restarts = conditions.restarts;
    loop {
        match interpreter.step(&mut environment) {
            Step::Emit(command) => run.commands.push(command),
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => {
                run.alarm = Some(*alarm);
                break;
            }
            Step::End if restarts > 0 => {
                restarts -= 1;
                interpreter.start_again();
            }
            Step::End => break,
        }
        assert!(run.commands.len() < 2_000_000, "too many commands for a test");
    }
    run.warnings = interpreter.take_warnings();
    run
}

impl Run {
    /// The listing, one command a line.
    pub fn listing(&self) -> String {
        let mut out = Vec::new();
        for command in &self.commands {
            write_listing(&mut out, command, self.decimals);
            out.push(b'\n');
        }
        String::from_utf8(out).expect("a listing is text")
    }

    /// The listing as single-block operation sees it: an empty line where the control stops.
    pub fn single_blocks(&self) -> String {
        let mut out = Vec::new();
        for command in &self.commands {
            write_listing(&mut out, command, self.decimals);
            out.extend_from_slice(if command.origin.runs_on { b"\n" } else { b"\n\n" });
        }
        String::from_utf8(out).expect("a listing is text")
    }

    /// Diagnostics as a fixture shows them: `alarm PS0062 cut-depth-illegal 2:5-8 'U0.'`.
    pub fn diagnostics(&self) -> String {
        let mut out = String::new();
        for diagnostic in self.warnings.iter().chain(&self.alarm) {
            let id = Messages.id_of(diagnostic, self.control.alarm_ids).unwrap_or("?".into());
            let severity = format!("{:?}", diagnostic.severity).to_lowercase();
            let place = diagnostic.place.map_or(String::new(), |place| {
                format!(" {}:{}-{}", place.line, place.column, place.end_column)
            });
            out.push_str(&format!("{severity} {id} {}{place}\n", diagnostic.key));
            let raw = Messages
                .raw(diagnostic.key, Language::English)
                .unwrap_or_else(|| panic!("{}", diagnostic.key));
            for name in raw.message.split('{').skip(1).filter_map(|part| part.split('}').next()) {
                let given = diagnostic.arguments.iter().any(|(known, _)| *known == name);
                assert!(given, "{}: nothing is put in for {{{name}}}", diagnostic.key);
            }
        }
        out
    }
}
