//! Macro calls: once, after every move, for every block, and by codes that parameters turn into calls.
//!
//! A call opens a level of local variables, fills it from its words and closes it again on return. Source:
//! macro calls of both families; limits of nesting are limits of the control.

use turnwright_control::Control;
use turnwright_control::policy::{CallUnderModalCall, MacroCancelWithoutCall, NestedModalCall};
use turnwright_syntax::{Block, Value, Word};

use super::arguments::{Arguments, Passed};
use crate::Environment;
use crate::flow::{Frame, FrameKind, MacroFrame};
use crate::index::Resume;
use crate::machine::Core;
use crate::report::Alarm;

/// Which call a code makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CallKind {
    /// At once.
    Simple,
    /// After every block that moves, until it is cancelled.
    Modal,
    /// In place of every block, until it is cancelled.
    EachBlock,
}

/// A call that stays in force.
#[derive(Clone, Debug)]
pub(crate) struct ModalCall {
    target: Program,
    rounds: u32,
    arguments: Passed,
    is_each_block: bool,
}

/// A program that was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Program {
    /// Its number, when it has one.
    pub(crate) number: Option<u32>,
    pub(crate) start: Resume,
}

/// A code that a parameter turns into a call.
#[derive(Clone, Copy, Debug)]
struct CodeCall {
    /// G codes times ten, M codes and T codes as they are.
    code: u32,
    program: u32,
    is_modal: bool,
}

/// The codes that call programs, as the parameters say.
#[derive(Debug, Default)]
pub(crate) struct CodeCalls {
    preparatory: Vec<CodeCall>,
    auxiliary: Vec<CodeCall>,
    /// M codes that call a subprogram, without arguments.
    subprograms: Vec<CodeCall>,
    tools: Vec<CodeCall>,
    /// Every T word calls this program.
    pub(crate) any_tool: Option<u32>,
    /// M codes with four digits from here on call the program of their number.
    direct_auxiliary_first: Option<u32>,
}

/// Calls by parameter: ten of each, nine subprograms.
const CALLS: u32 = 10;

impl CodeCalls {
    pub(super) fn new(control: &Control) -> Self {
        let (parameters, limits) = (&control.parameters, &control.limits);
        let mut calls = Self::default();
        let value = |name: String| parameters.value(&name);
        let single = |list: &mut Vec<CodeCall>, code: f64, scale: f64, program: u32| {
            if code != 0.0 {
                list.push(CodeCall { code: (code.abs() * scale) as u32, program, is_modal: code < 0.0 });
            }
        };
        let first = |name: &str| parameters.value(name).max(0.0) as u32;
        let calls_by = |name: &str| parameters.bit(name);
        for place in 0..CALLS {
            let number = place + 1;
            if calls_by("g-codes-call-macros") {
                let code = value(format!("macro-calling-g-code-{number}"));
                single(&mut calls.preparatory, code, 10.0, limits.g_call_program + place);
            }
            if calls_by("m-codes-call-macros") {
                let code = value(format!("macro-calling-m-code-{number}"));
                single(&mut calls.auxiliary, code, 1.0, limits.m_call_program + place);
            }
            if number < CALLS {
                single(
                    &mut calls.subprograms,
                    value(format!("subprogram-calling-m-code-{number}")),
                    1.0,
                    limits.m_subprogram + place,
                );
            }
            if calls_by("tool-code-calls-program") {
                let code = value(format!("macro-calling-t-code-{number}"));
                single(&mut calls.tools, code, 1.0, limits.t_call_program + place);
            }
        }
        // The other way to say it: a first code, a first program and how many.
        for place in 0..first("macro-calling-g-code-count").min(100) {
            let code = first("macro-calling-g-code-first") + place;
            single(&mut calls.preparatory, f64::from(code), 10.0, first("g-range-program") + place);
        }
        for place in 0..first("macro-calling-m-code-count").min(100) {
            let code = first("macro-calling-m-code-first") + place;
            single(&mut calls.auxiliary, f64::from(code), 1.0, first("m-range-program") + place);
        }
        let any_tool = calls_by("tool-code-calls-program") && limits.t_program > 0;
        calls.any_tool = any_tool.then_some(limits.t_program);
        let direct = limits.direct_calling_m_code;
        calls.direct_auxiliary_first = (direct > 0).then_some(direct);
        calls
    }

