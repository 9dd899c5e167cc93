//! Reach: how fast the path can be taken when acceleration is limited.
//!
//! In: spans of highest speed and the state at the start. Out: [`Knot`]s, places with the square of the speed there;
//! between two of them the square changes evenly, by no more than twice the acceleration per millimetre.
//!
//! Two passes, both linear: backward from the end, where the tool stands, and forward from the start.

use super::caps::Span;
use super::{least, most};

/// A place and the square of the speed there. Speeds are kept squared: along the path the square grows evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    /// Place on the path, mm.
    pub(super) at: f64,
    /// Speed × speed, mm²/s².
    pub(super) square: f64,
    /// The profile was lowered here: what comes before it does not tell.
    pub(super) is_lowered: bool,
}

impl Knot {
    pub(super) const fn new(at: f64, square: f64) -> Self {
        Self { at, square, is_lowered: false }
    }
}

/// Relative slack for values that are equal but for rounding.
pub(super) const SLACK: f64 = 1e-9;

/// The highest squares of speed at the start of each span, and behind the last one, from which the tool can still
/// keep all that comes and stand at the end. `growth` is twice the acceleration.
pub(super) fn backward(spans: &[Span], growth: f64, out: &mut Vec<f64>) {
    out.clear();
    out.resize(spans.len() + 1, 0.0);
    let mut square = 0.0f64;
    for (index, span) in spans.iter().enumerate().rev() {
        out[index + 1] = square;
        square = least(square + growth * (span.end - span.start), span.speed * span.speed);
        if let Some(before) = index.checked_sub(1) {
            square = least(square, spans[before].speed * spans[before].speed);
        }
        out[index] = square;
    }
}

/// The fastest profile from the start on. The start is no faster than [`backward`] says.
pub(super) fn forward(spans: &[Span], bounds: &[f64], growth: f64, start: Knot, out: &mut Vec<Knot>) {
    out.clear();
    out.push(start);
    let mut square = start.square;
    for (span, goal) in spans.iter().zip(&bounds[1..]) {
        let change = growth * (span.end - span.start);
        if square - goal >= change * (1.0 - SLACK) {
            square = *goal;
        } else if square + change <= *goal {
            square += change;
        } else {
            let top = least((square + goal + change) / 2.0, span.speed * span.speed);
            let peak = most(most(top, square), *goal);
            push(out, span.start + (peak - square) / growth, peak);
            push(out, span.end - (peak - goal) / growth, peak);
            square = *goal;
        }
        push(out, span.end, square);
    }
}

fn push(out: &mut Vec<Knot>, at: f64, square: f64) {
    if out.last().is_none_or(|last| at > last.at) {
        out.push(Knot::new(at, square));
    }
}

/// Whether a state is too fast for what comes within `distance`: an order that came down, or a hold.
pub(super) fn is_too_fast(spans: &[Span], bounds: &[f64], growth: f64, start: Knot, distance: f64) -> bool {
    let to = start.at + distance;
    let allowed = |at: f64, span: &Span, goal: f64| {
        (goal + growth * (span.end - at)).min(span.speed * span.speed) * (1.0 + SLACK) >= start.square
    };
    spans.iter().zip(&bounds[1..]).take_while(|(span, _)| span.start <= to).any(|(span, goal)| {
        !allowed(span.start.max(start.at), span, *goal) || !allowed(span.end.min(to), span, *goal)
    })
}

/// Where a tool that brakes from `start` comes down to what is allowed.
pub(super) fn brake(spans: &[Span], bounds: &[f64], growth: f64, start: Knot) -> Knot {
    let mut knot = start;
    for (span, goal) in spans.iter().zip(&bounds[1..]) {
        let at = knot.at.max(span.start);
        let room = span.end - at;
        let reachable = knot.square <= (goal + growth * room) * (1.0 + SLACK);
        let cap = span.speed * span.speed;
        if reachable && knot.square <= cap * (1.0 + SLACK) {
            return knot;
        }
        let way = (knot.square - cap) / growth;
        if reachable && way < room {
            return Knot::new(at + way, cap);
        }
        let rest = knot.square - growth * room;
        if rest <= 0.0 {
            return Knot::new(at + knot.square / growth, 0.0);
        }
        knot = Knot::new(span.end, rest);
    }
    knot
}
