//! `turning-cycle`, `thread-cycle`, `facing-cycle` — four moves in one block (G90, G92, G94; G77 to G79 in
//! system B; G20, G21, G24 in system C).
//!
//! `G90 X(U)_ Z(W)_ R_ F_`: rapid to the depth, cut to the end point, out at feed, rapid home. `G94` does the
//! same along X. `G92` cuts a thread with lead F and leaves it at rapid; near its end the tool runs out at 45
//! degrees (5130, 5131). R is the taper: start of the cut less its end, a radius for G90 and G92, a Z length for
//! G94.
//!
//! The words of the lead, and Q for the start angle, are those of single threads (`leads.rs`). On controls with the
//! words: J and K are the run-out across and along instead of the parameters (J zero: none; K alone
//! by policy none or as deep as long; J alone by policy as long as deep, or straight out at the end), L the number of starts, each a pass with its
//! share of the turn, P1 a thread across the face. They stay in force like X and Z; Q does not. The way out of a
//! thread is at rapid, or at the speed set for it (1466).
//!
//! Where P1 is the repair of a thread (a 980 with 174#4), the operator has recorded a place in the groove of the old
//! thread: the coordinate along the thread and the angle of the spindle, `[thread-repair]` of the setup file. The
//! start angle then is the one with which the thread goes through that place; with several starts, the first one
//! does. P1 stands in the first block and stays in force with the code. What acceleration loses (parameter 191 of
//! the machine) is not in it.
//!
//! X, Z and R stay in force while the code does: a block with a new X repeats the cycle from the same start
//! point, one with `U0` or `W0` repeats it as it was. A code of its own without any axis word only takes effect with the next axis word.
//!
//! `G92.1` is G92 with the spindle led as an axis: it needs S, turns a spindle that stands clockwise (where leads have a
//! sign, counter-clockwise for a negative one), and stops it behind the cycle again, as `G32.1` does.
//!
//! `G92.2` is G92 with a run-in: the tool goes down by D over the length E while it threads, and on without a stop.
//! E lies along the thread, as its alarm compares E and K with the thread's length; so D lies across it, as J does. They have
//! defaults (5150, 5151); both stay in force as J and K do.
//!
//! Deliberately not here: `G92.3`, of whose equal crests no text at hand says how the tool moves.
//!
//! Source: single canned cycles of both families; thread repair: programming help of the 980TDi, version 6.10.

use turnwright_control::policy::{RunOutLengthAlone, RunOutWords, TaperSign, ThreadCycleWords};
use turnwright_cycles as cycles;
use turnwright_syntax::Word;
use turnwright_units::{
    Angle, Diameter, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius,
};

use super::multi_thread::{self, run_out};
use super::{Function, letters};
use crate::block::Call;
use crate::machine::Core;
use crate::modal::SingleCycle;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static TURNING_CYCLE: Function =
    Function::motion("turning-cycle", |core, call| box_cycle(core, call, cycles::FirstAxis::X))
        .with_letters(b"R")
        .triggered_by(b"R")
        .repeating();

pub(super) static FACING_CYCLE: Function =
    Function::motion("facing-cycle", |core, call| box_cycle(core, call, cycles::FirstAxis::Z))
        .with_letters(b"R")
        .triggered_by(b"R")
        .repeating();

pub(super) static THREAD_CYCLE: Function = Function::motion("thread-cycle", thread_cycle)
    .with_letters(b"RQEIJKLPCD")
    .triggered_by(b"R")
    .with_lead()
    .repeating();

pub(super) static RIGID_THREAD_CYCLE: Function = Function::motion("rigid-thread-cycle", rigid_thread_cycle)
    .with_letters(b"RQEIJKLPCD")
    .triggered_by(b"R")
    .with_lead()
    .repeating();

pub(super) static RUN_IN_THREAD_CYCLE: Function = Function::motion("run-in-thread-cycle", |core, call| {
    thread_with(core, call, b"RQLPDE", Core::cycle_run_in)
})
.with_letters(b"RQEIJKLPCD")
.triggered_by(b"R")
.with_lead()
.repeating();

fn rigid_thread_cycle(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    if core.present_rpm().0 == 0 {
        return Err(core.alarm_at("spindle-not-started", call.word));
    }
    let is_led = core.lead_spindle(call.block);
    thread_cycle(core, call)?;
    if is_led {
        core.stop_spindle_behind_cycle();
    }
    Ok(())
}

