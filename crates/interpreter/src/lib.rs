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
mod coordinates;
mod corner;
mod data_list;
mod figure;
mod flow;
mod functions;
mod in_force;
pub mod limits;
mod machine;
mod modal;
mod moves;
mod offsets;
mod parts;
mod plane;
mod punch;
mod report;
mod reset;
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
pub use machine::{Interpreter, Options, Step, SyncReason};
pub use parts::Parts;
pub use punch::{DataFault, DataImport, export_offsets, export_work_zeros, import_data};
pub use text::LINE_BYTES_MAX;
use turnwright_diagnostics::SourceId;

/// Why a text could not be read; the caller knows more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadFault;

/// The world outside: texts and switches.
pub trait Environment {
    /// Reads bytes of a text from an offset on; 0 bytes at its end.
    ///
    /// # Errors
    /// [`ReadFault`] when the text cannot be read; the interpreter ends with an alarm.
    fn read(&mut self, source: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault>;

    /// Whether a block skip switch (1 to 9) is on. Asked when a block is read.
    fn skips(&self, switch: u8) -> bool;

    /// Whether the optional stop is on.
    fn stops_optionally(&self) -> bool {
        false
    }
}
