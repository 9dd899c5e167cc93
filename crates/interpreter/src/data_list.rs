//! The lists that data setting opens and G11 closes: parameters and tool life.
//!
//! Parameters: `N_ R_`, for one axis `N_ P_ R_` (1 is X, 2 is Z, the others as the machine file numbers
//! them), for one bit `N_ Q_ R_` where the control has it.
//! R is whole and counts the parameter's own unit, least increments for lengths; a word of bits is written as
//! eight digits or as its number. The parameter acts from the next block on. Controls that read parameters too
//! write with W, and R names the variable that takes the value.
//!
//! Tool life: `P_ L_ Q_` opens a group with its life (Q1 a count, Q2 minutes), the `T_` blocks behind it are its
//! tools. The data is kept and changes nothing: no tool wears in one run.
//!
//! Any other word in a list is refused; a control that has nothing but lists passes over those of tool life, and over P
//! where the parameter is none of an axis. Source: data setting of both families; passwords are protected on the
//! newer ones.

use std::collections::BTreeMap;

use turnwright_control::policy::DataSetting;
use turnwright_control::{Axis, Parameter, ParameterFault};
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_syntax::{Block, Word};

use crate::functions::Dispatch;
use crate::machine::Core;
use crate::modal::Settings;
use crate::report::Alarm;
use crate::strokes::Strokes;

/// A list in work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DataList {
    /// Parameters as words.
    Parameters,
    /// Parameters as words, and single bits.
    ParametersAndBits,
    /// Parameters written by W and read into variables by R.
    ParametersAndVariables,
    /// Groups of tools.
    ToolLife {
        /// The group whose tools follow.
        group: Option<u32>,
        /// The groups named are deleted.
        deletes: bool,
    },
}

/// What was registered for tool life management.
#[derive(Clone, Debug, Default)]
pub(crate) struct ToolLife {
    groups: BTreeMap<u32, ToolGroup>,
}

/// A group of tools that replace each other.
#[derive(Clone, Debug, Default)]
struct ToolGroup {
    #[expect(dead_code, reason = "kept for the day that tool life acts")]
    life: u32,
    #[expect(dead_code, reason = "kept for the day that tool life acts")]
    is_in_minutes: bool,
    tools: Vec<u32>,
}

/// Parameters that hold passwords and the key to programs.
const PROTECTED: std::ops::RangeInclusive<u32> = 3220..=3223;

/// Highest tool group that any control has.
const GROUP_MAX: u32 = 256;

/// Most tools in a group.
const TOOLS_MAX: usize = 16;

/// Longest life: a count, or minutes.
const LIFE_MAX: u32 = 99_999_999;

impl Core {
    /// A block between the opening of a list and its end.
    #[cold]
    pub(crate) fn run_data_list(&mut self, block: &Block) -> Result<(), Alarm> {
        let Some(list) = self.data_list else { return Ok(()) };
        if let Some(word) = block.word(b'G') {
            let ends = self
                .dispatch
                .function(self.code(word)?)
                .is_some_and(|id| id.get().name == "data-setting-end");
            if ends && block.words.iter().all(|word| matches!(word.address, b'G' | b'N')) {
                self.data_list = None;
                return Ok(());
            }
        }
        match list {
            DataList::ToolLife { group, deletes } => self.tool_life_block(block, group, deletes),
            DataList::Parameters => self.parameter_block(block, b"NPR", b'R'),
            DataList::ParametersAndBits => self.parameter_block(block, b"NPQR", b'R'),
            DataList::ParametersAndVariables => {
                if let Some(word) = block.words.iter().find(|word| matches!(word.address, b'K' | b'D')) {
                    // Data of the machine's own logic.
                    return Err(self.not_supported("data-setting", word));
                }
                if block.has(b'W') {
                    self.parameter_block(block, b"NPW", b'W')
                } else {
                    self.parameter_into_variable(block)
                }
            }
        }
    }

