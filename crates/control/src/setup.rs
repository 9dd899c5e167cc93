//! The setup: which machine, offsets, parameters, stock and tools a program meets.

use std::collections::BTreeMap;

use serde::Deserialize;
use turnwright_geometry::Outline;

use crate::setup_comment::lay_over;
use crate::signal::Signal;
use crate::{
    Axis, Chuck, ChuckOutlines, Material, Measure, MeasureEntry, Parameters, Stock, Tailstock, Tool,
    ToolEntry, embedded, nearest,
};

/// A pair of axis values in millimetres; X as a diameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisPair {
    /// X, mm, diameter.
    #[serde(default)]
    pub x: f64,
    /// Z, mm.
    #[serde(default)]
    pub z: f64,
}

/// A stored zero: millimetres, X as a diameter, C and B in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(missing_docs, reason = "the axes")]
pub struct ZeroRow {
    pub x: f64,
    pub z: f64,
    pub c: f64,
    pub y: f64,
    pub b: f64,
}

impl ZeroRow {
    /// The value of an axis.
    pub const fn value(&self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
            Axis::C => self.c,
            Axis::Y => self.y,
            Axis::B => self.b,
        }
    }

    /// A row of the values that axes have.
    pub fn of(value: impl Fn(Axis) -> f64) -> Self {
        let [x, z, c, y, b] = Axis::ALL.map(value);
        Self { x, z, c, y, b }
    }

    /// The axes to show: X, Z and those of the others that are not zero.
    pub fn shown(&self) -> impl Iterator<Item = (Axis, f64)> + '_ {
        let all = Axis::ALL.into_iter().map(|axis| (axis, self.value(axis)));
        all.filter(|(axis, value)| Axis::TURNING.contains(axis) || *value != 0.0)
    }
}

/// A machine: rates, times, and where its reference point lies. Units are the last part of each name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "name and unit say it; data/machines has the words")]
pub struct Machine {
    pub name: String,
    pub rapid_x_mm_per_min: f64,
    pub rapid_z_mm_per_min: f64,
    pub cutting_max_mm_per_min: f64,
    pub acceleration_x_mm_per_s2: f64,
    pub acceleration_z_mm_per_s2: f64,
    pub jerk_x_mm_per_s3: f64,
    pub jerk_z_mm_per_s3: f64,
    pub corner_s: f64,
    /// Where cutting moves get their acceleration.
    #[serde(default)]
    pub acc_dec: AccDec,
    pub in_position_s: f64,
    pub tool_change_s: f64,
    pub spindle_ramp_rpm_per_s: f64,
    pub auxiliary_s: f64,
    /// M codes that take another time, by number.
    #[serde(default)]
    pub auxiliary_m_s: BTreeMap<String, f64>,
    /// Who waits until the spindle has its speed.
    #[serde(default)]
    pub speed_wait: SpeedWait,
    /// The M code that stops the spindle at an angle.
    #[serde(default)]
    pub orientation_m: Option<u32>,
    /// From standstill to that angle.
    #[serde(default)]
    pub orientation_s: f64,
    /// Until the operator presses cycle start after M00, and after M01 where that stops.
    #[serde(default)]
    pub stop_s: f64,
    /// Once a piece, at the end of the program: loading and unloading.
    #[serde(default)]
    pub loading_s: f64,
    /// Once a piece, at the end of the program: bar feed.
    #[serde(default)]
    pub bar_feed_s: f64,
    pub rpm_max: u32,
    pub rpm_min_surface: u32,
    pub reference: AxisPair,
    /// The fastest that driven tools turn; left out: there are none.
    pub live_tool_rpm_max: Option<u32>,
    #[serde(default)]
    pub axes: MachineAxes,
}

/// Where cutting moves get their acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AccDec {
    /// Before interpolation: the path is kept.
    #[default]
    Before,
    /// After interpolation: each axis comes behind, corners are cut short.
    After,
}

/// Who waits until the spindle has its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedWait {
    /// The block that orders it.
    #[default]
    Order,
    /// The next cut.
    Cut,
}

/// The axes that a machine has beyond X and Z.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MachineAxes {
    /// Rotary axis about Z: the spindle as an axis.
    pub c: Option<RotaryAxis>,
    /// Linear axis across X and Z.
    pub y: Option<LinearAxis>,
    /// Rotary axis about Y.
    pub b: Option<RotaryAxis>,
}

