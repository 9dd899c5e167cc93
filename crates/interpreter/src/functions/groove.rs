//! `face-groove`, `radial-groove` — peck drilling and grooving along Z or X (G74, G75; G76, G77 in system C).
//!
//! `G74 R(e)`, then `G74 X(U)_ Z(W)_ P(Δi) Q(Δk) R(Δd) F_`. The block with an end point runs the cycle, the one
//! without stores the return e (radius). P belongs to X and Q to Z: one is the peck, the other the step to
//! the next groove. Both are whole numbers of least increments without sign, or millimetres by parameter; P is
//! a radius or a diameter by the control. Δd is the relief at the bottom.
//!
//! Without X and P the face cycle is a drilling cycle.
//!
//! Source: face and radial peck cycles of both families.

use turnwright_control::policy::{GrooveReliefAlone, GrooveWords};
use turnwright_cycles as cycles;
use turnwright_syntax::Word;
use turnwright_units::{Length, Position};

use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;

pub(super) static FACE_GROOVE: Function =
    Function::one_shot("face-groove", |core, call| groove(core, call, cycles::PeckAxis::Z))
        .with_letters(b"PQRDIK")
        .multiple_cycle();

pub(super) static RADIAL_GROOVE: Function =
    Function::one_shot("radial-groove", |core, call| groove(core, call, cycles::PeckAxis::X))
        .with_letters(b"PQRDIK")
        .multiple_cycle();

fn groove(core: &mut Core, call: &mut Call<'_>, peck_axis: cycles::PeckAxis) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let has_end = call.block.present() & super::AXES != 0;
    if let Some(word) = call.block.word(b'D').or(call.block.word(b'I')).or(call.block.word(b'K')) {
        return Err(if has_end { core.one_block_form(word) } else { core.alarm("cycle-word-illegal", word) });
    }
    if has_end {
        return core.run_groove(call, peck_axis);
    }
    core.refuse_letters(call.block, b"PQ")?;
    if let Some(word) = call.block.word(b'R') {
        core.settings.groove_return = core.unsigned_length(word)?;
    }
    Ok(())
}

impl Core {
    /// P or Q: a length without sign.
    fn groove_length(&self, word: &Word) -> Result<Length, Alarm> {
        let length = self.cycle_length(word)?;
        if length.signum() < 0 { Err(self.alarm("groove-step-negative", word)) } else { Ok(length) }
    }

    fn run_groove(&mut self, call: &mut Call<'_>, peck_axis: cycles::PeckAxis) -> Result<(), Alarm> {
        let (start, end) = (self.modal.position, self.target(call.block)?);
        let halved = self.control.policies.groove_words == GrooveWords::Diameter;
        let radial = |length: Length| if halved { length.half() } else { length };
        let cross = call.block.word(b'P').map(|word| self.groove_length(word)).transpose()?.map(radial);
        let lengthwise = call.block.word(b'Q').map(|word| self.groove_length(word)).transpose()?;
        let relief = call.block.word(b'R').map(|word| self.length(word)).transpose()?.unwrap_or(Length::ZERO);
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        let along_z = peck_axis == cycles::PeckAxis::Z;
        let (peck, step, peck_letters) =
            if along_z { (lengthwise, cross, letters(b"ZW")) } else { (cross, lengthwise, letters(b"XU")) };
        if call.block.present() & peck_letters == 0 {
            return Err(self.alarm_at("groove-end-missing", call.word));
        }
        if peck.is_none_or(Length::is_zero) {
            return Err(self.alarm_at("groove-step-zero", call.word));
        }
        self.check_spindle();
        let shifts = if along_z { end.x != start.x } else { end.z != start.z };
        if !relief.is_zero()
            && shifts
            && let Some(word) = call.block.word(b'R')
        {
            self.warn("relief-into-full-groove", word);
        }
        let relief = self.relief(relief, along_z, shifts);
        let request = cycles::GrooveRequest {
            context: self.cycle_context(feed),
            peck_axis,
            end: Position::new(end.x, end.z),
            peck,
            step,
            retract: self.settings.groove_return,
            relief,
            relief_direction: match self.control.policies.groove_relief_alone {
                _ if shifts => cycles::ReliefDirection::AgainstShift,
                GrooveReliefAlone::BySign => cycles::ReliefDirection::BySign,
                GrooveReliefAlone::AlwaysPlus => cycles::ReliefDirection::AlwaysPlus,
            },
        };
        let groove = cycles::groove(request).map_err(|fault| self.misuse(fault, call))?;
        self.start_cycle(CycleMoves::Groove(Box::new(groove)), call.code, Vec::new(), 0)
    }

    /// The relief as a radius; where the control takes its amount only, without its sign.
    fn relief(&self, relief: Length, along_z: bool, shifts: bool) -> Length {
        let halved = along_z && self.control.policies.groove_words == GrooveWords::Diameter;
        let relief = if halved { relief.half() } else { relief };
        let takes_amount = self.control.policies.cycle_integer_words
            == turnwright_control::policy::CycleIntegerWords::ByUnitParameter;
        if shifts && takes_amount { relief.abs() } else { relief }
    }
}
