//! `turnwright data`: the control's own texts in and out.

mod support;

use serde_json::Value;
use support::{Folder, turnwright};

const OFFSETS: &str = "%\nG10 P1 X0.2 Z0. R0.\nG10 P10001 X-10. Z-20.5 R0.8 Q3\n%\n";
const PARAMETERS: &str = "%\nN00000 Q1 L1P00000000\nN01023 Q1 A1P1 A2P2\nN05130 Q1 L1P7\n%\n";

#[test]
fn texts_of_the_control_go_into_a_setup_file_and_out_again() {
    let folder = Folder::new();
    let (offsets, parameters) =
        (folder.file("offsets.txt", OFFSETS), folder.file("parameters.txt", PARAMETERS));
    let setup = folder.file("setup.toml", "");
    let ran = turnwright(&["data", "--import", &offsets, "--import", &parameters, "-o", &setup]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    assert!(ran.err.contains("1023"), "what is not known is said: {}", ran.err);
    let out = turnwright(&["data", &setup, "--export", "offsets"]);
    assert_eq!((out.status, out.out.as_str()), (0, OFFSETS), "{}", out.err);
    let out = turnwright(&["data", &setup, "--export", "parameters"]);
    assert_eq!((out.status, out.out.as_str()), (0, PARAMETERS), "{}", out.err);
    let all = turnwright(&["data", &setup, "--export", "all"]).out;
    let again = folder.file("again.toml", "");
    let all_text = folder.file("all.txt", &all);
    assert_eq!(turnwright(&["data", "--import", &all_text, "-o", &again]).status, 0);
    assert_eq!(turnwright(&["data", &again, "--export", "all"]).out, all);
}

#[test]
fn an_imported_setup_acts_in_a_program() {
    let folder = Folder::new();
    let offsets = folder.file("offsets.txt", OFFSETS);
    let setup = folder.file("part.toml", "");
    turnwright(&["data", "--import", &offsets, "-o", &setup]);
    let program = folder.file("part.nc", "O1\nT0101\nG00 X50. Z2.\nM30\n");
    let ran = turnwright(&["trace", &program, "--setup", &setup, "--format", "text"]);
    assert!(ran.out.contains("relocate d409.8 z420.5"), "{}", ran.out);
}

#[test]
fn data_is_shown_as_a_table_and_as_json() {
    let folder = Folder::new();
    let setup = folder.file(
        "setup.toml",
        "control = \"fanuc-0i-tf\"\n[parameters]\n5130 = 7\n[work]\nG55 = { z = -3.5 }\n[offsets.12]\nwear = { x = 0.25 }\ntip = 3\n",
    );
    let shown = turnwright(&["data", &setup]);
    for word in ["0.25", "G55", "-3.5", "5130", "wear", "12"] {
        assert!(shown.out.contains(word), "{word}: {}", shown.out);
    }
    let chinese = turnwright(&["data", &setup, "--lang", "zh"]);
    assert!(chinese.out.contains("刀补") && chinese.out.contains("磨损"), "{}", chinese.out);
    let json: Value =
        serde_json::from_str(&turnwright(&["data", &setup, "--format", "json"]).out).expect("JSON");
    assert_eq!(json["offsets"][0]["wear"]["x"], 0.25);
    assert_eq!(json["work"]["G55"]["z"], -3.5);
    assert_eq!(turnwright(&["data"]).out, "nothing is stated: no offsets, no work zeros, no parameters\n");
}

#[test]
fn what_is_no_data_is_refused_with_its_place() {
    let folder = Folder::new();
    let program = folder.file("program.nc", "O1\nG10 P1 X1.\nG00 X5.\nM30\n");
    let ran = turnwright(&["data", "--import", &program]);
    assert_eq!(ran.status, 1);
    assert!(ran.err.contains("T164") && ran.err.contains("program.nc:3"), "{}", ran.err);
    let wrong = folder.file("wrong.txt", "%\nG10 P999 X1.\n%\n");
    let ran = turnwright(&["data", "--import", &wrong]);
    assert_eq!(ran.status, 1);
    assert!(ran.err.contains("PS0030") && ran.err.contains("wrong.txt:2:5"), "{}", ran.err);
    let empty = folder.file("empty.txt", "%\n%\n");
    assert_eq!(turnwright(&["data", "--import", &empty]).status, 2);
    assert_eq!(turnwright(&["data", "--import", "missing.txt"]).status, 2);
    assert_eq!(turnwright(&["data", "missing.toml"]).status, 2);
    let refused = turnwright(&["data", "--export", "offsets", "--control", "gsk-980tdi"]);
    assert_eq!(refused.status, 2, "{}", refused.out);
    assert!(refused.err.contains("T165"), "{}", refused.err);
}

#[test]
fn a_word_of_bits_is_never_made_up() {
    let folder = Folder::new();
    let setup = folder.file("setup.toml", "[parameters]\n\"3401#0\" = 1\n");
    let ran = turnwright(&["data", &setup, "--export", "parameters"]);
    assert_eq!((ran.status, ran.out.as_str()), (0, "%\n%\n"));
    assert!(ran.err.contains("T166") && ran.err.contains("3401"), "{}", ran.err);
    let text = folder.file("text.txt", "N03401 Q1 L1P01000000\n");
    let ran = turnwright(&["data", &setup, "--import", &text, "--export", "parameters"]);
    assert_eq!(ran.out, "%\nN03401 Q1 L1P01000000\n%\n", "the text is newer than the file");
}
