//! The pace: when the tool is where on its path.
//!
//! In: caps along one path that begins and ends at rest, overrides, holds. Out: place and speed at any time.
//!
//! Invariants: speed, acceleration and jerk along the path never exceed caps and [`RunLimits`]; the path is passed in
//! one direction and ended exactly. What is given out is final: it is the same however the caps come in, as long as
//! some [`Pace::foresight_mm`] are known ahead. Nothing is allocated after [`Pace::with_capacity`].

use std::collections::VecDeque;

use super::caps::{
    Averaging, Cap, Feedrate, Room, SHARE_MAX, SHARE_MIN, SPANS_PER_CAP, SPEED_MIN_MM_PER_S, Span, widen,
};
use super::peaks::{flatten, hill};
use super::phases::{PathState, Phase, Phases};
use super::reach::{Knot, backward, brake, forward, is_too_fast};

/// What holds on a whole path from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunLimits {
    /// Along the path, mm/s².
    pub acceleration_mm_per_s2: f64,
    /// Along the path, mm/s³.
    pub jerk_mm_per_s3: f64,
}

impl RunLimits {
    /// Seconds over which the profile is averaged: in this time the acceleration builds up.
    pub fn window_s(self) -> f64 {
        self.acceleration_mm_per_s2 / self.jerk_mm_per_s3
    }

    /// Way to rest with a share of the acceleration, and of all windows on it.
    fn stopping_mm(self, speed_mm_per_s: f64, share: f64) -> f64 {
        speed_mm_per_s * speed_mm_per_s / (2.0 * share * self.acceleration_mm_per_s2)
            + 2.0 * speed_mm_per_s * self.window_s()
    }

    fn averaging(self, rounding_s: f64) -> Averaging {
        Averaging { window_s: self.window_s(), rounding_s, acceleration: self.acceleration_mm_per_s2 }
    }

    /// How far a tool gets beyond a stretch that it leaves at a speed while the averaging still sees that stretch, mm.
    pub(crate) fn reach_mm(self, speed_mm_per_s: f64) -> f64 {
        self.averaging(0.0).reach_mm(speed_mm_per_s, 1.0, 0.0)
    }

    /// Seconds from rest to a speed.
    pub fn ramp_s(self, speed_mm_per_s: f64) -> f64 {
        speed_mm_per_s / self.acceleration_mm_per_s2 + self.window_s()
    }

    /// Way from rest to a speed, mm.
    pub fn ramp_mm(self, speed_mm_per_s: f64) -> f64 {
        speed_mm_per_s * self.ramp_s(speed_mm_per_s) / 2.0
    }

    /// Those with which a way from rest to rest takes the least time. On a way so short or so slow that the acceleration
    /// would have to go back before it is there, a lower one that is there sooner wins.
    ///
    /// With the jerk J and the window T, the acceleration is up and down again while J·T² is gained. From there to rest
    /// again takes 2·J·T³ when the top lasts no longer than it must. So T is the largest for which neither is too much.
    #[must_use]
    pub fn eased(self, way_mm: f64, speed_mm_per_s: f64) -> Self {
        let (jerk, window_s) = (self.jerk_mm_per_s3, self.window_s());
        let gained = jerk * window_s * window_s;
        if speed_mm_per_s >= gained && way_mm >= 2.0 * gained * window_s {
            return self;
        }
        let window_s = window_s.min((speed_mm_per_s / jerk).sqrt()).min(libm::cbrt(way_mm / (2.0 * jerk)));
        Self { acceleration_mm_per_s2: self.acceleration_mm_per_s2.min(jerk * window_s), ..self }
    }

    /// Seconds for a way from rest to rest: the least that its limits allow.
    pub fn rest_to_rest_s(self, way_mm: f64, speed_mm_per_s: f64) -> f64 {
        if way_mm <= 0.0 {
            return 0.0;
        }
        let eased = self.eased(way_mm, speed_mm_per_s);
        let (acceleration, window) = (eased.acceleration_mm_per_s2, eased.window_s());
        // The top lasts for a window at least: way = v²/a + v·window.
        let half = acceleration * window / 2.0;
        let sum = acceleration * way_mm;
        let peak = (sum / (half + (half * half + sum).sqrt())).min(speed_mm_per_s);
        peak / acceleration + way_mm / peak + window
    }
}

/// There is no room for another cap: play or take what is planned first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// What the speed did last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trend {
    Rising,
    Falling,
}

