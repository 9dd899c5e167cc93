//! The lanes over time in the report: places, speed, spindle and what the cuts ask of tools and spindle, all in the same
//! columns of equal length.
//!
//! In: a [`Timeline`] and the strips of cutting data in both languages. Out: JSON, a thousand columns at most, whatever
//! the program. A value that a column does not know is null.

use serde_json::{Value, json};

use crate::formats::cutting_svg::{CuttingPicture, Row};
use crate::formats::time_svg::{Columns, Scale, lanes};
use crate::timeline::Timeline;

/// The lane that the cutting data know better.
const REMOVAL: (&str, &str) = ("time-lane-removal", "cm³/min");

/// The lanes as JSON; nothing of a program that takes no time.
pub(super) fn plots_json(timeline: &Timeline, cutting: Option<&[CuttingPicture; 2]>) -> Option<Value> {
    let columns = Columns::of(timeline);
    if columns.moments.is_empty() {
        return None;
    }
    let rows = cutting.map_or(&[][..], |[english, _]| &english.rows[..]);
    let has_removal = rows.iter().any(|row| row.unit == REMOVAL.1);
    let of_time =
        lanes(timeline).iter().filter(|lane| !(has_removal && lane.title == REMOVAL.0)).map(|lane| {
            let ranges = columns.moments.iter().map(|moment| (lane.value)(moment, columns.seconds));
            let (low, high): (Vec<_>, Vec<_>) = ranges
                .map(|range| (known(range.is_known(), range.min, 3), known(range.is_known(), range.max, 3)))
                .unzip();
            let scale = match lane.scale {
                Scale::Fitted => "fitted",
                Scale::FromZero => "from-zero",
                Scale::Powers => "powers",
            };
            json!({ "key": lane.title, "scale": scale, "low": low, "high": high })
        });
    let mut all: Vec<Value> = of_time.collect();
    if let Some([english, chinese]) = cutting {
        all.extend(english.rows.iter().zip(&chinese.rows).map(|(row, other)| {
            json!({
                "name": both(&row.name, &other.name), "label": both(&row.label, &other.label), "unit": row.unit, "decimals": row.decimals, "peak": row.peak, "line": row.peak_line,
                "scale": "from-zero", "high": greatest(row, &columns),
            })
        }));
    }
    let shares = columns.moments.iter().map(|moment| moment.shares_s.map(|seconds| rounded(seconds, 3)));
    let tools = timeline.tools().iter().map(|call| (rounded(call.at_s, 3), call.tool));
    Some(json!({
        "seconds": columns.seconds, "duration": rounded(timeline.duration_s(), 3), "lanes": all,
        "shares": shares.collect::<Vec<_>>(), "tools": tools.collect::<Vec<_>>(),
        "note": cutting.map(|[english, chinese]| both(&english.subtitle, &chinese.subtitle)),
    }))
}

fn both(en: &str, zh: &str) -> Value {
    json!({ "en": en, "zh": zh })
}

/// The greatest value of a strip in each column.
fn greatest(row: &Row, columns: &Columns) -> Vec<Option<f64>> {
    let count = columns.moments.len();
    let mut all = vec![None; count];
    for (from_s, to_s, value) in &row.steps {
        let first = ((from_s / columns.seconds) as usize).min(count - 1);
        // What ends with a column does not touch the next one.
        let last = ((to_s / columns.seconds).ceil() as usize).clamp(first + 1, count);
        for column in &mut all[first..last] {
            *column = Some(column.map_or(*value, |other: f64| other.max(*value)));
        }
    }
    all.into_iter().map(|value| value.map(|value| rounded(value, row.decimals + 2))).collect()
}

fn known(is_known: bool, value: f64, decimals: usize) -> Option<f64> {
    is_known.then(|| rounded(value, decimals))
}

