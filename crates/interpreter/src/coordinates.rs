//! Coordinate systems, and target points from absolute and incremental words.

use turnwright_control::policy::AxisWordConflict;
use turnwright_control::{AxisPair, Setup, SetupFault};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Word};
use turnwright_units::{
    Diameter, Displacement, LeastIncrement, Length, MachineTurret, Position, Radius, WorkTip,
};

use crate::machine::{Core, Zeros};
use crate::report::Alarm;
use crate::words::Role;

fn displacement(pair: AxisPair) -> Result<Displacement<MachineTurret>, SetupFault> {
    let length = |mm: f64| {
        Length::from_mm_rounded(mm, LeastIncrement::METRIC_C)
            .filter(|length| length.abs() < Length::from_mm(1_000_000))
    };
    match (length(pair.x), length(pair.z)) {
        (Some(x), Some(z)) => Ok(Displacement::new(Diameter(x).to_radius(), z)),
        _ => Err(SetupFault { message: format!("X{} Z{} is out of range", pair.x, pair.z), line: 0 }),
    }
}

impl Zeros {
    pub(crate) fn new(setup: &Setup) -> Result<Self, SetupFault> {
        let reference = displacement(setup.machine()?.reference)?;
        let mut work = [Displacement::new(Radius::ZERO, Length::ZERO); 6];
        for (name, pair) in &setup.work {
            let number: usize = name.trim_start_matches(['G', 'g']).parse().unwrap_or(0);
            match work.get_mut(number.wrapping_sub(54)) {
                Some(slot) => *slot = displacement(*pair)?,
                None => {
                    let message = format!("[work] has no coordinate system {name}; they are G54 to G59");
                    return Err(SetupFault { message, line: 0 });
                }
            }
        }
        let mut offsets = Vec::new();
        for (name, offset) in &setup.offsets {
            let Ok(number) = name.parse() else {
                let message = format!("[offsets] has no offset {name}; they are numbers");
                return Err(SetupFault { message, line: 0 });
            };
            displacement(offset.geometry)?;
            displacement(offset.wear)?;
            offsets.push((number, *offset));
        }
        // The reference point is machine zero.
        Ok(Self { base: Displacement::new(-reference.x, -reference.z), work, offsets })
    }
}

impl Core {
    /// From machine coordinates to the zero of the work system with every shift in force.
    fn zero(&self) -> Displacement<MachineTurret> {
        let mut x = self.zeros.base.x + self.zeros.work[self.modal.work].x + self.modal.preset.x;
        let mut z = self.zeros.base.z + self.zeros.work[self.modal.work].z + self.modal.preset.z;
        let geometry =
            if self.settings.geometry_by_tool_number { self.modal.tool } else { self.modal.offset };
        for (number, offset) in &self.zeros.offsets {
            for (applies, pair) in
                [(geometry == *number, offset.geometry), (self.modal.offset == *number, offset.wear)]
            {
                if applies
                    && *number != 0
                    && let Ok(shift) = displacement(pair)
                {
                    x = x + shift.x;
                    z += shift.z;
                }
            }
        }
        Displacement::new(x, z)
    }

    /// Where the reference point lies in the work system in force.
    pub(crate) fn reference_point(&self) -> Position<WorkTip> {
        let zero = self.zero();
        Position::new(-zero.x, -zero.z)
    }

    /// The tool stands at the reference point before the program starts.
    pub(crate) fn start_at_reference(&mut self) {
        self.modal.position = self.reference_point();
        self.tip = self.modal.position;
    }

    /// Changes a shift; the tool stays where it is and has new coordinates.
    pub(crate) fn with_new_zero(&mut self, change: impl FnOnce(&mut Self)) {
        let before = self.zero();
        change(self);
        let after = self.zero();
        let place = self.modal.position;
        self.modal.position = Position::new(place.x + before.x - after.x, place.z + before.z - after.z);
        if before != after {
            self.tip = Position::new(self.tip.x + before.x - after.x, self.tip.z + before.z - after.z);
            self.emit(turnwright_canon::Action::Relocate { to: self.tip, others: None });
        }
    }

    /// The end point that the X, Z, U and W words of a block ask for, from the present position.
    #[inline]
    pub(crate) fn target(&mut self, block: &Block) -> Result<Position<WorkTip>, Alarm> {
        let from = self.modal.position;
        let to = self.target_from(block, from)?;
        self.in_range(to)
    }

    /// As [`Core::target`], with increments counted from `from`.
    #[inline]
    fn target_from(&mut self, block: &Block, from: Position<WorkTip>) -> Result<Position<WorkTip>, Alarm> {
        let mut to = from;
        const CROSS: u32 = Block::bit(b'X') | Block::bit(b'U');
        const ALONG: u32 = Block::bit(b'Z') | Block::bit(b'W');
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
    fn axis_word<'b>(
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
        if let turnwright_syntax::Value::Number(number) = word.value
            && !number.has_point
            && !self.settings.is_calculator
            && number.digits != 0
        {
            self.say_missing_point(word, number.digits);
        }
    }

    #[cold]
    fn say_missing_point(&mut self, word: &Word, digits: i64) {
        // Above this a value without a point is a length that somebody may mean.
        const SUSPICIOUS_BELOW: i64 = 1_000;
        if digits.abs() >= SUSPICIOUS_BELOW || self.already_said("number-without-point", self.at.line) {
            return;
        }
        let value = self.modal.increment(&self.settings).nm() * digits;
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::warning("number-without-point")
            .at(self.place(word))
            .with("word", quote)
            .with("value", Length::from_nm(value));
        self.say(diagnostic);
    }

    /// Refuses a place that the control cannot hold.
    #[inline]
    pub(crate) fn in_range(&self, to: Position<WorkTip>) -> Result<Position<WorkTip>, Alarm> {
        let limit = self.settings.length_limit_nm;
        if to.x.0.abs().nm() < limit && to.z.abs().nm() < limit { Ok(to) } else { Err(self.out_of_range(to)) }
    }

    #[cold]
    fn out_of_range(&self, to: Position<WorkTip>) -> Alarm {
        let value = if to.z.abs() > to.x.0.abs() { to.z } else { to.x.0 };
        let diagnostic =
            Diagnostic::alarm("position-out-of-range").at(self.block_place()).with("value", value);
        self.finish(diagnostic)
    }
}
