//! `exact-stop`, `exact-stop-mode`, `tapping-mode`, `cutting-mode` — how moves meet (G09, G61, G63, G64).
//!
//! Normally the next cutting move begins before the tool has come to rest, which rounds corners a little. `G61` lets
//! every move come to rest in position until G64 or G63; `G09` does so for its own block. Neither changes the path,
//! so cycles keep their own rule and the commands only carry the mode for whoever plans the motion. Where a parameter
//! makes every move come to rest (007#5 of the 980 series), that holds from the start and G64 does nothing.
//!
//! Source: exact stop and cutting mode of both families.

use turnwright_canon::{Action, PathMode};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static EXACT_STOP: Function = Function::mode("exact-stop", |core, _| {
    core.stops_once = core.modal.path_mode != PathMode::ExactStop;
    if core.stops_once {
        core.emit(Action::PathMode(PathMode::ExactStop));
    }
    Ok(())
})
.allowed_in_figure();

pub(super) static EXACT_STOP_MODE: Function =
    Function::mode("exact-stop-mode", |core, _| path_mode(core, PathMode::ExactStop)).allowed_in_figure();
pub(super) static TAPPING_MODE: Function =
    Function::mode("tapping-mode", |core, _| path_mode(core, PathMode::Tapping)).allowed_in_figure();
pub(super) static CUTTING_MODE: Function = Function::mode("cutting-mode", cutting_mode).allowed_in_figure();

fn cutting_mode(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if core.settings.path_mode_at_power_on == PathMode::ExactStop {
        if let Some(word) = call.word {
            core.warn("exact-stop-by-parameter", word);
        }
        return Ok(());
    }
    path_mode(core, PathMode::Continuous)
}

fn path_mode(core: &mut Core, mode: PathMode) -> Result<(), Alarm> {
    if core.modal.path_mode != mode {
        core.modal.path_mode = mode;
        core.emit(Action::PathMode(mode));
    }
    Ok(())
}

impl Core {
    /// Behind a block with an exact stop of its own the mode is what it was.
    #[cold]
    pub(crate) fn end_exact_stop(&mut self) {
        self.stops_once = false;
        self.emit(Action::PathMode(self.modal.path_mode));
    }
}