/// A rotary axis.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotaryAxis {
    /// The axis number by which parameters name it.
    pub number: u8,
    /// Rapid traverse, degrees per minute.
    pub rapid_deg_per_min: f64,
    /// It turns no faster while it cuts, degrees per minute.
    pub cutting_max_deg_per_min: f64,
    /// Acceleration, degrees/s².
    #[serde(default = "rotary_acceleration")]
    pub acceleration_deg_per_s2: f64,
    /// Jerk, degrees/s³.
    #[serde(default = "rotary_jerk")]
    pub jerk_deg_per_s3: f64,
    /// Its reference point, degrees.
    #[serde(default)]
    pub reference_deg: f64,
    /// Degrees after which its display begins again.
    #[serde(default = "full_turn")]
    pub turn_deg: f64,
    /// Whether its display begins again after a turn, and an absolute word goes the shorter way round.
    #[serde(default)]
    pub rolls_over: bool,
    /// The basic axis to which it lies parallel in planes: 5 for X, 6 for Y; left out: the one the plane asks for.
    pub parallel: Option<u8>,
    /// M codes that make the spindle an axis.
    #[serde(default)]
    pub on_m: Vec<u32>,
    /// M codes that make the axis a spindle again.
    #[serde(default)]
    pub off_m: Vec<u32>,
}

/// A linear axis.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearAxis {
    /// The axis number by which parameters name it.
    pub number: u8,
    /// Rapid traverse, mm per minute.
    pub rapid_mm_per_min: f64,
    /// Acceleration, mm/s².
    #[serde(default = "linear_acceleration")]
    pub acceleration_mm_per_s2: f64,
    /// Jerk, mm/s³.
    #[serde(default = "linear_jerk")]
    pub jerk_mm_per_s3: f64,
    /// Its reference point, mm.
    #[serde(default)]
    pub reference_mm: f64,
}

fn full_turn() -> f64 {
    360.0
}

fn rotary_acceleration() -> f64 {
    1_000.0
}

fn rotary_jerk() -> f64 {
    20_000.0
}

fn linear_acceleration() -> f64 {
    2_000.0
}

fn linear_jerk() -> f64 {
    100_000.0
}

impl MachineAxes {
    /// The axis with a number, from 1: X and Z are the first two, the others say it themselves.
    pub fn numbered(&self, number: usize) -> Option<Axis> {
        Axis::ALL.into_iter().find(|axis| self.number(*axis) == Some(number))
    }

    /// The number of an axis, if the machine has it.
    pub fn number(&self, axis: Axis) -> Option<usize> {
        let rotary = |axis: &Option<RotaryAxis>| axis.as_ref().map(|axis| usize::from(axis.number));
        match axis {
            Axis::X => Some(1),
            Axis::Z => Some(2),
            Axis::C => rotary(&self.c),
            Axis::Y => self.y.as_ref().map(|axis| usize::from(axis.number)),
            Axis::B => rotary(&self.b),
        }
    }

    /// What no axis can have.
    fn fault(&self) -> Option<String> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        for (name, axis) in [("c", &self.c), ("b", &self.b)] {
            let Some(axis) = axis else { continue };
            let is_sound = positive(axis.rapid_deg_per_min)
                && positive(axis.cutting_max_deg_per_min)
                && positive(axis.acceleration_deg_per_s2)
                && positive(axis.jerk_deg_per_s3)
                && positive(axis.turn_deg)
                && axis.turn_deg <= 1e6
                && axis.reference_deg.abs() <= 1e6;
            if !is_sound {
                return Some(format!("axes.{name}: rates and turn must be greater than zero"));
            }
            if !matches!(axis.parallel, None | Some(5 | 6)) {
                return Some(format!("axes.{name}: parallel is 5 (to X) or 6 (to Y)"));
            }
        }
        let y_is_sound = self.y.as_ref().is_none_or(|axis| {
            positive(axis.rapid_mm_per_min)
                && positive(axis.acceleration_mm_per_s2)
                && positive(axis.jerk_mm_per_s3)
                && axis.reference_mm.abs() <= 1e6
        });
        (!y_is_sound).then(|| "axes.y: the rate must be greater than zero".to_string())
    }
}

/// One row of an offset table, mm, as the control's screen shows it: X is a diameter unless the parameter for
/// X offsets makes it a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffsetRow {
    /// X.
    #[serde(default)]
    pub x: f64,
    /// Y.
    #[serde(default)]
    pub y: f64,
    /// Z.
    #[serde(default)]
    pub z: f64,
    /// Nose radius.
    #[serde(default)]
    pub r: f64,
}

