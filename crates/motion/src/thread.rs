//! Threads: an axis in step with the spindle.
//!
//! In: the way along the long axis, the leads, the speed of the spindle at the start. Out: the place as a function of
//! the angle that the spindle has turned since the start, and by how much the start comes before the start angle.
//!
//! The clock of a thread is the spindle. The ramps are planned for its speed at the start and then run through by its
//! angle, so that the tool stays on the helix however the speed wobbles. Speeding up costs less way than a nut would
//! have made; the start therefore comes that much before its angle, and the helix is the same at any speed.

use turnwright_canon::{Action, Command};

use crate::clock::Timing;
use crate::dynamics::Dynamics;
use crate::planner::{Phase, Phases, RunLimits};

/// A stretch of a thread along its long axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadStretch {
    /// Way, mm.
    pub way_mm: f64,
    /// Lead at its start, mm per revolution.
    pub lead_mm: f64,
    /// Lead at its end; between, it changes evenly with the revolutions.
    pub lead_end_mm: f64,
    /// Limits on this stretch.
    pub limits: RunLimits,
    /// The fastest that the axes can go along it, mm/s.
    pub limit_mm_per_s: f64,
}

/// Why a thread cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThreadFault {
    /// Lead × speed is above what the axes can do, mm/s.
    TooFast {
        /// What it asks for.
        needed_mm_per_s: f64,
        /// What they can do.
        limit_mm_per_s: f64,
    },
    /// No lead, no way, or the spindle stands.
    NoMotion,
    /// The ramps need more way than there is, mm.
    TooShort {
        /// Of both ramps.
        needed_mm: f64,
        /// Of the stretch.
        way_mm: f64,
    },
}

/// A chain of thread stretches, planned.
#[derive(Clone, Debug)]
pub struct ThreadPlan {
    phases: Phases,
    window_s: f64,
    per_second: f64,
    way_mm: f64,
    seconds: f64,
    advance: f64,
    run_in_mm: f64,
    run_out_mm: f64,
}

impl ThreadPlan {
    /// Plans a chain for a spindle speed.
    ///
    /// # Errors
    /// What makes it impossible.
    pub fn new(stretches: &[ThreadStretch], rpm: f64) -> Result<Self, ThreadFault> {
        let per_second = rpm / 60.0;
        let (Some(first), Some(last)) = (stretches.first(), stretches.last()) else {
            return Err(ThreadFault::NoMotion);
        };
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let is_sound = |stretch: &ThreadStretch| {
            positive(stretch.way_mm) && positive(stretch.lead_mm) && positive(stretch.lead_end_mm)
        };
        if !positive(per_second) || !stretches.iter().all(is_sound) {
            return Err(ThreadFault::NoMotion);
        }
        for stretch in stretches {
            let needed_mm_per_s = stretch.lead_mm.max(stretch.lead_end_mm) * per_second;
            if needed_mm_per_s > stretch.limit_mm_per_s {
                return Err(ThreadFault::TooFast { needed_mm_per_s, limit_mm_per_s: stretch.limit_mm_per_s });
            }
        }
        let least = |of: fn(&RunLimits) -> f64| {
            stretches.iter().map(|stretch| of(&stretch.limits)).fold(f64::INFINITY, f64::min)
        };
        let limits = RunLimits {
            acceleration_mm_per_s2: least(|limits| limits.acceleration_mm_per_s2),
            jerk_mm_per_s3: least(|limits| limits.jerk_mm_per_s3),
        };
        let ends = [first.lead_mm * per_second, last.lead_end_mm * per_second];
        let way_mm: f64 = stretches.iter().map(|stretch| stretch.way_mm).sum();
        let [run_in_mm, run_out_mm] = ends.map(|speed| limits.ramp_mm(speed));
        let mut plan = Self {
            phases: Phases::with_capacity(3 * stretches.len() + 2),
            window_s: limits.window_s(),
            per_second,
            way_mm,
            seconds: 0.0,
            advance: 0.0,
            run_in_mm,
            run_out_mm,
        };
        plan.lay(stretches, limits.acceleration_mm_per_s2)?;
        Ok(plan)
    }

