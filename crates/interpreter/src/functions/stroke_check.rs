//! `stroke-check-on`, `stroke-check-off` — the second stored stroke check (G22, G23).
//!
//! `G22 X_ Z_ I_ K_` switches the check on and sets its area: X and Z are the plus limits, I and K the minus limits,
//! all machine coordinates, X and I as diameters, on machines with Y also Y and J; a limit left out stays as it is. They overwrite the parameters
//! 1322 and 1323. `G23` switches the check off.
//!
//! The codes stand alone in their block: where the control insists, another word is an alarm; elsewhere it is a
//! warning when limits are given. An area whose plus limit is not beyond its minus limit forbids nothing as an inside and everything
//! as an outside; a warning says so.
//!
//! Source: stored stroke check of both families.

use turnwright_control::policy::StrokeCheckBlock;
use turnwright_syntax::{Block, Word};
use turnwright_units::Position;

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static STROKE_CHECK_ON: Function =
    Function::one_shot("stroke-check-on", switch_on).with_letters(b"IK").with_other_axes();
pub(super) static STROKE_CHECK_OFF: Function = Function::mode("stroke-check-off", switch_off);

fn switch_on(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    let has_y = core.axes.machine.y.is_some();
    let foreign: &[u8] = if has_y { b"UWCHVB" } else { b"UWCHVBYJ" };
    if let Some(word) = foreign.iter().find_map(|letter| block.word(*letter)) {
        return Err(core.alarm("illegal-address", word));
    }
    core.refuse_company(call, letters(b"GNOXZIKYJ"))?;
    let mut area = core.strokes.second;
    let place = |core: &mut Core, x: u8, z: u8, corner: &mut Position<_>| -> Result<(), Alarm> {
        if let Some(word) = block.word(x) {
            corner.x = core.radius(word, Role::XCoordinate)?;
            core.missing_point(word);
        }
        if let Some(word) = block.word(z) {
            corner.z = core.length(word)?;
            core.missing_point(word);
        }
        Ok(())
    };
    place(core, b'X', b'Z', &mut area.plus)?;
    place(core, b'I', b'K', &mut area.minus)?;
    for (letter, corner) in [(b'Y', &mut area.others_plus), (b'J', &mut area.others_minus)] {
        if let Some(word) = block.word(letter) {
            corner.y = core.length(word)?;
            core.missing_point(word);
        }
    }
    let names_limits = block.present() & letters(b"XZIKYJ") != 0;
    let is_empty_across = has_y && area.others_plus.y <= area.others_minus.y;
    if names_limits && (area.plus.x <= area.minus.x || area.plus.z <= area.minus.z || is_empty_across) {
        core.warn_block("stroke-area-empty");
    }
    core.strokes.second = area;
    core.modal.stroke_two_is_on = true;
    core.look_at_moves();
    Ok(())
}

fn switch_off(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_company(call, letters(b"GNO"))?;
    core.modal.stroke_two_is_on = false;
    core.look_at_moves();
    Ok(())
}

impl Core {
    /// Other words in the block of a stroke check, and a check that a parameter has switched off.
    fn refuse_company(&mut self, call: &Call<'_>, own: u32) -> Result<(), Alarm> {
        let codes = |word: &&Word| word.address == b'G';
        let stranger = call.block.words.iter().find(|word| own & Block::bit(word.address) == 0);
        let stranger = stranger.or_else(|| {
            let mut others = call
                .block
                .words
                .iter()
                .filter(codes)
                .filter(|word| call.word.is_none_or(|own| own.start != word.start));
            others.next()
        });
        let insists = self.control.policies.stroke_check_block == StrokeCheckBlock::Alone;
        match stranger {
            Some(word) if insists => Err(self.alarm("stroke-check-not-alone", word)),
            _ if insists && self.strokes.is_off => Err(self.alarm_at("stroke-check-not-alone", call.word)),
            Some(word) if call.block.present() & letters(b"XZIKYJ") != 0 => {
                self.warn("stroke-check-with-others", word);
                Ok(())
            }
            // Switched on or off in a safety line.
            _ => Ok(()),
        }
    }
}
