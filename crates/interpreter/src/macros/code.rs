//! Expressions as flat code, compiled once and run without allocating.
//!
//! In: the tree of an expression. Out: operations for one accumulator and a small stack. Variables with a fixed
//! number become slots when they are compiled; everything else that `#` may name is asked of the caller, who
//! knows the control's state ([`Outcome::Read`]).
//!
//! Source: arithmetic and logic operations of custom macro, both families.

use std::ops::Range;

use turnwright_syntax::{BinaryOperator, Comparison, Expression, Function, Node};

use super::variables::{NULL, Variables, is_null, number};

/// Most intermediate results that one expression holds; the bracket limit of every control stays below.
const STACK_MAX: usize = 24;

/// One operation.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Op {
    /// A constant, or null.
    Constant(f64),
    /// A variable as it is, null included.
    Raw(u16),
    /// A variable as a number.
    Number(u16),
    Push,
    Negate,
    /// The sign of a word.
    NegateUnlessNull,
    AddConstant(f64),
    AddSlot(u16),
    SubtractConstant(f64),
    SubtractSlot(u16),
    MultiplyConstant(f64),
    MultiplySlot(u16),
    DivideConstant(f64),
    DivideSlot(u16),
    CompareConstant(Comparison, f64),
    CompareSlot(Comparison, u16),
    /// What was pushed last, and the accumulator.
    Binary(BinaryOperator),
    Call(Function),
    /// What was pushed last is the first argument.
    CallTwo(Function),
    /// The variable whose number is the accumulator.
    Read,
    /// Null becomes zero.
    AsNumber,
    /// `ROUND` in a word: to the least increment of its address.
    RoundToIncrement,
}

/// Code of one expression in [`Machine::code`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Code {
    start: u32,
    end: u32,
}

impl Code {
    /// What stands there is no expression but a name.
    pub(crate) const NAME: Self = Self { start: u32::MAX, end: u32::MAX };
}

/// What running a piece of code came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// The value; null stays null.
    Value(f64),
    /// The caller must say what the variable of this number holds, and go on with [`Machine::resume`].
    Read(f64),
    /// It has no value.
    Fault(CodeFault),
}

/// Why an expression has no value, or may not be written here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CodeFault {
    DivideByZero,
    /// The argument lies outside the range of the function.
    Argument,
    /// A whole number does not fit 32 bits.
    IntegerOverflow,
    /// The value is larger than the control holds.
    Overflow,
    /// Brackets nest too deep.
    Brackets,
    /// The control does not have this function.
    NoFunction,
    /// The function takes its arguments otherwise.
    Arguments,
    /// The function's argument stands without brackets.
    BareArgument,
    /// The number of a loop is not 1, 2 or 3.
    LoopNumber,
}

/// How this control computes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    /// Largest magnitude of a value.
    pub(crate) magnitude_max: f64,
    /// Values are kept to eight significant digits.
    pub(crate) keeps_eight_digits: bool,
    /// A null variable equals zero in `EQ` and `NE`.
    pub(crate) null_equals_zero: bool,
    /// `ATAN` gives -180 to 180 degrees instead of 0 to 360.
    pub(crate) arc_tangent_is_signed: bool,
    pub(crate) arc_sine: ArcSine,
    /// `MOD`, `POW`, `ADP`, `ATAN` of one argument.
    pub(crate) has_newer_functions: bool,
    pub(crate) has_random: bool,
    pub(crate) takes_bare_arguments: bool,
    pub(crate) bracket_depth_max: u8,
}

/// The range of `ASIN`, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArcSine {
    /// -90 to 90.
    Principal,
    /// 270 to 360 for the negative ones, then 0 to 90.
    Unsigned,
    /// 90 to 270.
    Obtuse,
}

/// The code of all expressions that are kept, and the state of the one that runs.
#[derive(Debug)]
pub(crate) struct Machine {
    pub(crate) rules: Rules,
    code: Vec<Op>,
    /// Place of each operation in its line.
    places: Vec<(u32, u32)>,
    stack: [f64; STACK_MAX],
    depth: usize,
    at: usize,
    end: usize,
    /// The increment that `ROUND` in a word rounds to.
    increment: f64,
    random: u64,
}

