//! `skip` — a cut that ends on a signal (G31).
//!
//! `G31 X(U)_ Z(W)_ F_` cuts in a straight line; when the skip signal comes, the rest of the way is dropped and the
//! program goes on from where the tool stopped. Without a signal the move runs to its end. `P` names the input
//! where the control has several. The place is kept as the skip position. Nose compensation must be off.
//!
//! Whether and where a signal comes is the environment's affair: in a setup file `[[skip]]` says it. Override and
//! dry run (6200#7) act on the machine only.
//!
//! Source: skip function and multi-step skip, both families.

use turnwright_canon::{Action, Shape};
use turnwright_units::{Position, Radius, WorkTip};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::{Environment, SignalMove};

pub(super) static SKIP: Function = Function::one_shot("skip", skip).with_letters(b"P");

fn skip(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if core.is_compensating() {
        return Err(core.alarm_at("skip-in-compensation", call.word));
    }
    let inputs = u32::from(core.control.limits.skip_inputs);
    let input = match call.block.word(b'P') {
        None => None,
        Some(word) if inputs == 0 => return Err(core.alarm("illegal-address", word)),
        Some(word) => match core.whole(word, 99_999_999)? {
            input if (1..=inputs).contains(&input) => Some(input as u8),
            _ => return Err(core.alarm("skip-number-illegal", word)),
        },
    };
    if call.block.present() & super::AXES == 0 {
        return Ok(());
    }
    let to = core.target(call.block)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let stop = core.signal_place(call.environment, input, to).unwrap_or(to);
    core.modal.position = stop;
    core.skip_place = stop;
    core.tell_skip();
    core.emit_move(stop, Action::Feed { to: stop, shape: Shape::Line, feed, others: None })
}

impl Core {
    /// Where the last skip move ended, in the work system in force then.
    pub(crate) fn skip_position(&self) -> Position<WorkTip> {
        self.skip_place
    }

    /// Where on the way from the tool to a place a signal comes, rounded to the least increment.
    pub(super) fn signal_place(
        &self,
        environment: &mut dyn Environment,
        input: Option<u8>,
        to: Position<WorkTip>,
    ) -> Option<Position<WorkTip>> {
        let from = self.tip;
        let wait = SignalMove { line: self.at.line, input, from: self.in_work(from), to: self.in_work(to) };
        let part = environment.signal(&wait).filter(|part| (0.0..=1.0).contains(part))?;
        let along = |from: i64, to: i64| from + ((to - from) as f64 * part).round() as i64;
        let length = turnwright_units::Length::from_nm;
        let x = Radius(length(along(from.x.0.nm(), to.x.0.nm())));
        let z = length(along(from.z.nm(), to.z.nm()));
        let increment = self.modal.increment(&self.settings);
        Some(Position::new(x.to_diameter().rounded(increment).to_radius(), z.rounded(increment)))
    }
}
