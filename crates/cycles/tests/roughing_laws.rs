//! Laws of roughing, with and without pockets, checked against a bar that knows nothing of cycles: the bar is cut into
//! thin slices, each remembers how deep the tip has been in it. No move enters the figure, no feed takes more than
//! the depth of cut, no rapid meets what was not cut before, and behind the last pass nothing but the figure stands.
//!
//! Random, but seeded: every run sees the same figures.

use turnwright_canon::{Action, Phase, RapidPath, Shape, Turn};
use turnwright_cycles::{
    BottomEscape, Coincident, Context, CutAlong, CycleMove, Element, EscapeSpeed, Figure, FigureMotion, Hump,
    LevelOrigin, Misuse, Monotony, PocketRequest, RoughRequest, Tolerance, hump_before_end, monotony_fault,
    rough, rough_and_semi_finish, rough_pockets, rough_pockets_and_semi_finish, turn_back_fault,
};
use turnwright_dice::Dice;
use turnwright_units::{Feed, FeedPerRevolution, LeastIncrement, Length, Position, Radius, WorkTip};

/// Figures are in thousandths of a millimetre.
const STEP_NM: i64 = 1_000;
/// Neighbours of a slice, thousandths: places are rounded to half of that.
const NEAR: f64 = 2.0;

/// A stroke of the contour seen from A: depth `h` into the work, way `w` along the cut, thousandths.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    from: (i64, i64),
    to: (i64, i64),
    /// Centre, and whether the arc is the deep side of its circle.
    arc: Option<((i64, i64), bool)>,
}

impl Stroke {
    /// Depth at `w`, when the stroke passes there slanting.
    fn depth_at(&self, w: f64) -> Option<f64> {
        let (w0, w1) = (self.from.1 as f64, self.to.1 as f64);
        if w0 == w1 || w < w0 || w > w1 {
            return None;
        }
        let (h0, h1) = (self.from.0 as f64, self.to.0 as f64);
        let Some((centre, is_deep)) = self.arc else {
            return Some(h0 + (h1 - h0) * (w - w0) / (w1 - w0));
        };
        let (ch, cw) = (centre.0 as f64, centre.1 as f64);
        let square = (h0 - ch).powi(2) + (w0 - cw).powi(2) - (w - cw).powi(2);
        let rise = square.max(0.0).sqrt();
        Some(if is_deep { ch + rise } else { ch - rise })
    }
}

/// A contour that goes on along the cut all the time; with `pockets` it also goes down.
fn strokes(dice: &mut Dice, mut at: (i64, i64), pockets: bool) -> Vec<Stroke> {
    let mut out = Vec::new();
    for _ in 0..dice.whole(1, 8) {
        let stroke = stroke(dice, at, pockets);
        let is_in_range = (-300..40_000).contains(&stroke.to.0);
        if stroke.to != stroke.from && is_in_range {
            at = stroke.to;
            out.push(stroke);
        }
    }
    if out.iter().all(|stroke| stroke.to.1 == stroke.from.1) {
        out.push(Stroke { from: at, to: (at.0, at.1 + 5_000), arc: None });
    }
    if dice.percent(60) && at.0 > 0 {
        let from = out.last().map_or(at, |stroke| stroke.to);
        out.push(Stroke { from, to: (0, from.1), arc: None });
    }
    out
}

