//! Parameters as controls punch them out: `N01320 Q1 A1P99999.000 A2P99999.000` between `%` and `%`.
//!
//! In: such a text, or the parameters of a setup. Out: the parameters of a setup, or such a text.
//!
//! N is the number, Q1 says that it is a parameter. Each value stands behind P; before it may stand the axis (A1 is
//! X, A2 is Z, the others as the machine file numbers them), the path (L1) or the spindle (S1) that it belongs to. Bits are eight digits, bit 7 first. A length
//! without a point counts least increments.
//!
//! Invariants: nothing is lost: a number that is not known here, and what is known only in part (the other bits of
//! a word, the values of further axes), is kept as it stood ([`Setup::kept`]) and written out again. A word of bits
//! of which only some are known is never made up: written into a control it would clear the others.
//!
//! Source: parameter punch-out of the FANUC family, from memory; no text of a GSK control was found.

use std::collections::BTreeMap;

use crate::policy::ParameterText;
use crate::{Axis, Control, MachineAxes, Parameter, Parameters, Setup, UnderNumber};

/// A line of a parameter text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterLine {
    number: u32,
    values: Vec<Entry>,
}

/// One value of a line: where it belongs, and its digits.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Entry {
    /// `A1`, `L1`, `S1`, or nothing.
    place: String,
    value: String,
}

/// What a parameter text gave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterImport {
    /// How many values are known here and were set.
    pub known: usize,
    /// Numbers that are not known here; they are kept.
    pub unknown: Vec<u32>,
    /// Values that the parameter cannot have: number, value, what is expected. They are kept too.
    pub refused: Vec<(u32, String, &'static str)>,
}

impl ParameterLine {
    /// Reads a line; `None` when it is no line of a parameter text.
    pub fn parse(line: &str) -> Option<Self> {
        let packed: String =
            line.trim_end_matches([';', '\r']).chars().filter(|c| !c.is_whitespace()).collect();
        let rest = packed.strip_prefix(['N', 'n'])?;
        let (number, mut rest) = split_digits(rest);
        let number = number.parse().ok()?;
        let mut values = Vec::new();
        if let Some(kind) = rest.strip_prefix(['Q', 'q']) {
            // Q1 marks a parameter; anything else is another kind of data.
            let (kind, behind) = split_digits(kind);
            rest = (kind == "1").then_some(behind)?;
        }
        let mut place = String::new();
        while let Some(letter) = rest.chars().next() {
            let behind = &rest[letter.len_utf8()..];
            match letter.to_ascii_uppercase() {
                'P' => {
                    let end = behind.find(|c: char| !matches!(c, '0'..='9' | '.' | '-' | '+'));
                    let (value, behind) = behind.split_at(end.unwrap_or(behind.len()));
                    value.parse::<f64>().ok()?;
                    values.push(Entry { place: std::mem::take(&mut place), value: value.to_string() });
                    rest = behind;
                }
                letter @ ('A' | 'L' | 'S' | 'T' | 'M') => {
                    let (digits, behind) = split_digits(behind);
                    place.push(letter);
                    place.push_str(digits);
                    rest = behind;
                }
                _ => return None,
            }
        }
        (place.is_empty() && !values.is_empty()).then_some(Self { number, values })
    }

    /// The line in the form of a control.
    fn text(&self, form: ParameterText) -> String {
        let head = match form {
            ParameterText::Short => format!("N{:04}", self.number),
            ParameterText::Long => format!("N{:05} Q1", self.number),
        };
        self.values.iter().fold(head, |line, entry| format!("{line} {}P{}", entry.place, entry.value))
    }

    /// The values as they are kept in a setup.
    fn kept(&self) -> String {
        let values: Vec<String> =
            self.values.iter().map(|entry| format!("{}P{}", entry.place, entry.value)).collect();
        values.join(" ")
    }
}

/// Digits, and what follows them.
fn split_digits(text: &str) -> (&str, &str) {
    text.split_at(text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len()))
}

/// The axis that `A1` means on a machine.
fn axis_of(place: &str, machine: &MachineAxes) -> Option<Axis> {
    machine.numbered(place.strip_prefix('A')?.parse().ok()?)
}

/// The eight digits of a word of bits, bit 7 first.
fn bits_of(value: &str) -> Option<u8> {
    (value.len() == 8).then(|| u8::from_str_radix(value, 2).ok()).flatten()
}

