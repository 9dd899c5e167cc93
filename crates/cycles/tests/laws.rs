//! Laws that hold for every request: nothing enters the work, no level is too deep, mirrors and shifts of the request
//! are mirrors and shifts of the moves, depths of threads rise to the height, and nothing panics or runs away.
//!
//! Random, but seeded: every run sees the same thousands of cases.

use turnwright_canon::{Action, Phase, RapidPath, Shape, Turn};
use turnwright_cycles::{
    BottomEscape, BoxRequest, Clamp, Coincident, Context, CutAlong, CycleMove, DepthLaw, Element,
    EscapeSpeed, Figure, FigureMotion, FirstAxis, FlankInfeed, GrooveRequest, Hump, LevelOrigin, Misuse,
    Monotony, MonotonyFault, PatternRequest, PeckAxis, PlaneAxis, PocketRequest, ReliefDirection,
    RoughRequest, SinglePass, ThreadOnceRequest, ThreadRequest, Tolerance, box_cycle, depth_schedule, groove,
    hump_before_end, monotony_fault, pattern, rough, rough_pockets, start_inside_fault, taper_crosses_start,
    thread, thread_once, turn_back_fault,
};
use turnwright_dice::Dice;
use turnwright_units::{
    Angle, Feed, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, WorkTip,
};

const DEPTH_LAWS: [DepthLaw; 3] =
    [DepthLaw::EqualArea(Clamp::Accumulate), DepthLaw::EqualArea(Clamp::Formula), DepthLaw::EqualSteps];

const INFEEDS: [FlankInfeed; 5] = [
    FlankInfeed::Centre,
    FlankInfeed::WithCut,
    FlankInfeed::AgainstCut,
    FlankInfeed::BothFlanks,
    FlankInfeed::FlankAndCentre,
];

const UNIT: LeastIncrement = LeastIncrement::METRIC_B;
/// Canonical figures are in thousandths of a millimetre.
const STEP_NM: i64 = 1_000;

/// An element seen from A: depth `h` into the work, way `w` along the cut, thousandths.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    from: (i64, i64),
    to: (i64, i64),
    /// Centre, and whether it turns counter-clockwise with w to the right and h up.
    arc: Option<((i64, i64), bool)>,
}

impl Stroke {
    /// Depth of the surface at `w`, when the stroke passes there; the deeper end of a wall.
    fn depth_at(&self, w: f64) -> Option<f64> {
        let (w0, w1) = (self.from.1 as f64, self.to.1 as f64);
        if w < w0 || w > w1 {
            return None;
        }
        let (h0, h1) = (self.from.0 as f64, self.to.0 as f64);
        if w0 == w1 {
            return Some(h0.max(h1));
        }
        let Some((centre, _)) = self.arc else {
            return Some(h0 + (h1 - h0) * (w - w0) / (w1 - w0));
        };
        let (ch, cw) = (centre.0 as f64, centre.1 as f64);
        let radius = (h0 - ch).hypot(w0 - cw);
        let rise = (radius * radius - (w - cw) * (w - cw)).max(0.0).sqrt();
        Some(if (h0 + h1) / 2.0 > ch { ch + rise } else { ch - rise })
    }
}

/// A figure in the four quadrants and two axes of the plane.
#[derive(Clone, Copy, Debug)]
struct Setting {
    along: CutAlong,
    /// A as (u, v), thousandths.
    origin: (i64, i64),
    su: i64,
    sv: i64,
}

impl Setting {
    fn place(&self, (h, w): (i64, i64)) -> Position<WorkTip> {
        let (u, v) = (self.origin.0 + self.su * h, self.origin.1 + self.sv * w);
        let (x, z) = if self.along == CutAlong::Z { (u, v) } else { (v, u) };
        Position::new(Radius(Length::from_nm(x * STEP_NM)), Length::from_nm(z * STEP_NM))
    }

    /// A place seen from `start`, as (h, w) in thousandths.
    fn seen(&self, place: Position<WorkTip>, start: Position<WorkTip>) -> (f64, f64) {
        let way = place - start;
        let (x, z) = (way.x.0.nm() as f64 / STEP_NM as f64, way.z.nm() as f64 / STEP_NM as f64);
        let (u, v) = if self.along == CutAlong::Z { (x, z) } else { (z, x) };
        (u * self.su as f64, v * self.sv as f64)
    }

    fn figure(&self, bottom: i64, approach: FigureMotion, strokes: &[Stroke]) -> Figure {
        let mut elements = vec![Element { to: self.place((bottom, 0)), motion: approach, line: 0 }];
        for stroke in strokes {
            let motion = stroke.arc.map_or(FigureMotion::Line, |(centre, counter_clockwise)| {
                let turned = (self.along == CutAlong::Z) == (self.su * self.sv > 0);
                let turn = if counter_clockwise == turned { Turn::CounterClockwise } else { Turn::Clockwise };
                FigureMotion::Arc { turn, centre: self.place(centre) }
            });
            elements.push(Element { to: self.place(stroke.to), motion, line: 0 });
        }
        Figure { start: self.place((0, 0)), elements }
    }
}

