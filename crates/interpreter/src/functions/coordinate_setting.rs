//! `coordinate-setting`, `coordinate-preset`, `local-coordinates` — shifts of the work coordinates (G50, G50.3 and
//! G52; G92, G92.1 and G52 in systems B and C).
//!
//! `G50 X_ Z_` gives the place where the tool stands these coordinates, in all work systems; `U` and `W` add to
//! the present ones. It ends the local shift of the axis. By parameter (1202#2) it is an alarm. `G50 S_` limits
//! the spindle under constant surface speed. Both may stand in one block.
//!
//! `G52 X_ Z_` sets a local zero inside every work system; `X0 Z0` takes it back. What U and W do differs: see the
//! policy for local increments. `G50.3 X0 Z0` takes back what G50 and G52 did to the named axes.
//!
//! Nothing moves.
//!
//! Source: coordinate system setting, preset and local coordinate system, both families.

use turnwright_control::policy::LocalIncrements;
use turnwright_units::{Displacement, Length, MachineTurret, Radius, Rpm};

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static COORDINATE_SETTING: Function = Function::one_shot("coordinate-setting", coordinate_setting)
    .with_speed_limit()
    .with_other_axes()
    .setting_data();
pub(super) static COORDINATE_PRESET: Function =
    Function::one_shot("coordinate-preset", coordinate_preset).with_other_axes();
pub(super) static LOCAL_COORDINATES: Function =
    Function::one_shot("local-coordinates", local_coordinates).with_other_axes();

const CROSS: u32 = letters(b"XU");
const ALONG: u32 = letters(b"ZW");

fn coordinate_setting(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if let Some(word) = call.block.word(b'S') {
        core.modal.rpm_max = Some(Rpm(core.speed_value(word)?));
        core.emit_spindle();
    }
    let present = call.block.present();
    if present & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    if core.settings.coordinate_setting_alarm {
        return Err(core.alarm_at("unusable-g-code", call.word));
    }
    let there = core.target(call.block)?;
    core.suspend_compensation()?;
    let here = core.modal.position;
    core.with_new_zero(|core| {
        let zeros = &mut core.zeros;
        // The local shift of the axis ends inside the preset: the coordinates come out as they were written.
        let local = clear(&mut zeros.local, present);
        zeros.preset = Displacement::new(
            zeros.preset.x + local.x + here.x - there.x,
            zeros.preset.z + local.z + here.z - there.z,
        );
    });
    core.preset_other_axes(call.block)
}

/// Takes a shift back on the axes that a block names; gives what it was there.
fn clear(shift: &mut Displacement<MachineTurret>, present: u32) -> Displacement<MachineTurret> {
    let mut was = Displacement::new(Radius::ZERO, Length::ZERO);
    if present & CROSS != 0 {
        std::mem::swap(&mut shift.x, &mut was.x);
    }
    if present & ALONG != 0 {
        std::mem::swap(&mut shift.z, &mut was.z);
    }
    was
}

fn coordinate_preset(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    for word in [b'X', b'Z', b'U', b'W'].into_iter().filter_map(|letter| block.word(letter)) {
        // The value is always nothing: another one is no form of the code.
        if !core.length(word)?.is_zero() {
            return Err(core.alarm("data-out-of-range", word));
        }
    }
    for axis in core.other_values(block)? {
        if !axis.value.is_zero() {
            return Err(core.alarm("data-out-of-range", axis.word));
        }
    }
    core.suspend_compensation()?;
    let others = core.others_named(block).collect::<Vec<_>>();
    core.with_new_zero(|core| {
        clear(&mut core.zeros.preset, block.present());
        clear(&mut core.zeros.local, block.present());
        core.zeros.others.preset.clear(others.iter().copied());
        core.zeros.others.local.clear(others.iter().copied());
    });
    Ok(())
}

fn local_coordinates(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    let mut local = core.zeros.local;
    let adds = core.control.policies.local_increments == LocalIncrements::Add;
    if block.present() & CROSS != 0 {
        let (word, is_increment) = core.axis_word(block, b'X', b'U')?;
        let value = core.radius(word, if is_increment { Role::XIncrement } else { Role::XCoordinate })?;
        local.x = if is_increment && adds { local.x + value } else { value };
        core.missing_point(word);
    }
    if block.present() & ALONG != 0 {
        let (word, is_increment) = core.axis_word(block, b'Z', b'W')?;
        let value = core.length(word)?;
        local.z = if is_increment && adds { local.z + value } else { value };
        core.missing_point(word);
    }
    let mut others = core.zeros.others.local;
    for axis in core.other_values(block)? {
        let before = if axis.is_increment && adds { others.value(axis.axis) } else { Length::ZERO };
        others.put(axis.axis, before + axis.value);
    }
    core.suspend_compensation()?;
    core.with_new_zero(|core| {
        core.zeros.local = local;
        core.zeros.others.local = others;
    });
    Ok(())
}
