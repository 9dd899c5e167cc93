//! A move of the compensated contour, and how it is given out.

use turnwright_canon::{Action, Command, Origin, Shape, Turn};
use turnwright_diagnostics::Place;
use turnwright_geometry::{Bend, Joint, Offset, Point, Segment, Side, Vector};
use turnwright_units::{Displacement, Position, WorkTip};

use super::{Compensation, Nose};
use crate::machine::{BlockPlace, Core};
use crate::plane::{between_ends, place, point};
use crate::report::Alarm;

/// What part a move plays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// It leads onto the path.
    Start,
    /// It is part of the path.
    Contour,
    /// It leads off the path.
    End,
    /// It leads off the path, which goes on later.
    LettingGo,
}

/// A move of the contour.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) role: Role,
    /// Where it runs as programmed.
    pub(super) segment: Segment,
    pub(super) action: Action,
    /// The side that the program asked for.
    pub(super) asked: Side,
    /// The nose that acts at its end.
    pub(super) nose: Nose,
    /// It runs backwards without an alarm.
    pub(super) is_muted: bool,
    pub(super) origin: Origin,
    pub(super) at: BlockPlace,
}

impl Element {
    /// The nose beside the move.
    pub(super) fn offset(&self) -> Offset {
        let side = if self.nose.radius.signum() < 0 { self.asked.other() } else { self.asked };
        Offset { side, radius_mm: self.nose.radius.abs().to_mm() }
    }

    /// The place of its block.
    pub(super) fn place(&self) -> Place {
        self.at.span(self.at.first_byte, self.at.last_byte)
    }
}

/// Where a move runs as programmed.
pub(super) fn segment(from: Position<WorkTip>, to: Position<WorkTip>, action: &Action) -> Segment {
    let bend = match action {
        Action::Feed { shape: Shape::Arc { turn, centre }, .. } => {
            Some(Bend { centre: point(*centre), clockwise: *turn == Turn::Clockwise })
        }
        _ => None,
    };
    Segment { start: point(from), end: point(to), bend }
}

/// Sends a move somewhere else.
pub(super) fn move_end(action: &mut Action, end: Position<WorkTip>) {
    if let Action::Rapid { to, .. } | Action::Feed { to, .. } | Action::Thread { to, .. } = action {
        *to = end;
    }
}

/// From the nose centre to the imaginary tip.
pub(super) fn to_tip(nose: Nose) -> Vector {
    vector_of(nose.to_tip())
}

pub(super) fn vector_of(way: Displacement<WorkTip>) -> Vector {
    Vector { x: way.x.to_mm(), z: way.z.to_mm() }
}

impl Core {
    /// Gives out a move: the ways between the vectors of the joint at its start, which belong to it, and itself.
    pub(super) fn give_element(
        &mut self,
        path: &mut Compensation,
        element: &Element,
        start: Option<Joint>,
        end: Option<&Joint>,
        is_cut_short: bool,
    ) -> Result<(), Alarm> {
        if let Some(joint) = start {
            let corner = element.segment.start;
            for vector in &joint.vectors()[1..] {
                let to = self.snapped(vector.plus(to_tip(path.nose)).from(corner))?;
                let shape = if joint.is_round { self.round(path, element, corner, to) } else { Shape::Line };
                self.give_line(path, element, to, shape, path.nose)?;
            }
        }
        let Some(programmed) = element.action.end_point() else { return Ok(()) };
        // Beside an arc the nose can only end square to it; what leads off it is another way.
        let square = element.offset().at_end(&element.segment);
        let until = match end {
            Some(joint) => Some(joint.first()),
            None => element.segment.bend.map(|_| square),
        };
        let to = match until {
            Some(until) => self.snapped(until.plus(to_tip(element.nose)).from(element.segment.end))?,
            None => programmed,
        };
        let shape = match (element.segment.bend, until) {
            (Some(bend), Some(until)) if !is_cut_short => {
                let from = start.map_or(Vector::default(), |joint| joint.last());
                let way_mm = element.segment.shifted_way_mm(from, until);
                self.shifted_arc(path.stands, to, bend, to_tip(element.nose), way_mm)
            }
            _ => Shape::Line,
        };
        self.give_line(path, element, to, shape, element.nose)?;
        if end.is_none() {
            self.give_line(path, element, programmed, Shape::Line, element.nose)?;
        }
        path.nose = element.nose;
        Ok(())
    }

