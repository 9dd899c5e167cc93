//! Zeros of the coordinate systems: what lies between machine coordinates and those that programs use.
//!
//! `machine = work + zero`, where the zero is the sum of the place of the first work system, the external
//! offset, the work system in force, the workpiece shift, the coordinate preset, the local shift and the tool
//! offset. Every part is stored exactly. What the operator, a setup file, data setting and system variables read
//! and write by number is a [`WorkZero`]; its values are those of the screen: lengths with X as a diameter.
//!
//! Source: coordinate systems of both families.

use turnwright_canon::Action;
use turnwright_control::policy::WorkpieceShift;
use turnwright_control::{Axis, AxisPair, Control, Machine, Setup, SetupFault, nearest};
use turnwright_units::{
    Diameter, Displacement, LeastIncrement, Length, MachineTurret, Position, Radius, WorkTip,
};

use crate::axes::Places;
use crate::machine::Core;
use crate::other_zeros::{OtherZeros, refuse_axes_not_there, take_setup_zeros};

/// The standard work systems.
pub(crate) const STANDARD_SYSTEMS: usize = 6;

/// A stored zero or shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkZero {
    /// The external offset: it moves all work systems.
    External,
    /// A work system as in [`Modal::work`](crate::modal::Modal::work): 0 to 5, then the additional ones.
    System(usize),
    /// The workpiece shift, one more shift of all work systems.
    WorkpieceShift,
}

impl WorkZero {
    /// Additional work system `number`, from 1.
    pub(crate) const fn additional(number: usize) -> Self {
        Self::System(STANDARD_SYSTEMS + number - 1)
    }

    /// Its name in a setup file.
    pub(crate) fn name(self) -> String {
        match self {
            Self::External => "EXT".to_string(),
            Self::WorkpieceShift => "SHIFT".to_string(),
            Self::System(system) if system < STANDARD_SYSTEMS => format!("G{}", 54 + system),
            Self::System(system) => format!("G54.1 P{}", system - STANDARD_SYSTEMS + 1),
        }
    }

    /// The parameter that holds it too.
    pub(crate) fn parameter(self) -> Option<&'static str> {
        match self {
            Self::External => Some("work-zero-external"),
            Self::WorkpieceShift => None,
            Self::System(system) => WORK_PARAMETERS.get(system).copied(),
        }
    }

    /// The zero that a setup file means by `G54`, `G54.1 P3`, `EXT` or `SHIFT`.
    pub(crate) fn named(name: &str) -> Option<Self> {
        let name = name.to_ascii_uppercase().replace(' ', "");
        match name.as_str() {
            "EXT" => return Some(Self::External),
            "SHIFT" => return Some(Self::WorkpieceShift),
            _ => {}
        }
        if let Some(number) = name.strip_prefix("G54.1P") {
            return number.parse().ok().filter(|number| (1..=999).contains(number)).map(Self::additional);
        }
        let code: usize = name.trim_start_matches('G').parse().ok()?;
        let system = code.checked_sub(54)?;
        (system < STANDARD_SYSTEMS).then_some(Self::System(system))
    }
}

/// Parameters of the standard work systems.
pub(crate) const WORK_PARAMETERS: [&str; STANDARD_SYSTEMS] =
    ["work-zero-1", "work-zero-2", "work-zero-3", "work-zero-4", "work-zero-5", "work-zero-6"];

/// Parameters of the reference points.
pub(crate) const REFERENCE_PARAMETERS: [&str; 4] =
    ["reference-position-1", "reference-position-2", "reference-position-3", "reference-position-4"];

/// No way at all.
const NOTHING: Displacement<MachineTurret> = Displacement::new(Radius::ZERO, Length::ZERO);

/// All zeros and shifts.
#[derive(Clone, Debug)]
pub(crate) struct Zeros {
    /// From machine zero to the zero of a work system whose offset is nothing: the machine's affair.
    base: Displacement<MachineTurret>,
    external: Displacement<MachineTurret>,
    external_is_opposite: bool,
    /// The standard systems, then the additional ones that the control has.
    systems: Vec<Displacement<MachineTurret>>,
    workpiece_shift: Displacement<MachineTurret>,
    shift_rule: WorkpieceShift,
    /// Shift by coordinate setting, in every system.
    pub(crate) preset: Displacement<MachineTurret>,
    /// The local zero, in every system.
    pub(crate) local: Displacement<MachineTurret>,
    /// From the tool of one turret to that of the turret on the other side.
    other_turret: Radius,
    /// The reference points 1 to 4.
    pub(crate) reference: [Position<MachineTurret>; 4],
    /// The same for the axes beyond X and Z.
    pub(crate) others: OtherZeros,
}

