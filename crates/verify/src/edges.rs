//! Tools that cut where they have no edge, and what they leave behind.
//!
//! In: the cutting moves of a program with what each took away. Out: [`Fault`]s, with place and depth:
//! * the edge behind the nose of a turning insert ([`Flank`]) goes into work that stays: where the way goes in steeper than
//!   that edge stands clear, it shapes the part and not the nose;
//! * a tool feeds where it has no edge: a turning insert along an edge that lies nearly in the way, a drill across;
//! * a thin rib stands between two plunges of a blade.
//!
//! A wall that an edge left is told of only when the finished part still has it: what a later cut takes away was meant.
//! Only tools that the setup describes are looked at.
//!
//! Invariant: nothing is kept for a move but the last one of each edge, and at most [`KEPT_MAX`] places.

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, Origin};
use turnwright_control::{Flank, Tool, ToolKind, ToolSide};
use turnwright_geometry::{Bounds, Point, Segment, Vector, sweep_rad};
use turnwright_stock::machining::cutting_ways;
use turnwright_stock::{Removed, Section};
use turnwright_units::{Position, WorkTip};

/// Places that are looked at again when the part is finished, of each kind.
const KEPT_MAX: usize = 2_000;

/// An edge that goes in less deep than this has rubbed off what the nose leaves too.
const GOUGE_MM: f64 = 0.05;

/// An edge that lies in the way more than this squeezes instead of cutting, degrees.
const FLAT_DEG: f64 = 10.0;

/// A cut along such an edge that is less deep only wipes, mm.
const WIPE_MM: f64 = 1.0;

/// A drill that is pushed aside less than this only enlarges its hole, mm.
const SIDE_MM: f64 = 0.1;

/// The share of a blade's width below which what stands between two plunges is no land that somebody wants.
const RIB_PART: f64 = 1.0 / 3.0;

/// A thinner rib breaks off, mm.
const RIB_MM: f64 = 0.01;

/// How far beside an edge its wall is looked for, mm.
const BESIDE_MM: f64 = 1e-3;

/// How far behind the end of a wall the work goes on, when it does, mm.
const BEHIND_MM: f64 = 0.1;

/// Places along an edge where its wall is looked for.
const SAMPLES: u32 = 64;

/// What a tool did without an edge for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fault {
    pub(crate) key: &'static str,
    pub(crate) tool: u32,
    pub(crate) origin: Origin,
    /// Number of the command, from 0.
    pub(crate) command: u64,
    /// The programmed point.
    pub(crate) place: Point,
    /// How deep, or how thick the rib.
    pub(crate) depth_mm: f64,
    pub(crate) bounds: Bounds,
    /// Angle of the way and of the edge, degrees.
    pub(crate) angles_deg: Option<(f64, f64)>,
}

/// A move, by what it came from.
#[derive(Clone, Copy, Debug)]
struct Move {
    tool: u32,
    origin: Origin,
    command: u64,
}

/// A tool on a way that brings one of its edges further in.
#[derive(Clone, Copy, Debug)]
struct Entry {
    flank: Flank,
    is_neutral: bool,
    from: Point,
    deepest: Point,
    has_cut: bool,
    last: Move,
}

/// A stroke of a blade, across the work for a groove in the outside or the bore, along it for one in the face.
#[derive(Clone, Copy, Debug)]
struct Plunge {
    by: Move,
    /// Place along the row of grooves.
    along: f64,
    /// Where the stroke has begun to cut, and its bottom.
    top: f64,
    bottom: f64,
}

/// Follows the edges of the tools.
#[derive(Clone, Debug, Default)]
pub(crate) struct Edges {
    tools: BTreeMap<u32, Tool>,
    /// One for each edge of the tool in use that goes in.
    entries: Vec<Option<Entry>>,
    walls: Vec<Entry>,
    plunges: Vec<Plunge>,
    faults: Vec<Fault>,
}

