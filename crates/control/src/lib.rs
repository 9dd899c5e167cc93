//! What a control *is*: its codes, parameters, policies, limits, alarm numbers and texts.
//!
//! In: the tables of `data/`, compiled in. Out: a [`Control`] to run programs with, [`Messages`] to explain
//! what happened, a [`Setup`] of machine, offsets and parameters.
//!
//! Deliberately not here: execution. Control names stand only in `data/`; where behaviour differs, a named
//! policy (see [`policy`]) is answered there and asked by the stage concerned.

mod blank;
mod fits;
mod functions;
mod gears;
mod limits;
mod machine;
mod materials;
mod measures;
mod messages;
mod outline;
mod parameter_text;
mod parameters;
pub mod policy;
mod setup;
mod setup_comment;
mod setup_text;
mod signal;
mod suggest;
mod tooling;
mod workholding;

use policy::{AlarmIds, Policies};
use serde::Deserialize;

pub use blank::Stock;
pub use functions::{CodeSystem, FunctionEntry, Functions, Group, parse_code};
pub use gears::{GEARS_MAX, Gear, GearSelection};
pub use limits::Limits;
pub use machine::{AUXILIARY_TIMES_MAX, AccDec, LinearAxis, Machine, MachineAxes, RotaryAxis, SpeedWait};
pub use materials::{IsoGroup, Material, material, materials};
pub use measures::{Measure, MeasureEntry, Quantity, SectionSpot};
pub use messages::{Language, MessageText, Messages, RaisedBy};
pub use outline::{ArcTurn, OutlinePoint};
pub use parameter_text::{
    ParameterExport, ParameterImport, ParameterLine, export_parameters, import_parameters,
};
pub use parameters::{Acts, Axis, Parameter, ParameterFault, Parameters, UnderNumber};
pub use setup::{
    AxisPair, CheckSwitches, Mode, Offset, OffsetRow, Setup, SetupFault, ThreadRecord, ZeroRow, machine_names,
};
pub use setup_comment::setup_comment;
pub use setup_text::setup_key_words;
pub use signal::Signal;
pub use suggest::nearest;
pub use tooling::{CuttingTurn, Flank, Hand, InsertFacing, Tool, ToolEntry, ToolKind, ToolPost, ToolSide};
pub use workholding::{Bar, BarEnd, Chuck, ChuckOutlines, Grip, GripLaw, Tailstock};

pub(crate) mod embedded {
    //! Made by the build script.
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// The control used when neither program nor user names one.
pub const DEFAULT_CONTROL: &str = embedded_default();

const fn embedded_default() -> &'static str {
    include_str!("../../../data/default-control").trim_ascii()
}

/// A control, ready to run programs.
#[derive(Clone, Debug)]
pub struct Control {
    /// Its name, as users type it.
    pub name: &'static str,
    /// Whose functions it has: its own name when the code table says something about it, else its base's.
    pub code_table: &'static str,
    /// Its name, as people write it.
    pub title: String,
    /// One line about it, English and Chinese.
    pub summary: [String; 2],
    /// Its answers to the questions on which controls differ.
    pub policies: Policies,
    /// Its limits.
    pub limits: Limits,
    /// Which alarm numbers it shows.
    pub alarm_ids: AlarmIds,
    /// Its parameters and their present values.
    pub parameters: Parameters,
    words_for_later: std::collections::BTreeMap<String, String>,
}

/// Why no control could be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ControlFault {
    /// No control has this name.
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest that exists.
        nearest: Option<&'static str>,
    },
    /// A file of `data/` is wrong; a test keeps this from happening.
    Data(String),
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct File {
    #[serde(default)]
    r#abstract: bool,
    base: Option<String>,
    title: Option<String>,
    summary: Option<Words>,
    parameter_map: Option<String>,
    alarm_ids: Option<AlarmIds>,
    #[serde(default)]
    policies: toml::Table,
    #[serde(default)]
    limits: toml::Table,
    #[serde(default)]
    parameters: toml::Table,
    #[serde(default)]
    words_for_later: toml::Table,
}

#[derive(Clone, Debug, Deserialize)]
struct Words {
    en: String,
    zh: String,
}