/// Millimetres in one least increment.
fn increment_mm(parameters: &Parameters) -> f64 {
    if parameters.bit("least-input-increment-c") {
        0.000_1
    } else if parameters.bit("least-input-increment-a") {
        0.01
    } else {
        0.001
    }
}

/// Takes lines into a setup. `control` says which numbers are known; the setup's parameters win over its own.
pub fn import_parameters(control: &Control, setup: &mut Setup, lines: &[ParameterLine]) -> ParameterImport {
    let mut import = ParameterImport::default();
    let mut probe = control.parameters.clone();
    let machine = setup.machine().map(|machine| machine.axes).unwrap_or_default();
    // Bits first: they say what a least increment is.
    for line in lines {
        if let Some(under) = probe.under_number(line.number).filter(|under| under.whole.is_none()) {
            for (position, value) in line.values.iter().enumerate() {
                take_value(&mut probe, setup, (line.number, &under), (position, value), &machine);
            }
        }
    }
    for line in lines {
        let Some(under) = control.parameters.under_number(line.number) else {
            import.unknown.push(line.number);
            setup.kept.insert(line.number.to_string(), line.kept());
            continue;
        };
        let mut is_whole = under.bits.is_empty();
        for (position, value) in line.values.iter().enumerate() {
            match take_value(&mut probe, setup, (line.number, &under), (position, value), &machine) {
                Taken::Set(count) => import.known += count,
                Taken::Elsewhere => is_whole = false,
                Taken::Refused(expected) => {
                    import.refused.push((line.number, value.value.clone(), expected));
                    is_whole = false;
                }
            }
        }
        if is_whole {
            setup.kept.remove(&line.number.to_string());
        } else {
            setup.kept.insert(line.number.to_string(), line.kept());
        }
    }
    import
}

/// What became of one value.
enum Taken {
    Set(usize),
    /// It belongs to an axis or spindle that is not here.
    Elsewhere,
    Refused(&'static str),
}

fn take_value(
    probe: &mut Parameters,
    setup: &mut Setup,
    (number, under): (u32, &UnderNumber),
    (position, entry): (usize, &Entry),
    machine: &MachineAxes,
) -> Taken {
    let axis = axis_of(&entry.place, machine);
    let increment_mm = increment_mm(probe);
    let mut set = |address: String, value: &str| -> Result<(), &'static str> {
        probe.set(&address, value).map_err(|fault| fault.expected())?;
        let number: f64 = value.parse().map_err(|_| "a number")?;
        setup.set_parameter(&address, number);
        Ok(())
    };
    if let Some((_, parameter)) = under.whole {
        let address = match (parameter.is_per_axis(), axis) {
            (true, Some(axis)) => format!("{number}.{}", axis.letter()),
            (false, _) if position == 0 => number.to_string(),
            _ => return Taken::Elsewhere,
        };
        let value = if parameter.counts_increments() && !entry.value.contains('.') {
            let count: f64 = entry.value.parse().unwrap_or(0.0);
            trimmed(count * increment_mm)
        } else {
            entry.value.clone()
        };
        return set(address, &value).map_or_else(Taken::Refused, |()| Taken::Set(1));
    }
    let Some(word) = bits_of(&entry.value) else { return Taken::Refused("8 bits") };
    let mut count = 0;
    for (bit, parameter) in &under.bits {
        let address = match (parameter.is_per_axis(), axis) {
            (true, Some(axis)) => format!("{number}#{bit}.{}", axis.letter()),
            (false, _) if position == 0 => format!("{number}#{bit}"),
            _ => continue,
        };
        let value = if word & (1 << bit) == 0 { "0" } else { "1" };
        if let Err(expected) = set(address, value) {
            return Taken::Refused(expected);
        }
        count += 1;
    }
    if count == 0 { Taken::Elsewhere } else { Taken::Set(count) }
}

/// A number without trailing zeros, rounded to a millionth.
fn trimmed(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// A parameter text, and the words of bits that could not be written because not all of their bits are known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParameterExport {
    /// The lines, without `%`.
    pub text: String,
    /// Numbers of the words left out.
    pub left_out: Vec<u32>,
}