fn setting(dice: &mut Dice) -> Setting {
    Setting {
        along: *dice.pick(&[CutAlong::Z, CutAlong::X]),
        origin: (dice.whole(-80_000, 80_000), dice.whole(-80_000, 80_000)),
        su: *dice.pick(&[-1, 1]),
        sv: *dice.pick(&[-1, 1]),
    }
}

/// A contour that only rises; with `pockets` some strokes go down again.
fn strokes(dice: &mut Dice, bottom: i64, pockets: bool) -> Vec<Stroke> {
    let mut at = (bottom, 0);
    let mut out = Vec::new();
    for _ in 0..dice.whole(1, 9) {
        let stroke = stroke(dice, at, pockets);
        if stroke.to.0 < 0 || stroke.to == stroke.from {
            continue;
        }
        at = stroke.to;
        out.push(stroke);
    }
    if out.iter().all(|stroke| stroke.to.1 == stroke.from.1) {
        out.push(Stroke { from: at, to: (at.0, at.1 + 5_000), arc: None });
    }
    out
}

fn stroke(dice: &mut Dice, at: (i64, i64), pockets: bool) -> Stroke {
    let (h, w) = at;
    let size = dice.whole(1, 900);
    let line = |to| Stroke { from: at, to, arc: None };
    match dice.whole(0, if pockets { 6 } else { 5 }) {
        0 => line((h, w + 10 * size)),
        1 => line((h - 5 * size, w)),
        2 => line((h - dice.whole(1, 9) * size, w + dice.whole(1, 9) * size)),
        // Upright first, then flat; and the other way round.
        3 => Stroke { from: at, to: (h - 5 * size, w + 5 * size), arc: Some(((h, w + 5 * size), false)) },
        4 => Stroke { from: at, to: (h - 5 * size, w + 5 * size), arc: Some(((h - 5 * size, w), false)) },
        // A piece of a circle that ends on whole numbers: 3, 4, 5.
        5 => Stroke { from: at, to: (h - size, w + 3 * size), arc: Some(((h - 5 * size, w), false)) },
        _ => line((h + dice.whole(0, 5) * size, w + dice.whole(0, 5) * size)),
    }
    .turned()
}

impl Stroke {
    /// Decides the turn from the places: the short way round.
    fn turned(mut self) -> Self {
        if let Some((centre, _)) = self.arc {
            let (a, b) = (
                (self.from.1 - centre.1, self.from.0 - centre.0),
                (self.to.1 - centre.1, self.to.0 - centre.0),
            );
            self.arc = Some((centre, a.0 * b.1 - a.1 * b.0 > 0));
        }
        self
    }
}

fn context(start: Position<WorkTip>) -> Context {
    Context {
        start,
        increment: UNIT,
        feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000))),
        rapid: RapidPath::EachAxis,
    }
}

fn thousandths(count: i64) -> Length {
    Length::from_nm(count * STEP_NM)
}

fn rough_request(dice: &mut Dice, setting: &Setting) -> RoughRequest {
    let (au, av) = (dice.whole(-300, 900), dice.whole(-300, 300));
    let (x, z) = if setting.along == CutAlong::Z { (-setting.su * au, av) } else { (av, -setting.su * au) };
    RoughRequest {
        context: context(setting.place((0, 0))),
        along: setting.along,
        depth: thousandths(dice.whole(50, 4_000)),
        escape: thousandths(dice.whole(0, 800)),
        allowance_x: Radius(thousandths(x)),
        allowance_z: thousandths(z),
        coincident: *dice.pick(&[Coincident::Through, Coincident::Stop]),
        level_origin: LevelOrigin::ShiftedStart,
        escape_speed: *dice.pick(&[EscapeSpeed::Feed, EscapeSpeed::Rapid]),
        semi_finish: dice.percent(80),
        monotony: Monotony::Ignore,
    }
}

/// The deepest that a tip may go at `w`, half an increment of rounding granted each way.
fn floor_at(strokes: &[Stroke], w: f64) -> f64 {
    if w <= 1.0 {
        // In front of the contour there is nothing to hit.
        return f64::INFINITY;
    }
    let reach =
        |w: f64| strokes.iter().filter_map(|stroke| stroke.depth_at(w)).fold(f64::NEG_INFINITY, f64::max);
    [w - 1.0, w, w + 1.0].into_iter().map(reach).fold(f64::NEG_INFINITY, f64::max) + 1.0
}

