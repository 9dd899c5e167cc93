//! A setup written into the program, in comments that no control minds.
//!
//! ```text
//! (SETUP STOCK D50 L80 FACE1)            also BORE20
//! (SETUP CHUCK GRIP20 D200)              also INSIDE, JAW35, HEIGHT40, Z-60, RPM3000, FORCE30, MAXFORCE60
//! (SETUP BAR L600 GUIDED)                behind the spindle; also D50, BORE20, FREE
//! (SETUP TAILSTOCK Z-4)                  also ANGLE60, D25, L60, QUILL70
//! (SETUP TOOL 1 CNMG120408 PCLNR2525M12 R0.8 TIP3)
//! (SETUP TOOL 2 GROOVING W3 R0.2)        also CUT-OFF, THREADING, DRILLING D20, INSIDE, FACE, LEFT, FRONT …
//! (SETUP MEASURE D50 Z-10 H7)            a size: also BORE, WALL, W (with X), L with FROM and TO, MAJOR, MINOR, LEAD;
//!                                        its tolerance: a fit, +0.02 -0.01, or TOL0.05; NAME SEAT
//! (SETUP ALLOW tool-offset-differs)      DENY likewise
//! ```
//!
//! Letters may be small, a value may stand behind a blank or `=`, items may be parted by commas. Each item is a key of
//! the setup file in short; what a comment says counts before what the file says. A comment that begins with `SETUP`
//! and cannot be read is refused.

use toml::{Table, Value};

use crate::nearest;
use crate::tooling::{is_holder, is_insert};

/// What a comment may be about.
const SECTIONS: [&str; 8] = ["STOCK", "CHUCK", "BAR", "TAILSTOCK", "TOOL", "MEASURE", "ALLOW", "DENY"];

/// Short names of the keys of a section.
type Keys = &'static [(&'static str, &'static str)];

const STOCK: Keys = &[
    ("D", "diameter_mm"),
    ("DIAMETER", "diameter_mm"),
    ("L", "length_mm"),
    ("LENGTH", "length_mm"),
    ("BORE", "bore_mm"),
    ("FACE", "face_mm"),
];

const CHUCK: Keys = &[
    ("GRIP", "grip_mm"),
    ("Z", "jaw_z_mm"),
    ("JAW", "jaw_length_mm"),
    ("HEIGHT", "jaw_height_mm"),
    ("D", "diameter_mm"),
    ("L", "length_mm"),
    ("RPM", "rpm_max"),
    ("FORCE", "grip_force_kn"),
    ("MAXFORCE", "grip_force_max_kn"),
];

const BAR: Keys = &[("L", "behind_mm"), ("D", "diameter_mm"), ("BORE", "bore_mm")];

const TAILSTOCK: Keys = &[
    ("Z", "point_z_mm"),
    ("ANGLE", "point_angle_deg"),
    ("D", "centre_mm"),
    ("L", "centre_length_mm"),
    ("QUILL", "quill_mm"),
];

const TOOL: Keys = &[
    ("R", "nose_radius_mm"),
    ("TIP", "tip"),
    ("W", "width_mm"),
    ("WIDTH", "width_mm"),
    ("REACH", "reach_mm"),
    ("D", "diameter_mm"),
    ("POINT", "point_angle_deg"),
    ("THREAD", "thread_angle_deg"),
    ("ENTERING", "entering_angle_deg"),
    ("L", "length_mm"),
    ("SHANK", "shank_mm"),
];

/// Words that are a value by themselves: the word, its key, the value.
const TOOL_WORDS: &[(&str, &str, &str)] = &[
    ("TURNING", "kind", "turning"),
    ("GROOVING", "kind", "grooving"),
    ("CUT-OFF", "kind", "cut-off"),
    ("THREADING", "kind", "threading"),
    ("DRILLING", "kind", "drilling"),
    ("TAPPING", "kind", "tapping"),
    ("OUTSIDE", "side", "outside"),
    ("INSIDE", "side", "inside"),
    ("FACE", "side", "face"),
    ("RIGHT", "hand", "right"),
    ("LEFT", "hand", "left"),
    ("NEUTRAL", "hand", "neutral"),
    ("REAR", "post", "rear"),
    ("FRONT", "post", "front"),
    ("UP", "insert_faces", "up"),
    ("DOWN", "insert_faces", "down"),
];

