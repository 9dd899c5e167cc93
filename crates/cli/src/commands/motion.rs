//! `turnwright motion`: where the axes are, tick by tick.
//!
//! In: one program and a rate. Out: a table with a row a tick, CSV or Parquet by the end of the file's name, written as
//! the plan becomes final: its length needs no memory. The panel is set from the start or at any second.

use std::io::{self, Write};

use turnwright_canon::{Action, Interpolation};
use turnwright_control::MachineAxes;
use turnwright_diagnostics::Diagnostic;
use turnwright_export::formats::parquet::{Column, ColumnKind, ParquetTable};
use turnwright_motion::{Kind, Player, Sample};
use turnwright_units::write_fixed;

use super::trace::BUFFER_BYTES;
use crate::arguments::{Motion, is_parquet};
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
    let machine = session.machine()?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
    let rates = options.panel.man(rates, &session.control)?;
    let mut player = Player::new(execution.interpreter().position(), rates, f64::from(options.rate));
    options.actions.tell(&mut player, rates.panel, &session.control)?;
    let mut target = match &options.output {
        Some(path) if path.as_os_str() != "-" => Target::File(WholeFile::create(path, speech)?),
        _ => Target::Standard(io::stdout().lock()),
    };
    let mut table = Table::new(&machine.axes, options.output.as_deref().is_some_and(is_parquet));
    while let Some(command) = execution.next_command() {
        player.push(&command, &mut |sample| table.add(sample));
        if let Action::Interpolation(interpolation) = &command.action {
            table.is_virtual = *interpolation != Interpolation::Normal;
        }
        if table.buffer.len() >= BUFFER_BYTES {
            target.write(&mut table.buffer)?;
        }
    }
    player.finish(&mut |sample| table.add(sample));
    table.finish();
    target.write(&mut table.buffer)?;
    target.finish()?;
    if player.is_stuck() {
        let held = Diagnostic::warning("held-to-the-end").with("time", format!("{:.3}", table.last_s));
        execution.warn(held);
    }
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

/// The rows.
struct Table {
    /// The machine has axes beyond X and Z.
    has_others: bool,
    /// X and V are of a virtual plane: where the rotary axis is follows from them.
    is_virtual: bool,
    /// Time of the last row.
    last_s: f64,
    buffer: Vec<u8>,
    form: Form,
}

/// How they are written.
enum Form {
    Csv,
    Parquet(Box<ParquetTable>),
}

/// The words of the column `kind`, in the order of [`Kind`].
const KIND_WORDS: [&str; Kind::ALL.len()] = {
    let mut words = [""; Kind::ALL.len()];
    let mut at = 0;
    while at < words.len() {
        words[Kind::ALL[at] as usize] = Kind::ALL[at].word();
        at += 1;
    }
    words
};

impl Table {
    fn new(axes: &MachineAxes, is_parquet: bool) -> Self {
        let has_others = axes.c.is_some() || axes.y.is_some() || axes.b.is_some();
        let mut buffer = Vec::with_capacity(BUFFER_BYTES + 4096);
        let columns = columns(has_others);
        let form = if is_parquet {
            Form::Parquet(Box::new(ParquetTable::new(&columns, &mut buffer)))
        } else {
            let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
            buffer.extend_from_slice(names.join(",").as_bytes());
            buffer.push(b'\n');
            Form::Csv
        };
        Self { has_others, is_virtual: false, last_s: 0.0, buffer, form }
    }

    fn add(&mut self, sample: &Sample) {
        let [x, z, y, c, b, v] = sample.place;
        self.last_s = sample.time_s;
        self.number(sample.time_s, 6);
        // X is a diameter, as everywhere.
        self.number(2.0 * x, 6);
        self.number(z, 6);
        if self.has_others {
            self.number(y, 6);
            self.cell((!self.is_virtual).then_some(c), 6);
            self.number(b, 6);
            self.number(v, 6);
        }
        self.number(sample.path_mm_per_s, 4);
        self.number(sample.rpm, 2);
        self.number(sample.turns, 6);
        match &mut self.form {
            Form::Csv => {
                // Writing to memory does not fail.
                let _ = writeln!(self.buffer, "{},{}", sample.kind.word(), sample.line);
            }
            Form::Parquet(table) => {
                table.word(sample.kind as u32);
                table.integer(sample.line.try_into().unwrap_or(i32::MAX));
                table.flush_full(&mut self.buffer);
            }
        }
    }

    fn number(&mut self, value: f64, decimals: u8) {
        self.cell(Some(value), decimals);
    }

    /// Both forms hold the same numbers: those with so many decimals.
    fn cell(&mut self, value: Option<f64>, decimals: u8) {
        let scale = 10f64.powi(i32::from(decimals));
        let rounded = value.map(|value| (value * scale).round());
        match &mut self.form {
            Form::Csv => {
                if let Some(rounded) = rounded {
                    write_fixed(&mut self.buffer, rounded as i64, decimals);
                }
                self.buffer.push(b',');
            }
            // Zero has no sign, as in text.
            Form::Parquet(table) => table.number(rounded.map(|rounded| rounded / scale + 0.0)),
        }
    }

    /// No more rows come.
    fn finish(&mut self) {
        if let Form::Parquet(table) = std::mem::replace(&mut self.form, Form::Csv) {
            table.finish(&mut self.buffer);
        }
    }
}

fn columns(has_others: bool) -> Vec<Column> {
    let number = |name| Column { name, kind: ColumnKind::Number };
    let mut columns = vec![number("time_s"), number("x_mm"), number("z_mm")];
    if has_others {
        let c = Column { name: "c_deg", kind: ColumnKind::OptionalNumber };
        columns.extend([number("y_mm"), c, number("b_deg"), number("v_mm")]);
    }
    columns.extend(["path_mm_per_s", "rpm", "turns"].map(number));
    columns.push(Column { name: "kind", kind: ColumnKind::Word(&KIND_WORDS) });
    columns.push(Column { name: "line", kind: ColumnKind::Integer });
    columns
}
