//! The figure of a cycle: finding its blocks, and reading them without moving.
//!
//! In: the sequence numbers P and Q of a cycle block. Out: a [`Figure`] and where execution goes on. Source:
//! the rules for the blocks from P to Q of the repetitive cycles.

use turnwright_control::policy::{AfterRoughing, DuplicateSequence, FinishingFigure, FirstFigureCode};
use turnwright_cycles::Figure;
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_syntax::{Block, Word, scan_block};
use turnwright_units::Feed;

use crate::block::Call;
use crate::flow::{FrameKind, Resume};
use crate::functions::FunctionId;
use crate::machine::{Capture, Core};
use crate::report::Alarm;
use crate::text::{Cursor, Text};

const CROSS: u32 = Block::bit(b'X') | Block::bit(b'U');
const ALONG: u32 = Block::bit(b'Z') | Block::bit(b'W');

/// The sequence numbers of a figure, and where they were written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FigureRange {
    pub(crate) first: u32,
    pub(crate) last: u32,
    pub(crate) first_place: Place,
    pub(crate) last_place: Place,
}

/// A figure that was roughed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Roughed {
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// Its first block.
    begin: Resume,
}

/// A figure that was read.
#[derive(Debug)]
pub(crate) struct Captured {
    pub(crate) figure: Figure,
    pub(crate) range: FigureRange,
    /// Words of the first block.
    pub(crate) first_has_x: bool,
    pub(crate) first_has_z: bool,
    pub(crate) first_place: Place,
    /// At which its cycle cuts.
    pub(crate) feed: Feed,
    /// Its first block.
    begin: Resume,
    /// Where execution goes on.
    pub(crate) behind: Resume,
}

impl Captured {
    /// What is remembered of it.
    pub(crate) const fn roughed(&self) -> Roughed {
        Roughed { first: self.range.first, last: self.range.last, begin: self.begin }
    }

    /// Lines of the elements, for the origins of moves.
    pub(crate) fn lines(&self) -> Vec<u32> {
        self.figure.elements.iter().map(|element| element.line).collect()
    }
}

impl Core {
    /// Reading or finishing a figure: only some codes are allowed.
    pub(crate) fn is_in_figure(&self) -> bool {
        self.is_capturing()
            || matches!(self.frames.last().map(|frame| &frame.kind), Some(FrameKind::Finish { .. }))
    }

    /// The block in work is the first of the figure being read or finished.
    pub(crate) fn is_first_of_figure(&self) -> bool {
        let has_begun = self.capture.as_ref().is_some_and(|capture| !capture.elements.is_empty());
        !has_begun && self.figure_range().is_some_and(|range| self.at.sequence == Some(range.first))
    }

    fn figure_range(&self) -> Option<FigureRange> {
        match (&self.capture, self.frames.last().map(|frame| &frame.kind)) {
            (Some(capture), _) => Some(capture.range),
            (None, Some(FrameKind::Finish { range, .. })) => Some(*range),
            _ => None,
        }
    }

    /// P and Q of a cycle block.
    pub(crate) fn range_words(&self, call: &Call<'_>) -> Result<FigureRange, Alarm> {
        let block = call.block;
        let (Some(first), Some(last)) = (block.word(b'P'), block.word(b'Q')) else {
            let present = block.word(b'P').or(block.word(b'Q')).or(call.word);
            return Err(self.alarm_at("cycle-p-or-q-missing", present));
        };
        Ok(FigureRange {
            first: self.whole(first, 99_999)?,
            last: self.whole(last, 99_999)?,
            first_place: self.place(first),
            last_place: self.place(last),
        })
    }

