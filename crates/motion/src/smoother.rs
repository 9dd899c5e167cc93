//! The averaging of each axis that lets corners be passed: twice over the time of a corner.
//!
//! Or, on controls that let the axes come behind exponentially, a lag of the first order ([`Lag`]).
//!
//! In: the place of every tick. Out: the place to be given to the drives. A step of speed at a corner becomes a
//! triangle of acceleration; the corner becomes a curve. Sums are kept in whole numbers, so nothing drifts however
//! long it runs.

use crate::dynamics::AXIS_COUNT;
use crate::leg::Place;

/// Ticks that a corner may take: with more samples a second its time is cut short.
const TICKS_MAX: usize = 4096;

/// Whole numbers in a millimetre or degree.
const GRAIN: f64 = 1e9;

/// The last ticks of every axis and their sums, once and twice.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    once: [i128; AXIS_COUNT],
    twice: [i128; AXIS_COUNT],
}

/// Averages places.
#[derive(Clone, Debug)]
pub(crate) struct Smoother {
    last: Vec<Slot>,
    /// The oldest slot.
    next: usize,
    sum: Slot,
    /// What the sums of a millimetre or degree come to.
    scale: f64,
    /// The place where the tool stood.
    rest: Place,
    /// What is given out: of an axis that has not moved since, nothing is added up.
    out: Place,
    has_moved: [bool; AXIS_COUNT],
}

impl Smoother {
    /// For corners that take `corner_s` and a tick of `tick_s`.
    pub(crate) fn new(corner_s: f64, tick_s: f64) -> Self {
        let ticks = ((corner_s / tick_s).round() as usize).clamp(1, TICKS_MAX);
        Self {
            last: vec![Slot::default(); ticks],
            next: 0,
            sum: Slot::default(),
            scale: (ticks * ticks) as f64 * GRAIN,
            rest: [0.0; AXIS_COUNT],
            out: [0.0; AXIS_COUNT],
            has_moved: [false; AXIS_COUNT],
        }
    }

    /// The tool stands.
    pub(crate) fn stand(&mut self, place: &Place) {
        let ticks = self.last.len() as i128;
        let at = place.map(grains);
        let once = at.map(|value| value * ticks);
        self.last.fill(Slot { once: at, twice: once });
        self.sum = Slot { once, twice: once.map(|value| value * ticks) };
        self.rest = *place;
        self.out = self.sum.twice.map(|sum| float(sum) / self.scale);
        self.has_moved = [false; AXIS_COUNT];
    }

    /// The next tick.
    pub(crate) fn next(&mut self, place: &Place) -> Place {
        let oldest = &mut self.last[self.next];
        for (axis, value) in place.iter().enumerate() {
            self.has_moved[axis] |= *value != self.rest[axis];
            if !self.has_moved[axis] {
                continue;
            }
            let value = grains(*value);
            self.sum.once[axis] += value - std::mem::replace(&mut oldest.once[axis], value);
            let once = self.sum.once[axis];
            self.sum.twice[axis] += once - std::mem::replace(&mut oldest.twice[axis], once);
            self.out[axis] = float(self.sum.twice[axis]) / self.scale;
        }
        self.next = if self.next + 1 < self.last.len() { self.next + 1 } else { 0 };
        self.out
    }

    /// Ticks by which a steady motion comes out later.
    pub(crate) const fn delay_ticks(&self) -> usize {
        self.last.len() - 1
    }
}

/// What is left of the way when the axes count as there, mm or degrees: an increment.
pub(crate) const LAG_END: f64 = 1e-3;

/// A lag of the first order of each axis: its speed is what it is behind, over the time constant.
///
/// Between ticks the places go evenly. What an axis is behind then shrinks by the same part in each tick and grows by
/// the same part of the way: exact at the ticks, whatever their rate. As nothing but that is kept, nothing drifts.
#[derive(Clone, Debug)]
pub(crate) struct Lag {
    /// Part of what is behind that is left after a tick.
    keeps: f64,
    /// Part of the way of a tick that is behind at its end.
    adds: f64,
    last: Place,
    behind: Place,
}