/// Writes the parameters that a setup states and those that it keeps, in the form of the control. Values that nobody
/// stated are not written: ours are proposals.
pub fn export_parameters(control: &Control, setup: &Setup) -> ParameterExport {
    let form = control.policies.parameter_text;
    let mut stated = control.parameters.clone();
    for (address, value) in setup.parameter_words() {
        // What cannot be set is no parameter of this control and is not written.
        let _ = stated.set(&address, &value);
    }
    let increment_mm = increment_mm(&stated);
    let mut lines: BTreeMap<u32, ParameterLine> = BTreeMap::new();
    for (number, values) in &setup.kept {
        if let Some(line) = ParameterLine::parse(&format!("N{number} {values}")) {
            lines.insert(line.number, line);
        }
    }
    let machine = setup.machine().map(|machine| machine.axes).unwrap_or_default();
    let mut export = ParameterExport::default();
    for (address, value) in setup.parameter_words() {
        let (number, axis) = address.split_once('.').unwrap_or((&address, ""));
        let (word, bit) = number.split_once('#').unwrap_or((number, ""));
        let Ok(word) = word.parse::<u32>() else { continue };
        let axis = Axis::ALL.into_iter().find(|one| axis.eq_ignore_ascii_case(one.letter()));
        let place = match (axis, form) {
            // An axis that the machine does not have has no number to write.
            (Some(axis), _) if machine.number(axis).is_none() => continue,
            (Some(axis), _) => format!("A{}", machine.number(axis).unwrap_or_default()),
            (None, ParameterText::Long) => "L1".to_string(),
            (None, ParameterText::Short) => String::new(),
        };
        let plain = control.parameters.under_number(word).and_then(|under| under.whole);
        match (plain, bit.parse::<u8>()) {
            (Some((_, parameter)), _) => {
                let value = punched(increment_mm, form, parameter, &value);
                let line = lines.entry(word).or_insert(ParameterLine { number: word, values: Vec::new() });
                line.put(place, axis.is_some(), value);
            }
            (None, Ok(bit @ 0..=7)) => {
                let axis = axis.map(|_| &place);
                let line = lines.get_mut(&word);
                let is_put = line.is_some_and(|line| line.put_bit(axis, bit, value != "0"));
                if !is_put && !export.left_out.contains(&word) {
                    export.left_out.push(word);
                }
            }
            _ => {}
        }
    }
    for line in lines.values() {
        export.text.push_str(&line.text(form));
        export.text.push('\n');
    }
    export
}

/// A value as the control writes it.
fn punched(increment_mm: f64, form: ParameterText, parameter: &Parameter, value: &str) -> String {
    let number: f64 = value.parse().unwrap_or(0.0);
    match form {
        ParameterText::Short if parameter.counts_increments() => trimmed((number / increment_mm).round()),
        ParameterText::Long if parameter.counts_increments() => {
            let decimals = if increment_mm < 0.000_5 { 4 } else { 3 };
            let rounded = format!("{number:.decimals$}");
            // What the control's decimals cannot hold is written in full.
            if rounded.parse() == Ok(number) { rounded } else { trimmed(number) }
        }
        _ => trimmed(number),
    }
}

impl ParameterLine {
    /// Puts a value in its place: that of an axis, else the first.
    fn put(&mut self, place: String, is_axis: bool, value: String) {
        let found = self
            .values
            .iter_mut()
            .enumerate()
            .find(|(position, entry)| if is_axis { entry.place == place } else { *position == 0 });
        match found {
            Some((_, entry)) => entry.value = value,
            None => {
                self.values.push(Entry { place, value });
                self.values.sort_by(|one, other| one.place.cmp(&other.place));
            }
        }
    }

