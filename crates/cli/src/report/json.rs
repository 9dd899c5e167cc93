//! The report of a run for scripts: one JSON object.

use serde_json::{Value, json};
use turnwright_motion::OperationKind;

use super::sizes::judged_json;
use super::times::totals_json;
use super::{RunReport, assumption_text, estimates, operation_name};
use crate::environment::ProgramText;
use crate::speech::Speech;

impl RunReport {
    /// The same as the report for people.
    pub(crate) fn json(&self, text: &ProgramText, speech: Speech) -> Value {
        let diagnostics: Vec<Value> = self
            .findings
            .iter()
            .map(|finding| {
                finding.to_json(speech.messages(), speech.language, finding.spot(Some(text)).as_ref())
            })
            .collect();
        json!({
            "turnwright": "run",
            "version": 1,
            "file": self.file,
            "control": self.session.control.name,
            "control_reason": { "key": self.session.reason.word(), "text": self.session.reason.text(speech) },
            "setup": self.setup_name(),
            "machine": self.machine.name,
            "blocks": self.blocks,
            "stopped_at_line": self.stopped_at,
            "diagnostics": diagnostics,
            "operations": self.operations_json(speech),
            "cutting_extents": self.extents_json(),
            "part": self.part_json(),
            "cutting": self.cutting_json(),
            "measures": judged_json(&self.judged),
            "spindle_rpm": self.measure.summary.rpm().map(|rpm| json!({ "min": rpm.min, "max": rpm.max })),
            "time": self.measure.time_json(),
            "advice": self.advice_json(text, speech),
            "estimates": self.estimates_json(speech),
            "assumptions": self.assumptions_json(speech),
            "files": self.written,
            "pictures_left_out": self.not_drawn,
        })
    }

    fn assumptions_json(&self, speech: Speech) -> Vec<Value> {
        let assumptions = self.assumptions.iter();
        assumptions
            .map(|one| {
                json!({
                    "section": one.section,
                    "setting": one.key,
                    "key": one.words,
                    "line": one.line,
                    "text": assumption_text(one, speech),
                })
            })
            .collect()
    }

    pub(super) fn estimates_json(&self, speech: Speech) -> Vec<Value> {
        estimates(&self.measure, speech).map(|(key, text)| json!({ "key": key, "text": text })).collect()
    }

    pub(super) fn operations_json(&self, speech: Speech) -> Vec<Value> {
        let operations = self.measure.summary.operations().iter().enumerate();
        operations
            .map(|(index, operation)| {
                json!({
                    "index": index + 1,
                    "tool": operation.tool,
                    "offset": operation.offset,
                    "code": operation.label.map(|label| label.to_string()),
                    "kind": kind_word(operation.kind),
                    "name": operation_name(operation, &self.session.control, speech),
                    "first_line": operation.first_line,
                    "last_line": operation.last_line,
                    "passes": operation.passes,
                    "cutting_mm": operation.cutting_mm,
                    "rapid_mm": operation.rapid_mm,
                    "seconds": operation.times.total_s(),
                    "time": totals_json(&operation.times),
                })
            })
            .collect()
    }

    /// X as diameters, millimetres.
    fn extents_json(&self) -> Value {
        let Some(extents) = self.measure.summary.cutting_extents() else { return Value::Null };
        json!({
            "x_min": extents.x_min.to_diameter().0.to_mm(),
            "x_max": extents.x_max.to_diameter().0.to_mm(),
            "z_min": extents.z_min.to_mm(),
            "z_max": extents.z_max.to_mm(),
        })
    }

    /// Diameters and Z, millimetres.
    fn part_json(&self) -> Value {
        let Some((_, shape)) = &self.part else { return Value::Null };
        let cylinders = shape.cylinders.iter().map(|one| {
            json!({ "diameter": one.diameter_mm, "z_min": one.z.0, "z_max": one.z.1, "inside": one.is_inside })
        });
        let threads = shape.threads.iter().map(|one| {
            json!({
                "crest": one.crest_mm, "root": one.root_mm, "lead": one.lead_mm, "starts": one.starts,
                "z_min": one.z.0, "z_max": one.z.1, "inside": one.is_inside,
            })
        });
        json!({
            "diameter": shape.diameter_mm,
            "z_min": shape.z.0,
            "z_max": shape.z.1,
            "volume_mm3": shape.volume_mm3,
            "cylinders": cylinders.collect::<Vec<_>>(),
            "threads": threads.collect::<Vec<_>>(),
        })
    }
}

const fn kind_word(kind: OperationKind) -> &'static str {
    match kind {
        OperationKind::Standing => "standing",
        OperationKind::Positioning => "positioning",
        OperationKind::Turning => "turning",
        OperationKind::Drilling => "drilling",
        OperationKind::Threading => "threading",
    }
}
