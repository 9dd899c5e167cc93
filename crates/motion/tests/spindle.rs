//! The spindle: gears, and who waits for its speed. Expected values are worked out by hand.

use turnwright_canon::{Action, Command, Origin, Shape, SpindleSpeed, SpindleState, SpindleWatch};
use turnwright_motion::{
    Arrival, Clock, Dynamics, Gear, GearSelection, Gears, Kind, MachineRates, Orientation, Panel, Player,
    Sample, Schedule, SpeedWait, Timing,
};
use turnwright_units::{
    Angle, Feed, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, SurfaceSpeed, WorkTip,
};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// Diameter and Z in mm.
fn at(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(diameter / 2.0)), length(z))
}

fn spindle(rpm: u32) -> Action {
    let state = if rpm == 0 { SpindleState::Stop } else { SpindleState::Clockwise };
    Action::Spindle { state, speed: SpindleSpeed::Constant(Rpm(rpm)), rpm_max: None }
}

fn surface(m_per_min: u32) -> Action {
    let speed = SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(m_per_min));
    Action::Spindle { state: SpindleState::Clockwise, speed, rpm_max: None }
}

fn m(code: u32) -> Action {
    Action::Auxiliary { code }
}

/// A line at so much a revolution.
fn cut(to: Position<WorkTip>, feed: f64) -> Action {
    let feed = Feed::PerRevolution(FeedPerRevolution(length(feed)));
    Action::Feed { to, shape: Shape::Line, feed, others: None }
}

fn thread(to: Position<WorkTip>, lead: f64) -> Action {
    let (lead, start_angle) = (Lead(length(lead)), Angle::ZERO);
    Action::Thread { to, shape: Shape::Line, lead, lead_end: None, start_angle, is_chained: false }
}

/// Times one after the other, the tool at d40 z0 in the beginning.
fn timed(rates: MachineRates, actions: &[Action]) -> Vec<Timing> {
    let mut clock = Clock::new(at(40.0, 0.0), rates);
    actions.iter().map(|action| clock.advance(&Command::new(action.clone(), Origin::line(1)))).collect()
}

fn seconds(rates: MachineRates, actions: &[Action]) -> Vec<f64> {
    timed(rates, actions).iter().map(|timing| timing.seconds).collect()
}

fn samples(rates: MachineRates, actions: &[Action]) -> Vec<Sample> {
    let mut player = Player::new(at(40.0, 0.0), rates, 1000.0);
    let mut samples = Vec::new();
    let mut sink = |sample: &Sample| samples.push(*sample);
    for action in actions {
        player.push(&Command::new(action.clone(), Origin::line(1)), &mut sink);
    }
    player.finish(&mut sink);
    samples
}

#[track_caller]
fn near(values: &[f64], expected: &[f64]) {
    let is_near = |(value, expected): (&f64, &f64)| (value - expected).abs() <= expected.abs() * 1e-9;
    assert!(values.len() == expected.len() && values.iter().zip(expected).all(is_near), "{values:?}");
}

/// Up to 800 rpm at 500 rpm/s, and from 600 to 4000 rpm at 1000 rpm/s.
fn geared() -> MachineRates {
    let gear = |code, rpm_min, rpm_max, ramp_rpm_per_s| Gear { code, rpm_min, rpm_max, ramp_rpm_per_s };
    let mut gears = Gears::new([gear(41, 0.0, 800.0, 500.0), gear(42, 600.0, 4000.0, 1000.0)]);
    gears.change_s = 1.5;
    MachineRates { gears, ..MachineRates::default() }
}

#[test]
fn a_gear_holds_the_speed_and_has_its_own_ramp() {
    let timings = timed(geared(), &[spindle(2000), m(42), m(42), spindle(300), spindle(0)]);
    let kinds: Vec<Kind> = timings.iter().map(|timing| timing.kind).collect();
    assert_eq!(kinds, [Kind::Spindle, Kind::Spindle, Kind::Other, Kind::Spindle, Kind::Spindle]);
    let seconds: Vec<f64> = timings.iter().map(|timing| timing.seconds).collect();
    // Gear 1 gives 800 of the 2000: 1.6 s. To gear 2: down 1.6, change 1.5, up to 2000 2.0. The second M42 changes
    // nothing, an M code like any other. Gear 2 turns 600 where 300 are asked for: 1.4 down. To standstill 0.6.
    near(&seconds, &[1.6, 5.1, 0.2, 1.4, 0.6]);
}

