//! Reset, the end of a program, and the start after it.
//!
//! The reset key and M02, M30 leave the same state behind: nose compensation, modal macro calls, polar
//! and cylindrical interpolation and polygon turning are cancelled; all other modes go back to those of power-on, or stay where the parameter says
//! so. Inches and millimetres never change, S stays as a number, and F goes with the modes. The first work
//! system is selected with the modes or by a parameter of its own. The spindle is taken to stand afterwards: that
//! is the machine's own logic, and nearly every machine does it.
//!
//! M30 and M02 also count a part, and go back to the start of the program where their parameters say so.
//!
//! Source: modal groups and their state after reset, part counter, both families.

use turnwright_canon::{Action, SpindleState};
use turnwright_control::policy::SpeedLimitAtReset;
use turnwright_units::Length;

use crate::cache::Cache;
use crate::flow::Resume;
use crate::functions::FunctionId;
use crate::in_force::{GROUPS, MOTION};
use crate::machine::{Core, Interpreter};
use crate::modal::{FeedMode, SpeedMode};
use crate::text::Text;
use crate::transform::Transform;

/// Groups that a reset puts back whatever the parameter says: nose compensation, modal macro calls, polar
/// interpolation.
const ALWAYS_PUT_BACK: [usize; 3] = [7, 12, 21];
/// Inches and millimetres: no reset changes them.
const UNITS: usize = 6;
const WORK_COORDINATES: usize = 14;

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Program end.
    End,
    /// Program end and rewind.
    EndAndRewind,
}

impl Core {
    /// The program has ended: a part is counted, modes are reset, and the start is looked up again or not.
    #[cold]
    pub(crate) fn program_ended(&mut self, ending: Ending) {
        self.parts.count_end();
        let told = (self.out.len(), self.tip);
        let stays = match ending {
            Ending::End => self.settings.no_rewind_at_plain_end,
            Ending::EndAndRewind => self.settings.no_rewind_at_end,
        };
        self.drop_work();
        if ending == Ending::EndAndRewind {
            self.forget_thread_record();
        }
        if self.settings.program_end_clears_local {
            self.with_new_zero(|core| core.zeros.clear_local());
        } else if !self.settings.reset_clears_local && self.zeros.has_local() {
            self.warn_once("local-shift-left-on");
        }
        self.reset_modes();
        // Nothing follows the end: new coordinates of the tool are told at the next start.
        self.out.truncate(told.0);
        self.has_untold_place = self.tip != told.1;
        if !stays {
            self.rewind();
        }
    }

    /// The control forgets the recorded place of a thread, unless its parameter keeps it.
    pub(crate) fn forget_thread_record(&mut self) {
        if !self.settings.thread_record_kept {
            self.thread_record = None;
        }
    }

    /// The state of modes after a reset.
    pub(crate) fn reset_modes(&mut self) {
        let clears = self.settings.clear_modes_at_reset;
        self.reset_axes(clears);
        for group in 1..GROUPS {
            let is_cleared = clears && group != UNITS && group != WORK_COORDINATES;
            if is_cleared || ALWAYS_PUT_BACK.contains(&group) {
                self.modal.in_force.codes[group] = self.dispatch.codes_at_power_on[group];
            }
        }
        if clears {
            self.leave_hole_cycle();
            self.modal.stays_at_r = false;
            self.modal.motion_code = self.dispatch.codes_at_power_on[MOTION].unwrap_or_default();
            self.modal.motion =
                if self.settings.linear_at_power_on { FunctionId::LINEAR } else { FunctionId::RAPID };
            self.modal.rpm = self.present_rpm();
            self.modal.speed_mode = SpeedMode::Constant;
            self.modal.feed_mode = self.settings.feed_mode_at_power_on;
            self.modal.feed = self.initial_feed();
            self.modal.is_incremental = self.starts_incremental();
            self.has_untold_path_mode |= self.modal.path_mode != self.settings.path_mode_at_power_on;
            self.modal.path_mode = self.settings.path_mode_at_power_on;
            self.modal.stroke_two_is_on = self.settings.stroke_two_at_power_on;
            self.with_new_zero(|core| core.transform = Transform::default());
        }
        if clears || self.settings.reset_selects_first_work {
            self.modal.in_force.codes[WORK_COORDINATES] = self.dispatch.codes_at_power_on[WORK_COORDINATES];
            self.with_new_zero(|core| core.modal.work = 0);
        }
        if self.settings.reset_clears_local {
            self.with_new_zero(|core| core.zeros.clear_local());
        }
        self.look_at_moves();
        if self.control.policies.speed_limit_at_reset == SpeedLimitAtReset::Cancelled {
            self.modal.rpm_max = None;
        }
        self.forget_single_cycle();
        self.modal.spindle = SpindleState::Stop;
        self.last_spindle = Some(self.spindle_action());
    }

    /// The feed that is in force before any F word.
    pub(crate) fn initial_feed(&self) -> Option<Length> {
        let is_per_minute = self.settings.feed_mode_at_power_on == FeedMode::PerMinute;
        Some(self.settings.initial_feed).filter(|feed| is_per_minute && !feed.is_zero())
    }

    /// Systems B and C: whether X and Z are increments at power-on.
    pub(crate) fn starts_incremental(&self) -> bool {
        self.settings.incremental_at_power_on && !self.dispatch.has_incremental_words
    }

    /// Lets go of cycles, calls and figures that are in work.
    fn drop_work(&mut self) {
        self.active = None;
        self.in_cycle = None;
        self.cylinder_roughing = None;
        self.capture = None;
        self.corner = None;
        self.waiting = None;
        self.data_list = None;
        self.stops_once = false;
        self.frames.clear();
        self.cache.leave();
        self.macros.reset(&self.control.parameters);
        self.roughed.clear();
        self.finished_first.clear();
        self.reset_offset();
    }

    /// Goes back to the first block of the text.
    fn rewind(&mut self) {
        self.text.jump(self.text_start);
        self.cache.leave();
        self.cache.enter(self.text_start.source);
        self.from = 0;
        self.program_start = Resume { line: self.text_start, from: 0 };
        self.has_started = false;
        self.expects_program_number = true;
        self.is_plain = false;
    }
}

impl Interpreter {
    /// The reset key: what is in work is dropped, modes are left as the control leaves them, and the program
    /// is at its start again.
    pub fn reset(&mut self) {
        self.text_lines.stop(&mut self.core);
        self.core.out.clear();
        self.core.sync = None;
        self.core.abandon_compensation();
        let place = self.core.tip;
        self.core.drop_work();
        self.core.reset_modes();
        self.core.out.clear();
        self.core.has_untold_place |= self.core.tip != place;
        // The text may have been edited meanwhile.
        self.core.text = Text::new(self.core.text_start.source);
        self.core.indexes.clear();
        self.core.cache = Cache::default();
        self.core.macros.machine.forget(0);
        self.core.rewind();
        self.start_again();
    }

    /// Cycle start after the end of the program: it runs from its start, or goes on behind its end where the
    /// control stays there.
    pub fn start_again(&mut self) {
        self.text_lines.stop(&mut self.core);
        self.alarm = None;
        self.core.is_over = false;
        self.core.tell_axes();
        if std::mem::take(&mut self.core.has_untold_place) {
            self.core.emit(Action::Relocate { to: self.core.tip, others: None });
        }
        if std::mem::take(&mut self.core.has_untold_path_mode) {
            self.core.emit(Action::PathMode(self.core.modal.path_mode));
        }
        self.core.blocks_run = 0;
        self.core.cycle_moves = 0;
        self.core.idle_blocks = 0;
    }
}
