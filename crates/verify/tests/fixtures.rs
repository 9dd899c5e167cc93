//! The manual of the checks as a test: every Markdown file in `fixtures/verify` is a chapter, every `nc` block in it a
//! program, with a `setup` block before it where it needs one, and a block `diagnostics` behind it with what the checks
//! tell: line, number, name. `(SETUP …)` comments of the program count.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "tests read files")]

mod support;

use std::collections::BTreeSet;
use std::path::Path;

use support::run;
use turnwright_control::policy::AlarmIds;
use turnwright_control::{Messages, Setup, setup_comment};
use turnwright_verify::Checks;

/// The programs of a chapter: line, setup, program, what is told.
fn programs(text: &str) -> Vec<(usize, String, String, String)> {
    let mut programs = Vec::new();
    let (mut setup, mut program) = (String::new(), (0, String::new()));
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let Some(kind) = line.strip_prefix("```").filter(|kind| !kind.is_empty()) else { continue };
        let body = lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```");
        let body: String = body.map(|line| format!("{line}\n")).collect();
        match kind {
            "setup" => setup = body,
            "nc" => program = (number + 1, body),
            "diagnostics" => {
                let (line, program) = std::mem::take(&mut program);
                programs.push((line, std::mem::take(&mut setup), program, body));
            }
            other => panic!("line {}: a block of {other}", number + 1),
        }
    }
    programs
}

fn told(setup: &str, program: &str) -> String {
    let comments = program.lines().filter_map(|line| line.strip_prefix('(')?.strip_suffix(')'));
    let comments = comments.filter_map(setup_comment).map(|piece| piece.expect("a setup comment")).collect();
    let setup = Setup::with_comments(setup, comments).unwrap_or_else(|fault| panic!("{fault:?}"));
    let run = run(program, "fanuc-0i-tf", &setup);
    let mut checks = Checks::new(run.start);
    run.commands.iter().for_each(|command| checks.add(command));
    let mut findings = run.text;
    findings.extend(checks.finish(&setup).findings);
    findings.retain(|finding| !setup.checks.allow.iter().any(|name| name == finding.key));
    findings.sort_by_key(|finding| (finding.place.map_or(0, |place| place.line), finding.key));
    let line = |finding: &turnwright_diagnostics::Diagnostic| {
        let id = Messages.id(finding.key, AlarmIds::Four).unwrap_or("no number");
        format!("{} {id} {}\n", finding.place.map_or(0, |place| place.line), finding.key)
    };
    findings.iter().map(line).collect()
}

#[test]
fn every_check_tells_what_it_should_and_nothing_else() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/verify");
    let (mut failures, mut keys, mut count) = (Vec::new(), BTreeSet::new(), 0);
    for file in std::fs::read_dir(folder).expect("fixtures").map(|entry| entry.expect("an entry").path()) {
        let text = std::fs::read_to_string(&file).expect("readable");
        for (line, setup, program, expected) in programs(&text) {
            let actual = told(&setup, &program);
            keys.extend(actual.lines().filter_map(|line| Some(line.split(' ').nth(2)?.to_string())));
            if actual != expected {
                failures.push(format!("{}:{line}: expected\n{expected}but got\n{actual}", file.display()));
            }
            count += 1;
        }
    }
    assert!(failures.is_empty(), "{} of {count} fixtures differ:\n{}", failures.len(), failures.join("\n"));
    // Every check is a file, and every file is shown.
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let count = |folder: &str| std::fs::read_dir(source.join(folder)).expect("checks").count() - 1;
    let files = count("checks") + count("text");
    assert!(keys.len() >= files, "{files} checks, but only {keys:?} are shown");
}
