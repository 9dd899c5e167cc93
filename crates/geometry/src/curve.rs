//! Parts of ellipses and parabolas, and the arcs that stand for them.
//!
//! In: the ends of a cut and the conic it follows. Out: where the conic must lie ([`ellipse_centre`],
//! [`parabola_vertex`], [`circle_through`]), and a [`CurvePath`] with exact ends, which [`CurvePath::arcs`] turns into
//! arcs of circles within a stated tolerance.
//!
//! A conic has a frame of its own: u runs along its tilt (an angle from +Z), v a quarter turn counter-clockwise from
//! it. Invariants: the first and last point are the ends given, to the last bit; nothing is allocated.

use crate::{ArcFault, Bend, Point, centre_from_radius, sweep_rad};

/// What a curve is a part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Conic {
    /// `(u / along)² + (v / across)² = 1`.
    Ellipse {
        /// Half axis along the tilt, mm.
        along_mm: f64,
        /// Half axis across it, mm.
        across_mm: f64,
    },
    /// `v² = 2 · focal_parameter · u`: opens along the tilt.
    Parabola {
        /// From focus to directrix, mm, more than zero.
        focal_parameter_mm: f64,
    },
}

/// A right-handed frame in the half-section.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    origin: Point,
    cosine: f64,
    sine: f64,
}

impl Frame {
    fn new(origin: Point, tilt_rad: f64) -> Self {
        Self { origin, cosine: libm::cos(tilt_rad), sine: libm::sin(tilt_rad) }
    }

    /// (u, v) of a place.
    fn enter(&self, place: Point) -> (f64, f64) {
        let (z, x) = (place.z - self.origin.z, place.x - self.origin.x);
        (z * self.cosine + x * self.sine, x * self.cosine - z * self.sine)
    }

    fn leave(&self, (u, v): (f64, f64)) -> Point {
        Point {
            z: self.origin.z + u * self.cosine - v * self.sine,
            x: self.origin.x + u * self.sine + v * self.cosine,
        }
    }
}

/// The centre and turn (true: clockwise) of the circle through three places in this order; `None` when they lie on
/// one line.
pub fn circle_through(start: Point, middle: Point, end: Point) -> Option<(Point, bool)> {
    // Seen from the start, so that places far from the origin lose no digits.
    let (bz, bx) = (middle.z - start.z, middle.x - start.x);
    let (cz, cx) = (end.z - start.z, end.x - start.x);
    let cross = bz * cx - bx * cz;
    if cross == 0.0 {
        return None;
    }
    let (b, c) = (bz * bz + bx * bx, cz * cz + cx * cx);
    let centre = Point {
        z: start.z + (b * cx - c * bx) / (2.0 * cross),
        x: start.x + (c * bz - b * cz) / (2.0 * cross),
    };
    // A middle to the right of the chord is passed counter-clockwise.
    Some((centre, cross < 0.0))
}

/// The centre of an ellipse of given half axes and tilt through two places, so that the part between them is at most
/// half of it.
///
/// # Errors
/// [`ArcFault`] as for circles: the places may lie further apart than the ellipse is wide by `tolerance_mm`.
pub fn ellipse_centre(
    start: Point,
    end: Point,
    (along_mm, across_mm): (f64, f64),
    tilt_rad: f64,
    clockwise: bool,
    tolerance_mm: f64,
) -> Result<Point, ArcFault> {
    let frame = Frame::new(start, tilt_rad);
    // Stretched so that the ellipse is a circle of radius 1.
    let (u, v) = frame.enter(end);
    let stretched = Point { z: u / along_mm, x: v / across_mm };
    let tolerance = tolerance_mm / along_mm.max(across_mm);
    let centre = centre_from_radius(Point::default(), stretched, 1.0, clockwise, tolerance)?;
    Ok(frame.leave((centre.z * along_mm, centre.x * across_mm)))
}

/// The vertex of the parabola through two places, and whether it opens against the tilt: only one side gives the turn
/// asked for. `None` when the places lie on a parallel to its axis.
pub fn parabola_vertex(
    start: Point,
    end: Point,
    focal_parameter_mm: f64,
    tilt_rad: f64,
    clockwise: bool,
) -> Option<(Point, bool)> {
    let frame = Frame::new(start, tilt_rad);
    let (u, v) = frame.enter(end);
    // Seen along the axis into the opening, a clockwise cut runs from right to left.
    let opens_back = (v > 0.0) != clockwise;
    let parameter = if opens_back { -focal_parameter_mm } else { focal_parameter_mm };
    let vertex_v = v / 2.0 - parameter * u / v;
    let vertex = (-vertex_v * vertex_v / (2.0 * parameter), vertex_v);
    (v != 0.0 && vertex.0.is_finite()).then(|| (frame.leave(vertex), opens_back))
}

