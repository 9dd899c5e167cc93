//! `reference-return`, `second-reference-return`, `reference-leave`, `reference-check` — ways to and from the
//! reference points (G28, G30, G29, G27).
//!
//! `G28 X(U)_ Z(W)_`: the named axes move at rapid to the intermediate point, then on to the first reference
//! point; an axis that is not named stays. `G28 U0 W0` goes straight there. X and Z are the intermediate point,
//! not the reference point. Without an axis word nothing moves. `G30 P_` does the same with reference point 2, 3
//! or 4; without P it is the second. Both legs are non-linear whatever the parameter for positioning says.
//!
//! `G29 X(U)_ Z(W)_` goes at rapid through the intermediate point that the last G28 or G30 passed, then to the
//! point; its increments count from the intermediate point. `G27 X(U)_ Z(W)_` goes to the point at rapid and stops
//! with an alarm when a named axis is not at its first reference point there.
//!
//! Axes beyond X and Z that the block names go with them.
//!
//! The reference points are machine coordinates (1240 to 1243), so no shift and no offset changes where they lie.
//! By parameter the return cancels the local shift (1201#2) and the preset (1201#3) of the axis, and the 980
//! series lets go of the tool offset. Before the first return the others refuse to move; the setup says whether
//! the operator has made it (`[start] homed`).
//!
//! Source: automatic return to the reference points, both families.

use turnwright_canon::{Action, OtherAxes, RapidPath, Shape};
use turnwright_control::policy::ReferenceReturnRate;
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Displacement, Position, WorkTip};

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static REFERENCE_RETURN: Function =
    Function::one_shot("reference-return", reference_return).with_other_axes();
pub(super) static SECOND_REFERENCE_RETURN: Function =
    Function::one_shot("second-reference-return", second_reference_return)
        .with_letters(b"P")
        .with_other_axes();
pub(super) static REFERENCE_LEAVE: Function =
    Function::one_shot("reference-leave", reference_leave).with_other_axes();
pub(super) static REFERENCE_CHECK: Function =
    Function::one_shot("reference-check", reference_check).with_other_axes();

const CROSS: u32 = letters(b"XU");
const ALONG: u32 = letters(b"ZW");

/// What the control remembers of returns to the reference points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Homing {
    /// The control knows where the axes are.
    pub(crate) is_made: bool,
    /// The intermediate point of the last return.
    pub(crate) by_way_of: Option<Position<WorkTip>>,
    /// The same of the axes beyond X and Z.
    pub(crate) others_by_way_of: OtherAxes,
}

fn reference_return(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_in_hole_cycle(call.word)?;
    if !core.homing.is_made && call.block.present() & (super::AXES | core.axes.letters) != 0 {
        if core.settings.first_reference_by_hand {
            return Err(core.alarm_at("reference-return-not-made", call.word));
        }
        core.homing.is_made = true;
        core.look_at_moves();
    }
    core.return_to(call.block, 0)
}

fn second_reference_return(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_in_hole_cycle(call.word)?;
    let number = match call.block.word(b'P') {
        Some(word) => match core.whole(word, 99_999_999)? {
            number @ 2..=4 => number as usize,
            _ => return Err(core.alarm("reference-number-illegal", word)),
        },
        None => 2,
    };
    core.refuse_without_reference(call.word)?;
    core.return_to(call.block, number - 1)
}

fn reference_leave(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_in_hole_cycle(call.word)?;
    let present = call.block.present();
    if present & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    let Some(by_way_of) = core.homing.by_way_of else {
        return Err(core.alarm_at("intermediate-point-missing", call.word));
    };
    let from = core.modal.position;
    let by_way_of = named(present, by_way_of, from);
    core.modal.position = by_way_of;
    let to = core.target(call.block)?;
    let ends = core.other_ends(call.block)?;
    let passed = core.homing.others_by_way_of;
    let others_by_way_of = OtherAxes {
        c: ends.c.and(passed.c),
        y: ends.y.and(passed.y),
        b: ends.b.and(passed.b),
        ..OtherAxes::default()
    };
    core.without_vector(|core| {
        core.rapid_each_axis_with(by_way_of, others_by_way_of)?;
        core.rapid_each_axis_with(to, ends)
    })
}

fn reference_check(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_in_hole_cycle(call.word)?;
    core.refuse_without_reference(call.word)?;
    let present = call.block.present();
    if present & (super::AXES | core.axes.letters) == 0 {
        return Ok(());
    }
    let to = core.target(call.block)?;
    let ends = core.other_ends(call.block)?;
    core.without_vector(|core| core.rapid_each_axis_with(to, ends))?;
    let (there, home) = (core.machine_position(), core.zeros.reference[0]);
    for (axis, is_there) in [(CROSS, there.x == home.x), (ALONG, there.z == home.z)] {
        if present & axis != 0 && !is_there {
            let word = call.block.words.iter().find(|word| axis & Block::bit(word.address) != 0);
            return Err(core.alarm_at("not-at-reference", word));
        }
    }
    if let Some(word) = core.other_axis_not_at_home(call.block) {
        return Err(core.alarm("not-at-reference", word));
    }
    core.leave_out_movement(present & letters(b"XU") != 0, present & letters(b"ZW") != 0);
    Ok(())
}

