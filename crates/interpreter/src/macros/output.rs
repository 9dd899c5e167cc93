//! Output statements: `POPEN`, `DPRNT[…]`, `BPRNT[…]`, `PCLOS`, and the naming of variables.
//!
//! `DPRNT[TEXT#100[53]Z*#101[30]]` writes letters and digits as they stand, a blank for each `*`, and variables
//! with so many places before and behind the point. `BPRNT` writes variables as words of four bytes and the text
//! in the code of the tape. What is written is a command like any other; where it goes is the caller's affair.
//!
//! Source: external output commands of custom macro. Blanks in the statement mean nothing.

use std::ops::Range;

use turnwright_canon::Action;
use turnwright_diagnostics::Diagnostic;
use turnwright_syntax::parse_expression;

use super::variables::number;
use crate::Environment;
use crate::machine::{Core, Halt};
use crate::report::Alarm;

/// Most digits of a printed number, before and behind the point together.
const DIGITS_MAX: u8 = 8;

/// Longest line that one statement writes.
const LINE_CHARACTERS_MAX: usize = 4_096;

impl Core {
    /// An output statement between some bytes of the line.
    #[cold]
    pub(super) fn output(
        &mut self,
        range: Range<u32>,
        environment: &mut dyn Environment,
    ) -> Result<(), Halt> {
        let bytes = self.line_bytes().get(range.start as usize..range.end as usize).unwrap_or(&[]);
        let text: Vec<u8> = bytes.iter().map(u8::to_ascii_uppercase).collect();
        let (keyword, rest) = text.split_at(text.len().min(5));
        let at = range.start + 5;
        match keyword {
            b"POPEN" if rest.trim_ascii().is_empty() => {
                self.macros.output_is_open = true;
                Ok(())
            }
            b"PCLOS" if rest.trim_ascii().is_empty() => {
                self.macros.output_is_open = false;
                Ok(())
            }
            // Names of variables are for the screen.
            b"SETVN" if rest.contains(&b'[') && rest.trim_ascii_end().ends_with(b"]") => Ok(()),
            b"DPRNT" | b"BPRNT" => {
                if !self.macros.output_is_open {
                    return Err(self.output_fault("output-not-open", range).into());
                }
                let is_decimal = keyword == b"DPRNT";
                let line = self.printed(rest, at, is_decimal, environment)?;
                self.emit(Action::Output(line.into_boxed_str()));
                Ok(())
            }
            _ => Err(self.print_fault(range).into()),
        }
    }

    fn print_fault(&self, place: Range<u32>) -> Alarm {
        self.output_fault("print-format", place)
    }

    fn output_fault(&self, key: &'static str, place: Range<u32>) -> Alarm {
        let quote = self.quote(place.start, place.end);
        self.finish(Diagnostic::alarm(key).at(self.at.span(place.start, place.end)).with("word", quote))
    }

    /// What `[…]` prints; `at` is the place of its first byte in the line.
    fn printed(
        &mut self,
        text: &[u8],
        at: u32,
        is_decimal: bool,
        environment: &mut dyn Environment,
    ) -> Result<String, Halt> {
        let whole = at..at + text.len() as u32;
        let Some(inner) = text.strip_prefix(b"[").and_then(|text| text.trim_ascii_end().strip_suffix(b"]"))
        else {
            return Err(self.print_fault(whole).into());
        };
        let at = at + 1;
        let mut line = String::new();
        let mut place = 0;
        while let Some(byte) = inner.get(place).copied() {
            if line.len() > LINE_CHARACTERS_MAX {
                return Err(self.print_fault(whole).into());
            }
            match byte {
                b' ' | b'\t' => place += 1,
                b'*' => {
                    line.push(' ');
                    place += 1;
                }
                b'#' => {
                    let (variable, format, next) = match print_item(inner, place, is_decimal) {
                        Some(item) => item,
                        None => return Err(self.print_fault(at + place as u32..whole.end).into()),
                    };
                    let variable = at + variable.start as u32..at + variable.end as u32;
                    let value = self.print_value(variable, environment)?;
                    let item = at + place as u32..at + next as u32;
                    let printed = if is_decimal {
                        decimal(value, format, self.control.parameters.bit("print-without-leading-blanks"))
                    } else {
                        binary(value, format)
                    };
                    match printed {
                        Some(text) => line.push_str(&text),
                        None => return Err(self.print_fault(item).into()),
                    }
                    place = next;
                }
                b'A'..=b'Z' | b'0'..=b'9' | b'+' | b'-' | b'/' | b'.' => {
                    line.push(char::from(byte));
                    place += 1;
                }
                _ => {
                    let here = at + place as u32;
                    return Err(self.print_fault(here..here + 1).into());
                }
            }
        }
        Ok(line)
    }

