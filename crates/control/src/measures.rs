//! What a finished part must measure: `[[measure]]` of a setup file.
//!
//! In: an entry as it is written. Out: a [`Measure`] with one quantity, its place and its limits, or the key that is
//! wrong and the reason.

use serde::Deserialize;

use crate::fits::fit_deviations_mm;

/// Sizes and places beyond this are none, mm.
const SIZE_MM_MAX: f64 = 10_000.0;

/// A place in the half-section as people write it: `Z-32`, `X25`, `X25 Z-10`; X is a diameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SectionSpot {
    /// A diameter, mm.
    pub diameter_mm: Option<f64>,
    /// Z, mm.
    pub z_mm: Option<f64>,
}

impl SectionSpot {
    /// Reads a place.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let fault = || format!("{text:?} is no place: write Z-32, X25 or \"X25 Z-10\"");
        let mut spot = Self::default();
        // A letter begins a word, with or without a blank before it.
        let mut rest = text.trim();
        while let Some(letter) = rest.chars().next() {
            let number = &rest[letter.len_utf8()..];
            let end = number.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E'));
            let (number, next) = number.split_at(end.unwrap_or(number.len()));
            let value: f64 = number.trim_matches([' ', '=', ',']).parse().map_err(|_| fault())?;
            if !value.is_finite() || value.abs() > SIZE_MM_MAX {
                return Err(fault());
            }
            let slot = match letter {
                'X' | 'x' if value >= 0.0 => &mut spot.diameter_mm,
                'Z' | 'z' => &mut spot.z_mm,
                _ => return Err(fault()),
            };
            if slot.replace(value).is_some() {
                return Err(fault());
            }
            rest = next;
        }
        if spot == Self::default() { Err(fault()) } else { Ok(spot) }
    }
}

/// An entry `[[measure]]` of a setup file; `data/setup-keys.toml` explains each key.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(missing_docs, reason = "name and unit say it; data/setup-keys.toml has the words")]
pub struct MeasureEntry {
    pub name: Option<String>,
    pub at: Option<String>,
    pub from: Option<String>,
    pub to: Option<String>,
    pub diameter_mm: Option<f64>,
    pub bore_mm: Option<f64>,
    pub wall_mm: Option<f64>,
    pub width_mm: Option<f64>,
    pub length_mm: Option<f64>,
    pub major_mm: Option<f64>,
    pub minor_mm: Option<f64>,
    pub lead_mm: Option<f64>,
    pub tolerance_mm: Option<toml::Value>,
}

/// What is measured, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// The outer diameter at a Z.
    Diameter(f64),
    /// The bore at a Z.
    Bore(f64),
    /// From bore to outside at a Z.
    Wall(f64),
    /// The gap between material at a diameter: the one nearest to a Z, or the only one.
    Width {
        /// The diameter, mm.
        diameter_mm: f64,
        /// Which gap.
        near_z: Option<f64>,
    },
    /// Between the faces nearest to two Z.
    Length {
        /// One, mm.
        from: f64,
        /// The other, mm.
        to: f64,
    },
    /// Major diameter of the thread at a Z.
    Major(f64),
    /// Minor diameter of the thread at a Z.
    Minor(f64),
    /// Lead of the thread at a Z.
    Lead(f64),
}

impl Quantity {
    /// The key of setup files that gives the size.
    pub const fn key(&self) -> &'static str {
        match self {
            Self::Diameter(_) => "diameter_mm",
            Self::Bore(_) => "bore_mm",
            Self::Wall(_) => "wall_mm",
            Self::Width { .. } => "width_mm",
            Self::Length { .. } => "length_mm",
            Self::Major(_) => "major_mm",
            Self::Minor(_) => "minor_mm",
            Self::Lead(_) => "lead_mm",
        }
    }
}

/// One size of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// What the drawing calls it.
    pub name: Option<String>,
    /// What is measured, and where.
    pub quantity: Quantity,
    /// The nominal size, mm.
    pub nominal_mm: f64,
    /// Upper and lower deviation, mm; nothing when the size is only shown.
    pub deviations_mm: Option<(f64, f64)>,
}

