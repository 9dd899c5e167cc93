//! Zeros of the axes beyond X and Z: stored and added up as those of X and Z are.
//!
//! In the tables a degree of an axis that turns stands as a millimetre, as it does in the parameters.
//!
//! Source: coordinate systems of both families; the rotary axes have zeros of their own in every work system.

use turnwright_control::{Axis, Control, MachineAxes, Setup, SetupFault};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Angle, LeastIncrement, Length};

use crate::axes::Places;
use crate::machine::Core;
use crate::report::Alarm;
use crate::zeros::{REFERENCE_PARAMETERS, WORK_PARAMETERS, WorkZero};

/// The zeros and shifts of C, Y and B.
#[derive(Clone, Debug)]
pub(crate) struct OtherZeros {
    /// From machine zero to the zero of a work system whose offset is nothing: the machine's affair.
    base: Places,
    external: Places,
    /// The standard systems, then the additional ones.
    systems: Vec<Places>,
    workpiece_shift: Places,
    /// Shift by coordinate setting, in every system.
    pub(crate) preset: Places,
    /// The local zero, in every system.
    pub(crate) local: Places,
    /// The reference points 1 to 4, machine coordinates.
    pub(crate) reference: [Places; 4],
}

impl Places {
    /// The value of an axis.
    pub(crate) fn value(&self, axis: Axis) -> Length {
        match axis {
            Axis::C => Length::from_nm(self.c.nanodegrees() / 1_000),
            Axis::B => Length::from_nm(self.b.nanodegrees() / 1_000),
            Axis::Y => self.y,
            Axis::X | Axis::Z => Length::ZERO,
        }
    }

    /// Puts the value of an axis in; X and Z are elsewhere.
    pub(crate) fn put(&mut self, axis: Axis, value: Length) {
        let angle = Angle::from_nanodegrees(value.nm() * 1_000);
        match axis {
            Axis::C => self.c = angle,
            Axis::B => self.b = angle,
            Axis::Y => self.y = value,
            Axis::X | Axis::Z => {}
        }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self { c: self.c + other.c, y: self.y + other.y, b: self.b + other.b }
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self { c: self.c - other.c, y: self.y - other.y, b: self.b - other.b }
    }

    /// Takes the values of these axes away; gives what they were.
    pub(crate) fn clear(&mut self, axes: impl Iterator<Item = Axis>) -> Self {
        let mut was = Self::default();
        for axis in axes {
            was.put(axis, self.value(axis));
            self.put(axis, Length::ZERO);
        }
        was
    }
}

impl OtherZeros {
    /// What parameters and machine give; the setup's own zeros come later.
    pub(crate) fn new(control: &Control, systems: usize, machine: &MachineAxes) -> Self {
        let length = |mm: f64| Length::from_mm_rounded(mm, LeastIncrement::METRIC_C).unwrap_or(Length::ZERO);
        let axes = Axis::OTHERS.into_iter().filter(|axis| machine.number(*axis).is_some());
        let parameter = |name: &str| {
            let mut places = Places::default();
            for axis in axes.clone() {
                places.put(axis, length(control.parameters.axis_value(name, axis)));
            }
            places
        };
        let mut seen = Places::default();
        let degrees = |axis: &Option<turnwright_control::RotaryAxis>| {
            length(axis.as_ref().map_or(0.0, |axis| axis.reference_deg))
        };
        seen.put(Axis::C, degrees(&machine.c));
        seen.put(Axis::B, degrees(&machine.b));
        seen.put(Axis::Y, length(machine.y.as_ref().map_or(0.0, |axis| axis.reference_mm)));
        let reference = REFERENCE_PARAMETERS.map(parameter);
        let mut stored: Vec<Places> = WORK_PARAMETERS.iter().map(|name| parameter(name)).collect();
        stored.resize(systems, Places::default());
        Self {
            base: reference[0].minus(seen),
            external: parameter("work-zero-external"),
            systems: stored,
            workpiece_shift: Places::default(),
            preset: Places::default(),
            local: Places::default(),
            reference,
        }
    }

    /// A stored row.
    pub(crate) fn row(&mut self, zero: WorkZero) -> Option<&mut Places> {
        match zero {
            WorkZero::External => Some(&mut self.external),
            WorkZero::System(system) => self.systems.get_mut(system),
            WorkZero::WorkpieceShift => Some(&mut self.workpiece_shift),
        }
    }

