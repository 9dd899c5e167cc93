//! `thread`, `variable-lead-thread`, `variable-lead-thread-r`, `rigid-thread` — threads cut in single blocks (G32 and
//! G34, G32.1; G33 for G32 in systems B and C).
//!
//! `G32 X(U)_ Z(W)_ F_ Q_`: straight, tapered or face thread in step with the spindle. F is the lead along the
//! axis with the longer way (X as a radius); the words for it are in `leads.rs`. Q is the spindle angle of the start;
//! it is not modal.
//!
//! **Chains.** Thread blocks that follow one another form one thread: the spindle lock holds, lead and direction may
//! change, the start angle is that of the first block. Another block in between, or an M, S or T word in a thread
//! block, ends the chain.
//!
//! `G34` changes the lead by K (on some controls R) with every revolution. After n revolutions the tool has gone
//! F·n + K·n²/2, so the lead at the end of a way s is √(F² + 2·K·s); it must stay within the range of leads.
//!
//! **Run-out**, on controls with the words J and K: the last K along the long axis the tool leaves the thread by J
//! (signed) along the short one. Without J, or with J zero, there is none. J without K is by policy a run-out as
//! long as it is deep, or a pull-out straight from the end at its own speed (1466). A run-out ends the thread: a
//! thread block that would go on from it is refused, as the control makes run-outs only in the last block of a chain.
//! The help of the 980TDi calls J and K modal; how long they stay is not told, so a later thread without them has no
//! run-out here, and a warning says so.
//!
//! `G32.1` leads the spindle as an axis: it turns for this block only, at S.
//!
//! Source: thread cutting with constant and variable lead, both families.

use turnwright_canon::{Action, Shape, SpindleState};
use turnwright_control::policy::{RunOutBase, RunOutWords, RunOutWordsKept, VariableLeadStartAngle};
use turnwright_diagnostics::Diagnostic;
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, WorkTip,
};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

/// Letters that mean something in a thread block somewhere, if only a mistake with a name.
const THREAD_LETTERS: &[u8] = b"QEIJKRCLDP";

pub(super) static THREAD: Function =
    Function::motion("thread", thread).with_letters(THREAD_LETTERS).with_lead();

pub(super) static VARIABLE_LEAD_THREAD: Function =
    Function::motion("variable-lead-thread", |core, call| variable_lead(core, call, b'K'))
        .with_letters(THREAD_LETTERS)
        .with_lead();

pub(super) static VARIABLE_LEAD_THREAD_R: Function =
    Function::motion("variable-lead-thread-r", |core, call| variable_lead(core, call, b'R'))
        .with_letters(THREAD_LETTERS)
        .with_lead();

pub(super) static RIGID_THREAD: Function =
    Function::motion("rigid-thread", rigid_thread).with_letters(THREAD_LETTERS).with_lead();

fn thread(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let run_out = core.run_out_letters();
    core.refuse_strange_thread_letters(call, b"Q", run_out)?;
    let to = core.target(call.block)?;
    let lead = core.lead_in_force(call)?;
    core.check_thread(call, lead)?;
    core.cut_thread(call, to, lead, Length::ZERO)
}

fn variable_lead(core: &mut Core, call: &mut Call<'_>, letter: u8) -> Result<(), Alarm> {
    let has_angle = core.control.policies.variable_lead_start_angle == VariableLeadStartAngle::Taken;
    let own = [letter, b'Q'];
    let run_out = core.run_out_letters();
    core.refuse_strange_thread_letters(call, if has_angle { &own } else { &own[..1] }, run_out)?;
    let to = core.target(call.block)?;
    let lead = core.lead_in_force(call)?;
    let Some(word) = call.block.word(letter) else {
        return Err(core.alarm_at("lead-change-missing", call.word));
    };
    let change = core.lead_change(word)?;
    let way = to - core.modal.position;
    let lead_end = lead_after(lead, change, way.x.0.abs().max(way.z.abs()));
    let Some(lead_end) = lead_end.filter(|lead| core.is_lead_in_range(*lead)) else {
        return Err(core.alarm("lead-illegal", word));
    };
    core.check_thread(call, if lead_end.0 > lead.0 { lead_end } else { lead })?;
    core.cut_thread(call, to, lead, change)
}

