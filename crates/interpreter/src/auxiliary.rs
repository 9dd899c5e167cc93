//! M words: which act at the start of the move, which behind it, and which only the machine's own logic knows.
//!
//! Program stops, ends and calls wait for the end of the move; so do spindle stop and coolant off, unless the
//! policy gives them out with the move. Everything else acts at its start. One M word counts in a block, the last
//! one; by parameter up to three, of which stops and ends must stand alone. An unknown M is given on; it does not
//! stop the program.
//!
//! The second auxiliary function (`B12`) is given on like an unknown M. A machine has it when its parameter (3460) was set:
//! A, B, C or V; U and W stay increments.
//!
//! Source: the M functions that the control itself acts on and the order of actions in a block, both families.

use turnwright_canon::{Action, Coolant, SpindleState};
use turnwright_control::policy::{AuxiliaryCombination, CallEntry, StoppingCodes};
use turnwright_syntax::{Block, Word};

use crate::Environment;
use crate::functions::Function;
use crate::machine::{BlockPlace, Core, SyncReason};
use crate::report::Alarm;
use crate::reset::Ending;

/// What waits for the end of the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    Stop,
    OptionalStop,
    End,
    Call,
    /// A call of a program from outside the memory.
    CallExternal,
    /// A call of this program by a code that a parameter names.
    CallProgram(u32),
    Return,
    InterruptOn,
    InterruptOff,
}

/// What still has to be done for a block when its cycle has run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    auxiliary: Auxiliary,
    at: BlockPlace,
    /// Calls in work when the block began.
    depth: usize,
}

/// M words that one block may have where the parameter allows several.
const SEVERAL: u8 = 3;

