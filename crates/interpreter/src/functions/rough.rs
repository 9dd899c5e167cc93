//! `rough-turning`, `rough-facing` — stock removal along Z or X (G71, G72; G73, G74 in system C).
//!
//! `G71 U(Δd) R(e)`, then `G71 P(ns) Q(nf) U(Δu) W(Δw) F_`. The block with P and Q runs the cycle, the one
//! without stores depth and escape in the parameters, where they stay. Δd and e are radius values without sign,
//! Δu is a diameter with sign, Δw a length with sign. G72 has the depth in W and cuts along X. The form with
//! everything in one block is that of `one_block.rs`.
//!
//! Type I: the figure has no pockets and its first block names one axis (X for G71, Z for G72). Type II: the figure
//! may have pockets and its first block names both axes, if need be with W0 or U0; a 988 series control sees by the
//! figure itself, unless 5102#2 is set. On the 980 series `K1` asks for the check of monotony and `J1`, in type II,
//! for the last pass along the figure.
//!
//! Source: stock removal cycles of both families; policies of the control where they differ.

use turnwright_control::policy::{
    BottomEscape, CoincidentLevel, EscapeSpeed, FlatHump, LevelOrigin, MonotonyCheck, PocketLiftSpeed,
    PocketSemiFinish,
};
use turnwright_cycles as cycles;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Word};
use turnwright_units::{Length, Radius};

