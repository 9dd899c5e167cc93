//! The stock: what is in the chuck before the first cut.

use serde::Deserialize;
use turnwright_geometry::{Outline, Point};

use crate::OutlinePoint;
use crate::materials::{Material, material, materials};
use crate::outline::through;

/// `[stock]` of a setup file, in work coordinates: a bar, a tube, or a profile.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stock {
    /// What it is made of, by a name of `data/materials.toml`.
    pub material: Option<String>,
    /// Outer diameter of a bar or tube, mm.
    pub diameter_mm: Option<f64>,
    /// Diameter of the bore of a tube, mm.
    pub bore_mm: Option<f64>,
    /// Length, mm, from the front face to the back one.
    pub length_mm: Option<f64>,
    /// Z of the front face, mm: how far it stands in front of Z0.
    pub face_mm: f64,
    /// Half-section of a forging or casting, as a closed outline; X as a diameter, mm.
    pub profile: Vec<OutlinePoint>,
}

impl Stock {
    /// Whether nothing is said about it.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Whether nothing is said about its shape.
    pub fn is_shapeless(&self) -> bool {
        *self == Self { material: self.material.clone(), ..Self::default() }
    }

    /// What it is made of, as far as that is said.
    ///
    /// # Errors
    /// A material that nobody knows, with the nearest that is known.
    pub fn material(&self) -> Result<Option<&'static Material>, (&'static str, String)> {
        let Some(name) = &self.material else { return Ok(None) };
        material(name).map(Some).map_err(|nearest| {
            let hint = nearest.map_or_else(
                || materials().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", "),
                |nearest| format!("did you mean {nearest}?"),
            );
            ("material", format!("{name} is not known; {hint}"))
        })
    }

    /// Its half-section, X as a radius.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn outline(&self) -> Result<Outline, (&'static str, String)> {
        let fault = |key, why: &str| Err((key, why.to_string()));
        if !(self.face_mm.is_finite() && self.face_mm.abs() <= 10_000.0) {
            return fault("face_mm", "is no place");
        }
        if !self.profile.is_empty() {
            if self.diameter_mm.or(self.bore_mm).or(self.length_mm).is_some() {
                return fault(
                    "profile",
                    "says the whole shape; diameter_mm, bore_mm and length_mm go without it",
                );
            }
            if self.profile.iter().any(|point| point.x < 0.0) {
                return fault("profile", "reaches below the spindle axis");
            }
            let profile: Vec<OutlinePoint> = self
                .profile
                .iter()
                .map(|point| OutlinePoint { z: point.z + self.face_mm, ..*point })
                .collect();
            let outline = through(&profile, 0.5).map_err(|why| ("profile", why))?;
            if outline.bounds().min.x < 0.0 {
                return fault("profile", "reaches below the spindle axis");
            }
            return Ok(outline);
        }
        let size =
            |value: Option<f64>| value.filter(|size| size.is_finite() && *size > 0.0 && *size <= 100_000.0);
        let Some(diameter) = size(self.diameter_mm) else {
            return fault("diameter_mm", "the stock needs a diameter greater than zero, or a profile");
        };
        let Some(length) = size(self.length_mm) else {
            return fault("length_mm", "the stock needs a length greater than zero");
        };
        let bore = self.bore_mm.unwrap_or(0.0);
        if !(bore.is_finite() && bore >= 0.0) {
            return fault("bore_mm", "a bore is not negative");
        }
        if bore >= diameter {
            let why = format!("a bore of {bore} mm leaves nothing of a diameter of {diameter} mm");
            return Err(("bore_mm", why));
        }
        let (low, high) =
            (Point::new(bore / 2.0, self.face_mm - length), Point::new(diameter / 2.0, self.face_mm));
        Outline::rectangle(low, high).map_err(|_| ("length_mm", "the stock has no section".to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stock(text: &str) -> Stock {
        toml::from_str(text).unwrap_or_else(|fault| panic!("{text}: {fault}"))
    }

    #[test]
    fn bars_and_tubes_stand_with_their_face_in_front_of_zero() {
        let tube =
            stock("diameter_mm = 50\nbore_mm = 20\nlength_mm = 80\nface_mm = 1").outline().expect("a tube");
        let bounds = tube.bounds();
        assert_eq!((bounds.min, bounds.max), (Point::new(10.0, -79.0), Point::new(25.0, 1.0)));
        assert_eq!(tube.area_mm2(), 15.0 * 80.0);
    }

    #[test]
    fn a_forging_is_a_profile_in_diameters() {
        let text = "profile = [{ x = 0, z = 2 }, { x = 30, z = 2 }, { x = 40, z = -3, r = 5, turn = \"ccw\" }, \
                    { x = 40, z = -50 }, { x = 0, z = -50 }]";
        let forging = stock(text).outline().expect("a forging");
        // The arc of radius 5 takes a square less a quarter circle off the corner.
        let corner = 25.0 - 25.0 * std::f64::consts::FRAC_PI_4;
        assert!((forging.area_mm2() - (20.0 * 52.0 - corner)).abs() < 1e-9, "{}", forging.area_mm2());
    }

    #[test]
    fn stock_that_cannot_be_is_refused_with_the_key() {
        for (text, key) in [
            ("", "diameter_mm"),
            ("diameter_mm = -5\nlength_mm = 3", "diameter_mm"),
            ("diameter_mm = nan\nlength_mm = 3", "diameter_mm"),
            ("diameter_mm = 50", "length_mm"),
            ("diameter_mm = 50\nlength_mm = 80\nbore_mm = 50", "bore_mm"),
            ("diameter_mm = 50\nlength_mm = 80\nbore_mm = -1", "bore_mm"),
            ("diameter_mm = 50\nlength_mm = 80\nface_mm = inf", "face_mm"),
            (
                "diameter_mm = 50\nprofile = [{ x = 0, z = 0 }, { x = 9, z = 0 }, { x = 9, z = -9 }]",
                "profile",
            ),
            (
                "profile = [{ x = 0, z = 0 }, { x = 9, z = -9 }, { x = 9, z = 0 }, { x = 0, z = -9 }]",
                "profile",
            ),
            ("profile = [{ x = -9, z = 0 }, { x = 9, z = 0 }, { x = 9, z = -9 }]", "profile"),
        ] {
            let (found, why) = stock(text).outline().expect_err(text);
            assert_eq!((found, why.is_empty()), (key, false), "{text}: {why}");
        }
    }
}
