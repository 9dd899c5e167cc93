//! The moves of the seed programs' cycles, one by one, as worked out by hand rules and a separate small program.
//!
//! In the tables a move is its kind (R rapid, F line, W clockwise arc, T thread), its phase (a approach, i infeed,
//! c cut, e escape, r return, k contour, p peck, b back, o out, s shift, t thread, h home), its end as diameter and
//! Z. All at 0.0001 mm.

use turnwright_canon::{Action, Phase, RapidPath, Shape, Turn};
use turnwright_cycles::{
    BottomEscape, Clamp, Coincident, Context, CutAlong, CycleMove, DepthLaw, Element, EscapeSpeed, Figure,
    FigureMotion, FlankInfeed, GrooveRequest, Hump, LevelOrigin, Monotony, PatternRequest, PeckAxis,
    PocketRequest, ReliefDirection, RoughRequest, SinglePass, ThreadRequest, Tolerance, groove,
    monotony_fault, pattern, rough, rough_pockets, start_inside_fault, thread,
};
use turnwright_geometry::{Point, centre_from_radius};
use turnwright_units::{
    Angle, Diameter, Feed, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, WorkTip,
};

const UNIT: LeastIncrement = LeastIncrement::METRIC_C;

fn mm(value: f64) -> Length {
    Length::from_mm_rounded(value, UNIT).expect("a length")
}

fn radius(value: f64) -> Radius {
    Radius(Length::from_nm((value * 1e6).round() as i64))
}

/// A place by diameter and Z, mm.
fn at(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Diameter(mm(diameter)).to_radius(), mm(z))
}

fn context(diameter: f64, z: f64) -> Context {
    Context {
        start: at(diameter, z),
        increment: UNIT,
        feed: Feed::PerRevolution(FeedPerRevolution(mm(0.3))),
        rapid: RapidPath::EachAxis,
    }
}

/// A figure from its start and elements: `R` rapid, `F` line, `W` clockwise arc with a radius.
fn figure(start: (f64, f64), elements: &[(char, f64, f64, f64)]) -> Figure {
    let mut from = Point::new(start.0 / 2.0, start.1);
    let mut out = Vec::new();
    for &(kind, diameter, z, arc_radius) in elements {
        let end = Point::new(diameter / 2.0, z);
        let motion = match kind {
            'R' => FigureMotion::Rapid,
            'F' => FigureMotion::Line,
            _ => {
                let centre = centre_from_radius(from, end, arc_radius, true, 0.0).expect("an arc");
                let centre =
                    Position::new(radius(centre.x), Length::from_nm((centre.z * 1e6).round() as i64));
                FigureMotion::Arc { turn: Turn::Clockwise, centre }
            }
        };
        out.push(Element { to: at(diameter, z), motion, line: 0 });
        from = end;
    }
    Figure { start: at(start.0, start.1), elements: out }
}

fn rough_request(along: CutAlong, start: (f64, f64), depth: f64, allowance: (f64, f64)) -> RoughRequest {
    RoughRequest {
        context: context(start.0, start.1),
        along,
        depth: mm(depth),
        escape: mm(0.5),
        allowance_x: Diameter(mm(allowance.0)).to_radius(),
        allowance_z: mm(allowance.1),
        coincident: Coincident::Through,
        level_origin: LevelOrigin::ShiftedStart,
        escape_speed: EscapeSpeed::Feed,
        semi_finish: true,
        monotony: Monotony::Check { tolerance: Tolerance::EXACT },
    }
}

fn shaft() -> Figure {
    let elements = [
        ('F', 15.0, 0.5, 0.0),
        ('F', 15.0, 0.0, 0.0),
        ('F', 15.0, -15.0, 0.0),
        ('F', 30.0, -30.0, 0.0),
        ('F', 30.0, -42.0, 0.0),
        ('W', 36.0, -45.0, 3.0),
        ('F', 46.0, -45.0, 0.0),
    ];
    figure((46.0, 0.5), &elements)
}

fn shaft_request() -> RoughRequest {
    rough_request(CutAlong::Z, (46.0, 0.5), 2.0, (0.3, 0.1))
}

