//! Material between two edges.

use crate::curve::{Content, Curve};

/// Material from a floor, nearer to the axis, to a roof. Its ends along Z are those of its slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Band {
    pub(crate) floor: Curve,
    pub(crate) roof: Curve,
}

impl Band {
    /// Lowest and highest X between two Z.
    pub(crate) fn range(&self, from: f64, to: f64) -> (f64, f64) {
        (self.floor.range(from, to).0, self.roof.range(from, to).1)
    }

    pub(crate) fn content(&self, from: f64, to: f64) -> Content {
        self.roof.content(from, to) - self.floor.content(from, to)
    }

    /// Whether two bands are one between two Z.
    pub(crate) fn is_one_with(&self, other: &Self, from: f64, to: f64) -> bool {
        self.roof.is_one_with(&other.roof, from, to) && self.floor.is_one_with(&other.floor, from, to)
    }
}
