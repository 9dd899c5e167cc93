//! Lines that are nothing but a few letters with a number each, read in one go.
//!
//! In: text that begins with a line. Out: the line's numbers by letter, and where it ends. Most lines of long programs
//! are such; every other one is left to [`scan_block`](crate::scan_block), which reads these lines too and makes the
//! same numbers of them. Not here: words with their places, which only somebody who complains needs.

use crate::lines::LineEnd;
use crate::number::{Decimal, Run};
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
    /// ([`Block::bit`](crate::Block::bit)), each at most once, and its end and a little more is in sight. `None` for
    /// any other: nothing is known of its numbers then, and of its place what was known before.
    #[inline]
    pub fn read(&mut self, text: &[u8], letters: u32) -> Option<LineEnd> {
        let mut left = letters;
        let first_byte = text.iter().take_while(|byte| **byte == b' ').count();
        let (mut at, mut last_byte) = (first_byte, first_byte);
        let end = loop {
            let sight: &Sight = text.get(at..)?.first_chunk()?;
            let letter = sight[0].wrapping_sub(b'A');
            if letter >= 26 {
                if sight[0] != b' ' {
                    break sight;
                }
                at += 1;
                continue;
            }
            let bit = 1 << letter;
            if left & bit == 0 {
                return None;
            }
            left ^= bit;
            let (number, bytes) = match number(sight) {
                Some(number) => number,
                None => long_number(text.get(at..)?)?,
            };
            self.numbers[usize::from(letter) % PLACES] = number;
            at += bytes;
            last_byte = at;
        };
        let semicolon = usize::from(end[0] == b';');
        let next = match end[semicolon] {
            b'\n' => semicolon + 1,
            b'\r' if end[semicolon + 1] == b'\n' => semicolon + 2,
            _ => return None,
        };
        self.present = letters ^ left;
        self.first = *text.get(first_byte)?;
        (self.first_byte, self.last_byte) = (first_byte as u32, last_byte as u32);
        Some(LineEnd { start: at + semicolon, next: at + next })
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

/// What is looked at of a text at once: a word with a usual number, and what follows it.
type Sight = [u8; 16];

/// The number of a word with at most one sign, a minus, and at most one point: itself, and the bytes of the word. `None`
/// when it is none, or a long one.
#[inline(always)]
fn number(word: &Sight) -> Option<(Decimal, usize)> {
    let &[letter, first, second, ..] = word;
    if letter == b'G' && first.is_ascii_digit() && !second.is_ascii_digit() && second != b'.' {
        // The codes of most lines.
        let run =
            Run { digits: i64::from(first - b'0'), scale: 0, typed_digits: 1, has_point: false, bytes: 1 };
        return Some((run.signed(false), 2));
    }
    // Two ways: which of them is gone is foretold, and no number waits for the sign of the one before.
    if first == b'-' { signed_number::<true>(word) } else { signed_number::<false>(word) }
}

/// The same, where the sign is known.
#[inline(always)]
fn signed_number<const IS_NEGATIVE: bool>(word: &Sight) -> Option<(Decimal, usize)> {
    let first = 1 + usize::from(IS_NEGATIVE);
    let run = Run::of_eight(u64::from_le_bytes(*word[first..].first_chunk()?))?;
    let bytes = first + run.bytes;
    // A letter O behind digits may stand for a zero, and is no letter of a short line.
    let is_whole = !word[bytes % word.len()].is_ascii_digit();
    is_whole.then(|| (run.signed(IS_NEGATIVE), bytes))
}

/// The same of a word of any length, at the start of `text`.
#[cold]
fn long_number(text: &[u8]) -> Option<(Decimal, usize)> {
    let is_negative = *text.get(1)? == b'-';
    let first = 1 + usize::from(is_negative);
    let run = Run::read_slowly(text.get(first..)?)?;
    Some((run.signed(is_negative), first + run.bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Value, scan_block};

    const ALL: u32 = u32::MAX ^ Block::bit(b'O');

    /// What both readers make of a line; `None` where the short one leaves it.
    fn read(text: &str) -> Option<(LineEnd, ShortLine)> {
        let mut line = ShortLine::default();
        let seen = [text.as_bytes(), b"G0 X0. Z0. (seen)"].concat();
        let end = line.read(&seen, ALL)?;
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
        for text in [
            "G1 X40.2005 Z-0.0131\n",
            "  N10G01X.5Z5.F200 \r\n",
            "X-0 Z-.5;\n",
            "U123456789012345678\n",
            "X-194.9334 Z1234567.8\n",
            "X-123.45678 Z12345678\n",
            "X12345678. Z.12345678 F1234567\n",
        ] {
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
