//! Laws of the pace on seeded random paths: no limit is passed, nothing depends on how the path comes in, the
//! operator may come between at any time.

use turnwright_dice::Dice;
use turnwright_motion::planner::{Feedrate, Pace, RunLimits, SHARE_MIN};

/// Length (0 for a corner), ordered speed, limit, share of the acceleration.
type Piece = (f64, f64, f64, f64);

#[derive(Clone, Debug)]
struct Case {
    limits: RunLimits,
    pieces: Vec<Piece>,
}

impl Case {
    fn random(seed: u64) -> Self {
        let mut dice = Dice::new(0x9e37_79b9_7f4a_7c15 ^ (seed + 1).wrapping_mul(0x5851_f42d_4c95_7f2d));
        let acceleration = dice.size(200.0, 8000.0);
        let limits = RunLimits {
            acceleration_mm_per_s2: acceleration,
            jerk_mm_per_s3: acceleration / dice.size(0.004, 0.12),
        };
        // Half of the paths have the same acceleration everywhere.
        let is_shared = dice.one_in(2);
        let longest = if dice.roll().is_multiple_of(2) { 200.0 } else { 2.0 };
        let mut pieces = Vec::new();
        for _ in 0..1 + dice.roll() % 40 {
            let limit = dice.size(0.5, 400.0);
            let ordered = if dice.roll().is_multiple_of(3) { dice.size(0.5, 400.0) } else { limit };
            let share = if is_shared && dice.one_in(2) { dice.size(SHARE_MIN, 1.5) } else { 1.0 };
            pieces.push((dice.size(0.005, longest), ordered, limit, share));
            if dice.roll().is_multiple_of(2) {
                pieces.push((0.0, f64::INFINITY, dice.size(0.1, 100.0), 1.0));
            }
        }
        Self { limits, pieces }
    }

    fn length(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.0).sum()
    }

    /// A path that has not come in yet.
    fn begun(&self, capacity: usize) -> Pace {
        let mut pace = Pace::with_capacity(capacity, self.limits);
        pace.begin_sharing(self.limits, 400.0, 0.0);
        pace
    }

    fn pace(&self) -> Pace {
        let mut pace = self.begun(256);
        for (length, ordered, limit, share) in &self.pieces {
            pace.push_sharing(*length, *ordered, *limit, *share).expect("room");
        }
        pace.close();
        pace
    }

    /// The largest share of the acceleration that the stretches around a place have.
    fn share(&self, at: f64) -> f64 {
        let near = 1e-9 * (1.0 + self.length());
        let mut start = 0.0;
        let mut share = 0.0f64;
        for (length, _, _, of_piece) in &self.pieces {
            if *length > 0.0 && at >= start - near && at <= start + length + near {
                share = share.max(*of_piece);
            }
            start += length;
        }
        share
    }

    /// The lowest cap at or beside a place.
    fn cap(&self, at: f64, factor: f64) -> f64 {
        let near = 1e-12 * (1.0 + self.length());
        let mut start = 0.0;
        let mut lowest = f64::INFINITY;
        for (length, ordered, limit, _) in &self.pieces {
            if at > start + near && at < start + length - near || *length == 0.0 && (at - start).abs() < near
            {
                lowest = f64::min(lowest, (ordered * factor).min(*limit));
            }
            start += length;
        }
        lowest
    }
}

/// Looks at every sample: place, and by differences speed, acceleration and jerk.
struct Inspector {
    step_s: f64,
    last: [f64; 4],
    /// Shares of the acceleration at these places.
    shares: [f64; 4],
}

impl Inspector {
    fn new(step_s: f64, at: f64) -> Self {
        Self { step_s, last: [at; 4], shares: [1.5; 4] }
    }

