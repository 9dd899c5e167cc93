//! `turnwright motion`: where the axes are, tick by tick.
//!
//! In: one program and a rate. Out: a table (CSV) with a line a tick, written as the plan becomes final: its length
//! needs no memory. The program runs as with nobody at the panel.

use std::io::{self, Write};

use turnwright_canon::{Action, Interpolation};
use turnwright_motion::{Player, Sample};
use turnwright_units::write_fixed;

use super::trace::BUFFER_BYTES;
use crate::arguments::Motion;
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::output::WholeFile;
use crate::rates::rates;
use crate::render::Printer;
use crate::session::Session;

/// Writes the samples.
pub(crate) fn run(options: &Motion, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let machine = session.setup.machine().map_err(|fault| session.setup_fault(&fault))?;
    let machine = machine.limited_by(&session.control.parameters);
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
    let mut player = Player::new(execution.interpreter().position(), rates, f64::from(options.rate));
    let mut target = match &options.output {
        Some(path) if path.as_os_str() != "-" => Target::File(WholeFile::create(path, speech)?),
        _ => Target::Standard(io::stdout().lock()),
    };
    let axes = &machine.axes;
    let mut table = Table {
        has_others: axes.c.is_some() || axes.y.is_some() || axes.b.is_some(),
        is_virtual: false,
        buffer: Vec::with_capacity(BUFFER_BYTES + 4096),
    };
    table.head();
    while let Some(command) = execution.next_command() {
        player.push(&command, &mut |sample| table.line(sample));
        if let Action::Interpolation(interpolation) = &command.action {
            table.is_virtual = *interpolation != Interpolation::Normal;
        }
        if table.buffer.len() >= BUFFER_BYTES {
            target.write(&mut table.buffer)?;
        }
    }
    player.finish(&mut |sample| table.line(sample));
    target.write(&mut table.buffer)?;
    target.finish()?;
    let findings = execution.findings();
    printer.findings(&findings, &text);
    Ok(findings.iter().map(|finding| finding.status()).max().unwrap_or(Status::Clean))
}

/// Where the table goes.
enum Target {
    File(WholeFile),
    Standard(io::StdoutLock<'static>),
}

impl Target {
    fn write(&mut self, buffer: &mut Vec<u8>) -> Result<(), Fault> {
        match self {
            Self::File(file) => file.append(buffer)?,
            Self::Standard(out) => out.write_all(buffer)?,
        }
        buffer.clear();
        Ok(())
    }

    fn finish(self) -> Result<(), Fault> {
        match self {
            Self::File(file) => file.finish()?,
            Self::Standard(mut out) => out.flush()?,
        }
        Ok(())
    }
}

/// The lines.
struct Table {
    /// The machine has axes beyond X and Z.
    has_others: bool,
    /// X and V are of a virtual plane: where the rotary axis is follows from them.
    is_virtual: bool,
    buffer: Vec<u8>,
}

impl Table {
    fn head(&mut self) {
        let others = if self.has_others { ",y_mm,c_deg,b_deg,v_mm" } else { "" };
        let head = format!("time_s,x_mm,z_mm{others},path_mm_per_s,rpm,turns,kind,line\n");
        self.buffer.extend_from_slice(head.as_bytes());
    }

    fn line(&mut self, sample: &Sample) {
        let [x, z, y, c, b, v] = sample.place;
        self.number(sample.time_s, 6);
        // X is a diameter, as everywhere.
        self.column(2.0 * x, 6);
        self.column(z, 6);
        if self.has_others {
            self.column(y, 6);
            if self.is_virtual {
                self.buffer.push(b',');
            } else {
                self.column(c, 6);
            }
            self.column(b, 6);
            self.column(v, 6);
        }
        self.column(sample.path_mm_per_s, 4);
        self.column(sample.rpm, 2);
        self.column(sample.turns, 6);
        let kind = sample.kind.word();
        // Writing to memory does not fail.
        let _ = writeln!(self.buffer, ",{kind},{}", sample.line);
    }

    fn column(&mut self, value: f64, decimals: u8) {
        self.buffer.push(b',');
        self.number(value, decimals);
    }

    fn number(&mut self, value: f64, decimals: u8) {
        let scale = 10f64.powi(i32::from(decimals));
        write_fixed(&mut self.buffer, (value * scale).round() as i64, decimals);
    }
}
