//! The section along a program: what it was at the beginning, and what replaced what, stretch of Z by stretch.
//!
//! In: each command's number and what it removed, with the section after it. Out: [`Moment`]s in order; the section at
//! any of them is the one at the beginning with the windows of all moments up to it put into their places. Edges are
//! those of the section, exact.
//!
//! Invariant: memory is bounded by [`HISTORY_MOMENTS_MAX`] and [`HISTORY_EDGES_MAX`], whatever the program's length:
//! when there is too much, every second moment is put together with the one after it, and from then on a moment stands
//! for twice as many cuts. The last moment always shows the section as it is at the end.

use turnwright_geometry::Point;

use crate::band::Band;
use crate::curve::{Curve, greater, lesser};
use crate::removed::Removed;
use crate::row::Run;
use crate::section::Section;

/// Moments that are kept.
pub const HISTORY_MOMENTS_MAX: usize = 4_000;

/// Edges that are kept, in all moments together; about 8 bytes each in a report.
pub const HISTORY_EDGES_MAX: usize = 1_000_000;

/// Pieces that came off and are kept.
pub const FALLEN_MAX: usize = 8;

/// Windows of one moment: when there are more they become one.
const WINDOWS_MAX: usize = 16;

/// What was cut, when.
#[derive(Clone, Debug)]
pub struct History {
    stock: Run,
    moments: Vec<Moment>,
    fallen: Vec<(u64, Run)>,
    limits: Limits,
    edges: usize,
    /// Cuts that a moment stands for.
    stride: u64,
    /// Cuts since the last moment, and where along Z they were.
    cuts: u64,
    changed: Vec<(f64, f64)>,
    last: u64,
}

#[derive(Clone, Copy, Debug)]
struct Limits {
    moments: usize,
    edges: usize,
}

/// The section after a command, where it is another than at the moment before.
#[derive(Clone, Debug)]
pub struct Moment {
    command: u64,
    windows: Vec<Window>,
}

/// All material between two Z.
#[derive(Clone, Debug)]
pub struct Window {
    from: f64,
    to: f64,
    run: Run,
}

/// Rings of material between two Z.
#[derive(Clone, Copy, Debug)]
pub struct Slice<'a> {
    /// Lower end.
    pub from_z: f64,
    /// Higher end.
    pub to_z: f64,
    bands: &'a [Band],
}

/// An edge of a ring between two Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// Straight.
    Line {
        /// X at the lower Z.
        from_x: f64,
        /// X at the higher Z.
        to_x: f64,
    },
    /// Part of half a circle.
    Arc {
        /// Its centre.
        centre: Point,
        /// Its radius; below zero for the half below the centre.
        radius_mm: f64,
    },
}

impl History {
    /// Nothing cut yet.
    pub fn new(section: &Section) -> Self {
        let stock = run_between(section, f64::NEG_INFINITY, f64::INFINITY);
        let limits = Limits { moments: HISTORY_MOMENTS_MAX, edges: HISTORY_EDGES_MAX };
        Self {
            stock,
            moments: Vec::new(),
            fallen: Vec::new(),
            limits,
            edges: 0,
            stride: 1,
            cuts: 0,
            changed: Vec::new(),
            last: 0,
        }
    }

    /// A command was applied; `section` is what it left.
    #[inline]
    pub fn add(&mut self, command: u64, removed: &Removed, section: &Section) {
        if removed.is_something() {
            self.add_cut(command, removed, section);
        }
    }

    fn add_cut(&mut self, command: u64, removed: &Removed, section: &Section) {
        self.last = command;
        self.cuts += 1;
        match removed.bounds {
            // What falls off lies anywhere.
            Some(bounds) if !removed.may_part => self.note(bounds.min.z, bounds.max.z),
            _ => {
                let ends = self.stock.slabs().fold((0.0, 0.0), |(from, to), (slab, _)| {
                    (lesser(from, slab.from), greater(to, slab.to))
                });
                self.note(ends.0, ends.1);
            }
        }
        if self.cuts >= self.stride {
            self.keep(section);
        }
    }

    /// A piece came off with a command.
    pub fn add_fallen(&mut self, command: u64, piece: &Section) {
        let run = run_between(piece, f64::NEG_INFINITY, f64::INFINITY);
        if self.fallen.len() < FALLEN_MAX && run.edges() <= self.limits.edges / FALLEN_MAX {
            self.fallen.push((command, run));
        }
    }

    /// The program is over.
    pub fn finish(&mut self, section: &Section) {
        if self.cuts > 0 {
            self.keep(section);
        }
    }

