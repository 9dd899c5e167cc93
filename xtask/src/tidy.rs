//! `cargo xtask tidy`: the rules of the house that a machine can check.
//!
//! In: the files of the workspace. Out: [`Fault`]s with place and cure. Layers are in `layers`; what clippy
//! can check is in `clippy.toml`.

use std::fmt;
use std::fs;
use std::path::Path;

use crate::layers::{self, CORE_LAYER_MAX, crate_of};
use crate::scan::Source;

/// No source file is longer.
const LINES_MAX: usize = 900;

/// Endings of files that people write as source.
const SOURCE_ENDINGS: &[&str] = &[".rs", ".js", ".mjs", ".cjs", ".ts", ".css", ".sh", ".py"];

/// A rule that a file breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    path: String,
    line: usize,
    what: String,
    cure: &'static str,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}; cure: {}", self.path, self.line, self.what, self.cure)
    }
}

impl Fault {
    pub(crate) fn new(file: &File, line: usize, what: impl Into<String>, cure: &'static str) -> Self {
        Self { path: file.path.clone(), line, what: what.into(), cure }
    }
}

/// A text file, its path from the root with `/`.
pub(crate) struct File {
    pub(crate) path: String,
    pub(crate) text: String,
}

/// All faults, in order of files.
pub fn faults(root: &Path) -> Vec<Fault> {
    let mut files = Vec::new();
    collect(root, "", &mut files);
    files.sort_by(|one, other| one.path.cmp(&other.path));
    let mut faults = Vec::new();
    layers::check(&files, &mut faults);
    for file in &files {
        check_text(file, &mut faults);
        if file.path.ends_with(".rs") {
            check_rust(file, &mut faults);
        }
    }
    faults
}

/// Reads every text file that git would keep: see `.gitignore`.
fn collect(folder: &Path, prefix: &str, files: &mut Vec<File>) {
    const LEFT_OUT: &[&str] = &[".git", "target", "node_modules", "out"];
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{prefix}{name}");
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && !LEFT_OUT.contains(&name.as_str()) => {
                collect(&entry.path(), &format!("{path}/"), files);
            }
            // What is not UTF-8 is no text: pictures, fonts, programs in other encodings.
            // In a work tree `.git` is a file.
            Ok(kind) if kind.is_file() && !LEFT_OUT.contains(&name.as_str()) => {
                files.extend(fs::read_to_string(entry.path()).ok().map(|text| File { path, text }));
            }
            _ => {}
        }
    }
}

/// Rules for every text file.
fn check_text(file: &File, faults: &mut Vec<Fault>) {
    let lines = file.text.lines().count();
    if lines > LINES_MAX && SOURCE_ENDINGS.iter().any(|ending| file.path.ends_with(ending)) {
        let what = format!("{lines} lines, more than {LINES_MAX}");
        faults.push(Fault::new(file, LINES_MAX + 1, what, "one file a feature: split it"));
    }
    for (index, line) in file.text.lines().enumerate() {
        if let Some(path) = machine_path(line) {
            let what = format!("`{path}` is a path of one machine");
            faults.push(Fault::new(file, index + 1, what, "use a path from the root of the workspace"));
        }
        if let Some(host) = package_host(&file.path, line) {
            let what = format!("`{host}` is a package host");
            let cure = "leave hosts to the user's own settings (npm: omit-lockfile-registry-resolved=true)";
            faults.push(Fault::new(file, index + 1, what, cure));
        }
    }
}

/// An absolute path that exists on one machine only.
fn machine_path(line: &str) -> Option<&'static str> {
    // Joined here, so that this file keeps its own rule.
    const FOLDERS: [&str; 3] = [concat!("/", "work"), concat!("/", "root"), concat!("/", "tmp")];
    FOLDERS.into_iter().find(|folder| {
        line.match_indices(folder).any(|(at, _)| {
            let before = line[..at].chars().next_back();
            let after = line[at + folder.len()..].chars().next();
            // Part of a longer path, of a variable's path, or of a longer word.
            let inside = |c: char| c.is_alphanumeric() || "._-/}>)*]%".contains(c);
            let longer = |c: char| c.is_alphanumeric() || "_-.".contains(c);
            !before.is_some_and(inside) && !after.is_some_and(longer)
        })
    })
}

/// The host that packages would be fetched from.
fn package_host<'a>(path: &str, line: &'a str) -> Option<&'a str> {
    let (before, rest) = line.split_once("://")?;
    let host = rest.split(['/', '"', '\'', ' ', ':', ')']).next().unwrap_or(rest);
    // Cargo itself writes the name of its index.
    if path.ends_with("Cargo.lock") {
        return (!rest.starts_with("github.com/rust-lang/crates.io-index")).then_some(host);
    }
    let lock = path.ends_with("package-lock.json") && before.contains("\"resolved\"");
    let settings = path.ends_with(".npmrc") || path.ends_with(".cargo/config.toml");
    let named = ["registry", "mirror", "artifactory", "nexus"].iter().any(|word| host.contains(word));
    (lock || settings || named).then_some(host)
}

