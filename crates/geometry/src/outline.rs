//! Closed outlines of lines and arcs: the shape of an insert, a holder, a jaw, or the section of a blank.
//!
//! In: segments one after the other, either way round. Out: an [`Outline`] that is closed to the last bit, runs
//! counter-clockwise, encloses an area, and neither crosses nor touches itself; or an [`OutlineFault`] that says
//! where it is not so. An outline is relative to whatever its owner chose: a tool's to its programmed point.

use std::f64::consts::PI;

use crate::track::Track;
use crate::vector::Vector;
use crate::{Bend, Point, Segment};

/// Ends nearer than this are one corner, and an arc's ends may differ so much in their distance from its centre:
/// one nanometre, the rounding of exact lengths.
pub const CORNER_MM: f64 = 1e-6;

/// An outline has no more segments: every one is compared with every other.
pub const OUTLINE_SEGMENTS_MAX: usize = 2_000;

/// A coordinate is no larger, mm: a kilometre is beyond every lathe.
pub const OUTLINE_MM_MAX: f64 = 1e6;

/// A closed counter-clockwise loop of lines and arcs.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    segments: Vec<Segment>,
}

/// Why segments are no outline; indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineFault {
    /// There are none, or more than [`OUTLINE_SEGMENTS_MAX`].
    Count(usize),
    /// A coordinate of this segment is not a number, or larger than [`OUTLINE_MM_MAX`].
    Size(usize),
    /// This segment is shorter than [`CORNER_MM`].
    Short(usize),
    /// The ends of this arc lie at distances from its centre that differ by so much, or on it.
    Radius {
        /// Which segment.
        segment: usize,
        /// The difference, mm.
        difference_mm: f64,
    },
    /// This segment does not end where the next starts.
    Gap {
        /// Which segment.
        segment: usize,
        /// How wide it gapes, mm.
        gap_mm: f64,
    },
    /// Two segments meet away from a corner that they share.
    Crossing {
        /// The earlier one.
        first: usize,
        /// The later one.
        second: usize,
        /// Where.
        at: Point,
    },
    /// It encloses nothing.
    NoArea,
}

/// The smallest upright rectangle round something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest X and lowest Z.
    pub min: Point,
    /// Highest X and highest Z.
    pub max: Point,
}

impl Outline {
    /// An outline of segments that follow each other, in either sense.
    ///
    /// # Errors
    /// [`OutlineFault`] when they do not close, cross, or enclose nothing.
    pub fn new(mut segments: Vec<Segment>) -> Result<Self, OutlineFault> {
        if segments.is_empty() || segments.len() > OUTLINE_SEGMENTS_MAX {
            return Err(OutlineFault::Count(segments.len()));
        }
        for (index, segment) in segments.iter().enumerate() {
            check_segment(index, segment, segments.len() == 1)?;
        }
        close(&mut segments)?;
        for second in 1..segments.len() {
            for first in 0..second {
                if let Some(at) = meeting(&segments, first, second) {
                    return Err(OutlineFault::Crossing { first, second, at });
                }
            }
        }
        let area_mm2: f64 = segments.iter().map(Segment::area_beside_axis_mm2).sum();
        let bounds = bounds(&segments);
        let (wide, high) = (bounds.max.z - bounds.min.z, bounds.max.x - bounds.min.x);
        if area_mm2.abs() <= CORNER_MM * wide.max(high) {
            return Err(OutlineFault::NoArea);
        }
        if area_mm2 < 0.0 {
            segments.reverse();
            segments.iter_mut().for_each(|segment| *segment = segment.reversed());
        }
        Ok(Self { segments })
    }

    /// An outline of straight lines from each point to the next, and from the last to the first.
    ///
    /// # Errors
    /// As [`Outline::new`].
    pub fn polygon(points: &[Point]) -> Result<Self, OutlineFault> {
        let ends = points.iter().cycle().skip(1);
        Self::new(points.iter().zip(ends).map(|(&start, &end)| Segment { start, end, bend: None }).collect())
    }

    /// A full circle.
    ///
    /// # Errors
    /// As [`Outline::new`].
    pub fn circle(centre: Point, radius_mm: f64) -> Result<Self, OutlineFault> {
        let bend = Some(Bend { centre, clockwise: false });
        let (right, left) =
            (Point::new(centre.x, centre.z + radius_mm), Point::new(centre.x, centre.z - radius_mm));
        Self::new(vec![Segment { start: right, end: left, bend }, Segment { start: left, end: right, bend }])
    }

