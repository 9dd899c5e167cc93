//! Reading blocks: from a line of the text, or from those that were kept, to a block that can be executed.
//!
//! Statements are told apart from blocks of words here, expressions get their values and skipped blocks are left
//! out. Limits on the number of blocks are counted here.

use turnwright_control::policy::SkipInsideBlock;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, ExtentKind, scan_block};

use crate::Environment;
use crate::cache::{BlockId, Kept};
use crate::index::Resume;
use crate::limits;
use crate::machine::{BlockPlace, Core, Halt};
use crate::macros::Quick;
use crate::report::Alarm;
use crate::text::Cursor;

/// What reading the next block gave.
enum Read {
    /// A block to be executed.
    Block,
    /// A macro statement between these bytes of the line.
    Statement(u32, u32),
    /// A block that was kept.
    Kept(BlockId),
    /// Nothing to execute on this line.
    Blank,
    /// The end of the record or of the text.
    End,
}

impl Core {
    /// Reads and executes one block.
    #[inline]
    pub(crate) fn run_block(
        &mut self,
        block: &mut Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        if self.macros.interrupt.is_some() && environment.interrupts() {
            self.interrupt(environment)?;
        }
        match self.read_block(block, environment)? {
            Read::Blank => Ok(()),
            Read::End => Ok(self.end_of_record()?),
            Read::Kept(id) => self.run_kept(id, block, environment),
            Read::Statement(start, end) => self.read_statement(block, start..end, environment),
            Read::Block => {
                self.count_block()?;
                if block.computes && !self.keeps_variable_words(block) {
                    let result = self.compute_words(block, environment);
                    self.read_again_after(result, environment)?;
                }
                let plain = if self.is_plain { self.plain(block) } else { None };
                self.execute(block, plain, environment)?;
                if self.frames.is_empty() { Ok(()) } else { Ok(self.after_block(environment)?) }
            }
        }
    }

    /// As [`Core::run_block`], where nobody can wait.
    pub(crate) fn run_block_now(
        &mut self,
        block: &mut Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        loop {
            match self.run_block(block, environment) {
                Ok(()) => return Ok(()),
                Err(Halt::Alarm(alarm)) => return Err(alarm),
                Err(Halt::Wait(_)) => self.moves_done = true,
            }
        }
    }

    /// A block that has to wait is read again when it goes on.
    fn read_again_after(
        &mut self,
        result: Result<(), Halt>,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        if let Err(Halt::Wait(_)) = result {
            let start = self.block_start();
            self.go(start, environment)?;
        }
        result
    }

    /// A statement that is not kept: compiled, executed, forgotten.
    #[cold]
    fn read_statement(
        &mut self,
        block: &Block,
        range: std::ops::Range<u32>,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        self.has_started = true;
        self.expects_program_number = false;
        self.count_block()?;
        self.statement_stands_alone(block)?;
        let mark = self.macros.machine.mark();
        let statement = self.compile_statement(range)?;
        let result = self.run_statement(&statement, environment);
        self.macros.machine.forget(mark);
        self.read_again_after(result, environment)?;
        if self.frames.is_empty() { Ok(()) } else { Ok(self.after_block(environment)?) }
    }

    /// Only a sequence number may stand before a macro statement.
    fn statement_stands_alone(&mut self, block: &Block) -> Result<(), Alarm> {
        for (place, word) in block.words.iter().enumerate() {
            if word.address != b'N' {
                return Err(self.alarm("macro-and-nc-mixed", word));
            }
            self.sequence_number(block, place)?;
        }
        Ok(())
    }