    fn print_value(&mut self, range: Range<u32>, environment: &mut dyn Environment) -> Result<f64, Halt> {
        let expression = match parse_expression(self.line_bytes(), range.clone()) {
            Ok(expression) => expression,
            Err(fault) => return Err(self.expression_fault(&fault, range).into()),
        };
        let mark = self.macros.machine.mark();
        let code = self.macros.machine.compile(&expression, &self.macros.variables, false);
        let code = code.map_err(|(fault, place)| self.code_fault(fault, place))?;
        let value = self.evaluate(code, environment);
        self.macros.machine.forget(mark);
        Ok(number(value?))
    }
}

/// Places before and behind the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Format {
    whole: u8,
    fraction: u8,
}

/// `#100[53]` at `from`: the variable, its format, and where the next item begins. Decimals have places before and
/// behind the point, binary words only behind it.
fn print_item(text: &[u8], from: usize, is_decimal: bool) -> Option<(Range<usize>, Format, usize)> {
    let mut at = from;
    while text.get(at) == Some(&b'#') {
        at += 1;
    }
    if text.get(at) == Some(&b'[') {
        let mut depth = 0usize;
        loop {
            match text.get(at)? {
                b'[' => depth += 1,
                b']' => depth -= 1,
                _ => {}
            }
            at += 1;
            if depth == 0 {
                break;
            }
        }
    } else {
        while text.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
    }
    let variable = from..at;
    while matches!(text.get(at), Some(b' ')) {
        at += 1;
    }
    let digits = text.get(at..)?.strip_prefix(b"[")?;
    let end = digits.iter().position(|byte| *byte == b']')?;
    let format = match &digits[..end] {
        [whole @ b'0'..=b'9', fraction @ b'0'..=b'9'] if is_decimal => {
            Format { whole: whole - b'0', fraction: fraction - b'0' }
        }
        [fraction @ b'0'..=b'9'] if !is_decimal => Format { whole: 0, fraction: fraction - b'0' },
        _ => return None,
    };
    Some((variable, format, at + 1 + end + 1))
}

/// A value in decimals: a sign or a blank, digits with blanks for leading zeros (or none), the rest behind the
/// point.
fn decimal(value: f64, format: Format, without_blanks: bool) -> Option<String> {
    let Format { whole, fraction } = format;
    if whole + fraction > DIGITS_MAX || whole + fraction == 0 {
        return None;
    }
    let scale = 10f64.powi(i32::from(fraction));
    let scaled = (value.abs() * scale).round();
    if scaled >= 10f64.powi(i32::from(whole + fraction)) {
        return None;
    }
    let scaled = scaled as u64;
    let unit = 10u64.pow(u32::from(fraction));
    let is_negative = value < 0.0 && scaled != 0;
    let digits = (scaled / unit).to_string();
    let behind = if fraction == 0 {
        String::new()
    } else {
        format!(".{:0width$}", scaled % unit, width = usize::from(fraction))
    };
    let sign = if is_negative { "-" } else { " " };
    Some(if without_blanks {
        format!("{}{digits}{behind}", sign.trim())
    } else {
        format!("{sign}{digits:>width$}{behind}", width = usize::from(whole))
    })
}

/// A value as a word of four bytes, the first highest, in hexadecimal: what goes over the wire is not text.
fn binary(value: f64, format: Format) -> Option<String> {
    let scaled = (value * 10f64.powi(i32::from(format.fraction))).round();
    let fits = scaled >= f64::from(i32::MIN) && scaled <= f64::from(i32::MAX);
    fits.then(|| format!("{:08X}", scaled as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_their_columns() {
        let format = |whole, fraction| Format { whole, fraction };
        assert_eq!(decimal(128.474_2, format(3, 3), false).as_deref(), Some(" 128.474"));
        assert_eq!(decimal(-91.2, format(5, 3), false).as_deref(), Some("-   91.200"));
        assert_eq!(decimal(-91.2, format(5, 3), true).as_deref(), Some("-91.200"));
        assert_eq!(decimal(5.0, format(3, 0), true).as_deref(), Some("5"));
        assert_eq!(decimal(1000.0, format(3, 1), false), None);
        assert_eq!(decimal(1.0, format(5, 4), false), None);
    }

    #[test]
    fn words_of_four_bytes() {
        assert_eq!(binary(1.5, Format { whole: 0, fraction: 3 }).as_deref(), Some("000005DC"));
        assert_eq!(binary(1e12, Format { whole: 0, fraction: 0 }), None);
    }
}
