//! `turnwright run`: the program from its first block to its last, and what it was.
//!
//! In: one program. Out: a report for people or scripts; with `--out` also the page, the pictures and the
//! trace. What happened before an alarm is reported all the same.

use std::fs;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use turnwright_export::formats::jsonl;
use turnwright_export::formats::part_svg::{PartDrawing, write_part_svg};
use turnwright_export::formats::svg::{PictureOptions, write_svg};
use turnwright_verify::Checks;

use super::plot::paint;
use super::trace::{BUFFER_BYTES, write_alarm, write_json};
use crate::arguments::{Colour, Format, Run};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status, unwritable};
use crate::finding::Finding;
use crate::output::{WholeFile, sarif};
use crate::part;
use crate::passes::Passes;
use crate::render::Printer;
use crate::report::{Measure, RunReport, picture_language};
use crate::session::Session;
use crate::speech::Speech;

/// Shorter runs show no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Commands between two looks at the time.
const COMMANDS_PER_LOOK: u32 = 16 * 1024;

/// Runs the program and reports.
pub(crate) fn run(options: &Run, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, printer.speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let machine = session.setup.machine().map_err(|fault| session.setup_fault(&fault))?;
    let machine = machine.limited_by(&session.control.parameters);
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let mut measure = Measure::new(
        execution.interpreter().position(),
        &machine,
        &session.control.parameters,
        options.out.is_some(),
    );
    let mut folder =
        options.out.as_deref().map(|folder| OutFolder::create(folder, &session, speech)).transpose()?;

    let mut passes = folder.is_some().then(|| Passes::new(&execution));
    let mut checks = Checks::new(execution.interpreter().position());
    let mut progress = Progress::new(&text, printer);
    let decimals = execution.interpreter().decimals();
    while let Some(command) = execution.next_command() {
        checks.add(&command);
        if let Some(folder) = &mut folder {
            write_json(&mut folder.buffer, &command, decimals, &execution);
            folder.pour(BUFFER_BYTES)?;
        }
        if let Some(passes) = &mut passes {
            passes.add(&command, &execution);
        }
        measure.add(command);
        progress.look(&execution);
    }
    measure.finish();
    measure.warnings().for_each(|warning| execution.warn(warning));
    progress.finish();

    let checked = checks.finish(&session.setup);
    checked.findings.into_iter().for_each(|warning| execution.warn(warning));
    let mut part = part::machined(&text, &session, &options.machine, &checked.inferred.setup);
    if let Some(part) = &mut part {
        part.findings.drain(..).for_each(|finding| execution.warn(finding));
    }
    let findings = execution.findings();
    let status = findings.iter().map(Finding::status).max().unwrap_or(Status::Clean);
    let blocks = execution.interpreter().blocks_run();
    let stopped_at = execution.alarm().and_then(|alarm| alarm.place).map(|place| place.line);
    let file = text.name.clone();
    let mut report = RunReport {
        file,
        session,
        machine,
        findings,
        measure,
        passes: passes.map(Passes::finish).unwrap_or_default(),
        decimals,
        assumptions: checked.inferred.assumptions,
        part: part.and_then(part::drawn),
        blocks,
        stopped_at,
        written: Vec::new(),
    };
    if let Some(mut folder) = folder {
        write_alarm(&mut folder.buffer, &execution, printer);
        folder.finish(&text, &mut report, printer)?;
    }
    say(&report, &text, options.format, printer)?;
    Ok(status)
}

fn say(report: &RunReport, text: &ProgramText, format: Format, printer: &Printer) -> Result<(), Fault> {
    let speech = printer.speech;
    let mut out = printer.standard_output();
    match format {
        Format::Human => {
            out.write_all(report.head(speech).as_bytes())?;
            out.flush()?;
            printer.findings(&report.findings, text);
            out.write_all(report.body(speech).as_bytes())?;
        }
        Format::Json => writeln!(out, "{}", report.json(text, speech))?,
        Format::Sarif => {
            let results: Vec<_> =
                report.findings.iter().map(|finding| sarif::result(finding, speech, Some(text))).collect();
            writeln!(out, "{}", sarif::document(&results, speech))?;
        }
    }
    out.flush()?;
    Ok(())
}

/// The folder of `--out` while the trace is being written.
struct OutFolder {
    folder: PathBuf,
    trace: WholeFile,
    buffer: Vec<u8>,
}

impl OutFolder {
    fn create(folder: &Path, session: &Session, speech: Speech) -> Result<Self, Finding> {
        fs::create_dir_all(folder)
            .map_err(|error| unwritable(&folder.display().to_string(), &error, speech))?;
        let trace = WholeFile::create(&folder.join("trace.jsonl"), speech)?;
        let mut buffer = Vec::with_capacity(BUFFER_BYTES + 4096);
        jsonl::write_header(&mut buffer, &jsonl::TraceHeader { control: session.control.name });
        Ok(Self { folder: folder.to_path_buf(), trace, buffer })
    }

    /// Empties the buffer when it holds that many bytes.
    #[inline]
    fn pour(&mut self, bytes: usize) -> Result<(), Finding> {
        if self.buffer.len() >= bytes {
            self.trace.append(&self.buffer)?;
            self.buffer.clear();
        }
        Ok(())
    }

    /// Completes the trace and writes the page and the pictures.
    fn finish(
        mut self,
        text: &ProgramText,
        report: &mut RunReport,
        printer: &Printer,
    ) -> Result<(), Finding> {
        self.pour(0)?;
        let Self { folder, trace, .. } = self;
        let Some(path) = report.measure.path.take() else { return Ok(()) };
        let language = printer.speech.language;
        let page = report.page(text, &path, printer.speech);
        let options = PictureOptions {
            title: report.title(),
            language: picture_language(language),
            ..PictureOptions::default()
        };
        let picture = write_svg(&path, &options);
        drop(path);
        let png = paint(&folder.join("path.png"), &picture)?;
        WholeFile::write(&folder.join("report.html"), page.as_bytes(), printer.speech)?;
        WholeFile::write(&folder.join("path.svg"), picture.as_bytes(), printer.speech)?;
        WholeFile::write(&folder.join("path.png"), &png, printer.speech)?;
        let mut names = vec!["report.html", "path.svg", "path.png", "trace.jsonl"];
        if let Some((part, shape)) = &report.part {
            let drawing = PartDrawing {
                shape,
                stock: Some(&part.stock),
                title: report.title(),
                language: picture_language(language),
            };
            WholeFile::write(&folder.join("part.svg"), write_part_svg(&drawing).as_bytes(), printer.speech)?;
            names.push("part.svg");
        }
        trace.finish()?;
        report.written = names.iter().map(|name| folder.join(name).display().to_string()).collect();
        Ok(())
    }
}

/// A bar on the terminal, for runs that take long.
struct Progress {
    started: Instant,
    commands: u32,
    bytes: u64,
    is_wanted: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    fn new(text: &ProgramText, printer: &Printer) -> Self {
        let is_wanted = std::io::stderr().is_terminal() && printer.colour() != Colour::Never;
        Self { started: Instant::now(), commands: 0, bytes: text.len(), is_wanted, bar: None }
    }

    #[inline]
    fn look(&mut self, execution: &Execution<'_>) {
        self.commands += 1;
        if self.commands == COMMANDS_PER_LOOK {
            self.commands = 0;
            self.show(execution);
        }
    }

    fn show(&mut self, execution: &Execution<'_>) {
        if !self.is_wanted || self.started.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {elapsed}");
            ProgressBar::new(self.bytes).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        bar.set_position(execution.interpreter().offset());
    }

    fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