/// The lead after a way, when it has changed by so much with every revolution; `None` when it would not be positive.
fn lead_after(lead: Lead, change: Length, way: Length) -> Option<Lead> {
    let square = i128::from(lead.0.nm()).pow(2) + 2 * i128::from(change.nm()) * i128::from(way.nm());
    // To the nearest nanometre: the root of four times as much is twice as long.
    let end = u128::try_from(4 * square).ok().filter(|square| *square > 0)?.isqrt().div_ceil(2);
    i64::try_from(end).ok().map(|nm| Lead(Length::from_nm(nm)))
}

fn rigid_thread(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    let run_out = core.run_out_letters();
    core.refuse_strange_thread_letters(call, b"Q", run_out)?;
    let to = core.target(call.block)?;
    let lead = core.lead_in_force(call)?;
    if core.present_rpm().0 == 0 {
        return Err(core.alarm_at("spindle-not-started", call.word));
    }
    core.check_thread_speed(call, lead)?;
    let is_led = core.lead_spindle(call.block);
    core.cut_thread(call, to, lead, Length::ZERO)?;
    if is_led {
        core.turn_spindle(SpindleState::Stop);
    }
    Ok(())
}

/// How a thread is left, on controls with words for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunOut {
    /// Signed, along the short axis; a radius when that is X.
    across: Length,
    /// Along the long axis; zero pulls straight out.
    along: Length,
}

impl Core {
    /// Gives out a thread to `to`, with its run-out; `change` is what the lead grows by in a revolution.
    fn cut_thread(
        &mut self,
        call: &Call<'_>,
        to: Position<WorkTip>,
        lead: Lead,
        change: Length,
    ) -> Result<(), Alarm> {
        let start_angle = self.start_angle(call)?;
        let run_out = self.thread_run_out(call)?;
        let from = self.modal.position;
        let is_chained = self.chain_thread(call, start_angle)?;
        let start_angle = self.thread_start_angle;
        let thread = |to, lead, lead_end: Option<Lead>, is_chained| Action::Thread {
            to,
            shape: Shape::Line,
            lead,
            lead_end: lead_end.map(Box::new),
            start_angle,
            is_chained,
        };
        let way = to - from;
        let is_along_z = way.z.abs() >= way.x.0.abs();
        let long = if is_along_z { way.z.abs() } else { way.x.0.abs() };
        // The lead behind a way, when it varies.
        let lead_behind = |way: Length| if change.is_zero() { None } else { lead_after(lead, change, way) };
        let Some(RunOut { across, along }) = run_out else {
            self.modal.position = to;
            return self.emit_move(to, thread(to, lead, lead_behind(long), is_chained));
        };
        if along > long {
            return Err(self.alarm_at("run-out-too-long", call.block.word(b'K').or(call.block.word(b'J'))));
        }
        // The place on the line where the run-out begins: the end less `along`, rounded once.
        let share = along.to_mm() / long.to_mm().max(f64::MIN_POSITIVE);
        let back = |way: Length| Length::from_mm_rounded(way.to_mm() * share, LeastIncrement::METRIC_C);
        let (Some(back_x), Some(back_z)) = (back(way.x.0), back(way.z)) else {
            return Err(self.alarm_block("run-out-too-long"));
        };
        let increment = self.modal.increment(&self.settings);
        let leave = Position::new(
            (to.x - Radius(back_x)).to_diameter().rounded(increment).to_radius(),
            (to.z - back_z).rounded(increment),
        );
        let base = match self.control.policies.run_out_base {
            RunOutBase::Leaving => leave,
            RunOutBase::End => to,
        };
        let end = if is_along_z {
            Position::new(base.x + Radius(across), to.z)
        } else {
            Position::new(to.x, base.z + across)
        };
        let end = self.in_range(end)?;
        let lead_leaving = lead_behind(long - along);
        self.emit_move(leave, thread(leave, lead, lead_leaving, is_chained))?;
        self.modal.position = end;
        if along.is_zero() {
            self.emit_pull_out(end, lead_behind(long).unwrap_or(lead))?;
        } else {
            // The lead counts along the longer axis of the run-out, so that the long axis keeps its pace.
            let steep = (across.abs().to_mm() / along.to_mm()).max(1.0);
            let pace = |lead: Lead| {
                Length::from_mm_rounded(lead.0.to_mm() * steep, LeastIncrement::METRIC_C).map_or(lead, Lead)
            };
            let lead_end = lead_behind(long).map(pace);
            let lead = pace(lead_leaving.unwrap_or(lead));
            self.emit_move(end, thread(end, lead, lead_end, leave != from || is_chained))?;
        }
        self.ends_in_run_out = true;
        Ok(())
    }

