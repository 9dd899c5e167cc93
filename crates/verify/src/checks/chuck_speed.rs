//! **The spindle turns faster than the chuck may.** S under G97, or the limit of G96, is above `rpm_max` of `[chuck]` in
//! the setup file; under G96 without a limit the speed rises towards the axis as far as the machine goes.
//!
//! Why it hurts: the jaws lose their grip by centrifugal force, and the work leaves the chuck.
//!
//! How to mend it: lower S, or set the limit (G50 S) to what the chuck may turn.

use turnwright_canon::{Action, Command, Origin, SpindleSpeed, SpindleState};
use turnwright_diagnostics::Argument;

use super::{Check, Report, Scene, State};

/// The fastest that each line asks for; no limit is more than any.
#[derive(Default)]
pub(super) struct ChuckSpeed {
    asked: Vec<(u32, Origin)>,
}

impl Check for ChuckSpeed {
    fn on_other(&mut self, command: &Command, _: &State, _: &mut Report) {
        let Action::Spindle { state, speed, rpm_max } = &command.action else { return };
        if *state == SpindleState::Stop || self.asked.len() > 1_000 {
            return;
        }
        let limit = rpm_max.map_or(u32::MAX, |rpm| rpm.0);
        let rpm = match speed {
            SpindleSpeed::Constant(rpm) => rpm.0.min(limit),
            SpindleSpeed::Surface(_) => limit,
        };
        // A new limit above the speed in force asks for nothing new.
        if self.asked.last().is_none_or(|(last, _)| *last != rpm) {
            self.asked.push((rpm, command.origin));
        }
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let Some(rpm_max) = scene.setup.chuck.as_ref().and_then(|chuck| chuck.rpm_max) else { return };
        for (rpm, origin) in self.asked.iter().filter(|(rpm, _)| *rpm > rpm_max) {
            let asked = if *rpm == u32::MAX { "∞".to_string() } else { rpm.to_string() };
            let arguments = vec![("value", Argument::from(asked)), ("limit", Argument::from(rpm_max))];
            report.warn("chuck-too-fast", origin, arguments);
        }
    }
}
