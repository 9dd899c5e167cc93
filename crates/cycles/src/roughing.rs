//! Rough turning and rough facing of a figure that rises one way (type I): one procedure with the axes exchanged.
//!
//! In: a [`Figure`] and a [`RoughRequest`]. Out: level after level (infeed, cut along the level up to the figure,
//! escape at 45 degrees, return), then once along the figure, then home. Everything happens on the figure moved by
//! the allowances. Directions come from the figure: depth from the start to where the contour begins, the cut from
//! there to its end; so outside, inside, towards the chuck and away from it are one case.
//!
//! Decisions where the documents are silent: the approach may take several elements that go straight on, and the
//! infeed is rapid only when all of them are; without the contour pass the last infeed is left out as well; what
//! lies in a pocket is left for the contour pass.
//!
//! Not here: pockets (type II), nose radius compensation, the single finishing pass.
//! Source: rough turning and facing, type I, chapter 3 of the cycles, and rows 1 to 6, 9 and 28 of its chapter 13.

use turnwright_canon::Phase;
use turnwright_units::{Displacement, Length, Position, Radius, WorkTip};

use crate::figure::{LeadIn, Piece, cut_sign, lead_in, monotony_fault_of, profile, snap};
use crate::plane::{Plane, in_range};
use crate::{Context, CutAlong, CycleMove, Figure, Leg, Misuse, Tolerance, Tool, pass_number};

/// A level that lies exactly on a stretch of the figure parallel to the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coincident {
    /// Cut on to the far end of the stretch; leaves nothing on it for the contour pass.
    Through,
    /// Stop where the stretch begins; leaves a full depth of cut for the contour pass behind it.
    Stop,
}

/// Where the levels are counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelOrigin {
    /// From the start point moved by the allowances.
    ShiftedStart,
    /// From the start point itself.
    Start,
}

/// How fast the tool leaves a level at 45 degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EscapeSpeed {
    /// At the feed of the cycle.
    Feed,
    /// At rapid traverse.
    Rapid,
}

/// Whether a figure that turns back is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Monotony {
    /// Rough it as it is; what lies behind the first rise of a level is left for the contour pass.
    Ignore,
    /// Refuse it as [`Misuse::NotMonotone`].
    Check {
        /// Turning back by no more than this is forgiven.
        tolerance: Tolerance,
    },
}

/// The words of rough turning and facing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughRequest {
    /// State the cycle starts in.
    pub context: Context,
    /// The axis of the cuts.
    pub along: CutAlong,
    /// Depth of cut, along the other axis; a radius when that is X. More than zero.
    pub depth: Length,
    /// Escape on each axis, radius along X. Not negative.
    pub escape: Length,
    /// Finishing allowance along X, radius, signed.
    pub allowance_x: Radius,
    /// Finishing allowance along Z, signed.
    pub allowance_z: Length,
    /// Level on a parallel stretch.
    pub coincident: Coincident,
    /// Where levels are counted from.
    pub level_origin: LevelOrigin,
    /// Speed of the escape.
    pub escape_speed: EscapeSpeed,
    /// Whether the contour pass is made.
    pub semi_finish: bool,
    /// Whether the figure is checked.
    pub monotony: Monotony,
}

/// The moves of rough turning or facing.
#[derive(Clone, Debug)]
pub struct Roughing {
    figure: Figure,
    request: RoughRequest,
    plane: Plane,
    /// The allowances as commanded.
    shift: Displacement<WorkTip>,
    lead: LeadIn,
    profile: Profile,
    /// A′ as (u, v).
    origin: (i64, i64),
    /// Depth of the place that levels are counted from, below A′.
    level_zero: i64,
    /// Number of levels before the contour pass.
    levels: i64,
    /// −1 or 1: direction of the cut along v.
    forward: i64,
    level: i64,
    /// Where the cut of the present level ends along v, nanometres.
    cut_end: f64,
    tool: Tool,
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Approach,
    Infeed,
    Cut,
    Escape,
    Return,
    LastInfeed,
    Contour(usize),
    Home,
    Done,
}

