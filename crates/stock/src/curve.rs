//! Edges of bands: X as a function of Z, a line or half a circle.
//!
//! An edge has no ends of its own: the slab that holds it has. However often an edge is shortened, its numbers stay
//! those of the cut that made it, so nothing drifts. Upright edges are no functions of Z and exist nowhere: they are
//! where one slab's bands end and the next one's do not go on.

use turnwright_geometry::{Point, Vector};

use crate::WELD_MM;

/// A line that is not upright, or the upper or lower half of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Curve {
    /// `x + slope · (Z − z)`.
    Line {
        /// Z of a place on it.
        z: f64,
        /// X of that place.
        x: f64,
        /// Change of X along Z.
        slope: f64,
    },
    /// The half of a circle above or below its centre.
    Arc {
        /// Z of the centre.
        z: f64,
        /// X of the centre.
        x: f64,
        /// The radius: positive for the upper half, negative for the lower.
        radius: f64,
    },
}

/// The lesser of two numbers; quicker than `f64::min`, which also sorts out what is no number.
#[inline(always)]
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers.
#[inline(always)]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// What lies between an edge and the spindle axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Content {
    /// In the half-section, mm².
    pub(crate) area_mm2: f64,
    /// Turned once round the axis, mm³.
    pub(crate) volume_mm3: f64,
}

impl Curve {
    /// The line through two places at different Z.
    pub(crate) fn through(a: Point, b: Point) -> Self {
        let slope = (b.x - a.x) / (b.z - a.z);
        // Where it is level, its place along Z is arbitrary: let equal levels be equal numbers.
        Self::Line { z: if slope == 0.0 { 0.0 } else { a.z }, x: a.x, slope }
    }

    /// Everywhere at this X.
    pub(crate) const fn level(x: f64) -> Self {
        Self::Line { z: 0.0, x, slope: 0.0 }
    }

    /// X at a Z; of an arc the Z may lie outside it by the rounding of numbers.
    #[inline]
    pub(crate) fn at(&self, at_z: f64) -> f64 {
        match *self {
            Self::Line { z, x, slope } => x + slope * (at_z - z),
            Self::Arc { z, x, radius } => {
                let off = at_z - z;
                x + greater((radius - off) * (radius + off), 0.0).sqrt().copysign(radius)
            }
        }
    }

    /// The place at a Z.
    pub(crate) fn point(&self, z: f64) -> Point {
        Point { x: self.at(z), z }
    }

    /// The sine of the angle at which the edge climbs along Z: −1 falling upright, 0 level, 1 rising upright.
    #[inline]
    pub(crate) fn lean(&self, at_z: f64) -> f64 {
        match *self {
            Self::Line { slope, .. } => slope / (1.0 + slope * slope).sqrt(),
            Self::Arc { z, radius, .. } => ((z - at_z) / radius).clamp(-1.0, 1.0),
        }
    }

    /// Where an arc has this lean.
    pub(crate) fn leaning(&self, lean: f64) -> Option<f64> {
        match *self {
            Self::Line { .. } => None,
            Self::Arc { z, radius, .. } => Some(z - lean * radius),
        }
    }

    /// The edge somewhere else.
    #[inline]
    pub(crate) fn moved(&self, way: Vector) -> Self {
        match *self {
            Self::Line { x, slope: 0.0, .. } => Self::level(x + way.x),
            Self::Line { z, x, slope } => Self::Line { z: z + way.z, x: x + way.x, slope },
            Self::Arc { z, x, radius } => Self::Arc { z: z + way.z, x: x + way.x, radius },
        }
    }

    /// The edge on the other side of the axis.
    pub(crate) fn mirrored(&self) -> Self {
        match *self {
            Self::Line { z, x, slope } => Self::Line { z, x: -x, slope: -slope },
            Self::Arc { z, x, radius } => Self::Arc { z, x: -x, radius: -radius },
        }
    }

    /// Lowest and highest X between two Z.
    #[inline]
    pub(crate) fn range(&self, from: f64, to: f64) -> (f64, f64) {
        self.range_with(from, to, self.at(from), self.at(to))
    }

