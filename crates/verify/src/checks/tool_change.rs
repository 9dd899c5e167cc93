//! **The turret turns beside the work.** Another station is called while the tip is within 10 mm of the stock, or in it.
//!
//! Why it hurts: the tools beside the one at work are longer than one thinks, and the turret swings them through the
//! work or the chuck.
//!
//! How to mend it: retract to a safe place, such as G28 U0 W0 or G00 X150. Z150., before T.

use turnwright_canon::{Action, Command, Origin};
use turnwright_diagnostics::Argument;
use turnwright_units::{Position, WorkTip};

use super::{Check, Report, Scene, State};

/// Nearer than this the turret does not turn freely, mm.
const CLEAR_MM: f64 = 10.0;

#[derive(Default)]
pub(super) struct ToolChange {
    seen: Vec<(u32, Position<WorkTip>, Origin)>,
}

impl Check for ToolChange {
    fn on_other(&mut self, command: &Command, state: &State, _: &mut Report) {
        if let Action::Tool { tool, .. } = &command.action
            && state.station.is_some_and(|station| station != *tool)
            && state.has_cut
            && self.seen.len() < 1_000
        {
            self.seen.push((*tool, state.at, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (tool, _, origin) in self.seen.iter().filter(|(_, tip, _)| scene.is_near_stock(*tip, CLEAR_MM)) {
            report.warn("tool-change-near-work", origin, vec![("tool", Argument::from(*tool))]);
        }
    }
}
