//! Macro statements: compiled once, and what they do.
//!
//! `#i = …`, `IF … GOTO`, `IF … THEN`, `GOTO`, `WHILE … DO`, `DO`, `END`, and the output statements. Loops and
//! jumps are looked up in the index of the text; a kept block remembers where it led.
//!
//! Source: branching and repetition of custom macro, both families.

use std::ops::Range;

use turnwright_control::Mode;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Expected, Expression, ExpressionFault, Node, Statement as Written, parse_statement};

use super::arithmetic::CodeFault;
use super::code::Code;
use super::variables::number;
use crate::Environment;
use crate::cache::Way;
use crate::index::Resume;
use crate::limits;
use crate::machine::{Core, Halt};
use crate::report::Alarm;

/// What is written to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// A variable with a place of its own.
    Slot(u16),
    /// The variable whose number this computes.
    Number(Code),
}

/// A sequence number that is jumped to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Label {
    Fixed(u32),
    Computed(Code),
}

/// A statement in compiled form.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Statement {
    Assign {
        target: Target,
        value: Code,
    },
    IfGoto {
        condition: Code,
        label: Label,
    },
    IfThen {
        condition: Code,
        target: Target,
        value: Code,
    },
    While {
        condition: Code,
    },
    Do,
    End,
    Goto {
        label: Label,
    },
    /// Output; the text between these bytes of the line says what.
    Output {
        start: u32,
        end: u32,
    },
}

/// Largest sequence number that a jump may name, by digits.
fn sequence_max(digits: u8) -> f64 {
    10f64.powi(i32::from(digits)) - 1.0
}

impl Core {
    /// Compiles the statement at some bytes of the line in work.
    pub(crate) fn compile_statement(&mut self, range: Range<u32>) -> Result<Statement, Alarm> {
        let written = match parse_statement(self.line_bytes(), range.clone()) {
            Ok(written) => written,
            Err(fault) => return Err(self.expression_fault(&fault, range)),
        };
        let statement = self.compile_written(&written, &range);
        statement.map_err(|(fault, place)| self.code_fault(fault, place))
    }

    fn compile_written(
        &mut self,
        written: &Written,
        range: &Range<u32>,
    ) -> Result<Statement, (CodeFault, Range<u32>)> {
        let is_plain = matches!(written, Written::Assign(..) | Written::IfThen(..) | Written::Output(_));
        if !is_plain && self.mode == Mode::Mdi && self.frames.is_empty() {
            return Err((CodeFault::FlowInMdi, range.clone()));
        }
        Ok(match written {
            Written::Assign(target, value) => {
                let (target, value) = self.compile_assignment(target, value)?;
                Statement::Assign { target, value }
            }
            Written::IfGoto(condition, label) => {
                Statement::IfGoto { condition: self.compile(condition)?, label: self.compile_label(label)? }
            }
            Written::IfThen(condition, target, value) => {
                let condition = self.compile(condition)?;
                let (target, value) = self.compile_assignment(target, value)?;
                Statement::IfThen { condition, target, value }
            }
            Written::While(condition, loop_number) => {
                self.check_loop_number(*loop_number, range)?;
                Statement::While { condition: self.compile(condition)? }
            }
            Written::Do(loop_number) => {
                self.check_loop_number(*loop_number, range)?;
                Statement::Do
            }
            Written::End(loop_number) => {
                self.check_loop_number(*loop_number, range)?;
                Statement::End
            }
            Written::Goto(label) => Statement::Goto { label: self.compile_label(label)? },
            Written::Output(place) => Statement::Output { start: place.start, end: place.end },
        })
    }

    /// The number of a loop, the last thing in its statement.
    fn check_loop_number(
        &self,
        loop_number: u32,
        statement: &Range<u32>,
    ) -> Result<(), (CodeFault, Range<u32>)> {
        if (1..=3).contains(&loop_number) {
            return Ok(());
        }
        let text = &self.line_bytes()[statement.start as usize..statement.end as usize];
        let digits = text.iter().rev().take_while(|byte| byte.is_ascii_digit()).count() as u32;
        Err((CodeFault::LoopNumber, statement.end - digits..statement.end))
    }

    fn compile(&mut self, expression: &Expression) -> Result<Code, (CodeFault, Range<u32>)> {
        self.macros.machine.compile(expression, &self.macros.variables, false)
    }