/// A tool offset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Geometry.
    #[serde(default)]
    pub geometry: OffsetRow,
    /// Wear.
    #[serde(default)]
    pub wear: OffsetRow,
    /// Direction of the imaginary tip, 0 to 9; one value for both tables.
    #[serde(default)]
    pub tip: u8,
}

/// How the machine stands when the program starts.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Start {
    /// The operator has returned the axes to their reference points.
    pub homed: bool,
    /// How the program got into the control.
    pub mode: Mode,
}

/// Where the blocks of the main program come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The memory of the control: automatic operation.
    #[default]
    Memory,
    /// Typed in at the panel: what has to search the program is refused in it.
    Mdi,
}

impl Default for Start {
    fn default() -> Self {
        Self { homed: true, mode: Mode::Memory }
    }
}

/// `[checks]` of a setup file: warnings by name or number.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CheckSwitches {
    /// Not told.
    pub allow: Vec<String>,
    /// Told as errors.
    pub deny: Vec<String>,
}

/// What a setup file says.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// The control to use.
    pub control: Option<String>,
    /// The machine, by the name of its file in `data/machines`.
    pub machine: Option<String>,
    /// Parameters by the control's numbers; for one that each axis has its own of, `1221 = { X = …, Z = … }` or
    /// `1221.X = …`.
    #[serde(default)]
    pub parameters: BTreeMap<String, toml::Value>,
    /// Overrides of single machine values.
    #[serde(default)]
    pub rates: toml::Table,
    /// Axes beyond X and Z, added to those of the machine; `c = false` takes one away.
    #[serde(default)]
    pub axes: toml::Table,
    /// Tool offsets by number.
    #[serde(default)]
    pub offsets: BTreeMap<String, Offset>,
    /// How the machine stands when the program starts.
    #[serde(default)]
    pub start: Start,
    /// Signals that end skip and measuring moves; the first that fits a move counts.
    #[serde(default)]
    pub skip: Vec<Signal>,
    /// Stored zeros, mm, X as a diameter, C and B in degrees: `G54` to `G59`, `"G54.1 P1"` and so on, the external offset `EXT` and
    /// the workpiece shift `SHIFT`. They are what the control stores, counted from the machine's `reference`: with
    /// that at X0 Z0 they are true machine coordinates.
    #[serde(default)]
    pub work: BTreeMap<String, ZeroRow>,
    /// What is in the chuck before the first cut.
    #[serde(default)]
    pub stock: Option<Stock>,
    /// What the finished part must measure.
    #[serde(default)]
    pub measure: Vec<MeasureEntry>,
    /// What holds it.
    #[serde(default)]
    pub chuck: Option<Chuck>,
    /// A centre in its front face.
    #[serde(default)]
    pub tailstock: Option<Tailstock>,
    /// Tools by turret station.
    #[serde(default)]
    pub tools: BTreeMap<String, ToolEntry>,
    /// Which warnings are switched off, and which count as errors.
    #[serde(default)]
    pub checks: CheckSwitches,
    /// Parameters of a punched text that are not known here, or only in part, by number: `"1023" = "A1P1 A2P2"`.
    /// They change nothing and are written out again.
    #[serde(default)]
    pub kept: BTreeMap<String, String>,
}

/// What is wrong with a setup file, with its line when known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupFault {
    /// What is wrong.
    pub message: String,
    /// Line from 1, or 0.
    pub line: u32,
}

fn of_section(section: &str, (key, why): (&'static str, String)) -> SetupFault {
    SetupFault { message: format!("{section}.{key}: {why}"), line: 0 }
}

/// A message of the TOML reader about an unknown word, with the known word that is nearest.
fn with_suggestion(message: &str) -> String {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    match quoted[..] {
        [typed, ref known @ ..] if message.starts_with("unknown ") && known.len() > 1 => {
            let near = nearest(typed, known.iter().copied());
            near.map_or_else(|| message.to_string(), |near| format!("{message}; did you mean {near}?"))
        }
        _ => message.to_string(),
    }
}

/// The line of the key that a message begins with (`tools.3.insert: …`), as far as it is written in the usual way: a
/// section in brackets and a line for each key.
fn line_of(text: &str, message: &str) -> u32 {
    let path = message.split(": ").next().unwrap_or_default();
    let (section, key) = path.rsplit_once('.').unwrap_or((path, ""));
    let (mut header, mut of_section) = (String::new(), 0);
    let mut listed = BTreeMap::<String, u32>::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let number = index as u32 + 1;
        if let Some(name) = line.strip_prefix('[') {
            header = name.trim_matches(['[', ']']).replace([' ', '"', '\''], "");
            if name.starts_with('[') {
                let count = listed.entry(header.clone()).or_default();
                *count += 1;
                header = format!("{header}.{count}");
            }
            if header == path || (header == section && of_section == 0) {
                of_section = number;
            }
        } else if let Some((name, _)) = line.split_once('=') {
            let name = name.trim().replace([' ', '"', '\''], "");
            let whole = if header.is_empty() { name.clone() } else { format!("{header}.{name}") };
            if whole == path || (header == section && name == key) {
                return number;
            }
            if whole == section && of_section == 0 {
                of_section = number;
            }
        }
    }
    of_section
}

