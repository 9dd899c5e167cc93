//! The player: where every axis is at every tick.
//!
//! In: commands in order of execution, and what the operator does meanwhile ([`Panel`]). Out: a [`Sample`] a tick, at
//! any rate, through a closure that is called as soon as a place is final.
//!
//! The player holds a few thousand legs and nothing that grows with the program. A tick allocates nothing; a chain of
//! threads has its plan laid before its first tick. The same commands give the same samples, bit for bit.

use std::collections::VecDeque;

use turnwright_canon::{Action, Command, OtherAxes, PathMode, RapidPath};
use turnwright_units::{Lead, Position, WorkTip};

use crate::clock::Clock;
use crate::leg::{Leg, Place, X, Z};
use crate::orders::leg_limit;
use crate::planner::{Feedrate, Pace, RunLimits};
use crate::run::{CuttingRun, LEGS_MAX};
use crate::smoother::{Lag, Smoother};
use crate::spindle::{Shift, SpindleAngle};
use crate::tap::TapPace;
use crate::thread::ThreadPlan;
use crate::thread_chain::ThreadChain;
use crate::totals::Kind;
use crate::{AXIS_COUNT, Dynamics, MachineRates, Panel, RapidSurfaceSpeed, ThreadHold};

/// The machine at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Seconds since the start.
    pub time_s: f64,
    /// Where the axes are told to be.
    pub place: Place,
    /// Speed along the path, mm/s, before corners are rounded; 0 in threads and rapids of each axis for itself.
    pub path_mm_per_s: f64,
    /// Speed of the spindle, rpm; negative counter-clockwise.
    pub rpm: f64,
    /// Turns of the spindle since the start.
    pub turns: f64,
    /// What the time is spent on.
    pub kind: Kind,
    /// Program text of the block.
    pub source: u32,
    /// Line of the block.
    pub line: u32,
}

/// Where a leg came from.
#[derive(Clone, Copy, Debug)]
struct Block {
    source: u32,
    line: u32,
    /// What it is when it cuts.
    kind: Kind,
}

/// Plays commands.
#[derive(Debug)]
pub struct Player {
    clock: Clock,
    dynamics: Dynamics,
    rate_hz: f64,
    tick: u64,
    /// What the last tick belonged to.
    last: Option<(Block, Kind)>,
    /// When what is being done began.
    now_s: f64,
    panel: Panel,
    changes: VecDeque<(f64, Panel)>,
    /// The axes come to rest behind the last cut.
    is_block_over: bool,
    /// A feed hold came in a thread and does not act yet.
    is_hold_deferred: bool,
    run: CuttingRun,
    /// The legs of the command that is being taken up.
    legs: Vec<Leg>,
    has_others: bool,
    mode: PathMode,
    blocks: VecDeque<Block>,
    lanes: Box<[Pace; AXIS_COUNT]>,
    smoother: Smoother,
    /// In its place for cuts, where axes come behind exponentially.
    lag: Option<Lag>,
    spindle: SpindleAngle,
    thread: ThreadChain,
    /// The change of gear that is going on.
    shift: Option<Shift>,
    /// The spindle as a tap leads it.
    led: Option<SpindleAngle>,
    is_stuck: bool,
}

/// Of samples behind everything that was ordered.
const NO_BLOCK: Block = Block { source: 0, line: 0, kind: Kind::Cutting };

/// Caps of a rapid: one, and what overrides make of it.
const LANE_CAPS: usize = 4;

impl Player {
    /// The tool tip at `start`, the spindle standing. `rate_hz` is the number of ticks a second.
    pub fn new(start: Position<WorkTip>, rates: MachineRates, rate_hz: f64) -> Self {
        let dynamics = rates.dynamics.filter(|dynamics| dynamics.first_fault().is_none()).unwrap_or_default();
        let rates = MachineRates { dynamics: Some(dynamics), ..rates };
        let unit = RunLimits { acceleration_mm_per_s2: 1.0, jerk_mm_per_s3: 1.0 };
        Self {
            clock: Clock::new(start, rates),
            dynamics,
            rate_hz,
            tick: 0,
            last: None,
            now_s: 0.0,
            panel: rates.panel,
            changes: VecDeque::new(),
            is_block_over: false,
            is_hold_deferred: false,
            run: CuttingRun::new(dynamics, true, true),
            legs: Vec::new(),
            has_others: false,
            mode: PathMode::Continuous,
            blocks: VecDeque::with_capacity(LEGS_MAX),
            lanes: Box::new(std::array::from_fn(|_| Pace::with_capacity(LANE_CAPS, unit))),
            smoother: Smoother::new(dynamics.corner_s, 1.0 / rate_hz),
            lag: rates.lag_s().map(|lag_s| Lag::new(lag_s, 1.0 / rate_hz)),
            spindle: SpindleAngle::default(),
            thread: ThreadChain::default(),
            shift: None,
            led: None,
            is_stuck: false,
        }
    }

