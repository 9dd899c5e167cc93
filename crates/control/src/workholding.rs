//! What holds the work: chuck and tailstock, as outlines that no tool may touch; how fast chuck and bar may turn.

use serde::Deserialize;
use turnwright_geometry::{Bounds, Outline, OutlineFault, Point};

use crate::{Material, Stock};

/// Speed of sound along a steel bar, √(E/ρ) with 206 GPa and 7.85 g/cm³; counts where no material is named.
const STEEL_M_PER_S: f64 = 5_123.0;

/// Where the jaws grip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grip {
    /// On the outer diameter.
    #[default]
    Outside,
    /// In the bore.
    Inside,
}

impl Grip {
    /// Both ways, with the words of setup files.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Outside, "outside"), (Self::Inside, "inside")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(grip, _)| *grip == self).map_or("", |(_, word)| word)
    }
}

/// `[chuck]` of a setup file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Chuck {
    /// Where the jaws grip.
    pub grip: Grip,
    /// How much of the stock is in the jaws, mm.
    pub grip_mm: f64,
    /// Z of the front of the jaws, mm; left out: `grip_mm` in front of the stock's back face.
    pub jaw_z_mm: Option<f64>,
    /// How far the jaws stand out in front of the chuck, mm.
    pub jaw_length_mm: f64,
    /// How far they stand off the diameter they grip, mm, across the spindle axis.
    pub jaw_height_mm: f64,
    /// Diameter of the chuck, mm.
    pub diameter_mm: f64,
    /// Length of the chuck behind its face, mm.
    pub length_mm: f64,
    /// The fastest it may turn.
    pub rpm_max: Option<u32>,
    /// What all jaws together grip with while it stands, as it is set, kN.
    pub grip_force_kn: Option<f64>,
    /// The greatest that it can be set to, kN; left out: what it is set to.
    pub grip_force_max_kn: Option<f64>,
}

impl Default for Chuck {
    fn default() -> Self {
        Self {
            grip: Grip::Outside,
            grip_mm: 20.0,
            jaw_z_mm: None,
            jaw_length_mm: 35.0,
            jaw_height_mm: 40.0,
            diameter_mm: 200.0,
            length_mm: 90.0,
            rpm_max: None,
            grip_force_kn: None,
            grip_force_max_kn: None,
        }
    }
}

/// Share of the greatest gripping force that centrifugal force may take at the rated speed of a chuck: EN 1550 rates
/// them so.
const LOSS_AT_RATED_SPEED: f64 = 2.0 / 3.0;

/// Share of the gripping force at standstill that is left at least, by the same rule.
const GRIP_LEFT_MIN: f64 = 1.0 / 3.0;

/// How the grip of a chuck gets weaker with speed. EN 1550: at the rated speed centrifugal force takes two thirds of the
/// greatest gripping force; it grows with the square of the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripLaw {
    set_kn: f64,
    max_kn: f64,
    rated_rpm: f64,
}

impl GripLaw {
    /// What is left of the grip at a speed, kN.
    pub fn left_kn(&self, rpm: f64) -> f64 {
        (self.set_kn - LOSS_AT_RATED_SPEED * self.max_kn * (rpm / self.rated_rpm).powi(2)).max(0.0)
    }

    /// Up to this speed a third of the grip at standstill is left.
    pub fn rpm_max(&self) -> f64 {
        let share = (1.0 - GRIP_LEFT_MIN) * self.set_kn / (LOSS_AT_RATED_SPEED * self.max_kn);
        self.rated_rpm * share.sqrt()
    }
}

/// How the end of a bar behind the spindle is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BarEnd {
    /// Not at all.
    #[default]
    Free,
    /// In a bush or a bar feeder, free to turn.
    Guided,
}

impl BarEnd {
    /// Both, with the words of setup files.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Free, "free"), (Self::Guided, "guided")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(end, _)| *end == self).map_or("", |(_, word)| word)
    }

    /// First root of the frequency equation of a beam that is clamped at the spindle: cos λ cosh λ = -1 for a free end,
    /// tan λ = tanh λ for a guided one.
    const fn root(self) -> f64 {
        match self {
            Self::Free => 1.875_104_068_711_961,
            Self::Guided => 3.926_602_312_047_919,
        }
    }
}

/// `[bar]` of a setup file: what stands out behind the spindle.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Bar {
    /// From where it is held last to its end, mm.
    pub behind_mm: Option<f64>,
    /// Its diameter, mm; left out: that of the stock.
    pub diameter_mm: Option<f64>,
    /// Its bore, mm; left out: that of the stock.
    pub bore_mm: Option<f64>,
    /// How its end is held.
    pub end: BarEnd,
}

