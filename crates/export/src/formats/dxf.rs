//! Section and path as DXF (release 12, which every CAD and CAM system reads): lines and arcs on named layers.
//!
//! In: a [`PartShape`] and the outline of its stock, or a recorded path. Out: one text. X of the drawing is Z of the
//! machine, Y is the radius, lengths are millimetres. The section is the half above the axis; its arcs are arcs.
//!
//! | layer | holds |
//! |---|---|
//! | `PART` | the finished half-section, threads as their crests; nothing on the axis |
//! | `THREAD` | the lines through the roots of threads |
//! | `STOCK` | what the part was cut from |
//! | `CENTRE` | the spindle axis |
//! | `RAPID`, `FEED`, `THREADING` | the path |

use std::collections::HashSet;
use std::f64::consts::TAU;
use std::fmt::Write;

use turnwright_geometry::{Outline, Point, Segment};

use crate::part::PartShape;
use crate::path::{PathRecorder, SegmentKind};

/// Strokes in the file of a path; what lies on each other counts once.
pub const STROKES_MAX: usize = 200_000;

/// Coordinates of a path are kept in single precision: to a tenth of a micrometre.
const PATH_DECIMALS: i32 = 4;
/// Those of the section to a nanometre.
const PART_DECIMALS: i32 = 6;

/// What lies on the axis is no edge of a half-section, mm.
const AXIS_MM: f64 = 1e-6;

/// How far the centre line stands out, a share of the length.
const OVERHANG: f64 = 0.05;

/// A layer: its name, its colour by number, its line type.
struct Layer(&'static str, u8, &'static str);

const PART: Layer = Layer("PART", 7, "CONTINUOUS");
const THREAD: Layer = Layer("THREAD", 3, "CONTINUOUS");
const STOCK: Layer = Layer("STOCK", 8, "PHANTOM");
const CENTRE: Layer = Layer("CENTRE", 1, "CENTER");
const RAPID: Layer = Layer("RAPID", 1, "DASHED");
const FEED: Layer = Layer("FEED", 5, "CONTINUOUS");
const THREADING: Layer = Layer("THREADING", 3, "CONTINUOUS");

/// Line types: their names, what they look like in words, dashes and gaps in mm.
const LINE_TYPES: [(&str, &str, &[f64]); 4] = [
    ("CONTINUOUS", "Solid line", &[]),
    ("DASHED", "__ __ __", &[2.0, -1.0]),
    ("CENTER", "____ _ ____", &[6.0, -1.0, 1.0, -1.0]),
    ("PHANTOM", "____ _ _ ____", &[6.0, -1.0, 1.0, -1.0, 1.0, -1.0]),
];

/// The half-section of a part and its stock.
pub fn write_part_dxf(shape: &PartShape, stock: Option<&Outline>) -> String {
    let mut dxf = Drawing::new("half-section of the part", &[PART, THREAD, STOCK, CENTRE], PART_DECIMALS);
    let edges = shape.loops.iter().flatten().map(|edge| (&PART, edge));
    let stock = stock.map(|stock| stock.segments()).unwrap_or_default().iter().map(|edge| (&STOCK, edge));
    let is_off_axis = |edge: &Segment| edge.bend.is_some() || edge.start.x.max(edge.end.x) > AXIS_MM;
    for (layer, edge) in edges.chain(stock).filter(|(_, edge)| is_off_axis(edge)) {
        let centre = edge.bend.map(|bend| bend.centre);
        dxf.stroke(layer, edge.start, edge.end, centre.map(|centre| (centre, edge.sweep_rad())));
    }
    for root in shape.threads.iter().flat_map(|thread| thread.root.windows(2)) {
        dxf.stroke(&THREAD, root[0], root[1], None);
    }
    dxf.centre_line(shape.z);
    dxf.finish()
}

/// The path of the tool tip.
pub fn write_path_dxf(path: &PathRecorder) -> String {
    let mut dxf = Drawing::new("path of the tool tip", &[RAPID, FEED, THREADING, CENTRE], PATH_DECIMALS);
    let place = |point: crate::path::Point| Point::new(point.radius_mm.into(), point.z_mm.into());
    let mut seen = HashSet::new();
    let mut is_whole = path.segments_dropped() == 0;
    for segment in path.segments() {
        let layer = match segment.kind {
            SegmentKind::Rapid => &RAPID,
            SegmentKind::Feed => &FEED,
            SegmentKind::Thread => &THREADING,
        };
        let (start, end) = (place(segment.start), place(segment.end));
        let bow = segment.bow.map(|bow| (place(bow.centre), f64::from(bow.sweep_rad)));
        let spot = |place: Point| [place.x, place.z].map(|mm| dxf.grains(mm));
        let ends = (spot(start), spot(end));
        let bend = bow.map(|(centre, sweep)| (spot(centre), sweep.abs() > TAU / 2.0));
        if !seen.insert((ends.0.min(ends.1), ends.0.max(ends.1), bend, layer.0)) {
            continue;
        }
        if dxf.strokes >= STROKES_MAX {
            is_whole = false;
            break;
        }
        dxf.stroke(layer, start, end, bow);
    }
    if let Some(extents) = path.cutting_extents().or(path.extents()) {
        dxf.centre_line((extents.z_min_mm, extents.z_max_mm));
    }
    if !is_whole {
        dxf.comment("the path is longer: only its first part is here");
    }
    dxf.finish()
}

