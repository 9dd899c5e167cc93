//! The part beside what it ought to be: a drawing, or the figures that its finishing cycles follow.
//!
//! In: the target, and the run that cuts the part. Out: what is cut too deep ([`Spot`]s with the line that did it), what
//! is left standing, and how far the surface deviates along the contour of the target.
//!
//! A drawing is the whole part: every cut counts, threads excepted, for drawings show their crests. What the chuck still
//! holds behind the back of the drawing is not compared. The figure of a finishing cycle is only a part of the contour,
//! and only its own roughing and finishing count: what grooving tools, drills and threads take below it is meant.
//!
//! Invariant: a part that is its target has neither gouges nor rests.

pub mod drawing;
mod loops;

use turnwright_canon::{Action, Command, Phase, Shape};
use turnwright_geometry::{Bounds, Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::{Guard, edges};
use turnwright_units::{Position, WorkTip};

pub use self::loops::{ContourFault, section};
use crate::comparison::{Piece, pieces, surface};
use crate::figures::{BlockLine, Figure};

/// What is shallower is never told, mm: the least that a control can be asked for.
pub const LEAST_MM: f64 = 1e-3;

/// Numbers of drawings are no finer, mm.
const GRAIN_MM: f64 = 1e-5;

/// Gouges that are kept of one target; each has the edges of a region.
pub const SPOTS_MAX: usize = 200;

/// Strokes of a line or arc, each with its own deviation; of contours with many, fewer.
const STROKES: u32 = 24;

/// Strokes of a contour, as long as each line or arc has one.
const STROKES_MAX: u32 = 2_400;

/// What the part is held against.
#[derive(Clone, Debug)]
pub enum Target {
    /// All of it.
    Drawing(Box<Section>),
    /// The contours that finishing cycles follow.
    Figures(Vec<Figure>),
}

/// A place where the part is not its target.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// What is missing, or too much.
    pub piece: Piece,
    /// Of a gouge: the line that cut it.
    pub line: Option<BlockLine>,
    /// Of a gouge: the tool that cut it; 0 before any was called.
    pub tool: u32,
}

/// A stroke of the target's contour; above zero where material is left, below where too much is gone, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The stroke.
    pub way: Segment,
    /// How far the part is off it.
    pub deviation_mm: f64,
}

/// The part beside its target; what deviates most comes first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// What is cut too deep.
    pub gouges: Vec<Spot>,
    /// What is left standing.
    pub rests: Vec<Spot>,
    /// The contour of the target.
    pub contour: Vec<Segment>,
}

/// A target and those that watched over it while the part was cut.
#[derive(Clone, Debug)]
pub struct Aimed {
    pub(crate) target: Target,
    pub(crate) watches: Vec<Watch>,
}

/// A cut below a surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loss {
    pub(crate) piece: Piece,
    /// How far the programmed point itself was below the surface, mm.
    pub(crate) tip_mm: f64,
    pub(crate) line: BlockLine,
    /// Number of the command.
    pub(crate) command: u64,
    pub(crate) tool: u32,
}

/// Who must not cut below a surface, and what was cut nevertheless. It looks through a [`Guard`] of the machining.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    /// Nothing: everybody.
    figure: Option<Figure>,
    surface: Vec<Segment>,
    /// What was there at first, and what is left of it but for what was lost.
    whole: Section,
    kept: Section,
    pub(crate) losses: Vec<Loss>,
}

impl Watch {
    fn new(figure: Option<Figure>, surface: Vec<Segment>, whole: Section) -> (Self, Guard) {
        let guard = Guard::new(whole.clone(), LEAST_MM);
        (Self { figure, surface, kept: whole.clone(), whole, losses: Vec::new() }, guard)
    }

    /// Guards a figure; nothing when its edges cross each other.
    pub(crate) fn of_figure(figure: &Figure, stock: &Section) -> Option<(Self, Guard)> {
        let inside = Section::new(&figure.inside(stock.bounds()?)?).ok()?;
        Some(Self::new(Some(figure.clone()), figure.ways().collect(), common(&inside, stock)))
    }

