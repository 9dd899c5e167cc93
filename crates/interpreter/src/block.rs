//! One block: which functions it names, and the order in which its parts act.
//!
//! Order: modal codes, feed, speed, tool, auxiliary functions, then the move or one-shot function, then
//! the auxiliary functions that wait for the end of the move. Source: execution order inside a block, both
//! families.

use turnwright_control::policy::{OneShotWithMotion, ProgramZero, SettingBesideSystem};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Decimal, Word};

use crate::Environment;
use crate::auxiliary::{Auxiliary, Flow};
use crate::axes::Plane;
use crate::functions::{Function, FunctionId, Kind};
use crate::machine::Core;
use crate::macros::CallKind;
use crate::plain::Plain;
use crate::report::Alarm;
use crate::words::{POWER, Role};

/// What a function's code may look at.
pub(crate) struct Call<'a> {
    pub(crate) block: &'a Block,
    pub(crate) environment: &'a mut dyn Environment,
    /// The code as written, times ten.
    pub(crate) code: u16,
    /// The code's word; `None` when the code is in force from an earlier block.
    pub(crate) word: Option<&'a Word>,
}

/// Letters that every block may have.
const ALWAYS: u32 = Block::bit(b'G')
    | Block::bit(b'N')
    | Block::bit(b'O')
    | Block::bit(b'M')
    | Block::bit(b'S')
    | Block::bit(b'T')
    | Block::bit(b'F');

const AXES: u32 = Block::bit(b'X') | Block::bit(b'Z') | Block::bit(b'U') | Block::bit(b'W');

/// The common variable that holds the T code for the program that it calls.
const TOOL_VARIABLE: f64 = 149.0;

/// The modal group of the work coordinate systems.
const WORK_SYSTEMS: u8 = 14;

/// Most G words in a block.
const CODES_MAX: usize = 16;

/// A code of a block: its function, number times ten, and place among the words.
#[derive(Clone, Copy)]
struct Code {
    id: FunctionId,
    code: u16,
    word: u8,
}

/// The codes of a block, sorted by what they do.
#[derive(Default)]
struct Codes {
    modes: [(FunctionId, u8); CODES_MAX],
    mode_count: usize,
    /// Letters that modes of the block take.
    mode_letters: u32,
    one_shot: Option<Code>,
    motion: Option<Code>,
}

/// What a G code calls.
#[derive(Clone, Copy)]
enum MacroCall {
    /// A program that the words name.
    ByWords(CallKind),
    /// A program that a parameter names.
    ByCode((u32, CallKind)),
}

impl Core {
    /// Executes the words of a block, the short way where it is a plain one and nothing looks at it.
    #[inline]
    pub(crate) fn execute(
        &mut self,
        block: &Block,
        plain: Option<Plain>,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        if self.is_plain
            && let Some(plain) = plain
            && self.execute_plain(block, plain, environment)?
        {
            return Ok(());
        }
        self.is_plain = false;
        self.execute_any(block, environment)?;
        self.is_plain = self.has_plain_state();
        Ok(())
    }

