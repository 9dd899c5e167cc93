//! The spindle: what speed is asked for at a place, and how fast it really turns meanwhile.

use std::f64::consts::TAU;

use turnwright_canon::{SpindleSpeed, SpindleState};
use turnwright_units::Rpm;

use crate::{GearSelection, Gears, MachineRates};

/// No spindle turns faster, rpm: the limit on the axis when neither program nor machine gives one.
pub const RPM_FENCE: f64 = 100_000.0;

/// A slower change of speed is no ramp that a machine has, and its times would add up to infinity.
const RAMP_MIN: f64 = 1e-6;

/// Pieces of a rapid move in which the spindle follows the diameter: the speed asked for is that of each end.
const CHASE_STEPS: u32 = 64;

/// The speeds that constant surface speed asks for: `surface` / radius between two limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceLaw {
    /// Speed × radius, rpm·mm: 1000·V / 2π.
    pub(crate) rpm_mm: f64,
    /// Lower limit, rpm; never above `rpm_max`.
    pub(crate) rpm_min: f64,
    /// Upper limit, rpm; finite.
    pub(crate) rpm_max: f64,
}

impl SurfaceLaw {
    /// The speed at a distance from the axis (mm, either sign), rpm.
    pub(crate) fn rpm_at(self, x_mm: f64) -> f64 {
        let x_mm = x_mm.abs();
        // On the axis the law asks for infinity, which the upper limit answers.
        if x_mm == 0.0 { self.rpm_max } else { (self.rpm_mm / x_mm).clamp(self.rpm_min, self.rpm_max) }
    }
}

/// A ramp that a machine has; 0 for at once.
fn sound_ramp(rpm_per_s: f64) -> f64 {
    if rpm_per_s.is_finite() && rpm_per_s > RAMP_MIN { rpm_per_s } else { 0.0 }
}

/// What is asked of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// The same speed everywhere, rpm.
    Constant(f64),
    /// A speed that follows the diameter.
    Surface(SurfaceLaw),
}

impl Order {
    /// The speed asked for at a distance from the axis (mm), rpm.
    pub(crate) fn rpm_at(self, x_mm: f64) -> f64 {
        match self {
            Self::Constant(rpm) => rpm,
            Self::Surface(law) => law.rpm_at(x_mm),
        }
    }
}

/// Speed and angle of the spindle, tick by tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SpindleAngle {
    /// rpm, negative counter-clockwise.
    pub(crate) rpm: f64,
    /// Turns since the start, either way.
    pub(crate) turns: f64,
}

impl SpindleAngle {
    /// Turns for a while towards a speed, as unevenly as it does; `seconds` are those of turning, which is shorter or
    /// longer than the clock's.
    pub(crate) fn turn(&mut self, rpm: f64, ramp_rpm_per_s: f64, seconds: f64, turning_s: f64) {
        let before = self.rpm;
        let change = ramp_rpm_per_s * seconds;
        let is_near = ramp_rpm_per_s == 0.0 || (rpm - before).abs() <= change;
        self.rpm = if is_near { rpm } else { before + change.copysign(rpm - before) };
        self.turns += (before + self.rpm).abs() / 2.0 / 60.0 * turning_s;
    }
}

/// How unevenly a spindle turns: its speed swings about the one asked for as a sine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fluctuation {
    /// To either side, as a part of the speed.
    pub part: f64,
    /// Swings a second.
    pub hz: f64,
}

impl Fluctuation {
    /// Whether a spindle can turn so.
    pub(crate) fn is_sound(&self) -> bool {
        (0.0..1.0).contains(&self.part) && self.hz.is_finite() && self.hz >= 0.0
    }

    /// Whether there is any.
    pub(crate) fn is_some(&self) -> bool {
        self.part > 0.0 && self.hz > 0.0 && self.is_sound()
    }

    /// The speed at a time as a part of the even one.
    pub(crate) fn at(&self, time_s: f64) -> f64 {
        if self.is_some() { 1.0 + self.part * libm::sin(TAU * self.hz * time_s) } else { 1.0 }
    }

    /// In so many seconds an even spindle turns as far as this one between two times.
    pub(crate) fn seconds(&self, from_s: f64, to_s: f64) -> f64 {
        let even = to_s - from_s;
        if !self.is_some() {
            return even;
        }
        let swing = TAU * self.hz;
        even + self.part / swing * (libm::cos(swing * from_s) - libm::cos(swing * to_s))
    }
}

