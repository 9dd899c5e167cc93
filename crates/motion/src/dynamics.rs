//! What the axes can do beyond their rates: acceleration, jerk, and how corners are passed.
//!
//! A cutting path meets several demands at once: it speeds up, it bends, and at its corners the axes change speed. Each
//! has its share of what an axis can do, so that together they never ask for more. Rapids, alone on a straight way,
//! have all of it.

use crate::leg::{Heading, Place};
use crate::planner::{RunLimits, most};

/// Acceleration and jerk of one axis: mm of slide, or degrees, per s² and s³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDynamics {
    /// mm/s², or degrees/s².
    pub acceleration_per_s2: f64,
    /// mm/s³, or degrees/s³.
    pub jerk_per_s3: f64,
}

impl AxisDynamics {
    /// The limits of a way on which the axis moves by `share` of each millimetre.
    pub(crate) fn along(self, share: f64) -> RunLimits {
        RunLimits {
            acceleration_mm_per_s2: self.acceleration_per_s2 / share,
            jerk_mm_per_s3: self.jerk_per_s3 / share,
        }
    }

    /// Minutes from rest to rest at a rate; `None` when that is no rate.
    pub(crate) fn minutes(self, way: f64, per_minute: f64) -> Option<f64> {
        let seconds = if per_minute > 0.0 && per_minute.is_finite() {
            self.along(1.0).rest_to_rest_s(way, per_minute / 60.0)
        } else {
            return None;
        };
        seconds.is_finite().then_some(seconds / 60.0)
    }
}

/// The axes in the order of [`crate::leg::Place`].
pub const AXIS_COUNT: usize = 6;

/// Where cutting moves get their acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AccDec {
    /// Before interpolation: the path is kept, and its speed follows what the axes can do.
    #[default]
    Before,
    /// After interpolation: the path is given out at its full feed, and each axis comes behind, averaged over twice
    /// [`Dynamics::corner_s`]. Corners and arcs are cut short as on controls that work so; no speed is held down.
    After,
}

/// What the axes of a machine can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics {
    /// Where cutting moves get their acceleration.
    pub acc_dec: AccDec,
    /// X (as a radius), Z, Y, C, B, and the virtual axis of polar and cylindrical interpolation.
    pub axes: [AxisDynamics; AXIS_COUNT],
    /// No cut speeds up faster along its path, mm/s²; infinite: what the axes can do.
    pub cutting_mm_per_s2: f64,
    /// Seconds over which the axes change their speed at a corner of a cutting path: the longer, the faster corners
    /// are passed and the rounder they become.
    pub corner_s: f64,
    /// Seconds after a rapid, and after a move in exact-stop mode, until the axes are in position.
    pub in_position_s: f64,
}

impl Default for Dynamics {
    /// The generic lathe of the data folder; rotary axes and Y those of its turn-mill.
    fn default() -> Self {
        let axis = |acceleration_per_s2, jerk_per_s3| AxisDynamics { acceleration_per_s2, jerk_per_s3 };
        let (slide, rotary) = (axis(3_000.0, 150_000.0), axis(3_000.0, 60_000.0));
        Self {
            acc_dec: AccDec::Before,
            axes: [slide, slide, axis(2_000.0, 100_000.0), rotary, axis(1_000.0, 20_000.0), slide],
            cutting_mm_per_s2: f64::INFINITY,
            corner_s: 0.01,
            in_position_s: 0.02,
        }
    }
}

/// Shares of acceleration on a cutting path: along it, towards the centres of arcs, at corners. Together 1.
const ALONG: f64 = 0.25;
const BENDING: f64 = 0.4;
const CORNER: f64 = 0.35;

/// Shares of jerk on a cutting path. Together 1.
const JERK_ALONG: f64 = 0.3;
const JERK_BENDING: f64 = 0.45;
const JERK_CORNER: f64 = 0.25;