    /// The words of a parameter block: its number and the axis, if one is named.
    fn parameter_words<'b>(
        &self,
        block: &'b Block,
        letters: &[u8],
    ) -> Result<(&'b Word, u32, Option<Axis>), Alarm> {
        if let Some(word) = block.words.iter().find(|word| word.comma || !letters.contains(&word.address)) {
            return Err(self.alarm("parameter-input-format", word));
        }
        let Some(name) = block.word(b'N') else { return Err(self.alarm_block("parameter-input-format")) };
        let number = self.whole(name, 99_999)?;
        let axis = match block.word(b'P') {
            Some(word) => {
                let axis = self.axes.machine.numbered(self.whole(word, 99)? as usize);
                let under = self.control.parameters.under_number(number);
                let has_axes = under.as_ref().is_some_and(|under| {
                    let whole = under.whole.iter().map(|(_, parameter)| parameter);
                    whole
                        .chain(under.bits.iter().map(|(_, parameter)| parameter))
                        .any(|one| one.is_per_axis())
                });
                if axis.is_none() && (has_axes || !self.passes_over_words()) {
                    return Err(self.alarm("parameter-input-format", word));
                }
                axis
            }
            None => None,
        };
        Ok((name, number, axis))
    }

    /// Words without a meaning in lists are passed over.
    fn passes_over_words(&self) -> bool {
        self.control.policies.data_setting == DataSetting::ListsOnly
    }

    /// Writes a parameter.
    fn parameter_block(&mut self, block: &Block, letters: &[u8], value_letter: u8) -> Result<(), Alarm> {
        let (name, number, axis) = self.parameter_words(block, letters)?;
        let Some(value) = block.word(value_letter) else {
            return Err(self.alarm_block("parameter-input-format"));
        };
        if PROTECTED.contains(&number) {
            return Err(self.alarm("parameter-write-protected", name));
        }
        let Some(under) = self.control.parameters.under_number(number) else {
            self.warn("parameter-not-known-here", name);
            return Ok(());
        };
        self.settings.store(&mut self.control.parameters);
        match (under.whole, block.word(b'Q')) {
            (Some((_, parameter)), None) => self.write_parameter(number, parameter, axis, value)?,
            (None, Some(bit)) => {
                let place = self.whole(bit, 7)? as u8;
                let state = self.whole(value, 1)?;
                match under.bits.iter().find(|(known, _)| *known == place) {
                    Some((_, parameter)) => {
                        self.write_bit(number, place, parameter, axis, state != 0, value)?
                    }
                    None => self.warn("parameter-not-known-here", name),
                }
            }
            (None, None) => {
                let word = self.bits(value)?;
                for (place, parameter) in under.bits {
                    self.write_bit(number, place, parameter, axis, word & (1 << place) != 0, value)?;
                }
            }
            (Some(_), Some(bit)) => return Err(self.alarm("parameter-input-format", bit)),
        }
        self.follow_parameters(under.whole.map_or("", |(key, _)| key), axis);
        Ok(())
    }

    /// A parameter that has its number to itself.
    fn write_parameter(
        &mut self,
        number: u32,
        parameter: &Parameter,
        axis: Option<Axis>,
        value: &Word,
    ) -> Result<(), Alarm> {
        let digits = self.whole_signed(value)?;
        let amount = if parameter.counts_increments() {
            // Exact: both factors are whole.
            (digits * self.settings.metric_increment.nm()) as f64 / 1e6
        } else {
            digits as f64
        };
        self.set_parameter(&number.to_string(), parameter, axis, &amount.to_string(), value)
    }

    fn write_bit(
        &mut self,
        number: u32,
        place: u8,
        parameter: &Parameter,
        axis: Option<Axis>,
        is_set: bool,
        value: &Word,
    ) -> Result<(), Alarm> {
        let state = if is_set { "1" } else { "0" };
        self.set_parameter(&format!("{number}#{place}"), parameter, axis, state, value)
    }

    fn set_parameter(
        &mut self,
        number: &str,
        parameter: &Parameter,
        axis: Option<Axis>,
        amount: &str,
        value: &Word,
    ) -> Result<(), Alarm> {
        let address = match (parameter.is_per_axis(), axis) {
            (true, Some(axis)) => format!("{number}.{}", axis.letter()),
            (false, None) => number.to_string(),
            (false, Some(_)) if self.passes_over_words() => number.to_string(),
            _ => return Err(self.alarm_block("parameter-input-format")),
        };
        self.control.parameters.set(&address, amount).map_err(|fault| match fault {
            ParameterFault::Value { .. } => self.alarm("data-out-of-range", value),
            _ => self.alarm_block("parameter-input-format"),
        })
    }

    /// From here on the run follows the parameters as they are now.
    fn follow_parameters(&mut self, key: &str, axis: Option<Axis>) {
        let always =
            self.control.policies.decimal_rule == turnwright_control::policy::DecimalRule::AlwaysCalculator;
        let turnwright_control::Control { parameters, policies, limits, .. } = &self.control;
        self.settings = Settings::new(parameters, policies, always, limits.number_digits);
        self.dispatch = Dispatch::new(&self.control);
        self.with_new_zero(|core| core.zeros.follow_parameter(&core.control, key, axis));
        // The area that the program gave with the switch stays until its own parameters are written.
        let second = self.strokes.second;
        self.strokes = Strokes::new(&self.control.parameters, &self.axes.machine);
        if !matches!(key, "stroke-two-plus" | "stroke-two-minus") {
            self.strokes.second = second;
        }
        self.look_at_moves();
    }

    /// A word of bits: eight digits of 0 and 1, else its number.
    fn bits(&self, word: &Word) -> Result<u8, Alarm> {
        let written = self.quote(word.start + 1, word.end);
        if written.len() == 8
            && let Ok(bits) = u8::from_str_radix(&written, 2)
        {
            return Ok(bits);
        }
        u8::try_from(self.whole(word, 99_999_999)?).map_err(|_| self.alarm("data-out-of-range", word))
    }

    /// A whole number with or without sign.
    fn whole_signed(&self, word: &Word) -> Result<i64, Alarm> {
        let number = self.number(word)?;
        if number.has_point {
            return Err(self.alarm("point-not-allowed", word));
        }
        if number.digits.abs() > 999_999_999 {
            return Err(self.alarm("data-out-of-range", word));
        }
        Ok(number.digits)
    }

    /// `N_ P_ R_`: the value of a parameter into the variable R.
    fn parameter_into_variable(&mut self, block: &Block) -> Result<(), Alarm> {
        let (name, number, axis) = self.parameter_words(block, b"NPR")?;
        let Some(variable) = block.word(b'R') else {
            return Err(self.alarm_block("parameter-input-format"));
        };
        let whole = self.control.parameters.under_number(number).and_then(|under| under.whole);
        let Some((key, parameter)) = whole else {
            // Of a word of bits only some are known.
            return Err(self.not_supported("data-setting", name));
        };
        let names_none = !parameter.is_per_axis() && self.passes_over_words();
        if parameter.is_per_axis() != axis.is_some() && !names_none {
            return Err(self.alarm_block("parameter-input-format"));
        }
        self.settings.store(&mut self.control.parameters);
        let value = self.control.parameters.axis_value(key, axis.unwrap_or(Axis::X));
        self.give_to_variable(variable, value)
    }

    /// Puts a value into the variable that a word names.
    fn give_to_variable(&mut self, variable: &Word, value: f64) -> Result<(), Alarm> {
        let number = f64::from(self.whole(variable, 99_999)?);
        let Some(slot) = self.macros.variables.slot(number) else {
            return Err(self.alarm("variable-number-illegal", variable));
        };
        if self.macros.is_protected(slot) {
            return Err(self.alarm("variable-write-protected", variable));
        }
        let value = self.macros.machine.arithmetic.stored(value);
        self.macros.variables.set(slot, value);
        Ok(())
    }

    /// Opens the list of tool groups: all groups are registered anew, P1 adds groups, P2 deletes some.
    pub(crate) fn open_tool_life(&mut self, block: &Block) -> Result<DataList, Alarm> {
        let how = match block.word(b'P') {
            Some(word) => match self.whole(word, 99)? {
                how @ (1 | 2) => how,
                _ => return Err(self.alarm("data-setting-format", word)),
            },
            None => {
                self.tool_life.groups.clear();
                0
            }
        };
        if !self.already_said("tool-life-does-not-act", 0) {
            let place = self.block_place();
            self.say(Diagnostic::new(Severity::Note, "tool-life-does-not-act").at(place));
        }
        Ok(DataList::ToolLife { group: None, deletes: how == 2 })
    }

    /// Words that are none of a list: passed over with a warning, or refused.
    fn foreign_words(&mut self, block: &Block, letters: &[u8]) -> Result<(), Alarm> {
        if !self.passes_over_words() {
            return self.refuse_other_words(block, letters);
        }
        let is_foreign = |word: &&Word| word.comma || !letters.contains(&word.address);
        if let Some(word) = block.words.iter().find(is_foreign).copied() {
            self.warn("word-passed-over-in-list", &word);
        }
        Ok(())
    }

    fn tool_life_block(&mut self, block: &Block, group: Option<u32>, deletes: bool) -> Result<(), Alarm> {
        let foreign = |core: &mut Self, letters| core.foreign_words(block, letters);
        if let Some(word) = block.word(b'P') {
            foreign(self, if deletes { b"NP" } else { b"NPLQ" })?;
            let number = self.whole(word, 9_999)?;
            if !(1..=GROUP_MAX).contains(&number) {
                return Err(self.alarm("data-out-of-range", word));
            }
            if deletes {
                self.tool_life.groups.remove(&number);
                return Ok(());
            }
            let Some(life) = block.word(b'L') else { return Err(self.alarm("data-setting-format", word)) };
            let is_in_minutes = match block.word(b'Q') {
                None => false,
                Some(word) => match self.whole(word, 9)? {
                    1 => false,
                    2 => true,
                    _ => return Err(self.alarm("data-out-of-range", word)),
                },
            };
            let life = self.whole(life, LIFE_MAX)?;
            self.tool_life.groups.insert(number, ToolGroup { life, is_in_minutes, tools: Vec::new() });
            self.data_list = Some(DataList::ToolLife { group: Some(number), deletes });
            return Ok(());
        }
        let Some(word) = block.word(b'T') else {
            return foreign(self, b"N");
        };
        foreign(self, b"NT")?;
        let tool = self.whole(word, 99_999_999)?;
        let tools =
            group.and_then(|group| self.tool_life.groups.get_mut(&group)).map(|group| &mut group.tools);
        match tools {
            Some(tools) if tools.len() < TOOLS_MAX => {
                tools.push(tool);
                Ok(())
            }
            _ => Err(self.alarm("data-setting-format", word)),
        }
    }
}