/// The M words of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Auxiliary {
    pub(crate) spindle: Option<SpindleState>,
    coolant: Option<Coolant>,
    /// Numbers of other M words; as many as `other_count`.
    others: [u32; SEVERAL as usize],
    other_count: u8,
    /// Spindle stop or coolant off wait for the end of the move.
    acts_behind: bool,
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
    pub(super) const CALL_EXTERNAL: u32 = 198;
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
        let number = self.whole(word, self.settings.auxiliary_max)?;
        let called = self.subprogram_of(number);
        let is_call = called.is_some() || matches!(number, code::CALL | code::CALL_EXTERNAL);
        let (interrupt_on, interrupt_off) = self.macros.interrupt_codes;
        if is_call
            && self.control.policies.call_entry == CallEntry::Absent
            && let Some(entry) = block.word(b'Q')
        {
            return Err(self.alarm("illegal-address", entry));
        }
        let is_flow = is_call
            || matches!(
                number,
                code::STOP | code::OPTIONAL_STOP | code::END | code::END_AND_REWIND | code::RETURN
            )
            || number == interrupt_on
            || number == interrupt_off;
        let stops = matches!(number, code::STOP | code::OPTIONAL_STOP);
        if is_flow && self.is_in_figure() && !stops {
            return Err(match number {
                _ if is_call => self.refuse_in_figure(word),
                code::RETURN => self.refuse_in_figure(word),
                _ => self.figure_without_end(),
            });
        }
        let calls_already =
            matches!(auxiliary.flow, Some((Flow::Call | Flow::CallExternal | Flow::CallProgram(_), _)));
        if is_call && self.settings.several_auxiliary && calls_already {
            return Err(self.alarm("two-subprogram-calls", word));
        }
        if auxiliary.count > 0 && !self.joins(block, word, number, auxiliary)? {
            return Ok(());
        }
        if auxiliary.count == 0 {
            auxiliary.first = place as u8;
        }
        auxiliary.count += 1;
        self.modal.in_force.auxiliary = Some(number);
        if !self.is_capturing() {
            self.parts.count_code(number);
        }
        let stops_behind = self.control.policies.stopping_codes == StoppingCodes::BehindTheMove;
        let flow = |flow| Some((flow, place as u8));
        match number {
            _ if called.is_some() => {
                auxiliary.flow = called.and_then(|program| flow(Flow::CallProgram(program)))
            }
            code::CALL_EXTERNAL => auxiliary.flow = flow(Flow::CallExternal),
            _ if number == interrupt_on => auxiliary.flow = flow(Flow::InterruptOn),
            _ if number == interrupt_off => auxiliary.flow = flow(Flow::InterruptOff),
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
            code::SPINDLE_STOP => {
                auxiliary.spindle = Some(SpindleState::Stop);
                auxiliary.acts_behind |= stops_behind;
            }
            code::MIST | code::COOLANT_ON => auxiliary.coolant = Some(Coolant::On),
            code::COOLANT_OFF => {
                auxiliary.coolant = Some(Coolant::Off);
                auxiliary.acts_behind |= stops_behind;
            }
            other => {
                self.change_gear(other);
                self.note_rigid_code(other, word)?;
                auxiliary.others[usize::from(auxiliary.other_count)] = other;
                auxiliary.other_count += 1;
            }
        }
        Ok(())
    }

    /// Whether a further M word of the block acts at all; those before it may lose their effect.
    #[cold]
    fn joins(
        &mut self,
        block: &Block,
        word: &Word,
        number: u32,
        auxiliary: &mut Auxiliary,
    ) -> Result<bool, Alarm> {
        let first = &block.words[usize::from(auxiliary.first)];
        if !self.settings.several_auxiliary {
            // The last one counts.
            self.warn("auxiliary-overruled", first);
            *auxiliary = Auxiliary::default();
            return Ok(true);
        }
        let alone =
            |number| matches!(number, code::STOP | code::OPTIONAL_STOP | code::END | code::END_AND_REWIND);
        let stands_alone = matches!(auxiliary.flow, Some((Flow::Stop | Flow::OptionalStop | Flow::End, _)));
        let is_spindle = (code::SPINDLE_CLOCKWISE..=code::SPINDLE_STOP).contains(&number);
        let is_coolant = matches!(number, code::COOLANT_ON | code::COOLANT_OFF);
        let is_call = matches!(number, code::CALL | code::RETURN);
        let meets_its_group = (is_spindle && auxiliary.spindle.is_some())
            || (is_coolant && auxiliary.coolant.is_some())
            || (is_call && auxiliary.flow.is_some());
        let clash = stands_alone || alone(number) || meets_its_group;
        let is_alarm = self.control.policies.auxiliary_combination == AuxiliaryCombination::Alarm;
        if auxiliary.count >= SEVERAL || (clash && is_alarm) {
            return Err(self.alarm("auxiliary-combination-illegal", word));
        }
        if stands_alone && !alone(number) {
            self.warn("auxiliary-overruled", word);
            return Ok(false);
        }
        if clash {
            self.warn("auxiliary-overruled", first);
        }
        if alone(number) {
            *auxiliary = Auxiliary::default();
        }
        Ok(true)
    }

    /// What the M words of a block do behind its move; it waits until a cycle of the block has run.
    #[cold]
    pub(crate) fn behind_move(
        &mut self,
        auxiliary: Auxiliary,
        depth: usize,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        if self.active.is_some() || self.frames.len() > depth {
            let stops_spindle = self.waiting.is_some_and(|waiting| waiting.depth == depth);
            let auxiliary = if stops_spindle { auxiliary.with_spindle_stop_behind() } else { auxiliary };
            self.waiting = Some(Waiting { auxiliary, at: self.at, depth });
            return Ok(());
        }
        if self.stops_once {
            self.end_exact_stop();
        }
        if auxiliary.acts_behind {
            if auxiliary.spindle == Some(SpindleState::Stop) && !self.is_capturing() {
                self.modal.spindle = SpindleState::Stop;
                self.emit_spindle();
            }
            if auxiliary.coolant == Some(Coolant::Off) {
                self.emit(Action::Coolant(Coolant::Off));
            }
        }
        let Some((flow, place)) = auxiliary.flow else { return Ok(()) };
        self.flow(auxiliary, block, environment)?;
        if flow == Flow::End {
            let rewinds = block.words.get(usize::from(place)).and_then(|word| self.whole(word, 99).ok());
            let rewinds = rewinds == Some(code::END_AND_REWIND);
            self.program_ended(if rewinds { Ending::EndAndRewind } else { Ending::End });
        }
        Ok(())
    }

    /// A cycle that has started the spindle stops it when it has run.
    pub(crate) fn stop_spindle_behind_cycle(&mut self) {
        let auxiliary = Auxiliary::default().with_spindle_stop_behind();
        self.waiting = Some(Waiting { auxiliary, at: self.at, depth: self.frames.len() });
    }

    /// Whether a block whose cycle has run still has something to do.
    #[inline]
    pub(crate) fn is_due(&self) -> bool {
        self.waiting.as_ref().is_some_and(|waiting| self.frames.len() <= waiting.depth)
    }

    /// Does what waited for the end of a cycle.
    #[cold]
    pub(crate) fn finish_waiting(
        &mut self,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let Some(waiting) = self.waiting.take() else { return Ok(()) };
        self.is_plain = false;
        self.at = waiting.at;
        if let Some(id) = self.cache.current {
            // A call goes back to the block that comes next.
            let next = self.cache.start(id);
            self.go(next, environment)?;
        }
        self.behind_move(waiting.auxiliary, waiting.depth, block, environment)
    }
}