/// Plans the roughing of `figure`.
///
/// # Errors
/// [`Misuse::DepthNotPositive`], [`Misuse::BelowIncrement`], [`Misuse::EscapeNegative`], [`Misuse::NoContour`],
/// [`Misuse::NotMonotone`], [`Misuse::StartMismatch`], [`Misuse::OutOfRange`].
pub fn rough(figure: Figure, request: RoughRequest) -> Result<Roughing, Misuse> {
    let plane = Plane::new(request.along == CutAlong::Z, request.context.increment);
    check_words(&request, &plane)?;
    let figure = figure.prepare(&request.context)?;
    let lead = lead_in(&figure, &plane).ok_or(Misuse::NoContour)?;
    let pieces = profile(&figure, &plane, &lead);
    let forward = cut_sign(&pieces).ok_or(Misuse::NoContour)?;
    if let Monotony::Check { tolerance } = request.monotony
        && let Some(fault) = monotony_fault_of(&pieces, request.along, tolerance, &lead)
    {
        return Err(Misuse::NotMonotone(fault));
    }
    let shift = allowance_shift(&request);
    let origin = plane.split(figure.start + shift);
    let level_zero = level_zero(&request, &plane, &lead, &figure, shift);
    let height = lead.depth_sign * (lead.end.0 - plane.split(figure.start).0) - level_zero;
    // The number of n ≥ 1 with n·depth < height: the level that reaches the contour is the contour pass.
    let levels = if height > 0 { (height - 1) / request.depth.nm() } else { 0 };
    let profile = Profile::new(pieces, plane.grid_u() / 2);
    let tool = Tool::new(request.context.start);
    Ok(Roughing {
        figure,
        request,
        plane,
        shift,
        lead,
        profile,
        origin,
        level_zero,
        levels,
        forward,
        level: 0,
        cut_end: 0.0,
        tool,
        next: Next::Approach,
    })
}

/// The allowances on the least increment.
pub(crate) fn allowance_shift(request: &RoughRequest) -> Displacement<WorkTip> {
    let none = Position::new(Radius::ZERO, Length::ZERO);
    let allowances = Displacement::new(request.allowance_x, request.allowance_z);
    snap(none + allowances, request.context.increment) - none
}

/// Depth below A′ of the place that levels are counted from.
pub(crate) fn level_zero(
    request: &RoughRequest,
    plane: &Plane,
    lead: &LeadIn,
    figure: &Figure,
    shift: Displacement<WorkTip>,
) -> i64 {
    match request.level_origin {
        LevelOrigin::ShiftedStart => 0,
        LevelOrigin::Start => {
            lead.depth_sign * (plane.split(figure.start).0 - plane.split(figure.start + shift).0)
        }
    }
}

pub(crate) fn check_words(request: &RoughRequest, plane: &Plane) -> Result<(), Misuse> {
    in_range(&[request.depth, request.escape, request.allowance_x.0, request.allowance_z])?;
    if request.depth.nm() <= 0 {
        return Err(Misuse::DepthNotPositive);
    }
    if request.depth.nm() < plane.grid_u() {
        return Err(Misuse::BelowIncrement);
    }
    if request.escape.nm() < 0 {
        return Err(Misuse::EscapeNegative);
    }
    Ok(())
}

