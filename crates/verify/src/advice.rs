//! Where time could be saved without touching the part.
//!
//! In: the commands with what they take and what they take away, in order of execution. Out: notes, each with its line
//! and an estimate of the seconds that it is worth. Nothing is ever changed by them.
//!
//! They are careful: what may have a purpose that the program does not show (a finishing cut, a second cut of the same
//! way, a wait behind an M code) is left alone, and so is what saves less than [`SAVING_MIN_S`] a piece.
//!
//! Invariant: what is kept is bounded by [`SAVINGS_MAX`].

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, Origin, Phase, Shape, SpindleSpeed, SpindleState};
use turnwright_control::{Setup, Tool, ToolKind};
use turnwright_diagnostics::{Diagnostic, Place, Severity, SourceId};
use turnwright_motion::{Kind, MachineRates, RPM_FENCE, Timing};
use turnwright_stock::Removed;
use turnwright_units::{Feed, Position, WorkTip};

/// Advice that saves less is not given, seconds.
pub const SAVING_MIN_S: f64 = 0.5;

/// Lines that are remembered.
pub const SAVINGS_MAX: usize = 10_000;

/// Advice given on one program: what saves most.
pub const ADVICE_MAX: usize = 20;

/// Less than this, mm³, is dust.
const NOTHING_MM3: f64 = 1e-6;

/// A cut may start this far before the work, mm; a start further out than the second is told.
const LEAD_MM: f64 = 2.0;
const FAR_MM: f64 = 3.0;

/// Places this near to each other are the same, mm.
const SAME_MM: f64 = 0.1;

/// A way out that is longer leads to where tools are changed, mm.
const AWAY_MM: f64 = 100.0;

/// Turns in which a groove is round, and a time that is never too long, seconds.
const DWELL_TURNS: f64 = 3.0;
const DWELL_S: f64 = 0.2;

/// The thinnest chip of a roughing cut, as a part of the nose radius.
const FEED_OF_NOSE: f64 = 1.0 / 8.0;

/// A note on how to save time.
#[derive(Clone, Debug)]
pub struct Advice {
    /// What, where, and the words' values.
    pub diagnostic: Diagnostic,
    /// What it is worth, seconds a piece.
    pub seconds: f64,
}

/// What a line could save.
#[derive(Clone, Copy, Debug)]
struct Saving {
    seconds: f64,
    count: i64,
    /// The greatest value that is told: a distance, a feed, a time.
    value: f64,
}

/// Cuts from one rapid to the next.
#[derive(Clone, Copy, Debug)]
struct Pass {
    origin: Origin,
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    seconds: f64,
    length_mm: f64,
    removed_mm3: f64,
    /// Somebody knows what it took, and nothing speaks for a purpose.
    is_plain: bool,
}

/// Rapids from one cut to the next.
#[derive(Clone, Copy, Debug)]
struct Trip {
    from: Position<WorkTip>,
    seconds: f64,
    away_mm: f64,
    farthest: Origin,
    /// Something was done on the way.
    has_purpose: bool,
}

/// The surface speed in force, and the block that ordered it.
#[derive(Clone, Copy, Debug)]
struct SurfaceOrder {
    origin: Origin,
    rpm_mm: f64,
    rpm_max: f64,
}

/// Looks at a program.
#[derive(Clone, Debug)]
pub struct Advisor {
    rates: MachineRates,
    /// The gear of the spindle, by its place.
    gear: usize,
    tools: BTreeMap<u32, Tool>,
    tool: u32,
    savings: BTreeMap<(&'static str, u32, u32), Saving>,
    pass: Option<Pass>,
    /// Where the last pass that took something went.
    last_way: Option<(Position<WorkTip>, Position<WorkTip>)>,
    trip: Option<Trip>,
    surface: Option<SurfaceOrder>,
    was_cut: bool,
}

impl Advisor {
    /// For a setup and the rates of its machine.
    pub fn new(setup: &Setup, rates: MachineRates) -> Self {
        Self {
            rates,
            gear: 0,
            tools: setup.tools().unwrap_or_default(),
            tool: 0,
            savings: BTreeMap::new(),
            pass: None,
            last_way: None,
            trip: None,
            surface: None,
            was_cut: false,
        }
    }

