//! `data-setting`, `data-setting-end` — the program writes stored data (G10, G11).
//!
//! `G10 P_ X(U)_ Y(V)_ Z(W)_ R(C)_ Q_` writes a tool offset: P1 onward the wear, 10000 more the geometry. X, Y,
//! Z and the nose radius R replace the value, U, V, W and C add to it; Q is the direction of the tip, the same
//! for both tables. The tables may have an increment of their own (5042). Lengths follow the unit and the decimal rule of the program; X is what the offset screen
//! shows, a diameter by default.
//!
//! The new values act with the next T word, or at once by parameter (5001#6). P0 is the workpiece shift.
//!
//! `G10 L2 P_ X(U)_ Z(W)_` writes a stored zero: P0 the external offset, P1 to P6 the standard work systems;
//! `G10 L20 P_` the additional ones; other axes of the machine by their own letters. It acts at once.
//!
//! `G10 L50` (parameters; newer controls L52) and `G10 L3` (tool life) open a list that `G11` closes: see
//! `data_list.rs`.
//!
//! Source: data setting of both families; the forms of the newest generation are known at second hand.

use turnwright_control::Axis;
use turnwright_control::policy::{DataSetting, ToolInDataSetting};
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_syntax::{Block, Word};
use turnwright_units::Length;

use super::Function;
use crate::block::Call;
use crate::data_list::DataList;
use crate::machine::Core;
use crate::offsets::{OffsetFault, OffsetField, OffsetTable};
use crate::other_zeros::AxisValue;
use crate::report::Alarm;
use crate::words::Role;
use crate::zeros::{STANDARD_SYSTEMS, WorkZero};

pub(super) static DATA_SETTING: Function = Function::one_shot("data-setting", data_setting)
    .with_letters(b"PLRCQYV")
    .with_other_axes()
    .setting_data();

pub(super) static DATA_SETTING_END: Function = Function::one_shot("data-setting-end", |_, _| Ok(()));

/// Added to the number of an offset, it means the geometry.
const GEOMETRY: u32 = 10_000;

/// Pairs of letters: the value itself, an addition to it.
const COLUMNS: [(OffsetField, u8, u8); 4] = [
    (OffsetField::X, b'X', b'U'),
    (OffsetField::Y, b'Y', b'V'),
    (OffsetField::Z, b'Z', b'W'),
    (OffsetField::NoseRadius, b'R', b'C'),
];

fn data_setting(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    if let Some(word) = block.word(b'T')
        && core.control.policies.tool_in_data_setting == ToolInDataSetting::Foreign
    {
        return Err(core.alarm("data-setting-words-illegal", word));
    }
    let forms = core.control.policies.data_setting;
    let list = match block.word(b'L') {
        None if forms == DataSetting::ListsOnly => {
            return Err(core.alarm_at("data-setting-format", call.word));
        }
        None => {
            core.set_offset(block, call.word)?;
            None
        }
        Some(word) => match (core.whole(word, 99)?, forms) {
            (2 | 20, DataSetting::WithOldCode | DataSetting::WithEitherCode) => {
                core.set_work_zeros(block, word)?;
                None
            }
            (3, _) => Some(core.open_tool_life(block)?),
            (50, DataSetting::WithOldCode | DataSetting::WithEitherCode) => Some(DataList::Parameters),
            (52, DataSetting::WithEitherCode) => Some(DataList::ParametersAndBits),
            (52, DataSetting::ListsOnly) => Some(DataList::ParametersAndVariables),
            _ => return Err(core.alarm("data-setting-format", word)),
        },
    };
    if let Some(list) = list {
        core.refuse_other_words(block, b"GNLP")?;
        core.data_list = Some(list);
    }
    core.say_that_data_changes();
    Ok(())
}

impl Core {
    fn say_that_data_changes(&mut self) {
        if !self.already_said("data-setting-at-run", 0) {
            let place = self.block_place();
            self.say(Diagnostic::new(Severity::Note, "data-setting-at-run").at(place));
        }
    }

