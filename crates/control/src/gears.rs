//! Gears of the spindle in a machine file.

use serde::Deserialize;

use crate::Parameters;

/// A gear. Units are the last part of each name.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// The M code that changes to it; left out: 41 for the first, 42 for the second, and so on.
    pub m: Option<u32>,
    /// The spindle turns no slower in it.
    #[serde(default)]
    pub rpm_min: u32,
    /// The spindle turns no faster in it.
    pub rpm_max: u32,
    /// How fast the spindle changes its speed in it; left out: as the machine without gears.
    pub ramp_rpm_per_s: Option<f64>,
}

/// Who chooses the gear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GearSelection {
    /// The program, by an M code.
    #[default]
    MCode,
    /// The machine, by the speed asked for.
    Speed,
}

/// Gears that a machine can have.
pub const GEARS_MAX: usize = 8;

/// Names of the parameters that hold down the speed in each.
const MAXIMA: [&str; GEARS_MAX] = [
    "gear-1-maximum-rpm",
    "gear-2-maximum-rpm",
    "gear-3-maximum-rpm",
    "gear-4-maximum-rpm",
    "gear-5-maximum-rpm",
    "gear-6-maximum-rpm",
    "gear-7-maximum-rpm",
    "gear-8-maximum-rpm",
];

/// The M code of the first gear, as most builders have it.
const FIRST_CODE: u32 = 41;

/// The M codes of gears, the lowest first.
pub(crate) fn codes(gears: &[Gear]) -> impl Iterator<Item = u32> {
    gears.iter().zip(FIRST_CODE..).map(|(gear, usual)| gear.m.unwrap_or(usual))
}

/// The largest speeds that the control's parameters give; 0 leaves a gear's own.
pub(crate) fn limit(gears: &mut [Gear], parameters: &Parameters) {
    for (gear, name) in gears.iter_mut().zip(MAXIMA) {
        let rpm = parameters.value(name);
        if rpm >= 1.0 {
            gear.rpm_max = rpm as u32;
            gear.rpm_min = gear.rpm_min.min(gear.rpm_max - 1);
        }
    }
}

/// What no gears can be.
pub(crate) fn fault(gears: &[Gear]) -> Option<String> {
    if gears.len() > GEARS_MAX {
        return Some(format!("gears: at most {GEARS_MAX}, not {}", gears.len()));
    }
    let codes: Vec<u32> = codes(gears).collect();
    let mut numbered = gears.iter().zip(1..);
    numbered.find_map(|(gear, number)| {
        let is_ramp = |ramp: f64| ramp.is_finite() && ramp > 0.0;
        let code = codes[number - 1];
        let why = if gear.rpm_min >= gear.rpm_max {
            "rpm_max must be above rpm_min"
        } else if !gear.ramp_rpm_per_s.is_none_or(is_ramp) {
            "ramp_rpm_per_s must be greater than zero"
        } else if codes.iter().filter(|other| **other == code).count() > 1 {
            "each gear has an M code of its own"
        } else {
            return None;
        };
        Some(format!("gears, number {number}: {why}"))
    })
}
