//! **The offset is cancelled beside the work.** T with offset 00 for the same tool while the tip is within 2 mm of the
//! stock.
//!
//! Why it hurts: where offsets act as movements the axes go by the whole offset at once, perhaps into the work; where
//! they shift the coordinates the next absolute move does.
//!
//! How to mend it: retract first, cancel then.

use turnwright_canon::{Action, Command, Origin};
use turnwright_units::{Position, WorkTip};

use super::{Check, Report, Scene, State};

/// Nearer than this is beside the work, mm.
const BESIDE_MM: f64 = 2.0;

#[derive(Default)]
pub(super) struct OffsetCancel {
    seen: Vec<(Position<WorkTip>, Origin)>,
}

impl Check for OffsetCancel {
    fn on_other(&mut self, command: &Command, state: &State, _: &mut Report) {
        if let Action::Tool { tool, offset: 0 } = &command.action
            && state.offset != 0
            && state.station == Some(*tool)
            && state.has_cut
            && self.seen.len() < 1_000
        {
            self.seen.push((state.at, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (_, origin) in self.seen.iter().filter(|(tip, _)| scene.is_near_stock(*tip, BESIDE_MM)) {
            report.warn("offset-cancelled-near-work", origin, Vec::new());
        }
    }
}
