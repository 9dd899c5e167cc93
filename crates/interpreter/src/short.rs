//! The shortest way: a line of a path, straight from its numbers to its move.
//!
//! In: a line that is nothing but a sequence number, G00 to G03, axis words, `R`, `I`, `K` and a feed, where nothing is
//! to be said about any of them; read from the text ([`text`]) or kept in a loop ([`kept`]). Out: the move that
//! [`plain`](crate::plain) and [`block`](crate::block) would make of it. Whatever needs a word of its own, for an alarm,
//! a warning or a place, is left to them before anything has happened. What words mean stands in
//! [`words`](crate::words), what functions do in theirs; only the way is another.

mod kept;
mod text;

use turnwright_canon::{Action, Command, Shape};
use turnwright_syntax::{Block, Decimal, ShortLine};
use turnwright_units::{Feed, Length, Position, WorkTip};

use crate::functions::arc::short_centre;
use crate::functions::{FunctionId, PathKind};
use crate::machine::{BlockPlace, Core};
use crate::plain;
use crate::words::{Role, is_strange_feed};

pub(crate) use self::kept::KeptLines;
pub(crate) use self::text::TextLines;

const CROSS: u32 = Block::bit(b'X') | Block::bit(b'U');
const ALONG: u32 = Block::bit(b'Z') | Block::bit(b'W');

/// Where short lines come from.
pub(crate) trait ShortLines {
    /// The line that comes next, when it and what is in force let it go the short way. Nothing has happened then that
    /// the long way would not find as it was.
    fn next_line(&mut self, core: &mut Core) -> Option<&ShortLine>;

    /// Makes that line the block in work, and tells its place.
    fn take_line(&mut self, core: &mut Core, sequence: Option<u32>) -> BlockPlace;

    /// That line is left to the long way.
    fn leave_line(&mut self, core: &mut Core);
}

/// What a short line asks for.
pub(crate) struct ShortMove<'l> {
    line: &'l ShortLine,
    pub(crate) from: Position<WorkTip>,
    pub(crate) to: Position<WorkTip>,
}

impl ShortMove<'_> {
    /// The words of an arc: [`plain::BEND`].
    #[inline]
    fn has_bend(&self) -> bool {
        self.line.present() & plain::BEND != 0
    }

    #[inline]
    pub(crate) fn number(&self, letter: u8) -> Option<&Decimal> {
        self.line.number(letter)
    }
}

/// What a short line changes besides its move.
#[derive(Default)]
struct Changes {
    code: Option<(FunctionId, u16)>,
    sequence: Option<u32>,
    feed: Option<Length>,
}

impl Core {
    /// The move of the next line that makes one, as long as lines are short; `None` when the next one is another.
    #[inline(always)]
    pub(crate) fn next_short_move(&mut self, lines: &mut impl ShortLines) -> Option<Command> {
        loop {
            let line = lines.next_line(self)?;
            let Some((to, changes)) = self.short_target(line) else { break };
            let (id, _) = changes.code.unwrap_or((self.modal.motion, 0));
            let short = ShortMove { line, from: self.modal.position, to };
            // Each makes its move where it is given out: one that is carried there is waited for.
            match id.get().path {
                Some(PathKind::Rapid) if !short.has_bend() => {
                    let at = self.take_short_line(lines, &changes);
                    if self.goes_to(to) {
                        let path = self.rapid_path();
                        let action = Action::Rapid { to, path, others: None };
                        return Some(Command::new(action, self.origin_outside_cycles(at)));
                    }
                }
                Some(PathKind::Line) if !short.has_bend() => {
                    let Some(feed) = self.short_cut_feed(&changes) else { break };
                    let at = self.take_short_line(lines, &changes);
                    if self.goes_to(to) {
                        let action = Action::Feed { to, shape: Shape::Line, feed, others: None };
                        return Some(Command::new(action, self.origin_outside_cycles(at)));
                    }
                }
                Some(PathKind::Arc(turn)) => {
                    let Some(feed) = self.short_cut_feed(&changes) else { break };
                    let Some(centre) = short_centre(self, &short, turn) else { break };
                    let at = self.take_short_line(lines, &changes);
                    self.goes_to(to);
                    let shape = Shape::Arc { turn, centre };
                    let action = Action::Feed { to, shape, feed, others: None };
                    return Some(Command::new(action, self.origin_outside_cycles(at)));
                }
                _ => break,
            }
        }
        lines.leave_line(self);
        None
    }

