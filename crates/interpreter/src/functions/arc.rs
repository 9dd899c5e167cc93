//! `arc-clockwise`, `arc-counter-clockwise` — circular cuts (G02, G03).
//!
//! `G02 X(U)_ Z(W)_ R_ F_` or `G02 X(U)_ Z(W)_ I_ K_ F_`. Direction is seen with Z to the right and X up. I is
//! the way in X from the start to the centre as a radius, K the way in Z; one left out is zero. R is the radius:
//! positive for the arc below 180 degrees, negative for the longer one where the control has it. With both, R
//! counts. With neither the move is straight, or an alarm by parameter. With I or K and no end point it is a
//! full circle.
//!
//! An end point off the circle by more than the tolerance (3410) is an alarm; inside it the control's policy
//! says how both ends are met: arc and straight tail, a moved centre, or a radius that changes along the arc.
//! The last is given as an arc about the given centre (its ends differ in radius by no more than the tolerance).
//!
//! Source: circular interpolation of both families.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_control::policy::{ArcEndError, CornerWords, NegativeArcRadius};
use turnwright_diagnostics::Diagnostic;
use turnwright_geometry::{ArcFault, Point, centre_from_radius};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Feed, LeastIncrement, Length, Position, Radius, WorkTip};

use super::Function;
use crate::block::Call;
use crate::corner::Motion;
use crate::machine::Core;
use crate::plane::{place, point};
use crate::report::Alarm;
use crate::words::Role;

pub(super) static ARC_CLOCKWISE: Function =
    Function::motion("arc-clockwise", |core, call| arc(core, call, Turn::Clockwise))
        .with_letters(b"RIKLD")
        .triggered_by(b"RIK")
        .allowed_in_figure();

pub(super) static ARC_COUNTER_CLOCKWISE: Function =
    Function::motion("arc-counter-clockwise", |core, call| arc(core, call, Turn::CounterClockwise))
        .with_letters(b"RIKLD")
        .triggered_by(b"RIK")
        .allowed_in_figure();

/// Letters of corners where they may lie between any cuts.
const CORNERS: u32 = super::letters(b"LD");

/// An arc to be cut.
struct Arc<'b> {
    block: &'b Block,
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    turn: Turn,
    feed: Feed,
}

fn arc(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    if core.corner.is_some() || call.block.has_comma || call.block.present() & CORNERS != 0 {
        core.check_path_words(call.block)?;
    }
    if core.untaken.is_some() {
        // The way of the offset is no part of the arc.
        core.warn_block("offset-moves-in-arc");
        core.make_movement(call.word)?;
    }
    let from = core.modal.position;
    let to = core.target(call.block)?;
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let arc = Arc { block: call.block, from, to, turn, feed };
    if let Some(word) = call.block.word(b'R') {
        return core.arc_by_radius(&arc, word);
    }
    if call.block.has(b'I') || call.block.has(b'K') {
        return core.arc_by_centre(&arc, call);
    }
    if core.settings.arc_without_radius_alarm {
        return Err(core.alarm_at("arc-without-radius", call.word));
    }
    core.warn_block("arc-as-line");
    if core.joins_arcs(call.block) {
        return core.line_in_path(call.block, Motion::Feed(feed));
    }
    core.modal.position = to;
    core.emit_move(to, Action::Feed { to, shape: Shape::Line, feed, others: None })
}

