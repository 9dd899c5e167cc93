//! Commands applied to stock: what is cut, and what each crash looks like, beside the program that does not crash.

use std::f64::consts::PI;

use turnwright_canon::{
    Action, Command, Coolant, Interpolation, Origin, OtherAxes, RapidPath, Shape, SpindleSpeed, SpindleState,
    Turn,
};
use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_stock::machining::{Event, EventKind, Obstacle, RapidRates, ToolShape};
use turnwright_stock::{Machining, Section};
use turnwright_units::{Angle, Feed, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, WorkTip};

const RATES: RapidRates = RapidRates { x_mm_per_min: 10_000.0, z_mm_per_min: 20_000.0 };

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// A place by diameter and Z, as drawings and programs say it.
fn place(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(diameter / 2.0)), length(z))
}

fn rapid(diameter: f64, z: f64) -> Action {
    Action::Rapid { to: place(diameter, z), path: RapidPath::EachAxis, others: None }
}

fn straight(diameter: f64, z: f64) -> Action {
    Action::Rapid { to: place(diameter, z), path: RapidPath::Straight, others: None }
}

fn cut(diameter: f64, z: f64, shape: Shape) -> Action {
    let feed = Feed::PerRevolution(FeedPerRevolution(length(0.2)));
    Action::Feed { to: place(diameter, z), shape, feed, others: None }
}

fn feed(diameter: f64, z: f64) -> Action {
    cut(diameter, z, Shape::Line)
}

fn thread(diameter: f64, z: f64, lead: f64, start: i64) -> Action {
    Action::Thread {
        to: place(diameter, z),
        shape: Shape::Line,
        lead: Lead(length(lead)),
        lead_end: None,
        start_angle: Angle::from_millidegrees(start * 1_000),
        is_chained: false,
    }
}

fn tool(number: u32) -> Action {
    Action::Tool { tool: number, offset: number }
}

fn spindle(state: SpindleState) -> Action {
    Action::Spindle { state, speed: SpindleSpeed::Constant(Rpm(800)), rpm_max: None }
}

fn polygon(corners: &[(f64, f64)]) -> Outline {
    let points: Vec<Point> = corners.iter().map(|&(x, z)| Point::new(x, z)).collect();
    Outline::polygon(&points).expect("an outline")
}

/// 1: a turning tool with its holder 0.5 mm behind. 2: a parting blade 3 mm wide, by its left corner, with a shank
/// 30 mm up. 3: a threading insert of 60 degrees.
fn lathe() -> Machining {
    let bar = Section::bar(25.0, -80.0, 0.0).expect("a bar");
    let mut machining = Machining::new(bar, place(120.0, 50.0), RATES);
    let line = |start, end| Segment { start, end, bend: None };
    let bend = Some(Bend { centre: Point::new(0.4, 0.4), clockwise: false });
    let insert = vec![
        Segment { start: Point::new(0.4, 0.), end: Point::new(0., 0.4), bend },
        line(Point::new(0., 0.4), Point::new(1., 12.)),
        line(Point::new(1., 12.), Point::new(12., 12.)),
        line(Point::new(12., 12.), Point::new(12., 1.)),
        line(Point::new(12., 1.), Point::new(0.4, 0.)),
    ];
    let turning = ToolShape {
        cutting: Outline::new(insert).expect("an insert"),
        body: Some(polygon(&[(2.5, 3.), (2.5, 25.), (80., 25.), (80., 3.)])),
    };
    let parting = ToolShape {
        cutting: polygon(&[(0., 0.), (0., 3.), (30., 3.), (30., 0.)]),
        body: Some(polygon(&[(30., -5.), (30., 15.), (80., 15.), (80., -5.)])),
    };
    let threading = ToolShape {
        cutting: polygon(&[(0., 0.), (5., -5.0 / 3f64.sqrt()), (5., 5.0 / 3f64.sqrt())]),
        body: None,
    };
    for (number, shape) in [(1, turning), (2, parting), (3, threading)] {
        machining.set_tool(number, &shape);
    }
    let jaws = polygon(&[(25., -90.), (25., -60.), (70., -60.), (70., -90.)]);
    machining.add_obstacle(Obstacle::Jaws, &jaws).expect("jaws");
    machining
}

