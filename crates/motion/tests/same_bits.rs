//! The same commands give the same bits, on every machine: samples and times of seeded random programs, as one number
//! for each kind of program, held against `same_bits.txt`.
//!
//! After a change of the model the numbers are others, and are written anew with
//!
//! ```sh
//! TURNWRIGHT_BLESS=1 cargo test -p turnwright-motion --test same_bits
//! ```
//!
//! Where a file written on one machine fails on another one, the rows that differ say what to look at: functions that
//! are not from the crate `libm` (those of `std` are the platform's), a multiplication and addition in one, zeros with
//! a sign, the order of a hash table. On a machine of another architecture the same command without the variable is
//! the test. Without such a machine it is run in an emulator; on Debian with a rustup that has the other target:
//!
//! ```sh
//! apt-get install qemu-user-static gcc-aarch64-linux-gnu libc6-dev-arm64-cross
//! rustup target add aarch64-unknown-linux-gnu
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64-static -L /usr/aarch64-linux-gnu"
//! cargo test -p turnwright-motion --test same_bits --target aarch64-unknown-linux-gnu
//! ```
//!
//! Without such a target in rustup Debian's own compiler has one. Its packages are unpacked into a folder `$D`
//! (`apt-get download`, `dpkg -x FILE $D`): `rustc-web`, `libstd-rust-web-dev`, `libstd-rust-web-1.96` and the `libllvm`
//! that they ask for, and of the architecture `arm64` the same `libstd-rust-web-dev` once more. Then `RUSTC` names a
//! script that sets `LD_LIBRARY_PATH=$D/usr/lib/x86_64-linux-gnu` and runs `$D/usr/bin/rustc "$@"`.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::fmt::Write;
use std::path::Path;

use turnwright_canon::{
    Action, Command, Curve, Dwell, Interpolation, Origin, OtherAxes, PanelLock, PathMode, RapidPath, Shape,
    SidePlane, SidePoint, SpindleSpeed, SpindleState, Turn,
};
use turnwright_dice::Dice;
use turnwright_motion::{
    AccDec, AfterLaw, Arrival, Dynamics, Fluctuation, MachineRates, Panel, PanelRules, Player, RapidOverride,
    RapidSurfaceSpeed, Sample, Schedule, SpeedWait, ThreadHold, Timing,
};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, Seconds,
    SurfaceSpeed, WorkTip,
};

/// Fowler, Noll and Vo's hash, 64 bits, of eight bytes at a time.
struct Hash(u64);

impl Hash {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bits: u64) {
        self.0 = (self.0 ^ bits).wrapping_mul(0x0000_0100_0000_01b3);
        // What is hashed ends in zeros more often than not; multiplying alone never brings high bits down.
        self.0 ^= self.0 >> 32;
    }

    fn add_number(&mut self, number: f64) {
        self.add(number.to_bits());
    }

    fn add_sample(&mut self, sample: &Sample) {
        let Sample { time_s, place, path_mm_per_s, rpm, turns, kind, source, line } = *sample;
        [time_s, path_mm_per_s, rpm, turns].into_iter().chain(place).for_each(|value| self.add_number(value));
        self.add(kind as u64);
        self.add(u64::from(source) << 32 | u64::from(line));
    }

    fn add_timing(&mut self, timing: &Timing) {
        let Timing { seconds, waited_s, length_mm, rpm, .. } = *timing;
        let rpm = rpm.map_or([-1.0; 2], |rpm| [rpm.min, rpm.max]);
        [seconds, waited_s, length_mm, rpm[0], rpm[1]].into_iter().for_each(|value| self.add_number(value));
    }
}

/// Programs are made of whole numbers only, so that they themselves are the same everywhere. A place has a radius and
/// a Z in nanometres.
struct Writer {
    dice: Dice,
    actions: Vec<Action>,
    x: i64,
    z: i64,
    /// A move goes so far at most, nm.
    reach: i64,
}

