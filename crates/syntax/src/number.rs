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

/// A run of digits with at most one point, without its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) digits: i64,
    /// Digits behind the point.
    pub(crate) scale: u8,
    pub(crate) typed_digits: u8,
    pub(crate) has_point: bool,
    /// Bytes that it takes.
    pub(crate) bytes: usize,
}

impl Run {
    /// The number that the run is, behind a minus or not.
    #[inline(always)]
    pub(crate) const fn signed(self, is_negative: bool) -> Decimal {
        Decimal {
            digits: if is_negative { -self.digits } else { self.digits },
            scale: self.scale,
            typed_digits: self.typed_digits,
            has_point: self.has_point,
            is_negative,
        }
    }

    /// The run that eight bytes begin with, the first one lowest. One of all eight may go on behind them. `None` for
    /// eight digits, and for no digit.
    ///
    /// A byte at a time, each number would be waited for at its end, which nobody can foretell where lengths differ.
    #[inline(always)]
    pub(crate) fn of_eight(bytes: u64) -> Option<Self> {
        const ONES: u64 = 0x0101_0101_0101_0101;
        // Digits become 0 to 9. The highest bit of every other byte is set in `others`, and of a digit's it is not as
        // long as nothing but digits and a point stands before it.
        let values = bytes ^ (0x30 * ONES);
        let others = (values.wrapping_add(0x76 * ONES) | values) & (0x80 * ONES);
        if others == 0 {
            return None;
        }
        let whole = others.trailing_zeros() / 8;
        if (values >> (whole * 8)) as u8 != b'.' ^ 0x30 {
            let (digits, typed_digits) = (joined(values, whole)?, whole as u8);
            return Some(Self { digits, scale: 0, typed_digits, has_point: false, bytes: whole as usize });
        }
        let (through_point, behind_point) = (others ^ (others - 1), others & (others - 1));
        let bytes = behind_point.trailing_zeros() / 8;
        // The digits behind the point move over it.
        let moved = values >> 8;
        let digits = joined(moved ^ ((moved ^ values) & (through_point >> 8)), bytes - 1)?;
        let (scale, typed_digits) = ((bytes - 1 - whole) as u8, (bytes - 1) as u8);
        Some(Self { digits, scale, typed_digits, has_point: true, bytes: bytes as usize })
    }

    /// The run that `text` begins with, a byte at a time; `None` for no digit, and for more than [`DIGITS_MAX`].
    #[inline(never)]
    pub(crate) fn read_slowly(text: &[u8]) -> Option<Self> {
        let (mut digits, mut bytes, mut point) = (0i64, 0, None);
        for byte in text {
            match byte {
                b'0'..=b'9' => digits = digits.wrapping_mul(10).wrapping_add(i64::from(byte - b'0')),
                b'.' if point.is_none() => point = Some(bytes),
                _ => break,
            }
            bytes += 1;
        }
        let has_point = point.is_some();
        let typed_digits = bytes - usize::from(has_point);
        let scale = point.map_or(0, |point| typed_digits - point);
        (1..=usize::from(DIGITS_MAX)).contains(&typed_digits).then_some(Self {
            digits,
            scale: scale as u8,
            typed_digits: typed_digits as u8,
            has_point,
            bytes,
        })
    }
}

/// The number that so many digits make, a byte each, the first one lowest; `None` for no digits.
#[inline(always)]
fn joined(digits: u64, count: u32) -> Option<i64> {
    if count == 0 {
        return None;
    }
    // Up to the end of the eight, and then two, four and eight of them at once.
    let ones = digits << (64 - count * 8);
    let pairs = (ones.wrapping_mul(1 + (10 << 8)) >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(1 + (100 << 16)) >> 16) & 0x0000_ffff_0000_ffff;
    Some((fours.wrapping_mul(1 + (10_000 << 32)) >> 32) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_read_at_once_are_those_read_byte_by_byte() {
        // Every text of eight bytes of these kinds.
        const KINDS: &[u8] = b"09.A \n\x80";
        let mut text = [0; 8];
        for mut index in 0..KINDS.len().pow(8) {
            for place in &mut text {
                *place = KINDS[index % KINDS.len()];
                index /= KINDS.len();
            }
            let run = Run::of_eight(u64::from_le_bytes(text));
            let slow = Run::read_slowly(&text).filter(|run| run.typed_digits < 8);
            assert_eq!(run, slow, "{}", text.escape_ascii());
        }
    }

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
