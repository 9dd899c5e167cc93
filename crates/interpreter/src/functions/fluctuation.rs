//! `spindle-fluctuation-on`, `spindle-fluctuation-off` — watching the speed of the spindle (G26, G25).
//!
//! `G26 P_ Q_ R_ I_`: an alarm comes on the machine when the speed strays. P is the delay after a new S in
//! milliseconds, Q the percentage at which the speed counts as reached, R the permitted change in percent, I
//! the smallest band in rpm that can be an alarm. A word left out keeps its value; they overwrite the parameters
//! 4911 to 4914. `G25` ends it.
//!
//! The codes move nothing and are checked for their words here. The alarm itself (OH704) needs the measured speed
//! of a live spindle, which a program run does not have.
//!
//! Source: spindle speed fluctuation detection of both families.

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static SPINDLE_FLUCTUATION_ON: Function =
    Function::mode("spindle-fluctuation-on", watch).with_letters(b"PQRI");
pub(super) static SPINDLE_FLUCTUATION_OFF: Function =
    Function::mode("spindle-fluctuation-off", |_, _| Ok(()));

/// The letters of the words and their largest values: milliseconds, percent, percent, rpm.
const WORDS: [(u8, u32); 4] = [(b'P', 99_999), (b'Q', 100), (b'R', 100), (b'I', 99_999)];

fn watch(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    for (letter, max) in WORDS {
        let Some(word) = call.block.word(letter) else { continue };
        if core.whole(word, 99_999_999)? > max {
            return Err(core.alarm("data-out-of-range", word));
        }
    }
    Ok(())
}