/// A part of a conic from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePath {
    start: Point,
    end: Point,
    conic: Conic,
    frame: Frame,
    /// The parameter at the start (angle of the stretched ellipse, rad; v of the parabola, mm) and its signed way.
    from: f64,
    way: f64,
    /// From the conic to the true ends: what rounding of its data has left.
    start_gap: Point,
    end_gap: Point,
}

impl CurvePath {
    /// The part from `start` to `end` of a conic whose centre or vertex is `origin`. `clockwise` chooses the side of
    /// an ellipse; a parabola has only one.
    pub fn new(
        start: Point,
        end: Point,
        conic: Conic,
        origin: Point,
        tilt_rad: f64,
        clockwise: bool,
    ) -> Self {
        let frame = Frame::new(origin, tilt_rad);
        let (from, way) = match conic {
            Conic::Ellipse { along_mm, across_mm } => {
                let stretched = |place| {
                    let (u, v) = frame.enter(place);
                    Point { z: u / along_mm, x: v / across_mm }
                };
                let (start, end) = (stretched(start), stretched(end));
                (libm::atan2(start.x, start.z), sweep_rad(start, end, Point::default(), clockwise))
            }
            Conic::Parabola { .. } => {
                let (start, end) = (frame.enter(start).1, frame.enter(end).1);
                (start, end - start)
            }
        };
        let none = Point::default();
        let mut path = Self { start, end, conic, frame, from, way, start_gap: none, end_gap: none };
        let gap = |true_end: Point, computed: Point| Point {
            x: true_end.x - computed.x,
            z: true_end.z - computed.z,
        };
        path.start_gap = gap(start, path.on_conic(0.0));
        path.end_gap = gap(end, path.on_conic(1.0));
        path
    }

    fn on_conic(&self, share: f64) -> Point {
        let parameter = self.from + self.way * share;
        self.frame.leave(match self.conic {
            Conic::Ellipse { along_mm, across_mm } => {
                (along_mm * libm::cos(parameter), across_mm * libm::sin(parameter))
            }
            Conic::Parabola { focal_parameter_mm } => {
                (parameter * parameter / (2.0 * focal_parameter_mm), parameter)
            }
        })
    }

    /// The place after `share` (0 to 1) of the parameter's way.
    pub fn point_at(&self, share: f64) -> Point {
        if share <= 0.0 {
            return self.start;
        }
        if share >= 1.0 {
            return self.end;
        }
        let (place, left) = (self.on_conic(share), 1.0 - share);
        Point {
            x: place.x + self.start_gap.x * left + self.end_gap.x * share,
            z: place.z + self.start_gap.z * left + self.end_gap.z * share,
        }
    }

    /// Arcs that follow the curve from end to end and stay within `tolerance_mm` of it.
    pub fn arcs(&self, tolerance_mm: f64) -> CurveArcs {
        CurveArcs { path: *self, tolerance_mm, at: self.start, index: 0, level: 0 }
    }

    /// The arc through the curve's places at three shares, and how far the curve lies from it.
    fn arc_between(&self, start: Point, from: f64, to: f64) -> (CurveArc, f64) {
        /// More than a kilometre of radius bends a machine's length by less than any increment.
        const RADIUS_MAX_MM: f64 = 1e6;
        let at = |part: f64| self.point_at(from + (to - from) * part);
        let end = at(1.0);
        let circle = circle_through(start, at(0.5), end)
            .map(|(centre, clockwise)| (Bend { centre, clockwise }, centre.distance(start)))
            .filter(|(_, radius_mm)| *radius_mm <= RADIUS_MAX_MM);
        let chord_mm = start.distance(end);
        let off = |place: Point| match circle {
            Some((bend, radius_mm)) => (place.distance(bend.centre) - radius_mm).abs(),
            None => {
                let (z, x) = (end.z - start.z, end.x - start.x);
                ((place.z - start.z) * x - (place.x - start.x) * z).abs() / chord_mm.max(f64::MIN_POSITIVE)
            }
        };
        /// The furthest place lies between two that are looked at, and a little further out than they do.
        const BETWEEN: f64 = 1.25;
        let looked_at = [0.125, 0.21, 0.375, 0.5, 0.625, 0.79, 0.875];
        let error_mm = looked_at.into_iter().map(|part| off(at(part))).fold(0.0, f64::max) * BETWEEN;
        (CurveArc { end, bend: circle.map(|(bend, _)| bend) }, error_mm)
    }
}

