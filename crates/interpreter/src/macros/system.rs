//! System variables: what a program can ask of the control, and change in it.
//!
//! Numbers and meaning follow the tables of both families; which of two readings a control has is a policy.
//! Positions are asked of a machine that may still be moving: a program that reads them waits until it stands
//! ([`SyncReason::MovesDone`]). Lengths are in the unit of the program, X as a diameter.
//!
//! Source: system variables of custom macro, lathe.

use std::ops::Range;

use turnwright_canon::Action;
use turnwright_control::policy::{ClockVariables, NineThousandVariables, PositionVariables};
use turnwright_diagnostics::Diagnostic;
use turnwright_units::{Length, MachineTurret, Position, WorkTip};

use super::variables::{NULL, number};
use crate::Environment;
use crate::machine::{Core, Halt, SyncReason};
use crate::report::Alarm;

/// What system variables hold that nothing else does.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct State {
    /// Added to the clock so that it shows what was written.
    clock_shift_ms: f64,
    clock_shift: f64,
    /// Single block and completion of auxiliary functions.
    pub(crate) single_block: u8,
    /// Feed hold, override and exact stop.
    pub(crate) hold: u8,
    outputs: u32,
}

/// An axis behind a position variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Z,
    /// One that this machine does not have: it stands at 0.
    Other,
}

impl Core {
    /// What a variable holds.
    pub(crate) fn read_variable(
        &mut self,
        variable: f64,
        environment: &mut dyn Environment,
    ) -> Result<f64, Halt> {
        if let Some(slot) = self.macros.variables.slot(variable) {
            return Ok(self.macros.variables.get(slot));
        }
        if variable == 0.0 {
            return Ok(NULL);
        }
        let number_of = whole_number(variable);
        if let Some(inner) = number_of.and_then(|number| self.indirect(number)) {
            let held = number(self.read_variable(inner, environment)?);
            return self.read_variable(held, environment);
        }
        match number_of.map(|number| self.read_system(number, environment)) {
            Some(Ok(Some(value))) => Ok(value),
            Some(Err(halt)) => Err(halt),
            _ => Err(self.variable_alarm("variable-number-illegal").into()),
        }
    }

    /// The variable that holds the number of the one meant, on controls with such variables.
    fn indirect(&self, variable: u32) -> Option<f64> {
        let is_on = self.control.policies.nine_thousand_variables == NineThousandVariables::Indirect;
        (is_on && (9_100..=9_999).contains(&variable)).then(|| f64::from(variable - 9_000))
    }

