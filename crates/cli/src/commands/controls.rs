//! `turnwright controls`: the controls that are known, one in full, or what differs between two.

use std::io::Write;

use serde_json::{Map, Value, json};
use turnwright_control::{Control, DEFAULT_CONTROL, Language, control_names};

use crate::arguments::{Controls, LookupFormat};
use crate::fault::{Fault, Status};
use crate::render::Printer;
use crate::report::code_system;
use crate::session::load_control;
use crate::speech::Speech;
use crate::table::{Side, Table, facts, heading};

/// Answers.
pub(crate) fn run(options: &Controls, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let answer = match (&options.name, options.diff.as_deref()) {
        (_, Some([one, other])) => {
            let controls = [load_control(one, "", speech)?, load_control(other, "", speech)?];
            match options.format {
                LookupFormat::Human => difference_text(&controls, speech),
                LookupFormat::Json => format!("{}\n", difference_json(&controls, speech)),
            }
        }
        (Some(name), _) => {
            let control = load_control(name, "", speech)?;
            match options.format {
                LookupFormat::Human => full_text(&control, speech),
                LookupFormat::Json => format!("{}\n", full_json(&control, speech)),
            }
        }
        (None, _) => {
            let controls = control_names().into_iter().map(|name| load_control(name, "", speech));
            let controls = controls.collect::<Result<Vec<_>, _>>()?;
            match options.format {
                LookupFormat::Human => list_text(&controls, speech),
                LookupFormat::Json => {
                    let list: Vec<Value> =
                        controls.iter().map(|control| summary_json(control, speech)).collect();
                    format!("{}\n", Value::Array(list))
                }
            }
        }
    };
    let mut out = printer.standard_output();
    out.write_all(answer.as_bytes())?;
    out.flush()?;
    Ok(Status::Clean)
}

fn summary(control: &Control, speech: Speech) -> &str {
    match speech.language {
        Language::English => control.summary[0],
        Language::Chinese => control.summary[1],
    }
}

/// Codes and names of the functions that a control has.
fn codes(control: &Control, speech: Speech) -> Vec<(String, String)> {
    let system = code_system(control);
    let functions = speech.functions().iter().filter(|(_, entry)| entry.is_on(control.code_table));
    let mut codes: Vec<_> = functions
        .filter_map(|(_, entry)| {
            Some((entry.code(system)?.to_string(), entry.name(speech.language).to_string()))
        })
        .collect();
    codes.sort();
    codes
}

fn list_text(controls: &[Control], speech: Speech) -> String {
    let mut table = Table::new(&[Side::Left, Side::Left, Side::Right, Side::Right, Side::Left]);
    table.row(
        ["name", "title", "codes", "parameters", "summary"]
            .map(|key| speech.fill(&format!("column-{key}"), &[])),
    );
    for control in controls {
        let name = control.name.to_string();
        let mark = if control.name == DEFAULT_CONTROL { speech.get("default-mark") } else { "" };
        table.row([
            name,
            control.title.to_string(),
            codes(control, speech).len().to_string(),
            control.parameters.all().len().to_string(),
            format!("{}{mark}", summary(control, speech)),
        ]);
    }
    format!("{}\n{}\n", table.text(0, true), speech.get("controls-more"))
}

fn full_text(control: &Control, speech: Speech) -> String {
    let row = |key: &'static str, value: &str| (speech.get(key).to_string(), value.to_string());
    let mut out = facts(&[
        row("control", control.name),
        row("title", control.title),
        row("summary", summary(control, speech)),
    ]);
    for (key, fields) in [("policies", policies(control)), ("limits", limits(control))] {
        out.push_str(&format!("\n{}\n", heading(speech.get(key))));
        let mut table = Table::new(&[Side::Left, Side::Left]);
        fields.iter().for_each(|(name, value)| table.row([name, value]));
        out.push_str(&table.text(2, false));
    }
    out.push_str(&format!("\n{}\n", heading(speech.get("parameters"))));
    let mut table = Table::new(&[Side::Left, Side::Right, Side::Left]);
    for parameter in parameters(control, speech) {
        table.row([parameter.number, parameter.value, parameter.title]);
    }
    out.push_str(&table.text(2, false));
    out.push_str(&format!("\n{}\n", heading(speech.get("codes"))));
    let mut table = Table::new(&[Side::Left, Side::Left]);
    codes(control, speech).iter().for_each(|(code, name)| table.row([code, name]));
    out.push_str(&table.text(2, false));
    out
}

fn summary_json(control: &Control, speech: Speech) -> Value {
    json!({
        "name": control.name,
        "title": control.title,
        "summary": summary(control, speech),
        "is_default": control.name == DEFAULT_CONTROL,
        "codes": codes(control, speech).len(),
        "parameters": control.parameters.all().len(),
    })
}

