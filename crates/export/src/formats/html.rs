//! The report: one HTML file that opens offline and asks nothing of the network.
//!
//! In: a recorded path and what there is to say about the run, in words of both languages. Out: one HTML text.
//! Look and behaviour are `assets/report.html`, `.css` and the two `.js`; this file only puts the run into them as
//! JSON, so that no text of a program ever becomes markup. Deliberately not here: choosing words.

mod part;
mod path;
mod plots;

use serde_json::{Value, json};
use turnwright_diagnostics::Severity;

pub use self::part::{PlaceMark, ReportPart};
pub use self::path::REPORT_SEGMENTS_MAX;
use self::path::{Kept, path_json};
use super::cutting_svg::CuttingPicture;
use super::svg::escape_xml;
use crate::Language;
use crate::passes::{Cause, Cycle, GivenWord, Pass};
use crate::path::PathRecorder;
use crate::timeline::Timeline;
use crate::words::{REPORT_TEXTS, Words};

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
    let kept = Kept::of(path, REPORT_SEGMENTS_MAX);
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
                "mark": found.mark.map(|mark| mark.json(&kept.moves)),
            })
        })
        .collect();
    let cycles: Vec<Value> =
        report.cycles.iter().map(|table| cycle_json(table, &kept, report.source)).collect();
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
        json.push_str(&part.json(&kept.moves));
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
fn cycle_json(table: &CycleTable, kept: &Kept<'_>, source: u32) -> Value {
    let cycle = &table.cycle;
    let index = |command| kept.moves.partition_point(|one| one.command < command);
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

#[cfg(test)]
mod tests {
    use super::path::PHASES;
    use super::*;
    use turnwright_canon::{Action, Command, CycleLabel, CycleOrigin, Origin, Phase, RapidPath};
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

    /// A column of runs, as the script reads it.
    fn read_runs(column: &Value) -> Vec<f64> {
        let numbers: Vec<f64> =
            column.as_array().expect("a column").iter().filter_map(Value::as_f64).collect();
        numbers.chunks(2).flat_map(|run| std::iter::repeat_n(run[1], run[0] as usize)).collect()
    }

    #[test]
    fn the_path_is_there_in_columns_of_equal_height() {
        let run = run_of(&write_html(&recorded(5), &Report::default()));
        let path = &run["path"];
        for name in ["first", "kind", "line", "figure", "cycle", "pass", "phase", "tool", "advance", "unit"] {
            assert_eq!(read_runs(&path[name]).len(), 5, "{name}");
        }
        assert_eq!((&path["moves"], path["elapsed"].as_array().map(Vec::len)), (&json!(5), Some(5)));
        assert_eq!(path["cycles"], json!(["G71.1"]));
        assert_eq!(path["phases"][read_runs(&path["phase"])[0] as usize - 1], "home");
        assert_eq!((read_runs(&path["figure"])[0], read_runs(&path["pass"])[0]), (2.0, 3.0));
        assert_eq!(path["jumps"], json!([0, 50, 100]));
        assert_eq!(path["elapsed"], json!([500, 500, 500, 500, 500]));
        // The first move goes from X100 Z100 to X40 Z0, round a corner; the second ends at X41 Z-1.
        let ends: Vec<f64> =
            path["ends"].as_array().expect("ends").iter().filter_map(Value::as_f64).collect();
        assert_eq!((ends[0] + ends[2], ends[1] + ends[3]), (200_000.0, 0.0));
        assert_eq!((path["incomplete"].as_bool(), path["joined_mm"].as_f64()), (Some(false), Some(0.0)));
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
        assert_eq!(run["path"]["elapsed"], json!([500, 2250]));
    }

    #[test]
    fn lines_of_another_text_are_not_lines_of_this_one() {
        let report = Report { source: 1, ..Report::default() };
        let run = run_of(&write_html(&recorded(1), &report));
        assert_eq!((&run["path"]["line"], &run["path"]["figure"]), (&json!([1, 0]), &json!([1, 0])));
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
