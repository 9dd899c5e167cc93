//! The single cycles: one box of four moves, straight or tapered, and the box whose cut is a thread.
//!
//! In: a [`BoxRequest`] or a [`ThreadOnceRequest`]. Out: infeed, cut, out, home. The box leaves the cut at the feed,
//! the thread at rapid traverse.
//!
//! Not here: which words persist from block to block. Source: the single cycles in
//! chapter 13 of the language reference.

use turnwright_canon::{Action, Phase};
use turnwright_units::{Angle, FeedPerMinute, Lead, Length, Position, WorkTip};

use crate::plane::{Plane, in_range};
use crate::threading::{LineWords, Part, ThreadLeg, ThreadLine};
use crate::{Context, CutAlong, CycleMove, Misuse, Tool};

/// The axis that a box cycle moves first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FirstAxis {
    /// X: turning along Z, taper on the diameter.
    X,
    /// Z: facing along X, taper on the face.
    Z,
}

/// The words of a box cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxRequest {
    /// State the cycle starts in.
    pub context: Context,
    /// Axis of the infeed.
    pub first: FirstAxis,
    /// Where the cut ends.
    pub end: Position<WorkTip>,
    /// Begin of the cut less its end, along the axis of the infeed; radius for X; signed.
    pub taper: Length,
}

/// The moves of a box cycle.
#[derive(Clone, Debug)]
pub struct BoxCycle {
    context: Context,
    corners: [Position<WorkTip>; 3],
    tool: Tool,
    done: usize,
}

/// Plans a box cycle.
///
/// # Errors
/// [`Misuse::OutOfRange`].
pub fn box_cycle(request: BoxRequest) -> Result<BoxCycle, Misuse> {
    let context = request.context;
    in_range(&[context.start.x.0, context.start.z, request.end.x.0, request.end.z, request.taper])?;
    let plane = Plane::new(request.first == FirstAxis::X, context.increment);
    let (start, end) = (plane.split(context.start), plane.split(request.end));
    let corners = [
        plane.place(end.0 + request.taper.nm(), start.1),
        plane.place(end.0, end.1),
        plane.place(start.0, end.1),
    ];
    Ok(BoxCycle { context, corners, tool: Tool::new(context.start), done: 0 })
}

impl BoxCycle {
    /// No more moves than this.
    pub const fn move_estimate(&self) -> u64 {
        4
    }

    fn advance(&mut self) -> Option<CycleMove> {
        let [begin, end, out] = self.corners;
        let (action, phase): (Action, Phase) = match self.done {
            0 => (self.context.rapid(begin), Phase::Infeed),
            1 => (self.context.line(end), Phase::Cut),
            2 => (self.context.line(out), Phase::Out),
            3 => (self.context.rapid(self.context.start), Phase::Home),
            _ => return None,
        };
        self.done += 1;
        Some(CycleMove { action, phase, pass: 1, element: None })
    }
}

impl Iterator for BoxCycle {
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

/// The words of a single thread pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadOnceRequest {
    /// State the cycle starts in; its feed is not used.
    pub context: Context,
    /// The axis that the thread runs along; the infeed is along the other one.
    pub along: CutAlong,
    /// Where the thread ends.
    pub end: Position<WorkTip>,
    /// Begin of the thread less its end along the axis of the infeed, signed; radius for X.
    pub taper: Length,
    /// Advance per revolution, along the longer axis of the thread.
    pub lead: Lead,
    /// Spindle angle at which the first pass starts.
    pub start_angle: Angle,
    /// Starts of the thread, spread evenly over a revolution: one pass each. Zero is one.
    pub starts: u32,
    /// Length of the run-out along the thread; zero: none.
    pub run_out: Length,
    /// Angle of the run-out from the thread's axis, degrees below 90; zero: 45.
    pub run_out_angle_deg: u8,
    /// How far the run-out leaves along the axis of the infeed, instead of by the angle.
    pub run_out_depth: Option<Length>,
    /// Feed of the way out; rapid traverse when not given.
    pub pull_out_feed: Option<FeedPerMinute>,
    /// How the tool comes down to the thread with the spindle turning; straight down before it when not given.
    pub run_in: Option<RunIn>,
}

/// A slanted way to the depth of a thread, at the thread's lead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunIn {
    /// Along the axis of the infeed, positive; radius for X.
    pub depth: Length,
    /// Along the thread, positive.
    pub length: Length,
}

