//! What the axes can do beyond their rates: acceleration, jerk, and how corners are passed.
//!
//! A cutting path meets several demands at once: it speeds up, it bends, and at its corners the axes change speed. Each
//! has its share of what an axis can do, so that together they never ask for more. Rapids, and a cut by itself on a
//! straight way, have all of it.

use crate::leg::{Heading, Leg, Place, X, Z};
use crate::planner::{RunLimits, SHARE_MAX, SHARE_MIN, most};

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

/// Shares of acceleration and jerk on a cutting path: at corners, and on the legs between them. Together 1.
const CORNER: f64 = 0.2;
const LEG: f64 = 0.8;

/// What a leg that hardly bends has along it: a little less than its share, so that most arcs are like lines.
const ALONG: f64 = 0.78;

/// Share of jerk where a curvature begins or ends: as much as it takes, from that of corners up to this. Arcs leave it
/// to their ends all the way, lines near them only.
const BEND: f64 = 0.5;

/// Arcs are passed a little slower than they could, so that something is left for speeding up on them.
const ARC: f64 = 0.95;

/// Up to this override the speed ordered on an arc is had, where the machine can; what is left of the acceleration is
/// had along the path.
pub(crate) const ARC_OVERRIDE: f64 = 2.0;

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
            jerk_mm_per_s3: ALONG * least(|axis| axis.jerk_per_s3),
        }
    }

    /// The highest speed on an arc in a plane of two axes, mm/s, and what it leaves along the path, when `wanted` is the
    /// highest speed that anybody will want there.
    ///
    /// At speed v on radius r, with the acceleration a along it, an arc takes the acceleration v²/r towards its centre;
    /// its jerk is v³/r² against the way and 3·v·a/r across it, beside the jerk along it. Each pair stands at a right
    /// angle: together they stay within the circle of what the weaker axis has.
    pub(crate) fn arc(&self, axes: [usize; 2], radius_mm: f64, along: RunLimits, wanted: f64) -> (f64, f64) {
        if self.acc_dec == AccDec::After {
            return (f64::INFINITY, 1.0);
        }
        let least = |of: fn(&AxisDynamics) -> f64| of(&self.axes[axes[0]]).min(of(&self.axes[axes[1]]));
        let acceleration = LEG * least(|axis| axis.acceleration_per_s2);
        let jerk = (1.0 - BEND) * least(|axis| axis.jerk_per_s3);
        let window_s = along.window_s();
        // With the least share along the path: 0.1² + 0.99² < 1, and of the jerk (0.16 + 0.6)² + (0.16 · 4)² < 1.
        let fastest = (0.99 * acceleration * radius_mm)
            .sqrt()
            .min(libm::cbrt(0.6 * jerk * radius_mm * radius_mm))
            .min(4.0 / 3.0 * radius_mm / window_s);
        let speed = (ARC * fastest).min(wanted);
        let turning = speed / radius_mm;
        let pull = speed * turning / acceleration;
        let (back, across) = (speed * turning * turning / jerk, 3.0 * turning * window_s);
        // (part + back)² + (part · across)² = 1, where part is what is had along the path of what an arc has.
        let width = 1.0 + across * across;
        let jerky = ((back * back + width * (1.0 - back * back)).sqrt() - back) / width;
        let share = (jerky * (1.0 - BEND)).min((1.0 - pull * pull).sqrt() * LEG) / ALONG;
        (speed, share.clamp(SHARE_MIN, 1.0))
    }

    /// What a straight leg that is passed at `speed_mm_per_s` has along the path: each axis gives what it has, so that
    /// a slanted way has more. A short leg, which others reach over, and a slow one, which has its speed at once
    /// anyhow, are like any other: legs that are alike are planned as one.
    pub(crate) fn line_share(&self, leg: &Leg, along: RunLimits, speed_mm_per_s: f64) -> f64 {
        let ramp = along.acceleration_mm_per_s2 * along.window_s();
        if speed_mm_per_s < ramp / 4.0 || leg.length_mm < 2.0 * along.reach_mm(speed_mm_per_s) {
            return 1.0;
        }
        let mut share = self.cutting_mm_per_s2 / along.acceleration_mm_per_s2;
        for (axis, dynamics) in self.axes.iter().enumerate() {
            let way = (leg.to[axis] - leg.from[axis]).abs() / leg.length_mm;
            if way > 0.0 {
                share = share
                    .min(ALONG * dynamics.acceleration_per_s2 / (way * along.acceleration_mm_per_s2))
                    .min(ALONG * dynamics.jerk_per_s3 / (way * along.jerk_mm_per_s3));
            }
        }
        share.clamp(1.0, SHARE_MAX)
    }

    /// What corners ask for.
    pub(crate) fn corner_law(&self) -> CornerLaw {
        let time = self.corner_s;
        let jerk = |axis: usize| CORNER * self.axes[axis].jerk_per_s3;
        let acceleration = |axis: usize| CORNER * self.axes[axis].acceleration_per_s2;
        // Of two corners a time apart the jerks may add up, the accelerations not. Where they may, no corner loses.
        let is_brief = [X, Z].into_iter().all(|axis| jerk(axis) * time >= 2.0 * acceleration(axis));
        let (span, fold) = if is_brief { (time, 2.0) } else { (2.0 * time, 1.0) };
        let step = |axis: usize| acceleration(axis).min(jerk(axis) * time / fold) * time;
        CornerLaw {
            // After interpolation corners are cut short, whatever the speed.
            time_s: if self.acc_dec == AccDec::After { 0.0 } else { span },
            per_turn: std::array::from_fn(|axis| 1.0 / step(axis)),
            per_bend: std::array::from_fn(|axis| 1.0 / (time * jerk(axis))),
            bend_share: BEND / CORNER,
            turn_jerk: std::array::from_fn(|axis| fold * step(axis) / (time * time * jerk(axis))),
        }
    }
}