    /// The lines with the first and last sequence number of a figure.
    pub(crate) fn find_range(
        &mut self,
        range: &FigureRange,
        call: &mut Call<'_>,
    ) -> Result<(Resume, Resume), Alarm> {
        let here = self.block_start();
        let found = self.find_sequence(range.first, here, call.environment)?;
        let Some((first, firsts)) = found else {
            return Err(self.range_alarm(range.first, range.first_place));
        };
        // The first block may be the last one too.
        let before = Cursor { offset: first.line.offset.wrapping_sub(1), ..first.line };
        let before = Resume { line: before, from: usize::MAX };
        let found = self.find_sequence(range.last, before, call.environment)?;
        let behind = found.filter(|(last, _)| last.position() >= first.position());
        let Some((last, lasts)) = behind else {
            if found.is_none() {
                return Err(self.range_alarm(range.last, range.last_place));
            }
            let diagnostic = Diagnostic::alarm("figure-order-reversed").at(range.last_place);
            return Err(self.finish(diagnostic.with("word", format!("P{} Q{}", range.first, range.last))));
        };
        for (count, number, place) in
            [(firsts, range.first, range.first_place), (lasts, range.last, range.last_place)]
        {
            if count > 1 {
                self.report_duplicate(number, place)?;
            }
        }
        if last.position() == self.block_start().position() {
            // The cycle would be part of its own figure.
            let mut diagnostic = Diagnostic::alarm("figure-code-illegal").at(range.last_place);
            diagnostic = diagnostic.with("word", format!("Q{}", range.last));
            return Err(self.finish(diagnostic.near(self.block_place(), "figure-range-names-cycle")));
        }
        Ok((first, last))
    }

    /// The first block of the figure that the finishing cycle runs.
    pub(crate) fn figure_to_finish(
        &mut self,
        range: &FigureRange,
        call: &mut Call<'_>,
    ) -> Result<Resume, Alarm> {
        let (found, _) = self.find_range(range, call)?;
        if self.control.policies.finishing_figure == FinishingFigure::Searched {
            return Ok(found);
        }
        let is_same = |one: &&Roughed| (one.first, one.last) == (range.first, range.last);
        Ok(self.roughed.iter().rev().find(is_same).map_or(found, |one| one.begin))
    }

    fn report_duplicate(&mut self, number: u32, place: Place) -> Result<(), Alarm> {
        let refuses = self.control.policies.duplicate_sequence == DuplicateSequence::Alarm;
        let diagnostic = if refuses {
            Diagnostic::alarm("figure-number-duplicate")
        } else {
            Diagnostic::warning("duplicate-sequence")
        };
        let diagnostic =
            diagnostic.at(place).with("sequence", i64::from(number)).with("word", format!("N{number}"));
        if refuses {
            return Err(self.finish(diagnostic));
        }
        if !self.already_said("duplicate-sequence", place.line) {
            self.say(diagnostic);
        }
        Ok(())
    }

    fn range_alarm(&self, number: u32, place: Place) -> Alarm {
        let diagnostic = Diagnostic::alarm("figure-block-not-found").at(place);
        self.finish(diagnostic.with("sequence", i64::from(number)).with("word", format!("N{number}")))
    }

    /// The program ended inside the figure.
    pub(crate) fn figure_without_end(&self) -> Alarm {
        match self.figure_range() {
            Some(range) => self.range_alarm(range.last, range.last_place),
            None => self.alarm_block("figure-block-not-found"),
        }
    }

    /// A code that no figure may have. When it stands in the block that Q names, Q is the mistake.
    pub(crate) fn refuse_in_figure(&self, word: &Word) -> Alarm {
        let here = self.place(word);
        let quote = self.quote(word.start, word.end);
        match self.figure_range() {
            Some(range) if self.at.sequence == Some(range.last) => {
                let diagnostic = Diagnostic::alarm("figure-code-illegal").at(range.last_place);
                self.finish(
                    diagnostic.with("word", format!("Q{}", range.last)).near(here, "figure-code-illegal"),
                )
            }
            Some(range) => {
                let diagnostic = Diagnostic::alarm("figure-code-illegal").at(here).with("word", quote);
                self.finish(diagnostic.near(range.first_place, "figure-range-here"))
            }
            None => self.alarm("figure-code-illegal", word),
        }
    }

