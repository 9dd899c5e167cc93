//! Machine times beside the fastest there are, which `fixtures/motion/optimum.py` has found with ruckig and toppra.

use turnwright_canon::{Action, Command, Origin, RapidPath, Shape, Turn};
use turnwright_motion::{AxisDynamics, Dynamics, MachineRates, Panel, Schedule};
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

const REST_TO_REST: &str = include_str!("../../../fixtures/motion/rest-to-rest.csv");
const PATHS: &str = include_str!("../../../fixtures/motion/paths.csv");
const JERKY_PATHS: &str = include_str!("../../../fixtures/motion/jerky-paths.csv");

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

/// Radius and Z in mm.
fn at(x: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(x)), length(z))
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Seconds of a program; nothing is waited for at its end but the axes themselves.
fn seconds(start: Position<WorkTip>, rates: MachineRates, actions: impl IntoIterator<Item = Action>) -> f64 {
    let mut schedule = Schedule::new(start, rates);
    for (index, action) in actions.into_iter().enumerate() {
        schedule.push(Command::new(action, Origin::line(index as u32 + 1)));
    }
    schedule.finish();
    std::iter::from_fn(|| schedule.next_known()).map(|(_, timing)| timing.seconds).sum()
}

/// The ratio that the planner is meant to keep on ways of half a millimetre and more.
const MEANT: f64 = 1.3;

/// Ours in optima, over a class of cases.
#[derive(Clone, Copy, Debug)]
struct Ratios {
    count: usize,
    least: f64,
    most: f64,
}

impl Ratios {
    const NONE: Self = Self { count: 0, least: f64::INFINITY, most: 0.0 };

    fn add(&mut self, ours_s: f64, optimum_s: f64) {
        let ratio = ours_s / optimum_s;
        (self.least, self.most) = (self.least.min(ratio), self.most.max(ratio));
        self.count += 1;
    }

    /// Never faster than the optimum, whose rounding and grid are allowed for; and the ratio is the one reached, within three
    /// hundredths of it: a planner that does better has its ratio here lowered.
    fn reach(&self, ratio: f64, what: &dyn std::fmt::Debug) {
        assert!(self.least > 0.999, "{self:?} {what:?}");
        assert!(self.most <= ratio && self.most > 0.97 * ratio, "{self:?} instead of {ratio}: {what:?}");
    }
}

fn rapids() -> impl Iterator<Item = (RapidCase, RapidPath)> {
    let paths = [RapidPath::EachAxis, RapidPath::Straight];
    REST_TO_REST.lines().skip(1).flat_map(move |row| paths.map(|path| (RapidCase::new(row), path)))
}

/// Ruckig has the same limits of speed, acceleration and jerk: there the optimum is one, and ours is it, on short ways
/// and long ones, light machines and heavy ones.
#[test]
fn a_rapid_takes_the_least_time_there_is() {
    for (case, path) in rapids() {
        let (ours, optimum) = (case.seconds(path), case.optimum_s(path));
        assert!((ours - optimum).abs() <= 1e-6 * optimum, "{ours} {optimum} {:?} {path:?}", case.way);
    }
}

