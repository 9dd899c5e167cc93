//! `turnwright run`: the program from its first block to its last, and what it was.
//!
//! In: one program. Out: a report for people or scripts; with `--out` also the page, the pictures and the
//! trace. What happened before an alarm is reported all the same.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_export::formats::cutting_svg::write_cutting_svg;
use turnwright_export::formats::dxf::write_path_dxf;
use turnwright_export::formats::jsonl::{self, CommandWriter};
use turnwright_export::formats::part_svg::PartDrawing;
use turnwright_export::formats::svg::{PictureOptions, write_svg};
use turnwright_export::formats::time_svg::{TimePicture, write_time_svg};
use turnwright_export::mesh::CHORD_MM;
use turnwright_export::solid::has_solid;
use turnwright_verify::Checks;
use turnwright_verify::advice::Advisor;
use turnwright_verify::cutting::CuttingRun;

use super::check;
use super::plot::paint;
use super::trace::{BUFFER_BYTES, write_alarm, write_json};
use crate::arguments::{Format, Run};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status, unwritable};
use crate::finding::Finding;
use crate::output::{PartFile, WholeFile, sarif};
use crate::part::{self, Meshed};
use crate::passes::Passes;
use crate::progress::Progress;
use crate::rates::rates;
use crate::render::Printer;
use crate::report::{Kept, Measure, RunReport, picture_language};
use crate::session::Session;
use crate::speech::Speech;

/// What `--out` writes of the part.
const PART_FILES: [&str; 5] = ["part.svg", "part.step", "part.stl", "part.glb", "part.dxf"];

/// Runs the program and reports.
pub(crate) fn run(options: &Run, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, printer.speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let machine = session.machine()?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
    let writes = options.out.is_some();
    let kept = Kept { path: writes, timeline: writes, table: writes };
    let mut measure = Measure::new(execution.interpreter().position(), rates, kept);
    let mut folder =
        options.out.as_deref().map(|folder| OutFolder::create(folder, &session, speech)).transpose()?;

    let mut passes = folder.is_some().then(|| Passes::new(&execution));
    let mut checks = Checks::new(execution.interpreter().position());
    let mut progress = Progress::new(&text, printer);
    let decimals = execution.interpreter().decimals();
    let mut writer = CommandWriter::new(decimals);
    while let Some(command) = execution.next_command() {
        checks.add(&command);
        if let Some(folder) = &mut folder {
            write_json(&mut folder.buffer, &mut writer, &command, &execution);
            folder.pour(BUFFER_BYTES)?;
        }
        if let Some(passes) = &mut passes {
            passes.add(&command, &execution);
        }
        progress.look(execution.interpreter());
    }
    progress.finish();

    let checked = checks.finish(&session.setup);
    let found = check::of_text(&text).into_iter().chain(checked.findings);
    found.for_each(|warning| execution.warn(warning));
    // The second run cuts the part and takes the time: what a move removes tells where time is lost.
    let mut progress = Progress::new(&text, printer);
    let mut look = |again: &Execution<'_>, measure: &mut Measure| {
        progress.look(again.interpreter());
        folder.as_mut().map_or(Ok(()), |folder| folder.pour_table(measure, BUFFER_BYTES))
    };
    let (setup, asked) = (&checked.inferred.setup, &options.machine);
    measure.advisor = Some(Advisor::new(setup, rates));
    // What cannot be was refused when the setup was read.
    let material = session.setup.material().unwrap_or_default();
    measure.cutting = Some(CuttingRun::new(setup.tools().unwrap_or_default(), material));
    let mut part =
        part::machined(&text, &session, asked, &checked.inferred, None, Some(&mut measure), &mut look)?;
    progress.finish();
    measure.warnings().for_each(|warning| execution.warn(warning));
    if let Some(part) = &mut part {
        part.findings.drain(..).for_each(|finding| execution.warn(finding));
    }
    let judged = part::judged(part.as_ref(), &session.setup, execution.alarm());
    part::out_of_tolerance(&judged).for_each(|finding| execution.warn(finding));
    let part = part.and_then(part::drawn);
    if options.out.is_some() && part.as_ref().is_some_and(|(_, shape)| !has_solid(shape)) {
        execution.warn(Diagnostic::new(Severity::Note, "part-too-fine"));
    }
    let meshed = match &part {
        Some((part, shape)) if options.out.is_some() => part::meshed(part, shape, CHORD_MM),
        _ => Meshed::default(),
    };
    if let Some(finding) = &meshed.finding {
        execution.warn(finding.clone());
    }
    let findings = execution.findings();
    let status = findings.iter().map(Finding::status).max().unwrap_or(Status::Clean);
    let blocks = execution.interpreter().blocks_run();
    let stopped_at = execution.alarm().and_then(|alarm| alarm.place).map(|place| place.line);
    let file = text.name.clone();
    let cutting = measure.cutting.take().map(CuttingRun::finish).unwrap_or_default();
    let mut report = RunReport {
        file,
        session,
        machine,
        findings,
        measure,
        passes: passes.map(Passes::finish).unwrap_or_default(),
        decimals,
        assumptions: checked.inferred.assumptions,
        part,
        meshed,
        cutting,
        judged,
        blocks,
        stopped_at,
        written: Vec::new(),
        not_drawn: 0,
    };
    if let Some(mut folder) = folder {
        write_alarm(&mut folder.buffer, &execution, printer);
        folder.finish(&text, &mut report, printer, !options.no_3d)?;
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
    times: WholeFile,
    buffer: Vec<u8>,
}

