//! Speed caps along the path, and how far each one reaches.
//!
//! In: [`Cap`]s, one behind the other; a cap of no length is a corner. Out: [`Span`]s of constant speed, each cap
//! widened on both sides by its speed × half the averaging window.
//!
//! Why: the averaging of [`super::phases`] mixes what lies half a window before and behind. A profile that keeps a
//! speed on the widened stretch has, averaged, no more than that speed on the stretch itself. Proof: were the mean
//! speed above V, the window would cover more path than V·T; it would reach beyond the widened stretch on one side
//! only, and the mean place would lie beyond the stretch.

use super::{least, most};

/// What the operator makes of the speeds that the program orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feedrate {
    /// Override, 1 for 100 %.
    Override(f64),
    /// Dry run: one speed everywhere, mm/s.
    Fixed(f64),
}

/// A stretch of path and the speeds that hold on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Where it begins, mm along the path.
    pub start_mm: f64,
    /// Where it ends; for a corner the same place.
    pub end_mm: f64,
    /// The speed that the program asks for, before any override.
    pub ordered_mm_per_s: f64,
    /// The speed that the machine allows whatever the override.
    pub limit_mm_per_s: f64,
    /// What the operator makes of the speed here.
    pub(super) feedrate: Feedrate,
    /// What its width is measured with: that of the profile which the tool already follows.
    pub(super) width_feedrate: Feedrate,
}

/// The slowest that a cap may be: below it a path would take for ever.
pub const SPEED_MIN_MM_PER_S: f64 = 1e-6;

impl Cap {
    /// The speed that the operator allows.
    pub(super) fn speed(&self, feedrate: Feedrate) -> f64 {
        let ordered = match feedrate {
            Feedrate::Override(factor) => self.ordered_mm_per_s * factor,
            // A corner is no order: only its limit counts.
            Feedrate::Fixed(_) if self.ordered_mm_per_s == f64::INFINITY => f64::INFINITY,
            Feedrate::Fixed(mm_per_s) => mm_per_s,
        };
        most(least(ordered, self.limit_mm_per_s), SPEED_MIN_MM_PER_S)
    }

    /// Speed and width as the operator had them when it came.
    pub(super) fn wide_span(&self) -> WideSpan {
        let span = Span { start: self.start_mm, end: self.end_mm, speed: self.speed(self.feedrate) };
        WideSpan { span, width_speed: self.speed(self.width_feedrate) }
    }
}

/// A span to be widened, and the speed whose way in half a window is the width.
#[derive(Clone, Copy, Debug)]
pub(super) struct WideSpan {
    pub(super) span: Span,
    pub(super) width_speed: f64,
}

/// A stretch with one highest speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) speed: f64,
}

impl Span {
    /// The same stretch seen from the other end.
    fn mirrored(self) -> Self {
        Self { start: -self.end, end: -self.start, speed: self.speed }
    }
}

/// Room for widening, used again and again.
#[derive(Clone, Debug)]
pub(super) struct Room {
    wide: Vec<WideSpan>,
    forward: Vec<Span>,
    backward: Vec<Span>,
}

impl Room {
    /// For so many caps: each is cut in two at most by those that reach on.
    pub(super) fn for_caps(caps: usize) -> Self {
        let spans = || Vec::with_capacity(2 * caps + 2);
        Self { wide: Vec::with_capacity(caps), forward: spans(), backward: spans() }
    }
}

/// The spans of caps. A corner that is no slower than a stretch beside it changes nothing: it is left out, whoever
/// comes between later.
fn collect<'a>(caps: impl Iterator<Item = &'a Cap>, out: &mut Vec<WideSpan>) {
    out.clear();
    let mut corner: Option<WideSpan> = None;
    let mut before = f64::INFINITY;
    for cap in caps {
        let wide = cap.wide_span();
        let is_corner = cap.start_mm == cap.end_mm;
        out.extend(corner.take().filter(|corner| is_corner || corner.span.speed < wide.span.speed));
        if !is_corner {
            before = wide.span.speed;
            out.push(wide);
        } else if wide.span.speed < before {
            corner = Some(wide);
        }
    }
    out.extend(corner);
}

/// Widens caps to both sides, into `out`.
pub(super) fn widen<'a>(
    caps: impl Iterator<Item = &'a Cap>,
    half_window_s: f64,
    room: &mut Room,
    out: &mut Vec<Span>,
) {
    collect(caps, &mut room.wide);
    let wide = room.wide.iter();
    widen_forward(wide.clone().copied(), half_window_s, &mut room.forward);
    widen_forward(
        wide.rev().map(|wide| WideSpan { span: wide.span.mirrored(), ..*wide }),
        half_window_s,
        &mut room.backward,
    );
    out.clear();
    let mut backward = room.backward.iter().rev().map(|span| span.mirrored());
    let Some(mut other) = backward.next() else { return };
    for span in &room.forward {
        let mut at = span.start;
        while at < span.end {
            let to = least(span.end, other.end);
            append(out, Span { start: at, end: to, speed: least(span.speed, other.speed) });
            at = to;
            if other.end <= at {
                match backward.next() {
                    Some(next) => other = next,
                    None => return,
                }
            }
        }
    }
}

