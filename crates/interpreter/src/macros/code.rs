//! Expressions as flat code, compiled once and run without allocating.
//!
//! In: the tree of an expression. Out: operations for one accumulator and a small stack. Variables with a fixed
//! number become slots when they are compiled; everything else that `#` may name is asked of the caller, who
//! knows the control's state ([`Pause::Read`]).
//!
//! Source: arithmetic and logic operations of custom macro, both families.

use std::ops::Range;

use turnwright_syntax::{BinaryOperator, Comparison, Expression, Function, Node};

use super::arithmetic::{Arithmetic, CodeFault, Rules};
use super::names;
use super::variables::{LOCALS, NULL, Variables, is_null, number};

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
    /// A variable and a constant: most expressions begin so.
    SlotPlusConstant(u16, f64),
    SlotTimesConstant(u16, f64),
    CompareSlotWithConstant(Comparison, u16, f64),
    /// What stands on the left of a difference, the accumulator being its right side.
    SubtractFromConstant(f64),
    SubtractFromSlot(u16),
    /// What was pushed last, and the accumulator.
    Binary(BinaryOperator),
    Call(Function),
    /// What was pushed last is the first argument.
    CallTwo(Function),
    /// The variable whose number is the accumulator.
    Read,
    /// `ADP` of the local variable in a slot.
    AddPoint(u16),
    /// A parameter: its number and bit were pushed, the accumulator is the axis.
    Parameter,
    /// The number of the axis with a letter.
    AxisNumber(u8),
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
    /// A number was typed.
    pub(crate) const NONE: Self = Self { start: 0, end: 0 };
    /// What stands there is no expression but a name.
    pub(crate) const NAME: Self = Self { start: u32::MAX, end: u32::MAX };

    /// Whether it is the code of an expression.
    pub(crate) fn computes(self) -> bool {
        self != Self::NONE && self != Self::NAME
    }

    #[inline]
    const fn is_one_operation(self) -> bool {
        self.end.wrapping_sub(self.start) == 1
    }
}

/// Why running a piece of code came to no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pause {
    /// The caller must say what the variable of this number holds, and go on with [`Machine::resume`].
    Read(f64),
    /// The caller must round the value to what the word's address counts in, and go on in the same way.
    Round(f64),
    /// As for [`Pause::Read`], of a local variable that is an argument, with the point that its word lacked.
    AddPoint(u16),
    /// The value of a parameter is asked for in the same way: its number, bit and axis.
    Parameter(f64, f64, f64),
    /// The number of the axis with a letter.
    AxisNumber(u8),
    /// It has no value.
    Fault(CodeFault),
}

/// The code of all expressions that are kept, and the state of the one that runs.
#[derive(Debug)]
pub(crate) struct Machine {
    pub(crate) arithmetic: Arithmetic,
    code: Vec<Op>,
    /// Place of each operation in its line.
    places: Vec<(u32, u32)>,
    stack: [f64; STACK_MAX],
    depth: usize,
    at: usize,
    end: usize,
    pause: Pause,
}

