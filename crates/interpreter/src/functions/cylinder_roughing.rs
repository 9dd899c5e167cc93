//! The second type of `cylindrical-interpolation`: `G07.1 C_ J_ K_ R_ L_`, the blocks of a figure, `G07.1 C0` — the
//! figure is cut in passes, each a little deeper in X.
//!
//! J is the whole depth of roughing across the axis, with the sign of the way in (by policy), K the allowance that
//! the last pass takes, R how far above the uncut surface the tool goes back, L the number of roughing cuts; the
//! pass of the figure itself is one more. All four words are needed; K may be zero.
//!
//! From where the tool stands X goes at rapid to the start of the cycle, R above the surface. Each pass goes down at
//! feed, along the figure, out to the level of the start at rapid, and then with Z and the rotary axis together back
//! to the start. The cuts are equally deep; each level is computed from the surface and rounded once. In a pass the
//! X words of the figure are moved by the distance of its level from the figure. Behind `G07.1 C0` the tool stands
//! at the start of the cycle. The blocks run as they stand: their M codes act in every pass, every pass begins with
//! the modes of the first.
//!
//! The tool goes out before it goes back: going back straight from the groove would cross its walls, and the help
//! gives the end of the way out no number of its pass, so it is the same level for all.
//!
//! Not told by any text at hand, and so policies: whether the tool stands at the bottom or at the surface when the
//! cycle begins, whether J counts the allowance in, its sign, and which of the words are diameters. A warning with the
//! diameters of surface and last pass says what was taken.
//!
//! Source: programming help of the 980TDi, version 6.10.

use turnwright_canon::{Action, CycleLabel, CycleOrigin, OtherAxes, Phase, RapidPath, Shape};
use turnwright_control::policy::{
    CylinderRoughing as Place, CylinderRoughingSign, CylinderRoughingTotal, CylinderRoughingWords,
};
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::{Block, Word};
use turnwright_units::{Angle, Length, Position, Radius, WorkTip};

use super::FunctionId;
use crate::auxiliary::{Auxiliary, Flow};
use crate::block::Call;
use crate::flow::Resume;
use crate::in_force::GROUPS;
use crate::machine::{BlockPlace, Core};
use crate::modal::FeedMode;
use crate::report::Alarm;
use crate::words::Role;

/// The words that ask for it.
const WORDS: &[u8] = b"JKRL";

/// Most roughing cuts.
const CUTS_MAX: u32 = 9_999;

/// What every pass begins with.
#[derive(Clone, Debug)]
struct Modes {
    motion: FunctionId,
    motion_code: u16,
    feed: Option<Length>,
    feed_mode: FeedMode,
    codes: [Option<u16>; GROUPS],
}

/// Where the levels lie, radii.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    /// Where X stood when the cycle began: the figure is written from there.
    written: Radius,
    surface: Radius,
    /// The last pass.
    figure: Radius,
    start: Radius,
    /// From the surface to the deepest roughing cut.
    roughing: Length,
    cuts: u32,
}

/// A figure on the cylinder that is roughed.
#[derive(Debug)]
pub(crate) struct CylinderRoughing {
    /// The first block of the figure.
    begin: Resume,
    /// The block that asked for it.
    pub(crate) at: BlockPlace,
    code: u16,
    /// Calls in work around it.
    depth: usize,
    modes: Modes,
    levels: Levels,
    start: Position<WorkTip>,
    c: Angle,
    v: Length,
    pass: u32,
    level: Radius,
}

impl CylinderRoughing {
    /// From where the figure is written to the pass in work.
    pub(crate) fn shift(&self) -> Radius {
        self.level - self.levels.written
    }

    fn is_last(&self) -> bool {
        self.pass > self.levels.cuts
    }
}

