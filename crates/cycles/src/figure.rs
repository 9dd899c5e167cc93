//! The figure of a cycle: what the blocks between first and last sequence number draw, and how it is walked.
//!
//! In: places and motions captured by the interpreter. Out: the same figure on the least increment, its *profile*
//! (pieces on which both axes run one way; arcs are cut at their extreme points), and two judgements that controls
//! make before they start: [`monotony_fault`] and [`start_inside_fault`].
//!
//! Not here: levels and moves. Source: rules of the figure and of the signs, chapters 1.5, 1.6 and 3 of the cycles.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_units::{Displacement, LeastIncrement, Length, Position, Radius, WorkTip};

use crate::plane::{Plane, in_range};
use crate::{Context, Misuse};

/// The shape a cycle works on.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Where the tool stands before the first element (A).
    pub start: Position<WorkTip>,
    /// The elements in the order of the program; the first leads from A to the beginning of the contour (B).
    pub elements: Vec<Element>,
}

/// One block of the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// End point.
    pub to: Position<WorkTip>,
    /// How it gets there.
    pub motion: FigureMotion,
    /// Line of the program that wrote it; carried for the caller, not used here.
    pub line: u32,
}

/// How an element of the figure moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FigureMotion {
    /// At rapid traverse.
    Rapid,
    /// A straight cut.
    Line,
    /// An arc; start and end are exact, the radius is the distance of the centre from the start.
    Arc {
        /// Which way, seen with Z to the right and X up.
        turn: Turn,
        /// Centre of the circle.
        centre: Position<WorkTip>,
    },
}

/// The axis that roughing cuts along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CutAlong {
    /// Cuts run along Z, depth is counted along X: turning.
    Z,
    /// Cuts run along X, depth is counted along Z: facing.
    X,
}

/// An axis by its place in the turning plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PlaneAxis {
    /// Z.
    First,
    /// X.
    Second,
}

/// An axis of the figure that turns back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MonotonyFault {
    /// Which axis.
    pub axis: PlaneAxis,
    /// Index of the first element that goes back by more than the tolerance.
    pub element: u32,
}

/// How far each axis of a figure may turn back without being taken for turning back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// Along X.
    pub x: Radius,
    /// Along Z.
    pub z: Length,
}

impl Tolerance {
    /// None at all.
    pub const EXACT: Self = Self::both(Length::ZERO);

    /// The same on both axes.
    pub const fn both(length: Length) -> Self {
        Self { x: Radius(length), z: length }
    }

    /// (along the cut, along the depth axis), nanometres.
    fn split(self, along: CutAlong) -> (i64, i64) {
        match along {
            CutAlong::Z => (self.z.nm(), self.x.0.nm()),
            CutAlong::X => (self.x.0.nm(), self.z.nm()),
        }
    }
}

/// A figure that reaches beyond the start point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartFault {
    /// The axis on which it does: the depth axis.
    pub axis: PlaneAxis,
    /// Index of the first element that reaches beyond.
    pub element: u32,
}

impl Figure {
    /// The figure on the least increment, or why no cycle can use it.
    pub(crate) fn prepare(mut self, context: &Context) -> Result<Self, Misuse> {
        in_range(&[context.start.x.0, context.start.z])?;
        if self.start != context.start {
            return Err(Misuse::StartMismatch);
        }
        let mut from = self.start;
        let mut snapped_from = snap(from, context.increment);
        let mut moves = false;
        for element in &mut self.elements {
            in_range(&[element.to.x.0, element.to.z])?;
            let to = snap(element.to, context.increment);
            if let FigureMotion::Arc { centre, .. } = element.motion {
                in_range(&[centre.x.0, centre.z])?;
                // An arc that rounding has closed must not become a full circle.
                if (to == snapped_from && element.to != from) || centre == to {
                    element.motion = FigureMotion::Line;
                }
            }
            moves |= to != snapped_from || matches!(element.motion, FigureMotion::Arc { .. });
            (from, snapped_from) = (element.to, to);
            element.to = to;
        }
        if moves { Ok(self) } else { Err(Misuse::NoContour) }
    }

    /// The end of element `index` moved by `shift`.
    pub(crate) fn end(&self, index: usize, shift: Displacement<WorkTip>) -> Position<WorkTip> {
        self.elements.get(index).map_or(self.start, |element| element.to) + shift
    }

