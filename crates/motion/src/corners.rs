//! Corners: how fast legs may follow one another without a stop.
//!
//! In: legs with the speeds ordered on them. Out: caps for the [`Pace`], a few legs later, as corners that lie closer
//! together than the time in which one is passed count together.

use std::collections::VecDeque;

use crate::Dynamics;
use crate::dynamics::{CornerLaw, Demand};
use crate::leg::{Heading, Leg};
use crate::planner::{Full, Pace, RunLimits, SPEED_MIN_MM_PER_S, least, most};

/// Stretches that wait for the corners behind them. With more inside one corner's time, the corner is passed as
/// slowly as if the stretch behind were all corners.
const WAITING_MAX: usize = 64;

/// A stretch of a leg and the corner at its end.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    length_mm: f64,
    end_mm: f64,
    /// No tool is sooner at its end, seconds from the start of the path.
    soonest_s: f64,
    ordered_mm_per_s: f64,
    limit_mm_per_s: f64,
    share: f64,
    corner_mm_per_s: f64,
    /// What the corner at its end leaves of the acceleration around it.
    corner_share: f64,
    /// That of all corners before the one at its end.
    demand: Demand,
    has_corner: bool,
}

/// The legs on their way to the pace.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    law: CornerLaw,
    /// Overrides and dry runs may ask for more than is ordered.
    has_operator: bool,
    waiting: VecDeque<Stretch>,
    /// No stretch may be passed faster.
    fastest_mm_per_s: f64,
    end_mm: f64,
    soonest_s: f64,
    heading: Option<Heading>,
    /// The highest speed on the last leg, whatever is ordered.
    limit_mm_per_s: f64,
    /// What the path is limited to.
    limits: RunLimits,
    /// Where the last corner was, when no tool was sooner there, and its speed were it alone.
    last_mm: f64,
    last_s: f64,
    last_mm_per_s: f64,
    /// That of all corners met.
    demand: Demand,
    /// The first of those waiting whose corner may be passed together with the next one.
    group: usize,
    /// The last corner before the group, when it is apart only because the path is slow enough since.
    apart: Option<usize>,
}

impl Corners {
    pub(crate) fn new(dynamics: &Dynamics, has_operator: bool) -> Self {
        Self {
            law: dynamics.corner_law(),
            has_operator,
            // Twice, so that they seldom come to lie around the end of the ring.
            waiting: VecDeque::with_capacity(2 * WAITING_MAX),
            fastest_mm_per_s: 0.0,
            end_mm: 0.0,
            soonest_s: 0.0,
            heading: None,
            limit_mm_per_s: f64::INFINITY,
            limits: dynamics.cutting(false),
            last_mm: 0.0,
            last_s: 0.0,
            last_mm_per_s: 0.0,
            demand: Demand::default(),
            group: 0,
            apart: None,
        }
    }

    /// Begins a path at rest.
    pub(crate) fn begin(&mut self, limits: RunLimits) {
        self.waiting.clear();
        self.limits = limits;
        (self.last_mm, self.last_s, self.last_mm_per_s) = (0.0, 0.0, 0.0);
        self.fastest_mm_per_s = 0.0;
        (self.end_mm, self.soonest_s, self.heading) = (0.0, 0.0, None);
        (self.demand, self.group, self.apart) = (Demand::default(), 0, None);
    }

    /// The next leg begins: the corner between it and the one before is known.
    pub(crate) fn turn_into(&mut self, leg: &Leg, limit_mm_per_s: f64) {
        let start = leg.heading(0.0);
        if let (Some(end), Some(before)) = (&self.heading, self.waiting.back_mut())
            && self.law.time_s > 0.0
        {
            before.has_corner = true;
            let limit = before.limit_mm_per_s;
            let fastest = least(self.limit_mm_per_s, limit_mm_per_s);
            let (slowness, share) = self.law.add(&mut self.demand, end, &start, fastest);
            before.corner_share = share;
            self.pass(slowness, limit);
            self.look_back();
        }
        self.limit_mm_per_s = limit_mm_per_s;
        self.heading = Some(if leg.arc.is_some() { leg.heading(1.0) } else { start });
    }

    /// No tool is sooner at the corner just met, which alone is passed at 1 / `slowness`, than the acceleration lets it,
    /// and the jerk; just before it no tool is faster than `limit`.
    #[inline]
    fn pass(&mut self, slowness: f64, limit: f64) {
        let is_apart = self.soonest_s - self.last_s >= self.law.time_s;
        let mm_per_s = if slowness * limit <= 1.0 { limit } else { 1.0 / slowness };
        if !is_apart && (mm_per_s < limit || self.last_mm_per_s < limit) {
            self.be_late(mm_per_s);
        }
        (self.last_mm, self.last_s, self.last_mm_per_s) = (self.end_mm, self.soonest_s, mm_per_s);
    }

    /// Between the last corner and the one just met, which is passed at a speed, the tool can only get so fast.
    fn be_late(&mut self, mm_per_s: f64) {
        let way = self.end_mm - self.last_mm;
        // A slanted leg has more than the limits say.
        let share = self.waiting.back().map_or(1.0, |before| most(before.share, 1.0));
        let acceleration = share * self.limits.acceleration_mm_per_s2;
        let (slow, fast) = (least(self.last_mm_per_s, mm_per_s), most(self.last_mm_per_s, mm_per_s));
        let change = 2.0 * acceleration * way;
        let seconds = if fast * fast - slow * slow >= change {
            ((slow * slow + change).sqrt() - slow) / acceleration
        } else {
            let peak = ((slow * slow + fast * fast + change) / 2.0).sqrt();
            (2.0 * peak - slow - fast) / acceleration
        };
        // From full acceleration to full deceleration the tool gets no further in one time.
        let time = self.law.time_s;
        let is_apart = way >= time * (fast + share * self.limits.jerk_mm_per_s3 * time * time / 12.0);
        let seconds = if is_apart { most(seconds, time) } else { seconds };
        self.soonest_s = most(self.soonest_s, self.last_s + seconds);
        if let Some(before) = self.waiting.back_mut() {
            before.soonest_s = self.soonest_s;
        }
    }

