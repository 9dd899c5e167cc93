//! The drawing of the part as SVG: a full section, hatched, with centre line, threads by convention, the stock it was
//! cut from dash-dotted, and its main sizes.
//!
//! In: a [`PartShape`] and the outline of the stock. Out: one SVG text with nothing outside itself: chuck left, Z to
//! the right, one scale for both. Diameters, grooves, threads, radii, chamfers and tapers are pointed at from above
//! (outside) and from below (bores), lengths are measured from the front face. What finds no room is left out, details first;
//! the sizes of the table are all there.

use std::fmt::Write;

use turnwright_geometry::{Outline, Point, Segment};

use super::svg::{FONT_FAMILY, escape_xml};
use crate::Language;
use crate::part::{PartShape, Thread, taper_text, thousandths};
use crate::words::Words;

/// Width of the drawing, and the least and greatest height of it.
const WIDTH_PX: f64 = 1200.0;
const HEIGHT_PX: f64 = 800.0;

const MARGIN_PX: f64 = 60.0;
/// Above the part: heading and two rows of what points at its outside. Below it: two rows for bores, and the lengths.
const TOP_PX: f64 = 156.0;
const ROW_PX: f64 = 26.0;
/// From the part to the nearer row of texts: here the pointers bend to where they point.
const BEND_PX: f64 = 46.0;
/// Between texts, and between a text and the pointer of another.
const GAP_PX: f64 = 5.0;
const TEXT_PX: f64 = 14.0;

/// Lengths that are drawn, the whole one included.
const LENGTHS_MAX: usize = 7;

/// What is drawn.
#[derive(Clone, Debug)]
pub struct PartDrawing<'a> {
    /// The part.
    pub shape: &'a PartShape,
    /// What it was cut from.
    pub stock: Option<&'a Outline>,
    /// Heading, usually the file's name.
    pub title: String,
    /// Language of the words in it.
    pub language: Language,
}

/// The scale and where zero lies.
pub(super) struct Sheet {
    pub(super) px_per_mm: f64,
    pub(super) zero_px: f64,
    pub(super) axis_px: f64,
}

impl Sheet {
    pub(super) fn x(&self, z_mm: f64) -> f64 {
        self.zero_px + z_mm * self.px_per_mm
    }

    pub(super) fn y(&self, radius_mm: f64) -> f64 {
        self.axis_px - radius_mm * self.px_per_mm
    }
}

/// Draws the part.
pub fn write_part_svg(drawing: &PartDrawing<'_>) -> String {
    let PartDrawing { shape, stock, .. } = *drawing;
    let words = Words::new(drawing.language);
    let lengths = lengths(shape);
    let has_inside = pointers(shape, true).next().is_some();
    let inside_px = if has_inside { BEND_PX + ROW_PX + TEXT_PX } else { 0.0 };
    let below_px = inside_px + ROW_PX * (lengths.len() as f64 + 1.5);
    let of_stock = stock.map(Outline::bounds);
    let radius = of_stock.map_or(0.0, |stock| stock.max.x).max(shape.diameter_mm / 2.0).max(0.1);
    let back = of_stock.map_or(shape.z.0, |stock| stock.min.z.min(shape.z.0));
    let front = of_stock.map_or(shape.z.1, |stock| stock.max.z.max(shape.z.1));
    let free = (WIDTH_PX - 2.0 * MARGIN_PX, HEIGHT_PX - TOP_PX - below_px - 30.0);
    let px_per_mm = (free.0 / (front - back).max(0.1)).min(free.1 / (2.0 * radius));
    let sheet = Sheet {
        px_per_mm,
        zero_px: WIDTH_PX / 2.0 - (front + back) / 2.0 * px_per_mm,
        axis_px: TOP_PX + radius * px_per_mm,
    };
    let bottom_px = sheet.y(-radius);
    let height_px = bottom_px + below_px + 20.0;

    let mut svg = String::with_capacity(16_384);
    let title = escape_xml(&drawing.title);
    let description = escape_xml(words.get("part-description"));
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px:.0}\" \
         viewBox=\"0 0 {WIDTH_PX} {height_px:.0}\" font-family=\"'{FONT_FAMILY}', sans-serif\" \
         font-size=\"{TEXT_PX}\" role=\"img\">\n<title>{title}</title>\n<desc>{description}</desc>\n\
         <defs><pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" \
         patternTransform=\"rotate(45)\"><rect width=\"7\" height=\"7\" fill=\"#f4f6f8\"/>\
         <path d=\"M0 0V7\" stroke=\"#6b7785\" stroke-width=\"1\"/></pattern>\
         <marker id=\"arrow\" viewBox=\"0 0 10 6\" refX=\"10\" refY=\"3\" markerWidth=\"10\" markerHeight=\"6\" \
         orient=\"auto-start-reverse\"><path d=\"M0 0L10 3L0 6z\" fill=\"#333\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    write_heading(&mut svg, drawing, &words);
    write_section(&mut svg, &sheet, shape);
    if let Some(stock) = stock {
        let mut data = String::new();
        for side in [1.0, -1.0] {
            write_loop(&mut data, &sheet, stock.segments(), side, true);
        }
        let look = "fill=\"none\" stroke=\"#8a5a00\" stroke-width=\"1\" stroke-dasharray=\"12 3 2 3 2 3\"";
        let _ = writeln!(svg, "<path class=\"stock\" d=\"{data}\" {look}/>");
    }
    let (left, right, axis) = (sheet.x(back) - 24.0, sheet.x(front) + 24.0, sheet.axis_px);
    let _ = writeln!(
        svg,
        "<path class=\"centre-line\" d=\"M{left:.2} {axis:.2}H{right:.2}\" stroke=\"#333\" stroke-width=\"1\" \
         stroke-dasharray=\"16 4 3 4\"/>"
    );
    for thread in &shape.threads {
        write_thread(&mut svg, &sheet, thread);
    }
    write_pointers(&mut svg, &sheet, shape, bottom_px);
    for (row, z) in lengths.iter().enumerate() {
        let y = bottom_px + inside_px + ROW_PX * (row as f64 + 1.5);
        write_length(&mut svg, &sheet, shape, (*z, shape.z.1), y);
    }
    svg.push_str("</svg>\n");
    svg
}

