//! Rigid tapping: the axis and the spindle that is led with it, from rest to rest.
//!
//! The tap goes by the lead a turn, whatever the speed: the place of the axis gives the angle of the spindle. Both speed up
//! and slow down together, as fast as the slower of them can, so that neither overshoots where the spindle turns round.

use turnwright_units::{Lead, Position, WorkTip};

use crate::clock::Clock;
use crate::leg::{X, Z};
use crate::planner::RunLimits;
use crate::spindle::RPM_FENCE;

/// A way of a tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TapPace {
    /// Along the hole, mm.
    pub(crate) way_mm: f64,
    /// Where the spindle has the speed asked for, mm/s.
    pub(crate) speed_mm_per_s: f64,
    /// Of axis and spindle together; infinite when neither has any.
    pub(crate) limits: RunLimits,
    /// mm per revolution.
    pub(crate) lead_mm: f64,
}

impl TapPace {
    /// The way from where the clock is; `None` when nothing would turn or move.
    pub(crate) fn new(clock: &Clock, to: Position<WorkTip>, lead: Lead) -> Option<Self> {
        let (from, lead_mm) = (clock.position(), lead.0.to_mm().abs());
        let way = to - from;
        let ways = [way.x.to_mm().abs(), way.z.to_mm().abs()];
        let way_mm = ways[X].max(ways[Z]);
        let rpm = clock.spindle_order().rpm_at(from.x.to_mm());
        let speed_mm_per_s = match clock.dry_thread() {
            // In a dry run the spindle is led at the speed of the axis, as far as it can follow.
            Some(dry) => {
                let rpm_max = clock.rates().rpm_max.map_or(RPM_FENCE, |rpm| f64::from(rpm.0));
                dry.min(lead_mm * rpm_max) / 60.0
            }
            None => lead_mm * rpm / 60.0,
        };
        if !(way_mm > 0.0 && speed_mm_per_s > 0.0 && speed_mm_per_s.is_finite()) {
            return None;
        }
        let mut limits = RunLimits { acceleration_mm_per_s2: f64::INFINITY, jerk_mm_per_s3: f64::INFINITY };
        if let Some(dynamics) = &clock.rates().dynamics {
            limits = dynamics.straight(&[ways[X] / way_mm, ways[Z] / way_mm, 0.0, 0.0, 0.0, 0.0]);
        }
        let ramp = clock.spindle().ramp_rpm_per_s();
        if ramp > 0.0 {
            limits.acceleration_mm_per_s2 = limits.acceleration_mm_per_s2.min(lead_mm * ramp / 60.0);
        }
        Some(Self { way_mm, speed_mm_per_s, limits, lead_mm })
    }

    /// From rest to rest.
    pub(crate) fn seconds(&self) -> f64 {
        if self.limits.acceleration_mm_per_s2.is_finite() {
            self.limits.rest_to_rest_s(self.way_mm, self.speed_mm_per_s)
        } else {
            self.way_mm / self.speed_mm_per_s
        }
    }

    /// The fastest that the spindle turns: a short hole ends before it has its speed, rpm.
    pub(crate) fn peak_rpm(&self) -> f64 {
        let highest = (self.limits.acceleration_mm_per_s2 * self.way_mm).sqrt();
        60.0 * self.speed_mm_per_s.min(highest) / self.lead_mm
    }
}