const BAR_WORDS: &[(&str, &str, &str)] = &[("FREE", "end", "free"), ("GUIDED", "end", "guided")];

const CHUCK_WORDS: &[(&str, &str, &str)] = &[("OUTSIDE", "grip", "outside"), ("INSIDE", "grip", "inside")];

/// Sizes of a MEASURE comment: the word, its key.
const SIZES: Keys = &[
    ("D", "diameter_mm"),
    ("BORE", "bore_mm"),
    ("WALL", "wall_mm"),
    ("W", "width_mm"),
    ("L", "length_mm"),
    ("MAJOR", "major_mm"),
    ("MINOR", "minor_mm"),
    ("LEAD", "lead_mm"),
];

/// Values that count: no point in them.
const WHOLE: [&str; 2] = ["tip", "rpm_max"];

/// A comment (what is between the brackets) as a piece of a setup file; `None` when it is a remark like any other.
///
/// # Errors
/// What of it cannot be read, in words.
pub fn setup_comment(comment: &str) -> Option<Result<Table, String>> {
    let comment = comment.trim().to_ascii_uppercase();
    let rest = comment.strip_prefix("SETUP")?;
    // SETUPS and SETUP-SHEET are words of their own; without a number it is a heading or a sentence.
    let is_one_word = rest.starts_with([' ', ':', '=', '\t']);
    let section = rest.split([' ', '\t', ':', '=']).find(|word| !word.is_empty())?;
    let switches = ["ALLOW", "DENY"].contains(&section);
    let is_meant =
        switches || (rest.contains(|c: char| c.is_ascii_digit()) && nearest(section, SECTIONS).is_some());
    (is_one_word && is_meant).then(|| read(rest))
}

fn read(text: &str) -> Result<Table, String> {
    let mut items = text.split([' ', '\t', ',', ':', '=']).filter(|item| !item.is_empty()).peekable();
    let section = items
        .next()
        .ok_or("SETUP is followed by STOCK, CHUCK, BAR, TAILSTOCK, TOOL, MEASURE, ALLOW or DENY")?;
    if matches!(section, "ALLOW" | "DENY") {
        let names: Vec<Value> = items.map(|item| Value::String(item.to_ascii_lowercase())).collect();
        if names.is_empty() {
            return Err(format!("{section} is followed by names of warnings"));
        }
        let switches = Table::from_iter([(section.to_ascii_lowercase(), Value::Array(names))]);
        return Ok(Table::from_iter([("checks".to_string(), Value::Table(switches))]));
    }
    if section == "MEASURE" {
        let measure = read_measure(items)?;
        return Ok(Table::from_iter([("measure".to_string(), Value::Array(vec![Value::Table(measure)]))]));
    }
    let (keys, words): (Keys, &[_]) = match section {
        "STOCK" => (STOCK, &[]),
        "CHUCK" => (CHUCK, CHUCK_WORDS),
        "BAR" => (BAR, BAR_WORDS),
        "TAILSTOCK" => (TAILSTOCK, &[]),
        "TOOL" => (TOOL, TOOL_WORDS),
        other => {
            let near = nearest(other, SECTIONS);
            let hint = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
            return Err(format!("{other} is none of {}{hint}", SECTIONS.join(", ")));
        }
    };
    let station = if section == "TOOL" {
        let station = items.next().map(|item| item.trim_start_matches('T'));
        let station = station.and_then(|item| item.parse::<u32>().ok());
        Some(station.ok_or("TOOL is followed by the number of the turret station")?)
    } else {
        None
    };
    let mut table = Table::new();
    while let Some(item) = items.next() {
        let letters = item.find(|c: char| !c.is_ascii_alphabetic() && c != '-').unwrap_or(item.len());
        let letters = item[..letters].trim_end_matches('-').len();
        let (name, number) = item.split_at(letters);
        if let Some((_, key)) = keys.iter().find(|(short, _)| *short == name) {
            let is_word = number.is_empty() && words.iter().any(|(word, ..)| *word == item);
            let number =
                if number.is_empty() && !is_word { items.next().unwrap_or_default() } else { number };
            if !is_word {
                table.insert((*key).to_string(), value(key, number).ok_or_else(|| no_number(item, number))?);
                continue;
            }
        }
        if let Some((_, key, value)) = words.iter().find(|(word, ..)| *word == item) {
            table.insert((*key).to_string(), Value::String((*value).to_string()));
        } else if section == "TOOL" && is_insert(item) {
            table.insert("insert".to_string(), Value::String(item.to_string()));
        } else if section == "TOOL" && is_holder(item) {
            table.insert("holder".to_string(), Value::String(item.to_string()));
        } else {
            let known = keys.iter().map(|(short, _)| *short).chain(words.iter().map(|(word, ..)| *word));
            let near = nearest(name, known.clone());
            let hint = near.map_or_else(
                || format!("; known are {}", known.collect::<Vec<_>>().join(" ")),
                |near| format!("; did you mean {near}?"),
            );
            return Err(format!("{item} is not known here{hint}"));
        }
    }
    if let Some(station) = station {
        table = Table::from_iter([(station.to_string(), Value::Table(table))]);
    }
    let section = if station.is_some() { "tools".to_string() } else { section.to_ascii_lowercase() };
    Ok(Table::from_iter([(section, Value::Table(table))]))
}