fn assert_outside(strokes: &[Stroke], from: (f64, f64), to: (f64, f64), step: &CycleMove) {
    let end = strokes.last().expect("a contour").to.1 as f64;
    for part in 0..=24 {
        let share = f64::from(part) / 24.0;
        let (h, w) = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
        assert!(w <= end + 1.0, "beyond the end of the figure: {step:?}");
        assert!(h <= floor_at(strokes, w), "{h} > {} at {w}: {step:?} {strokes:?}", floor_at(strokes, w));
    }
}

#[test]
fn roughing_never_enters_the_work_and_never_takes_more_than_the_depth() {
    let mut dice = Dice::new(0x9E37_79B9_7F4A_7C15);
    let mut cuts = 0;
    for case in 0..4_000 {
        let setting = setting(&mut dice);
        let bottom = dice.whole(500, 30_000);
        let strokes = strokes(&mut dice, bottom, case % 2 == 1);
        let approach = *dice.pick(&[FigureMotion::Rapid, FigureMotion::Line]);
        let request = rough_request(&mut dice, &setting);
        let cycle = rough(setting.figure(bottom, approach, &strokes), request).expect("a cycle");
        let estimate = cycle.move_estimate();
        let moved = moved_start(&request);
        let (mut at, mut level, mut count) = (request.context.start, 0.0, 0);
        for step in cycle {
            let to = step.action.end_point().expect("a move");
            let (from_seen, to_seen) = (setting.seen(at, moved), setting.seen(to, moved));
            let arc = matches!(&step.action, Action::Feed { shape: Shape::Arc { .. }, .. });
            if !arc && !matches!(step.phase, Phase::Approach | Phase::Home) {
                assert_outside(&strokes, from_seen, to_seen, &step);
            }
            if step.phase == Phase::Infeed {
                let rapid = matches!(&step.action, Action::Rapid { .. });
                assert_eq!(rapid, approach == FigureMotion::Rapid && !goes_on_down(&strokes));
                assert!(to_seen.0 - level <= request.depth.nm() as f64 / STEP_NM as f64 + 1e-6, "{step:?}");
                level = to_seen.0;
            }
            if step.phase == Phase::Cut {
                assert_cut_reaches(&strokes, to_seen, request.coincident);
                cuts += 1;
            }
            at = to;
            count += 1;
        }
        assert!(count <= estimate, "{count} moves, {estimate} announced");
        assert_eq!(at, request.context.start);
    }
    assert!(cuts > 20_000, "{cuts} cuts looked at");
}

/// The approach takes in what goes straight on down, and is rapid only when all of it is.
fn goes_on_down(strokes: &[Stroke]) -> bool {
    strokes[0].to.1 == 0 && strokes[0].to.0 > strokes[0].from.0
}

fn moved_start(request: &RoughRequest) -> Position<WorkTip> {
    let start = request.context.start;
    Position::new(start.x + request.allowance_x, start.z + request.allowance_z)
}

/// Behind the end of a cut the figure is in the way, or it is at an end.
fn assert_cut_reaches(strokes: &[Stroke], (h, w): (f64, f64), coincident: Coincident) {
    let end = strokes.last().expect("a contour").to.1 as f64;
    let behind = w + 2.0;
    if behind >= end {
        return;
    }
    let corners = strokes.iter().flat_map(|stroke| [stroke.from, stroke.to]);
    // Corners too: a wall of no thickness stops the tool as well.
    let corners = corners.filter(|corner| (corner.1 as f64 - w).abs() <= 2.0).map(|corner| corner.0 as f64);
    let surface = strokes
        .iter()
        .filter_map(|stroke| stroke.depth_at(behind))
        .chain(corners)
        .fold(f64::INFINITY, f64::min);
    let slack = if coincident == Coincident::Stop { 1.0 } else { 1e-6 };
    // A stretch within half an increment below the level counts as the level itself.
    assert!(surface < h + slack, "cut ended at {w}, depth {h}, but the surface is at {surface}: {strokes:?}");
}

#[test]
fn only_pockets_are_found_not_monotone() {
    let mut dice = Dice::new(77);
    for _ in 0..3_000 {
        let setting = setting(&mut dice);
        let bottom = dice.whole(500, 30_000);
        let mut strokes = strokes(&mut dice, bottom, false);
        let figure = setting.figure(bottom, FigureMotion::Rapid, &strokes);
        assert_eq!(monotony_fault(&figure, setting.along, Tolerance::EXACT), None, "{figure:?}");
        let outward = -setting.su;
        let (x, z) = if setting.along == CutAlong::Z { (outward, 0) } else { (0, outward) };
        assert_eq!(start_inside_fault(&figure, setting.along, Radius(thousandths(x)), thousandths(z)), None);
        // One step down at the end is one fault, on the depth axis, in the last element.
        let end = strokes.last().expect("a contour").to;
        strokes.push(Stroke { from: end, to: (end.0 + 10, end.1 + 10), arc: None });
        let pocket = setting.figure(bottom, FigureMotion::Rapid, &strokes);
        let axis = if setting.along == CutAlong::Z { PlaneAxis::Second } else { PlaneAxis::First };
        let fault = MonotonyFault { axis, element: strokes.len() as u32 };
        assert_eq!(monotony_fault(&pocket, setting.along, Tolerance::EXACT), Some(fault), "{pocket:?}");
        assert_eq!(monotony_fault(&pocket, setting.along, Tolerance::both(thousandths(10))), None);
        let checked = RoughRequest {
            monotony: Monotony::Check { tolerance: Tolerance::EXACT },
            ..rough_request(&mut dice, &setting)
        };
        assert_eq!(rough(pocket, checked).map(|_| ()), Err(Misuse::NotMonotone(fault)));
    }
}

