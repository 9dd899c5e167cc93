//! Cutting data in words, as JSON and as what a picture of them holds.

use serde_json::{Value, json};
use turnwright_export::formats::cutting_svg::{CuttingPicture, Row};
use turnwright_verify::cutting::{Quantity, ra_of};

use super::{RunReport, picture_language};
use crate::speech::Speech;

/// Lines that the JSON report has; the peaks are of all lines.
const LINES_SHOWN_MAX: usize = 2_000;

/// Units and decimal places that mean something.
const fn unit(quantity: Quantity) -> (&'static str, usize) {
    match quantity {
        Quantity::Depth => ("mm", 3),
        Quantity::Chip => ("mm", 3),
        Quantity::Speed => ("m/min", 0),
        Quantity::Removal => ("cm³/min", 1),
        Quantity::Force => ("N", 0),
        Quantity::Power => ("kW", 2),
        Quantity::Roughness => ("µm", 2),
    }
}

impl RunReport {
    /// The greatest of each quantity, a line each; nothing when nothing was cut.
    pub(super) fn cutting_text(&self, speech: Speech) -> Option<String> {
        let lines: Vec<String> =
            Quantity::ALL.into_iter().filter_map(|quantity| self.peak_text(quantity, speech)).collect();
        if lines.is_empty() {
            return None;
        }
        Some(format!("{}\n{}", lines.join("\n"), self.material_note(speech)))
    }

    /// What force and power rest on.
    fn material_note(&self, speech: Speech) -> String {
        let Some(material) = self.cutting.material else {
            return speech.get("cutting-without-material").to_string();
        };
        let (kc, mc) = (material.kc11_n_per_mm2.to_string(), material.mc.to_string());
        let title = material.title(speech.language);
        let values = [("material", material.name.as_str()), ("title", title), ("kc", &kc), ("mc", &mc)];
        speech.fill("cutting-of-material", &values)
    }

    fn peak_text(&self, quantity: Quantity, speech: Speech) -> Option<String> {
        let (value, line) = self.cutting.peak(quantity)?;
        let (unit, decimals) = unit(quantity);
        let (number, tool, ra) =
            (line.line.to_string(), line.tool.to_string(), format!("{:.2}", ra_of(value)));
        let what = speech.find(&format!("cutting-{}", quantity.word()));
        let value = format!("{value:.decimals$}");
        let values = [
            ("what", what),
            ("value", &value),
            ("unit", unit),
            ("ra", &ra),
            ("line", &number),
            ("tool", &tool),
        ];
        let key = if quantity == Quantity::Roughness { "cutting-peak-rz" } else { "cutting-peak" };
        Some(speech.fill(key, &values))
    }

    /// Peaks and lines for scripts.
    pub(super) fn cutting_json(&self) -> Value {
        let values = |values: &[Option<f64>]| -> serde_json::Map<String, Value> {
            Quantity::ALL.iter().map(|one| (one.word().to_string(), json!(values[*one as usize]))).collect()
        };
        let mut peaks = serde_json::Map::new();
        for quantity in Quantity::ALL {
            if let Some((value, line)) = self.cutting.peak(quantity) {
                let peak = json!({ "value": value, "line": line.line, "tool": line.tool });
                peaks.insert(quantity.word().to_string(), peak);
            }
        }
        if let Some((rz, line)) = self.cutting.peak(Quantity::Roughness) {
            let peak = json!({ "value": ra_of(rz), "line": line.line, "tool": line.tool });
            peaks.insert("ra_um".to_string(), peak);
        }
        let of_program = self.cutting.lines.iter().filter(|line| line.source == 0);
        let lines = of_program.take(LINES_SHOWN_MAX).map(|line| {
            let mut one = values(&line.values);
            one.insert("line".to_string(), json!(line.line));
            one.insert("tool".to_string(), json!(line.tool));
            Value::Object(one)
        });
        json!({
            "model": "kienzle",
            "material": self.cutting.material.map(|material| &material.name),
            "kc11_n_per_mm2": self.cutting.material.map(|material| material.kc11_n_per_mm2),
            "mc": self.cutting.material.map(|material| material.mc),
            "peaks": peaks,
            "lines": lines.collect::<Vec<_>>(),
        })
    }

    /// The course over time, for a picture; nothing when nothing was cut.
    pub(crate) fn cutting_picture(&self, speech: Speech) -> Option<CuttingPicture> {
        let data = &self.cutting;
        if data.course.is_empty() {
            return None;
        }
        let row = |quantity: Quantity| {
            let (peak, peak_at) = data.peak(quantity)?;
            let (index, (unit, decimals)) = (quantity as usize, unit(quantity));
            let of_course = data.course.iter();
            let steps = of_course.filter_map(|step| Some((step.from_s, step.to_s, step.values[index]?)));
            Some(Row {
                name: speech.find(&format!("cutting-{}", quantity.word())).to_string(),
                label: self.peak_text(quantity, speech)?,
                peak,
                // Lines of other texts are not in the page.
                peak_line: if peak_at.source == 0 { peak_at.line } else { 0 },
                unit,
                decimals,
                steps: steps.collect(),
            })
        };
        Some(CuttingPicture {
            title: self.title(),
            subtitle: self.material_note(speech),
            rows: Quantity::ALL.into_iter().filter_map(row).collect(),
            total_s: self.measure.summary.totals().total_s(),
            language: picture_language(speech.language),
        })
    }
}