impl Machine {
    pub(crate) fn new(rules: Rules) -> Self {
        Self {
            rules,
            code: Vec::new(),
            places: Vec::new(),
            stack: [0.0; STACK_MAX],
            depth: 0,
            at: 0,
            end: 0,
            increment: 1.0,
            random: 0x2545_f491_4f6c_dd1d,
        }
    }

    /// How much code is kept; for [`Machine::forget`].
    pub(crate) fn mark(&self) -> usize {
        self.code.len()
    }

    /// Lets go of everything compiled since a mark.
    pub(crate) fn forget(&mut self, mark: usize) {
        self.code.truncate(mark);
        self.places.truncate(mark);
    }

    /// The place of the operation that ran last.
    pub(crate) fn fault_place(&self) -> Range<u32> {
        let (start, end) = self.places.get(self.at.wrapping_sub(1)).copied().unwrap_or_default();
        start..end
    }

    /// Compiles an expression; `in_word` when it is the value of an address.
    pub(crate) fn compile(
        &mut self,
        expression: &Expression,
        variables: &Variables,
        in_word: bool,
    ) -> Result<Code, (CodeFault, Range<u32>)> {
        let start = self.code.len();
        let whole = expression.node(expression.root()).map_or(0..0, |(_, place)| place);
        if let Some(place) = expression.bare_argument()
            && !self.rules.takes_bare_arguments
        {
            return Err((CodeFault::BareArgument, place));
        }
        if expression.bracket_depth() > self.rules.bracket_depth_max {
            return Err((CodeFault::Brackets, whole));
        }
        let compiler = Compiler { expression, variables, in_word };
        compiler.node(self, expression.root(), 0)?;
        Ok(Code { start: start as u32, end: self.code.len() as u32 })
    }

    fn emit(&mut self, op: Op, place: &Range<u32>) {
        self.code.push(op);
        self.places.push((place.start, place.end));
    }

    /// Runs code from its start.
    #[inline]
    pub(crate) fn start(&mut self, code: Code, increment: f64, variables: &Variables) -> Outcome {
        self.at = code.start as usize;
        self.end = code.end as usize;
        self.depth = 0;
        self.increment = increment;
        self.run(NULL, variables)
    }

    /// Goes on with the value of the variable that was asked for.
    pub(crate) fn resume(&mut self, value: f64, variables: &Variables) -> Outcome {
        self.run(value, variables)
    }

