//! Threads as drawings have them: the surface that a thread lies in, and the line through its roots.
//!
//! In: the section with its grooves, the same section without them, and what is remembered of the threads. Out: a
//! [`Thread`] for each, and the plain section with its threads' crests: where the thread took more than its grooves,
//! as a taper thread that is cut from the bar does, the crest is what the grooves left.

use turnwright_geometry::{Bend, Outline, Point, Segment, Vector};
use turnwright_stock::Section;
use turnwright_stock::machining::ThreadMark;

/// Lines that are bent by less than this share of a thread's depth are drawn straight, and a crest that lies lower by
/// less is where the surface was.
const SHARE: f64 = 0.05;

/// Flanks that are cut in several passes have small hills of their own: a crest is the highest, and a root the lowest,
/// in this share of the distance between two grooves, to both sides.
const NEIGHBOURHOOD: f64 = 0.75;

/// Rounding.
const SLACK_MM: f64 = 1e-6;

/// A thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// Diameter of its crest half-way, mm: outside it is the greater one.
    pub crest_mm: f64,
    /// Diameter of its deepest root, mm.
    pub root_mm: f64,
    /// Its lead, mm.
    pub lead_mm: f64,
    /// How many starts it has.
    pub starts: usize,
    /// From lower to higher Z.
    pub z: (f64, f64),
    /// The line through its roots, in the material.
    pub root: Vec<Point>,
    /// In a bore.
    pub is_inside: bool,
    side: Side,
    /// How far it reaches along its side, and out of it.
    along: (f64, f64),
    out: (f64, f64),
}

/// Which way a surface looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Outside,
    Inside,
    Front,
    Back,
}

impl Side {
    /// The side to which the way from one place to another looks; the material is on its left.
    fn of(start: Point, end: Point) -> Self {
        let way = Vector::between(start, end);
        match (way.z.abs() >= way.x.abs(), way.z > 0.0, way.x > 0.0) {
            (true, true, _) => Self::Inside,
            (true, false, _) => Self::Outside,
            (false, _, true) => Self::Front,
            (false, _, false) => Self::Back,
        }
    }

    const fn along(self, place: Point) -> f64 {
        match self {
            Self::Outside | Self::Inside => place.z,
            Self::Front | Self::Back => place.x,
        }
    }

    fn out(self, place: Point) -> f64 {
        match self {
            Self::Outside => place.x,
            Self::Inside => -place.x,
            Self::Front => place.z,
            Self::Back => -place.z,
        }
    }

    fn place(self, along: f64, out: f64) -> Point {
        match self {
            Self::Outside => Point::new(out, along),
            Self::Inside => Point::new(-out, along),
            Self::Front => Point::new(along, out),
            Self::Back => Point::new(along, -out),
        }
    }

    /// How far a line of this side is out where it passes.
    fn out_at(self, edge: &Segment, along: f64) -> Option<f64> {
        let (start, end) = (self.along(edge.start), self.along(edge.end));
        let share = (along - start) / (end - start);
        let is_passed = edge.bend.is_none() && (0.0..=1.0).contains(&share);
        (is_passed && Self::of(edge.start, edge.end) == self)
            .then(|| self.out(edge.start) + share * (self.out(edge.end) - self.out(edge.start)))
    }
}

