//! Times worked out by hand, each in the comment beside it.

use turnwright_canon::{
    Action, Command, Coolant, Curve, Dwell, Interpolation, Origin, OtherAxes, RapidPath, Shape, SidePlane,
    SidePoint, SpindleSpeed, SpindleState, Turn,
};
use turnwright_motion::{Clock, Kind, MachineRates, RapidSurfaceSpeed, Timing};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, Revolutions, Rpm, Seconds,
    SurfaceSpeed, WorkTip,
};

/// Diameter and Z in mm.
fn at(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(diameter / 2.0)), length(z))
}

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn per_rev(mm: f64) -> Feed {
    Feed::PerRevolution(FeedPerRevolution(length(mm)))
}

fn clock(diameter: f64, z: f64) -> Clock {
    Clock::new(at(diameter, z), MachineRates::default())
}

fn run(clock: &mut Clock, action: Action) -> Timing {
    clock.advance(&Command::new(action, Origin::line(1)))
}

fn line(clock: &mut Clock, diameter: f64, z: f64, feed: Feed) -> Timing {
    run(clock, Action::Feed { to: at(diameter, z), shape: Shape::Line, feed, others: None })
}

fn thread(clock: &mut Clock, diameter: f64, z: f64, lead: f64, lead_end: Option<f64>) -> Timing {
    let lead_end = lead_end.map(|lead| Lead(length(lead)));
    run(clock, threaded(at(diameter, z), lead, lead_end, false))
}

fn threaded(to: Position<WorkTip>, lead: f64, lead_end: Option<Lead>, is_chained: bool) -> Action {
    let (lead, start_angle) = (Lead(length(lead)), Angle::ZERO);
    let lead_end = lead_end.map(Box::new);
    Action::Thread { to, shape: Shape::Line, lead, lead_end, start_angle, is_chained }
}

fn rapid(clock: &mut Clock, diameter: f64, z: f64, path: RapidPath) -> Timing {
    run(clock, Action::Rapid { to: at(diameter, z), path, others: None })
}

fn spindle(clock: &mut Clock, speed: SpindleSpeed, rpm_max: Option<u32>) -> Timing {
    let rpm_max = rpm_max.map(Rpm);
    run(clock, Action::Spindle { state: SpindleState::Clockwise, speed, rpm_max })
}

fn constant(rpm: u32) -> SpindleSpeed {
    SpindleSpeed::Constant(Rpm(rpm))
}

fn surface(m_per_min: u32) -> SpindleSpeed {
    SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(m_per_min))
}

#[track_caller]
fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() <= expected.abs() * 1e-6, "{value} instead of {expected}");
}

#[test]
fn facing_at_constant_surface_speed_runs_into_the_clamp() {
    // 120 m/min, at most 2500 rpm, 0.2 mm/rev, from d40 to d10.
    // Speed × radius = 120 000 / 2π = 19 098.593 rpm·mm; the clamp begins at r = 19 098.593/2500 = 7.639 437.
    // r 20 → 7.639 437: (20² − 7.639 437²) / (2 · 0.2 · 19 098.593) min = 341.639 0/7 639.437 = 0.044 720 44 min.
    // r 7.639 437 → 5: 2.639 437 / (0.2 · 2500) = 0.005 278 87 min. Together 0.049 999 31 min = 2.999 959 s.
    let mut clock = clock(40.0, 0.0);
    // From 0 to 120 000/(40π) = 954.930 rpm at 1000 rpm/s.
    near(spindle(&mut clock, surface(120), Some(2500)).seconds, 0.954_930);
    let timing = line(&mut clock, 10.0, 0.0, per_rev(0.2));
    near(timing.seconds, 2.999_959);
    near(timing.length_mm, 15.0);
    assert_eq!(timing.waited_s, 0.0);
    let rpm = timing.rpm.expect("turning");
    near(rpm.min, 954.930);
    assert_eq!(rpm.max, 2500.0);
    // Without the program's limit the machine's 4000 rpm hold and the 3819.7 rpm of d10 are reached:
    // (20² − 5²) / 7 639.437 = 0.049 087 39 min = 2.945 243 s.
    let mut free = self::clock(40.0, 0.0);
    spindle(&mut free, surface(120), None);
    near(line(&mut free, 10.0, 0.0, per_rev(0.2)).seconds, 2.945_243);
}

