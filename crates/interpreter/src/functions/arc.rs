//! `arc-clockwise`, `arc-counter-clockwise` — circular cuts (G02, G03).
//!
//! `G02 X(U)_ Z(W)_ R_ F_` or `G02 X(U)_ Z(W)_ I_ K_ F_`. Direction is seen with Z to the right and X up. I is
//! the way in X from the start to the centre as a radius, K the way in Z; one left out is zero. R is the radius:
//! positive for the arc below 180 degrees, negative for the longer one where the control has it. With both, R
//! counts. With neither the move is straight, or an alarm by parameter. With I or K and no end point it is a
//! full circle.
//!
//! An end point off the circle by more than the tolerance (3410) is an alarm; inside it the control's policy
//! says how both ends are met: arc and straight tail along one axis, a moved centre, or a radius that changes along
//! the arc.
//! The last is given as an arc about the given centre (its ends differ in radius by no more than the tolerance).
//!
//! Source: circular interpolation of both families.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_control::policy::{ArcEndError, CornerWords, NegativeArcRadius};
use turnwright_diagnostics::Diagnostic;
use turnwright_geometry::{ArcFault, Point, centre_from_radius, sweep_rad};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Feed, LeastIncrement, Length, Position, Radius, WorkTip};

use super::{Function, PathKind};
use crate::block::Call;
use crate::corner::Motion;
use crate::machine::Core;
use crate::plane::{place, point};
use crate::report::Alarm;
use crate::short::ShortMove;
use crate::words::Role;

pub(super) static ARC_CLOCKWISE: Function =
    Function::motion("arc-clockwise", |core, call| arc(core, call, Turn::Clockwise))
        .with_letters(b"RIKLD")
        .making_a_path(PathKind::Arc(Turn::Clockwise))
        .triggered_by(b"RIK")
        .with_other_axes()
        .allowed_in_figure()
        .allowed_in_rotation();

pub(super) static ARC_COUNTER_CLOCKWISE: Function =
    Function::motion("arc-counter-clockwise", |core, call| arc(core, call, Turn::CounterClockwise))
        .with_letters(b"RIKLD")
        .making_a_path(PathKind::Arc(Turn::CounterClockwise))
        .triggered_by(b"RIK")
        .with_other_axes()
        .allowed_in_figure()
        .allowed_in_rotation();

/// Letters of corners where they may lie between any cuts.
const CORNERS: u32 = super::letters(b"LD");

/// What programs that were written by a computer are off by; more is worth a warning.
const ROUNDED_ARC_MM: f64 = 0.01;

/// An arc by its radius that turns by more than this many degrees is nearly a half circle.
const HALF_CIRCLE_DEG: f64 = 179.0;

/// An arc to be cut.
struct Arc<'b> {
    block: &'b Block,
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    turn: Turn,
    feed: Feed,
}