type Fault = (&'static str, String);

impl MeasureEntry {
    /// The size that the entry asks for.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub fn read(&self) -> Result<Measure, Fault> {
        let sizes = [
            ("diameter_mm", self.diameter_mm),
            ("bore_mm", self.bore_mm),
            ("wall_mm", self.wall_mm),
            ("width_mm", self.width_mm),
            ("length_mm", self.length_mm),
            ("major_mm", self.major_mm),
            ("minor_mm", self.minor_mm),
            ("lead_mm", self.lead_mm),
        ];
        let mut given = sizes.into_iter().filter_map(|(key, size)| Some((key, size?)));
        let Some((key, nominal_mm)) = given.next() else {
            let keys = sizes.map(|(key, _)| key).join(", ");
            return Err(("at", format!("no size: give one of {keys}")));
        };
        if let Some((other, _)) = given.next() {
            return Err((other, format!("one size for each [[measure]]; {key} is there too")));
        }
        if !(nominal_mm.is_finite() && nominal_mm > 0.0 && nominal_mm <= SIZE_MM_MAX) {
            return Err((key, "must be greater than zero".to_string()));
        }
        let quantity = self.quantity(key)?;
        let deviations_mm = self.tolerance_mm.as_ref().map(|value| match value {
            toml::Value::String(fit) => fit_of(fit, key, nominal_mm),
            value => deviations(value, nominal_mm),
        });
        let deviations_mm = deviations_mm.transpose();
        let deviations_mm = deviations_mm.map_err(|why| ("tolerance_mm", why))?;
        Ok(Measure { name: self.name.clone(), quantity, nominal_mm, deviations_mm })
    }

    fn quantity(&self, key: &str) -> Result<Quantity, Fault> {
        let place = |name, text: &Option<String>| match text {
            Some(text) => SectionSpot::parse(text).map_err(|why| (name, why)),
            None => Err((name, format!("{key} needs a place, for example {name} = \"Z-32\""))),
        };
        let only_z = |name, text: &Option<String>| match place(name, text)? {
            SectionSpot { diameter_mm: None, z_mm: Some(z) } => Ok(z),
            _ => Err((name, format!("{key} is measured at a Z, for example \"Z-32\""))),
        };
        if key == "length_mm" {
            if self.at.is_some() {
                return Err(("at", "a length goes from one face to another: give from and to".to_string()));
            }
            let (from, to) = (only_z("from", &self.from)?, only_z("to", &self.to)?);
            if from == to {
                return Err(("to", "is the place that the length begins at".to_string()));
            }
            return Ok(Quantity::Length { from, to });
        }
        for (name, text) in [("from", &self.from), ("to", &self.to)] {
            if text.is_some() {
                return Err((name, format!("goes with length_mm; {key} is measured at one place")));
            }
        }
        Ok(match key {
            "width_mm" => match place("at", &self.at)? {
                SectionSpot { diameter_mm: Some(diameter_mm), z_mm } => {
                    Quantity::Width { diameter_mm, near_z: z_mm }
                }
                _ => return Err(("at", "a width is measured at a diameter: \"X25\"".to_string())),
            },
            "diameter_mm" => Quantity::Diameter(only_z("at", &self.at)?),
            "bore_mm" => Quantity::Bore(only_z("at", &self.at)?),
            "wall_mm" => Quantity::Wall(only_z("at", &self.at)?),
            "major_mm" => Quantity::Major(only_z("at", &self.at)?),
            "minor_mm" => Quantity::Minor(only_z("at", &self.at)?),
            _ => Quantity::Lead(only_z("at", &self.at)?),
        })
    }
}

/// Deviations by a fit, `h7` or `50h7`: of shafts for outer sizes, of holes for inner ones.
fn fit_of(text: &str, key: &str, nominal_mm: f64) -> Result<(f64, f64), String> {
    let text = text.trim();
    let letter = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (size, fit) = text.split_at(letter);
    if !size.is_empty() && size.trim().parse() != Ok(nominal_mm) {
        return Err(format!(
            "{text}: {size} is not the size of {nominal_mm} mm, nor is this a fit of ISO 286"
        ));
    }
    let is_hole = fit.starts_with(|c: char| c.is_ascii_uppercase());
    match key {
        "diameter_mm" if is_hole => {
            Err(format!("{fit} is for holes; an outer diameter takes small letters, as in h7"))
        }
        "bore_mm" | "width_mm" if !is_hole => {
            Err(format!("{fit} is for shafts; bores and grooves take capitals, as in H7"))
        }
        "major_mm" | "minor_mm" | "lead_mm" => {
            Err(format!("{fit}: threads have tolerances of their own; give [upper, lower] in mm"))
        }
        _ => fit_deviations_mm(nominal_mm, fit),
    }
}

