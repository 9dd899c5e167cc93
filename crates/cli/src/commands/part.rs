//! `turnwright part`: the finished part alone, in the form that the file's name asks for.
//!
//! In: one program. Out: one file. The program runs twice, as in `run`: to see what it is written for, and on that stock.

use turnwright_diagnostics::Diagnostic;
use turnwright_export::formats::part_svg::PartDrawing;
use turnwright_verify::Inference;

use super::plot::{paint, say};
use crate::arguments::PartOptions;
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::output::{PartFile, WholeFile};
use crate::part::{self, Meshed};
use crate::render::Printer;
use crate::report::{Measure, picture_language};
use crate::session::Session;

/// Runs the program and writes its part.
pub(crate) fn run(options: &PartOptions, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    session.setup.machine().map_err(|fault| session.setup_fault(&fault))?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let mut inference = Inference::new(execution.interpreter().position());
    while let Some(command) = execution.next_command() {
        inference.add(&command);
    }
    let inferred = inference.finish(&session.setup);
    let mut look = |_: &Execution<'_>, _: &mut Measure| Ok(());
    let mut part = part::machined(&text, &session, &options.machine, &inferred, None, None, &mut look)?;
    if let Some(part) = &mut part {
        part.findings.drain(..).for_each(|finding| execution.warn(finding));
    }
    let drawn = part.and_then(part::drawn);
    let target = &options.output;
    let meshed = match (&drawn, PartFile::of(target)) {
        (Some((part, shape)), Some(form)) if form.is_mesh() => part::meshed(part, shape, options.chord),
        _ => Meshed::default(),
    };
    if let Some(finding) = meshed.finding {
        execution.warn(finding);
    }
    let file = drawn.as_ref().and_then(|(part, shape)| {
        let drawing = PartDrawing {
            shape,
            stock: Some(&part.stock),
            title: options
                .file
                .file_name()
                .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
            language: picture_language(speech.language),
        };
        PartFile::of(target)?.bytes(&drawing, meshed.mesh.as_ref())
    });
    match file {
        Some(picture) if PartFile::of(target) == Some(PartFile::Png) => {
            WholeFile::write(target, &paint(target, &String::from_utf8_lossy(&picture))?, speech)?;
        }
        Some(bytes) => WholeFile::write(target, &bytes, speech)?,
        None => execution.warn(Diagnostic::error(if drawn.is_some() { "part-too-fine" } else { "no-part" })),
    }
    say(&execution.findings(), &text, options.format, printer)
}
