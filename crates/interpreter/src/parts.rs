//! The part counter.
//!
//! Every program end counts a part, and so does one further M code if the parameter names it; by another
//! parameter only that code counts. The number of parts wanted is kept beside it for programs that ask.
//!
//! Source: part counter of both families.

use turnwright_control::Parameters;

use crate::machine::Interpreter;

/// Parts made and wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Made so far.
    pub made: u32,
    /// Wanted; 0 for any number.
    pub wanted: u32,
    /// A further M code that counts; 0 for none.
    code: u32,
    only_by_code: bool,
}

impl Parts {
    pub(crate) fn new(parameters: &Parameters) -> Self {
        let count = |name| parameters.value(name).clamp(0.0, f64::from(u32::MAX)) as u32;
        Self {
            made: count("parts-made"),
            wanted: count("parts-wanted"),
            code: count("part-counting-code"),
            only_by_code: parameters.bit("parts-counted-by-code-only"),
        }
    }

    /// A program has ended.
    pub(crate) fn count_end(&mut self) {
        if !self.only_by_code {
            self.made = self.made.saturating_add(1);
        }
    }

    /// An M code was given out.
    pub(crate) fn count_code(&mut self, code: u32) {
        if code != 0 && code == self.code {
            self.made = self.made.saturating_add(1);
        }
    }
}

impl Interpreter {
    /// Parts made and wanted.
    pub fn parts(&self) -> Parts {
        self.core.parts
    }
}
