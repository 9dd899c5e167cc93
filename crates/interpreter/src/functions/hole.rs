//! `face-drilling`, `side-drilling`, `face-boring`, `side-boring`, `face-drilling-with-retract`,
//! `side-drilling-with-retract`, `hole-cycle-off`, `return-to-start-level`, `return-to-r-level` — hole cycles (G83, G87,
//! G85, G89, G80; G98 and G99 of systems B and C). Tapping is in `hole_tap.rs`.
//!
//! `G83 X(U)_ C(H)_ Z(W)_ R_ Q_ P_ F_ K_ M_` drills into the face, `G87 Z(W)_ C(H)_ X(U)_ …` into the side. X and C (Z
//! and C) are the place, Z (X) is the bottom. R is the way from the start level to the R point, signed, a radius; W
//! (U) counts the bottom from there. The start level is where the tool stands when the first of these codes comes. Q
//! is the depth of a peck without sign, P the dwell at the bottom in milliseconds.
//!
//! **Order.** Rapid to the place, rapid to the R point, in at feed, dwell, back to the R point (drills at rapid, boring
//! cycles at the feed of 5149, 200 percent without it), rapid to the start level; systems B and C stay at the R point
//! while G99 is in force there.
//!
//! **Pecks.** By 5101#2 the drill goes back by 5114 after each peck, or to the R point and then down to 5115 above the
//! depth reached (5114 where 5115 is zero).
//!
//! **In force.** R, Q, P, the bottom and the clamp stay in force, with the code itself, until the cancelling code or any
//! motion code; place and K count for their block. A block without an axis word drills nothing, and its words are
//! not kept. K drills so many holes, each an increment further, K0 none. An M word with the number of 5110 clamps
//! the rotary axis between place and R point of this and all further holes; the next number frees it, and 5111
//! is the time for that.
//!
//! **980 series.** R of G83 and G87 is the retract after each peck; there is no R point, the feed begins at the start
//! level. Without J and with J0 the drill goes back by R, with J1 to the start level and down to R above (the texts say
//! that J chooses and not how: a policy). D watches the load, which nothing here has.
//!
//! Source: hole cycles, both families.

use turnwright_canon::{Action, Shape};
use turnwright_control::policy::{PeckModeWord, ZeroPeck};
use turnwright_cycles::{self as cycles, Clamping, HoleRequest, HoleWork, Peck, PeckAxis, PeckRetract};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Angle, Feed, FeedPerMinute, FeedPerRevolution, Length, Position, Seconds, WorkTip};

use super::{Function, FunctionId, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static FACE_DRILLING: Function =
    Function::motion("face-drilling", |core, call| holes(core, call, PeckAxis::Z, Work::Drill)).hole_cycle();
pub(super) static SIDE_DRILLING: Function =
    Function::motion("side-drilling", |core, call| holes(core, call, PeckAxis::X, Work::Drill)).hole_cycle();
pub(super) static FACE_DRILLING_WITH_RETRACT: Function =
    Function::motion("face-drilling-with-retract", |core, call| {
        holes(core, call, PeckAxis::Z, Work::DrillWithRetract)
    })
    .hole_cycle();
pub(super) static SIDE_DRILLING_WITH_RETRACT: Function =
    Function::motion("side-drilling-with-retract", |core, call| {
        holes(core, call, PeckAxis::X, Work::DrillWithRetract)
    })
    .hole_cycle();
pub(super) static FACE_TAPPING: Function =
    Function::motion("face-tapping", |core, call| holes(core, call, PeckAxis::Z, Work::Tap)).tapping_cycle();
pub(super) static SIDE_TAPPING: Function =
    Function::motion("side-tapping", |core, call| holes(core, call, PeckAxis::X, Work::Tap)).tapping_cycle();
pub(super) static FACE_BORING: Function =
    Function::motion("face-boring", |core, call| holes(core, call, PeckAxis::Z, Work::Bore)).hole_cycle();
pub(super) static SIDE_BORING: Function =
    Function::motion("side-boring", |core, call| holes(core, call, PeckAxis::X, Work::Bore)).hole_cycle();

pub(super) static HOLE_CYCLE_OFF: Function = Function::mode("hole-cycle-off", |core, _| {
    core.leave_hole_cycle();
    Ok(())
})
.allowed_in_rotation();
pub(super) static RETURN_TO_START_LEVEL: Function =
    Function::mode("return-to-start-level", |core, _| stay_at_r(core, false)).allowed_in_rotation();
pub(super) static RETURN_TO_R_LEVEL: Function =
    Function::mode("return-to-r-level", |core, _| stay_at_r(core, true)).allowed_in_rotation();

/// Letters of the words that stay in force.
const DATA: &[u8] = b"RQPKJD";
/// Most repeats.
const REPEATS_MAX: u32 = 9_999;
/// Longest dwell, milliseconds.
const DWELL_MAX: u32 = 99_999_999;
/// A boring cycle leaves at this percentage of its feed where the parameter gives none.
const BORE_OUT_PERCENT: u32 = 200;

/// What is done in a hole.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Work {
    Drill,
    DrillWithRetract,
    Bore,
    Tap,
}

