//! The report of a run as one page, in both languages.

use std::mem;

use turnwright_export::formats::crash_svg::{CrashPicture, write_crash_svg};
use turnwright_export::formats::cutting_svg::CuttingPicture;
use turnwright_export::formats::html::{
    AssumptionRow, CycleTable, Fact, OperationRow, PlaceMark, Report, ReportDiagnostic, ReportPart,
    write_html,
};
use turnwright_export::passes::Cycle;
use turnwright_export::path::PathRecorder;
use turnwright_export::wound::{PAGE_CHORD_MM, Wound};
use turnwright_verify::Assumption;
use turnwright_verify::part::{Mark, Part};

use super::human::rpm_text;
use super::{RunReport, TIME_PARTS, assumption_text, estimates, operation_name, picture_language};
use crate::environment::ProgramText;
use crate::finding::{Finding, decode};
use crate::passes::setting_name;
use crate::speech::{BOTH, Speech};

/// Lines of the program in the report; a browser's list cannot be much higher.
const REPORT_LINES_MAX: usize = 600_000;

/// Bytes of the program in the report.
const REPORT_BYTES_MAX: usize = 16 * 1024 * 1024;

/// English and Chinese.
const SPEECHES: [Speech; 2] = [Speech { language: BOTH[0] }, Speech { language: BOTH[1] }];

impl RunReport {
    /// The page; `has_solid` puts what shows the part in space into it.
    pub(crate) fn page(
        &mut self,
        text: &ProgramText,
        path: &PathRecorder,
        speech: Speech,
        has_solid: bool,
    ) -> String {
        let (program_lines, is_whole) = program_lines(text.lines(), REPORT_LINES_MAX, REPORT_BYTES_MAX);
        let mut facts = self.page_facts();
        if !is_whole {
            facts.push(fact("program", |speech| {
                speech.fill("program-shown-in-part", &[("n", &program_lines.len().to_string())])
            }));
        }
        let [estimated_note_en, estimated_note_zh] = SPEECHES.map(|speech| {
            let sentences: Vec<String> =
                estimates(&self.measure, speech).map(|(_, sentence)| sentence).collect();
            sentences.join(if speech.language == BOTH[0] { " " } else { "" })
        });
        let (cycles, dropped) = mem::take(&mut self.passes);
        if dropped > 0 {
            facts.push(fact("passes", |speech| {
                speech.fill("passes-not-kept", &[("n", &dropped.to_string())])
            }));
        }
        let assumptions = self.assumptions.iter().map(|one| {
            let [text_en, text_zh] = SPEECHES.map(|speech| {
                let own = Assumption { line: None, ..one.clone() };
                assumption_text(&own, speech)
            });
            AssumptionRow { line: one.line.unwrap_or_default(), text_en, text_zh }
        });
        let report = Report {
            title: self.title(),
            control: self.session.control.name.to_string(),
            control_reason: self.session.reason.text(speech),
            source: 0,
            program_lines,
            operations: self.page_operations(),
            cycles: cycles.into_iter().map(|cycle| self.page_cycle(cycle)).collect(),
            diagnostics: self.findings.iter().map(|finding| self.page_diagnostic(finding, text)).collect(),
            assumptions: assumptions.collect(),
            part: self.page_part(has_solid),
            timeline: self.measure.timeline.as_ref(),
            cutting: self.page_cutting(),
            facts,
            estimated_note_en,
            estimated_note_zh,
            language: picture_language(speech.language),
        };
        write_html(path, &report)
    }

    /// The file's name without its folders.
    pub(crate) fn title(&self) -> String {
        std::path::Path::new(&self.file)
            .file_name()
            .map_or_else(|| self.file.clone(), |name| name.to_string_lossy().into_owned())
    }

