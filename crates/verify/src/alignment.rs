//! Two sequences beside each other: which stretches of one stand in the place of which stretches of the other.
//!
//! The shortest way from one to the other, after Myers (1986). Of several that are equally short the same one is taken
//! whichever sequence comes first.

use std::ops::Range;

/// Sequences that differ in more places are not looked at one by one: what lies between their common begin and their
/// common end is one stretch.
pub(crate) const EDITS_MAX: usize = 1_500;

/// A stretch of the first sequence that stands where a stretch of the second does; either may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Hunk {
    pub(crate) first: Range<usize>,
    pub(crate) second: Range<usize>,
}

/// Where two sequences differ, in order.
pub(crate) fn hunks(first: &[u32], second: &[u32]) -> Vec<Hunk> {
    if first <= second {
        return ordered_hunks(first, second);
    }
    let swapped = ordered_hunks(second, first).into_iter();
    swapped.map(|hunk| Hunk { first: hunk.second, second: hunk.first }).collect()
}

fn ordered_hunks(a: &[u32], b: &[u32]) -> Vec<Hunk> {
    let head = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    let (a_rest, b_rest) = (&a[head..], &b[head..]);
    let tail = a_rest.iter().rev().zip(b_rest.iter().rev()).take_while(|(a, b)| a == b).count();
    let (a_middle, b_middle) = (&a_rest[..a_rest.len() - tail], &b_rest[..b_rest.len() - tail]);
    if a_middle.is_empty() && b_middle.is_empty() {
        return Vec::new();
    }
    let whole = || vec![Hunk { first: 0..a_middle.len(), second: 0..b_middle.len() }];
    let mut hunks = shortest(a_middle, b_middle).unwrap_or_else(whole);
    for hunk in &mut hunks {
        for range in [&mut hunk.first, &mut hunk.second] {
            *range = range.start + head..range.end + head;
        }
    }
    hunks
}

/// The hunks of the shortest way; nothing when it is too long.
fn shortest(a: &[u32], b: &[u32]) -> Option<Vec<Hunk>> {
    let (width, height) = (a.len() as isize, b.len() as isize);
    let most = (a.len() + b.len()).min(EDITS_MAX);
    // For each diagonal, how far along `a` one comes with so many edits; the diagonals are counted from −edits.
    let mut rows: Vec<Vec<isize>> = Vec::new();
    for edits in 0..=most as isize {
        let mut row = vec![0; 2 * edits as usize + 1];
        for diagonal in (-edits..=edits).step_by(2) {
            let mut x = step(&rows, edits, diagonal).0;
            let mut y = x - diagonal;
            while x < width && y < height && a[x as usize] == b[y as usize] {
                x += 1;
                y += 1;
            }
            row[(diagonal + edits) as usize] = x;
            if x >= width && y >= height {
                return Some(trace_back(&rows, edits, (width, height)));
            }
        }
        rows.push(row);
    }
    None
}

/// The furthest start of a diagonal, and the diagonal that it comes from.
fn step(rows: &[Vec<isize>], edits: isize, diagonal: isize) -> (isize, isize) {
    if edits == 0 {
        return (0, 0);
    }
    let before = &rows[(edits - 1) as usize];
    let reach = |diagonal: isize| {
        usize::try_from(diagonal + edits - 1).ok().and_then(|index| before.get(index)).copied()
    };
    match (reach(diagonal - 1), reach(diagonal + 1)) {
        (Some(left), Some(above)) if left < above => (above, diagonal + 1),
        (Some(left), _) => (left + 1, diagonal - 1),
        (None, above) => (above.unwrap_or(0), diagonal + 1),
    }
}

fn trace_back(rows: &[Vec<isize>], edits: isize, end: (isize, isize)) -> Vec<Hunk> {
    let mut hunks: Vec<Hunk> = Vec::new();
    let mut diagonal = end.0 - end.1;
    for edits in (1..=edits).rev() {
        let (start, from) = step(rows, edits, diagonal);
        let y = start - diagonal;
        let (first, second) = if from < diagonal {
            ((start - 1) as usize..start as usize, y as usize..y as usize)
        } else {
            (start as usize..start as usize, (y - 1) as usize..y as usize)
        };
        match hunks.last_mut() {
            Some(hunk) if hunk.first.start == first.end && hunk.second.start == second.end => {
                *hunk = Hunk { first: first.start..hunk.first.end, second: second.start..hunk.second.end };
            }
            _ => hunks.push(Hunk { first: first.clone(), second: second.clone() }),
        }
        diagonal = from;
    }
    hunks.reverse();
    hunks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(a: &[u32], b: &[u32]) -> Vec<(Range<usize>, Range<usize>)> {
        hunks(a, b).into_iter().map(|hunk| (hunk.first, hunk.second)).collect()
    }

    #[test]
    fn what_differs_is_found_and_nothing_else() {
        assert_eq!(found(&[1, 2, 3], &[1, 2, 3]), []);
        assert_eq!(found(&[1, 2, 3], &[1, 9, 3]), [(1..2, 1..2)]);
        assert_eq!(found(&[1, 2, 3, 4], &[1, 4]), [(1..3, 1..1)]);
        assert_eq!(found(&[1, 4, 5, 7], &[1, 2, 4, 5, 8, 9, 7]), [(1..1, 1..2), (3..3, 4..6)]);
        assert_eq!(found(&[], &[1, 2]), [(0..0, 0..2)]);
    }

    #[test]
    fn any_two_sequences_mirror_and_replay() {
        let mut state = 1_u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for _ in 0..500 {
            let (length, other) = (random(12), random(12));
            let a: Vec<u32> = (0..length).map(|_| random(4)).collect();
            let b: Vec<u32> = (0..other).map(|_| random(4)).collect();
            let there = hunks(&a, &b);
            let back = hunks(&b, &a);
            assert_eq!(there.len(), back.len());
            let mirrored = there.iter().zip(&back).all(|(x, y)| x.first == y.second && x.second == y.first);
            assert!(mirrored || a == b, "{a:?} {b:?}");
            // What lies between the hunks is the same, so that the second can be made of the first.
            let (mut made, mut at) = (Vec::new(), 0);
            for hunk in &there {
                made.extend_from_slice(&a[at..hunk.first.start]);
                made.extend_from_slice(&b[hunk.second.clone()]);
                at = hunk.first.end;
            }
            made.extend_from_slice(&a[at..]);
            assert_eq!(made, b, "{a:?}");
        }
    }

    #[test]
    fn sequences_that_have_nothing_in_common_cost_little() {
        let (a, b): (Vec<u32>, Vec<u32>) = ((0..5_000).collect(), (10_000..15_000).collect());
        assert_eq!(found(&a, &b), [(0..5_000, 0..5_000)]);
    }
}