fn displacement(pair: AxisPair) -> Result<Displacement<MachineTurret>, SetupFault> {
    let length = |mm: f64| {
        Length::from_mm_rounded(mm, LeastIncrement::METRIC_C)
            .filter(|length| length.abs() < Length::from_mm(1_000_000))
    };
    match (length(pair.x), length(pair.z)) {
        (Some(x), Some(z)) => Ok(Displacement::new(Diameter(x).to_radius(), z)),
        _ => Err(SetupFault { message: format!("X{} Z{} is out of range", pair.x, pair.z), line: 0 }),
    }
}

fn length(mm: f64) -> Length {
    Length::from_mm_rounded(mm, LeastIncrement::METRIC_C).unwrap_or(Length::ZERO)
}

/// A parameter with a value for each axis.
fn pair(control: &Control, name: &str) -> AxisPair {
    let value = |axis| control.parameters.axis_value(name, axis);
    AxisPair { x: value(Axis::X), z: value(Axis::Z) }
}

impl Zeros {
    /// The zeros that parameters and setup give.
    ///
    /// # Errors
    /// Values out of range, and names of systems that the control does not have.
    pub(crate) fn new(control: &Control, setup: &Setup, machine: &Machine) -> Result<Self, SetupFault> {
        let parameter = |name| displacement(pair(control, name));
        let mut systems = Vec::new();
        for name in WORK_PARAMETERS {
            systems.push(parameter(name)?);
        }
        systems.resize(STANDARD_SYSTEMS + usize::from(control.limits.additional_work_systems), NOTHING);
        let mut reference = [Position::new(Radius::ZERO, Length::ZERO); 4];
        for (point, name) in reference.iter_mut().zip(REFERENCE_PARAMETERS) {
            let place = parameter(name)?;
            *point = Position::new(place.x, place.z);
        }
        // The machine file gives the place of the first reference point in work coordinates.
        let seen = displacement(machine.reference)?;
        refuse_axes_not_there(control, &machine.axes)?;
        let mut others = OtherZeros::new(control, systems.len(), &machine.axes);
        take_setup_zeros(&mut others, setup, &machine.axes)?;
        let mut zeros = Self {
            others,
            base: Displacement::new(reference[0].x - seen.x, reference[0].z - seen.z),
            external: parameter("work-zero-external")?,
            external_is_opposite: control.parameters.bit("external-offset-opposite"),
            systems,
            workpiece_shift: NOTHING,
            shift_rule: control.policies.workpiece_shift,
            preset: NOTHING,
            local: NOTHING,
            other_turret: Radius(length(control.parameters.value("double-turret-distance"))),
            reference,
        };
        for (name, pair) in &setup.work {
            let value = displacement(AxisPair { x: pair.x, z: pair.z })?;
            match WorkZero::named(name).and_then(|zero| zeros.slot(zero)) {
                Some(slot) if *slot == NOTHING || *slot == value => *slot = value,
                Some(_) => {
                    let message = format!("{name} has one value in [work] and another one by parameter");
                    return Err(SetupFault { message, line: 0 });
                }
                None => return Err(zeros.unknown_system(name)),
            }
        }
        Ok(zeros)
    }

    /// Takes a parameter over that a program has written. The place of the tool is not told: call it inside
    /// [`Core::with_new_zero`].
    pub(crate) fn follow_parameter(&mut self, control: &Control, name: &str, axis: Option<Axis>) {
        self.external_is_opposite = control.parameters.bit("external-offset-opposite");
        let Some(axis) = axis else { return };
        let value = Length::from_nm((control.parameters.axis_value(name, axis) * 1e6).round() as i64);
        if let Some(system) = WORK_PARAMETERS.iter().position(|known| *known == name) {
            self.set(WorkZero::System(system), axis, value);
        } else if name == "work-zero-external" {
            self.set(WorkZero::External, axis, value);
        } else if let Some(point) = REFERENCE_PARAMETERS.iter().position(|known| *known == name) {
            let place = &mut self.reference[point];
            match axis {
                Axis::X => place.x = Diameter(value).to_radius(),
                Axis::Z => place.z = value,
                Axis::C | Axis::Y | Axis::B => self.others.reference[point].put(axis, value),
            }
        }
    }

