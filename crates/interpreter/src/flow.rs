//! Program flow: subprograms, returns, ends, and the search for program and sequence numbers.

use turnwright_canon::{Action, CycleLabel, CycleOrigin, Phase};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Value, Word, scan_block};
use turnwright_units::{Position, WorkTip};

use crate::Environment;
use crate::auxiliary::{Auxiliary, Flow};
use crate::figure::FigureRange;
use crate::limits::SEQUENCES_MAX;
use crate::machine::{BlockPlace, Core, SyncReason};
use crate::report::Alarm;
use crate::text::{Cursor, Text};

/// A call that has not returned.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) kind: FrameKind,
    /// Where reading goes on after the return.
    back: Resume,
    pub(crate) caller_program: Option<u32>,
    caller_start: Cursor,
    pub(crate) call_line: u32,
}

/// What was called.
#[derive(Debug)]
pub(crate) enum FrameKind {
    /// A subprogram.
    Subprogram { start: Cursor, rounds_left: u32 },
    /// The figure of a finishing cycle.
    Finish { range: FigureRange, home: Position<WorkTip>, at: BlockPlace, code: u16 },
}

/// A place to go on reading: a line, or a block inside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resume {
    pub(crate) line: Cursor,
    pub(crate) from: usize,
}

/// Where programs and sequence numbers stand in a text.
#[derive(Debug, Default)]
pub(crate) struct ProgramIndex {
    /// Number and first line, in order of the text.
    programs: Vec<(u32, Cursor)>,
    /// Number of program in the list above (0 for what stands before the first), sequence number, line;
    /// sorted, so that equal numbers stand together in order of the text.
    sequences: Vec<(u32, u32, Cursor)>,
}

impl Core {
    /// Call depth of subprograms.
    pub(crate) fn depth(&self) -> u8 {
        let calls = self.frames.iter().filter(|frame| matches!(frame.kind, FrameKind::Subprogram { .. }));
        if self.frames.is_empty() { 0 } else { calls.count() as u8 }
    }

    /// Where reading goes on after the block in work.
    pub(crate) fn resume(&self) -> Resume {
        if self.from == 0 {
            Resume { line: self.text.cursor(), from: 0 }
        } else {
            Resume { line: self.line_cursor(), from: self.from }
        }
    }

    /// The line of the block in work.
    pub(crate) fn line_cursor(&self) -> Cursor {
        Cursor { source: self.at.source, offset: self.at.line_offset, line: self.at.line }
    }

    /// Goes on reading at a place.
    pub(crate) fn go(&mut self, to: Resume, environment: &mut dyn Environment) -> Result<(), Alarm> {
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
        match flow {
            Flow::Stop => {
                self.emit(Action::Stop);
                self.sync = Some(SyncReason::CycleStart);
                Ok(())
            }
            Flow::OptionalStop => {
                self.emit(Action::OptionalStop);
                if environment.stops_optionally() {
                    self.sync = Some(SyncReason::CycleStart);
                }
                Ok(())
            }
            Flow::End => {
                self.emit(Action::End);
                self.is_over = true;
                Ok(())
            }
            Flow::Call => self.call(block, word, environment),
            Flow::Return => self.return_from_call(block, environment),
        }
    }

    /// `M98 P_ L_`: the last four digits of a longer P are the program, those before them the count.
    fn call(
        &mut self,
        block: &Block,
        word: Option<Word>,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let Some(target) = block.word(b'P') else {
            return Err(self.alarm_at("call-program-missing", word.as_ref()));
        };
        if let Some(entry) = block.word(b'Q') {
            return Err(self.alarm("illegal-address", entry));
        }
        let value = self.whole(target, 99_999_999)?;
        let (number, rounds) = match block.word(b'L') {
            Some(count) => (value, self.whole(count, 9_999)?),
            None if value > 9_999 => (value % 10_000, value / 10_000),
            None => (value, 1),
        };
        if self.depth() >= self.control.limits.call_depth_max {
            return Err(self.alarm("calls-too-deep", target));
        }
        let found = self.index(environment)?.programs.iter().find(|(known, _)| *known == number).copied();
        let Some((_, start)) = found else {
            let quote = self.quote(target.start, target.end);
            let diagnostic = Diagnostic::alarm("program-not-found").at(self.place(target));
            return Err(self.finish(diagnostic.with("word", quote).with("program", format!("O{number:04}"))));
        };
        if rounds == 0 {
            return Ok(());
        }
        let frame = Frame {
            kind: FrameKind::Subprogram { start, rounds_left: rounds - 1 },
            back: self.resume(),
            caller_program: self.program,
            caller_start: self.program_start,
            call_line: self.at.line,
        };
        self.frames.push(frame);
        self.enter(number, start, environment)
    }

    /// Goes to the first line of a program, which holds its number.
    fn enter(&mut self, number: u32, start: Cursor, environment: &mut dyn Environment) -> Result<(), Alarm> {
        self.program = Some(number);
        self.program_start = start;
        self.expects_program_number = true;
        self.go(Resume { line: start, from: 0 }, environment)
    }

    fn return_from_call(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let target = block.word(b'P').copied();
        let Some(frame) = self.frames.last_mut() else {
            if let Some(word) = target {
                return self.jump_to(&word, environment);
            }
            // In the main program M99 starts over: one round is shown.
            self.warn_block("main-program-repeats");
            self.emit(Action::End);
            self.is_over = true;
            return Ok(());
        };
        if let FrameKind::Subprogram { start, rounds_left } = &mut frame.kind
            && *rounds_left > 0
            && target.is_none()
        {
            *rounds_left -= 1;
            let start = *start;
            self.expects_program_number = true;
            return self.go(Resume { line: start, from: 0 }, environment);
        }
        let Some(frame) = self.frames.pop() else { return Ok(()) };
        self.program = frame.caller_program;
        self.program_start = frame.caller_start;
        match target {
            None => self.go(frame.back, environment),
            Some(word) => self.jump_to(&word, environment),
        }
    }

