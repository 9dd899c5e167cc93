//! `turnwright explain`, and parameters that are asked for by a wrong number.
//!
//! That every code, alarm and parameter is explained on every control is tested beside the command itself.

mod support;

use support::{Folder, turnwright};

#[test]
fn alarms_are_found_by_class_and_number_in_both_languages() {
    for (asked, control, id) in [
        ("ot500", "fanuc-0i-tf", "OT0500"),
        ("500", "fanuc-0i-mate-tb", "500"),
        ("ps62", "fanuc-0i-td", "PS0062"),
        ("MC3012", "fanuc-0i-tf", "MC3012"),
        ("3012", "fanuc-0i-tc", "3012"),
        ("5912", "gsk-980tdi", "5912"),
        ("SW0100", "fanuc-0i-tf", "SW0100"),
        ("909", "gsk-988ta", "909"),
    ] {
        for (language, cause) in [("en", "cause: "), ("zh", "原因：")] {
            let ran = turnwright(&["explain", asked, "--control", control, "--lang", language]);
            assert_eq!(ran.status, 0, "{asked}: {}", ran.err);
            assert!(ran.out.contains(&format!("{id}  ")) && ran.out.contains(cause), "{asked}: {}", ran.out);
        }
    }
    // Another class is another alarm.
    let ran = turnwright(&["explain", "PS0500", "--control", "fanuc-0i-tf"]);
    assert_eq!(ran.status, 2, "{}", ran.out);
}

#[test]
fn an_unknown_parameter_is_an_error_with_a_suggestion() {
    let folder = Folder::new();
    let program = folder.file("part.nc", support::CLEAN);
    for (control, given, near) in [
        ("fanuc-0i-tf", "3402#9=1", "3402#"),
        ("fanuc-0i-tf", "12211.X=1", "1221.X"),
        ("gsk-980tdi", "001#9=1", "001#"),
    ] {
        let ran = turnwright(&["check", &program, "--control", control, "--param", given]);
        assert_eq!(ran.status, 2, "{given}: {}", ran.err);
        assert!(ran.err.contains("T021") && ran.err.contains(near), "{given}: {}", ran.err);
    }
    let ran = turnwright(&["check", &program, "--control", "fanuc-0i-tf", "--param", "1221=1"]);
    assert!(ran.status == 2 && ran.err.contains("1221.X"), "{}", ran.err);
    let ran = turnwright(&["explain", "3402#9", "--control", "fanuc-0i-tf"]);
    assert!(ran.status == 2 && ran.err.contains("3402#"), "{}", ran.err);
}

