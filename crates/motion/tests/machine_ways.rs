//! What the builder of a machine decides: acceleration before or after interpolation, who waits for the spindle, what
//! an orientation takes. Expected values are worked out by hand.

use turnwright_canon::{
    Action, Command, Dwell, Origin, PathMode, RapidPath, Shape, SpindleSpeed, SpindleState, Turn,
};
use turnwright_motion::{
    AccDec, AfterLaw, Clock, Dynamics, Kind, MachineRates, Orientation, Player, Schedule, SpeedWait, Timing,
};
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, Revolutions, Rpm, Seconds, WorkTip};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// Radius and Z in mm.
fn at(x: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

fn feed(to: Position<WorkTip>, shape: Shape) -> Action {
    // 100 mm/s.
    Action::Feed { to, shape, feed: Feed::PerMinute(FeedPerMinute(length(6000.0))), others: None }
}

fn spindle(rpm: u32) -> Action {
    let speed = SpindleSpeed::Constant(Rpm(rpm));
    Action::Spindle { state: SpindleState::Clockwise, speed, rpm_max: None }
}

fn after() -> MachineRates {
    let dynamics = Dynamics { acc_dec: AccDec::After, corner_s: 0.032, ..Dynamics::default() };
    MachineRates { dynamics: Some(dynamics), ..MachineRates::default() }
}

/// Places of X and Z at 10,000 ticks a second.
fn places(actions: &[Action]) -> Vec<[f64; 2]> {
    places_of(after(), actions)
}

fn places_of(rates: MachineRates, actions: &[Action]) -> Vec<[f64; 2]> {
    let mut player = Player::new(at(50.0, 0.0), rates, 10_000.0);
    let mut places = Vec::new();
    let mut sink = |sample: &turnwright_motion::Sample| places.push([sample.place[0], sample.place[1]]);
    for action in actions {
        player.push(&Command::new(action.clone(), Origin::line(1)), &mut sink);
    }
    player.finish(&mut sink);
    places
}

fn timed(rates: MachineRates, actions: &[Action]) -> Vec<Timing> {
    let mut clock = Clock::new(at(50.0, 0.0), rates);
    actions.iter().map(|action| clock.advance(&Command::new(action.clone(), Origin::line(1)))).collect()
}

#[test]
fn after_interpolation_a_path_takes_its_feed_and_twice_the_averaging() {
    let corner = [feed(at(30.0, 0.0), Shape::Line), feed(at(30.0, -40.0), Shape::Line)];
    let mut schedule = Schedule::new(at(50.0, 0.0), after());
    corner.iter().for_each(|action| schedule.push(Command::new(action.clone(), Origin::line(1))));
    schedule.finish();
    let mut seconds = 0.0;
    while let Some((_, timing)) = schedule.next_known() {
        seconds += timing.seconds;
    }
    // 60 mm at 100 mm/s, and 2 · 32 ms until both averages have run out.
    assert!((seconds - 0.664).abs() < 0.001, "{seconds}");
}

#[test]
fn after_interpolation_corners_and_arcs_are_cut_short() {
    let corner = [feed(at(30.0, 0.0), Shape::Line), feed(at(30.0, -40.0), Shape::Line)];
    let nearest = places(&corner).iter().map(|[x, z]| (x - 30.0).hypot(*z)).fold(f64::INFINITY, f64::min);
    // The change of speed, 100·√2 mm/s, by a sixth of the averaging: 0.754 mm.
    let expected = 100.0 * 2f64.sqrt() * 0.032 / 6.0;
    assert!((nearest - expected).abs() < 0.02 * expected, "{nearest} {expected}");

    // Round a whole circle of radius 20 about (30, 0): it shrinks by v²T²/(12·r) = 0.0427 mm.
    let shape = || Shape::Arc { turn: Turn::CounterClockwise, centre: at(30.0, 0.0) };
    let radii: Vec<f64> = places(&[feed(at(50.0, 0.0), shape()), feed(at(50.0, 0.0), shape())])
        .iter()
        .map(|[x, z]| (x - 30.0).hypot(*z))
        .collect();
    let (expected, middle) = (100.0f64.powi(2) * 0.032f64.powi(2) / (12.0 * 20.0), radii.len() / 2);
    assert!((20.0 - radii[middle] - expected).abs() < 0.02 * expected, "{} {expected}", radii[middle]);
    // With exact stop the corner is met.
    let stop = [&[Action::PathMode(PathMode::ExactStop)], &corner[..]].concat();
    let nearest = places(&stop).iter().map(|[x, z]| (x - 30.0).hypot(*z)).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-6, "{nearest}");
}

