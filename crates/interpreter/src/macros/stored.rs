//! System variables behind which a stored value stands: tool offsets, work zeros, part counts.
//!
//! One table says which number means which value; reading and writing share it. Source: system variables of
//! custom macro, lathe; the extended banks of the newer controls.

use turnwright_control::Axis as WorkAxis;
use turnwright_control::policy::{WorkShiftVariables, WorkZeroVariables};
use turnwright_units::{LeastIncrement, Length, Radius};

use super::system::{Axis, Written};
use crate::machine::Core;
use crate::offsets::{OffsetFault, OffsetField, OffsetTable};
use crate::zeros::WorkZero;

/// A value that is stored outside the variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stored {
    Offset(OffsetTable, OffsetField, u32),
    Tip(u32),
    Zero(WorkZero, WorkAxis),
    /// The zero of an axis that has none here.
    NoZero,
    PartsMade,
    PartsWanted,
}

/// Banks of offset variables: first and last number, table, column; the first belongs to offset 1.
const BANKS: [(u32, u32, OffsetTable, OffsetField); 8] = [
    (2001, 2064, OffsetTable::Wear, OffsetField::X),
    (2101, 2164, OffsetTable::Wear, OffsetField::Z),
    (2201, 2264, OffsetTable::Wear, OffsetField::NoseRadius),
    (2401, 2449, OffsetTable::Wear, OffsetField::Y),
    (2451, 2499, OffsetTable::Geometry, OffsetField::Y),
    (2701, 2749, OffsetTable::Geometry, OffsetField::X),
    (2801, 2849, OffsetTable::Geometry, OffsetField::Z),
    (2901, 2964, OffsetTable::Geometry, OffsetField::NoseRadius),
];

/// The same for controls with more offsets than these banks reach.
const EXTENDED_BANKS: [(u32, OffsetTable, OffsetField); 8] = [
    (10_001, OffsetTable::Wear, OffsetField::X),
    (11_001, OffsetTable::Wear, OffsetField::Z),
    (12_001, OffsetTable::Wear, OffsetField::NoseRadius),
    (14_001, OffsetTable::Wear, OffsetField::Y),
    (15_001, OffsetTable::Geometry, OffsetField::X),
    (16_001, OffsetTable::Geometry, OffsetField::Z),
    (17_001, OffsetTable::Geometry, OffsetField::NoseRadius),
    (19_001, OffsetTable::Geometry, OffsetField::Y),
];

/// Offsets that the first banks reach.
const SHORT_BANK: u32 = 64;
/// Variables of an extended bank.
const LONG_BANK: u32 = 999;
/// From one work system to the next.
const SYSTEM_STEP: u32 = 20;

impl Core {
    fn stored(&self, variable: u32) -> Option<Stored> {
        let bank = BANKS.iter().find(|(first, last, ..)| (*first..=*last).contains(&variable));
        if let Some((first, _, table, field)) = bank {
            return Some(Stored::Offset(*table, *field, variable - first + 1));
        }
        if self.control.limits.offset_number_max > SHORT_BANK {
            let bank =
                EXTENDED_BANKS.iter().find(|(first, ..)| (*first..first + LONG_BANK).contains(&variable));
            if let Some((first, table, field)) = bank {
                return Some(Stored::Offset(*table, *field, variable - first + 1));
            }
            if (13_001..13_001 + LONG_BANK).contains(&variable) {
                return Some(Stored::Tip(variable - 13_000));
            }
        }
        let z_shift = match self.control.policies.work_shift_variables {
            WorkShiftVariables::HundredApart => 2601,
            WorkShiftVariables::Neighbours => 2502,
        };
        Some(match variable {
            2301..=2364 => Stored::Tip(variable - 2300),
            2501 => Stored::Zero(WorkZero::WorkpieceShift, WorkAxis::X),
            _ if variable == z_shift => Stored::Zero(WorkZero::WorkpieceShift, WorkAxis::Z),
            2550 => Stored::Zero(WorkZero::External, WorkAxis::X),
            2551..=2556 => Stored::Zero(WorkZero::System((variable - 2551) as usize), WorkAxis::X),
            2650 => Stored::Zero(WorkZero::External, WorkAxis::Z),
            2651..=2656 => Stored::Zero(WorkZero::System((variable - 2651) as usize), WorkAxis::Z),
            3901 => Stored::PartsMade,
            3902 => Stored::PartsWanted,
            5201..=5328 => {
                let (system, place) = ((variable - 5201) / SYSTEM_STEP, (variable - 5201) % SYSTEM_STEP);
                let zero =
                    if system == 0 { WorkZero::External } else { WorkZero::System(system as usize - 1) };
                return self.zero_of(zero, place);
            }
            7001..=7960 => {
                let (system, place) = ((variable - 7001) / SYSTEM_STEP, (variable - 7001) % SYSTEM_STEP);
                return self.zero_of(WorkZero::additional(system as usize + 1), place);
            }
            _ => return None,
        })
    }