/// The moves of a single thread pass, or of one for each start.
#[derive(Clone, Debug)]
pub struct ThreadOnce {
    line: ThreadLine,
    part: Part,
    tool: Tool,
    first_angle: Angle,
    /// Number of the start in work, from 0, and how many there are.
    start: u32,
    starts: u32,
}

/// Plans a single thread pass.
///
/// # Errors
/// [`Misuse::NoThread`], [`Misuse::LeadNotPositive`], [`Misuse::RunOutNegative`], [`Misuse::RunOutAngle`],
/// [`Misuse::OutOfRange`].
pub fn thread_once(request: ThreadOnceRequest) -> Result<ThreadOnce, Misuse> {
    let ThreadOnceRequest { context, end, taper, lead, start_angle, run_out, run_out_angle_deg, .. } =
        request;
    let mut line = ThreadLine::new(LineWords {
        context,
        along: request.along,
        end,
        taper,
        run_out,
        run_out_angle_deg,
        run_out_depth: request.run_out_depth,
        pull_out_feed: request.pull_out_feed,
        lead,
        start_angle,
    })?;
    line.fit_run_out(0.0, 0.0);
    if let Some(RunIn { depth, length }) = request.run_in {
        in_range(&[depth, length])?;
        line.run_in = Some((depth.to_nm_float(), length.to_nm_float()));
    }
    let (tool, starts) = (Tool::new(context.start), request.starts.max(1));
    Ok(ThreadOnce { line, part: Part::Infeed, tool, first_angle: start_angle, start: 0, starts })
}

/// Where a start of several begins, in whole thousandths of a degree; below a full turn except for the first.
pub fn angle_of_start(first: Angle, start: u32, starts: u32) -> Angle {
    const TURN: i64 = 360_000;
    if start == 0 {
        return first;
    }
    let shift = (i64::from(start) * TURN * 2 + i64::from(starts)) / (i64::from(starts) * 2);
    Angle::from_millidegrees((first.millidegrees() + shift) % TURN)
}

impl ThreadOnce {
    /// No more moves than this.
    pub const fn move_estimate(&self) -> u64 {
        6 * self.starts as u64
    }

    /// Passes it makes.
    pub const fn passes(&self) -> u32 {
        self.starts
    }

    /// The run-out that is made, along the thread, when the one asked for does not fit between thread and start
    /// point.
    pub fn run_out_shortened(&self) -> Option<Length> {
        self.line.shortened()
    }

    fn leg(&mut self) -> Option<ThreadLeg> {
        let leg = self.line.leg(self.part, 0.0, 0.0, self.start + 1)?;
        self.part = match self.part {
            Part::Infeed if self.line.run_in.is_some() => Part::RunIn,
            part => part.after(),
        };
        if self.part == Part::Done && self.start + 1 < self.starts {
            (self.part, self.start) = (Part::Infeed, self.start + 1);
            self.line.start_angle = angle_of_start(self.first_angle, self.start, self.starts);
        }
        Some(leg)
    }
}

impl Iterator for ThreadOnce {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        loop {
            let leg = self.leg()?;
            if self.tool.goes_to(leg.to) {
                return Some(self.line.make(leg));
            }
        }
    }
}