    /// Puts a bit into the word of an axis, else the first; false when there is no such word.
    fn put_bit(&mut self, axis: Option<&String>, bit: u8, is_set: bool) -> bool {
        let entry = match axis {
            Some(place) => self.values.iter_mut().find(|entry| entry.place == *place),
            None => self.values.first_mut(),
        };
        let Some(entry) = entry else { return false };
        let Some(word) = bits_of(&entry.value) else { return false };
        let word = if is_set { word | 1 << bit } else { word & !(1 << bit) };
        entry.value = format!("{word:08b}");
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn import(control: &str, text: &str) -> (Control, Setup, ParameterImport) {
        let control = Control::load(control).expect("a control");
        let lines: Vec<ParameterLine> = text.lines().filter_map(ParameterLine::parse).collect();
        let mut setup = Setup::default();
        let import = import_parameters(&control, &mut setup, &lines);
        (control, setup, import)
    }

    #[test]
    fn a_line_is_known_by_its_form() {
        assert!(ParameterLine::parse("N3401 P00000001").is_some());
        assert!(ParameterLine::parse("N01320Q1A1P 99999.000A2P-5.;").is_some());
        for line in
            ["N10 G00 X5.", "N3401 R1", "N3401 Q0 R1", "N1 A1", "G10 P1 X1.", "N01320 Q0 P100", "%", "N5 P"]
        {
            assert_eq!(ParameterLine::parse(line), None, "{line}");
        }
    }

    #[test]
    fn bits_lengths_and_counts_are_read_in_the_units_of_the_control() {
        let text = "N03402 Q1 L1P00010000\nN01221 Q1 A1P-12.500 A2P-3000\nN05130 Q1 L1P7\n";
        let (_, setup, import) = import("fanuc-0i-tf", text);
        let words = setup.parameter_words();
        let value = |number: &str| words.iter().find(|(known, _)| known == number).map(|(_, v)| v.as_str());
        assert_eq!(value("3402#4"), Some("1"));
        assert_eq!(value("3402#0"), Some("0"));
        assert_eq!(value("1221.X"), Some("-12.5"));
        assert_eq!(value("1221.Z"), Some("-3"));
        assert_eq!(value("5130"), Some("7"));
        assert!(import.unknown.is_empty() && import.refused.is_empty(), "{import:?}");
    }

    #[test]
    fn what_comes_in_goes_out_again() {
        let text = "N00000 Q1 L1P00000010\nN01023 Q1 A1P1 A2P2\nN01221 Q1 A1P-12.500 A2P-3.000 A3P7\n\
                    N03402 Q1 L1P10010011\nN05130 Q1 L1P7\n";
        let (control, setup, import) = import("fanuc-0i-tf", text);
        assert_eq!(import.unknown, [1023]);
        assert_eq!(
            export_parameters(&control, &setup),
            ParameterExport { text: text.to_string(), left_out: vec![] }
        );
        let text = "N1221 A1P-12500 A2P-3000\nN5130 P7\n";
        let (control, setup, _) = self::import("fanuc-0i-mate-tb", text);
        assert_eq!(export_parameters(&control, &setup).text, text);
    }

    #[test]
    fn a_changed_bit_leaves_the_others_and_no_word_is_made_up() {
        let (control, mut setup, _) = import("fanuc-0i-tf", "N03402 Q1 L1P10000011\n");
        setup.set_parameter("3402#4", 1.0);
        setup.set_parameter("3403#4", 1.0);
        let export = export_parameters(&control, &setup);
        assert_eq!(export.text, "N03402 Q1 L1P10010011\n");
        assert_eq!(export.left_out, [3403]);
    }

    #[test]
    fn impossible_values_are_named_and_kept() {
        let (control, setup, import) = import("fanuc-0i-tf", "N05130 Q1 L1P-7\nN03402 Q1 L1P12\n");
        assert_eq!(import.refused.len(), 2);
        assert_eq!(export_parameters(&control, &setup).text, "N03402 Q1 L1P12\nN05130 Q1 L1P-7\n");
    }

    #[test]
    fn every_parameter_of_every_control_survives_the_way_out_and_in() {
        for name in crate::control_names() {
            let control = Control::load(name).expect("a control");
            let mut setup = Setup::default();
            let mut words = BTreeMap::new();
            for (at, (address, _, parameter, _)) in control.parameters.all().into_iter().enumerate() {
                let value = match parameter.unit {
                    "bit" => (at % 2) as f64,
                    "mm" | "deg" => at as f64 * 0.25 - 7.0,
                    _ => at as f64,
                };
                setup.set_parameter(&address, value);
                if let Some((word, _)) = address.split_once('#') {
                    let axes = if parameter.is_per_axis() { "A1P00000000 A2P00000000" } else { "P00000000" };
                    words.insert(word.trim_start_matches('0').to_string(), axes.to_string());
                }
            }
            setup.kept = words
                .into_iter()
                .map(|(word, values)| (if word.is_empty() { "0".into() } else { word }, values))
                .collect();
            let export = export_parameters(&control, &setup);
            assert!(export.left_out.is_empty(), "{name}: {:?}", export.left_out);
            let lines: Vec<_> =
                export.text.lines().map(|line| ParameterLine::parse(line).expect(line)).collect();
            let mut again = Setup::default();
            let import = import_parameters(&control, &mut again, &lines);
            assert!(import.unknown.is_empty() && import.refused.is_empty(), "{name}: {import:?}");
            assert_eq!(export_parameters(&control, &again), export, "{name}");
        }
    }
}
