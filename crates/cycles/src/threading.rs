//! Thread cutting in many passes, and what every thread pass has in common.
//!
//! In: a [`ThreadRequest`]. Out: pass after pass (infeed along the flank, thread, run-out, out, home), depths from a
//! [`DepthSchedule`]: equal chip area and never less than the least depth, or equal steps; the finishing allowance
//! last, then spring passes. A thread of several starts cuts each depth once a start.
//!
//! The finishing path lies where the flank of the first infeed direction leads at full height. Passes on the other
//! flank are mirrored about that path: mirrored about the start point they would leave a root wider than the tool.
//!
//! Not here: the digits of the packed word, spindle and feed hold. Source: thread cutting, chapter 9 of the cycles.

use turnwright_canon::{Action, Phase, Shape};
use turnwright_units::{Angle, Feed, FeedPerMinute, Lead, Length, Position, Radius, WorkTip};

use crate::plane::{Plane, in_range};
use crate::{Context, CutAlong, CycleMove, Misuse, Tool, angle_of_start, pass_number};

/// What happens to the depths once a pass would take less than the least depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clamp {
    /// Each pass goes at least the least depth below the one before: from the first clamped pass on, steps are equal.
    Accumulate,
    /// Each pass goes at least the least depth below where the *formula* had the one before: after two clamped passes
    /// steps shrink again.
    Formula,
}

/// How depths grow from pass to pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthLaw {
    /// With the root of the pass number, so that every pass cuts the same chip area.
    EqualArea(Clamp),
    /// By the first depth each time.
    EqualSteps,
}

/// Where along Z the passes lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlankInfeed {
    /// All straight in from the start point.
    Centre,
    /// Down the flank that leads in the direction of the cut.
    WithCut,
    /// Down the other flank, against the direction of the cut.
    AgainstCut,
    /// With the cut, every second pass down the other flank of the same groove.
    BothFlanks,
    /// With the cut, every second pass straight above the root.
    FlankAndCentre,
}

impl FlankInfeed {
    /// Way in the direction of the cut per tangent of half the angle: pass from 1, its depth, the full height.
    fn way(self, pass: u64, depth: f64, height: f64) -> f64 {
        let is_second = pass.is_multiple_of(2);
        match self {
            Self::Centre => 0.0,
            Self::AgainstCut => -depth,
            Self::BothFlanks if is_second => 2.0 * height - depth,
            Self::FlankAndCentre if is_second => height,
            Self::WithCut | Self::BothFlanks | Self::FlankAndCentre => depth,
        }
    }

    /// The furthest way of any pass.
    const fn reach(self, height: f64) -> f64 {
        match self {
            Self::Centre | Self::AgainstCut => 0.0,
            Self::WithCut | Self::FlankAndCentre => height,
            Self::BothFlanks => 2.0 * height,
        }
    }
}

/// The words of thread cutting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadRequest {
    /// State the cycle starts in; its feed is not used.
    pub context: Context,
    /// Where the thread ends, at its root (external) or major diameter (internal).
    pub end: Position<WorkTip>,
    /// Radius at the start of the thread less radius at its end, signed.
    pub taper: Radius,
    /// Height of the thread.
    pub height: Radius,
    /// Depth of the first pass.
    pub first_depth: Radius,
    /// Least depth of a pass; zero: none.
    pub min_depth: Radius,
    /// What the roughing passes leave.
    pub finishing_allowance: Radius,
    /// Passes at full height, at least 1: the first takes the allowance, the others nothing.
    pub finishing_passes: u32,
    /// Length of the run-out along Z; zero: none.
    pub run_out: Length,
    /// Angle of the run-out from Z, degrees below 90; zero: 45.
    pub run_out_angle_deg: u8,
    /// How far the run-out leaves the thread, radius; `None`: by the angle.
    pub run_out_depth: Option<Length>,
    /// Speed of leaving the thread; `None`: rapid.
    pub pull_out_feed: Option<FeedPerMinute>,
    /// Angle between the flanks, degrees below 180: the start moves along half of it. Zero: straight in.
    pub nose_angle_deg: u8,
    /// Advance per revolution, along the longer axis of the thread.
    pub lead: Lead,
    /// Spindle angle at which the passes of the first start begin.
    pub start_angle: Angle,
    /// Threads side by side; 0 counts as 1.
    pub starts: u32,
    /// Depths from pass to pass.
    pub depths: DepthLaw,
    /// Where along Z the passes lie.
    pub infeed: FlankInfeed,
}

