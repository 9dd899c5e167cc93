//! The two axes of a cycle by their part in it, and the one place where computed points are rounded.
//!
//! In: nanometres along the *depth* axis (u) and along the *cut* axis (v), X as a radius. Out: positions on the
//! least increment. Not here: directions and what the moves are for.

use turnwright_units::{LeastIncrement, Length, Position, Radius, WorkTip};

use crate::Misuse;

/// 1000 km: sums of a few such lengths and their squares stay far inside `i64` and `i128`.
const RANGE_NM: i64 = 1_000_000_000_000_000;

/// Refuses lengths with which exact arithmetic could run over.
pub(crate) fn in_range(lengths: &[Length]) -> Result<(), Misuse> {
    let fits = |length: &Length| (-RANGE_NM..=RANGE_NM).contains(&length.nm());
    if lengths.iter().all(fits) { Ok(()) } else { Err(Misuse::OutOfRange) }
}

/// Which axis is the depth axis, and how finely each can be commanded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// True when depth is counted along X and the cut runs along Z.
    pub(crate) depth_is_x: bool,
    increment: LeastIncrement,
}

impl Plane {
    pub(crate) const fn new(depth_is_x: bool, increment: LeastIncrement) -> Self {
        Self { depth_is_x, increment }
    }

    /// (u, v) of a place, nanometres.
    pub(crate) const fn split(&self, place: Position<WorkTip>) -> (i64, i64) {
        let (x, z) = (place.x.0.nm(), place.z.nm());
        if self.depth_is_x { (x, z) } else { (z, x) }
    }

    /// (u, v) of an X (radius) and a Z, nanometres.
    pub(crate) const fn split_lengths(&self, x: Radius, z: Length) -> (i64, i64) {
        if self.depth_is_x { (x.0.nm(), z.nm()) } else { (z.nm(), x.0.nm()) }
    }

    /// The place at exact (u, v), rounded once.
    pub(crate) fn place(&self, u: i64, v: i64) -> Position<WorkTip> {
        let (x, z) = if self.depth_is_x { (u, v) } else { (v, u) };
        Position::new(snap_x_exact(x, self.increment), Length::from_nm(z).rounded(self.increment))
    }

    /// The place at exact u and computed v, rounded once.
    pub(crate) fn place_computed(&self, u: i64, v: f64) -> Position<WorkTip> {
        if self.depth_is_x {
            Position::new(snap_x_exact(u, self.increment), snap_z(v, self.increment))
        } else {
            Position::new(snap_x(v, self.increment), Length::from_nm(u).rounded(self.increment))
        }
    }

    /// The place at computed u and v, rounded once.
    pub(crate) fn place_both_computed(&self, u: f64, v: f64) -> Position<WorkTip> {
        let (x, z) = if self.depth_is_x { (u, v) } else { (v, u) };
        Position::new(snap_x(x, self.increment), snap_z(z, self.increment))
    }

    /// The smallest step along u, nanometres: for X half of the increment, which counts on the diameter.
    pub(crate) const fn grid_u(&self) -> i64 {
        if self.depth_is_x { self.increment.nm() / 2 } else { self.increment.nm() }
    }

    /// The smallest step along v, nanometres.
    pub(crate) const fn grid_v(&self) -> i64 {
        if self.depth_is_x { self.increment.nm() } else { self.increment.nm() / 2 }
    }
}

fn snap_x_exact(radius_nm: i64, increment: LeastIncrement) -> Radius {
    Radius(Length::from_nm(radius_nm)).to_diameter().rounded(increment).to_radius()
}

/// A computed radius, nanometres, to the nearest increment on the diameter (halves away from zero).
pub(crate) fn snap_x(radius_nm: f64, increment: LeastIncrement) -> Radius {
    let grid = increment.nm() / 2;
    Radius(Length::from_nm(steps(radius_nm, grid) * grid))
}

/// A computed Z, nanometres, to the nearest increment (halves away from zero).
pub(crate) fn snap_z(nm: f64, increment: LeastIncrement) -> Length {
    Length::from_nm(steps(nm, increment.nm()) * increment.nm())
}

fn steps(nm: f64, grid: i64) -> i64 {
    // Callers stay inside the range by construction; the clamp only keeps a bad float from becoming a bad product.
    let count = (nm / grid as f64).clamp(-1e16, 1e16);
    // As `f64::round`, which is a call: what is left behind the point is exact.
    let whole = count as i64;
    let rest = count - whole as f64;
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

/// `numerator / denominator` to the nearest multiple of `grid`, halves away from zero. Positive denominator and grid.
pub(crate) fn ratio_on_grid(numerator: i128, denominator: i128, grid: i64) -> i64 {
    let unit = denominator * i128::from(grid);
    let half = if numerator < 0 { -(unit / 2) } else { unit / 2 };
    ((numerator + half) / unit) as i64 * grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn x_is_rounded_on_the_diameter() {
        let plane = Plane::new(true, LeastIncrement::METRIC_B);
        // Radius 10.00026 is diameter 20.00052: 20.001, radius 10.0005.
        assert_eq!(plane.place(10_000_260, 0).x, Radius(Length::from_nm(10_000_500)));
        assert_eq!(snap_x(10_000_260.0, LeastIncrement::METRIC_B), Radius(Length::from_nm(10_000_500)));
        assert_eq!(plane.place(10_000_240, 0).x, Radius(Length::from_nm(10_000_000)));
    }

    #[test]
    fn steps_are_rounded_as_floats_are() {
        let bits = (0..64).map(|bit| f64::from_bits(0x3fdf_ffff_ffff_ffff_u64.wrapping_add(bit)));
        let some =
            [0.0, -0.0, 0.5, 1.5, 2.5, 4_503_599_627_370_495.5, 9e15, 1e16, 1e300, f64::INFINITY, f64::NAN];
        for value in bits.chain(some).flat_map(|value| [value, -value]) {
            assert_eq!(steps(value, 1), value.round().clamp(-1e16, 1e16) as i64, "{value:e}");
        }
    }

    #[test]
    fn ratios_round_halves_away_from_zero() {
        assert_eq!(ratio_on_grid(1, 2, 1), 1);
        assert_eq!(ratio_on_grid(-1, 2, 1), -1);
        assert_eq!(ratio_on_grid(10_000, 3, 500), 3_500);
        assert_eq!(ratio_on_grid(-10_000, 3, 1_000), -3_000);
    }

    #[test]
    fn the_range_ends_at_a_thousand_kilometres() {
        assert_eq!(in_range(&[Length::from_nm(RANGE_NM), Length::from_nm(-RANGE_NM)]), Ok(()));
        assert_eq!(in_range(&[Length::from_nm(i64::MIN)]), Err(Misuse::OutOfRange));
        assert_eq!(in_range(&[Length::from_nm(i64::MAX)]), Err(Misuse::OutOfRange));
    }
}