    /// Guards all that a drawing shows.
    pub(crate) fn of_drawing(drawing: &Section, stock: &Section) -> (Self, Guard) {
        Self::new(None, surface(drawing), common(drawing, stock))
    }

    pub(crate) fn figure(&self) -> Option<&Figure> {
        self.figure.as_ref()
    }

    /// Whether a command must not cut below the surface.
    pub(crate) fn counts(&self, command: &Command) -> bool {
        if matches!(command.action, Action::Thread { .. }) {
            return false;
        }
        let Some(figure) = &self.figure else { return true };
        let line = (command.origin.source, command.origin.line);
        command.origin.cycle.is_some() && (line == figure.finishing || figure.roughing.contains(&line))
    }

    /// Takes note of what a command cut out of the guard on its way from a place.
    pub(crate) fn note(
        &mut self,
        guard: &mut Guard,
        from: Position<WorkTip>,
        command: &Command,
        by: (u64, u32),
    ) {
        let origin = &command.origin;
        let is_finishing = origin.cycle.is_some_and(|cycle| cycle.phase == Phase::Finish);
        let line = (origin.source, origin.figure_line.filter(|_| is_finishing).unwrap_or(origin.line));
        for lost in guard.take_lost() {
            self.kept.cut_section(&lost);
            let places = tip(from, command);
            let below = places.into_iter().filter(|place| lost.contains(*place));
            let tip_mm = below.map(|place| distance(&self.surface, place)).fold(0.0, f64::max);
            for piece in pieces(&lost, &self.surface, LEAST_MM) {
                if self.losses.len() < SPOTS_MAX {
                    let (command, tool) = by;
                    self.losses.push(Loss { piece, tip_mm, line, command, tool });
                }
            }
        }
    }

    /// What was lost, each piece with the deepest cut into it.
    fn gouges(&self) -> Vec<Spot> {
        let mut lost = self.whole.clone();
        lost.cut_section(&self.kept);
        let spot = |piece: Piece| {
            let by = self.losses.iter().filter(|loss| loss.piece.bounds.meets(&piece.bounds, GRAIN_MM));
            let by = by.max_by(|a, b| a.piece.deviation_mm.total_cmp(&b.piece.deviation_mm));
            Spot { line: by.map(|loss| loss.line), tool: by.map_or(0, |loss| loss.tool), piece }
        };
        pieces(&lost, &self.surface, LEAST_MM).into_iter().map(spot).collect()
    }
}

/// Places of the programmed point on a cutting move, or a straight rapid.
fn tip(from: Position<WorkTip>, command: &Command) -> Vec<Point> {
    const LOOKS: u32 = 32;
    let ways: Vec<Segment> = match &command.action {
        Action::Rapid { to, .. } => edges(from, *to, &Shape::Line).collect(),
        Action::Feed { to, shape, .. } => edges(from, *to, shape).collect(),
        _ => Vec::new(),
    };
    let looks = |way: &Segment| (0..=LOOKS).map(|look| way.at(f64::from(look) / f64::from(LOOKS))).collect();
    ways.iter().flat_map(|way| -> Vec<Point> { looks(way) }).collect()
}

fn distance(surface: &[Segment], place: Point) -> f64 {
    surface.iter().map(|edge| edge.distance(place)).fold(f64::INFINITY, f64::min)
}

/// What two sections have both.
fn common(section: &Section, other: &Section) -> Section {
    let (mut lacks, mut common) = (section.clone(), section.clone());
    lacks.cut_section(other);
    common.cut_section(&lacks);
    common
}

/// What stands on a figure's outer side, and the figure's own surface.
pub(crate) fn rest_of_figure(figure: &Figure, part: &Section) -> Vec<Piece> {
    let ways: Vec<Segment> = figure.ways().collect();
    let outside = figure.outside().and_then(|outline| Section::new(&outline).ok());
    outside.map_or_else(Vec::new, |outside| pieces(&common(&outside, part), &ways, GRAIN_MM))
}

