//! Taking a stencil away from one slab.
//!
//! The slab is parted where an edge of the stencil begins or crosses an edge of the material. Between two such places
//! nothing crosses, and taking away is a matter of four numbers in a column: floor and roof of the material, lower
//! and upper edge of the stencil. Edges that are one but for the rounding of numbers ([`crate::WELD_MM`]) are taken as
//! one here, and only here; whatever is decided, what is left is a stack of bands again.

use turnwright_geometry::Point;

use crate::WELD_MM;
use crate::band::Band;
use crate::curve::Curve;
use crate::removed::Removed;
use crate::row::{Run, Slab};
use crate::sweep::Stencil;

/// A stencil in use.
pub(crate) struct Knife<'a> {
    pub(crate) stencil: &'a Stencil,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) removed: Removed,
    pub(crate) stops: &'a mut Stops,
}

/// Memory for the places where a slab is parted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stops {
    coarse: Vec<f64>,
    fine: Vec<f64>,
}

/// Nothing is below, nothing is above.
const BELOW_ALL: Curve = Curve::level(f64::NEG_INFINITY);
const ABOVE_ALL: Curve = Curve::level(f64::INFINITY);

impl<'a> Knife<'a> {
    pub(crate) fn new(stencil: &'a Stencil, stops: &'a mut Stops) -> Self {
        let (from, to) = (stencil.lower.from, stencil.lower.to().min(stencil.upper.to()));
        Self { stencil, from, to, removed: Removed::default(), stops }
    }

    /// The material of a band between two Z, less all between two edges that cross none of its own there.
    fn carve_band(
        &mut self,
        band: &Band,
        (lower, upper): (Curve, Curve),
        from: f64,
        to: f64,
        left: &mut Run,
    ) {
        let rises = |a: &Curve, b: &Curve| a.rises_over(b, from, to);
        if !rises(&band.roof, &lower) || !rises(&upper, &band.floor) {
            left.push_band(*band);
            return;
        }
        let (mut bottom, mut top) = (band.floor, band.roof);
        if rises(&lower, &band.floor) {
            left.push_band(Band { floor: band.floor, roof: lower });
            bottom = lower;
        }
        let is_open = !rises(&band.roof, &upper);
        if !is_open {
            left.push_band(Band { floor: upper, roof: band.roof });
            top = upper;
        }
        let is_whole = is_open && bottom == band.floor;
        let is_split = !is_open && bottom != band.floor;
        self.removed.add(&Band { floor: bottom, roof: top }, from, to, is_whole || is_split);
    }

    /// Whether the rectangle between two Z and two X is out of reach.
    #[inline]
    pub(crate) fn misses(&self, from: f64, to: f64, low: f64, high: f64) -> bool {
        let (from, to) = (from.max(self.from), to.min(self.to));
        to - from <= WELD_MM
            || self.stencil.lower.range(from, to).0 >= high
            || self.stencil.upper.range(from, to).1 <= low
    }

    /// Writes what is left of a slab; false when that is all of it.
    pub(crate) fn carve(&mut self, slab: &Slab, bands: &[Band], left: &mut Run) -> bool {
        let (from, to) = (slab.from.max(self.from), slab.to.min(self.to));
        // A side that passes all of the material by need not be looked at.
        let has_lower = self.stencil.lower.range(from, to).1 > slab.low;
        let has_upper = self.stencil.upper.range(from, to).0 < slab.high;
        let mut stops = std::mem::take(self.stops);
        let Stops { coarse, fine } = &mut stops;
        coarse.clear();
        coarse.extend([from, to]);
        if has_lower {
            coarse.extend(self.stencil.lower.links.iter().map(|link| link.to));
        }
        if has_upper {
            coarse.extend(self.stencil.upper.links.iter().map(|link| link.to));
        }
        part(coarse, slab.from, slab.to);
        let before = self.removed.count;
        let mut start = slab.from;
        for &stop in coarse.iter() {
            let middle = (start + stop) / 2.0;
            let is_within = self.from < middle && middle < self.to;
            let lower = if has_lower { self.stencil.lower.edge(middle) } else { BELOW_ALL };
            let upper = if has_upper { self.stencil.upper.edge(middle) } else { ABOVE_ALL };
            fine.clear();
            if is_within {
                let edges = bands.iter().flat_map(|band| [&band.floor, &band.roof]);
                fine.extend(
                    edges.flat_map(|edge| edge.crossings(&lower).into_iter().chain(edge.crossings(&upper))),
                );
            }
            part(fine, start, stop);
            for &to in fine.iter() {
                for band in bands {
                    if is_within {
                        self.carve_band(band, (lower, upper), start, to, left);
                    } else {
                        left.push_band(*band);
                    }
                }
                left.end_slab(start, to);
                start = to;
            }
        }
        *self.stops = stops;
        self.removed.count > before
    }
}

/// Keeps the places between two Z, in order, none nearer to another than the weld; the last is the end.
fn part(stops: &mut Vec<f64>, from: f64, to: f64) {
    stops.retain(|stop| from + WELD_MM < *stop && *stop < to - WELD_MM);
    stops.sort_unstable_by(f64::total_cmp);
    stops.dedup_by(|next, before| *next - *before <= WELD_MM);
    stops.push(to);
}

impl Removed {
    fn add(&mut self, band: &Band, from: f64, to: f64, may_part: bool) {
        let content = band.content(from, to);
        let (low, high) = band.range(from, to);
        self.count += 1;
        self.area_mm2 += content.area_mm2;
        self.volume_mm3 += content.volume_mm3;
        self.may_part |= may_part;
        self.include(Point::new(low, from));
        self.include(Point::new(high, to));
    }
}