    /// Lays the phases: up to speed, along the stretches, to rest.
    fn lay(&mut self, stretches: &[ThreadStretch], acceleration: f64) -> Result<(), ThreadFault> {
        let per_second = self.per_second;
        let mut cursor = Cursor { time_s: 0.0, at_mm: 0.0, speed: 0.0, phases: &mut self.phases };
        let mut start_mm = 0.0;
        for (index, stretch) in stretches.iter().enumerate() {
            let (from, to) = (stretch.lead_mm * per_second, stretch.lead_end_mm * per_second);
            let change = (to * to - from * from) / (2.0 * stretch.way_mm);
            let speed_at = |way: f64| (from * from + 2.0 * change * way).max(0.0).sqrt();
            // From rest the square of the speed grows by 2a a millimetre, on the thread by 2·change. A change of lead
            // lies half before and half behind the joint: then it costs no turns.
            let joined = if index == 0 {
                from * from / (2.0 * (acceleration - change).max(acceleration / 2.0))
            } else {
                from * ((from - cursor.speed).abs() / acceleration / 2.0)
            };
            let left = match stretches.get(index + 1) {
                Some(next) => to * ((next.lead_mm * per_second - to).abs() / acceleration / 2.0),
                None => to * to / (2.0 * (acceleration + change).max(acceleration / 2.0)),
            };
            if joined + left >= stretch.way_mm {
                return Err(ThreadFault::TooShort { needed_mm: joined + left, way_mm: stretch.way_mm });
            }
            cursor.go(start_mm + joined, speed_at(joined));
            let leaves = speed_at(stretch.way_mm - left);
            cursor.go(start_mm + stretch.way_mm - left, leaves);
            if index == 0 {
                // The averaged motion is half a window behind, and, of a parabola, a little above.
                let here_s = cursor.time_s + self.window_s / 2.0
                    - change * (self.window_s * self.window_s) / 24.0 / leaves;
                let nut_s = 2.0 * (stretch.way_mm - left) / (from + leaves);
                self.advance = per_second * (here_s - nut_s);
            }
            start_mm += stretch.way_mm;
        }
        cursor.go(start_mm, 0.0);
        self.seconds = cursor.time_s + self.window_s;
        Ok(())
    }

    /// Revolutions before the start angle at which the axis must start.
    pub const fn advance(&self) -> f64 {
        self.advance
    }

    /// Revolutions from the start to rest.
    pub fn revolutions(&self) -> f64 {
        self.seconds * self.per_second
    }

    /// Way from the start until the axis is on the helix, mm.
    pub const fn run_in_mm(&self) -> f64 {
        self.run_in_mm
    }

    /// Way from where the axis leaves the helix to its rest, mm.
    pub const fn run_out_mm(&self) -> f64 {
        self.run_out_mm
    }

    /// Way along the long axis after so many revolutions since the start.
    pub fn way_mm(&self, revolutions: f64) -> f64 {
        if revolutions <= 0.0 {
            return 0.0;
        }
        self.phases.mean(revolutions / self.per_second, self.window_s).at_mm.min(self.way_mm)
    }
}

/// Lays phases one behind the other.
struct Cursor<'a> {
    time_s: f64,
    at_mm: f64,
    speed: f64,
    phases: &'a mut Phases,
}

impl Cursor<'_> {
    fn go(&mut self, end_mm: f64, speed: f64) {
        let way_mm = end_mm - self.at_mm;
        if way_mm <= 0.0 {
            return;
        }
        let duration_s = 2.0 * way_mm / (self.speed + speed);
        self.phases.push(Phase {
            start_s: self.time_s,
            duration_s,
            start_mm: self.at_mm,
            end_mm,
            speed: self.speed,
            acceleration: (speed - self.speed) / duration_s,
        });
        self.time_s += duration_s;
        (self.at_mm, self.speed) = (end_mm, speed);
    }
}

/// Time constant of the drives behind the rule of thumb for lead-in, s: the usual 33 ms.
const DRIVE_S: f64 = 1.0 / 30.0;

/// Error of the lead that is taken to be none.
const LEAD_ERROR: f64 = 0.01;

