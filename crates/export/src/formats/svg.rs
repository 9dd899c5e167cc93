//! The picture of the path as SVG: chuck side left, X up, Z right, one scale for both.
//!
//! In: a recorded path. Out: one SVG text with nothing outside itself. The view is fitted to the cutting
//! moves, so that a far home position does not shrink the work; rapids leave the frame. X is labelled as a
//! diameter. What is drawn is bounded by [`SEGMENTS_DRAWN_MAX`].

mod marks;

use std::collections::HashSet;
use std::fmt::Write;

use turnwright_units::write_fixed;

use crate::Language;
use crate::path::{Bow, Extents, PathRecorder, Point, Segment, SegmentKind};
use crate::words::Words;

pub use marks::Mark;

/// Strokes in one picture; strokes that fall on the same pixels count once when there are more.
pub const SEGMENTS_DRAWN_MAX: usize = 200_000;

/// Smallest and greatest side of a picture.
const SIDE_PX_MIN: u32 = 240;
const SIDE_PX_MAX: u32 = 16_384;

/// Font family of every text; the PNG writer carries a font of this name.
pub(crate) const FONT_FAMILY: &str = "Turnwright Sans";

const TITLE_PX: f64 = 16.0;
const LABEL_PX: f64 = 12.0;

const MARGIN_LEFT_PX: f64 = 66.0;
const MARGIN_RIGHT_PX: f64 = 22.0;
const MARGIN_TOP_PX: f64 = 68.0;
const MARGIN_BOTTOM_PX: f64 = 46.0;
/// Free space between the work and the frame, and the strip of the chuck symbol.
const PAD_PX: f64 = 26.0;
const CHUCK_PX: f64 = 36.0;

/// The centre line is drawn into the view unless the work would become this many times smaller.
const CENTRE_LINE_SHRINK_MAX: f64 = 4.0;

/// How the picture is made.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// Heading, usually the file's name.
    pub title: String,
    /// Language of the words in it.
    pub language: Language,
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
    /// Places with a short text beside them; the view is then fitted to the cuts alone. A text that finds no room is
    /// left out, its dot stays.
    pub marks: Vec<Mark>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            language: Language::English,
            width_px: 1200,
            height_px: 720,
            marks: Vec::new(),
        }
    }
}

/// Draws the path.
pub fn write_svg(path: &PathRecorder, options: &PictureOptions) -> String {
    let words = Words::new(options.language);
    let frame = Frame::new(path, options);
    let strokes = Strokes::of(path, &frame);
    let mut svg = String::with_capacity(8_192 + strokes.bytes());
    write_opening(&mut svg, options, &words);
    write_axes(&mut svg, &frame, &words);
    write_chuck(&mut svg, &frame, &words);
    svg.push_str("<g clip-path=\"url(#plot)\">\n");
    write_centre_line(&mut svg, &frame);
    for kind in KINDS {
        strokes.write(&mut svg, kind);
    }
    write_origin(&mut svg, &frame);
    svg.push_str("</g>\n");
    marks::write(&mut svg, &frame, &options.marks);
    write_heading(&mut svg, path, options, &words, strokes.incomplete || path.segments_dropped() > 0);
    svg.push_str("</svg>\n");
    svg
}

/// From the lowest layer to the highest: cuts are never hidden by rapids.
const KINDS: [SegmentKind; 3] = [SegmentKind::Rapid, SegmentKind::Feed, SegmentKind::Thread];

