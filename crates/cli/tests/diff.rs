//! `turnwright diff`: what an edit changed, and nothing of the text.

mod support;

use serde_json::Value;
use support::{Folder, turnwright};

const PROGRAM: &str = "O1(SHAFT)\nT0101\nG97 S800 M03\nG00 X52. Z2.\nX44.\nG01 Z-40. F0.2\nX52.\nG00 Z2.\nX40.\nG01 Z-30.\n\
     X52.\nG00 X100. Z50.\nM30\n";

const SETUP: &str =
    "[stock]\ndiameter_mm = 50\nlength_mm = 90\n[tools.1]\ninsert = \"DNMG150404\"\nnose_radius_mm = 0\n";

fn json(old: &str, new: &str) -> (i32, Value) {
    let ran = turnwright(&["diff", old, new, "--format", "json"]);
    let value = serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{} {}", ran.out, ran.err));
    (ran.status, value)
}

/// The program and an edited one, each with the setup.
fn pair(folder: &Folder, edit: impl Fn(&str) -> String) -> (String, String) {
    for name in ["old.toml", "new.toml"] {
        folder.file(name, SETUP);
    }
    (folder.file("old.nc", PROGRAM), folder.file("new.nc", edit(PROGRAM)))
}

#[test]
fn a_program_is_the_same_as_itself_however_it_is_written() {
    let folder = Folder::new();
    let (old, new) = pair(&folder, |text| {
        // Sequence numbers, comments, blanks, zeros, an empty line: all is text.
        let lines = text.lines().enumerate().map(|(index, line)| match index {
            0 => "O1(OTHER)\n\n".to_string(),
            _ => format!("N{} {} (x)\n", index * 10, line.replace("X44.", "X44.000").replace("G01", "G1")),
        });
        lines.collect()
    });
    for other in [&old, &new] {
        let (status, same) = json(&old, other);
        assert_eq!((status, &same["same"]), (0, &Value::Bool(true)), "{same}");
    }
    assert!(turnwright(&["diff", &old, &new]).out.contains("The programs do the same"));
}

#[test]
fn one_number_changed_is_exactly_that() {
    let folder = Folder::new();
    let (old, new) = pair(&folder, |text| text.replace("X40.", "X40.4"));
    let (status, changed) = json(&old, &new);
    assert_eq!(status, 1);
    assert_eq!(changed["passes"]["changed"], 1, "{changed}");
    assert_eq!(
        (&changed["passes"]["added"], &changed["passes"]["removed"]),
        (&Value::from(0), &Value::from(0))
    );
    let pass = &changed["passes"]["list"][0];
    assert_eq!((pass["new_line"].as_u64(), pass["cycle"].is_null()), (Some(10), true), "{pass}");
    assert!((pass["x"].as_f64().expect("a number") - 0.4).abs() < 1e-9, "{pass}");
    // The rapid that leads to it ends elsewhere too.
    assert_eq!(changed["rapids"].as_array().expect("rapids").len(), 1);
    let pieces = changed["part"]["pieces"].as_array().expect("pieces");
    assert_eq!(pieces.len(), 1, "{changed}");
    let piece = &pieces[0];
    assert_eq!((&piece["only"], &piece["kind"]), (&Value::from("new"), &Value::from("diameter")));
    assert!((piece["old"].as_f64().expect("a size") - 40.0).abs() < 1e-9);
    assert!((piece["new"].as_f64().expect("a size") - 40.4).abs() < 1e-9);
    assert!((piece["area_mm2"].as_f64().expect("an area") - 0.2 * 30.0).abs() < 1e-6, "{piece}");
    let said = turnwright(&["diff", &old, &new]);
    assert!(said.out.contains("1 changed") && said.out.contains("⌀40 → ⌀40.4, Z0 to Z-30"), "{}", said.out);
    assert!(turnwright(&["diff", &old, &new, "--lang", "zh"]).out.contains("走刀：改变 1"));
    // A feed leaves the part alone and changes the time.
    let (old, new) = pair(&folder, |text| text.replace("F0.2", "F0.25"));
    let (status, changed) = json(&old, &new);
    assert_eq!((status, changed["part"]["pieces"].as_array().map(Vec::len)), (1, Some(0)), "{changed}");
    assert_eq!(changed["passes"]["changed"], 2, "{changed}");
    assert!(changed["time"]["new_s"].as_f64() < changed["time"]["old_s"].as_f64());
    // A face moves.
    let (old, new) = pair(&folder, |text| text.replace("Z-30.", "Z-31."));
    let face = &json(&old, &new).1["part"]["pieces"][0];
    assert_eq!((&face["kind"], &face["only"]), (&Value::from("face"), &Value::from("old")), "{face}");
    assert!((face["old"].as_f64().expect("a Z") + 30.0).abs() < 1e-9, "{face}");
    assert!((face["new"].as_f64().expect("a Z") + 31.0).abs() < 1e-9, "{face}");
}

