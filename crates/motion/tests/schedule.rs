//! The schedule: times with acceleration, worked out by hand, and laws that tie them to those without.

use turnwright_canon::{
    Action, Command, Dwell, Origin, PathMode, RapidPath, Shape, SpindleSpeed, SpindleState, SpindleWatch,
    Turn,
};
use turnwright_dice::Dice;
use turnwright_motion::{Clock, Dynamics, Kind, MachineRates, Schedule, SpeedWait, Timing};
use turnwright_units::{
    Feed, FeedPerMinute, FeedPerRevolution, Length, Position, Radius, Rpm, Seconds, SurfaceSpeed, WorkTip,
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

fn timed(start: Position<WorkTip>, rates: MachineRates, actions: &[Action]) -> Vec<Timing> {
    let mut schedule = Schedule::new(start, rates);
    let mut timings = Vec::new();
    for (index, action) in actions.iter().enumerate() {
        schedule.push(Command::new(action.clone(), Origin::line(index as u32 + 1)));
        while let Some((command, timing)) = schedule.next_known() {
            assert_eq!(command.origin.line as usize, timings.len() + 1);
            timings.push(timing);
        }
    }
    schedule.finish();
    while let Some((_, timing)) = schedule.next_known() {
        timings.push(timing);
    }
    assert_eq!(timings.len(), actions.len());
    timings
}

fn seconds(timings: &[Timing]) -> f64 {
    timings.iter().map(|timing| timing.seconds).sum()
}

#[track_caller]
fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() <= expected.abs() * 1e-5, "{value} instead of {expected}");
}

#[test]
fn rapids_speed_up_and_slow_down() {
    // 80 mm of Z at 16 000 mm/min = 266.667 mm/s; 3000 mm/s² and 150 000 mm/s³: 80/266.667 + 266.667/3000
    // + 3000/150 000 = 0.3 + 0.088 889 + 0.02, and 0.02 s into position.
    let timings = timed(at(50.0, 80.0), rates(), &[rapid(50.0, 0.0, RapidPath::EachAxis)]);
    near(timings[0].seconds, 0.428_889);
    // X has 30 mm at 200 mm/s: 0.15 + 0.066 667 + 0.02 = 0.236 667 s; the longer one tells.
    let both = timed(at(50.0, 80.0), rates(), &[rapid(20.0, 0.0, RapidPath::EachAxis)]);
    near(both[0].seconds, 0.428_889);
    // In a straight line Z has 80 of 85.440 mm: along the way 266.667/0.936 329 = 284.800 mm/s, 3204.0 mm/s².
    // 85.440/284.800 + 284.800/3204.0 + 0.02 = 0.3 + 0.088 889 + 0.02: the same, as Z sets the pace.
    let straight = timed(at(50.0, 80.0), rates(), &[rapid(20.0, 0.0, RapidPath::Straight)]);
    near(straight[0].seconds, 0.428_889);
    // 0.5 mm: only 150 000 mm/s³ count, (32·0.5/150 000)^⅓ = 0.047 425 s; + 0.02.
    let short = timed(at(50.0, 0.5), rates(), &[rapid(50.0, 0.0, RapidPath::EachAxis)]);
    near(short[0].seconds, 0.067_425);
}

#[test]
fn a_cut_from_rest_to_rest() {
    // By itself it has all that the axis has: 150 000 mm/s³ for 1.667 mm/s, up and down again, twice √(1.667/150 000).
    let timings = timed(at(10.0, 0.0), rates(), &[cut(10.0, -10.0, 100.0)]);
    near(timings[0].seconds, 6.0 + 2.0 * 0.003_333);
    // In a chain 0.78 of 3000 mm/s² and of 150 000 mm/s³: 2340 and 117 000, so 0.02 s for the acceleration.
    // 10 mm at 100 mm/min: 6 s + 1.666 667/2340 + 0.02, and twice the 0.01 s of corners until the axes stand.
    let chain = timed(at(10.0, 0.0), rates(), &[cut(10.0, -4.0, 100.0), cut(10.0, -10.0, 100.0)]);
    near(seconds(&chain), 6.0 + 0.000_712 + 0.02 + 0.02);
    assert_eq!(timings[0].kind, Kind::Cutting);
}

