//! Pattern repeating: the figure is run several times, each time nearer to its place.
//!
//! In: a [`Figure`] and a [`PatternRequest`]. Out: for each pass a rapid to the moved start, then the whole
//! figure moved by the same way; after the last pass a rapid to the start. The first pass lies off by relief and
//! allowance, the last by the allowance alone, and the passes between divide the relief evenly. Rapid elements
//! stay rapid; arcs are moved, not offset.
//!
//! Not here: whether the figure closes (a figure that ends away from its start makes the tool cross from there to
//! the start of the next pass at rapid, as the control does). Source: pattern repeating, chapter 5 of the cycles.

use turnwright_canon::{Action, Phase};
use turnwright_units::{Displacement, Length, Radius, WorkTip};

use crate::figure::snap;
use crate::plane::{in_range, ratio_on_grid};
use crate::{Context, CycleMove, Figure, FigureMotion, Misuse, Tool, pass_number};

/// What one commanded pass means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinglePass {
    /// One pass, at the allowance.
    Once,
    /// Two passes: one at full relief, one at the allowance. Some controls run at least two.
    Twice,
}

/// The words of pattern repeating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternRequest {
    /// State the cycle starts in.
    pub context: Context,
    /// Relief of the first pass along X, radius, signed.
    pub relief_x: Radius,
    /// Relief of the first pass along Z, signed.
    pub relief_z: Length,
    /// Number of passes, at least 1.
    pub passes: u32,
    /// Finishing allowance along X, radius, signed.
    pub allowance_x: Radius,
    /// Finishing allowance along Z, signed.
    pub allowance_z: Length,
    /// What one pass means.
    pub single_pass: SinglePass,
}

/// The moves of pattern repeating.
#[derive(Clone, Debug)]
pub struct Pattern {
    figure: Figure,
    request: PatternRequest,
    tool: Tool,
    passes: u32,
    pass: u32,
    shift: Displacement<WorkTip>,
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Start,
    Element(usize),
    Home,
    Done,
}

/// Plans pattern repeating of `figure`.
///
/// # Errors
/// [`Misuse::PassesZero`], [`Misuse::NoContour`] for an empty figure, [`Misuse::StartMismatch`],
/// [`Misuse::OutOfRange`].
pub fn pattern(figure: Figure, request: PatternRequest) -> Result<Pattern, Misuse> {
    in_range(&[request.relief_x.0, request.relief_z, request.allowance_x.0, request.allowance_z])?;
    let figure = figure.prepare(&request.context)?;
    if request.passes == 0 {
        return Err(Misuse::PassesZero);
    }
    let passes = match request.single_pass {
        SinglePass::Once => request.passes,
        SinglePass::Twice => request.passes.max(2),
    };
    let tool = Tool::new(request.context.start);
    let shift = Displacement::new(Radius::ZERO, Length::ZERO);
    Ok(Pattern { figure, request, tool, passes, pass: 0, shift, next: Next::Start })
}

