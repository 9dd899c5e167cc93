//! **The speed changes between the passes of a thread.** Two threads of one tool end at the same Z with the same lead,
//! and S is another one.
//!
//! Why it hurts: the lag of the axis goes with the speed, so the passes do not meet: the thread is cut crossed.
//!
//! How to mend it: one S for all passes.

use turnwright_canon::{Action, Command, SpindleSpeed};
use turnwright_units::{Length, Rpm};

use super::{Check, Report, State};

#[derive(Clone, Copy, PartialEq, Eq)]
struct Pass {
    station: Option<u32>,
    end_z: Length,
    lead: Length,
    rpm: Rpm,
}

#[derive(Default)]
pub(super) struct ThreadSpeed {
    last: Option<Pass>,
}

impl Check for ThreadSpeed {
    fn on_move(&mut self, command: &Command, state: &State, report: &mut Report) {
        // A run-out belongs to the thread before it.
        let Action::Thread { to, lead, is_chained: false, .. } = &command.action else { return };
        let Some(SpindleSpeed::Constant(rpm)) = state.speed else { return };
        let pass = Pass { station: state.station, end_z: to.z, lead: lead.0, rpm };
        if let Some(last) = self.last.replace(pass)
            && (last.station, last.end_z, last.lead) == (pass.station, pass.end_z, pass.lead)
            && last.rpm != pass.rpm
        {
            report.warn("thread-passes-differ", &command.origin, Vec::new());
        }
    }
}