    /// The next command, and what it took away when anybody knows.
    pub fn add(&mut self, command: &Command, timing: &Timing, removed: Option<&Removed>) {
        match (&command.action, timing.kind) {
            (Action::Feed { .. }, _) => {
                self.end_trip(timing);
                self.cut(command, timing, removed);
            }
            (Action::Rapid { to, .. }, _) => {
                self.end_pass();
                self.travel(&command.origin, timing, *to);
            }
            (Action::Thread { .. }, _) => {
                self.end_trip(timing);
                self.end_pass();
            }
            (Action::Dwell(_), _) => {
                self.end_pass();
                self.stand(&command.origin, timing);
                self.interrupt();
            }
            (Action::Tool { tool, .. }, _) => {
                self.end_pass();
                self.tool = if *tool == 0 { self.tool } else { *tool };
                self.interrupt();
            }
            (Action::Spindle { state, speed, rpm_max }, _) => {
                self.end_pass();
                self.interrupt();
                let machine_max = self.machine_rpm_max();
                self.surface = match (state, speed, rpm_max) {
                    (SpindleState::Stop, ..) => None,
                    // What the machine itself cannot do is no advice.
                    (_, SpindleSpeed::Surface(surface), Some(limit)) if f64::from(limit.0) < machine_max => {
                        Some(SurfaceOrder {
                            origin: command.origin,
                            rpm_mm: surface.0.to_mm() / std::f64::consts::TAU,
                            rpm_max: f64::from(limit.0),
                        })
                    }
                    _ => None,
                };
            }
            (Action::Auxiliary { code }, _) => {
                self.gear = self.rates.gears.of_code(*code).unwrap_or(self.gear);
                self.end_pass();
                self.interrupt();
            }
            (Action::PathMode(_) | Action::Message(_) | Action::Output(_), _) => return,
            _ => {
                self.end_pass();
                self.interrupt();
            }
        }
        self.was_cut = timing.kind == Kind::Cutting;
    }

    /// The program is over; what saves most comes first.
    pub fn finish(mut self) -> Vec<Advice> {
        self.end_pass();
        let worth = self.savings.into_iter().filter(|(_, saving)| saving.seconds >= SAVING_MIN_S);
        let mut advice: Vec<Advice> = worth
            .map(|((key, source, line), saving)| {
                let source = SourceId(source);
                let place = Place { source, line, line_offset: u64::MAX, column: 1, end_column: 1 };
                let diagnostic = Diagnostic::new(Severity::Note, key)
                    .at(place)
                    .with("seconds", format!("{:.1}", saving.seconds))
                    .with("n", saving.count)
                    .with("value", ((saving.value * 1e3).round() / 1e3).to_string());
                Advice { diagnostic, seconds: saving.seconds }
            })
            .collect();
        advice.sort_by(|one, other| other.seconds.total_cmp(&one.seconds));
        advice.truncate(ADVICE_MAX);
        advice
    }

    fn save(&mut self, key: &'static str, origin: &Origin, seconds: f64, value: f64) {
        if !(seconds.is_finite() && seconds > 0.0) {
            return;
        }
        let place = (key, origin.source, origin.line);
        if self.savings.len() >= SAVINGS_MAX && !self.savings.contains_key(&place) {
            return;
        }
        let saving = self.savings.entry(place).or_insert(Saving { seconds: 0.0, count: 0, value });
        saving.seconds += seconds;
        saving.count += 1;
        saving.value = saving.value.max(value);
    }

    /// Seconds of a way at rapid, ramps included in the rough.
    fn rapid_s(&self, mm: f64) -> f64 {
        let per_min = self.rates.rapid_x_mm_per_min.min(self.rates.rapid_z_mm_per_min);
        mm / per_min * 60.0 + 0.1
    }

