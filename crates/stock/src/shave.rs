//! Taking a stencil away from a slab that one side of it shaves: the everyday cut.
//!
//! Where the slab is one band, only the lower side of the stencil reaches into it (or only the upper, in a bore), and
//! the other edge of the band lies clear of that side, a column is a matter of two edges: what is left ends at the
//! nearer of them. What comes out is what [`Knife::carve`] makes of such a slab anyway, number by number.

use crate::WELD_MM;
use crate::band::Band;
use crate::chain::Side;
use crate::curve::{Column, Curve};
use crate::knife::Knife;
use crate::removed::Tally;
use crate::row::{Run, Slab};

/// From this far off an edge lies clear however steep it is.
const CLEAR_MM: f64 = 1.0;

impl Knife<'_> {
    /// Whether a side of the stencil lies so far from the edge of the band that it does not cut that no column needs
    /// to look at it.
    #[inline]
    pub(crate) fn is_clear(&self, side: Side, slab: &Slab, band: &Band) -> bool {
        let apart = |edge: &Curve| if edge.is_level() { WELD_MM } else { CLEAR_MM };
        match side {
            Side::Lower => {
                self.stencil.lower_least - band.floor.highest(slab.from, slab.to) > apart(&band.floor)
            }
            Side::Upper => {
                let most = self.upper.range(slab.from, slab.to).1;
                band.roof.lowest(slab.from, slab.to) - most > apart(&band.roof)
            }
        }
    }

    /// Writes what is left of such a slab; false when that is all of it.
    pub(crate) fn shave(&mut self, side: Side, slab: &Slab, band: &Band, left: &mut Run) -> bool {
        let mut walk = match side {
            Side::Lower => self.lower,
            Side::Upper => self.upper,
        };
        let old = match side {
            Side::Lower => &band.roof,
            Side::Upper => &band.floor,
        };
        let mut shaving = Shaving { side, band, old, taken: &mut self.taken, left, is_changed: false };
        let mut from = slab.from;
        if self.from - from > WELD_MM {
            shaving.write(old, from, self.from);
            from = self.from;
        }
        let end = if slab.to - self.to > WELD_MM { self.to } else { slab.to };
        while from < end {
            let Some(link) = walk.at(from) else { break };
            let to = if end - link.to > WELD_MM { link.to } else { end };
            if link.edge.may_meet(old, from, to) {
                let [one, two] = link.edge.crossings(old);
                for stop in if two < one { [two, one] } else { [one, two] } {
                    // What is no number is no place.
                    if stop - from > WELD_MM && to - stop > WELD_MM {
                        shaving.column(&link.edge, from, stop);
                        from = stop;
                    }
                }
            }
            shaving.column(&link.edge, from, to);
            from = to;
        }
        if slab.to > end {
            shaving.write(old, end, slab.to);
        }
        shaving.is_changed
    }
}

/// A slab being shaved.
struct Shaving<'a> {
    side: Side,
    band: &'a Band,
    /// The edge of the band that the stencil cuts.
    old: &'a Curve,
    taken: &'a mut Tally,
    left: &'a mut Run,
    is_changed: bool,
}

impl Shaving<'_> {
    /// Writes a stretch of the slab with this edge in place of the old one.
    #[inline]
    fn write(&mut self, edge: &Curve, from: f64, to: f64) {
        match self.side {
            Side::Lower => self.left.push_slab_of(&self.band.floor, edge, from, to),
            Side::Upper => self.left.push_slab_of(edge, &self.band.roof, from, to),
        }
    }

    /// Takes what lies beyond an edge that does not cross the old one between two Z.
    fn column(&mut self, edge: &Curve, from: f64, to: f64) {
        let column = Column::new(from, to);
        let (new, old) = (column.across(edge), column.across(self.old));
        let is_cut = match self.side {
            Side::Lower => column.rises(&old, &new),
            Side::Upper => column.rises(&new, &old),
        };
        self.is_changed |= is_cut;
        if !is_cut {
            return self.write(self.old, from, to);
        }
        self.write(edge, from, to);
        match self.side {
            Side::Lower => self.taken.add(edge, self.old, from, to),
            Side::Upper => self.taken.add(self.old, edge, from, to),
        }
    }
}

#[cfg(test)]
mod tests {
    use turnwright_geometry::{Bend, Outline, Point, Segment};

    use super::*;
    use crate::knife::Stops;
    use crate::{Cutter, Section, Sweep};

    /// A nose of 0.4 mm with a shank of 30 mm outwards (or inwards), from its centre.
    fn nose(outwards: f64) -> Cutter {
        let at = |x: f64, z: f64| Point::new(x * outwards, z * outwards);
        let bend = Some(Bend { centre: Point::new(0.0, 0.0), clockwise: false });
        let line = |start, end| Segment { start, end, bend: None };
        let outline = Outline::new(vec![
            Segment { start: at(0.0, -0.4), end: at(0.0, 0.4), bend },
            line(at(0.0, 0.4), at(30.0, 0.4)),
            line(at(30.0, 0.4), at(30.0, -0.4)),
            line(at(30.0, -0.4), at(0.0, -0.4)),
        ]);
        Cutter::new(&outline.expect("a nose"))
    }

    #[test]
    fn a_shaved_slab_is_what_any_slab_would_be() {
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let (outside, inside) = (nose(1.0), nose(-1.0));
        let mut section = Section::tube(30.0, 50.0, -20.0, 0.0).expect("a tube");
        let (mut sweep, mut stops) = (Sweep::new(), [Stops::default(), Stops::default()]);
        let mut shaved = [0; 2];
        for cut in 0..600 {
            let is_outside = cut % 2 == 0;
            let mut place = |depth: f64| {
                let x = if is_outside { 50.0 - depth } else { 30.0 + depth };
                Point::new(x + random() - 0.5, 1.0 - 22.0 * random())
            };
            let depth = 4.0 * f64::from(cut) / 600.0;
            let (from, to) = (place(depth), place(depth));
            sweep.line(if is_outside { &outside } else { &inside }, from, to);
            let [stops, others] = &mut stops;
            let (mut knife, mut other) =
                (Knife::new(&sweep.stencils()[0], stops), Knife::new(&sweep.stencils()[0], others));
            for (slab, bands) in section.row.slabs() {
                let reach = knife.reach(slab.from, slab.to, slab.low, slab.high);
                let _ = other.reach(slab.from, slab.to, slab.low, slab.high);
                let ([band], Some(reach)) = (bands, reach) else { continue };
                let Some(side) = reach.side().filter(|side| knife.is_clear(*side, slab, band)) else {
                    continue;
                };
                let (mut left, mut expected) = (Run::default(), Run::default());
                let is_changed = knife.shave(side, slab, band, &mut left);
                assert_eq!(other.carve_all(slab, bands, reach, &mut expected), is_changed);
                assert_eq!(format!("{left:?}"), format!("{expected:?}"));
                assert_eq!(format!("{:?}", knife.taken), format!("{:?}", other.taken));
                shaved[usize::from(is_outside)] += usize::from(is_changed);
            }
            section.cut(&sweep);
        }
        assert!(shaved.iter().all(|count| *count > 300), "{shaved:?}");
    }
}