/// The state at the end of what is planned.
#[derive(Clone, Copy, Debug)]
struct Front {
    time_s: f64,
    at_mm: f64,
    /// Speed × speed.
    square: f64,
    trend: Trend,
    /// Seconds since the speed last changed.
    lasting_s: f64,
    /// The operator has come between: what lies ahead may ask for a reversal at once.
    is_interrupted: bool,
}

impl Front {
    const REST: Self = Self {
        time_s: 0.0,
        at_mm: 0.0,
        square: 0.0,
        trend: Trend::Falling,
        lasting_s: f64::INFINITY,
        is_interrupted: false,
    };
}

/// Plans and plays one path.
#[derive(Clone, Debug)]
pub struct Pace {
    limits: RunLimits,
    averaging: Averaging,
    /// So far all of it has the same acceleration.
    is_alike: bool,
    /// No stretch that is to come reaches back further than this; 0 where all have the same acceleration.
    reach_max_mm: f64,
    capacity: usize,
    caps: VecDeque<Cap>,
    end_mm: f64,
    is_closed: bool,
    feedrate: Feedrate,
    is_held: bool,
    front: Front,
    phases: Phases,
    // Room for planning, used again and again.
    spans: Vec<Span>,
    room: Room,
    bounds: Vec<f64>,
    knots: Vec<Knot>,
    profile: Vec<Knot>,
}

/// Phases kept for each cap that there is room for.
const PHASES_PER_CAP: usize = 4;

/// Caps that overrides may cut in two at once; with more the change waits until a cap is over.
const SPLITS_MAX: usize = 16;

impl Pace {
    /// A path of no length, with room for so many caps at once.
    pub fn with_capacity(capacity: usize, limits: RunLimits) -> Self {
        let caps = capacity + SPLITS_MAX;
        let spans = SPANS_PER_CAP * caps + 8;
        Self {
            limits,
            averaging: limits.averaging(0.0),
            is_alike: true,
            reach_max_mm: 0.0,
            capacity,
            caps: VecDeque::with_capacity(caps),
            end_mm: 0.0,
            is_closed: false,
            feedrate: Feedrate::Override(1.0),
            is_held: false,
            front: Front::REST,
            phases: Phases::with_capacity(PHASES_PER_CAP * caps + 16),
            // A span becomes three knots at most, and one that is lowered two.
            spans: Vec::with_capacity(spans),
            room: Room::for_caps(caps),
            bounds: Vec::with_capacity(spans + 1),
            knots: Vec::with_capacity(3 * spans + 8),
            profile: Vec::with_capacity(6 * spans + 16),
        }
    }

    /// Begins another path at rest; override and hold stay.
    pub fn begin(&mut self, limits: RunLimits) {
        self.begin_sharing(limits, 0.0, 0.0);
    }

    /// Begins another path at rest, with stretches and corners that have other accelerations and are passed at no more
    /// than `speed_max_mm_per_s`; 0 without such. Corners are felt for `rounding_s` longer than the averaging takes.
    pub fn begin_sharing(&mut self, limits: RunLimits, speed_max_mm_per_s: f64, rounding_s: f64) {
        (self.limits, self.averaging) = (limits, limits.averaging(rounding_s));
        let reach_mm = self.averaging.reach_max_mm(speed_max_mm_per_s, SHARE_MAX);
        self.reach_max_mm = if speed_max_mm_per_s > 0.0 { reach_mm } else { 0.0 };
        self.caps.clear();
        self.is_alike = true;
        (self.end_mm, self.is_closed) = (0.0, false);
        self.front = Front::REST;
        self.phases.clear();
    }

    /// What holds on this path.
    pub const fn limits(&self) -> RunLimits {
        self.limits
    }

    /// Length of the path as far as it is known, mm.
    pub const fn end_mm(&self) -> f64 {
        self.end_mm
    }

    /// Adds a stretch, or with no length a corner.
    ///
    /// # Errors
    /// When there is no room.
    pub fn push(&mut self, length_mm: f64, ordered_mm_per_s: f64, limit_mm_per_s: f64) -> Result<(), Full> {
        self.push_sharing(length_mm, ordered_mm_per_s, limit_mm_per_s, 1.0)
    }

