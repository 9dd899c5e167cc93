//! A run: legs cut one after the other without a stop, from rest to rest.
//!
//! In: legs and the speeds ordered on them, in any chunks. Out: the place at any time that is planned, and when each
//! leg is over. Nothing is allocated after [`CuttingRun::new`].

use std::collections::VecDeque;

use turnwright_canon::PathMode;

use crate::corners::Corners;
use crate::feedrate::{Order, Stretches, TurningSpindle};
use crate::leg::{Leg, Place};
use crate::planner::{Pace, PathState, RunLimits};
use crate::{AccDec, Dynamics, MachineRates};

/// Legs known at once: the look-ahead.
pub const LEGS_MAX: usize = 2048;

/// A chain of legs.
#[derive(Clone, Debug)]
pub(crate) struct CuttingRun {
    dynamics: Dynamics,
    pub(crate) pace: Pace,
    /// Where each leg that has been taken up ends, mm along the path.
    ends_mm: VecDeque<f64>,
    /// The legs themselves, when anybody asks for places.
    legs: Option<VecDeque<Leg>>,
    end_mm: f64,
    corners: Corners,
    /// The first leg, while there is no other and it is straight.
    only: Option<Leg>,
    /// Corners are cut short, which takes its time at the end too.
    pub(crate) is_rounded: bool,
    /// The last leg, when there are stretches left of it.
    current: Option<(Leg, Stretches)>,
    pub(crate) spindle: TurningSpindle,
    is_over: bool,
    /// Seconds from the end of the profile until the axes stand in position.
    settling_s: f64,
}

impl CuttingRun {
    /// To be played or for its times only; with an operator who may order another speed than the program, or without.
    pub(crate) fn new(dynamics: Dynamics, is_played: bool, has_operator: bool) -> Self {
        Self {
            dynamics,
            pace: Pace::with_capacity(2 * LEGS_MAX, dynamics.cutting(false)),
            ends_mm: VecDeque::with_capacity(LEGS_MAX),
            legs: is_played.then(|| VecDeque::with_capacity(LEGS_MAX)),
            end_mm: 0.0,
            corners: Corners::new(&dynamics, has_operator),
            only: None,
            is_rounded: true,
            current: None,
            spindle: TurningSpindle { rpm: 0.0, ramp_rpm_per_s: 0.0 },
            is_over: true,
            settling_s: 0.0,
        }
    }

    /// Begins a chain at rest.
    pub(crate) fn begin(&mut self, limits: RunLimits, rates: &MachineRates, spindle: TurningSpindle) {
        let fastest = rates.cutting_max_mm_per_min / 60.0;
        self.pace.begin_sharing(limits, fastest, 2.0 * self.dynamics.corner_s);
        self.ends_mm.clear();
        self.legs.iter_mut().for_each(VecDeque::clear);
        self.corners.begin(limits);
        (self.end_mm, self.only, self.is_rounded) = (0.0, None, true);
        (self.current, self.spindle, self.is_over) = (None, spindle, false);
    }

    /// Whether legs can be added.
    pub(crate) fn is_open(&self) -> bool {
        !self.is_over
    }

    /// Whether another leg can be taken up. If not, play or take what is planned, and [`CuttingRun::plan`].
    pub(crate) fn has_room(&self) -> bool {
        self.current.is_none() && self.ends_mm.len() < LEGS_MAX
    }

    /// Takes up a leg, when there is room.
    pub(crate) fn push(&mut self, leg: &Leg, order: Order, limit: (f64, f64)) {
        if self.end_mm > 0.0 || leg.arc.is_some() {
            self.only = None;
        } else {
            self.only = Some(*leg);
        }
        self.end_mm += leg.length_mm;
        self.ends_mm.push_back(self.end_mm);
        self.legs.iter_mut().for_each(|legs| legs.push_back(*leg));
        self.corners.turn_into(leg, limit.0);
        let has_room = self.corners.pour(&mut self.pace, false).is_ok() || self.corners.has_room();
        match order {
            Order::Speed(speed) if has_room => self.corners.add(leg.length_mm, speed, limit),
            _ => {
                self.current = Some((*leg, Stretches::new(order, limit)));
                self.feed();
            }
        }
    }