/// The bottom as it was given.
#[derive(Clone, Copy, Debug)]
enum Bottom {
    At(Length),
    BelowR(Length),
}

/// What a hole cycle keeps from hole to hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HoleInForce {
    /// The motion that is in force again behind it, and its code.
    motion_before: (FunctionId, u16),
    /// Where the tool stood when the first code came.
    start: Position<WorkTip>,
    /// Way to the R point; of the 980 series, the retract.
    r: Length,
    bottom: Option<Bottom>,
    /// Zero: none.
    peck: Length,
    dwell_ms: u32,
    clamps: bool,
    /// J of the 980 series.
    peck_mode: u32,
    /// Taps follow the spindle.
    pub(super) is_rigid: bool,
    holes: u32,
}

/// Parameters of hole cycles.
#[derive(Clone, Debug)]
pub(crate) struct HoleSettings {
    pecks_to_r: bool,
    peck_return: Length,
    peck_approach: Length,
    bore_percent: u32,
    clamp_code: u32,
    unclamp_dwell_ms: u32,
    pub(super) tap: super::hole_tap::TapSettings,
}

impl HoleSettings {
    pub(crate) fn new(parameters: &turnwright_control::Parameters) -> Self {
        let mm = |name: &str| Length::from_nm((parameters.value(name) * 1e6).round() as i64);
        let count = |name: &str| parameters.value(name).clamp(0.0, 1e9) as u32;
        let (peck_return, peck_approach) = (mm("peck-return"), mm("peck-approach"));
        Self {
            pecks_to_r: parameters.bit("peck-deep"),
            peck_return,
            peck_approach: if peck_approach.is_zero() { peck_return } else { peck_approach },
            bore_percent: match count("bore-retract") {
                0 => BORE_OUT_PERCENT,
                percent => percent,
            },
            clamp_code: count("axis-clamp-code"),
            unclamp_dwell_ms: count("axis-unclamp-dwell"),
            tap: super::hole_tap::TapSettings::new(parameters),
        }
    }
}

/// Where a block drills.
struct Place {
    place: Length,
    step: Length,
    others: turnwright_canon::OtherAxes,
    others_step: (Angle, Length),
}

fn stay_at_r(core: &mut Core, stays: bool) -> Result<(), Alarm> {
    core.modal.stays_at_r = stays;
    Ok(())
}

fn holes(core: &mut Core, call: &mut Call<'_>, axis: PeckAxis, work: Work) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    core.refuse_foreign_hole_letters(call.block, work)?;
    let Some(mut hole) = core.modal.hole else { return Ok(()) };
    let axes = super::AXES | (core.axes.letters & !letters(b"J"));
    if call.block.present() & axes == 0 {
        let data = |letter: &u8| call.block.word(*letter).filter(|word| !core.selects_spindle(word));
        if let Some(word) = DATA.iter().find_map(data) {
            core.warn("hole-words-without-hole", word);
        }
        return Ok(());
    }
    core.take_hole_words(call.block, axis, work, &mut hole)?;
    let repeats = call.block.word(b'K').map_or(Ok(1), |word| core.whole(word, REPEATS_MAX))?;
    let along = |place: Position<WorkTip>| if axis == PeckAxis::Z { place.z } else { place.x.0 };
    let initial = along(hole.start);
    let has_r_point = work != Work::DrillWithRetract;
    let r_point = if has_r_point { initial + hole.r } else { initial };
    let bottom = match hole.bottom {
        Some(Bottom::At(bottom)) => bottom,
        Some(Bottom::BelowR(depth)) => r_point + depth,
        None => return Err(core.alarm_at("hole-bottom-missing", call.word)),
    };
    core.check_hole(call, has_r_point.then_some(hole.r), bottom - r_point);
    let (hole_work, feed) = core.hole_work(call, work, &mut hole, bottom - r_point)?;
    let place = core.hole_place(call.block, axis, repeats)?;
    let settings = &core.settings.hole;
    let clamping = Clamping {
        on: settings.clamp_code,
        off: settings.clamp_code.saturating_add(1),
        dwell: Seconds(f64::from(settings.unclamp_dwell_ms) / 1_000.0),
    };
    let request = HoleRequest {
        context: core.cycle_context(feed),
        axis,
        place: place.place,
        step: place.step,
        others: place.others,
        others_step: place.others_step,
        initial,
        r_point,
        bottom,
        work: hole_work,
        dwell: Seconds(f64::from(hole.dwell_ms) / 1_000.0),
        clamping: hole.clamps.then_some(clamping),
        stays_at_r: core.modal.stays_at_r && has_r_point,
        repeats,
    };
    let moves = cycles::hole(request).map_err(|fault| core.misuse(fault, call))?;
    let holes_before = hole.holes;
    hole.holes = holes_before.saturating_add(repeats);
    core.modal.hole = Some(hole);
    core.start_cycle(CycleMoves::Hole(Box::new(moves)), call.code, Vec::new(), holes_before)
}

