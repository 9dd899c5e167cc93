//! The path of the tool tip, kept so that it can be drawn.
//!
//! In: commands in order of execution, each with its time. Out: [`Segment`]s (straight or arc) grouped into
//! [`Move`]s (one a command), and the space they take.
//!
//! Invariants: memory is bounded by [`PATH_SEGMENTS_MAX`]; what lies beyond is counted, and the extents and
//! times still see it. Coordinates are millimetres, X as a radius, in `f32`: half a micrometre at eight
//! metres, far below a pixel. Deliberately not here: pixels, colours, and any number that a check would use.

use turnwright_canon::{Action, Command, Curve, CycleOrigin, Dwell, RapidPath, SectionPlace, Shape, Turn};
use turnwright_geometry as geometry;
use turnwright_units::{Feed, Position, WorkTip};

/// Segments kept; about 200 MB when all are used.
pub const PATH_SEGMENTS_MAX: usize = 2_000_000;

/// How near the arcs that are drawn for an ellipse or a parabola stay to it, millimetres.
const CURVE_TOLERANCE_MM: f64 = 0.002;

/// A place in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Distance from the spindle axis, millimetres, negative beyond it.
    pub radius_mm: f32,
    /// Along the spindle axis, millimetres.
    pub z_mm: f32,
}

/// What a segment does to the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SegmentKind {
    /// Positioning.
    Rapid,
    /// Cutting.
    Feed,
    /// Cutting in step with the spindle.
    Thread,
}

/// The circle of a segment that is not straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bow {
    /// Centre of the circle.
    pub centre: Point,
    /// Angle from start to end seen with Z to the right and X up, counter-clockwise positive.
    pub sweep_rad: f32,
}

/// One stroke of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it starts.
    pub start: Point,
    /// Where it ends.
    pub end: Point,
    /// The circle, unless it is straight.
    pub bow: Option<Bow>,
    /// What it does.
    pub kind: SegmentKind,
}

/// The advance of a cutting move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance {
    /// Millimetres per spindle revolution.
    MmPerRevolution(f32),
    /// Millimetres per minute.
    MmPerMinute(f32),
    /// Lead of a thread, millimetres.
    LeadMm(f32),
}

/// One command that moved the tool: one segment, or two for a rapid whose axes do not end together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Its first segment; the next move's first segment ends it.
    pub segment_first: u32,
    /// Number of the command from 0, commands that are no moves counted too.
    pub command: u32,
    /// Which program text.
    pub source: u32,
    /// Line of the block, from 1.
    pub line: u32,
    /// Line of the figure block that shaped it, when that is another one.
    pub figure_line: Option<std::num::NonZeroU32>,
    /// The cycle, when one made it.
    pub cycle: Option<CycleOrigin>,
    /// Turret station in use, 0 before the first call.
    pub tool: u32,
    /// How fast it cuts; `None` for a rapid.
    pub advance: Option<Advance>,
    /// Time from the start of the program to the end of this move.
    pub elapsed_s: f64,
    /// How long the move itself takes.
    pub seconds: f32,
}

/// A rectangle in the plane of the path, millimetres, X as a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extents {
    /// Least distance from the axis.
    pub radius_min_mm: f64,
    /// Greatest distance from the axis.
    pub radius_max_mm: f64,
    /// Nearest to the chuck.
    pub z_min_mm: f64,
    /// Farthest from the chuck.
    pub z_max_mm: f64,
}

impl Extents {
    fn at(radius_mm: f64, z_mm: f64) -> Self {
        Self { radius_min_mm: radius_mm, radius_max_mm: radius_mm, z_min_mm: z_mm, z_max_mm: z_mm }
    }

    fn include(&mut self, radius_mm: f64, z_mm: f64) {
        self.radius_min_mm = self.radius_min_mm.min(radius_mm);
        self.radius_max_mm = self.radius_max_mm.max(radius_mm);
        self.z_min_mm = self.z_min_mm.min(z_mm);
        self.z_max_mm = self.z_max_mm.max(z_mm);
    }

    fn join(&mut self, other: Self) {
        self.include(other.radius_min_mm, other.z_min_mm);
        self.include(other.radius_max_mm, other.z_max_mm);
    }
}

/// Keeps the moves of a run for the pictures.
#[derive(Clone, Debug)]
pub struct PathRecorder {
    at: Position<WorkTip>,
    section: SectionPlace,
    rapid_x_mm_per_min: f64,
    rapid_z_mm_per_min: f64,
    segments: Vec<Segment>,
    segments_max: usize,
    segments_dropped: u64,
    moves: Vec<Move>,
    commands: u32,
    tool: u32,
    elapsed_s: f64,
    seconds: f64,
    dwell_s: f64,
    cutting_extents: Option<Extents>,
    extents: Option<Extents>,
}

