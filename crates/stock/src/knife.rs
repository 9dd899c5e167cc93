//! Taking a stencil away from one slab.
//!
//! The slab is parted where an edge of the stencil begins or crosses an edge of the material. Between two such places
//! nothing crosses, and taking away is a matter of four numbers in a column: floor and roof of the material, lower
//! and upper edge of the stencil. Edges that are one but for the rounding of numbers ([`crate::WELD_MM`]) are taken as
//! one here, and only here; whatever is decided, what is left is a stack of bands again.

use crate::WELD_MM;
use crate::band::Band;
use crate::curve::{Column, Curve, greater, lesser};
use crate::removed::Removed;
use crate::row::{Run, Slab};
use crate::sweep::Stencil;

/// A stencil in use.
pub(crate) struct Knife<'a> {
    stencil: &'a Stencil,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) removed: Removed,
    stops: &'a mut Stops,
}

/// Memory for the places where a slab is parted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stops {
    coarse: Places,
    fine: Places,
    /// See [`Knife::doubt`].
    pub(crate) doubts: Vec<(f64, f64)>,
}

/// The sides of a stencil that lie within some material; a side that does not passes all of it by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    lower: bool,
    upper: bool,
}

impl<'a> Knife<'a> {
    pub(crate) fn new(stencil: &'a Stencil, stops: &'a mut Stops) -> Self {
        let (from, to) = (stencil.lower.from, stencil.lower.to().min(stencil.upper.to()));
        stops.doubts.clear();
        Self { stencil, from, to, removed: Removed::default(), stops }
    }

    /// Between these Z, what is left is not seen to hang together; it may, further off.
    pub(crate) fn doubt(&mut self, ends: (f64, f64)) {
        self.stops.doubts.push(ends);
    }

    /// How the stencil lies to the rectangle between two Z and two X; `None` when it misses it.
    #[inline]
    pub(crate) fn reach(&self, from: f64, to: f64, low: f64, high: f64) -> Option<Reach> {
        let (from, to) = (greater(from, self.from), lesser(to, self.to));
        if to - from <= WELD_MM {
            return None;
        }
        let Stencil { lower, upper, lower_least, upper_least } = self.stencil;
        if lower.clears(high, from, to) {
            return None;
        }
        let has_lower = *lower_least > low || lower.range(from, to).1 > low;
        if *upper_least >= high {
            return Some(Reach { lower: has_lower, upper: false });
        }
        let upper = upper.range(from, to);
        (upper.1 > low).then_some(Reach { lower: has_lower, upper: upper.0 < high })
    }

    /// Writes what is left of a slab; false when that is all of it.
    pub(crate) fn carve(&mut self, slab: &Slab, bands: &[Band], reach: Reach, left: &mut Run) -> bool {
        let Self { stencil, stops: Stops { coarse, fine, .. }, removed, .. } = self;
        coarse.restart(slab.from, slab.to);
        coarse.add(self.from);
        coarse.add(self.to);
        if reach.lower {
            stencil.lower.links.iter().for_each(|link| coarse.add(link.to));
        }
        if reach.upper {
            stencil.upper.links.iter().for_each(|link| coarse.add(link.to));
        }
        let before = removed.count;
        let mut from = slab.from;
        for &to in coarse.ends() {
            let middle = (from + to) / 2.0;
            if middle < self.from || middle > self.to {
                bands.iter().for_each(|band| left.push_band(*band));
                left.end_slab(from, to);
            } else {
                let lower = reach.lower.then(|| stencil.lower.edge(middle));
                let upper = reach.upper.then(|| stencil.upper.edge(middle));
                fine.restart(from, to);
                for band in bands {
                    fine.add_crossings(lower.as_ref(), band);
                    fine.add_crossings(upper.as_ref(), band);
                }
                carve_between(bands, lower.as_ref(), upper.as_ref(), fine, removed, left);
            }
            from = to;
        }
        removed.count > before
    }
}

/// Writes what is left where the edges of the stencil do not change; they cross others at the given places.
fn carve_between(
    bands: &[Band],
    lower: Option<&Curve>,
    upper: Option<&Curve>,
    crossings: &Places,
    removed: &mut Removed,
    left: &mut Run,
) {
    let mut from = crossings.from;
    for &to in crossings.ends() {
        let column = Column::new(from, to);
        let lower = lower.map(|edge| column.across(edge));
        let upper = upper.map(|edge| column.across(edge));
        for band in bands {
            let (floor, roof) = (column.across(&band.floor), column.across(&band.roof));
            let is_below = lower.is_some_and(|lower| !column.rises(&roof, &lower));
            let is_above = upper.is_some_and(|upper| !column.rises(&upper, &floor));
            if is_below || is_above {
                left.push_band(*band);
                continue;
            }
            let mut taken = *band;
            let bottom = lower.filter(|lower| column.rises(lower, &floor));
            if let Some(edge) = bottom {
                left.push_band(Band { floor: band.floor, roof: *edge.edge });
                taken.floor = *edge.edge;
            }
            let top = upper.filter(|upper| column.rises(&roof, upper));
            if let Some(edge) = top {
                left.push_band(Band { floor: *edge.edge, roof: band.roof });
                taken.roof = *edge.edge;
            }
            removed.add(&taken, from, to);
        }
        left.end_slab(from, to);
        from = to;
    }
}

/// Places between two Z, in order, none nearer to another or to an end than the weld, and the further end.
#[derive(Clone, Debug, Default)]
struct Places {
    from: f64,
    to: f64,
    ends: Vec<f64>,
}

impl Places {
    fn restart(&mut self, from: f64, to: f64) {
        (self.from, self.to) = (from, to);
        self.ends.clear();
        self.ends.push(to);
    }

    /// Adds a place where there is room for it; what is no number is no place.
    #[inline]
    fn add(&mut self, z: f64) {
        if !(z - self.from > WELD_MM && self.to - z > WELD_MM) {
            return;
        }
        let behind = self.ends.iter().position(|place| z < place + WELD_MM).unwrap_or(0);
        // The one behind is no nearer in front of it than the weld, or it is taken for it.
        if self.ends[behind] - z > WELD_MM {
            self.ends.insert(behind, z);
        }
    }

    #[inline]
    fn add_crossings(&mut self, edge: Option<&Curve>, band: &Band) {
        let Some(edge) = edge else { return };
        for other in [&band.floor, &band.roof] {
            if edge.may_meet(other, self.from, self.to) {
                let [one, two] = edge.crossings(other);
                self.add(one);
                self.add(two);
            }
        }
    }

    /// Where the parts between the places end, one after the other.
    fn ends(&self) -> &[f64] {
        &self.ends
    }
}
