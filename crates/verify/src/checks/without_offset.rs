//! **Cutting without an offset.** A tool was called with offset 00 (T0100), or the offset was cancelled, and a cutting
//! move follows.
//!
//! Why it hurts: the tool cuts as if it had no length.
//!
//! How to mend it: call it with its offset, T0101. A program that calls no tool at all is not meant.

use turnwright_canon::{Action, Command};

use super::{Check, Report, State};

#[derive(Default)]
pub(super) struct WithoutOffset {
    /// The first cut was told of.
    is_told: bool,
}

impl Check for WithoutOffset {
    #[inline]
    fn on_move(&mut self, command: &Command, state: &State, report: &mut Report) {
        let cuts = !matches!(command.action, Action::Rapid { .. });
        if state.offset == 0 && cuts && !self.is_told && state.station.is_some_and(|station| station != 0) {
            self.is_told = true;
            report.warn("tool-without-offset", &command.origin, Vec::new());
        }
    }

    fn on_other(&mut self, command: &Command, _: &State, _: &mut Report) {
        self.is_told &= !matches!(command.action, Action::Tool { .. });
    }
}
