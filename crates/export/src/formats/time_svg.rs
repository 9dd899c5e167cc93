//! The picture of a program over time as SVG: what the time is spent on, X, Z, the speed along the path, the spindle
//! and, when anybody knows it, the rate of removal, one above the other over the same seconds.
//!
//! In: a recorded [`Timeline`]. Out: one SVG text with nothing outside itself. Each column of a lane reaches from the
//! least to the greatest value of its stretch of time. The speed has a scale of powers of ten, so that cuts and rapids
//! are both to be seen. The size of the text is bounded, whatever the program.

use std::fmt::Write;

use super::svg::{FONT_FAMILY, escape_xml};
use crate::Language;
use crate::timeline::{Moment, Range, Timeline};
use crate::words::Words;

const WIDTH_PX: f64 = 1200.0;
const LEFT_PX: f64 = 96.0;
const RIGHT_PX: f64 = 1176.0;
const TOP_PX: f64 = 100.0;
const LANE_PX: f64 = 116.0;
const GAP_PX: f64 = 16.0;
const TEXT_PX: f64 = 12.0;

/// Columns of a lane.
const COLUMNS_MAX: usize = 1024;

/// Speeds below this are drawn at the foot of the scale, mm/min.
const SPEED_MIN: f64 = 10.0;

/// How the picture is made.
#[derive(Clone, Debug)]
pub struct TimePicture {
    /// Heading, usually the file's name.
    pub title: String,
    /// Language of the words in it.
    pub language: Language,
}

/// A lane: one value over time.
pub(super) struct Lane {
    /// Key of its name.
    pub(super) title: &'static str,
    /// Line and area.
    look: &'static str,
    /// The values of a column that is so many seconds long.
    pub(super) value: fn(&Moment, f64) -> Range,
    /// From the lower to the upper edge.
    pub(super) scale: Scale,
}

/// How values become heights.
#[derive(Clone, Copy, Debug)]
pub(super) enum Scale {
    /// Between what occurs.
    Fitted,
    /// From zero to what occurs.
    FromZero,
    /// Powers of ten from [`SPEED_MIN`].
    Powers,
}

/// Those of a program; the last is known where somebody knows what was removed.
const LANES: [Lane; 5] = [
    Lane { title: "time-lane-x", look: "#0b4f9e", value: |moment, _| moment.x_mm, scale: Scale::Fitted },
    Lane { title: "time-lane-z", look: "#00695c", value: |moment, _| moment.z_mm, scale: Scale::Fitted },
    Lane {
        title: "time-lane-speed",
        look: "#b3261e",
        value: |moment, _| moment.speed_mm_per_min,
        scale: Scale::Powers,
    },
    Lane { title: "time-lane-rpm", look: "#6a3fa0", value: |moment, _| moment.rpm, scale: Scale::FromZero },
    Lane {
        title: "time-lane-removal",
        look: "#8a5a00",
        // Cubic centimetres a minute.
        value: |moment, seconds| Range { min: 0.0, max: moment.removed_mm3 / seconds * 60.0 / 1000.0 },
        scale: Scale::FromZero,
    },
];

/// Names and looks of the shares of a moment.
const SHARES: [(&str, &str); 3] =
    [("time-share-cutting", "#0b4f9e"), ("time-share-rapid", "#d32f2f"), ("time-share-other", "#c9ced6")];

/// Draws a program over time.
pub fn write_time_svg(timeline: &Timeline, picture: &TimePicture) -> String {
    let words = Words::new(picture.language);
    let columns = Columns::of(timeline);
    let lanes = lanes(timeline);
    let bottom_px = TOP_PX + lanes.len() as f64 * (LANE_PX + GAP_PX);
    let height_px = bottom_px + 40.0;
    let mut svg = String::with_capacity(256 * 1024);
    let (title, description) = (escape_xml(&picture.title), escape_xml(words.get("time-description")));
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px:.0}\" \
         viewBox=\"0 0 {WIDTH_PX} {height_px:.0}\" font-family=\"'{FONT_FAMILY}', sans-serif\" \
         font-size=\"{TEXT_PX}\" role=\"img\">\n<title>{title}</title>\n<desc>{description}</desc>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT_PX}\" y=\"28\" font-size=\"16\" font-weight=\"bold\">{title}</text>\n"
    );
    write_legend(&mut svg, &words, timeline.duration_s());
    if columns.moments.is_empty() {
        let _ = writeln!(
            svg,
            "<text x=\"{LEFT_PX}\" y=\"{:.0}\">{}</text>",
            TOP_PX + 40.0,
            escape_xml(words.get("time-nothing"))
        );
    } else {
        write_shares(&mut svg, &columns);
        write_seconds(&mut svg, &columns, bottom_px);
        for (index, lane) in lanes.iter().enumerate() {
            write_lane(&mut svg, &columns, lane, TOP_PX + index as f64 * (LANE_PX + GAP_PX), &words);
        }
        write_tools(&mut svg, timeline, &columns, bottom_px);
    }
    svg.push_str("</svg>\n");
    svg
}

