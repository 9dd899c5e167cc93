//! Measured sizes in words and as JSON.

use serde_json::{Value, json};
use turnwright_export::formats::part_svg::mm;
use turnwright_verify::measuring::{Judged, nominal_text};

use crate::render::clean;
use crate::speech::Speech;

/// What the setup file asks for, a line each.
pub(crate) fn judged_text(judged: &[Judged], speech: Speech) -> String {
    let line = |(index, one): (usize, &Judged)| {
        let name = one.measure.name.as_deref().map_or_else(|| format!("[[measure]] {}", index + 1), clean);
        let expected = nominal_text(&one.measure);
        let verdict = match one.passes() {
            Some(true) => "size-pass",
            Some(false) => "size-fail",
            None => "size-shown",
        };
        match one.found {
            Ok(found) => {
                let values = [
                    ("name", name.as_str()),
                    ("found", &tenths_of_micrometres(found)),
                    ("verdict", speech.get(verdict)),
                    ("expected", &expected),
                ];
                speech.fill("size-line", &values)
            }
            Err(why) => {
                let why = speech.find(&format!("size-{}", why.word()));
                speech.fill("size-line-none", &[("name", &name), ("why", why), ("expected", &expected)])
            }
        }
    };
    judged.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

/// The same as JSON.
pub(crate) fn judged_json(judged: &[Judged]) -> Vec<Value> {
    let one = |one: &Judged| {
        json!({
            "name": one.measure.name,
            "quantity": one.measure.quantity.key().trim_end_matches("_mm"),
            "nominal": one.measure.nominal_mm,
            "upper": one.measure.deviations_mm.map(|(upper, _)| upper),
            "lower": one.measure.deviations_mm.map(|(_, lower)| lower),
            "found": one.found.ok(),
            "why": one.found.err().map(|why| why.word()),
            "pass": one.passes(),
        })
    };
    judged.iter().map(one).collect()
}

/// Tenths of a micrometre, as tolerances need them.
fn tenths_of_micrometres(value: f64) -> String {
    ((value * 1e4).round() / 1e4 + 0.0).to_string()
}

/// From one Z to another, as measured from the front.
pub(crate) fn z_text(z: f64) -> String {
    format!("Z{}", mm(z))
}
