//! The chores of this repository.
//!
//! [`green`] is the one green command, [`tidy`] the rules of the house, [`guard`] counts instructions. No dependencies, so that it builds at
//! once on a fresh machine.

pub mod green;
pub mod guard;
mod layers;
mod scan;
pub mod tidy;

use std::path::{Path, PathBuf};

/// The folder of the workspace.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
