//! **The spindle turns the wrong way for the tool.** A tool cuts while the spindle turns against its insert: `post` and
//! `insert_faces` of `[tools.N]` in the setup say how it stands, or the hand of its holder does (a right-hand holder that
//! feeds to the chuck needs M03, on either post).
//!
//! Why it hurts: the work runs onto the back of the insert and breaks it, and a chuck that is screwed on comes loose.
//!
//! How to mend it: start the spindle the other way (M03 or M04), or mount the tool the other way round.
//!
//! Drills are [`super::drill_direction`]'s. Without post, facing or holder in the setup nothing is told.

use turnwright_canon::{Action, Command, Origin, SpindleState};
use turnwright_control::{CuttingTurn, ToolKind};
use turnwright_diagnostics::Argument;

use super::{Check, Report, Scene, State};

/// The first cut of each tool with each way of the spindle.
#[derive(Default)]
pub(super) struct SpindleTurn {
    seen: Vec<(u32, SpindleState, Origin)>,
    last: Option<(u32, SpindleState)>,
}

impl Check for SpindleTurn {
    #[inline]
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        let now = (state.station.unwrap_or(1), state.spindle);
        if self.last == Some(now) || matches!(command.action, Action::Rapid { .. }) {
            return;
        }
        self.last = Some(now);
        if !self.seen.iter().any(|(station, spindle, _)| (*station, *spindle) == now) {
            self.seen.push((now.0, now.1, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (station, spindle, origin) in &self.seen {
            let Some(tool) = scene.tools.get(station) else { continue };
            let (wrong, right) = match tool.turn {
                Some(CuttingTurn::Clockwise) => (SpindleState::CounterClockwise, "M03"),
                Some(CuttingTurn::CounterClockwise) => (SpindleState::Clockwise, "M04"),
                None => continue,
            };
            let is_on_axis = matches!(tool.kind, ToolKind::Drilling | ToolKind::Tapping);
            if *spindle == wrong && !is_on_axis {
                let arguments = vec![("tool", Argument::from(*station)), ("value", Argument::from(right))];
                report.warn("spindle-wrong-for-tool", origin, arguments);
            }
        }
    }
}
