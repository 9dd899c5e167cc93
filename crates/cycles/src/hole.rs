//! Holes: drilling with and without pecks, boring and tapping, into the face or into the side.
//!
//! In: a [`HoleRequest`]. Out: for every repeat the way to the hole, clamp, R point, the work down to the bottom, dwell,
//! back to the R point, and home to the initial level unless the tool stays at the R point.
//!
//! Pecks are counted from the R point; the last one ends exactly at the bottom. A return never leads above the R point.
//! Taps turn round at the end of every peck, drills only go back.
//!
//! Not here: which words are modal, when a spindle counts as rigid, what clamps. Source: hole cycles, chapter 19 of the
//! language.

use turnwright_canon::{Action, Dwell, OtherAxes, Phase, Shape};
use turnwright_units::{Angle, Feed, Lead, Length, Position, Seconds, WorkTip};

use crate::plane::{Plane, in_range};
use crate::{Context, CycleMove, Misuse, PeckAxis, Tool, pass_number};

/// A hole is not cut in one go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peck {
    /// Depth of a peck, radius along X. More than zero.
    pub depth: Length,
    /// How far the tool goes back after it.
    pub retract: PeckRetract,
}

/// The way back after a peck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PeckRetract {
    /// By so much, to break the chip.
    Short(Length),
    /// To the R point, to bring the chip out; the next peck starts at feed so much above the depth reached.
    Full(Length),
}

/// What is done between the R point and the bottom.
#[derive(Clone, Debug, PartialEq)]
pub enum HoleWork {
    /// In at feed, out at rapid.
    Drill(Option<Peck>),
    /// In at feed, out at a feed of its own.
    Bore(Feed),
    /// In and out with the spindle turning round in between.
    Tap(Box<Tap>),
}

/// The spindle's part in tapping, as commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Tap {
    /// Before the way in, unless the spindle turns already.
    pub start: Option<Action>,
    /// At the end of every way in and out.
    pub stop: Action,
    /// Before the way out.
    pub reverse: Action,
    /// Before the next way in of a pecked hole.
    pub forward: Action,
    /// After the last way out, when the spindle goes on as before.
    pub restart: Option<Action>,
    /// In step with the spindle by this lead, which is led for it; `None`: at feed, the holder gives way.
    pub lead: Option<Lead>,
    /// Pecks of rigid tapping.
    pub peck: Option<Peck>,
}

/// The brake of a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamping {
    /// Number of the M function that clamps.
    pub on: u32,
    /// Number of the one that frees.
    pub off: u32,
    /// Time to free.
    pub dwell: Seconds,
}

/// The words of a hole cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct HoleRequest {
    /// State the cycle starts in.
    pub context: Context,
    /// Axis of the hole.
    pub axis: PeckAxis,
    /// Where the first hole lies on the axis across; a radius when that is X.
    pub place: Length,
    /// From repeat to repeat.
    pub step: Length,
    /// Where other axes stand for the first hole.
    pub others: OtherAxes,
    /// What turns and moves them from repeat to repeat.
    pub others_step: (Angle, Length),
    /// Along the hole: level that the tool comes from, R point, bottom; radii along X.
    pub initial: Length,
    /// Where the feed begins.
    pub r_point: Length,
    /// Where it ends.
    pub bottom: Length,
    /// What is done in between.
    pub work: HoleWork,
    /// Dwell at the bottom.
    pub dwell: Seconds,
    /// Brake of the rotary axis.
    pub clamping: Option<Clamping>,
    /// The tool stays at the R point.
    pub stays_at_r: bool,
    /// How many holes; none for zero.
    pub repeats: u32,
}

/// The moves of a hole cycle.
#[derive(Clone, Debug)]
pub struct Hole {
    request: HoleRequest,
    plane: Plane,
    tool: Tool,
    /// Signed way of a peck, and the whole way from the R point.
    peck: i64,
    total: i64,
    pecks: i64,
    hole: u32,
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Place,
    Clamp,
    RPoint,
    /// A rigid tap leads the spindle, and lets it go.
    Lead,
    StartSpindle,
    In(i64),
    /// A drill goes back from peck to peck.
    Back(i64),
    Down(i64),
    /// A tap turns round at the end of a peck, goes out, and turns round again.
    Stop(i64),
    Dwell,
    Reverse(i64),
    TapOut(i64),
    StopOutside(i64),
    Forward(i64),
    LetGo,
    Out,
    Home,
    Free,
    FreeDwell,
    Done,
}

