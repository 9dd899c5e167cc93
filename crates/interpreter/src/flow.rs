//! Program flow: subprograms, returns, jumps, ends.
//!
//! Where programs and sequence numbers stand is the index's business; what a macro call hands over is in
//! `macros/`. Source: subprograms and program ends of both families.

use turnwright_canon::{Action, CycleLabel, CycleOrigin, Phase, RapidPath};
use turnwright_control::Mode;
use turnwright_control::policy::{
    CallInCompensation, CallWithoutProgram, CallsInMdi, ComputedProgramNumber, ProgramNames,
};
use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_syntax::{Block, ExtentKind, Value, Word};
use turnwright_units::{Position, WorkTip};

use crate::Environment;
use crate::auxiliary::{Auxiliary, Flow};
use crate::compensation::Outside;
use crate::figure::FigureRange;
pub(crate) use crate::index::Resume;
use crate::index::{ProgramIndex, ProgramName};
use crate::machine::{BlockPlace, Core, SyncReason};
use crate::macros::{Locals, Passed, Program};
use crate::report::Alarm;
use crate::text::Cursor;

/// A call that has not returned.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) kind: FrameKind,
    /// Where reading goes on after the return.
    back: Resume,
    pub(crate) caller_program: Option<u32>,
    caller_start: Resume,
    pub(crate) call_line: u32,
}

/// What was called.
#[derive(Debug)]
pub(crate) enum FrameKind {
    /// A subprogram.
    Subprogram {
        start: Resume,
        rounds_left: u32,
        /// A code called it; such codes have their plain meaning inside.
        by_code: bool,
        /// It came from outside the memory.
        is_external: bool,
    },
    /// A macro.
    Macro(MacroFrame),
    /// The figure of a finishing cycle.
    Finish {
        range: FigureRange,
        home: Position<WorkTip>,
        at: BlockPlace,
        code: u16,
        /// Compensation in force around it, where it does not act inside.
        outside: Option<Outside>,
    },
}

/// A macro that runs.
#[derive(Debug)]
pub(crate) struct MacroFrame {
    pub(crate) start: Resume,
    pub(crate) rounds_left: u32,
    /// The local variables that every round begins with.
    pub(crate) arguments: Passed,
    /// Those of the caller.
    pub(crate) caller: Box<Locals>,
    /// The modal call that it answers.
    pub(crate) modal: Option<usize>,
    /// A code called it; such codes have their plain meaning inside.
    pub(crate) by_code: bool,
}

impl Core {
    /// Call depth of subprograms.
    #[inline]
    pub(crate) fn depth(&self) -> u8 {
        if self.frames.is_empty() { 0 } else { self.call_depths().0 + self.call_depths().1 }
    }

    /// Calls that have not returned: subprograms, and macros.
    fn call_depths(&self) -> (u8, u8) {
        self.frames.iter().fold((0, 0), |(subprograms, macros), frame| match frame.kind {
            FrameKind::Subprogram { .. } => (subprograms + 1, macros),
            FrameKind::Macro(_) => (subprograms, macros + 1),
            FrameKind::Finish { .. } => (subprograms, macros),
        })
    }

    /// Refuses what has to search the program in one that was typed in at the panel. The programs that it calls lie
    /// in the memory.
    pub(crate) fn refuse_in_mdi(&self, key: &'static str, word: Option<&Word>) -> Result<(), Alarm> {
        if self.mode == Mode::Mdi && self.frames.is_empty() { Err(self.alarm_at(key, word)) } else { Ok(()) }
    }

    /// Refuses a call beyond the depth that the control allows.
    pub(crate) fn check_depth(&self, word: &Word, is_macro: bool) -> Result<(), Alarm> {
        let (subprograms, macros) = self.call_depths();
        let is_called_in_mdi = self.mode == Mode::Mdi && subprograms + macros > 0;
        if is_called_in_mdi && self.control.policies.calls_in_mdi == CallsInMdi::OneLevel {
            return Err(self.alarm("calls-too-deep", word));
        }
        let limits = &self.control.limits;
        if is_macro && macros >= limits.macro_depth_max {
            return Err(self.alarm("macro-calls-too-deep", word));
        }
        let is_full = subprograms + macros >= limits.combined_depth_max;
        if is_full || (!is_macro && subprograms >= limits.call_depth_max) {
            return Err(self.alarm("calls-too-deep", word));
        }
        Ok(())
    }