/// The lanes of a program.
pub(super) fn lanes(timeline: &Timeline) -> &'static [Lane] {
    if timeline.has_removal() { &LANES } else { &LANES[..4] }
}

/// What is drawn side by side.
pub(super) struct Columns {
    pub(super) moments: Vec<Moment>,
    /// How long each is.
    pub(super) seconds: f64,
    /// Pixels of a second.
    px_per_s: f64,
}

impl Columns {
    pub(super) fn of(timeline: &Timeline) -> Self {
        let (mut moments, mut seconds) = (timeline.moments().to_vec(), timeline.moment_s());
        while moments.len() > COLUMNS_MAX {
            moments = moments
                .chunks(2)
                .map(|pair| pair.get(1).map_or(pair[0], |next| pair[0].with(next)))
                .collect();
            seconds *= 2.0;
        }
        Self { moments, seconds, px_per_s: (RIGHT_PX - LEFT_PX) / timeline.duration_s().max(1e-9) }
    }

    /// Left and right edge of a column.
    fn edges(&self, index: usize) -> (f64, f64) {
        let x = |index: usize| (LEFT_PX + index as f64 * self.seconds * self.px_per_s).min(RIGHT_PX);
        (x(index), x(index + 1))
    }
}

fn write_legend(svg: &mut String, words: &Words, duration_s: f64) {
    let _ = writeln!(
        svg,
        "<text x=\"{RIGHT_PX}\" y=\"28\" text-anchor=\"end\" font-weight=\"bold\">{} {}</text>",
        escape_xml(words.get("time-in-all")),
        clock(duration_s, duration_s)
    );
    let mut x = LEFT_PX;
    for (key, look) in SHARES {
        let word = words.get(key);
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.1}\" y=\"41\" width=\"12\" height=\"12\" fill=\"{look}\"/>\
             <text x=\"{:.1}\" y=\"51\">{}</text>",
            x + 17.0,
            escape_xml(word)
        );
        // Wide characters take twice the room.
        x += 42.0 + word.chars().map(|c| if c.is_ascii() { 6.6 } else { 12.0 }).sum::<f64>();
    }
}

/// The strip that tells what the time goes into.
fn write_shares(svg: &mut String, columns: &Columns) {
    let (top, height) = (TOP_PX - 22.0, 12.0);
    let mut paths = [String::new(), String::new(), String::new()];
    for (index, moment) in columns.moments.iter().enumerate() {
        let all: f64 = moment.shares_s.iter().sum();
        let (left, right) = columns.edges(index);
        let mut y = top;
        for (path, share) in
            paths.iter_mut().zip(moment.shares_s).filter(|(_, share)| *share > 0.0 && all > 0.0)
        {
            let high = height * share / all;
            let _ = write!(path, "M{left:.2} {y:.2}H{right:.2}V{:.2}H{left:.2}z", y + high);
            y += high;
        }
    }
    for (path, (key, look)) in paths.iter().zip(SHARES).filter(|(path, _)| !path.is_empty()) {
        let _ = writeln!(svg, "<path class=\"{key}\" d=\"{path}\" fill=\"{look}\"/>");
    }
}

/// Upright lines at round times, and their labels.
fn write_seconds(svg: &mut String, columns: &Columns, bottom_px: f64) {
    const STEPS: [f64; 22] = [
        0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0,
        1800.0, 3600.0, 7200.0, 14_400.0, 43_200.0,
    ];
    let duration_s = (RIGHT_PX - LEFT_PX) / columns.px_per_s;
    let widest = 86_400.0 * (duration_s / 86_400.0 / 10.0).ceil();
    let step = STEPS.into_iter().find(|step| step * columns.px_per_s >= 70.0).unwrap_or(widest);
    let mut index = 0.0;
    while index * step <= duration_s * (1.0 + 1e-9) {
        let x = LEFT_PX + index * step * columns.px_per_s;
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.2} {TOP_PX}V{:.1}\" stroke=\"#e3e6ea\"/>\
             <text x=\"{x:.2}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom_px - GAP_PX,
            bottom_px + 4.0,
            clock(index * step, step)
        );
        index += 1.0;
    }
}

