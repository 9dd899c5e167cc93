//! `multi-thread`, `enhanced-thread`, `enhanced-thread-980` — a thread in many passes (G76; G78 in system C; G78 of GSK).
//!
//! `G76 P(m)(r)(a) Q(Δdmin) R(d)`, then `G76 X(U)_ Z(W)_ R(i) P(k) Q(Δd) F(L)`. The block with an end point runs
//! the cycle, the one without stores its values in the parameters: m finishing passes, run-out r in tenths of
//! the lead, nose angle a (two digits each), least depth, finishing allowance. k is the height, Δd the first
//! depth, both without sign in least increments (or millimetres by parameter), i the taper as a radius with
//! sign. X is the root of an outside thread, the major diameter of an inside one. What fewer digits than six mean is a
//! policy.
//!
//! In one block (`one_block.rs`): `G76 X(U)_ Z(W)_ I(i) K(k) D(Δd) A(a) F(L) P_ Q_`. A is a whole angle up to 120, P
//! the method: 1 down one flank in equal areas (as without P), 2 down both flanks in turn, 3 and 4 the same in equal
//! depths; Q is the start angle.
//!
//! **Further words of GSK.** On the 980 series J and K in the block that stores are the run-out across and along, on
//! the 988 series in the block that cuts; they stay in force in place of r until r is written again. J zero is no
//! run-out; J alone is as long as deep there, here straight out. The 988 series stores D as well (0 down one flank, 1
//! every second pass over the root, 2 both flanks in turn) and L, the number of starts: each depth is cut once a start,
//! the starts a share of the turn apart.
//!
//! `enhanced-thread` has the words of G76 without D and L; parameters choose flank (5144) and depths (5145), and
//! steps clamped by the least depth stay equal.
//!
//! `enhanced-thread-980` says with its words what those parameters say: of P, m is the way of the depths (0 equal steps,
//! 1 as G76), r the flank (0 straight in, 1 left, 2 right, 3 both in turn), a the angle; D counts the finishing passes,
//! L the starts, J and K are the run-out, which r is not there. What P leaves unwritten stays as it was, at first by
//! parameters 061 and 062. That m, r and a have two digits each as in G76 is taken over from there. D and L count
//! for this cycle alone. E, a run-in across the axis, is refused: over which length it goes down is not told.
//!
//! Source: multiple thread cutting cycle of both families; programming help of the 980TDi, version 6.10.

use turnwright_control::policy::{MultiThreadWords, ThreadAngles, ThreadDepthClamp, ThreadDigits};
use turnwright_cycles as cycles;
use turnwright_syntax::{Block, Word};
use turnwright_units::{
    Angle, Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Position, Radius, WorkTip,
};

use super::Function;
use super::one_block::Form;
use crate::block::Call;
use crate::machine::Core;
use crate::moves::CycleMoves;
use crate::report::Alarm;
use crate::words::Role;

pub(super) static MULTI_THREAD: Function =
    Function::one_shot("multi-thread", |core, call| multi_thread(core, call, Cycle::Common))
        .with_letters(b"PQRDIJKLAE")
        .with_lead()
        .multiple_cycle();

pub(super) static ENHANCED_THREAD: Function =
    Function::one_shot("enhanced-thread", |core, call| multi_thread(core, call, Cycle::Enhanced))
        .with_letters(b"PQRDIJKLAE")
        .with_lead()
        .multiple_cycle();

pub(super) static ENHANCED_THREAD_980: Function =
    Function::one_shot("enhanced-thread-980", |core, call| multi_thread(core, call, Cycle::EnhancedByWords))
        .with_letters(b"PQRDIJKLAE")
        .with_lead()
        .multiple_cycle();

/// Which of the cycles: they differ in where flank and depths come from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cycle {
    Common,
    /// From parameters.
    Enhanced,
    /// From words of the block that stores.
    EnhancedByWords,
}

/// Nose angles of the controls that list them.
const LISTED_ANGLES: [u32; 6] = [0, 29, 30, 55, 60, 80];
/// Largest angle of the form in one block.
const ANGLE_MAX_DEG: u32 = 120;
/// Most starts that L may ask for.
const STARTS_MAX: u32 = 999;

