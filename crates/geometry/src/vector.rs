//! Ways between places of the half-section.

use crate::Point;

/// A way from one place of the half-section to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Across the spindle axis, mm (radius).
    pub x: f64,
    /// Along the spindle axis, mm.
    pub z: f64,
}

impl Vector {
    /// From one place to another.
    #[inline]
    pub fn between(from: Point, to: Point) -> Self {
        Self { x: to.x - from.x, z: to.z - from.z }
    }

    /// How long it is, mm.
    #[inline]
    pub fn length(self) -> f64 {
        (self.x * self.x + self.z * self.z).sqrt()
    }

    /// With length 1; nothing when it has no length.
    pub(crate) fn unit(self) -> Option<Self> {
        let length = self.length();
        (length > 0.0).then(|| self.times(1.0 / length))
    }

    /// A multiple of it.
    pub fn times(self, factor: f64) -> Self {
        Self { x: self.x * factor, z: self.z * factor }
    }

    /// Turned a quarter counter-clockwise.
    pub(crate) fn left(self) -> Self {
        Self { x: self.z, z: -self.x }
    }

    /// Positive when `other` points the same way.
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.z * other.z
    }

    /// Positive when `other` points to the left.
    pub fn cross(self, other: Self) -> f64 {
        self.z * other.x - self.x * other.z
    }

    /// Where it leads from a place.
    pub fn from(self, point: Point) -> Point {
        Point { x: point.x + self.x, z: point.z + self.z }
    }

    /// Both, one after the other.
    pub fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, z: self.z + other.z }
    }
}
