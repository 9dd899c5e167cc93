//! The planner: how fast a path is taken when acceleration and jerk are limited.
//!
//! A [`Pace`] takes caps of speed along one path and gives place and speed at any time:
//!
//! ```text
//! caps ──widen──▶ spans ──backward, forward──▶ knots ──flatten──▶ profile ──▶ phases ──mean──▶ place at a time
//! ```
//!
//! The profile has limited acceleration; averaged over a window of acceleration / jerk, it has limited jerk. For the
//! average to keep the caps they are widened first (`caps.rs`); for the jerk to stay limited tops are made to last as
//! long as the window (`peaks.rs`). Each stage is linear in the number of caps and allocates nothing.

mod caps;
mod pace;
mod peaks;
mod phases;
mod reach;

pub use caps::{Cap, Feedrate, SHARE_MAX, SHARE_MIN, SPEED_MIN_MM_PER_S};
pub use pace::{Full, Pace, RunLimits};
pub use phases::PathState;
pub(crate) use phases::{Phase, Phases};

/// The smaller of two numbers. As `f64::min` but for what is no number, which never comes here; quicker.
pub(crate) const fn least(one: f64, other: f64) -> f64 {
    if one < other { one } else { other }
}

/// The larger of two numbers, likewise.
pub(crate) const fn most(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}