/// The same place on the other side of the spindle axis.
fn mirrored(place: Position<WorkTip>) -> Position<WorkTip> {
    Position::new(-place.x, place.z)
}

fn along_z(place: Position<WorkTip>, way: Length) -> Position<WorkTip> {
    Position::new(place.x, place.z + way)
}

/// Every place of a figure changed by `change`; `flip` turns arcs the other way.
fn changed(figure: &Figure, flip: bool, change: impl Fn(Position<WorkTip>) -> Position<WorkTip>) -> Figure {
    let motion = |motion| match motion {
        FigureMotion::Arc { turn, centre } => {
            let turn = match (turn, flip) {
                (Turn::Clockwise, true) => Turn::CounterClockwise,
                (Turn::CounterClockwise, true) => Turn::Clockwise,
                (turn, false) => turn,
            };
            FigureMotion::Arc { turn, centre: change(centre) }
        }
        other => other,
    };
    let elements = figure.elements.iter();
    let elements =
        elements.map(|element| Element { to: change(element.to), motion: motion(element.motion), line: 0 });
    Figure { start: change(figure.start), elements: elements.collect() }
}

/// The same moves with the places changed, to within one increment of rounding.
fn assert_same_but(
    a: &[CycleMove],
    b: &[CycleMove],
    change: impl Fn(Position<WorkTip>) -> Position<WorkTip>,
) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((a.phase, a.pass, a.element), (b.phase, b.pass, b.element));
        let (to, other) =
            (change(a.action.end_point().expect("a move")), b.action.end_point().expect("a move"));
        let off = to - other;
        assert!(off.x.0.abs().nm() * 2 <= UNIT.nm() && off.z.abs().nm() <= UNIT.nm(), "{a:?} {b:?}");
    }
}

#[test]
fn mirrored_and_shifted_requests_give_mirrored_and_shifted_moves() {
    let mut dice = Dice::new(4_711);
    for _ in 0..1_500 {
        let setting = setting(&mut dice);
        let bottom = dice.whole(500, 30_000);
        let strokes = strokes(&mut dice, bottom, true);
        let figure = setting.figure(bottom, FigureMotion::Rapid, &strokes);
        let request = rough_request(&mut dice, &setting);
        let moves: Vec<_> = rough(figure.clone(), request).expect("a cycle").collect();

        let other_side = RoughRequest {
            context: context(mirrored(request.context.start)),
            allowance_x: -request.allowance_x,
            ..request
        };
        let mirror: Vec<_> = rough(changed(&figure, true, mirrored), other_side).expect("a cycle").collect();
        assert_same_but(&moves, &mirror, mirrored);
        let ends =
            |moves: &[CycleMove]| moves.iter().filter_map(|step| step.action.end_point()).collect::<Vec<_>>();
        let exact: Vec<_> = ends(&moves).into_iter().map(mirrored).collect();
        assert_eq!(exact, ends(&mirror), "a mirror rounds the same way");

        let way = thousandths(dice.whole(-200_000, 200_000));
        let further = RoughRequest { context: context(along_z(request.context.start, way)), ..request };
        let shifted = changed(&figure, false, |place| along_z(place, way));
        let shift: Vec<_> = rough(shifted, further).expect("a cycle").collect();
        assert_same_but(&moves, &shift, |place| along_z(place, way));
    }
}

