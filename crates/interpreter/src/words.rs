//! Words to quantities: decimal rules, units, increments, and the one place where an X word becomes a radius.
//!
//! Source: numbers and decimal points of both families; diameter and radius words by role.

use turnwright_control::policy::{
    CycleIntegerWords, FineDigits, IntegerWords, LedSpindleFeed, MissingPoint, NegativeFeed,
};
use turnwright_syntax::{Decimal, Value, Word};
use turnwright_units::{Diameter, LeastIncrement, Length, Radius};

use crate::functions::Function;
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

/// What a radial word means: a place or way across the work, or a distance from its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// X of a move, of a preset, of an intermediate point.
    XCoordinate,
    /// U of a move.
    XIncrement,
    /// U of the block that runs a roughing cycle.
    XAllowance,
    /// Depth of cut, relief of a pattern, return of a groove.
    RadialDepth,
    /// I and R of arcs.
    ArcOffset,
    /// R of single cycles and of the threading cycle.
    TaperRadius,
    /// J of threads: how far a run-out leaves.
    RunOut,
    /// C, R, I and K of corners.
    CornerSize,
}

impl Role {
    const fn is_diameter(self) -> bool {
        matches!(self, Self::XCoordinate | Self::XIncrement | Self::XAllowance)
    }
}

