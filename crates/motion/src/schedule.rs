//! The schedule: what each command takes on a machine whose axes have mass.
//!
//! In: commands in order of execution. Out: each of them with its [`Timing`], in the same order, as soon as it is
//! known. How long a cut takes depends on the cuts behind it, so it comes out later than it went in.
//!
//! Without [`MachineRates::dynamics`] the times are those of the [`Clock`], at once.

use std::collections::VecDeque;

use turnwright_canon::{Action, Command, PathMode};
use turnwright_units::{Position, WorkTip};

use crate::clock::{Clock, SpindleStray, Timing};
use crate::feedrate::Order;
use crate::leg::Leg;
use crate::orders::leg_limit;
use crate::plain::PlainCut;
use crate::run::{CuttingRun, LEGS_MAX};
use crate::smoother::Lag;
use crate::totals::Kind;
use crate::{Dynamics, ESTIMATES, ESTIMATES_WITH_DYNAMICS, MachineRates, Panel};

/// The time of a command, known or in the run that is being planned.
#[derive(Debug)]
struct Entry {
    timing: Timing,
    /// Legs that are not over yet.
    legs: u32,
    /// All its legs have been taken up.
    is_complete: bool,
}

/// Measures commands with the planner.
#[derive(Debug)]
pub struct Schedule {
    clock: Clock,
    planning: Option<Box<Planning>>,
    entries: Entries,
}

/// Commands that have come in and not gone out yet.
#[derive(Debug, Default)]
struct Entries {
    commands: VecDeque<Command>,
    /// For each of them.
    list: VecDeque<Entry>,
    /// So many of the first ones have a time that is known.
    known: usize,
}

impl Entries {
    #[inline]
    fn add(&mut self, command: Command, entry: Entry) {
        self.commands.push_back(command);
        self.list.push_back(entry);
    }

    fn add_known(&mut self, command: Command, timing: Timing) {
        debug_assert_eq!(self.known, self.list.len());
        self.add(command, Entry { timing, legs: 0, is_complete: true });
        self.known += 1;
    }

    fn unknown_count(&self) -> usize {
        self.list.len() - self.known
    }
}

/// The run in progress.
#[derive(Debug)]
struct Planning {
    dynamics: Dynamics,
    run: CuttingRun,
    /// The legs of the command that is being taken up.
    legs: Vec<Leg>,
    /// When the last leg that is over was.
    passed_s: f64,
    /// What it took.
    leg_s: f64,
    /// The time constant of axes that come behind exponentially.
    lag_s: Option<f64>,
    /// Then of the last leg: how far the quickest axis goes on its last millimetre, and its length, mm.
    last: (f64, f64),
    mode: PathMode,
    has_others: bool,
    /// In single-block operation the axes come to rest behind the last cut.
    is_block_over: bool,
}

impl Schedule {
    /// The tool tip at `start`, the spindle standing.
    pub fn new(start: Position<WorkTip>, rates: MachineRates) -> Self {
        let planning = rates.dynamics.filter(|dynamics| dynamics.first_fault().is_none()).map(|dynamics| {
            Box::new(Planning {
                dynamics,
                run: CuttingRun::new(dynamics, false, rates.panel != Panel::default()),
                legs: Vec::new(),
                passed_s: 0.0,
                leg_s: 0.0,
                lag_s: rates.lag_s(),
                last: (0.0, 0.0),
                mode: PathMode::Continuous,
                has_others: false,
                is_block_over: false,
            })
        });
        Self { clock: Clock::new(start, rates), planning, entries: Entries::default() }
    }

    /// Commands whose time is unknown because nothing would turn or move.
    pub const fn unknown_feeds(&self) -> u64 {
        self.clock.unknown_feeds()
    }

    /// The first time that the spindle was not where the watch of its speed wants it.
    pub const fn stray(&self) -> Option<SpindleStray> {
        self.clock.stray()
    }

    /// What the times rest on besides the program: keys of sentences in the report.
    pub const fn estimates(&self) -> &'static [&'static str] {
        if self.planning.is_some() { ESTIMATES_WITH_DYNAMICS } else { ESTIMATES }
    }

    /// The next command.
    pub fn push(&mut self, command: Command) {
        let Some(planning) = &mut self.planning else {
            let timing = self.clock.advance(&command);
            self.entries.add_known(command, timing);
            return;
        };
        if planning.goes_on_plainly()
            && let Some(cut) = self.clock.plain_cut(&command)
        {
            return planning.add_plain(command, &cut, &mut self.entries);
        }
        let goes_on = match &command.action {
            // Overrides begin or cease to act.
            Action::PathMode(mode)
                if (*mode == PathMode::Tapping) != (planning.mode == PathMode::Tapping) =>
            {
                false
            }
            Action::Feed { others, .. } => {
                planning.run.is_open()
                    && planning.mode != PathMode::ExactStop
                    && !planning.is_block_over
                    && others.is_some() == planning.has_others
                    && !self.clock.would_wait()
            }
            // A dry run passes threads as cuts, each from rest.
            Action::Thread { is_chained: true, .. } => {
                planning.run.is_open()
                    && !planning.is_block_over
                    && !planning.has_others
                    && self.clock.dry_thread().is_some()
            }
            Action::PathMode(_) | Action::Message(_) | Action::Output(_) => {
                planning.run.is_open() && self.entries.unknown_count() < 2 * LEGS_MAX
            }
            _ => false,
        };
        if !goes_on {
            planning.end_run(&mut self.clock, &mut self.entries);
        }
        if let Action::PathMode(mode) = &command.action {
            planning.mode = *mode;
        }
        planning.add(command, &mut self.clock, &mut self.entries);
    }

    /// No more commands come: all times are known.
    pub fn finish(&mut self) {
        if let Some(planning) = &mut self.planning {
            planning.end_run(&mut self.clock, &mut self.entries);
        }
    }

    /// The next command whose time is known, with it.
    pub fn next_known(&mut self) -> Option<(Command, Timing)> {
        self.entries.known = self.entries.known.checked_sub(1)?;
        Some((self.entries.commands.pop_front()?, self.entries.list.pop_front()?.timing))
    }
}