    /// The caller waits from here on.
    pub(crate) fn push_frame(&mut self, kind: FrameKind) {
        self.is_plain = false;
        self.frames.push(Frame {
            kind,
            back: self.resume(),
            caller_program: self.program,
            caller_start: self.program_start,
            call_line: self.at.line,
        });
    }

    /// Where reading goes on after the block in work.
    pub(crate) fn resume(&self) -> Resume {
        if let Some(id) = self.cache.current {
            self.cache.behind(id)
        } else if self.from == 0 {
            Resume { line: self.text.cursor(), from: 0 }
        } else {
            Resume { from: self.from, ..self.place_in_line() }
        }
    }

    /// The block that comes next, when none is in work.
    pub(crate) fn next_block(&self) -> Resume {
        match self.cache.current {
            Some(id) => self.cache.start(id),
            None => self.resume(),
        }
    }

    /// The line of the block in work.
    pub(crate) fn line_cursor(&self) -> Cursor {
        Cursor { source: self.at.source, offset: self.at.line_offset, line: self.at.line }
    }

    /// A signal asks for the program of the interrupt, between two blocks.
    #[cold]
    pub(crate) fn interrupt(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let Some(number) = self.macros.interrupt else { return Ok(()) };
        if let Some(id) = self.cache.current {
            // The block that would come next waits.
            let next = self.cache.start(id);
            self.go(next, environment)?;
        }
        let word = Word {
            address: b'M',
            comma: false,
            start: self.at.first_byte,
            end: self.at.last_byte,
            value: Value::Missing,
        };
        if self.is_in_figure() {
            return Err(self.alarm_block("macro-interrupt-in-cycle"));
        }
        let target = self.program_by_number(number, &word, environment)?;
        let is_running = self
            .frames
            .iter()
            .any(|frame| matches!(frame.kind, FrameKind::Subprogram { start, .. } if start == target.start));
        if is_running {
            return Ok(());
        }
        self.enter_subprogram(target, 1, &word, false, false, environment)
    }

    /// Where the block in work begins.
    pub(crate) fn block_start(&self) -> Resume {
        match self.cache.current {
            Some(id) => self.cache.start(id),
            None => Resume { line: self.line_cursor(), from: self.block_from },
        }
    }

    /// Goes to another block of the program; what lies between is kept when the way is back.
    pub(crate) fn jump(&mut self, to: Resume, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let here = self.block_start();
        if to.line.source == here.line.source && to.position() <= here.position() {
            self.cache.heat(here.line.source, here.line.offset);
        }
        self.go(to, environment)
    }

    /// Goes on reading at a place.
    pub(crate) fn go(&mut self, to: Resume, environment: &mut dyn Environment) -> Result<(), Alarm> {
        self.cache.leave();
        self.cache.enter(to.line.source);
        self.text.jump(to.line);
        self.from = to.from;
        if to.from > 0 {
            // The rest of a line: it has to be read again.
            match self.text.next(environment) {
                Ok(Some(line)) => self.line = line,
                _ => return Err(Box::new(Diagnostic::error("file-unreadable"))),
            }
        }
        Ok(())
    }

