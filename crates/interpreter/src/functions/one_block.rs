//! Repetitive cycles with everything in one block, as the FANUC Series 10/11/15 wrote them, and as Haas does.
//!
//! `G71 P Q U W I K D F`, `G72` the same, `G73 P Q U W I K D F`, `G74`/`G75 X Z I K D F`, `G76 X Z I K D A F P Q`
//! (codes of system A). D is a depth of cut, a number of passes or a relief, I and K are distances along X (radius)
//! and along Z. What the block does not say comes from the parameters: escape, return, least depth, finishing
//! allowance and passes, run-out. Its words write no parameter.
//!
//! Parameter 0001#1 chooses the form. By policy a block in the other form is recognised by its letters, run, and said.
//! A D without a point counts least increments. The control refuses a point there; where the form was only
//! recognised, the program comes from a control that writes D0.05, and the point is taken.
//!
//! In the roughing cycles I and K are the allowance that a pass along the figure takes before G70: the rough passes
//! leave it beside U and W, then the tool goes from the start point along the figure, whatever 5105#1 says. R, where
//! the form was only recognised, is the escape; it needs its point, as `R1` chooses the type on Haas. Figures from
//! there end with a rapid move back to the start (`N20 G00 G40 Z0.1`), where a figure may not turn back: roughing
//! leaves it out where the form was only recognised. A template whose figure is still empty is said there and roughs
//! nothing.
//!
//! Source: cycles of both families, chapters 1.2, 10 and 13.

use turnwright_control::policy::CycleForm;
use turnwright_cycles as cycles;
use turnwright_syntax::{Block, Word};
use turnwright_units::{Length, Radius};

use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

/// How a cycle is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A block that stores, then a block that cuts.
    TwoBlocks,
    /// Everything in one block, as the parameter says.
    OneBlock,
    /// Everything in one block, against the parameter.
    OneBlockRecognised,
}

/// What a roughing cycle takes from its words or from the parameters.
pub(super) struct RoughWords {
    pub(super) depth: Length,
    pub(super) escape: Length,
    /// What the rough passes leave beside the finishing allowance.
    pub(super) semi_finish: Option<(Radius, Length)>,
}

impl Core {
    /// The form of a cycle's block; one of the `marks` makes it one block.
    pub(super) fn cycle_form(&mut self, block: &Block, marks: &[u8]) -> Result<Form, Alarm> {
        let mark = marks.iter().find_map(|letter| block.word(*letter));
        match (self.control.policies.cycle_form, self.settings.one_block_form, mark) {
            (CycleForm::Absent, ..) | (CycleForm::ByParameter, false, None) => Ok(Form::TwoBlocks),
            (CycleForm::ByParameter, false, Some(word)) => Err(self.alarm("cycle-word-illegal", word)),
            (CycleForm::ByParameter, true, _) | (CycleForm::Recognised, true, Some(_)) => Ok(Form::OneBlock),
            (CycleForm::Recognised, false, Some(word)) => {
                self.warn("cycle-form-recognised", word);
                Ok(Form::OneBlockRecognised)
            }
            (CycleForm::Recognised, _, None) => Ok(Form::TwoBlocks),
        }
    }

    /// Depth, escape and what the rough passes leave.
    pub(super) fn rough_words(&mut self, call: &Call<'_>, form: Form) -> Result<RoughWords, Alarm> {
        let (mut depth, mut escape) = (self.settings.cut_depth, self.settings.cut_escape);
        let mut semi_finish = None;
        if form != Form::TwoBlocks {
            let block = call.block;
            if let Some(word) = block.word(b'D') {
                depth = self.one_block_depth(word, form)?;
                if depth.signum() <= 0 {
                    return Err(self.alarm("cut-depth-illegal", word));
                }
            }
            if let Some(word) = block.word(b'R') {
                let has_point = self.number(word)?.has_point;
                if form == Form::OneBlock || !has_point {
                    return Err(self.alarm("cycle-word-illegal", word));
                }
                escape = self.unsigned_length(word)?;
            }
            if block.has(b'I') || block.has(b'K') {
                let x = self.optional_radius(block, b'I', Role::RadialDepth)?.unwrap_or(Radius::ZERO);
                semi_finish = Some((x, self.optional_length(block, b'K')?));
            }
        }
        if depth.signum() <= 0 {
            return Err(self.alarm_at("cut-depth-illegal", call.word));
        }
        Ok(RoughWords { depth, escape, semi_finish })
    }

    /// Leaves out rapid moves at the end of a figure that lead back along the cut.
    pub(super) fn leave_out_return(&self, figure: &mut cycles::Figure, along: cycles::CutAlong) {
        let tolerance = self.monotony_tolerance();
        while let Some(fault) = cycles::turn_back_fault(figure, along, tolerance)
            && fault.element as usize + 1 == figure.elements.len()
            && figure.elements.last().is_some_and(|last| last.motion == cycles::FigureMotion::Rapid)
        {
            figure.elements.pop();
        }
    }

    /// D as a length: least increments without a point.
    pub(super) fn one_block_depth(&mut self, word: &Word, form: Form) -> Result<Length, Alarm> {
        let has_point = self.number(word)?.has_point;
        if has_point && form == Form::OneBlockRecognised {
            self.length(word)
        } else {
            self.cycle_length(word)
        }
    }

    /// The length of a word, zero without it.
    pub(super) fn optional_length(&mut self, block: &Block, letter: u8) -> Result<Length, Alarm> {
        let Some(word) = block.word(letter) else { return Ok(Length::ZERO) };
        self.missing_point(word);
        self.length(word)
    }
}
