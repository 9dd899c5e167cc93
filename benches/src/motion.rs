//! The planner, measured: cost of a path from rest to rest (T1), of a leg (T2), of a tick (T3), limits over many ticks
//! (T4), and how much faster than the machine a whole job is run (T5, in [`crate::job`]).
//!
//! The peer of T1 is the crate `rsruckig`, which finds the fastest motion there is: its time is the yardstick for ours.

use std::time::Instant;

use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, ThrowErrorHandler, Trajectory};
use turnwright_canon::{Action, Command, Origin, Shape, Turn};
use turnwright_dice::Dice;
use turnwright_motion::planner::{Pace, RunLimits};
use turnwright_motion::{Dynamics, MachineRates, Player, Sample, Schedule};
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

use crate::board::Board;
use crate::{job, linuxcnc};

/// Seconds on the processor: what others do meanwhile does not count. Elsewhere than on Linux, the wall's.
fn processor_s(began: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().next().and_then(|field| field.parse::<f64>().ok());
    nanoseconds.map_or_else(|| began.elapsed().as_secs_f64(), |nanoseconds| nanoseconds / 1e9)
}

/// Measures processor time.
pub struct Stopwatch {
    began: Instant,
    at_start_s: f64,
}

impl Stopwatch {
    /// From now on.
    pub fn start() -> Self {
        let began = Instant::now();
        Self { began, at_start_s: processor_s(began) }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        processor_s(self.began) - self.at_start_s
    }

    fn nanoseconds_each(&self, count: usize) -> f64 {
        self.seconds() * 1e9 / count as f64
    }
}

/// Prints the table; `samples` ticks are looked at for limits.
pub fn run(samples: u64, board: &mut Board) -> Result<(), String> {
    segments(board)?;
    legs();
    linuxcnc::run(board)?;
    ticks(board);
    job::run((samples / 4).max(1_000_000), board)?;
    programs(samples, board)
}

/// T1: rest to rest on a straight line, ours and the optimum.
fn segments(board: &mut Board) -> Result<(), String> {
    const COUNT: usize = 400_000;
    let limits = RunLimits { acceleration_mm_per_s2: 3000.0, jerk_mm_per_s3: 150_000.0 };
    let mut slowest = 0.0f64;
    for (name, shortest, longest) in
        [("0.05 to 0.5 mm", 0.05, 0.5), ("0.5 to 5 mm", 0.5, 5.0), ("5 to 200 mm", 5.0, 200.0)]
    {
        let mut dice = Dice::new(1);
        let ways: Vec<f64> = (0..COUNT).map(|_| dice.size(shortest, longest)).collect();
        let mut pace = Pace::with_capacity(4, limits);
        let started = Stopwatch::start();
        let mut ours_s = 0.0;
        for way in &ways {
            pace.begin(limits);
            let _ = pace.push(*way, 200.0, 200.0);
            pace.close();
            pace.ease();
            pace.plan();
            ours_s += pace.duration_s().unwrap_or(f64::NAN);
        }
        let ours_ns = started.nanoseconds_each(COUNT);
        let mut otg = Ruckig::<1, ThrowErrorHandler>::new(None, 0.001);
        let mut input = InputParameter::<1>::new(None);
        let one = |value: f64| DataArrayOrVec::Stack([value]);
        input.max_velocity = one(200.0);
        input.max_acceleration = one(3000.0);
        input.max_jerk = one(150_000.0);
        let mut trajectory = Trajectory::<1>::new(None);
        let started = Stopwatch::start();
        let mut optimum_s = 0.0;
        for way in &ways {
            input.target_position = one(*way);
            otg.calculate(&input, &mut trajectory).map_err(|error| format!("{error:?}"))?;
            optimum_s += trajectory.get_duration();
        }
        let theirs_ns = started.nanoseconds_each(COUNT);
        if shortest == 5.0 {
            board.note("T1", theirs_ns / ours_ns);
        } else if longest == 0.5 {
            board.note("T1 short", theirs_ns / ours_ns);
        }
        println!(
            "T1 rest to rest, {name:15} {ours_ns:7.0} ns, rsruckig {theirs_ns:6.0} ns: ratio {:5.1}; machine time {:.3} x the optimum",
            theirs_ns / ours_ns,
            ours_s / optimum_s
        );
        slowest = slowest.max(ours_s / optimum_s);
    }
    board.note("T1 time", slowest);
    Ok(())
}

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn at(x: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

fn rates() -> MachineRates {
    MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() }
}

/// Short lines along a wave, as a CAM system would give them.
fn wave(count: usize, mm: f64, mm_per_min: f64) -> Vec<Command> {
    let feed = Feed::PerMinute(FeedPerMinute(length(mm_per_min)));
    let place = |index: usize| {
        let way = index as f64 * mm;
        at(30.0 + 2.0 * (way / 5.0).sin(), -0.8 * way)
    };
    let line = |index: usize| Action::Feed { to: place(index), shape: Shape::Line, feed, others: None };
    (1..=count).map(|index| Command::new(line(index), Origin::line(index as u32))).collect()
}

