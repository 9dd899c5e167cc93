//! `turnwright diff`: what an edit changed in passes, part and time.
//!
//! In: two programs, each with its own setup; or what git gives an external diff. Out: the steps that changed, the places
//! where the part did, the time of the operations, and the alarms and warnings that came or went; nothing of the text.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use turnwright_export::formats::overlay_svg::{Overlay, OverlayMark, Region, write_overlay_svg};
use turnwright_export::formats::part_svg::mm;
use turnwright_motion::Operation;
use turnwright_stock::Section;
use turnwright_verify::Checks;
use turnwright_verify::changes::{Change, StepKind, Steps, changes};
use turnwright_verify::comparison::{Comparison, GRAIN_MM, Piece, Shift, shift};
use turnwright_verify::part::Part;

use super::plot::write_picture;
use crate::arguments::{Diff, LookupFormat, Machine};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::finding::Finding;
use crate::part;
use crate::rates::rates;
use crate::render::{Printer, clean};
use crate::report::{Kept, Measure, operation_name, picture_language};
use crate::session::Session;
use crate::speech::Speech;
use crate::table::heading;

/// Lines of a list that people read.
const SHOWN_MAX: usize = 20;

/// Times that differ by less are equal, s.
const SECONDS: f64 = 1e-6;

/// Compares two programs.
pub(crate) fn run(options: &Diff, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let asked = Asked::new(options, speech)?;
    let old = Side::new(&asked.old, &asked.machine, speech)?;
    let new = Side::new(&asked.new, &asked.machine, speech)?;
    let difference = Difference::new(&old, &new, speech);
    if let Some(target) = &options.output {
        let title = format!("{} → {}", old.name, new.name);
        let picture = write_overlay_svg(&difference.overlay(title, speech));
        write_picture(target, &picture, speech)?;
    }
    let mut out = printer.standard_output();
    match options.format {
        LookupFormat::Human => {
            if let Some(path) = &asked.shown {
                out.write_all(format!("{}\n", heading(&clean(path))).as_bytes())?;
            }
            out.write_all(difference.human(speech).as_bytes())?;
        }
        LookupFormat::Json => writeln!(out, "{}", difference.json(speech))?,
    }
    out.flush()?;
    Ok(if difference.is_empty() || asked.is_of_git { Status::Clean } else { Status::Found })
}

/// Which programs, and how git asks for them.
struct Asked {
    old: PathBuf,
    new: PathBuf,
    machine: Machine,
    /// The name to show, when the files are copies that git made.
    shown: Option<String>,
    is_of_git: bool,
}

impl Asked {
    fn new(options: &Diff, speech: Speech) -> Result<Self, Fault> {
        let mut machine = options.machine.clone();
        match options.files.as_slice() {
            [old, new] => {
                Ok(Self { old: old.clone(), new: new.clone(), machine, shown: None, is_of_git: false })
            }
            // Path, old file, hash and mode, new file, hash and mode; of a renamed file its new name and a text more.
            [path, old, _, _, new, _, _] | [path, old, _, _, new, _, _, _, _] => {
                // The copies that git makes have no setup beside them; the program has.
                let beside = path.with_extension("toml");
                if machine.setup.is_none() && beside != *path && beside.is_file() {
                    machine.setup = Some(beside);
                }
                let shown = Some(path.display().to_string());
                Ok(Self { old: old.clone(), new: new.clone(), machine, shown, is_of_git: true })
            }
            _ => Err(Fault::Usage(speech.get("diff-arguments").to_string())),
        }
    }
}

/// All there is to know of a program.
struct Side {
    name: String,
    session: Session,
    steps: Steps,
    measure: Measure,
    part: Option<Part>,
    findings: Vec<Finding>,
}

