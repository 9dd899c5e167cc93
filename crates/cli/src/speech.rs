//! The words of the user interface, in the language of the user.

use std::io;

use turnwright_control::{Functions, Language, Messages};

use crate::arguments::Lang;

mod table {
    //! Made of `data/texts.toml` by the build script: key, English and Chinese.
    include!(concat!(env!("OUT_DIR"), "/texts.rs"));
}
use table::TEXTS;

/// Both languages, English first, as every table of texts has them.
pub(crate) const BOTH: [Language; 2] = [Language::English, Language::Chinese];

/// What can be said, in one language.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Speech {
    /// The language.
    pub(crate) language: Language,
}

impl Speech {
    /// The language asked for, else that of the environment.
    pub(crate) fn new(asked: Option<Lang>) -> Self {
        let language = match asked {
            Some(Lang::En) => Language::English,
            Some(Lang::Zh) => Language::Chinese,
            None => language_of_environment(),
        };
        Self { language }
    }

    /// A text; a missing one is shown by its key, so that nobody misses it.
    pub(crate) fn get(self, key: &'static str) -> &'static str {
        self.lookup(key).unwrap_or(key)
    }

    /// A text whose key is put together; empty when there is none.
    pub(crate) fn find(self, key: &str) -> &'static str {
        self.lookup(key).unwrap_or_default()
    }

    fn lookup(self, key: &str) -> Option<&'static str> {
        let index = TEXTS.binary_search_by_key(&key, |(known, _)| known).ok()?;
        let [english, chinese] = TEXTS[index].1;
        Some(if self.language == Language::English { english } else { chinese })
    }

    /// A text with values in its braces.
    pub(crate) fn fill(self, key: &str, values: &[(&str, &str)]) -> String {
        let text = self.lookup(key).unwrap_or(key).to_string();
        values.iter().fold(text, |text, (name, value)| text.replace(&format!("{{{name}}}"), value))
    }

    /// Diagnostics in words.
    pub(crate) const fn messages(self) -> Messages {
        Messages
    }

    /// The code table.
    pub(crate) const fn functions(self) -> Functions {
        Functions
    }

    /// What the system says about a file, in the user's language where the case is a common one.
    pub(crate) fn system(self, error: &io::Error) -> String {
        let key = match error.kind() {
            io::ErrorKind::NotFound => "system-not-found",
            io::ErrorKind::PermissionDenied => "system-permission-denied",
            io::ErrorKind::IsADirectory => "system-is-a-directory",
            io::ErrorKind::NotADirectory => "system-not-a-directory",
            io::ErrorKind::StorageFull => "system-storage-full",
            io::ErrorKind::ReadOnlyFilesystem => "system-read-only",
            _ => return error.to_string(),
        };
        self.get(key).to_string()
    }

    /// Seconds as people say them.
    pub(crate) fn duration(self, seconds: f64) -> String {
        let tenths = (seconds * 10.0).round().max(0.0) as u64;
        let rounded = (seconds.round().max(0.0)) as u64;
        if tenths < 600 {
            return self.fill("time-s", &[("s", &format!("{}.{}", tenths / 10, tenths % 10))]);
        }
        let (hours, minutes, rest) = (rounded / 3600, rounded / 60 % 60, rounded % 60);
        if hours == 0 {
            self.fill("time-min", &[("m", &minutes.to_string()), ("s", &rest.to_string())])
        } else {
            let values = [hours.to_string(), minutes.to_string(), rest.to_string()];
            self.fill("time-h", &[("h", &values[0]), ("m", &values[1]), ("s", &values[2])])
        }
    }
}

fn language_of_environment() -> Language {
    let set = ["LC_ALL", "LC_MESSAGES", "LANG"]
        .into_iter()
        .filter_map(std::env::var_os)
        .find(|value| !value.is_empty())
        .unwrap_or_default();
    if set.to_string_lossy().to_ascii_lowercase().starts_with("zh") {
        Language::Chinese
    } else {
        Language::English
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_exists_in_both_languages_with_the_same_places() {
        let places = |text: &str| {
            let mut names: Vec<String> = text
                .split('{')
                .skip(1)
                .filter_map(|rest| rest.split_once('}'))
                .map(|(n, _)| n.to_string())
                .collect();
            names.sort();
            names
        };
        for (key, [en, zh]) in TEXTS.iter() {
            assert!(!en.is_empty() && !zh.is_empty(), "{key}");
            assert_eq!(places(en), places(zh), "{key}");
        }
    }

    #[test]
    fn every_estimate_and_kind_has_a_sentence() {
        for key in turnwright_motion::ESTIMATES.iter().chain(turnwright_motion::ESTIMATES_WITH_DYNAMICS) {
            assert!(
                Speech { language: Language::English }.lookup(&format!("estimate-{key}")).is_some(),
                "{key}"
            );
        }
    }

    #[test]
    fn durations_read_well() {
        let speech = Speech { language: Language::English };
        let said = [0.04, 9.96, 59.94, 59.96, 60.4, 3599.6, 7322.0].map(|seconds| speech.duration(seconds));
        let expected =
            ["0.0 s", "10.0 s", "59.9 s", "1 min 0 s", "1 min 0 s", "1 h 0 min 0 s", "2 h 2 min 2 s"];
        assert_eq!(said, expected);
    }
}
