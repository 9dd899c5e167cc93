//! Offsets and work zeros as controls punch them out: lines of data setting (`G10 P10001 X-10. Z-20.`) between `%`
//! and `%`.
//!
//! In: such a text, or a setup. Out: a setup, or such a text. A text may hold parameter lines too, which are taken
//! first (see `turnwright_control::ParameterLine`). The rest is read by running it, so that every form that
//! a program may write is understood here too, parameter lists included; a text that moves the tool is refused.
//! Lengths are in the unit that the control has at power-on, with a point.
//!
//! Source: data output of the FANUC family, which is its data setting.

use std::collections::BTreeMap;

use turnwright_canon::Action;
use turnwright_control::policy::DataSetting;
use turnwright_control::{
    Axis, Control, Offset, OffsetRow, ParameterImport, ParameterLine, Setup, SetupFault, ZeroRow,
    import_parameters,
};
use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_units::{LeastIncrement, Length, write_fixed};

use crate::machine::{Interpreter, Options, Step};
use crate::offsets::OffsetTable;
use crate::zeros::{STANDARD_SYSTEMS, WorkZero};
use crate::{Environment, ReadFault};

/// A text in memory; no switch is on.
struct Memory<'a>(&'a [u8]);

impl Environment for Memory<'_> {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = usize::try_from(offset).ok().and_then(|from| self.0.get(from..)).unwrap_or(&[]);
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

/// Why no data was taken from a text or setup.
#[derive(Clone, Debug, PartialEq)]
pub enum DataFault {
    /// The setup makes no sense.
    Setup(SetupFault),
    /// The text stops with this.
    Text(Box<Diagnostic>),
}

/// What a text gave besides the setup.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DataImport {
    /// What became of its parameter lines.
    pub parameters: ParameterImport,
    /// Warnings about its other lines.
    pub warnings: Vec<Diagnostic>,
    /// It held neither parameters nor data setting.
    pub is_empty: bool,
}

/// Takes a punched text into a setup. `control` has the setup's parameters.
///
/// # Errors
/// The alarm of a wrong line; a text that does more than set data.
pub fn import_data(control: &Control, setup: &mut Setup, text: &[u8]) -> Result<DataImport, DataFault> {
    let (mut lines, mut rest) = (Vec::new(), text.to_vec());
    for line in rest.split_mut(|byte| *byte == b'\n') {
        let words = String::from_utf8_lossy(line);
        let parameter = ParameterLine::parse(&words);
        // Several records may stand in one file. What is taken out leaves blanks, so that places stay right.
        if parameter.is_some() || words.trim_start().starts_with('%') {
            line.fill(b' ');
        }
        lines.extend(parameter);
    }
    let parameters = import_parameters(control, setup, &lines);
    let mut control = control.clone();
    for (address, value) in setup.parameter_words() {
        // A value that cannot be was named when the setup was read.
        let _ = control.parameters.set(&address, &value);
    }
    let mut import = DataImport { parameters, warnings: Vec::new(), is_empty: lines.is_empty() };
    if rest.trim_ascii().is_empty() {
        return Ok(import);
    }
    import.is_empty = false;
    import.warnings = run_data(control, setup, &rest)?;
    Ok(import)
}

/// Runs lines of data setting and stores what they wrote; gives the warnings.
fn run_data(mut control: Control, setup: &mut Setup, text: &[u8]) -> Result<Vec<Diagnostic>, DataFault> {
    let parameters_before = control.parameters.all();
    // Such a text has no end of program.
    control.parameters.set_by_name("end-of-record-allowed", 1.0);
    let mut interpreter =
        Interpreter::new(control, setup, SourceId(0), Options::default()).map_err(DataFault::Setup)?;
    let mut environment = Memory(text);
    loop {
        match interpreter.step(&mut environment) {
            Step::End => break,
            Step::Alarm(alarm) if alarm.key == "program-empty" => break,
            Step::Alarm(alarm) => return Err(DataFault::Text(alarm)),
            Step::Emit(command) if matches!(command.action, Action::Relocate { .. } | Action::End) => {}
            Step::Emit(_) | Step::NeedSync(_) => {
                let diagnostic = Diagnostic::error("text-does-more-than-set-data");
                return Err(DataFault::Text(Box::new(diagnostic.at(interpreter.core.block_place()))));
            }
        }
    }
    let notes = ["data-setting-at-run", "tool-life-does-not-act"];
    let mut said = interpreter.take_warnings();
    said.retain(|diagnostic| !notes.contains(&diagnostic.key));
    let before: BTreeMap<_, _> =
        parameters_before.into_iter().map(|(address, _, _, value)| (address, value)).collect();
    for (address, name, _, value) in interpreter.core.control.parameters.all() {
        if name != "end-of-record-allowed" && before.get(&address) != Some(&value) {
            setup.set_parameter(&address, value);
        }
    }
    interpreter.store_into(setup);
    Ok(said)
}

