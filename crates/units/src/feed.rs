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

/// A spindle angle, in thousandths of a degree as the controls count it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Angle {
    millidegrees: i64,
}

impl Angle {
    /// Zero degrees.
    pub const ZERO: Self = Self { millidegrees: 0 };

    /// From thousandths of a degree.
    pub const fn from_millidegrees(millidegrees: i64) -> Self {
        Self { millidegrees }
    }

    /// Thousandths of a degree.
    pub const fn millidegrees(self) -> i64 {
        self.millidegrees
    }
}

/// A time in seconds.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct Seconds(pub f64);

/// A number of spindle revolutions.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct Revolutions(pub f64);