/// A value as a user would type it; the name of its kind when it is none, which is refused as no number.
pub(crate) fn typed(value: &toml::Value) -> String {
    match value {
        toml::Value::Integer(value) => value.to_string(),
        toml::Value::Float(value) => value.to_string(),
        toml::Value::Boolean(value) => u8::from(*value).to_string(),
        toml::Value::String(value) => value.clone(),
        other => other.type_str().to_string(),
    }
}

/// Names of the machines in `data/machines`.
pub fn machine_names() -> impl Iterator<Item = &'static str> {
    embedded::MACHINES.iter().map(|(name, _)| *name)
}

/// No time of a machine is longer.
const DAY_S: f64 = 86_400.0;

/// M codes with a time of their own.
pub const AUXILIARY_TIMES_MAX: usize = 16;

impl Machine {
    /// The machine as the control's parameters limit it: rapid traverse, cutting feed, spindle speed, and the lowest
    /// speed of constant surface speed. A parameter of 0 leaves the machine's own value.
    #[must_use]
    pub fn limited_by(mut self, parameters: &Parameters) -> Self {
        let set = |name| Some(parameters.value(name)).filter(|value| *value > 0.0);
        let of_axis = |name, axis| Some(parameters.axis_value(name, axis)).filter(|value: &f64| *value > 0.0);
        if let Some(rate) = of_axis("rapid-rate", Axis::X) {
            self.rapid_x_mm_per_min = rate;
        }
        if let Some(rate) = of_axis("rapid-rate", Axis::Z) {
            self.rapid_z_mm_per_min = rate;
        }
        // The time in which a rapid comes to its rate, and the time in which its acceleration builds up.
        let per_s =
            |axis, rate: f64| of_axis("rapid-time-constant", axis).map(|ms: f64| rate / 60.0 / (ms / 1e3));
        let builds_up = |axis, acceleration: f64| {
            of_axis("rapid-time-constant-bell", axis).map(|ms: f64| acceleration / (ms / 1e3))
        };
        for (axis, rate, acceleration, jerk) in [
            (
                Axis::X,
                self.rapid_x_mm_per_min,
                &mut self.acceleration_x_mm_per_s2,
                &mut self.jerk_x_mm_per_s3,
            ),
            (
                Axis::Z,
                self.rapid_z_mm_per_min,
                &mut self.acceleration_z_mm_per_s2,
                &mut self.jerk_z_mm_per_s3,
            ),
        ] {
            *acceleration = per_s(axis, rate).unwrap_or(*acceleration);
            *jerk = builds_up(axis, *acceleration).unwrap_or(*jerk);
        }
        // Each axis is averaged twice: half of the time constant each. One time holds for the path.
        let of_cuts = Axis::TURNING.into_iter().filter_map(|axis| of_axis("cutting-time-constant", axis));
        if let Some(ms) = of_cuts.reduce(f64::max) {
            self.corner_s = (ms / 2e3).min(1.0);
        }
        if let Some(feed) = set("cutting-feed-maximum") {
            self.cutting_max_mm_per_min = feed;
        }
        // Along a path the faster axis counts: a feed above its limit is surely held down.
        let fastest =
            |name| Axis::TURNING.into_iter().filter_map(|axis| of_axis(name, axis)).reduce(f64::max);
        if let Some(feed) = fastest("cutting-feed-maximum-axis") {
            let of_all = set("cutting-feed-maximum").unwrap_or(f64::INFINITY);
            self.cutting_max_mm_per_min = feed.min(of_all);
        }
        for (axis, rotary) in [(Axis::C, &mut self.axes.c), (Axis::B, &mut self.axes.b)] {
            let Some(rotary) = rotary else { continue };
            rotary.rapid_deg_per_min = of_axis("rapid-rate", axis).unwrap_or(rotary.rapid_deg_per_min);
            rotary.cutting_max_deg_per_min =
                of_axis("cutting-feed-maximum-axis", axis).unwrap_or(rotary.cutting_max_deg_per_min);
        }
        if let (Some(rate), Some(axis)) = (of_axis("rapid-rate", Axis::Y), &mut self.axes.y) {
            axis.rapid_mm_per_min = rate;
        }
        if let (Some(turn), Some(axis)) = (set("rotary-turn"), &mut self.axes.c) {
            axis.turn_deg = turn;
        }
        if let Some(rpm) = set("spindle-maximum-rpm") {
            self.rpm_max = rpm as u32;
        }
        if let Some(rpm) = set("surface-speed-minimum-rpm") {
            self.rpm_min_surface = rpm as u32;
        }
        self
    }