/// T2: what a leg costs until its time is known, corners and look-ahead included.
fn legs() {
    const COUNT: usize = 400_000;
    for mm_per_min in [200.0, 3000.0] {
        let commands = wave(COUNT, 0.13, mm_per_min);
        let mut schedule = Schedule::new(at(30.0, 0.0), rates());
        let started = Stopwatch::start();
        let mut seconds = 0.0;
        for command in commands {
            schedule.push(command);
            while let Some((_, timing)) = schedule.next_known() {
                seconds += timing.seconds;
            }
        }
        schedule.finish();
        while let Some((_, timing)) = schedule.next_known() {
            seconds += timing.seconds;
        }
        let ns = started.nanoseconds_each(COUNT);
        println!(
            "T2 legs of 0.13 mm at F{mm_per_min:<5} {ns:7.0} ns a leg, look-ahead 2048; {seconds:.0} s of machine time"
        );
    }
}

/// T3: a tick of the path, and the longest ones.
fn ticks(board: &mut Board) {
    let limits = Dynamics::default();
    let along = RunLimits {
        acceleration_mm_per_s2: limits.axes[0].acceleration_per_s2 / 4.0,
        jerk_mm_per_s3: limits.axes[0].jerk_per_s3 * 0.3,
    };
    let mut dice = Dice::new(7);
    let mut pace = Pace::with_capacity(2048, along);
    let mut nanoseconds = Vec::with_capacity(4_000_000);
    let mut tick = 0u32;
    let mut pushed = 0;
    while nanoseconds.len() < 2_000_000 && pushed < 3_000_000 {
        while pace.has_room(2) {
            let _ = pace.push(dice.size(0.05, 0.5), dice.size(5.0, 40.0), 133.0);
            pushed += 1;
        }
        pace.plan();
        while f64::from(tick) * 1e-3 < pace.planned_s() {
            let started = Instant::now();
            let state = pace.at(f64::from(tick) * 1e-3);
            pace.forget_before(f64::from(tick) * 1e-3);
            nanoseconds.push(started.elapsed().as_nanos() as u32);
            std::hint::black_box(state);
            tick += 1;
        }
    }
    nanoseconds.sort_unstable();
    let of = |part: f64| nanoseconds[((nanoseconds.len() - 1) as f64 * part) as usize];
    let mean = nanoseconds.iter().map(|ns| u64::from(*ns)).sum::<u64>() as f64 / nanoseconds.len() as f64;
    board.note("T3 path", mean);
    board.note("T3 p99.9", f64::from(of(0.999)));
    println!(
        "T3 a tick of the path: mean {mean:.0} ns, p99 {} ns, p99.9 {} ns ({} ticks, the clock's own cost included)",
        of(0.99),
        of(0.999),
        nanoseconds.len()
    );
}

/// Lines and small arcs in every direction, at any feed.
fn program(seed: u64, size: f64) -> Vec<Command> {
    let mut dice = Dice::new(seed * 977 + 3);
    let (mut x, mut z) = (30.0, 0.0);
    (0..400)
        .map(|index| {
            let (dx, dz) = (size * (dice.part() - 0.5), size * (dice.part() - 0.6));
            let shape = if dice.part() < 0.4 {
                let turn = if dice.part() < 0.5 { Turn::Clockwise } else { Turn::CounterClockwise };
                Shape::Arc { turn, centre: at(x + dx / 2.0, z + dz / 2.0) }
            } else {
                Shape::Line
            };
            (x, z) = (x + dx, z + dz);
            let feed = Feed::PerMinute(FeedPerMinute(length(dice.size(20.0, 6000.0))));
            Command::new(Action::Feed { to: at(x, z), shape, feed, others: None }, Origin::line(index))
        })
        .collect()
}

/// T4: programs played at a thousand ticks a second, each axis looked at.
fn programs(samples: u64, board: &mut Board) -> Result<(), String> {
    let dynamics = Dynamics::default();
    let (mut ticks, mut violations, mut seed) = (0u64, 0u64, 0u64);
    while ticks < samples {
        let commands = program(seed, [10.0, 1.0, 0.1][(seed % 3) as usize]);
        let mut places: Vec<[f64; 2]> = Vec::new();
        let mut player = Player::new(at(30.0, 0.0), rates(), 1000.0);
        let mut sink = |sample: &Sample| places.push([sample.place[0], sample.place[1]]);
        for command in &commands {
            player.push(command, &mut sink);
        }
        player.finish(&mut sink);
        ticks += places.len() as u64;
        for axis in 0..2 {
            let limits = dynamics.axes[axis];
            for window in places.windows(4) {
                let [p0, p1, p2, p3] = [0, 1, 2, 3].map(|index: usize| window[index][axis]);
                let acceleration = (p3 - 2.0 * p2 + p1) * 1e6;
                let jerk = (p3 - 3.0 * p2 + 3.0 * p1 - p0) * 1e9;
                let is_over = acceleration.abs() > limits.acceleration_per_s2 * (1.0 + 1e-5)
                    || jerk.abs() > limits.jerk_per_s3 * (1.0 + 1e-5) + 1.0;
                violations += u64::from(is_over);
            }
        }
        seed += 1;
    }
    board.note("T4", violations as f64);
    println!("T4 limits of acceleration and jerk passed: {violations} in {ticks} ticks of {seed} programs");
    if violations == 0 { Ok(()) } else { Err(format!("{violations} samples beyond a limit")) }
}