    fn look(&mut self, at: f64, case: &Case, what: &dyn std::fmt::Debug) {
        let limits = case.limits;
        self.shares = [self.shares[1], self.shares[2], self.shares[3], case.share(at)];
        let share = self.shares.iter().copied().fold(0.0, f64::max);
        self.last = [self.last[1], self.last[2], self.last[3], at];
        let [p0, p1, p2, p3] = self.last;
        let acceleration = (p3 - 2.0 * p2 + p1) / self.step_s.powi(2);
        let jerk = (p3 - 3.0 * p2 + 3.0 * p1 - p0) / self.step_s.powi(3);
        // The places themselves are good to a few units in the last place.
        let noise = 16.0 * f64::EPSILON * (at.abs() + 1.0);
        assert!(p3 >= p2 - noise, "goes back from {p2} to {p3}: {what:?}");
        let most = share * limits.acceleration_mm_per_s2 * (1.0 + 1e-7) + noise / self.step_s.powi(2);
        assert!(acceleration.abs() <= most, "acceleration {acceleration} at {at}: {what:?}");
        let most = share * limits.jerk_mm_per_s3 * (1.0 + 1e-6) + noise / self.step_s.powi(3);
        assert!(jerk.abs() <= most, "jerk {jerk} of {most} at {at}: {what:?}");
    }
}

#[test]
fn no_sample_passes_a_limit_and_the_end_is_exact() {
    for seed in 0..3000 {
        let case = Case::random(seed);
        let mut pace = case.pace();
        pace.plan();
        let duration = pace.duration_s().expect("all is planned");
        let step = duration / 400.0;
        let mut inspector = Inspector::new(step, 0.0);
        let mut time = 0.0;
        while time < duration + 4.0 * step {
            let state = pace.at(time);
            inspector.look(state.at_mm, &case, &(seed, time));
            let cap = case.cap(state.at_mm, 1.0);
            assert!(
                state.speed_mm_per_s <= cap * (1.0 + 1e-6) + 1e-9,
                "{} above {cap} at {} {seed}",
                state.speed_mm_per_s,
                state.at_mm
            );
            time += step;
        }
        let end = pace.at(duration + 1e-9);
        assert!((end.at_mm - case.length()).abs() <= 1e-9 * (1.0 + case.length()), "{seed} {end:?}");
        assert_eq!(end.speed_mm_per_s.abs().max(1e-6), 1e-6, "{seed}");
    }
}

/// Feeds a path in bursts and plays it at the same time, with little room. Every place as bits.
fn played(case: &Case, mut burst: impl FnMut() -> usize, step: f64, capacity: usize) -> Vec<u64> {
    let mut pace = case.begun(capacity);
    let mut pieces = case.pieces.iter();
    let mut places = Vec::new();
    let mut next = pieces.next();
    let mut tick = 0u32;
    loop {
        for _ in 0..burst() {
            let Some((length, ordered, limit, share)) = next else { break };
            if pace.push_sharing(*length, *ordered, *limit, *share).is_err() {
                break;
            }
            next = pieces.next();
        }
        if next.is_none() {
            pace.close();
        }
        pace.plan();
        let until = pace.duration_s().unwrap_or_else(|| pace.planned_s());
        while f64::from(tick) * step <= until {
            places.push(pace.at(f64::from(tick) * step).at_mm.to_bits());
            pace.forget_before(f64::from(tick) * step);
            tick += 1;
        }
        if pace.duration_s().is_some() {
            return places;
        }
    }
}

#[test]
fn the_same_bits_whatever_the_chunks_and_run_after_run() {
    for seed in 0..400 {
        let mut case = Case::random(seed);
        let more = Case::random(seed + 5000);
        case.pieces.extend(more.pieces);
        let pace = {
            let mut pace = case.pace();
            pace.plan();
            pace
        };
        let step = pace.duration_s().expect("planned") / 300.0;
        let whole = played(&case, || usize::MAX, step, 256);
        let mut dice = Dice::new(seed + 17);
        let chunks = played(&case, || 1 + (dice.roll() % 5) as usize, step, 256);
        let single = played(&case, || 1, step, 256);
        assert!(whole == chunks, "{seed}");
        assert!(whole == single, "{seed}");
        assert!(whole == played(&case, || usize::MAX, step, 256), "{seed}");
    }
}

