//! S words, speed modes and limits.
//!
//! S counts turns a minute, or with constant surface speed metres (feet) a minute. Three things hold the speed
//! down: the limit of the coordinate-setting code while the speed follows the diameter, and always the largest
//! speed of the spindle and of the gear in use, where their parameters give one. A parameter gives the least speed of
//! constant surface speed as well. The gear is that of the last M41 to M48, as most builders have it, or of the M codes
//! that the machine file gives its gears; gear 1 before. Where the machine chooses the gear by the speed, the gear that
//! reaches most counts.
//!
//! What the assumed machine cannot do is said once; the command keeps the value that the program asks for.
//!
//! Source: constant surface speed, its limit, and the rules of S in both modes.

use turnwright_canon::{Action, SpindleSpeed, SpindleState};
use turnwright_control::{GEARS_MAX, GearSelection, Machine};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Feed, Rpm, SurfaceSpeed};

use crate::machine::Core;
use crate::modal::SpeedMode;
use crate::report::Alarm;

/// No spindle turns faster.
const RPM_FENCE: u32 = 99_999;

/// M codes that change to gears 1 to 8; gears above 4 exist where their parameter gives a speed.
const GEARS: std::ops::RangeInclusive<u32> = 41..=48;

/// Gears that are always there.
const USUAL_GEARS: u8 = 4;

/// What the machine can do: only messages ask for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MachineLimits {
    feed_mm_per_min: f64,
    rpm_max: u32,
    rpm_min_surface: u32,
    /// M code, least and largest speed of each gear.
    gears: [Option<(u32, u32, u32)>; GEARS_MAX],
    chooses_gear: bool,
}

impl MachineLimits {
    pub(crate) fn new(machine: &Machine) -> Self {
        let mut gears = [None; GEARS_MAX];
        for ((place, gear), code) in gears.iter_mut().zip(&machine.gears).zip(machine.gear_codes()) {
            *place = Some((code, gear.rpm_min, gear.rpm_max));
        }
        Self {
            feed_mm_per_min: machine.cutting_max_mm_per_min,
            rpm_max: machine.rpm_max,
            rpm_min_surface: machine.rpm_min_surface,
            gears,
            chooses_gear: machine.gear_selection == GearSelection::Speed && !machine.gears.is_empty(),
        }
    }

    /// The gear that an M code changes to, from 1, where the machine file has gears.
    fn gear_of(&self, code: u32) -> Option<u8> {
        let place = self.gears.iter().flatten().position(|gear| gear.0 == code)?;
        Some(place as u8 + 1)
    }

    /// The least and the largest speed of the spindle in a gear.
    fn rpm_range(&self, gear: u8) -> (u32, u32) {
        let machine_max = if self.rpm_max > 0 { self.rpm_max } else { RPM_FENCE };
        let (min, max) = if self.chooses_gear {
            let all = self.gears.iter().flatten();
            all.fold((RPM_FENCE, 0), |(min, max), gear| (min.min(gear.1), max.max(gear.2)))
        } else {
            self.gears[usize::from(gear - 1)].map_or((0, RPM_FENCE), |(_, min, max)| (min, max))
        };
        (min.min(machine_max), max.min(machine_max))
    }
}

impl Core {
    /// An S word in the speed mode in force.
    pub(crate) fn speed_word(&mut self, word: &Word) -> Result<(), Alarm> {
        let value = self.speed_value(word)?;
        self.modal.in_force.speed = Some(value);
        match self.modal.speed_mode {
            SpeedMode::Constant => self.modal.rpm = Rpm(value),
            SpeedMode::Surface if self.modal.is_inch => {
                self.modal.surface = SurfaceSpeed::from_ft_per_min(value)
            }
            SpeedMode::Surface => self.modal.surface = SurfaceSpeed::from_m_per_min(value),
        }
        Ok(())
    }

    /// The number of an S word: whole, without sign, as long as the control allows.
    pub(crate) fn speed_value(&self, word: &Word) -> Result<u32, Alarm> {
        self.whole(word, self.settings.speed_max)
    }

