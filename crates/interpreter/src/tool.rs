//! T words: station and offset.
//!
//! The last digits of T are the offset number, those before them the station: two digits by default, one by
//! parameter (5002#0), or as many as 5028 says. Offset number 0 cancels. The geometry has the offset number, or
//! that of the station by parameter (5002#1); with offset 00 a geometry that shifts the coordinates stays,
//! unless 5002#5 takes it away too. What the offset then does stands in `offsets.rs`.
//!
//! Source: tool selection and tool offset of both families.

use turnwright_canon::Action;
use turnwright_control::policy::ShortToolWord;
use turnwright_syntax::{Value, Word};

use crate::machine::Core;
use crate::report::Alarm;

/// Most digits that any control takes.
const DIGITS_MAX: u32 = 99_999_999;

impl Core {
    /// A tool word.
    pub(crate) fn tool_word(&mut self, word: &Word) -> Result<(), Alarm> {
        let number = self.whole(word, DIGITS_MAX)?;
        self.modal.in_force.tool = Some(number);
        let settings = self.settings.offsets;
        if number.checked_ilog10().unwrap_or(0) >= settings.tool_digits {
            return Err(self.alarm("tool-number-illegal", word));
        }
        if self.control.policies.short_tool_word == ShortToolWord::Refused
            && matches!(word.value, Value::Number(number) if !number.is_computed())
            && self.digits_written(word) < 2 * settings.number_digits
        {
            return Err(self.alarm("tool-number-illegal", word));
        }
        let split = 10u32.pow(settings.number_digits);
        let (station, offset) = (number / split, number % split);
        let tool = if station == 0 { self.modal.tool } else { station };
        let geometry = match offset {
            0 if settings.zero_takes_geometry() => 0,
            _ if settings.geometry_by_tool_number => tool,
            0 => self.modal.geometry,
            number => number,
        };
        if offset.max(geometry) > self.control.limits.offset_number_max {
            return Err(self.alarm("offset-number-illegal", word));
        }
        if tool != self.modal.tool {
            self.warn_of_compensation(Some(word));
        }
        self.modal.tool = tool;
        self.modal.offset = offset;
        self.modal.geometry = geometry;
        if !self.offset_called_is_legal() {
            return Err(self.alarm("offset-value-illegal", word));
        }
        let called = self.offset_called();
        self.with_new_zero(|core| core.modal.offset_in_force = called);
        self.emit(Action::Tool { tool, offset });
        Ok(())
    }

    /// Digits of a word as it stands in the text.
    fn digits_written(&self, word: &Word) -> u32 {
        let bytes = self.line_bytes().get(word.start as usize..word.end as usize);
        bytes.unwrap_or_default().iter().filter(|byte| byte.is_ascii_digit()).count() as u32
    }
}
