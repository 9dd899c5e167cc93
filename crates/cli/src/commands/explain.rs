//! `turnwright explain`: what a code, an alarm or a parameter means on a control.
//!
//! One question may have several answers: a number can be an alarm and a parameter, and one alarm number can
//! stand for several conditions. All of them are given.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::sync::LazyLock;

use serde_json::{Value, json};
use turnwright_control::{
    CodeSystem, Control, DEFAULT_CONTROL, FunctionEntry, Messages, RaisedBy, control_names, nearest,
    parse_code,
};
use turnwright_interpreter::implemented_functions;

use super::controls::parameters;
use crate::arguments::{Explain, LookupFormat};
use crate::fault::{Fault, Status};
use crate::render::{Printer, clean};
use crate::report::code_system;
use crate::session::load_control;
use crate::speech::Speech;
use crate::table::heading;

type Auxiliary = BTreeMap<String, toml::Table>;

/// The M codes.
static AUXILIARY: LazyLock<Auxiliary> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../../data/auxiliary.toml"))
        .unwrap_or_else(|error| unreachable!("data/auxiliary.toml is read by a test: {error}"))
});

/// One meaning of what was asked.
struct Answer {
    /// `code`, `auxiliary`, `alarm` or `parameter`.
    kind: &'static str,
    id: String,
    key: String,
    title: String,
    /// Labelled paragraphs, in order: the key of the label (empty for none) and the text.
    paragraphs: Vec<(&'static str, String)>,
}

/// Answers.
pub(crate) fn run(options: &Explain, printer: &Printer) -> Result<Status, Fault> {
    if let Some(line) = options.line {
        return super::passes::run(options, line, printer);
    }
    let speech = printer.speech;
    let control = load_control(options.machine.control.as_deref().unwrap_or(DEFAULT_CONTROL), "", speech)?;
    let asked = options.code.trim();
    let answers = answers(asked, &control, speech);
    if answers.is_empty() {
        return Err(Fault::Usage(unknown(asked, &control, speech)));
    }
    let text = match options.format {
        LookupFormat::Human => human(&answers, &control, speech),
        LookupFormat::Json => format!("{}\n", json(&answers, &control)),
    };
    let mut out = printer.standard_output();
    out.write_all(text.as_bytes())?;
    out.flush()?;
    Ok(Status::Clean)
}

/// Every meaning of what was asked.
fn answers(asked: &str, control: &Control, speech: Speech) -> Vec<Answer> {
    let mut answers = functions(asked, control, speech);
    answers.extend(auxiliaries(asked, speech));
    answers.extend(alarms(asked, control, speech));
    answers.extend(shown_parameters(asked, control, speech));
    answers
}

fn human(answers: &[Answer], control: &Control, speech: Speech) -> String {
    let mut out = String::new();
    for answer in answers {
        if !out.is_empty() {
            out.push('\n');
        }
        let kind = speech.fill(&format!("kind-{}", answer.kind), &[("control", control.name)]);
        out.push_str(&format!("{}  ({kind})\n", heading(&format!("{}  {}", answer.id, answer.title))));
        for (label, text) in &answer.paragraphs {
            if label.is_empty() {
                out.push_str(&format!("  {text}\n"));
            } else {
                out.push_str(&format!("  {}{}{text}\n", speech.get(label), speech.get("colon")));
            }
        }
    }
    out
}

fn json(answers: &[Answer], control: &Control) -> Value {
    let list: Vec<Value> = answers
        .iter()
        .map(|answer| {
            let mut object = json!({
                "kind": answer.kind, "id": answer.id, "key": answer.key, "title": answer.title,
                "control": control.name,
            });
            for (label, text) in &answer.paragraphs {
                let name = if label.is_empty() { "text" } else { label.trim_start_matches("label-") };
                object[name] = json!(text);
            }
            object
        })
        .collect();
    Value::Array(list)
}

fn functions(asked: &str, control: &Control, speech: Speech) -> Vec<Answer> {
    let table = speech.functions();
    let wanted = asked.strip_prefix(['G', 'g']).and_then(parse_code);
    let system = code_system(control);
    if let Some(entry) = table.get(asked) {
        return vec![function(asked, entry, control, speech)];
    }
    let Some(code) = wanted else { return Vec::new() };
    if let Some((name, entry)) = table.by_code(code, system, control.code_table) {
        return vec![function(name, entry, control, speech)];
    }
    // Not here: what it is elsewhere, on other controls or in the other code tables.
    let names_it = |entry: &FunctionEntry| {
        SYSTEMS.iter().any(|(system, _)| {
            entry.code(*system).is_some_and(|text| text.split('/').any(|one| parse_code(one) == Some(code)))
        })
    };
    table
        .iter()
        .filter(|(_, entry)| names_it(entry))
        .map(|(name, entry)| function(name, entry, control, speech))
        .collect()
}

const SYSTEMS: [(CodeSystem, &str); 3] = [(CodeSystem::A, "A"), (CodeSystem::B, "B"), (CodeSystem::C, "C")];

fn function(name: &str, entry: &FunctionEntry, control: &Control, speech: Speech) -> Answer {
    let system = code_system(control);
    let codes: Vec<String> = SYSTEMS
        .iter()
        .filter_map(|(system, letter)| Some(format!("{letter} {}", entry.code(*system)?)))
        .collect();
    let any = SYSTEMS.iter().find_map(|(system, _)| entry.code(*system)).unwrap_or(name);
    let mut paragraphs = vec![("", entry.text(speech.language).to_string())];
    if !entry.forms.is_empty() {
        paragraphs.push(("label-form", entry.forms.join("  |  ")));
    }
    paragraphs.push(("label-systems", codes.join(", ")));
    paragraphs.push(("label-group", format!("{:02}", entry.group().0)));
    let on: Vec<&str> = control_names().into_iter().filter(|name| entry.is_on(name)).collect();
    let on = if on.len() == control_names().len() {
        speech.get("all-controls").to_string()
    } else {
        on.join(", ")
    };
    paragraphs.push(("label-on", on));
    let state = if !entry.is_on(control.code_table) || entry.code(system).is_none() {
        speech.fill("not-on-control", &[("control", control.name)])
    } else if implemented_functions().any(|known| known == name) {
        speech.get("is-executed").to_string()
    } else {
        speech.get("is-not-executed").to_string()
    };
    paragraphs.push(("label-state", state));
    Answer {
        kind: "code",
        id: entry.code(system).unwrap_or(any).to_string(),
        key: name.to_string(),
        title: entry.name(speech.language).to_string(),
        paragraphs,
    }
}

fn auxiliaries(asked: &str, speech: Speech) -> Vec<Answer> {
    let Some(wanted) = asked.strip_prefix(['M', 'm']).and_then(parse_code) else { return Vec::new() };
    let tag = speech.get("language-tag");
    AUXILIARY
        .iter()
        .filter_map(|(key, entry)| {
            let code = entry.get("code")?.as_str()?;
            let words = entry.get(tag)?.as_table()?;
            let word = |name: &str| words.get(name).and_then(toml::Value::as_str).unwrap_or("").to_string();
            code.split('/').any(|one| parse_code(one) == Some(wanted)).then(|| Answer {
                kind: "auxiliary",
                id: code.to_string(),
                key: key.clone(),
                title: word("name"),
                paragraphs: vec![("", word("text"))],
            })
        })
        .collect()
}

fn alarms(asked: &str, control: &Control, speech: Speech) -> Vec<Answer> {
    let messages = speech.messages();
    let lower = asked.to_ascii_lowercase();
    let mut keys = messages.by_id(asked, control.alarm_ids);
    if messages.raw(&lower, speech.language).is_some() {
        keys = vec![lower.as_str()];
    }
    let of_program = number_of_program(asked, control);
    if of_program.is_some() {
        keys.push(Messages::OF_PROGRAM);
    }
    keys.into_iter()
        .filter_map(|key| {
            let words = messages.raw(key, speech.language)?;
            let id = messages.id(key, control.alarm_ids).unwrap_or(key);
            let mut paragraphs = vec![
                ("label-cause", readable(&words.cause)),
                ("label-cure", readable(&words.remedy)),
                ("label-key", key.to_string()),
            ];
            if let Some(why) = messages.raised_by(key) {
                paragraphs.push(("label-raised", speech.get(raised_label(why)).to_string()));
            }
            Some(Answer {
                kind: "alarm",
                id: match of_program {
                    Some(number) if key == Messages::OF_PROGRAM => {
                        id.replace("{number}", &number.to_string())
                    }
                    _ => id.to_string(),
                },
                key: key.to_string(),
                title: if key == Messages::OF_PROGRAM {
                    speech.get("alarm-of-program").to_string()
                } else {
                    readable(&words.message)
                },
                paragraphs,
            })
        })
        .collect()
}

/// The number of an alarm that programs raise themselves: `3012`, `MC3012`, `5912`.
fn number_of_program(asked: &str, control: &Control) -> Option<u32> {
    let number = asked.to_ascii_uppercase().trim_start_matches("MC").parse::<u32>().ok()?;
    let limits = &control.limits;
    (limits.user_alarm_base..=limits.user_alarm_base + limits.user_alarm_max)
        .contains(&number)
        .then_some(number)
}

/// The text that says when an alarm can come.
const fn raised_label(why: RaisedBy) -> &'static str {
    match why {
        RaisedBy::Operator => "raised-operator",
        RaisedBy::Device => "raised-device",
        RaisedBy::CommandLine | RaisedBy::Limit | RaisedBy::Note => "raised-here",
        RaisedBy::Policy | RaisedBy::Option => "raised-option",
        RaisedBy::OutsideScope => "raised-later",
    }
}