    /// Whether a P word names the main spindle.
    pub(crate) fn selects_spindle(&self, word: &Word) -> bool {
        let code = self.settings.spindle_selection_code;
        code != 0 && self.whole(word, 99_999).is_ok_and(|value| value == code)
    }

    /// The gear that an M code changes to.
    pub(crate) fn change_gear(&mut self, code: u32) {
        if self.machine_limits.gears[0].is_some() {
            if let Some(gear) = self.machine_limits.gear_of(code).filter(|_| !self.is_capturing()) {
                self.modal.gear = gear;
            }
            return;
        }
        if !GEARS.contains(&code) || self.is_capturing() {
            return;
        }
        let gear = (code - GEARS.start()) as u8 + 1;
        if gear <= USUAL_GEARS || self.settings.gear_rpm_max[usize::from(gear - 1)].is_some() {
            self.modal.gear = gear;
        }
    }

    /// A spindle that turns has another limit in another gear.
    pub(crate) fn obey_in_gear(&mut self) {
        if self.modal.spindle != SpindleState::Stop && !self.is_capturing() {
            self.emit_spindle();
        }
    }

    /// The largest speed by parameter, in the gear in use.
    fn rpm_by_parameter(&self) -> Option<Rpm> {
        if self.machine_limits.chooses_gear {
            let limits = &self.settings.gear_rpm_max[..self.machine_limits.gears.iter().flatten().count()];
            // A gear without a limit of its own reaches whatever the spindle does.
            let most = limits.iter().try_fold(Rpm(0), |most, limit| limit.map(|limit| most.max(limit)));
            return [self.settings.rpm_max, most].into_iter().flatten().min();
        }
        let of_gear = self.settings.gear_rpm_max[usize::from(self.modal.gear - 1)];
        [self.settings.rpm_max, of_gear].into_iter().flatten().min()
    }

    /// The largest speed of the mode in force.
    fn rpm_limit(&self) -> Option<Rpm> {
        match self.modal.speed_mode {
            SpeedMode::Constant => self.modal.rpm_max,
            SpeedMode::Surface => [self.modal.rpm_max, self.rpm_by_parameter()].into_iter().flatten().min(),
        }
    }

    /// The spindle speed at the tool's present place under constant surface speed.
    pub(crate) fn present_rpm(&self) -> Rpm {
        match self.modal.speed_mode {
            SpeedMode::Constant => self.modal.rpm,
            SpeedMode::Surface => {
                let surface_mm_per_min = self.modal.surface.0.to_mm();
                if surface_mm_per_min == 0.0 {
                    return Rpm(0);
                }
                let (gear_min, machine_max) = self.machine_limits.rpm_range(self.modal.gear);
                let least = f64::from(self.machine_limits.rpm_min_surface.max(gear_min));
                let limit = f64::from(self.rpm_limit().map_or(machine_max, |rpm| rpm.0.min(machine_max)));
                let diameter_mm = self.modal.position.x.to_diameter().0.to_mm().abs();
                let free = surface_mm_per_min / (std::f64::consts::PI * diameter_mm.max(1e-6));
                Rpm(free.max(least).min(limit).round() as u32)
            }
        }
    }

    /// How a spindle turns that the lead in force leads; threads per inch have no sign.
    pub(crate) fn way_of_lead(&mut self, block: &Block) -> SpindleState {
        if block.has(b'I') && !block.has(b'F') {
            self.modal.lead_is_left = false;
        }
        if self.modal.lead_is_left { SpindleState::CounterClockwise } else { SpindleState::Clockwise }
    }

    /// Turns the spindle for a thread that leads it; true when it has to be stopped behind the thread.
    pub(crate) fn lead_spindle(&mut self, block: &Block) -> bool {
        let way = self.way_of_lead(block);
        let stands = self.modal.spindle == SpindleState::Stop;
        // A right-handed lead leaves a spindle that turns as it is: the sign may not count on this control.
        let is_led = stands || (self.modal.lead_is_left && self.modal.spindle != way);
        if is_led {
            self.turn_spindle(way);
        }
        is_led
    }

