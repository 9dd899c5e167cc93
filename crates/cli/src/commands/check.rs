//! `turnwright check`: diagnostics of many programs.
//!
//! Programs are checked in parallel, a batch at a time, and said in the order of their names, so that equal
//! runs give equal output and memory does not grow with the number of programs.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_verify::{Checks, TextChecks};

use crate::arguments::{Check, Format};
use crate::environment::{ProgramText, STANDARD_INPUT, unreadable};
use crate::execution::Execution;
use crate::fault::{Fault, Status, caught};
use crate::finding::Finding;
use crate::output::sarif::{self, SarifResult};
use crate::part;
use crate::rates::rates;
use crate::render::Printer;
use crate::report::{Kept, Measure};
use crate::session::Session;
use crate::speech::Speech;

/// Programs checked before the first of them are said.
const BATCH: usize = 256;

/// Folders in folders that are searched.
const DEPTH_MAX: u32 = 64;

/// How names of programs end.
const EXTENSIONS: [&str; 9] = ["nc", "cnc", "tap", "txt", "mpf", "ngc", "min", "prg", "iso"];

/// A program to be checked, or why it cannot be.
pub(super) type Candidate = Result<PathBuf, Finding>;

/// What was found in one program, already in words.
#[derive(Debug, Default)]
struct Checked {
    said: String,
    results: Vec<SarifResult>,
    count: Count,
}

/// What every program is checked for, and how it is said.
#[derive(Clone, Copy, Debug)]
struct Task<'a> {
    options: &'a Check,
    printer: &'a Printer,
    /// Notes are for one program; among many they hide what matters.
    shows_notes: bool,
}

/// Sums for the last line.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    files: u64,
    alarms: u64,
    errors: u64,
    warnings: u64,
    notes: u64,
    is_failure: bool,
}

impl Count {
    fn add(&mut self, other: Self) {
        self.files += other.files;
        self.alarms += other.alarms;
        self.errors += other.errors;
        self.warnings += other.warnings;
        self.notes += other.notes;
        self.is_failure |= other.is_failure;
    }

    fn add_finding(&mut self, finding: &Finding) {
        match finding.diagnostic.severity {
            Severity::Alarm => self.alarms += 1,
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
            Severity::Note => self.notes += 1,
        }
        self.is_failure |= finding.status() == Status::Failed;
    }

    const fn status(self) -> Status {
        match self {
            Self { is_failure: true, .. } => Status::Failed,
            Self { alarms: 0, errors: 0, .. } => Status::Clean,
            _ => Status::Found,
        }
    }
}

/// The programs that were named, those of folders in the order of their names.
pub(super) fn candidates(named: &[PathBuf], speech: Speech) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for path in named {
        if path.as_os_str() != STANDARD_INPUT && path.is_dir() {
            let before = candidates.len();
            gather(path, 0, &mut candidates, speech);
            if candidates.len() == before {
                // A folder without programs is a mistyped folder, not a clean one.
                let empty = Diagnostic::error("folder-without-programs");
                candidates.push(Err(Finding::new(path.display().to_string(), empty).failed()));
            }
        } else {
            candidates.push(Ok(path.clone()));
        }
    }
    candidates
}

/// Checks everything that was named.
pub(crate) fn run(options: &Check, printer: &Printer) -> Result<Status, Fault> {
    let candidates = candidates(&options.files, printer.speech);
    let mut count = Count::default();
    let mut results = Vec::new();
    let mut out = io::stdout().lock();
    let task = Task { options, printer, shows_notes: candidates.len() == 1 };
    for batch in candidates.chunks(BATCH) {
        let checked: Vec<Checked> = match batch {
            // One program needs no helpers, and they take longer to start than most programs to check.
            [one] => vec![check(one, &task)],
            _ => batch.par_iter().map(|one| check(one, &task)).collect(),
        };
        for one in checked {
            count.add(one.count);
            results.extend(one.results);
            match options.format {
                Format::Human => printer.say(&one.said),
                Format::Json => out.write_all(one.said.as_bytes())?,
                Format::Sarif => {}
            }
        }
    }
    match options.format {
        Format::Human => printer.say(&last_line(count, &task)),
        Format::Json => {}
        Format::Sarif => writeln!(out, "{}", sarif::document(&results, printer.speech))?,
    }
    out.flush()?;
    Ok(count.status())
}

fn last_line(count: Count, task: &Task<'_>) -> String {
    let speech = task.printer.speech;
    let number = |name: &str, number: u64| {
        let key = if number == 1 { format!("count-{name}-one") } else { format!("count-{name}") };
        speech.fill(&key, &[("n", &number.to_string())])
    };
    let mut parts = vec![number("files", count.files), number("alarms", count.alarms)];
    if count.errors > 0 {
        parts.push(number("errors", count.errors));
    }
    parts.push(number("warnings", count.warnings));
    if count.notes > 0 && !task.shows_notes {
        parts.push(number("notes-hidden", count.notes));
    }
    format!("{}\n", parts.join(speech.get("list-comma")))
}

