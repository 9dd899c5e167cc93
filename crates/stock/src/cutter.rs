//! A tool's outline as convex parts, ready to be swept.
//!
//! The union of the parts is the outline. Parts are cut apart along Z only, and only where the outline is not convex;
//! an insert, a drill and a grooving blade are one part each. An edge that is hollowed by an arc (a form tool) has no
//! convex parts: chords stand for such an arc, never further from it than [`HOLLOW_MM`], so that the tool cuts that
//! much too much there, never too little.

use turnwright_geometry::{Bounds, Outline, Point};

use crate::WELD_MM;
use crate::band::Band;
use crate::chain::Side;
use crate::curve::Curve;
use crate::decompose::slabs_of;

/// How far chords lie from a hollow arc of a tool: a tenth of a micrometre.
pub const HOLLOW_MM: f64 = 1e-4;

/// Leans that differ less are of edges that go on without a corner.
const SMOOTH: f64 = 1e-9;

/// A tool, relative to its programmed point.
#[derive(Clone, Debug)]
pub struct Cutter {
    pub(crate) parts: Vec<Convex>,
    bounds: Bounds,
}

/// A convex shape between two Z: its lower edges with leans that grow, its upper edges with leans that fall.
#[derive(Clone, Debug)]
pub(crate) struct Convex {
    pub(crate) from: f64,
    pub(crate) lower: Vec<Facet>,
    pub(crate) upper: Vec<Facet>,
    /// Lowest X of the lower edges.
    pub(crate) lower_least: f64,
    /// Lowest X of the upper edges.
    pub(crate) upper_least: f64,
}

/// An edge of a convex shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) to: f64,
    pub(crate) edge: Curve,
    /// Its lean where it begins.
    pub(crate) first: f64,
    /// Its lean where it ends.
    pub(crate) last: f64,
}

impl Cutter {
    /// The parts of an outline.
    pub fn new(outline: &Outline) -> Self {
        let mut parts: Vec<Convex> = Vec::new();
        for slab in slabs_of(outline) {
            for band in slab.bands {
                for (from, to, band) in filled(band, slab.from, slab.to) {
                    match parts.iter_mut().find(|part| part.goes_on_with(&band, from, to)) {
                        Some(part) => part.push(&band, from, to),
                        None => parts.push(Convex::new(&band, from, to)),
                    }
                }
            }
        }
        Self { parts, bounds: outline.bounds() }
    }

    /// The upright rectangle round the tool, about its programmed point.
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }
}

impl Convex {
    fn new(band: &Band, from: f64, to: f64) -> Self {
        let (lower_least, upper_least) = (f64::INFINITY, f64::INFINITY);
        let mut part = Self { from, lower: Vec::new(), upper: Vec::new(), lower_least, upper_least };
        part.push(band, from, to);
        part
    }

    pub(crate) fn to(&self) -> f64 {
        self.lower.last().map_or(self.from, |facet| facet.to)
    }

    pub(crate) fn side(&self, side: Side) -> &[Facet] {
        match side {
            Side::Lower => &self.lower,
            Side::Upper => &self.upper,
        }
    }

    /// Whether a band continues the part and leaves it convex.
    fn goes_on_with(&self, band: &Band, from: f64, to: f64) -> bool {
        let (Some(lower), Some(upper)) = (self.lower.last(), self.upper.last()) else { return false };
        let meets = |last: &Facet, next: &Curve| (last.edge.at(from) - next.at(from)).abs() <= 10.0 * WELD_MM;
        (self.to() - from).abs() <= WELD_MM
            && from < to
            && meets(lower, &band.floor)
            && meets(upper, &band.roof)
            && lower.last <= band.floor.lean(from) + SMOOTH
            && upper.last >= band.roof.lean(from) - SMOOTH
    }

    fn push(&mut self, band: &Band, from: f64, to: f64) {
        self.lower_least = self.lower_least.min(band.floor.range(from, to).0);
        self.upper_least = self.upper_least.min(band.roof.range(from, to).0);
        for (facets, edge) in [(&mut self.lower, band.floor), (&mut self.upper, band.roof)] {
            let last = edge.lean(to);
            match facets.last_mut() {
                Some(facet) if facet.edge.is_one_with(&edge, from, to) => {
                    facet.to = to;
                    facet.last = last;
                }
                _ => facets.push(Facet { to, edge, first: edge.lean(from), last }),
            }
        }
    }
}

/// A band of a tool with chords in place of hollow edges.
fn filled(band: Band, from: f64, to: f64) -> impl Iterator<Item = (f64, f64, Band)> {
    let is_hollow =
        |edge: &Curve, side: Side| matches!(edge, Curve::Arc { radius, .. } if radius * side.turn() > 0.0);
    let (floor, roof) = (is_hollow(&band.floor, Side::Lower), is_hollow(&band.roof, Side::Upper));
    let count = [(floor, &band.floor), (roof, &band.roof)]
        .into_iter()
        .filter(|(is_hollow, _)| *is_hollow)
        .map(|(_, edge)| chords(edge, from, to))
        .max()
        .unwrap_or(1);
    (0..count).map(move |index| {
        let at = |index: u32| from + (to - from) * f64::from(index) / f64::from(count);
        let (a, b) = (at(index), if index + 1 == count { to } else { at(index + 1) });
        let chord = |edge: Curve, is_hollow| {
            if is_hollow { Curve::through(edge.point(a), edge.point(b)) } else { edge }
        };
        (a, b, Band { floor: chord(band.floor, floor), roof: chord(band.roof, roof) })
    })
}

/// How many even steps along Z keep chords within [`HOLLOW_MM`] of an arc.
fn chords(edge: &Curve, from: f64, to: f64) -> u32 {
    const COUNT_MAX: u32 = 1 << 10;
    let Curve::Arc { radius, .. } = *edge else { return 1 };
    let mut count = 1;
    while count < COUNT_MAX {
        let at = |index: u32| from + (to - from) * f64::from(index) / f64::from(count);
        let chord = |index: u32| Point::distance(edge.point(at(index)), edge.point(at(index + 1)));
        let sagitta = |chord: f64| chord * chord / (8.0 * radius.abs());
        if (0..count).all(|index| sagitta(chord(index)) <= HOLLOW_MM) {
            break;
        }
        count *= 2;
    }
    count
}