    #[inline]
    fn run(&mut self, mut value: f64, variables: &Variables) -> Outcome {
        let slots = variables.slots();
        let limit = self.rules.magnitude_max;
        let slot = |place: u16| number(slots[usize::from(place)]);
        let mut at = self.at;
        let end = self.end;
        let fault = loop {
            if at >= end {
                self.at = at;
                return Outcome::Value(value);
            }
            let op = self.code[at];
            at += 1;
            match op {
                Op::Constant(constant) => value = constant,
                Op::Raw(place) => value = slots[usize::from(place)],
                Op::Number(place) => value = slot(place),
                Op::Push => {
                    self.stack[self.depth] = value;
                    self.depth += 1;
                }
                Op::Negate => value = -number(value),
                Op::NegateUnlessNull if is_null(value) => {}
                Op::NegateUnlessNull => value = -value,
                Op::AddConstant(constant) => value += constant,
                Op::AddSlot(place) => value += slot(place),
                Op::SubtractConstant(constant) => value -= constant,
                Op::SubtractSlot(place) => value -= slot(place),
                Op::MultiplyConstant(constant) => value *= constant,
                Op::MultiplySlot(place) => value *= slot(place),
                Op::DivideConstant(divisor) => match divide(value, divisor) {
                    Ok(quotient) => value = quotient,
                    Err(fault) => break fault,
                },
                Op::DivideSlot(place) => match divide(value, slot(place)) {
                    Ok(quotient) => value = quotient,
                    Err(fault) => break fault,
                },
                Op::CompareConstant(comparison, constant) => {
                    value = self.compare(comparison, value, constant);
                    continue;
                }
                Op::CompareSlot(comparison, place) => {
                    value = self.compare(comparison, value, slots[usize::from(place)]);
                    continue;
                }
                Op::Binary(operator) => {
                    self.depth -= 1;
                    match self.binary(operator, self.stack[self.depth], value) {
                        Ok(result) => value = result,
                        Err(fault) => break fault,
                    }
                }
                Op::Call(function) => match self.call(function, number(value)) {
                    Ok(result) => value = result,
                    Err(fault) => break fault,
                },
                Op::CallTwo(function) => {
                    self.depth -= 1;
                    match self.call_two(function, self.stack[self.depth], number(value)) {
                        Ok(result) => value = result,
                        Err(fault) => break fault,
                    }
                }
                Op::Read => {
                    self.at = at;
                    return Outcome::Read(number(value));
                }
                Op::AsNumber => value = number(value),
                Op::RoundToIncrement => value = round(number(value) / self.increment) * self.increment,
            }
            // Null is no number and passes; whatever else is not within the limit has overflown.
            if !within(value, limit) && !is_null(value) {
                break CodeFault::Overflow;
            }
        };
        self.at = at;
        Outcome::Fault(fault)
    }

    #[inline]
    fn compare(&self, comparison: Comparison, left: f64, right: f64) -> f64 {
        let same = || {
            if self.rules.null_equals_zero || is_null(left) == is_null(right) {
                number(left) == number(right)
            } else {
                false
            }
        };
        let holds = match comparison {
            Comparison::Equal => same(),
            Comparison::NotEqual => !same(),
            Comparison::Greater => number(left) > number(right),
            Comparison::Less => number(left) < number(right),
            Comparison::GreaterOrEqual => number(left) >= number(right),
            Comparison::LessOrEqual => number(left) <= number(right),
        };
        f64::from(u8::from(holds))
    }

    pub(super) fn binary(&self, operator: BinaryOperator, left: f64, right: f64) -> Result<f64, CodeFault> {
        if let BinaryOperator::Compare(comparison) = operator {
            return Ok(self.compare(comparison, left, right));
        }
        let (left, right) = (number(left), number(right));
        Ok(match operator {
            BinaryOperator::Add => left + right,
            BinaryOperator::Subtract => left - right,
            BinaryOperator::Multiply => left * right,
            BinaryOperator::Divide => divide(left, right)?,
            BinaryOperator::Modulo => left - divide(left, right)?.trunc() * right,
            BinaryOperator::And => f64::from(whole(left)? & whole(right)?),
            BinaryOperator::Or => f64::from(whole(left)? | whole(right)?),
            BinaryOperator::ExclusiveOr => f64::from(whole(left)? ^ whole(right)?),
            BinaryOperator::Compare(_) => unreachable!("done above"),
        })
    }

    pub(super) fn call(&mut self, function: Function, value: f64) -> Result<f64, CodeFault> {
        Ok(match function {
            Function::Sin => sine(value),
            Function::Cos => sine(value + 90.0),
            Function::Tan => divide(sine(value), sine(value + 90.0))?,
            Function::ArcSin => self.arc_sine(value)?,
            Function::ArcCos if value.abs() <= 1.0 => value.acos().to_degrees(),
            Function::ArcTan => value.atan().to_degrees(),
            Function::SquareRoot if value >= 0.0 => value.sqrt(),
            Function::Absolute => value.abs(),
            Function::Logarithm if value > 0.0 => value.ln(),
            Function::Exponential => value.exp(),
            Function::Round => round(value),
            Function::RoundDown => value.trunc(),
            Function::RoundUp => {
                if value < 0.0 {
                    value.floor()
                } else {
                    value.ceil()
                }
            }
            Function::ToBinary => to_binary(value)?,
            Function::ToDecimal => to_decimal(value)?,
            // A number in an expression has its point already.
            Function::AddPoint => value,
            Function::Random => self.random_up_to(value),
            _ => return Err(CodeFault::Argument),
        })
    }

