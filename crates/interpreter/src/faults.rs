//! What is odd in the text of a block: faults of reading, doubled words and codes, marks out of place.
//!
//! In: a block as it was read. Out: an alarm at the word, or a warning. Which it is, policies and parameters say.
//!
//! Source: words and numbers, several words with one address, both families.

use turnwright_control::policy::{
    MacroNames, NestedComment, ProgramNames, RepeatedAddress, RepeatedSpeedWord, UnnumberedProgram,
};
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_syntax::{Block, ExtentKind, Fault, FaultKind, Value, Word};

use crate::machine::Core;
use crate::report::Alarm;

impl Core {
    #[cold]
    pub(crate) fn report_faults(&mut self, block: &Block) -> Result<(), Alarm> {
        for fault in &block.faults {
            if fault.kind == FaultKind::ProgramName {
                self.check_program_name(block, fault)?;
                continue;
            }
            if fault.kind == FaultKind::IndirectAxis && self.control.policies.macro_names == MacroNames::Known
            {
                continue;
            }
            if let Some(word) = self.numbered_word(block, fault) {
                let quote = self.quote(word.start, fault.end);
                let place = self.at.span(word.start, fault.end);
                return Err(self.finish(Diagnostic::alarm("numbered-word").at(place).with("word", quote)));
            }
            let (key, severity) = self.fault_key(fault);
            if severity == Severity::Alarm {
                return Err(self.fault_alarm(key, fault));
            }
            // What a whole file is written with is said once.
            let line = if is_habit(fault.kind) { 0 } else { self.at.line };
            if !self.already_said(key, line) {
                let place = self.at.span(fault.start, fault.end);
                let quote = self.quote(fault.start, fault.end);
                self.say(Diagnostic::new(severity, key).at(place).with("word", quote));
            }
        }
        Ok(())
    }

    /// A name in angle brackets heads a program, or is called where the control calls programs that way.
    fn check_program_name(&self, block: &Block, fault: &Fault) -> Result<(), Alarm> {
        let heads = block.has(b'O') || (block.words.is_empty() && self.expects_program_number);
        let calls = |word: &Word| match word.address {
            b'M' => self.whole(word, u32::MAX).is_ok_and(|code| self.is_call_code(code)),
            b'G' => self.calls_macro(word),
            _ => false,
        };
        let is_known = match self.control.policies.program_names {
            ProgramNames::None => false,
            ProgramNames::InBrackets => heads,
            ProgramNames::InAngles => heads || block.words.iter().any(calls),
        };
        match (is_known, heads) {
            (true, _) => Ok(()),
            (false, true) => Err(self.fault_alarm("program-number-illegal", fault)),
            (false, false) => Err(self.fault_alarm("illegal-address", fault)),
        }
    }

