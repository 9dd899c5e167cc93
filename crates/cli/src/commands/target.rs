//! `measure --target`: the part held against a drawing, or against the figures that its finishing cycles follow.
//!
//! In: the options and a finished part with its judgement. Out: a table, JSON, a picture, and errors for what is out of
//! tolerance.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::{Value, json};
use turnwright_control::Setup;
use turnwright_diagnostics::{Diagnostic, Place, SourceId};
use turnwright_export::formats::overlay_svg::{Overlay, OverlayMark, Region, Stroke};
use turnwright_export::formats::part_svg::mm;
use turnwright_export::part::PartShape;
use turnwright_geometry::Segment;
use turnwright_stock::Section;
use turnwright_verify::part::Part;
use turnwright_verify::target::drawing::{DRAWING_BYTES_MAX, Drawing, DrawingFault};
use turnwright_verify::target::{ContourFault, Judgement, Spot, section};

use crate::arguments::Measure;
use crate::environment::unreadable;
use crate::finding::Finding;
use crate::part::Aim;
use crate::render::clean;
use crate::report::picture_language;
use crate::report::sizes::z_text;
use crate::speech::Speech;
use crate::table::{Side, Table, heading};

/// Lines of the table, and errors of a kind.
const SHOWN_MAX: usize = 20;
const TOLD_MAX: usize = 10;

/// Colours of the regions, and of the contour where it is in tolerance.
const GOUGE: &str = "#d43d51";
const REST: &str = "#1f6fc0";
const GOOD: &str = "#2b9348";

/// Colours of the contour from a small deviation to the largest.
const GOUGE_SHADES: [&str; 3] = ["#f4a25e", "#e4572e", "#a4133c"];
const REST_SHADES: [&str; 3] = ["#64b5e8", "#1f6fc0", "#1b2f73"];

/// What `--target` names: the word for the figures of the finishing cycles, else a drawing.
///
/// # Errors
/// A drawing that cannot be read, or that shows no half-section.
pub(super) fn aim(options: &Measure, speech: Speech) -> Result<Option<Aim>, Finding> {
    let Some(target) = &options.target else { return Ok(None) };
    if target.as_os_str().eq_ignore_ascii_case("g70") {
        return Ok(Some(Aim::Finishing));
    }
    let name = target.display().to_string();
    let refused = |reason: String| {
        let diagnostic = Diagnostic::error("target-unreadable").with("name", clean(&name));
        Finding::new(name.clone(), diagnostic.with("value", reason)).failed()
    };
    let bytes = bytes(target).map_err(|error| unreadable(&name, &error, speech))?;
    let drawing = Drawing::read(&bytes).map_err(|fault| refused(drawing_fault(&fault, speech)))?;
    let layer = drawing.layer(options.layer.as_deref()).map_err(|names| {
        let names: Vec<String> = names.into_iter().map(clean).collect();
        let names = names.join(speech.get("list-comma"));
        let key = match (&options.layer, names.is_empty()) {
            (_, true) => "drawing-nothing",
            (Some(_), _) => "drawing-no-layer",
            (None, _) => "drawing-layers",
        };
        let asked = clean(options.layer.as_deref().unwrap_or_default());
        refused(speech.fill(key, &[("name", &asked), ("names", &names)]))
    })?;
    if let Some((shape, line)) = &layer.unread {
        let values = [("name", clean(shape)), ("line", line.to_string())];
        return Err(refused(filled(speech, "drawing-shape", &values)));
    }
    let section = section(&layer.edges).map_err(|fault| refused(contour_fault(fault, speech)))?;
    Ok(Some(Aim::Drawing(Box::new(section))))
}