/// The depths of a thread's passes below the crest, radius, in millimetres, not rounded.
#[derive(Clone, Debug)]
pub struct DepthSchedule {
    first: f64,
    least: f64,
    cap: f64,
    height: f64,
    law: DepthLaw,
    /// Roughing passes so far and the depth of the last.
    count: u64,
    depth: f64,
    finishing_left: u32,
}

/// The depths of a thread's passes: rising to `height` less `finishing_allowance`, then `finishing_passes` times
/// `height`.
///
/// # Errors
/// [`Misuse::HeightNotPositive`], [`Misuse::FirstDepthNotPositive`], [`Misuse::MinDepthNegative`],
/// [`Misuse::MinDepthAboveHeight`], [`Misuse::AllowanceNegative`], [`Misuse::AllowanceNotBelowHeight`],
/// [`Misuse::FinishingPassesZero`], [`Misuse::OutOfRange`].
pub fn depth_schedule(
    height: Radius,
    first_depth: Radius,
    min_depth: Radius,
    finishing_allowance: Radius,
    finishing_passes: u32,
    law: DepthLaw,
) -> Result<DepthSchedule, Misuse> {
    in_range(&[height.0, first_depth.0, min_depth.0, finishing_allowance.0])?;
    let refusals = [
        (height.0.nm() <= 0, Misuse::HeightNotPositive),
        (first_depth.0.nm() <= 0, Misuse::FirstDepthNotPositive),
        (min_depth.0.nm() < 0, Misuse::MinDepthNegative),
        (min_depth > height, Misuse::MinDepthAboveHeight),
        (finishing_allowance.0.nm() < 0, Misuse::AllowanceNegative),
        (finishing_allowance >= height, Misuse::AllowanceNotBelowHeight),
        (finishing_passes == 0, Misuse::FinishingPassesZero),
    ];
    if let Some((_, misuse)) = refusals.into_iter().find(|&(refused, _)| refused) {
        return Err(misuse);
    }
    Ok(DepthSchedule {
        first: nm(first_depth.0),
        least: nm(min_depth.0),
        cap: nm((height - finishing_allowance).0),
        height: nm(height.0),
        law,
        count: 0,
        depth: 0.0,
        finishing_left: finishing_passes,
    })
}

impl DepthSchedule {
    /// No more passes than this.
    pub fn pass_estimate(&self) -> u64 {
        let ratio = self.cap / self.first;
        let by_area = ratio * ratio;
        let passes = match self.law {
            DepthLaw::EqualSteps => ratio,
            DepthLaw::EqualArea(Clamp::Accumulate) if self.least > 0.0 => {
                by_area.min(self.cap / self.least + 1.0)
            }
            DepthLaw::EqualArea(_) => by_area,
        };
        (passes.ceil() as u64).saturating_add(1).saturating_add(u64::from(self.finishing_left))
    }

    /// The next depth, nanometres.
    fn next_nm(&mut self) -> Option<f64> {
        if self.depth < self.cap {
            self.count = self.count.saturating_add(1);
            self.depth = self.rough_depth().min(self.cap);
            return Some(self.depth);
        }
        self.finishing_left = self.finishing_left.checked_sub(1)?;
        Some(self.height)
    }

    fn rough_depth(&self) -> f64 {
        if self.count == 1 {
            return self.first;
        }
        let by_area = |count: u64| self.first * (count as f64).sqrt();
        let before = match self.law {
            DepthLaw::EqualSteps => return self.first * self.count as f64,
            DepthLaw::EqualArea(Clamp::Accumulate) => self.depth,
            DepthLaw::EqualArea(Clamp::Formula) => by_area(self.count - 1),
        };
        by_area(self.count).max(before + self.least)
    }
}

impl Iterator for DepthSchedule {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.next_nm().map(|depth| depth / 1e6)
    }
}

/// The moves of thread cutting.
#[derive(Clone, Debug)]
pub struct Threading {
    line: ThreadLine,
    schedule: DepthSchedule,
    height: f64,
    /// Way along Z per depth.
    flank: f64,
    infeed: FlankInfeed,
    depth: f64,
    /// Number of the present depth from 1, and of the start that is being cut from 0.
    depth_number: u64,
    start: u32,
    starts: u32,
    first_angle: Angle,
    part: Part,
    tool: Tool,
}