    /// Adds a stretch or a corner with another acceleration: its share, from [`SHARE_MIN`] to [`SHARE_MAX`], times that of
    /// the limits.
    ///
    /// # Errors
    /// When there is no room.
    pub fn push_sharing(
        &mut self,
        length_mm: f64,
        ordered_mm_per_s: f64,
        limit_mm_per_s: f64,
        share: f64,
    ) -> Result<(), Full> {
        self.is_alike &= share == 1.0;
        let end_mm = self.end_mm + length_mm;
        // Stretches with the same speed are one: look-ahead then costs nothing.
        if let Some(last) = self.caps.back_mut()
            && last.ordered_mm_per_s == ordered_mm_per_s
            && last.limit_mm_per_s == limit_mm_per_s
            && last.feedrate == self.feedrate
            && last.width_feedrate == self.feedrate
            && last.share == share
            && last.start_mm < last.end_mm
        {
            last.end_mm = end_mm;
        } else if self.caps.len() >= self.capacity {
            return Err(Full);
        } else {
            let start_mm = self.end_mm;
            self.caps.push_back(Cap {
                start_mm,
                end_mm,
                ordered_mm_per_s,
                limit_mm_per_s,
                feedrate: self.feedrate,
                width_feedrate: self.feedrate,
                share,
            });
        }
        self.end_mm = end_mm;
        Ok(())
    }

    /// The path is complete.
    pub fn close(&mut self) {
        self.is_closed = true;
    }

    /// Of a complete path of one speed that is not planned yet, takes the limits that are fastest on it.
    pub fn ease(&mut self) {
        if let (Some(cap), 1, true) =
            (self.caps.front(), self.caps.len(), self.is_closed && self.phases.is_empty())
        {
            let limits = self.limits.eased(self.end_mm, cap.speed(cap.feedrate));
            (self.limits, self.averaging) = (limits, limits.averaging(0.0));
        }
    }

    /// Whether there is room for `count` more caps.
    pub fn has_room(&self, count: usize) -> bool {
        self.caps.len() + count <= self.capacity
    }

    /// Path that must be known ahead for the plan to be final, for speeds up to `speed_mm_per_s`.
    pub fn foresight_mm(&self, speed_mm_per_s: f64) -> f64 {
        let share_min = if self.reach_max_mm > 0.0 { SHARE_MIN } else { 1.0 };
        self.limits.stopping_mm(speed_mm_per_s, share_min) + self.reach_max_mm
    }

    /// The time up to which place and speed are final.
    pub const fn planned_s(&self) -> f64 {
        self.front.time_s
    }

    /// The place up to which the profile, before averaging, is final.
    pub const fn planned_mm(&self) -> f64 {
        self.front.at_mm
    }

    /// Seconds from the start to rest at the end, once all is planned.
    pub fn duration_s(&self) -> Option<f64> {
        (self.is_closed && self.front.at_mm >= self.end_mm)
            .then(|| if self.end_mm > 0.0 { self.front.time_s + self.limits.window_s() } else { 0.0 })
    }

    /// Whether the tool stands, held, and has come to rest at a time.
    pub fn is_resting(&self, time_s: f64) -> bool {
        self.front.square == 0.0 && time_s >= self.front.time_s + self.limits.window_s()
    }

    /// The place before averaging at which a feed change at this time would begin.
    pub fn leading_mm(&self, time_s: f64) -> f64 {
        self.phases.place(time_s)
    }

    /// Place and speed at a time that is planned. Times must not go back by more than the window, nor behind a time
    /// given to [`Pace::forget_before`].
    pub fn at(&self, time_s: f64) -> PathState {
        self.phases.mean(time_s, self.limits.window_s())
    }

    /// Forgets what is over at a time.
    pub fn forget_before(&mut self, time_s: f64) {
        self.phases.forget_before(time_s - self.limits.window_s());
        let passed = self.phases.place(time_s);
        self.forget_caps(passed);
    }

    fn forget_caps(&mut self, passed_mm: f64) {
        // Without other shares only its speed reaches on, half as far.
        let (averaging, half) = (self.averaging, self.limits.window_s() / 2.0);
        let reach = |cap: &Cap| match cap.share {
            _ if self.is_alike => cap.limit_mm_per_s * half,
            share => averaging.reach_max_mm(cap.limit_mm_per_s, share),
        };
        while self.caps.len() > 1 && self.caps.front().is_some_and(|cap| cap.end_mm + reach(cap) < passed_mm)
        {
            self.caps.pop_front();
        }
        // Of many short ones that still reach on, the slowest may stand for two.
        while self.caps.len() > self.capacity / 2 && self.caps[1].end_mm <= passed_mm {
            let Some(first) = self.caps.pop_front() else { return };
            let second = &mut self.caps[0];
            second.start_mm = first.start_mm;
            second.ordered_mm_per_s = second.ordered_mm_per_s.min(first.ordered_mm_per_s);
            second.limit_mm_per_s = second.limit_mm_per_s.min(first.limit_mm_per_s);
            second.share = second.share.min(first.share);
        }
    }

