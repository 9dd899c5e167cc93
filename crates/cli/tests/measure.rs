//! `turnwright measure`, and the drawing's sizes in `run` and `check`.

mod support;

use serde_json::Value;
use support::{Folder, turnwright};

const PROGRAM: &str =
    "O1\nT0101\nG97 S800 M03\nG00 X52. Z2.\nG90 X40. Z-20. F0.2\nX38.\nG00 X100. Z100.\nM30\n";

const SETUP: &str = "[stock]\nmaterial = \"6061\"\ndiameter_mm = 50\nlength_mm = 60\n\
    [[measure]]\nname = \"seat\"\nat = \"Z-10\"\ndiameter_mm = 38.02\ntolerance_mm = [0, -0.02]\n";

fn json(arguments: &[&str]) -> (i32, Value) {
    let ran = turnwright(arguments);
    let value = serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{} {}", ran.out, ran.err));
    (ran.status, value)
}

#[test]
fn a_part_is_measured_at_places_and_as_a_whole() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    folder.file("part.toml", SETUP);
    let ran = turnwright(&["measure", &program]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    for words in ["⌀50 × 60 mm", "g of 6061 (wrought aluminium alloy)", "⌀38", "seat: 38 mm, in tolerance"]
    {
        assert!(ran.out.contains(words), "{words}: {}", ran.out);
    }
    let (status, whole) = json(&["measure", &program, "--format", "json"]);
    let volume = std::f64::consts::PI * (19.0 * 19.0 * 20.0 + 25.0 * 25.0 * 40.0);
    assert!((whole["sizes"]["volume_mm3"].as_f64().expect("a volume") - volume).abs() < 1e-6);
    assert!((whole["sizes"]["mass_g"].as_f64().expect("a mass") - volume * 2.7e-3).abs() < 1e-6);
    assert_eq!((status, &whole["measures"][0]["pass"]), (0, &Value::Bool(true)));
    let (_, at) = json(&["measure", &program, "--at", "Z-10", "--at", "X45", "--format", "json"]);
    assert_eq!(at["at"][0]["behind"][0]["diameter"], 38.0);
    assert_eq!(at["at"][1]["material"][0]["length"], 40.0);
    assert!(turnwright(&["measure", &program, "--lang", "zh"]).out.contains("合格"));
    let refused = turnwright(&["measure", &program, "--at", "Y3"]);
    assert!(refused.status == 2 && refused.err.contains("Z-32"), "{}", refused.err);
    let idle = folder.file("idle.nc", "O1\nM30\n");
    assert!(turnwright(&["measure", &idle]).out.contains("no part to measure"));
}

#[test]
fn a_size_beyond_its_limit_is_an_error_everywhere() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    folder.file("part.toml", SETUP.replace("38.02", "38.0201"));
    for command in ["run", "check", "measure"] {
        let ran = turnwright(&[command, &program]);
        assert_eq!(ran.status, 1, "{command}: {}", ran.err);
        assert!(ran.err.contains("T375") && ran.err.contains("seat is 38 mm, -0.0001 mm"), "{}", ran.err);
    }
    let (_, report) = json(&["run", &program, "--format", "json"]);
    assert_eq!(report["measures"][0]["pass"], false);
    folder.file("part.toml", SETUP);
    for command in ["run", "check", "measure"] {
        assert_eq!(turnwright(&[command, &program]).status, 0, "{command}");
    }
    // A program that stops short has no finished part to judge.
    let alarms = folder.file("part.nc", PROGRAM.replace("X38.", "G200 X38."));
    let ran = turnwright(&["check", &alarms]);
    assert!(ran.status == 1 && !ran.err.contains("T375"), "{}", ran.err);
    // A program that cuts nothing has none of the sizes.
    folder.file("part.nc", "O1\nM30\n");
    folder.file("part.toml", SETUP.split_once("[[").map_or(String::new(), |(_, sizes)| format!("[[{sizes}")));
    assert!(turnwright(&["check", &program]).err.contains("T376"));
}

#[test]
fn sizes_that_cannot_be_are_refused_with_key_and_line() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    for (setup, line, words) in [
        ("[[measure]]\nat = \"Z-10\"\ndiametr_mm = 38\n", 3, "did you mean diameter_mm?"),
        ("[[measure]]\nat = \"Z-10\"\ndiameter_mm = 38\ntolerance_mm = [0.1, 0.1]\n", 4, "the same"),
        ("[stock]\nmaterial = \"40Crr\"\n", 2, "did you mean 40Cr?"),
    ] {
        folder.file("part.toml", setup);
        let (status, told) = json(&["check", &program, "--format", "json"]);
        assert_eq!(
            (status, told["key"].as_str(), told["line"].as_u64()),
            (2, Some("setup-invalid"), Some(line))
        );
        assert!(told["message"].as_str().expect("a message").contains(words), "{told}");
    }
}

#[test]
fn cutting_data_are_told_with_their_lines_and_drawn() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    folder.file("part.toml", SETUP);
    let out = folder.path("out").display().to_string();
    let ran = turnwright(&["run", &program, "--out", &out]);
    assert!(ran.out.contains("depth of cut up to 5.000 mm (line 5, tool 1)"), "{}", ran.out);
    assert!(ran.out.contains("estimated for 6061") && ran.out.contains("kW"), "{}", ran.out);
    let drawn = std::fs::read_to_string(folder.path("out/cutting.svg")).expect("a picture");
    assert!(drawn.matches("class=\"course\"").count() >= 6, "{drawn}");
    let (_, report) = json(&["run", &program, "--format", "json"]);
    let peaks = &report["cutting"]["peaks"];
    assert_eq!(
        (&peaks["depth_mm"]["line"], &report["cutting"]["model"]),
        (&Value::from(5), &Value::from("kienzle"))
    );
    assert_eq!(report["cutting"]["lines"].as_array().expect("lines").len(), 2);
    // Without a material there is no force, and the report says how to get it.
    folder.file("part.toml", SETUP.replace("material = \"6061\"\n", ""));
    let ran = turnwright(&["run", &program]);
    assert!(ran.out.contains("no force and power") && !ran.out.contains("kW"), "{}", ran.out);
}
