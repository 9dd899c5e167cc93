//! The bar as it is cut: the axial half-section with exact lines and arcs, and what tools do to it.
//!
//! In: outlines of blanks and tools ([`turnwright_geometry::Outline`]), and the ways of tools. Out: the section that is
//! left ([`Section`]), what each sweep took or would hit ([`Removed`], [`Contact`]), pieces that came off, contours.
//!
//! A section is a row of *slabs* along Z; a slab is a stack of *bands* of material, each from a *floor* to a *roof*, which
//! are lines or half circles. That holds every shape: bores, face grooves, undercuts, several bodies. A cut is worked out
//! column by column, where it is a matter of comparing numbers; so it always leaves a section, however edges touch,
//! overlap or nearly do, as they do all day in turning.
//!
//! Invariants: edges keep the numbers of the cut that made them; X is a radius and never below the axis; every number
//! is finite; a cut costs what lies in its window, not what the section holds, and allocates nothing once its memory
//! has grown. Edges nearer than [`WELD_MM`] are one.
//!
//! [`Machining`] applies canonical commands to a section and tells of crashes; [`History`] remembers the section along
//! them.
//!
//! Deliberately not here: frames and offsets, feeds and time, pixels, words.

mod band;
mod chain;
mod contour;
mod curve;
mod cutter;
mod decompose;
mod gauge;
pub mod history;
mod knife;
pub mod machining;
mod pieces;
mod removed;
mod row;
mod section;
mod shave;
mod slide;
mod sweep;
mod swing;

pub use contour::Contour;
pub use cutter::{Cutter, HOLLOW_MM};
pub use gauge::{Beside, Reach};
pub use history::History;
pub use machining::Machining;
pub use pieces::Piece;
pub use removed::{Contact, Removed};
pub use section::{Section, SectionFault};
pub use sweep::Sweep;

/// Edges nearer to each other than this are one: a picometre. It lies between the rounding of the numbers, some 1e-13 mm,
/// and the nanometre of exact lengths, 1e-6 mm, so that it neither keeps the one nor loses the other.
pub const WELD_MM: f64 = 1e-9;