/// Z of what is measured from the front face, from the nearest to the farthest.
fn lengths(shape: &PartShape) -> Vec<f64> {
    let mut lengths: Vec<f64> = shape.faces.iter().copied().filter(|z| shape.z.1 - z > 1e-3).collect();
    lengths.retain(|z| z - shape.z.0 > 1e-3);
    lengths.truncate(LENGTHS_MAX - 1);
    lengths.push(shape.z.0);
    lengths
}

fn write_heading(svg: &mut String, drawing: &PartDrawing<'_>, words: &Words) {
    let shape = drawing.shape;
    let size = format!(
        "⌀{} × {} mm · {} {} cm³",
        mm(shape.diameter_mm),
        mm(shape.z.1 - shape.z.0),
        words.get("part-volume"),
        mm(shape.volume_mm3 / 1000.0)
    );
    let _ = writeln!(
        svg,
        "<text x=\"{MARGIN_PX}\" y=\"30\" font-size=\"18\" font-weight=\"bold\">{}</text>\n\
         <text class=\"size\" x=\"{MARGIN_PX}\" y=\"52\">{}</text>",
        escape_xml(&drawing.title),
        escape_xml(&size)
    );
}

/// Both halves, hatched; edges on the axis are none. Behind a bore its edges are seen.
fn write_section(svg: &mut String, sheet: &Sheet, shape: &PartShape) {
    let (mut area, mut edges, mut seen) = (String::new(), String::new(), String::new());
    for edges_of in &shape.loops {
        for side in [1.0, -1.0] {
            write_loop(&mut area, sheet, edges_of, side, false);
            write_loop(&mut edges, sheet, edges_of, side, true);
        }
        for edge in edges_of {
            // A floor, or a face that ends at one: what lies behind the bore is seen across it.
            let is_floor = edge.end.z - edge.start.z > 1e-6;
            for place in [edge.start, edge.end].into_iter().filter(|place| is_floor && place.x > 1e-6) {
                let (x, top, bottom) = (sheet.x(place.z), sheet.y(place.x), sheet.y(-place.x));
                let is_open = |other: &Segment| other.start.x.max(other.end.x) <= place.x + 1e-6;
                let covers = |other: &&Segment| {
                    other.start.z.min(other.end.z) < place.z - 1e-6
                        && other.start.z.max(other.end.z) > place.z + 1e-6
                        && is_open(other)
                };
                if shape.loops.iter().flatten().find(covers).is_none() {
                    let _ = write!(seen, "M{x:.2} {top:.2}V{bottom:.2}");
                }
            }
        }
    }
    let _ = writeln!(
        svg,
        "<path class=\"section\" d=\"{area}\" fill=\"url(#hatch)\" fill-rule=\"evenodd\"/>\n\
         <path class=\"behind\" d=\"{seen}\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.2\"/>\n\
         <path class=\"edges\" d=\"{edges}\" fill=\"none\" stroke=\"#111\" stroke-width=\"2\" \
         stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
    );
}

