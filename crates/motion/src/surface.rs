//! Feed per revolution under constant surface speed, integrated along the path.
//!
//! The path speed is feed × rpm, and rpm is a constant / |x| between two limits. Its inverse, the seconds a
//! millimetre takes, is therefore |x| times a constant between two limits: straight pieces that meet at known
//! distances from the axis. Between those both lines and circles have a closed form.

use std::f64::consts::PI;

use crate::path::{Circle, Stretch, way_to};
use crate::spindle::SurfaceLaw;

/// Minutes that a millimetre of path takes, as a function of the distance from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slowness {
    /// Growth with the distance from the axis, min/mm per mm.
    per_mm: f64,
    /// Lower limit (the speed limit), min/mm.
    min: f64,
    /// Upper limit (the lowest speed), min/mm; infinite when there is none.
    max: f64,
}

impl Slowness {
    /// `None` when the tool would never move.
    pub(crate) fn new(feed_mm_per_rev: f64, law: SurfaceLaw, cutting_max_mm_per_min: f64) -> Option<Self> {
        let fastest = (feed_mm_per_rev * law.rpm_max).min(cutting_max_mm_per_min);
        let slowest = (feed_mm_per_rev * law.rpm_min).min(fastest);
        let per_mm = 1.0 / (feed_mm_per_rev * law.rpm_mm);
        if fastest > 0.0 && per_mm.is_finite() {
            let max = if slowest > 0.0 { 1.0 / slowest } else { f64::INFINITY };
            Some(Self { per_mm, min: 1.0 / fastest, max })
        } else {
            None
        }
    }

    /// Minutes per millimetre at `x_mm`.
    pub(crate) fn at(self, x_mm: f64) -> f64 {
        (x_mm.abs() * self.per_mm).clamp(self.min, self.max)
    }

    /// The X at which the straight pieces meet: the axis and both sides of it, mm.
    fn corners(self) -> [f64; 5] {
        let (near, far) = (self.min / self.per_mm, self.max / self.per_mm);
        [-far, -near, 0.0, near, far]
    }

    /// Minutes for a line of `length_mm` between two X.
    pub(crate) fn line_minutes(self, from_x_mm: f64, to_x_mm: f64, length_mm: f64) -> f64 {
        let (low, high) = (from_x_mm.min(to_x_mm), from_x_mm.max(to_x_mm));
        if low == high {
            return length_mm * self.at(low);
        }
        let mut sum = 0.0;
        let mut left = low;
        // The corners come in rising order, so the pieces do.
        for corner in self.corners().into_iter().chain([f64::INFINITY]) {
            let right = corner.clamp(left, high);
            // The function is straight between corners: its mean is its value in the middle.
            sum += (right - left) * self.at((left + right) / 2.0);
            left = right;
        }
        // Divided first, so that a line of one piece is exact however little X it covers.
        sum / (high - low) * length_mm
    }

    /// Minutes for a straight stretch or an arc.
    pub(crate) fn minutes_of(self, stretch: &Stretch) -> f64 {
        match stretch.arc {
            None => self.line_minutes(stretch.start.x, stretch.end.x, stretch.length_mm()),
            Some(arc) => arc.circles().map(|circle| self.circle_minutes(&circle)).sum(),
        }
    }

    /// Minutes for a piece of a circle.
    pub(crate) fn circle_minutes(self, circle: &Circle) -> f64 {
        let total = circle.sweep_rad.abs();
        let direction = circle.sweep_rad.signum();
        // Both ends, and every corner twice.
        let mut ways = [0.0, total, total, total, total, total, total, total, total, total, total, total];
        let mut count = 2;
        for corner in self.corners() {
            let sine = (corner - circle.centre_x_mm) / circle.radius_mm;
            if sine.abs() < 1.0 {
                let angle = libm::asin(sine);
                for crossing in [angle, PI - angle] {
                    let way = way_to(circle.start_rad, circle.sweep_rad, crossing);
                    if way < total {
                        ways[count] = way;
                        count += 1;
                    }
                }
            }
        }
        let ways = &mut ways[..count];
        ways.sort_unstable_by(f64::total_cmp);
        let mut sum = 0.0;
        for pair in ways.windows(2) {
            let (angle, middle) =
                (pair[1] - pair[0], circle.start_rad + direction * (pair[0] + pair[1]) / 2.0);
            let x_middle = circle.centre_x_mm + circle.radius_mm * libm::sin(middle);
            let slowness = self.at(x_middle);
            sum += if slowness > self.min && slowness < self.max {
                // The integral of x over the angle, written so that short pieces lose no digits.
                let x_angle = circle.centre_x_mm * angle
                    + 2.0 * circle.radius_mm * libm::sin(middle) * libm::sin(angle / 2.0);
                x_angle.abs() * self.per_mm
            } else {
                slowness * angle
            };
        }
        sum * circle.path_mm_per_rad
    }
}
