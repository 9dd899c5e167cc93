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
//! This first model knows no acceleration of the axes: what it leaves out or assumes is named in
//! [`ESTIMATES`], so that a report can say so. Deliberately not here: text, alarms, look-ahead.

mod axes;
mod clock;
mod path;
mod rates;
mod spindle;
mod summary;
mod surface;

pub use clock::{Clock, Kind, RpmRange, Timing, Totals};
pub use path::ArcPath;
pub use rates::{MachineRates, RapidSurfaceSpeed};
pub use spindle::RPM_FENCE;
pub use summary::{Extents, OPERATIONS_MAX, Operation, OperationKind, Summary};

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
    // Stops count no time: they last as long as the operator wants.
    "stops-left-out",
];
