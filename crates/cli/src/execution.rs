//! A program on its way: steps, warnings, the alarm.

use turnwright_canon::Command;
use turnwright_diagnostics::{Diagnostic, Severity, SourceId};
use turnwright_interpreter::{Interpreter, Options, Step};

use crate::arguments::{Deny, Machine};
use crate::environment::{Panel, ProgramText};
use crate::finding::Finding;
use crate::session::Session;

/// A run of one program.
#[derive(Debug)]
pub(crate) struct Execution<'a> {
    interpreter: Interpreter,
    panel: Panel<'a>,
    text: &'a ProgramText,
    denies_warnings: bool,
    alarm: Option<Diagnostic>,
    early: Option<Diagnostic>,
    /// Number of the program that gave the last command.
    program: Option<u32>,
}

impl<'a> Execution<'a> {
    /// The program at its start.
    pub(crate) fn new(text: &'a ProgramText, session: &Session, machine: &Machine) -> Result<Self, Finding> {
        let options = machine.max_blocks.map_or_else(Options::default, |blocks_max| Options { blocks_max });
        let interpreter = Interpreter::new(session.control.clone(), &session.setup, SourceId(0), options)
            .map_err(|fault| session.setup_fault(&fault))?;
        Ok(Self {
            interpreter,
            panel: Panel::new(text, machine),
            text,
            denies_warnings: machine.deny == Some(Deny::Warnings),
            alarm: None,
            early: session.warning.clone(),
            program: None,
        })
    }

    /// The next command; `None` at the end of the program or at an alarm.
    #[inline]
    pub(crate) fn next_command(&mut self) -> Option<Command> {
        loop {
            match self.interpreter.step(&mut self.panel) {
                Step::Emit(command) => {
                    self.program = command.origin.program;
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
        let early = self.early.take();
        let warnings: Vec<Diagnostic> = early.into_iter().chain(self.interpreter.take_warnings()).collect();
        warnings.into_iter().map(|warning| self.finding(warning)).collect()
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
        if self.denies_warnings && diagnostic.severity == Severity::Warning {
            diagnostic.severity = Severity::Error;
        }
        let is_unreadable = diagnostic.key == "file-unreadable";
        let finding =
            Finding::new(self.text.name.as_str(), diagnostic).with_ids(self.interpreter.control().alarm_ids);
        if is_unreadable { finding.failed() } else { finding }
    }
}
