//! Cutting data along a program: depth of cut, chip thickness, speed, removal rate, force, power, roughness.
//!
//! In: each command with what it removed from the stock and the time it took; the tools' outlines; the material, when it
//! is known. Out: the greatest value of each quantity with its line, the greatest of every line, and a course over time
//! for a picture.
//!
//! How it is reckoned:
//! * Depth of cut `a`: how far what was removed reaches square to the feed; of an inclined move the mean, removed area by
//!   engaged length. A plunging blade has its width as `a`.
//! * Chip thickness `h`: `a · f / l`, with the length `l` of that edge of the outline which leads and lies within `a`. For
//!   a straight edge that is `f · sin κ`; round noses thin the chip as they do in the cut. A drill has two lips.
//! * Removal rate: the exact volume by the time in engagement.
//! * Force and power after Kienzle: `kc = kc1.1 · h^-mc`, `Fc = kc · a · f`, `P = kc · Q`; no correction for rake, wear or
//!   speed. Only with a material.
//! * Roughness of a nose `r` within `f ≤ 2 r`: `Rz = f² / 8 r`; `Ra` is that of a parabola of this height, `4 / (9 √3)` of
//!   it. Only of cuts that are not roughed again.
//!
//! Threads are left out: their chip is none of these. Invariant: every number is finite; what is kept is bounded.

use std::collections::{BTreeMap, VecDeque};

use turnwright_canon::{Action, Command, Phase, SpindleSpeed};
use turnwright_control::{Material, Tool, ToolKind};
use turnwright_geometry::{Outline, Point, Vector};
use turnwright_motion::{RpmRange, Timing};
use turnwright_stock::Removed;
use turnwright_units::{Feed, Position, WorkTip};

/// Lines whose values are kept.
pub const LINES_MAX: usize = 20_000;

/// Stretches of the course over time; when there are more, neighbours become one.
pub const COURSE_MAX: usize = 4_000;

/// What is removed in a thinner layer is no cut, mm: rounding and rubbing.
const CUT_MM: f64 = 1e-4;

/// Chords that an arc of an outline is looked at as.
const CHORDS: u32 = 48;

/// `4 / (9 √3)`: mean deviation of a parabola from its mean line, by its height.
const RA_BY_RZ: f64 = 0.256_600_119_639_833_2;

/// The quantities, in the order of tables and pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Depth of cut, mm.
    Depth,
    /// Chip thickness, mm.
    Chip,
    /// Surface speed, m/min.
    Speed,
    /// Removal rate, cm³/min.
    Removal,
    /// Main cutting force, N.
    Force,
    /// Power at the cut, kW.
    Power,
    /// Theoretical roughness Rz, µm.
    Roughness,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Depth, Self::Chip, Self::Speed, Self::Removal, Self::Force, Self::Power, Self::Roughness];

    /// Name in texts and JSON, with the unit.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Depth => "depth_mm",
            Self::Chip => "chip_thickness_mm",
            Self::Speed => "surface_speed_m_per_min",
            Self::Removal => "removal_rate_cm3_per_min",
            Self::Force => "force_n",
            Self::Power => "power_kw",
            Self::Roughness => "rz_um",
        }
    }
}

/// Mean roughness that belongs to an Rz of turning, the same unit.
pub fn ra_of(rz: f64) -> f64 {
    rz * RA_BY_RZ
}

/// Specific cutting force after Kienzle, N/mm².
pub fn specific_force_n_per_mm2(material: &Material, chip_mm: f64) -> f64 {
    material.kc11_n_per_mm2 * libm::pow(chip_mm, -material.mc)
}

/// One value of each quantity that is known.
pub type Values = [Option<f64>; Quantity::ALL.len()];

/// The greatest of each quantity in a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineData {
    /// Which program text.
    pub source: u32,
    /// Its line, from 1.
    pub line: u32,
    /// The tool.
    pub tool: u32,
    /// The greatest of each.
    pub values: Values,
}

/// A stretch of the course over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// When it begins, s.
    pub from_s: f64,
    /// When it ends, s.
    pub to_s: f64,
    /// The greatest of each.
    pub values: Values,
}

/// What a program asks of its tools and its spindle.
#[derive(Clone, Debug, Default)]
pub struct CuttingData {
    /// What it was reckoned for.
    pub material: Option<&'static Material>,
    /// By line.
    pub lines: Vec<LineData>,
    /// Over time.
    pub course: Vec<Stretch>,
}

impl CuttingData {
    /// The line where a quantity is greatest.
    pub fn peak(&self, quantity: Quantity) -> Option<(f64, &LineData)> {
        let index = quantity as usize;
        let known = self.lines.iter().filter_map(|line| Some((line.values[index]?, line)));
        // Of equal ones the first.
        known.reduce(|best, other| if other.0 > best.0 { other } else { best })
    }
}

