//! `turnwright explain FILE --line N`: every pass of the cycle that a line runs, and which word or parameter caused it.
//!
//! The program runs up to the first time that its line N runs a cycle. A pass goes from where its first cut begins to
//! where its last one ends; its depth is counted from the start point of the cycle, along X as a radius.

use std::io::Write;

use serde_json::{Value, json};
use turnwright_canon::{Command, CycleLabel, Phase};
use turnwright_control::Parameters;
use turnwright_interpreter::GivenParameter;
use turnwright_syntax::{Block, scan_block};
use turnwright_units::{Length, Position, WorkTip, write_millimetres};

use crate::arguments::{Explain, LookupFormat};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::render::{Printer, clean};
use crate::report::code_system;
use crate::session::Session;
use crate::speech::Speech;
use crate::table::{Side, Table, facts, heading};

/// The parameters that a cycle takes what its block does not say from; the first gives its depth.
const PARAMETERS: [(&str, &[&str]); 6] = [
    ("rough-turning", &["cycle-depth-of-cut", "cycle-escape", "cycle-clearance"]),
    ("rough-facing", &["cycle-depth-of-cut", "cycle-escape", "cycle-clearance"]),
    ("pattern-repeating", &["pattern-relief-x", "pattern-relief-z", "pattern-passes"]),
    ("face-groove", &["groove-return"]),
    ("radial-groove", &["groove-return"]),
    (
        "multi-thread",
        &[
            "thread-minimum-depth",
            "thread-finishing-allowance",
            "thread-finishing-passes",
            "thread-nose-angle",
        ],
    ),
];

/// A cycle that ran.
struct Cycle {
    label: CycleLabel,
    name: String,
    start: Position<WorkTip>,
    passes: Vec<Pass>,
    parameters: Parameters,
    given: Vec<GivenParameter>,
}

/// One pass.
struct Pass {
    number: u32,
    phase: Phase,
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    /// Lines of the figure that gave it its shape or ended it, first and last.
    figure: Option<(u32, u32)>,
}

/// Shows the passes.
pub(super) fn run(options: &Explain, line: u32, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(options.code.as_ref(), speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let Some(cycle) = find(&mut execution, line) else {
        let findings: Vec<_> = execution.alarm_finding().into_iter().collect();
        if findings.is_empty() {
            return Err(Fault::Usage(speech.fill("no-cycle-in-line", &[("line", &line.to_string())])));
        }
        for finding in &findings {
            printer.finding(finding, Some(&text));
        }
        return Ok(Status::Found);
    };
    let block = text.offset_of_line(line).map(|offset| text.line_at(offset)).unwrap_or_default();
    let shown =
        Shown { cycle: &cycle, words: words(&block), decimals: execution.interpreter().decimals(), speech };
    let out = match options.format {
        LookupFormat::Human => shown.human(line, &String::from_utf8_lossy(&block), code_name(&cycle, speech)),
        LookupFormat::Json => format!("{}\n", shown.json(line)),
    };
    let mut standard = printer.standard_output();
    standard.write_all(out.as_bytes())?;
    standard.flush()?;
    Ok(Status::Clean)
}

fn code_name(cycle: &Cycle, speech: Speech) -> String {
    let entry = speech.functions().get(&cycle.name);
    entry.map_or(String::new(), |entry| entry.name(speech.language).to_string())
}

/// Runs the program until the line has run a cycle once.
fn find(execution: &mut Execution<'_>, line: u32) -> Option<Cycle> {
    let mut at = execution.interpreter().position();
    let mut cycle: Option<Cycle> = None;
    while let Some(command) = execution.next_command() {
        let origin = command.origin;
        match origin.cycle.filter(|_| origin.source == 0 && origin.line == line) {
            Some(made) => {
                let is_again = cycle
                    .as_ref()
                    .and_then(|cycle| cycle.passes.last())
                    .is_some_and(|last| made.pass < last.number || (made.pass == 0 && last.number > 0));
                if is_again {
                    break;
                }
                let cycle = cycle.get_or_insert_with(|| begun(execution, made.label, at));
                if let Some(to) = command.action.end_point() {
                    cycle.add(&command, made.pass, made.phase, at, to);
                }
            }
            None if cycle.is_some() => break,
            None => {}
        }
        at = command.action.end_point().unwrap_or(at);
    }
    cycle
}

fn begun(execution: &Execution<'_>, label: CycleLabel, start: Position<WorkTip>) -> Cycle {
    let interpreter = execution.interpreter();
    let control = interpreter.control();
    let functions = turnwright_control::Functions::load();
    let entry = functions.by_code(label.0, code_system(control), control.code_table);
    Cycle {
        label,
        name: entry.map_or(String::new(), |(name, _)| name.to_string()),
        start,
        passes: Vec::new(),
        parameters: interpreter.parameters(),
        given: interpreter.given_parameters().to_vec(),
    }
}

impl Cycle {
    fn add(
        &mut self,
        command: &Command,
        pass: u32,
        phase: Phase,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
    ) {
        let cuts = matches!(
            phase,
            Phase::Cut | Phase::Contour | Phase::Finish | Phase::Peck | Phase::Thread | Phase::Chamfer
        );
        if !cuts {
            return;
        }
        let line = command.origin.figure_line;
        match self.passes.last_mut().filter(|last| last.number == pass) {
            Some(last) => {
                last.to = to;
                last.figure = match (last.figure, line) {
                    (Some((first, _)), Some(line)) => Some((first, line)),
                    (figure, line) => figure.or(line.map(|line| (line, line))),
                };
            }
            None => self.passes.push(Pass {
                number: pass,
                phase,
                from,
                to,
                figure: line.map(|line| (line, line)),
            }),
        }
    }

    fn parameters(&self) -> &'static [&'static str] {
        PARAMETERS.iter().find(|(name, _)| *name == self.name).map_or(&[], |(_, parameters)| parameters)
    }

    /// Depth of a pass below the start point.
    fn depth(&self, pass: &Pass) -> Length {
        let way = pass.from - self.start;
        let is_along_z = self.name.contains("facing") || self.name.starts_with("face-");
        if is_along_z { way.z.abs() } else { way.x.0.abs() }
    }
}

