//! M words: which act before the move, which after it, and which only the machine's own logic knows.
//!
//! Source: the M functions that the control itself acts on, both families. An unknown M is given on; it does
//! not stop the program.

use turnwright_canon::{Action, Coolant, SpindleState};
use turnwright_syntax::Block;

use crate::machine::Core;
use crate::report::Alarm;

/// What waits for the end of the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    Stop,
    OptionalStop,
    End,
    Call,
    Return,
}

/// The M words of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Auxiliary {
    pub(crate) spindle: Option<SpindleState>,
    coolant: Option<Coolant>,
    /// Numbers of other M words; as many as `other_count`.
    others: [u32; 3],
    other_count: u8,
    /// What directs the program, and its place among the words.
    pub(crate) flow: Option<(Flow, u8)>,
    pub(crate) returns: bool,
    first: u8,
    count: u8,
}

/// Numbers of the M functions that the control acts on itself.
mod code {
    pub(super) const STOP: u32 = 0;
    pub(super) const OPTIONAL_STOP: u32 = 1;
    pub(super) const END: u32 = 2;
    pub(super) const SPINDLE_CLOCKWISE: u32 = 3;
    pub(super) const SPINDLE_COUNTER_CLOCKWISE: u32 = 4;
    pub(super) const SPINDLE_STOP: u32 = 5;
    pub(super) const MIST: u32 = 7;
    pub(super) const COOLANT_ON: u32 = 8;
    pub(super) const COOLANT_OFF: u32 = 9;
    pub(super) const END_AND_REWIND: u32 = 30;
    pub(super) const CALL: u32 = 98;
    pub(super) const RETURN: u32 = 99;
    /// Macro interrupt on and off, and the call of a program from outside: the control's own, not executed yet.
    pub(super) const FOR_LATER: [u32; 3] = [96, 97, 198];
}

impl Core {
    /// Takes an M word in; a second one counts only where the parameter allows several.
    pub(crate) fn sort_auxiliary(
        &mut self,
        block: &Block,
        place: usize,
        auxiliary: &mut Auxiliary,
    ) -> Result<(), Alarm> {
        let word = &block.words[place];
        let number = self.whole(word, 99_999_999)?;
        let is_flow = matches!(
            number,
            code::STOP | code::OPTIONAL_STOP | code::END | code::END_AND_REWIND | code::CALL | code::RETURN
        );
        if is_flow && self.is_in_figure() {
            return Err(match number {
                code::CALL | code::RETURN => self.refuse_in_figure(word),
                _ => self.figure_without_end(),
            });
        }
        if code::FOR_LATER.contains(&number) {
            return Err(self.not_supported("auxiliary-of-the-control", word));
        }
        if auxiliary.count > 0 {
            if !self.settings.several_auxiliary {
                // The last one counts.
                self.warn("auxiliary-overruled", &block.words[usize::from(auxiliary.first)]);
                *auxiliary = Auxiliary::default();
            } else if auxiliary.count >= 3 {
                return Err(self.alarm("auxiliary-combination-illegal", word));
            }
        }
        if auxiliary.count == 0 {
            auxiliary.first = place as u8;
        }
        auxiliary.count += 1;
        let is_spindle =
            matches!(number, code::SPINDLE_CLOCKWISE | code::SPINDLE_COUNTER_CLOCKWISE | code::SPINDLE_STOP);
        if (is_spindle && auxiliary.spindle.is_some()) || (is_flow && auxiliary.flow.is_some()) {
            return Err(self.alarm("auxiliary-combination-illegal", word));
        }
        self.modal.in_force.auxiliary = Some(number);
        let flow = |flow| Some((flow, place as u8));
        match number {
            code::STOP => auxiliary.flow = flow(Flow::Stop),
            code::OPTIONAL_STOP => auxiliary.flow = flow(Flow::OptionalStop),
            code::END | code::END_AND_REWIND => auxiliary.flow = flow(Flow::End),
            code::CALL => auxiliary.flow = flow(Flow::Call),
            code::RETURN => {
                auxiliary.flow = flow(Flow::Return);
                auxiliary.returns = true;
            }
            code::SPINDLE_CLOCKWISE => auxiliary.spindle = Some(SpindleState::Clockwise),
            code::SPINDLE_COUNTER_CLOCKWISE => auxiliary.spindle = Some(SpindleState::CounterClockwise),
            code::SPINDLE_STOP => auxiliary.spindle = Some(SpindleState::Stop),
            code::MIST | code::COOLANT_ON => auxiliary.coolant = Some(Coolant::On),
            code::COOLANT_OFF => auxiliary.coolant = Some(Coolant::Off),
            other => {
                auxiliary.others[usize::from(auxiliary.other_count)] = other;
                auxiliary.other_count += 1;
            }
        }
        Ok(())
    }
}

impl Auxiliary {
    /// Letters that M words of the block take.
    pub(crate) fn letters(&self) -> u32 {
        match self.flow {
            Some((Flow::Call, _)) => Block::bit(b'P') | Block::bit(b'L') | Block::bit(b'Q'),
            Some((Flow::Return, _)) => Block::bit(b'P') | Block::bit(b'L'),
            _ => 0,
        }
    }

    pub(crate) fn has_flow(&self) -> bool {
        self.flow.is_some()
    }

    /// M words that only act, none that directs the program.
    pub(crate) fn is_plain(&self) -> bool {
        self.count > 0 && self.flow.is_none()
    }

    /// Gives out what acts at the start of the move.
    #[inline]
    pub(crate) fn emit_before(&self, core: &mut Core) {
        if self.count == 0 {
            return;
        }
        if let Some(coolant) = self.coolant {
            core.emit(Action::Coolant(coolant));
        }
        for code in &self.others[..usize::from(self.other_count)] {
            core.emit(Action::Auxiliary { code: *code });
        }
    }
}