impl Writer {
    fn new(seed: u64) -> Self {
        let mut dice = Dice::new(seed * 7919 + 11);
        let reach = *dice.pick(&[20_000_000, 4_000_000, 500_000, 30_000]);
        Self { dice, actions: Vec::new(), x: START.0, z: START.1, reach }
    }

    fn place(x: i64, z: i64) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(x)), Length::from_nm(z))
    }

    /// Another place: an even way in each direction, so that a centre may lie in its middle.
    fn step(&mut self) -> [i64; 4] {
        let (x, z) = (self.x, self.z);
        let half = self.reach / 2;
        let way = |dice: &mut Dice| 2 * dice.whole(-half, half);
        let (dx, dz) = match self.dice.below(6) {
            0 => (0, way(&mut self.dice)),
            1 => (way(&mut self.dice), 0),
            _ => (way(&mut self.dice) / 4 * 2, way(&mut self.dice)),
        };
        // Back where it would go through the axis.
        self.x = if x + dx < 1_000_000 { x - dx } else { x + dx };
        self.z = z + dz;
        [x, z, self.x, self.z]
    }

    fn turn(&mut self) -> Turn {
        Turn::clockwise_if(self.dice.one_in(2))
    }

    /// Never so slow that a program takes minutes.
    fn feed(&mut self, is_long: bool) -> Feed {
        if is_long || self.dice.one_in(2) {
            let slowest = if is_long { 3_000_000_000 } else { 100_000_000 };
            Feed::PerMinute(FeedPerMinute(Length::from_nm(self.dice.whole(slowest, 6_000_000_000))))
        } else {
            Feed::PerRevolution(FeedPerRevolution(Length::from_nm(self.dice.whole(100_000, 800_000))))
        }
    }

    fn cut(&mut self, shape: Shape, others: Option<Box<OtherAxes>>) {
        let feed = self.feed(others.is_some());
        self.actions.push(Action::Feed { to: Self::place(self.x, self.z), shape, feed, others });
    }

    fn line(&mut self) {
        self.step();
        self.cut(Shape::Line, None);
    }

    fn arc(&mut self) {
        let [x, z, to_x, to_z] = self.step();
        let (dx, dz) = ((to_x - x) / 2, (to_z - z) / 2);
        // On the perpendicular bisector, rounded: circles and the hair's breadth of spirals.
        let aside = self.dice.whole(-2, 2);
        let centre = Self::place(x + dx - dz * aside, z + dz + dx * aside);
        let turn = self.turn();
        self.cut(Shape::Arc { turn, centre }, None);
    }

    fn curve(&mut self) {
        let [x, z, to_x, to_z] = self.step();
        let (dx, dz) = ((to_x - x) / 2, (to_z - z) / 2);
        let turn = self.turn();
        let curve = if self.dice.one_in(3) {
            let focal = self.dice.whole(1_000_000, 9_000_000);
            let vertex = Self::place(x, z);
            let tilt = Angle::from_millidegrees(self.dice.whole(0, 359_999));
            Curve::Parabola { turn, vertex, focal_parameter: Length::from_nm(focal), tilt }
        } else {
            let half = dx.abs().max(dz.abs()).max(10_000);
            let (half_along, half_across) = (Length::from_nm(half * 3 / 2), Length::from_nm(half));
            let tilt = Angle::from_millidegrees(self.dice.whole(0, 179_999));
            Curve::Ellipse { turn, centre: Self::place(x + dx, z + dz), half_along, half_across, tilt }
        };
        self.cut(Shape::Curve(Box::new(curve)), None);
    }

    fn rapid(&mut self) {
        self.step();
        let path = *self.dice.pick(&[RapidPath::EachAxis, RapidPath::Straight, RapidPath::Home]);
        let others = self.dice.one_in(4).then(|| {
            let c = Some(Angle::from_millidegrees(self.dice.whole(0, 360_000)));
            Box::new(OtherAxes { c, ..OtherAxes::default() })
        });
        self.actions.push(Action::Rapid { to: Self::place(self.x, self.z), path, others });
    }

    /// Axes beyond X and Z, arcs across the section, virtual planes.
    fn others(&mut self) {
        let [x, _, _, _] = self.step();
        let side = 2 * self.dice.whole(-4_000_000, 4_000_000);
        let angle = Some(Angle::from_millidegrees(self.dice.whole(-90_000, 400_000)));
        let per_degree = Length::from_mm(1);
        let base = OtherAxes { per_degree, ..OtherAxes::default() };
        let others = match self.dice.below(4) {
            0 => OtherAxes { c: angle, ..base },
            1 => OtherAxes { y: Some(Length::from_nm(side)), b: angle, ..base },
            2 => OtherAxes { y: Some(Length::from_nm(side)), ..base },
            _ => {
                let radius = Radius(Length::from_nm(x));
                let interpolation = *self.dice.pick(&[
                    Interpolation::Polar { zero: Angle::ZERO, is_below: false },
                    Interpolation::Cylindrical { radius },
                    Interpolation::Normal,
                ]);
                self.actions.push(Action::Interpolation(interpolation));
                OtherAxes { v: Some(Length::from_nm(side)), c: angle, ..base }
            }
        };
        let shape = if self.dice.one_in(2) {
            let plane = *self.dice.pick(&[SidePlane::Face, SidePlane::Flank, SidePlane::Wall]);
            let along = if plane == SidePlane::Face { self.x } else { self.z };
            let centre = SidePoint { along: Length::from_nm(along / 2), side: Length::from_nm(side / 2) };
            Shape::SideArc { plane, turn: self.turn(), centre }
        } else {
            Shape::Line
        };
        self.cut(shape, Some(Box::new(others)));
    }

    fn spindle(&mut self, is_even: bool) {
        let speed = if is_even || self.dice.one_in(2) {
            SpindleSpeed::Constant(Rpm(self.dice.whole(500, 2_400) as u32))
        } else {
            SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(self.dice.whole(90, 320) as u32))
        };
        let state = *self.dice.pick(&[SpindleState::Clockwise, SpindleState::CounterClockwise]);
        self.actions.push(Action::Spindle { state, speed, rpm_max: Some(Rpm(3_000)) });
    }

    fn thread(&mut self) {
        self.spindle(true);
        let count = 1 + self.dice.below(3);
        for link in 0..count {
            let (x, z) = (self.x, self.z);
            self.z -= self.dice.whole(6_000_000, 25_000_000);
            self.x += self.dice.whole(0, 2) * 500_000;
            let lead = Lead(Length::from_nm(self.dice.whole(500_000, 2_500_000)));
            let lead_end = self.dice.one_in(4).then(|| Box::new(Lead(Length::from_nm(lead.0.nm() * 3 / 2))));
            let shape = if self.dice.one_in(5) {
                let centre = Self::place((x + self.x) / 2 - 40_000_000, (z + self.z) / 2);
                Shape::Arc { turn: Turn::CounterClockwise, centre }
            } else {
                Shape::Line
            };
            let start_angle = Angle::from_millidegrees(self.dice.whole(0, 359_999));
            let to = Self::place(self.x, self.z);
            let is_chained = link > 0;
            self.actions.push(Action::Thread { to, shape, lead, lead_end, start_angle, is_chained });
        }
        self.z += 20_000_000;
        let to = Self::place(self.x + 3_000_000, self.z);
        self.x += 3_000_000;
        self.actions.push(Action::Rapid { to, path: RapidPath::EachAxis, others: None });
    }

    fn tap(&mut self) {
        self.actions.push(Action::RigidTapping(true));
        self.spindle(true);
        let lead = Lead(Length::from_nm(self.dice.whole(500_000, 2_000_000)));
        let deep = self.dice.whole(3_000_000, 20_000_000);
        for z in [self.z - deep, self.z] {
            let to = Self::place(self.x, z);
            let (shape, start_angle) = (Shape::Line, Angle::ZERO);
            let thread = Action::Thread { to, shape, lead, lead_end: None, start_angle, is_chained: false };
            self.actions.push(thread);
        }
        self.actions.push(Action::RigidTapping(false));
    }

    fn mode(&mut self) {
        let modes = [PathMode::Continuous, PathMode::Continuous, PathMode::ExactStop, PathMode::Tapping];
        self.actions.push(Action::PathMode(*self.dice.pick(&modes)));
    }

    fn stand(&mut self) {
        let action = match self.dice.below(4) {
            0 => Action::Dwell(Dwell::Time(Seconds(self.dice.below(300) as f64 / 1024.0))),
            1 => Action::Dwell(Dwell::Turns(turnwright_units::Revolutions(2.5))),
            2 => Action::Auxiliary { code: 8 },
            _ => Action::Tool { tool: 1 + self.dice.below(4) as u32, offset: 1 },
        };
        self.actions.push(action);
    }

    fn anything(&mut self) {
        match self.dice.below(20) {
            0..=6 => self.line(),
            7..=10 => self.arc(),
            11 => self.curve(),
            12..=13 => self.rapid(),
            14 => self.others(),
            15 => self.spindle(false),
            16 => self.thread(),
            17 => self.tap(),
            18 => self.mode(),
            _ => self.stand(),
        }
    }
}