impl Edges {
    /// Watches a tool that the setup describes.
    pub(crate) fn watch(&mut self, station: u32, tool: &Tool) {
        self.tools.insert(station, tool.clone());
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.tools.is_empty()
    }

    /// A command that has been cut out of the section, from a place, by a station.
    pub(crate) fn add(
        &mut self,
        (command, number): (&Command, u64),
        station: u32,
        (from, to): (Position<WorkTip>, Position<WorkTip>),
        removed: &Removed,
        section: &Section,
    ) {
        let Action::Feed { shape, others, .. } = &command.action else {
            if matches!(command.action, Action::Rapid { .. } | Action::Thread { .. } | Action::Tool { .. }) {
                self.withdraw(section);
            }
            return;
        };
        let Some(tool) = self.tools.get(&station) else { return };
        let by = Move { tool: station, origin: command.origin, command: number };
        if others.is_some() {
            return;
        }
        let flanks = tool.flanks.len();
        self.entries.resize(flanks, None);
        let mut ended = Vec::new();
        for way in cutting_ways(from, to, shape) {
            for (flank, entry) in tool.flanks.iter().zip(&mut self.entries) {
                follow(entry, flank, flanks > 1, &way, removed.is_something(), by, &mut ended);
            }
            let Some(bounds) = removed.bounds.filter(|_| way.bend.is_none()) else { continue };
            if self.faults.len() < KEPT_MAX {
                self.faults.extend(without_edge(tool, by, &way, bounds));
            }
            if let Some(plunge) = plunge(tool, by, &way, bounds) {
                plunge.join(&mut self.plunges);
            }
        }
        for entry in ended {
            self.keep(entry, section);
        }
    }

    /// The tool leaves the work.
    fn withdraw(&mut self, section: &Section) {
        for entry in std::mem::take(&mut self.entries).into_iter().flatten() {
            self.keep(entry, section);
        }
    }

    /// An edge that has gone in as far as it does: its wall is looked at again in the end.
    fn keep(&mut self, entry: Entry, section: &Section) {
        if entry.has_cut && self.walls.len() < KEPT_MAX && entry.fault(section).is_some() {
            self.walls.push(entry);
        }
    }

    /// What the finished part shows of it.
    pub(crate) fn finish(mut self, held: &Section, part: &Section) -> Vec<Fault> {
        self.withdraw(held);
        let mut faults = std::mem::take(&mut self.faults);
        faults.extend(self.walls.iter().filter_map(|wall| wall.fault(part)));
        faults.extend(self.ribs(part));
        faults.sort_by_key(|fault| fault.command);
        faults
    }

    /// Thin ribs between neighbouring plunges of a blade.
    fn ribs(&mut self, part: &Section) -> Vec<Fault> {
        let order = |a: &Plunge, b: &Plunge| a.by.tool.cmp(&b.by.tool).then(a.along.total_cmp(&b.along));
        self.plunges.sort_by(order);
        let rib = |two: &[Plunge]| {
            let [one, other] = *two else { return None };
            let tool = self.tools.get(&one.by.tool).filter(|_| one.by.tool == other.by.tool)?;
            let (is_face, cutting) = (tool.side == ToolSide::Face, tool.cutting.bounds());
            let (low, high) =
                if is_face { (cutting.min.x, cutting.max.x) } else { (cutting.min.z, cutting.max.z) };
            let (from, to) = (one.along + high, other.along + low);
            let thick = to - from;
            if !(RIB_MM..RIB_PART * (high - low)).contains(&thick) {
                return None;
            }
            // As deep as both are.
            let sign = if one.bottom < one.top { 1.0 } else { -1.0 };
            let bottom = if sign > 0.0 { one.bottom.max(other.bottom) } else { one.bottom.min(other.bottom) };
            let top = if sign > 0.0 { one.top.min(other.top) } else { one.top.max(other.top) };
            let depth = (top - bottom) * sign;
            let place = |along: f64, across: f64| {
                if is_face { Point { x: along, z: across } } else { Point { x: across, z: along } }
            };
            let middle = (from + to) / 2.0;
            let across = (top + bottom) / 2.0;
            let stands = depth > GOUGE_MM
                && part.contains(place(middle, across))
                && !part.contains(place(from - (high - low) / 2.0, across))
                && !part.contains(place(to + (high - low) / 2.0, across));
            let last = if one.by.command > other.by.command { one.by } else { other.by };
            stands.then(|| Fault {
                key: "rib-left-standing",
                tool: last.tool,
                origin: last.origin,
                command: last.command,
                place: place(middle, top),
                depth_mm: thick,
                bounds: Bounds { min: place(from, bottom.min(top)), max: place(to, bottom.max(top)) },
                angles_deg: None,
            })
        };
        self.plunges.windows(2).filter_map(rib).collect()
    }
}

