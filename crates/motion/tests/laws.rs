//! Laws on seeded random moves: the closed forms against an integration that knows nothing of them.

use std::f64::consts::{PI, TAU};
use std::time::Duration;

use turnwright_canon::{
    Action, Command, Curve, Dwell, Interpolation, Origin, OtherAxes, RapidPath, Shape, SidePlane, SidePoint,
    SpindleSpeed, SpindleState, Turn,
};
use turnwright_dice::Dice;
use turnwright_motion::{
    AfterLaw, ArcPath, Arrival, AuxiliaryTimes, BlockTime, BlockTimes, Clock, Dynamics, Fluctuation, Gear,
    GearSelection, Gears, Kind, LINES_MAX, MachineRates, Orientation, Panel, PanelRules, RapidOverride,
    RapidSurfaceSpeed, SPIRAL_TOLERANCE, Schedule, SpeedWait, Summary, TIME_TOLERANCE, Timing,
};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, Revolutions, Rpm, Seconds,
    SurfaceSpeed, WorkTip,
};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn at(x_mm: f64, z_mm: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x_mm)), length(z_mm))
}

/// A surface speed, its limits and a feed.
#[derive(Clone, Copy, Debug)]
struct Cut {
    m_per_min: u32,
    rpm_max: u32,
    rpm_min: u32,
    feed_mm_per_rev: f64,
    cutting_max: f64,
}

impl Cut {
    fn random(dice: &mut Dice) -> Self {
        Self {
            m_per_min: dice.between(5.0, 400.0) as u32,
            rpm_max: dice.between(200.0, 6000.0) as u32,
            rpm_min: if dice.one_in(3) { 0 } else { dice.between(0.0, 800.0) as u32 },
            feed_mm_per_rev: (dice.between(0.01, 1.0) * 1e4).round() / 1e4,
            cutting_max: dice.between(100.0, 8000.0).round(),
        }
    }

    /// Seconds a millimetre takes at a place, straight from the words of the manual.
    fn seconds_per_mm(&self, x_mm: f64) -> f64 {
        let diameter = 2.0 * x_mm.abs();
        let mut rpm = 1000.0 * f64::from(self.m_per_min) / (PI * diameter);
        rpm = rpm.max(f64::from(self.rpm_min)).min(f64::from(self.rpm_max));
        60.0 / (self.feed_mm_per_rev * rpm).min(self.cutting_max)
    }

    fn timing(&self, from: Position<WorkTip>, to: Position<WorkTip>, shape: Shape) -> Timing {
        let rates = MachineRates {
            cutting_max_mm_per_min: self.cutting_max,
            rpm_max: None,
            rpm_min_surface: self.rpm_min,
            ..MachineRates::default()
        };
        let mut clock = Clock::new(from, rates);
        let surface = SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(self.m_per_min));
        let state = SpindleState::Clockwise;
        run(&mut clock, Action::Spindle { state, speed: surface, rpm_max: Some(Rpm(self.rpm_max)) });
        let feed = Feed::PerRevolution(FeedPerRevolution(length(self.feed_mm_per_rev)));
        run(&mut clock, Action::Feed { to, shape, feed, others: None })
    }
}

fn run(clock: &mut Clock, action: Action) -> Timing {
    clock.advance(&Command::new(action, Origin::line(1)))
}