impl PathRecorder {
    /// An empty path that starts at `start`. The rates, of X as a radius, shape the rapids whose axes move
    /// each at its own; a rate that is not above zero draws them straight.
    pub fn new(start: Position<WorkTip>, rapid_x_mm_per_min: f64, rapid_z_mm_per_min: f64) -> Self {
        Self {
            at: start,
            section: SectionPlace::default(),
            rapid_x_mm_per_min,
            rapid_z_mm_per_min,
            segments: Vec::new(),
            segments_max: PATH_SEGMENTS_MAX,
            segments_dropped: 0,
            moves: Vec::new(),
            commands: 0,
            tool: 0,
            elapsed_s: 0.0,
            seconds: 0.0,
            dwell_s: 0.0,
            cutting_extents: None,
            extents: None,
        }
    }

    /// The same path with a smaller limit than [`PATH_SEGMENTS_MAX`].
    pub fn with_segments_max(mut self, segments_max: usize) -> Self {
        self.segments_max = segments_max.min(PATH_SEGMENTS_MAX);
        self
    }

    /// The next command, which takes `seconds`.
    pub fn add(&mut self, command: &Command, seconds: f64) {
        let seconds = if seconds.is_finite() { seconds.max(0.0) } else { 0.0 };
        self.elapsed_s += seconds;
        self.seconds = seconds;
        let end = self.section.end_of(&command.action).unwrap_or(self.at);
        match &command.action {
            Action::Rapid { path, .. } => self.add_rapid(command, end, *path),
            Action::Feed { shape, feed, .. } => {
                let mm = feed.length().to_mm() as f32;
                let advance = match feed {
                    Feed::PerRevolution(_) => Advance::MmPerRevolution(mm),
                    Feed::PerMinute(_) => Advance::MmPerMinute(mm),
                };
                self.add_cut(command, end, shape, SegmentKind::Feed, advance);
            }
            Action::Thread { shape, lead, .. } => {
                let advance = Advance::LeadMm(lead.0.to_mm() as f32);
                self.add_cut(command, end, shape, SegmentKind::Thread, advance);
            }
            Action::Relocate { to, .. } => self.at = *to,
            Action::Tool { tool, .. } => self.tool = *tool,
            Action::Dwell(Dwell::Time(_) | Dwell::Turns(_)) => self.dwell_s += seconds,
            Action::PathMode(_)
            | Action::Interpolation(_)
            | Action::Coupling(_)
            | Action::RigidTapping(_)
            | Action::SpindleWatch(_)
            | Action::PanelLock(_)
            | Action::Spindle { .. }
            | Action::Coolant(_)
            | Action::Auxiliary { .. }
            | Action::SecondAuxiliary { .. }
            | Action::Stop
            | Action::OptionalStop
            | Action::End
            | Action::Message(_)
            | Action::Output(_) => {}
        }
        self.commands = self.commands.saturating_add(1);
    }

    /// Everything kept, in order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The commands that moved the tool, in order.
    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// The segments of the move with this index, empty for an index that does not exist.
    pub fn segments_of(&self, move_index: usize) -> &[Segment] {
        let Some(first) = self.moves.get(move_index) else { return &[] };
        let end =
            self.moves.get(move_index + 1).map_or(self.segments.len(), |next| next.segment_first as usize);
        self.segments.get(first.segment_first as usize..end).unwrap_or(&[])
    }

    /// Segments that came after the limit was reached and are not kept.
    pub fn segments_dropped(&self) -> u64 {
        self.segments_dropped
    }

    /// Time of everything added.
    pub fn elapsed_s(&self) -> f64 {
        self.elapsed_s
    }

    /// Time of the dwells in it.
    pub fn dwell_s(&self) -> f64 {
        self.dwell_s
    }

    /// The space of the cutting moves, their starts and the bulge of arcs included.
    pub fn cutting_extents(&self) -> Option<Extents> {
        self.cutting_extents
    }

    /// The space of all moves.
    pub fn extents(&self) -> Option<Extents> {
        self.extents
    }

