//! Nose compensation of the turning and facing cycles.
//!
//! Each of their four moves is shifted by a fixed vector. Those along the axes are cut right by the imaginary tip as
//! they are; the taper is shifted so far along the axis of the infeed that the nose touches it from the side of the start
//! point. The ways between them stay where they were, and no joints are inserted.
//!
//! A tip that points away from the work would overcut it: an alarm by policy.
//!
//! Source: tool nose radius compensation with single cycles.

use turnwright_control::policy::SingleCycleOvercut;
use turnwright_cycles::FirstAxis;
use turnwright_geometry::{Offset, Segment, Side};
use turnwright_units::{Length, Position, Radius, WorkTip};

use super::element;
use crate::block::Call;
use crate::machine::Core;
use crate::plane::point;
use crate::report::Alarm;

impl Core {
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
        let cut_start = match first {
            FirstAxis::X => Position::new(end.x + Radius(taper), start.z),
            FirstAxis::Z => Position::new(start.x, end.z + taper),
        };
        let cut = Segment { start: point(cut_start), end: point(end), bend: None };
        let along_first = |x: f64, z: f64| if first == FirstAxis::X { x } else { z };
        let to_start = along_first((start.x - end.x).to_mm(), (start.z - end.z).to_mm());
        let square = [Side::Left, Side::Right]
            .map(|side| Offset { side, radius_mm: 1.0 }.at_start(&cut))
            .into_iter()
            .find(|square| along_first(square.x, square.z) * to_start > NOTHING);
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