/// Seconds as minutes and seconds; decimals where the step is a part of a second.
fn clock(seconds: f64, step: f64) -> String {
    if seconds >= 60.0 || step >= 60.0 {
        let whole = seconds.round() as u64;
        let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
        if hours > 0 { format!("{hours}:{minutes:02}:{rest:02}") } else { format!("{minutes}:{rest:02}") }
    } else if step < 1.0 {
        format!("{seconds:.2} s")
    } else if seconds.fract() > 0.0 {
        format!("{seconds:.1} s")
    } else {
        format!("{seconds:.0} s")
    }
}

fn write_lane(svg: &mut String, columns: &Columns, lane: &Lane, top_px: f64, words: &Words) {
    let values: Vec<Range> =
        columns.moments.iter().map(|moment| (lane.value)(moment, columns.seconds)).collect();
    // Where the cuts are is what is looked at; a far home position leaves the lane.
    let is_fitted = matches!(lane.scale, Scale::Fitted);
    let cuts = |moment: &Moment| moment.shares_s[0] > 0.0;
    let only_cuts = is_fitted && columns.moments.iter().any(cuts);
    let shown = columns.moments.iter().zip(&values).filter(|(moment, _)| !only_cuts || cuts(moment));
    let known = shown.map(|(_, range)| range).filter(|range| range.is_known());
    let all = known.fold(None, |all: Option<Range>, range| Some(all.map_or(*range, |all| all.with(*range))));
    let axis = Axis::new(all, lane.scale);
    let y = |value: f64| top_px + LANE_PX * (1.0 - axis.part(value));
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT_PX}\" y=\"{top_px}\" width=\"{:.0}\" height=\"{LANE_PX}\" fill=\"none\" stroke=\"#b8bec7\"/>\
         <text x=\"14\" y=\"{:.1}\" fill=\"{}\" transform=\"rotate(-90 14 {:.1})\" text-anchor=\"middle\">{}</text>",
        RIGHT_PX - LEFT_PX,
        top_px + LANE_PX / 2.0,
        lane.look,
        top_px + LANE_PX / 2.0,
        escape_xml(words.get(lane.title))
    );
    for tick in axis.ticks() {
        let at = y(tick);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT_PX} {at:.2}H{RIGHT_PX}\" stroke=\"#eceef1\"/>\
             <text x=\"{:.0}\" y=\"{:.2}\" text-anchor=\"end\">{}</text>",
            LEFT_PX - 6.0,
            at + 4.0,
            number(tick)
        );
    }
    let (mut data, mut last) = (String::new(), None);
    for (index, range) in values.iter().enumerate() {
        if !range.is_known() {
            last = None;
            continue;
        }
        let (left, right) = columns.edges(index);
        let (mut low, mut high) = (y(range.min), y(range.max));
        // Lines have a breadth, and hang together where a value leaps.
        if let Some((last_low, last_high)) = last {
            (low, high) = (f64::max(low, last_high), f64::min(high, last_low));
        }
        last = Some((y(range.min), y(range.max)));
        let low = low.max(high + 1.2);
        let _ = write!(data, "M{left:.2} {high:.2}H{right:.2}V{low:.2}H{left:.2}z");
    }
    let _ = writeln!(svg, "<path class=\"{}\" d=\"{data}\" fill=\"{}\"/>", lane.title, lane.look);
}

/// Where tools are called.
fn write_tools(svg: &mut String, timeline: &Timeline, columns: &Columns, bottom_px: f64) {
    let mut free_px = 0.0;
    for call in timeline.tools() {
        let x = LEFT_PX + call.at_s * columns.px_per_s;
        let label = format!("T{}", call.tool);
        let _ = writeln!(
            svg,
            "<path class=\"tool\" d=\"M{x:.2} {:.1}V{:.1}\" stroke=\"#333\" stroke-dasharray=\"3 3\"/>",
            TOP_PX - 24.0,
            bottom_px - GAP_PX
        );
        if x >= free_px {
            let _ = writeln!(
                svg,
                "<text x=\"{:.2}\" y=\"{:.1}\" font-weight=\"bold\">{label}</text>",
                x + 3.0,
                TOP_PX - 26.0
            );
            free_px = x + 12.0 + 8.0 * label.len() as f64;
        }
    }
}