fn told(step: &CycleMove) -> (u32, String) {
    let kind = match &step.action {
        Action::Rapid { .. } => 'R',
        Action::Feed { shape: Shape::Line, .. } => 'F',
        Action::Feed { shape: Shape::Arc { turn: Turn::Clockwise, .. }, .. } => 'W',
        Action::Thread { .. } => 'T',
        other => panic!("no move of these cycles: {other:?}"),
    };
    let phase = match step.phase {
        Phase::Approach => 'a',
        Phase::Infeed => 'i',
        Phase::Cut => 'c',
        Phase::Escape => 'e',
        Phase::Return => 'r',
        Phase::Contour => 'k',
        Phase::Peck => 'p',
        Phase::Back => 'b',
        Phase::Out => 'o',
        Phase::Shift => 's',
        Phase::Thread => 't',
        Phase::Home => 'h',
        other => panic!("no phase of these cycles: {other:?}"),
    };
    let to = step.action.end_point().expect("a move");
    (step.pass, format!("{kind}{phase}{},{}", to.x.to_diameter().0, to.z))
}

fn all(table: &[(u32, &str)]) -> Vec<(u32, String)> {
    let mut moves = Vec::new();
    for &(pass, row) in table {
        moves.extend(row.split_whitespace().map(|step| (pass, step.to_owned())));
    }
    moves
}

fn assert_moves(cycle: impl Iterator<Item = CycleMove>, table: &[(u32, &str)]) {
    let (made, expected): (Vec<_>, Vec<_>) = (cycle.map(|step| told(&step)).collect(), all(table));
    for (index, (got, want)) in made.iter().zip(&expected).enumerate() {
        assert_eq!(got, want, "move {}", index + 1);
    }
    assert_eq!(made.len(), expected.len());
}

/// Every arc must have both ends on its circle.
fn assert_arcs_close(start: Position<WorkTip>, moves: &[CycleMove]) {
    let mut from = start;
    for step in moves {
        let to = step.action.end_point().expect("a move");
        if let Action::Feed { shape: Shape::Arc { centre, .. }, .. } = &step.action {
            let reach = |place: Position<WorkTip>| {
                (place.x.to_mm() - centre.x.to_mm()).hypot(place.z.to_mm() - centre.z.to_mm())
            };
            assert!((reach(from) - reach(to)).abs() < 2e-6, "{step:?}");
        }
        from = to;
    }
}

#[test]
fn rough_turning_of_the_shaft() {
    let cycle = rough(shaft(), shaft_request()).expect("a cycle");
    assert_eq!(cycle.move_estimate(), 38);
    let moves: Vec<_> = cycle.clone().collect();
    assert_arcs_close(shaft().start, &moves);
    assert_eq!(moves[10].element, Some(5), "the third cut ends on the fillet");
    assert_eq!(moves[34].element, Some(5), "the fillet of the contour pass");
    assert_moves(cycle, SHAFT);
    assert_eq!(monotony_fault(&shaft(), CutAlong::Z, Tolerance::EXACT), None);
    let request = shaft_request();
    assert_eq!(start_inside_fault(&shaft(), CutAlong::Z, request.allowance_x, request.allowance_z), None);
}

#[test]
fn a_level_that_stops_at_the_cylinder_it_coincides_with() {
    let request = RoughRequest { coincident: Coincident::Stop, ..shaft_request() };
    let moves: Vec<_> = rough(shaft(), request).expect("a cycle").map(|step| told(&step).1).collect();
    assert_eq!(moves[14], "Fc30.3,-29.9");
    assert_eq!(moves[15], "Fe31.3,-29.4");
    assert_eq!(moves.len(), 37);
}

#[test]
fn levels_counted_from_the_start_itself() {
    let request = RoughRequest { level_origin: LevelOrigin::Start, ..shaft_request() };
    let moves: Vec<_> = rough(shaft(), request).expect("a cycle").map(|step| told(&step).1).collect();
    assert_eq!(moves[..3], ["Ra46.3,0.6", "Fi42,0.6", "Fc42,-44.9"]);
    assert_eq!(moves[26], "Fc18,-17.6");
}

#[test]
fn escape_at_rapid_and_no_contour_pass() {
    let request = RoughRequest { escape_speed: EscapeSpeed::Rapid, semi_finish: false, ..shaft_request() };
    let moves: Vec<_> = rough(shaft(), request).expect("a cycle").map(|step| told(&step).1).collect();
    assert_eq!(moves[3], "Re43.3,-44.4");
    assert_eq!(moves[28..], ["Rr19.3,0.6", "Rh46,0.5"]);
}