    fn unknown_system(&self, name: &str) -> SetupFault {
        let additional = self.systems.len() - STANDARD_SYSTEMS;
        let names = ["EXT", "SHIFT", "G54", "G55", "G56", "G57", "G58", "G59"];
        let near = nearest(name, names).map_or(String::new(), |near| format!("; did you mean {near}?"));
        let more = if additional > 0 { format!(", G54.1 P1 to G54.1 P{additional}") } else { String::new() };
        let message = format!(
            "[work] has no coordinate system {name}; there are G54 to G59{more}, EXT and SHIFT{near}"
        );
        SetupFault { message, line: 0 }
    }

    fn slot(&mut self, zero: WorkZero) -> Option<&mut Displacement<MachineTurret>> {
        match zero {
            WorkZero::External => Some(&mut self.external),
            WorkZero::System(system) => self.systems.get_mut(system),
            WorkZero::WorkpieceShift => Some(&mut self.workpiece_shift),
        }
    }

    /// How many additional work systems the control has.
    pub(crate) fn additional_systems(&self) -> usize {
        self.systems.len() - STANDARD_SYSTEMS
    }

    /// A stored value, X as a diameter; `None` when the control has no such system.
    pub(crate) fn get(&self, zero: WorkZero, axis: Axis) -> Option<Length> {
        let stored = match zero {
            WorkZero::External => &self.external,
            WorkZero::System(system) => self.systems.get(system)?,
            WorkZero::WorkpieceShift => &self.workpiece_shift,
        };
        Some(match axis {
            Axis::X => stored.x.to_diameter().0,
            Axis::Z => stored.z,
            Axis::C | Axis::Y | Axis::B => return self.others.get(zero, axis),
        })
    }

    /// Both values, X as a diameter; nothing for a system that the control does not have.
    pub(crate) fn pair(&self, zero: WorkZero) -> [Length; 2] {
        Axis::TURNING.map(|axis| self.get(zero, axis).unwrap_or(Length::ZERO))
    }

    /// Stores a value, X as a diameter; `None` when the control has no such system. The place of the tool is not
    /// told: call it inside [`Core::with_new_zero`], or use [`Core::set_work_zero`].
    pub(crate) fn set(&mut self, zero: WorkZero, axis: Axis, value: Length) -> Option<()> {
        let slot = self.slot(zero)?;
        *slot = match axis {
            Axis::X => Displacement::new(Diameter(value).to_radius(), slot.z),
            Axis::Z => Displacement::new(slot.x, value),
            Axis::C | Axis::Y | Axis::B => {
                self.others.row(zero)?.put(axis, value);
                return Some(());
            }
        };
        Some(())
    }

    /// Takes the local shift back.
    pub(crate) fn clear_local(&mut self) {
        self.local = NOTHING;
        self.others.local = Places::default();
    }

    /// Whether a local shift is in force.
    pub(crate) fn has_local(&self) -> bool {
        self.local != NOTHING || self.others.local != Places::default()
    }

    /// From machine zero to the zero of a work system with every shift but the tool's.
    pub(crate) fn of_work(&self, system: usize) -> Displacement<MachineTurret> {
        let plus = |a: Displacement<MachineTurret>, b: Displacement<MachineTurret>| {
            Displacement::new(a.x + b.x, a.z + b.z)
        };
        let minus = |a: Displacement<MachineTurret>, b: Displacement<MachineTurret>| {
            Displacement::new(a.x - b.x, a.z - b.z)
        };
        let mut zero = plus(self.base, self.systems.get(system).copied().unwrap_or(NOTHING));
        zero = if self.external_is_opposite { minus(zero, self.external) } else { plus(zero, self.external) };
        zero = match self.shift_rule {
            WorkpieceShift::MovesZero => plus(zero, self.workpiece_shift),
            WorkpieceShift::AddsToCoordinates => minus(zero, self.workpiece_shift),
        };
        plus(plus(zero, self.preset), self.local)
    }
}

