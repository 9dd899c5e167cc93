//! Pecked grooving and drilling, across the axis or into the face: one procedure with the axes exchanged.
//!
//! In: a [`GrooveRequest`]. Out: column after column (pecks with a small return after each, relief at the bottom,
//! out), steps sideways between them, home. The last peck and the last column end exactly at the end point.
//! Needs no more memory than one column's counters.
//!
//! Not here: whether the first column has room for a relief, which words may be left out, radius or diameter of the
//! words. Source: face and radial grooving, chapters 7 and 8 of the cycles.

use turnwright_canon::{Action, Phase};
use turnwright_units::{Length, Position, WorkTip};

use crate::plane::{Plane, in_range};
use crate::{Context, CycleMove, Misuse, Tool, pass_number};

/// The axis of the pecks; columns lie side by side along the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PeckAxis {
    /// Across the spindle axis: radial grooves.
    X,
    /// Along the spindle axis: face grooves and drilling.
    Z,
}

/// Which way the tool moves off at the bottom when there is only one column. With several it always moves against
/// the direction of the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReliefDirection {
    /// Only ever against the columns: a single column has no relief.
    AgainstShift,
    /// Towards plus.
    AlwaysPlus,
    /// Towards the sign of the relief word.
    BySign,
}

/// The words of pecked grooving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrooveRequest {
    /// State the cycle starts in.
    pub context: Context,
    /// Axis of the pecks.
    pub peck_axis: PeckAxis,
    /// Bottom of the last column.
    pub end: Position<WorkTip>,
    /// Depth of a peck, radius along X; `None` or zero: straight to the bottom.
    pub peck: Option<Length>,
    /// Step from column to column, radius along X; may only be missing or zero when there is one column.
    pub step: Option<Length>,
    /// Return after a peck, radius along X. Not negative.
    pub retract: Length,
    /// Relief at the bottom, radius along X; signed only where its direction is not fixed otherwise.
    pub relief: Length,
    /// Direction of the relief of a single column.
    pub relief_direction: ReliefDirection,
}

/// The moves of pecked grooving.
#[derive(Clone, Debug)]
pub struct Groove {
    context: Context,
    plane: Plane,
    tool: Tool,
    start: (i64, i64),
    /// Signed way of a peck, a return, a step and a relief, and the whole ways along both axes.
    peck: i64,
    retract: i64,
    step: i64,
    relief: i64,
    total: i64,
    span: i64,
    pecks: i64,
    columns: i64,
    column: i64,
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Peck(i64),
    Back(i64),
    Relief,
    Out,
    Shift,
    Home,
    Done,
}

/// Plans pecked grooving.
///
/// # Errors
/// [`Misuse::PeckNegative`], [`Misuse::StepNegative`], [`Misuse::StepZero`], [`Misuse::RetractNegative`],
/// [`Misuse::ReliefNegative`], [`Misuse::BelowIncrement`], [`Misuse::OutOfRange`].
pub fn groove(request: GrooveRequest) -> Result<Groove, Misuse> {
    let context = request.context;
    let plane = Plane::new(request.peck_axis == PeckAxis::X, context.increment);
    let (peck, step) = (request.peck.unwrap_or(Length::ZERO), request.step.unwrap_or(Length::ZERO));
    in_range(&[context.start.x.0, context.start.z, request.end.x.0, request.end.z])?;
    in_range(&[peck, step, request.retract, request.relief])?;
    let (start, end) = (plane.split(context.start), plane.split(request.end));
    let (total, span) = (end.0 - start.0, end.1 - start.1);
    check_words(&request, peck, step, span)?;
    check_grid(peck, plane.grid_u())?;
    check_grid(step, plane.grid_v())?;
    Ok(Groove {
        context,
        plane,
        tool: Tool::new(context.start),
        start,
        peck: peck.nm() * total.signum(),
        retract: request.retract.nm() * total.signum(),
        step: step.nm() * span.signum(),
        relief: relief_way(&request, span),
        total,
        span,
        pecks: parts(total, peck.nm()),
        columns: if span == 0 { 1 } else { 1 + parts(span, step.nm()) },
        column: 1,
        next: Next::Peck(1),
    })
}

