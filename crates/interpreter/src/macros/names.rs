//! System variables by name, parameters and axis numbers in expressions: what the newest controls add.
//!
//! `[#_ABSIO[1]]` is `#5001`, `[#_DATE]` is `#3011`: a name stands for a number, a subscript counts from it. `PRM[n]`
//! is the value of a parameter, `PRM[n,b]` one of its bits, `/[a]` behind either picks the axis. `AXNUM[Z]` is the number
//! that an axis has in subscripts, and `AX[n]=value` is the word of the axis with a number. Which names exist is from memory; they are those of variables that exist here.
//!
//! Source: functions of custom macro, newest lathe controls.

use turnwright_control::Axis as ParameterAxis;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Fault, FaultKind, parse_expression};

use super::system::Axis;
use super::variables::is_null;
use crate::Environment;
use crate::machine::{Core, Halt};

/// Names, the number that they stand for, and whether a subscript is added to it.
const NAMES: [(&[u8], u32, bool); 47] = [
    (b"UI", 1000, true),
    (b"UIW", 1032, true),
    (b"UO", 1100, true),
    (b"UOW", 1132, true),
    (b"ALM", 3000, false),
    (b"CLOCK1", 3001, false),
    (b"CLOCK2", 3002, false),
    (b"CNTL1", 3003, false),
    (b"CNTL2", 3004, false),
    (b"SETDT", 3005, false),
    (b"MSGSTP", 3006, false),
    (b"MRIMG", 3007, false),
    (b"DATE", 3011, false),
    (b"TIME", 3012, false),
    (b"PARTSN", 3901, false),
    (b"PARTSR", 3902, false),
    (b"BUFG", 4000, true),
    (b"BUFB", 4102, false),
    (b"BUFD", 4107, false),
    (b"BUFF", 4109, false),
    (b"BUFH", 4111, false),
    (b"BUFM", 4113, false),
    (b"BUFN", 4114, false),
    (b"BUFO", 4115, false),
    (b"BUFS", 4119, false),
    (b"BUFT", 4120, false),
    (b"BUFWZP", 4130, false),
    (b"ABSIO", 5000, true),
    (b"ABSMT", 5020, true),
    (b"ABSOT", 5040, true),
    (b"ABSKP", 5060, true),
    (b"SVERR", 5100, true),
    (b"WZCMN", 5200, true),
    (b"WZG54", 5220, true),
    (b"WZG55", 5240, true),
    (b"WZG56", 5260, true),
    (b"WZG57", 5280, true),
    (b"WZG58", 5300, true),
    (b"WZG59", 5320, true),
    (b"OFSXW", 10_000, true),
    (b"OFSZW", 11_000, true),
    (b"OFSRW", 12_000, true),
    (b"OFST", 13_000, true),
    (b"OFSYW", 14_000, true),
    (b"OFSXG", 15_000, true),
    (b"OFSZG", 16_000, true),
    (b"OFSRG", 17_000, true),
];

/// The number that a name stands for, when it is one and has a subscript just when it takes one.
pub(super) fn number_of(name: &[u8], has_subscript: bool) -> Option<u32> {
    let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
    let (_, number, takes) = NAMES.iter().find(|(known, ..)| name.eq_ignore_ascii_case(known))?;
    (*takes == has_subscript).then_some(*number)
}