fn full_json(control: &Control, speech: Speech) -> Value {
    let object = |fields: Vec<(String, String)>| -> Map<String, Value> {
        fields.into_iter().map(|(name, value)| (name, scalar(&value))).collect()
    };
    let parameters: Vec<Value> = parameters(control, speech)
        .into_iter()
        .map(|one| json!({ "number": one.number, "key": one.key, "name": one.title, "value": scalar(&one.value) }))
        .collect();
    let codes: Vec<Value> = codes(control, speech)
        .into_iter()
        .map(|(code, name)| json!({ "code": code, "name": name }))
        .collect();
    json!({
        "name": control.name,
        "title": control.title,
        "summary": summary(control, speech),
        "is_default": control.name == DEFAULT_CONTROL,
        "policies": object(policies(control)),
        "limits": object(limits(control)),
        "parameters": parameters,
        "codes": codes,
    })
}

/// A number where it is one.
fn scalar(value: &str) -> Value {
    value.parse::<f64>().map_or_else(
        |_| json!(value),
        |number| if number.fract() == 0.0 { json!(number as i64) } else { json!(number) },
    )
}

/// What is compared, in the order in which it is shown; each has its title in the texts.
const SECTIONS: [&str; 6] =
    ["policies", "limits", "codes", "parameters", "parameter-numbers", "alarm-numbers"];

/// One line of what differs: section, name, value on the one, value on the other.
struct Difference {
    section: &'static str,
    name: String,
    values: [String; 2],
}

fn differences([one, other]: &[Control; 2], speech: Speech) -> Vec<Difference> {
    let mut found = Vec::new();
    let mut compare = |section, left: Vec<(String, String)>, right: Vec<(String, String)>| {
        let of = |fields: &[(String, String)], name: &str| {
            fields
                .iter()
                .find(|(known, _)| known == name)
                .map_or_else(|| "-".to_string(), |(_, value)| value.clone())
        };
        let mut names: Vec<&String> = left.iter().chain(&right).map(|(name, _)| name).collect();
        let mut seen = std::collections::HashSet::new();
        names.retain(|name| seen.insert(name.as_str()));
        for name in names {
            let values = [of(&left, name), of(&right, name)];
            if values[0] != values[1] {
                found.push(Difference { section, name: name.clone(), values });
            }
        }
    };
    let ids = |control: &Control| vec![("alarm-ids".to_string(), kebab(&format!("{:?}", control.alarm_ids)))];
    compare("policies", [ids(one), policies(one)].concat(), [ids(other), policies(other)].concat());
    compare("limits", limits(one), limits(other));
    let stated = |control: &Control| -> Vec<ParameterFacts> {
        let shown = parameters(control, speech).into_iter();
        shown
            .map(|one| ParameterFacts { title: one.titled(), number: one.number, value: one.value })
            .collect()
    };
    let (left, right) = (stated(one), stated(other));
    // A parameter whose number alone differs behaves alike: that is a list of its own.
    let value_of = |facts: &[ParameterFacts], title: &str| {
        facts.iter().find(|facts| facts.title == title).map(|facts| facts.value.clone())
    };
    let behaves_alike =
        |title: &str| value_of(&left, title).is_some() && value_of(&left, title) == value_of(&right, title);
    let differing = |facts: &[ParameterFacts]| -> Vec<(String, String)> {
        let facts = facts.iter().filter(|facts| !behaves_alike(&facts.title));
        facts.map(|facts| (facts.title.clone(), format!("{} = {}", facts.number, facts.value))).collect()
    };
    let numbers = |facts: &[ParameterFacts]| -> Vec<(String, String)> {
        let facts = facts.iter().filter(|facts| behaves_alike(&facts.title));
        facts.map(|facts| (facts.title.clone(), facts.number.clone())).collect()
    };
    compare("parameters", differing(&left), differing(&right));
    compare("parameter-numbers", numbers(&left), numbers(&right));
    compare("codes", codes(one, speech), codes(other, speech));
    let messages = speech.messages();
    let mut keys: Vec<&str> = messages.keys().collect();
    keys.sort_unstable();
    // 062 and PS0062 are one number in two spellings; the policy above says so once.
    let is_one_number = |key: &&str| {
        let number = |control: &Control| messages.id(key, control.alarm_ids).map(plain_number);
        number(one) == number(other)
    };
    keys.retain(|key| !is_one_number(key));
    let ids = |control: &Control| -> Vec<(String, String)> {
        let id = |key: &&str| messages.id(key, control.alarm_ids).unwrap_or("-").to_string();
        keys.iter().map(|key| ((*key).to_string(), id(key))).collect()
    };
    compare("alarm-numbers", ids(one), ids(other));
    found
}

