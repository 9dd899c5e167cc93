//! The report: one HTML file that opens offline and asks nothing of the network.
//!
//! In: a recorded path and what there is to say about the run, in words of both languages. Out: one HTML text.
//! Look and behaviour are `assets/report.html`, `.css` and the two `.js`; this file only puts the run into them as
//! JSON, so that no text of a program ever becomes markup. Deliberately not here: choosing words.

mod part;
mod plots;

use serde_json::{Value, json};
use turnwright_canon::Phase;
use turnwright_diagnostics::Severity;
use turnwright_units::write_fixed;

pub use self::part::{PlaceMark, ReportPart};
use super::cutting_svg::CuttingPicture;
use super::svg::{escape_xml, shown_extents};
use crate::Language;
use crate::passes::{Cause, Cycle, GivenWord, Pass};
use crate::path::{Advance, Move, PathRecorder, Segment, SegmentKind};
use crate::timeline::Timeline;
use crate::words::{REPORT_TEXTS, Words};

/// Segments in one report; about 20 MB of HTML. The report says when there are more.
pub const REPORT_SEGMENTS_MAX: usize = 300_000;

const TEMPLATE: &str = include_str!("../../assets/report.html");
const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = concat!(
    include_str!("../../assets/report-path.js"),
    include_str!("../../assets/report-part.js"),
    include_str!("../../assets/report-drawing.js"),
    include_str!("../../assets/report-solid.js"),
    include_str!("../../assets/report-tables.js"),
    include_str!("../../assets/report-cycles.js"),
    include_str!("../../assets/report-plots.js"),
    include_str!("../../assets/report.js")
);

/// three.js, for the part in space; `assets/make_three.sh` makes it. It is run when a reader asks for it.
const THREE: &str = include_str!("../../assets/three.bundle.js");

/// What the report says around the path.
#[derive(Clone, Debug, Default)]
pub struct Report<'a> {
    /// Heading, usually the file's name.
    pub title: String,
    /// Name of the control.
    pub control: String,
    /// Why that control was used.
    pub control_reason: String,
    /// Which program text `program_lines` is, as the origins of the commands number it.
    pub source: u32,
    /// The program, line by line, without line ends.
    pub program_lines: Vec<String>,
    /// What each tool did.
    pub operations: Vec<OperationRow>,
    /// The passes of each cycle.
    pub cycles: Vec<CycleTable>,
    /// What was found.
    pub diagnostics: Vec<ReportDiagnostic>,
    /// Anything else worth knowing, in order.
    pub facts: Vec<Fact>,
    /// What was assumed of stock and tools: sentences, and the lines they are from, 0 for none.
    pub assumptions: Vec<AssumptionRow>,
    /// The part that comes out, where there is stock.
    pub part: Option<ReportPart<'a>>,
    /// Places and speeds over time.
    pub timeline: Option<&'a Timeline>,
    /// The cutting data over the same time, in English and in Chinese.
    pub cutting: Option<[CuttingPicture; 2]>,
    /// What the times rest on, English; may be empty.
    pub estimated_note_en: String,
    /// What the times rest on, Chinese; may be empty.
    pub estimated_note_zh: String,
    /// Language at opening; the reader can change it.
    pub language: Language,
}

/// One row of the table of operations.
#[derive(Clone, Debug, Default)]
pub struct OperationRow {
    /// Number from 1.
    pub index: u32,
    /// Turret station.
    pub tool: Option<u32>,
    /// What it is, English.
    pub name_en: String,
    /// What it is, Chinese.
    pub name_zh: String,
    /// The code as written, may be empty.
    pub code: String,
    /// First line, from 1.
    pub first_line: u32,
    /// Last line.
    pub last_line: u32,
    /// Number of passes, 0 when it has none.
    pub passes: u32,
    /// Way cut.
    pub cutting_mm: f64,
    /// Way at rapid.
    pub rapid_mm: f64,
    /// Time.
    pub seconds: f64,
}

/// Something that was assumed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AssumptionRow {
    /// Line from 1, 0 when it comes from no line.
    pub line: u32,
    /// The sentence, English.
    pub text_en: String,
    /// The sentence, Chinese.
    pub text_zh: String,
}

