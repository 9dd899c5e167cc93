//! The part in the report: its section along the program, the tools, what stands around, its sizes, its stock.
//!
//! In: a [`History`] and the outlines. Out: JSON whose long columns of numbers the script takes to pieces; its first
//! page says how. Lengths are millimetres, X as a radius, to the nanometre.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use turnwright_geometry::{Bounds, Outline, Point};
use turnwright_stock::History;
use turnwright_stock::history::{Edge, Slice};
use turnwright_stock::machining::{Obstacle, ToolShape};

use super::path::Column;
use crate::formats::part_svg::{PartDrawing, thread_text, write_part_svg};
use crate::part::PartShape;
use crate::path::Move;
use crate::wound::Wound;

/// What the report shows of the part.
#[derive(Clone, Debug)]
pub struct ReportPart<'a> {
    /// Its section along the program.
    pub history: &'a History,
    /// Its sizes.
    pub shape: &'a PartShape,
    /// What it was cut from.
    pub stock: &'a Outline,
    /// The tools by station; 0 before any is called.
    pub tools: &'a BTreeMap<u32, ToolShape>,
    /// What stands around the work.
    pub obstacles: &'a [(Obstacle, Outline)],
    /// Whether it can be seen in space too, which takes 0.6 MB.
    pub has_solid: bool,
    /// The finished part with its threads as they wind.
    pub wound: Option<Wound>,
    /// The number of the command with which it came off, when it did.
    pub parted: Option<u64>,
}

/// Where in the section a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceMark {
    /// Number of the command, from 0.
    pub command: u64,
    /// Where the programmed point is.
    pub place: Point,
    /// How deep, mm.
    pub depth_mm: f64,
    /// Round what is hit.
    pub bounds: Option<Bounds>,
}

impl ReportPart<'_> {
    /// The part as JSON, with moments in moves done, and nothing later than the last of the moves but the end.
    pub(super) fn json(&self, moves: &[Move]) -> String {
        let Self { history, shape, tools, obstacles, .. } = *self;
        let mut stock = Column::default();
        push_slices(&mut stock, history.stock());
        let mut changes = Column::default();
        for moment in history.moments() {
            changes.push_whole(moves_done(moves, moment.command()) as i64);
            changes.push_whole(moment.windows().len() as i64);
            for window in moment.windows() {
                let (from, to) = window.ends();
                changes.push_nm(from);
                changes.push_nm(to);
                push_slices(&mut changes, window.slices());
            }
        }
        let mut fallen = Column::default();
        for (command, slices) in history.fallen() {
            fallen.push_whole(moves_done(moves, command) as i64);
            push_slices(&mut fallen, slices);
        }
        let tools: BTreeMap<String, Value> = tools
            .iter()
            .map(|(station, tool)| {
                let body = tool.body.as_ref().map(outline_json);
                (station.to_string(), json!({ "cutting": outline_json(&tool.cutting), "body": body }))
            })
            .collect();
        let obstacles: Vec<Value> = obstacles
            .iter()
            .map(|(obstacle, outline)| json!({ "kind": obstacle_word(*obstacle), "outline": outline_json(outline) }))
            .collect();
        let head = json!({
            "outline": outline_json(self.stock), "tools": tools, "obstacles": obstacles,
            "sizes": sizes_json(shape),
        });
        let mut json = head.to_string();
        json.truncate(json.len() - 1);
        for (name, column) in [("stock", stock), ("changes", changes), ("fallen", fallen)] {
            column.write(name, &mut json);
        }
        if let Some(wound) = &self.wound {
            let step = self.parted.map(|command| moves_done(moves, command));
            json.push_str(&format!(",\n\"wound\":{}", wound_json(wound, step)));
        }
        json.push('}');
        json
    }

    /// The finished part as a drawing, for a reader without scripts.
    pub(super) fn drawing(&self, title: &str, language: crate::Language) -> String {
        let Self { shape, stock, .. } = *self;
        write_part_svg(&PartDrawing { shape, stock: Some(stock), title: title.to_owned(), language })
    }
}

impl PlaceMark {
    pub(super) fn json(&self, moves: &[Move]) -> Value {
        let Self { place, depth_mm, bounds, command } = *self;
        let bounds = bounds.map(|bounds| [bounds.min.x, bounds.min.z, bounds.max.x, bounds.max.z]);
        json!({
            "step": moves_done(moves, command), "x": place.x, "z": place.z, "depth": depth_mm, "bounds": bounds,
        })
    }
}

/// How many of the moves are done after a command.
fn moves_done(moves: &[Move], command: u64) -> usize {
    moves.partition_point(|one| u64::from(one.command) <= command)
}

/// Their number; of each its two Z, the number of its rings, and each ring's inner and outer edge: 0 and X where it is
/// level, 1 and X at both Z where it is straight, 2 with centre Z, centre X and radius where it is an arc.
fn push_slices<'a>(column: &mut Column, slices: impl ExactSizeIterator<Item = Slice<'a>>) {
    column.push_whole(slices.len() as i64);
    for slice in slices {
        column.push_nm(slice.from_z);
        column.push_nm(slice.to_z);
        column.push_whole(slice.ring_count() as i64);
        for edge in slice.rings().flatten() {
            match edge {
                Edge::Line { from_x, to_x } if from_x == to_x => {
                    column.push_whole(0);
                    column.push_nm(from_x);
                }
                Edge::Line { from_x, to_x } => {
                    column.push_whole(1);
                    column.push_nm(from_x);
                    column.push_nm(to_x);
                }
                Edge::Arc { centre, radius_mm } => {
                    column.push_whole(2);
                    column.push_nm(centre.z);
                    column.push_nm(centre.x);
                    column.push_nm(radius_mm);
                }
            }
        }
    }
}