/// A message whose places are not filled: `{word}` reads as `…`.
fn readable(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        out.push('…');
        rest = after.split_once('}').map_or("", |(_, after)| after);
    }
    out.push_str(rest);
    out.trim_start_matches("…: ").trim_start_matches("…：").to_string()
}

fn shown_parameters(asked: &str, control: &Control, speech: Speech) -> Vec<Answer> {
    let number = asked.trim_start_matches("No.").trim_start_matches("no.");
    let found = control.parameters.find(number).map(|(key, ..)| key);
    let bits = |known: &str| known.split_once('#').is_some_and(|(word, _)| same_number(word, number));
    parameters(control, speech)
        .into_iter()
        .filter(|one| match &found {
            Some(key) => one.key == *key,
            None => one.key == asked || (bits(&one.number) && !number.contains('#')),
        })
        .map(|one| Answer {
            kind: "parameter",
            title: one.title,
            paragraphs: vec![
                ("", one.effect),
                ("label-value", one.value),
                ("label-unit", one.unit),
                ("label-key", one.key.clone()),
            ],
            id: one.number,
            key: one.key,
        })
        .collect()
}

fn same_number(one: &str, other: &str) -> bool {
    let plain = |text: &str| text.trim_start_matches('0').to_string();
    !other.is_empty() && other.bytes().all(|byte| byte.is_ascii_digit()) && plain(one) == plain(other)
}