#[test]
fn a_spindle_that_was_oriented_stands_through_a_change_of_gear() {
    let orientation = Some(Orientation { code: 19, seconds: 0.4 });
    let actions = [spindle(500), m(19), m(42), cut(at(40.0, -1.0), 0.1)];
    let timings = timed(MachineRates { orientation, ..geared() }, &actions);
    // Down from 500 at 500 rpm/s and to the angle; the change alone; nothing turns for the cut.
    near(&[timings[1].seconds, timings[2].seconds, timings[3].seconds], &[1.4, 1.5, 0.0]);
}

#[test]
fn a_gear_may_change_while_the_spindle_turns_slowly() {
    let mut rates = geared();
    rates.gears.change_rpm = 200.0;
    // Down from 800 to 200 in 1.2, change 1.5, up to 2000 in 1.8 s. Slower than 200 nothing slows it down: at
    // standstill the change is all there is.
    near(&seconds(rates, &[spindle(2000), m(42)]), &[1.6, 4.5]);
    near(&seconds(rates, &[m(42), spindle(1000)]), &[1.5, 1.0]);
}

#[test]
fn a_machine_may_choose_the_gear_by_the_speed() {
    let mut rates = geared();
    rates.gears.selection = GearSelection::BySpeed;
    let actions = [spindle(700), spindle(2500), spindle(900), spindle(0), spindle(800)];
    // 700 in gear 1; 2500 needs gear 2: 1.4 + 1.5 + 2.5; 900 too; standing changes no gear; 800 is the most of gear 1.
    near(&seconds(rates, &actions), &[1.4, 5.4, 1.6, 0.9, 1.5 + 1.6]);
    // Constant surface speed: at the place of the order. 120 m/min at d40 are 955 rpm.
    near(&seconds(rates, &[surface(120)]), &[1.5 + 0.954_929_658_551_372]);
}

#[test]
fn constant_surface_speed_stays_within_the_gear() {
    // 955 rpm wanted, 800 in gear 1: 1.6 s; 10 mm at 0.2 · 800 mm/min: 3.75 s. In gear 2 60 m/min at d40 are 477, but it
    // turns no slower than 600: 5 s at 0.2 · 600.
    let timings = timed(geared(), &[surface(120), cut(at(40.0, -10.0), 0.2)]);
    near(&[timings[0].seconds, timings[1].seconds], &[1.6, 3.75]);
    let slow = seconds(geared(), &[surface(60), m(42), cut(at(40.0, -10.0), 0.2)]);
    near(&slow[2..], &[5.0]);
}

#[test]
fn samples_show_the_change_of_gear() {
    let actions = [spindle(2000), m(42)];
    let samples = samples(geared(), &actions);
    let total: f64 = seconds(geared(), &actions).iter().sum();
    assert!((samples.len() as f64 / 1000.0 - total).abs() < 0.002, "{} {total}", samples.len());
    let rpm_at = |second: f64| samples[(second * 1000.0) as usize].rpm;
    // Up to 800 at 500 rpm/s until 1.6; standing from 3.2 to 4.7; up at 1000 rpm/s.
    for (second, rpm) in [(0.8, 400.0), (1.6, 800.0), (2.4, 400.0), (3.3, 0.0), (4.6, 0.0), (5.7, 1000.0)] {
        assert!((rpm_at(second) - rpm).abs() < 2.0, "{second} {}", rpm_at(second));
    }
    assert!(samples.iter().all(|sample| sample.kind == Kind::Spindle));
}