    fn compile_assignment(
        &mut self,
        target: &Expression,
        value: &Expression,
    ) -> Result<(Target, Code), (CodeFault, Range<u32>)> {
        let slot = match target.node(target.root()) {
            Some((Node::Number(variable), _)) => self.macros.variables.slot(*variable),
            _ => None,
        };
        let target = match slot {
            Some(slot) if !self.macros.is_protected(slot) => Target::Slot(slot),
            _ => Target::Number(self.compile(target)?),
        };
        Ok((target, self.compile(value)?))
    }

    fn compile_label(&mut self, label: &Expression) -> Result<Label, (CodeFault, Range<u32>)> {
        match label.node(label.root()) {
            Some((Node::Number(value), _))
                if (1.0..=sequence_max(self.control.limits.sequence_digits)).contains(value)
                    && value.fract() == 0.0 =>
            {
                Ok(Label::Fixed(*value as u32))
            }
            _ => Ok(Label::Computed(self.compile(label)?)),
        }
    }

    /// Does what a statement says. Behind it, reading stands where the program goes on.
    #[inline]
    pub(crate) fn run_statement(
        &mut self,
        statement: &Statement,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        match *statement {
            Statement::Assign { target, value } => self.assign(target, value, environment)?,
            Statement::IfThen { condition, target, value } => {
                if self.holds(condition, environment)? {
                    self.assign(target, value, environment)?;
                }
            }
            Statement::IfGoto { condition, label } => {
                if self.holds(condition, environment)? {
                    return self.goto(label, environment);
                }
            }
            Statement::Goto { label } => return self.goto(label, environment),
            Statement::While { condition } => {
                if !self.holds(condition, environment)? {
                    return Ok(self.leave_loop(environment)?);
                }
                if self.cache.current.is_none() {
                    self.check_loop(*statement, environment)?;
                }
            }
            // A kept one was checked when it was kept.
            Statement::Do if self.cache.current.is_some() => {}
            Statement::Do => self.check_loop(*statement, environment)?,
            Statement::End => return Ok(self.repeat_loop(environment)?),
            Statement::Output { start, end } => self.output(start..end, environment)?,
        }
        self.go_on(environment)?;
        Ok(())
    }

    #[inline]
    fn holds(&mut self, condition: Code, environment: &mut dyn Environment) -> Result<bool, Halt> {
        Ok(number(self.evaluate(condition, environment)?) != 0.0)
    }

    #[inline]
    fn assign(&mut self, target: Target, value: Code, environment: &mut dyn Environment) -> Result<(), Halt> {
        match target {
            Target::Slot(slot) => {
                let value = self.evaluate(value, environment)?;
                let value = self.macros.machine.arithmetic.stored(value);
                self.macros.variables.set(slot, value);
                Ok(())
            }
            Target::Number(target) => self.assign_by_number(target, value, environment),
        }
    }

    #[cold]
    fn assign_by_number(
        &mut self,
        target: Code,
        value: Code,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        let variable = number(self.evaluate(target, environment)?);
        let place = self.macros.machine.end_place(target);
        let value = self.evaluate(value, environment)?;
        self.write_variable(variable, value, place, environment)
    }

    /// The block behind the one in work comes next.
    #[inline]
    pub(crate) fn go_on(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let Some(current) = self.cache.current else { return Ok(()) };
        if self.cache.follow(Way::Next) {
            return Ok(());
        }
        let behind = self.cache.behind(current);
        self.go(behind, environment)
    }

    #[cold]
    fn find_label(&mut self, label: Label, environment: &mut dyn Environment) -> Result<Resume, Halt> {
        let wanted = match label {
            Label::Fixed(wanted) => wanted,
            Label::Computed(code) => {
                let value = number(self.evaluate(code, environment)?).round();
                let max = sequence_max(self.control.limits.sequence_digits);
                if !(1.0..=max).contains(&value) {
                    return Err(self.label_alarm("jump-number-out-of-range", format!("{value}")).into());
                }
                value as u32
            }
        };
        self.count_idle(limits::IDLE_LOOK_UPS)?;
        let here = self.block_start();
        let Some((to, _)) = self.find_sequence(wanted, here, environment)? else {
            return Err(self.label_alarm("jump-target-not-found", format!("N{wanted}")).into());
        };
        if self.index(here.line.source, environment)?.enters_loop(here, to) {
            return Err(self.label_alarm("jump-into-loop", format!("N{wanted}")).into());
        }
        Ok(to)
    }