    /// No more legs come. The corners' averaging runs out, and after an exact stop the axes get into position.
    pub(crate) fn close(&mut self, mode: PathMode) {
        self.is_over = true;
        self.go_straight();
        let in_position_s = if mode == PathMode::ExactStop { self.dynamics.in_position_s } else { 0.0 };
        let rounding_s = if self.is_rounded { 2.0 * self.dynamics.corner_s } else { 0.0 };
        self.settling_s = rounding_s + in_position_s;
    }

    /// A chain of one straight leg is no chain: nothing is kept for corners and bends, and none are rounded.
    fn go_straight(&mut self) {
        let Some(leg) = self.only.filter(|_| self.dynamics.acc_dec == AccDec::Before) else { return };
        let Some([ordered, limit]) = self.corners.only_speeds().filter(|_| self.current.is_none()) else {
            return;
        };
        let direction = std::array::from_fn(|axis| (leg.to[axis] - leg.from[axis]).abs() / leg.length_mm);
        let mut limits = self.dynamics.straight(&direction);
        limits.acceleration_mm_per_s2 = limits.acceleration_mm_per_s2.min(self.dynamics.cutting_mm_per_s2);
        self.pace.begin(limits);
        self.corners.begin(limits);
        // An empty pace has room for one.
        let _ = self.pace.push(leg.length_mm, ordered, limit);
        self.pace.close();
        self.pace.ease();
        self.is_rounded = false;
    }

    /// Seconds from rest to rest, settling included, once all is planned.
    pub(crate) fn duration_s(&self) -> Option<f64> {
        self.pace.duration_s().filter(|_| self.is_over).map(|duration| duration + self.settling_s)
    }

    /// Takes stretches as far as there is room.
    fn feed(&mut self) {
        while let Some((leg, stretches)) = &mut self.current {
            if self.corners.pour(&mut self.pace, false).is_err() && !self.corners.has_room() {
                return;
            }
            let (length, speed) = stretches.next(leg, &mut self.spindle);
            self.corners.add(length, speed, stretches.limit);
            if stretches.is_done(leg) {
                self.current = None;
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
            if self.ends_mm.len() == LEGS_MAX {
                // Legs so short that all of them together are no look-ahead: the nearer half goes on.
                self.pace.plan_until(self.ends_mm[LEGS_MAX / 2]);
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
        let leg = self.ends_mm.iter().position(|end_mm| *end_mm >= state.at_mm);
        let place = match leg.and_then(|index| Some((self.legs.as_ref()?.get(index)?, self.ends_mm[index]))) {
            Some((leg, end_mm)) => {
                leg.place(((state.at_mm - (end_mm - leg.length_mm)) / leg.length_mm).max(0.0))
            }
            None => self.legs.as_ref().and_then(VecDeque::back).map_or([0.0; 6], |last| last.to),
        };
        (place, state)
    }

    /// Forgets what is over at a time, when the tool is at a place; how many legs that are.
    pub(crate) fn forget_before(&mut self, time_s: f64, at_mm: f64) -> usize {
        self.pace.forget_before(time_s);
        let before = self.ends_mm.len();
        while self.ends_mm.len() > 1 && self.ends_mm[0] < at_mm {
            self.forget_leg();
        }
        before - self.ends_mm.len()
    }

    fn forget_leg(&mut self) {
        self.ends_mm.pop_front();
        if let Some(legs) = &mut self.legs {
            legs.pop_front();
        }
    }

    /// The time at which the next leg is over, when that is known, before averaging: half a window later the tool is
    /// there. For clocks; who plays uses [`CuttingRun::at`].
    pub(crate) fn take_end(&mut self) -> Option<f64> {
        let end_mm = *self.ends_mm.front()?;
        let is_last = self.is_over && self.ends_mm.len() == 1;
        let time_s = if is_last {
            self.duration_s()?
        } else if self.pace.planned_mm() >= end_mm {
            self.pace.pass(end_mm) + self.pace.limits().window_s() / 2.0
        } else {
            return None;
        };
        self.forget_leg();
        Some(time_s)
    }
}
