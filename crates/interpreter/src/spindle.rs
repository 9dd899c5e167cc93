//! S words, speed modes and limits.
//!
//! Source: constant surface speed, its limit, and the rules of S in both modes.

use turnwright_canon::{Action, SpindleSpeed, SpindleState};
use turnwright_syntax::Word;
use turnwright_units::{Rpm, SurfaceSpeed};

use crate::machine::Core;
use crate::modal::SpeedMode;
use crate::report::Alarm;

impl Core {
    /// An S word in the speed mode in force.
    pub(crate) fn speed_word(&mut self, word: &Word) -> Result<(), Alarm> {
        let value = self.speed_value(word)?;
        self.modal.in_force.speed = Some(value);
        match self.modal.speed_mode {
            SpeedMode::Constant => self.modal.rpm = Rpm(value),
            SpeedMode::Surface if self.modal.is_inch => {
                self.modal.surface = SurfaceSpeed::from_ft_per_min(value)
            }
            SpeedMode::Surface => self.modal.surface = SurfaceSpeed::from_m_per_min(value),
        }
        Ok(())
    }

    /// The number of an S word: whole, without sign, as long as the control allows.
    pub(crate) fn speed_value(&self, word: &Word) -> Result<u32, Alarm> {
        self.whole(word, self.settings.speed_max)
    }

    /// The spindle speed at the tool's present place under constant surface speed.
    pub(crate) fn present_rpm(&self) -> Rpm {
        match self.modal.speed_mode {
            SpeedMode::Constant => self.modal.rpm,
            SpeedMode::Surface => {
                let diameter_mm = self.modal.position.x.to_mm().abs() * 2.0;
                let free = self.modal.surface.to_m_per_min() * 1000.0
                    / (std::f64::consts::PI * diameter_mm.max(1e-6));
                let limit = self.modal.rpm_max.map_or(99_999.0, |rpm| f64::from(rpm.0));
                Rpm(free.min(limit).round() as u32)
            }
        }
    }

    /// The state of the spindle as a command.
    pub(crate) fn spindle_action(&self) -> Action {
        let speed = match self.modal.speed_mode {
            SpeedMode::Constant => SpindleSpeed::Constant(self.modal.rpm),
            SpeedMode::Surface => SpindleSpeed::Surface(self.modal.surface),
        };
        Action::Spindle { state: self.modal.spindle, speed, rpm_max: self.modal.rpm_max }
    }

    /// Gives out the state of the spindle when it is a new one.
    pub(crate) fn emit_spindle(&mut self) {
        let action = self.spindle_action();
        if self.last_spindle.as_ref().is_none_or(|last| *last != action) && !self.is_power_on_state(&action) {
            self.last_spindle = Some(action.clone());
            self.emit(action);
        }
    }

    fn is_power_on_state(&self, action: &Action) -> bool {
        let stopped = SpindleSpeed::Constant(Rpm(0));
        self.last_spindle.is_none()
            && *action == Action::Spindle { state: SpindleState::Stop, speed: stopped, rpm_max: None }
    }

    /// Warnings about the spindle before a cutting move.
    #[inline]
    pub(crate) fn check_spindle(&mut self) {
        if self.modal.spindle == SpindleState::Stop
            && self.modal.feed_mode == crate::modal::FeedMode::PerRevolution
            && !self.said_spindle_stands
            && !self.is_capturing()
        {
            self.said_spindle_stands = true;
            self.warn_once("spindle-not-started-warning");
        }
    }
}
