//! Diagnostics for people. The only place that knows the library that draws them.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::io::{self, Write as _};

use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};
use anstream::{AutoStream, ColorChoice};
use turnwright_control::Language;
use turnwright_diagnostics::{Diagnostic, Severity};

use crate::arguments::{Arguments, Colour, Format};
use crate::environment::ProgramText;
use crate::finding::{Finding, Spot};
use crate::output::sarif;
use crate::speech::Speech;

/// Says things on the terminal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Printer {
    /// The words.
    pub(crate) speech: Speech,
    colour: Colour,
}

impl Printer {
    /// A printer for the options of the command line.
    pub(crate) fn new(arguments: &Arguments) -> Self {
        let presentation = &arguments.presentation;
        Self { speech: Speech::new(presentation.lang), colour: presentation.color }
    }

    /// Standard output, through which colours go only when they are wanted.
    pub(crate) fn standard_output(&self) -> AutoStream<io::StdoutLock<'static>> {
        AutoStream::new(io::stdout().lock(), self.choice(&io::stdout()))
    }

    fn choice(&self, stream: &impl anstream::stream::RawStream) -> ColorChoice {
        match self.colour {
            Colour::Auto => AutoStream::choice(stream),
            Colour::Always => ColorChoice::Always,
            Colour::Never => ColorChoice::Never,
        }
    }

    /// Text to standard error. Nothing can be done when nobody listens there.
    pub(crate) fn say(&self, text: &str) {
        let choice = self.choice(&io::stderr());
        let _ = AutoStream::new(io::stderr().lock(), choice).write_all(text.as_bytes());
    }

    /// A finding to standard error.
    pub(crate) fn finding(&self, finding: &Finding, text: Option<&ProgramText>) {
        self.say(&self.human_all([finding], text));
    }

    /// The findings of one program to standard error; what a finding means is said the first time only.
    pub(crate) fn findings(&self, findings: &[Finding], text: &ProgramText) {
        self.say(&self.human_all(findings, Some(text)));
    }

    /// The option for colours.
    pub(crate) const fn colour(&self) -> Colour {
        self.colour
    }

    /// Findings as text; cause and cure of a key are given once.
    pub(crate) fn human_all<'a>(
        &self,
        findings: impl IntoIterator<Item = &'a Finding>,
        text: Option<&ProgramText>,
    ) -> String {
        let mut explained = HashSet::new();
        let mut out = String::new();
        for finding in findings {
            let is_new = explained.insert(finding.diagnostic.key);
            // What is wrong with a setup file is not in the program's text.
            let text = text.filter(|text| text.name == finding.file);
            out.push_str(&self.drawn(finding, text, is_new));
        }
        out
    }

    /// What keeps a command from doing anything, in the form that was asked for.
    pub(crate) fn refuse(&self, finding: &Finding, format: Format) -> io::Result<()> {
        let (messages, language) = (self.speech.messages(), self.speech.language);
        let line = match format {
            Format::Human => {
                self.finding(finding, None);
                return Ok(());
            }
            Format::Json => finding.to_json_line(messages, language, finding.spot(None).as_ref()),
            Format::Sarif => sarif::document(&[sarif::result(finding, self.speech, None)], self.speech),
        };
        let mut out = io::stdout().lock();
        writeln!(out, "{line}")?;
        out.flush()
    }

    /// A finding as text with colours, ending in an empty line.
    fn drawn(&self, finding: &Finding, text: Option<&ProgramText>, explains: bool) -> String {
        let speech = self.speech;
        let words = finding.words(speech.messages(), speech.language);
        let (message, cause, remedy) = (clean(&words.message), clean(&words.cause), clean(&words.remedy));
        let id = clean(&finding.id(speech.messages()));
        let file = clean(&finding.file);
        let spot = finding.spot(text);
        let shown = spot.as_ref().map(Shown::new);
        let related: Vec<_> = related(finding, text, speech);
        let mut group = Group::with_title(
            level(finding.diagnostic.severity, speech).primary_title(message.as_str()).id(id.as_str()),
        );
        let (here, elsewhere): (Vec<_>, Vec<_>) = related
            .iter()
            .partition(|(other, _)| shown.as_ref().is_some_and(|shown| shown.line == other.line));
        if let Some(shown) = &shown {
            group = group.element(shown.element(&file, None, AnnotationKind::Primary, &here));
        } else if !file.is_empty() {
            group = group.element(Origin::path(file.as_str()));
        }
        for (shown, label) in elsewhere {
            group = group.element(shown.element(&file, Some(label), AnnotationKind::Context, &[]));
        }
        let mut notes: Vec<(&str, String)> = Vec::new();
        for call in finding.diagnostic.trace.iter().rev() {
            notes.push(("label-call", called_from(call.program, call.line, speech)));
        }
        if explains {
            notes.push(("label-cause", cause));
            notes.push(("label-cure", remedy));
        }
        if let Some(hint) = &finding.hint {
            notes.push(("label-hint", clean(hint)));
        }
        if let Some(picture) = &finding.picture {
            notes.push(("label-picture", clean(picture)));
        }
        let group = notes.iter().filter(|(_, text)| !text.is_empty()).fold(group, |group, (label, text)| {
            group.element(Level::NOTE.with_name(speech.get(label)).message(text.as_str()))
        });
        let renderer = Renderer::styled();
        let mut out = renderer.render(&[group]);
        out.push_str("\n\n");
        out
    }
}

