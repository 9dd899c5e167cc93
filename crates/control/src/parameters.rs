//! Parameters: named by meaning, numbered by control.

use std::collections::BTreeSet;

use table::TABLE;

use crate::{Language, names, nearest};

mod table {
    //! Made of `data/parameters.toml` by the build script.
    use super::{Acts, Parameter, Texts};
    include!(concat!(env!("OUT_DIR"), "/parameters.rs"));
}

/// An axis of the machine, for values that each axis has its own of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Across the spindle axis.
    X,
    /// Along the spindle axis.
    Z,
    /// About the spindle axis; its values are degrees.
    C,
    /// Across X and Z.
    Y,
    /// About Y; its values are degrees.
    B,
}

impl Axis {
    /// All axes.
    pub const ALL: [Self; 5] = [Self::X, Self::Z, Self::C, Self::Y, Self::B];

    /// The axes that every lathe has.
    pub const TURNING: [Self; 2] = [Self::X, Self::Z];

    /// Those that only the machine file gives.
    pub const OTHERS: [Self; 3] = [Self::C, Self::Y, Self::B];

    /// Its letter.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::X => "X",
            Self::Z => "Z",
            Self::C => "C",
            Self::Y => "Y",
            Self::B => "B",
        }
    }
}

#[derive(Clone, Debug)]
struct Texts {
    name: &'static str,
    effect: &'static str,
}

/// Why a parameter changes no run here; the head of `data/parameters.toml` tells more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// Only the moving machine shows it.
    Live,
    /// The machine file says it.
    MachineFile,
    /// What it does exactly, no text at hand tells; whoever sets it is told so.
    Untold,
}

/// A parameter as `data/parameters.toml` has it.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Unit of its value: `bit`, `count`, `mm`, …
    pub unit: &'static str,
    /// By the name of a map, what controls with that map call it.
    numbers: &'static [(&'static str, &'static str)],
    default: f64,
    /// It has one value for each axis.
    per_axis: bool,
    acts: Option<Acts>,
    en: Texts,
    zh: Texts,
}

impl Parameter {
    /// Whether a value without a point counts least increments: lengths do, angles are whole degrees.
    pub fn counts_increments(&self) -> bool {
        self.unit == "mm"
    }

    /// Its name in a language.
    pub const fn name(&self, language: Language) -> &'static str {
        match language {
            Language::English => self.en.name,
            Language::Chinese => self.zh.name,
        }
    }

    /// Whether each axis has its own value.
    pub const fn is_per_axis(&self) -> bool {
        self.per_axis
    }

    /// When it acts, if it changes no run here today.
    pub const fn acts(&self) -> Option<Acts> {
        self.acts
    }

    /// What it changes, in a language.
    pub const fn effect(&self, language: Language) -> &'static str {
        match language {
            Language::English => self.en.effect,
            Language::Chinese => self.zh.effect,
        }
    }

    /// What controls with a map call it; a leading `!` marks a bit with the opposite sense.
    fn printed(&self, map: &str) -> Option<&'static str> {
        self.numbers.iter().find(|(known, _)| *known == map).map(|(_, number)| *number)
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
    /// The parameter has a value for each axis, and none was named.
    Axis {
        /// The number.
        number: String,
        /// How it is written for one axis.
        example: String,
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

impl ParameterFault {
    /// What would have been right.
    pub const fn expected(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "a number that exists",
            Self::Axis { .. } => "an axis",
            Self::Value { expected, .. } => expected,
        }
    }
}

/// What a control has under one number: a value, or some of the eight bits of a word.
#[derive(Clone, Debug, Default)]
pub struct UnderNumber {
    /// The parameter that has the number to itself, and its name.
    pub whole: Option<(&'static str, &'static Parameter)>,
    /// The bits that are known.
    pub bits: Vec<(u8, &'static Parameter)>,
}

/// The parameters of one control and their present values.
#[derive(Clone, Debug)]
pub struct Parameters {
    map: &'static str,
    /// In the order of the table; one that does not go by axes has its value in every place.
    values: Vec<[f64; Axis::ALL.len()]>,
    /// Names of those that were set, to whatever value.
    stated: BTreeSet<&'static str>,
    /// Of those with a value for each axis, the axes beyond X and Z that were set.
    stated_others: BTreeSet<(&'static str, Axis)>,
}

/// Where a parameter stands in the table.
fn place(name: &str) -> Option<usize> {
    names::place(table::TABLE_SLOTS, TABLE, name)
}

impl Parameters {
    /// The defaults of a parameter map, with a control's own values over them.
    pub(crate) fn load(map: &'static str, own: &[(&str, f64)]) -> Result<Self, String> {
        let mut values: Vec<_> =
            TABLE.iter().map(|(_, parameter)| [parameter.default; Axis::ALL.len()]).collect();
        for (name, value) in own {
            match place(name) {
                Some(place) => values[place].fill(*value),
                None => return Err(format!("parameter {name} is unknown")),
            }
        }
        Ok(Self { map, values, stated: BTreeSet::new(), stated_others: BTreeSet::new() })
    }