impl Thread {
    /// The thread of a mark, if the section shows its grooves. `plain` gets the thread's crest.
    pub(super) fn new(grooved: &[Vec<Segment>], plain: &mut Section, mark: &ThreadMark) -> Option<Self> {
        let grooves = grooves(grooved, mark)?;
        let (start, end) = (grooves[0].start, grooves[grooves.len() - 1].end);
        let side = Side::of(start, end);
        let starts = mark.starts.len().max(1);
        let reach_mm = mark.lead_mm / starts as f64 * NEIGHBOURHOOD;
        let places: Vec<(f64, f64)> =
            corners(&grooves).into_iter().map(|place| (side.along(place), side.out(place))).collect();
        let on_side = |hills: Vec<(f64, f64)>, sense: f64| -> Vec<Point> {
            hills.into_iter().map(|(along, out)| side.place(along, sense * out)).collect()
        };
        let roots = on_side(hills(places.iter().map(|(along, out)| (*along, -out)), reach_mm), -1.0);
        let crests = on_side(hills(places.iter().copied(), reach_mm), 1.0);
        let deepest = roots.iter().map(|root| side.out(*root)).reduce(f64::min)?;
        let mut surface = edges(plain);
        let most = |surface: &[Segment], along: f64| {
            let near = surface.iter().filter_map(|edge| side.out_at(edge, along));
            near.filter(|out| *out > deepest).fold(f64::NEG_INFINITY, f64::max)
        };
        let height = crests.iter().map(|crest| most(&surface, side.along(*crest))).reduce(f64::max)?;
        let slack_mm = SHARE * (height - deepest);
        let ends = |of: fn(f64, f64) -> f64| move |a: Point, b: Point| of(side.along(a), side.along(b));
        let bounds = (mark.bounds.min, mark.bounds.max);
        let cut = (ends(f64::min)(bounds.0, bounds.1), ends(f64::max)(bounds.0, bounds.1));

        let mut gaps: Vec<f64> =
            crests.iter().map(|crest| most(&surface, side.along(*crest)) - side.out(*crest)).collect();
        gaps.sort_by(f64::total_cmp);
        if gaps.get(gaps.len() / 2).is_some_and(|gap| *gap > slack_mm) {
            let crest = extended(&straightened(&crests, slack_mm), mark.lead_mm, cut, side);
            // All that stands out over the crest goes.
            let above = |place: &Point| side.place(side.along(*place), height + mark.lead_mm);
            let (first, last) = (crest.first().map(above), crest.last().map(above));
            let corners: Vec<Point> = crest.iter().copied().chain(last).chain(first).collect();
            if let Ok(hole) = Outline::polygon(&corners) {
                plain.cut_hole(&hole);
                surface = edges(plain);
            }
        }

        // The surface that the thread lies in ends it, where it goes through; where it starts, less than a lead away.
        let programmed = (ends(f64::min)(mark.from, mark.to), ends(f64::max)(mark.from, mark.to));
        let reach = (cut.0.min(programmed.0), cut.1.max(programmed.1));
        let middle = (cut.0 + cut.1) / 2.0;
        let bed = surface
            .iter()
            .filter(|edge| side.out_at(edge, middle).is_some_and(|out| out > deepest))
            .max_by(|a, b| {
                let out = |edge: &Segment| side.out_at(edge, middle).unwrap_or(f64::NEG_INFINITY);
                out(a).total_cmp(&out(b))
            })?;
        let bed_ends = (ends(f64::min)(bed.start, bed.end), ends(f64::max)(bed.start, bed.end));
        let near = |gap: f64| gap < mark.lead_mm;
        let starts_low = side.along(mark.from) < side.along(mark.to);
        let mut along = (reach.0.max(bed_ends.0.min(cut.0)), reach.1.min(bed_ends.1.max(cut.1)));
        if starts_low && near(along.0 - bed_ends.0) {
            along.0 = along.0.min(bed_ends.0);
        } else if !starts_low && near(bed_ends.1 - along.1) {
            along.1 = along.1.max(bed_ends.1);
        }
        let root = extended(&straightened(&roots, slack_mm), mark.lead_mm, along, side);
        let crest = side.place(middle, side.out_at(bed, middle)?);
        Some(Self {
            crest_mm: 2.0 * crest.x,
            root_mm: 2.0 * side.place(middle, deepest).x,
            lead_mm: mark.lead_mm,
            starts,
            z: match side {
                Side::Outside | Side::Inside => along,
                Side::Front | Side::Back => (mark.bounds.min.z, mark.bounds.max.z),
            },
            root: in_material(root, plain),
            is_inside: side == Side::Inside,
            side,
            along,
            out: (deepest, height),
        })
    }

    /// The name of a metric thread, `M20×1.5`; nothing for any other, for tapers and for those of a face.
    pub fn name(&self) -> Option<String> {
        let is_level = self.taper_deg().is_none();
        let is_round = matches!(self.side, Side::Outside | Side::Inside);
        let pitch_mm = self.lead_mm / self.starts.max(1) as f64;
        let (low, high) = (self.crest_mm.min(self.root_mm), self.crest_mm.max(self.root_mm));
        (is_level && is_round).then(|| super::metric::name(high, low, pitch_mm, self.starts)).flatten()
    }