    /// From a time on the operator has set the panel so. Times must rise.
    pub fn set_at(&mut self, time_s: f64, panel: Panel) {
        self.changes.push_back((time_s, panel));
    }

    /// Whether a hold that is never released has stopped everything.
    pub const fn is_stuck(&self) -> bool {
        self.is_stuck
    }

    /// Seconds played.
    pub const fn played_s(&self) -> f64 {
        self.now_s
    }

    /// The next command; `sink` gets the samples that are final.
    pub fn push(&mut self, command: &Command, sink: &mut dyn FnMut(&Sample)) {
        if self.is_stuck {
            return;
        }
        let kind =
            if matches!(command.action, Action::Thread { .. }) { Kind::Threading } else { Kind::Cutting };
        let block = Block { source: command.origin.source, line: command.origin.line, kind };
        if !matches!(&command.action, Action::Thread { is_chained: true, .. }) {
            self.play_thread(sink);
        }
        if matches!(&command.action, Action::Thread { is_chained: false, .. }) {
            // A thread begins at rest: how the panel is set then counts for all of it.
            self.end_run(sink);
        }
        // In a dry run that acts on them threads are cuts like any other.
        let is_dry_thread = kind == Kind::Threading
            && self.thread.is_empty()
            && !self.clock.is_led()
            && self.clock.dry_thread().is_some();
        match &command.action {
            Action::Feed { .. } | Action::Thread { .. } if kind == Kind::Cutting || is_dry_thread => {
                let others = command.action.others();
                let goes_on = self.run.is_open()
                    && self.mode != PathMode::ExactStop
                    && !self.is_block_over
                    && others.is_some() == self.has_others
                    && !self.clock.would_wait();
                if !goes_on {
                    self.end_run(sink);
                }
                self.cut(command, block, sink);
                self.is_block_over = self.panel.single_block && !command.origin.runs_on;
                if self.is_hold_deferred && kind == Kind::Cutting {
                    self.end_run(sink);
                    self.end_deferral(command, sink);
                }
                return;
            }
            Action::PathMode(mode) => {
                if (*mode == PathMode::Tapping) != (self.mode == PathMode::Tapping) {
                    // Overrides begin or cease to act.
                    self.end_run(sink);
                }
                self.mode = *mode;
                self.clock.advance(command);
                return;
            }
            Action::Message(_) | Action::Output(_) => return,
            _ => {}
        }
        self.end_run(sink);
        match &command.action {
            Action::Rapid { to, path, others } => {
                self.rapid(command, *to, *path, others.as_deref(), block, sink);
                self.end_deferral(command, sink);
            }
            Action::Thread { to, lead, .. } if self.clock.is_led() => {
                self.tap(command, *to, *lead, block, sink)
            }
            Action::Thread { .. } => self.thread.add(command, &mut self.clock, &self.dynamics),
            _ => {
                if !self.clock.is_led() {
                    // A tap comes out first.
                    self.wait_while_held(block, sink);
                }
                let timing = self.clock.advance(command);
                let shift_s = self.shift_gear(timing.kind, block, sink);
                self.stand(timing.seconds - shift_s, timing.kind, block, sink);
                self.end_deferral(command, sink);
            }
        }
        self.smoother.stand(&self.clock.place());
    }

    /// The spindle changes its gear, if the last command asked for that, before it gets its speed; the seconds it takes.
    fn shift_gear(&mut self, kind: Kind, block: Block, sink: &mut dyn FnMut(&Sample)) -> f64 {
        let Some(shift) = self.clock.last_shift() else { return 0.0 };
        self.shift = Some(shift);
        self.stand(shift.seconds, kind, block, sink);
        self.shift = None;
        shift.seconds
    }

    /// No more commands come.
    pub fn finish(&mut self, sink: &mut dyn FnMut(&Sample)) {
        self.play_thread(sink);
        self.end_run(sink);
        if let Some((block, kind)) = self.last.filter(|_| !self.is_stuck) {
            // The last tick of a move may lie before its end.
            self.give(self.clock.place(), 0.0, kind, block, sink);
        }
    }