/// Key of the legend's word, and the look of the strokes: colour-blind-safe by dash and width too.
const fn look(kind: SegmentKind) -> (&'static str, &'static str) {
    match kind {
        SegmentKind::Rapid => (
            "picture-rapid",
            r##"class="rapid" stroke="#d32f2f" stroke-width="1.1" stroke-dasharray="6 4" stroke-opacity="0.85""##,
        ),
        SegmentKind::Feed => ("picture-feed", r##"class="feed" stroke="#0b4f9e" stroke-width="1.6""##),
        SegmentKind::Thread => ("picture-thread", r##"class="thread" stroke="#00875a" stroke-width="1.8""##),
    }
}

const CENTRE_LINE_LOOK: &str = r##"stroke="#555" stroke-width="1" stroke-dasharray="14 4 2 4""##;

/// The plotted rectangle and its scale.
struct Frame {
    left_px: f64,
    top_px: f64,
    right_px: f64,
    bottom_px: f64,
    px_per_mm: f64,
    /// What lies at the left edge and at the upper edge.
    z_left_mm: f64,
    radius_top_mm: f64,
}

impl Frame {
    fn new(path: &PathRecorder, options: &PictureOptions) -> Self {
        let (width_px, height_px) = size_px(options);
        let (left_px, top_px) = (MARGIN_LEFT_PX, MARGIN_TOP_PX);
        let (right_px, bottom_px) = (width_px - MARGIN_RIGHT_PX, height_px - MARGIN_BOTTOM_PX);
        let free_width_px = right_px - left_px - CHUCK_PX - 2.0 * PAD_PX;
        let free_height_px = bottom_px - top_px - 2.0 * PAD_PX;
        let shown = match path.cutting_extents() {
            // What is marked is to be told apart, so the centre line may be out of sight.
            Some(cuts) if !options.marks.is_empty() => cuts,
            _ => shown_extents(path, free_width_px / free_height_px),
        };
        let px_per_mm = scale_for(&shown, free_width_px, free_height_px);
        let z_middle_mm = f64::midpoint(shown.z_min_mm, shown.z_max_mm);
        let radius_middle_mm = f64::midpoint(shown.radius_min_mm, shown.radius_max_mm);
        Self {
            left_px,
            top_px,
            right_px,
            bottom_px,
            px_per_mm,
            z_left_mm: z_middle_mm - (f64::midpoint(left_px + CHUCK_PX, right_px) - left_px) / px_per_mm,
            radius_top_mm: radius_middle_mm + (bottom_px - top_px) / 2.0 / px_per_mm,
        }
    }

    fn x_px(&self, z_mm: f64) -> f64 {
        self.left_px + (z_mm - self.z_left_mm) * self.px_per_mm
    }

    fn y_px(&self, radius_mm: f64) -> f64 {
        self.top_px + (self.radius_top_mm - radius_mm) * self.px_per_mm
    }

    fn place(&self, point: Point) -> (f64, f64) {
        (self.x_px(point.z_mm.into()), self.y_px(point.radius_mm.into()))
    }

    /// Height of the centre line when it is in the frame.
    fn centre_line_px(&self) -> Option<f64> {
        let y_px = self.y_px(0.0);
        (self.top_px..=self.bottom_px).contains(&y_px).then_some(y_px)
    }
}

/// What the view is fitted to: the cutting moves, else all moves, else an empty stage; and the centre line
/// unless it is far away. `width_to_height` is the shape of the free space.
pub(crate) fn shown_extents(path: &PathRecorder, width_to_height: f64) -> Extents {
    let shown = path.cutting_extents().or(path.extents()).unwrap_or(Extents {
        radius_min_mm: 0.0,
        radius_max_mm: 25.0,
        z_min_mm: -80.0,
        z_max_mm: 0.0,
    });
    let with_centre_line = Extents {
        radius_min_mm: shown.radius_min_mm.min(0.0),
        radius_max_mm: shown.radius_max_mm.max(0.0),
        ..shown
    };
    let scale = |extents| scale_for(extents, width_to_height, 1.0);
    if scale(&with_centre_line) * CENTRE_LINE_SHRINK_MAX >= scale(&shown) { with_centre_line } else { shown }
}

/// The one scale that fits both ways.
fn scale_for(extents: &Extents, width_px: f64, height_px: f64) -> f64 {
    // A single point still needs a scale: a tenth of a millimetre at least.
    let z_mm = (extents.z_max_mm - extents.z_min_mm).max(0.1);
    let x_mm = (extents.radius_max_mm - extents.radius_min_mm).max(0.1);
    (width_px / z_mm).min(height_px / x_mm)
}

fn size_px(options: &PictureOptions) -> (f64, f64) {
    (
        f64::from(options.width_px.clamp(SIDE_PX_MIN, SIDE_PX_MAX)),
        f64::from(options.height_px.clamp(SIDE_PX_MIN, SIDE_PX_MAX)),
    )
}

/// The strokes of each kind as path data.
struct Strokes<'a> {
    frame: &'a Frame,
    data: [Vec<u8>; 3],
    pen: [Option<(i64, i64)>; 3],
    drawn: usize,
    incomplete: bool,
}

impl<'a> Strokes<'a> {
    fn of(path: &PathRecorder, frame: &'a Frame) -> Self {
        let mut strokes =
            Self { frame, data: Default::default(), pen: [None; 3], drawn: 0, incomplete: false };
        // Strokes on top of each other are drawn once: dashes stay dashes, and a long program that repeats
        // itself stays small. A long path counts whole pixels as the same place, a short one hundredths.
        let grain = if path.segments().len() > SEGMENTS_DRAWN_MAX { 1.0 } else { 100.0 };
        let mut seen = HashSet::with_capacity(path.segments().len().min(SEGMENTS_DRAWN_MAX));
        for segment in path.segments() {
            let spot = |point| {
                let (x, y) = frame.place(point);
                ((x * grain).round() as i64, (y * grain).round() as i64)
            };
            let (a, b) = (spot(segment.start), spot(segment.end));
            let bend = segment.bow.map(|bow| spot(bow.centre));
            if !seen.insert((a.min(b), a.max(b), bend, segment.kind)) {
                continue;
            }
            if strokes.drawn >= SEGMENTS_DRAWN_MAX {
                strokes.incomplete = true;
                break;
            }
            strokes.add(segment);
        }
        strokes
    }

    fn bytes(&self) -> usize {
        self.data.iter().map(Vec::len).sum()
    }

    fn add(&mut self, segment: &Segment) {
        let start = self.frame.place(segment.start);
        let end = self.frame.place(segment.end);
        match segment.bow {
            None => self.add_line(segment.kind, start, end),
            Some(bow) => self.add_arc(segment.kind, start, end, &bow),
        }
    }

    fn add_line(&mut self, kind: SegmentKind, start: (f64, f64), end: (f64, f64)) {
        let Some((start, end)) = self.clip(start, end) else { return };
        let (start, end) = (hundredths(start), hundredths(end));
        if start == end && self.pen[kind as usize] == Some(start) {
            return;
        }
        self.move_to(kind, start);
        self.data[kind as usize].push(b'L');
        self.push_point(kind, end);
    }

    fn add_arc(&mut self, kind: SegmentKind, start: (f64, f64), end: (f64, f64), bow: &Bow) {
        /// Above this radius renderers lose precision, so that chords are drawn.
        const RADIUS_PX_MAX: f64 = 50_000.0;
        const CHORDS: u32 = 64;
        let centre = self.frame.place(bow.centre);
        let radius_px = (start.0 - centre.0).hypot(start.1 - centre.1);
        let sweep_rad = f64::from(bow.sweep_rad);
        // On the screen Y points down, so that angles change their sign.
        let start_rad = (centre.1 - start.1).atan2(start.0 - centre.0);
        let at = |part: f64| {
            let angle = start_rad + sweep_rad * part;
            (centre.0 + radius_px * angle.cos(), centre.1 - radius_px * angle.sin())
        };
        if radius_px > RADIUS_PX_MAX {
            for chord in 0..CHORDS {
                let part = |chord: u32| f64::from(chord) / f64::from(CHORDS);
                self.add_line(kind, at(part(chord)), at(part(chord + 1)));
            }
            return;
        }
        let Frame { left_px, right_px, top_px, bottom_px, .. } = *self.frame;
        let outside = centre.0 + radius_px < left_px
            || centre.0 - radius_px > right_px
            || centre.1 + radius_px < top_px
            || centre.1 - radius_px > bottom_px;
        if outside || radius_px < 0.05 {
            return;
        }
        self.move_to(kind, hundredths(start));
        // An SVG arc cannot be a whole circle: two halves.
        let halves = if sweep_rad.abs() > std::f64::consts::PI { 2 } else { 1 };
        for half in 1..=halves {
            let to = if half == halves { end } else { at(0.5) };
            let data = &mut self.data[kind as usize];
            data.push(b'A');
            write_fixed(data, (radius_px * 100.0).round() as i64, 2);
            data.push(b' ');
            write_fixed(data, (radius_px * 100.0).round() as i64, 2);
            data.extend_from_slice(if sweep_rad < 0.0 { b" 0 0 1 " } else { b" 0 0 0 " });
            self.push_point(kind, hundredths(to));
        }
    }

    /// Starts a new stroke unless the pen is already there.
    fn move_to(&mut self, kind: SegmentKind, to: (i64, i64)) {
        self.drawn += 1;
        if self.pen[kind as usize] != Some(to) {
            self.data[kind as usize].push(b'M');
            self.push_point(kind, to);
        }
    }

    fn push_point(&mut self, kind: SegmentKind, to: (i64, i64)) {
        let data = &mut self.data[kind as usize];
        write_fixed(data, to.0, 2);
        data.push(b' ');
        write_fixed(data, to.1, 2);
        self.pen[kind as usize] = Some(to);
    }

    /// The part of a line in the frame and a little around it (Liang and Barsky), so that a far home
    /// position makes neither long numbers nor a million dashes.
    fn clip(&self, start: (f64, f64), end: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
        const AROUND_PX: f64 = 20.0;
        let frame = self.frame;
        let (dx, dy) = (end.0 - start.0, end.1 - start.1);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (toward, room) in [
            (-dx, start.0 - (frame.left_px - AROUND_PX)),
            (dx, frame.right_px + AROUND_PX - start.0),
            (-dy, start.1 - (frame.top_px - AROUND_PX)),
            (dy, frame.bottom_px + AROUND_PX - start.1),
        ] {
            if toward == 0.0 && room < 0.0 {
                return None;
            } else if toward < 0.0 {
                from = from.max(room / toward);
            } else if toward > 0.0 {
                to = to.min(room / toward);
            }
        }
        let at = |part: f64| (start.0 + dx * part, start.1 + dy * part);
        (from <= to).then(|| (if from > 0.0 { at(from) } else { start }, if to < 1.0 { at(to) } else { end }))
    }

    fn write(&self, svg: &mut String, kind: SegmentKind) {
        let data = &self.data[kind as usize];
        if !data.is_empty() {
            let data = std::str::from_utf8(data).unwrap_or_default();
            let _ = writeln!(
                svg,
                r#"<path {} fill="none" stroke-linejoin="round" stroke-linecap="round" d="{data}"/>"#,
                look(kind).1
            );
        }
    }
}

fn hundredths(place: (f64, f64)) -> (i64, i64) {
    ((place.0 * 100.0).round() as i64, (place.1 * 100.0).round() as i64)
}

fn write_opening(svg: &mut String, options: &PictureOptions, words: &Words) {
    let (width_px, height_px) = size_px(options);
    let _ = writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width_px}" height="{height_px}" viewBox="0 0 {width_px} {height_px}" role="img" xml:lang="{tag}" font-family="'{FONT_FAMILY}', 'Noto Sans CJK SC', 'Microsoft YaHei', sans-serif" font-size="{LABEL_PX}" fill="#222">
<title>{title}</title>
<desc>{description}</desc>
<defs>
<clipPath id="plot"><rect x="{MARGIN_LEFT_PX}" y="{MARGIN_TOP_PX}" width="{plot_width}" height="{plot_height}"/></clipPath>
<pattern id="hatch" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><line x1="0" y1="0" x2="0" y2="7" stroke="#8a8a8a" stroke-width="2"/></pattern>
</defs>
<rect width="{width_px}" height="{height_px}" fill="#fff"/>"##,
        tag = options.language.tag(),
        title = escape_xml(&options.title),
        description = escape_xml(words.get("picture-description")),
        plot_width = width_px - MARGIN_LEFT_PX - MARGIN_RIGHT_PX,
        plot_height = height_px - MARGIN_TOP_PX - MARGIN_BOTTOM_PX,
    );
}

