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

/// What the program leaves of the bar: ⌀38 to Z-20.
const DRAWING: &str = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\ncontour\n90\n6\n70\n0\n10\n0\n20\n0\n10\n0\n20\n19\n\
                       10\n-20\n20\n19\n10\n-20\n20\n25\n10\n-60\n20\n25\n10\n-60\n20\n0\n0\nENDSEC\n0\nEOF\n";

const SHARP: &str =
    "[stock]\ndiameter_mm = 50\nlength_mm = 60\n[tools.1]\ninsert = \"CNMG120404\"\nnose_radius_mm = 0\n";

#[test]
fn a_part_is_held_against_a_drawing() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    folder.file("part.toml", SHARP);
    let (drawing, picture) =
        (folder.file("drawing.dxf", DRAWING), folder.path("target.svg").display().to_string());
    let good = turnwright(&["measure", &program, "--target", &drawing, "-o", &picture]);
    assert!(good.status == 0 && good.out.contains("within ±0.01 mm"), "{} {}", good.out, good.err);
    let svg = std::fs::read_to_string(&picture).expect("a picture");
    assert!(svg.contains("class=\"deviation\"") && !svg.contains("class=\"mark\""));
    // 0.25 mm more on the diameter, and 0.4 mm less in Z.
    let other = folder
        .file("other.dxf", DRAWING.replace("20\n19\n", "20\n19.25\n").replace("10\n-20\n", "10\n-20.4\n"));
    let asked = ["measure", &program, "--target", &other, "-o", &picture];
    let bad = turnwright(&asked);
    assert_eq!(bad.status, 1, "{}", bad.err);
    for words in ["too deep", "-0.25", "⌀38.5", "left standing", "+0.4"] {
        assert!(bad.out.contains(words), "{words}: {}", bad.out);
    }
    for words in ["T364", "0.25 mm below the target", "part.nc:6", "T365", "0.4 mm above"] {
        assert!(bad.err.contains(words), "{words}: {}", bad.err);
    }
    assert!(std::fs::read_to_string(&picture).expect("a picture").contains("cut by line 6"));
    let (status, held) = json(&[&asked[..4], &["--format", "json"]].concat());
    let target = &held["target"];
    assert_eq!(
        (status, &target["pass"], &target["gouges"][0]["line"]),
        (1, &Value::Bool(false), &Value::from(6))
    );
    assert!((target["gouge_max"].as_f64().expect("a length") - 0.25).abs() < 1e-6);
    let (status, loose) = json(&[&asked[..4], &["--tolerance", "0.4", "--format", "json"]].concat());
    assert_eq!((status, &loose["target"]["pass"]), (0, &Value::Bool(true)));
    let zh = turnwright(&[&asked[..4], &["--lang", "zh"]].concat());
    assert!(zh.out.contains("过切") && zh.err.contains("零件在"), "{} {}", zh.out, zh.err);
    let (_, plain) = json(&["measure", &program, "--format", "json"]);
    assert!(plain["target"].is_null());
}

#[test]
fn our_own_drawing_read_back_deviates_nowhere() {
    let folder = Folder::new();
    let thread = "T0303\nG00 X40. Z5.\nG92 X37.2 Z-12. F1.5\nX36.4\nG00 X100. Z100.\nM30\n";
    let program = folder.file("part.nc", PROGRAM.replace("M30\n", thread));
    folder.file("part.toml", SHARP);
    let drawing = folder.path("part.dxf").display().to_string();
    assert_eq!(turnwright(&["part", &program, "-o", &drawing]).status, 0);
    let (status, held) =
        json(&["measure", &program, "--target", &drawing, "--tolerance", "0.001", "--format", "json"]);
    let target = &held["target"];
    assert_eq!(
        (status, target["gouge_max"].as_f64(), target["rest_max"].as_f64()),
        (0, Some(0.0), Some(0.0))
    );
}

