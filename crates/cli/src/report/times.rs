//! Where the time of a program goes, for people and for scripts.

use serde_json::{Value, json};
use turnwright_motion::{Kind, Totals};
use turnwright_verify::advice::Advice;

use super::{Measure, RunReport, TIME_PARTS};
use crate::environment::ProgramText;
use crate::finding::Finding;
use crate::speech::Speech;
use crate::table::{Side, Table, heading};

/// Lines that are named as the longest.
const LINES_SHOWN: usize = 8;

/// Lines that scripts are given.
const LINES_GIVEN: usize = 200;

/// What time is spent on, in a line; what takes none is left out.
pub(super) fn parts_text(totals: &Totals, speech: Speech) -> String {
    let parts: Vec<String> = TIME_PARTS
        .iter()
        .filter(|(kind, _)| totals.seconds(*kind) > 0.0)
        .map(|(kind, name)| {
            format!("{} {}", speech.find(&format!("time-of-{name}")), speech.duration(totals.seconds(*kind)))
        })
        .collect();
    parts.join(speech.get("list-comma"))
}

/// Seconds in all and of each part.
pub(crate) fn totals_json(totals: &Totals) -> Value {
    let mut time = json!({ "total_s": totals.total_s() });
    for (kind, name) in TIME_PARTS {
        time[format!("{name}_s")] = json!(totals.seconds(kind));
    }
    time
}

impl Measure {
    /// Tools and the lines that take longest.
    pub(crate) fn times_text(&self, speech: Speech) -> String {
        use Side::{Left, Right};
        let total_s = self.summary.totals().total_s();
        if total_s <= 0.0 {
            return String::new();
        }
        let percent = |seconds: f64| format!("{:.1} %", seconds / total_s * 100.0);
        let column = |key: &str| speech.fill(&format!("column-{key}"), &[]);
        let mut tools = Table::new(&[Right, Right, Right, Right, Right, Right, Right]);
        tools.row(["tool", "time", "share", "in-cut", "in-rapid", "tool-change", "other"].map(column));
        for (tool, times) in self.summary.tools() {
            let seconds = |kinds: &[Kind]| kinds.iter().map(|kind| times.seconds(*kind)).sum::<f64>();
            let (cut, rapid) = (seconds(&[Kind::Cutting, Kind::Threading]), seconds(&[Kind::Rapid]));
            let change = seconds(&[Kind::ToolChange]);
            let all = times.total_s();
            tools.row([
                tool.map_or(String::new(), |tool| format!("T{tool}")),
                speech.duration(all),
                percent(all),
                speech.duration(cut),
                speech.duration(rapid),
                speech.duration(change),
                speech.duration((all - cut - rapid - change).max(0.0)),
            ]);
        }
        let mut lines = Table::new(&[Right, Right, Right, Left]);
        lines.row(["line", "time", "share", "runs"].map(column));
        for (source, line, of_line) in self.blocks.longest(LINES_SHOWN) {
            if of_line.time.is_zero() {
                break;
            }
            let seconds = of_line.time.as_secs_f64();
            let name = if source == 0 { line.to_string() } else { format!("{source}:{line}") };
            let runs = if of_line.runs > 1 { format!("× {}", of_line.runs) } else { String::new() };
            lines.row([name, speech.duration(seconds), percent(seconds), runs]);
        }
        format!(
            "{}\n{}\n{}\n{}\n",
            heading(speech.get("times-of-tools")),
            tools.text(2, false),
            heading(speech.get("times-of-lines")),
            lines.text(2, false)
        )
    }

    /// Seconds by part, tool and line. The names of its first fields are those of version 1.
    pub(crate) fn time_json(&self) -> Value {
        let mut time = totals_json(self.summary.totals());
        time["moves_of_unknown_time"] = json!(self.schedule.unknown_feeds());
        let tools = self.summary.tools().map(|(tool, times)| {
            let mut row = totals_json(times);
            row["tool"] = json!(tool);
            row
        });
        time["tools"] = tools.collect();
        let lines = self.blocks.longest(LINES_GIVEN).into_iter().map(|(source, line, of_line)| {
            let seconds = of_line.time.as_secs_f64();
            json!({ "source": source, "line": line, "seconds": seconds, "runs": of_line.runs })
        });
        time["longest_lines"] = lines.collect();
        time
    }
}