/// After which move the part comes off, if it does; of each shell whether its profiles are closed, of each profile how
/// many corners it has and their Z and X, in micrometres from the one before, and how it is joined to the next: a bit for
/// each triangle, 1 where its base is in this one, four to a digit, the first the highest.
fn wound_json(wound: &Wound, step: Option<usize>) -> Value {
    let shells = wound.rings.iter().map(|profiles| {
        let mut corners = Vec::new();
        let mut joints = Vec::with_capacity(profiles.len());
        let mut is_ring = false;
        for profile in profiles {
            is_ring = profile.is_ring;
            corners.push(profile.count as i64);
            let mut before = (0, 0);
            for corner in &wound.corners[profile.first..profile.first + profile.count] {
                let Point { x, z } = corner.place;
                let here = ((z * 1e3).round() as i64, (x * 1e3).round() as i64);
                corners.extend([here.0 - before.0, here.1 - before.1]);
                before = here;
            }
            let digit = |four: &[bool]| {
                let bits = (0..4).map(|at| u32::from(four.get(at).copied().unwrap_or(false)) << (3 - at));
                char::from_digit(bits.sum(), 16).unwrap_or('0')
            };
            joints.push(profile.is_base_here.chunks(4).map(digit).collect::<String>());
        }
        json!({ "closed": is_ring, "corners": corners, "joints": joints })
    });
    json!({ "step": step, "shells": shells.collect::<Vec<_>>() })
}

/// Each segment as its start, Z and X, and, where it is an arc, its centre and the angle that it turns.
fn outline_json(outline: &Outline) -> Value {
    let segments = outline.segments().iter().map(|segment| match segment.bend {
        None => json!([segment.start.z, segment.start.x]),
        Some(bend) => {
            json!([segment.start.z, segment.start.x, bend.centre.z, bend.centre.x, segment.sweep_rad()])
        }
    });
    Value::Array(segments.collect())
}

const fn obstacle_word(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::Chuck => "chuck",
        Obstacle::Jaws => "jaws",
        Obstacle::Tailstock => "tailstock",
    }
}

/// The rows of the table of sizes: key of what it is, diameter as a drawing says it, from and to along Z.
fn sizes_json(shape: &PartShape) -> Value {
    let whole = json!({
        "diameter": shape.diameter_mm, "length": shape.z.1 - shape.z.0, "z": [shape.z.1, shape.z.0],
        "volume": shape.volume_mm3,
    });
    let cylinders = shape.cylinders.iter().map(|one| {
        let kind = if one.is_inside { "bore" } else { "cylinder" };
        json!({ "kind": kind, "diameter": one.diameter_mm, "z": [one.z.1, one.z.0] })
    });
    let threads = shape.threads.iter().map(|one| {
        let kind = if one.is_inside { "inside-thread" } else { "thread" };
        let root = one.root_mm;
        json!({ "kind": kind, "diameter": one.crest_mm, "text": thread_text(one), "root": root, "z": [one.z.1, one.z.0] })
    });
    let faces = shape.faces.iter().map(|z| json!({ "kind": "face", "z": [z, z] }));
    json!({ "whole": whole, "rows": cylinders.chain(threads).chain(faces).collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use turnwright_stock::Section;

    use super::*;

    #[test]
    fn the_section_is_there_in_columns_of_numbers() {
        let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
        let stock = Outline::rectangle(Point::new(0.0, -60.0), Point::new(20.0, 0.0)).expect("an outline");
        let mut history = History::new(&section);
        let ball = Outline::circle(Point::new(20.0, -30.0), 5.0).expect("a circle");
        let removed = section.cut_hole(&ball);
        history.add(7, &removed, &section);
        let shape = PartShape::new(&section, &section, &[]).expect("a part");
        let tools = BTreeMap::from([(3, ToolShape { cutting: ball.clone(), body: None })]);
        let obstacles = [(Obstacle::Jaws, stock.clone())];
        let part = ReportPart {
            history: &history,
            shape: &shape,
            stock: &stock,
            tools: &tools,
            obstacles: &obstacles,
            has_solid: false,
            wound: None,
            parted: None,
        };
        let json: Value = serde_json::from_str(&part.json(&[])).expect("JSON");
        // One slab, its Z, one ring from the axis to 20 mm.
        assert_eq!(json["stock"], json!([1, -60, 0, 1, 0, 0, 0, 20]));
        // After no move one window, with one slab whose roof is the lower half of the circle.
        assert_eq!(json["changes"], json!([0, 1, -35, -25, 1, -35, -25, 1, 0, 0, 2, -30, 20, -5]));
        assert_eq!(json["fallen"], json!([]));
        assert_eq!(json["tools"]["3"]["cutting"].as_array().map(Vec::len), Some(ball.segments().len()));
        assert_eq!(json["obstacles"][0]["kind"], "jaws");
        assert_eq!(json["sizes"]["whole"]["diameter"], 40.0);
    }
}
