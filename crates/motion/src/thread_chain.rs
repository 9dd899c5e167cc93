//! Thread moves that follow one another without a stop, until the last of them is known.

use turnwright_canon::{Action, Command, RapidPath, Shape};
use turnwright_geometry::Point;

use crate::clock::Clock;
use crate::dynamics::Dynamics;
use crate::leg::{Place, X, Z};
use crate::path::{ArcPath, point};
use crate::thread::ThreadStretch;

/// A chain, and what the spindle does in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct ThreadChain {
    links: Vec<Link>,
    pub(crate) stretches: Vec<ThreadStretch>,
    /// Where each ends on the way along the long axes, mm.
    ends_mm: Vec<f64>,
    /// Line of each link.
    pub(crate) lines: Vec<u32>,
    pub(crate) source: u32,
    /// In single-block operation the control goes on behind its last move.
    pub(crate) runs_on: bool,
    /// Speed of the spindle, rpm.
    pub(crate) rpm: f64,
    /// Part of a turn at which it starts.
    pub(crate) start_turns: f64,
    /// Seconds to wait for the spindle.
    pub(crate) waited_s: f64,
    /// Seconds that the clock counts for it.
    pub(crate) seconds: f64,
}

/// One move: the other axis follows the long one.
#[derive(Clone, Copy, Debug)]
struct Link {
    from: Point,
    to: Point,
    arc: Option<ArcPath>,
    long: usize,
    start: Place,
}

impl Link {
    /// The place when the long axis has gone a part of its way.
    fn place(&self, part: f64) -> Place {
        let mut place = self.start;
        let along = |from: f64, to: f64| if part >= 1.0 { to } else { from + (to - from) * part };
        (place[X], place[Z]) = (along(self.from.x, self.to.x), along(self.from.z, self.to.z));
        if let Some(arc) = self.arc.filter(|_| part > 0.0 && part < 1.0) {
            // Of the two places on the circle the one on the side of the chord.
            let chord = (
                self.from.x + (self.to.x - self.from.x) * part,
                self.from.z + (self.to.z - self.from.z) * part,
            );
            let radius = arc.start_radius_mm + (arc.end_radius_mm - arc.start_radius_mm) * part;
            let beside = |along: f64, centre: f64, other_centre: f64, other_chord: f64| {
                let root = (radius * radius - (along - centre) * (along - centre)).max(0.0).sqrt();
                other_centre + root.copysign(other_chord - other_centre)
            };
            if self.long == Z {
                place[X] = beside(place[Z], arc.centre.z, arc.centre.x, chord.0);
            } else {
                place[Z] = beside(place[X], arc.centre.x, arc.centre.z, chord.1);
            }
        }
        place
    }
}

impl ThreadChain {
    /// Adds a thread move and lets the clock pass it.
    pub(crate) fn add(&mut self, command: &Command, clock: &mut Clock, dynamics: &Dynamics) {
        let Action::Thread { to, shape, lead, lead_end, start_angle, .. } = &command.action else { return };
        let (from_at, start) = (clock.position(), clock.place());
        let (from, end) = (point(from_at), point(*to));
        let way = [(end.x - from.x).abs(), (end.z - from.z).abs()];
        let long = if way[X] > way[Z] { X } else { Z };
        let long_mm = way[long];
        let timing = clock.advance(command);
        if self.links.is_empty() {
            self.waited_s = timing.waited_s;
            self.rpm = timing.rpm.map_or(0.0, |rpm| rpm.max);
            self.start_turns = start_angle.to_degrees() / 360.0;
            self.source = command.origin.source;
        }
        self.seconds += timing.seconds - timing.waited_s;
        let arc = match shape {
            Shape::Arc { turn, centre } => Some(ArcPath::new(from_at, *to, *centre, *turn)),
            _ => None,
        };
        let rates = clock.rapid_rates(RapidPath::EachAxis);
        let direction = [way[X] / long_mm, way[Z] / long_mm, 0.0, 0.0, 0.0, 0.0];
        let slowest =
            |axis: usize| if direction[axis] > 0.0 { rates[axis] / direction[axis] } else { f64::INFINITY };
        self.stretches.push(ThreadStretch {
            way_mm: long_mm,
            lead_mm: lead.0.to_mm(),
            lead_end_mm: lead_end.as_deref().copied().unwrap_or(*lead).0.to_mm(),
            limits: dynamics.threading(&direction),
            limit_mm_per_s: slowest(X).min(slowest(Z)).min(clock.rates().cutting_max_mm_per_min) / 60.0,
        });
        self.ends_mm.push(self.ends_mm.last().copied().unwrap_or(0.0) + long_mm);
        self.links.push(Link { from, to: end, arc, long, start });
        self.lines.push(command.origin.line);
        self.runs_on = command.origin.runs_on;
    }

    /// Whether none waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// The chain that waits, if one does.
    pub(crate) fn take(&mut self) -> Option<Self> {
        (!self.links.is_empty()).then(|| std::mem::take(self))
    }

    /// One that none waits in, with the room of this one.
    pub(crate) fn emptied(mut self) -> Self {
        self.links.clear();
        self.stretches.clear();
        self.ends_mm.clear();
        self.lines.clear();
        let Self { links, stretches, ends_mm, lines, .. } = self;
        Self { links, stretches, ends_mm, lines, ..Self::default() }
    }

    /// Whether it changes its direction.
    pub(crate) fn is_bent(&self) -> bool {
        self.links.len() > 1 || self.links.iter().any(|link| link.arc.is_some())
    }

    /// Place, and line of the block, after a way along the long axes; in a chain of any length at once.
    pub(crate) fn at(&self, way_mm: f64) -> (Place, u32) {
        let passed = self.ends_mm.partition_point(|end_mm| *end_mm < way_mm);
        let index = passed.min(self.links.len().saturating_sub(1));
        let done_mm = index.checked_sub(1).map_or(0.0, |before| self.ends_mm[before]);
        match (self.links.get(index), self.stretches.get(index)) {
            (Some(link), Some(stretch)) => {
                (link.place((way_mm - done_mm) / stretch.way_mm), self.lines[index])
            }
            _ => ([0.0; 6], 0),
        }
    }
}