impl Side {
    fn new(path: &Path, options: &Machine, speech: Speech) -> Result<Self, Fault> {
        let text = ProgramText::open(path, speech)?;
        let session = Session::choose(&text, options, speech)?;
        let machine = session.machine()?;
        let mut execution = Execution::new(&text, &session, options)?;
        let start = execution.interpreter().position();
        let (mut steps, mut checks) = (Steps::new(start), Checks::new(start));
        while let Some(command) = execution.next_command() {
            steps.add(&command);
            checks.add(&command);
        }
        let checked = checks.finish(&session.setup);
        let rates = rates(&machine, &session.control.parameters, options.optional_stop);
        let mut measure = Measure::new(start, rates, Kept::default());
        let mut look = |_: &Execution<'_>, _: &mut Measure| Ok(());
        let part =
            part::machined(&text, &session, options, &checked.inferred, None, Some(&mut measure), &mut look)?;
        let judged = part::judged(part.as_ref(), &session.setup, execution.alarm());
        let of_part = part.iter().flat_map(|part| part.findings.clone()).collect::<Vec<_>>();
        let told = checked.findings.into_iter().chain(measure.warnings()).chain(of_part);
        told.chain(part::out_of_tolerance(&judged)).for_each(|finding| execution.warn(finding));
        let findings = execution.findings();
        let name = text.name.rsplit('/').next().unwrap_or(&text.name).to_string();
        Ok(Self { name, session, steps, measure, part, findings })
    }

    fn seconds(&self) -> f64 {
        self.measure.summary.totals().total_s()
    }

    fn section(&self) -> Section {
        self.part.as_ref().map(|part| part.section.clone()).unwrap_or_default()
    }
}

/// An operation that takes another time, or is in one program only.
struct OperationChange {
    name: String,
    tool: Option<u32>,
    line: u32,
    old_s: Option<f64>,
    new_s: Option<f64>,
}

/// A diagnostic that is in one program only.
struct FindingChange {
    came: bool,
    severity: &'static str,
    id: String,
    line: u32,
    message: String,
}

struct Difference<'a> {
    old: &'a Side,
    new: &'a Side,
    steps: Vec<Change>,
    parts: Comparison,
    sections: (Section, Section),
    operations: Vec<OperationChange>,
    findings: Vec<FindingChange>,
}

impl<'a> Difference<'a> {
    fn new(old: &'a Side, new: &'a Side, speech: Speech) -> Self {
        let sections = (old.section(), new.section());
        Self {
            old,
            new,
            steps: changes(&old.steps, &new.steps),
            parts: Comparison::new(&sections.0, &sections.1, GRAIN_MM),
            sections,
            operations: operations(old, new, speech),
            findings: findings(old, new, speech),
        }
    }

    fn is_empty(&self) -> bool {
        self.steps.is_empty()
            && self.parts.is_empty()
            && self.operations.is_empty()
            && self.findings.is_empty()
            && (self.old.seconds() - self.new.seconds()).abs() < SECONDS
    }

    /// How many passes changed, were added, were removed.
    fn passes(&self) -> [usize; 3] {
        let of_passes = || self.steps.iter().filter(|change| change.kind() == StepKind::Pass);
        let count = |wanted: fn(&Change) -> bool| of_passes().filter(|change| wanted(change)).count();
        [
            count(|change| change.old.is_some() && change.new.is_some()),
            count(|change| change.old.is_none()),
            count(|change| change.new.is_none()),
        ]
    }

    /// The change of the passes that reaches furthest in X, and the place.
    fn furthest(&self) -> Option<(f64, f64)> {
        let of_passes = self.steps.iter().filter(|change| change.kind() == StepKind::Pass);
        let moved = of_passes.filter_map(Change::moved).filter(|moved| moved.x_mm != 0.0);
        moved.max_by(|a, b| a.x_mm.abs().total_cmp(&b.x_mm.abs())).map(|moved| (moved.x_mm, moved.at_z_mm))
    }