/// The offsets of a setup as a text of data setting, without `%`.
///
/// # Errors
/// A setup that makes no sense; a control whose programs cannot write offsets.
pub fn export_offsets(control: &Control, setup: &Setup) -> Result<String, DataFault> {
    let interpreter = open(control, setup)?;
    let core = &interpreter.core;
    let has_y = (1..=core.offsets.last_number()).any(|number| {
        [OffsetTable::Geometry, OffsetTable::Wear]
            .into_iter()
            .any(|table| !core.offsets.values(table, number)[1].is_zero())
    });
    let mut text = String::new();
    for number in 1..=core.offsets.last_number() {
        for (table, target) in [(OffsetTable::Wear, number), (OffsetTable::Geometry, number + 10_000)] {
            let [x, y, z, radius] = core.offsets.values(table, number);
            let written = |length| interpreter.written(length, core.offset_increment());
            text.push_str(&format!("G10 P{target} X{}", written(x)));
            if has_y {
                text.push_str(&format!(" Y{}", written(y)));
            }
            text.push_str(&format!(" Z{} R{}", written(z), written(radius)));
            if table == OffsetTable::Geometry {
                text.push_str(&format!(" Q{}", core.offsets.tip(number)));
            }
            text.push('\n');
        }
    }
    Ok(text)
}

/// The work zeros of a setup as a text of data setting, without `%`.
///
/// # Errors
/// As [`export_offsets`].
pub fn export_work_zeros(control: &Control, setup: &Setup) -> Result<String, DataFault> {
    let interpreter = open(control, setup)?;
    let mut text = String::new();
    let mut line = |head: &str, zero: WorkZero| {
        let pair = interpreter.core.zeros.pair(zero);
        let increment = interpreter.core.modal.increment(&interpreter.core.settings);
        let (x, z) = (interpreter.written(pair[0], increment), interpreter.written(pair[1], increment));
        text.push_str(&format!("{head} X{x} Z{z}"));
        let core = &interpreter.core;
        for axis in Axis::OTHERS.into_iter().filter(|axis| core.axes.machine.number(*axis).is_some()) {
            let value = core.zeros.get(zero, axis).unwrap_or(Length::ZERO);
            let value = match axis {
                Axis::Y => interpreter.written(value, increment),
                _ => written_in(value, core.settings.metric_increment, 1_000_000),
            };
            text.push_str(&format!(" {}{value}", axis.letter()));
        }
        text.push('\n');
    };
    line("G10 P0", WorkZero::WorkpieceShift);
    line("G10 L2 P0", WorkZero::External);
    for system in 0..STANDARD_SYSTEMS {
        line(&format!("G10 L2 P{}", system + 1), WorkZero::System(system));
    }
    let zeros = &interpreter.core.zeros;
    let is_used = |number: &usize| zeros.pair(WorkZero::additional(*number)) != [Length::ZERO; 2];
    for number in 1..=(1..=zeros.additional_systems()).rev().find(is_used).unwrap_or(0) {
        line(&format!("G10 L20 P{number}"), WorkZero::additional(number));
    }
    Ok(text)
}

fn open(control: &Control, setup: &Setup) -> Result<Interpreter, DataFault> {
    if control.policies.data_setting == DataSetting::ListsOnly {
        return Err(DataFault::Text(Box::new(Diagnostic::error("data-text-unknown"))));
    }
    Interpreter::new(control.clone(), setup, SourceId(0), Options::default()).map_err(DataFault::Setup)
}

impl Interpreter {
    /// A length as a word has it, in the unit of power-on.
    fn written(&self, length: Length, increment: LeastIncrement) -> String {
        written_in(length, increment, if self.core.modal.is_inch { 25_400_000 } else { 1_000_000 })
    }

