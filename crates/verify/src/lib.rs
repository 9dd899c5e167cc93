//! What a whole program shows: faults that no single block has, the setup it was written for, the [`part`].
//!
//! In: the commands of a program, one by one, and a [`Setup`](turnwright_control::Setup). Out: warnings of the
//! [`Checks`], and what the setup leaves open, taken from the program, with every [`Assumption`] told as data.
//!
//! Deliberately not here: the control's own alarms and warnings, which are the interpreter's; sentences, which are in
//! `data/`.

pub mod advice;
mod alignment;
pub mod changes;
mod checks;
pub mod comparison;
pub mod cutting;
mod edges;
pub mod figures;
mod inference;
pub mod measuring;
pub mod part;
pub mod scene;
pub mod target;
mod text;
pub mod thread_ways;

pub use checks::{Checked, Checks};
pub use inference::{Assumption, Inference, Inferred};
pub use text::TextChecks;