/// The other places of a finding and what they are.
fn related(finding: &Finding, text: Option<&ProgramText>, speech: Speech) -> Vec<(Shown, String)> {
    let of_same_text = |source| finding.diagnostic.place.is_none_or(|place| place.source == source);
    finding
        .diagnostic
        .related
        .iter()
        .filter(|other| of_same_text(other.place.source))
        .map(|other| {
            let label = if other.key == finding.diagnostic.key {
                String::new()
            } else {
                let mut note = Diagnostic::new(Severity::Note, other.key);
                note.arguments.clone_from(&finding.diagnostic.arguments);
                clean(&speech.messages().text(&note, speech.language).message)
            };
            (Shown::new(&Spot::new(&other.place, text)), label)
        })
        .collect()
}

fn called_from(program: u32, line: u32, speech: Speech) -> String {
    let line = line.to_string();
    if program == 0 {
        speech.fill("call-line", &[("line", &line)])
    } else {
        speech.fill("call", &[("program", &format!("O{program:04}")), ("line", &line)])
    }
}

fn level(severity: Severity, speech: Speech) -> Level<'static> {
    let (level, english, chinese) = match severity {
        Severity::Alarm => (Level::ERROR, "alarm", "severity-alarm"),
        Severity::Error => (Level::ERROR, "error", "severity-error"),
        Severity::Warning => (Level::WARNING, "warning", "severity-warning"),
        Severity::Note => (Level::NOTE, "note", "severity-note"),
    };
    match speech.language {
        Language::English => level.with_name(english),
        Language::Chinese => level.with_name(speech.get(chinese).to_string()),
    }
}

/// A line with a place in it.
struct Shown {
    line: usize,
    column: usize,
    text: String,
    span: std::ops::Range<usize>,
}

impl Shown {
    fn new(spot: &Spot) -> Self {
        let (line, column) = (spot.line as usize, spot.column as usize);
        Self { line, column, text: spot.text.clone(), span: spot.span.clone() }
    }

    /// The line, the place underlined, and other places in the same line. Long lines are shown in part.
    fn element<'a>(
        &'a self,
        file: &'a str,
        label: Option<&'a String>,
        kind: AnnotationKind,
        others: &[&'a (Self, String)],
    ) -> Element<'a> {
        if self.text.is_empty() {
            return Origin::path(file).line(self.line).char_column(self.column).into();
        }
        let label = label.filter(|label| !label.is_empty()).map(String::as_str);
        let others = others.iter().filter(|(_, label)| !label.is_empty());
        Snippet::source(self.text.as_str())
            .path(file)
            .line_start(self.line)
            .annotation(kind.span(self.span.clone()).label(label))
            .annotations(
                others.map(|(other, label)| {
                    AnnotationKind::Context.span(other.span.clone()).label(label.as_str())
                }),
            )
            .into()
    }
}

/// Text of a program or a system without anything that could steer a terminal.
pub(crate) fn clean(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() {
            let _ = write!(out, "{}", character.escape_default());
        } else {
            out.push(character);
        }
    }
    out
}