/// Adaptive Simpson over 0 to 1, begun with many panels so that no corner is missed.
fn integrate(f: &dyn Fn(f64) -> f64) -> f64 {
    fn refine(f: &dyn Fn(f64) -> f64, left: [f64; 2], right: [f64; 2], tolerance: f64, depth: u32) -> f64 {
        let middle = (left[0] + right[0]) / 2.0;
        let at_middle = f(middle);
        let (one, two) = ((left[0] + middle) / 2.0, (middle + right[0]) / 2.0);
        let (at_one, at_two) = (f(one), f(two));
        let width = right[0] - left[0];
        let rough = width / 6.0 * (left[1] + 4.0 * at_middle + right[1]);
        let fine = width / 12.0 * (left[1] + 4.0 * at_one + 2.0 * at_middle + 4.0 * at_two + right[1]);
        if depth == 0 || (fine - rough).abs() <= tolerance {
            fine
        } else {
            refine(f, left, [middle, at_middle], tolerance / 2.0, depth - 1)
                + refine(f, [middle, at_middle], right, tolerance / 2.0, depth - 1)
        }
    }
    const PANELS: u32 = 64;
    let scale: f64 = (0..PANELS).map(|i| f((f64::from(i) + 0.5) / f64::from(PANELS))).sum::<f64>();
    (0..PANELS)
        .map(|i| {
            let (a, b) = (f64::from(i) / f64::from(PANELS), f64::from(i + 1) / f64::from(PANELS));
            refine(f, [a, f(a)], [b, f(b)], scale * 1e-15, 40)
        })
        .sum()
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64, case: &dyn std::fmt::Debug) {
    assert!((value - expected).abs() <= expected * tolerance, "{value} instead of {expected}: {case:?}");
}

#[test]
fn an_ellipse_with_equal_half_axes_takes_the_time_of_its_circle() {
    let mut dice = Dice::new(13);
    for _ in 0..300 {
        let cut = Cut::random(&mut dice);
        let radius = dice.between(1.0, 80.0);
        let (start, way) = (dice.between(0.0, TAU), dice.between(0.1, 3.0));
        let (x, z) = (dice.between(-20.0, 150.0), dice.between(-100.0, 0.0));
        let on = |angle: f64| at(x + radius * angle.sin(), z + radius * angle.cos());
        let turn = if dice.one_in(2) { Turn::Clockwise } else { Turn::CounterClockwise };
        let (from, to) = match turn {
            Turn::CounterClockwise => (on(start), on(start + way)),
            Turn::Clockwise => (on(start + way), on(start)),
        };
        let (centre, half) = (at(x, z), length(radius));
        let tilt = Angle::from_millidegrees(dice.between(0.0, 180_000.0) as i64);
        let ellipse = Curve::Ellipse { turn, centre, half_along: half, half_across: half, tilt };
        let circle = cut.timing(from, to, Shape::Arc { turn, centre });
        let curve = cut.timing(from, to, Shape::Curve(Box::new(ellipse)));
        near(curve.seconds, circle.seconds, SPIRAL_TOLERANCE, &(cut, from, to));
        near(curve.length_mm, circle.length_mm, SPIRAL_TOLERANCE, &(cut, from, to));
    }
}

#[test]
fn lines_at_surface_speed_agree_with_integration() {
    let mut dice = Dice::new(0x1dea_0001);
    for _ in 0..1500 {
        let cut = Cut::random(&mut dice);
        let (x0, z0) = (dice.between(-20.0, 80.0), dice.between(-100.0, 5.0));
        // Also hardly any X, and none.
        let dx = match dice.roll() % 4 {
            0 => 0.0,
            1 => dice.between(-2e-6, 2e-6),
            _ => dice.between(-80.0, 80.0),
        };
        let (from, to) = (at(x0, z0), at(x0 + dx, z0 + dice.between(-50.0, 50.0)));
        let (start, end) = (from.x.to_mm(), to.x.to_mm());
        let mm = (end - start).hypot((to.z - from.z).to_mm());
        let expected = mm * integrate(&|t| cut.seconds_per_mm(start + (end - start) * t));
        let timing = cut.timing(from, to, Shape::Line);
        near(timing.seconds, expected, TIME_TOLERANCE, &(cut, from, to));
        near(timing.length_mm, mm, 1e-12, &(from, to));
    }
}

/// Seconds of an arc whose radius grows evenly with the angle, by integration.
fn arc_seconds(cut: &Cut, arc: &ArcPath) -> f64 {
    let growth = (arc.end_radius_mm - arc.start_radius_mm) / arc.sweep_rad;
    integrate(&|t| {
        let angle = arc.sweep_rad * t;
        let radius = arc.start_radius_mm + growth * angle;
        let x = arc.centre.x + radius * (arc.start_rad + angle).sin();
        radius.hypot(growth) * arc.sweep_rad.abs() * cut.seconds_per_mm(x)
    })
}

