//! `reference-return` — to the reference point by way of an intermediate point (G28).
//!
//! `G28 X(U)_ Z(W)_`: the named axes move at rapid to the intermediate point, then on to the first reference
//! point; an axis that is not named stays. `G28 U0 W0` goes straight there. X and Z are the intermediate point,
//! not the reference point. Without an axis word nothing moves.
//!
//! Where the reference point lies is the machine's affair: the setup says it.
//!
//! Source: automatic return to the reference point, both families.

use turnwright_canon::{Action, RapidPath};
use turnwright_diagnostics::Diagnostic;
use turnwright_units::Position;

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static REFERENCE_RETURN: Function =
    Function::one_shot("reference-return", reference_return).with_other_axes();

fn reference_return(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let present = call.block.present();
    if present & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    let by_way_of = core.target(call.block)?;
    let home = core.to_work(core.zeros.reference[0]);
    let to = Position::new(
        if present & letters(b"XU") != 0 { home.x } else { by_way_of.x },
        if present & letters(b"ZW") != 0 { home.z } else { by_way_of.z },
    );
    if !core.already_said("home-is-assumed", 0) {
        let diagnostic = Diagnostic::new(turnwright_diagnostics::Severity::Note, "home-is-assumed");
        let place = core.block_place();
        core.say(diagnostic.at(place));
    }
    // Both legs are non-linear whatever the parameter for positioning says.
    let (others_by_way_of, others_home) = core.other_axes_home(call.block)?;
    for (place, others) in [(by_way_of, others_by_way_of), (to, others_home)] {
        core.modal.position = place;
        core.emit_move(place, Action::Rapid { to: place, path: RapidPath::EachAxis, others })?;
    }
    core.leave_out_movement(present & letters(b"XU") != 0, present & letters(b"ZW") != 0);
    Ok(())
}