    /// The material before the first cut.
    pub fn stock(&self) -> impl ExactSizeIterator<Item = Slice<'_>> {
        slices(&self.stock)
    }

    /// The moments in order.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// The pieces that came off: after which command, and where they were.
    pub fn fallen(&self) -> impl Iterator<Item = (u64, impl ExactSizeIterator<Item = Slice<'_>>)> {
        self.fallen.iter().map(|(command, run)| (*command, slices(run)))
    }

    fn note(&mut self, from: f64, to: f64) {
        let (mut from, mut to) = (from, to);
        let is_full = self.changed.len() >= WINDOWS_MAX;
        self.changed.retain(|other| {
            let is_apart = !is_full && (other.1 < from || to < other.0);
            if !is_apart {
                (from, to) = (lesser(from, other.0), greater(to, other.1));
            }
            is_apart
        });
        self.changed.push((from, to));
    }

    fn keep(&mut self, section: &Section) {
        self.changed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let windows = self.changed.drain(..);
        let windows: Vec<Window> =
            windows.map(|(from, to)| Window { from, to, run: run_between(section, from, to) }).collect();
        self.edges += windows.iter().map(|window| window.run.edges()).sum::<usize>();
        self.moments.push(Moment { command: self.last, windows });
        self.cuts = 0;
        while self.moments.len() > 1
            && (self.moments.len() > self.limits.moments || self.edges > self.limits.edges)
        {
            self.thin();
        }
    }

    /// Makes one moment of two.
    fn thin(&mut self) {
        let mut moments = std::mem::take(&mut self.moments).into_iter();
        while let Some(first) = moments.next() {
            self.moments.push(match moments.next() {
                Some(second) => first.before(second),
                None => first,
            });
        }
        let windows = self.moments.iter().flat_map(|moment| &moment.windows);
        self.edges = windows.map(|window| window.run.edges()).sum();
        self.stride *= 2;
    }
}

impl Moment {
    /// The number of the command after which it is so.
    pub const fn command(&self) -> u64 {
        self.command
    }

    /// Where something changed, in order along Z.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// This moment and the next as one.
    fn before(self, next: Self) -> Self {
        let mut windows = self.windows;
        for window in &next.windows {
            windows = windows.iter().flat_map(|one| one.without(window.from, window.to)).collect();
        }
        windows.extend(next.windows);
        windows.sort_by(|a, b| a.from.total_cmp(&b.from));
        Self { command: next.command, windows }
    }
}

impl Window {
    /// Lower and higher end along Z.
    pub const fn ends(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// The material in it.
    pub fn slices(&self) -> impl ExactSizeIterator<Item = Slice<'_>> {
        slices(&self.run)
    }

    /// What is left of it on both sides of another.
    fn without(&self, from: f64, to: f64) -> impl Iterator<Item = Self> {
        let sides = [(self.from, lesser(self.to, from)), (greater(self.from, to), self.to)];
        sides.into_iter().filter(|(from, to)| from < to).map(|(from, to)| {
            let mut run = Run::default();
            clip(self.run.slabs(), from, to, &mut run);
            Self { from, to, run }
        })
    }
}

impl Slice<'_> {
    /// How many rings there are.
    pub const fn ring_count(&self) -> usize {
        self.bands.len()
    }

    /// The rings from the axis outwards, each with its inner and its outer edge.
    pub fn rings(&self) -> impl Iterator<Item = [Edge; 2]> {
        let Self { from_z, to_z, bands } = *self;
        bands.iter().map(move |band| [band.floor, band.roof].map(|edge| Edge::new(&edge, from_z, to_z)))
    }
}

impl Edge {
    fn new(curve: &Curve, from_z: f64, to_z: f64) -> Self {
        match *curve {
            Curve::Line { .. } => Self::Line { from_x: curve.at(from_z), to_x: curve.at(to_z) },
            Curve::Arc { z, x, radius } => Self::Arc { centre: Point { x, z }, radius_mm: radius },
        }
    }
}

fn slices(run: &Run) -> impl ExactSizeIterator<Item = Slice<'_>> {
    (0..run.len()).map(|index| {
        let (slab, bands) = run.slab(index);
        Slice { from_z: slab.from, to_z: slab.to, bands }
    })
}

fn run_between(section: &Section, from: f64, to: f64) -> Run {
    let mut run = Run::default();
    clip(section.row.slabs_between(from, to), from, to, &mut run);
    run
}

/// Adds what lies between two Z.
pub(crate) fn clip<'a>(
    slabs: impl Iterator<Item = (&'a crate::row::Slab, &'a [Band])>,
    from: f64,
    to: f64,
    out: &mut Run,
) {
    for (slab, bands) in slabs {
        let (from, to) = (greater(slab.from, from), lesser(slab.to, to));
        if from < to {
            bands.iter().for_each(|band| out.push_band(*band));
            out.end_slab(from, to);
        }
    }
}

#[cfg(test)]
mod tests {
    use turnwright_geometry::{Outline, Segment};

    use super::*;
    use crate::curve::Content;
    use crate::{Cutter, Sweep};