/// A drawing being written.
struct Drawing {
    text: String,
    decimals: i32,
    strokes: usize,
}

impl Drawing {
    fn new(what: &str, layers: &[Layer], decimals: i32) -> Self {
        let mut drawing = Self { text: String::new(), decimals, strokes: 0 };
        drawing.comment(&format!("turnwright: {what}; mm; X is Z of the machine, Y is the radius"));
        drawing.groups(&[(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (0, "ENDSEC")]);
        drawing.groups(&[(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE")]);
        drawing.group(70, LINE_TYPES.len());
        for (name, look, dashes) in LINE_TYPES {
            drawing.groups(&[(0, "LTYPE"), (2, name), (70, "0"), (3, look), (72, "65")]);
            drawing.group(73, dashes.len());
            drawing.group(40, dashes.iter().map(|dash| dash.abs()).sum::<f64>());
            dashes.iter().for_each(|dash| drawing.group(49, dash));
        }
        drawing.groups(&[(0, "ENDTAB"), (0, "TABLE"), (2, "LAYER")]);
        drawing.group(70, layers.len());
        for Layer(name, colour, line_type) in layers {
            drawing.groups(&[(0, "LAYER"), (2, name), (70, "0")]);
            drawing.group(62, colour);
            drawing.group(6, line_type);
        }
        drawing.groups(&[(0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]);
        drawing
    }

    fn group(&mut self, code: u16, value: impl std::fmt::Display) {
        let _ = write!(self.text, "{code}\n{value}\n");
    }

    fn groups(&mut self, groups: &[(u16, &str)]) {
        groups.iter().for_each(|(code, value)| self.group(*code, value));
    }

    fn comment(&mut self, words: &str) {
        self.group(999, words);
    }

    /// A length in the smallest steps that are written.
    fn grains(&self, mm: f64) -> i64 {
        (mm * 10f64.powi(self.decimals)).round() as i64
    }

    fn length(&self, mm: f64) -> f64 {
        self.grains(mm) as f64 / 10f64.powi(self.decimals)
    }

    fn place(&mut self, codes: (u16, u16), place: Point) {
        self.group(codes.0, self.length(place.z));
        self.group(codes.1, self.length(place.x));
    }

    /// A line, or the arc round a centre with its angle, which is below zero when it is clockwise.
    fn stroke(&mut self, layer: &Layer, start: Point, end: Point, bow: Option<(Point, f64)>) {
        let is_closed =
            self.grains(start.x) == self.grains(end.x) && self.grains(start.z) == self.grains(end.z);
        let Some((centre, sweep_rad)) = bow else {
            if !is_closed {
                self.groups(&[(0, "LINE"), (8, layer.0)]);
                self.place((10, 20), start);
                self.place((11, 21), end);
                self.strokes += 1;
            }
            return;
        };
        let is_circle = is_closed && sweep_rad.abs() > TAU / 2.0;
        if is_closed && !is_circle {
            return;
        }
        self.groups(&[(0, if is_circle { "CIRCLE" } else { "ARC" }), (8, layer.0)]);
        self.place((10, 20), centre);
        self.group(40, self.length(centre.distance(start)));
        if !is_circle {
            // Arcs of the format run counter-clockwise.
            let (from, to) = if sweep_rad > 0.0 { (start, end) } else { (end, start) };
            for (code, place) in [(50, from), (51, to)] {
                let degrees = (place.x - centre.x).atan2(place.z - centre.z).to_degrees().rem_euclid(360.0);
                self.group(code, (degrees * 1e9).round() / 1e9);
            }
        }
        self.strokes += 1;
    }

    fn centre_line(&mut self, (back, front): (f64, f64)) {
        let overhang = OVERHANG * (front - back);
        self.stroke(&CENTRE, Point::new(0.0, back - overhang), Point::new(0.0, front + overhang), None);
    }

    fn finish(mut self) -> String {
        self.groups(&[(0, "ENDSEC"), (0, "EOF")]);
        self.text
    }
}
