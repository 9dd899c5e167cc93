//! `nose-compensation-left`, `nose-compensation-right`, `nose-compensation-off` — nose-radius compensation (G41, G42,
//! G40).
//!
//! `G41` keeps the nose left of the path, `G42` right, seen in the direction of travel with Z to the right and X up.
//! The radius (geometry and wear together) and the tip number are those of the offset in force. The next straight
//! move leads onto the path, how is chosen by parameter (5003); an arc is refused there, and so is a corner word.
//! The two codes may follow each other; offset number 0 follows the path as it is written.
//!
//! `G40`: the next straight move leads off the path, to the programmed point. `G40 X_ Z_ I_ K_` names the direction of
//! a wall, I as a radius: the path is left where it meets the wall. Program end and reset cancel without a move.
//!
//! Warnings: the nose has no radius or no tip number; the program ends, calls another tool or goes to a reference point
//! with compensation on; so many blocks without a move that the next one is not seen.
//!
//! In the figure of a roughing cycle the codes act where a policy says so, else only when it is finished.
//!
//! A radius below zero exchanges the sides, or is refused, by policy. Compensation works in the turning plane.
//! What happens at corners, and the interference check, is in `compensation/`.
//!
//! Source: tool nose radius compensation of both families.

use turnwright_control::policy::{NegativeNoseRadius, RoughingCompensation};
use turnwright_geometry::{Side, Vector};
use turnwright_syntax::Word;

use super::Function;
use crate::axes::Plane;
use crate::block::Call;
use crate::compensation::COMPENSATION_GROUP;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static LEFT: Function =
    Function::mode("nose-compensation-left", |core, call| start(core, call, Side::Left)).allowed_in_figure();
pub(super) static RIGHT: Function =
    Function::mode("nose-compensation-right", |core, call| start(core, call, Side::Right))
        .allowed_in_figure();
pub(super) static OFF: Function =
    Function::mode("nose-compensation-off", end).allowed_in_figure().allowed_in_rotation();

fn start(core: &mut Core, call: &mut Call<'_>, side: Side) -> Result<(), Alarm> {
    if core.settings.compensation.refused_in_mdi {
        core.refuse_in_mdi("compensation-in-mdi", call.word)?;
    }
    if core.is_capturing() && !core.acts_in_roughed_figure(call)? {
        return Ok(());
    }
    if let Some(word) = call.word
        && !core.acts_in_finished_figure()
    {
        core.warn("compensation-not-in-first-block", word);
        return Ok(());
    }
    if let Some(word) = call.word
        && (core.axes.is_virtual() || core.axes.plane != Plane::Zx)
    {
        if core.nose().radius.is_zero() {
            // A nose without a radius is nowhere else than its path.
            core.warn("compensation-without-radius", word);
            return Ok(());
        }
        return Err(core.not_supported("nose-compensation-left", word));
    }
    if !core.settings.compensation.is_available {
        if let Some(word) = call.word {
            core.warn("compensation-switched-off", word);
        }
        return Ok(());
    }
    if core.nose().radius.signum() < 0
        && core.control.policies.negative_nose_radius == NegativeNoseRadius::Alarm
    {
        return Err(core.alarm_at("nose-radius-negative", call.word));
    }
    if core.corner.is_some() && !core.compensates_on(side) {
        return Err(core.alarm_at("corner-in-compensation-start", call.word));
    }
    core.compensate_on(side);
    Ok(())
}

fn end(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if core.is_capturing() && !core.acts_in_roughed_figure(call)? {
        return Ok(());
    }
    if core.compensation.is_none() {
        return Ok(());
    }
    if core.corner.is_some() {
        return Err(core.alarm_at("corner-in-compensation-start", call.word));
    }
    let x = core.optional_radius(call.block, b'I', Role::ArcOffset)?;
    let z = call.block.word(b'K').map(|word| core.length(word)).transpose()?;
    let wall = Vector { x: x.map_or(0.0, |x| x.to_mm()), z: z.map_or(0.0, |z| z.to_mm()) };
    core.compensate_off((wall.length() > 0.0).then_some(wall));
    Ok(())
}

impl Core {
    /// A tool with a nose radius where compensation is on outside the turning plane: it would have to act there.
    pub(crate) fn refuse_nose_outside_plane(&self, word: &Word) -> Result<(), Alarm> {
        let is_outside = self.axes.is_virtual() || self.axes.plane != Plane::Zx;
        if is_outside && self.is_compensating() && !self.nose().radius.is_zero() {
            return Err(self.not_supported("nose-compensation-left", word));
        }
        Ok(())
    }

    /// Nose compensation is on: its group holds another code than at power-on.
    pub(crate) fn is_compensating(&self) -> bool {
        let in_force = self.modal.in_force.codes[COMPENSATION_GROUP];
        in_force.is_some() && in_force != self.dispatch.codes_at_power_on[COMPENSATION_GROUP]
    }

    /// Whether a code of compensation acts in a figure that is roughed; by parameter it is refused there.
    #[cold]
    fn acts_in_roughed_figure(&self, call: &Call<'_>) -> Result<bool, Alarm> {
        if let Some(word) = call.word
            && !self.settings.compensation.allowed_in_figure
        {
            return Err(self.refuse_in_figure(word));
        }
        Ok(match self.control.policies.roughing_compensation {
            RoughingCompensation::None | RoughingCompensation::BeforeCycle => false,
            RoughingCompensation::ByParameter => self.settings.compensation.roughs_compensated,
            RoughingCompensation::InFirstBlock => self.is_first_of_figure(),
        })
    }

    /// Whether compensation can begin in this block of a figure that is finished: on some controls only in its first.
    fn acts_in_finished_figure(&self) -> bool {
        let only_in_first = self.control.policies.roughing_compensation == RoughingCompensation::InFirstBlock
            && self.is_in_figure();
        !only_in_first || self.is_first_of_figure()
    }

    /// I and K where they belong to the wall at the end of compensation.
    #[cold]
    pub(crate) fn wall_letters(&self) -> u32 {
        if self.has_wall_words() { super::letters(b"IK") } else { 0 }
    }
}