fn pocket_request(rough: RoughRequest) -> PocketRequest {
    PocketRequest {
        rough,
        tolerance: Tolerance::EXACT,
        clearance: Length::ZERO,
        hump: Hump::AlongContour,
        bottom_escape: BottomEscape::Follow,
        lift_speed: EscapeSpeed::Rapid,
    }
}

fn two_pockets() -> Figure {
    let elements = [
        ('R', 30.0, 2.0, 0.0),
        ('F', 30.0, -10.0, 0.0),
        ('F', 50.0, -20.0, 0.0),
        ('F', 34.0, -28.0, 0.0),
        ('F', 34.0, -36.0, 0.0),
        ('F', 52.0, -42.0, 0.0),
        ('F', 40.0, -48.0, 0.0),
        ('F', 40.0, -54.0, 0.0),
        ('F', 56.0, -60.0, 0.0),
        ('F', 60.0, -60.0, 0.0),
    ];
    figure((60.0, 2.0), &elements)
}

#[test]
fn rough_turning_of_two_pockets() {
    let request = pocket_request(rough_request(CutAlong::Z, (60.0, 2.0), 3.0, (0.4, 0.0)));
    let cycle = rough_pockets(two_pockets(), request).expect("a cycle");
    assert!(cycle.move_estimate() >= 66);
    assert_moves(cycle, TWO_POCKETS);
}

#[test]
fn rough_facing_of_the_flange() {
    let elements = [
        ('R', 61.0, -15.0, 0.0),
        ('F', 40.0, -15.0, 0.0),
        ('F', 30.0, -10.0, 0.0),
        ('F', 30.0, -5.0, 0.0),
        ('W', 20.0, 0.0, 5.0),
        ('R', 20.0, 0.5, 0.0),
    ];
    let request = rough_request(CutAlong::X, (61.0, 0.5), 2.0, (0.1, 0.3));
    let cycle = rough(figure((61.0, 0.5), &elements), request).expect("a cycle");
    assert_arcs_close(request.context.start, &cycle.clone().collect::<Vec<_>>());
    assert_moves(cycle, FLANGE);
}

#[test]
fn rough_facing_of_the_stepped_face() {
    let elements = [
        ('R', 176.0, -55.0, 0.0),
        ('F', 160.0, -55.0, 0.0),
        ('F', 80.0, -35.0, 0.0),
        ('F', 80.0, -20.0, 0.0),
        ('F', 40.0, 0.0, 0.0),
    ];
    let request = rough_request(CutAlong::X, (176.0, 10.0), 2.0, (0.2, 0.1));
    assert_moves(rough(figure((176.0, 10.0), &elements), request).expect("a cycle"), STEPPED_FACE);
}

fn pattern_request(start: (f64, f64), relief: (f64, f64), allowance: (f64, f64)) -> PatternRequest {
    PatternRequest {
        context: context(start.0, start.1),
        relief_x: radius(relief.0),
        relief_z: mm(relief.1),
        passes: 3,
        allowance_x: Diameter(mm(allowance.0)).to_radius(),
        allowance_z: mm(allowance.1),
        single_pass: SinglePass::Once,
    }
}

fn forging() -> Figure {
    let elements = [
        ('R', 50.0, 1.0, 0.0),
        ('F', 50.0, -10.0, 0.0),
        ('F', 60.0, -15.0, 0.0),
        ('F', 60.0, -25.0, 0.0),
        ('W', 80.0, -35.0, 10.0),
        ('F', 90.0, -40.0, 0.0),
        ('R', 110.0, 10.0, 0.0),
    ];
    figure((110.0, 10.0), &elements)
}

#[test]
fn pattern_repeating_of_the_forging() {
    let request = pattern_request((110.0, 10.0), (5.0, 3.0), (0.4, 0.1));
    let cycle = pattern(forging(), request).expect("a cycle");
    assert_eq!(cycle.move_estimate(), 25);
    assert_arcs_close(request.context.start, &cycle.clone().collect::<Vec<_>>());
    assert_moves(cycle, FORGING);
}

#[test]
fn pattern_repeating_of_the_hollow() {
    let elements = [('F', 30.0, -10.0, 0.0), ('W', 30.0, -30.0, 15.0), ('R', 50.0, -10.0, 0.0)];
    let request = pattern_request((50.0, -10.0), (4.0, 0.0), (0.4, 0.0));
    assert_moves(pattern(figure((50.0, -10.0), &elements), request).expect("a cycle"), HOLLOW);
}