    /// Pieces of the part that changed; whether the old one has them.
    fn pieces(&self) -> impl Iterator<Item = (&Piece, bool)> {
        let old = self.parts.only_first.iter().map(|piece| (piece, true));
        old.chain(self.parts.only_second.iter().map(|piece| (piece, false)))
    }

    fn piece_text(&self, piece: &Piece, of_old: bool, speech: Speech) -> String {
        let (min, max) = (piece.bounds.min, piece.bounds.max);
        let (z1, z2) = (mm(max.z), mm(min.z));
        let fill = |key: &str, old: f64, new: f64| {
            let values = [("old", mm(old)), ("new", mm(new)), ("z1", z1.clone()), ("z2", z2.clone())];
            filled(speech, key, &values)
        };
        let text = match shift(piece, of_old, &self.sections.0, &self.sections.1) {
            Some(Shift::Diameter(old, new)) => fill("diff-diameter", old, new),
            Some(Shift::Bore(old, new)) => fill("diff-bore", old, new),
            Some(Shift::Face(old, new)) => {
                let (x1, x2) = (mm(2.0 * max.x), mm(2.0 * min.x));
                filled(speech, "diff-face", &[("old", mm(old)), ("new", mm(new)), ("x1", x1), ("x2", x2)])
            }
            None if of_old => fill("diff-lost", 0.0, 0.0),
            None => fill("diff-gained", 0.0, 0.0),
        };
        let values = [("text", text), ("d", mm(piece.deviation_mm)), ("a", mm(piece.area_mm2))];
        filled(speech, "diff-deviation", &values)
    }