#[test]
fn the_pattern_keeps_its_shape_and_divides_its_relief() {
    let mut dice = Dice::new(31);
    for _ in 0..1_000 {
        let setting = setting(&mut dice);
        let bottom = dice.whole(500, 30_000);
        let strokes = strokes(&mut dice, bottom, true);
        let figure = setting.figure(bottom, FigureMotion::Rapid, &strokes);
        let request = PatternRequest {
            context: context(figure.start),
            relief_x: Radius(thousandths(dice.whole(-5_000, 5_000))),
            relief_z: thousandths(dice.whole(-5_000, 5_000)),
            passes: dice.whole(1, 9) as u32,
            allowance_x: Radius(thousandths(dice.whole(-500, 500))),
            allowance_z: thousandths(dice.whole(-500, 500)),
            single_pass: SinglePass::Once,
        };
        let cycle = pattern(figure.clone(), request).expect("a cycle");
        assert!(cycle.clone().count() as u64 <= cycle.move_estimate());
        for step in cycle.filter(|step| step.phase == Phase::Cut) {
            let element = figure.elements[step.element.expect("an element") as usize];
            let off = step.action.end_point().expect("a move") - element.to;
            let left = f64::from(request.passes - step.pass) / f64::from((request.passes - 1).max(1));
            let x = request.allowance_x.to_mm() + request.relief_x.to_mm() * left;
            let z = request.allowance_z.to_mm() + request.relief_z.to_mm() * left;
            assert!((off.x.to_mm() - x).abs() <= 0.000_25 + 1e-9, "{off:?} {x}");
            assert!((off.z.to_mm() - z).abs() <= 0.000_5 + 1e-9, "{off:?} {z}");
            if let (
                Action::Feed { shape: Shape::Arc { centre, .. }, .. },
                FigureMotion::Arc { centre: old, .. },
            ) = (&step.action, element.motion)
            {
                assert_eq!(*centre - old, off, "arcs are moved bodily");
            }
        }
    }
}

#[test]
fn grooves_reach_the_bottom_of_every_column_in_small_bites() {
    let mut dice = Dice::new(5);
    for _ in 0..2_000 {
        let start =
            Position::new(Radius(thousandths(dice.whole(1, 40_000))), thousandths(dice.whole(-9_000, 9_000)));
        let end = Position::new(
            Radius(thousandths(dice.whole(-40_000, 40_000))),
            thousandths(dice.whole(-9_000, 9_000)),
        );
        let request = GrooveRequest {
            context: context(start),
            peck_axis: *dice.pick(&[PeckAxis::X, PeckAxis::Z]),
            end,
            peck: Some(thousandths(dice.whole(300, 5_000))),
            step: Some(thousandths(dice.whole(300, 5_000))),
            retract: thousandths(dice.whole(0, 400)),
            relief: thousandths(dice.whole(0, 300)),
            relief_direction: ReliefDirection::BySign,
        };
        let along = |place: Position<WorkTip>| match request.peck_axis {
            PeckAxis::X => (place.x.0.nm(), place.z.nm()),
            PeckAxis::Z => (place.z.nm(), place.x.0.nm()),
        };
        let cycle = groove(request).expect("a groove");
        let estimate = cycle.move_estimate();
        let (mut at, mut deepest, mut count, mut column) = (start, 0, 0, 0);
        let (mut side, mut bottoms) = (along(start).1, 0);
        for step in cycle {
            let to = step.action.end_point().expect("a move");
            if step.pass != column {
                (column, deepest) = (step.pass, 0);
            }
            match step.phase {
                Phase::Peck => {
                    let depth = (along(to).0 - along(start).0).abs();
                    assert!(depth - deepest <= request.peck.expect("a peck").nm(), "{step:?}");
                    deepest = depth;
                    bottoms += i64::from(along(to).0 == along(end).0);
                    assert_eq!(along(to).1, along(at).1);
                }
                Phase::Shift => {
                    assert!((along(to).1 - side).abs() <= request.step.expect("a step").nm(), "{step:?}");
                    side = along(to).1;
                }
                _ => {}
            }
            at = to;
            count += 1;
        }
        assert!(count <= estimate && at == start);
        let span = (along(end).1 - along(start).1).abs();
        let columns =
            1 + (span + request.step.expect("a step").nm() - 1) / request.step.expect("a step").nm();
        if along(end).0 != along(start).0 {
            assert_eq!((bottoms, i64::from(column), side), (columns, columns, along(end).1));
        }
    }
}

#[test]
fn thread_depths_rise_to_the_height_and_areas_shrink() {
    let mut dice = Dice::new(99);
    for _ in 0..10_000 {
        let height = dice.whole(200, 4_000);
        let first = dice.whole(20, 900);
        let least = dice.whole(0, height.min(300));
        let allowance = dice.whole(0, height / 4);
        let finishing = dice.whole(1, 5) as u32;
        let law = *dice.pick(&DEPTH_LAWS);
        let r = |count| Radius(thousandths(count));
        let schedule =
            depth_schedule(r(height), r(first), r(least), r(allowance), finishing, law).expect("depths");
        let estimate = schedule.pass_estimate();
        let depths: Vec<f64> = schedule.collect();
        assert!(depths.len() as u64 <= estimate, "{} passes, {estimate} announced", depths.len());
        assert!(depths.windows(2).all(|pair| pair[0] <= pair[1]));
        let steps: f64 = depths.windows(2).map(|pair| pair[1] - pair[0]).sum::<f64>() + depths[0];
        assert!((steps - height as f64 / 1e3).abs() < 1e-9);
        let rough = &depths[..depths.len() - finishing as usize];
        assert!((rough.last().expect("a pass") - (height - allowance) as f64 / 1e3).abs() < 1e-9);
        assert!(depths[rough.len()..].iter().all(|depth| (depth - height as f64 / 1e3).abs() < 1e-9));
        let (first, least) = (first as f64 / 1e3, least as f64 / 1e3);
        assert!((rough[0] - first).abs() < 1e-9 || rough.len() == 1);
        assert_steps_obey(law, &rough[..rough.len() - 1], first, least);
    }
}