impl Lag {
    /// For a time constant and a tick, s.
    pub(crate) fn new(time_s: f64, tick_s: f64) -> Self {
        let ticks = tick_s / time_s;
        let (keeps, adds) = (libm::exp(-ticks), -libm::expm1(-ticks) / ticks);
        Self { keeps, adds, last: [0.0; AXIS_COUNT], behind: [0.0; AXIS_COUNT] }
    }

    /// The tool stands.
    pub(crate) fn stand(&mut self, place: &Place) {
        (self.last, self.behind) = (*place, [0.0; AXIS_COUNT]);
    }

    /// The next tick.
    pub(crate) fn next(&mut self, place: &Place) -> Place {
        let (keeps, adds) = (self.keeps, self.adds);
        for ((behind, to), from) in self.behind.iter_mut().zip(place).zip(&self.last) {
            *behind = *behind * keeps + (to - from) * adds;
        }
        self.last = *place;
        std::array::from_fn(|axis| place[axis] - self.behind[axis])
    }

    /// Where the axes would be with no lag.
    pub(crate) const fn goal(&self) -> Place {
        self.last
    }

    /// Whether nothing is behind.
    pub(crate) fn is_still(&self) -> bool {
        self.behind == [0.0; AXIS_COUNT]
    }

    /// Whether the axes count as there.
    pub(crate) fn has_arrived(&self) -> bool {
        self.behind.iter().all(|behind| behind.abs() <= LAG_END)
    }

    /// Seconds from the end of a way that was gone evenly until the axes count as there: `mm_per_s` is the speed of the
    /// quickest axis, `moving_s` how long it went so.
    pub(crate) fn rest_s(time_s: f64, mm_per_s: f64, moving_s: f64) -> f64 {
        let behind = -mm_per_s * time_s * libm::expm1(-moving_s / time_s);
        if behind > LAG_END { time_s * libm::log(behind / LAG_END) } else { 0.0 }
    }
}

/// A place in whole numbers.
fn grains(value: f64) -> i128 {
    let grains = value * GRAIN;
    let rounded = grains + 0.5f64.copysign(grains);
    // The conversion of long numbers takes long.
    if rounded.abs() < i64::MAX as f64 { (rounded as i64).into() } else { rounded as i128 }
}

fn float(sum: i128) -> f64 {
    if let Ok(sum) = i64::try_from(sum) { sum as f64 } else { float_of_long(sum) }
}