    /// The time at which the profile, before averaging, passes a place that is planned; everything before the place
    /// is forgotten. For clocks: who plays uses [`Pace::at`].
    pub fn pass(&mut self, place_mm: f64) -> f64 {
        while self.phases.first().is_some_and(|phase| phase.end_mm < place_mm) {
            self.phases.forget_first();
        }
        self.forget_caps(place_mm);
        self.phases.first().map_or(self.front.time_s, |phase| phase.start_s + phase.time_to(place_mm))
    }

    /// Changes override or dry run, and the hold, from a time on that has been played.
    pub fn interrupt(&mut self, time_s: f64, feedrate: Feedrate, is_held: bool) {
        if feedrate == self.feedrate && is_held == self.is_held {
            return;
        }
        self.is_held = is_held;
        if time_s < self.front.time_s {
            self.take_back(time_s);
        } else if self.front.square == 0.0 {
            // It stands, and stood until now.
            self.front.lasting_s += time_s - self.front.time_s;
            self.front.time_s = time_s;
        }
        self.front.is_interrupted = true;
        self.change_feedrate(feedrate);
    }

    /// Takes back what is planned beyond a time.
    fn take_back(&mut self, time_s: f64) {
        let Some(running) = self.phases.cut_at(time_s) else {
            // It has not begun to move.
            self.front = Front { time_s, at_mm: self.phases.place(time_s), ..Front::REST };
            return;
        };
        let speed = running.speed(time_s).max(0.0);
        self.front = Front { time_s, at_mm: running.end_mm, square: speed * speed, ..self.front };
        let changed = self.phases.iter().rev().find(|phase| phase.acceleration != 0.0);
        if let Some(phase) = changed {
            self.front.trend = if phase.acceleration > 0.0 { Trend::Rising } else { Trend::Falling };
            self.front.lasting_s = time_s - phase.end_s();
        } else {
            self.front.lasting_s = f64::INFINITY;
        }
    }

    /// How far ahead may lie what the tool is already slowing down for.
    fn near_mm(&self) -> f64 {
        let fastest = self.caps.iter().map(|cap| cap.speed(cap.feedrate)).fold(0.0, f64::max);
        let shares = || self.caps.iter().map(|cap| cap.share);
        let (share_min, share_max) = (shares().fold(1.0, f64::min), shares().fold(0.0, f64::max));
        let less = self.caps.iter().filter(|cap| cap.share < share_max);
        let reach = less.map(|cap| self.averaging.reach_max_mm(cap.limit_mm_per_s, cap.share));
        self.limits.stopping_mm(fastest, share_min) + reach.fold(0.0, f64::max)
    }

    /// Lets another feedrate hold. What is so near that the tool may already be slowing down for it keeps its width,
    /// and becomes no faster: else the profile followed so far and the new one would not fit into one averaging.
    fn change_feedrate(&mut self, feedrate: Feedrate) {
        self.feedrate = feedrate;
        let near_mm = self.front.at_mm + if self.front.square == 0.0 { 0.0 } else { self.near_mm() };
        let mut index = 0;
        while index < self.caps.len() {
            let cap = self.caps[index];
            let changed = Cap { feedrate, width_feedrate: feedrate, ..cap };
            if cap.start_mm >= near_mm {
                self.caps[index] = changed;
            } else {
                if cap.speed(feedrate) < cap.speed(cap.feedrate) {
                    self.caps[index].feedrate = feedrate;
                }
                if cap.end_mm > near_mm && self.caps.len() < self.capacity + SPLITS_MAX {
                    self.caps[index].end_mm = near_mm;
                    index += 1;
                    self.caps.insert(index, Cap { start_mm: near_mm, ..changed });
                }
            }
            index += 1;
        }
    }

    /// Override or dry run, and hold, before the path comes in.
    pub fn preset(&mut self, feedrate: Feedrate, is_held: bool) {
        (self.feedrate, self.is_held) = (feedrate, is_held);
    }

    /// Whether the operator holds it.
    pub const fn is_held(&self) -> bool {
        self.is_held
    }