/// Plans holes.
///
/// # Errors
/// [`Misuse::PeckNegative`], [`Misuse::BelowIncrement`], [`Misuse::OutOfRange`].
pub fn hole(request: HoleRequest) -> Result<Hole, Misuse> {
    let plane = Plane::new(request.axis == PeckAxis::X, request.context.increment);
    let depth = request.peck().map_or(Length::ZERO, |peck| peck.depth);
    let start = request.context.start;
    let last = i64::from(request.repeats.saturating_sub(1)).saturating_mul(request.step.nm());
    in_range(&[start.x.0, start.z, request.place, request.step, Length::from_nm(last), depth])?;
    in_range(&[request.initial, request.r_point, request.bottom, request.others_step.1])?;
    if depth.signum() < 0 {
        return Err(Misuse::PeckNegative);
    }
    if depth.nm() > 0 && depth.nm() < plane.grid_u() {
        return Err(Misuse::BelowIncrement);
    }
    let total = request.bottom.nm() - request.r_point.nm();
    let pecks = if depth.is_zero() || total == 0 { 1 } else { (total.abs() - 1) / depth.nm() + 1 };
    let next = if request.repeats == 0 { Next::Done } else { Next::Place };
    let tool = Tool::new(start);
    let peck = depth.nm() * total.signum();
    let mut hole = Hole { peck, request, plane, tool, total, pecks, hole: 1, next };
    if hole.at_depth(0) == hole.at_depth(total) && hole.request.step.is_zero() {
        // A hole of no depth in one place: once is enough, and a great many times would take for ever.
        hole.request.repeats = hole.request.repeats.min(1);
    }
    Ok(hole)
}

impl HoleRequest {
    fn peck(&self) -> Option<Peck> {
        match &self.work {
            HoleWork::Drill(peck) => *peck,
            HoleWork::Bore(_) => None,
            HoleWork::Tap(tap) => tap.peck,
        }
    }
}

impl Hole {
    /// No more commands than this.
    pub fn move_estimate(&self) -> u64 {
        let pecks = u64::try_from(self.pecks).unwrap_or(0);
        pecks.saturating_mul(6).saturating_add(10).saturating_mul(u64::from(self.request.repeats))
    }

    fn advance(&mut self) -> Option<CycleMove> {
        loop {
            let step = match self.next {
                Next::Place => self.place(),
                Next::Clamp => self.clamp(),
                Next::RPoint => self.r_point(),
                Next::Lead => self.lead(true, Next::StartSpindle),
                Next::StartSpindle => self.start_spindle(),
                Next::In(count) => self.work_in(count),
                Next::Back(count) => self.back(count),
                Next::Down(count) => self.down(count),
                Next::Stop(count) => self.turn(
                    |tap| Some(&tap.stop),
                    if count < self.pecks { Next::Reverse(count) } else { Next::Dwell },
                ),
                Next::Dwell => self.dwell(),
                Next::Reverse(count) => self.turn(|tap| Some(&tap.reverse), Next::TapOut(count)),
                Next::TapOut(count) => self.tap_out(count),
                Next::StopOutside(count) => self.turn(|tap| Some(&tap.stop), Next::Forward(count)),
                Next::Forward(count) if count < self.pecks => {
                    self.turn(|tap| Some(&tap.forward), Next::In(count + 1))
                }
                Next::Forward(_) => self.turn(|tap| tap.restart.as_ref(), Next::LetGo),
                Next::LetGo => self.lead(false, Next::Home),
                Next::Out => self.out(),
                Next::Home => self.home(),
                Next::Free => self.free(),
                Next::FreeDwell => self.free_dwell(),
                Next::Done => return None,
            };
            if step.is_some() {
                return step;
            }
        }
    }

    /// To the hole, at the level where the tool stands.
    fn place(&mut self) -> Option<CycleMove> {
        self.next = Next::Clamp;
        let count = i64::from(self.hole - 1);
        let request = &self.request;
        let (level, _) = self.plane.split(self.tool.at());
        let to = self.plane.place(level, self.place_v());
        let (turn, way) = request.others_step;
        let mut others = request.others;
        others.c = others.c.map(|c| c + Angle::from_nanodegrees(turn.nanodegrees().saturating_mul(count)));
        others.y = others.y.map(|y| y + Length::from_nm(way.nm().saturating_mul(count)));
        let goes_on = count == 0 || turn != Angle::ZERO || !way.is_zero();
        let moves_others = goes_on && (others.c.is_some() || others.y.is_some() || others.b.is_some());
        let others = moves_others.then(|| Box::new(others));
        let action = Action::Rapid { to, path: request.context.rapid, others };
        self.tell(action, Phase::Shift)
    }

