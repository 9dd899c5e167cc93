//! Blocks that ran before and are likely to run again: loops and subprograms run from here without being read,
//! split into words or compiled a second time.
//!
//! A block is kept when it lies before a place that execution jumped back from, so that a program without
//! loops keeps nothing. Every block knows the one behind it and, once it has jumped, the one it jumps to.
//! What is kept is bounded by [`CACHE_BYTES_MAX`](crate::limits::CACHE_BYTES_MAX); beyond it blocks are read anew.

use std::num::NonZeroU32;

use turnwright_diagnostics::SourceId;
use turnwright_syntax::{Block, Word};

use crate::index::{NumberMap, Resume};
use crate::limits::CACHE_BYTES_MAX;
use crate::machine::BlockPlace;
use crate::macros::{Code, Quick, Statement};
use crate::plain::Plain;

/// A block that is kept: its number from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlockId(NonZeroU32);

impl BlockId {
    #[inline]
    const fn place(self) -> usize {
        self.0.get() as usize - 1
    }
}

/// The blocks that a block has led to so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Links {
    /// The one behind it.
    pub(crate) next: Option<BlockId>,
    /// The one that it jumps to.
    pub(crate) jump: Option<BlockId>,
}

/// What a kept block does.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kept {
    Statement(Statement),
    Words {
        first: u32,
        count: u8,
        /// Those of them that are expressions.
        computed: Places,
        /// What the block comes to where nothing looks at it.
        plain: Option<Plain>,
        /// It may go the [short way](crate::short).
        is_short: bool,
    },
    /// Nothing to execute.
    Blank,
}

/// Places of words in a block, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Places(u64);

impl Places {
    /// The words that `codes` compute; `None` when one stands too far behind.
    fn of(codes: &[Code]) -> Option<Self> {
        let mut computed = codes.iter().enumerate().filter(|(_, code)| code.computes());
        computed.try_fold(Self::default(), |Self(bits), (place, _)| {
            Some(Self(bits | 1u64.checked_shl(place as u32).filter(|_| place < 64)?))
        })
    }

    pub(crate) const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl Iterator for Places {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        let place = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        (place < 64).then_some(place as usize)
    }
}

/// A way from one block to another that is filled in when it is first gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Next,
    Jump,
}

#[derive(Clone, Debug)]
struct Entry {
    at: BlockPlace,
    start: Resume,
    behind: Resume,
    kept: Kept,
    /// Switches that skip it.
    skip: u16,
    text: (u32, u32),
}

/// The blocks that are kept.
#[derive(Debug, Default)]
pub(crate) struct Cache {
    entries: Vec<Entry>,
    /// Of each entry, what a loop asks for again and again.
    quick: Vec<(Quick, Links)>,
    words: Vec<Word>,
    /// Compiled values of the words above, for those that are expressions.
    codes: Vec<Code>,
    text: Vec<u8>,
    places: NumberMap<(SourceId, u64, u32), BlockId>,
    /// Text in work, and the last place in it that execution jumped back from: blocks before it are kept.
    source: SourceId,
    hot_end: u64,
    hot: Vec<(SourceId, u64)>,
    /// The block in work, when it is a kept one.
    pub(crate) current: Option<BlockId>,
    /// The way that leads to the block that comes next.
    open: Option<(BlockId, Way)>,
}

impl Cache {
    /// Execution went back: what lies before `from` will run again.
    pub(crate) fn heat(&mut self, source: SourceId, from: u64) {
        match self.hot.iter_mut().find(|(known, _)| *known == source) {
            Some((_, end)) => *end = (*end).max(from),
            None => self.hot.push((source, from)),
        }
        if source == self.source {
            self.hot_end = self.hot_end.max(from);
        }
    }

    /// Whether blocks at a place are kept.
    #[inline]
    pub(crate) fn is_hot(&self, source: SourceId, offset: u64) -> bool {
        offset <= self.hot_end && self.hot_end > 0 && source == self.source
    }

    /// Another text is read.
    pub(crate) fn enter(&mut self, source: SourceId) {
        if source != self.source {
            self.source = source;
            self.hot_end = self.hot.iter().find(|(known, _)| *known == source).map_or(0, |(_, end)| *end);
        }
    }

    /// The block at a place, if it is kept; it becomes the current one.
    pub(crate) fn find(&mut self, at: Resume) -> Option<BlockId> {
        let id = *self.places.get(&(at.line.source, at.line.offset, at.from as u32))?;
        self.arrive(id);
        Some(id)
    }

    #[inline]
    fn arrive(&mut self, id: BlockId) {
        if let Some((from, way)) = self.open.take() {
            let links = &mut self.quick[from.place()].1;
            match way {
                Way::Next => links.next = Some(id),
                Way::Jump => links.jump = Some(id),
            }
        }
        self.current = Some(id);
    }

    /// What a block does, and the switches that skip it.
    #[inline]
    pub(crate) fn kept(&self, id: BlockId) -> (&Kept, u16) {
        let entry = &self.entries[id.place()];
        (&entry.kept, entry.skip)
    }

    /// A block as a loop of statements sees it.
    #[inline]
    pub(crate) fn quick(&self, id: BlockId) -> &(Quick, Links) {
        &self.quick[id.place()]
    }

    /// Goes to a block that another leads to.
    #[inline]
    pub(crate) fn go_to(&mut self, id: BlockId) {
        self.current = Some(id);
    }