    fn add_cut(
        &mut self,
        command: &Command,
        to: Position<WorkTip>,
        shape: &Shape,
        kind: SegmentKind,
        advance: Advance,
    ) {
        let bow = match shape {
            // The picture is the section: an arc across it is seen from its edge.
            Shape::Line | Shape::SideArc { .. } => None,
            Shape::Arc { turn, centre } => bow_between(self.at, to, *centre, *turn),
            Shape::Curve(curve) => return self.add_curve(command, to, curve, kind, advance),
        };
        if to == self.at && bow.is_none() {
            return;
        }
        self.begin_move(command, Some(advance), 1);
        let segment = Segment { start: point(self.at), end: point(to), bow, kind };
        self.push(segment);
        self.at = to;
    }

    /// An ellipse or a parabola, drawn as arcs.
    #[cold]
    fn add_curve(
        &mut self,
        command: &Command,
        to: Position<WorkTip>,
        curve: &Curve,
        kind: SegmentKind,
        advance: Advance,
    ) {
        let drawn = |place: geometry::Point| Point { radius_mm: place.x as f32, z_mm: place.z as f32 };
        let path = curve.path(self.at, to);
        let arcs = path.arcs(CURVE_TOLERANCE_MM);
        self.begin_move(command, Some(advance), arcs.clone().count());
        let mut start = path.point_at(0.0);
        for geometry::CurveArc { end, bend } in arcs {
            let bow = bend.map(|geometry::Bend { centre, clockwise }| Bow {
                centre: drawn(centre),
                sweep_rad: geometry::sweep_rad(start, end, centre, clockwise) as f32,
            });
            self.push(Segment { start: drawn(start), end: drawn(end), bow, kind });
            start = end;
        }
        self.at = to;
    }

    fn add_rapid(&mut self, command: &Command, to: Position<WorkTip>, path: RapidPath) {
        if to == self.at {
            return;
        }
        let corner = match path {
            RapidPath::Straight => None,
            RapidPath::EachAxis | RapidPath::Home => self.corner(to),
        };
        let (start, end) = (point(self.at), point(to));
        self.begin_move(command, None, if corner.is_some() { 2 } else { 1 });
        let straight = |start, end| Segment { start, end, bow: None, kind: SegmentKind::Rapid };
        match corner {
            Some(corner) => {
                self.push(straight(start, corner));
                self.push(straight(corner, end));
            }
            None => self.push(straight(start, end)),
        }
        self.at = to;
    }

    /// Where the axis with the shorter time stops and the other goes on alone, when that is on the way.
    fn corner(&self, to: Position<WorkTip>) -> Option<Point> {
        let way = to - self.at;
        let (x_mm, z_mm) = (way.x.to_mm(), way.z.to_mm());
        let x_min = x_mm.abs() / self.rapid_x_mm_per_min;
        let z_min = z_mm.abs() / self.rapid_z_mm_per_min;
        let rates_are_rates = self.rapid_x_mm_per_min > 0.0 && self.rapid_z_mm_per_min > 0.0;
        let (shorter, longer) = (x_min.min(z_min), x_min.max(z_min));
        // Below a thousandth of the longer time the corner is not visible.
        if !rates_are_rates || shorter <= longer * 1e-3 || longer - shorter <= longer * 1e-3 {
            return None;
        }
        let radius_mm = self.at.x.to_mm() + x_mm * (shorter / x_min);
        let z_mm = self.at.z.to_mm() + z_mm * (shorter / z_min);
        Some(Point { radius_mm: radius_mm as f32, z_mm: z_mm as f32 })
    }

    /// Notes the move, unless its segments will not fit.
    fn begin_move(&mut self, command: &Command, advance: Option<Advance>, segments: usize) {
        if self.segments.len() + segments > self.segments_max {
            // From here on nothing more is kept, so that what is kept stays in one piece.
            self.segments_max = self.segments.len();
            return;
        }
        let origin = &command.origin;
        self.moves.push(Move {
            segment_first: self.segments.len() as u32,
            command: self.commands,
            source: origin.source,
            line: origin.line,
            figure_line: origin.figure_line.and_then(std::num::NonZeroU32::new),
            cycle: origin.cycle,
            tool: self.tool,
            advance,
            elapsed_s: self.elapsed_s,
            seconds: self.seconds as f32,
        });
    }

    fn push(&mut self, segment: Segment) {
        let space = space_of(&segment);
        match &mut self.extents {
            Some(extents) => extents.join(space),
            none => *none = Some(space),
        }
        if segment.kind != SegmentKind::Rapid {
            match &mut self.cutting_extents {
                Some(extents) => extents.join(space),
                none => *none = Some(space),
            }
        }
        if self.segments.len() < self.segments_max {
            self.segments.push(segment);
        } else {
            self.segments_dropped += 1;
        }
    }
}

