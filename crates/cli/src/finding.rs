//! A diagnostic together with the file that it is about, put into words and columns that people count.

use std::ops::Range;

use serde_json::{Value, json};
use std::borrow::Cow;
use turnwright_control::policy::AlarmIds;

use turnwright_control::{Language, MessageText, Messages};
use turnwright_diagnostics::{Diagnostic, Place, Severity};

use crate::environment::ProgramText;
use crate::fault::Status;

/// Something that was found, and in which file.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    /// Name of the file; empty when it is about no file.
    pub(crate) file: String,
    /// What was found.
    pub(crate) diagnostic: Box<Diagnostic>,
    /// More about this one case: the nearest name, the words of the system.
    pub(crate) hint: Option<String>,
    /// The file that shows it.
    pub(crate) picture: Option<String>,
    /// The numbers of the control that was in use.
    ids: AlarmIds,
    is_failure: bool,
    /// Where it is, looked up already.
    located: Option<Box<Spot>>,
}

impl Finding {
    /// A diagnostic about a file.
    pub(crate) fn new(file: impl Into<String>, diagnostic: Diagnostic) -> Self {
        Self {
            file: file.into(),
            diagnostic: Box::new(diagnostic),
            hint: None,
            picture: None,
            ids: AlarmIds::Four,
            is_failure: false,
            located: None,
        }
    }

    /// The same, as a fault of usage, reading or writing.
    pub(crate) fn failed(mut self) -> Self {
        self.is_failure = true;
        self
    }

    /// The same, with more about this case.
    pub(crate) fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same, with the numbers that a control shows.
    pub(crate) fn with_ids(mut self, ids: AlarmIds) -> Self {
        self.ids = ids;
        self
    }

    /// The same, its place looked up in its text.
    pub(crate) fn located(mut self, text: &ProgramText) -> Self {
        self.located = self.spot(Some(text)).map(Box::new);
        self
    }

    /// What it means for the exit status.
    pub(crate) fn status(&self) -> Status {
        match self.diagnostic.severity {
            _ if self.is_failure => Status::Failed,
            Severity::Alarm | Severity::Error => Status::Found,
            Severity::Warning | Severity::Note => Status::Clean,
        }
    }

    /// Whether it stops a program, or would.
    pub(crate) fn is_alarm_or_error(&self) -> bool {
        self.is_failure || matches!(self.diagnostic.severity, Severity::Alarm | Severity::Error)
    }

    /// The control's own number where it has one, else ours, else the name.
    pub(crate) fn id(&self, messages: Messages) -> Cow<'static, str> {
        messages.id_of(&self.diagnostic, self.ids).unwrap_or(Cow::Borrowed(self.diagnostic.key))
    }

    /// Its words.
    pub(crate) fn words(&self, messages: Messages, language: Language) -> MessageText {
        messages.text(&self.diagnostic, language)
    }

    /// Where it is, as people count; `None` when it is about the file as a whole.
    pub(crate) fn spot(&self, text: Option<&ProgramText>) -> Option<Spot> {
        let place = self.diagnostic.place.as_ref()?;
        Some(self.located.as_deref().cloned().unwrap_or_else(|| Spot::new(place, text)))
    }

    /// One line of JSON, with the fields of the contract in their order.
    pub(crate) fn to_json_line(&self, messages: Messages, language: Language, spot: Option<&Spot>) -> String {
        let fields = self.json_fields(messages, language, spot);
        let inner: Vec<String> = fields.iter().map(|(name, value)| format!("\"{name}\":{value}")).collect();
        format!("{{{}}}", inner.join(","))
    }

    /// The same as a value.
    pub(crate) fn to_json(&self, messages: Messages, language: Language, spot: Option<&Spot>) -> Value {
        let picture = self.picture.as_ref().map(|file| ("picture", json!(file)));
        self.json_fields(messages, language, spot)
            .into_iter()
            .chain(picture)
            .map(|(name, value)| (name.to_string(), value))
            .collect()
    }

    fn json_fields(
        &self,
        messages: Messages,
        language: Language,
        spot: Option<&Spot>,
    ) -> [(&'static str, Value); 11] {
        let words = self.words(messages, language);
        let (line, column, end_column) =
            spot.map_or((0, 0, 0), |spot| (spot.line, spot.column, spot.end_column));
        let trace: Vec<Value> = self
            .diagnostic
            .trace
            .iter()
            .map(|call| json!({ "program": call.program, "line": call.line }))
            .collect();
        let message = match &self.hint {
            Some(hint) => Cow::Owned(format!("{} ({hint})", words.message)),
            None => words.message,
        };
        [
            ("file", json!(self.file)),
            ("severity", json!(severity_word(self.diagnostic.severity))),
            ("id", json!(self.id(messages))),
            ("key", json!(self.diagnostic.key)),
            ("line", json!(line)),
            ("column", json!(column)),
            ("end_column", json!(end_column)),
            ("message", json!(message)),
            ("cause", json!(words.cause)),
            ("remedy", json!(words.remedy)),
            ("trace", Value::Array(trace)),
        ]
    }
}

