//! `turnwright data`: offsets, work zeros and parameters of a setup file, shown, read from the control's own text
//! form and written in it.
//!
//! The forms themselves are the libraries' (`turnwright_control::ParameterLine`, `turnwright_interpreter::import_data`);
//! here files are read and written and things are said.

use std::fs;
use std::io::Write;
use std::path::Path;

use serde_json::{Map, Value, json};
use turnwright_control::{
    Axis, Control, DEFAULT_CONTROL, Language, OffsetRow, ParameterImport, Setup, ZeroRow, export_parameters,
};
use turnwright_diagnostics::Diagnostic;
use turnwright_interpreter::{DataFault, export_offsets, export_work_zeros, import_data};

use crate::arguments::{Data, Export, LookupFormat};
use crate::environment::{ProgramText, unreadable};
use crate::fault::{Fault, Status};
use crate::finding::Finding;
use crate::output::file::WholeFile;
use crate::render::Printer;
use crate::session::{invalid_setup, load_control, read_setup, set_parameters};
use crate::speech::Speech;
use crate::table::{Side, Table, heading};

/// Texts of controls are short; a larger file is none.
const TEXT_BYTES_MAX: u64 = 64 * 1024 * 1024;

/// Shows, reads or writes.
pub(crate) fn run(options: &Data, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let mut setup = match &options.setup {
        Some(path) => read_setup(path, speech)?,
        None => Setup::default(),
    };
    let setup_name = options.setup.as_ref().map_or(String::new(), |path| path.display().to_string());
    let mut control = match (&options.control, &setup.control) {
        (Some(name), _) => load_control(name, "", speech)?,
        (None, Some(name)) => load_control(name, &setup_name, speech)?,
        (None, None) => load_control(DEFAULT_CONTROL, "", speech)?,
    };
    set_parameters(&mut control, &setup.parameter_words(), &setup_name, speech)?;
    let place = Place { setup: options.setup.as_deref(), speech };
    for path in &options.import {
        take_in(path, &mut control, &mut setup, &place, printer)?;
    }
    if !options.import.is_empty() {
        setup.control = Some(control.name.to_string());
    }
    let answer = match (options.export, &options.output, options.format) {
        (Some(what), ..) => text_of(what, &control, &setup, &place, printer)?,
        (None, Some(_), _) => setup.to_toml(),
        (None, None, LookupFormat::Human) => human(&control, &setup, speech),
        (None, None, LookupFormat::Json) => format!("{}\n", as_json(&control, &setup, speech)),
    };
    match &options.output {
        Some(path) if path.as_os_str() != "-" => WholeFile::write(path, answer.as_bytes(), speech)?,
        _ => {
            let mut out = printer.standard_output();
            out.write_all(answer.as_bytes())?;
            out.flush()?;
        }
    }
    Ok(Status::Clean)
}

/// Where a fault of the setup is said to be.
struct Place<'a> {
    setup: Option<&'a Path>,
    speech: Speech,
}

impl Place<'_> {
    /// A fault of the data as a finding; `text` is the text it was read from.
    fn finding(&self, fault: DataFault, control: &Control, text: Option<&ProgramText>) -> Finding {
        match fault {
            DataFault::Setup(fault) => invalid_setup(self.setup.unwrap_or(Path::new("--import")), &fault),
            DataFault::Text(diagnostic) => {
                let name = text.map_or("", |text| text.name.as_str());
                let finding = Finding::new(name, *diagnostic).with_ids(control.alarm_ids);
                match text {
                    Some(text) => finding.located(text),
                    None => finding,
                }
            }
        }
    }
}