#[test]
fn a_way_of_one_speed_has_the_same_bits_whatever_the_chunks() {
    for seed in 0..2000 {
        let mut dice = Dice::new(seed + 3);
        let acceleration = dice.size(200.0, 8000.0);
        let limits = RunLimits {
            acceleration_mm_per_s2: acceleration,
            jerk_mm_per_s3: acceleration / dice.size(0.004, 0.12),
        };
        let (way, speed) = (dice.size(1e-3, 500.0), dice.size(0.5, 400.0));
        // Once at once, and once with a corner in it that holds nobody up: that goes through all passes.
        let planned = |pieces: &[(f64, f64)]| {
            let mut pace = Pace::with_capacity(8, limits);
            for (length, limit) in pieces {
                pace.push(*length, f64::INFINITY, *limit).expect("room");
            }
            pace.close();
            pace.plan();
            let duration = pace.duration_s().expect("planned");
            let places = (0..=20).map(|tick| pace.at(duration * f64::from(tick) / 20.0).at_mm.to_bits());
            (duration.to_bits(), places.collect::<Vec<_>>())
        };
        let whole = planned(&[(way, speed)]);
        assert_eq!(whole, planned(&[(way, speed), (0.0, 1e9)]), "{limits:?} {way} {speed}");
        // Chunk by chunk.
        let case = Case { limits, pieces: vec![(way, speed, speed, 1.0)] };
        let step = f64::from_bits(whole.0) / 100.0;
        let at_once = played(&case, || 1, step, 8);
        let parts = Case { limits, pieces: vec![(way / 2.0, speed, speed, 1.0); 2] };
        assert!(at_once == played(&parts, || 1, step, 8), "{limits:?} {way} {speed}");
    }
}

#[test]
fn little_room_is_slower_but_safe() {
    for seed in 0..100 {
        let mut dice = Dice::new(seed + 1);
        let mut case = Case::random(seed);
        // Braking takes many more pieces than there is room for.
        case.pieces = (0..400).map(|_| (0.02, 100.0 + dice.part(), 300.0, 1.0)).collect();
        let places = played(&case, || usize::MAX, 1e-3, 16);
        let mut inspector = Inspector::new(1e-3, 0.0);
        for place in &places {
            inspector.look(f64::from_bits(*place), &case, &seed);
        }
        assert!((f64::from_bits(places[places.len() - 1]) - case.length()).abs() < 1e-3, "{seed}");
    }
}

#[test]
fn the_operator_may_come_between_at_any_time() {
    for seed in 0..600 {
        let case = Case::random(seed);
        let mut pace = case.pace();
        let mut dice = Dice::new(seed * 31 + 7);
        pace.plan();
        let step = (pace.duration_s().expect("planned") / 300.0).clamp(2e-4, 2e-3);
        let mut inspector = Inspector::new(step, 0.0);
        let (mut held, mut since) = (false, 0);
        let mut slowest_factor_allowed = f64::INFINITY;
        for tick in 0..60_000 {
            let time = f64::from(tick) * step;
            if dice.roll().is_multiple_of(60) && tick < 20_000 {
                let factor = if dice.roll().is_multiple_of(4) { 1.0 } else { dice.size(0.1, 2.5) };
                held = dice.roll().is_multiple_of(3);
                pace.interrupt(time, Feedrate::Override(factor), held);
                pace.plan();
                since = tick;
                slowest_factor_allowed = 2.5;
            } else if tick == 20_000 {
                held = false;
                pace.interrupt(time, Feedrate::Override(1.0), false);
                pace.plan();
            }
            let state = pace.at(time);
            inspector.look(state.at_mm, &case, &(seed, tick, time));
            let cap = case.cap(state.at_mm, slowest_factor_allowed);
            assert!(state.speed_mm_per_s <= cap * (1.0 + 1e-6) + 1e-9, "{seed} {tick} {state:?} {cap}");
            // Braking with the smallest share and averaging, then a hold has stopped it for good.
            let stopping_s =
                400.0 / (SHARE_MIN * case.limits.acceleration_mm_per_s2) + 2.0 * case.limits.window_s();
            if held && f64::from(tick - since) * step > stopping_s {
                assert!(state.speed_mm_per_s.abs() < 1e-6, "{seed} {tick} {state:?}");
                assert!(pace.is_resting(time), "{seed}");
            }
            pace.forget_before(time);
            if !held && pace.duration_s().is_some_and(|duration| time > duration) {
                break;
            }
        }
        let end = pace.duration_s().expect("it ends");
        assert!((pace.at(end + 1e-9).at_mm - case.length()).abs() < 1e-8, "{seed}");
    }
}