    /// Plans what can be planned for good. With no room left, also what might still have become faster.
    pub fn plan(&mut self) {
        // An interruption is answered first; the rest then follows as if from there.
        for _ in 0..2 {
            if self.front.at_mm >= self.end_mm || self.is_held && self.front.square == 0.0 {
                return;
            }
            if self.is_closed && self.caps.len() == 1 && self.phases.is_empty() && self.front.at_mm == 0.0 {
                return self.plan_hill();
            }
            if self.front.square == 0.0 && self.front.is_interrupted && !self.wait() {
                return;
            }
            if !self.plan_once() {
                return;
            }
        }
    }

    /// Plans a path of one speed from rest to rest: what the passes of [`Pace::plan_once`] would come to, bit for bit.
    fn plan_hill(&mut self) {
        let Some(cap) = self.caps.front() else { return };
        let growth = 2.0 * self.limits.acceleration_mm_per_s2;
        let growth = growth * cap.share;
        let [left, right] = hill(self.end_mm, cap.speed(cap.feedrate), growth, self.limits.window_s());
        for knot in [left, right, Knot::new(self.end_mm, 0.0, growth)] {
            self.add_knot(knot);
        }
        self.front.is_interrupted = false;
    }

    /// Lets the rest of a window go by at rest.
    fn wait(&mut self) -> bool {
        let rest_s = self.limits.window_s() - self.front.lasting_s;
        let at = self.front.at_mm;
        if rest_s > 0.0 && !self.add_phase(Knot::new(at, 0.0, 0.0), rest_s) {
            return false;
        }
        (self.front.lasting_s, self.front.is_interrupted) = (f64::INFINITY, false);
        true
    }

    /// Whether there is more to plan at once.
    fn plan_once(&mut self) -> bool {
        let window_s = self.limits.window_s();
        let start = Knot::new(self.front.at_mm, self.front.square, 0.0);
        let speed = start.square.sqrt();
        self.gather();
        let rest_mm = speed * (window_s - self.front.lasting_s).max(0.0);
        if self.front.is_interrupted && self.front.trend == Trend::Falling && rest_mm > 0.0 {
            self.slow_down_to(start.at + rest_mm, speed);
        }
        backward(&self.spans, &mut self.bounds);
        if self.front.is_interrupted {
            let rising_mm = if self.front.trend == Trend::Rising { rest_mm } else { 0.0 };
            if self.is_held || is_too_fast(&self.spans, &self.bounds, start, rising_mm) {
                return self.obey(start, rising_mm);
            }
        }
        forward(&self.spans, &self.bounds, start, &mut self.knots);
        let head_mm = match self.front.trend {
            Trend::Rising => speed * self.front.lasting_s,
            Trend::Falling => f64::INFINITY,
        };
        flatten(&self.knots, window_s, head_mm, &mut self.profile);
        self.commit();
        false
    }

    /// The spans from the front on.
    fn gather(&mut self) {
        widen(self.caps.iter(), self.is_alike, self.averaging, &mut self.room, &mut self.spans);
        let at = self.front.at_mm;
        let passed = self.spans.iter().take_while(|span| span.end <= at).count();
        self.spans.drain(..passed);
        if let Some(first) = self.spans.first_mut() {
            first.start = at;
        }
    }

    /// No faster than `speed` up to a place.
    fn slow_down_to(&mut self, until_mm: f64, speed: f64) {
        for index in 0..self.spans.len() {
            let span = self.spans[index];
            if span.start >= until_mm {
                return;
            }
            if span.speed > speed {
                if span.end > until_mm {
                    self.spans[index].start = until_mm;
                    self.spans.insert(index, Span { end: until_mm, ..span });
                }
                self.spans[index].speed = speed.max(SPEED_MIN_MM_PER_S);
            }
        }
    }

    /// Slows down from a state that is too fast for what is now asked: first the present speed for the rest of a
    /// window when it has just been reached by speeding up, then braking.
    fn obey(&mut self, start: Knot, rising_mm: f64) -> bool {
        let speed = start.square.sqrt();
        let coasted = Knot { at: start.at + rising_mm, ..start };
        if rising_mm > 0.0 && !self.add_phase(coasted, rising_mm / speed) {
            return false;
        }
        brake(&self.spans, &self.bounds, self.is_held, coasted, &mut self.knots);
        for index in 0..self.knots.len() {
            self.add_knot(self.knots[index]);
        }
        // Held at rest, it waits; else it goes on from there, not up again within a window.
        (self.front.trend, self.front.lasting_s) = (Trend::Falling, 0.0);
        !self.is_held
    }

