//! Program texts: files and standard input, read at any offset.
//!
//! Small files are held in memory, large ones are read where they lie, so that memory does not grow with the
//! length of a program. Streams (standard input, pipes) are held in memory up to [`STREAM_BYTES_MAX`].

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use turnwright_control::{AxisPair, Setup};
use turnwright_diagnostics::{Diagnostic, SourceId};
use turnwright_interpreter::{DateTime, Environment, ProgramName, ReadFault, SignalMove};
use turnwright_syntax::find_line_end;
use turnwright_units::{Position, WorkTip};

use crate::arguments::Machine;
use crate::finding::Finding;
use crate::speech::Speech;

/// Files up to this size are held in memory.
const MEMORY_BYTES_MAX: u64 = 8 * 1024 * 1024;

/// A stream cannot be read twice, so it is kept; longer ones are refused.
const STREAM_BYTES_MAX: u64 = 256 * 1024 * 1024;

/// Bytes of a line that are looked at to show it.
const LINE_BYTES_MAX: usize = 64 * 1024;

/// The name that stands for standard input.
pub(crate) const STANDARD_INPUT: &str = "-";

/// A program text.
#[derive(Debug)]
pub(crate) struct ProgramText {
    /// Its name in messages.
    pub(crate) name: String,
    /// Its file, unless it is a stream.
    pub(crate) path: Option<PathBuf>,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Memory(Vec<u8>),
    File { file: File, bytes: u64 },
}

impl ProgramText {
    /// Opens a text.
    pub(crate) fn open(path: &Path, speech: Speech) -> Result<Self, Finding> {
        let name = path.display().to_string();
        let fault = |error: &io::Error| unreadable(&name, error, speech);
        if path.as_os_str() == STANDARD_INPUT {
            let content = Content::Memory(read_stream(&name, io::stdin().lock(), speech)?);
            return Ok(Self { name, path: None, content });
        }
        let file = File::open(path).map_err(|error| fault(&error))?;
        let metadata = file.metadata().map_err(|error| fault(&error))?;
        if metadata.is_dir() {
            return Err(Finding::new(&name, Diagnostic::error("file-is-a-directory")).failed());
        }
        let content = if !metadata.is_file() {
            Content::Memory(read_stream(&name, file, speech)?)
        } else if metadata.len() <= MEMORY_BYTES_MAX {
            let mut bytes = Vec::with_capacity(metadata.len() as usize + 1);
            // One byte more shows a file that has grown since.
            (&file).take(MEMORY_BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|error| fault(&error))?;
            Content::Memory(bytes)
        } else {
            Content::File { file, bytes: metadata.len() }
        };
        Ok(Self { name, path: Some(path.to_path_buf()), content })
    }

    /// A text that has been read already.
    pub(crate) fn in_memory(name: impl Into<String>, bytes: &[u8]) -> Self {
        Self { name: name.into(), path: None, content: Content::Memory(bytes.to_vec()) }
    }

    /// Its length in bytes.
    pub(crate) fn len(&self) -> u64 {
        match &self.content {
            Content::Memory(bytes) => bytes.len() as u64,
            Content::File { bytes, .. } => *bytes,
        }
    }

    /// Bytes from an offset on; 0 at the end.
    pub(crate) fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        match &self.content {
            Content::Memory(bytes) => {
                let rest = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).unwrap_or(&[]);
                let count = rest.len().min(buffer.len());
                buffer[..count].copy_from_slice(&rest[..count]);
                Ok(count)
            }
            Content::File { file, .. } => loop {
                match read_file_at(file, offset, buffer) {
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    result => return result,
                }
            },
        }
    }

    /// The bytes behind an offset, as many as a line may have.
    fn line_room(&self, offset: u64) -> usize {
        usize::try_from(self.len().saturating_sub(offset)).unwrap_or(usize::MAX).min(LINE_BYTES_MAX)
    }

    /// The first bytes of the text, as many as a line may have.
    pub(crate) fn head(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.line_room(0)];
        let count = self.read_at(0, &mut bytes).unwrap_or(0);
        bytes.truncate(count);
        bytes
    }

    /// The bytes of the line that starts at an offset, without its end; the head of a very long one.
    pub(crate) fn line_at(&self, offset: u64) -> Vec<u8> {
        let mut bytes = vec![0; self.line_room(offset)];
        let mut length = 0;
        while length < bytes.len() {
            match self.read_at(offset + length as u64, &mut bytes[length..]) {
                Ok(0) | Err(_) => break,
                Ok(count) => {
                    length += count;
                    if find_line_end(&bytes[..length], false).is_some() {
                        break;
                    }
                }
            }
        }
        bytes.truncate(length);
        let end = find_line_end(&bytes, true).map_or(bytes.len(), |end| end.start);
        bytes.truncate(end);
        bytes
    }

    /// Where a line (from 1) starts.
    pub(crate) fn offset_of_line(&self, line: u32) -> Option<u64> {
        let mut lines = Lines::new(self);
        (1..line).try_for_each(|_| lines.next().map(|_| ()))?;
        Some(lines.offset())
    }

    /// The lines from the first one on.
    pub(crate) fn lines(&self) -> Lines<'_> {
        Lines::new(self)
    }
}