    /// Blocks that were kept, up to the next that may give something out: nothing is read, split or compiled again.
    #[inline]
    fn run_kept(
        &mut self,
        id: BlockId,
        block: &mut Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        let mut id = id;
        loop {
            id = self.run_quick(id);
            self.at = self.cache.place(id);
            self.count_block()?;
            let (kept, skip) = self.cache.kept(id);
            if skip != 0 && skips(skip, environment) {
                return Ok(self.go_on(environment)?);
            }
            match *kept {
                Kept::Statement(statement) => {
                    self.count_idle(1)?;
                    self.run_statement(&statement, environment)?;
                }
                Kept::Blank => {
                    self.count_idle(1)?;
                    self.go_on(environment)?;
                }
                Kept::Words { first, count, computed, plain, .. } => {
                    self.cache.refill(block, first, count);
                    self.count_idle(1 + limits::IDLE_WORD_BLOCKS)?;
                    if !computed.is_empty() {
                        self.macros.word_values.clear();
                        let may_be_passed = !self.is_plain || crate::plain::has_other_words(block);
                        block.resolve(computed, |word, place| {
                            let code = self.cache.code(first, place);
                            self.word_value(word, code, may_be_passed, environment)
                        })?;
                    }
                    self.execute(block, plain, environment)?;
                    if self.cache.current == Some(id) {
                        self.go_on(environment)?;
                    }
                }
            }
            if !self.frames.is_empty() {
                self.after_block(environment)?;
            }
            match self.cache.current {
                Some(next) if !self.has_something_to_say() => id = next,
                _ => return Ok(()),
            }
        }
    }

    /// Whether the caller has to be asked or told something before the next block.
    #[inline]
    fn has_something_to_say(&self) -> bool {
        !self.out.is_empty()
            || self.sync.is_some()
            || self.is_over
            || self.active.is_some()
            || self.waiting.is_some()
            // Who reads a figure looks at every block.
            || self.capture.is_some()
            || self.macros.interrupt.is_some()
    }

    #[inline]
    fn count_block(&mut self) -> Result<(), Alarm> {
        self.blocks_run += 1;
        if self.blocks_run <= self.options.blocks_max { Ok(()) } else { Err(self.too_many_blocks()) }
    }

    #[cold]
    fn too_many_blocks(&self) -> Alarm {
        let limit = self.options.blocks_max as i64;
        let diagnostic = Diagnostic::error("block-limit-reached").at(self.block_place()).with("limit", limit);
        self.finish(diagnostic)
    }

    /// Counts a block of a loop; moves given out start the count anew.
    #[inline]
    pub(crate) fn count_idle(&mut self, weight: u64) -> Result<(), Alarm> {
        self.idle_blocks += weight;
        if self.idle_blocks <= self.options.idle_blocks_max { Ok(()) } else { Err(self.idles_too_long()) }
    }

    #[cold]
    fn idles_too_long(&self) -> Alarm {
        let limit = self.options.idle_blocks_max as i64;
        let diagnostic = Diagnostic::error("loop-without-motion").at(self.block_place()).with("limit", limit);
        self.finish(diagnostic)
    }

    /// Reads the next block that has something to execute into `block`.
    #[inline]
    fn read_block(&mut self, block: &mut Block, environment: &mut dyn Environment) -> Result<Read, Alarm> {
        if let Some(id) = self.cache.current {
            return Ok(Read::Kept(id));
        }
        if self.from == 0 {
            match self.text.next(environment) {
                Ok(Some(line)) => self.line = line,
                Ok(None) => {
                    block.clear();
                    return Ok(Read::End);
                }
                Err(_) => return Err(Box::new(Diagnostic::error("file-unreadable"))),
            }
        }
        let source = self.text.source();
        let is_hot = self.cache.is_hot(source, self.line.offset);
        if is_hot && let Some(id) = self.cache.find(self.place_in_line()) {
            return Ok(Read::Kept(id));
        }
        let bytes = self.text.bytes(&self.line);
        let length = bytes.len();
        self.block_from = self.from;
        let next = scan_block(bytes, self.from, block);
        let last_byte = block.words.last().map_or(length as u32, |word| word.end);
        let first_byte = block.words.first().map_or(self.from as u32, |word| word.start);
        self.from = if next < length { next } else { 0 };
        self.at = BlockPlace {
            source,
            line: self.line.number,
            line_offset: self.line.offset,
            first_byte,
            last_byte,
            sequence: None,
        };
        if self.line.is_cut {
            let limit = crate::LINE_BYTES_MAX as i64;
            let place = self.at.span(0, limit as u32);
            return Err(Box::new(Diagnostic::error("line-too-long").at(place).with("limit", limit)));
        }
        if block.is_percent || block.is_end_of_text {
            // Before the first block this is the leader of the tape.
            return Ok(if self.has_started || block.is_end_of_text { Read::End } else { Read::Blank });
        }
        if let Some((start, end)) = block.macro_statement {
            (self.at.first_byte, self.at.last_byte) = (start, end);
        }
        if is_hot {
            self.count_idle(limits::IDLE_READ_BLOCKS)?;
            if let Some(id) = self.keep(block, environment)? {
                return Ok(Read::Kept(id));
            }
        }
        self.cache.forget_way();
        if block.skip.whole | block.skip.rest != 0 {
            self.apply_skips(block, environment)?;
        }
        if !block.faults.is_empty() {
            self.report_faults(block)?;
        }
        if let Some((start, end)) = block.macro_statement {
            return Ok(Read::Statement(start, end));
        }
        Ok(if block.words.is_empty() { Read::Blank } else { Read::Block })
    }

