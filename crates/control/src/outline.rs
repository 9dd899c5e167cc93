//! Closed outlines in the half-section, from the points that a setup file lists.

use serde::Deserialize;
use turnwright_geometry::{Bend, Outline, OutlineFault, Point, Segment, Vector, centre_from_radius};

/// Points closer than this are one, mm.
const SAME_MM: f64 = 1e-6;

/// Gap of an arc that is closed without a word, mm.
const ARC_TOLERANCE_MM: f64 = 1e-3;

/// One point of an outline, mm, and how the outline gets there from the point before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutlinePoint {
    /// X: of the stock a diameter, of a tool as it is.
    pub x: f64,
    /// Z.
    pub z: f64,
    /// Radius of the arc that leads here; left out: a straight line.
    pub r: Option<f64>,
    /// Which way that arc turns, seen with Z to the right and X up.
    pub turn: Option<ArcTurn>,
}

/// Which way an arc turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArcTurn {
    /// Clockwise: as G02.
    Cw,
    /// Counter-clockwise: as G03.
    Ccw,
}

impl ArcTurn {
    /// The word of setup files.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Cw => "cw",
            Self::Ccw => "ccw",
        }
    }
}

/// The outline through the points, whichever way they are listed; `x_factor` makes a radius of their X.
///
/// # Errors
/// What no outline can be, in words: too few points, no number, an arc too small, a loop that crosses itself.
pub(crate) fn through(points: &[OutlinePoint], x_factor: f64) -> Result<Outline, String> {
    if points.len() < 3 {
        return Err(format!("an outline has 3 points or more, not {}", points.len()));
    }
    if points.iter().any(|point| ![point.x, point.z, point.r.unwrap_or(1.0)].iter().all(|n| n.is_finite())) {
        return Err("a point is no number".to_string());
    }
    let place = |point: &OutlinePoint| Point::new(point.x * x_factor, point.z);
    let mut segments = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        let start = place(&points[(index + points.len() - 1) % points.len()]);
        let end = place(point);
        if start.distance(end) < SAME_MM {
            // The first point again at the end closes the loop in so many words.
            if index == 0 {
                continue;
            }
            return Err(format!("points {index} and {} are the same", index + 1));
        }
        let bend = match (point.r, point.turn) {
            (None, None) => None,
            (Some(radius), _) if radius <= 0.0 => {
                return Err(format!("point {}: r = {radius} is no radius", index + 1));
            }
            (None, Some(_)) | (Some(_), None) => {
                return Err(format!("point {}: an arc has r and turn (\"cw\" or \"ccw\")", index + 1));
            }
            (Some(radius), Some(turn)) => {
                let clockwise = turn == ArcTurn::Cw;
                let centre = centre_from_radius(start, end, radius, clockwise, ARC_TOLERANCE_MM);
                let centre = centre
                    .map_err(|_| format!("point {}: an arc of r = {radius} does not reach it", index + 1))?;
                Some(Bend { centre, clockwise })
            }
        };
        segments.push(Segment { start, end, bend });
    }
    // The way into the first point closes the loop and stands last.
    let into_first = usize::from(segments.len() == points.len());
    segments.rotate_left(into_first);
    Outline::new(segments).map_err(|fault| words(fault, x_factor))
}

/// Why points are no outline, in words; places with X as the points have it.
fn words(fault: OutlineFault, x_factor: f64) -> String {
    match fault {
        OutlineFault::Count(count) => format!("an outline cannot have {count} points"),
        OutlineFault::Size(index) => format!("point {}: no machine is so large", index + 2),
        OutlineFault::Short(index) => format!("points {} and {} are the same", index + 1, index + 2),
        OutlineFault::Radius { segment, .. } | OutlineFault::Gap { segment, .. } => {
            format!("point {}: the arc does not reach it", segment + 2)
        }
        OutlineFault::Crossing { at, .. } => {
            format!("the outline crosses or touches itself at x = {:.3}, z = {:.3}", at.x / x_factor, at.z)
        }
        OutlineFault::NoArea => "the outline holds no area".to_string(),
    }
}