    /// Gives out what is final of the profile.
    fn commit(&mut self) {
        let fastest = self.spans.iter().map(|span| span.speed).fold(0.0, f64::max);
        let final_mm = self.end_mm - self.foresight_mm(fastest);
        let count = if self.is_closed {
            self.profile.len()
        } else {
            let within = self.profile.iter().take_while(|knot| knot.at <= final_mm).count();
            self.profile[..within].iter().rposition(|knot| !knot.is_lowered).map_or(0, |last| last + 1)
        };
        if count <= 1 && !self.has_room(1) {
            let passed = self.caps.iter().take_while(|cap| cap.end_mm <= self.front.at_mm).count();
            if let Some(middle) = self.caps.get((passed + self.caps.len()).div_ceil(2)) {
                self.commit_until(middle.start_mm);
            }
            return;
        }
        let profile = std::mem::take(&mut self.profile);
        let mut has_room = true;
        for knot in profile[..count].iter().skip(1) {
            has_room = has_room && self.add_knot(*knot);
            self.front.is_interrupted &= !has_room;
        }
        if let (Some(last), Some(next)) = (profile[..count].last(), profile.get(count))
            && has_room
            && last.square == next.square
        {
            // Of a steady stretch what is near is final, though its end is not known.
            self.add_knot(Knot { at: next.at.min(final_mm), ..*next });
        }
        self.profile = profile;
    }

    /// Plans as [`Pace::plan`] does, and at least up to a place: with what is safe, though it might have become
    /// faster.
    pub fn plan_until(&mut self, until_mm: f64) {
        self.plan();
        if self.front.at_mm < until_mm && !self.is_closed {
            self.commit_until(until_mm);
        }
    }

    /// Gives out what is safe up to a place.
    fn commit_until(&mut self, until_mm: f64) {
        let passed = self.profile.iter().take_while(|knot| knot.at < self.front.at_mm).count();
        if self.profile.get(passed).is_none_or(|knot| knot.at > self.front.at_mm) && passed > 0 {
            // The front lies on a steady stretch.
            self.profile[passed - 1].at = self.front.at_mm;
        }
        self.profile.drain(..passed.saturating_sub(1));
        for index in 1..self.profile.len() {
            let (from, mut to) = (self.profile[index - 1], self.profile[index]);
            let is_last = to.at >= until_mm;
            if to.at > until_mm {
                let part = (until_mm - from.at) / (to.at - from.at);
                to = Knot { at: until_mm, square: from.square + (to.square - from.square) * part, ..to };
            }
            if !self.add_knot(to) || is_last {
                break;
            }
        }
        // A way down for the sake of the unknown is no way down for good.
        self.front.is_interrupted = self.front.trend == Trend::Falling;
    }

    /// Adds the phase to a knot; `false` when there is no room.
    fn add_knot(&mut self, knot: Knot) -> bool {
        let way = knot.at - self.front.at_mm;
        let (from, to) = (self.front.square.sqrt(), knot.square.sqrt());
        if way > 0.0 && from + to > 0.0 {
            return self.add_phase(knot, 2.0 * way / (from + to));
        }
        // No way, or one of rounding between two rests.
        (self.front.at_mm, self.front.square) = (knot.at, knot.square);
        true
    }

    fn add_phase(&mut self, end: Knot, duration_s: f64) -> bool {
        let speed = self.front.square.sqrt();
        let acceleration = (end.square.sqrt() - speed) / duration_s;
        // A steady stretch stays one phase, in however many pieces it comes.
        if acceleration == 0.0
            && let Some(end_s) = self.phases.extend(end.at, speed)
        {
            self.front.lasting_s += end_s - self.front.time_s;
            (self.front.time_s, self.front.at_mm) = (end_s, end.at);
            return true;
        }
        if self.phases.is_full() {
            return false;
        }
        let front = &mut self.front;
        self.phases.push(Phase {
            start_s: front.time_s,
            duration_s,
            start_mm: front.at_mm,
            end_mm: end.at,
            speed,
            acceleration,
        });
        (front.time_s, front.at_mm, front.square) = (front.time_s + duration_s, end.at, end.square);
        if acceleration == 0.0 {
            front.lasting_s += duration_s;
        } else {
            front.trend = if acceleration > 0.0 { Trend::Rising } else { Trend::Falling };
            front.lasting_s = 0.0;
        }
        true
    }
}