impl Core {
    /// The levels that the words of a block ask for; `None` without such words.
    pub(super) fn cylinder_levels(&mut self, call: &Call<'_>) -> Result<Option<Levels>, Alarm> {
        let block = call.block;
        if WORDS.iter().all(|letter| !block.has(*letter)) {
            return Ok(None);
        }
        let [Some(depth), Some(allowance), Some(retract), Some(cuts)] =
            [b'J', b'K', b'R', b'L'].map(|letter| block.word(letter))
        else {
            return Err(self.alarm_at("cylinder-roughing-incomplete", call.word));
        };
        let policies = &self.control.policies;
        let (depth_role, allowance_role) = match policies.cylinder_roughing_words {
            CylinderRoughingWords::AsInPattern => (Role::RadialDepth, Role::XAllowance),
            CylinderRoughingWords::Radii => (Role::RadialDepth, Role::RadialDepth),
            CylinderRoughingWords::Diameters => (Role::XAllowance, Role::XAllowance),
        };
        let total = self.radius(depth, depth_role)?;
        let cut_count = self.whole(cuts, CUTS_MAX)?;
        for (word, is_zero) in [(depth, total.0.is_zero()), (cuts, cut_count == 0)] {
            if is_zero {
                return Err(self.alarm("cylinder-roughing-zero", word));
            }
        }
        self.unsigned_length(allowance)?;
        self.unsigned_length(retract)?;
        let left = self.radius(allowance, allowance_role)?;
        let above = self.radius(retract, depth_role)?;
        let inward = match policies.cylinder_roughing_sign {
            CylinderRoughingSign::WayIn => total.0.signum(),
            CylinderRoughingSign::WayOut => -total.0.signum(),
        };
        let roughing = match policies.cylinder_roughing_total {
            CylinderRoughingTotal::WithoutAllowance => total.0.abs(),
            CylinderRoughingTotal::WithAllowance => total.0.abs() - left.0,
        };
        if roughing.signum() <= 0 {
            return Err(self.alarm("cylinder-roughing-zero", allowance));
        }
        let signed = |length: Length| if inward < 0 { -length } else { length };
        let written = self.modal.position.x;
        let way = Radius(signed(roughing + left.0));
        let (surface, figure) = match policies.cylinder_roughing {
            Place::SurfaceAtStart => (written, written + way),
            Place::FigureAtStart | Place::Absent => (written - way, written),
        };
        let start = surface - Radius(signed(above.0));
        let side = written.0.signum();
        if [surface, figure, start].iter().any(|level| level.0.signum() != side) {
            return Err(self.alarm("cylinder-roughing-crosses-axis", depth));
        }
        Ok(Some(Levels { written, surface, figure, start, roughing: signed(roughing), cuts: cut_count }))
    }

    /// Cylindrical interpolation has begun: the tool goes to the start of the cycle and down to the first level.
    pub(super) fn begin_cylinder_roughing(&mut self, call: &Call<'_>, levels: Levels) -> Result<(), Alarm> {
        if !self.macros.modal_calls.is_empty() {
            return Err(self.alarm_at("cylindrical-code-illegal", call.word));
        }
        self.tell_cylinder_levels(levels);
        let modal = &self.modal;
        let roughing = CylinderRoughing {
            begin: self.resume(),
            at: self.at,
            code: call.code,
            depth: self.frames.len(),
            modes: Modes {
                motion: modal.motion,
                motion_code: modal.motion_code,
                feed: modal.feed,
                feed_mode: modal.feed_mode,
                codes: modal.in_force.codes,
            },
            levels,
            start: Position::new(levels.start, modal.position.z),
            c: self.axes.at.c,
            v: self.axes.v,
            pass: 0,
            level: levels.surface,
        };
        let start = roughing.start;
        self.cylinder_roughing = Some(Box::new(roughing));
        self.cylinder_phase(Phase::Approach);
        self.cylinder_rapid(start, OtherAxes::default())?;
        self.next_cylinder_pass(call)
    }

    fn tell_cylinder_levels(&mut self, levels: Levels) {
        if self.already_said("cylinder-roughing-read", self.at.line) {
            return;
        }
        let diameter = |x: Radius| x.to_diameter().0.to_mm().to_string();
        let place = self.block_place();
        let warning = Diagnostic::warning("cylinder-roughing-read").at(place);
        self.say(warning.with("from", diameter(levels.surface)).with("to", diameter(levels.figure)));
    }

