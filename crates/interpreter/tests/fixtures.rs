//! The manual as a test: every Markdown file in `fixtures/interpreter` is a chapter, every `nc` block in it a
//! program, and the block after it what comes out.
//!
//! A block opened with `nc` takes words: a control (`fanuc-0i-tf`), parameters (`3401#0=1`), `skip=1`,
//! `machine=turn-mill`. A block
//! `setup` before it is its setup file. The
//! following block is `listing` (commands), `single-block` (commands, with an empty line where single-block operation
//! stops), `diagnostics` (alarms and warnings), or several one after the other; a
//! program without a `diagnostics` block must have no alarm. `TURNWRIGHT_BLESS=1 cargo test -p
//! turnwright-interpreter --test fixtures` rewrites the expected blocks; read the difference as behaviour.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "tests read files")]

mod support;

use std::fs;
use std::path::Path;

use support::{Conditions, run};

#[test]
fn the_manual_is_true() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/interpreter");
    let bless = std::env::var_os("TURNWRIGHT_BLESS").is_some();
    let mut files: Vec<_> =
        fs::read_dir(&folder).expect("fixtures").map(|entry| entry.expect("entry").path()).collect();
    files.sort();
    let (mut failures, mut programs) = (Vec::new(), 0);
    for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "md")) {
        let text = fs::read_to_string(file).expect("readable");
        let (blessed, count) =
            check(&text, &file.file_name().unwrap_or_default().to_string_lossy(), &mut failures);
        programs += count;
        if bless && blessed != text {
            fs::write(file, blessed).expect("writable");
        }
    }
    assert!(programs > 0, "no fixtures found");
    assert!(
        bless || failures.is_empty(),
        "{} of {programs} fixtures differ:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

/// Checks one file; gives the file as it would be when blessed, and the number of programs.
fn check(text: &str, name: &str, failures: &mut Vec<String>) -> (String, usize) {
    let mut blessed = String::new();
    let mut programs = 0;
    let mut lines = text.lines().enumerate().peekable();
    let mut last: Option<(support::Run, usize, bool)> = None;
    let mut setup = String::new();
    let settle = |last: &mut Option<(support::Run, usize, bool)>, failures: &mut Vec<String>| {
        if let Some((run, line, saw_diagnostics)) = last.take()
            && !saw_diagnostics
            && let Some(alarm) = &run.alarm
        {
            failures.push(format!("{name}:{line}: alarm {} is not expected ({:?})", alarm.key, alarm.place));
        }
    };
    while let Some((number, line)) = lines.next() {
        blessed.push_str(line);
        blessed.push('\n');
        let Some(info) = line.strip_prefix("```").filter(|info| !info.is_empty()) else { continue };
        let mut body = String::new();
        let mut closing = "```";
        for (_, line) in lines.by_ref() {
            if line.starts_with("```") {
                closing = line;
                break;
            }
            body.push_str(line);
            body.push('\n');
        }
        let mut words = info.split_whitespace();
        match words.next() {
            Some("nc") => {
                settle(&mut last, failures);
                programs += 1;
                let conditions = Conditions { setup: std::mem::take(&mut setup), ..conditions(words) };
                let given = run(body.as_bytes(), &conditions);
                if !goes_the_long_way_too(&given, &body, conditions) {
                    failures.push(format!("{name}:{}: the short way of plain blocks differs", number + 1));
                }
                last = Some((given, number + 1, false));
                blessed.push_str(&body);
            }
            Some("setup") => {
                blessed.push_str(&body);
                setup = body;
            }
            Some(kind @ ("listing" | "diagnostics" | "single-block")) => {
                let (run, _, saw) =
                    last.as_mut().unwrap_or_else(|| panic!("{name}:{}: no program", number + 1));
                let actual = match kind {
                    "listing" => run.listing(),
                    "single-block" => run.single_blocks(),
                    _ => run.diagnostics(),
                };
                *saw |= kind == "diagnostics";
                if actual != body {
                    failures.push(format!("{name}:{}: expected\n{body}but got\n{actual}", number + 1));
                }
                blessed.push_str(&actual);
            }
            _ => blessed.push_str(&body),
        }
        blessed.push_str(closing);
        blessed.push('\n');
    }
    settle(&mut last, failures);
    (blessed, programs)
}

/// Whether a program does the same when no block may go the short way: where a G code calls a macro, every block
/// is looked at.
fn goes_the_long_way_too(given: &support::Run, program: &str, conditions: Conditions) -> bool {
    let calls_macros = conditions.parameters.iter().any(|(number, _)| number.starts_with("60"));
    if calls_macros || !conditions.control.starts_with("fanuc") {
        return true;
    }
    let long = run(program.as_bytes(), &conditions.with("6050", "9998"));
    long.listing() == given.listing() && long.diagnostics() == given.diagnostics()
}

fn conditions<'a>(words: impl Iterator<Item = &'a str>) -> Conditions {
    let mut conditions = Conditions::on("fanuc-0i-tf");
    for word in words {
        match word.split_once('=') {
            Some(("skip", switches)) => {
                conditions.skips = switches.split(',').filter_map(|switch| switch.parse().ok()).collect();
            }
            Some(("machine", name)) => conditions.machine = Some(name.to_string()),
            Some(("restarts", count)) => conditions.restarts = count.parse().expect("a number"),
            Some((number, value)) => conditions = conditions.with(number, value),
            None => conditions.control = word.to_string(),
        }
    }
    conditions
}
