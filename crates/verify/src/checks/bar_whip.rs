//! **The bar whips behind the spindle.** A speed comes within a quarter of the one at which the bar behind the spindle (`[bar]`
//! of the setup) bends by itself: its first bending frequency after Euler and Bernoulli, clamped at the spindle.
//!
//! Why it hurts: the bar bends, breaks out of the spindle and strikes whoever stands there.
//!
//! How to mend it: turn slower, cut the bar shorter, or guide its end (a bush, a bar feeder).

use turnwright_canon::Command;
use turnwright_diagnostics::Argument;

use super::turning_speeds::TurningSpeeds;
use super::{Check, Report, Scene, State};

/// Share of the critical speed that a bar may turn at: the model knows neither a bent bar nor play in the spindle.
const CRITICAL_PART: f64 = 0.75;

#[derive(Default)]
pub(super) struct BarWhip(TurningSpeeds);

impl Check for BarWhip {
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        self.0.on_move(command, state);
    }

    fn on_other(&mut self, command: &Command, _: &State, _: &mut Report) {
        self.0.on_other(command);
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let Ok(Some(critical)) = scene.setup.bar_critical_rpm() else { return };
        let limit = (CRITICAL_PART * critical).floor();
        for (rpm, origin) in self.0.above(limit) {
            let arguments = vec![
                ("value", Argument::from(format!("{rpm:.0}"))),
                ("critical", Argument::from(format!("{critical:.0}"))),
                ("limit", Argument::from(format!("{limit:.0}"))),
            ];
            report.warn("bar-whips", origin, arguments);
        }
    }
}