/// Kind, the points of the path lie so far apart or more (mm), feeds from and to (mm/min), the ratio reached.
type PathClass = (&'static str, f64, f64, f64, f64);

fn ratios_of_paths(paths: &str, classes: &[PathClass], dynamics: Dynamics) -> Vec<Ratios> {
    let mut all = vec![Ratios::NONE; classes.len()];
    for row in paths.lines().skip(1) {
        let case = PathCase::new(row);
        let is_in = |(kind, shortest_mm, from, to, _): &PathClass| {
            case.kind == *kind && case.shortest_mm == *shortest_mm && (*from..*to).contains(&case.feed)
        };
        let index = classes.iter().position(is_in).expect("every path has a class");
        all[index].add(case.seconds(dynamics), case.optimum_s);
    }
    all
}

/// Toppra knows no jerk: here ours has as good as no limit of it either, and the limits are the same. Of arcs the
/// path is kept exactly, and the optimum is one; sharp corners are cut short, by ours no more than by the yardstick.
#[test]
fn cutting_paths_without_jerk_are_near_the_optimum() {
    let mut dynamics = Dynamics { in_position_s: 0.0, corner_s: 0.005, ..Dynamics::default() };
    dynamics.axes.iter_mut().for_each(|axis| axis.jerk_per_s3 = 1e9);
    let any = |kind, shortest_mm, ratio| (kind, shortest_mm, 0.0, f64::INFINITY, ratio);
    let classes = [
        any("arcs", 5.0, 1.07),
        any("corners", 5.0, 1.07),
        any("arcs", 0.5, 1.25),
        any("corners", 0.5, MEANT),
    ];
    for (class, ratios) in classes.iter().zip(ratios_of_paths(PATHS, &classes, dynamics)) {
        ratios.reach(class.4, class);
    }
}

/// With the jerk of a machine: an optimum that keeps speed, acceleration and jerk of each axis and stays as near the path
/// as ours, found by a solver for any trajectory (no planner that goes along its path with a speed comes up to it, as it
/// takes the inside of arcs and goes over corners with the acceleration still there).
#[test]
fn cutting_paths_with_jerk_beside_any_trajectory() {
    const CLASSES: [PathClass; 10] = [
        ("arcs", 5.0, 0.0, 1000.0, 1.02),
        ("corners", 5.0, 0.0, 1000.0, 1.02),
        ("arcs", 0.5, 0.0, 300.0, 1.04),
        ("corners", 0.5, 0.0, 300.0, 1.06),
        ("corners", 5.0, 1000.0, 6000.0, 1.12),
        ("corners", 0.5, 300.0, 1000.0, 1.30),
        ("arcs", 5.0, 1000.0, 6000.0, 1.35),
        ("arcs", 0.5, 300.0, 1000.0, 1.19),
        ("corners", 0.5, 1000.0, 6000.0, 1.58),
        ("arcs", 0.5, 1000.0, 6000.0, 2.24),
    ];
    let dynamics = Dynamics { in_position_s: 0.0, ..Dynamics::default() };
    for (class, ratios) in CLASSES.iter().zip(ratios_of_paths(JERKY_PATHS, &CLASSES, dynamics)) {
        assert!(ratios.count >= 5, "{ratios:?}");
        ratios.reach(class.4, class);
    }
}

/// With the jerk of a machine toppra's times are a bound that nothing can come up to where feeds are fast and ways
/// short: there the acceleration is never had for long. At the feeds of turning it hardly counts.
#[test]
fn cutting_paths_beside_a_machine_without_jerk() {
    const CLASSES: [PathClass; 12] = [
        ("arcs", 5.0, 0.0, 1000.0, 1.01),
        ("corners", 5.0, 0.0, 1000.0, 1.02),
        ("arcs", 0.5, 0.0, 300.0, 1.09),
        ("corners", 0.5, 0.0, 300.0, 1.05),
        ("corners", 5.0, 1000.0, 3000.0, 1.11),
        ("corners", 5.0, 3000.0, 6000.0, 1.18),
        ("corners", 0.5, 300.0, 1000.0, 1.25),
        ("arcs", 5.0, 1000.0, 3000.0, 1.13),
        ("arcs", 0.5, 300.0, 1000.0, 1.29),
        ("arcs", 5.0, 3000.0, 6000.0, 1.34),
        ("corners", 0.5, 1000.0, 6000.0, 2.29),
        ("arcs", 0.5, 1000.0, 6000.0, 2.59),
    ];
    let dynamics = Dynamics { in_position_s: 0.0, ..Dynamics::default() };
    for (class, ratios) in CLASSES.iter().zip(ratios_of_paths(PATHS, &CLASSES, dynamics)) {
        assert!(ratios.count >= 6, "{ratios:?}");
        ratios.reach(class.4, class);
    }
}

/// A rapid of one or two axes.
struct RapidCase {
    way: [f64; 2],
    rates: MachineRates,
    each_s: f64,
    straight_s: f64,
}

impl RapidCase {
    fn new(row: &str) -> Self {
        let fields: Vec<f64> = row.split(',').map(number).collect();
        let [way_x, way_z, speed_x, speed_z, a_x, a_z, jerk_x, jerk_z, each_s, straight_s] = fields[..]
        else {
            panic!("{row}")
        };
        let axis = |acceleration_per_s2, jerk_per_s3| AxisDynamics { acceleration_per_s2, jerk_per_s3 };
        let mut dynamics = Dynamics { in_position_s: 0.0, ..Dynamics::default() };
        (dynamics.axes[0], dynamics.axes[1]) = (axis(a_x, jerk_x), axis(a_z, jerk_z));
        let rates = MachineRates {
            rapid_x_mm_per_min: speed_x * 60.0,
            rapid_z_mm_per_min: speed_z * 60.0,
            dynamics: Some(dynamics),
            ..MachineRates::default()
        };
        Self { way: [way_x, way_z], rates, each_s, straight_s }
    }

    fn seconds(&self, path: RapidPath) -> f64 {
        let rapid = Action::Rapid { to: at(self.way[0], self.way[1]), path, others: None };
        seconds(at(0.0, 0.0), self.rates, [rapid])
    }

    fn optimum_s(&self, path: RapidPath) -> f64 {
        if path == RapidPath::EachAxis { self.each_s } else { self.straight_s }
    }
}

/// A cutting path.
struct PathCase<'a> {
    kind: &'a str,
    shortest_mm: f64,
    feed: f64,
    optimum_s: f64,
    moves: Vec<Action>,
}

