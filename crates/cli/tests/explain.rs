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
fn a_program_of_the_card_calls_no_other_one_from_there() {
    let folder = Folder::new();
    let program = folder.file("O0001.nc", "O0001\nM198 P2\nM30\n");
    folder.file("O0002.nc", "O0002\nM198 P3\nM99\n");
    folder.file("O0003.nc", "O0003\nM99\n");
    let ran = turnwright(&["check", &program, "--control", "fanuc-0i-tf"]);
    assert_eq!(ran.status, 1, "{}", ran.err);
    assert!(ran.err.contains("PS0210"), "{}", ran.err);
}