/// Plans thread cutting.
///
/// # Errors
/// Those of [`depth_schedule`], [`Misuse::NoThread`], [`Misuse::LeadNotPositive`], [`Misuse::RunOutNegative`],
/// [`Misuse::RunOutAngle`], [`Misuse::NoseAngle`], [`Misuse::ThreadTooShort`].
pub fn thread(request: ThreadRequest) -> Result<Threading, Misuse> {
    let mut schedule = depth_schedule(
        request.height,
        request.first_depth,
        request.min_depth,
        request.finishing_allowance,
        request.finishing_passes,
        request.depths,
    )?;
    if request.nose_angle_deg >= 180 {
        return Err(Misuse::NoseAngle);
    }
    let flank = half_angle_tangent(request.nose_angle_deg);
    let mut line = ThreadLine::new(LineWords {
        context: request.context,
        along: CutAlong::Z,
        end: request.end,
        taper: request.taper.0,
        run_out: request.run_out,
        run_out_angle_deg: request.run_out_angle_deg,
        run_out_depth: request.run_out_depth,
        pull_out_feed: request.pull_out_feed,
        lead: request.lead,
        start_angle: request.start_angle,
    })?;
    let height = nm(request.height.0);
    let reach = flank * request.infeed.reach(height);
    if reach >= line.length.abs() {
        return Err(Misuse::ThreadTooShort);
    }
    line.outward = if request.context.start.x > request.end.x { 1.0 } else { -1.0 };
    let depth = schedule.next_nm().unwrap_or(height);
    // The first pass has the least room to run out sideways, the furthest the shortest thread to do it in.
    line.fit_run_out(height - depth, reach);
    Ok(Threading {
        line,
        schedule,
        height,
        flank,
        infeed: request.infeed,
        depth,
        depth_number: 1,
        start: 0,
        starts: request.starts.max(1),
        first_angle: request.start_angle,
        part: Part::Infeed,
        tool: Tool::new(request.context.start),
    })
}

impl Threading {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        // The depth of the first pass has been taken from the schedule already; the estimate counts it still.
        self.schedule.pass_estimate().saturating_mul(5).saturating_mul(u64::from(self.starts))
    }

    /// The run-out that is made, along Z, when the one asked for does not fit between thread and start point; the
    /// same for all passes.
    pub fn run_out_shortened(&self) -> Option<Length> {
        self.line.shortened()
    }

    /// What comes next, and moves on to what follows it.
    #[inline]
    fn leg(&mut self) -> Option<ThreadLeg> {
        let way = self.infeed.way(self.depth_number, self.depth, self.height);
        let passes_before = (self.depth_number - 1).saturating_mul(u64::from(self.starts));
        let pass = pass_number(passes_before.saturating_add(u64::from(self.start) + 1));
        let leg = self.line.leg(self.part, self.height - self.depth, self.flank * way, pass)?;
        self.part = self.part.after();
        if self.part == Part::Done {
            self.next_pass();
        }
        Some(leg)
    }

    /// The next start at this depth, else the next depth.
    fn next_pass(&mut self) {
        if self.start + 1 < self.starts {
            self.start += 1;
        } else if let Some(depth) = self.schedule.next_nm() {
            (self.start, self.depth) = (0, depth);
            self.depth_number = self.depth_number.saturating_add(1);
        } else {
            return;
        }
        self.part = Part::Infeed;
        self.line.start_angle = angle_of_start(self.first_angle, self.start, self.starts);
    }
}

impl Iterator for Threading {
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

/// The parts of a thread pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Infeed,
    /// Down to the thread while the spindle turns; only where the line has a run-in.
    RunIn,
    Thread,
    Chamfer,
    Out,
    Home,
    Done,
}

impl Part {
    pub(crate) const fn after(self) -> Self {
        match self {
            Self::Infeed | Self::RunIn => Self::Thread,
            Self::Thread => Self::Chamfer,
            Self::Chamfer => Self::Out,
            Self::Out => Self::Home,
            Self::Home | Self::Done => Self::Done,
        }
    }
}

/// A move of a thread pass before it is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThreadLeg {
    part: Part,
    pub(crate) to: Position<WorkTip>,
    pass: u32,
    start_angle: Angle,
    /// The run-out follows a thread in the same pass.
    follows: bool,
}

