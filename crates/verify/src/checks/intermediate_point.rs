//! **The way to the reference point leads into the work.** X and Z of G28 are a point on the way; this one lies within
//! the stock, and the tool goes towards it before it goes away.
//!
//! Why it hurts: the point is taken for the goal, so nobody thinks that the tool will go there, at rapid.
//!
//! How to mend it: retract first, and G28 U0 W0 from there; or a point on the way that is clear of the work.

use turnwright_canon::{Action, Command, Origin};
use turnwright_units::{Position, WorkTip};

use super::{Check, Report, Scene, State};

/// The reference point is further from the work than this, mm.
const AWAY_MM: f64 = 10.0;

#[derive(Default)]
pub(super) struct IntermediatePoint {
    /// The rapid move before, which came from here.
    last: Option<(Position<WorkTip>, Origin)>,
    /// The point on the way, and the goal.
    seen: Vec<(Position<WorkTip>, Position<WorkTip>, Origin)>,
}

impl Check for IntermediatePoint {
    #[inline]
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        let Action::Rapid { to, .. } = &command.action else {
            self.last = None;
            return;
        };
        let (via, origin) = (state.at, command.origin);
        if let Some((from, last)) = self.last.replace((via, origin))
            && (last.source, last.line, last.cycle) == (origin.source, origin.line, None)
            && (via.x < from.x || via.z < from.z)
            && self.seen.len() < 1_000
        {
            self.seen.push((via, *to, origin));
        }
    }

    fn on_other(&mut self, _: &Command, _: &State, _: &mut Report) {
        self.last = None;
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (via, goal, origin) in &self.seen {
            if scene.is_near_stock(*via, -1e-3) && !scene.is_near_stock(*goal, AWAY_MM) {
                report.warn("intermediate-point-near-work", origin, Vec::new());
            }
        }
    }
}