    /// The word before a sign of equality: `S2=1000` is written where a control has several spindles.
    fn numbered_word<'b>(&self, block: &'b Block, fault: &Fault) -> Option<&'b Word> {
        let is_equals = self.text.bytes(&self.line).get(fault.start as usize) == Some(&b'=');
        let word = block.words.iter().rfind(|word| word.end <= fault.start)?;
        let is_of_spindle = matches!(word.address, b'S' | b'M');
        let has_number = matches!(word.value, Value::Number(number) if number.scale == 0);
        (fault.kind == FaultKind::NotAWord
            && is_equals
            && is_of_spindle
            && word.end == fault.start
            && has_number)
            .then_some(word)
    }

    /// The diagnostic of a fault that the reader found.
    fn fault_key(&self, fault: &Fault) -> (&'static str, Severity) {
        use Severity::{Alarm, Warning};
        match fault.kind {
            FaultKind::NumberTooLong => ("number-too-long", Alarm),
            FaultKind::TwoPoints => ("two-points", Alarm),
            FaultKind::TwoSigns => ("two-signs", Alarm),
            FaultKind::AddressWithoutValue => {
                let letter = self.text.bytes(&self.line).get(fault.start as usize);
                match letter.map(u8::to_ascii_uppercase) {
                    Some(b'N' | b'O') => ("number-missing-after-o-or-n", Alarm),
                    _ => ("address-without-value", Alarm),
                }
            }
            FaultKind::NotAWord => ("not-a-word", Alarm),
            FaultKind::DecimalComma => ("decimal-comma", Alarm),
            FaultKind::LetterO => ("letter-o-for-zero", Alarm),
            FaultKind::StrayBracket => ("stray-bracket", Alarm),
            FaultKind::TooManyWords => ("too-many-words", Alarm),
            FaultKind::UnclosedComment => ("unclosed-comment", Warning),
            FaultKind::NestedComment if self.control.policies.nested_comment == NestedComment::Alarm => {
                ("nested-comment", Alarm)
            }
            FaultKind::NestedComment => ("nested-comment", Warning),
            FaultKind::TextAfterSemicolon => ("text-after-semicolon", Warning),
            FaultKind::FullWidth => ("full-width-character", Warning),
            // Asked of the control before.
            FaultKind::ProgramName => ("illegal-address", Alarm),
            FaultKind::IndirectAxis => ("macro-function-unavailable", Alarm),
        }
    }

    pub(crate) fn fault_alarm(&self, key: &'static str, fault: &Fault) -> Alarm {
        let quote = self.quote(fault.start, fault.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(fault.start, fault.end)).with("word", quote))
    }

    /// The mark of a block skip behind words, where the control knows it only at the head.
    pub(crate) fn skip_inside_block(&self, block: &Block) -> Alarm {
        let head = block.words.iter().find(|word| word.address != b'N').map_or(0, |word| word.start);
        let mark = block.extents.iter().find(|extent| extent.kind == ExtentKind::Skip && extent.start > head);
        let (start, end) =
            mark.map_or((self.at.first_byte, self.at.last_byte), |mark| (mark.start, mark.end));
        let diagnostic = Diagnostic::alarm("not-a-word").at(self.at.span(start, end));
        self.finish(diagnostic.with("word", self.quote(start, end)))
    }

    /// The same address twice: the last counts, unless the parameter makes it an alarm.
    #[cold]
    pub(crate) fn repeated_addresses(&mut self, block: &Block) -> Result<(), Alarm> {
        let same = |a: &Word, b: &Word| {
            (a.address, a.comma) == (b.address, b.comma) && !matches!(a.address, b'G' | b'M')
        };
        let words = &block.words;
        let repeats_speed = |word: &Word| word.address == b'S' && !word.comma;
        let is_call = words.iter().any(|word| word.address == b'G' && self.calls_macro(word));
        if !is_call
            && self.control.policies.repeated_speed_word == RepeatedSpeedWord::Alarm
            && let Some(again) = words.iter().filter(|word| repeats_speed(word)).nth(1)
        {
            return Err(self.alarm("too-many-spindle-words", again));
        }
        for (place, first) in words.iter().enumerate() {
            if is_call && matches!(first.address, b'I' | b'J' | b'K') {
                // Each further one is another argument.
                continue;
            }
            let Some(again) = words[place + 1..].iter().find(|word| same(first, word)) else { continue };
            if self.settings.duplicate_word_alarm
                || self.control.policies.repeated_address == RepeatedAddress::Alarm
            {
                return Err(self.alarm("duplicate-word", again));
            }
            self.warn("repeated-address", first);
        }
        Ok(())
    }

    /// Two codes of one group: the last counts, unless the parameter makes it an alarm.
    #[cold]
    pub(crate) fn same_group(&mut self, block: &Block, first: u8, word: &Word) -> Result<(), Alarm> {
        if self.settings.duplicate_word_alarm {
            return Err(self.alarm("duplicate-word", word));
        }
        self.warn("same-group-codes", &block.words[usize::from(first)]);
        Ok(())
    }

    /// The first block of a program: without O its sequence number may name the program.
    #[cold]
    pub(crate) fn first_block(&mut self) {
        self.expects_program_number = false;
        let takes_sequence =
            self.control.policies.unnumbered_program == UnnumberedProgram::TakesFirstSequence;
        if takes_sequence && self.program.is_none() && self.frames.is_empty() {
            self.program = self.at.sequence;
        }
    }
}

/// Ways of writing that a file has everywhere or nowhere.
const fn is_habit(kind: FaultKind) -> bool {
    matches!(kind, FaultKind::FullWidth | FaultKind::TextAfterSemicolon)
}