/// Follows a program.
#[derive(Clone, Debug)]
pub struct CuttingRun {
    tools: BTreeMap<u32, Tool>,
    material: Option<&'static Material>,
    tool: u32,
    spindle: Option<SpindleSpeed>,
    now_s: f64,
    lines: BTreeMap<(u32, u32, u32), Values>,
    course: VecDeque<Stretch>,
    /// Stretches that are one.
    folding: usize,
    folded: usize,
}

impl CuttingRun {
    /// Tools by station, and the material when it is known.
    pub fn new(tools: BTreeMap<u32, Tool>, material: Option<&'static Material>) -> Self {
        Self {
            tools,
            material,
            tool: 0,
            spindle: None,
            now_s: 0.0,
            lines: BTreeMap::new(),
            course: VecDeque::new(),
            folding: 1,
            folded: 0,
        }
    }

    /// The next command, with its time and what it removed.
    pub fn add(&mut self, command: &Command, timing: &Timing, removed: Option<&Removed>) {
        let from_s = self.now_s;
        self.now_s += timing.seconds;
        match &command.action {
            Action::Tool { tool, .. } => self.tool = *tool,
            Action::Spindle { speed, .. } => self.spindle = Some(*speed),
            _ => {}
        }
        let Some(values) = removed.and_then(|removed| self.values(command, removed, timing)) else { return };
        let key = (command.origin.source, command.origin.line, self.tool);
        if self.lines.len() < LINES_MAX || self.lines.contains_key(&key) {
            join(self.lines.entry(key).or_default(), &values);
        }
        self.push(Stretch { from_s, to_s: self.now_s, values });
    }

    fn push(&mut self, stretch: Stretch) {
        match self
            .course
            .back_mut()
            .filter(|last| !self.folded.is_multiple_of(self.folding) && stretch.from_s - last.to_s < 1.0)
        {
            Some(last) => {
                last.to_s = stretch.to_s;
                join(&mut last.values, &stretch.values);
            }
            None => self.course.push_back(stretch),
        }
        self.folded += 1;
        if self.course.len() > COURSE_MAX {
            self.folding *= 2;
            let mut halved: VecDeque<Stretch> = VecDeque::new();
            for (index, stretch) in self.course.drain(..).enumerate() {
                match halved.back_mut().filter(|_| index % 2 == 1) {
                    Some(last) => {
                        last.to_s = stretch.to_s;
                        join(&mut last.values, &stretch.values);
                    }
                    None => halved.push_back(stretch),
                }
            }
            self.course = halved;
        }
    }

    /// The program is over.
    pub fn finish(self) -> CuttingData {
        let lines = self.lines.into_iter();
        CuttingData {
            material: self.material,
            lines: lines
                .map(|((source, line, tool), values)| LineData { source, line, tool, values })
                .collect(),
            course: self.course.into(),
        }
    }

    fn values(&self, command: &Command, removed: &Removed, timing: &Timing) -> Option<Values> {
        let Action::Feed { to, feed, .. } = &command.action else { return None };
        let tool =
            self.tools.get(&self.tool).or_else(|| self.tools.values().next().filter(|_| self.tool == 0))?;
        let bounds = removed.bounds?;
        let (from, to) = (place(timing.from), place(*to));
        let way = Vector::between(from, to);
        let length = way.length();
        let seconds = timing.seconds - timing.waited_s;
        let rpm = timing.rpm.filter(|rpm| rpm.min > 0.0)?;
        if length <= 0.0 || seconds <= 0.0 {
            return None;
        }
        let ahead = Vector { x: way.x / length, z: way.z / length };
        let square = Square::new(ahead);
        let line = square.of(from);
        let corners = [
            bounds.min,
            bounds.max,
            Point::new(bounds.min.x, bounds.max.z),
            Point::new(bounds.max.x, bounds.min.z),
        ];
        let offs = corners.map(|corner| square.of(corner) - line);
        let (least, most) = (
            offs.iter().copied().fold(f64::INFINITY, f64::min),
            offs.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        );
        // The share of the way on which something was removed.
        let (low, high, start, end) = if way.z.abs() >= way.x.abs() {
            (bounds.min.z, bounds.max.z, from.z, to.z)
        } else {
            (bounds.min.x, bounds.max.x, from.x, to.x)
        };
        let overlap = high.min(start.max(end)) - low.max(start.min(end));
        let share = (overlap / (end - start).abs()).clamp(0.0, 1.0);
        // A round nose takes what lies beside a short way: on no less of it than the width of what was taken asks for.
        // A blade that only just dips in has removed more than it has moved.
        let least_share = (removed.area_mm2 / ((most - least) * length)).min(1.0);
        let share = if share > 0.0 { share.max(least_share) } else { 1.0 };
        let is_upright = way.x.abs() < 1e-9 || way.z.abs() < 1e-9;
        let depth = removed.area_mm2 / (length * share);
        let depth = if is_upright { most - least } else { depth.min(most - least) };
        if depth < CUT_MM {
            return None;
        }
        let edge = Edge::of(&tool.cutting, &square);
        let (low, high) = if is_upright {
            (least, most)
        } else if (least + most) / 2.0 - edge.low < edge.high - (least + most) / 2.0 {
            (edge.low, edge.low + depth)
        } else {
            (edge.high - depth, edge.high)
        };
        let feed_mm = match feed {
            Feed::PerRevolution(feed) => feed.0.to_mm(),
            Feed::PerMinute(feed) => feed.0.to_mm() / self.rpm_at(from.x, rpm).min(self.rpm_at(to.x, rpm)),
        };
        let lips = if tool.kind == ToolKind::Drilling { 2.0 } else { 1.0 };
        let engaged = edge.length_within(&tool.cutting, &square, ahead, low, high);
        let chip = Some(depth * feed_mm / lips / engaged).filter(|chip| chip.is_finite() && *chip > 0.0);
        let removal = removed.volume_mm3 / 1000.0 / (seconds * share / 60.0);
        let kc = self.material.zip(chip).map(|(material, chip)| specific_force_n_per_mm2(material, chip));
        let is_roughed_again = command.origin.cycle.is_some_and(|cycle| cycle.phase != Phase::Finish);
        let nose = Some(tool.nose_radius_mm).filter(|nose| tool.kind == ToolKind::Turning && *nose > 0.0);
        let roughness = nose.filter(|nose| feed_mm <= 2.0 * nose && !is_roughed_again);
        let values = [
            Some(depth),
            chip,
            Some(self.speed((from, to), rpm, bounds.max.x, depth)),
            Some(removal),
            kc.map(|kc| kc * depth * feed_mm),
            kc.map(|kc| kc * removal / 60_000.0),
            roughness.map(|nose| feed_mm * feed_mm / (8.0 * nose) * 1000.0),
        ];
        Some(values.map(|value| value.filter(|value| value.is_finite())))
    }

