//! The figures that finishing cycles follow: their edges, and on which side of them the part is.
//!
//! In: the commands of a run in which tools are sharp (without compensation every run is one), one by one. Out: each
//! [`Figure`] with the lines that rough and finish it, and the regions on both sides of its edges as outlines.
//!
//! The first move of the cycle only leads to the figure and is none of it, nor are rapids at its end. On which side the
//! part is, the place shows from which the cycle starts: outside of an outer contour, inside of a bore, in front of a
//! face. A figure that turns back in both directions has no such side and is left alone.
//!
//! Invariant: at most [`FIGURES_MAX`] figures of at most [`FIGURE_EDGES_MAX`] edges are kept.

use turnwright_canon::{Action, Command, Origin, Phase, SectionPlace};
use turnwright_geometry::{Bounds, Outline, Point, Segment};
use turnwright_stock::machining::edges;
use turnwright_units::{Position, WorkTip};

/// Figures that are kept; those of further finishing cycles are not looked at.
pub const FIGURES_MAX: usize = 20;

/// Edges of a figure; one that has more is not looked at.
pub const FIGURE_EDGES_MAX: usize = 1_000;

/// Cycles before a finishing cycle among which its roughing is looked for.
const CYCLES_MAX: usize = 50;

/// Places that are nearer are one, and edges that lean less are upright or level, mm.
const SAME_MM: f64 = 1e-6;

/// How far behind a wall at its end the figure guards the part, mm.
const BEHIND_WALL_MM: f64 = 5.0;

/// How far regions reach out of everything, mm.
const BEYOND_MM: f64 = 1.0;

/// What is looked at above a figure, over its highest place, mm.
const LEVEL_MM: f64 = 5e-6;

/// A line or an arc of a figure, and the line of the program that describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The line or arc.
    pub way: Segment,
    /// Where it is written.
    pub line: u32,
}

/// Where the part is, seen from its figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Towards the axis: an outer contour.
    Below,
    /// Away from the axis: a bore.
    Above,
    /// Towards lower Z: a face.
    Behind,
    /// Towards higher Z: a face on the chuck's side.
    InFront,
}

/// Number of the text and line of a block.
pub type BlockLine = (u32, u32);

/// A figure that a finishing cycle follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its lines and arcs in the order of travel, above the axis.
    pub edges: Vec<Edge>,
    /// The finishing cycle.
    pub finishing: BlockLine,
    /// The roughing cycles of the same figure.
    pub roughing: Vec<BlockLine>,
    /// The turret station that finishes.
    pub tool: u32,
    /// On which side the part is.
    pub material: Material,
}

/// What is found in a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// The figures, in the order of their finishing.
    pub found: Vec<Figure>,
    /// Finishing cycles whose figure turns back, or is too long.
    pub unclear: Vec<BlockLine>,
    /// A finishing cycle ran with nose compensation: its moves were not those of the figure, unless tools are sharp.
    pub is_compensated: bool,
}

/// Looks for figures in the commands of a run.
#[derive(Clone, Debug)]
pub struct FigureSearch {
    at: Position<WorkTip>,
    place: SectionPlace,
    tool: u32,
    /// The finishing cycle at work.
    open: Option<Open>,
    /// Cycles, and the lines of their figures that they name.
    cycles: Vec<(BlockLine, u32, u32)>,
    figures: Figures,
}

/// A finishing cycle whose figure is being collected.
#[derive(Clone, Debug)]
struct Open {
    finishing: BlockLine,
    start: Point,
    edges: Vec<Edge>,
    /// How many edges there are up to the last cutting move.
    cut: usize,
    has_approached: bool,
    is_in_section: bool,
}

impl FigureSearch {
    /// Nothing seen yet, the tool at `start`.
    pub fn new(start: Position<WorkTip>) -> Self {
        Self {
            at: start,
            place: SectionPlace::default(),
            tool: 0,
            open: None,
            cycles: Vec::new(),
            figures: Figures::default(),
        }
    }

    /// Looks at a command.
    #[inline]
    pub fn add(&mut self, command: &Command) {
        let from = self.at;
        if let Some(end) = self.place.end_of(&command.action) {
            self.at = end;
        }
        if command.origin.cycle.is_some() || self.open.is_some() {
            self.in_cycle(command, from);
        }
        match &command.action {
            Action::Tool { tool, .. } => self.tool = *tool,
            Action::Relocate { to, .. } => self.at = *to,
            _ => {}
        }
    }

    /// What was found.
    pub fn finish(&mut self) -> Figures {
        self.close();
        std::mem::take(&mut self.figures)
    }