    fn cut(&mut self, command: &Command, timing: &Timing, removed: Option<&Removed>) {
        let Action::Feed { to, shape, feed, others } = &command.action else { return };
        let seconds = timing.seconds - timing.waited_s;
        let phase = command.origin.cycle.map(|cycle| cycle.phase);
        let is_finish = matches!(phase, Some(Phase::Finish | Phase::Contour));
        let is_plain =
            others.is_none() && !is_finish && removed.is_some() && self.tools.contains_key(&self.tool);
        let volume_mm3 = removed.map_or(0.0, |removed| removed.volume_mm3);
        let begun = Pass {
            origin: command.origin,
            from: timing.from,
            to: *to,
            seconds: 0.0,
            length_mm: 0.0,
            removed_mm3: 0.0,
            is_plain: true,
        };
        // The passes of a cycle may follow one another at feed.
        let number = |origin: &Origin| origin.cycle.map(|cycle| (cycle.label, cycle.pass));
        if self.pass.is_some_and(|pass| number(&pass.origin) != number(&command.origin)) {
            self.end_pass();
        }
        let mut pass = self.pass.unwrap_or(begun);
        if is_plain && *shape == Shape::Line && pass.removed_mm3 <= NOTHING_MM3 && volume_mm3 > NOTHING_MM3 {
            let air_mm = removed.map_or(0.0, |removed| air_mm(timing, *to, removed));
            if air_mm > FAR_MM {
                let idle_mm = air_mm - LEAD_MM;
                let saved = idle_mm / timing.length_mm * seconds - self.rapid_s(idle_mm) + 0.1;
                self.save("advice-far-start", &command.origin, saved, air_mm);
            }
        }
        pass.to = *to;
        pass.seconds += seconds;
        pass.length_mm += timing.length_mm;
        pass.removed_mm3 += volume_mm3;
        pass.is_plain &= is_plain;
        self.pass = Some(pass);
        if let Some(removed) = removed.filter(|_| is_plain && volume_mm3 > NOTHING_MM3) {
            self.judge_feed(&command.origin, *feed, timing, seconds, removed);
        }
        self.judge_clamp(*feed, timing, *to, seconds);
    }

    /// A roughing cut whose chip is thinner than the nose can lift.
    fn judge_feed(&mut self, origin: &Origin, feed: Feed, timing: &Timing, seconds: f64, removed: &Removed) {
        let (Some(tool), Some(bounds)) = (self.tools.get(&self.tool), removed.bounds) else { return };
        let Some(rpm) = timing.rpm else { return };
        let nose_mm = tool.nose_radius_mm;
        let depth_mm = (bounds.max.x - bounds.min.x).min(bounds.max.z - bounds.min.z);
        let feed_mm = match feed {
            Feed::PerRevolution(feed) => feed.0.to_mm(),
            Feed::PerMinute(feed) => feed.0.to_mm() / rpm.min.max(1.0),
        };
        let least_mm = nose_mm * FEED_OF_NOSE;
        if tool.kind == ToolKind::Turning && nose_mm >= 0.2 && depth_mm >= nose_mm && feed_mm < least_mm {
            self.save("advice-slow-feed", origin, seconds * (1.0 - feed_mm / least_mm), feed_mm);
        }
    }

    /// The fastest that the spindle turns in its gear.
    fn machine_rpm_max(&self) -> f64 {
        let machine_max = self.rates.rpm_max.map_or(RPM_FENCE, |rpm| f64::from(rpm.0));
        self.rates.gears.rpm_max(self.gear).map_or(machine_max, |rpm| rpm.min(machine_max))
    }

