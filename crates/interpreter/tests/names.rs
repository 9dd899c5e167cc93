//! Every name that the code uses stands in the data: alarms, functions, parameters.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use turnwright_control::{Control, Functions, Language, Messages, control_names};
use turnwright_interpreter::implemented_functions;

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// String literals that are written as names are: lower case with hyphens.
fn names_in(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.split('"').skip(1).step_by(2))
        .filter(|literal| {
            literal.contains('-')
                && literal.starts_with(|c: char| c.is_ascii_lowercase())
                && literal.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
        })
}

#[test]
fn every_name_in_the_code_is_in_the_data() {
    let messages = Messages;
    let mut known: BTreeSet<String> = messages.keys().map(str::to_string).collect();
    known.extend(Functions.iter().map(|(name, _)| name.to_string()));
    for name in control_names() {
        let control = Control::load(name).expect("a control");
        known.extend(control.parameters.all().into_iter().map(|(_, name, ..)| name.to_string()));
    }
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    let mut count = 0;
    for file in files {
        let text = fs::read_to_string(&file).expect("readable");
        for name in names_in(&text) {
            assert!(known.contains(name), "{}: {name} is in no table of data/", file.display());
            count += 1;
        }
    }
    assert!(count > 150, "only {count} names found: the search is broken");
}

#[test]
fn every_function_that_runs_has_its_entry_and_every_entry_its_texts() {
    let functions = Functions;
    for name in implemented_functions() {
        let entry = functions.get(name).unwrap_or_else(|| panic!("{name} is not in data/functions.toml"));
        assert!(!entry.forms.is_empty(), "{name} has no form");
    }
    for (name, entry) in functions.iter() {
        for language in [Language::English, Language::Chinese] {
            assert!(!entry.name(language).is_empty() && !entry.text(language).is_empty(), "{name}");
        }
    }
}

#[test]
fn every_message_has_words_in_both_languages_and_a_number_somewhere() {
    let messages = Messages;
    for key in messages.keys() {
        for language in [Language::English, Language::Chinese] {
            let text = messages.raw(key, language).unwrap_or_else(|| panic!("{key}"));
            for part in [&text.message, &text.cause, &text.remedy] {
                assert!(!part.trim().is_empty(), "{key}");
            }
            assert!(
                !text.cause.contains('{') && !text.remedy.contains('{'),
                "{key}: only messages take arguments"
            );
        }
        let has_number = control_names()
            .iter()
            .any(|name| messages.id(key, Control::load(name).expect("a control").alarm_ids).is_some());
        assert!(has_number, "{key} has no number on any control");
    }
}
