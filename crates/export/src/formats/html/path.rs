//! The path in the report: its moves as columns that stay short however long the program is.
//!
//! In: a recorded path. Out: JSON. Ends and times are told as what is added to the one before, in tenths of a micrometre
//! and in milliseconds; columns that seldom change as runs: how many, and the value, or what each adds to the one before.
//! `assets/report-path.js` reads them.
//!
//! A path of more than [`REPORT_SEGMENTS_MAX`] pieces is shown with neighbouring straight cuts joined, as coarsely as it
//! takes and no coarser than [`JOINED_MM_MAX`]; what is too long even so is cut off between two moves. The page says both.

use std::borrow::Cow;

use serde_json::json;
use turnwright_canon::Phase;
use turnwright_units::write_fixed;

use crate::formats::svg::shown_extents;
use crate::path::{Advance, Move, PathRecorder, Point, Segment, SegmentKind};

/// Pieces of path in one report, about 20 MB of HTML.
pub const REPORT_SEGMENTS_MAX: usize = 600_000;

/// How far the pieces that are joined may lie from the one that is shown, at first and at most, mm.
const JOINED_MM_MIN: f64 = 0.001;
const JOINED_MM_MAX: f64 = 0.064;

/// Moves that become one.
const JOINED_MOVES_MAX: usize = 16;

/// A column of numbers, as a JSON array.
#[derive(Default)]
pub(super) struct Column(Vec<u8>);

impl Column {
    fn push(&mut self, value: i64, decimals: u8) {
        if !self.0.is_empty() {
            self.0.push(b',');
        }
        write_fixed(&mut self.0, value, decimals);
    }

    pub(super) fn push_whole(&mut self, value: impl Into<i64>) {
        self.push(value.into(), 0);
    }

    /// A length in millimetres with four places, a tenth of the finest increment in use.
    fn push_mm(&mut self, value: f32) {
        self.push(tenths_of_um(value), 4);
    }

    /// A length in millimetres to the nanometre.
    pub(super) fn push_nm(&mut self, mm: f64) {
        self.push((mm * 1e6).round() as i64, 6);
    }

    /// Adds it to an object that is being written.
    pub(super) fn write(&self, name: &str, out: &mut String) {
        out.push_str(",\n\"");
        out.push_str(name);
        out.push_str("\":[");
        out.push_str(std::str::from_utf8(&self.0).unwrap_or_default());
        out.push(']');
    }
}

/// A column that seldom changes, or grows by the same again and again: how many, and which value, in turn.
#[derive(Default)]
struct Runs {
    column: Column,
    count: u32,
    value: i64,
}

impl Runs {
    fn push(&mut self, value: impl Into<i64>) {
        let value = value.into();
        if self.count > 0 && value != self.value {
            self.close();
        }
        self.value = value;
        self.count += 1;
    }

    fn close(&mut self) {
        if self.count > 0 {
            self.column.push_whole(self.count);
            self.column.push_whole(self.value);
        }
        self.count = 0;
    }

    fn write(mut self, name: &str, out: &mut String) {
        self.close();
        self.column.write(name, out);
    }
}

/// What of a path is in the report.
pub(super) struct Kept<'a> {
    pub(super) moves: Cow<'a, [Move]>,
    segments: Cow<'a, [Segment]>,
    /// The moves that are several, and the last line of each.
    joined: Vec<(u32, u32)>,
    /// How far from the path what is shown may be, mm; 0 when nothing is joined.
    joined_mm: f64,
    incomplete: bool,
}

impl<'a> Kept<'a> {
    /// All of a path, or as much as the limit lets.
    pub(super) fn of(path: &'a PathRecorder, segments_max: usize) -> Self {
        let mut kept = Self {
            moves: Cow::Borrowed(path.moves()),
            segments: Cow::Borrowed(path.segments()),
            joined: Vec::new(),
            joined_mm: 0.0,
            incomplete: path.segments_dropped() > 0,
        };
        let mut tolerance_mm = JOINED_MM_MIN;
        while kept.segments.len() > segments_max && tolerance_mm <= JOINED_MM_MAX {
            kept = joined(path, tolerance_mm);
            tolerance_mm *= 4.0;
        }
        if kept.segments.len() > segments_max {
            kept.cut_off(segments_max);
        }
        kept
    }

    /// Leaves whole moves up to the limit.
    fn cut_off(&mut self, segments_max: usize) {
        // A move at the limit with a corner would lose its second half.
        let fits = self.moves.partition_point(|one| (one.segment_first as usize) < segments_max);
        let moves_kept = fits.saturating_sub(1);
        let segments_kept = self.moves.get(moves_kept).map_or(0, |next| next.segment_first as usize);
        self.moves.to_mut().truncate(moves_kept);
        self.segments.to_mut().truncate(segments_kept);
        self.joined.retain(|(index, _)| (*index as usize) < moves_kept);
        self.incomplete = true;
    }
}