    fn next_s(&self) -> f64 {
        self.tick as f64 / self.rate_hz
    }

    /// Whether the panel changes with the next tick.
    fn look_at_panel(&mut self) -> bool {
        let mut has_changed = false;
        while self.changes.front().is_some_and(|(time_s, _)| *time_s <= self.next_s()) {
            if let Some((_, panel)) = self.changes.pop_front() {
                (self.panel, has_changed) = (panel, true);
            }
        }
        if has_changed {
            // The clock counts at 100 %; what it passes over and how is the same.
            let dry_run_mm_per_min = self.panel.dry_run_mm_per_min;
            self.clock.set_panel(Panel { dry_run_mm_per_min, ..Panel::default() });
        }
        has_changed
    }

    /// The panel as it acts now.
    fn acting_panel(&self) -> Panel {
        Panel { is_held: self.panel.is_held && !self.is_hold_deferred, ..self.panel }
            .locked(self.clock.lock())
    }

    /// Behind a move that follows a thread a feed hold from that thread acts.
    fn end_deferral(&mut self, command: &Command, sink: &mut dyn FnMut(&Sample)) {
        if self.is_hold_deferred && !command.origin.runs_on {
            self.is_hold_deferred = false;
            let block = Block { source: command.origin.source, line: command.origin.line, kind: Kind::Other };
            self.wait_while_held(block, sink);
        }
    }

    /// Nothing that is no move begins while the operator holds.
    fn wait_while_held(&mut self, block: Block, sink: &mut dyn FnMut(&Sample)) {
        let place = self.clock.place();
        loop {
            self.look_at_panel();
            if !self.acting_panel().is_held || self.is_stuck {
                return;
            }
            if self.changes.is_empty() {
                self.is_stuck = true;
                return;
            }
            self.give(place, 0.0, Kind::Stop, block, sink);
            self.now_s = self.next_s();
        }
    }

    fn give(
        &mut self,
        place: Place,
        path_mm_per_s: f64,
        kind: Kind,
        block: Block,
        sink: &mut dyn FnMut(&Sample),
    ) {
        let time_s = self.next_s();
        let spindle = self.clock.spindle();
        // In a rapid the spindle already aims at its end, where the clock is, or follows the tool.
        let aims_at_end =
            kind == Kind::Rapid && self.clock.rates().rapid_surface_speed == RapidSurfaceSpeed::AtEndPoint;
        let x_mm = if aims_at_end { self.clock.position().x.to_mm() } else { place[X] };
        let (rpm, ramp_rpm_per_s) = match self.shift {
            Some(shift) => (shift.rpm, shift.ramp_rpm_per_s),
            None if self.clock.is_led() => (0.0, spindle.ramp_rpm_per_s()),
            None if kind == Kind::Threading => (self.spindle.rpm, 0.0),
            None => (spindle.wanted_rpm(x_mm), spindle.ramp_rpm_per_s()),
        };
        match self.led {
            Some(angle) => self.spindle = angle,
            None => {
                let turning_s = self.turning_s(time_s - 1.0 / self.rate_hz, time_s);
                self.spindle.turn(rpm, ramp_rpm_per_s, 1.0 / self.rate_hz, turning_s);
            }
        }
        // Led by a tap it turns as that goes.
        let swing = if self.led.is_some() { 1.0 } else { self.clock.rates().fluctuation.at(time_s) };
        sink(&Sample {
            time_s,
            place,
            path_mm_per_s,
            rpm: self.spindle.rpm * swing,
            turns: self.spindle.turns,
            kind,
            source: block.source,
            line: block.line,
        });
        self.tick += 1;
        self.last = Some((block, kind));
    }

    /// Stands still.
    fn stand(&mut self, seconds: f64, kind: Kind, block: Block, sink: &mut dyn FnMut(&Sample)) {
        let place = self.clock.place();
        let stops = kind == Kind::Dwell && self.clock.rates().panel_rules.hold_stops_dwell;
        let mut end_s = self.now_s + seconds;
        while self.next_s() < end_s && !self.is_stuck {
            self.look_at_panel();
            if stops && self.acting_panel().is_held {
                self.is_stuck = self.changes.is_empty();
                end_s += 1.0 / self.rate_hz;
            }
            self.give(place, 0.0, kind, block, sink);
        }
        self.now_s = end_s;
    }

