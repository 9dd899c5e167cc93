//! **Lower-case letters.** A word outside of remarks is written with a small letter.
//!
//! Why it hurts: here they are read as capitals; older controls refuse the program when it is read in.
//!
//! How to mend it: write the program in capitals.

use super::{Line, Report};

#[derive(Debug, Default)]
pub(super) struct LowerCase {
    is_told: bool,
}

impl LowerCase {
    pub(super) fn add(&mut self, line: &Line<'_>, report: &mut Report) {
        // A name of a program is no word.
        let is_name = line.code.contains(&b'<');
        if !self.is_told && !is_name && line.code.iter().any(u8::is_ascii_lowercase) {
            self.is_told = true;
            report.note("lower-case-letters", line);
        }
    }
}
