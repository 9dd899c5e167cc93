//! The clock: one [`Timing`] a command.
//!
//! In: commands in order of execution. Out: seconds, length and spindle speed of each, and the sums.
//!
//! The clock keeps the position, the tool number and the spindle. A move whose speed is zero (feed per
//! revolution with the spindle standing, no feed at all) has no known time: it counts no seconds and is
//! counted in [`Clock::unknown_feeds`].

use turnwright_canon::{
    Action, Command, Dwell, OtherAxes, PanelLock, PathMode, RapidPath, Shape, SpindleWatch,
};
use turnwright_units::{Feed, Lead, Position, WorkTip};

use crate::axes::AxisPlaces;
use crate::dynamics::Dynamics;
use crate::leg::{Place, X, Z};
use crate::path::{ArcPath, CutPath, stretches};
use crate::spindle::{Order, Shift, Spindle};
use crate::surface::Slowness;
use crate::tap::TapPace;
use crate::totals::{Kind, SECONDS_MAX, Totals};
use crate::{MachineRates, Panel, RapidSurfaceSpeed, SpeedWait};

/// Differences of speed below this are rounding, rpm.
const RPM_NEAR: f64 = 1e-6;

/// A spindle that is not where the watch of its speed wants it: an alarm on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleStray {
    /// Program text of the command.
    pub source: u32,
    /// Its line.
    pub line: u32,
    /// The speed asked for, rpm.
    pub ordered_rpm: f64,
    /// The real one, rpm.
    pub real_rpm: f64,
}

/// The spindle speeds of a move, rpm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RpmRange {
    /// Slowest.
    pub min: f64,
    /// Fastest.
    pub max: f64,
}

impl RpmRange {
    /// The range that holds two speeds.
    fn between(one: f64, other: f64) -> Self {
        Self { min: one.min(other), max: one.max(other) }
    }

    /// The range that holds two ranges.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// How long one command takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// What the time is spent on.
    pub kind: Kind,
    /// Where the tool stood before.
    pub from: Position<WorkTip>,
    /// Seconds in all.
    pub seconds: f64,
    /// The part of `seconds` in which a cut waited for the spindle to reach its speed.
    pub waited_s: f64,
    /// Length of the path, mm (X as radius); 0 when nothing moves.
    pub length_mm: f64,
    /// Spindle speeds asked for during a move or a dwell; `None` when the spindle stands.
    pub rpm: Option<RpmRange>,
}

/// Measures commands in order of execution.
#[derive(Clone, Debug)]
pub struct Clock {
    rates: MachineRates,
    /// The operator has set the panel otherwise than usual.
    is_manned: bool,
    mode: PathMode,
    lock: PanelLock,
    position: Position<WorkTip>,
    axes: AxisPlaces,
    tool: Option<u32>,
    spindle: Spindle,
    /// The speed of the thread in progress, rpm: a chain of threads keeps it.
    thread_rpm: Option<f64>,
    /// The spindle is led with a tap.
    is_led: bool,
    watch: Option<SpindleWatch>,
    /// Text and line of the last command while the speed is watched.
    watched_at: (u32, u32),
    stray: Option<SpindleStray>,
    /// What the last command began with, when it changed the gear.
    shift: Option<Shift>,
    totals: Totals,
    unknown_feeds: u64,
}

/// Seconds and length of a move, before any wait.
struct Way {
    seconds: f64,
    length_mm: f64,
}

impl Clock {
    /// A clock at zero: the tool tip at `start`, the spindle standing, the turret at an unknown station.
    pub fn new(start: Position<WorkTip>, rates: MachineRates) -> Self {
        Self {
            rates,
            is_manned: rates.panel != Panel::default(),
            mode: PathMode::Continuous,
            lock: PanelLock::default(),
            position: start,
            axes: AxisPlaces::default(),
            tool: None,
            spindle: Spindle::new(&rates),
            thread_rpm: None,
            is_led: false,
            watch: None,
            watched_at: (0, 0),
            stray: None,
            shift: None,
            totals: Totals::default(),
            unknown_feeds: 0,
        }
    }