    /// The auxiliary function that waits for the end of the block.
    #[cold]
    pub(crate) fn flow(
        &mut self,
        auxiliary: Auxiliary,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let Some((flow, place)) = auxiliary.flow else { return Ok(()) };
        let word = block.words.get(usize::from(place)).copied();
        if self.corner.is_some() {
            return Err(self.corner_without_next());
        }
        let calls = matches!(flow, Flow::Call | Flow::CallExternal | Flow::CallProgram(_));
        if calls
            && self.control.policies.call_in_compensation == CallInCompensation::Alarm
            && self.is_compensating()
        {
            return Err(self.alarm_at("call-in-compensation", word.as_ref()));
        }
        match flow {
            // Roughing passes over what its figure does besides moving; finishing stops.
            Flow::Stop | Flow::OptionalStop if self.is_capturing() => Ok(()),
            Flow::Stop => {
                self.stop_reading_ahead()?;
                self.emit(Action::Stop);
                self.sync = Some(SyncReason::CycleStart);
                Ok(())
            }
            Flow::OptionalStop => {
                self.stop_reading_ahead()?;
                self.emit(Action::OptionalStop);
                if environment.stops_optionally() {
                    self.sync = Some(SyncReason::CycleStart);
                }
                Ok(())
            }
            Flow::End => {
                self.warn_of_compensation(word.as_ref());
                self.end_compensation()?;
                self.emit(Action::End);
                self.is_over = true;
                Ok(())
            }
            Flow::Call => self.call(block, word, false, environment),
            Flow::CallExternal => self.call(block, word, true, environment),
            Flow::CallProgram(number) => {
                let Some(word) = word else { return Ok(()) };
                let target = self.program_by_number(number, &word, environment)?;
                self.enter_subprogram(target, 1, &word, true, false, environment)
            }
            Flow::InterruptOn => {
                let Some(target) = block.word(b'P') else {
                    return Err(self.alarm_at("call-program-missing", word.as_ref()));
                };
                let number = self.whole(target, 99_999_999)?;
                self.program_by_number(number, target, environment)?;
                self.macros.interrupt = Some(number);
                Ok(())
            }
            Flow::InterruptOff => {
                self.macros.interrupt = None;
                Ok(())
            }
            Flow::Return => {
                if self.settings.gives_return_code
                    && let Some(code) = word.and_then(|word| self.whole(&word, u32::MAX).ok())
                {
                    self.emit(Action::Auxiliary { code });
                }
                self.return_from_call(block, environment)
            }
        }
    }

    /// `M98 P_ L_`: the last four digits of a longer P are the program, those before them the count. A program
    /// may have a name instead; Q names the block to begin with.
    fn call(
        &mut self,
        block: &Block,
        word: Option<Word>,
        is_external: bool,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let Some(word) = word else { return Ok(()) };
        if is_external
            && self
                .frames
                .iter()
                .any(|frame| matches!(frame.kind, FrameKind::Subprogram { is_external: true, .. }))
        {
            return Err(self.alarm("external-call-not-allowed", &word));
        }
        let (target, rounds) = self.call_words(block, &word, is_external, environment)?;
        let start = match block.word(b'Q') {
            None => target.start,
            Some(entry) => {
                let number = self.whole(entry, 99_999)?;
                let index = self.index(target.start.line.source, environment)?;
                match index.sequence(number, target.start, target.start) {
                    Some((at, _)) => at,
                    None => return Err(self.sequence_alarm(entry, number)),
                }
            }
        };
        let named = block.word(b'P').copied().unwrap_or(word);
        self.enter_subprogram(Program { start, ..target }, rounds, &named, false, is_external, environment)
    }

    fn call_words(
        &mut self,
        block: &Block,
        word: &Word,
        is_external: bool,
        environment: &mut dyn Environment,
    ) -> Result<(Program, u32), Alarm> {
        let limit = self.control.limits.repeat_count_max;
        let count = block.word(b'L').map(|count| self.whole(count, limit)).transpose()?;
        if let Some(name) = self.name_in_block(block) {
            return Ok((self.program_by_name(&name, word, environment)?, count.unwrap_or(1)));
        }
        let Some(target) = block.word(b'P') else {
            let calls_itself = self.control.policies.call_without_program == CallWithoutProgram::CallsItself
                && block.has(b'Q');
            if !calls_itself {
                return Err(self.alarm("call-program-missing", word));
            }
            let this = Program { number: self.program, start: self.program_start };
            return Ok((this, count.unwrap_or(1)));
        };
        let value = self.program_word(target)?;
        let (number, rounds) = match count {
            Some(_) if value > 9_999 && self.control.limits.program_digits <= 4 => {
                if self.control.policies.computed_program_number == ComputedProgramNumber::FourDigits {
                    return Err(self.alarm("repeat-count-twice", target));
                }
                (value % 10_000, count.unwrap_or(1))
            }
            Some(count) => (value, count),
            None if value > 9_999 => (value % 10_000, value / 10_000),
            None => (value, 1),
        };
        if rounds > limit {
            return Err(self.alarm("number-too-long", target));
        }
        let program = if is_external {
            self.external_program(ProgramName::Number(number), target, environment)?
        } else {
            self.program_by_number(number, target, environment)?
        };
        Ok((program, rounds))
    }

