//! What is in force: one code of each modal group, and the last value at each modal address.
//!
//! Programs read both as system variables, people on the modal display. A code is kept as the program wrote it,
//! times ten (`G99` is 990, `G50.2` is 502), because the display shows numbers and no names; what a code does
//! to the machine stands in `modal.rs`.
//!
//! Source: modal groups and the state at power-on, both families.

use turnwright_control::{CodeSystem, Functions, Parameters};
use turnwright_syntax::{Value, Word};

use crate::functions::{Dispatch, FunctionId};
use crate::machine::{Core, Interpreter};

/// Modal groups by FANUC's numbers, 0 to 22.
pub const GROUPS: usize = 23;

/// Codes and values in force.
#[derive(Clone, Debug, Default)]
pub(crate) struct InForce {
    /// By group; `None` for a group that the control does not have, and for one-shot codes.
    pub(crate) codes: [Option<u16>; GROUPS],
    pub(crate) sequence: Option<u32>,
    pub(crate) auxiliary: Option<u32>,
    pub(crate) speed: Option<u32>,
    pub(crate) tool: Option<u32>,
    /// Values at B, D and H.
    rare: [Option<f64>; 3],
}

/// Group of motion codes.
pub(crate) const MOTION: usize = 1;
/// Group of hole cycles: every motion code ends them.
const HOLE_CYCLES: usize = 10;

/// The codes in force after power-on, by name; a group whose code the control does not have stays empty.
fn names_at_power_on(parameters: &Parameters, system: CodeSystem) -> [Option<&'static str>; 16] {
    let choose = |bit, set, clear| Some(if parameters.bit(bit) { set } else { clear });
    let has_absolute_code = system != CodeSystem::A;
    [
        choose("linear-at-power-on", "linear", "rapid"),
        Some("constant-spindle-speed"),
        choose("incremental-at-power-on", "incremental", "absolute").filter(|_| has_absolute_code),
        Some("double-turret-mirror-off"),
        choose("feed-per-minute-at-power-on", "feed-per-minute", "feed-per-revolution"),
        choose("inch-input", "inch", "metric"),
        Some("nose-compensation-off"),
        Some("spindle-fluctuation-off"),
        choose("stroke-check-two-off-at-power-on", "stroke-check-off", "stroke-check-on"),
        Some("hole-cycle-off"),
        Some("return-to-start-level"),
        Some("modal-macro-cancel"),
        Some("work-coordinates-1"),
        Some("cutting-mode"),
        match (parameters.bit("turning-plane-at-power-on"), parameters.bit("plane-yz-at-power-on")) {
            (_, true) => Some("plane-yz"),
            (true, false) => Some("plane-zx"),
            (false, false) => Some("plane-xy"),
        },
        Some("polygon-turning-off"),
    ]
}

/// Groups 17 and 21 have their cancelling codes at power-on whatever the parameters say.
const ALSO_AT_POWER_ON: [&str; 2] = ["rotation-off", "polar-interpolation-off"];

/// The codes in force after power-on, by group.
pub(crate) fn codes_at_power_on(
    parameters: &Parameters,
    system: CodeSystem,
    code_table: &str,
) -> [Option<u16>; GROUPS] {
    let mut codes = [None; GROUPS];
    let functions = Functions;
    let names = names_at_power_on(parameters, system).into_iter().flatten().chain(ALSO_AT_POWER_ON);
    for entry in names.filter_map(|name| functions.get(name)).filter(|entry| entry.is_on(code_table)) {
        if let Some(slot) = codes.get_mut(usize::from(entry.group().0)) {
            *slot = entry.code_numbers(system).first().copied();
        }
    }
    codes
}

impl InForce {
    /// Codes in force, and no value at any address.
    pub(crate) fn new(codes: [Option<u16>; GROUPS]) -> Self {
        Self { codes, ..Self::default() }
    }

    /// A code of a modal group is in force from here on.
    #[inline]
    pub(crate) fn code(&mut self, id: FunctionId, code: u16, dispatch: &Dispatch) {
        let group = usize::from(dispatch.group(id));
        if group != 0 {
            self.codes[group] = Some(code);
        }
        if group == MOTION && self.codes[HOLE_CYCLES].is_some() {
            self.codes[HOLE_CYCLES] = dispatch.codes_at_power_on[HOLE_CYCLES];
        }
    }

    /// Remembers the value of a B, D or H word.
    #[cold]
    pub(crate) fn rare_word(&mut self, word: &Word) {
        if let (Some(slot), Value::Number(number)) = (rare_slot(word.address), word.value) {
            self.rare[slot] = Some(number.digits as f64 / 10f64.powi(i32::from(number.scale)));
        }
    }
}

const fn rare_slot(letter: u8) -> Option<usize> {
    match letter {
        b'B' => Some(0),
        b'D' => Some(1),
        b'H' => Some(2),
        _ => None,
    }
}

impl Core {
    /// The code in force in each modal group, times ten, by the group's number.
    pub(crate) fn modal_codes(&self) -> [Option<u16>; GROUPS] {
        self.modal.in_force.codes
    }

    /// The value in force at one of the addresses B D F H M N O S T, in the units that the program writes.
    pub(crate) fn modal_word(&self, letter: u8) -> Option<f64> {
        let in_force = &self.modal.in_force;
        match letter {
            b'F' => {
                let unit_mm = if self.modal.is_inch { 25.4 } else { 1.0 };
                self.modal.feed.map(|feed| feed.to_mm() / unit_mm)
            }
            b'M' => in_force.auxiliary.map(f64::from),
            b'N' => in_force.sequence.map(f64::from),
            b'O' => self.program.map(f64::from),
            b'S' => in_force.speed.map(f64::from),
            b'T' => in_force.tool.map(f64::from),
            _ => in_force.rare[rare_slot(letter)?],
        }
    }
}

impl Interpreter {
    /// The code in force in each modal group, times ten, by the group's number: `G99` is 990 at place 5.
    pub fn modal_codes(&self) -> [Option<u16>; GROUPS] {
        self.core.modal_codes()
    }

    /// The value in force at one of the addresses B D F H M N O S T, in the units that the program writes;
    /// `None` when none was programmed.
    pub fn modal_word(&self, letter: char) -> Option<f64> {
        self.core.modal_word(u8::try_from(letter).ok()?.to_ascii_uppercase())
    }
}
