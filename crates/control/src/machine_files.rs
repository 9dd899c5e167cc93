//! The machine files of `data/machines`, as the build script read them: a start parses no text.

use Given::*;

include!(concat!(env!("OUT_DIR"), "/machines.rs"));

/// A value in a machine file.
#[derive(Clone, Copy)]
pub(crate) enum Given {
    Text(&'static str),
    Whole(i64),
    Number(f64),
    Truth(bool),
    List(&'static [Self]),
    Table(&'static [(&'static str, Self)]),
}

impl Given {
    /// The value as a setup file would give it.
    fn value(self) -> toml::Value {
        match self {
            Text(text) => text.into(),
            Whole(whole) => whole.into(),
            Number(number) => number.into(),
            Truth(truth) => truth.into(),
            List(values) => toml::Value::Array(values.iter().map(|value| value.value()).collect()),
            Table(pairs) => table(pairs).into(),
        }
    }
}

/// Keys and values as a setup file would give them.
pub(crate) fn table(pairs: &[(&str, Given)]) -> toml::Table {
    pairs.iter().map(|(key, value)| (key.to_string(), value.value())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::disallowed_methods, reason = "a test may read files")]
    fn the_machines_are_their_files() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
        let count = std::fs::read_dir(&folder).expect("the folder").count();
        assert_eq!(MACHINES.len(), count);
        for (name, pairs) in MACHINES {
            let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("the file");
            assert_eq!(table(pairs), text.parse().expect("TOML"), "{name}");
        }
    }
}
