//! `turnwright time`: how long programs take, and what for.
//!
//! One program: what its time is spent on, by tool, operation and line; with `--output` block by block (CSV) or drawn
//! over time (SVG, PNG). Many programs: a table with a line for each and the sum of all; programs are timed in
//! parallel, a batch at a time, and said in the order they were named in.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde_json::{Value, json};
use turnwright_export::formats::time_svg::{TimePicture, write_time_svg};
use turnwright_motion::{Kind, Panel, Totals};
use turnwright_verify::Checks;
use turnwright_verify::advice::Advisor;
use turnwright_verify::cutting::CuttingData;

use super::check::{Candidate, candidates};
use super::plot::write_picture;
use super::trace::BUFFER_BYTES;
use crate::arguments::{Colour, LookupFormat, Time};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status, caught};
use crate::finding::Finding;
use crate::output::WholeFile;
use crate::part::{self, Meshed};
use crate::passes::Passes;
use crate::progress::Progress;
use crate::rates::rates;
use crate::render::{Printer, clean};
use crate::report::{Kept, Measure, RunReport, TIME_PARTS, picture_language, totals_json};
use crate::session::Session;
use crate::speech::Speech;
use crate::table::{Side, Table};

/// Programs timed before the first of them are said.
const BATCH: usize = 64;

/// Shorter work shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Times what was named.
pub(crate) fn run(options: &Time, printer: &Printer) -> Result<Status, Fault> {
    if options.panel.feed_override == Some(0.0) && options.panel.dry_run.is_none() {
        return Err(Fault::Usage(printer.speech.get("time-without-feed").to_string()));
    }
    let named = candidates(&options.files, printer.speech);
    match &named[..] {
        [Ok(path)] => one(path, options, printer),
        _ => many(&named, options, printer),
    }
}

/// What the name of the output asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Table,
    Picture,
}

fn form(output: Option<&PathBuf>) -> Option<Form> {
    let extension = output?.extension().map(|extension| extension.to_ascii_lowercase());
    let is_picture = extension.is_some_and(|extension| extension == "svg" || extension == "png");
    Some(if is_picture { Form::Picture } else { Form::Table })
}

/// A program in full.
fn one(path: &Path, options: &Time, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(path, speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let machine = session.machine()?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let wanted = form(options.output.as_ref());
    let start = execution.interpreter().position();
    let mut checks = Checks::new(start);
    let mut progress = Progress::new(&text, printer);
    while let Some(command) = execution.next_command() {
        checks.add(&command);
        progress.look(execution.interpreter());
    }
    progress.finish();
    let checked = checks.finish(&session.setup);

    let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
    let rates = options.panel.man(rates, &session.control)?;
    let kept =
        Kept { timeline: wanted == Some(Form::Picture), table: wanted == Some(Form::Table), path: false };
    let mut measure = Measure::new(start, rates, kept);
    let mut progress = Progress::new(&text, printer);
    let table = options.output.as_ref().filter(|_| kept.table);
    let mut table = table.map(|path| WholeFile::create(path, speech)).transpose()?;
    let mut look = |again: &Execution<'_>, measure: &mut Measure| {
        progress.look(again.interpreter());
        pour(table.as_mut(), measure, BUFFER_BYTES)
    };
    let (setup, asked) = (&checked.inferred.setup, &options.machine);
    // Advice is for the program as it runs in production.
    measure.advisor = (rates.panel == Panel::default()).then(|| Advisor::new(setup, rates));
    part::machined(&text, &session, asked, &checked.inferred, None, Some(&mut measure), &mut look)?;
    progress.finish();
    pour(table.as_mut(), &mut measure, 0)?;
    if let Some(table) = table {
        table.finish()?;
    }
    let title = text.name.rsplit('/').next().unwrap_or(&text.name).to_string();
    if let (Some(timeline), Some(path)) = (&measure.timeline, &options.output) {
        let picture = TimePicture { title, language: picture_language(speech.language) };
        write_picture(path, &write_time_svg(timeline, &picture), speech)?;
    }
    measure.warnings().for_each(|finding| execution.warn(finding));
    // What is told here are the alarms; `check` tells the rest.
    let mut findings = execution.findings();
    let status = findings.iter().map(Finding::status).max().unwrap_or(Status::Clean);
    findings.retain(Finding::is_alarm_or_error);
    let stopped_at = execution.alarm().and_then(|alarm| alarm.place).map(|place| place.line);
    let report = RunReport {
        file: text.name.clone(),
        session,
        machine,
        findings,
        measure,
        passes: Passes::new(&execution).finish(),
        decimals: execution.interpreter().decimals(),
        assumptions: Vec::new(),
        cutting: CuttingData::default(),
        judged: Vec::new(),
        part: None,
        meshed: Meshed::default(),
        blocks: execution.interpreter().blocks_run(),
        stopped_at,
        not_drawn: 0,
        written: options.output.iter().map(|path| path.display().to_string()).collect(),
    };
    let mut out = printer.standard_output();
    match options.format {
        LookupFormat::Human => {
            out.write_all(report.head(speech).as_bytes())?;
            out.flush()?;
            printer.findings(&report.findings, &text);
            out.write_all(report.time_body(speech).as_bytes())?;
        }
        LookupFormat::Json => writeln!(out, "{}", report.time_document(&text, speech))?,
    }
    out.flush()?;
    Ok(status)
}

