//! Parameters: named by meaning, numbered by control.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

use crate::{Language, nearest};

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Texts {
    name: String,
    effect: String,
}

/// A parameter as `data/parameters.toml` has it.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Parameter {
    /// Unit of its value: `bit`, `count`, `mm`, …
    pub unit: String,
    numbers: BTreeMap<String, String>,
    default: f64,
    #[serde(default)]
    #[expect(dead_code, reason = "kept in the data for readers")]
    certainty: Option<String>,
    en: Texts,
    zh: Texts,
}

impl Parameter {
    /// Its name in a language.
    pub fn name(&self, language: Language) -> &str {
        match language {
            Language::English => &self.en.name,
            Language::Chinese => &self.zh.name,
        }
    }

    /// What it changes, in a language.
    pub fn effect(&self, language: Language) -> &str {
        match language {
            Language::English => &self.en.effect,
            Language::Chinese => &self.zh.effect,
        }
    }
}

/// Why a parameter could not be set.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterFault {
    /// The control has no parameter of this number.
    Unknown {
        /// What was asked for.
        number: String,
        /// The nearest number that exists.
        nearest: Option<String>,
    },
    /// The value cannot be the parameter's.
    Value {
        /// The number.
        number: String,
        /// What was given.
        value: String,
        /// What is expected.
        expected: &'static str,
    },
}

/// The parameters of one control and their present values.
#[derive(Clone, Debug)]
pub struct Parameters {
    map: String,
    values: BTreeMap<String, f64>,
}

/// The table; read when it is first asked for.
fn table() -> &'static BTreeMap<String, Parameter> {
    static TABLE: OnceLock<BTreeMap<String, Parameter>> = OnceLock::new();
    TABLE.get_or_init(|| {
        toml::from_str(include_str!("../../../data/parameters.toml"))
            .unwrap_or_else(|error| unreachable!("data/parameters.toml is read by a test: {error}"))
    })
}

impl Parameters {
    /// The defaults of a parameter map, with a control's own values over them.
    pub(crate) fn load(map: &str, own: &toml::Table) -> Result<Self, String> {
        let mut values = BTreeMap::new();
        for (name, parameter) in table() {
            values.insert(name.clone(), parameter.default);
        }
        for (name, value) in own {
            let value = value.as_integer().map(|n| n as f64).or(value.as_float());
            match (values.get_mut(name), value) {
                (Some(slot), Some(value)) => *slot = value,
                _ => return Err(format!("parameter {name} is unknown or has no number")),
            }
        }
        Ok(Self { map: map.to_string(), values })
    }

    /// The value of a parameter by name; bits are 0 and 1.
    pub fn value(&self, name: &str) -> f64 {
        debug_assert!(self.values.contains_key(name), "no parameter {name} in data/parameters.toml");
        self.values.get(name).copied().unwrap_or(0.0)
    }

    /// A bit by name.
    pub fn bit(&self, name: &str) -> bool {
        self.value(name) != 0.0
    }

    /// Sets a parameter by the number that the control gives it: `3401#0`, `5130`, `051`.
    ///
    /// # Errors
    /// An unknown number (with the nearest), or a value of the wrong kind.
    pub fn set(&mut self, number: &str, value: &str) -> Result<(), ParameterFault> {
        let number = number.trim();
        let table = table();
        let known = table.iter().filter_map(|(name, p)| p.numbers.get(&self.map).map(|n| (name, p, n)));
        let Some((name, parameter, printed)) =
            known.clone().find(|(_, _, printed)| normal(printed.trim_start_matches('!')) == normal(number))
        else {
            let numbers: Vec<&str> = known.map(|(_, _, n)| n.trim_start_matches('!')).collect();
            let nearest = nearest(number, numbers).map(str::to_string);
            return Err(ParameterFault::Unknown { number: number.to_string(), nearest });
        };
        let fault = |expected| ParameterFault::Value {
            number: number.to_string(),
            value: value.to_string(),
            expected,
        };
        let parsed: f64 = value.trim().parse().map_err(|_| fault("a number"))?;
        let parsed = match parameter.unit.as_str() {
            "bit" if parsed == 0.0 || parsed == 1.0 => {
                if printed.starts_with('!') {
                    1.0 - parsed
                } else {
                    parsed
                }
            }
            "bit" => return Err(fault("0 or 1")),
            "count" | "tenth-lead" | "rpm" | "percent" if parsed < 0.0 || parsed.fract() != 0.0 => {
                return Err(fault("a whole number, not negative"));
            }
            _ if parsed.is_finite() && parsed.abs() < 1e9 => parsed,
            _ => return Err(fault("a number in range")),
        };
        self.values.insert(name.clone(), parsed);
        Ok(())
    }

    /// The number that the control gives a parameter, without the mark of an inverted bit.
    pub fn number(&self, name: &str) -> Option<String> {
        let number = table().get(name)?.numbers.get(&self.map)?.trim_start_matches('!').to_string();
        Some(number)
    }

    /// The parameter with a number of this control, with its name.
    pub fn find(&self, number: &str) -> Option<(String, Parameter, f64)> {
        let (name, parameter) = table().iter().find(|(_, p)| {
            p.numbers.get(&self.map).is_some_and(|n| normal(n.trim_start_matches('!')) == normal(number))
        })?;
        Some((name.clone(), parameter.clone(), self.value(name)))
    }

    /// Every parameter of this control: number, name, table entry, value.
    pub fn all(&self) -> Vec<(String, String, Parameter, f64)> {
        let mut all: Vec<_> = table()
            .iter()
            .filter_map(|(name, p)| {
                let number = p.numbers.get(&self.map)?.trim_start_matches('!').to_string();
                Some((number, name.clone(), p.clone(), self.value(name)))
            })
            .collect();
        all.sort_by(|a, b| a.0.cmp(&b.0));
        all
    }
}

/// `051` and `51`, `0001#1` and `1#1` are the same parameter.
fn normal(number: &str) -> String {
    let upper = number.trim().to_ascii_uppercase();
    let (whole, bit) = upper.split_once('#').unwrap_or((&upper, ""));
    let whole = whole.trim_start_matches(['N', 'O', '.']).trim_start_matches('0');
    format!("{whole}#{bit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Control;

    #[test]
    fn numbers_are_the_controls_own_and_inverted_bits_are_turned() {
        let mut fanuc = Control::load("fanuc-0i-tf").expect("control").parameters;
        fanuc.set("3402#4", "1").expect("known");
        assert!(fanuc.bit("feed-per-minute-at-power-on"));
        let mut gsk = Control::load("gsk-980tdi").expect("control").parameters;
        gsk.set("182#0", "0").expect("known");
        assert!(gsk.bit("feed-per-minute-at-power-on"));
        gsk.set("182#0", "1").expect("known");
        assert!(!gsk.bit("feed-per-minute-at-power-on"));
    }

    #[test]
    fn unknown_numbers_and_wrong_values_are_refused() {
        let mut parameters = Control::load("fanuc-0i-tf").expect("control").parameters;
        assert!(matches!(
            parameters.set("3401#9", "1"),
            Err(ParameterFault::Unknown { nearest: Some(_), .. })
        ));
        assert!(matches!(parameters.set("3401#0", "2"), Err(ParameterFault::Value { .. })));
        assert!(matches!(parameters.set("5130", "-1"), Err(ParameterFault::Value { .. })));
        assert!(matches!(parameters.set("5130", "ten"), Err(ParameterFault::Value { .. })));
    }
}