fn stroke(dice: &mut Dice, (h, w): (i64, i64), pockets: bool) -> Stroke {
    let size = dice.whole(1, 900);
    let (a, b) = (dice.whole(1, 9) * size, dice.whole(1, 9) * size);
    let line = |to| Stroke { from: (h, w), to, arc: None };
    let arc = |to, centre, is_deep| Stroke { from: (h, w), to, arc: Some((centre, is_deep)) };
    let r = 5 * size;
    match dice.whole(0, if pockets { 14 } else { 5 }) {
        0 => line((h, w + 10 * size)),
        1 => line((h - r, w)),
        2 => line((h - a, w + b)),
        // Quarters of a circle upwards: upright first, then flat; and the other way round.
        3 => arc((h - r, w + r), (h, w + r), false),
        4 => arc((h - r, w + r), (h - r, w), true),
        // A piece of a circle that ends on whole numbers: 3, 4, 5.
        5 => arc((h - size, w + 3 * size), (h - r, w), true),
        6 | 7 => line((h + a, w + b)),
        8 => line((h + r, w)),
        9 => arc((h + r, w + r), (h, w + r), true),
        10 => arc((h + r, w + r), (h + r, w), false),
        // Dips and humps: flat ones, 3, 4, 5 again, and half circles.
        11 => arc((h, w + 6 * size), (h - 4 * size, w + 3 * size), true),
        12 => arc((h, w + 6 * size), (h + 4 * size, w + 3 * size), false),
        13 => arc((h, w + 2 * r), (h, w + r), true),
        _ => arc((h, w + 2 * r), (h, w + r), false),
    }
}

/// How the tool comes to the contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Approach {
    /// Straight down beside it, at rapid or at feed.
    Open { is_rapid: bool },
    /// Over it at rapid, at the height of the start point.
    Over,
    /// The contour begins at the start point.
    Touching,
}

/// A figure in one of the quadrants of the plane, and its contour.
#[derive(Clone, Debug)]
struct Case {
    along: CutAlong,
    /// A as (u, v), thousandths.
    origin: (i64, i64),
    su: i64,
    sv: i64,
    approach: Approach,
    strokes: Vec<Stroke>,
}

impl Case {
    fn new(dice: &mut Dice, pockets: bool) -> Self {
        loop {
            let case = Self::any(dice, pockets);
            let (least, greatest) = case.reach();
            if greatest > -2.0 * least {
                // Otherwise nobody could say which way is down.
                return case;
            }
        }
    }

    /// The least and the greatest depth of the contour.
    fn reach(&self) -> (f64, f64) {
        let ends = self.strokes.iter().flat_map(|stroke| [stroke.from.0 as f64, stroke.to.0 as f64]);
        let middles = self.strokes.iter().filter_map(|stroke| {
            stroke.depth_at(stroke.arc.map_or(stroke.from.1, |(centre, _)| centre.1) as f64)
        });
        ends.chain(middles).fold((0.0, 0.0), |(least, greatest), h| (h.min(least), h.max(greatest)))
    }

    fn any(dice: &mut Dice, pockets: bool) -> Self {
        let approach = match dice.whole(0, if pockets { 3 } else { 0 }) {
            2 => Approach::Over,
            3 => Approach::Touching,
            _ => Approach::Open { is_rapid: dice.percent(50) },
        };
        let strokes = match approach {
            Approach::Open { .. } => {
                let bottom = dice.whole(500, 30_000);
                strokes(dice, (bottom, 0), pockets)
            }
            Approach::Over => {
                let begin = dice.whole(10, 9_000);
                strokes(dice, (0, begin), pockets)
            }
            Approach::Touching => {
                // The first stroke slants, or it would be the approach.
                let first =
                    Stroke { from: (0, 0), to: (dice.whole(1, 9_000), dice.whole(1, 9_000)), arc: None };
                let mut all = vec![first];
                all.extend(strokes(dice, first.to, pockets));
                all
            }
        };
        Self {
            along: *dice.pick(&[CutAlong::Z, CutAlong::X]),
            origin: (dice.whole(-80_000, 80_000), dice.whole(-80_000, 80_000)),
            su: *dice.pick(&[-1, 1]),
            sv: *dice.pick(&[-1, 1]),
            approach,
            strokes,
        }
    }

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