#[test]
fn cuts_in_one_line_take_as_long_as_one() {
    let pieces: Vec<_> = (1..=3000).map(|piece| cut(10.0, -0.01 * f64::from(piece), 1000.0)).collect();
    let whole = timed(at(10.0, 0.0), rates(), &[cut(10.0, -20.0, 1000.0), cut(10.0, -30.0, 1000.0)]);
    let parts = timed(at(10.0, 0.0), rates(), &pieces);
    near(seconds(&parts), seconds(&whole));
    // In the middle each takes its share.
    near(parts[1500].seconds, 0.01 / (1000.0 / 60.0));
}

#[test]
fn a_corner_costs_time_and_an_exact_stop_more() {
    let square = [cut(10.0, -20.0, 3000.0), cut(20.0, -20.0, 3000.0)];
    let straight = |feed: f64| {
        let halves = [cut(10.0, -20.0, feed), cut(10.0, -30.0, feed)];
        seconds(&timed(at(10.0, 0.0), rates(), &halves))
    };
    let whole = straight(3000.0);
    let corner = seconds(&timed(at(10.0, 0.0), rates(), &square));
    let mut stops = vec![Action::PathMode(PathMode::ExactStop)];
    stops.extend(square);
    let stopped = seconds(&timed(at(10.0, 0.0), rates(), &stops));
    assert!(whole < corner && corner < stopped, "{whole} {corner} {stopped}");
    // Each stop by itself: 20 and 10 mm at 50 mm/s, twice √(50/150 000) to get there, 0.02 s into position.
    near(stopped, 30.0 / 50.0 + 2.0 * (2.0 * (50.0f64 / 150_000.0).sqrt() + 0.02));
    // Slow cuts pass their corners without a change of speed.
    let slow = [cut(10.0, -20.0, 120.0), cut(20.0, -20.0, 120.0)];
    near(seconds(&timed(at(10.0, 0.0), rates(), &slow)), straight(120.0));
}

#[test]
fn a_message_between_cuts_stops_nothing_and_a_dwell_does() {
    let cuts = |between: Action| [cut(10.0, -5.0, 1000.0), between, cut(10.0, -10.0, 1000.0)];
    let halves = [cut(10.0, -5.0, 1000.0), cut(10.0, -10.0, 1000.0)];
    let whole = seconds(&timed(at(10.0, 0.0), rates(), &halves));
    near(seconds(&timed(at(10.0, 0.0), rates(), &cuts(Action::Message("turn".into())))), whole);
    let dwelt = timed(at(10.0, 0.0), rates(), &cuts(Action::Dwell(Dwell::Time(Seconds(1.0)))));
    assert_eq!(dwelt[1].seconds, 1.0);
    // Each half by itself gets to 16.667 mm/s and back in twice √(16.667/150 000) s; the chain took longer.
    let by_itself = 2.0 * (16.666_667f64 / 150_000.0).sqrt();
    near(seconds(&dwelt) - 1.0 - 10.0 / 16.666_667, 2.0 * by_itself);
}

fn turning(m_per_min: u32, rpm_max: u32) -> Action {
    Action::Spindle {
        state: SpindleState::Clockwise,
        speed: SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(m_per_min)),
        rpm_max: Some(Rpm(rpm_max)),
    }
}

fn per_rev(x: f64, z: f64, mm: f64) -> Action {
    let feed = Feed::PerRevolution(FeedPerRevolution(length(mm)));
    Action::Feed { to: at(x, z), shape: Shape::Line, feed, others: None }
}

