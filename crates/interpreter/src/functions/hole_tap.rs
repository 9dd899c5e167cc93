//! `face-tapping`, `side-tapping` — tapping cycles (G84, G88).
//!
//! The words and the way are those of `hole.rs`. At the bottom the spindle stops, turns the other way, and the tap comes out
//! at feed to the R point; there it turns as before. A spindle that turns counter-clockwise cuts a left-hand thread.
//!
//! **Flexible.** Feed and spindle know nothing of each other; the holder gives way.
//!
//! **Rigid.** With M29 (5210) before the cycle, or always by 5200#0, the tap follows the spindle: the lead is F with feed
//! per revolution, else F divided by S; on controls whose leads have a sign F is the lead itself, negative for a
//! left-hand thread, or I gives threads per inch. S must be there, and not above 5241. The spindle stands behind each hole.
//! While the tap works the spindle is led: it speeds up, slows down and turns round with the axis, so that neither runs ahead.
//! Q makes pecks, out to the R point (5200#5 at 1) or back by 5213; the way out is faster by 5211 where 5200#4 allows
//! it. Between M29 and the cycle no axis may move and S may not change; the plane stays as it is.
//!
//! Source: tapping cycles, both families; the 980 series taps rigidly without a code, and its help (6.10) calls F a lead.

use turnwright_canon::{Action, SpindleSpeed, SpindleState};
use turnwright_cycles::{Peck, PeckRetract, Tap};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Feed, FeedPerMinute, FeedPerRevolution, Lead, Length, Rpm};

use super::hole::HoleInForce;
use crate::block::Call;
use crate::machine::Core;
use crate::modal::SpeedMode;
use crate::report::Alarm;

/// The M code of rigid tapping where the parameter is zero.
const RIGID_CODE: u32 = 29;

/// Parameters of tapping.
#[derive(Clone, Debug)]
pub(super) struct TapSettings {
    is_always_rigid: bool,
    rigid_code: u32,
    rpm_max: u32,
    pecks_to_r: bool,
    peck_return: Length,
    /// Speed of the way out, percent.
    out_percent: u32,
}

impl TapSettings {
    pub(super) fn new(parameters: &turnwright_control::Parameters) -> Self {
        let count = |name: &str| parameters.value(name).clamp(0.0, 1e9) as u32;
        let out_percent = count("rigid-tap-out-percent");
        Self {
            is_always_rigid: parameters.bit("rigid-tap-without-code"),
            rigid_code: match count("rigid-tap-code") {
                0 => RIGID_CODE,
                code => code,
            },
            rpm_max: count("rigid-tap-maximum-rpm"),
            pecks_to_r: parameters.bit("rigid-tap-pecks-to-r"),
            peck_return: Length::from_nm((parameters.value("rigid-tap-peck-return") * 1e6).round() as i64),
            out_percent: match out_percent {
                1.. if parameters.bit("rigid-tap-out-override") => out_percent,
                _ => 100,
            },
        }
    }
}

impl Core {
    /// An M code was read: it may announce rigid tapping.
    #[inline]
    pub(crate) fn note_rigid_code(&mut self, code: u32, word: &Word) -> Result<(), Alarm> {
        if code == self.settings.hole.tap.rigid_code { self.announce_rigid_tapping(word) } else { Ok(()) }
    }

    #[cold]
    fn announce_rigid_tapping(&mut self, word: &Word) -> Result<(), Alarm> {
        if self.is_capturing() {
            return Ok(());
        }
        if self.modal.awaits_rigid_tap || self.modal.hole.is_some_and(|hole| hole.is_rigid) {
            return Err(self.alarm("rigid-tap-order", word));
        }
        self.modal.awaits_rigid_tap = true;
        self.look_at_moves();
        Ok(())
    }

    /// Rigid tapping that was announced does not come any more.
    pub(super) fn forget_rigid_tapping(&mut self) {
        if std::mem::take(&mut self.modal.awaits_rigid_tap) {
            self.look_at_moves();
        }
    }

    /// An S word between the announcement and the tapping cycle.
    pub(crate) fn check_speed_before_tap(&self, block: &Block, word: &Word) -> Result<(), Alarm> {
        if !self.modal.awaits_rigid_tap || self.modal.motion.get().is_tapping() {
            return Ok(());
        }
        let code = self.settings.hole.tap.rigid_code;
        let announces = |word: &Word| word.address == b'M' && self.whole(word, u32::MAX).ok() == Some(code);
        if block.words.iter().any(announces) { Ok(()) } else { Err(self.alarm("rigid-tap-order", word)) }
    }

    /// The plane may not change while the tap is led.
    pub(super) fn check_plane_before_tap(&self, word: Option<&Word>) -> Result<(), Alarm> {
        if self.modal.awaits_rigid_tap || self.modal.hole.is_some_and(|hole| hole.is_rigid) {
            return Err(self.alarm_at("rigid-tap-plane-change", word));
        }
        Ok(())
    }