    fn clamp(&mut self) -> Option<CycleMove> {
        self.next = Next::RPoint;
        let code = self.request.clamping?.on;
        self.tell(Action::Auxiliary { code }, Phase::Shift)
    }

    fn r_point(&mut self) -> Option<CycleMove> {
        self.next = if self.tap().is_some() { Next::Lead } else { Next::In(1) };
        self.tell(self.request.context.rapid(self.at_depth(0)), Phase::Approach)
    }

    /// A rigid tap leads the spindle from here on, or no more.
    fn lead(&mut self, is_led: bool, next: Next) -> Option<CycleMove> {
        self.next = next;
        self.tap()?.lead?;
        self.tell(Action::RigidTapping(is_led), Phase::Thread)
    }

    fn start_spindle(&mut self) -> Option<CycleMove> {
        self.turn(|tap| tap.start.as_ref(), Next::In(1))
    }

    /// A command of the spindle, when the tap has one here.
    fn turn(&mut self, action: impl Fn(&Tap) -> Option<&Action>, next: Next) -> Option<CycleMove> {
        self.next = next;
        let action = self.tap().and_then(action)?.clone();
        self.tell(action, Phase::Thread)
    }

    fn work_in(&mut self, count: i64) -> Option<CycleMove> {
        let is_last = count == self.pecks;
        let to = self.at_depth(self.depth(count));
        let (next, phase) = match (&self.request.work, is_last) {
            (HoleWork::Tap(_), _) => (Next::Stop(count), Phase::Thread),
            (_, true) if self.pecks == 1 => (Next::Dwell, Phase::Cut),
            (_, true) => (Next::Dwell, Phase::Peck),
            (_, false) => (Next::Back(count), Phase::Peck),
        };
        self.next = next;
        self.tell(self.at_pace(to, count > 1), phase)
    }

    fn back(&mut self, count: i64) -> Option<CycleMove> {
        let (to, next) = match self.request.peck()?.retract {
            PeckRetract::Short(way) => (self.above(count, way), Next::In(count + 1)),
            PeckRetract::Full(_) => (self.at_depth(0), Next::Down(count)),
        };
        self.next = next;
        self.tell(self.request.context.rapid(to), Phase::Back)
    }

    fn down(&mut self, count: i64) -> Option<CycleMove> {
        self.next = Next::In(count + 1);
        let PeckRetract::Full(clearance) = self.request.peck()?.retract else { return None };
        self.tell(self.request.context.rapid(self.above(count, clearance)), Phase::Return)
    }

    fn dwell(&mut self) -> Option<CycleMove> {
        self.next = if self.tap().is_some() { Next::Reverse(self.pecks) } else { Next::Out };
        let phase = if self.tap().is_some() { Phase::Thread } else { Phase::Cut };
        self.pause(self.request.dwell, phase)
    }

    /// A tap leaves a peck, or the hole.
    fn tap_out(&mut self, count: i64) -> Option<CycleMove> {
        self.next = Next::StopOutside(count);
        let to = match self.request.peck().map(|peck| peck.retract) {
            Some(PeckRetract::Short(way)) if count < self.pecks => self.above(count, way),
            _ => self.at_depth(0),
        };
        let phase = if count < self.pecks { Phase::Back } else { Phase::Out };
        self.tell(self.at_pace(to, true), phase)
    }

    fn out(&mut self) -> Option<CycleMove> {
        self.next = Next::Home;
        let to = self.at_depth(0);
        let action = match self.request.work {
            HoleWork::Bore(feed) => Action::Feed { to, shape: Shape::Line, feed, others: None },
            HoleWork::Drill(_) | HoleWork::Tap(_) => self.request.context.rapid(to),
        };
        self.tell(action, Phase::Out)
    }

    fn home(&mut self) -> Option<CycleMove> {
        self.next = Next::Free;
        if self.request.stays_at_r {
            return None;
        }
        let to = self.plane.place(self.request.initial.nm(), self.place_v());
        self.tell(self.request.context.rapid(to), Phase::Home)
    }

    fn free(&mut self) -> Option<CycleMove> {
        self.next = Next::FreeDwell;
        let code = self.request.clamping?.off;
        self.tell(Action::Auxiliary { code }, Phase::Home)
    }

