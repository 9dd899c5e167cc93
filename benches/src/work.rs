//! Small pieces of work whose instructions are counted: `work NAME COUNT`.
//!
//! Everything is made in memory, the same on every machine and for every count: programs are as long whether they are
//! run or not. With a count of 0 a piece does all but its work, so that the difference of two runs is the work alone.

use std::fmt::Write;

use turnwright_canon::{Action, Command, Origin, Shape};
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_export::formats::jsonl::CommandWriter;
use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};
use turnwright_motion::{Dynamics, LEGS_MAX, MachineRates, Panel, Player, Schedule};
use turnwright_stock::{Cutter, Section, Sweep};
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

/// Does something so many times.
type Work = fn(u32) -> Result<(), String>;

/// The pieces.
const PIECES: [(&str, Work); 8] = [
    ("lines", |count| interpret(&lines(), count, false)),
    ("arcs", |count| interpret(&arcs(), count, false)),
    ("loop", |count| interpret(ROUNDS, count, false)),
    ("roughing", |count| interpret(&roughing(), count, false)),
    ("trace", |count| interpret(&lines(), count, true)),
    ("stock", stock),
    ("planner", planner),
    ("overrides", overrides),
];

/// Blocks of the programs that are written out: as many as are ever counted.
const BLOCKS: u32 = 10_000;

/// A move in every round, for ever.
const ROUNDS: &str = "#1=0\nWHILE[1 EQ 1]DO1\n#2=20+SIN[#1*0.36]\nG1 X[#2*2] Z[0-#1*0.001]\n#1=#1+1\nEND1\n";

/// Does a piece of work.
pub fn run(name: &str, count: u32) -> Result<(), String> {
    let piece = PIECES.iter().find(|(piece, _)| *piece == name);
    let known = || PIECES.map(|(piece, _)| piece).join(", ");
    piece.map_or_else(|| Err(format!("no work is called {name}: {}", known())), |(_, work)| work(count))
}

/// A program in memory.
pub struct Memory(pub Vec<u8>);

