//! Reach: how fast the path can be taken when acceleration is limited.
//!
//! In: spans of highest speed and the state at the start. Out: [`Knot`]s, places with the square of the speed there;
//! between two of them the square changes evenly, by no more than the growth of the span.
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
    /// By how much the square may change on each millimetre of the way here.
    pub(super) growth: f64,
    /// The profile was lowered here: what comes before it does not tell.
    pub(super) is_lowered: bool,
}

impl Knot {
    pub(super) const fn new(at: f64, square: f64, growth: f64) -> Self {
        Self { at, square, growth, is_lowered: false }
    }
}

/// Relative slack for values that are equal but for rounding.
pub(super) const SLACK: f64 = 1e-9;

/// The highest squares of speed at the start of each span, and behind the last one, from which the tool can still
/// keep all that comes and stand at the end.
pub(super) fn backward(spans: &[Span], out: &mut Vec<f64>) {
    out.clear();
    out.resize(spans.len() + 1, 0.0);
    let mut square = 0.0f64;
    for (index, span) in spans.iter().enumerate().rev() {
        out[index + 1] = square;
        square = least(square + span.growth * (span.end - span.start), span.speed * span.speed);
        if let Some(before) = index.checked_sub(1) {
            square = least(square, spans[before].speed * spans[before].speed);
        }
        out[index] = square;
    }
}

/// The fastest profile from the start on. The start is no faster than [`backward`] says.
pub(super) fn forward(spans: &[Span], bounds: &[f64], start: Knot, out: &mut Vec<Knot>) {
    out.clear();
    out.push(start);
    let mut square = start.square;
    for (span, goal) in spans.iter().zip(&bounds[1..]) {
        let growth = span.growth;
        let change = growth * (span.end - span.start);
        if square - goal >= change * (1.0 - SLACK) {
            square = *goal;
        } else if square + change <= *goal {
            square += change;
        } else {
            let top = least((square + goal + change) / 2.0, span.speed * span.speed);
            let peak = most(most(top, square), *goal);
            push(out, span.start + (peak - square) / growth, peak, growth);
            push(out, span.end - (peak - goal) / growth, peak, growth);
            square = *goal;
        }
        push(out, span.end, square, growth);
    }
}

fn push(out: &mut Vec<Knot>, at: f64, square: f64, growth: f64) {
    if out.last().is_none_or(|last| at > last.at) {
        out.push(Knot::new(at, square, growth));
    }
}

/// Whether a state is too fast for what comes within `distance`: an order that came down, or a hold.
pub(super) fn is_too_fast(spans: &[Span], bounds: &[f64], start: Knot, distance: f64) -> bool {
    let to = start.at + distance;
    let allowed = |at: f64, span: &Span, goal: f64| {
        (goal + span.growth * (span.end - at)).min(span.speed * span.speed) * (1.0 + SLACK) >= start.square
    };
    spans.iter().zip(&bounds[1..]).take_while(|(span, _)| span.start <= to).any(|(span, goal)| {
        !allowed(span.start.max(start.at), span, *goal) || !allowed(span.end.min(to), span, *goal)
    })
}

/// The way of a tool that brakes from `start` until it is down at what is allowed, or at rest when it is held: one
/// knot for each acceleration on the way.
pub(super) fn brake(spans: &[Span], bounds: &[f64], is_held: bool, start: Knot, out: &mut Vec<Knot>) {
    out.clear();
    let mut knot = start;
    for (span, goal) in spans.iter().zip(&bounds[1..]).filter(|(span, _)| span.end > start.at) {
        let growth = span.growth;
        let at = knot.at.max(span.start);
        let room = span.end - at;
        let reachable = !is_held && knot.square <= (goal + growth * room) * (1.0 + SLACK);
        let cap = span.speed * span.speed;
        if reachable && knot.square <= cap * (1.0 + SLACK) {
            break;
        }
        let rest = knot.square - growth * room;
        knot = if reachable && (knot.square - cap) / growth < room {
            Knot::new(at + (knot.square - cap) / growth, cap, growth)
        } else if rest <= 0.0 {
            Knot::new(at + knot.square / growth, 0.0, growth)
        } else {
            Knot::new(span.end, rest, growth)
        };
        match out.last_mut() {
            Some(last) if last.growth == growth => *last = knot,
            _ => out.push(knot),
        }
        if knot.square == 0.0 || knot.square == cap && reachable {
            break;
        }
    }
    if let Some(last) = out.last_mut().filter(|_| is_held) {
        // At the end of the path but for rounding.
        last.square = 0.0;
    }
}