impl Pattern {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        u64::from(self.passes).saturating_mul(self.figure.elements.len() as u64 + 1).saturating_add(1)
    }

    /// How far pass `pass` (from 1) lies from the figure. Rounded as one displacement, so that the moved figure
    /// keeps its shape to the last digit.
    fn shift_of(&self, pass: u32) -> Displacement<WorkTip> {
        let step = self.request.context.increment.nm();
        let x = self.part(self.request.allowance_x.0, self.request.relief_x.0, pass, step / 2);
        let z = self.part(self.request.allowance_z, self.request.relief_z, pass, step);
        Displacement::new(Radius(x), z)
    }

    fn part(&self, allowance: Length, relief: Length, pass: u32, grid: i64) -> Length {
        let gaps = i128::from(self.passes.saturating_sub(1)).max(1);
        let left = i128::from(self.passes - pass);
        let exact = i128::from(allowance.nm()) * gaps + i128::from(relief.nm()) * left;
        Length::from_nm(ratio_on_grid(exact, gaps, grid))
    }

    fn advance(&mut self) -> Option<CycleMove> {
        let step = match self.next {
            Next::Start => self.start_pass(),
            Next::Element(index) => self.run_element(index)?,
            Next::Home => {
                self.next = Next::Done;
                self.tell(self.request.context.rapid(self.request.context.start), Phase::Home, None)
            }
            Next::Done => return None,
        };
        Some(step)
    }

    fn start_pass(&mut self) -> CycleMove {
        self.pass += 1;
        self.shift = self.shift_of(self.pass);
        self.next = Next::Element(0);
        let phase = if self.pass == 1 { Phase::Approach } else { Phase::Shift };
        let to = snap(self.figure.start + self.shift, self.request.context.increment);
        self.tell(self.request.context.rapid(to), phase, None)
    }

    fn run_element(&mut self, index: usize) -> Option<CycleMove> {
        let element = self.figure.elements.get(index)?;
        let context = &self.request.context;
        let action = match element.motion {
            FigureMotion::Rapid => context.rapid(self.figure.end(index, self.shift)),
            _ => self.figure.cut(index, self.shift, context),
        };
        self.next = match (index + 1 < self.figure.elements.len(), self.pass < self.passes) {
            (true, _) => Next::Element(index + 1),
            (false, true) => Next::Start,
            (false, false) => Next::Home,
        };
        Some(self.tell(action, Phase::Cut, Some(pass_number(index as u64))))
    }

    const fn tell(&self, action: Action, phase: Phase, element: Option<u32>) -> CycleMove {
        CycleMove { action, phase, pass: self.pass, element }
    }
}

impl Iterator for Pattern {
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
    use turnwright_units::{Feed, FeedPerRevolution, LeastIncrement, Position};

    use super::*;
    use crate::Element;

    fn place(x: i32, z: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_mm(x)), Length::from_mm(z))
    }

    fn request(passes: u32) -> PatternRequest {
        let context = Context {
            start: place(30, 2),
            increment: LeastIncrement::METRIC_B,
            feed: Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000))),
            rapid: RapidPath::EachAxis,
        };
        PatternRequest {
            context,
            relief_x: Radius(Length::from_mm(1)),
            relief_z: Length::ZERO,
            passes,
            allowance_x: Radius::ZERO,
            allowance_z: Length::ZERO,
            single_pass: SinglePass::Once,
        }
    }

    fn figure(start: Position<WorkTip>, to: &[Position<WorkTip>]) -> Figure {
        let element = |&to| Element { to, motion: FigureMotion::Line, line: 0 };
        Figure { start, elements: to.iter().map(element).collect() }
    }

    fn refused(figure: Figure, request: PatternRequest) -> Misuse {
        pattern(figure, request).map(|_| ()).expect_err("refused")
    }

    #[test]
    fn each_wrong_word_has_its_name() {
        let one = figure(place(30, 2), &[place(20, 2)]);
        assert_eq!(refused(one.clone(), request(0)), Misuse::PassesZero);
        assert_eq!(refused(figure(place(30, 2), &[]), request(2)), Misuse::NoContour);
        assert_eq!(refused(figure(place(30, 2), &[place(30, 2)]), request(2)), Misuse::NoContour);
        assert_eq!(refused(figure(place(31, 2), &[place(20, 2)]), request(2)), Misuse::StartMismatch);
        let far = PatternRequest { relief_z: Length::from_nm(i64::MIN), ..request(2) };
        assert_eq!(refused(one, far), Misuse::OutOfRange);
    }

    #[test]
    fn one_element_is_enough() {
        let cycle = pattern(figure(place(30, 2), &[place(20, 2)]), request(2)).expect("a pattern");
        let phases: Vec<_> = cycle.map(|step| step.phase).collect();
        assert_eq!(phases, [Phase::Approach, Phase::Cut, Phase::Shift, Phase::Cut, Phase::Home]);
    }
}