    /// The feed that a cut of a short line has.
    #[inline(always)]
    fn short_cut_feed(&self, changes: &Changes) -> Option<Feed> {
        let feed = changes.feed.or(self.modal.feed).and_then(|feed| self.feed_of(feed))?;
        (!self.cuts_beside_standing_spindle()).then_some(feed)
    }

    /// Whether nothing asks to see lines or moves on their way.
    #[inline(always)]
    fn may_go_short(&self) -> bool {
        self.is_plain
            && !self.is_over
            && !self.looks_at_moves
            && self.waiting.is_none()
            && self.macros.interrupt.is_none()
            && self.macros.state.single_block == 0
    }

    /// Whether one block more may be executed.
    #[inline(always)]
    fn may_run_block(&self) -> bool {
        self.blocks_run < self.options.blocks_max
    }

    /// The end point of a short line, and what else it says, where all of it is in order.
    #[inline(always)]
    fn short_target(&self, line: &ShortLine) -> Option<(Position<WorkTip>, Changes)> {
        let present = line.present();
        if present & plain::AXES == 0 {
            return None;
        }
        let mut to = self.modal.position;
        if present & CROSS != 0 {
            let (number, is_increment) = self.short_axis_word(line, b'X', b'U')?;
            let length = self.plain_place(number)?;
            to.x = if is_increment {
                to.x + self.radius_of(self.limited(length)?, Role::XIncrement)
            } else {
                self.radius_of(length, Role::XCoordinate)
            };
        }
        if present & ALONG != 0 {
            let (number, is_increment) = self.short_axis_word(line, b'Z', b'W')?;
            let length = self.plain_place(number)?;
            to.z = if is_increment { to.z + self.limited(length)? } else { length };
        }
        if !self.is_in_range(to) {
            return None;
        }
        let mut changes = Changes::default();
        if let Some(number) = line.number(b'G') {
            changes.code = Some(self.plain_code(*number)?);
        }
        if let Some(number) = line.number(b'N') {
            let is_first = line.first() == b'N';
            changes.sequence = Some(self.plain_sequence(*number).filter(|_| is_first)?);
        }
        if let Some(number) = line.number(b'F') {
            changes.feed = Some(self.short_feed(*number)?);
        }
        Some((to, changes))
    }

    /// As [`Core::axis_word`], where one of the two letters stands.
    #[inline(always)]
    fn short_axis_word<'l>(
        &self,
        line: &'l ShortLine,
        absolute: u8,
        increment: u8,
    ) -> Option<(&'l Decimal, bool)> {
        match (line.number(absolute), line.number(increment)) {
            (Some(number), None) => Some((number, self.modal.is_incremental)),
            (None, Some(number)) if self.dispatch.has_incremental_words => Some((number, true)),
            _ => None,
        }
    }

    /// As [`Core::feed_word`], where nothing is to be said.
    #[inline(always)]
    fn short_feed(&self, number: Decimal) -> Option<Length> {
        let per_revolution = self.modal.feed_mode == crate::modal::FeedMode::PerRevolution;
        let feed = self.plain_feed(number, per_revolution).filter(|_| !number.is_negative)?;
        let is_above = self.feed_of(feed).is_some_and(|feed| self.is_above_cutting_speed(feed));
        (!is_above && !is_strange_feed(feed, per_revolution)).then_some(feed)
    }

    /// Makes a short line the block in work, and tells its place.
    #[inline(always)]
    fn take_short_line(
        &mut self,
        lines: &mut impl ShortLines,
        &Changes { code, sequence, feed }: &Changes,
    ) -> BlockPlace {
        let at = lines.take_line(self, sequence);
        self.blocks_run += 1;
        if sequence.is_some() {
            self.modal.in_force.sequence = sequence;
        }
        if let Some((id, code)) = code {
            self.change_motion(id, code);
        }
        if feed.is_some() {
            (self.modal.feed, self.modal.feed_is_lead) = (feed, false);
        }
        at
    }

    /// The tool goes to the end of a short line; whether that is another place.
    #[inline(always)]
    fn goes_to(&mut self, to: Position<WorkTip>) -> bool {
        self.modal.position = to;
        let goes = to != self.tip;
        self.tip = to;
        goes
    }
}
