//! `finishing` — once along the figure (G70; G72 in system C).
//!
//! `G70 P(ns) Q(nf)` executes the blocks from ns to nf as they stand: their F, S and T act, rapids stay rapid.
//! Then both axes go back to the start point at rapid, each at its own rate, and the program goes on behind the
//! cycle block.
//!
//! Of several figures with these numbers it takes by policy the first one that a search finds, or the one that was roughed.
//!
//! P and Q that are not those of a roughing cycle before are legal and the commonest typing error: a warning.
//!
//! Source: finishing cycle of both families.

use turnwright_diagnostics::Diagnostic;

use super::Function;
use crate::block::Call;
use crate::figure::Roughed;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static FINISHING: Function =
    Function::one_shot("finishing", finishing).with_letters(b"PQ").multiple_cycle();

fn finishing(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_axis_words(call)?;
    core.refuse_in_mdi("cycle-not-in-memory", call.word)?;
    let range = core.range_words(call)?;
    core.compare_with_roughing(&range);
    let first = core.figure_to_finish(&range, call)?;
    core.remember_finished(first.line.line);
    core.start_finish(first, range, call.code, call.environment)
}

impl Core {
    /// X, Z, U and W have no meaning in the finishing cycle.
    fn refuse_axis_words(&self, call: &Call<'_>) -> Result<(), Alarm> {
        match b"XZUW".iter().find_map(|letter| call.block.word(*letter)) {
            Some(word) => Err(self.alarm("cycle-word-illegal", word)),
            None => Ok(()),
        }
    }

    /// A figure that is finished while nothing was roughed yet; roughing it later is worth a warning.
    fn remember_finished(&mut self, line: u32) {
        const REMEMBERED: usize = 16;
        if self.roughed.is_empty() && self.finished_first.len() < REMEMBERED {
            self.finished_first.push(line);
        }
    }

    fn compare_with_roughing(&mut self, range: &crate::figure::FigureRange) {
        if self.roughed.is_empty()
            || self.roughed.iter().any(|one| (one.first, one.last) == (range.first, range.last))
        {
            return;
        }
        // The word that differs from a roughing cycle's, when only one does.
        let same_first = self.roughed.iter().rev().find(|one| one.first == range.first);
        let same_last = self.roughed.iter().rev().find(|one| one.last == range.last);
        let (place, word, expected) = match (same_first, same_last) {
            (Some(one), _) => (range.last_place, format!("Q{}", range.last), format!("Q{}", one.last)),
            (None, Some(one)) => (range.first_place, format!("P{}", range.first), format!("P{}", one.first)),
            (None, None) => {
                let Roughed { first, last, .. } = self.roughed[self.roughed.len() - 1];
                (range.first_place, format!("P{} Q{}", range.first, range.last), format!("P{first} Q{last}"))
            }
        };
        let diagnostic = Diagnostic::warning("finishing-range-differs").at(place);
        self.say(diagnostic.with("word", word).with("expected", expected));
    }
}
