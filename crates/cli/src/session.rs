//! Which control and setup a program meets, and why.
//!
//! The control is that of `--control`, else of the program's own comment `(CONTROL name)`, else of the setup
//! file, else the default. Parameters come from the control, then the setup file, then `--param`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use turnwright_control::{
    Control, ControlFault, DEFAULT_CONTROL, Language, Mode, ParameterFault, Setup, SetupFault, control_names,
    nearest, setup_comment,
};
use turnwright_diagnostics::{Diagnostic, Place, Severity, SourceId};
use turnwright_syntax::{LineEnd, find_line_end};

use crate::arguments::Machine;
use crate::environment::ProgramText;
use crate::finding::{Finding, decode};
use crate::speech::Speech;

/// Lines at the head of a program in which a directive is looked for.
const DIRECTIVE_LINES: u32 = 20;

/// Setup files are written by hand; a larger one is none.
const SETUP_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// Why a control was used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    /// `--control`.
    Option,
    /// The program says so in this line.
    Directive(u32),
    /// The setup file says so.
    Setup,
    /// Nobody said anything.
    Default,
}

impl Reason {
    /// The word of the JSON format.
    pub(crate) const fn word(&self) -> &'static str {
        match self {
            Self::Option => "option",
            Self::Directive(_) => "directive",
            Self::Setup => "setup",
            Self::Default => "default",
        }
    }

    /// The reason in words.
    pub(crate) fn text(&self, speech: Speech) -> String {
        let line = if let Self::Directive(line) = self { line.to_string() } else { String::new() };
        speech.fill(&format!("reason-{}", self.word()), &[("line", &line)])
    }
}

/// What a program meets.
#[derive(Clone, Debug)]
pub(crate) struct Session {
    /// The control, its parameters set.
    pub(crate) control: Control,
    /// Why this one.
    pub(crate) reason: Reason,
    /// The setup.
    pub(crate) setup: Setup,
    /// Its file, if there is one.
    pub(crate) setup_path: Option<PathBuf>,
    /// Comments that look like directives and are none.
    pub(crate) warnings: Vec<Diagnostic>,
}

impl Session {
    /// Chooses control and setup for a program.
    pub(crate) fn choose(text: &ProgramText, options: &Machine, speech: Speech) -> Result<Self, Finding> {
        let mut warnings = Vec::new();
        let (mut setup, setup_path) = find_setup(text, options, speech, &mut warnings)?;
        if options.mdi {
            setup.start.mode = Mode::Mdi;
        }
        let (mut control, reason) = if let Some(name) = &options.control {
            (load_control(name, "", speech)?, Reason::Option)
        } else {
            match directive(text, speech) {
                Directive::Names(name, place) => {
                    (load_control(&name, &text.name, speech)?, Reason::Directive(place.line))
                }
                Directive::Unknown(finding) => return Err(*finding),
                Directive::None(odd) => {
                    warnings.extend(odd);
                    match (&setup.control, &setup_path) {
                        (Some(name), Some(path)) => {
                            (load_control(name, &path.display().to_string(), speech)?, Reason::Setup)
                        }
                        _ => (load_control(DEFAULT_CONTROL, "", speech)?, Reason::Default),
                    }
                }
            }
        };
        let file = setup_path.as_ref().map_or(String::new(), |path| path.display().to_string());
        set_parameters(&mut control, &setup.parameter_words(), &file, speech)?;
        set_parameters(&mut control, &options.parameters, "", speech)?;
        Ok(Self { control, reason, setup, setup_path, warnings })
    }

    /// The machine of the setup, as the parameters limit it.
    pub(crate) fn machine(&self) -> Result<turnwright_control::Machine, Finding> {
        let machine = self.setup.machine().map_err(|fault| self.setup_fault(&fault))?;
        Ok(machine.limited_by(&self.control.parameters))
    }

    /// A setup whose machine or values make no sense.
    pub(crate) fn setup_fault(&self, fault: &SetupFault) -> Finding {
        invalid_setup(self.setup_path.as_deref().unwrap_or(Path::new("--setup")), fault)
    }
}

/// Loads a control named by `file`, or on the command line when that is empty.
pub(crate) fn load_control(name: &str, file: &str, speech: Speech) -> Result<Control, Finding> {
    Control::load(name).map_err(|fault| match fault {
        ControlFault::Unknown { name, nearest } => {
            let known = control_names().join(", ");
            let diagnostic = Diagnostic::error("unknown-control").with("name", name).with("expected", known);
            hinted(Finding::new(file, diagnostic).failed(), nearest, speech)
        }
        ControlFault::Data(why) => Finding::new(file, Diagnostic::error("internal-error").with("value", why)),
    })
}

fn hinted(finding: Finding, nearest: Option<&str>, speech: Speech) -> Finding {
    match nearest {
        Some(name) => finding.with_hint(speech.fill("did-you-mean", &[("name", name)])),
        None => finding,
    }
}

