//! **A stop in the middle of a cut.** M00 or M01 right behind a cutting move that ends in or on the stock.
//!
//! Why it hurts: the tool rubs a mark into the turning work; with the spindle stopped too, its edge breaks out when it
//! starts again; and an operator reaches in.
//!
//! How to mend it: retract before the stop.

use turnwright_canon::{Action, Command, Origin};
use turnwright_units::{Position, WorkTip};

use super::{Check, Report, Scene, State};

#[derive(Default)]
pub(super) struct StopInCut {
    is_cutting: bool,
    seen: Vec<(Position<WorkTip>, Origin)>,
}

impl Check for StopInCut {
    #[inline]
    fn on_move(&mut self, command: &Command, _: &State, _: &mut Report) {
        self.is_cutting = !matches!(command.action, Action::Rapid { .. });
    }

    fn on_other(&mut self, command: &Command, state: &State, _: &mut Report) {
        let stops = matches!(command.action, Action::Stop | Action::OptionalStop);
        if stops && self.is_cutting && self.seen.len() < 1_000 {
            self.seen.push((state.at, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        // A feed that just leaves the stock ends on its surface.
        for (_, origin) in self.seen.iter().filter(|(tip, _)| scene.is_near_stock(*tip, -1e-3)) {
            report.warn("stop-in-cut", origin, Vec::new());
        }
    }
}