impl Zeros {
    /// The same for the axes beyond X and Z.
    pub(crate) fn of_others(&self, system: usize) -> Places {
        let shift_moves_zero = match self.shift_rule {
            WorkpieceShift::MovesZero => true,
            WorkpieceShift::AddsToCoordinates => false,
        };
        self.others.of_work(system, self.external_is_opposite, shift_moves_zero)
    }
}

impl Core {
    /// From machine coordinates to the zero of the work system with every shift in force. With the mirror on, the
    /// tool is the one of the turret on the other side.
    pub(crate) fn zero(&self) -> Displacement<MachineTurret> {
        let work = self.zeros.of_work(self.modal.work);
        let shift = self.modal.offset_in_force.shift;
        let other_turret = if self.transform.is_mirrored { self.zeros.other_turret } else { Radius::ZERO };
        Displacement::new(work.x + shift.x + other_turret, work.z + shift.z)
    }

    /// From machine coordinates to those of the tip: the zero, and the way that the offset has moved the tool.
    pub(crate) fn tip_zero(&self) -> Displacement<MachineTurret> {
        let (zero, movement) = (self.zero(), self.modal.offset_in_force.movement);
        Displacement::new(zero.x + movement.x, zero.z + movement.z)
    }

    /// A place of the tip as the program has it, in machine coordinates.
    pub(crate) fn to_machine(&self, place: Position<WorkTip>) -> Position<MachineTurret> {
        let (place, zero) = (self.in_work(place), self.tip_zero());
        Position::new(place.x + zero.x, place.z + zero.z)
    }

    /// The place of the tip as the program has it while the turret stands at a machine place.
    pub(crate) fn to_work(&self, place: Position<MachineTurret>) -> Position<WorkTip> {
        let zero = self.tip_zero();
        self.transform.to_program(Position::new(place.x - zero.x, place.z - zero.z))
    }

    /// Where the tool is in machine coordinates, at the end of the block in work.
    pub(crate) fn machine_position(&self) -> Position<MachineTurret> {
        let place = self.modal.position;
        let owed = self.untaken.unwrap_or(Displacement::new(Radius::ZERO, Length::ZERO));
        self.to_machine(Position::new(place.x - owed.x, place.z - owed.z))
    }

    /// A stored zero, X as a diameter; `None` when the control has no such system.
    pub(crate) fn work_zero(&self, zero: WorkZero, axis: Axis) -> Option<Length> {
        self.zeros.get(zero, axis)
    }

    /// Stores a zero, X as a diameter; `None` when the control has no such system. The tool stays where it is;
    /// when the zero is in force its coordinates change.
    pub(crate) fn set_work_zero(&mut self, zero: WorkZero, axis: Axis, value: Length) -> Option<()> {
        let mut stored = None;
        self.with_new_zero(|core| stored = core.zeros.set(zero, axis, value));
        stored
    }

    /// The tool stands at the reference point before the program starts.
    pub(crate) fn start_at_reference(&mut self) {
        self.modal.position = self.to_work(self.zeros.reference[0]);
        self.tip = self.modal.position;
        self.axes.preset = self.zeros.of_others(self.modal.work);
        self.axes.at = self.zeros.others.reference[0].minus(self.axes.preset);
    }

