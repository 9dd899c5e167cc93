//! The spindle: gears, and who waits for its speed. Expected values are worked out by hand.

use turnwright_canon::{Action, Command, Origin, Shape, SpindleSpeed, SpindleState};
use turnwright_motion::{
    Arrival, Clock, Dynamics, Gear, GearSelection, Gears, Kind, MachineRates, Player, Sample, Schedule,
    SpeedWait, Timing,
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