impl OutFolder {
    fn create(folder: &Path, session: &Session, speech: Speech) -> Result<Self, Finding> {
        fs::create_dir_all(folder)
            .map_err(|error| unwritable(&folder.display().to_string(), &error, speech))?;
        let trace = WholeFile::create(&folder.join("trace.jsonl"), speech)?;
        let times = WholeFile::create(&folder.join("times.csv"), speech)?;
        let mut buffer = Vec::with_capacity(BUFFER_BYTES + 4096);
        jsonl::write_header(&mut buffer, &jsonl::TraceHeader { control: session.control.name });
        Ok(Self { folder: folder.to_path_buf(), trace, times, buffer })
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

    /// Writes the table of times when it holds that many bytes.
    fn pour_table(&mut self, measure: &mut Measure, bytes: usize) -> Result<(), Finding> {
        if let Some(table) = measure.table.as_mut().filter(|table| table.len() >= bytes) {
            self.times.append(table)?;
            table.clear();
        }
        Ok(())
    }

    /// Completes the trace and writes the page and the pictures.
    fn finish(
        mut self,
        text: &ProgramText,
        report: &mut RunReport,
        printer: &Printer,
        has_solid: bool,
    ) -> Result<(), Finding> {
        self.pour(0)?;
        self.pour_table(&mut report.measure, 0)?;
        let Self { folder, trace, times, .. } = self;
        let Some(path) = report.measure.path.take() else { return Ok(()) };
        let language = printer.speech.language;
        let page = report.page(text, &path, printer.speech, has_solid);
        let options = PictureOptions {
            title: report.title(),
            language: picture_language(language),
            ..PictureOptions::default()
        };
        let picture = write_svg(&path, &options);
        let strokes = write_path_dxf(&path);
        drop(path);
        let png = paint(&folder.join("path.png"), &picture)?;
        WholeFile::write(&folder.join("report.html"), page.as_bytes(), printer.speech)?;
        WholeFile::write(&folder.join("path.svg"), picture.as_bytes(), printer.speech)?;
        WholeFile::write(&folder.join("path.png"), &png, printer.speech)?;
        WholeFile::write(&folder.join("path.dxf"), strokes.as_bytes(), printer.speech)?;
        let mut names = vec!["report.html", "path.svg", "path.png", "path.dxf", "trace.jsonl", "times.csv"];
        if let Some(timeline) = &report.measure.timeline {
            let picture = TimePicture { title: report.title(), language: picture_language(language) };
            let drawn = write_time_svg(timeline, &picture);
            WholeFile::write(&folder.join("time.svg"), drawn.as_bytes(), printer.speech)?;
            names.push("time.svg");
        }
        if let Some(picture) = report.cutting_picture(printer.speech) {
            let drawn = write_cutting_svg(&picture);
            WholeFile::write(&folder.join("cutting.svg"), drawn.as_bytes(), printer.speech)?;
            names.push("cutting.svg");
        }
        if let Some((part, shape)) = &report.part {
            let drawing = PartDrawing {
                shape,
                stock: Some(&part.stock),
                title: report.title(),
                language: picture_language(language),
            };
            let mesh = report.meshed.mesh.as_ref();
            for name in PART_FILES {
                let target = folder.join(name);
                if let Some(bytes) = PartFile::of(&target).and_then(|form| form.bytes(&drawing, mesh)) {
                    WholeFile::write(&target, &bytes, printer.speech)?;
                    names.push(name);
                }
            }
        }
        let (crashes, not_drawn) = report.crash_pictures(text, printer.speech);
        drop_pictures(&folder);
        for (at, name, picture) in &crashes {
            let target = folder.join(name);
            WholeFile::write(&target, picture.as_bytes(), printer.speech)?;
            report.findings[*at].picture = Some(target.display().to_string());
            names.push(name);
        }
        trace.finish()?;
        times.finish()?;
        report.not_drawn = not_drawn;
        report.written = names.iter().map(|name| folder.join(name).display().to_string()).collect();
        Ok(())
    }
}

/// Takes away what an earlier run wrote of crashes: a program that is mended has none.
fn drop_pictures(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(is_crash_picture) {
            // One that stays is only out of date.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is `crash-2-line-17.svg` or the like.
fn is_crash_picture(name: &str) -> bool {
    let numbers = name.strip_prefix("crash-").and_then(|rest| rest.strip_suffix(".svg"));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    numbers.and_then(|rest| rest.split_once("-line-")).is_some_and(|(a, b)| is_number(a) && is_number(b))
}
