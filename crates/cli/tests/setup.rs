//! `turnwright setup`, and setups that comments of the program give.

mod support;

use serde_json::Value;
use support::{Folder, turnwright};

const PROGRAM: &str =
    "O1\nT0101\nG97 S800 M03\nG00 X52. Z2.\nG90 X40. Z-20. F0.2\nX38.\nG00 X100. Z100.\nM30\n";

#[test]
fn the_setup_that_is_written_is_found_and_leaves_nothing_to_assume() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    let report: Value =
        serde_json::from_str(&turnwright(&["run", &program, "--format", "json"]).out).expect("JSON");
    let assumptions = report["assumptions"].as_array().expect("assumptions");
    assert!(assumptions.iter().any(|one| one["section"] == "stock" && one["setting"] == "diameter_mm"));
    let said = turnwright(&["run", &program]).out;
    assert!(said.contains("Stock: 52 mm thick, the largest X that is fed to (line 5)"), "{said}");
    let setup = folder.file("part.toml", "");
    let ran = turnwright(&["setup", &program, "-o", &setup]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    let report: Value =
        serde_json::from_str(&turnwright(&["run", &program, "--format", "json"]).out).expect("JSON");
    assert_eq!(report["assumptions"], Value::Array(Vec::new()));
    // Written again from the file it is the same, without the assumptions among its comments.
    let again = turnwright(&["setup", &program]).out;
    assert!(!again.contains("assumed:"), "{again}");
    let values = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !line.starts_with('#')).map(str::to_string).collect()
    };
    let written = std::fs::read_to_string(&setup).expect("a setup");
    assert!(written.contains("# assumed: Stock: 52 mm"), "{written}");
    assert_eq!(values(&again), values(&written));
    let chinese = turnwright(&["setup", &program, "--lang", "zh"]).out;
    assert!(chinese.contains("# 棒料或管料的外径。"), "{chinese}");
}

#[test]
fn comments_of_the_program_count_before_the_file() {
    let folder = Folder::new();
    let comments = "O1\n(SETUP STOCK D55 L80)\n(setup tool 1 DNMG150608 R0.8)\n";
    let program = folder.file("part.nc", PROGRAM.replacen("O1\n", comments, 1));
    folder.file("part.toml", "[stock]\ndiameter_mm = 60\nlength_mm = 70\nface_mm = 0.5\n");
    let setup = turnwright(&["setup", &program]).out;
    for line in ["diameter_mm = 55", "length_mm = 80", "face_mm = 0.5", "insert = \"DNMG150608\""] {
        assert!(setup.contains(line), "{line}: {setup}");
    }
    assert!(!setup.contains("assumed: Stock"), "{setup}");
}

#[test]
fn setups_that_cannot_be_are_refused_with_key_and_place() {
    let folder = Folder::new();
    // A remark that only looks like it is told and passed over.
    let program = folder.file("part.nc", PROGRAM.replacen("O1\n", "O1\n(SETUP STOK D55)\n", 1));
    let ran = turnwright(&["check", &program, "--format", "json"]);
    let told: Value = serde_json::from_str(ran.out.lines().next().expect("a line")).expect("JSON");
    assert_eq!((ran.status, told["key"].as_str()), (0, Some("setup-comment-invalid")), "{}", ran.out);
    assert_eq!((told["line"].as_u64(), told["column"].as_u64()), (Some(2), Some(1)));
    assert!(told["message"].as_str().is_some_and(|text| text.contains("did you mean STOCK?")));
    let program = folder.file("tube.nc", PROGRAM.replacen("O1\n", "O1\n(SETUP STOCK D5 L9 BORE9)\n", 1));
    let ran = turnwright(&["check", &program, "--format", "json"]);
    let refused: Value = serde_json::from_str(ran.out.lines().next().expect("a line")).expect("JSON");
    assert_eq!((ran.status, refused["key"].as_str()), (2, Some("setup-comment-invalid")), "{}", ran.out);
    assert!(refused["message"].as_str().is_some_and(|text| text.contains("stock.bore_mm")), "{refused}");
    // Of several comments the one to blame is shown: here the size whose fit the tables do not have.
    let head = "O1\n(SETUP STOCK D55 L80)\n(SETUP MEASURE D30 Z-5 H7)\n(SETUP MEASURE D30 Z-6 ZC7)\n";
    let program = folder.file("fit.nc", PROGRAM.replacen("O1\n", head, 1));
    let ran = turnwright(&["check", &program, "--format", "json"]);
    let refused: Value = serde_json::from_str(ran.out.lines().next().expect("a line")).expect("JSON");
    assert_eq!((ran.status, refused["line"].as_u64()), (2, Some(4)), "{}", ran.out);
    assert!(
        refused["message"].as_str().is_some_and(|text| text.contains("measure.2.tolerance_mm")),
        "{refused}"
    );
    let program = folder.file("bore.nc", PROGRAM);
    folder.file("bore.toml", "[stock]\ndiameter_mm = 30\nlength_mm = 70\nbore_mm = 40\n");
    let ran = turnwright(&["check", &program, "--format", "json"]);
    let refused: Value = serde_json::from_str(ran.out.lines().next().expect("a line")).expect("JSON");
    assert_eq!(
        (refused["key"].as_str(), refused["line"].as_u64()),
        (Some("setup-invalid"), Some(4)),
        "{refused}"
    );
    assert!(refused["message"].as_str().is_some_and(|text| text.contains("stock.bore_mm")), "{refused}");
}

#[test]
fn warnings_are_switched_by_name_or_number() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM.replace("T0101", "T0102"));
    let keys = |arguments: &[&str]| -> (i32, Vec<(String, String)>) {
        let ran = turnwright(&[&["check", &program, "--format", "json"], arguments].concat());
        let lines = ran.out.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
        let word = |value: &Value| value.as_str().unwrap_or_default().to_string();
        (ran.status, lines.map(|line| (word(&line["key"]), word(&line["severity"]))).collect())
    };
    let told = |severity: &str| vec![("tool-offset-differs".to_string(), severity.to_string())];
    assert_eq!(keys(&[]), (0, told("warning")));
    assert_eq!(keys(&["--allow", "tool-offset-differs"]), (0, Vec::new()));
    assert_eq!(keys(&["--allow", "T095"]), (0, Vec::new()));
    assert_eq!(keys(&["--deny", "T095"]), (1, told("error")));
    assert_eq!(keys(&["--deny", "warnings"]), (1, told("error")));
    assert_eq!(keys(&["--allow", "tool-ofset-differs"]).0, 2);
    // The command line counts after the file.
    folder.file("part.toml", "[checks]\ndeny = [\"tool-offset-differs\"]\n");
    assert_eq!(keys(&[]), (1, told("error")));
    assert_eq!(keys(&["--allow", "T095"]), (0, Vec::new()));
    folder.file("part.toml", "[checks]\nallow = [\"tool-offset-differs\"]\n");
    assert_eq!(keys(&[]), (0, Vec::new()));
}
