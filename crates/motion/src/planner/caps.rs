//! Speed caps along the path, and how far each one reaches.
//!
//! In: [`Cap`]s, one behind the other; a cap of no length is a corner. Out: [`Span`]s of constant speed and
//! acceleration, each cap widened on both sides: its speed by the way of half the averaging window at that speed, its
//! acceleration by that of a whole one.
//!
//! Why: the averaging of [`super::phases`] mixes what lies half a window before and behind. A profile that keeps a
//! speed on the widened stretch has, averaged, no more than that speed on the stretch itself. Proof: were the mean
//! speed above V, the window would cover more path than V·T; it would reach beyond the widened stretch on one side
//! only, and the mean place would lie beyond the stretch. The mean acceleration on a stretch is one of its window, so
//! all of that has to lie where the acceleration is no more; it leaves the stretch no faster than V and with no more
//! than its acceleration A, and so gets no further than V·T + A·T²/2. A corner that is rounded behind the averaging is
//! felt for so much longer.

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
    /// How much acceleration it has along the path, in that of [`super::RunLimits`]: less where it bends, more where
    /// several axes share the way.
    pub(super) share: f64,
}

/// No stretch has a smaller share of the acceleration.
pub const SHARE_MIN: f64 = 0.1;

/// No stretch has a larger one.
pub const SHARE_MAX: f64 = 2.0;

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
    fn wide_speed(&self, half_window_s: f64) -> WideLevel {
        let level = Level { start: self.start_mm, end: self.end_mm, value: self.speed(self.feedrate) };
        WideLevel { level, reach: self.speed(self.width_feedrate) * half_window_s }
    }

    /// Share and its width.
    fn wide_share(&self, averaging: Averaging) -> WideLevel {
        let level = Level { start: self.start_mm, end: self.end_mm, value: self.share };
        let rounding_s = if self.start_mm == self.end_mm { averaging.rounding_s } else { 0.0 };
        let reach = averaging.reach_mm(self.speed(self.width_feedrate), self.share, rounding_s);
        WideLevel { level, reach }
    }
}

/// A stretch with one highest speed and one acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) speed: f64,
    /// How much the square of the speed may change on a millimetre: twice the acceleration.
    pub(super) growth: f64,
}

/// A stretch with one highest value: of the speed, or of the share of the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Level {
    start: f64,
    end: f64,
    value: f64,
}

impl Level {
    /// The same stretch seen from the other end.
    fn mirrored(self) -> Self {
        Self { start: -self.end, end: -self.start, value: self.value }
    }
}

/// What widens caps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Averaging {
    pub(super) window_s: f64,
    /// So much longer corners are felt, which are rounded behind the averaging.
    pub(super) rounding_s: f64,
    /// Of a share of 1.
    pub(super) acceleration: f64,
}

impl Averaging {
    /// How far a tool gets in one window, and so much longer, from a stretch that it leaves at a speed.
    pub(super) fn reach_mm(self, speed: f64, share: f64, longer_s: f64) -> f64 {
        let seconds = self.window_s + longer_s;
        seconds * (speed + share * self.acceleration * seconds / 2.0)
    }

    /// No stretch or corner with such a speed and share is felt further than this.
    pub(super) fn reach_max_mm(self, speed: f64, share: f64) -> f64 {
        self.reach_mm(speed, share, self.rounding_s)
    }
}

/// A level to be widened, and how far.
#[derive(Clone, Copy, Debug)]
struct WideLevel {
    level: Level,
    reach: f64,
}

/// Room for widening, used again and again.
#[derive(Clone, Debug)]
pub(super) struct Room {
    wide: Vec<WideLevel>,
    forward: Vec<Level>,
    backward: Vec<Level>,
    speeds: Vec<Level>,
    shares: Vec<Level>,
}

/// Spans of one value that a cap becomes at most: it is cut in two by those that reach on, on each of two passes.
const LEVELS_PER_CAP: usize = 4;

/// Spans that a cap becomes at most.
pub(super) const SPANS_PER_CAP: usize = 2 * LEVELS_PER_CAP;

impl Room {
    /// For so many caps.
    pub(super) fn for_caps(caps: usize) -> Self {
        let one_way = || Vec::with_capacity(LEVELS_PER_CAP / 2 * caps + 2);
        let both_ways = || Vec::with_capacity(LEVELS_PER_CAP * caps + 4);
        Self {
            wide: Vec::with_capacity(caps),
            forward: one_way(),
            backward: one_way(),
            speeds: both_ways(),
            shares: both_ways(),
        }
    }
}

/// The speeds of caps. A corner that is no slower than a stretch beside it changes nothing: it is left out, whoever
/// comes between later.
fn collect_speeds<'a>(caps: impl Iterator<Item = &'a Cap>, half_window_s: f64, out: &mut Vec<WideLevel>) {
    out.clear();
    let mut corner: Option<WideLevel> = None;
    let mut before = f64::INFINITY;
    for cap in caps {
        let wide = cap.wide_speed(half_window_s);
        let is_corner = cap.start_mm == cap.end_mm;
        out.extend(corner.take().filter(|corner| is_corner || corner.level.value < wide.level.value));
        if !is_corner {
            before = wide.level.value;
            out.push(wide);
        } else if wide.level.value < before {
            corner = Some(wide);
        }
    }
    out.extend(corner);
}