/// The scale of a lane.
struct Axis {
    low: f64,
    high: f64,
    scale: Scale,
}

impl Axis {
    fn new(all: Option<Range>, scale: Scale) -> Self {
        let Range { min, max } = all.unwrap_or(Range { min: 0.0, max: 1.0 });
        let (low, high) = match scale {
            Scale::Fitted => {
                let room = ((max - min) * 0.05).max(1.0);
                (min - room, max + room)
            }
            Scale::FromZero => (0.0, if max > 0.0 { max * 1.08 } else { 1.0 }),
            Scale::Powers => (SPEED_MIN.log10(), (max.max(10.0 * SPEED_MIN) * 1.2).log10()),
        };
        Self { low, high, scale }
    }

    /// 0 at the lower edge, 1 at the upper.
    fn part(&self, value: f64) -> f64 {
        let value = if matches!(self.scale, Scale::Powers) { value.max(SPEED_MIN).log10() } else { value };
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Round values within.
    fn ticks(&self) -> Vec<f64> {
        if matches!(self.scale, Scale::Powers) {
            let (low, high) = (self.low.ceil() as i32, self.high.floor() as i32);
            return (low..=high).map(|power| 10f64.powi(power)).collect();
        }
        let rough = (self.high - self.low) / 4.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(10.0 * power);
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last.min(first + 10)).map(|index| index as f64 * step).collect()
    }
}

/// A round number without more decimals than it has.
fn number(value: f64) -> String {
    // Adding nothing makes minus zero plain.
    ((value * 1e3).round() / 1e3 + 0.0).to_string()
}

#[cfg(test)]
mod tests {
    use turnwright_motion::{Kind, RpmRange, Timing};
    use turnwright_units::{Length, Position, Radius};

    use super::*;

    fn timeline(removed: Option<f64>) -> Timeline {
        let at = |radius: i32, z: i32| Position::new(Radius(Length::from_mm(radius)), Length::from_mm(z));
        let mut timeline = Timeline::default();
        timeline.call_tool(3);
        let mut from = at(50, 5);
        for pass in 0..40 {
            let radius = 40 - pass % 20;
            for (to, seconds, kind) in [
                (at(radius, 5), 0.3, Kind::Rapid),
                (at(radius, -30), 6.5, Kind::Cutting),
                (at(45, 5), 0.4, Kind::Rapid),
            ] {
                let rpm = Some(RpmRange { min: 900.0, max: 1500.0 });
                let timing = Timing { kind, from, seconds, waited_s: 0.0, length_mm: 35.0, rpm };
                timeline.add(&timing, to, removed.filter(|_| kind == Kind::Cutting));
                from = to;
            }
        }
        timeline
    }

    fn drawn(timeline: &Timeline, language: Language) -> String {
        let svg = write_time_svg(timeline, &TimePicture { title: "a<b>.nc".to_string(), language });
        roxmltree::Document::parse(&svg).expect("well-formed");
        svg
    }

    #[test]
    fn lanes_follow_what_is_known() {
        let svg = drawn(&timeline(Some(100.0)), Language::English);
        for class in ["time-lane-x", "time-lane-removal", "time-share-rapid"] {
            assert!(svg.contains(&format!("class=\"{class}\"")), "{class}");
        }
        assert!(svg.contains(">T3<") && svg.contains("a&lt;b&gt;.nc"));
        assert!(!drawn(&timeline(None), Language::Chinese).contains("time-lane-removal\""));
    }

    #[test]
    fn a_program_of_no_time_and_one_of_ages_are_drawn() {
        assert!(!drawn(&Timeline::default(), Language::English).contains("NaN"));
        let mut ages = timeline(Some(1.0));
        let at = Position::new(Radius(Length::ZERO), Length::ZERO);
        let timing =
            Timing { kind: Kind::Dwell, from: at, seconds: 1e12, waited_s: 0.0, length_mm: 0.0, rpm: None };
        ages.add(&timing, at, None);
        let svg = drawn(&ages, Language::English);
        assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.len() < 1_000_000, "{}", svg.len());
    }
}