    /// The program that a G code (times ten) calls, and whether the call is modal.
    #[inline]
    pub(crate) fn preparatory(&self, code: u16) -> Option<(u32, CallKind)> {
        let call = self.preparatory.iter().find(|call| call.code == u32::from(code))?;
        Some((call.program, if call.is_modal { CallKind::Modal } else { CallKind::Simple }))
    }

    /// The macro that an M code calls.
    pub(crate) fn auxiliary(&self, code: u32) -> Option<u32> {
        self.auxiliary.iter().find(|call| call.code == code).map(|call| call.program)
    }

    /// The subprogram that an M code calls.
    pub(crate) fn subprogram(&self, code: u32) -> Option<u32> {
        let listed = self.subprograms.iter().find(|call| call.code == code).map(|call| call.program);
        listed.or_else(|| {
            let first = self.direct_auxiliary_first?;
            (first..first + 1_000).contains(&code).then_some(code)
        })
    }

    /// The macro that a T code calls.
    pub(crate) fn tool(&self, code: u32) -> Option<u32> {
        self.tools.iter().find(|call| call.code == code).map(|call| call.program)
    }

    /// Whether any M code may call.
    pub(crate) fn has_auxiliary(&self) -> bool {
        !(self.auxiliary.is_empty() && self.subprograms.is_empty() && self.direct_auxiliary_first.is_none())
    }

    /// Whether any G code may call.
    pub(crate) fn has_preparatory(&self) -> bool {
        !self.preparatory.is_empty()
    }

    /// Whether any T code may call.
    pub(crate) fn has_tools(&self) -> bool {
        self.any_tool.is_some() || !self.tools.is_empty()
    }
}

impl Core {
    /// A block with a macro call; `call` is its G word.
    #[cold]
    pub(crate) fn macro_call(
        &mut self,
        block: &Block,
        call: &Word,
        kind: CallKind,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        self.check_call_block(block, call)?;
        if kind == CallKind::Simple && self.is_type_a_block(block) {
            return self.type_a(block, environment);
        }
        let arguments = self.arguments(block, Some(call), Arguments::OfCall)?;
        let rounds = match block.word(b'L') {
            Some(word) => self.whole(word, self.control.limits.repeat_count_max)?,
            None => 1,
        };
        let target = self.called_program(block, call, environment)?;
        match kind {
            CallKind::Simple => {
                if self.control.policies.call_under_modal_call == CallUnderModalCall::Cancels {
                    self.macros.modal_calls.clear();
                }
                let named = block.word(b'P').unwrap_or(call);
                self.enter_macro(target, rounds, arguments, MacroEntry::default(), named, environment)
            }
            CallKind::Modal | CallKind::EachBlock => {
                let is_each_block = kind == CallKind::EachBlock;
                let levels = match self.control.policies.nested_modal_call {
                    NestedModalCall::Allowed => self.control.limits.macro_depth_max,
                    NestedModalCall::Refused => 1,
                };
                if self.macros.modal_calls.len() >= usize::from(levels) {
                    return Err(self.alarm("macro-calls-too-deep", call));
                }
                self.macros.modal_calls.push(ModalCall { target, rounds, arguments, is_each_block });
                Ok(())
            }
        }
    }

    /// What stands before the call, or calls again, has no place in its block.
    fn check_call_block(&self, block: &Block, call: &Word) -> Result<(), Alarm> {
        for word in &block.words {
            if word.start < call.start && !matches!(word.address, b'N' | b'O') {
                return Err(self.alarm("macro-and-nc-mixed", word));
            }
            if word.start > call.start && word.address == b'G' && self.calls_macro(word) {
                return Err(self.alarm("two-macro-calls", word));
            }
        }
        Ok(())
    }

    /// Whether a G word hands the words behind it to a macro.
    pub(crate) fn calls_macro(&self, word: &Word) -> bool {
        let Ok(code) = self.code(word) else { return false };
        let by_parameter = self.macros.calls.preparatory(code).is_some() && !self.is_called_by_code();
        by_parameter || self.dispatch.function(code).is_some_and(|id| id.get().is_call())
    }

    /// A code that a parameter turns into a call, with the other words as arguments.
    #[cold]
    pub(crate) fn call_by_code(
        &mut self,
        block: &Block,
        word: &Word,
        (number, kind): (u32, CallKind),
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let arguments = self.arguments(block, Some(word), Arguments::OfCall)?;
        let rounds = match block.word(b'L') {
            Some(word) => self.whole(word, self.control.limits.repeat_count_max)?,
            None => 1,
        };
        let target = self.program_by_number(number, word, environment)?;
        if kind == CallKind::Modal {
            self.macros.modal_calls.push(ModalCall { target, rounds, arguments, is_each_block: false });
            return Ok(());
        }
        let entry = MacroEntry { by_code: true, modal: None };
        self.enter_macro(target, rounds, arguments, entry, word, environment)
    }

