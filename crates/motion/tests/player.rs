//! Laws of the samples: no axis passes a limit at any tick, the path is kept, the end is exact, the operator may come
//! between, threads stay on one helix at any speed.

use turnwright_canon::{
    Action, Command, Dwell, Origin, PathMode, RapidPath, Shape, SpindleSpeed, SpindleState, Turn,
};
use turnwright_dice::Dice;
use turnwright_motion::{
    Dynamics, Fluctuation, Kind, MachineRates, Panel, Player, RapidOverride, Sample, Schedule,
};
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

fn rates() -> MachineRates {
    MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() }
}

fn cut(x: f64, z: f64, mm_per_min: f64) -> Action {
    let feed = Feed::PerMinute(FeedPerMinute(length(mm_per_min)));
    Action::Feed { to: at(x, z), shape: Shape::Line, feed, others: None }
}

fn rapid(x: f64, z: f64, path: RapidPath) -> Action {
    Action::Rapid { to: at(x, z), path, others: None }
}

fn constant(rpm: u32) -> Action {
    let speed = SpindleSpeed::Constant(Rpm(rpm));
    Action::Spindle { state: SpindleState::Clockwise, speed, rpm_max: None }
}

fn thread(x: f64, z: f64, lead: f64, degrees: i64, is_chained: bool) -> Action {
    Action::Thread {
        to: at(x, z),
        shape: Shape::Line,
        lead: Lead(length(lead)),
        lead_end: None,
        start_angle: Angle::from_millidegrees(degrees * 1000),
        is_chained,
    }
}

fn played(start: Position<WorkTip>, hz: f64, actions: &[Action], panels: &[(f64, Panel)]) -> Vec<Sample> {
    played_on(rates(), start, hz, actions, panels)
}

fn played_on(
    rates: MachineRates,
    start: Position<WorkTip>,
    hz: f64,
    actions: &[Action],
    panels: &[(f64, Panel)],
) -> Vec<Sample> {
    let mut player = Player::new(start, rates, hz);
    let mut samples = Vec::new();
    for (time_s, panel) in panels {
        player.set_at(*time_s, *panel);
    }
    for (index, action) in actions.iter().enumerate() {
        let command = Command::new(action.clone(), Origin::line(index as u32 + 1));
        player.push(&command, &mut |sample| samples.push(*sample));
    }
    player.finish(&mut |sample| samples.push(*sample));
    samples
}

/// Every limit of every axis, by differences of the places.
fn inspect(samples: &[Sample], hz: f64, case: &dyn std::fmt::Debug) {
    inspect_on(rates(), samples, hz, case);
}

fn inspect_on(rates: MachineRates, samples: &[Sample], hz: f64, case: &dyn std::fmt::Debug) {
    let dynamics = rates.dynamics.expect("a machine");
    let speeds = [rates.rapid_x_mm_per_min / 60.0, rates.rapid_z_mm_per_min / 60.0];
    for (axis, speed) in speeds.into_iter().enumerate() {
        let limits = dynamics.axes[axis];
        for window in samples.windows(4) {
            let [p0, p1, p2, p3] = [0, 1, 2, 3].map(|index: usize| window[index].place[axis]);
            let noise = 4e-13 * (1.0 + p3.abs());
            let what = || format!("{axis} at {} in line {}: {case:?}", window[3].time_s, window[3].line);
            let velocity = (p3 - p2) * hz;
            assert!(velocity.abs() <= speed * (1.0 + 1e-6) + noise * hz, "speed {velocity} {}", what());
            let acceleration = (p3 - 2.0 * p2 + p1) * hz.powi(2);
            let most = limits.acceleration_per_s2 * (1.0 + 1e-6) + 4.0 * noise * hz.powi(2);
            assert!(acceleration.abs() <= most, "acceleration {acceleration} {}", what());
            let jerk = (p3 - 3.0 * p2 + 3.0 * p1 - p0) * hz.powi(3);
            let most = limits.jerk_per_s3 * (1.0 + 1e-5) + 8.0 * noise * hz.powi(3);
            assert!(jerk.abs() <= most, "jerk {jerk} {}", what());
        }
    }
}