/// The steps of all roughing depths but the last, which the allowance cuts short.
fn assert_steps_obey(law: DepthLaw, depths: &[f64], first: f64, least: f64) {
    let steps: Vec<f64> = depths.windows(2).map(|pair| pair[1] - pair[0]).collect();
    match law {
        DepthLaw::EqualSteps => assert!(steps.iter().all(|step| (step - first).abs() < 1e-9)),
        DepthLaw::EqualArea(Clamp::Accumulate) => {
            assert!(steps.iter().all(|step| *step >= least - 1e-9));
            // Once as small as the least depth, steps stay so.
            let clamped = steps.iter().position(|step| (step - least).abs() < 1e-9);
            assert!(steps[clamped.unwrap_or(steps.len())..].iter().all(|step| (step - least).abs() < 1e-9));
            assert!(steps.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9));
        }
        DepthLaw::EqualArea(Clamp::Formula) => {
            for (place, depth) in depths.iter().enumerate().skip(1) {
                let by_area = |count: usize| first * (count as f64).sqrt();
                assert!((depth - by_area(place + 1).max(by_area(place) + least)).abs() < 1e-9);
            }
        }
    }
}

fn thread_request(dice: &mut Dice) -> ThreadRequest {
    let inside = dice.percent(50);
    let (root, start_x) = if inside { (20_000, 16_000) } else { (17_400, 25_000) };
    let sign = *dice.pick(&[-1, 1]);
    let start = Position::new(Radius(thousandths(start_x)), thousandths(sign * 5_000));
    ThreadRequest {
        context: context(start),
        end: Position::new(Radius(thousandths(root)), thousandths(-sign * dice.whole(0, 20_000))),
        taper: Radius::ZERO,
        height: Radius(thousandths(1_300)),
        first_depth: Radius(thousandths(dice.whole(50, 400))),
        min_depth: Radius(thousandths(dice.whole(0, 100))),
        finishing_allowance: Radius(thousandths(50)),
        finishing_passes: 2,
        run_out: thousandths(dice.whole(0, 20_000)),
        run_out_angle_deg: dice.whole(0, 80) as u8,
        run_out_depth: None,
        pull_out_feed: None,
        nose_angle_deg: *dice.pick(&[0, 29, 55, 60, 90]),
        lead: Lead(thousandths(2_000)),
        start_angle: Angle::ZERO,
        starts: dice.whole(0, 3) as u32,
        depths: *dice.pick(&DEPTH_LAWS),
        infeed: *dice.pick(&INFEEDS),
    }
}

#[test]
fn threads_stay_between_root_and_start() {
    let mut dice = Dice::new(123);
    for _ in 0..4_000 {
        let request = thread_request(&mut dice);
        let (start, end) = (request.context.start, request.end);
        let cycle = thread(request).expect("a thread");
        assert!(cycle.clone().count() as u64 <= cycle.move_estimate());
        let (low_x, high_x) = (start.x.min(end.x), start.x.max(end.x));
        // Down the flank against the cut a pass begins behind the start point.
        let behind =
            if request.infeed == FlankInfeed::AgainstCut { thousandths(1_300) } else { Length::ZERO };
        let (low_z, high_z) = match start.z < end.z {
            true => (start.z - behind, end.z),
            false => (end.z, start.z + behind),
        };
        for step in cycle {
            let to = step.action.end_point().expect("a move");
            assert!((low_x..=high_x).contains(&to.x) && (low_z..=high_z).contains(&to.z), "{step:?}");
            if step.phase == Phase::Out {
                assert_eq!((to.x, to.z), (start.x, end.z));
            }
        }
    }
}

/// Every pass at full height takes the same way, whichever flank the passes before it went down.
#[test]
fn finishing_passes_follow_one_path() {
    let mut dice = Dice::new(77);
    for _ in 0..2_000 {
        let request = ThreadRequest { finishing_passes: 4, ..thread_request(&mut dice) };
        let starts = request.starts.max(1) as usize;
        let begins: Vec<_> = thread(request)
            .expect("a thread")
            .filter(|step| step.phase == Phase::Infeed)
            .filter_map(|step| step.action.end_point())
            .collect();
        let finishing = &begins[begins.len() - 4 * starts..];
        assert!(finishing.iter().all(|begin| *begin == finishing[0]), "{request:?}");
    }
}