    /// Where the tool tip is.
    pub const fn position(&self) -> Position<WorkTip> {
        self.position
    }

    /// The sums so far.
    pub const fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Commands whose time is unknown because nothing would turn or move.
    pub const fn unknown_feeds(&self) -> u64 {
        self.unknown_feeds
    }

    pub(crate) const fn axes(&self) -> &AxisPlaces {
        &self.axes
    }

    pub(crate) const fn rates(&self) -> &MachineRates {
        &self.rates
    }

    pub(crate) const fn spindle(&self) -> &Spindle {
        &self.spindle
    }

    pub(crate) const fn spindle_order(&self) -> Order {
        self.spindle.order
    }

    /// Rapid traverse of each axis on such a way, per minute, at 100 %.
    pub(crate) fn rapid_rates(&self, path: RapidPath) -> Place {
        let rates = &self.rates;
        let (x, z, y) = (rates.rapid_x_mm_per_min, rates.rapid_z_mm_per_min, rates.rapid_y_mm_per_min);
        let (c, b) = (rates.rapid_c_deg_per_min, rates.rapid_b_deg_per_min);
        match path {
            RapidPath::Home if rates.home_mm_per_min > 0.0 => {
                let home = rates.home_mm_per_min;
                [home, home, home, c, b, home]
            }
            _ => [x, z, y, c, b, x],
        }
    }

    /// The same as the operator has it.
    fn rapid_rates_now(&self, path: RapidPath) -> Place {
        let rates = self.rapid_rates(path);
        if !self.is_manned {
            return rates;
        }
        rates.map(|rate| self.panel().rapid_rate(&self.rates.panel_rules, rate))
    }

    /// The panel as the program lets it act.
    pub(crate) fn panel(&self) -> Panel {
        self.rates.panel.locked(self.lock)
    }

    /// What of the panel the program locks.
    pub(crate) const fn lock(&self) -> PanelLock {
        self.lock
    }

    /// The panel is set otherwise from here on.
    pub(crate) fn set_panel(&mut self, panel: Panel) {
        (self.rates.panel, self.is_manned) = (panel, panel != Panel::default());
    }

    /// The speed of threads and taps, while a dry run acts on them, mm/min.
    pub(crate) fn dry_thread(&self) -> Option<f64> {
        if self.is_manned { self.rates.panel.dry_thread(&self.rates.panel_rules) } else { None }
    }

    /// Time goes by that no command takes.
    pub(crate) fn let_pass(&mut self, seconds: f64) {
        self.spindle.run(seconds.max(0.0));
    }

    /// What the last command began with, when it changed the gear.
    pub(crate) const fn last_shift(&self) -> Option<Shift> {
        self.shift
    }

    /// The spindle is led with a tap.
    pub(crate) const fn is_led(&self) -> bool {
        self.is_led
    }

    /// Nobody watches the speed of the spindle, and the panel is as usual.
    pub(crate) const fn is_plain(&self) -> bool {
        self.watch.is_none() && !self.is_manned
    }

    /// A cut that waited for nothing and changed nothing but the place is over.
    #[inline]
    pub(crate) fn arrive_plainly(&mut self, to: Position<WorkTip>) {
        (self.shift, self.thread_rpm, self.position) = (None, None, to);
    }

    /// Whether a cut from here would wait for the spindle.
    pub(crate) fn would_wait(&self) -> bool {
        let mut spindle = self.spindle;
        spindle.aim(spindle.order.rpm_at(self.position.x.to_mm()));
        self.seconds_to_cut(&spindle) > 0.0
    }