    fn figure(&self) -> Figure {
        let element = |to, motion| Element { to: self.place(to), motion, line: 0 };
        let begin = self.strokes[0].from;
        let mut elements = match self.approach {
            Approach::Open { is_rapid: false } => vec![element(begin, FigureMotion::Line)],
            Approach::Open { is_rapid: true } | Approach::Over => vec![element(begin, FigureMotion::Rapid)],
            Approach::Touching => Vec::new(),
        };
        let is_turned = (self.along == CutAlong::Z) == (self.su * self.sv > 0);
        for stroke in &self.strokes {
            let motion = stroke.arc.map_or(FigureMotion::Line, |(centre, is_deep)| {
                // Seen with w to the right and h up, the upper side of a circle is passed clockwise.
                let turn = if is_deep == is_turned { Turn::Clockwise } else { Turn::CounterClockwise };
                FigureMotion::Arc { turn, centre: self.place(centre) }
            });
            elements.push(element(stroke.to, motion));
        }
        Figure { start: self.place((0, 0)), elements }
    }

    fn request(&self, dice: &mut Dice) -> PocketRequest {
        let deepest = self.strokes.iter().map(|stroke| stroke.from.0.max(stroke.to.0)).max().unwrap_or(0);
        // Now and then a level meets a flat of the figure.
        let flats = self.strokes.iter().filter(|stroke| stroke.from.0 == stroke.to.0 && stroke.from.0 > 0);
        let flat = flats.map(|stroke| stroke.from.0 / dice.whole(1, 6)).next_back();
        let depth = match flat {
            Some(flat) if dice.percent(40) => flat.max(deepest / 40 + 1),
            _ => dice.whole(50, 4_000).max(deepest / 20),
        };
        // Allowances lead away from the work.
        let (au, av) = (dice.whole(0, 900), -dice.whole(0, 300));
        let (au, av) = (-self.su * au, self.sv * av);
        let (x, z) = if self.along == CutAlong::Z { (au, av) } else { (av, au) };
        let rough = RoughRequest {
            context: context(self.place((0, 0))),
            along: self.along,
            depth: thousandths(depth),
            escape: thousandths(if dice.percent(80) { dice.whole(0, 800) } else { dice.whole(0, 8_000) }),
            allowance_x: Radius(thousandths(x)),
            allowance_z: thousandths(z),
            coincident: *dice.pick(&[Coincident::Through, Coincident::Stop]),
            level_origin: LevelOrigin::ShiftedStart,
            escape_speed: *dice.pick(&[EscapeSpeed::Feed, EscapeSpeed::Rapid]),
            semi_finish: dice.percent(80),
            monotony: Monotony::Ignore,
        };
        PocketRequest {
            rough,
            tolerance: Tolerance::EXACT,
            clearance: thousandths(*dice.pick(&[0, 0, 200, 1_000])),
            hump: *dice.pick(&[Hump::AlongContour, Hump::ExtraLevel]),
            bottom_escape: *dice.pick(&[BottomEscape::Follow, BottomEscape::Diagonal]),
            lift_speed: *dice.pick(&[EscapeSpeed::Feed, EscapeSpeed::Rapid]),
        }
    }
}

fn context(start: Position<WorkTip>) -> Context {
    Context {
        start,
        increment: LeastIncrement::METRIC_B,
        feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000))),
        rapid: RapidPath::EachAxis,
    }
}

fn thousandths(count: i64) -> Length {
    Length::from_nm(count * STEP_NM)
}

/// One thin slice of the bar.
#[derive(Clone, Copy, Debug)]
struct Slice {
    w: f64,
    /// The figure there, and the deepest it is near by.
    figure: f64,
    deepest_near: f64,
    /// How deep the tip has been.
    cut: f64,
}

/// The bar in front of the tool: it begins at the start point and has its height there.
struct Bar<'a> {
    case: &'a Case,
    /// Always three neighbours, [`NEAR`] apart.
    slices: Vec<Slice>,
}