    fn execute_any(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<(), Alarm> {
        self.has_started = true;
        if self.data_list.is_some() {
            return self.run_data_list(block);
        }
        self.thread_blocks >>= 1;
        let depth = self.frames.len();
        if !self.macros.modal_calls.is_empty() && self.call_for_block(block, environment)? {
            return Ok(());
        }
        if (self.macros.calls.has_auxiliary() || self.macros.calls.has_tools())
            && self.call_by_word(block, environment)?
        {
            return Ok(());
        }
        if block.words.len() as u32 > block.present().count_ones() {
            self.repeated_addresses(block)?;
        }
        let mut codes = Codes::default();
        let mut auxiliary = Auxiliary::default();
        for (place, word) in block.words.iter().enumerate() {
            match word.address {
                b'X' | b'Z' | b'U' | b'W' | b'F' => {}
                _ if word.comma => {}
                b'G' => {
                    if let Some(call) = self.sort_code(block, place, &mut codes)? {
                        return self.call_macro(block, word, call, environment);
                    }
                }
                b'M' => self.sort_auxiliary(block, place, &mut auxiliary)?,
                b'N' => self.sequence_number(block, place)?,
                b'B' | b'D' | b'H' => self.modal.in_force.rare_word(word),
                b'O' => self.program_number(word, &auxiliary)?,
                _ => {}
            }
        }
        if self.expects_program_number {
            self.first_block();
        }
        if self.is_over {
            return Ok(());
        }
        if self.axes.is_virtual() {
            self.check_virtual_plane(block)?;
            self.check_cylinder_figure(block, &auxiliary)?;
        }
        if codes.one_shot.is_some() && codes.motion.is_some() {
            self.one_shot_with_motion(block, &codes)?;
        }
        if self.macros.calls.any_tool.is_some() {
            self.call_by_tool(block, &mut auxiliary)?;
        }
        if codes.one_shot.is_some() && codes.mode_count > 0 {
            self.drop_work_system(block, &mut codes);
        }
        for (id, word) in codes.modes.iter().take(codes.mode_count) {
            self.run_mode(*id, &block.words[usize::from(*word)], block, environment)?;
        }
        if let Some(motion) = codes.motion {
            self.change_motion(motion.id, motion.code);
        }
        let motion = self.modal.motion;
        let function = codes.one_shot.map_or(motion, |one_shot| one_shot.id).get();
        let mut other_letters = codes.mode_letters | auxiliary.letters();
        if self.compensation.is_some() {
            other_letters |= self.wall_letters();
        }
        let second = self.settings.second_auxiliary & block.present();
        let second = if second == 0 { 0 } else { self.second_auxiliary(function) };
        other_letters |= second;
        self.check_letters(block, function, other_letters)?;
        if self.axes.plane != Plane::Zx {
            self.refuse_cycle_plane(block, function)?;
        }
        if let Some(word) = block.word(b'F') {
            self.feed_word(word, function)?;
        }
        if block.present() & SPEED_OR_TOOL != 0 || self.spindle_may_change(&codes, &auxiliary) {
            self.speed_and_tool(block, &codes, &auxiliary)?;
        }
        auxiliary.emit_before(self, block);
        if second != 0 {
            self.emit_second_auxiliary(block)?;
        }
        let waiting_corner = self.corner.is_some();
        let mut moves = false;
        let call = |word, code, environment| Call { block, environment, code, word };
        match codes.one_shot {
            Some(Code { id, code, word }) => {
                let word = &block.words[usize::from(word)];
                if waiting_corner && !function.in_figure {
                    return Err(self.corner_interrupted());
                }
                id.get().run(self, &mut call(Some(word), code, environment))?;
                self.modal.in_force.code(id, code, &self.dispatch);
                if !function.keeps_single_cycle {
                    self.forget_single_cycle();
                }
            }
            None => {
                let triggered = self.is_triggered(block, function, other_letters)
                    || (function.repeats && self.repeats_single_cycle(block, &auxiliary));
                moves = triggered;
                if triggered {
                    if waiting_corner && !function.in_figure {
                        return Err(self.corner_interrupted());
                    }
                    let word = codes.motion.map(|motion| &block.words[usize::from(motion.word)]);
                    function.run(self, &mut call(word, self.modal.motion_code, environment))?;
                }
            }
        }
        if block.present() & Block::bit(b'T') != 0 && self.owes_movement() {
            self.end_of_tool_block(block.word(b'T'))?;
        }
        if self.corner.is_some() {
            self.check_open_path()?;
        }
        if self.compensation.is_some() {
            self.check_compensation(!auxiliary.has_flow())?;
        }
        if auxiliary.acts_behind() | self.stops_once {
            self.behind_move(auxiliary, depth, block, environment)?;
        }
        if !self.macros.modal_calls.is_empty() && !self.is_capturing() && (moves || self.has_moves_to_give())
        {
            self.call_after_move(environment)?;
        }
        Ok(())
    }

    /// Whether the block in work gave moves out, or began a cycle that will.
    #[cold]
    fn has_moves_to_give(&self) -> bool {
        self.active.is_some() || self.out.iter().any(|command| command.action.end_point().is_some())
    }

    /// Whether the words of a block make a motion in force run; `other_letters` belong to modes and M words.
    #[inline]
    fn is_triggered(&self, block: &Block, function: &Function, other_letters: u32) -> bool {
        let letters = function.trigger | (self.axes.letters & function.other_axes);
        block.present() & letters & !other_letters != 0
            || (block.has_comma && function.draws_lines && self.gives_angle(block))
    }

    #[inline]
    fn sort_code(
        &mut self,
        block: &Block,
        place: usize,
        codes: &mut Codes,
    ) -> Result<Option<MacroCall>, Alarm> {
        let word = &block.words[place];
        let code = self.code(word)?;
        if let Some(call) = self.macros.calls.preparatory(code)
            && !self.is_called_by_code()
        {
            return Ok(Some(MacroCall::ByCode(call)));
        }
        let Some(id) = self.dispatch.function(code) else { return Err(self.refuse_code(code, word)) };
        let function = id.get();
        if !function.in_figure && self.is_in_figure() {
            return Err(self.refuse_in_figure(word));
        }
        if !function.in_rotation && self.transform.rotation.is_some() {
            return Err(self.alarm("rotation-code-illegal", word));
        }
        let new = Code { id, code, word: place as u8 };
        match function.kind {
            Kind::Call(kind) => return Ok(Some(MacroCall::ByWords(kind))),
            Kind::Mode(_) => {
                let group = self.dispatch.group(id);
                for (earlier, first) in &codes.modes[..codes.mode_count] {
                    if group != 0 && self.dispatch.group(*earlier) == group {
                        self.same_group(block, *first, word)?;
                    }
                }
                if codes.mode_count == CODES_MAX {
                    return Err(self.alarm("too-many-words", word));
                }
                let disputed = codes.mode_letters & function.letters & block.present();
                if disputed != 0 {
                    return Err(self.disputed_letter(block, disputed));
                }
                codes.modes[codes.mode_count] = (id, place as u8);
                codes.mode_count += 1;
                codes.mode_letters |= function.letters;
            }
            Kind::OneShot(_) => {
                if let Some(first) = codes.one_shot.replace(new) {
                    self.same_group(block, first.word, word)?;
                }
            }
            Kind::Motion(_) => {
                if let Some(first) = codes.motion.replace(new) {
                    self.same_group(block, first.word, word)?;
                }
            }
        }
        Ok(None)
    }

    /// A letter that two codes of the block would take as theirs.
    #[cold]
    fn disputed_letter(&self, block: &Block, letters: u32) -> Alarm {
        let word = block.words.iter().find(|word| !word.comma && letters & Block::bit(word.address) != 0);
        self.alarm_at("word-of-two-codes", word)
    }

    /// A coordinate setting and a work system in one block: on some controls the work system does not count.
    #[cold]
    fn drop_work_system(&mut self, block: &Block, codes: &mut Codes) {
        let is_setting = codes.one_shot.is_some_and(|one_shot| one_shot.id.get().takes_speed_limit);
        let places = block.present() & (AXES | self.axes.letters) != 0;
        if !is_setting || !places || self.control.policies.setting_beside_system == SettingBesideSystem::Both
        {
            return;
        }
        let modes = &codes.modes[..codes.mode_count];
        let is_system = |(id, _): &(FunctionId, u8)| self.dispatch.group(*id) == WORK_SYSTEMS;
        let Some(at) = modes.iter().position(is_system) else { return };
        self.warn("work-system-ignored", &block.words[usize::from(codes.modes[at].1)]);
        codes.modes.copy_within(at + 1..codes.mode_count, at);
        codes.mode_count -= 1;
    }

    /// A block whose G code calls a macro.
    #[cold]
    fn call_macro(
        &mut self,
        block: &Block,
        word: &Word,
        call: MacroCall,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        self.expects_program_number = false;
        match call {
            MacroCall::ByWords(kind) => self.macro_call(block, word, kind, environment),
            MacroCall::ByCode(call) => self.call_by_code(block, word, call, environment),
        }
    }

    /// A block whose first word is an M code that calls a macro, or whose T word calls one. False when it is none.
    #[cold]
    fn call_by_word(&mut self, block: &Block, environment: &mut dyn Environment) -> Result<bool, Alarm> {
        if self.is_called_by_code() || self.is_capturing() {
            return Ok(false);
        }
        let first = block.words.iter().find(|word| word.address != b'N');
        if let Some(word) = first
            && word.address == b'M'
            && let Some(program) = self.macros.calls.auxiliary(self.whole(word, 99_999_999)?)
        {
            self.call_by_code(block, word, (program, CallKind::Simple), environment)?;
            return Ok(true);
        }
        let Some(word) = block.word(b'T') else { return Ok(false) };
        let tool = self.whole(word, 99_999_999)?;
        if let Some(program) = self.macros.calls.tool(tool) {
            self.call_by_code(block, word, (program, CallKind::Simple), environment)?;
            return Ok(true);
        }
        Ok(false)
    }

    #[cold]
    fn refuse_code(&self, code: u16, word: &Word) -> Alarm {
        let functions = turnwright_control::Functions;
        let quote = self.quote(word.start, word.end);
        match functions.by_code(code, self.dispatch.system, self.control.code_table) {
            Some((name, entry)) => {
                let mut alarm = self.not_supported(name, word);
                alarm.key =
                    if entry.outside_scope { "function-outside-scope" } else { "function-undescribed" };
                alarm
            }
            None => {
                let diagnostic = Diagnostic::alarm("unusable-g-code").at(self.place(word));
                self.finish(diagnostic.with("code", quote.clone()).with("word", quote))
            }
        }
    }

    fn run_mode(
        &mut self,
        id: FunctionId,
        word: &Word,
        block: &Block,
        environment: &mut dyn Environment,
    ) -> Result<(), Alarm> {
        let code = self.code(word)?;
        id.get().run(self, &mut Call { block, environment, code, word: Some(word) })?;
        self.modal.in_force.code(id, code, &self.dispatch);
        Ok(())
    }

    #[inline(always)]
    pub(crate) fn change_motion(&mut self, id: FunctionId, code: u16) {
        if (self.modal.motion, self.modal.motion_code) != (id, code) {
            self.begin_motion(id, code);
        }
    }

    fn begin_motion(&mut self, id: FunctionId, code: u16) {
        if self.modal.motion != id {
            if id.get().is_hole_cycle || self.modal.hole.is_some() {
                self.change_hole_cycle(id, (self.modal.motion, self.modal.motion_code));
            }
            self.modal.motion = id;
            self.forget_single_cycle();
        }
        self.modal.motion_code = code;
        self.modal.in_force.code(id, code, &self.dispatch);
    }

    /// Every letter must belong to something in the block.
    #[inline]
    fn check_letters(&mut self, block: &Block, function: &Function, other_letters: u32) -> Result<(), Alarm> {
        let others = self.axes.letters & function.other_axes;
        let allowed = ALWAYS | AXES | others | function.letters | other_letters;
        let mut foreign = block.present() & !allowed;
        let is_idle =
            matches!(function.kind, Kind::Motion(_)) && !self.is_triggered(block, function, other_letters);
        if is_idle {
            // A motion that does not run takes no letters: `R5.` alone shapes nothing.
            foreign |= block.present() & function.letters & !other_letters;
        }
        if foreign != 0 {
            foreign &= !self.spindle_selection(block);
        }
        if foreign != 0 {
            return Err(self.foreign_letter(block, foreign, function));
        }
        if block.has_comma && (is_idle || !matches!(function.kind, Kind::Motion(_))) {
            return Err(self.comma_without_line(block));
        }
        Ok(())
    }

    /// P where it selects the spindle.
    #[cold]
    fn spindle_selection(&self, block: &Block) -> u32 {
        match block.word(b'P') {
            Some(word) if self.selects_spindle(word) => Block::bit(b'P'),
            _ => 0,
        }
    }

    /// A word behind a comma belongs to a straight cut with an end point.
    #[cold]
    fn comma_without_line(&self, block: &Block) -> Alarm {
        self.alarm_at("illegal-address", block.words.iter().find(|word| word.comma))
    }

    #[cold]
    fn foreign_letter(&self, block: &Block, foreign: u32, function: &Function) -> Alarm {
        let word = block.words.iter().find(|word| !word.comma && foreign & Block::bit(word.address) != 0);
        if let Some(word) = word
            && self.control.words_for_later(function.name).as_bytes().contains(&word.address)
        {
            return self.not_supported(function.name, word);
        }
        let is_axis = word.is_some_and(|word| self.axes.letters & Block::bit(word.address) != 0);
        let key = if function.is_multiple_cycle {
            "cycle-word-illegal"
        } else if function.is_single_cycle() && is_axis {
            "single-cycle-axis-illegal"
        } else if function.takes_lead && word.is_some_and(|word| self.breaks_corners(word)) {
            "corner-in-thread"
        } else {
            "illegal-address"
        };
        self.alarm_at(key, word)
    }

    fn spindle_may_change(&self, codes: &Codes, auxiliary: &Auxiliary) -> bool {
        auxiliary.spindle.is_some() || codes.mode_count > 0
    }

    /// By parameter a T word calls a program, which finds the number in a common variable.
    #[cold]
    fn call_by_tool(&mut self, block: &Block, auxiliary: &mut Auxiliary) -> Result<(), Alarm> {
        let (Some(program), Some(word)) = (self.macros.calls.any_tool, block.word(b'T')) else {
            return Ok(());
        };
        if self.is_called_by_code() || self.is_capturing() {
            return Ok(());
        }
        let tool = self.whole(word, 99_999_999)?;
        let held = self.macros.variables.slot(TOOL_VARIABLE);
        if let Some(slot) = held {
            self.macros.variables.set(slot, f64::from(tool));
        }
        if auxiliary.has_flow() {
            return Err(self.alarm("two-subprogram-calls", word));
        }
        let place = block.words.iter().position(|other| other.start == word.start).unwrap_or(0);
        auxiliary.flow = Some((Flow::CallProgram(program), place as u8));
        Ok(())
    }

    fn tool_calls_program(&self, auxiliary: &Auxiliary) -> bool {
        matches!(auxiliary.flow, Some((Flow::CallProgram(program), _)) if Some(program) == self.macros.calls.any_tool)
    }

    #[cold]
    fn speed_and_tool(&mut self, block: &Block, codes: &Codes, auxiliary: &Auxiliary) -> Result<(), Alarm> {
        if self.is_capturing() {
            return Ok(());
        }
        let limits_speed = codes.one_shot.is_some_and(|one_shot| one_shot.id.get().takes_speed_limit);
        if let Some(word) = block.word(b'S')
            && !limits_speed
        {
            self.check_speed_before_tap(block, word)?;
            self.speed_word(word)?;
        }
        if let Some(word) = block.word(b'T')
            && !self.tool_calls_program(auxiliary)
        {
            let refuses = self.settings.offsets.refuses_tool_in_setting;
            if refuses && codes.one_shot.is_some_and(|one_shot| one_shot.id.get().sets_data) {
                return Err(self.alarm("tool-not-allowed-here", word));
            }
            self.tool_word(word)?;
            self.refuse_nose_outside_plane(word)?;
        }
        if let Some(state) = auxiliary.spindle_before() {
            self.modal.spindle = state;
        }
        self.emit_spindle();
        if block.has(b'S') || auxiliary.spindle.is_some() {
            self.check_speed();
        }
        Ok(())
    }

    #[inline]
    pub(crate) fn sequence_number(&mut self, block: &Block, place: usize) -> Result<(), Alarm> {
        let word = &block.words[place];
        if place > 0 && block.words[place - 1].address != b'O' {
            self.warn("sequence-not-at-start", word);
        }
        let number = self.number(word)?;
        let Some(value) = self.plain_sequence(number) else {
            let key = if number.has_point {
                "point-not-allowed"
            } else if number.digits < 0 {
                "minus-not-allowed"
            } else {
                "number-too-long"
            };
            return Err(self.alarm(key, word));
        };
        self.at.sequence = Some(value);
        self.modal.in_force.sequence = Some(value);
        Ok(())
    }

    /// A sequence number that the control takes. Leading zeros are common; only the value counts.
    #[inline]
    pub(crate) fn plain_sequence(&self, number: Decimal) -> Option<u32> {
        let limit = POWER[usize::from(self.control.limits.sequence_digits.min(9))];
        let is_whole = !number.has_point && (0..limit).contains(&number.digits);
        is_whole.then_some(number.digits as u32)
    }

    fn program_number(&mut self, word: &Word, auxiliary: &Auxiliary) -> Result<(), Alarm> {
        if matches!(word.value, turnwright_syntax::Value::Missing) {
            // `O<NAME>`: the name is kept by the reader.
            return Ok(());
        }
        let number = self.whole(word, 99_999_999)?;
        if auxiliary.returns {
            return Ok(());
        }
        if !self.expects_program_number {
            // The next program begins here: the one before had no end.
            return self.end_of_record();
        }
        let digits = u32::from(self.control.limits.program_digits.min(8));
        let is_forbidden_zero = number == 0 && self.control.policies.program_zero == ProgramZero::Alarm;
        if is_forbidden_zero || number >= 10u32.pow(digits) {
            return Err(self.alarm("program-number-illegal", word));
        }
        self.program = Some(number);
        self.program_start = self.block_start();
        Ok(())
    }

    /// A code that acts once beside a motion code: it takes the axis words, or both are refused.
    #[cold]
    fn one_shot_with_motion(&self, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        match codes.one_shot {
            Some(Code { word, .. })
                if self.control.policies.one_shot_with_motion == OneShotWithMotion::Alarm =>
            {
                Err(self.alarm("one-shot-with-motion-code", &block.words[usize::from(word)]))
            }
            _ => Ok(()),
        }
    }

    /// Whether a single cycle in force runs again in a block without axis words.
    fn repeats_single_cycle(&mut self, block: &Block, auxiliary: &Auxiliary) -> bool {
        use turnwright_control::policy::SingleCycleRepeat;
        let acts = auxiliary.is_plain() || block.present() & SPEED_OR_TOOL != 0;
        let repeats = self.control.policies.single_cycle_repeat == SingleCycleRepeat::OnEveryBlock
            && acts
            && !auxiliary.has_flow()
            && (self.modal.cycle.x.is_some() || self.modal.cycle.z.is_some());
        if repeats {
            self.warn_block("cycle-still-active");
        }
        repeats
    }

    /// The length words of an X-like letter by role, for functions.
    pub(crate) fn optional_radius(
        &self,
        block: &Block,
        letter: u8,
        role: Role,
    ) -> Result<Option<turnwright_units::Radius>, Alarm> {
        block.word(letter).map(|word| self.radius(word, role)).transpose()
    }
}

const SPEED_OR_TOOL: u32 = Block::bit(b'S') | Block::bit(b'T');
