//! A run: legs cut one after the other without a stop, from rest to rest.
//!
//! In: legs and the speeds ordered on them, in any chunks. Out: the place at any time that is planned, and when each
//! leg is over. Nothing is allocated after [`CuttingRun::new`].

use std::collections::VecDeque;

use turnwright_canon::PathMode;

use crate::Dynamics;
use crate::corners::Corners;
use crate::feedrate::{Order, Stretches, TurningSpindle};
use crate::leg::{Leg, Place};
use crate::planner::{Pace, PathState, RunLimits};

/// Legs known at once: the look-ahead.
pub const LEGS_MAX: usize = 2048;

/// A leg that has been taken up, and where it ends.
#[derive(Clone, Copy, Debug)]
struct Placed {
    leg: Leg,
    end_mm: f64,
}

/// A chain of legs.
#[derive(Clone, Debug)]
pub(crate) struct CuttingRun {
    dynamics: Dynamics,
    pub(crate) pace: Pace,
    legs: VecDeque<Placed>,
    end_mm: f64,
    corners: Corners,
    /// What is left of the last leg.
    current: Option<Stretches>,
    pub(crate) spindle: TurningSpindle,
    is_over: bool,
    /// Seconds from the end of the profile until the axes stand in position.
    settling_s: f64,
}

impl CuttingRun {
    /// For legs that nobody, or an operator, comes between.
    pub(crate) fn new(dynamics: Dynamics, has_operator: bool) -> Self {
        Self {
            dynamics,
            pace: Pace::with_capacity(2 * LEGS_MAX, dynamics.cutting(false)),
            legs: VecDeque::with_capacity(LEGS_MAX),
            end_mm: 0.0,
            corners: Corners::new(&dynamics, has_operator),
            current: None,
            spindle: TurningSpindle { rpm: 0.0, ramp_rpm_per_s: 0.0 },
            is_over: true,
            settling_s: 0.0,
        }
    }

    /// Begins a chain at rest.
    pub(crate) fn begin(&mut self, limits: RunLimits, spindle: TurningSpindle) {
        self.pace.begin(limits);
        self.legs.clear();
        self.corners.clear();
        (self.end_mm, self.current, self.spindle, self.is_over) = (0.0, None, spindle, false);
    }

    /// Whether legs can be added.
    pub(crate) fn is_open(&self) -> bool {
        !self.is_over
    }

    /// Whether another leg can be taken up. If not, play or take what is planned, and [`CuttingRun::plan`].
    pub(crate) fn has_room(&self) -> bool {
        self.current.is_none() && self.legs.len() < LEGS_MAX
    }

    /// Takes up a leg, when there is room.
    pub(crate) fn push(&mut self, leg: &Leg, order: Order, limit_mm_per_s: f64) {
        self.end_mm += leg.length_mm;
        self.legs.push_back(Placed { leg: *leg, end_mm: self.end_mm });
        self.corners.turn_into(leg);
        self.current = Some(Stretches::new(order, limit_mm_per_s));
        self.feed();
    }

    /// No more legs come. The corners' averaging runs out, and after an exact stop the axes get into position.
    pub(crate) fn close(&mut self, mode: PathMode) {
        self.is_over = true;
        let in_position_s = if mode == PathMode::ExactStop { self.dynamics.in_position_s } else { 0.0 };
        self.settling_s = 2.0 * self.dynamics.corner_s + in_position_s;
    }

    /// Seconds from rest to rest, settling included, once all is planned.
    pub(crate) fn duration_s(&self) -> Option<f64> {
        self.pace.duration_s().filter(|_| self.is_over).map(|duration| duration + self.settling_s)
    }

    /// Takes stretches as far as there is room.
    fn feed(&mut self) {
        while let (Some(stretches), Some(last)) = (&mut self.current, self.legs.back()) {
            if self.corners.pour(&mut self.pace, false).is_err() && !self.corners.has_room() {
                return;
            }
            match stretches.next(&last.leg, &mut self.spindle) {
                Some((length, speed)) => self.corners.add(length, speed, stretches.limit_mm_per_s),
                None => self.current = None,
            }
        }
    }

    /// Plans what can be planned.
    pub(crate) fn plan(&mut self) {
        loop {
            self.feed();
            let is_over = self.is_over && self.current.is_none();
            let poured = self.corners.pour(&mut self.pace, is_over).is_ok();
            if poured && is_over {
                self.pace.close();
            }
            if self.legs.len() == LEGS_MAX {
                // Legs so short that all of them together are no look-ahead: the nearer half goes on.
                self.pace.plan_until(self.legs[LEGS_MAX / 2].end_mm);
            } else {
                self.pace.plan();
            }
            if poured || !self.pace.has_room(2) {
                return;
            }
        }
    }

    /// Place and speed at a time.
    pub(crate) fn at(&self, time_s: f64) -> (Place, PathState) {
        let state = self.pace.at(time_s);
        let place = match self.legs.iter().find(|placed| placed.end_mm >= state.at_mm) {
            Some(Placed { leg, end_mm }) => {
                leg.place(((state.at_mm - (end_mm - leg.length_mm)) / leg.length_mm).max(0.0))
            }
            None => self.legs.back().map_or([0.0; 6], |placed| placed.leg.to),
        };
        (place, state)
    }

    /// Forgets what is over at a time; how many legs that are.
    pub(crate) fn forget_before(&mut self, time_s: f64) -> usize {
        self.pace.forget_before(time_s);
        let at_mm = self.pace.at(time_s).at_mm;
        let before = self.legs.len();
        while self.legs.len() > 1 && self.legs[0].end_mm < at_mm {
            self.legs.pop_front();
        }
        before - self.legs.len()
    }

    /// The time at which the next leg is over, when that is known, before averaging: half a window later the tool is
    /// there. For clocks; who plays uses [`CuttingRun::at`].
    pub(crate) fn take_end(&mut self) -> Option<f64> {
        let end_mm = self.legs.front()?.end_mm;
        let is_last = self.is_over && self.legs.len() == 1;
        let time_s = if is_last {
            self.duration_s()?
        } else if self.pace.planned_mm() >= end_mm {
            self.pace.pass(end_mm) + self.pace.limits().window_s() / 2.0
        } else {
            return None;
        };
        self.legs.pop_front();
        Some(time_s)
    }
}