impl<'a> Bar<'a> {
    /// `start` is A, seen from A′.
    fn new(case: &'a Case, start: (f64, f64), dice: &mut Dice) -> Self {
        let mut slices = Vec::new();
        let depth = |w: f64| {
            let depths = case.strokes.iter().filter_map(|stroke| stroke.depth_at(w));
            // In front of a contour that begins further on stands nothing but the bar.
            depths.fold(None, |least: Option<f64>, depth| Some(least.map_or(depth, |other| other.min(depth))))
        };
        for stroke in &case.strokes {
            for _ in 0..4 {
                let (low, high) =
                    ((stroke.from.1 as f64).max(start.1) + 2.0 * NEAR, stroke.to.1 as f64 - 2.0 * NEAR);
                if high <= low {
                    break;
                }
                let w = low + (high - low) * dice.whole(0, 1_000) as f64 / 1e3;
                for w in [w - NEAR, w, w + NEAR] {
                    let figure = depth(w).expect("within the contour");
                    let near = [w - NEAR, w, w + NEAR].map(|w| stroke.depth_at(w));
                    let deepest_near = near.into_iter().flatten().fold(f64::MIN, f64::max);
                    slices.push(Slice { w, figure, deepest_near, cut: figure.min(start.0) });
                }
            }
        }
        Self { case, slices }
    }

    /// Moves the tip; says what is wrong with it.
    fn go(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        step: &CycleMove,
        depth_max: f64,
        granted: f64,
    ) -> Result<(), String> {
        let (low, high) = (from.1.min(to.1), from.1.max(to.1));
        let is_rapid = matches!(step.action, Action::Rapid { .. });
        for triple in self.slices.chunks_exact_mut(3) {
            let cut_before = triple.iter().map(|slice| slice.cut).fold(f64::MIN, f64::max);
            for slice in triple.iter_mut().filter(|slice| (low..=high).contains(&slice.w)) {
                let depth = depth_on(self.case, from, to, step, slice.w);
                if depth > slice.deepest_near + granted + 1.0 {
                    return Err(format!("enters the figure at {slice:?}: {depth}"));
                }
                if is_rapid && depth > cut_before + granted + 1.0 {
                    return Err(format!("rapid through what stands at {slice:?}: {depth}"));
                }
                if !is_rapid && depth - cut_before > depth_max + 1.0 {
                    return Err(format!("takes {} at {slice:?}", depth - cut_before));
                }
                slice.cut = slice.cut.max(depth);
            }
        }
        Ok(())
    }

    /// The most that stands above the figure.
    fn left(&self) -> f64 {
        let left = |triple: &[Slice]| {
            let [a, b, c] = [0, 1, 2].map(|index| triple[index].figure - triple[index].cut);
            a.min(b).min(c)
        };
        self.slices.chunks_exact(3).map(left).fold(0.0, f64::max)
    }
}

/// Depth of the tip at `w` on its way.
fn depth_on(case: &Case, from: (f64, f64), to: (f64, f64), step: &CycleMove, w: f64) -> f64 {
    if let Action::Feed { shape: Shape::Arc { turn, centre }, .. } = &step.action {
        let end = step.action.end_point().expect("a move");
        let (dh, dw) = case.seen(*centre, end);
        let (ch, cw) = (to.0 + dh, to.1 + dw);
        let radius = dh.hypot(dw);
        let rise = (radius * radius - (w - cw) * (w - cw)).max(0.0).sqrt();
        let is_turned = (case.along == CutAlong::Z) == (case.su * case.sv > 0);
        let is_clockwise = (*turn == Turn::Clockwise) == is_turned;
        let is_deep = is_clockwise == (to.1 > from.1);
        return if is_deep { ch + rise } else { ch - rise };
    }
    if from.1 == to.1 {
        return from.0.max(to.0);
    }
    from.0 + (to.0 - from.0) * (w - from.1) / (to.1 - from.1)
}