/// Widens caps to both sides, into `out`; `is_alike` when all have the same acceleration.
pub(super) fn widen<'a>(
    caps: impl Iterator<Item = &'a Cap> + Clone,
    is_alike: bool,
    averaging: Averaging,
    room: &mut Room,
    out: &mut Vec<Span>,
) {
    let Room { wide, forward, backward, speeds, shares } = room;
    let growth = 2.0 * averaging.acceleration;
    out.clear();
    collect_speeds(caps.clone(), averaging.window_s / 2.0, wide);
    if is_alike {
        return widen_both(wide, forward, backward, |start, end, speed| match out.last_mut() {
            Some(last) if last.speed == speed => last.end = end,
            _ => out.push(Span { start, end, speed, growth }),
        });
    }
    let collect = |out: &mut Vec<Level>, wide: &[WideLevel], forward: &mut _, backward: &mut _| {
        out.clear();
        widen_both(wide, forward, backward, |start, end, value| append(out, Level { start, end, value }));
    };
    collect(speeds, wide, forward, backward);
    wide.clear();
    let counts = |cap: &&Cap| cap.start_mm < cap.end_mm || cap.share < 1.0;
    wide.extend(caps.filter(counts).map(|cap| cap.wide_share(averaging)));
    collect(shares, wide, forward, backward);
    overlay(speeds, shares.iter().copied(), |start, end, speed, share| {
        out.push(Span { start, end, speed, growth: growth * share });
    });
}

/// Widens levels to both sides.
#[inline]
fn widen_both(
    wide: &[WideLevel],
    forward: &mut Vec<Level>,
    backward: &mut Vec<Level>,
    mut each: impl FnMut(f64, f64, f64),
) {
    widen_forward(wide.iter().copied(), forward);
    let mirrored = |wide: &WideLevel| WideLevel { level: wide.level.mirrored(), ..*wide };
    widen_forward(wide.iter().rev().map(mirrored), backward);
    overlay(forward, backward.iter().rev().map(|level| level.mirrored()), |start, end, one, other| {
        each(start, end, least(one, other));
    });
}

/// The stretches on which both of two rows have one value.
fn overlay(ones: &[Level], others: impl Iterator<Item = Level>, mut each: impl FnMut(f64, f64, f64, f64)) {
    let mut others = others;
    let Some(mut other) = others.next() else { return };
    for one in ones {
        let mut at = one.start;
        while at < one.end {
            let to = least(one.end, other.end);
            each(at, to, one.value, other.value);
            at = to;
            if other.end <= at {
                match others.next() {
                    Some(next) => other = next,
                    None => return,
                }
            }
        }
    }
}

fn widen_forward(levels: impl Iterator<Item = WideLevel>, out: &mut Vec<Level>) {
    out.clear();
    let mut carries = Carries::default();
    for WideLevel { level, reach } in levels {
        let mut at = level.start;
        while at < level.end {
            let (to, value) = match carries.lowest(at) {
                Some(carry) if carry.value < level.value => (least(carry.until, level.end), carry.value),
                _ => (level.end, level.value),
            };
            append(out, Level { start: at, end: to, value });
            at = to;
        }
        carries.add(Carry { value: level.value, until: level.end + reach });
    }
}

/// Adds a level, or lengthens the last one when the value is the same.
fn append(out: &mut Vec<Level>, level: Level) {
    match out.last_mut() {
        Some(last) if last.value == level.value => last.end = level.end,
        _ => out.push(level),
    }
}

/// A cap that reaches on.
#[derive(Clone, Copy, Debug, Default)]
struct Carry {
    value: f64,
    until: f64,
}

/// Caps kept at once. When more would reach on, the two highest become one that is low and long enough for both.
const CARRIES_MAX: usize = 32;

/// The caps that reach on, lowest and shortest first: one that is neither lower nor longer than another is not kept.
#[derive(Clone, Copy, Debug, Default)]
struct Carries {
    list: [Carry; CARRIES_MAX],
    count: usize,
}

impl Carries {
    /// The lowest that still reaches on at a place.
    fn lowest(&mut self, at: f64) -> Option<Carry> {
        let over = self.list[..self.count].iter().take_while(|carry| carry.until <= at).count();
        self.list.copy_within(over..self.count, 0);
        self.count -= over;
        self.list[..self.count].first().copied()
    }

    fn add(&mut self, new: Carry) {
        let kept = &self.list[..self.count];
        let lower = kept.iter().take_while(|carry| carry.value < new.value).count();
        if lower > 0 && kept[lower - 1].until >= new.until {
            return;
        }
        let covered = kept[lower..].iter().take_while(|carry| carry.until <= new.until).count();
        let rest = lower + covered..self.count;
        if covered > 0 {
            self.list[lower] = new;
            self.list.copy_within(rest.clone(), lower + 1);
            self.count = lower + 1 + rest.len();
            return;
        }
        if self.count == CARRIES_MAX {
            self.list[CARRIES_MAX - 2].until = self.list[CARRIES_MAX - 1].until.max(new.until);
            self.count -= 1;
            if lower >= self.count {
                self.list[self.count - 1].value = self.list[self.count - 1].value.min(new.value);
                return;
            }
        }
        self.list.copy_within(lower..self.count, lower + 1);
        self.list[lower] = new;
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
                share: 1.0,
            })
            .collect();
        let averaging = Averaging { window_s: 2.0 * half_window_s, rounding_s: 0.0, acceleration: 1.0 };
        widen(caps.iter(), true, averaging, &mut room, &mut out);
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
