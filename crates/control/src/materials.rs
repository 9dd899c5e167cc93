//! What is cut: names, density and specific cutting force, from `data/materials.toml`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::{Language, nearest};

/// The groups of ISO 513.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum IsoGroup {
    /// Steel.
    P,
    /// Stainless steel.
    M,
    /// Cast iron.
    K,
    /// Aluminium, copper and what else is no iron.
    N,
    /// Titanium and alloys that resist heat.
    S,
    /// Hardened steel.
    H,
}

/// A material.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// The name that it is known by first.
    #[serde(skip)]
    pub name: String,
    /// Its group.
    pub iso: IsoGroup,
    /// Other names of it, or of grades so near that the same numbers hold.
    pub names: Vec<String>,
    /// Specific cutting force at a chip of 1 mm × 1 mm, N/mm².
    pub kc11_n_per_mm2: f64,
    /// How it rises with thinner chips.
    pub mc: f64,
    /// Mass of a cubic centimetre, g.
    pub density_g_per_cm3: f64,
    /// Modulus of elasticity, GPa.
    pub elastic_gpa: f64,
    title: Words,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    en: String,
    zh: String,
}

static MATERIALS: LazyLock<Vec<Material>> = LazyLock::new(|| {
    let table: BTreeMap<String, Material> = toml::from_str(include_str!("../../../data/materials.toml"))
        .unwrap_or_else(|error| unreachable!("data/materials.toml is read by a test: {error}"));
    table.into_iter().map(|(name, material)| Material { name, ..material }).collect()
});

impl Material {
    /// What it is, in words.
    pub fn title(&self, language: Language) -> &str {
        match language {
            Language::English => &self.title.en,
            Language::Chinese => &self.title.zh,
        }
    }

    /// Speed of sound along a bar of it.
    pub fn speed_of_sound_m_per_s(&self) -> f64 {
        (self.elastic_gpa * 1e9 / (self.density_g_per_cm3 * 1e3)).sqrt()
    }

    /// Its first name and the others.
    fn all_names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.name.as_str()).chain(self.names.iter().map(String::as_str))
    }
}

/// All materials, by name.
pub fn materials() -> impl Iterator<Item = &'static Material> {
    MATERIALS.iter()
}

/// Letters and digits alone, small: blanks, hyphens and points in a grade's name are a matter of taste.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The material of a name.
///
/// # Errors
/// The nearest name that is known.
pub fn material(name: &str) -> Result<&'static Material, Option<&'static str>> {
    let wanted = plain(name);
    let found = MATERIALS.iter().find(|one| one.all_names().any(|known| plain(known) == wanted));
    let near = || nearest(name, MATERIALS.iter().flat_map(Material::all_names));
    found.filter(|_| !wanted.is_empty()).ok_or_else(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_known_by_all_their_names() {
        for (name, known) in [
            ("45", "45"),
            ("45钢", "45"),
            ("C45", "45"),
            ("40cr", "40Cr"),
            ("304", "304"),
            ("HT250", "HT250"),
            ("6061-T6", "6061"),
            ("H59", "H59"),
            ("gcr15", "GCr15"),
        ] {
            assert_eq!(material(name).map(|one| one.name.as_str()), Ok(known), "{name}");
        }
        assert_eq!(material("40Crr").map(|one| one.name.as_str()), Err(Some("40Cr")));
        assert!(material("").map(|one| one.name.as_str()).is_err());
        assert_eq!(material("unobtainium").map(|one| one.name.as_str()), Err(None));
    }

    #[test]
    fn every_material_is_sound_and_every_name_is_its_own() {
        let mut names: Vec<String> = materials().flat_map(Material::all_names).map(plain).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count, "a name is there twice");
        for one in materials() {
            assert!((300.0..=6000.0).contains(&one.kc11_n_per_mm2), "{one:?}");
            assert!((0.1..=0.5).contains(&one.mc), "{one:?}");
            assert!((0.9..=20.0).contains(&one.density_g_per_cm3), "{one:?}");
            assert!(!one.title.en.is_empty() && !one.title.zh.is_empty(), "{one:?}");
        }
        for group in [IsoGroup::P, IsoGroup::M, IsoGroup::K, IsoGroup::N, IsoGroup::S, IsoGroup::H] {
            assert!(materials().any(|one| one.iso == group), "{group:?}");
        }
    }
}
