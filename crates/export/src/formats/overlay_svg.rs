//! A part with what is too much or too little of it in colour, as SVG: two parts of an edit, or a part on its target.
//!
//! In: the loops of the part in grey, coloured regions, the line that the part is held against, numbered marks with a
//! sentence each. Out: one SVG text with nothing outside itself: chuck left, Z to the right, both halves of the section,
//! one scale for both.

use std::collections::BTreeMap;
use std::fmt::Write;

use turnwright_geometry::{Point, Segment};

use super::svg::{FONT_FAMILY, escape_xml};
use crate::Language;

const WIDTH_PX: f64 = 1200.0;
const HEIGHT_PX: f64 = 640.0;
const MARGIN_PX: f64 = 60.0;
const TOP_PX: f64 = 110.0;
const SCALE_PX: f64 = 34.0;
const LINE_PX: f64 = 22.0;

/// Marks that are drawn.
pub const MARKS_MAX: usize = 20;

/// A coloured part of the section.
#[derive(Clone, Debug)]
pub struct Region {
    /// Which colour of the legend.
    pub colour: usize,
    /// A closed loop.
    pub edges: Vec<Segment>,
}

/// A numbered place with its sentence.
#[derive(Clone, Debug)]
pub struct OverlayMark {
    /// Where.
    pub place: Point,
    /// What is there.
    pub text: String,
}

/// A stroke of the line that the part is held against, in the colour of its deviation.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// The line or arc.
    pub way: Segment,
    /// Its colour.
    pub colour: &'static str,
}

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// Heading, usually the file's name.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The loops of the part.
    pub loops: Vec<Vec<Segment>>,
    /// What the part is held against, as a line.
    pub figure: Vec<Segment>,
    /// The same line in colours, instead of dashes.
    pub strokes: Vec<Stroke>,
    /// What is in colour.
    pub regions: Vec<Region>,
    /// Colours with their meaning.
    pub legend: Vec<(&'static str, String)>,
    /// Colours of the strokes with their meaning.
    pub scale: Vec<(&'static str, String)>,
    /// Numbered places.
    pub marks: Vec<OverlayMark>,
    /// Language of the document.
    pub language: Language,
}

/// The scale and where zero lies.
struct Sheet {
    px_per_mm: f64,
    zero_px: f64,
    axis_px: f64,
}

impl Sheet {
    fn place(&self, place: Point, side: f64) -> (f64, f64) {
        (self.zero_px + place.z * self.px_per_mm, self.axis_px - side * place.x * self.px_per_mm)
    }
}

/// Draws the overlay.
pub fn write_overlay_svg(overlay: &Overlay) -> String {
    let edges = || {
        let regions = overlay.regions.iter().flat_map(|region| &region.edges);
        overlay.loops.iter().flatten().chain(regions).chain(&overlay.figure)
    };
    let places = || edges().flat_map(|edge| [edge.start, edge.at(0.5), edge.end]);
    let radius = places().map(|place| place.x).fold(0.1, f64::max);
    let back = places().map(|place| place.z).fold(f64::INFINITY, f64::min);
    let front = places().map(|place| place.z).fold(f64::NEG_INFINITY, f64::max);
    let (back, front) = if back < front { (back, front) } else { (-1.0, 0.0) };
    let top_px = if overlay.scale.is_empty() { TOP_PX } else { TOP_PX + SCALE_PX };
    let free = (WIDTH_PX - 2.0 * MARGIN_PX, HEIGHT_PX - top_px - MARGIN_PX);
    let px_per_mm = (free.0 / (front - back)).min(free.1 / (2.0 * radius));
    let sheet = Sheet {
        px_per_mm,
        zero_px: WIDTH_PX / 2.0 - (front + back) / 2.0 * px_per_mm,
        axis_px: top_px + radius * px_per_mm,
    };
    let marks = &overlay.marks[..overlay.marks.len().min(MARKS_MAX)];
    let list_px = sheet.axis_px + radius * px_per_mm + 40.0;
    let height_px = list_px + LINE_PX * marks.len() as f64 + 20.0;
    let mut svg = String::with_capacity(16_384);
    let (title, subtitle) = (escape_xml(&overlay.title), escape_xml(&overlay.subtitle));
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px:.0}\" \
         viewBox=\"0 0 {WIDTH_PX} {height_px:.0}\" font-family=\"'{FONT_FAMILY}', sans-serif\" font-size=\"14\" \
         role=\"img\" xml:lang=\"{}\">\n<title>{title}</title>\n<desc>{subtitle}</desc>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{MARGIN_PX}\" y=\"32\" font-size=\"18\" font-weight=\"bold\">{title}</text>\n\
         <text class=\"subtitle\" x=\"{MARGIN_PX}\" y=\"54\">{subtitle}</text>\n",
        overlay.language.tag()
    );
    write_legend(&mut svg, "legend", 68.0, &overlay.legend);
    write_legend(&mut svg, "scale", 90.0, &overlay.scale);
    let mut data = String::new();
    for side in [1.0, -1.0] {
        overlay.loops.iter().for_each(|edges| write_edges(&mut data, &sheet, edges, side));
    }
    let _ = writeln!(
        svg,
        "<path class=\"part\" d=\"{data}\" fill=\"#e3e8ed\" fill-rule=\"evenodd\" stroke=\"#55606c\" stroke-width=\"1.2\"/>"
    );
    for (colour, (fill, _)) in overlay.legend.iter().enumerate() {
        let mut data = String::new();
        for region in overlay.regions.iter().filter(|region| region.colour == colour) {
            for side in [1.0, -1.0] {
                write_edges(&mut data, &sheet, &region.edges, side);
            }
        }
        // The edge of a thin region is all that is seen of it.
        let _ = writeln!(
            svg,
            "<path class=\"region\" d=\"{data}\" fill=\"{fill}\" fill-opacity=\"0.75\" stroke=\"{fill}\" stroke-width=\"1.6\"/>"
        );
    }
    let mut data = String::new();
    for side in [1.0, -1.0] {
        write_edges(&mut data, &sheet, &overlay.figure, side);
    }
    let _ = writeln!(
        svg,
        "<path class=\"figure\" d=\"{data}\" fill=\"none\" stroke=\"#111\" stroke-width=\"1\" stroke-dasharray=\"7 4\"/>"
    );
    write_strokes(&mut svg, &sheet, &overlay.strokes);
    let (left, right) = (sheet.zero_px + back * px_per_mm - 24.0, sheet.zero_px + front * px_per_mm + 24.0);
    let _ = writeln!(
        svg,
        "<path class=\"centre-line\" d=\"M{left:.2} {axis:.2}H{right:.2}\" stroke=\"#333\" stroke-dasharray=\"16 4 3 4\"/>",
        axis = sheet.axis_px
    );
    for (index, mark) in marks.iter().enumerate() {
        write_mark(&mut svg, &sheet, index + 1, mark, list_px + LINE_PX * index as f64);
    }
    svg.push_str("</svg>\n");
    svg
}