#[test]
fn one_pass_is_one_at_the_allowance_or_two() {
    let first_of = |single_pass| {
        let request = PatternRequest {
            passes: 1,
            single_pass,
            ..pattern_request((110.0, 10.0), (5.0, 3.0), (0.4, 0.1))
        };
        let moves: Vec<_> = pattern(forging(), request).expect("a cycle").map(|step| told(&step)).collect();
        (moves[0].1.clone(), moves.last().expect("home").0)
    };
    assert_eq!(first_of(SinglePass::Once), ("Ra110.4,10.1".to_owned(), 1));
    assert_eq!(first_of(SinglePass::Twice), ("Ra120.4,13.1".to_owned(), 2));
}

fn slot(start_z: f64, peck: f64) -> GrooveRequest {
    GrooveRequest {
        context: context(125.0, start_z),
        peck_axis: PeckAxis::X,
        end: at(40.0, -50.0),
        peck: Some(mm(peck)),
        step: Some(mm(3.0)),
        retract: mm(0.5),
        relief: Length::ZERO,
        relief_direction: ReliefDirection::AlwaysPlus,
    }
}

fn assert_columns(request: GrooveRequest, count: usize, first: &[(u32, &str)], last: &[(u32, &str)]) {
    let moves: Vec<_> = groove(request).expect("a cycle").collect();
    assert_eq!(moves.len(), count);
    let last_pass = last[0].0;
    assert_moves(moves.iter().filter(|step| step.pass == 1).cloned(), first);
    assert_moves(moves.iter().filter(|step| step.pass == last_pass).cloned(), last);
}

#[test]
fn radial_grooving() {
    // The word is 6 mm either way: on the diameter, or on the radius.
    assert_columns(slot(-24.0, 3.0), 310, SLOT_FINE_FIRST, SLOT_FINE_LAST);
    assert_columns(slot(-20.0, 6.0), 187, SLOT_COARSE_FIRST, SLOT_COARSE_LAST);
}

#[test]
fn pecked_drilling() {
    let request = GrooveRequest {
        context: context(0.0, 2.0),
        peck_axis: PeckAxis::Z,
        end: at(0.0, -20.0),
        peck: Some(mm(5.0)),
        step: None,
        retract: mm(1.0),
        relief: Length::ZERO,
        relief_direction: ReliefDirection::BySign,
    };
    assert_moves(groove(request).expect("a cycle"), DRILL);
}

#[test]
fn thread_cutting() {
    let request = ThreadRequest {
        context: context(25.0, 5.0),
        end: at(17.4, -20.0),
        taper: Radius::ZERO,
        height: radius(1.3),
        first_depth: radius(0.4),
        min_depth: radius(0.1),
        finishing_allowance: radius(0.05),
        finishing_passes: 2,
        run_out: Length::ZERO,
        run_out_angle_deg: 0,
        nose_angle_deg: 60,
        lead: Lead(mm(2.0)),
        start_angle: Angle::ZERO,
        starts: 1,
        depths: DepthLaw::EqualArea(Clamp::Accumulate),
        infeed: FlankInfeed::WithCut,
        run_out_depth: None,
        pull_out_feed: None,
    };
    assert_moves(thread(request).expect("a cycle"), SCREW);
}