    /// Codes and seconds of the M codes whose time is known.
    pub fn auxiliary_times(&self) -> impl Iterator<Item = (u32, f64)> {
        self.auxiliary_m_s.iter().filter_map(|(code, seconds)| Some((code.parse().ok()?, *seconds)))
    }

    /// What no time can be.
    fn time_fault(&self) -> Option<String> {
        let is_time = |seconds: f64| (0.0..=DAY_S).contains(&seconds);
        let times = [
            ("tool_change_s", self.tool_change_s),
            ("auxiliary_s", self.auxiliary_s),
            ("orientation_s", self.orientation_s),
            ("stop_s", self.stop_s),
            ("loading_s", self.loading_s),
            ("bar_feed_s", self.bar_feed_s),
        ];
        if let Some((key, _)) = times.into_iter().find(|(_, seconds)| !is_time(*seconds)) {
            return Some(format!("{key}: from 0 to {DAY_S} seconds"));
        }
        let count = self.auxiliary_m_s.len();
        if count > AUXILIARY_TIMES_MAX {
            return Some(format!("auxiliary_m_s: at most {AUXILIARY_TIMES_MAX} M codes, not {count}"));
        }
        self.auxiliary_m_s.iter().find_map(|(code, seconds)| {
            let is_code = code.bytes().all(|byte| byte.is_ascii_digit()) && code.parse::<u32>().is_ok();
            let why = if is_code { "from 0 to 86400 seconds" } else { "the key is the number of an M code" };
            (!is_code || !is_time(*seconds)).then(|| format!("auxiliary_m_s.{code}: {why}"))
        })
    }
}