#[test]
fn facing_past_the_axis_counts_both_sides() {
    // 2500 rpm from d10 to d-2 with 0.1 mm/rev, clamped all the way: 6 / 250 min = 1.44 s.
    let mut clock = clock(10.0, 0.0);
    spindle(&mut clock, surface(120), Some(2500));
    near(line(&mut clock, -2.0, 0.0, per_rev(0.1)).seconds, 1.44);
}

#[test]
fn a_ball_at_constant_surface_speed() {
    // A quarter about d0 z0 from r0 z10 to r10 z0 counter-clockwise, 0.1 mm/rev, 60 m/min, 100 000 rpm at most:
    // ∫ R·sin θ·R dθ over a quarter = R² = 100 mm²; speed × radius = 9 549.297 rpm·mm, so 100/954.929 7 min
    // = 6.283 185 s (2π) but for the first 0.0955 mm of radius, which the limit rounds off by less than 1e-4.
    let rates = MachineRates {
        rpm_max: None,
        rpm_min_surface: 0,
        spindle_ramp_rpm_per_s: 0.0,
        ..MachineRates::default()
    };
    let mut clock = Clock::new(at(0.0, 10.0), rates);
    spindle(&mut clock, surface(60), None);
    let shape = Shape::Arc { turn: Turn::CounterClockwise, centre: at(0.0, 0.0) };
    let timing = run(&mut clock, Action::Feed { to: at(20.0, 0.0), shape, feed: per_rev(0.1), others: None });
    assert!((timing.seconds - std::f64::consts::TAU).abs() < 1e-3, "{}", timing.seconds);
    near(timing.length_mm, 5.0 * std::f64::consts::PI);
    // A cutting feed of 8000 mm/min at most; on the axis the law alone would ask for no end of it.
    assert!(timing.seconds > std::f64::consts::TAU);
}

#[test]
fn feeds_per_minute_and_per_revolution() {
    let mut clock = clock(40.0, 0.0);
    // 50 mm at 200 mm/min: 15 s, with the spindle standing.
    near(line(&mut clock, 40.0, -50.0, Feed::PerMinute(FeedPerMinute(length(200.0)))).seconds, 15.0);
    // 1000 rpm are there after 1 s; 50 mm at 0.25 mm/rev: 0.2 min = 12 s.
    near(spindle(&mut clock, constant(1000), None).seconds, 1.0);
    near(line(&mut clock, 40.0, 0.0, per_rev(0.25)).seconds, 12.0);
    // 20 mm/rev would be 20 000 mm/min, the machine cuts at 8000 at most: 40/8000 min = 0.3 s.
    near(line(&mut clock, 40.0, -40.0, per_rev(20.0)).seconds, 0.3);
    // 9000 rpm are 4000 on this machine: 40/(0.1 · 4000) = 0.1 min = 6 s. The program's limit is for surface speed.
    near(spindle(&mut clock, constant(9000), Some(500)).seconds, 3.0);
    near(line(&mut clock, 40.0, 0.0, per_rev(0.1)).seconds, 6.0);
    near(clock.totals().seconds(Kind::Cutting), 15.0 + 12.0 + 0.3 + 6.0);
    near(clock.totals().seconds(Kind::Spindle), 4.0);
    near(clock.totals().total_s(), 37.3);
}

#[test]
fn in_a_rapid_the_spindle_aims_at_its_end_or_follows_the_tool() {
    // 120 m/min from r20 to r1 at 600 mm/min: 19 mm at 10 mm/s = 1.9 s. 954.930 rpm at the start, 4000 at the end.
    // Aiming at the end: 954.930 + 1900 = 2854.930 rpm, so the next cut waits 1.145 070 s.
    // Following: 19 098.593/r² · 10 mm/s is faster than 1000 rpm/s from r = 13.82 mm on (1381.98 rpm), so the spindle
    // lags for 12.82 mm or 1.282 s and has 2663.98 rpm at the end: 1.336 s to wait.
    for (rapid_surface_speed, waited_s) in
        [(RapidSurfaceSpeed::AtEndPoint, 1.145_070), (RapidSurfaceSpeed::AtPresentPoint, 1.336)]
    {
        let rates =
            MachineRates { rapid_x_mm_per_min: 600.0, rapid_surface_speed, ..MachineRates::default() };
        let mut clock = Clock::new(at(40.0, 0.0), rates);
        spindle(&mut clock, surface(120), None);
        near(rapid(&mut clock, 2.0, 0.0, RapidPath::EachAxis).seconds, 1.9);
        let timing = line(&mut clock, 2.0, -1.0, per_rev(0.1));
        assert!((timing.waited_s - waited_s).abs() < 0.02, "{} instead of {waited_s}", timing.waited_s);
    }
}

