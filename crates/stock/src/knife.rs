//! Taking a stencil away from one slab.
//!
//! The slab is parted where an edge of the stencil begins or crosses an edge of the material. Between two such places
//! nothing crosses, and taking away is a matter of four numbers in a column: floor and roof of the material, lower
//! and upper edge of the stencil. Edges that are one but for the rounding of numbers ([`crate::WELD_MM`]) are taken as
//! one here, and only here; whatever is decided, what is left is a stack of bands again.

use crate::WELD_MM;
use crate::band::Band;
use crate::chain::{Side, Walk};
use crate::curve::{Column, Curve, greater, lesser};
use crate::removed::Tally;
use crate::row::{Run, Slab};
use crate::sweep::Stencil;

/// A stencil in use.
pub(crate) struct Knife<'a> {
    pub(crate) stencil: &'a Stencil,
    /// Its sides from the slab on that was looked at last.
    pub(crate) lower: Walk<'a>,
    pub(crate) upper: Walk<'a>,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) taken: Tally,
    stops: &'a mut Stops,
}

/// Memory for the places where a slab is parted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stops {
    crossings: Places,
    /// See [`Knife::doubt`].
    pub(crate) doubts: Vec<(f64, f64)>,
}

/// The sides of a stencil that lie within some material; a side that does not passes all of it by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    lower: bool,
    upper: bool,
}

impl Reach {
    /// The only side that lies within the material.
    #[inline]
    pub(crate) const fn side(self) -> Option<Side> {
        match (self.lower, self.upper) {
            (true, false) => Some(Side::Lower),
            (false, true) => Some(Side::Upper),
            _ => None,
        }
    }
}

impl<'a> Knife<'a> {
    pub(crate) fn new(stencil: &'a Stencil, stops: &'a mut Stops) -> Self {
        let (from, to) = (stencil.lower.from, stencil.lower.to().min(stencil.upper.to()));
        stops.doubts.clear();
        let (lower, upper) = (stencil.lower.walk(), stencil.upper.walk());
        Self { stencil, lower, upper, from, to, taken: Tally::default(), stops }
    }

    /// Between these Z, what is left is not seen to hang together; it may, further off.
    pub(crate) fn doubt(&mut self, ends: (f64, f64)) {
        self.stops.doubts.push(ends);
    }

    /// How the stencil lies to the rectangle between two Z and two X; `None` when it misses it. Rectangles come in
    /// order along Z.
    #[inline]
    pub(crate) fn reach(&mut self, from: f64, to: f64, low: f64, high: f64) -> Option<Reach> {
        let (from, to) = (greater(from, self.from), lesser(to, self.to));
        let &Stencil { lower_least, upper_least, .. } = self.stencil;
        if to - from <= WELD_MM || lower_least >= high {
            return None;
        }
        self.lower.at(from);
        if self.lower.clears(high, from, to) {
            return None;
        }
        let has_lower = lower_least > low || self.lower.range(from, to).1 > low;
        if upper_least >= high {
            return Some(Reach { lower: has_lower, upper: false });
        }
        self.upper.at(from);
        let upper = self.upper.range(from, to);
        (upper.1 > low).then_some(Reach { lower: has_lower, upper: upper.0 < high })
    }

    /// Writes what is left of a slab; false when that is all of it.
    #[inline]
    pub(crate) fn carve(&mut self, slab: &Slab, bands: &[Band], reach: Reach, left: &mut Run) -> bool {
        if let ([band], Some(side)) = (bands, reach.side())
            && self.is_clear(side, slab, band)
        {
            return self.shave(side, slab, band, left);
        }
        self.carve_all(slab, bands, reach, left)
    }

    /// See [`Knife::carve`]; any slab, any sides.
    pub(crate) fn carve_all(&mut self, slab: &Slab, bands: &[Band], reach: Reach, left: &mut Run) -> bool {
        let Self { stops: Stops { crossings, .. }, taken, .. } = self;
        let before = taken.count();
        let pass_by = |left: &mut Run, from, to| {
            bands.iter().for_each(|band| left.push_band(*band));
            left.end_slab(from, to);
        };
        let mut from = slab.from;
        if self.from - from > WELD_MM {
            pass_by(left, from, self.from);
            from = self.from;
        }
        let end = if slab.to - self.to > WELD_MM { self.to } else { slab.to };
        let mut lower = reach.lower.then_some(self.lower);
        let mut upper = reach.upper.then_some(self.upper);
        while from < end {
            let mut to = end;
            let mut edge_from = |walk: &mut Option<Walk<'a>>| {
                let link = walk.as_mut()?.at(from)?;
                if end - link.to > WELD_MM {
                    to = lesser(to, link.to);
                }
                Some(&link.edge)
            };
            let (lower, upper) = (edge_from(&mut lower), edge_from(&mut upper));
            crossings.restart(from, to);
            for band in bands {
                lower.iter().chain(&upper).for_each(|edge| crossings.add_crossings(edge, band));
            }
            carve_between(bands, lower, upper, crossings, taken, left);
            from = to;
        }
        if slab.to > end {
            pass_by(left, end, slab.to);
        }
        taken.count() > before
    }
}

/// Writes what is left where the edges of the stencil do not change; they cross others at the given places.
fn carve_between(
    bands: &[Band],
    lower: Option<&Curve>,
    upper: Option<&Curve>,
    crossings: &Places,
    taken: &mut Tally,
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
            let bottom = lower.filter(|lower| column.rises(lower, &floor)).map(|lower| lower.edge);
            if let Some(edge) = bottom {
                left.push_band(Band { floor: band.floor, roof: *edge });
            }
            let top = upper.filter(|upper| column.rises(&roof, upper)).map(|upper| upper.edge);
            if let Some(edge) = top {
                left.push_band(Band { floor: *edge, roof: band.roof });
            }
            taken.add(bottom.unwrap_or(&band.floor), top.unwrap_or(&band.roof), from, to);
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
        // Places come nearly in order, so that the last ones are looked at first.
        let mut behind = self.ends.len() - 1;
        while behind > 0 && self.ends[behind - 1] > z {
            behind -= 1;
        }
        let has_room = behind == 0 || z - self.ends[behind - 1] > WELD_MM;
        if has_room && self.ends[behind] - z > WELD_MM {
            self.ends.insert(behind, z);
        }
    }

    fn add_crossings(&mut self, edge: &Curve, band: &Band) {
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
