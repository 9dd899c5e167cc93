//! `rapid` — positioning at rapid traverse (G00).
//!
//! `G00 X(U)_ Z(W)_` moves to the end point, each axis at its own rate (dog-leg), or in a straight line when the
//! parameter for linear positioning is set. F has no effect on it.
//!
//! Rapids may take part in drawing dimensions (an angle, a chamfer); see `corner`.
//!
//! Source: positioning of both families.

use turnwright_canon::Action;

use super::linear::PATH_LETTERS;
use super::{Function, PathKind};
use crate::block::Call;
use crate::corner::Motion;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static RAPID: Function = Function::motion("rapid", rapid)
    .drawing_lines()
    .making_a_path(PathKind::Rapid)
    .with_other_axes()
    .allowed_in_figure()
    .allowed_in_rotation();

fn rapid(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if call.block.present() & core.axes.rare != 0 {
        return core.rapid_with_axes(call);
    }
    let path = core.rapid_path();
    if core.corner.is_some() || call.block.present() & PATH_LETTERS != 0 || call.block.has_comma {
        return core.line_in_path(call.block, Motion::Rapid(path));
    }
    let to = core.target(call.block)?;
    core.modal.position = to;
    core.emit_made(to, || Action::Rapid { to, path, others: None })
}