/// Runs a cycle through the bar and checks each move of it.
fn check(
    case: &Case,
    request: &PocketRequest,
    moves: impl Iterator<Item = CycleMove>,
    estimate: u64,
    dice: &mut Dice,
) -> usize {
    let rough = &request.rough;
    let start = rough.context.start;
    let moved = Position::new(start.x + rough.allowance_x, start.z + rough.allowance_z);
    // Warnings tell of figures that stand in the way home.
    let ends_low = hump_before_end(&case.figure(), case.along, Tolerance::EXACT).is_some();
    let is_home_free = !ends_low && case.reach().0 >= 0.0;
    let depth_max = rough.depth.nm() as f64 / STEP_NM as f64;
    let mut bar = Bar::new(case, case.seen(start, moved), dice);
    let (mut at, mut count, mut cuts) = (start, 0, 0);
    for step in moves {
        let to = step.action.end_point().expect("a move");
        let (from_seen, to_seen) = (case.seen(at, moved), case.seen(to, moved));
        assert_arc_closes(at, to, &step);
        let is_checked = match step.phase {
            Phase::Approach => false,
            Phase::Home => is_home_free,
            _ => true,
        };
        // The way home ends at A itself, which may lie within the allowance.
        let granted = if step.phase == Phase::Home { to_seen.0 } else { 0.0 };
        if is_checked && let Err(fault) = bar.go(from_seen, to_seen, &step, depth_max, granted) {
            panic!("{fault}\n{step:?}\n{from_seen:?} to {to_seen:?}\n{case:?}\n{request:?}");
        }
        cuts += usize::from(step.phase == Phase::Cut);
        at = to;
        count += 1;
    }
    assert_eq!(at, start);
    assert!(count <= estimate, "{count} moves, {estimate} announced");
    let left_max = if rough.semi_finish { 1.0 } else { depth_max + 1.0 };
    assert!(bar.left() <= left_max, "{} is left\n{case:?}\n{request:?}", bar.left());
    cuts
}

/// Both ends of an arc lie on one circle.
fn assert_arc_closes(from: Position<WorkTip>, to: Position<WorkTip>, step: &CycleMove) {
    if let Action::Feed { shape: Shape::Arc { centre, .. }, .. } = &step.action {
        let reach = |place: Position<WorkTip>| {
            (place.x.to_mm() - centre.x.to_mm()).hypot(place.z.to_mm() - centre.z.to_mm())
        };
        assert!((reach(from) - reach(to)).abs() < 4e-6, "{step:?} from {from:?}");
    }
}

#[test]
fn roughing_with_pockets_leaves_the_figure_and_nothing_else() {
    let mut dice = Dice::new(0x9E37_79B9_7F4A_7C15);
    let mut cuts = 0;
    for _ in 0..10_000 {
        let case = Case::new(&mut dice, true);
        let request = case.request(&mut dice);
        let cycle = rough_pockets(case.figure(), request).expect("a cycle");
        let estimate = cycle.move_estimate();
        cuts += check(&case, &request, cycle, estimate, &mut dice);
    }
    assert!(cuts > 40_000, "{cuts} cuts looked at");
}

#[test]
fn roughing_without_pockets_leaves_the_figure_and_nothing_else() {
    let mut dice = Dice::new(0x0BAD_CAFE);
    for _ in 0..4_000 {
        let case = Case::new(&mut dice, false);
        let request = case.request(&mut dice);
        let cycle = rough(case.figure(), request.rough).expect("a cycle");
        let estimate = cycle.move_estimate();
        check(&case, &request, cycle, estimate, &mut dice);
    }
}

/// What roughing leaves for the pass that takes it off, away from the work: X, Z.
fn left_for_semi_finish(case: &Case, dice: &mut Dice) -> (Radius, Length) {
    let (u, v) = (-case.su * dice.whole(0, 700), -case.sv * dice.whole(0, 300));
    let (x, z) = if case.along == CutAlong::Z { (u, v) } else { (v, u) };
    (Radius(thousandths(x)), thousandths(z))
}