/// Numbers that break things.
fn wild(dice: &mut Dice) -> i64 {
    let special = [
        0,
        1,
        -1,
        2,
        249,
        250,
        499,
        500,
        -500,
        1_000,
        1_000_000,
        -1_000_000,
        10_000_000,
        999_999_999_999_999,
        1_000_000_000_000_000,
        -1_000_000_000_000_000,
        1_000_000_000_000_001,
        i64::MAX,
        i64::MIN,
        i64::MAX - 1,
        i64::MAX / 2,
    ];
    if dice.percent(60) { *dice.pick(&special) } else { (dice.roll() as i64) >> dice.whole(0, 63) }
}

/// Now and then something ordinary, so that not every request is refused at once.
fn word(dice: &mut Dice) -> Length {
    let tame = dice.percent(70);
    Length::from_nm(if tame { dice.whole(-40, 40) * 500_000 } else { wild(dice) })
}

fn mostly_positive(dice: &mut Dice) -> Length {
    let length = word(dice);
    if dice.percent(90) { length.abs() } else { length }
}

fn wild_place(dice: &mut Dice) -> Position<WorkTip> {
    Position::new(Radius(word(dice)), word(dice))
}

fn wild_figure(dice: &mut Dice, start: Position<WorkTip>) -> Figure {
    let mut elements = Vec::new();
    for _ in 0..dice.whole(0, 6) {
        let motion = match dice.whole(0, 3) {
            0 => FigureMotion::Rapid,
            1 => FigureMotion::Line,
            2 => FigureMotion::Arc { turn: Turn::Clockwise, centre: wild_place(dice) },
            _ => FigureMotion::Arc { turn: Turn::CounterClockwise, centre: wild_place(dice) },
        };
        let to = elements.last().map_or(start, |element: &Element| element.to);
        let to = if dice.percent(15) { to } else { wild_place(dice) };
        elements.push(Element { to, motion, line: 0 });
    }
    Figure { start, elements }
}

fn wild_context(dice: &mut Dice) -> Context {
    let all =
        [LeastIncrement::METRIC_A, LeastIncrement::METRIC_C, LeastIncrement::INCH_B, LeastIncrement::INCH_C];
    Context { increment: *dice.pick(&all), ..context(wild_place(dice)) }
}

/// Runs a cycle for a while: never more moves than announced, none without length, and it ends where it began.
fn run(
    cycle: Result<impl Iterator<Item = CycleMove>, Misuse>,
    estimate: u64,
    start: Position<WorkTip>,
) -> bool {
    let Ok(cycle) = cycle else { return false };
    let (mut at, mut count) = (start, 0);
    for step in cycle.take(3_000) {
        let to = step.action.end_point().expect("a move");
        let arc = matches!(&step.action, Action::Feed { shape: Shape::Arc { .. }, .. });
        assert!(arc || to != at, "a move of no length: {step:?}");
        at = to;
        count += 1;
    }
    assert!(count <= estimate, "{count} moves, {estimate} announced");
    if count < 3_000 {
        assert_eq!(at, start);
    }
    true
}

#[test]
fn no_roughing_request_panics_or_runs_away() {
    let mut dice = Dice::new(0xDEAD_BEEF);
    let (mut accepted, mut with_pockets) = (0, 0);
    for _ in 0..60_000 {
        let context = wild_context(&mut dice);
        let figure = wild_figure(&mut dice, context.start);
        let along = *dice.pick(&[CutAlong::Z, CutAlong::X]);
        let request = RoughRequest {
            context,
            along,
            depth: word(&mut dice),
            escape: word(&mut dice),
            allowance_x: Radius(word(&mut dice)),
            allowance_z: word(&mut dice),
            coincident: *dice.pick(&[Coincident::Through, Coincident::Stop]),
            level_origin: *dice.pick(&[LevelOrigin::ShiftedStart, LevelOrigin::Start]),
            escape_speed: EscapeSpeed::Feed,
            semi_finish: dice.percent(50),
            monotony: if dice.percent(20) {
                Monotony::Check { tolerance: Tolerance::both(word(&mut dice)) }
            } else {
                Monotony::Ignore
            },
        };
        let _ = monotony_fault(&figure, along, Tolerance::both(word(&mut dice)));
        let _ = start_inside_fault(&figure, along, request.allowance_x, request.allowance_z);
        let cycle = rough(figure.clone(), request);
        let estimate = cycle.as_ref().map_or(0, |cycle| cycle.move_estimate());
        accepted += i32::from(run(cycle, estimate, context.start));
        let _ = turn_back_fault(&figure, along, Tolerance::both(word(&mut dice)));
        let _ = hump_before_end(&figure, along, Tolerance::both(word(&mut dice)));
        let request = PocketRequest {
            rough: request,
            tolerance: Tolerance::both(word(&mut dice)),
            clearance: word(&mut dice),
            hump: *dice.pick(&[Hump::AlongContour, Hump::ExtraLevel]),
            bottom_escape: *dice.pick(&[BottomEscape::Follow, BottomEscape::Diagonal]),
            lift_speed: EscapeSpeed::Rapid,
        };
        let cycle = rough_pockets(figure, request);
        let estimate = cycle.as_ref().map_or(0, |cycle| cycle.move_estimate());
        with_pockets += i32::from(run(cycle, estimate, context.start));
    }
    assert!(accepted > 1_000 && with_pockets > 1_000, "{accepted} and {with_pockets} accepted");
}