#[test]
fn circles_at_surface_speed_agree_with_integration() {
    let mut dice = Dice::new(0x1dea_0002);
    for _ in 0..1500 {
        let cut = Cut::random(&mut dice);
        let radius = dice.between(0.1, 40.0);
        let (cx, cz) = (dice.between(-10.0, 60.0), dice.between(-50.0, 0.0));
        let start = dice.between(-PI, PI);
        let sweep = dice.between(-TAU, TAU);
        let on = |angle: f64| at(cx + radius * angle.sin(), cz + radius * angle.cos());
        let turn = if sweep < 0.0 { Turn::Clockwise } else { Turn::CounterClockwise };
        let (from, to, centre) = (on(start), on(start + sweep), at(cx, cz));
        let arc = ArcPath::new(from, to, centre, turn);
        assert!((arc.sweep_rad - sweep).abs() < 1e-4, "{arc:?} {sweep}");
        let timing = cut.timing(from, to, Shape::Arc { turn, centre });
        // Ends rounded to the nanometre make every circle a spiral by a hair: hence the last term.
        let hair = (arc.end_radius_mm - arc.start_radius_mm).abs() / radius;
        near(timing.seconds, arc_seconds(&cut, &arc), TIME_TOLERANCE + hair, &(cut, arc));
        near(timing.length_mm, radius * sweep.abs(), 1e-4 / sweep.abs().min(1.0), &arc);
    }
}

#[test]
fn spirals_at_surface_speed_agree_with_integration() {
    let mut dice = Dice::new(0x1dea_0003);
    for _ in 0..300 {
        let cut = Cut::random(&mut dice);
        let (cx, cz) = (dice.between(0.0, 60.0), dice.between(-50.0, 0.0));
        let start_radius = dice.between(1.0, 40.0);
        let end_radius = start_radius * (1.0 + dice.between(-0.5, 0.5) * dice.between(0.0, 1.0).powi(4));
        let (start, sweep) = (dice.between(-PI, PI), dice.between(0.05, TAU));
        let on = |angle: f64, radius: f64| at(cx + radius * angle.sin(), cz + radius * angle.cos());
        let turn = Turn::CounterClockwise;
        let (from, to, centre) = (on(start, start_radius), on(start + sweep, end_radius), at(cx, cz));
        let arc = ArcPath::new(from, to, centre, turn);
        let timing = cut.timing(from, to, Shape::Arc { turn, centre });
        near(timing.seconds, arc_seconds(&cut, &arc), SPIRAL_TOLERANCE, &(cut, arc));
    }
}

#[test]
fn a_line_cut_in_two_takes_as_long() {
    let mut dice = Dice::new(0x1dea_0004);
    for _ in 0..2000 {
        let cut = Cut::random(&mut dice);
        let mut place = || at(dice.between(-20.0, 80.0), dice.between(-90.0, 5.0));
        let (from, to) = (place(), place());
        // Halved exactly: both ways are made even.
        let middle = at((from.x.to_mm() + to.x.to_mm()) / 2.0, (from.z.to_mm() + to.z.to_mm()) / 2.0);
        let halves =
            cut.timing(from, middle, Shape::Line).seconds + cut.timing(middle, to, Shape::Line).seconds;
        // The middle is rounded to the nanometre.
        near(halves, cut.timing(from, to, Shape::Line).seconds, 1e-5, &(cut, from, to));
    }
}

