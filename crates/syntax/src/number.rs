//! Numbers as they were typed.

/// A number as it was typed: digits, where the point stood, and whether there was one.
///
/// `X100` and `X100.` differ only in `has_point`, and that can be the difference between 0.1 mm and 100 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decimal {
    /// All digits as one whole number, with the sign.
    pub digits: i64,
    /// How many of them stand behind the point.
    pub scale: u8,
    /// Digits typed, leading zeros included (saturating); 0 for a value that was computed, not typed.
    pub typed_digits: u8,
    /// A point was typed.
    pub has_point: bool,
    /// A minus was typed, also before a zero.
    pub is_negative: bool,
}

/// Most digits that a number is read with; more are a fault.
pub(crate) const DIGITS_MAX: u8 = 18;

/// Decimal places that computed values are kept with.
const COMPUTED_PLACES: u8 = 9;

impl Decimal {
    /// The value of an expression, to nine decimal places; `None` when it is not finite or too large to count.
    #[inline]
    pub fn computed(value: f64) -> Option<Self> {
        let is_negative = value < 0.0;
        let scaled = value * 1e9;
        let (digits, scale) = if scaled.abs() < 9e18 {
            // To the nearest, halves away from zero.
            ((scaled + 0.5f64.copysign(scaled)) as i64, COMPUTED_PLACES)
        } else if value.abs() < 9e18 {
            (value.round() as i64, 0)
        } else {
            return None;
        };
        Some(Self { digits, scale, typed_digits: 0, has_point: true, is_negative })
    }

    /// The value was computed, not typed.
    #[inline]
    pub const fn is_computed(self) -> bool {
        self.typed_digits == 0
    }

    /// A computed value rounded to so many decimal places, halves away from zero. At none it has no point.
    #[must_use]
    pub const fn rounded(self, places: u8) -> Self {
        let mut rounded = self;
        if rounded.scale > places {
            // All surplus digits go at once: one by one would round twice.
            let mut factor = 1;
            let mut surplus = rounded.scale - places;
            while surplus > 0 {
                factor *= 10;
                surplus -= 1;
            }
            let half = if rounded.digits < 0 { -factor / 2 } else { factor / 2 };
            rounded.digits = (rounded.digits + half) / factor;
            rounded.scale = places;
        }
        if places == 0 {
            rounded.has_point = false;
        }
        rounded
    }

    /// The value as a whole number when nothing stands behind the point.
    pub const fn whole(self) -> Option<i64> {
        if self.scale == 0 { Some(self.digits) } else { None }
    }

    /// The value times 10^`places`, or `None` when that is out of range; digits beyond are cut off towards zero
    /// and reported in the flag.
    pub fn scaled(self, places: u8) -> Option<(i64, bool)> {
        if self.scale <= places {
            let factor = 10i64.checked_pow(u32::from(places - self.scale))?;
            self.digits.checked_mul(factor).map(|value| (value, false))
        } else {
            let factor = 10i64.checked_pow(u32::from(self.scale - places))?;
            Some((self.digits / factor, self.digits % factor != 0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_values_are_held_to_nine_places() {
        let third = Decimal::computed(-1.0 / 3.0).expect("fits");
        assert_eq!((third.digits, third.scale, third.is_computed()), (-333_333_333, 9, true));
        assert_eq!(Decimal::computed(1e15).map(|d| (d.digits, d.scale)), Some((1_000_000_000_000_000, 0)));
        assert_eq!(third.rounded(3).digits, -333);
        let half = Decimal::computed(3.5).expect("fits").rounded(0);
        assert_eq!((half.digits, half.scale, half.has_point), (4, 0, false));
        assert_eq!(Decimal::computed(f64::NAN), None);
        assert_eq!(Decimal::computed(1e30), None);
    }

    #[test]
    fn scaling_keeps_or_cuts() {
        let number =
            Decimal { digits: -12_345, scale: 3, typed_digits: 5, has_point: true, is_negative: true };
        assert_eq!(number.scaled(3), Some((-12_345, false)));
        assert_eq!(number.scaled(6), Some((-12_345_000, false)));
        assert_eq!(number.scaled(1), Some((-123, true)));
        assert_eq!(Decimal { digits: i64::MAX, ..number }.scaled(9), None);
    }
}
