//! Straight lines given by a point and an angle.

use crate::Point;

/// A line without ends: through a point, at an angle counter-clockwise from +Z. Both ways along it are the
/// same line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Any point of it.
    pub through: Point,
    /// Its angle, radians.
    pub angle_rad: f64,
}

impl Line {
    /// All places with this X.
    pub const fn at_x(x: f64) -> Self {
        Self { through: Point { x, z: 0.0 }, angle_rad: 0.0 }
    }

    /// All places with this Z.
    pub const fn at_z(z: f64) -> Self {
        Self { through: Point { x: 0.0, z }, angle_rad: std::f64::consts::FRAC_PI_2 }
    }

    /// Where two lines cross; `None` when they are within `parallel_rad` of being parallel.
    pub fn crossing(self, other: Self, parallel_rad: f64) -> Option<Point> {
        // An exact quarter turn has a cosine of exactly zero, so that the given coordinate is kept as it is.
        let (z, x) = direction(self.angle_rad);
        let (other_z, other_x) = direction(other.angle_rad);
        let cross = z * other_x - x * other_z;
        if cross.abs() < libm::sin(parallel_rad) || cross == 0.0 {
            return None;
        }
        let (dz, dx) = (other.through.z - self.through.z, other.through.x - self.through.x);
        let way = (dz * other_x - dx * other_z) / cross;
        let found = Point { x: self.through.x + way * x, z: self.through.z + way * z };
        (found.x.is_finite() && found.z.is_finite()).then_some(found)
    }

    /// How far `point` lies along the line from [`Line::through`], mm: negative against the angle.
    pub fn way_to(self, point: Point) -> f64 {
        let (z, x) = direction(self.angle_rad);
        (point.z - self.through.z) * z + (point.x - self.through.x) * x
    }
}

/// The unit step along Z and X at an angle.
fn direction(angle_rad: f64) -> (f64, f64) {
    let clean = |part: f64| if part.abs() < 1e-15 { 0.0 } else { part };
    (clean(libm::cos(angle_rad)), clean(libm::sin(angle_rad)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: f64 = std::f64::consts::PI / 180.0;

    fn line(x: f64, z: f64, degrees: f64) -> Line {
        Line { through: Point::new(x, z), angle_rad: degrees * DEGREE }
    }

    #[test]
    fn two_angles_of_a_drawing_give_the_corner() {
        // From diameter 20 at 170 degrees, and back from diameter 50, Z-40 at 120 degrees.
        let corner = line(10.0, 0.0, 170.0).crossing(line(25.0, -40.0, 120.0), DEGREE).expect("they cross");
        assert!((corner.x - 32.304_7 / 2.0).abs() < 5e-5 && (corner.z + 34.891_8).abs() < 5e-5, "{corner:?}");
        assert!(line(10.0, 0.0, 170.0).way_to(corner) > 0.0);
        assert!(line(10.0, 0.0, -10.0).way_to(corner) < 0.0);
    }

    #[test]
    fn a_given_coordinate_is_met() {
        let start = line(10.0, 5.0, 135.0);
        let at_x = start.crossing(Line::at_x(15.0), DEGREE).expect("crosses");
        assert!((at_x.x - 15.0).abs() < 1e-12 && at_x.z.abs() < 1e-12, "{at_x:?}");
        let at_z = start.crossing(Line::at_z(-5.0), DEGREE).expect("crosses");
        assert!((at_z.x - 20.0).abs() < 1e-12 && (at_z.z + 5.0).abs() < 1e-12, "{at_z:?}");
    }

    #[test]
    fn nearly_parallel_lines_do_not_cross() {
        for degrees in [0.0, 0.9, -0.9, 180.9, 179.1] {
            assert_eq!(line(10.0, 0.0, degrees).crossing(Line::at_x(20.0), DEGREE), None, "{degrees}");
        }
        assert!(line(10.0, 0.0, 1.1).crossing(Line::at_x(20.0), DEGREE).is_some());
        assert_eq!(line(10.0, 0.0, 0.0).crossing(line(20.0, 0.0, 180.0), 0.0), None);
    }
}
