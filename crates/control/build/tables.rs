//! Tables of `data/` as Rust constants: a program that starts reads no text.
//!
//! In: a TOML file of named entries. Out: the source of a constant slice of pairs, sorted by name. What an entry
//! lacks, and what nobody asked it for, stops the build by its name.
//!
//! Deliberately not here: what the entries mean.

use std::fmt::Debug;
use std::fs;
use std::path::Path;

use toml::{Table, Value};

/// One entry, or a table in it; asked for its keys one by one.
pub(crate) struct Entry {
    place: String,
    table: Table,
}

impl Entry {
    fn fault(&self, key: &str, what: &str) -> ! {
        panic!("{}: {key} {what}", self.place)
    }

    fn expect<T>(&self, key: &str, what: &str, value: Option<T>) -> T {
        value.unwrap_or_else(|| self.fault(key, what))
    }

    /// A text that must be there.
    pub(crate) fn text(&mut self, key: &str) -> String {
        let value = self.table.remove(key);
        self.expect(key, "is no text, or missing", value.as_ref().and_then(Value::as_str).map(literal))
    }

    /// A text that may be missing, left in place.
    pub(crate) fn peek(&self, key: &str) -> Option<&str> {
        self.table.get(key).and_then(Value::as_str)
    }

    /// A small whole number written as a text, such as `"01"`.
    pub(crate) fn decimal(&mut self, key: &str) -> String {
        let number = self.peek(key).and_then(|text| text.parse::<u8>().ok());
        self.table.remove(key);
        literal(self.expect(key, "is no number from 0 to 255, or missing", number))
    }

    /// A text that may be missing.
    pub(crate) fn optional_text(&mut self, key: &str) -> String {
        if self.table.contains_key(key) { format!("Some({})", self.text(key)) } else { "None".to_string() }
    }

    /// A list of texts; a missing one is empty.
    pub(crate) fn texts(&mut self, key: &str) -> String {
        let Some(value) = self.table.remove(key) else { return "&[]".to_string() };
        let texts: Option<Vec<String>> =
            value.as_array().and_then(|values| values.iter().map(|one| one.as_str().map(literal)).collect());
        format!("&[{}]", self.expect(key, "is no list of texts", texts).join(", "))
    }

    /// A list of texts that means something else when it is missing than when it is empty.
    pub(crate) fn optional_texts(&mut self, key: &str) -> String {
        if self.table.contains_key(key) { format!("Some({})", self.texts(key)) } else { "None".to_string() }
    }

    /// A number that must be there.
    pub(crate) fn number(&mut self, key: &str) -> String {
        let value = self.table.remove(key);
        let number =
            value.and_then(|value| value.as_float().or(value.as_integer().map(|whole| whole as f64)));
        literal(self.expect(key, "is no number, or missing", number))
    }

    /// Yes or no; no when it is missing.
    pub(crate) fn flag(&mut self, key: &str) -> String {
        let value = self.table.remove(key).unwrap_or(Value::Boolean(false));
        literal(self.expect(key, "is neither true nor false", value.as_bool()))
    }

    /// A variant of an enum, `Some(Acts::MachineFile)` of `machine-file`. The compiler knows whether it exists.
    pub(crate) fn optional_variant(&mut self, key: &str, r#enum: &str) -> String {
        let Some(value) = self.table.remove(key) else { return "None".to_string() };
        let word = self.expect(key, "is no text", value.as_str());
        format!("Some({}::{})", r#enum, pascal(word))
    }

    /// A table of texts, as pairs sorted by key.
    pub(crate) fn pairs(&mut self, key: &str) -> String {
        let mut inner = self.inner(key);
        let keys: Vec<String> = inner.table.keys().cloned().collect();
        let pairs: Vec<String> = keys.iter().map(|key| format!("({key:?}, {})", inner.text(key))).collect();
        format!("&[{}]", pairs.join(", "))
    }

    /// A table that must be there.
    pub(crate) fn inner(&mut self, key: &str) -> Self {
        match self.table.remove(key) {
            Some(Value::Table(table)) => Self { place: format!("{} {key}", self.place), table },
            _ => self.fault(key, "is no table, or missing"),
        }
    }

    /// Nothing may be left.
    pub(crate) fn end(self) {
        if let Some(key) = self.table.keys().next() {
            self.fault(key, "is not known here");
        }
    }
}

pub(crate) fn literal(value: impl Debug) -> String {
    format!("{value:?}")
}

/// `machine-file` as a type is spelled: `MachineFile`.
pub(crate) fn pascal(word: &str) -> String {
    let parts = word.split('-').filter(|part| !part.is_empty());
    parts.map(|part| part[..1].to_ascii_uppercase() + &part[1..]).collect()
}

/// The table that a file holds; the build looks at it again when it changes.
pub(crate) fn read(file: &Path) -> Table {
    println!("cargo::rerun-if-changed={}", file.display());
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    text.parse().unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// The source of `const NAME: &[(&str, TYPE)]` with what `expression` makes of each entry of a file.
pub(crate) fn constant(
    file: &Path,
    name: &str,
    r#type: &str,
    expression: fn(&mut Entry) -> String,
) -> String {
    let mut names: Vec<_> = read(file).into_iter().collect();
    names.sort_by(|a, b| a.0.cmp(&b.0));
    let mut source = format!("pub(crate) const {name}: &[(&str, {})] = &[\n", r#type);
    for (name, value) in names {
        let place = format!("{} [{name}]", file.file_name().unwrap_or_default().display());
        let Value::Table(table) = value else { panic!("{place} is no table") };
        let mut entry = Entry { place, table };
        source.push_str(&format!("    ({name:?}, {}),\n", expression(&mut entry)));
        entry.end();
    }
    source.push_str("];\n");
    source
}

/// A table as the source of pairs of key and `Given`.
pub(crate) fn given_pairs(table: &Table) -> String {
    let pairs: Vec<String> =
        table.iter().map(|(key, value)| format!("({key:?}, {})", given(key, value))).collect();
    format!("&[{}]", pairs.join(", "))
}

fn given(place: &str, value: &Value) -> String {
    match value {
        Value::String(text) => format!("Text({text:?})"),
        Value::Integer(whole) => format!("Whole({whole})"),
        Value::Float(number) => format!("Number({number:?})"),
        Value::Boolean(truth) => format!("Truth({truth})"),
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(|value| given(place, value)).collect();
            format!("List(&[{}])", values.join(", "))
        }
        Value::Table(table) => format!("Table({})", given_pairs(table)),
        Value::Datetime(_) => panic!("{place} is a date"),
    }
}