    /// Takes up the legs of a cut.
    fn cut(&mut self, command: &Command, block: Block, sink: &mut dyn FnMut(&Sample)) {
        let Some(order) = self.clock.cut_order(&command.action) else {
            self.end_run(sink);
            let timing = self.clock.advance(command);
            self.stand(timing.seconds, timing.kind, block, sink);
            self.smoother.stand(&self.clock.place());
            return;
        };
        if !self.run.is_open() {
            let waited_s = self.clock.clone().advance_along(command, Some(&order.path)).waited_s;
            self.stand(waited_s, Kind::Spindle, block, sink);
            self.has_others = order.has_others;
            let mut spindle = self.clock.turning_spindle();
            if waited_s > 0.0 || spindle.ramp_rpm_per_s == 0.0 {
                spindle.rpm = self.clock.spindle_order().rpm_at(self.clock.position().x.to_mm());
            }
            self.smoother.stand(&self.clock.place());
            let place = self.clock.place();
            self.lag.iter_mut().for_each(|lag| lag.stand(&place));
            let (feedrate, is_held) = self.acting_panel().cutting(self.mode);
            self.run.begin(self.dynamics.cutting(self.has_others), self.clock.rates(), spindle);
            self.run.pace.preset(feedrate, is_held);
        }
        let mut legs = std::mem::take(&mut self.legs);
        legs.clear();
        order.add_legs(&mut legs);
        for leg in &legs {
            while !self.run.has_room() && !self.is_stuck {
                self.play_run(sink);
            }
            let limit = leg_limit(leg, order.order, &self.clock, &self.dynamics, self.run.pace.limits());
            self.run.push(leg, order.order, limit);
            self.blocks.push_back(block);
        }
        self.legs = legs;
        self.clock.advance_along(command, Some(&order.path));
    }

    /// Plays what is final of the run; whether it is over.
    fn play_run(&mut self, sink: &mut dyn FnMut(&Sample)) -> bool {
        self.run.plan();
        loop {
            let time_s = self.next_s() - self.now_s;
            match self.run.duration_s() {
                Some(duration) if time_s >= duration => {
                    self.now_s += duration;
                    self.let_axes_arrive(sink);
                    return true;
                }
                None if time_s > self.run.pace.planned_s() && !self.run.pace.is_held() => return false,
                _ => {}
            }
            if self.look_at_panel() {
                let (feedrate, is_held) = self.acting_panel().cutting(self.mode);
                self.run.pace.interrupt(time_s, feedrate, is_held);
                self.run.plan();
                continue;
            }
            let rounding_s = if self.run.is_rounded { 2.0 * self.dynamics.corner_s } else { 0.0 };
            let settled_s = time_s - rounding_s;
            if self.run.pace.is_held()
                && self.changes.is_empty()
                && self.run.pace.is_resting(settled_s)
                && self.lag.as_ref().is_none_or(Lag::has_arrived)
            {
                self.is_stuck = true;
                return true;
            }
            let (place, state) = self.run.at(time_s);
            let passed = self.run.forget_before(time_s, state.at_mm);
            self.blocks.drain(..passed.min(self.blocks.len().saturating_sub(1)));
            let place = match &mut self.lag {
                Some(lag) => lag.next(&place),
                None if self.run.is_rounded => self.smoother.next(&place),
                None => place,
            };
            let block = self.blocks.front().copied().unwrap_or(NO_BLOCK);
            self.give(place, state.speed_mm_per_s, block.kind, block, sink);
        }
    }

    /// Behind the last cut the axes come to its end, where they lag behind. Nothing holds them on the way.
    fn let_axes_arrive(&mut self, sink: &mut dyn FnMut(&Sample)) {
        let block = self.blocks.back().copied().unwrap_or(NO_BLOCK);
        loop {
            let Some(lag) = self.lag.as_mut().filter(|lag| !lag.is_still()) else { return };
            let goal = lag.goal();
            // What is left at last is less than an increment, and gone at once.
            let place = if lag.has_arrived() { goal } else { lag.next(&goal) };
            if place == goal {
                lag.stand(&goal);
            }
            self.look_at_panel();
            self.give(place, 0.0, block.kind, block, sink);
            self.now_s = self.next_s();
        }
    }

    /// Comes to rest.
    fn end_run(&mut self, sink: &mut dyn FnMut(&Sample)) {
        if !self.run.is_open() {
            return;
        }
        self.run.close(self.mode);
        while !self.is_stuck && !self.play_run(sink) {}
        self.blocks.clear();
        self.clock.lag_behind(self.run.spindle.rpm);
    }