/// The word of the JSON formats.
pub(crate) const fn severity_word(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
        Severity::Alarm => "alarm",
    }
}

/// A place in a line, in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Spot {
    /// Line, from 1.
    pub(crate) line: u32,
    /// First character, from 1.
    pub(crate) column: u32,
    /// First character behind; greater than `column` unless the line is not known.
    pub(crate) end_column: u32,
    /// The line.
    pub(crate) text: String,
    /// The stretch, in bytes of `text`.
    pub(crate) span: Range<usize>,
}

impl Spot {
    /// Looks a place up in its text. Without the text the columns are those of the place.
    pub(crate) fn new(place: &Place, text: Option<&ProgramText>) -> Self {
        let offset = match place.line_offset {
            u64::MAX => text.and_then(|text| text.offset_of_line(place.line)),
            offset => Some(offset),
        };
        let (Some(text), Some(offset)) = (text, offset) else {
            let (column, end_column) = (place.column, place.end_column);
            return Self { line: place.line, column, end_column, text: String::new(), span: 0..0 };
        };
        let mut spot = Self::in_line(&text.line_at(offset), place.column, place.end_column);
        spot.line = place.line;
        if place.line_offset == u64::MAX {
            // Only the line is known: all of it is meant.
            let start = spot.text.len() - spot.text.trim_start().len();
            spot.span = start..spot.text.trim_end().len().max(start);
            spot.column = spot.text[..spot.span.start].chars().count() as u32 + 1;
            spot.end_column = spot.text[..spot.span.end].chars().count() as u32 + 1;
        }
        spot
    }

    fn in_line(line: &[u8], column: u32, end_column: u32) -> Self {
        let text = decode(line);
        let chars_before = |column: u32| {
            let bytes = (column as usize).saturating_sub(1).min(line.len());
            decode_as(&line[..bytes], line).chars().count()
        };
        let first = chars_before(column);
        let last = chars_before(end_column).max(first);
        let byte_of = |chars: usize| text.char_indices().nth(chars).map_or(text.len(), |(at, _)| at);
        let span = byte_of(first)..byte_of(last);
        Self { line: 0, column: first as u32 + 1, end_column: last as u32 + 1, text, span }
    }
}

/// A line of a program as text: UTF-8, else GBK as Chinese shop floors have it, else what can be read of it.
pub(crate) fn decode(line: &[u8]) -> String {
    decode_as(line, line)
}

/// The first part of a line in the encoding that the whole line has.
fn decode_as(part: &[u8], line: &[u8]) -> String {
    if std::str::from_utf8(line).is_ok() {
        return String::from_utf8_lossy(part).into_owned();
    }
    match encoding_rs::GB18030.decode_without_bom_handling(line) {
        (_, false) => encoding_rs::GB18030.decode_without_bom_handling(part).0.into_owned(),
        (_, true) => String::from_utf8_lossy(part).into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_in_any_encoding() {
        let word = |line: &[u8]| {
            let start = line.windows(2).position(|two| two == b"U2").expect("the word") as u32 + 1;
            let spot = Spot::in_line(line, start, start + 2);
            (spot.column, spot.end_column, spot.text[spot.span.clone()].to_string())
        };
        assert_eq!(word("G71 (车刀) U2".as_bytes()), (10, 12, "U2".to_string()));
        // The same in GBK, and with a byte that is no text at all.
        assert_eq!(word(b"G71 (\xb3\xb5\xb5\xb6) U2"), (10, 12, "U2".to_string()));
        assert_eq!(word(b"G71 (\xff) U2"), (9, 11, "U2".to_string()));
    }

    #[test]
    fn a_place_beyond_the_line_is_its_end() {
        let spot = Spot::in_line(b"G71", 9, 12);
        assert_eq!((spot.column, spot.end_column, spot.span), (4, 4, 3..3));
    }
}
