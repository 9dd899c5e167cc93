//! The moment of a crash or a gouge from close by, as SVG.
//!
//! In: the section that the tool met, what of it is in the way, the tool with its holder, its way, what stands around, and
//! the words of the finding. Out: one SVG text with nothing outside itself: chuck left, Z to the right, X up, one scale for
//! both; the depth is dimensioned where the finding's rectangle has it as a side.
//!
//! Invariant: what is drawn of the section is what the window shows, so that a picture stays small.

use std::fmt::Write;

use turnwright_geometry::{Bounds, Outline, Point, Segment, Vector};
use turnwright_stock::Section;
use turnwright_stock::machining::{Obstacle, ToolShape};

use super::part_svg::{Sheet, mm, write_loop};
use super::svg::{FONT_FAMILY, escape_xml, text_width_px};
use crate::Language;
use crate::words::Words;

const WIDTH_PX: f64 = 1000.0;
const HEIGHT_PX: f64 = 760.0;
const MARGIN_PX: f64 = 30.0;
const TEXT_PX: f64 = 14.0;
const LINE_PX: f64 = 20.0;

/// Lines of the message that are shown.
const LINES_MAX: usize = 3;

/// What is hit takes this share of the window, which shows no less than this, mm.
const SHARE: f64 = 0.22;
const LEAST_MM: f64 = 8.0;

/// What is drawn.
#[derive(Clone, Debug)]
pub struct CrashPicture<'a> {
    /// Heading, usually the file's name.
    pub title: String,
    /// The line of the program, from 1, and what it says.
    pub line: (u32, String),
    /// The finding's words.
    pub message: String,
    /// What the tool met.
    pub section: &'a Section,
    /// What of it is in the way.
    pub hit: Option<&'a Section>,
    /// The tool, when it was at the place.
    pub tool: Option<&'a ToolShape>,
    /// Where the programmed point was, or the place of the part.
    pub place: Point,
    /// The lines and arcs of the move.
    pub way: &'a [Segment],
    /// What stands around.
    pub obstacles: &'a [(Obstacle, Outline)],
    /// How deep, mm.
    pub depth_mm: f64,
    /// Round what is hit.
    pub bounds: Option<Bounds>,
    /// Language of the words in it.
    pub language: Language,
}