    /// The value of a parameter by name; bits are 0 and 1.
    pub fn value(&self, name: &str) -> f64 {
        self.axis_value(name, Axis::ALL[0])
    }

    /// The value that a parameter by name has for an axis.
    pub fn axis_value(&self, name: &str, axis: Axis) -> f64 {
        let place = place(name);
        debug_assert!(place.is_some(), "no parameter {name} in data/parameters.toml");
        place.map_or(0.0, |place| self.values[place][axis as usize])
    }

    /// A bit by name.
    pub fn bit(&self, name: &str) -> bool {
        self.value(name) != 0.0
    }

    /// Whether somebody set it, to whatever value.
    pub fn is_stated(&self, name: &str) -> bool {
        self.stated.contains(name)
    }

    /// The numbers of parameters that were set away from their defaults although nobody knows what they do
    /// ([`Acts::Untold`]).
    pub fn stated_untold(&self) -> impl Iterator<Item = &'static str> {
        let untold = TABLE.iter().zip(&self.values).filter(|((name, parameter), values)| {
            parameter.acts == Some(Acts::Untold)
                && self.stated.contains(name)
                && values.iter().any(|value| *value != parameter.default)
        });
        untold.filter_map(|((name, _), _)| self.number(name))
    }

    /// The number by which a parameter was set for an axis, if one was: `1221.C`.
    pub fn stated_for(&self, axis: Axis) -> Option<String> {
        let (name, _) = self.stated_others.iter().find(|(_, stated)| *stated == axis)?;
        Some(format!("{}.{}", self.number(name)?, axis.letter()))
    }

    /// Sets a parameter by the number that the control gives it: `3401#0`, `5130`, `051`. Behind the number of a
    /// parameter that each axis has its own of stands the axis: `1221.X`, `1310#0.Z`.
    ///
    /// # Errors
    /// An unknown number (with the nearest), an axis missing, or a value of the wrong kind.
    pub fn set(&mut self, number: &str, value: &str) -> Result<(), ParameterFault> {
        let number = number.trim();
        let Some((name, parameter, axis)) = self.look_up(number) else {
            let known = TABLE.iter().filter(|(_, one)| one.printed(self.map).is_some());
            let numbers: Vec<String> =
                known.flat_map(|(name, one)| self.addresses(name, one)).map(|(n, _)| n).collect();
            let nearest = nearest(number, numbers.iter().map(String::as_str)).map(str::to_string);
            return Err(ParameterFault::Unknown { number: number.to_string(), nearest });
        };
        if parameter.per_axis && axis.is_none() {
            let example = format!("{number}.{}", Axis::ALL[0].letter());
            return Err(ParameterFault::Axis { number: number.to_string(), example });
        }
        let printed = parameter.printed(self.map).unwrap_or_default();
        let fault = |expected| ParameterFault::Value {
            number: number.to_string(),
            value: value.to_string(),
            expected,
        };
        let parsed: f64 = value.trim().parse().map_err(|_| fault("a number"))?;
        let parsed = match parameter.unit {
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
            "signed count" if parsed.fract() != 0.0 => return Err(fault("a whole number")),
            _ if parsed.is_finite() && parsed.abs() < 1e9 => parsed,
            _ => return Err(fault("a number in range")),
        };
        self.stated.insert(name);
        if let Some(axis) = axis.filter(|axis| Axis::OTHERS.contains(axis)) {
            self.stated_others.insert((name, axis));
        }
        if let Some(place) = place(name) {
            match axis {
                Some(axis) => self.values[place][axis as usize] = parsed,
                None => self.values[place].fill(parsed),
            }
        }
        Ok(())
    }

    /// What this control has under a number without bit and axis; `None` when nothing is known of it here.
    pub fn under_number(&self, number: u32) -> Option<UnderNumber> {
        let mut found = UnderNumber::default();
        for (name, parameter) in TABLE {
            let Some(printed) = parameter.printed(self.map) else { continue };
            let (word, bit) = printed.trim_start_matches('!').split_once('#').unwrap_or((printed, ""));
            if word.parse() != Ok(number) {
                continue;
            }
            match bit.parse() {
                Ok(bit) => found.bits.push((bit, parameter)),
                Err(_) => found.whole = Some((name, parameter)),
            }
        }
        (found.whole.is_some() || !found.bits.is_empty()).then_some(found)
    }

