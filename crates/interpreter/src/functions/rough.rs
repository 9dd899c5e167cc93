//! `rough-turning`, `rough-facing` — stock removal along Z or X (G71, G72; G73, G74 in system C).
//!
//! `G71 U(Δd) R(e)`, then `G71 P(ns) Q(nf) U(Δu) W(Δw) F_`. The block with P and Q runs the cycle, the one
//! without stores depth and escape in the parameters, where they stay. Δd and e are radius values without sign,
//! Δu is a diameter with sign, Δw a length with sign. G72 has the depth in W and cuts along X. The form with
//! everything in one block is that of `one_block.rs`.
//!
//! Type I here: the figure has no pockets and its first block names one axis (X for G71, Z for G72).
//!
//! Source: stock removal cycles of both families; policies of the control where they differ.

use turnwright_control::policy::{
    CoincidentLevel, CycleType, EscapeSpeed, LevelOrigin, MonotonyCheck, TypeTwo,
};
use turnwright_cycles as cycles;
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_syntax::Block;
use turnwright_units::{Length, Position, Radius, WorkTip};

use super::Function;
use super::one_block::Form;
use crate::block::Call;
use crate::figure::Captured;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static ROUGH_TURNING: Function =
    Function::one_shot("rough-turning", |core, call| rough(core, call, cycles::CutAlong::Z))
        .with_letters(LETTERS)
        .multiple_cycle();

pub(super) static ROUGH_FACING: Function =
    Function::one_shot("rough-facing", |core, call| rough(core, call, cycles::CutAlong::X))
        .with_letters(LETTERS)
        .multiple_cycle();

const LETTERS: &[u8] = b"PQRDJKI";

fn rough(core: &mut Core, call: &mut Call<'_>, along: cycles::CutAlong) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let form = core.cycle_form(call.block, b"DIK")?;
    if form != Form::TwoBlocks || call.block.has(b'P') || call.block.has(b'Q') {
        core.run_roughing(call, along, form)
    } else {
        core.store_roughing(call.block, along)
    }
}

impl Core {
    /// Refuses letters that the block in hand does not take.
    pub(super) fn refuse_letters(&self, block: &Block, letters: &[u8]) -> Result<(), Alarm> {
        match letters.iter().find_map(|letter| block.word(*letter)) {
            Some(word) => Err(self.alarm("cycle-word-illegal", word)),
            None => Ok(()),
        }
    }

    /// The block without P and Q.
    fn store_roughing(&mut self, block: &Block, along: cycles::CutAlong) -> Result<(), Alarm> {
        let (depth, foreign): (u8, &[u8]) = match along {
            cycles::CutAlong::Z => (b'U', b"XZWJKDI"),
            cycles::CutAlong::X => (b'W', b"XZUJKDI"),
        };
        self.refuse_letters(block, foreign)?;
        if let Some(word) = block.word(depth) {
            let value = self.radius(word, Role::RadialDepth)?.0;
            self.missing_point(word);
            if value.signum() <= 0 {
                return Err(self.alarm("cut-depth-illegal", word));
            }
            self.settings.cut_depth = value;
        }
        if let Some(word) = block.word(b'R') {
            self.settings.cut_escape = self.unsigned_length(word)?;
            self.missing_point(word);
        }
        Ok(())
    }

    /// The block with P and Q.
    fn run_roughing(
        &mut self,
        call: &mut Call<'_>,
        along: cycles::CutAlong,
        form: Form,
    ) -> Result<(), Alarm> {
        let by_word = self.control.policies.monotony_check == MonotonyCheck::ByWord;
        let foreign: &[u8] = match form {
            Form::TwoBlocks if by_word => b"XZRDI",
            Form::TwoBlocks => b"XZRDIJK",
            Form::OneBlock | Form::OneBlockRecognised => b"XZJ",
        };
        self.refuse_letters(call.block, foreign)?;
        let allowance_x = self.optional_radius(call.block, b'U', Role::XAllowance)?.unwrap_or(Radius::ZERO);
        let allowance_z =
            call.block.word(b'W').map(|word| self.length(word)).transpose()?.unwrap_or(Length::ZERO);
        for word in [call.block.word(b'U'), call.block.word(b'W')].into_iter().flatten() {
            self.missing_point(word);
        }
        let words = self.rough_words(call, form)?;
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        let checks = self.checks_monotony(call.block);
        let captured = self.capture_figure(call)?;
        self.remember_range(&captured);
        self.check_first_block(&captured, along, call)?;
        self.check_figure(&captured, along, (allowance_x, allowance_z), checks, call)?;
        let policies = &self.control.policies;
        let request = cycles::RoughRequest {
            context: self.cycle_context(feed),
            along,
            depth: words.depth,
            escape: words.escape,
            allowance_x,
            allowance_z,
            coincident: match policies.coincident_level {
                CoincidentLevel::Through => cycles::Coincident::Through,
                CoincidentLevel::Stop => cycles::Coincident::Stop,
            },
            level_origin: match policies.level_origin {
                LevelOrigin::ShiftedStart => cycles::LevelOrigin::ShiftedStart,
                LevelOrigin::Start => cycles::LevelOrigin::Start,
            },
            escape_speed: match policies.escape_speed {
                _ if self.settings.rapid_escape => cycles::EscapeSpeed::Rapid,
                EscapeSpeed::Feed => cycles::EscapeSpeed::Feed,
                EscapeSpeed::Rapid => cycles::EscapeSpeed::Rapid,
            },
            semi_finish: !self.settings.no_semi_finish,
            monotony: cycles::Monotony::Ignore,
        };
        let (lines, behind) = (captured.lines(), captured.behind);
        let figure = captured.figure;
        let moves = match words.semi_finish {
            None => cycles::rough(figure, request).map(|cycle| CycleMoves::Roughing(Box::new(cycle))),
            Some((x, z)) => cycles::rough_and_semi_finish(figure, request, x, z)
                .map(|cycle| CycleMoves::SemiFinished(Box::new(cycle))),
        };
        let moves = moves.map_err(|fault| self.misuse(fault, call))?;
        self.start_cycle(moves, call.code, lines, 0)?;
        self.go(behind, call.environment)
    }

