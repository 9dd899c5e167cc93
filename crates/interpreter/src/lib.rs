//! Blocks to commands: a resumable step machine.
//!
//! In: program text through [`Environment`], a [`Control`](turnwright_control::Control) and a
//! [`Setup`](turnwright_control::Setup). Out: one [`Step`] at a time, the caller owns the pace.
//!
//! Invariants:
//! * no I/O, no clock, no globals; memory does not grow with the length of the program;
//! * what is not understood is an alarm at the word, never passed over;
//! * every loop has a limit with a name (see [`limits`]);
//! * exactly one function turns an X-like word into a radius (`words.rs`).
//!
//! Life of one block: `text` finds the line, `turnwright_syntax` its words, `block` the functions and the order
//! of actions, `functions/` what each does; cycles give their moves one by one through `moves`.
//!
//! Deliberately not here: time, pictures, checks of good practice beyond what the block itself shows.

mod auxiliary;
mod axes;
mod block;
mod cache;
mod compensation;
mod coordinates;
mod corner;
mod data_list;
mod faults;
mod figure;
mod figure_checks;
mod flow;
mod functions;
mod in_force;
mod index;
mod leads;
pub mod limits;
mod machine;
mod macros;
mod modal;
mod moves;
mod offsets;
mod other_zeros;
mod parts;
mod plain;
mod plane;
mod punch;
mod queue;
mod reading;
mod report;
mod reset;
mod short;
mod spindle;
mod strokes;
mod text;
mod tool;
mod transform;
mod watch;
mod words;
mod zeros;

pub use functions::implemented_functions;
pub use in_force::GROUPS;
pub use index::ProgramName;
pub use machine::{GivenParameter, Interpreter, Options, Step, SyncReason};
pub use parts::Parts;
pub use punch::{DataFault, DataImport, export_offsets, export_work_zeros, import_data};
pub use text::LINE_BYTES_MAX;
use turnwright_diagnostics::SourceId;
use turnwright_units::{Position, WorkTip};

/// Why a text could not be read; the caller knows more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadFault;

/// A date and a time of day, as the machine's calendar has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are the documentation")]
pub struct DateTime {
    pub year: u16,
    pub month: u8,
    pub day: u8,
    pub hour: u8,
    pub minute: u8,
    pub second: u8,
}

/// A straight move that a signal may end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalMove {
    /// The line of its block.
    pub line: u32,
    /// The input that the program names.
    pub input: Option<u8>,
    /// Where it starts.
    pub from: Position<WorkTip>,
    /// Where it ends without a signal.
    pub to: Position<WorkTip>,
}

/// The world outside: texts, switches and signals.
pub trait Environment {
    /// Reads bytes of a text from an offset on; 0 bytes at its end.
    ///
    /// # Errors
    /// [`ReadFault`] when the text cannot be read; the interpreter ends with an alarm.
    fn read(&mut self, source: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault>;

    /// Whether a block skip switch (1 to 9) is on. Asked when a block is read.
    fn skips(&self, switch: u8) -> bool;

    /// A program that is not in the text in work: another file of the control's memory.
    fn program(&mut self, name: ProgramName<'_>) -> Option<SourceId> {
        let _ = name;
        None
    }

    /// The calendar of the machine; `None` when there is none to ask, and the variables of date and time are 0.
    fn now(&self) -> Option<DateTime> {
        None
    }

    /// Milliseconds since power-on.
    fn uptime_ms(&self) -> u64 {
        0
    }

    /// A signal from the machine's own logic to macros, 0 to 31.
    fn macro_input(&self, signal: u8) -> bool {
        let _ = signal;
        false
    }

    /// A signal from macros to the machine's own logic, 0 to 31.
    fn set_macro_output(&mut self, signal: u8, is_on: bool) {
        let _ = (signal, is_on);
    }

    /// Whether a signal asks for the program of a macro interrupt. Asked before each block while one is allowed.
    fn interrupts(&mut self) -> bool {
        false
    }

    /// After which part of a move (0 to 1) the signal that it waits for comes; `None` when it does not.
    fn signal(&mut self, wait: &SignalMove) -> Option<f64> {
        let _ = wait;
        None
    }

    /// Whether the optional stop is on.
    fn stops_optionally(&self) -> bool {
        false
    }
}