/// Finds lines that are asked for mostly one after the other, without counting from the start each time.
#[derive(Debug, Default)]
pub(crate) struct LineFinder {
    source: u32,
    /// The line found last, from 1, and where it starts.
    line: u32,
    offset: u64,
}

impl LineFinder {
    /// The bytes of a line (from 1) of a text, which is known by the number of its source.
    pub(crate) fn line(&mut self, text: &ProgramText, source: u32, line: u32) -> Vec<u8> {
        if self.source != source || self.line == 0 || line < self.line {
            (self.source, self.line, self.offset) = (source, 1, 0);
        }
        let mut lines = Lines { base: self.offset, ..Lines::new(text) };
        if (self.line..line).try_for_each(|_| lines.next().map(|_| ())).is_none() {
            return Vec::new();
        }
        (self.line, self.offset) = (line, lines.offset());
        text.line_at(self.offset)
    }
}

/// The lines of a text, one by one; a very long one gives its head.
pub(crate) struct Lines<'a> {
    text: &'a ProgramText,
    window: Vec<u8>,
    /// Offset of the window's first byte.
    base: u64,
    at: usize,
    is_last: bool,
}

impl<'a> Lines<'a> {
    fn new(text: &'a ProgramText) -> Self {
        Self { text, window: Vec::new(), base: 0, at: 0, is_last: false }
    }

    /// Where the next line starts.
    fn offset(&self) -> u64 {
        self.base + self.at as u64
    }

    fn fill(&mut self) {
        self.base += self.at as u64;
        self.window.drain(..self.at);
        self.at = 0;
        let kept = self.window.len();
        let from = self.base + kept as u64;
        self.window.resize(kept + self.text.line_room(from), 0);
        let read = self.text.read_at(from, &mut self.window[kept..]).unwrap_or(0);
        self.window.truncate(kept + read);
        self.is_last = read == 0;
    }
}

impl Iterator for Lines<'_> {
    type Item = Vec<u8>;

    fn next(&mut self) -> Option<Vec<u8>> {
        let mut head: Option<Vec<u8>> = None;
        loop {
            let rest = &self.window[self.at..];
            if let Some(end) = find_line_end(rest, self.is_last) {
                let line = head.unwrap_or_else(|| rest[..end.start].to_vec());
                self.at += end.next;
                return Some(line);
            }
            if self.is_last {
                let line = rest.to_vec();
                self.at = self.window.len();
                return head.or((!line.is_empty()).then_some(line));
            }
            if rest.len() > LINE_BYTES_MAX {
                head = head.or_else(|| Some(rest[..LINE_BYTES_MAX].to_vec()));
                // Half of a CR LF may be the last byte.
                self.at = self.window.len() - 1;
            }
            self.fill();
        }
    }
}

#[cfg(unix)]
fn read_file_at(file: &File, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(not(unix))]
fn read_file_at(mut file: &File, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
    use std::io::Seek;
    file.seek(io::SeekFrom::Start(offset))?;
    file.read(buffer)
}

fn read_stream(name: &str, stream: impl Read, speech: Speech) -> Result<Vec<u8>, Finding> {
    let mut bytes = Vec::new();
    stream
        .take(STREAM_BYTES_MAX + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| unreadable(name, &error, speech))?;
    if bytes.len() as u64 > STREAM_BYTES_MAX {
        let limit = format!("{} MiB", STREAM_BYTES_MAX / (1024 * 1024));
        return Err(Finding::new(name, Diagnostic::error("file-too-large").with("limit", limit)).failed());
    }
    Ok(bytes)
}

/// A file that cannot be read, with the system's own words.
pub(crate) fn unreadable(name: &str, error: &io::Error, speech: Speech) -> Finding {
    Finding::new(name, Diagnostic::error("file-unreadable")).failed().with_hint(speech.system(error))
}

/// Most programs called from other files in one run.
const OTHERS_MAX: usize = 1_000;

/// The world as the interpreter sees it: one text, the programs beside it, and the switches of the panel.
#[derive(Debug)]
pub(crate) struct Panel<'a> {
    text: &'a ProgramText,
    /// Programs in other files that were called; the first is source 1.
    others: Vec<ProgramText>,
    /// Numbers of programs that were looked for and found, each with its source.
    found: Vec<(u32, SourceId)>,
    skips: [bool; 10],
    stops_optionally: bool,
    speech: Speech,
    setup: Setup,
}

impl<'a> Panel<'a> {
    /// The text and the switches of the command line.
    pub(crate) fn new(text: &'a ProgramText, machine: &Machine, setup: &Setup) -> Self {
        let mut skips = [false; 10];
        for switch in &machine.skip {
            skips[usize::from(*switch % 10)] = true;
        }
        // Why a neighbour cannot be opened is not said: the call says that there is no such program.
        let speech = Speech { language: turnwright_control::Language::English };
        Self {
            text,
            others: Vec::new(),
            found: Vec::new(),
            skips,
            stops_optionally: machine.optional_stop,
            speech,
            setup: setup.clone(),
        }
    }

