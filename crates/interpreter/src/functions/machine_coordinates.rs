//! `machine-coordinates` — one rapid move in machine coordinates (G53).
//!
//! `G53 X_ Z_` (and the other axes of the machine) moves at rapid to a point counted from machine zero, whatever work system, shift and offset are in
//! force, for this block only. U and W (in systems B and C the words of incremental mode) do not count: they are
//! named in a warning. Each axis goes at its own rate, also with linear positioning, unless a parameter makes
//! this move linear (1401#2 of the 988 series). The reference return must have been made.
//!
//! Source: selecting the machine coordinate system, both families.

use turnwright_canon::{Action, RapidPath, Shape};
use turnwright_syntax::{Block, Word};
use turnwright_units::Position;

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static MACHINE_COORDINATES: Function =
    Function::one_shot("machine-coordinates", machine_coordinates).with_other_axes();

fn machine_coordinates(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    if block.present() & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    core.refuse_without_reference(call.word)?;
    let increments = if core.dispatch.has_incremental_words {
        letters(b"UW")
    } else if core.modal.is_incremental {
        letters(b"XZ")
    } else if let Some(word) = block.word(b'U').or(block.word(b'W')) {
        return Err(core.alarm("illegal-address", word));
    } else {
        0
    };
    let counts = |word: &&Word| increments & Block::bit(word.address) == 0;
    for word in block.words.iter().filter(|word| !counts(word)) {
        core.warn("machine-move-increment-ignored", word);
    }
    let mut to = core.machine_position();
    if let Some(word) = block.word(b'X').filter(|word| counts(word)) {
        to.x = core.radius(word, Role::XCoordinate)?;
        core.missing_point(word);
    }
    if let Some(word) = block.word(b'Z').filter(|word| counts(word)) {
        to.z = core.length(word)?;
        core.missing_point(word);
    }
    let to = core.to_work(Position::new(to.x, to.z));
    let to = core.in_range(to)?;
    let path = if core.settings.linear_machine_move { RapidPath::Straight } else { RapidPath::EachAxis };
    let ends = core.other_ends_of_machine(block)?;
    core.modal.position = to;
    let others = core.take_along(to, &Shape::Line, ends);
    core.without_vector(|core| core.emit_move(to, Action::Rapid { to, path, others }))?;
    let names = |letter| block.word(letter).is_some_and(|word| counts(&word));
    core.leave_out_movement(names(b'X'), names(b'Z'));
    Ok(())
}
