//! `measuring-x`, `measuring-z` — automatic tool offset (G36, G37).
//!
//! `G36 X_` or `G37 Z_`: the tool goes at rapid to the distance γ (6251, 6252) before the place, then at the
//! measuring feed (6241; of G37 6242 where it is set) on, until the signal of the sensor comes. It must come within ε (6254, 6255) of the place,
//! else there is an alarm and nothing is corrected. The difference between where it came and the place
//! is added to the wear of the offset in force (or taken from it, 6210#6), which then acts as any changed offset does. γ and ε are radius
//! values in X.
//!
//! The offset must have been called before; T, an increment or another axis in the block is an alarm. Nose
//! compensation must be off.
//!
//! Source: automatic tool offset of both families. That the wear is corrected, not the geometry, and that γ and
//! ε are radius values is from memory.

use turnwright_canon::{Action, Shape};
use turnwright_control::Axis;
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::offsets::{OffsetField, OffsetTable};
use crate::report::Alarm;

pub(super) static MEASURING_X: Function =
    Function::one_shot("measuring-x", |core, call| measure(core, call, Axis::X));
pub(super) static MEASURING_Z: Function =
    Function::one_shot("measuring-z", |core, call| measure(core, call, Axis::Z));

fn measure(core: &mut Core, call: &mut Call<'_>, axis: Axis) -> Result<(), Alarm> {
    let block = call.block;
    if core.control.parameters.bit("measuring-unavailable") {
        return Err(core.alarm_at("measuring-switched-off", call.word));
    }
    if core.is_compensating() {
        return Err(core.alarm_at("skip-in-compensation", call.word));
    }
    if let Some(word) = block.word(b'T') {
        return Err(core.alarm("tool-in-measuring-block", word));
    }
    let own = if axis == Axis::X { b'X' } else { b'Z' };
    let strange = letters(b"XZUW") & !letters(&[own]);
    let strange = block.words.iter().find(|word| strange & turnwright_syntax::Block::bit(word.address) != 0);
    let Some(word) = block.word(own).filter(|_| strange.is_none() && !core.modal.is_incremental) else {
        return Err(core.alarm_at("measuring-axis-illegal", strange.or(block.word(own)).or(call.word)));
    };
    let number = core.modal.offset;
    if number == 0 {
        return Err(core.alarm_at("measuring-without-offset", call.word));
    }
    let nominal = core.target(block)?;
    core.missing_point(word);
    let feed = |name| Length::from_nm((core.control.parameters.value(name) * 1e6).round() as i64);
    let feed = match feed("measuring-feed-z") {
        of_z if axis == Axis::Z && !of_z.is_zero() => of_z,
        _ => feed("measuring-feed"),
    };
    if feed.is_zero() {
        return Err(core.alarm_at("feed-missing", call.word));
    }
    let feed = Feed::PerMinute(FeedPerMinute(feed));
    let [approach, window] = if axis == Axis::X {
        ["measuring-approach-x", "measuring-window-x"]
    } else {
        ["measuring-approach-z", "measuring-window-z"]
    }
    .map(|name| Length::from_nm((core.control.parameters.value(name) * 1e6).round() as i64));
    let along = |place: Position<WorkTip>| if axis == Axis::X { place.x.0 } else { place.z };
    let moved = |place: Position<WorkTip>, way: Length| {
        if axis == Axis::X {
            Position::new(place.x + Radius(way), place.z)
        } else {
            Position::new(place.x, place.z + way)
        }
    };
    let way = along(nominal) - along(core.tip);
    let towards = |length: Length| if way.signum() < 0 { -length } else { length };
    if way.abs() > approach {
        core.rapid_each_axis(moved(nominal, towards(-approach)))?;
    }
    let last = moved(nominal, towards(window));
    let signal = core.signal_place(call.environment, None, last);
    let stop = signal.unwrap_or(last);
    core.modal.position = stop;
    core.emit_move(stop, Action::Feed { to: stop, shape: Shape::Line, feed, others: None })?;
    let difference = along(stop) - along(nominal);
    if signal.is_none() || difference.abs() > window {
        return Err(core.alarm_at("measuring-signal-outside-window", call.word));
    }
    let is_diameter = axis == Axis::X && core.settings.offsets.wear_x_is_diameter();
    let difference =
        if core.control.parameters.bit("measuring-subtracts") { -difference } else { difference };
    let change = if is_diameter { Radius(difference).to_diameter().0 } else { difference };
    let field = if axis == Axis::X { OffsetField::X } else { OffsetField::Z };
    core.offset_value(OffsetTable::Wear, field, number)
        .and_then(|before| core.set_offset_value(OffsetTable::Wear, field, number, before + change))
        .map_err(|_| core.alarm("offset-data-out-of-range", word))
}
