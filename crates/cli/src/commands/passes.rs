//! `turnwright explain FILE --line N`: every pass of the cycle that a line runs, and which word or parameter caused it.
//!
//! The program runs up to the first time that its line N runs a cycle. With `--output` the cycle is drawn, its passes
//! numbered where they begin.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use serde_json::{Value, json};
use turnwright_canon::Command;
use turnwright_control::{Machine, Parameters};
use turnwright_export::formats::svg::{Mark, PictureOptions, write_svg};
use turnwright_export::passes::{Cause, Cycle};
use turnwright_units::{Length, Position, WorkTip, write_millimetres};

use super::plot::write_picture;
use crate::arguments::{Explain, LookupFormat};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::passes::{Passes, cause_text, setting_name, source_of};
use crate::rates::rates;
use crate::render::{Printer, clean};
use crate::report::{Kept, Measure, picture_language};
use crate::session::Session;
use crate::speech::Speech;
use crate::table::{Side, Table, facts, heading};

/// Shows the passes.
pub(super) fn run(options: &Explain, line: u32, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(options.code.as_ref(), speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let Some((cycle, parameters)) = find(&mut execution, line) else {
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
    let block = clean(String::from_utf8_lossy(&block).trim()).to_string();
    let shown = Shown { cycle: &cycle, parameters, decimals: execution.interpreter().decimals(), speech };
    if let Some(target) = &options.output {
        let machine = session.machine()?;
        let again = Execution::new(&text, &session, &options.machine)?;
        let title = format!("{} {}{}{block}", cycle.label, shown.in_line(line), speech.get("colon"));
        draw(target, again, &cycle, &machine, title, speech)?;
    }
    let out = match options.format {
        LookupFormat::Human => shown.human(line, &block),
        LookupFormat::Json => format!("{}\n", shown.json(line)),
    };
    let mut standard = printer.standard_output();
    standard.write_all(out.as_bytes())?;
    standard.flush()?;
    Ok(Status::Clean)
}

/// Runs the program until the line has run a cycle once; the parameters are those of that moment.
fn find(execution: &mut Execution<'_>, line: u32) -> Option<(Cycle, Parameters)> {
    let of_line = |cycle: &Cycle| if cycle.source == 0 { cycle.of_line(line) } else { None };
    let mut passes = Passes::new(execution);
    let mut seen = 0;
    while let Some(command) = execution.next_command() {
        passes.add(&command, execution);
        if let Some(cycle) = passes.cycles()[seen..].iter().find_map(of_line) {
            return Some((cycle, execution.interpreter().parameters()));
        }
        seen = passes.cycles().len();
    }
    let (cycles, _) = passes.finish();
    let cycle = cycles.iter().find_map(of_line)?;
    Some((cycle, execution.interpreter().parameters()))
}

/// Draws the commands of a cycle.
fn draw(
    target: &Path,
    mut execution: Execution<'_>,
    cycle: &Cycle,
    machine: &Machine,
    title: String,
    speech: Speech,
) -> Result<(), Fault> {
    let rates = rates(machine, &execution.interpreter().parameters(), false);
    let mut drawn = Measure::new(cycle.start, rates, Kept { path: true, ..Kept::default() });
    let Range { start, end } = cycle.commands;
    let line = |command: &Command| command.origin.line;
    let is_of_pass = |command: &Command| cycle.passes.iter().any(|pass| pass.line == line(command));
    for index in 0..end {
        let Some(command) = execution.next_command() else { break };
        if index >= start && is_of_pass(&command) {
            drawn.add(command, None);
        }
    }
    drawn.finish();
    let Some(path) = drawn.path else { return Ok(()) };
    let marks = cycle.passes.iter().map(|pass| Mark::new(pass.from, pass.number.to_string())).collect();
    let language = picture_language(speech.language);
    let options = PictureOptions { title, language, marks, ..PictureOptions::default() };
    write_picture(target, &write_svg(&path, &options), speech)?;
    Ok(())
}

/// Headings of the table.
const COLUMNS: [&str; 8] = [
    "pass-number",
    "pass-phase",
    "pass-depth",
    "pass-from-x",
    "pass-from-z",
    "pass-to-x",
    "pass-to-z",
    "pass-cause",
];

/// A cycle as it is shown.
struct Shown<'a> {
    cycle: &'a Cycle,
    parameters: Parameters,
    decimals: u8,
    speech: Speech,
}

impl Shown<'_> {
    fn length(&self, length: Length) -> String {
        let mut out = Vec::new();
        write_millimetres(&mut out, length, self.decimals);
        String::from_utf8_lossy(&out).into_owned()
    }

    fn in_line(&self, line: u32) -> String {
        self.speech.fill("pass-line", &[("line", &line.to_string())])
    }

    fn causes(&self, causes: &[Cause]) -> String {
        let causes: Vec<String> = causes.iter().map(|cause| cause_text(cause, self.speech)).collect();
        causes.join(self.speech.get("pass-cause-separator"))
    }

    fn human(&self, line: u32, block: &str) -> String {
        let (cycle, speech) = (self.cycle, self.speech);
        let entry = speech.functions().get(&cycle.function);
        let name = entry.map_or(String::new(), |entry| entry.name(speech.language).to_string());
        let mut out = format!("{}\n", heading(&format!("{}  {name}", cycle.label)));
        out.push_str(&format!("  {}{}{block}\n", self.in_line(line), speech.get("colon")));
        let given: Vec<(String, String)> = cycle
            .settings
            .iter()
            .map(|setting| {
                let source = cause_text(&source_of(setting), speech);
                (setting_name(setting, &self.parameters, speech), format!("{}  {source}", setting.value))
            })
            .collect();
        out.push_str(&facts(&given));
        let (left, right) = (Side::Left, Side::Right);
        let mut table = Table::new(&[right, left, right, right, right, right, right, left]);
        table.row(COLUMNS.map(|key| speech.get(key)));
        for pass in &cycle.passes {
            table.row([
                pass.number.to_string(),
                speech.find(&format!("phase-{}", pass.phase.word())).to_string(),
                self.length(pass.depth),
                self.length(pass.from.x.to_diameter().0),
                self.length(pass.from.z),
                self.length(pass.to.x.to_diameter().0),
                self.length(pass.to.z),
                self.causes(&pass.causes),
            ]);
        }
        out + &table.text(2, true)
    }

    fn json(&self, line: u32) -> Value {
        let cycle = self.cycle;
        let place =
            |place: Position<WorkTip>| json!({ "x": place.x.to_diameter().0.to_mm(), "z": place.z.to_mm() });
        let parameters: Vec<Value> = cycle
            .settings
            .iter()
            .map(|setting| {
                json!({
                    "name": setting.name,
                    "number": setting.number,
                    "value": setting.value,
                    "word": setting.given.as_ref().map(|given| &given.text),
                    "line": setting.given.as_ref().map(|given| given.line),
                })
            })
            .collect();
        let passes: Vec<Value> = cycle
            .passes
            .iter()
            .map(|pass| {
                let figure = pass.causes.iter().find_map(|cause| match cause {
                    Cause::Figure(first, last) => Some([first, last]),
                    Cause::Word(_) | Cause::Parameter(_) => None,
                });
                json!({
                    "pass": pass.number,
                    "phase": pass.phase.word(),
                    "depth": pass.depth.to_mm(),
                    "from": place(pass.from),
                    "to": place(pass.to),
                    "figure_lines": figure,
                    "cause": self.causes(&pass.causes),
                })
            })
            .collect();
        json!({
            "line": line,
            "cycle": cycle.label.to_string(),
            "name": cycle.function,
            "start": place(cycle.start),
            "parameters": parameters,
            "passes": passes,
        })
    }
}