/// Acceleration after interpolation: before it the path gets its feed as good as at once, mm/s² and mm/s³.
const AT_ONCE: RunLimits = RunLimits { acceleration_mm_per_s2: 1e6, jerk_mm_per_s3: 1e10 };

/// Share of acceleration and jerk for the ramps of a thread.
const THREADING: f64 = 0.8;

impl Dynamics {
    /// The key of the first value that no machine can have.
    pub fn first_fault(&self) -> Option<&'static str> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let is_sound = |axis: &AxisDynamics| positive(axis.acceleration_per_s2) && positive(axis.jerk_per_s3);
        if !self.axes.iter().all(is_sound) {
            return Some("acceleration");
        }
        if self.cutting_mm_per_s2.is_nan() || self.cutting_mm_per_s2 <= 0.0 {
            return Some("acceleration_cutting_mm_per_s2");
        }
        if !positive(self.corner_s) || self.corner_s > CORNER_S_MAX {
            return Some("corner_s");
        }
        let in_position = self.in_position_s;
        (!(in_position.is_finite() && in_position >= 0.0)).then_some("in_position_s")
    }

    /// The limits on a straight way, from rest to rest, along a direction: each axis has all of its own.
    pub(crate) fn straight(&self, direction: &[f64; AXIS_COUNT]) -> RunLimits {
        let mut limits = RunLimits { acceleration_mm_per_s2: f64::INFINITY, jerk_mm_per_s3: f64::INFINITY };
        for (axis, share) in self.axes.iter().zip(direction).filter(|(_, share)| **share != 0.0) {
            let along = axis.along(share.abs());
            limits.acceleration_mm_per_s2 = limits.acceleration_mm_per_s2.min(along.acceleration_mm_per_s2);
            limits.jerk_mm_per_s3 = limits.jerk_mm_per_s3.min(along.jerk_mm_per_s3);
        }
        limits
    }

    /// The limits of a move in step with the spindle, along its long axis: `direction` is the way of each axis for a
    /// millimetre of that one. What is left over follows the spindle where its speed is not even.
    pub(crate) fn threading(&self, direction: &[f64; AXIS_COUNT]) -> RunLimits {
        let RunLimits { acceleration_mm_per_s2, jerk_mm_per_s3 } = self.straight(direction);
        RunLimits {
            acceleration_mm_per_s2: THREADING * acceleration_mm_per_s2,
            jerk_mm_per_s3: THREADING * jerk_mm_per_s3,
        }
    }

    /// The limits along a cutting path on X and Z, whatever its direction; of other axes when they move along.
    pub(crate) fn cutting(&self, with_others: bool) -> RunLimits {
        if self.acc_dec == AccDec::After {
            return AT_ONCE;
        }
        let count = if with_others { AXIS_COUNT } else { 2 };
        let least =
            |of: fn(&AxisDynamics) -> f64| self.axes[..count].iter().map(of).fold(f64::INFINITY, f64::min);
        RunLimits {
            acceleration_mm_per_s2: (ALONG * least(|axis| axis.acceleration_per_s2))
                .min(self.cutting_mm_per_s2),
            jerk_mm_per_s3: JERK_ALONG * least(|axis| axis.jerk_per_s3),
        }
    }

    /// The highest speed on an arc in a plane of two axes, mm/s.
    ///
    /// Acceleration towards the centre: v²/r. Jerk: 3·v·a/r while the speed changes by `a`, and v³/r² always; each has
    /// half of the share.
    pub(crate) fn arc_speed(&self, axes: [usize; 2], radius_mm: f64, along: RunLimits) -> f64 {
        if self.acc_dec == AccDec::After {
            return f64::INFINITY;
        }
        let least = |of: fn(&AxisDynamics) -> f64| of(&self.axes[axes[0]]).min(of(&self.axes[axes[1]]));
        let acceleration = BENDING * least(|axis| axis.acceleration_per_s2);
        let jerk = JERK_BENDING / 2.0 * least(|axis| axis.jerk_per_s3);
        (acceleration * radius_mm)
            .sqrt()
            .min(jerk * radius_mm / (3.0 * along.acceleration_mm_per_s2))
            .min(libm::cbrt(jerk * radius_mm * radius_mm))
    }

    /// What corners ask for.
    pub(crate) fn corner_law(&self) -> CornerLaw {
        let time = self.corner_s;
        let jerk = |axis: usize| JERK_CORNER * self.axes[axis].jerk_per_s3;
        let step = |axis: usize| (CORNER * self.axes[axis].acceleration_per_s2).min(jerk(axis) * time) * time;
        CornerLaw {
            // After interpolation corners are cut short, whatever the speed.
            time_s: if self.acc_dec == AccDec::After { 0.0 } else { 2.0 * time },
            per_turn: std::array::from_fn(|axis| 1.0 / step(axis)),
            per_bend: std::array::from_fn(|axis| 1.0 / (time * jerk(axis))),
            turn_jerk: std::array::from_fn(|axis| step(axis) / (time * time * jerk(axis))),
        }
    }
}