#[test]
fn rapids_take_the_time_of_the_longest_axis() {
    // 30 mm of radius at 12 000 and 80 mm at 16 000 mm/min: 0.15 s and 0.3 s.
    // Dog-leg: together for 0.15 s over 30 and 40 mm (50 mm), then 40 mm of Z alone.
    let mut clock = clock(100.0, 80.0);
    let timing = rapid(&mut clock, 40.0, 0.0, RapidPath::EachAxis);
    near(timing.seconds, 0.3);
    near(timing.length_mm, 90.0);
    assert_eq!((timing.kind, timing.rpm), (Kind::Rapid, None));
    let timing = rapid(&mut clock, 100.0, 80.0, RapidPath::Straight);
    near(timing.seconds, 0.3);
    near(timing.length_mm, 7300f64.sqrt());
}

#[test]
fn a_rapid_sends_the_spindle_to_the_speed_of_its_end() {
    // 100 m/min, 2500 rpm at most: 2500 at d10, 100 000/(100π) = 318.310 at d100.
    let mut clock = clock(10.0, 0.0);
    spindle(&mut clock, surface(100), Some(2500));
    let out = rapid(&mut clock, 100.0, 0.0, RapidPath::EachAxis);
    let rpm = out.rpm.expect("turning");
    near(rpm.min, 318.310);
    assert_eq!(rpm.max, 2500.0);
    // 45 mm of radius: 0.225 s, in which the spindle comes down by 225 rpm only. The next cut waits for the
    // other (2500 − 318.310 − 225)/1000 = 1.956 690 s, then 10 mm at 0.1 · 318.310 mm/min = 18.849 556 s.
    near(out.seconds, 0.225);
    let cut = line(&mut clock, 100.0, -10.0, per_rev(0.1));
    near(cut.waited_s, 1.956_690);
    near(cut.seconds, 1.956_690 + 18.849_556);
    near(clock.totals().seconds(Kind::Cutting), 18.849_556);
}

#[test]
fn threads_follow_the_spindle_along_their_long_axis() {
    let mut clock = clock(30.0, 3.0);
    spindle(&mut clock, constant(800), None);
    // 33 mm at lead 1.5: 22 turns at 800 rpm = 1.65 s, the 1 mm of taper changes nothing.
    near(thread(&mut clock, 32.0, -30.0, 1.5, None).seconds, 1.65);
    // A face thread: 10 mm of radius at lead 2 are 5 turns = 0.375 s.
    near(thread(&mut clock, 12.0, -30.0, 2.0, None).seconds, 0.375);
    // Lead from 1 to 3 over 20 mm: 10 turns of 2 mm in the mean = 0.75 s.
    near(thread(&mut clock, 12.0, -50.0, 1.0, Some(3.0)).seconds, 0.75);
}

#[test]
fn a_chain_of_threads_keeps_the_speed_of_its_start() {
    // 100 m/min at d20: 1591.549 rpm; 8 mm of radius then at lead 1: 8/1591.549 min = 0.301 593 s each.
    let mut clock = clock(20.0, 0.0);
    spindle(&mut clock, surface(100), None);
    near(thread(&mut clock, 36.0, 0.0, 1.0, None).seconds, 0.301_593);
    let second = run(&mut clock, threaded(at(20.0, 0.0), 1.0, None, true));
    near(second.seconds, 0.301_593);
    near(second.rpm.expect("turning").max, 1591.549);
}

#[test]
fn dwells_tools_and_auxiliaries() {
    let mut clock = clock(40.0, 0.0);
    near(run(&mut clock, Action::Dwell(Dwell::Time(Seconds(0.5)))).seconds, 0.5);
    spindle(&mut clock, constant(600), None);
    // 5 turns at 10 a second.
    near(run(&mut clock, Action::Dwell(Dwell::Turns(Revolutions(5.0)))).seconds, 0.5);
    near(run(&mut clock, Action::Tool { tool: 1, offset: 1 }).seconds, 1.5);
    // Only another station takes time: not another offset, not the cancelling of one.
    for (tool, offset) in [(1, 11), (1, 0), (0, 0), (1, 1)] {
        assert_eq!(run(&mut clock, Action::Tool { tool, offset }).seconds, 0.0);
    }
    near(run(&mut clock, Action::Tool { tool: 2, offset: 2 }).seconds, 1.5);
    near(run(&mut clock, Action::Coolant(Coolant::On)).seconds, 0.2);
    near(run(&mut clock, Action::Auxiliary { code: 68 }).seconds, 0.2);
    assert_eq!(run(&mut clock, Action::OptionalStop).seconds, 0.0);
}