/// Radius and Z, nm.
const START: (i64, i64) = (30_000_000, 5_000_000);

/// Adds a move, or what belongs together, to a program.
type Add = fn(&mut Writer);

/// The kinds of programs.
const KINDS: [(&str, Add); 9] = [
    ("lines", Writer::line),
    ("arcs", Writer::arc),
    ("curves", Writer::curve),
    ("rapids", Writer::rapid),
    ("other-axes", Writer::others),
    ("threads", Writer::thread),
    ("taps", Writer::tap),
    ("anything", Writer::anything),
    ("operated", Writer::anything),
];

/// Programs of each kind.
const PROGRAMS: u64 = 40;

/// What an operator does in the first seconds, every 64 ms or so.
fn operate(dice: &mut Dice) -> Vec<(f64, Panel)> {
    let count = dice.below(30);
    let change = |index: u64| {
        let rapid = *dice.pick(&[
            RapidOverride::Part(1.0),
            RapidOverride::Part(0.25),
            RapidOverride::Part(0.5),
            RapidOverride::Lowest,
        ]);
        let panel = Panel {
            feed: dice.below(25) as f64 / 16.0,
            rapid,
            is_held: dice.one_in(5),
            dry_run_mm_per_min: dice.one_in(6).then_some(2_500.0),
            single_block: dice.one_in(6),
        };
        (index as f64 / 16.0 + dice.below(64) as f64 / 1024.0, panel)
    };
    // Whatever it was, in the end everything goes on.
    (0..count).map(change).chain([(3.0, Panel::default())]).collect()
}

