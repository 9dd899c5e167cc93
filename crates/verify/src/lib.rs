//! What a whole program shows: the setup it was written for.
//!
//! In: the commands of a program, one by one, and a [`Setup`](turnwright_control::Setup). Out: what the setup leaves
//! open, taken from the program, with every [`Assumption`] told as data.
//!
//! Deliberately not here: the control's own alarms and warnings, which are the interpreter's; sentences, which are in
//! `data/`.

mod inference;

pub use inference::{Assumption, Inference, Inferred};