fn check_words(request: &GrooveRequest, peck: Length, step: Length, span: i64) -> Result<(), Misuse> {
    if peck.nm() < 0 {
        return Err(Misuse::PeckNegative);
    }
    if step.nm() < 0 {
        return Err(Misuse::StepNegative);
    }
    if step.is_zero() && span != 0 {
        return Err(Misuse::StepZero);
    }
    if request.retract.nm() < 0 {
        return Err(Misuse::RetractNegative);
    }
    let fixed = span != 0 || request.relief_direction != ReliefDirection::BySign;
    if fixed && request.relief.nm() < 0 {
        return Err(Misuse::ReliefNegative);
    }
    Ok(())
}

const fn check_grid(length: Length, grid: i64) -> Result<(), Misuse> {
    if length.nm() > 0 && length.nm() < grid { Err(Misuse::BelowIncrement) } else { Ok(()) }
}

/// How many parts of `part` it takes to go `whole`, the last one shortened; one when they are not cut up.
const fn parts(whole: i64, part: i64) -> i64 {
    if part == 0 || whole == 0 { 1 } else { (whole.abs() - 1) / part + 1 }
}

const fn relief_way(request: &GrooveRequest, span: i64) -> i64 {
    let relief = request.relief.nm();
    if span != 0 {
        return -span.signum() * relief;
    }
    match request.relief_direction {
        ReliefDirection::AgainstShift => 0,
        ReliefDirection::AlwaysPlus | ReliefDirection::BySign => relief,
    }
}

impl Groove {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        let pecks = u64::try_from(self.pecks).unwrap_or(0);
        let columns = u64::try_from(self.columns).unwrap_or(0);
        pecks.saturating_mul(2).saturating_add(3).saturating_mul(columns).saturating_add(1)
    }

    fn advance(&mut self) -> Option<CycleMove> {
        let (top, side) = (self.start.0, self.column_v());
        let bottom = top + self.total;
        let (phase, u, v) = match self.next {
            Next::Peck(count) => {
                self.next = if count < self.pecks { Next::Back(count) } else { Next::Relief };
                (Phase::Peck, self.peck_u(count), side)
            }
            Next::Back(count) => {
                self.next = Next::Peck(count + 1);
                (Phase::Back, self.peck_u(count) - self.retract, side)
            }
            Next::Relief => {
                self.next = Next::Out;
                (Phase::Relief, bottom, side + self.relief)
            }
            Next::Out => {
                self.next = if self.column < self.columns { Next::Shift } else { Next::Home };
                (Phase::Out, top, side + self.relief)
            }
            Next::Shift => {
                self.column += 1;
                self.next = Next::Peck(1);
                (Phase::Shift, top, self.column_v())
            }
            Next::Home => {
                self.next = Next::Done;
                return Some(self.tell(self.context.rapid(self.context.start), Phase::Home));
            }
            Next::Done => return None,
        };
        let to = self.plane.place(u, v);
        let action = if phase == Phase::Peck { self.context.line(to) } else { self.context.rapid(to) };
        Some(self.tell(action, phase))
    }

    /// Depth axis after peck `count`; the last one reaches the bottom exactly.
    const fn peck_u(&self, count: i64) -> i64 {
        self.start.0 + if count < self.pecks { self.peck * count } else { self.total }
    }

    /// Where the present column lies; the last one exactly at the end.
    const fn column_v(&self) -> i64 {
        self.start.1 + if self.column < self.columns { self.step * (self.column - 1) } else { self.span }
    }

    fn tell(&self, action: Action, phase: Phase) -> CycleMove {
        CycleMove { action, phase, pass: pass_number(u64::try_from(self.column).unwrap_or(0)), element: None }
    }
}