    pub(super) fn call_two(&mut self, function: Function, first: f64, second: f64) -> Result<f64, CodeFault> {
        let first = number(first);
        Ok(match function {
            Function::ArcTan => {
                if first == 0.0 && second == 0.0 {
                    return Err(CodeFault::Argument);
                }
                let angle = first.atan2(second).to_degrees();
                if angle < 0.0 && !self.rules.arc_tangent_is_signed { angle + 360.0 } else { angle }
            }
            Function::Power => {
                if first == 0.0 && second < 0.0 {
                    return Err(CodeFault::DivideByZero);
                }
                let power = first.powf(second);
                if power.is_nan() {
                    return Err(CodeFault::Argument);
                }
                power
            }
            Function::RandomBetween => first + self.random_up_to(second - first),
            _ => return Err(CodeFault::Arguments),
        })
    }

    fn arc_sine(&self, value: f64) -> Result<f64, CodeFault> {
        if value.abs() > 1.0 {
            return Err(CodeFault::Argument);
        }
        let angle = value.asin().to_degrees();
        Ok(match self.rules.arc_sine {
            ArcSine::Principal => angle,
            ArcSine::Unsigned if angle < 0.0 => angle + 360.0,
            ArcSine::Unsigned => angle,
            ArcSine::Obtuse => 180.0 - angle,
        })
    }

    /// The same numbers in every run: a program must do the same thing twice.
    fn random_up_to(&mut self, limit: f64) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1u64 << 53) as f64 * limit
    }

    /// A value as the control stores it.
    #[inline]
    pub(crate) fn stored(&self, value: f64) -> f64 {
        if self.rules.keeps_eight_digits && !is_null(value) { eight_digits(value) } else { value }
    }
}

struct Compiler<'a> {
    expression: &'a Expression,
    variables: &'a Variables,
    in_word: bool,
}

type Compiled = Result<(), (CodeFault, Range<u32>)>;

