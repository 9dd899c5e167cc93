//! Playing allocates nothing, whatever is played and however long it takes.
//!
//! What is counted: everything that [`Player::push`] and [`Player::finish`] ask of the allocator, the taking up of each
//! command and all ticks that are played with it. The commands themselves are made before, and the operator's changes
//! given before. The count is that of the test's own thread.

use turnwright_canon::{
    Action, Command, Dwell, Origin, PathMode, RapidPath, Shape, SpindleSpeed, SpindleState, Turn,
};
use turnwright_motion::{Dynamics, Kind, MachineRates, Panel, Player, Sample};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, Seconds,
    SurfaceSpeed, WorkTip,
};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// Radius and Z in mm.
fn at(x: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

fn cut(x: f64, z: f64, shape: Shape, feed: Feed) -> Action {
    Action::Feed { to: at(x, z), shape, feed, others: None }
}

fn thread(x: f64, z: f64, is_chained: bool) -> Action {
    Action::Thread {
        to: at(x, z),
        shape: Shape::Line,
        lead: Lead(length(1.5)),
        lead_end: None,
        start_angle: Angle::ZERO,
        is_chained,
    }
}

fn spindle(speed: SpindleSpeed) -> Action {
    Action::Spindle { state: SpindleState::Clockwise, speed, rpm_max: Some(Rpm(2500)) }
}

const START: (f64, f64) = (30.0, 5.0);

/// Lines, half circles, a face at constant surface speed, a dwell, an exact stop, rapids, and at the end one thread of
/// `thread_mm` and a chain of two.
fn program(thread_mm: f64) -> Vec<Command> {
    let per_minute = |mm: f64| Feed::PerMinute(FeedPerMinute(length(mm)));
    let per_turn = Feed::PerRevolution(FeedPerRevolution(length(0.2)));
    let mut actions = vec![
        spindle(SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(150))),
        Action::Rapid { to: at(25.0, 1.0), path: RapidPath::EachAxis, others: None },
        cut(5.0, 1.0, Shape::Line, per_turn),
        Action::Rapid { to: at(20.0, 1.0), path: RapidPath::Straight, others: None },
    ];
    // More short lines than are looked ahead at once.
    for index in 1..=3000 {
        let way = 0.01 * f64::from(index);
        actions.push(cut(20.0 + 0.2 * way.sin(), 1.0 - way, Shape::Line, per_minute(2000.0)));
    }
    actions.push(cut(20.0, -30.0, Shape::Line, per_minute(500.0)));
    for index in 0..40 {
        let z = -30.0 - f64::from(index);
        let turn = if index % 2 == 0 { Turn::Clockwise } else { Turn::CounterClockwise };
        actions.push(cut(20.0, z - 1.0, Shape::Arc { turn, centre: at(20.0, z - 0.5) }, per_turn));
    }
    actions.extend([
        Action::Dwell(Dwell::Time(Seconds(0.5))),
        Action::PathMode(PathMode::ExactStop),
        cut(22.0, -70.0, Shape::Line, per_minute(1000.0)),
        cut(22.0, -75.0, Shape::Line, per_minute(1000.0)),
        Action::PathMode(PathMode::Continuous),
        spindle(SpindleSpeed::Constant(Rpm(600))),
        Action::Rapid { to: at(15.0, 5.0), path: RapidPath::EachAxis, others: None },
        thread(15.0, 5.0 - thread_mm, false),
        Action::Rapid { to: at(15.0, 5.0), path: RapidPath::EachAxis, others: None },
        thread(15.0, -20.0, false),
        thread(17.0, -22.0, true),
        Action::Rapid { to: at(START.0, START.1), path: RapidPath::EachAxis, others: None },
    ]);
    let command = |(index, action)| Command::new(action, Origin::line(index as u32 + 1));
    actions.into_iter().enumerate().map(command).collect()
}

/// Ticks of a program, of them those in threads and those that stand in a cut, and how often it asked for memory.
#[derive(Debug)]
struct Played {
    ticks: u64,
    threading: u64,
    standing: u64,
    allocations: u64,
}

/// Plays a program; meanwhile the operator changes the feed, holds and lets go, again and again.
fn play(player: &mut Player, commands: &[Command]) -> Played {
    let began_s = player.played_s();
    for index in 0..60 {
        let (feed, is_held) = ([1.0, 0.5, 1.2][index % 3], index % 10 == 4);
        player.set_at(began_s + 0.35 * (index + 1) as f64, Panel { feed, is_held, ..Panel::default() });
    }
    let mut played = Played { ticks: 0, threading: 0, standing: 0, allocations: 0 };
    let mut last = [f64::NAN; 6];
    let mut sink = |sample: &Sample| {
        played.ticks += 1;
        played.threading += u64::from(sample.kind == Kind::Threading);
        played.standing += u64::from(sample.kind == Kind::Cutting && sample.place == last);
        last = sample.place;
    };
    let counted = allocation_counter::measure(|| {
        commands.iter().for_each(|command| player.push(command, &mut sink));
        player.finish(&mut sink);
    });
    played.allocations = counted.count_total;
    played
}

/// Chains of threads in a program: each has its plan laid before its first tick, in one piece.
const CHAINS: u64 = 2;

#[test]
fn no_tick_allocates() {
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let (short, long) = (program(15.0), program(150.0));
    let mut player = Player::new(at(START.0, START.1), rates, 1000.0);
    // Room that grows once, as for the first command with many legs.
    play(&mut player, &short);
    let first = play(&mut player, &short);
    let second = play(&mut player, &long);
    assert!(!player.is_stuck());
    assert_eq!(first.allocations, CHAINS, "{first:?}");
    // Ten times the thread, not one piece of memory more.
    assert!(second.threading > first.threading + 5_000, "{first:?} {second:?}");
    assert_eq!(second.allocations, CHAINS, "{second:?}");
    // All of it was played, and the operator did hold.
    assert!(first.ticks > 30_000 && first.standing > 500, "{first:?}");
}

#[test]
fn the_count_sees_what_is_allocated() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(Box::new(1))));
    assert_eq!(counted.count_total, 1);
}