    /// Whether cuts begin before the spindle has its speed.
    pub(crate) const fn cuts_at_once(&self) -> bool {
        matches!(self.rates.speed_wait, SpeedWait::Thread) && !self.rates.arrival.before_cut
    }

    /// Seconds that a cut waits for a spindle.
    fn seconds_to_cut(&self, spindle: &Spindle) -> f64 {
        if self.cuts_at_once() {
            0.0
        } else {
            self.seconds_to_arrival(spindle, self.rates.arrival.before_cut)
        }
    }

    /// Seconds until a spindle has its speed and, where it looks at all, the control has seen it.
    fn seconds_to_arrival(&self, spindle: &Spindle, looks: bool) -> f64 {
        let until_look = if looks { spindle.seconds_to_look(self.rates.arrival.delay_s) } else { 0.0 };
        spindle.seconds_to_target().max(until_look)
    }

    /// In the cuts so far the spindle could not follow the diameter: it turns at `rpm`.
    pub(crate) fn lag_behind(&mut self, rpm: f64) {
        self.spindle.turn_at(rpm);
        if let (Some(watch), Order::Surface(law)) = (self.watch, self.spindle.order) {
            // It was reached once, so only the permitted change counts.
            let watch = SpindleWatch { reached_permille: 0, ..watch };
            self.judge(watch, law.rpm_at(self.position.x.to_mm()), rpm);
        }
    }

    /// The first time that the spindle was not where the watch of its speed wants it.
    pub(crate) const fn stray(&self) -> Option<SpindleStray> {
        self.stray
    }

    /// Judges the speed at the moment from which it is looked at after a new order: when the time for reaching it is over.
    fn watch_order(&mut self) {
        let Some(watch) = self.watch.filter(|_| !self.is_led) else { return };
        let shifting_s = self.shift.map_or(0.0, |shift| shift.seconds);
        let mut then = self.spindle;
        then.run((f64::from(watch.delay_ms) / 1e3 - shifting_s).max(0.0));
        let ordered_rpm = self.spindle.target_rpm();
        self.judge(watch, ordered_rpm, then.actual_rpm());
        if self.rates.fluctuation.is_some() {
            // Once it is reached, the speed goes on swinging, and only the permitted change counts.
            self.judge(SpindleWatch { reached_permille: 0, ..watch }, ordered_rpm, ordered_rpm);
        }
    }

    fn judge(&mut self, watch: SpindleWatch, ordered_rpm: f64, real_rpm: f64) {
        let permitted = f64::from(watch.reached_permille.max(watch.allowed_permille)) / 1000.0 * ordered_rpm;
        // Where nobody has said what is permitted, nothing can be wrong.
        let is_told = watch.allowed_permille > 0 || watch.band.0 > 0;
        // An uneven spindle is as far off as it swings.
        let swing_rpm =
            if self.rates.fluctuation.is_some() { self.rates.fluctuation.part * real_rpm } else { 0.0 };
        let real_rpm = if real_rpm > ordered_rpm { real_rpm + swing_rpm } else { real_rpm - swing_rpm };
        let off = (ordered_rpm - real_rpm).abs();
        if is_told && ordered_rpm > 0.0 && off > permitted.max(f64::from(watch.band.0)) + RPM_NEAR {
            let (source, line) = self.watched_at;
            self.stray.get_or_insert(SpindleStray { source, line, ordered_rpm, real_rpm });
        }
    }

    /// Measures the next command.
    pub fn advance(&mut self, command: &Command) -> Timing {
        let path = match &command.action {
            Action::Feed { to, shape, .. } => Some(CutPath::new(self.position, *to, shape)),
            _ => None,
        };
        let timing = self.advance_along(command, path.as_ref());
        self.totals.add(&timing);
        timing
    }