/// Takes a text of the control into the setup.
fn take_in(
    path: &Path,
    control: &mut Control,
    setup: &mut Setup,
    place: &Place<'_>,
    printer: &Printer,
) -> Result<(), Fault> {
    let speech = place.speech;
    let name = path.display().to_string();
    let read = || {
        if fs::metadata(path)?.len() > TEXT_BYTES_MAX {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        fs::read(path)
    };
    let bytes = read().map_err(|error| unreadable(&name, &error, speech))?;
    let text = ProgramText::in_memory(name.as_str(), &bytes);
    let import =
        import_data(control, setup, &bytes).map_err(|fault| place.finding(fault, control, Some(&text)))?;
    if import.is_empty {
        return Err(Finding::new(name, Diagnostic::error("data-text-empty")).failed().into());
    }
    for diagnostic in import.warnings {
        printer.finding(&Finding::new(name.as_str(), diagnostic).with_ids(control.alarm_ids), Some(&text));
    }
    say_parameters(&name, &import.parameters, printer);
    // The next text is read with the parameters of this one.
    set_parameters(control, &setup.parameter_words(), &name, speech)?;
    Ok(())
}

/// Says which parameters of a text do not act.
fn say_parameters(name: &str, import: &ParameterImport, printer: &Printer) {
    let speech = printer.speech;
    for (number, value, expected) in &import.refused {
        let expected = match speech.language {
            Language::English => (*expected).to_string(),
            Language::Chinese => speech.fill(&format!("expected-{}", expected.replace([' ', ','], "-")), &[]),
        };
        let diagnostic = Diagnostic::warning("parameter-text-value")
            .with("parameter", i64::from(*number))
            .with("value", value.as_str())
            .with("expected", expected);
        printer.finding(&Finding::new(name, diagnostic), None);
    }
    if !import.unknown.is_empty() {
        let diagnostic = Diagnostic::warning("parameter-text-unknown")
            .with("count", import.unknown.len() as i64)
            .with("parameters", list(&import.unknown));
        printer.finding(&Finding::new(name, diagnostic), None);
    }
}

/// Numbers in a row; a long row is cut.
fn list(numbers: &[u32]) -> String {
    const SHOWN_MAX: usize = 20;
    let mut shown: Vec<String> = numbers.iter().take(SHOWN_MAX).map(u32::to_string).collect();
    if numbers.len() > SHOWN_MAX {
        shown.push("…".to_string());
    }
    shown.join(" ")
}

/// The text of the control: one record between `%` for each kind.
fn text_of(
    what: Export,
    control: &Control,
    setup: &Setup,
    place: &Place<'_>,
    printer: &Printer,
) -> Result<String, Fault> {
    let mut text = String::new();
    let mut record = |lines: &str| text.push_str(&format!("%\n{lines}%\n"));
    let fault = |fault| place.finding(fault, control, None).failed();
    if matches!(what, Export::Parameters | Export::All) {
        let export = export_parameters(control, setup);
        for number in export.left_out {
            let diagnostic =
                Diagnostic::warning("parameter-text-incomplete").with("parameter", i64::from(number));
            printer.finding(&Finding::new("", diagnostic), None);
        }
        record(&export.text);
    }
    if matches!(what, Export::Offsets | Export::All) {
        record(&export_offsets(control, setup).map_err(fault)?);
    }
    if matches!(what, Export::Work | Export::All) {
        record(&export_work_zeros(control, setup).map_err(fault)?);
    }
    Ok(text)
}

/// Offsets in the order of their numbers.
fn offsets(setup: &Setup) -> Vec<(u32, &turnwright_control::Offset)> {
    let mut offsets: Vec<_> =
        setup.offsets.iter().map(|(name, offset)| (name.parse().unwrap_or(u32::MAX), offset)).collect();
    offsets.sort_by_key(|(number, _)| *number);
    offsets
}

/// The parameters that a setup states: number, value, name.
fn parameters(control: &Control, setup: &Setup, language: Language) -> Vec<[String; 3]> {
    let words = setup.parameter_words().into_iter();
    words
        .map(|(number, value)| {
            let name = control
                .parameters
                .find(&number)
                .map_or(String::new(), |(_, parameter, _)| parameter.name(language).to_string());
            [number, value, name]
        })
        .collect()
}

fn human(control: &Control, setup: &Setup, speech: Speech) -> String {
    let mut out = String::new();
    let mut section = |title: &'static str, table: &Table, has_heading: bool| {
        if !out.is_empty() {
            out.push('\n');
        }
        out.push_str(&format!("{}\n{}", heading(speech.get(title)), table.text(2, has_heading)));
    };
    if !setup.offsets.is_empty() {
        let mut table = Table::new(&[
            Side::Right,
            Side::Left,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
        ]);
        table.row([speech.get("data-number"), "", "X", "Y", "Z", "R", speech.get("data-tip")]);
        for (number, offset) in offsets(setup) {
            let row = |name: &'static str, row: &OffsetRow| {
                let values = [row.x, row.y, row.z, row.r].map(|value| value.to_string());
                [vec![speech.get(name).to_string()], values.to_vec()].concat()
            };
            let first = row("data-geometry", &offset.geometry);
            table.row([vec![number.to_string()], first, vec![offset.tip.to_string()]].concat());
            table.row([vec![String::new()], row("data-wear", &offset.wear)].concat());
        }
        section("data-offsets", &table, true);
    }
    if !setup.work.is_empty() {
        // X, Z, and the axes of which some zero is set.
        let is_used =
            |axis: &Axis| setup.work.values().any(|row| row.shown().any(|(shown, _)| shown == *axis));
        let axes: Vec<Axis> = Axis::ALL.into_iter().filter(is_used).collect();
        let mut table = Table::new(&[&[Side::Left][..], &vec![Side::Right; axes.len()]].concat());
        table.row([""].into_iter().chain(axes.iter().map(|axis| axis.letter())));
        for (name, row) in &setup.work {
            let values = axes.iter().map(|axis| row.value(*axis).to_string());
            table.row([name.clone()].into_iter().chain(values));
        }
        section("data-work", &table, true);
    }
    if !setup.parameters.is_empty() {
        let mut table = Table::new(&[Side::Left, Side::Right, Side::Left]);
        for row in parameters(control, setup, speech.language) {
            table.row(row);
        }
        section("parameters", &table, false);
    }
    if !setup.kept.is_empty() {
        let mut table = Table::new(&[Side::Right, Side::Left]);
        let mut kept: Vec<_> = setup.kept.iter().collect();
        kept.sort_by_key(|(number, _)| number.parse::<u32>().unwrap_or(u32::MAX));
        for (number, values) in kept {
            table.row([number, values]);
        }
        section("data-kept", &table, false);
    }
    if out.is_empty() { format!("{}\n", speech.get("data-none")) } else { out }
}