fn unknown(asked: &str, control: &Control, speech: Speech) -> String {
    let messages = speech.messages();
    let mut known: BTreeSet<String> = BTreeSet::new();
    known.extend(
        speech
            .functions()
            .iter()
            .filter_map(|(_, entry)| entry.code(code_system(control)).map(str::to_string)),
    );
    known.extend(speech.functions().iter().map(|(name, _)| name.to_string()));
    known.extend(AUXILIARY.values().filter_map(|entry| Some(entry.get("code")?.as_str()?.to_string())));
    known.extend(messages.keys().map(str::to_string));
    known.extend(messages.keys().filter_map(|key| messages.id(key, control.alarm_ids)).map(str::to_string));
    known.extend(control.parameters.all().into_iter().map(|(number, ..)| number));
    let why = speech.fill("explain-unknown", &[("asked", &clean(asked)), ("control", control.name)]);
    match nearest(asked, known.iter().map(String::as_str)) {
        Some(near) => {
            format!("{why}{}{}", speech.get("list-comma"), speech.fill("did-you-mean", &[("name", near)]))
        }
        None => why,
    }
}

#[cfg(test)]
mod tests {
    use turnwright_control::Language;

    use super::*;

    #[test]
    fn messages_without_values_read_as_sentences() {
        assert_eq!(readable("{word}: a count, limit {limit}"), "a count, limit …");
        assert_eq!(readable("plain"), "plain");
    }

