//! What a control *is*: its codes, parameters, policies, limits, alarm numbers and texts.
//!
//! In: the tables of `data/`, compiled in. Out: a [`Control`] to run programs with, [`Messages`] to explain
//! what happened, a [`Setup`] of machine, offsets and parameters.
//!
//! Deliberately not here: execution. Control names stand only in `data/`; where behaviour differs, a named
//! policy (see [`policy`]) is answered there and asked by the stage concerned.

mod blank;
mod codes;
mod fits;
mod functions;
mod gears;
mod limits;
mod machine;
mod machine_files;
mod materials;
mod measures;
mod messages;
mod names;
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

pub use blank::Stock;
pub use codes::parse_code;
pub use functions::{CodeSystem, FunctionEntry, Functions, Group};
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

mod definitions {
    //! Made of `data/controls` by the build script.
    use crate::policy::*;
    use crate::{Definition, Limits};
    include!(concat!(env!("OUT_DIR"), "/controls.rs"));
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
    pub title: &'static str,
    /// One line about it, English and Chinese.
    pub summary: [&'static str; 2],
    /// Its answers to the questions on which controls differ.
    pub policies: Policies,
    /// Its limits.
    pub limits: Limits,
    /// Which alarm numbers it shows.
    pub alarm_ids: AlarmIds,
    /// Its parameters and their present values.
    pub parameters: Parameters,
    words_for_later: &'static [(&'static str, &'static str)],
}

/// A control as `data/controls` has it, with what its bases say.
struct Definition {
    name: &'static str,
    /// Its name and those of its bases, nearest first.
    lineage: &'static [&'static str],
    title: &'static str,
    summary: [&'static str; 2],
    parameter_map: &'static str,
    alarm_ids: AlarmIds,
    policies: Policies,
    limits: Limits,
    /// Its own values of parameters.
    parameters: &'static [(&'static str, f64)],
    words_for_later: &'static [(&'static str, &'static str)],
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

/// Names of all controls, sorted.
pub fn control_names() -> Vec<&'static str> {
    definitions::CONTROLS.iter().map(|definition| definition.name).collect()
}

impl Control {
    /// Loads a control by name (case and `_` for `-` do not matter).
    ///
    /// # Errors
    /// [`ControlFault::Unknown`] with the nearest name.
    pub fn load(name: &str) -> Result<Self, ControlFault> {
        let wanted = name.trim().to_ascii_lowercase().replace(['_', ' '], "-");
        let found = definitions::CONTROLS.iter().find(|definition| definition.name == wanted);
        let Some(definition) = found else {
            let nearest = nearest(name, control_names());
            return Err(ControlFault::Unknown { name: name.to_string(), nearest });
        };
        let &Definition {
            name, lineage, title, summary, policies, limits, alarm_ids, words_for_later, ..
        } = definition;
        let parameters = Parameters::load(definition.parameter_map, definition.parameters);
        Ok(Self {
            name,
            code_table: lineage.iter().find(|name| Functions.knows(name)).unwrap_or(&name),
            title,
            summary,
            policies,
            limits,
            words_for_later,
            alarm_ids,
            parameters: parameters.map_err(ControlFault::Data)?,
        })
    }
}

impl Control {
    /// Letters that a function takes on this control and that are not executed yet: they are refused by name.
    pub fn words_for_later(&self, function: &str) -> &str {
        let found = self.words_for_later.iter().find(|(name, _)| *name == function);
        found.map_or("", |(_, letters)| letters)
    }
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
    fn a_control_has_what_its_bases_say() {
        let (own, base) = (Control::load("fanuc-0i-tf"), Control::load("fanuc-0i-td"));
        let (own, base) = (own.expect("a control"), base.expect("a control"));
        assert_eq!(own.policies.arc_end_error, base.policies.arc_end_error);
        assert_ne!(own.policies.program_names, base.policies.program_names);
        assert_eq!((own.limits.program_digits, base.limits.program_digits), (8, 4));
        assert_eq!(own.limits.sequence_digits, base.limits.sequence_digits);
        // What is only a base of controls is none.
        assert!(matches!(Control::load("base"), Err(ControlFault::Unknown { .. })));
    }

    #[test]
    fn a_wrong_name_gets_the_nearest_one() {
        let fault = Control::load("fanuc-0i-tff").expect_err("no such control");
        assert!(matches!(fault, ControlFault::Unknown { nearest: Some("fanuc-0i-tf"), .. }), "{fault:?}");
    }
}