    /// A rapid: each axis for itself, or X and Z together.
    fn rapid(
        &mut self,
        command: &Command,
        to: Position<WorkTip>,
        path: RapidPath,
        others: Option<&OtherAxes>,
        block: Block,
        sink: &mut dyn FnMut(&Sample),
    ) {
        let (from, end) = (self.clock.place(), Clock::place_after(self.clock.place(), to, others));
        let rates = self.clock.rapid_rates(path);
        let rules = self.clock.rates().panel_rules;
        let way: Place = std::array::from_fn(|axis| end[axis] - from[axis]);
        let is_straight = path.is_straight();
        let section_mm = libm::hypot(way[X], way[Z]);
        // How far the quickest axis of a lane goes on a millimetre of its way.
        let per_way: Place = std::array::from_fn(|axis| match axis {
            X if is_straight && section_mm > 0.0 => way[X].abs().max(way[Z].abs()) / section_mm,
            _ => 1.0,
        });
        let panel = self.acting_panel();
        for axis in 0..AXIS_COUNT {
            let lane = &mut self.lanes[axis];
            let (length, speed, limits) = match axis {
                X if is_straight && section_mm > 0.0 => {
                    let (x, z) = (way[X].abs() / section_mm, way[Z].abs() / section_mm);
                    let limits = self.dynamics.straight(&[x, z, 0.0, 0.0, 0.0, 0.0]);
                    (section_mm, (rates[X] / x).min(rates[Z] / z), limits)
                }
                Z if is_straight => (0.0, rates[Z], self.dynamics.axes[Z].along(1.0)),
                _ => (way[axis].abs(), rates[axis], self.dynamics.axes[axis].along(1.0)),
            };
            lane.begin(limits);
            let (feedrate, is_held) = panel.rapid(&rules, per_way[axis]);
            lane.preset(feedrate, is_held);
            let speed = speed / 60.0;
            if length > 0.0 && speed.is_finite() && speed > 0.0 {
                // An empty lane has room for one.
                let _ = lane.push(length, speed, speed);
            }
            lane.close();
            lane.ease();
        }
        let timing = self.clock.advance(command);
        loop {
            let time_s = self.next_s() - self.now_s;
            self.lanes.iter_mut().for_each(Pace::plan);
            let longest = |known: Option<f64>, lane: &Pace| Some(known?.max(lane.duration_s()?));
            if let Some(duration) = self.lanes.iter().fold(Some(0.0), longest) {
                let settled = duration + if duration > 0.0 { self.dynamics.in_position_s } else { 0.0 };
                if time_s >= settled {
                    self.now_s += settled;
                    // The spindle had more time than at 100 %.
                    self.clock.let_pass(settled - timing.seconds);
                    return;
                }
            }
            if self.look_at_panel() {
                let panel = self.acting_panel();
                for (lane, per_way) in self.lanes.iter_mut().zip(per_way) {
                    let (feedrate, is_held) = panel.rapid(&rules, per_way);
                    lane.interrupt(time_s, feedrate, is_held);
                }
                continue;
            }
            let is_resting = |lane: &Pace| lane.duration_s().is_some() || lane.is_resting(time_s);
            if self.lanes[X].is_held() && self.changes.is_empty() && self.lanes.iter().all(is_resting) {
                self.is_stuck = true;
                return;
            }
            let mut place = from;
            for axis in 0..AXIS_COUNT {
                let of_lane = if is_straight && axis == Z { X } else { axis };
                let lane = &self.lanes[of_lane];
                let part = if lane.end_mm() > 0.0 { lane.at(time_s).at_mm / lane.end_mm() } else { 1.0 };
                place[axis] = if part >= 1.0 { end[axis] } else { from[axis] + way[axis] * part };
            }
            let speed = if is_straight { self.lanes[X].at(time_s).speed_mm_per_s } else { 0.0 };
            self.lanes.iter_mut().for_each(|lane| lane.forget_before(time_s));
            self.give(place, speed, Kind::Rapid, block, sink);
        }
    }

