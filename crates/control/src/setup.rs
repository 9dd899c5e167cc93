//! The setup: which machine, offsets and parameters a program meets.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::{embedded, nearest};

/// A pair of axis values in millimetres; X as a diameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisPair {
    /// X, mm, diameter.
    #[serde(default)]
    pub x: f64,
    /// Z, mm.
    #[serde(default)]
    pub z: f64,
}

/// A machine: rates, times, and where its reference point lies. Units are the last part of each name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "name and unit say it; data/machines has the words")]
pub struct Machine {
    pub name: String,
    pub rapid_x_mm_per_min: f64,
    pub rapid_z_mm_per_min: f64,
    pub cutting_max_mm_per_min: f64,
    pub tool_change_s: f64,
    pub spindle_ramp_rpm_per_s: f64,
    pub auxiliary_s: f64,
    pub rpm_max: u32,
    pub rpm_min_surface: u32,
    pub reference: AxisPair,
}

/// A tool offset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Geometry, mm, X as a diameter.
    #[serde(default)]
    pub geometry: AxisPair,
    /// Wear, mm, X as a diameter.
    #[serde(default)]
    pub wear: AxisPair,
}

/// What a setup file says.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// The control to use.
    pub control: Option<String>,
    /// The machine, by the name of its file in `data/machines`.
    pub machine: Option<String>,
    /// Parameters by the control's numbers.
    #[serde(default)]
    pub parameters: BTreeMap<String, toml::Value>,
    /// Overrides of single machine values.
    #[serde(default)]
    pub rates: toml::Table,
    /// Tool offsets by number.
    #[serde(default)]
    pub offsets: BTreeMap<String, Offset>,
    /// Work coordinate systems 1 to 6: their zeros, measured from the first one's, mm, X as a diameter.
    #[serde(default)]
    pub work: BTreeMap<String, AxisPair>,
}

/// What is wrong with a setup file, with its line when known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupFault {
    /// What is wrong.
    pub message: String,
    /// Line from 1, or 0.
    pub line: u32,
}

/// Names of the machines in `data/machines`.
pub fn machine_names() -> impl Iterator<Item = &'static str> {
    embedded::MACHINES.iter().map(|(name, _)| *name)
}

impl Setup {
    /// Reads a setup file's text.
    ///
    /// # Errors
    /// What cannot be read, unknown keys with the known ones.
    pub fn parse(text: &str) -> Result<Self, SetupFault> {
        toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = if error.span().is_some() {
                text.get(..start).unwrap_or("").matches('\n').count() as u32 + 1
            } else {
                0
            };
            SetupFault { message: error.message().to_string(), line }
        })
    }

    /// Parameters as number and value, in words as a user would type them.
    pub fn parameter_words(&self) -> impl Iterator<Item = (&str, String)> {
        self.parameters.iter().map(|(number, value)| {
            let value = match value {
                toml::Value::Integer(value) => value.to_string(),
                toml::Value::Float(value) => value.to_string(),
                toml::Value::Boolean(value) => u8::from(*value).to_string(),
                toml::Value::String(value) => value.clone(),
                other => other.type_str().to_string(),
            };
            (number.as_str(), value)
        })
    }

    /// The machine with its overrides.
    ///
    /// # Errors
    /// An unknown machine or an unknown key among the overrides.
    pub fn machine(&self) -> Result<Machine, SetupFault> {
        let wanted = self.machine.as_deref().unwrap_or("generic-lathe");
        let Some((_, text)) = embedded::MACHINES.iter().find(|(name, _)| *name == wanted) else {
            let near = nearest(wanted, machine_names());
            let near = near.map_or(String::new(), |name| format!("; did you mean {name}?"));
            return Err(SetupFault { message: format!("no machine is called {wanted}{near}"), line: 0 });
        };
        let fault = |error: toml::de::Error| SetupFault { message: error.message().to_string(), line: 0 };
        let mut table: toml::Table = toml::from_str(text).map_err(fault)?;
        for (key, value) in &self.rates {
            // A whole number is a fine length too.
            table.insert(key.clone(), value.clone());
        }
        let machine: Machine = table.try_into().map_err(fault)?;
        let positive = [
            machine.rapid_x_mm_per_min,
            machine.rapid_z_mm_per_min,
            machine.cutting_max_mm_per_min,
            machine.spindle_ramp_rpm_per_s,
        ];
        if positive.iter().any(|rate| !rate.is_finite() || *rate <= 0.0) {
            return Err(SetupFault { message: "rates must be greater than zero".to_string(), line: 0 });
        }
        Ok(machine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_are_errors_with_a_line() {
        let fault = Setup::parse("control = \"x\"\nmachin = \"y\"\n").expect_err("unknown key");
        assert_eq!(fault.line, 2);
        assert!(fault.message.contains("machin"), "{}", fault.message);
    }

    #[test]
    fn machines_load_and_take_overrides() {
        let setup = Setup::parse("[rates]\nrapid_x_mm_per_min = 6000\n").expect("setup");
        assert_eq!(setup.machine().expect("machine").rapid_x_mm_per_min, 6000.0);
        let setup = Setup::parse("[rates]\nrapid_y = 1\n").expect("setup");
        assert!(setup.machine().is_err());
        for name in machine_names() {
            let setup = Setup { machine: Some(name.to_string()), ..Setup::default() };
            setup.machine().expect(name);
        }
    }
}
