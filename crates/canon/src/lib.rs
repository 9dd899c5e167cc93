//! The canonical commands: the narrow waist between language and motion.
//!
//! In: what the interpreter and the cycles decided. Out: one closed enum, [`Action`], that preview, time,
//! simulation, expander and machine all read, each command with the [`Origin`] that it came from.
//!
//! Invariants: positions are exact and in the frame [`WorkTip`]; X is a radius; moves of no length do not
//! exist; no address letter and no control name is here, and a code number occurs only as the label that a
//! person typed ([`CycleLabel`]).

mod axes;
mod curve;
mod listing;

pub use axes::{Interpolation, OtherAxes, SectionPlace, SidePlane, SidePoint, SpeedRatio};
pub use curve::Curve;
pub use listing::write_listing;
use turnwright_units::{
    Angle, Feed, Lead, Position, Revolutions, Rpm, Seconds, SurfaceSpeed, WorkNose, WorkTip,
};

/// One command and where it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// What is to be done.
    pub action: Action,
    /// Which words asked for it.
    pub origin: Origin,
    /// Where the centre of the tool nose is at the end of a move, while nose compensation is on; boxed, so that the
    /// moves of every day stay small.
    pub nose: Option<Box<Position<WorkNose>>>,
}

impl Command {
    /// A command without nose compensation.
    #[inline]
    pub const fn new(action: Action, origin: Origin) -> Self {
        Self { action, origin, nose: None }
    }
}

/// Everything that a program can ask of the machine.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Positioning at rapid traverse.
    Rapid {
        /// End point.
        to: Position<WorkTip>,
        /// How the axes share the way.
        path: RapidPath,
        /// Axes beyond X and Z that go along.
        others: Option<Box<OtherAxes>>,
    },
    /// A cutting move.
    Feed {
        /// End point.
        to: Position<WorkTip>,
        /// Line or arc.
        shape: Shape,
        /// Tangential feed.
        feed: Feed,
        /// Axes beyond X and Z that go along.
        others: Option<Box<OtherAxes>>,
    },
    /// A move in step with the spindle.
    Thread {
        /// End point.
        to: Position<WorkTip>,
        /// Line or arc; an arc stays within the quarter of its circle in which one axis is the long one.
        shape: Shape,
        /// Lead along the long axis at the start.
        lead: Lead,
        /// Lead at the end, when it varies: it changes evenly with the revolutions. Boxed, as few threads do that.
        lead_end: Option<Box<Lead>>,
        /// Spindle angle at which the thread starts: of a chain, its first move.
        start_angle: Angle,
        /// The thread goes on from the move before without a stop; otherwise the move waits until the spindle
        /// has come to the start angle.
        is_chained: bool,
    },
    /// The tool stands where it stood, and that place has other coordinates from here on: a coordinate preset,
    /// another work system, another tool offset. Nothing moves.
    Relocate {
        /// The same place in the new coordinates.
        to: Position<WorkTip>,
        /// The places of other axes that have new coordinates.
        others: Option<Box<OtherAxes>>,
    },
    /// What the coordinates of the moves from here on mean.
    Interpolation(Interpolation),
    /// Another rotation is coupled to the spindle in a fixed ratio, or, with `None`, uncoupled.
    Coupling(Option<SpeedRatio>),
    /// From here on the spindle is led with a tap, or no more: it turns only while the tap moves, in step with it, and
    /// both come to rest together. Threads are then the ways of the tap.
    RigidTapping(bool),
    /// From here on the speed of the spindle is watched, or, with `None`, no more.
    SpindleWatch(Option<SpindleWatch>),
    /// Switches of the operator's panel that do nothing from here on.
    PanelLock(PanelLock),
    /// How moves meet from here on.
    PathMode(PathMode),
    /// Standing still; the tool comes to rest also when the time is zero.
    Dwell(Dwell),
    /// New state of the spindle.
    Spindle {
        /// Turning or not, and which way.
        state: SpindleState,
        /// How the speed is held.
        speed: SpindleSpeed,
        /// Upper limit of the speed, when one is set.
        rpm_max: Option<Rpm>,
    },
    /// A tool and its offset are called.
    Tool {
        /// Turret station.
        tool: u32,
        /// Offset number; 0 cancels.
        offset: u32,
    },
    /// Coolant.
    Coolant(Coolant),
    /// Any auxiliary function that only the machine's own logic knows.
    Auxiliary {
        /// Its number.
        code: u32,
    },
    /// The second auxiliary function, which only the machine's own logic knows.
    SecondAuxiliary {
        /// Its letter: `B` as a rule.
        letter: u8,
        /// Its number.
        code: u32,
    },
    /// Wait for cycle start.
    Stop,
    /// Wait for cycle start when the operator has chosen to.
    OptionalStop,
    /// The program is over.
    End,
    /// Words for the operator.
    Message(Box<str>),
    /// A line that the program writes to an outside device.
    Output(Box<str>),
}