impl Compiler<'_> {
    /// The slot of a variable with a fixed number, if the node is one.
    fn slot(&self, index: usize) -> Option<u16> {
        let (Node::Variable(inner), _) = self.expression.node(index)? else { return None };
        let (Node::Number(variable), _) = self.expression.node(*inner)? else { return None };
        self.variables.slot(*variable)
    }

    fn constant(&self, index: usize) -> Option<f64> {
        match self.expression.node(index)? {
            (Node::Number(value), _) => Some(*value),
            (Node::Variable(inner), _) => match self.expression.node(*inner)? {
                (Node::Number(0.0), _) => Some(NULL),
                _ => None,
            },
            _ => None,
        }
    }

    /// `depth`: intermediate results held when the node is reached.
    fn node(&self, machine: &mut Machine, index: usize, depth: usize) -> Compiled {
        let Some((node, place)) = self.expression.node(index) else { return Ok(()) };
        if depth >= STACK_MAX {
            return Err((CodeFault::Brackets, place));
        }
        if let Some(slot) = self.slot(index) {
            machine.emit(Op::Raw(slot), &place);
            return Ok(());
        }
        match *node {
            Node::Number(value) => machine.emit(Op::Constant(value), &place),
            Node::Variable(inner) => match self.constant(index) {
                Some(null) => machine.emit(Op::Constant(null), &place),
                None => {
                    self.node(machine, inner, depth)?;
                    machine.emit(Op::Read, &place);
                }
            },
            Node::Negate(inner) => {
                self.node(machine, inner, depth)?;
                // `X-#1`: the sign belongs to the word, which is as if it were not there when the variable is empty.
                let is_signed_word = self.in_word && index == self.expression.root();
                if is_signed_word && matches!(self.expression.node(inner), Some((Node::Variable(_), _))) {
                    machine.emit(Op::NegateUnlessNull, &place);
                    return Ok(());
                }
                machine.emit(Op::Negate, &place);
            }
            Node::Call(function, first, second) => {
                self.check_function(machine, function, second, &place)?;
                match second {
                    Some(second) => {
                        self.node(machine, first, depth)?;
                        machine.emit(Op::Push, &place);
                        self.node(machine, second, depth + 1)?;
                        machine.emit(Op::CallTwo(function), &place);
                    }
                    None => {
                        self.node(machine, first, depth)?;
                        let op = if function == Function::Round && self.in_word {
                            Op::RoundToIncrement
                        } else {
                            Op::Call(function)
                        };
                        machine.emit(op, &place);
                    }
                }
            }
            Node::Binary(operator, left, right) => {
                self.binary(machine, operator, (left, right), depth, &place)?
            }
        }
        Ok(())
    }

    /// A node whose null counts as zero.
    fn as_number(&self, machine: &mut Machine, index: usize, depth: usize) -> Compiled {
        let place = self.expression.node(index).map_or(0..0, |(_, place)| place);
        match (self.slot(index), self.expression.node(index)) {
            (Some(slot), _) => machine.emit(Op::Number(slot), &place),
            (None, Some((Node::Variable(_), _))) => {
                self.node(machine, index, depth)?;
                machine.emit(Op::AsNumber, &place);
            }
            _ => self.node(machine, index, depth)?,
        }
        Ok(())
    }

    fn binary(
        &self,
        machine: &mut Machine,
        operator: BinaryOperator,
        (left, right): (usize, usize),
        depth: usize,
        place: &Range<u32>,
    ) -> Compiled {
        use BinaryOperator as B;
        if operator == B::Modulo && !machine.rules.has_newer_functions {
            return Err((CodeFault::NoFunction, place.clone()));
        }
        if let B::Compare(_) = operator {
            self.node(machine, left, depth)?;
        } else {
            self.as_number(machine, left, depth)?;
        }
        let op = match (operator, self.constant(right).map(number), self.slot(right)) {
            (B::Compare(comparison), Some(_), _) => {
                Op::CompareConstant(comparison, self.constant(right).unwrap_or(NULL))
            }
            (B::Compare(comparison), _, Some(slot)) => Op::CompareSlot(comparison, slot),
            (B::Add, Some(constant), _) => Op::AddConstant(constant),
            (B::Add, _, Some(slot)) => Op::AddSlot(slot),
            (B::Subtract, Some(constant), _) => Op::SubtractConstant(constant),
            (B::Subtract, _, Some(slot)) => Op::SubtractSlot(slot),
            (B::Multiply, Some(constant), _) => Op::MultiplyConstant(constant),
            (B::Multiply, _, Some(slot)) => Op::MultiplySlot(slot),
            (B::Divide, Some(constant), _) => Op::DivideConstant(constant),
            (B::Divide, _, Some(slot)) => Op::DivideSlot(slot),
            _ => {
                machine.emit(Op::Push, place);
                self.node(machine, right, depth + 1)?;
                Op::Binary(operator)
            }
        };
        machine.emit(op, place);
        Ok(())
    }

    fn check_function(
        &self,
        machine: &Machine,
        function: Function,
        second: Option<usize>,
        place: &Range<u32>,
    ) -> Compiled {
        let rules = &machine.rules;
        let fault = match function {
            Function::Power | Function::AddPoint if !rules.has_newer_functions => CodeFault::NoFunction,
            Function::Random | Function::RandomBetween if !rules.has_random => CodeFault::NoFunction,
            Function::ArcTan if second.is_none() && !rules.has_newer_functions => CodeFault::Arguments,
            // Parameters are numbers of the control's memory, not of a program's arithmetic.
            Function::Parameter => CodeFault::NoFunction,
            _ => return Ok(()),
        };
        Err((fault, place.clone()))
    }
}

/// False for what is not a number, too.
#[inline]
fn within(value: f64, limit: f64) -> bool {
    value.abs() <= limit
}