/// Runs actions, one a line, and gives the events.
fn run(machining: &mut Machining, actions: &[Action]) -> Vec<Event> {
    let mut events = Vec::new();
    for (action, line) in actions.iter().zip(1..) {
        machining.advance(&Command::new(action.clone(), Origin::line(line)), &mut |event| events.push(event));
    }
    events
}

fn turning(actions: Vec<Action>) -> (Machining, Vec<Event>) {
    let mut machining = lathe();
    let before = vec![tool(1), spindle(SpindleState::Clockwise)];
    let events = run(&mut machining, &[before, actions].concat());
    (machining, events)
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
}

#[test]
fn a_clean_program_tells_nothing() {
    let (machining, events) = turning(vec![
        rapid(54., 2.),
        rapid(40., 2.),
        feed(40., -30.),
        feed(51., -30.),
        rapid(51., 2.),
        rapid(36., 2.),
        feed(36., -5.),
        cut(40., -7., Shape::Arc { turn: Turn::Clockwise, centre: place(40., -5.) }),
        feed(40., -30.),
        rapid(120., 50.),
    ]);
    assert_eq!(events, []);
    let section = machining.section();
    near(section.rings(-3.)[0].1, 18.0);
    near(section.rings(-20.)[0].1, 20.0);
}

#[test]
fn a_rapid_into_stock_is_told_with_line_place_and_depth() {
    // From X54 Z2 straight to X40 Z-10: 5 mm into the bar at rapid.
    let (machining, events) = turning(vec![rapid(54., 2.), rapid(40., 2.), straight(40., -10.)]);
    assert_eq!(events.len(), 1);
    let event = &events[0];
    assert_eq!((event.kind, event.origin.line), (EventKind::RapidIntoStock, 5));
    // The edge touches the face when the programmed point is there.
    assert!((event.place.x - 20.0).abs() < 1e-9 && event.place.z.abs() < 0.01, "{:?}", event.place);
    let contact = event.contact.expect("a contact");
    near(contact.bounds.max.x, 25.0);
    near(contact.bounds.min.x, 20.0);
    near(contact.depth_mm, 5.0);
    // It took what it hit: the way back is free.
    assert!(machining.section().rings(-5.)[0].1 < 20.0 + 1e-6);
}

#[test]
fn only_the_dog_leg_hits() {
    // Straight from X60 Z-20 to X20 Z20 the tool stays clear of the corner at X50 Z0; with each axis at its own rate X
    // would be in first were it faster, but here Z ends first.
    let way = |action| turning(vec![rapid(90., 10.), rapid(90., -22.), action]).1;
    assert_eq!(way(straight(50., 20.)).len(), 0);
    let mut machining = lathe();
    let slow_z = Machining::new(
        machining.section().clone(),
        place(90., -22.),
        RapidRates { z_mm_per_min: 2_000.0, ..RATES },
    );
    let mut dog_leg = slow_z;
    let shape = ToolShape { cutting: polygon(&[(0., 0.), (0., 2.), (8., 2.), (8., 0.)]), body: None };
    dog_leg.set_tool(1, &shape);
    machining.set_tool(1, &shape);
    let program = [tool(1), spindle(SpindleState::Clockwise), rapid(44., 20.)];
    let events = run(&mut dog_leg, &program);
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::RapidIntoStock]);
    near(events[0].contact.expect("a contact").bounds.min.x, 22.0);
    // Along the straight line nothing is hit.
    let mut straight_on = Machining::new(machining.section().clone(), place(90., -22.), RATES);
    straight_on.set_tool(1, &shape);
    assert_eq!(run(&mut straight_on, &[tool(1), spindle(SpindleState::Clockwise), straight(44., 20.)]), []);
}

#[test]
fn the_holder_behind_the_insert_hits_the_shoulder() {
    // Plunging 5 mm deep beside nothing: the holder, 2.5 mm higher and 3 mm beside, goes into the bar.
    let (_, events) = turning(vec![rapid(54., -20.), feed(40., -20.)]);
    let holder = events.iter().find(|event| event.kind == EventKind::BodyIntoStock).expect("the holder");
    assert_eq!(holder.origin.line, 4);
    near(holder.contact.expect("a contact").depth_mm, 2.5);
    near(holder.place.x, 22.5 - 1e-3);
    let (_, events) = turning(vec![rapid(54., -20.), feed(46., -20.)]);
    assert_eq!(events, []);
}

