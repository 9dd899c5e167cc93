//! The nose of the tool: its radius, and where the imaginary tip lies from its centre.
//!
//! The direction is the tip number of the offset in force: 1 to 4 are the corners of the square around the nose, 5 to 8
//! the middles of its sides, 0 and 9 its centre.
//!
//! ```text
//!  X   2  6  1
//!  |   7  0  5
//!  +-- 3  8  4   Z
//! ```
//!
//! Source: nose radius, tip numbers, both families.

use turnwright_units::{Displacement, Length, Position, Radius, WorkNose, WorkTip};

use crate::machine::Core;

/// A nose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Nose {
    /// As the offset has it: below zero the sides of the path are exchanged.
    pub(crate) radius: Length,
    tip: u8,
}

impl Nose {
    /// From its centre to the imaginary tip.
    pub(crate) const fn to_tip(self) -> Displacement<WorkTip> {
        let (z, x) = match self.tip {
            1 => (1, 1),
            2 => (-1, 1),
            3 => (-1, -1),
            4 => (1, -1),
            5 => (1, 0),
            6 => (0, 1),
            7 => (-1, 0),
            8 => (0, -1),
            _ => (0, 0),
        };
        let radius = self.radius.abs();
        Displacement::new(Radius(radius.times(x)), radius.times(z))
    }

    /// It has no radius or no tip number: compensation changes nothing, or takes the centre for the tip.
    pub(crate) const fn is_unset(self) -> bool {
        self.radius.is_zero() || self.tip == 0
    }

    /// The centre while the tip is at a place.
    pub(crate) fn centre(self, tip: Position<WorkTip>) -> Position<WorkNose> {
        let way = self.to_tip();
        Position::new(tip.x - way.x, tip.z - way.z)
    }
}

impl Core {
    /// The nose of the offset in force.
    pub(crate) const fn nose(&self) -> Nose {
        let offset = &self.modal.offset_in_force;
        Nose { radius: if self.has_sharp_noses { Length::ZERO } else { offset.nose_radius }, tip: offset.tip }
    }
}