/// A size of the drawing: what it is, where, and how far off it may be. In a program all letters are capitals: the fit of an
/// outer size is taken for that of a shaft.
fn read_measure<'a>(items: impl Iterator<Item = &'a str>) -> Result<Table, String> {
    let (mut table, mut limits, mut place) = (Table::new(), Vec::new(), Vec::new());
    let mut items = items.flat_map(|item| item.split('/'));
    while let Some(item) = items.next() {
        if item.starts_with(['+', '-']) {
            limits.push(Value::Float(item.parse().map_err(|_| no_number("a deviation", item))?));
            continue;
        }
        let letters = item.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(item.len());
        let (name, number) = item.split_at(letters);
        let is_fit = number.len() <= 2 && number.parse::<u8>().is_ok() && name.len() <= 2;
        let mut next = || if number.is_empty() { items.next().unwrap_or_default() } else { number };
        if let Some((_, key)) = SIZES.iter().find(|(short, _)| *short == name) {
            // 50H7 is a size with its fit.
            let number = next();
            let fit = number.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(number.len());
            let (number, fit) = number.split_at(fit);
            table.insert((*key).to_string(), value(key, number).ok_or_else(|| no_number(name, number))?);
            if !fit.is_empty() {
                table.insert("tolerance_mm".to_string(), Value::String(fit.to_string()));
            }
            continue;
        }
        match name {
            "X" | "Z" => place.push(format!("{name}{}", next())),
            "FROM" | "TO" => {
                let z = next().trim_start_matches('Z');
                table.insert(name.to_ascii_lowercase(), Value::String(format!("Z{z}")));
            }
            "TOL" => {
                let number = next();
                let both = value("tolerance_mm", number).ok_or_else(|| no_number(name, number))?;
                table.insert("tolerance_mm".to_string(), both);
            }
            "NAME" => {
                table.insert("name".to_string(), Value::String(next().to_string()));
            }
            _ if is_fit => {
                table.insert("tolerance_mm".to_string(), Value::String(item.to_string()));
            }
            _ => {
                let known = SIZES.iter().map(|(short, _)| *short);
                let known = known.chain(["X", "Z", "FROM", "TO", "TOL", "NAME"]);
                let hint = nearest(name, known.clone()).map_or_else(
                    || format!("known are {}, a fit, +0.02 -0.01", known.collect::<Vec<_>>().join(" ")),
                    |near| format!("did you mean {near}?"),
                );
                return Err(format!("{item} is not known here; {hint}"));
            }
        }
    }
    if !place.is_empty() {
        table.insert("at".to_string(), Value::String(place.join(" ")));
    }
    if !limits.is_empty() {
        table.insert("tolerance_mm".to_string(), Value::Array(limits));
    }
    if table.contains_key("diameter_mm")
        && let Some(Value::String(fit)) = table.get_mut("tolerance_mm")
    {
        *fit = fit.to_ascii_lowercase();
    }
    Ok(table)
}