/// The deepest part of a rest that a round nose could have reached, and the line of the figure there: what it leaves in
/// inner corners, and at the ends of the figure, is nobody's fault.
pub(crate) fn deepest_in_reach(figure: &Figure, rests: &[Piece], nose_mm: f64) -> Option<(f64, Point, u32)> {
    let outside = figure.outside()?;
    let ways: Vec<Segment> = figure.ways().collect();
    let ends = [ways.first()?.start, ways.last()?.end];
    let reaches: Vec<Reach<'_>> = rests.iter().map(|piece| Reach::new(piece, &ways)).collect();
    let mut deepest: Option<(f64, Point, u32)> = None;
    for (edge, way) in figure.edges.iter().zip(&ways) {
        for look in 0..STROKES {
            let share = (f64::from(look) + 0.5) / f64::from(STROKES);
            let place = way.at(share);
            let depth = reaches.iter().map(|reach| reach.at(place)).fold(0.0, f64::max);
            if depth <= deepest.map_or(0.0, |deepest| deepest.0) {
                continue;
            }
            let step = 0.25 / f64::from(STROKES);
            let (before, behind) = (way.at(share - step), way.at(share + step));
            let length = before.distance(behind).max(GRAIN_MM);
            let square = |sign: f64, mm: f64| {
                let (x, z) = (behind.x - before.x, behind.z - before.z);
                Point::new(place.x + sign * z / length * mm, place.z - sign * x / length * mm)
            };
            let sign = if outside.contains(square(1.0, 10.0 * LEAST_MM)) { 1.0 } else { -1.0 };
            let centre = square(sign, nose_mm);
            let is_free = ways.iter().all(|way| way.distance(centre) >= nose_mm - LEAST_MM);
            let is_inner = ends.iter().all(|end| end.distance(place) >= 1.5 * nose_mm);
            if is_free && is_inner {
                deepest = Some((depth, place, edge.line));
            }
        }
    }
    deepest
}

/// A piece beside the contour that it begins at.
struct Reach<'a> {
    piece: &'a Piece,
    /// Its edges that are not on the contour.
    free: Vec<Segment>,
}

impl<'a> Reach<'a> {
    fn new(piece: &'a Piece, contour: &[Segment]) -> Self {
        let is_free = |edge: &&Segment| {
            let middle = edge.at(0.5);
            contour.iter().all(|way| way.distance(middle) > GRAIN_MM)
        };
        Self { piece, free: piece.edges.iter().filter(is_free).copied().collect() }
    }

    /// How far the piece reaches from a place on the contour; 0 when it does not begin there.
    fn at(&self, place: Point) -> f64 {
        let Bounds { min, max } = self.piece.bounds;
        let is_between = |low: f64, at: f64, high: f64| low - GRAIN_MM <= at && at <= high + GRAIN_MM;
        let is_near = is_between(min.x, place.x, max.x) && is_between(min.z, place.z, max.z);
        if !is_near || self.piece.edges.iter().all(|edge| edge.distance(place) > GRAIN_MM) {
            return 0.0;
        }
        self.free.iter().map(|edge| edge.distance(place)).reduce(f64::min).unwrap_or(0.0)
    }
}

impl Aimed {
    /// The finished part, as it is shown, beside its target.
    pub fn judge(&self, part: &Section) -> Judgement {
        let mut judgement = match &self.target {
            Target::Drawing(drawing) => self.beside_drawing(drawing, part),
            Target::Figures(figures) => Judgement {
                gouges: self.watches.iter().flat_map(Watch::gouges).collect(),
                rests: figures
                    .iter()
                    .flat_map(|figure| rest_of_figure(figure, part))
                    .map(Spot::rest)
                    .collect(),
                contour: figures.iter().flat_map(Figure::ways).collect(),
            },
        };
        for spots in [&mut judgement.gouges, &mut judgement.rests] {
            spots.sort_by(|a, b| b.piece.deviation_mm.total_cmp(&a.piece.deviation_mm));
            spots.truncate(SPOTS_MAX);
        }
        judgement
    }

