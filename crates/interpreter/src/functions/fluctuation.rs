//! `spindle-fluctuation-on`, `spindle-fluctuation-off` — watching the speed of the spindle (G26, G25).
//!
//! `G26 P_ Q_ R_ I_`: an alarm comes when the speed strays. P is the time behind a new S in milliseconds for which nobody
//! looks, unless the speed is reached before; Q the percentage at which it counts as reached, R the permitted change in
//! percent, I the smallest band in rpm that can be an alarm; Q and R in tenths of a percent with 4900#0. A word left out
//! keeps its value, at first that of the parameters 4911 to 4914. `G25` ends it.
//!
//! The codes move nothing: they are given out, and whoever knows the speed of the spindle judges it.
//!
//! Source: spindle speed fluctuation detection of both families.

use turnwright_canon::Action;
use turnwright_units::Rpm;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static SPINDLE_FLUCTUATION_ON: Function =
    Function::mode("spindle-fluctuation-on", watch).with_letters(b"PQRI");
pub(super) static SPINDLE_FLUCTUATION_OFF: Function = Function::mode("spindle-fluctuation-off", end_watch);

/// The largest delay, in milliseconds, and the largest band, in rpm.
const COUNT_MAX: u32 = 99_999;

fn watch(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let percent = if core.settings.watch_counts_tenths { 1 } else { 10 };
    let mut watch = core.modal.watch;
    for (letter, max) in
        [(b'P', COUNT_MAX), (b'Q', 1000 / percent), (b'R', 1000 / percent), (b'I', COUNT_MAX)]
    {
        let Some(word) = call.block.word(letter) else { continue };
        let value = core.whole(word, 99_999_999)?;
        if value > max {
            return Err(core.alarm("data-out-of-range", word));
        }
        match letter {
            b'P' => watch.delay_ms = value,
            b'Q' => watch.reached_permille = value * percent,
            b'R' => watch.allowed_permille = value * percent,
            _ => watch.band = Rpm(value),
        }
    }
    if !core.is_capturing() && (!core.modal.is_watched || watch != core.modal.watch) {
        (core.modal.watch, core.modal.is_watched) = (watch, true);
        core.emit(Action::SpindleWatch(Some(watch)));
    }
    Ok(())
}

fn end_watch(core: &mut Core, _: &mut Call<'_>) -> Result<(), Alarm> {
    if !core.is_capturing() && std::mem::take(&mut core.modal.is_watched) {
        core.emit(Action::SpindleWatch(None));
    }
    Ok(())
}
