//! `linear` — a straight cut (G01).
//!
//! `G01 X(U)_ Z(W)_ F_` cuts in a straight line to the end point at feed F, measured along the path with X as a
//! radius. X and Z are absolute, U and W count from the present position; both may stand in one block. F stays
//! in force; without any F the control stops.
//!
//! A move along one axis may end in an automatic corner: `R±r` a tangent fillet, `C±c` (or `I`, `K`, `,C`, `,R`)
//! a 45-degree chamfer, if the next line runs along the other axis. See `corner.rs`.
//!
//! Source: linear interpolation of both families.

use turnwright_canon::{Action, Shape};
use turnwright_syntax::Block;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static LINEAR: Function =
    Function::motion("linear", linear).with_letters(CORNER_WORDS).allowed_in_figure();

/// Letters that may name a corner; `corner.rs` knows which do on the control.
const CORNER_WORDS: &[u8] = b"RCIKLD";

const CORNERS: u32 = super::letters(CORNER_WORDS);

fn linear(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let to = core.target(call.block)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    if core.corner.is_some() || call.block.present() & CORNERS != 0 || call.block.has_comma {
        core.refuse_strange_corner_letters(call.block)?;
        return core.linear_with_corner(call.block, to, feed);
    }
    core.modal.position = to;
    core.emit_move(to, Action::Feed { to, shape: Shape::Line, feed, others: None })
}

impl Core {
    /// Letters that name a corner on some controls, but not on this one.
    fn refuse_strange_corner_letters(&self, block: &Block) -> Result<(), Alarm> {
        use turnwright_control::policy::CornerWords;
        let strange: &[u8] = match self.control.policies.corner_words {
            CornerWords::LengthAndFillet => b"RCIK",
            CornerWords::ChamferAndRadius if self.settings.plain_corner_letters => b"LD",
            CornerWords::ChamferAndRadius => b"CLD",
        };
        match strange.iter().find_map(|letter| block.word(*letter)) {
            Some(word) => Err(self.alarm("corner-letter-illegal", word)),
            None => Ok(()),
        }
    }
}