    /// The number behind P.
    fn program_word(&self, word: &Word) -> Result<u32, Alarm> {
        let value = self.whole(word, 99_999_999)?;
        let is_computed = matches!(word.value, Value::Number(number) if number.is_computed());
        let holds_four = self.control.policies.computed_program_number == ComputedProgramNumber::FourDigits;
        if is_computed && value > 9_999 && holds_four {
            return Err(self.alarm("program-number-variable-too-large", word));
        }
        Ok(value)
    }

    fn enter_subprogram(
        &mut self,
        target: Program,
        rounds: u32,
        word: &Word,
        by_code: bool,
        is_external: bool,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        self.check_depth(word, false)?;
        if rounds == 0 {
            return Ok(());
        }
        let start = target.start;
        self.push_frame(FrameKind::Subprogram { start, rounds_left: rounds - 1, by_code, is_external });
        self.enter(target, environment)
    }

    /// The name that a call gives instead of a number: `P[NAME]`, or `<NAME>`.
    fn name_in_block(&self, block: &Block) -> Option<String> {
        if let Some(word) = block.word(b'P')
            && let Value::Expression { start, end } = word.value
        {
            return self.name_in_brackets(start, end);
        }
        let name = block.extents.iter().find(|extent| extent.kind == ExtentKind::Name)?;
        let text = self.line_bytes().get(name.start as usize + 1..name.end as usize - 1)?;
        Some(String::from_utf8_lossy(text).trim().to_string())
    }

    /// The name between square brackets, when it can be one.
    pub(crate) fn name_in_brackets(&self, start: u32, end: u32) -> Option<String> {
        if self.control.policies.program_names != ProgramNames::InBrackets {
            return None;
        }
        let text = self.line_bytes().get(start as usize..end as usize)?;
        let inner = text.strip_prefix(b"[")?.strip_suffix(b"]")?;
        let is_name = !inner.is_empty()
            && inner.iter().all(|byte| {
                byte.is_ascii_alphanumeric()
                    || *byte >= 0x80
                    || matches!(byte, b'+' | b'-' | b'_' | b'.' | b' ')
            });
        is_name.then(|| String::from_utf8_lossy(inner).trim().to_string())
    }

    /// The program that a macro call names.
    pub(crate) fn called_program(
        &mut self,
        block: &Block,
        call: &Word,
        environment: &mut dyn Environment,
    ) -> Result<Program, Alarm> {
        if let Some(name) = self.name_in_block(block) {
            return self.program_by_name(&name, call, environment);
        }
        let Some(target) = block.word(b'P') else {
            return Err(self.alarm("call-program-missing", call));
        };
        let number = self.program_word(target)?;
        self.program_by_number(number, target, environment)
    }

    /// A program of the text in work, or of one that the environment knows.
    pub(crate) fn program_by_number(
        &mut self,
        number: u32,
        word: &Word,
        environment: &mut dyn Environment,
    ) -> Result<Program, Alarm> {
        let source = self.at.source;
        match self.index(source, environment)?.program(ProgramName::Number(number)) {
            Some(start) => Ok(Program { number: Some(number), start }),
            None => self.external_program(ProgramName::Number(number), word, environment),
        }
    }