fn widen_forward(spans: impl Iterator<Item = WideSpan>, half_window_s: f64, out: &mut Vec<Span>) {
    out.clear();
    let mut carries = Carries::default();
    for WideSpan { span, width_speed } in spans {
        let mut at = span.start;
        while at < span.end {
            let (to, speed) = match carries.lowest(at) {
                Some(carry) if carry.speed < span.speed => (least(carry.until, span.end), carry.speed),
                _ => (span.end, span.speed),
            };
            append(out, Span { start: at, end: to, speed });
            at = to;
        }
        carries.add(Carry { speed: span.speed, until: span.end + width_speed * half_window_s });
    }
}

/// Adds a span, or lengthens the last one when the speed is the same.
fn append(out: &mut Vec<Span>, span: Span) {
    match out.last_mut() {
        Some(last) if last.speed == span.speed => last.end = span.end,
        _ => out.push(span),
    }
}

/// A cap that reaches on.
#[derive(Clone, Copy, Debug, Default)]
struct Carry {
    speed: f64,
    until: f64,
}

/// Caps kept at once. When more would reach on, the two fastest become one that is slow and long enough for both.
const CARRIES_MAX: usize = 32;

/// The caps that reach on, slowest and shortest first: one that is neither slower nor longer than another is not kept.
#[derive(Clone, Copy, Debug, Default)]
struct Carries {
    list: [Carry; CARRIES_MAX],
    count: usize,
}

impl Carries {
    /// The slowest that still reaches on at a place.
    fn lowest(&mut self, at: f64) -> Option<Carry> {
        let over = self.list[..self.count].iter().take_while(|carry| carry.until <= at).count();
        self.list.copy_within(over..self.count, 0);
        self.count -= over;
        self.list[..self.count].first().copied()
    }

    fn add(&mut self, new: Carry) {
        let kept = &self.list[..self.count];
        let slower = kept.iter().take_while(|carry| carry.speed < new.speed).count();
        if slower > 0 && kept[slower - 1].until >= new.until {
            return;
        }
        let covered = kept[slower..].iter().take_while(|carry| carry.until <= new.until).count();
        let rest = slower + covered..self.count;
        if covered > 0 {
            self.list[slower] = new;
            self.list.copy_within(rest.clone(), slower + 1);
            self.count = slower + 1 + rest.len();
            return;
        }
        if self.count == CARRIES_MAX {
            self.list[CARRIES_MAX - 2].until = self.list[CARRIES_MAX - 1].until.max(new.until);
            self.count -= 1;
            if slower >= self.count {
                self.list[self.count - 1].speed = self.list[self.count - 1].speed.min(new.speed);
                return;
            }
        }
        self.list.copy_within(slower..self.count, slower + 1);
        self.list[slower] = new;
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widened(spans: &[(f64, f64, f64)], half_window_s: f64) -> Vec<(f64, f64, f64)> {
        let (mut room, mut out) = (Room::for_caps(4), Vec::new());
        let caps: Vec<_> = spans
            .iter()
            .map(|&(start_mm, end_mm, limit_mm_per_s)| Cap {
                start_mm,
                end_mm,
                ordered_mm_per_s: f64::INFINITY,
                limit_mm_per_s,
                feedrate: Feedrate::Override(1.0),
                width_feedrate: Feedrate::Override(1.0),
            })
            .collect();
        widen(caps.iter(), half_window_s, &mut room, &mut out);
        out.iter().map(|span| (span.start, span.end, span.speed)).collect()
    }

    #[test]
    fn a_corner_and_a_slow_stretch_reach_to_both_sides() {
        // Half a window of 0.1 s: the corner at 10 mm with 5 mm/s holds for half a millimetre on each side.
        let spans = [(0.0, 10.0, 20.0), (10.0, 10.0, 5.0), (10.0, 30.0, 20.0), (30.0, 40.0, 10.0)];
        assert_eq!(
            widened(&spans, 0.1),
            [(0.0, 9.5, 20.0), (9.5, 10.5, 5.0), (10.5, 29.0, 20.0), (29.0, 40.0, 10.0)]
        );
    }

    #[test]
    fn each_place_has_the_lowest_of_all_that_reach_it() {
        // Any number of stretches, also more than are carried at once: never faster than each cap by itself allows.
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        for _ in 0..300 {
            let half_window_s = 0.2 * random();
            let mut at = 0.0;
            let mut spans = Vec::new();
            for _ in 0..60 {
                let length = if random() < 0.3 { 0.0 } else { random() * random() };
                spans.push((at, at + length, 0.1 + 20.0 * random()));
                at += length;
            }
            let out = widened(&spans, half_window_s);
            for (index, (start, end, speed)) in spans.iter().enumerate() {
                // A corner between slower stretches is none.
                let is_slower = |span: Option<&(f64, f64, f64)>| span.is_some_and(|span| span.2 <= *speed);
                let is_stretch = |span: &&(f64, f64, f64)| span.0 < span.1;
                let before = spans[..index].iter().rfind(is_stretch);
                let behind = spans[index + 1..].iter().find(is_stretch);
                if start == end && (is_slower(before) || is_slower(behind)) {
                    continue;
                }
                let reach = speed * half_window_s;
                for (from, to, allowed) in &out {
                    let overlaps = *from < end + reach - 1e-9 && *to > start - reach + 1e-9;
                    assert!(!overlaps || allowed <= speed, "{start}..{end} {speed}: {from}..{to} {allowed}");
                }
            }
            assert!(out.windows(2).all(|pair| pair[0].1 == pair[1].0), "{out:?}");
        }
    }
}