#[test]
fn a_facing_cut_takes_its_time_by_the_diameter_and_a_slow_spindle_lags() {
    // 120 m/min from d40 to d10, 0.2 mm/rev, at most 2500 rpm: 2.999 959 s, see by_hand.rs; 3.183 mm/s at the start,
    // 8.333 at the end: (3.183 + 8.333)/1500 = 7.7 ms for speeding up and slowing down, and as the feed follows the
    // diameter half the averaging behind, 1/120 · ln(8.333/3.183) = 8.0 ms; 1/60 + 0.02 s at the end.
    let fast = MachineRates { spindle_ramp_rpm_per_s: 0.0, ..rates() };
    let timings = timed(at(20.0, 0.0), fast, &[turning(120, 2500), per_rev(5.0, 0.0, 0.2)]);
    let ramps = timings[1].seconds - 2.999_959 - 1.0 / 60.0 - 0.02;
    assert!((ramps - 0.0157).abs() < 0.001, "{ramps}");
    // The spindle would have to speed up by 2·0.2·n²/(60·d) = 608 rpm/s at the end; it has 100. With n² growing by
    // 2·100·60/0.2 a millimetre from 954.93: after 12.36 mm it is asked for 2500 and turns at 1286; to the centre
    // √(954.93² + 60 000·15) = 1346. Mean (954.93 + 1346)/2 · 0.2/60 = 3.835 mm/s: 3.911 s.
    let slow = MachineRates { spindle_ramp_rpm_per_s: 100.0, ..rates() };
    let timings = timed(at(20.0, 0.0), slow, &[turning(120, 2500), per_rev(5.0, 0.0, 0.2)]);
    let cutting = timings[1].seconds - timings[1].waited_s - 1.0 / 60.0 - 0.02;
    assert!((cutting - 3.911).abs() < 0.03, "{cutting}");
}

/// A program of cuts, arcs, rapids and dwells.
fn program(seed: u64) -> Vec<Action> {
    let mut dice = Dice::new(seed * 77 + 5);
    let mut actions = vec![turning(dice.between(20.0, 300.0) as u32, 3000)];
    let (mut x, mut z) = (30.0, 5.0);
    for _ in 0..40 {
        let (dx, dz) = (dice.between(-3.0, 3.0), dice.between(-8.0, 4.0));
        match dice.roll() % 12 {
            0 => actions.push(rapid(x + dx, z + dz, RapidPath::EachAxis)),
            1 => actions.push(rapid(x + dx, z + dz, RapidPath::Straight)),
            2 => {
                actions.push(Action::Dwell(Dwell::Time(Seconds(0.1))));
                continue;
            }
            3 => {
                let mode = [PathMode::ExactStop, PathMode::Continuous][(dice.roll() % 2) as usize];
                actions.push(Action::PathMode(mode));
                continue;
            }
            4..=6 => {
                // Half a circle.
                let turn =
                    if dice.roll().is_multiple_of(2) { Turn::Clockwise } else { Turn::CounterClockwise };
                let shape = Shape::Arc { turn, centre: at(x + dx / 2.0, z + dz / 2.0) };
                let feed = Feed::PerRevolution(FeedPerRevolution(length(0.15)));
                actions.push(Action::Feed { to: at(x + dx, z + dz), shape, feed, others: None });
            }
            7 | 8 => actions.push(per_rev(x + dx, z + dz, 0.2)),
            _ => actions.push(cut(x + dx, z + dz, dice.between(50.0, 4000.0))),
        }
        (x, z) = (x + dx, z + dz);
    }
    actions
}

