//! What a cut took away, and what a tool touches.

use turnwright_geometry::{Bounds, Point};

use crate::band::Band;

/// What a sweep took out of a section; the rectangle round it is the depth of cut in both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Removed {
    /// From the half-section, mm².
    pub area_mm2: f64,
    /// From the part, mm³.
    pub volume_mm3: f64,
    /// The rectangle round what was taken; nothing when nothing was.
    pub bounds: Option<Bounds>,
    /// What is left may have come apart: ask [`crate::Section::pieces`].
    pub may_part: bool,
    /// How many pieces of band were taken.
    pub(crate) count: u32,
}

/// Material in the way of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The rectangle round what would be taken away.
    pub bounds: Bounds,
    /// How deep the tool goes in: the shorter side of the rectangle.
    pub depth_mm: f64,
    /// What would be taken from the half-section, mm².
    pub area_mm2: f64,
    /// What would be taken from the part, mm³.
    pub volume_mm3: f64,
}

impl Removed {
    /// Whether anything was taken.
    pub const fn is_something(&self) -> bool {
        self.count > 0
    }

    pub(crate) fn add(&mut self, band: &Band, from: f64, to: f64) {
        let content = band.content(from, to);
        let (low, high) = band.range(from, to);
        self.count += 1;
        self.area_mm2 += content.area_mm2;
        self.volume_mm3 += content.volume_mm3;
        self.include(Point::new(low, from));
        self.include(Point::new(high, to));
    }

    fn include(&mut self, place: Point) {
        let none = Bounds { min: place, max: place };
        self.bounds = Some(self.bounds.map_or(none, |bounds| bounds.with(place)));
    }

    /// Both together.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        let mut both = Self {
            area_mm2: self.area_mm2 + other.area_mm2,
            volume_mm3: self.volume_mm3 + other.volume_mm3,
            bounds: self.bounds,
            may_part: self.may_part || other.may_part,
            count: self.count + other.count,
        };
        if let Some(bounds) = other.bounds {
            both.include(bounds.min);
            both.include(bounds.max);
        }
        both
    }

    pub(crate) fn contact(&self) -> Option<Contact> {
        Some(Contact::around(self.bounds?, self.area_mm2, self.volume_mm3))
    }
}

impl Contact {
    /// Of material with this rectangle round it.
    pub(crate) fn around(bounds: Bounds, area_mm2: f64, volume_mm3: f64) -> Self {
        let (wide, high) = (bounds.max.z - bounds.min.z, bounds.max.x - bounds.min.x);
        Self { bounds, depth_mm: wide.min(high), area_mm2, volume_mm3 }
    }
}
