//! The setup: which machine, offsets, parameters, stock and tools a program meets.

use std::collections::BTreeMap;

use serde::Deserialize;
use turnwright_geometry::Outline;

use crate::machine::Machine;
use crate::setup_comment::lay_over;
use crate::signal::Signal;
use crate::{
    Axis, Bar, Chuck, ChuckOutlines, Material, Measure, MeasureEntry, Stock, Tailstock, Tool, ToolEntry,
    machine_files, nearest,
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

/// What the operator recorded on a thread that is to be cut again: the tool stands in the groove of the thread, and
/// the control notes where, and how the spindle stands. The coordinate that counts is that of the thread's long axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThreadRecord {
    /// Work coordinate X, mm, diameter: for threads that move more in X.
    #[serde(default)]
    pub x: Option<f64>,
    /// Work coordinate Z, mm: for threads that move more in Z.
    #[serde(default)]
    pub z: Option<f64>,
    /// How far the spindle stands behind its index mark, degrees, counted in the direction in which it turns.
    pub angle_deg: f64,
}

impl ThreadRecord {
    fn check(&self) -> Result<(), (&'static str, String)> {
        let lengths = [("x", self.x), ("z", self.z)];
        let is_length = |mm: f64| (-1e5..=1e5).contains(&mm);
        if let Some((key, _)) = lengths.iter().find(|(_, value)| !value.is_none_or(is_length)) {
            return Err((key, "must be a length up to 100000 mm".to_string()));
        }
        if lengths.iter().all(|(_, value)| value.is_none()) {
            return Err(("z", "the record needs z, or x for a thread across the face".to_string()));
        }
        if !(0.0..=360.0).contains(&self.angle_deg) {
            return Err(("angle_deg", "must be 0 to 360".to_string()));
        }
        Ok(())
    }
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
    /// The place recorded on a thread that P1 of the thread cycles repairs.
    #[serde(default, rename = "thread-repair")]
    pub thread_repair: Option<ThreadRecord>,
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
    /// What stands out behind the spindle.
    #[serde(default)]
    pub bar: Option<Bar>,
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
    machine_files::MACHINES.iter().map(|(name, _)| *name)
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
        self.bar_critical_rpm()?;
        self.tailstock_outline()?;
        let record = self.thread_repair.as_ref().map_or(Ok(()), ThreadRecord::check);
        record.map_err(|fault| of_section("thread-repair", fault))?;
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

    /// The speed at which the bar whips behind the spindle; nothing when the setup says nothing of it.
    ///
    /// # Errors
    /// The key and the reason.
    pub fn bar_critical_rpm(&self) -> Result<Option<f64>, SetupFault> {
        let Some(bar) = &self.bar else { return Ok(None) };
        let critical = bar.critical_rpm(self.stock.as_ref(), self.material()?);
        critical.map(Some).map_err(|fault| of_section("bar", fault))
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
        let Some((_, pairs)) = machine_files::MACHINES.iter().find(|(name, _)| *name == wanted) else {
            let near = nearest(wanted, machine_names());
            let near = near.map_or(String::new(), |name| format!("; did you mean {name}?"));
            return Err(SetupFault { message: format!("no machine is called {wanted}{near}"), line: 0 });
        };
        let fault = |error: toml::de::Error| SetupFault { message: error.message().to_string(), line: 0 };
        let mut table = machine_files::table(pairs);
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
            machine.acceleration_cutting_mm_per_s2.unwrap_or(1.0),
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
        if !(0.0..=50.0).contains(&machine.fluctuation_percent)
            || !(0.01..=200.0).contains(&machine.fluctuation_hz)
        {
            let message = "fluctuation_percent is 0 to 50, fluctuation_hz 0.01 to 200".to_string();
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
    use crate::AccDec;

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

    #[test]
    fn parameters_choose_where_cuts_get_their_acceleration() {
        let machine = |control: &str, rates: &str, set: &[(&str, &str)]| {
            let mut parameters = crate::Control::load(control).expect("control").parameters;
            for (number, value) in set {
                parameters.set(number, value).expect(number);
            }
            let setup = Setup::parse(&format!("[rates]\n{rates}")).expect("setup");
            let machine = setup.machine().expect("machine").limited_by(&parameters);
            (machine.acc_dec, machine.acceleration_cutting_mm_per_s2)
        };
        let (tb, tf, ta) = ("fanuc-0i-tc", "fanuc-0i-tf", "gsk-988ta");
        assert_eq!(machine(tf, "", &[]), (AccDec::Before, None));
        for (control, law) in
            [(tb, AccDec::AfterExponential), (tf, AccDec::AfterExponential), (ta, AccDec::After)]
        {
            assert_eq!(machine(control, "", &[("1622.X", "64")]), (law, None));
        }
        for control in [tb, tf] {
            assert_eq!(machine(control, "", &[("1622.X", "64"), ("1610#0.X", "1")]), (AccDec::After, None));
        }
        let exponential = "acc_dec = \"after-exponential\"";
        assert_eq!(machine(ta, exponential, &[]), (AccDec::AfterExponential, None));
        let both = [("1622.X", "64"), ("1660.X", "800"), ("1660.Z", "600")];
        assert_eq!(machine(tf, "", &both), (AccDec::Before, Some(600.0)));
        // 6000 mm/min in 200 ms; one of the two alone is none.
        assert_eq!(machine(tb, "", &[("1770", "6000"), ("1771", "200")]), (AccDec::Before, Some(500.0)));
        assert_eq!(machine(tb, "", &[("1770", "6000"), ("1622.Z", "32")]), (AccDec::AfterExponential, None));
        // The machine file overrules where, the parameter how much.
        assert_eq!(machine(tf, "acc_dec = \"after\"", &both), (AccDec::After, Some(600.0)));
        assert_eq!(machine(tf, "acc_dec = \"before\"", &[("1622.X", "64")]), (AccDec::Before, None));
        let given = "acceleration_cutting_mm_per_s2 = 250";
        assert_eq!(machine(tf, given, &[]), (AccDec::Before, Some(250.0)));
        for wrong in ["fluctuation_percent = 51", "fluctuation_percent = -1", "fluctuation_hz = 0"] {
            assert!(Setup::parse(&format!("[rates]\n{wrong}")).expect("setup").machine().is_err(), "{wrong}");
        }
        let none = Setup::parse("[rates]\nacceleration_cutting_mm_per_s2 = 0").expect("setup");
        assert!(none.machine().is_err());
    }
}
