//! What every thread needs of the words and the spindle: lead, start angle, speed.
//!
//! F is the lead. Beside it some controls know E, a lead with more digits that means the same as F, others I, threads
//! per inch whatever the units; of several in one block the last counts. I stays in force until a thread block gives
//! another lead. The lead must lie within the control's range.
//!
//! The lead times the speed is the speed of the long axis; above the largest cutting feed (1422, 1430, else that of
//! the machine in the setup) the axis could not follow: an alarm, or by policy a warning. That of the assumed machine is
//! always a warning.
//!
//! Source: leads and speed limits of threads, both families.

use turnwright_canon::SpindleState;
use turnwright_control::policy::{LeadWords, StartAngleUnit, ThreadOverspeed, ThreadWithoutSpindle};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Decimal, Word};
use turnwright_units::{Angle, Lead, Length};

use crate::block::Call;
use crate::machine::Core;
use crate::modal::SpeedMode;
use crate::report::Alarm;

/// A full turn in thousandths of a degree; larger start angles are taken as this.
const TURN_MILLIDEGREES: i64 = 360_000;

/// Starts that L may ask for.
const THREAD_STARTS_MAX: u32 = 99;

/// An inch, for threads per inch.
const INCH_NM: i128 = 25_400_000;

impl Core {
    /// The lead in force after the words of the block.
    pub(crate) fn lead_in_force(&mut self, call: &Call<'_>) -> Result<Lead, Alarm> {
        let letter = match self.control.policies.lead_words {
            LeadWords::FeedOrExact => b'E',
            LeadWords::FeedOrCount => b'I',
        };
        self.lead_by(call, letter)
    }

    /// The same where I is the centre of an arc.
    pub(crate) fn lead_in_force_beside_centre(&mut self, call: &Call<'_>) -> Result<Lead, Alarm> {
        self.lead_by(call, b'E')
    }

    fn lead_by(&mut self, call: &Call<'_>, letter: u8) -> Result<Lead, Alarm> {
        let block = call.block;
        let mut at = block.word(b'F');
        if at.is_some() {
            self.modal.lead_by_count = None;
        }
        if let Some(word) = block.word(letter) {
            if let Some(feed) = at {
                self.warn("lead-given-twice", if word.start > feed.start { feed } else { word });
            }
            let lead = if letter == b'E' { self.exact_lead(word)? } else { self.lead_by_count(word)? };
            if at.is_none_or(|feed| word.start > feed.start) {
                at = Some(word);
                match letter {
                    b'E' => (self.modal.feed, self.modal.feed_is_lead) = (Some(lead), true),
                    _ => self.modal.lead_by_count = Some(lead),
                }
            }
        }
        match self.modal.lead_by_count.or(self.modal.feed).map(Lead) {
            Some(lead) if self.is_lead_in_range(lead) => Ok(lead),
            Some(lead) if lead.0.signum() > 0 => Err(self.alarm_at("lead-illegal", at.or(call.word))),
            _ => Err(self.alarm_at("lead-missing", at.or(call.word))),
        }
    }

    /// Whether the control can cut this lead.
    pub(crate) fn is_lead_in_range(&self, lead: Lead) -> bool {
        let limits = &self.control.limits;
        let (least, most) = if self.modal.is_inch {
            (limits.lead_inch_min_nm, limits.lead_inch_max_nm)
        } else {
            (limits.lead_metric_min_nm, limits.lead_metric_max_nm)
        };
        (least..=most).contains(&lead.0.nm())
    }

    /// E: a lead to a ten-thousandth of a millimetre or a millionth of an inch.
    fn exact_lead(&mut self, word: &Word) -> Result<Length, Alarm> {
        let lead = self.fine_lead(word)?;
        match lead.signum() {
            0 => Err(self.alarm("lead-zero", word)),
            1 => Ok(lead),
            _ => Err(self.alarm("minus-not-allowed", word)),
        }
    }

    /// The change of lead in a revolution, with its sign: as large as a lead may be, or none.
    pub(crate) fn lead_change(&mut self, word: &Word) -> Result<Length, Alarm> {
        let change = self.fine_lead(word)?;
        if change.is_zero() || self.is_lead_in_range(Lead(change.abs())) {
            Ok(change)
        } else {
            Err(self.alarm("lead-illegal", word))
        }
    }

    /// A lead in its own increments: those are what it counts without a point.
    fn fine_lead(&mut self, word: &Word) -> Result<Length, Alarm> {
        let decimals: u8 = if self.modal.is_inch { 6 } else { 4 };
        let number = self.number(word)?;
        let number = if number.is_computed() { number.rounded(decimals) } else { number };
        let unit = if self.modal.is_inch { INCH_NM } else { 1_000_000 };
        self.check_lead(word);
        if number.scale > decimals {
            return Err(self.alarm("lead-decimals-illegal", word));
        }
        let counts = !(number.has_point || self.settings.is_calculator);
        let scale = if counts { decimals } else { number.scale };
        // A millionth of an inch is 25.4 nm: rounded to the nanometre.
        let nm = (i128::from(number.digits) * unit * 2 / 10i128.pow(u32::from(scale)) + 1).div_euclid(2);
        match i64::try_from(nm) {
            Ok(nm) => Ok(Length::from_nm(nm)),
            Err(_) => Err(self.alarm("number-too-long", word)),
        }
    }