/// Draws the picture.
pub fn write_crash_svg(picture: &CrashPicture<'_>) -> String {
    let words = Words::new(picture.language);
    let message = wrapped(&picture.message, WIDTH_PX - 2.0 * MARGIN_PX);
    let top_px = 76.0 + LINE_PX * message.len() as f64;
    let (width, height) = (WIDTH_PX - 2.0 * MARGIN_PX, HEIGHT_PX - top_px - 60.0);
    let Bounds { min, max } = picture.bounds.unwrap_or(Bounds { min: picture.place, max: picture.place });
    let focus = Point { x: (min.x + max.x) / 2.0, z: (min.z + max.z) / 2.0 };
    let least = LEAST_MM / width.min(height);
    let mm_per_px = ((max.z - min.z) / width / SHARE).max((max.x - min.x) / height / SHARE).max(least);
    let px_per_mm = 1.0 / mm_per_px;
    let sheet = Sheet {
        px_per_mm,
        zero_px: MARGIN_PX + width / 2.0 - focus.z * px_per_mm,
        axis_px: top_px + height / 2.0 + focus.x * px_per_mm,
    };
    let half_mm = width / 2.0 * mm_per_px;
    let (from, to) = (focus.z - half_mm - mm_per_px, focus.z + half_mm + mm_per_px);

    let mut svg = String::with_capacity(8_192);
    let title = escape_xml(&picture.title);
    let line = words.get("crash-line").replace("{line}", &picture.line.0.to_string());
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{HEIGHT_PX}\" \
         viewBox=\"0 0 {WIDTH_PX} {HEIGHT_PX}\" font-family=\"'{FONT_FAMILY}', sans-serif\" font-size=\"{TEXT_PX}\" \
         role=\"img\" xml:lang=\"{}\">\n<title>{title}</title>\n<desc>{}</desc>\n\
         <defs><clipPath id=\"window\"><rect x=\"{MARGIN_PX}\" y=\"{top_px}\" width=\"{width}\" height=\"{height}\"/></clipPath>\
         <pattern id=\"hatch\" width=\"9\" height=\"9\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
         <rect width=\"9\" height=\"9\" fill=\"#f4f6f8\"/><path d=\"M0 0V9\" stroke=\"#8a95a1\"/></pattern>\
         <marker id=\"arrow\" viewBox=\"0 0 10 6\" refX=\"10\" refY=\"3\" markerWidth=\"10\" markerHeight=\"6\" \
         orient=\"auto-start-reverse\"><path d=\"M0 0L10 3L0 6z\" fill=\"context-stroke\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{MARGIN_PX}\" y=\"30\" font-size=\"18\" font-weight=\"bold\">{title} · {line}</text>\n\
         <text class=\"block\" x=\"{MARGIN_PX}\" y=\"52\" fill=\"#555\">{}</text>\n",
        picture.language.tag(),
        escape_xml(&picture.message),
        escape_xml(&picture.line.1),
    );
    for (row, text) in message.iter().enumerate() {
        let y = 76.0 + LINE_PX * row as f64;
        let _ =
            writeln!(svg, "<text class=\"message\" x=\"{MARGIN_PX}\" y=\"{y}\">{}</text>", escape_xml(text));
    }
    svg.push_str("<g clip-path=\"url(#window)\">\n");
    let shown = picture.section.between(from, to);
    write_path(
        &mut svg,
        "section",
        &sheet,
        &loops(&shown),
        "fill=\"url(#hatch)\" fill-rule=\"evenodd\" stroke=\"#222\" stroke-width=\"1.6\"",
    );
    for (_, outline) in picture.obstacles {
        write_path(
            &mut svg,
            "obstacle",
            &sheet,
            &[outline.segments().to_vec()],
            "fill=\"#9a9486\" fill-opacity=\"0.8\" stroke=\"#555\"",
        );
    }
    if let Some(hit) = picture.hit {
        write_path(
            &mut svg,
            "hit",
            &sheet,
            &loops(&hit.between(from, to)),
            "fill=\"#d22\" fill-opacity=\"0.55\" stroke=\"#d22\" stroke-width=\"1.4\"",
        );
    }
    let end = picture.way.last().map(|way| way.end).filter(|end| end.distance(picture.place) > mm_per_px);
    if let Some(tool) = picture.tool {
        let ends = end.map(|end| {
            (end, "end", "fill=\"none\" stroke=\"#8a5a00\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"")
        });
        let here = (
            picture.place,
            "tool",
            "fill=\"#f2b632\" fill-opacity=\"0.55\" stroke=\"#8a5a00\" stroke-width=\"1.6\"",
        );
        for (at, class, look) in ends.into_iter().chain([here]) {
            let moved = |outline: &Outline| outline.moved(Vector { x: at.x, z: at.z }).segments().to_vec();
            if let Some(body) = &tool.body {
                let look = if class == "tool" {
                    "fill=\"#9a9486\" fill-opacity=\"0.4\" stroke=\"#555\""
                } else {
                    look
                };
                write_path(&mut svg, "holder", &sheet, &[moved(body)], look);
            }
            write_path(&mut svg, class, &sheet, &[moved(&tool.cutting)], look);
        }
    }
    let mut data = String::new();
    write_loop(&mut data, &sheet, picture.way, 1.0, false);
    let _ = writeln!(
        svg,
        "<path class=\"way\" d=\"{data}\" fill=\"none\" stroke=\"#c0392b\" stroke-width=\"1.6\" marker-end=\"url(#arrow)\"/>"
    );
    let _ = writeln!(
        svg,
        "<path class=\"centre-line\" d=\"M0 {0:.2}H{WIDTH_PX}\" stroke=\"#333\" stroke-dasharray=\"16 4 3 4\"/>",
        sheet.axis_px
    );
    let (x, y) = (sheet.x(picture.place.z), sheet.y(picture.place.x));
    let _ = writeln!(
        svg,
        "<path class=\"place\" d=\"M{:.1} {y:.1}h16m-8 -8v16\" stroke=\"#111\" stroke-width=\"1.4\"/>\n{}</g>",
        x - 8.0,
        label(
            (x + 12.0, y + 20.0),
            "start",
            &format!("X{} Z{}", mm(2.0 * picture.place.x), mm(picture.place.z))
        ),
    );
    match picture.bounds {
        Some(bounds) => write_depth(&mut svg, &sheet, bounds, picture.depth_mm),
        None => svg.push_str(&label((x + 12.0, y + 38.0), "start", &format!("{} mm", mm(picture.depth_mm)))),
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{MARGIN_PX}\" y=\"{top_px}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#999\"/>"
    );
    let half_x = height / 2.0 * mm_per_px;
    let window =
        Bounds { min: Point { x: focus.x - half_x, z: from }, max: Point { x: focus.x + half_x, z: to } };
    write_legend(&mut svg, picture, window, end.is_some(), &words);
    svg.push_str("</svg>\n");
    svg
}

fn loops(section: &Section) -> Vec<Vec<Segment>> {
    section.contours().into_iter().map(|contour| contour.segments).collect()
}

/// Closed loops, above the axis and below it.
fn write_path(svg: &mut String, class: &str, sheet: &Sheet, loops: &[Vec<Segment>], look: &str) {
    let mut data = String::new();
    for side in [1.0, -1.0] {
        // A tool is above the axis only.
        if side > 0.0 || matches!(class, "section" | "obstacle" | "hit") {
            loops.iter().for_each(|edges| write_loop(&mut data, sheet, edges, side, false));
        }
    }
    let _ = writeln!(svg, "<path class=\"{class}\" d=\"{data}\" {look}/>");
}

