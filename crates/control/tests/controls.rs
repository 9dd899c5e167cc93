//! A control is one file: what the build makes of it and its bases.

#[path = "../build/controls.rs"]
#[allow(dead_code, clippy::disallowed_methods, clippy::disallowed_macros, reason = "shared with the build")]
mod controls;
#[path = "../build/tables.rs"]
#[allow(dead_code, clippy::disallowed_methods, clippy::disallowed_macros, reason = "shared with the build")]
mod tables;

use std::collections::BTreeMap;

use toml::Table;

fn table(text: &str) -> Table {
    text.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// Two questions, a base that answers them, and our lathe.
fn made(ours: &str) -> String {
    let questions = table(
        "[escape-speed]\nasks = \"How fast?\"\nfeed = \"As cut.\"\nrapid = \"As it can.\"\n\
         [fine-digits]\nasks = \"Too fine?\"\ncut = \"Cut off.\"\nround = \"Rounded.\"\n",
    );
    let base = "abstract = true\ntitle = \"All\"\nalarm-ids = \"named\"\n\
                [policies]\nescape-speed = \"feed\"\nfine-digits = \"round\"\n[limits]\nnumber-digits = 8\n";
    let files = [("base", base), ("our-lathe", ours)];
    let files: BTreeMap<_, _> =
        files.into_iter().map(|(name, text)| (name.to_string(), table(text))).collect();
    controls::controls(&questions, &files)
}

#[test]
fn a_control_says_what_differs_from_its_base() {
    let source = made("base = \"base\"\ntitle = \"Ours\"\n[policies]\nescape-speed = \"rapid\"\n");
    assert_eq!(source.matches("Definition {").count(), 1, "{source}");
    for part in [
        "name: \"our-lathe\", lineage: &[\"our-lathe\", \"base\"], title: \"Ours\"",
        "escape_speed: EscapeSpeed::Rapid",
        "fine_digits: FineDigits::Round",
        "limits: Limits { number_digits: 8,",
        "alarm_ids: AlarmIds::Named",
    ] {
        assert!(source.contains(part), "{part}\n{source}");
    }
}

#[test]
#[should_panic(expected = "our-lathe: fast is no reading of escape-speed")]
fn an_answer_that_is_no_reading_stops_the_build() {
    made("base = \"base\"\n[policies]\nescape-speed = \"fast\"\n");
}

#[test]
#[should_panic(expected = "base none does not exist")]
fn a_base_that_does_not_exist_stops_the_build() {
    made("base = \"none\"\n");
}

#[test]
#[should_panic(expected = "our-lathe: polices is not known here")]
fn an_unknown_table_stops_the_build() {
    made("base = \"base\"\n[polices]\n");
}

#[test]
#[should_panic(expected = "too many bases")]
fn a_circle_of_bases_stops_the_build() {
    made("base = \"our-lathe\"\n");
}