fn write_legend(svg: &mut String, class: &str, y: f64, entries: &[(&'static str, String)]) {
    let mut x = MARGIN_PX;
    for (fill, text) in entries {
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.0}\" y=\"{y:.0}\" width=\"16\" height=\"12\" fill=\"{fill}\" fill-opacity=\"0.75\"/>\n\
             <text class=\"{class}\" x=\"{:.0}\" y=\"{:.0}\">{}</text>",
            x + 22.0,
            y + 11.0,
            escape_xml(text)
        );
        let width: f64 = text.chars().map(|c| if c.is_ascii() { 7.5 } else { 14.0 }).sum();
        x += width + 48.0;
    }
}

/// Strokes of one colour are one path.
fn write_strokes(svg: &mut String, sheet: &Sheet, strokes: &[Stroke]) {
    let mut paths: BTreeMap<&str, String> = BTreeMap::new();
    for stroke in strokes {
        let data = paths.entry(stroke.colour).or_default();
        for side in [1.0, -1.0] {
            write_edges(data, sheet, &[stroke.way], side);
        }
    }
    for (colour, data) in paths {
        let _ = writeln!(
            svg,
            "<path class=\"deviation\" d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.4\"/>"
        );
    }
}

fn write_mark(svg: &mut String, sheet: &Sheet, number: usize, mark: &OverlayMark, y_list: f64) {
    let (x, y) = sheet.place(mark.place, 1.0);
    let (up_x, up_y) = (x + 14.0, y - 22.0);
    let _ = writeln!(
        svg,
        "<path d=\"M{x:.1} {y:.1}L{up_x:.1} {up_y:.1}\" stroke=\"#111\"/>\n\
         <circle cx=\"{up_x:.1}\" cy=\"{up_y:.1}\" r=\"10\" fill=\"#fff\" stroke=\"#111\"/>\n\
         <text x=\"{up_x:.1}\" y=\"{:.1}\" font-size=\"12\" text-anchor=\"middle\">{number}</text>\n\
         <text class=\"mark\" x=\"{MARGIN_PX}\" y=\"{y_list:.1}\">{number}: {}</text>",
        up_y + 4.0,
        escape_xml(&mark.text)
    );
}

/// Edges as path data, above the axis or below it.
fn write_edges(data: &mut String, sheet: &Sheet, edges: &[Segment], side: f64) {
    let mut pen = None;
    for edge in edges {
        if pen != Some(edge.start) {
            let (x, y) = sheet.place(edge.start, side);
            let _ = write!(data, "M{x:.2} {y:.2}");
        }
        let (x, y) = sheet.place(edge.end, side);
        match edge.bend {
            None => {
                let _ = write!(data, "L{x:.2} {y:.2}");
            }
            Some(bend) => {
                let radius = bend.centre.distance(edge.start) * sheet.px_per_mm;
                let is_long = u8::from(edge.sweep_rad().abs() > std::f64::consts::PI);
                let flag = u8::from(bend.clockwise == (side > 0.0));
                let _ = write!(data, "A{radius:.3} {radius:.3} 0 {is_long} {flag} {x:.2} {y:.2}");
            }
        }
        pen = Some(edge.end);
    }
}
