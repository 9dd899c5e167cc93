//! The path of a round nose that rolls along one side of a path of lines and arcs.
//!
//! At each corner of the path stands a [`Joint`]: the vectors from the corner to the nose centre, in the order in which
//! the centre passes them. The first ends the element before the corner, the last begins the one behind it; between
//! them the centre goes straight. Inside corners have one vector, to the crossing of the shifted elements. Outside
//! corners have the crossing of the shifted lines (of the tangents, where there is an arc), and corners sharper than a
//! right angle are cut off by a straight way that passes them at the radius.
//!
//! An arc whose end does not lie on its circle is taken for the circle about its centre through that end.

use crate::track::Track;
use crate::vector::Vector;
use crate::{Bend, Point, Segment};

/// The side of the path that the nose is on, seen in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// 1 to the left, −1 to the right.
    fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The other side.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// A nose beside a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// On which side.
    pub side: Side,
    /// Its radius, zero or more, mm.
    pub radius_mm: f64,
}

/// How corners are passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// Elements that meet at less than this go on straight, or straight back.
    pub straight_rad: f64,
    /// Shifted elements that miss each other by no more than this still meet.
    pub gap_mm: f64,
    /// Of two vectors that differ by no more than this along both axes the second is left out.
    pub ignored_mm: f64,
    /// Outside corners are passed on an arc about the corner.
    pub round: bool,
}

/// How the nose comes to its path, and leaves it the same way backwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartUp {
    /// Straight to where it stands square to the element behind the corner.
    Direct,
    /// Round outside corners as inside the path.
    AlongPath,
    /// Square to both elements, one after the other.
    BothSquare,
}

/// Shifted elements do not meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointFault;

/// The vectors of a corner: one to four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    vectors: [Vector; 4],
    from: u8,
    to: u8,
    /// The way from the first to the last is an arc about the corner.
    pub is_round: bool,
}

impl Joint {
    /// A joint of one vector.
    pub fn single(vector: Vector) -> Self {
        Self::of(&[vector])
    }

    /// A joint of two vectors with a straight way between them.
    pub fn two(first: Vector, second: Vector) -> Self {
        Self::of(&[first, second])
    }

    fn of(vectors: &[Vector]) -> Self {
        let mut joint = Self { vectors: [Vector::default(); 4], from: 0, to: 0, is_round: false };
        for vector in vectors {
            joint.push(*vector);
        }
        joint
    }

    fn push(&mut self, vector: Vector) {
        self.vectors[usize::from(self.to)] = vector;
        self.to += 1;
    }

    /// All vectors, in order.
    pub fn vectors(&self) -> &[Vector] {
        &self.vectors[usize::from(self.from)..usize::from(self.to)]
    }

    /// Where the element before the corner ends.
    pub fn first(&self) -> Vector {
        self.vectors[usize::from(self.from)]
    }

    /// Where the element behind the corner begins.
    pub fn last(&self) -> Vector {
        self.vectors[usize::from(self.to) - 1]
    }

    /// Leaves the first vector out, unless it is the only one.
    pub fn drop_first(&mut self) -> bool {
        let drops = self.to - self.from > 1;
        self.from += u8::from(drops);
        self.is_round &= !drops;
        drops
    }

    /// Leaves the last vector out, unless it is the only one.
    pub fn drop_last(&mut self) -> bool {
        let drops = self.to - self.from > 1;
        self.to -= u8::from(drops);
        self.is_round &= !drops;
        drops
    }

    /// Leaves out each vector that is nearly the one before it.
    fn thinned(self, ignored_mm: f64) -> Self {
        let mut kept = Self { to: self.from, ..self };
        for vector in self.vectors() {
            let is_near = kept.to > kept.from && {
                let before = kept.last();
                (before.x - vector.x).abs() <= ignored_mm && (before.z - vector.z).abs() <= ignored_mm
            };
            if !is_near {
                kept.push(*vector);
            }
        }
        kept.is_round &= kept.to - kept.from > 1;
        kept
    }
}

/// How a path turns at a corner.
enum Turn {
    Straight,
    Inside,
    /// The angle on the side of the work is a right one or more.
    Obtuse,
    Acute,
}

/// A corner: the directions of travel and the vectors square to them.
struct Corner {
    inward: Vector,
    outward: Vector,
    before: Vector,
    behind: Vector,
    turn: Turn,
}

impl Offset {
    fn reach(self) -> f64 {
        self.side.sign() * self.radius_mm
    }

    fn square_to(self, direction: Vector) -> Vector {
        direction.left().times(self.reach())
    }

