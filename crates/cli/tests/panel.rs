//! The operator's panel on the command line: what each switch does to times and samples, and what is refused.

mod support;

use serde_json::Value;
use support::{Folder, turnwright};

/// A cut of 35 mm at 0.25 mm × 600 rpm = 150 mm/min: 14 s; a thread of 26 mm; a dwell of 1.5 s; the way home.
const PROGRAM: &str = "O0001\nT0101\nG97 S600 M03\nG00 X50. Z5.\nG01 Z-30. F0.25\nG00 X100. Z50.\nG04 X1.5\n\
                       G00 X40. Z6.\nG32 Z-20. F1.5\nG00 X60.\nG28 U0 W0\nM30\n";

fn seconds(program: &str, options: &[&str]) -> Value {
    let ran = turnwright(&[&["time", program, "--format", "json"], options].concat());
    assert_eq!(ran.status, 0, "{options:?} {}", ran.err);
    let document: Value = serde_json::from_str(&ran.out).expect("JSON");
    document["programs"][0].clone()
}

fn part(program: &Value, name: &str) -> f64 {
    program["time"][name].as_f64().expect("seconds")
}

#[test]
fn overrides_dry_run_and_their_parameters_change_the_time() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    let usual = seconds(&program, &[]);
    assert!((part(&usual, "cutting_s") - 14.0).abs() < 0.1);
    let half = seconds(&program, &["--feed-override", "50"]);
    assert!((part(&half, "cutting_s") - 28.0).abs() < 0.1);
    for same in ["threading_s", "rapid_s", "dwell_s"] {
        assert_eq!(part(&half, same), part(&usual, same));
    }
    // The report says how the panel stood, and gives no advice for a run that nobody means to repeat.
    assert_eq!(half["estimates"][0]["key"], "panel-feed-override");
    assert!(half["estimates"][0]["text"].as_str().is_some_and(|text| text.contains("50 %")));
    assert_eq!(half["advice"], serde_json::json!([]));

    let lowest = seconds(&program, &["--rapid-override", "F0", "--param", "1421=2000"]);
    let quarter = seconds(&program, &["--rapid-override", "25%"]);
    assert!(part(&lowest, "rapid_s") > part(&quarter, "rapid_s"));
    assert!(part(&quarter, "rapid_s") > 3.0 * part(&usual, "rapid_s"));

    // 1410 is the speed; 1401#5 takes threads out of it, 1401#6 rapids into it.
    let dry = seconds(&program, &["--dry-run", "--param", "1410=3000"]);
    assert!((part(&dry, "cutting_s") - 0.7).abs() < 0.15, "{}", dry["time"]);
    assert!(part(&dry, "threading_s") < 0.7 && part(&usual, "threading_s") > 1.5);
    let kept = seconds(&program, &["--dry-run=3000", "--param", "1401#5=1", "--param", "1401#6=1"]);
    assert_eq!(part(&kept, "threading_s"), part(&usual, "threading_s"));
    assert!(part(&kept, "rapid_s") > 3.0 * part(&usual, "rapid_s"));
    assert_eq!(part(&dry, "rapid_s"), part(&usual, "rapid_s"));

    // 1428 is the rate of the way home.
    let slow_home = seconds(&program, &["--param", "1428=2000"]);
    assert!(part(&slow_home, "rapid_s") > part(&usual, "rapid_s") + 5.0);
    assert_eq!(part(&slow_home, "cutting_s"), part(&usual, "cutting_s"));
    let many = turnwright(&["time", &program, &program, "--feed-override", "50", "--format", "json"]);
    let many: Value = serde_json::from_str(&many.out).expect("JSON");
    assert_eq!(many["programs"][1]["time"]["cutting_s"], half["time"]["cutting_s"]);
}

/// Time, Z and kind of each row.
fn rows(program: &str, options: &[&str]) -> Vec<(f64, f64, String)> {
    let ran = turnwright(&[&["motion", program, "--rate", "100"], options].concat());
    assert_eq!(ran.status, 0, "{options:?} {}", ran.err);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[0].parse().expect("a time"), cells[2].parse().expect("a place"), cells[6].to_string())
    };
    ran.out.lines().skip(1).map(row).collect()
}