    /// Element `index` moved by `shift`, as a cutting move; rapid elements are cut too.
    pub(crate) fn cut(&self, index: usize, shift: Displacement<WorkTip>, context: &Context) -> Action {
        let to = self.end(index, shift);
        let shape = match self.elements.get(index).map(|element| element.motion) {
            Some(FigureMotion::Arc { turn, centre }) => Shape::Arc { turn, centre: centre + shift },
            _ => Shape::Line,
        };
        Action::Feed { to, shape, feed: context.feed, others: None }
    }
}

/// A place on the least increment.
pub(crate) fn snap(place: Position<WorkTip>, increment: LeastIncrement) -> Position<WorkTip> {
    Position::new(place.x.to_diameter().rounded(increment).to_radius(), place.z.rounded(increment))
}

/// A stretch of the figure on which neither axis turns back. Depth `h` grows into the work and is 0 at A.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) h0: i64,
    pub(crate) h1: i64,
    pub(crate) v0: i64,
    pub(crate) v1: i64,
    pub(crate) element: u32,
    curve: Curve,
}

#[derive(Clone, Copy, Debug)]
enum Curve {
    Line,
    /// Centre (depth, v), radius, and on which side of the centre the piece lies along v.
    Arc {
        h: i64,
        v: i64,
        radius: f64,
        side: i64,
    },
}

impl Piece {
    /// The v at which the piece passes depth `level`, nanometres; the level lies between its ends.
    pub(crate) fn crossing(&self, level: i64) -> f64 {
        match self.curve {
            Curve::Line => self.line_crossing(level),
            Curve::Arc { h, v, radius, side } => {
                let off = (level - h).abs() as f64;
                let half_chord = ((radius - off) * (radius + off)).max(0.0).sqrt();
                let (low, high) = (self.v0.min(self.v1) as f64, self.v0.max(self.v1) as f64);
                (v as f64 + side as f64 * half_chord).clamp(low, high)
            }
        }
    }

    /// Exact but for the last fraction of a nanometre, so that a true half increment is seen as one.
    fn line_crossing(&self, level: i64) -> f64 {
        let span = self.h1 - self.h0;
        if span == 0 {
            return self.v0 as f64;
        }
        let (depth, way) = ((level - self.h0) * span.signum(), self.v1 - self.v0);
        if let Some(product) = depth.checked_mul(way) {
            let (whole, rest) = (product.div_euclid(span.abs()), product.rem_euclid(span.abs()));
            return (self.v0 + whole) as f64 + rest as f64 / span.abs() as f64;
        }
        // Longer than any lathe.
        let (product, span) = (i128::from(depth) * i128::from(way), i128::from(span.abs()));
        let (whole, rest) = (product.div_euclid(span), product.rem_euclid(span));
        (i128::from(self.v0) + whole) as f64 + rest as f64 / span as f64
    }
}

/// The approach of the figure: its leading elements that only go down to where the contour begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeadIn {
    /// How many elements it takes; at least 1.
    pub(crate) elements: usize,
    /// Direction of depth along u: −1, 0 or 1.
    pub(crate) depth_sign: i64,
    /// True when all of it is at rapid traverse.
    pub(crate) rapid: bool,
    /// Where it ends (B), (u, v).
    pub(crate) end: (i64, i64),
}

/// Finds the approach. The first element always belongs to it; more follow while they go on straight down.
pub(crate) fn lead_in(figure: &Figure, plane: &Plane) -> Option<LeadIn> {
    let first = figure.elements.first()?;
    let from = plane.split(figure.start);
    let end = plane.split(first.to);
    let rapid = first.motion == FigureMotion::Rapid;
    let mut lead = LeadIn { elements: 1, depth_sign: (end.0 - from.0).signum(), rapid, end };
    for element in &figure.elements[1..] {
        let to = plane.split(element.to);
        let way = (to.0 - lead.end.0).signum();
        let straight = to.1 == lead.end.1 && !matches!(element.motion, FigureMotion::Arc { .. });
        if !straight || (way != 0 && lead.depth_sign != 0 && way != lead.depth_sign) {
            break;
        }
        lead.rapid &= element.motion == FigureMotion::Rapid || way == 0;
        lead.depth_sign = if lead.depth_sign == 0 { way } else { lead.depth_sign };
        lead.elements += 1;
        lead.end = to;
    }
    Some(lead)
}