fn as_json(control: &Control, setup: &Setup, speech: Speech) -> Value {
    let row = |row: &OffsetRow| json!({ "x": row.x, "y": row.y, "z": row.z, "r": row.r });
    let offsets: Vec<Value> = offsets(setup)
        .into_iter()
        .map(|(number, offset)| {
            json!({
                "number": number,
                "geometry": row(&offset.geometry),
                "wear": row(&offset.wear),
                "tip": offset.tip,
            })
        })
        .collect();
    let work: Map<String, Value> =
        setup.work.iter().map(|(name, row)| (name.clone(), zero_json(row))).collect();
    let parameters: Vec<Value> = parameters(control, setup, speech.language)
        .into_iter()
        .map(|[number, value, name]| {
            let value = value.parse::<f64>().map_or_else(|_| json!(value), |value| json!(value));
            json!({ "number": number, "value": value, "name": name })
        })
        .collect();
    json!({
        "control": control.name,
        "offsets": offsets,
        "work": work,
        "parameters": parameters,
        "kept": setup.kept,
    })
}

/// A stored zero: X, Z, and of the other axes what is set.
fn zero_json(row: &ZeroRow) -> Value {
    let axes = row.shown().map(|(axis, value)| (axis.letter().to_lowercase(), json!(value)));
    Value::Object(axes.collect())
}