/// A cycle with the words that only the control knows.
#[derive(Clone, Debug)]
pub struct CycleTable {
    /// Its passes.
    pub cycle: Cycle,
    /// What it is, English.
    pub name_en: String,
    /// What it is, Chinese.
    pub name_zh: String,
    /// What its settings are called, in their order, English and Chinese.
    pub setting_names: Vec<[String; 2]>,
}

/// A diagnostic in words already chosen.
#[derive(Clone, Debug)]
pub struct ReportDiagnostic {
    /// How much it matters.
    pub severity: Severity,
    /// The control's own number or the check's.
    pub id: String,
    /// Name of the diagnostic.
    pub key: String,
    /// Line from 1, 0 when it concerns the program as a whole.
    pub line: u32,
    /// First byte, counted from 1.
    pub column: u32,
    /// First byte behind.
    pub end_column: u32,
    /// Message, English.
    pub message_en: String,
    /// Cause, English.
    pub cause_en: String,
    /// Remedy, English.
    pub remedy_en: String,
    /// Message, Chinese.
    pub message_zh: String,
    /// Cause, Chinese.
    pub cause_zh: String,
    /// Remedy, Chinese.
    pub remedy_zh: String,
    /// Where in the section.
    pub mark: Option<PlaceMark>,
}

/// A fact in a row of its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fact {
    /// What, English.
    pub label_en: String,
    /// What, Chinese.
    pub label_zh: String,
    /// How much.
    pub value: String,
}

impl From<(String, String, String)> for Fact {
    fn from((label_en, label_zh, value): (String, String, String)) -> Self {
        Self { label_en, label_zh, value }
    }
}

/// The report as one HTML text.
pub fn write_html(path: &PathRecorder, report: &Report<'_>) -> String {
    let run = run_json(path, report);
    let mut html = String::with_capacity(run.len() + TEMPLATE.len() + STYLE.len() + SCRIPT.len() + 16_384);
    // Each place of the template is filled once; what is filled in is never searched again.
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        html.push_str(before);
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        match name {
            "language" => html.push_str(report.language.tag()),
            "title" => html.push_str(&escape_xml(&report.title)),
            "control" => html.push_str(&escape_xml(&report.control)),
            "control_reason" => html.push_str(&escape_xml(&report.control_reason)),
            "no_script" => html.push_str(&escape_xml(Words::new(report.language).get("no-script"))),
            "no_script_part" => {
                let drawing = report.part.as_ref().map(|part| part.drawing(&report.title, report.language));
                html.push_str(drawing.as_deref().unwrap_or_default());
            }
            "style" => html.push_str(STYLE),
            "solid" if report.part.as_ref().is_some_and(|part| part.has_solid) => {
                html.push_str("<script type=\"text/plain\" id=\"turnwright-three\">");
                html.push_str(THREE);
                html.push_str("</script>\n");
            }
            "script" => html.push_str(SCRIPT),
            "texts" => html.push_str(&inert_json(REPORT_TEXTS)),
            "run" => html.push_str(&run),
            _ => {}
        }
        rest = after;
    }
    html.push_str(rest);
    html
}

/// JSON that cannot end the script element it stands in: `<` occurs in JSON only inside strings.
fn inert_json(json: &str) -> String {
    json.replace('<', "\\u003c")
}

