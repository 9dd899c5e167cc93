//! `pattern-repeating` — the figure again and again, ever closer (G73; G75 in system C).
//!
//! `G73 U(Δi) W(Δk) R(d)`, then `G73 P(ns) Q(nf) U(Δu) W(Δw) F_`. Δi (radius) and Δk are the way from the last
//! pass to the first, with sign; d is the number of passes, a count: a point in it is taken with a warning.
//! The last pass lies at the allowances Δu (diameter) and Δw.
//!
//! Source: pattern repeating cycle of both families.

use turnwright_control::policy::SinglePatternPass;
use turnwright_cycles as cycles;
use turnwright_syntax::{Block, Word};
use turnwright_units::{Length, Radius};

use super::Function;
use super::one_block::Form;
use crate::block::Call;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static PATTERN_REPEATING: Function =
    Function::one_shot("pattern-repeating", pattern_repeating).with_letters(b"PQRDIK").multiple_cycle();

/// Most passes that the word takes.
const PASSES_MAX: i64 = 9_999;

fn pattern_repeating(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let form = core.cycle_form(call.block, b"DIK")?;
    if form != Form::TwoBlocks || call.block.has(b'P') || call.block.has(b'Q') {
        core.run_pattern(call, form)
    } else {
        core.store_pattern(call.block)
    }
}

impl Core {
    fn store_pattern(&mut self, block: &Block) -> Result<(), Alarm> {
        self.refuse_letters(block, b"XZDIK")?;
        if let Some(word) = block.word(b'U') {
            self.settings.pattern_relief_x = self.radius(word, Role::RadialDepth)?;
            self.missing_point(word);
            self.note_given("pattern-relief-x", word);
        }
        if let Some(word) = block.word(b'W') {
            self.settings.pattern_relief_z = self.length(word)?;
            self.missing_point(word);
            self.note_given("pattern-relief-z", word);
        }
        if let Some(word) = block.word(b'R') {
            self.settings.pattern_passes = self.pattern_passes(word)?;
            self.note_given("pattern-passes", word);
        }
        Ok(())
    }

    fn pattern_passes(&mut self, word: &Word) -> Result<u32, Alarm> {
        let number = self.number(word)?;
        let count = number.scaled(0).map_or(0, |(count, _)| count);
        if !(1..=PASSES_MAX).contains(&count) {
            return Err(self.alarm("pass-count-illegal", word));
        }
        if number.has_point {
            self.warn("count-with-point", word);
        }
        Ok(count as u32)
    }

    fn run_pattern(&mut self, call: &mut Call<'_>, form: Form) -> Result<(), Alarm> {
        self.refuse_letters(call.block, if form == Form::TwoBlocks { b"XZRDIK" } else { b"XZR" })?;
        let settings = &self.settings;
        let mut relief = (settings.pattern_relief_x, settings.pattern_relief_z);
        let mut passes = settings.pattern_passes;
        if form != Form::TwoBlocks {
            relief.0 = self.optional_radius(call.block, b'I', Role::RadialDepth)?.unwrap_or(relief.0);
            if call.block.has(b'K') {
                relief.1 = self.optional_length(call.block, b'K')?;
            }
            if let Some(word) = call.block.word(b'D') {
                passes = self.pattern_passes(word)?;
            }
        }
        let allowance_x = self.optional_radius(call.block, b'U', Role::XAllowance)?.unwrap_or(Radius::ZERO);
        let allowance_z =
            call.block.word(b'W').map(|word| self.length(word)).transpose()?.unwrap_or(Length::ZERO);
        for word in [call.block.word(b'U'), call.block.word(b'W')].into_iter().flatten() {
            self.missing_point(word);
        }
        if passes == 0 {
            return Err(self.alarm_at("pass-count-illegal", call.word));
        }
        let captured = self.capture_figure(call)?;
        self.remember_range(&captured);
        self.warn_allowance_signs(call, &captured.figure, None, (allowance_x, allowance_z));
        self.check_pattern(&captured, relief, call);
        let request = cycles::PatternRequest {
            context: self.cycle_context(captured.feed),
            relief_x: relief.0,
            relief_z: relief.1,
            passes,
            allowance_x,
            allowance_z,
            single_pass: match self.control.policies.single_pattern_pass {
                SinglePatternPass::Once => cycles::SinglePass::Once,
                SinglePatternPass::Twice => cycles::SinglePass::Twice,
            },
        };
        let (lines, behind) = (captured.lines(), captured.behind);
        let pattern = cycles::pattern(captured.figure, request).map_err(|fault| self.misuse(fault, call))?;
        self.start_cycle(CycleMoves::Pattern(Box::new(pattern)), call.code, lines, 0)?;
        self.go(behind, call.environment)
    }
}
