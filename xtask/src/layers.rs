//! Which crate may know which: the table of the house, checked against the `Cargo.toml` files.

use std::collections::BTreeMap;

use crate::tidy::{Fault, File};

/// Every crate and its layer. A crate depends on lower layers only.
const LAYERS: &[(&str, u8)] = &[
    ("units", 0),
    ("diagnostics", 0),
    ("geometry", 1),
    ("syntax", 1),
    ("control", 2),
    ("canon", 2),
    ("cycles", 3),
    ("interpreter", 4),
    ("motion", 5),
    ("stock", 5),
    ("verify", 6),
    ("export", 6),
    ("cli", 7),
    ("lsp", 7),
    ("panel", 7),
    ("store", 7),
    ("machine-io", 7),
    ("wasm", 7),
    ("python", 7),
];

/// Allowed inside one layer: who, whom.
const WITHIN: &[(&str, &str)] = &[("diagnostics", "units")];

/// Crates that know these and no others.
const ONLY: &[(&str, &[&str])] = &[("syntax", &["diagnostics", "units"])];

/// Crates of the core do no I/O: see `clippy.toml`.
pub(crate) const CORE_LAYER_MAX: u8 = 6;

/// The layer of a crate's folder.
pub(crate) fn layer(folder: &str) -> Option<u8> {
    LAYERS.iter().find(|(name, _)| *name == folder).map(|(_, layer)| *layer)
}

/// The folder `crates/<this>/…` that a file lies in.
pub(crate) fn crate_of(path: &str) -> Option<&str> {
    path.strip_prefix("crates/")?.split('/').next()
}

pub(crate) fn check(files: &[File], faults: &mut Vec<Fault>) {
    let manifests = || {
        let of_crates = files.iter().filter(|file| file.path.ends_with("/Cargo.toml"));
        of_crates.filter_map(|file| Some((crate_of(&file.path)?, file)))
    };
    let package = |text: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix("name = \""))?;
        Some(line.trim_end_matches('"').to_owned())
    };
    let folders: BTreeMap<String, &str> =
        manifests().filter_map(|(folder, file)| Some((package(&file.text)?, folder))).collect();
    for (folder, file) in manifests() {
        let Some(own) = layer(folder) else {
            let cure = "give it a layer in xtask/src/layers.rs";
            faults.push(Fault::new(file, 1, format!("crate `{folder}` has no layer"), cure));
            continue;
        };
        for (line, name) in dependencies(&file.text) {
            let Some(other) = folders.get(name).copied() else { continue };
            let allowed = match ONLY.iter().find(|(name, _)| *name == folder) {
                Some((_, only)) => only.contains(&other),
                None => layer(other).is_some_and(|layer| layer < own) || WITHIN.contains(&(folder, other)),
            };
            if !allowed {
                let what = format!("`{folder}` (layer {own}) must not know `{other}`");
                faults.push(Fault::new(file, line, what, "move the shared part to a lower layer"));
            }
        }
    }
}

/// Line and name of what a manifest builds with. What only its tests use is free.
fn dependencies(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut counts = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let line = line.trim();
        if let Some(section) = line.strip_prefix('[') {
            let section = section.trim_end_matches(']');
            // `[dependencies.name]` is a dependency of its own.
            let inner = section.rsplit_once("dependencies.").filter(|(before, _)| !before.ends_with("dev-"));
            counts = section.ends_with("dependencies") && !section.ends_with("dev-dependencies");
            return inner.map(|(_, name)| (index + 1, name));
        }
        let name = line.split(['.', ' ', '=']).next()?;
        (counts && !name.is_empty() && !name.starts_with('#')).then_some((index + 1, name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(folder: &str, text: &str) -> File {
        let path = format!("crates/{folder}/Cargo.toml");
        File { path, text: format!("[package]\nname = \"turnwright-{folder}\"\n{text}") }
    }

    fn faults(text: &str) -> Vec<String> {
        let files = [
            manifest("units", ""),
            manifest("canon", ""),
            manifest("control", ""),
            manifest("motion", ""),
            manifest("stock", text),
        ];
        let mut faults = Vec::new();
        check(&files, &mut faults);
        faults.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn lower_layers_are_free_others_are_not() {
        assert!(faults("[dependencies]\nturnwright-canon.workspace = true\nserde = \"1\"\n").is_empty());
        assert!(faults("[dev-dependencies]\nturnwright-motion.workspace = true\n").is_empty());
        let sideways = faults("[dependencies]\nturnwright-motion = { path = \"../motion\" }\n");
        assert_eq!(sideways.len(), 1);
        assert!(
            sideways[0].starts_with("crates/stock/Cargo.toml:4: `stock` (layer 5) must not know `motion`")
        );
        assert_eq!(faults("[dependencies.turnwright-motion]\nworkspace = true\n").len(), 1);
    }
}
