//! The words of pictures and reports, from `data/report-texts.json`.

use serde_json::Value;

/// The texts of pictures and reports: `key → {en, zh}`. What a translator corrects.
pub(crate) const REPORT_TEXTS: &str = include_str!("../../../data/report-texts.json");

/// The language of a picture or a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Simplified Chinese.
    Chinese,
}

impl Language {
    /// The tag of HTML and SVG, which is also the key in the file of texts.
    pub const fn tag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Chinese => "zh",
        }
    }
}

/// The texts in one language, read once for a picture.
pub(crate) struct Words {
    texts: Value,
    language: Language,
}

impl Words {
    /// The texts in `language`.
    pub(crate) fn new(language: Language) -> Self {
        // A file that does not parse is caught by the test below; a picture then shows its keys.
        Self { texts: serde_json::from_str(REPORT_TEXTS).unwrap_or(Value::Null), language }
    }

    /// The text of `key`; a missing one is shown by its key, so that nobody misses it.
    pub(crate) fn get<'a>(&'a self, key: &'a str) -> &'a str {
        self.texts[key][self.language.tag()].as_str().unwrap_or(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_exists_in_both_languages() {
        let texts: Value = serde_json::from_str(REPORT_TEXTS).expect("report-texts.json is JSON");
        for (key, entry) in texts.as_object().expect("an object") {
            for tag in ["en", "zh"] {
                assert!(entry[tag].as_str().is_some_and(|text| !text.is_empty()), "{key} has no {tag}");
            }
        }
    }
}