impl Core {
    /// Words of corners and drawing dimensions in an arc, and an arc behind such words.
    #[cold]
    fn check_path_words(&mut self, block: &Block) -> Result<(), Alarm> {
        if self.corner.is_some() {
            self.check_arc_in_path()?;
        }
        let is_strange = |word: &&Word| match self.control.policies.corner_words {
            CornerWords::LengthAndFillet => word.comma,
            CornerWords::ChamferAndRadius => word.comma || matches!(word.address, b'L' | b'D'),
        };
        match block.words.iter().find(is_strange) {
            Some(word) if word.comma && matches!(word.address, b'A' | b'C' | b'R') => {
                Err(self.alarm("drawing-sequence-illegal", word))
            }
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }

    fn cut_arc(&mut self, arc: &Arc<'_>, centre: Position<WorkTip>) -> Result<(), Alarm> {
        if self.joins_arcs(arc.block) {
            return self.arc_in_path(arc.block, (arc.from, arc.to), (arc.turn, centre), arc.feed);
        }
        self.modal.position = arc.to;
        let shape = Shape::Arc { turn: arc.turn, centre };
        self.emit_move(arc.to, Action::Feed { to: arc.to, shape, feed: arc.feed, others: None })
    }

    fn arc_by_radius(&mut self, arc: &Arc<'_>, word: &Word) -> Result<(), Alarm> {
        let radius = self.radius(word, Role::ArcOffset)?;
        self.missing_point(word);
        if radius.0.signum() < 0 && self.control.policies.negative_arc_radius == NegativeArcRadius::Alarm {
            return Err(self.alarm("negative-radius", word));
        }
        if radius.0.is_zero() {
            return Err(self.arc_alarm(word, 0.0));
        }
        if arc.from == arc.to {
            // An arc of no degrees: nothing moves.
            return Ok(());
        }
        let tolerance = self.settings.arc_tolerance_mm.max(0.0);
        let clockwise = arc.turn == Turn::Clockwise;
        match centre_from_radius(point(arc.from), point(arc.to), radius.to_mm(), clockwise, tolerance) {
            Ok(centre) => match place(centre) {
                Some(centre) => self.cut_arc(arc, centre),
                None => Err(self.alarm("number-too-long", word)),
            },
            Err(ArcFault::RadiusTooSmall { missing_mm }) => Err(self.arc_alarm(word, missing_mm)),
            Err(ArcFault::NoChord) => Ok(()),
        }
    }

    fn arc_alarm(&self, word: &Word, error_mm: f64) -> Alarm {
        let shown = |mm: f64| Length::from_mm_rounded(mm, LeastIncrement::METRIC_C).unwrap_or(Length::ZERO);
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::alarm("arc-radius-tolerance").at(self.place(word)).with("word", quote);
        let diagnostic = diagnostic.with("value", shown(error_mm));
        self.finish(diagnostic.with("limit", shown(self.settings.arc_tolerance_mm)))
    }

    fn arc_by_centre(&mut self, arc: &Arc<'_>, call: &Call<'_>) -> Result<(), Alarm> {
        let x = self.optional_radius(call.block, b'I', Role::ArcOffset)?.unwrap_or(Radius::ZERO);
        let z = call.block.word(b'K').map(|word| self.length(word)).transpose()?.unwrap_or(Length::ZERO);
        let word = call.block.word(b'I').or(call.block.word(b'K'));
        let Some(word) = word.copied() else { return Ok(()) };
        if x.0.is_zero() && z.is_zero() {
            return Err(self.arc_alarm(&word, 0.0));
        }
        let centre = Position::new(arc.from.x + x, arc.from.z + z);
        let at_start = point(centre).distance(point(arc.from));
        let at_end = point(centre).distance(point(arc.to));
        let error = (at_start - at_end).abs();
        let tolerance = self.settings.arc_tolerance_mm;
        if tolerance > 0.0 && error > tolerance {
            return Err(self.arc_alarm(&word, error));
        }
        // Less than an increment is the rounding of the words.
        if error <= self.modal.increment(&self.settings).to_mm() {
            return self.cut_arc(arc, centre);
        }
        match self.control.policies.arc_end_error {
            ArcEndError::Spiral => self.cut_arc(arc, centre),
            ArcEndError::Recentre => {
                let clockwise = arc.turn == Turn::Clockwise;
                let short =
                    turnwright_geometry::sweep_rad(point(arc.from), point(arc.to), point(centre), clockwise)
                        .abs()
                        <= std::f64::consts::PI;
                let radius = if short { at_start } else { -at_start };
                let half = point(arc.from).distance(point(arc.to)) / 2.0;
                match centre_from_radius(point(arc.from), point(arc.to), radius, clockwise, 0.0) {
                    Ok(moved) => match place(moved) {
                        Some(moved) => self.cut_arc(arc, moved),
                        None => Err(self.alarm("number-too-long", &word)),
                    },
                    Err(_) => Err(self.arc_alarm(&word, half - at_start)),
                }
            }
            ArcEndError::TailLine => self.arc_and_tail(arc, centre, at_start, at_end),
        }
    }

    /// An arc with the radius of its start to the ray of the end point, then straight to the end point.
    fn arc_and_tail(
        &mut self,
        arc: &Arc<'_>,
        centre: Position<WorkTip>,
        radius_mm: f64,
        end_mm: f64,
    ) -> Result<(), Alarm> {
        let (middle, end) = (point(centre), point(arc.to));
        let scale = if end_mm > 0.0 { radius_mm / end_mm } else { return self.cut_arc(arc, centre) };
        let on_circle =
            Point::new(middle.x + (end.x - middle.x) * scale, middle.z + (end.z - middle.z) * scale);
        let Some(stop) = place(on_circle) else { return self.cut_arc(arc, centre) };
        let increment = self.modal.increment(&self.settings);
        let stop =
            Position::new(stop.x.to_diameter().rounded(increment).to_radius(), stop.z.rounded(increment));
        self.cut_arc(&Arc { to: stop, ..*arc }, centre)?;
        self.modal.position = arc.to;
        self.emit_move(arc.to, Action::Feed { to: arc.to, shape: Shape::Line, feed: arc.feed, others: None })
    }
}