/// A parameter as it is compared.
struct ParameterFacts {
    title: String,
    number: String,
    value: String,
}

/// An alarm number without what its family puts before it: `062` and `PS0062` are 62. Names stay.
fn plain_number(id: &str) -> &str {
    let digits = id.trim_start_matches(|c: char| c.is_ascii_uppercase());
    if digits.bytes().all(|byte| byte.is_ascii_digit()) && !id.starts_with('T') {
        digits.trim_start_matches('0')
    } else {
        id
    }
}

fn difference_text(controls: &[Control; 2], speech: Speech) -> String {
    let differences = differences(controls, speech);
    if differences.is_empty() {
        return format!("{}\n", speech.get("no-difference"));
    }
    let mut out = String::new();
    for section in SECTIONS {
        let of_section: Vec<_> = differences.iter().filter(|one| one.section == section).collect();
        if of_section.is_empty() {
            continue;
        }
        let mut table = Table::new(&[Side::Left, Side::Left, Side::Left]);
        table.row([speech.get(section), controls[0].name, controls[1].name]);
        for one in of_section {
            table.row([one.name.as_str(), &one.values[0], &one.values[1]]);
        }
        if !out.is_empty() {
            out.push('\n');
        }
        out.push_str(&table.text(0, true));
    }
    out
}

fn difference_json(controls: &[Control; 2], speech: Speech) -> Value {
    let rows: Vec<Value> = differences(controls, speech)
        .into_iter()
        .map(|one| json!({ "section": one.section, "name": one.name, "values": one.values }))
        .collect();
    json!({ "controls": [controls[0].name, controls[1].name], "differences": rows })
}

/// A parameter as the control shows it.
pub(super) struct ShownParameter {
    /// Its name in the data.
    pub(super) key: String,
    /// Its number.
    pub(super) number: String,
    /// Its value as the control shows it: some bits have the opposite sense there.
    pub(super) value: String,
    /// Its unit.
    pub(super) unit: String,
    /// Its name.
    pub(super) title: String,
    /// What it changes.
    pub(super) effect: String,
}

impl ShownParameter {
    /// Its name, with the axis where each has its own value.
    fn titled(&self) -> String {
        match self.number.split_once('.') {
            Some((_, axis)) => format!("{} {axis}", self.title),
            None => self.title.clone(),
        }
    }
}

/// The parameters of a control.
pub(super) fn parameters(control: &Control, speech: Speech) -> Vec<ShownParameter> {
    let all = control.parameters.all();
    all.into_iter()
        .map(|(number, key, parameter, value)| {
            let name = parameter.name(speech.language);
            ShownParameter {
                title: number.split_once('.').map_or(name.to_string(), |(_, axis)| format!("{name}, {axis}")),
                effect: parameter.effect(speech.language).to_string(),
                unit: parameter.unit.to_string(),
                value: value.to_string(),
                key: key.to_string(),
                number,
            }
        })
        .collect()
}

fn policies(control: &Control) -> Vec<(String, String)> {
    fields(&format!("{:?}", control.policies))
}

fn limits(control: &Control) -> Vec<(String, String)> {
    fields(&format!("{:?}", control.limits))
}

/// Names and values of a plain structure, spelled as in the data. Its own debugging output is the one list of
/// its fields, so that a new policy is shown without anybody remembering this place.
fn fields(debug: &str) -> Vec<(String, String)> {
    let inner = debug.split_once('{').map_or("", |(_, rest)| rest).trim_end_matches(['}', ' ']);
    inner
        .split(", ")
        .filter_map(|field| field.split_once(": "))
        .map(|(name, value)| (name.trim().replace('_', "-"), kebab(value.trim())))
        .collect()
}

/// `ByParameter` as the data spells it: `by-parameter`.
fn kebab(variant: &str) -> String {
    let mut out = String::new();
    for (index, character) in variant.chars().enumerate() {
        if character.is_ascii_uppercase() && index > 0 {
            out.push('-');
        }
        out.push(character.to_ascii_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn policies_are_spelled_as_in_the_data() {
        let control = Control::load(DEFAULT_CONTROL).expect("the default");
        let policies = policies(&control);
        assert!(policies.contains(&("decimal-rule".to_string(), "by-parameter".to_string())), "{policies:?}");
        assert!(
            limits(&control)
                .iter()
                .any(|(name, value)| name == "call-depth-max" && value.parse::<u8>().is_ok())
        );
    }
}
