//! `tapping-in-line` — tapping in step with the spindle (G33 where that is no thread).
//!
//! `G33 Z(W)_ F(I)_ L_`: the tap is fed in by the lead F, or I threads per inch; at the bottom the spindle stops and
//! turns the other way, the tap comes out to where it started, and the spindle stops. Start it again (M03) before the
//! next cut. L is the number of starts: for each the spindle is started again and the tap fed in at its share of the
//! turn. X may not move. The start angle is that of the encoder; overrides do nothing.
//!
//! Source: tapping in thread mode, GSK 980 texts.

use turnwright_canon::{Action, Shape, SpindleState};
use turnwright_cycles::angle_of_start;
use turnwright_units::Angle;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static TAPPING_IN_LINE: Function =
    Function::motion("tapping-in-line", tapping).with_letters(b"QEIJKRCLDP").with_lead();

fn tapping(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_strange_thread_letters(call, b"L", b"")?;
    let from = core.modal.position;
    let to = core.target(call.block)?;
    if to.x != from.x {
        let word = call.block.word(b'X').or(call.block.word(b'U'));
        return Err(core.alarm_at("tapping-moves-x", word));
    }
    let lead = core.lead_in_force(call)?;
    let starts = call.block.word(b'L').map_or(Ok(1), |word| core.thread_starts(word))?;
    let turns = core.modal.spindle;
    let back = match turns {
        SpindleState::Clockwise => SpindleState::CounterClockwise,
        SpindleState::CounterClockwise => SpindleState::Clockwise,
        SpindleState::Stop => return Err(core.alarm_at("spindle-not-started", call.word)),
    };
    core.check_thread(call, lead)?;
    for start in 0..starts {
        let start_angle = angle_of_start(Angle::ZERO, start, starts);
        let thread = |to, is_chained| Action::Thread {
            to,
            shape: Shape::Line,
            lead,
            lead_end: None,
            start_angle,
            is_chained,
        };
        core.turn_spindle(turns);
        core.emit_move(to, thread(to, false))?;
        core.turn_spindle(SpindleState::Stop);
        core.turn_spindle(back);
        core.emit_move(from, thread(from, true))?;
        core.turn_spindle(SpindleState::Stop);
    }
    Ok(())
}