impl Roughing {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        let levels = u64::try_from(self.levels).unwrap_or(0);
        levels.saturating_mul(4).saturating_add(self.figure.elements.len() as u64 + 3)
    }

    #[inline]
    fn leg(&mut self) -> Option<Leg> {
        Some(match self.next {
            Next::Approach => self.approach(),
            Next::Infeed => self.infeed(),
            Next::Cut => self.cut(),
            Next::Escape => self.escape(),
            Next::Return => self.back(),
            Next::LastInfeed => self.last_infeed(),
            Next::Home => self.home(),
            Next::Contour(_) | Next::Done => return None,
        })
    }

    fn approach(&mut self) -> Leg {
        self.next = self.after_level();
        let to = self.plane.place(self.origin.0, self.origin.1);
        Leg { to, is_rapid: true, phase: Phase::Approach, pass: 0, element: None }
    }

    fn infeed(&mut self) -> Leg {
        self.next = Next::Cut;
        let to = self.plane.place(self.level_u(), self.origin.1);
        self.tell(to, self.lead.rapid, Phase::Infeed, None)
    }

    fn cut(&mut self) -> Leg {
        self.next = Next::Escape;
        let (end, element) = self.end_of_cut();
        self.cut_end = end;
        self.tell(self.plane.place_computed(self.level_u(), end), false, Phase::Cut, element)
    }

    fn escape(&mut self) -> Leg {
        self.next = Next::Return;
        let back = self.cut_end - (self.forward * self.request.escape.nm()) as f64;
        let to = self.plane.place_computed(self.escaped_u(), back);
        self.tell(to, self.request.escape_speed == EscapeSpeed::Rapid, Phase::Escape, None)
    }

    fn back(&mut self) -> Leg {
        let to = self.plane.place(self.escaped_u(), self.origin.1);
        let leg = self.tell(to, true, Phase::Return, None);
        self.next = self.after_level();
        leg
    }

    fn last_infeed(&mut self) -> Leg {
        self.next = Next::Contour(self.lead.elements);
        let last = self.lead.elements - 1;
        let to = self.figure.end(last, self.shift);
        self.tell(to, self.lead.rapid, Phase::Infeed, Some(pass_number(last as u64)))
    }

    fn home(&mut self) -> Leg {
        self.next = Next::Done;
        self.tell(self.request.context.start, true, Phase::Home, None)
    }

    /// The next element of the contour pass; those without length are left out.
    fn contour(&mut self, from: usize) -> Option<CycleMove> {
        let mut index = from;
        while index < self.figure.elements.len() {
            let step = CycleMove {
                action: self.figure.cut(index, self.shift, &self.request.context),
                phase: Phase::Contour,
                pass: self.pass(),
                element: Some(pass_number(index as u64)),
            };
            index += 1;
            if self.tool.goes(&step) {
                self.next = Next::Contour(index);
                return Some(step);
            }
        }
        self.next = Next::Home;
        None
    }

    /// Counts on to the next level and says what comes first there.
    fn after_level(&mut self) -> Next {
        if self.level < self.levels {
            self.level += 1;
            Next::Infeed
        } else if self.request.semi_finish {
            self.level += 1;
            Next::LastInfeed
        } else {
            Next::Home
        }
    }

    /// Depth of the present level below A′.
    const fn level_depth(&self) -> i64 {
        self.level_zero.saturating_add(self.level.saturating_mul(self.request.depth.nm()))
    }

    const fn level_u(&self) -> i64 {
        self.origin.0.saturating_add(self.lead.depth_sign * self.level_depth())
    }

    const fn escaped_u(&self) -> i64 {
        self.level_u().saturating_sub(self.lead.depth_sign * self.request.escape.nm())
    }

    /// Where the present level meets the figure, and the element it meets; never behind the start.
    fn end_of_cut(&self) -> (f64, Option<u32>) {
        let (end, element) = self.profile.end_of_level(self.level_depth(), self.request.coincident);
        let moved = end + self.plane.split_lengths(self.shift.x, self.shift.z).1 as f64;
        let start = self.origin.1 as f64;
        let end = if self.forward > 0 { moved.max(start) } else { moved.min(start) };
        (end, element)
    }

    fn tell(&self, to: Position<WorkTip>, is_rapid: bool, phase: Phase, element: Option<u32>) -> Leg {
        Leg { to, is_rapid, phase, pass: self.pass(), element }
    }

    fn pass(&self) -> u32 {
        pass_number(u64::try_from(self.level).unwrap_or(0))
    }
}

impl Iterator for Roughing {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        loop {
            if let Some(leg) = self.leg() {
                if self.tool.goes_to(leg.to) {
                    return Some(leg.make(&self.request.context));
                }
            } else if let Next::Contour(index) = self.next {
                if let Some(step) = self.contour(index) {
                    return Some(step);
                }
            } else {
                return None;
            }
        }
    }
}

