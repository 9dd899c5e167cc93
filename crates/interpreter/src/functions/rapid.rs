//! `rapid` — positioning at rapid traverse (G00).
//!
//! `G00 X(U)_ Z(W)_` moves to the end point, each axis at its own rate (dog-leg), or in a straight line when the
//! parameter for linear positioning is set. F has no effect on it.
//!
//! Source: positioning of both families.

use turnwright_canon::Action;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static RAPID: Function = Function::motion("rapid", rapid).allowed_in_figure();

fn rapid(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let to = core.target(call.block)?;
    core.modal.position = to;
    let path = core.rapid_path();
    core.emit_move(to, Action::Rapid { to, path, others: None })
}

impl Core {
    /// Words behind a comma belong to the straight cut only.
    pub(super) fn refuse_comma_words(&self, block: &turnwright_syntax::Block) -> Result<(), Alarm> {
        if !block.has_comma {
            return Ok(());
        }
        match block.words.iter().find(|word| word.comma) {
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }
}