    /// See [`Curve::range`]; X at both ends is known.
    #[inline]
    fn range_with(&self, from: f64, to: f64, a: f64, b: f64) -> (f64, f64) {
        let (low, high) = (lesser(a, b), greater(a, b));
        match *self {
            Self::Arc { z, x, radius } if from < z && z < to => {
                (lesser(low, x + radius), greater(high, x + radius))
            }
            _ => (low, high),
        }
    }

    /// Whether it is at the same X everywhere.
    #[inline]
    pub(crate) const fn is_level(&self) -> bool {
        matches!(self, Self::Line { slope: 0.0, .. })
    }

    /// Lowest X between two Z.
    #[inline]
    pub(crate) fn lowest(&self, from: f64, to: f64) -> f64 {
        match *self {
            Self::Line { x, slope: 0.0, .. } => x,
            Self::Arc { z, x, radius } if radius < 0.0 && from < z && z < to => x + radius,
            _ => lesser(self.at(from), self.at(to)),
        }
    }

    /// Highest X between two Z.
    #[inline]
    pub(crate) fn highest(&self, from: f64, to: f64) -> f64 {
        match *self {
            Self::Line { x, slope: 0.0, .. } => x,
            Self::Arc { z, x, radius } if radius > 0.0 && from < z && z < to => x + radius,
            _ => greater(self.at(from), self.at(to)),
        }
    }

    /// Whether the edge lies no lower than this X between two Z; a bulging arc is tried without a root.
    #[inline]
    pub(crate) fn clears(&self, level: f64, from: f64, to: f64) -> bool {
        match *self {
            Self::Arc { z, x, radius } if radius < 0.0 => {
                let off = if to < z { z - to } else { greater(from - z, 0.0) };
                let above = x - level;
                above >= 0.0 && above * above + off * off >= radius * radius
            }
            _ => self.at(from) >= level && self.at(to) >= level,
        }
    }

    /// Where two edges may cross, as Z; nothing is said on whether that is within their ends or halves.
    ///
    /// Circles and lines that just touch are found too, even when they miss by the rounding of the numbers.
    #[inline]
    pub(crate) fn crossings(&self, other: &Self) -> [f64; 2] {
        match (*self, *other) {
            (Self::Line { z, x, slope }, Self::Line { z: z2, x: x2, slope: slope2 }) => {
                // From the middle between the two known places, so that neither's rounding is stretched far.
                let at = (z + z2) / 2.0;
                let gap = (x + slope * (at - z)) - (x2 + slope2 * (at - z2));
                [at - gap / (slope - slope2), f64::NAN]
            }
            (line @ Self::Line { slope, .. }, Self::Arc { z, x, radius })
            | (Self::Arc { z, x, radius }, line @ Self::Line { slope, .. }) => {
                let stretch = (1.0 + slope * slope).sqrt();
                let off = (line.at(z) - x) / stretch;
                let half = half_chord(radius.abs(), off.abs());
                let foot = -slope / stretch * off;
                [z + foot - half / stretch, z + foot + half / stretch]
            }
            (Self::Arc { z, x, radius }, Self::Arc { z: z2, x: x2, radius: radius2 }) => {
                let (dz, dx) = (z2 - z, x2 - x);
                let apart = (dz * dz + dx * dx).sqrt();
                let foot = (apart + (radius - radius2) * (radius + radius2) / apart) / 2.0;
                let half = half_chord(radius.abs(), foot.abs());
                let (along, across) = (dz / apart * foot, dx / apart * half);
                [z + along - across, z + along + across]
            }
        }
    }

    /// Whether two edges may cross between two Z, by a look that costs less than to find where.
    #[inline]
    pub(crate) fn may_meet(&self, other: &Self, from: f64, to: f64) -> bool {
        match (self, other) {
            (Self::Line { .. }, Self::Line { .. }) => {
                (self.at(from) - other.at(from)) * (self.at(to) - other.at(to)) <= 0.0
            }
            (line @ Self::Line { .. }, Self::Arc { x, radius, .. })
            | (Self::Arc { x, radius, .. }, line @ Self::Line { .. }) => {
                let (low, high) = line.range(from, to);
                let (bottom, top) = if *radius > 0.0 { (*x, x + radius) } else { (x + radius, *x) };
                low <= top && high >= bottom
            }
            (Self::Arc { .. }, Self::Arc { .. }) => self != other,
        }
    }