    fn human(&self, speech: Speech) -> String {
        let mut out = String::new();
        if self.old.steps.is_cut_short() || self.new.steps.is_cut_short() {
            out.push_str(&format!("{}\n", speech.get("diff-cut-short")));
        }
        if self.is_empty() {
            out.push_str(&format!("{}\n", speech.get("diff-same")));
            return out;
        }
        let seconds = self.new.seconds() - self.old.seconds();
        out.push_str(&format!("{}\n", self.headline(speech)));
        let mut section = |key: &'static str, lines: Vec<String>| {
            if lines.is_empty() {
                return;
            }
            out.push_str(&format!("\n{}\n", heading(speech.get(key))));
            for line in lines.iter().take(SHOWN_MAX) {
                out.push_str(&format!("  {line}\n"));
            }
            if let Some(more) = lines.len().checked_sub(SHOWN_MAX).filter(|more| *more > 0) {
                out.push_str(&format!("  {}\n", speech.fill("diff-more", &[("n", &more.to_string())])));
            }
        };
        section("diff-passes", self.steps.iter().map(|change| self.step_text(change, speech)).collect());
        let mut part: Vec<String> =
            self.pieces().map(|(piece, of_old)| self.piece_text(piece, of_old, speech)).collect();
        let volumes = [&self.sections.0, &self.sections.1].map(|section| section.volume_mm3() / 1000.0);
        if !part.is_empty() {
            let values =
                [("old", mm(volumes[0])), ("new", mm(volumes[1])), ("d", signed(volumes[1] - volumes[0]))];
            part.push(filled(speech, "diff-volume", &values));
        }
        section("diff-part", part);
        let mut time = Vec::new();
        if seconds.abs() >= SECONDS {
            let total = |side: &Side| speech.duration(side.seconds());
            let values = [("old", total(self.old)), ("new", total(self.new)), ("d", signed(seconds))];
            time.push(filled(speech, "diff-total", &values));
        }
        time.extend(self.operations.iter().map(|operation| operation_text(operation, speech)));
        section("diff-time", time);
        let told = self.findings.iter().map(|finding| {
            let sign = if finding.came { '+' } else { '-' };
            let FindingChange { severity, id, line, message, .. } = finding;
            format!("{sign} {severity}[{id}] {}: {}", line_text(*line, speech), clean(message))
        });
        section("diff-findings", told.collect());
        out
    }

    /// The edit in one line.
    fn headline(&self, speech: Speech) -> String {
        let [changed, added, removed] = self.passes();
        let values = [
            ("changed", changed.to_string()),
            ("added", added.to_string()),
            ("removed", removed.to_string()),
        ];
        let mut parts = vec![filled(speech, "diff-summary", &values)];
        for (kind, key) in [(StepKind::Rapid, "diff-summary-rapids"), (StepKind::Other, "diff-summary-other")]
        {
            let count = self.steps.iter().filter(|change| change.kind() == kind).count();
            if count > 0 {
                parts.push(speech.fill(key, &[("n", &count.to_string())]));
            }
        }
        if let Some((x, z)) = self.furthest() {
            parts.push(filled(speech, "diff-x", &[("d", signed(x)), ("z", mm(z))]));
        }
        parts.push(format!("{} s", signed(self.new.seconds() - self.old.seconds())));
        parts.join("; ")
    }

    fn step_text(&self, change: &Change, speech: Speech) -> String {
        let sign = match (&change.old, &change.new) {
            (Some(_), Some(_)) => '~',
            (None, _) => '+',
            (_, None) => '-',
        };
        let mut parts = vec![match (&change.old, &change.new) {
            (Some(old), Some(new)) if old.line != new.line => {
                filled(speech, "diff-lines", &[("old", old.line.to_string()), ("new", new.line.to_string())])
            }
            (old, new) => line_text(new.as_ref().or(old.as_ref()).map_or(0, |step| step.line), speech),
        }];
        if let Some(step) = change.new.as_ref().or(change.old.as_ref()) {
            if let Some(tool) = step.tool {
                parts.push(speech.fill("diff-tool", &[("tool", &tool.to_string())]));
            }
            parts.push(match (step.kind, step.cycle) {
                (StepKind::Pass, Some((label, pass))) => {
                    format!("{label} {}", speech.fill("diff-pass", &[("n", &pass.to_string())]))
                }
                (StepKind::Pass, None) => speech.get("diff-cut").to_string(),
                (StepKind::Rapid, _) => speech.get("diff-rapid").to_string(),
                (StepKind::Other, _) => speech.get("diff-other").to_string(),
            });
        }
        let mut text = format!("{sign} {}", parts.join(speech.get("list-comma")));
        if change.old.is_some() && change.new.is_some() {
            text.push_str(&format!("{}{}", speech.get("colon"), moved_text(change, speech)));
        }
        text
    }

    fn json(&self, speech: Speech) -> Value {
        let steps = |kind: StepKind| -> Vec<Value> {
            let of_kind = self.steps.iter().filter(|change| change.kind() == kind);
            of_kind.map(change_json).collect()
        };
        let pieces = self.pieces().map(|(piece, of_old)| {
            let (kind, sizes) = match shift(piece, of_old, &self.sections.0, &self.sections.1) {
                Some(Shift::Diameter(old, new)) => ("diameter", Some((old, new))),
                Some(Shift::Bore(old, new)) => ("bore", Some((old, new))),
                Some(Shift::Face(old, new)) => ("face", Some((old, new))),
                None => ("material", None),
            };
            json!({
                "only": if of_old { "old" } else { "new" },
                "kind": kind,
                "old": sizes.map(|sizes| sizes.0),
                "new": sizes.map(|sizes| sizes.1),
                "deviation": piece.deviation_mm,
                "area_mm2": piece.area_mm2,
                "z_max": piece.bounds.max.z, "z_min": piece.bounds.min.z,
                "x_max": 2.0 * piece.bounds.max.x, "x_min": 2.0 * piece.bounds.min.x,
            })
        });
        let operations = self.operations.iter().map(|one| {
            json!({ "name": one.name, "tool": one.tool, "line": one.line, "old_s": one.old_s, "new_s": one.new_s })
        });
        let findings = self.findings.iter().map(|one| {
            json!({
                "change": if one.came { "added" } else { "removed" }, "severity": one.severity, "id": one.id,
                "line": one.line, "message": one.message,
            })
        });
        let [changed, added, removed] = self.passes();
        let volumes = [&self.sections.0, &self.sections.1].map(Section::volume_mm3);
        json!({
            "turnwright": "diff",
            "version": 1,
            "old": self.old.name,
            "new": self.new.name,
            "same": self.is_empty(),
            "text": if self.is_empty() { speech.get("diff-same").to_string() } else { self.headline(speech) },
            "passes": { "changed": changed, "added": added, "removed": removed, "list": steps(StepKind::Pass) },
            "rapids": steps(StepKind::Rapid),
            "other": steps(StepKind::Other),
            "part": {
                "old_volume_mm3": volumes[0], "new_volume_mm3": volumes[1],
                "pieces": pieces.collect::<Vec<_>>(),
            },
            "time": {
                "old_s": self.old.seconds(), "new_s": self.new.seconds(),
                "operations": operations.collect::<Vec<_>>(),
            },
            "diagnostics": findings.collect::<Vec<_>>(),
        })
    }

    fn overlay(&self, title: String, speech: Speech) -> Overlay {
        let mut both = self.sections.0.clone();
        // What both have, so that each colour shows what only one has.
        let mut rest = self.sections.0.clone();
        rest.cut_section(&self.sections.1);
        both.cut_section(&rest);
        let region = |(piece, of_old): (&Piece, bool)| Region {
            colour: usize::from(!of_old),
            edges: piece.edges.clone(),
        };
        let mark = |(piece, of_old): (&Piece, bool)| OverlayMark {
            place: piece.place,
            text: self.piece_text(piece, of_old, speech),
        };
        let subtitle =
            if self.is_empty() { speech.get("diff-same").to_string() } else { self.headline(speech) };
        Overlay {
            title,
            subtitle,
            loops: both.contours().into_iter().map(|contour| contour.segments).collect(),
            figure: Vec::new(),
            strokes: Vec::new(),
            scale: Vec::new(),
            regions: self.pieces().map(region).collect(),
            legend: vec![
                ("#d43d51", speech.get("diff-old-only").to_string()),
                ("#1f6fc0", speech.get("diff-new-only").to_string()),
            ],
            marks: self.pieces().map(mark).collect(),
            language: picture_language(speech.language),
        }
    }
}