/// A program of cuts, arcs, rapids and dwells, short and long.
fn program(seed: u64) -> Vec<Action> {
    let mut dice = Dice::new(seed * 77 + 5);
    let surface = SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(dice.between(20.0, 300.0) as u32));
    let state = SpindleState::Clockwise;
    let mut actions = vec![Action::Spindle { state, speed: surface, rpm_max: Some(Rpm(3000)) }];
    let (mut x, mut z) = (30.0, 5.0);
    let size = [8.0, 1.0, 0.1, 0.01][(dice.roll() % 4) as usize];
    for _ in 0..60 {
        let (dx, dz) = (size * dice.between(-0.4, 0.4), size * dice.between(-1.0, 0.5));
        match dice.roll() % 12 {
            0 => actions.push(rapid(x + dx, z + dz, RapidPath::EachAxis)),
            1 => actions.push(rapid(x + dx, z + dz, RapidPath::Straight)),
            2 if dice.one_in(3) => {
                actions.push(Action::Dwell(Dwell::Time(Seconds(0.1))));
                continue;
            }
            3 if dice.one_in(3) => {
                let is_exact = dice.one_in(2);
                let mode = if is_exact { PathMode::ExactStop } else { PathMode::Continuous };
                actions.push(Action::PathMode(mode));
                continue;
            }
            4..=6 => {
                // Half a circle.
                let turn = if dice.one_in(2) { Turn::Clockwise } else { Turn::CounterClockwise };
                let shape = Shape::Arc { turn, centre: at(x + dx / 2.0, z + dz / 2.0) };
                let feed = Feed::PerRevolution(FeedPerRevolution(length(0.3)));
                actions.push(Action::Feed { to: at(x + dx, z + dz), shape, feed, others: None });
            }
            _ => actions.push(cut(x + dx, z + dz, dice.between(50.0, 6000.0))),
        }
        (x, z) = (x + dx, z + dz);
    }
    actions
}

fn end_of(actions: &[Action]) -> Position<WorkTip> {
    actions.iter().rev().find_map(Action::end_point).expect("a move")
}

#[test]
fn no_axis_passes_a_limit_at_any_tick_and_the_end_is_exact() {
    for seed in 0..120 {
        let actions = program(seed);
        let hz = [1000.0, 1000.0, 250.0, 4000.0][(seed % 4) as usize];
        let samples = played(at(30.0, 5.0), hz, &actions, &[]);
        inspect(&samples, hz, &seed);
        let (end, last) = (end_of(&actions), samples[samples.len() - 1]);
        assert!((last.place[0] - end.x.to_mm()).abs() < 1e-6, "{seed} {last:?}");
        assert!((last.place[1] - end.z.to_mm()).abs() < 1e-6, "{seed} {last:?}");
    }
}

/// Quick axes and lazy ones, hard and soft, corners cut much and little; on every second machine the operator comes
/// between.
#[test]
fn no_axis_of_any_machine_passes_a_limit() {
    for seed in 0..300 {
        let mut dice = Dice::new(seed + 4000);
        let mut dynamics =
            Dynamics { corner_s: f64::from(2 + dice.below(28) as u32) * 1e-3, ..Dynamics::default() };
        for axis in &mut dynamics.axes[..2] {
            axis.acceleration_per_s2 = dice.size(300.0, 10_000.0);
            axis.jerk_per_s3 = axis.acceleration_per_s2 / dice.size(1e-3, 0.1);
        }
        let rates = MachineRates { dynamics: Some(dynamics), ..rates() };
        let mut time = 0.0;
        let mut panels = Vec::new();
        for _ in 0..if dice.one_in(2) { 20 } else { 0 } {
            time += dice.between(0.0, 0.3);
            panels.push((
                time,
                Panel { feed: dice.between(0.05, 2.5), is_held: dice.one_in(4), ..Panel::default() },
            ));
        }
        panels.push((time + 0.5, Panel::default()));
        let actions = program(seed);
        let samples = played_on(rates, at(30.0, 5.0), 1000.0, &actions, &panels);
        inspect_on(rates, &samples, 1000.0, &seed);
        let (end, last) = (end_of(&actions), samples[samples.len() - 1]);
        assert!((last.place[0] - end.x.to_mm()).abs() < 1e-6, "{seed} {last:?}");
        assert!((last.place[1] - end.z.to_mm()).abs() < 1e-6, "{seed} {last:?}");
    }
}