/// One place on the axes that a block names, another one on the rest.
fn named(present: u32, there: Position<WorkTip>, else_here: Position<WorkTip>) -> Position<WorkTip> {
    Position::new(
        if present & CROSS != 0 { there.x } else { else_here.x },
        if present & ALONG != 0 { there.z } else { else_here.z },
    )
}

impl Core {
    /// Moves the named axes to a reference point, 0 to 3, by way of the point of the block.
    fn return_to(&mut self, block: &Block, number: usize) -> Result<(), Alarm> {
        let present = block.present();
        if present & (super::AXES | self.axes.letters) == 0 {
            return Ok(());
        }
        let by_way_of = self.target(block)?;
        if !self.already_said("home-is-assumed", 0) {
            let place = self.block_place();
            self.say(Diagnostic::new(Severity::Note, "home-is-assumed").at(place));
        }
        self.homing.by_way_of =
            Some(self.homing.by_way_of.map_or(by_way_of, |before| named(present, by_way_of, before)));
        let home = self.to_work(self.zeros.reference[number]);
        let home = named(present, home, by_way_of);
        self.warn_of_compensation(None);
        let has_rate =
            number > 0 || self.control.policies.reference_return_rate == ReferenceReturnRate::AllPoints;
        let path = if has_rate { RapidPath::Home } else { RapidPath::EachAxis };
        // Both legs are non-linear whatever the parameter for positioning says.
        let others_by_way_of = self.other_ends(block)?;
        let others_home = self.other_reference(number, &others_by_way_of);
        let before = self.homing.others_by_way_of;
        self.homing.others_by_way_of = OtherAxes {
            c: others_by_way_of.c.or(before.c),
            y: others_by_way_of.y.or(before.y),
            b: others_by_way_of.b.or(before.b),
            ..OtherAxes::default()
        };
        self.without_vector(|core| {
            core.rapid_each_axis_with(by_way_of, others_by_way_of)?;
            core.rapid_along(path, home, others_home)
        })?;
        self.leave_out_movement(present & CROSS != 0, present & ALONG != 0);
        if number == 0 {
            self.clear_shifts_at_home(block);
        }
        if self.settings.reference_return_cancels_offset {
            (self.modal.offset, self.modal.geometry) = (0, 0);
            let none = self.offset_called();
            self.with_new_zero(|core| core.modal.offset_in_force = none);
        }
        Ok(())
    }

    /// Shifts that the return to the first reference point cancels by parameter, on the named axes.
    fn clear_shifts_at_home(&mut self, block: &Block) {
        let (local, preset) =
            (self.settings.reference_return_clears_local, self.settings.reference_return_clears_preset);
        if !(local || preset) {
            return;
        }
        let present = block.present();
        let others = self.others_named(block).collect::<Vec<_>>();
        let without = |shift: &mut Displacement<_>| {
            if present & CROSS != 0 {
                shift.x = turnwright_units::Radius::ZERO;
            }
            if present & ALONG != 0 {
                shift.z = turnwright_units::Length::ZERO;
            }
        };
        self.with_new_zero(|core| {
            if local {
                without(&mut core.zeros.local);
                core.zeros.others.local.clear(others.iter().copied());
            }
            if preset {
                without(&mut core.zeros.preset);
                core.zeros.others.preset.clear(others.iter().copied());
            }
        });
    }

    /// A rapid move on which each axis goes at its own rate.
    pub(super) fn rapid_each_axis(&mut self, to: Position<WorkTip>) -> Result<(), Alarm> {
        self.rapid_each_axis_with(to, OtherAxes::default())
    }

    /// The same with axes beyond X and Z.
    pub(super) fn rapid_each_axis_with(
        &mut self,
        to: Position<WorkTip>,
        ends: OtherAxes,
    ) -> Result<(), Alarm> {
        self.rapid_along(RapidPath::EachAxis, to, ends)
    }

    fn rapid_along(&mut self, path: RapidPath, to: Position<WorkTip>, ends: OtherAxes) -> Result<(), Alarm> {
        self.modal.position = to;
        let others = self.take_along(to, &Shape::Line, ends);
        self.emit_move(to, Action::Rapid { to, path, others })
    }

    /// Moves in machine coordinates need the reference.
    pub(super) fn refuse_without_reference(&self, word: Option<&Word>) -> Result<(), Alarm> {
        if self.homing.is_made { Ok(()) } else { Err(self.alarm_at("reference-not-made", word)) }
    }

    /// Ways to the reference point break a hole cycle off.
    fn refuse_in_hole_cycle(&self, word: Option<&Word>) -> Result<(), Alarm> {
        if self.is_in_hole_cycle() {
            Err(self.alarm_at("reference-code-in-hole-cycle", word))
        } else {
            Ok(())
        }
    }

    /// A hole cycle is in force: its group holds another code than at power-on.
    pub(super) fn is_in_hole_cycle(&self) -> bool {
        const HOLE_CYCLES: usize = 10;
        self.modal.in_force.codes[HOLE_CYCLES] != self.dispatch.codes_at_power_on[HOLE_CYCLES]
    }
}