/// Finds the approach of a figure with pockets. What is cut before the tool has gone straight down belongs to the
/// contour: then there is no approach and nothing is open to the start.
pub(crate) fn pocket_lead_in(figure: &Figure, plane: &Plane) -> Option<LeadIn> {
    let first = figure.elements.first()?;
    let (start, to) = (plane.split(figure.start), plane.split(first.to));
    let is_rapid = first.motion == FigureMotion::Rapid;
    let goes_straight = to.1 == start.1 && !matches!(first.motion, FigureMotion::Arc { .. });
    let mut lead = match (is_rapid, goes_straight) {
        (_, true) => lead_in(figure, plane)?,
        (true, false) => LeadIn { elements: 1, depth_sign: (to.0 - start.0).signum(), rapid: true, end: to },
        (false, false) => LeadIn { elements: 0, depth_sign: 0, rapid: false, end: start },
    };
    if lead.depth_sign == 0 {
        // Depth lies where the contour reaches furthest.
        let pieces = profile(figure, plane, &lead);
        let reach = pieces.iter().map(|piece| piece.h1).max_by_key(|depth| depth.abs());
        lead.depth_sign = if reach.is_some_and(|depth| depth < 0) { -1 } else { 1 };
    }
    Some(lead)
}

/// Makes pieces that turn back along v by no more than `tolerance` go straight on instead.
pub(crate) fn straighten(
    pieces: &mut [Piece],
    forward: i64,
    tolerance: Tolerance,
    along: CutAlong,
) -> Result<(), MonotonyFault> {
    let axis = if along == CutAlong::Z { PlaneAxis::First } else { PlaneAxis::Second };
    let mut furthest = i64::MIN;
    for piece in pieces {
        furthest = furthest.max(forward * piece.v0);
        if furthest - forward * piece.v1 > tolerance.split(along).0 {
            return Err(MonotonyFault { axis, element: piece.element });
        }
        piece.v0 = forward * furthest;
        furthest = furthest.max(forward * piece.v1);
        piece.v1 = forward * furthest;
    }
    Ok(())
}

/// The contour after the approach, as pieces, in order. Depth is measured from A along `lead.depth_sign`
/// (along +u when the approach has no depth).
pub(crate) fn profile(figure: &Figure, plane: &Plane, lead: &LeadIn) -> Vec<Piece> {
    let sign = if lead.depth_sign == 0 { 1 } else { lead.depth_sign };
    let origin = plane.split(figure.start).0;
    let depth = |(u, v): (i64, i64)| (sign * (u - origin), v);
    let mut pieces = Vec::with_capacity(figure.elements.len());
    let mut from = depth(lead.end);
    for (index, element) in figure.elements.iter().enumerate().skip(lead.elements) {
        let to = depth(plane.split(element.to));
        let number = crate::pass_number(index as u64);
        match element.motion {
            FigureMotion::Arc { turn, centre } => {
                let centre = depth(plane.split(centre));
                // Exchanging the axes or turning one round reverses the turn as it is seen in (h, v).
                let seen_with_v_right = plane.depth_is_x == (sign > 0);
                let counter_clockwise = (turn == Turn::CounterClockwise) == seen_with_v_right;
                push_arc(&mut pieces, from, to, centre, counter_clockwise, number);
            }
            _ if to != from => pieces.push(piece(from, to, number, Curve::Line)),
            _ => {}
        }
        from = to;
    }
    pieces
}

const fn piece(from: (i64, i64), to: (i64, i64), element: u32, curve: Curve) -> Piece {
    Piece { h0: from.0, h1: to.0, v0: from.1, v1: to.1, element, curve }
}

/// Cuts an arc at its extreme points. Here h points up and v to the right.
fn push_arc(
    pieces: &mut Vec<Piece>,
    from: (i64, i64),
    to: (i64, i64),
    centre: (i64, i64),
    counter_clockwise: bool,
    element: u32,
) {
    // A clockwise arc is a counter-clockwise one in a mirror: turn h round, and round again on the way out.
    let mirror = if counter_clockwise { 1 } else { -1 };
    let arm = |place: (i64, i64)| (place.1 - centre.1, mirror * (place.0 - centre.0));
    let (start, end) = (arm(from), arm(to));
    let radius = (start.0 as f64 * start.0 as f64 + start.1 as f64 * start.1 as f64).sqrt();
    let (first, count) = extremes_passed(start, end);
    let mut at = from;
    for quarter in first..first + count {
        let reach = radius.round() as i64;
        let arm = match quarter % 4 {
            0 => (reach, 0),
            1 => (0, reach),
            2 => (-reach, 0),
            _ => (0, -reach),
        };
        let extreme = (centre.0 + mirror * arm.1, centre.1 + arm.0);
        push_quarter(pieces, at, extreme, centre, radius, element);
        at = extreme;
    }
    push_quarter(pieces, at, to, centre, radius, element);
}

