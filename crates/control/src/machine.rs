//! The machine: rates, times, axes, and what parameters of the control say of them.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::gears::{self, Gear, GearSelection};
use crate::{Axis, AxisPair, Parameters};

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
    /// No cut speeds up faster along its path; left out: what the axes can do.
    #[serde(default)]
    pub acceleration_cutting_mm_per_s2: Option<f64>,
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
    /// Gears of the spindle, the lowest first; none: one range.
    #[serde(default)]
    pub gears: Vec<Gear>,
    /// Who chooses the gear.
    #[serde(default)]
    pub gear_selection: GearSelection,
    /// From the speed of changing to the new gear.
    #[serde(default)]
    pub gear_change_s: f64,
    /// The spindle turns no faster while it changes.
    #[serde(default)]
    pub gear_change_rpm: u32,
    /// By how much the speed of the spindle swings to either side, % of it.
    #[serde(default)]
    pub fluctuation_percent: f64,
    /// How often it swings.
    #[serde(default = "swings_per_s")]
    pub fluctuation_hz: f64,
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
    /// As the control's parameters say: before interpolation where they give an acceleration for that, after it where
    /// they give a time constant of cuts and nothing else, and before it where they give nothing.
    #[default]
    ByParameter,
    /// Before interpolation: the path is kept.
    Before,
    /// After interpolation: each axis comes behind, its speed changing evenly; corners are cut short.
    After,
    /// After interpolation: each axis comes behind, its speed changing exponentially; corners and arcs are cut shorter.
    AfterExponential,
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
    /// Nobody but a thread, unless the control's parameter says so.
    Thread,
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

fn swings_per_s() -> f64 {
    5.0
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
    pub(crate) fn fault(&self) -> Option<String> {
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
        let time_constant_ms = of_cuts.reduce(f64::max);
        if let Some(ms) = time_constant_ms {
            self.corner_s = (ms / 2e3).min(1.0);
        }
        // The acceleration before interpolation: of each axis, or as a speed and the time in which it is reached.
        let of_axes =
            Axis::TURNING.into_iter().filter_map(|axis| of_axis("acceleration-before-interpolation", axis));
        let of_ramp = set("speed-before-interpolation")
            .zip(set("time-before-interpolation"))
            .map(|(mm_per_min, ms)| mm_per_min / 60.0 / (ms / 1e3));
        let before_mm_per_s2 = of_axes.reduce(f64::min).or(of_ramp);
        if let Some(acceleration) = before_mm_per_s2 {
            self.acceleration_cutting_mm_per_s2 = Some(acceleration);
        }
        if self.acc_dec == AccDec::ByParameter {
            let is_after = before_mm_per_s2.is_none() && time_constant_ms.is_some();
            // Where the control has the choice, the bit that is not set means exponential; one law holds for the path.
            let is_even = parameters.number("cutting-even-after-interpolation").is_none()
                || Axis::TURNING
                    .into_iter()
                    .any(|axis| parameters.axis_value("cutting-even-after-interpolation", axis) != 0.0);
            self.acc_dec = match (is_after, is_even) {
                (true, true) => AccDec::After,
                (true, false) => AccDec::AfterExponential,
                (false, _) => AccDec::Before,
            };
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
        gears::limit(&mut self.gears, parameters);
        if let Some(rpm) = set("surface-speed-minimum-rpm") {
            self.rpm_min_surface = rpm as u32;
        }
        self
    }

    /// The M codes of the gears, the lowest gear first.
    pub fn gear_codes(&self) -> impl Iterator<Item = u32> {
        gears::codes(&self.gears)
    }

    /// Codes and seconds of the M codes whose time is known.
    pub fn auxiliary_times(&self) -> impl Iterator<Item = (u32, f64)> {
        self.auxiliary_m_s.iter().filter_map(|(code, seconds)| Some((code.parse().ok()?, *seconds)))
    }

    /// What no time can be.
    pub(crate) fn time_fault(&self) -> Option<String> {
        let is_time = |seconds: f64| (0.0..=DAY_S).contains(&seconds);
        let times = [
            ("tool_change_s", self.tool_change_s),
            ("auxiliary_s", self.auxiliary_s),
            ("orientation_s", self.orientation_s),
            ("gear_change_s", self.gear_change_s),
            ("stop_s", self.stop_s),
            ("loading_s", self.loading_s),
            ("bar_feed_s", self.bar_feed_s),
        ];
        if let Some((key, _)) = times.into_iter().find(|(_, seconds)| !is_time(*seconds)) {
            return Some(format!("{key}: from 0 to {DAY_S} seconds"));
        }
        if let Some(fault) = gears::fault(&self.gears) {
            return Some(fault);
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
