//! Checks of a text as it stands in its file, whether a block of it runs or not.
//!
//! One file a check, as in [`checks`](crate::Checks); a control reads such a text without a word, and something of it
//! is not what its writer meant.

mod after_end;
mod control_characters;
mod duplicate_program;
mod lower_case;

use turnwright_diagnostics::{Argument, Diagnostic, Place, Severity, SourceId};

/// A line without its remarks.
struct Line<'a> {
    /// From 1.
    number: u32,
    /// All of it.
    bytes: &'a [u8],
    /// What stands outside of round brackets and before a semicolon, without blanks.
    code: &'a [u8],
}

/// What the checks have to say.
#[derive(Debug, Default)]
struct Report {
    findings: Vec<Diagnostic>,
}

impl Report {
    fn tell(&mut self, mut diagnostic: Diagnostic, line: u32, arguments: Vec<(&'static str, Argument)>) {
        let place = Place { source: SourceId(0), line, line_offset: u64::MAX, column: 1, end_column: 1 };
        diagnostic = diagnostic.at(place);
        diagnostic.arguments = arguments;
        self.findings.push(diagnostic);
    }

    fn warn(&mut self, key: &'static str, line: &Line<'_>, arguments: Vec<(&'static str, Argument)>) {
        self.tell(Diagnostic::warning(key), line.number, arguments);
    }

    fn note(&mut self, key: &'static str, line: &Line<'_>) {
        self.tell(Diagnostic::new(Severity::Note, key), line.number, Vec::new());
    }
}

/// All checks of one text.
#[derive(Debug, Default)]
pub struct TextChecks {
    lines: u32,
    code: Vec<u8>,
    after_end: after_end::AfterEnd,
    control_characters: control_characters::ControlCharacters,
    duplicate_program: duplicate_program::DuplicateProgram,
    lower_case: lower_case::LowerCase,
    report: Report,
}

impl TextChecks {
    /// Looks at the next line, given without its end.
    pub fn add(&mut self, bytes: &[u8]) {
        self.lines = self.lines.saturating_add(1);
        self.code.clear();
        code_of(bytes, &mut self.code);
        let line = Line { number: self.lines, bytes, code: &self.code };
        let report = &mut self.report;
        if !self.after_end.add(&line, report) {
            return;
        }
        self.control_characters.add(&line, report);
        self.duplicate_program.add(&line, report);
        self.lower_case.add(&line, report);
    }

    /// What was found, in the order of the lines.
    pub fn finish(self) -> Vec<Diagnostic> {
        self.report.findings
    }
}

/// What of a line is code.
fn code_of(bytes: &[u8], code: &mut Vec<u8>) {
    let mut is_remark = false;
    for byte in bytes {
        match byte {
            b'(' => is_remark = true,
            b')' if is_remark => is_remark = false,
            b';' if !is_remark => return,
            _ if is_remark || byte.is_ascii_whitespace() => {}
            _ => code.push(*byte),
        }
    }
}

/// The number of a program that begins with this code, when nothing else stands there.
fn program_number(code: &[u8]) -> Option<u64> {
    let [b'O' | b'o' | b':', digits @ ..] = code else { return None };
    let is_number = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
    std::str::from_utf8(digits).ok().filter(|_| is_number)?.parse().ok()
}
