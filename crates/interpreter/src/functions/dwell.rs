//! `dwell` — wait (G04).
//!
//! `G04 X_` or `U_` in seconds, `P_` in milliseconds without a point. Without a point X and U count
//! thousandths of a second, on controls with calculator input whole seconds. With feed per revolution and the
//! parameter set, all three count spindle revolutions instead. P counts before X, X before U. Without a word it
//! is an exact stop, which moves nothing.
//!
//! Source: dwell of both families.

use turnwright_canon::{Action, Dwell};
use turnwright_units::{Revolutions, Seconds};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

pub(super) static DWELL: Function = Function::one_shot("dwell", dwell)
    .with_letters(b"P")
    .allowed_in_figure()
    .keeping_single_cycle()
    .setting_data();

/// Longest dwell, in thousandths of a second.
const DWELL_MAX: u32 = 99_999_999;

fn dwell(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if let Some(word) = call.block.word(b'Z').or(call.block.word(b'W')) {
        return Err(core.alarm("illegal-address", word));
    }
    let thousandths = if let Some(word) = call.block.word(b'P') {
        i64::from(core.whole(word, DWELL_MAX)?)
    } else if let Some(word) = call.block.word(b'X').or(call.block.word(b'U')) {
        let number = core.number(word)?;
        if number.is_negative && number.digits != 0 {
            return Err(core.alarm("minus-not-allowed", word));
        }
        let places = if number.has_point || core.settings.is_calculator { 3 } else { 0 };
        match number.scaled(places) {
            Some((value, _)) if value <= i64::from(DWELL_MAX) => value,
            _ => return Err(core.alarm("number-too-long", word)),
        }
    } else {
        return Ok(());
    };
    let amount = thousandths as f64 / 1000.0;
    let turns = core.settings.dwell_in_revolutions && core.modal.feed_mode == FeedMode::PerRevolution;
    let dwell = if turns { Dwell::Turns(Revolutions(amount)) } else { Dwell::Time(Seconds(amount)) };
    core.emit(Action::Dwell(dwell));
    Ok(())
}
