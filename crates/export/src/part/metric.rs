//! Names of metric threads, by the table in `data/threads.json`.
//!
//! In: the diameters, the pitch and the starts of a thread. Out: its name, `M20×1.5`, when it can be no other; a crest that
//! is turned smaller than the nominal size, as it is done, still has its name.

use std::sync::LazyLock;

/// A size with its coarse pitch, where it has one, and its fine ones.
#[derive(Clone, Debug)]
struct Size {
    nominal_mm: f64,
    coarse_mm: Option<f64>,
    fine_mm: Vec<f64>,
}

static SIZES: LazyLock<Vec<Size>> = LazyLock::new(|| {
    let table: serde_json::Value = serde_json::from_str(include_str!("../../../../data/threads.json"))
        .unwrap_or_else(|error| unreachable!("data/threads.json is read by a test: {error}"));
    let size = |row: &serde_json::Value| {
        let fine = row["fine"].as_array().into_iter().flatten();
        Some(Size {
            nominal_mm: row["size"].as_f64()?,
            coarse_mm: row["coarse"].as_f64(),
            fine_mm: fine.filter_map(serde_json::Value::as_f64).collect(),
        })
    };
    table["threads"].as_array().into_iter().flatten().filter_map(size).collect()
});

/// Depth of the groove in pitches: 0.54 to 0.61 for the profile of 60 degrees, with room for how shops reckon it.
const DEPTH_IN_PITCHES: std::ops::Range<f64> = 0.5..0.72;

/// How far a nominal diameter is passed, and how far missed, mm and pitches.
const OVER_MM: f64 = 0.05;
const UNDER_MM: f64 = 0.1;
const UNDER_IN_PITCHES: f64 = 0.2;

/// The name of a thread whose greater diameter and lesser one, and whose pitch are known.
pub(super) fn name(major_mm: f64, minor_mm: f64, pitch_mm: f64, starts: usize) -> Option<String> {
    if !DEPTH_IN_PITCHES.contains(&((major_mm - minor_mm) / 2.0 / pitch_mm)) {
        return None;
    }
    let is_same = |pitch: &f64| (pitch - pitch_mm).abs() < 1e-6;
    let under_mm = UNDER_MM + UNDER_IN_PITCHES * pitch_mm;
    let fits = |size: &&Size| {
        let is_near = (size.nominal_mm - under_mm..=size.nominal_mm + OVER_MM).contains(&major_mm);
        is_near && size.coarse_mm.iter().chain(&size.fine_mm).any(is_same)
    };
    let far = |size: &Size| (size.nominal_mm - major_mm).abs();
    let size = SIZES.iter().filter(fits).min_by(|a, b| far(a).total_cmp(&far(b)))?;
    let (nominal, is_coarse) = (size.nominal_mm, size.coarse_mm.as_ref().is_some_and(is_same));
    Some(match (starts, is_coarse) {
        (0 | 1, true) => format!("M{nominal}"),
        (0 | 1, false) => format!("M{nominal}×{pitch_mm}"),
        _ => format!("M{nominal}×Ph{}P{pitch_mm}", super::thousandths(pitch_mm * starts as f64)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_of_the_table_have_their_names() {
        for (major, minor, pitch, starts, expected) in [
            (20.0, 18.16, 1.5, 1, Some("M20×1.5")),
            // Turned smaller, as one does, and as deep as 1.3 pitches make it.
            (19.8, 17.85, 1.5, 1, Some("M20×1.5")),
            (20.0, 17.294, 2.5, 1, Some("M20")),
            (30.0, 26.211, 3.5, 1, Some("M30")),
            (30.0, 27.4, 2.0, 1, Some("M30×2")),
            (30.0, 28.376, 1.5, 2, Some("M30×Ph3P1.5")),
            // No such pitch, no such size, too shallow, a trapezoid's depth in a pitch that is there.
            (20.0, 17.0, 2.309, 1, None),
            (19.4, 17.6, 1.5, 1, None),
            (20.0, 19.0, 1.5, 1, None),
            (30.0, 26.5, 2.0, 1, None),
            (20.2, 18.4, 1.5, 1, None),
        ] {
            assert_eq!(name(major, minor, pitch, starts).as_deref(), expected, "{major} {pitch}");
        }
        assert_eq!(SIZES.len(), 49);
        assert!(SIZES.windows(2).all(|two| two[0].nominal_mm < two[1].nominal_mm));
    }
}
