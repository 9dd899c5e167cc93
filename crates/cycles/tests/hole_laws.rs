//! Laws of holes: the feed takes everything between R point and bottom in bites, nothing is passed at rapid that no feed
//! has cut, a hole in the side is one in the face turned round, and nothing panics or runs away.
//!
//! Random, but seeded: every run sees the same thousands of cases.

use turnwright_canon::{Action, OtherAxes, Phase, RapidPath, SpindleSpeed, SpindleState};
use turnwright_cycles::{
    Clamping, Context, CycleMove, HoleRequest, HoleWork, Peck, PeckAxis, PeckRetract, Tap, hole,
};
use turnwright_dice::Dice;
use turnwright_units::{
    Angle, Feed, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, Rpm, Seconds, WorkTip,
};

const fn thousandths(count: i64) -> Length {
    Length::from_nm(count * 1_000)
}

fn spindle(state: SpindleState) -> Action {
    Action::Spindle { state, speed: SpindleSpeed::Constant(Rpm(500)), rpm_max: None }
}

fn work(dice: &mut Dice, peck: Option<Peck>) -> HoleWork {
    match dice.whole(0, 3) {
        0 | 1 => HoleWork::Drill(peck),
        2 => HoleWork::Bore(Feed::PerRevolution(FeedPerRevolution(thousandths(200)))),
        _ => HoleWork::Tap(Box::new(Tap {
            start: dice.percent(50).then(|| spindle(SpindleState::Clockwise)),
            stop: spindle(SpindleState::Stop),
            reverse: spindle(SpindleState::CounterClockwise),
            forward: spindle(SpindleState::Clockwise),
            restart: dice.percent(50).then(|| spindle(SpindleState::Clockwise)),
            lead: dice.percent(50).then(|| Lead(thousandths(1_000))),
            peck,
        })),
    }
}

/// A hole with lengths as `length` rolls them; `initial` is where the tool stands.
fn request(dice: &mut Dice, length: impl Fn(&mut Dice) -> Length) -> HoleRequest {
    let axis = if dice.percent(50) { PeckAxis::X } else { PeckAxis::Z };
    let start = Position::new(Radius(length(dice)), length(dice));
    let initial = if axis == PeckAxis::X { start.x.0 } else { start.z };
    let way = if dice.percent(50) { 1 } else { -1 };
    let signed = |length: Length| Length::from_nm(length.abs().nm() * way);
    let r_point = initial + signed(length(dice));
    let retract = if dice.percent(50) {
        PeckRetract::Short(length(dice).abs())
    } else {
        PeckRetract::Full(length(dice).abs())
    };
    let peck = dice.percent(70).then(|| Peck { depth: length(dice).abs(), retract });
    HoleRequest {
        context: Context {
            start,
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(thousandths(100))),
            rapid: RapidPath::EachAxis,
        },
        axis,
        place: length(dice),
        step: if dice.percent(50) { length(dice) } else { Length::ZERO },
        others: OtherAxes::default(),
        others_step: (Angle::ZERO, Length::ZERO),
        initial,
        r_point,
        bottom: r_point + signed(length(dice)),
        work: work(dice, peck),
        dwell: Seconds(if dice.percent(30) { 0.5 } else { 0.0 }),
        clamping: dice.percent(20).then_some(Clamping { on: 31, off: 32, dwell: Seconds(0.1) }),
        stays_at_r: dice.percent(30),
        repeats: dice.whole(1, 3) as u32,
    }
}

fn peck_of(request: &HoleRequest) -> Option<Peck> {
    match &request.work {
        HoleWork::Drill(peck) => *peck,
        HoleWork::Bore(_) => None,
        HoleWork::Tap(tap) => tap.peck,
    }
}

#[test]
fn holes_are_cut_in_bites_and_never_passed_at_rapid() {
    let mut dice = Dice::new(20_261_122);
    for _ in 0..10_000 {
        // Whole hundredths, so that nothing is rounded.
        let asked = request(&mut dice, |dice| thousandths(dice.whole(1, 3_000) * 10));
        let along = |place: Position<WorkTip>| match asked.axis {
            PeckAxis::X => (place.x.0.nm(), place.z.nm()),
            PeckAxis::Z => (place.z.nm(), place.x.0.nm()),
        };
        let (r, bottom) = (asked.r_point.nm(), asked.bottom.nm());
        let inward = (bottom - r).signum();
        let cycle = hole(asked.clone()).expect("a hole");
        let estimate = cycle.move_estimate();
        let (mut at, mut count, mut bottoms, mut pass) = (along(asked.context.start), 0, 0, 0);
        // Depth cut so far in this hole, from the R point.
        let mut deepest = 0;
        for step in cycle {
            count += 1;
            if step.pass != pass {
                (pass, deepest) = (step.pass, 0);
            }
            let Some(to) = step.action.end_point().map(along) else { continue };
            let depth = (to.0 - r) * inward;
            match step.action {
                Action::Rapid { .. } => assert!(depth <= deepest, "{step:?} in {asked:?}"),
                _ if depth > deepest => {
                    assert!((at.0 - r) * inward <= deepest, "fed from deeper than was cut: {step:?}");
                    if let Some(peck) = peck_of(&asked) {
                        assert!(depth - deepest <= peck.depth.nm(), "{step:?}");
                    }
                    deepest = depth;
                    bottoms += i32::from(to.0 == bottom);
                }
                _ => {}
            }
            // Sideways only above the R point, or on it.
            assert!(to.1 == at.1 || (to.0 == at.0 && depth <= 0), "{step:?}");
            at = to;
        }
        assert_eq!(bottoms, asked.repeats as i32);
        assert!(count <= estimate);
        assert_eq!(at.0, if asked.stays_at_r { r } else { asked.initial.nm() });
        assert_eq!(at.1, asked.place.nm() + i64::from(asked.repeats - 1) * asked.step.nm());
    }
}

