//! **A pass of a cycle leads away from the work.** It begins and ends in front of the stock, its end more than 5 mm off.
//!
//! Why it hurts: a single cycle stays in force until another motion code. A bare `X200. Z150.` behind it is not a
//! retreat but one more pass, at feed or in step with the spindle, and then rapid back to where it began.
//!
//! How to mend it: G00 in front of the position.

use turnwright_canon::{Action, Command, Origin, Phase};
use turnwright_units::Length;

use super::{Check, Report, Scene, State};

/// Further in front of the stock no pass ends, mm.
const OFF_MM: f64 = 5.0;

/// Where passes that go away from the chuck begin and end along Z.
#[derive(Default)]
pub(super) struct CycleLeadsAway {
    seen: Vec<(Length, Length, Origin)>,
}

impl Check for CycleLeadsAway {
    #[inline]
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        let (Action::Feed { to, .. } | Action::Thread { to, .. }) = &command.action else { return };
        let is_pass =
            command.origin.cycle.is_some_and(|cycle| matches!(cycle.phase, Phase::Cut | Phase::Thread));
        if is_pass && to.z > state.at.z && self.seen.len() < 1_000 {
            self.seen.push((state.at.z, to.z, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let Some(stock) = scene.stock else { return };
        for (start, end, origin) in &self.seen {
            if start.to_mm() > stock.max.z && end.to_mm() > stock.max.z + OFF_MM {
                report.warn("cycle-leads-away", origin, Vec::new());
            }
        }
    }
}