    /// Writes what is stored into a setup: work zeros that it states as parameters are stated so again.
    fn store_into(&self, setup: &mut Setup) {
        let core = &self.core;
        for number in 1..=core.offsets.last_number() {
            let row = |table| {
                let [x, y, z, r] = core.offsets.values(table, number).map(Length::to_mm);
                OffsetRow { x, y, z, r }
            };
            let offset = Offset {
                geometry: row(OffsetTable::Geometry),
                wear: row(OffsetTable::Wear),
                tip: core.offsets.tip(number),
            };
            setup.offsets.insert(number.to_string(), offset);
        }
        let systems = STANDARD_SYSTEMS + core.zeros.additional_systems();
        let zeros = [WorkZero::WorkpieceShift, WorkZero::External].into_iter();
        for zero in zeros.chain((0..systems).map(WorkZero::System)) {
            let value = |axis| core.zeros.get(zero, axis).unwrap_or(Length::ZERO).to_mm();
            let has = |axis: &Axis| core.axes.machine.number(*axis).is_some();
            let row = ZeroRow::of(value);
            let number = zero.parameter().and_then(|name| core.control.parameters.number(name));
            let stated = number.filter(|number| setup.parameters.contains_key(*number));
            if let Some(number) = stated {
                for axis in Axis::ALL.into_iter().filter(has) {
                    setup.set_parameter(&format!("{number}.{}", axis.letter()), value(axis));
                }
            } else if row != ZeroRow::default() || setup.work.contains_key(&zero.name()) {
                setup.work.insert(zero.name(), row);
            }
        }
    }
}