#[test]
fn jaws_are_hit_by_cutting_edges_and_holders_at_any_feed() {
    let (_, events) = turning(vec![rapid(54., 2.), rapid(49., 2.), feed(49., -61.)]);
    assert_eq!(
        events.iter().map(|event| event.kind).collect::<Vec<_>>(),
        [EventKind::IntoObstacle(Obstacle::Jaws)]
    );
    // The edge that leads leans back by 1 in 11.6.
    near(events[0].contact.expect("a contact").depth_mm, 1.0 - 0.1 / 11.6);
    let (_, events) = turning(vec![rapid(54., 2.), rapid(49., 2.), feed(49., -59.9)]);
    assert_eq!(events, []);
    let (_, events) = turning(vec![rapid(90., -55.), straight(90., -70.)]);
    assert_eq!(events.first().map(|event| event.kind), Some(EventKind::IntoObstacle(Obstacle::Jaws)));
}

#[test]
fn a_cut_with_a_standing_spindle_is_told() {
    let mut machining = lathe();
    let stop = spindle(SpindleState::Stop);
    let program = [tool(1), stop, rapid(54., 2.), rapid(48., 2.), feed(48., 1.), feed(48., -10.)];
    let events = run(&mut machining, &program);
    assert_eq!(events.len(), 1);
    assert_eq!((events[0].kind, events[0].origin.line), (EventKind::SpindleStopped, 6));
}

#[test]
fn parting_lets_the_part_fall_and_it_is_gone() {
    let mut machining = lathe();
    let program = [
        tool(2),
        spindle(SpindleState::Clockwise),
        rapid(54., -40.),
        feed(14., -40.),
        rapid(54., -40.),
        rapid(54., -40.),
    ];
    assert_eq!(run(&mut machining, &program), []);
    let events =
        run(&mut machining, &[rapid(15., -40.), feed(-1., -40.), rapid(60., -40.), rapid(20., -10.)]);
    // Then, at rapid, through where the part was: nothing is there.
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::CutOff]);
    let part = events[0].contact.expect("the part");
    near(part.bounds.min.z, -37.0);
    near(part.bounds.max.z, 0.0);
    assert!((part.volume_mm3 - PI * 625.0 * 37.0).abs() < 1e-6);
    near(machining.section().bounds().expect("the rest").max.z, -40.0);
}

#[test]
fn threads_are_true_grooves_at_their_lead_and_start() {
    let mut machining = lathe();
    let spin = spindle(SpindleState::Clockwise);
    // M50 x 2 by an insert of 60 degrees, 1 mm deep, from Z4 to Z-20: a groove at every even Z.
    let before = machining.section().volume_mm3();
    run(
        &mut machining,
        &[tool(3), spin, rapid(54., 4.), rapid(48., 4.), thread(48., -20., 2., 0), rapid(54., -20.)],
    );
    for z in [-2.0, -4.0, -10.0, -18.0] {
        near(machining.section().rings(z)[0].1, 24.0);
        near(machining.section().rings(z + 1.0)[0].1, 25.0);
    }
    // Each is a ring of the area of the insert's point, turned round its centroid.
    let area = 1.0 / 3f64.sqrt();
    let ring = 2.0 * PI * area * (25.0 - 1.0 / 3.0);
    let grooves = (before - machining.section().volume_mm3()) / ring;
    // Whole ones at Z-2 to Z-20, half of one at Z0.
    assert!((grooves - 10.5).abs() < 1e-9, "{grooves}");
    // The second start, half a turn on: a groove at every odd Z.
    run(&mut machining, &[rapid(54., 4.), rapid(48., 4.), thread(48., -20., 2., 180), rapid(54., -20.)]);
    near(machining.section().rings(-3.0)[0].1, 24.0);
    let marks = machining.threads();
    assert_eq!(marks.len(), 1);
    assert_eq!((marks[0].starts.len(), marks[0].passes, marks[0].lead_mm), (2, 2, 2.0));
    near(marks[0].bounds.min.x, 24.0);
}