    /// A history with these limits, and the content of the section after each cut, by command number.
    fn worked(limits: Limits) -> (History, Vec<Content>) {
        let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
        let mut history = History::new(&section);
        history.limits = limits;
        let insert = Cutter::new(&Outline::circle(Point::new(2.0, 0.0), 2.0).expect("an insert"));
        let mut sweep = Sweep::new();
        let mut contents = Vec::new();
        for number in 0_u32..90 {
            // Ways here and there, deeper and deeper; every third one cuts air.
            let spread = f64::from(number * 37 % 50);
            let x = if number % 3 == 2 { 30.0 } else { 19.0 - f64::from(number) * 0.15 };
            let way = Segment {
                start: Point::new(x, -spread),
                end: Point::new(x + 0.4, -spread - f64::from(number % 7) * 2.0 - 1.0),
                bend: None,
            };
            let removed = section.cut(sweep.along(&insert, &way));
            history.add(u64::from(number), &removed, &section);
            contents.push(content(section.row.slabs()));
        }
        history.finish(&section);
        (history, contents)
    }

    fn content<'a>(slabs: impl Iterator<Item = (&'a crate::row::Slab, &'a [Band])>) -> Content {
        let mut content = Content::default();
        for (slab, bands) in slabs {
            bands.iter().for_each(|band| content += band.content(slab.from, slab.to));
        }
        content
    }

    /// Compares each moment, put together as a reader does it, with the section as it was.
    fn is_true(history: &History, contents: &[Content]) {
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let mut now = Moment {
            command: 0,
            windows: vec![Window { from: all.0, to: all.1, run: history.stock.clone() }],
        };
        for moment in history.moments() {
            now = now.before(moment.clone());
            let shown = content(now.windows.iter().flat_map(|window| window.run.slabs()));
            let was = contents[moment.command() as usize];
            assert!((shown.area_mm2 - was.area_mm2).abs() < 1e-6, "{}: {shown:?} {was:?}", moment.command());
            assert!((shown.volume_mm3 - was.volume_mm3).abs() < 1e-4, "{shown:?} {was:?}");
        }
    }

    #[test]
    fn every_moment_is_the_section_of_its_time() {
        let (history, contents) = worked(Limits { moments: 1_000, edges: 100_000 });
        assert_eq!(history.moments().len(), 60, "one for each cut, none for air");
        is_true(&history, &contents);
        assert!(history.moments().iter().all(|moment| moment.windows().len() == 1));
    }

    #[test]
    fn what_is_too_much_is_put_together_and_stays_true() {
        for limits in [Limits { moments: 10, edges: 100_000 }, Limits { moments: 1_000, edges: 600 }] {
            let (history, contents) = worked(limits);
            assert!(history.moments().len() <= limits.moments && history.edges <= limits.edges);
            assert!(history.moments().len() > 2, "{}", history.moments().len());
            is_true(&history, &contents);
            let last = history.moments().last().map(Moment::command);
            assert_eq!(last, Some(88), "the last cut is the last moment");
        }
    }

    #[test]
    fn edges_keep_their_numbers() {
        let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
        let mut history = History::new(&section);
        let ball = Outline::circle(Point::new(20.0, -30.0), 5.0).expect("a circle");
        let removed = section.cut_hole(&ball);
        history.add(7, &removed, &section);
        let slices: Vec<Slice<'_>> = history.moments()[0].windows()[0].slices().collect();
        assert_eq!((slices.len(), slices[0].from_z, slices[0].to_z), (1, -35.0, -25.0));
        let rings: Vec<[Edge; 2]> = slices[0].rings().collect();
        let arc = Edge::Arc { centre: Point::new(20.0, -30.0), radius_mm: -5.0 };
        assert_eq!(rings, [[Edge::Line { from_x: 0.0, to_x: 0.0 }, arc]]);
    }

    #[test]
    fn a_piece_that_comes_off_changes_everything_and_is_kept() {
        let mut section = Section::bar(10.0, -60.0, 0.0).expect("a bar");
        let mut history = History::new(&section);
        let blade = Outline::rectangle(Point::new(-1.0, -33.0), Point::new(12.0, -30.0)).expect("a blade");
        let removed = section.cut_hole(&blade);
        assert!(removed.may_part);
        let mut piece = section.clone();
        piece.drop_pieces(|piece| piece.bounds.min.z < -32.0);
        section.drop_pieces(|piece| piece.bounds.min.z > -32.0);
        history.add(3, &removed, &section);
        history.add_fallen(3, &piece);
        let left: Vec<Slice<'_>> = history.moments()[0].windows()[0].slices().collect();
        assert_eq!((left.len(), left[0].from_z, left[0].to_z), (1, -60.0, -33.0));
        let fallen: Vec<(u64, f64)> = history
            .fallen()
            .map(|(command, mut piece)| (command, piece.next().map_or(0.0, |one| one.from_z)))
            .collect();
        assert_eq!(fallen, [(3, -30.0)]);
    }
}
