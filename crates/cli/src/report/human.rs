//! The report of a run on a terminal.

use turnwright_export::formats::part_svg::{mm, thread_text};
use turnwright_export::part::PartShape;

use super::sizes::judged_text;
use super::times::parts_text;
use super::{RunReport, assumption_text, estimates, operation_name};
use turnwright_verify::scene::SCENES_MAX;

use crate::render::clean;
use crate::speech::Speech;
use crate::table::{Side, Table, facts, heading};

impl RunReport {
    /// Which control, which setup and why: what stands before everything else.
    pub(crate) fn head(&self, speech: Speech) -> String {
        let label = |key: &'static str| speech.get(key).to_string();
        let control = &self.session.control;
        let reason = self.session.reason.text(speech);
        let named = |what: &str| speech.fill("named", &[("name", what), ("why", &reason)]);
        let mut rows = vec![(label("program"), clean(&self.file)), (label("control"), named(control.name))];
        if let Some(setup) = self.setup_name() {
            rows.push((label("setup"), clean(&setup)));
        }
        let key = if self.session.setup.machine.is_some() { "machine-named" } else { "machine-assumed" };
        rows.push((label("machine"), speech.fill(key, &[("name", &clean(&self.machine.name))])));
        facts(&rows) + "\n"
    }

    /// Operations, extents, speeds and time.
    pub(crate) fn body(&self, speech: Speech) -> String {
        let mut out = self.stopped_text(speech);
        if !self.measure.summary.operations().is_empty() {
            out.push_str(&self.operations(speech));
            out.push('\n');
        }
        out.push_str(&facts(&self.figures(speech)));
        out.push('\n');
        out.push_str(&self.measure.times_text(speech));
        out.push_str(&self.advice_text(speech));
        out.push_str(&self.endnotes(speech));
        out
    }

    /// Where an alarm ended the program.
    pub(super) fn stopped_text(&self, speech: Speech) -> String {
        let line = self.stopped_at.map(|line| line.to_string());
        line.map_or(String::new(), |line| speech.fill("stopped-at", &[("line", &line)]) + "\n\n")
    }

    /// What the figures rest on, and what was written.
    pub(super) fn endnotes(&self, speech: Speech) -> String {
        let mut out = String::new();
        out.push_str(&heading(speech.get("estimated")));
        out.push('\n');
        for (_, sentence) in estimates(&self.measure, speech) {
            out.push_str(&format!("  - {sentence}\n"));
        }
        if !self.assumptions.is_empty() {
            out.push_str(&format!("\n{}\n", heading(speech.get("assumed"))));
            for assumption in &self.assumptions {
                out.push_str(&format!("  - {}\n", assumption_text(assumption, speech)));
            }
        }
        if !self.written.is_empty() {
            out.push_str(&format!("\n{}\n", heading(speech.get("written"))));
            for file in &self.written {
                out.push_str(&format!("  {}\n", clean(file)));
            }
            if self.not_drawn > 0 {
                let values = [("n", &*self.not_drawn.to_string()), ("most", &*SCENES_MAX.to_string())];
                out.push_str(&format!("  {}\n", speech.fill("pictures-left-out", &values)));
            }
        }
        out
    }

    pub(super) fn operations(&self, speech: Speech) -> String {
        use Side::{Left, Right};
        let mut table = Table::new(&[Right, Right, Left, Left, Right, Right, Right, Right, Right]);
        let columns =
            ["number", "tool", "code", "operation", "lines", "passes", "cutting-mm", "rapid-mm", "time"];
        table.row(columns.map(|key| speech.fill(&format!("column-{key}"), &[])));
        for (index, operation) in self.measure.summary.operations().iter().enumerate() {
            let lines = match (operation.first_line, operation.last_line) {
                (first, last) if last <= first => first.to_string(),
                (first, last) => format!("{first}-{last}"),
            };
            table.row([
                (index + 1).to_string(),
                operation.tool.map_or(String::new(), |tool| tool.to_string()),
                operation.label.map_or(String::new(), |label| label.to_string()),
                operation_name(operation, &self.session.control, speech),
                lines,
                if operation.passes > 0 { operation.passes.to_string() } else { String::new() },
                format!("{:.1}", operation.cutting_mm),
                format!("{:.1}", operation.rapid_mm),
                speech.duration(operation.times.total_s()),
            ]);
        }
        let mut out = table.text(0, true);
        if self.measure.summary.merged_operations() > 0 {
            let more = self.measure.summary.merged_operations().to_string();
            out.push_str(&speech.fill("more-operations", &[("n", &more)]));
            out.push('\n');
        }
        out
    }

    fn figures(&self, speech: Speech) -> Vec<(String, String)> {
        let label = |key: &'static str| speech.get(key).to_string();
        let summary = &self.measure.summary;
        let mut rows = Vec::new();
        let cutting = match self.cutting_extents() {
            Some([x, z]) => {
                let values = [("x1", &x[0]), ("x2", &x[1]), ("z1", &z[0]), ("z2", &z[1])];
                speech.fill("extents", &values.map(|(name, value)| (name, value.as_str())))
            }
            None => label("no-cutting"),
        };
        rows.push((label("cutting-extents"), cutting));
        if let Some((_, shape)) = &self.part {
            rows.push((label("part"), part_text(shape, speech)));
        }
        if let Some(text) = self.cutting_text(speech) {
            rows.push((label("cutting-data"), text));
        }
        if !self.judged.is_empty() {
            rows.push((label("part-sizes"), judged_text(&self.judged, speech)));
        }
        if let Some(rpm) = summary.rpm() {
            rows.push((label("spindle"), rpm_text(rpm.min, rpm.max)));
        }
        let totals = self.measure.summary.totals();
        let mut time = speech.duration(totals.total_s());
        let parts = parts_text(totals, speech);
        if !parts.is_empty() {
            time = format!("{time}\n{parts}");
        }
        if self.measure.schedule.unknown_feeds() > 0 {
            let count = self.measure.schedule.unknown_feeds().to_string();
            time = format!("{time}\n{}", speech.fill("time-unknown", &[("n", &count)]));
        }
        rows.push((label("time"), time));
        rows
    }
}

/// The part's size, and below it its cylinders and threads from the front.
fn part_text(shape: &PartShape, speech: Speech) -> String {
    let size = [
        ("d", mm(shape.diameter_mm)),
        ("l", mm(shape.z.1 - shape.z.0)),
        ("v", mm(shape.volume_mm3 / 1000.0)),
    ];
    let fill = |key: &str, values: &[(&str, String)]| {
        let values: Vec<(&str, &str)> = values.iter().map(|(name, value)| (*name, value.as_str())).collect();
        speech.fill(key, &values)
    };
    let mut lines = vec![fill("part-size", &size)];
    let place = |z: (f64, f64)| [("z1", mm(z.1)), ("z2", mm(z.0))];
    for cylinder in &shape.cylinders {
        let key = if cylinder.is_inside { "part-bore" } else { "part-cylinder" };
        let [from, to] = place(cylinder.z);
        lines.push(fill(key, &[("d", mm(cylinder.diameter_mm)), from, to]));
    }
    for thread in &shape.threads {
        let [from, to] = place(thread.z);
        lines.push(fill("part-thread", &[("thread", thread_text(thread)), from, to]));
    }
    lines.join("\n")
}

/// A range of spindle speeds.
pub(super) fn rpm_text(min: f64, max: f64) -> String {
    let (min, max) = (min.round(), max.round());
    if min < max { format!("{min:.0} … {max:.0} rpm") } else { format!("{max:.0} rpm") }
}