fn push_quarter(
    pieces: &mut Vec<Piece>,
    from: (i64, i64),
    to: (i64, i64),
    centre: (i64, i64),
    radius: f64,
    element: u32,
) {
    if from != to {
        let side = (from.1 - centre.1 + to.1 - centre.1).signum();
        pieces.push(piece(from, to, element, Curve::Arc { h: centre.0, v: centre.1, radius, side }));
    }
}

/// Which quarter points (0 right, 1 top, 2 left, 3 bottom, counted on past 3) a counter-clockwise arc meets after
/// its start and before its end: the first, and how many. Whole numbers only, so no angle can slip.
fn extremes_passed(start: (i64, i64), end: (i64, i64)) -> (u32, u32) {
    let (from, to) = (quadrant(start), quadrant(end));
    let cross = i128::from(start.0) * i128::from(end.1) - i128::from(start.1) * i128::from(end.0);
    let crossed = match (to + 4 - from) % 4 {
        0 if cross > 0 => 0,
        0 => 4,
        quarters => quarters,
    };
    (from + 1, crossed)
}

/// 0 to 3, each with the quarter point it begins at.
const fn quadrant((right, up): (i64, i64)) -> u32 {
    match (right, up) {
        (1.., 0..) => 0,
        (..=0, 1..) => 1,
        (..=-1, ..=0) => 2,
        _ => 3,
    }
}

/// The first place where the contour turns back on an axis by more than `tolerance`, walking from
/// the end of the approach: along the cut it must keep the direction from begin to end, along the depth axis it
/// must only rise towards the start. `None` also for a figure without a contour.
pub fn monotony_fault(figure: &Figure, along: CutAlong, tolerance: Tolerance) -> Option<MonotonyFault> {
    let plane = Plane::new(along == CutAlong::Z, LeastIncrement::METRIC_C);
    within_range(figure)?;
    let lead = lead_in(figure, &plane)?;
    let pieces = profile(figure, &plane, &lead);
    monotony_fault_of(&pieces, along, tolerance, &lead)
}

pub(crate) fn monotony_fault_of(
    pieces: &[Piece],
    along: CutAlong,
    tolerance: Tolerance,
    lead: &LeadIn,
) -> Option<MonotonyFault> {
    let (cut_axis, depth_axis) = match along {
        CutAlong::Z => (PlaneAxis::First, PlaneAxis::Second),
        CutAlong::X => (PlaneAxis::Second, PlaneAxis::First),
    };
    let forward = cut_sign(pieces)?;
    let (along_cut, along_depth) = tolerance.split(along);
    let rise = match lead.depth_sign {
        0 => pieces.last().map_or(0, |last| (last.h1 - pieces[0].h0).signum()),
        _ => -1,
    };
    let (mut furthest_v, mut furthest_h) = (i64::MIN, i64::MIN);
    for piece in pieces {
        furthest_v = furthest_v.max(forward * piece.v0);
        furthest_h = furthest_h.max(rise * piece.h0);
        if furthest_v - forward * piece.v1 > along_cut {
            return Some(MonotonyFault { axis: cut_axis, element: piece.element });
        }
        let against = if rise == 0 { (piece.h1 - piece.h0).abs() } else { furthest_h - rise * piece.h1 };
        if against > along_depth {
            return Some(MonotonyFault { axis: depth_axis, element: piece.element });
        }
    }
    None
}

/// The first place where the contour of a figure with pockets turns back along the cut by more than `tolerance`: no
/// pass could follow it.
pub fn turn_back_fault(figure: &Figure, along: CutAlong, tolerance: Tolerance) -> Option<MonotonyFault> {
    let plane = Plane::new(along == CutAlong::Z, LeastIncrement::METRIC_C);
    within_range(figure)?;
    let lead = pocket_lead_in(figure, &plane)?;
    let mut pieces = profile(figure, &plane, &lead);
    let forward = cut_sign(&pieces)?;
    straighten(&mut pieces, forward, tolerance, along).err()
}