    /// Where the next block begins, its line being read already.
    pub(crate) fn place_in_line(&self) -> Resume {
        let source = self.text.source();
        let line = Cursor { source, offset: self.line.offset, line: self.line.number };
        Resume { line, from: self.from }
    }

    /// Keeps a block of a loop, if nothing about it needs a second look.
    #[cold]
    fn keep(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<Option<BlockId>, Alarm> {
        let is_plain = block.skip.rest == 0
            && !(block.computes && self.keeps_variable_words(block))
            && block.extents.iter().all(|extent| extent.kind != ExtentKind::Name)
            && block.faults.iter().all(|fault| fault.kind.is_harmless());
        if !is_plain || (block.skip.whole != 0 && skips(block.skip.whole, environment)) {
            return Ok(None);
        }
        self.report_faults(block)?;
        let behind = if self.from == 0 {
            Resume { line: self.text.cursor(), from: 0 }
        } else {
            Resume { from: self.from, ..self.place_in_line() }
        };
        let start = Resume { from: self.block_from, ..self.place_in_line() };
        let mark = self.macros.machine.mark();
        let id = if let Some((from, to)) = block.macro_statement {
            self.statement_stands_alone(block)?;
            let statement = self.compile_statement(from..to)?;
            self.check_loop(statement, environment)?;
            let frame = self.kept_frame(block, start, behind);
            let quick = Quick::of(&statement, &self.macros.machine);
            self.cache.keep_statement(Some((statement, quick)), frame.of(self.text.bytes(&self.line)))
        } else if block.words.is_empty() {
            let frame = self.kept_frame(block, start, behind);
            self.cache.keep_statement(None, frame.of(self.text.bytes(&self.line)))
        } else {
            let mut codes = Vec::new();
            self.compile_words(block, &mut codes)?;
            let plain = self.plain(block);
            let is_short =
                plain.is_some() && codes.iter().all(|code| self.macros.machine.stands_alone(*code));
            let frame = self.kept_frame(block, start, behind);
            self.cache.keep_words(block, &codes, plain, is_short, frame.of(self.text.bytes(&self.line)))
        };
        if id.is_none() {
            self.macros.machine.forget(mark);
        }
        Ok(id)
    }

    fn kept_frame(&self, block: &Block, start: Resume, behind: Resume) -> crate::cache::Place {
        crate::cache::Place { at: self.at, start, behind, skip: block.skip.whole }
    }

    #[cold]
    fn apply_skips(&self, block: &mut Block, environment: &mut dyn Environment) -> Result<(), Alarm> {
        if block.skip.rest != 0 && self.control.policies.skip_inside_block == SkipInsideBlock::Alarm {
            return Err(self.skip_inside_block(block));
        }
        if skips(block.skip.whole, environment) {
            block.clear();
        } else if skips(block.skip.rest, environment) {
            let kept = usize::from(block.skip.words_kept);
            let from = block.words.get(kept).map_or(u32::MAX, |word| word.start);
            block.faults.retain(|fault| fault.start < from);
            block.truncate(kept);
        }
        Ok(())
    }
}

/// Whether one of the switches in `marks` is on.
fn skips(marks: u16, environment: &dyn Environment) -> bool {
    (1..=9u8).any(|switch| marks & (1 << switch) != 0 && environment.skips(switch))
}
