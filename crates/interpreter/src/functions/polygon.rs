//! `polygon-turning-on`, `polygon-turning-off` — flats turned by a driven cutter (G51.2, G50.2).
//!
//! `G51.2 P_ Q_` couples the rotation of a driven tool to the spindle: P turns of the spindle go with Q turns of
//! the tool, whole numbers, Q negative for the other direction. With P1 Q2 one blade leaves two flats, two
//! blades four. `G50.2` ends it, as does a reset. Each stands alone in its block. The cut itself is programmed as
//! usual.
//!
//! The function needs driven tools: a machine without them refuses it as a control without the option does.
//!
//! Source: polygon turning of both families.

use turnwright_canon::{Action, SpeedRatio};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::Word;

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;

pub(super) static POLYGON_ON: Function =
    Function::one_shot("polygon-turning-on", polygon_on).with_letters(b"PQ");
pub(super) static POLYGON_OFF: Function = Function::one_shot("polygon-turning-off", polygon_off);

/// Largest number of turns in a ratio.
const TURNS_MAX: i64 = 999;

fn polygon_on(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.stands_alone(call, POLYGON_ON.letters, "polygon-code-not-alone")?;
    if !core.axes.has_live_tools {
        return Err(core.option_missing(call.word));
    }
    let (Some(p), Some(q)) = (call.block.word(b'P'), call.block.word(b'Q')) else {
        return Err(core.alarm_at("polygon-ratio-illegal", call.word));
    };
    let spindle = core.turns(p)?;
    let other = core.turns(q)?;
    let Some(spindle) = u32::try_from(spindle).ok().filter(|turns| *turns > 0) else {
        return Err(core.alarm("polygon-ratio-illegal", p));
    };
    let ratio = SpeedRatio { spindle, other: other as i32 };
    if core.axes.coupling.replace(ratio) != Some(ratio) {
        core.emit(Action::Coupling(Some(ratio)));
    }
    Ok(())
}

fn polygon_off(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if core.axes.coupling.is_none() {
        return Ok(());
    }
    core.stands_alone(call, 0, "polygon-code-not-alone")?;
    core.axes.coupling = None;
    core.emit(Action::Coupling(None));
    Ok(())
}

impl Core {
    /// Whole turns of a ratio, signed and not zero.
    fn turns(&self, word: &Word) -> Result<i64, Alarm> {
        let number = self.number(word)?;
        if number.has_point {
            return Err(self.alarm("point-not-allowed", word));
        }
        if number.digits == 0 || number.digits.abs() > TURNS_MAX {
            return Err(self.alarm("polygon-ratio-illegal", word));
        }
        Ok(number.digits)
    }

    /// A code whose option the machine does not have.
    fn option_missing(&self, word: Option<&Word>) -> Alarm {
        let place = word.map_or_else(|| self.block_place(), |word| self.place(word));
        let quote = word.map_or_else(String::new, |word| self.quote(word.start, word.end));
        let diagnostic = Diagnostic::alarm("unusable-g-code").at(place);
        self.finish(diagnostic.with("code", quote.clone()).with("word", quote))
    }
}
