//! Program text, read through a window: memory does not grow with the length of the program.
//!
//! In: [`Environment::read`]. Out: lines with number and offset. A line longer than [`LINE_BYTES_MAX`] is
//! given cut off and marked; what lies behind is passed over piece by piece.

use turnwright_diagnostics::SourceId;
use turnwright_syntax::{LineEnd, find_line_end};

use crate::limits::{HELD_TEXT_BYTES_MAX, PARKED_TEXTS_MAX};
use crate::{Environment, ReadFault};

/// Longest line that is read; a control takes a few hundred characters.
pub const LINE_BYTES_MAX: usize = 32 * 1024;

/// Bytes read at a time, and how many of them at first: often a few lines are all that is looked for.
const WINDOW_BYTES: usize = 64 * 1024;
const FIRST_READ_BYTES: usize = 4 * 1024;

/// A place in a text where reading can go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cursor {
    pub(crate) source: SourceId,
    /// Bytes from the start of the text to the start of the line.
    pub(crate) offset: u64,
    /// Number of the line, from 1.
    pub(crate) line: u32,
}

/// A line that was read; its bytes are in the window until the next one is read.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Line {
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) number: u32,
    pub(crate) offset: u64,
    pub(crate) is_cut: bool,
    is_in_head: bool,
}

/// The window.
#[derive(Debug)]
pub(crate) struct Text {
    source: SourceId,
    /// Bytes of the window; only the first `filled` are text.
    buffer: Vec<u8>,
    filled: usize,
    /// Offset of the first byte of the buffer.
    base: u64,
    /// Start of the next line in the buffer.
    at: usize,
    next_line: u32,
    is_last: bool,
    /// The head of a line that is longer than the window.
    head: Vec<u8>,
    /// Texts whose length is known and small: they are held as a whole once they are jumped in.
    held: Vec<SourceId>,
    /// The window begins at the start of the text and lets go of nothing.
    is_held: bool,
    /// Held texts that a call or a return has left, the one left last behind the others.
    parked: Vec<Parked>,
}

/// The window on a held text that another one is read instead of.
#[derive(Debug)]
struct Parked {
    source: SourceId,
    buffer: Vec<u8>,
    filled: usize,
    is_last: bool,
}

impl Text {
    pub(crate) fn new(source: SourceId) -> Self {
        Self {
            source,
            buffer: Vec::new(),
            filled: 0,
            base: 0,
            at: 0,
            next_line: 1,
            is_last: false,
            head: Vec::new(),
            held: Vec::new(),
            parked: Vec::new(),
            is_held: false,
        }
    }

    /// The length of a text is known: a small one is held as a whole from the next jump on.
    pub(crate) fn expect(&mut self, source: SourceId, bytes: u64) {
        if bytes <= HELD_TEXT_BYTES_MAX && !self.held.contains(&source) {
            self.held.push(source);
        }
    }

    /// The text in work.
    #[inline]
    pub(crate) fn source(&self) -> SourceId {
        self.source
    }

    /// Where the next line begins.
    pub(crate) fn cursor(&self) -> Cursor {
        Cursor { source: self.source, offset: self.next_offset(), line: self.next_line }
    }

    /// Goes to another line.
    pub(crate) fn jump(&mut self, to: Cursor) {
        self.next_line = to.line;
        let end = self.base + self.filled as u64;
        let is_near = (self.base..=end).contains(&to.offset) || (self.is_held && self.base <= to.offset);
        if to.source == self.source && is_near {
            self.at = (to.offset - self.base) as usize;
            return;
        }
        if to.source != self.source {
            self.park();
        }
        self.source = to.source;
        self.is_held = self.held.contains(&to.source);
        (self.filled, self.is_last) = (0, false);
        if let Some(place) = self.parked.iter().position(|parked| parked.source == to.source) {
            let Parked { buffer, filled, is_last, .. } = self.parked.remove(place);
            (self.buffer, self.filled, self.is_last) = (buffer, filled, is_last);
        }
        // Of a held text everything before the place is read too, once.
        self.base = if self.is_held { 0 } else { to.offset };
        self.at = (to.offset - self.base) as usize;
    }

    /// Puts a held text aside: calls go to and fro between texts.
    fn park(&mut self) {
        if !self.is_held {
            return;
        }
        if self.parked.len() >= PARKED_TEXTS_MAX {
            self.parked.remove(0);
        }
        let buffer = std::mem::take(&mut self.buffer);
        self.parked.push(Parked { source: self.source, buffer, filled: self.filled, is_last: self.is_last });
    }