    /// The zero of an axis by its place in the numbers of position variables.
    fn zero_of(&self, zero: WorkZero, place: u32) -> Option<Stored> {
        self.work_zero(zero, WorkAxis::X)?;
        if place >= 8 {
            return None;
        }
        Some(match self.position_axis(place) {
            Axis::X => Stored::Zero(zero, WorkAxis::X),
            Axis::Z => Stored::Zero(zero, WorkAxis::Z),
            Axis::C => Stored::Zero(zero, WorkAxis::C),
            Axis::Y => Stored::Zero(zero, WorkAxis::Y),
            Axis::B => Stored::Zero(zero, WorkAxis::B),
            Axis::None => Stored::NoZero,
        })
    }

    /// A stored value, in the unit of the program; `None` when the number means none.
    pub(super) fn read_stored(&self, variable: u32) -> Option<f64> {
        let length = |length: Length| length.to_mm() / self.unit_mm();
        Some(match self.stored(variable)? {
            Stored::Offset(table, field, number) => length(self.offset_value(table, field, number).ok()?),
            Stored::Tip(number) => f64::from(self.offset_tip(number).ok()?),
            Stored::Zero(zero, axis @ (WorkAxis::C | WorkAxis::B)) => self.work_zero(zero, axis)?.to_mm(),
            Stored::Zero(zero, axis) => {
                length(self.work_zero(zero, axis)?) / if self.is_radius(axis) { 2.0 } else { 1.0 }
            }
            Stored::NoZero => 0.0,
            Stored::PartsMade => f64::from(self.parts.made),
            Stored::PartsWanted => f64::from(self.parts.wanted),
        })
    }

    /// Stores a value; `None` when the number means none.
    pub(super) fn write_stored(&mut self, variable: u32, value: f64) -> Option<Written> {
        let stored = self.stored(variable)?;
        let increment = match stored {
            Stored::Offset(..) => self.offset_increment(),
            _ => self.modal.increment(&self.settings),
        };
        // Degrees know no inch.
        let (unit_mm, increment) = match stored {
            Stored::Zero(_, WorkAxis::C | WorkAxis::B) => (1.0, self.settings.metric_increment),
            _ => (self.unit_mm(), increment),
        };
        let length = Length::from_mm_rounded(value * unit_mm, increment);
        let is_count = (0.0..=f64::from(u32::MAX)).contains(&value.round());
        Some(match stored {
            Stored::Offset(table, field, number) => match length {
                Some(length) => offset_written(self.set_offset_value(table, field, number, length)),
                None => Written::OffsetOutOfRange,
            },
            Stored::Tip(number) => {
                let tip = if (0.0..=9.0).contains(&value.round()) { value.round() as u8 } else { u8::MAX };
                offset_written(self.set_offset_tip(number, tip))
            }
            Stored::Zero(..) | Stored::NoZero
                if (5201..=5328).contains(&variable)
                    && self.control.policies.work_zero_variables == WorkZeroVariables::ReadOnly =>
            {
                Written::ReadOnly
            }
            Stored::Zero(zero, axis) => match length.filter(|length| self.is_zero_value(*length)) {
                Some(length) => match self.set_work_zero(zero, axis, self.zero_stored(axis, length)) {
                    Some(()) => Written::Done,
                    None => Written::Unknown,
                },
                None => Written::OffsetOutOfRange,
            },
            Stored::NoZero => Written::Unknown,
            Stored::PartsMade if is_count => {
                self.parts.made = value.round() as u32;
                Written::Done
            }
            Stored::PartsWanted if is_count => {
                self.parts.wanted = value.round() as u32;
                Written::Done
            }
            Stored::PartsMade | Stored::PartsWanted => Written::OutOfRange,
        })
    }

    fn is_radius(&self, axis: WorkAxis) -> bool {
        axis == WorkAxis::X && self.settings.x_is_radius
    }

    /// Zeros are kept with X as a diameter.
    fn zero_stored(&self, axis: WorkAxis, value: Length) -> Length {
        if self.is_radius(axis) { Radius(value).to_diameter().0 } else { value }
    }

    fn is_zero_value(&self, length: Length) -> bool {
        length.is_below(self.settings.length_limit_nm)
    }

    /// Millimetres in the unit of the program.
    pub(super) fn unit_mm(&self) -> f64 {
        if self.modal.is_inch { LeastIncrement::INCH_B.to_mm() * 10_000.0 } else { 1.0 }
    }
}

fn offset_written(result: Result<(), OffsetFault>) -> Written {
    match result {
        Ok(()) => Written::Done,
        Err(OffsetFault::Number) => Written::Unknown,
        Err(OffsetFault::Value) => Written::OffsetOutOfRange,
    }
}
