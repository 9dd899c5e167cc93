//! The example programs, which are the programs printed in the seed documents: every one runs without an alarm,
//! and its cycles make exactly the moves of the tables worked out by hand rules.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use support::{Conditions, Run, run};
use turnwright_canon::{Action, CycleLabel, Shape, Turn};
use turnwright_control::Setup;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

fn run_file(path: &Path) -> Run {
    let text = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let shown = String::from_utf8_lossy(&text).into_owned();
    let directive =
        shown.lines().find_map(|line| line.trim().strip_prefix("(CONTROL ")).expect("a directive");
    let mut conditions = Conditions::on(directive.trim_end_matches(')').trim());
    if let Ok(setup) = fs::read_to_string(path.with_extension("toml")) {
        let parsed = Setup::parse(&setup).unwrap_or_else(|fault| panic!("{fault:?}"));
        for (number, value) in parsed.parameter_words() {
            conditions = conditions.with(&number, &value);
        }
    }
    run(&text, &conditions)
}

fn files(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(example(folder))
        .expect("examples")
        .map(|entry| entry.expect("entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "nc"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_example_runs_to_its_end() {
    let mut count = 0;
    for folder in ["fanuc-0i-mate-tb", "gsk-980tdi", "gsk-988ta"] {
        for file in files(folder) {
            let run = run_file(&file);
            assert!(run.alarm.is_none(), "{}: {:?}", file.display(), run.alarm);
            assert_eq!(
                run.commands.last().map(|command| &command.action),
                Some(&Action::End),
                "{}",
                file.display()
            );
            count += 1;
        }
    }
    assert!(count >= 17, "only {count} examples");
}

/// Moves of one cycle: code, diameter and Z in ten-thousandths, as the worked tables print them.
fn moves(run: &Run, label: u16) -> Vec<(&'static str, i64, i64)> {
    let mut out = Vec::new();
    for command in &run.commands {
        let Some(cycle) = command.origin.cycle else { continue };
        if cycle.label != CycleLabel(label * 10) {
            continue;
        }
        let code = match &command.action {
            Action::Rapid { .. } => "G00",
            Action::Feed { shape: Shape::Line, .. } => "G01",
            Action::Feed { shape: Shape::Arc { turn: Turn::Clockwise, .. }, .. } => "G02",
            Action::Feed { .. } => "G03",
            Action::Thread { .. } => "G32",
            _ => continue,
        };
        let to = command.action.end_point().expect("a move");
        out.push((code, to.x.to_diameter().0.nm() / 100, to.z.nm() / 100));
    }
    out
}

/// A table in the notation of the worked examples, one move a line: `G01 42.3 0.6`.
fn table(text: &str) -> Vec<(&'static str, i64, i64)> {
    let fixed = |word: &str| (word.parse::<f64>().expect("a number") * 10_000.0).round() as i64;
    text.split(',')
        .map(|row| {
            let mut words = row.split_whitespace();
            let code = match words.next() {
                Some("G00") => "G00",
                Some("G01") => "G01",
                Some("G02") => "G02",
                other => panic!("{other:?}"),
            };
            (code, fixed(words.next().expect("X")), fixed(words.next().expect("Z")))
        })
        .collect()
}

#[test]
fn rough_turning_and_finishing_of_the_shaft() {
    let run = run_file(&example("fanuc-0i-mate-tb/O4008-rough-turning.nc"));
    let expected = table(
        "G00 46.3 0.6, G01 42.3 0.6, G01 42.3 -44.9, G01 43.3 -44.4, G00 43.3 0.6, G01 38.3 0.6, G01 38.3 -44.9, \
         G01 39.3 -44.4, G00 39.3 0.6, G01 34.3 0.6, G01 34.3 -44.728, G01 35.3 -44.228, G00 35.3 0.6, \
         G01 30.3 0.6, G01 30.3 -41.9, G01 31.3 -41.4, G00 31.3 0.6, G01 26.3 0.6, G01 26.3 -25.9, \
         G01 27.3 -25.4, G00 27.3 0.6, G01 22.3 0.6, G01 22.3 -21.9, G01 23.3 -21.4, G00 23.3 0.6, G01 18.3 0.6, \
         G01 18.3 -17.9, G01 19.3 -17.4, G00 19.3 0.6, G01 15.3 0.6, G01 15.3 0.1, G01 15.3 -14.9, \
         G01 30.3 -29.9, G01 30.3 -41.9, G02 36.3 -44.9, G01 46.3 -44.9, G00 46 0.5",
    );
    assert_eq!(moves(&run, 71), expected);
    let expected =
        table("G01 15 0.5, G01 15 0, G01 15 -15, G01 30 -30, G01 30 -42, G02 36 -45, G01 46 -45, G00 46 0.5");
    assert_eq!(moves(&run, 70), expected);
}

#[test]
fn rough_facing_and_finishing_of_the_disc() {
    let run = run_file(&example("fanuc-0i-mate-tb/O4009-rough-facing.nc"));
    let all = moves(&run, 72);
    assert_eq!(all.len(), 36);
    let expected = table("G00 61.1 0.8, G00 61.1 -1.2, G01 27.241 -1.2, G01 28.241 -0.7, G00 61.1 -0.7");
    assert_eq!(all[..5], expected);
    let expected = table(
        "G00 61.1 -14.7, G01 40.1 -14.7, G01 30.1 -9.7, G01 30.1 -4.7, G02 20.1 0.3, G01 20.1 0.8, G00 61 0.5",
    );
    assert_eq!(all[29..], expected);
    let expected = table("G00 61 -15, G01 40 -15, G01 30 -10, G01 30 -5, G02 20 0, G00 20 0.5, G00 61 0.5");
    assert_eq!(moves(&run, 70), expected);
}

#[test]
fn pattern_repeating_of_the_forging() {
    let run = run_file(&example("fanuc-0i-mate-tb/O4010-pattern-repeating.nc"));
    let expected = table(
        "G00 120.4 13.1, G00 60.4 4.1, G01 60.4 -6.9, G01 70.4 -11.9, G01 70.4 -21.9, G02 90.4 -31.9, \
         G01 100.4 -36.9, G00 120.4 13.1, G00 115.4 11.6, G00 55.4 2.6, G01 55.4 -8.4, G01 65.4 -13.4, \
         G01 65.4 -23.4, G02 85.4 -33.4, G01 95.4 -38.4, G00 115.4 11.6, G00 110.4 10.1, G00 50.4 1.1, \
         G01 50.4 -9.9, G01 60.4 -14.9, G01 60.4 -24.9, G02 80.4 -34.9, G01 90.4 -39.9, G00 110.4 10.1, \
         G00 110 10",
    );
    assert_eq!(moves(&run, 73), expected);
}

#[test]
fn recess_with_a_closed_figure() {
    let run = run_file(&example("fanuc-0i-mate-tb/example-4-11-recess.nc"));
    let expected = table(
        "G00 58.4 -10, G01 38.4 -10, G02 38.4 -30, G00 58.4 -10, G00 54.4 -10, G01 34.4 -10, G02 34.4 -30, \
         G00 54.4 -10, G00 50.4 -10, G01 30.4 -10, G02 30.4 -30, G00 50.4 -10, G00 50 -10",
    );
    assert_eq!(moves(&run, 73), expected);
    assert_eq!(moves(&run, 70), table("G01 30 -10, G02 30 -30, G00 50 -10"));
}

#[test]
fn facing_and_grooving_on_the_other_family() {
    let run = run_file(&example("gsk-988ta/O0005-rough-facing.nc"));
    let all = moves(&run, 72);
    assert_eq!(all.len(), 135);
    assert_eq!(all[..4], table("G00 176.2 10.1, G00 176.2 8.1, G01 40.2 8.1, G01 41.2 8.6"));
    assert_eq!(
        all[129..],
        table("G00 176.2 -54.9, G01 160.2 -54.9, G01 80.2 -34.9, G01 80.2 -19.9, G01 40.2 0.1, G00 176 10")
    );
    assert_eq!(
        moves(&run, 70),
        table("G00 176 -55, G01 160 -55, G01 80 -35, G01 80 -20, G01 40 0, G00 176 10")
    );
    let radius = moves(&run_file(&example("gsk-988ta/O0008-radial-groove.nc")), 75);
    assert_eq!(radius.len(), 187);
    assert_eq!(radius[..3], table("G01 113 -20, G00 114 -20, G01 101 -20"));
    let diameter = moves(&run_file(&example("gsk-980tdi/O0008-radial-groove.nc")), 75);
    assert_eq!(diameter.len(), 310);
    assert_eq!(diameter[..3], table("G01 119 -24, G00 120 -24, G01 113 -24"));
    assert_eq!(diameter[309..], table("G00 125 -24"));
}

#[test]
fn every_printed_mistake_is_named_where_it_stands() {
    let expected: [(&str, &[(&str, &str)]); 6] = [
        ("O4008-finishing-ends-too-early.nc", &[("finishing-range-differs", "Q100")]),
        (
            "O4009-finishing-names-itself.nc",
            &[("finishing-range-differs", "P60"), ("figure-code-illegal", "Q110")],
        ),
        ("O4010-count-with-point.nc", &[("count-with-point", "R3.")]),
        ("O4010-from-bar-point-in-q.nc", &[("point-not-allowed", "Q120.")]),
        ("O4010-from-bar-not-renumbered.nc", &[("figure-start-skipped", "P60")]),
        ("example-4-11-range-names-cycle.nc", &[("figure-code-illegal", "Q90")]),
    ];
    for (file, mistakes) in expected {
        let path = example("with-errors").join(file);
        let text = String::from_utf8(fs::read(&path).expect("example")).expect("ASCII");
        let run = run_file(&path);
        for (key, word) in mistakes {
            let found = run.warnings.iter().chain(&run.alarm).find(|diagnostic| diagnostic.key == *key);
            let place = found.unwrap_or_else(|| panic!("{file}: no {key}:\n{}", run.diagnostics())).place;
            let place = place.expect("a place");
            let line = text.lines().nth(place.line as usize - 1).expect("the line");
            let marked = &line[place.column as usize - 1..place.end_column as usize - 1];
            assert!(marked.starts_with(word), "{file}: {key} marks {marked}, not {word}");
        }
    }
}