fn line_text(line: u32, speech: Speech) -> String {
    speech.fill("diff-line", &[("line", &line.to_string())])
}

fn moved_text(change: &Change, speech: Speech) -> String {
    let Some(moved) = change.moved() else { return speech.get("diff-way").to_string() };
    let mut parts = Vec::new();
    if moved.x_mm != 0.0 {
        parts.push(filled(speech, "diff-x", &[("d", signed(moved.x_mm)), ("z", mm(moved.at_z_mm))]));
    }
    if moved.z_mm != 0.0 {
        parts.push(filled(speech, "diff-z", &[("d", signed(moved.z_mm)), ("x", mm(moved.at_x_mm))]));
    }
    if parts.is_empty() { speech.get("diff-data").to_string() } else { parts.join(speech.get("list-comma")) }
}

fn change_json(change: &Change) -> Value {
    let step = change.new.as_ref().or(change.old.as_ref());
    let moved = change.moved();
    let what = match (&change.old, &change.new) {
        (Some(_), Some(_)) => "changed",
        (None, _) => "added",
        (_, None) => "removed",
    };
    json!({
        "change": what,
        "old_line": change.old.as_ref().map(|step| step.line),
        "new_line": change.new.as_ref().map(|step| step.line),
        "tool": step.and_then(|step| step.tool),
        "cycle": step.and_then(|step| step.cycle).map(|(label, _)| label.to_string()),
        "pass": step.and_then(|step| step.cycle).map(|(_, pass)| pass),
        "x": moved.map(|moved| moved.x_mm),
        "at_z": moved.map(|moved| moved.at_z_mm),
        "z": moved.map(|moved| moved.z_mm),
        "at_x": moved.map(|moved| moved.at_x_mm),
    })
}