impl Core {
    /// Whether an M code calls the program that its block names.
    pub(crate) const fn is_call_code(&self, number: u32) -> bool {
        matches!(number, code::CALL | code::CALL_EXTERNAL)
    }

    /// The subprogram that an M code calls by parameter, outside programs that were called that way.
    fn subprogram_of(&self, number: u32) -> Option<u32> {
        if !self.macros.calls.has_auxiliary() || self.is_called_by_code() {
            return None;
        }
        self.macros.calls.subprogram(number)
    }
}

/// The second auxiliary function: a word of the letter that a parameter names.
impl Core {
    /// Its letter, unless that names an axis of the machine or is a word of the function of the block.
    #[cold]
    pub(crate) fn second_auxiliary(&self, function: &Function) -> u32 {
        self.settings.second_auxiliary & !(self.axes.letters | function.letters)
    }

    #[cold]
    pub(crate) fn emit_second_auxiliary(&mut self, block: &Block) -> Result<(), Alarm> {
        let is_second =
            |word: &&Word| !word.comma && Block::bit(word.address) == self.settings.second_auxiliary;
        let Some(word) = block.words.iter().rfind(is_second) else { return Ok(()) };
        let code = self.whole(word, 99_999_999)?;
        self.emit(Action::SecondAuxiliary { letter: word.address, code });
        Ok(())
    }
}

impl Auxiliary {
    /// Letters that M words of the block take.
    pub(crate) fn letters(&self) -> u32 {
        match self.flow {
            Some((Flow::Call | Flow::CallExternal, _)) => {
                Block::bit(b'P') | Block::bit(b'L') | Block::bit(b'Q')
            }
            Some((Flow::InterruptOn | Flow::Return, _)) => Block::bit(b'P'),
            _ => 0,
        }
    }

    /// The same, with a stop of the spindle behind the move. What the block gave out before its move stays given.
    fn with_spindle_stop_behind(mut self) -> Self {
        if !self.acts_behind {
            self.coolant = None;
        }
        self.spindle = Some(SpindleState::Stop);
        self.acts_behind = true;
        self
    }

    pub(crate) fn has_flow(&self) -> bool {
        self.flow.is_some()
    }

    /// Something waits for the end of the move.
    #[inline]
    pub(crate) fn acts_behind(&self) -> bool {
        self.acts_behind || self.flow.is_some()
    }

    /// The state of the spindle that the block asks for before its move.
    pub(crate) fn spindle_before(&self) -> Option<SpindleState> {
        self.spindle.filter(|state| !(self.acts_behind && *state == SpindleState::Stop))
    }

    /// M words that only act, none that directs the program.
    pub(crate) fn is_plain(&self) -> bool {
        self.count > 0 && self.flow.is_none()
    }

    /// Gives out what acts at the start of the move.
    #[inline]
    pub(crate) fn emit_before(&self, core: &mut Core, block: &Block) {
        if self.count == 0 {
            return;
        }
        if let Some(coolant) = self.coolant.filter(|coolant| !(self.acts_behind && *coolant == Coolant::Off))
        {
            core.emit(Action::Coolant(coolant));
        }
        for code in &self.others[..usize::from(self.other_count)] {
            if core.clamps_for_hole(*code, block) {
                continue;
            }
            core.axes.machine_code(*code);
            core.emit(Action::Auxiliary { code: *code });
            core.obey_in_gear();
            if core.settings.unbuffered.iter().any(|(first, last)| (first..=last).contains(&code)) {
                core.sync = Some(SyncReason::MovesDone);
            }
        }
    }
}
