//! Outlines taken apart into slabs: between two neighbouring Z of its corners, an outline is a stack of bands.

use turnwright_geometry::{Bend, Outline, Point, Segment};

use crate::WELD_MM;
use crate::band::Band;
use crate::curve::Curve;

/// What an outline holds between two Z.
#[derive(Clone, Debug)]
pub(crate) struct OutlineSlab {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// From the axis outwards.
    pub(crate) bands: Vec<Band>,
}

/// An edge of an outline with its ends.
struct Ended {
    from: f64,
    to: f64,
    edge: Curve,
}

/// The slabs of an outline, along Z.
pub(crate) fn slabs_of(outline: &Outline) -> Vec<OutlineSlab> {
    let mut edges = Vec::new();
    outline.segments().iter().for_each(|segment| edges_of(segment, &mut edges));
    let mut stops: Vec<f64> = edges.iter().flat_map(|edge| [edge.from, edge.to]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|next, before| *next - *before <= WELD_MM);
    let slab = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        let middle = (from + to) / 2.0;
        let across = edges.iter().filter(|edge| edge.from < middle && middle < edge.to);
        let mut stack: Vec<Curve> = across.map(|edge| edge.edge).collect();
        stack.sort_by(|a, b| a.at(middle).total_cmp(&b.at(middle)));
        let bands = stack.chunks_exact(2).map(|pair| Band { floor: pair[0], roof: pair[1] }).collect();
        OutlineSlab { from, to, bands }
    };
    stops.windows(2).map(slab).collect()
}

/// The parts of a segment that are functions of Z; upright lines have none.
fn edges_of(segment: &Segment, edges: &mut Vec<Ended>) {
    match segment.bend {
        None => {
            let (start, end) = (segment.start, segment.end);
            let (from, to) = (start.z.min(end.z), start.z.max(end.z));
            if to - from > WELD_MM {
                edges.push(Ended { from, to, edge: Curve::through(start, end) });
            }
        }
        Some(bend) => half_circles(segment.start, segment.end, bend, |from, to, edge| {
            edges.push(Ended { from: from.min(to), to: from.max(to), edge });
        }),
    }
}

/// Splits an arc where it turns back along Z: the parts from start to end, each with its first and last Z.
pub(crate) fn half_circles(start: Point, end: Point, bend: Bend, mut part: impl FnMut(f64, f64, Curve)) {
    use std::f64::consts::{PI, TAU};
    let centre = bend.centre;
    let radius = (start.distance(centre) + end.distance(centre)) / 2.0;
    let angle = |point: Point| libm::atan2(point.x - centre.x, point.z - centre.z);
    let sense = if bend.clockwise { -1.0 } else { 1.0 };
    let first = angle(start);
    let mut swept = ((angle(end) - first) * sense).rem_euclid(TAU);
    // A nanometre of way is no arc: start and end are one, and the arc goes all the way round.
    if swept * radius < WELD_MM || start == end {
        swept = TAU;
    }
    let mut from = (start.z, 0.0);
    // The outermost places along Z are at whole multiples of half a turn.
    let next = |travelled: f64| {
        let halves = (first + sense * travelled) / PI * sense;
        ((halves + 1e-12).floor() + 1.0 - halves) * PI + travelled
    };
    for _ in 0..4 {
        let stop = next(from.1);
        let is_last = stop >= swept - 1e-12;
        let middle = first + sense * (from.1 + stop.min(swept)) / 2.0;
        let side = libm::cos(first + sense * stop).signum();
        let to = if is_last { (end.z, swept) } else { (centre.z + side * radius, stop) };
        let half = radius.copysign(libm::sin(middle));
        if (to.0 - from.0).abs() > WELD_MM {
            part(from.0, to.0, Curve::Arc { z: centre.z, x: centre.x, radius: half });
        }
        if is_last {
            return;
        }
        from = to;
    }
}
