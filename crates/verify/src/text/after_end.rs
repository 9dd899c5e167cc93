//! **Something stands behind the end.** Text behind the closing %, or a block right behind M30, M02 or M99 that has
//! neither N, to be jumped to, nor O, to be called.
//!
//! Why it hurts: it never runs. Often two programs were pasted together, or an M30 of a trial was left in the middle.
//!
//! How to mend it: delete what is left over, or take out the end that is in the way.

use super::{Line, Report};

#[derive(Debug, Default)]
pub(super) struct AfterEnd {
    has_code: bool,
    /// The closing % has been read.
    is_closed: bool,
    /// The block before ended the program in any case.
    is_ended: bool,
    text_is_told: bool,
    blocks_are_told: bool,
}

impl AfterEnd {
    /// Returns whether the line is read by a control.
    pub(super) fn add(&mut self, line: &Line<'_>, report: &mut Report) -> bool {
        let is_text = line.code.iter().any(|byte| !byte.is_ascii_control());
        if !is_text {
            return !self.is_closed;
        }
        let is_mark = line.code.first() == Some(&b'%') && line.code[1..].iter().all(u8::is_ascii_control);
        if self.is_closed {
            if !is_mark && !self.text_is_told {
                self.text_is_told = true;
                report.warn("text-after-end", line, Vec::new());
            }
            return false;
        }
        if is_mark {
            self.is_closed = self.has_code;
            return true;
        }
        self.has_code = true;
        let can_be_reached = matches!(line.code[0].to_ascii_uppercase(), b'N' | b'O' | b':' | b'<' | b'%');
        if self.is_ended && !can_be_reached && !self.blocks_are_told {
            self.blocks_are_told = true;
            report.warn("blocks-after-end", line, Vec::new());
        }
        self.is_ended = ends_program(line.code);
        true
    }
}

/// Whether a block ends its program whenever it runs. One that is skipped or asks a condition may not.
fn ends_program(code: &[u8]) -> bool {
    let may_not = |byte: &u8| matches!(byte, b'/' | b'[' | b'#' | b'=');
    let ends = |at: usize| {
        let digits = code[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        matches!(&code[at + 1..at + 1 + digits], b"30" | b"02" | b"2" | b"99")
    };
    !code.iter().any(may_not) && (0..code.len()).any(|at| matches!(code[at], b'M' | b'm') && ends(at))
}