#[test]
fn gears_that_no_machine_has_are_named() {
    let wrong = |change: fn(&mut Gears)| {
        let mut rates = geared();
        change(&mut rates.gears);
        rates.first_fault()
    };
    assert_eq!(wrong(|_| {}), None);
    assert_eq!(wrong(|gears| gears.change_s = -1.0), Some("gears"));
    let gear = Gear { code: 41, rpm_min: 800.0, rpm_max: 800.0, ramp_rpm_per_s: 500.0 };
    assert_eq!(MachineRates { gears: Gears::new([gear]), ..geared() }.first_fault(), Some("gears"));
}

/// Threads alone wait, and what the control looks at.
fn looking(before_cut: bool, before_thread: bool, delay_s: f64) -> MachineRates {
    let arrival = Arrival { before_cut, before_thread, delay_s };
    MachineRates { speed_wait: SpeedWait::Thread, arrival, ..MachineRates::default() }
}

#[test]
fn the_control_waits_for_the_speed_where_its_parameter_says_so() {
    let cuts = [spindle(1000), cut(at(40.0, -10.0), 0.2), cut(at(40.0, -20.0), 0.2)];
    let waits = |rates| {
        timed(rates, &cuts).iter().map(|timing| (timing.seconds, timing.waited_s)).collect::<Vec<_>>()
    };
    // 1000 rpm take 1 s; 10 mm at 200 mm/min take 3 s. 3708#0: the first cut waits, the order and the second do not.
    assert_eq!(waits(looking(true, false, 0.1)), [(0.0, 0.0), (4.0, 1.0), (3.0, 0.0)]);
    // 3740 longer than the ramp: it is looked at no sooner.
    assert_eq!(waits(looking(true, false, 1.5)), [(0.0, 0.0), (4.5, 1.5), (3.0, 0.0)]);
    // Without it nobody waits, whatever 3740 is.
    assert_eq!(waits(looking(false, false, 1.5)), [(0.0, 0.0), (3.0, 0.0), (3.0, 0.0)]);
    // Where the order has waited already, the delay has run meanwhile; at once takes the delay.
    let order = MachineRates { speed_wait: SpeedWait::Order, ..looking(true, false, 0.1) };
    assert_eq!(waits(order)[..2], [(1.0, 0.0), (3.0, 0.0)]);
    let at_once = MachineRates { spindle_ramp_rpm_per_s: 0.0, ..order };
    assert_eq!(waits(at_once)[..2], [(0.0, 0.0), (3.1, 0.1)]);
    // A thread always waits for its speed; 3708#1 has it looked at as well.
    let threads = [spindle(1000), thread(at(40.0, -10.0), 1.0)];
    let waited = |rates| timed(rates, &threads)[1].waited_s;
    assert_eq!((waited(looking(false, false, 1.5)), waited(looking(false, true, 1.5))), (1.0, 1.5));
}

#[test]
fn a_cut_that_does_not_wait_follows_the_spindle_as_it_speeds_up() {
    let actions = [spindle(1000), cut(at(40.0, -10.0), 0.2), cut(at(40.0, -20.0), 0.2)];
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..looking(false, false, 0.1) };
    let mut schedule = Schedule::new(at(40.0, 0.0), rates);
    actions.iter().for_each(|action| schedule.push(Command::new(action.clone(), Origin::line(1))));
    schedule.finish();
    let mut total = 0.0;
    while let Some((_, timing)) = schedule.next_known() {
        total += timing.seconds;
    }
    // 100 turns: 8.33 of them in the second of the ramp, 91.67 at 16.67 a second: 6.5 s. (Waiting takes 7.) The axis comes a
    // few hundredths of a second behind, as it does at every change of feed.
    assert!((6.5..6.58).contains(&total), "{total}");
    // Feed per revolution stays true while the speed rises, that time at 3.33 mm/s aside.
    let samples = samples(rates, &actions);
    assert!((samples.len() as f64 / 1000.0 - total).abs() < 0.002);
    let off_mm = samples.iter().map(|sample| (sample.place[1] + 0.2 * sample.turns).abs());
    let worst = off_mm.fold(0.0, f64::max);
    assert!(worst < 0.08 * 3.34, "{worst}");
}

fn turning(state: SpindleState, rpm: u32) -> Action {
    Action::Spindle { state, speed: SpindleSpeed::Constant(Rpm(rpm)), rpm_max: None }
}

