//! **Two programs with one number.** O1000 stands twice in the text.
//!
//! Why it hurts: a call runs the first of them; which of them a control keeps when the text is read in is another
//! question.
//!
//! How to mend it: give the second one another number, or delete the one that is old.

use std::collections::BTreeSet;

use turnwright_diagnostics::Argument;

use super::{Line, Report, program_number};

/// Programs of one text that are kept in mind.
const PROGRAMS_MAX: usize = 10_000;

#[derive(Debug, Default)]
pub(super) struct DuplicateProgram {
    seen: BTreeSet<u64>,
    told: usize,
}

impl DuplicateProgram {
    pub(super) fn add(&mut self, line: &Line<'_>, report: &mut Report) {
        let Some(number) = program_number(line.code) else { return };
        if self.seen.contains(&number) {
            self.told += 1;
            if self.told <= crate::checks::FINDINGS_MAX {
                let name = format!("O{number:04}");
                report.warn("duplicate-program", line, vec![("program", Argument::from(name))]);
            }
        } else if self.seen.len() < PROGRAMS_MAX {
            self.seen.insert(number);
        }
    }
}