impl Plunge {
    /// Pecks at one place are one plunge.
    fn join(self, plunges: &mut Vec<Self>) {
        let is_same =
            |known: &&mut Self| known.by.tool == self.by.tool && (known.along - self.along).abs() < 1e-6;
        if let Some(known) = plunges.iter_mut().rev().find(is_same) {
            let is_down = self.bottom < self.top;
            let outer = |a: f64, b: f64| if is_down { a.max(b) } else { a.min(b) };
            let inner = |a: f64, b: f64| if is_down { a.min(b) } else { a.max(b) };
            (known.top, known.bottom) = (outer(known.top, self.top), inner(known.bottom, self.bottom));
        } else if plunges.len() < KEPT_MAX {
            plunges.push(self);
        }
    }
}

impl Entry {
    /// The wall that the edge has left where it went in furthest, when a section has it, and how much too deep it is.
    fn fault(&self, section: &Section) -> Option<Fault> {
        let Self { flank, from, deepest, .. } = self;
        let (way, length) = (flank.way(), flank.near.distance(flank.far));
        let origin = Vector { x: deepest.x, z: deepest.z };
        let near = origin.from(flank.near);
        let at = |along: f64, outward: f64| flank.outward.times(outward).from(way.times(along).from(near));
        let is_wall = |along: f64| {
            let (work, air) = (at(along, BESIDE_MM), at(along, -BESIDE_MM));
            work.x > 0.0 && section.contains(work) && !section.contains(air)
        };
        // It begins beside the nose and goes on to the surface that the edge went in through.
        let step = length / f64::from(SAMPLES);
        let first = (0..4).find(|index| is_wall(step * (f64::from(*index) + 0.5)))?;
        let mut end = step * (f64::from(first) + 0.5);
        while end + step < length && is_wall(end + step) {
            end += step;
        }
        let (mut low, mut high) = (end, (end + step).min(length));
        for _ in 0..20 {
            let middle = (low + high) / 2.0;
            if is_wall(middle) { low = middle } else { high = middle }
        }
        // A wall that ends in a face across is what facing leaves; one that ends in a land was cut into it.
        let end = at(low, BESIDE_MM);
        let goes_on = Vector { x: 0.2 * flank.outward.x.signum(), z: way.z.signum() };
        if !section.contains(goes_on.times(BEHIND_MM).from(end)) {
            return None;
        }
        let chord = Vector::between(*from, *deepest);
        let inward = chord.dot(flank.outward) / chord.length();
        let depth_mm = (low * inward).min(low * way.z.abs());
        let back = chord.times(-1.0);
        let angle_deg = libm::atan2(back.x.abs(), back.z * way.z.signum()).to_degrees();
        let is_meant = self.is_neutral && !(1e-6..90.0 - 1e-6).contains(&angle_deg);
        (depth_mm > GOUGE_MM && !is_meant).then(|| Fault {
            key: "insert-back-cuts",
            tool: self.last.tool,
            origin: self.last.origin,
            command: self.last.command,
            place: *deepest,
            depth_mm,
            bounds: Bounds { min: near, max: near }.with(end),
            angles_deg: Some((angle_deg, flank.clear_deg())),
        })
    }
}