/// The spindle in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spindle {
    /// What is asked for while cutting.
    pub(crate) order: Order,
    /// +1 clockwise, −1 counter-clockwise: turning round passes through zero.
    direction: f64,
    /// Speed asked for at the moment, signed, rpm.
    target_rpm: f64,
    /// Real speed, signed, rpm.
    actual_rpm: f64,
    /// Change of speed, rpm per second; 0 for at once.
    ramp_rpm_per_s: f64,
    /// The gear that is in.
    gear: usize,
    /// The last order as it was given: another gear answers it otherwise.
    given: (SpindleState, SpindleSpeed, Option<Rpm>),
    /// Seconds since the last order that no cut has waited for yet.
    since_order_s: Option<f64>,
}

/// A change of gear: what the spindle does before it speeds up again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    /// Speed of changing, rpm with its sign.
    pub(crate) rpm: f64,
    /// How fast the spindle gets down to it, rpm per second; 0 for at once.
    pub(crate) ramp_rpm_per_s: f64,
    /// Until the new gear is in, seconds.
    pub(crate) seconds: f64,
}

impl Spindle {
    /// A standing spindle.
    pub(crate) fn new(rates: &MachineRates) -> Self {
        let ramp = rates.gears.get(0).map_or(rates.spindle_ramp_rpm_per_s, |gear| gear.ramp_rpm_per_s);
        Self {
            order: Order::Constant(0.0),
            direction: 1.0,
            target_rpm: 0.0,
            actual_rpm: 0.0,
            ramp_rpm_per_s: sound_ramp(ramp),
            gear: 0,
            given: (SpindleState::Stop, SpindleSpeed::Constant(Rpm(0)), None),
            since_order_s: None,
        }
    }

    /// Takes a new order. The program's limit holds only while the speed follows the diameter.
    pub(crate) fn command(
        &mut self,
        state: SpindleState,
        speed: SpindleSpeed,
        rpm_limit: Option<Rpm>,
        rates: &MachineRates,
    ) {
        self.given = (state, speed, rpm_limit);
        self.since_order_s = Some(0.0);
        let gear = rates.gears.get(self.gear);
        let machine_max = rates.rpm_max.map_or(RPM_FENCE, |rpm| f64::from(rpm.0)).min(RPM_FENCE);
        let machine_max = gear.map_or(machine_max, |gear| gear.rpm_max.min(machine_max).max(0.0));
        let gear_min = gear.map_or(0.0, |gear| gear.rpm_min.min(machine_max).max(0.0));
        self.order = match (state, speed) {
            (SpindleState::Stop, _) | (_, SpindleSpeed::Constant(Rpm(0))) => Order::Constant(0.0),
            (_, SpindleSpeed::Constant(rpm)) => {
                Order::Constant(f64::from(rpm.0).min(machine_max).max(gear_min))
            }
            (_, SpindleSpeed::Surface(surface)) => {
                let rpm_mm = surface.0.to_mm() / std::f64::consts::TAU;
                let rpm_max = rpm_limit.map_or(machine_max, |rpm| f64::from(rpm.0).min(machine_max));
                if rpm_mm > 0.0 && rpm_max > 0.0 {
                    let rpm_min = f64::from(rates.rpm_min_surface).max(gear_min).min(rpm_max);
                    Order::Surface(SurfaceLaw { rpm_mm, rpm_min, rpm_max })
                } else {
                    Order::Constant(0.0)
                }
            }
        };
        match state {
            SpindleState::Clockwise => self.direction = 1.0,
            SpindleState::CounterClockwise => self.direction = -1.0,
            SpindleState::Stop => {}
        }
    }

    /// The gear that answers an order given at a distance from the axis (mm), where the machine chooses it: not the one
    /// that is in.
    pub(crate) fn other_gear(&self, rates: &MachineRates, x_mm: f64) -> Option<usize> {
        let (state, speed, rpm_limit) = self.given;
        if rates.gears.selection == GearSelection::ByCode || state == SpindleState::Stop {
            return None;
        }
        let free = MachineRates { gears: Gears::default(), ..*rates };
        let mut unbound = *self;
        unbound.command(state, speed, rpm_limit, &free);
        let wanted = unbound.order.rpm_at(x_mm);
        rates.gears.for_speed(wanted).filter(|gear| *gear != self.gear && wanted > 0.0)
    }

