//! `multi-thread` — a thread in many passes (G76; G78 in system C).
//!
//! `G76 P(m)(r)(a) Q(Δdmin) R(d)`, then `G76 X(U)_ Z(W)_ R(i) P(k) Q(Δd) F(L)`. The block with an end point runs
//! the cycle, the one without stores its values in the parameters: m finishing passes, run-out r in tenths of
//! the lead, nose angle a (two digits each), least depth, finishing allowance. k is the height, Δd the first
//! depth, both without sign in least increments (or millimetres by parameter), i the taper as a radius with
//! sign. X is the root of an outside thread, the major diameter of an inside one.
//!
//! Source: multiple thread cutting cycle of both families.

use turnwright_control::policy::{ThreadAngles, ThreadDepthClamp};
use turnwright_cycles as cycles;
use turnwright_syntax::{Block, Word};
use turnwright_units::{Angle, Feed, FeedPerRevolution, Radius};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static MULTI_THREAD: Function =
    Function::one_shot("multi-thread", multi_thread).with_letters(b"PQRDIKA").with_lead().multiple_cycle();

/// Nose angles of the controls that list them.
const LISTED_ANGLES: [u32; 6] = [0, 29, 30, 55, 60, 80];

fn multi_thread(core: &mut Core, call: &mut Call<'_>) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    let has_end = call.block.present() & super::AXES != 0;
    let one_block = b"DIKA".iter().find_map(|letter| call.block.word(*letter));
    if let Some(word) = one_block {
        return Err(if has_end { core.one_block_form(word) } else { core.alarm("cycle-word-illegal", word) });
    }
    if has_end { core.run_multi_thread(call) } else { core.store_multi_thread(call.block) }
}

impl Core {
    fn store_multi_thread(&mut self, block: &Block) -> Result<(), Alarm> {
        if let Some(word) = block.word(b'P') {
            self.store_thread_digits(word)?;
        }
        if let Some(word) = block.word(b'Q') {
            let depth = self.cycle_length(word)?;
            if depth.signum() < 0 {
                return Err(self.alarm("minus-not-allowed", word));
            }
            self.settings.thread_minimum_depth = Radius(depth);
        }
        if let Some(word) = block.word(b'R') {
            self.settings.thread_finishing_allowance = Radius(self.unsigned_length(word)?);
            self.missing_point(word);
        }
        Ok(())
    }

    /// `P mmrraa`: parts that are not written keep their values.
    fn store_thread_digits(&mut self, word: &Word) -> Result<(), Alarm> {
        let value = self.whole(word, 999_999)?;
        let typed = self.number(word)?.typed_digits;
        let (passes, run_out, angle) = (value / 10_000, value / 100 % 100, value % 100);
        let is_allowed = match self.control.policies.thread_angles {
            ThreadAngles::Listed => LISTED_ANGLES.contains(&angle),
            ThreadAngles::Any => true,
        };
        if !is_allowed {
            return Err(self.alarm("thread-angle-illegal", word));
        }
        self.settings.thread_nose_angle_deg = angle as u8;
        if typed > 2 || value > 99 {
            self.settings.run_out_tenths = run_out;
        }
        if passes > 0 {
            self.settings.thread_finishing_passes = passes;
        }
        Ok(())
    }

    /// P or Q of the block that runs the cycle: more than zero.
    fn thread_depth(&self, call: &Call<'_>, letter: u8) -> Result<Radius, Alarm> {
        let Some(word) = call.block.word(letter) else {
            return Err(self.alarm_at("thread-height-or-depth-illegal", call.word));
        };
        let depth = self.cycle_length(word)?;
        if depth.signum() <= 0 {
            return Err(self.alarm("thread-height-or-depth-illegal", word));
        }
        Ok(Radius(depth))
    }

    fn run_multi_thread(&mut self, call: &mut Call<'_>) -> Result<(), Alarm> {
        let end = self.target(call.block)?;
        let height = self.thread_depth(call, b'P')?;
        let first_depth = self.thread_depth(call, b'Q')?;
        let taper = self.optional_radius(call.block, b'R', Role::TaperRadius)?.unwrap_or(Radius::ZERO);
        if let Some(word) = call.block.word(b'R') {
            self.missing_point(word);
        }
        let lead = self.lead_in_force(call)?;
        self.check_thread_spindle()?;
        if (self.modal.position.x - end.x).0.abs() < height.0 {
            // The crest lies further out than the start: the first infeed would lead away from the work.
            self.warn_block("thread-start-inside");
        }
        let settings = &self.settings;
        let request = cycles::ThreadRequest {
            context: self.cycle_context(Feed::PerRevolution(FeedPerRevolution(lead.0))),
            end,
            taper,
            height,
            first_depth,
            min_depth: settings.thread_minimum_depth,
            finishing_allowance: settings.thread_finishing_allowance,
            finishing_passes: settings.thread_finishing_passes,
            run_out: run_out(lead, settings.run_out_tenths),
            run_out_angle_deg: settings.run_out_angle_deg,
            nose_angle_deg: settings.thread_nose_angle_deg,
            lead,
            start_angle: Angle::ZERO,
            clamp: match self.control.policies.thread_depth_clamp {
                ThreadDepthClamp::Accumulate => cycles::Clamp::Accumulate,
                ThreadDepthClamp::Formula => cycles::Clamp::Formula,
            },
        };
        let thread = cycles::thread(request).map_err(|fault| self.misuse(fault, call))?;
        if thread.run_out_shortened().is_some() {
            self.warn_block("run-out-shortened");
        }
        self.start_cycle(CycleMoves::Threading(Box::new(thread)), call.code, Vec::new(), 0)
    }
}

/// The run-out: tenths of the lead.
pub(super) fn run_out(lead: turnwright_units::Lead, tenths: u32) -> turnwright_units::Length {
    turnwright_units::Length::from_nm(lead.0.nm().saturating_mul(i64::from(tenths)) / 10)
}
