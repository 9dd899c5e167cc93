//! The operator's panel: overrides, feed hold, dry run, single block.
//!
//! In: what the operator has set, and what the control's parameters make of it. Out: what that asks of a path, as one
//! [`Feedrate`] and whether the axes stand: every switch is a cap on the same mechanism.

use turnwright_canon::{PanelLock, PathMode};
use turnwright_units::{Feed, FeedPerMinute, FeedPerRevolution, Length};

use crate::planner::Feedrate;

/// What the operator has set. It may change at any tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Feed override, 1 for 100 %. Threads and taps do not heed it.
    pub feed: f64,
    /// Rapid override.
    pub rapid: RapidOverride,
    /// Feed hold: the axes come to rest. A thread is finished first.
    pub is_held: bool,
    /// Dry run: cuts go at this speed, mm/min, whatever their feed and the feed override.
    pub dry_run_mm_per_min: Option<f64>,
    /// The axes come to rest behind each block.
    pub single_block: bool,
}

/// The rapid override switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RapidOverride {
    /// A part of the rapid rate, 1 for 100 %.
    Part(f64),
    /// Its lowest position, F0: a speed of its own, [`PanelRules::rapid_lowest_per_min`].
    Lowest,
}

/// What the control's parameters make of the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PanelRules {
    /// Speed of rapids at F0, mm or degrees per minute.
    pub rapid_lowest_per_min: f64,
    /// Rapids stand too while the feed override is 0.
    pub rapids_heed_feed: bool,
    /// Dry run acts on rapids.
    pub dry_rapids: bool,
    /// Dry run acts on threads and taps: they go at its speed, out of step with the spindle or leading it. A thread, with
    /// all that is chained to it, ends as it began: switched in it, on or off, the dry run acts behind it.
    pub dry_threads: bool,
    /// Feed hold stops the time of a dwell.
    pub hold_stops_dwell: bool,
    /// Where a feed hold that came in a thread stops the axes.
    pub thread_hold: ThreadHold,
}

/// Where a feed hold that came in a thread stops the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThreadHold {
    /// Behind the block that follows the thread: the tool is out of the work then.
    #[default]
    BehindNextBlock,
    /// At the end of the thread; of a cycle, at the end of its pass.
    AtEnd,
}

impl Default for Panel {
    fn default() -> Self {
        Self {
            feed: 1.0,
            rapid: RapidOverride::Part(1.0),
            is_held: false,
            dry_run_mm_per_min: None,
            single_block: false,
        }
    }
}

impl Panel {
    /// What is left of it while a program locks some of it.
    #[must_use]
    pub(crate) fn locked(self, lock: PanelLock) -> Self {
        Self {
            is_held: self.is_held && !lock.hold,
            feed: if lock.feed_override { 1.0 } else { self.feed },
            dry_run_mm_per_min: self.dry_run_mm_per_min.filter(|_| !lock.dry_run),
            ..self
        }
    }

    /// What it makes of cuts, and whether they stand.
    pub(crate) fn cutting(&self, mode: PathMode) -> (Feedrate, bool) {
        match self.dry_run_mm_per_min {
            _ if mode == PathMode::Tapping => (Feedrate::Override(1.0), false),
            Some(mm_per_min) => standing_at_none(Feedrate::Fixed(mm_per_min / 60.0), self.is_held),
            None => standing_at_none(Feedrate::Override(self.feed), self.is_held),
        }
    }

    /// The same of rapids; on each mm or degree of the way the quickest axis moves by `per_way`.
    pub(crate) fn rapid(&self, rules: &PanelRules, per_way: f64) -> (Feedrate, bool) {
        let dry = self.dry_run_mm_per_min.filter(|_| rules.dry_rapids);
        let fixed = |per_min: f64| Feedrate::Fixed(per_min / 60.0 / per_way);
        let feedrate = match (dry, self.rapid) {
            (Some(dry), _) => fixed(dry),
            (None, RapidOverride::Lowest) => fixed(rules.rapid_lowest_per_min),
            (None, RapidOverride::Part(part)) => Feedrate::Override(part),
        };
        let stands = dry.is_none() && rules.rapids_heed_feed && self.feed <= 0.0;
        standing_at_none(feedrate, self.is_held || stands)
    }

    /// A rapid rate as it makes it, per minute; 0 while rapids stand.
    pub(crate) fn rapid_rate(&self, rules: &PanelRules, per_min: f64) -> f64 {
        match self.rapid(rules, 1.0) {
            (_, true) => 0.0,
            (Feedrate::Override(part), _) => per_min * part,
            (Feedrate::Fixed(per_s), _) => per_min.min(60.0 * per_s),
        }
    }

    /// A feed as it makes it; 0 while cuts stand.
    pub(crate) fn feed(&self, mode: PathMode, feed: Feed) -> Feed {
        let times = |length: Length, part: f64| Length::from_nm((1e6 * length.to_mm() * part).round() as i64);
        let per_min =
            |mm_per_s: f64| Feed::PerMinute(FeedPerMinute(Length::from_nm((60e6 * mm_per_s).round() as i64)));
        match (self.cutting(mode), feed) {
            ((_, true), _) => per_min(0.0),
            ((Feedrate::Fixed(mm_per_s), _), _) => per_min(mm_per_s),
            ((Feedrate::Override(1.0), _), feed) => feed,
            ((Feedrate::Override(part), _), Feed::PerMinute(feed)) => {
                Feed::PerMinute(FeedPerMinute(times(feed.0, part)))
            }
            ((Feedrate::Override(part), _), Feed::PerRevolution(feed)) => {
                Feed::PerRevolution(FeedPerRevolution(times(feed.0, part)))
            }
        }
    }

    /// The speed of threads and taps in a dry run that acts on them, mm/min.
    pub(crate) fn dry_thread(&self, rules: &PanelRules) -> Option<f64> {
        self.dry_run_mm_per_min.filter(|_| rules.dry_threads)
    }
}

/// A speed of nothing is a hold: as a speed it would be crept along for ever, also behind its end.
fn standing_at_none(feedrate: Feedrate, is_held: bool) -> (Feedrate, bool) {
    match feedrate {
        Feedrate::Override(speed) | Feedrate::Fixed(speed) if speed <= 0.0 => (Feedrate::Override(1.0), true),
        _ => (feedrate, is_held),
    }
}
