//! The part of a program: a second run of it, on the stock that the first one showed.

use turnwright_control::Setup;
use turnwright_export::part::PartShape;
use turnwright_stock::machining::RapidRates;
use turnwright_verify::part::{Part, PartRun};

use crate::arguments::Machine;
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::session::Session;

/// Cuts the program out of its stock. `setup` is the whole setup, with what the first run showed; nothing comes back
/// when there is no stock, for the program cuts nothing.
pub(crate) fn machined(
    text: &ProgramText,
    session: &Session,
    options: &Machine,
    setup: &Setup,
) -> Option<Part> {
    setup.stock.as_ref()?;
    // What the program prints was written by the first run.
    let options = Machine { program_output: None, ..options.clone() };
    let machine = session.setup.machine().ok()?.limited_by(&session.control.parameters);
    let rates =
        RapidRates { x_mm_per_min: machine.rapid_x_mm_per_min, z_mm_per_min: machine.rapid_z_mm_per_min };
    let mut execution = Execution::new(text, session, &options).ok()?;
    let start = execution.interpreter().position();
    let mut run = PartRun::new(setup, &session.setup, start, rates).ok()??;
    while let Some(command) = execution.next_command() {
        run.add(&command);
        if run.is_full() {
            break;
        }
    }
    Some(run.finish())
}

/// How a part is drawn; nothing when nothing is left of it.
pub(crate) fn drawn(part: Part) -> Option<(Part, PartShape)> {
    let shape = PartShape::new(&part.section, &part.threads)?;
    Some((part, shape))
}
