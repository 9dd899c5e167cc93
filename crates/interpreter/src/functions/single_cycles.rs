//! `turning-cycle`, `thread-cycle`, `facing-cycle` — four moves in one block (G90, G92, G94; G77 to G79 in
//! system B; G20, G21, G24 in system C).
//!
//! `G90 X(U)_ Z(W)_ R_ F_`: rapid to the depth, cut to the end point, out at feed, rapid home. `G94` does the
//! same along X. `G92` cuts a thread with lead F and leaves it at rapid; near its end the tool runs out at 45
//! degrees (5130, 5131). R is the taper: start of the cut less its end, a radius for G90 and G92, a Z length for
//! G94.
//!
//! X, Z and R stay in force while the code does: a block with a new X repeats the cycle from the same start
//! point. A code of its own without any axis word only takes effect with the next axis word.
//!
//! Source: single canned cycles of both families.

use turnwright_control::policy::TaperSign;
use turnwright_cycles as cycles;
use turnwright_units::{Angle, Feed, FeedPerRevolution, Length, Position, Radius};

use super::multi_thread::run_out;
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
    .with_letters(b"RQ")
    .triggered_by(b"R")
    .with_lead()
    .repeating();

fn box_cycle(core: &mut Core, call: &mut Call<'_>, first: cycles::FirstAxis) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let end = core.single_cycle_words(call, first == cycles::FirstAxis::X)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let taper = core.modal.cycle.taper;
    core.check_taper(call, first, end, taper)?;
    let request = cycles::BoxRequest { context: core.cycle_context(feed), first, end, taper };
    let cycle = cycles::box_cycle(request).map_err(|fault| core.misuse(fault, call))?;
    let passes_before = core.count_single_cycle();
    core.start_cycle(CycleMoves::Box(Box::new(cycle)), call.code, Vec::new(), passes_before)
}

fn thread_cycle(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let end = core.single_cycle_words(call, true)?;
    let lead = core.lead_in_force(call)?;
    if call.block.has(b'Q') {
        core.modal.cycle.start_angle_millidegrees = core.start_angle(call)?.millidegrees();
    }
    core.check_thread_spindle()?;
    let taper = core.modal.cycle.taper;
    core.check_taper(call, cycles::FirstAxis::X, end, taper)?;
    let request = cycles::ThreadOnceRequest {
        context: core.cycle_context(Feed::PerRevolution(FeedPerRevolution(lead.0))),
        end,
        taper: Radius(taper),
        lead,
        start_angle: Angle::from_millidegrees(core.modal.cycle.start_angle_millidegrees),
        run_out: run_out(lead, core.settings.run_out_tenths),
        run_out_angle_deg: core.settings.run_out_angle_deg,
    };
    let cycle = cycles::thread_once(request).map_err(|fault| core.misuse(fault, call))?;
    if cycle.run_out_shortened().is_some() {
        core.warn_block("run-out-shortened");
    }
    let passes_before = core.count_single_cycle();
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
            let to = self.target(call.block)?;
            if present & letters(b"XU") != 0 {
                self.modal.cycle.x = Some(to.x);
            }
            if present & letters(b"ZW") != 0 {
                self.modal.cycle.z = Some(to.z);
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

    /// Counts the pass that begins; gives how many there were.
    fn count_single_cycle(&mut self) -> u32 {
        let before = self.modal.cycle.pass;
        self.modal.cycle.pass = before.saturating_add(1);
        before
    }

    fn check_taper(
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
