//! `turnwright completions` and `turnwright man`: files for the shell and the manual, made from the options.

use std::io::{self, Write};

use clap::CommandFactory;

use crate::arguments::{Arguments, Completions, Man};
use crate::fault::{Fault, Status};

/// Prints a completion script.
pub(crate) fn completions(options: &Completions) -> Result<Status, Fault> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "turnwright", &mut script);
    print(&script)
}

/// Prints a manual page.
pub(crate) fn man(options: &Man) -> Result<Status, Fault> {
    let mut command = Arguments::command();
    command.build();
    let named = options.command.as_ref().and_then(|name| command.find_subcommand(name)).cloned();
    let page = named.unwrap_or(command);
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    print(&text)
}

fn print(bytes: &[u8]) -> Result<Status, Fault> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()?;
    Ok(Status::Clean)
}