    /// How its roots taper: between its sides, degrees; nothing for a straight one. Its run-out is no taper: the longest
    /// stretch counts.
    pub fn taper_deg(&self) -> Option<f64> {
        let stretches = self.root.windows(2).map(|two| (two[1].x - two[0].x, two[1].z - two[0].z));
        let (dx, dz) = stretches.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (dx, dz) = (dx.abs(), dz.abs());
        (matches!(self.side, Side::Outside | Side::Inside) && dx > 0.02)
            .then(|| 2.0 * dx.atan2(dz).to_degrees())
    }

    /// Whether an edge of the drawing is this thread's crest.
    pub fn holds(&self, edge: &Segment) -> bool {
        let middle = edge.at(0.5);
        let (along, out) = (self.side.along(middle), self.side.out(middle));
        edge.bend.is_none()
            && Side::of(edge.start, edge.end) == self.side
            && self.along.0 < along
            && along < self.along.1
            && self.out.0 + SLACK_MM < out
            && out < self.out.1 + self.lead_mm
    }

    /// Whether a place of the true section belongs to this thread: between its ends, not deeper than its roots.
    pub fn surrounds(&self, place: Point) -> bool {
        let (along, out) = (self.side.along(place), self.side.out(place));
        let is_between = self.along.0 < along && along < self.along.1;
        is_between && self.out.0 - SLACK_MM <= out && out < self.out.1 + self.lead_mm
    }

    /// How far it may wind on from one of so many half-planes to the next, by its hand.
    pub(crate) fn steps(&self, half_planes: usize) -> [Vector; 2] {
        let step = self.lead_mm / half_planes.max(1) as f64;
        [step, -step].map(|step| match self.side {
            Side::Outside | Side::Inside => Vector { x: 0.0, z: step },
            Side::Front | Side::Back => Vector { x: step, z: 0.0 },
        })
    }

    /// Parts the edges where the thread ends, so that its surface is one of its own.
    pub(super) fn part(&self, edges: &mut Vec<Segment>) {
        for end in [self.along.0, self.along.1] {
            let mut parted = Vec::with_capacity(edges.len() + 2);
            for edge in edges.drain(..) {
                let (a, b) = (self.side.along(edge.start), self.side.along(edge.end));
                let is_inner = (end - a) * (b - end) > 0.0 && (end - a).abs().min((b - end).abs()) > 1e-3;
                let out = self.side.out_at(&edge, end).filter(|out| is_inner && *out > self.out.0 + SLACK_MM);
                if let Some(out) = out {
                    let place = self.side.place(end, out);
                    parted.extend([Segment { end: place, ..edge }, Segment { start: place, ..edge }]);
                } else {
                    parted.push(edge);
                }
            }
            *edges = parted;
        }
    }
}

fn edges(section: &Section) -> Vec<Segment> {
    section.contours().into_iter().flat_map(|contour| contour.segments).collect()
}

/// The longest run of edges that lies where the thread was cut: two flanks at least, and the crest between them.
fn grooves(loops: &[Vec<Segment>], mark: &ThreadMark) -> Option<Vec<Segment>> {
    const EDGES_MIN: usize = 3;
    let (min, max) = (mark.bounds.min, mark.bounds.max);
    let is_in = |place: Point| {
        (min.z - SLACK_MM..=max.z + SLACK_MM).contains(&place.z)
            && (min.x - SLACK_MM..=max.x + SLACK_MM).contains(&place.x)
    };
    let is_groove = |edge: &Segment| is_in(edge.start) && is_in(edge.end);
    let mut longest: Vec<Segment> = Vec::new();
    for edges in loops {
        // From an edge outside the thread on, so that no run is parted.
        let Some(first) = edges.iter().position(|edge| !is_groove(edge)) else { continue };
        let (behind, before) = edges.split_at(first);
        let edges: Vec<Segment> = before.iter().chain(behind).copied().collect();
        let run = edges.split(|edge| !is_groove(edge)).max_by_key(|run| run.len());
        longest = run.filter(|run| run.len() > longest.len()).map_or(longest, <[Segment]>::to_vec);
    }
    (longest.len() >= EDGES_MIN).then_some(longest)
}