fn run_json(path: &PathRecorder, report: &Report<'_>) -> String {
    let kept = kept(path);
    let both = |en: &str, zh: &str| json!({ "en": en, "zh": zh });
    let operations: Vec<Value> = report
        .operations
        .iter()
        .map(|row| {
            json!({
                "index": row.index, "tool": row.tool, "name": both(&row.name_en, &row.name_zh), "code": row.code,
                "first": row.first_line, "last": row.last_line.max(row.first_line), "passes": row.passes,
                "cutting_mm": row.cutting_mm, "rapid_mm": row.rapid_mm, "seconds": row.seconds,
            })
        })
        .collect();
    let diagnostics: Vec<Value> = report
        .diagnostics
        .iter()
        .map(|found| {
            let text = report.program_lines.get((found.line as usize).wrapping_sub(1)).map_or("", String::as_str);
            json!({
                "severity": severity_word(found.severity), "id": found.id, "key": found.key, "line": found.line,
                "from": utf16_column(text, found.column), "to": utf16_column(text, found.end_column),
                "message": both(&found.message_en, &found.message_zh), "cause": both(&found.cause_en, &found.cause_zh),
                "remedy": both(&found.remedy_en, &found.remedy_zh),
                "mark": found.mark.map(|mark| mark.json(kept.moves)),
            })
        })
        .collect();
    let cycles: Vec<Value> =
        report.cycles.iter().map(|table| cycle_json(table, path, report.source)).collect();
    let facts: Vec<Value> = report
        .facts
        .iter()
        .map(|fact| json!({ "label": both(&fact.label_en, &fact.label_zh), "value": fact.value }))
        .collect();
    let assumptions: Vec<Value> = report
        .assumptions
        .iter()
        .map(|one| json!({ "line": one.line, "text": both(&one.text_en, &one.text_zh) }))
        .collect();
    let head = json!({
        "assumptions": assumptions, "language": report.language.tag(), "program": report.program_lines, "operations": operations,
        "cycles": cycles, "diagnostics": diagnostics, "facts": facts,
        "note": both(&report.estimated_note_en, &report.estimated_note_zh),
    });
    let mut json = inert_json(&head.to_string());
    json.truncate(json.len() - 1);
    json.push_str(",\n\"path\":");
    json.push_str(&path_json(path, &kept, report.source));
    if let Some(part) = &report.part {
        json.push_str(",\n\"part\":");
        json.push_str(&part.json(kept.moves));
    }
    if let Some(plots) =
        report.timeline.and_then(|timeline| plots::plots_json(timeline, report.cutting.as_ref()))
    {
        json.push_str(",\n\"plots\":");
        json.push_str(&inert_json(&plots.to_string()));
    }
    json.push('}');
    json
}

/// A cycle: its moves are those with indices from `first` up to `end`.
fn cycle_json(table: &CycleTable, path: &PathRecorder, source: u32) -> Value {
    let cycle = &table.cycle;
    let moves = path.moves();
    let index = |command| moves.partition_point(|one| one.command < command);
    let here = cycle.source == source;
    let settings: Vec<Value> = cycle
        .settings
        .iter()
        .zip(&table.setting_names)
        .map(|(setting, [en, zh])| {
            let source = match &setting.given {
                Some(word) => cause_json(&Cause::Word(word.clone())),
                None => cause_json(&Cause::Parameter(setting.number.clone())),
            };
            json!({ "name": { "en": en, "zh": zh }, "value": setting.value, "cause": source })
        })
        .collect();
    let row = |pass: &Pass| {
        let causes: Vec<Value> = pass.causes.iter().map(cause_json).collect();
        json!({
            "number": pass.number, "line": if here { pass.line } else { 0 }, "phase": pass.phase.word(),
            "depth": pass.depth.to_mm(), "causes": causes,
            "from": [pass.from.x.to_diameter().0.to_mm(), pass.from.z.to_mm()],
            "to": [pass.to.x.to_diameter().0.to_mm(), pass.to.z.to_mm()],
        })
    };
    json!({
        "code": cycle.label.to_string(), "name": { "en": table.name_en, "zh": table.name_zh },
        "line": if here { cycle.line } else { 0 }, "settings": settings,
        "first": index(cycle.commands.start), "end": index(cycle.commands.end),
        "passes": cycle.passes.iter().map(row).collect::<Vec<_>>(),
    })
}

/// A cause as the key of its sentence and what stands in it.
fn cause_json(cause: &Cause) -> Value {
    match cause {
        Cause::Word(GivenWord { text, line }) => json!({ "key": "pass-by-word", "word": text, "line": line }),
        Cause::Parameter(number) => json!({ "key": "pass-by-parameter", "number": number }),
        Cause::Figure(first, last) if first == last => {
            json!({ "key": "pass-by-figure-line", "first": first })
        }
        Cause::Figure(first, last) => json!({ "key": "pass-by-figure-lines", "first": first, "last": last }),
    }
}