/// J and K of threading cycles: how deep and how long the run-out is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RunOutWords {
    pub(crate) depth: Option<Length>,
    pub(crate) length: Option<Length>,
}

/// The words of the block that cuts.
struct ThreadWords {
    taper: Radius,
    height: Radius,
    first_depth: Radius,
    nose_angle_deg: u8,
    start_angle: Angle,
    depths: cycles::DepthLaw,
    infeed: cycles::FlankInfeed,
    finishing_passes: u32,
    starts: u32,
}

fn multi_thread(core: &mut Core, call: &mut Call<'_>, cycle: Cycle) -> Result<(), Alarm> {
    core.refuse_comma_words(call.block)?;
    if call.block.present() & super::AXES == 0 {
        return core.store_multi_thread(call.block, cycle);
    }
    let form = core.cycle_form(call.block, b"DIKA")?;
    core.refuse_letters(call.block, core.foreign_thread_letters(form))?;
    let words = if form == Form::TwoBlocks {
        core.thread_words(call, cycle)?
    } else {
        core.thread_words_in_one_block(call, form)?
    };
    core.run_multi_thread(call, words)
}

impl Core {
    fn store_multi_thread(&mut self, block: &Block, cycle: Cycle) -> Result<(), Alarm> {
        let words = self.control.policies.multi_thread_words;
        let by_words = cycle == Cycle::EnhancedByWords;
        if let Some(word) = block.word(b'E').filter(|_| by_words) {
            return Err(self.not_supported(ENHANCED_THREAD_980.name, word));
        }
        self.refuse_letters(
            block,
            match (words, cycle) {
                (_, Cycle::EnhancedByWords) => b"IA",
                (MultiThreadWords::Plain, _) => b"DIJKLAE",
                (MultiThreadWords::RunOutInData, _) => b"DILAE",
                (MultiThreadWords::FlanksAndStarts, Cycle::Common) => b"IJKAE",
                (MultiThreadWords::FlanksAndStarts, Cycle::Enhanced) => b"DIJKLAE",
            },
        )?;
        if let Some(word) = block.word(b'P') {
            if by_words { self.store_enhanced_digits(word)? } else { self.store_thread_digits(word)? }
        }
        if let Some(word) = block.word(b'Q') {
            let depth = self.cycle_length(word)?;
            if depth.signum() < 0 {
                return Err(self.alarm("minus-not-allowed", word));
            }
            self.settings.thread_minimum_depth = Radius(depth);
            self.note_given("thread-minimum-depth", word);
        }
        if let Some(word) = block.word(b'R') {
            self.settings.thread_finishing_allowance = Radius(self.unsigned_length(word)?);
            self.missing_point(word);
            self.note_given("thread-finishing-allowance", word);
        }
        if by_words {
            self.store_enhanced_words(block)?;
            return self.store_run_out(block);
        }
        if let Some(word) = block.word(b'D') {
            self.settings.thread_infeed = match self.whole(word, 99)? {
                0 => cycles::FlankInfeed::WithCut,
                1 => cycles::FlankInfeed::FlankAndCentre,
                2 => cycles::FlankInfeed::BothFlanks,
                _ => return Err(self.alarm("thread-method-illegal", word)),
            };
        }
        if let Some(word) = block.word(b'L') {
            self.settings.thread_starts = match self.whole(word, 99_999_999)? {
                starts @ 1..=STARTS_MAX => starts,
                _ => return Err(self.alarm("thread-starts-illegal", word)),
            };
        }
        self.store_run_out(block)
    }