fn divide(left: f64, right: f64) -> Result<f64, CodeFault> {
    if right == 0.0 { Err(CodeFault::DivideByZero) } else { Ok(left / right) }
}

/// The sine of an angle in degrees, exact at every multiple of 90.
#[inline]
fn sine(degrees: f64) -> f64 {
    /// Adding and taking away this rounds to a whole number.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    /// Beyond, neighbouring floats are about as far apart as a quarter turn.
    const FAR: f64 = 1e15;
    let degrees = if degrees.abs() < FAR { degrees } else { degrees % 360.0 };
    let quarter = (degrees / 90.0 + WHOLE) - WHOLE;
    let rest = (degrees - quarter * 90.0).to_radians();
    match quarter as i64 & 3 {
        0 => rest.sin(),
        1 => rest.cos(),
        2 => -rest.sin(),
        _ => -rest.cos(),
    }
}

/// To the nearest whole number, halves away from zero.
fn round(value: f64) -> f64 {
    value.round()
}

fn whole(value: f64) -> Result<i32, CodeFault> {
    let rounded = value.round();
    if rounded >= f64::from(i32::MIN) && rounded <= f64::from(i32::MAX) {
        Ok(rounded as i32)
    } else {
        Err(CodeFault::IntegerOverflow)
    }
}

/// Largest number of eight binary coded digits.
const CODED_MAX: f64 = 99_999_999.0;

/// Binary coded decimal to binary: 0x25 (37) is 25.
fn to_binary(value: f64) -> Result<f64, CodeFault> {
    let coded = value.round();
    if !(0.0..=f64::from(u32::MAX)).contains(&coded) {
        return Err(CodeFault::Argument);
    }
    let text = format!("{:x}", coded as u32);
    text.parse::<u32>().map(f64::from).map_err(|_| CodeFault::Argument)
}

/// Binary to binary coded decimal: 25 is 0x25 (37).
fn to_decimal(value: f64) -> Result<f64, CodeFault> {
    let plain = value.round();
    if !(0.0..=CODED_MAX).contains(&plain) {
        return Err(CodeFault::Argument);
    }
    u32::from_str_radix(&format!("{}", plain as u32), 16).map(f64::from).map_err(|_| CodeFault::Argument)
}

/// Eight significant digits, and nothing below the smallest magnitude of the older controls.
fn eight_digits(value: f64) -> f64 {
    const SMALLEST: f64 = 1e-29;
    if value.abs() < SMALLEST {
        return 0.0;
    }
    let places = 7 - value.abs().log10().floor() as i32;
    if places.abs() > 300 {
        return value;
    }
    let scale = 10f64.powi(places.abs());
    if places >= 0 { (value * scale).round() / scale } else { (value / scale).round() * scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_exact_at_quarters_and_good_between() {
        for turns in -8i32..8 {
            let degrees = f64::from(turns) * 90.0;
            let exact = [0.0, 1.0, 0.0, -1.0][turns.rem_euclid(4) as usize];
            assert_eq!(sine(degrees).abs(), f64::abs(exact), "{degrees}");
        }
        for tenth in -36_000..36_000 {
            let degrees = f64::from(tenth) / 10.0;
            assert!((sine(degrees) - degrees.to_radians().sin()).abs() < 1e-13, "{degrees}");
        }
        assert!(sine(1e300).abs() <= 1.0);
    }

    #[test]
    fn coded_decimals() {
        assert_eq!(to_binary(37.0), Ok(25.0));
        assert_eq!(to_decimal(25.0), Ok(37.0));
        assert_eq!(to_binary(26.0), Err(CodeFault::Argument));
        assert_eq!(to_decimal(-1.0), Err(CodeFault::Argument));
    }

    #[test]
    fn eight_significant_digits() {
        assert_eq!(eight_digits(1.0 / 3.0), 0.333_333_33);
        assert_eq!(eight_digits(123_456_789.0), 123_456_790.0);
        assert_eq!(eight_digits(1e-30), 0.0);
    }
}