impl Iterator for Groove {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        loop {
            let step = self.advance()?;
            if self.tool.goes(&step) {
                return Some(step);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use turnwright_canon::RapidPath;
    use turnwright_units::{Feed, FeedPerRevolution, LeastIncrement, Radius};

    use super::*;

    fn request() -> GrooveRequest {
        let context = Context {
            start: Position::new(Radius(Length::from_mm(20)), Length::ZERO),
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(100_000))),
            rapid: RapidPath::EachAxis,
        };
        GrooveRequest {
            context,
            peck_axis: PeckAxis::X,
            end: Position::new(Radius(Length::from_mm(10)), Length::from_mm(-10)),
            peck: Some(Length::from_mm(3)),
            step: Some(Length::from_mm(4)),
            retract: Length::from_mm(1),
            relief: Length::from_mm(0),
            relief_direction: ReliefDirection::BySign,
        }
    }

    fn refused(request: GrooveRequest) -> Misuse {
        groove(request).map(|_| ()).expect_err("refused")
    }

    #[test]
    fn each_wrong_word_has_its_name() {
        let minus = Length::from_mm(-1);
        assert_eq!(refused(GrooveRequest { peck: Some(minus), ..request() }), Misuse::PeckNegative);
        assert_eq!(refused(GrooveRequest { step: Some(minus), ..request() }), Misuse::StepNegative);
        assert_eq!(refused(GrooveRequest { step: None, ..request() }), Misuse::StepZero);
        assert_eq!(refused(GrooveRequest { retract: minus, ..request() }), Misuse::RetractNegative);
        assert_eq!(refused(GrooveRequest { relief: minus, ..request() }), Misuse::ReliefNegative);
        let dust = Some(Length::from_nm(1));
        assert_eq!(refused(GrooveRequest { peck: dust, ..request() }), Misuse::BelowIncrement);
        assert_eq!(refused(GrooveRequest { step: dust, ..request() }), Misuse::BelowIncrement);
    }

    #[test]
    fn without_a_peck_each_column_is_one_feed() {
        let moves: Vec<_> = groove(GrooveRequest { peck: None, ..request() }).expect("a groove").collect();
        assert_eq!(moves.iter().filter(|step| step.phase == Phase::Peck).count(), 4);
        assert!(moves.iter().all(|step| step.phase != Phase::Back));
    }

    #[test]
    fn relief_goes_against_the_columns_or_as_asked() {
        let relief_z = |direction, relief, end_z| {
            let end = Position::new(Radius(Length::from_mm(10)), Length::from_mm(end_z));
            let asked = GrooveRequest {
                relief: Length::from_mm(relief),
                relief_direction: direction,
                end,
                ..request()
            };
            let mut moves = groove(asked).expect("a groove");
            moves
                .find(|step| step.phase == Phase::Relief)
                .and_then(|step| step.action.end_point())
                .map(|to| to.z)
        };
        assert_eq!(relief_z(ReliefDirection::BySign, 1, -10), Some(Length::from_mm(1)));
        assert_eq!(relief_z(ReliefDirection::BySign, 1, 10), Some(Length::from_mm(-1)));
        assert_eq!(relief_z(ReliefDirection::BySign, -1, 0), Some(Length::from_mm(-1)));
        assert_eq!(relief_z(ReliefDirection::AlwaysPlus, 1, 0), Some(Length::from_mm(1)));
        assert_eq!(relief_z(ReliefDirection::AgainstShift, 1, 0), None);
    }

    #[test]
    fn the_estimate_is_not_exceeded() {
        let cycle = groove(GrooveRequest { relief: Length::from_mm(1), ..request() }).expect("a groove");
        let estimate = cycle.move_estimate();
        assert!(cycle.count() as u64 <= estimate);
    }
}
