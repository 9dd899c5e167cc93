//! What a cutting command orders, for the planner: its legs, the speed on them, and what limits it.

use turnwright_canon::{Action, OtherAxes, Shape, SidePlane, Turn};
use turnwright_geometry::Point;
use turnwright_units::{Feed, Position, WorkTip};

use crate::Dynamics;
use crate::clock::Clock;
use crate::dynamics::ARC_OVERRIDE;
use crate::feedrate::{Order, TurningSpindle};
use crate::leg::{B, C, Leg, LegArc, Place, V, X, Y, Z};
use crate::path::{ArcPath, CutPath, stretches};
use crate::planner::{RunLimits, least, most};
use crate::spindle::SurfaceLaw;
use crate::surface::Slowness;

/// What a cutting move orders.
pub(crate) struct CutOrder<'a> {
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    shape: &'a Shape,
    pub(crate) start: Place,
    end: Place,
    pub(crate) path: CutPath,
    /// What feed is measured along, mm.
    feed_mm: f64,
    pub(crate) order: Order,
    /// Axes beyond X and Z move along.
    pub(crate) has_others: bool,
}

impl Clock {
    /// Where all axes are.
    pub(crate) fn place(&self) -> Place {
        let mut place = self.axes().places();
        (place[X], place[Z]) = (self.position().x.to_mm(), self.position().z.to_mm());
        place
    }

    /// Where all axes are at the end of a move from `place`.
    pub(crate) fn place_after(mut place: Place, to: Position<WorkTip>, others: Option<&OtherAxes>) -> Place {
        (place[X], place[Z]) = (to.x.to_mm(), to.z.to_mm());
        if let Some(others) = others {
            let set = |place: &mut f64, value: Option<f64>| *place = value.unwrap_or(*place);
            set(&mut place[Y], others.y.map(|y| y.to_mm()));
            set(&mut place[B], others.b.map(|b| b.to_degrees()));
            set(&mut place[V], others.v.map(|v| v.to_mm()));
            // The rotary axis of a virtual plane follows the path; it is no way of its own.
            if others.v.is_none() {
                set(&mut place[C], others.c.map(|c| c.to_degrees()));
            }
        }
        place
    }

    /// What the next command orders when it is a cut at a known speed; `None` for all else.
    #[inline]
    pub(crate) fn cut_order<'a>(&self, action: &'a Action) -> Option<CutOrder<'a>> {
        let (to, shape, feed, others) = match action {
            Action::Feed { to, shape, feed, others } => (*to, shape, Some(*feed), others.as_deref()),
            Action::Thread { to, shape, .. } if !self.is_led() && self.dry_thread().is_some() => {
                (*to, shape, None, None)
            }
            _ => return None,
        };
        let from = self.position();
        let path = CutPath::new(from, to, shape);
        let feed_mm = match others {
            None => path.length_mm,
            Some(others) => self.axes().cut(from, to, shape, path.length_mm, others, self.rates()).feed_mm,
        };
        if feed_mm <= 0.0 || !feed_mm.is_finite() {
            return None;
        }
        let order = match feed.and_then(|feed| self.order_of(feed)) {
            Some(order) => order,
            // In a dry run feed per revolution needs no spindle.
            None => Order::Speed(self.panel().dry_run_mm_per_min.filter(|feed| *feed > 0.0)? / 60.0),
        };
        let start = self.place();
        let end = Self::place_after(start, to, others);
        Some(CutOrder { from, to, shape, start, end, path, feed_mm, order, has_others: others.is_some() })
    }

    /// What a feed orders; `None` when nothing would move.
    #[inline]
    fn order_of(&self, feed: Feed) -> Option<Order> {
        let order = match (feed, self.spindle_order()) {
            (Feed::PerMinute(feed), _) => Order::Speed(feed.0.to_mm() / 60.0),
            (Feed::PerRevolution(feed), crate::spindle::Order::Constant(rpm))
                if self.cuts_at_once() && rpm > 0.0 =>
            {
                // The spindle may still be on its way to this speed: the same everywhere.
                let law = SurfaceLaw { rpm_mm: rpm, rpm_min: rpm, rpm_max: rpm };
                self.order_along(feed.0.to_mm(), law)?
            }
            (Feed::PerRevolution(feed), crate::spindle::Order::Constant(rpm)) => {
                Order::Speed(feed.0.to_mm() * rpm / 60.0)
            }
            (Feed::PerRevolution(feed), crate::spindle::Order::Surface(law)) => {
                self.order_along(feed.0.to_mm(), law)?
            }
        };
        let is_motion = match order {
            Order::Speed(speed) => speed.is_finite() && speed > 0.0,
            Order::Surface { .. } => true,
        };
        is_motion.then_some(order)
    }

    /// Feed by the revolutions of a spindle whose speed changes.
    fn order_along(&self, feed_mm_per_rev: f64, law: SurfaceLaw) -> Option<Order> {
        let slowness = Slowness::new(feed_mm_per_rev, law, self.rates().cutting_max_mm_per_min)?;
        Some(Order::Surface { law, feed_mm_per_rev, slowness })
    }

    /// The spindle as it turns now.
    pub(crate) fn turning_spindle(&self) -> TurningSpindle {
        TurningSpindle { rpm: self.spindle().actual_rpm(), ramp_rpm_per_s: self.spindle().ramp_rpm_per_s() }
    }
}

