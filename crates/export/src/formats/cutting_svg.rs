//! Cutting data over time as SVG: a strip for each quantity, one below the other.
//!
//! In: [`Row`]s of values with their begin and end in seconds, in words. Out: one SVG text with nothing outside itself.

use std::fmt::Write;

use super::svg::{FONT_FAMILY, escape_xml};
use crate::Language;

const WIDTH_PX: f64 = 1200.0;
const LEFT_PX: f64 = 110.0;
const RIGHT_PX: f64 = 30.0;
const TOP_PX: f64 = 80.0;
const STRIP_PX: f64 = 84.0;
const PITCH_PX: f64 = 124.0;

/// Marks on the axis of time.
const TICKS: f64 = 8.0;

/// One quantity over time.
#[derive(Clone, Debug)]
pub struct Row {
    /// What it is.
    pub name: String,
    /// The same with its greatest value and the line of that.
    pub label: String,
    /// The greatest value: the height of the strip.
    pub peak: f64,
    /// The line where that is.
    pub peak_line: u32,
    /// In what it is measured.
    pub unit: &'static str,
    /// Decimal places that mean something.
    pub decimals: usize,
    /// Begin, end and value.
    pub steps: Vec<(f64, f64, f64)>,
}

/// What is drawn.
#[derive(Clone, Debug)]
pub struct CuttingPicture {
    /// Heading, usually the file's name.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The strips, from the top.
    pub rows: Vec<Row>,
    /// How long the program takes.
    pub total_s: f64,
    /// Language of the document.
    pub language: Language,
}

/// Draws the strips.
pub fn write_cutting_svg(picture: &CuttingPicture) -> String {
    let height_px = TOP_PX + PITCH_PX * picture.rows.len() as f64 + 30.0;
    let total_s = picture.total_s.max(1e-3);
    let x = |seconds: f64| LEFT_PX + seconds / total_s * (WIDTH_PX - LEFT_PX - RIGHT_PX);
    let mut svg = String::with_capacity(32_768);
    let (title, subtitle) = (escape_xml(&picture.title), escape_xml(&picture.subtitle));
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px:.0}\" \
         viewBox=\"0 0 {WIDTH_PX} {height_px:.0}\" font-family=\"'{FONT_FAMILY}', sans-serif\" font-size=\"13\" \
         role=\"img\" xml:lang=\"{}\">\n<title>{title}</title>\n<desc>{subtitle}</desc>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT_PX}\" y=\"30\" font-size=\"18\" font-weight=\"bold\">{title}</text>\n\
         <text x=\"{LEFT_PX}\" y=\"50\">{subtitle}</text>\n",
        picture.language.tag()
    );
    let tick_s = tick(total_s / TICKS);
    for (index, row) in picture.rows.iter().enumerate() {
        let top = TOP_PX + PITCH_PX * index as f64 + 16.0;
        let bottom = top + STRIP_PX;
        let _ = writeln!(
            svg,
            "<text class=\"label\" x=\"{LEFT_PX}\" y=\"{:.1}\">{}</text>\n\
             <rect x=\"{LEFT_PX}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{STRIP_PX}\" fill=\"#f4f6f8\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n\
             <text x=\"{:.1}\" y=\"{bottom:.1}\" text-anchor=\"end\">0</text>",
            top - 5.0,
            escape_xml(&row.label),
            WIDTH_PX - LEFT_PX - RIGHT_PX,
            LEFT_PX - 6.0,
            top + 11.0,
            escape_xml(&format!("{:.*} {}", row.decimals, row.peak, row.unit)),
            LEFT_PX - 6.0,
        );
        let mut data = String::new();
        for (from_s, to_s, value) in &row.steps {
            let y = bottom - value / row.peak.max(1e-12) * STRIP_PX;
            // What lasts less than a pixel is seen all the same.
            let (left, right) = (x(*from_s), x(*to_s).max(x(*from_s) + 0.6));
            let _ = write!(data, "M{left:.2} {bottom:.2}V{y:.2}H{right:.2}V{bottom:.2}z");
        }
        let _ = writeln!(svg, "<path class=\"course\" d=\"{data}\" fill=\"#1f6fc0\"/>");
        let mut ticks = String::new();
        for count in 0..=(total_s / tick_s) as u32 {
            let at = x(f64::from(count) * tick_s);
            let _ = write!(ticks, "M{at:.2} {bottom:.2}v5");
            let _ = writeln!(
                svg,
                "<text x=\"{at:.1}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"middle\" fill=\"#555\">{} s</text>",
                bottom + 16.0,
                f64::from(count) * tick_s
            );
        }
        let _ = writeln!(
            svg,
            "<path d=\"{ticks}M{LEFT_PX} {bottom:.2}H{:.1}\" stroke=\"#555\" fill=\"none\"/>",
            WIDTH_PX - RIGHT_PX
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// A round number of seconds no smaller than this.
fn tick(seconds: f64) -> f64 {
    let rounds = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0];
    rounds.into_iter().find(|round| *round >= seconds).unwrap_or_else(|| (seconds / 3600.0).ceil() * 3600.0)
}
