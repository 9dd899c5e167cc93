//! Functions that only change a mode: units (G20, G21), work coordinates (G54 to
//! G59, and G54.1 with the number P), speed mode (G96, G97), feed mode (G98, G99), absolute and incremental (systems B and C).
//!
//! Each acts before anything else in its block. A change of feed mode does not convert the F in force; a change
//! back to constant spindle speed without S keeps the speed that the spindle has at that diameter.
//!
//! Source: modal groups, constant surface speed and feed modes of both families.

use turnwright_control::policy::FeedPerRevolution;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::{FeedMode, SpeedMode};
use crate::report::Alarm;
use crate::zeros::STANDARD_SYSTEMS;

pub(super) static INCH: Function = Function::mode("inch", |core, call| units(core, call, true));
pub(super) static METRIC: Function = Function::mode("metric", |core, call| units(core, call, false));

pub(super) static WORK_COORDINATES_1: Function =
    Function::mode("work-coordinates-1", |core, _| work(core, 0));
pub(super) static WORK_COORDINATES_2: Function =
    Function::mode("work-coordinates-2", |core, _| work(core, 1));
pub(super) static WORK_COORDINATES_3: Function =
    Function::mode("work-coordinates-3", |core, _| work(core, 2));
pub(super) static WORK_COORDINATES_4: Function =
    Function::mode("work-coordinates-4", |core, _| work(core, 3));
pub(super) static WORK_COORDINATES_5: Function =
    Function::mode("work-coordinates-5", |core, _| work(core, 4));
pub(super) static WORK_COORDINATES_6: Function =
    Function::mode("work-coordinates-6", |core, _| work(core, 5));
pub(super) static WORK_COORDINATES_ADDITIONAL: Function =
    Function::mode("work-coordinates-additional", additional_work).with_letters(b"P");

pub(super) static CONSTANT_SURFACE_SPEED: Function = Function::mode("constant-surface-speed", surface_speed)
    .with_letters(b"P")
    .allowed_in_figure()
    .allowed_in_rotation();
pub(super) static CONSTANT_SPINDLE_SPEED: Function =
    Function::mode("constant-spindle-speed", spindle_speed).allowed_in_figure().allowed_in_rotation();

pub(super) static FEED_PER_MINUTE: Function =
    Function::mode("feed-per-minute", |core, _| feed_mode(core, FeedMode::PerMinute))
        .allowed_in_figure()
        .allowed_in_rotation();
pub(super) static FEED_PER_REVOLUTION: Function =
    Function::mode("feed-per-revolution", feed_per_revolution).allowed_in_figure().allowed_in_rotation();

pub(super) static ABSOLUTE: Function = Function::mode("absolute", |core, _| increments(core, false));
pub(super) static INCREMENTAL: Function = Function::mode("incremental", |core, _| increments(core, true));

fn units(core: &mut Core, call: &mut Call<'_>, is_inch: bool) -> Result<(), Alarm> {
    if core.modal.is_inch == is_inch {
        return Ok(());
    }
    // Another code in the block may end the cycle.
    let is_alone = call.block.words.iter().filter(|word| word.address == b'G').count() == 1;
    let is_in_cycle = core.modal.motion.get().repeats || core.is_in_hole_cycle();
    if core.is_compensating() || (is_in_cycle && is_alone) {
        return Err(core.alarm_at("unit-change-illegal", call.word));
    }
    let has_moved = core.machine_position() != core.zeros.reference[0];
    if (has_moved || call.block.present() & super::AXES != 0)
        && let Some(word) = call.word
    {
        core.warn("unit-change-late", word);
    }
    let from = core.offset_increment();
    core.modal.is_inch = is_inch;
    let to = core.offset_increment();
    if from != to && !core.settings.offsets.converts_units && core.has_offset_values() {
        core.warn_once("offsets-read-in-other-unit");
        core.reread_offsets(from, to);
    }
    Ok(())
}

fn work(core: &mut Core, system: usize) -> Result<(), Alarm> {
    core.suspend_compensation()?;
    core.with_new_zero(|core| core.modal.work = system);
    Ok(())
}

/// `G54.1 P_`; without P it is the first additional system.
fn additional_work(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let Some(word) = call.block.word(b'P') else {
        if let Some(word) = call.word {
            core.warn("work-system-missing", word);
        }
        return work(core, STANDARD_SYSTEMS);
    };
    match core.whole(word, 99_999_999)? as usize {
        number if (1..=core.zeros.additional_systems()).contains(&number) => {
            work(core, STANDARD_SYSTEMS + number - 1)
        }
        _ => Err(core.alarm("work-system-illegal", word)),
    }
}

fn feed_per_revolution(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    match core.control.policies.feed_per_revolution {
        FeedPerRevolution::Available => feed_mode(core, FeedMode::PerRevolution),
        FeedPerRevolution::Alarm => Err(core.alarm_at("feed-per-revolution-unavailable", call.word)),
    }
}

fn feed_mode(core: &mut Core, mode: FeedMode) -> Result<(), Alarm> {
    core.modal.feed_mode = mode;
    Ok(())
}

fn increments(core: &mut Core, are_incremental: bool) -> Result<(), Alarm> {
    core.modal.is_incremental = are_incremental;
    Ok(())
}

fn surface_speed(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if !core.settings.surface_speed_available {
        return Err(core.alarm_at("unusable-g-code", call.word));
    }
    let axis = match call.block.word(b'P') {
        Some(word) if !core.selects_spindle(word) => core.whole(word, 99)?,
        _ => 0,
    };
    let axis = if axis == 0 { core.settings.surface_speed_axis } else { axis };
    if axis > 1 {
        return Err(core.alarm_at("surface-speed-axis-illegal", call.block.word(b'P').or(call.word)));
    }
    if core.is_capturing() {
        return Ok(());
    }
    core.modal.speed_mode = SpeedMode::Surface;
    if core.modal.rpm_max.is_none()
        && let Some(word) = call.word
    {
        core.warn("surface-speed-without-limit", word);
    }
    Ok(())
}

fn spindle_speed(core: &mut Core, _: &mut Call<'_>) -> Result<(), Alarm> {
    if !core.is_capturing() {
        core.modal.rpm = core.present_rpm();
        core.modal.speed_mode = SpeedMode::Constant;
    }
    Ok(())
}
