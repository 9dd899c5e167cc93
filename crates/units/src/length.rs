//! [`Length`], [`Diameter`], [`Radius`] and the least increments they are rounded to.

use std::fmt;
use std::ops::{Add, AddAssign, Neg, Sub};

/// Nanometres in one millimetre.
const NM_PER_MM: i64 = 1_000_000;

/// The least increment of a control: what its last programmable digit stands for.
///
/// Source: the increment systems IS-A, IS-B and IS-C of both families.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LeastIncrement {
    nm: i64,
}

impl LeastIncrement {
    /// IS-A, metric: 0.01 mm.
    pub const METRIC_A: Self = Self { nm: 10_000 };
    /// IS-B, metric: 0.001 mm.
    pub const METRIC_B: Self = Self { nm: 1_000 };
    /// IS-C, metric: 0.0001 mm.
    pub const METRIC_C: Self = Self { nm: 100 };
    /// IS-A, inch: 0.001 in.
    pub const INCH_A: Self = Self { nm: 25_400 };
    /// IS-B, inch: 0.0001 in.
    pub const INCH_B: Self = Self { nm: 2_540 };
    /// IS-C, inch: 0.00001 in.
    pub const INCH_C: Self = Self { nm: 254 };

    /// Nanometres in one increment; always even.
    pub const fn nm(self) -> i64 {
        self.nm
    }

    /// The increment in millimetres.
    pub fn to_mm(self) -> f64 {
        self.nm as f64 / NM_PER_MM as f64
    }

    /// The increment in inches.
    pub fn to_inches(self) -> f64 {
        self.nm as f64 / (25.4 * NM_PER_MM as f64)
    }

    /// Decimal places that show one metric increment in millimetres: 2, 3 or 4.
    pub const fn metric_decimals(self) -> u8 {
        match self.nm {
            10_000 | 25_400 => 2,
            1_000 | 2_540 => 3,
            _ => 4,
        }
    }
}

/// An exact length: whole nanometres.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Length {
    nm: i64,
}

impl Length {
    /// No length.
    pub const ZERO: Self = Self { nm: 0 };

    /// A length of whole nanometres.
    pub const fn from_nm(nm: i64) -> Self {
        Self { nm }
    }

    /// A length of whole millimetres.
    pub const fn from_mm(mm: i32) -> Self {
        Self { nm: mm as i64 * NM_PER_MM }
    }

    /// `count` least increments, or `None` outside the range.
    pub const fn from_increments(count: i64, increment: LeastIncrement) -> Option<Self> {
        match count.checked_mul(increment.nm) {
            Some(nm) => Some(Self { nm }),
            None => None,
        }
    }

    /// The multiple of `increment` nearest to a computed number of millimetres (halves away from zero);
    /// `None` for a number that is not finite or lies outside the range.
    pub fn from_mm_rounded(mm: f64, increment: LeastIncrement) -> Option<Self> {
        let count = (mm * NM_PER_MM as f64 / increment.nm as f64).round();
        // 2^53: above it a float no longer names every integer.
        if count.abs() < 9.0e15 { Self::from_increments(count as i64, increment) } else { None }
    }

    /// Whole nanometres.
    pub const fn nm(self) -> i64 {
        self.nm
    }

    /// Millimetres as a float, for geometry and time only.
    pub fn to_mm(self) -> f64 {
        self.nm as f64 / NM_PER_MM as f64
    }

    /// Nanometres as a float, for ratios and roots of lengths: exact up to 9,000 km.
    pub const fn to_nm_float(self) -> f64 {
        self.nm as f64
    }

    /// The distance from zero.
    pub const fn abs(self) -> Self {
        Self { nm: self.nm.saturating_abs() }
    }

    /// Whether the distance from zero is less than so many nanometres.
    #[inline]
    pub const fn is_below(self, limit_nm: i64) -> bool {
        -limit_nm < self.nm && self.nm < limit_nm
    }

    /// −1, 0 or 1.
    pub const fn signum(self) -> i64 {
        self.nm.signum()
    }

    /// True for no length at all.
    pub const fn is_zero(self) -> bool {
        self.nm == 0
    }

    /// Half of this length. Exact for every value that a program can give (see the crate's first page).
    pub const fn half(self) -> Self {
        Self { nm: self.nm / 2 }
    }

    /// This length `factor` times.
    pub const fn times(self, factor: i64) -> Self {
        Self { nm: self.nm.saturating_mul(factor) }
    }