    /// `P mmrraa` of the cycle whose words choose depths and flank.
    fn store_enhanced_digits(&mut self, word: &Word) -> Result<(), Alarm> {
        let value = self.whole(word, 999_999)?;
        let typed = self.number(word)?.typed_digits;
        let (depths, flank, angle) = (value / 10_000, value / 100 % 100, value % 100);
        let Some(infeed) = flank_infeed(flank).filter(|_| depths <= 1) else {
            return Err(self.alarm("thread-method-illegal", word));
        };
        self.settings.thread_nose_angle_deg = angle as u8;
        self.note_given("thread-nose-angle", word);
        if typed > 2 || value > 99 {
            self.settings.enhanced_thread_infeed = infeed;
        }
        if typed > 4 || value > 9_999 {
            self.settings.enhanced_thread_equal_steps = depths == 0;
        }
        Ok(())
    }

    /// D and L of the same cycle.
    fn store_enhanced_words(&mut self, block: &Block) -> Result<(), Alarm> {
        if let Some(word) = block.word(b'D') {
            self.settings.enhanced_thread_finishing_passes = Some(self.whole(word, 99)?).filter(|n| *n > 0);
        }
        if let Some(word) = block.word(b'L') {
            self.settings.enhanced_thread_starts = self.thread_starts(word)?;
        }
        Ok(())
    }

    /// J and K stay in force; r written after them takes their place.
    fn store_run_out(&mut self, block: &Block) -> Result<(), Alarm> {
        let depth = block.word(b'J').map(|word| self.unsigned_length(word)).transpose()?;
        let length = block.word(b'K').map(|word| self.unsigned_length(word)).transpose()?;
        let words = &mut self.settings.thread_run_out_words;
        words.depth = depth.or(words.depth);
        words.length = length.or(words.length);
        Ok(())
    }

