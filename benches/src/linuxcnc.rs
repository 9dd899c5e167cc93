//! The planner beside LinuxCNC's (T2, T3, T6): the same places, the same largest speeds and accelerations, in turn.
//!
//! Theirs is the module of the installed package, called by a small program that is compiled here from `linuxcnc.c`
//! and the headers of its development package; without both the rows stay empty.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use turnwright_canon::{Action, Command as Order, Origin, RapidPath, Shape};
use turnwright_dice::Dice;
use turnwright_motion::{Dynamics, Kind, MachineRates, Player, Sample, Schedule};
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

use crate::board::Board;
use crate::motion::Stopwatch;

/// Lines of a path.
const COUNT: usize = 20_000;
/// How often both sides are run in turn.
const ROUNDS: usize = 5;
/// So often, and for so many ticks, ours is run each time.
const REPEATS: usize = 20;
const TICKS_MIN: usize = 500_000;
/// Largest speed of both axes, mm/s; their acceleration, mm/s²; how far the other side may leave the path, mm.
const RAPID: f64 = 200.0;
const ACCELERATION: f64 = 3000.0;
const TOLERANCE: f64 = 0.01;
/// Jerk of a machine that jerks: as good as none is limited, as on the other side, mm/s³.
const FREE_JERK: f64 = 1e7;
/// Seconds in which its axes change their speed at a corner.
const FREE_CORNER_S: f64 = 0.005;

/// X and Z, mm.
type Place = (f64, f64);

/// Back and forth: X goes any way, Z slowly on, as in the programs of [`crate::generate`].
fn zigzag() -> Vec<Place> {
    let mut dice = Dice::new(88_172_645_463_325_252);
    let (mut x, mut z) = (40.0, 0.0);
    let mut places = vec![(x, z)];
    for _ in 0..COUNT {
        x = f64::clamp(x + (dice.part() - 0.5) * 0.5, 5.0, 60.0);
        z -= dice.part() * 0.02;
        places.push((x, z));
    }
    places
}

/// A smooth contour in short lines.
fn wave() -> Vec<Place> {
    let place = |index: usize| {
        let way = index as f64 * 0.13;
        (30.0 + 2.0 * (way / 5.0).sin(), -0.8 * way)
    };
    (0..=COUNT).map(place).collect()
}

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn at((x, z): Place) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

fn commands(path: &[Place], mm_per_min: f64) -> Vec<Order> {
    let feed = Feed::PerMinute(FeedPerMinute(length(mm_per_min)));
    let line = |(index, place): (usize, &Place)| {
        let action = Action::Feed { to: at(*place), shape: Shape::Line, feed, others: None };
        Order::new(action, Origin::line(index as u32 + 1))
    };
    path[1..].iter().enumerate().map(line).collect()
}

fn rates(jerk_per_s3: f64) -> MachineRates {
    let mut dynamics = Dynamics::default();
    if jerk_per_s3 == FREE_JERK {
        // A machine that does not jerk gets round its corners sooner, and both sides may leave the path as far.
        dynamics.corner_s = FREE_CORNER_S;
    }
    for axis in &mut dynamics.axes[..2] {
        (axis.acceleration_per_s2, axis.jerk_per_s3) = (ACCELERATION, jerk_per_s3);
    }
    let rapid_mm_per_min = RAPID * 60.0;
    MachineRates {
        rapid_x_mm_per_min: rapid_mm_per_min,
        rapid_z_mm_per_min: rapid_mm_per_min,
        cutting_max_mm_per_min: rapid_mm_per_min,
        dynamics: Some(dynamics),
        ..MachineRates::default()
    }
}

/// What a path takes.
#[derive(Clone, Copy, Debug)]
struct Cost {
    /// Nanoseconds a line, look-ahead included.
    line_ns: f64,
    /// Nanoseconds a tick; of ours with everything that it takes.
    tick_ns: f64,
    /// Seconds of machine time.
    machine_s: f64,
}

/// What a path that was played keeps.
struct Kept {
    /// How far it leaves the path given, mm.
    off_mm: f64,
    /// The largest acceleration of an axis from tick to tick, mm/s².
    acceleration: f64,
}

impl Kept {
    fn of(path: &[Place], played: &[Place]) -> Self {
        let accelerations = played.windows(3).flat_map(|places| {
            let [p0, p1, p2] = [places[0], places[1], places[2]];
            [p2.0 - 2.0 * p1.0 + p0.0, p2.1 - 2.0 * p1.1 + p0.1]
        });
        Self {
            off_mm: off(path, played),
            acceleration: 1e6 * accelerations.fold(0.0f64, |most, change| most.max(change.abs())),
        }
    }
}