/// A hole from Z5 to Z-15 and back with lead 1.5, out at another speed, as the cycle gives it out.
fn tapping(rpm: u32, out_rpm: u32) -> Vec<Action> {
    use SpindleState::{Clockwise, CounterClockwise, Stop};
    let way = |z| thread(at(0.0, z), 1.5);
    vec![
        Action::Relocate { to: at(0.0, 5.0), others: None },
        Action::RigidTapping(true),
        turning(Clockwise, rpm),
        way(-15.0),
        turning(Stop, rpm),
        turning(CounterClockwise, out_rpm),
        way(5.0),
        turning(Stop, rpm),
        Action::RigidTapping(false),
    ]
}

#[test]
fn a_rigid_tap_takes_the_ramps_of_the_spindle_and_no_wait_for_an_angle() {
    let timings = timed(MachineRates::default(), &tapping(300, 300));
    // 20 mm are 13.33 turns, at 5 a second 2.667 s; speeding up and slowing down at 1000 rpm/s cost half of 0.3 s each.
    near(
        &[timings[3].seconds, timings[3].waited_s, timings[6].seconds],
        &[8.0 / 3.0 + 0.3, 0.3, 8.0 / 3.0 + 0.3],
    );
    assert_eq!(timings[3].kind, Kind::Threading);
    let others: f64 =
        timings.iter().enumerate().filter(|(place, _)| ![3, 6].contains(place)).map(|(_, t)| t.seconds).sum();
    assert_eq!(others, 0.0, "orders of the spindle take effect while the tap moves");
    // Out at 450: 1.778 s and 0.45.
    near(&[timed(MachineRates::default(), &tapping(300, 450))[6].seconds], &[16.0 / 9.0 + 0.45]);
    // At 2000 rpm the 13.33 turns are over before the speed is there: n²/(60·1000) = 13.33 gives 894.4 rpm, 1.789 s.
    let short = timed(MachineRates::default(), &tapping(2000, 2000))[3];
    near(&[short.seconds, short.rpm.expect("turning").max], &[2.0 * 0.8f64.sqrt(), 1000.0 * 0.8f64.sqrt()]);
    // A spindle that turns already stops first.
    let mut turning_before = vec![spindle(1000)];
    turning_before.extend(tapping(300, 300));
    near(&[timed(MachineRates::default(), &turning_before)[2].seconds], &[1.0]);
}

#[test]
fn a_slow_axis_holds_the_spindle_back() {
    let mut dynamics = Dynamics::default();
    dynamics.axes[1].acceleration_per_s2 = 5.0;
    let rates = MachineRates { dynamics: Some(dynamics), ..MachineRates::default() };
    // 7.5 mm/s at 5 mm/s² instead of 25: 1.5 s instead of 0.3.
    let tap = timed(rates, &tapping(300, 300))[3];
    assert!((tap.seconds - (8.0 / 3.0 + 1.5)).abs() < 1e-3, "{}", tap.seconds);
}

#[test]
fn tap_and_spindle_stay_in_step_and_come_to_rest_together() {
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let samples = samples(rates, &tapping(300, 450));
    let deepest = samples.iter().map(|sample| sample.place[1]).fold(f64::INFINITY, f64::min);
    assert!((-15.0..-14.9999).contains(&deepest), "no overshoot: {deepest}");
    let last = samples.last().expect("samples");
    assert!(last.rpm.abs() < 2.0 && (last.turns - 80.0 / 3.0).abs() < 1e-4, "{last:?}");
    let turn = samples.iter().position(|sample| sample.rpm < 0.0).expect("the way out");
    for (place, pair) in samples.windows(2).enumerate() {
        // In: 1.5 mm down a turn; out: up again behind 13.33 turns.
        let sample = pair[1];
        let expected = if place + 1 < turn { 5.0 - 1.5 * sample.turns } else { 1.5 * sample.turns - 35.0 };
        assert!((sample.place[1] - expected).abs() < 1e-9, "{sample:?}");
        // 1000 rpm/s are 1 rpm a tick; the sign changes at standstill.
        assert!((sample.rpm - pair[0].rpm).abs() < 1.0 + 1e-6, "{pair:?}");
        assert!((-450.0 - 1e-5..=300.0 + 1e-5).contains(&sample.rpm));
    }
}