/// The rectangle of what is hit, and the side of it that is the depth.
fn write_depth(svg: &mut String, sheet: &Sheet, Bounds { min, max }: Bounds, depth_mm: f64) {
    const OFF_PX: f64 = 26.0;
    let (left, right, top, bottom) = (sheet.x(min.z), sheet.x(max.z), sheet.y(max.x), sheet.y(min.x));
    let _ = writeln!(
        svg,
        "<rect class=\"bounds\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"none\" stroke=\"#d22\" stroke-dasharray=\"4 3\"/>",
        right - left,
        bottom - top
    );
    let is_side = |side: f64| (side - depth_mm).abs() < 1e-3;
    let text = format!("{} mm", mm(depth_mm));
    let arrows =
        "stroke=\"#d22\" stroke-width=\"1.2\" marker-start=\"url(#arrow)\" marker-end=\"url(#arrow)\"";
    if is_side(max.x - min.x) {
        let at = right + OFF_PX;
        let _ = writeln!(
            svg,
            "<path d=\"M{right:.2} {top:.2}H{end:.2}M{right:.2} {bottom:.2}H{end:.2}\" stroke=\"#d22\" stroke-width=\"0.7\"/>\n\
             <path class=\"depth\" d=\"M{at:.2} {top:.2}V{bottom:.2}\" {arrows}/>\n{}",
            label((at + 8.0, (top + bottom) / 2.0 + 5.0), "start", &text),
            end = at + 6.0,
        );
    } else if is_side(max.z - min.z) {
        let at = top - OFF_PX;
        let _ = writeln!(
            svg,
            "<path d=\"M{left:.2} {top:.2}V{end:.2}M{right:.2} {top:.2}V{end:.2}\" stroke=\"#d22\" stroke-width=\"0.7\"/>\n\
             <path class=\"depth\" d=\"M{left:.2} {at:.2}H{right:.2}\" {arrows}/>\n{}",
            label(((left + right) / 2.0, at - 7.0), "middle", &text),
            end = at - 6.0,
        );
    } else {
        let _ = writeln!(svg, "{}", label((right + 10.0, top - 6.0), "start", &text));
    }
}

/// A text that stays readable on whatever lies below it.
fn label((x, y): (f64, f64), anchor: &str, text: &str) -> String {
    format!(
        "<text class=\"label\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-weight=\"bold\" stroke=\"#fff\" \
         stroke-width=\"4\" paint-order=\"stroke\">{}</text>\n",
        escape_xml(text)
    )
}

/// What the colours mean; `window` is what the picture shows.
fn write_legend(svg: &mut String, picture: &CrashPicture<'_>, window: Bounds, has_end: bool, words: &Words) {
    const LEGEND_PX: f64 = 12.0;
    let is_seen = |(_, outline): &(Obstacle, Outline)| outline.bounds().meets(&window, 0.0);
    let has_holder = picture.tool.is_some_and(|tool| tool.body.is_some());
    let (has_tool, has_hit) = (picture.tool.is_some(), picture.hit.is_some());
    let entries = [
        (has_hit, "crash-hit", "fill=\"#d22\" fill-opacity=\"0.55\""),
        (
            !has_hit && picture.bounds.is_some(),
            "crash-bounds",
            "fill=\"none\" stroke=\"#d22\" stroke-dasharray=\"4 3\"",
        ),
        (has_tool, "crash-tool", "fill=\"#f2b632\" fill-opacity=\"0.55\" stroke=\"#8a5a00\""),
        (has_tool && has_end, "crash-end", "fill=\"none\" stroke=\"#8a5a00\" stroke-dasharray=\"6 4\""),
        (
            has_holder || picture.obstacles.iter().any(is_seen),
            "crash-holder",
            "fill=\"#9a9486\" fill-opacity=\"0.6\"",
        ),
        (!picture.way.is_empty(), "crash-way", "fill=\"#c0392b\""),
    ];
    let mut x = MARGIN_PX;
    for (_, key, look) in entries.into_iter().filter(|(is_shown, ..)| *is_shown) {
        let text = words.get(key);
        let height = if key == "crash-way" { 2.0 } else { 12.0 };
        let y = HEIGHT_PX - 30.0 + (12.0 - height) / 2.0;
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.0}\" y=\"{y:.0}\" width=\"18\" height=\"{height}\" {look}/>\
             <text class=\"legend\" x=\"{:.0}\" y=\"{:.0}\" font-size=\"{LEGEND_PX}\">{}</text>",
            x + 23.0,
            HEIGHT_PX - 20.0,
            escape_xml(text)
        );
        x += 23.0 + text_width_px(text, LEGEND_PX) + 10.0;
    }
}

/// A text in lines no longer than this, broken at spaces where it has some.
fn wrapped(text: &str, width_px: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_inclusive([' ', '，', '。', '：']) {
        let last = lines.len() - 1;
        let is_long = text_width_px(&lines[last], TEXT_PX) + text_width_px(word, TEXT_PX) > width_px;
        if is_long && !lines[last].is_empty() {
            lines.push(word.to_owned());
        } else {
            lines[last].push_str(word);
        }
    }
    if lines.len() > LINES_MAX {
        lines.truncate(LINES_MAX);
        lines[LINES_MAX - 1].push('…');
    }
    lines
}