/// The words that every thread has.
pub(crate) struct LineWords {
    pub(crate) context: Context,
    pub(crate) along: CutAlong,
    pub(crate) end: Position<WorkTip>,
    pub(crate) taper: Length,
    pub(crate) run_out: Length,
    pub(crate) run_out_angle_deg: u8,
    pub(crate) run_out_depth: Option<Length>,
    pub(crate) pull_out_feed: Option<FeedPerMinute>,
    pub(crate) lead: Lead,
    pub(crate) start_angle: Angle,
}

/// The line that a finished thread follows, and how a pass leaves it. Nanometres, radius; u is the axis of the
/// infeed, v that of the thread.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThreadLine {
    context: Context,
    plane: Plane,
    start_u: f64,
    end_u: f64,
    end_v: f64,
    /// From start to end along v, signed.
    pub(crate) length: f64,
    taper: f64,
    /// 1 away from the axis, −1 towards it, 0 when the start gives no side.
    pub(crate) outward: f64,
    asked_run_out: f64,
    run_out: f64,
    /// Way along u per way along v in the run-out.
    slope: f64,
    pull_out_feed: Option<FeedPerMinute>,
    lead: Lead,
    pub(crate) start_angle: Angle,
    /// Way along u, away from the work, and along v.
    pub(crate) run_in: Option<(f64, f64)>,
}

impl ThreadLine {
    pub(crate) fn new(words: LineWords) -> Result<Self, Misuse> {
        let LineWords { context, end, taper, run_out, run_out_angle_deg, lead, start_angle, .. } = words;
        let depth = words.run_out_depth.unwrap_or(Length::ZERO);
        in_range(&[context.start.x.0, context.start.z, end.x.0, end.z, taper, run_out, depth, lead.0])?;
        let plane = Plane::new(words.along == CutAlong::Z, context.increment);
        let ((start_u, start_v), (end_u, end_v)) = (plane.split(context.start), plane.split(end));
        let refusals = [
            (start_v == end_v, Misuse::NoThread),
            (lead.0.nm() <= 0, Misuse::LeadNotPositive),
            (run_out.nm() < 0 || depth.nm() < 0, Misuse::RunOutNegative),
            (run_out_angle_deg >= 90, Misuse::RunOutAngle),
        ];
        if let Some((_, misuse)) = refusals.into_iter().find(|&(refused, _)| refused) {
            return Err(misuse);
        }
        Ok(Self {
            context,
            plane,
            start_u: start_u as f64,
            end_u: end_u as f64,
            end_v: end_v as f64,
            length: (end_v - start_v) as f64,
            taper: nm(taper),
            outward: (start_u - end_u).signum() as f64,
            asked_run_out: nm(run_out),
            run_out: nm(run_out),
            slope: match words.run_out_depth {
                Some(depth) if run_out.nm() > 0 => nm(depth) / nm(run_out),
                _ => tangent(run_out_angle_deg),
            },
            pull_out_feed: words.pull_out_feed,
            lead,
            start_angle,
            run_in: None,
        })
    }

    /// Shortens the run-out so that no pass leaves the room between thread and start point. `stock` is what the
    /// shallowest pass leaves on the root, `advance` how far the start of the deepest has moved along Z.
    pub(crate) fn fit_run_out(&mut self, stock: f64, advance: f64) {
        let room = self.outward * (self.start_u - self.end_u) - stock;
        // Along the run-out the thread's own taper brings the tool nearer to the start point, or further off.
        let rise = self.slope + self.outward * self.taper / self.length.abs();
        let by_room = if rise > 0.0 { room.max(0.0) / rise } else { f64::INFINITY };
        let by_room = if self.outward == 0.0 { 0.0 } else { by_room };
        self.run_out = self.asked_run_out.min(by_room).min(self.length.abs() - advance).max(0.0);
    }

    /// The run-out made, when it is not the one asked for.
    pub(crate) fn shortened(&self) -> Option<Length> {
        (self.run_out < self.asked_run_out).then(|| Length::from_nm(self.run_out as i64))
    }