fn pour(table: Option<&mut WholeFile>, measure: &mut Measure, bytes: usize) -> Result<(), Finding> {
    if let (Some(file), Some(rows)) = (table, measure.table.as_mut().filter(|rows| rows.len() >= bytes)) {
        file.append(rows)?;
        rows.clear();
    }
    Ok(())
}

/// A program among many.
#[derive(Debug, Default)]
struct Timed {
    file: String,
    control: &'static str,
    times: Totals,
    unknown: u64,
    stopped_at: Option<u32>,
    status: Option<Status>,
    /// Alarms and errors in words.
    said: String,
    diagnostics: Vec<Value>,
}

fn many(named: &[Candidate], options: &Time, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    if form(options.output.as_ref()) == Some(Form::Picture) {
        return Err(Fault::Usage(speech.get("time-picture-of-one").to_string()));
    }
    let progress = Bar::new(named.len(), printer);
    let mut programs = Vec::with_capacity(named.len());
    for batch in named.chunks(BATCH) {
        let batch: Vec<Timed> = batch
            .par_iter()
            .map(|candidate| {
                let timed = timed(candidate, options, printer);
                progress.step();
                timed
            })
            .collect();
        programs.extend(batch);
    }
    progress.finish();
    let mut sum = Totals::default();
    programs.iter().for_each(|one| sum.add_all(&one.times));
    if let Some(path) = &options.output {
        WholeFile::write(path, csv(&programs).as_bytes(), speech)?;
    }
    let mut out = printer.standard_output();
    match options.format {
        LookupFormat::Human => {
            programs.iter().for_each(|one| printer.say(&one.said));
            out.write_all(table(&programs, &sum, speech).as_bytes())?;
        }
        LookupFormat::Json => writeln!(out, "{}", document(&programs, &sum))?,
    }
    out.flush()?;
    Ok(programs.iter().filter_map(|one| one.status).max().unwrap_or(Status::Clean))
}

/// Times a program. Nothing in it can stop the others from being timed.
fn timed(candidate: &Candidate, options: &Time, printer: &Printer) -> Timed {
    let path = match candidate {
        Ok(path) => path,
        Err(finding) => {
            return of_findings(finding.file.clone(), vec![finding.clone()], None, options, printer);
        }
    };
    let text = match ProgramText::open(path, printer.speech) {
        Ok(text) => text,
        Err(finding) => {
            return of_findings(path.display().to_string(), vec![finding], None, options, printer);
        }
    };
    let mut times = Totals::default();
    let (mut unknown, mut stopped_at, mut control) = (0, None, "");
    let result = caught(|| -> Result<Vec<Finding>, Finding> {
        let session = Session::choose(&text, &options.machine, printer.speech)?;
        control = session.control.name;
        let machine = session.machine()?;
        let mut execution = Execution::new(&text, &session, &options.machine)?;
        let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
        let rates = options.panel.man(rates, &session.control)?;
        let mut measure = Measure::new(execution.interpreter().position(), rates, Kept::default());
        while let Some(command) = execution.next_command() {
            measure.add(command, None);
        }
        measure.finish();
        times = *measure.summary.totals();
        unknown = measure.schedule.unknown_feeds();
        stopped_at = execution.alarm().and_then(|alarm| alarm.place).map(|place| place.line);
        Ok(execution.findings())
    });
    let findings = match result {
        Ok(Ok(findings)) => findings,
        Ok(Err(mut finding)) | Err(mut finding) => {
            if finding.file.is_empty() {
                finding.file.clone_from(&text.name);
            }
            vec![finding]
        }
    };
    let told = of_findings(text.name.clone(), findings, Some(&text), options, printer);
    Timed { control, times, unknown, stopped_at, ..told }
}

fn of_findings(
    file: String,
    mut findings: Vec<Finding>,
    text: Option<&ProgramText>,
    options: &Time,
    printer: &Printer,
) -> Timed {
    let status = findings.iter().map(Finding::status).max();
    findings.retain(Finding::is_alarm_or_error);
    let mut timed = Timed { file, status, ..Timed::default() };
    let (messages, language) = (printer.speech.messages(), printer.speech.language);
    // What is wrong with a setup file is not in the program's text.
    let of_text = |finding: &Finding| text.filter(|text| text.name == finding.file);
    match options.format {
        LookupFormat::Human => timed.said = printer.human_all(findings.iter(), text),
        LookupFormat::Json => {
            let json = |finding: &Finding| {
                finding.to_json(messages, language, finding.spot(of_text(finding)).as_ref())
            };
            timed.diagnostics = findings.iter().map(json).collect();
        }
    }
    timed
}

