//! **The grip is too weak at this speed.** Centrifugal force takes more than two thirds of the gripping force that `[chuck]`
//! of the setup names (`grip_force_kn`), by the rule of EN 1550: at the rated speed `rpm_max` it takes two thirds of the
//! greatest force (`grip_force_max_kn`), and it grows with the square of the speed.
//!
//! Why it hurts: the jaws let go of the work in the cut.
//!
//! How to mend it: turn slower, set the limit (G50 S) lower, or grip harder where the work allows it.
//!
//! The last third is the cut's. Whether it needs more is not judged: how much of its force the grip can hold against hangs on
//! the friction between jaws and work, which no setup knows.
//!
//! A speed above `rpm_max` is [`super::chuck_speed`]'s to tell. Jaws that grip in a bore are not judged: speed presses them
//! outwards.

use turnwright_canon::Command;
use turnwright_diagnostics::Argument;

use super::turning_speeds::TurningSpeeds;
use super::{Check, Report, Scene, State};

#[derive(Default)]
pub(super) struct GripForce(TurningSpeeds);

impl Check for GripForce {
    fn on_move(&mut self, command: &Command, state: &State, _: &mut Report) {
        self.0.on_move(command, state);
    }

    fn on_other(&mut self, command: &Command, _: &State, _: &mut Report) {
        self.0.on_other(command);
    }

    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let Some(chuck) = &scene.setup.chuck else { return };
        let (Ok(Some(law)), Some(rated)) = (chuck.grip_law(), chuck.rpm_max) else { return };
        let limit = law.rpm_max().floor();
        for (rpm, origin) in self.0.above(limit).filter(|(rpm, _)| *rpm <= f64::from(rated)) {
            let arguments = vec![
                ("value", Argument::from(format!("{rpm:.0}"))),
                ("force", Argument::from(format!("{:.1}", law.left_kn(rpm)))),
                ("limit", Argument::from(format!("{limit:.0}"))),
            ];
            report.warn("grip-too-weak", origin, arguments);
        }
    }
}
