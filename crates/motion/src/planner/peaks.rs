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
pub(super) fn flatten(knots: &[Knot], window_s: f64, head_mm: f64, out: &mut Vec<Knot>) {
    out.clear();
    let mut valley = 0;
    let mut head_mm = head_mm;
    for &knot in knots {
        match out.last() {
            Some(top) if knot.square < top.square => {
                if lower(out, valley, head_mm, knot, window_s) {
                    (valley, head_mm) = (out.len() - 1, f64::INFINITY);
                }
            }
            _ => out.push(knot),
        }
    }
}

/// Takes off the top before a way down to `down` and adds that. Whether the hill is over; otherwise the way down was
/// used up, and `down` is the right end of the top.
fn lower(out: &mut Vec<Knot>, valley: usize, head_mm: f64, down: Knot, window_s: f64) -> bool {
    loop {
        let Some(&right) = out.last() else { return true };
        let flat = out[valley..].iter().rev().take_while(|knot| knot.square == right.square).count();
        let first = out.len() - flat;
        let head = if first == valley { head_mm } else { 0.0 };
        let span = right.at - out[first].at + head;
        let needed = |square: f64| window_s * square.sqrt() * (1.0 - SLACK);
        if first == valley || span >= needed(right.square) {
            out.push(down);
            return true;
        }
        let (left, below) = (out[first], out[first - 1]);
        out.truncate(first);
        let low = below.square.max(down.square);
        // So much way each flank gives for a square.
        let (of_left, of_right) = (1.0 / left.growth, 1.0 / down.growth);
        let way = of_left + of_right;
        if span + way * (right.square - low) >= needed(low) {
            let square = broad_top(right.square, span, way, window_s).clamp(low, right.square);
            let taken = right.square - square;
            out.push(Knot { at: left.at - taken * of_left, square, is_lowered: true, ..left });
            out.push(Knot::new(right.at + taken * of_right, square, down.growth));
            out.push(down);
            return true;
        }
        let taken = right.square - low;
        if low > below.square {
            out.push(Knot { at: left.at - taken * of_left, square: low, is_lowered: true, ..left });
        }
        if low == down.square {
            out.push(down);
            return false;
        }
        let at = right.at + taken * of_right;
        out.push(Knot { at, square: low, growth: down.growth, is_lowered: true });
    }
}

/// The square of the speed at which a top between two flanks lasts for the window, when `span` of it has `square` and
/// the flanks together give `way` for each square taken off.
fn broad_top(square: f64, span: f64, way: f64, window_s: f64) -> f64 {
    // x² + T·x / way = square + span / way.
    let half = window_s / (2.0 * way);
    let sum = square + span / way;
    let speed = sum / (half + (half * half + sum).sqrt());
    speed * speed
}

/// The ends of the top on a path of one speed from rest to rest.
pub(super) fn hill(length: f64, speed: f64, growth: f64, window_s: f64) -> [Knot; 2] {
    let top = (growth * length / 2.0).min(speed * speed);
    let flank = top / growth;
    let knot = |at: f64, square: f64| Knot::new(at, square, growth);
    let (left, right) = (knot(flank, top), knot((length - flank).max(flank), top));
    let span = right.at - left.at;
    if span >= window_s * top.sqrt() * (1.0 - SLACK) {
        return [left, right];
    }
    let square = broad_top(top, span, 1.0 / growth + 1.0 / growth, window_s).clamp(0.0, top);
    let way = (top - square) * (1.0 / growth);
    [Knot { at: left.at - way, square, is_lowered: true, growth }, knot(right.at + way, square)]
}