    /// What cycles take from the state of the program.
    pub(super) fn cycle_context(&self, feed: turnwright_units::Feed) -> cycles::Context {
        cycles::Context {
            start: self.modal.position,
            increment: self.modal.increment(&self.settings),
            feed,
            rapid: self.rapid_path(),
        }
    }

    /// The finishing cycle should name the same figure.
    pub(super) fn remember_range(&mut self, captured: &Captured) {
        const REMEMBERED: usize = 3;
        if self.finished_first.contains(&captured.first_place.line) {
            self.warn_block("finishing-before-roughing");
        }
        if self.roughed.len() == REMEMBERED {
            self.roughed.remove(0);
        }
        self.roughed.push((captured.range.first, captured.range.last));
    }

    /// The axes in the figure's first block choose the type.
    fn check_first_block(
        &self,
        captured: &Captured,
        along: cycles::CutAlong,
        call: &Call<'_>,
    ) -> Result<(), Alarm> {
        let (depth, other) = match along {
            cycles::CutAlong::Z => (captured.first_has_x, captured.first_has_z),
            cycles::CutAlong::X => (captured.first_has_z, captured.first_has_x),
        };
        let automatic = self.control.policies.cycle_type == CycleType::ByTypeParameter
            && !self.settings.type_by_first_block;
        let has_pockets = || cycles::monotony_fault(&captured.figure, along, self.half_increment()).is_some();
        let start_axis = || {
            let expected = if along == cycles::CutAlong::Z { "X" } else { "Z" };
            let diagnostic = Diagnostic::alarm("figure-start-axis").at(captured.first_place);
            let word = format!("N{}", captured.range.first);
            self.finish(
                diagnostic
                    .with("word", word)
                    .with("expected", expected)
                    .near(captured.range.first_place, "figure-range-here"),
            )
        };
        let type_two = || {
            let diagnostic = Diagnostic::error("type-two-not-supported-yet").at(captured.first_place);
            let code = call.word.map_or(String::new(), |word| self.quote(word.start, word.end));
            Err(self.finish(diagnostic.with("code", code).with("word", format!("N{}", captured.range.first))))
        };
        match (depth, other) {
            (true, false) if automatic && has_pockets() => type_two(),
            (true, false) => Ok(()),
            (false, _) => Err(start_axis()),
            (true, true) if automatic && !has_pockets() => Ok(()),
            (true, true) if self.control.policies.type_two == TypeTwo::Alarm => Err(start_axis()),
            (true, true) => type_two(),
        }
    }

    fn half_increment(&self) -> Length {
        Length::from_nm(self.modal.increment(&self.settings).nm() / 2)
    }

    /// Whether this control refuses a figure that turns back.
    fn checks_monotony(&self, block: &Block) -> bool {
        match self.control.policies.monotony_check {
            MonotonyCheck::ByFigureCheck => self.settings.figure_check,
            MonotonyCheck::ByMonotonyBit => self.settings.monotony_check,
            MonotonyCheck::ByMonotonyBits => {
                self.settings.monotony_check && self.settings.type_by_first_block
            }
            MonotonyCheck::ByWord => block.word(b'K').is_some_and(
                |word| matches!(word.value, turnwright_syntax::Value::Number(number) if number.digits != 0),
            ),
        }
    }