/// Machines that differ in everything that has formulas of its own.
fn machine(dice: &mut Dice) -> MachineRates {
    let acc_dec = if dice.one_in(4) { AccDec::After } else { AccDec::Before };
    let dynamics = Dynamics {
        acc_dec,
        corner_s: (1 + dice.below(24)) as f64 / 1024.0,
        in_position_s: dice.below(30) as f64 / 1024.0,
        ..Dynamics::default()
    };
    let fluctuation =
        if dice.one_in(3) { Fluctuation { part: 0.03, hz: 5.0 } } else { Fluctuation::default() };
    let panel_rules = PanelRules {
        rapid_lowest_per_min: 400.0,
        rapids_heed_feed: dice.one_in(3),
        dry_rapids: dice.one_in(2),
        dry_threads: dice.one_in(2),
        hold_stops_dwell: dice.one_in(2),
        thread_hold: *dice.pick(&[ThreadHold::BehindNextBlock, ThreadHold::AtEnd]),
    };
    MachineRates {
        dynamics: Some(dynamics),
        spindle_ramp_rpm_per_s: *dice.pick(&[0.0, 400.0, 2_500.0]),
        rapid_surface_speed: *dice.pick(&[RapidSurfaceSpeed::AtEndPoint, RapidSurfaceSpeed::AtPresentPoint]),
        speed_wait: *dice.pick(&[SpeedWait::Order, SpeedWait::Cut, SpeedWait::Thread]),
        arrival: Arrival { before_cut: dice.one_in(2), before_thread: dice.one_in(2), delay_s: 0.125 },
        home_mm_per_min: if dice.one_in(2) { 3_000.0 } else { 0.0 },
        holds_tapping: dice.one_in(2),
        fluctuation,
        after: *dice.pick(&[AfterLaw::Even, AfterLaw::Exponential]),
        panel_rules,
        ..MachineRates::default()
    }
}