/// A path with neighbouring straight cuts of lines that follow each other as one.
fn joined(path: &PathRecorder, tolerance_mm: f64) -> Kept<'static> {
    let all = path.moves();
    let (mut moves, mut segments, mut joined) = (Vec::new(), Vec::new(), Vec::new());
    let mut index = 0;
    while let Some(first) = all.get(index) {
        let own = path.segments_of(index);
        let mut count = 1;
        let mut through = vec![own.first().map_or(Point::default(), |segment| segment.end)];
        while count < JOINED_MOVES_MAX && goes_on(path, index + count - 1) {
            let Some(end) = path.segments_of(index + count).first().map(|segment| segment.end) else { break };
            if !through.iter().all(|place| distance_mm(*place, own[0].start, end) <= tolerance_mm) {
                break;
            }
            through.push(end);
            count += 1;
        }
        let last = &all[index + count - 1];
        let one = Move {
            segment_first: segments.len() as u32,
            elapsed_s: last.elapsed_s,
            seconds: all[index..index + count].iter().map(|one| one.seconds).sum(),
            ..*first
        };
        if count > 1 {
            joined.push((moves.len() as u32, last.line));
            segments.push(Segment { end: through[count - 1], ..own[0] });
        } else {
            segments.extend_from_slice(own);
        }
        moves.push(one);
        index += count;
    }
    Kept {
        moves: Cow::Owned(moves),
        segments: Cow::Owned(segments),
        joined,
        joined_mm: tolerance_mm,
        incomplete: path.segments_dropped() > 0,
    }
}

/// Whether a move and the next one are straight cuts that differ in nothing but their way and their line.
fn goes_on(path: &PathRecorder, index: usize) -> bool {
    let (moves, is_straight) = (path.moves(), |segments: &[Segment]| {
        matches!(segments, [Segment { bow: None, kind: SegmentKind::Feed, .. }])
    });
    let [one, next] = [moves.get(index), moves.get(index + 1)];
    let (Some(one), Some(next)) = (one, next) else { return false };
    let waits_s = next.elapsed_s - f64::from(next.seconds) - one.elapsed_s;
    let is_same = (one.source, one.figure_line, one.cycle, one.tool, one.advance)
        == (next.source, next.figure_line, next.cycle, next.tool, next.advance);
    let ends_meet = || path.segments_of(index)[0].end == path.segments_of(index + 1)[0].start;
    is_same
        && next.line > one.line
        && waits_s < 5e-4
        && is_straight(path.segments_of(index))
        && is_straight(path.segments_of(index + 1))
        && ends_meet()
}

/// How far a place is from a straight way.
fn distance_mm(place: Point, from: Point, to: Point) -> f64 {
    let way = |a: Point, b: Point| {
        (f64::from(b.radius_mm) - f64::from(a.radius_mm), f64::from(b.z_mm) - f64::from(a.z_mm))
    };
    let ((along_x, along_z), (x, z)) = (way(from, to), way(from, place));
    let square = along_x * along_x + along_z * along_z;
    let share = if square > 0.0 { ((x * along_x + z * along_z) / square).clamp(0.0, 1.0) } else { 0.0 };
    (x - along_x * share).hypot(z - along_z * share)
}