/// Follows an edge along a way; entries that are over are put to those that ended.
fn follow(
    entry: &mut Option<Entry>,
    flank: &Flank,
    is_neutral: bool,
    way: &Segment,
    has_cut: bool,
    by: Move,
    ended: &mut Vec<Entry>,
) {
    let turning = turning_point(flank, way);
    let ends = [turning, Some(way.end)];
    let mut at = way.start;
    for end in ends.into_iter().flatten() {
        let inward = Vector::between(at, end).dot(flank.outward);
        if inward > 1e-9 {
            let known = entry.get_or_insert(Entry {
                flank: *flank,
                is_neutral,
                from: at,
                deepest: at,
                has_cut: false,
                last: by,
            });
            known.deepest = end;
            known.has_cut |= has_cut;
            if has_cut {
                known.last = by;
            }
        } else if inward < -1e-9 {
            ended.extend(entry.take());
        }
        at = end;
    }
}

/// Where an arc brings an edge further in than at its ends, or less far.
fn turning_point(flank: &Flank, way: &Segment) -> Option<Point> {
    let bend = way.bend?;
    let radius = bend.centre.distance(way.start);
    let sweep = |to: Point| sweep_rad(way.start, to, bend.centre, bend.clockwise).abs();
    let whole = sweep(way.end);
    let candidates = [radius, -radius].map(|arm| flank.outward.times(arm).from(bend.centre));
    candidates.into_iter().find(|place| {
        let part = sweep(*place) / whole;
        (1e-9..1.0 - 1e-9).contains(&part)
    })
}

/// A feed for which the tool has no edge.
fn without_edge(tool: &Tool, by: Move, way: &Segment, bounds: Bounds) -> Option<Fault> {
    let line = Vector::between(way.start, way.end);
    let (high, wide) = (bounds.max.x - bounds.min.x, bounds.max.z - bounds.min.z);
    let (depth_mm, least_mm, angles_deg) = match tool.kind {
        ToolKind::Drilling | ToolKind::Tapping if line.x.abs() > SIDE_MM => (high.min(wide), SIDE_MM, None),
        ToolKind::Turning => {
            let flank = tool.flanks.first()?;
            let (inward, along) =
                (line.dot(flank.outward) / line.length(), line.dot(flank.way()) / line.length());
            let angle_deg = libm::asin(inward.clamp(-1.0, 1.0)).to_degrees();
            if !(along > 0.0 && angle_deg > 0.0 && angle_deg < FLAT_DEG) {
                return None;
            }
            let depth = if line.z.abs() > line.x.abs() { high } else { wide };
            (depth, WIPE_MM, Some((angle_deg, FLAT_DEG)))
        }
        _ => return None,
    };
    (depth_mm > least_mm).then_some(Fault {
        key: "feed-without-edge",
        tool: by.tool,
        origin: by.origin,
        command: by.command,
        place: way.start,
        depth_mm,
        bounds,
        angles_deg,
    })
}

/// A stroke of a blade straight into the work.
fn plunge(tool: &Tool, by: Move, way: &Segment, bounds: Bounds) -> Option<Plunge> {
    if !matches!(tool.kind, ToolKind::Grooving | ToolKind::CutOff) {
        return None;
    }
    let (down, back) = (way.start.x - way.end.x, way.start.z - way.end.z);
    let (along, into, top) = match tool.side {
        ToolSide::Outside => (back, down, bounds.max.x),
        ToolSide::Inside => (back, -down, bounds.min.x),
        ToolSide::Face => (down, back, bounds.max.z),
    };
    let is_face = tool.side == ToolSide::Face;
    (along.abs() < 1e-6 && into > GOUGE_MM).then_some(Plunge {
        by,
        along: if is_face { way.start.x } else { way.start.z },
        top,
        bottom: if is_face { way.end.z } else { way.end.x },
    })
}