/// Operations whose time is another, in the order of the new program; those that are gone behind them.
fn operations(old: &Side, new: &Side, speech: Speech) -> Vec<OperationChange> {
    let named = |side: &Side, operation: &Operation| operation_name(operation, &side.session.control, speech);
    let mut rest: Vec<&Operation> = old.measure.summary.operations().iter().collect();
    let mut found = Vec::new();
    for operation in new.measure.summary.operations() {
        let is_same = |other: &&Operation| {
            (other.tool, other.label, other.kind) == (operation.tool, operation.label, operation.kind)
        };
        let partner = rest.iter().position(is_same).map(|index| rest.remove(index));
        let (old_s, new_s) = (partner.map(|other| other.times.total_s()), operation.times.total_s());
        if old_s.is_none_or(|old_s| (old_s - new_s).abs() >= SECONDS) {
            found.push(OperationChange {
                name: named(new, operation),
                tool: operation.tool,
                line: operation.first_line,
                old_s,
                new_s: Some(new_s),
            });
        }
    }
    found.extend(rest.into_iter().map(|operation| OperationChange {
        name: named(old, operation),
        tool: operation.tool,
        line: operation.first_line,
        old_s: Some(operation.times.total_s()),
        new_s: None,
    }));
    found
}

fn operation_text(operation: &OperationChange, speech: Speech) -> String {
    let tool = operation.tool.map_or(String::new(), |tool| {
        format!("{}{}", speech.fill("diff-tool", &[("tool", &tool.to_string())]), speech.get("list-comma"))
    });
    let seconds =
        |seconds: Option<f64>| seconds.map_or("–".to_string(), |seconds| speech.duration(seconds));
    let difference = operation.new_s.unwrap_or(0.0) - operation.old_s.unwrap_or(0.0);
    let values =
        [("old", seconds(operation.old_s)), ("new", seconds(operation.new_s)), ("d", signed(difference))];
    let line = line_text(operation.line, speech);
    let total = filled(speech, "diff-total", &values);
    format!("{tool}{} ({line}){}{total}", operation.name, speech.get("colon"))
}

/// Diagnostics that are in one program only. The same one in another line is the same.
fn findings(old: &Side, new: &Side, speech: Speech) -> Vec<FindingChange> {
    let told = |side: &Side| -> BTreeMap<(String, String), Vec<(u32, &'static str)>> {
        let mut told = BTreeMap::<_, Vec<_>>::new();
        for finding in &side.findings {
            let id = finding.id(speech.messages()).into_owned();
            let message = finding.words(speech.messages(), speech.language).message.into_owned();
            let line = finding.diagnostic.place.map_or(0, |place| place.line);
            let severity = crate::finding::severity_word(finding.diagnostic.severity);
            told.entry((id, message)).or_default().push((line, severity));
        }
        told
    };
    let (before, now) = (told(old), told(new));
    let mut found = Vec::new();
    for (came, has, lacks) in [(false, &before, &now), (true, &now, &before)] {
        for ((id, message), places) in has {
            let known = lacks.get(&(id.clone(), message.clone())).map_or(0, Vec::len);
            for (line, severity) in places.iter().skip(known) {
                let (id, message) = (id.clone(), message.clone());
                found.push(FindingChange { came, severity, id, line: *line, message });
            }
        }
    }
    found.sort_by_key(|one| (one.line, one.came));
    found
}

fn filled(speech: Speech, key: &str, values: &[(&str, String)]) -> String {
    let values: Vec<(&str, &str)> = values.iter().map(|(name, value)| (*name, value.as_str())).collect();
    speech.fill(key, &values)
}

/// Thousandths with their sign.
fn signed(value: f64) -> String {
    let text = mm(value);
    if text.starts_with('-') || text == "0" { text } else { format!("+{text}") }
}
