//! Short lines of the text.

use turnwright_syntax::{LineEnd, ShortLine};

use super::ShortLines;
use crate::machine::{BlockPlace, Core};
use crate::plain;
use crate::text::Line;

/// The line ahead in the text.
#[derive(Debug, Default)]
pub(crate) struct TextLines {
    line: ShortLine,
    end: LineEnd,
}

impl ShortLines for TextLines {
    #[inline(always)]
    fn next_line(&mut self, core: &mut Core) -> Option<&ShortLine> {
        let is_ahead = core.from == 0
            && core.frames.is_empty()
            && !core.cache.is_hot(core.text.source(), core.text.next_offset());
        if !is_ahead {
            return None;
        }
        self.end = self.line.read(core.text.ahead(), plain::PLAIN)?;
        Some(&self.line)
    }

    #[inline(always)]
    fn take_line(&self, core: &mut Core, sequence: Option<u32>) {
        core.line = core.text.take_ahead(self.end);
        core.block_from = 0;
        let Line { number: line, offset: line_offset, .. } = core.line;
        let (first_byte, last_byte) = self.line.bytes();
        core.at =
            BlockPlace { source: core.text.source(), line, line_offset, first_byte, last_byte, sequence };
        core.cache.forget_way();
    }
}