    #[cold]
    fn in_cycle(&mut self, command: &Command, from: Position<WorkTip>) {
        let origin = &command.origin;
        let line = (origin.source, origin.line);
        let is_finishing = origin.cycle.is_some_and(|cycle| cycle.phase == Phase::Finish);
        if self.open.as_ref().is_some_and(|open| !is_finishing || open.finishing != line) {
            self.close();
        }
        if !is_finishing {
            return self.note_cycle(origin, line);
        }
        self.figures.is_compensated |= command.nose.is_some();
        let open = self.open.get_or_insert_with(|| Open {
            finishing: line,
            start: point(from),
            edges: Vec::new(),
            cut: 0,
            has_approached: false,
            is_in_section: true,
        });
        if command.action.end_point().is_none() || open.edges.len() > FIGURE_EDGES_MAX {
            return;
        }
        if !std::mem::replace(&mut open.has_approached, true) {
            return;
        }
        let line = origin.figure_line.unwrap_or(origin.line);
        let edge = |way| Edge { way, line };
        match &command.action {
            Action::Feed { shape, others: None, .. } if !self.place.is_polar() => {
                open.edges.extend(edges(from, self.at, shape).map(edge));
                open.cut = open.edges.len();
            }
            Action::Rapid { others: None, .. } => {
                let way = Segment { start: point(from), end: point(self.at), bend: None };
                open.edges.push(edge(way));
            }
            _ => open.is_in_section = false,
        }
    }

    /// Remembers between which lines the figure of a cycle lies.
    fn note_cycle(&mut self, origin: &Origin, line: BlockLine) {
        let (Some(_), Some(figure_line)) = (origin.cycle, origin.figure_line) else { return };
        match self.cycles.last_mut().filter(|(known, ..)| *known == line) {
            Some((_, first, last)) => (*first, *last) = (figure_line.min(*first), figure_line.max(*last)),
            None => {
                if self.cycles.len() == CYCLES_MAX {
                    self.cycles.remove(0);
                }
                self.cycles.push((line, figure_line, figure_line));
            }
        }
    }

    fn close(&mut self) {
        let Some(mut open) = self.open.take() else { return };
        open.edges.truncate(open.cut);
        let figures = &mut self.figures;
        if figures.found.len() + figures.unclear.len() >= FIGURES_MAX {
            return;
        }
        let lines = open.edges.iter().map(|edge| edge.line);
        let (first, last) = (lines.clone().min(), lines.max());
        let (Some(first), Some(last)) = (first, last) else { return };
        let is_same = |(line, from, to): &&(BlockLine, u32, u32)| {
            line.0 == open.finishing.0 && *from <= last && first <= *to
        };
        let roughing = self.cycles.iter().filter(is_same).map(|(line, ..)| *line).collect();
        let figure = Figure {
            finishing: open.finishing,
            roughing,
            tool: self.tool,
            edges: above_axis(open.edges),
            material: Material::Below,
        };
        let is_known = |other: &Figure| other.edges == figure.edges && other.finishing == figure.finishing;
        if figures.found.iter().any(is_known) || figures.unclear.contains(&open.finishing) {
            return;
        }
        let is_sound = open.is_in_section && figure.edges.len() <= FIGURE_EDGES_MAX;
        match is_sound.then(|| figure.turned_to(open.start)).flatten() {
            Some(figure) => figures.found.push(figure),
            None => figures.unclear.push(open.finishing),
        }
    }
}

fn point(position: Position<WorkTip>) -> Point {
    Point::new(position.x.to_mm(), position.z.to_mm())
}

/// The edges up to the axis: faces are turned a little beyond it.
fn above_axis(edges: Vec<Edge>) -> Vec<Edge> {
    let is_above = |place: Point| place.x >= -SAME_MM;
    let at_axis = |way: &Segment| {
        let share = way.start.x / (way.start.x - way.end.x);
        Point::new(0.0, way.start.z + (way.end.z - way.start.z) * share)
    };
    let mut kept = Vec::with_capacity(edges.len());
    for edge in edges {
        match (is_above(edge.way.start), is_above(edge.way.end)) {
            (true, true) => kept.push(edge),
            (true, false) => {
                let end = at_axis(&edge.way);
                kept.push(Edge { way: Segment { end, ..edge.way }, ..edge });
                break;
            }
            (false, true) => {
                let start = at_axis(&edge.way);
                kept.push(Edge { way: Segment { start, ..edge.way }, ..edge });
            }
            (false, false) => {}
        }
    }
    kept.retain(|edge| edge.way.start.distance(edge.way.end) > SAME_MM);
    kept
}

/// A place as distance along the figure and across it.
#[derive(Clone, Copy)]
struct Seen {
    along: f64,
    across: f64,
}

impl Material {
    const ALL: [Self; 4] = [Self::Below, Self::Above, Self::Behind, Self::InFront];

    /// Along the figure, and out of the part.
    const fn see(self, place: Point) -> Seen {
        match self {
            Self::Below => Seen { along: place.z, across: place.x },
            Self::Above => Seen { along: place.z, across: -place.x },
            Self::Behind => Seen { along: place.x, across: place.z },
            Self::InFront => Seen { along: place.x, across: -place.z },
        }
    }

    const fn place(self, Seen { along, across }: Seen) -> Point {
        match self {
            Self::Below => Point::new(across, along),
            Self::Above => Point::new(-across, along),
            Self::Behind => Point::new(along, across),
            Self::InFront => Point::new(along, -across),
        }
    }
}