    /// Turns the spindle, or stops it, without a word of the program.
    pub(crate) fn turn_spindle(&mut self, state: SpindleState) {
        self.modal.spindle = state;
        self.emit_spindle();
    }

    /// The state of the spindle as a command.
    pub(crate) fn spindle_action(&self) -> Action {
        let speed = match self.modal.speed_mode {
            SpeedMode::Constant => {
                let limit = self.rpm_by_parameter().unwrap_or(self.modal.rpm);
                SpindleSpeed::Constant(self.modal.rpm.min(limit))
            }
            SpeedMode::Surface => SpindleSpeed::Surface(self.modal.surface),
        };
        Action::Spindle { state: self.modal.spindle, speed, rpm_max: self.rpm_limit() }
    }

    /// What a machinist would look at twice when the spindle gets new orders.
    pub(crate) fn check_speed(&mut self) {
        let turns = self.modal.spindle != SpindleState::Stop;
        match self.modal.speed_mode {
            SpeedMode::Constant => {
                let limit = self.rpm_by_parameter().map_or(u32::MAX, |rpm| rpm.0);
                let (least, most) = self.machine_limits.rpm_range(self.modal.gear);
                let rpm = self.modal.rpm.0;
                if rpm > limit || rpm > most || (rpm > 0 && rpm < least) {
                    self.warn_once("speed-limited");
                }
                if turns && self.modal.rpm.0 == 0 {
                    self.warn_once("spindle-without-speed");
                }
            }
            SpeedMode::Surface if self.modal.surface.0.is_zero() => {
                self.warn_once("surface-speed-without-value");
            }
            SpeedMode::Surface => {}
        }
        self.check_cutting_speed();
    }

    /// A feed above what the machine cuts with is said once.
    pub(crate) fn check_cutting_speed(&mut self) {
        let Some(feed) = self.feed_in_force().filter(|_| !self.modal.feed_is_lead) else { return };
        if self.is_above_cutting_speed(feed) && !self.is_capturing() {
            self.warn_once("feed-limited");
        }
    }

    /// Whether the machine does not cut with a feed, as the spindle turns now.
    #[inline]
    pub(crate) fn is_above_cutting_speed(&self, feed: Feed) -> bool {
        let mm_per_min = match feed {
            Feed::PerMinute(feed) => feed.0.to_mm(),
            Feed::PerRevolution(_) if self.modal.spindle == SpindleState::Stop => return false,
            Feed::PerRevolution(feed) => feed.0.to_mm() * f64::from(self.present_rpm().0),
        };
        mm_per_min > self.machine_limits.feed_mm_per_min
    }

    /// Gives out the state of the spindle when it is a new one.
    pub(crate) fn emit_spindle(&mut self) {
        let action = self.spindle_action();
        if self.last_spindle.as_ref().is_none_or(|last| *last != action) && !self.is_power_on_state(&action) {
            self.last_spindle = Some(action.clone());
            self.emit(action);
        }
    }

    fn is_power_on_state(&self, action: &Action) -> bool {
        let stopped = SpindleSpeed::Constant(Rpm(0));
        self.last_spindle.is_none()
            && *action == Action::Spindle { state: SpindleState::Stop, speed: stopped, rpm_max: None }
    }

    /// Warnings about the spindle before a cutting move.
    #[inline]
    pub(crate) fn check_spindle(&mut self) {
        if self.cuts_beside_standing_spindle() && !self.is_capturing() {
            self.said_spindle_stands = true;
            self.warn_once("spindle-not-started-warning");
        }
    }

    /// Whether a cut would feed by the revolutions of a spindle that stands, and nothing was said of it yet.
    #[inline]
    pub(crate) fn cuts_beside_standing_spindle(&self) -> bool {
        self.modal.spindle == SpindleState::Stop
            && self.modal.feed_mode == crate::modal::FeedMode::PerRevolution
            && !self.said_spindle_stands
    }
}
