//! SARIF 2.1.0: one document with every finding, for code review tools.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use turnwright_diagnostics::Severity;

use crate::environment::ProgramText;
use crate::finding::Finding;
use crate::speech::Speech;

/// One finding and the rule that it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct SarifResult {
    key: String,
    result: Value,
}

/// A finding as a result.
pub(crate) fn result(finding: &Finding, speech: Speech, text: Option<&ProgramText>) -> SarifResult {
    let words = finding.words(speech.messages(), speech.language);
    let hint = finding.hint.as_ref().map_or(String::new(), |hint| format!(" ({hint})"));
    let mut region = json!({});
    if let Some(spot) = finding.spot(text) {
        // A region that ends where it starts is a place between two characters.
        region = json!({
            "startLine": spot.line.max(1),
            "startColumn": spot.column.max(1),
            "endColumn": spot.end_column.max(spot.column).max(1),
        });
    }
    let mut location = json!({ "artifactLocation": { "uri": uri(&finding.file) } });
    if region.get("startLine").is_some() {
        location["region"] = region;
    }
    let mut result = json!({
        "ruleId": finding.diagnostic.key,
        "level": level(finding.diagnostic.severity),
        "message": { "text": format!("{}{hint}. {}", words.message, words.remedy) },
        "properties": { "id": finding.id(speech.messages()) },
    });
    if !finding.file.is_empty() {
        result["locations"] = json!([{ "physicalLocation": location }]);
    }
    SarifResult { key: finding.diagnostic.key.to_string(), result }
}

/// The document, as one line of JSON.
pub(crate) fn document(results: &[SarifResult], speech: Speech) -> String {
    let mut rules: BTreeMap<&str, Value> = BTreeMap::new();
    for found in results {
        rules.entry(&found.key).or_insert_with(|| rule(&found.key, speech));
    }
    let rules: Vec<Value> = rules.into_values().collect();
    let results: Vec<&Value> = results.iter().map(|found| &found.result).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "Turnwright", "version": env!("CARGO_PKG_VERSION"), "rules": rules } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
    .to_string()
}

fn rule(key: &str, speech: Speech) -> Value {
    match speech.messages().raw(key, speech.language) {
        Some(words) => json!({
            "id": key,
            "shortDescription": { "text": without_arguments(&words.message) },
            "fullDescription": { "text": words.cause },
            "help": { "text": words.remedy },
        }),
        None => json!({ "id": key }),
    }
}

/// A message as the heading of a rule: what differs from case to case becomes an ellipsis.
fn without_arguments(message: &str) -> String {
    let mut parts = message.split('{');
    let first = parts.next().unwrap_or_default().to_string();
    parts.fold(first, |heading, part| heading + "…" + part.split_once('}').map_or(part, |(_, rest)| rest))
}

const fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Alarm | Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// A path as a relative or absolute reference; what is not plain is escaped.
fn uri(file: &str) -> String {
    let mut out = String::with_capacity(file.len());
    if file.starts_with('/') {
        out.push_str("file://");
    }
    for byte in file.replace('\\', "/").bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => {
                out.push(byte.into())
            }
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}
