//! A picture for each crash: which files are written, what is in them, how many, and when there are none.

mod support;

use serde_json::Value;
use support::{Folder, Ran, turnwright};

const HEAD: &str = "O1\n(SETUP STOCK D50 L80)\n(SETUP TOOL 1 CNMG120404 PCLNR2525M12)\n(SETUP CHUCK D160)\n\
    T0101\nG97 S800 M3\nG0 X52. Z2.\n";

/// Straight into the bar: 10 mm of Z, 5 of X.
const CRASH: &str = "X40.\nZ-10.\nG1 W5. F1.\nG0 X52.\nZ2.\n";

fn crash_files(folder: &Folder) -> Vec<String> {
    let names = support::names(&folder.path("out"));
    names.into_iter().filter(|name| name.starts_with("crash-")).collect()
}

fn run(folder: &Folder, body: &str, options: &[&str]) -> Ran {
    let program = folder.file("part.nc", format!("{HEAD}{body}G0 X100. Z50.\nM30\n"));
    let out = folder.path("out").display().to_string();
    turnwright(&[&["run", &program, "--out", &out], options].concat())
}

#[test]
fn a_crash_has_a_picture_that_the_console_names() {
    let folder = Folder::new();
    let ran = run(&folder, CRASH, &[]);
    assert_eq!(ran.status, 1);
    assert_eq!(crash_files(&folder), ["crash-1-line-9.svg"]);
    let named = format!("picture: {}", folder.path("out").join("crash-1-line-9.svg").display());
    assert!(ran.err.contains(&named), "{}", ran.err);
    let svg = std::fs::read_to_string(folder.path("out").join("crash-1-line-9.svg")).expect("a picture");
    for words in [
        "part.nc · line 9",
        ">Z-10.<",
        "at rapid, at X40 Z",
        ">5 mm<",
        "class=\"hit\"",
        "class=\"tool\"",
        "class=\"holder\"",
        "class=\"way\"",
        "class=\"depth\"",
        "what is in the way",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    // The same as data, and in Chinese.
    let ran = run(&folder, CRASH, &["--format", "json", "--lang", "zh"]);
    let report: Value = serde_json::from_str(&ran.out).expect("JSON");
    let found = report["diagnostics"].as_array().expect("findings");
    let crash = found.iter().find(|one| one["key"] == "rapid-into-stock").expect("the crash");
    assert!(crash["picture"].as_str().is_some_and(|file| file.ends_with("crash-1-line-9.svg")), "{crash}");
    assert_eq!(report["pictures_left_out"], 0);
    let svg = std::fs::read_to_string(folder.path("out").join("crash-1-line-9.svg")).expect("a picture");
    assert!(
        svg.contains("第 9 行") && svg.contains("快速移动时切入毛坯") && !svg.contains("what is in the way")
    );
}

#[test]
fn without_a_crash_there_is_no_picture_and_old_ones_go() {
    let folder = Folder::new();
    run(&folder, CRASH, &[]);
    folder.file("out/crash-report.svg", "mine");
    let ran = run(&folder, "X40.\nG1 Z-10. F0.2\nW5.\nG0 X52.\nZ2.\n", &["--format", "json"]);
    assert_eq!(ran.status, 0, "{}", ran.out);
    assert_eq!(crash_files(&folder), ["crash-report.svg"]);
    assert!(!ran.out.contains("\"picture\""));
    // Nothing is drawn when nothing is written.
    let program = folder.path("part.nc").display().to_string();
    assert!(!turnwright(&["run", &program]).err.contains("picture:"));
}

#[test]
fn jaws_and_holders_are_drawn_as_they_stand() {
    let folder = Folder::new();
    run(&folder, "X90.\nZ-82.\nX100.\nZ2.\n", &[]);
    let files = crash_files(&folder);
    let svg = std::fs::read_to_string(folder.path("out").join(&files[0])).expect("a picture");
    assert!(
        svg.contains("into the jaws")
            && svg.contains("class=\"obstacle\"")
            && svg.contains("round what is hit")
    );
    assert!(!svg.contains("class=\"hit\""));
}

#[test]
fn there_are_twenty_pictures_and_the_rest_is_counted() {
    let folder = Folder::new();
    // Ten findings a kind at most: into the stock, into the jaws, with the holder; each on a line of its own.
    let stock: String = (1..=12).map(|n| format!("X{}.\nZ-{n}0.\nG0 X52.\nZ2.\n", 50 - n)).collect();
    let jaws: String =
        (1..=12).map(|n| format!("X{}. Z-50.\nZ-7{}.\nX130.\nZ2.\n", 90 + n, n % 10)).collect();
    let ran = run(&folder, &(stock + &jaws), &["--format", "json"]);
    let report: Value = serde_json::from_str(&ran.out).expect("JSON");
    let findings = report["diagnostics"].as_array().expect("findings");
    let with = findings.iter().filter(|one| one["picture"].is_string()).count();
    assert_eq!((with, crash_files(&folder).len()), (20, 20));
    let left_out = report["pictures_left_out"].as_u64().expect("a number");
    assert!(left_out > 0, "{findings:?}");
    let out = run(&folder, "", &[]).out;
    assert!(!out.contains("no picture of their own"));
}