    /// The squared cosine of the angle at which the edge climbs.
    #[inline]
    fn levelness(&self, at_z: f64) -> f64 {
        match *self {
            Self::Line { slope, .. } => 1.0 / (1.0 + slope * slope),
            Self::Arc { z, radius, .. } => {
                let lean = (z - at_z) / radius;
                (1.0 - lean) * (1.0 + lean)
            }
        }
    }

    /// Whether two edges are one between two Z, but for the rounding of numbers.
    #[inline]
    pub(crate) fn is_one_with(&self, other: &Self, from: f64, to: f64) -> bool {
        if self == other {
            return true;
        }
        let near = |a: f64, b: f64| (a - b).abs() <= WELD_MM;
        match (*self, *other) {
            (Self::Line { .. }, Self::Line { .. }) => {
                near(self.at(to), other.at(to)) && near(self.at(from), other.at(from))
            }
            (Self::Arc { z, x, radius }, Self::Arc { z: z2, x: x2, radius: radius2 }) => {
                near(z, z2) && near(x, x2) && near(radius, radius2)
            }
            _ => false,
        }
    }

    /// What lies between the edge and the axis from one Z to another: exact, by the chord and the segment of the
    /// circle over it, each turned round the axis by the path of its centroid (Pappus).
    pub(crate) fn content(&self, from: f64, to: f64) -> Content {
        self.content_above(from, to, self.at(from), self.at(to))
    }

    /// That, and the lowest and highest X.
    #[inline]
    pub(crate) fn content_and_range(&self, from: f64, to: f64) -> (Content, f64, f64) {
        let (a, b) = (self.at(from), self.at(to));
        let (low, high) = self.range_with(from, to, a, b);
        (self.content_above(from, to, a, b), low, high)
    }

    /// See [`Curve::content`]; X at both ends is known.
    #[inline]
    fn content_above(&self, from: f64, to: f64, a: f64, b: f64) -> Content {
        use std::f64::consts::PI;
        let wide = to - from;
        let area = wide * (a + b) / 2.0;
        let volume = PI / 3.0 * wide * (a * a + a * b + b * b);
        match *self {
            Self::Line { .. } => Content { area_mm2: area, volume_mm3: volume },
            Self::Arc { z, x, radius } => {
                let chord_squared = wide * wide + (b - a) * (b - a);
                let (before, behind) = ((from - z, a - x), (to - z, b - x));
                let bulge = segment_area(radius.abs(), chord_squared, before, behind).copysign(radius);
                let moment = x * bulge + wide * chord_squared / 12.0;
                Content { area_mm2: area + bulge, volume_mm3: volume + 2.0 * PI * moment }
            }
        }
    }
}

/// A stretch of Z in which edges do not cross: how two of them lie to each other is seen at a place of it. Where they are
/// near to each other a second one is looked at: edges that touch in between do so once, so that one of the two tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    one: f64,
    other: f64,
}

/// Of edges further apart than this one place tells enough.
const FAR_MM: f64 = 1e-3;
/// But not in columns narrower than this, where steep edges may cross within the weld.
const NARROW_MM: f64 = 1e-6;

impl Column {
    #[inline]
    pub(crate) fn new(from: f64, to: f64) -> Self {
        Self { one: from + (to - from) * 0.25, other: from + (to - from) * 0.75 }
    }