    /// As [`Clock::advance`], but for the sums, with the way of a cutting move that has been measured already.
    pub(crate) fn advance_along(&mut self, command: &Command, path: Option<&CutPath>) -> Timing {
        self.shift = None;
        if self.watch.is_some() {
            self.watched_at = (command.origin.source, command.origin.line);
        }
        let timing = match &command.action {
            Action::Rapid { to, path, others } => self.rapid(*to, *path, others.as_deref()),
            Action::Feed { to, shape, feed, others } => {
                let measured;
                let path = match path {
                    Some(path) => path,
                    None => {
                        measured = CutPath::new(self.position, *to, shape);
                        &measured
                    }
                };
                self.cut(*to, shape, *feed, others.as_deref(), path)
            }
            Action::Thread { to, lead, .. } if self.is_led => self.tap(*to, *lead),
            Action::Thread { to, shape, .. } if self.dry_thread().is_some() => self.dry_cut(*to, shape),
            Action::Thread { to, shape, lead, lead_end, is_chained, .. } => {
                if !is_chained {
                    self.thread_rpm = None;
                }
                self.thread(*to, shape, [*lead, lead_end.as_deref().copied().unwrap_or(*lead)], *is_chained)
            }
            Action::Dwell(dwell) => self.dwell(*dwell),
            Action::Spindle { state, speed, rpm_max } => {
                self.spindle.command(*state, *speed, *rpm_max, &self.rates);
                let gear = self.spindle.other_gear(&self.rates, self.position.x.to_mm());
                self.order_speed(gear)
            }
            Action::Tool { tool, .. } => {
                // Tool 0 cancels an offset, the turret stays; the first call turns it from where nobody knows.
                let turns = *tool != 0 && self.tool != Some(*tool);
                if turns {
                    self.tool = Some(*tool);
                }
                self.still(Kind::ToolChange, if turns { self.rates.tool_change_s } else { 0.0 })
            }
            Action::Auxiliary { code } => self.auxiliary(*code),
            Action::Coolant(_) | Action::SecondAuxiliary { .. } => {
                self.still(Kind::Other, self.rates.auxiliary_s)
            }
            Action::Stop => self.still(Kind::Stop, self.rates.stop_s),
            Action::OptionalStop => self.still(Kind::Stop, self.rates.optional_stop_s),
            Action::End => self.still(Kind::Loading, self.rates.loading_s),
            Action::Relocate { to, others } => {
                self.position = *to;
                if let Some(others) = others {
                    self.axes.follow(others);
                }
                self.still(Kind::Other, 0.0)
            }
            Action::Interpolation(interpolation) => {
                self.axes.interpolate(*interpolation);
                self.still(Kind::Other, 0.0)
            }
            Action::RigidTapping(is_led) => {
                self.is_led = *is_led;
                self.order_speed(None)
            }
            Action::SpindleWatch(watch) => {
                self.watch = *watch;
                if self.rates.fluctuation.is_some() {
                    self.watched_at = (command.origin.source, command.origin.line);
                    self.watch_order();
                }
                self.still(Kind::Other, 0.0)
            }
            Action::PathMode(mode) => {
                self.mode = *mode;
                self.still(Kind::Other, 0.0)
            }
            Action::PanelLock(lock) => {
                self.lock = *lock;
                self.still(Kind::Other, 0.0)
            }
            Action::Coupling(_) | Action::Message(_) | Action::Output(_) => self.still(Kind::Other, 0.0),
        };
        if timing.kind != Kind::Threading {
            self.thread_rpm = None;
        }
        if let Some(to) = command.action.end_point() {
            self.position = to;
        }
        if let Some(others) = command.action.others() {
            self.axes.follow(others);
        }
        timing
    }