    fn program_by_name(
        &mut self,
        name: &str,
        word: &Word,
        environment: &mut dyn Environment,
    ) -> Result<Program, Alarm> {
        let source = self.at.source;
        match self.index(source, environment)?.program(ProgramName::Text(name)) {
            Some(start) => Ok(Program { number: None, start }),
            None => self.external_program(ProgramName::Text(name), word, environment),
        }
    }

    fn external_program(
        &mut self,
        name: ProgramName<'_>,
        word: &Word,
        environment: &mut dyn Environment,
    ) -> Result<Program, Alarm> {
        let number = match name {
            ProgramName::Number(number) => Some(number),
            ProgramName::Text(_) => None,
        };
        let found = environment.program(name);
        let Some(source) = found else {
            let program = match name {
                ProgramName::Number(number) => format!("O{number:04}"),
                ProgramName::Text(text) => text.to_string(),
            };
            let quote = self.quote(word.start, word.end);
            let diagnostic = Diagnostic::alarm("program-not-found").at(self.place(word));
            return Err(self.finish(diagnostic.with("word", quote).with("program", program)));
        };
        // A file of its own may do without its number.
        let whole = Resume { line: Cursor { source, offset: 0, line: 1 }, from: 0 };
        let start = self.index(source, environment)?.program(name).unwrap_or(whole);
        Ok(Program { number, start })
    }

    /// Goes to the first block of a program, which holds its number.
    pub(crate) fn enter(&mut self, target: Program, environment: &mut dyn Environment) -> Result<(), Alarm> {
        self.count_idle(crate::limits::IDLE_CALLS)?;
        self.program = target.number;
        self.program_start = target.start;
        (self.expects_program_number, self.is_plain) = (true, false);
        self.jump(target.start, environment)
    }

    fn return_from_call(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let target = block.word(b'P').copied();
        if !self.macros.modal_calls.is_empty() {
            self.check_return_words(block)?;
        }
        let Some(frame) = self.frames.last_mut() else {
            if self.control.parameters.bit("main-program-return-alarm") {
                return Err(self.alarm_block("main-program-return-forbidden"));
            }
            if let Some(word) = target {
                return self.jump_to(&word, environment);
            }
            // In the main program M99 starts over: one round is shown.
            self.stop_reading_ahead()?;
            self.forget_thread_record();
            self.warn_block("main-program-repeats");
            self.emit(Action::End);
            self.is_over = true;
            return Ok(());
        };
        let again = match &mut frame.kind {
            _ if target.is_some() => None,
            FrameKind::Subprogram { start, rounds_left, .. } if *rounds_left > 0 => {
                *rounds_left -= 1;
                Some((*start, None))
            }
            FrameKind::Macro(frame) if frame.rounds_left > 0 => {
                frame.rounds_left -= 1;
                Some((frame.start, Some(frame.arguments.clone())))
            }
            _ => None,
        };
        if let Some((start, arguments)) = again {
            if let Some(arguments) = arguments {
                self.macros.variables.set_locals(&arguments.values);
            }
            (self.expects_program_number, self.is_plain) = (true, false);
            return self.jump(start, environment);
        }
        let Some(frame) = self.frames.pop() else { return Ok(()) };
        if let FrameKind::Macro(MacroFrame { caller, .. }) = &frame.kind {
            self.macros.variables.set_locals(caller);
        }
        self.program = frame.caller_program;
        self.program_start = frame.caller_start;
        match target {
            None => self.jump(frame.back, environment),
            Some(word) => self.jump_to(&word, environment),
        }
    }

    /// With a modal call in force a return stands alone.
    fn check_return_words(&self, block: &Block) -> Result<(), Alarm> {
        match block.words.iter().find(|word| !matches!(word.address, b'O' | b'N' | b'P' | b'M')) {
            Some(word) => Err(self.alarm("return-block-with-words", word)),
            None => Ok(()),
        }
    }

    /// Goes to the block with the sequence number of a word, in the program in work.
    fn jump_to(&mut self, word: &Word, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let number = self.whole(word, 99_999)?;
        let from = self.program_start;
        match self.find_sequence(number, from, environment)? {
            Some((to, _)) => {
                (self.expects_program_number, self.is_plain) = (true, false);
                self.jump(to, environment)
            }
            None => Err(self.sequence_alarm(word, number)),
        }
    }