/// How far places lie off a path at most; they come in its order.
fn off(path: &[Place], places: &[Place]) -> f64 {
    const AHEAD: usize = 24;
    let (mut first, mut most) = (0, 0.0f64);
    for &(x, z) in places {
        let reach = first..(first + AHEAD).min(path.len() - 1);
        let near = reach.map(|index| {
            let ((ax, az), (bx, bz)) = (path[index], path[index + 1]);
            let (dx, dz) = (bx - ax, bz - az);
            let part = (((x - ax) * dx + (z - az) * dz) / (dx * dx + dz * dz)).clamp(0.0, 1.0);
            ((x - ax - dx * part).hypot(z - az - dz * part), index)
        });
        let Some((distance, index)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        most = most.max(distance);
        first = index.saturating_sub(2).max(first);
    }
    most
}

/// Seconds of the cuts whose time is known by now.
fn cutting_s(schedule: &mut Schedule) -> f64 {
    let known = std::iter::from_fn(|| schedule.next_known());
    known.filter(|(_, timing)| timing.kind == Kind::Cutting).map(|(_, timing)| timing.seconds).sum()
}

/// The schedule's cost of a line, the player's of a tick, and where that one was.
fn ours(path: &[Place], mm_per_min: f64, jerk_per_s3: f64) -> (Cost, Vec<Place>) {
    let given = commands(path, mm_per_min);
    let (start, rates) = (at(path[0]), rates(jerk_per_s3));
    // The counter moves in steps of some milliseconds, so that the path is gone again and again.
    let back = Action::Rapid { to: start, path: RapidPath::Straight, others: None };
    let back = Order::new(back, Origin::line(0));
    let commands: Vec<Order> =
        (0..REPEATS).flat_map(|_| given.iter().cloned().chain([back.clone()])).collect();
    let mut schedule = Schedule::new(start, rates);
    let mut machine_s = 0.0;
    let watch = Stopwatch::start();
    for command in commands {
        schedule.push(command);
        machine_s += cutting_s(&mut schedule);
    }
    schedule.finish();
    machine_s += cutting_s(&mut schedule);
    let line_ns = watch.seconds() * 1e9 / (COUNT * REPEATS) as f64;
    machine_s /= REPEATS as f64;
    let mut played = Vec::with_capacity((machine_s * 1000.0) as usize + 100);
    let (watch, mut ticks) = (Stopwatch::start(), 0);
    while ticks < TICKS_MIN {
        played.clear();
        let mut player = Player::new(start, rates, 1000.0);
        let mut sink = |sample: &Sample| played.push((sample.place[0], sample.place[1]));
        for command in &given {
            player.push(command, &mut sink);
        }
        player.finish(&mut sink);
        ticks += played.len();
    }
    let tick_ns = watch.seconds() * 1e9 / ticks as f64;
    (Cost { line_ns, tick_ns, machine_s }, played)
}

/// Their planner.
struct Peer {
    program: PathBuf,
    module: PathBuf,
}

impl Peer {
    /// Compiles the program that calls it; why not, when that cannot be.
    fn find(folder: &Path) -> Result<Self, &'static str> {
        let module = Path::new("/usr/lib/linuxcnc/modules/tpmod.so");
        let headers = Path::new("/usr/include/linuxcnc");
        if !module.exists() {
            return Err("linuxcnc-uspace is not installed");
        }
        if !headers.join("tp.h").exists() {
            return Err("linuxcnc-uspace-dev is not installed");
        }
        let program = folder.join("linuxcnc-planner");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("linuxcnc.c");
        let built = Command::new("cc")
            .args(["-O2", "-w", "-rdynamic", "-DRTAPI", "-I"])
            .arg(headers)
            .arg(&source)
            .arg("-o")
            .arg(&program)
            .args(["-ldl", "-lm"])
            .stderr(Stdio::null())
            .status();
        if !built.is_ok_and(|status| status.success()) {
            return Err("linuxcnc.c does not compile here");
        }
        Ok(Self { program, module: module.to_path_buf() })
    }

    fn run(&self, path: &[Place], mm_per_min: f64) -> Result<Cost, String> {
        let said = self.says(path, mm_per_min, &[])?;
        match said.as_slice() {
            [line_ns, tick_ns, machine_s] => {
                Ok(Cost { line_ns: *line_ns, tick_ns: *tick_ns, machine_s: *machine_s })
            }
            _ => Err("LinuxCNC's planner does not say what it took".to_string()),
        }
    }

    fn plays(&self, path: &[Place], mm_per_min: f64) -> Result<Vec<Place>, String> {
        let said = self.says(path, mm_per_min, &["places"])?;
        // The costs come last.
        Ok(said[..said.len() - 3].chunks_exact(2).map(|place| (place[0], place[1])).collect())
    }

    /// The numbers that the program prints.
    fn says(&self, path: &[Place], mm_per_min: f64, also: &[&str]) -> Result<Vec<f64>, String> {
        let mut text = String::new();
        for (x, z) in path {
            let _ = writeln!(text, "{x:.6} {z:.6}");
        }
        let numbers = [mm_per_min / 60.0, ACCELERATION, TOLERANCE, RAPID].map(|number| number.to_string());
        let mut child = Command::new(&self.program)
            .arg(&self.module)
            .args(numbers)
            .args(also)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| error.to_string())?;
        // It reads all of it before it writes anything.
        child
            .stdin
            .take()
            .ok_or("no input")?
            .write_all(text.as_bytes())
            .map_err(|error| error.to_string())?;
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        if !output.status.success() {
            return Err("LinuxCNC's planner failed".to_string());
        }
        let said = String::from_utf8_lossy(&output.stdout);
        said.split_whitespace().map(|word| word.parse().map_err(|_| format!("{word} is no number"))).collect()
    }
}