    /// The place of the current block.
    #[inline]
    pub(crate) fn place(&self, id: BlockId) -> BlockPlace {
        self.entries[id.place()].at
    }

    /// Where reading goes on behind a block.
    pub(crate) fn behind(&self, id: BlockId) -> Resume {
        self.entries[id.place()].behind
    }

    /// Where a block begins.
    pub(crate) fn start(&self, id: BlockId) -> Resume {
        self.entries[id.place()].start
    }

    /// The text of the current block's line.
    pub(crate) fn line(&self, id: BlockId) -> &[u8] {
        let (start, end) = self.entries[id.place()].text;
        &self.text[start as usize..end as usize]
    }

    /// Goes from the current block along a way that was gone before; false when it has to be found.
    #[inline]
    pub(crate) fn follow(&mut self, way: Way) -> bool {
        let Some(id) = self.current else { return false };
        let links = &self.quick[id.place()].1;
        let to = match way {
            Way::Next => links.next,
            Way::Jump => links.jump,
        };
        if to.is_some() {
            self.current = to;
            true
        } else {
            self.open = Some((id, way));
            false
        }
    }

    /// Reading goes on somewhere in the text.
    pub(crate) fn leave(&mut self) {
        self.current = None;
    }

    /// The way that is being looked for leads nowhere that is known.
    pub(crate) fn forget_way(&mut self) {
        self.open = None;
    }

    /// Fills a block with the words of a kept one.
    #[inline]
    pub(crate) fn refill(&self, block: &mut Block, first: u32, count: u8) {
        block.refill(first, self.words(first, count));
    }

    /// The words of a kept block.
    #[inline]
    pub(crate) fn words(&self, first: u32, count: u8) -> &[Word] {
        &self.words[first as usize..first as usize + usize::from(count)]
    }

    /// Whether the way from a block to the one behind it was gone before.
    #[inline]
    pub(crate) fn leads_on(&self, id: BlockId) -> bool {
        self.quick[id.place()].1.next.is_some()
    }

    /// A block needs the long way.
    pub(crate) fn leave_short_way(&mut self, id: BlockId) {
        if let Kept::Words { is_short, .. } = &mut self.entries[id.place()].kept {
            *is_short = false;
        }
    }

    /// The compiled value of a word of a kept block.
    #[inline]
    pub(crate) fn code(&self, first: u32, place: usize) -> Code {
        self.codes[first as usize + place]
    }

    /// Keeps a block; `None` when there is no room.
    pub(crate) fn keep_words(
        &mut self,
        block: &Block,
        codes: &[Code],
        plain: Option<Plain>,
        is_short: bool,
        frame: Frame<'_>,
    ) -> Option<BlockId> {
        let first = self.words.len() as u32;
        let computed = Places::of(codes)?;
        let count = u8::try_from(block.words.len()).ok()?;
        if !self.has_room(frame.line.len() + block.words.len() * (size_of::<Word>() + size_of::<Code>())) {
            return None;
        }
        self.words.extend_from_slice(&block.words);
        self.codes.extend_from_slice(codes);
        self.codes.resize(self.words.len(), Code::NONE);
        self.keep(Kept::Words { first, count, computed, plain, is_short }, Quick::Not, frame)
    }

    /// Keeps a statement, or a block with nothing to execute; `None` when there is no room.
    pub(crate) fn keep_statement(
        &mut self,
        statement: Option<(Statement, Quick)>,
        frame: Frame<'_>,
    ) -> Option<BlockId> {
        let (kept, quick) = match statement {
            Some((statement, quick)) => (Kept::Statement(statement), quick),
            None => (Kept::Blank, Quick::Next),
        };
        if self.has_room(frame.line.len()) { self.keep(kept, quick, frame) } else { None }
    }

    fn has_room(&self, more: usize) -> bool {
        // The table of places holds as much again as an entry at most.
        let entries = self.entries.len() * (size_of::<Entry>() + size_of::<(Quick, Links)>() + 48);
        let words = self.words.len() * (size_of::<Word>() + size_of::<Code>());
        entries + words + self.text.len() + more < CACHE_BYTES_MAX
    }

    fn keep(&mut self, kept: Kept, quick: Quick, frame: Frame<'_>) -> Option<BlockId> {
        let id = BlockId(NonZeroU32::new(self.entries.len() as u32 + 1)?);
        let start = self.text.len() as u32;
        self.text.extend_from_slice(frame.line);
        let text = (start, self.text.len() as u32);
        let Place { at, start, behind, skip } = frame.place;
        self.entries.push(Entry { at, start, behind, kept, skip, text });
        // A block that a switch may skip is looked at each time.
        self.quick.push((if skip == 0 { quick } else { Quick::Not }, Links::default()));
        self.places.insert((start.line.source, start.line.offset, start.from as u32), id);
        self.arrive(id);
        Some(id)
    }
}

/// Where a block that is to be kept stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) at: BlockPlace,
    pub(crate) start: Resume,
    pub(crate) behind: Resume,
    /// Switches that skip it.
    pub(crate) skip: u16,
}

impl Place {
    /// The place with the text of its line.
    pub(crate) fn of(self, line: &[u8]) -> Frame<'_> {
        Frame { place: self, line }
    }
}

/// A place with the text of its line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<'a> {
    place: Place,
    line: &'a [u8],
}
