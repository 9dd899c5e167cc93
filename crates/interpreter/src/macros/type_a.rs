//! Macro of the older kind: `G65 Hm P#i Q#j R#k`, arithmetic and jumps by number.
//!
//! H says what is done; P is the variable that takes the result, or the block to go to; Q and R are the operands,
//! variables or numbers. Source: the H table of GSK's G65; the same table is an option of older FANUC controls.

use turnwright_control::policy::TypeAMacro;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{BinaryOperator, Block, Function, Node, Value, Word, parse_expression};

use super::CallKind;
use super::arithmetic::CodeFault;
use super::variables::number;
use crate::Environment;
use crate::functions::Kind;
use crate::machine::{Core, Halt};
use crate::report::Alarm;

/// What H asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    /// P takes Q.
    Copy,
    /// P takes Q and R together.
    Binary(BinaryOperator),
    /// P takes the function of Q.
    Function(Function),
    /// P takes P times Q divided by R.
    MultiplyDivide,
    /// P takes the root of the sum of both squares.
    Hypotenuse,
    /// P takes Q times the function of R.
    Times(Function),
    /// P takes the angle of Q over R.
    Angle,
    /// On with block P.
    Go,
    /// On with block P when Q and R compare so.
    GoIf(std::cmp::Ordering, bool),
    /// An alarm.
    Alarm,
}

fn operation(code: u32) -> Option<Operation> {
    use std::cmp::Ordering::{Equal, Greater, Less};
    Some(match code {
        1 => Operation::Copy,
        2 => Operation::Binary(BinaryOperator::Add),
        3 => Operation::Binary(BinaryOperator::Subtract),
        4 => Operation::Binary(BinaryOperator::Multiply),
        5 => Operation::Binary(BinaryOperator::Divide),
        11 => Operation::Binary(BinaryOperator::Or),
        12 => Operation::Binary(BinaryOperator::And),
        13 => Operation::Binary(BinaryOperator::ExclusiveOr),
        21 => Operation::Function(Function::SquareRoot),
        22 => Operation::Function(Function::Absolute),
        23 => Operation::Binary(BinaryOperator::Modulo),
        24 => Operation::Function(Function::ToBinary),
        25 => Operation::Function(Function::ToDecimal),
        26 => Operation::MultiplyDivide,
        27 => Operation::Hypotenuse,
        31 => Operation::Times(Function::Sin),
        32 => Operation::Times(Function::Cos),
        33 => Operation::Times(Function::Tan),
        34 => Operation::Angle,
        80 => Operation::Go,
        81 => Operation::GoIf(Equal, true),
        82 => Operation::GoIf(Equal, false),
        83 => Operation::GoIf(Greater, true),
        84 => Operation::GoIf(Less, true),
        // Not less, not greater.
        85 => Operation::GoIf(Less, false),
        86 => Operation::GoIf(Greater, false),
        99 => Operation::Alarm,
        _ => return None,
    })
}

impl Core {
    /// Whether the call of a block is arithmetic on this control.
    pub(super) fn is_type_a_block(&self, block: &Block) -> bool {
        block.has(b'H')
            && match self.control.policies.type_a_macro {
                TypeAMacro::None => false,
                TypeAMacro::ByWord => true,
                TypeAMacro::ByParameter => self.control.parameters.bit("macro-form-a"),
            }
    }

    /// Whether a block's words may not be computed, because its P names a variable.
    pub(crate) fn keeps_variable_words(&self, block: &Block) -> bool {
        self.is_type_a_block(block)
            && block.words.iter().any(|word| {
                let code = if word.address == b'G' { self.code(word).ok() } else { None };
                let function = code.and_then(|code| self.dispatch.function(code));
                function.is_some_and(|id| matches!(id.get().kind, Kind::Call(CallKind::Simple)))
            })
    }