fn box_cycle(core: &mut Core, call: &mut Call<'_>, first: cycles::FirstAxis) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let end = core.single_cycle_words(call, first == cycles::FirstAxis::X)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let taper = core.modal.cycle.taper;
    core.check_taper(call, first, end, taper)?;
    let end = core.beside_taper(call, first, end, taper)?;
    let request = cycles::BoxRequest { context: core.cycle_context(feed), first, end, taper };
    let cycle = cycles::box_cycle(request).map_err(|fault| core.misuse(fault, call))?;
    let passes_before = core.count_single_cycle(1);
    core.start_cycle(CycleMoves::Box(Box::new(cycle)), call.code, Vec::new(), passes_before)
}

fn thread_cycle(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let own: &[u8] = match core.control.policies.thread_cycle_words {
        ThreadCycleWords::Plain => b"RQ",
        ThreadCycleWords::StartsAndFace | ThreadCycleWords::StartsAndRepair => b"RQLP",
    };
    thread_with(core, call, own, |_, _, _, _| Ok(None))
}

/// What the run-in of a thread is, from the block, the run-out along the thread and the end of the thread.
type RunInOf = fn(
    &mut Core,
    &Call<'_>,
    Length,
    Position<turnwright_units::WorkTip>,
) -> Result<Option<cycles::RunIn>, Alarm>;

/// A thread cycle with its letters and its run-in.
fn thread_with(core: &mut Core, call: &mut Call<'_>, own: &[u8], run_in: RunInOf) -> Result<(), Alarm> {
    core.refuse_strange_thread_letters(call, own, core.run_out_letters())?;
    core.thread_cycle_form(call)?;
    let is_face = core.modal.cycle.is_face_thread;
    let first = if is_face { cycles::FirstAxis::Z } else { cycles::FirstAxis::X };
    let end = core.single_cycle_words(call, !is_face)?;
    let lead = core.lead_in_force(call)?;
    let start_angle = core.start_angle(call)?;
    core.check_thread(call, lead)?;
    let taper = core.modal.cycle.taper;
    let start_angle = core.repair_angle(call, lead, end)?.unwrap_or(start_angle);
    core.check_taper(call, first, end, taper)?;
    if !is_face && call.word.is_some() {
        core.check_lead_in(end, lead, 0.0);
    }
    let (run_out, run_out_depth) = core.cycle_run_out(call, lead, end)?;
    let run_in = run_in(core, call, run_out, end)?;
    let request = cycles::ThreadOnceRequest {
        context: core.cycle_context(Feed::PerRevolution(FeedPerRevolution(lead.0))),
        along: if is_face { cycles::CutAlong::X } else { cycles::CutAlong::Z },
        end,
        taper,
        lead,
        start_angle,
        starts: core.modal.cycle.starts,
        run_out,
        run_out_angle_deg: core.settings.run_out_angle_deg,
        run_out_depth,
        pull_out_feed: core.settings.thread_pull_out_feed.map(FeedPerMinute),
        run_in,
    };
    let cycle = cycles::thread_once(request).map_err(|fault| core.misuse(fault, call))?;
    if cycle.run_out_shortened().is_some() {
        core.warn_block("run-out-shortened");
    }
    core.keep_vector(call, first, end, taper)?;
    let passes_before = core.count_single_cycle(cycle.passes());
    core.start_cycle(CycleMoves::ThreadOnce(Box::new(cycle)), call.code, Vec::new(), passes_before)
}

impl Core {
    /// Ends the life of X, Z and R of a single cycle.
    pub(crate) fn forget_single_cycle(&mut self) {
        self.modal.cycle = SingleCycle::default();
    }