const fn severity_word(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
        Severity::Alarm => "alarm",
    }
}

/// The column of a byte (from 1) as an index from 0 into the text as browsers count it.
fn utf16_column(text: &str, column: u32) -> usize {
    let byte = (column as usize).saturating_sub(1);
    text.char_indices().take_while(|(at, _)| *at < byte).map(|(_, c)| c.len_utf16()).sum()
}

/// Columns of numbers, as JSON arrays.
#[derive(Default)]
struct Column(Vec<u8>);

impl Column {
    fn push(&mut self, value: i64, decimals: u8) {
        if !self.0.is_empty() {
            self.0.push(b',');
        }
        write_fixed(&mut self.0, value, decimals);
    }

    fn push_whole(&mut self, value: impl Into<i64>) {
        self.push(value.into(), 0);
    }

    /// A length in millimetres with four places, a tenth of the finest increment in use.
    fn push_mm(&mut self, value: f32) {
        self.push((f64::from(value) * 1e4).round() as i64, 4);
    }

    /// A length in millimetres to the nanometre.
    fn push_nm(&mut self, mm: f64) {
        self.push((mm * 1e6).round() as i64, 6);
    }

    /// Adds it to an object that is being written.
    fn write(&self, name: &str, out: &mut String) {
        out.push_str(",\n\"");
        out.push_str(name);
        out.push_str("\":[");
        out.push_str(std::str::from_utf8(&self.0).unwrap_or_default());
        out.push(']');
    }
}

/// What of a path is in the report: all of it, or whole moves up to the limit.
struct Kept<'a> {
    moves: &'a [Move],
    segments: &'a [Segment],
    incomplete: bool,
}

fn kept(path: &PathRecorder) -> Kept<'_> {
    let segments = path.segments();
    let moves_kept = path.moves().partition_point(|one| (one.segment_first as usize) < REPORT_SEGMENTS_MAX);
    // A move at the limit with a corner would lose its second half.
    let incomplete = segments.len() > REPORT_SEGMENTS_MAX || path.segments_dropped() > 0;
    let moves_kept = if segments.len() > REPORT_SEGMENTS_MAX { moves_kept - 1 } else { moves_kept };
    let segments_kept =
        path.moves().get(moves_kept).map_or(segments.len(), |next| next.segment_first as usize);
    Kept { moves: &path.moves()[..moves_kept], segments: &segments[..segments_kept], incomplete }
}

