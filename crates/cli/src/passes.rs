//! The passes of cycles, collected while a program runs, and the words for what caused them.

use turnwright_canon::Command;
use turnwright_control::{Functions, Parameters};
use turnwright_diagnostics::SourceId;
use turnwright_export::passes::{BlockFacts, Cause, Cycle, GivenWord, PassRecorder, Setting, parameters_of};
use turnwright_interpreter::Interpreter;
use turnwright_syntax::{Block, scan_block};

use crate::environment::LineFinder;
use crate::execution::Execution;
use crate::report::code_system;
use crate::speech::Speech;

/// Collects the passes of a program.
#[derive(Debug)]
pub(crate) struct Passes {
    recorder: PassRecorder,
    finder: LineFinder,
}

impl Passes {
    /// None yet.
    pub(crate) fn new(execution: &Execution<'_>) -> Self {
        Self {
            recorder: PassRecorder::new(execution.interpreter().position()),
            finder: LineFinder::default(),
        }
    }

    /// The next command.
    #[inline]
    pub(crate) fn add(&mut self, command: &Command, execution: &Execution<'_>) {
        let Self { recorder, finder } = self;
        recorder.add(command, |command| {
            let origin = command.origin;
            let text = execution.text_of(SourceId(origin.source));
            let block = finder.line(text, origin.source, origin.line);
            facts(command, execution.interpreter(), &block)
        });
    }

    /// The cycles that have ended so far.
    pub(crate) fn cycles(&self) -> &[Cycle] {
        self.recorder.cycles()
    }

    /// The cycles that ran, and how many passes were too many to keep.
    pub(crate) fn finish(self) -> (Vec<Cycle>, u64) {
        self.recorder.finish()
    }
}

/// What is known of the block that runs a cycle.
fn facts(command: &Command, interpreter: &Interpreter, block: &[u8]) -> BlockFacts {
    let control = interpreter.control();
    let function = command
        .origin
        .cycle
        .and_then(|cycle| Functions.by_code(cycle.label.0, code_system(control), control.code_table))
        .map_or("", |(name, _)| name);
    let wanted = parameters_of(function);
    let parameters = if wanted.is_empty() { None } else { Some(interpreter.parameters()) };
    BlockFacts {
        function: function.to_string(),
        words: words(block),
        settings: parameters.map_or(Vec::new(), |parameters| settings(wanted, &parameters, interpreter)),
        crest: interpreter.thread_crest().filter(|_| wanted.contains(&"thread-minimum-depth")),
    }
}

fn settings(
    wanted: &'static [&'static str],
    parameters: &Parameters,
    interpreter: &Interpreter,
) -> Vec<Setting> {
    let setting = |name: &&'static str| {
        let given = interpreter.given_parameters().iter().find(|given| given.parameter == *name);
        Some(Setting {
            name,
            number: parameters.number(name)?.to_string(),
            value: parameters.value(name),
            given: given.map(|given| GivenWord { text: given.word.clone(), line: given.line }),
        })
    };
    wanted.iter().filter_map(setting).collect()
}

/// The words of a block: letter and text.
fn words(block: &[u8]) -> Vec<(u8, String)> {
    let mut scanned = Block::new();
    scan_block(block, 0, &mut scanned);
    let text = |start: u32, end: u32| block.get(start as usize..end as usize).unwrap_or_default();
    scanned
        .words
        .iter()
        .map(|word| (word.address, String::from_utf8_lossy(text(word.start, word.end)).into_owned()))
        .collect()
}

/// A cause in words.
pub(crate) fn cause_text(cause: &Cause, speech: Speech) -> String {
    match cause {
        Cause::Word(GivenWord { text, line }) => {
            speech.fill("pass-by-word", &[("word", text), ("line", &line.to_string())])
        }
        Cause::Parameter(number) => speech.fill("pass-by-parameter", &[("number", number)]),
        Cause::Figure(first, last) => {
            let key = if first == last { "pass-by-figure-line" } else { "pass-by-figure-lines" };
            speech.fill(key, &[("first", &first.to_string()), ("last", &last.to_string())])
        }
    }
}

/// Where a parameter of a cycle got its value.
pub(crate) fn source_of(setting: &Setting) -> Cause {
    setting.given.clone().map_or_else(|| Cause::Parameter(setting.number.clone()), Cause::Word)
}

/// What a parameter is called on the control.
pub(crate) fn setting_name(setting: &Setting, parameters: &Parameters, speech: Speech) -> String {
    let found = parameters.find(&setting.number);
    found.map_or(setting.number.clone(), |(_, parameter, _)| parameter.name(speech.language).to_string())
}
