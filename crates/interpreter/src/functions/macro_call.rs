//! `macro-call`, `modal-macro-call`, `macro-call-each-block`, `modal-macro-cancel` — calls of macros (G65, G66,
//! G66.1, G67).
//!
//! `G65 P_ L_ …` runs program P, L times, and hands it the other words as local variables 1 to 33. `G66` does it
//! after every following block that moves an axis, `G66.1` in place of every following block; `G67` ends the last
//! of them. The call stands first in its block, and everything behind it is arguments.
//!
//! On the controls that have it, `H` makes G65 arithmetic of the older kind.
//!
//! Source: macro calls, both families.

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::macros::CallKind;
use crate::report::Alarm;

pub(super) static MACRO_CALL: Function = Function::call("macro-call", CallKind::Simple);
pub(super) static MODAL_MACRO_CALL: Function = Function::call("modal-macro-call", CallKind::Modal);
pub(super) static MACRO_CALL_EACH_BLOCK: Function =
    Function::call("macro-call-each-block", CallKind::EachBlock);
pub(super) static MODAL_MACRO_CANCEL: Function = Function::mode(super::MODAL_CALL_CANCEL, cancel);

fn cancel(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.cancel_modal_call(call.word)
}