    /// Straight out of a thread, at the speed set for it or else that of the thread.
    fn emit_pull_out(&mut self, to: Position<WorkTip>, lead: Lead) -> Result<(), Alarm> {
        let feed = match self.settings.thread_pull_out_feed {
            Some(feed) => Feed::PerMinute(FeedPerMinute(feed)),
            None => Feed::PerRevolution(FeedPerRevolution(lead.0)),
        };
        self.emit_move(to, Action::Feed { to, shape: Shape::Line, feed, others: None })
    }

    /// J and K; `None` when there is no run-out.
    fn thread_run_out(&mut self, call: &Call<'_>) -> Result<Option<RunOut>, Alarm> {
        let Some(word) = call.block.word(b'J') else {
            let kept = self.modal.run_out.filter(|_| !self.is_behind_thread());
            return Ok(match self.control.policies.run_out_words_kept {
                RunOutWordsKept::UntilChanged => kept,
                RunOutWordsKept::OwnBlock => {
                    if kept.is_some() {
                        self.warn_block("run-out-may-stay");
                    }
                    None
                }
            });
        };
        let across = self.radius(word, Role::RunOut)?.0;
        let along = call.block.word(b'K').map(|word| self.unsigned_length(word)).transpose()?;
        let along = match (along.unwrap_or(Length::ZERO), self.control.policies.run_out_words) {
            (along, RunOutWords::LengthAsDepth) if along.is_zero() => across.abs(),
            (along, _) => along,
        };
        let run_out = (!across.is_zero()).then_some(RunOut { across, along });
        if self.control.policies.run_out_words == RunOutWords::LengthAsDepth {
            self.modal.run_out = run_out;
        }
        Ok(run_out)
    }

    /// Whether the thread of this block goes on from the block before; takes its start angle when it does not.
    pub(super) fn chain_thread(&mut self, call: &Call<'_>, start_angle: Angle) -> Result<bool, Alarm> {
        const ENDS_CHAIN: u32 = super::letters(b"MST");
        let is_chained = self.is_behind_thread() && call.block.present() & ENDS_CHAIN == 0;
        if is_chained && self.ends_in_run_out {
            let diagnostic = Diagnostic::error("run-out-inside-chain").at(self.block_place());
            return Err(self.finish(diagnostic));
        }
        if !is_chained {
            self.thread_start_angle = start_angle;
        }
        self.ends_in_run_out = false;
        self.note_thread_block();
        Ok(is_chained)
    }

    /// The letters of a run-out.
    pub(super) const fn run_out_letters(&self) -> &'static [u8] {
        match self.control.policies.run_out_words {
            RunOutWords::Absent => b"",
            RunOutWords::LengthAsDepth | RunOutWords::StraightOut => b"JK",
        }
    }

    /// Letters that do not belong to threads on this control: those of corners have an alarm of their own.
    pub(super) fn refuse_strange_thread_letters(
        &self,
        call: &Call<'_>,
        own: &[u8],
        run_out: &[u8],
    ) -> Result<(), Alarm> {
        use turnwright_control::policy::{CornerWords, LeadWords};
        let lead: &[u8] = match self.control.policies.lead_words {
            LeadWords::FeedOrExact => b"E",
            LeadWords::FeedOrCount => b"I",
        };
        let corner: &[u8] = match self.control.policies.corner_words {
            CornerWords::ChamferAndRadius => b"IKCR",
            CornerWords::LengthAndFillet => b"LD",
        };
        let strange = call.block.words.iter().find(|word| {
            let knows = |letters: &[u8]| letters.contains(&word.address);
            word.comma || knows(THREAD_LETTERS) && !(knows(own) || knows(lead) || knows(run_out))
        });
        match strange {
            None => Ok(()),
            Some(word) if word.comma || corner.contains(&word.address) => {
                Err(self.alarm("corner-in-thread", word))
            }
            Some(word) => Err(self.alarm("illegal-address", word)),
        }
    }
}