/// The element that rises highest above the end of the contour, if one does: the way back from the end to the start
/// leads through it.
pub fn hump_before_end(figure: &Figure, along: CutAlong, tolerance: Tolerance) -> Option<u32> {
    let plane = Plane::new(along == CutAlong::Z, LeastIncrement::METRIC_C);
    within_range(figure)?;
    let lead = pocket_lead_in(figure, &plane)?;
    let pieces = profile(figure, &plane, &lead);
    let (begin, end) = (pieces.first()?, pieces.last()?.h1);
    let begin = std::iter::once((begin.h0, begin.element));
    let corners = begin.chain(pieces.iter().map(|piece| (piece.h1, piece.element)));
    let (highest, element) = corners.min_by_key(|corner| corner.0)?;
    (end - highest > tolerance.split(along).1).then_some(element)
}

/// How many pockets the contour has: how often it goes down again, seen in the direction of the cut.
pub fn pocket_count(figure: &Figure, along: CutAlong, tolerance: Tolerance) -> u32 {
    let plane = Plane::new(along == CutAlong::Z, LeastIncrement::METRIC_C);
    let pieces = within_range(figure)
        .and_then(|()| pocket_lead_in(figure, &plane))
        .map_or(Vec::new(), |lead| profile(figure, &plane, &lead));
    let slack = tolerance.split(along).1;
    let (mut count, mut is_down) = (0, false);
    let mut turn = pieces.first().map_or(0, |piece| piece.h0);
    for piece in pieces {
        // The deepest place while it goes down, the highest while it goes up.
        if is_down == (piece.h1 > turn) {
            turn = piece.h1;
        } else if (piece.h1 - turn).abs() > slack {
            (is_down, turn) = (!is_down, piece.h1);
            count += u32::from(is_down);
        }
    }
    count
}

/// Direction of the cut along v: from begin to end of the contour, or of its first stretch along v when both have
/// the same v. `None` when nothing moves along v.
pub(crate) fn cut_sign(pieces: &[Piece]) -> Option<i64> {
    let whole = (pieces.last()?.v1 - pieces.first()?.v0).signum();
    let first = pieces.iter().map(|piece| (piece.v1 - piece.v0).signum()).find(|&sign| sign != 0)?;
    Some(if whole == 0 { first } else { whole })
}

/// Whether the figure reaches beyond the start point on the depth axis. A positive allowance says that the work
/// lies below A, a negative one that it lies above; without an allowance the approach says it.
pub fn start_inside_fault(
    figure: &Figure,
    along: CutAlong,
    allowance_x: Radius,
    allowance_z: Length,
) -> Option<StartFault> {
    let plane = Plane::new(along == CutAlong::Z, LeastIncrement::METRIC_C);
    within_range(figure)?;
    let lead = lead_in(figure, &plane)?;
    let allowance = plane.split_lengths(allowance_x, allowance_z).0.signum();
    let outward = if allowance == 0 { -lead.depth_sign } else { allowance };
    let axis = if plane.depth_is_x { PlaneAxis::Second } else { PlaneAxis::First };
    let depth_sign = if lead.depth_sign == 0 { 1 } else { lead.depth_sign };
    // h grows along depth_sign and is 0 at A.
    let beyond = |h: i64| outward * depth_sign * h > 0;
    if beyond(depth_sign * (lead.end.0 - plane.split(figure.start).0)) {
        return Some(StartFault { axis, element: crate::pass_number(lead.elements as u64 - 1) });
    }
    let pieces = profile(figure, &plane, &lead);
    let out = pieces.iter().find(|piece| beyond(piece.h1))?;
    Some(StartFault { axis, element: out.element })
}