    /// The spindle gets another order, or another gear in which to obey the last one.
    fn order_speed(&mut self, gear: Option<usize>) -> Timing {
        self.shift = gear.map(|gear| self.spindle.shift(gear, &self.rates));
        // Led with a tap it stands until that moves.
        let rpm = if self.is_led { 0.0 } else { self.spindle.order.rpm_at(self.position.x.to_mm()) };
        self.spindle.aim(rpm);
        self.watch_order();
        let waits = self.is_led || self.rates.speed_wait == SpeedWait::Order;
        let speeding_s = if waits { self.spindle.seconds_to_target() } else { 0.0 };
        let mut timing = self.still(Kind::Spindle, speeding_s);
        timing.seconds += self.shift.map_or(0.0, |shift| shift.seconds);
        timing
    }

    /// An auxiliary function: the one that orients the spindle stops it first, others may change its gear.
    fn auxiliary(&mut self, code: u32) -> Timing {
        let gear = self.rates.gears.of_code(code).filter(|gear| *gear != self.spindle.gear());
        if gear.is_some() {
            return self.order_speed(gear);
        }
        match self.rates.orientation {
            Some(orientation) if orientation.code == code => {
                self.spindle.stop();
                self.still(Kind::Spindle, self.spindle.seconds_to_target() + orientation.seconds)
            }
            _ => {
                let seconds = self.rates.auxiliary_times.of(code).unwrap_or(self.rates.auxiliary_s);
                self.still(Kind::Other, seconds)
            }
        }
    }

    /// A command that does not move, of so many seconds when that is a time at all.
    fn still(&mut self, kind: Kind, seconds: f64) -> Timing {
        let seconds = if seconds.is_finite() && seconds > 0.0 { seconds } else { 0.0 };
        self.spindle.run(seconds);
        Timing { kind, from: self.position, seconds, waited_s: 0.0, length_mm: 0.0, rpm: None }
    }

    /// Minutes as seconds; a way whose time is not known is counted and takes none.
    fn known_minutes(&mut self, minutes: Option<f64>, length_mm: f64) -> Way {
        let seconds =
            minutes.map(|minutes| minutes * 60.0).filter(|seconds| (0.0..=SECONDS_MAX).contains(seconds));
        self.unknown_feeds += u64::from(seconds.is_none());
        Way { seconds: seconds.unwrap_or(0.0), length_mm }
    }

    fn rapid(&mut self, to: Position<WorkTip>, path: RapidPath, others: Option<&OtherAxes>) -> Timing {
        let way = to - self.position;
        let (dx_mm, dz_mm) = (way.x.to_mm().abs(), way.z.to_mm().abs());
        let rates = self.rapid_rates_now(path);
        let (rate_x, rate_z) = (rates[X], rates[Z]);
        let at_rates = (minutes(dx_mm, rate_x), minutes(dz_mm, rate_z));
        let (minutes, length_mm) = match at_rates {
            (Some(x), Some(z)) => {
                let length_mm = match path {
                    RapidPath::Straight => libm::hypot(dx_mm, dz_mm),
                    RapidPath::EachAxis | RapidPath::Home => {
                        // Both axes until the nearer end, then the other one alone.
                        let both = x.min(z);
                        let together = |way_mm: f64, minutes: f64| {
                            if minutes > 0.0 { way_mm * (both / minutes) } else { 0.0 }
                        };
                        let (x_mm, z_mm) = (together(dx_mm, x), together(dz_mm, z));
                        libm::hypot(x_mm, z_mm) + (dx_mm - x_mm) + (dz_mm - z_mm)
                    }
                };
                // On the straight line the slower axis sets the time, and moves at its own rate.
                (Some(x.max(z)), length_mm)
            }
            _ => (None, libm::hypot(dx_mm, dz_mm)),
        };
        let (minutes, length_mm) = match others {
            None => (minutes, length_mm),
            Some(others) => {
                let way = self.axes.rapid(length_mm, others, &rates, self.rates.dynamics.as_ref());
                (longer(minutes, way.minutes_min), way.length_mm)
            }
        };
        let minutes = match &self.rates.dynamics {
            // At a rate that is none, the time is as little known as without.
            Some(dynamics) if minutes.is_some() && length_mm > 0.0 => {
                self.rapid_minutes(dynamics, [dx_mm, dz_mm], path, others, &rates)
            }
            _ => minutes,
        };
        let way = self.known_minutes(minutes, length_mm);
        let before = self.spindle.target_rpm();
        let after = self.spindle.order.rpm_at(to.x.to_mm());
        match (self.rates.rapid_surface_speed, self.spindle.order) {
            (RapidSurfaceSpeed::AtPresentPoint, Order::Surface(law)) => {
                self.spindle.chase(law, self.position.x.to_mm(), to.x.to_mm(), way.seconds);
            }
            _ => {
                self.spindle.aim(after);
                self.spindle.run(way.seconds);
            }
        }
        Timing {
            kind: Kind::Rapid,
            from: self.position,
            seconds: way.seconds,
            waited_s: 0.0,
            length_mm: way.length_mm,
            rpm: turning(RpmRange::between(before, after)),
        }
    }

