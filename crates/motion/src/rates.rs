//! What a machine can do, as far as time is concerned.

use turnwright_units::Rpm;

use crate::{AccDec, Dynamics, Fluctuation, Gears, Panel, PanelRules};

/// Which speed constant surface speed asks for during a rapid move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum RapidSurfaceSpeed {
    /// At once that of the end point.
    #[default]
    AtEndPoint,
    /// That of the present point, all the way.
    AtPresentPoint,
}

/// The times of auxiliary functions that somebody has measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AuxiliaryTimes {
    /// Code and seconds.
    times: [(u32, f64); Self::COUNT_MAX],
    count: usize,
}

impl AuxiliaryTimes {
    /// More are not kept.
    pub const COUNT_MAX: usize = 16;

    /// The times of functions, by code. Those beyond [`Self::COUNT_MAX`] are left out.
    pub fn new(given: impl IntoIterator<Item = (u32, f64)>) -> Self {
        let mut times = Self::default();
        for (place, given) in times.times.iter_mut().zip(given) {
            *place = given;
            times.count += 1;
        }
        times
    }

    /// Seconds of a function, if somebody has said so.
    pub fn of(&self, code: u32) -> Option<f64> {
        self.times().find(|(of, _)| *of == code).map(|(_, seconds)| seconds)
    }

    fn times(&self) -> impl Iterator<Item = (u32, f64)> {
        self.times.into_iter().take(self.count)
    }
}

/// Who waits until the spindle has its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeedWait {
    /// The block that orders the speed: it is over when the spindle has it.
    #[default]
    Order,
    /// The next cut, thread or dwell in turns; what comes before it goes on while the spindle changes its speed.
    Cut,
    /// Threads only: cuts begin while the spindle still changes its speed, and feed per revolution follows it. (Without
    /// [`Dynamics`] that costs no time.)
    Thread,
}

/// What the control itself makes sure of, by parameter, whoever else waits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Arrival {
    /// The first cut behind an order waits for the speed.
    pub before_cut: bool,
    /// So does the first thread.
    pub before_thread: bool,
    /// It looks whether the speed is reached so many seconds behind the order.
    pub delay_s: f64,
}

/// How an axis comes behind where cuts get their acceleration after interpolation ([`crate::AccDec::After`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AfterLaw {
    /// Its speed changes evenly: averaged over twice [`Dynamics::corner_s`].
    #[default]
    Even,
    /// Exponentially: a lag whose time constant is twice [`Dynamics::corner_s`].
    Exponential,
}

/// The orientation of the spindle by an auxiliary function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// The function.
    pub code: u32,
    /// From standstill to the angle, seconds.
    pub seconds: f64,
}

/// The rates of a machine. X rates are those of the slide: millimetres of radius a minute.
///
/// The default is an assumed small production lathe, the same as `data/machines/generic-lathe.toml`; a setup
/// file overwrites it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineRates {
    /// Rapid traverse of X, mm of radius per minute.
    pub rapid_x_mm_per_min: f64,
    /// Rapid traverse of Z, mm per minute.
    pub rapid_z_mm_per_min: f64,
    /// Rapid traverse of a Y axis, mm per minute.
    pub rapid_y_mm_per_min: f64,
    /// Rapid rate of X (mm of radius), Z and Y on the way to a reference point; 0: that of positioning.
    pub home_mm_per_min: f64,
    /// Rapid traverse of a C axis, degrees per minute.
    pub rapid_c_deg_per_min: f64,
    /// Rapid traverse of a B axis, degrees per minute.
    pub rapid_b_deg_per_min: f64,
    /// A C axis turns no faster while it cuts, degrees per minute.
    pub cutting_max_c_deg_per_min: f64,
    /// No cutting move is faster along its path, mm per minute.
    pub cutting_max_mm_per_min: f64,
    /// From one turret station to another, seconds.
    pub tool_change_s: f64,
    /// How fast the spindle speeds up and slows down, rpm per second; 0 for at once.
    pub spindle_ramp_rpm_per_s: f64,
    /// Coolant and other auxiliary functions, seconds each.
    pub auxiliary_s: f64,
    /// Auxiliary functions that take another time.
    pub auxiliary_times: AuxiliaryTimes,
    /// Until the operator presses cycle start after a stop, seconds.
    pub stop_s: f64,
    /// The same after an optional stop; 0 while that is switched off.
    pub optional_stop_s: f64,
    /// A new piece at the end of the program, seconds: bar feed, loading and unloading.
    pub loading_s: f64,
    /// Who waits for the speed.
    pub speed_wait: SpeedWait,
    /// What the control makes sure of.
    pub arrival: Arrival,
    /// Gears of the spindle.
    pub gears: Gears,
    /// Feed hold acts while a rigid tap works.
    pub holds_tapping: bool,
    /// The function that stops the spindle at an angle, if the machine has one.
    pub orientation: Option<Orientation>,
    /// How unevenly the spindle turns.
    pub fluctuation: Fluctuation,
    /// The spindle turns no faster.
    pub rpm_max: Option<Rpm>,
    /// The spindle turns no slower while it follows the diameter, rpm.
    pub rpm_min_surface: u32,
    /// What the spindle does in rapid moves while it follows the diameter.
    pub rapid_surface_speed: RapidSurfaceSpeed,
    /// What the axes can do beyond their rates; `None`: they reach their rates at once.
    pub dynamics: Option<Dynamics>,
    /// How axes come behind where cuts get their acceleration after interpolation.
    pub after: AfterLaw,
    /// How the operator has set the panel from the start.
    pub panel: Panel,
    /// What the control makes of the panel.
    pub panel_rules: PanelRules,
}