impl Environment for Memory {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = usize::try_from(offset).ok().and_then(|offset| self.0.get(offset..)).unwrap_or_default();
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

/// Runs a program until it has made so many moves.
fn interpret(program: &str, count: u32, lists: bool) -> Result<(), String> {
    let control = Control::load("fanuc-0i-tf").map_err(|fault| format!("{fault:?}"))?;
    let mut memory = Memory(format!("O1000\nG98 M3 S1000\nG0 X100. Z2.\nF200.\n{program}M30\n").into_bytes());
    let mut interpreter = Interpreter::new(control, &Setup::default(), SourceId(0), Options::default())
        .map_err(|fault| fault.message)?;
    let mut out = Vec::with_capacity(1 << 16);
    let mut writer = CommandWriter::new(3);
    let mut moves = 0;
    while moves < count {
        match interpreter.step(&mut memory) {
            Step::Emit(command) => {
                moves += u32::from(command.action.end_point().is_some());
                if lists {
                    writer.write(&mut out, &command);
                }
                if out.len() > 1 << 15 {
                    out.clear();
                }
            }
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => return Err(format!("alarm {} at {:?}", alarm.key, alarm.place)),
            Step::End => return Err(format!("only {moves} moves")),
        }
    }
    Ok(())
}

fn lines() -> String {
    let mut text = String::new();
    for index in 0..BLOCKS {
        let (x, z) = (40_000 + index * 7919 % 50_000, index * 104_729 % 200_000);
        let _ = writeln!(text, "G1 X{}.{:03} Z-{}.{:03}", x / 1000, x % 1000, z / 1000, z % 1000);
    }
    text
}

/// Quarter arcs, out and in again.
fn arcs() -> String {
    let mut text = String::from("G1 X40. Z0\n");
    for index in 0..BLOCKS {
        let (code, way) = if index % 2 == 0 { (2, 4) } else { (3, -4) };
        let _ = writeln!(text, "G{code} U{way}. W-2. R2.");
    }
    text
}

/// G71 on twenty steps with cones, again and again.
fn roughing() -> String {
    let mut figure = String::new();
    for step in 0..20 {
        let (x, z) = (20 + 4 * step, -2 * step);
        let _ = writeln!(figure, "G1 X{x}. Z{}.\nG1 X{}. Z{}.", z - 1, x + 4, z - 2);
    }
    format!(
        "WHILE[1 EQ 1]DO1\nG71 U0.1 R0.1\nG71 P100 Q200 U0.4 W0.1\nN100 G0 X20.\n{figure}N200 G1 X100.\n\
         END1\n"
    )
}

/// A nose with upright sides goes along wavy lines, each deeper than the one before.
fn stock(count: u32) -> Result<(), String> {
    let nose = 0.4;
    let at = Point::new;
    let line = |start, end| Segment { start, end, bend: None };
    let (left, right) = (at(0.0, -nose), at(0.0, nose));
    let (top_left, top_right) = (at(60.0, -nose), at(60.0, nose));
    let bend = Some(Bend { centre: at(0.0, 0.0), clockwise: false });
    let outline = Outline::new(vec![
        Segment { start: left, end: right, bend },
        line(right, top_right),
        line(top_right, top_left),
        line(top_left, left),
    ]);
    let cutter = Cutter::new(&outline.map_err(|fault| format!("{fault:?}"))?);
    let mut section = Section::bar(50.0, -100.0, 0.0).map_err(|fault| format!("{fault:?}"))?;
    let mut sweep = Sweep::new();
    let place = |index: u32| {
        let (pass, step) = (index / 1000, index % 1000);
        let z = -0.1 * (f64::from(step) - 0.037 * f64::from(pass));
        at(48.0 - 2.0 * f64::from(pass) + 0.25 * (z * 1.3 + f64::from(pass)).sin(), z)
    };
    let mut removed_mm2 = 0.0;
    for index in 0..count {
        if (index + 1) % 1000 != 0 {
            removed_mm2 += section.cut(sweep.line(&cutter, place(index), place(index + 1))).area_mm2;
        }
    }
    std::hint::black_box(removed_mm2);
    Ok(())
}

/// Short lines along a wave are planned.
/// The dearest ticks of the player: as many short lines are known ahead as ever are, and in each tick the operator turns
/// the feed override, so that all of them are planned anew.
fn overrides(count: u32) -> Result<(), String> {
    let length = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
    let at = |x: f64, z: f64| -> Position<WorkTip> { Position::new(Radius(length(x)), length(z)) };
    let feed = Feed::PerMinute(FeedPerMinute(length(1200.0)));
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let mut player = Player::new(at(30.0, 0.0), rates, 1000.0);
    for tick in 1..=count {
        let feed = [1.0, 0.9, 1.1, 0.6, 1.3][tick as usize % 5];
        player.set_at(f64::from(tick) / 1000.0, Panel { feed, ..Panel::default() });
    }
    let mut ticks = 0;
    let mut index = 0;
    // At 20 mm/s a tick passes two lines at most.
    while ticks < count {
        index += 1;
        if index > LEGS_MAX as u32 + 2 * count {
            return Err(format!("only {ticks} ticks"));
        }
        let way = f64::from(index) * 0.01;
        let to = at(30.0 + 0.2 * (way * 3.0).sin() + [0.0, 0.003][index as usize % 2], -way);
        let action = Action::Feed { to, shape: Shape::Line, feed, others: None };
        player.push(&Command::new(action, Origin::line(index)), &mut |_| ticks += 1);
    }
    std::hint::black_box(player.played_s());
    Ok(())
}

fn planner(count: u32) -> Result<(), String> {
    let length = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
    let at = |x: f64, z: f64| -> Position<WorkTip> { Position::new(Radius(length(x)), length(z)) };
    let feed = Feed::PerMinute(FeedPerMinute(length(3000.0)));
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let mut schedule = Schedule::new(at(30.0, 0.0), rates);
    let mut seconds = 0.0;
    for index in 1..=count {
        let way = f64::from(index) * 0.13;
        let to = at(30.0 + 2.0 * (way / 5.0).sin(), -0.8 * way);
        let action = Action::Feed { to, shape: Shape::Line, feed, others: None };
        schedule.push(Command::new(action, Origin::line(index)));
        while let Some((_, timing)) = schedule.next_known() {
            seconds += timing.seconds;
        }
    }
    schedule.finish();
    while let Some((_, timing)) = schedule.next_known() {
        seconds += timing.seconds;
    }
    std::hint::black_box(seconds);
    Ok(())
}