/// The four corners of the sign table: A, first element, figure end, allowances; level places, contour, cut sign.
#[test]
fn directions_come_from_the_figure() {
    struct Case {
        start: (f64, f64),
        bottom: f64,
        end: (f64, f64),
        allowance: (f64, f64),
        moved: (f64, f64),
        levels: [f64; 4],
        contour: f64,
        first_cut_end: &'static str,
        first_escape: &'static str,
    }
    let cases = [
        // Outside, towards the chuck.
        Case {
            start: (60.0, 2.0),
            bottom: 30.0,
            end: (60.0, -40.0),
            allowance: (0.4, 0.1),
            moved: (60.4, 2.1),
            levels: [54.4, 48.4, 42.4, 36.4],
            contour: 30.4,
            first_cut_end: "Fc54.4,-39.9",
            first_escape: "Fe55.4,-39.4",
        },
        // Inside, towards the chuck.
        Case {
            start: (20.0, 2.0),
            bottom: 50.0,
            end: (20.0, -40.0),
            allowance: (-0.4, 0.1),
            moved: (19.6, 2.1),
            levels: [25.6, 31.6, 37.6, 43.6],
            contour: 49.6,
            first_cut_end: "Fc25.6,-39.9",
            first_escape: "Fe24.6,-39.4",
        },
        // Outside, away from the chuck.
        Case {
            start: (60.0, -42.0),
            bottom: 30.0,
            end: (60.0, 0.0),
            allowance: (0.4, -0.1),
            moved: (60.4, -42.1),
            levels: [54.4, 48.4, 42.4, 36.4],
            contour: 30.4,
            first_cut_end: "Fc54.4,-0.1",
            first_escape: "Fe55.4,-0.6",
        },
        // Inside, away from the chuck.
        Case {
            start: (20.0, -42.0),
            bottom: 50.0,
            end: (20.0, 0.0),
            allowance: (-0.4, -0.1),
            moved: (19.6, -42.1),
            levels: [25.6, 31.6, 37.6, 43.6],
            contour: 49.6,
            first_cut_end: "Fc25.6,-0.1",
            first_escape: "Fe24.6,-0.6",
        },
    ];
    for case in cases {
        let elements = [
            ('R', case.bottom, case.start.1, 0.0),
            ('F', case.bottom, case.end.1, 0.0),
            ('F', case.end.0, case.end.1, 0.0),
        ];
        let request = rough_request(CutAlong::Z, case.start, 3.0, case.allowance);
        let shape = figure(case.start, &elements);
        assert_eq!(start_inside_fault(&shape, CutAlong::Z, request.allowance_x, request.allowance_z), None);
        let cycle = rough(shape, request).expect("a cycle");
        let moves: Vec<_> = cycle.collect();
        let words: Vec<_> = moves.iter().map(|step| told(step).1).collect();
        assert_eq!(moves[0].action.end_point(), Some(at(case.moved.0, case.moved.1)));
        let infeeds: Vec<_> = moves
            .iter()
            .filter(|step| step.phase == Phase::Infeed)
            .filter_map(|step| step.action.end_point())
            .collect();
        let mut expected: Vec<_> = case.levels.iter().map(|&level| at(level, case.moved.1)).collect();
        expected.push(at(case.contour, case.moved.1));
        assert_eq!(infeeds, expected);
        assert_eq!((words[2].as_str(), words[3].as_str()), (case.first_cut_end, case.first_escape));
    }
}

/// Rough turning of the shaft O4008: levels at 2 mm, the fourth exactly on a cylinder.
const TWO_POCKETS: &[(u32, &str)] = &[
    (0, "Ra60.4,2"),
    (1, "Ri54.4,2 Fc54.4,-59.25 Fe56.4,-60 Fe60.4,-60 Re61.4,-60"),
    (2, "Rr61.4,2 Ri48.4,2 Fc48.4,-19 Fe50.4,-20 Re55.4,-20"),
    (3, "Rr55.4,2 Ri42.4,2 Fc42.4,-16 Fe48.4,-19 Re49.4,-19"),
    (4, "Rr49.4,2 Ri36.4,2 Fc36.4,-13 Fe42.4,-16 Re43.4,-16"),
    (5, "Rr55.4,-16 Rr55.4,-20 Fi50.4,-20 Fi48.4,-21 Fc48.4,-40.6667 Fe52.4,-42 Re55.4,-42"),
    (6, "Rr55.4,-21 Fi48.4,-21 Fi42.4,-24 Fc42.4,-38.6667 Fe48.4,-40.6667 Re49.4,-40.6667"),
    (7, "Rr49.4,-24 Fi42.4,-24 Fi36.4,-27 Fc36.4,-36.6667 Fe42.4,-38.6667 Re43.4,-38.6667"),
    (8, "Rr55.4,-38.6667 Rr55.4,-42 Fi52.4,-42 Fi48.4,-44 Fc48.4,-57 Fe54.4,-59.25 Re55.4,-59.25"),
    (9, "Rr55.4,-44 Fi48.4,-44 Fi42.4,-47 Fc42.4,-54.75 Fe48.4,-57 Re49.4,-57"),
    (10, "Rr60.4,-57 Rr60.4,2 Ri30.4,2 Fk30.4,-10 Fk50.4,-20 Fk34.4,-28 Fk34.4,-36 Fk52.4,-42"),
    (10, "Fk40.4,-48 Fk40.4,-54 Fk56.4,-60 Fk60.4,-60 Rh60,2"),
];

