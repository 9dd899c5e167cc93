//! Makes constants of the tables and controls of `data/`, and lists the files of `data/machines`, so that adding a
//! control or a machine is adding a file and nothing else.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a build script reads files")]

mod controls;
mod tables;

use std::path::{Path, PathBuf};
use std::{env, fs};

use tables::{Entry, constant};

fn main() {
    let data = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../data");
    let mut machines = "pub(crate) const MACHINES: &[(&str, &str)] = &[\n".to_string();
    for file in files(&data.join("machines")) {
        let name = file.file_stem().expect("a file name").to_string_lossy().into_owned();
        println!("cargo::rerun-if-changed={}", file.display());
        let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        // Remarks are for people: nobody else is to read them at every start.
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        machines.push_str(&format!("    ({name:?}, {:?}),\n", lines.join("\n")));
    }
    machines.push_str("];\n");
    let questions = tables::read(&data.join("policies.toml"));
    let controls = controls::files(&files(&data.join("controls")));
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let write = |name: &str, source: String| {
        fs::write(Path::new(&out).join(name), source).expect("the build folder is writable");
    };
    write("machines.rs", machines);
    write("policies.rs", controls::policies(&questions));
    write("controls.rs", controls::controls(&questions, &controls));
    write("functions.rs", constant(&data.join("functions.toml"), "ENTRIES", "FunctionEntry", function));
    write("messages.rs", constant(&data.join("alarms.toml"), "ENTRIES", "Entry", message));
    write("parameters.rs", constant(&data.join("parameters.toml"), "TABLE", "Parameter", parameter));
}

/// The TOML files of a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("a directory entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    files
}

fn function(entry: &mut Entry) -> String {
    let mut codes = entry.inner("codes");
    let [a, b, c] = ["a", "b", "c"].map(|system| codes.optional_text(system));
    codes.end();
    let [en, zh] = ["en", "zh"].map(|language| {
        let mut texts = entry.inner(language);
        let source = format!("Texts {{ name: {}, text: {} }}", texts.text("name"), texts.text("text"));
        texts.end();
        source
    });
    format!(
        "FunctionEntry {{ codes: Codes {{ a: {a}, b: {b}, c: {c} }}, group: {}, only: {}, not_on: {}, \
         outside_scope: {}, only_with: {}, forms: {}, en: {en}, zh: {zh} }}",
        entry.text("group"),
        entry.optional_texts("only"),
        entry.texts("not-on"),
        entry.flag("outside-scope"),
        entry.optional_text("only-with"),
        entry.texts("forms"),
    )
}

fn message(entry: &mut Entry) -> String {
    let mut ids = entry.inner("ids");
    let [three, four, named, own] = ["three", "four", "named", "own"].map(|kind| ids.optional_text(kind));
    ids.end();
    let [en, zh] = ["en", "zh"].map(|language| {
        let mut texts = entry.inner(language);
        let [message, cause, remedy] = ["message", "cause", "remedy"].map(|part| texts.text(part));
        texts.end();
        format!("MessageText {{ message: Cow::Borrowed({message}), cause: Cow::Borrowed({cause}), remedy: Cow::Borrowed({remedy}) }}")
    });
    format!(
        "Entry {{ ids: Ids {{ three: {three}, four: {four}, named: {named}, own: {own} }}, raised_by: {}, en: {en}, zh: {zh} }}",
        entry.optional_variant("raised-by", "RaisedBy"),
    )
}

fn parameter(entry: &mut Entry) -> String {
    // How sure the source is: kept in the data for readers.
    let _ = entry.optional_text("certainty");
    let [en, zh] = ["en", "zh"].map(|language| {
        let mut texts = entry.inner(language);
        let source = format!("Texts {{ name: {}, effect: {} }}", texts.text("name"), texts.text("effect"));
        texts.end();
        source
    });
    format!(
        "Parameter {{ unit: {}, numbers: {}, default: {}, per_axis: {}, acts: {}, en: {en}, zh: {zh} }}",
        entry.text("unit"),
        entry.pairs("numbers"),
        entry.number("default"),
        entry.flag("per-axis"),
        entry.optional_variant("acts", "Acts"),
    )
}
