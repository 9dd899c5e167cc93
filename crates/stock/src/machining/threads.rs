//! Threads: where the insert is each time the spindle passes zero, and what to remember of them.

use turnwright_canon::SpindleState;
use turnwright_geometry::{Bounds, Point, Segment};
use turnwright_units::Angle;

/// A thread with more turns in one move is cut as a plain way.
pub const TURNS_MAX: u32 = 20_000;

/// The same on a face: all its turns lie beside each other at one Z, and every cut would look at each of them. A scroll has a
/// dozen turns; hundreds come of a lost decimal point.
pub const FACE_TURNS_MAX: u32 = 100;

/// No more threads are remembered.
pub const THREADS_MAX: usize = 200;

/// How far the spindle has turned since it last stood at zero, in turns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Phase(f64);

/// Which way a thread winds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThreadHand {
    /// It tightens clockwise.
    Right,
    /// It tightens counter-clockwise.
    Left,
    /// The spindle stood, or the thread lies on a face.
    #[default]
    Unknown,
}

impl ThreadHand {
    /// The hand that follows from the way of the spindle and the way along Z. Seen from behind the chuck with the
    /// spindle turning clockwise, the tool goes round the work counter-clockwise; if it comes nearer as it does so, its
    /// trace is a right-hand thread.
    pub(super) fn of(spindle: SpindleState, way: &Segment) -> Self {
        let (dz, dx) = (way.end.z - way.start.z, way.end.x - way.start.x);
        if dx.abs() > dz.abs() {
            return Self::Unknown;
        }
        match (spindle, dz < 0.0) {
            (SpindleState::Stop, _) => Self::Unknown,
            (SpindleState::Clockwise, true) | (SpindleState::CounterClockwise, false) => Self::Right,
            (SpindleState::Clockwise, false) | (SpindleState::CounterClockwise, true) => Self::Left,
        }
    }
}

/// A thread in the section.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadMark {
    /// The tool that cut it.
    pub tool: u32,
    /// Its lead at the start, mm.
    pub lead_mm: f64,
    /// Which way it winds.
    pub hand: ThreadHand,
    /// From one programmed end, mm.
    pub from: Point,
    /// To the other; of the deepest pass.
    pub to: Point,
    /// The rectangle round all that was cut.
    pub bounds: Bounds,
    /// The start angles, each once: as many as the thread has starts; no more than 60 are kept.
    pub starts: Vec<Angle>,
    /// How many moves cut it.
    pub passes: u32,
}

impl Phase {
    pub(super) fn starting_at(angle: Angle) -> Self {
        Self((angle.to_degrees() / 360.0).rem_euclid(1.0))
    }

    /// The same so many turns further on.
    pub(super) fn further(self, turns: f64) -> Self {
        Self((self.0 + turns).rem_euclid(1.0))
    }

    /// Where the tool is on a way whenever the spindle passes zero; `None` when that is too often. The lead is that
    /// along the longer axis, and changes evenly with the turns from the first to the second.
    pub(super) fn turns(
        &mut self,
        way: &Segment,
        lead_mm: (f64, f64),
    ) -> Option<impl Iterator<Item = Point> + use<>> {
        let (dz, dx) = (way.end.z - way.start.z, way.end.x - way.start.x);
        let length = dz.abs().max(dx.abs());
        let turns = 2.0 * length / (lead_mm.0 + lead_mm.1);
        let turns_max = if dx.abs() > dz.abs() { FACE_TURNS_MAX } else { TURNS_MAX };
        if !(turns > 0.0 && turns <= f64::from(turns_max)) {
            return None;
        }
        let first = if self.0 == 0.0 { 0.0 } else { 1.0 - self.0 };
        self.0 = (self.0 + turns).rem_euclid(1.0);
        let count = if turns < first { 0 } else { (turns - first) as u32 + 1 };
        let way = *way;
        Some((0..count).map(move |index| {
            let turned = first + f64::from(index);
            let along = turned * (lead_mm.0 + (lead_mm.1 - lead_mm.0) * turned / (2.0 * turns));
            place(&way, (along / length).clamp(0.0, 1.0))
        }))
    }
}

/// The place at a share of the longer axis.
fn place(way: &Segment, share: f64) -> Point {
    let (dz, dx) = (way.end.z - way.start.z, way.end.x - way.start.x);
    let line = Point { x: way.start.x + dx * share, z: way.start.z + dz * share };
    let Some(bend) = way.bend else { return line };
    let centre = bend.centre;
    let radius = centre.distance(way.start);
    // Of the two places of the circle, the one on the side of both ends.
    let other = |along: f64, start: f64, end: f64, centre: f64| {
        let half = ((radius - along) * (radius + along)).max(0.0).sqrt();
        if start + end >= 2.0 * centre { centre + half } else { centre - half }
    };
    if dz.abs() >= dx.abs() {
        Point { x: other(line.z - centre.z, way.start.x, way.end.x, centre.x), ..line }
    } else {
        Point { z: other(line.x - centre.x, way.start.z, way.end.z, centre.z), ..line }
    }
}