/// How the axes share a rapid move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapidPath {
    /// Each axis at its own rapid rate; the shorter way ends first (dog-leg).
    EachAxis,
    /// A straight line in the shortest time.
    Straight,
    /// The way to a reference point: as [`RapidPath::EachAxis`], at the rates of the reference return.
    Home,
}

impl RapidPath {
    /// Whether the path is a straight line; else the shorter way ends first.
    pub const fn is_straight(self) -> bool {
        matches!(self, Self::Straight)
    }
}

/// The form of a cutting move. Start and end are exact; the radius is the distance of the centre from them.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line,
    /// An arc about `centre`.
    Arc {
        /// Which way, seen with Z to the right and X up.
        turn: Turn,
        /// Centre of the circle.
        centre: Position<WorkTip>,
    },
    /// An arc in a plane that holds the side axis (see [`SidePlane`]); the end's place on that axis is in the
    /// move's [`OtherAxes`]. Way of an axis outside the plane is spread evenly over the arc.
    SideArc {
        /// Which plane.
        plane: SidePlane,
        /// Which way, seen with the plane's first axis to the right and its second up.
        turn: Turn,
        /// Centre of the circle.
        centre: SidePoint,
    },
    /// A part of another conic; boxed, so that the moves of every day stay small.
    Curve(Box<Curve>),
}

impl Shape {
    /// The word of the trace format.
    pub const fn word(&self) -> &'static str {
        let (clockwise, counter_clockwise, turn) = match self {
            Self::Line => return "line",
            Self::Arc { turn, .. } | Self::SideArc { turn, .. } => ("cw", "ccw", *turn),
            Self::Curve(curve) => match **curve {
                Curve::Ellipse { turn, .. } => ("ellipse-cw", "ellipse-ccw", turn),
                Curve::Parabola { turn, .. } => ("parabola-cw", "parabola-ccw", turn),
            },
        };
        match turn {
            Turn::Clockwise => clockwise,
            Turn::CounterClockwise => counter_clockwise,
        }
    }
}

/// The way an arc turns, seen with Z to the right and X up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Turn {
    /// Clockwise.
    Clockwise,
    /// Counter-clockwise.
    CounterClockwise,
}

/// How one cutting move meets the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PathMode {
    /// The next move may begin before the tool has come to rest: corners are rounded a little.
    #[default]
    Continuous,
    /// Each move comes to rest in position before the next begins. Moves of cycles keep their own rule.
    ExactStop,
    /// As continuous, with overrides and feed hold out of action.
    Tapping,
}

/// A pause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dwell {
    /// By the clock.
    Time(Seconds),
    /// By the spindle.
    Turns(Revolutions),
}

/// Spindle on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SpindleState {
    /// Turning clockwise, seen from behind the chuck.
    Clockwise,
    /// Turning counter-clockwise.
    CounterClockwise,
    /// Standing.
    #[default]
    Stop,
}

/// How the spindle speed is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleSpeed {
    /// Fixed.
    Constant(Rpm),
    /// Following the diameter so that the tip sees this speed.
    Surface(SurfaceSpeed),
}