impl Planning {
    /// Whether a straight cut of X and Z would go on with the run.
    fn goes_on_plainly(&self) -> bool {
        self.run.is_open() && self.mode != PathMode::ExactStop && !self.has_others
    }

    fn add_plain(&mut self, command: Command, cut: &PlainCut, entries: &mut Entries) {
        while !self.run.has_room() {
            self.run.plan();
            self.take(entries);
        }
        entries.add(command, Entry { timing: cut.timing(), legs: 1, is_complete: true });
        let leg = cut.leg();
        if self.lag_s.is_some() {
            self.last = quickest(&leg);
        }
        let share = self.dynamics.line_share(&leg, self.run.pace.limits(), cut.speed_mm_per_s);
        self.run.push(&leg, Order::Speed(cut.speed_mm_per_s), (f64::INFINITY, share));
    }

    fn add(&mut self, command: Command, clock: &mut Clock, entries: &mut Entries) {
        let (feedrate, is_held) = clock.panel().cutting(self.mode);
        // What stands for ever has no time.
        let cut = if is_held { None } else { clock.cut_order(&command.action) };
        let Some(cut) = cut else {
            let timing = clock.advance(&command);
            if self.run.is_open() {
                entries.add(command, Entry { timing, legs: 0, is_complete: true });
            } else {
                entries.add_known(command, timing);
            }
            return;
        };
        let (order, has_others) = (cut.order, cut.has_others);
        self.legs.clear();
        cut.add_legs(&mut self.legs);
        let path = cut.path;
        let mut spindle = clock.turning_spindle();
        let wanted_rpm = clock.spindle_order().rpm_at(clock.position().x.to_mm());
        let timing = clock.advance_along(&command, Some(&path));
        if !self.run.is_open() {
            self.has_others = has_others;
            if timing.waited_s > 0.0 || spindle.ramp_rpm_per_s == 0.0 {
                spindle.rpm = wanted_rpm;
            }
            self.run.begin(self.dynamics.cutting(has_others), clock.rates(), spindle);
            self.run.pace.preset(feedrate, false);
            self.passed_s = 0.0;
        }
        self.is_block_over = clock.panel().single_block && !command.origin.runs_on;
        let waiting = Timing { seconds: timing.waited_s, ..timing };
        entries.add(command, Entry { timing: waiting, legs: 0, is_complete: false });
        for leg in 0..self.legs.len() {
            while !self.run.has_room() {
                self.run.plan();
                self.take(entries);
            }
            let leg = &self.legs[leg];
            let limit = leg_limit(leg, order, clock, &self.dynamics, self.run.pace.limits());
            if let Some(entry) = entries.list.back_mut() {
                entry.legs += 1;
            }
            if self.lag_s.is_some() {
                self.last = quickest(leg);
            }
            self.run.push(leg, order, limit);
        }
        if let Some(entry) = entries.list.back_mut() {
            entry.is_complete = true;
        }
    }

    /// Takes the times that are known.
    fn take(&mut self, entries: &mut Entries) {
        while let Some(entry) = entries.list.get_mut(entries.known) {
            while entry.legs > 0 {
                let Some(end_s) = self.run.take_end() else { return };
                self.leg_s = end_s - self.passed_s;
                entry.timing.seconds += self.leg_s;
                self.passed_s = end_s;
                entry.legs -= 1;
            }
            if !entry.is_complete {
                return;
            }
            entries.known += 1;
        }
    }

    /// Seconds beyond those of settling until axes that lag behind are at the end of the run: as if the tool had gone all
    /// of it as it went at last.
    fn arriving_s(&self, lag_s: f64) -> f64 {
        let in_position_s = if self.mode == PathMode::ExactStop { self.dynamics.in_position_s } else { 0.0 };
        let settling_s = 2.0 * self.dynamics.corner_s + in_position_s;
        let (share, length_mm) = self.last;
        let speed = share * length_mm / (self.leg_s - settling_s).max(f64::MIN_POSITIVE);
        (Lag::rest_s(lag_s, speed, (self.passed_s - settling_s).max(0.0)) - settling_s).max(0.0)
    }

    /// Comes to rest.
    fn end_run(&mut self, clock: &mut Clock, entries: &mut Entries) {
        if !self.run.is_open() {
            return;
        }
        self.run.close(self.mode);
        let is_cut = entries.unknown_count() > 0;
        while entries.unknown_count() > 0 {
            self.run.plan();
            self.take(entries);
        }
        let lag_s = self.lag_s.filter(|_| is_cut);
        if let Some(arriving_s) = lag_s.map(|lag_s| self.arriving_s(lag_s)) {
            let is_cut = |entry: &&mut Entry| matches!(entry.timing.kind, Kind::Cutting | Kind::Threading);
            entries
                .list
                .iter_mut()
                .rev()
                .find(is_cut)
                .into_iter()
                .for_each(|last| last.timing.seconds += arriving_s);
        }
        clock.lag_behind(self.run.spindle.rpm);
    }
}

/// How far the quickest axis goes on the last millimetre of a leg, and the length of the leg, mm.
fn quickest(leg: &Leg) -> (f64, f64) {
    (leg.heading(1.0).direction.into_iter().fold(0.0, |most: f64, way| most.max(way.abs())), leg.length_mm)
}
