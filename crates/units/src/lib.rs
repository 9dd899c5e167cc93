//! Exact quantities of a turning centre.
//!
//! In: whole numbers of least increments, or computed millimetres with a named rounding.
//! Out: types that cannot be mixed up: a [`Diameter`] is not a [`Radius`], a position in one [`Frame`]
//! is not a position in another, a feed per minute is not a feed per revolution.
//!
//! Every length is a whole number of nanometres in an `i64`. One nanometre divides every least input
//! increment of the controls (IS-A, IS-B, IS-C, metric and inch) and half of each, so that a programmed
//! diameter always has an exact radius. Arithmetic saturates at the end of the range (9.2 million km)
//! instead of wrapping or panicking; programs are refused long before.
//!
//! Deliberately not here: words, control state, geometry (that is `f64` millimetres in `geometry`).

mod feed;
mod length;
mod number;
mod position;

pub use feed::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Revolutions, Rpm, Seconds, SurfaceSpeed,
};
pub use length::{Diameter, LeastIncrement, Length, Radius};
pub use number::{write_degrees, write_fixed, write_millimetres, write_whole};
pub use position::{Displacement, Frame, MachineTurret, Position, Shift, WorkNose, WorkTip};
