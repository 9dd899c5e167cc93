//! Where programs, sequence numbers and loops stand in a text: found by one pass when they are first needed,
//! then looked up without reading again.
//!
//! In: a text. Out: places to go on reading. Loops are paired here, once, by their place in the text; whether a
//! `DO` and its `END` fit each other does not depend on the way that execution took.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_syntax::{Block, ExtentKind, Value, Word, scan_block};

use crate::Environment;
use crate::limits::SEQUENCES_MAX;
use crate::report::Alarm;
use crate::text::{Cursor, Text};

/// A place to go on reading: a line, or a block inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Resume {
    pub(crate) line: Cursor,
    pub(crate) from: usize,
}

impl Resume {
    /// Order of places in one text.
    pub(crate) fn position(&self) -> (u64, usize) {
        (self.line.offset, self.from)
    }
}

/// What a program is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramName<'a> {
    /// `O` and a number.
    Number(u32),
    /// A name, as written.
    Text(&'a str),
}

/// A `DO` or `END` (`WHILE` counts as its `DO`).
#[derive(Clone, Copy, Debug)]
struct LoopMark {
    at: Resume,
    behind: Resume,
    number: u8,
    is_end: bool,
    /// The mark that it belongs to.
    partner: Option<u32>,
    /// The `DO` around the whole loop, for a `DO` with a partner.
    outer: Option<u32>,
}

/// Hashes the small whole numbers that are looked up here.
#[derive(Default)]
pub(crate) struct NumberHasher(u64);

impl Hasher for NumberHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u32(&mut self, value: u32) {
        self.write_u64(u64::from(value));
    }

    fn write_u64(&mut self, value: u64) {
        let mixed = (self.0.rotate_left(5) ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 32);
    }
}

/// A table keyed by whole numbers.
pub(crate) type NumberMap<K, V> = HashMap<K, V, BuildHasherDefault<NumberHasher>>;

/// Tables by number are made for texts with up to this many sequence numbers; beyond, memory counts for more.
const TABLE_SEQUENCES_MAX: usize = 1_000_000;

/// Where programs, sequence numbers and loops stand in a text.
#[derive(Debug, Default)]
pub(crate) struct ProgramIndex {
    /// Where each program begins, in order of the text.
    programs: Vec<Resume>,
    by_number: NumberMap<u32, u32>,
    by_name: HashMap<String, u32>,
    /// Number of program in the list above plus one (0 for what stands before the first), sequence number,
    /// place; sorted, so that equal numbers stand together in order of the text.
    sequences: Vec<(u32, u32, Resume)>,
    /// The first of each group of equal numbers above.
    first_of: NumberMap<u64, u32>,
    loops: Vec<LoopMark>,
    /// Length of the text.
    pub(crate) bytes: u64,
}

impl ProgramIndex {
    pub(crate) fn read(source: SourceId, environment: &mut dyn Environment) -> Result<Self, Alarm> {
        let mut index = Self::default();
        let mut text = Text::new(source);
        let mut block = Block::new();
        let unreadable = |_| Box::new(Diagnostic::error("file-unreadable"));
        while let Some(line) = text.next(environment).map_err(unreadable)? {
            let bytes = text.bytes(&line);
            if !may_hold_a_mark(bytes) {
                continue;
            }
            let next_line = text.cursor();
            let mut from = 0;
            loop {
                let next = scan_block(bytes, from, &mut block);
                let is_last = next >= bytes.len();
                let cursor = Cursor { source, offset: line.offset, line: line.number };
                let at = Resume { line: cursor, from };
                let behind = if is_last {
                    Resume { line: next_line, from: 0 }
                } else {
                    Resume { line: cursor, from: next }
                };
                index.take(bytes, &block, at, behind)?;
                if is_last || line.is_cut {
                    break;
                }
                from = next;
            }
        }
        index.bytes = text.cursor().offset;
        index.sequences.sort_unstable_by_key(|(program, number, at)| (*program, *number, at.position()));
        if index.sequences.len() <= TABLE_SEQUENCES_MAX {
            for (place, (program, number, _)) in index.sequences.iter().enumerate() {
                index.first_of.entry(sequence_key(*program, *number)).or_insert(place as u32);
            }
        }
        index.pair_loops();
        Ok(index)
    }

