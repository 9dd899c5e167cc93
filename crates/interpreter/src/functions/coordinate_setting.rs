//! `coordinate-setting` — coordinate preset and highest spindle speed (G50; G92 in systems B and C).
//!
//! `G50 X_ Z_` gives the place where the tool stands these coordinates, in all work systems; `U` and `W` add to
//! the present ones. `G50 S_` limits the spindle under constant surface speed. Both may stand in one block.
//! Nothing moves.
//!
//! Source: coordinate system setting and maximum spindle speed of both families.

use turnwright_units::{Displacement, Rpm};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static COORDINATE_SETTING: Function = Function::one_shot("coordinate-setting", coordinate_setting)
    .with_speed_limit()
    .with_other_axes()
    .setting_data();

fn coordinate_setting(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if let Some(word) = call.block.word(b'S') {
        core.modal.rpm_max = Some(Rpm(core.speed_value(word)?));
        core.emit_spindle();
    }
    if call.block.present() & super::AXES != 0 {
        let there = core.target(call.block)?;
        let here = core.modal.position;
        core.with_new_zero(|core| {
            let preset = core.zeros.preset;
            core.zeros.preset = Displacement::new(preset.x + here.x - there.x, preset.z + here.z - there.z);
        });
    }
    core.preset_other_axes(call.block)
}