#[test]
fn turning_points_are_the_ends_of_the_extents() {
    let mut dice = Dice::new(0x1dea_0005);
    for _ in 0..2000 {
        let (cx, cz, radius) = (dice.between(-50.0, 50.0), dice.between(-50.0, 0.0), dice.between(0.1, 40.0));
        let (start, sweep) = (dice.between(-PI, PI), dice.between(-TAU, TAU));
        let on = |angle: f64| at(cx + radius * angle.sin(), cz + radius * angle.cos());
        let turn = if sweep < 0.0 { Turn::Clockwise } else { Turn::CounterClockwise };
        let (from, to) = (on(start), on(start + sweep));
        let arc = ArcPath::new(from, to, at(cx, cz), turn);
        let mut ends: Vec<_> = arc.turning_points().map(|point| point.x).collect();
        ends.extend([from.x.to_mm(), to.x.to_mm()]);
        let samples: Vec<_> =
            (0..=4000).map(|i| cx + radius * (start + sweep * f64::from(i) / 4000.0).sin()).collect();
        for pick in [f64::min, f64::max] {
            let (end, sample) = (ends.iter().copied().reduce(pick), samples.iter().copied().reduce(pick));
            let (end, sample) = (end.expect("an end"), sample.expect("a sample"));
            assert!((end - sample).abs() < 1e-4, "{end} {sample} {arc:?}");
        }
    }
}

/// Anything that the types allow, sensible or not.
fn any_action(dice: &mut Dice) -> Action {
    let number = |dice: &mut Dice| match dice.roll() % 6 {
        0 => 0.0,
        1 => f64::NAN,
        2 => f64::INFINITY,
        3 => -1.0,
        _ => dice.between(0.0, 10.0),
    };
    let any_length = |dice: &mut Dice| match dice.roll() % 8 {
        0 => Length::ZERO,
        1 => Length::from_nm(i64::MAX),
        2 => Length::from_nm(i64::MIN),
        3 => Length::from_nm(1),
        4 => Length::from_nm(dice.roll() as i64),
        _ => length(dice.between(-100.0, 100.0)),
    };
    let place = |dice: &mut Dice| Position::new(Radius(any_length(dice)), any_length(dice));
    let angle = |dice: &mut Dice| Angle::from_nanodegrees(any_length(dice).nm());
    let others = |dice: &mut Dice| {
        dice.one_in(3).then(|| {
            Box::new(OtherAxes {
                c: dice.one_in(2).then(|| angle(dice)),
                y: dice.one_in(2).then(|| any_length(dice)),
                b: dice.one_in(2).then(|| angle(dice)),
                v: dice.one_in(2).then(|| any_length(dice)),
                per_degree: any_length(dice),
            })
        })
    };
    match dice.roll() % 8 {
        0 => Action::Rapid { to: place(dice), path: RapidPath::EachAxis, others: others(dice) },
        1 => Action::Rapid { to: place(dice), path: RapidPath::Straight, others: others(dice) },
        2 | 3 => {
            let turn = if dice.one_in(2) { Turn::Clockwise } else { Turn::CounterClockwise };
            let shape = match dice.roll() % 4 {
                0 | 1 => Shape::Line,
                2 => Shape::Arc { turn, centre: place(dice) },
                _ => {
                    let centre = SidePoint { along: any_length(dice), side: any_length(dice) };
                    Shape::SideArc { plane: SidePlane::Wall, turn, centre }
                }
            };
            let feed = if dice.one_in(4) {
                Feed::PerMinute(FeedPerMinute(any_length(dice)))
            } else {
                Feed::PerRevolution(FeedPerRevolution(any_length(dice)))
            };
            Action::Feed { to: place(dice), shape, feed, others: others(dice) }
        }
        4 => Action::Thread {
            to: place(dice),
            lead: Lead(any_length(dice)),
            lead_end: dice.one_in(2).then(|| Box::new(Lead(any_length(dice)))),
            start_angle: Angle::ZERO,
            shape: Shape::Line,
            is_chained: false,
        },
        5 if dice.one_in(2) => Action::Dwell(Dwell::Time(Seconds(number(dice)))),
        5 => Action::Dwell(Dwell::Turns(Revolutions(number(dice)))),
        6 if dice.one_in(4) => Action::Auxiliary { code: 10 },
        6 if dice.one_in(4) => {
            [Action::Stop, Action::OptionalStop, Action::End][dice.roll() as usize % 3].clone()
        }
        6 if dice.one_in(3) => {
            let radius = Radius(any_length(dice));
            Action::Interpolation(Interpolation::Cylindrical { radius })
        }
        6 => Action::Tool { tool: (dice.roll() % 3) as u32, offset: 1 },
        _ => Action::Spindle {
            state: if dice.one_in(5) { SpindleState::Stop } else { SpindleState::CounterClockwise },
            speed: if dice.one_in(2) {
                SpindleSpeed::Constant(Rpm(dice.roll() as u32))
            } else {
                SpindleSpeed::Surface(SurfaceSpeed(any_length(dice)))
            },
            rpm_max: dice.one_in(2).then(|| Rpm((dice.roll() % 3) as u32 * 1000)),
        },
    }
}

