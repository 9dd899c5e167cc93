//! The operator's panel: what every switch does to the time, that player and schedule agree about it, and what the
//! rules of threads, dwells and the reference return make of it.

use turnwright_canon::{
    Action, Command, CycleLabel, CycleOrigin, Dwell, Origin, PanelLock, PathMode, Phase, RapidPath, Shape,
    SpindleSpeed, SpindleState,
};
use turnwright_motion::{
    Clock, Dynamics, Kind, MachineRates, Panel, PanelRules, Player, RapidOverride, Sample, Schedule,
    ThreadHold,
};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, Seconds, WorkTip,
};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// Radius and Z in mm.
fn at(x: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

const START: (f64, f64) = (30.0, 5.0);

fn rapid(x: f64, z: f64, path: RapidPath) -> Command {
    Command::new(Action::Rapid { to: at(x, z), path, others: None }, Origin::line(1))
}

fn cut(x: f64, z: f64, feed: Feed) -> Command {
    Command::new(Action::Feed { to: at(x, z), shape: Shape::Line, feed, others: None }, Origin::line(2))
}

fn per_minute(mm: f64) -> Feed {
    Feed::PerMinute(FeedPerMinute(length(mm)))
}

fn per_turn(mm: f64) -> Feed {
    Feed::PerRevolution(FeedPerRevolution(length(mm)))
}

fn turn(rpm: u32) -> Command {
    let speed = SpindleSpeed::Constant(Rpm(rpm));
    let state = if rpm == 0 { SpindleState::Stop } else { SpindleState::Clockwise };
    Command::new(Action::Spindle { state, speed, rpm_max: None }, Origin::line(3))
}

fn thread(x: f64, z: f64, lead: f64, is_chained: bool) -> Command {
    let start_angle = Angle::ZERO;
    let lead = Lead(length(lead));
    let shape = Shape::Line;
    let action = Action::Thread { to: at(x, z), shape, lead, lead_end: None, start_angle, is_chained };
    Command::new(action, Origin::line(4))
}

fn action(action: Action) -> Command {
    Command::new(action, Origin::line(5))
}

fn rates(panel: Panel, panel_rules: PanelRules) -> MachineRates {
    MachineRates { dynamics: Some(Dynamics::default()), panel, panel_rules, ..MachineRates::default() }
}

/// Seconds of each command.
fn timed(commands: &[Command], rates: MachineRates) -> Vec<f64> {
    let mut schedule = Schedule::new(at(START.0, START.1), rates);
    commands.iter().for_each(|command| schedule.push(command.clone()));
    schedule.finish();
    std::iter::from_fn(|| schedule.next_known()).map(|(_, timing)| timing.seconds).collect()
}

fn played(commands: &[Command], rates: MachineRates, changes: &[(f64, Panel)]) -> (Vec<Sample>, bool) {
    let mut player = Player::new(at(START.0, START.1), rates, 1000.0);
    let mut samples = Vec::new();
    changes.iter().for_each(|(time_s, panel)| player.set_at(*time_s, *panel));
    commands.iter().for_each(|command| player.push(command, &mut |sample| samples.push(*sample)));
    player.finish(&mut |sample| samples.push(*sample));
    (samples, player.is_stuck())
}

/// A shaft end: positioning, a cut by the minute, a corner, a cut by the turn, a dwell, away and home.
fn program() -> Vec<Command> {
    vec![
        turn(1000),
        rapid(20.0, 2.0, RapidPath::EachAxis),
        cut(20.0, -30.0, per_minute(300.0)),
        cut(25.0, -30.0, per_turn(0.25)),
        action(Action::Dwell(Dwell::Time(Seconds(0.5)))),
        rapid(60.0, 40.0, RapidPath::Straight),
        rapid(100.0, 100.0, RapidPath::Home),
    ]
}

/// Time from rest to rest over a way on which the speed is reached before the acceleration could be: that goes up to
/// √(speed · jerk) and down again.
fn rest_to_rest(way: f64, speed: f64, jerk: f64) -> f64 {
    way / speed + 2.0 * (speed / jerk).sqrt()
}

#[test]
fn each_switch_counts_where_it_acts_and_nowhere_else() {
    let rules = PanelRules { rapid_lowest_per_min: 400.0, ..PanelRules::default() };
    let usual = timed(&program(), rates(Panel::default(), rules));
    let with = |panel: Panel| timed(&program(), rates(panel, rules));
    let is_equal = |index: usize, one: &[f64]| (one[index] - usual[index]).abs() < 1e-12;

    // 32 mm at 300 mm/min are 6.4 s; at half of it twice as long, but for the corner and the ramps.
    let half = with(Panel { feed: 0.5, ..Panel::default() });
    assert!((usual[2] - 6.4).abs() < 0.05 && (half[2] - 12.8).abs() < 0.05, "{usual:?} {half:?}");
    assert!((usual[3] - 1.2).abs() < 0.06 && (half[3] - 2.4).abs() < 0.06, "{usual:?} {half:?}");
    assert!([0, 1, 4, 5, 6].into_iter().all(|index| is_equal(index, &half)), "{usual:?} {half:?}");

    // Rapids of each axis for itself: 10 mm of X at 3 m/min, 3 mm of Z; X takes longer. 20 ms into position.
    let quarter = with(Panel { rapid: RapidOverride::Part(0.25), ..Panel::default() });
    let expected = rest_to_rest(10.0, 50.0, 150_000.0) + 0.02;
    assert!((quarter[1] - expected).abs() < 1e-9, "{quarter:?} {expected}");
    assert!([0, 2, 3, 4].into_iter().all(|index| is_equal(index, &quarter)), "{usual:?} {quarter:?}");

    // F0: 400 mm/min for each axis. 10 mm of X take 1.5 s. On the straight way of 35 and 70 mm the longer axis has it.
    let lowest = with(Panel { rapid: RapidOverride::Lowest, ..Panel::default() });
    assert!((lowest[1] - 1.5 - 0.02).abs() < 0.03, "{lowest:?}");
    assert!((lowest[5] - 70.0 / 400.0 * 60.0 - 0.02).abs() < 0.03, "{lowest:?}");

    // Dry run at 2000: the cuts alone; the rapids only when the parameter says so.
    let dry = Panel { dry_run_mm_per_min: Some(2000.0), ..Panel::default() };
    let cuts_only = with(dry);
    assert!((cuts_only[2] - 0.96).abs() < 0.1 && (cuts_only[3] - 0.15).abs() < 0.1, "{cuts_only:?}");
    assert!([0, 1, 4, 5, 6].into_iter().all(|index| is_equal(index, &cuts_only)), "{cuts_only:?}");
    let all = timed(&program(), rates(dry, PanelRules { dry_rapids: true, ..rules }));
    assert!((all[6] - 60.0 / 2000.0 * 60.0 - 0.02).abs() < 0.06, "{all:?}");

    // The feed override stops rapids by parameter only; then nothing has a time.
    let zero = Panel { feed: 0.0, ..Panel::default() };
    assert!(is_equal(1, &with(zero)) && with(zero)[2] == 0.0);
    let stops = timed(&program(), rates(zero, PanelRules { rapids_heed_feed: true, ..rules }));
    assert_eq!(stops[1], 0.0);
}

#[test]
fn single_block_stops_behind_blocks_and_not_inside_of_them() {
    let panel = Panel { single_block: true, ..Panel::default() };
    let seconds = |commands: &[Command], panel| -> f64 {
        timed(commands, rates(panel, PanelRules::default())).iter().sum()
    };
    let mut commands = vec![cut(30.0, 0.0, per_minute(600.0)), cut(30.0, -5.0, per_minute(600.0))];
    let (through, stopped) = (seconds(&commands, Panel::default()), seconds(&commands, panel));
    // Two cuts that are each by themselves, and one chain.
    assert!((stopped - through).abs() > 0.01, "{through} {stopped}");
    commands[0].origin.runs_on = true;
    assert!((seconds(&commands, panel) - through).abs() < 1e-12);
}

#[test]
fn the_return_to_the_reference_point_has_a_rate_of_its_own() {
    let usual = rates(Panel::default(), PanelRules::default());
    let slow = MachineRates { home_mm_per_min: 3000.0, ..usual };
    let (at_rapid, at_home) = (timed(&program(), usual), timed(&program(), slow));
    assert_eq!(at_rapid[..6], at_home[..6]);
    // 60 mm of Z at 50 mm/s.
    let expected = rest_to_rest(60.0, 50.0, 150_000.0) + 0.02;
    assert!((at_home[6] - expected).abs() < 1e-9, "{at_home:?} {expected}");
}

#[test]
fn player_and_schedule_agree_whatever_the_panel() {
    let rules = PanelRules { rapid_lowest_per_min: 300.0, dry_threads: true, ..PanelRules::default() };
    let mut commands = program();
    commands.insert(2, action(Action::PathMode(PathMode::Tapping)));
    commands.insert(4, action(Action::PathMode(PathMode::Continuous)));
    let panels = [
        Panel::default(),
        Panel { feed: 0.4, ..Panel::default() },
        Panel { feed: 1.5, rapid: RapidOverride::Part(0.25), ..Panel::default() },
        Panel { rapid: RapidOverride::Lowest, ..Panel::default() },
        Panel { dry_run_mm_per_min: Some(2500.0), ..Panel::default() },
        Panel { single_block: true, feed: 0.7, ..Panel::default() },
    ];
    for panel in panels {
        for rules in [rules, PanelRules { dry_rapids: true, ..rules }] {
            let rates = rates(panel, rules);
            let seconds: f64 = timed(&commands, rates).iter().sum();
            let (samples, is_stuck) = played(&commands, rates, &[]);
            let last = samples[samples.len() - 1].time_s;
            assert!((last - seconds).abs() < 4e-3 && !is_stuck, "{panel:?} {rules:?}: {last} {seconds}");
        }
    }
    // In tapping mode (between lines 2 and 4 here) the override does not act.
    let seconds = |panel| timed(&commands, rates(panel, rules));
    assert!((seconds(panels[1])[3] - seconds(panels[0])[3]).abs() < 1e-12);
}

#[test]
fn threads_heed_neither_override_nor_dry_run_unless_the_parameter_says_so() {
    let commands =
        [turn(600), rapid(20.0, 5.0, RapidPath::EachAxis), thread(20.0, -25.0, 1.5, false), turn(0)];
    let dry = Panel { dry_run_mm_per_min: Some(3000.0), feed: 0.3, ..Panel::default() };
    let usual = timed(&commands, rates(Panel::default(), PanelRules::default()));
    let in_step = timed(&commands, rates(dry, PanelRules::default()));
    assert_eq!(usual, in_step);
    // 30 mm at 50 mm/s instead of 15.
    let rules = PanelRules { dry_threads: true, ..PanelRules::default() };
    let out_of_step = timed(&commands, rates(dry, rules));
    let expected = rest_to_rest(30.0, 50.0, 150_000.0);
    assert!((out_of_step[2] - expected).abs() < 1e-9, "{out_of_step:?} {expected}");
    assert!(out_of_step[2] < usual[2]);
    let (samples, _) = played(&commands, rates(dry, rules), &[]);
    let threading = samples.iter().filter(|sample| sample.kind == Kind::Threading).count();
    assert!((threading as f64 / 1000.0 - expected).abs() < 3e-3, "{threading} {expected}");
    // The clock without acceleration knows the same rule.
    let bare = MachineRates { dynamics: None, ..rates(dry, rules) };
    let mut clock = Clock::new(at(20.0, 5.0), bare);
    let timing = clock.advance(&thread(20.0, -25.0, 1.5, false));
    assert!((timing.seconds - 0.6).abs() < 1e-12 && timing.rpm.is_none(), "{timing:?}");
}

#[test]
fn a_tap_in_a_dry_run_leads_the_spindle_at_its_speed() {
    let led = |is_led| action(Action::RigidTapping(is_led));
    let commands = [led(true), turn(400), thread(30.0, -15.0, 1.5, false), led(false)];
    let dry = |speed| Panel { dry_run_mm_per_min: Some(speed), ..Panel::default() };
    let rules = PanelRules { dry_threads: true, ..PanelRules::default() };
    let usual = timed(&commands, rates(Panel::default(), rules))[2];
    let slow = timed(&commands, rates(dry(150.0), rules))[2];
    let ineffective = timed(&commands, rates(dry(150.0), PanelRules::default()))[2];
    assert_eq!(usual, ineffective);
    // 20 mm: 2 s at 600 mm/min, 8 s at 150, and the ramps.
    assert!(slow > 8.0 && slow < 8.5 && usual > 2.0 && usual < 2.6, "{slow} {usual}");
}

#[test]
fn a_hold_in_a_thread_acts_behind_it_as_the_control_says() {
    let commands = [
        turn(600),
        rapid(20.0, 5.0, RapidPath::EachAxis),
        thread(20.0, -25.0, 1.5, false),
        rapid(30.0, -25.0, RapidPath::EachAxis),
        rapid(30.0, 5.0, RapidPath::EachAxis),
    ];
    // The thread takes two seconds after some 0.7 s; the hold comes in its middle and lasts ten.
    let held = Panel { is_held: true, ..Panel::default() };
    let changes = [(1.5, held), (11.5, Panel::default())];
    for (thread_hold, stands_at) in
        [(ThreadHold::BehindNextBlock, (30.0, -25.0)), (ThreadHold::AtEnd, (20.0, -25.0))]
    {
        let rules = PanelRules { thread_hold, ..PanelRules::default() };
        let (samples, is_stuck) = played(&commands, rates(Panel::default(), rules), &changes);
        let place = |time_s: f64| samples[(time_s * 1000.0) as usize].place;
        // In the thread nothing happens.
        assert!(place(1.6)[1] < place(1.5)[1] - 1.4, "{thread_hold:?}");
        let standing = place(8.0);
        assert!((standing[0] - stands_at.0).abs() < 1e-9 && (standing[1] - stands_at.1).abs() < 1e-9);
        assert!(!is_stuck && (samples[samples.len() - 1].time_s - 11.5) > 0.1);
    }
}

#[test]
fn a_hold_in_the_pass_of_a_cycle_acts_where_the_pass_ends() {
    let of_cycle = |mut command: Command, phase: Phase, runs_on: bool| {
        command.origin.cycle = Some(CycleOrigin { label: CycleLabel(920), pass: 1, phase });
        command.origin.runs_on = runs_on;
        command
    };
    let commands = [
        turn(600),
        rapid(20.0, 5.0, RapidPath::EachAxis),
        of_cycle(thread(20.0, -25.0, 1.5, false), Phase::Thread, true),
        of_cycle(rapid(30.0, -25.0, RapidPath::EachAxis), Phase::Out, true),
        of_cycle(rapid(30.0, 5.0, RapidPath::EachAxis), Phase::Home, false),
        rapid(40.0, 5.0, RapidPath::EachAxis),
    ];
    let held = Panel { is_held: true, ..Panel::default() };
    for thread_hold in [ThreadHold::BehindNextBlock, ThreadHold::AtEnd] {
        let rules = PanelRules { thread_hold, ..PanelRules::default() };
        let (samples, is_stuck) = played(&commands, rates(Panel::default(), rules), &[(1.5, held)]);
        let last = samples[samples.len() - 1].place;
        assert!(is_stuck && (last[0] - 30.0).abs() < 1e-9 && (last[1] - 5.0).abs() < 1e-9, "{last:?}");
    }
}

#[test]
fn a_hold_stops_the_time_of_a_dwell_where_the_control_says_so() {
    let commands = [action(Action::Dwell(Dwell::Time(Seconds(2.0)))), rapid(40.0, 5.0, RapidPath::EachAxis)];
    let held = Panel { is_held: true, ..Panel::default() };
    let changes = [(1.0, held), (1.5, Panel::default())];
    for (hold_stops_dwell, seconds) in [(true, 2.5), (false, 2.0)] {
        let rules = PanelRules { hold_stops_dwell, ..PanelRules::default() };
        let (samples, is_stuck) = played(&commands, rates(Panel::default(), rules), &changes);
        let dwell = samples.iter().filter(|sample| sample.kind == Kind::Dwell).count() as f64 / 1000.0;
        assert!((dwell - seconds).abs() < 2e-3 && !is_stuck, "{dwell} {seconds}");
    }
}

#[test]
fn an_override_of_nothing_is_a_hold_and_what_follows_goes_on_at_full_speed() {
    let zero = Panel { feed: 0.0, rapid: RapidOverride::Part(0.0), ..Panel::default() };
    let dry = Panel { dry_run_mm_per_min: Some(0.0), ..Panel::default() };
    let lowest = Panel { feed: 0.0, rapid: RapidOverride::Lowest, ..Panel::default() };
    let ways = [cut(30.0, -25.0, per_minute(1200.0)), rapid(30.0, -400.0, RapidPath::EachAxis)];
    for (way, panel) in [(0, zero), (0, dry), (0, lowest), (1, zero), (1, lowest)] {
        let commands = [ways[way].clone()];
        let rates = rates(Panel::default(), PanelRules::default());
        let (usual, _) = played(&commands, rates, &[]);
        let (held, _) = played(
            &commands,
            rates,
            &[(0.5, Panel { is_held: true, ..Panel::default() }), (3.5, Panel::default())],
        );
        let (samples, is_stuck) = played(&commands, rates, &[(0.5, panel), (3.5, Panel::default())]);
        assert!(!is_stuck && samples == held, "{way} {panel:?}: {} {}", samples.len(), held.len());
        assert!(
            samples.len() > usual.len() + 2_900 && samples.len() < usual.len() + 3_300,
            "{way} {panel:?}"
        );
    }
}

#[test]
fn nothing_begins_while_the_operator_holds() {
    let commands = [
        action(Action::Tool { tool: 2, offset: 2 }),
        action(Action::Auxiliary { code: 8 }),
        rapid(40.0, 5.0, RapidPath::EachAxis),
    ];
    // The tool change takes 1.5 s and is finished; the M code waits until 4 s.
    let held = Panel { is_held: true, ..Panel::default() };
    let (samples, _) = played(
        &commands,
        rates(Panel::default(), PanelRules::default()),
        &[(0.5, held), (4.0, Panel::default())],
    );
    let first = |kind: Kind| samples.iter().find(|sample| sample.kind == kind).map(|sample| sample.time_s);
    assert!((first(Kind::Stop).expect("waits") - 1.5).abs() < 2e-3, "{:?}", first(Kind::Stop));
    assert!((first(Kind::Other).expect("goes on") - 4.0).abs() < 2e-3, "{:?}", first(Kind::Other));
    assert!((first(Kind::Rapid).expect("moves") - 4.2).abs() < 3e-3, "{:?}", first(Kind::Rapid));
}

#[test]
fn a_program_can_put_hold_and_override_out_of_action() {
    let dry_run = false;
    let lock = |hold, feed_override| action(Action::PanelLock(PanelLock { hold, feed_override, dry_run }));
    let commands = [
        lock(true, true),
        cut(30.0, -5.0, per_minute(600.0)),
        lock(false, false),
        cut(30.0, -15.0, per_minute(600.0)),
    ];
    let half = Panel { feed: 0.5, ..Panel::default() };
    let rates = rates(half, PanelRules::default());
    let seconds = timed(&commands, rates);
    // 10 mm at 10 mm/s are a second, then two: the lock ends the run, so each has its ramps.
    assert!((seconds[1] - 1.0).abs() < 0.1 && (seconds[3] - 2.0).abs() < 0.1, "{seconds:?}");
    // Held in the first cut: it ends first.
    let held = Panel { is_held: true, ..half };
    let (samples, is_stuck) = played(&commands, rates, &[(0.5, held)]);
    let last = samples[samples.len() - 1];
    assert!(is_stuck && (last.place[1] + 5.0).abs() < 1e-6, "{last:?}");
    let (samples, is_stuck) = played(&commands, rates, &[(0.5, held), (3.0, half)]);
    let last = samples[samples.len() - 1].time_s;
    assert!(!is_stuck && (last - 3.0 - seconds[3]).abs() < 0.01, "{last} {seconds:?}");
}

#[test]
fn a_skip_move_goes_at_its_own_feed_in_dry_run_and_whatever_the_override_and_can_be_held() {
    let lock =
        |feed_override, dry_run| action(Action::PanelLock(PanelLock { hold: false, feed_override, dry_run }));
    let commands = [
        lock(true, true),
        cut(30.0, -5.0, per_minute(600.0)),
        lock(false, false),
        cut(30.0, -15.0, per_minute(600.0)),
    ];
    let usual = timed(&commands, rates(Panel::default(), PanelRules::default()));
    let dry = Some(3000.0);
    let panels = [
        Panel { feed: 0.5, ..Panel::default() },
        Panel { feed: 0.0, dry_run_mm_per_min: dry, ..Panel::default() },
    ];
    for panel in panels {
        let rates = rates(panel, PanelRules::default());
        let seconds = timed(&commands, rates);
        assert_eq!(seconds[1], usual[1], "{panel:?}");
        assert!((seconds[3] - usual[3]).abs() > 0.5, "{panel:?} {seconds:?}");
        let (samples, _) = played(&commands, rates, &[]);
        let last = samples[samples.len() - 1].time_s;
        assert!((last - seconds.iter().sum::<f64>()).abs() < 4e-3, "{last} {seconds:?}");
    }
    let held = Panel { is_held: true, ..Panel::default() };
    let (samples, is_stuck) =
        played(&commands, rates(Panel::default(), PanelRules::default()), &[(0.5, held)]);
    let last = samples[samples.len() - 1];
    assert!(is_stuck && last.place[1] > -1.0 && last.place[1] < 0.5, "{last:?}");
}

#[test]
fn a_dry_run_switched_in_a_thread_acts_behind_it_and_switched_before_it_at_once() {
    // A cut of some 2 s, a chain of two threads, 2 s each in step and 0.6 s at 3 m/min, back, and one thread more.
    let commands = [
        turn(600),
        rapid(20.0, 10.0, RapidPath::EachAxis),
        cut(20.0, 5.0, per_minute(150.0)),
        thread(20.0, -25.0, 1.5, false),
        thread(20.5, -55.0, 1.5, true),
        rapid(30.0, -55.0, RapidPath::EachAxis),
        rapid(20.0, -20.0, RapidPath::Straight),
        thread(20.0, -50.0, 1.5, false),
        cut(20.0, -60.0, per_minute(300.0)),
    ];
    let usual = Panel::default();
    let dry = Panel { dry_run_mm_per_min: Some(3000.0), ..usual };
    let rules = PanelRules { dry_threads: true, ..PanelRules::default() };
    // Seconds in threads, of the chain and of the last one, and of the last cut.
    let seconds = |start: Panel, changes: &[(f64, Panel)]| {
        let (samples, is_stuck) = played(&commands, rates(start, rules), changes);
        assert!(!is_stuck);
        let of = |kind: Kind, is_in: fn(f64) -> bool| {
            let is_here = |sample: &&Sample| sample.kind == kind && is_in(sample.place[1]);
            samples.iter().filter(is_here).count() as f64 / 1000.0
        };
        let back = samples.iter().rposition(|sample| sample.kind == Kind::Rapid).expect("goes back");
        let last =
            samples[back..].iter().filter(|sample| sample.kind == Kind::Threading).count() as f64 / 1000.0;
        [of(Kind::Threading, |_| true) - last, last, of(Kind::Cutting, |z| z < -50.0)]
    };
    let is_near = |now: [f64; 3], expected: [f64; 3]| {
        now.iter().zip(expected).all(|(now, expected)| (now - expected).abs() < 0.2)
    };
    let (in_step, all_dry) = (seconds(usual, &[]), seconds(dry, &[]));
    assert!(
        is_near(in_step, [4.1, 2.1, 2.0]) && is_near(all_dry, [1.2, 0.6, 0.2]),
        "{in_step:?} {all_dry:?}"
    );
    // In the cut before the chain: that is the next to begin.
    assert!(is_near(seconds(usual, &[(1.5, dry)]), all_dry), "{:?}", seconds(usual, &[(1.5, dry)]));
    // Turned off before the chain: the spindle has its speed after 0.6 s, the dry cut begins at 0.75 s.
    let early = seconds(dry, &[(0.75, usual)]);
    assert!(is_near(early, in_step), "{early:?}");
    // In the chain, in its first link: it ends as it began, what follows is dry.
    let begun = seconds(usual, &[(4.0, dry)]);
    assert!(is_near(begun, [in_step[0], all_dry[1], all_dry[2]]), "{begun:?}");
    // And the other way round.
    let begun = seconds(dry, &[(1.3, usual)]);
    assert!(is_near(begun, [all_dry[0], in_step[1], in_step[2]]), "{begun:?}");
}