    fn free_dwell(&mut self) -> Option<CycleMove> {
        let time = self.request.clamping.map_or(Seconds(0.0), |clamping| clamping.dwell);
        let step = self.pause(time, Phase::Home);
        (self.hole, self.next) = if self.hole < self.request.repeats {
            (self.hole + 1, Next::Place)
        } else {
            (self.hole, Next::Done)
        };
        step
    }

    fn pause(&self, time: Seconds, phase: Phase) -> Option<CycleMove> {
        if time.0 > 0.0 { self.tell(Action::Dwell(Dwell::Time(time)), phase) } else { None }
    }

    fn tap(&self) -> Option<&Tap> {
        match &self.request.work {
            HoleWork::Tap(tap) => Some(tap),
            HoleWork::Drill(_) | HoleWork::Bore(_) => None,
        }
    }

    /// At feed, or in step with the spindle.
    fn at_pace(&self, to: Position<WorkTip>, is_chained: bool) -> Action {
        match self.tap().and_then(|tap| tap.lead) {
            Some(lead) => Action::Thread {
                to,
                shape: Shape::Line,
                lead,
                lead_end: None,
                start_angle: Angle::ZERO,
                is_chained,
            },
            None => self.request.context.line(to),
        }
    }

    /// Way from the R point after a peck; the last one reaches the bottom exactly.
    const fn depth(&self, count: i64) -> i64 {
        if count < self.pecks { self.peck * count } else { self.total }
    }

    /// So much above the depth of a peck, but not above the R point.
    fn above(&self, count: i64, way: Length) -> Position<WorkTip> {
        let depth = self.depth(count);
        self.at_depth(depth - depth.signum() * way.nm().clamp(0, depth.abs()))
    }

    fn at_depth(&self, depth: i64) -> Position<WorkTip> {
        self.plane.place(self.request.r_point.nm() + depth, self.place_v())
    }

    fn place_v(&self) -> i64 {
        self.request.place.nm() + self.request.step.nm() * i64::from(self.hole - 1)
    }

    #[expect(clippy::unnecessary_wraps, reason = "steps that are left out are None")]
    fn tell(&self, action: Action, phase: Phase) -> Option<CycleMove> {
        Some(CycleMove { action, phase, pass: pass_number(u64::from(self.hole)), element: None })
    }
}

impl Iterator for Hole {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        loop {
            let step = self.advance()?;
            if self.tool.goes(&step) {
                return Some(step);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{RapidPath, SpindleSpeed, SpindleState};
    use turnwright_units::{FeedPerRevolution, LeastIncrement, Radius, Rpm};

    use super::*;

    fn mm(millimetres: i32) -> Length {
        Length::from_mm(millimetres)
    }

    fn request(work: HoleWork) -> HoleRequest {
        HoleRequest {
            context: Context {
                start: Position::new(Radius(mm(30)), mm(10)),
                increment: LeastIncrement::METRIC_B,
                feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(100_000))),
                rapid: RapidPath::EachAxis,
            },
            axis: PeckAxis::Z,
            place: mm(20),
            step: Length::ZERO,
            others: OtherAxes::default(),
            others_step: (Angle::ZERO, Length::ZERO),
            initial: mm(10),
            r_point: mm(2),
            bottom: mm(-10),
            work,
            dwell: Seconds(0.0),
            clamping: None,
            stays_at_r: false,
            repeats: 1,
        }
    }

    /// Places along Z, millimetres, behind the positioning.
    fn levels(request: HoleRequest) -> Vec<(Phase, f64)> {
        let moves = hole(request).expect("a hole").skip(1);
        moves.filter_map(|step| Some((step.phase, step.action.end_point()?.z.to_mm()))).collect()
    }

    #[test]
    fn a_drill_without_pecks_goes_straight_in() {
        use Phase::{Approach, Cut, Home, Out};
        let expected = [(Approach, 2.0), (Cut, -10.0), (Out, 2.0), (Home, 10.0)];
        assert_eq!(levels(request(HoleWork::Drill(None))), expected);
    }

