//! Limits that keep any program within bounded time and memory. Each has its own diagnostic.

/// Blocks executed in one run (`block-limit-reached`): more than a machine runs in a week, few enough for a loop
/// without an end to be told within seconds. Who reads long texts adds what they hold.
pub const BLOCKS_MAX: u64 = 6_000_000;

/// Blocks of loops executed without a move (`loop-without-motion`). A block that has to be read anew counts
/// for [`IDLE_READ_BLOCKS`].
pub const IDLE_BLOCKS_MAX: u64 = 8_000_000;

/// What a block of a loop that is not kept counts for, against the limit above: as much as it takes.
pub const IDLE_READ_BLOCKS: u64 = 10;

/// What a kept block of words counts for beyond itself.
pub const IDLE_WORD_BLOCKS: u64 = 3;

/// What looking a computed label up, or asking for a system variable, counts for beyond its block.
pub const IDLE_LOOK_UPS: u64 = 2;

/// Texts that calls lead to and fro between without reading them anew.
pub const PARKED_TEXTS_MAX: usize = 8;

/// What a call counts for beyond its block.
pub const IDLE_CALLS: u64 = 60;

/// Memory for blocks that are kept because they run again; beyond it they are read anew.
pub const CACHE_BYTES_MAX: usize = 16 * 1024 * 1024;

/// Texts up to this length are held in memory once a program jumps in them.
pub const HELD_TEXT_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// Moves made by one cycle block (`cycle-move-limit`).
pub const CYCLE_MOVES_MAX: u64 = 5_000_000;

/// Moves made by all cycles of one run (`cycle-move-limit`).
pub const RUN_MOVES_MAX: u64 = 8_000_000;

/// Warnings kept; further ones are counted (`too-many-diagnostics`).
pub const WARNINGS_MAX: usize = 200;

/// Lines with a sequence number that are remembered for searching (`file-too-large`).
pub const SEQUENCES_MAX: usize = 20_000_000;
