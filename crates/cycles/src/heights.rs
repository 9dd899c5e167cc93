//! The depths of a figure's corners, arranged so that the next one above or below a level is found by halving.
//!
//! In: depths in the order of the figure. Out: the first or last of them that lies at or below, or beyond, a level.
//! Each question takes as many steps as the number of corners has binary digits, so a figure of any size is
//! searched level by level in bounded time. Not here: what the depths mean.

/// Depths of corners, searched from either side.
#[derive(Clone, Debug)]
pub(crate) struct Heights {
    /// Half the length of `spans`: where the corners begin in it.
    leaves: usize,
    count: usize,
    /// Least and greatest depth of each span of corners; span `i` is made of spans `2i` and `2i + 1`.
    spans: Vec<(i64, i64)>,
}

const EMPTY: (i64, i64) = (i64::MAX, i64::MIN);

impl Heights {
    pub(crate) fn new(depths: impl ExactSizeIterator<Item = i64>) -> Self {
        let count = depths.len();
        let leaves = count.next_power_of_two();
        let mut spans = vec![EMPTY; 2 * leaves];
        for (span, depth) in spans[leaves..].iter_mut().zip(depths) {
            *span = (depth, depth);
        }
        for index in (1..leaves).rev() {
            let (left, right) = (spans[2 * index], spans[2 * index + 1]);
            spans[index] = (left.0.min(right.0), left.1.max(right.1));
        }
        Self { leaves, count, spans }
    }

    /// Depth of a corner.
    pub(crate) fn depth(&self, corner: usize) -> i64 {
        self.spans[self.leaves + corner].0
    }

    /// Index of the last corner.
    pub(crate) const fn last(&self) -> usize {
        self.count - 1
    }

    /// The first corner from `from` on that is deeper than `depth`.
    pub(crate) fn next_deeper(&self, from: usize, depth: i64) -> Option<usize> {
        self.next(from, |(_, greatest)| greatest > depth)
    }

    /// The first corner from `from` on that is no deeper than `depth`.
    pub(crate) fn next_up_to(&self, from: usize, depth: i64) -> Option<usize> {
        self.next(from, |(least, _)| least <= depth)
    }

    /// The last corner before `before` that is no deeper than `depth`.
    pub(crate) fn last_up_to(&self, before: usize, depth: i64) -> Option<usize> {
        let mut span = self.leaves + before.checked_sub(1)?;
        while self.spans[span].0 > depth {
            while span.is_multiple_of(2) {
                span /= 2;
            }
            if span == 1 {
                return None;
            }
            span -= 1;
        }
        while span < self.leaves {
            let right = 2 * span + 1;
            span = if self.spans[right].0 <= depth { right } else { right - 1 };
        }
        Some(span - self.leaves)
    }

    /// The least depth of the corners `from` to `to`, both included, in either order.
    pub(crate) fn least_between(&self, from: usize, to: usize) -> i64 {
        let (mut low, mut high) = (self.leaves + from.min(to), self.leaves + from.max(to));
        let mut least = self.spans[low].0.min(self.spans[high].0);
        while low / 2 != high / 2 {
            if low.is_multiple_of(2) {
                least = least.min(self.spans[low + 1].0);
            }
            if !high.is_multiple_of(2) {
                least = least.min(self.spans[high - 1].0);
            }
            (low, high) = (low / 2, high / 2);
        }
        least
    }

    fn next(&self, from: usize, holds: impl Fn((i64, i64)) -> bool) -> Option<usize> {
        if from >= self.count {
            return None;
        }
        let mut span = self.leaves + from;
        while !holds(self.spans[span]) {
            while !span.is_multiple_of(2) {
                span /= 2;
            }
            if span == 0 {
                return None;
            }
            span += 1;
        }
        while span < self.leaves {
            span = if holds(self.spans[2 * span]) { 2 * span } else { 2 * span + 1 };
        }
        Some(span - self.leaves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_question_is_answered_as_by_looking_one_by_one() {
        let depths = [4, 7, 7, 1, 0, 9, 3, 3, 8, -2, 5];
        for count in 1..=depths.len() {
            let depths = &depths[..count];
            let heights = Heights::new(depths.iter().copied());
            assert_eq!(heights.last(), count - 1);
            for from in 0..count {
                for level in -3..=10 {
                    let next = |holds: &dyn Fn(i64) -> bool| (from..count).find(|&at| holds(depths[at]));
                    assert_eq!(heights.next_deeper(from, level), next(&|depth| depth > level));
                    assert_eq!(heights.next_up_to(from, level), next(&|depth| depth <= level));
                    let last = (0..from).rev().find(|&at| depths[at] <= level);
                    assert_eq!(heights.last_up_to(from, level), last);
                }
                for to in 0..count {
                    let least = depths[from.min(to)..=from.max(to)].iter().copied().min();
                    assert_eq!(Some(heights.least_between(from, to)), least);
                }
            }
        }
    }
}