#[test]
fn turning_the_spindle_round_passes_through_zero() {
    // 600 rpm one way to 900 the other: 1500 rpm at 1000 rpm/s.
    let mut clock = clock(40.0, 0.0);
    spindle(&mut clock, constant(600), None);
    let round =
        Action::Spindle { state: SpindleState::CounterClockwise, speed: constant(900), rpm_max: None };
    near(run(&mut clock, round).seconds, 1.5);
    let stop = Action::Spindle { state: SpindleState::Stop, speed: constant(900), rpm_max: None };
    near(run(&mut clock, stop).seconds, 0.9);
}

#[test]
fn what_waits_for_a_standing_spindle_is_counted_not_guessed() {
    let mut clock = clock(40.0, 0.0);
    let timing = line(&mut clock, 40.0, -10.0, per_rev(0.2));
    assert_eq!((timing.seconds, timing.rpm, clock.unknown_feeds()), (0.0, None, 1));
    near(timing.length_mm, 10.0);
    thread(&mut clock, 40.0, -20.0, 1.0, None);
    run(&mut clock, Action::Dwell(Dwell::Turns(Revolutions(2.0))));
    // Surface speed nothing, or a limit of nothing.
    spindle(&mut clock, surface(0), None);
    line(&mut clock, 40.0, -10.0, per_rev(0.2));
    spindle(&mut clock, surface(100), Some(0));
    line(&mut clock, 40.0, -20.0, per_rev(0.2));
    line(&mut clock, 40.0, -30.0, Feed::PerMinute(FeedPerMinute(Length::ZERO)));
    assert_eq!((clock.totals().total_s(), clock.unknown_feeds()), (0.0, 6));
}

#[test]
fn other_coordinates_without_a_move_take_no_time() {
    let mut clock = clock(40.0, 0.0);
    let relocate = Action::Relocate { to: at(50.0, 10.0), others: None };
    clock.advance(&Command::new(relocate, Origin::line(1)));
    assert_eq!(rapid(&mut clock, 50.0, 10.0, RapidPath::EachAxis).seconds, 0.0);
    assert_eq!(clock.position(), at(50.0, 10.0));
}

#[test]
fn a_degree_counts_as_a_millimetre_in_the_feed() {
    let mut clock = clock(40.0, 0.0);
    let per_minute = |mm: f64| Feed::PerMinute(FeedPerMinute(length(mm)));
    let with_c = |degrees: i64| OtherAxes {
        c: Some(Angle::from_millidegrees(degrees * 1_000)),
        per_degree: length(1.0),
        ..OtherAxes::default()
    };
    // The rotary axis alone: 90 degrees at 180 a minute.
    let line = |z: f64, feed: Feed, others: OtherAxes| Action::Feed {
        to: at(40.0, z),
        shape: Shape::Line,
        feed,
        others: Some(Box::new(others)),
    };
    let timing = run(&mut clock, line(0.0, per_minute(180.0), with_c(90)));
    near(timing.seconds, 30.0);
    near(timing.length_mm, 0.0);
    // With a length: the root of 30 and 40 squared is 50, at 100 a minute.
    let timing = run(&mut clock, line(-30.0, per_minute(100.0), with_c(130)));
    near(timing.seconds, 30.0);
    near(timing.length_mm, 30.0);
    // In inch input a degree is an inch: 10 degrees at 20 (inches) a minute.
    let inch = OtherAxes { per_degree: length(25.4), ..with_c(140) };
    near(run(&mut clock, line(-30.0, per_minute(20.0 * 25.4), inch)).seconds, 30.0);
    // The rotary axis is no faster than 18,000 degrees a minute: 900 take 3 s.
    near(
        run(
            &mut clock,
            line(
                -30.0,
                per_minute(20_000.0 * 25.4),
                OtherAxes { c: Some(Angle::from_millidegrees(1_040_000)), ..inch },
            ),
        )
        .seconds,
        3.0,
    );
    // At rapid each axis for itself: 180 degrees at 36,000 a minute are 0.3 s, 10 mm of Z less.
    let to = at(40.0, -40.0);
    let rapid = Action::Rapid { to, path: RapidPath::EachAxis, others: Some(Box::new(with_c(1_220))) };
    near(run(&mut clock, rapid).seconds, 0.3);
}

