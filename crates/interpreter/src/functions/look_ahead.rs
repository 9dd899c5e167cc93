//! `look-ahead-control`, `advanced-preview` — reading further ahead (G05.1, G08).
//!
//! `G05.1 Q1` and `G08 P1` let the control read many blocks ahead, so that short moves run smoothly; 0 ends it. `R`
//! beside Q is a level from 1 to 10. The path stays the same, so nothing is commanded.
//!
//! Source: look-ahead functions of the FANUC family.

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static LOOK_AHEAD_CONTROL: Function =
    Function::one_shot("look-ahead-control", |core, call| switch(core, call, b'Q'))
        .with_letters(b"QR")
        .keeping_single_cycle();
pub(super) static ADVANCED_PREVIEW: Function =
    Function::one_shot("advanced-preview", |core, call| switch(core, call, b'P'))
        .with_letters(b"P")
        .keeping_single_cycle();

/// The highest level of smoothness.
const LEVEL_MAX: u32 = 10;

fn switch(core: &mut Core, call: &mut Call<'_>, letter: u8) -> Result<(), Alarm> {
    let Some(word) = call.block.word(letter) else {
        return Err(core.alarm_at("command-value-illegal", call.word));
    };
    if core.whole(word, 99)? > 1 {
        return Err(core.alarm("command-value-illegal", word));
    }
    if let Some(level) = call.block.word(b'R')
        && !(1..=LEVEL_MAX).contains(&core.whole(level, 99)?)
    {
        return Err(core.alarm("command-value-illegal", level));
    }
    let axis = call.block.words.iter().find(|word| matches!(word.address, b'X' | b'Z' | b'U' | b'W'));
    axis.map_or(Ok(()), |word| Err(core.alarm("illegal-address", word)))
}