impl Core {
    /// A hole cycle comes into force, or a motion code ends it.
    #[cold]
    pub(crate) fn change_hole_cycle(&mut self, to: FunctionId, before: (FunctionId, u16)) {
        if !to.get().is_hole_cycle {
            self.modal.hole = None;
        } else if self.modal.hole.is_none() {
            self.modal.hole = Some(HoleInForce {
                motion_before: before,
                start: self.modal.position,
                r: Length::ZERO,
                bottom: None,
                peck: Length::ZERO,
                dwell_ms: 0,
                clamps: false,
                peck_mode: 0,
                is_rigid: false,
                holes: 0,
            });
        }
    }

    /// The motion before the hole cycle is in force again.
    pub(crate) fn leave_hole_cycle(&mut self) {
        self.forget_rigid_tapping();
        if let Some(hole) = self.modal.hole.take() {
            (self.modal.motion, self.modal.motion_code) = hole.motion_before;
        }
    }

    /// Whether an M code of this block clamps the rotary axis for a hole: then the cycle gives it out.
    #[cold]
    pub(crate) fn clamps_for_hole(&self, code: u32, block: &Block) -> bool {
        code != 0
            && code == self.settings.hole.clamp_code
            && self.modal.hole.is_some()
            && block.present() & (super::AXES | self.axes.letters) != 0
    }