    fn take(&mut self, bytes: &[u8], block: &Block, at: Resume, behind: Resume) -> Result<(), Alarm> {
        let number = |word: &Word| match word.value {
            Value::Number(number) => u32::try_from(number.digits).ok(),
            _ => None,
        };
        let mut returns = false;
        for word in &block.words {
            match word.address {
                b'O' => {
                    // What follows a return in the same block is the next program.
                    let from = if returns { word.end as usize } else { at.from };
                    let place = self.programs.len() as u32;
                    match (number(word), program_name(bytes, block)) {
                        (Some(number), _) => {
                            self.by_number.entry(number).or_insert(place);
                        }
                        (None, Some(name)) => {
                            self.by_name.entry(name).or_insert(place);
                        }
                        (None, None) => continue,
                    }
                    self.programs.push(Resume { from, ..at });
                }
                b'M' => returns |= number(word) == Some(99),
                b'N' if word.start <= block.words[0].start => {
                    if self.sequences.len() >= SEQUENCES_MAX {
                        return Err(Box::new(
                            Diagnostic::error("file-too-large").with("limit", SEQUENCES_MAX as i64),
                        ));
                    }
                    if let Some(number) = number(word) {
                        self.sequences.push((self.programs.len() as u32, number, at));
                    }
                }
                _ => {}
            }
        }
        if block.words.is_empty()
            && let Some(name) = program_name(bytes, block)
        {
            self.by_name.entry(name).or_insert(self.programs.len() as u32);
            self.programs.push(at);
        }
        if let Some((start, end)) = block.macro_statement
            && let Some((number, is_end)) = loop_mark(&bytes[start as usize..end as usize])
        {
            self.loops.push(LoopMark { at, behind, number, is_end, partner: None, outer: None });
        }
        Ok(())
    }

    /// Finds the `END` of every `DO`, program by program. A pair that crosses another has no partners.
    fn pair_loops(&mut self) {
        let mut open: Vec<u32> = Vec::new();
        let mut program = 0;
        for place in 0..self.loops.len() {
            let mark = self.loops[place];
            let here = self.program_at(mark.at);
            if here != program {
                program = here;
                open.clear();
            }
            if !mark.is_end {
                // A number that is open already would be ended by the wrong END.
                if open.iter().any(|outer| self.loops[*outer as usize].number == mark.number) {
                    continue;
                }
                self.loops[place].outer = open.last().copied();
                open.push(place as u32);
            } else if let Some(level) =
                open.iter().rposition(|outer| self.loops[*outer as usize].number == mark.number)
            {
                let is_innermost = level + 1 == open.len();
                if is_innermost {
                    let partner = open[level];
                    self.loops[place].partner = Some(partner);
                    self.loops[partner as usize].partner = Some(place as u32);
                }
                open.truncate(level);
            }
        }
    }

    /// Where a program begins.
    pub(crate) fn program(&self, name: ProgramName<'_>) -> Option<Resume> {
        let place = match name {
            ProgramName::Number(number) => self.by_number.get(&number),
            ProgramName::Text(text) => self.by_name.get(text),
        };
        place.map(|place| self.programs[*place as usize])
    }

    /// Number in the list of the program that a place lies in, 0 before the first.
    fn program_at(&self, at: Resume) -> u32 {
        self.programs.partition_point(|start| start.position() <= at.position()) as u32
    }

    /// The block with a sequence number in the program that begins at `program`: the first one behind `from`,
    /// else the first of all; and how many blocks have the number.
    pub(crate) fn sequence(&self, number: u32, program: Resume, from: Resume) -> Option<(Resume, usize)> {
        let program = self.program_at(program);
        let first = if self.first_of.is_empty() {
            self.sequences.partition_point(|(p, n, _)| (*p, *n) < (program, number))
        } else {
            *self.first_of.get(&sequence_key(program, number))? as usize
        };
        let is_same = |entry: &(u32, u32, Resume)| (entry.0, entry.1) == (program, number);
        let rest = &self.sequences[first..];
        if !rest.first().is_some_and(is_same) {
            return None;
        }
        if !rest.get(1).is_some_and(is_same) {
            return Some((rest[0].2, 1));
        }
        let count = rest.partition_point(is_same);
        let behind = rest[..count].partition_point(|(_, _, at)| at.position() <= from.position());
        let found = rest[..count].get(behind).unwrap_or(&rest[0]);
        Some((found.2, count))
    }