/// The path as columns; zero means "none" in those that count from 1.
pub(super) fn path_json(path: &PathRecorder, kept: &Kept<'_>, source: u32) -> String {
    let Kept { moves, segments, joined, joined_mm, incomplete } = kept;
    let [mut ends, mut jumps, mut arcs] = [const { Column(Vec::new()) }; 3];
    let (mut pen, mut before) = (None, (0, 0));
    for (index, segment) in segments.iter().enumerate() {
        if pen != Some(segment.start) {
            jumps.push_whole(index as i64);
            jumps.push_mm(segment.start.radius_mm);
            jumps.push_mm(segment.start.z_mm);
        }
        let end = (tenths_of_um(segment.end.radius_mm), tenths_of_um(segment.end.z_mm));
        ends.push_whole(end.0 - before.0);
        ends.push_whole(end.1 - before.1);
        before = end;
        if let Some(bow) = segment.bow {
            arcs.push_whole(index as i64);
            arcs.push_mm(bow.centre.radius_mm);
            arcs.push_mm(bow.centre.z_mm);
            arcs.push((f64::from(bow.sweep_rad) * 1e7).round() as i64, 7);
        }
        pen = Some(segment.end);
    }

    let mut labels = Vec::new();
    let [mut first, mut kind, mut line, mut figure, mut cycle] = std::array::from_fn(|_| Runs::default());
    let [mut pass, mut phase, mut tool, mut advance, mut unit] = std::array::from_fn(|_| Runs::default());
    let (mut elapsed, mut waits) = (Column::default(), Column::default());
    let (mut before_s, mut before_ms, mut first_before, mut line_before) = (0.0, 0, 0, 0);
    for (index, one) in moves.iter().enumerate() {
        // Dwells, tool changes and whatever else passes before the tool moves.
        let wait_ms = ((one.elapsed_s - f64::from(one.seconds) - before_s) * 1e3).round() as i64;
        if wait_ms > 0 {
            waits.push_whole(index as i64);
            waits.push(wait_ms, 3);
        }
        before_s = one.elapsed_s;
        let here = one.source == source;
        first.push(i64::from(one.segment_first) - first_before);
        first_before = i64::from(one.segment_first);
        kind.push(kind_number(segments[one.segment_first as usize].kind));
        let line_now = if here { i64::from(one.line) } else { 0 };
        line.push(line_now - line_before);
        line_before = line_now;
        figure.push(one.figure_line.filter(|_| here).map_or(0, |line| line.get()));
        cycle.push(one.cycle.map_or(0, |cycle| {
            let at = labels.iter().position(|label| *label == cycle.label).unwrap_or_else(|| {
                labels.push(cycle.label);
                labels.len() - 1
            });
            at as i64 + 1
        }));
        pass.push(one.cycle.map_or(0, |cycle| cycle.pass));
        phase.push(one.cycle.map_or(0, |cycle| phase_number(cycle.phase)));
        tool.push(one.tool);
        let (value, number) = match one.advance {
            None => (0.0, 0),
            Some(Advance::MmPerRevolution(value)) => (value, 1),
            Some(Advance::MmPerMinute(value)) => (value, 2),
            Some(Advance::LeadMm(value)) => (value, 3),
        };
        advance.push((f64::from(value) * 1e5).round() as i64);
        unit.push(number);
        let elapsed_ms = (one.elapsed_s * 1e3).round() as i64;
        elapsed.push_whole(elapsed_ms - before_ms);
        before_ms = elapsed_ms;
    }
    let mut last_lines = Column::default();
    let of_here = joined.iter().filter(|(index, _)| moves[*index as usize].source == source);
    for (index, last_line) in of_here {
        last_lines.push_whole(*index);
        last_lines.push_whole(*last_line);
    }

    let shown = shown_extents(path, 2.0);
    let view = [shown.radius_min_mm, shown.radius_max_mm, shown.z_min_mm, shown.z_max_mm];
    let words: Vec<&str> = PHASES.iter().map(|phase| phase.word()).collect();
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    let mut out = format!(
        "{{\"view\":{},\"moves\":{},\"incomplete\":{incomplete},\"joined_mm\":{joined_mm},\"phases\":{},\"cycles\":{}",
        json!(view),
        moves.len(),
        json!(words),
        json!(labels)
    );
    for (name, column) in [
        ("ends", ends),
        ("jumps", jumps),
        ("arcs", arcs),
        ("elapsed", elapsed),
        ("waits", waits),
        ("joined", last_lines),
    ] {
        column.write(name, &mut out);
    }
    for (name, runs) in [
        ("first", first),
        ("kind", kind),
        ("line", line),
        ("figure", figure),
        ("cycle", cycle),
        ("pass", pass),
        ("phase", phase),
        ("tool", tool),
        ("advance", advance),
        ("unit", unit),
    ] {
        runs.write(name, &mut out);
    }
    out.push('}');
    out
}

fn tenths_of_um(mm: f32) -> i64 {
    (f64::from(mm) * 1e4).round() as i64
}

const fn kind_number(kind: SegmentKind) -> u32 {
    match kind {
        SegmentKind::Rapid => 0,
        SegmentKind::Feed => 1,
        SegmentKind::Thread => 2,
    }
}

/// The phases in the order of their numbers, from 1.
pub(super) const PHASES: [Phase; 15] = [
    Phase::Approach,
    Phase::Infeed,
    Phase::Cut,
    Phase::Escape,
    Phase::Return,
    Phase::Contour,
    Phase::Finish,
    Phase::Peck,
    Phase::Back,
    Phase::Relief,
    Phase::Shift,
    Phase::Thread,
    Phase::Chamfer,
    Phase::Out,
    Phase::Home,
];