#[test]
fn parameters_of_axes_that_the_machine_lacks_are_refused() {
    let folder = Folder::new();
    let program = folder.file("part.nc", support::CLEAN);
    let ran = turnwright(&["check", &program, "--control", "fanuc-0i-tf", "--param", "1221.C=90"]);
    assert!(ran.status == 2 && ran.err.contains("1221.C") && ran.err.contains("no axis C"), "{}", ran.err);
    folder.file("part.toml", "machine = \"turn-mill\"\n[work]\nG55 = { c = 12.5 }\n");
    let ran = turnwright(&["check", &program, "--control", "fanuc-0i-tf", "--param", "1221.C=90"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    let setup = folder.file("plain.toml", "[work]\nG55 = { c = 12.5 }\n");
    let ran = turnwright(&["check", &program, "--setup", &setup]);
    assert!(ran.status == 2 && ran.err.contains("no axis C"), "{}", ran.err);
}

#[test]
fn a_program_of_the_card_calls_no_other_one_from_there() {
    let folder = Folder::new();
    let program = folder.file("O0001.nc", "O0001\nM198 P2\nM30\n");
    folder.file("O0002.nc", "O0002\nM198 P3\nM99\n");
    folder.file("O0003.nc", "O0003\nM99\n");
    let ran = turnwright(&["check", &program, "--control", "fanuc-0i-tf"]);
    assert_eq!(ran.status, 1, "{}", ran.err);
    assert!(ran.err.contains("PS0210"), "{}", ran.err);
}

const ROUGHING: &str = "S800 M03\nG00 X60. Z2.\nG71 U10. R1.\nG71 P10 Q20 U0.4 W0.1 F0.2\nN10 G00 X30.\nG01 Z-20.\nX50. Z-30.\nN20 X60.\nM30\n";

#[test]
fn every_pass_of_a_cycle_says_what_caused_it() {
    let folder = Folder::new();
    let program = folder.file("part.nc", ROUGHING);
    let ran = turnwright(&["explain", &program, "--line", "4", "--control", "fanuc-0i-tf"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    let rows: Vec<Vec<&str>> = ran.out.lines().map(|line| line.split_whitespace().collect()).collect();
    let row = |number: &str| rows.iter().find(|row| row.first() == Some(&number)).expect("a row").join(" ");
    // From X60.4: the first level lies at X40.4, 9.8 below the start point, and ends where line 7 rises above it.
    assert_eq!(row("1"), "1 cut 9.8 40.4 2.1 40.4 -24.9 U10. in line 3, figure line 7");
    assert_eq!(row("2"), "2 along the figure 14.8 30.4 2.1 60.4 -29.9 figure lines 6 to 8");
    assert!(ran.out.contains("R1. in line 3") && ran.out.contains("parameter 5134"), "{}", ran.out);

    let json =
        turnwright(&["explain", &program, "--line", "4", "--control", "fanuc-0i-tf", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(value["cycle"], "G71");
    assert_eq!(value["passes"].as_array().map(Vec::len), Some(2));
    assert_eq!(value["parameters"][0]["word"], "U10.");

    let ran = turnwright(&["explain", &program, "--line", "4", "--control", "gsk-988ta", "--lang", "zh"]);
    assert!(ran.out.contains("第 3 行的 U10."), "{}", ran.out);
    let ran = turnwright(&["explain", &program, "--line", "2", "--control", "fanuc-0i-tf"]);
    assert!(ran.status == 2 && ran.err.contains("line 2"), "{}", ran.err);
}

#[test]
fn a_cycle_is_drawn_with_its_passes_numbered() {
    let folder = Folder::new();
    let program = folder.file("part.nc", ROUGHING);
    for name in ["cycle.svg", "cycle.png"] {
        let picture = folder.path(name);
        let target = picture.display().to_string();
        let ran =
            turnwright(&["explain", &program, "--line", "4", "--control", "fanuc-0i-tf", "-o", &target]);
        assert!(ran.status == 0 && ran.out.contains("U10. in line 3"), "{}", ran.err);
        assert!(std::fs::metadata(&picture).is_ok_and(|file| file.len() > 1_000), "{name}");
    }
    let svg = std::fs::read_to_string(folder.path("cycle.svg")).expect("the picture");
    for text in [">1</text>", ">2</text>", "G71 line 4: G71 P10 Q20"] {
        assert!(svg.contains(text), "{text}");
    }
    let ran = turnwright(&["explain", "G71", "-o", "cycle.svg"]);
    assert!(ran.status == 2 && ran.err.contains("--line"), "{}", ran.err);
}

#[test]
fn single_cycles_show_the_passes_of_their_line() {
    let folder = Folder::new();
    let text = "S500 M03\nG00 X50. Z2.\nG90 X40. Z-20. F0.2\nX30.\nG28 U0 W0\nM30\n";
    let program = folder.file("part.nc", text);
    let ran = turnwright(&["explain", &program, "--line", "4", "--control", "fanuc-0i-tf"]);
    let row = ran.out.lines().last().expect("a row").split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(row, "2 cut 10 30 2 30 -20 X30. in line 4", "{}", ran.out);
}

#[test]
fn the_depths_of_a_thread_come_from_their_words() {
    let folder = Folder::new();
    let text = "G97 S500 M03\nG00 X25. Z5.\nG76 P020060 Q100 R0.05\nG76 X17.4 Z-20. P1300 Q400 F2.\nM30\n";
    let program = folder.file("thread.nc", text);
    let ran = turnwright(&["explain", &program, "--line", "4", "--control", "fanuc-0i-tf"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    let row = |number: &str| {
        let line = ran.out.lines().find(|line| line.trim_start().starts_with(number)).expect("a row");
        line.to_string()
    };
    // Depths count from the crest, X20, not from the start point.
    assert!(row("1 ").starts_with("     1  thread    0.4    19.2"), "{}", ran.out);
    assert!(row("10 ").starts_with("    10  thread    1.3    17.4"), "{}", ran.out);
    assert!(row("9 ").ends_with("R0.05 in line 3"), "{}", ran.out);
    assert!(row("1 ").ends_with("Q400 in line 4"), "{}", ran.out);
    assert!(row("6 ").ends_with("Q100 in line 3"), "{}", ran.out);
    assert!(row("10 ").ends_with("P1300 in line 4"), "{}", ran.out);
    assert!(row("11 ").ends_with("P020060 in line 3"), "{}", ran.out);
}