/// The path as columns; the script's first page says what each is. Zero means "none" in the columns that
/// count from 1.
fn path_json(path: &PathRecorder, kept: &Kept<'_>, source: u32) -> String {
    let Kept { moves, segments, incomplete } = *kept;
    let [mut ends, mut jumps, mut arcs] = [const { Column(Vec::new()) }; 3];
    let mut pen = None;
    for (index, segment) in segments.iter().enumerate() {
        if pen != Some(segment.start) {
            jumps.push_whole(index as i64);
            jumps.push_mm(segment.start.radius_mm);
            jumps.push_mm(segment.start.z_mm);
        }
        ends.push_mm(segment.end.radius_mm);
        ends.push_mm(segment.end.z_mm);
        if let Some(bow) = segment.bow {
            arcs.push_whole(index as i64);
            arcs.push_mm(bow.centre.radius_mm);
            arcs.push_mm(bow.centre.z_mm);
            arcs.push((f64::from(bow.sweep_rad) * 1e7).round() as i64, 7);
        }
        pen = Some(segment.end);
    }

    let mut labels = Vec::new();
    let [mut first, mut kind, mut line, mut figure, mut cycle, mut pass] = [const { Column(Vec::new()) }; 6];
    let [mut phase, mut tool, mut advance, mut unit, mut elapsed] = [const { Column(Vec::new()) }; 5];
    let (mut waits, mut before_s) = (Column::default(), 0.0);
    for (index, one) in moves.iter().enumerate() {
        // Dwells, tool changes and whatever else passes before the tool moves.
        let wait_ms = ((one.elapsed_s - f64::from(one.seconds) - before_s) * 1e3).round() as i64;
        if wait_ms > 0 {
            waits.push_whole(index as i64);
            waits.push(wait_ms, 3);
        }
        before_s = one.elapsed_s;
        let here = one.source == source;
        first.push_whole(one.segment_first);
        kind.push_whole(kind_number(segments[one.segment_first as usize].kind));
        line.push_whole(if here { one.line } else { 0 });
        figure.push_whole(one.figure_line.filter(|_| here).map_or(0, |line| line.get()));
        cycle.push_whole(one.cycle.map_or(0, |cycle| {
            let at = labels.iter().position(|label| *label == cycle.label).unwrap_or_else(|| {
                labels.push(cycle.label);
                labels.len() - 1
            });
            at as i64 + 1
        }));
        pass.push_whole(one.cycle.map_or(0, |cycle| cycle.pass));
        phase.push_whole(one.cycle.map_or(0, |cycle| phase_number(cycle.phase)));
        tool.push_whole(one.tool);
        let (value, number) = match one.advance {
            None => (0.0, 0),
            Some(Advance::MmPerRevolution(value)) => (value, 1),
            Some(Advance::MmPerMinute(value)) => (value, 2),
            Some(Advance::LeadMm(value)) => (value, 3),
        };
        advance.push((f64::from(value) * 1e5).round() as i64, 5);
        unit.push_whole(number);
        elapsed.push((one.elapsed_s * 1e3).round() as i64, 3);
    }

    let shown = shown_extents(path, 2.0);
    let view = [shown.radius_min_mm, shown.radius_max_mm, shown.z_min_mm, shown.z_max_mm];
    let words: Vec<&str> = PHASES.iter().map(|phase| phase.word()).collect();
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    let mut out = format!(
        "{{\"view\":{},\"incomplete\":{incomplete},\"phases\":{},\"cycles\":{}",
        json!(view),
        json!(words),
        json!(labels)
    );
    for (name, column) in [
        ("ends", ends),
        ("jumps", jumps),
        ("arcs", arcs),
        ("first", first),
        ("kind", kind),
        ("line", line),
        ("figure", figure),
        ("cycle", cycle),
        ("pass", pass),
        ("phase", phase),
        ("tool", tool),
        ("advance", advance),
        ("unit", unit),
        ("elapsed", elapsed),
        ("waits", waits),
    ] {
        column.write(name, &mut out);
    }
    out.push('}');
    out
}

const fn kind_number(kind: SegmentKind) -> u32 {
    match kind {
        SegmentKind::Rapid => 0,
        SegmentKind::Feed => 1,
        SegmentKind::Thread => 2,
    }
}

/// The phases in the order of their numbers, from 1.
const PHASES: [Phase; 15] = [
    Phase::Approach,
    Phase::Infeed,
    Phase::Cut,
    Phase::Escape,
    Phase::Return,
    Phase::Contour,
    Phase::Finish,
    Phase::Peck,
    Phase::Back,
    Phase::Relief,
    Phase::Shift,
    Phase::Thread,
    Phase::Chamfer,
    Phase::Out,
    Phase::Home,
];