    /// Asks on a control, in both languages, and demands texts everywhere and an answer of the kind and key.
    fn ask(asked: &str, control: &Control, kind: &str, key: &str) {
        for language in crate::speech::BOTH {
            let found = answers(asked, control, Speech { language });
            let name = control.name;
            let meant = found.iter().find(|answer| answer.kind == kind && answer.key == key);
            let Some(meant) = meant else { panic!("{name}: {asked} is not explained as {kind} {key}") };
            for (label, text) in &meant.paragraphs {
                let may_be_empty = matches!(*label, "label-unit");
                assert!(may_be_empty || !text.trim().is_empty(), "{name}: {asked}: {label}");
                assert!(!text.contains(['{', '}']), "{name}: {asked}: {text}");
            }
            assert!(!meant.title.trim().is_empty() && !meant.id.is_empty(), "{name}: {asked}");
            assert!(human(&found, control, Speech { language }).lines().count() > 1);
        }
    }

    fn controls() -> impl Iterator<Item = Control> {
        control_names().into_iter().map(|name| Control::load(name).expect("a control"))
    }

    #[test]
    fn every_code_is_explained_on_every_control_that_has_it() {
        let mut asked = 0;
        for control in controls() {
            for (name, entry) in turnwright_control::Functions.iter() {
                let Some(code) = entry.code(code_system(&control)) else { continue };
                if !entry.is_on(control.code_table) || entry.only_with().is_some() {
                    continue;
                }
                for one in code.split('/') {
                    // A code that a parameter gives to another function answers with that one as well.
                    let found = answers(one, &control, Speech { language: Language::English });
                    assert!(found.iter().any(|answer| answer.kind == "code"), "{}: {one}", control.name);
                }
                ask(name, &control, "code", name);
                asked += 1;
            }
            for (key, entry) in AUXILIARY.iter() {
                let code = entry.get("code").and_then(toml::Value::as_str).expect("a code");
                ask(code.split('/').next().expect("one"), &control, "auxiliary", key);
            }
        }
        assert!(asked > 500);
    }

    #[test]
    fn every_alarm_is_explained_by_its_number_on_every_control() {
        let messages = Messages;
        for control in controls() {
            for key in messages.keys() {
                match messages.id(key, control.alarm_ids) {
                    Some(id) if !id.contains('{') => {
                        ask(id, &control, "alarm", key);
                        ask(&id.to_ascii_lowercase(), &control, "alarm", key);
                    }
                    _ => ask(key, &control, "alarm", key),
                }
            }
            let limits = &control.limits;
            for number in [limits.user_alarm_base, limits.user_alarm_base + limits.user_alarm_max] {
                ask(&number.to_string(), &control, "alarm", Messages::OF_PROGRAM);
            }
            assert!(number_of_program(&(limits.user_alarm_base - 1).to_string(), &control).is_none());
        }
        let control = Control::load("fanuc-0i-tf").expect("a control");
        for (asked, key) in
            [("MC3012", "macro-user-alarm"), ("OT0500", "stroke-one-plus"), ("500", "stroke-one-plus")]
        {
            ask(asked, &control, "alarm", key);
        }
        let gsk = Control::load("gsk-980tdi").expect("a control");
        ask("5912", &gsk, "alarm", "macro-user-alarm");
    }

    #[test]
    fn every_parameter_is_explained_by_its_number_on_every_control() {
        let mut asked = 0;
        for control in controls() {
            for (number, key, parameter, _) in control.parameters.all() {
                ask(&number, &control, "parameter", key);
                if parameter.is_per_axis() {
                    // Without the axis: all of them.
                    let whole = number.rsplit_once('.').expect("an axis").0;
                    ask(whole, &control, "parameter", key);
                }
                if let Some((word, _)) = number.split_once('#') {
                    ask(word, &control, "parameter", key);
                }
                asked += 1;
            }
        }
        assert!(asked > 1000);
    }

    #[test]
    fn the_table_of_auxiliary_codes_is_complete() {
        for (key, entry) in AUXILIARY.iter() {
            assert!(entry.get("code").and_then(toml::Value::as_str).and_then(parse_code).is_some(), "{key}");
            assert!(entry.contains_key("en") && entry.contains_key("zh"), "{key}");
        }
    }
}