/// The words of a block: letter and text.
fn words(block: &[u8]) -> Vec<(u8, String)> {
    let mut scanned = Block::new();
    scan_block(block, 0, &mut scanned);
    let text = |start: u32, end: u32| block.get(start as usize..end as usize).unwrap_or_default();
    scanned
        .words
        .iter()
        .map(|word| (word.address, String::from_utf8_lossy(text(word.start, word.end)).into_owned()))
        .collect()
}

/// A cycle as it is shown.
struct Shown<'a> {
    cycle: &'a Cycle,
    words: Vec<(u8, String)>,
    decimals: u8,
    speech: Speech,
}

impl Shown<'_> {
    fn word(&self, letter: u8) -> Option<&str> {
        self.words.iter().find(|(address, _)| *address == letter).map(|(_, text)| text.as_str())
    }

    fn length(&self, length: Length) -> String {
        let mut out = Vec::new();
        write_millimetres(&mut out, length, self.decimals);
        String::from_utf8_lossy(&out).into_owned()
    }

    /// The word that gave a parameter its value, else its number.
    fn source(&self, parameter: &str) -> String {
        if let Some(given) = self.cycle.given.iter().find(|given| given.parameter == parameter) {
            return self.in_line(&given.word, given.line);
        }
        let number = self.cycle.parameters.number(parameter).unwrap_or_else(|| parameter.to_string());
        self.speech.fill("pass-by-parameter", &[("number", &number)])
    }

    fn in_line(&self, word: &str, line: u32) -> String {
        self.speech.fill("pass-by-word", &[("word", word), ("line", &line.to_string())])
    }

    /// What caused a pass.
    fn cause(&self, index: usize, line: u32) -> String {
        let pass = &self.cycle.passes[index];
        let own = |letter: u8| self.word(letter).map(|word| self.in_line(word, line));
        let depth = match (self.cycle.name.as_str(), pass.phase) {
            ("rough-turning" | "rough-facing", Phase::Cut) => {
                own(b'D').or_else(|| Some(self.source("cycle-depth-of-cut")))
            }
            ("pattern-repeating", _) => own(b'D').or_else(|| Some(self.source("pattern-passes"))),
            ("multi-thread", _) => self.thread_cause(index, line),
            ("face-groove" | "radial-groove", _) => {
                own(if self.cycle.name == "face-groove" { b'Q' } else { b'P' })
            }
            _ => None,
        };
        let figure = pass.figure.map(|(first, last)| {
            let key = if first == last { "pass-by-figure-line" } else { "pass-by-figure-lines" };
            self.speech.fill(key, &[("first", &first.to_string()), ("last", &last.to_string())])
        });
        let causes: Vec<String> = depth.into_iter().chain(figure).collect();
        causes.join(self.speech.get("pass-cause-separator"))
    }

    /// Depths fall by the first one, not below the least one, and end at the height.
    fn thread_cause(&self, index: usize, line: u32) -> Option<String> {
        let depth = |index: usize| self.cycle.depth(&self.cycle.passes[index]);
        let (this, last) = (depth(index), depth(self.cycle.passes.len() - 1));
        let own = |letter: u8| self.word(letter).map(|word| self.in_line(word, line));
        let before = if index == 0 { Length::ZERO } else { depth(index - 1) };
        let least = (self.cycle.parameters.value("thread-minimum-depth") * 1e6).round() as i64;
        if index == 0 {
            own(b'Q')
        } else if this == before {
            Some(self.source("thread-finishing-passes"))
        } else if this == last {
            own(b'P')
        } else if ((this - before).nm() - least).abs() <= 1_000 {
            Some(self.source("thread-minimum-depth"))
        } else {
            own(b'Q')
        }
    }

    fn human(&self, line: u32, block: &str, name: String) -> String {
        let cycle = self.cycle;
        let mut out = format!("{}\n", heading(&format!("{}  {name}", cycle.label)));
        out.push_str(&format!(
            "  {}{}{}\n",
            self.speech.fill("pass-line", &[("line", &line.to_string())]),
            self.speech.get("colon"),
            clean(block.trim())
        ));
        let given: Vec<(String, String)> = cycle
            .parameters()
            .iter()
            .filter(|name| cycle.parameters.number(name).is_some())
            .map(|name| {
                (self.title(name), format!("{}  {}", cycle.parameters.value(name), self.source(name)))
            })
            .collect();
        out.push_str(&facts(&given));
        let mut table = Table::new(&[
            Side::Right,
            Side::Left,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Left,
        ]);
        let speech = self.speech;
        table.row(
            [
                "pass-number",
                "pass-phase",
                "pass-depth",
                "pass-from-x",
                "pass-from-z",
                "pass-to-x",
                "pass-to-z",
                "pass-cause",
            ]
            .map(|key| speech.get(key)),
        );
        for (index, pass) in cycle.passes.iter().enumerate() {
            table.row([
                pass.number.to_string(),
                speech.find(&format!("phase-{}", pass.phase.word())).to_string(),
                self.length(cycle.depth(pass)),
                self.length(pass.from.x.to_diameter().0),
                self.length(pass.from.z),
                self.length(pass.to.x.to_diameter().0),
                self.length(pass.to.z),
                self.cause(index, line),
            ]);
        }
        out + &table.text(2, true)
    }

    fn title(&self, parameter: &str) -> String {
        let number = self.cycle.parameters.number(parameter).unwrap_or_default();
        let found = self.cycle.parameters.find(&number);
        found.map_or(number, |(_, parameter, _)| parameter.name(self.speech.language).to_string())
    }

    fn json(&self, line: u32) -> Value {
        let cycle = self.cycle;
        let place =
            |place: Position<WorkTip>| json!({ "x": place.x.to_diameter().0.to_mm(), "z": place.z.to_mm() });
        let parameters: Vec<Value> = cycle
            .parameters()
            .iter()
            .filter_map(|name| {
                let given = cycle.given.iter().find(|given| given.parameter == *name);
                Some(json!({
                    "name": name,
                    "number": cycle.parameters.number(name)?,
                    "value": cycle.parameters.value(name),
                    "word": given.map(|given| &given.word),
                    "line": given.map(|given| given.line),
                }))
            })
            .collect();
        let passes: Vec<Value> = cycle
            .passes
            .iter()
            .enumerate()
            .map(|(index, pass)| {
                json!({
                    "pass": pass.number,
                    "phase": pass.phase.word(),
                    "depth": cycle.depth(pass).to_mm(),
                    "from": place(pass.from),
                    "to": place(pass.to),
                    "figure_lines": pass.figure.map(|(first, last)| [first, last]),
                    "cause": self.cause(index, line),
                })
            })
            .collect();
        json!({
            "line": line,
            "cycle": cycle.label.to_string(),
            "name": cycle.name,
            "start": place(cycle.start),
            "parameters": parameters,
            "passes": passes,
        })
    }
}