/// A length as a word has it: `unit` is one of its units, nm.
fn written_in(length: Length, increment: LeastIncrement, unit: i64) -> String {
    let increment = increment.nm();
    let decimals = (unit / increment).ilog10() as u8;
    let mut digits = Vec::new();
    if unit != 1_000_000 || length.nm() % increment == 0 {
        write_fixed(&mut digits, (length.nm() + increment / 2 * length.signum()) / increment, decimals);
    } else {
        // Finer than the control is; nothing is hidden.
        write_fixed(&mut digits, length.nm(), 6);
    }
    let mut text = String::from_utf8(digits).unwrap_or_default();
    if !text.contains('.') {
        text.push('.');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control() -> Control {
        Control::load(turnwright_control::DEFAULT_CONTROL).expect("the usual control")
    }

    #[test]
    fn zeros_of_other_axes_are_read_and_written_again() {
        let mut setup = Setup::parse("machine = \"turn-mill\"\n").expect("a setup");
        let text = "G10 L2 P2 X0. Z-5. C12.5 Y-0.25 B30.\nN01221 Q1 A1P0. A2P0. A4P90.\n";
        import_data(&control(), &mut setup, text.as_bytes()).expect("data");
        let row = setup.work["G55"];
        assert_eq!((row.z, row.c, row.y, row.b), (-5.0, 12.5, -0.25, 30.0));
        let c = setup.parameter_words().into_iter().find(|(number, _)| number == "1221.C");
        assert_eq!(c.map(|(_, value)| value).as_deref(), Some("90"));
        let again = export_work_zeros(&control(), &setup).expect("zeros");
        assert!(again.contains("G10 L2 P2 X0. Z-5. C12.5 Y-0.25 B30.\n"), "{again}");
        let mut parsed = Setup::parse(&setup.to_toml()).expect("its own text");
        parsed.kept.clone_from(&setup.kept);
        assert_eq!(parsed, setup);
    }

    #[test]
    fn what_is_read_is_written_again() {
        let text = "%\nG10 P1 X0.2 Z0. R0.\nG10 P10001 X-10. Z-20.5 R0.8 Q3\nG10 P2 X0. Z-0.015 R0.\n\
                    G10 P10002 X0. Z0. R0.4 Q2\n%\n";
        let mut setup = Setup::default();
        assert_eq!(import_data(&control(), &mut setup, text.as_bytes()), Ok(DataImport::default()));
        assert_eq!(setup.offsets["1"].geometry.x, -10.0);
        assert_eq!(setup.offsets["1"].tip, 3);
        let again = export_offsets(&control(), &setup).expect("offsets");
        assert_eq!(format!("%\n{again}%\n"), text);
    }

    #[test]
    fn work_zeros_are_read_and_written() {
        let text = "G10 P0 X0. Z0.1\nG10 L2 P0 X1. Z2.\nG10 L2 P1 X0. Z0.\nG10 L2 P2 X0. Z-55.\nG10 L2 P3 X0. Z0.\n\
                    G10 L2 P4 X0. Z0.\nG10 L2 P5 X0. Z0.\nG10 L2 P6 X0.001 Z0.\nG10 L20 P1 X0. Z0.\nG10 L20 P2 X5. Z6.\n";
        let mut setup = Setup::default();
        import_data(&control(), &mut setup, text.as_bytes()).expect("a data text");
        assert_eq!(setup.work["G55"].z, -55.0);
        assert_eq!(setup.work["G54.1 P2"].x, 5.0);
        assert!(!setup.work.contains_key("G54"));
        assert_eq!(export_work_zeros(&control(), &setup), Ok(text.to_string()));
    }

    #[test]
    fn random_tables_survive_the_way_out_and_in_metric_and_inch() {
        let mut seed = 2_463_534_242u64;
        let mut random = |limit: i64| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed % (2 * limit as u64)) as i64 - limit
        };
        for inch in [0.0, 1.0] {
            let mut control = control();
            control.parameters.set_by_name("inch-input", inch);
            let increment_mm = if inch == 0.0 { 0.001 } else { 0.002_54 };
            let mut setup = Setup::default();
            for number in 1..=40 {
                let mut row = |limit| OffsetRow {
                    x: random(limit) as f64 * increment_mm,
                    y: random(limit) as f64 * increment_mm,
                    z: random(limit) as f64 * increment_mm,
                    r: random(1_000) as f64 * increment_mm,
                };
                let offset = Offset { geometry: row(3_000_000), wear: row(9_000), tip: number % 10 };
                setup.offsets.insert(number.to_string(), offset);
            }
            let text = export_offsets(&control, &setup).expect("offsets");
            let mut again = Setup::default();
            import_data(&control, &mut again, text.as_bytes()).expect("a data text");
            assert_eq!(export_offsets(&control, &again), Ok(text));
            for (name, offset) in &setup.offsets {
                assert!((offset.geometry.x - again.offsets[name].geometry.x).abs() < 1e-9, "{name}");
            }
        }
    }

    #[test]
    fn offsets_keep_the_digits_of_their_own_increment() {
        let mut control = control();
        control.parameters.set_by_name("offset-increment-c", 1.0);
        let mut setup = Setup::default();
        import_data(&control, &mut setup, b"G10 P1 X15 Z-0.0002 R0\n").expect("a data text");
        assert_eq!(setup.offsets["1"].wear.x, 0.001_5);
        let text = "G10 P1 X0.0015 Z-0.0002 R0.\nG10 P10001 X0. Z0. R0. Q0\n";
        assert_eq!(export_offsets(&control, &setup), Ok(text.to_string()));
    }

    #[test]
    fn a_program_is_no_data_text_and_a_wrong_line_is_an_alarm() {
        let refused = |text: &str| match import_data(&control(), &mut Setup::default(), text.as_bytes()) {
            Err(DataFault::Text(diagnostic)) => {
                (diagnostic.key, diagnostic.place.map_or(0, |place| place.line))
            }
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(refused("G10 P1 X1.\nG00 X5.\n"), ("text-does-more-than-set-data", 2));
        assert_eq!(refused("G10 P1 X1.\nG10 P999 X5.\n"), ("offset-number-illegal", 2));
    }

    #[test]
    fn parameter_lists_are_taken_too() {
        let mut setup = Setup::default();
        import_data(&control(), &mut setup, b"G10 L52\nN5130 R7\nN3401 Q0 R1\nG11\n").expect("a data text");
        import_data(&control(), &mut setup, b"%\nN05131 Q1 L1P30\n%\n%\nG10 P1 X1. Z2.\n%\n")
            .expect("two records");
        assert_eq!(setup.offsets["1"].wear.z, 2.0);
        assert_eq!(setup.parameters.remove("5131"), Some(30.into()));
        assert_eq!(setup.parameter_words(), [("3401#0".into(), "1".into()), ("5130".into(), "7".into())]);
    }
}