#[test]
fn in_a_virtual_plane_the_feed_is_along_the_virtual_path() {
    let mut clock = clock(40.0, 0.0);
    run(&mut clock, Action::Interpolation(Interpolation::Polar { zero: Angle::ZERO, is_below: false }));
    let feed = Feed::PerMinute(FeedPerMinute(length(60.0)));
    let v = |mm: f64| {
        Some(Box::new(OtherAxes {
            v: Some(length(mm)),
            c: Some(Angle::from_millidegrees(45_000)),
            ..OtherAxes::default()
        }))
    };
    let timing =
        run(&mut clock, Action::Feed { to: at(40.0, 0.0), shape: Shape::Line, feed, others: v(20.0) });
    near(timing.seconds, 20.0);
    // Half a circle of radius 10 about X10 (radius), V20: 10 π mm.
    let centre = SidePoint { along: length(10.0), side: length(20.0) };
    let shape = Shape::SideArc { plane: SidePlane::Face, turn: Turn::CounterClockwise, centre };
    let timing = run(&mut clock, Action::Feed { to: at(0.0, 0.0), shape, feed, others: v(20.0) });
    near(timing.length_mm, 10.0 * std::f64::consts::PI);
    near(timing.seconds, 10.0 * std::f64::consts::PI);
}

#[test]
fn curves_are_as_long_as_their_integrals() {
    // A quarter of the ellipse with half axes 20 and 10: 20 · E(3/4), and E(3/4) = 1.2110560275684594.
    let mut quarter = clock(0.0, 0.0);
    let ellipse = Curve::Ellipse {
        turn: Turn::CounterClockwise,
        centre: at(0.0, -20.0),
        half_along: length(20.0),
        half_across: length(10.0),
        tilt: Angle::ZERO,
    };
    let feed = Feed::PerMinute(FeedPerMinute(length(100.0)));
    let curve = |curve, to| Action::Feed { to, shape: Shape::Curve(Box::new(curve)), feed, others: None };
    let timing = run(&mut quarter, curve(ellipse, at(20.0, -20.0)));
    assert!((timing.length_mm - 20.0 * 1.211_056_027_568_459_4).abs() < 1e-5, "{timing:?}");
    assert!((timing.seconds - timing.length_mm * 0.6).abs() < 1e-9, "{timing:?}");
    // x² = 10·(−z) up to radius 10: 5·√5 + 2.5·arsinh 2 = 14.789428...
    let mut bow = clock(0.0, 0.0);
    let parabola = Curve::Parabola {
        turn: Turn::CounterClockwise,
        vertex: at(0.0, 0.0),
        focal_parameter: length(5.0),
        tilt: Angle::from_millidegrees(180_000),
    };
    let timing = run(&mut bow, curve(parabola, at(20.0, -10.0)));
    let expected = 5.0 * 5.0f64.sqrt() + 2.5 * (2.0 + 5.0f64.sqrt()).ln();
    assert!((timing.length_mm - expected).abs() < 1e-5, "{timing:?} {expected}");
}

#[test]
fn a_thread_along_an_arc_takes_the_turns_of_its_long_axis() {
    // From 60 to 120 degrees on radius 10: 10 mm of Z at 2 mm a turn and 600 rpm are half a second; the way is
    // 10·π/3.
    let mut clock = clock(2.0 * 8.660_254, 5.0);
    spindle(&mut clock, SpindleSpeed::Constant(Rpm(600)), None);
    let action = Action::Thread {
        to: at(2.0 * 8.660_254, -5.0),
        shape: Shape::Arc { turn: Turn::CounterClockwise, centre: at(0.0, 0.0) },
        lead: Lead(length(2.0)),
        lead_end: None,
        start_angle: Angle::ZERO,
        is_chained: false,
    };
    let timing = run(&mut clock, action);
    assert!((timing.seconds - timing.waited_s - 0.5).abs() < 1e-9, "{timing:?}");
    assert!((timing.length_mm - 10.0 * std::f64::consts::FRAC_PI_3).abs() < 1e-5, "{timing:?}");
}