/// The columns of the table: a name and the kinds it sums up.
const COLUMNS: [(&str, &[Kind]); 6] = [
    ("in-cut", &[Kind::Cutting, Kind::Threading]),
    ("in-rapid", &[Kind::Rapid]),
    ("tool-change", &[Kind::ToolChange]),
    ("spindle", &[Kind::Spindle, Kind::SpindleWait]),
    ("dwell", &[Kind::Dwell]),
    ("other", &[Kind::Stop, Kind::Loading, Kind::Other]),
];

fn table(programs: &[Timed], sum: &Totals, speech: Speech) -> String {
    use Side::{Left, Right};
    let mut table = Table::new(&[Left, Right, Right, Right, Right, Right, Right, Right, Left]);
    let column = |key: &str| speech.fill(&format!("column-{key}"), &[]);
    let head = ["program", "time"].into_iter().chain(COLUMNS.map(|(key, _)| key));
    table.row(head.map(column));
    let cells = |name: String, times: &Totals, remark: String| {
        let of = |kinds: &[Kind]| kinds.iter().map(|kind| times.seconds(*kind)).sum::<f64>();
        let parts = COLUMNS.map(|(_, kinds)| match of(kinds) {
            0.0 => String::new(),
            seconds => speech.duration(seconds),
        });
        let whole = [name, speech.duration(times.total_s())];
        whole.into_iter().chain(parts).chain([remark]).collect::<Vec<_>>()
    };
    for one in programs {
        let remark = match one.stopped_at {
            Some(line) => speech.fill("time-until", &[("line", &line.to_string())]),
            None if one.status == Some(Status::Failed) => speech.get("time-none").to_string(),
            None if one.unknown > 0 => speech.fill("time-some-unknown", &[("n", &one.unknown.to_string())]),
            None => String::new(),
        };
        table.row(cells(clean(&one.file), &one.times, remark));
    }
    let count = programs.len().to_string();
    table.row(cells(speech.fill("time-of-all", &[("n", &count)]), sum, String::new()));
    table.text(0, true)
}

fn document(programs: &[Timed], sum: &Totals) -> Value {
    let programs = programs.iter().map(|one| {
        json!({
            "file": one.file,
            "control": one.control,
            "time": totals_json(&one.times),
            "moves_of_unknown_time": one.unknown,
            "stopped_at_line": one.stopped_at,
            "diagnostics": one.diagnostics,
        })
    });
    json!({
        "turnwright": "time",
        "version": 1,
        "programs": programs.collect::<Vec<_>>(),
        "time": totals_json(sum),
    })
}

/// A line a program.
fn csv(programs: &[Timed]) -> String {
    let mut out = String::from("file,seconds");
    TIME_PARTS.iter().for_each(|(_, name)| out.push_str(&format!(",{name}_s")));
    out.push_str(",stopped_at_line\n");
    for one in programs {
        // A name with a comma or a quote is quoted.
        let needs_quotes = one.file.contains([',', '"', '\n', '\r']);
        let file =
            if needs_quotes { format!("\"{}\"", one.file.replace('"', "\"\"")) } else { one.file.clone() };
        let seconds = |time: Duration| format!("{}.{:09}", time.as_secs(), time.subsec_nanos());
        out.push_str(&format!("{file},{}", seconds(one.times.total())));
        for (kind, _) in TIME_PARTS {
            out.push_str(&format!(",{}", seconds(one.times.time(kind))));
        }
        out.push_str(&format!(",{}\n", one.stopped_at.map_or(String::new(), |line| line.to_string())));
    }
    out
}

/// How many programs are done, on a terminal and when it takes long.
struct Bar {
    started: Instant,
    is_wanted: bool,
    done: AtomicU64,
    bar: ProgressBar,
}

impl Bar {
    fn new(count: usize, printer: &Printer) -> Self {
        let is_wanted = std::io::stderr().is_terminal() && printer.colour() != Colour::Never;
        let bar = ProgressBar::hidden();
        bar.set_length(count as u64);
        Self { started: Instant::now(), is_wanted, done: AtomicU64::new(0), bar }
    }

    fn step(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if !self.is_wanted || self.started.elapsed() < PATIENCE {
            return;
        }
        if self.bar.is_hidden() {
            let style = ProgressStyle::with_template("{wide_bar} {pos}/{len}  {elapsed}");
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
        }
        self.bar.set_position(done);
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
