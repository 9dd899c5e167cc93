//! The table of faults in `docs/checks.md` is true: every number once, every name a diagnostic that something raises,
//! and every check of this crate in it or named as beyond it.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::collections::BTreeSet;
use std::path::Path;

use turnwright_control::Messages;

/// Checks that tell of faults beyond the catalogue.
const BEYOND: [&str; 1] = ["feed-mode-changed"];

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("readable")
}

/// What stands between backticks and looks like a name.
fn names(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2).filter(|name| !name.contains(' '))
}

#[test]
fn the_table_of_faults_is_true() {
    let page = read("../../docs/checks.md");
    let rows: Vec<Vec<&str>> = page
        .lines()
        .filter(|line| line.starts_with("| V"))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let numbers: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    let expected: Vec<String> = (1..=66).map(|number| format!("V{number:02}")).collect();
    assert_eq!(numbers, expected);
    let messages = Messages;
    let mut told = BTreeSet::new();
    for row in &rows {
        let [number, _, by, remark] = row[..] else { panic!("{row:?} has not four columns") };
        assert_eq!(by.is_empty(), ["live", "guess:"].iter().any(|why| remark.starts_with(why)), "{number}");
        for name in names(by) {
            assert!(messages.keys().any(|key| key == name), "{number}: there is no {name}");
            let is_raised = messages.raised_by(name).is_none_or(|why| why.is_raised());
            assert!(is_raised, "{number}: nothing raises {name}");
            told.insert(name);
        }
    }
    for chapter in ["checks", "text"] {
        let fixtures = read(&format!("../../fixtures/verify/{chapter}.md"));
        let shown = fixtures.lines().filter_map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            (words.len() == 3 && words[1].starts_with('T') && words[0].parse::<u32>().is_ok())
                .then(|| words[2].to_string())
        });
        for name in shown {
            let is_told = page.contains(&format!("`{name}`")) || BEYOND.contains(&name.as_str());
            assert!(is_told, "{name} is not in docs/checks.md");
        }
    }
    assert!(told.len() > 80);
}