/// Any gears at all, of any M codes that actions have.
fn gears(rate: &mut impl FnMut() -> f64, round: usize) -> Gears {
    let gear = |code| Gear { code, rpm_min: rate(), rpm_max: rate(), ramp_rpm_per_s: rate() };
    let mut gears = Gears::new((0..round as u32 % 12).map(gear));
    (gears.change_s, gears.change_rpm) = (rate(), rate());
    gears.selection = if round.is_multiple_of(4) { GearSelection::BySpeed } else { GearSelection::ByCode };
    gears
}

#[test]
fn nothing_makes_a_time_that_is_no_number() {
    let mut dice = Dice::new(0x1dea_0006);
    for round in 0..400 {
        let mut rate = || match dice.roll() % 8 {
            0 => 0.0,
            1 => f64::NAN,
            2 => f64::INFINITY,
            3 => -5.0,
            4 => f64::MIN_POSITIVE,
            _ => dice.between(1.0, 10_000.0),
        };
        let rates = MachineRates {
            rapid_x_mm_per_min: rate(),
            rapid_z_mm_per_min: rate(),
            rapid_y_mm_per_min: rate(),
            rapid_c_deg_per_min: rate(),
            rapid_b_deg_per_min: rate(),
            cutting_max_c_deg_per_min: rate(),
            cutting_max_mm_per_min: rate(),
            tool_change_s: rate(),
            spindle_ramp_rpm_per_s: rate(),
            auxiliary_s: rate(),
            auxiliary_times: AuxiliaryTimes::new((0..20).map(|code| (code, rate()))),
            stop_s: rate(),
            optional_stop_s: rate(),
            loading_s: rate(),
            speed_wait: [SpeedWait::Order, SpeedWait::Cut, SpeedWait::Thread][round % 3],
            arrival: Arrival { before_cut: round % 2 == 0, before_thread: round % 5 == 0, delay_s: rate() },
            gears: gears(&mut rate, round),
            holds_tapping: false,
            fluctuation: Fluctuation { part: rate(), hz: rate() },
            orientation: Some(Orientation { code: 10, seconds: rate() }).filter(|_| round % 3 == 0),
            rpm_max: None,
            rpm_min_surface: 0,
            rapid_surface_speed: RapidSurfaceSpeed::AtPresentPoint,
            dynamics: None,
            after: AfterLaw::Exponential,
            home_mm_per_min: rate(),
            panel: Panel {
                feed: rate(),
                rapid: RapidOverride::Part(rate()),
                is_held: round % 7 == 0,
                dry_run_mm_per_min: Some(rate()).filter(|_| round % 4 == 0),
                single_block: round % 2 == 0,
            },
            panel_rules: PanelRules {
                rapid_lowest_per_min: rate(),
                dry_rapids: round % 8 == 0,
                dry_threads: round % 3 == 0,
                ..PanelRules::default()
            },
        };
        let mut clock = Clock::new(at(10.0, 10.0), rates);
        let mut summary = Summary::new();
        for _ in 0..100 {
            let command = Command::new(any_action(&mut dice), Origin::line(1));
            let timing = clock.advance(&command);
            summary.add(&command, &timing);
            let rpm = timing.rpm.map_or([0.0, 0.0], |rpm| [rpm.min, rpm.max]);
            for number in [timing.seconds, timing.waited_s, timing.length_mm, rpm[0], rpm[1]] {
                assert!(number.is_finite() && number >= 0.0, "{round} {rates:?} {command:?} {timing:?}");
            }
        }
        assert!(clock.totals().total_s().is_finite());
        assert_eq!(clock.totals(), summary.totals());
    }
}