    /// The speed that is asked for at a distance from the axis; what the spindle lags behind is not counted.
    fn rpm_at(&self, x_mm: f64, rpm: RpmRange) -> f64 {
        match self.spindle {
            Some(SpindleSpeed::Surface(surface)) if x_mm != 0.0 => {
                let wanted = surface.to_m_per_min() * 1000.0 / (2.0 * std::f64::consts::PI * x_mm.abs());
                wanted.min(rpm.max)
            }
            _ => rpm.max,
        }
    }

    /// The fastest that an edge passes material, m/min.
    fn speed(&self, (from, to): (Point, Point), rpm: RpmRange, outermost: f64, depth: f64) -> f64 {
        // What lies outside the way of the tip is cut by the edge above it.
        let above = if outermost > from.x.max(to.x) + 1e-6 { depth } else { 0.0 };
        let at = |x: f64| {
            let turning = 2.0 * std::f64::consts::PI * (x.abs() + above).min(outermost);
            turning * self.rpm_at(x, rpm) / 1000.0
        };
        at(from.x).max(at(to.x))
    }
}

fn join(values: &mut Values, others: &Values) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = match (*value, *other) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
    }
}

fn place(position: Position<WorkTip>) -> Point {
    Point::new(position.x.to_mm(), position.z.to_mm())
}

/// Distances square to the feed.
struct Square(Vector);

impl Square {
    fn new(ahead: Vector) -> Self {
        Self(Vector { x: ahead.z, z: -ahead.x })
    }

    fn of(&self, place: Point) -> f64 {
        self.0.x * place.x + self.0.z * place.z
    }
}

/// How far a tool reaches square to the feed.
struct Edge {
    low: f64,
    high: f64,
}

impl Edge {
    fn of(outline: &Outline, square: &Square) -> Self {
        let offs = outline.segments().iter().flat_map(|segment| [segment.start, segment.at(0.5)]);
        let offs = offs.map(|place| square.of(place));
        offs.fold(Self { low: f64::INFINITY, high: f64::NEG_INFINITY }, |edge, off| Self {
            low: edge.low.min(off),
            high: edge.high.max(off),
        })
    }

    /// The length of the leading edge between two distances square to the feed.
    fn length_within(&self, outline: &Outline, square: &Square, ahead: Vector, low: f64, high: f64) -> f64 {
        let mut length = 0.0;
        for segment in outline.segments() {
            let chords = if segment.bend.is_some() { CHORDS } else { 1 };
            for chord in 0..chords {
                let part = |index: u32| segment.at(f64::from(index) / f64::from(chords));
                let (a, b) = (part(chord), part(chord + 1));
                let way = Vector::between(a, b);
                // The tool lies to the left of its outline; what faces the feed leads.
                let leads = way.x * ahead.z - way.z * ahead.x > 1e-12;
                let (from, to) = (square.of(a), square.of(b));
                let span = (to - from).abs();
                if !leads || span < 1e-12 {
                    continue;
                }
                let within = from.max(to).min(high) - from.min(to).max(low);
                length += way.length() * (within / span).clamp(0.0, 1.0);
            }
        }
        length
    }
}
