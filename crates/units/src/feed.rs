//! Feeds, speeds, leads, angles and times.

use crate::Length;

/// A feed in millimetres per minute along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct FeedPerMinute(pub Length);

/// A feed in millimetres per spindle revolution along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct FeedPerRevolution(pub Length);

/// The feed of a cutting move; the mode is part of the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feed {
    /// Millimetres per minute.
    PerMinute(FeedPerMinute),
    /// Millimetres per spindle revolution.
    PerRevolution(FeedPerRevolution),
}

impl Feed {
    /// The number behind the mode: millimetres per minute or per revolution.
    pub const fn length(self) -> Length {
        match self {
            Self::PerMinute(feed) => feed.0,
            Self::PerRevolution(feed) => feed.0,
        }
    }
}

/// The advance of a thread per revolution, along its long axis, radius when that is X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lead(pub Length);

/// Spindle revolutions per minute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Rpm(pub u32);

/// Surface speed: the length of chip that passes the tip in a minute (`S` of constant surface speed).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceSpeed(pub Length);

impl SurfaceSpeed {
    /// From whole metres per minute.
    pub const fn from_m_per_min(metres: u32) -> Self {
        Self(Length::from_nm(metres as i64 * 1_000_000_000))
    }

    /// From whole feet per minute.
    pub const fn from_ft_per_min(feet: u32) -> Self {
        Self(Length::from_nm(feet as i64 * 304_800_000))
    }

    /// Metres per minute.
    pub fn to_m_per_min(self) -> f64 {
        self.0.to_mm() / 1000.0
    }
}

/// An angle of a spindle or of a rotary axis: whole billionths of a degree, so that every least increment of a
/// control is exact. It counts on over full turns and may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Angle {
    nanodegrees: i64,
}

impl Angle {
    /// Zero degrees.
    pub const ZERO: Self = Self { nanodegrees: 0 };

    /// One full turn.
    pub const TURN: Self = Self::from_millidegrees(360_000);

    /// From thousandths of a degree.
    pub const fn from_millidegrees(millidegrees: i64) -> Self {
        Self { nanodegrees: millidegrees.saturating_mul(1_000_000) }
    }

    /// Thousandths of a degree, rounded with halves away from zero.
    pub const fn millidegrees(self) -> i64 {
        let half = if self.nanodegrees < 0 { -500_000 } else { 500_000 };
        self.nanodegrees.saturating_add(half) / 1_000_000
    }

    /// From billionths of a degree.
    pub const fn from_nanodegrees(nanodegrees: i64) -> Self {
        Self { nanodegrees }
    }

    /// Billionths of a degree.
    pub const fn nanodegrees(self) -> i64 {
        self.nanodegrees
    }

    /// A computed angle in radians, rounded to the billionth of a degree; what is no number is zero.
    pub fn from_radians_rounded(radians: f64) -> Self {
        Self { nanodegrees: (radians.to_degrees() * 1e9).round() as i64 }
    }

    /// Degrees, for computing.
    pub fn to_degrees(self) -> f64 {
        self.nanodegrees as f64 / 1e9
    }

    /// Radians, for computing.
    pub fn to_radians(self) -> f64 {
        self.to_degrees().to_radians()
    }

    /// Distance from zero.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self { nanodegrees: self.nanodegrees.saturating_abs() }
    }

    /// The same direction, from zero up to one full turn.
    #[must_use]
    pub const fn within(self, turn: Self) -> Self {
        if turn.nanodegrees <= 0 {
            return self;
        }
        Self { nanodegrees: self.nanodegrees.rem_euclid(turn.nanodegrees) }
    }

    /// The same direction, at most half a turn away from `near`.
    #[must_use]
    pub const fn nearest_to(self, near: Self, turn: Self) -> Self {
        let way = Self { nanodegrees: self.nanodegrees.saturating_sub(near.nanodegrees) }.within(turn);
        let back = if way.nanodegrees * 2 > turn.nanodegrees { turn.nanodegrees } else { 0 };
        Self { nanodegrees: near.nanodegrees.saturating_add(way.nanodegrees - back) }
    }
}

impl std::ops::Add for Angle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { nanodegrees: self.nanodegrees.saturating_add(other.nanodegrees) }
    }
}

impl std::ops::Sub for Angle {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { nanodegrees: self.nanodegrees.saturating_sub(other.nanodegrees) }
    }
}

/// A time in seconds.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct Seconds(pub f64);

/// A number of spindle revolutions.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct Revolutions(pub f64);

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(degrees: i64) -> Angle {
        Angle::from_millidegrees(degrees * 1_000)
    }

    #[test]
    fn a_direction_is_found_on_the_turn_in_work() {
        assert_eq!(degrees(-30).within(Angle::TURN), degrees(330));
        assert_eq!(degrees(10).nearest_to(degrees(350), Angle::TURN), degrees(370));
        assert_eq!(degrees(350).nearest_to(degrees(10), Angle::TURN), degrees(-10));
        assert_eq!(degrees(180).nearest_to(degrees(0), Angle::TURN), degrees(180));
        assert_eq!(degrees(730).nearest_to(degrees(5), Angle::TURN), degrees(10));
    }

    #[test]
    fn thousandths_of_a_degree_are_rounded() {
        assert_eq!(Angle::from_nanodegrees(1_499_999).millidegrees(), 1);
        assert_eq!(Angle::from_nanodegrees(-1_500_000).millidegrees(), -2);
        assert_eq!(Angle::from_radians_rounded(std::f64::consts::PI), degrees(180));
    }
}