/// A path at a feed, and the goals that are measured with it.
struct Row {
    name: &'static str,
    path: Vec<Place>,
    mm_per_min: f64,
    /// The cost of a line, that of a tick, machine time with jerk as free as theirs and with that of a machine.
    goals: [Option<&'static str>; 4],
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// Runs both sides in turn.
pub fn run(board: &mut Board) -> Result<(), String> {
    let folder = std::env::temp_dir().join("turnwright-bench");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let peer = Peer::find(&folder);
    let row = |name, path, mm_per_min, goals| Row { name, path, mm_per_min, goals };
    let rows = [
        row("zigzag", zigzag(), 200.0, [Some("T2"), None, None, None]),
        row("zigzag", zigzag(), 3000.0, ["T2 fast", "T3", "T6", "T6 jerk"].map(Some)),
        row("wave", wave(), 200.0, [None; 4]),
        row("wave", wave(), 3000.0, ["T2 smooth", "T3 smooth", "T6 smooth", "T6 smooth jerk"].map(Some)),
    ];
    if let Err(reason) = &peer {
        println!("T2, T3, T6 beside LinuxCNC's planner: not measured, {reason}");
        rows.iter().flat_map(|row| row.goals).flatten().for_each(|goal| board.excuse(goal, reason));
    }
    for row in &rows {
        measure(row, peer.as_ref().ok(), board)?;
    }
    Ok(())
}

fn measure(row: &Row, peer: Option<&Peer>, board: &mut Board) -> Result<(), String> {
    let Row { name, path, mm_per_min, .. } = row;
    let jerk_per_s3 = Dynamics::default().axes[0].jerk_per_s3;
    let (mut lines, mut ticks, mut times) = (Vec::new(), Vec::new(), None);
    for round in 0..ROUNDS {
        let (mine, played) = ours(path, *mm_per_min, jerk_per_s3);
        let (free, freely_played) = ours(path, *mm_per_min, FREE_JERK);
        let theirs = peer.map(|peer| peer.run(path, *mm_per_min)).transpose()?;
        if let Some(theirs) = &theirs {
            lines.push(theirs.line_ns / mine.line_ns);
            ticks.push(theirs.tick_ns / mine.tick_ns);
            times = Some([free.machine_s / theirs.machine_s, mine.machine_s / theirs.machine_s]);
        }
        if round + 1 < ROUNDS {
            continue;
        }
        let show = |who: &str, cost: &Cost, played: &[Place]| {
            let kept = Kept::of(path, played);
            println!(
                "{name:6} F{mm_per_min:<4} {who:15} {:5.0} ns a line, {:4.0} ns a tick, {:8.3} s of machine time; {:.1} µm off the path, {:.2} x the acceleration",
                cost.line_ns,
                cost.tick_ns,
                cost.machine_s,
                1e3 * kept.off_mm,
                kept.acceleration / ACCELERATION
            );
        };
        show("ours", &mine, &played);
        show("ours, free jerk", &free, &freely_played);
        if let (Some(theirs), Some(peer)) = (&theirs, peer) {
            show("LinuxCNC", theirs, &peer.plays(path, *mm_per_min)?);
        }
    }
    let Some([free, limited]) = times else { return Ok(()) };
    let (line_ratio, tick_ratio) = (median(lines), median(ticks));
    println!(
        "{name:6} F{mm_per_min:<4} a line {line_ratio:.1} x as fast, a tick {tick_ratio:.1} x; machine time {free:.3} x theirs, {limited:.3} x with jerk"
    );
    for (goal, figure) in row.goals.into_iter().zip([line_ratio, tick_ratio, free, limited]) {
        if let Some(goal) = goal {
            board.note(goal, figure);
        }
    }
    Ok(())
}