#[test]
fn with_acceleration_too_every_command_gets_a_time() {
    let mut dice = Dice::new(0x1dea_0008);
    for round in 0..200 {
        let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
        let mut schedule = Schedule::new(at(10.0, 10.0), rates);
        let mut timed = 0;
        for _ in 0..50 {
            schedule.push(Command::new(any_action(&mut dice), Origin::line(1)));
        }
        schedule.finish();
        while let Some((command, timing)) = schedule.next_known() {
            assert!(timing.seconds.is_finite() && timing.seconds >= 0.0, "{round} {command:?} {timing:?}");
            timed += 1;
        }
        assert_eq!(timed, 50);
    }
}

#[test]
fn causes_blocks_lines_operations_and_tools_add_up_to_the_same_time() {
    let mut dice = Dice::new(0x1dea_0009);
    for round in 0..100 {
        let rates = MachineRates {
            dynamics: dice.one_in(2).then(Dynamics::default),
            auxiliary_times: AuxiliaryTimes::new([(10, 2.5)]),
            stop_s: 30.0,
            loading_s: 12.0,
            ..MachineRates::default()
        };
        let mut schedule = Schedule::new(at(10.0, 10.0), rates);
        let (mut line, mut commands) = (1, 0);
        for _ in 0..200 {
            // Some lines make several commands, some run again.
            line = if dice.one_in(3) { line } else { 1 + (dice.roll() % 30) as u32 };
            schedule.push(Command::new(any_action(&mut dice), Origin::line(line)));
        }
        schedule.finish();
        let (mut summary, mut blocks) = (Summary::new(), BlockTimes::default());
        let (mut of_blocks, mut of_commands, mut ends) = (Duration::ZERO, Duration::ZERO, Duration::ZERO);
        let mut sum_up = |block: BlockTime| {
            assert_eq!(block.start, of_blocks, "{round}");
            of_blocks += block.times.total();
        };
        while let Some((command, timing)) = schedule.next_known() {
            summary.add(&command, &timing);
            let operation = summary.operations().len();
            blocks.add(&command, &timing, operation, None).into_iter().for_each(&mut sum_up);
            of_commands += timing.time();
            commands += 1;
        }
        blocks.finish().into_iter().for_each(&mut sum_up);
        let totals = summary.totals();
        ends += blocks.lines().map(|(.., line)| line.time).sum::<Duration>() + blocks.rest().time;
        let of_kinds: Duration = Kind::ALL.iter().map(|kind| totals.time(*kind)).sum();
        let of_operations: Duration = summary.operations().iter().map(|one| one.times.total()).sum();
        let of_tools: Duration = summary.tools().map(|(_, times)| times.total()).sum();
        for sum in [of_blocks, of_commands, ends, of_kinds, of_operations, of_tools] {
            assert_eq!(sum, totals.total(), "{round}");
        }
        assert_eq!(commands, 200);
        assert!(totals.total() > Duration::ZERO);
    }
}

#[test]
fn lines_beyond_what_is_kept_are_summed() {
    let mut blocks = BlockTimes::default();
    let mut clock = Clock::new(at(10.0, 10.0), MachineRates::default());
    let dwell = Action::Dwell(Dwell::Time(Seconds(0.5)));
    for line in 1..=LINES_MAX as u32 + 3 {
        let command = Command::new(dwell.clone(), Origin::line(line));
        let timing = clock.advance(&command);
        blocks.add(&command, &timing, 1, None);
    }
    blocks.finish();
    assert_eq!(blocks.lines().count(), LINES_MAX);
    assert_eq!((blocks.rest().runs, blocks.rest().time), (3, Duration::from_millis(1500)));
    assert_eq!(blocks.longest(2).len(), 2);
}

#[test]
fn the_same_program_twice_gives_the_same_bits() {
    let seconds = || {
        let mut dice = Dice::new(0x1dea_0007);
        let mut clock = Clock::new(at(100.0, 100.0), MachineRates::default());
        for _ in 0..500 {
            run(&mut clock, any_action(&mut dice));
        }
        clock.totals().total_s().to_bits()
    };
    assert_eq!(seconds(), seconds());
}