    fn page_operations(&self) -> Vec<OperationRow> {
        let operations = self.measure.summary.operations().iter().zip(1..);
        operations
            .map(|(operation, index)| {
                let [name_en, name_zh] =
                    SPEECHES.map(|speech| operation_name(operation, &self.session.control, speech));
                OperationRow {
                    index,
                    tool: operation.tool,
                    name_en,
                    name_zh,
                    code: operation.label.map_or(String::new(), |label| label.to_string()),
                    first_line: operation.first_line,
                    last_line: operation.last_line,
                    passes: operation.passes,
                    cutting_mm: operation.cutting_mm,
                    rapid_mm: operation.rapid_mm,
                    seconds: operation.times.total_s(),
                }
            })
            .collect()
    }

    fn page_cycle(&self, cycle: Cycle) -> CycleTable {
        let parameters = &self.session.control.parameters;
        let [name_en, name_zh] = SPEECHES.map(|speech| {
            let entry = speech.functions().get(&cycle.function);
            entry.map_or(String::new(), |entry| entry.name(speech.language).to_string())
        });
        let names = |setting| SPEECHES.map(|speech| setting_name(setting, parameters, speech));
        let setting_names = cycle.settings.iter().map(names).collect();
        CycleTable { cycle, name_en, name_zh, setting_names }
    }

    fn page_diagnostic(&self, finding: &Finding, text: &ProgramText) -> ReportDiagnostic {
        let messages = SPEECHES[0].messages();
        let [english, chinese] = BOTH.map(|language| finding.words(messages, language));
        let spot = finding.spot(Some(text));
        let (line, column, end_column) =
            spot.map_or((0, 0, 0), |spot| (spot.line, spot.span.start as u32 + 1, spot.span.end as u32 + 1));
        ReportDiagnostic {
            severity: finding.diagnostic.severity,
            id: finding.id(messages).to_string(),
            key: finding.diagnostic.key.to_string(),
            line,
            column,
            end_column,
            message_en: english.message.into_owned(),
            cause_en: english.cause.into_owned(),
            remedy_en: english.remedy.into_owned(),
            message_zh: chinese.message.into_owned(),
            cause_zh: chinese.cause.into_owned(),
            remedy_zh: chinese.remedy.into_owned(),
            mark: self.mark_of(finding),
        }
    }

    /// Where in the part a finding is.
    fn mark_of(&self, finding: &Finding) -> Option<PlaceMark> {
        let (part, _) = self.part.as_ref()?;
        let Mark { command, place, depth_mm, bounds, .. } = part.marks[mark_index(part, finding)?];
        Some(PlaceMark { command, place, depth_mm, bounds })
    }

    /// The pictures of crashes and gouges: which finding, the name of the file, the picture. Those behind the first
    /// [`SCENES_MAX`](turnwright_verify::scene::SCENES_MAX) are only counted.
    pub(crate) fn crash_pictures(
        &self,
        text: &ProgramText,
        speech: Speech,
    ) -> (Vec<(usize, String, String)>, usize) {
        let Some((part, _)) = &self.part else { return Default::default() };
        let (mut drawn, mut left_out) = (Vec::new(), 0);
        for (at, finding) in self.findings.iter().enumerate() {
            let Some(index) = mark_index(part, finding) else { continue };
            let mark = &part.marks[index];
            if !mark.is_collision() {
                continue;
            }
            let Some(scene) = part.scenes.iter().find(|scene| scene.mark == index) else {
                left_out += 1;
                continue;
            };
            let spot = finding.spot(Some(text));
            let block = spot.map_or_else(String::new, |spot| spot.text.trim().to_string());
            let picture = CrashPicture {
                title: self.title(),
                line: (mark.line.1, block),
                message: finding.words(speech.messages(), speech.language).message.into_owned(),
                section: &scene.section,
                hit: scene.hit.as_ref(),
                tool: part.tools.get(&mark.tool).filter(|_| mark.is_of_tool()),
                place: mark.place,
                way: &scene.way,
                obstacles: &part.obstacles,
                depth_mm: mark.depth_mm,
                bounds: mark.bounds,
                language: picture_language(speech.language),
            };
            let name = format!("crash-{}-line-{}.svg", drawn.len() + 1, mark.line.1);
            drawn.push((at, name, write_crash_svg(&picture)));
        }
        (drawn, left_out)
    }