/// The lead-in that a thread needs, mm: what the axis takes to come up to speed, and what a drive that follows with the
/// usual delay takes until the lead is right to a hundredth; the longer of both.
pub fn lead_in_needed_mm(lead_mm: f64, rpm: f64, limits: RunLimits) -> f64 {
    let speed = lead_mm * rpm / 60.0;
    let drives = DRIVE_S * speed * (-1.0 - libm::log(LEAD_ERROR));
    drives.max(limits.ramp_mm(speed))
}

/// The way behind its last full turn that a thread needs, mm: what the axis takes to rest, and what a drive is behind;
/// the longer of both.
pub fn run_out_needed_mm(lead_mm: f64, rpm: f64, limits: RunLimits) -> f64 {
    let speed = lead_mm * rpm / 60.0;
    (DRIVE_S * speed).max(limits.ramp_mm(speed))
}

/// The ways that a thread move needs, mm along its long axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadNeed {
    /// Before the work.
    pub lead_in_mm: f64,
    /// Behind the last full turn.
    pub run_out_mm: f64,
    /// The way in front of Z0, of a move along Z through Z0 into the part: where nobody knows the stock, that is its face.
    pub before_zero_mm: Option<f64>,
}

impl ThreadNeed {
    /// That of a move in step with the spindle.
    pub fn of(command: &Command, timing: &Timing, dynamics: &Dynamics) -> Option<Self> {
        let Action::Thread { to, lead, lead_end, .. } = &command.action else { return None };
        let (rpm, from) = (timing.rpm?.max, timing.from);
        let way = *to - from;
        let [x_mm, z_mm] = [way.x.to_mm().abs(), way.z.to_mm().abs()];
        let long_mm = x_mm.max(z_mm);
        if long_mm == 0.0 {
            return None;
        }
        let limits = dynamics.threading(&[x_mm / long_mm, z_mm / long_mm, 0.0, 0.0, 0.0, 0.0]);
        let lead_end = lead_end.as_deref().copied().unwrap_or(*lead);
        let is_through_zero = x_mm <= z_mm && from.z.to_mm() > 0.0 && to.z.to_mm() < 0.0;
        Some(Self {
            lead_in_mm: lead_in_needed_mm(lead.0.to_mm().abs(), rpm, limits),
            run_out_mm: run_out_needed_mm(lead_end.0.to_mm().abs(), rpm, limits),
            before_zero_mm: is_through_zero.then(|| from.z.to_mm()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: RunLimits = RunLimits { acceleration_mm_per_s2: 1000.0, jerk_mm_per_s3: 1000.0 / 0.03 };

    fn stretch(way_mm: f64, lead_mm: f64, lead_end_mm: f64) -> ThreadStretch {
        ThreadStretch { way_mm, lead_mm, lead_end_mm, limits: LIMITS, limit_mm_per_s: 200.0 }
    }

    #[test]
    fn the_rule_of_thumb_for_lead_in() {
        // Lead 1.5 at 1200 rpm: 30 mm/s, 1 mm in a thirtieth of a second, 3.6 times that for one per cent.
        assert!((lead_in_needed_mm(1.5, 1200.0, LIMITS) - 3.605).abs() < 0.001);
        // The run-out: that millimetre, L·n/1800; the axis alone takes 0.9 mm to rest.
        assert!((run_out_needed_mm(1.5, 1200.0, LIMITS) - 1.0).abs() < 0.001);
        let slow_axis = RunLimits { acceleration_mm_per_s2: 300.0, jerk_mm_per_s3: 10_000.0 };
        assert!((run_out_needed_mm(1.5, 1200.0, slow_axis) - 1.95).abs() < 0.001);
    }

    #[test]
    fn between_the_ramps_the_axis_is_on_the_helix_at_any_speed() {
        for rpm in [200.0, 600.0, 1200.0, 2400.0] {
            let plan = ThreadPlan::new(&[stretch(40.0, 1.5, 1.5)], rpm).expect("a thread");
            let mut on_helix = 0;
            for step in 0..4000 {
                let since_start = plan.revolutions() * f64::from(step) / 4000.0;
                let way = plan.way_mm(since_start);
                if way > plan.run_in_mm() && way < 40.0 - plan.run_out_mm() {
                    let nut = 1.5 * (since_start - plan.advance());
                    assert!((way - nut).abs() < 1e-9, "{rpm} {way} {nut}");
                    on_helix += 1;
                }
            }
            assert!(on_helix > 500, "{rpm} {on_helix}");
            assert!((plan.way_mm(plan.revolutions()) - 40.0).abs() < 1e-9);
        }
    }

    #[test]
    fn leads_that_change_evenly_or_at_a_joint_keep_the_helix() {
        // From 1 to 3 mm over 40: 20 turns, the lead grows by 0.1 a turn: way = N + 0.05·N².
        let plan = ThreadPlan::new(&[stretch(40.0, 1.0, 3.0)], 600.0).expect("a thread");
        // Two leads: 20 turns of 1 mm, then 2 mm each.
        let joint =
            ThreadPlan::new(&[stretch(20.0, 1.0, 1.0), stretch(30.0, 2.0, 2.0)], 600.0).expect("a thread");
        for step in 0..5000 {
            let turns = 20.0 * f64::from(step) / 5000.0;
            let way = turns + 0.05 * turns * turns;
            if way > plan.run_in_mm() + 0.1 && way < 40.0 - plan.run_out_mm() - 0.1 {
                let real = plan.way_mm(turns + plan.advance());
                // Averaging lifts a parabola by a·T²/24 = 0.4 µm here, which the start takes off at one place.
                assert!((real - way).abs() < 4e-4, "{turns} {way} {real}");
            }
            let way = turns.min(20.0) + 2.0 * (turns - 20.0).max(0.0);
            let far = |from: f64| (turns - from).abs() > 0.5;
            if far(0.0) && far(20.0) && turns < 19.0 {
                let real = joint.way_mm(turns + joint.advance());
                assert!((real - way).abs() < 1e-9, "{turns} {way} {real}");
            }
        }
        let real = joint.way_mm(25.0 + joint.advance());
        assert!((real - 30.0).abs() < 1e-9, "{real}");
    }

    #[test]
    fn a_wobbling_spindle_takes_the_axis_along() {
        // Five times a second by three per cent up and down. The ramps take four fifths of what the axis can do; the
        // wobble must fit into the rest.
        let tau = std::f64::consts::TAU;
        for rpm in [200.0, 600.0, 1200.0, 2400.0] {
            let per_second = rpm / 60.0;
            let plan = ThreadPlan::new(&[stretch(120.0, 1.5, 1.5)], rpm).expect("a thread");
            let turns = |time: f64| per_second * (time + 0.03 / (5.0 * tau) * (5.0 * tau * time).sin());
            let mut last = [0.0; 4];
            let mut tick = 0;
            while turns(f64::from(tick) * 1e-3) < plan.revolutions() {
                let since_start = turns(f64::from(tick) * 1e-3);
                let way = plan.way_mm(since_start);
                if way > plan.run_in_mm() && way < 120.0 - plan.run_out_mm() {
                    let nut = 1.5 * (since_start - plan.advance());
                    assert!((way - nut).abs() < 1e-3, "{rpm} {way} {nut}");
                }
                last = [last[1], last[2], last[3], way];
                let [p0, p1, p2, p3] = last;
                let acceleration = (p3 - 2.0 * p2 + p1) * 1e6;
                assert!(acceleration.abs() < LIMITS.acceleration_mm_per_s2 / 0.8, "{rpm} {acceleration}");
                let jerk = (p3 - 3.0 * p2 + 3.0 * p1 - p0) * 1e9;
                assert!(jerk.abs() < LIMITS.jerk_mm_per_s3 / 0.8, "{rpm} {jerk}");
                tick += 1;
            }
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let too_fast = ThreadPlan::new(&[stretch(40.0, 6.0, 6.0)], 2400.0).err();
        assert_eq!(too_fast, Some(ThreadFault::TooFast { needed_mm_per_s: 240.0, limit_mm_per_s: 200.0 }));
        assert_eq!(ThreadPlan::new(&[stretch(40.0, 0.0, 1.0)], 600.0).err(), Some(ThreadFault::NoMotion));
        assert_eq!(ThreadPlan::new(&[stretch(40.0, 1.0, 1.0)], 0.0).err(), Some(ThreadFault::NoMotion));
        let short = ThreadPlan::new(&[stretch(0.5, 3.0, 3.0)], 1200.0).err();
        assert!(matches!(short, Some(ThreadFault::TooShort { .. })), "{short:?}");
    }
}