#[test]
fn samples_take_as_long_as_the_schedule_says() {
    for seed in 0..60 {
        let actions = program(seed);
        let mut schedule = Schedule::new(at(30.0, 5.0), rates());
        for action in &actions {
            schedule.push(Command::new(action.clone(), Origin::line(1)));
        }
        schedule.finish();
        let mut seconds = 0.0;
        while let Some((_, timing)) = schedule.next_known() {
            seconds += timing.seconds;
        }
        let samples = played(at(30.0, 5.0), 1000.0, &actions, &[]);
        let last = samples[samples.len() - 1].time_s;
        // The player has to reckon with overrides: it sees more corners close together.
        assert!((last - seconds).abs() < 6e-3, "{seed}: {last} {seconds}");
    }
}

#[test]
fn the_same_program_twice_gives_the_same_bits() {
    for seed in 0..20 {
        let actions = program(seed);
        let samples = || played(at(30.0, 5.0), 1000.0, &actions, &[]);
        let bits = |samples: Vec<Sample>| -> Vec<u64> {
            samples.iter().flat_map(|sample| sample.place.map(f64::to_bits)).collect()
        };
        assert!(bits(samples()) == bits(samples()), "{seed}");
    }
}

#[test]
fn the_operator_changes_the_pace_within_all_limits() {
    for seed in 0..80 {
        let actions = program(seed);
        let mut dice = Dice::new(seed + 1000);
        let mut panels = Vec::new();
        let mut time = 0.0;
        for _ in 0..30 {
            time += dice.between(0.0, 0.3);
            panels.push((
                time,
                Panel {
                    feed: dice.between(0.0, 2.0),
                    rapid: [0.02, 0.25, 0.5, 1.0].map(RapidOverride::Part)[(dice.roll() % 4) as usize],
                    is_held: dice.one_in(4),
                    dry_run_mm_per_min: dice.one_in(4).then_some(3000.0),
                    single_block: dice.one_in(5),
                },
            ));
        }
        panels.push((time + 0.5, Panel::default()));
        let samples = played(at(30.0, 5.0), 1000.0, &actions, &panels);
        inspect(&samples, 1000.0, &seed);
        let (end, last) = (end_of(&actions), samples[samples.len() - 1]);
        assert!((last.place[0] - end.x.to_mm()).abs() < 1e-6, "{seed} {last:?}");
        assert!((last.place[1] - end.z.to_mm()).abs() < 1e-6, "{seed} {last:?}");
    }
}

/// Slow cuts in short pieces with sharp corners: in a dry run they go many times faster than ordered.
#[test]
fn a_dry_run_of_slow_cuts_keeps_the_corners() {
    for seed in 0..12 {
        let mut dice = Dice::new(seed + 50);
        let size = [3.0, 0.3, 0.03][(seed % 3) as usize];
        let (mut x, mut z) = (30.0, 5.0);
        let actions: Vec<_> = (0..200)
            .map(|_| {
                (x, z) = (x + size * dice.between(-1.0, 1.0), z + size * dice.between(-1.0, 0.5));
                cut(x, z, dice.between(20.0, 60.0))
            })
            .collect();
        let panel = Panel { dry_run_mm_per_min: Some(6000.0), ..Panel::default() };
        // From the first instant, and in the middle of a cut.
        for from_s in [0.0, 0.4] {
            let samples = played(at(30.0, 5.0), 1000.0, &actions, &[(from_s, panel)]);
            inspect(&samples, 1000.0, &(seed, from_s));
            let slow = played(at(30.0, 5.0), 1000.0, &actions[..20], &[]);
            let dry = played(at(30.0, 5.0), 1000.0, &actions[..20], &[(from_s, panel)]);
            assert!(2 * dry.len() < slow.len() + 800, "{seed} {from_s}: {} {}", dry.len(), slow.len());
        }
    }
}

