//! How a command ends: its exit status, and what kept it from doing its work.

use std::any::Any;
use std::cell::RefCell;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use turnwright_diagnostics::Diagnostic;

use crate::arguments::Arguments;
use crate::commands;
use crate::finding::Finding;
use crate::render::Printer;
use crate::speech::Speech;

/// The exit status, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    /// No alarm and no error.
    Clean,
    /// An alarm or an error was found.
    Found,
    /// Wrong usage, or a file that cannot be read or written.
    Failed,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(match status {
            Status::Clean => 0,
            Status::Found => 1,
            Status::Failed => 2,
        })
    }
}

/// Why a command stopped before its end.
#[derive(Debug)]
pub(crate) enum Fault {
    /// Standard output took no more.
    Output(io::Error),
    /// The question makes no sense; why, in the user's language.
    Usage(String),
    /// Something that is said as a diagnostic.
    Refused(Box<Finding>),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl From<Finding> for Fault {
    fn from(finding: Finding) -> Self {
        Self::Refused(Box::new(finding))
    }
}

thread_local! {
    /// What the last panic of this thread said, and where.
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs the command; says what stopped it, if anything did.
pub(crate) fn guarded(arguments: Arguments) -> Status {
    std::panic::set_hook(Box::new(|panic| {
        LAST_PANIC.with_borrow_mut(|said| *said = panic.to_string().replace('\n', " "));
    }));
    let printer = Printer::new(&arguments);
    let result = caught(|| commands::run(&arguments, &printer));
    match result {
        Ok(Ok(status)) => status,
        Ok(Err(Fault::Output(error))) if error.kind() == io::ErrorKind::BrokenPipe => Status::Clean,
        Ok(Err(Fault::Output(error))) => {
            printer.finding(&unwritable("-", &error, printer.speech), None);
            Status::Failed
        }
        Ok(Err(Fault::Usage(why))) => {
            printer.say(&format!("{}: {why}\n", printer.speech.get("severity-error")));
            Status::Failed
        }
        Ok(Err(Fault::Refused(finding))) => {
            // The reader of the output may be gone; the status says enough.
            let _ = printer.refuse(&finding, commands::format(&arguments));
            finding.status()
        }
        Err(finding) => {
            printer.finding(&finding, None);
            Status::Found
        }
    }
}

/// Runs something that must not panic; a panic becomes a finding that can be reported.
pub(crate) fn caught<T>(action: impl FnOnce() -> T) -> Result<T, Finding> {
    catch_unwind(AssertUnwindSafe(action)).map_err(|_: Box<dyn Any + Send>| {
        let said = LAST_PANIC.with_borrow(String::clone);
        Finding::new("", Diagnostic::error("internal-error").with("value", said))
    })
}

/// A file or stream that cannot be written.
pub(crate) fn unwritable(name: &str, error: &io::Error, speech: Speech) -> Finding {
    let value = speech.system(error);
    let diagnostic = Diagnostic::error("output-unwritable").with("name", name).with("value", value);
    Finding::new("", diagnostic).failed()
}