    /// An upright rectangle between two opposite corners.
    ///
    /// # Errors
    /// As [`Outline::new`].
    pub fn rectangle(corner: Point, opposite: Point) -> Result<Self, OutlineFault> {
        let (a, c) = (corner, opposite);
        Self::polygon(&[a, Point::new(a.x, c.z), c, Point::new(c.x, a.z)])
    }

    /// Its lines and arcs, counter-clockwise; each starts exactly where the one before ends.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// What it encloses, mm².
    pub fn area_mm2(&self) -> f64 {
        self.segments.iter().map(Segment::area_beside_axis_mm2).sum()
    }

    /// The upright rectangle round it.
    pub fn bounds(&self) -> Bounds {
        bounds(&self.segments)
    }

    /// The outline somewhere else.
    #[must_use]
    pub fn moved(&self, way: Vector) -> Self {
        Self { segments: self.segments.iter().map(|segment| segment.moved(way)).collect() }
    }

    /// Left and right changed about Z = 0: a tool of the other hand.
    #[must_use]
    pub fn mirrored_in_z(&self) -> Self {
        self.mirrored(|point| Point { z: -point.z, ..point })
    }

    /// Up and down changed about X = 0: an outer tool as an inner one, or on the other side of the axis.
    #[must_use]
    pub fn mirrored_in_x(&self) -> Self {
        self.mirrored(|point| Point { x: -point.x, ..point })
    }

    fn mirrored(&self, image: impl Fn(Point) -> Point) -> Self {
        let mirrored = self.segments.iter().rev().map(|segment| Segment {
            start: image(segment.end),
            end: image(segment.start),
            // Turned round by the mirror and back by being run the other way.
            bend: segment.bend.map(|bend| Bend { centre: image(bend.centre), ..bend }),
        });
        Self { segments: mirrored.collect() }
    }

    /// Whether a place lies inside; of a place on the outline either answer may come.
    pub fn contains(&self, place: Point) -> bool {
        let above = self.segments.iter().map(|segment| segment.crossings_above(place)).sum::<usize>();
        above % 2 == 1
    }
}

fn check_segment(index: usize, segment: &Segment, is_alone: bool) -> Result<(), OutlineFault> {
    let places = [Some(segment.start), Some(segment.end), segment.bend.map(|bend| bend.centre)];
    let fits = |value: f64| value.abs() <= OUTLINE_MM_MAX;
    if !places.into_iter().flatten().all(|place| fits(place.x) && fits(place.z)) {
        return Err(OutlineFault::Size(index));
    }
    if segment.start.distance(segment.end) < CORNER_MM && !(is_alone && segment.bend.is_some()) {
        return Err(OutlineFault::Short(index));
    }
    if let Some(bend) = segment.bend {
        let (start_mm, end_mm) = (segment.start.distance(bend.centre), segment.end.distance(bend.centre));
        let difference_mm = (start_mm - end_mm).abs();
        if difference_mm > CORNER_MM || start_mm < CORNER_MM {
            return Err(OutlineFault::Radius { segment: index, difference_mm });
        }
    }
    Ok(())
}

/// Lets every segment end exactly where the next starts.
fn close(segments: &mut [Segment]) -> Result<(), OutlineFault> {
    for index in 0..segments.len() {
        let next = segments[(index + 1) % segments.len()].start;
        let gap_mm = segments[index].end.distance(next);
        if gap_mm > CORNER_MM {
            return Err(OutlineFault::Gap { segment: index, gap_mm });
        }
        segments[index].end = next;
    }
    Ok(())
}

/// Where two segments meet, other than in a corner between them.
fn meeting(segments: &[Segment], first: usize, second: usize) -> Option<Point> {
    let (one, other) = (&segments[first], &segments[second]);
    if !bounds(&[*one]).meets(&bounds(&[*other]), CORNER_MM) {
        return None;
    }
    let follows = first + 1 == second;
    let closes = (second + 1) % segments.len() == first;
    let is_corner = |place: Point| {
        (follows && place.distance(one.end) <= CORNER_MM)
            || (closes && place.distance(one.start) <= CORNER_MM)
    };
    let crossings = match (Track::beside(one, 0.0), Track::beside(other, 0.0)) {
        (Some(a), Some(b)) => a.crossings(&b),
        _ => [None; 2],
    };
    let crossings =
        crossings.into_iter().flatten().filter(|place| one.passes(*place) && other.passes(*place));
    let ends_of_other = [other.start, other.end].into_iter().filter(|place| one.passes(*place));
    let ends_of_one = [one.start, one.end].into_iter().filter(|place| other.passes(*place));
    crossings.chain(ends_of_other).chain(ends_of_one).find(|place| !is_corner(*place))
}

