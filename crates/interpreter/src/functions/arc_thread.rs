//! `arc-thread-clockwise`, `arc-thread-counter-clockwise`, `circular-thread-clockwise`,
//! `circular-thread-counter-clockwise` — threads along an arc (G32.2 and G32.3, or the option G35 and G36).
//!
//! `G35 X(U)_ Z(W)_ R_ F_ Q_` or with I and K as in `arc.rs`. F is the lead along the long axis: Z where the arc runs
//! nearer to Z, X where it runs nearer to X. It may not change within a block, so the arc must stay in one quarter of
//! its circle between the 45-degree places, and both axes may not come back to where they were. I is the centre here,
//! so threads per inch count only from an earlier block. There is no run-out. Chains are those of `thread.rs`.
//!
//! Source: circular thread cutting, both families.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_geometry::{ArcFault, Point, centre_from_radius};
use turnwright_units::{Length, Position, Radius, WorkTip};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::plane::{place, point};
use crate::report::Alarm;
use crate::words::Role;

const fn arc_function(name: &'static str, run: super::Run) -> Function {
    Function::motion(name, run).with_letters(b"QEIJKRCLD").with_lead()
}

pub(super) static ARC_THREAD_CLOCKWISE: Function =
    arc_function("arc-thread-clockwise", |core, call| arc_thread(core, call, Turn::Clockwise));

pub(super) static ARC_THREAD_COUNTER_CLOCKWISE: Function =
    arc_function("arc-thread-counter-clockwise", |core, call| arc_thread(core, call, Turn::CounterClockwise));

pub(super) static CIRCULAR_THREAD_CLOCKWISE: Function =
    arc_function("circular-thread-clockwise", |core, call| arc_thread(core, call, Turn::Clockwise));

pub(super) static CIRCULAR_THREAD_COUNTER_CLOCKWISE: Function =
    arc_function("circular-thread-counter-clockwise", |core, call| {
        arc_thread(core, call, Turn::CounterClockwise)
    });

fn arc_thread(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    core.refuse_strange_thread_letters(call, b"QRIK", b"")?;
    core.move_before_bend(call)?;
    let from = core.modal.position;
    let to = core.target(call.block)?;
    let lead = core.lead_in_force_beside_centre(call)?;
    let start_angle = core.start_angle(call)?;
    let centre = core.arc_thread_centre(call, from, to, turn)?;
    let tolerance_mm = core.modal.increment(&core.settings).to_mm();
    if !has_one_long_axis(point(from), point(to), point(centre), turn, tolerance_mm) {
        return Err(core.alarm_at("arc-thread-illegal", call.word));
    }
    core.check_thread(call, lead)?;
    let is_chained = core.chain_thread(call, start_angle)?;
    let start_angle = core.thread_start_angle;
    core.modal.position = to;
    let shape = Shape::Arc { turn, centre };
    core.emit_move(to, Action::Thread { to, shape, lead, lead_end: None, start_angle, is_chained })
}

/// Whether one axis is the long one all along an arc: both ends lie in the same quarter about the centre, between
/// its 45-degree places, and the way between them is the short one.
fn has_one_long_axis(start: Point, end: Point, centre: Point, turn: Turn, tolerance_mm: f64) -> bool {
    let arm = |place: Point| (place.x - centre.x, place.z - centre.z);
    let ((start_x, start_z), (end_x, end_z)) = (arm(start), arm(end));
    // Above and below the centre an arc runs along Z, left and right of it along X.
    let within = |main: [f64; 2], other: [f64; 2]| {
        main[0] * main[1] > 0.0 && (0..2).all(|end| other[end].abs() <= main[end].abs() + tolerance_mm)
    };
    let fits = within([start_x, end_x], [start_z, end_z]) || within([start_z, end_z], [start_x, end_x]);
    let cross = start_z * end_x - start_x * end_z;
    let is_short_way = if turn == Turn::Clockwise { cross < 0.0 } else { cross > 0.0 };
    fits && is_short_way
}

impl Core {
    fn arc_thread_centre(
        &mut self,
        call: &Call<'_>,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        turn: Turn,
    ) -> Result<Position<WorkTip>, Alarm> {
        let tolerance_mm = self.settings.arc_tolerance_mm.max(0.0);
        if let Some(word) = call.block.word(b'R') {
            let radius = self.radius(word, Role::ArcOffset)?;
            self.missing_point(word);
            if radius.0.signum() <= 0 {
                // More than half a circle, or none at all.
                return Err(self.alarm("arc-thread-illegal", word));
            }
            let clockwise = turn == Turn::Clockwise;
            return match centre_from_radius(point(from), point(to), radius.to_mm(), clockwise, tolerance_mm) {
                Ok(centre) => place(centre).ok_or_else(|| self.alarm("number-too-long", word)),
                Err(ArcFault::RadiusTooSmall { missing_mm }) => Err(self.arc_alarm(word, missing_mm)),
                Err(ArcFault::NoChord) => Err(self.alarm_at("arc-thread-illegal", call.word)),
            };
        }
        let Some(word) = call.block.word(b'I').or(call.block.word(b'K')) else {
            return Err(self.alarm_at("arc-without-radius", call.word));
        };
        let x = self.optional_radius(call.block, b'I', Role::ArcOffset)?.unwrap_or(Radius::ZERO);
        let z = call.block.word(b'K').map(|word| self.length(word)).transpose()?.unwrap_or(Length::ZERO);
        let centre = Position::new(from.x + x, from.z + z);
        let error_mm = (point(centre).distance(point(from)) - point(centre).distance(point(to))).abs();
        if tolerance_mm > 0.0 && error_mm > tolerance_mm {
            return Err(self.arc_alarm(word, error_mm));
        }
        Ok(centre)
    }
}
