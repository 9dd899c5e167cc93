//! T words: station and offset.
//!
//! The last two digits are the offset (the last one by parameter), the rest is the station. Offsets move the
//! zero of the work system, so that the tip's coordinates are right from the T word on; the small move that a
//! wear value causes on a machine is not a command of its own.

use turnwright_canon::Action;
use turnwright_syntax::Word;

use crate::machine::Core;
use crate::report::Alarm;

impl Core {
    /// A tool word.
    pub(crate) fn tool_word(&mut self, word: &Word) -> Result<(), Alarm> {
        let number = self.whole(word, 99_999_999)?;
        self.modal.in_force.tool = Some(number);
        let split = if self.settings.offset_digits_one { 10 } else { 100 };
        let (tool, offset) = (number / split, number % split);
        if offset > self.control.limits.offset_number_max {
            return Err(self.alarm("offset-number-illegal", word));
        }
        self.with_new_zero(|core| {
            if tool != 0 {
                core.modal.tool = tool;
            }
            core.modal.offset = offset;
        });
        self.emit(Action::Tool { tool: self.modal.tool, offset });
        Ok(())
    }
}
