//! Nose compensation of the turning and facing cycles, and of the thread cutting cycle.
//!
//! A thread keeps the vector that it finds, through all moves of its cycle, and no joints are made. Of the others each of their four moves is shifted by a fixed vector. Those along the axes are cut right by the imaginary tip as
//! they are; the taper is shifted so far along the axis of the infeed that the nose touches it from the side of the start
//! point, or by policy from that of G41 or G42. The ways between them stay where they were, and no joints are inserted.
//!
//! A tip that points away from the work would overcut it: an alarm by policy.
//!
//! Source: tool nose radius compensation with single cycles.

use turnwright_control::policy::{SingleCycleOvercut, SingleCycleSide};
use turnwright_cycles::FirstAxis;
use turnwright_geometry::{Offset, Segment, Side};
use turnwright_units::{Length, Position, Radius, WorkTip};

use super::element;
use crate::block::Call;
use crate::machine::Core;
use crate::plane::point;
use crate::report::Alarm;

/// The cut of a single cycle.
fn cut(start: Position<WorkTip>, first: FirstAxis, end: Position<WorkTip>, taper: Length) -> Segment {
    let cut_start = match first {
        FirstAxis::X => Position::new(end.x + Radius(taper), start.z),
        FirstAxis::Z => Position::new(start.x, end.z + taper),
    };
    Segment { start: point(cut_start), end: point(end), bend: None }
}

impl Core {
    /// Before the thread cutting cycle: the nose stands square to the move before it, and stays so.
    pub(crate) fn keep_vector(
        &mut self,
        call: &Call<'_>,
        first: FirstAxis,
        end: Position<WorkTip>,
        taper: Length,
    ) -> Result<(), Alarm> {
        let Some(mut path) = self.compensation.take() else { return Ok(()) };
        let is_on = path.side.is_some();
        let beside = cut(self.modal.position, first, end, taper);
        let result = if is_on { self.square_off(&mut path, Some(&beside)) } else { Ok(()) };
        self.compensation = Some(path);
        result?;
        if !is_on {
            return self.suspend_compensation();
        }
        if call.word.is_some() {
            self.warn_block("thread-in-compensation");
        }
        Ok(())
    }

    /// Where the cut of a turning or facing cycle ends, with its taper touched by the nose.
    pub(crate) fn beside_taper(
        &self,
        call: &Call<'_>,
        first: FirstAxis,
        end: Position<WorkTip>,
        taper: Length,
    ) -> Result<Position<WorkTip>, Alarm> {
        /// What the rounding of the numbers leaves of nothing.
        const NOTHING: f64 = 1e-9;
        let is_on = self.compensation.as_ref().is_some_and(|path| path.side.is_some());
        let nose = self.nose();
        if !is_on || nose.radius.is_zero() {
            return Ok(end);
        }
        let start = self.modal.position;
        let cut = cut(start, first, end, taper);
        let along_first = |x: f64, z: f64| if first == FirstAxis::X { x } else { z };
        let to_start = along_first((start.x - end.x).to_mm(), (start.z - end.z).to_mm());
        let beside = |side| Offset { side, radius_mm: 1.0 }.at_start(&cut);
        let by_code = self.control.policies.single_cycle_side == SingleCycleSide::Code;
        let asked = self.compensation.as_ref().and_then(|path| path.side).filter(|_| by_code);
        let square = match asked {
            Some(side) => Some(beside(side)).filter(|square| along_first(square.x, square.z).abs() > NOTHING),
            None => [Side::Left, Side::Right]
                .map(beside)
                .into_iter()
                .find(|square| along_first(square.x, square.z) * to_start > NOTHING),
        };
        let Some(square) = square else { return Ok(end) };
        let tip = element::to_tip(nose);
        let tip_ahead = square.x * tip.x + square.z * tip.z;
        if tip_ahead > NOTHING && self.control.policies.single_cycle_overcut == SingleCycleOvercut::Alarm {
            return Err(self.alarm_at("single-cycle-overcut", call.word.or(call.block.word(b'R'))));
        }
        let shift = (nose.radius.abs().to_mm() + tip_ahead) / along_first(square.x, square.z);
        let mut shifted = point(end);
        match first {
            FirstAxis::X => shifted.x += shift,
            FirstAxis::Z => shifted.z += shift,
        }
        self.snapped(shifted)
    }
}