    fn refuse_foreign_hole_letters(&self, block: &Block, work: Work) -> Result<(), Alarm> {
        let foreign: &[u8] = if work == Work::DrillWithRetract { b"" } else { b"JD" };
        match foreign.iter().find_map(|letter| block.word(*letter)) {
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }

    /// Takes in the words that stay in force.
    fn take_hole_words(
        &mut self,
        block: &Block,
        axis: PeckAxis,
        work: Work,
        hole: &mut HoleInForce,
    ) -> Result<(), Alarm> {
        let (absolute, increment) = if axis == PeckAxis::Z { (b'Z', b'W') } else { (b'X', b'U') };
        if block.has(absolute) || block.has(increment) {
            let (word, is_increment) = self.axis_word(block, absolute, increment)?;
            let length = match (axis, is_increment) {
                (PeckAxis::Z, _) => self.length(word)?,
                (PeckAxis::X, true) => self.radius(word, Role::XIncrement)?.0,
                (PeckAxis::X, false) => self.radius(word, Role::XCoordinate)?.0,
            };
            hole.bottom = Some(if is_increment { Bottom::BelowR(length) } else { Bottom::At(length) });
        }
        if let Some(word) = block.word(b'R') {
            self.missing_point(word);
            hole.r = match work {
                Work::DrillWithRetract => self.unsigned_length(word)?,
                Work::Tap => self.tap_r(word)?,
                Work::Drill | Work::Bore => self.length(word)?,
            };
        }
        if let Some(word) = block.word(b'Q') {
            hole.peck = self.peck_word(word, work)?;
        }
        if let Some(word) = block.word(b'P') {
            hole.dwell_ms = self.whole(word, DWELL_MAX)?;
        }
        if let Some(word) = block.word(b'J') {
            hole.peck_mode = self.whole(word, 1)?;
        }
        if let Some(word) = block.word(b'D') {
            self.whole(word, 9_999)?;
            self.warn("drill-load-not-watched", word);
        }
        let code = self.settings.hole.clamp_code;
        if code != 0 {
            let is_clamp =
                |word: &&Word| word.address == b'M' && self.whole(word, u32::MAX).ok() == Some(code);
            hole.clamps |= block.words.iter().any(|word| is_clamp(&word));
        }
        Ok(())
    }

    fn peck_word(&mut self, word: &Word, work: Work) -> Result<Length, Alarm> {
        let peck = self.cycle_length(word)?;
        let drills = matches!(work, Work::Drill | Work::DrillWithRetract);
        match peck.signum() {
            1 => Ok(peck),
            0 if drills && self.control.policies.zero_peck == ZeroPeck::Alarm => {
                Err(self.alarm("peck-depth-missing", word))
            }
            0 => Ok(peck),
            _ => Err(self.alarm("minus-not-allowed", word)),
        }
    }

    /// Where the words of a block put the holes; takes the other axes along.
    fn hole_place(&mut self, block: &Block, axis: PeckAxis, repeats: u32) -> Result<Place, Alarm> {
        let from = self.modal.position;
        let to = self.target(block)?;
        let (absolute, increment) = if axis == PeckAxis::Z { (b'X', b'U') } else { (b'Z', b'W') };
        let across = |place: Position<WorkTip>| if axis == PeckAxis::Z { place.x.0 } else { place.z };
        let steps =
            (block.has(absolute) || block.has(increment)) && self.axis_word(block, absolute, increment)?.1;
        let step = if steps { across(to) - across(from) } else { Length::ZERO };
        let mut place = Place {
            place: across(to),
            step,
            others: turnwright_canon::OtherAxes::default(),
            others_step: (Angle::ZERO, Length::ZERO),
        };
        if repeats == 0 || block.present() & self.axes.letters & !letters(b"J") == 0 {
            return Ok(place);
        }
        let here = self.axes.at;
        let ends = self.other_targets(block)?;
        let turns =
            |letter: u8, step: u8| block.has(step) || (block.has(letter) && self.modal.is_incremental);
        if let Some(c) = ends.c.filter(|_| turns(b'C', b'H')) {
            place.others_step.0 = c - here.c;
        }
        if let Some(y) = ends.y.filter(|_| turns(b'Y', b'V')) {
            place.others_step.1 = y - here.y;
        }
        if let Some(others) = self.take_along(to, &Shape::Line, ends) {
            place.others = *others;
            for _ in 1..repeats {
                self.axes.at.c = self.axes.at.c + place.others_step.0;
                self.axes.at.y += place.others_step.1;
            }
        }
        Ok(place)
    }

    /// What a machinist would look at twice.
    fn check_hole(&mut self, call: &Call<'_>, r: Option<Length>, depth: Length) {
        if depth.is_zero() {
            self.warn_block("hole-without-depth");
        }
        if let Some(r) = r
            && r.signum() * depth.signum() < 0
        {
            // Written as the level where the feed begins, as mills have it.
            match call.block.word(b'R') {
                Some(word) => self.warn("hole-r-leads-away", word),
                None => self.warn_block("hole-r-leads-away"),
            }
        }
    }

    /// What is done in the hole, and the feed of the way in.
    fn hole_work(
        &mut self,
        call: &Call<'_>,
        work: Work,
        hole: &mut HoleInForce,
        depth: Length,
    ) -> Result<(HoleWork, Feed), Alarm> {
        if work == Work::Tap {
            let (tap, feed) = self.tap(call, hole, hole.peck, depth)?;
            return Ok((HoleWork::Tap(Box::new(tap)), feed));
        }
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        let settings = &self.settings.hole;
        let retract = match work {
            Work::DrillWithRetract => {
                let is_short = match self.control.policies.peck_mode_word {
                    PeckModeWord::ZeroIsShort => hole.peck_mode == 0,
                    PeckModeWord::OneIsShort => hole.peck_mode == 1,
                };
                if is_short { PeckRetract::Short(hole.r) } else { PeckRetract::Full(hole.r) }
            }
            _ if settings.pecks_to_r => PeckRetract::Full(settings.peck_approach),
            _ => PeckRetract::Short(settings.peck_return),
        };
        let peck = (!hole.peck.is_zero()).then_some(Peck { depth: hole.peck, retract });
        let hole_work = match work {
            Work::Bore => HoleWork::Bore(percent_of(feed, settings.bore_percent)),
            _ => HoleWork::Drill(peck),
        };
        Ok((hole_work, feed))
    }
}

fn percent_of(feed: Feed, percent: u32) -> Feed {
    let share = |length: Length| Length::from_nm(length.nm().saturating_mul(i64::from(percent)) / 100);
    match feed {
        Feed::PerMinute(FeedPerMinute(length)) => Feed::PerMinute(FeedPerMinute(share(length))),
        Feed::PerRevolution(FeedPerRevolution(length)) => {
            Feed::PerRevolution(FeedPerRevolution(share(length)))
        }
    }
}

impl Core {
    /// The state of the spindle as a command, were it this one.
    pub(super) fn spindle_action_in(&mut self, state: turnwright_canon::SpindleState) -> Action {
        let before = std::mem::replace(&mut self.modal.spindle, state);
        let action = self.spindle_action();
        self.modal.spindle = before;
        action
    }
}