#[test]
fn what_the_operator_does_when_stands_in_the_table() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    let usual = rows(&program, &[]);
    let end = |rows: &[(f64, f64, String)]| rows[rows.len() - 1].0;
    // Held for three seconds in the middle of the cut: it stands, and the rest comes three seconds later.
    let held = rows(&program, &["--hold", "8..11"]);
    let at = |time: f64| held.iter().find(|row| row.0 >= time).expect("a row").1;
    assert!(at(8.5) == at(10.9) && at(7.0) > at(8.0) && at(11.5) < at(11.0));
    let later = end(&held) - end(&usual);
    assert!((later - 3.0).abs() < 0.2, "{later}");
    // Twice the feed from 8 s on saves half of what is left.
    let fast = rows(&program, &["--at", "8:feed=200"]);
    assert!(end(&fast) < end(&usual) - 3.0, "{} {}", end(&fast), end(&usual));
    // The same said in other words, several at once; the thread heeds none of it.
    let also = rows(&program, &["--at", "8:hold", "--at", "11:start,feed=100%"]);
    assert_eq!(held, also);
    let threading = |rows: &[(f64, f64, String)]| rows.iter().filter(|row| row.2 == "threading").count();
    let slow = rows(&program, &["--feed-override", "10", "--single-block", "--rapid-override", "50"]);
    assert!(threading(&slow).abs_diff(threading(&usual)) <= 12, "half a turn of chance at most");
    // Never let go: the table ends there, and that is said.
    let program = program.as_str();
    let ran = turnwright(&["motion", program, "--rate", "100", "--hold", "8.."]);
    assert_eq!(ran.status, 0);
    assert!(ran.err.contains("T380") && ran.err.contains("the table ends there"), "{}", ran.err);
    let last = ran.out.lines().last().expect("a row").split(',').next().map(str::parse::<f64>);
    assert!(last.is_some_and(|time| time.is_ok_and(|time| time < 8.5)));
}

#[test]
fn what_no_panel_has_is_refused_with_what_would_be_right() {
    let folder = Folder::new();
    let program = folder.file("part.nc", PROGRAM);
    for (options, said) in [
        (["time", "--feed-override=255"], "0 to 254"),
        (["time", "--feed-override=0"], "turnwright motion --hold"),
        (["time", "--rapid-override=0"], "F0"),
        (["time", "--rapid-override=F0"], "parameter 1421 is 0"),
        (["time", "--dry-run=0"], "above 0"),
        (["motion", "--hold=3"], "12.5..15"),
        (["motion", "--hold=3..2"], "before it begins"),
        (["motion", "--at=-1:hold"], "seconds since the start"),
        (["motion", "--at=1:speed=50"], "no switch of the panel"),
        (["motion", "--at=1:rapid=F0"], "parameter 1421 is 0"),
    ] {
        let ran = turnwright(&[options[0], &program, options[1]]);
        assert_eq!(ran.status, 2, "{options:?}");
        assert!(ran.err.contains(said), "{options:?} {}", ran.err);
    }
    // The number is that of the control.
    let ran = turnwright(&["time", &program, "--control", "gsk-980tdi", "--rapid-override", "F0"]);
    assert!(ran.status == 2 && ran.err.contains("parameter 032 is 0"), "{}", ran.err);
    // The 980 has no parameter for the speed of dry runs.
    let ran = turnwright(&["time", &program, "--control", "gsk-980tdi", "--dry-run"]);
    assert!(ran.status == 2 && ran.err.contains("T384") && ran.err.contains("manual feed"), "{}", ran.err);
    let ran = turnwright(&["motion", &program, "--control", "gsk-980tdi", "--at", "1:dry-run=on"]);
    assert!(ran.status == 2 && ran.err.contains("T384"), "{}", ran.err);
    let ran = turnwright(&["time", &program, "--control", "gsk-980tdi", "--dry-run=1260"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
}
