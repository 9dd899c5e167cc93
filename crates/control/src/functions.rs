//! The code table: which number names which function in G-code systems A, B and C, and what it is for.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

/// Which of the three code tables a control uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeSystem {
    /// X and Z absolute, U and W incremental; the lathe default.
    A,
    /// Absolute and incremental by code.
    B,
    /// As B with the cycles elsewhere.
    C,
}

/// A modal group, by the number that the manuals give it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Group(pub u8);

impl Group {
    /// One-shot codes.
    pub const ONE_SHOT: Self = Self(0);
    /// Motion.
    pub const MOTION: Self = Self(1);
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Texts {
    name: String,
    text: String,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Codes {
    a: Option<String>,
    b: Option<String>,
    c: Option<String>,
}

/// A function of the code table.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FunctionEntry {
    codes: Codes,
    group: String,
    only: Option<Vec<String>>,
    #[serde(default)]
    not_on: Vec<String>,
    /// Formats, with the letters of system A.
    #[serde(default)]
    pub forms: Vec<String>,
    en: Texts,
    zh: Texts,
}

impl FunctionEntry {
    /// Its code in a system, as text (`G71`).
    pub fn code(&self, system: CodeSystem) -> Option<&str> {
        match system {
            CodeSystem::A => self.codes.a.as_deref(),
            CodeSystem::B => self.codes.b.as_deref(),
            CodeSystem::C => self.codes.c.as_deref(),
        }
    }

    /// Its modal group.
    pub fn group(&self) -> Group {
        Group(self.group.parse().unwrap_or(0))
    }

    /// Whether a control has it, by the name of its code table.
    pub fn is_on(&self, control: &str) -> bool {
        self.only.as_ref().is_none_or(|only| only.iter().any(|name| name == control))
            && !self.not_on.iter().any(|name| name == control)
    }

    /// Its name in a language.
    pub fn name(&self, language: crate::Language) -> &str {
        match language {
            crate::Language::English => &self.en.name,
            crate::Language::Chinese => &self.zh.name,
        }
    }

    /// What it does, in a language.
    pub fn text(&self, language: crate::Language) -> &str {
        match language {
            crate::Language::English => &self.en.text,
            crate::Language::Chinese => &self.zh.text,
        }
    }
}

/// All functions, by name.
#[derive(Clone, Debug)]
pub struct Functions {
    entries: BTreeMap<String, FunctionEntry>,
}

impl Functions {
    /// The table; read when it is first asked for.
    ///
    /// # Panics
    /// Never with the data compiled in; a test reads it.
    pub fn load() -> &'static Self {
        static TABLE: OnceLock<Functions> = OnceLock::new();
        TABLE.get_or_init(|| {
            let entries = toml::from_str(include_str!("../../../data/functions.toml"))
                .unwrap_or_else(|error| unreachable!("data/functions.toml is read by a test: {error}"));
            Self { entries }
        })
    }

    /// Names and entries.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &FunctionEntry)> {
        self.entries.iter().map(|(name, entry)| (name.as_str(), entry))
    }

    /// A function by name.
    pub fn get(&self, name: &str) -> Option<&FunctionEntry> {
        self.entries.get(name)
    }

    /// Whether any entry says something about a control.
    pub fn knows(&self, control: &str) -> bool {
        self.entries
            .values()
            .any(|entry| entry.only.iter().flatten().chain(&entry.not_on).any(|name| name == control))
    }

    /// The function that a code (times ten) names on a control, by the name of its code table.
    pub fn by_code(&self, code: u16, system: CodeSystem, control: &str) -> Option<(&str, &FunctionEntry)> {
        self.iter().find(|(_, entry)| {
            entry.is_on(control)
                && entry
                    .code(system)
                    .is_some_and(|text| text.split('/').any(|one| parse_code(one) == Some(code)))
        })
    }
}

/// The number of a code such as `G71` or `G50.3`, times ten. Leading zeros do not matter.
pub fn parse_code(text: &str) -> Option<u16> {
    let digits = text.trim().trim_start_matches(['G', 'g', 'M', 'm']);
    let (whole, tenth) = digits.split_once('.').unwrap_or((digits, "0"));
    let whole: u16 = whole.parse().ok()?;
    let tenth: u16 = tenth.parse().ok()?;
    (whole < 1000 && tenth < 10).then_some(whole * 10 + tenth)
}