#[test]
fn feed_hold_acts_on_a_tap_only_where_the_parameter_lets_it() {
    for (holds_tapping, is_stuck) in [(false, false), (true, true)] {
        let dynamics = Some(Dynamics::default());
        let rates = MachineRates { dynamics, holds_tapping, ..MachineRates::default() };
        let mut player = Player::new(at(0.0, 5.0), rates, 1000.0);
        player.set_at(1.0, Panel { is_held: true, ..Panel::default() });
        let mut samples = Vec::new();
        let mut sink = |sample: &Sample| samples.push(*sample);
        for action in tapping(300, 300) {
            player.push(&Command::new(action, Origin::line(1)), &mut sink);
        }
        player.finish(&mut sink);
        assert_eq!(player.is_stuck(), is_stuck);
        // Held, tap and spindle have come to rest together; they are where the lead says.
        let last = samples.last().expect("samples");
        if is_stuck {
            assert!(
                last.rpm.abs() < 2.0 && (last.place[1] - (5.0 - 1.5 * last.turns)).abs() < 1e-9,
                "{last:?}"
            );
            assert!((1.2..1.5).contains(&last.time_s), "{last:?}");
        }
    }
}

/// The first stray in a program of one order, P ms, Q and R per mille, I rpm.
fn watched(actions: &[Action], delay_ms: u32, [reached, allowed]: [u32; 2], band: u32) -> Option<(f64, f64)> {
    let watch =
        SpindleWatch { delay_ms, reached_permille: reached, allowed_permille: allowed, band: Rpm(band) };
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let mut schedule = Schedule::new(at(40.0, 0.0), rates);
    for action in [&[Action::SpindleWatch(Some(watch))], actions].concat() {
        schedule.push(Command::new(action, Origin::line(1)));
    }
    schedule.finish();
    schedule.stray().map(|stray| (stray.ordered_rpm, stray.real_rpm))
}

#[test]
fn a_watched_spindle_must_have_its_speed_in_time() {
    let order = [spindle(2000)];
    // 1000 rpm/s: 1500 after 1.5 s, 1900 after 1.9; 5 % are 100 rpm.
    assert_eq!(watched(&order, 1500, [50, 100], 50), Some((2000.0, 1500.0)));
    assert_eq!(watched(&order, 1899, [50, 50], 50), Some((2000.0, 1899.0)));
    assert_eq!(watched(&order, 1900, [50, 50], 50), None);
    // The widest of Q, R and I counts; with neither R nor I nothing is permitted or not.
    assert_eq!(watched(&order, 1500, [50, 250], 50), None);
    assert_eq!(watched(&order, 1500, [50, 100], 500), None);
    assert_eq!(watched(&order, 0, [50, 0], 0), None);
    // Nobody looks at a stop, nor at a spindle that a tap leads.
    assert_eq!(watched(&[spindle(2000), spindle(0)], 1950, [50, 50], 50), None);
    assert_eq!(watched(&tapping(2000, 2000), 0, [50, 50], 50), None);
    // Ended, it tells nothing.
    assert_eq!(watched(&[Action::SpindleWatch(None), spindle(2000)], 0, [50, 50], 50), None);
}

#[test]
fn a_watched_spindle_must_follow_the_diameter() {
    // 120 m/min facing with 0.5 mm/rev from d40 to d2: n·dn a turn is 5·10⁻³·n³... far beyond 1000 rpm/s near the axis, where
    // the machine's 4000 rpm are asked for.
    let facing = [surface(120), cut(at(2.0, 0.0), 0.5)];
    let (ordered, real) = watched(&facing, 5000, [50, 100], 50).expect("it lags");
    assert!(ordered == 4000.0 && (1000.0..3500.0).contains(&real), "{ordered} {real}");
    // Turning along Z asks for nothing.
    assert_eq!(watched(&[surface(120), cut(at(40.0, -20.0), 0.5)], 5000, [50, 100], 50), None);
}
