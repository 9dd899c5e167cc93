//! The code table: which number names which function in G-code systems A, B and C, and what it is for.

use crate::names;

mod table {
    //! Made of `data/functions.toml` by the build script.
    use super::{Codes, FunctionEntry, Texts};
    include!(concat!(env!("OUT_DIR"), "/functions.rs"));
}

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

#[derive(Clone, Debug)]
struct Texts {
    name: &'static str,
    text: &'static str,
}

/// The codes of a function in the three systems, as text and as numbers.
#[derive(Clone, Debug)]
struct Codes {
    texts: [Option<&'static str>; 3],
    numbers: [&'static [u16]; 3],
}

/// A function of the code table.
#[derive(Clone, Debug)]
pub struct FunctionEntry {
    codes: Codes,
    group: u8,
    only: Option<&'static [&'static str]>,
    not_on: &'static [&'static str],
    /// What it does cannot be told from a program: it is refused for good.
    pub outside_scope: bool,
    only_with: Option<&'static str>,
    /// Formats, with the letters of system A.
    pub forms: &'static [&'static str],
    en: Texts,
    zh: Texts,
}

impl FunctionEntry {
    /// Its code in a system, as text (`G71`).
    pub fn code(&self, system: CodeSystem) -> Option<&'static str> {
        self.codes.texts[system as usize]
    }

    /// The numbers of its codes in a system, times ten; the first is the one it is called by.
    pub fn code_numbers(&self, system: CodeSystem) -> &'static [u16] {
        self.codes.numbers[system as usize]
    }

    /// Its modal group.
    pub const fn group(&self) -> Group {
        Group(self.group)
    }

    /// Whether a control has it, by the name of its code table.
    pub fn is_on(&self, control: &str) -> bool {
        self.only.is_none_or(|only| only.contains(&control)) && !self.not_on.contains(&control)
    }

    /// The parameter that must be set for its code to name it; another function has the code otherwise.
    pub const fn only_with(&self) -> Option<&'static str> {
        self.only_with
    }

    /// Its name in a language.
    pub const fn name(&self, language: crate::Language) -> &'static str {
        match language {
            crate::Language::English => self.en.name,
            crate::Language::Chinese => self.zh.name,
        }
    }

    /// What it does, in a language.
    pub const fn text(&self, language: crate::Language) -> &'static str {
        match language {
            crate::Language::English => self.en.text,
            crate::Language::Chinese => self.zh.text,
        }
    }
}

/// All functions, by name: `data/functions.toml`, compiled in.
#[derive(Clone, Copy, Debug)]
pub struct Functions;

impl Functions {
    /// Names and entries, sorted by name.
    pub fn iter(self) -> impl Iterator<Item = (&'static str, &'static FunctionEntry)> {
        table::ENTRIES.iter().map(|(name, entry)| (*name, entry))
    }

    /// A function by name.
    pub fn get(self, name: &str) -> Option<&'static FunctionEntry> {
        let place = names::place(table::ENTRIES_SLOTS, table::ENTRIES, name)?;
        Some(&table::ENTRIES[place].1)
    }

    /// Whether any entry says something about a control.
    pub fn knows(self, control: &str) -> bool {
        self.iter().any(|(_, entry)| {
            entry.only.is_some_and(|only| only.contains(&control)) || entry.not_on.contains(&control)
        })
    }

    /// The function that a code (times ten) names on a control, by the name of its code table.
    pub fn by_code(
        self,
        code: u16,
        system: CodeSystem,
        control: &str,
    ) -> Option<(&'static str, &'static FunctionEntry)> {
        let named = self
            .iter()
            .filter(|(_, entry)| entry.code_numbers(system).contains(&code) && entry.is_on(control));
        named.min_by_key(|(_, entry)| entry.only_with.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_code;

    /// Codes of a group in systems A, B and C, `-` where a system has none.
    const GROUPS: [(u8, &str); 17] = [
        (1, "00,00,00 01,01,01 02,02,02 03,03,03 32,33,33 34,34,34 90,77,20 92,78,21 94,79,24"),
        (2, "96,96,96 97,97,97"),
        (3, "-,90,90 -,91,91"),
        (4, "68,68,68 69,69,69"),
        (5, "98,94,94 99,95,95"),
        (6, "20,20,70 21,21,71"),
        (7, "40,40,40 41,41,41 42,42,42"),
        (8, "25,25,25 26,26,26"),
        (9, "22,22,22 23,23,23"),
        (10, "80,80,80 83,83,83 84,84,84 85,85,85 87,87,87 88,88,88 89,89,89"),
        (11, "-,98,98 -,99,99"),
        (12, "66,66,66 67,67,67"),
        (14, "54,54,54 55,55,55 56,56,56 57,57,57 58,58,58 59,59,59"),
        (15, "61,61,61 63,63,63 64,64,64"),
        (16, "17,17,17 18,18,18 19,19,19"),
        (20, "50.2,50.2,50.2 51.2,51.2,51.2"),
        (21, "12.1,12.1,12.1 13.1,13.1,13.1"),
    ];

    const ONE_SHOT: &str = "04,04,04 09,09,09 10,10,10 11,11,11 27,27,27 28,28,28 30,30,30 31,31,31 50,92,92 \
                            50.3,92.1,92.1 52,52,52 53,53,53 65,65,65 70,70,72 71,71,73 72,72,74 73,73,75 \
                            74,74,76 75,75,77 76,76,78";

    #[test]
    fn every_name_is_found_and_no_other() {
        for (name, entry) in Functions.iter() {
            assert!(Functions.get(name).is_some_and(|found| std::ptr::eq(found, entry)), "{name}");
            assert!(Functions.get(&format!("{name}-")).is_none(), "{name}");
        }
        assert!(Functions.get("").is_none());
    }

    #[test]
    fn every_code_of_the_three_systems_is_in_its_group() {
        let functions = Functions;
        let mut count = 0;
        for (group, rows) in GROUPS.iter().copied().chain([(0, ONE_SHOT)]) {
            for row in rows.split_whitespace() {
                let systems = [CodeSystem::A, CodeSystem::B, CodeSystem::C];
                let mut names = Vec::new();
                for (system, text) in systems.into_iter().zip(row.split(',')).filter(|(_, text)| *text != "-")
                {
                    let code = parse_code(text).expect("a code");
                    let found = functions.by_code(code, system, "fanuc-0i-tf");
                    let (name, entry) = found.unwrap_or_else(|| panic!("G{text} in {system:?}"));
                    assert_eq!(entry.group(), Group(group), "{name}");
                    names.push(name);
                    count += 1;
                }
                names.dedup();
                assert_eq!(names.len(), 1, "{row} is one function: {names:?}");
            }
        }
        assert!(count > 180, "{count}");
    }
}