    fn loop_at(&self, at: Resume) -> Option<&LoopMark> {
        let place = self.loops.partition_point(|mark| mark.at.position() < at.position());
        self.loops.get(place).filter(|mark| mark.at.position() == at.position())
    }

    /// Behind the `END` of the loop whose `DO` stands at a place.
    pub(crate) fn behind_loop(&self, at: Resume) -> Option<Resume> {
        let partner = self.loop_at(at)?.partner?;
        Some(self.loops[partner as usize].behind)
    }

    /// The `DO` of the loop whose `END` stands at a place.
    pub(crate) fn start_of_loop(&self, at: Resume) -> Option<Resume> {
        let partner = self.loop_at(at)?.partner?;
        Some(self.loops[partner as usize].at)
    }

    /// Whether a jump would enter a loop from outside.
    pub(crate) fn enters_loop(&self, from: Resume, to: Resume) -> bool {
        let before = self.loops.partition_point(|mark| mark.at.position() < to.position());
        // The innermost loop around the target: that of the last mark before it, or the one around that.
        let mut around = None;
        for mark in self.loops[..before].iter().rev() {
            match (mark.is_end, mark.partner) {
                (false, Some(_)) => around = Some(mark),
                (true, Some(start)) => {
                    around = self.loops[start as usize].outer.map(|outer| &self.loops[outer as usize]);
                }
                (_, None) => continue,
            }
            break;
        }
        while let Some(mark) = around {
            let Some(end) = mark.partner else { return false };
            let end = self.loops[end as usize].at.position();
            let holds = |place: (u64, usize)| mark.at.position() < place && place <= end;
            if holds(to.position()) && !holds(from.position()) {
                return true;
            }
            around = mark.outer.map(|outer| &self.loops[outer as usize]);
        }
        false
    }
}

fn sequence_key(program: u32, number: u32) -> u64 {
    u64::from(program) << 32 | u64::from(number)
}

/// Whether a line can hold a program, a sequence number or a loop; most lines of a program cannot.
fn may_hold_a_mark(bytes: &[u8]) -> bool {
    let head = bytes.iter().find(|byte| !matches!(byte, b' ' | b'\t' | 0xef | 0xbb | 0xbf));
    match head.map(u8::to_ascii_uppercase) {
        // Behind a comment anything may come.
        Some(b'N' | b'O' | b':' | b'/' | b'<' | b'W' | b'D' | b'E' | b'(') => true,
        Some(b'M') => bytes.iter().any(|byte| matches!(byte, b'O' | b'o' | b';')),
        _ => bytes.contains(&b';'),
    }
}

/// The name in angle brackets, if the block has one.
fn program_name(bytes: &[u8], block: &Block) -> Option<String> {
    let name = block.extents.iter().find(|extent| extent.kind == ExtentKind::Name)?;
    let text = bytes.get(name.start as usize..name.end as usize)?;
    let text = String::from_utf8_lossy(text);
    Some(text.trim_matches(['<', '>']).trim().to_string())
}

/// Number of a loop statement, and whether it is its end.
fn loop_mark(statement: &[u8]) -> Option<(u8, bool)> {
    let text: Vec<u8> =
        statement.iter().filter(|byte| !byte.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect();
    let number = |digits: &[u8]| std::str::from_utf8(digits).ok()?.parse().ok();
    if let Some(rest) = text.strip_prefix(b"END") {
        return Some((number(rest)?, true));
    }
    let is_loop = text.starts_with(b"WHILE") || (text.starts_with(b"DO"));
    let digits = text.iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
    let (head, digits) = text.split_at(text.len() - digits);
    (is_loop && head.ends_with(b"DO")).then(|| number(digits)).flatten().map(|number| (number, false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loop_statements_are_known_by_their_words() {
        assert_eq!(loop_mark(b"WHILE[#1 LT 10]DO1"), Some((1, false)));
        assert_eq!(loop_mark(b"DO 2"), Some((2, false)));
        assert_eq!(loop_mark(b"end 3"), Some((3, true)));
        assert_eq!(loop_mark(b"#1=2"), None);
        assert_eq!(loop_mark(b"DPRNT[DO1]"), None);
        assert_eq!(loop_mark(b"IF[#1EQ1]GOTO5"), None);
    }
}
