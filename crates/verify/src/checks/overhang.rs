//! **Long slender work without a centre.** The stock stands out of the jaws by more than four times its diameter, and
//! the setup has no tailstock.
//!
//! Why it hurts: the work bends and whips; at speed it climbs out of the chuck.
//!
//! How to mend it: support it with a centre (`[tailstock]`), or grip it shorter.

use turnwright_diagnostics::Argument;

use super::{Check, Report, Scene};

/// Diameters that may stand out.
const OVERHANG_MAX: f64 = 4.0;

pub(super) struct Overhang;

impl Check for Overhang {
    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let (Some(stock), None) = (scene.stock, &scene.setup.tailstock) else { return };
        let Ok(Some(chuck)) = scene.setup.chuck_outlines() else { return };
        let length = stock.max.z - chuck.jaw.bounds().max.z;
        let times = length / (2.0 * stock.max.x);
        if times > OVERHANG_MAX {
            let arguments = vec![("value", Argument::from(format!("{times:.1}")))];
            report.warn_program("work-overhangs", arguments);
        }
    }
}
