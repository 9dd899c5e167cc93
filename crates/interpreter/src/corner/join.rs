//! Breaking a corner between two elements: the rules of the right angle, and of any two elements.

use turnwright_canon::{Shape, Turn};
use turnwright_diagnostics::Diagnostic;
use turnwright_geometry::{Bend, Breaking, Corner, CornerFault, Segment, break_corner};
use turnwright_units::{Length, Position, WorkTip};

use super::words::{CornerWord, Form, Rule};
use super::{Element, PARALLEL_DEG};
use crate::machine::Core;
use crate::plane::{between_ends, place, point};
use crate::report::Alarm;

/// Cuts that meet at less than this are tangent: programmed ends are rounded, and short arcs turn by it.
const TANGENT_DEG: f64 = 0.1;

/// The axis of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X,
    Z,
}

impl Axis {
    const fn other(self) -> Self {
        match self {
            Self::X => Self::Z,
            Self::Z => Self::X,
        }
    }

    /// The way along this axis.
    fn way(self, from: Position<WorkTip>, to: Position<WorkTip>) -> Length {
        match self {
            Self::X => (to.x - from.x).0,
            Self::Z => to.z - from.z,
        }
    }

    /// The axis along which a line runs, when it runs along one.
    fn of(element: &Element) -> Option<Self> {
        let way = |axis: Self| axis.way(element.from, element.to).is_zero();
        match (way(Self::X), way(Self::Z)) {
            (false, true) => Some(Self::X),
            (true, false) => Some(Self::Z),
            _ => None,
        }
    }
}

impl Element {
    fn segment(&self) -> Option<Segment> {
        let bend = match self.shape {
            Shape::Line => None,
            // Paths lie in the turning plane, and corners are between lines and circles.
            Shape::SideArc { .. } | Shape::Curve(_) => return None,
            Shape::Arc { turn, centre } => {
                Some(Bend { centre: point(centre), clockwise: turn == Turn::Clockwise })
            }
        };
        Some(Segment { start: self.start, end: self.end?, bend })
    }
}

fn turn(bend: Bend) -> Turn {
    if bend.clockwise { Turn::Clockwise } else { Turn::CounterClockwise }
}

impl Core {
    /// What a block with a word of the right-angled corner must itself be: a line along one axis, long enough.
    pub(super) fn check_right_angle(&self, element: &mut Element) -> Result<(), Alarm> {
        let axis = Axis::of(element);
        let is_slanting =
            element.end.is_none() || (element.from.x != element.to.x && element.from.z != element.to.z);
        let Some(corner) = &mut element.corner else { return Ok(()) };
        if corner.rule == Rule::PlainLetter
            && (is_slanting || element.angle.is_some())
            && corner.size.signum() > 0
        {
            // Only a drawing dimension can mean this.
            corner.rule = Rule::AnyLines;
        }
        if !matches!(corner.rule, Rule::RightAngle | Rule::PlainLetter) {
            return Ok(());
        }
        let Some(axis) = axis else {
            let key = if is_slanting { "taper-in-corner-block" } else { "corner-longer-than-move" };
            return Err(self.alarm(key, &corner.word));
        };
        // I leads off in X and so belongs to a line along Z; K the other way round.
        let fits = match corner.word.address {
            b'I' => axis == Axis::Z,
            b'K' => axis == Axis::X,
            _ => true,
        };
        if fits { Ok(()) } else { Err(self.alarm("corner-axis-mismatch", &corner.word)) }
    }

    /// The way of a corner between its rounded ends.
    pub(super) fn corner_shape(
        &self,
        corner: &Corner,
        before: Position<WorkTip>,
        after: Position<WorkTip>,
    ) -> Shape {
        let Some(bend) = corner.bend else { return Shape::Line };
        let rounding_mm = self.modal.increment(&self.settings).to_mm();
        match place(between_ends(bend.centre, point(before), point(after), rounding_mm)) {
            Some(centre) => Shape::Arc { turn: turn(bend), centre },
            None => Shape::Line,
        }
    }

