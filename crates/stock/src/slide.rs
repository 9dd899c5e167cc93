//! A convex shape along a line.
//!
//! Both sides of a convex shape are sorted by lean. Sliding it along a line puts the line into each side where its
//! lean belongs: what comes before stands where the way begins, what comes behind where it ends. An arc is parted
//! where the way is its tangent. Nothing is approximated.

use turnwright_geometry::{Point, Vector};

use crate::WELD_MM;
use crate::chain::{Chain, Side};
use crate::curve::Curve;
use crate::cutter::Convex;

/// Writes one side of a shape that moves from `left` to `right` (not to the left).
pub(crate) fn slide(chain: &mut Chain, part: &Convex, side: Side, left: Point, right: Point) {
    let (start, end) = (Vector { x: left.x, z: left.z }, Vector { x: right.x, z: right.z });
    let (dz, dx) = (right.z - left.z, right.x - left.x);
    chain.restart(part.from + start.z);
    if dz <= WELD_MM {
        // Upright: the place that reaches further towards this side counts.
        let is_end = dx * side.turn() < 0.0;
        let way = if is_end { end } else { start };
        part.side(side)
            .iter()
            .for_each(|facet| chain.push(facet.to + start.z, facet.edge.moved(Vector { z: start.z, ..way })));
        return;
    }
    let lean = dx / (dz * dz + dx * dx).sqrt();
    let turn = side.turn();
    let line = |chain: &mut Chain, from: Point| {
        let (from, to) = (start.from(from), end.from(from));
        chain.push(to.z, Curve::through(from, to));
    };
    let (mut is_past, mut z) = (false, part.from);
    for facet in part.side(side) {
        if !is_past && (facet.last - lean) * turn > 0.0 {
            is_past = true;
            let touch = facet.edge.leaning(lean).map_or(z, |touch| touch.clamp(z, facet.to));
            chain.push(touch + start.z, facet.edge.moved(start));
            line(chain, facet.edge.point(touch));
        }
        let way = if is_past { end } else { start };
        chain.push(facet.to + way.z, facet.edge.moved(way));
        z = facet.to;
    }
    if let Some(last) = part.side(side).last().filter(|_| !is_past) {
        line(chain, last.edge.point(last.to));
    }
}