/// The contour, ready to be asked where a level ends.
#[derive(Clone, Debug)]
struct Profile {
    pieces: Vec<Piece>,
    /// The least depth up to the end of each piece: falls from piece to piece, so it can be searched by halving.
    least: Vec<i64>,
    /// Half of the least increment along the depth axis, nanometres.
    tolerance: i64,
}

impl Profile {
    fn new(pieces: Vec<Piece>, tolerance: i64) -> Self {
        let mut lowest = i64::MAX;
        let least = pieces
            .iter()
            .map(|piece| {
                lowest = lowest.min(piece.h1);
                lowest
            })
            .collect();
        Self { pieces, least, tolerance }
    }

    /// The first place where the figure rises above `level`, walking from its begin; its end when it never does.
    fn end_of_level(&self, level: i64, coincident: Coincident) -> (f64, Option<u32>) {
        let reached = match coincident {
            Coincident::Through => self.least.partition_point(|&depth| depth >= level - self.tolerance),
            Coincident::Stop => self.least.partition_point(|&depth| depth > level + self.tolerance),
        };
        let Some(piece) = self.pieces.get(reached) else {
            return (self.pieces.last().map_or(0.0, |last| last.v1 as f64), None);
        };
        let end = if piece.h0 <= level {
            piece.v0 as f64
        } else if piece.h1 <= level {
            piece.crossing(level)
        } else {
            // Within the tolerance below the level: as good as touched.
            piece.v1 as f64
        };
        (end, Some(piece.element))
    }
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{Action, RapidPath};
    use turnwright_units::{Feed, FeedPerRevolution, LeastIncrement};

    use super::*;
    use crate::{Element, FigureMotion, MonotonyFault, PlaneAxis};