/// One of the arcs that stand for a curve. It begins where the one before ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveArc {
    /// Where it ends.
    pub end: Point,
    /// Its circle; `None` for a straight piece.
    pub bend: Option<Bend>,
}

/// The arcs of a curve, in order: halves of halves, each as long as the tolerance lets it be.
#[derive(Clone, Debug)]
pub struct CurveArcs {
    path: CurvePath,
    tolerance_mm: f64,
    at: Point,
    /// The next piece is number `index` of `2^level` equal ones.
    index: u32,
    level: u32,
}

/// Halvings of a curve: 65,536 arcs at most, whatever the tolerance.
const LEVEL_MAX: u32 = 16;

impl Iterator for CurveArcs {
    type Item = CurveArc;

    fn next(&mut self) -> Option<CurveArc> {
        if self.index == 1 << self.level {
            return None;
        }
        loop {
            let pieces = f64::from(1u32 << self.level);
            let (from, to) = (f64::from(self.index) / pieces, f64::from(self.index + 1) / pieces);
            let (arc, error_mm) = self.path.arc_between(self.at, from, to);
            if error_mm > self.tolerance_mm && self.level < LEVEL_MAX {
                (self.index, self.level) = (self.index * 2, self.level + 1);
                continue;
            }
            self.index += 1;
            while self.level > 0 && self.index.is_multiple_of(2) {
                (self.index, self.level) = (self.index / 2, self.level - 1);
            }
            self.at = arc.end;
            return Some(arc);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_give_the_circle_and_its_turn() {
        // From the top of a circle of radius 5 about X0 Z0 over its right to its bottom: clockwise.
        let (top, right, bottom) = (Point::new(5.0, 0.0), Point::new(0.0, 5.0), Point::new(-5.0, 0.0));
        let (centre, clockwise) = circle_through(top, right, bottom).expect("a circle");
        assert!(centre.distance(Point::default()) < 1e-12 && clockwise);
        assert!(!circle_through(bottom, right, top).expect("a circle").1);
        assert_eq!(circle_through(top, Point::default(), bottom), None);
    }

    #[test]
    fn a_quarter_of_an_ellipse_is_found_from_its_ends() {
        // Half axes 10 along Z and 5 along X about the origin, from its right end to its top.
        let (right, top) = (Point::new(0.0, 10.0), Point::new(5.0, 0.0));
        let centre = ellipse_centre(right, top, (10.0, 5.0), 0.0, false, 0.0).expect("an ellipse");
        assert!(centre.distance(Point::default()) < 1e-12, "{centre:?}");
        let conic = Conic::Ellipse { along_mm: 10.0, across_mm: 5.0 };
        let middle = CurvePath::new(right, top, conic, centre, 0.0, false).point_at(0.5);
        let (z, x) = (10.0 * 0.5f64.sqrt(), 5.0 * 0.5f64.sqrt());
        assert!(middle.distance(Point::new(x, z)) < 1e-12, "{middle:?}");
        let far = ellipse_centre(right, Point::new(0.0, -10.5), (10.0, 5.0), 0.0, false, 0.001);
        assert!(matches!(far, Err(ArcFault::RadiusTooSmall { .. })));
    }

    #[test]
    fn the_turn_chooses_the_side_that_a_parabola_opens_to() {
        // x² = 2·5·(−z): vertex at the origin, opens to −Z; from the vertex up to X10 Z−10.
        let (vertex, end) = (Point::default(), Point::new(10.0, -10.0));
        let (found, opens_back) = parabola_vertex(vertex, end, 5.0, 0.0, false).expect("a parabola");
        assert!(found.distance(vertex) < 1e-12 && opens_back);
        let (other, opens_back) = parabola_vertex(vertex, end, 5.0, 0.0, true).expect("a parabola");
        assert!(other.distance(vertex) > 1.0 && !opens_back);
        assert_eq!(parabola_vertex(vertex, Point::new(0.0, -10.0), 5.0, 0.0, true), None);
    }

    #[test]
    fn arcs_of_a_circle_are_one_arc() {
        let conic = Conic::Ellipse { along_mm: 7.0, across_mm: 7.0 };
        let (start, end) = (Point::new(0.0, 7.0), Point::new(7.0, 0.0));
        let path = CurvePath::new(start, end, conic, Point::default(), 0.3, false);
        assert_eq!(path.arcs(1e-9).count(), 1);
    }
}