/// Upper and lower deviation: `[0, -0.021]` in either order, or `0.05` for both ways.
fn deviations(value: &toml::Value, nominal_mm: f64) -> Result<(f64, f64), String> {
    let number = |value: &toml::Value| match value {
        toml::Value::Integer(number) => Some(*number as f64),
        toml::Value::Float(number) => Some(*number).filter(|number| number.is_finite()),
        _ => None,
    };
    let expected =
        || "is [upper, lower] in mm, for example [0, -0.021], one number, or a fit \"h7\"".to_string();
    let (upper, lower) = match value {
        toml::Value::Array(both) => match both.as_slice() {
            [a, b] => {
                let (a, b) = (number(a).ok_or_else(expected)?, number(b).ok_or_else(expected)?);
                (a.max(b), a.min(b))
            }
            _ => return Err(expected()),
        },
        one => {
            let one = number(one).ok_or_else(expected)?;
            if one < 0.0 {
                return Err("one number is a deviation both ways and not negative".to_string());
            }
            (one, -one)
        }
    };
    if upper == lower {
        return Err("upper and lower limit are the same: no part could be made to that".to_string());
    }
    if upper.abs().max(lower.abs()) >= nominal_mm {
        return Err(format!("a deviation is smaller than the size of {nominal_mm} mm"));
    }
    Ok((upper, lower))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Measure, Fault> {
        toml::from_str::<MeasureEntry>(text).unwrap_or_else(|fault| panic!("{text}: {fault}")).read()
    }

    #[test]
    fn places_are_words_as_in_a_program() {
        let spot = |diameter_mm, z_mm| Ok(SectionSpot { diameter_mm, z_mm });
        assert_eq!(SectionSpot::parse("Z-32"), spot(None, Some(-32.0)));
        assert_eq!(SectionSpot::parse(" x25. z-1.5"), spot(Some(25.0), Some(-1.5)));
        assert_eq!(SectionSpot::parse("X25Z-1.5"), spot(Some(25.0), Some(-1.5)));
        assert_eq!(SectionSpot::parse("X 25, Z = -1"), spot(Some(25.0), Some(-1.0)));
        for text in ["", "Z", "32", "Y3", "Z1 Z2", "X-5", "Znan", "Z1e9", "Z-3 2"] {
            assert!(SectionSpot::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn an_entry_is_one_size_at_one_place() {
        let seat = read("at = \"Z-32\"\ndiameter_mm = 30\ntolerance_mm = [0, -0.021]").expect("a size");
        assert_eq!((seat.quantity, seat.nominal_mm), (Quantity::Diameter(-32.0), 30.0));
        assert_eq!(seat.deviations_mm, Some((0.0, -0.021)));
        let length =
            read("from = \"Z0\"\nto = \"Z-32\"\nlength_mm = 32\ntolerance_mm = 0.1").expect("a size");
        assert_eq!(length.quantity, Quantity::Length { from: 0.0, to: -32.0 });
        assert_eq!(length.deviations_mm, Some((0.1, -0.1)));
        let width = read("at = \"X25\"\nwidth_mm = 4\ntolerance_mm = [-0.1, 0.2]").expect("a size");
        assert_eq!(width.deviations_mm, Some((0.2, -0.1)));
        let fit = |text: &str| read(text).expect(text).deviations_mm;
        assert_eq!(fit("at = \"Z-1\"\ndiameter_mm = 50\ntolerance_mm = \"h7\""), Some((0.0, -0.025)));
        assert_eq!(fit("at = \"Z-1\"\ndiameter_mm = 50\ntolerance_mm = \"50h7\""), Some((0.0, -0.025)));
        assert_eq!(fit("at = \"Z-1\"\nbore_mm = 20\ntolerance_mm = \"20H7\""), Some((0.021, 0.0)));
        assert_eq!(fit("at = \"X25\"\nwidth_mm = 8\ntolerance_mm = \"N9\""), Some((0.0, -0.036)));
        assert_eq!(read("at = \"Z1\"\nlead_mm = 1.5").expect("a size").deviations_mm, None);
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_key() {
        for (text, key) in [
            ("", "at"),
            ("diameter_mm = 30", "at"),
            ("at = \"X3\"\ndiameter_mm = 30", "at"),
            ("at = \"Z3\"\ndiameter_mm = 30\nbore_mm = 3", "bore_mm"),
            ("at = \"Z3\"\ndiameter_mm = 0", "diameter_mm"),
            ("at = \"Z3\"\ndiameter_mm = nan", "diameter_mm"),
            ("at = \"Z3\"\nwidth_mm = 3", "at"),
            ("at = \"Z3\"\nlength_mm = 3", "at"),
            ("from = \"Z3\"\nlength_mm = 3", "to"),
            ("from = \"Z3\"\nto = \"Z3\"\nlength_mm = 3", "to"),
            ("at = \"Z3\"\nto = \"Z3\"\nbore_mm = 3", "to"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = [0.1]", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = [0.1, 0.1]", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = [0.1, nan]", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = -0.1", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = 3", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = true", "tolerance_mm"),
            ("at = \"Z3\"\nbore_mm = 3\ntolerance_mm = \"h7\"", "tolerance_mm"),
            ("at = \"Z3\"\ndiameter_mm = 3\ntolerance_mm = \"H7\"", "tolerance_mm"),
            ("at = \"Z3\"\ndiameter_mm = 3\ntolerance_mm = \"4h7\"", "tolerance_mm"),
            ("at = \"Z3\"\ndiameter_mm = 3\ntolerance_mm = \"x7\"", "tolerance_mm"),
            ("at = \"Z3\"\nmajor_mm = 20\ntolerance_mm = \"6g\"", "tolerance_mm"),
            ("at = \"Z3\"\nlead_mm = 2\ntolerance_mm = \"h7\"", "tolerance_mm"),
        ] {
            let (found, why) = read(text).expect_err(text);
            assert_eq!((found, why.is_empty()), (key, false), "{text}: {why}");
        }
    }
}
