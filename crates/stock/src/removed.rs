//! What a cut took away, and what a tool touches.

use turnwright_geometry::{Bounds, Point};

use crate::curve::{Content, Curve, greater, lesser};

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

/// Adds up what a knife takes, piece by piece along Z. Edges that go on from piece to piece are measured once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tally {
    floor: Stretch,
    roof: Stretch,
    content: Content,
    bounds: Bounds,
    count: u32,
}

/// An edge between two Z.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    edge: Curve,
    from: f64,
    to: f64,
}

impl Default for Tally {
    fn default() -> Self {
        let none = Stretch { edge: Curve::level(0.0), from: 0.0, to: 0.0 };
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        let bounds = Bounds { min: Point::new(min, min), max: Point::new(max, max) };
        Self { floor: none, roof: none, content: Content::default(), bounds, count: 0 }
    }
}

impl Tally {
    /// How many pieces there were.
    pub(crate) const fn count(&self) -> u32 {
        self.count
    }

    /// Takes all from a floor to a roof between two Z.
    #[inline]
    pub(crate) fn add(&mut self, floor: &Curve, roof: &Curve, from: f64, to: f64) {
        self.count += 1;
        self.bounds.min.z = lesser(self.bounds.min.z, from);
        self.bounds.max.z = greater(self.bounds.max.z, to);
        if let Some(floor) = self.floor.go_on(floor, from, to) {
            self.take_floor(&floor);
        }
        if let Some(roof) = self.roof.go_on(roof, from, to) {
            self.take_roof(&roof);
        }
    }

    fn take_floor(&mut self, floor: &Stretch) {
        let (content, low, _) = floor.edge.content_and_range(floor.from, floor.to);
        self.content = self.content - content;
        self.bounds.min.x = lesser(self.bounds.min.x, low);
    }

    fn take_roof(&mut self, roof: &Stretch) {
        let (content, _, high) = roof.edge.content_and_range(roof.from, roof.to);
        self.content += content;
        self.bounds.max.x = greater(self.bounds.max.x, high);
    }

    /// All that was taken.
    pub(crate) fn removed(mut self) -> Removed {
        if self.count == 0 {
            return Removed::default();
        }
        let Self { floor, roof, .. } = self;
        self.take_floor(&floor);
        self.take_roof(&roof);
        Removed {
            area_mm2: self.content.area_mm2,
            volume_mm3: self.content.volume_mm3,
            bounds: Some(self.bounds),
            may_part: false,
            count: self.count,
        }
    }
}

impl Stretch {
    /// Goes on to the end of another where that is of the same edge; else the other takes its place, and this one is
    /// given out when it is one.
    #[inline]
    fn go_on(&mut self, edge: &Curve, from: f64, to: f64) -> Option<Self> {
        if self.to == from && self.edge == *edge {
            self.to = to;
            return None;
        }
        let before = std::mem::replace(self, Self { edge: *edge, from, to });
        (before.to > before.from).then_some(before)
    }
}