    fn variable_alarm(&self, key: &'static str) -> Alarm {
        let place = self.macros.machine.fault_place();
        let place = if place.is_empty() { self.at.first_byte..self.at.last_byte } else { place };
        let quote = self.quote(place.start, place.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(place.start, place.end)).with("word", quote))
    }

    fn read_system(&mut self, variable: u32, environment: &mut dyn Environment) -> Result<Option<f64>, Halt> {
        let clock = self.control.policies.clock_variables;
        let unit = if self.modal.is_inch { 25.4 } else { 1.0 };
        let value = match variable {
            1000..=1031 => f64::from(u8::from(environment.macro_input((variable - 1000) as u8))),
            1032 => f64::from(inputs(environment, 16)),
            1033 => f64::from(inputs(environment, 32)),
            1100..=1131 => f64::from(self.macros.state.outputs >> (variable - 1100) & 1),
            1132 => f64::from(self.macros.state.outputs & 0xffff),
            1133 => f64::from(self.macros.state.outputs),
            3000 | 3006 => return Err(self.variable_alarm("variable-read-protected").into()),
            3001 => {
                let ms = environment.uptime_ms() as f64 + self.macros.state.clock_shift_ms;
                match clock {
                    ClockVariables::MillisecondsAndHours => ms,
                    ClockVariables::Seconds => (ms / 1000.0).floor(),
                }
            }
            3002 => {
                let ms = environment.uptime_ms() as f64;
                let unit = match clock {
                    ClockVariables::MillisecondsAndHours => 3_600_000.0,
                    ClockVariables::Seconds => 1000.0,
                };
                ms / unit + self.macros.state.clock_shift
            }
            3003 => f64::from(self.macros.state.single_block),
            3004 => f64::from(self.macros.state.hold),
            3005 => f64::from(u8::from(self.modal.is_inch) << 2),
            3011 => environment.now().map_or(0.0, |now| {
                f64::from(u32::from(now.year) * 10_000 + u32::from(now.month) * 100 + u32::from(now.day))
            }),
            3012 => environment.now().map_or(0.0, |now| {
                f64::from(u32::from(now.hour) * 10_000 + u32::from(now.minute) * 100 + u32::from(now.second))
            }),
            5001..=5008 => work(self.position_axis(variable - 5001), self.modal.position) / unit,
            5021..=5028 => {
                self.wait_for_moves()?;
                machine(self.position_axis(variable - 5021), self.machine_position()) / unit
            }
            5041..=5048 => {
                self.wait_for_moves()?;
                work(self.position_axis(variable - 5041), self.modal.position) / unit
            }
            // Axes of a simulated machine follow exactly.
            5101..=5108 => 0.0,
            _ => return Ok(None),
        };
        Ok(Some(value))
    }

    /// The axis that a position variable stands for.
    pub(super) fn position_axis(&self, place: u32) -> Axis {
        match (self.control.policies.position_variables, place) {
            (_, 0) => Axis::X,
            (PositionVariables::XThenZ, 1) | (PositionVariables::XThenYThenZ, 2) => Axis::Z,
            _ => Axis::Other,
        }
    }

    /// Whoever asks where the axes are waits until they stand.
    fn wait_for_moves(&self) -> Result<(), Halt> {
        if self.moves_done { Ok(()) } else { Err(Halt::Wait(SyncReason::MovesDone)) }
    }

    /// Writes a variable; `place` is where its number stands.
    pub(crate) fn write_variable(
        &mut self,
        variable: f64,
        value: f64,
        place: Range<u32>,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        let alarm = |core: &Self, key| {
            let quote = core.quote(place.start, place.end);
            let diagnostic = Diagnostic::alarm(key).at(core.at.span(place.start, place.end));
            Halt::from(core.finish(diagnostic.with("word", quote)))
        };
        if let Some(slot) = self.macros.variables.slot(variable) {
            if self.macros.is_protected(slot) {
                return Err(alarm(self, "variable-write-protected"));
            }
            let value = self.macros.machine.stored(value);
            self.macros.variables.set(slot, value);
            return Ok(());
        }
        let Some(variable) = whole_number(variable) else {
            return Err(alarm(self, "variable-number-illegal"));
        };
        if variable == 0 {
            return Err(alarm(self, "variable-write-protected"));
        }
        if let Some(inner) = self.indirect(variable) {
            let held = number(self.read_variable(inner, environment)?);
            return self.write_variable(held, value, place, environment);
        }
        match self.write_system(variable, number(value), environment)? {
            Written::Done => Ok(()),
            Written::ReadOnly => Err(alarm(self, "variable-write-protected")),
            Written::OutOfRange => Err(alarm(self, "argument-out-of-range")),
            Written::Unknown => Err(alarm(self, "variable-number-illegal")),
        }
    }

    fn write_system(
        &mut self,
        variable: u32,
        value: f64,
        environment: &mut dyn Environment,
    ) -> Result<Written, Halt> {
        let state = &mut self.macros.state;
        let flags = |max: u8| (0.0..=f64::from(max)).contains(&value.round()).then(|| value.round() as u8);
        match variable {
            1100..=1131 => {
                let signal = (variable - 1100) as u8;
                let is_on = value.round() != 0.0;
                state.outputs = state.outputs & !(1 << signal) | u32::from(is_on) << signal;
                environment.set_macro_output(signal, is_on);
            }
            1132 | 1133 => {
                let count = if variable == 1132 { 16 } else { 32 };
                let rounded = value.round();
                if rounded.abs() > f64::from(u32::MAX) {
                    return Ok(Written::OutOfRange);
                }
                let word = rounded as i64 as u32;
                for signal in 0..count {
                    environment.set_macro_output(signal, word >> signal & 1 == 1);
                }
                let kept = if count == 16 { state.outputs & 0xffff_0000 } else { 0 };
                state.outputs = kept | if count == 16 { word & 0xffff } else { word };
            }
            3000 => {
                let text = self.comment();
                return Err(self.user_alarm(value, &text).into());
            }
            3001 => {
                let ms = if self.control.policies.clock_variables == ClockVariables::Seconds {
                    return Ok(Written::ReadOnly);
                } else {
                    value
                };
                state.clock_shift_ms = ms - environment.uptime_ms() as f64;
            }
            3002 => {
                let unit = match self.control.policies.clock_variables {
                    ClockVariables::MillisecondsAndHours => 3_600_000.0,
                    ClockVariables::Seconds => 1000.0,
                };
                state.clock_shift = value - environment.uptime_ms() as f64 / unit;
            }
            3003 => match flags(3) {
                Some(flags) => state.single_block = flags,
                None => return Ok(Written::OutOfRange),
            },
            3004 => match flags(7) {
                Some(flags) => state.hold = flags,
                None => return Ok(Written::OutOfRange),
            },
            3005 => {
                let Some(settings) = (0.0..65_536.0).contains(&value).then_some(value as u32) else {
                    return Ok(Written::OutOfRange);
                };
                self.modal.is_inch = settings & 4 != 0;
            }
            3006 => {
                let text = self.comment();
                self.emit(Action::Message(text.into_boxed_str()));
                self.emit(Action::Stop);
                self.sync = Some(SyncReason::CycleStart);
            }
            1000..=1033 | 3007 | 3011 | 3012 | 4001..=4130 | 5001..=5128 => return Ok(Written::ReadOnly),
            _ => return Ok(Written::Unknown),
        }
        Ok(Written::Done)
    }

    /// An alarm that the program itself raises.
    pub(super) fn user_alarm(&self, value: f64, text: &str) -> Alarm {
        let limits = &self.control.limits;
        let raised = value.round();
        if !(0.0..=f64::from(limits.user_alarm_max)).contains(&raised) {
            return self.alarm_block("argument-out-of-range");
        }
        let number = i64::from(limits.user_alarm_base) + raised as i64;
        let text = if text.is_empty() { number.to_string() } else { text.to_string() };
        let diagnostic = Diagnostic::alarm("macro-user-alarm").at(self.block_place());
        self.finish(diagnostic.with("value", text).with("number", number))
    }

    /// The comment behind the statement in work.
    fn comment(&self) -> String {
        let line = self.line_bytes();
        let rest = line.get(self.at.last_byte as usize..).unwrap_or(&[]);
        let Some(open) = rest.iter().position(|byte| *byte == b'(') else { return String::new() };
        let inner = &rest[open + 1..];
        let end = inner.iter().position(|byte| *byte == b')').unwrap_or(inner.len());
        String::from_utf8_lossy(&inner[..end]).trim().chars().take(COMMENT_CHARACTERS_MAX).collect()
    }
}

/// Longest text of a message.
const COMMENT_CHARACTERS_MAX: usize = 80;

/// What writing a system variable came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Written {
    Done,
    ReadOnly,
    OutOfRange,
    Unknown,
}

fn whole_number(variable: f64) -> Option<u32> {
    let rounded = variable.round();
    ((variable - rounded).abs() < 1e-6 && (0.0..100_000.0).contains(&rounded)).then_some(rounded as u32)
}

fn inputs(environment: &dyn Environment, count: u8) -> u32 {
    (0..count).filter(|signal| environment.macro_input(*signal)).fold(0, |word, signal| word | 1 << signal)
}

fn work(axis: Axis, position: Position<WorkTip>) -> f64 {
    millimetres(axis, position.x.to_diameter().0, position.z)
}

fn machine(axis: Axis, position: Position<MachineTurret>) -> f64 {
    millimetres(axis, position.x.to_diameter().0, position.z)
}

fn millimetres(axis: Axis, x: Length, z: Length) -> f64 {
    match axis {
        Axis::X => x.to_mm(),
        Axis::Z => z.to_mm(),
        Axis::Other => 0.0,
    }
}