    /// The multiple of `increment` nearest to this length, halves away from zero.
    pub const fn rounded(self, increment: LeastIncrement) -> Self {
        const USUAL: i64 = LeastIncrement::METRIC_B.nm;
        const FINE: i64 = LeastIncrement::METRIC_C.nm;
        let step = increment.nm;
        let half = if self.nm < 0 { -(step / 2) } else { step / 2 };
        let sum = self.nm.saturating_add(half);
        // A division by a known number costs little.
        let nm = match step {
            USUAL => sum / USUAL * USUAL,
            FINE => sum / FINE * FINE,
            _ => sum / step * step,
        };
        Self { nm }
    }
}

impl Add for Length {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { nm: self.nm.saturating_add(other.nm) }
    }
}

impl AddAssign for Length {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Length {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { nm: self.nm.saturating_sub(other.nm) }
    }
}

impl Neg for Length {
    type Output = Self;
    fn neg(self) -> Self {
        Self { nm: self.nm.saturating_neg() }
    }
}

impl fmt::Display for Length {
    /// Millimetres without trailing zeros: `12.5`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = Vec::with_capacity(24);
        crate::write_millimetres(&mut text, *self, 6);
        f.write_str(std::str::from_utf8(&text).unwrap_or(""))
    }
}

impl fmt::Debug for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self} mm")
    }
}

/// A distance across the work, as drawings and most X words give it.
///
/// ```compile_fail
/// use turnwright_units::{Diameter, Length, Radius};
/// fn needs_radius(_: Radius) {}
/// needs_radius(Diameter(Length::from_mm(40)));
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Diameter(pub Length);

impl Diameter {
    /// The same place as a radius.
    pub const fn to_radius(self) -> Radius {
        Radius(self.0.half())
    }

    /// Rounded to the increment of a diameter word.
    pub const fn rounded(self, increment: LeastIncrement) -> Self {
        Self(self.0.rounded(increment))
    }
}

impl fmt::Debug for Diameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "d{}", self.0)
    }
}

impl fmt::Display for Diameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "d{}", self.0)
    }
}

/// A distance from the spindle axis: what everything inside computes with.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Radius(pub Length);

impl Radius {
    /// On the spindle axis.
    pub const ZERO: Self = Self(Length::ZERO);

    /// The same place as a diameter.
    pub const fn to_diameter(self) -> Diameter {
        Diameter(self.0.times(2))
    }

    /// Millimetres from the axis, for geometry and time only.
    pub fn to_mm(self) -> f64 {
        self.0.to_mm()
    }
}

impl Add for Radius {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Radius {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Radius {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl fmt::Debug for Radius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "r{}", self.0)
    }
}

impl fmt::Display for Radius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "r{}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [LeastIncrement; 6] = [
        LeastIncrement::METRIC_A,
        LeastIncrement::METRIC_B,
        LeastIncrement::METRIC_C,
        LeastIncrement::INCH_A,
        LeastIncrement::INCH_B,
        LeastIncrement::INCH_C,
    ];

    #[test]
    fn every_increment_halves_exactly() {
        for increment in ALL {
            for count in [-7, -1, 0, 1, 3, 99_999_999] {
                let length = Length::from_increments(count, increment).expect("in range");
                assert_eq!(Diameter(length).to_radius().to_diameter(), Diameter(length));
            }
        }
    }

    #[test]
    fn rounding_goes_to_the_nearest_increment_and_halves_away_from_zero() {
        let unit = LeastIncrement::METRIC_B;
        assert_eq!(Length::from_mm_rounded(27.241_4, unit), Length::from_increments(27_241, unit));
        assert_eq!(Length::from_nm(1_500).rounded(unit), Length::from_nm(2_000));
        assert_eq!(Length::from_nm(-1_500).rounded(unit), Length::from_nm(-2_000));
        assert_eq!(Length::from_nm(1_499).rounded(unit), Length::from_nm(1_000));
    }

    #[test]
    fn what_is_no_number_of_millimetres_is_refused() {
        for mm in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
            assert_eq!(Length::from_mm_rounded(mm, LeastIncrement::METRIC_B), None);
        }
        assert_eq!(Length::from_increments(i64::MAX, LeastIncrement::METRIC_C), None);
    }

    #[test]
    fn the_end_of_the_range_saturates() {
        let end = Length::from_nm(i64::MAX);
        assert_eq!(end + end, end);
        assert_eq!(-Length::from_nm(i64::MIN), end);
    }
}
