//! Corners: how fast legs may follow one another without a stop.
//!
//! In: legs with the speeds ordered on them. Out: caps for the [`Pace`], a few legs later, as corners that lie closer
//! together than the time in which one is passed count together.

use std::collections::VecDeque;

use crate::Dynamics;
use crate::dynamics::AXIS_COUNT;
use crate::leg::{Leg, Place};
use crate::planner::{Full, Pace};

/// Stretches that wait for the corners behind them. With more inside one corner's time, the corner is passed as
/// slowly as if the stretch behind were all corners.
const WAITING_MAX: usize = 64;

/// The orders of an operator may raise speeds by this, so the time of a corner is looked at for speeds so high.
const OVERRIDE_MAX: f64 = 2.54;

/// A stretch of a leg and the corner at its end.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    start_mm: f64,
    end_mm: f64,
    ordered_mm_per_s: f64,
    limit_mm_per_s: f64,
    corner_mm_per_s: f64,
    turn: [f64; AXIS_COUNT],
    bend: [f64; AXIS_COUNT],
    has_corner: bool,
}

/// The legs on their way to the pace.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    waiting: VecDeque<Stretch>,
    end_mm: f64,
    last: Option<(Place, Place)>,
}

impl Corners {
    pub(crate) fn new() -> Self {
        Self { waiting: VecDeque::with_capacity(WAITING_MAX), end_mm: 0.0, last: None }
    }

    pub(crate) fn clear(&mut self) {
        self.waiting.clear();
        (self.end_mm, self.last) = (0.0, None);
    }

    /// The next leg begins: the corner between it and the one before is known.
    pub(crate) fn turn_into(&mut self, leg: &Leg, dynamics: &Dynamics) {
        if let (Some((direction, curvature)), Some(before)) = (self.last, self.waiting.back_mut()) {
            let difference =
                |new: Place, old: Place| std::array::from_fn(|axis| (new[axis] - old[axis]).abs());
            before.turn = difference(leg.direction(0.0), direction);
            before.bend = difference(leg.curvature(0.0), curvature);
            before.has_corner = true;
            self.look_back(dynamics);
        }
        self.last = Some((leg.direction(1.0), leg.curvature(1.0)));
    }

    /// Whether there is room for another stretch; a corner before it is known by now.
    pub(crate) fn has_room(&self) -> bool {
        self.waiting.len() < WAITING_MAX
    }

    /// A stretch of the leg that has begun.
    pub(crate) fn add(&mut self, length_mm: f64, ordered_mm_per_s: f64, limit_mm_per_s: f64) {
        let start_mm = self.end_mm;
        self.end_mm += length_mm;
        self.waiting.push_back(Stretch {
            start_mm,
            end_mm: self.end_mm,
            ordered_mm_per_s,
            limit_mm_per_s,
            corner_mm_per_s: f64::INFINITY,
            turn: [0.0; AXIS_COUNT],
            bend: [0.0; AXIS_COUNT],
            has_corner: false,
        });
    }

    /// Lets the corner just met slow down those that are passed together with it.
    fn look_back(&mut self, dynamics: &Dynamics) {
        let (mut turn, mut bend) = ([0.0; AXIS_COUNT], [0.0; AXIS_COUNT]);
        let mut speeds = [f64::INFINITY; WAITING_MAX];
        let mut oldest = self.waiting.len();
        for (index, stretch) in
            self.waiting.iter().enumerate().rev().filter(|(_, stretch)| stretch.has_corner)
        {
            for axis in 0..AXIS_COUNT {
                turn[axis] += stretch.turn[axis];
                bend[axis] += stretch.bend[axis];
            }
            // So fast the corners from here on are passed within one time, or so slowly that they are not.
            let apart = (self.end_mm - stretch.end_mm) / (2.0 * dynamics.corner_s);
            let together = dynamics.corner_speed(&turn, &bend);
            (oldest, speeds[index]) = (index, together.max(apart));
            if apart >= together {
                break;
            }
        }
        let mut slowest = f64::INFINITY;
        for (stretch, speed) in self.waiting.iter_mut().zip(speeds).skip(oldest) {
            stretch.limit_mm_per_s = stretch.limit_mm_per_s.min(slowest);
            slowest = slowest.min(speed);
            if stretch.has_corner {
                stretch.corner_mm_per_s = stretch.corner_mm_per_s.min(slowest);
            }
        }
    }

    /// Gives to the pace what no later corner can slow down any more; everything when the path is over.
    pub(crate) fn pour(&mut self, pace: &mut Pace, dynamics: &Dynamics, is_over: bool) -> Result<(), Full> {
        while let Some(first) = self.waiting.front().copied() {
            let known_mm = self.end_mm - first.end_mm;
            let apart = known_mm / (2.0 * dynamics.corner_s);
            let fastest = (first.ordered_mm_per_s * OVERRIDE_MAX).min(first.limit_mm_per_s);
            let is_last = self.waiting.len() == 1;
            if !is_over && (is_last || apart < fastest.min(first.corner_mm_per_s) && self.has_room()) {
                return Ok(());
            }
            if !pace.has_room(2) {
                return Err(Full);
            }
            pace.push(first.end_mm - first.start_mm, first.ordered_mm_per_s, first.limit_mm_per_s)?;
            if first.has_corner {
                let is_early = !is_over && apart < first.corner_mm_per_s && apart < fastest;
                let speed = if is_early { apart } else { first.corner_mm_per_s };
                // Slower than its own stretch, or it holds nobody up.
                if speed < fastest {
                    pace.push(0.0, f64::INFINITY, speed)?;
                }
            }
            self.waiting.pop_front();
        }
        Ok(())
    }
}