    /// Down to the next level.
    fn next_cylinder_pass(&mut self, call: &Call<'_>) -> Result<(), Alarm> {
        let increment = self.modal.increment(&self.settings);
        let Some(roughing) = &mut self.cylinder_roughing else { return Ok(()) };
        roughing.pass += 1;
        let levels = roughing.levels;
        roughing.level = if roughing.is_last() {
            levels.figure
        } else {
            let (pass, cuts) = (i128::from(roughing.pass), i128::from(levels.cuts));
            let way = Length::from_nm((i128::from(levels.roughing.nm()) * pass / cuts) as i64);
            (levels.surface + Radius(way)).to_diameter().rounded(increment).to_radius()
        };
        let to = Position::new(roughing.level, roughing.start.z);
        let is_last = roughing.is_last();
        self.cylinder_phase(Phase::Infeed);
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.cut_with_axes(to, Shape::Line, feed, OtherAxes::default())?;
        self.cylinder_phase(if is_last { Phase::Finish } else { Phase::Cut });
        Ok(())
    }

    /// The figure has been run: out and back to the start. True when another pass follows.
    pub(super) fn end_cylinder_pass(&mut self, call: &mut Call<'_>) -> Result<bool, Alarm> {
        let Some(roughing) = &self.cylinder_roughing else { return Ok(false) };
        if roughing.depth != self.frames.len() {
            return Err(self.alarm_at("cylinder-roughing-without-end", call.word));
        }
        if !self.macros.modal_calls.is_empty() {
            return Err(self.alarm_at("cylindrical-code-illegal", call.word));
        }
        let (start, is_last, begin) = (roughing.start, roughing.is_last(), roughing.begin);
        let home = OtherAxes { c: Some(roughing.c), v: Some(roughing.v), ..OtherAxes::default() };
        let modes = roughing.modes.clone();
        self.cylinder_phase(Phase::Out);
        self.cylinder_rapid(Position::new(start.x, self.modal.position.z), OtherAxes::default())?;
        self.cylinder_phase(if is_last { Phase::Home } else { Phase::Return });
        self.cylinder_rapid(start, home)?;
        if is_last {
            self.leave_cylinder_roughing();
            return Ok(false);
        }
        self.change_motion(modes.motion, modes.motion_code);
        (self.modal.feed, self.modal.feed_mode) = (modes.feed, modes.feed_mode);
        self.modal.in_force.codes = modes.codes;
        self.next_cylinder_pass(call)?;
        self.jump(begin, call.environment)?;
        Ok(true)
    }

    /// Nothing is roughed on a cylinder any more.
    pub(crate) fn leave_cylinder_roughing(&mut self) {
        if self.cylinder_roughing.take().is_some() {
            self.in_cycle = None;
        }
    }

    /// Refuses the end of the program, or of the called one, before the end of the figure.
    pub(crate) fn check_cylinder_figure(&self, block: &Block, auxiliary: &Auxiliary) -> Result<(), Alarm> {
        let Some(roughing) = &self.cylinder_roughing else { return Ok(()) };
        let leaves = match auxiliary.flow {
            Some((Flow::End, place)) => Some(place),
            Some((Flow::Return, place)) if self.frames.len() <= roughing.depth => Some(place),
            _ => None,
        };
        match leaves {
            Some(place) => {
                Err(self.alarm_at("cylinder-roughing-without-end", block.words.get(usize::from(place))))
            }
            None => Ok(()),
        }
    }

    /// What the moves of the cycle from here on are.
    fn cylinder_phase(&mut self, phase: Phase) {
        let Some(roughing) = &self.cylinder_roughing else { return };
        let label = CycleLabel(roughing.code);
        self.in_cycle = Some(CycleOrigin { label, pass: roughing.pass, phase });
    }

    fn cylinder_rapid(&mut self, to: Position<WorkTip>, ends: OtherAxes) -> Result<(), Alarm> {
        self.modal.position = to;
        let others = self.take_along(to, &Shape::Line, ends);
        self.emit_move(to, Action::Rapid { to, path: RapidPath::Straight, others })
    }

    /// Words of the block that the control does not take, or that end a cycle with what only its beginning has.
    pub(super) fn refuse_cylinder_words(&self, block: &Block, allows_k: bool) -> Result<(), Alarm> {
        let roughs = self.control.policies.cylinder_roughing != Place::Absent;
        let is_foreign =
            |word: &&Word| WORDS.contains(&word.address) && !roughs && !(word.address == b'K' && allows_k);
        match block.words.iter().find(is_foreign) {
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }
}