    /// Changes a shift or the offset; the tool stays where it is and has new coordinates. A new movement of the
    /// offset is owed.
    pub(crate) fn with_new_zero(&mut self, change: impl FnOnce(&mut Self)) {
        let (before, tip_before) = (self.zero(), self.tip_zero());
        let (place, tip) = (self.modal.position, self.tip);
        let (place_in_work, tip_in_work) = (self.in_work(place), self.in_work(tip));
        let offset_before = self.modal.offset_in_force;
        let others_before = self.zeros.of_others(self.modal.work);
        change(self);
        let offset = self.modal.offset_in_force;
        let (shift_y, movement_y) =
            (offset.shift_y - offset_before.shift_y, offset.movement_y - offset_before.movement_y);
        self.move_other_zeros(
            self.zeros.of_others(self.modal.work).minus(others_before),
            shift_y,
            movement_y,
        );
        let (after, tip_after) = (self.zero(), self.tip_zero());
        let moved = |place: Position<WorkTip>, before: Displacement<_>, after: Displacement<_>| {
            Position::new(place.x + before.x - after.x, place.z + before.z - after.z)
        };
        let tip_in_new_work = moved(tip_in_work, tip_before, tip_after);
        self.modal.position = self.transform.to_program(moved(place_in_work, before, after));
        self.tip = self.transform.to_program(tip_in_new_work);
        // What the program's place moved by and the tip's did not.
        let (moved, tip_moved) = (self.modal.position - place, self.tip - tip);
        if moved != tip_moved {
            self.owe_movement(moved.x - tip_moved.x, moved.z - tip_moved.z);
        }
        if tip_in_work == tip_in_new_work {
            return;
        }
        if self.compensation.is_some() {
            self.relocate_compensated(self.tip - tip);
        } else {
            self.emit(Action::Relocate { to: tip_in_new_work, others: None });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use turnwright_control::{DEFAULT_CONTROL, control_names};

    fn made(control: &Control, setup: &Setup) -> Result<Zeros, SetupFault> {
        Zeros::new(control, setup, &setup.machine()?)
    }

    /// The zeros of the usual control, which has additional systems.
    fn zeros(setup: &str) -> Result<Zeros, SetupFault> {
        let control = Control::load(DEFAULT_CONTROL).expect("a control");
        made(&control, &Setup::parse(setup).expect("a setup"))
    }

    #[test]
    fn every_zero_of_a_setup_is_read_and_written_exactly() {
        let setup =
            "[work]\nEXT = { z = 0.1 }\nG55 = { x = 0.001 }\n\"G54.1 P48\" = { z = -7 }\nSHIFT = { x = 3 }\n";
        let mut zeros = zeros(setup).expect("a setup");
        let mm = |mm: f64| Some(Length::from_nm((mm * 1e6) as i64));
        assert_eq!(zeros.get(WorkZero::External, Axis::Z), mm(0.1));
        assert_eq!(zeros.get(WorkZero::System(1), Axis::X), mm(0.001));
        assert_eq!(zeros.get(WorkZero::additional(48), Axis::Z), mm(-7.0));
        assert_eq!(zeros.get(WorkZero::WorkpieceShift, Axis::X), mm(3.0));
        assert_eq!(zeros.set(WorkZero::System(5), Axis::X, Length::from_nm(254)), Some(()));
        assert_eq!(zeros.get(WorkZero::System(5), Axis::X), Some(Length::from_nm(254)));
        assert_eq!(zeros.get(WorkZero::additional(49), Axis::Z), None);
        assert_eq!(zeros.set(WorkZero::additional(49), Axis::Z, Length::ZERO), None);
    }

    #[test]
    fn systems_that_the_control_does_not_have_are_refused_by_name() {
        let mut controls = control_names().into_iter().map(|name| Control::load(name).expect("a control"));
        let plain = controls.find(|control| control.limits.additional_work_systems == 0).expect("a control");
        let setup = Setup::parse("[work]\n\"G54.1 P1\" = { z = -7 }\n").expect("a setup");
        let fault = made(&plain, &setup).expect_err("no such system");
        assert!(fault.message.contains("G54 to G59, EXT"), "{}", fault.message);
        let fault = zeros("[work]\nG60 = { z = -7 }\n").expect_err("no such system");
        assert!(fault.message.contains("G54.1 P48"), "{}", fault.message);
        let fault = zeros("[work]\nEXTT = { z = -7 }\n").expect_err("no such system");
        assert!(fault.message.contains("did you mean EXT?"), "{}", fault.message);
    }

    #[test]
    fn two_different_values_for_one_system_are_refused() {
        let mut control = Control::load(DEFAULT_CONTROL).expect("a control");
        control.parameters.set("1221.Z", "-5").expect("a parameter");
        let setup = |z| Setup::parse(&format!("[work]\nG54 = {{ z = {z} }}\n")).expect("a setup");
        assert!(made(&control, &setup(-5)).is_ok());
        assert!(made(&control, &setup(-6)).is_err());
    }
}
