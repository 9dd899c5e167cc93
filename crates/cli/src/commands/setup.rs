//! `turnwright setup`: the setup that a program seems to be written for, as a file to edit.
//!
//! In: a program, with what its setup file and comments say. Out: the whole setup with a comment at each key, what was
//! assumed included.

use std::cell::RefCell;
use std::collections::HashSet;
use std::io::Write;

use turnwright_control::setup_key_words;
use turnwright_verify::{Inference, Inferred};

use crate::arguments::SetupOptions;
use crate::environment::{ProgramText, STANDARD_INPUT};
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::finding::Finding;
use crate::output::WholeFile;
use crate::render::Printer;
use crate::report::assumption_text;
use crate::session::Session;
use crate::speech::Speech;

/// Runs the program and writes its setup.
pub(crate) fn run(options: &SetupOptions, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let mut inference = Inference::new(execution.interpreter().position());
    while let Some(command) = execution.next_command() {
        inference.add(&command);
    }
    let mut inferred = inference.finish(&session.setup);
    inferred.setup.control = Some(session.control.name.to_string());
    // A program that stops half-way shows half of its setup.
    let alarm = execution.alarm_finding();
    if let Some(alarm) = &alarm {
        printer.findings(std::slice::from_ref(alarm), &text);
    }
    let file = setup_file(&inferred, &text.name, speech);
    match options.output.as_deref().filter(|path| path.as_os_str() != STANDARD_INPUT) {
        Some(path) => WholeFile::write(path, file.as_bytes(), speech)?,
        None => {
            let mut out = printer.standard_output();
            out.write_all(file.as_bytes())?;
            out.flush()?;
        }
    }
    Ok(alarm.as_ref().map_or(Status::Clean, Finding::status))
}

/// The setup as a file with comments.
fn setup_file(inferred: &Inferred, program: &str, speech: Speech) -> String {
    // A key is explained where it stands first.
    let explained = RefCell::new(HashSet::new());
    let comment = |section: &str, key: &str| {
        let kind = section.split('.').next().unwrap_or_default();
        let mut lines = Vec::new();
        if let Some(words) = setup_key_words(kind, key, speech.language)
            && explained.borrow_mut().insert((kind.to_string(), key.to_string()))
        {
            lines.push(words.to_string());
        }
        let of_key = inferred.assumptions.iter().filter(|one| one.section == section && one.key == key);
        lines.extend(
            of_key.map(|one| format!("{}: {}", speech.get("assumed-word"), assumption_text(one, speech))),
        );
        lines
    };
    let head = speech.fill("setup-file-head", &[("name", &program.replace(char::is_control, " "))]);
    let head: String = head.lines().map(|line| format!("# {line}\n")).collect();
    format!("{head}\n{}", inferred.setup.to_commented_toml(&comment))
}