const SHAFT: &[(u32, &str)] = &[
    (0, "Ra46.3,0.6"),
    (1, "Fi42.3,0.6 Fc42.3,-44.9 Fe43.3,-44.4 Rr43.3,0.6"),
    (2, "Fi38.3,0.6 Fc38.3,-44.9 Fe39.3,-44.4 Rr39.3,0.6"),
    (3, "Fi34.3,0.6 Fc34.3,-44.7284 Fe35.3,-44.2284 Rr35.3,0.6"),
    (4, "Fi30.3,0.6 Fc30.3,-41.9 Fe31.3,-41.4 Rr31.3,0.6"),
    (5, "Fi26.3,0.6 Fc26.3,-25.9 Fe27.3,-25.4 Rr27.3,0.6"),
    (6, "Fi22.3,0.6 Fc22.3,-21.9 Fe23.3,-21.4 Rr23.3,0.6"),
    (7, "Fi18.3,0.6 Fc18.3,-17.9 Fe19.3,-17.4 Rr19.3,0.6"),
    (
        8,
        "Fi15.3,0.6 Fk15.3,0.1 Fk15.3,-14.9 Fk30.3,-29.9 Fk30.3,-41.9 Wk36.3,-44.9 Fk46.3,-44.9 \
         Rh46,0.5",
    ),
];

/// Rough facing of O4009, a figure that begins and ends at rapid traverse.
const FLANGE: &[(u32, &str)] = &[
    (0, "Ra61.1,0.8"),
    (1, "Ri61.1,-1.2 Fc27.2414,-1.2 Fe28.2414,-0.7 Rr61.1,-0.7"),
    (2, "Ri61.1,-3.2 Fc29.6394,-3.2 Fe30.6394,-2.7 Rr61.1,-2.7"),
    (3, "Ri61.1,-5.2 Fc30.1,-5.2 Fe31.1,-4.7 Rr61.1,-4.7"),
    (4, "Ri61.1,-7.2 Fc30.1,-7.2 Fe31.1,-6.7 Rr61.1,-6.7"),
    (5, "Ri61.1,-9.2 Fc30.1,-9.2 Fe31.1,-8.7 Rr61.1,-8.7"),
    (6, "Ri61.1,-11.2 Fc33.1,-11.2 Fe34.1,-10.7 Rr61.1,-10.7"),
    (7, "Ri61.1,-13.2 Fc37.1,-13.2 Fe38.1,-12.7 Rr61.1,-12.7"),
    (8, "Ri61.1,-14.7 Fk40.1,-14.7 Fk30.1,-9.7 Fk30.1,-4.7 Wk20.1,0.3 Fk20.1,0.8 Rh61,0.5"),
];