impl Bar {
    /// The speed at which it whips: the first bending frequency of a beam after Euler and Bernoulli, once a turn,
    /// n = 60 λ² / 2π L² · √(E/ρ) · √(D² + d²) / 4.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn critical_rpm(&self, stock: Option<&Stock>, material: Option<&Material>) -> Result<f64, Fault> {
        let size = |key, own: Option<f64>, of_stock: Option<f64>| match own.or(of_stock) {
            Some(size) if size.is_finite() && size > 0.0 && size <= 10_000.0 => Ok(size),
            Some(_) => Err((key, "must be greater than zero".to_string())),
            None => Err((key, "is needed".to_string())),
        };
        let length_m = size("behind_mm", self.behind_mm, None)? / 1e3;
        let of_stock = stock.and_then(|stock| stock.diameter_mm);
        let diameter_m = size("diameter_mm", self.diameter_mm, of_stock)? / 1e3;
        let bore_mm = self.bore_mm.or(stock.and_then(|stock| stock.bore_mm)).unwrap_or(0.0);
        if !(bore_mm >= 0.0 && bore_mm / 1e3 < diameter_m) {
            return Err(("bore_mm", "leaves nothing of the bar".to_string()));
        }
        let gyration_m = diameter_m.hypot(bore_mm / 1e3) / 4.0;
        let speed_of_sound = material.map_or(STEEL_M_PER_S, Material::speed_of_sound_m_per_s);
        let root = self.end.root();
        let rad_per_s = root * root * speed_of_sound * gyration_m / (length_m * length_m);
        Ok(rad_per_s * 30.0 / std::f64::consts::PI)
    }
}

/// The chuck as outlines in work coordinates, X as a radius.
#[derive(Clone, Debug, PartialEq)]
pub struct ChuckOutlines {
    /// A jaw.
    pub jaw: Outline,
    /// The chuck behind the jaws.
    pub body: Outline,
}

/// `[tailstock]` of a setup file: a centre in the work's front face.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tailstock {
    /// Z of the point of the centre, mm: inside the work, as its hole is.
    pub point_z_mm: Option<f64>,
    /// Angle of the point, degrees.
    pub point_angle_deg: f64,
    /// Diameter of the centre behind its point, mm.
    pub centre_mm: f64,
    /// Length of the centre in front of the quill, mm, its point included.
    pub centre_length_mm: f64,
    /// Diameter of the quill, mm.
    pub quill_mm: f64,
    /// Length of the quill, mm.
    pub quill_length_mm: f64,
}

impl Default for Tailstock {
    fn default() -> Self {
        Self {
            point_z_mm: None,
            point_angle_deg: 60.0,
            centre_mm: 25.0,
            centre_length_mm: 60.0,
            quill_mm: 70.0,
            quill_length_mm: 150.0,
        }
    }
}