impl<'a> PathCase<'a> {
    fn new(row: &'a str) -> Self {
        let fields: Vec<&str> = row.split(',').collect();
        let [kind, shortest_mm, feed, optimum_s, moves] = fields[..] else { panic!("{row}") };
        let mm_per_min = Feed::PerMinute(FeedPerMinute(length(number(feed))));
        let cut = |words: &str| {
            let (kind, numbers) = words.split_once(' ').expect("a move");
            let numbers: Vec<f64> = numbers.split(' ').map(number).collect();
            let arc = |turn| Shape::Arc { turn, centre: at(numbers[2], numbers[3]) };
            let shape = match kind {
                "cw" => arc(Turn::Clockwise),
                "ccw" => arc(Turn::CounterClockwise),
                _ => Shape::Line,
            };
            Action::Feed { to: at(numbers[0], numbers[1]), shape, feed: mm_per_min, others: None }
        };
        Self {
            kind,
            shortest_mm: number(shortest_mm),
            feed: number(feed),
            optimum_s: number(optimum_s),
            moves: moves.split("; ").map(cut).collect(),
        }
    }

    fn seconds(&self, dynamics: Dynamics) -> f64 {
        let rates = MachineRates { dynamics: Some(dynamics), ..MachineRates::default() };
        seconds(at(30.0, 0.0), rates, self.moves.clone())
    }
}

/// Every path at rising overrides.
#[test]
fn a_higher_override_is_never_later() {
    for row in PATHS.lines().skip(1) {
        let case = PathCase::new(row);
        let mut last = f64::INFINITY;
        for percent in [10, 50, 80, 100, 120, 150, 200, 254] {
            let panel = Panel { feed: f64::from(percent) / 100.0, ..Default::default() };
            let rates =
                MachineRates { dynamics: Some(Dynamics::default()), panel, ..MachineRates::default() };
            let now = seconds(at(30.0, 0.0), rates, case.moves.clone());
            // Where a faster tool notices a corner earlier, a little may be lost.
            assert!(now <= last * 1.014, "{percent} % {now} after {last}: {row}");
            last = now;
        }
    }
}
