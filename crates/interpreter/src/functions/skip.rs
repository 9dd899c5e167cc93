//! `skip` — a cut that ends on a signal (G31).
//!
//! `G31 X(U)_ Z(W)_ F_` cuts in a straight line; when the skip signal comes, the rest of the way is dropped and the
//! program goes on from where the tool stopped. Without a signal the move runs to its end. `P` names the input
//! where the control has several. The place is kept as the skip position. Nose compensation must be off.
//!
//! Whether and where a signal comes is the environment's affair: in a setup file `[[skip]]` says it. Feed
//! override and dry run act in it by parameter only (6200#7): without it they are put out of action for the move.
//!
//! Source: skip function and multi-step skip, both families.

use turnwright_canon::{Action, OtherAxes, PanelLock, Shape};
use turnwright_units::{Angle, Length, Position, Radius, WorkTip};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::{Environment, SignalMove};

pub(super) static SKIP: Function = Function::one_shot("skip", skip).with_letters(b"P").with_other_axes();

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
    if call.block.present() & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    let to = core.target(call.block)?;
    let ends = core.other_ends(call.block)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let signal = core.signal_part(call.environment, input, to);
    let stop = signal.map_or(to, |part| core.part_of_way(part, to));
    let ends = signal.map_or(ends, |part| core.part_of_other_ways(part, ends));
    core.modal.position = stop;
    let others = core.take_along(stop, &Shape::Line, ends);
    core.skip_place = stop;
    core.skip_places = core.axes.at;
    core.tell_skip();
    let action = Action::Feed { to: stop, shape: Shape::Line, feed, others };
    if core.settings.skip_feed_overridden {
        return core.emit_move(stop, action);
    }
    let lock = core.panel_lock();
    core.emit(Action::PanelLock(PanelLock { feed_override: true, dry_run: true, ..lock }));
    core.emit_move(stop, action)?;
    core.emit(Action::PanelLock(lock));
    Ok(())
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
        self.signal_part(environment, input, to).map(|part| self.part_of_way(part, to))
    }

    /// After which part of the way a signal comes.
    fn signal_part(
        &self,
        environment: &mut dyn Environment,
        input: Option<u8>,
        to: Position<WorkTip>,
    ) -> Option<f64> {
        let from = self.tip;
        let wait = SignalMove { line: self.at.line, input, from: self.in_work(from), to: self.in_work(to) };
        environment.signal(&wait).filter(|part| (0.0..=1.0).contains(part))
    }

    /// The axes beyond X and Z after a part of their way.
    fn part_of_other_ways(&self, part: f64, ends: OtherAxes) -> OtherAxes {
        let at = self.axes.at;
        let along = |from: i64, to: i64| from + ((to - from) as f64 * part).round() as i64;
        let turned = |from: Angle, to: Angle| {
            let increment = self.settings.metric_increment.nm() * 1_000;
            let there = along(from.nanodegrees(), to.nanodegrees());
            Angle::from_nanodegrees((there + increment / 2).div_euclid(increment) * increment)
        };
        let increment = self.modal.increment(&self.settings);
        OtherAxes {
            c: ends.c.map(|to| turned(at.c, to)),
            b: ends.b.map(|to| turned(at.b, to)),
            y: ends.y.map(|to| Length::from_nm(along(at.y.nm(), to.nm())).rounded(increment)),
            ..ends
        }
    }

    /// A place after a part of the way from the tool to another one, rounded to the least increment.
    fn part_of_way(&self, part: f64, to: Position<WorkTip>) -> Position<WorkTip> {
        let from = self.tip;
        let along = |from: i64, to: i64| from + ((to - from) as f64 * part).round() as i64;
        let length = Length::from_nm;
        let x = Radius(length(along(from.x.0.nm(), to.x.0.nm())));
        let z = length(along(from.z.nm(), to.z.nm()));
        let increment = self.modal.increment(&self.settings);
        Position::new(x.to_diameter().rounded(increment).to_radius(), z.rounded(increment))
    }
}