/// Words that no code has, and why.
const BANNED: &[(&str, &str)] = &[
    ("todo!", "finish it, or raise an alarm that says it is not supported"),
    ("unimplemented!", "finish it, or raise an alarm that says it is not supported"),
    ("dbg!", "delete it"),
];

/// Words that no code of the core has outside tests, and why.
const BANNED_IN_CORE: &[(&str, &str)] = &[
    ("println!", "return the text, crates/cli prints it"),
    ("eprintln!", "return the text, crates/cli prints it"),
    ("print!", "return the text, crates/cli prints it"),
    ("eprint!", "return the text, crates/cli prints it"),
];

/// Words that have no place where numbers become cuts; a picture may count its pixels as it likes.
const BANNED_BEFORE_EXPORT: &[(&str, &str)] =
    &[("as f32", "f32 loses micrometres: use f64"), (": f32", "f32 loses micrometres: use f64")];

/// Words that only `units` has: elsewhere lengths become floats by a function with a name.
const BANNED_OUTSIDE_UNITS: &[(&str, &str)] = &[(".nm() as f64", "use Length::to_mm")];

/// Crates whose numbers have the same bits on every machine.
const SAME_BITS: &[&str] = &["units", "geometry", "canon", "motion"];

const OF_PLATFORM: &str = "its bits are those of the platform: use the crate libm";

/// Words that those have not: what `std` takes from the platform, rounds once where others round twice, or shuffles.
const BANNED_IN_SAME_BITS: &[(&str, &str)] = &[
    (".sin(", OF_PLATFORM),
    (".cos(", OF_PLATFORM),
    (".sin_cos(", OF_PLATFORM),
    (".tan(", OF_PLATFORM),
    (".asin(", OF_PLATFORM),
    (".acos(", OF_PLATFORM),
    (".atan(", OF_PLATFORM),
    (".atan2(", OF_PLATFORM),
    (".sinh(", OF_PLATFORM),
    (".cosh(", OF_PLATFORM),
    (".tanh(", OF_PLATFORM),
    (".exp(", OF_PLATFORM),
    (".exp_m1(", OF_PLATFORM),
    (".ln(", OF_PLATFORM),
    (".ln_1p(", OF_PLATFORM),
    (".log10(", OF_PLATFORM),
    (".log2(", OF_PLATFORM),
    (".powf(", OF_PLATFORM),
    (".powi(", "in which order it multiplies nobody says: multiply"),
    (".hypot(", OF_PLATFORM),
    (".cbrt(", OF_PLATFORM),
    (".mul_add(", "multiply and add, each rounded"),
    ("HashMap", "its order is another in each run: use a BTreeMap or a Vec"),
    ("HashSet", "its order is another in each run: use a BTreeSet or a Vec"),
];

/// Names of controls: they stand in `data/`.
const CONTROLS: &[&str] = &["fanuc", "gsk"];

/// Rules for Rust.
fn check_rust(file: &File, faults: &mut Vec<Fault>) {
    if !file.text.lines().find(|line| !line.trim().is_empty()).is_some_and(|line| line.starts_with("//!")) {
        let cure = "say in `//!` what goes in, what comes out and what is not here";
        faults.push(Fault::new(file, 1, "no module doc", cure));
    }
    let source = Source::new(&file.text);
    report(file, &source.bare, BANNED, faults);
    let Some(folder) = crate_of(&file.path) else { return };
    // Tests in files of their own, and build scripts, are outside `src` or named so.
    if !file.path.contains("/src/") || file.path.ends_with("/tests.rs") || file.path.contains("/tests/") {
        return;
    }
    let source = source.without_tests();
    if layers::layer(folder).is_some_and(|layer| layer <= CORE_LAYER_MAX) {
        report(file, &source.bare, BANNED_IN_CORE, faults);
    }
    if layers::layer(folder).is_some_and(|layer| layer < CORE_LAYER_MAX) {
        report(file, &source.bare, BANNED_BEFORE_EXPORT, faults);
    }
    if folder != "units" {
        report(file, &source.bare, BANNED_OUTSIDE_UNITS, faults);
    }
    if SAME_BITS.contains(&folder) {
        report(file, &source.bare, BANNED_IN_SAME_BITS, faults);
    }
    for (index, line) in source.code.lines().enumerate() {
        let lower = line.to_ascii_lowercase();
        let name = CONTROLS.iter().find(|name| lower.contains(*name));
        // A path into `data/` is how the tables come in.
        if let Some(name) = name.filter(|_| !lower.contains("data/")) {
            let cure = "name the behaviour as a policy; which control has it stands in data/";
            faults.push(Fault::new(file, index + 1, format!("`{name}` is the name of a control"), cure));
        }
    }
}