/// What all passes of one thread have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreadCut {
    pub(super) tool: u32,
    pub(super) lead_mm: f64,
    pub(super) hand: ThreadHand,
}

/// The threads of a part.
#[derive(Clone, Debug, Default)]
pub(super) struct ThreadMarks(Vec<ThreadMark>);

impl ThreadMarks {
    pub(super) fn marks(&self) -> &[ThreadMark] {
        &self.0
    }

    /// A pass that cut something: of a thread that is known, or of a new one.
    pub(super) fn note(&mut self, cut: ThreadCut, start: Angle, way: &Segment, bounds: Bounds) {
        let ThreadCut { tool, lead_mm, hand } = cut;
        const STARTS_MAX: usize = 60;
        let is_same = |mark: &&mut ThreadMark| {
            (mark.tool, mark.lead_mm, mark.hand) == (tool, lead_mm, hand)
                && mark.bounds.meets(&bounds, lead_mm)
        };
        if let Some(mark) = self.0.iter_mut().find(is_same) {
            mark.bounds = mark.bounds.with(bounds.min).with(bounds.max);
            (mark.from, mark.to) = (way.start, way.end);
            mark.passes = mark.passes.saturating_add(1);
            if !mark.starts.contains(&start) && mark.starts.len() < STARTS_MAX {
                mark.starts.push(start);
            }
        } else if self.0.len() < THREADS_MAX {
            let (from, to) = (way.start, way.end);
            self.0.push(ThreadMark { tool, lead_mm, hand, from, to, bounds, starts: vec![start], passes: 1 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(to_x: f64, to_z: f64) -> Segment {
        Segment { start: Point::new(10., 3.), end: Point::new(to_x, to_z), bend: None }
    }

    fn places(phase: &mut Phase, way: &Segment, lead_mm: (f64, f64)) -> Vec<f64> {
        phase.turns(way, lead_mm).expect("a thread").map(|place| (place.z * 1e9).round() / 1e9).collect()
    }

    #[test]
    fn more_turns_are_followed_along_the_axis_than_on_a_face() {
        let is_followed = |way: Segment| Phase::default().turns(&way, (2., 2.)).is_some();
        assert!(is_followed(line(10. + 200., 2.)));
        assert!(!is_followed(line(10. + 204., 2.)));
        assert!(is_followed(line(9., 3. - 204.)));
    }

    #[test]
    fn once_a_turn_in_phase_and_on_through_a_chain() {
        let way = line(10., -3.0);
        assert_eq!(places(&mut Phase::default(), &way, (2., 2.)), [3., 1., -1., -3.]);
        // Started at 90 degrees, zero comes three quarters of a turn later.
        let mut phase = Phase::starting_at(Angle::from_millidegrees(90_000));
        assert_eq!(places(&mut phase, &way, (2., 2.)), [1.5, -0.5, -2.5]);
        // A quarter turn is left over, and the next move goes on with it.
        let next = Segment { start: way.end, end: Point::new(10., -7.), bend: None };
        assert_eq!(places(&mut phase, &next, (2., 2.)), [-4.5, -6.5]);
    }

    #[test]
    fn a_lead_that_grows_grows_with_the_turns() {
        // 1 to 3 mm over 6 mm: three turns, of 1 1/3, 2 and 2 2/3 mm.
        let found = places(&mut Phase::default(), &line(10., -3.), (1., 3.));
        let expected = [3., 3. - 4. / 3., 3. - 10. / 3., -3.];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{found:?}");
    }

    #[test]
    fn tapers_and_faces_follow_the_longer_axis() {
        let taper =
            Phase::default().turns(&line(11., -3.), (3., 3.)).expect("a thread").last().expect("places");
        assert_eq!(taper, Point::new(11., -3.));
        let scroll: Vec<Point> = Phase::default().turns(&line(4., 3.), (2., 2.)).expect("a scroll").collect();
        assert_eq!(scroll.last(), Some(&Point::new(4., 3.)));
        assert_eq!(scroll.len(), 4);
    }

    #[test]
    fn too_fine_a_lead_is_no_thread() {
        assert!(Phase::default().turns(&line(10., -30.), (1e-6, 1e-6)).is_none());
        assert!(Phase::default().turns(&line(10., -30.), (0., 0.)).is_none());
    }
}
