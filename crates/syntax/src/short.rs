//! Lines that are nothing but a few letters with a number each, read in one go.
//!
//! In: text that begins with a line. Out: the line's numbers by letter, and where it ends. Most lines of long programs
//! are such; every other one is left to [`scan_block`](crate::scan_block), which reads these lines too and makes the
//! same numbers of them. Not here: words with their places, which only somebody who complains needs.

use crate::lines::LineEnd;
use crate::number::{DIGITS_MAX, Decimal};
use crate::{Value, Word};

/// Places for letters: as many as there are, and more, so that every remainder is one.
const PLACES: usize = 32;

/// The numbers of one line, reused from line to line.
#[derive(Clone, Debug, Default)]
pub struct ShortLine {
    numbers: [Decimal; PLACES],
    present: u32,
    first: u8,
    first_byte: u32,
    last_byte: u32,
}

impl ShortLine {
    /// Reads the line at the start of `text` when it is one block of blanks and of words with these `letters`
    /// ([`Block::bit`](crate::Block::bit)), each at most once, and its end is in sight. `None` for any other: nothing
    /// is known then.
    #[inline]
    pub fn read(&mut self, text: &[u8], letters: u32) -> Option<LineEnd> {
        let mut left = letters;
        let (mut at, mut last_byte) = (0, 0);
        let mut byte = *text.first()?;
        loop {
            let letter = byte.wrapping_sub(b'A');
            if letter >= 26 {
                if byte != b' ' {
                    break;
                }
                at += 1;
                byte = *text.get(at)?;
                continue;
            }
            let bit = 1 << letter;
            if left & bit == 0 {
                return None;
            }
            if left == letters {
                (self.first, self.first_byte) = (b'A' + letter, at as u32);
            }
            left ^= bit;
            let (number, end, next) = number(text, at + 1)?;
            self.numbers[usize::from(letter) % PLACES] = number;
            (at, last_byte, byte) = (end, end, next);
        }
        self.present = letters ^ left;
        self.last_byte = last_byte as u32;
        if byte == b';' {
            at += 1;
            byte = *text.get(at)?;
        }
        let next = match byte {
            b'\n' => at + 1,
            b'\r' if text.get(at + 1) == Some(&b'\n') => at + 2,
            _ => return None,
        };
        Some(LineEnd { start: at, next })
    }

    /// Takes the words of a block that was read before, all of one letter each. Numbers that are not known yet have to
    /// be [`set`](Self::set).
    pub fn fill(&mut self, words: &[Word]) {
        self.present = 0;
        for word in words {
            let number = if let Value::Number(number) = word.value { number } else { Decimal::default() };
            self.set(word.address, number);
        }
        self.first = words.first().map_or(0, |word| word.address);
        self.first_byte = words.first().map_or(0, |word| word.start);
        self.last_byte = words.last().map_or(0, |word| word.end);
    }

    /// Gives a letter its number.
    #[inline]
    pub fn set(&mut self, letter: u8, number: Decimal) {
        let place = usize::from(letter.wrapping_sub(b'A')) % PLACES;
        self.present |= 1 << place;
        self.numbers[place] = number;
    }

    /// The letters of the line, bit 0 for A.
    #[inline]
    pub const fn present(&self) -> u32 {
        self.present
    }

    /// The letter of the first word, once there is one.
    #[inline]
    pub const fn first(&self) -> u8 {
        self.first
    }

    /// First byte of the first word, and first byte behind the last.
    #[inline]
    pub const fn bytes(&self) -> (u32, u32) {
        (self.first_byte, self.last_byte)
    }

    /// The number behind a letter.
    #[inline]
    pub fn number(&self, letter: u8) -> Option<&Decimal> {
        let place = usize::from(letter.wrapping_sub(b'A')) % PLACES;
        if self.present & (1 << place) != 0 { self.numbers.get(place) } else { None }
    }
}

/// A number with at most one sign, a minus, and at most one point: itself, where it ends, and the byte there.
#[inline]
fn number(text: &[u8], from: usize) -> Option<(Decimal, usize, u8)> {
    let mut at = from;
    let mut byte = *text.get(at)?;
    let is_negative = byte == b'-';
    if is_negative {
        at += 1;
        byte = *text.get(at)?;
    }
    let first = at;
    let mut value = 0i64;
    let mut digit = byte.wrapping_sub(b'0');
    while digit <= 9 {
        value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
        at += 1;
        byte = *text.get(at)?;
        digit = byte.wrapping_sub(b'0');
    }
    let mut typed = at - first;
    let mut scale = 0;
    let has_point = byte == b'.';
    if has_point {
        at += 1;
        let point = at;
        byte = *text.get(at)?;
        digit = byte.wrapping_sub(b'0');
        while digit <= 9 {
            value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
            at += 1;
            byte = *text.get(at)?;
            digit = byte.wrapping_sub(b'0');
        }
        scale = at - point;
        typed += scale;
    }
    // A letter O behind digits may stand for a zero, and is no letter of a short line.
    if typed == 0 || typed > usize::from(DIGITS_MAX) {
        return None;
    }
    let number = Decimal {
        digits: if is_negative { -value } else { value },
        scale: scale as u8,
        typed_digits: typed as u8,
        has_point,
        is_negative,
    };
    Some((number, at, byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Value, scan_block};

    const ALL: u32 = u32::MAX ^ Block::bit(b'O');

    /// What both readers make of a line; `None` where the short one leaves it.
    fn read(text: &str) -> Option<(LineEnd, ShortLine)> {
        let mut line = ShortLine::default();
        let end = line.read(text.as_bytes(), ALL)?;
        let mut block = Block::new();
        scan_block(text.as_bytes().get(..end.start)?, 0, &mut block);
        assert_eq!(block.present(), line.present(), "{text}");
        for word in &block.words {
            assert_eq!(word.value, Value::Number(*line.number(word.address)?), "{text}");
        }
        let bytes = block.words.first().zip(block.words.last());
        assert_eq!(bytes.map(|(first, last)| (first.start, last.end)), Some(line.bytes()), "{text}");
        assert!(block.faults.is_empty(), "{text}");
        Some((end, line))
    }

    #[test]
    fn lines_of_words_are_read_as_blocks_are() {
        for text in
            ["G1 X40.2005 Z-0.0131\n", "  N10G01X.5Z5.F200 \r\n", "X-0 Z-.5;\nX1", "U123456789012345678\n"]
        {
            assert!(read(text).is_some(), "{text}");
        }
        let (end, line) = read("N5 X1. Z2.;\r\nG0").expect("is short");
        assert_eq!(end, LineEnd { start: 11, next: 13 });
        assert_eq!((line.first(), line.bytes()), (b'N', (0, 10)));
    }

    #[test]
    fn every_other_line_is_left() {
        let others = [
            "X1.",
            "X1.\r",
            "X1.\rZ2.\n",
            "X1. (c)\n",
            "X\n",
            "X.\n",
            "X--1.\n",
            "X+1.\n",
            "X1.2.\n",
            "X1O.\n",
            "x1.\n",
            "X#1\n",
            "X1. X2.\n",
            "O1\n",
            ",R1.\n",
            "X1.;Z2.\n",
            "X1.; \n",
            "/X1.\n",
            "X1234567890123456789\n",
            "X1.\tZ2.\n",
            "%\n",
        ];
        for text in others {
            assert!(read(text).is_none(), "{text}");
        }
        assert!(ShortLine::default().read(b"X1. M3\n", Block::bit(b'X')).is_none());
    }
}