    /// Ends the modal call that was made last.
    pub(crate) fn cancel_modal_call(&mut self, word: Option<&Word>) -> Result<(), Alarm> {
        let is_harmless = self.control.policies.macro_cancel_without_call == MacroCancelWithoutCall::Harmless
            || self.control.parameters.bit("macro-cancel-allowed");
        match self.macros.modal_calls.pop() {
            None if !is_harmless => Err(self.alarm_at("modal-cancel-without-call", word)),
            _ => Ok(()),
        }
    }

    /// The modal call that comes next, seen from where execution is: the last one made, or inside one that runs
    /// the one made before it.
    fn next_modal_call(&self) -> Option<(usize, ModalCall)> {
        let running = self.frames.iter().rev().find_map(|frame| match &frame.kind {
            FrameKind::Macro(frame) => frame.modal,
            _ => None,
        });
        // The macro that runs may have ended calls of its caller.
        let level = running.unwrap_or(self.macros.modal_calls.len()).checked_sub(1)?;
        Some((level, self.macros.modal_calls.get(level)?.clone()))
    }

    /// After a block that moved: the modal call in force.
    #[cold]
    pub(crate) fn call_after_move(&mut self, environment: &mut dyn Environment) -> Result<(), Alarm> {
        let Some((level, call)) = self.next_modal_call() else { return Ok(()) };
        if call.is_each_block {
            return Ok(());
        }
        let entry = MacroEntry { by_code: false, modal: Some(level) };
        let word = Word {
            address: b'G',
            comma: false,
            start: self.at.first_byte,
            end: self.at.last_byte,
            value: Value::Missing,
        };
        self.enter_macro(call.target, call.rounds, call.arguments, entry, &word, environment)
    }

    /// In place of a block: the call for every block, with the words of this one. False when there is none.
    #[cold]
    pub(crate) fn call_for_block(
        &mut self,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<bool, Alarm> {
        let Some((level, call)) = self.next_modal_call().filter(|(_, call)| call.is_each_block) else {
            return Ok(false);
        };
        let Some(word) = block.words.iter().find(|word| !matches!(word.address, b'N' | b'O')).copied() else {
            return Ok(false);
        };
        if block.words.iter().any(|word| word.address == b'G' && self.is_cancel_code(word)) {
            return Ok(false);
        }
        let mut arguments = self.arguments(block, None, Arguments::OfBlock)?;
        for (argument, stored) in arguments.values.iter_mut().zip(call.arguments.values.iter()) {
            // What the block does not say again is as the call said it.
            if super::is_null(*argument) {
                *argument = *stored;
            }
        }
        let entry = MacroEntry { by_code: false, modal: Some(level) };
        self.enter_macro(call.target, call.rounds, arguments, entry, &word, environment)?;
        Ok(true)
    }

    fn is_cancel_code(&self, word: &Word) -> bool {
        let function = self.code(word).ok().and_then(|code| self.dispatch.function(code));
        function.is_some_and(|id| id.get().name == crate::functions::MODAL_CALL_CANCEL)
    }

    /// Opens a level of local variables and goes to the program.
    fn enter_macro(
        &mut self,
        target: Program,
        rounds: u32,
        arguments: Passed,
        entry: MacroEntry,
        word: &Word,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        self.check_depth(word, true)?;
        if rounds == 0 {
            return Ok(());
        }
        let caller = Box::new(self.macros.variables.locals());
        self.macros.variables.set_locals(&arguments.values);
        let frame = MacroFrame {
            start: target.start,
            rounds_left: rounds - 1,
            arguments,
            caller,
            modal: entry.modal,
            by_code: entry.by_code,
        };
        self.push_frame(FrameKind::Macro(frame));
        self.enter(target, environment)
    }

    /// Whether the program in work was called by a code, where such codes have their plain meaning.
    pub(crate) fn is_called_by_code(&self) -> bool {
        self.frames.iter().any(|frame: &Frame| match &frame.kind {
            FrameKind::Macro(frame) => frame.by_code,
            FrameKind::Subprogram { by_code, .. } => *by_code,
            FrameKind::Finish { .. } => false,
        })
    }
}

/// How a macro was entered.
#[derive(Clone, Copy, Debug, Default)]
struct MacroEntry {
    by_code: bool,
    modal: Option<usize>,
}