/// Names of all controls, sorted.
pub fn control_names() -> Vec<&'static str> {
    embedded::CONTROLS
        .iter()
        .filter(|(_, text)| !toml::from_str::<File>(text).is_ok_and(|file| file.r#abstract))
        .map(|(name, _)| *name)
        .collect()
}

impl Control {
    /// Loads a control by name (case and `_` for `-` do not matter).
    ///
    /// # Errors
    /// [`ControlFault::Unknown`] with the nearest name.
    pub fn load(name: &str) -> Result<Self, ControlFault> {
        let wanted = name.trim().to_ascii_lowercase().replace(['_', ' '], "-");
        let found = embedded::CONTROLS.iter().find(|(known, _)| *known == wanted);
        let Some((name, text)) = found else { return Err(unknown(name)) };
        Self::define(name, text)
    }

    /// A control from the text of its definition.
    fn define(name: &'static str, text: &str) -> Result<Self, ControlFault> {
        let mut file = read(name, text)?;
        if file.r#abstract {
            return Err(unknown(name));
        }
        let mut lineage = vec![name];
        let summary = file.summary.take();
        // Nearest first: what is said nearer wins.
        let mut base = file.base.clone();
        let mut steps = 0;
        while let Some(name) = base {
            steps += 1;
            let above = embedded::CONTROLS.iter().find(|(known, _)| *known == name && steps < 10);
            let Some((name, text)) = above else {
                return Err(ControlFault::Data(format!("base {name} does not exist")));
            };
            let above = read(name, text)?;
            lineage.push(*name);
            file.parameter_map = file.parameter_map.or(above.parameter_map);
            file.alarm_ids = file.alarm_ids.or(above.alarm_ids);
            for (own, from) in [
                (&mut file.policies, above.policies),
                (&mut file.limits, above.limits),
                (&mut file.parameters, above.parameters),
                (&mut file.words_for_later, above.words_for_later),
            ] {
                for (key, value) in from {
                    own.entry(key).or_insert(value);
                }
            }
            base = above.base;
        }
        let fault = |error: toml::de::Error| ControlFault::Data(format!("{name}: {error}"));
        let summary = summary.map_or_else(Default::default, |words| [words.en, words.zh]);
        let map = file.parameter_map.unwrap_or_default();
        let code_table = lineage.into_iter().find(|name| Functions.knows(name)).unwrap_or(name);
        Ok(Self {
            name,
            code_table,
            title: file.title.unwrap_or_else(|| (*name).to_string()),
            summary,
            policies: file.policies.try_into().map_err(fault)?,
            limits: file.limits.try_into().map_err(fault)?,
            words_for_later: file.words_for_later.try_into().map_err(fault)?,
            alarm_ids: file.alarm_ids.unwrap_or(AlarmIds::Four),
            parameters: Parameters::load(&map, &file.parameters).map_err(ControlFault::Data)?,
        })
    }
}

impl Control {
    /// Letters that a function takes on this control and that are not executed yet: they are refused by name.
    pub fn words_for_later(&self, function: &str) -> &str {
        self.words_for_later.get(function).map_or("", String::as_str)
    }
}

fn read(name: &str, text: &str) -> Result<File, ControlFault> {
    toml::from_str(text).map_err(|error| ControlFault::Data(format!("{name}: {error}")))
}

fn unknown(name: &str) -> ControlFault {
    ControlFault::Unknown { name: name.to_string(), nearest: nearest(name, control_names()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_control_of_the_contract_loads() {
        for name in [
            "fanuc-0i-mate-tb",
            "fanuc-0i-tc",
            "fanuc-0i-td",
            "fanuc-0i-tf",
            "gsk-980tdc",
            "gsk-980tdi",
            "gsk-988ta",
            "gsk-988tb",
        ] {
            let control = Control::load(name).unwrap_or_else(|fault| panic!("{name}: {fault:?}"));
            assert_eq!(control.name, name);
            assert!(!control.summary[0].is_empty() && !control.summary[1].is_empty(), "{name}");
        }
        assert!(control_names().len() >= 8);
        assert!(control_names().contains(&DEFAULT_CONTROL));
    }

    #[test]
    fn adding_a_control_is_one_file() {
        let text = "base = \"fanuc-0i-tf\"\ntitle = \"Our lathe\"\n[policies]\nescape-speed = \"rapid\"\n";
        let ours = Control::define("our-lathe", text).expect("a definition");
        let base = Control::load("fanuc-0i-tf").expect("a control");
        assert_eq!(ours.policies.escape_speed, policy::EscapeSpeed::Rapid);
        assert_eq!(ours.policies.arc_end_error, base.policies.arc_end_error);
        let codes = |control: &Control| -> Vec<&str> {
            let table = Functions.iter();
            table.filter(|(_, entry)| entry.is_on(control.code_table)).map(|(name, _)| name).collect()
        };
        assert_eq!(codes(&ours), codes(&base));
        assert!(codes(&base).len() > 50);
        assert!(matches!(Control::define("our-lathe", "base = \"none\""), Err(ControlFault::Data(_))));
    }

    #[test]
    fn a_wrong_name_gets_the_nearest_one() {
        let fault = Control::load("fanuc-0i-tff").expect_err("no such control");
        assert!(matches!(fault, ControlFault::Unknown { nearest: Some("fanuc-0i-tf"), .. }), "{fault:?}");
    }
}