impl Core {
    /// `PRM`: the value of a parameter, or of a bit of it, of an axis where each has its own.
    #[cold]
    pub(super) fn parameter_value(&self, number: f64, bit: f64, axis: f64) -> Result<f64, Halt> {
        let is_whole = |value: f64, max: f64| value.fract() == 0.0 && (0.0..=max).contains(&value);
        let axis_letter = match axis {
            _ if is_null(axis) => "",
            _ => match is_whole(axis, 8.0).then(|| self.position_axis((axis as u32).saturating_sub(1))) {
                Some(Axis::X) => ParameterAxis::X.letter(),
                Some(Axis::Z) => ParameterAxis::Z.letter(),
                Some(Axis::C) => ParameterAxis::C.letter(),
                Some(Axis::Y) => ParameterAxis::Y.letter(),
                Some(Axis::B) => ParameterAxis::B.letter(),
                _ => return Err(self.parameter_fault("argument-out-of-range")),
            },
        };
        if !is_whole(number, 99_999.0) || !(is_null(bit) || is_whole(bit, 7.0)) {
            return Err(self.parameter_fault("argument-out-of-range"));
        }
        let parameters = &self.control.parameters;
        let value = |bit: Option<u8>| {
            let bit = bit.map_or(String::new(), |bit| format!("#{bit}"));
            let address = format!("{number}{bit}");
            let of_axis = (!axis_letter.is_empty())
                .then(|| parameters.find(&format!("{address}.{axis_letter}")))
                .flatten();
            of_axis.or_else(|| parameters.find(&address)).map(|(_, _, value)| value)
        };
        let found = if is_null(bit) {
            value(None).or_else(|| {
                let bits = parameters.under_number(number as u32)?.bits;
                Some(bits.iter().filter_map(|(bit, _)| Some(value(Some(*bit))? * f64::from(1 << bit))).sum())
            })
        } else {
            value(Some(bit as u8))
        };
        found.ok_or_else(|| self.parameter_fault("parameter-not-known"))
    }

    /// `AXNUM`: the number of an axis of the machine.
    #[cold]
    pub(super) fn axis_number(&self, letter: u8) -> Result<f64, Halt> {
        let wanted = match letter {
            b'X' => Axis::X,
            b'Z' => Axis::Z,
            b'C' => Axis::C,
            b'Y' => Axis::Y,
            b'B' => Axis::B,
            _ => return Err(self.parameter_fault("illegal-address")),
        };
        match (0..8).find(|place| self.position_axis(*place) == wanted) {
            Some(place) => Ok(f64::from(place + 1)),
            None => Err(self.parameter_fault("illegal-address")),
        }
    }

    /// Gives words of axes that are named by number (`AX[n]=value`) their letters.
    #[cold]
    pub(super) fn name_axes(
        &mut self,
        block: &mut Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        for place in 0..block.words.len() {
            let word = block.words[place];
            let is_indirect =
                |fault: &&Fault| fault.kind == FaultKind::IndirectAxis && fault.start == word.start;
            if block.faults.iter().find(is_indirect).is_none() {
                continue;
            }
            let line = self.line_bytes();
            let text = &line[word.start as usize..word.end as usize];
            // The reader saw the brackets and the sign behind them.
            let equals = text.iter().position(|byte| *byte == b'=').unwrap_or(text.len());
            let bracket = |wanted| text[..equals].iter().position(|byte| *byte == wanted).unwrap_or(0) as u32;
            let last = text[..equals].iter().rposition(|byte| *byte == b']').unwrap_or(0) as u32;
            let range = word.start + bracket(b'[')..word.start + last + 1;
            let expression = match parse_expression(line, range.clone()) {
                Ok(expression) => expression,
                Err(fault) => return Err(self.expression_fault(&fault, range).into()),
            };
            let code = self.macros.machine.compile(&expression, &self.macros.variables, true);
            let code = code.map_err(|(fault, place)| self.code_fault(fault, place))?;
            let number = self.evaluate_all(code, None, environment)?;
            let axis = match number {
                _ if is_null(number) || number.fract() != 0.0 || !(1.0..=8.0).contains(&number) => Axis::None,
                _ => self.position_axis(number as u32 - 1),
            };
            let letter = match axis {
                Axis::X => b'X',
                Axis::Z => b'Z',
                Axis::C => b'C',
                Axis::Y => b'Y',
                Axis::B => b'B',
                Axis::None => return Err(self.alarm("illegal-address", &word).into()),
            };
            block.rename(place, letter);
        }
        Ok(())
    }

    fn parameter_fault(&self, key: &'static str) -> Halt {
        let place = self.macros.machine.fault_place();
        let quote = self.quote(place.start, place.end);
        let diagnostic = Diagnostic::alarm(key).at(self.at.span(place.start, place.end));
        self.finish(diagnostic.with("word", quote)).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_take_a_subscript_or_none() {
        assert_eq!(number_of(b"DATE\0\0\0\0", false), Some(3011));
        assert_eq!(number_of(b"DATE\0\0\0\0", true), None);
        assert_eq!(number_of(b"absio\0\0\0", true), Some(5000));
        assert_eq!(number_of(b"ABSIO\0\0\0", false), None);
        assert_eq!(number_of(b"ABSI\0\0\0\0", true), None);
    }
}