    /// The stored value of an axis.
    pub(crate) fn get(&self, zero: WorkZero, axis: Axis) -> Option<Length> {
        let row = match zero {
            WorkZero::External => &self.external,
            WorkZero::System(system) => self.systems.get(system)?,
            WorkZero::WorkpieceShift => &self.workpiece_shift,
        };
        Some(row.value(axis))
    }

    /// From machine zero to the zero of a work system. `external` and `shift` say which way these two go.
    pub(crate) fn of_work(
        &self,
        system: usize,
        external_is_opposite: bool,
        shift_moves_zero: bool,
    ) -> Places {
        let signed = |zero: Places, shift: Places, adds: bool| {
            if adds { zero.plus(shift) } else { zero.minus(shift) }
        };
        let zero = self.base.plus(self.systems.get(system).copied().unwrap_or_default());
        let zero = signed(zero, self.external, !external_is_opposite);
        signed(zero, self.workpiece_shift, shift_moves_zero).plus(self.preset).plus(self.local)
    }
}

/// Refuses parameters of axes that the machine does not have.
pub(crate) fn refuse_axes_not_there(control: &Control, machine: &MachineAxes) -> Result<(), SetupFault> {
    let missing = Axis::OTHERS.into_iter().filter(|axis| machine.number(*axis).is_none());
    match missing.into_iter().find_map(|axis| Some((axis, control.parameters.stated_for(axis)?))) {
        None => Ok(()),
        Some((axis, number)) => {
            let (letter, key) = (axis.letter(), axis.letter().to_lowercase());
            let message =
                format!("parameter {number}: the machine has no axis {letter}; [axes.{key}] gives it one");
            Err(SetupFault { message, line: 0 })
        }
    }
}

/// Refuses zeros of a setup for axes that the machine does not have.
pub(crate) fn take_setup_zeros(
    zeros: &mut OtherZeros,
    setup: &Setup,
    machine: &MachineAxes,
) -> Result<(), SetupFault> {
    for (name, row) in &setup.work {
        let Some(zero) = WorkZero::named(name) else { continue };
        for axis in Axis::OTHERS {
            let value = row.value(axis);
            if value == 0.0 {
                continue;
            }
            let fault = |why: &str| SetupFault { message: format!("[work] {name}: {why}"), line: 0 };
            if machine.number(axis).is_none() {
                return Err(fault(&format!("the machine has no axis {}", axis.letter())));
            }
            let value = Length::from_mm_rounded(value, LeastIncrement::METRIC_C)
                .filter(|value| value.abs() < Length::from_mm(1_000_000))
                .ok_or_else(|| fault(&format!("{}{value} is out of range", axis.letter())))?;
            let before = zeros.get(zero, axis).unwrap_or(Length::ZERO);
            if !before.is_zero() && before != value {
                return Err(fault("one value here and another one by parameter"));
            }
            if let Some(row) = zeros.row(zero) {
                row.put(axis, value);
            }
        }
    }
    Ok(())
}

/// A word that gives an axis beyond X and Z a value in a table.
pub(crate) struct AxisValue<'b> {
    pub(crate) axis: Axis,
    pub(crate) word: &'b Word,
    pub(crate) is_increment: bool,
    pub(crate) value: Length,
}

impl Core {
    /// The axes beyond X and Z that a block names.
    pub(crate) fn others_named(&self, block: &Block) -> impl Iterator<Item = Axis> + use<> {
        let present = block.present() & self.axes.letters;
        let has = move |letters: &[u8]| letters.iter().any(|letter| present & Block::bit(*letter) != 0);
        let named = [(Axis::C, has(b"CH")), (Axis::Y, has(b"YV")), (Axis::B, has(b"B"))];
        named.into_iter().filter(|(_, is_named)| *is_named).map(|(axis, _)| axis)
    }

    /// The values for tables of the axes beyond X and Z that a block names.
    pub(crate) fn other_values<'b>(&mut self, block: &'b Block) -> Result<Vec<AxisValue<'b>>, Alarm> {
        let mut values = Vec::new();
        for axis in self.others_named(block) {
            let (word, is_increment) = match axis {
                Axis::C => self.axis_word(block, b'C', b'H')?,
                Axis::Y => self.axis_word(block, b'Y', b'V')?,
                _ => match block.word(b'B') {
                    Some(word) => (word, self.modal.is_incremental),
                    None => continue,
                },
            };
            let value = if axis == Axis::Y {
                self.missing_point(word);
                self.length(word)?
            } else {
                Length::from_nm(self.angle(word)?.nanodegrees() / 1_000)
            };
            values.push(AxisValue { axis, word, is_increment, value });
        }
        Ok(values)
    }
}
