//! Where results go: files that are whole or not there at all, and the forms of diagnostics for programs.

pub(crate) mod file;
pub(crate) mod sarif;

pub(crate) use file::WholeFile;