    /// One part of the pass that leaves `stock` on the root and starts `advance` further along Z.
    #[inline]
    pub(crate) fn leg(&self, part: Part, stock: f64, advance: f64, pass: u32) -> Option<ThreadLeg> {
        let forward = self.length.signum();
        let begin = self.end_v - self.length + forward * advance;
        let leave = self.end_v - forward * self.run_out;
        let to = match part {
            Part::Infeed => {
                let above = self.run_in.map_or(0.0, |(depth, _)| depth);
                self.on_line(begin, stock + above)
            }
            Part::RunIn => self.on_line(begin + forward * self.run_in.map_or(0.0, |(_, way)| way), stock),
            Part::Thread => self.on_line(leave, stock),
            Part::Chamfer => {
                let u = self.depth_axis(leave, stock) + self.outward * self.run_out * self.slope;
                self.plane.place_both_computed(u, self.end_v)
            }
            Part::Out => {
                // The start as it is given, only the other axis rounded.
                let end = self.plane.place_both_computed(self.end_u, self.end_v);
                let start = self.context.start;
                if self.plane.depth_is_x {
                    Position::new(start.x, end.z)
                } else {
                    Position::new(end.x, start.z)
                }
            }
            Part::Home => self.context.start,
            Part::Done => return None,
        };
        Some(ThreadLeg { part, to, pass, start_angle: self.start_angle, follows: leave != begin })
    }

    /// The move itself.
    #[inline]
    pub(crate) fn make(&self, leg: ThreadLeg) -> CycleMove {
        let ThreadLeg { part, to, pass, start_angle, follows } = leg;
        let threaded = |lead, is_chained, phase| CycleMove {
            action: Action::Thread { to, shape: Shape::Line, lead, lead_end: None, start_angle, is_chained },
            phase,
            pass,
            element: None,
        };
        let rapid = |phase| CycleMove { action: self.context.rapid(to), phase, pass, element: None };
        match (part, self.pull_out_feed) {
            (Part::Infeed, _) => rapid(Phase::Infeed),
            (Part::RunIn, _) => {
                let slope = self.run_in.map_or(0.0, |(depth, way)| depth / way);
                threaded(self.slanted_lead(slope), false, Phase::Thread)
            }
            (Part::Thread, _) => threaded(self.lead, self.run_in.is_some(), Phase::Thread),
            (Part::Chamfer, _) => threaded(self.slanted_lead(self.slope), follows, Phase::Chamfer),
            (Part::Out, Some(feed)) => {
                let feed = Feed::PerMinute(feed);
                let action = Action::Feed { to, shape: Shape::Line, feed, others: None };
                CycleMove { action, phase: Phase::Out, pass, element: None }
            }
            (Part::Out, None) => rapid(Phase::Out),
            (Part::Home | Part::Done, _) => rapid(Phase::Home),
        }
    }

    /// u of the line at v.
    fn depth_axis(&self, v: f64, stock: f64) -> f64 {
        self.end_u + self.outward * stock + self.taper * ((self.end_v - v) / self.length)
    }

    fn on_line(&self, v: f64, stock: f64) -> Position<WorkTip> {
        self.plane.place_both_computed(self.depth_axis(v, stock), v)
    }

    /// Lead along the longer axis of a run-in or run-out, so that v keeps the pace it has in the thread.
    fn slanted_lead(&self, slope: f64) -> Lead {
        let steep = (self.taper / self.length).abs();
        if steep <= 1.0 && slope <= 1.0 {
            return self.lead;
        }
        let along_v = nm(self.lead.0) / steep.max(1.0);
        let lead = (along_v * slope.max(1.0)).round().clamp(1.0, 1e16);
        Lead(Length::from_nm(lead as i64))
    }
}

const fn nm(length: Length) -> f64 {
    length.to_nm_float()
}

/// Tangent of an angle in whole degrees, 0 standing for 45.
fn tangent(degrees: u8) -> f64 {
    // Exactly 1 for the usual angle: a last digit of the tangent must not decide a rounding.
    if degrees == 0 || degrees == 45 { 1.0 } else { libm::tan(f64::from(degrees).to_radians()) }
}

fn half_angle_tangent(degrees: u8) -> f64 {
    if degrees == 90 { 1.0 } else { libm::tan((f64::from(degrees) / 2.0).to_radians()) }
}

#[cfg(test)]
mod tests {
    use turnwright_canon::RapidPath;
    use turnwright_units::{Feed, FeedPerRevolution, LeastIncrement};

    use super::*;