/// A loop as path data, above the axis or below it.
pub(super) fn write_loop(data: &mut String, sheet: &Sheet, edges: &[Segment], side: f64, without_axis: bool) {
    let place = |place: Point| (sheet.x(place.z), sheet.y(side * place.x));
    let mut pen = None;
    for edge in edges {
        if without_axis && edge.start.x.max(edge.end.x) < 1e-6 {
            continue;
        }
        if pen != Some(edge.start) {
            let (x, y) = place(edge.start);
            let _ = write!(data, "M{x:.2} {y:.2}");
        }
        let (x, y) = place(edge.end);
        match edge.bend {
            None => {
                let _ = write!(data, "L{x:.2} {y:.2}");
            }
            Some(bend) => {
                let radius = bend.centre.distance(edge.start) * sheet.px_per_mm;
                let is_long = u8::from(edge.sweep_rad().abs() > std::f64::consts::PI);
                // Clockwise with X up is clockwise on the screen; in the lower half it is the other way.
                let flag = u8::from(bend.clockwise == (side > 0.0));
                let _ = write!(data, "A{radius:.3} {radius:.3} 0 {is_long} {flag} {x:.2} {y:.2}");
            }
        }
        pen = Some(edge.end);
    }
}

fn write_thread(svg: &mut String, sheet: &Sheet, thread: &Thread) {
    let mut data = String::new();
    for side in [1.0, -1.0] {
        for (index, place) in thread.root.iter().enumerate() {
            let pen = if index == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{pen}{:.2} {:.2}", sheet.x(place.z), sheet.y(side * place.x));
        }
    }
    let look = "fill=\"none\" stroke=\"#111\" stroke-width=\"0.9\"";
    let _ = writeln!(svg, "<path class=\"thread\" d=\"{data}\" {look}/>");
}

/// A text that points at a surface.
struct Pointer {
    at: Point,
    text: String,
    /// Of two that have no room, the one with less of it goes.
    weight: f64,
}

/// What points at the outside, or at the bores.
fn pointers(shape: &PartShape, is_inside: bool) -> impl Iterator<Item = Pointer> + '_ {
    let of_cylinders = shape.cylinders.iter().filter(move |one| one.is_inside == is_inside).map(|one| {
        let at = Point::new(one.diameter_mm / 2.0, (one.z.0 + one.z.1) / 2.0);
        let diameter = format!("⌀{}", mm(one.diameter_mm));
        let text = match one.groove_mm {
            Some(width) => format!("{}×{diameter}", mm(width)),
            None => diameter,
        };
        Pointer { at, text, weight: 1e6 + one.z.1 - one.z.0 }
    });
    let of_threads = shape.threads.iter().filter(move |one| one.is_inside == is_inside).map(|one| {
        let at = Point::new(one.crest_mm / 2.0, (one.z.0 + one.z.1) / 2.0);
        Pointer { at, text: thread_text(one), weight: f64::INFINITY }
    });
    let of_details = shape.details.iter().filter(move |one| one.is_inside == is_inside);
    let of_details = of_details.map(|one| Pointer { at: one.place, text: one.text(), weight: one.length_mm });
    of_cylinders.chain(of_threads).chain(of_details)
}

/// Places for texts in two rows that take turns, in their order along the part: none upon another, nor upon the pointer
/// of another. `None` when they are too many for the width.
fn places(pointers: &[(f64, f64)]) -> Option<Vec<f64>> {
    // The least distance from a text to the one before it and to the one before that.
    let next = |a: f64, b: f64| a.max(b) + GAP_PX;
    let row = |a: f64, b: f64| a + b + 2.0 * GAP_PX;
    let least = |places: &[f64], index: usize| {
        let half = |index: usize| pointers[index].1;
        let mut least = GAP_PX + half(index);
        if index > 0 {
            least = least.max(places[index - 1] + next(half(index - 1), half(index)));
        }
        if index > 1 {
            least = least.max(places[index - 2] + row(half(index - 2), half(index)));
        }
        least
    };
    let mut places: Vec<f64> = Vec::with_capacity(pointers.len());
    for (index, (wanted, _)) in pointers.iter().enumerate() {
        places.push(wanted.max(least(&places, index)));
    }
    // Those that leave the sheet push the others back.
    for index in (0..places.len()).rev() {
        let half = |index: usize| pointers[index].1;
        let mut most = WIDTH_PX - GAP_PX - half(index);
        if index + 1 < places.len() {
            most = most.min(places[index + 1] - next(half(index), half(index + 1)));
        }
        if index + 2 < places.len() {
            most = most.min(places[index + 2] - row(half(index), half(index + 2)));
        }
        places[index] = places[index].min(most);
    }
    places.iter().zip(pointers).all(|(place, (_, half))| place - half >= 0.0).then_some(places)
}

