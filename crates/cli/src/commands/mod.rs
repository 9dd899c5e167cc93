//! The commands, one file each.

mod check;
mod controls;
mod data;
mod diff;
mod explain;
mod generate;
mod measure;
mod motion;
mod part;
mod passes;
mod plot;
mod run;
mod setup;
mod target;
mod time;
mod trace;

use crate::arguments::{Arguments, Command, Format, LookupFormat};
use crate::fault::{Fault, Status};
use crate::render::Printer;

/// Runs the command that was asked for.
pub(crate) fn run(arguments: &Arguments, printer: &Printer) -> Result<Status, Fault> {
    match &arguments.command {
        Command::Run(options) => run::run(options, printer),
        Command::Check(options) => check::run(options, printer),
        Command::Trace(options) => trace::run(options, printer),
        Command::Plot(options) => plot::run(options, printer),
        Command::Part(options) => part::run(options, printer),
        Command::Motion(options) => motion::run(options, printer),
        Command::Time(options) => time::run(options, printer),
        Command::Measure(options) => measure::run(options, printer),
        Command::Diff(options) => diff::run(options, printer),
        Command::Explain(options) => explain::run(options, printer),
        Command::Controls(options) => controls::run(options, printer),
        Command::Data(options) => data::run(options, printer),
        Command::Setup(options) => setup::run(options, printer),
        Command::Completions(options) => generate::completions(options),
        Command::Man(options) => generate::man(options),
    }
}

/// The form in which a command says why it cannot do its work. A trace stays a trace.
pub(crate) fn format(arguments: &Arguments) -> Format {
    let lookup = |format| if format == LookupFormat::Json { Format::Json } else { Format::Human };
    match &arguments.command {
        Command::Run(options) => options.format,
        Command::Check(options) => options.format,
        Command::Plot(options) => options.format,
        Command::Part(options) => options.format,
        Command::Setup(options) => options.format,
        Command::Measure(options) => lookup(options.format),
        Command::Diff(options) => lookup(options.format),
        Command::Explain(options) => lookup(options.format),
        Command::Time(options) => lookup(options.format),
        Command::Controls(options) => lookup(options.format),
        Command::Data(options) => lookup(options.format),
        Command::Trace(_) | Command::Motion(_) | Command::Completions(_) | Command::Man(_) => Format::Human,
    }
}