/// How fast corners may be passed.
///
/// The axes are averaged twice over [`Dynamics::corner_s`], T: a change of speed by v·turn takes an acceleration of
/// v·turn/T and a jerk of v·turn/T², a change of acceleration by v²·bend a jerk of v²·bend/T. The weight that such a
/// change has at an instant falls evenly to both sides, to nothing at T: it is the mean over the windows of length T
/// around that instant. So accelerations are no more than those of all changes within one T; the jerk is that of one T
/// less that of the next, and no more than that of all changes within 2·T.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerLaw {
    /// Corners that lie closer together in time count together, s.
    pub(crate) time_s: f64,
    /// Demand of a change of direction by 1.
    per_turn: Place,
    /// A change of curvature may take so many times as much.
    bend_share: f64,
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
    fn since(&self, earlier: &Self) -> Self {
        let difference =
            |now: &Place, then: &Place| -> Place { std::array::from_fn(|axis| now[axis] - then[axis]) };
        let bends = self.bends.wrapping_sub(earlier.bends);
        Self {
            turn: difference(&self.turn, &earlier.turn),
            bend: difference(&self.bend, &earlier.bend),
            bends,
        }
    }
}

impl CornerLaw {
    /// Adds what a change of heading asks for, where nobody will be faster than `limit`. Gives 1 / the highest speed at
    /// which it is met alone, and the share of the acceleration that it leaves along the path.
    #[inline]
    pub(crate) fn add(&self, sum: &mut Demand, from: &Heading, to: &Heading, limit: f64) -> (f64, f64) {
        let mut turn = Place::default();
        let mut slowness = 0.0;
        for (axis, turn) in turn.iter_mut().enumerate() {
            *turn = (to.direction[axis] - from.direction[axis]).abs() * self.per_turn[axis];
            sum.turn[axis] += *turn;
            slowness = most(slowness, *turn);
        }
        if from.is_bent || to.is_bent { self.add_bend(sum, from, to, limit, &turn) } else { (slowness, 1.0) }
    }

    fn add_bend(
        &self,
        sum: &mut Demand,
        from: &Heading,
        to: &Heading,
        limit: f64,
        turn: &Place,
    ) -> (f64, f64) {
        let bend: Place = std::array::from_fn(|axis| {
            (to.curvature[axis] - from.curvature[axis]).abs() * self.per_bend[axis]
        });
        let wanted = limit * limit * bend.into_iter().fold(0.0, most);
        let part = wanted.clamp(1.0, self.bend_share);
        let corner = Demand { turn: *turn, bend: bend.map(|bend| bend / part), bends: 1 };
        for (sum, bend) in sum.bend.iter_mut().zip(&corner.bend) {
            *sum += bend;
        }
        sum.bends = sum.bends.wrapping_add(1);
        let share = if part > 1.0 { (1.0 - part * CORNER) / ALONG } else { 1.0 };
        (self.slowness(&corner), share)
    }

    /// The highest speed at which the demand of the corners met since it was `earlier` is met.
    #[inline]
    pub(crate) fn speed_since(&self, earlier: &Demand, now: &Demand) -> f64 {
        if now.bends != earlier.bends {
            return 1.0 / self.slowness(&now.since(earlier));
        }
        let turns = now.turn.iter().zip(&earlier.turn).map(|(now, earlier)| now - earlier);
        1.0 / turns.fold(0.0, most)
    }

    /// 1 / the highest speed at which a demand is met.
    fn slowness(&self, demand: &Demand) -> f64 {
        let mut slowness = demand.turn.into_iter().fold(0.0, most);
        if demand.bends > 0 {
            for ((turn, bend), part) in demand.turn.iter().zip(&demand.bend).zip(&self.turn_jerk) {
                // v²·bend + v·turn·part = 1
                let linear = turn * part;
                slowness = most(slowness, (linear + (linear * linear + 4.0 * bend).sqrt()) / 2.0);
            }
        }
        slowness
    }
}

/// A longer time would round corners beyond what any control does, s.
pub const CORNER_S_MAX: f64 = 1.0;