    /// I: threads per inch as a lead, rounded to the nanometre.
    fn lead_by_count(&mut self, word: &Word) -> Result<Length, Alarm> {
        let Decimal { digits, scale, .. } = self.number(word)?;
        if digits < 0 {
            return Err(self.alarm("minus-not-allowed", word));
        }
        if digits == 0 {
            return Err(self.alarm("lead-zero", word));
        }
        if scale > 9 {
            return Err(self.alarm("number-too-long", word));
        }
        let (inch, count) = (INCH_NM * 10i128.pow(u32::from(scale)), i128::from(digits));
        i64::try_from((inch * 2 + count) / (count * 2))
            .map(Length::from_nm)
            .map_err(|_| self.alarm("lead-illegal", word))
    }

    /// The block before was a thread too.
    pub(crate) const fn is_behind_thread(&self) -> bool {
        self.thread_blocks & 1 != 0
    }

    /// The block in work is a thread.
    pub(crate) const fn note_thread_block(&mut self) {
        self.thread_blocks |= 2;
    }

    /// The start angle of a thread, 0 when not given.
    pub(crate) fn start_angle(&self, call: &Call<'_>) -> Result<Angle, Alarm> {
        let Some(word) = call.block.word(b'Q') else { return Ok(Angle::ZERO) };
        let in_degrees = match self.control.policies.start_angle_unit {
            StartAngleUnit::Thousandths => false,
            StartAngleUnit::Degrees => true,
            StartAngleUnit::ByUnitParameter => self.settings.cycle_words_in_mm,
        };
        let millidegrees =
            if in_degrees { self.millidegrees(word)? } else { i64::from(self.whole(word, 99_999_999)?) };
        if millidegrees < 0 {
            return Err(self.alarm("minus-not-allowed", word));
        }
        Ok(Angle::from_millidegrees(millidegrees.min(TURN_MILLIDEGREES)))
    }

    /// L: the number of starts.
    pub(crate) fn thread_starts(&self, word: &Word) -> Result<u32, Alarm> {
        match self.whole(word, 99_999_999)? {
            starts @ 1..=THREAD_STARTS_MAX => Ok(starts),
            _ => Err(self.alarm("thread-starts-illegal", word)),
        }
    }

    /// Degrees in thousandths, to the nearest.
    pub(crate) fn millidegrees(&self, word: &Word) -> Result<i64, Alarm> {
        let number = self.number(word)?;
        if number.scale > 9 || number.digits.abs() >= 1_000_000_000_000 {
            return Err(self.alarm("number-too-long", word));
        }
        let scale = 10i64.pow(u32::from(number.scale));
        Ok((number.digits * 2_000 + scale).div_euclid(scale * 2))
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

    /// The spindle turns, at one speed, and the axes can follow it.
    pub(crate) fn check_thread(&mut self, call: &Call<'_>, lead: Lead) -> Result<(), Alarm> {
        self.check_thread_spindle()?;
        self.check_thread_speed(call, lead)
    }

    /// The spindle must turn, and should turn at one speed, while a thread is cut.
    pub(crate) fn check_thread_spindle(&mut self) -> Result<(), Alarm> {
        let has_no_speed = self.modal.speed_mode == SpeedMode::Constant && self.modal.rpm.0 == 0;
        let refuses = match self.control.policies.thread_without_spindle {
            ThreadWithoutSpindle::Alarm => true,
            ThreadWithoutSpindle::ByCheckParameter => !self.settings.thread_speed_check_off,
            ThreadWithoutSpindle::Warn => false,
        };
        if has_no_speed && refuses {
            return Err(self.alarm_block("spindle-not-started"));
        }
        if self.modal.spindle == SpindleState::Stop {
            self.warn_once("spindle-not-started-warning");
        }
        if self.modal.speed_mode == SpeedMode::Surface {
            self.warn_once("thread-under-constant-surface-speed");
        }
        Ok(())
    }

    /// Nobody has said what the axis can do: that of the assumed machine is no alarm. Once for each feed.
    #[cold]
    fn warn_of_assumed_feed(&mut self, word: Option<&Word>, needed_mm_per_min: f64, limit_mm_per_min: f64) {
        const KEY: &str = "thread-too-fast-for-assumed-machine";
        if !self.said.insert((KEY, 0, needed_mm_per_min as u32)) {
            return;
        }
        let place = word.map_or_else(|| self.block_place(), |word| self.place(word));
        let whole = |mm_per_min: f64| format!("{mm_per_min:.0}");
        let warning = Diagnostic::warning(KEY).at(place);
        self.say(warning.with("needed", whole(needed_mm_per_min)).with("limit", whole(limit_mm_per_min)));
    }

    /// The long axis must keep up with the spindle.
    pub(crate) fn check_thread_speed(&mut self, call: &Call<'_>, lead: Lead) -> Result<(), Alarm> {
        let Some(limit_mm_per_min) = self.settings.thread_feed_max_mm_per_min else { return Ok(()) };
        let needed_mm_per_min = lead.0.to_mm() * f64::from(self.present_rpm().0);
        if needed_mm_per_min <= limit_mm_per_min {
            return Ok(());
        }
        let word = call.block.word(b'F').or(call.word).copied();
        if self.settings.thread_feed_is_assumed {
            self.warn_of_assumed_feed(word.as_ref(), needed_mm_per_min, limit_mm_per_min);
            return Ok(());
        }
        match (self.control.policies.thread_overspeed, word) {
            (ThreadOverspeed::Alarm, word) => Err(self.alarm_at("thread-too-fast", word.as_ref())),
            (ThreadOverspeed::Warn, Some(word)) => {
                self.warn("thread-too-fast", &word);
                Ok(())
            }
            (ThreadOverspeed::Warn, None) => {
                self.warn_block("thread-too-fast");
                Ok(())
            }
        }
    }
}
