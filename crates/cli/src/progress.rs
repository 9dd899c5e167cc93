//! A bar on the terminal while a program runs.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use turnwright_interpreter::Interpreter;

use crate::arguments::Colour;
use crate::environment::ProgramText;
use crate::render::Printer;

/// Shorter runs show no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Commands between two looks at the time.
const COMMANDS_PER_LOOK: u32 = 16 * 1024;

/// A bar on the terminal, for runs that take long.
pub(crate) struct Progress {
    started: Instant,
    commands: u32,
    bytes: u64,
    is_wanted: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Nothing is shown yet.
    pub(crate) fn new(text: &ProgramText, printer: &Printer) -> Self {
        let is_wanted = std::io::stderr().is_terminal() && printer.colour() != Colour::Never;
        Self { started: Instant::now(), commands: 0, bytes: text.len(), is_wanted, bar: None }
    }

    /// How far the program has come.
    #[inline]
    pub(crate) fn look(&mut self, interpreter: &Interpreter) {
        self.commands += 1;
        if self.commands == COMMANDS_PER_LOOK {
            self.commands = 0;
            self.show(interpreter);
        }
    }

    fn show(&mut self, interpreter: &Interpreter) {
        if !self.is_wanted || self.started.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {elapsed}");
            ProgressBar::new(self.bytes).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        bar.set_position(interpreter.offset());
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
