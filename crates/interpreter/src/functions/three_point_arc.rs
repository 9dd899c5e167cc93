//! `three-point-arc`, `three-point-arc-absolute` — an arc through a place between its ends (G05, G05.1 where they
//! are no look-ahead).
//!
//! `G05 X(U)_ Z(W)_ I_ K_ F_`: I (a radius) and K lead from the start to the place in between; one left out is zero.
//! In G05.1 they are its coordinates, I a diameter; one left out is that of the start. The places give circle and
//! turn, so the move is an ordinary arc. Places on one line, equal places, or neither I nor K are an alarm: there is
//! no full circle this way.
//!
//! Source: arc interpolation through three points, GSK 980TDi texts.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_geometry::circle_through;
use turnwright_units::Position;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::plane::{place, point};
use crate::report::Alarm;
use crate::words::Role;

pub(super) static THREE_POINT_ARC: Function =
    Function::motion("three-point-arc", |core, call| three_point_arc(core, call, Middle::Way))
        .with_letters(b"IK")
        .triggered_by(b"IK")
        .allowed_in_figure();

pub(super) static THREE_POINT_ARC_ABSOLUTE: Function =
    Function::motion("three-point-arc-absolute", |core, call| three_point_arc(core, call, Middle::Place))
        .with_letters(b"IK")
        .triggered_by(b"IK")
        .allowed_in_figure();

/// What I and K are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Middle {
    /// A way from the start.
    Way,
    /// Coordinates.
    Place,
}

fn three_point_arc(core: &mut Core, call: &mut Call<'_>, kind: Middle) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    core.move_before_bend(call)?;
    let from = core.modal.position;
    let to = core.target(call.block)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let role = if kind == Middle::Place { Role::XCoordinate } else { Role::ArcOffset };
    let x = core.optional_radius(call.block, b'I', role)?;
    let z = call.block.word(b'K').map(|word| core.length(word)).transpose()?;
    if x.is_none() && z.is_none() {
        return Err(core.alarm_at("three-point-arc-illegal", call.word));
    }
    let middle = match kind {
        Middle::Way => Position::new(x.map_or(from.x, |x| from.x + x), z.map_or(from.z, |z| from.z + z)),
        Middle::Place => Position::new(x.unwrap_or(from.x), z.unwrap_or(from.z)),
    };
    let circle = circle_through(point(from), point(middle), point(to));
    let circle = circle.and_then(|(centre, clockwise)| Some((place(centre)?, clockwise)));
    let Some((centre, clockwise)) = circle else {
        let word = call.block.word(b'I').or(call.block.word(b'K'));
        return Err(core.alarm_at("three-point-arc-illegal", word));
    };
    core.modal.position = to;
    let shape = Shape::Arc { turn: Turn::clockwise_if(clockwise), centre };
    core.emit_move(to, Action::Feed { to, shape, feed, others: None })
}
