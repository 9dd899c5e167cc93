//! Questions and controls as Rust: the enums of `data/policies.toml`, and every control with what its bases say.
//!
//! In: the tables of both. Out: the source of the enums and of a constant. An answer that is no reading of its question
//! stops the build by its place; a question that nobody answers is a missing field to the compiler.

use std::collections::BTreeMap;
use std::fmt::Write;

use toml::{Table, Value};

use super::tables::{literal, pascal, read};

/// Most bases above each other.
const BASES_MAX: usize = 10;

/// The enums of the questions, and a struct of the answers.
pub(crate) fn policies(questions: &Table) -> String {
    let (mut source, mut fields) = (String::new(), String::new());
    for (name, question) in questions {
        let mut readings = question.as_table().unwrap_or_else(|| panic!("{name} is no table")).clone();
        let asks = readings.remove("asks").unwrap_or_else(|| panic!("{name} asks nothing"));
        let asks = text(name, &asks);
        let variants: String = readings
            .iter()
            .map(|(reading, means)| format!("    /// {}\n    {},\n", text(reading, means), pascal(reading)))
            .collect();
        let r#enum = pascal(name);
        let _ = write!(
            source,
            "/// {asks}\n#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum {enum} {{\n{variants}}}\n\n"
        );
        let _ = write!(fields, "    /// {asks}\n    pub {}: {enum},\n", field(name));
    }
    source
        + "/// A control's answers.\n#[derive(Clone, Copy, Debug)]\npub struct Policies {\n"
        + &fields
        + "}\n"
}

/// The controls, by name, that are not only bases.
pub(crate) fn controls(questions: &Table, files: &BTreeMap<String, Table>) -> String {
    let mut source = "pub(crate) const CONTROLS: &[Definition] = &[\n".to_string();
    for (name, file) in files {
        if file.get("abstract").and_then(Value::as_bool) != Some(true) {
            source += &control(name, questions, files);
        }
    }
    source + "];\n"
}

fn control(name: &str, questions: &Table, files: &BTreeMap<String, Table>) -> String {
    let (whole, lineage) = whole(name, files);
    let table = |key: &str| whole.get(key).and_then(Value::as_table).cloned().unwrap_or_default();
    let word = |key: &str, otherwise: &str| {
        whole.get(key).map_or_else(|| otherwise.to_string(), |value| text(key, value).to_string())
    };
    let answers: String = table("policies")
        .iter()
        .map(|(question, answer)| {
            let answer = text(question, answer);
            let readings = questions.get(question).and_then(Value::as_table);
            let is_reading =
                answer != "asks" && readings.is_some_and(|readings| readings.contains_key(answer));
            assert!(is_reading, "{name}: {answer} is no reading of {question} in data/policies.toml");
            format!("{}: {}::{}, ", field(question), pascal(question), pascal(answer))
        })
        .collect();
    let limits: String = table("limits")
        .iter()
        .map(|(limit, value)| {
            let number = value.as_integer().unwrap_or_else(|| panic!("{name}: {limit} is no whole number"));
            format!("{}: {number}, ", field(limit))
        })
        .collect();
    let parameters: String = table("parameters")
        .iter()
        .map(|(parameter, value)| {
            let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
            let number = number.unwrap_or_else(|| panic!("{name}: {parameter} has no number"));
            format!("({parameter:?}, {number:?}), ")
        })
        .collect();
    let later: String = table("words-for-later")
        .iter()
        .map(|(function, words)| format!("({function:?}, {:?}), ", text(function, words)))
        .collect();
    let summary = table("summary");
    let [en, zh] = ["en", "zh"]
        .map(|language| summary.get(language).map_or("", |words| text(language, words)).to_string());
    format!(
        "    Definition {{ name: {name:?}, lineage: &{lineage:?}, title: {}, summary: [{}, {}], parameter_map: {}, \
         alarm_ids: AlarmIds::{}, policies: Policies {{ {answers} }}, limits: Limits {{ {limits} }}, \
         parameters: &[{parameters}], words_for_later: &[{later}] }},\n",
        literal(word("title", name)),
        literal(en),
        literal(zh),
        literal(word("parameter-map", "")),
        pascal(&word("alarm-ids", "four")),
    )
}

/// A control with everything that its bases say and it does not, and the names of both, nearest first. Title and
/// summary are its own.
fn whole(name: &str, files: &BTreeMap<String, Table>) -> (Table, Vec<String>) {
    const KEYS: [&str; 10] = [
        "abstract",
        "base",
        "title",
        "summary",
        "parameter-map",
        "alarm-ids",
        "policies",
        "limits",
        "parameters",
        "words-for-later",
    ];
    let mut whole = Table::new();
    let (mut lineage, mut next) = (Vec::new(), Some(name.to_string()));
    while let Some(name) = next {
        assert!(lineage.len() < BASES_MAX, "{lineage:?}: too many bases");
        let file = files.get(&name).unwrap_or_else(|| panic!("{lineage:?}: base {name} does not exist"));
        for (key, value) in file {
            assert!(KEYS.contains(&key.as_str()), "{name}: {key} is not known here");
            match (whole.get_mut(key), value) {
                (Some(Value::Table(own)), Value::Table(above)) if key != "summary" => {
                    for (key, value) in above {
                        own.entry(key).or_insert_with(|| value.clone());
                    }
                }
                (None, _) if lineage.is_empty() || !matches!(key.as_str(), "title" | "summary") => {
                    whole.insert(key.clone(), value.clone());
                }
                _ => {}
            }
        }
        next = file.get("base").map(|base| text("base", base).to_string());
        lineage.push(name);
    }
    (whole, lineage)
}

/// The control files of a folder.
pub(crate) fn files(paths: &[std::path::PathBuf]) -> BTreeMap<String, Table> {
    let name = |path: &std::path::Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    paths.iter().map(|path| (name(path).expect("a file name"), read(path))).collect()
}

fn text<'v>(place: &str, value: &'v Value) -> &'v str {
    value.as_str().unwrap_or_else(|| panic!("{place} is no text"))
}

fn field(name: &str) -> String {
    name.replace('-', "_")
}