pub(crate) const POWER: [i64; 10] =
    [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// Numbers with fewer digits than this are short enough and small enough for every control.
const FINE_DIGITS_MAX: u64 = 100_000_000;

/// The increments of nearly every control, nanometres: a division by a known number costs little.
const USUAL: i64 = LeastIncrement::METRIC_B.nm();
const FINE: i64 = LeastIncrement::METRIC_C.nm();

/// How often `step` goes into a number, to the nearest; halves away from zero.
#[inline]
const fn nearest(digits: i64, step: i64) -> i64 {
    let half = if digits < 0 { -step / 2 } else { step / 2 };
    (digits + half) / step
}

/// Whether a feed is usual in the other feed mode: more than this a revolution, or less than this a minute, is hardly
/// ever meant.
#[inline]
pub(crate) fn is_strange_feed(feed: Length, per_revolution: bool) -> bool {
    const PER_REVOLUTION_MAX: Length = Length::from_mm(10);
    const PER_MINUTE_MIN: Length = Length::from_mm(1);
    if per_revolution { feed > PER_REVOLUTION_MAX } else { feed < PER_MINUTE_MIN && !feed.is_zero() }
}

impl Core {
    /// The number of a word.
    #[inline]
    pub(crate) fn number(&self, word: &Word) -> Result<Decimal, Alarm> {
        match word.value {
            Value::Number(number) => Ok(number),
            // Expressions were computed before; what is left is a name where no name can stand.
            Value::Expression { .. } => Err(self.alarm("macro-expression-format", word)),
            Value::Missing => Err(self.alarm("address-without-value", word)),
        }
    }

    /// A length word by the decimal rule of the control.
    #[inline]
    pub(crate) fn length(&self, word: &Word) -> Result<Length, Alarm> {
        if let Value::Number(number) = &word.value
            && let Some(length) = self.plain_length(number)
        {
            return Ok(length);
        }
        self.length_with(word, self.modal.increment(&self.settings))
    }

    /// A length in millimetres where little can go wrong; any other has to be looked at with its word.
    ///
    /// By reference, as all numbers of short lines: whoever reads one as a whole that was just written field by field
    /// waits for the fields.
    #[inline(always)]
    pub(crate) fn plain_length(&self, number: &Decimal) -> Option<Length> {
        self.limited(self.plain_place(number)?)
    }

    /// A length that the control can hold.
    #[inline(always)]
    pub(crate) fn limited(&self, length: Length) -> Option<Length> {
        length.is_below(self.settings.length_limit_nm).then_some(length)
    }

    /// As [`Core::plain_length`], where the control may not be able to hold it: whoever makes a place of it asks for
    /// the place.
    #[inline(always)]
    pub(crate) fn plain_place(&self, number: &Decimal) -> Option<Length> {
        if !(number.has_point || self.settings.is_calculator) || self.modal.is_inch {
            return None;
        }
        let nm = if number.scale <= self.settings.metric_decimals {
            // Nearly every word: no finer than the increment.
            number.digits.saturating_mul(POWER[usize::from(6 - number.scale)])
        } else {
            self.fine_millimetres(number)?
        };
        Some(Length::from_nm(nm))
    }

    /// A length word whose value counts, or is long, large or missing.
    #[cold]
    fn length_with(&self, word: &Word, increment: LeastIncrement) -> Result<Length, Alarm> {
        let number = self.number(word)?;
        let counts = !(number.has_point || self.settings.is_calculator);
        self.length_of(word, number, counts, increment)
    }

    /// A value of the offset tables, which may have an increment of their own.
    pub(crate) fn offset_length(&self, word: &Word) -> Result<Length, Alarm> {
        self.length_with(word, self.offset_increment())
    }

    /// Millimetres finer than the increment, in nanometres, where little can go wrong; [`Core::length_of`] does the
    /// rest.
    fn fine_millimetres(&self, number: &Decimal) -> Option<i64> {
        let increment = self.settings.metric_increment.nm();
        if number.is_computed() && number.scale == 9 {
            // Nanometres in an increment, and the thousandths of them that computed values are held to.
            return Some(match increment {
                USUAL => nearest(number.digits, USUAL * 1_000) * USUAL,
                FINE => nearest(number.digits, FINE * 1_000) * FINE,
                _ => nearest(number.digits, increment * 1_000) * increment,
            });
        }
        if number.scale <= 6 && number.digits.unsigned_abs() < FINE_DIGITS_MAX {
            // Programs of CAM systems: a digit or two more.
            let nm = number.digits * POWER[usize::from(6 - number.scale)];
            let half = match self.control.policies.fine_digits {
                FineDigits::Cut => 0,
                FineDigits::Round if nm < 0 => -increment / 2,
                FineDigits::Round => increment / 2,
            };
            return Some(match increment {
                USUAL => (nm + half) / USUAL * USUAL,
                _ => (nm + half) / increment * increment,
            });
        }
        None
    }

    /// A number that counts: what was computed is rounded to the nearest whole one.
    #[inline]
    fn counted(&self, word: &Word) -> Result<Decimal, Alarm> {
        let number = self.number(word)?;
        Ok(if number.is_computed() { number.rounded(0) } else { number })
    }

    /// `counts`: the number counts least increments.
    fn length_of(
        &self,
        word: &Word,
        number: Decimal,
        counts: bool,
        increment: LeastIncrement,
    ) -> Result<Length, Alarm> {
        let increment = increment.nm();
        let digits_max = POWER[usize::from(self.control.limits.number_digits.min(9))];
        if number.digits.abs() >= digits_max && !number.is_computed() {
            return Err(self.alarm("number-too-long", word));
        }
        if counts {
            if self.control.policies.missing_point == MissingPoint::Alarm && number.digits != 0 {
                return Err(self.alarm("point-required", word));
            }
            if number.digits.abs() >= digits_max {
                return Err(self.alarm("number-too-long", word));
            }
            return Ok(Length::from_nm(number.digits * increment));
        }
        let unit = if self.modal.is_inch { 25_400_000 } else { 1_000_000 };
        if number.scale > 9 {
            return Err(self.alarm("number-too-long", word));
        }
        let nm = i128::from(number.digits) * unit;
        let scale = i128::from(POWER[usize::from(number.scale)]);
        let step = i128::from(increment) * scale;
        // The number in increments, cut or rounded once.
        let half = match self.control.policies.fine_digits {
            FineDigits::Cut if !number.is_computed() => 0,
            FineDigits::Cut | FineDigits::Round => {
                step / 2 * i128::from(if number.digits < 0 { -1i8 } else { 1 })
            }
        };
        let count = (nm + half) / step;
        if count.abs() >= i128::from(digits_max) {
            return Err(self.alarm("number-too-long", word));
        }
        Ok(Length::from_nm(count as i64 * increment))
    }

    /// The one place where an X-like word becomes a radius: its role decides, not its letter.
    #[inline]
    pub(crate) fn radius(&self, word: &Word, role: Role) -> Result<Radius, Alarm> {
        Ok(self.radius_of(self.length(word)?, role))
    }

    /// The radius that the length of an X-like word means.
    #[inline]
    pub(crate) fn radius_of(&self, length: Length, role: Role) -> Radius {
        let is_diameter = role.is_diameter() && !self.settings.x_is_radius;
        if is_diameter { Diameter(length).to_radius() } else { Radius(length) }
    }

    /// The way back: a coordinate of X as programs write and read it.
    pub(crate) fn x_value(&self, x: Radius) -> Length {
        if self.settings.x_is_radius { x.0 } else { x.to_diameter().0 }
    }

    /// A length that has no sign.
    pub(crate) fn unsigned_length(&self, word: &Word) -> Result<Length, Alarm> {
        let length = self.length(word)?;
        if length.signum() < 0 { Err(self.alarm("minus-not-allowed", word)) } else { Ok(length) }
    }

    /// P and Q of the grooving and threading cycles: least increments, or millimetres by parameter.
    pub(crate) fn cycle_length(&self, word: &Word) -> Result<Length, Alarm> {
        let number = self.number(word)?;
        let in_mm = match self.control.policies.cycle_integer_words {
            CycleIntegerWords::Increments => false,
            CycleIntegerWords::ByUnitParameter => self.settings.cycle_words_in_mm,
        };
        let number = if in_mm { number } else { self.counted(word)? };
        if number.has_point && !in_mm {
            return Err(self.alarm("point-not-allowed", word));
        }
        self.length_of(word, number, !in_mm, self.modal.increment(&self.settings))
    }

    /// A whole number without sign and point, at most `max`.
    #[inline]
    pub(crate) fn whole(&self, word: &Word, max: u32) -> Result<u32, Alarm> {
        let number = self.counted(word)?;
        let digits = if number.has_point { self.whole_with_point(word, number)? } else { number.digits };
        if number.is_negative && digits != 0 {
            return Err(self.alarm("minus-not-allowed", word));
        }
        match u32::try_from(digits) {
            Ok(value) if value <= max => Ok(value),
            _ => Err(self.alarm("number-too-long", word)),
        }
    }

    /// A whole number with a point behind it.
    #[cold]
    fn whole_with_point(&self, word: &Word, number: Decimal) -> Result<i64, Alarm> {
        match (self.control.policies.integer_words, number.scaled(0)) {
            (IntegerWords::FractionRefused, Some((whole, false))) => Ok(whole),
            _ => Err(self.alarm("point-not-allowed", word)),
        }
    }

    /// The F word of a block.
    #[inline]
    pub(crate) fn feed_word(&mut self, word: &Word, function: &Function) -> Result<(), Alarm> {
        let takes_lead = function.takes_lead || (function.is_hole_cycle && self.taps_by_lead(function));
        let per_revolution = takes_lead || self.modal.feed_mode == FeedMode::PerRevolution;
        let mut number = self.number(word)?;
        self.modal.lead_is_left = false;
        if number.is_negative && number.digits != 0 {
            if function.leads_spindle() && self.has_signed_leads() {
                self.modal.lead_is_left = true;
            } else if takes_lead || self.control.policies.negative_feed == NegativeFeed::Alarm {
                return Err(self.alarm("minus-not-allowed", word));
            } else {
                self.warn("negative-feed-as-positive", word);
            }
            number.digits = number.digits.abs();
        }
        let feed = self.feed(word, number, per_revolution)?;
        self.modal.feed = Some(feed);
        self.modal.feed_is_lead = takes_lead;
        if takes_lead {
            self.check_lead(word);
        } else {
            self.check_feed(word, feed, per_revolution);
        }
        Ok(())
    }

    /// F of the codes that lead the spindle is a lead with a sign.
    pub(crate) fn has_signed_leads(&self) -> bool {
        self.control.policies.led_spindle_feed == LedSpindleFeed::SignedLead
    }

    /// F of a tapping cycle is a lead.
    fn taps_by_lead(&self, function: &Function) -> bool {
        function.is_tapping() && self.has_signed_leads()
    }

    /// A code times ten: `G71` is 710, `G50.3` is 503.
    #[inline]
    pub(crate) fn code(&self, word: &Word) -> Result<u16, Alarm> {
        let number = self.number(word)?;
        if number.is_negative {
            return Err(self.alarm("minus-not-allowed", word));
        }
        if number.scale == 0 && number.digits < 1_000 {
            return Ok(number.digits as u16 * 10);
        }
        match number.scaled(1) {
            Some((code, false)) if code < 10_000 => Ok(code as u16),
            _ => Err(self.alarm("unusable-g-code", word)),
        }
    }

    /// A feed from the number of its word. Without a point it counts hundredths of a millimetre per revolution (or thousandths), whole
    /// millimetres per minute (or thousandths): the parameters say which.
    #[inline]
    fn feed(&self, word: &Word, number: Decimal, per_revolution: bool) -> Result<Length, Alarm> {
        self.plain_feed(number, per_revolution).ok_or_else(|| self.alarm("number-too-long", word))
    }

    /// As [`Core::feed`]; `None` for a number that is too long.
    #[inline]
    pub(crate) fn plain_feed(&self, number: Decimal, per_revolution: bool) -> Option<Length> {
        let number = if number.is_computed() { number.rounded(6) } else { number };
        if number.has_point && !self.modal.is_inch && number.scale <= 6 && number.digits < 1_000_000_000 {
            return Some(Length::from_nm(number.digits * POWER[usize::from(6 - number.scale)]));
        }
        let unit: i64 = if self.modal.is_inch { 25_400_000 } else { 1_000_000 };
        let (mul, div) = if number.has_point || self.settings.is_calculator {
            (unit, POWER[usize::from(number.scale.min(9))])
        } else if per_revolution {
            // Inch: 0.0001 in, or 0.000001 in.
            match (self.modal.is_inch, self.settings.feed_per_rev_fine) {
                (false, false) => (10_000, 1),
                (false, true) => (1_000, 1),
                (true, false) => (2_540, 1),
                (true, true) => (unit, 1_000_000),
            }
        } else {
            match (self.modal.is_inch, self.settings.feed_per_min_fine) {
                (false, false) => (unit, 1),
                (false, true) => (1_000, 1),
                (true, false) => (254_000, 1),
                (true, true) => (unit, 1_000_000),
            }
        };
        let digits_max = POWER[usize::from(self.control.limits.number_digits.min(9))];
        if number.scale > 9 || (number.digits >= digits_max && !number.is_computed()) {
            return None;
        }
        number.digits.checked_mul(mul).map(|nm| Length::from_nm(nm / div))
    }

    /// Warns about a feed that is usual in the other feed mode.
    #[inline]
    fn check_feed(&mut self, word: &Word, feed: Length, per_revolution: bool) {
        if is_strange_feed(feed, per_revolution) {
            self.warn("feed-suspicious", word);
        } else {
            self.check_cutting_speed();
        }
    }
}
