//! Gears of the spindle: how fast it turns in each, how fast it gets there, and what changing costs.
//!
//! A change slows the spindle down to the speed at which its wheels may meet, takes its time, and speeds the spindle up in
//! the new gear. The first gear is in at power-on.

/// A gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// The auxiliary function that changes to it.
    pub code: u32,
    /// The spindle turns no slower in it, rpm.
    pub rpm_min: f64,
    /// The spindle turns no faster in it, rpm.
    pub rpm_max: f64,
    /// How fast the spindle changes its speed in it, rpm per second; 0 for at once.
    pub ramp_rpm_per_s: f64,
}

/// Who chooses the gear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GearSelection {
    /// The program, by an auxiliary function.
    #[default]
    ByCode,
    /// The machine: the lowest gear that reaches the speed of an order.
    BySpeed,
}

/// The gears of a spindle, the lowest first; none: one range, that of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gears {
    gears: [Option<Gear>; Self::COUNT_MAX],
    /// Who chooses.
    pub selection: GearSelection,
    /// From the speed of changing to the new gear, seconds.
    pub change_s: f64,
    /// The spindle turns no faster while it changes, rpm; 0: it stands.
    pub change_rpm: f64,
}

impl Gears {
    /// More are not kept.
    pub const COUNT_MAX: usize = 8;

    /// These gears, chosen by the program, changed at standstill and in no time.
    pub fn new(given: impl IntoIterator<Item = Gear>) -> Self {
        let mut gears = Self::default();
        for (place, given) in gears.gears.iter_mut().zip(given) {
            *place = Some(given);
        }
        gears
    }

    /// A gear by its place, the lowest is 0.
    pub(crate) fn get(&self, place: usize) -> Option<Gear> {
        *self.gears.get(place)?
    }

    /// The gear that an auxiliary function changes to, by its place.
    pub fn of_code(&self, code: u32) -> Option<usize> {
        self.all().position(|gear| gear.code == code)
    }

    /// The lowest gear that reaches a speed, or the highest of all.
    pub(crate) fn for_speed(&self, rpm: f64) -> Option<usize> {
        let last = self.all().count().checked_sub(1)?;
        Some(self.all().position(|gear| rpm <= gear.rpm_max).unwrap_or(last))
    }

    /// The fastest that the spindle turns in a gear, or, where the machine chooses it, in any, rpm.
    pub fn rpm_max(&self, place: usize) -> Option<f64> {
        match self.selection {
            GearSelection::ByCode => self.get(place).map(|gear| gear.rpm_max),
            GearSelection::BySpeed => self.all().map(|gear| gear.rpm_max).reduce(f64::max),
        }
    }

    /// Whether a machine can have them.
    pub(crate) fn are_sound(&self) -> bool {
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        not_negative(self.change_s)
            && not_negative(self.change_rpm)
            && self.all().all(|gear| {
                not_negative(gear.ramp_rpm_per_s)
                    && not_negative(gear.rpm_min)
                    && gear.rpm_max.is_finite()
                    && gear.rpm_min < gear.rpm_max
            })
    }

    fn all(&self) -> impl Iterator<Item = Gear> {
        self.gears.into_iter().flatten()
    }
}