    /// An alarm at what stands behind the `GOTO` of the statement in work.
    fn label_alarm(&self, key: &'static str, word: String) -> Alarm {
        let (start, end) = (self.at.first_byte as usize, self.at.last_byte as usize);
        let statement = self.line_bytes().get(start..end).unwrap_or(&[]);
        let found = statement.windows(4).rposition(|word| word.eq_ignore_ascii_case(b"GOTO"));
        let behind = found.map_or(0, |found| found + 4);
        let blanks = statement[behind..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let place = self.at.span((start + behind + blanks) as u32, self.at.last_byte);
        self.finish(Diagnostic::alarm(key).at(place).with("word", word))
    }

    #[inline]
    fn goto(&mut self, label: Label, environment: &mut dyn Environment) -> Result<(), Halt> {
        if matches!(label, Label::Fixed(_)) && self.cache.follow(Way::Jump) {
            return Ok(());
        }
        let to = self.find_label(label, environment)?;
        self.jump(to, environment)?;
        Ok(())
    }

    /// `WHILE` does not hold: on behind its `END`.
    fn leave_loop(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        if self.cache.follow(Way::Jump) {
            return Ok(());
        }
        let here = self.block_start();
        match self.index(here.line.source, environment)?.behind_loop(here) {
            Some(behind) => self.jump(behind, environment),
            None => Err(self.alarm_block("loop-without-end")),
        }
    }

    /// A loop must have its end before it is entered.
    pub(crate) fn check_loop(
        &mut self,
        statement: Statement,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        if !matches!(statement, Statement::While { .. } | Statement::Do) {
            return Ok(());
        }
        let here = self.block_start();
        match self.index(here.line.source, environment)?.behind_loop(here) {
            Some(_) => Ok(()),
            None => Err(self.alarm_block("loop-without-end")),
        }
    }

    /// `END`: back to the `DO`.
    #[inline]
    fn repeat_loop(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        if self.cache.follow(Way::Jump) {
            return Ok(());
        }
        let here = self.block_start();
        match self.index(here.line.source, environment)?.start_of_loop(here) {
            Some(start) => self.jump(start, environment),
            None => Err(self.alarm_block("end-without-loop")),
        }
    }

    /// The alarm of a statement or expression that cannot be read.
    #[cold]
    pub(crate) fn expression_fault(&self, fault: &ExpressionFault, range: Range<u32>) -> Alarm {
        let bytes = self.line_bytes();
        let rest = bytes.get(fault.place.start as usize..range.end as usize).unwrap_or(&[]);
        let is_word = matches!(rest, [letter, next, ..] if letter.is_ascii_alphabetic()
            && (next.is_ascii_digit() || matches!(next, b'-' | b'.' | b'#')));
        let key = match fault.expected {
            Expected::End if is_word => "macro-and-nc-mixed",
            Expected::End if rest.first() == Some(&b']') => "opening-bracket-missing",
            Expected::Value | Expected::Number | Expected::End => "expression-format",
            Expected::VariableNumber => "variable-number-illegal",
            Expected::OpeningBracket => "opening-bracket-missing",
            Expected::ClosingBracket => "closing-bracket-missing",
            Expected::Comma => "comma-missing",
            Expected::Arguments => "function-argument-format",
            Expected::Function => "macro-word-unknown",
            Expected::LessNesting => "bracket-nesting",
            Expected::LoopNumber => "loop-number-illegal",
            Expected::EqualsSign => "equals-sign-missing",
            Expected::IfForm => "if-format",
            Expected::WhileForm => "while-format",
            Expected::Statement => "macro-statement-format",
        };
        let place = fault.place.start..fault.place.end.max(fault.place.start + 1);
        let quote = self.quote(range.start, range.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(place.start, place.end)).with("word", quote))
    }

    /// The alarm of an expression that has no value.
    #[cold]
    pub(crate) fn code_fault(&self, fault: CodeFault, place: Range<u32>) -> Alarm {
        let key = match fault {
            CodeFault::DivideByZero => "divide-by-zero",
            CodeFault::Argument => "argument-out-of-range",
            CodeFault::IntegerOverflow => "macro-integer-overflow",
            CodeFault::Overflow => "macro-value-overflow",
            CodeFault::Brackets => "bracket-nesting",
            CodeFault::NoFunction => "macro-function-unavailable",
            CodeFault::Arguments => "function-argument-format",
            CodeFault::BareArgument => "opening-bracket-missing",
            CodeFault::LoopNumber => "loop-number-illegal",
            CodeFault::JoinedConditions => "expression-format",
            CodeFault::FlowInMdi => "macro-flow-in-mdi",
            CodeFault::NoName => "variable-number-illegal",
        };
        let quote = self.quote(place.start, place.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(place.start, place.end)).with("word", quote))
    }
}
