//! How long the commands take: feeds, spindle speeds, rapids, threads, and what the program adds up to.
//!
//! In: canonical commands in order of execution and the rates of the machine ([`MachineRates`]).
//! Out: one [`Timing`] a command ([`Clock`]), and the operations, extents and totals of a program
//! ([`Summary`]).
//!
//! Invariants: every number is finite; nothing is allocated for a command; feed per revolution under constant
//! surface speed is integrated in closed form along lines and circles, split where a speed limit begins, so
//! the only error is that of floating point (relative [`TIME_TOLERANCE`]; spirals [`SPIRAL_TOLERANCE`]). Ellipses and
//! parabolas are measured as arcs that stay within a hundredth of a micrometre of them.
//!
//! With [`Dynamics`] the axes have acceleration and jerk: a [`Schedule`] plans the cuts ahead ([`planner`]). What the
//! times leave out or assume is named in [`ESTIMATES`] and [`ESTIMATES_WITH_DYNAMICS`], so that a report can say so.
//! Deliberately not here: text, alarms.

mod axes;
mod blocks;
mod clock;
mod corners;
mod dynamics;
mod feedrate;
mod gears;
mod leg;
mod orders;
mod panel;
mod path;
mod plain;
pub mod planner;
mod player;
mod rates;
mod run;
mod schedule;
mod smoother;
mod spindle;
mod summary;
mod surface;
mod tap;
mod thread;
mod thread_chain;
mod totals;

pub use blocks::{BlockTime, BlockTimes, LINES_MAX, LineTime};
pub use clock::{Clock, RpmRange, SpindleStray, Timing};
pub use dynamics::{AXIS_COUNT, AccDec, AxisDynamics, CORNER_S_MAX, Dynamics};
pub use gears::{Gear, GearSelection, Gears};
pub use leg::Place;
pub use panel::{Panel, PanelRules, RapidOverride, ThreadHold};
pub use path::ArcPath;
pub use player::{Player, Sample};
pub use rates::{AfterLaw, Arrival, AuxiliaryTimes, MachineRates, Orientation, RapidSurfaceSpeed, SpeedWait};
pub use run::LEGS_MAX;
pub use schedule::Schedule;
pub use spindle::{Fluctuation, RPM_FENCE};
pub use summary::{Extents, OPERATIONS_MAX, Operation, OperationKind, Summary};
pub use thread::{ThreadFault, ThreadNeed, ThreadPlan, ThreadStretch, lead_in_needed_mm, run_out_needed_mm};
pub use totals::{Kind, Totals};

/// Relative error of the seconds of lines, circles, threads, rapids and dwells against the model they follow.
pub const TIME_TOLERANCE: f64 = 1e-9;

/// Relative error of the seconds of arcs whose start and end lie at different distances from the centre, and of
/// ellipses and parabolas.
pub const SPIRAL_TOLERANCE: f64 = 1e-5;

/// What the times rest on besides the program: keys of sentences in the report.
pub const ESTIMATES: &[&str] = &[
    // Axes reach their rates at once: rapids and short cuts take longer on the machine.
    "axis-acceleration-left-out",
    // One constant for every change of the tool number, whatever the way of the turret.
    "tool-change-constant",
    // The spindle changes speed at a constant rate, a cut waits until it is there.
    "spindle-ramp-linear",
    // One constant for coolant and every other auxiliary function.
    "auxiliary-constant",
    // The wait for the one-turn signal before a thread, half a turn on average, is not counted.
    "thread-start-left-out",
    // A stop lasts as long as the operator wants; what the machine file says of stops and of a new piece is counted.
    "stops-and-loading-constant",
];

/// As [`ESTIMATES`], when the machine has [`Dynamics`].
pub const ESTIMATES_WITH_DYNAMICS: &[&str] = &[
    // Acceleration and jerk are those of the machine file; the drives follow without delay.
    "axis-acceleration-of-machine",
    "tool-change-constant",
    "spindle-ramp-linear",
    "auxiliary-constant",
    // The start angle of a thread comes round after half a turn.
    "thread-start-half-turn",
    "stops-and-loading-constant",
];