    fn page_part(&self, has_solid: bool) -> Option<ReportPart<'_>> {
        let (part, shape) = self.part.as_ref()?;
        let Part { history, stock, tools, obstacles, parted, .. } = part;
        let turns = self.meshed.turns.as_ref().filter(|_| has_solid);
        Some(ReportPart {
            history: history.as_ref()?,
            shape,
            stock,
            tools,
            obstacles,
            has_solid,
            wound: turns.and_then(|turns| Wound::new(shape, turns, PAGE_CHORD_MM).ok()),
            parted: *parted,
        })
    }

    fn page_cutting(&self) -> Option<[CuttingPicture; 2]> {
        let [english, chinese] = SPEECHES.map(|speech| self.cutting_picture(speech));
        Some([english?, chinese?])
    }

    fn page_facts(&self) -> Vec<Fact> {
        let totals = self.measure.summary.totals();
        let mut facts = vec![fact("machine", |_| self.machine.name.clone())];
        if let Some(setup) = self.setup_name() {
            facts.push(fact("setup", |_| setup.clone()));
        }
        if let Some([x, z]) = self.cutting_extents() {
            facts.push(fact("extents-x", |_| format!("{} … {} mm", x[0], x[1])));
            facts.push(fact("extents-z", |_| format!("{} … {} mm", z[0], z[1])));
        }
        if let Some(rpm) = self.measure.summary.rpm() {
            facts.push(fact("spindle", |_| rpm_text(rpm.min, rpm.max)));
        }
        facts.push(fact("time-total", |_| clock_face(totals.total_s())));
        for (kind, name) in TIME_PARTS {
            if totals.seconds(kind) > 0.0 {
                facts.push(fact(&format!("time-of-{name}"), |_| clock_face(totals.seconds(kind))));
            }
        }
        facts
    }
}

/// Which of the part's marks a finding has.
fn mark_index(part: &Part, finding: &Finding) -> Option<usize> {
    let place = finding.diagnostic.place.as_ref()?;
    let line = (place.source, place.line);
    part.marks.iter().position(|mark| mark.key == finding.diagnostic.key && mark.line == line)
}

/// Minutes and seconds as every language writes them.
fn clock_face(seconds: f64) -> String {
    let tenths = (seconds * 10.0).round().max(0.0) as u64;
    format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10)
}

/// A row whose value is the same in both languages; English where it is not.
fn fact(key: &str, value: impl Fn(Speech) -> String) -> Fact {
    let [label_en, label_zh] = SPEECHES.map(|speech| speech.fill(key, &[]));
    Fact { label_en, label_zh, value: value(SPEECHES[0]) }
}

/// The program's lines as far as a page can hold them, and whether that is all.
fn program_lines<L: AsRef<[u8]>>(
    lines: impl Iterator<Item = L>,
    lines_max: usize,
    bytes_max: usize,
) -> (Vec<String>, bool) {
    let mut shown = Vec::new();
    let mut bytes = 0;
    for line in lines {
        bytes += line.as_ref().len();
        if shown.len() >= lines_max || bytes > bytes_max {
            return (shown, false);
        }
        shown.push(decode(line.as_ref()));
    }
    (shown, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_holds_so_many_lines_and_bytes_and_not_one_more() {
        let text = ["G0 X50.", "Z2.", "M30"];
        let held = |lines, bytes| {
            let (shown, is_whole) = program_lines(text.iter(), lines, bytes);
            (shown.len(), is_whole)
        };
        assert_eq!(held(3, 13), (3, true));
        assert_eq!(held(2, 13), (2, false));
        assert_eq!(held(3, 12), (2, false));
        assert_eq!(held(0, 13), (0, false));
        assert_eq!(program_lines(text[..0].iter(), 0, 0), (Vec::new(), true));
    }
}
