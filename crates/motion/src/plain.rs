//! Plain cuts: straight ways of X and Z at one speed, while the spindle has the speed that it was given and the operator
//! lets the program run as it is. Long programs consist of them.
//!
//! What they come to is what [`Clock::cut_order`] and [`Clock::advance_along`] say, number by number; all that such a
//! cut cannot change is left alone.

use turnwright_canon::{Action, Command, Shape};
use turnwright_geometry::Point;
use turnwright_units::{Feed, Position, WorkTip};

use crate::clock::{Clock, RpmRange, Timing};
use crate::leg::{Leg, X, Z};
use crate::path::{point, way_mm};
use crate::spindle::Order;
use crate::totals::{Kind, SECONDS_MAX};

/// A plain cut.
pub(crate) struct PlainCut {
    from: Position<WorkTip>,
    start: Point,
    end: Point,
    length_mm: f64,
    pub(crate) speed_mm_per_s: f64,
    rpm: f64,
}

impl PlainCut {
    /// Its timing but for its seconds, which only the planner knows.
    #[inline]
    pub(crate) fn timing(&self) -> Timing {
        let &Self { from, length_mm, rpm, .. } = self;
        let rpm = (rpm > 0.0).then_some(RpmRange { min: rpm, max: rpm });
        Timing { kind: Kind::Cutting, from, seconds: 0.0, waited_s: 0.0, length_mm, rpm }
    }

    /// Its leg; the axes beyond X and Z, which stand, are all at zero here.
    #[inline]
    pub(crate) fn leg(&self) -> Leg {
        let mut leg = Leg { from: [0.0; 6], to: [0.0; 6], arc: None, length_mm: self.length_mm };
        (leg.from[X], leg.from[Z]) = (self.start.x, self.start.z);
        (leg.to[X], leg.to[Z]) = (self.end.x, self.end.z);
        leg
    }
}

impl Clock {
    /// Goes along a plain cut that no axis is too slow for; `None`, and nothing done, when a command is anything else.
    #[inline]
    pub(crate) fn plain_cut(&mut self, command: &Command) -> Option<PlainCut> {
        let Action::Feed { to, shape: Shape::Line, feed, others: None } = &command.action else {
            return None;
        };
        let Order::Constant(rpm) = self.spindle_order() else { return None };
        if !self.is_plain() || !self.spindle().is_steady() {
            return None;
        }
        let per_minute = match feed {
            Feed::PerMinute(feed) => feed.0.to_mm(),
            Feed::PerRevolution(_) if self.cuts_at_once() => return None,
            Feed::PerRevolution(feed) => feed.0.to_mm() * rpm,
        };
        let (start, end) = (point(self.position()), point(*to));
        let length_mm = way_mm(end.x - start.x, end.z - start.z);
        let speed_mm_per_s = per_minute / 60.0;
        let rates = self.rates();
        // Along a slanted way each axis is slower.
        let is_within = per_minute < NEARLY * rates.cutting_max_mm_per_min
            && per_minute < NEARLY * rates.rapid_x_mm_per_min
            && per_minute < NEARLY * rates.rapid_z_mm_per_min;
        let is_known = speed_mm_per_s > 0.0 && length_mm > 0.0 && length_mm <= SECONDS_MAX * speed_mm_per_s;
        if !is_within || !is_known {
            return None;
        }
        let from = self.position();
        self.arrive_plainly(*to);
        Some(PlainCut { from, start, end, length_mm, speed_mm_per_s, rpm })
    }
}

/// A limit that rounding cannot bring down to the speed.
const NEARLY: f64 = 1.0 - 1e-9;