    /// Minutes of a rapid from rest to rest and into position.
    fn rapid_minutes(
        &self,
        dynamics: &Dynamics,
        [dx_mm, dz_mm]: [f64; 2],
        path: RapidPath,
        others: Option<&OtherAxes>,
        rates: &Place,
    ) -> Option<f64> {
        let (rate_x, rate_z) = (rates[X], rates[Z]);
        let section = match path {
            RapidPath::EachAxis | RapidPath::Home => {
                longer(dynamics.axes[X].minutes(dx_mm, rate_x), dynamics.axes[Z].minutes(dz_mm, rate_z))
            }
            RapidPath::Straight => {
                let length_mm = libm::hypot(dx_mm, dz_mm);
                let (x, z) = (dx_mm / length_mm, dz_mm / length_mm);
                let per_second = (rate_x / 60.0 / x).min(rate_z / 60.0 / z);
                let limits = dynamics.straight(&[x, z, 0.0, 0.0, 0.0, 0.0]);
                Some(if length_mm > 0.0 { limits.rest_to_rest_s(length_mm, per_second) / 60.0 } else { 0.0 })
            }
        };
        let of = |others| self.axes.rapid(0.0, others, rates, Some(dynamics)).minutes_min;
        let others = others.map_or(Some(0.0), of);
        longer(section, others).map(|minutes| minutes + dynamics.in_position_s / 60.0)
    }

    fn cut(
        &mut self,
        to: Position<WorkTip>,
        shape: &Shape,
        feed: Feed,
        others: Option<&OtherAxes>,
        path: &CutPath,
    ) -> Timing {
        // Of an arc across the section X is taken to change evenly; it matters to the spindle only.
        let &CutPath { start, end, arc, is_curve, length_mm } = path;
        let pieces = || stretches(self.position, to, shape);
        let axes =
            others.map(|others| self.axes.cut(self.position, to, shape, length_mm, others, &self.rates));
        let (length_mm, feed_mm) =
            axes.as_ref().map_or((length_mm, length_mm), |way| (way.length_mm, way.feed_mm));
        let cutting_max = self.rates.cutting_max_mm_per_min;
        let feed = if self.is_manned { self.panel().feed(self.mode, feed) } else { feed };
        // Degrees are no way in millimetres: with rotary axes only the length is held below the limit.
        let fastest = if axes.is_some() { f64::INFINITY } else { cutting_max };
        let known = match (feed, self.spindle.order) {
            (Feed::PerMinute(feed), _) => minutes(feed_mm, feed.0.to_mm().min(fastest)),
            (Feed::PerRevolution(feed), Order::Constant(rpm)) => {
                minutes(feed_mm, (feed.0.to_mm() * rpm).min(fastest))
            }
            (Feed::PerRevolution(feed), Order::Surface(law)) => {
                Slowness::new(feed.0.to_mm(), law, cutting_max).map(|slowness| match arc {
                    None if is_curve => pieces().map(|piece| slowness.minutes_of(&piece)).sum(),
                    None => slowness.line_minutes(start.x, end.x, feed_mm),
                    Some(arc) => arc.circles().map(|circle| slowness.circle_minutes(&circle)).sum(),
                })
            }
        };
        let minutes = axes.map_or(known, |way| longer(known, way.minutes_min));
        let rpm = if is_curve {
            self.speeds_along(start.x, end.x, pieces().filter_map(|piece| piece.arc))
        } else {
            self.speeds_along(start.x, end.x, arc.into_iter())
        };
        let rpm = turning(rpm);
        self.spindle.aim(self.spindle.order.rpm_at(start.x));
        let waited_s = self.wait(self.seconds_to_cut(&self.spindle));
        let way = self.known_minutes(minutes, length_mm);
        self.spindle.follow(self.spindle.order.rpm_at(end.x));
        Timing {
            kind: Kind::Cutting,
            from: self.position,
            seconds: waited_s + way.seconds,
            waited_s,
            length_mm: way.length_mm,
            rpm,
        }
    }

