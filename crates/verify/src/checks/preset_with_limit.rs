//! **Speed limit and coordinates are set in one block.** The code that limits the speed by S also presets coordinates,
//! when X, Z, U or W stands beside it.
//!
//! Why it hurts: whoever meant a move, or only the limit, has shifted all coordinates that follow.
//!
//! How to mend it: two blocks. A preset that is meant so: allow `preset-with-speed-limit`.

use turnwright_canon::{Action, Command};

use super::{Check, Report, State};

#[derive(Default)]
pub(super) struct PresetWithLimit {
    /// Text and line of the last limit, preset and tool.
    limit: Option<(u32, u32)>,
    preset: Option<(u32, u32)>,
    tool: Option<(u32, u32)>,
}

impl Check for PresetWithLimit {
    fn on_other(&mut self, command: &Command, state: &State, report: &mut Report) {
        let line = Some((command.origin.source, command.origin.line));
        match &command.action {
            Action::Spindle { rpm_max, .. } if *rpm_max != state.rpm_max && rpm_max.is_some() => {
                self.limit = line;
            }
            Action::Relocate { .. } => self.preset = line,
            // A new tool has its own offset.
            Action::Tool { .. } => self.tool = line,
            _ => return,
        }
        if self.limit == line && self.preset == line && self.tool != line {
            report.warn("preset-with-speed-limit", &command.origin, Vec::new());
        }
    }
}