    /// The source of a program that another file of the folder holds.
    fn look_for(&mut self, name: ProgramName<'_>) -> Option<SourceId> {
        let path = file_beside(self.text.path.as_deref()?, name)?;
        if let Some(known) = self.others.iter().position(|other| other.path.as_deref() == Some(&path)) {
            return Some(SourceId(known as u32 + 1));
        }
        if self.others.len() >= OTHERS_MAX {
            return None;
        }
        self.others.push(ProgramText::open(&path, self.speech).ok()?);
        Some(SourceId(self.others.len() as u32))
    }

    /// A text by its number.
    pub(crate) fn source(&self, source: SourceId) -> &ProgramText {
        match source.0.checked_sub(1).and_then(|place| self.others.get(place as usize)) {
            Some(other) => other,
            None => self.text,
        }
    }
}

/// The file beside a program that holds another one: named by its number (`O1234.nc`, `1234`) or its name.
fn file_beside(program: &Path, name: ProgramName<'_>) -> Option<PathBuf> {
    let folder = program.parent()?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path != program && path.is_file() && names(path, name))
        .collect();
    // Which one, must not depend on the order of the folder.
    found.sort();
    found.into_iter().next()
}

fn names(path: &Path, name: ProgramName<'_>) -> bool {
    const EXTENSIONS: [&str; 8] = ["", "nc", "cnc", "txt", "tap", "prg", "mpf", "iso"];
    let extension = path.extension().map_or_else(String::new, |text| text.to_string_lossy().to_lowercase());
    let Some(stem) = path.file_stem().map(|stem| stem.to_string_lossy().to_uppercase()) else { return false };
    match name {
        ProgramName::Number(number) => {
            let digits = stem.strip_prefix('O').unwrap_or(&stem);
            let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
            EXTENSIONS.contains(&extension.as_str()) && is_number && digits.parse() == Ok(number)
        }
        ProgramName::Text(text) => {
            let whole =
                path.file_name().map_or_else(String::new, |file| file.to_string_lossy().to_uppercase());
            let text = text.to_uppercase();
            whole == text || (stem == text && EXTENSIONS.contains(&extension.as_str()))
        }
    }
}

impl Environment for Panel<'_> {
    fn read(&mut self, source: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        self.source(source).read_at(offset, buffer).map_err(|_| ReadFault)
    }

    fn program(&mut self, name: ProgramName<'_>) -> Option<SourceId> {
        let ProgramName::Number(number) = name else { return self.look_for(name) };
        // A loop asks again and again.
        if let Some((_, source)) = self.found.iter().find(|(known, _)| *known == number) {
            return Some(*source);
        }
        let source = self.look_for(name)?;
        self.found.push((number, source));
        Some(source)
    }

    fn now(&self) -> Option<DateTime> {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).ok()?.as_secs();
        Some(date_and_time(since_1970))
    }

    fn skips(&self, switch: u8) -> bool {
        self.skips.get(usize::from(switch)).copied().unwrap_or(false)
    }

    fn signal(&mut self, wait: &SignalMove) -> Option<f64> {
        let pair =
            |place: Position<WorkTip>| AxisPair { x: place.x.to_diameter().0.to_mm(), z: place.z.to_mm() };
        self.setup.signal(wait.line, wait.input, pair(wait.from), pair(wait.to))
    }

    fn stops_optionally(&self) -> bool {
        self.stops_optionally
    }
}

/// Seconds since 1970 as a date and a time of day, universal time.
fn date_and_time(seconds: u64) -> DateTime {
    let (days, time) = (seconds / 86_400, seconds % 86_400);
    // Years that begin in March: then the leap day is the last of its year.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    DateTime {
        year: year as u16,
        month: month as u8,
        day: day as u8,
        hour: (time / 3_600) as u8,
        minute: (time / 60 % 60) as u8,
        second: (time % 60) as u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_dates() {
        let show = |seconds| {
            let at = date_and_time(seconds);
            format!("{}-{}-{} {}:{}:{}", at.year, at.month, at.day, at.hour, at.minute, at.second)
        };
        assert_eq!(show(0), "1970-1-1 0:0:0");
        assert_eq!(show(951_827_696), "2000-2-29 12:34:56");
        assert_eq!(show(1_795_305_599), "2026-11-21 23:59:59");
    }

    #[test]
    fn programs_are_found_by_number_and_name() {
        let number = ProgramName::Number(1234);
        for file in ["O1234", "o1234.NC", "1234.txt", "O01234.cnc"] {
            assert!(names(Path::new(file), number), "{file}");
        }
        for file in ["O12345.nc", "O1234.rs", "AO1234.nc", "O.nc"] {
            assert!(!names(Path::new(file), number), "{file}");
        }
        assert!(names(Path::new("RING.CNC"), ProgramName::Text("ring")));
    }
}