impl Setup {
    /// Reads a setup file's text.
    ///
    /// # Errors
    /// What cannot be read, unknown keys with the known ones.
    pub fn parse(text: &str) -> Result<Self, SetupFault> {
        let setup: Self = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = if error.span().is_some() {
                text.get(..start).unwrap_or("").matches('\n').count() as u32 + 1
            } else {
                0
            };
            SetupFault { message: with_suggestion(error.message()), line }
        })?;
        if let Some(message) = setup.skip.iter().find_map(Signal::fault) {
            return Err(SetupFault { message: message.to_string(), line: 0 });
        }
        setup.check().map_err(|mut fault| {
            fault.line = line_of(text, &fault.message);
            fault
        })?;
        Ok(setup)
    }

    /// Reads a setup file's text with what comments of the program lay over it; see
    /// [`setup_comment`](crate::setup_comment).
    ///
    /// # Errors
    /// As [`Setup::parse`]; for what comes from a comment the key and the reason.
    pub fn with_comments(text: &str, comments: Vec<toml::Table>) -> Result<Self, SetupFault> {
        if comments.is_empty() {
            return Self::parse(text);
        }
        let read = |error: toml::de::Error| SetupFault { message: with_suggestion(error.message()), line: 0 };
        let Ok(mut table) = toml::from_str::<toml::Table>(text) else { return Self::parse(text) };
        // Faults of the file alone have their line; but a comment may give what the file leaves out.
        let of_file = toml::from_str::<Self>(text);
        if of_file.is_err() {
            return Self::parse(text);
        }
        comments.into_iter().for_each(|comment| lay_over(&mut table, comment));
        let setup: Self = table.try_into().map_err(read)?;
        if let Some(message) = setup.skip.iter().find_map(Signal::fault) {
            return Err(SetupFault { message: message.to_string(), line: 0 });
        }
        setup.check()?;
        Ok(setup)
    }

    /// Whether stock, chuck, tailstock and tools can be.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn check(&self) -> Result<(), SetupFault> {
        self.material()?;
        self.measures()?;
        self.stock_outline()?;
        self.chuck_outlines()?;
        self.tailstock_outline()?;
        self.tools().map(|_| ())
    }

    /// The half-section of the stock in work coordinates, X as a radius.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn stock_outline(&self) -> Result<Option<Outline>, SetupFault> {
        self.stock
            .as_ref()
            .filter(|stock| !stock.is_shapeless() || stock.is_empty())
            .map(|stock| stock.outline().map_err(|fault| of_section("stock", fault)))
            .transpose()
    }

    /// What the stock is made of.
    ///
    /// # Errors
    /// A material that nobody knows.
    pub fn material(&self) -> Result<Option<&'static Material>, SetupFault> {
        let found =
            self.stock.as_ref().map(|stock| stock.material().map_err(|fault| of_section("stock", fault)));
        found.transpose().map(Option::flatten)
    }

    /// What the finished part must measure, in the order of the file.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn measures(&self) -> Result<Vec<Measure>, SetupFault> {
        let measures = self.measure.iter().enumerate();
        let read = |(index, entry): (usize, &MeasureEntry)| {
            entry.read().map_err(|fault| of_section(&format!("measure.{}", index + 1), fault))
        };
        measures.map(read).collect()
    }

    /// Jaws and chuck.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn chuck_outlines(&self) -> Result<Option<ChuckOutlines>, SetupFault> {
        let Some(chuck) = &self.chuck else { return Ok(None) };
        let stock = self.stock_outline()?;
        chuck.outlines(stock.as_ref()).map(Some).map_err(|fault| of_section("chuck", fault))
    }

    /// The centre and its quill.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn tailstock_outline(&self) -> Result<Option<Outline>, SetupFault> {
        let Some(tailstock) = &self.tailstock else { return Ok(None) };
        let face_z = self.stock_outline()?.map(|stock| stock.bounds().max.z);
        tailstock.outline(face_z).map(Some).map_err(|fault| of_section("tailstock", fault))
    }

    /// The tools with their shapes, by turret station. Nose and tip that an entry leaves open are those of the
    /// offset of the same number.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn tools(&self) -> Result<BTreeMap<u32, Tool>, SetupFault> {
        let shaped = self.tools.iter().map(|(name, entry)| {
            let fault = |key: &str, why: String| {
                let key = if key.is_empty() { String::new() } else { format!(".{key}") };
                SetupFault { message: format!("tools.{name}{key}: {why}"), line: 0 }
            };
            let station = name.parse::<u32>().ok().filter(|station| (1..=999).contains(station));
            let station =
                station.ok_or_else(|| fault("", "a turret station is a number, 1 to 999".to_string()))?;
            let offset = self.offsets.iter().find(|(number, _)| number.parse() == Ok(station));
            let nose = offset.map(|(_, offset)| (offset.geometry.r + offset.wear.r, offset.tip));
            entry.resolve(nose).map(|tool| (station, tool)).map_err(|wrong| fault(wrong.key, wrong.why))
        });
        let mut tools = BTreeMap::new();
        for one in shaped {
            let (station, tool) = one?;
            if tools.insert(station, tool).is_some() {
                return Err(SetupFault {
                    message: format!("tools: station {station} is there twice"),
                    line: 0,
                });
            }
        }
        Ok(tools)
    }

    /// After which part of a move, of a block at `line` and for an input, a signal comes. Places are work
    /// coordinates, X as a diameter.
    pub fn signal(&self, line: u32, input: Option<u8>, from: AxisPair, to: AxisPair) -> Option<f64> {
        self.skip.iter().find_map(|signal| signal.part(line, input, from, to))
    }

    /// Parameters as number and value, in words as a user would type them.
    pub fn parameter_words(&self) -> Vec<(String, String)> {
        let mut words = Vec::new();
        for (number, value) in &self.parameters {
            match value {
                toml::Value::Table(axes) => {
                    words.extend(axes.iter().map(|(axis, value)| (format!("{number}.{axis}"), typed(value))));
                }
                value => words.push((number.clone(), typed(value))),
            }
        }
        words
    }

    /// States a parameter by its number, with bit and axis behind it: `3401#0`, `1221.X`.
    pub fn set_parameter(&mut self, address: &str, value: f64) {
        let value = if value.fract() == 0.0 && value.abs() < 1e15 {
            toml::Value::Integer(value as i64)
        } else {
            toml::Value::Float(value)
        };
        match address.split_once('.') {
            None => {
                self.parameters.insert(address.to_string(), value);
            }
            Some((number, axis)) => {
                let axes = self.parameters.entry(number.to_string());
                let axes = axes.or_insert_with(|| toml::Value::Table(toml::Table::new()));
                if !axes.is_table() {
                    *axes = toml::Value::Table(toml::Table::new());
                }
                if let toml::Value::Table(axes) = axes {
                    axes.insert(axis.to_string(), value);
                }
            }
        }
    }

    /// The machine with its overrides.
    ///
    /// # Errors
    /// An unknown machine or an unknown key among the overrides.
    pub fn machine(&self) -> Result<Machine, SetupFault> {
        let wanted = self.machine.as_deref().unwrap_or("generic-lathe");
        let Some((_, text)) = embedded::MACHINES.iter().find(|(name, _)| *name == wanted) else {
            let near = nearest(wanted, machine_names());
            let near = near.map_or(String::new(), |name| format!("; did you mean {name}?"));
            return Err(SetupFault { message: format!("no machine is called {wanted}{near}"), line: 0 });
        };
        let fault = |error: toml::de::Error| SetupFault { message: error.message().to_string(), line: 0 };
        let mut table: toml::Table = toml::from_str(text).map_err(fault)?;
        for (key, value) in &self.rates {
            // A whole number is a fine length too.
            table.insert(key.clone(), value.clone());
        }
        if !self.axes.is_empty() {
            let axes = table.entry("axes").or_insert_with(|| toml::Table::new().into());
            change_axes(axes, &self.axes);
        }
        let machine: Machine = table.try_into().map_err(fault)?;
        let positive = [
            machine.rapid_x_mm_per_min,
            machine.rapid_z_mm_per_min,
            machine.cutting_max_mm_per_min,
            machine.spindle_ramp_rpm_per_s,
            machine.acceleration_x_mm_per_s2,
            machine.acceleration_z_mm_per_s2,
            machine.jerk_x_mm_per_s3,
            machine.jerk_z_mm_per_s3,
            machine.corner_s,
        ];
        if positive.iter().any(|rate| !rate.is_finite() || *rate <= 0.0) {
            return Err(SetupFault { message: "rates must be greater than zero".to_string(), line: 0 });
        }
        if machine.corner_s > 1.0 || !(0.0..=60.0).contains(&machine.in_position_s) {
            let message = "corner_s is at most 1, in_position_s from 0 to 60".to_string();
            return Err(SetupFault { message, line: 0 });
        }
        if let Some(message) = machine.time_fault() {
            return Err(SetupFault { message, line: 0 });
        }
        match machine.axes.fault() {
            Some(message) => Err(SetupFault { message, line: 0 }),
            None => Ok(machine),
        }
    }
}