    /// Figures that turn back, or reach beyond the start point.
    fn check_figure(
        &mut self,
        captured: &Captured,
        along: cycles::CutAlong,
        (allowance_x, allowance_z): (Radius, Length),
        checks: bool,
        call: &Call<'_>,
    ) -> Result<(), Alarm> {
        if let Some(fault) = cycles::monotony_fault(&captured.figure, along, self.half_increment()) {
            let place = self.element_place(captured, fault.element);
            let key = match fault.axis {
                cycles::PlaneAxis::First => "figure-not-monotone-z",
                cycles::PlaneAxis::Second => "figure-not-monotone-x",
            };
            if checks {
                return Err(self.finish(Diagnostic::alarm(key).at(place)));
            }
            let axis = if fault.axis == cycles::PlaneAxis::First { "Z" } else { "X" };
            if !self.already_said("figure-not-monotone-warning", place.line) {
                self.say(Diagnostic::warning("figure-not-monotone-warning").at(place).with("name", axis));
            }
        }
        let warned =
            self.warn_allowance_signs(call, &captured.figure, Some(along), (allowance_x, allowance_z));
        if let Some(fault) = cycles::start_inside_fault(&captured.figure, along, allowance_x, allowance_z) {
            let place = self.element_place(captured, fault.element);
            if self.settings.figure_check {
                return Err(self.finish(Diagnostic::alarm("figure-beyond-start").at(place)));
            }
            if !warned && !self.already_said("figure-beyond-start-warning", place.line) {
                self.say(Diagnostic::warning("figure-beyond-start-warning").at(place));
            }
        }
        Ok(())
    }

    /// Warns about allowances that lead into the part; true when it did. The part lies where the infeed goes, or
    /// on an axis without infeed towards the furthest point of the figure; an allowance must point back.
    pub(super) fn warn_allowance_signs(
        &mut self,
        call: &Call<'_>,
        figure: &cycles::Figure,
        along: Option<cycles::CutAlong>,
        (allowance_x, allowance_z): (Radius, Length),
    ) -> bool {
        let start = figure.start;
        let way = |is_infeed: bool, way: fn(&cycles::Element, Position<WorkTip>) -> Length| {
            let reach = if is_infeed { 1 } else { figure.elements.len() };
            let ways = figure.elements.iter().take(reach).map(|element| way(element, start));
            ways.max_by_key(|way| way.abs()).unwrap_or_default()
        };
        let x = way(along == Some(cycles::CutAlong::Z), |element, start| (element.to.x - start.x).0);
        let z = way(along == Some(cycles::CutAlong::X), |element, start| element.to.z - start.z);
        let mut warned = false;
        for (allowance, way, letter) in [(allowance_x.0, x, b'U'), (allowance_z, z, b'W')] {
            if allowance.signum() * way.signum() > 0
                && let Some(word) = call.block.word(letter)
            {
                self.warn("allowance-sign", word);
                warned = true;
            }
        }
        warned
    }

    /// The line of a figure's element; its bytes are not at hand any more, so the whole line is meant.
    fn element_place(&self, captured: &Captured, element: u32) -> Place {
        let line =
            captured.figure.elements.get(element as usize).map_or(self.at.line, |element| element.line);
        Place { source: self.at.source, line, line_offset: u64::MAX, column: 1, end_column: 1 }
    }

    /// The alarm of the control for what a cycle refused.
    pub(super) fn misuse(&self, fault: cycles::Misuse, call: &Call<'_>) -> Alarm {
        use cycles::Misuse;
        let letter = |letter: u8| call.block.word(letter).or(call.word);
        let (key, word) = match fault {
            Misuse::OutOfRange => ("number-too-long", call.word),
            Misuse::StartMismatch => ("figure-start-mismatch", call.word),
            Misuse::NoContour => ("figure-without-contour", letter(b'Q')),
            Misuse::DepthNotPositive => ("cut-depth-illegal", call.word),
            Misuse::BelowIncrement => ("depth-below-increment", call.word),
            Misuse::EscapeNegative | Misuse::RetractNegative => ("minus-not-allowed", letter(b'R')),
            Misuse::NotMonotone(_) => ("figure-not-monotone-x", call.word),
            Misuse::PassesZero => ("pass-count-illegal", letter(b'R')),
            Misuse::PeckNegative | Misuse::StepNegative => ("groove-step-negative", letter(b'P')),
            Misuse::StepZero => ("groove-step-zero", call.word),
            Misuse::ReliefNegative => ("groove-relief-negative", letter(b'R')),
            Misuse::NoThread => ("thread-length-illegal", letter(b'Z')),
            Misuse::LeadNotPositive => ("lead-missing", letter(b'F')),
            Misuse::HeightNotPositive => ("thread-height-or-depth-illegal", letter(b'P')),
            Misuse::FirstDepthNotPositive => ("thread-height-or-depth-illegal", letter(b'Q')),
            Misuse::MinDepthNegative | Misuse::MinDepthAboveHeight => {
                ("thread-minimum-depth-illegal", call.word)
            }
            Misuse::AllowanceNegative | Misuse::AllowanceNotBelowHeight => {
                ("thread-finishing-allowance-illegal", letter(b'P'))
            }
            Misuse::FinishingPassesZero => ("thread-finishing-passes-illegal", call.word),
            Misuse::NoseAngle => ("thread-angle-illegal", letter(b'P')),
            Misuse::ThreadTooShort => ("thread-length-illegal", letter(b'Z')),
            Misuse::RunOutNegative | Misuse::RunOutAngle => ("run-out-illegal", call.word),
        };
        self.alarm_at(key, word)
    }
}