fn bounds(segments: &[Segment]) -> Bounds {
    let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
    let nothing = Bounds { min: Point::new(high, high), max: Point::new(low, low) };
    segments.iter().fold(nothing, |bounds, segment| {
        let bounds = bounds.with(segment.start).with(segment.end);
        segment.extremes().fold(bounds, Bounds::with)
    })
}

impl Bounds {
    /// The rectangle that holds this place too.
    #[must_use]
    pub fn with(self, place: Point) -> Self {
        Self {
            min: Point::new(self.min.x.min(place.x), self.min.z.min(place.z)),
            max: Point::new(self.max.x.max(place.x), self.max.z.max(place.z)),
        }
    }

    /// Whether two rectangles come as near as `slack_mm`.
    pub fn meets(&self, other: &Self, slack_mm: f64) -> bool {
        self.min.z <= other.max.z + slack_mm
            && other.min.z <= self.max.z + slack_mm
            && self.min.x <= other.max.x + slack_mm
            && other.min.x <= self.max.x + slack_mm
    }
}

impl Segment {
    /// The angle of an arc, negative when clockwise; 0 of a line.
    pub fn sweep_rad(&self) -> f64 {
        self.bend.map_or(0.0, |bend| bend.sense() * self.sweep(bend))
    }

    /// The same way back.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let bend = self.bend.map(|bend| Bend { clockwise: !bend.clockwise, ..bend });
        Self { start: self.end, end: self.start, bend }
    }

    /// Whether a place lies on it, give or take a corner.
    fn passes(&self, place: Point) -> bool {
        let off = match self.bend {
            None => {
                let way = Vector::between(self.start, self.end);
                way.cross(Vector::between(self.start, place)) / way.length()
            }
            Some(bend) => bend.centre.distance(place) - self.radius(),
        };
        off.abs() <= CORNER_MM && self.holds(place, CORNER_MM)
    }

    /// The points of an arc with the lowest and highest X and Z of its circle, those that it passes.
    fn extremes(&self) -> impl Iterator<Item = Point> + '_ {
        self.bend.into_iter().flat_map(move |bend| {
            let radius = self.radius();
            let sides = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
            let points =
                sides.map(|(x, z)| Point::new(bend.centre.x + x * radius, bend.centre.z + z * radius));
            points.into_iter().filter(move |point| self.holds(*point, 0.0))
        })
    }

    /// The area that the way from start to end passes on its left, down to the spindle axis; against Z it counts
    /// as positive, so that a counter-clockwise loop adds up to what it encloses.
    pub fn area_beside_axis_mm2(&self) -> f64 {
        let below = (self.start.z - self.end.z) * (self.start.x + self.end.x) / 2.0;
        let bulge = self.bend.map_or(0.0, |bend| {
            let (radius, sweep) = (self.radius(), self.sweep(bend));
            bend.sense() * radius * radius / 2.0 * (sweep - libm::sin(sweep))
        });
        below + bulge
    }

    /// The same of the volume that it passes when it turns round the spindle axis.
    pub fn volume_round_axis_mm3(&self) -> f64 {
        let (start, end) = (self.start, self.end);
        let Some(bend) = self.bend else {
            return PI / 3.0 * (start.z - end.z) * (start.x * start.x + start.x * end.x + end.x * end.x);
        };
        // X is `centre + radius · sin`, Z runs by `−radius · sin`.
        let (radius, centre) = (self.radius(), bend.centre.x);
        let from = libm::atan2(start.x - centre, start.z - bend.centre.z);
        let passed = |angle: f64| {
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let ring = centre * radius * (angle - sine * cosine);
            ring - centre * centre * cosine + radius * radius * cosine * (cosine * cosine / 3.0 - 1.0)
        };
        PI * radius * (passed(from + self.sweep_rad()) - passed(from))
    }

    /// How often a ray from `place` towards higher X crosses the element.
    pub fn crossings_above(&self, place: Point) -> usize {
        let passes = |from: f64, to: f64| (from <= place.z) != (to <= place.z);
        let Some(bend) = self.bend else {
            let way = (place.z - self.start.z) / (self.end.z - self.start.z);
            let x = self.start.x + way * (self.end.x - self.start.x);
            return usize::from(passes(self.start.z, self.end.z) && x > place.x);
        };
        // Between the outermost places along Z an arc runs one way, on the upper or on the lower side.
        let radius = self.radius();
        let turns = [1.0, -1.0].map(|side| Point::new(bend.centre.x, bend.centre.z + side * radius));
        let mut inner: Vec<Point> = turns.into_iter().filter(|turn| self.holds(*turn, 0.0)).collect();
        inner.sort_by(|a, b| {
            self.travelled(bend, self.start, *a).total_cmp(&self.travelled(bend, self.start, *b))
        });
        let stops: Vec<Point> = [self.start].into_iter().chain(inner).chain([self.end]).collect();
        let crossed = |pair: &&[Point]| {
            let (from, to) = (pair[0], pair[1]);
            let is_upper = (to.z < from.z) != bend.clockwise;
            let off_z = place.z - bend.centre.z;
            let half = (radius * radius - off_z * off_z).max(0.0).sqrt();
            let x = if is_upper { bend.centre.x + half } else { bend.centre.x - half };
            passes(from.z, to.z) && x > place.x
        };
        stops.windows(2).filter(crossed).count()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn point(x: f64, z: f64) -> Point {
        Point::new(x, z)
    }

    fn line(start: Point, end: Point) -> Segment {
        Segment { start, end, bend: None }
    }

    fn arc(start: Point, end: Point, centre: Point, clockwise: bool) -> Segment {
        Segment { start, end, bend: Some(Bend { centre, clockwise }) }
    }

    #[test]
    fn a_blank_may_be_given_either_way_round() {
        let corners = [point(0., 0.), point(0., -50.), point(25., -50.), point(25., 0.)];
        let mut back = corners;
        back.reverse();
        for corners in [corners, back] {
            let blank = Outline::polygon(&corners).expect("an outline");
            assert_eq!(blank.area_mm2(), 1250.0);
            assert_eq!(blank.bounds(), Bounds { min: point(0., -50.), max: point(25., 0.) });
            assert!(blank.contains(point(10., -10.)) && !blank.contains(point(26., -10.)));
            assert!(!blank.contains(point(-1., -10.)) && !blank.contains(point(10., 1.)));
        }
    }

    #[test]
    fn a_circle_has_its_area_and_its_bounds() {
        let disc = Outline::circle(point(3., 4.), 2.0).expect("an outline");
        assert!((disc.area_mm2() - 4.0 * PI).abs() < 1e-12);
        assert_eq!(disc.bounds(), Bounds { min: point(1., 2.), max: point(5., 6.) });
        for (x, z, inside) in [(3., 4., true), (4.4, 5.4, true), (4.5, 5.5, false), (0.9, 4., false)] {
            assert_eq!(disc.contains(point(x, z)), inside, "{x} {z}");
        }
        // The same as one arc that ends where it starts.
        let whole =
            Outline::new(vec![arc(point(5., 4.), point(5., 4.), point(3., 4.), true)]).expect("one arc");
        assert!((whole.area_mm2() - 4.0 * PI).abs() < 1e-12);
        assert!(whole.contains(point(2., 4.)) && !whole.contains(point(2., 6.)));
    }

    #[test]
    fn what_turns_round_the_axis_has_the_volume_that_pappus_gives_it() {
        let volume = |outline: &Outline| -> f64 {
            outline.segments().iter().map(Segment::volume_round_axis_mm3).sum()
        };
        let ring = Outline::circle(point(10., 4.), 2.0).expect("an outline");
        assert!((volume(&ring) - 2.0 * PI * 10.0 * 4.0 * PI).abs() < 1e-10);
        let cone = Outline::polygon(&[point(0., 0.), point(6., 0.), point(0., 10.)]).expect("an outline");
        assert!((volume(&cone) - 120.0 * PI).abs() < 1e-10);
        // Half a ball on the axis.
        let half = Outline::new(vec![
            line(point(0., -3.), point(0., 3.)),
            arc(point(0., 3.), point(0., -3.), point(0., 0.), false),
        ])
        .expect("an outline");
        assert!((volume(&half) - 36.0 * PI).abs() < 1e-11);
    }

    #[test]
    fn an_insert_with_a_round_nose_keeps_its_arc() {
        // A right angle with a nose of 0.8 mm at the origin, 10 mm long.
        let insert = Outline::new(vec![
            arc(point(0.8, 0.), point(0., 0.8), point(0.8, 0.8), false),
            line(point(0., 0.8), point(0., 10.)),
            line(point(0., 10.), point(10., 0.)),
            line(point(10., 0.), point(0.8, 0.)),
        ])
        .expect("an outline");
        let missing = 0.64 - 0.64 * PI / 4.0;
        assert!((insert.area_mm2() - (50.0 - missing)).abs() < 1e-12);
        assert!(!insert.contains(point(0.1, 0.1)) && insert.contains(point(0.3, 0.3)));
        let other_hand = insert.mirrored_in_z();
        assert!((other_hand.area_mm2() - insert.area_mm2()).abs() < 1e-12);
        assert!(other_hand.contains(point(0.3, -0.3)) && !other_hand.contains(point(0.1, -0.1)));
        assert!(Outline::new(other_hand.segments().to_vec()).is_ok());
        let inner = insert.mirrored_in_x().moved(Vector { x: 20., z: -5. });
        assert!(inner.contains(point(19.7, -4.7)));
        assert!(Outline::new(inner.segments().to_vec()).is_ok());
    }

    #[test]
    fn ends_within_a_nanometre_are_closed_and_wider_gaps_are_named() {
        let corners = |gap: f64| {
            vec![
                line(point(0., 0.), point(0., 5.)),
                line(point(gap, 5.), point(5., 0.)),
                line(point(5., 0.), point(0., 0.)),
            ]
        };
        let closed = Outline::new(corners(5e-7)).expect("closed");
        for (one, next) in closed.segments().iter().zip(closed.segments().iter().cycle().skip(1)) {
            assert_eq!(one.end, next.start);
        }
        assert_eq!(Outline::new(corners(0.01)), Err(OutlineFault::Gap { segment: 0, gap_mm: 0.01 }));
    }

    #[test]
    fn crossings_touches_and_spikes_are_refused_with_their_place() {
        let bow = [point(0., 0.), point(10., 10.), point(10., 0.), point(0., 10.)];
        let fault = Outline::polygon(&bow).expect_err("a bow tie");
        assert_eq!(fault, OutlineFault::Crossing { first: 0, second: 2, at: point(5., 5.) });
        let touching = [point(0., 0.), point(0., 10.), point(10., 10.), point(0., 5.), point(10., 0.)];
        assert!(matches!(
            Outline::polygon(&touching),
            Err(OutlineFault::Crossing { at, .. }) if at.distance(point(0., 5.)) < 1e-9
        ));
        let spike = [point(0., 0.), point(0., 10.), point(0., 5.), point(5., 5.)];
        assert!(matches!(Outline::polygon(&spike), Err(OutlineFault::Crossing { first: 0, second: 1, .. })));
        // An arc through a line that follows it.
        let through = vec![
            arc(point(0., 0.), point(0., 4.), point(0., 2.), false),
            line(point(0., 4.), point(-3., 0.5)),
            line(point(-3., 0.5), point(0., 0.)),
        ];
        assert!(Outline::new(through).is_err());
        // Two arcs that lie on each other.
        let (low, high, middle) = (point(0., 0.), point(0., 4.), point(0., 2.));
        let flat = vec![arc(low, high, middle, true), arc(high, low, middle, false)];
        assert!(Outline::new(flat).is_err());
    }

    #[test]
    fn what_is_no_shape_is_refused() {
        assert_eq!(Outline::new(Vec::new()), Err(OutlineFault::Count(0)));
        assert_eq!(Outline::polygon(&[point(0., f64::NAN), point(1., 1.)]), Err(OutlineFault::Size(0)));
        assert_eq!(Outline::circle(point(0., 0.), 1e9), Err(OutlineFault::Size(0)));
        assert_eq!(Outline::circle(point(0., 0.), 0.0), Err(OutlineFault::Short(0)));
        assert_eq!(Outline::polygon(&[point(0., 0.)]), Err(OutlineFault::Short(0)));
        assert!(Outline::polygon(&[point(0., 0.), point(5., 5.)]).is_err());
        assert!(Outline::polygon(&[point(0., 0.), point(0., 3.), point(0., 9.)]).is_err());
        let uneven = vec![
            arc(point(0., 0.), point(0., 4.), point(0., 2.1), false),
            line(point(0., 4.), point(0., 0.)),
        ];
        assert!(matches!(Outline::new(uneven), Err(OutlineFault::Radius { segment: 0, .. })));
    }
}
