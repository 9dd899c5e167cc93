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
use crate::flow::FrameKind;
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

/// Most sets of I, J and K.
const SETS_MAX: usize = 10;

/// The local variable of each letter, 0 for those that hand over nothing. I, J, K: that of the first set.
const VARIABLES: [u8; 26] =
    [1, 2, 3, 7, 8, 9, 0, 11, 4, 5, 6, 0, 13, 0, 0, 0, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26];

/// What a call hands to its macro.
#[derive(Clone, Debug)]
pub(crate) struct Passed {
    /// The local variables.
    pub(crate) values: Box<Locals>,
    /// The letter of each whose word had no point, else 0.
    pointless: [u8; LOCALS],
}

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
    ) -> Result<Passed, Alarm> {
        let mut locals = Box::new([NULL; LOCALS]);
        let mut pointless = [0; LOCALS];
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
            let is_pointless =
                matches!(word.value, Value::Number(number) if !number.has_point && !number.is_computed());
            pointless[variable - 1] = if is_pointless { word.address } else { 0 };
        }
        Ok(Passed { values: locals, pointless })
    }

    /// `ADP` of a local variable: an argument that was written without a point, with the point behind its last
    /// digit. By parameter (6007#4) arguments are converted for good, and nothing is changed.
    #[cold]
    pub(super) fn with_point(&self, slot: u16) -> f64 {
        let value = self.macros.variables.get(slot);
        let place = usize::from(slot);
        let frame = self.frames.iter().rev().find_map(|frame| match &frame.kind {
            FrameKind::Macro(frame) => Some(frame),
            _ => None,
        });
        let passed = frame.map(|frame| &frame.arguments).filter(|passed| passed.values[place] == value);
        let letter = passed.map_or(0, |passed| passed.pointless[place]);
        let converts = self.control.policies.macro_argument_numbers == MacroArgumentNumbers::Increments
            && !self.settings.is_calculator
            && !self.control.parameters.bit("arguments-by-value");
        if letter == 0 || !converts { value } else { (value * self.increments_per_unit(letter)).round() }
    }

    /// How many of what a number without a point counts make one.
    fn increments_per_unit(&self, address: u8) -> f64 {
        let modal = &self.modal;
        match address {
            b'D' | b'H' | b'M' | b'Q' | b'S' | b'T' | b'G' | b'L' | b'P' => 1.0,
            b'E' | b'F' => match (modal.feed_mode, modal.is_inch) {
                (FeedMode::PerMinute, false) if self.settings.feed_per_min_fine => 1e3,
                (FeedMode::PerMinute, false) => 1.0,
                (FeedMode::PerMinute, true) => 1e2,
                (FeedMode::PerRevolution, false) if self.settings.feed_per_rev_fine => 1e3,
                (FeedMode::PerRevolution, false) => 1e2,
                (FeedMode::PerRevolution, true) => 1e4,
            },
            _ if modal.is_inch => (25_400_000 / self.settings.inch_increment.nm()) as f64,
            _ => (1_000_000 / self.settings.metric_increment.nm()) as f64,
        }
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
        // A quotient of whole numbers is the nearest float; a product of floats need not be.
        Ok(number.digits as f64 / self.increments_per_unit(word.address))
    }
}

/// A number as it stands there.
fn as_written(number: Decimal) -> f64 {
    number.digits as f64 / 10f64.powi(i32::from(number.scale))
}