    /// `G10 P_` without L: a row of an offset table.
    fn set_offset(&mut self, block: &Block, code: Option<&Word>) -> Result<(), Alarm> {
        let Some(target) = block.word(b'P') else { return Err(self.alarm_at("data-setting-format", code)) };
        let (table, number) = match self.whole(target, 99_999)? {
            0 => return self.write_work_zero(block, WorkZero::WorkpieceShift, target),
            number @ GEOMETRY.. => (OffsetTable::Geometry, number - GEOMETRY),
            number => (OffsetTable::Wear, number),
        };
        let at = |core: &Self, fault: OffsetFault, word: &Word| match fault {
            OffsetFault::Number => core.alarm(fault.key(), target),
            OffsetFault::Value => core.alarm(fault.key(), word),
        };
        let mut is_empty = true;
        if let Some(word) = block.words.iter().find(|word| matches!(word.address, b'H' | b'B' | b'J')) {
            return Err(self.alarm("data-setting-words-illegal", word));
        }
        for (field, absolute, increment) in COLUMNS {
            if !block.has(absolute) && !block.has(increment) {
                continue;
            }
            is_empty = false;
            let (word, is_increment) = self.axis_word(block, absolute, increment)?;
            let length = self.offset_length(word)?;
            self.missing_offset_point(word);
            let value = if is_increment {
                self.increased_offset(table, field, number, length).map_err(|fault| at(self, fault, word))?
            } else {
                length
            };
            self.store_offset_value(table, field, number, value).map_err(|fault| at(self, fault, word))?;
        }
        if let Some(word) = block.word(b'Q') {
            is_empty = false;
            let tip = u8::try_from(self.whole(word, 99)?).unwrap_or(u8::MAX);
            self.store_offset_tip(number, tip).map_err(|fault| at(self, fault, word))?;
        }
        if is_empty {
            return Err(self.alarm_at("data-setting-format", code));
        }
        self.after_offset_change(number);
        Ok(())
    }

    /// `G10 L2 P_` and `G10 L20 P_`: a stored zero.
    fn set_work_zeros(&mut self, block: &Block, list: &Word) -> Result<(), Alarm> {
        let Some(target) = block.word(b'P') else { return Err(self.alarm("data-setting-format", list)) };
        let number = self.whole(target, 99_999)? as usize;
        let zero = match (self.whole(list, 99)?, number) {
            (2, 0) => WorkZero::External,
            (2, 1..=STANDARD_SYSTEMS) => WorkZero::System(number - 1),
            (20, 1..) => WorkZero::additional(number),
            _ => return Err(self.alarm("data-setting-format", target)),
        };
        self.write_work_zero(block, zero, target)
    }

    /// Writes the axes that the block names into a stored zero.
    fn write_work_zero(&mut self, block: &Block, zero: WorkZero, target: &Word) -> Result<(), Alarm> {
        let is_axis = |word: &Word| self.axes.letters & Block::bit(word.address) != 0 && word.address != b'J';
        let is_own = |word: &Word| b"GNLPXZUWTSMF".contains(&word.address) || is_axis(word);
        if let Some(word) = block.words.iter().find(|word| word.comma || !is_own(word)) {
            return Err(self.alarm("data-setting-words-illegal", word));
        }
        let mut values: Vec<(Axis, Length)> = Vec::new();
        for (axis, absolute, increment) in [(Axis::X, b'X', b'U'), (Axis::Z, b'Z', b'W')] {
            if !block.has(absolute) && !block.has(increment) {
                continue;
            }
            let (word, is_increment) = self.axis_word(block, absolute, increment)?;
            self.missing_point(word);
            let value = if axis == Axis::X {
                self.radius(word, Role::XCoordinate)?.to_diameter().0
            } else {
                self.length(word)?
            };
            let Some(before) = self.work_zero(zero, axis) else {
                return Err(self.alarm("data-setting-format", target));
            };
            let value = if is_increment { before + value } else { value };
            if !value.is_below(self.settings.length_limit_nm) {
                return Err(self.alarm("data-out-of-range", word));
            }
            values.push((axis, value));
        }
        for AxisValue { axis, word, is_increment, value } in self.other_values(block)? {
            let Some(before) = self.work_zero(zero, axis) else {
                return Err(self.alarm("data-setting-format", target));
            };
            let value = if is_increment { before + value } else { value };
            if !value.is_below(self.settings.length_limit_nm) {
                return Err(self.alarm("data-out-of-range", word));
            }
            values.push((axis, value));
        }
        if values.is_empty() {
            return Err(self.alarm("data-setting-format", target));
        }
        self.with_new_zero(|core| {
            for (axis, value) in values {
                core.zeros.set(zero, axis, value);
            }
        });
        Ok(())
    }

    /// Refuses every word whose letter is not listed.
    pub(crate) fn refuse_other_words(&self, block: &Block, letters: &[u8]) -> Result<(), Alarm> {
        match block.words.iter().find(|word| word.comma || !letters.contains(&word.address)) {
            Some(word) => Err(self.alarm("data-setting-words-illegal", word)),
            None => Ok(()),
        }
    }
}