#[test]
fn no_pattern_or_groove_panics_or_runs_away() {
    let mut dice = Dice::new(0xC0FFEE);
    let mut accepted = (0, 0);
    for _ in 0..40_000 {
        let context = wild_context(&mut dice);
        let request = PatternRequest {
            context,
            relief_x: Radius(word(&mut dice)),
            relief_z: word(&mut dice),
            passes: if dice.percent(80) { dice.whole(0, 5) as u32 } else { wild(&mut dice) as u32 },
            allowance_x: Radius(word(&mut dice)),
            allowance_z: word(&mut dice),
            single_pass: *dice.pick(&[SinglePass::Once, SinglePass::Twice]),
        };
        let cycle = pattern(wild_figure(&mut dice, context.start), request);
        let estimate = cycle.as_ref().map_or(0, |cycle| cycle.move_estimate());
        accepted.0 += i32::from(run(cycle, estimate, context.start));

        let request = GrooveRequest {
            context,
            peck_axis: *dice.pick(&[PeckAxis::X, PeckAxis::Z]),
            end: wild_place(&mut dice),
            peck: dice.percent(80).then(|| word(&mut dice)),
            step: dice.percent(80).then(|| word(&mut dice)),
            retract: word(&mut dice),
            relief: word(&mut dice),
            relief_direction: *dice.pick(&[
                ReliefDirection::AgainstShift,
                ReliefDirection::AlwaysPlus,
                ReliefDirection::BySign,
            ]),
        };
        let cycle = groove(request);
        let estimate = cycle.as_ref().map_or(0, |cycle| cycle.move_estimate());
        accepted.1 += i32::from(run(cycle, estimate, context.start));
    }
    assert!(accepted.0 > 1_000 && accepted.1 > 1_000, "{accepted:?} accepted");
}

#[test]
fn no_thread_or_box_panics_or_runs_away() {
    let mut dice = Dice::new(0xB01D_FACE);
    let mut accepted = (0, 0);
    for _ in 0..60_000 {
        let context = wild_context(&mut dice);
        let end = wild_place(&mut dice);
        let taper = word(&mut dice);
        let request = ThreadRequest {
            context,
            end,
            taper: Radius(taper),
            height: Radius(mostly_positive(&mut dice)),
            first_depth: Radius(mostly_positive(&mut dice)),
            min_depth: Radius(mostly_positive(&mut dice)),
            finishing_allowance: Radius(mostly_positive(&mut dice)),
            finishing_passes: if dice.percent(80) { 2 } else { wild(&mut dice) as u32 },
            run_out: mostly_positive(&mut dice),
            run_out_angle_deg: dice.whole(0, 100) as u8,
            run_out_depth: dice.percent(20).then(|| mostly_positive(&mut dice)),
            pull_out_feed: None,
            nose_angle_deg: dice.whole(0, 190) as u8,
            lead: Lead(mostly_positive(&mut dice)),
            start_angle: Angle::from_millidegrees(wild(&mut dice)),
            starts: if dice.percent(80) { 1 } else { wild(&mut dice) as u32 },
            depths: *dice.pick(&DEPTH_LAWS),
            infeed: *dice.pick(&INFEEDS),
        };
        let cycle = thread(request);
        let estimate = cycle.as_ref().map_or(0, |cycle| cycle.move_estimate());
        accepted.0 += i32::from(run(cycle, estimate, context.start));

        let ThreadRequest { run_out, run_out_angle_deg, lead, start_angle, .. } = request;
        let taper = Radius(taper);
        let once = ThreadOnceRequest {
            context,
            along: CutAlong::Z,
            end,
            taper: taper.0,
            lead,
            start_angle,
            starts: 1,
            run_out,
            run_out_angle_deg,
            run_out_depth: None,
            pull_out_feed: None,
            run_in: None,
        };
        accepted.1 += i32::from(run(thread_once(once), 5, context.start));
        let first = *dice.pick(&[FirstAxis::X, FirstAxis::Z]);
        let _ = taper_crosses_start(first, context.start, end, taper.0);
        run(box_cycle(BoxRequest { context, first, end, taper: taper.0 }), 4, context.start);
    }
    assert!(accepted.0 > 1_000 && accepted.1 > 1_000, "{accepted:?} accepted");
}