fn arc(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    if call.block.present() & core.axes.rare != 0 || core.axes.plane != crate::axes::Plane::Zx {
        return super::plane_arc::plane_arc(core, call, turn);
    }
    if core.corner.is_some() || call.block.has_comma || call.block.present() & CORNERS != 0 {
        core.check_path_words(call.block)?;
    }
    core.move_before_bend(call)?;
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

/// How much nearer to the centre one end of an arc lies than the other.
#[inline]
fn end_error_mm(centre: Position<WorkTip>, from: Position<WorkTip>, to: Position<WorkTip>) -> f64 {
    const NM_PER_MM: f64 = 1e6;
    let distance_nm = |end: Position<WorkTip>| {
        let (x, z) = ((end.x - centre.x).0.to_nm_float(), (end.z - centre.z).to_nm_float());
        (x * x + z * z).sqrt()
    };
    (distance_nm(from) - distance_nm(to)).abs() / NM_PER_MM
}

/// The centre of the arc of a short line, where its words need no second look and its ends fit the circle.
///
/// Always inline: it has one caller, and what is returned through memory is waited for.
#[inline(always)]
pub(crate) fn short_centre(core: &Core, line: &ShortMove<'_>, turn: Turn) -> Option<Position<WorkTip>> {
    let &ShortMove { from, to, .. } = line;
    let offset = |letter| match line.number(letter) {
        Some(number) => core.plain_length(number),
        None => Some(Length::ZERO),
    };
    let (x, z) = (core.radius_of(offset(b'I')?, Role::ArcOffset), offset(b'K')?);
    let is_by_centre = !(x.0.is_zero() && z.is_zero());
    match line.number(b'R') {
        None if is_by_centre => {
            let centre = Position::new(from.x + x, from.z + z);
            let error = end_error_mm(centre, from, to);
            let tolerance = core.settings.arc_tolerance_mm;
            let fits = error <= core.modal.increment(&core.settings).to_mm()
                && (tolerance <= 0.0 || error <= tolerance);
            fits.then_some(centre)
        }
        Some(number) if line.number(b'I').or(line.number(b'K')).is_none() && from != to => {
            let radius = core.radius_of(core.plain_length(number)?, Role::ArcOffset);
            if radius.0.signum() <= 0 || core.is_doubtful_half_circle(from, to, radius) {
                return None;
            }
            place(core.centre_by_radius(from, to, radius, turn).ok()?)
        }
        _ => None,
    }
}

impl Core {
    /// Makes what an offset has still to move before a move that is no line.
    #[inline]
    pub(super) fn move_before_bend(&mut self, call: &Call<'_>) -> Result<(), Alarm> {
        if self.untaken.is_some() {
            // The way of the offset is no part of the arc.
            self.warn_block("offset-moves-in-arc");
            self.make_movement(call.word)?;
        }
        Ok(())
    }

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
        let Arc { to, turn, feed, .. } = *arc;
        self.emit_made(to, || Action::Feed { to, shape: Shape::Arc { turn, centre }, feed, others: None })
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
        if let Some(ignored) = arc.block.word(b'I').or(arc.block.word(b'K')) {
            self.warn("arc-centre-ignored", ignored);
        }
        if arc.from == arc.to {
            // An arc of no degrees: nothing moves.
            self.warn("arc-goes-nowhere", word);
            return Ok(());
        }
        if self.is_doubtful_half_circle(arc.from, arc.to, radius) {
            self.warn("half-circle-by-radius", word);
        }
        match self.centre_by_radius(arc.from, arc.to, radius, arc.turn) {
            Ok(centre) => match place(centre) {
                Some(centre) => self.cut_arc(arc, centre),
                None => Err(self.alarm("number-too-long", word)),
            },
            Err(ArcFault::RadiusTooSmall { missing_mm }) => Err(self.arc_alarm(word, missing_mm)),
            Err(ArcFault::NoChord) => Ok(()),
        }
    }

    /// Whether an arc is so nearly a half circle that a control without long arcs may take the other one.
    #[inline]
    fn is_doubtful_half_circle(
        &self,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        radius: Radius,
    ) -> bool {
        let half_chord = point(from).distance(point(to)) / 2.0;
        self.control.policies.negative_arc_radius == NegativeArcRadius::Alarm
            && half_chord > radius.to_mm() * (HALF_CIRCLE_DEG / 2.0).to_radians().sin()
    }

    #[inline]
    fn centre_by_radius(
        &self,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        radius: Radius,
        turn: Turn,
    ) -> Result<Point, ArcFault> {
        let tolerance =
            if self.settings.arc_small_radius_alarm { 0.0 } else { self.settings.arc_tolerance_mm.max(0.0) };
        centre_from_radius(point(from), point(to), radius.to_mm(), turn == Turn::Clockwise, tolerance)
    }

    pub(super) fn arc_alarm(&self, word: &Word, error_mm: f64) -> Alarm {
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
            return Err(if self.follows_compensated() {
                self.alarm("compensated-arc-interferes", &word)
            } else {
                self.arc_alarm(&word, 0.0)
            });
        }
        let centre = Position::new(arc.from.x + x, arc.from.z + z);
        let at_start = point(centre).distance(point(arc.from));
        let error = end_error_mm(centre, arc.from, arc.to);
        let tolerance = self.settings.arc_tolerance_mm;
        let policy = self.control.policies.arc_end_error;
        if tolerance > 0.0 && error > tolerance && policy != ArcEndError::RecentreAlways {
            return Err(self.arc_alarm(&word, error));
        }
        // Less than an increment is the rounding of the words.
        if error <= self.modal.increment(&self.settings).to_mm() {
            return self.cut_arc(arc, centre);
        }
        match policy {
            ArcEndError::Spiral => self.cut_arc(arc, centre),
            ArcEndError::Recentre => self.arc_with_moved_centre(arc, centre, 0.0, &word),
            ArcEndError::RecentreAlways => self.arc_with_moved_centre(arc, centre, tolerance.max(0.0), &word),
            ArcEndError::TailLine => self.arc_and_tail(arc, centre, at_start),
        }?;
        if error > ROUNDED_ARC_MM {
            self.warn("arc-end-adjusted", &word);
        }
        Ok(())
    }

    /// An arc with the radius of its start about a centre that both ends fit; the way round stays as it was.
    fn arc_with_moved_centre(
        &mut self,
        arc: &Arc<'_>,
        centre: Position<WorkTip>,
        tolerance_mm: f64,
        word: &Word,
    ) -> Result<(), Alarm> {
        let clockwise = arc.turn == Turn::Clockwise;
        let (from, to) = (point(arc.from), point(arc.to));
        let radius_mm = point(centre).distance(from);
        let is_short = sweep_rad(from, to, point(centre), clockwise).abs() <= std::f64::consts::PI;
        let signed = if is_short { radius_mm } else { -radius_mm };
        match centre_from_radius(from, to, signed, clockwise, tolerance_mm) {
            Ok(moved) => match place(moved) {
                Some(moved) => self.cut_arc(arc, moved),
                None => Err(self.alarm("number-too-long", word)),
            },
            Err(_) => Err(self.arc_alarm(word, from.distance(to) / 2.0 - radius_mm)),
        }
    }

    /// An arc with the radius of its start until one axis is where it ends, then straight along the other.
    fn arc_and_tail(
        &mut self,
        arc: &Arc<'_>,
        centre: Position<WorkTip>,
        radius_mm: f64,
    ) -> Result<(), Alarm> {
        let (middle, end) = (point(centre), point(arc.to));
        let (x, z) = (end.x - middle.x, end.z - middle.z);
        // The place on the circle with one coordinate of the end point, on its side of the centre.
        let beside = |given: f64, found: f64| {
            let squared = radius_mm * radius_mm - given * given;
            (squared >= 0.0).then(|| squared.sqrt().copysign(found))
        };
        let with_end_z = beside(z, x).map(|x| Point::new(middle.x + x, end.z));
        let with_end_x = beside(x, z).map(|z| Point::new(end.x, middle.z + z));
        let nearest = [with_end_z, with_end_x]
            .into_iter()
            .flatten()
            .min_by(|one, other| one.distance(end).total_cmp(&other.distance(end)));
        let Some(stop) = nearest.and_then(place) else { return self.cut_arc(arc, centre) };
        let increment = self.modal.increment(&self.settings);
        let stop =
            Position::new(stop.x.to_diameter().rounded(increment).to_radius(), stop.z.rounded(increment));
        self.cut_arc(&Arc { to: stop, ..*arc }, centre)?;
        self.modal.position = arc.to;
        self.emit_move(arc.to, Action::Feed { to: arc.to, shape: Shape::Line, feed: arc.feed, others: None })
    }
}
