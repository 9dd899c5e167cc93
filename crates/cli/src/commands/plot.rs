//! `turnwright plot`: the tool path alone, as a picture or as the lines and arcs of a DXF file.

use std::io::{self, Write};
use std::path::Path;

use turnwright_diagnostics::Diagnostic;
use turnwright_export::formats::dxf::write_path_dxf;
use turnwright_export::formats::png::write_png;
use turnwright_export::formats::svg::{PictureOptions, write_svg};

use crate::arguments::{Format, Plot};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::finding::Finding;
use crate::output::{PartFile, WholeFile, sarif};
use crate::rates::rates;
use crate::render::Printer;
use crate::report::{Kept, Measure, picture_language};
use crate::session::Session;
use crate::speech::Speech;

/// Pixels of the PNG for each of the drawing's own.
const SCALE: f32 = 2.0;

/// Draws the picture.
pub(crate) fn run(options: &Plot, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, printer.speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let machine = session.machine()?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let rates = rates(&machine, &session.control.parameters, options.machine.optional_stop);
    let kept = Kept { path: true, ..Kept::default() };
    let mut measure = Measure::new(execution.interpreter().position(), rates, kept);
    while let Some(command) = execution.next_command() {
        measure.add(command, None);
    }
    measure.finish();
    let Some(path) = measure.path else { return Ok(Status::Failed) };
    if PartFile::of(&options.output) == Some(PartFile::Dxf) {
        WholeFile::write(&options.output, write_path_dxf(&path).as_bytes(), speech)?;
        return say(&execution.findings(), &text, options.format, printer);
    }
    let title = options.file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let language = picture_language(speech.language);
    let picture = write_svg(&path, &PictureOptions { title, language, ..PictureOptions::default() });
    write_picture(&options.output, &picture, speech)?;
    say(&execution.findings(), &text, options.format, printer)
}

pub(super) fn say(
    findings: &[Finding],
    text: &ProgramText,
    format: Format,
    printer: &Printer,
) -> Result<Status, Fault> {
    let speech = printer.speech;
    let mut out = io::stdout().lock();
    match format {
        Format::Human => printer.findings(findings, text),
        Format::Json => {
            for finding in findings {
                let spot = finding.spot(Some(text));
                writeln!(out, "{}", finding.to_json_line(speech.messages(), speech.language, spot.as_ref()))?;
            }
        }
        Format::Sarif => {
            let results: Vec<_> =
                findings.iter().map(|finding| sarif::result(finding, speech, Some(text))).collect();
            writeln!(out, "{}", sarif::document(&results, speech))?;
        }
    }
    out.flush()?;
    Ok(findings.iter().map(Finding::status).max().unwrap_or(Status::Clean))
}

/// Writes a drawing in the form that the name of the file asks for.
pub(super) fn write_picture(target: &Path, picture: &str, speech: Speech) -> Result<(), Finding> {
    if target.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        WholeFile::write(target, &paint(target, picture)?, speech)
    } else {
        WholeFile::write(target, picture.as_bytes(), speech)
    }
}

/// A drawing as PNG.
pub(super) fn paint(target: &Path, picture: &str) -> Result<Vec<u8>, Finding> {
    write_png(picture, SCALE).map_err(|fault| {
        let name = target.display().to_string();
        let diagnostic =
            Diagnostic::error("output-unwritable").with("name", name).with("value", fault.to_string());
        Finding::new("", diagnostic).failed()
    })
}