    /// `P mmrraa`.
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
        let has_run_out = match self.control.policies.thread_digits {
            ThreadDigits::LeadingZeros => {
                if typed < 5 && value < 10_000 {
                    self.warn("thread-digits-short", word);
                }
                true
            }
            ThreadDigits::PartsWritten => typed > 2 || value > 99,
            ThreadDigits::AllParts if typed < 5 && value < 10_000 => {
                return Err(self.alarm("thread-digits-missing", word));
            }
            ThreadDigits::AllParts => true,
        };
        self.settings.thread_nose_angle_deg = angle as u8;
        if has_run_out {
            self.settings.run_out_tenths = run_out;
            self.settings.thread_run_out_words = RunOutWords::default();
        }
        if passes > 0 {
            self.settings.thread_finishing_passes = passes;
            self.note_given("thread-finishing-passes", word);
        }
        self.note_given("thread-nose-angle", word);
        Ok(())
    }

    /// Letters that the block that cuts does not take.
    const fn foreign_thread_letters(&self, form: Form) -> &'static [u8] {
        if !matches!(form, Form::TwoBlocks) {
            return b"RJL";
        }
        match self.control.policies.multi_thread_words {
            MultiThreadWords::Plain => b"DIJKLA",
            MultiThreadWords::RunOutInData => b"DJKLAE",
            MultiThreadWords::FlanksAndStarts => b"DLAE",
        }
    }

    /// P, Q and R of the block that cuts.
    fn thread_words(&mut self, call: &Call<'_>, cycle: Cycle) -> Result<ThreadWords, Alarm> {
        let positive = |letter| self.thread_depth(call, letter, |word| self.cycle_length(word));
        let (height, first_depth) = (positive(b'P')?, positive(b'Q')?);
        self.store_run_out(call.block)?;
        let clamp = match self.control.policies.thread_depth_clamp {
            ThreadDepthClamp::Formula if cycle != Cycle::Enhanced => cycles::Clamp::Formula,
            ThreadDepthClamp::Accumulate | ThreadDepthClamp::Formula => cycles::Clamp::Accumulate,
        };
        let settings = &self.settings;
        let (infeed, depths) = match cycle {
            Cycle::Common => (settings.thread_infeed, cycles::DepthLaw::EqualArea(clamp)),
            _ if settings.enhanced_thread_equal_steps => {
                (settings.enhanced_thread_infeed, cycles::DepthLaw::EqualSteps)
            }
            _ => (settings.enhanced_thread_infeed, cycles::DepthLaw::EqualArea(clamp)),
        };
        let (mut finishing_passes, mut starts) = (settings.thread_finishing_passes, settings.thread_starts);
        if cycle == Cycle::EnhancedByWords {
            finishing_passes = settings.enhanced_thread_finishing_passes.unwrap_or(finishing_passes);
            starts = settings.enhanced_thread_starts;
        }
        Ok(ThreadWords {
            taper: self.thread_taper(call, b'R')?,
            height,
            first_depth,
            nose_angle_deg: self.settings.thread_nose_angle_deg,
            start_angle: Angle::ZERO,
            depths,
            infeed,
            finishing_passes,
            starts,
        })
    }

    /// I, K, D, A, P and Q of the form in one block.
    fn thread_words_in_one_block(&mut self, call: &Call<'_>, form: Form) -> Result<ThreadWords, Alarm> {
        let height = self.thread_depth(call, b'K', |word| self.length(word))?;
        if let Some(word) = call.block.word(b'K') {
            self.missing_point(word);
        }
        let first_depth = match call.block.word(b'D') {
            Some(word) => self.one_block_depth(word, form)?,
            None => return Err(self.alarm_at("thread-height-or-depth-illegal", call.word)),
        };
        if first_depth.signum() <= 0 {
            return Err(self.alarm_at("thread-height-or-depth-illegal", call.block.word(b'D')));
        }
        let nose_angle_deg = match call.block.word(b'A') {
            Some(word) => match self.whole(word, 999)? {
                angle @ 0..=ANGLE_MAX_DEG => angle as u8,
                _ => return Err(self.alarm("thread-angle-illegal", word)),
            },
            None => 0,
        };
        let method = call.block.word(b'P').map_or(Ok(1), |word| match self.whole(word, 99)? {
            method @ 1..=4 => Ok(method),
            _ => Err(self.alarm("thread-method-illegal", word)),
        })?;
        Ok(ThreadWords {
            taper: self.thread_taper(call, b'I')?,
            height,
            first_depth: Radius(first_depth),
            nose_angle_deg,
            start_angle: self.start_angle(call)?,
            depths: match method {
                1 | 2 => cycles::DepthLaw::EqualArea(cycles::Clamp::Accumulate),
                _ => cycles::DepthLaw::EqualSteps,
            },
            infeed: match method {
                1 | 3 => cycles::FlankInfeed::WithCut,
                _ => cycles::FlankInfeed::BothFlanks,
            },
            finishing_passes: self.settings.thread_finishing_passes,
            starts: self.settings.thread_starts,
        })
    }

    fn thread_taper(&mut self, call: &Call<'_>, letter: u8) -> Result<Radius, Alarm> {
        if let Some(word) = call.block.word(letter) {
            self.missing_point(word);
        }
        Ok(self.optional_radius(call.block, letter, Role::TaperRadius)?.unwrap_or(Radius::ZERO))
    }

    /// A height or depth of the block that cuts: it must be there, and more than zero.
    fn thread_depth(
        &self,
        call: &Call<'_>,
        letter: u8,
        length: impl Fn(&Word) -> Result<Length, Alarm>,
    ) -> Result<Radius, Alarm> {
        let Some(word) = call.block.word(letter) else {
            return Err(self.alarm_at("thread-height-or-depth-illegal", call.word));
        };
        let depth = length(word)?;
        if depth.signum() <= 0 {
            return Err(self.alarm("thread-height-or-depth-illegal", word));
        }
        Ok(Radius(depth))
    }

    fn run_multi_thread(&mut self, call: &mut Call<'_>, words: ThreadWords) -> Result<(), Alarm> {
        let end = self.target(call.block)?;
        let lead = self.lead_in_force(call)?;
        self.check_thread(call, lead)?;
        self.check_thread_place(call, &words, end, lead)?;
        let (run_out, run_out_depth) = self.multi_thread_run_out(call, lead, end)?;
        let settings = &self.settings;
        let request = cycles::ThreadRequest {
            context: self.cycle_context(Feed::PerRevolution(FeedPerRevolution(lead.0))),
            end,
            taper: words.taper,
            height: words.height,
            first_depth: words.first_depth,
            min_depth: settings.thread_minimum_depth,
            finishing_allowance: settings.thread_finishing_allowance,
            finishing_passes: words.finishing_passes,
            run_out,
            run_out_angle_deg: settings.run_out_angle_deg,
            run_out_depth,
            pull_out_feed: settings.thread_pull_out_feed.map(FeedPerMinute),
            nose_angle_deg: words.nose_angle_deg,
            lead,
            start_angle: words.start_angle,
            starts: words.starts,
            depths: words.depths,
            infeed: words.infeed,
        };
        let thread = cycles::thread(request).map_err(|fault| self.misuse(fault, call))?;
        if thread.run_out_shortened().is_some() {
            self.warn_block("run-out-shortened");
        }
        let outward = if self.modal.position.x.0 < end.x.0 { Radius(-words.height.0) } else { words.height };
        self.thread_crest = Some(end.x + words.taper + outward);
        self.start_cycle(CycleMoves::Threading(Box::new(thread)), call.code, Vec::new(), 0)
    }

    /// Length and depth of the run-out: J and K while they are in force, else tenths of the lead.
    fn multi_thread_run_out(
        &mut self,
        call: &Call<'_>,
        lead: Lead,
        end: Position<WorkTip>,
    ) -> Result<(Length, Option<Length>), Alarm> {
        let words = self.settings.thread_run_out_words;
        let (along, depth) = match self.run_out_by_words(words) {
            Some((along, depth)) => (along, Some(depth)),
            None => (run_out(lead, self.settings.run_out_tenths), None),
        };
        let has_words = self.control.policies.multi_thread_words != MultiThreadWords::Plain;
        if has_words && along > (end.z - self.modal.position.z).abs() {
            let word = call.block.word(b'K').or(call.block.word(b'J')).or(call.word);
            return Err(self.alarm_at("run-out-too-long", word));
        }
        Ok((along, depth))
    }

    /// What a machinist would look at twice before the first pass.
    fn check_thread_place(
        &mut self,
        call: &Call<'_>,
        words: &ThreadWords,
        end: Position<WorkTip>,
        lead: Lead,
    ) -> Result<(), Alarm> {
        let start = self.modal.position;
        self.check_taper(call, cycles::FirstAxis::X, end, words.taper.0)?;
        let outward = (start.x - end.x).0.signum();
        let is_too_near = |root: Radius| {
            let room = (start.x - root).0;
            room.signum() != outward || room.abs() < words.height.0
        };
        if is_too_near(end.x) || is_too_near(end.x + words.taper) {
            // The crest lies further out than the start: the first infeed would lead away from the work.
            self.warn_block("thread-start-inside");
        }
        let flank_mm = words.height.to_mm() * libm::tan(f64::from(words.nose_angle_deg).to_radians() / 2.0);
        self.check_lead_in(end, lead, flank_mm);
        Ok(())
    }

    /// Whether the way from the start to the face is long enough is known only where Z0 is the face.
    pub(super) fn check_lead_in(&mut self, end: Position<WorkTip>, lead: Lead, flank_mm: f64) {
        let start = self.modal.position.z;
        let is_from_face = start.signum() >= 0 && end.z.signum() < 0;
        if is_from_face && start.to_mm() - flank_mm < LEAD_IN_LEADS * lead.0.to_mm() {
            self.warn_block("thread-lead-in-short");
        }
    }
}

/// The least way of a thread before the work, in leads: the axis has to come up to the spindle's pace.
const LEAD_IN_LEADS: f64 = 2.0;

/// The flank that a number chooses.
pub(crate) const fn flank_infeed(number: u32) -> Option<cycles::FlankInfeed> {
    Some(match number {
        0 => cycles::FlankInfeed::Centre,
        1 => cycles::FlankInfeed::AgainstCut,
        2 => cycles::FlankInfeed::WithCut,
        3 => cycles::FlankInfeed::BothFlanks,
        _ => return None,
    })
}

/// The run-out: tenths of the lead.
pub(super) fn run_out(lead: Lead, tenths: u32) -> Length {
    Length::from_nm(lead.0.nm().saturating_mul(i64::from(tenths)) / 10)
}
