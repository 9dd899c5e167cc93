//! A folder of its own for each test, and the built program.
#![allow(dead_code, reason = "each test file uses its part")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A program that runs to its end with one warning: G28 to an assumed reference point is a note, X100 without
/// a point is the warning.
pub const WARNS: &str =
    "O0001\nT0101\nG97 S500 M03\nG00 X50. Z2.\nG01 X100 F0.2\nG01 Z-10.\nG00 Z5.\nX60.\nM30\n";

/// A program without anything to say about.
pub const CLEAN: &str = "O0001\nT0101\nG97 S500 M03\nG00 X50. Z2.\nG01 Z-10. F0.2\nG00 X60. Z5.\nM30\n";

/// The depth of cut of the cycle in line 6 is zero.
pub const ALARMS: &str = "O0001\nT0101\nG97 S500 M03\nG00 X50. Z2.\nG01 Z1. F0.3\n  G71 U0. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.3\nN10 G00 X20.\nG01 Z-10.\nN20 X50.\nM30\n";

static NEXT: AtomicU32 = AtomicU32::new(0);

/// A folder that goes away with its owner.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("turnwright-test-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file and gives its path.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a parent")).expect("folders");
        fs::write(&path, content).expect("a file");
        path.display().to_string()
    }

    /// Names of everything in it, hidden files too.
    pub fn names(&self) -> Vec<String> {
        names(&self.0)
    }
}

pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What a run gave.
#[derive(Debug)]
pub struct Ran {
    pub status: i32,
    pub out: String,
    pub err: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            status: output.status.code().unwrap_or(-1),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// The program with a known environment.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_turnwright"));
    command.args(arguments).env_clear().env("LANG", "C");
    command
}

/// Runs it.
pub fn turnwright(arguments: &[&str]) -> Ran {
    command(arguments).stdin(Stdio::null()).output().expect("the program starts").into()
}

/// Runs it with a text on standard input.
pub fn turnwright_with_input(arguments: &[&str], input: &[u8]) -> Ran {
    let mut child = command(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    child.stdin.take().expect("a pipe").write_all(input).expect("input is taken");
    child.wait_with_output().expect("it ends").into()
}

/// The objects of JSON lines.
pub fn json_lines(text: &str) -> Vec<serde_json::Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("no JSON: {line}")))
        .collect()
}