/// No more of a file than a drawing may have, and one byte that shows that it has more.
fn bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(DRAWING_BYTES_MAX as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn drawing_fault(fault: &DrawingFault, speech: Speech) -> String {
    let (key, number) = match fault {
        DrawingFault::TooLong => ("drawing-too-long", 0),
        DrawingFault::Binary => ("drawing-binary", 0),
        DrawingFault::Truncated => ("drawing-truncated", 0),
        DrawingFault::NotGroup(line) => ("drawing-no-dxf", i64::from(*line)),
        DrawingFault::NotNumber(line) => ("drawing-number", i64::from(*line)),
        DrawingFault::TooLarge(line) => ("drawing-large", i64::from(*line)),
        DrawingFault::Unit(unit) => ("drawing-unit", *unit),
        DrawingFault::Tilted(line) => ("drawing-tilted", i64::from(*line)),
        DrawingFault::Mesh(line) => ("drawing-mesh", i64::from(*line)),
    };
    speech.fill(key, &[("n", &number.to_string())])
}

fn contour_fault(fault: ContourFault, speech: Speech) -> String {
    let (key, place) = match fault {
        ContourFault::Nothing => return speech.get("drawing-nothing").to_string(),
        ContourFault::TooMany(count) => return speech.fill("drawing-many", &[("n", &count.to_string())]),
        ContourFault::BelowAxis(place) => ("drawing-below-axis", place),
        ContourFault::Open(place) => ("drawing-open", place),
        ContourFault::Branch(place) => ("drawing-branch", place),
        ContourFault::Crossing(place) => ("drawing-crossing", place),
        ContourFault::NoPart(place) => ("drawing-no-part", place),
    };
    filled(speech, key, &[("z", mm(place.z)), ("r", mm(place.x))])
}

/// A part beside its target, and the section that was judged: with threads as drawings show them.
pub(super) fn judgement(part: &mut Part) -> Option<(Judgement, Section)> {
    let aimed = part.aimed.take()?;
    let shape = PartShape::new(&part.section, &part.plain, &part.threads)?;
    let edges: Vec<Segment> = shape.loops.into_iter().flatten().collect();
    let shown = section(&edges).unwrap_or_else(|_| part.plain.clone());
    Some((aimed.judge(&shown), shown))
}

/// A judgement in words, numbers and colours.
pub(super) struct Held<'a> {
    pub(super) judgement: &'a Judgement,
    /// The setup as it was given.
    pub(super) given: &'a Setup,
    pub(super) options: &'a Measure,
    pub(super) speech: Speech,
}