    /// The vector square to an element at its start; nothing for an element without length.
    pub fn at_start(self, segment: &Segment) -> Vector {
        segment.tangent(segment.start).map_or(Vector::default(), |direction| self.square_to(direction))
    }

    /// The vector square to an element at its end.
    pub fn at_end(self, segment: &Segment) -> Vector {
        segment.tangent(segment.end).map_or(Vector::default(), |direction| self.square_to(direction))
    }

    /// Whether the nose is larger than the inside of an arc.
    pub fn is_too_large_for(self, segment: &Segment, slack_mm: f64) -> bool {
        [segment.start, segment.end].into_iter().any(|at| {
            matches!(Track::through(segment, at, self.reach()), Some(Track::Round { radius, .. }) if radius < -slack_mm)
        })
    }

    fn corner(self, before: &Segment, behind: &Segment, straight_rad: f64) -> Option<Corner> {
        let (inward, outward) = (before.tangent(before.end)?, behind.tangent(behind.start)?);
        let (cross, dot) = (inward.cross(outward) * self.side.sign(), inward.dot(outward));
        let turn = if cross.abs() <= libm::sin(straight_rad) {
            // Straight back: round the end of a thin wall.
            if dot > 0.0 { Turn::Straight } else { Turn::Acute }
        } else if cross > 0.0 {
            Turn::Inside
        } else if dot > -1e-9 {
            Turn::Obtuse
        } else {
            Turn::Acute
        };
        Some(Corner {
            inward,
            outward,
            before: self.square_to(inward),
            behind: self.square_to(outward),
            turn,
        })
    }

    /// The joint at the corner between two elements.
    ///
    /// # Errors
    /// [`JointFault`] when the shifted elements of an inside corner do not meet.
    pub fn joint(self, before: &Segment, behind: &Segment, rules: &Joints) -> Result<Joint, JointFault> {
        let Some(corner) = self.corner(before, behind, rules.straight_rad) else {
            return Ok(Joint::single(self.at_end(before)));
        };
        let joint = match corner.turn {
            Turn::Straight => Joint::single(self.mitre(&corner)),
            Turn::Inside => Joint::single(self.crossing(before, behind, &corner, rules.gap_mm)?),
            Turn::Obtuse | Turn::Acute if rules.round => {
                Joint { is_round: true, ..Joint::of(&[corner.before, corner.behind]) }
            }
            Turn::Obtuse | Turn::Acute => {
                let mut joint = Joint::of(&[]);
                if before.bend.is_some() {
                    joint.push(corner.before);
                }
                self.push_outside(&mut joint, &corner);
                if behind.bend.is_some() {
                    joint.push(corner.behind);
                }
                joint
            }
        };
        Ok(joint.thinned(rules.ignored_mm))
    }

    /// The joint between the straight way to the path and its first element.
    pub fn start_joint(self, way: &Segment, first: &Segment, start_up: StartUp, rules: &Joints) -> Joint {
        let Some(corner) = self.corner(way, first, rules.straight_rad) else {
            return Joint::single(self.at_start(first));
        };
        let joint = match (start_up, &corner.turn) {
            (StartUp::BothSquare, _) => Joint::of(&[corner.before, corner.behind]),
            (StartUp::AlongPath, Turn::Obtuse | Turn::Acute) => {
                let mut joint = Joint::of(&[]);
                self.push_outside(&mut joint, &corner);
                if first.bend.is_some() || matches!(corner.turn, Turn::Acute) {
                    joint.push(corner.behind);
                }
                joint
            }
            _ => Joint::single(corner.behind),
        };
        joint.thinned(rules.ignored_mm)
    }

    /// The joint between the last element of the path and the straight way off it.
    pub fn end_joint(self, last: &Segment, way: &Segment, start_up: StartUp, rules: &Joints) -> Joint {
        let Some(corner) = self.corner(last, way, rules.straight_rad) else {
            return Joint::single(self.at_end(last));
        };
        let joint = match (start_up, &corner.turn) {
            (StartUp::BothSquare, _) => Joint::of(&[corner.before, corner.behind]),
            (StartUp::AlongPath, Turn::Obtuse | Turn::Acute) => {
                let mut joint = Joint::of(&[]);
                if last.bend.is_some() || matches!(corner.turn, Turn::Acute) {
                    joint.push(corner.before);
                }
                self.push_outside(&mut joint, &corner);
                joint
            }
            _ => Joint::single(corner.before),
        };
        joint.thinned(rules.ignored_mm)
    }

