//! A program on its way: steps, warnings, the alarm.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use turnwright_canon::{Action, Command};
use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_interpreter::{Interpreter, Options, Step};

use crate::arguments::Machine;
use crate::environment::{Panel, ProgramText};
use crate::finding::Finding;
use crate::session::Session;
use crate::switches::Switches;

/// A run of one program.
#[derive(Debug)]
pub(crate) struct Execution<'a> {
    interpreter: Interpreter,
    panel: Panel<'a>,
    text: &'a ProgramText,
    switches: Switches,
    alarm: Option<Diagnostic>,
    early: Vec<Diagnostic>,
    /// Warnings of those who looked at the commands.
    added: Vec<Diagnostic>,
    /// Number of the program that gave the last command.
    program: Option<u32>,
    /// Where lines that the program prints go, besides the trace.
    output: Option<ProgramOutput>,
}

/// The file that `DPRNT` and `BPRNT` write to.
#[derive(Debug)]
struct ProgramOutput {
    name: String,
    file: BufWriter<File>,
    fault: Option<io::Error>,
}

impl ProgramOutput {
    fn create(path: &Path) -> Result<Self, Finding> {
        let name = path.display().to_string();
        match File::create(path) {
            Ok(file) => Ok(Self { name, file: BufWriter::new(file), fault: None }),
            Err(error) => Err(unwritable(&name, &error)),
        }
    }

    fn line(&mut self, text: &str) {
        if self.fault.is_none() {
            self.fault = writeln!(self.file, "{text}").err();
        }
    }

    /// Writes the rest; the fault, if there was one.
    fn finish(&mut self) -> Option<Finding> {
        let fault = self.fault.take().or_else(|| self.file.flush().err())?;
        Some(unwritable(&self.name, &fault))
    }
}

fn unwritable(name: &str, error: &io::Error) -> Finding {
    let diagnostic =
        Diagnostic::error("output-unwritable").with("name", name).with("value", error.to_string());
    Finding::new(name, diagnostic).failed()
}

impl<'a> Execution<'a> {
    /// The program at its start.
    pub(crate) fn new(text: &'a ProgramText, session: &Session, machine: &Machine) -> Result<Self, Finding> {
        let usual = Options::default();
        let options = Options {
            // A long text may be read through once; no block is shorter than a letter, a digit and a line end.
            blocks_max: machine.max_blocks.unwrap_or(usual.blocks_max + text.len() / 3),
            idle_blocks_max: machine.max_idle_blocks.unwrap_or(usual.idle_blocks_max),
        };
        let switches = Switches::new(session, machine)?;
        let interpreter = Interpreter::new(session.control.clone(), &session.setup, SourceId(0), options)
            .map_err(|fault| session.setup_fault(&fault))?;
        Ok(Self {
            interpreter,
            panel: Panel::new(text, machine, &session.setup),
            text,
            switches,
            alarm: None,
            early: session.warnings.clone(),
            added: Vec::new(),
            program: None,
            output: machine.program_output.as_deref().map(ProgramOutput::create).transpose()?,
        })
    }

    /// The same with sharp tools.
    pub(crate) fn with_sharp_noses(mut self) -> Self {
        self.interpreter = self.interpreter.with_sharp_noses();
        self
    }

    /// The next command; `None` at the end of the program or at an alarm.
    #[inline]
    pub(crate) fn next_command(&mut self) -> Option<Command> {
        loop {
            match self.interpreter.step(&mut self.panel) {
                Step::Emit(command) => {
                    self.program = command.origin.program;
                    if let (Some(output), Action::Output(text)) = (&mut self.output, &command.action) {
                        output.line(text);
                    }
                    return Some(command);
                }
                // Somebody presses cycle start.
                Step::NeedSync(_) => {}
                Step::Alarm(alarm) => {
                    self.alarm = Some(*alarm);
                    return None;
                }
                Step::End => return None,
            }
        }
    }

    /// Runs to the end and gives nothing but findings.
    pub(crate) fn drain(&mut self) {
        while self.next_command().is_some() {}
    }

    /// Number of the program that gave the last command.
    pub(crate) fn program(&self) -> Option<u32> {
        self.program
    }

    /// The text of the program.
    pub(crate) fn text(&self) -> &'a ProgramText {
        self.text
    }

    /// Name of the file behind the number of a source, unless it is the program itself.
    #[inline]
    pub(crate) fn other_file(&self, source: u32) -> Option<&str> {
        (source != 0).then(|| self.panel.source(SourceId(source)).name.as_str())
    }

    /// The text behind the number of a source.
    pub(crate) fn text_of(&self, source: SourceId) -> &ProgramText {
        self.panel.source(source)
    }

    /// The interpreter.
    pub(crate) fn interpreter(&self) -> &Interpreter {
        &self.interpreter
    }

    /// The alarm that ended the program, if one did.
    pub(crate) fn alarm(&self) -> Option<&Diagnostic> {
        self.alarm.as_ref()
    }

    /// The warnings since the last call.
    pub(crate) fn take_warnings(&mut self) -> Vec<Finding> {
        let fault = self.output.as_mut().and_then(ProgramOutput::finish);
        let early = std::mem::take(&mut self.early);
        let added = std::mem::take(&mut self.added);
        let warnings: Vec<Diagnostic> =
            early.into_iter().chain(self.interpreter.take_warnings()).chain(added).collect();
        let told = warnings.into_iter().filter(|warning| !self.switches.allows(warning));
        told.map(|warning| self.finding(warning)).chain(fault).collect()
    }

    /// Adds a warning about the commands.
    pub(crate) fn warn(&mut self, warning: Diagnostic) {
        self.added.push(warning);
    }

    /// Everything found and not yet taken, in the order of the lines; the alarm is the last.
    pub(crate) fn findings(&mut self) -> Vec<Finding> {
        let mut findings = self.take_warnings();
        findings.sort_by_key(|finding| {
            finding.diagnostic.place.map_or((u32::MAX, 0), |place| (place.line, place.column))
        });
        findings.extend(self.alarm_finding());
        findings
    }

    /// The alarm as a finding.
    pub(crate) fn alarm_finding(&self) -> Option<Finding> {
        self.alarm.clone().map(|alarm| self.finding(alarm))
    }

    fn finding(&self, mut diagnostic: Diagnostic) -> Finding {
        self.switches.judge(&mut diagnostic);
        let is_unreadable = diagnostic.key == "file-unreadable";
        let source = diagnostic.place.map_or(SourceId(0), |place| place.source);
        let text = self.panel.source(source);
        let ids = self.interpreter.control().alarm_ids;
        let mut finding = Finding::new(text.name.as_str(), diagnostic).with_ids(ids);
        if source != SourceId(0) {
            finding = finding.located(text);
        }
        if is_unreadable { finding.failed() } else { finding }
    }
}