/// Grid, ticks, numbers and the names of the axes.
fn write_axes(svg: &mut String, frame: &Frame, words: &Words) {
    let Frame { left_px, top_px, right_px, bottom_px, px_per_mm, .. } = *frame;
    let z_left_mm = frame.z_left_mm;
    let z_right_mm = z_left_mm + (right_px - left_px) / px_per_mm;
    svg.push_str("<g stroke=\"#e6e6e6\" stroke-width=\"1\">\n");
    let z_ticks = Ticks::new(z_left_mm, z_right_mm, px_per_mm, TickLabels::SideBySide);
    for (z_mm, _) in z_ticks.all() {
        let x = frame.x_px(z_mm);
        let _ = writeln!(svg, r#"<line x1="{x:.2}" y1="{top_px}" x2="{x:.2}" y2="{bottom_px}"/>"#);
    }
    let diameter_top_mm = 2.0 * frame.radius_top_mm;
    let diameter_bottom_mm = diameter_top_mm - 2.0 * (bottom_px - top_px) / px_per_mm;
    let x_ticks = Ticks::new(diameter_bottom_mm, diameter_top_mm, px_per_mm / 2.0, TickLabels::Stacked);
    for (diameter_mm, _) in x_ticks.all() {
        let y = frame.y_px(diameter_mm / 2.0);
        let _ = writeln!(svg, r#"<line x1="{left_px}" y1="{y:.2}" x2="{right_px}" y2="{y:.2}"/>"#);
    }
    let _ = writeln!(
        svg,
        "</g>\n<rect x=\"{left_px}\" y=\"{top_px}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#999\"/>",
        right_px - left_px,
        bottom_px - top_px
    );
    svg.push_str("<g class=\"z-axis\" text-anchor=\"middle\">\n");
    for (z_mm, label) in z_ticks.all() {
        let x = frame.x_px(z_mm);
        let _ = writeln!(svg, r#"<text x="{x:.2}" y="{:.2}">{label}</text>"#, bottom_px + 17.0);
    }
    svg.push_str("</g>\n<g class=\"x-axis\" text-anchor=\"end\">\n");
    for (diameter_mm, label) in x_ticks.all() {
        let y = frame.y_px(diameter_mm / 2.0) + 4.0;
        let _ = writeln!(svg, r#"<text x="{:.2}" y="{y:.2}">{label}</text>"#, left_px - 7.0);
    }
    let _ = writeln!(
        svg,
        r#"</g>
<g font-weight="bold"><text x="{:.2}" y="{:.2}" text-anchor="middle">{}</text>
<text x="10" y="{:.2}">{}</text></g>"#,
        f64::midpoint(left_px, right_px),
        bottom_px + 36.0,
        escape_xml(words.get("picture-axis-z")),
        top_px - 10.0,
        escape_xml(words.get("picture-axis-x")),
    );
}

/// The hatched strip at the left that says where the chuck is.
fn write_chuck(svg: &mut String, frame: &Frame, words: &Words) {
    let middle_px = frame.centre_line_px().unwrap_or(f64::midpoint(frame.top_px, frame.bottom_px));
    let top_px = (middle_px - 80.0).max(frame.top_px + 6.0);
    let bottom_px = (middle_px + 80.0).min(frame.bottom_px - 1.0);
    // Beside the centre line, not across it.
    let half_label_px = text_width_px(words.get("picture-chuck-side"), 11.0) / 2.0 + 6.0;
    let label_y_px = match frame.centre_line_px() {
        Some(y_px) if y_px - frame.top_px > 2.0 * half_label_px + 8.0 => y_px - half_label_px,
        Some(y_px) => y_px + half_label_px,
        None => middle_px,
    };
    let label_x_px = frame.left_px + 30.0;
    let _ = writeln!(
        svg,
        r##"<g class="chuck"><rect x="{:.2}" y="{top_px:.2}" width="15" height="{:.2}" fill="url(#hatch)" stroke="#777"/>
<text transform="translate({label_x_px:.2} {label_y_px:.2}) rotate(-90)" text-anchor="middle" font-size="11" fill="#666">{}</text></g>"##,
        frame.left_px,
        bottom_px - top_px,
        escape_xml(words.get("picture-chuck-side")),
    );
}

fn write_centre_line(svg: &mut String, frame: &Frame) {
    if let Some(y) = frame.centre_line_px() {
        let _ = writeln!(
            svg,
            r#"<line class="centre-line" x1="{}" y1="{y:.2}" x2="{}" y2="{y:.2}" {CENTRE_LINE_LOOK}/>"#,
            frame.left_px, frame.right_px
        );
    }
}

/// The sign of a work zero: a circle with two black quarters.
fn write_origin(svg: &mut String, frame: &Frame) {
    let (x, y) = (frame.x_px(0.0), frame.y_px(0.0));
    let _ = writeln!(
        svg,
        r##"<g class="work-zero" transform="translate({x:.2} {y:.2})"><circle r="6" fill="#fff" fill-opacity="0.8" stroke="#222"/><path d="M0 0V-6A6 6 0 0 1 6 0ZM0 0V6A6 6 0 0 1 -6 0Z" fill="#222"/></g>"##
    );
}

/// Title, legend and what has to be said about the picture.
fn write_heading(
    svg: &mut String,
    path: &PathRecorder,
    options: &PictureOptions,
    words: &Words,
    incomplete: bool,
) {
    let (width_px, height_px) = size_px(options);
    let title = shortened(&options.title, width_px - 40.0, TITLE_PX);
    let _ = writeln!(
        svg,
        r#"<text class="title" x="10" y="26" font-size="{TITLE_PX}" font-weight="bold">{}</text>"#,
        escape_xml(&title)
    );
    let mut entries: Vec<(&str, &str)> = KINDS
        .into_iter()
        .filter(|kind| path.segments().iter().any(|segment| segment.kind == *kind))
        .map(look)
        .collect();
    entries.push(("picture-centre-line", CENTRE_LINE_LOOK));
    // Set from the right edge, so that the name of the X axis keeps the left.
    let mut right_px = width_px - MARGIN_RIGHT_PX;
    svg.push_str("<g class=\"legend\">\n");
    for (key, look) in entries.into_iter().rev() {
        let text = words.get(key);
        let text_px = right_px - text_width_px(text, LABEL_PX);
        let line_px = text_px - 44.0;
        if line_px < 80.0 {
            break;
        }
        let _ = writeln!(
            svg,
            r#"<line x1="{line_px:.2}" y1="48" x2="{:.2}" y2="48" {look}/><text x="{text_px:.2}" y="52">{}</text>"#,
            text_px - 8.0,
            escape_xml(text)
        );
        right_px = line_px - 18.0;
    }
    svg.push_str("</g>\n");
    let note = if path.extents().is_none() {
        Some("picture-no-moves")
    } else if incomplete {
        Some("picture-incomplete")
    } else if path.cutting_extents().is_none() {
        Some("picture-no-cutting")
    } else {
        None
    };
    if let Some(key) = note {
        let (x, y) = (
            f64::midpoint(MARGIN_LEFT_PX, width_px - MARGIN_RIGHT_PX),
            if path.extents().is_none() { height_px / 2.0 - 40.0 } else { MARGIN_TOP_PX + 20.0 },
        );
        let _ = writeln!(
            svg,
            r##"<text class="note" x="{x:.2}" y="{y:.2}" text-anchor="middle" font-size="14" fill="#555">{}</text>"##,
            escape_xml(words.get(key))
        );
    }
}

/// How the labels of an axis stand to each other.
#[derive(Clone, Copy)]
enum TickLabels {
    SideBySide,
    Stacked,
}

/// Round numbers along an axis: steps of 1, 2 or 5 times a power of ten, so wide that labels keep apart.
struct Ticks {
    first: i64,
    last: i64,
    /// The step is `digit` × 10^`power`.
    digit: i64,
    power: i32,
}

impl Ticks {
    fn new(from_mm: f64, to_mm: f64, px_per_mm: f64, labels: TickLabels) -> Self {
        for power in -4..9 {
            for digit in [1, 2, 5] {
                let step_mm = digit as f64 * 10f64.powi(power);
                let ticks = Self {
                    first: (from_mm / step_mm).ceil() as i64,
                    last: (to_mm / step_mm).floor() as i64,
                    digit,
                    power,
                };
                let room_px = match labels {
                    TickLabels::Stacked => 34.0,
                    TickLabels::SideBySide => {
                        let label_px = |index| text_width_px(&ticks.label(index), LABEL_PX);
                        (label_px(ticks.first).max(label_px(ticks.last)) + 18.0).max(52.0)
                    }
                };
                if step_mm * px_per_mm >= room_px {
                    return ticks;
                }
            }
        }
        Self { first: 0, last: 0, digit: 1, power: 0 }
    }

    fn all(&self) -> impl Iterator<Item = (f64, String)> + '_ {
        (self.first..=self.last).map(|index| (self.value_mm(index), self.label(index)))
    }

    fn value_mm(&self, index: i64) -> f64 {
        // A division for negative powers: 3 / 10 is the float that people mean, 3 × 0.1 is not.
        let value = (index * self.digit) as f64;
        if self.power < 0 { value / 10f64.powi(-self.power) } else { value * 10f64.powi(self.power) }
    }

    fn label(&self, index: i64) -> String {
        let places = (-self.power).max(0) as usize;
        format!("{:.places$}", self.value_mm(index)).replace('-', "\u{2212}")
    }
}

/// Width of a text as the bundled font sets it, roughly and rather too wide.
pub(super) fn text_width_px(text: &str, font_px: f64) -> f64 {
    text.chars().map(|c| if c.is_ascii() { 0.58 } else { 1.0 }).sum::<f64>() * font_px
}

fn shortened(text: &str, width_px: f64, font_px: f64) -> String {
    if text_width_px(text, font_px) <= width_px {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        if text_width_px(&short, font_px) + 2.0 * font_px > width_px {
            break;
        }
        short.push(c);
    }
    short.push('…');
    short
}

/// Any text as XML text or attribute; what XML cannot hold is shown by the replacement character.
pub(crate) fn escape_xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(c),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use turnwright_canon::{Action, Command, Origin, RapidPath, Shape, Turn};
    use turnwright_units::{
        Angle, Feed, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, WorkTip,
    };

    fn at(diameter_mm: f64, z_mm: f64) -> Position<WorkTip> {
        let exact = |mm| Length::from_mm_rounded(mm, LeastIncrement::METRIC_B).expect("in range");
        Position::new(Radius(exact(diameter_mm).half()), exact(z_mm))
    }

    fn rapid(diameter_mm: f64, z_mm: f64) -> Action {
        Action::Rapid { to: at(diameter_mm, z_mm), path: RapidPath::EachAxis, others: None }
    }

    fn feed(diameter_mm: f64, z_mm: f64, shape: Shape) -> Action {
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(200_000)));
        Action::Feed { to: at(diameter_mm, z_mm), shape, feed, others: None }
    }

    fn thread(diameter_mm: f64, z_mm: f64) -> Action {
        let lead = Lead(Length::from_mm(2));
        Action::Thread {
            to: at(diameter_mm, z_mm),
            lead,
            lead_end: None,
            start_angle: Angle::ZERO,
            shape: Shape::Line,
            is_chained: false,
        }
    }

    fn recorded(actions: Vec<Action>) -> PathRecorder {
        let mut path = PathRecorder::new(at(400.0, 600.0), 5_000.0, 10_000.0);
        for action in actions {
            path.add(&Command::new(action, Origin::line(1)), 1.0);
        }
        path
    }

    fn drawn(path: &PathRecorder) -> String {
        write_svg(path, &PictureOptions { title: "a".into(), ..PictureOptions::default() })
    }

    /// The path data of a class.
    fn data_of(svg: &str, class: &str) -> Option<String> {
        let document = roxmltree::Document::parse(svg).expect("well-formed");
        let node = document.descendants().find(|node| node.attribute("class") == Some(class))?;
        node.attribute("d").map(str::to_owned)
    }

    fn shaft() -> PathRecorder {
        recorded(vec![
            rapid(40.0, 2.0),
            feed(40.0, -30.0, Shape::Line),
            feed(50.0, -35.0, Shape::Arc { turn: Turn::CounterClockwise, centre: at(40.0, -35.0) }),
            rapid(60.0, 2.0),
            thread(60.0, -10.0),
            rapid(400.0, 600.0),
        ])
    }

    #[test]
    fn each_kind_has_its_own_look_and_the_picture_is_well_formed() {
        let svg = drawn(&shaft());
        let document = roxmltree::Document::parse(&svg).expect("well-formed");
        let of = |class| document.descendants().find(|node| node.attribute("class") == Some(class));
        let rapid = of("rapid").expect("rapids");
        assert!(rapid.has_attribute("stroke-dasharray"));
        let feed = of("feed").expect("feeds");
        assert!(!feed.has_attribute("stroke-dasharray"));
        let thread = of("thread").expect("threads");
        let colours = [rapid, feed, thread].map(|node| node.attribute("stroke").expect("a colour"));
        assert!(colours[0] != colours[1] && colours[1] != colours[2] && colours[0] != colours[2]);
        assert!(of("centre-line").is_some() && of("chuck").is_some() && of("legend").is_some());
        assert!(svg.contains("X ⌀ mm") && svg.contains("Z mm"));
    }

    #[test]
    fn the_view_is_fitted_to_the_cuts_and_both_axes_have_one_scale() {
        let frame = Frame::new(&shaft(), &PictureOptions::default());
        for (diameter_mm, z_mm) in [(40.0, 2.0), (50.0, -35.0), (60.0, 2.0), (0.0, -35.0)] {
            let (x, y) = (frame.x_px(z_mm), frame.y_px(diameter_mm / 2.0));
            assert!(x > frame.left_px + CHUCK_PX && x < frame.right_px, "{x}");
            assert!(y > frame.top_px && y < frame.bottom_px, "{y}");
        }
        assert!(frame.x_px(600.0) > frame.right_px, "the home position is outside");
        // 37 mm of cuts fill the free width, or 30 mm of radius the free height.
        assert!(frame.px_per_mm > 10.0);
        // Right and up are positive.
        assert!(frame.x_px(1.0) > frame.x_px(0.0) && frame.y_px(1.0) < frame.y_px(0.0));
    }

    #[test]
    fn long_rapids_end_near_the_frame() {
        let data = data_of(&drawn(&shaft()), "rapid").expect("rapids");
        for number in data.split(['M', 'L', 'A', ' ']).filter(|word| !word.is_empty()) {
            let px: f64 = number.parse().expect("a number");
            assert!((-30.0..1300.0).contains(&px), "{px}");
        }
    }

    #[test]
    fn moves_that_follow_each_other_are_one_stroke() {
        let path = recorded(vec![
            rapid(40.0, 2.0),
            feed(40.0, -10.0, Shape::Line),
            feed(44.0, -12.0, Shape::Line),
            feed(44.0, -30.0, Shape::Line),
        ]);
        let data = data_of(&drawn(&path), "feed").expect("feeds");
        assert_eq!((data.matches('M').count(), data.matches('L').count()), (1, 3));
    }

    #[test]
    fn arcs_turn_on_the_screen_as_on_the_machine() {
        let arc = |turn| {
            let shape = Shape::Arc { turn, centre: at(40.0, -5.0) };
            let path = recorded(vec![rapid(40.0, 0.0), feed(50.0, -5.0, shape)]);
            data_of(&drawn(&path), "feed").expect("an arc")
        };
        // The sweep flag is 1 for clockwise as one sees it. The quarter is one arc, the other way is two.
        assert_eq!(arc(Turn::CounterClockwise).matches(" 0 0 0 ").count(), 1);
        assert_eq!(arc(Turn::Clockwise).matches(" 0 0 1 ").count(), 2);
    }

    #[test]
    fn negative_x_is_drawn_below_the_centre_line() {
        let path = recorded(vec![rapid(40.0, 0.0), feed(-60.0, 0.0, Shape::Line)]);
        let frame = Frame::new(&path, &PictureOptions::default());
        let centre_line = frame.centre_line_px().expect("in sight");
        assert!(frame.y_px(-30.0) > centre_line && frame.y_px(-30.0) < frame.bottom_px);
        assert!(drawn(&path).contains(">\u{2212}40</text>"));
    }

    #[test]
    fn a_far_centre_line_does_not_shrink_the_work() {
        let path =
            recorded(vec![rapid(800.0, 0.0), feed(800.0, -4.0, Shape::Line), feed(804.0, -4.0, Shape::Line)]);
        assert!(Frame::new(&path, &PictureOptions::default()).centre_line_px().is_none());
        roxmltree::Document::parse(&drawn(&path)).expect("well-formed");
    }

    #[test]
    fn a_path_without_cuts_or_without_moves_says_so() {
        let svg = drawn(&recorded(vec![rapid(40.0, 2.0)]));
        assert!(svg.contains("no cutting move"));
        assert!(data_of(&svg, "rapid").is_some(), "all moves are in the view then");
        let svg = drawn(&recorded(vec![]));
        roxmltree::Document::parse(&svg).expect("well-formed");
        assert!(svg.contains("The program moves no tool."));
    }

    #[test]
    fn labels_never_touch() {
        for (from, to, px_per_mm) in
            [(-1.0, 1.0, 500.0), (-1234.5, -1233.5, 900.0), (-30_000.0, 100.0, 0.03), (0.0, 0.001, 9e5)]
        {
            let ticks = Ticks::new(from, to, px_per_mm, TickLabels::SideBySide);
            let all: Vec<(f64, String)> = ticks.all().collect();
            assert!(all.len() < 100);
            for pair in all.windows(2) {
                let room = (pair[1].0 - pair[0].0) * px_per_mm;
                let need =
                    text_width_px(&pair[0].1, LABEL_PX) / 2.0 + text_width_px(&pair[1].1, LABEL_PX) / 2.0;
                assert!(room > need + 8.0, "{pair:?}");
            }
        }
    }

    #[test]
    fn tick_labels_are_what_people_write() {
        let ticks = Ticks { first: -2, last: 2, digit: 1, power: -1 };
        let labels: Vec<String> = ticks.all().map(|(_, label)| label).collect();
        assert_eq!(labels, ["\u{2212}0.2", "\u{2212}0.1", "0.0", "0.1", "0.2"]);
        let ticks = Ticks { first: 1, last: 1, digit: 5, power: 1 };
        assert_eq!(ticks.all().next(), Some((50.0, "50".to_owned())));
    }

    #[test]
    fn marks_have_their_texts_where_there_is_room_and_dots_everywhere() {
        let marks = |count: i32, step_mm: f64| {
            (0..count).map(|n| Mark::new(at(40.0, -step_mm * f64::from(n)), (n + 1).to_string())).collect()
        };
        let drawn = |marks: Vec<Mark>| {
            let svg = write_svg(&shaft(), &PictureOptions { marks, ..PictureOptions::default() });
            let document = roxmltree::Document::parse(&svg).expect("well-formed");
            let group = document.descendants().find(|node| node.attribute("class") == Some("marks"));
            let count =
                |name| group.map_or(0, |g| g.children().filter(|node| node.has_tag_name(name)).count());
            (count("circle"), count("text"))
        };
        assert_eq!(drawn(marks(10, 3.0)), (10, 10));
        let (dots, texts) = drawn(marks(100, 0.1));
        assert_eq!(dots, 100);
        assert!((10..100).contains(&texts), "{texts}");
        assert_eq!(drawn(marks(1, 0.0)), (1, 1));
        assert_eq!(drawn(vec![]), (0, 0));
        assert_eq!(drawn(vec![Mark::new(at(400.0, 600.0), "far")]), (0, 0), "outside the frame");
    }

    #[test]
    fn any_title_is_well_formed_and_fits() {
        for title in ["<a> & \"b\" 'c'", "\u{0}\u{1b}[31m\u{ffff}", &"车".repeat(500), ""] {
            let options = PictureOptions { title: (*title).into(), ..PictureOptions::default() };
            let svg = write_svg(&shaft(), &options);
            let document = roxmltree::Document::parse(&svg).expect("well-formed");
            let shown = document.descendants().find(|node| node.attribute("class") == Some("title"));
            assert!(shown.and_then(|node| node.text()).unwrap_or_default().chars().count() < 90);
        }
    }

    #[test]
    fn a_path_that_repeats_itself_stays_small() {
        let mut actions = vec![rapid(40.0, 2.0)];
        for _ in 0..150_000 {
            actions.push(feed(40.0, -30.0, Shape::Line));
            actions.push(feed(40.0, 2.0, Shape::Line));
        }
        let svg = drawn(&recorded(actions));
        assert!(svg.len() < 20_000 && !svg.contains("only the first part"), "{} bytes", svg.len());
    }

    #[test]
    fn a_smallest_and_a_greatest_picture_are_drawn() {
        for side in [0, 1, u32::MAX] {
            let options = PictureOptions { width_px: side, height_px: side, ..PictureOptions::default() };
            roxmltree::Document::parse(&write_svg(&shaft(), &options)).expect("well-formed");
        }
    }
}