fn report(file: &File, text: &str, banned: &[(&str, &'static str)], faults: &mut Vec<Fault>) {
    for (index, line) in text.lines().enumerate() {
        for (word, cure) in banned {
            let whole = |at: usize| {
                let word_character = |c: char| c.is_alphanumeric() || c == '_';
                let open = word.starts_with(|c: char| !c.is_alphanumeric());
                open || !line[..at].chars().next_back().is_some_and(word_character)
            };
            if line.match_indices(word).any(|(at, _)| whole(at)) {
                faults.push(Fault::new(file, index + 1, format!("`{word}`"), cure));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rust(path: &str, text: &str) -> Vec<String> {
        let file = File { path: path.to_owned(), text: text.to_owned() };
        let mut faults = Vec::new();
        check_text(&file, &mut faults);
        check_rust(&file, &mut faults);
        faults.iter().map(|fault| format!("{}: {}", fault.line, fault.what)).collect()
    }

    #[test]
    fn control_names_are_for_data_comments_and_tests() {
        let text = "//! As Fanuc does.\n// gsk\nfn a() { let b = \"GSK\"; }\nconst C: &str = include_str!(\"../data/gsk.toml\");\n\
                    #[cfg(test)]\nmod tests {\n    const D: &str = \"fanuc\";\n}\n";
        assert_eq!(rust("crates/canon/src/a.rs", text), ["3: `gsk` is the name of a control"]);
        assert!(rust("crates/canon/tests/a.rs", text).is_empty());
    }

    #[test]
    fn printing_is_for_the_shells() {
        let text = "//! A.\nfn a() {\n    println!(\"b\");\n    eprint!(\"println!\");\n}\n";
        assert_eq!(rust("crates/canon/src/a.rs", text), ["3: `println!`", "4: `eprint!`"]);
        assert!(rust("crates/cli/src/a.rs", text).is_empty());
    }

    #[test]
    fn numbers_of_motion_have_the_same_bits_everywhere() {
        let text = "//! A.\nfn a(b: f64) -> f64 { libm::sin(b) + b.hypot(b).sqrt() + b.powi(2) }\n#[cfg(test)]\nmod tests {\n\
                    fn c() -> f64 { 1f64.sin() }\n}\n";
        assert_eq!(rust("crates/motion/src/a.rs", text), ["2: `.powi(`", "2: `.hypot(`"]);
        assert!(rust("crates/export/src/a.rs", text).is_empty());
    }

    #[test]
    fn unfinished_code_is_found_everywhere_but_not_in_strings() {
        let unfinished = ["todo", "dbg"].map(|word| format!("//! A.\nfn a() {{ {word}!() }}\n"));
        assert_eq!(rust("xtask/src/a.rs", &unfinished[0]), ["2: `todo!`"]);
        assert_eq!(rust("crates/cli/tests/a.rs", &unfinished[1]), ["2: `dbg!`"]);
        assert!(rust("xtask/src/a.rs", "//! A.\nconst B: &str = \"todo!\";\n").is_empty());
    }

    #[test]
    fn a_file_says_what_it_is_and_ends_in_time() {
        assert_eq!(rust("xtask/src/a.rs", "fn a() {}\n"), ["1: no module doc"]);
        let long = format!("//! A.\n{}", "//\n".repeat(LINES_MAX));
        assert_eq!(rust("xtask/src/a.rs", &long), ["901: 901 lines, more than 900"]);
    }

    #[test]
    fn paths_of_one_machine_are_found() {
        let path = |folder: &str, rest: &str| format!("{}{folder}{rest}", '/');
        assert!(machine_path(&format!("cd {}", path("work", "/main"))).is_some());
        assert!(machine_path(&format!("\"{}\"", path("tmp", ""))).is_some());
        assert!(machine_path(&format!("see example.com{}", path("work", "/"))).is_none());
        assert!(machine_path(&path("workpiece", "")).is_none());
        assert!(machine_path(&format!("$HOME{}", path("tmp", "/a"))).is_none());
    }

    #[test]
    fn package_hosts_stand_in_nobodys_file() {
        let address = format!("https://{}.example.org/a.tgz", "registry");
        assert!(package_host("a/README.md", &address).is_some());
        assert!(
            package_host("a/package-lock.json", "  \"resolved\": \"https://packages.example.org/a\"")
                .is_some()
        );
        assert!(package_host("a/package-lock.json", "  \"url\": \"https://example.org/funding\"").is_none());
        let index = "source = \"registry+https://github.com/rust-lang/crates.io-index\"";
        assert!(package_host("Cargo.lock", index).is_none());
        assert!(package_host("Cargo.lock", "source = \"git+https://example.org/a\"").is_some());
    }
}
