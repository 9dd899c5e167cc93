//! Custom macro: variables, expressions, statements, calls, system variables, output.
//!
//! In: the text of macro statements and of words with expressions. Out: numbers for words, jumps, calls. What a
//! block does with its words is not known here. An expression is compiled once and runs without allocating; no
//! value that is not finite leaves it.

mod arguments;
mod arithmetic;
mod calls;
mod code;
mod names;
mod output;
mod quick;
mod statement;
mod stored;
mod system;
mod type_a;
mod variables;

pub(crate) use arguments::Passed;
use arithmetic::{ArcSine, Rules};
pub(crate) use calls::{CallKind, CodeCalls, ModalCall, Program};
pub(crate) use code::Code;
use code::{Machine, Pause};
pub(crate) use quick::Quick;
pub(crate) use statement::Statement;
use turnwright_control::policy::{
    ArcSineRange, BareArgument, JoinedConditions, MacroFunctions, MacroNames, MacroPrecision, NullVariable,
};
use turnwright_control::{Control, Parameters};
use turnwright_syntax::{Block, Decimal, Value, Word, parse_expression};
pub(crate) use variables::{Locals, Variables, is_null, number};

use crate::Environment;
use crate::machine::{Core, Halt};
use crate::report::Alarm;

/// Largest magnitude of a value on controls that keep eight digits.
const MAGNITUDE_MAX_OLD: f64 = 1e47;
/// Largest magnitude elsewhere.
const MAGNITUDE_MAX: f64 = 1e308;

/// Everything that custom macro holds from block to block.
#[derive(Debug)]
pub(crate) struct Macros {
    pub(crate) machine: Machine,
    pub(crate) variables: Variables,
    /// Modal calls in force, outermost first.
    pub(crate) modal_calls: Vec<ModalCall>,
    pub(crate) calls: CodeCalls,
    /// First and last slot that programs may not write.
    protected: Option<(u16, u16)>,
    /// Program that an interrupt calls, while it is allowed.
    pub(crate) interrupt: Option<u32>,
    /// The M codes that allow and forbid interrupts.
    pub(crate) interrupt_codes: (u32, u32),
    pub(crate) state: system::State,
    output_is_open: bool,
    /// Codes of the words of a block that is not kept.
    codes: Vec<Code>,
    /// Values of the computed words of the block in work, by the first byte of the word.
    pub(crate) word_values: Vec<(u32, f64)>,
}

impl Macros {
    pub(crate) fn new(control: &Control) -> Self {
        let (policies, limits, parameters) = (&control.policies, &control.limits, &control.parameters);
        let signed = parameters.bit("arc-tangent-signed");
        let old = policies.macro_precision == MacroPrecision::EightDigits;
        let small = old || parameters.bit("macro-values-to-1e47");
        let rules = Rules {
            magnitude_max: if small { MAGNITUDE_MAX_OLD } else { MAGNITUDE_MAX },
            keeps_eight_digits: old,
            null_equals_zero: policies.null_variable == NullVariable::IsZero,
            arc_tangent_is_signed: signed,
            arc_sine: match (policies.arc_sine_range, signed) {
                (ArcSineRange::WithArcTangent, false) => ArcSine::Unsigned,
                (ArcSineRange::WithArcTangent, true) | (ArcSineRange::Opposite, false) => ArcSine::Principal,
                (ArcSineRange::Opposite, true) => ArcSine::Obtuse,
            },
            has_newer_functions: policies.macro_functions != MacroFunctions::Basic,
            has_random: policies.macro_functions == MacroFunctions::ExtendedWithRandom,
            has_names: policies.macro_names == MacroNames::Known,
            joins_conditions: policies.joined_conditions == JoinedConditions::Taken,
            takes_bare_arguments: policies.bare_argument == BareArgument::Taken,
            bracket_depth_max: limits.bracket_depth_max,
        };
        let variables = Variables::new(limits.common_variable_last, limits.retained_variable_last);
        let protected = protected_slots(parameters, &variables);
        Self {
            machine: Machine::new(rules),
            variables,
            modal_calls: Vec::new(),
            calls: CodeCalls::new(control),
            protected,
            interrupt: None,
            interrupt_codes: (
                parameters.value("interrupt-on-code") as u32,
                parameters.value("interrupt-off-code") as u32,
            ),
            state: system::State::default(),
            output_is_open: false,
            codes: Vec::new(),
            word_values: Vec::new(),
        }
    }

    /// Calls and interrupts are cancelled; variables are forgotten unless a parameter keeps them.
    pub(crate) fn reset(&mut self, parameters: &Parameters) {
        self.modal_calls.clear();
        self.interrupt = None;
        self.output_is_open = false;
        (self.state.single_block, self.state.hold) = (0, 0);
        let keeps = |name| parameters.bit(name);
        self.variables.reset(!keeps("reset-keeps-local-variables"), !keeps("reset-keeps-common-variables"));
    }

    /// Whether a parameter keeps programs from writing a variable.
    pub(crate) fn is_protected(&self, slot: u16) -> bool {
        self.protected.is_some_and(|(first, last)| (first..=last).contains(&slot))
    }
}

fn protected_slots(parameters: &Parameters, variables: &Variables) -> Option<(u16, u16)> {
    let first = parameters.value("protected-variables-first");
    let last = parameters.value("protected-variables-last");
    if first < 1.0 || last < first {
        return None;
    }
    // Of a range that goes beyond the variables that exist, those that do.
    let slots = (first as u32..=last as u32).filter_map(|number| variables.slot(f64::from(number)));
    slots.fold(None, |range, slot| Some(range.map_or((slot, slot), |(first, _)| (first, slot))))
}

