//! The questions on which controls differ or sources disagree, each with all its readings.
//!
//! Made of `data/policies.toml` by the build script. A control definition in `data/controls` answers every one of them;
//! no code asks for a control's name.

include!(concat!(env!("OUT_DIR"), "/policies.rs"));

/// Which alarm numbers a control shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlarmIds {
    /// Three digits.
    Three,
    /// Two letters and four digits.
    Four,
    /// Own names where no number is known.
    Named,
}