    /// Changes to another gear; the order holds on as that one answers it.
    pub(crate) fn shift(&mut self, gear: usize, rates: &MachineRates) -> Shift {
        let ramp_rpm_per_s = self.ramp_rpm_per_s;
        let known = |value: f64| if value.is_finite() { value.max(0.0) } else { 0.0 };
        let (change_s, change_rpm) = (known(rates.gears.change_s), known(rates.gears.change_rpm));
        self.target_rpm = self.actual_rpm.clamp(-change_rpm, change_rpm);
        let slowing_s = self.seconds_to_target();
        self.run(slowing_s);
        let seconds = slowing_s + change_s;
        self.since_order_s = self.since_order_s.map(|since_s| since_s + change_s);
        (self.gear, self.ramp_rpm_per_s) =
            (gear, sound_ramp(rates.gears.get(gear).map_or(0.0, |gear| gear.ramp_rpm_per_s)));
        let (state, speed, rpm_limit) = self.given;
        let since_order_s = self.since_order_s;
        self.command(state, speed, rpm_limit, rates);
        self.since_order_s = since_order_s;
        Shift { rpm: self.actual_rpm, ramp_rpm_per_s, seconds }
    }

    /// The gear that is in.
    pub(crate) const fn gear(&self) -> usize {
        self.gear
    }

    /// It has the one speed that it was ordered to have, and somebody has waited for it.
    pub(crate) fn is_steady(&self) -> bool {
        let Order::Constant(rpm) = self.order else { return false };
        let wanted = self.direction * rpm;
        self.since_order_s.is_none() && self.target_rpm == wanted && self.actual_rpm == wanted
    }

    /// Nothing is asked for until the next order: the spindle is held at an angle.
    pub(crate) fn stop(&mut self) {
        self.order = Order::Constant(0.0);
        self.given = (SpindleState::Stop, SpindleSpeed::Constant(Rpm(0)), None);
        self.aim(0.0);
    }

    /// The speed asked for at the moment, rpm.
    pub(crate) fn target_rpm(&self) -> f64 {
        self.target_rpm.abs()
    }

    /// Asks for a speed (rpm); it is reached as time goes by.
    pub(crate) fn aim(&mut self, rpm: f64) {
        self.target_rpm = self.direction * rpm;
    }

    /// Seconds until the speed asked for is reached.
    pub(crate) fn seconds_to_target(&self) -> f64 {
        let change = (self.target_rpm - self.actual_rpm).abs();
        let seconds = change / self.ramp_rpm_per_s;
        // No ramp is no wait.
        if seconds.is_finite() { seconds } else { 0.0 }
    }

    /// Seconds until the control looks whether the last order is fulfilled.
    pub(crate) fn seconds_to_look(&self, delay_s: f64) -> f64 {
        let seconds = self.since_order_s.map_or(0.0, |since_s| (delay_s - since_s).max(0.0));
        if seconds.is_finite() { seconds } else { 0.0 }
    }

    /// Somebody has waited for the last order.
    pub(crate) fn has_arrived(&mut self) {
        self.since_order_s = None;
    }

    /// Lets `seconds` go by.
    pub(crate) fn run(&mut self, seconds: f64) {
        if let Some(since_s) = &mut self.since_order_s {
            *since_s += seconds;
        }
        if seconds >= self.seconds_to_target() {
            self.actual_rpm = self.target_rpm;
        } else {
            let way = seconds * self.ramp_rpm_per_s;
            self.actual_rpm += if self.target_rpm > self.actual_rpm { way } else { -way };
        }
    }

    /// Lets `seconds` go by in which the distance from the axis changes evenly and the speed asked for with it.
    pub(crate) fn chase(&mut self, law: SurfaceLaw, start_x_mm: f64, end_x_mm: f64, seconds: f64) {
        for step in 1..=CHASE_STEPS {
            let part = f64::from(step) / f64::from(CHASE_STEPS);
            self.aim(law.rpm_at(start_x_mm + (end_x_mm - start_x_mm) * part));
            self.run(seconds / f64::from(CHASE_STEPS));
        }
    }

    /// Real speed, rpm.
    pub(crate) fn actual_rpm(&self) -> f64 {
        self.actual_rpm.abs()
    }

    /// Speed asked for at a distance from the axis (mm), rpm with the sign of its direction.
    pub(crate) fn wanted_rpm(&self, x_mm: f64) -> f64 {
        self.direction * self.order.rpm_at(x_mm)
    }

    /// Change of speed, rpm per second; 0 for at once.
    pub(crate) const fn ramp_rpm_per_s(&self) -> f64 {
        self.ramp_rpm_per_s
    }

    /// The spindle turns at `rpm`, whatever is asked for.
    pub(crate) fn turn_at(&mut self, rpm: f64) {
        self.actual_rpm = self.direction * rpm;
    }

    /// The spindle turns at `rpm`: it has followed a cut.
    pub(crate) fn follow(&mut self, rpm: f64) {
        self.aim(rpm);
        self.actual_rpm = self.target_rpm;
    }
}
