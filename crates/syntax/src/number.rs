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
    /// Digits typed, leading zeros included (saturating).
    pub typed_digits: u8,
    /// A point was typed.
    pub has_point: bool,
    /// A minus was typed, also before a zero.
    pub is_negative: bool,
}

impl Decimal {
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
    fn scaling_keeps_or_cuts() {
        let number =
            Decimal { digits: -12_345, scale: 3, typed_digits: 5, has_point: true, is_negative: true };
        assert_eq!(number.scaled(3), Some((-12_345, false)));
        assert_eq!(number.scaled(6), Some((-12_345_000, false)));
        assert_eq!(number.scaled(1), Some((-123, true)));
        assert_eq!(Decimal { digits: i64::MAX, ..number }.scaled(9), None);
    }
}