fn write_pointers(svg: &mut String, sheet: &Sheet, shape: &PartShape, bottom_px: f64) {
    for is_inside in [false, true] {
        let mut pointers: Vec<Pointer> = pointers(shape, is_inside).collect();
        pointers.sort_by(|a, b| a.at.z.total_cmp(&b.at.z));
        let found = loop {
            let wanted: Vec<(f64, f64)> =
                pointers.iter().map(|one| (sheet.x(one.at.z), half_width(&one.text))).collect();
            if let Some(places) = places(&wanted) {
                break places;
            }
            let weights = pointers.iter().enumerate().map(|(index, one)| (index, one.weight));
            let lightest = weights.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
            pointers.remove(lightest);
        };
        for (index, (x, pointer)) in found.iter().zip(&pointers).enumerate() {
            let row = if index.is_multiple_of(2) { 0.0 } else { ROW_PX };
            let side = if is_inside { -1.0 } else { 1.0 };
            let (to_x, to_y) = (sheet.x(pointer.at.z), sheet.y(side * pointer.at.x));
            // From the text straight to where the rows end, over to its place, and straight to the surface.
            let (y_text, y_line, y_rows, y_part) = if is_inside {
                let near = bottom_px + BEND_PX;
                (near + row + TEXT_PX - 3.0, near + row, near - 4.0, bottom_px + 8.0)
            } else {
                let near = TOP_PX - BEND_PX;
                (near - row, near - row + 5.0, near + 6.0, TOP_PX - 8.0)
            };
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.2} {y_line:.2}V{y_rows:.2}L{to_x:.2} {y_part:.2}V{to_y:.2}\" fill=\"none\" stroke=\"#333\" \
                 stroke-width=\"0.8\" marker-end=\"url(#arrow)\"/>\n\
                 <text class=\"diameter\" x=\"{x:.2}\" y=\"{y_text:.2}\" text-anchor=\"middle\" stroke=\"#fff\" \
                 stroke-width=\"4\" paint-order=\"stroke\">{}</text>",
                escape_xml(&pointer.text)
            );
        }
    }
}

/// The words of a thread: its name, when it is a metric one of the table, else its diameters and its lead; starts, taper.
pub fn thread_text(thread: &Thread) -> String {
    if let Some(name) = thread.name() {
        return name;
    }
    let starts = if thread.starts > 1 { format!(" ({}×)", thread.starts) } else { String::new() };
    let taper = thread.taper_deg().map_or_else(String::new, |angle| format!(" {}", taper_text(angle)));
    format!("⌀{}/{} × {}{starts}{taper}", mm(thread.crest_mm), mm(thread.root_mm), mm(thread.lead_mm))
}

fn half_width(text: &str) -> f64 {
    text.chars().count() as f64 * TEXT_PX * 0.31
}

fn write_length(svg: &mut String, sheet: &Sheet, shape: &PartShape, z: (f64, f64), y: f64) {
    let (left, right) = (sheet.x(z.0), sheet.x(z.1));
    // The lines that lead out begin at the edge of the part.
    let edge = |z: f64| {
        let ends = shape.loops.iter().flatten().filter(|edge| (edge.start.z - z).abs() < 1e-6);
        sheet.y(-ends.map(|edge| edge.start.x).fold(0.0, f64::max))
    };
    let (from_left, from_right) = (edge(z.0), edge(z.1));
    let _ = writeln!(
        svg,
        "<path d=\"M{left:.2} {from_left:.2}V{end:.2}M{right:.2} {from_right:.2}V{end:.2}\" stroke=\"#9aa3ad\" \
         stroke-width=\"0.6\"/>\n\
         <path d=\"M{left:.2} {y:.2}H{right:.2}\" stroke=\"#333\" stroke-width=\"0.8\" \
         marker-start=\"url(#arrow)\" marker-end=\"url(#arrow)\"/>\n\
         <text class=\"length\" x=\"{middle:.2}\" y=\"{text_y:.2}\" text-anchor=\"middle\" stroke=\"#fff\" \
         stroke-width=\"4\" paint-order=\"stroke\">{}</text>",
        mm(z.1 - z.0),
        end = y + 5.0,
        middle = (left + right) / 2.0,
        text_y = y - 4.0,
    );
}

/// Thousandths of a millimetre, without zeros that say nothing.
pub fn mm(value: f64) -> String {
    thousandths(value)
}
