//! `linear` — a straight cut (G01).
//!
//! `G01 X(U)_ Z(W)_ F_` cuts in a straight line to the end point at feed F, measured along the path with X as a
//! radius. X and Z are absolute, U and W count from the present position; both may stand in one block. F stays
//! in force; without any F the control stops.
//!
//! The corner to the next block may be broken, and a line may be given by its angle: `R`, `I`, `K`, plain `C` at a
//! right angle, `,A ,C ,R` (plain letters by parameter) or `L`, `D`, `Q` between any lines. See `corner`.
//!
//! Source: linear interpolation of both families.

use turnwright_canon::{Action, Shape};

use super::{Function, PathKind};
use crate::block::Call;
use crate::corner::Motion;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static LINEAR: Function = Function::motion("linear", linear)
    .drawing_lines()
    .making_a_path(PathKind::Line)
    .with_other_axes()
    .allowed_in_figure()
    .allowed_in_rotation();

/// Letters that may make the line part of a path.
pub(super) const PATH_LETTERS: u32 = super::letters(crate::corner::LETTERS);

fn linear(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if call.block.present() & core.axes.rare != 0 {
        return core.linear_with_axes(call);
    }
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    if core.corner.is_some() || call.block.present() & PATH_LETTERS != 0 || call.block.has_comma {
        return core.line_in_path(call.block, Motion::Feed(feed));
    }
    let to = core.target(call.block)?;
    core.modal.position = to;
    core.emit_made(to, || Action::Feed { to, shape: Shape::Line, feed, others: None })
}