/// The first way home ends roughing; what follows is one pass along the figure, and nothing is left behind it but the
/// allowance. Before it no move comes nearer than what is left for it.
fn check_semi_finish(
    case: &Case,
    request: &PocketRequest,
    (leave_x, leave_z): (Radius, Length),
    moves: Vec<CycleMove>,
    alone: Vec<CycleMove>,
    dice: &mut Dice,
) {
    let homes = moves.iter().filter(|step| step.phase == Phase::Home).count();
    let roughing = moves.iter().position(|step| step.phase == Phase::Home).map_or(0, |home| home + 1);
    let (roughing, contour) = moves.split_at(roughing);
    let rough = RoughRequest {
        allowance_x: request.rough.allowance_x + leave_x,
        allowance_z: request.rough.allowance_z + leave_z,
        semi_finish: false,
        ..request.rough
    };
    let levels = PocketRequest { rough, ..*request };
    check(case, &levels, roughing.iter().cloned(), u64::MAX, dice);
    // The pass along the figure is that of roughing to the allowance alone.
    let along = |moves: &[CycleMove]| -> Vec<_> {
        let contour = moves.iter().filter(|step| step.phase == Phase::Contour);
        contour.map(|step| (step.action.clone(), step.element)).collect()
    };
    assert_eq!(along(contour), along(&alone), "{case:?} {request:?}");
    assert!(homes <= 2 && contour.iter().all(|step| step.phase != Phase::Cut), "{case:?} {request:?}");
    let last_rough = roughing.last().map_or(0, |step| step.pass);
    assert!(contour.iter().all(|step| step.pass >= last_rough), "passes are counted on");
}

#[test]
fn a_semi_finishing_pass_takes_off_what_roughing_has_left_for_it() {
    let mut dice = Dice::new(0x5E_ED_0F_1A_7E);
    for _ in 0..3_000 {
        let case = Case::new(&mut dice, false);
        let mut request = case.request(&mut dice);
        request.rough.semi_finish = true;
        let leave = left_for_semi_finish(&case, &mut dice);
        let moves = rough_and_semi_finish(case.figure(), request.rough, leave.0, leave.1).expect("a cycle");
        let alone = rough(case.figure(), request.rough).expect("a cycle");
        check_semi_finish(&case, &request, leave, moves.collect(), alone.collect(), &mut dice);
    }
}

#[test]
fn a_semi_finishing_pass_takes_off_what_roughing_of_pockets_has_left_for_it() {
    let mut dice = Dice::new(0x0C_0F_FE_E0);
    for _ in 0..5_000 {
        let case = Case::new(&mut dice, true);
        let mut request = case.request(&mut dice);
        request.rough.semi_finish = true;
        let leave = left_for_semi_finish(&case, &mut dice);
        let moves = rough_pockets_and_semi_finish(case.figure(), request, leave.0, leave.1).expect("a cycle");
        let alone = rough_pockets(case.figure(), request).expect("a cycle");
        check_semi_finish(&case, &request, leave, moves.collect(), alone.collect(), &mut dice);
    }
}

#[test]
fn without_pockets_both_types_cut_the_same_levels() {
    let mut dice = Dice::new(2_718_281_828);
    for _ in 0..2_000 {
        let case = Case::new(&mut dice, false);
        let request = case.request(&mut dice);
        let cuts = |moves: &mut dyn Iterator<Item = CycleMove>| -> Vec<_> {
            moves.filter(|step| step.phase == Phase::Cut).map(|step| (step.action, step.element)).collect()
        };
        let one = cuts(&mut rough(case.figure(), request.rough).expect("a cycle"));
        let two = cuts(&mut rough_pockets(case.figure(), request).expect("a cycle"));
        assert_eq!(one, two, "{case:?} {request:?}");
    }
}