impl Figure {
    /// The figure with the side that the start of its cycle shows; nothing when it shows none.
    fn turned_to(mut self, start: Point) -> Option<Self> {
        let is_so = |material: &Material| {
            self.material = *material;
            let ways = self.level();
            let places = || ways.iter().flat_map(|way| (0..=8).map(|part| way.at(f64::from(part) / 8.0)));
            let seen: Vec<Seen> = places().map(|place| material.see(place)).collect();
            let is_rising =
                |sign: f64| seen.windows(2).all(|pair| sign * (pair[1].along - pair[0].along) >= -SAME_MM);
            let across = seen.iter().map(|seen| seen.across).fold(f64::NEG_INFINITY, f64::max);
            !ways.is_empty()
                && (is_rising(1.0) || is_rising(-1.0))
                && material.see(start).across >= across - SAME_MM
        };
        let material = Material::ALL.iter().copied().find(is_so)?;
        self.material = material;
        Some(self)
    }

    /// The edges without walls at both ends that stand square to the figure, and without what lies on the axis.
    fn level(&self) -> Vec<Segment> {
        let is_end = |way: &Segment| {
            let (start, end) = (self.material.see(way.start), self.material.see(way.end));
            let is_wall = way.bend.is_none() && (end.along - start.along).abs() <= SAME_MM;
            is_wall || way.start.x.max(way.end.x) <= SAME_MM
        };
        let ways: Vec<Segment> = self.edges.iter().map(|edge| edge.way).collect();
        let first = ways.iter().position(|way| !is_end(way)).unwrap_or(ways.len());
        let last = ways.iter().rposition(|way| !is_end(way)).map_or(first, |last| last + 1);
        ways[first..last].to_vec()
    }

    /// Its lines and arcs, each with its ends on one circle.
    pub fn ways(&self) -> impl Iterator<Item = Segment> {
        self.edges.iter().map(|edge| even(edge.way))
    }

    /// The part as far as the figure shows it, in a rectangle that holds the stock; behind a wall at an end a little
    /// more.
    pub fn inside(&self, stock: Bounds) -> Option<Outline> {
        let far = |least: f64| self.across().fold(least, |least, across| least.min(across - BEYOND_MM));
        let across = match self.material {
            Material::Below => 0.0,
            Material::Above => far(-(stock.max.x + BEYOND_MM)),
            Material::Behind => far(stock.min.z - BEYOND_MM),
            Material::InFront => far(-(stock.max.z + BEYOND_MM)),
        };
        self.region(across, true)
    }

    /// What the figure takes away, as high as its own highest place: what stands higher the cycle may have found so.
    pub fn outside(&self) -> Option<Outline> {
        self.region(self.across().fold(f64::NEG_INFINITY, f64::max) + LEVEL_MM, false)
    }

    fn across(&self) -> impl Iterator<Item = f64> {
        let ends = self.edges.iter().flat_map(|edge| [edge.way.start, edge.way.end]);
        ends.map(|place| self.material.see(place).across)
    }

    /// What lies between the figure and a line at `across`.
    fn region(&self, across: f64, has_walls: bool) -> Option<Outline> {
        let level = self.level();
        let (first, last) = (level.first()?.start, level.last()?.end);
        let sign = (self.material.see(last).along - self.material.see(first).along).signum();
        let (front, back) = (self.edges.first()?.way.start, self.edges.last()?.way.end);
        let (mut ways, mut corners): (Vec<Segment>, Vec<Point>) = (Vec::new(), Vec::new());
        let behind = |wall: Point, end: Point, sign: f64| {
            let (wall, end) = (self.material.see(wall), self.material.see(end));
            let is_wall = has_walls && wall.across > end.across + SAME_MM;
            let corner = |along: f64| {
                let place = self.material.place(Seen { along, across: wall.across });
                Point { x: place.x.max(0.0), ..place }
            };
            is_wall.then(|| [corner(end.along), corner(end.along + sign * BEHIND_WALL_MM)])
        };
        ways.extend(level.iter().copied().map(even));
        corners.push(last);
        corners.extend(behind(back, last, sign).into_iter().flatten());
        let foot = |place: Point| self.material.place(Seen { across, ..self.material.see(place) });
        let front_wall = behind(front, first, -sign);
        corners.push(foot(corners[corners.len() - 1]));
        corners.push(foot(front_wall.map_or(first, |wall| wall[1])));
        corners.extend(front_wall.into_iter().flat_map(|[wall, behind]| [behind, wall]));
        corners.push(first);
        corners.dedup_by(|a, b| a.distance(*b) <= SAME_MM);
        ways.extend(corners.windows(2).map(|pair| Segment { start: pair[0], end: pair[1], bend: None }));
        Outline::new(ways).ok()
    }
}

/// An arc with its centre as far from one end as from the other.
fn even(way: Segment) -> Segment {
    Segment { bend: way.bend.map(|bend| bend.evened(way.start, way.end)), ..way }
}
