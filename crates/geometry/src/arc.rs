//! Arcs given by end points: centre from radius, sweep from centre.

use crate::Point;

/// Why no circle of a given radius passes through two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcFault {
    /// Half the chord is longer than the radius by this much, mm.
    RadiusTooSmall {
        /// Missing length, mm.
        missing_mm: f64,
    },
    /// Start and end are the same place: every direction would do.
    NoChord,
}

/// The centre of the arc from `start` to `end` with `radius_mm`; a negative radius asks for the arc of
/// more than 180 degrees. `clockwise` is seen with Z to the right and X up.
///
/// # Errors
/// [`ArcFault`] when the points are further apart than the circle is wide by more than `tolerance_mm`
/// (inside it the centre is the middle of the chord), or when they are the same.
pub fn centre_from_radius(
    start: Point,
    end: Point,
    radius_mm: f64,
    clockwise: bool,
    tolerance_mm: f64,
) -> Result<Point, ArcFault> {
    let (dz, dx) = (end.z - start.z, end.x - start.x);
    let chord = start.distance(end);
    if chord == 0.0 {
        return Err(ArcFault::NoChord);
    }
    let half = chord / 2.0;
    let radius = radius_mm.abs();
    let rise_squared = (radius - half) * (radius + half);
    let rise = if rise_squared >= 0.0 {
        rise_squared.sqrt()
    } else if half - radius <= tolerance_mm {
        0.0
    } else {
        return Err(ArcFault::RadiusTooSmall { missing_mm: half - radius });
    };
    // The centre of a minor clockwise arc lies to the right of the chord, of a counter-clockwise one to the left.
    let side = if clockwise == (radius_mm >= 0.0) { -1.0 } else { 1.0 };
    let (middle_z, middle_x) = ((start.z + end.z) / 2.0, (start.x + end.x) / 2.0);
    Ok(Point { z: middle_z - side * dx / chord * rise, x: middle_x + side * dz / chord * rise })
}

/// The signed angle from `start` to `end` about `centre`, radians: negative when clockwise, a full turn when
/// the points coincide.
pub fn sweep_rad(start: Point, end: Point, centre: Point, clockwise: bool) -> f64 {
    const TURN: f64 = std::f64::consts::TAU;
    let from = libm::atan2(start.x - centre.x, start.z - centre.z);
    let to = libm::atan2(end.x - centre.x, end.z - centre.z);
    let mut sweep = to - from;
    if clockwise {
        while sweep >= -1e-12 {
            sweep -= TURN;
        }
    } else {
        while sweep <= 1e-12 {
            sweep += TURN;
        }
    }
    sweep
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_arc_of_the_shaft_example() {
        // X30 Z-42 to X36 Z-45, clockwise R3: the centre is X36 Z-42.
        let centre = centre_from_radius(Point::new(15.0, -42.0), Point::new(18.0, -45.0), 3.0, true, 0.0)
            .expect("arc");
        assert!((centre.x - 18.0).abs() < 1e-12 && (centre.z + 42.0).abs() < 1e-12, "{centre:?}");
    }

    #[test]
    fn negative_radius_takes_the_long_way() {
        let (start, end) = (Point::new(10.0, 0.0), Point::new(10.0, -6.0));
        let short = centre_from_radius(start, end, 5.0, true, 0.0).expect("arc");
        let long = centre_from_radius(start, end, -5.0, true, 0.0).expect("arc");
        assert!(sweep_rad(start, end, short, true).abs() < std::f64::consts::PI);
        assert!(sweep_rad(start, end, long, true).abs() > std::f64::consts::PI);
    }

    #[test]
    fn too_small_a_radius_says_how_much_is_missing() {
        let (start, end) = (Point::new(0.0, 0.0), Point::new(0.0, 10.0));
        match centre_from_radius(start, end, 4.9, true, 0.05) {
            Err(ArcFault::RadiusTooSmall { missing_mm }) => assert!((missing_mm - 0.1).abs() < 1e-12),
            other => panic!("{other:?}"),
        }
        assert!(centre_from_radius(start, end, 4.97, true, 0.05).is_ok());
        assert_eq!(centre_from_radius(start, start, 1.0, true, 0.0), Err(ArcFault::NoChord));
    }
}