/// Checks one program. Nothing in it can stop the others from being checked.
fn check(candidate: &Candidate, task: &Task<'_>) -> Checked {
    let Task { options, printer, .. } = *task;
    let path = match candidate {
        Ok(path) => path,
        Err(finding) => return said(std::slice::from_ref(finding), None, task),
    };
    let text = match ProgramText::open(path, printer.speech) {
        Ok(text) => text,
        Err(finding) => return said(&[finding], None, task),
    };
    let findings = caught(|| find(&text, options, printer)).unwrap_or_else(|mut finding| {
        finding.file.clone_from(&text.name);
        vec![finding]
    });
    said(&findings, Some(&text), task)
}

fn find(text: &ProgramText, options: &Check, printer: &Printer) -> Vec<Finding> {
    let started = Session::choose(text, &options.machine, printer.speech)
        .and_then(|session| Ok((Execution::new(text, &session, &options.machine)?, session)));
    let (mut execution, session) = match started {
        Ok(started) => started,
        Err(mut finding) => {
            if finding.file.is_empty() {
                finding.file.clone_from(&text.name);
            }
            return vec![finding];
        }
    };
    if options.alarms_only {
        execution.drain();
    } else {
        let mut checks = Checks::new(execution.interpreter().position());
        while let Some(command) = execution.next_command() {
            checks.add(&command);
        }
        let checked = checks.finish(&session.setup);
        // The clock tells where a thread starts too close and where the spindle strays.
        let start = execution.interpreter().position();
        let mut measure = session.machine().ok().map(|machine| {
            let parameters = &session.control.parameters;
            let rates = rates(&machine, parameters, options.machine.optional_stop);
            Measure::new(start, rates, Kept::default())
        });
        let mut look = |_: &Execution<'_>, _: &mut Measure| Ok(());
        let (asked, inferred) = (&options.machine, &checked.inferred);
        let part = part::machined(text, &session, asked, inferred, None, measure.as_mut(), &mut look);
        let part = part.ok().flatten();
        measure.iter().flat_map(Measure::warnings).for_each(|finding| execution.warn(finding));
        let judged = part::judged(part.as_ref(), &session.setup, execution.alarm());
        let of_text = of_text(text);
        let of_part = part.into_iter().flat_map(|part| part.findings).chain(part::out_of_tolerance(&judged));
        of_text
            .into_iter()
            .chain(checked.findings)
            .chain(of_part)
            .for_each(|finding| execution.warn(finding));
    }
    let mut findings = execution.findings();
    if options.alarms_only {
        // What stopped the run short is told too: silence would say that the program is good.
        findings.retain(|finding| matches!(finding.diagnostic.severity, Severity::Alarm | Severity::Error));
    }
    findings
}

/// What the text shows as it stands.
pub(super) fn of_text(text: &ProgramText) -> Vec<Diagnostic> {
    let mut checks = TextChecks::default();
    text.lines().for_each(|line| checks.add(&line));
    checks.finish()
}

fn said(findings: &[Finding], text: Option<&ProgramText>, task: &Task<'_>) -> Checked {
    let Task { options, printer, shows_notes } = *task;
    let mut checked = Checked::default();
    checked.count.files = 1;
    let (messages, language) = (printer.speech.messages(), printer.speech.language);
    for finding in findings {
        checked.count.add_finding(finding);
        // What is wrong with a setup file is not in the program's text.
        let text = text.filter(|text| text.name == finding.file);
        match options.format {
            Format::Human => {}
            Format::Json => {
                let spot = finding.spot(text);
                checked.said.push_str(&finding.to_json_line(messages, language, spot.as_ref()));
                checked.said.push('\n');
            }
            Format::Sarif => checked.results.push(sarif::result(finding, printer.speech, text)),
        }
    }
    if options.format == Format::Human {
        let shown = findings.iter().filter(|one| shows_notes || one.diagnostic.severity != Severity::Note);
        checked.said = printer.human_all(shown, text);
    }
    checked
}

/// The programs in a folder and the folders in it, in the order of their names.
fn gather(folder: &Path, depth: u32, candidates: &mut Vec<Candidate>, speech: Speech) {
    let fault = |error: &io::Error| unreadable(&folder.display().to_string(), error, speech);
    let entries = fs::read_dir(folder).and_then(|entries| entries.collect::<io::Result<Vec<_>>>());
    let mut entries = match entries {
        Ok(entries) => entries,
        Err(error) => return candidates.push(Err(fault(&error))),
    };
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        let path = path.strip_prefix(".").map_or(path.clone(), Path::to_path_buf);
        // A link to a folder may lead back here and is not followed.
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => {
                if depth < DEPTH_MAX && !is_hidden(&path) {
                    gather(&path, depth + 1, candidates, speech);
                }
            }
            Ok(_) if is_program(&path) && !path.is_dir() => candidates.push(Ok(path)),
            Ok(_) => {}
            Err(error) => candidates.push(Err(fault(&error))),
        }
    }
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

fn is_program(path: &Path) -> bool {
    if is_hidden(path) {
        return false;
    }
    match path.extension() {
        Some(extension) => EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known)),
        None => path.file_name().is_some_and(|name| {
            let name = name.to_string_lossy();
            name.strip_prefix(['O', 'o'])
                .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_known_by_their_names() {
        for name in ["a.nc", "A.NC", "O0001", "o12", "b.Tap", "c.txt"] {
            assert!(is_program(Path::new(name)), "{name}");
        }
        for name in ["a.toml", "Ox1", "O", "report.html", ".a.nc", "README.md", "o"] {
            assert!(!is_program(Path::new(name)), "{name}");
        }
    }
}
