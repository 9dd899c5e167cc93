//! Lists the files of `data/controls` and `data/machines`, so that adding a control or a machine is adding a
//! file and nothing else.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a build script reads files")]

use std::path::Path;
use std::{env, fs};

fn main() {
    let data = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../data");
    let mut source = String::new();
    for (folder, constant) in [("controls", "CONTROLS"), ("machines", "MACHINES")] {
        let folder = data.join(folder);
        println!("cargo::rerun-if-changed={}", folder.display());
        let mut files: Vec<_> = fs::read_dir(&folder)
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
            .map(|entry| entry.expect("a directory entry").path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
            .collect();
        files.sort();
        source.push_str(&format!("pub(crate) const {constant}: &[(&str, &str)] = &[\n"));
        for file in files {
            let name = file.file_stem().expect("a file name").to_string_lossy().into_owned();
            let path = fs::canonicalize(&file).expect("an existing file");
            source.push_str(&format!("    ({name:?}, include_str!({:?})),\n", path.display().to_string()));
        }
        source.push_str("];\n");
    }
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("embedded.rs");
    fs::write(out, source).expect("the build folder is writable");
}