#[test]
fn a_hold_that_is_never_released_ends_at_rest() {
    let actions = [cut(30.0, -50.0, 2000.0), cut(40.0, -50.0, 2000.0)];
    let mut player = Player::new(at(30.0, 5.0), rates(), 1000.0);
    player.set_at(0.5, Panel { is_held: true, ..Panel::default() });
    let mut samples = Vec::new();
    for action in &actions {
        let command = Command::new(action.clone(), Origin::line(1));
        player.push(&command, &mut |sample| samples.push(*sample));
    }
    player.finish(&mut |sample| samples.push(*sample));
    assert!(player.is_stuck());
    inspect(&samples, 1000.0, &"held");
    let last = samples[samples.len() - 1];
    // 33.3 mm/s: braking takes 33.3/750 s, the averaging 1/60 s, the corners' 0.02 s.
    assert!(last.time_s < 0.5 + 33.4 / 750.0 + 1.0 / 60.0 + 0.023, "{last:?}");
    assert!(last.path_mm_per_s.abs() < 1e-9, "{last:?}");
}

#[test]
fn the_path_is_kept_but_for_the_rounding_of_corners() {
    // A square of 3 mm at 2000 mm/min. No axis changes its speed at a corner by more than 3.75 mm/s (a quarter of the
    // jerk × the square of 10 ms), so a corner is missed by at most √2 · 3.75 · 0.01/6 = 8.8 µm.
    let actions =
        [cut(30.0, 2.0, 2000.0), cut(33.0, 2.0, 2000.0), cut(33.0, 5.0, 2000.0), cut(30.0, 5.0, 2000.0)];
    let samples = played(at(30.0, 5.0), 1000.0, &actions, &[]);
    inspect(&samples, 1000.0, &"square");
    let far = |sample: &Sample| {
        let (x, z) = ((sample.place[0] - 31.5).abs(), (sample.place[1] - 3.5).abs());
        (x.max(z) - 1.5).abs()
    };
    let worst = samples.iter().map(far).fold(0.0, f64::max);
    assert!(worst < 0.0089 && worst > 0.001, "{worst}");
    // With exact stop it is the square itself.
    let mut exact = vec![Action::PathMode(PathMode::ExactStop)];
    exact.extend(actions);
    let worst = played(at(30.0, 5.0), 1000.0, &exact, &[]).iter().map(far).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst}");
    // A circle comes out smaller by v²·T²/(12·r): 5 mm/s, 10 ms, 2 mm: 0.1 µm.
    let shape = Shape::Arc { turn: Turn::Clockwise, centre: at(32.0, 5.0) };
    let feed = Feed::PerMinute(FeedPerMinute(length(300.0)));
    let circle = [Action::Feed { to: at(30.0, 5.0), shape, feed, others: None }];
    let samples = played(at(30.0, 5.0), 1000.0, &circle, &[]);
    let worst = samples
        .iter()
        .map(|sample| 2.0 - (sample.place[0] - 32.0).hypot(sample.place[1] - 5.0))
        .fold(0.0, f64::max);
    assert!(worst < 1.1e-4 && worst > 0.9e-4, "{worst}");
}