/// Lays the axes of a setup over those of a machine, value by value.
fn change_axes(of_machine: &mut toml::Value, of_setup: &toml::Table) {
    let Some(axes) = of_machine.as_table_mut() else { return };
    for (name, change) in of_setup {
        match (change, axes.get_mut(name).and_then(toml::Value::as_table_mut)) {
            (toml::Value::Boolean(false), _) => {
                axes.remove(name);
            }
            (toml::Value::Table(change), Some(axis)) => {
                axis.extend(change.iter().map(|(key, value)| (key.clone(), value.clone())));
            }
            (other, _) => {
                axes.insert(name.clone(), other.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_are_errors_with_a_line() {
        let fault = Setup::parse("control = \"x\"\nmachin = \"y\"\n").expect_err("unknown key");
        assert_eq!(fault.line, 2);
        assert!(fault.message.contains("machin"), "{}", fault.message);
    }

    #[test]
    fn a_parameter_of_each_axis_is_a_table() {
        let setup =
            Setup::parse("[parameters]\n5130 = 10\n1221 = { X = -1.5, Z = 2 }\n1241.Z = 3\n").expect("setup");
        let words = setup.parameter_words();
        let words: Vec<_> = words.iter().map(|(number, value)| format!("{number}={value}")).collect();
        assert_eq!(words, ["1221.X=-1.5", "1221.Z=2", "1241.Z=3", "5130=10"]);
    }

    #[test]
    fn a_setup_that_is_written_reads_back() {
        let text = "control = \"a\\\"b\"\nmachine = \"m\"\n[parameters]\n\"3401#0\" = 1\n1221 = { X = -0.5 }\n051 = \"7\"\n\
                    [rates]\nrapid_x_mm_per_min = 6000\naxes = { c = { number = 3 } }\nlist = [1, 2]\n\
                    [kept]\n1023 = \"A1P1 A2P2\"\n[work]\n\"G54.1 P2\" = { z = -1.25 }\n\
                    [offsets.12]\ngeometry = { x = -10.001, y = 2 }\nwear = { r = 0.4 }\ntip = 3\n[offsets.2]\n";
        let mut setup = Setup::parse(text).expect("a setup");
        assert_eq!(Setup::parse(&setup.to_toml()), Ok(setup.clone()), "{}", setup.to_toml());
        setup.set_parameter("1221.Z", 3.0);
        setup.set_parameter("5130", 12.0);
        let words = Setup::parse(&setup.to_toml()).expect("a setup").parameter_words();
        assert!(words.contains(&("1221.Z".to_string(), "3".to_string())), "{words:?}");
        assert!(words.contains(&("1221.X".to_string(), "-0.5".to_string())), "{words:?}");
        assert_eq!(Setup::default().to_toml(), "");
    }

    #[test]
    fn machines_load_and_take_overrides() {
        let setup = Setup::parse("[rates]\nrapid_x_mm_per_min = 6000\n").expect("setup");
        assert_eq!(setup.machine().expect("machine").rapid_x_mm_per_min, 6000.0);
        let setup = Setup::parse("[rates]\nrapid_y = 1\n").expect("setup");
        assert!(setup.machine().is_err());
        let setup = Setup::parse("[rates]\nbar_feed_s = 8\nauxiliary_m_s = { 10 = 2.5 }\n").expect("setup");
        let machine = setup.machine().expect("machine");
        assert_eq!((machine.bar_feed_s, machine.stop_s), (8.0, 0.0));
        assert_eq!(machine.auxiliary_times().collect::<Vec<_>>(), [(10, 2.5)]);
        for wrong in
            ["stop_s = -1", "loading_s = 1e6", "auxiliary_m_s = { x = 1 }", "auxiliary_m_s = { 10 = -1 }"]
        {
            let setup = Setup::parse(&format!("[rates]\n{wrong}\n")).expect("setup");
            assert!(setup.machine().is_err(), "{wrong}");
        }
        let setup = Setup::parse("machine = \"turn-mill\"\n[axes]\nc.rapid_deg_per_min = 9000\nb = false\n");
        let axes = setup.expect("setup").machine().expect("machine").axes;
        assert_eq!(axes.c.map(|axis| (axis.number, axis.rapid_deg_per_min)), Some((4, 9000.0)));
        assert_eq!((axes.b, axes.y.map(|axis| axis.number)), (None, Some(3)));
        let setup = Setup::parse("machine = \"turn-mill\"").expect("setup");
        let machine = setup.machine().expect("machine");
        assert_eq!(machine.axes.numbered(3), Some(Axis::Y));
        assert_eq!((machine.axes.number(Axis::C), machine.axes.numbered(9)), (Some(4), None));
        let mut parameters = crate::Control::load(crate::DEFAULT_CONTROL).expect("control").parameters;
        for (number, value) in [("1420.C", "720"), ("1420.Y", "500"), ("1430.B", "90")] {
            parameters.set(number, value).expect(number);
        }
        let axes = machine.limited_by(&parameters).axes;
        assert_eq!(axes.c.map(|axis| axis.rapid_deg_per_min), Some(720.0));
        assert_eq!(axes.y.map(|axis| axis.rapid_mm_per_min), Some(500.0));
        assert_eq!(axes.b.map(|axis| axis.cutting_max_deg_per_min), Some(90.0));
        for (number, value) in [("1420.X", "12000"), ("1620.X", "100"), ("1621.X", "50"), ("1622.Z", "64")] {
            parameters.set(number, value).expect(number);
        }
        let machine = Setup::default().machine().expect("machine").limited_by(&parameters);
        // 200 mm/s in 100 ms; the acceleration builds up in 50 ms.
        assert_eq!((machine.acceleration_x_mm_per_s2, machine.jerk_x_mm_per_s3), (2000.0, 40_000.0));
        assert_eq!((machine.acceleration_z_mm_per_s2, machine.corner_s), (3000.0, 0.032));
        let setup = Setup::parse("[axes.y]\nnumber = 3\nrapid_mm_per_min = 0.0\n").expect("setup");
        assert!(setup.machine().is_err());
        for name in machine_names() {
            let setup = Setup { machine: Some(name.to_string()), ..Setup::default() };
            setup.machine().expect(name);
        }
    }
}