/// A loop through corners, counter-clockwise, each corner rounded with a radius where it has one. A rounding that does
/// not fit on its edges is made as large as fits.
///
/// # Errors
/// As [`Outline::new`].
pub(crate) fn rounded(corners: &[(Point, f64)]) -> Result<Outline, OutlineFault> {
    let count = corners.len();
    let way = |from: usize, to: usize| Vector::between(corners[from % count].0, corners[to % count].0);
    // Length of an edge that a corner's rounding takes, and the angle it turns by.
    let turn = |index: usize| {
        let (before, after) = (way(index + count - 1, index), way(index, index + 1));
        libm::atan2(before.cross(after), before.z * after.z + before.x * after.x)
    };
    let taken: Vec<f64> = (0..count)
        .map(|index| {
            let wanted = corners[index].1 * libm::tan(turn(index).abs() / 2.0);
            let room = way(index + count - 1, index).length().min(way(index, index + 1).length()) / 2.0;
            wanted.min(room)
        })
        .collect();
    let mut segments = Vec::with_capacity(2 * count);
    for (index, (corner, _)) in corners.iter().enumerate() {
        let before = way(index + count - 1, index);
        let after = way(index, index + 1);
        let entry = before.times(-taken[index] / before.length()).from(*corner);
        let exit = after.times(taken[index] / after.length()).from(*corner);
        if taken[index] > SAME_MM {
            let radius = taken[index] / libm::tan(turn(index).abs() / 2.0);
            let side = if turn(index) > 0.0 { 1.0 } else { -1.0 };
            let across = Vector { x: before.z, z: -before.x }.times(side * radius / before.length());
            let bend = Bend { centre: across.from(entry), clockwise: turn(index) < 0.0 };
            segments.push(Segment { start: entry, end: exit, bend: Some(bend) });
        }
        let next = (index + 1) % count;
        let end = after.times(-taken[next] / after.length()).from(corners[next].0);
        if exit.distance(end) > SAME_MM {
            segments.push(Segment { start: exit, end, bend: None });
        }
    }
    Outline::new(segments)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, z: f64) -> OutlinePoint {
        OutlinePoint { x, z, ..OutlinePoint::default() }
    }

    #[test]
    fn an_outline_may_be_listed_either_way_and_closed_in_so_many_words() {
        let points = [at(0.0, 0.0), at(40.0, 0.0), at(40.0, -50.0), at(0.0, -50.0)];
        let mut back = points;
        back.reverse();
        for points in [&points[..], &back, &[points[0], points[1], points[2], points[3], points[0]]] {
            let outline = through(points, 0.5).expect("an outline");
            assert_eq!((outline.area_mm2(), outline.segments().len()), (1000.0, 4));
        }
    }

    #[test]
    fn an_arc_counts_with_its_whole_area() {
        // A quarter circle of radius 10: 25·π. From X0 Z10 to X10 Z0 about the origin: counter-clockwise.
        let quarter = OutlinePoint { r: Some(10.0), turn: Some(ArcTurn::Ccw), ..at(10.0, 0.0) };
        let outline = through(&[at(0.0, 0.0), at(0.0, 10.0), quarter], 1.0).expect("an outline");
        assert!((outline.area_mm2() - 25.0 * std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_outline_is_refused_with_the_reason() {
        let refused = |points: &[OutlinePoint]| through(points, 1.0).expect_err("refused");
        assert!(refused(&[at(0.0, 0.0), at(1.0, 0.0)]).contains("3 points"));
        let bow = [at(0.0, 0.0), at(10.0, 10.0), at(10.0, 0.0), at(0.0, 10.0)];
        assert!(refused(&bow).contains("itself at x = 5.000, z = 5.000"));
        assert!(refused(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)]).contains("the same"));
        assert!(refused(&[at(0.0, 0.0), at(f64::NAN, 0.0), at(0.0, 1.0)]).contains("no number"));
        assert!(refused(&[at(0.0, 0.0), at(1e9, 0.0), at(0.0, 1.0)]).contains("so large"));
        let far = OutlinePoint { r: Some(1.0), turn: Some(ArcTurn::Cw), ..at(10.0, 0.0) };
        assert!(refused(&[at(0.0, 0.0), far, at(0.0, 10.0)]).contains("point 2"));
        let negative = OutlinePoint { r: Some(-1.0), ..at(10.0, 0.0) };
        let open = OutlinePoint { r: Some(10.0), ..at(10.0, 0.0) };
        assert!(refused(&[at(0.0, 0.0), open, at(0.0, 10.0)]).contains("an arc has r and turn"));
        assert!(refused(&[at(0.0, 0.0), negative, at(0.0, 10.0)]).contains("no radius"));
    }

    #[test]
    fn corners_are_rounded_as_far_as_they_fit() {
        let square = [(0.0, 0.0), (0.0, 10.0), (10.0, 10.0), (10.0, 0.0)].map(|(x, z)| Point::new(x, z));
        let area = |radius: f64| {
            let outline = rounded(&square.map(|corner| (corner, radius))).expect("an outline");
            (outline.segments().len(), outline.area_mm2())
        };
        assert_eq!(area(0.0), (4, 100.0));
        let (count, round) = area(2.0);
        assert!(count == 8 && (round - (100.0 - 4.0 * 4.0 + 4.0 * std::f64::consts::PI)).abs() < 1e-9);
        // Roundings larger than the square leave its circle.
        let (count, circle) = area(50.0);
        assert!(count == 4 && (circle - 25.0 * std::f64::consts::PI).abs() < 1e-9);
    }
}