    /// R of a tapping cycle; on some controls not known what it counts.
    pub(super) fn tap_r(&self, word: &Word) -> Result<Length, Alarm> {
        let function = self.modal.motion.get().name;
        if self.control.words_for_later(function).as_bytes().contains(&b'R') {
            return Err(self.not_supported(function, word));
        }
        self.length(word)
    }

    /// What the spindle does, and the feed of a flexible tap.
    pub(super) fn tap(
        &mut self,
        call: &Call<'_>,
        hole: &mut HoleInForce,
        peck: Length,
        depth: Length,
    ) -> Result<(Tap, Feed), Alarm> {
        if let Some(word) = call.block.word(b'I').filter(|_| !self.has_signed_leads()) {
            return Err(self.alarm("illegal-address", word));
        }
        let is_announced = self.modal.awaits_rigid_tap;
        self.forget_rigid_tapping();
        hole.is_rigid |= is_announced || self.settings.hole.tap.is_always_rigid;
        let turns = match self.modal.spindle {
            _ if self.has_signed_leads() => self.way_of_lead(call.block),
            SpindleState::CounterClockwise => SpindleState::CounterClockwise,
            SpindleState::Clockwise | SpindleState::Stop => SpindleState::Clockwise,
        };
        let other_way = match turns {
            SpindleState::CounterClockwise => SpindleState::Clockwise,
            _ => SpindleState::CounterClockwise,
        };
        let (stop, forward) = (self.spindle_action_in(SpindleState::Stop), self.spindle_action_in(turns));
        let mut tap = Tap {
            start: Some(forward.clone()).filter(|forward| self.last_spindle.as_ref() != Some(forward)),
            stop,
            reverse: self.spindle_action_in(other_way),
            forward: forward.clone(),
            restart: Some(forward),
            lead: None,
            peck: None,
        };
        if hole.is_rigid {
            return self.rigid_tap(call, tap, peck, depth);
        }
        if let Some(word) = call.block.word(b'Q') {
            return Err(self.alarm("illegal-address", word));
        }
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        if self.modal.spindle == SpindleState::Stop {
            self.warn_once("spindle-not-started-warning");
            // The cycle only turns round what turns.
            tap.start = None;
        }
        self.modal.spindle = turns;
        self.last_spindle = tap.restart.clone();
        Ok((tap, feed))
    }

    fn rigid_tap(
        &mut self,
        call: &Call<'_>,
        mut tap: Tap,
        peck: Length,
        depth: Length,
    ) -> Result<(Tap, Feed), Alarm> {
        let at_speed = call.block.word(b'S').or(call.word);
        let settings = self.settings.hole.tap.clone();
        let rpm = self.modal.rpm;
        let is_too_fast = settings.rpm_max > 0 && rpm.0 > settings.rpm_max;
        if self.modal.speed_mode == SpeedMode::Surface || rpm.0 == 0 || is_too_fast {
            return Err(self.alarm_at("rigid-tap-speed-illegal", at_speed));
        }
        let lead = match self.feed_in_force() {
            _ if self.has_signed_leads() => self.lead_in_force(call)?.0,
            Some(Feed::PerRevolution(FeedPerRevolution(lead))) => lead,
            Some(Feed::PerMinute(FeedPerMinute(feed))) => {
                let rpm = i64::from(rpm.0);
                Length::from_nm(feed.nm().saturating_add(rpm / 2) / rpm)
            }
            None => Length::ZERO,
        };
        if lead.signum() <= 0 {
            return Err(self.alarm_at("rigid-tap-feed-missing", call.block.word(b'F').or(call.word)));
        }
        if depth.is_zero() {
            return Err(self.alarm_at("rigid-tap-distance", call.word));
        }
        let retract = if settings.pecks_to_r {
            PeckRetract::Full(Length::ZERO)
        } else {
            PeckRetract::Short(settings.peck_return)
        };
        let out_percent = settings.out_percent;
        // The faster of both ways.
        let percent = i64::from(out_percent.max(100));
        self.check_thread_speed(call, Lead(Length::from_nm(lead.nm().saturating_mul(percent) / 100)))?;
        tap.peck = (!peck.is_zero()).then_some(Peck { depth: peck, retract });
        tap.lead = Some(Lead(lead));
        tap.restart = None;
        if let Action::Spindle { speed: SpindleSpeed::Constant(rpm), .. } = &mut tap.reverse {
            *rpm = Rpm((u64::from(rpm.0) * u64::from(out_percent) / 100).min(99_999) as u32);
        }
        self.modal.spindle = SpindleState::Stop;
        self.last_spindle = Some(tap.stop.clone());
        Ok((tap, Feed::PerRevolution(FeedPerRevolution(lead))))
    }
}
