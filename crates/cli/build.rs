//! Makes a constant of `data/texts.toml`, and says how the program is linked.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a build script reads files")]

#[path = "../control/build/tables.rs"]
#[allow(dead_code, reason = "its other users need more")]
mod tables;

use std::path::Path;
use std::{env, fs};

fn main() {
    let file =
        Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../data/texts.toml");
    let source = tables::constant(&file, "TEXTS", "[&str; 2]", |entry| {
        format!("[{}, {}]", entry.text("en"), entry.text("zh"))
    });
    let target =
        ["CARGO_CFG_TARGET_OS", "CARGO_CFG_TARGET_ENV"].map(|name| env::var(name).unwrap_or_default());
    if target == ["linux", "gnu"] {
        // Tables with addresses that are known at build time need no work when the program starts.
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("texts.rs");
    fs::write(out, source).expect("the build folder is writable");
}