    /// Reads the figure that P and Q of a cycle block name.
    pub(crate) fn capture_figure(&mut self, call: &mut Call<'_>) -> Result<Captured, Alarm> {
        self.refuse_in_mdi("cycle-not-in-memory", call.word)?;
        let range = self.range_words(call)?;
        let (first, _) = self.find_range(&range, call)?;
        // Feeds of the figure do not count in roughing.
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        let is_adjacent = self.look_between(first, &range, call)?;
        let here = self.resume();
        let cycle_line = self.line_cursor();
        let (modal, at, tip) = (self.modal.clone(), self.at, self.tip);
        // Compensation in force waits outside of the figure; it shifts the figure only where the control does that.
        let compensation = self.compensation.take();
        self.capture = Some(Capture { elements: Vec::new(), curve_pieces: 0, range });
        self.compensate_figure(compensation.as_deref());
        self.go(first, call.environment)?;
        let read = self.read_figure(range, call);
        let read = read.and_then(|first| self.stop_reading_ahead().map(|()| first));
        self.compensation = compensation;
        self.look_at_moves();
        let behind = self.next_block();
        let capture = self.capture.take();
        (self.modal, self.at, self.tip) = (modal, at, tip);
        let (first_letters, first_place) = read?;
        // Messages about the cycle block quote its line.
        self.go(Resume { line: cycle_line, from: 0 }, call.environment)?;
        if let Ok(Some(line)) = self.text.next(call.environment) {
            self.line = line;
        }
        let stands_before = first.line.offset < cycle_line.offset;
        if stands_before {
            // Going on behind such a figure would run the cycle for ever.
            self.warn_block("behaviour-uncertain");
        }
        let behind = match self.control.policies.after_roughing {
            AfterRoughing::BehindFigure if stands_before => here,
            AfterRoughing::BehindFigure => behind,
            AfterRoughing::BehindAdjacentFigure if is_adjacent => behind,
            AfterRoughing::BehindAdjacentFigure => here,
        };
        let elements = capture.map_or_else(Vec::new, |capture| capture.elements);
        Ok(Captured {
            figure: Figure { start: self.modal.position, elements },
            range,
            first_has_x: first_letters & CROSS != 0,
            first_has_z: first_letters & ALONG != 0,
            first_place,
            feed,
            begin: first,
            behind,
        })
    }

    /// Runs the figure's blocks; gives letters and place of the first.
    fn read_figure(&mut self, range: FigureRange, call: &mut Call<'_>) -> Result<(u32, Place), Alarm> {
        let mut block = Block::new();
        let mut first = None;
        loop {
            self.run_block_now(&mut block, call.environment)?;
            if self.at.sequence.is_none() && block.is_empty() {
                continue;
            }
            if first.is_none() {
                first = Some((block.present(), self.block_place()));
                self.check_first_code()?;
            }
            if self.at.sequence == Some(range.last) {
                break;
            }
        }
        if self.corner.is_some() {
            return Err(self.corner_without_next());
        }
        Ok(first.unwrap_or((0, range.first_place)))
    }

    fn check_first_code(&self) -> Result<(), Alarm> {
        let motion = self.modal.motion;
        let plain = motion == FunctionId::RAPID || motion == FunctionId::LINEAR;
        let arcs =
            self.control.policies.first_figure_code == FirstFigureCode::AnyMotion && motion.get().in_figure;
        if plain || arcs { Ok(()) } else { Err(self.alarm_block("figure-start-code")) }
    }

    /// Looks at what stands between the cycle block and its figure: it never runs. True when that is nothing.
    fn look_between(
        &mut self,
        first: Resume,
        range: &FigureRange,
        call: &mut Call<'_>,
    ) -> Result<bool, Alarm> {
        let here = self.resume();
        if here.from > 0 || first.line.offset < here.line.offset {
            return Ok(false);
        }
        let mut text = Text::new(self.at.source);
        text.jump(here.line);
        let mut block = Block::new();
        let mut is_adjacent = true;
        loop {
            let line = match text.next(call.environment) {
                Ok(Some(line)) if line.offset < first.line.offset => line,
                Ok(_) => return Ok(is_adjacent),
                Err(_) => return Err(Box::new(Diagnostic::error("file-unreadable"))),
            };
            scan_block(text.bytes(&line), 0, &mut block);
            if block.is_empty() {
                continue;
            }
            is_adjacent = false;
            if block.present() & (CROSS | ALONG) != 0
                && self.control.policies.after_roughing == AfterRoughing::BehindFigure
                && !self.already_said("figure-start-skipped", self.at.line)
            {
                let skipped = Place {
                    source: self.at.source,
                    line: line.number,
                    line_offset: line.offset,
                    column: 1,
                    end_column: (line.end - line.start) as u32 + 1,
                };
                let diagnostic = Diagnostic::warning("figure-start-skipped").at(range.first_place);
                let diagnostic =
                    diagnostic.with("word", format!("P{}", range.first)).with("line", line.number);
                self.say(diagnostic.near(skipped, "figure-start-skipped"));
            }
        }
    }
}