fn point(position: Position<WorkTip>) -> Point {
    Point { radius_mm: position.x.to_mm() as f32, z_mm: position.z.to_mm() as f32 }
}

/// The circle of an arc; `None` for an arc without radius, which is drawn straight. Equal start and end mean
/// the full circle.
fn bow_between(
    start: Position<WorkTip>,
    end: Position<WorkTip>,
    centre: Position<WorkTip>,
    turn: Turn,
) -> Option<Bow> {
    use std::f64::consts::TAU;
    if start == centre || end == centre {
        return None;
    }
    let angle = |to: Position<WorkTip>| {
        let way = to - centre;
        way.x.to_mm().atan2(way.z.to_mm())
    };
    let counter_clockwise = if start == end { 0.0 } else { (angle(end) - angle(start)).rem_euclid(TAU) };
    let sweep_rad = match turn {
        Turn::CounterClockwise if start == end => TAU,
        Turn::CounterClockwise => counter_clockwise,
        Turn::Clockwise => counter_clockwise - TAU,
    };
    Some(Bow { centre: point(centre), sweep_rad: sweep_rad as f32 })
}

/// The rectangle around one segment, the bulge of an arc included.
fn space_of(segment: &Segment) -> Extents {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let Segment { start, end, bow, .. } = segment;
    let mut space = Extents::at(start.radius_mm.into(), start.z_mm.into());
    space.include(end.radius_mm.into(), end.z_mm.into());
    if let Some(bow) = bow {
        let (centre_radius_mm, centre_z_mm) = (f64::from(bow.centre.radius_mm), f64::from(bow.centre.z_mm));
        let x_mm = f64::from(start.radius_mm) - centre_radius_mm;
        let z_mm = f64::from(start.z_mm) - centre_z_mm;
        let (radius_mm, start_rad) = (x_mm.hypot(z_mm), x_mm.atan2(z_mm));
        let sweep_rad = f64::from(bow.sweep_rad);
        for quarter in 0..4 {
            // How far along the arc the quadrant's point lies, measured the way the arc turns.
            let to_quadrant = (f64::from(quarter) * FRAC_PI_2 - start_rad) * sweep_rad.signum();
            if to_quadrant.rem_euclid(TAU) <= sweep_rad.abs() {
                let (x, z) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarter as usize];
                space.include(centre_radius_mm + x * radius_mm, centre_z_mm + z * radius_mm);
            }
        }
    }
    space
}

#[cfg(test)]
mod tests {
    use super::*;
    use turnwright_canon::Origin;
    use turnwright_units::{FeedPerRevolution, Length, Radius};