    #[test]
    fn pecks_break_the_chip_or_bring_it_out() {
        use Phase::{Approach, Back, Home, Out, Peck as Bite, Return};
        let peck = |retract| HoleWork::Drill(Some(Peck { depth: mm(5), retract }));
        let short = levels(request(peck(PeckRetract::Short(mm(1)))));
        let expected = [
            (Approach, 2.0),
            (Bite, -3.0),
            (Back, -2.0),
            (Bite, -8.0),
            (Back, -7.0),
            (Bite, -10.0),
            (Out, 2.0),
            (Home, 10.0),
        ];
        assert_eq!(short, expected);
        let full = levels(request(peck(PeckRetract::Full(mm(1)))));
        let expected = [
            (Approach, 2.0),
            (Bite, -3.0),
            (Back, 2.0),
            (Return, -2.0),
            (Bite, -8.0),
            (Back, 2.0),
            (Return, -7.0),
            (Bite, -10.0),
            (Out, 2.0),
            (Home, 10.0),
        ];
        assert_eq!(full, expected);
    }

    #[test]
    fn repeats_go_on_across() {
        let asked =
            HoleRequest { step: mm(-4), repeats: 3, stays_at_r: true, ..request(HoleWork::Drill(None)) };
        let places: Vec<_> = hole(asked)
            .expect("holes")
            .filter(|step| step.phase == Phase::Shift)
            .filter_map(|step| step.action.end_point())
            .map(|to| (to.x.to_mm(), to.z.to_mm()))
            .collect();
        assert_eq!(places, [(20.0, 10.0), (16.0, 2.0), (12.0, 2.0)]);
        let none = HoleRequest { repeats: 0, ..request(HoleWork::Drill(None)) };
        assert_eq!(hole(none).expect("none").count(), 0);
    }

    fn spindle(state: SpindleState) -> Action {
        Action::Spindle { state, speed: SpindleSpeed::Constant(Rpm(500)), rpm_max: None }
    }

    fn tap(peck: Option<Peck>) -> HoleWork {
        HoleWork::Tap(Box::new(Tap {
            start: None,
            stop: spindle(SpindleState::Stop),
            reverse: spindle(SpindleState::CounterClockwise),
            forward: spindle(SpindleState::Clockwise),
            restart: Some(spindle(SpindleState::Clockwise)),
            lead: Some(Lead(mm(1))),
            peck,
        }))
    }

    #[test]
    fn a_tap_turns_round_at_the_bottom_and_outside() {
        let asked = HoleRequest { dwell: Seconds(0.5), ..request(tap(None)) };
        let steps: Vec<_> = hole(asked).expect("a hole").skip(2).map(|step| step.action).collect();
        let is_spindle = |place: usize, state| steps[place] == spindle(state);
        assert_eq!(steps.len(), 10);
        assert_eq!((&steps[0], &steps[8]), (&Action::RigidTapping(true), &Action::RigidTapping(false)));
        assert_eq!(steps[1].end_point().map(|to| to.z), Some(mm(-10)));
        assert!(is_spindle(2, SpindleState::Stop) && is_spindle(4, SpindleState::CounterClockwise));
        assert_eq!(steps[3], Action::Dwell(Dwell::Time(Seconds(0.5))));
        assert_eq!(steps[5].end_point().map(|to| to.z), Some(mm(2)));
        assert!(is_spindle(6, SpindleState::Stop) && is_spindle(7, SpindleState::Clockwise));
    }

    #[test]
    fn a_pecked_tap_never_goes_back_without_turning() {
        let peck = Peck { depth: mm(5), retract: PeckRetract::Short(mm(1)) };
        let steps: Vec<_> = hole(request(tap(Some(peck)))).expect("a hole").skip(2).collect();
        let ends: Vec<_> =
            steps.iter().filter_map(|step| step.action.end_point()).map(|to| to.z.to_mm()).collect();
        assert_eq!(ends, [-3.0, -2.0, -8.0, -7.0, -10.0, 2.0, 10.0]);
        let turns = steps.iter().filter(|step| step.action.end_point().is_none()).count();
        // Besides, it is led and let go.
        assert_eq!(turns, 3 * 4 + 2);
    }

    #[test]
    fn the_estimate_is_not_exceeded() {
        for peck in [None, Some(Peck { depth: mm(1), retract: PeckRetract::Full(mm(1)) })] {
            for work in [HoleWork::Drill(peck), tap(peck)] {
                let clamping = Some(Clamping { on: 31, off: 32, dwell: Seconds(1.0) });
                let asked = HoleRequest { clamping, dwell: Seconds(1.0), repeats: 4, ..request(work) };
                let cycle = hole(asked).expect("holes");
                let estimate = cycle.move_estimate();
                assert!(cycle.count() as u64 <= estimate);
            }
        }
    }
}
