//! Phases of constant acceleration, and their running mean.
//!
//! In: phases, one behind the other in time. Out: place and speed at any time, averaged over the window before it:
//! the acceleration of the mean grows evenly where that of the phases jumps, so the jerk is limited.

use std::collections::VecDeque;

/// A stretch of time with one acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Phase {
    pub(crate) start_s: f64,
    pub(crate) duration_s: f64,
    pub(crate) start_mm: f64,
    pub(crate) end_mm: f64,
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
}

impl Phase {
    pub(crate) fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    /// Way after `time` in the phase.
    fn way(&self, time: f64) -> f64 {
        time * (self.speed + self.acceleration * time / 2.0)
    }

    /// Place at a time of the clock.
    pub(crate) fn place(&self, at_s: f64) -> f64 {
        self.start_mm + self.way(at_s - self.start_s)
    }

    /// Speed at a time of the clock.
    pub(crate) fn speed(&self, at_s: f64) -> f64 {
        self.speed + self.acceleration * (at_s - self.start_s)
    }

    /// Seconds from the start of the phase to a place in it.
    pub(crate) fn time_to(&self, place_mm: f64) -> f64 {
        let way = place_mm - self.start_mm;
        let speed_square = self.speed * self.speed + 2.0 * self.acceleration * way;
        let sum = self.speed + speed_square.max(0.0).sqrt();
        if sum > 0.0 { (2.0 * way / sum).clamp(0.0, self.duration_s) } else { 0.0 }
    }

    /// The integral over time of the distance from `base_mm`, between two times of the clock.
    fn integral(&self, base_mm: f64, from_s: f64, to_s: f64) -> f64 {
        let (from, time) = (from_s - self.start_s, to_s - from_s);
        let speed = self.speed + self.acceleration * from;
        let start = self.start_mm - base_mm + self.way(from);
        time * (start + time * (speed / 2.0 + self.acceleration * time / 6.0))
    }
}

/// Place and speed on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Place, mm along the path.
    pub at_mm: f64,
    /// Speed, mm/s.
    pub speed_mm_per_s: f64,
}

/// The phases that still count.
#[derive(Clone, Debug)]
pub(crate) struct Phases {
    list: VecDeque<Phase>,
    capacity: usize,
    /// Where the tool stood before the first phase, and where it stands behind the last.
    ends_mm: [f64; 2],
}

impl Phases {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        Self { list: VecDeque::with_capacity(capacity), capacity, ends_mm: [0.0; 2] }
    }

    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.ends_mm = [0.0; 2];
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(crate) fn is_full(&self) -> bool {
        self.list.len() == self.capacity
    }

    pub(crate) fn push(&mut self, phase: Phase) {
        debug_assert!(!self.is_full());
        self.list.push_back(phase);
        self.ends_mm[1] = phase.end_mm;
    }

    /// Lengthens the last phase when it is one of this speed all along; its new end in time.
    pub(crate) fn extend(&mut self, end_mm: f64, speed: f64) -> Option<f64> {
        let last = self.list.back_mut()?;
        let is_same = speed > 0.0 && last.acceleration == 0.0 && last.speed == speed;
        is_same.then(|| {
            (last.end_mm, last.duration_s) = (end_mm, (end_mm - last.start_mm) / speed);
            self.ends_mm[1] = end_mm;
            last.end_s()
        })
    }

    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = &Phase> {
        self.list.iter()
    }

    pub(crate) fn first(&self) -> Option<&Phase> {
        self.list.front()
    }

    /// Forgets the phases that end before a time.
    pub(crate) fn forget_before(&mut self, time_s: f64) {
        while self.list.front().is_some_and(|phase| phase.end_s() < time_s) {
            self.forget_first();
        }
    }

    pub(crate) fn forget_first(&mut self) {
        if let Some(phase) = self.list.pop_front() {
            self.ends_mm[0] = phase.end_mm;
        }
    }

    /// Ends the profile at a time: what comes later is taken back. The phase that runs then.
    pub(crate) fn cut_at(&mut self, time_s: f64) -> Option<Phase> {
        while self.list.back().is_some_and(|phase| phase.start_s >= time_s) {
            let phase = self.list.pop_back()?;
            self.ends_mm[1] = phase.start_mm;
        }
        let last = self.list.back_mut()?;
        if last.end_s() > time_s {
            last.end_mm = last.place(time_s);
            last.duration_s = time_s - last.start_s;
        }
        self.ends_mm[1] = last.end_mm;
        Some(*last)
    }

    /// The phases, but for those that end long before a time. Who plays has forgotten them: then there are none.
    #[inline]
    fn from(&self, time_s: f64) -> impl Iterator<Item = &Phase> {
        const FEW: usize = 16;
        let is_long = self.list.get(FEW).is_some_and(|phase| phase.end_s() < time_s);
        let over = if is_long { self.list.partition_point(|phase| phase.end_s() < time_s) } else { 0 };
        self.list.iter().skip(over)
    }

    /// Place without averaging.
    pub(crate) fn place(&self, time_s: f64) -> f64 {
        match self.from(time_s).find(|phase| phase.end_s() >= time_s) {
            Some(phase) if phase.start_s <= time_s => phase.place(time_s),
            Some(phase) => phase.start_mm,
            None => self.ends_mm[1],
        }
    }

    /// The mean over the window that ends at a time.
    pub(crate) fn mean(&self, time_s: f64, window_s: f64) -> PathState {
        let from = time_s - window_s;
        let base = self.place(from);
        let mut integral = 0.0;
        let mut at = from;
        let mut now = base;
        for phase in self.from(from) {
            let end = phase.end_s().min(time_s);
            if end > at {
                // Before a phase that does not follow at once the tool stands.
                let begin = at.max(phase.start_s);
                integral += (now - base) * (begin - at) + phase.integral(base, begin, end);
                at = end;
                now = if end < time_s { phase.end_mm } else { phase.place(end) };
            }
            if phase.end_s() >= time_s {
                break;
            }
        }
        if window_s <= 0.0 {
            let moving = self.from(time_s).find(|phase| phase.end_s() >= time_s && phase.start_s <= time_s);
            return PathState {
                at_mm: base,
                speed_mm_per_s: moving.map_or(0.0, |phase| phase.speed(time_s)),
            };
        }
        // Behind the last phase it stands again.
        integral += (now - base) * (time_s - at).max(0.0);
        PathState { at_mm: base + integral / window_s, speed_mm_per_s: (now - base) / window_s }
    }
}