impl Held<'_> {
    fn tolerance_mm(&self) -> f64 {
        self.options.tolerance
    }

    /// What is out of tolerance, the deepest first: whether it is a gouge.
    fn beyond(&self) -> Vec<(&Spot, bool)> {
        let gouges = self.judgement.gouges_beyond(self.tolerance_mm()).map(|spot| (spot, true));
        let rests = self.judgement.rests_beyond(self.tolerance_mm()).map(|spot| (spot, false));
        let mut all: Vec<(&Spot, bool)> = gouges.chain(rests).collect();
        all.sort_by(|a, b| b.0.piece.deviation_mm.total_cmp(&a.0.piece.deviation_mm));
        all
    }

    /// Errors, of each line the deepest gouge.
    pub(super) fn findings(&self) -> Vec<Diagnostic> {
        let mut lines = BTreeSet::new();
        let (mut gouges, mut rests) = (0, 0);
        let mut findings = Vec::new();
        for (spot, is_gouge) in self.beyond() {
            let count = if is_gouge { &mut gouges } else { &mut rests };
            let is_new = spot.line.is_none_or(|line| lines.insert(line));
            if *count >= TOLD_MAX || !is_new {
                continue;
            }
            *count += 1;
            let key = if is_gouge { "target-gouged" } else { "target-not-reached" };
            let mut finding = Diagnostic::error(key)
                .with("depth", mm(spot.piece.deviation_mm))
                .with("x", mm(2.0 * spot.piece.place.x))
                .with("z", mm(spot.piece.place.z));
            if let Some((source, line)) = spot.line {
                let source = SourceId(source);
                finding = finding.at(Place { source, line, line_offset: u64::MAX, column: 1, end_column: 1 });
            }
            findings.push(finding);
        }
        findings
    }

    fn deepest(spots: &[Spot]) -> f64 {
        spots.iter().map(|spot| spot.piece.deviation_mm).fold(0.0, f64::max)
    }

    /// The verdict in a line.
    fn verdict(&self) -> String {
        let (gouge, rest) = (Self::deepest(&self.judgement.gouges), Self::deepest(&self.judgement.rests));
        let key = if self.beyond().is_empty() { "target-pass" } else { "target-fail" };
        let values = [("t", mm(self.tolerance_mm())), ("gouge", mm(gouge)), ("rest", mm(rest))];
        filled(self.speech, key, &values)
    }

    /// The name of the target.
    fn name(&self) -> String {
        self.options.target.as_ref().map_or_else(String::new, |target| clean(&target.display().to_string()))
    }

    pub(super) fn human(&self) -> String {
        use Side::{Left, Right};
        let speech = self.speech;
        let title = speech.fill("target-title", &[("name", &self.name())]);
        let mut out = format!("{}{}{}\n", heading(&title), speech.get("colon"), self.verdict());
        let beyond = self.beyond();
        if beyond.is_empty() {
            return out;
        }
        let mut table = Table::new(&[Left, Right, Right, Right, Right, Right, Right, Right]);
        let columns = ["what", "deviation", "at-z", "at-d", "from", "to", "area", "line"];
        table.row(columns.map(|key| speech.find(&format!("column-{key}")).to_string()));
        for (spot, is_gouge) in beyond.iter().take(SHOWN_MAX) {
            let piece = &spot.piece;
            let sign = if *is_gouge { "-" } else { "+" };
            table.row([
                speech.get(if *is_gouge { "target-gouge" } else { "target-rest" }).to_string(),
                format!("{sign}{}", mm(piece.deviation_mm)),
                z_text(piece.place.z),
                format!("⌀{}", mm(2.0 * piece.place.x)),
                z_text(piece.bounds.max.z),
                z_text(piece.bounds.min.z),
                mm(piece.area_mm2),
                spot.line.map_or_else(String::new, |(_, line)| line.to_string()),
            ]);
        }
        out.push_str(&table.text(2, true));
        if beyond.len() > SHOWN_MAX {
            let more = (beyond.len() - SHOWN_MAX).to_string();
            out.push_str(&format!("  {}\n", speech.fill("diff-more", &[("n", &more)])));
        }
        for tool in self.assumed_tools() {
            out.push_str(&format!("  {}\n", speech.fill("target-assumed", &[("tool", &tool.to_string())])));
        }
        out
    }

    /// Tools that cut too deep in a shape that nobody gave.
    fn assumed_tools(&self) -> BTreeSet<u32> {
        let is_given = |tool: u32| self.given.tools.keys().any(|name| name.parse() == Ok(tool));
        let gouges = self.judgement.gouges_beyond(self.tolerance_mm()).filter(|spot| spot.line.is_some());
        gouges.map(|spot| spot.tool).filter(|tool| !is_given(*tool)).collect()
    }

    pub(super) fn json(&self) -> Value {
        let tolerance = self.tolerance_mm();
        let one = |spot: &Spot| {
            let piece = &spot.piece;
            json!({
                "deviation": piece.deviation_mm,
                "z": piece.place.z,
                "diameter": 2.0 * piece.place.x,
                "z_max": piece.bounds.max.z,
                "z_min": piece.bounds.min.z,
                "diameter_max": 2.0 * piece.bounds.max.x,
                "diameter_min": 2.0 * piece.bounds.min.x,
                "area_mm2": piece.area_mm2,
                "line": spot.line.map(|(_, line)| line),
                "tool": spot.line.map(|_| spot.tool),
            })
        };
        json!({
            "target": self.name(),
            "tolerance": tolerance,
            "pass": self.beyond().is_empty(),
            "assumed_tools": self.assumed_tools(),
            "gouge_max": Self::deepest(&self.judgement.gouges),
            "rest_max": Self::deepest(&self.judgement.rests),
            "gouges": self.judgement.gouges_beyond(tolerance).map(one).collect::<Vec<_>>(),
            "rests": self.judgement.rests_beyond(tolerance).map(one).collect::<Vec<_>>(),
        })
    }

    /// The part with its gouges and rests in colour, and the contour of the target with its deviation.
    pub(super) fn overlay(&self, part: &Section, title: String) -> Overlay {
        let speech = self.speech;
        let beyond = self.beyond();
        let region = |(spot, is_gouge): &(&Spot, bool)| Region {
            colour: usize::from(!is_gouge),
            edges: spot.piece.edges.clone(),
        };
        let mark = |(spot, is_gouge): &(&Spot, bool)| OverlayMark {
            place: spot.piece.place,
            text: self.mark(spot, *is_gouge),
        };
        let most = |is_gouge: bool| {
            let spots = beyond.iter().filter(|(_, known)| *known == is_gouge);
            spots.map(|(spot, _)| spot.piece.deviation_mm).fold(self.tolerance_mm(), f64::max)
        };
        let (gouge_mm, rest_mm) = (most(true), most(false));
        let strokes = self.judgement.strokes().into_iter().map(|stroke| {
            let (shades, most_mm) =
                if stroke.deviation_mm < 0.0 { (GOUGE_SHADES, gouge_mm) } else { (REST_SHADES, rest_mm) };
            Stroke { way: stroke.way, colour: self.shade(stroke.deviation_mm.abs(), most_mm, shades) }
        });
        Overlay {
            title,
            subtitle: format!(
                "{}{}{}",
                speech.fill("target-title", &[("name", &self.name())]),
                speech.get("colon"),
                self.verdict()
            ),
            loops: part.contours().into_iter().map(|contour| contour.segments).collect(),
            figure: self.judgement.contour.clone(),
            strokes: strokes.collect(),
            regions: beyond.iter().map(region).collect(),
            legend: vec![
                (GOUGE, speech.get("target-gouge-legend").to_string()),
                (REST, speech.get("target-rest-legend").to_string()),
            ],
            scale: self.scale(gouge_mm, rest_mm),
            marks: beyond.iter().map(mark).collect(),
            language: picture_language(speech.language),
        }
    }

    fn mark(&self, spot: &Spot, is_gouge: bool) -> String {
        let values = [
            ("d", mm(spot.piece.deviation_mm)),
            ("z", mm(spot.piece.place.z)),
            ("x", mm(2.0 * spot.piece.place.x)),
            ("line", spot.line.map_or_else(String::new, |(_, line)| line.to_string())),
        ];
        let key = match (is_gouge, spot.line) {
            (true, Some(_)) => "target-mark-cut",
            (true, None) => "target-mark-missing",
            (false, _) => "target-mark-rest",
        };
        filled(self.speech, key, &values)
    }

    /// Thirds between the tolerance and the largest deviation.
    fn shade(&self, deviation_mm: f64, most_mm: f64, shades: [&'static str; 3]) -> &'static str {
        let tolerance = self.tolerance_mm();
        if deviation_mm <= tolerance {
            return GOOD;
        }
        let share = (deviation_mm - tolerance) / (most_mm - tolerance).max(f64::MIN_POSITIVE);
        shades[((share * 3.0) as usize).min(2)]
    }

    /// What the colours of the contour mean, from the deepest gouge to the highest rest.
    fn scale(&self, gouge_mm: f64, rest_mm: f64) -> Vec<(&'static str, String)> {
        let tolerance = self.tolerance_mm();
        let steps = |most_mm: f64, sign: &str, shades: [&'static str; 3]| -> Vec<(&'static str, String)> {
            if most_mm <= tolerance {
                return Vec::new();
            }
            let at = |third: u32| tolerance + (most_mm - tolerance) * f64::from(third) / 3.0;
            let step = |(shade, third): (&'static str, u32)| {
                (shade, format!("{sign}{}…{sign}{}", mm(at(third)), mm(at(third + 1))))
            };
            shades.into_iter().zip(0..).map(step).collect()
        };
        let mut scale = steps(gouge_mm, "−", GOUGE_SHADES);
        scale.reverse();
        scale.push((GOOD, format!("±{} mm", mm(tolerance))));
        scale.extend(steps(rest_mm, "+", REST_SHADES));
        scale
    }
}

fn filled(speech: Speech, key: &str, values: &[(&str, String)]) -> String {
    let values: Vec<(&str, &str)> = values.iter().map(|(name, value)| (*name, value.as_str())).collect();
    speech.fill(key, &values)
}