/// What a step is for, where it ends as (along, across) when it moves, and its hole.
type Told = (Phase, Option<(i64, i64)>, u32);

fn told(asked: HoleRequest) -> Vec<Told> {
    let axis = asked.axis;
    let place = |step: &CycleMove| {
        step.action.end_point().map(|to| match axis {
            PeckAxis::X => (to.x.0.nm(), to.z.nm()),
            PeckAxis::Z => (to.z.nm(), to.x.0.nm()),
        })
    };
    hole(asked).expect("a hole").map(|step| (step.phase, place(&step), step.pass)).collect()
}

#[test]
fn a_hole_in_the_side_is_one_in_the_face_turned_round() {
    let mut dice = Dice::new(606_060);
    for _ in 0..5_000 {
        let asked = request(&mut dice, |dice| thousandths(dice.whole(1, 3_000) * 10));
        let start = asked.context.start;
        let turned = HoleRequest {
            axis: if asked.axis == PeckAxis::X { PeckAxis::Z } else { PeckAxis::X },
            context: Context { start: Position::new(Radius(start.z), start.x.0), ..asked.context },
            ..asked.clone()
        };
        assert_eq!(told(asked), told(turned));
    }
}

#[test]
fn mirrored_and_shifted_holes_have_mirrored_and_shifted_moves() {
    let mut dice = Dice::new(808_080);
    for _ in 0..5_000 {
        let asked = request(&mut dice, |dice| thousandths(dice.whole(1, 3_000) * 10));
        let shift = thousandths(dice.whole(-50_000, 50_000) * 2);
        let start = asked.context.start;
        let (mirrored, shifted) = match asked.axis {
            PeckAxis::X => {
                (Position::new(-start.x, start.z), Position::new(start.x + Radius(shift), start.z))
            }
            PeckAxis::Z => (Position::new(start.x, -start.z), Position::new(start.x, start.z + shift)),
        };
        let change = |start, change: &dyn Fn(Length) -> Length| HoleRequest {
            context: Context { start, ..asked.context },
            initial: change(asked.initial),
            r_point: change(asked.r_point),
            bottom: change(asked.bottom),
            ..asked.clone()
        };
        let plain = told(asked.clone());
        let carried = |carry: &dyn Fn(i64) -> i64| -> Vec<Told> {
            plain.iter().map(|(phase, to, pass)| (*phase, to.map(|(u, v)| (carry(u), v)), *pass)).collect()
        };
        assert_eq!(told(change(mirrored, &|length| -length)), carried(&|u| -u));
        assert_eq!(told(change(shifted, &|length| length + shift)), carried(&|u| u + shift.nm()));
    }
}

#[test]
fn no_hole_panics_or_runs_away() {
    let mut dice = Dice::new(0xDEAD_BEEF);
    let mut accepted = 0;
    for _ in 0..20_000 {
        let wild = |dice: &mut Dice| match dice.whole(0, 9) {
            0 => Length::ZERO,
            1 => Length::from_nm(1),
            2 => Length::from_nm(i64::MAX),
            3 => Length::from_nm(i64::MIN),
            4 => Length::from_nm(dice.whole(-2_000_000_000_000_000, 2_000_000_000_000_000)),
            _ => thousandths(dice.whole(-50_000, 50_000)),
        };
        let mut asked = request(&mut dice, |dice| thousandths(dice.whole(-50_000, 50_000)));
        if dice.percent(50) {
            (asked.place, asked.step) = (wild(&mut dice), wild(&mut dice));
            (asked.initial, asked.bottom, asked.r_point) =
                (wild(&mut dice), wild(&mut dice), wild(&mut dice));
            asked.repeats = dice.roll() as u32;
        }
        let Ok(cycle) = hole(asked) else { continue };
        accepted += 1;
        let estimate = cycle.move_estimate();
        assert!(cycle.take(2_000).count() as u64 <= estimate);
    }
    assert!(accepted > 7_000, "{accepted} accepted");
}