    /// The only stretch of a path: its ordered speed and its limit.
    pub(crate) fn only_speeds(&self) -> Option<[f64; 2]> {
        let first = self.waiting.front().filter(|first| first.end_mm == first.length_mm)?;
        (self.waiting.len() == 1).then_some([first.ordered_mm_per_s, first.limit_mm_per_s])
    }

    /// Whether there is room for another stretch; a corner before it is known by now.
    pub(crate) fn has_room(&self) -> bool {
        self.waiting.len() < WAITING_MAX
    }

    /// A stretch of the leg that has begun.
    pub(crate) fn add(&mut self, length_mm: f64, ordered_mm_per_s: f64, (limit_mm_per_s, share): (f64, f64)) {
        // With nobody who could raise it, the order is a limit: then stretches of one speed are alike.
        let limit_mm_per_s =
            if self.has_operator { limit_mm_per_s } else { least(ordered_mm_per_s, limit_mm_per_s) };
        self.fastest_mm_per_s = self.fastest_mm_per_s.max(limit_mm_per_s);
        self.end_mm += length_mm;
        self.soonest_s += length_mm / limit_mm_per_s.max(SPEED_MIN_MM_PER_S);
        self.waiting.push_back(Stretch {
            length_mm,
            end_mm: self.end_mm,
            soonest_s: self.soonest_s,
            ordered_mm_per_s,
            limit_mm_per_s,
            share,
            corner_mm_per_s: f64::INFINITY,
            corner_share: 1.0,
            demand: self.demand,
            has_corner: false,
        });
    }

    /// Lets the corner just met slow down those that are passed together with it.
    ///
    /// The longer a group of corners, the slower it is passed, and the faster it would have to be passed for all of
    /// it to lie within one time: the group ends where these meet, and with each corner it ends no earlier.
    fn look_back(&mut self) {
        let waiting = self.waiting.make_contiguous();
        let last = waiting.len() - 1;
        let is_out = |stretch: &Stretch| self.soonest_s - stretch.soonest_s >= self.law.time_s;
        let way_speed = |stretch: &Stretch| (self.end_mm - stretch.end_mm) / self.law.time_s;
        let together = loop {
            let stretch = &waiting[self.group];
            if is_out(stretch) && self.group < last {
                self.apart = None;
            } else if stretch.has_corner {
                let together = self.law.speed_since(&stretch.demand, &self.demand);
                if way_speed(stretch) < together || self.group == last {
                    break together;
                }
                self.apart = Some(self.group);
            }
            self.group += 1;
        };
        self.apart = self.apart.filter(|index| !is_out(&waiting[*index]));
        let apart = self.apart.map_or(f64::INFINITY, |index| way_speed(&waiting[index]));
        let slowest = least(together, apart);
        if slowest >= self.fastest_mm_per_s {
            return;
        }
        let start = self.apart.map_or(self.group, |index| index + 1);
        for stretch in &mut waiting[start..=self.group] {
            stretch.limit_mm_per_s = least(stretch.limit_mm_per_s, apart);
        }
        waiting[self.group].corner_mm_per_s = least(waiting[self.group].corner_mm_per_s, slowest);
        for stretch in &mut waiting[self.group + 1..] {
            stretch.limit_mm_per_s = least(stretch.limit_mm_per_s, slowest);
            stretch.corner_mm_per_s = least(stretch.corner_mm_per_s, slowest);
        }
    }

    /// Gives to the pace what no later corner can slow down any more; everything when the path is over.
    pub(crate) fn pour(&mut self, pace: &mut Pace, is_over: bool) -> Result<(), Full> {
        while let Some(first) = self.waiting.front() {
            let is_apart = self.soonest_s - first.soonest_s >= self.law.time_s;
            if !is_over && !is_apart && self.has_room() {
                return Ok(());
            }
            if !pace.has_room(2) {
                return Err(Full);
            }
            pace.push_sharing(first.length_mm, first.ordered_mm_per_s, first.limit_mm_per_s, first.share)?;
            if first.has_corner {
                let apart = (self.end_mm - first.end_mm) / self.law.time_s;
                let is_early = !is_over && !is_apart;
                let speed = if is_early { first.corner_mm_per_s.min(apart) } else { first.corner_mm_per_s };
                let next = self.waiting.get(1).unwrap_or(first);
                let beside = least(first.limit_mm_per_s, next.limit_mm_per_s);
                if first.corner_share < 1.0 {
                    let ordered = least(first.ordered_mm_per_s, next.ordered_mm_per_s);
                    pace.push_sharing(0.0, ordered, least(speed, beside), first.corner_share)?;
                } else if speed < beside {
                    // Slower than the stretches beside it, or it holds nobody up.
                    pace.push(0.0, f64::INFINITY, speed)?;
                }
            }
            self.waiting.pop_front();
            self.group = self.group.saturating_sub(1);
            self.apart = self.apart.and_then(|index| index.checked_sub(1));
        }
        Ok(())
    }
}
