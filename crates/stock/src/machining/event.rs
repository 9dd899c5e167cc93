//! What happens to tools and stock besides cutting.

use turnwright_canon::Origin;
use turnwright_geometry::Point;

use crate::removed::Contact;

/// Something that a machinist wants to know of before it happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// What.
    pub kind: EventKind,
    /// Which words caused it.
    pub origin: Origin,
    /// Where the programmed point is when it begins, mm.
    pub place: Point,
    /// Where the shapes overlap, and how far; of a piece that was cut off, the piece.
    pub contact: Option<Contact>,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A cutting edge goes into the stock at rapid traverse.
    RapidIntoStock,
    /// Holder or shank go into the stock.
    BodyIntoStock,
    /// Any part of the tool goes into what stands around.
    IntoObstacle(Obstacle),
    /// A cut in stock that does not turn.
    SpindleStopped,
    /// A cut that is no turning, with an axis beside X and Z: it is not shown in the section.
    NotTurned,
    /// A piece has lost its hold, and is gone.
    CutOff,
    /// A cut with a tool whose shape is not known; nothing is taken away.
    NoShape {
        /// Its number.
        tool: u32,
    },
}

/// What stands around the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Obstacle {
    /// The body of the chuck.
    Chuck,
    /// Its jaws.
    Jaws,
    /// Centre and quill.
    Tailstock,
}