/// The corners of a run, and the outermost places of its arcs.
fn corners(run: &[Segment]) -> Vec<Point> {
    let mut places = Vec::with_capacity(run.len() + 1);
    for edge in run {
        places.push(edge.start);
        if let Some(Bend { centre, .. }) = edge.bend {
            let radius = centre.distance(edge.start);
            let sides = [(radius, 0.0), (-radius, 0.0), (0.0, radius), (0.0, -radius)];
            let outermost = sides.map(|(x, z)| Point::new(centre.x + x, centre.z + z));
            places.extend(outermost.into_iter().filter(|place| edge.distance(*place) < SLACK_MM));
        }
    }
    places.extend(run.last().map(|last| last.end));
    places
}

/// The places that no other is higher than within `reach_mm` along the line; its ends are none.
fn hills(places: impl Iterator<Item = (f64, f64)>, reach_mm: f64) -> Vec<(f64, f64)> {
    let places: Vec<(f64, f64)> = places.collect();
    let is_hill = |index: &usize| {
        let (along, height) = places[*index];
        let is_near = |place: &&(f64, f64)| (place.0 - along).abs() < reach_mm;
        let before = places[..*index].iter().rev().take_while(is_near);
        let behind = places[index + 1..].iter().take_while(is_near);
        before.chain(behind).all(|place| place.1 <= height + SLACK_MM)
    };
    (1..places.len().saturating_sub(1)).filter(is_hill).map(|index| places[index]).collect()
}

/// The same line with as few corners as stay within a distance (Ramer, Douglas and Peucker).
fn straightened(line: &[Point], slack_mm: f64) -> Vec<Point> {
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return Vec::new() };
    let mut is_kept = vec![false; line.len()];
    (is_kept[0], is_kept[line.len() - 1]) = (true, true);
    let mut spans = vec![(0, line.len() - 1)];
    while let Some((from, to)) = spans.pop() {
        let chord = Segment { start: line[from], end: line[to], bend: None };
        let off = |index: &usize| chord.distance(line[*index]);
        let farthest = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(farthest) = farthest.filter(|index| off(index) > slack_mm) {
            is_kept[farthest] = true;
            spans.extend([(from, farthest), (farthest, to)]);
        }
    }
    if first == last {
        return vec![*first];
    }
    line.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(place, _)| *place).collect()
}

/// A line that goes straight on at both ends as far as the thread reaches, but no farther than a lead.
fn extended(line: &[Point], lead_mm: f64, along: (f64, f64), side: Side) -> Vec<Point> {
    let mut line = line.to_vec();
    let lead_on = |from: Point, end: Point, to: f64| {
        let (a, b) = (side.along(from), side.along(end));
        let slope = if (b - a).abs() > SLACK_MM { (side.out(end) - side.out(from)) / (b - a) } else { 0.0 };
        let to = to.clamp(b - lead_mm, b + lead_mm);
        side.place(to, side.out(end) + slope * (to - b))
    };
    let (Some(first), Some(last)) = (line.first().copied(), line.last().copied()) else { return line };
    let (second, last_but_one) = (line[1.min(line.len() - 1)], line[line.len().saturating_sub(2)]);
    let rises = side.along(first) < side.along(last);
    let (before, behind) = if rises { along } else { (along.1, along.0) };
    line.insert(0, lead_on(second, first, before));
    line.push(lead_on(last_but_one, last, behind));
    line
}

/// What of a line is in the material: its ends are drawn in to the surface.
fn in_material(mut line: Vec<Point>, section: &Section) -> Vec<Point> {
    const HALVINGS: u32 = 30;
    for _ in 0..2 {
        line.reverse();
        let [.., inner, end] = line.as_mut_slice() else { continue };
        if section.contains(*end) {
            continue;
        }
        let (mut inside, mut outside) = (*inner, *end);
        for _ in 0..HALVINGS {
            let middle = Vector::between(inside, outside).times(0.5).from(inside);
            if section.contains(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        *end = inside;
    }
    line
}
