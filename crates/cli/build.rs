//! Makes a constant of `data/texts.toml`, and says how the program is linked.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "a build script reads files")]

#[path = "../control/build/tables.rs"]
#[allow(dead_code, reason = "its other users need more")]
mod tables;

use std::path::Path;
use std::process::Command;
use std::{env, fs};

fn main() {
    let file =
        Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../data/texts.toml");
    let source = tables::constant(&file, "TEXTS", "[&str; 2]", |entry| {
        format!("[{}, {}]", entry.text("en"), entry.text("zh"))
    });
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let out = Path::new(&out);
    let [os, libc, arch] =
        ["OS", "ENV", "ARCH"].map(|what| env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default());
    if os == "linux" && libc == "gnu" {
        // Tables with addresses that are known at build time need no work when the program starts.
        println!("cargo::rustc-link-arg-bins=-no-pie");
        if arch == "x86_64" && has_static_unwinder() {
            // Rust asks for the shared unwinder by name, whatever the linker is told: this name leads to the static
            // one. A start has one library less to find, map and relocate. Other architectures were not tried.
            fs::write(out.join("libgcc_s.so"), "INPUT(-lgcc_eh -lgcc)\n")
                .expect("the build folder is writable");
            println!("cargo::rustc-link-arg-bins=-L{}", out.display());
        }
    }
    fs::write(out.join("texts.rs"), source).expect("the build folder is writable");
}

/// Whether the linker's compiler has the unwinder as an archive: gcc has, others may not.
fn has_static_unwinder() -> bool {
    let linker = env::var("RUSTC_LINKER").ok();
    if linker.is_none() && env::var("HOST") != env::var("TARGET") {
        return false;
    }
    let mut asked = Command::new(linker.as_deref().unwrap_or("cc"));
    let Ok(answer) = asked.arg("-print-file-name=libgcc_eh.a").output() else { return false };
    // What it does not have it answers with the bare name.
    let path = String::from_utf8_lossy(&answer.stdout);
    let path = Path::new(path.trim());
    answer.status.success() && path.is_absolute() && path.is_file()
}