/// Rough facing of O0005.
const STEPPED_FACE: &[(u32, &str)] = &[
    (0, "Ra176.2,10.1"),
    (1, "Ri176.2,8.1 Fc40.2,8.1 Fe41.2,8.6 Rr176.2,8.6"),
    (2, "Ri176.2,6.1 Fc40.2,6.1 Fe41.2,6.6 Rr176.2,6.6"),
    (3, "Ri176.2,4.1 Fc40.2,4.1 Fe41.2,4.6 Rr176.2,4.6"),
    (4, "Ri176.2,2.1 Fc40.2,2.1 Fe41.2,2.6 Rr176.2,2.6"),
    (5, "Ri176.2,0.1 Fc40.2,0.1 Fe41.2,0.6 Rr176.2,0.6"),
    (6, "Ri176.2,-1.9 Fc44.2,-1.9 Fe45.2,-1.4 Rr176.2,-1.4"),
    (7, "Ri176.2,-3.9 Fc48.2,-3.9 Fe49.2,-3.4 Rr176.2,-3.4"),
    (8, "Ri176.2,-5.9 Fc52.2,-5.9 Fe53.2,-5.4 Rr176.2,-5.4"),
    (9, "Ri176.2,-7.9 Fc56.2,-7.9 Fe57.2,-7.4 Rr176.2,-7.4"),
    (10, "Ri176.2,-9.9 Fc60.2,-9.9 Fe61.2,-9.4 Rr176.2,-9.4"),
    (11, "Ri176.2,-11.9 Fc64.2,-11.9 Fe65.2,-11.4 Rr176.2,-11.4"),
    (12, "Ri176.2,-13.9 Fc68.2,-13.9 Fe69.2,-13.4 Rr176.2,-13.4"),
    (13, "Ri176.2,-15.9 Fc72.2,-15.9 Fe73.2,-15.4 Rr176.2,-15.4"),
    (14, "Ri176.2,-17.9 Fc76.2,-17.9 Fe77.2,-17.4 Rr176.2,-17.4"),
    (15, "Ri176.2,-19.9 Fc80.2,-19.9 Fe81.2,-19.4 Rr176.2,-19.4"),
    (16, "Ri176.2,-21.9 Fc80.2,-21.9 Fe81.2,-21.4 Rr176.2,-21.4"),
    (17, "Ri176.2,-23.9 Fc80.2,-23.9 Fe81.2,-23.4 Rr176.2,-23.4"),
    (18, "Ri176.2,-25.9 Fc80.2,-25.9 Fe81.2,-25.4 Rr176.2,-25.4"),
    (19, "Ri176.2,-27.9 Fc80.2,-27.9 Fe81.2,-27.4 Rr176.2,-27.4"),
    (20, "Ri176.2,-29.9 Fc80.2,-29.9 Fe81.2,-29.4 Rr176.2,-29.4"),
    (21, "Ri176.2,-31.9 Fc80.2,-31.9 Fe81.2,-31.4 Rr176.2,-31.4"),
    (22, "Ri176.2,-33.9 Fc80.2,-33.9 Fe81.2,-33.4 Rr176.2,-33.4"),
    (23, "Ri176.2,-35.9 Fc84.2,-35.9 Fe85.2,-35.4 Rr176.2,-35.4"),
    (24, "Ri176.2,-37.9 Fc92.2,-37.9 Fe93.2,-37.4 Rr176.2,-37.4"),
    (25, "Ri176.2,-39.9 Fc100.2,-39.9 Fe101.2,-39.4 Rr176.2,-39.4"),
    (26, "Ri176.2,-41.9 Fc108.2,-41.9 Fe109.2,-41.4 Rr176.2,-41.4"),
    (27, "Ri176.2,-43.9 Fc116.2,-43.9 Fe117.2,-43.4 Rr176.2,-43.4"),
    (28, "Ri176.2,-45.9 Fc124.2,-45.9 Fe125.2,-45.4 Rr176.2,-45.4"),
    (29, "Ri176.2,-47.9 Fc132.2,-47.9 Fe133.2,-47.4 Rr176.2,-47.4"),
    (30, "Ri176.2,-49.9 Fc140.2,-49.9 Fe141.2,-49.4 Rr176.2,-49.4"),
    (31, "Ri176.2,-51.9 Fc148.2,-51.9 Fe149.2,-51.4 Rr176.2,-51.4"),
    (32, "Ri176.2,-53.9 Fc156.2,-53.9 Fe157.2,-53.4 Rr176.2,-53.4"),
    (33, "Ri176.2,-54.9 Fk160.2,-54.9 Fk80.2,-34.9 Fk80.2,-19.9 Fk40.2,0.1 Rh176,10"),
];

/// Pattern repeating of the forging O4010.
const FORGING: &[(u32, &str)] = &[
    (
        1,
        "Ra120.4,13.1 Rc60.4,4.1 Fc60.4,-6.9 Fc70.4,-11.9 Fc70.4,-21.9 Wc90.4,-31.9 Fc100.4,-36.9 \
         Rc120.4,13.1",
    ),
    (
        2,
        "Rs115.4,11.6 Rc55.4,2.6 Fc55.4,-8.4 Fc65.4,-13.4 Fc65.4,-23.4 Wc85.4,-33.4 Fc95.4,-38.4 \
         Rc115.4,11.6",
    ),
    (
        3,
        "Rs110.4,10.1 Rc50.4,1.1 Fc50.4,-9.9 Fc60.4,-14.9 Fc60.4,-24.9 Wc80.4,-34.9 Fc90.4,-39.9 \
         Rc110.4,10.1 Rh110,10",
    ),
];

/// Pattern repeating of the hollow 4-11.
const HOLLOW: &[(u32, &str)] = &[
    (1, "Ra58.4,-10 Fc38.4,-10 Wc38.4,-30 Rc58.4,-10"),
    (2, "Rs54.4,-10 Fc34.4,-10 Wc34.4,-30 Rc54.4,-10"),
    (3, "Rs50.4,-10 Fc30.4,-10 Wc30.4,-30 Rc50.4,-10 Rh50,-10"),
];

