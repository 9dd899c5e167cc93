//! The ways of moves, as lines and arcs.

use turnwright_canon::{RapidPath, Shape, Turn};
use turnwright_geometry::{Bend, CurveArcs, Point, Segment, Vector, sweep_rad};
use turnwright_units::{Position, WorkTip};

use super::RapidRates;

/// How far arcs lie from the ellipses and parabolas that they stand for: a hundredth of a micrometre.
const CONIC_MM: f64 = 1e-5;

pub(super) fn point(position: Position<WorkTip>) -> Point {
    Point::new(position.x.to_mm(), position.z.to_mm())
}

/// The one or two lines of a rapid move.
pub fn rapid_edges(
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    path: RapidPath,
    rates: RapidRates,
) -> impl Iterator<Item = Segment> {
    rapid_ways(point(from), point(to), path, rates)
}

/// The one or two lines of a rapid move.
pub(super) fn rapid_ways(
    from: Point,
    to: Point,
    path: RapidPath,
    rates: RapidRates,
) -> impl Iterator<Item = Segment> {
    let corner = match path {
        RapidPath::Straight => to,
        RapidPath::EachAxis | RapidPath::Home => {
            let (dz, dx) = (to.z - from.z, to.x - from.x);
            let seconds = |way: f64, rate: f64| if rate > 0.0 { way.abs() / rate } else { 0.0 };
            let (x, z) = (seconds(dx, rates.x_mm_per_min), seconds(dz, rates.z_mm_per_min));
            if x == 0.0 || z == 0.0 {
                to
            } else if x < z {
                Point { x: to.x, z: from.z + dz * (x / z) }
            } else {
                Point { x: from.x + dx * (z / x), z: to.z }
            }
        }
    };
    let line = |start, end| Segment { start, end, bend: None };
    [line(from, corner), line(corner, to)].into_iter().filter(|way| way.start != way.end)
}

/// Whether a shape lies in the half-section.
pub(super) const fn is_in_section(shape: &Shape) -> bool {
    !matches!(shape, Shape::SideArc { .. })
}

/// The lines and arcs of a cutting move.
pub(super) enum Ways {
    One(Option<Segment>),
    Conic(Point, CurveArcs),
}

/// The lines and arcs of a cutting move: ellipses and parabolas become arcs.
pub fn edges(from: Position<WorkTip>, to: Position<WorkTip>, shape: &Shape) -> impl Iterator<Item = Segment> {
    ways(from, to, shape)
}

pub(super) fn ways(from: Position<WorkTip>, to: Position<WorkTip>, shape: &Shape) -> Ways {
    let one = |bend| Ways::One(Some(Segment { start: point(from), end: point(to), bend }));
    match shape {
        Shape::Line | Shape::SideArc { .. } => one(None),
        Shape::Arc { turn, centre } => {
            one(Some(Bend { centre: point(*centre), clockwise: *turn == Turn::Clockwise }))
        }
        Shape::Curve(curve) => Ways::Conic(point(from), curve.path(from, to).arcs(CONIC_MM)),
    }
}

impl Iterator for Ways {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        match self {
            Self::One(way) => way.take(),
            Self::Conic(at, arcs) => {
                let arc = arcs.next()?;
                let start = std::mem::replace(at, arc.end);
                Some(Segment { start, end: arc.end, bend: arc.bend })
            }
        }
    }
}

/// The place at a share of a way.
pub(super) fn at(way: &Segment, share: f64) -> Point {
    let Some(bend) = way.bend else {
        return Vector::between(way.start, way.end).times(share).from(way.start);
    };
    let angle = sweep_rad(way.start, way.end, bend.centre, bend.clockwise) * share;
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let arm = Vector::between(bend.centre, way.start);
    Vector { x: arm.x * cosine + arm.z * sine, z: arm.z * cosine - arm.x * sine }.from(bend.centre)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATES: RapidRates = RapidRates { x_mm_per_min: 10_000.0, z_mm_per_min: 20_000.0 };

    fn legs(from: Point, to: Point, path: RapidPath) -> Vec<Point> {
        rapid_ways(from, to, path, RATES).map(|way| way.end).collect()
    }

    #[test]
    fn the_shorter_way_ends_first() {
        let (from, to) = (Point::new(50., 10.), Point::new(40., -50.));
        // 10 mm of X take as long as 20 mm of Z.
        assert_eq!(legs(from, to, RapidPath::EachAxis), [Point::new(40., -10.), to]);
        assert_eq!(legs(to, from, RapidPath::EachAxis), [Point::new(50., -30.), from]);
        let steep = Point::new(20., -10.);
        assert_eq!(legs(from, steep, RapidPath::EachAxis), [Point::new(40., -10.), steep]);
        assert_eq!(legs(from, to, RapidPath::Straight), [to]);
        let along = Point::new(50., -5.);
        assert_eq!(legs(from, along, RapidPath::EachAxis), [along]);
        assert!(legs(from, from, RapidPath::EachAxis).is_empty());
    }
}
