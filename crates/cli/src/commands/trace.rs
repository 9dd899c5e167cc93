//! `turnwright trace`: the canonical commands, one a line.
//!
//! In: one program. Out: a stream of JSON lines or the listing, through one buffer that is used again and
//! again. The alarm is the last line, and is also said on standard error.

use std::io::{self, IsTerminal, Write};

use turnwright_canon::{Command, write_listing};
use turnwright_export::formats::jsonl::{self, CommandWriter};

use crate::arguments::{Trace, TraceFormat};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::render::Printer;
use crate::session::Session;

/// Bytes gathered before they are written.
pub(crate) const BUFFER_BYTES: usize = 64 * 1024;

/// Writes the trace.
pub(crate) fn run(options: &Trace, printer: &Printer) -> Result<Status, Fault> {
    let mut out = io::stdout().lock();
    let format =
        options.format.unwrap_or(if out.is_terminal() { TraceFormat::Human } else { TraceFormat::Jsonl });
    let text = ProgramText::open(&options.file, printer.speech)?;
    let session = Session::choose(&text, &options.machine, printer.speech)?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let decimals = execution.interpreter().decimals();
    let mut writer = CommandWriter::new(decimals);

    let mut buffer = Vec::with_capacity(BUFFER_BYTES + 4096);
    if format == TraceFormat::Jsonl {
        jsonl::write_header(&mut buffer, &jsonl::TraceHeader { control: session.control.name });
    }
    while let Some(command) = execution.next_command() {
        match format {
            TraceFormat::Jsonl => write_json(&mut buffer, &mut writer, &command, &execution),
            TraceFormat::Text => write_line(&mut buffer, &command, decimals),
            TraceFormat::Human => {
                let _ = write!(buffer, "{:>6}  ", command.origin.line);
                write_line(&mut buffer, &command, decimals);
            }
        }
        if buffer.len() >= BUFFER_BYTES {
            out.write_all(&buffer)?;
            buffer.clear();
        }
    }
    if format == TraceFormat::Jsonl {
        write_alarm(&mut buffer, &execution, printer);
    }
    out.write_all(&buffer)?;
    out.flush()?;

    let denies = !options.machine.deny.is_empty();
    let findings =
        if denies { execution.findings() } else { execution.alarm_finding().into_iter().collect() };
    for finding in &findings {
        printer.finding(finding, Some(&text));
    }
    Ok(findings.iter().map(|finding| finding.status()).max().unwrap_or(Status::Clean))
}

/// One command as JSON, with its file when that is another than the program's.
#[inline]
pub(crate) fn write_json(
    buffer: &mut Vec<u8>,
    writer: &mut CommandWriter,
    command: &Command,
    execution: &Execution<'_>,
) {
    match execution.other_file(command.origin.source) {
        None => writer.write(buffer, command),
        Some(file) => writer.write_of_file(buffer, command, file),
    }
}

fn write_line(buffer: &mut Vec<u8>, command: &Command, decimals: u8) {
    write_listing(buffer, command, decimals);
    buffer.push(b'\n');
}

/// The alarm that ended the program, as the last line of a trace.
pub(crate) fn write_alarm(buffer: &mut Vec<u8>, execution: &Execution<'_>, printer: &Printer) {
    let Some(finding) = execution.alarm_finding() else { return };
    let messages = printer.speech.messages();
    let words = finding.words(messages, printer.speech.language);
    let trace = &finding.diagnostic.trace;
    let alarm = jsonl::TraceAlarm {
        id: &finding.id(messages),
        key: finding.diagnostic.key,
        message: &words.message,
        line: finding.diagnostic.place.map_or(0, |place| place.line),
        sequence: finding.spot(Some(execution.text())).and_then(|spot| sequence_number(&spot.text)),
        program: execution.program(),
        depth: u8::try_from(trace.len()).unwrap_or(u8::MAX),
        file: finding.diagnostic.place.and_then(|place| execution.other_file(place.source.0)),
    };
    jsonl::write_alarm(buffer, &alarm);
}

/// The sequence number at the start of a line, behind the marks of a block that can be skipped.
fn sequence_number(line: &str) -> Option<u32> {
    let rest = line.trim_start().trim_start_matches(|c: char| c == '/' || c.is_ascii_digit()).trim_start();
    let digits = rest.strip_prefix(['N', 'n'])?.trim_start();
    let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    digits[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sequence_numbers_stand_at_the_start() {
        assert_eq!(sequence_number("N10 G00"), Some(10));
        assert_eq!(sequence_number(" /2 N0020G0"), Some(20));
        assert_eq!(sequence_number("G00 N10"), None);
        assert_eq!(sequence_number("N"), None);
        assert_eq!(sequence_number("N99999999999"), None);
    }
}