/// How the speed of the spindle is watched: an alarm comes when it is further off than all three limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpindleWatch {
    /// Behind a new order nobody looks before the speed is reached, but for no longer than this, ms.
    pub delay_ms: u32,
    /// A speed so near to the order counts as reached, per mille.
    pub reached_permille: u32,
    /// A speed that was reached may be off by so much, per mille.
    pub allowed_permille: u32,
    /// Smaller differences are no alarm.
    pub band: Rpm,
}

/// Which switches of the operator's panel a program has put out of action, or the control in a move that skips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PanelLock {
    /// Feed hold.
    pub hold: bool,
    /// Feed override: it counts as 100 %.
    pub feed_override: bool,
    /// Dry run: cuts go at their own feed.
    pub dry_run: bool,
}

/// Coolant on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coolant {
    /// Flowing.
    On,
    /// Not flowing.
    Off,
}

/// A cycle's code as the program wrote it, times ten: 710 for a person's `G71`, 71.1 would be 711.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CycleLabel(pub u16);

impl std::fmt::Display for CycleLabel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_multiple_of(10) {
            write!(f, "G{:02}", self.0 / 10)
        } else {
            write!(f, "G{:02}.{}", self.0 / 10, self.0 % 10)
        }
    }
}

/// What part a move plays in its cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// From the start point to the start point moved by the allowances.
    Approach,
    /// To the depth of the next pass.
    Infeed,
    /// The pass itself.
    Cut,
    /// Away from the work at 45 degrees, or along the figure.
    Escape,
    /// Back to where the next pass starts.
    Return,
    /// Once along the figure with allowance.
    Contour,
    /// Once along the figure itself.
    Finish,
    /// A peck.
    Peck,
    /// The small return after a peck.
    Back,
    /// Sideways from the bottom of a groove.
    Relief,
    /// To the next column or start.
    Shift,
    /// In step with the spindle.
    Thread,
    /// The run-out of a thread.
    Chamfer,
    /// Out of the work.
    Out,
    /// Back to the start point of the cycle.
    Home,
}

impl Phase {
    /// The word of the trace format.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Infeed => "infeed",
            Self::Cut => "cut",
            Self::Escape => "escape",
            Self::Return => "return",
            Self::Contour => "contour",
            Self::Finish => "finish",
            Self::Peck => "peck",
            Self::Back => "back",
            Self::Relief => "relief",
            Self::Shift => "shift",
            Self::Thread => "thread",
            Self::Chamfer => "chamfer",
            Self::Out => "out",
            Self::Home => "home",
        }
    }
}

/// Where a move stands in the cycle that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleOrigin {
    /// The cycle's code as written.
    pub label: CycleLabel,
    /// Number of the pass from 1; 0 before the first.
    pub pass: u32,
    /// What the move is for.
    pub phase: Phase,
}

/// Where a command came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Which program text.
    pub source: u32,
    /// Line in that text, from 1. For a move of a cycle: the line of the block that ran the cycle.
    pub line: u32,
    /// Line of the figure block that gave the move its shape, when that is another one.
    pub figure_line: Option<u32>,
    /// Sequence number of the block at `line`.
    pub sequence: Option<u32>,
    /// Program number.
    pub program: Option<u32>,
    /// Call depth, 0 in the main program.
    pub depth: u8,
    /// The cycle, when one made the command.
    pub cycle: Option<CycleOrigin>,
    /// In single-block operation the control does not stop behind this command, but behind a later one.
    pub runs_on: bool,
}

impl Origin {
    /// The origin of a block outside any cycle.
    pub const fn line(line: u32) -> Self {
        Self {
            source: 0,
            line,
            figure_line: None,
            sequence: None,
            program: None,
            depth: 0,
            cycle: None,
            runs_on: false,
        }
    }
}

impl Action {
    /// The end point of a move, `None` for everything else.
    pub const fn end_point(&self) -> Option<Position<WorkTip>> {
        match self {
            Self::Rapid { to, .. } | Self::Feed { to, .. } | Self::Thread { to, .. } => Some(*to),
            _ => None,
        }
    }

    /// Where the axes beyond X and Z that a move takes along end.
    pub fn others(&self) -> Option<&OtherAxes> {
        match self {
            Self::Rapid { others, .. } | Self::Feed { others, .. } => others.as_deref(),
            _ => None,
        }
    }
}
