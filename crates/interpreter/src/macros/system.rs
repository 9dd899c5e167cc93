//! System variables: what a program can ask of the control, and change in it.
//!
//! Numbers and meaning follow the tables of both families; which of two readings a control has is a policy.
//! Positions are asked of a machine that may still be moving: a program that reads them waits until it stands
//! ([`SyncReason::MovesDone`]). Lengths are in the unit of the program, X as a diameter.
//!
//! Source: system variables of custom macro, lathe.

use std::ops::Range;

use turnwright_canon::{Action, PanelLock};
use turnwright_control::policy::{
    ClockVariables, ModalVariables, NineThousandVariables, PositionVariables, SkipVariables,
};
use turnwright_diagnostics::Diagnostic;

use super::variables::{NULL, number};
use crate::Environment;
use crate::axes::Places;
use crate::limits;
use crate::machine::{Core, Halt, SyncReason};
use crate::offsets::{OffsetField, OffsetTable};
use crate::report::Alarm;
use crate::zeros::STANDARD_SYSTEMS;

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
    C,
    Y,
    B,
    /// One that this machine does not have: it stands at 0.
    None,
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
        self.count_idle(limits::IDLE_LOOK_UPS)?;
        let number_of = whole_number(variable);
        if let Some(inner) = number_of.and_then(|number| self.indirect(number)) {
            let held = number(self.read_variable(inner, environment)?);
            if self.is_indirect(held) {
                return Err(self.variable_alarm("variable-number-illegal").into());
            }
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

    /// Whether a number that such a variable holds is that of another one: it could lead round in a circle.
    fn is_indirect(&self, held: f64) -> bool {
        whole_number(held).is_some_and(|held| self.indirect(held).is_some())
    }

    fn variable_alarm(&self, key: &'static str) -> Alarm {
        let place = self.macros.machine.fault_place();
        let place = if place.is_empty() { self.at.first_byte..self.at.last_byte } else { place };
        let quote = self.quote(place.start, place.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(place.start, place.end)).with("word", quote))
    }

    fn read_system(&mut self, variable: u32, environment: &mut dyn Environment) -> Result<Option<f64>, Halt> {
        let clock = self.control.policies.clock_variables;
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
            // The mirror of the double turret is one in X.
            3007 => f64::from(u8::from(self.transform.is_mirrored)),
            3011 => environment.now().map_or(0.0, |now| {
                f64::from(u32::from(now.year) * 10_000 + u32::from(now.month) * 100 + u32::from(now.day))
            }),
            3012 => environment.now().map_or(0.0, |now| {
                f64::from(u32::from(now.hour) * 10_000 + u32::from(now.minute) * 100 + u32::from(now.second))
            }),
            4001..=4022 if self.shows_modal(variable) => {
                let code = self.modal_codes()[(variable - 4000) as usize];
                code.map_or(0.0, |code| f64::from(code) / 10.0)
            }
            4102..=4130 if self.shows_modal(variable) => match modal_address(variable) {
                Some(b'P') => self.additional_system().map_or(0.0, |system| system as f64),
                Some(letter) => self.modal_word(letter).unwrap_or(0.0),
                None => return Ok(None),
            },
            5001..=5008 => self.work_place(self.position_axis(variable - 5001)),
            5021..=5028 => {
                self.wait_for_moves()?;
                let place = self.machine_position();
                match self.position_axis(variable - 5021) {
                    Axis::X => self.x_value(place.x).to_mm() / self.unit_mm(),
                    Axis::Z => place.z.to_mm() / self.unit_mm(),
                    other => self.other_value(self.axes.in_machine(), other),
                }
            }
            5041..=5048 => {
                self.wait_for_moves()?;
                self.work_place(self.position_axis(variable - 5041))
            }
            5061..=5068 => self.skip_place_of(self.position_axis(variable - 5061)),
            5081..=5088 => self.active_offset(OffsetTable::Wear, self.position_axis(variable - 5081)),
            5121..=5128 => self.active_offset(OffsetTable::Geometry, self.position_axis(variable - 5121)),
            // Axes of a simulated machine follow exactly.
            5101..=5108 => 0.0,
            _ => return Ok(self.read_stored(variable)),
        };
        Ok(Some(value))
    }

    /// Whether the control lets programs see this modal variable.
    fn shows_modal(&self, variable: u32) -> bool {
        match self.control.policies.modal_variables {
            ModalVariables::All => true,
            ModalVariables::Listed => matches!(
                variable,
                4001 | 4002 | 4005..=4007 | 4012 | 4014 | 4016 | 4109 | 4113..=4115 | 4119 | 4120
            ),
        }
    }

    /// The additional work system in force, from 1.
    fn additional_system(&self) -> Option<usize> {
        (self.modal.work + 1).checked_sub(STANDARD_SYSTEMS).filter(|system| *system > 0)
    }

    fn work_place(&self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.x_value(self.modal.position.x).to_mm() / self.unit_mm(),
            Axis::Z => self.modal.position.z.to_mm() / self.unit_mm(),
            other => self.other_place(other),
        }
    }

    /// Where the last skip signal came.
    fn skip_place_of(&self, axis: Axis) -> f64 {
        let place = self.skip_position();
        match axis {
            Axis::X => self.x_value(place.x).to_mm() / self.unit_mm(),
            Axis::Z => place.z.to_mm() / self.unit_mm(),
            other => self.other_value(self.skip_places, other),
        }
    }

    /// Puts the place of a skip into common variables, on controls that do.
    pub(crate) fn tell_skip(&mut self) {
        if self.control.policies.skip_variables != SkipVariables::CommonVariables {
            return;
        }
        for (variable, axis) in [(995.0, Axis::X), (996.0, Axis::Z)] {
            if let Some(slot) = self.macros.variables.slot(variable) {
                let place = self.skip_place_of(axis);
                self.macros.variables.set(slot, place);
            }
        }
    }

    fn other_place(&self, axis: Axis) -> f64 {
        self.other_value(self.axes.at, axis)
    }

    fn other_value(&self, places: Places, axis: Axis) -> f64 {
        match axis {
            Axis::C => places.c.to_degrees(),
            Axis::Y => places.y.to_mm() / self.unit_mm(),
            Axis::B => places.b.to_degrees(),
            Axis::X | Axis::Z | Axis::None => 0.0,
        }
    }

    /// A value of the offset in force; nothing without one.
    fn active_offset(&self, table: OffsetTable, axis: Axis) -> f64 {
        let field = match axis {
            Axis::X => OffsetField::X,
            Axis::Z => OffsetField::Z,
            Axis::Y => OffsetField::Y,
            Axis::C | Axis::B | Axis::None => return 0.0,
        };
        let by_tool = table == OffsetTable::Geometry && self.settings.offsets.geometry_by_tool_number;
        let number = if by_tool { self.modal.tool } else { self.modal.offset };
        self.offset_value(table, field, number).map_or(0.0, |length| length.to_mm() / self.unit_mm())
    }

    /// The axis that a position variable stands for.
    pub(super) fn position_axis(&self, place: u32) -> Axis {
        match (self.control.policies.position_variables, place) {
            (_, 0) => Axis::X,
            (PositionVariables::XThenZ, 1) | (PositionVariables::XThenYThenZ, 2) => Axis::Z,
            (PositionVariables::XThenYThenZ, 1) => Axis::Y,
            (PositionVariables::XThenYThenZ, 3) => Axis::C,
            (PositionVariables::XThenYThenZ, _) => Axis::None,
            // The axes that the machine has, in the usual order of builders.
            (PositionVariables::XThenZ, place) => {
                let machine = &self.axes.machine;
                let others = [
                    (machine.c.is_some(), Axis::C),
                    (machine.y.is_some(), Axis::Y),
                    (machine.b.is_some(), Axis::B),
                ];
                let present = others.iter().filter(|(is_there, _)| *is_there);
                present.map(|(_, axis)| *axis).nth(place as usize - 2).unwrap_or(Axis::None)
            }
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
        self.is_plain = false;
        if let Some(slot) = self.macros.variables.slot(variable) {
            if self.macros.is_protected(slot) {
                return Err(alarm(self, "variable-write-protected"));
            }
            let value = self.macros.machine.arithmetic.stored(value);
            self.macros.variables.set(slot, value);
            return Ok(());
        }
        self.count_idle(limits::IDLE_LOOK_UPS)?;
        let Some(variable) = whole_number(variable) else {
            return Err(alarm(self, "variable-number-illegal"));
        };
        if variable == 0 {
            return Err(alarm(self, "variable-write-protected"));
        }
        if let Some(inner) = self.indirect(variable) {
            let held = number(self.read_variable(inner, environment)?);
            if self.is_indirect(held) {
                return Err(alarm(self, "variable-number-illegal"));
            }
            return self.write_variable(held, value, place, environment);
        }
        match self.write_system(variable, number(value), environment)? {
            Written::Done => Ok(()),
            Written::ReadOnly => Err(alarm(self, "variable-write-protected")),
            Written::OutOfRange => Err(alarm(self, "argument-out-of-range")),
            Written::OffsetOutOfRange => Err(alarm(self, "offset-data-out-of-range")),
            Written::Unknown => Err(alarm(self, "variable-number-illegal")),
        }
    }

    /// Which switches of the panel the program has put out of action.
    pub(crate) fn panel_lock(&self) -> PanelLock {
        let flags = self.macros.state.hold;
        PanelLock { hold: flags & HOLD_OFF != 0, feed_override: flags & OVERRIDE_OFF != 0, dry_run: false }
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
            3004 => {
                let Some(flags) = flags(7) else { return Ok(Written::OutOfRange) };
                let before = std::mem::replace(&mut state.hold, flags);
                if (before ^ flags) & (HOLD_OFF | OVERRIDE_OFF) != 0 {
                    self.emit(Action::PanelLock(self.panel_lock()));
                }
            }
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
                self.stop_reading_ahead()?;
                self.sync = Some(SyncReason::CycleStart);
            }
            1000..=1033 | 3007 | 3011 | 3012 | 4001..=4130 | 5001..=5128 => return Ok(Written::ReadOnly),
            _ => return Ok(self.write_stored(variable, value).unwrap_or(Written::Unknown)),
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

/// Feed hold is switched off: a bit of `#3004`.
const HOLD_OFF: u8 = 1;

/// So is the feed override.
const OVERRIDE_OFF: u8 = 2;

/// Longest text of a message.
const COMMENT_CHARACTERS_MAX: usize = 80;

/// What writing a system variable came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Written {
    Done,
    ReadOnly,
    OutOfRange,
    /// More than an offset or a zero can hold.
    OffsetOutOfRange,
    Unknown,
}

fn whole_number(variable: f64) -> Option<u32> {
    let rounded = variable.round();
    ((variable - rounded).abs() < 1e-6 && (0.0..100_000.0).contains(&rounded)).then_some(rounded as u32)
}

fn inputs(environment: &dyn Environment, count: u8) -> u32 {
    (0..count).filter(|signal| environment.macro_input(*signal)).fold(0, |word, signal| word | 1 << signal)
}

/// The address whose last value a variable holds.
const fn modal_address(variable: u32) -> Option<u8> {
    Some(match variable {
        4102 => b'B',
        4107 => b'D',
        4109 => b'F',
        4111 => b'H',
        4113 => b'M',
        4114 => b'N',
        4115 => b'O',
        4119 => b'S',
        4120 => b'T',
        4130 => b'P',
        _ => return None,
    })
}