    /// The spindle speeds along a line, an arc or several.
    fn speeds_along(&self, start_x_mm: f64, end_x_mm: f64, arcs: impl Iterator<Item = ArcPath>) -> RpmRange {
        let (mut low, mut high) = (start_x_mm.min(end_x_mm), start_x_mm.max(end_x_mm));
        for arc in arcs {
            for turn in arc.turning_points() {
                (low, high) = (low.min(turn.x), high.max(turn.x));
            }
        }
        let nearest = if low <= 0.0 && high >= 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        let order = self.spindle.order;
        RpmRange::between(order.rpm_at(low.abs().max(high.abs())), order.rpm_at(nearest))
    }

    /// Waits until the spindle turns at `rpm` and, where it `looks`, the control has seen it, in seconds.
    fn wait_for(&mut self, rpm: f64, looks: bool) -> f64 {
        self.spindle.aim(rpm);
        self.wait(self.seconds_to_arrival(&self.spindle, looks))
    }

    /// Waits so many seconds for the spindle.
    fn wait(&mut self, seconds: f64) -> f64 {
        self.spindle.run(seconds);
        self.spindle.has_arrived();
        seconds
    }

    /// Minutes that a thread takes beyond its turns: half a turn, on average, for the start angle to come round, and
    /// half of each ramp. Of a chain they are counted at its start.
    fn thread_start_minutes(&self, [dx_mm, dz_mm]: [f64; 2], lead: Lead, rpm: f64) -> f64 {
        let Some(dynamics) = self.rates.dynamics.filter(|_| rpm > 0.0) else { return 0.0 };
        let long_mm = dx_mm.max(dz_mm);
        if long_mm == 0.0 {
            return 0.0;
        }
        let limits = dynamics.threading(&[dx_mm / long_mm, dz_mm / long_mm, 0.0, 0.0, 0.0, 0.0]);
        0.5 / rpm + limits.ramp_s(lead.0.to_mm().abs() * rpm / 60.0) / 60.0
    }

    fn thread(
        &mut self,
        to: Position<WorkTip>,
        shape: &Shape,
        [lead, lead_end]: [Lead; 2],
        is_chained: bool,
    ) -> Timing {
        let way = to - self.position;
        let (dx_mm, dz_mm) = (way.x.to_mm().abs(), way.z.to_mm().abs());
        let rpm = self.thread_rpm.unwrap_or_else(|| self.spindle.order.rpm_at(self.position.x.to_mm()));
        self.thread_rpm = Some(rpm);
        let arrival = self.rates.arrival;
        let waited_s = self.wait_for(rpm, arrival.before_cut || arrival.before_thread);
        // A lead that changes evenly with the turns covers the way in as many turns as its mean does.
        let mean_lead_mm = (lead.0.to_mm() + lead_end.0.to_mm()) / 2.0;
        let length_mm = stretches(self.position, to, shape).map(|piece| piece.length_mm()).sum();
        let cutting = minutes(dx_mm.max(dz_mm), mean_lead_mm * rpm);
        let starting = if is_chained { 0.0 } else { self.thread_start_minutes([dx_mm, dz_mm], lead, rpm) };
        let known = self.known_minutes(cutting.map(|minutes| minutes + starting), length_mm);
        Timing {
            kind: Kind::Threading,
            from: self.position,
            seconds: waited_s + known.seconds,
            waited_s,
            length_mm: known.length_mm,
            rpm: turning(RpmRange::between(rpm, rpm)),
        }
    }