    fn at(diameter_mm: i64, z_mm: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(diameter_mm * 500_000)), Length::from_mm(z_mm))
    }

    fn rapid(to: Position<WorkTip>, path: RapidPath) -> Command {
        Command::new(Action::Rapid { to, path, others: None }, Origin::line(1))
    }

    fn feed(to: Position<WorkTip>, shape: Shape) -> Command {
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(200_000)));
        Command::new(Action::Feed { to, shape, feed, others: None }, Origin::line(2))
    }

    fn recorder() -> PathRecorder {
        PathRecorder::new(at(100, 100), 5_000.0, 10_000.0)
    }

    #[test]
    fn in_polar_interpolation_the_picture_has_the_distance_from_the_spindle_axis() {
        use turnwright_canon::{Interpolation, OtherAxes};
        let at = |x: i32| Position::new(Radius(Length::from_mm(x)), Length::ZERO);
        let mut path = PathRecorder::new(at(3), 12_000.0, 16_000.0);
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_mm(1)));
        let polar = Interpolation::Polar { zero: turnwright_units::Angle::ZERO, is_below: false };
        let others = OtherAxes { v: Some(Length::from_mm(4)), ..OtherAxes::default() };
        let cut = Action::Feed { to: at(3), shape: Shape::Line, feed, others: Some(Box::new(others)) };
        for action in [Action::Interpolation(polar), cut] {
            path.add(&Command::new(action, Origin::line(1)), 1.0);
        }
        let [segment] = path.segments() else { panic!("one segment") };
        assert_eq!((segment.start.radius_mm, segment.end.radius_mm), (3.0, 5.0));
    }

    #[test]
    fn a_rapid_with_each_axis_at_its_own_rate_bends_where_the_shorter_ends() {
        let mut path = recorder();
        // X: 30 mm of radius at 5 m/min = 0.36 s; Z: 100 mm at 10 m/min = 0.6 s. Z has gone 60 mm at 0.36 s.
        path.add(&rapid(at(40, 0), RapidPath::EachAxis), 0.6);
        assert_eq!(path.moves().len(), 1);
        let [first, second] = path.segments_of(0) else { panic!("two segments") };
        assert_eq!(first.end, Point { radius_mm: 20.0, z_mm: 40.0 });
        assert_eq!(second.end, Point { radius_mm: 20.0, z_mm: 0.0 });
    }

    #[test]
    fn a_straight_rapid_and_one_along_an_axis_have_one_segment() {
        let mut path = recorder();
        path.add(&rapid(at(40, 0), RapidPath::Straight), 0.6);
        path.add(&rapid(at(40, 5), RapidPath::EachAxis), 0.6);
        assert_eq!(path.segments().len(), 2);
        assert_eq!(path.cutting_extents(), None);
    }

    #[test]
    fn the_bulge_of_an_arc_belongs_to_the_extents() {
        let mut path = PathRecorder::new(at(0, 0), 1.0, 1.0);
        // A ball of radius 20: from the face centre counter-clockwise over the top to the back.
        let shape = Shape::Arc { turn: Turn::CounterClockwise, centre: at(0, -20) };
        path.add(&feed(at(0, -40), shape), 1.0);
        let extents = path.cutting_extents().expect("a cut");
        assert!((extents.radius_max_mm - 20.0).abs() < 1e-4);
        assert!(extents.radius_min_mm.abs() < 1e-4);
        // Clockwise the bulge is on the other side of the axis.
        let mut path = PathRecorder::new(at(0, 0), 1.0, 1.0);
        let shape = Shape::Arc { turn: Turn::Clockwise, centre: at(0, -20) };
        path.add(&feed(at(0, -40), shape), 1.0);
        assert!((path.cutting_extents().expect("a cut").radius_min_mm + 20.0).abs() < 1e-4);
    }

    #[test]
    fn an_arc_back_to_its_start_is_the_full_circle() {
        for (turn, sign) in [(Turn::Clockwise, -1.0), (Turn::CounterClockwise, 1.0)] {
            let mut path = PathRecorder::new(at(20, 0), 1.0, 1.0);
            path.add(&feed(at(20, 0), Shape::Arc { turn, centre: at(10, 0) }), 1.0);
            let sweep = path.segments()[0].bow.expect("an arc").sweep_rad;
            assert!((sweep - sign * std::f32::consts::TAU).abs() < 1e-5, "{sweep}");
        }
    }

    #[test]
    fn an_ellipse_is_one_move_of_arcs_that_join() {
        let mut path = PathRecorder::new(at(0, 0), 1.0, 1.0);
        let (half_along, half_across) = (Length::from_mm(20), Length::from_mm(10));
        let tilt = turnwright_units::Angle::ZERO;
        let (turn, centre) = (Turn::CounterClockwise, at(0, -20));
        let ellipse = Curve::Ellipse { turn, centre, half_along, half_across, tilt };
        path.add(&feed(at(20, -20), Shape::Curve(Box::new(ellipse))), 1.0);
        let segments = path.segments_of(0);
        assert_eq!((path.moves().len(), segments.len()), (1, path.segments().len()));
        assert!((3..40).contains(&segments.len()), "{}", segments.len());
        assert!(segments.windows(2).all(|pair| pair[0].end == pair[1].start));
        assert!(segments.iter().all(|segment| segment.bow.is_some_and(|bow| bow.sweep_rad > 0.0)));
        assert_eq!(segments.last().expect("arcs").end, point(at(20, -20)));
    }

    #[test]
    fn beyond_the_limit_segments_are_counted_and_still_measured() {
        let mut path = recorder().with_segments_max(3);
        path.add(&rapid(at(40, 0), RapidPath::EachAxis), 0.5);
        path.add(&rapid(at(100, 90), RapidPath::EachAxis), 0.5);
        path.add(&feed(at(100, -70), Shape::Line), 0.5);
        assert_eq!((path.segments().len(), path.moves().len(), path.segments_dropped()), (2, 1, 3));
        assert_eq!(path.cutting_extents().expect("a cut").z_min_mm, -70.0);
        assert_eq!(path.elapsed_s(), 1.5);
    }

    #[test]
    fn moves_of_no_length_are_not_drawn() {
        let mut path = recorder();
        path.add(&feed(at(100, 100), Shape::Line), 0.0);
        path.add(&rapid(at(100, 100), RapidPath::Straight), f64::NAN);
        assert!(path.moves().is_empty() && path.extents().is_none());
    }
}
