//! Where results go: files that are whole or not there at all, the files of a part, and the forms of diagnostics for
//! programs.

pub(crate) mod file;
mod part;
pub(crate) mod sarif;

pub(crate) use file::WholeFile;
pub(crate) use part::PartFile;
