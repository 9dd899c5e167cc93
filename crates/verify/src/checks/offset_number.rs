//! **Tool and offset have different numbers.** T0102: station 1 with the offset of station 2.
//!
//! Why it hurts: nearly always a slip of the finger; the tool cuts with the length of another one.
//!
//! How to mend it: write the same number twice. Shops that keep second offsets beyond the stations (T0111) allow
//! `tool-offset-differs`.

use turnwright_canon::{Action, Command};

use super::{Check, Report, State};

pub(super) struct OffsetNumber;

impl Check for OffsetNumber {
    fn on_other(&mut self, command: &Command, _: &State, report: &mut Report) {
        if let Action::Tool { tool, offset } = &command.action
            && *offset != 0
            && *tool != 0
            && tool != offset
        {
            report.warn("tool-offset-differs", &command.origin, Vec::new());
        }
    }
}