    /// An edge at the first place.
    #[inline]
    pub(crate) fn across<'a>(&self, edge: &'a Curve) -> Across<'a> {
        Across { edge, x: edge.at(self.one) }
    }

    /// How far one edge lies above another, and at which Z: above zero when it lies above.
    #[inline]
    pub(crate) fn height(&self, upper: &Across<'_>, lower: &Across<'_>) -> (f64, f64) {
        let one = upper.x - lower.x;
        if one.abs() > FAR_MM && self.other - self.one > NARROW_MM {
            return (one, self.one);
        }
        let other = upper.edge.at(self.other) - lower.edge.at(self.other);
        if one.abs() > other.abs() { (one, self.one) } else { (other, self.other) }
    }

    /// Whether an edge lies above another by more than the weld, measured square to the flatter of them.
    #[inline]
    pub(crate) fn rises(&self, upper: &Across<'_>, lower: &Across<'_>) -> bool {
        let (height, z) = self.height(upper, lower);
        // No edge is so steep that a millimetre above another is within the weld.
        if height <= WELD_MM || height > 1.0 {
            return height > WELD_MM;
        }
        let level = greater(upper.edge.levelness(z), lower.edge.levelness(z));
        height * height * level > WELD_MM * WELD_MM
    }
}

/// An edge with its X at the first place of a column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Across<'a> {
    pub(crate) edge: &'a Curve,
    x: f64,
}

impl std::ops::Sub for Content {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { area_mm2: self.area_mm2 - other.area_mm2, volume_mm3: self.volume_mm3 - other.volume_mm3 }
    }
}

impl std::ops::AddAssign for Content {
    fn add_assign(&mut self, other: Self) {
        self.area_mm2 += other.area_mm2;
        self.volume_mm3 += other.volume_mm3;
    }
}

/// Half the chord of a circle at a distance from its centre: nothing when just touched, no number when missed.
#[inline]
fn half_chord(radius: f64, off: f64) -> f64 {
    if off > radius + WELD_MM { f64::NAN } else { greater((radius - off) * (radius + off), 0.0).sqrt() }
}

