//! Target points from absolute and incremental words.

use turnwright_control::policy::AxisWordConflict;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Word};
use turnwright_units::{LeastIncrement, Length, Position, WorkTip};

use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

impl Core {
    /// The end point that the X, Z, U and W words of a block ask for, from the present position.
    #[inline]
    pub(crate) fn target(&mut self, block: &Block) -> Result<Position<WorkTip>, Alarm> {
        let from = self.modal.position;
        let to = self.target_from(block, from)?;
        if self.is_in_range(to) { Ok(to) } else { Err(self.out_of_range(Some(block), to)) }
    }

    /// As [`Core::target`], with increments counted from `from`.
    #[inline]
    fn target_from(&mut self, block: &Block, from: Position<WorkTip>) -> Result<Position<WorkTip>, Alarm> {
        let mut to = from;
        const CROSS: u32 = Block::bit(b'X') | Block::bit(b'U');
        const ALONG: u32 = Block::bit(b'Z') | Block::bit(b'W');
        if self.untaken.is_some() {
            self.take_movement(block.present() & CROSS != 0, block.present() & ALONG != 0);
        }
        if block.present() & CROSS != 0 {
            let (word, is_increment) = self.axis_word(block, b'X', b'U')?;
            to.x = if is_increment {
                from.x + self.radius(word, Role::XIncrement)?
            } else {
                self.radius(word, Role::XCoordinate)?
            };
            self.missing_point(word);
        }
        if block.present() & ALONG != 0 {
            let (word, is_increment) = self.axis_word(block, b'Z', b'W')?;
            let length = self.length(word)?;
            to.z = if is_increment { from.z + length } else { length };
            self.missing_point(word);
        }
        Ok(to)
    }

    /// The word that counts for an axis, and whether it is an increment.
    #[inline]
    pub(crate) fn axis_word<'b>(
        &mut self,
        block: &'b Block,
        absolute: u8,
        increment: u8,
    ) -> Result<(&'b Word, bool), Alarm> {
        let lists_increments = self.dispatch.has_incremental_words;
        match (block.word(absolute), block.word(increment)) {
            (Some(word), None) => Ok((word, self.modal.is_incremental)),
            (None, Some(word)) if lists_increments => Ok((word, true)),
            (Some(absolute), Some(increment)) if lists_increments => {
                self.warn("absolute-and-increment-together", increment);
                let later = match self.control.policies.axis_word_conflict {
                    AxisWordConflict::LaterWord => increment.start > absolute.start,
                    AxisWordConflict::AbsoluteWins => false,
                };
                Ok(if later { (increment, true) } else { (absolute, false) })
            }
            (_, Some(word)) => Err(self.alarm("illegal-address", word)),
            (None, None) => Err(self.alarm_block("arc-endpoint-missing")),
        }
    }

    /// Warns about a length that looks as if its point were forgotten.
    #[inline]
    pub(crate) fn missing_point(&mut self, word: &Word) {
        self.missing_point_of(word, self.modal.increment(&self.settings));
    }

    /// The same for a value of the offset tables.
    pub(crate) fn missing_offset_point(&mut self, word: &Word) {
        self.missing_point_of(word, self.offset_increment());
    }

    #[inline]
    fn missing_point_of(&mut self, word: &Word, increment: LeastIncrement) {
        if let turnwright_syntax::Value::Number(number) = word.value
            && !number.has_point
            && !self.settings.is_calculator
            && number.digits != 0
        {
            self.say_missing_point(word, number.digits, increment);
        }
    }

    #[cold]
    fn say_missing_point(&mut self, word: &Word, digits: i64, increment: LeastIncrement) {
        // Above this a value without a point is a length that somebody may mean.
        const SUSPICIOUS_BELOW: i64 = 1_000;
        if digits.abs() >= SUSPICIOUS_BELOW || self.already_said_at("number-without-point", word) {
            return;
        }
        let value = increment.nm() * digits;
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::warning("number-without-point")
            .at(self.place(word))
            .with("word", quote)
            .with("value", Length::from_nm(value));
        self.say(diagnostic);
    }

    /// Whether the control can hold a place: X as a diameter.
    #[inline]
    pub(crate) fn is_in_range(&self, to: Position<WorkTip>) -> bool {
        let limit = self.settings.length_limit_nm;
        to.x.to_diameter().0.is_below(limit) && to.z.is_below(limit)
    }

    /// Refuses a computed place that the control cannot hold.
    pub(crate) fn in_range(&self, to: Position<WorkTip>) -> Result<Position<WorkTip>, Alarm> {
        if self.is_in_range(to) { Ok(to) } else { Err(self.out_of_range(None, to)) }
    }

    /// A place that the control cannot hold, at the word that asks for it; X as a diameter.
    #[cold]
    fn out_of_range(&self, block: Option<&Block>, to: Position<WorkTip>) -> Alarm {
        let diameter = to.x.to_diameter().0;
        let (value, letters) = if diameter.is_below(self.settings.length_limit_nm) {
            (to.z, [b'Z', b'W'])
        } else {
            (diameter, [b'X', b'U'])
        };
        let words = letters.into_iter().filter_map(|letter| block.and_then(|block| block.word(letter)));
        let word = words.max_by_key(|word| word.start);
        let place = word.map_or_else(|| self.block_place(), |word| self.place(word));
        self.finish(Diagnostic::alarm("position-out-of-range").at(place).with("value", value))
    }
}
