//! Limits that keep any program within bounded time and memory. Each has its own diagnostic.

/// Blocks executed in one run (`block-limit-reached`).
pub const BLOCKS_MAX: u64 = 30_000_000;

/// Moves made by one cycle block (`cycle-move-limit`).
pub const CYCLE_MOVES_MAX: u64 = 5_000_000;

/// Moves made by all cycles of one run (`cycle-move-limit`).
pub const RUN_MOVES_MAX: u64 = 200_000_000;

/// Warnings kept; further ones are counted (`too-many-diagnostics`).
pub const WARNINGS_MAX: usize = 200;

/// Lines with a sequence number that are remembered for searching (`file-too-large`).
pub const SEQUENCES_MAX: usize = 20_000_000;
