//! `cargo xtask test`: every test there is, one line at the end.
//!
//! In: the workspace, `tests-browser/`, the environment. Out: the tests' own output as it comes, then
//! `N passed, N failed, N skipped`, and success only if nothing failed.

use std::fmt;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Sums of tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sums {
    /// Tests that held.
    pub passed: u64,
    /// Tests that did not.
    pub failed: u64,
    /// Tests that were not run.
    pub skipped: u64,
}

impl fmt::Display for Sums {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

impl std::ops::AddAssign for Sums {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

/// Runs everything.
pub fn run(root: &Path) -> ExitCode {
    let mut sums = rust_tests(root);
    sums += browser_tests(root);
    println!("\n{sums}");
    if sums.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn rust_tests(root: &Path) -> Sums {
    let arguments = std::env::var("TURNWRIGHT_TEST_ARGS").unwrap_or_else(|_| "--workspace".to_owned());
    if arguments == "none" {
        println!("== Rust tests left out: TURNWRIGHT_TEST_ARGS=none");
        return Sums::default();
    }
    println!("== cargo test {arguments}");
    let mut command = cargo(root);
    command.args(["test", "--no-fail-fast"]).args(arguments.split_whitespace());
    let mut sums = Sums::default();
    let ended_well = echo(&mut command, |line| {
        if let Some(more) = cargo_sums(line) {
            sums += more;
        }
    });
    // A test program that does not build or dies says no sums.
    if !ended_well && sums.failed == 0 {
        sums.failed = 1;
    }
    sums
}

fn browser_tests(root: &Path) -> Sums {
    let folder = root.join("tests-browser");
    let files = test_files(&folder);
    if files.is_empty() {
        println!("== no browser tests in tests-browser/");
        return Sums::default();
    }
    println!("== browser tests: {} files", files.len());
    let required = std::env::var("TURNWRIGHT_REQUIRE_BROWSER").is_ok_and(|value| value == "1");
    let count = files.len() as u64;
    let failed = Sums { failed: count, ..Sums::default() };
    let (node, chromium) = (on_path("node"), chromium());
    let (Some(node), Some(chromium)) = (&node, &chromium) else {
        let missing = if node.is_none() { "node" } else { "chromium" };
        println!(
            "{missing} is missing; cure: install it (Debian: apt-get install {missing}), then try again"
        );
        if required {
            println!("FAILED: {count} browser test files, because TURNWRIGHT_REQUIRE_BROWSER=1");
            return failed;
        }
        println!("SKIPPED: {count} browser test files");
        return Sums { skipped: count, ..Sums::default() };
    };
    if folder.join("package.json").exists() && !folder.join("node_modules").exists() {
        println!("== npm ci");
        if !echo(Command::new("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(&folder), |_| {}) {
            println!("FAILED: npm ci; cure: is package-lock.json up to date, is the npm registry in reach?");
            return failed;
        }
    }
    if !echo(cargo(root).args(["build", "--package", "turnwright"]), |_| {}) {
        println!("FAILED: the turnwright binary does not build");
        return failed;
    }
    let mut sums = Sums::default();
    // Files by name: what Node makes of a folder differs between its versions.
    let mut command = Command::new(node);
    command.args(["--test", "--test-reporter=spec"]).args(&files).current_dir(root);
    command.env("TURNWRIGHT_BIN", binary()).env("TURNWRIGHT_CHROMIUM", chromium);
    let ended_well = echo(&mut command, |line| node_sums(line, &mut sums));
    if !ended_well && sums.failed == 0 {
        sums.failed = 1;
    }
    sums
}

fn cargo(root: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root);
    command
}

/// The binary beside this one: both are built into the same folder.
fn binary() -> PathBuf {
    let here = std::env::current_exe().unwrap_or_default();
    here.with_file_name(format!("turnwright{}", std::env::consts::EXE_SUFFIX))
}

fn on_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())
}

fn chromium() -> Option<PathBuf> {
    let debian = PathBuf::from("/usr/bin/chromium");
    if debian.is_file() { Some(debian) } else { on_path("chromium") }
}

/// The test files of a folder and the folders in it, sorted.
fn test_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if path.is_dir() && name != "node_modules" {
            files.extend(test_files(&path));
        } else if [".test.js", ".test.mjs", ".test.cjs"].iter().any(|end| name.ends_with(end)) {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Runs a program, shows its output as it comes and hands on every line. True if it ended well.
fn echo(command: &mut Command, mut each: impl FnMut(&str)) -> bool {
    let mut child = match command.stdout(Stdio::piped()).spawn() {
        Ok(child) => child,
        Err(error) => {
            println!("{} does not start: {error}", command.get_program().display());
            return false;
        }
    };
    if let Some(output) = child.stdout.take() {
        let mut reader = BufReader::new(output);
        let mut line = Vec::new();
        while reader.read_until(b'\n', &mut line).is_ok_and(|bytes| bytes > 0) {
            // A closed terminal is no reason to stop the tests.
            let _ = std::io::stdout().write_all(&line);
            each(String::from_utf8_lossy(&line).trim_end());
            line.clear();
        }
    }
    child.wait().is_ok_and(|status| status.success())
}

/// The sums of a line such as `test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; …`.
fn cargo_sums(line: &str) -> Option<Sums> {
    let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    let mut sums = Sums::default();
    for count in counts.split("; ") {
        let mut words = count.split(' ');
        let (Some(number), Some(what)) = (words.next().and_then(|word| word.parse().ok()), words.next())
        else {
            continue;
        };
        match what {
            "passed" => sums.passed = number,
            "failed" => sums.failed = number,
            "ignored" => sums.skipped = number,
            _ => {}
        }
    }
    Some(sums)
}

/// Adds a line such as `ℹ pass 3` or `# pass 3`. The sums come last: the first of them starts afresh, so
/// that a test that prints such a line does no harm.
fn node_sums(line: &str, sums: &mut Sums) {
    let Some(line) = line.strip_prefix("ℹ ").or_else(|| line.strip_prefix("# ")) else { return };
    let Some((what, number)) = line.split_once(' ') else { return };
    let Ok(number) = number.parse::<u64>() else { return };
    match what {
        "tests" => *sums = Sums::default(),
        "pass" => sums.passed = number,
        "fail" | "cancelled" => sums.failed += number,
        "skipped" | "todo" => sums.skipped += number,
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_cargo() {
        let line = "test result: FAILED. 3 passed; 2 failed; 1 ignored; 0 measured; 7 filtered out; finished in 0.01s";
        assert_eq!(cargo_sums(line), Some(Sums { passed: 3, failed: 2, skipped: 1 }));
        assert_eq!(cargo_sums("test result is unclear"), None);
        assert_eq!(cargo_sums("test a::b ... ok"), None);
    }

    #[test]
    fn sums_of_node_with_either_reporter() {
        for mark in ["ℹ", "#"] {
            let mut sums = Sums { passed: 99, ..Sums::default() };
            for words in [
                "tests 9",
                "suites 2",
                "pass 4",
                "fail 1",
                "cancelled 2",
                "skipped 1",
                "todo 1",
                "duration_ms 12.5",
            ] {
                node_sums(&format!("{mark} {words}"), &mut sums);
            }
            assert_eq!(sums, Sums { passed: 4, failed: 3, skipped: 2 });
        }
    }

    #[test]
    fn the_last_line_is_plain() {
        assert_eq!(Sums { passed: 1, failed: 2, skipped: 3 }.to_string(), "1 passed, 2 failed, 3 skipped");
    }
}