    fn um(micrometres: i64) -> Radius {
        Radius(Length::from_nm(micrometres * 1_000))
    }

    fn request() -> ThreadRequest {
        let context = Context {
            start: Position::new(um(12_500), Length::from_mm(5)),
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(Length::ZERO)),
            rapid: RapidPath::EachAxis,
        };
        ThreadRequest {
            context,
            end: Position::new(um(8_700), Length::from_mm(-20)),
            taper: Radius::ZERO,
            height: um(1_300),
            first_depth: um(400),
            min_depth: um(100),
            finishing_allowance: um(50),
            finishing_passes: 2,
            run_out: Length::from_mm(2),
            run_out_angle_deg: 0,
            run_out_depth: None,
            pull_out_feed: None,
            nose_angle_deg: 60,
            lead: Lead(Length::from_mm(2)),
            start_angle: Angle::ZERO,
            starts: 1,
            depths: DepthLaw::EqualArea(Clamp::Accumulate),
            infeed: FlankInfeed::WithCut,
        }
    }

    fn refused(request: ThreadRequest) -> Misuse {
        thread(request).map(|_| ()).expect_err("refused")
    }

    #[test]
    fn each_wrong_word_has_its_name() {
        let zero = Radius::ZERO;
        assert_eq!(refused(ThreadRequest { height: zero, ..request() }), Misuse::HeightNotPositive);
        assert_eq!(refused(ThreadRequest { first_depth: zero, ..request() }), Misuse::FirstDepthNotPositive);
        assert_eq!(refused(ThreadRequest { min_depth: um(-1), ..request() }), Misuse::MinDepthNegative);
        assert_eq!(refused(ThreadRequest { min_depth: um(1_301), ..request() }), Misuse::MinDepthAboveHeight);
        assert_eq!(
            refused(ThreadRequest { finishing_allowance: um(-1), ..request() }),
            Misuse::AllowanceNegative
        );
        let all = ThreadRequest { finishing_allowance: um(1_300), ..request() };
        assert_eq!(refused(all), Misuse::AllowanceNotBelowHeight);
        assert_eq!(refused(ThreadRequest { finishing_passes: 0, ..request() }), Misuse::FinishingPassesZero);
        assert_eq!(refused(ThreadRequest { nose_angle_deg: 180, ..request() }), Misuse::NoseAngle);
        assert_eq!(refused(ThreadRequest { run_out_angle_deg: 90, ..request() }), Misuse::RunOutAngle);
        assert_eq!(
            refused(ThreadRequest { run_out: Length::from_mm(-1), ..request() }),
            Misuse::RunOutNegative
        );
        assert_eq!(refused(ThreadRequest { lead: Lead(Length::ZERO), ..request() }), Misuse::LeadNotPositive);
        let flat = Position::new(um(8_700), Length::from_mm(5));
        assert_eq!(refused(ThreadRequest { end: flat, ..request() }), Misuse::NoThread);
        let short = Position::new(um(8_700), Length::from_nm(4_500_000));
        assert_eq!(refused(ThreadRequest { end: short, ..request() }), Misuse::ThreadTooShort);
    }

    #[test]
    fn both_readings_of_the_least_depth() {
        let depths = |clamp| {
            let law = DepthLaw::EqualArea(clamp);
            let schedule = depth_schedule(um(1_300), um(400), um(100), um(50), 1, law).expect("depths");
            schedule.map(|depth| (depth * 1e4).round() as i64).collect::<Vec<_>>()
        };
        let accumulate = [4_000, 5_657, 6_928, 8_000, 9_000, 10_000, 11_000, 12_000, 12_500, 13_000];
        assert_eq!(depths(Clamp::Accumulate), accumulate);
        let formula = [4_000, 5_657, 6_928, 8_000, 9_000, 9_944, 10_798, 11_583, 12_314, 12_500, 13_000];
        assert_eq!(depths(Clamp::Formula), formula);
    }

    #[test]
    fn without_allowance_the_finishing_passes_follow_the_full_depth() {
        let schedule =
            depth_schedule(um(500), um(600), um(0), um(0), 2, DepthLaw::EqualSteps).expect("depths");
        assert_eq!(schedule.collect::<Vec<_>>(), [0.5, 0.5, 0.5]);
    }

    #[test]
    fn equal_steps_go_down_by_the_first_depth() {
        let law = DepthLaw::EqualSteps;
        let schedule = depth_schedule(um(1_000), um(300), um(100), um(50), 1, law).expect("depths");
        let depths = schedule.map(|depth| (depth * 1e4).round() as i64).collect::<Vec<_>>();
        assert_eq!(depths, [3_000, 6_000, 9_000, 9_500, 10_000]);
    }

    /// Z where each pass begins, from the start point in the direction of the cut, micrometres.
    fn ways(infeed: FlankInfeed) -> Vec<i64> {
        // With 90 degrees the way along Z is the depth: 0.4, 0.8, 1.2, 1.25, 1.3 mm.
        let depths = DepthLaw::EqualSteps;
        let asked = ThreadRequest { infeed, depths, nose_angle_deg: 90, finishing_passes: 1, ..request() };
        let passes = thread(asked).expect("a thread").filter(|step| step.phase == Phase::Infeed);
        passes
            .filter_map(|step| step.action.end_point())
            .map(|to| (Length::from_mm(5) - to.z).nm() / 1_000)
            .collect()
    }

    #[test]
    fn passes_lie_on_the_flanks_that_are_asked_for() {
        assert_eq!(ways(FlankInfeed::Centre), [0; 5]);
        assert_eq!(ways(FlankInfeed::WithCut), [400, 800, 1_200, 1_250, 1_300]);
        assert_eq!(ways(FlankInfeed::AgainstCut), [-400, -800, -1_200, -1_250, -1_300]);
        // Mirrored about the finishing path at 1.3: as far on one side as on the other.
        assert_eq!(ways(FlankInfeed::BothFlanks), [400, 1_800, 1_200, 1_350, 1_300]);
        assert_eq!(ways(FlankInfeed::FlankAndCentre), [400, 1_300, 1_200, 1_300, 1_300]);
    }

    #[test]
    fn each_depth_is_cut_once_a_start() {
        let asked = ThreadRequest { starts: 3, start_angle: Angle::from_millidegrees(90_000), ..request() };
        let mut passes = Vec::new();
        for step in thread(asked).expect("a thread").filter(|step| step.phase == Phase::Thread) {
            if let Action::Thread { to, start_angle, .. } = step.action {
                passes.push((step.pass, to.x, start_angle.millidegrees()));
            }
        }
        assert_eq!(passes.len(), 33);
        for (place, (pass, x, angle)) in passes.iter().enumerate() {
            assert_eq!(*pass as usize, place + 1);
            assert_eq!(*angle, [90_000, 210_000, 330_000][place % 3]);
            assert_eq!(*x, passes[place / 3 * 3].1);
        }
    }

    #[test]
    fn the_run_out_ends_at_the_programmed_end() {
        let cycle = thread(request()).expect("a thread");
        assert_eq!(cycle.run_out_shortened(), None);
        let pass: Vec<_> = cycle.take(3).map(|step| (step.phase, step.action.end_point())).collect();
        assert_eq!(pass[1], (Phase::Thread, Some(Position::new(um(9_600), Length::from_mm(-18)))));
        assert_eq!(pass[2], (Phase::Chamfer, Some(Position::new(um(11_600), Length::from_mm(-20)))));
    }

    #[test]
    fn a_run_out_that_does_not_fit_is_shortened() {
        // Crest of the first pass at radius 9.6, start at 12.5: 2.9 mm of room.
        let asked = ThreadRequest { run_out: Length::from_mm(4), ..request() };
        let cycle = thread(asked).expect("a thread");
        assert_eq!(cycle.run_out_shortened(), Some(Length::from_nm(2_900_000)));
        let mut ends =
            cycle.filter(|step| step.phase == Phase::Chamfer).filter_map(|step| step.action.end_point());
        assert!(ends.all(|to| to.x <= asked.context.start.x && to.z == asked.end.z));
    }

    #[test]
    fn a_tapered_thread_is_shifted_bodily() {
        let asked =
            ThreadRequest { taper: um(-1_000), nose_angle_deg: 0, run_out: Length::ZERO, ..request() };
        let starts = |phase| {
            let cycle = thread(asked).expect("a thread");
            cycle.filter(move |step| step.phase == phase).filter_map(|step| step.action.end_point())
        };
        for (begin, end) in starts(Phase::Infeed).zip(starts(Phase::Thread)) {
            assert_eq!(begin.x - end.x, um(-1_000));
        }
    }
}