impl RunReport {
    fn advised(&self, advice: &Advice) -> Finding {
        Finding::new(&*self.file, advice.diagnostic.clone()).with_ids(self.session.control.alarm_ids)
    }

    /// Where time could be saved.
    pub(super) fn advice_text(&self, speech: Speech) -> String {
        if self.measure.advice.is_empty() {
            return String::new();
        }
        let mut table = Table::new(&[Side::Right, Side::Right, Side::Left]);
        for advice in &self.measure.advice {
            let finding = self.advised(advice);
            let words = finding.words(speech.messages(), speech.language);
            let line = advice.diagnostic.place.map_or(0, |place| place.line).to_string();
            let id = finding.id(speech.messages()).into_owned();
            let line = speech.fill("call-line", &[("line", &line)]);
            table.row([speech.duration(advice.seconds), line, format!("{id}  {}", words.message)]);
            table.row([String::new(), String::new(), format!("      {}", words.remedy)]);
        }
        format!("{}\n{}\n", heading(speech.get("advice")), table.text(2, false))
    }

    /// The same for scripts.
    pub(super) fn advice_json(&self, text: &ProgramText, speech: Speech) -> Vec<Value> {
        let json = |advice: &Advice| {
            let finding = self.advised(advice);
            let spot = finding.spot(Some(text));
            let mut value = finding.to_json(speech.messages(), speech.language, spot.as_ref());
            value["seconds"] = json!(advice.seconds);
            value
        };
        self.measure.advice.iter().map(json).collect()
    }

    /// All there is to say of the time.
    pub(crate) fn time_body(&self, speech: Speech) -> String {
        let totals = self.measure.summary.totals();
        let total_s = totals.total_s();
        let mut out = self.stopped_text(speech);
        let mut causes = Table::new(&[Side::Left, Side::Right, Side::Right]);
        causes.row([speech.get("time-total").to_string(), speech.duration(total_s), String::new()]);
        for (kind, name) in TIME_PARTS.into_iter().filter(|(kind, _)| totals.seconds(*kind) > 0.0) {
            let seconds = totals.seconds(kind);
            causes.row([
                speech.find(&format!("time-of-{name}")).to_string(),
                speech.duration(seconds),
                format!("{:.1} %", seconds / total_s * 100.0),
            ]);
        }
        out.push_str(&causes.text(0, true));
        if self.measure.schedule.unknown_feeds() > 0 {
            let count = self.measure.schedule.unknown_feeds().to_string();
            out.push_str(&format!("{}\n", speech.fill("time-unknown", &[("n", &count)])));
        }
        out.push('\n');
        if !self.measure.summary.operations().is_empty() {
            out.push_str(&self.operations(speech));
            out.push('\n');
        }
        out.push_str(&self.measure.times_text(speech));
        out.push_str(&self.advice_text(speech));
        out.push_str(&self.endnotes(speech));
        out
    }

    /// The same for scripts.
    pub(crate) fn time_document(&self, text: &ProgramText, speech: Speech) -> Value {
        let diagnostics = self.findings.iter().map(|finding| {
            finding.to_json(speech.messages(), speech.language, finding.spot(Some(text)).as_ref())
        });
        json!({
            "turnwright": "time",
            "version": 1,
            "programs": [{
                "file": self.file,
                "control": self.session.control.name,
                "machine": self.machine.name,
                "time": self.measure.time_json(),
                "operations": self.operations_json(speech),
                "advice": self.advice_json(text, speech),
                "stopped_at_line": self.stopped_at,
                "diagnostics": diagnostics.collect::<Vec<_>>(),
                "estimates": self.estimates_json(speech),
            }],
            "time": totals_json(self.measure.summary.totals()),
            "files": self.written,
        })
    }
}
