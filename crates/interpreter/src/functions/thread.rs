//! `thread` — a thread cut with constant lead (G32; G33 in systems B and C).
//!
//! `G32 X(U)_ Z(W)_ F_ Q_`: straight, tapered or face thread in step with the spindle. F is the lead along the
//! axis with the longer way (X as a radius). Q is the spindle angle of the start in thousandths of a degree,
//! without a point; it is not modal. Blocks that follow one another form one thread.
//!
//! Source: thread cutting with constant lead, both families.

use turnwright_canon::Action;
use turnwright_control::policy::ThreadWithoutSpindle;
use turnwright_syntax::Word;
use turnwright_units::{Angle, Lead};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::SpeedMode;
use crate::report::Alarm;

pub(super) static THREAD: Function = Function::motion("thread", thread).with_letters(b"Q").with_lead();

/// A full turn in thousandths of a degree; larger start angles are taken as this.
const TURN_MILLIDEGREES: u32 = 360_000;

fn thread(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if let Some(word) = call.block.words.iter().find(|word| word.comma) {
        return Err(core.alarm("corner-in-thread", word));
    }
    let to = core.target(call.block)?;
    let lead = core.lead_in_force(call)?;
    let start_angle = core.start_angle(call)?;
    core.check_thread_spindle()?;
    core.modal.position = to;
    core.emit_move(to, Action::Thread { to, lead, lead_end: None, start_angle })
}

impl Core {
    /// The lead: the F in force.
    pub(super) fn lead_in_force(&self, call: &Call<'_>) -> Result<Lead, Alarm> {
        match self.modal.feed {
            Some(feed) if feed.signum() > 0 => Ok(Lead(feed)),
            _ => Err(self.alarm_at("lead-missing", call.block.word(b'F').or(call.word))),
        }
    }

    /// The start angle of a thread, 0 when not given.
    pub(super) fn start_angle(&self, call: &Call<'_>) -> Result<Angle, Alarm> {
        let Some(word) = call.block.word(b'Q') else { return Ok(Angle::ZERO) };
        let value = self.whole(word, 99_999_999)?.min(TURN_MILLIDEGREES);
        Ok(Angle::from_millidegrees(i64::from(value)))
    }

    /// A lead without a point is a thousand times smaller than it looks, or a hundred: say it.
    pub(crate) fn check_lead(&mut self, word: &Word) {
        if let turnwright_syntax::Value::Number(number) = word.value
            && !number.has_point
            && !self.settings.is_calculator
            && number.digits != 0
        {
            self.warn("lead-without-point", word);
        }
    }

    /// The spindle must turn, and should turn at one speed, while a thread is cut.
    pub(super) fn check_thread_spindle(&mut self) -> Result<(), Alarm> {
        let has_no_speed = self.modal.speed_mode == SpeedMode::Constant && self.modal.rpm.0 == 0;
        if has_no_speed && self.control.policies.thread_without_spindle == ThreadWithoutSpindle::Alarm {
            return Err(self.alarm_block("spindle-not-started"));
        }
        if self.modal.spindle == turnwright_canon::SpindleState::Stop {
            self.warn_once("spindle-not-started-warning");
        }
        if self.modal.speed_mode == SpeedMode::Surface {
            self.warn_once("thread-under-constant-surface-speed");
        }
        Ok(())
    }
}