fn phase_number(phase: Phase) -> u32 {
    PHASES.iter().position(|one| *one == phase).map_or(0, |at| at as u32 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use turnwright_canon::{Action, Command, CycleLabel, CycleOrigin, Origin, RapidPath};
    use turnwright_units::{Length, Position, Radius, WorkTip};

    fn at(diameter_mm: i64, z_mm: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(diameter_mm * 500_000)), Length::from_mm(z_mm))
    }

    fn recorded(moves: u32) -> PathRecorder {
        let mut path = PathRecorder::new(at(100, 100), 5_000.0, 10_000.0);
        for number in 0..moves {
            let to = at(40 + i64::from(number % 2), -((number % 1000) as i32));
            let cycle = Some(CycleOrigin { label: CycleLabel(711), pass: 3, phase: Phase::Home });
            let origin = Origin { cycle, figure_line: Some(2), ..Origin::line(1) };
            path.add(
                &Command::new(Action::Rapid { to, path: RapidPath::EachAxis, others: None }, origin),
                0.5,
            );
        }
        path
    }

    /// The run as a browser would read it from the page.
    fn run_of(html: &str) -> Value {
        let (_, after) = html.split_once("id=\"turnwright-run\">").expect("the run");
        let (run, _) = after.split_once("</script>").expect("its end");
        serde_json::from_str(run).expect("JSON")
    }

    fn hostile() -> Report<'static> {
        let evil = "</script><script>alert(1)</script><!-- {{run}} {{script}} & \u{0}\u{2028}\" '".to_owned();
        Report {
            title: evil.clone(),
            control: evil.clone(),
            control_reason: evil.clone(),
            program_lines: vec![evil.clone(), "G01 车 X10".into()],
            operations: vec![OperationRow {
                name_en: evil.clone(),
                code: evil.clone(),
                ..OperationRow::default()
            }],
            cycles: vec![CycleTable {
                cycle: Cycle {
                    label: CycleLabel(711),
                    function: evil.clone(),
                    source: 0,
                    line: 1,
                    start: at(40, 0),
                    settings: Vec::new(),
                    passes: vec![Pass {
                        number: 3,
                        line: 1,
                        phase: Phase::Cut,
                        depth: Length::ZERO,
                        from: at(40, 0),
                        to: at(40, -1),
                        causes: vec![Cause::Word(GivenWord { text: evil.clone(), line: 1 })],
                    }],
                    commands: 1..3,
                },
                name_en: evil.clone(),
                name_zh: evil.clone(),
                setting_names: Vec::new(),
            }],
            facts: vec![Fact { label_en: evil.clone(), label_zh: evil.clone(), value: evil.clone() }],
            diagnostics: vec![ReportDiagnostic {
                severity: Severity::Alarm,
                id: evil.clone(),
                key: evil.clone(),
                line: 2,
                column: 9,
                end_column: 12,
                message_en: evil.clone(),
                cause_en: evil.clone(),
                remedy_en: evil.clone(),
                message_zh: evil.clone(),
                cause_zh: evil.clone(),
                remedy_zh: evil.clone(),
                mark: None,
            }],
            assumptions: vec![AssumptionRow { line: 1, text_en: evil.clone(), text_zh: evil.clone() }],
            ..Report::default()
        }
    }

    #[test]
    fn no_text_breaks_out_of_its_place() {
        let report = hostile();
        let html = write_html(&recorded(3), &report);
        // Two blocks of data and one script, as in the template.
        assert_eq!(html.matches("<script").count(), 3);
        assert_eq!(html.matches("</script").count(), 3);
        assert_eq!(html.matches("<!--").count(), 0);
        assert!(!html.contains("<script>alert"));
        let run = run_of(&html);
        assert_eq!(run["program"][0], report.program_lines[0]);
        let cycle = &run["cycles"][0];
        assert_eq!((&cycle["first"], &cycle["end"], &cycle["code"]), (&json!(1), &json!(3), &json!("G71.1")));
        assert_eq!(cycle["passes"][0]["causes"][0]["word"], report.program_lines[0]);
        assert_eq!(run["diagnostics"][0]["message"]["zh"], report.diagnostics[0].message_zh);
    }

    #[test]
    fn nothing_is_fetched() {
        let html = write_html(&recorded(3), &hostile());
        for address in ["http://", "https://", "//cdn", "src=", "@import", "url("] {
            assert!(!html.contains(address), "{address}");
        }
        assert!(html.contains("default-src 'none'"));
        assert!(!html.contains("{{style}}") && html.contains("\"use strict\""));
    }

    #[test]
    fn three_stays_in_its_element_and_names_its_licence() {
        assert!(!THREE.contains("<script") && !THREE.contains("</script") && !THREE.contains("<!--"));
        assert!(THREE.starts_with("/*! three.js") && THREE.contains("Permission is hereby granted"));
        // The one address is the name of an XML vocabulary, which nobody fetches.
        let addresses = THREE.matches("http://").count() + THREE.matches("https://").count();
        assert_eq!(addresses, THREE.matches("http://www.w3.org/1999/xhtml").count());
    }

    #[test]
    fn columns_count_as_browsers_do() {
        // 车 has three bytes and is one unit; the tenth byte is the X.
        assert_eq!(utf16_column("G01 车 X10", 9), 6);
        assert_eq!(utf16_column("G01 车 X10", 12), 9);
        assert_eq!(utf16_column("G01", 99), 3);
        assert_eq!(utf16_column("", 0), 0);
        let run = run_of(&write_html(&recorded(0), &hostile()));
        assert_eq!((&run["diagnostics"][0]["from"], &run["diagnostics"][0]["to"]), (&json!(6), &json!(9)));
    }

    #[test]
    fn the_path_is_there_in_columns_of_equal_height() {
        let run = run_of(&write_html(&recorded(5), &Report::default()));
        let path = &run["path"];
        let height = |name: &str| path[name].as_array().expect("a column").len();
        for name in ["kind", "line", "figure", "cycle", "pass", "phase", "tool", "advance", "unit", "elapsed"]
        {
            assert_eq!(height(name), height("first"), "{name}");
        }
        assert_eq!(height("first"), 5);
        assert_eq!(path["cycles"], json!(["G71.1"]));
        assert_eq!(path["phases"][path["phase"][0].as_u64().expect("a number") as usize - 1], "home");
        assert_eq!((&path["figure"][0], &path["pass"][0]), (&json!(2), &json!(3)));
        assert_eq!(path["jumps"], json!([0, 50, 100]));
        assert_eq!(path["elapsed"][4], 2.5);
        assert_eq!(path["incomplete"], false);
    }

    #[test]
    fn what_passes_before_a_move_is_told_apart() {
        let mut path = recorded(1);
        let dwell = Action::Dwell(turnwright_canon::Dwell::Time(turnwright_units::Seconds(2.0)));
        path.add(&Command::new(dwell, Origin::line(1)), 2.0);
        let to = at(80, 7);
        path.add(
            &Command::new(Action::Rapid { to, path: RapidPath::Straight, others: None }, Origin::line(1)),
            0.25,
        );
        let run = run_of(&write_html(&path, &Report::default()));
        assert_eq!(run["path"]["waits"], json!([1, 2]));
        assert_eq!(run["path"]["elapsed"], json!([0.5, 2.75]));
    }

    #[test]
    fn lines_of_another_text_are_not_lines_of_this_one() {
        let report = Report { source: 1, ..Report::default() };
        let run = run_of(&write_html(&recorded(1), &report));
        assert_eq!((&run["path"]["line"][0], &run["path"]["figure"][0]), (&json!(0), &json!(0)));
    }

    #[test]
    fn a_path_that_is_too_long_is_cut_between_moves_and_says_so() {
        let run = run_of(&write_html(&recorded(REPORT_SEGMENTS_MAX as u32), &Report::default()));
        let path = &run["path"];
        assert_eq!(path["incomplete"], true);
        let segments = path["ends"].as_array().expect("ends").len() / 2;
        assert!(segments <= REPORT_SEGMENTS_MAX && segments > REPORT_SEGMENTS_MAX - 3, "{segments}");
    }

    #[test]
    fn every_text_that_the_script_asks_for_exists() {
        let texts: Value = serde_json::from_str(REPORT_TEXTS).expect("JSON");
        let asked = |text: &str, before: &str| {
            let parts: Vec<String> = text.split(before).skip(1).map(str::to_owned).collect();
            parts
                .into_iter()
                .map(|part| part.split('"').next().unwrap_or_default().to_owned())
                .collect::<Vec<_>>()
        };
        let mut keys = asked(SCRIPT, "word(\"");
        for attribute in ["data-text=\"", "data-title=\"", "data-label=\""] {
            keys.extend(asked(TEMPLATE, attribute));
        }
        keys.extend(["word", "parameter", "figure-line", "figure-lines"].map(|end| format!("pass-by-{end}")));
        keys.extend(PHASES.iter().map(|phase| format!("phase-{}", phase.word())));
        for severity in [Severity::Note, Severity::Warning, Severity::Error, Severity::Alarm] {
            keys.push(format!("severity-{}", severity_word(severity)));
        }
        assert!(keys.len() > 50);
        for key in keys.iter().filter(|key| !key.ends_with('-')) {
            assert!(texts.get(key).is_some(), "{key}");
        }
    }
}