    /// Goes to the block with the sequence number of a word, in the program in work.
    fn jump_to(&mut self, word: &Word, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let number = self.whole(word, 99_999)?;
        match self.find_sequence(number, self.program_start, environment)? {
            Some((line, _)) => {
                self.expects_program_number = true;
                self.go(Resume { line, from: 0 }, environment)
            }
            None => {
                let quote = self.quote(word.start, word.end);
                let diagnostic = Diagnostic::alarm("sequence-not-found").at(self.place(word));
                Err(self.finish(diagnostic.with("word", quote).with("sequence", i64::from(number))))
            }
        }
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
        if self.settings.end_of_record_allowed && self.frames.is_empty() {
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
        if self.at.sequence != Some(range.last) {
            return Ok(());
        }
        if self.corner.is_some() {
            return Err(self.corner_without_next());
        }
        self.in_cycle = Some(CycleOrigin { label: CycleLabel(code), pass: 1, phase: Phase::Home });
        // Each axis goes back at its own rate, whatever the parameter for rapid moves says.
        self.modal.position = home;
        self.emit_move(
            home,
            Action::Rapid { to: home, path: turnwright_canon::RapidPath::EachAxis, others: None },
        )?;
        self.in_cycle = None;
        if let Some(frame) = self.frames.pop() {
            self.go(frame.back, environment)?;
        }
        Ok(())
    }

    /// Starts the finishing cycle: the blocks of the figure are executed as they stand.
    pub(crate) fn start_finish(
        &mut self,
        first: Cursor,
        range: FigureRange,
        code: u16,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let frame = Frame {
            kind: FrameKind::Finish { range, home: self.modal.position, at: self.at, code },
            back: self.resume(),
            caller_program: self.program,
            caller_start: self.program_start,
            call_line: self.at.line,
        };
        self.frames.push(frame);
        self.in_cycle = Some(CycleOrigin { label: CycleLabel(code), pass: 1, phase: Phase::Finish });
        self.go(Resume { line: first, from: 0 }, environment)
    }

    /// The line with a sequence number in the program in work: the first one behind `from`, else the first
    /// from the start of the program; and how many lines have it.
    pub(crate) fn find_sequence(
        &mut self,
        number: u32,
        from: Cursor,
        environment: &mut dyn Environment,
    ) -> Result<Option<(Cursor, usize)>, Alarm> {
        let start = self.program_start;
        let index = self.index(environment)?;
        let program = index.program_at(start);
        let first = index.sequences.partition_point(|(p, n, _)| (*p, *n) < (program, number));
        let same = index.sequences[first..].iter().take_while(|(p, n, _)| (*p, *n) == (program, number));
        let lines: Vec<Cursor> = same.map(|(_, _, line)| *line).collect();
        let found = lines.iter().find(|line| line.offset > from.offset).or(lines.first());
        Ok(found.map(|line| (*line, lines.len())))
    }

    /// The index of the text, made by one pass over it when it is first needed.
    fn index(&mut self, environment: &mut dyn Environment) -> Result<&ProgramIndex, Alarm> {
        if self.index.is_none() {
            let index = ProgramIndex::read(self.at, environment)?;
            self.index = Some(index);
        }
        match &self.index {
            Some(index) => Ok(index),
            None => unreachable!("made above"),
        }
    }
}

impl ProgramIndex {
    fn read(at: BlockPlace, environment: &mut dyn Environment) -> Result<Self, Alarm> {
        let mut index = Self::default();
        let mut text = Text::new(at.source);
        let mut block = Block::new();
        let unreadable = |_| Box::new(Diagnostic::error("file-unreadable"));
        while let Some(line) = text.next(environment).map_err(unreadable)? {
            let bytes = text.bytes(&line);
            let head = bytes.iter().find(|byte| !matches!(byte, b' ' | b'\t' | 0xef | 0xbb | 0xbf));
            if !matches!(head, Some(b'N' | b'n' | b'O' | b'o' | b':' | b'/')) {
                continue;
            }
            scan_block(bytes, 0, &mut block);
            let cursor = Cursor { source: at.source, offset: line.offset, line: line.number };
            let number = |word: &Word| match word.value {
                Value::Number(number) => u32::try_from(number.digits).ok(),
                _ => None,
            };
            match block.words.first() {
                Some(word) if word.address == b'O' => {
                    if let Some(number) = number(word) {
                        index.programs.push((number, cursor));
                    }
                }
                Some(word) if word.address == b'N' => {
                    if index.sequences.len() >= SEQUENCES_MAX {
                        return Err(Box::new(
                            Diagnostic::error("file-too-large").with("limit", SEQUENCES_MAX as i64),
                        ));
                    }
                    if let Some(number) = number(word) {
                        index.sequences.push((index.programs.len() as u32, number, cursor));
                    }
                }
                _ => {}
            }
        }
        index.sequences.sort_by_key(|(program, number, line)| (*program, *number, line.offset));
        Ok(index)
    }

    /// Number in the list of the program that a line lies in.
    fn program_at(&self, line: Cursor) -> u32 {
        self.programs.partition_point(|(_, start)| start.offset <= line.offset) as u32
    }
}