#[test]
fn mass_costs_time_and_the_lighter_the_less() {
    for seed in 0..150 {
        let actions = program(seed);
        let start = at(30.0, 5.0);
        // With a spindle that is there at once: a slow one lags in one model and not in the other.
        let rates = || MachineRates { spindle_ramp_rpm_per_s: 0.0, ..rates() };
        let mut clock = Clock::new(start, MachineRates { dynamics: None, ..rates() });
        let commands = actions.iter().map(|action| Command::new(action.clone(), Origin::line(1)));
        let nominal: f64 = commands.map(|command| clock.advance(&command).seconds).sum();
        let with = |factor: f64, corner_s: f64| {
            let mut dynamics = Dynamics { corner_s, in_position_s: 0.0, ..Dynamics::default() };
            for axis in &mut dynamics.axes {
                axis.acceleration_per_s2 *= factor;
                axis.jerk_per_s3 *= factor * factor;
            }
            seconds(&timed(start, MachineRates { dynamics: Some(dynamics), ..rates() }, &actions))
        };
        let (light, usual, heavy) = (with(1e5, 1e-6), with(1.0, 0.01), with(0.3, 0.02));
        assert!((light - nominal).abs() < 1e-3 * nominal, "{seed}: {light} {nominal}");
        assert!(usual > light && heavy > usual, "{seed}: {nominal} {light} {usual} {heavy}");
    }
}

/// A spindle that is watched, with everything permitted, changes no time; but its cuts go the long way.
#[test]
fn plain_cuts_take_what_any_cut_takes() {
    let watch = SpindleWatch { delay_ms: 0, reached_permille: 0, allowed_permille: 0, band: Rpm(0) };
    let mut dice = Dice::new(1);
    let mut plain = 0;
    for round in 0..60 {
        let speed_wait = [SpeedWait::Order, SpeedWait::Cut, SpeedWait::Thread][round % 3];
        let ramp = if round % 2 == 0 { 0.0 } else { 800.0 };
        let cutting_max = if round % 5 == 0 { 700.0 } else { 12_000.0 };
        let rates = MachineRates {
            speed_wait,
            spindle_ramp_rpm_per_s: ramp,
            cutting_max_mm_per_min: cutting_max,
            ..rates()
        };
        let size = [0.05, 0.5, 20.0][round / 3 % 3];
        let (mut x, mut z) = (30.0, 0.0);
        let mut program = vec![Action::Message(String::new().into())];
        while program.len() < 400 {
            let kind = dice.part();
            (x, z) = (x + size * (dice.part() - 0.5), z + size * (dice.part() - 0.5));
            let per_minute = Feed::PerMinute(FeedPerMinute(length(20.0 * 400f64.powf(dice.part()))));
            let per_turn = Feed::PerRevolution(FeedPerRevolution(length(0.05 + dice.part())));
            let feed = if kind < 0.5 { per_minute } else { per_turn };
            program.push(match kind {
                _ if kind < 0.90 => Action::Feed { to: at(x, z), shape: Shape::Line, feed, others: None },
                _ if kind < 0.93 => Action::Spindle {
                    state: if dice.part() < 0.8 {
                        SpindleState::Clockwise
                    } else {
                        SpindleState::CounterClockwise
                    },
                    speed: if dice.part() < 0.8 {
                        SpindleSpeed::Constant(Rpm((dice.part() * 2000.0) as u32))
                    } else {
                        SpindleSpeed::Surface(SurfaceSpeed(length(150_000.0)))
                    },
                    rpm_max: None,
                },
                _ if kind < 0.95 => Action::Dwell(Dwell::Time(Seconds(dice.part()))),
                _ if kind < 0.97 => rapid(x, z, RapidPath::Straight),
                _ if kind < 0.98 => Action::PathMode(PathMode::ExactStop),
                _ => Action::PathMode(PathMode::Continuous),
            });
        }
        let mut watched = program.clone();
        watched[0] = Action::SpindleWatch(Some(watch));
        let (ours, expected) = (timed(at(30.0, 0.0), rates, &program), timed(at(30.0, 0.0), rates, &watched));
        assert_eq!(ours[1..], expected[1..], "round {round}");
        plain += ours.iter().filter(|timing| timing.kind == Kind::Cutting && timing.seconds > 0.0).count();
    }
    assert!(plain > 10_000, "{plain}");
}