fn value(key: &str, number: &str) -> Option<Value> {
    if WHOLE.contains(&key) {
        number.parse().ok().map(Value::Integer)
    } else {
        number.parse::<f64>().ok().filter(|number| number.is_finite()).map(Value::Float)
    }
}

fn no_number(item: &str, number: &str) -> String {
    format!("{item} needs a number, not {number:?}")
}

/// Lays one piece of a setup over another, key by key; lists are joined.
pub(crate) fn lay_over(under: &mut Table, over: Table) {
    for (key, value) in over {
        match (under.get_mut(&key), value) {
            (Some(Value::Table(under)), Value::Table(over)) => lay_over(under, over),
            (Some(Value::Array(under)), Value::Array(over)) => under.extend(over),
            (_, value) => {
                under.insert(key, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Setup, ToolKind, ToolSide};

    fn pieces(comments: &[&str]) -> Vec<Table> {
        let read =
            |comment: &&str| setup_comment(comment).expect(comment).unwrap_or_else(|why| panic!("{why}"));
        comments.iter().map(read).collect()
    }

    #[test]
    fn comments_are_keys_of_the_setup_file_in_short() {
        let comments = pieces(&[
            "SETUP STOCK D50 L80.5 FACE = 1",
            "setup chuck grip 25, d200 inside rpm3000",
            "SETUP TOOL 1 CNMG120408 PCLNR2525M12 R0.8 TIP3",
            "Setup Tool T02 grooving w3 inside",
            "SETUP TOOL 3 DRILLING D20 POINT118",
            "SETUP TAILSTOCK Z-4",
            "SETUP STOCK BORE20",
            "SETUP ALLOW tool-offset-differs T106",
            "SETUP ALLOW stop-in-cut",
        ]);
        let setup = Setup::with_comments("[stock]\ndiameter_mm = 40\n", comments).expect("a setup");
        let stock = setup.stock.clone().expect("stock");
        assert_eq!(
            (stock.diameter_mm, stock.length_mm, stock.bore_mm, stock.face_mm),
            (Some(50.0), Some(80.5), Some(20.0), 1.0)
        );
        assert_eq!(setup.chuck.as_ref().and_then(|chuck| chuck.rpm_max), Some(3000));
        let tools = setup.tools().expect("tools");
        assert_eq!((tools[&1].tip, tools[&1].nose_radius_mm), (3, 0.8));
        assert_eq!(
            (tools[&2].kind, tools[&2].side, tools[&2].width_mm),
            (ToolKind::Grooving, ToolSide::Inside, Some(3.0))
        );
        assert_eq!(tools[&3].kind, ToolKind::Drilling);
        assert_eq!(setup.checks.allow, ["tool-offset-differs", "t106", "stop-in-cut"]);
        assert_eq!(setup.tailstock.and_then(|tailstock| tailstock.point_z_mm), Some(-4.0));
    }

    #[test]
    fn sizes_are_written_as_in_a_drawing() {
        let comments = pieces(&[
            "SETUP MEASURE D50 Z-10 H7",
            "SETUP MEASURE BORE 20H7 Z-10 NAME SEAT",
            "SETUP MEASURE L32 FROM0 TO-32 TOL0.1",
            "setup measure w4 x25 z-9 +0.1/-0.05",
            "SETUP MEASURE D40JS6, Z = -30",
            "SETUP MEASURE LEAD1.5 Z-5",
        ]);
        let file = "[[measure]]\nat = \"Z-1\"\nwall_mm = 3\n";
        let setup = Setup::with_comments(file, comments).expect("a setup");
        let measures = setup.measures().expect("sizes");
        assert_eq!(measures.len(), 7);
        let limits: Vec<_> = measures.iter().map(|measure| measure.deviations_mm).collect();
        assert_eq!(limits[..3], [None, Some((0.0, -0.025)), Some((0.021, 0.0))]);
        assert_eq!(limits[3..], [Some((0.1, -0.1)), Some((0.1, -0.05)), Some((0.008, -0.008)), None]);
        assert_eq!(measures[2].name.as_deref(), Some("SEAT"));
        let quantity = |index: usize| measures[index].quantity;
        assert_eq!(quantity(3), crate::Quantity::Length { from: 0.0, to: -32.0 });
        assert_eq!(quantity(4), crate::Quantity::Width { diameter_mm: 25.0, near_z: Some(-9.0) });
        // What the key refuses is refused by its name.
        let wrong = Setup::with_comments("", pieces(&["SETUP MEASURE D50 Z-10 X7"])).expect_err("refused");
        assert!(wrong.message.starts_with("measure.1."), "{wrong:?}");
        let wrong = Setup::with_comments("", pieces(&["SETUP MEASURE D50Z7 Z-10"])).expect_err("refused");
        assert!(wrong.message.contains("z7"), "{wrong:?}");
        let setup = Setup::with_comments("", pieces(&["SETUP BAR L600 D30 GUIDED"])).expect("a setup");
        assert_eq!(setup.bar.expect("a bar").behind_mm, Some(600.0));
        let chuck = pieces(&["SETUP STOCK D50 L80", "SETUP CHUCK RPM4000 FORCE30 MAXFORCE60"]);
        let chuck = Setup::with_comments("", chuck).expect("a setup").chuck.expect("a chuck");
        assert_eq!((chuck.grip_force_kn, chuck.grip_force_max_kn), (Some(30.0), Some(60.0)));
        let tool = pieces(&["SETUP TOOL 2 CUT-OFF W3 REAR UP"]);
        let tools = Setup::with_comments("", tool).expect("a setup").tools().expect("tools");
        assert_eq!(tools[&2].turn, Some(crate::CuttingTurn::CounterClockwise));
    }

    #[test]
    fn other_remarks_are_left_alone_and_wrong_ones_refused() {
        for remark in
            ["SETUPS", "SETUP", "SET UP", "ROUGHING", "SETUP-SHEET 4", "SETUP WORK 54", "SETUP TOOL LIST", ""]
        {
            assert!(setup_comment(remark).is_none(), "{remark}");
        }
        for (comment, why) in [
            ("SETUP STOK D50", "did you mean STOCK?"),
            ("SETUP STOCK DIAMETR 50", "did you mean DIAMETER?"),
            ("SETUP STOCK L5 D", "needs a number"),
            ("SETUP STOCK Dx5", "did you mean D?"),
            ("SETUP STOCK SEVENTY5", "known are"),
            ("SETUP STOCK D1e999", "needs a number"),
            ("SETUP TOOL CNMG120408", "number of the turret station"),
            ("SETUP TOOL 1 CNMG12", "not known here"),
            ("SETUP TOOL 1 TIP3.5", "needs a number"),
            ("SETUP DENY", "followed by"),
            ("SETUP MEASURE DIA50 Z-10", "not known here"),
            ("SETUP MEASURE D50 Z-10 MAYOR3", "did you mean MAJOR?"),
            ("SETUP MEASURE D Z-10", "needs a number"),
            ("SETUP MEASURE D50 Z-10 +x", "needs a number"),
            ("SETUP BAR L600 GUIDE", "did you mean GUIDED?"),
        ] {
            let fault = setup_comment(comment).expect(comment).expect_err(comment);
            assert!(fault.contains(why), "{comment}: {fault}");
        }
    }
}
