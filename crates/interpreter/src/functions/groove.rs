//! `face-groove`, `radial-groove` — peck drilling and grooving along Z or X (G74, G75; G76, G77 in system C).
//!
//! `G74 R(e)`, then `G74 X(U)_ Z(W)_ P(Δi) Q(Δk) R(Δd) F_`. The block with an end point runs the cycle, the one
//! without stores the return e (radius). P belongs to X and Q to Z: one is the peck, the other the step to
//! the next groove. Both are whole numbers of least increments without sign, or millimetres by parameter; P is
//! a radius or a diameter by the control, and so is the relief Δd at the bottom of the face cycle. In one block
//! (`one_block.rs`) I is the distance along X, K that along Z, D the relief.
//!
//! Without X and P the face cycle is a drilling cycle. An end point without the peck is refused, cut in one go, or by
//! policy no block that cuts.
//!
//! Source: face and radial peck cycles of both families.

use turnwright_control::policy::{
    GrooveReliefAlone, GrooveReliefSign, GrooveWithoutPeck, GrooveWords as GrooveWordsAre,
};
use turnwright_cycles as cycles;
use turnwright_syntax::Word;
use turnwright_units::{Length, Position};

use super::one_block::Form;
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
    if call.block.present() & super::AXES != 0 {
        let form = core.cycle_form(call.block, b"DIK")?;
        let peck = if peck_axis == cycles::PeckAxis::X { b'P' } else { b'Q' };
        let stores = core.control.policies.groove_without_peck == GrooveWithoutPeck::StoresData;
        if !stores || form != Form::TwoBlocks || call.block.has(peck) {
            return core.run_groove(call, peck_axis, form);
        }
        core.refuse_letters(call.block, b"DIK")?;
        core.warn_block("groove-cuts-nothing");
    } else {
        core.refuse_letters(call.block, b"PQDIK")?;
    }
    if let Some(word) = call.block.word(b'R') {
        core.settings.groove_return = core.unsigned_length(word)?;
        core.missing_point(word);
        core.note_given("groove-return", word);
    }
    Ok(())
}

/// The distances of the block that cuts, as its words have them; along X a radius.
struct GrooveWords {
    cross: Option<Length>,
    lengthwise: Option<Length>,
    relief: Length,
    relief_letter: u8,
}

impl Core {
    fn groove_words(&mut self, call: &Call<'_>, along_z: bool, form: Form) -> Result<GrooveWords, Alarm> {
        let block = call.block;
        if form == Form::TwoBlocks {
            self.refuse_letters(block, b"DIK")?;
            let halved = self.control.policies.groove_words == GrooveWordsAre::Diameter;
            let radial = |length: Length| if halved { length.half() } else { length };
            let unsigned = |letter| {
                block.word(letter).map(|word| self.no_step_back(word, self.cycle_length(word)?)).transpose()
            };
            let (cross, lengthwise) = (unsigned(b'P')?.map(radial), unsigned(b'Q')?);
            let relief = self.optional_length(block, b'R')?;
            let relief = if along_z { radial(relief) } else { relief };
            return Ok(GrooveWords { cross, lengthwise, relief, relief_letter: b'R' });
        }
        self.refuse_letters(block, b"PQR")?;
        let unsigned =
            |letter| block.word(letter).map(|word| self.no_step_back(word, self.length(word)?)).transpose();
        let (cross, lengthwise) = (unsigned(b'I')?, unsigned(b'K')?);
        for word in [block.word(b'I'), block.word(b'K')].into_iter().flatten() {
            self.missing_point(word);
        }
        let relief = block.word(b'D').map_or(Ok(Length::ZERO), |word| self.one_block_depth(word, form))?;
        Ok(GrooveWords { cross, lengthwise, relief, relief_letter: b'D' })
    }

    fn no_step_back(&self, word: &Word, length: Length) -> Result<Length, Alarm> {
        if length.signum() < 0 { Err(self.alarm("groove-step-negative", word)) } else { Ok(length) }
    }

    fn run_groove(
        &mut self,
        call: &mut Call<'_>,
        peck_axis: cycles::PeckAxis,
        form: Form,
    ) -> Result<(), Alarm> {
        let (start, end) = (self.modal.position, self.target(call.block)?);
        let along_z = peck_axis == cycles::PeckAxis::Z;
        let words = self.groove_words(call, along_z, form)?;
        let (peck, step, peck_letters) = if along_z {
            (words.lengthwise, words.cross, letters(b"ZW"))
        } else {
            (words.cross, words.lengthwise, letters(b"XU"))
        };
        if call.block.present() & peck_letters == 0 {
            return Err(self.alarm_at("groove-end-missing", call.word));
        }
        if peck.is_none_or(Length::is_zero) {
            let plunges = self.control.policies.groove_without_peck == GrooveWithoutPeck::OnePlunge;
            if form != Form::OneBlockRecognised && !(plunges && peck.is_none()) {
                return Err(self.alarm_at("groove-step-zero", call.word));
            }
            self.warn_block("groove-step-omitted");
        }
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        let shifts = if along_z { end.x != start.x } else { end.z != start.z };
        if !words.relief.is_zero()
            && let Some(word) = call.block.word(words.relief_letter)
        {
            self.warn("relief-into-full-groove", word);
        }
        let request = cycles::GrooveRequest {
            context: self.cycle_context(feed),
            peck_axis,
            end: Position::new(end.x, end.z),
            peck,
            step,
            retract: self.settings.groove_return,
            relief: self.relief(words.relief, shifts),
            relief_direction: match self.control.policies.groove_relief_alone {
                _ if shifts => cycles::ReliefDirection::AgainstShift,
                GrooveReliefAlone::BySign => cycles::ReliefDirection::BySign,
                GrooveReliefAlone::AlwaysPlus => cycles::ReliefDirection::AlwaysPlus,
            },
        };
        let groove = cycles::groove(request).map_err(|fault| self.misuse(fault, call))?;
        self.start_cycle(CycleMoves::Groove(Box::new(groove)), call.code, Vec::new(), 0)
    }

    /// Some controls take only the amount of a relief whose direction is fixed.
    fn relief(&self, relief: Length, shifts: bool) -> Length {
        let takes_amount = self.control.policies.groove_relief_sign == GrooveReliefSign::Ignored;
        if shifts && takes_amount { relief.abs() } else { relief }
    }
}
