//! `data-setting`, `data-setting-end` — the program writes stored data (G10, G11).
//!
//! `G10 P_ X(U)_ Y(V)_ Z(W)_ R(C)_ Q_` writes a tool offset: P1 onward the wear, 10000 more the geometry. X, Y,
//! Z and the nose radius R replace the value, U, V, W and C add to it; Q is the direction of the tip, the same
//! for both tables. Lengths follow the unit and the decimal rule of the program; X is what the offset screen
//! shows, a diameter by default.
//!
//! The new values act with the next T word, or at once by parameter (5001#6).
//!
//! Source: data setting of both families; the forms of the newest generation are known at second hand.

use turnwright_control::policy::{DataSetting, ToolInDataSetting};
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_syntax::{Block, Word};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::offsets::{OffsetFault, OffsetField, OffsetTable};
use crate::report::Alarm;

pub(super) static DATA_SETTING: Function =
    Function::one_shot("data-setting", data_setting).with_letters(b"PLRCQYV").setting_data();

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
    match block.word(b'L') {
        None if core.control.policies.data_setting == DataSetting::ListsOnly => {
            return Err(core.alarm_at("data-setting-format", call.word));
        }
        None => core.set_offset(block, call.word)?,
        Some(word) => return Err(core.not_supported("data-setting", word)),
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
            number @ GEOMETRY.. => (OffsetTable::Geometry, number - GEOMETRY),
            number => (OffsetTable::Wear, number),
        };
        let at = |core: &Self, fault: OffsetFault, word: &Word| match fault {
            OffsetFault::Number => core.alarm(fault.key(), target),
            OffsetFault::Value => core.alarm(fault.key(), word),
        };
        let mut is_empty = true;
        for (field, absolute, increment) in COLUMNS {
            if !block.has(absolute) && !block.has(increment) {
                continue;
            }
            is_empty = false;
            let (word, is_increment) = self.axis_word(block, absolute, increment)?;
            let length = self.length(word)?;
            self.missing_point(word);
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
}