fn phase_number(phase: Phase) -> u32 {
    PHASES.iter().position(|one| *one == phase).map_or(0, |at| at as u32 + 1)
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{Action, Command, Origin, RapidPath, Shape};
    use turnwright_units::{Feed, FeedPerRevolution, Length, Position, Radius, WorkTip};

    use super::*;

    fn at(radius_nm: i64, z_nm: i64) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(radius_nm)), Length::from_nm(z_nm))
    }

    fn cut(to: Position<WorkTip>, line: u32) -> Command {
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(200_000)));
        Command::new(Action::Feed { to, shape: Shape::Line, feed, others: None }, Origin::line(line))
    }

    /// Steps of a tenth of a millimetre along Z that lie by turns 0.8 µm on either side of a line.
    fn wavy(moves: u32) -> PathRecorder {
        let mut path = PathRecorder::new(at(0, 0), 0.0, 0.0);
        for number in 1..=moves {
            let radius_nm = if number % 2 == 0 { 800 } else { -800 };
            path.add(&cut(at(10_000_000 + radius_nm, -100_000 * i64::from(number)), number), 0.5);
        }
        path
    }

    #[test]
    fn a_path_is_whole_up_to_the_limit_and_joined_beyond() {
        let path = wavy(1000);
        let whole = Kept::of(&path, 1000);
        assert_eq!((whole.segments.len(), whole.joined_mm, whole.incomplete), (1000, 0.0, false));
        let kept = Kept::of(&path, 999);
        // 1.6 µm from side to side need the second tolerance; 16 moves are one.
        assert_eq!((kept.joined_mm, kept.incomplete), (4.0 * JOINED_MM_MIN, false));
        assert_eq!((kept.moves.len(), kept.segments.len()), (64, 64));
        let last = kept.moves.last().expect("a move");
        assert_eq!((last.elapsed_s, kept.joined.last().copied()), (500.0, Some((63, 1000))));
        // The first goes down to the work.
        assert_eq!((kept.moves[1].line, kept.joined[..2].to_vec()), (2, vec![(1, 17), (2, 33)]));
        // Nothing is farther away than is told, and the ends meet.
        for pair in kept.segments.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
        }
        for segment in path.segments() {
            let away = |one: &Segment| distance_mm(segment.end, one.start, one.end);
            let least = kept.segments.iter().map(away).fold(f64::INFINITY, f64::min);
            assert!(least <= kept.joined_mm + 1e-6, "{least}");
        }
    }

    #[test]
    fn what_differs_is_never_joined() {
        let mut path = PathRecorder::new(at(0, 0), 0.0, 0.0);
        for number in 1..=20_u32 {
            path.add(&cut(at(10_000_000, -100_000 * i64::from(number)), number), 0.5);
        }
        let dwell = Action::Dwell(turnwright_canon::Dwell::Time(turnwright_units::Seconds(2.0)));
        path.add(&Command::new(dwell, Origin::line(21)), 2.0);
        path.add(&cut(at(10_000_000, -2_100_000), 22), 0.5);
        // A loop runs an earlier line again, then a rapid goes on in the same way.
        path.add(&cut(at(10_000_000, -2_200_000), 3), 0.5);
        let to = at(10_000_000, -2_300_000);
        let rapid = Action::Rapid { to, path: RapidPath::Straight, others: None };
        path.add(&Command::new(rapid, Origin::line(24)), 0.5);
        let kept = joined(&path, JOINED_MM_MAX);
        let lines: Vec<u32> = kept.moves.iter().map(|one| one.line).collect();
        assert_eq!(lines, [1, 2, 18, 22, 3, 24]);
        assert_eq!(kept.joined, [(1, 17), (2, 20)]);
    }

    #[test]
    fn a_path_that_cannot_be_joined_is_cut_off_between_moves_and_says_so() {
        let mut path = PathRecorder::new(at(50_000_000, 100_000_000), 5_000.0, 10_000.0);
        for number in 0..50_u32 {
            let to = at(20_000_000 + i64::from(number % 2), -1_000_000 * i64::from(number));
            let rapid = Action::Rapid { to, path: RapidPath::EachAxis, others: None };
            path.add(&Command::new(rapid, Origin::line(number + 1)), 0.5);
        }
        let all = path.segments().len();
        for limit in [0, 1, all / 2, all - 1] {
            let kept = Kept::of(&path, limit);
            assert!(kept.incomplete && kept.segments.len() <= limit, "{limit}");
            assert!(kept.segments.len() + 3 >= limit, "{limit}");
            assert!(path_json(&path, &kept, 0).contains("\"incomplete\":true"));
        }
        assert!(!Kept::of(&path, all).incomplete);
    }
}