    /// Takes in the words of the block and gives the end point; what is missing is as before.
    fn single_cycle_words(
        &mut self,
        call: &Call<'_>,
        taper_is_radial: bool,
    ) -> Result<Position<turnwright_units::WorkTip>, Alarm> {
        let present = call.block.present();
        if present & super::AXES != 0 {
            let (to, here) = (self.target(call.block)?, self.modal.position);
            // An increment of zero moves nowhere: the cycle runs again as it is.
            let increments = if self.modal.is_incremental { super::AXES } else { letters(b"UW") };
            let cycle = &mut self.modal.cycle;
            let stays = |letter, held: bool| held && present & letters(letter) & !increments == 0;
            if present & letters(b"XU") != 0 && !(to.x == here.x && stays(b"XU", cycle.x.is_some())) {
                cycle.x = Some(to.x);
            }
            if present & letters(b"ZW") != 0 && !(to.z == here.z && stays(b"ZW", cycle.z.is_some())) {
                cycle.z = Some(to.z);
            }
        }
        if let Some(word) = call.block.word(b'R') {
            self.missing_point(word);
            self.modal.cycle.taper =
                if taper_is_radial { self.radius(word, Role::TaperRadius)?.0 } else { self.length(word)? };
        }
        let here = self.modal.position;
        Ok(Position::new(self.modal.cycle.x.unwrap_or(here.x), self.modal.cycle.z.unwrap_or(here.z)))
    }

    /// L and P of the thread cycle; they stay in force as X and Z do.
    fn thread_cycle_form(&mut self, call: &Call<'_>) -> Result<(), Alarm> {
        if let Some(word) = call.block.word(b'L') {
            self.modal.cycle.starts = self.thread_starts(word)?;
        }
        if let Some(word) = call.block.word(b'P') {
            if self.control.policies.thread_cycle_words == ThreadCycleWords::StartsAndRepair {
                return self.thread_repair_word(word);
            }
            self.modal.cycle.is_face_thread = self.whole(word, 1)? == 1;
        }
        Ok(())
    }

    /// P1 repairs a thread, any other P does not.
    fn thread_repair_word(&mut self, word: &Word) -> Result<(), Alarm> {
        let asks = self.whole(word, 99_999_999)? == 1;
        let follows = self.modal.motion.get().name == THREAD_CYCLE.name;
        if asks && !self.settings.thread_repair {
            self.warn("thread-repair-off", word);
        } else if asks && follows != self.settings.thread_repair_follows {
            self.warn("thread-repair-way-differs", word);
        }
        self.modal.cycle.repairs = asks && self.settings.thread_repair;
        Ok(())
    }

    /// The start angle with which a repaired thread goes through the recorded place: the spindle turns once for
    /// each lead between the start of the thread and that place.
    fn repair_angle(
        &mut self,
        call: &Call<'_>,
        lead: Lead,
        end: Position<turnwright_units::WorkTip>,
    ) -> Result<Option<Angle>, Alarm> {
        if !self.modal.cycle.repairs {
            return Ok(None);
        }
        let start = Position::new(end.x + Radius(self.modal.cycle.taper), self.modal.position.z);
        let (way, record) = (end - start, self.thread_record);
        let length = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
        let (from, to, place) = if way.x.0.abs() > way.z.abs() {
            let x = record.and_then(|record| record.x).map(|mm| Diameter(length(mm)).to_radius().0);
            (start.x.0, end.x.0, x)
        } else {
            (start.z, end.z, record.and_then(|record| record.z).map(length))
        };
        let word = call.block.word(b'P').or(call.word);
        let (Some(place), Some(record)) = (place, record) else {
            return Err(self.alarm_at("thread-record-missing", word));
        };
        if place < from.min(to) || place > from.max(to) {
            return Err(self.alarm_at("thread-record-outside", word));
        }
        if let Some(word) = call.block.word(b'Q') {
            self.warn("thread-repair-overrules-angle", word);
        }
        let turn = Angle::TURN.nanodegrees();
        let turned = i128::from((place - from).abs().nm()) * i128::from(turn) / i128::from(lead.0.nm());
        let recorded = (record.angle_deg * 1e9).round() as i128;
        let angle = (recorded - turned).rem_euclid(i128::from(turn));
        Ok(Some(Angle::from_millidegrees(Angle::from_nanodegrees(angle as i64).millidegrees() % 360_000)))
    }

