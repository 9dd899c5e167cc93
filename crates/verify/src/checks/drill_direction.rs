//! **A drill turns backwards.** A tool that drills on the spindle axis feeds into the work while the spindle turns
//! counter-clockwise (M04).
//!
//! Why it hurts: drills are right-handed; the wrong way round the lips do not cut, and the drill burns or breaks.
//!
//! How to mend it: start the spindle with M03 before drilling. A left-handed drill: `hand = "left"` in its `[tools.N]`.

use turnwright_canon::{Action, Command, Origin, SpindleState};
use turnwright_control::{Hand, ToolKind};
use turnwright_diagnostics::Argument;

use super::{Check, Report, Scene, State};

/// The first move of each tool into the work on the axis while the spindle turned that way.
#[derive(Default)]
pub(super) struct DrillDirection {
    seen: Vec<(u32, Origin)>,
}

impl Check for DrillDirection {
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        if state.spindle != SpindleState::CounterClockwise {
            return;
        }
        if let Action::Feed { to, .. } = &command.action
            && to.x.0.is_zero()
            && state.at.x.0.is_zero()
            && to.z < state.at.z
        {
            let station = state.station.unwrap_or(1);
            if !self.seen.iter().any(|(known, _)| *known == station) {
                self.seen.push((station, command.origin));
            }
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (station, origin) in &self.seen {
            let is_drill = scene
                .tools
                .get(station)
                .is_some_and(|tool| tool.kind == ToolKind::Drilling && tool.hand != Hand::Left);
            if is_drill {
                report.warn("drill-turns-backwards", origin, vec![("tool", Argument::from(*station))]);
            }
        }
    }
}