    /// A tap and the spindle that it leads: the place gives the angle.
    fn tap(
        &mut self,
        command: &Command,
        to: Position<WorkTip>,
        lead: Lead,
        block: Block,
        sink: &mut dyn FnMut(&Sample),
    ) {
        let from = self.clock.place();
        let end = Clock::place_after(from, to, None);
        let pace = TapPace::new(&self.clock, to, lead);
        let direction = self.clock.spindle().wanted_rpm(from[X]).signum();
        let start = self.spindle;
        let holds = self.clock.rates().holds_tapping;
        let is_held = |panel: &Panel| holds && panel.is_held;
        self.clock.advance(command);
        let Some(pace) = pace else { return };
        let lane = &mut self.lanes[X];
        lane.begin(pace.limits);
        lane.preset(Feedrate::Override(1.0), is_held(&self.panel));
        // An empty lane has room for one.
        let _ = lane.push(pace.way_mm, pace.speed_mm_per_s, pace.speed_mm_per_s);
        lane.close();
        lane.ease();
        loop {
            let time_s = self.next_s() - self.now_s;
            self.lanes[X].plan();
            if let Some(duration) = self.lanes[X].duration_s().filter(|duration| time_s >= *duration) {
                self.now_s += duration;
                break;
            }
            if self.look_at_panel() {
                self.lanes[X].interrupt(time_s, Feedrate::Override(1.0), is_held(&self.panel));
                continue;
            }
            let lane = &mut self.lanes[X];
            if lane.is_held() && self.changes.is_empty() && lane.is_resting(time_s) {
                self.is_stuck = true;
                break;
            }
            let state = lane.at(time_s);
            lane.forget_before(time_s);
            let part = state.at_mm / pace.way_mm;
            let place = std::array::from_fn(|axis| from[axis] + (end[axis] - from[axis]) * part);
            self.led = Some(SpindleAngle {
                rpm: direction * 60.0 * state.speed_mm_per_s / pace.lead_mm,
                turns: start.turns + state.at_mm / pace.lead_mm,
            });
            self.give(place, state.speed_mm_per_s, Kind::Threading, block, sink);
        }
        self.led = None;
        if !self.is_stuck {
            self.spindle = SpindleAngle { rpm: 0.0, turns: start.turns + pace.way_mm / pace.lead_mm };
        }
    }

    /// Plays the chain of threads that waits.
    fn play_thread(&mut self, sink: &mut dyn FnMut(&Sample)) {
        let Some(chain) = self.thread.take() else { return };
        let block = Block { source: chain.source, line: chain.lines[0], kind: Kind::Threading };
        self.wait_while_held(block, sink);
        if self.is_stuck {
            return;
        }
        self.stand(chain.waited_s, Kind::Spindle, block, sink);
        match ThreadPlan::new(&chain.stretches, chain.rpm) {
            Ok(plan) => {
                let per_second = self.spindle.rpm.abs() / 60.0;
                let next_turns = |player: &Self| {
                    player.spindle.turns + player.turning_s(player.last_s(), player.next_s()) * per_second
                };
                // The next time that the spindle comes to the start.
                let start = chain.start_turns - plan.advance();
                let begin = start + (next_turns(self) - start).ceil();
                self.smoother.stand(&chain.at(0.0).0);
                let is_bent = chain.is_bent();
                let lead_s = if is_bent { self.smoother.delay_ticks() as f64 / self.rate_hz } else { 0.0 };
                let end = begin + plan.revolutions();
                loop {
                    self.look_at_panel();
                    let turns = next_turns(self);
                    let since = turns - begin + lead_s * per_second;
                    if turns >= end + lead_s * per_second || per_second == 0.0 {
                        break;
                    }
                    let (place, line) = chain.at(plan.way_mm(since));
                    let place = if is_bent { self.smoother.next(&place) } else { place };
                    self.give(place, 0.0, Kind::Threading, Block { line, ..block }, sink);
                }
                self.now_s = self.next_s();
            }
            // No thread that a machine could cut: the axes go there, and the alarm says why.
            Err(_) => self.stand(chain.seconds, Kind::Threading, block, sink),
        }
        self.smoother.stand(&self.clock.place());
        let ends_here = self.clock.rates().panel_rules.thread_hold == ThreadHold::AtEnd && !chain.runs_on;
        self.is_hold_deferred = self.panel.is_held && !ends_here;
        self.thread = chain.emptied();
    }

    /// In so many seconds an even spindle turns as far as this one.
    fn turning_s(&self, from_s: f64, to_s: f64) -> f64 {
        self.clock.rates().fluctuation.seconds(from_s, to_s)
    }

    /// When the last sample was.
    fn last_s(&self) -> f64 {
        self.tick.saturating_sub(1) as f64 / self.rate_hz
    }
}