    fn beside_drawing(&self, drawing: &Section, part: &Section) -> Judgement {
        let Some(wanted) = drawing.bounds() else { return Judgement::default() };
        let (mut too_much, mut too_little) = (part.clone(), drawing.clone());
        too_much.cut_section(drawing);
        too_little.cut_section(part);
        let held = part.bounds().filter(|has| has.min.z < wanted.min.z - GRAIN_MM);
        if let Some(has) = held
            && let Ok(held) = Section::bar(has.max.x + 1.0, has.min.z - 1.0, wanted.min.z)
        {
            too_much.cut_section(&held);
        }
        let losses = || self.watches.iter().flat_map(|watch| &watch.losses);
        let gouge = |piece: Piece| {
            let near = |loss: &&Loss| distance(&loss.piece.edges, piece.place) <= LEAST_MM;
            let by = losses().filter(near);
            let by = by.max_by(|a, b| a.piece.deviation_mm.total_cmp(&b.piece.deviation_mm));
            Spot { line: by.map(|loss| loss.line), tool: by.map_or(0, |loss| loss.tool), piece }
        };
        let is_back = |way: &Segment| way.start.z.max(way.end.z) <= wanted.min.z + GRAIN_MM;
        let contour = surface(drawing);
        Judgement {
            gouges: pieces(&too_little, &surface(part), GRAIN_MM).into_iter().map(gouge).collect(),
            rests: pieces(&too_much, &contour, GRAIN_MM).into_iter().map(Spot::rest).collect(),
            contour: contour.into_iter().filter(|way| held.is_none() || !is_back(way)).collect(),
        }
    }
}

impl Spot {
    const fn rest(piece: Piece) -> Self {
        Self { piece, line: None, tool: 0 }
    }
}

impl Judgement {
    /// The contour in strokes, each with its deviation; where there is none, a stroke is as long as its line or arc.
    pub fn strokes(&self) -> Vec<Stroke> {
        let [gouges, rests] = [&self.gouges, &self.rests].map(|spots| -> Vec<Reach<'_>> {
            spots.iter().map(|spot| Reach::new(&spot.piece, &self.contour)).collect()
        });
        let deepest =
            |reaches: &[Reach<'_>], place| reaches.iter().map(|reach| reach.at(place)).fold(0.0, f64::max);
        let mut strokes: Vec<Stroke> = Vec::new();
        let count = (STROKES_MAX / (self.contour.len() as u32).max(1)).clamp(1, STROKES);
        for way in &self.contour {
            let at = |part: u32| way.at(f64::from(part) / f64::from(count));
            let first = strokes.len();
            for part in 0..count {
                let place = way.at((f64::from(part) + 0.5) / f64::from(count));
                let (gouge, rest) = (deepest(&gouges, place), deepest(&rests, place));
                let deviation_mm = if gouge > rest { -gouge } else { rest };
                let end = if part + 1 == count { way.end } else { at(part + 1) };
                match strokes[first..].last_mut().filter(|last| last.deviation_mm == deviation_mm) {
                    Some(last) => last.way.end = end,
                    None => {
                        let start = if part == 0 { way.start } else { at(part) };
                        strokes.push(Stroke { way: Segment { start, end, bend: way.bend }, deviation_mm });
                    }
                }
            }
        }
        strokes
    }

    /// What is cut deeper than this.
    pub fn gouges_beyond(&self, tolerance_mm: f64) -> impl Iterator<Item = &Spot> {
        self.gouges.iter().filter(move |spot| is_beyond(spot, tolerance_mm))
    }

    /// What stands higher than this.
    pub fn rests_beyond(&self, tolerance_mm: f64) -> impl Iterator<Item = &Spot> {
        self.rests.iter().filter(move |spot| is_beyond(spot, tolerance_mm))
    }
}

/// At the limit itself a deviation is within it, however numbers were rounded.
fn is_beyond(spot: &Spot, tolerance_mm: f64) -> bool {
    spot.piece.deviation_mm > tolerance_mm + GRAIN_MM
}
