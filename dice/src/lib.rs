//! Seeded random choices for tests, examples and benchmarks: the same on every machine, run after run.
//!
//! Not for the product, which has no chance in it.

/// Marsaglia's xorshift64* generator.
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// From a seed that is not 0.
    pub const fn new(seed: u64) -> Self {
        assert!(seed != 0, "from 0 nothing else comes");
        Self(seed)
    }

    /// Any whole number.
    pub const fn roll(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A whole number below `count`, which is not 0.
    pub const fn below(&mut self, count: u64) -> u64 {
        // The high bits are the better ones.
        (self.roll() >> 16) % count
    }

    /// A place among so many; 0 among none.
    pub const fn index(&mut self, length: usize) -> usize {
        if length == 0 { 0 } else { self.below(length as u64) as usize }
    }

    /// A whole number from `low` to `high`, both included.
    pub const fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    /// From 0 up to, not including, 1.
    pub const fn part(&mut self) -> f64 {
        (self.roll() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From `low` up to `high`.
    pub const fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    /// Between two values above zero, all sizes alike.
    pub fn size(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.part())
    }

    /// True once in so many times.
    pub const fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    /// True so many times in a hundred.
    pub const fn percent(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    /// One of them; there is at least one.
    pub const fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.index(from.len())]
    }
}