/// Sets parameters that `file` states, or the command line when that is empty.
pub(crate) fn set_parameters(
    control: &mut Control,
    values: &[(String, String)],
    file: &str,
    speech: Speech,
) -> Result<(), Finding> {
    values.iter().try_for_each(|(number, value)| set_parameter(control, number, value, file, speech))
}

fn set_parameter(
    control: &mut Control,
    number: &str,
    value: &str,
    file: &str,
    speech: Speech,
) -> Result<(), Finding> {
    control.parameters.set(number, value).map_err(|fault| match fault {
        ParameterFault::Unknown { number, nearest } => {
            let diagnostic = Diagnostic::error("unknown-parameter").with("parameter", number);
            hinted(Finding::new(file, diagnostic).failed(), nearest.as_deref(), speech)
        }
        ParameterFault::Axis { number, example } => {
            let diagnostic = Diagnostic::error("parameter-axis-missing").with("parameter", number);
            hinted(Finding::new(file, diagnostic).failed(), Some(&example), speech)
        }
        ParameterFault::Value { number, value, expected } => {
            let expected = match speech.language {
                Language::English => expected.to_string(),
                Language::Chinese => {
                    speech.fill(&format!("expected-{}", expected.replace([' ', ','], "-")), &[])
                }
            };
            let diagnostic = Diagnostic::error("parameter-value-illegal")
                .with("parameter", number)
                .with("value", value)
                .with("expected", expected);
            Finding::new(file, diagnostic).failed()
        }
    })
}

/// The setup file that was named, or the one beside the program, and over it what comments of the program say.
fn find_setup(
    text: &ProgramText,
    options: &Machine,
    speech: Speech,
    warnings: &mut Vec<Diagnostic>,
) -> Result<(Setup, Option<PathBuf>), Finding> {
    let beside = || {
        let program = text.path.as_ref()?;
        let beside = program.with_extension("toml");
        (beside != *program && beside.is_file()).then_some(beside)
    };
    let path = options.setup.clone().or_else(beside);
    let content = path.as_deref().map(|path| read_text(path, speech)).transpose()?.unwrap_or_default();
    if let Some(path) = &path {
        parse_setup(path, &content)?;
    }
    let (mut comments, mut places) = (Vec::new(), Vec::new());
    for (place, comment) in head_comments(text) {
        let Some(piece) = setup_comment(&comment) else { continue };
        match piece {
            Ok(piece) => comments.push(piece),
            // A remark that only looks like it must not keep the program from running.
            Err(value) => {
                let mut warning = comment_fault(place, &comment, value);
                warning.severity = Severity::Warning;
                warnings.push(warning);
                continue;
            }
        }
        places.push((place, comment));
    }
    let setup = Setup::with_comments(&content, comments.clone()).map_err(|fault| {
        // The first comment from which on it is wrong in this way.
        let is_wrong = |count: &usize| {
            let some = Setup::with_comments(&content, comments[..*count].to_vec());
            some.is_err_and(|other| other.message == fault.message)
        };
        let to_blame = (1..=comments.len()).find(is_wrong).and_then(|count| places.get(count - 1));
        match to_blame {
            Some((place, comment)) => {
                let fault = comment_fault(*place, comment, fault.message);
                Finding::new(text.name.as_str(), fault).failed().located(text)
            }
            None => invalid_setup(path.as_deref().unwrap_or(Path::new("--setup")), &fault),
        }
    })?;
    Ok((setup, path))
}

/// A comment about the setup that cannot be.
fn comment_fault(place: Place, comment: &str, value: String) -> Diagnostic {
    let diagnostic = Diagnostic::error("setup-comment-invalid").at(place);
    diagnostic.with("word", format!("({})", comment.trim())).with("value", value)
}

/// The comments at the head of a program that may be about its setup, with their places.
fn head_comments(text: &ProgramText) -> Vec<(Place, String)> {
    let head = text.head();
    if !head.windows(5).any(|word| word.eq_ignore_ascii_case(b"SETUP")) {
        return Vec::new();
    }
    let mut found = Vec::new();
    let (mut start, mut line) = (0, 1);
    while start < head.len() {
        let rest = &head[start..];
        let end = find_line_end(rest, true).unwrap_or(LineEnd { start: rest.len(), next: rest.len() });
        for (from, to, comment) in comments(&rest[..end.start]) {
            let (column, end_column) = (from as u32 + 1, to as u32 + 1);
            let place = Place { source: SourceId(0), line, line_offset: start as u64, column, end_column };
            found.push((place, comment));
        }
        start += end.next.max(1);
        line += 1;
    }
    found
}

/// Reads a setup file.
pub(crate) fn read_setup(path: &Path, speech: Speech) -> Result<Setup, Finding> {
    parse_setup(path, &read_text(path, speech)?)
}

fn parse_setup(path: &Path, content: &str) -> Result<Setup, Finding> {
    Setup::parse(content).map_err(|fault| {
        let text = ProgramText::in_memory(path.display().to_string(), content.as_bytes());
        invalid_setup(path, &fault).located(&text)
    })
}

