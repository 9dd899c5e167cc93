//! `ellipse-clockwise`, `ellipse-counter-clockwise`, `parabola-clockwise`, `parabola-counter-clockwise` — parts of an
//! ellipse (G06.2, G06.3) or a parabola (G07.2, G07.3). Directions are those of arcs, seen with Z to the right and X
//! up.
//!
//! `G06.2 X(U)_ Z(W)_ A_ B_ Q_ F_`: A is the half axis along the angle Q from +Z, B the other one, both in mm and
//! measured as a radius. The part is at most half of the ellipse. A and B alike give an ordinary arc. Zero, missing,
//! or ends further apart than the ellipse is wide are an alarm. A is meant to be the longer one; where it is not, Q is
//! still the angle of A. Without X and Z the block does nothing, with a warning.
//!
//! `G07.2 X(U)_ Z(W)_ P_ Q_ F_`: the parabola y² = 2·P·x through both ends, its axis at the angle Q from +Z. It opens
//! to the side that gives the turn asked for, so P has no sign. P zero or missing, or ends on a parallel to the axis,
//! are an alarm.
//!
//! P counts least increments and Q thousandths of a degree, or millimetres and degrees by the unit parameter (182#7).
//! None of these words is modal. Ends that coincide draw nothing and are an alarm.
//!
//! Source: elliptic and parabolic interpolation, GSK 980TDi texts.

use turnwright_canon::{Action, Curve, Shape, Turn};
use turnwright_geometry::{ellipse_centre, parabola_vertex};
use turnwright_syntax::Word;
use turnwright_units::{Angle, Feed, Length, Position, WorkTip};

use super::Function;
use crate::block::Call;
use crate::machine::Core;
use crate::plane::{place, point};
use crate::report::Alarm;

/// Half a turn and a whole one, thousandths of a degree.
const HALF_TURN: i64 = 180_000;
const TURN: i64 = 360_000;

pub(super) static ELLIPSE_CLOCKWISE: Function =
    Function::motion("ellipse-clockwise", |core, call| ellipse(core, call, Turn::Clockwise))
        .with_letters(b"ABQ")
        .triggered_by(b"AB")
        .allowed_in_figure();

pub(super) static ELLIPSE_COUNTER_CLOCKWISE: Function =
    Function::motion("ellipse-counter-clockwise", |core, call| ellipse(core, call, Turn::CounterClockwise))
        .with_letters(b"ABQ")
        .triggered_by(b"AB")
        .allowed_in_figure();

pub(super) static PARABOLA_CLOCKWISE: Function =
    Function::motion("parabola-clockwise", |core, call| parabola(core, call, Turn::Clockwise))
        .with_letters(b"PQ")
        .allowed_in_figure();

pub(super) static PARABOLA_COUNTER_CLOCKWISE: Function =
    Function::motion("parabola-counter-clockwise", |core, call| parabola(core, call, Turn::CounterClockwise))
        .with_letters(b"PQ")
        .allowed_in_figure();

/// What every curve has.
struct Cut {
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    feed: Feed,
    /// Q, thousandths of a degree, any sign.
    tilt_millidegrees: i64,
}

fn ellipse(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    if call.block.present() & super::AXES == 0 {
        core.warn_block("ellipse-without-end");
        return Ok(());
    }
    let Cut { from, to, feed, tilt_millidegrees } = core.curve_words(call, "ellipse-illegal")?;
    let half_along = core.half_axis(call, b'A')?;
    let half_across = core.half_axis(call, b'B')?;
    let tilt = Angle::from_millidegrees(tilt_millidegrees.rem_euclid(HALF_TURN));
    // The ends are rounded words: by so much they may lie too far apart.
    let tolerance_mm = core.modal.increment(&core.settings).to_mm();
    let centre = ellipse_centre(
        point(from),
        point(to),
        (half_along.to_mm(), half_across.to_mm()),
        tilt.to_radians(),
        turn == Turn::Clockwise,
        tolerance_mm,
    );
    let Some(centre) = centre.ok().and_then(place) else {
        return Err(core.alarm_at("ellipse-illegal", call.block.word(b'A')));
    };
    core.modal.position = to;
    let shape = if half_along == half_across {
        Shape::Arc { turn, centre }
    } else {
        Shape::Curve(Box::new(Curve::Ellipse { turn, centre, half_along, half_across, tilt }))
    };
    core.emit_move(to, Action::Feed { to, shape, feed, others: None })
}

fn parabola(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    let Cut { from, to, feed, tilt_millidegrees } = core.curve_words(call, "parabola-illegal")?;
    let Some(word) = call.block.word(b'P') else {
        return Err(core.alarm_at("parabola-illegal", call.word));
    };
    let focal_parameter = core.cycle_length(word)?.abs();
    if focal_parameter.is_zero() {
        return Err(core.alarm("parabola-illegal", word));
    }
    let tilt = Angle::from_millidegrees(tilt_millidegrees.rem_euclid(TURN));
    let found = parabola_vertex(
        point(from),
        point(to),
        focal_parameter.to_mm(),
        tilt.to_radians(),
        turn == Turn::Clockwise,
    );
    // An axis at 90 degrees is parallel to X only as far as a cosine goes: no ends meet on it within an increment.
    let Some((vertex, opens_back)) = found.and_then(|(vertex, back)| Some((place(vertex)?, back))) else {
        return Err(core.alarm_at("parabola-illegal", call.block.word(b'Q').or(call.word)));
    };
    core.modal.position = to;
    let opening = if opens_back { tilt_millidegrees + HALF_TURN } else { tilt_millidegrees };
    let tilt = Angle::from_millidegrees(opening.rem_euclid(TURN));
    let shape = Shape::Curve(Box::new(Curve::Parabola { turn, vertex, focal_parameter, tilt }));
    core.emit_move(to, Action::Feed { to, shape, feed, others: None })
}

impl Core {
    fn curve_words(&mut self, call: &Call<'_>, refusal: &'static str) -> Result<Cut, Alarm> {
        self.refuse_comma_words(call.block)?;
        self.move_before_bend(call)?;
        let from = self.modal.position;
        let to = self.target(call.block)?;
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        if from == to {
            return Err(self.alarm_at(refusal, call.word));
        }
        let tilt_millidegrees = call.block.word(b'Q').map_or(Ok(0), |word| self.curve_angle(word))?;
        Ok(Cut { from, to, feed, tilt_millidegrees })
    }

    /// Q: thousandths of a degree, or degrees by the unit parameter.
    fn curve_angle(&self, word: &Word) -> Result<i64, Alarm> {
        if self.settings.cycle_words_in_mm {
            return self.millidegrees(word);
        }
        let number = self.number(word)?;
        if number.has_point {
            return Err(self.alarm("point-not-allowed", word));
        }
        Ok(number.digits)
    }

    fn half_axis(&self, call: &Call<'_>, letter: u8) -> Result<Length, Alarm> {
        let Some(word) = call.block.word(letter) else {
            return Err(self.alarm_at("ellipse-illegal", call.word));
        };
        let length = self.unsigned_length(word)?;
        if length.is_zero() { Err(self.alarm("ellipse-illegal", word)) } else { Ok(length) }
    }
}