#[test]
fn the_other_way_round_is_the_mirror() {
    let folder = Folder::new();
    let edits: [fn(&str) -> String; 4] = [
        |text| text.replace("X40.", "X41."),
        |text| text.replace("G00 Z2.\nX40.\nG01 Z-30.\nX52.\n", ""),
        |text| text.replace("M30", "G00 X48. Z2.\nG01 Z-50. F0.1\nX52.\nG00 Z60.\nM30"),
        |text| text.replace("G01 Z-30.\n", "G200\n"),
    ];
    for edit in edits {
        let (old, new) = pair(&folder, edit);
        let (there, back) = (json(&old, &new).1, json(&new, &old).1);
        let count = |value: &Value, name: &str| value["passes"][name].as_u64();
        assert_eq!(count(&there, "changed"), count(&back, "changed"));
        assert_eq!(count(&there, "added"), count(&back, "removed"));
        assert_eq!(count(&there, "removed"), count(&back, "added"));
        assert_eq!(
            (&there["time"]["old_s"], &there["time"]["new_s"]),
            (&back["time"]["new_s"], &back["time"]["old_s"])
        );
        let only = |value: &Value, side: &str| -> Vec<String> {
            let pieces = value["part"]["pieces"].as_array().expect("pieces").iter();
            pieces.filter(|piece| piece["only"] == side).map(|piece| piece["area_mm2"].to_string()).collect()
        };
        assert_eq!(only(&there, "old"), only(&back, "new"));
        assert_eq!(only(&there, "new"), only(&back, "old"));
        let told = |value: &Value, change: &str| {
            let told = value["diagnostics"].as_array().expect("diagnostics").iter();
            told.filter(|one| one["change"] == change).map(|one| one["id"].to_string()).collect::<Vec<_>>()
        };
        assert_eq!(told(&there, "added"), told(&back, "removed"));
        assert_eq!(told(&there, "removed"), told(&back, "added"));
    }
}

#[test]
fn alarms_that_come_are_told() {
    let folder = Folder::new();
    let (old, new) = pair(&folder, |text| text.replace("X52.\nG00 X100.", "X52..\nG00 X100."));
    let (status, changed) = json(&old, &new);
    let told = changed["diagnostics"].as_array().expect("diagnostics");
    assert!(told.iter().any(|one| one["change"] == "added" && one["severity"] == "alarm"), "{changed}");
    assert_eq!(status, 1);
}

#[test]
fn git_gives_seven_arguments_and_wants_success() {
    let folder = Folder::new();
    let (old, new) = pair(&folder, |text| text.replace("X40.", "X41."));
    let picture = folder.path("diff.svg").display().to_string();
    let ran =
        turnwright(&["diff", &new, &old, "0123abc", "100644", &new, "4567def", "100644", "-o", &picture]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    assert!(ran.out.contains("new.nc") && ran.out.contains("1 changed"), "{}", ran.out);
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.contains("class=\"region\"") && drawn.contains("⌀40 → ⌀41"), "{drawn}");
    for wrong in
        [vec!["diff", old.as_str()], vec!["diff", &old, &new, "x"], vec!["diff", &old, "no-such-file.nc"]]
    {
        assert_eq!(turnwright(&wrong).status, 2, "{wrong:?}");
    }
}