#[test]
fn a_mirrored_or_shifted_figure_with_pockets_gives_mirrored_or_shifted_moves() {
    let mut dice = Dice::new(4_711);
    for _ in 0..1_500 {
        let case = Case::new(&mut dice, true);
        let request = case.request(&mut dice);
        let moves: Vec<_> = rough_pockets(case.figure(), request).expect("a cycle").collect();
        let seen = |case: &Case, request: &PocketRequest, moves: &[CycleMove]| -> Vec<_> {
            let start = request.rough.context.start;
            let seen = |step: &CycleMove| case.seen(step.action.end_point().expect("a move"), start);
            let mut moves: Vec<_> =
                moves.iter().map(|step| (seen(step), step.phase, step.pass, step.element)).collect();
            // A cut of one step may round to none on the other side.
            moves.dedup_by(|next, before| {
                let steps = (next.0.0 - before.0.0).abs().max((next.0.1 - before.0.1).abs());
                next.1 == Phase::Cut && steps <= 1.0
            });
            moves
        };
        let expected = seen(&case, &request, &moves);
        // The other way along the depth axis, along the cut, somewhere else.
        let other = Case {
            su: -case.su,
            sv: if dice.percent(50) { -case.sv } else { case.sv },
            origin: (case.origin.0 + dice.whole(-9_000, 9_000), dice.whole(-90_000, 90_000)),
            ..case.clone()
        };
        let (x, z) = (request.rough.allowance_x, request.rough.allowance_z);
        let turned = |length: Length, turns: bool| if turns { -length } else { length };
        let (turns_u, turns_v) = (true, other.sv != case.sv);
        let (turns_x, turns_z) =
            if case.along == CutAlong::Z { (turns_u, turns_v) } else { (turns_v, turns_u) };
        let other_request = PocketRequest {
            rough: RoughRequest {
                context: context(other.place((0, 0))),
                allowance_x: Radius(turned(x.0, turns_x)),
                allowance_z: turned(z, turns_z),
                ..request.rough
            },
            ..request
        };
        let other_moves: Vec<_> = rough_pockets(other.figure(), other_request).expect("a cycle").collect();
        let made = seen(&other, &other_request, &other_moves);
        assert_eq!(made.len(), expected.len(), "{case:?} {request:?}");
        for (made, expected) in made.iter().zip(&expected) {
            assert_eq!((made.1, made.2, made.3), (expected.1, expected.2, expected.3));
            let off = (made.0.0 - expected.0.0).abs().max((made.0.1 - expected.0.1).abs());
            assert!(off <= 1.0, "{made:?} {expected:?}");
        }
    }
}

#[test]
fn only_what_turns_back_along_the_cut_is_refused_with_pockets() {
    let mut dice = Dice::new(99);
    for _ in 0..1_000 {
        let mut case = Case::new(&mut dice, true);
        assert_eq!(turn_back_fault(&case.figure(), case.along, Tolerance::EXACT), None, "{case:?}");
        let end = case.strokes.last().expect("a contour").to;
        case.strokes.push(Stroke { from: end, to: (end.0 + 10, end.1 - 10), arc: None });
        let figure = case.figure();
        let fault = turn_back_fault(&figure, case.along, Tolerance::EXACT).expect("a fault");
        assert_eq!(fault.element as usize, figure.elements.len() - 1);
        assert_eq!(turn_back_fault(&figure, case.along, Tolerance::both(thousandths(10))), None);
        let request = case.request(&mut dice);
        let refused = rough_pockets(figure.clone(), request).map(|_| ());
        assert_eq!(refused, Err(Misuse::NotMonotone(fault)));
        let tolerant = PocketRequest { tolerance: Tolerance::both(thousandths(10)), ..request };
        assert!(rough_pockets(figure.clone(), tolerant).is_ok());
        assert!(monotony_fault(&figure, case.along, Tolerance::EXACT).is_some());
    }
}