    /// Length and depth of the run-out: J and K when one of them is in force, else by the parameters.
    fn cycle_run_out(
        &mut self,
        call: &Call<'_>,
        lead: Lead,
        end: Position<turnwright_units::WorkTip>,
    ) -> Result<(Length, Option<Length>), Alarm> {
        let length = |word| self.unsigned_length(word);
        let depth = call.block.word(b'J').map(length).transpose()?;
        let along = call.block.word(b'K').map(length).transpose()?;
        let cycle = &mut self.modal.cycle;
        cycle.run_out_depth = depth.or(cycle.run_out_depth);
        cycle.run_out_length = along.or(cycle.run_out_length);
        let words = multi_thread::RunOutWords { depth: cycle.run_out_depth, length: cycle.run_out_length };
        let (along, depth) = match self.run_out_by_words(words) {
            Some((along, depth)) => (along, Some(depth)),
            None => (run_out(lead, self.settings.run_out_tenths), None),
        };
        let has_words = self.control.policies.run_out_words != RunOutWords::Absent;
        if has_words && along > self.cycle_thread_length(end) {
            let word = call.block.word(b'K').or(call.block.word(b'J')).or(call.word);
            return Err(self.alarm_at("run-out-too-long", word));
        }
        Ok((along, depth))
    }

    /// From the start point to the end, along the thread.
    fn cycle_thread_length(&self, end: Position<turnwright_units::WorkTip>) -> Length {
        let way = end - self.modal.position;
        if self.modal.cycle.is_face_thread { way.x.0.abs() } else { way.z.abs() }
    }

    /// The run-in that D and E ask for.
    fn cycle_run_in(
        &mut self,
        call: &Call<'_>,
        run_out: Length,
        end: Position<turnwright_units::WorkTip>,
    ) -> Result<Option<cycles::RunIn>, Alarm> {
        let [across, along] = [b'D', b'E'].map(|letter| call.block.word(letter));
        let length = |word| self.unsigned_length(word);
        let (depth, way) = (across.map(length).transpose()?, along.map(length).transpose()?);
        let cycle = &mut self.modal.cycle;
        cycle.run_in_depth = depth.or(cycle.run_in_depth);
        cycle.run_in_length = way.or(cycle.run_in_length);
        let depth = cycle.run_in_depth.unwrap_or(self.settings.run_in_depth);
        let length = cycle.run_in_length.unwrap_or(self.settings.run_in_length);
        if depth.is_zero() {
            return Err(self.alarm_at("run-in-zero-d", across.or(call.word)));
        }
        if length.is_zero() {
            return Err(self.alarm_at("run-in-zero-e", along.or(call.word)));
        }
        if length + run_out > self.cycle_thread_length(end) {
            let word = along.or(call.block.word(b'K')).or(call.word);
            return Err(self.alarm_at("run-in-and-out-too-long", word));
        }
        Ok(Some(cycles::RunIn { depth, length }))
    }

    /// Length and depth of the run-out that J and K ask for.
    pub(super) fn run_out_by_words(&self, words: multi_thread::RunOutWords) -> Option<(Length, Length)> {
        let straight = self.control.policies.run_out_words == RunOutWords::StraightOut;
        Some(match (words.depth, words.length) {
            (None, None) => return None,
            (None, Some(along)) => match self.control.policies.run_out_length_alone {
                RunOutLengthAlone::NoRunOut => (Length::ZERO, Length::ZERO),
                RunOutLengthAlone::AsDeepAsLong => (along, along),
            },
            (Some(depth), along) => match along.filter(|along| !along.is_zero()) {
                _ if depth.is_zero() => (Length::ZERO, depth),
                Some(along) => (along, depth),
                None if straight => (Length::ZERO, depth),
                None => (depth, depth),
            },
        })
    }

    /// Counts the passes that begin; gives how many there were.
    fn count_single_cycle(&mut self, passes: u32) -> u32 {
        let before = self.modal.cycle.pass;
        self.modal.cycle.pass = before.saturating_add(passes);
        before
    }

    pub(super) fn check_taper(
        &mut self,
        call: &Call<'_>,
        first: cycles::FirstAxis,
        end: Position<turnwright_units::WorkTip>,
        taper: Length,
    ) -> Result<(), Alarm> {
        if !cycles::taper_crosses_start(first, self.modal.position, end, taper) {
            return Ok(());
        }
        let word = call.block.word(b'R').or(call.word).copied();
        match self.control.policies.taper_sign {
            TaperSign::Alarm => Err(self.alarm_at("taper-sign-illegal", word.as_ref())),
            TaperSign::Warn => {
                match word {
                    Some(word) => self.warn("taper-sign-suspicious", &word),
                    None => self.warn_block("taper-sign-suspicious"),
                }
                Ok(())
            }
        }
    }
}
