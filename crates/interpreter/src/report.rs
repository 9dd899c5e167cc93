//! Diagnostics with a place: alarms that stop, warnings that do not.

use turnwright_diagnostics::{Argument, Call, Diagnostic, Place};
use turnwright_syntax::Word;

use crate::limits::WARNINGS_MAX;
use crate::machine::{BlockPlace, Core};

/// An alarm on its way out of the interpreter.
pub(crate) type Alarm = Box<Diagnostic>;

impl BlockPlace {
    /// The place of some bytes of the block's line.
    pub(crate) fn span(&self, start: u32, end: u32) -> Place {
        Place {
            source: self.source,
            line: self.line,
            line_offset: self.line_offset,
            column: start + 1,
            end_column: end + 1,
        }
    }
}

impl Core {
    /// The place of a word of the block in work.
    pub(crate) fn place(&self, word: &Word) -> Place {
        self.at.span(word.start, word.end)
    }

    /// The place of the whole block in work.
    pub(crate) fn block_place(&self) -> Place {
        self.at.span(self.at.first_byte, self.at.last_byte)
    }

    /// The line of the block in work.
    pub(crate) fn line_bytes(&self) -> &[u8] {
        match self.cache.current {
            Some(id) => self.cache.line(id),
            None => self.text.bytes(&self.line),
        }
    }

    /// The text of some bytes of the line in work, for a message.
    pub(crate) fn quote(&self, start: u32, end: u32) -> String {
        let line = self.line_bytes();
        let (start, end) = ((start as usize).min(line.len()), (end as usize).min(line.len()));
        let text: String = String::from_utf8_lossy(&line[start..end]).chars().take(40).collect();
        text.trim().to_string()
    }

    /// An alarm at a word of the block in work; `{word}` is the word.
    pub(crate) fn alarm(&self, key: &'static str, word: &Word) -> Alarm {
        let quote = self.quote(word.start, word.end);
        self.finish(Diagnostic::alarm(key).at(self.place(word)).with("word", quote))
    }

    /// An alarm at the block in work as a whole.
    pub(crate) fn alarm_block(&self, key: &'static str) -> Alarm {
        let quote = self.quote(self.at.first_byte, self.at.last_byte);
        self.finish(Diagnostic::alarm(key).at(self.block_place()).with("word", quote))
    }

    /// An alarm at a word when there is one, else at the block.
    pub(crate) fn alarm_at(&self, key: &'static str, word: Option<&Word>) -> Alarm {
        word.map_or_else(|| self.alarm_block(key), |word| self.alarm(key, word))
    }

    /// Something that a later version does, by its key in the table of functions: named, never passed over.
    pub(crate) fn not_supported(&self, function: &str, word: &Word) -> Alarm {
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::error("not-supported-yet").at(self.place(word));
        let diagnostic = diagnostic.with("code", quote.clone()).with("word", quote);
        self.finish(diagnostic.with("name", Argument::Function(function.into())))
    }

    /// Adds the calls that led here.
    pub(crate) fn finish(&self, mut diagnostic: Diagnostic) -> Alarm {
        diagnostic.trace = self.call_trace();
        Box::new(diagnostic)
    }

    fn call_trace(&self) -> Vec<Call> {
        self.frames
            .iter()
            .map(|frame| Call { program: frame.caller_program.unwrap_or(0), line: frame.call_line })
            .collect()
    }

    /// A warning at a word of the block in work.
    pub(crate) fn warn(&mut self, key: &'static str, word: &Word) {
        if self.already_said(key, self.at.line) {
            return;
        }
        let quote = self.quote(word.start, word.end);
        let place = self.place(word);
        self.say(Diagnostic::warning(key).at(place).with("word", quote));
    }

    /// A warning at the block in work.
    pub(crate) fn warn_block(&mut self, key: &'static str) {
        if !self.already_said(key, self.at.line) {
            let place = self.block_place();
            self.say(Diagnostic::warning(key).at(place));
        }
    }

    /// A warning that is given only once in a run.
    pub(crate) fn warn_once(&mut self, key: &'static str) {
        if !self.already_said(key, 0) {
            let place = self.block_place();
            self.say(Diagnostic::warning(key).at(place));
        }
    }

    /// Whether this was said about this line before; a block in a loop warns once.
    pub(crate) fn already_said(&mut self, key: &'static str, line: u32) -> bool {
        self.said.len() > WARNINGS_MAX * 4 || !self.said.insert((key, line, 0))
    }

    /// Whether this was said about this word before.
    pub(crate) fn already_said_at(&mut self, key: &'static str, word: &Word) -> bool {
        self.said.len() > WARNINGS_MAX * 4 || !self.said.insert((key, self.at.line, word.start + 1))
    }

    /// Keeps a diagnostic for the caller.
    pub(crate) fn say(&mut self, diagnostic: Diagnostic) {
        if self.is_capturing() {
            // The figure is read a second time by the finishing cycle; what is odd in it is said once.
            self.said.insert((diagnostic.key, diagnostic.place.map_or(0, |place| place.line), 0));
        }
        if self.warnings_given < WARNINGS_MAX {
            self.warnings_given += 1;
            let mut diagnostic = diagnostic;
            diagnostic.trace = self.call_trace();
            self.warnings.push(diagnostic);
        } else if self.warnings_given == WARNINGS_MAX {
            self.warnings_given += 1;
            self.warnings
                .push(Diagnostic::warning("too-many-diagnostics").with("limit", WARNINGS_MAX as i64));
        }
    }
}
