//! What happens to a move between the program and the machine, when anything does.
//!
//! Mirror and rotation carry it into work coordinates, the stroke checks may refuse it, and before the reference
//! return, or once rigid tapping is announced, no axis moves. Nose compensation shifts it first. Nearly every program has none of these;
//! one flag keeps them off its way.
//!
//! Source: stored stroke checks, mirror, rotation and reference return of both families.

use turnwright_canon::Action;
use turnwright_units::{Position, WorkTip};

use crate::machine::Core;
use crate::report::Alarm;

impl Core {
    /// Decides anew whether moves are looked at; called whenever one of the reasons changes.
    pub(crate) fn look_at_moves(&mut self) {
        self.looks_at_moves = self.transform.is_on()
            || self.strokes.is_armed(self.modal.stroke_two_is_on)
            || self.settings.cutting_feed_is_barred
            || self.compensation.is_some()
            || self.lacks_reference()
            || self.modal.awaits_rigid_tap;
    }

    /// No axis may move yet.
    fn lacks_reference(&self) -> bool {
        !self.homing.is_made && !self.settings.start_without_reference
    }

    /// A move of the program from `from` as it goes to the machine, unless it is refused.
    #[cold]
    pub(crate) fn looked_at(&self, from: Position<WorkTip>, action: Action) -> Result<Action, Alarm> {
        if self.lacks_reference() {
            return Err(self.alarm_block("reference-not-made"));
        }
        if self.settings.cutting_feed_is_barred
            && matches!(action, Action::Feed { .. } | Action::Thread { .. })
        {
            return Err(self.alarm_block("cutting-feed-limit-zero"));
        }
        if self.modal.awaits_rigid_tap {
            return Err(self.alarm_block("rigid-tap-axis-move"));
        }
        let action = if self.transform.is_on() {
            self.transform.action(action, self.modal.increment(&self.settings))
        } else {
            action
        };
        if self.strokes.is_armed(self.modal.stroke_two_is_on) {
            self.check_strokes(self.in_work(from), &action)?;
        }
        Ok(action)
    }
}
