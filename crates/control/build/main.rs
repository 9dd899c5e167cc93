//! Makes constants of the tables and controls of `data/`, and lists the files of `data/machines`, so that adding a
//! control or a machine is adding a file and nothing else.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a build script reads files")]

#[path = "../src/codes.rs"]
mod codes;
mod controls;
#[path = "../src/names.rs"]
#[allow(dead_code, reason = "nothing is looked up while building")]
mod names;
mod tables;

use std::path::{Path, PathBuf};
use std::{env, fs};

use tables::{Entry, constant};

fn main() {
    let data = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../data");
    let mut machines = "pub(crate) const MACHINES: &[(&str, &[(&str, Given)])] = &[\n".to_string();
    for file in files(&data.join("machines")) {
        let name = file.file_stem().expect("a file name").to_string_lossy().into_owned();
        machines.push_str(&format!("    ({name:?}, {}),\n", tables::given_pairs(&tables::read(&file))));
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
    let functions = data.join("functions.toml");
    let slots = name_slots(&functions, "ENTRIES");
    write("functions.rs", constant(&functions, "ENTRIES", "FunctionEntry", function) + &slots);
    write("messages.rs", constant(&data.join("alarms.toml"), "ENTRIES", "Entry", message));
    let parameters = data.join("parameters.toml");
    let slots = name_slots(&parameters, "TABLE");
    write("parameters.rs", constant(&parameters, "TABLE", "Parameter", parameter) + &slots);
}

/// The source of `NAME_SLOTS`, by which the names of a file's constant are found: a power of two of slots, at most half
/// of them taken, so that looking ends soon.
fn name_slots(file: &Path, name: &str) -> String {
    let table = tables::read(file);
    let mut sorted: Vec<&str> = table.keys().map(String::as_str).collect();
    sorted.sort_unstable();
    let mut slots = vec![names::EMPTY; (sorted.len() * 2).next_power_of_two()];
    for (place, entry) in (0..names::EMPTY).zip(sorted) {
        let mut slot = names::hash(entry);
        while slots[slot & (slots.len() - 1)] != names::EMPTY {
            slot += 1;
        }
        let slot = slot & (slots.len() - 1);
        slots[slot] = place;
    }
    format!("pub(crate) const {name}_SLOTS: &[u16] = &{slots:?};\n")
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
    let numbers = ["a", "b", "c"].map(|system| codes.peek(system).map_or(Vec::new(), code_numbers));
    let texts = ["a", "b", "c"].map(|system| codes.optional_text(system)).join(", ");
    codes.end();
    let numbers = format!("[&{:?}, &{:?}, &{:?}]", numbers[0], numbers[1], numbers[2]);
    let [en, zh] = ["en", "zh"].map(|language| {
        let mut texts = entry.inner(language);
        let source = format!("Texts {{ name: {}, text: {} }}", texts.text("name"), texts.text("text"));
        texts.end();
        source
    });
    format!(
        "FunctionEntry {{ codes: Codes {{ texts: [{texts}], numbers: {numbers} }}, group: {}, only: {}, not_on: {}, \
         outside_scope: {}, only_with: {}, forms: {}, en: {en}, zh: {zh} }}",
        entry.decimal("group"),
        entry.optional_texts("only"),
        entry.texts("not-on"),
        entry.flag("outside-scope"),
        entry.optional_text("only-with"),
        entry.texts("forms"),
    )
}

/// The numbers of codes such as `G32/G33`.
fn code_numbers(text: &str) -> Vec<u16> {
    let number = |code| codes::parse_code(code).unwrap_or_else(|| panic!("{code} is no code"));
    text.split('/').map(number).collect()
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