fn rounded(value: f64, decimals: usize) -> f64 {
    let scale = 10f64.powi(decimals as i32);
    // Adding nothing makes minus zero plain.
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use turnwright_motion::{Kind, RpmRange, Timing};
    use turnwright_units::{Length, Position, Radius};

    use super::*;
    use crate::Language;

    /// A cut of four seconds, a rapid of two.
    fn timeline() -> Timeline {
        let at = |z: i32| Position::new(Radius(Length::from_mm(10)), Length::from_mm(z));
        let mut timeline = Timeline::default();
        timeline.call_tool(3);
        let rpm = Some(RpmRange { min: 500.0, max: 500.0 });
        let cut =
            Timing { kind: Kind::Cutting, from: at(0), seconds: 4.0, waited_s: 0.0, length_mm: 40.0, rpm };
        timeline.add(&cut, at(-40), Some(100.0));
        let back = Timing {
            kind: Kind::Rapid,
            from: at(-40),
            seconds: 2.0,
            waited_s: 0.0,
            length_mm: 40.0,
            rpm: None,
        };
        timeline.add(&back, at(0), None);
        timeline
    }

    fn pictures(steps: Vec<(f64, f64, f64)>) -> [CuttingPicture; 2] {
        [("depth", Language::English), ("切削深度", Language::Chinese)].map(|(label, language)| {
            CuttingPicture {
                title: String::new(),
                subtitle: String::new(),
                rows: vec![Row {
                    name: label.to_owned(),
                    label: label.to_owned(),
                    peak: 2.5,
                    peak_line: 7,
                    unit: "mm",
                    decimals: 3,
                    steps: steps.clone(),
                }],
                total_s: 6.0,
                language,
            }
        })
    }

    #[test]
    fn every_lane_has_the_columns_of_the_time() {
        let json = plots_json(&timeline(), Some(&pictures(vec![(0.0, 4.0, 2.5)]))).expect("plots");
        let (lanes, shares) =
            (json["lanes"].as_array().expect("lanes"), json["shares"].as_array().expect("shares"));
        assert_eq!(shares.len() as f64 * json["seconds"].as_f64().expect("seconds"), 6.0);
        assert_eq!(json["tools"], json!([[0.0, 3]]));
        let keys: Vec<_> = lanes.iter().map(|lane| lane["key"].as_str().unwrap_or("cutting")).collect();
        assert_eq!(
            keys,
            [
                "time-lane-x",
                "time-lane-z",
                "time-lane-speed",
                "time-lane-rpm",
                "time-lane-removal",
                "cutting"
            ]
        );
        for lane in lanes {
            assert_eq!(lane["high"].as_array().map(Vec::len), Some(shares.len()));
        }
        // Of the rapid neither spindle nor depth are known.
        let (depth, last) = (&lanes[5]["high"], shares.len() - 1);
        assert_eq!((&depth[0], &depth[last]), (&json!(2.5), &Value::Null));
        assert_eq!(lanes[3]["high"][last], Value::Null);
        assert_eq!((&lanes[5]["label"]["zh"], &lanes[5]["line"]), (&json!("切削深度"), &json!(7)));
    }

    #[test]
    fn a_peak_shorter_than_a_column_is_there_and_one_behind_the_end_too() {
        let [mut english, chinese] = pictures(vec![(1.0, 1.0, 2.5), (5.9, 6.5, 1.5), (9.0, 9.0, 0.5)]);
        english.rows[0].unit = "cm³/min";
        let json = plots_json(&timeline(), Some(&[english, chinese])).expect("plots");
        let lanes = json["lanes"].as_array().expect("lanes");
        assert!(lanes.iter().all(|lane| lane["key"] != "time-lane-removal"), "the same lane twice");
        let high: Vec<f64> =
            lanes[4]["high"].as_array().expect("a lane").iter().filter_map(Value::as_f64).collect();
        assert_eq!(high[0], 2.5);
        assert_eq!(high.last(), Some(&1.5));
    }

    #[test]
    fn a_program_of_no_time_has_no_lanes() {
        assert!(plots_json(&Timeline::default(), None).is_none());
    }
}