/// How fast corners may be passed.
///
/// The axes are averaged twice over [`Dynamics::corner_s`], T: a change of speed by v·turn takes an acceleration of
/// v·turn/T and a jerk of v·turn/T², a change of acceleration by v²·bend a jerk of v²·bend/T.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerLaw {
    /// Seconds in which a corner is passed: those that lie closer together count together.
    pub(crate) time_s: f64,
    /// Demand of a change of direction by 1.
    per_turn: Place,
    /// Demand of a change of curvature by 1.
    per_bend: Place,
    /// Part of the jerk that a change of direction takes at the speed that its demand allows.
    turn_jerk: Place,
}

/// What corners ask of each axis, added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Demand {
    /// Of acceleration, and of jerk as far as directions change: 1 / the speed that is allowed, s/mm.
    turn: Place,
    /// Of jerk where curvatures change: 1 / the square of the speed that would be allowed, s²/mm².
    bend: Place,
    /// How many of the corners have such a change.
    bends: u32,
}

impl Demand {
    /// That of the corners met since it was `earlier`.
    pub(crate) fn since(&self, earlier: &Self) -> Self {
        let difference =
            |now: &Place, then: &Place| -> Place { std::array::from_fn(|axis| now[axis] - then[axis]) };
        let bends = self.bends.wrapping_sub(earlier.bends);
        let bend = if bends > 0 { difference(&self.bend, &earlier.bend) } else { Place::default() };
        Self { turn: difference(&self.turn, &earlier.turn), bend, bends }
    }
}

impl CornerLaw {
    /// Adds what a change of heading asks for.
    pub(crate) fn add(&self, sum: &mut Demand, from: &Heading, to: &Heading) {
        let weigh = |sum: &mut Place, from: &Place, to: &Place, weights: &Place| {
            for axis in 0..AXIS_COUNT {
                sum[axis] += (to[axis] - from[axis]).abs() * weights[axis];
            }
        };
        weigh(&mut sum.turn, &from.direction, &to.direction, &self.per_turn);
        if from.is_bent || to.is_bent {
            weigh(&mut sum.bend, &from.curvature, &to.curvature, &self.per_bend);
            sum.bends = sum.bends.wrapping_add(1);
        }
    }

    /// The highest speed at which a demand is met.
    pub(crate) fn speed(&self, demand: &Demand) -> f64 {
        let mut slowness = demand.turn.into_iter().fold(0.0, most);
        if demand.bends > 0 {
            for ((turn, bend), part) in demand.turn.iter().zip(&demand.bend).zip(&self.turn_jerk) {
                // v²·bend + v·turn·part = 1
                let linear = turn * part;
                slowness = most(slowness, (linear + (linear * linear + 4.0 * bend).sqrt()) / 2.0);
            }
        }
        1.0 / slowness
    }
}

/// A longer time would round corners beyond what any control does, s.
pub const CORNER_S_MAX: f64 = 1.0;
