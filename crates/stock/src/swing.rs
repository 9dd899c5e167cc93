//! A convex shape along a part of a circle.
//!
//! While the path runs one way along Z, all that the shape passes over at a Z is one stretch of X. Its lower end is
//! the lowest of a few edges (its upper end the highest), each of them passed over itself:
//! * the shape where the path begins and where it ends,
//! * the path, moved to each corner, as far as its lean lies between those of the edges beside the corner,
//! * for each arc of the shape an arc with both radii together, or with their difference where the path bends the
//!   other way, again between their common leans,
//! * each line of the shape at the place of the path that has its lean.
//!
//! So the edges of a swept shape are lines and arcs, and nothing is approximated.

use turnwright_geometry::Vector;

use crate::WELD_MM;
use crate::chain::{Chain, Side};
use crate::curve::{Column, Curve};
use crate::cutter::Convex;

/// Memory for making a chain.
#[derive(Clone, Debug, Default)]
pub(crate) struct Swing {
    before: Chain,
}

impl Swing {
    /// Writes one side of a shape that moves along `path` between two Z.
    pub(crate) fn write(
        &mut self,
        chain: &mut Chain,
        part: &Convex,
        side: Side,
        path: &Curve,
        from: f64,
        to: f64,
    ) {
        let Curve::Arc { z, x, radius } = *path else { return };
        let mut outermost = Outermost { chain, before: &mut self.before, side };
        outermost.restart(part.from + from, part.to() + to);
        let facets = part.side(side);
        // The path as a way that the shape is moved by, at a lean.
        let centre = Vector { x, z };
        let way = |z: f64| Vector { x: path.at(z), z };
        let leans = sorted(path.lean(from), path.lean(to));
        // The part of an arc between two leans that the path has too.
        let between = |outermost: &mut Outermost<'_>, arc: Curve, one: f64, other: f64| {
            let (least, most) = sorted(one, other);
            let (least, most) = (least.max(leans.0), most.min(leans.1));
            if let (true, Some(a), Some(b)) = (least < most, arc.leaning(least), arc.leaning(most)) {
                outermost.take(a.min(b), a.max(b), arc);
            }
        };
        for stop in [from, to] {
            let mut z = part.from;
            for facet in facets {
                outermost.take(z + stop, facet.to + stop, facet.edge.moved(way(stop)));
                z = facet.to;
            }
        }
        // In front of the first edge and behind the last the shape is upright.
        let (mut corner_z, mut lean) = (part.from, -side.turn());
        for facet in facets {
            let corner = facet.edge.point(corner_z);
            between(&mut outermost, path.moved(Vector { x: corner.x, z: corner.z }), lean, facet.first);
            match facet.edge {
                Curve::Arc { z, x, radius: own } => {
                    let both = own + radius;
                    if both * radius > 0.0 {
                        let arc = Curve::Arc { z, x, radius: both }.moved(centre);
                        between(&mut outermost, arc, facet.first, facet.last);
                    }
                }
                Curve::Line { .. } => {
                    let touch =
                        path.leaning(facet.first).filter(|_| leans.0 < facet.first && facet.first < leans.1);
                    if let Some(touch) = touch {
                        outermost.take(corner_z + touch, facet.to + touch, facet.edge.moved(way(touch)));
                    }
                }
            }
            (corner_z, lean) = (facet.to, facet.last);
        }
        if let Some(last) = facets.last() {
            let corner = last.edge.point(corner_z);
            between(&mut outermost, path.moved(Vector { x: corner.x, z: corner.z }), lean, side.turn());
        }
    }
}

/// A chain of the lowest (or highest) of all the edges it took.
struct Outermost<'a> {
    chain: &'a mut Chain,
    before: &'a mut Chain,
    side: Side,
}

impl Outermost<'_> {
    /// Begins with nothing between two Z: an edge that every other lies beyond.
    fn restart(&mut self, from: f64, to: f64) {
        self.chain.restart(from);
        self.chain.push(to, Curve::level(f64::INFINITY * self.side.turn()));
    }

    /// Takes an edge between two Z where it lies beyond those taken so far.
    fn take(&mut self, from: f64, to: f64, edge: Curve) {
        std::mem::swap(self.chain, self.before);
        let chain = &mut *self.chain;
        chain.restart(self.before.from);
        for (start, end, old) in self.before.pieces() {
            let (a, b) = (from.max(start), to.min(end));
            if b - a <= WELD_MM {
                chain.go_on(end, old);
                continue;
            }
            chain.go_on(a, old);
            let mut stops = edge.crossings(&old);
            stops.sort_by(f64::total_cmp);
            let mut low = a;
            for stop in stops.into_iter().filter(|stop| a < *stop && *stop < b).chain([b]) {
                let column = Column::new(low, stop);
                let (height, _) = column.height(&column.across(&edge), &column.across(&old));
                let is_beyond = height * self.side.turn() < 0.0;
                chain.go_on(stop, if is_beyond { edge } else { old });
                low = stop;
            }
            chain.go_on(end, old);
        }
    }
}

fn sorted(a: f64, b: f64) -> (f64, f64) {
    if a < b { (a, b) } else { (b, a) }
}
