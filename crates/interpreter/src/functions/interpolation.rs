//! `polar-interpolation-on`, `polar-interpolation-off` (G12.1, G13.1), `polar-words-on`, `polar-words-off` (G16,
//! G15) and `cylindrical-interpolation` (G07.1) — milling on the face and round the circumference.
//!
//! **Polar**: from `G12.1` on, X and C are the axes of a plane across the spindle whose zero lies on the spindle
//! axis. X is a diameter as ever (a radius by 5450#6), C a length in millimetres as a radius value, and starts at 0 where C stands.
//! Two parameters name the axes by number (5460, 5461). Straight cuts, arcs (`R`, or `I J`), dwell, nose
//! compensation, macro calls and feed modes are allowed; positioning where the control has it. `G13.1` ends the
//! mode; X and C then count from where they really are.
//!
//! Where the control has them, `G16` gives points by radius (the word of X) and angle (the word of C, degrees),
//! `G15` ends that.
//!
//! **Cylindrical**: `G07.1 C_` gives the radius of a cylinder about Z; C moves are degrees as ever (or, with `K1`
//! where the control has it, millimetres on the surface), but run along the unrolled surface: F is the speed
//! there, and arcs of Z and C are arcs on it, by R only. `G07.1 C0` ends the mode. Where the control has the words
//! J K R L, the blocks between are a figure that is roughed in passes ([`cylinder_roughing`](super::cylinder_roughing)).
//!
//! Both begin alone in their blocks, without nose compensation, and in feed per minute where the control insists
//! on it. Cancelling what is not on does nothing.
//!
//! Source: polar and cylindrical interpolation of both families.

use turnwright_canon::{Action, Interpolation};
use turnwright_control::policy::{CylinderLengths, InterpolationFeed, PolarRapid, PolarTool};
use turnwright_syntax::{Block, Word};
use turnwright_units::Radius;

use super::{Function, FunctionId, letters};
use crate::axes::is_below;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::FeedMode;
use crate::report::Alarm;

pub(super) static POLAR_ON: Function = Function::one_shot("polar-interpolation-on", polar_on);
pub(super) static POLAR_OFF: Function = Function::one_shot("polar-interpolation-off", polar_off);
pub(super) static POLAR_WORDS_ON: Function =
    Function::mode("polar-words-on", |core, call| polar_words(core, call, true));
pub(super) static POLAR_WORDS_OFF: Function =
    Function::mode("polar-words-off", |core, call| polar_words(core, call, false));
pub(super) static CYLINDRICAL: Function =
    Function::one_shot("cylindrical-interpolation", cylindrical).with_letters(b"CHBYKRJL");

/// Functions that work in both kinds of virtual plane.
const IN_VIRTUAL_PLANES: &[&str] = &[
    "linear",
    "arc-clockwise",
    "arc-counter-clockwise",
    "dwell",
    "nose-compensation-off",
    "nose-compensation-left",
    "nose-compensation-right",
    "macro-call",
    "modal-macro-call",
    "macro-call-each-block",
    "modal-macro-cancel",
    "feed-per-minute",
    "feed-per-revolution",
];
const IN_POLAR_ONLY: &[&str] = &["polar-interpolation-off", "polar-words-on", "polar-words-off"];
const IN_CYLINDRICAL_ONLY: &[&str] = &["cylindrical-interpolation"];

fn polar_on(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.stands_alone(call, 0, "interpolation-not-alone")?;
    let axes = &core.axes.machine;
    let rotary = axes.c.as_ref().filter(|axis| u32::from(axis.number) == core.settings.polar_rotary_axis);
    if rotary.is_none() || core.settings.polar_linear_axis != X_NUMBER || core.axes.is_spindle {
        return Err(core.alarm_at("polar-axis-illegal", call.word));
    }
    core.may_start_interpolation(call)?;
    let is_below = is_below(core.modal.position.x);
    core.begin_interpolation(Interpolation::Polar { zero: core.axes.at.c, is_below });
    Ok(())
}

/// The number by which parameters name the X axis.
const X_NUMBER: u32 = 1;

fn polar_off(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if !matches!(core.axes.interpolation, Interpolation::Polar { .. }) {
        return Ok(());
    }
    core.stands_alone(call, 0, "interpolation-not-alone")?;
    core.refuse_end_in_compensation(call)?;
    core.leave_virtual_plane();
    Ok(())
}

fn polar_words(core: &mut Core, call: &mut Call<'_>, are_polar: bool) -> Result<(), Alarm> {
    let is_polar = matches!(core.axes.interpolation, Interpolation::Polar { .. });
    if are_polar && !is_polar {
        return Err(core.alarm_at("polar-words-outside", call.word));
    }
    if is_polar {
        core.stands_alone(call, 0, "interpolation-not-alone")?;
    }
    core.axes.polar_words = are_polar;
    Ok(())
}

