//! The turning cycles as pure functions: a request goes in, moves come out.
//!
//! In: exact lengths (X words already radii), the captured [`Figure`] where a cycle has one, the [`Context`]
//! the cycle starts in, and named policies where controls differ. Out: an iterator of [`CycleMove`]s, made
//! lazily, owning everything it needs, allocating nothing per move; or a [`Misuse`] that the interpreter maps
//! to the alarm of the control.
//!
//! Rules for every cycle:
//! * every commanded point is computed exactly (nanometres, or `f64` where a root or tangent is involved) and
//!   rounded **once** to the least increment in use, X on the diameter; rounded values are never added up;
//! * a move that ends where the tool already stands is not made (a full circle is a move);
//! * no request panics or spins: what cannot be cut is a [`Misuse`], and `move_estimate` tells how much is asked
//!   for before the first move.
//!
//! Not here: words, modal state, numbers of codes or alarms, control names, feeds of figure blocks (the contour
//! pass runs at the feed of the cycle), nose radius compensation.
//!
//! ```
//! use turnwright_canon::{Phase, RapidPath};
//! use turnwright_cycles::{BoxRequest, Context, FirstAxis, box_cycle};
//! use turnwright_units::{Diameter, Feed, FeedPerRevolution, LeastIncrement, Length, Position};
//!
//! let at = |d, z| Position::new(Diameter(Length::from_mm(d)).to_radius(), Length::from_mm(z));
//! let context = Context {
//!     start: at(31, 1),
//!     increment: LeastIncrement::METRIC_B,
//!     feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000))),
//!     rapid: RapidPath::EachAxis,
//! };
//! let request = BoxRequest { context, first: FirstAxis::X, end: at(26, -25), taper: Length::ZERO };
//! let phases: Vec<Phase> = box_cycle(request).expect("in range").map(|step| step.phase).collect();
//! assert_eq!(phases, [Phase::Infeed, Phase::Cut, Phase::Out, Phase::Home]);
//! ```
//!
//! Source: the reference of the repetitive cycles, chapters 1 to 9, and of the single cycles.

mod figure;
mod groove;
mod heights;
mod hole;
mod misuse;
mod pattern;
mod plane;
mod pockets;
mod roughing;
mod semi_finish;
mod single;
mod threading;

pub use figure::{
    CutAlong, Element, Figure, FigureMotion, MonotonyFault, PlaneAxis, StartFault, Tolerance,
    hump_before_end, monotony_fault, pocket_count, start_inside_fault, turn_back_fault,
};
pub use groove::{Groove, GrooveRequest, PeckAxis, ReliefDirection, groove};
pub use hole::{Clamping, Hole, HoleRequest, HoleWork, Peck, PeckRetract, Tap, hole};
pub use misuse::Misuse;
pub use pattern::{Pattern, PatternRequest, SinglePass, pattern};
pub use pockets::{BottomEscape, Hump, PocketRequest, PocketRoughing, rough_pockets};
pub use roughing::{Coincident, EscapeSpeed, LevelOrigin, Monotony, RoughRequest, Roughing, rough};
pub use semi_finish::{SemiFinished, rough_and_semi_finish, rough_pockets_and_semi_finish};
pub use single::{
    BoxCycle, BoxRequest, FirstAxis, RunIn, ThreadOnce, ThreadOnceRequest, angle_of_start, box_cycle,
    taper_crosses_start, thread_once,
};
pub use threading::{
    Clamp, DepthLaw, DepthSchedule, FlankInfeed, ThreadRequest, Threading, depth_schedule, thread,
};

use turnwright_canon::{Action, Phase, RapidPath, Shape};
use turnwright_units::{Feed, LeastIncrement, Position, WorkTip};

/// One move of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleMove {
    /// The move itself; hole cycles also dwell, turn the spindle and clamp.
    pub action: Action,
    /// What it is for.
    pub phase: Phase,
    /// Pass, level or column it belongs to, from 1; 0 before the first. Stays at `u32::MAX` when there are more.
    pub pass: u32,
    /// Index of the figure element that gave the move its shape or stopped it.
    pub element: Option<u32>,
}

/// What a cycle takes from the state of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Context {
    /// Where the tool stands when the cycle is read (A): start and end of every cycle.
    pub start: Position<WorkTip>,
    /// The least increment in use; X is rounded to it on the diameter.
    pub increment: LeastIncrement,
    /// Feed of the cutting moves.
    pub feed: Feed,
    /// How the axes share a rapid move.
    pub rapid: RapidPath,
}

impl Context {
    pub(crate) const fn rapid(&self, to: Position<WorkTip>) -> Action {
        Action::Rapid { to, path: self.rapid, others: None }
    }

    pub(crate) const fn line(&self, to: Position<WorkTip>) -> Action {
        Action::Feed { to, shape: Shape::Line, feed: self.feed, others: None }
    }
}

/// A straight move before it is made. Cycles of many moves look at it first and build the [`CycleMove`] once, in
/// the place that it is given out from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) to: Position<WorkTip>,
    /// At rapid traverse, otherwise at the feed of the cycle.
    pub(crate) is_rapid: bool,
    pub(crate) phase: Phase,
    pub(crate) pass: u32,
    pub(crate) element: Option<u32>,
}

impl Leg {
    #[inline]
    pub(crate) const fn make(self, context: &Context) -> CycleMove {
        let Self { to, is_rapid, phase, pass, element } = self;
        if is_rapid {
            CycleMove { action: context.rapid(to), phase, pass, element }
        } else {
            CycleMove { action: context.line(to), phase, pass, element }
        }
    }
}

/// Knows where the tool stands, and so which moves have no length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tool {
    at: Position<WorkTip>,
}

impl Tool {
    pub(crate) const fn new(at: Position<WorkTip>) -> Self {
        Self { at }
    }

    /// Where it stands.
    pub(crate) const fn at(&self) -> Position<WorkTip> {
        self.at
    }

    /// Follows a straight move; false when it goes nowhere.
    #[inline]
    pub(crate) fn goes_to(&mut self, to: Position<WorkTip>) -> bool {
        let goes = to != self.at;
        self.at = to;
        goes
    }

    /// Follows the move; false when it goes nowhere. An arc back to its start is a full circle.
    pub(crate) fn goes(&mut self, step: &CycleMove) -> bool {
        let Some(to) = step.action.end_point() else { return true };
        let circle =
            matches!(&step.action, Action::Feed { shape: Shape::Arc { centre, .. }, .. } if *centre != to);
        let goes = circle || to != self.at || step.action.others().is_some();
        self.at = to;
        goes
    }
}

/// A pass counter as the moves carry it.
pub(crate) fn pass_number(pass: u64) -> u32 {
    u32::try_from(pass).unwrap_or(u32::MAX)
}