impl Default for MachineRates {
    fn default() -> Self {
        Self {
            rapid_x_mm_per_min: 12_000.0,
            rapid_z_mm_per_min: 16_000.0,
            rapid_y_mm_per_min: 8_000.0,
            home_mm_per_min: 0.0,
            rapid_c_deg_per_min: 36_000.0,
            rapid_b_deg_per_min: 9_000.0,
            cutting_max_c_deg_per_min: 18_000.0,
            cutting_max_mm_per_min: 8_000.0,
            tool_change_s: 1.5,
            spindle_ramp_rpm_per_s: 1_000.0,
            auxiliary_s: 0.2,
            auxiliary_times: AuxiliaryTimes::default(),
            stop_s: 0.0,
            optional_stop_s: 0.0,
            loading_s: 0.0,
            speed_wait: SpeedWait::Order,
            arrival: Arrival::default(),
            gears: Gears::default(),
            holds_tapping: false,
            orientation: None,
            fluctuation: Fluctuation::default(),
            rpm_max: Some(Rpm(4_000)),
            rpm_min_surface: 20,
            rapid_surface_speed: RapidSurfaceSpeed::AtEndPoint,
            dynamics: None,
            after: AfterLaw::Even,
            panel: Panel::default(),
            panel_rules: PanelRules::default(),
        }
    }
}

impl MachineRates {
    /// The time constant of axes that come behind exponentially, s.
    pub(crate) fn lag_s(&self) -> Option<f64> {
        let dynamics = self.dynamics.filter(|dynamics| dynamics.acc_dec == AccDec::After)?;
        (self.after == AfterLaw::Exponential).then_some(2.0 * dynamics.corner_s)
    }

    /// The key of the first value that no machine can have: a rate that is not above zero, a time or a ramp
    /// below zero, or a number that is not finite. [`crate::Clock`] counts moves at such a rate as unknown.
    pub fn first_fault(&self) -> Option<&'static str> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        [
            ("rapid_x_mm_per_min", positive(self.rapid_x_mm_per_min)),
            ("rapid_z_mm_per_min", positive(self.rapid_z_mm_per_min)),
            ("rapid_y_mm_per_min", positive(self.rapid_y_mm_per_min)),
            ("home_mm_per_min", not_negative(self.home_mm_per_min)),
            ("rapid_c_deg_per_min", positive(self.rapid_c_deg_per_min)),
            ("rapid_b_deg_per_min", positive(self.rapid_b_deg_per_min)),
            ("cutting_max_c_deg_per_min", positive(self.cutting_max_c_deg_per_min)),
            ("cutting_max_mm_per_min", positive(self.cutting_max_mm_per_min)),
            ("tool_change_s", not_negative(self.tool_change_s)),
            ("spindle_ramp_rpm_per_s", not_negative(self.spindle_ramp_rpm_per_s)),
            ("gears", self.gears.are_sound()),
            ("fluctuation", self.fluctuation.is_sound()),
            ("arrival", not_negative(self.arrival.delay_s)),
            ("auxiliary_s", not_negative(self.auxiliary_s)),
            ("auxiliary_times", self.auxiliary_times.times().all(|(_, seconds)| not_negative(seconds))),
            ("orientation", self.orientation.is_none_or(|orientation| not_negative(orientation.seconds))),
            ("stop_s", not_negative(self.stop_s)),
            ("optional_stop_s", not_negative(self.optional_stop_s)),
            ("loading_s", not_negative(self.loading_s)),
        ]
        .into_iter()
        .find_map(|(key, sound)| (!sound).then_some(key))
        .or_else(|| self.dynamics.and_then(|dynamics| dynamics.first_fault()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_the_generic_lathe_of_the_data_folder() {
        let text = include_str!("../../../data/machines/generic-lathe.toml");
        let value = |key: &str| -> f64 {
            let line =
                text.lines().find(|line| line.split('=').next().is_some_and(|name| name.trim() == key));
            let value = line.and_then(|line| line.split('=').nth(1)).expect(key);
            value.split('#').next().unwrap_or("").trim().parse().expect(key)
        };
        let rates = MachineRates::default();
        assert_eq!(value("rapid_x_mm_per_min"), rates.rapid_x_mm_per_min);
        assert_eq!(value("rapid_z_mm_per_min"), rates.rapid_z_mm_per_min);
        assert_eq!(value("cutting_max_mm_per_min"), rates.cutting_max_mm_per_min);
        assert_eq!(value("tool_change_s"), rates.tool_change_s);
        assert_eq!(value("spindle_ramp_rpm_per_s"), rates.spindle_ramp_rpm_per_s);
        assert_eq!(value("auxiliary_s"), rates.auxiliary_s);
        assert_eq!(Some(value("rpm_max")), rates.rpm_max.map(|rpm| f64::from(rpm.0)));
        assert_eq!(value("rpm_min_surface"), f64::from(rates.rpm_min_surface));
    }

    #[test]
    fn a_rate_of_zero_is_named() {
        assert_eq!(MachineRates::default().first_fault(), None);
        let rates = MachineRates { rapid_z_mm_per_min: 0.0, ..MachineRates::default() };
        assert_eq!(rates.first_fault(), Some("rapid_z_mm_per_min"));
        let rates = MachineRates { auxiliary_s: f64::NAN, ..MachineRates::default() };
        assert_eq!(rates.first_fault(), Some("auxiliary_s"));
    }
}
