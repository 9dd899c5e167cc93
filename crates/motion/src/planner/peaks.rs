//! Peaks: a top speed must last as long as the averaging window.
//!
//! In: the knots of [`super::reach`]. Out: the highest profile below it on which at least a window of time lies
//! between speeding up and slowing down. Then no window sees both, and the mean acceleration changes by no more than
//! the acceleration within a window: the jerk is limited. Valleys last that long by themselves, as caps are widened.
//!
//! One pass: the left flank of the hill in progress lies on a stack; a way down takes the top off until it is broad
//! enough.

use super::reach::{Knot, SLACK};

/// Flattens the peaks of `knots` into `out`. At the start the speed has already lasted for `head_mm`; infinite when it
/// was not reached by speeding up.
pub(super) fn flatten(knots: &[Knot], growth: f64, window_s: f64, head_mm: f64, out: &mut Vec<Knot>) {
    out.clear();
    let mut valley = 0;
    let mut head_mm = head_mm;
    for &knot in knots {
        match out.last() {
            Some(top) if knot.square < top.square => {
                if lower(out, valley, head_mm, knot, growth, window_s) {
                    (valley, head_mm) = (out.len() - 1, f64::INFINITY);
                }
            }
            _ => out.push(knot),
        }
    }
}

/// Takes off the top before a way down to `down` and adds that. Whether the hill is over; otherwise the way down was
/// used up, and `down` is the right end of the top.
fn lower(out: &mut Vec<Knot>, valley: usize, head_mm: f64, down: Knot, growth: f64, window_s: f64) -> bool {
    loop {
        let Some(&right) = out.last() else { return true };
        let flat = out[valley..].iter().rev().take_while(|knot| knot.square == right.square).count();
        let first = out.len() - flat;
        let head = if first == valley { head_mm } else { 0.0 };
        let span = right.at - out[first].at + head;
        let needed = |square: f64| window_s * square.sqrt() * (1.0 - SLACK);
        if span >= needed(right.square) || first == valley {
            out.push(down);
            return true;
        }
        let (left, below) = (out[first], out[first - 1]);
        out.truncate(first);
        let low = below.square.max(down.square);
        // Each flank gives way / growth per square, so the top broadens by twice that.
        if span + 2.0 * (right.square - low) / growth >= needed(low) {
            // x² + growth·T·x/2 = square + growth·span/2, x the speed at which the top lasts for the window.
            let half = growth * window_s / 4.0;
            let sum = right.square + growth * span / 2.0;
            let speed = sum / (half + (half * half + sum).sqrt());
            let square = (speed * speed).clamp(low, right.square);
            let way = (right.square - square) / growth;
            out.push(Knot { at: left.at - way, square, is_lowered: true });
            out.push(Knot::new(right.at + way, square));
            out.push(down);
            return true;
        }
        if low > below.square {
            out.push(Knot { at: left.at - (right.square - low) / growth, square: low, is_lowered: true });
        }
        if low == down.square {
            out.push(down);
            return false;
        }
        out.push(Knot { at: right.at + (right.square - low) / growth, square: low, is_lowered: true });
    }
}