#[test]
fn a_part_is_held_against_the_figure_of_its_finishing() {
    let folder = Folder::new();
    let text = "O1\nT0101 G97 S800 M03\nG00 X52. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U-0.4 W0.1 F0.2\nN10 G00 X20.\n\
                G01 Z-20. F0.1\nX40. Z-25.\nN20 X52.\nG70 P10 Q20\nG00 X100. Z100.\nM30\n";
    let (program, sound) =
        (folder.file("part.nc", text), folder.file("sound.nc", text.replace("U-0.4", "U0.4")));
    for name in ["part.toml", "sound.toml"] {
        folder.file(name, SHARP);
    }
    let held = turnwright(&["measure", &program, "--target", "g70"]);
    assert!(
        held.status == 1 && held.err.contains("T364") && held.out.contains("-0.2"),
        "{} {}",
        held.out,
        held.err
    );
    for command in ["run", "check"] {
        let told = turnwright(&[command, &program]);
        assert!(told.status == 1 && told.err.contains("T362"), "{command}: {}", told.err);
        assert!(!turnwright(&[command, &sound]).err.contains("T362"));
    }
    // Of a tool that is assumed it is a warning, which can be switched off.
    folder.file("part.toml", "[stock]\ndiameter_mm = 50\nlength_mm = 60\n");
    let assumed = turnwright(&["check", &program]);
    assert!(assumed.status == 0 && assumed.err.contains("warning[T362]"), "{}", assumed.err);
    assert!(!turnwright(&["check", &program, "--allow", "figure-gouged"]).err.contains("T362"));
    let good = turnwright(&["measure", &sound, "--target", "G70"]);
    assert!(good.status == 0 && good.out.contains("within"), "{} {}", good.out, good.err);
    // A taper that a round nose leaves.
    folder.file("sound.toml", SHARP.replace("nose_radius_mm = 0\n", ""));
    let rest = turnwright(&["check", &sound]);
    assert!(rest.status == 0 && rest.err.contains("T363"), "{}", rest.err);
    assert_eq!(turnwright(&["check", &sound, "--deny", "figure-not-reached"]).status, 1);
    assert!(!turnwright(&["check", &sound, "--allow", "T363"]).err.contains("T363"));
    // No finishing cycle, no figure.
    let without = folder.file("without.nc", PROGRAM);
    let ran = turnwright(&["measure", &without, "--target", "g70"]);
    assert!(ran.status == 1 && ran.err.contains("T367"), "{}", ran.err);
}

#[test]
fn targets_that_cannot_be_read_are_refused_with_the_reason() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    folder.file("part.toml", SHARP);
    let axis = "0\nLINE\n8\naxis\n10\n0\n20\n0\n11\n-60\n21\n0\n0\nENDSEC\n";
    let cases = [
        (DRAWING.replace("0\nEOF\n", ""), "ends too early"),
        ("hello\nworld\n".to_string(), "line 1 has no DXF group code"),
        (DRAWING.replace("10\n-60\n20\n0\n", ""), "ends in the open at Z-60, radius 25"),
        (DRAWING.replace("20\n25\n", "20\n1e9\n"), "more than a kilometre"),
        (DRAWING.replacen("0\nENDSEC\n", axis, 1), "axis, contour"),
        (DRAWING.replace("LWPOLYLINE", "SPLINE"), "SPLINE"),
        ("0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n".to_string(), "nothing is drawn"),
    ];
    for (text, words) in cases {
        let drawing = folder.file("bad.dxf", text);
        let ran = turnwright(&["measure", &program, "--target", &drawing]);
        assert!(ran.status == 2 && ran.err.contains(words), "{words}: {}", ran.err);
    }
    let drawing = folder.file("both.dxf", DRAWING.replacen("0\nENDSEC\n", axis, 1));
    assert_eq!(turnwright(&["measure", &program, "--target", &drawing, "--layer", "contour"]).status, 0);
    let none = turnwright(&["measure", &program, "--target", &drawing, "--layer", "none"]);
    assert!(none.status == 2 && none.err.contains("axis, contour"), "{}", none.err);
    let missing = folder.path("missing.dxf").display().to_string();
    assert_eq!(turnwright(&["measure", &program, "--target", &missing]).status, 2);
    for (tolerance, status) in [("0.001", 0), ("0.0009", 2), ("10", 0), ("10.1", 2), ("nan", 2)] {
        let asked =
            ["measure", &program, "--target", &drawing, "--layer", "contour", "--tolerance", tolerance];
        assert_eq!(turnwright(&asked).status, status, "{tolerance}");
    }
    assert_eq!(turnwright(&["measure", &program, "-o", "x.svg"]).status, 2);
}
