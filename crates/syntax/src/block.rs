//! What one block holds: words, faults, and everything between them.

use crate::Decimal;

/// The value of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// A number was typed.
    Number(Decimal),
    /// A variable or an expression was typed; its text is `start..end` of the line.
    Expression {
        /// First byte of the expression, sign included.
        start: u32,
        /// First byte behind it.
        end: u32,
    },
    /// Nothing usable follows the address; a fault says what.
    Missing,
}

/// An address and its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// The letter, in upper case.
    pub address: u8,
    /// A comma stood before the letter (`,R2.`).
    pub comma: bool,
    /// First byte of the word in its line.
    pub start: u32,
    /// First byte behind the word.
    pub end: u32,
    /// What follows the letter.
    pub value: Value,
}

/// What is wrong with a stretch of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaultKind {
    /// More digits than any address takes.
    NumberTooLong,
    /// Two points in a number.
    TwoPoints,
    /// Two signs before a number.
    TwoSigns,
    /// A letter without a number.
    AddressWithoutValue,
    /// Text that is no word.
    NotAWord,
    /// A comma where a number has its point.
    DecimalComma,
    /// The letter O where a zero belongs.
    LetterO,
    /// A bracket without its partner.
    StrayBracket,
    /// More words than a block may have.
    TooManyWords,
    /// A comment that is not closed before the end of the line.
    UnclosedComment,
    /// A comment inside a comment.
    NestedComment,
    /// Text behind the end of block that is no program.
    TextAfterSemicolon,
    /// A full-width character that stands for an ASCII one.
    FullWidth,
    /// A program name in angle brackets, which only some controls know.
    ProgramName,
    /// An axis named by its number (`AX[1]=5.`), which only some controls know.
    IndirectAxis,
}

impl FaultKind {
    /// True for what only deserves a warning because the meaning is not in doubt.
    pub const fn is_harmless(self) -> bool {
        matches!(
            self,
            Self::UnclosedComment | Self::NestedComment | Self::TextAfterSemicolon | Self::FullWidth
        )
    }
}

/// A fault and its place in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub kind: FaultKind,
    /// First byte.
    pub start: u32,
    /// First byte behind.
    pub end: u32,
}

/// What stands between words and is neither blank nor word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtentKind {
    /// `( … )`.
    Comment,
    /// A block skip mark.
    Skip,
    /// The end of block.
    Semicolon,
    /// Text behind an end of block that is no program.
    IgnoredText,
    /// A tape mark with the rest of its line.
    Percent,
    /// A program name in angle brackets.
    Name,
    /// A macro statement.
    Macro,
    /// Bytes that belong to nothing.
    Junk,
    /// The mark that old editors put at the end of a file.
    EndOfText,
}

/// A stretch of a line that is neither blank nor word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// What it is.
    pub kind: ExtentKind,
    /// First byte.
    pub start: u32,
    /// First byte behind.
    pub end: u32,
}

/// Block skip marks of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skip {
    /// Switches that skip the whole block; bit 1 is `/` or `/1`.
    pub whole: u16,
    /// Switches that skip the rest of the block.
    pub rest: u16,
    /// Words before the mark inside the block, when there is one.
    pub words_kept: u8,
}

/// One block, reused from block to block so that reading a program allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The words, in order.
    pub words: Vec<Word>,
    /// Comments, marks and other text between them, in order.
    pub extents: Vec<Extent>,
    /// What is wrong, in order.
    pub faults: Vec<Fault>,
    /// Block skip marks.
    pub skip: Skip,
    /// Text of the macro statement when the block is one.
    pub macro_statement: Option<(u32, u32)>,
    /// A word stands behind a comma.
    pub has_comma: bool,
    /// The value of a word is an expression.
    pub computes: bool,
    /// The block is a tape mark.
    pub is_percent: bool,
    /// The text ends here whatever follows.
    pub is_end_of_text: bool,
    /// What [`Block::refill`] filled the block from, while it still holds that.
    copy_of: Option<u32>,
    present: u32,
    last: [u8; 26],
}

