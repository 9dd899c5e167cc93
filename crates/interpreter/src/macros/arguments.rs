//! What a call hands to a macro: letters to local variables.
//!
//! Each letter has its variable; I, J and K may come again, up to ten times, and then name further ones (the
//! second assignment). Each of the three letters is counted for itself, so that any order is understood; where
//! two words name one variable the later counts.
//!
//! Numbers without a point are least increments of their letter on one family (write the point), and what they
//! look like on the other.
//!
//! Source: argument specification I and II, both families; the counting of I, J, K from the examples of GSK.

use turnwright_control::policy::MacroArgumentNumbers;
use turnwright_syntax::{Block, Decimal, Value, Word};

use super::variables::{LOCALS, Locals, NULL};
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

/// Most sets of I, J and K.
const SETS_MAX: usize = 10;

/// The local variable of each letter, 0 for those that hand over nothing. I, J, K: that of the first set.
const VARIABLES: [u8; 26] =
    [1, 2, 3, 7, 8, 9, 0, 11, 4, 5, 6, 0, 13, 0, 0, 0, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26];

/// Which words of a block are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arguments {
    /// Those of a call: G cannot be one.
    OfCall,
    /// Those of a block that a modal call takes over, codes included.
    OfBlock,
}

impl Core {
    /// The local variables that the words of a block make.
    pub(super) fn arguments(
        &mut self,
        block: &Block,
        call: Option<&Word>,
        which: Arguments,
    ) -> Result<Box<Locals>, Alarm> {
        let mut locals = Box::new([NULL; LOCALS]);
        let mut sets = [0usize; 3];
        let only_first_sets = self.control.parameters.bit("arguments-first-sets-only");
        for word in &block.words {
            if Some(word.start) == call.map(|call| call.start) {
                continue;
            }
            if word.comma {
                return Err(self.alarm("illegal-address", word));
            }
            let variable = match word.address {
                b'N' | b'O' => continue,
                b'P' | b'L' if which == Arguments::OfCall => continue,
                b'G' if which == Arguments::OfCall => {
                    return Err(self.alarm("g-code-as-argument", word));
                }
                b'G' => 10,
                b'L' => 12,
                b'P' => 16,
                letter @ (b'I' | b'J' | b'K') => {
                    let set = &mut sets[usize::from(letter - b'I')];
                    let this = if only_first_sets { 0 } else { *set };
                    *set += 1;
                    if this >= SETS_MAX {
                        return Err(self.alarm("too-many-argument-sets", word));
                    }
                    usize::from(VARIABLES[usize::from(letter - b'A')]) + 3 * this
                }
                letter => usize::from(VARIABLES[usize::from(letter - b'A')]),
            };
            locals[variable - 1] = self.argument(word)?;
        }
        Ok(locals)
    }

    /// The value that a word hands over.
    fn argument(&self, word: &Word) -> Result<f64, Alarm> {
        let Value::Number(number) = word.value else {
            return Err(self.alarm("address-without-value", word));
        };
        if number.is_computed() {
            let computed = self.macros.word_values.iter().find(|(start, _)| *start == word.start);
            return Ok(computed.map_or_else(|| as_written(number), |(_, value)| *value));
        }
        let increments = self.control.policies.macro_argument_numbers == MacroArgumentNumbers::Increments
            && !self.settings.is_calculator
            && !number.has_point;
        if !increments {
            return Ok(as_written(number));
        }
        let value = number.digits as f64;
        let modal = &self.modal;
        Ok(match word.address {
            b'D' | b'H' | b'M' | b'Q' | b'S' | b'T' | b'G' | b'L' | b'P' => value,
            b'E' | b'F' => match (modal.feed_mode, modal.is_inch) {
                (FeedMode::PerMinute, false) if self.settings.feed_per_min_fine => value / 1e3,
                (FeedMode::PerMinute, false) => value,
                (FeedMode::PerMinute, true) => value / 1e2,
                (FeedMode::PerRevolution, false) if self.settings.feed_per_rev_fine => value / 1e3,
                (FeedMode::PerRevolution, false) => value / 1e2,
                (FeedMode::PerRevolution, true) => value / 1e4,
            },
            _ => {
                // A quotient of whole numbers is the nearest float; a product of floats need not be.
                let per_unit = if modal.is_inch {
                    25_400_000 / self.settings.inch_increment.nm()
                } else {
                    1_000_000 / self.settings.metric_increment.nm()
                };
                value / per_unit as f64
            }
        })
    }
}

/// A number as it stands there.
fn as_written(number: Decimal) -> f64 {
    number.digits as f64 / 10f64.powi(i32::from(number.scale))
}