/// What no chuck or tailstock can be: the key, and why.
type Fault = (&'static str, String);

fn positive(sizes: &[(&'static str, f64)]) -> Result<(), Fault> {
    match sizes.iter().find(|(_, size)| !(size.is_finite() && *size > 0.0 && *size <= 10_000.0)) {
        Some((key, _)) => Err((key, "must be greater than zero".to_string())),
        None => Ok(()),
    }
}

fn no_shape(key: &'static str) -> impl Fn(OutlineFault) -> Fault {
    move |_| (key, "with these sizes there is no shape".to_string())
}

impl Chuck {
    /// How its grip gets weaker with speed; nothing when nobody says how strong it is, or when it grips in a bore: there
    /// speed presses the jaws outwards.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn grip_law(&self) -> Result<Option<GripLaw>, Fault> {
        let forces = [("grip_force_kn", self.grip_force_kn), ("grip_force_max_kn", self.grip_force_max_kn)];
        for (key, force) in forces {
            if force.is_some_and(|force| !(force.is_finite() && force > 0.0 && force <= 10_000.0)) {
                return Err((key, "must be greater than zero".to_string()));
            }
        }
        let Some(set_kn) = self.grip_force_kn else {
            return match self.grip_force_max_kn {
                Some(_) => Err(("grip_force_max_kn", "says nothing without grip_force_kn".to_string())),
                None => Ok(None),
            };
        };
        let Some(rated) = self.rpm_max else {
            return Err(("grip_force_kn", "needs rpm_max, the rated speed of the chuck".to_string()));
        };
        let max_kn = self.grip_force_max_kn.unwrap_or(set_kn);
        if max_kn < set_kn {
            return Err(("grip_force_max_kn", "is less than what the chuck is set to".to_string()));
        }
        let law = GripLaw { set_kn, max_kn, rated_rpm: f64::from(rated) };
        Ok((self.grip == Grip::Outside).then_some(law))
    }

    /// Jaw and body around stock of this half-section.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn outlines(&self, stock: Option<&Outline>) -> Result<ChuckOutlines, Fault> {
        positive(&[
            ("grip_mm", self.grip_mm),
            ("jaw_length_mm", self.jaw_length_mm),
            ("jaw_height_mm", self.jaw_height_mm),
            ("diameter_mm", self.diameter_mm),
            ("length_mm", self.length_mm),
        ])?;
        if self.rpm_max == Some(0) {
            return Err(("rpm_max", "must be greater than zero".to_string()));
        }
        self.grip_law()?;
        if self.jaw_z_mm.is_some_and(|z| !(z.is_finite() && z.abs() <= 100_000.0)) {
            return Err(("jaw_z_mm", "is no place".to_string()));
        }
        let bounds = stock.map(Outline::bounds);
        if let Some(bounds) = &bounds
            && self.jaw_z_mm.is_none()
            && self.grip_mm >= bounds.max.z - bounds.min.z
        {
            let why = format!("the stock is not longer than the {} mm in the jaws", self.grip_mm);
            return Err(("grip_mm", why));
        }
        let behind = bounds.map(|bounds| bounds.min.z + self.grip_mm);
        let Some(front_z) = self.jaw_z_mm.or(behind) else {
            return Err(("jaw_z_mm", "without a stock the place of the jaws is needed".to_string()));
        };
        let gripped = stock.and_then(|stock| gripped_radius(stock, front_z, self.grip));
        let face_z = front_z - self.jaw_length_mm;
        let (low, high) = match (self.grip, gripped) {
            (Grip::Inside, Some(radius)) => ((radius - self.jaw_height_mm).max(0.0), radius),
            (Grip::Inside, None) => return Err(("grip", "the stock has no bore for the jaws".to_string())),
            (Grip::Outside, radius) => {
                let radius = radius.unwrap_or(0.0);
                (radius, radius + self.jaw_height_mm)
            }
        };
        let jaw = Outline::rectangle(Point::new(low, face_z), Point::new(high, front_z));
        let jaw = jaw.map_err(no_shape("jaw_height_mm"))?;
        let back_z = face_z - self.length_mm;
        let body = Outline::rectangle(Point::new(0.0, back_z), Point::new(self.diameter_mm / 2.0, face_z));
        Ok(ChuckOutlines { jaw, body: body.map_err(no_shape("diameter_mm"))? })
    }
}

/// The radius that jaws find behind a place: of a shape that is not round, the largest outside, the smallest inside.
fn gripped_radius(stock: &Outline, front_z: f64, grip: Grip) -> Option<f64> {
    let behind: Vec<&turnwright_geometry::Segment> =
        stock.segments().iter().filter(|one| one.start.z.min(one.end.z) < front_z).collect();
    let is_inner = |x: f64| x > 0.0;
    let ends = behind.iter().flat_map(|one| [one.start.x, one.end.x]);
    match grip {
        Grip::Outside => ends.reduce(f64::max),
        Grip::Inside => {
            let Bounds { max, .. } = stock.bounds();
            ends.filter(|x| is_inner(*x) && *x < max.x).reduce(f64::min)
        }
    }
}

impl Tailstock {
    /// Centre and quill; `face_z` is where the front face of the stock is.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn outline(&self, face_z: Option<f64>) -> Result<Outline, Fault> {
        positive(&[
            ("centre_mm", self.centre_mm),
            ("centre_length_mm", self.centre_length_mm),
            ("quill_mm", self.quill_mm),
            ("quill_length_mm", self.quill_length_mm),
        ])?;
        if !(10.0..=170.0).contains(&self.point_angle_deg) {
            return Err(("point_angle_deg", "must be 10 to 170 degrees".to_string()));
        }
        if self.point_z_mm.is_some_and(|z| !(z.is_finite() && z.abs() <= 100_000.0)) {
            return Err(("point_z_mm", "is no place".to_string()));
        }
        let half = (self.point_angle_deg / 2.0).to_radians();
        let cone = self.centre_mm / 2.0 / libm::tan(half);
        if cone >= self.centre_length_mm {
            return Err(("centre_length_mm", "the centre is shorter than its point".to_string()));
        }
        if self.quill_mm <= self.centre_mm {
            return Err(("quill_mm", "the quill is thicker than the centre".to_string()));
        }
        // A centre hole of a usual size takes in a third of the point.
        let Some(point_z) = self.point_z_mm.or(face_z.map(|face| face - cone / 3.0)) else {
            return Err(("point_z_mm", "without a stock the place of the centre is needed".to_string()));
        };
        let (centre, quill) = (self.centre_mm / 2.0, self.quill_mm / 2.0);
        let quill_z = point_z + self.centre_length_mm;
        let end_z = quill_z + self.quill_length_mm;
        let at = Point::new;
        Outline::polygon(&[
            at(0.0, point_z),
            at(0.0, end_z),
            at(quill, end_z),
            at(quill, quill_z),
            at(centre, quill_z),
            at(centre, point_z + cone),
        ])
        .map_err(no_shape("centre_mm"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar() -> Outline {
        Outline::rectangle(Point::new(0.0, -80.0), Point::new(25.0, 1.0)).expect("a bar")
    }

    #[test]
    fn jaws_grip_the_back_of_the_stock() {
        let outlines = Chuck::default().outlines(Some(&bar())).expect("a chuck");
        let (jaw, body) = (outlines.jaw.bounds(), outlines.body.bounds());
        assert_eq!((jaw.min, jaw.max), (Point::new(25.0, -95.0), Point::new(65.0, -60.0)));
        assert_eq!((body.min, body.max), (Point::new(0.0, -185.0), Point::new(100.0, -95.0)));
        // The step behind the place of the jaws is what they grip.
        let stepped = [(0.0, 0.0), (30.0, 0.0), (30.0, -50.0), (20.0, -50.0), (20.0, -80.0), (0.0, -80.0)];
        let stepped = Outline::polygon(&stepped.map(|(x, z)| Point::new(x, z))).expect("a forging");
        let chuck = Chuck { jaw_z_mm: Some(-60.0), ..Chuck::default() };
        assert_eq!(chuck.outlines(Some(&stepped)).expect("a chuck").jaw.bounds().min.x, 20.0);
        let tube = Outline::rectangle(Point::new(15.0, -80.0), Point::new(25.0, 1.0)).expect("a tube");
        let chuck = Chuck { grip: Grip::Inside, jaw_height_mm: 10.0, ..Chuck::default() };
        let jaw = chuck.outlines(Some(&tube)).expect("a chuck").jaw.bounds();
        assert_eq!((jaw.min.x, jaw.max.x), (5.0, 15.0));
    }

    #[test]
    fn the_centre_stands_in_the_face() {
        let outline =
            Tailstock { point_z_mm: Some(-3.0), ..Tailstock::default() }.outline(None).expect("a centre");
        let bounds = outline.bounds();
        assert_eq!((bounds.min, bounds.max), (Point::new(0.0, -3.0), Point::new(35.0, 207.0)));
        let cone = 12.5 / libm::tan(30_f64.to_radians());
        let usual = Tailstock::default().outline(Some(1.0)).expect("a centre");
        assert!((usual.bounds().min.z - (1.0 - cone / 3.0)).abs() < 1e-12);
    }

    #[test]
    fn grip_is_lost_with_the_square_of_the_speed() {
        let chuck = Chuck { rpm_max: Some(4000), grip_force_kn: Some(60.0), ..Chuck::default() };
        let law = chuck.grip_law().expect("a law").expect("a force");
        // A third is left at the rated speed: that is what rates it.
        assert!((law.left_kn(4000.0) - 20.0).abs() < 1e-12 && (law.rpm_max() - 4000.0).abs() < 1e-9);
        assert!((law.left_kn(2000.0) - 50.0).abs() < 1e-12);
        // Set to a quarter, it may turn half as fast.
        let gently = Chuck { grip_force_kn: Some(15.0), grip_force_max_kn: Some(60.0), ..chuck.clone() };
        let law = gently.grip_law().expect("a law").expect("a force");
        assert!((law.rpm_max() - 2000.0).abs() < 1e-9 && (law.left_kn(2000.0) - 5.0).abs() < 1e-12);
        assert_eq!(law.left_kn(4000.0), 0.0);
        let inside = Chuck { grip: Grip::Inside, ..chuck };
        assert_eq!(inside.grip_law(), Ok(None));
        assert_eq!(Chuck::default().grip_law(), Ok(None));
    }

    #[test]
    fn a_bar_whips_at_its_first_bending_frequency() {
        let bar = Bar { behind_mm: Some(1000.0), diameter_mm: Some(50.0), ..Bar::default() };
        // 3.516 · 5123 m/s · 12.5 mm / 1 m² = 225.2 1/s.
        let rpm = bar.critical_rpm(None, None).expect("a speed");
        assert!((rpm - 2150.0).abs() < 2.0, "{rpm}");
        // Half as long, four times as fast; guided, (3.9266 / 1.8751)² = 4.385 times.
        let short = Bar { behind_mm: Some(500.0), ..bar.clone() }.critical_rpm(None, None).expect("a speed");
        assert!((short / rpm - 4.0).abs() < 1e-12);
        let guided = Bar { end: BarEnd::Guided, ..bar.clone() }.critical_rpm(None, None).expect("a speed");
        assert!((guided / rpm - 4.385).abs() < 1e-3);
        // A tube is stiffer for its mass; brass is softer for its.
        let tube = Bar { bore_mm: Some(30.0), ..bar.clone() }.critical_rpm(None, None).expect("a speed");
        assert!((tube / rpm - 34_f64.sqrt() / 5.0).abs() < 1e-12);
        let brass = crate::materials::material("H59").expect("brass");
        let softer = bar.critical_rpm(None, Some(brass)).expect("a speed");
        assert!(softer < 0.75 * rpm && softer > 0.6 * rpm, "{softer}");
        let fault = |bar: Bar| bar.critical_rpm(None, None).expect_err("refused").0;
        assert_eq!(fault(Bar { behind_mm: None, ..bar.clone() }), "behind_mm");
        assert_eq!(fault(Bar { behind_mm: Some(-3.0), ..bar.clone() }), "behind_mm");
        assert_eq!(fault(Bar { diameter_mm: None, ..bar.clone() }), "diameter_mm");
        assert_eq!(fault(Bar { bore_mm: Some(50.0), ..bar }), "bore_mm");
    }

    #[test]
    fn what_cannot_hold_is_refused_with_the_key() {
        let chuck = |change: fn(&mut Chuck)| {
            let mut chuck = Chuck::default();
            change(&mut chuck);
            chuck.outlines(Some(&bar())).expect_err("refused").0
        };
        assert_eq!(chuck(|chuck| chuck.grip_mm = 90.0), "grip_mm");
        assert_eq!(chuck(|chuck| chuck.jaw_height_mm = -1.0), "jaw_height_mm");
        assert_eq!(chuck(|chuck| chuck.diameter_mm = f64::NAN), "diameter_mm");
        assert_eq!(chuck(|chuck| chuck.grip = Grip::Inside), "grip");
        assert_eq!(chuck(|chuck| chuck.grip_force_kn = Some(0.0)), "grip_force_kn");
        // The rated speed is needed, and the rating is no less than what is set.
        assert_eq!(chuck(|chuck| chuck.grip_force_kn = Some(20.0)), "grip_force_kn");
        assert_eq!(chuck(|chuck| chuck.grip_force_max_kn = Some(20.0)), "grip_force_max_kn");
        let weak = Chuck { rpm_max: Some(3000), grip_force_kn: Some(30.0), ..Chuck::default() };
        let weak = Chuck { grip_force_max_kn: Some(20.0), ..weak };
        assert_eq!(weak.outlines(Some(&bar())).expect_err("refused").0, "grip_force_max_kn");
        assert_eq!(chuck(|chuck| chuck.rpm_max = Some(0)), "rpm_max");
        assert_eq!(chuck(|chuck| chuck.jaw_z_mm = Some(f64::INFINITY)), "jaw_z_mm");
        assert_eq!(Chuck::default().outlines(None).expect_err("refused").0, "jaw_z_mm");
        let tailstock = |change: fn(&mut Tailstock)| {
            let mut tailstock = Tailstock::default();
            change(&mut tailstock);
            tailstock.outline(Some(0.0)).expect_err("refused").0
        };
        assert_eq!(tailstock(|tailstock| tailstock.point_angle_deg = 0.0), "point_angle_deg");
        assert_eq!(tailstock(|tailstock| tailstock.centre_length_mm = 5.0), "centre_length_mm");
        assert_eq!(tailstock(|tailstock| tailstock.quill_mm = 20.0), "quill_mm");
        assert_eq!(Tailstock::default().outline(None).expect_err("refused").0, "point_z_mm");
    }
}
