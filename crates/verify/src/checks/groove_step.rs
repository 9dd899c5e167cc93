//! **Steps wider than the blade.** A grooving cycle goes on to its next column by more than the width of the tool, and by less than
//! two of them: what is as wide as the blade is a land between two grooves.
//!
//! Why it hurts: ribs remain between the plunges.
//!
//! How to mend it: make the step (P or Q of the cycle) a little smaller than the width of the blade.

use turnwright_canon::{Action, Command, Origin, Phase};
use turnwright_control::ToolKind;
use turnwright_diagnostics::Argument;

use super::{Check, Report, Scene, State};

/// Tool, width of the step, place.
#[derive(Default)]
pub(super) struct GrooveStep {
    steps: Vec<(u32, f64, Origin)>,
}

impl Check for GrooveStep {
    #[inline]
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        if !matches!(command.origin.cycle, Some(cycle) if cycle.phase == Phase::Shift) {
            return;
        }
        let Action::Rapid { to, .. } = &command.action else { return };
        let step = (to.z - state.at.z).to_mm().abs().max((to.x - state.at.x).to_mm().abs());
        let station = state.station.unwrap_or(1);
        let origin = &command.origin;
        let is_same = |known: &&mut (u32, f64, Origin)| {
            (known.0, known.2.source, known.2.line) == (station, origin.source, origin.line)
        };
        if let Some((_, widest, _)) = self.steps.iter_mut().find(is_same) {
            *widest = widest.max(step);
        } else if self.steps.len() < 1_000 {
            self.steps.push((station, step, *origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        for (station, step, origin) in &self.steps {
            let Some(tool) = scene.tools.get(station) else { continue };
            let is_blade = matches!(tool.kind, ToolKind::Grooving | ToolKind::CutOff);
            let is_rib = |width: f64| *step > width + 1e-6 && *step < 2.0 * width;
            if is_blade && tool.width_mm.is_some_and(is_rib) {
                report.warn("groove-step-wider-than-tool", origin, vec![("tool", Argument::from(*station))]);
            }
        }
    }
}