    fn place(x: i64, z: i64) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(x * 1_000)), Length::from_nm(z * 1_000))
    }

    /// A figure from (30, 2) on, radius and Z in thousandths, its first element rapid.
    fn figure(to: &[(i64, i64)]) -> Figure {
        let motion = |index| if index == 0 { FigureMotion::Rapid } else { FigureMotion::Line };
        let element = |(index, &(x, z))| Element { to: place(x, z), motion: motion(index), line: 0 };
        Figure { start: place(30_000, 2_000), elements: to.iter().enumerate().map(element).collect() }
    }

    fn step_shaft() -> Figure {
        figure(&[(10_000, 2_000), (10_000, -20_000), (20_000, -20_000), (20_000, -40_000), (30_000, -40_000)])
    }

    fn request() -> RoughRequest {
        let context = Context {
            start: place(30_000, 2_000),
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000))),
            rapid: RapidPath::EachAxis,
        };
        RoughRequest {
            context,
            along: CutAlong::Z,
            depth: Length::from_mm(5),
            escape: Length::from_mm(1),
            allowance_x: Radius::ZERO,
            allowance_z: Length::ZERO,
            coincident: Coincident::Through,
            level_origin: LevelOrigin::ShiftedStart,
            escape_speed: EscapeSpeed::Feed,
            semi_finish: true,
            monotony: Monotony::Ignore,
        }
    }

    fn refused(figure: Figure, request: RoughRequest) -> Misuse {
        rough(figure, request).map(|_| ()).expect_err("refused")
    }

    fn ends_of(figure: Figure, request: RoughRequest, phase: Phase) -> Vec<Position<WorkTip>> {
        let cycle = rough(figure, request).expect("a cycle");
        cycle.filter(|step| step.phase == phase).filter_map(|step| step.action.end_point()).collect()
    }

    #[test]
    fn each_wrong_word_has_its_name() {
        let with = |depth, escape| {
            refused(
                step_shaft(),
                RoughRequest { depth: Length::from_nm(depth), escape: Length::from_nm(escape), ..request() },
            )
        };
        assert_eq!(with(0, 0), Misuse::DepthNotPositive);
        assert_eq!(with(-1_000_000, 0), Misuse::DepthNotPositive);
        assert_eq!(with(499, 0), Misuse::BelowIncrement);
        assert_eq!(with(1_000_000, -1), Misuse::EscapeNegative);
        assert_eq!(with(i64::MAX, 0), Misuse::OutOfRange);
        let elsewhere = Figure { start: place(30_000, 1_000), ..step_shaft() };
        assert_eq!(refused(elsewhere, request()), Misuse::StartMismatch);
    }

    #[test]
    fn a_figure_without_a_stretch_along_the_cut_is_no_contour() {
        assert_eq!(refused(figure(&[]), request()), Misuse::NoContour);
        assert_eq!(refused(figure(&[(10_000, 2_000)]), request()), Misuse::NoContour);
        assert_eq!(refused(figure(&[(10_000, 2_000), (20_000, 2_000)]), request()), Misuse::NoContour);
    }

    #[test]
    fn a_pocket_is_refused_only_when_asked() {
        let pocket = figure(&[(10_000, 2_000), (10_000, -9_000), (9_000, -12_000), (25_000, -12_000)]);
        let fault = MonotonyFault { axis: PlaneAxis::Second, element: 2 };
        let strict = RoughRequest { monotony: Monotony::Check { tolerance: Tolerance::EXACT }, ..request() };
        assert_eq!(refused(pocket.clone(), strict), Misuse::NotMonotone(fault));
        assert!(rough(pocket, request()).is_ok());
    }

    #[test]
    fn the_first_rise_ends_a_cut_even_before_a_pocket() {
        let hump = figure(&[
            (10_000, 2_000),
            (10_000, -9_000),
            (18_000, -9_000),
            (12_000, -15_000),
            (29_000, -30_000),
        ]);
        let asked = RoughRequest { depth: Length::from_mm(15), ..request() };
        assert_eq!(ends_of(hump, asked, Phase::Cut), [place(15_000, -9_000)]);
    }

    #[test]
    fn an_approach_in_two_elements_is_roughed_all_the_way_down() {
        let two = figure(&[(20_000, 2_000), (10_000, 2_000), (10_000, -20_000), (30_000, -20_000)]);
        let infeeds = ends_of(two.clone(), request(), Phase::Infeed);
        let expected = [25_000, 20_000, 15_000, 10_000].map(|x| place(x, 2_000));
        assert_eq!(infeeds, expected);
        // The second element is a cut, so no infeed may be rapid.
        let cycle = rough(two, request()).expect("a cycle");
        let mut infeeds = cycle.filter(|step| step.phase == Phase::Infeed);
        assert!(infeeds.all(|step| matches!(step.action, Action::Feed { .. })));
    }

    #[test]
    fn half_an_increment_counts_as_on_the_level() {
        // The cylinder at radius 20 lies 249 nm above or below the level; half an increment of X is 250 nm.
        let cut = |depth, coincident| {
            let asked = RoughRequest { depth: Length::from_nm(depth), coincident, ..request() };
            ends_of(step_shaft(), asked, Phase::Cut)[0].z
        };
        let (near, far) = (Length::from_mm(-20), Length::from_mm(-40));
        assert_eq!(cut(10_000_249, Coincident::Through), far);
        assert_eq!(cut(10_000_251, Coincident::Through), near);
        assert_eq!(cut(10_000_000, Coincident::Stop), near);
        assert_eq!(cut(9_999_751, Coincident::Stop), near);
        assert_eq!(cut(9_999_749, Coincident::Stop), far);
    }

    #[test]
    fn a_figure_that_comes_back_along_the_cut_takes_its_first_direction() {
        let back = figure(&[(10_000, 2_000), (10_000, -20_000), (20_000, -20_000), (20_000, 2_000)]);
        assert_eq!(ends_of(back, request(), Phase::Escape)[2], place(16_000, -19_000));
    }

    #[test]
    fn no_depth_leaves_only_the_contour() {
        let flat = figure(&[(30_000, 1_000), (30_000, -20_000)]);
        let cycle = rough(flat, request()).expect("a cycle");
        let phases: Vec<_> = cycle.map(|step| step.phase).collect();
        assert_eq!(phases, [Phase::Infeed, Phase::Contour, Phase::Home]);
    }
}