impl CutOrder<'_> {
    /// Adds the legs, one behind the other.
    pub(crate) fn add_legs(&self, legs: &mut Vec<Leg>) {
        let Self { start, end, path, feed_mm, .. } = *self;
        if !path.is_curve {
            let arc = path.arc.map(|path| LegArc { axes: [Z, X], path }).or_else(|| self.side_arc());
            legs.push(Leg { from: start, to: end, arc, length_mm: feed_mm });
            return;
        }
        let feed_per_mm = feed_mm / path.length_mm;
        let mut done_mm = 0.0;
        let mut from = start;
        for piece in stretches(self.from, self.to, self.shape) {
            let length_mm = piece.length_mm();
            done_mm += length_mm;
            let part = (done_mm / path.length_mm).min(1.0);
            let mut to: Place = std::array::from_fn(|axis| start[axis] + (end[axis] - start[axis]) * part);
            (to[X], to[Z]) = (piece.end.x, piece.end.z);
            let arc = piece.arc.map(|path| LegArc { axes: [Z, X], path });
            if length_mm > 0.0 {
                legs.push(Leg { from, to, arc, length_mm: length_mm * feed_per_mm });
            }
            from = to;
        }
    }

    /// An arc in a plane of the side axis.
    fn side_arc(&self) -> Option<LegArc> {
        let Shape::SideArc { plane, turn, centre } = self.shape else { return None };
        let side = if self.end[V] != self.start[V] || self.end[Y] == self.start[Y] && self.start[V] != 0.0 {
            V
        } else {
            Y
        };
        let axes = match plane {
            SidePlane::Face => [X, side],
            SidePlane::Flank => [side, Z],
            SidePlane::Wall => [Z, side],
        };
        let at = |place: &Place| Point::new(place[axes[1]], place[axes[0]]);
        let (right, up) = plane.right_and_up(*centre);
        let path =
            ArcPath::between(at(&self.start), at(&self.end), Point::new(up, right), *turn == Turn::Clockwise);
        Some(LegArc { axes, path })
    }
}

/// What limits a leg, whatever the feed: the highest speed, mm/s, and its share of the acceleration.
pub(crate) fn leg_limit(
    leg: &Leg,
    order: Order,
    clock: &Clock,
    dynamics: &Dynamics,
    along: RunLimits,
) -> (f64, f64) {
    let rates = clock.rates();
    let per_minute = [
        rates.rapid_x_mm_per_min,
        rates.rapid_z_mm_per_min,
        rates.rapid_y_mm_per_min,
        rates.cutting_max_c_deg_per_min,
        rates.rapid_b_deg_per_min,
        rates.rapid_x_mm_per_min,
    ];
    let in_arc = |axis: usize| leg.arc.is_some_and(|arc| arc.axes.contains(&axis));
    let per_mm = 1.0 / leg.length_mm;
    // Minutes that a millimetre takes at least.
    let mut slowness = 0.0f64;
    let mut turning = 0.0f64;
    for (axis, rate) in per_minute.into_iter().enumerate() {
        let share = if in_arc(axis) { 1.0 } else { (leg.to[axis] - leg.from[axis]).abs() * per_mm };
        if share > 0.0 {
            slowness = slowness.max(share / rate);
            if matches!(axis, C | B) {
                turning = turning.max(share);
            }
        }
    }
    // Degrees are no way in millimetres: the largest feed holds for the rest.
    let moving = if turning > 0.0 { (1.0 - turning * turning).max(0.0).sqrt() } else { 1.0 };
    slowness = slowness.max(moving / rates.cutting_max_mm_per_min);
    let limit = 1.0 / (60.0 * slowness);
    match (leg.arc, leg.radius_mm()) {
        (Some(arc), Some(radius_mm)) => {
            let dry_run = clock.panel().dry_run_mm_per_min.unwrap_or(0.0) / 60.0;
            let wanted = most(ARC_OVERRIDE * order.highest(leg), dry_run);
            dynamics.arc(arc.axes, radius_mm, along, limit.min(wanted))
        }
        _ => (limit, dynamics.line_share(leg, along, least(limit, order.highest(leg)))),
    }
}