    /// Moves the nose square to the start of a move, without a joint.
    pub(super) fn give_shift(
        &mut self,
        path: &mut Compensation,
        element: &Element,
        square: Vector,
    ) -> Result<(), Alarm> {
        let to = self.snapped(square.plus(to_tip(element.nose)).from(element.segment.start))?;
        path.nose = element.nose;
        self.give_line(path, element, to, Shape::Line, element.nose)
    }

    /// An arc beside an arc; a line where it is shorter than its ends are rounded.
    fn shifted_arc(
        &self,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        bend: Bend,
        to_tip: Vector,
        way_mm: f64,
    ) -> Shape {
        let increment_mm = self.modal.increment(&self.settings).to_mm();
        if way_mm <= 2.0 * increment_mm {
            return Shape::Line;
        }
        let centre = to_tip.from(bend.centre);
        let off = (centre.distance(point(from)) - centre.distance(point(to))).abs();
        let centre = if off <= 2.0 * increment_mm {
            between_ends(centre, point(from), point(to), increment_mm)
        } else {
            centre
        };
        place(centre)
            .map_or(Shape::Line, |centre| Shape::Arc { turn: Turn::clockwise_if(bend.clockwise), centre })
    }

    /// The arc about a corner that ends at a place.
    fn round(&self, path: &Compensation, element: &Element, corner: Point, to: Position<WorkTip>) -> Shape {
        if matches!(element.action, Action::Rapid { .. }) {
            return Shape::Line;
        }
        let centre = to_tip(path.nose).from(corner);
        let (from, until) = (Vector::between(centre, point(path.stands)), Vector::between(centre, point(to)));
        let bend = Bend { centre, clockwise: from.cross(until) < 0.0 };
        self.shifted_arc(path.stands, to, bend, Vector::default(), point(path.stands).distance(point(to)))
    }

    /// A move of the kind that the element is, to a place.
    fn give_line(
        &mut self,
        path: &mut Compensation,
        element: &Element,
        to: Position<WorkTip>,
        shape: Shape,
        nose: Nose,
    ) -> Result<(), Alarm> {
        let is_same = path.stands == to && shape == Shape::Line && element.action.others().is_none();
        if is_same {
            return Ok(());
        }
        let mut action = element.action.clone();
        move_end(&mut action, to);
        if let Action::Feed { shape: old, .. } = &mut action {
            *old = shape;
        }
        let from = std::mem::replace(&mut path.stands, to);
        self.give(from, action, element.origin, Some(nose))
    }

    /// Gives a move out as the last thing before the machine.
    pub(crate) fn give(
        &mut self,
        from: Position<WorkTip>,
        action: Action,
        origin: Origin,
        nose: Option<Nose>,
    ) -> Result<(), Alarm> {
        if self.is_capturing()
            && let Some(to) = action.end_point()
        {
            // The contour runs ahead of what the figure is made of.
            let tip = self.tip;
            let captured = self.capture_move(to, &action);
            self.tip = tip;
            return captured;
        }
        let centre = nose.zip(action.end_point()).map(|(nose, tip)| nose.centre(tip));
        let action = self.looked_at(from, action)?;
        let nose = centre.map(|centre| {
            // Seen as any place of the section.
            let seen = self.in_work(Position::new(centre.x, centre.z));
            Box::new(Position::new(seen.x, seen.z))
        });
        self.out.push_back(Command { action, origin, nose });
        Ok(())
    }
}

/// The vector to the nose centre while the tip stands at a place.
pub(super) fn vector(stands: Point, corner: Point, nose: Nose) -> Vector {
    Vector::between(corner, stands).plus(to_tip(nose).times(-1.0))
}
