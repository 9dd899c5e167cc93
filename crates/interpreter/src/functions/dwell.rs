//! `dwell` — wait (G04).
//!
//! `G04 X_` or `U_` in seconds, `P_` in milliseconds without a point. Without a point X and U count
//! thousandths of a second, on controls with calculator input whole seconds; a value that looks as if its point
//! were forgotten is named. With feed per revolution and the parameter set, all three count spindle revolutions
//! instead, which need a spindle that turns. P counts before X, X before U. Without a word it is an exact stop: the
//! tool comes to rest and waits no time.
//!
//! `Q_` ends the dwell when that input comes on, where the control has such inputs.
//!
//! Source: dwell of both families.

use turnwright_canon::{Action, Dwell, SpindleState};
use turnwright_control::policy::{NegativeDwell, TurnDwellWithoutSpindle};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Decimal, Word};
use turnwright_units::{Revolutions, Seconds};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

pub(super) static DWELL: Function = Function::one_shot("dwell", dwell)
    .with_letters(b"PQ")
    .allowed_in_figure()
    .keeping_single_cycle()
    .setting_data()
    .allowed_in_rotation();

/// Longest dwell, in thousandths of a second.
const DWELL_MAX: i64 = 99_999_999;

/// A dwell by X or U without a point below this looks as if the point were forgotten, in thousandths.
const SUSPICIOUS_BELOW: i64 = 100;

fn dwell(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if let Some(word) = call.block.word(b'Z').or(call.block.word(b'W')) {
        return Err(core.alarm("illegal-address", word));
    }
    if let Some(word) = call.block.word(b'Q') {
        core.ending_input(word)?;
    }
    let time = call.block.word(b'P').or(call.block.word(b'X')).or(call.block.word(b'U'));
    let Some(word) = time else {
        core.emit(Action::Dwell(Dwell::Time(Seconds(0.0))));
        return Ok(());
    };
    let amount = core.thousandths(word)? as f64 / 1000.0;
    let in_turns = core.settings.dwell_in_revolutions && core.modal.feed_mode == FeedMode::PerRevolution;
    let dwell = if in_turns {
        core.check_turning(word)?;
        Dwell::Turns(Revolutions(amount))
    } else {
        Dwell::Time(Seconds(amount))
    };
    core.emit(Action::Dwell(dwell));
    Ok(())
}

impl Core {
    /// The amount of a dwell in thousandths of a second or of a revolution.
    fn thousandths(&mut self, word: &Word) -> Result<i64, Alarm> {
        let number = self.number(word)?;
        if number.is_negative && number.digits != 0 {
            if self.control.policies.negative_dwell == NegativeDwell::Alarm {
                return Err(self.alarm("minus-not-allowed", word));
            }
            self.warn("negative-dwell-as-zero", word);
            return Ok(0);
        }
        if word.address == b'P' {
            return self.whole(word, DWELL_MAX as u32).map(i64::from);
        }
        let is_whole_unit = number.has_point || self.settings.is_calculator;
        match number.scaled(if is_whole_unit { 3 } else { 0 }) {
            Some((value, _)) if value <= DWELL_MAX => {
                if !is_whole_unit {
                    self.check_dwell_point(word, number);
                }
                Ok(value)
            }
            _ => Err(self.alarm("number-too-long", word)),
        }
    }

    fn check_dwell_point(&mut self, word: &Word, number: Decimal) {
        if (1..SUSPICIOUS_BELOW).contains(&number.digits)
            && !self.already_said_at("dwell-without-point", word)
        {
            let quote = self.quote(word.start, word.end);
            let diagnostic = Diagnostic::warning("dwell-without-point").at(self.place(word));
            let seconds = format!("0.{:03}", number.digits);
            self.say(diagnostic.with("word", quote).with("seconds", seconds));
        }
    }

    /// A dwell in turns of a spindle that stands would never end.
    fn check_turning(&mut self, word: &Word) -> Result<(), Alarm> {
        if self.is_capturing() || (self.modal.spindle != SpindleState::Stop && self.present_rpm().0 > 0) {
            return Ok(());
        }
        if self.control.policies.turn_dwell_without_spindle == TurnDwellWithoutSpindle::Alarm {
            return Err(self.alarm("command-value-illegal", word));
        }
        self.warn("spindle-not-started-warning", word);
        Ok(())
    }

    /// The input that ends the dwell.
    fn ending_input(&mut self, word: &Word) -> Result<(), Alarm> {
        let inputs = u32::from(self.control.limits.dwell_inputs);
        match self.whole(word, 999)? {
            input if (1..=inputs).contains(&input) => {
                self.warn("dwell-until-input", word);
                Ok(())
            }
            _ => Err(self.alarm("skip-number-illegal", word)),
        }
    }
}
