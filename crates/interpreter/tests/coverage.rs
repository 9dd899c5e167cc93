//! What the tables promise is shown: every alarm by a fixture, every parameter by code that reads it. What cannot be
//! shown says why, in the table itself.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use turnwright_control::policy::AlarmIds;
use turnwright_control::{Control, Functions, Messages, control_names};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, extension, found);
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
}

/// The text of every source file of the product.
fn sources() -> String {
    let mut found = Vec::new();
    for entry in fs::read_dir(root().join("crates")).expect("crates") {
        files(&entry.expect("a crate").path().join("src"), "rs", &mut found);
    }
    found.iter().map(|file| fs::read_to_string(file).expect("readable")).collect()
}

/// Keys and numbers in the `diagnostics` blocks of the fixtures.
fn shown() -> BTreeMap<String, BTreeSet<String>> {
    let mut found = Vec::new();
    files(&root().join("fixtures"), "md", &mut found);
    let mut shown: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in found {
        let text = fs::read_to_string(&file).expect("readable");
        let mut is_inside = false;
        for line in text.lines() {
            if line.starts_with("```") {
                is_inside = line == "```diagnostics";
            } else if is_inside {
                let mut words = line.split_whitespace().skip(1);
                let (Some(id), Some(key)) = (words.next(), words.next()) else { continue };
                shown.entry(key.to_string()).or_default().insert(id.to_string());
            }
        }
    }
    shown
}

#[test]
fn every_diagnostic_of_a_program_has_a_fixture() {
    let (messages, shown, sources) = (Messages, shown(), sources());
    let mut wrong = Vec::new();
    for key in messages.keys() {
        let is_shown = shown.contains_key(key);
        let in_code = sources.contains(&format!("\"{key}\""));
        match messages.raised_by(key) {
            None if !is_shown => wrong.push(format!("{key}: no fixture shows it")),
            Some(why) if why.is_raised() && !in_code => {
                wrong.push(format!("{key}: nothing in the code raises it"));
            }
            Some(_) if is_shown => wrong.push(format!("{key}: a fixture shows it, so no reason is needed")),
            _ => {}
        }
    }
    assert!(shown.len() > 150, "only {} keys found in the fixtures: the search is broken", shown.len());
    assert!(wrong.is_empty(), "{} diagnostics:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn our_own_numbers_are_given_once() {
    let messages = Messages;
    let mut given: BTreeMap<&str, &str> = BTreeMap::new();
    for key in messages.keys() {
        let Some(id) = messages.own_id(key) else { continue };
        assert!(id.starts_with('T'), "{key}: {id}");
        if let Some(other) = given.insert(id, key) {
            panic!("{id} is {other} and {key}");
        }
    }
    assert!(given.len() > 100);
}

#[test]
fn whatever_a_program_raises_has_a_number_everywhere() {
    let messages = Messages;
    for key in messages.keys().filter(|key| messages.raised_by(key).is_none()) {
        for ids in [AlarmIds::Three, AlarmIds::Four, AlarmIds::Named] {
            assert!(messages.id(key, ids).is_some(), "{key} has no number where controls have {ids:?}");
        }
    }
}

#[test]
fn a_number_of_a_control_is_that_of_its_family() {
    let messages = Messages;
    let digits = |id: &str| id.bytes().all(|byte| byte.is_ascii_digit());
    for key in messages.keys() {
        if let Some(id) =
            messages.id(key, AlarmIds::Three).filter(|id| !id.starts_with('T') && !id.contains('{'))
        {
            assert!(digits(id) && id.len() >= 3, "{key}: {id}");
        }
        if let Some(id) =
            messages.id(key, AlarmIds::Four).filter(|id| !id.starts_with('T') && !id.contains('{'))
        {
            let number = id.get(2..).unwrap_or("");
            let class = &id[..2];
            assert!(["PS", "OT", "OH", "SV", "SP", "SW", "PW", "MC"].contains(&class), "{key}: {id}");
            assert!(digits(number) && number.len() == 4, "{key}: {id}");
        }
    }
}

#[test]
fn every_parameter_is_read_or_says_why_not() {
    let (sources, functions) = (sources(), Functions);
    let mut parameters = BTreeMap::new();
    for name in control_names() {
        let control = Control::load(name).expect("a control");
        parameters
            .extend(control.parameters.all().into_iter().map(|(_, name, parameter, _)| (name, parameter)));
    }
    let mut wrong = Vec::new();
    for (name, parameter) in &parameters {
        // Rows of equal parameters are read by a name that ends in their number.
        let row = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_read = sources.contains(&format!("\"{name}\""))
            || (row != *name && sources.contains(&format!("\"{row}{{")))
            || functions.iter().any(|(_, entry)| entry.only_with() == Some(*name));
        if is_read == parameter.acts().is_some() {
            let what = if is_read { "is read, so no reason is needed" } else { "nothing reads it" };
            wrong.push(format!("{name}: {what}"));
        }
    }
    assert!(parameters.len() > 200);
    assert!(wrong.is_empty(), "{} parameters:\n{}", wrong.len(), wrong.join("\n"));
}