#[cold]
fn float_of_long(sum: i128) -> f64 {
    sum as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_is_rounded_by_a_sixth_of_its_time() {
        // 5 mm/s along X, then along Z; corner 10 ms, tick 0.1 ms: the deviation is the change of speed × T/6.
        let tick = 1e-4;
        let mut smoother = Smoother::new(0.01, tick);
        let mut nearest = f64::INFINITY;
        for index in -400..400 {
            let way = 5.0 * f64::from(index) * tick;
            let out = smoother.next(&[way.min(0.0), way.max(0.0), 0.0, 0.0, 0.0, 0.0]);
            if index > -100 {
                nearest = nearest.min(out[0].hypot(out[1]));
            }
        }
        let expected = 5.0 * 2f64.sqrt() * 0.01 / 6.0;
        assert!((nearest - expected).abs() < 0.02 * expected, "{nearest} {expected}");
    }

    #[test]
    fn an_axis_that_starts_late_and_one_far_away_are_averaged_alike() {
        // Sums of 5 km and 4096 ticks are longer than 64 bits; Z starts when X has long been moving.
        let mut smoother = Smoother::new(1.0, 1e-5);
        let far = 5e6;
        smoother.stand(&[far, far, 0.0, 0.0, 0.0, 0.0]);
        let mut out = Place::default();
        for index in 0..30_000 {
            let (x, z) = (f64::from(index) * 1e-4, f64::from((index - 10_000).max(0)) * 1e-4);
            out = smoother.next(&[far + x, far + z, 0.0, 0.0, 0.0, 0.0]);
        }
        assert!((out[0] - out[1] - 1.0).abs() < 1e-8, "{out:?}");
        assert!((out[0] - far - 1e-4 * (29_999.0 - 4095.0)).abs() < 1e-8, "{out:?}");
    }

    #[test]
    fn a_lag_is_the_exponential_at_every_tick_of_any_rate() {
        // 50 mm/s from rest, time constant 32 ms: v·T·(1 − e^(−t/T)) behind; then at rest v·T·e^(−t/T).
        let (speed, time) = (50.0, 0.032);
        for hz in [250, 1000, 4000] {
            let tick = 1.0 / f64::from(hz);
            let mut lag = Lag::new(time, tick);
            for index in 1..=2 * hz {
                let at_s = f64::from(index) * tick;
                let goal = speed * at_s.min(1.0);
                let out = lag.next(&[goal, -goal, 0.0, 0.0, 0.0, 0.0]);
                let behind = if at_s <= 1.0 {
                    speed * time * (1.0 - (-at_s / time).exp())
                } else {
                    speed * time * (1.0 - (-1.0 / time).exp()) * (-(at_s - 1.0) / time).exp()
                };
                assert!((out[0] - (goal - behind)).abs() < 1e-12 * (1.0 + goal), "{hz} {at_s}: {out:?}");
                assert_eq!(out[0], -out[1]);
                let rest_s = at_s - 1.0 - Lag::rest_s(time, speed, 1.0);
                assert!(
                    at_s <= 1.0 || rest_s.abs() < tick || lag.has_arrived() == (rest_s > 0.0),
                    "{hz} {at_s}"
                );
            }
            // Ten million millimetres later it is as near as ever: nothing has added up.
            let far = 1e7;
            lag.stand(&[far, 0.0, 0.0, 0.0, 0.0, 0.0]);
            for index in 0..200_000 {
                lag.next(&[far + speed * f64::from(index % 1000) * tick, 0.0, 0.0, 0.0, 0.0, 0.0]);
            }
            let out = (0..40 * hz).fold(Place::default(), |_, _| lag.next(&[far, 0.0, 0.0, 0.0, 0.0, 0.0]));
            assert_eq!(out[0], far);
        }
    }

    #[test]
    fn an_arc_shrinks_and_a_corner_is_cut_as_the_formulas_say() {
        let (speed, time, radius, tick) = (50.0, 0.032, 20.0, 1e-3);
        let mut lag = Lag::new(time, tick);
        let mut out = Place::default();
        for index in 0..4000 {
            let angle = speed / radius * f64::from(index) * tick;
            out = lag.next(&[radius * angle.sin(), radius * angle.cos(), 0.0, 0.0, 0.0, 0.0]);
        }
        // Half of T²·v²/r: 64 µm; of the next order, (v·T/r)² times three quarters of it, are 0.4 of them.
        let (shrunk, formula) = (radius - out[0].hypot(out[1]), time * time * speed * speed / radius / 2.0);
        assert!((shrunk - formula).abs() < 6e-3 * formula, "{shrunk} {formula}");
        // A right angle: t seconds behind it the incoming axis is v·T·e^(−t/T) short of it, and the other one has gone
        // v·(t − T·(1 − e^(−t/T))).
        let mut lag = Lag::new(time, 1e-4);
        let (mut nearest, mut expected) = (f64::INFINITY, f64::INFINITY);
        for index in -5000..5000 {
            let way = speed * f64::from(index) * 1e-4;
            let out = lag.next(&[way.min(0.0), way.max(0.0), 0.0, 0.0, 0.0, 0.0]);
            if index >= -2500 {
                nearest = nearest.min(out[0].hypot(out[1]));
            }
            let part = f64::from(index.max(0)) * 1e-4 / time;
            let aside = [(-part).exp(), part - 1.0 + (-part).exp()];
            expected = expected.min(speed * time * aside[0].hypot(aside[1]));
        }
        assert!((nearest - expected).abs() < 1e-3 * expected && nearest > 0.5, "{nearest} {expected}");
    }

    #[test]
    fn at_rest_it_is_exact() {
        let place = [12.345_678_9, -3.0, 0.0, 90.0, 0.0, 0.0];
        let mut smoother = Smoother::new(0.01, 1e-3);
        smoother.stand(&place);
        assert_eq!(smoother.next(&place), place);
        assert_eq!(smoother.delay_ticks(), 9);
    }
}
