//! The speeds ordered along a leg, stretch by stretch.
//!
//! Feed per minute is one stretch. Feed per revolution follows the spindle, and that, under constant surface speed,
//! the diameter: stretches so short that the speed changes by a few hundredths on each, as fast as their mean. A
//! spindle that cannot follow the diameter lags behind, and the feed with it: the feed per revolution stays true.

use crate::leg::{Leg, X};
use crate::spindle::SurfaceLaw;
use crate::surface::Slowness;

/// What orders the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// The same all the way, mm/s.
    Speed(f64),
    /// So much a revolution of a spindle that follows the diameter.
    Surface { law: SurfaceLaw, feed_mm_per_rev: f64, slowness: Slowness },
}

impl Order {
    /// The highest speed that is ordered anywhere on a leg, mm/s.
    pub(crate) fn highest(self, leg: &Leg) -> f64 {
        match self {
            Self::Speed(speed) => speed,
            Self::Surface { law, feed_mm_per_rev, .. } => {
                feed_mm_per_rev * law.rpm_at(leg.nearest_mm()) / 60.0
            }
        }
    }
}

/// The spindle that a path is cut with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TurningSpindle {
    /// Real speed, rpm.
    pub(crate) rpm: f64,
    /// Change of speed, rpm per second; 0 for at once.
    pub(crate) ramp_rpm_per_s: f64,
}

/// A stretch on which the speed asked for changes by no more than this.
const RATIO_MAX: f64 = 1.03;

/// Shorter stretches change nothing, mm.
const STRETCH_MIN_MM: f64 = 0.01;

/// Stretches of a leg: with more, a leg of no sensible length would take for ever.
const STRETCHES_MAX: f64 = 8192.0;

/// Gives the stretches of a leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretches {
    order: Order,
    /// The highest speed on the leg, mm/s, whatever is ordered, and its share of the acceleration.
    pub(crate) limit: (f64, f64),
    done_mm: f64,
}

impl Stretches {
    pub(crate) fn new(order: Order, limit: (f64, f64)) -> Self {
        Self { order, limit, done_mm: 0.0 }
    }

    /// Whether the whole leg has been given.
    pub(crate) fn is_done(&self, leg: &Leg) -> bool {
        self.done_mm >= leg.length_mm
    }

    /// Length and ordered speed of the next stretch of the leg.
    pub(crate) fn next(&mut self, leg: &Leg, spindle: &mut TurningSpindle) -> (f64, f64) {
        let rest_mm = leg.length_mm - self.done_mm;
        match self.order {
            Order::Speed(speed) => {
                self.done_mm = leg.length_mm;
                (rest_mm, speed)
            }
            Order::Surface { law, feed_mm_per_rev, slowness } => {
                let x_at = |done_mm: f64| leg.place(done_mm / leg.length_mm)[X];
                let start = law.rpm_at(x_at(self.done_mm));
                let is_even = |length: f64| {
                    [0.5, 1.0].into_iter().all(|part| {
                        let rpm = law.rpm_at(x_at(self.done_mm + length * part));
                        rpm <= start * RATIO_MAX && start <= rpm * RATIO_MAX
                    })
                };
                let mut length = rest_mm;
                let shortest = STRETCH_MIN_MM.max(leg.length_mm / STRETCHES_MAX);
                while length > 2.0 * shortest && !is_even(length) {
                    length /= 2.0;
                }
                // While the spindle is behind, its own speed is what changes along a stretch.
                length = length.min((feed_mm_per_rev * spindle.even_turns(start)).max(shortest));
                let minutes_per_mm = [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)]
                    .map(|(part, weight)| weight * slowness.at(x_at(self.done_mm + length * part)))
                    .iter()
                    .sum::<f64>()
                    / 6.0;
                let end = law.rpm_at(x_at(self.done_mm + length));
                let speed = match spindle.lag(end, length / feed_mm_per_rev) {
                    Some(mean_rpm) => feed_mm_per_rev * mean_rpm / 60.0,
                    None => 1.0 / (60.0 * minutes_per_mm),
                };
                self.done_mm = if length == rest_mm { leg.length_mm } else { self.done_mm + length };
                (length, speed)
            }
        }
    }
}

impl TurningSpindle {
    /// Turns on which the speed changes by little while the spindle is on its way to `rpm`.
    fn even_turns(&self, rpm: f64) -> f64 {
        if self.ramp_rpm_per_s == 0.0 || self.rpm <= rpm * RATIO_MAX && rpm <= self.rpm * RATIO_MAX {
            return f64::INFINITY;
        }
        self.rpm * self.rpm * (RATIO_MAX * RATIO_MAX - 1.0) / (120.0 * self.ramp_rpm_per_s)
    }

    /// Follows to a speed within so many turns of its own; its mean speed when it cannot.
    fn lag(&mut self, rpm: f64, turns: f64) -> Option<f64> {
        let before = self.rpm;
        // With an even ramp the square of the speed grows evenly with the turns: d(n²) = 2·n·dn, n/60·dt = d(turns).
        let change = 120.0 * self.ramp_rpm_per_s * turns;
        let (square, goal) = (before * before, rpm * rpm);
        if self.ramp_rpm_per_s == 0.0 || (goal - square).abs() <= change {
            self.rpm = rpm;
            return None;
        }
        self.rpm = if goal > square { square + change } else { square - change }.sqrt();
        Some((before + self.rpm) / 2.0)
    }
}
