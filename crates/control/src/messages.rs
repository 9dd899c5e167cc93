//! The words of diagnostics, in English and Chinese, and the numbers that controls print for them.

use std::borrow::Cow;

use turnwright_diagnostics::{Argument, Diagnostic};

use crate::Functions;
use crate::policy::AlarmIds;

mod table {
    //! Made of `data/alarms.toml` by the build script.
    use std::borrow::Cow;

    use super::{Entry, Ids, MessageText, RaisedBy};
    include!(concat!(env!("OUT_DIR"), "/messages.rs"));
}

/// A language that every text exists in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Chinese.
    Chinese,
}

/// A diagnostic in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageText {
    /// What is wrong.
    pub message: Cow<'static, str>,
    /// Why.
    pub cause: Cow<'static, str>,
    /// What to do.
    pub remedy: Cow<'static, str>,
}

#[derive(Clone, Debug)]
struct Ids {
    three: Option<&'static str>,
    four: Option<&'static str>,
    named: Option<&'static str>,
    own: Option<&'static str>,
}

/// What raises a diagnostic that no program in the fixtures can raise; the head of `data/alarms.toml` tells more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaisedBy {
    /// Editing, searching, MDI and manual work at the panel.
    Operator,
    /// Drives, signals and the machine's own logic.
    Device,
    /// Files, options and setups of the command line.
    CommandLine,
    /// A guard against huge texts, or against a fault of our own.
    Limit,
    /// A reading of a policy that no control has as delivered.
    Policy,
    /// It stands beside another diagnostic and names a second place.
    Note,
    /// An option that none of the machines has.
    Option,
    /// A function that is refused by name.
    OutsideScope,
}

impl RaisedBy {
    /// Whether the code raises it today.
    pub const fn is_raised(self) -> bool {
        matches!(self, Self::CommandLine | Self::Limit | Self::Policy | Self::Note)
    }
}

#[derive(Clone, Debug)]
struct Entry {
    ids: Ids,
    raised_by: Option<RaisedBy>,
    en: MessageText,
    zh: MessageText,
}

/// All texts of diagnostics: `data/alarms.toml`, compiled in.
#[derive(Clone, Copy, Debug)]
pub struct Messages;

impl Messages {
    fn entry(key: &str) -> Option<&'static Entry> {
        let index = table::ENTRIES.binary_search_by_key(&key, |(known, _)| known).ok()?;
        Some(&table::ENTRIES[index].1)
    }

    /// All keys, sorted.
    pub fn keys(self) -> impl Iterator<Item = &'static str> {
        table::ENTRIES.iter().map(|(key, _)| *key)
    }

    /// The number of a diagnostic: the control's own where it has one, else ours.
    pub fn id(self, key: &str, ids: AlarmIds) -> Option<&'static str> {
        let entry = &Self::entry(key)?.ids;
        let own = match ids {
            AlarmIds::Three => entry.three,
            AlarmIds::Four => entry.four,
            AlarmIds::Named => entry.named,
        };
        own.or(entry.own)
    }

    /// The number of this diagnostic; the number of an alarm that the program raised is part of it.
    pub fn id_of(self, diagnostic: &Diagnostic, ids: AlarmIds) -> Option<Cow<'static, str>> {
        let id = self.id(diagnostic.key, ids)?;
        Some(if id.contains('{') {
            Cow::Owned(fill(id, &diagnostic.arguments, Language::English))
        } else {
            Cow::Borrowed(id)
        })
    }

    /// The number of ours that stands where a control has none.
    pub fn own_id(self, key: &str) -> Option<&'static str> {
        Self::entry(key)?.ids.own
    }

    /// What raises it, when that is no program of the fixtures.
    pub fn raised_by(self, key: &str) -> Option<RaisedBy> {
        Self::entry(key)?.raised_by
    }

    /// Keys that a number names on a control (several conditions may share one number).
    pub fn by_id(self, number: &str, ids: AlarmIds) -> Vec<&'static str> {
        let wanted = number.trim().to_ascii_uppercase();
        self.keys().filter(|key| self.id(key, ids).is_some_and(|id| is_same_id(id, &wanted))).collect()
    }

    /// A diagnostic in words, with its arguments put in.
    pub fn text(self, diagnostic: &Diagnostic, language: Language) -> MessageText {
        let Some(raw) = self.raw(diagnostic.key, language) else {
            let nothing = Cow::Borrowed("");
            return MessageText {
                message: Cow::Borrowed(diagnostic.key),
                cause: nothing.clone(),
                remedy: nothing,
            };
        };
        let fill = |text: &Cow<'static, str>| {
            if text.contains('{') {
                Cow::Owned(fill(text, &diagnostic.arguments, language))
            } else {
                text.clone()
            }
        };
        MessageText { message: fill(&raw.message), cause: fill(&raw.cause), remedy: fill(&raw.remedy) }
    }

    /// The key of the alarm that programs raise themselves, with numbers of their own.
    pub const OF_PROGRAM: &str = "macro-user-alarm";

    /// The words behind a key, arguments still in braces.
    pub fn raw(self, key: &str, language: Language) -> Option<&'static MessageText> {
        let entry = Self::entry(key)?;
        Some(match language {
            Language::English => &entry.en,
            Language::Chinese => &entry.zh,
        })
    }
}

/// Letters that controls set before a number: the class of the alarm.
const CLASSES: [&str; 8] = ["PS", "OT", "OH", "SV", "SP", "SW", "PW", "MC"];

/// Class and number: `PS0010` is PS and 10. What has no number is its own class.
fn class_and_number(id: &str) -> (&str, Option<u32>) {
    let class = CLASSES.into_iter().find(|class| id.starts_with(class)).unwrap_or("");
    match id[class.len()..].parse() {
        Ok(number) => (class, Some(number)),
        Err(_) => (id, None),
    }
}

/// `PS0010`, `ps10` and `0010` are one number; OT0500 and PS0500 are two.
fn is_same_id(id: &str, asked: &str) -> bool {
    let ((class, number), (asked_class, asked_number)) = (class_and_number(id), class_and_number(asked));
    let may_lack_class = number.is_some() && (class.is_empty() || asked_class.is_empty());
    number == asked_number && (class == asked_class || may_lack_class)
}

fn fill(text: &str, arguments: &[(&'static str, Argument)], language: Language) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(open) = rest.find('{') {
        out.push_str(&rest[..open]);
        rest = &rest[open..];
        let Some(close) = rest.find('}') else { break };
        let name = &rest[1..close];
        match arguments.iter().find(|(known, _)| *known == name) {
            Some((_, Argument::Text(value))) => out.push_str(value),
            Some((_, Argument::Integer(value))) => out.push_str(&value.to_string()),
            Some((_, Argument::Length(value))) => out.push_str(&value.to_string()),
            Some((_, Argument::Function(key))) => {
                let entry = Functions.get(key);
                out.push_str(entry.map_or(key, |entry| entry.name(language)));
            }
            None => out.push('?'),
        }
        rest = &rest[close + 1..];
    }
    out.push_str(rest);
    out
}