#[test]
fn a_thread_that_ends_in_solid_is_left_through_its_own_groove() {
    // M50 x 1.5 by 1 mm deep, 15 mm long: it ends half a turn behind the half-plane that is looked at, where the section
    // is still solid. X out is through the groove that the insert stands in.
    let begin = [tool(3), spindle(SpindleState::Clockwise), rapid(54., 3.), rapid(48., 3.)];
    let solid = thread(48., -14.25, 1.5, 0);
    let leaving = |way: Vec<Action>| {
        let mut machining = lathe();
        let events = run(&mut machining, &[begin.to_vec(), vec![solid.clone()], way].concat());
        (machining, events)
    };
    let grooves = leaving(Vec::new()).0.section().volume_mm3();
    let wait = Action::Coolant(Coolant::On);
    for way in [vec![rapid(54., -14.25)], vec![straight(54., -14.25)], vec![wait, rapid(54., -14.25)]] {
        let (machining, events) = leaving(way);
        assert_eq!(events, []);
        near(machining.section().volume_mm3(), grooves);
    }
    // Along Z it leads through the crests, and so does X out a little further on.
    let (_, events) = leaving(vec![rapid(48., 3.)]);
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::RapidIntoStock]);
    near(events[0].place.x, 24.0);
    let mut beside = lathe();
    let next = [solid.clone(), rapid(54., -14.25), rapid(54., -30.), rapid(48., -30.)];
    let events = run(&mut beside, &[begin.to_vec(), next.to_vec()].concat());
    assert_eq!(events.iter().map(|event| event.origin.line).collect::<Vec<_>>(), [8]);
    // One move later the groove is no excuse any more.
    let (_, events) = leaving(vec![rapid(54., -14.25), rapid(48., -14.25)]);
    assert_eq!(events.iter().map(|event| event.origin.line).collect::<Vec<_>>(), [7]);
}

#[test]
fn what_is_not_turned_is_told_and_not_taken() {
    let others = OtherAxes { c: Some(Angle::from_millidegrees(90_000)), ..OtherAxes::default() };
    let mut slot = feed(40., -10.);
    if let Action::Feed { others: axes, .. } = &mut slot {
        *axes = Some(Box::new(others));
    }
    let (machining, events) = turning(vec![rapid(54., 2.), rapid(40., 2.), slot]);
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::NotTurned]);
    near(machining.section().area_mm2(), 2_000.0);
    let polar = Interpolation::Polar { zero: Angle::ZERO, is_below: false };
    let (machining, events) =
        turning(vec![rapid(54., 2.), rapid(40., 2.), Action::Interpolation(polar), feed(40., -10.)]);
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::NotTurned]);
    near(machining.section().area_mm2(), 2_000.0);
}

#[test]
fn a_tool_without_a_shape_is_told_once_in_a_row() {
    let mut machining = lathe();
    let program = [
        tool(7),
        spindle(SpindleState::Clockwise),
        rapid(40., 2.),
        feed(40., -5.),
        feed(40., -9.),
        tool(1),
        tool(8),
        feed(30., -9.),
    ];
    let events = run(&mut machining, &program);
    let kinds: Vec<_> = events.iter().map(|event| (event.kind, event.origin.line)).collect();
    assert_eq!(kinds, [(EventKind::NoShape { tool: 7 }, 4), (EventKind::NoShape { tool: 8 }, 8)]);
    near(machining.section().area_mm2(), 2_000.0);
}

#[test]
fn places_that_no_lathe_reaches_end_no_run() {
    let far = [i64::MAX, i64::MIN, 1_000_000_000_000_000, -7, 0];
    let mut machining = lathe();
    let mut program = vec![tool(1), spindle(SpindleState::Clockwise)];
    for x in far {
        for z in far {
            let to = Position::new(Radius(Length::from_nm(x)), Length::from_nm(z));
            program.push(Action::Rapid { to, path: RapidPath::EachAxis, others: None });
            let centre = Position::new(Radius(Length::from_nm(z)), Length::from_nm(x));
            let shape = Shape::Arc { turn: Turn::Clockwise, centre };
            let feed = Feed::PerRevolution(FeedPerRevolution(length(0.2)));
            program.push(Action::Feed { to: place(30., -20.), shape, feed, others: None });
            program.push(thread(30., -1e9, 1e-6, 20));
            program.push(Action::Relocate { to, others: None });
        }
    }
    run(&mut machining, &program);
    assert!(machining.section().area_mm2().is_finite());
}