#[test]
fn a_thread_is_one_helix_at_any_speed() {
    for (rpm, degrees) in [(200, 0), (600, 0), (1200, 120), (2400, 240)] {
        let actions = [
            constant(rpm),
            rapid(20.0, 5.0, RapidPath::EachAxis),
            thread(20.0, -25.0, 1.5, degrees, false),
            rapid(25.0, -25.0, RapidPath::EachAxis),
            rapid(25.0, 5.0, RapidPath::EachAxis),
            rapid(20.0, 5.0, RapidPath::EachAxis),
            thread(20.0, -25.0, 1.5, degrees, false),
        ];
        let samples = played(at(20.0, 8.0), 1000.0, &actions, &[]);
        inspect(&samples, 1000.0, &rpm);
        let mut counted = 0;
        for sample in samples.iter().filter(|sample| sample.kind == Kind::Threading) {
            // Well behind the start and before the end.
            if sample.place[1] < 1.0 && sample.place[1] > -21.0 {
                let nut = 5.0 - sample.place[1] - 1.5 * (sample.turns - f64::from(degrees as i32) / 360.0);
                let off = nut - (nut / 1.5).round() * 1.5;
                assert!(off.abs() < 1e-6, "{rpm}: {off} {sample:?}");
                counted += 1;
            }
        }
        assert!(counted > 200, "{rpm} {counted}");
    }
}

/// The proof of the threads: from 200 to 2,400 rpm, on a spindle that swings at random, seeded, the helix shifts by no more
/// than a micrometre, at no tick and from no pass to the next, and no axis passes a limit.
#[test]
fn a_thread_is_one_helix_on_a_spindle_that_wobbles() {
    let mut dice = Dice::new(2_400);
    for rpm in (200..=2400).step_by(100) {
        // Two hundredths at most, so that the swing itself asks for less than the axis has left.
        let fluctuation = Fluctuation { part: dice.between(0.005, 0.02), hz: dice.between(1.0, 5.0) };
        let rates = MachineRates { fluctuation, ..rates() };
        let actions = [
            constant(rpm),
            rapid(20.0, 8.0, RapidPath::EachAxis),
            thread(20.0, -45.0, 1.5, 120, false),
            rapid(25.0, -45.0, RapidPath::EachAxis),
            rapid(25.0, 8.0, RapidPath::EachAxis),
            rapid(20.0, 8.0, RapidPath::EachAxis),
            thread(20.0, -45.0, 1.5, 120, false),
        ];
        let mut player = Player::new(at(20.0, 8.0), rates, 1000.0);
        let mut samples = Vec::new();
        for action in actions {
            player.push(&Command::new(action, Origin::line(1)), &mut |sample| samples.push(*sample));
        }
        player.finish(&mut |sample| samples.push(*sample));
        inspect(&samples, 1000.0, &rpm);
        let threading: Vec<&Sample> =
            samples.iter().filter(|sample| sample.kind == Kind::Threading).collect();
        let mut counted = 0;
        for sample in &threading {
            // Behind the run-in, before the run-out.
            if sample.place[1] < 2.0 && sample.place[1] > -39.0 {
                let nut = 8.0 - sample.place[1] - 1.5 * (sample.turns - 120.0 / 360.0);
                let off = nut - (nut / 1.5).round() * 1.5;
                assert!(off.abs() < 1e-3, "{rpm} {fluctuation:?}: {off} {sample:?}");
                counted += 1;
            }
        }
        assert!(counted > 1000, "{rpm} {counted}");
        // It does wobble: the speed swings to both sides by what was asked for.
        let speeds = threading.iter().map(|sample| sample.rpm / f64::from(rpm));
        let (low, high) =
            speeds.fold((2.0f64, 0.0f64), |(low, high), speed| (low.min(speed), high.max(speed)));
        assert!(
            high > 1.0 + 0.9 * fluctuation.part && low < 1.0 - 0.9 * fluctuation.part,
            "{rpm} {low} {high}"
        );
    }
}

#[test]
fn a_chain_with_a_chamfer_keeps_the_limits() {
    let actions = [
        constant(500),
        rapid(20.0, 5.0, RapidPath::EachAxis),
        thread(20.0, -20.0, 1.5, 0, false),
        thread(21.5, -21.5, 1.5, 0, true),
    ];
    let samples = played(at(20.0, 8.0), 1000.0, &actions, &[]);
    let last = samples[samples.len() - 1];
    assert!((last.place[0] - 21.5).abs() < 1e-6 && (last.place[1] + 21.5).abs() < 1e-6, "{last:?}");
    inspect(&samples, 1000.0, &"chain");
}
