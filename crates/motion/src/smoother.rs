//! The averaging of each axis that lets corners be passed: twice over the time of a corner.
//!
//! In: the place of every tick. Out: the place to be given to the drives. A step of speed at a corner becomes a
//! triangle of acceleration; the corner becomes a curve. Sums are kept in whole numbers, so nothing drifts however
//! long it runs.

use std::collections::VecDeque;

use crate::leg::Place;

/// Ticks that a corner may take: with more samples a second its time is cut short.
const TICKS_MAX: usize = 4096;

/// Whole numbers in a millimetre or degree.
const GRAIN: f64 = 1e9;

/// A running sum of the last ticks.
#[derive(Clone, Debug)]
struct RunningSum {
    last: VecDeque<[i128; 6]>,
    sum: [i128; 6],
}

impl RunningSum {
    fn standing(ticks: usize, value: [i128; 6]) -> Self {
        let mut last = VecDeque::with_capacity(ticks);
        last.extend(std::iter::repeat_n(value, ticks));
        Self { last, sum: value.map(|value| value * ticks as i128) }
    }

    fn fill(&mut self, value: [i128; 6]) {
        self.last.iter_mut().for_each(|last| *last = value);
        self.sum = value.map(|value| value * self.last.len() as i128);
    }

    fn next(&mut self, value: [i128; 6]) -> [i128; 6] {
        if let Some(oldest) = self.last.pop_front() {
            self.last.push_back(value);
            for ((sum, value), oldest) in self.sum.iter_mut().zip(value).zip(oldest) {
                *sum += value - oldest;
            }
        }
        self.sum
    }
}

/// Averages places.
#[derive(Clone, Debug)]
pub(crate) struct Smoother {
    ticks: usize,
    once: RunningSum,
    twice: RunningSum,
}

impl Smoother {
    /// For corners that take `corner_s` and a tick of `tick_s`.
    pub(crate) fn new(corner_s: f64, tick_s: f64) -> Self {
        let ticks = ((corner_s / tick_s).round() as usize).clamp(1, TICKS_MAX);
        let zero = [0; 6];
        Self { ticks, once: RunningSum::standing(ticks, zero), twice: RunningSum::standing(ticks, zero) }
    }

    /// The tool stands.
    pub(crate) fn stand(&mut self, place: &Place) {
        let grains = grains(place);
        self.once.fill(grains);
        self.twice.fill(grains.map(|value| value * self.ticks as i128));
    }

    /// The next tick.
    pub(crate) fn next(&mut self, place: &Place) -> Place {
        let sum = self.twice.next(self.once.next(grains(place)));
        let scale = (self.ticks * self.ticks) as f64;
        sum.map(|sum| sum as f64 / scale / GRAIN)
    }

    /// Ticks by which a steady motion comes out later.
    pub(crate) const fn delay_ticks(&self) -> usize {
        self.ticks - 1
    }
}

fn grains(place: &Place) -> [i128; 6] {
    place.map(|value| (value * GRAIN).round() as i128)
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
    fn at_rest_it_is_exact() {
        let place = [12.345_678_9, -3.0, 0.0, 90.0, 0.0, 0.0];
        let mut smoother = Smoother::new(0.01, 1e-3);
        smoother.stand(&place);
        assert_eq!(smoother.next(&place), place);
        assert_eq!(smoother.delay_ticks(), 9);
    }
}