    /// The vector to where the last element meets a wall that leaves its end in a direction, whichever side of it
    /// the work is on; square to the element where they do not meet.
    pub fn wall_joint(self, last: &Segment, wall: Vector, rules: &Joints) -> Joint {
        let way = Segment { start: last.end, end: wall.from(last.end), bend: None };
        let square = self.at_end(last);
        let vector = self.corner(last, &way, rules.straight_rad).map_or(square, |corner| match corner.turn {
            Turn::Straight => self.mitre(&corner),
            _ => self.crossing(last, &way, &corner, rules.gap_mm).unwrap_or(square),
        });
        Joint::single(vector)
    }

    /// The joint where the nose changes from this side to another.
    pub fn side_change(self, before: &Segment, new: Self, behind: &Segment) -> Joint {
        Joint::of(&[self.at_end(before), new.at_start(behind)])
    }

    fn push_outside(self, joint: &mut Joint, corner: &Corner) {
        match corner.turn {
            Turn::Acute => {
                joint.push(corner.before.plus(corner.inward.times(self.radius_mm)));
                joint.push(corner.behind.plus(corner.outward.times(-self.radius_mm)));
            }
            _ => joint.push(self.mitre(corner)),
        }
    }

    /// To the crossing of the shifted tangents.
    fn mitre(self, corner: &Corner) -> Vector {
        corner.before.plus(corner.behind).times(1.0 / (1.0 + corner.inward.dot(corner.outward)))
    }

    /// To the crossing of the shifted elements that the corner itself becomes as the nose grows.
    fn crossing(
        self,
        before: &Segment,
        behind: &Segment,
        corner: &Corner,
        gap_mm: f64,
    ) -> Result<Vector, JointFault> {
        if before.bend.is_none() && behind.bend.is_none() {
            return Ok(self.mitre(corner));
        }
        let at = before.end;
        let one = Track::through(before, at, self.reach()).ok_or(JointFault)?;
        let other = Track::through(behind, behind.start, self.reach()).ok_or(JointFault)?;
        // Along a line, or across the line between two centres: on the same side as the corner.
        let (middle, axis) = match (&one, &other) {
            (Track::Straight { along, .. }, Track::Round { centre, .. })
            | (Track::Round { centre, .. }, Track::Straight { along, .. }) => (*centre, *along),
            (Track::Round { centre, .. }, Track::Round { centre: other, .. }) => {
                (*centre, Vector::between(*centre, *other).left())
            }
            (Track::Straight { .. }, Track::Straight { .. }) => return Ok(self.mitre(corner)),
        };
        let branch = |point: Point| Vector::between(middle, point).dot(axis);
        let side = branch(at);
        let met = one.crossings(&other);
        let fits = met.into_iter().flatten().filter(|point| branch(*point) * side >= 0.0);
        let found = fits.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        let found = found.or_else(|| one.nearly_meets(&other, gap_mm));
        found.map(|point| Vector::between(at, point)).ok_or(JointFault)
    }
}

impl Segment {
    /// The angle about the centre between the start and the end of an arc, each moved by a vector; nothing when the
    /// way between them would lead backwards.
    fn shifted_sweep(&self, from: Vector, to: Vector) -> Option<f64> {
        let bend = self.bend?;
        let programmed = self.sweep(bend);
        let turned = self.travelled(bend, from.from(self.start), to.from(self.end));
        let is_closed = turned == 0.0 && programmed > 1.5 * std::f64::consts::PI;
        let turned = if is_closed { std::f64::consts::TAU } else { turned };
        (turned - programmed <= std::f64::consts::PI).then_some(turned)
    }

    /// How far a nose centre runs beside an arc, from its start to its end, each moved by a vector, mm; nothing when
    /// it would run backwards.
    pub fn shifted_way_mm(&self, from: Vector, to: Vector) -> f64 {
        let radius_mm = self.bend.map_or(0.0, |bend| bend.centre.distance(from.from(self.start)));
        self.shifted_sweep(from, to).map_or(0.0, |turned| turned * radius_mm)
    }

    /// Whether the nose centre runs against an element between two vectors: by its direction when `by_direction`,
    /// and in arcs by the angle between start and end.
    pub fn runs_back(&self, from: Vector, to: Vector, by_direction: bool) -> bool {
        /// The rounding of the numbers.
        const NOTHING_MM: f64 = 1e-9;
        if self.bend.is_some() {
            return self.shifted_sweep(from, to).is_none();
        }
        let way = Vector::between(self.start, self.end);
        let shifted = Vector::between(from.from(self.start), to.from(self.end));
        by_direction && shifted.dot(way) < -NOTHING_MM * way.length()
    }

    /// The element somewhere else.
    #[must_use]
    pub fn moved(&self, way: Vector) -> Self {
        let bend = self.bend.map(|bend| Bend { centre: way.from(bend.centre), ..bend });
        Self { start: way.from(self.start), end: way.from(self.end), bend }
    }
}