impl Core {
    /// Runs the compiled code of a statement.
    #[inline]
    pub(crate) fn evaluate(&mut self, code: Code, environment: &mut dyn Environment) -> Result<f64, Halt> {
        match self.macros.machine.at_once(code, &self.macros.variables) {
            Some(value) => Ok(value),
            None => self.evaluate_long(code, environment),
        }
    }

    fn evaluate_long(&mut self, code: Code, environment: &mut dyn Environment) -> Result<f64, Halt> {
        self.evaluate_all(code, None, environment)
    }

    /// Runs compiled code; in a word, `ROUND` rounds to what its address counts in.
    #[inline(always)]
    fn evaluate_all(
        &mut self,
        code: Code,
        address: Option<u8>,
        environment: &mut dyn Environment,
    ) -> Result<f64, Halt> {
        match self.macros.machine.start(code, &self.macros.variables) {
            Some(value) => Ok(value),
            None => self.evaluate_rest(address, environment),
        }
    }

    /// Gives code what it asks for until it has a value.
    fn evaluate_rest(&mut self, address: Option<u8>, environment: &mut dyn Environment) -> Result<f64, Halt> {
        loop {
            let value = match self.macros.machine.why() {
                Pause::Read(variable) => self.read_variable(variable, environment)?,
                Pause::Round(value) => {
                    let increment = address.map_or(1.0, |address| self.word_increment(address));
                    (value / increment).round() * increment
                }
                Pause::AddPoint(slot) => self.with_point(slot),
                Pause::Parameter(number, bit, axis) => self.parameter_value(number, bit, axis)?,
                Pause::AxisNumber(letter) => self.axis_number(letter)?,
                Pause::Fault(fault) => {
                    let place = self.macros.machine.fault_place();
                    return Err(self.code_fault(fault, place).into());
                }
            };
            if let Some(value) = self.macros.machine.resume(value, &self.macros.variables) {
                return Ok(value);
            }
        }
    }

    /// Gives the words of the block in work that are expressions their numbers. Words whose variable holds
    /// nothing are taken out, or are zero: the control decides.
    #[cold]
    pub(crate) fn compute_words(
        &mut self,
        block: &mut Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        let mark = self.macros.machine.mark();
        let mut codes = std::mem::take(&mut self.macros.codes);
        let named = match block.faults.is_empty() {
            true => Ok(()),
            false => self.name_axes(block, environment),
        };
        let result = match named.and_then(|()| Ok(self.compile_words(block, &mut codes)?)) {
            Ok(()) => {
                let computed = (0..codes.len()).filter(|place| codes[*place].computes());
                block.resolve(computed, |word, place| self.word_value(word, codes[place], true, environment))
            }
            Err(halt) => Err(halt),
        };
        self.macros.codes = codes;
        self.macros.machine.forget(mark);
        result
    }

    /// Compiles the words of a block that are expressions; one code for every word.
    pub(crate) fn compile_words(&mut self, block: &Block, codes: &mut Vec<Code>) -> Result<(), Alarm> {
        codes.clear();
        self.macros.word_values.clear();
        for word in &block.words {
            let Value::Expression { start, end } = word.value else {
                codes.push(Code::NONE);
                continue;
            };
            if matches!(word.address, b'N' | b'O') {
                return Err(self.alarm("macro-expression-format", word));
            }
            let expression = match parse_expression(self.line_bytes(), start..end) {
                Ok(expression) => expression,
                Err(_) if word.address == b'P' && self.name_in_brackets(start, end).is_some() => {
                    codes.push(Code::NAME);
                    continue;
                }
                Err(fault) => return Err(self.expression_fault(&fault, start..end)),
            };
            let code = self.macros.machine.compile(&expression, &self.macros.variables, true);
            codes.push(code.map_err(|(fault, place)| self.code_fault(fault, place))?);
        }
        Ok(())
    }

    /// The number of a word whose value is an expression; `None` takes the word out of the block. The value itself
    /// is kept when a call may pass it on.
    #[inline(always)]
    pub(crate) fn word_value(
        &mut self,
        word: &Word,
        code: Code,
        may_be_passed: bool,
        environment: &mut dyn Environment,
    ) -> Result<Option<Decimal>, Halt> {
        let value = match self.macros.machine.at_once(code, &self.macros.variables) {
            Some(value) => value,
            None => self.evaluate_all(code, Some(word.address), environment)?,
        };
        if is_null(value) && self.control.policies.null_variable == NullVariable::IsNothing {
            return Ok(None);
        }
        if may_be_passed {
            self.macros.word_values.push((word.start, value));
        }
        match Decimal::computed(number(value)) {
            Some(decimal) => Ok(Some(decimal)),
            None => Err(self.alarm("number-too-long", word).into()),
        }
    }

    /// What `ROUND` rounds to in a word: the least increment of lengths, else whole numbers.
    fn word_increment(&self, address: u8) -> f64 {
        match address {
            b'G' | b'H' | b'L' | b'M' | b'D' | b'P' | b'S' | b'T' => 1.0,
            _ if self.modal.is_inch => self.settings.inch_increment.to_inches(),
            _ => self.settings.metric_increment.to_mm(),
        }
    }
}