/// Between a chord and its arc of no more than half a circle; the ends are given from the centre, as (z, x).
#[inline]
fn segment_area(radius: f64, chord_squared: f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    // Half of r² times angle less sine, which for a small angle is a series in the squared sine of half of it.
    // In pairs, so that the processor works on several at once.
    const SERIES: [(f64, f64); 6] = [
        (4.0 / 3.0, 2.0 / 5.0),
        (3.0 / 14.0, 5.0 / 36.0),
        (35.0 / 352.0, 63.0 / 832.0),
        (77.0 / 1280.0, 429.0 / 8704.0),
        (6435.0 / 155_648.0, 12_155.0 / 344_064.0),
        (46_189.0 / 1_507_328.0, 88_179.0 / 3_276_800.0),
    ];
    let sine_squared = chord_squared / (4.0 * radius * radius);
    if sine_squared < 0.1 {
        let squared = sine_squared * sine_squared;
        let pairs = SERIES.iter().rev();
        let series = pairs.fold(0.0, |sum, (even, odd)| sum * squared + (even + odd * sine_squared));
        return radius * radius / 2.0 * series * sine_squared * sine_squared.sqrt();
    }
    // Sine and cosine of half the angle; the lesser of them tells the angle best.
    let (across, above) = (from.0 + to.0, from.1 + to.1);
    let cosine_squared = (across * across + above * above) / (4.0 * radius * radius);
    let (sine, cosine) = (sine_squared.sqrt(), cosine_squared.sqrt());
    let half =
        if sine < cosine { libm::asin(sine) } else { std::f64::consts::FRAC_PI_2 - libm::asin(cosine) };
    radius * radius * (half - sine * cosine)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn arc(x: f64, z: f64, radius: f64) -> Curve {
        Curve::Arc { z, x, radius }
    }

    #[test]
    fn a_half_circle_holds_a_ball_and_a_ring() {
        let ball = arc(0.0, 5.0, 3.0).content(2.0, 8.0);
        assert!((ball.area_mm2 - 4.5 * PI).abs() < 1e-12, "{ball:?}");
        assert!((ball.volume_mm3 - 36.0 * PI).abs() < 1e-11, "{ball:?}");
        let ring = arc(10.0, 0.0, 2.0).content(-2.0, 2.0) - arc(10.0, 0.0, -2.0).content(-2.0, 2.0);
        assert!((ring.area_mm2 - 4.0 * PI).abs() < 1e-12, "{ring:?}");
        assert!((ring.volume_mm3 - 2.0 * PI * 10.0 * 4.0 * PI).abs() < 1e-10, "{ring:?}");
    }

    #[test]
    fn small_pieces_add_up_to_the_whole_to_the_last_digits() {
        let edge = arc(20.0, 0.0, -4.0);
        for count in [1, 2, 7, 40, 1_000] {
            let mut sum = Content::default();
            for part in 0..count {
                let at = |part: u32| -4.0 + 8.0 * f64::from(part) / f64::from(count);
                sum += edge.content(at(part), at(part + 1));
            }
            // A box of 8 by 20 less half a disc; Pappus with its centroid 4·4/3π below 20.
            let (area, disc) = (160.0 - 8.0 * PI, 8.0 * PI);
            let volume = 2.0 * PI * (160.0 * 10.0 - disc * (20.0 - 16.0 / (3.0 * PI)));
            assert!((sum.area_mm2 - area).abs() < 1e-11, "{count}: {}", sum.area_mm2 - area);
            assert!((sum.volume_mm3 - volume).abs() < 1e-9, "{count}: {}", sum.volume_mm3 - volume);
        }
    }

    #[test]
    fn cones_have_the_volume_of_cones() {
        let cone = Curve::through(Point::new(0.0, 0.0), Point::new(6.0, -10.0)).content(-10.0, 0.0);
        assert!((cone.area_mm2 - 30.0).abs() < 1e-12 && (cone.volume_mm3 - 120.0 * PI).abs() < 1e-11);
    }

    #[test]
    fn crossings_and_touches_are_found() {
        let near = |found: [f64; 2], expected: [f64; 2]| {
            let mut found = found;
            found.sort_by(f64::total_cmp);
            assert!(
                (found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9,
                "{found:?}"
            );
        };
        let circle = arc(0.0, 0.0, 5.0);
        near(circle.crossings(&Curve::level(3.0)), [-4.0, 4.0]);
        near(Curve::level(5.0 + 1e-13).crossings(&circle), [0.0, 0.0]);
        near(circle.crossings(&arc(0.0, 10.0, -5.0)), [5.0, 5.0]);
        near(circle.crossings(&arc(0.0, 6.0, 5.0)), [3.0, 3.0]);
        near(circle.crossings(&arc(6.0, 0.0, 5.0)), [-4.0, 4.0]);
        assert!(circle.crossings(&Curve::level(5.1))[0].is_nan());
        let slope = Curve::through(Point::new(0.0, 0.0), Point::new(4.0, 4.0));
        near(slope.crossings(&circle), [-12.5_f64.sqrt(), 12.5_f64.sqrt()]);
        assert!((slope.crossings(&Curve::level(1.5))[0] - 1.5).abs() < 1e-12);
        // One and the same: anything but an end of the world.
        let _ = circle.crossings(&circle);
        let _ = slope.crossings(&slope);
    }

    #[test]
    fn heights_of_steep_edges_are_measured_square() {
        let rises = |upper: &Curve, lower: &Curve, from: f64, to: f64| {
            let column = Column::new(from, to);
            column.rises(&column.across(upper), &column.across(lower))
        };
        let steep = Curve::through(Point::new(0.0, 0.0), Point::new(10.0, 1e-6));
        let beside = steep.moved(Vector { x: 0.0, z: 1e-12 });
        assert!(steep.at(1e-7) - beside.at(1e-7) > 1e-6);
        assert!(!rises(&steep, &beside, 0.0, 1e-6) && !rises(&beside, &steep, 0.0, 1e-6));
        let thick = steep.moved(Vector { x: 0.0, z: -2e-9 });
        assert!(rises(&thick, &steep, 0.0, 1e-6));
        assert!(rises(&Curve::level(2.0), &Curve::level(0.5), 0.0, 1.0));
        // Touching half-way, yet far above at the ends.
        assert!(rises(&Curve::level(5.0), &arc(0.0, 0.0, 5.0), -4.0, 4.0));
    }

    #[test]
    fn leans_lead_to_places() {
        for edge in [arc(3.0, 1.0, 2.0), arc(3.0, 1.0, -2.0)] {
            for lean in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let z = edge.leaning(lean).expect("an arc");
                assert!((edge.lean(z) - lean).abs() < 1e-12);
            }
        }
    }
}