    /// A cut all of which is turned at the clamp of the surface speed.
    fn judge_clamp(&mut self, feed: Feed, timing: &Timing, to: Position<WorkTip>, seconds: f64) {
        let Some(order) = self.surface.filter(|_| matches!(feed, Feed::PerRevolution(_))) else { return };
        let thickest_mm = timing.from.x.to_mm().abs().max(to.x.to_mm().abs());
        let machine_max = self.machine_rpm_max();
        let wanted = if thickest_mm > 0.0 { order.rpm_mm / thickest_mm } else { f64::INFINITY };
        let possible = wanted.min(machine_max);
        if possible > order.rpm_max * 1.1 {
            let saved = seconds * (1.0 - order.rpm_max / possible);
            self.save("advice-speed-clamp", &order.origin, saved, possible.round());
        }
    }

    /// Cuts that took nothing away from one rapid to the next.
    fn end_pass(&mut self) {
        let Some(pass) = self.pass.take() else { return };
        if pass.removed_mm3 > NOTHING_MM3 {
            self.last_way = Some((pass.from, pass.to));
            return;
        }
        let is_again = self
            .last_way
            .is_some_and(|(from, to)| distance(from, pass.from) < SAME_MM && distance(to, pass.to) < SAME_MM);
        if pass.is_plain && !is_again {
            let saved = pass.seconds - self.rapid_s(pass.length_mm);
            self.save("advice-air-cut", &pass.origin, saved, pass.length_mm);
        }
    }

    /// A dwell right behind a cut.
    fn stand(&mut self, origin: &Origin, timing: &Timing) {
        let Some(rpm) = timing.rpm.filter(|_| self.was_cut) else { return };
        let needed_s = (DWELL_TURNS * 60.0 / rpm.max).max(DWELL_S);
        let dwell_s = timing.seconds - timing.waited_s;
        if dwell_s > 2.0 * needed_s {
            self.save("advice-long-dwell", origin, dwell_s - needed_s, dwell_s);
        }
    }

    fn travel(&mut self, origin: &Origin, timing: &Timing, to: Position<WorkTip>) {
        let away_mm = self.trip.map_or_else(|| distance(timing.from, to), |trip| distance(trip.from, to));
        let trip = self.trip.get_or_insert(Trip {
            from: timing.from,
            seconds: 0.0,
            away_mm: 0.0,
            farthest: *origin,
            // What comes before the first cut is the way there.
            has_purpose: !self.was_cut,
        });
        trip.seconds += timing.seconds;
        if away_mm > trip.away_mm {
            (trip.away_mm, trip.farthest) = (away_mm, *origin);
        }
    }

    /// Something is done where the tool is.
    fn interrupt(&mut self) {
        if let Some(trip) = &mut self.trip {
            trip.has_purpose = true;
        }
    }

    /// The next cut: was the way there needed?
    fn end_trip(&mut self, timing: &Timing) {
        let Some(trip) = self.trip.take() else { return };
        let direct_mm = distance(trip.from, timing.from);
        if !trip.has_purpose && trip.away_mm > AWAY_MM.max(2.0 * direct_mm) {
            let saved = trip.seconds - self.rapid_s(direct_mm) - 0.2;
            self.save("advice-needless-return", &trip.farthest, saved, trip.away_mm);
        }
    }
}

fn distance(one: Position<WorkTip>, other: Position<WorkTip>) -> f64 {
    libm::hypot(one.x.to_mm() - other.x.to_mm(), one.z.to_mm() - other.z.to_mm())
}

/// How far a straight cut goes before it meets what it takes away, mm along its way.
fn air_mm(timing: &Timing, to: Position<WorkTip>, removed: &Removed) -> f64 {
    let Some(bounds) = removed.bounds else { return 0.0 };
    let from = timing.from;
    let (dx, dz) = (to.x.to_mm() - from.x.to_mm(), to.z.to_mm() - from.z.to_mm());
    let (way, start, low, high) = if dz.abs() >= dx.abs() {
        (dz, from.z.to_mm(), bounds.min.z, bounds.max.z)
    } else {
        (dx, from.x.to_mm(), bounds.min.x, bounds.max.x)
    };
    let along = if way < 0.0 { start - high } else { low - start };
    (along / way.abs() * timing.length_mm).clamp(0.0, timing.length_mm)
}