    fn sequence_alarm(&self, word: &Word, number: u32) -> Alarm {
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::alarm("sequence-not-found").at(self.place(word));
        self.finish(diagnostic.with("word", quote).with("sequence", i64::from(number)))
    }

    /// `%`, the next program, or the end of the text, without an end of program before it.
    pub(crate) fn end_of_record(&mut self) -> Result<(), Alarm> {
        if self.corner.is_some() {
            return Err(self.corner_without_next());
        }
        if !self.has_started {
            self.is_over = true;
            return Err(Box::new(Diagnostic::error("program-empty")));
        }
        if self.is_in_figure() {
            return Err(self.figure_without_end());
        }
        if self.cylinder_roughing.is_some() {
            return Err(self.alarm_block("cylinder-roughing-without-end"));
        }
        if self.settings.end_of_record_allowed && self.frames.is_empty() {
            self.warn_of_compensation(None);
            self.end_compensation()?;
            self.emit(Action::End);
            self.is_over = true;
            return Ok(());
        }
        Err(self.alarm_block("end-of-record-without-end"))
    }

    /// After each block of a called program or figure: the finishing cycle ends behind its last block.
    #[inline]
    pub(crate) fn after_block(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let Some(frame) = self.frames.last() else { return Ok(()) };
        let FrameKind::Finish { range, home, code, .. } = frame.kind else { return Ok(()) };
        if self.at.sequence != Some(range.last) || self.is_over {
            return Ok(());
        }
        if self.corner.is_some() {
            return Err(self.corner_without_next());
        }
        self.in_cycle = Some(CycleOrigin { label: CycleLabel(code), pass: 1, phase: Phase::Home });
        // Each axis goes back at its own rate, whatever the parameter for rapid moves says.
        self.modal.position = home;
        let back = Action::Rapid { to: home, path: RapidPath::EachAxis, others: None };
        if self.tip == home {
            self.suspend_compensation()?;
        } else {
            self.without_vector(|core| core.emit_move(home, back))?;
        }
        self.start_up_again();
        self.in_cycle = None;
        if let Some(frame) = self.frames.pop() {
            if let FrameKind::Finish { outside: Some(outside), .. } = frame.kind {
                self.come_back_to(outside);
            }
            self.go(frame.back, environment)?;
        }
        Ok(())
    }

    /// Starts the finishing cycle: the blocks of the figure are executed as they stand.
    pub(crate) fn start_finish(
        &mut self,
        first: Resume,
        range: FigureRange,
        code: u16,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let outside = self.leave_outside()?;
        let home = self.modal.position;
        self.push_frame(FrameKind::Finish { range, home, at: self.at, code, outside });
        self.in_cycle = Some(CycleOrigin { label: CycleLabel(code), pass: 1, phase: Phase::Finish });
        self.go(first, environment)
    }

    /// The block with a sequence number in the program in work: the first one behind `from`, else the first
    /// from the start of the program; and how many blocks have it.
    pub(crate) fn find_sequence(
        &mut self,
        number: u32,
        from: Resume,
        environment: &mut dyn Environment,
    ) -> Result<Option<(Resume, usize)>, Alarm> {
        let start = self.program_start;
        Ok(self.index(start.line.source, environment)?.sequence(number, start, from))
    }

    /// The index of a text, made by one pass over it when it is first needed.
    #[inline]
    pub(crate) fn index(
        &mut self,
        source: SourceId,
        environment: &mut dyn Environment,
    ) -> Result<&ProgramIndex, Alarm> {
        let known = self.indexes.iter().position(|(known, _)| *known == source);
        let place = match known {
            Some(place) => place,
            None => {
                let index = ProgramIndex::read(source, environment)?;
                self.text.expect(source, index.bytes);
                self.indexes.push((source, index));
                self.indexes.len() - 1
            }
        };
        Ok(&self.indexes[place].1)
    }
}