impl Machine {
    pub(crate) fn new(rules: Rules) -> Self {
        Self {
            arithmetic: Arithmetic::new(rules),
            code: Vec::new(),
            places: Vec::new(),
            stack: [0.0; STACK_MAX],
            depth: 0,
            at: 0,
            end: 0,
            pause: Pause::Round(0.0),
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

    /// The place of the operation that ran last, of code that has no value.
    pub(crate) fn fault_place(&self) -> Range<u32> {
        self.place(self.at)
    }

    /// The place of the operation that some code ends with.
    pub(crate) fn end_place(&self, code: Code) -> Range<u32> {
        self.place(code.end as usize)
    }

    /// The place of the operation before this one.
    fn place(&self, at: usize) -> Range<u32> {
        let (start, end) = self.places.get(at.wrapping_sub(1)).copied().unwrap_or_default();
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
            && !self.arithmetic.rules.takes_bare_arguments
        {
            return Err((CodeFault::BareArgument, place));
        }
        if expression.bracket_depth() > self.arithmetic.rules.bracket_depth_max {
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

    /// The value of code that is a single operation on variables that have a place of their own; `None` for other
    /// code, and where there is no value.
    #[inline(always)]
    pub(crate) fn at_once(&self, code: Code, variables: &Variables) -> Option<f64> {
        if !code.is_one_operation() {
            return None;
        }
        let slots = variables.slots();
        let slot = |place: u16| slots[usize::from(place)];
        let value = match *self.code.get(code.start as usize)? {
            Op::Constant(constant) => return Some(constant),
            Op::Raw(place) => return Some(slot(place)),
            Op::CompareSlotWithConstant(comparison, place, constant) => {
                return Some(self.arithmetic.compare(comparison, slot(place), constant));
            }
            Op::SlotPlusConstant(place, constant) => number(slot(place)) + constant,
            Op::SlotTimesConstant(place, constant) => number(slot(place)) * constant,
            _ => return None,
        };
        within(value, self.arithmetic.rules.magnitude_max).then_some(value)
    }

    /// The value of code that needs nothing but variables ([`Machine::stands_alone`]); `None` where there is none.
    #[inline]
    pub(crate) fn value(&mut self, code: Code, variables: &Variables) -> Option<f64> {
        if code.is_one_operation()
            && let Some(value) = self.at_once(code, variables)
        {
            return Some(value);
        }
        self.start(code, variables)
    }

    /// Whether running code twice gives the same twice, and asks nobody.
    pub(crate) fn stands_alone(&self, code: Code) -> bool {
        let ops = self.code.get(code.start as usize..code.end as usize).unwrap_or_default();
        ops.iter().all(|op| match op {
            Op::Read | Op::RoundToIncrement | Op::AddPoint(_) | Op::Parameter | Op::AxisNumber(_) => false,
            Op::Call(function) | Op::CallTwo(function) => {
                !matches!(function, Function::Random | Function::RandomBetween)
            }
            _ => true,
        })
    }

    /// Runs code from its start; `None` when it pauses ([`Machine::why`]).
    #[inline]
    pub(crate) fn start(&mut self, code: Code, variables: &Variables) -> Option<f64> {
        self.at = code.start as usize;
        self.end = code.end as usize;
        self.depth = 0;
        self.run(NULL, variables)
    }

    /// Goes on with what was asked for.
    pub(crate) fn resume(&mut self, value: f64, variables: &Variables) -> Option<f64> {
        self.run(value, variables)
    }

    #[inline]
    fn run(&mut self, mut value: f64, variables: &Variables) -> Option<f64> {
        let slots = variables.slots();
        let limit = self.arithmetic.rules.magnitude_max;
        let slot = |place: u16| number(slots[usize::from(place)]);
        let ops = self.code.get(self.at..self.end).unwrap_or_default();
        for (place, op) in ops.iter().enumerate() {
            let result = match *op {
                Op::Constant(constant) => {
                    value = constant;
                    continue;
                }
                Op::Raw(place) => {
                    value = slots[usize::from(place)];
                    continue;
                }
                Op::Number(place) => {
                    value = slot(place);
                    continue;
                }
                Op::Push => {
                    self.stack[self.depth] = value;
                    self.depth += 1;
                    continue;
                }
                Op::Negate => {
                    value = -number(value);
                    continue;
                }
                Op::NegateUnlessNull => {
                    value = if is_null(value) { value } else { -value };
                    continue;
                }
                Op::AsNumber => {
                    value = number(value);
                    continue;
                }
                Op::CompareConstant(comparison, constant) => {
                    value = self.arithmetic.compare(comparison, value, constant);
                    continue;
                }
                Op::CompareSlot(comparison, place) => {
                    value = self.arithmetic.compare(comparison, value, slots[usize::from(place)]);
                    continue;
                }
                Op::CompareSlotWithConstant(comparison, place, constant) => {
                    value = self.arithmetic.compare(comparison, slots[usize::from(place)], constant);
                    continue;
                }
                Op::Read => return self.pause(place, Pause::Read(number(value))),
                Op::RoundToIncrement => return self.pause(place, Pause::Round(number(value))),
                Op::AddPoint(slot) => return self.pause(place, Pause::AddPoint(slot)),
                Op::Parameter => {
                    self.depth -= 2;
                    let (number, bit) = (self.stack[self.depth], self.stack[self.depth + 1]);
                    return self.pause(place, Pause::Parameter(number, bit, value));
                }
                Op::AxisNumber(letter) => return self.pause(place, Pause::AxisNumber(letter)),
                Op::AddConstant(constant) => value + constant,
                Op::AddSlot(place) => value + slot(place),
                Op::SubtractConstant(constant) => value - constant,
                Op::SubtractSlot(place) => value - slot(place),
                Op::SubtractFromConstant(constant) => constant - value,
                Op::SubtractFromSlot(place) => slot(place) - value,
                Op::MultiplyConstant(constant) => value * constant,
                Op::MultiplySlot(place) => value * slot(place),
                Op::SlotPlusConstant(place, constant) => slot(place) + constant,
                Op::SlotTimesConstant(place, constant) => slot(place) * constant,
                Op::DivideConstant(divisor) if divisor != 0.0 => value / divisor,
                Op::DivideSlot(place) if slot(place) != 0.0 => value / slot(place),
                Op::DivideConstant(_) | Op::DivideSlot(_) => {
                    return self.fault(CodeFault::DivideByZero, place);
                }
                Op::Binary(operator) => {
                    self.depth -= 1;
                    match self.arithmetic.binary(operator, self.stack[self.depth], value) {
                        Ok(result) => result,
                        Err(fault) => return self.fault(fault, place),
                    }
                }
                Op::Call(function) => match self.arithmetic.call(function, number(value)) {
                    Ok(result) => result,
                    Err(fault) => return self.fault(fault, place),
                },
                Op::CallTwo(function) => {
                    self.depth -= 1;
                    match self.arithmetic.call_two(function, self.stack[self.depth], number(value)) {
                        Ok(result) => result,
                        Err(fault) => return self.fault(fault, place),
                    }
                }
            };
            if !within(result, limit) {
                return self.fault(CodeFault::Overflow, place);
            }
            value = result;
        }
        self.at = self.end;
        Some(value)
    }

    /// The operation at a place behind the present one has no value.
    #[cold]
    fn fault(&mut self, fault: CodeFault, place: usize) -> Option<f64> {
        self.pause(place, Pause::Fault(fault))
    }

    /// The operation at a place behind the present one waits.
    fn pause(&mut self, place: usize, pause: Pause) -> Option<f64> {
        self.at += place + 1;
        self.pause = pause;
        None
    }

    /// Why the code that ran last has no value.
    pub(crate) const fn why(&self) -> Pause {
        self.pause
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

    /// Whether a node is a comparison.
    fn compares(&self, index: usize) -> bool {
        matches!(self.expression.node(index), Some((Node::Binary(BinaryOperator::Compare(_), ..), _)))
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
                        let local = self.slot(first).filter(|slot| usize::from(*slot) < LOCALS);
                        if let (Function::AddPoint, Some(slot)) = (function, local) {
                            machine.emit(Op::AddPoint(slot), &place);
                            return Ok(());
                        }
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
            Node::Named(..) | Node::Parameter { .. } | Node::AxisNumber(_)
                if !machine.arithmetic.rules.has_names =>
            {
                return Err((CodeFault::NoFunction, place));
            }
            Node::Named(name, subscript) => {
                let Some(number) = names::number_of(&name, subscript.is_some()) else {
                    return Err((CodeFault::NoName, place));
                };
                match subscript {
                    None => machine.emit(Op::Constant(f64::from(number)), &place),
                    Some(subscript) => {
                        self.as_number(machine, subscript, depth)?;
                        machine.emit(Op::AddConstant(f64::from(number)), &place);
                    }
                }
            }
            Node::Parameter { number, bit, axis } => {
                self.as_number(machine, number, depth)?;
                machine.emit(Op::Push, &place);
                self.perhaps(machine, bit, depth + 1, &place)?;
                machine.emit(Op::Push, &place);
                self.perhaps(machine, axis, depth + 2, &place)?;
                machine.emit(Op::Parameter, &place);
            }
            Node::AxisNumber(letter) => machine.emit(Op::AxisNumber(letter), &place),
        }
        Ok(())
    }

    /// A node as a number, or null where there is none.
    fn perhaps(
        &self,
        machine: &mut Machine,
        index: Option<usize>,
        depth: usize,
        place: &Range<u32>,
    ) -> Compiled {
        match index {
            Some(index) => self.as_number(machine, index, depth),
            None => {
                machine.emit(Op::Constant(NULL), place);
                Ok(())
            }
        }
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
        if operator == B::Modulo && !machine.arithmetic.rules.has_newer_functions {
            return Err((CodeFault::NoFunction, place.clone()));
        }
        if !machine.arithmetic.rules.joins_conditions && (self.compares(left) || self.compares(right)) {
            return Err((CodeFault::JoinedConditions, place.clone()));
        }
        let (slots, constants) =
            ((self.slot(left), self.slot(right)), (self.constant(left), self.constant(right)));
        let whole = match (operator, slots.0, constants.1) {
            (B::Compare(comparison), Some(slot), Some(constant)) => {
                Some(Op::CompareSlotWithConstant(comparison, slot, constant))
            }
            (B::Add, Some(slot), Some(constant)) => Some(Op::SlotPlusConstant(slot, number(constant))),
            (B::Subtract, Some(slot), Some(constant)) => Some(Op::SlotPlusConstant(slot, -number(constant))),
            (B::Multiply, Some(slot), Some(constant)) => Some(Op::SlotTimesConstant(slot, number(constant))),
            _ => None,
        };
        if let Some(op) = whole {
            machine.emit(op, place);
            return Ok(());
        }
        // A constant or variable on the left of something longer: the right side first, so that nothing has to be held.
        let is_long = constants.1.is_none() && slots.1.is_none();
        let turned = match (operator, constants.0.map(number), slots.0) {
            (B::Add, Some(constant), _) => Some(Op::AddConstant(constant)),
            (B::Subtract, Some(constant), _) => Some(Op::SubtractFromConstant(constant)),
            (B::Multiply, Some(constant), _) => Some(Op::MultiplyConstant(constant)),
            (B::Add, _, Some(slot)) if is_long => Some(Op::AddSlot(slot)),
            (B::Subtract, _, Some(slot)) if is_long => Some(Op::SubtractFromSlot(slot)),
            (B::Multiply, _, Some(slot)) if is_long => Some(Op::MultiplySlot(slot)),
            _ => None,
        };
        if let Some(op) = turned {
            self.as_number(machine, right, depth)?;
            machine.emit(op, place);
            return Ok(());
        }
        if let B::Compare(_) = operator {
            self.node(machine, left, depth)?;
        } else {
            self.as_number(machine, left, depth)?;
        }
        let op = match (operator, constants.1, slots.1) {
            (B::Compare(comparison), Some(constant), _) => Op::CompareConstant(comparison, constant),
            (B::Compare(comparison), _, Some(slot)) => Op::CompareSlot(comparison, slot),
            (B::Add, Some(constant), _) => Op::AddConstant(number(constant)),
            (B::Add, _, Some(slot)) => Op::AddSlot(slot),
            (B::Subtract, Some(constant), _) => Op::SubtractConstant(number(constant)),
            (B::Subtract, _, Some(slot)) => Op::SubtractSlot(slot),
            (B::Multiply, Some(constant), _) => Op::MultiplyConstant(number(constant)),
            (B::Multiply, _, Some(slot)) => Op::MultiplySlot(slot),
            (B::Divide, Some(constant), _) => Op::DivideConstant(number(constant)),
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
        let rules = &machine.arithmetic.rules;
        let fault = match function {
            Function::Power | Function::AddPoint if !rules.has_newer_functions => CodeFault::NoFunction,
            Function::Random | Function::RandomBetween if !rules.has_random => CodeFault::NoFunction,
            Function::ArcTan if second.is_none() && !rules.has_newer_functions => CodeFault::Arguments,
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