    /// A line along an axis must hold its own corner, whatever comes next.
    pub(super) fn check_room(&self, element: &Element) -> Result<(), Alarm> {
        match (&element.corner, element.end) {
            (Some(corner), Some(end))
                if matches!(corner.rule, Rule::RightAngle | Rule::PlainLetter)
                    && element.start.distance(end) + self.half_increment_mm() < corner.size.abs().to_mm() =>
            {
                Err(self.alarm("corner-longer-than-move", &corner.word))
            }
            _ => Ok(()),
        }
    }

    /// Ends are rounded to the increment, so an element may be shorter by half of it than it was meant.
    fn half_increment_mm(&self) -> f64 {
        self.modal.increment(&self.settings).to_mm() / 2.0
    }

    /// The corner between two elements; `None` when they leave none to break.
    pub(super) fn broken(
        &mut self,
        first: &Element,
        word: &CornerWord,
        second: &Element,
    ) -> Result<Option<Corner>, Alarm> {
        let is_right_angled = match word.rule {
            Rule::RightAngle => true,
            Rule::PlainLetter => {
                word.size.signum() < 0
                    || Axis::of(first).zip(Axis::of(second)).is_some_and(|(one, other)| one != other)
            }
            Rule::AnyLines | Rule::AnyCuts => false,
        };
        if is_right_angled {
            self.check_perpendicular(first, word, second)?;
        }
        let (Some(before), Some(behind)) = (first.segment(), second.segment()) else { return Ok(None) };
        let size = word.size.abs().to_mm();
        let breaking = match (word.form, word.rule) {
            (Form::Fillet, _) => Breaking::Fillet(size),
            (Form::Chamfer, Rule::AnyCuts) if !self.settings.corner_length_to_corner => {
                Breaking::ChamferOfLength(size)
            }
            (Form::Chamfer, _) => Breaking::ChamferFromCorner(size),
        };
        let has_arc = before.bend.is_some() || behind.bend.is_some();
        let is_drawn = word.rule != Rule::AnyCuts || first.angle.is_some() || second.angle.is_some();
        let straight_deg = if is_drawn { PARALLEL_DEG } else { TANGENT_DEG };
        let slack_mm = self.half_increment_mm();
        match break_corner(&before, &behind, breaking, straight_deg.to_radians(), slack_mm) {
            Ok(corner) => {
                if has_arc && word.form == Form::Chamfer {
                    self.say_at_corner("behaviour-uncertain", word);
                }
                Ok(Some(corner))
            }
            Err(CornerFault::Straight) => {
                self.say_at_corner("corner-without-angle", word);
                Ok(None)
            }
            Err(CornerFault::TooLong) => {
                let diagnostic = Diagnostic::alarm("corner-longer-than-move").at(word.place);
                let diagnostic = diagnostic.with("word", word.quote.clone());
                Err(self.finish(diagnostic.near(second.place(), "next-block")))
            }
        }
    }

    fn say_at_corner(&mut self, key: &'static str, word: &CornerWord) {
        if !self.already_said(key, word.place.line) {
            self.say(Diagnostic::warning(key).at(word.place).with("word", word.quote.clone()));
        }
    }

    /// The rules of the right-angled corner about the line behind it.
    fn check_perpendicular(&self, first: &Element, word: &CornerWord, second: &Element) -> Result<(), Alarm> {
        let refuse = |key| {
            let diagnostic = Diagnostic::alarm(key).at(word.place).with("word", word.quote.clone());
            Err(self.finish(diagnostic.near(second.place(), "next-block")))
        };
        let Some(axis) = Axis::of(first) else { return refuse("taper-in-corner-block") };
        let next = axis.other();
        let names_next = match next {
            Axis::X => second.names.0,
            Axis::Z => second.names.1,
        };
        if second.shape != Shape::Line
            || !axis.way(second.from, second.to).is_zero()
            || (!names_next && second.angle.is_none())
        {
            return refuse("no-perpendicular-after-corner");
        }
        let ahead = next.way(second.from, second.to);
        if ahead.signum() != word.size.signum() || ahead.abs() < word.size.abs() {
            return refuse("bad-move-after-corner");
        }
        Ok(())
    }
}
