//! Short lines that were kept: those of loops, their expressions computed anew each time.

use turnwright_syntax::{Decimal, ShortLine};

use super::ShortLines;
use crate::cache::{BlockId, Kept, Way};
use crate::limits;
use crate::machine::{BlockPlace, Core};
use crate::macros::{is_null, number};

/// The kept line that comes next.
#[derive(Debug, Default)]
pub(crate) struct KeptLines {
    line: ShortLine,
    /// The block whose words the line has.
    of: Option<BlockId>,
}

/// What a block of words costs of the bound on loops that make no move.
const IDLE_BLOCKS: u64 = 1 + limits::IDLE_WORD_BLOCKS;

impl ShortLines for KeptLines {
    #[inline(always)]
    fn next_line(&mut self, core: &mut Core) -> Option<&ShortLine> {
        if !(core.may_go_short() && core.may_run_block()) {
            return None;
        }
        let id = core.run_quick(core.cache.current?);
        let (kept, skip) = core.cache.kept(id);
        let &Kept::Words { first, count, computed, is_short: true, .. } = kept else { return None };
        let is_free = skip == 0
            && core.in_cycle.is_none()
            && core.capture.is_none()
            && core.cache.leads_on(id)
            && core.may_run_block()
            && core.idle_blocks + IDLE_BLOCKS <= core.options.idle_blocks_max;
        if !is_free {
            return None;
        }
        if self.of != Some(id) {
            self.line.fill(core.cache.words(first, count));
            self.of = Some(id);
        }
        for place in computed {
            let letter = core.cache.words(first, count)[place].address;
            let code = core.cache.code(first, place);
            let value = core.macros.machine.value(code, &core.macros.variables)?;
            if is_null(value) {
                return None;
            }
            self.line.set(letter, Decimal::computed(number(value))?);
        }
        Some(&self.line)
    }

    #[inline(always)]
    fn take_line(&mut self, core: &mut Core, sequence: Option<u32>) -> BlockPlace {
        core.idle_blocks += IDLE_BLOCKS;
        let Some(id) = self.of else { return core.at };
        let at = BlockPlace { sequence, ..core.cache.place(id) };
        core.at = at;
        core.cache.follow(Way::Next);
        at
    }

    #[cold]
    fn leave_line(&mut self, core: &mut Core) {
        if let Some(id) = self.of {
            core.cache.leave_short_way(id);
        }
    }
}
