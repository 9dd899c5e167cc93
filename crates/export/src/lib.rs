//! What the program did, in forms that people and other programs read.
//!
//! In: canonical commands, one by one. Out: text and pictures, written into a buffer or returned; the caller
//! owns every file. One format, one file in [`formats`].
//!
//! [`path::PathRecorder`] keeps the moves that the pictures need; the line formats need no memory at all.
//! Deliberately not here: I/O, clocks, code numbers, control names, and any change of what is drawn: a
//! format shows the commands as they are.

pub mod formats;
pub mod mesh;
pub mod part;
pub mod passes;
pub mod path;
pub mod solid;
pub mod timeline;
mod words;
pub mod wound;

pub use words::Language;
