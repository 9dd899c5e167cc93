//! Short lines of the text.
//!
//! Whether something forbids the short way is asked before the first of them. As long as they follow each other, nothing
//! can come that does.

use turnwright_syntax::{LineEnd, ShortLine};

use super::ShortLines;
use crate::machine::{BlockPlace, Core};
use crate::plain;

/// The line ahead in the text.
#[derive(Debug, Default)]
pub(crate) struct TextLines {
    line: ShortLine,
    end: LineEnd,
    /// The block in work is the short line taken last. Its [`Core::line`] is found when it is left.
    goes_on: bool,
}

impl TextLines {
    /// Whether short lines go on: nothing else has come since the last one.
    #[inline(always)]
    pub(crate) fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// Something else comes.
    pub(crate) fn stop(&mut self, core: &mut Core) {
        if std::mem::take(&mut self.goes_on) {
            core.line = core.text.taken(core.at.line, core.at.line_offset);
        }
    }

    /// Whether the first short line may come.
    fn may_begin(core: &Core) -> bool {
        core.may_go_short()
            && core.from == 0
            && core.frames.is_empty()
            && !core.cache.is_hot(core.text.source(), core.text.next_offset())
    }
}

impl ShortLines for TextLines {
    #[inline(always)]
    fn next_line(&mut self, core: &mut Core) -> Option<&ShortLine> {
        if !self.goes_on && !Self::may_begin(core) {
            return None;
        }
        let end = if core.may_run_block() { self.line.read(core.text.ahead(), plain::PLAIN) } else { None };
        let Some(end) = end else {
            self.stop(core);
            return None;
        };
        self.end = end;
        Some(&self.line)
    }

    #[inline(always)]
    fn take_line(&mut self, core: &mut Core, sequence: Option<u32>) -> BlockPlace {
        if !self.goes_on {
            self.goes_on = true;
            core.block_from = 0;
            core.cache.forget_way();
        }
        let (first_byte, last_byte) = self.line.bytes();
        let (source, line_offset) = (core.text.source(), core.text.next_offset());
        let line = core.text.take_ahead(self.end);
        let at = BlockPlace { source, line, line_offset, first_byte, last_byte, sequence };
        core.at = at;
        at
    }

    fn leave_line(&mut self, core: &mut Core) {
        self.stop(core);
    }
}