/// Radial grooving O0008 with the peck read as a diameter: first column.
const SLOT_FINE_FIRST: &[(u32, &str)] = &[(
    1,
    "Fp119,-24 Rb120,-24 Fp113,-24 Rb114,-24 Fp107,-24 Rb108,-24 Fp101,-24 Rb102,-24 Fp95,-24 \
         Rb96,-24 Fp89,-24 Rb90,-24 Fp83,-24 Rb84,-24 Fp77,-24 Rb78,-24 Fp71,-24 Rb72,-24 \
         Fp65,-24 Rb66,-24 Fp59,-24 Rb60,-24 Fp53,-24 Rb54,-24 Fp47,-24 Rb48,-24 Fp41,-24 \
         Rb42,-24 Fp40,-24 Ro125,-24",
)];

/// The same: last column.
const SLOT_FINE_LAST: &[(u32, &str)] = &[(
    10,
    "Rs125,-50 Fp119,-50 Rb120,-50 Fp113,-50 Rb114,-50 Fp107,-50 Rb108,-50 Fp101,-50 \
         Rb102,-50 Fp95,-50 Rb96,-50 Fp89,-50 Rb90,-50 Fp83,-50 Rb84,-50 Fp77,-50 Rb78,-50 \
         Fp71,-50 Rb72,-50 Fp65,-50 Rb66,-50 Fp59,-50 Rb60,-50 Fp53,-50 Rb54,-50 Fp47,-50 \
         Rb48,-50 Fp41,-50 Rb42,-50 Fp40,-50 Ro125,-50 Rh125,-24",
)];

/// Radial grooving O0008 with the peck read as a radius: first column.
const SLOT_COARSE_FIRST: &[(u32, &str)] = &[(
    1,
    "Fp113,-20 Rb114,-20 Fp101,-20 Rb102,-20 Fp89,-20 Rb90,-20 Fp77,-20 Rb78,-20 Fp65,-20 \
         Rb66,-20 Fp53,-20 Rb54,-20 Fp41,-20 Rb42,-20 Fp40,-20 Ro125,-20",
)];

/// The same: last column.
const SLOT_COARSE_LAST: &[(u32, &str)] = &[(
    11,
    "Rs125,-50 Fp113,-50 Rb114,-50 Fp101,-50 Rb102,-50 Fp89,-50 Rb90,-50 Fp77,-50 Rb78,-50 \
         Fp65,-50 Rb66,-50 Fp53,-50 Rb54,-50 Fp41,-50 Rb42,-50 Fp40,-50 Ro125,-50 Rh125,-20",
)];

/// Pecked drilling from Z2 to Z-20.
const DRILL: &[(u32, &str)] =
    &[(1, "Fp0,-3 Rb0,-2 Fp0,-8 Rb0,-7 Fp0,-13 Rb0,-12 Fp0,-18 Rb0,-17 Fp0,-20 Ro0,2")];

/// Thread M20 x 2 in nine roughing and two finishing passes.
const SCREW: &[(u32, &str)] = &[
    (1, "Ri19.2,4.7691 Tt19.2,-20 Ro25,-20 Rh25,5"),
    (2, "Ri18.8686,4.6734 Tt18.8686,-20 Ro25,-20 Rh25,5"),
    (3, "Ri18.6144,4.6 Tt18.6144,-20 Ro25,-20 Rh25,5"),
    (4, "Ri18.4,4.5381 Tt18.4,-20 Ro25,-20 Rh25,5"),
    (5, "Ri18.2,4.4804 Tt18.2,-20 Ro25,-20 Rh25,5"),
    (6, "Ri18,4.4226 Tt18,-20 Ro25,-20 Rh25,5"),
    (7, "Ri17.8,4.3649 Tt17.8,-20 Ro25,-20 Rh25,5"),
    (8, "Ri17.6,4.3072 Tt17.6,-20 Ro25,-20 Rh25,5"),
    (9, "Ri17.5,4.2783 Tt17.5,-20 Ro25,-20 Rh25,5"),
    (10, "Ri17.4,4.2494 Tt17.4,-20 Ro25,-20 Rh25,5"),
    (11, "Ri17.4,4.2494 Tt17.4,-20 Ro25,-20 Rh25,5"),
];