    /// Does what H asks for.
    pub(super) fn type_a(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Alarm> {
        match self.type_a_now(block, environment) {
            Ok(()) => Ok(()),
            Err(Halt::Alarm(alarm)) => Err(alarm),
            // Nothing here reads what has to be waited for more than once.
            Err(Halt::Wait(_)) => {
                self.moves_done = true;
                self.type_a(block, environment)
            }
        }
    }

    fn type_a_now(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Halt> {
        let Some(code) = block.word(b'H') else { return Ok(()) };
        let Some(operation) = operation(self.whole(code, 99)?) else {
            return Err(self.alarm("macro-function-unavailable", code).into());
        };
        match operation {
            Operation::Go => self.type_a_jump(block, environment),
            Operation::GoIf(order, wanted) => {
                let (left, right) =
                    (self.operand(block, b'Q', environment)?, self.operand(block, b'R', environment)?);
                if (left.partial_cmp(&right) == Some(order)) == wanted {
                    return self.type_a_jump(block, environment);
                }
                Ok(())
            }
            Operation::Alarm => {
                let raised = self.operand(block, b'P', environment)?;
                Err(self.user_alarm(raised, "").into())
            }
            _ => {
                let value = self.type_a_value(operation, block, environment)?;
                let Some(target) = block.word(b'P') else {
                    return Err(self.alarm("macro-statement-format", code).into());
                };
                let variable = self.target_variable(target, environment)?;
                self.write_variable(variable, value, target.start..target.end, environment)
            }
        }
    }

    fn type_a_value(
        &mut self,
        operation: Operation,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<f64, Halt> {
        let left = self.operand(block, b'Q', environment)?;
        let mut right = |core: &mut Self| core.operand(block, b'R', environment);
        let value = match operation {
            Operation::Copy => Ok(left),
            Operation::Binary(operator) => {
                let right = right(self)?;
                self.macros.machine.arithmetic.binary(operator, left, right)
            }
            Operation::Function(function) => self.macros.machine.arithmetic.call(function, left),
            Operation::Hypotenuse => Ok(left.hypot(right(self)?)),
            Operation::Times(function) => {
                let angle = right(self)?;
                self.macros.machine.arithmetic.call(function, angle).map(|value| left * value)
            }
            Operation::Angle => {
                let right = right(self)?;
                self.macros.machine.arithmetic.call_two(Function::ArcTan, left, right)
            }
            Operation::MultiplyDivide => {
                let divisor = right(self)?;
                let held = match block.word(b'P') {
                    Some(word) => {
                        let variable = self.target_variable(word, environment)?;
                        number(self.read_variable(variable, environment)?)
                    }
                    None => 0.0,
                };
                self.macros.machine.arithmetic.binary(BinaryOperator::Divide, held * left, divisor)
            }
            Operation::Go | Operation::GoIf(..) | Operation::Alarm => Ok(0.0),
        };
        let place = || block.word(b'H').map_or(0..0, |word| word.start..word.end);
        let value = value.map_err(|fault| self.code_fault(fault, place()))?;
        if value.is_finite() { Ok(value) } else { Err(self.code_fault(CodeFault::Overflow, place()).into()) }
    }

    fn type_a_jump(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Halt> {
        let Some(target) = block.word(b'P') else {
            return Err(self.alarm_block("macro-statement-format").into());
        };
        let wanted = self.operand(block, b'P', environment)?.round();
        if !(1.0..100_000.0).contains(&wanted) {
            return Err(self.alarm("jump-number-out-of-range", target).into());
        }
        let here = self.block_start();
        match self.find_sequence(wanted as u32, here, environment)? {
            Some((to, _)) => Ok(self.jump(to, environment)?),
            None => {
                let diagnostic = Diagnostic::alarm("jump-target-not-found").at(self.place(target));
                let diagnostic = diagnostic.with("word", self.quote(target.start, target.end));
                Err(self.finish(diagnostic.with("sequence", wanted as i64)).into())
            }
        }
    }

    /// The value of an operand: a number as written, or what a variable holds. Without the word it is 0.
    fn operand(&mut self, block: &Block, letter: u8, environment: &mut dyn Environment) -> Result<f64, Halt> {
        let Some(word) = block.word(letter) else { return Ok(0.0) };
        match word.value {
            Value::Number(value) => Ok(value.digits as f64 / 10f64.powi(i32::from(value.scale))),
            Value::Expression { start, end } => {
                let code = self.type_a_code(start..end)?;
                let value = self.evaluate(code.1, environment);
                self.macros.machine.forget(code.0);
                Ok(number(value?))
            }
            Value::Missing => Err(self.alarm("address-without-value", word).into()),
        }
    }

    fn type_a_code(&mut self, range: std::ops::Range<u32>) -> Result<(usize, super::Code), Alarm> {
        let expression = match parse_expression(self.line_bytes(), range.clone()) {
            Ok(expression) => expression,
            Err(fault) => return Err(self.expression_fault(&fault, range)),
        };
        let mark = self.macros.machine.mark();
        let code = self.macros.machine.compile(&expression, &self.macros.variables, false);
        Ok((mark, code.map_err(|(fault, place)| self.code_fault(fault, place))?))
    }

    /// The number of the variable that P names.
    fn target_variable(&mut self, word: &Word, environment: &mut dyn Environment) -> Result<f64, Halt> {
        let Value::Expression { start, end } = word.value else {
            return Err(self.alarm("variable-number-illegal", word).into());
        };
        let parsed = parse_expression(self.line_bytes(), start..end);
        let expression = match parsed {
            Ok(expression) => expression,
            Err(fault) => return Err(self.expression_fault(&fault, start..end).into()),
        };
        let Some((Node::Variable(_), _)) = expression.node(expression.root()) else {
            return Err(self.alarm("variable-number-illegal", word).into());
        };
        // What stands behind the first `#` is the number.
        let (mark, code) = self.type_a_code(start + 1..end)?;
        let value = self.evaluate(code, environment);
        self.macros.machine.forget(mark);
        Ok(number(value?))
    }
}
