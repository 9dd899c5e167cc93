//! Positions that know whose origin they are measured from and which point of the tool they locate.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, Sub};

use crate::{Length, Radius};

/// An origin together with the point of the tool that is located in it.
pub trait Frame: Copy + fmt::Debug + PartialEq {
    /// The name printed by `Debug`.
    const NAME: &'static str;
}

/// The active work coordinate system; locates the imaginary tool tip. What programs say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkTip;

/// The active work coordinate system; locates the centre of the nose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkNose;

/// The machine's own zero; locates the reference point of the turret.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MachineTurret;

impl Frame for WorkTip {
    const NAME: &'static str = "work";
}
impl Frame for WorkNose {
    const NAME: &'static str = "nose";
}
impl Frame for MachineTurret {
    const NAME: &'static str = "machine";
}

/// An exact place. X is a radius; there is no bare X anywhere.
///
/// ```compile_fail
/// use turnwright_units::{Length, MachineTurret, Position, Radius, WorkTip};
/// let work = Position::<WorkTip>::new(Radius::ZERO, Length::ZERO);
/// let machine = Position::<MachineTurret>::new(Radius::ZERO, Length::ZERO);
/// let _ = work - machine;
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Position<F: Frame> {
    /// Distance from the spindle axis.
    pub x: Radius,
    /// Distance along the spindle axis, away from the chuck.
    pub z: Length,
    frame: PhantomData<F>,
}

impl<F: Frame> Position<F> {
    /// A place in frame `F`.
    pub const fn new(x: Radius, z: Length) -> Self {
        Self { x, z, frame: PhantomData }
    }
}

impl<F: Frame> fmt::Debug for Position<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}({} z{})", F::NAME, self.x.to_diameter(), self.z)
    }
}

/// The way from one position to another in the same frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Displacement<F: Frame> {
    /// Along X, radius.
    pub x: Radius,
    /// Along Z.
    pub z: Length,
    frame: PhantomData<F>,
}

impl<F: Frame> Displacement<F> {
    /// A way of `x` (radius) and `z`.
    pub const fn new(x: Radius, z: Length) -> Self {
        Self { x, z, frame: PhantomData }
    }
}

impl<F: Frame> Sub for Position<F> {
    type Output = Displacement<F>;
    fn sub(self, other: Self) -> Displacement<F> {
        Displacement::new(self.x - other.x, self.z - other.z)
    }
}

impl<F: Frame> Add<Displacement<F>> for Position<F> {
    type Output = Self;
    fn add(self, way: Displacement<F>) -> Self {
        Self::new(self.x + way.x, self.z + way.z)
    }
}

/// The only way from a position in frame `A` to the same place in frame `B`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shift<A: Frame, B: Frame> {
    x: Radius,
    z: Length,
    frames: PhantomData<(A, B)>,
}

impl<A: Frame, B: Frame> Shift<A, B> {
    /// The shift that adds `x` (radius) and `z` to a position in `A`.
    pub const fn new(x: Radius, z: Length) -> Self {
        Self { x, z, frames: PhantomData }
    }

    /// The same place, seen from `B`.
    pub fn apply(self, position: Position<A>) -> Position<B> {
        Position::new(position.x + self.x, position.z + self.z)
    }

    /// First this shift, then `next`.
    pub fn then<C: Frame>(self, next: Shift<B, C>) -> Shift<A, C> {
        Shift::new(self.x + next.x, self.z + next.z)
    }

    /// The way back.
    pub fn inverse(self) -> Shift<B, A> {
        Shift::new(-self.x, -self.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_and_its_inverse_cancel() {
        let shift = Shift::<MachineTurret, WorkTip>::new(Radius(Length::from_mm(200)), Length::from_mm(400));
        let home = Position::<MachineTurret>::new(Radius::ZERO, Length::ZERO);
        assert_eq!(shift.inverse().apply(shift.apply(home)), home);
        assert_eq!(shift.apply(home).z, Length::from_mm(400));
    }
}