    /// The bytes of the line last read.
    pub(crate) fn bytes(&self, line: &Line) -> &[u8] {
        let text = if line.is_in_head { &self.head } else { &self.buffer[..self.filled] };
        // A line that is no longer in the window is quoted as nothing.
        text.get(line.start..line.end).unwrap_or(&[])
    }

    /// Reads the next line; `None` behind the last.
    #[inline]
    pub(crate) fn next(&mut self, environment: &mut dyn Environment) -> Result<Option<Line>, ReadFault> {
        while self.at > self.filled {
            if self.is_last {
                return Ok(None);
            }
            self.fill(environment)?;
        }
        loop {
            if let Some(end) = find_line_end(&self.buffer[self.at..self.filled], self.is_last) {
                let line = self.line(self.at + end.start);
                self.at += end.next;
                return Ok(Some(self.limited(line)));
            }
            if self.is_last {
                if self.at == self.filled {
                    return Ok(None);
                }
                let line = self.line(self.filled);
                self.at = self.filled;
                return Ok(Some(self.limited(line)));
            }
            if self.filled - self.at > LINE_BYTES_MAX {
                return self.long_line(environment).map(Some);
            }
            self.fill(environment)?;
        }
    }

    /// What of the text lies in the window behind the line last read.
    #[inline]
    pub(crate) fn ahead(&self) -> &[u8] {
        self.buffer.get(self.at..self.filled).unwrap_or(&[])
    }

    /// Takes the line at the start of [`Text::ahead`]; its number.
    #[inline]
    pub(crate) fn take_ahead(&mut self, end: LineEnd) -> u32 {
        let number = self.next_line;
        self.next_line = number.saturating_add(1);
        self.at += end.next;
        number
    }

    /// A line that was taken, while it is in the window.
    pub(crate) fn taken(&self, number: u32, offset: u64) -> Line {
        let start = (offset - self.base) as usize;
        let end = find_line_end(self.buffer.get(start..self.filled).unwrap_or(&[]), true);
        let end = end.map_or(self.filled, |end| start + end.start);
        Line { start, end, number, offset, is_cut: false, is_in_head: false }
    }

    /// Where the next line begins, counted from the start of the text.
    #[inline]
    pub(crate) fn next_offset(&self) -> u64 {
        self.base + self.at as u64
    }

    #[inline]
    fn line(&mut self, end: usize) -> Line {
        let number = self.next_line;
        self.next_line = number.saturating_add(1);
        Line {
            start: self.at,
            end,
            number,
            offset: self.base + self.at as u64,
            is_cut: false,
            is_in_head: false,
        }
    }

    fn limited(&self, mut line: Line) -> Line {
        if line.end - line.start > LINE_BYTES_MAX {
            line.end = line.start + LINE_BYTES_MAX;
            line.is_cut = true;
        }
        line
    }

    /// Lets go of what was read and reads more behind what is left.
    fn fill(&mut self, environment: &mut dyn Environment) -> Result<(), ReadFault> {
        if !self.is_held {
            self.buffer.copy_within(self.at..self.filled, 0);
            self.base += self.at as u64;
            self.filled -= self.at;
            self.at = 0;
        }
        let wanted = self.filled + self.buffer.len().clamp(FIRST_READ_BYTES, WINDOW_BYTES);
        if self.buffer.len() < wanted {
            self.buffer.resize(wanted, 0);
        }
        let offset = self.base + self.filled as u64;
        let read = environment.read(self.source, offset, &mut self.buffer[self.filled..wanted])?;
        self.filled += read.min(wanted - self.filled);
        self.is_last = read == 0;
        Ok(())
    }

    /// Keeps the head of a line without end in sight and passes over the rest.
    fn long_line(&mut self, environment: &mut dyn Environment) -> Result<Line, ReadFault> {
        let mut line = self.line(self.at + LINE_BYTES_MAX);
        self.head.clear();
        self.head.extend_from_slice(&self.buffer[line.start..line.end]);
        (line.start, line.end, line.is_cut, line.is_in_head) = (0, self.head.len(), true, true);
        loop {
            // Half of a CR LF may be the last byte of the piece.
            let ends_in_return = self.buffer[..self.filled].last() == Some(&b'\r');
            self.at = self.filled - usize::from(ends_in_return);
            self.fill(environment)?;
            if let Some(end) = find_line_end(&self.buffer[self.at..self.filled], self.is_last) {
                self.at += end.next;
                return Ok(line);
            }
            if self.is_last {
                self.at = self.filled;
                return Ok(line);
            }
        }
    }
}
