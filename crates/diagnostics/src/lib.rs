//! What went wrong and where, as data.
//!
//! In: keys, places and arguments from every stage. Out: [`Diagnostic`] values for renderers.
//! Deliberately not here: sentences, alarm numbers and rendering. A key such as `cut-depth-illegal` gets its
//! number from the control and its words, in any language, from `data/` at the edge.

use turnwright_units::Length;

/// Which program text a place lies in; the caller that opened the texts knows their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct SourceId(pub u32);

/// A stretch of one line of a program text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Place {
    /// The text.
    pub source: SourceId,
    /// Line, counted from 1.
    pub line: u32,
    /// Bytes from the start of the text to the start of the line.
    pub line_offset: u64,
    /// First byte of the stretch, counted from 1 at the start of the line.
    pub column: u32,
    /// First byte behind the stretch, counted likewise; equal to `column` for a point.
    pub end_column: u32,
}

/// How much a diagnostic matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Said so that the user can understand the rest.
    Note,
    /// The control runs on, a machinist would look twice.
    Warning,
    /// Not the control's business: a file, an option, a limit of this program.
    Error,
    /// The control stops here.
    Alarm,
}

/// A value put into a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// Text as it is.
    Text(Box<str>),
    /// A whole number.
    Integer(i64),
    /// A length, shown in millimetres.
    Length(Length),
    /// A function of the code table by its key, shown by its name in the language of the message.
    Function(Box<str>),
}

impl From<&str> for Argument {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Argument {
    fn from(text: String) -> Self {
        Self::Text(text.into_boxed_str())
    }
}

impl From<i64> for Argument {
    fn from(number: i64) -> Self {
        Self::Integer(number)
    }
}

impl From<u32> for Argument {
    fn from(number: u32) -> Self {
        Self::Integer(number.into())
    }
}

impl From<Length> for Argument {
    fn from(length: Length) -> Self {
        Self::Length(length)
    }
}

/// One step of the way that led to the place: the call of a subprogram, macro or cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// Number of the calling program, 0 when it has none.
    pub program: u32,
    /// Line of the call.
    pub line: u32,
}

/// Another place that helps to understand the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Related {
    /// Where.
    pub place: Place,
    /// Key of the words shown there.
    pub key: &'static str,
}

/// A diagnostic as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Name of the diagnostic, `kebab-case`; the entry in `data/alarms.toml` has the same name.
    pub key: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// Where it is; `None` when it concerns the text as a whole.
    pub place: Option<Place>,
    /// Values for the message, by name.
    pub arguments: Vec<(&'static str, Argument)>,
    /// The calls that led there, outermost first.
    pub trace: Vec<Call>,
    /// Other places worth showing.
    pub related: Vec<Related>,
}

impl Diagnostic {
    /// A diagnostic with nothing but its key and severity.
    pub fn new(severity: Severity, key: &'static str) -> Self {
        Self { key, severity, place: None, arguments: Vec::new(), trace: Vec::new(), related: Vec::new() }
    }

    /// An alarm of the control.
    pub fn alarm(key: &'static str) -> Self {
        Self::new(Severity::Alarm, key)
    }

    /// A warning.
    pub fn warning(key: &'static str) -> Self {
        Self::new(Severity::Warning, key)
    }

    /// An error that is not the control's.
    pub fn error(key: &'static str) -> Self {
        Self::new(Severity::Error, key)
    }

    /// Puts it at a place.
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Adds a value for the message.
    pub fn with(mut self, name: &'static str, value: impl Into<Argument>) -> Self {
        self.arguments.push((name, value.into()));
        self
    }

    /// Adds another place worth showing.
    pub fn near(mut self, place: Place, key: &'static str) -> Self {
        self.related.push(Related { place, key });
        self
    }
}
