//! Times block by block, and line by line.
//!
//! In: every command with its [`Timing`], in order of execution. Out: a [`BlockTime`] for each stretch of commands that
//! one block made, as soon as the next block begins, and the sum of every line.
//!
//! Memory is bounded: of lines past [`LINES_MAX`] only the sum of all is kept.

use std::collections::BTreeMap;
use std::time::Duration;

use turnwright_canon::{Command, Origin};

use crate::{Timing, Totals};

/// Lines whose times are kept apart.
pub const LINES_MAX: usize = 100_000;

/// The time of a block. Of a block that runs again at once, without another between, both are counted together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockTime {
    /// When it began.
    pub start: Duration,
    /// The block: the origin of its first command.
    pub origin: Origin,
    /// Number of the operation it belongs to, from 1.
    pub operation: usize,
    /// Turret station, when one has been called.
    pub tool: Option<u32>,
    /// What its time is spent on.
    pub times: Totals,
}

/// The time of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineTime {
    /// In all.
    pub time: Duration,
    /// How often its block ran.
    pub runs: u64,
}

/// Times by block and line.
#[derive(Clone, Debug, Default)]
pub struct BlockTimes {
    block: Option<BlockTime>,
    now: Duration,
    lines: BTreeMap<(u32, u32), LineTime>,
    rest: LineTime,
    /// Text, line and call depth of the last block.
    last_run: Option<(u32, u32, u8)>,
}

impl BlockTimes {
    /// Adds one command of an operation; the block before it, when it begins another.
    pub fn add(
        &mut self,
        command: &Command,
        timing: &Timing,
        operation: usize,
        tool: Option<u32>,
    ) -> Option<BlockTime> {
        let origin = command.origin;
        let mut last = None;
        let of_block = |block: &BlockTime| {
            let first = &block.origin;
            (first.source, first.line, first.depth, block.operation)
                == (origin.source, origin.line, origin.depth, operation)
        };
        if !self.block.as_ref().is_some_and(of_block) {
            last = self.finish();
            self.block =
                Some(BlockTime { start: self.now, origin, operation, tool, times: Totals::default() });
        }
        if let Some(block) = &mut self.block {
            block.times.add(timing);
        }
        self.now = self.now.saturating_add(timing.time());
        last
    }

    /// The last block; no more commands come.
    pub fn finish(&mut self) -> Option<BlockTime> {
        let block = self.block.take()?;
        let key = (block.origin.source, block.origin.line);
        let has_room = self.lines.len() < LINES_MAX;
        let line = match self.lines.get_mut(&key) {
            Some(line) => line,
            None if has_room => self.lines.entry(key).or_default(),
            None => &mut self.rest,
        };
        line.time = line.time.saturating_add(block.times.total());
        // A block whose moves are two operations runs once all the same.
        let run = (block.origin.source, block.origin.line, block.origin.depth);
        line.runs += u64::from(self.last_run.replace(run) != Some(run));
        Some(block)
    }

    /// Text, line and time of every line that was kept.
    pub fn lines(&self) -> impl Iterator<Item = (u32, u32, LineTime)> {
        self.lines.iter().map(|((source, line), time)| (*source, *line, *time))
    }

    /// The lines that took longest, the longest first.
    pub fn longest(&self, count: usize) -> Vec<(u32, u32, LineTime)> {
        let mut longest: Vec<_> = self.lines().collect();
        longest.sort_by_key(|(.., line)| std::cmp::Reverse(line.time));
        longest.truncate(count);
        longest
    }

    /// The lines that were not kept, together.
    pub const fn rest(&self) -> LineTime {
        self.rest
    }
}