/// The number of all samples and times of a kind, and how many samples that are.
fn play_kind(index: usize) -> (u64, u64) {
    let (name, add) = KINDS[index];
    let (mut hash, mut samples) = (Hash::new(), 0);
    for program in 0..PROGRAMS {
        let mut writer = Writer::new(1_000 * (index as u64 + 1) + program);
        writer.spindle(false);
        for _ in 0..8 + writer.dice.below(25) {
            add(&mut writer);
            if name == "operated" && writer.dice.one_in(12) {
                let lock = PanelLock {
                    hold: writer.dice.one_in(2),
                    feed_override: writer.dice.one_in(2),
                    dry_run: writer.dice.one_in(2),
                };
                writer.actions.push(Action::PanelLock(lock));
            }
        }
        let mut rates = machine(&mut writer.dice);
        let changes = if name == "operated" { operate(&mut writer.dice) } else { Vec::new() };
        if let Some((_, panel)) = changes.first().filter(|(_, panel)| panel.feed > 0.0 && !panel.is_held) {
            rates.panel = *panel;
        }
        let rate_hz = *writer.dice.pick(&[1000.0, 250.0, 1000.0, 2000.0]);
        let start = Writer::place(START.0, START.1);
        let (mut player, mut schedule) = (Player::new(start, rates, rate_hz), Schedule::new(start, rates));
        changes.iter().for_each(|(time_s, panel)| player.set_at(*time_s, *panel));
        let mut sink = |sample: &Sample| {
            hash.add_sample(sample);
            samples += 1;
        };
        let commands = || {
            let origin = |line: usize| Origin::line(line as u32 + 1);
            writer
                .actions
                .iter()
                .enumerate()
                .map(move |(line, action)| Command::new(action.clone(), origin(line)))
        };
        commands().for_each(|command| player.push(&command, &mut sink));
        player.finish(&mut sink);
        assert!(!player.is_stuck(), "{name} {program}");
        commands().for_each(|command| schedule.push(command));
        schedule.finish();
        while let Some((_, timing)) = schedule.next_known() {
            hash.add_timing(&timing);
        }
    }
    (hash.0, samples)
}

#[test]
fn samples_and_times_have_the_same_bits_everywhere() {
    let (mut page, mut all, mut count) = (String::new(), Hash::new(), 0);
    for (index, (name, _)) in KINDS.iter().enumerate() {
        let (hash, samples) = play_kind(index);
        // A kind that is not played shows nothing.
        assert!(samples > 10_000, "{name}: {samples} samples");
        all.add(hash);
        count += samples;
        let _ = writeln!(page, "{name} {samples} {hash:016x}");
    }
    let _ = writeln!(page, "all {count} {:016x}", all.0);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/same_bits.txt");
    if std::env::var_os("TURNWRIGHT_BLESS").is_some() {
        std::fs::write(&file, &page).expect("writable");
    }
    let before = std::fs::read_to_string(&file).unwrap_or_default();
    assert_eq!(
        page, before,
        "kind, samples, bits: after a change of the model TURNWRIGHT_BLESS=1 writes them anew; without one this machine \
         differs from the one that wrote them"
    );
}