impl Block {
    /// An empty block.
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets everything and keeps the memory.
    #[inline]
    pub fn clear(&mut self) {
        self.words.clear();
        self.extents.clear();
        self.faults.clear();
        self.skip = Skip::default();
        self.macro_statement = None;
        self.has_comma = false;
        self.computes = false;
        self.is_percent = false;
        self.is_end_of_text = false;
        self.copy_of = None;
        self.present = 0;
    }

    /// Adds a word.
    #[inline]
    pub(crate) fn push(&mut self, word: Word) {
        self.note(word, self.words.len());
        self.words.push(word);
    }

    /// Drops every word from `kept` on (a block skip inside the block took them).
    pub fn truncate(&mut self, kept: usize) {
        let words = std::mem::take(&mut self.words);
        (self.present, self.has_comma, self.copy_of) = (0, false, None);
        self.words = Vec::with_capacity(words.capacity());
        for word in words.into_iter().take(kept) {
            self.push(word);
        }
    }

    /// Gives the words at some places, in order, the numbers that `value` makes of them; a word that it makes nothing
    /// of is taken out.
    ///
    /// # Errors
    /// The first error of `value`; the block is then of no more use.
    #[inline]
    pub fn resolve<E>(
        &mut self,
        places: impl Iterator<Item = usize>,
        mut value: impl FnMut(&Word, usize) -> Result<Option<Decimal>, E>,
    ) -> Result<(), E> {
        let mut has_gaps = false;
        for place in places {
            let Some(word) = self.words.get_mut(place) else { break };
            word.value = match value(word, place)? {
                Some(number) => Value::Number(number),
                None => {
                    has_gaps = true;
                    Value::Missing
                }
            };
        }
        if has_gaps {
            self.close_gaps();
        }
        Ok(())
    }

    /// Gives a word another letter: that of the axis whose number it was written with.
    #[cold]
    pub fn rename(&mut self, place: usize, letter: u8) {
        self.words[place].address = letter;
        (self.present, self.has_comma, self.copy_of) = (0, false, None);
        for place in 0..self.words.len() {
            self.note(self.words[place], place);
        }
    }

    /// Drops the words that have no value.
    #[cold]
    fn close_gaps(&mut self) {
        self.words.retain(|word| word.value != Value::Missing);
        (self.present, self.has_comma, self.copy_of) = (0, false, None);
        for place in 0..self.words.len() {
            self.note(self.words[place], place);
        }
    }

    /// Fills the block with words read before, which are known by a number: what holds them already stays.
    #[inline]
    pub fn refill(&mut self, number: u32, words: &[Word]) {
        if self.copy_of != Some(number) {
            self.fill(number, words);
        }
    }

    fn fill(&mut self, number: u32, words: &[Word]) {
        self.clear();
        self.words.extend_from_slice(words);
        for (place, word) in words.iter().enumerate() {
            self.note(*word, place);
        }
        self.copy_of = Some(number);
    }

    #[inline]
    fn note(&mut self, word: Word, place: usize) {
        if word.comma {
            self.has_comma = true;
        } else {
            let letter = usize::from(word.address - b'A');
            self.present |= 1 << letter;
            self.last[letter] = place as u8;
        }
    }

    /// The letters of the words without a comma, bit 0 for A.
    pub const fn present(&self) -> u32 {
        self.present
    }

    /// The bit of a letter in [`Block::present`].
    pub const fn bit(letter: u8) -> u32 {
        1 << (letter - b'A')
    }

    /// True when the block has a word with this letter.
    #[inline]
    pub const fn has(&self, letter: u8) -> bool {
        self.present & Self::bit(letter) != 0
    }

    /// The last word with this letter and without a comma.
    #[inline]
    pub fn word(&self, letter: u8) -> Option<&Word> {
        if self.has(letter) {
            self.words.get(usize::from(self.last[usize::from(letter - b'A')]))
        } else {
            None
        }
    }

    /// The place of the last word with this letter and without a comma.
    #[inline]
    pub fn place(&self, letter: u8) -> Option<usize> {
        self.has(letter).then(|| usize::from(self.last[usize::from(letter - b'A')]))
    }

    /// The last word with this letter behind a comma.
    pub fn comma_word(&self, letter: u8) -> Option<&Word> {
        self.words.iter().rev().find(|word| word.comma && word.address == letter)
    }

    /// True when nothing is to be executed.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty() && self.macro_statement.is_none()
    }
}