    /// A thread in a dry run that acts on it: a way like any other, out of step with the spindle.
    fn dry_cut(&mut self, to: Position<WorkTip>, shape: &Shape) -> Timing {
        let length_mm = stretches(self.position, to, shape).map(|piece| piece.length_mm()).sum();
        let per_minute = self.dry_thread().unwrap_or(0.0).min(self.rates.cutting_max_mm_per_min);
        let way = self.known_minutes(minutes(length_mm, per_minute), length_mm);
        self.spindle.run(way.seconds);
        Timing {
            kind: Kind::Threading,
            from: self.position,
            seconds: way.seconds,
            waited_s: 0.0,
            length_mm: way.length_mm,
            rpm: None,
        }
    }

    /// The way of a tap and the spindle that is led with it, from rest to rest. What it takes beyond the turns at full
    /// speed is the spindle's.
    fn tap(&mut self, to: Position<WorkTip>, lead: Lead) -> Timing {
        let pace = TapPace::new(self, to, lead);
        let seconds = pace.map(|pace| pace.seconds());
        let at_speed = pace.map_or(0.0, |pace| pace.way_mm / pace.speed_mm_per_s);
        let known =
            self.known_minutes(seconds.map(|seconds| seconds / 60.0), pace.map_or(0.0, |pace| pace.way_mm));
        let rpm = pace.map_or(0.0, |pace| pace.peak_rpm());
        Timing {
            kind: Kind::Threading,
            from: self.position,
            seconds: known.seconds,
            waited_s: (known.seconds - at_speed).max(0.0),
            length_mm: known.length_mm,
            rpm: turning(RpmRange::between(rpm, rpm)),
        }
    }

    fn dwell(&mut self, dwell: Dwell) -> Timing {
        let rpm = self.spindle.target_rpm();
        let (minutes, waited_s) = match dwell {
            Dwell::Time(seconds) => (Some(seconds.0 / 60.0), 0.0),
            // Turns are counted at the speed that was asked for.
            Dwell::Turns(turns) if self.rates.speed_wait == SpeedWait::Cut => {
                (minutes(turns.0, rpm), self.wait_for(rpm, false))
            }
            Dwell::Turns(turns) => (minutes(turns.0, rpm), 0.0),
        };
        let seconds = self.known_minutes(minutes, 0.0).seconds;
        let still = self.still(Kind::Dwell, seconds);
        Timing {
            rpm: turning(RpmRange::between(rpm, rpm)),
            seconds: waited_s + still.seconds,
            waited_s,
            ..still
        }
    }
}

/// Minutes for `way` at `per_minute`; `None` when that is not a speed. No way takes no time at any speed.
fn minutes(way: f64, per_minute: f64) -> Option<f64> {
    if way == 0.0 {
        Some(0.0)
    } else if per_minute > 0.0 && per_minute.is_finite() {
        Some(way / per_minute).filter(|minutes| minutes.is_finite())
    } else {
        None
    }
}

/// The longer of two times that an axis needs; not known when one is not.
fn longer(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    Some(one?.max(other?))
}

/// A range of speeds, unless the spindle stands.
fn turning(range: RpmRange) -> Option<RpmRange> {
    (range.max > 0.0).then_some(range)
}