    /// The parameter that a number of this control names, and the axis when the number names one too.
    fn look_up(&self, number: &str) -> Option<(&'static str, &'static Parameter, Option<Axis>)> {
        let of_number = |number: &str| {
            let wanted = normal(number);
            TABLE.iter().find(|(_, parameter)| {
                let printed = parameter.printed(self.map);
                printed.is_some_and(|printed| normal(printed.trim_start_matches('!')) == wanted)
            })
        };
        let axis =
            |letter: &str| Axis::ALL.into_iter().find(|axis| letter.eq_ignore_ascii_case(axis.letter()));
        if let Some((number, letter)) = number.rsplit_once('.')
            && let Some(axis) = axis(letter)
        {
            let (name, parameter) = of_number(number)?;
            return parameter.per_axis.then_some((name, parameter, Some(axis)));
        }
        of_number(number).map(|(name, parameter)| (*name, parameter, None))
    }

    /// The numbers by which a parameter of this control is set, and the place of each value.
    fn addresses(&self, name: &'static str, parameter: &Parameter) -> Vec<(String, Axis)> {
        let Some(number) = parameter.printed(self.map) else { return Vec::new() };
        let number = number.trim_start_matches('!');
        if parameter.per_axis {
            // Of axes that few machines have, what somebody set.
            let is_set = |axis| Axis::TURNING.contains(&axis) || self.stated_others.contains(&(name, axis));
            let axes = Axis::ALL.into_iter().filter(|axis| is_set(*axis));
            axes.map(|axis| (format!("{number}.{}", axis.letter()), axis)).collect()
        } else {
            vec![(number.to_string(), Axis::ALL[0])]
        }
    }

    /// The number that the control gives a parameter, without the mark of an inverted bit.
    pub fn number(&self, name: &str) -> Option<&'static str> {
        Some(TABLE[place(name)?].1.printed(self.map)?.trim_start_matches('!'))
    }

    /// The value as the control's own screen has it: some bits have the opposite sense there.
    fn shown_value(&self, name: &str, parameter: &Parameter, axis: Axis) -> f64 {
        let value = self.axis_value(name, axis);
        let is_inverted = parameter.printed(self.map).is_some_and(|number| number.starts_with('!'));
        if is_inverted { 1.0 - value } else { value }
    }

    /// Sets a parameter by name, in the sense of its name: what data blocks of cycles do.
    pub fn set_by_name(&mut self, name: &str, value: f64) {
        let place = place(name);
        debug_assert!(place.is_some(), "no parameter {name} in data/parameters.toml");
        if let Some(place) = place {
            self.values[place].fill(value);
        }
    }

    /// The parameter with a number of this control, with its name; the value of the axis that the number names,
    /// else of the first.
    pub fn find(&self, number: &str) -> Option<(&'static str, &'static Parameter, f64)> {
        let (name, parameter, axis) = self.look_up(number)?;
        let value = self.shown_value(name, parameter, axis.unwrap_or(Axis::ALL[0]));
        Some((name, parameter, value))
    }

    /// Every parameter of this control: number, name, table entry, value; for each axis where they differ by axis.
    pub fn all(&self) -> Vec<(String, &'static str, &'static Parameter, f64)> {
        let mut all: Vec<_> = TABLE
            .iter()
            .flat_map(|(name, parameter)| {
                self.addresses(name, parameter).into_iter().map(move |(number, axis)| {
                    let value = self.shown_value(name, parameter, axis);
                    (number, *name, parameter, value)
                })
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
    fn every_name_is_found_and_no_other() {
        for (at, (name, _)) in TABLE.iter().enumerate() {
            assert_eq!(place(name), Some(at), "{name}");
            for other in [format!("{name}-"), format!("-{name}"), name[1..].to_string(), name.to_uppercase()]
            {
                let known = TABLE.iter().position(|(name, _)| *name == other);
                assert_eq!(place(&other), known, "{other}");
            }
        }
        assert_eq!(place(""), None);
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

    #[test]
    fn a_parameter_of_each_axis_is_set_by_number_and_axis() {
        let mut parameters = Control::load("fanuc-0i-tf").expect("control").parameters;
        parameters.set("1221.z", "-12.5").expect("known");
        assert_eq!(parameters.axis_value("work-zero-1", Axis::Z), -12.5);
        assert_eq!(parameters.axis_value("work-zero-1", Axis::X), 0.0);
        let fault = parameters.set("1221", "1").expect_err("no axis");
        assert_eq!(fault, ParameterFault::Axis { number: "1221".to_string(), example: "1221.X".to_string() });
        parameters.set("1221.C", "90").expect("known");
        assert_eq!(parameters.axis_value("work-zero-1", Axis::C), 90.0);
        assert_eq!(parameters.stated_for(Axis::C).as_deref(), Some("1221.C"));
        assert_eq!(parameters.stated_for(Axis::Y), None);
        let shown =
            parameters.all().into_iter().map(|(number, ..)| number).filter(|n| n.starts_with("1221."));
        assert_eq!(shown.collect::<Vec<_>>(), ["1221.C", "1221.X", "1221.Z"]);
        assert!(matches!(parameters.set("1221.Q", "1"), Err(ParameterFault::Unknown { .. })));
        assert!(matches!(parameters.set("3410.X", "1"), Err(ParameterFault::Unknown { .. })));
    }
}