#[test]
fn after_interpolation_axes_may_come_behind_exponentially() {
    let rates = MachineRates { after: AfterLaw::Exponential, ..after() };
    // Twice 32 ms is the time constant: at 100 mm/s the axes are 6.4 mm behind.
    let (speed, time) = (100.0, 0.064);
    let corner = [feed(at(30.0, 0.0), Shape::Line), feed(at(30.0, -40.0), Shape::Line)];
    let seen = places_of(rates, &corner);
    let nearest = seen.iter().map(|[x, z]| (x - 30.0).hypot(*z)).fold(f64::INFINITY, f64::min);
    // In the 0.2 s before the corner the first axis has come to be that much behind.
    let behind = 1.0 - (-0.2f64 / time).exp();
    let expected = (0..4000)
        .map(|index| f64::from(index) * 1e-3)
        .map(|t: f64| speed * time * (behind * (-t).exp()).hypot(t - 1.0 + (-t).exp()))
        .fold(f64::INFINITY, f64::min);
    assert!((nearest - expected).abs() < 2e-3 * expected && nearest > 2.0, "{nearest} {expected}");
    // It ends where it is told to, and the last step is less than an increment.
    let [.., before, last] = seen[..] else { panic!("too short") };
    assert!(last == [30.0, -40.0] && (before[1] + 40.0).abs() <= 1e-3, "{before:?} {last:?}");
    // 60 mm at 100 mm/s, and until a micrometre is left of 6.4 mm: 8.76 time constants.
    let arriving_s = time * (6.4e3f64).ln();
    let played_s = (seen.len() - 1) as f64 / 10_000.0;
    assert!((played_s - 0.6 - arriving_s).abs() < 1e-3, "{played_s} {arriving_s}");
    for actions in
        [&corner[..], &corner[..1], &[&[Action::PathMode(PathMode::ExactStop)], &corner[..]].concat()]
    {
        let mut schedule = Schedule::new(at(50.0, 0.0), rates);
        actions.iter().for_each(|action| schedule.push(Command::new(action.clone(), Origin::line(1))));
        schedule.finish();
        let seconds: f64 =
            std::iter::from_fn(|| schedule.next_known()).map(|(_, timing)| timing.seconds).sum();
        let played_s = (places_of(rates, actions).len() - 1) as f64 / 10_000.0;
        assert!((seconds - played_s).abs() < 2e-3, "{seconds} {played_s}");
    }

    // A circle of radius 20 shrinks by about (v·T)²/(2·r) = 1.02 mm; to the last digit r·(1 − 1/√(1 + (v·T/r)²)).
    let shape = || Shape::Arc { turn: Turn::CounterClockwise, centre: at(30.0, 0.0) };
    let seen = places_of(rates, &[feed(at(50.0, 0.0), shape()), feed(at(50.0, 0.0), shape())]);
    let [x, z] = seen[seen.len() / 2];
    let expected = 20.0 * (1.0 - 1.0 / (1.0 + (speed * time / 20.0).powi(2)).sqrt());
    let shrunk = 20.0 - (x - 30.0).hypot(z);
    assert!((shrunk - expected).abs() < 1e-4 && (shrunk - 1.024).abs() < 0.1, "{shrunk} {expected}");
}

#[test]
fn rapids_run_while_the_spindle_speeds_up_where_the_cut_waits() {
    let rates = MachineRates { speed_wait: SpeedWait::Cut, ..MachineRates::default() };
    let rapid = Action::Rapid { to: at(30.0, 0.0), path: RapidPath::EachAxis, others: None };
    // 20 mm at 12,000 mm/min are 0.1 s; 1000 rpm take 1 s, of which the rapid has used up a tenth.
    let timings = timed(rates, &[spindle(1000), rapid, feed(at(30.0, -10.0), Shape::Line)]);
    let seconds = timings.iter().map(|timing| timing.seconds).collect::<Vec<_>>();
    assert_eq!(seconds[0], 0.0);
    assert!((seconds[1] - 0.1).abs() < 1e-9 && (timings[2].waited_s - 0.9).abs() < 1e-9, "{seconds:?}");
    // Turns are counted at the speed that was asked for, a time runs at once.
    let turns = Action::Dwell(Dwell::Turns(Revolutions(10.0)));
    let timings = timed(rates, &[spindle(600), turns]);
    assert!((timings[1].waited_s - 0.6).abs() < 1e-9 && (timings[1].seconds - 1.6).abs() < 1e-9);
    let timings = timed(rates, &[spindle(600), Action::Dwell(Dwell::Time(Seconds(0.5)))]);
    assert_eq!((timings[1].waited_s, timings[1].seconds), (0.0, 0.5));
}

#[test]
fn an_orientation_stops_the_spindle_and_turns_it_to_its_angle() {
    let rates =
        MachineRates { orientation: Some(Orientation { code: 19, seconds: 0.4 }), ..MachineRates::default() };
    let timings = timed(rates, &[spindle(1500), Action::Auxiliary { code: 19 }, spindle(1500)]);
    let spent: Vec<_> = timings.iter().map(|timing| (timing.kind, timing.seconds)).collect();
    assert_eq!(spent, [(Kind::Spindle, 1.5), (Kind::Spindle, 1.9), (Kind::Spindle, 1.5)]);
    // Elsewhere it is an M code like any other.
    let plain = timed(MachineRates::default(), &[spindle(1500), Action::Auxiliary { code: 19 }]);
    assert_eq!((plain[1].kind, plain[1].seconds), (Kind::Other, 0.2));
}

#[test]
fn cuts_speed_up_no_faster_than_the_control_lets_them() {
    let one = [feed(at(10.0, 0.0), Shape::Line)];
    let seconds = |cutting_mm_per_s2: f64| {
        let dynamics = Dynamics { cutting_mm_per_s2, ..Dynamics::default() };
        let rates = MachineRates { dynamics: Some(dynamics), ..MachineRates::default() };
        let mut schedule = Schedule::new(at(50.0, 0.0), rates);
        one.iter().for_each(|action| schedule.push(Command::new(action.clone(), Origin::line(1))));
        schedule.finish();
        schedule.next_known().map_or(0.0, |(_, timing)| timing.seconds)
    };
    // 40 mm at 100 mm/s from rest to rest: v/a and a/j more; the machine itself has 3000 mm/s² and 150 000 mm/s³.
    let expected = |a: f64| 0.4 + 100.0 / a + a / 150_000.0;
    for (limit, acceleration) in [(f64::INFINITY, 3000.0), (4000.0, 3000.0), (500.0, 500.0)] {
        assert!((seconds(limit) - expected(acceleration)).abs() < 1e-9, "{limit}");
    }
}
