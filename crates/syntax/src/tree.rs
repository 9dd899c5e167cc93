//! The lossless token table.

use crate::{Block, ExtentKind, find_line_end, scan_block};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum TokenKind {
    /// Blanks and control characters between words.
    Blank = 0,
    /// An address word.
    Word = 1,
    /// A comment.
    Comment = 2,
    /// A block skip mark.
    Skip = 3,
    /// An end of block.
    Semicolon = 4,
    /// Text behind an end of block that is no program.
    IgnoredText = 5,
    /// A tape mark and the rest of its line.
    Percent = 6,
    /// A program name.
    Name = 7,
    /// A macro statement.
    Macro = 8,
    /// Bytes that belong to nothing.
    Junk = 9,
    /// End-of-file mark of old editors.
    EndOfText = 10,
    /// The end of a line.
    LineEnd = 11,
}

impl TokenKind {
    const ALL: [Self; 12] = [
        Self::Blank,
        Self::Word,
        Self::Comment,
        Self::Skip,
        Self::Semicolon,
        Self::IgnoredText,
        Self::Percent,
        Self::Name,
        Self::Macro,
        Self::Junk,
        Self::EndOfText,
        Self::LineEnd,
    ];
}

impl From<ExtentKind> for TokenKind {
    fn from(kind: ExtentKind) -> Self {
        match kind {
            ExtentKind::Comment => Self::Comment,
            ExtentKind::Skip => Self::Skip,
            ExtentKind::Semicolon => Self::Semicolon,
            ExtentKind::IgnoredText => Self::IgnoredText,
            ExtentKind::Percent => Self::Percent,
            ExtentKind::Name => Self::Name,
            ExtentKind::Macro => Self::Macro,
            ExtentKind::Junk => Self::Junk,
            ExtentKind::EndOfText => Self::EndOfText,
        }
    }
}

/// A token and the bytes it covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// What it is.
    pub kind: TokenKind,
    /// Its first byte in the text.
    pub start: usize,
    /// Its bytes.
    pub text: &'a [u8],
}

/// A text and its tokens. Two bytes a token: four bits of kind, twelve of length; a longer token goes on in
/// following entries with the same kind and the mark [`CONTINUES`].
#[derive(Clone, Debug)]
pub struct Tree {
    text: Box<[u8]>,
    tokens: Vec<u16>,
}

const LENGTH_MAX: usize = 0x0fff;
/// Kind nibble of an entry that lengthens the token before it.
const CONTINUES: u16 = 0xf000;

impl Tree {
    /// Reads any bytes.
    pub fn parse(text: impl Into<Box<[u8]>>) -> Self {
        let text = text.into();
        let mut tokens = Vec::with_capacity(text.len() / 3);
        let mut block = Block::new();
        let mut line_start = 0;
        while line_start < text.len() {
            let rest = &text[line_start..];
            let end = find_line_end(rest, true);
            let (length, next) = end.map_or((rest.len(), rest.len()), |end| (end.start, end.next));
            push_line(&mut tokens, &rest[..length], &mut block);
            push(&mut tokens, TokenKind::LineEnd, next - length);
            line_start += next;
        }
        tokens.shrink_to_fit();
        Self { text, tokens }
    }

    /// The text.
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// The tokens in order; together they are the text.
    pub fn tokens(&self) -> impl Iterator<Item = Token<'_>> {
        let mut start = 0;
        let mut entries = self.tokens.iter().peekable();
        std::iter::from_fn(move || {
            let first = *entries.next()?;
            let mut length = usize::from(first) & LENGTH_MAX;
            while let Some(&&more) = entries.peek()
                && more & CONTINUES == CONTINUES
            {
                length += usize::from(more) & LENGTH_MAX;
                entries.next();
            }
            let token = Token {
                kind: TokenKind::ALL[usize::from(first >> 12)],
                start,
                text: &self.text[start..start + length],
            };
            start += length;
            Some(token)
        })
    }

    /// Writes the text again from its tokens.
    pub fn print(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.text.len());
        for token in self.tokens() {
            out.extend_from_slice(token.text);
        }
        out
    }

    /// Bytes that the tree takes, text included.
    pub fn memory_bytes(&self) -> usize {
        self.text.len() + self.tokens.capacity() * size_of::<u16>()
    }
}

fn push(tokens: &mut Vec<u16>, kind: TokenKind, length: usize) {
    if length == 0 {
        return;
    }
    let first = length.min(LENGTH_MAX);
    tokens.push(((kind as u16) << 12) | first as u16);
    let mut rest = length - first;
    while rest > 0 {
        let part = rest.min(LENGTH_MAX);
        tokens.push(CONTINUES | part as u16);
        rest -= part;
    }
}

fn push_line(tokens: &mut Vec<u16>, line: &[u8], block: &mut Block) {
    let mut from = 0;
    while from < line.len() {
        let next = scan_block(line, from, block);
        let (mut words, mut extents) = (block.words.iter().peekable(), block.extents.iter().peekable());
        let mut at = from;
        loop {
            let word_first = match (words.peek(), extents.peek()) {
                (None, None) => break,
                (Some(word), Some(extent)) => word.start < extent.start,
                (word, _) => word.is_some(),
            };
            let (kind, start, end) = if word_first {
                words.next().map(|word| (TokenKind::Word, word.start, word.end))
            } else {
                extents.next().map(|extent| (extent.kind.into(), extent.start, extent.end))
            }
            .unwrap_or((TokenKind::Blank, at as u32, at as u32));
            push(tokens, TokenKind::Blank, start as usize - at);
            push(tokens, kind, (end - start) as usize);
            at = end as usize;
        }
        // A block that consumed nothing would repeat for ever; the scanner always consumes.
        let next = next.max(from + 1);
        push(tokens, TokenKind::Blank, next - at);
        from = next;
    }
}