/// Whether a taper makes the path of a single cycle cross itself: it points against the infeed and is longer. Without
/// an infeed (the cut ends at the start's diameter) nothing crosses. Some controls alarm, others cut it; so it is a question and not a refusal.
pub fn taper_crosses_start(
    first: FirstAxis,
    start: Position<WorkTip>,
    end: Position<WorkTip>,
    taper: Length,
) -> bool {
    let infeed = match first {
        FirstAxis::X => (end.x - start.x).0,
        FirstAxis::Z => end.z - start.z,
    };
    taper.signum() * infeed.signum() < 0 && taper.abs() > infeed.abs()
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{RapidPath, Shape};
    use turnwright_units::{Diameter, Feed, FeedPerRevolution, LeastIncrement};

    use super::*;

    fn at(diameter: i32, z: i32) -> Position<WorkTip> {
        Position::new(Diameter(Length::from_mm(diameter)).to_radius(), Length::from_mm(z))
    }

    fn context() -> Context {
        Context {
            start: at(32, 1),
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(150_000))),
            rapid: RapidPath::EachAxis,
        }
    }

    fn corners(cycle: impl Iterator<Item = CycleMove>) -> Vec<Position<WorkTip>> {
        cycle.filter_map(|step| step.action.end_point()).collect()
    }

    #[test]
    fn a_tapered_box_begins_at_end_plus_taper() {
        let request = BoxRequest {
            context: context(),
            first: FirstAxis::X,
            end: at(26, -25),
            taper: Length::from_mm(-3),
        };
        let cycle = box_cycle(request).expect("a box");
        let kinds: Vec<_> = cycle.clone().map(|step| matches!(step.action, Action::Rapid { .. })).collect();
        assert_eq!(kinds, [true, false, false, true]);
        assert_eq!(corners(cycle), [at(20, 1), at(26, -25), at(32, -25), at(32, 1)]);
    }

    #[test]
    fn a_facing_box_moves_z_first() {
        let request = BoxRequest {
            context: context(),
            first: FirstAxis::Z,
            end: at(10, -2),
            taper: Length::from_mm(-1),
        };
        let cycle = box_cycle(request).expect("a box");
        assert_eq!(corners(cycle), [at(32, -3), at(10, -2), at(10, 1), at(32, 1)]);
    }

    #[test]
    fn a_box_of_no_size_has_no_moves() {
        let request =
            BoxRequest { context: context(), first: FirstAxis::X, end: at(32, 1), taper: Length::ZERO };
        assert_eq!(box_cycle(request).expect("a box").count(), 0);
    }

    #[test]
    fn a_thread_leaves_at_rapid() {
        let request = ThreadOnceRequest {
            context: context(),
            end: at(26, -20),
            taper: Length::ZERO,
            along: CutAlong::Z,
            lead: Lead(Length::from_mm(2)),
            start_angle: Angle::ZERO,
            starts: 1,
            run_out: Length::from_mm(2),
            run_out_angle_deg: 45,
            run_out_depth: None,
            pull_out_feed: None,
            run_in: None,
        };
        let cycle = thread_once(request).expect("a thread");
        assert_eq!(cycle.run_out_shortened(), None);
        assert!(matches!(cycle.clone().nth(3).expect("out").action, Action::Rapid { .. }));
        assert_eq!(corners(cycle), [at(26, 1), at(26, -18), at(30, -20), at(32, -20), at(32, 1)]);
        let long =
            thread_once(ThreadOnceRequest { run_out: Length::from_mm(9), ..request }).expect("a thread");
        assert_eq!(long.run_out_shortened(), Some(Length::from_mm(3)));
        let steep = ThreadOnceRequest { run_out_depth: Some(Length::from_mm(1)), ..request };
        let steep = corners(thread_once(steep).expect("a thread"));
        assert_eq!(steep[1..3], [at(26, -18), at(28, -20)]);
        let run_in = RunIn { depth: Length::from_mm(1), length: Length::from_mm(3) };
        let gentle = thread_once(ThreadOnceRequest { run_in: Some(run_in), ..request }).expect("a thread");
        assert_eq!(corners(gentle)[..3], [at(28, 1), at(26, -2), at(26, -18)]);
        let face = ThreadOnceRequest { along: CutAlong::X, end: at(12, -3), ..request };
        let face = corners(thread_once(face).expect("a thread"));
        assert_eq!(face, [at(32, -3), at(16, -3), at(12, -1), at(12, 1), at(32, 1)]);
        let flat = thread_once(ThreadOnceRequest { end: at(26, 1), ..request });
        assert_eq!(flat.map(|_| ()), Err(Misuse::NoThread));
    }

    #[test]
    fn several_starts_are_spread_over_the_turn() {
        let starts = |starts, first| -> Vec<i64> {
            let first = Angle::from_millidegrees(first);
            (0..starts).map(|start| angle_of_start(first, start, starts).millidegrees()).collect()
        };
        assert_eq!(starts(1, 360_000), [360_000]);
        assert_eq!(starts(3, 0), [0, 120_000, 240_000]);
        assert_eq!(starts(7, 300_000), [300_000, 351_429, 42_857, 94_286, 145_714, 197_143, 248_571]);
    }

    #[test]
    fn a_taper_against_the_cut_must_fit_into_the_infeed() {
        let crosses =
            |taper| taper_crosses_start(FirstAxis::X, at(32, 1), at(26, -25), Length::from_mm(taper));
        assert!(!crosses(-50));
        assert!(!crosses(3));
        assert!(crosses(4));
    }

    #[test]
    fn cuts_are_lines_at_the_feed_of_the_block() {
        let request =
            BoxRequest { context: context(), first: FirstAxis::X, end: at(26, -25), taper: Length::ZERO };
        let cut = box_cycle(request).expect("a box").nth(1).expect("a cut");
        let expected =
            Action::Feed { to: at(26, -25), shape: Shape::Line, feed: context().feed, others: None };
        assert_eq!((cut.action, cut.phase), (expected, Phase::Cut));
    }
}