#[test]
fn an_override_at_the_first_instant_holds_from_there() {
    for seed in 0..100 {
        let case = Case::random(seed);
        let mut preset = case.begun(256);
        preset.preset(Feedrate::Override(0.5), false);
        case.pieces.iter().for_each(|(length, ordered, limit, share)| {
            preset.push_sharing(*length, *ordered, *limit, *share).expect("room");
        });
        preset.close();
        preset.plan();
        let mut pace = case.pace();
        pace.plan();
        pace.interrupt(0.0, Feedrate::Override(0.5), false);
        pace.plan();
        assert_eq!(pace.duration_s(), preset.duration_s(), "{seed}");
        // Held and released again within one instant, far from the start, it is where it was.
        pace.interrupt(0.5, Feedrate::Override(0.5), true);
        pace.plan();
        let rest = pace.at(1e4).at_mm;
        pace.forget_before(1e4);
        pace.interrupt(1e4, Feedrate::Override(0.5), false);
        pace.plan();
        pace.interrupt(1e4, Feedrate::Override(1.0), false);
        pace.plan();
        assert_eq!(pace.at(1e4).at_mm, rest, "{seed}");
    }
}

#[test]
fn a_higher_override_is_never_later() {
    for seed in 0..300 {
        let case = Case::random(seed);
        let mut last = f64::INFINITY;
        for percent in [10, 50, 80, 100, 120, 200] {
            let mut pace = case.begun(256);
            pace.preset(Feedrate::Override(f64::from(percent) / 100.0), false);
            for (length, ordered, limit, share) in &case.pieces {
                pace.push_sharing(*length, *ordered, *limit, *share).expect("room");
            }
            pace.close();
            pace.plan();
            let duration = pace.duration_s().expect("planned");
            // Caps widen with their speed: near the start of a slow stretch, or behind a corner that a slower path
            // would not have noticed, a percent may be lost; and where accelerations differ tenfold, four.
            let lost = if case.pieces.iter().all(|piece| piece.3 == 1.0) { 0.01 } else { 0.04 };
            assert!(duration <= last * (1.0 + lost), "{seed} {percent} {duration} after {last}");
            last = duration;
        }
    }
}

#[test]
fn the_way_back_takes_as_long() {
    for seed in 0..400 {
        let mut case = Case::random(seed);
        let seconds = |case: &Case| {
            let mut pace = case.pace();
            pace.plan();
            pace.duration_s().expect("planned")
        };
        let there = seconds(&case);
        case.pieces.reverse();
        let back = seconds(&case);
        assert!((there - back).abs() <= 1e-6 * there, "{seed} {there} {back}");
    }
}

#[test]
fn a_way_from_rest_to_rest_is_known_in_closed_form() {
    let mut dice = Dice::new(99);
    for _ in 0..2000 {
        let acceleration = dice.size(100.0, 10_000.0);
        let limits = RunLimits {
            acceleration_mm_per_s2: acceleration,
            jerk_mm_per_s3: acceleration / dice.size(0.001, 0.1),
        };
        let (way, speed) = (dice.size(1e-4, 1000.0), dice.size(0.1, 500.0));
        let mut pace = Pace::with_capacity(4, limits);
        pace.push(way, speed, 1e9).expect("room");
        pace.close();
        pace.ease();
        pace.plan();
        let (closed, planned) = (limits.rest_to_rest_s(way, speed), pace.duration_s().expect("planned"));
        assert!((closed - planned).abs() < 1e-8 * closed, "{limits:?} {way} {speed}: {closed} {planned}");
    }
}