fn cylindrical(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let block = call.block;
    let may_unroll = core.control.policies.cylinder_lengths == CylinderLengths::ByWord;
    core.refuse_cylinder_words(block, may_unroll)?;
    core.stands_alone(call, CYLINDRICAL.letters, "interpolation-not-alone")?;
    let has_axis = core.axes.machine.c.is_some() && !core.axes.is_spindle;
    let foreign = [b'B', b'Y'].into_iter().find_map(|letter| block.word(letter));
    let word = match (block.word(b'C'), block.word(b'H')) {
        (Some(word), None) | (None, Some(word)) if has_axis && foreign.is_none() => word,
        (one, other) => {
            let word = foreign.or(one.and(other)).or(one).or(other).or(call.word);
            return Err(core.alarm_at("cylindrical-axis-illegal", word));
        }
    };
    let radius = core.unsigned_length(word)?;
    core.missing_point(word);
    let is_on = matches!(core.axes.interpolation, Interpolation::Cylindrical { .. });
    if radius.is_zero() {
        if is_on {
            core.refuse_end_in_compensation(call)?;
            if !core.end_cylinder_pass(call)? {
                core.leave_virtual_plane();
            }
        }
        return Ok(());
    }
    if is_on || core.modal.motion == FunctionId::RAPID {
        return Err(core.alarm_at("cylindrical-code-illegal", call.word));
    }
    core.may_start_interpolation(call)?;
    let unrolled_words = match block.word(b'K').filter(|_| may_unroll) {
        None => false,
        Some(word) => core.whole(word, 1)? == 1,
    };
    let levels = if may_unroll { None } else { core.cylinder_levels(call)? };
    core.begin_interpolation(Interpolation::Cylindrical { radius: Radius(radius) });
    core.axes.unrolled_words = unrolled_words;
    match levels {
        Some(levels) => core.begin_cylinder_roughing(call, levels),
        None => Ok(()),
    }
}

impl Core {
    fn begin_interpolation(&mut self, interpolation: Interpolation) {
        self.axes.interpolate(interpolation);
        if matches!(interpolation, Interpolation::Polar { .. }) {
            self.settings.x_is_radius |= self.control.parameters.bit("polar-x-is-radius");
        }
        self.emit(Action::Interpolation(interpolation));
    }

    /// Nose compensation is off, and the feed is per minute where it must be.
    fn may_start_interpolation(&self, call: &Call<'_>) -> Result<(), Alarm> {
        let per_minute = self.control.policies.interpolation_feed == InterpolationFeed::Any
            || self.modal.feed_mode == FeedMode::PerMinute;
        if self.is_compensating() || !per_minute {
            return Err(self.alarm_at("interpolation-start-illegal", call.word));
        }
        Ok(())
    }

    /// Nose compensation that began in the mode ends in it.
    fn refuse_end_in_compensation(&self, call: &Call<'_>) -> Result<(), Alarm> {
        if self.is_compensating() {
            return Err(self.alarm_at("interpolation-end-in-compensation", call.word));
        }
        Ok(())
    }

    /// A code with its own words and nothing else.
    pub(super) fn stands_alone(&self, call: &Call<'_>, letters: u32, key: &'static str) -> Result<(), Alarm> {
        let own = call.word.map_or(0, |word| word.start);
        let foreign = call.block.words.iter().find(|word| match word.address {
            b'N' | b'O' => false,
            b'G' => word.start != own,
            letter => letters & Block::bit(letter) == 0,
        });
        match foreign {
            Some(word) => Err(self.alarm(key, word)),
            None => Ok(()),
        }
    }

    /// Refuses what the virtual plane in force does not allow, before anything in the block acts.
    #[cold]
    pub(crate) fn check_virtual_plane(&self, block: &Block) -> Result<(), Alarm> {
        let (key, only) = match self.axes.interpolation {
            Interpolation::Normal => return Ok(()),
            Interpolation::Polar { .. } => ("polar-code-illegal", IN_POLAR_ONLY),
            Interpolation::Cylindrical { .. } => ("cylindrical-code-illegal", IN_CYLINDRICAL_ONLY),
        };
        if let Some(word) = block.word(b'T')
            && matches!(self.axes.interpolation, Interpolation::Polar { .. })
            && self.control.policies.polar_tool == PolarTool::Alarm
        {
            return Err(self.alarm("polar-tool-word", word));
        }
        let rapid = key == "polar-code-illegal" && self.control.policies.polar_rapid == PolarRapid::Allowed;
        let is_allowed = |name: &str| {
            IN_VIRTUAL_PLANES.contains(&name) || only.contains(&name) || (name == "rapid" && rapid)
        };
        let mut has_motion = false;
        for word in block.words.iter().filter(|word| word.address == b'G') {
            let Some(id) = self.dispatch.function(self.code(word)?) else { continue };
            let function = id.get();
            has_motion |= !matches!(function.kind, super::Kind::Mode(_));
            if !is_allowed(function.name) {
                return Err(self.alarm(key, word));
            }
        }
        let moves = block.present() & (super::AXES | self.axes.letters) != 0;
        if moves && !has_motion && !is_allowed(self.modal.motion.get().name) {
            let is_axis = |word: &&Word| {
                (super::AXES | self.axes.letters) & letters(&[word.address]) != 0 && !word.comma
            };
            return Err(self.alarm_at(key, block.words.iter().find(is_axis)));
        }
        Ok(())
    }
}
