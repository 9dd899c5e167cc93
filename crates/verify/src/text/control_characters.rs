//! **Control characters.** Bytes that are no text stand in the program. The mark of old systems for the end of a file
//! (Ctrl-Z) and the empty tape (NUL) are not meant.
//!
//! Why it hurts: they come from a disturbed transfer, and what came beside them may be damaged too.
//!
//! How to mend it: compare the place with the original, and send or save the program again.

use super::{Line, Report};

/// Codes of a computer that a text may have: the empty tape, the tabulator, the end of a file.
const HARMLESS: [u8; 3] = [0, b'\t', 0x1A];

#[derive(Debug, Default)]
pub(super) struct ControlCharacters {
    is_told: bool,
}

impl ControlCharacters {
    pub(super) fn add(&mut self, line: &Line<'_>, report: &mut Report) {
        let is_meant = |byte: &u8| byte.is_ascii_control() && !HARMLESS.contains(byte) && *byte != b'\r';
        if !self.is_told && line.bytes.iter().any(is_meant) {
            self.is_told = true;
            report.note("control-characters", line);
        }
    }
}
