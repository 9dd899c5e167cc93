//! `turnwright`: the command line.
//!
//! In: program texts, setup files, options, the environment. Out: diagnostics, reports, traces and pictures,
//! and an exit status: 0 nothing found, 1 an alarm or an error, 2 usage or a file that cannot be read or
//! written. This is the only crate that reads, prints and writes; what a library user would want is not here.
//!
//! One file a command in `commands/`. Sentences of the user interface are in `data/texts.toml`.

mod arguments;
mod commands;
mod environment;
mod execution;
mod fault;
mod finding;
mod operator;
mod output;
mod part;
mod passes;
mod progress;
mod rates;
mod render;
mod report;
mod session;
mod speech;
mod switches;
mod table;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use crate::arguments::Arguments;

fn main() -> ExitCode {
    match arguments() {
        Ok(arguments) => fault::guarded(arguments).into(),
        Err(error) => {
            // A help text that nobody reads to its end is no fault.
            let _ = error.print();
            ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
        }
    }
}

/// What was asked for.
fn arguments() -> Result<Arguments, clap::Error> {
    let words: Vec<_> = std::env::args_os().collect();
    // Describing every command takes as long as checking a short program does.
    if let Some(arguments) = Arguments::of_one_command(&words) {
        return Ok(arguments);
    }
    let mut command = Arguments::command();
    let mut matches = command.try_get_matches_from_mut(words)?;
    let arguments = Arguments::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command));
    // Taking the description of every command apart would take a good part of a short run.
    std::mem::forget(command);
    arguments
}