fn within_range(figure: &Figure) -> Option<()> {
    in_range(&[figure.start.x.0, figure.start.z]).ok()?;
    for element in &figure.elements {
        in_range(&[element.to.x.0, element.to.z]).ok()?;
        if let FigureMotion::Arc { centre, .. } = element.motion {
            in_range(&[centre.x.0, centre.z]).ok()?;
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(diameter: i32, z: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(i64::from(diameter) * 500_000)), Length::from_mm(z))
    }

    fn line(diameter: i32, z: i32) -> Element {
        Element { to: place(diameter, z), motion: FigureMotion::Line, line: 0 }
    }

    fn arc(diameter: i32, z: i32, turn: Turn, centre: (i32, i32)) -> Element {
        let motion = FigureMotion::Arc { turn, centre: place(centre.0, centre.1) };
        Element { to: place(diameter, z), motion, line: 0 }
    }

    fn figure(elements: Vec<Element>) -> Figure {
        Figure { start: place(60, 2), elements }
    }

    #[test]
    fn a_ball_end_is_monotone_and_a_bulge_is_not() {
        // Half-ball of radius 10 on the axis, from the pole to the equator.
        let ball = figure(vec![line(0, 2), line(0, 0), arc(20, -10, Turn::CounterClockwise, (0, -10))]);
        assert_eq!(monotony_fault(&ball, CutAlong::Z, Tolerance::EXACT), None);
        // The same circle 5 mm further round turns back on X.
        let centre = place(0, -10);
        let beyond = Element {
            to: Position::new(Radius(Length::from_mm(8)), Length::from_mm(-16)),
            motion: FigureMotion::Arc { turn: Turn::CounterClockwise, centre },
            line: 0,
        };
        let bulge = figure(vec![line(0, 2), line(0, 0), beyond]);
        let fault = MonotonyFault { axis: PlaneAxis::Second, element: 2 };
        assert_eq!(monotony_fault(&bulge, CutAlong::Z, Tolerance::EXACT), Some(fault));
        assert_eq!(monotony_fault(&bulge, CutAlong::Z, Tolerance::both(Length::from_mm(2))), None);
    }

    #[test]
    fn an_arc_between_monotone_ends_is_seen_to_swing_out() {
        // From X20 to X40 along Z, but the long way round.
        let swung = figure(vec![line(20, 2), line(20, -10), arc(40, -20, Turn::Clockwise, (40, -10))]);
        assert_eq!(monotony_fault(&swung, CutAlong::Z, Tolerance::EXACT), None);
        let wrong = figure(vec![line(20, 2), line(20, -10), arc(40, -20, Turn::CounterClockwise, (40, -10))]);
        assert_eq!(
            monotony_fault(&wrong, CutAlong::Z, Tolerance::EXACT),
            Some(MonotonyFault { axis: PlaneAxis::First, element: 2 })
        );
    }

    #[test]
    fn a_start_below_the_figure_is_found() {
        let high = figure(vec![line(20, 2), line(20, -10), line(70, -20)]);
        let fault = Some(StartFault { axis: PlaneAxis::Second, element: 2 });
        assert_eq!(start_inside_fault(&high, CutAlong::Z, Radius::ZERO, Length::ZERO), fault);
        let bore = figure(vec![line(80, 2), line(80, -10), line(70, -20)]);
        let minus = -Radius(Length::from_mm(1));
        assert_eq!(start_inside_fault(&bore, CutAlong::Z, minus, Length::ZERO), None);
        assert!(start_inside_fault(&bore, CutAlong::Z, -minus, Length::ZERO).is_some());
    }

    #[test]
    fn the_approach_goes_on_while_it_goes_down() {
        let plane = Plane::new(true, LeastIncrement::METRIC_B);
        let two = figure(vec![line(40, 2), line(20, 2), line(20, -10), line(50, -10)]);
        let lead = lead_in(&two, &plane).expect("an approach");
        assert_eq!((lead.elements, lead.end.0, lead.depth_sign), (2, 10_000_000, -1));
        let back = figure(vec![line(20, 2), line(40, 2), line(40, -10)]);
        assert_eq!(lead_in(&back, &plane).expect("an approach").elements, 1);
    }

    #[test]
    fn quarter_points_are_counted() {
        assert_eq!(extremes_passed((1, 0), (0, 1)), (1, 1));
        assert_eq!(extremes_passed((1, 0), (1, 0)), (1, 4));
        assert_eq!(extremes_passed((2, 1), (1, 2)), (1, 0));
        assert_eq!(extremes_passed((1, 2), (2, 1)), (1, 4));
        assert_eq!(extremes_passed((0, -1), (0, 1)), (4, 2));
        assert_eq!(quadrant((0, 0)), 3);
    }
}