/// The text of a setup file.
fn read_text(path: &Path, speech: Speech) -> Result<String, Finding> {
    let name = path.display().to_string();
    let unusable = |value: String| {
        let diagnostic = Diagnostic::error("setup-invalid").with("name", name.as_str()).with("value", value);
        Finding::new(name.as_str(), diagnostic).failed()
    };
    match fs::metadata(path) {
        Ok(metadata) if metadata.len() > SETUP_BYTES_MAX => {
            Err(unusable(format!("> {} MiB", SETUP_BYTES_MAX >> 20)))
        }
        Ok(_) => fs::read_to_string(path).map_err(|error| unusable(speech.system(&error))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let diagnostic = Diagnostic::error("setup-not-found").with("name", name.as_str());
            Err(Finding::new(name.as_str(), diagnostic).failed())
        }
        Err(error) => Err(unusable(speech.system(&error))),
    }
}

/// A setup file that makes no sense.
pub(crate) fn invalid_setup(path: &Path, fault: &SetupFault) -> Finding {
    let name = path.display().to_string();
    let diagnostic =
        Diagnostic::error("setup-invalid").with("name", name.as_str()).with("value", fault.message.as_str());
    let place =
        Place { line: fault.line, line_offset: u64::MAX, column: 1, end_column: 1, source: SourceId(0) };
    let diagnostic = if fault.line > 0 { diagnostic.at(place) } else { diagnostic };
    Finding::new(name, diagnostic).failed()
}

/// What the head of a program says about its control.
enum Directive {
    /// A control that exists.
    Names(String, Place),
    /// Clearly a directive, with a name that does not exist.
    Unknown(Box<Finding>),
    /// Nothing, or only a comment that reminds of a directive.
    None(Option<Diagnostic>),
}

fn directive(text: &ProgramText, speech: Speech) -> Directive {
    let mut odd = None;
    let head = text.head();
    let mut start = 0;
    for line_number in 1..=DIRECTIVE_LINES {
        let rest = &head[start..];
        let end = find_line_end(rest, true).unwrap_or(LineEnd { start: rest.len(), next: rest.len() });
        let place = |from: usize, to: usize| Place {
            source: SourceId(0),
            line: line_number,
            line_offset: start as u64,
            column: from as u32 + 1,
            end_column: to as u32 + 1,
        };
        for (from, to, comment) in comments(&rest[..end.start]) {
            let Some((keyword, name)) = split_directive(&comment) else { continue };
            if Control::load(&name).is_ok() {
                return Directive::Names(name, place(from, to));
            }
            let word = format!("({comment})");
            let near = nearest(&name, control_names());
            let diagnostic = |severity: fn(&'static str) -> Diagnostic| {
                severity("directive-unknown").at(place(from, to)).with("word", word.clone())
            };
            let is_one_word = !name.contains(' ');
            if near.is_some() || (keyword == "CONTROL" && is_one_word) {
                let finding = Finding::new(text.name.as_str(), diagnostic(Diagnostic::error));
                let hint = match near {
                    Some(name) => speech.fill("did-you-mean", &[("name", name)]),
                    None => control_names().join(", "),
                };
                return Directive::Unknown(Box::new(finding.with_hint(hint).located(text)));
            }
            if keyword == "CONTROL" && odd.is_none() {
                odd = Some(diagnostic(Diagnostic::warning));
            }
        }
        start += end.next;
    }
    Directive::None(odd)
}

/// The comments of a line: first byte, first byte behind, and what is between the brackets.
fn comments(line: &[u8]) -> Vec<(usize, usize, String)> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(open) = line[at..].iter().position(|byte| *byte == b'(') {
        let from = at + open;
        let Some(close) = line[from..].iter().position(|byte| *byte == b')') else { break };
        found.push((from, from + close + 1, decode(&line[from + 1..from + close])));
        at = from + close + 1;
    }
    found
}

/// Keyword and name of a comment such as `CONTROL fanuc-0i-tf`, `PROFILE: gsk-980tdi`.
fn split_directive(comment: &str) -> Option<(&'static str, String)> {
    let comment = comment.trim();
    let keyword = ["CONTROL", "PROFILE"].into_iter().find(|keyword| {
        comment.get(..keyword.len()).is_some_and(|head| head.eq_ignore_ascii_case(keyword))
    })?;
    let rest = &comment[keyword.len()..];
    let name = rest.trim_start_matches([' ', '\t', ':', '=']);
    (name.len() < rest.len() && !name.is_empty()).then(|| (keyword, name.trim().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directives_are_read_in_any_case_and_other_comments_are_not() {
        assert_eq!(split_directive("Control gsk-980tdi"), Some(("CONTROL", "gsk-980tdi".to_string())));
        assert_eq!(split_directive(" PROFILE: X "), Some(("PROFILE", "X".to_string())));
        assert_eq!(split_directive("CONTROLLED DRILL"), None);
        assert_eq!(split_directive("CONTROL"), None);
        let found = comments(b"O1 (A) (CONTROL B) (open");
        assert_eq!(found, [(3, 6, "A".to_string()), (7, 18, "CONTROL B".to_string())]);
    }
}