use super::Function;
use super::one_block::Form;
use crate::block::Call;
use crate::figure::Captured;
use crate::figure_checks::{RoughType, switches_on};
use crate::machine::{Core, GivenParameter};
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
    // I and K alone are those of the one-block form only where no other block has given the depth.
    let runs = call.block.has(b'P') || call.block.has(b'Q');
    let marks: &[u8] = if runs && !core.settings.has_roughing_data { b"DIK" } else { b"D" };
    let form = core.cycle_form(call.block, marks)?;
    if runs || form != Form::TwoBlocks {
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

    /// Remembers which word wrote a parameter.
    pub(super) fn note_given(&mut self, parameter: &'static str, word: &Word) {
        let given = GivenParameter {
            parameter,
            word: self.quote(word.start, word.end),
            place: self.place(word),
            source: self.at.source,
            line: self.at.line,
        };
        match self.given.iter_mut().find(|other| other.parameter == parameter) {
            Some(other) => *other = given,
            None => self.given.push(given),
        }
    }

    /// The block without P and Q.
    fn store_roughing(&mut self, block: &Block, along: cycles::CutAlong) -> Result<(), Alarm> {
        let (depth, foreign): (u8, &[u8]) = match along {
            cycles::CutAlong::Z => (b'U', b"XZWJKDI"),
            cycles::CutAlong::X => (b'W', b"XZUJKDI"),
        };
        self.refuse_letters(block, foreign)?;
        self.settings.has_roughing_data = true;
        if let Some(word) = block.word(depth) {
            let value = self.radius(word, Role::RadialDepth)?.0;
            self.missing_point(word);
            if value.signum() <= 0 {
                return Err(self.alarm("cut-depth-illegal", word));
            }
            self.settings.cut_depth = value;
            self.note_given("cycle-depth-of-cut", word);
        }
        if let Some(word) = block.word(b'R') {
            self.settings.cut_escape = self.unsigned_length(word)?;
            self.note_given("cycle-escape", word);
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
        let mut captured = self.capture_figure(call)?;
        self.remember_range(&captured);
        if form == Form::OneBlockRecognised {
            self.leave_out_return(&mut captured.figure, along);
        }
        self.check_blank_side(&captured.figure, along, call)?;
        let kind = self.rough_type(&captured, along)?;
        self.check_figure(&captured, kind, along, (allowance_x, allowance_z), call)?;
        let policies = &self.control.policies;
        let rough = cycles::RoughRequest {
            context: self.cycle_context(captured.feed),
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
            semi_finish: match kind {
                RoughType::One => !self.settings.no_semi_finish,
                RoughType::Two => self.semi_finishes_pockets(call.block),
            },
            monotony: cycles::Monotony::Ignore,
        };
        let (lines, behind) = (captured.lines(), captured.behind);
        let figure = captured.figure;
        let moves = match (kind, words.semi_finish) {
            (RoughType::One, None) => {
                cycles::rough(figure, rough).map(|cycle| CycleMoves::Roughing(Box::new(cycle)))
            }
            (RoughType::One, Some((x, z))) => cycles::rough_and_semi_finish(figure, rough, x, z)
                .map(|cycle| CycleMoves::SemiFinished(Box::new(cycle))),
            (RoughType::Two, None) => cycles::rough_pockets(figure, self.pocket_request(rough))
                .map(|cycle| CycleMoves::Pockets(Box::new(cycle))),
            (RoughType::Two, Some((x, z))) => {
                cycles::rough_pockets_and_semi_finish(figure, self.pocket_request(rough), x, z)
                    .map(|cycle| CycleMoves::SemiFinishedPockets(Box::new(cycle)))
            }
        };
        match moves {
            Err(cycles::Misuse::NoContour) if form == Form::OneBlockRecognised => {
                self.warn_block("empty-figure");
            }
            moves => {
                let moves = moves.map_err(|fault| self.misuse(fault, call))?;
                self.start_cycle(moves, call.code, lines, 0)?;
            }
        }
        self.go(behind, call.environment)
    }

    fn pocket_request(&self, rough: cycles::RoughRequest) -> cycles::PocketRequest {
        let policies = &self.control.policies;
        cycles::PocketRequest {
            rough,
            tolerance: self.monotony_tolerance(),
            clearance: self.settings.pocket_clearance,
            hump: match policies.flat_hump {
                FlatHump::AlongContour => cycles::Hump::AlongContour,
                FlatHump::ExtraLevel => cycles::Hump::ExtraLevel,
            },
            bottom_escape: match policies.bottom_escape {
                BottomEscape::ByParameter if !self.settings.follows_pocket_bottom => {
                    cycles::BottomEscape::Diagonal
                }
                BottomEscape::Follow | BottomEscape::ByParameter => cycles::BottomEscape::Follow,
            },
            lift_speed: match policies.pocket_lift_speed {
                PocketLiftSpeed::Feed => cycles::EscapeSpeed::Feed,
                PocketLiftSpeed::Rapid => cycles::EscapeSpeed::Rapid,
            },
        }
    }

    /// Whether roughing with pockets ends with the pass along the figure.
    fn semi_finishes_pockets(&self, block: &Block) -> bool {
        match self.control.policies.pocket_semi_finish {
            PocketSemiFinish::ByParameter => !self.settings.no_pocket_semi_finish,
            PocketSemiFinish::ByWord => switches_on(block, b'J'),
        }
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
        self.roughed.push(captured.roughed());
    }

    /// The alarm of the control for what a cycle refused.
    pub(super) fn misuse(&self, fault: cycles::Misuse, call: &Call<'_>) -> Alarm {
        use cycles::Misuse;
        // Of a value that the block that stores has given, the word there is meant.
        let stored = match fault {
            Misuse::MinDepthNegative | Misuse::MinDepthAboveHeight => "thread-minimum-depth",
            Misuse::AllowanceNegative | Misuse::AllowanceNotBelowHeight => "thread-finishing-allowance",
            Misuse::NoseAngle if !call.block.has(b'A') => "thread-nose-angle",
            Misuse::RetractNegative => "groove-return",
            Misuse::EscapeNegative => "cycle-escape",
            _ => "",
        };
        let given = self.given.iter().find(|given| given.parameter == stored);
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
        match given {
            Some(given) => {
                let near = call.word.map_or_else(|| self.block_place(), |word| self.place(word));
                self.finish(Diagnostic::alarm(key).at(given.place).near(near, "cycle-that-runs"))
            }
            None => self.alarm_at(key, word),
        }
    }
}
