//! What time is spent on, and sums that are exact.
//!
//! Each command's share of each cause is rounded once to the nanosecond; from there on times are whole numbers, so
//! that causes, blocks, operations and tools add up to the same total in whatever order they are summed.

use std::time::Duration;

use crate::Timing;

/// What time is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Positioning.
    Rapid,
    /// A cutting move.
    Cutting,
    /// A move in step with the spindle.
    Threading,
    /// Standing still by order.
    Dwell,
    /// A new tool number.
    ToolChange,
    /// A new speed of the spindle, ordered by a block of its own.
    Spindle,
    /// A cut's wait until the spindle has its speed.
    SpindleWait,
    /// Waiting for cycle start.
    Stop,
    /// A new piece: bar feed, loading and unloading.
    Loading,
    /// Everything else: coolant, auxiliary functions, messages.
    Other,
}

impl Kind {
    /// All of them, the moves first.
    pub const ALL: [Self; 10] = [
        Self::Cutting,
        Self::Threading,
        Self::Rapid,
        Self::Dwell,
        Self::ToolChange,
        Self::Spindle,
        Self::SpindleWait,
        Self::Stop,
        Self::Loading,
        Self::Other,
    ];

    /// The word in tables for scripts.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Cutting => "cutting",
            Self::Threading => "threading",
            Self::Dwell => "dwell",
            Self::ToolChange => "tool-change",
            Self::Spindle => "spindle",
            Self::SpindleWait => "spindle-wait",
            Self::Stop => "stop",
            Self::Loading => "loading",
            Self::Other => "other",
        }
    }
}

/// Some 30,000 years: nothing counts longer, so that sums stay numbers.
pub(crate) const SECONDS_MAX: f64 = 1e12;

/// Seconds as a time in whole nanoseconds; what is no time is none.
pub(crate) fn duration(seconds: f64) -> Duration {
    if seconds == 0.0 {
        return Duration::ZERO;
    }
    let counted = if seconds > SECONDS_MAX { SECONDS_MAX } else { seconds };
    Duration::try_from_secs_f64(counted).unwrap_or_default()
}

impl Timing {
    /// The time, split by what it is spent on.
    pub fn parts(&self) -> [(Kind, Duration); 2] {
        let waited_s = self.waited_s.clamp(0.0, self.seconds.max(0.0));
        [(self.kind, duration(self.seconds - waited_s)), (Kind::SpindleWait, duration(waited_s))]
    }

    /// The sum of the [`parts`](Self::parts).
    pub fn time(&self) -> Duration {
        let [(_, spent), (_, waited)] = self.parts();
        spent.saturating_add(waited)
    }
}

/// Sums of times and lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// By [`Kind`], in its order.
    times: [Duration; Kind::ALL.len()],
    /// Millimetres by [`Kind`], in its order.
    length_mm: [f64; Kind::ALL.len()],
}

impl Totals {
    /// Adds one command.
    pub fn add(&mut self, timing: &Timing) {
        for (kind, time) in timing.parts() {
            let sum = &mut self.times[kind as usize];
            *sum = sum.saturating_add(time);
        }
        self.length_mm[timing.kind as usize] += timing.length_mm;
    }

    /// Adds other sums.
    pub fn add_all(&mut self, other: &Self) {
        for (sum, time) in self.times.iter_mut().zip(&other.times) {
            *sum = sum.saturating_add(*time);
        }
        for (sum, length) in self.length_mm.iter_mut().zip(&other.length_mm) {
            *sum += length;
        }
    }

    /// Time spent on one kind.
    pub const fn time(&self, kind: Kind) -> Duration {
        self.times[kind as usize]
    }

    /// Seconds spent on one kind.
    pub const fn seconds(&self, kind: Kind) -> f64 {
        self.time(kind).as_secs_f64()
    }

    /// Length of the path of one kind, mm.
    pub const fn length_mm(&self, kind: Kind) -> f64 {
        self.length_mm[kind as usize]
    }

    /// Time in all.
    pub fn total(&self) -> Duration {
        self.times.iter().fold(Duration::ZERO, |sum, time| sum.saturating_add(*time))
    }

    /// Seconds in all.
    pub fn total_s(&self) -> f64 {
        self.total().as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use turnwright_units::{Length, Position, Radius};

    use super::*;

    #[test]
    fn every_kind_has_its_place() {
        let mut seen = [false; Kind::ALL.len()];
        Kind::ALL.iter().for_each(|kind| seen[*kind as usize] = true);
        assert_eq!(seen, [true; Kind::ALL.len()]);
    }

    #[test]
    fn a_wait_is_the_spindles() {
        let timing = Timing {
            kind: Kind::Cutting,
            from: Position::new(Radius::ZERO, Length::ZERO),
            seconds: 3.25,
            waited_s: 1.25,
            length_mm: 7.0,
            rpm: None,
        };
        let mut totals = Totals::default();
        totals.add(&timing);
        assert_eq!((totals.seconds(Kind::Cutting), totals.seconds(Kind::SpindleWait)), (2.0, 1.25));
        assert_eq!((totals.total(), totals.length_mm(Kind::Cutting)), (timing.time(), 7.0));
        // What is no time adds nothing.
        totals.add(&Timing { seconds: f64::NAN, waited_s: 0.0, ..timing });
        totals.add(&Timing { seconds: -1.0, waited_s: 0.5, ..timing });
        assert_eq!(totals.total_s(), 3.25);
    }
}
