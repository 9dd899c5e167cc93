//! Lead-in and run-out of threads against the stock, and the overrun of a tap whose spindle stops.

mod support;

use support::{Folder, turnwright};

const HEAD: &str = "O0001\nT0101\nG97 S1000 M03\n";

/// What is said of the ways of threads: number and needs.
fn said(moves: &str, options: &[&str]) -> Vec<String> {
    let folder = Folder::new();
    let program = folder.file("part.nc", format!("{HEAD}{moves}M30\n"));
    let setup = folder.file("bar.toml", "[stock]\ndiameter_mm = 40.0\nlength_mm = 80.0\n");
    let mut arguments = vec!["check", program.as_str(), "--color", "never"];
    if options == ["inferred"] {
        // As without a setup file.
    } else {
        arguments.extend(["--setup", setup.as_str()]);
        arguments.extend(options);
    }
    let ran = turnwright(&arguments);
    let is_of_threads = |line: &&str| ["T081", "T381", "T383"].iter().any(|id| line.contains(id));
    ran.err.lines().filter(is_of_threads).map(str::to_string).collect()
}

#[test]
fn the_end_of_a_thread_needs_a_groove_a_chamfer_or_a_free_end() {
    // 1.5 mm at 1000 rpm: a thirtieth of a second is 0.83 mm; in: 3.0 mm.
    let [inside] = &said("G00 X38. Z6.\nG32 Z-20. F1.5\nG00 X45.\n", &[])[..] else { panic!("one word") };
    assert!(inside.contains("T381") && inside.contains("needs 0.8 mm of run-out and has 0.0 mm"), "{inside}");
    for good in [
        // Out at a slant; through the groove; over the end of the bar.
        "G00 X38. Z6.\nG32 Z-18. F1.5\nU4. W-2.\nG00 X45.\n",
        "G00 X42. Z-18.\nG01 X30. F0.1\nZ-21.\nX42.\nG00 Z6.\nX38.\nG32 Z-19.5 F1.5\nG00 X45.\n",
        "G00 X38. Z6.\nG32 Z-81. F1.5\nG00 X45.\n",
    ] {
        assert_eq!(said(good, &[]), [""; 0], "{good}");
    }
    // Half a millimetre behind the end of the bar is too little.
    let short = "G00 X38. Z6.\nG32 Z-80.5 F1.5\nG00 X45.\n";
    let [short] = &said(short, &[])[..] else { panic!("one word") };
    assert!(short.contains("needs 0.8 mm of run-out and has 0.5 mm"), "{short}");
    // The run-out of the cycle counts, and is missed where the parameter takes it away; the passes are told of once.
    let cycle = "G00 X42. Z6.\nG92 X38. Z-20. F1.5\nX37.5\nX37.2\n";
    assert_eq!(said(cycle, &["--param", "5130=10"]), [""; 0]);
    let without = said(cycle, &["--param", "5130=0"]);
    assert!(without.len() == 1 && without[0].contains("T381"), "{without:?}");
    // Nobody knows what lies behind a thread in a bar that is only inferred, unless the program cuts there.
    assert_eq!(said("G00 X38. Z6.\nG32 Z-20. F1.5\nG00 X45.\n", &["inferred"]), [""; 0]);
    let turned = "G00 X46. Z3.\nX44.\nG01 Z-50. F0.2\nG00 X46. Z6.\nX42.\nG01 Z-50. F0.2\nG00 X46.\nZ6.\nX40.\n\
                  G32 Z-20. F1.5\nG00 X46.\n";
    let turned = said(turned, &["inferred"]);
    assert!(turned.len() == 1 && turned[0].contains("T381"), "{turned:?}");
}

#[test]
fn the_way_to_the_work_is_that_of_the_long_axis() {
    let start = |z: &str| format!("G00 X38. Z{z}\nG32 Z-18. F1.5\nU4. W-2.\nG00 X45.\n");
    assert_eq!(said(&start("3.1"), &[]), [""; 0]);
    let near = said(&start("2."), &[]);
    assert!(near.len() == 1 && near[0].contains("needs 3.0 mm of lead-in and has 2.0 mm"), "{near:?}");
    assert_eq!(said(&start("2."), &["inferred"]), near);
    // A scroll on the face from d48: 4 mm of radius to the bar, and it ends inside; over the edge outwards it is right.
    let scroll = said("G00 X48. Z-1.\nG32 X10. F3.\nG00 Z2.\n", &[]);
    assert!(scroll[0].contains("needs 6.0 mm of lead-in and has 4.0 mm"), "{scroll:?}");
    assert!(scroll[1].contains("needs 1.7 mm of run-out and has 0.0 mm"), "{scroll:?}");
    // A taper of 60 degrees to the axis is long along X: 10 mm of radius to the edge of the bar.
    let taper = "G00 X60. Z4.\nG32 X20. Z-7.5 F3.\nG00 X70. Z20.\n";
    assert!(said(taper, &[]).iter().all(|said| !said.contains("T081")), "{:?}", said(taper, &[]));
}

#[test]
fn a_tap_led_by_the_encoder_goes_on_while_the_spindle_stops() {
    let tap = "G00 X0 Z6.\nG33 Z-20. F1.5\n";
    // The assumed spindle stops in a second from 1000 rpm: 8.3 turns of 1.5 mm.
    let [said_of_tap] = &said(tap, &["--control", "gsk-980tdi"])[..] else { panic!("one word") };
    assert!(said_of_tap.contains("T383") && said_of_tap.contains("12.5 mm"), "{said_of_tap}");
    // Rigid tapping leads the spindle: nothing to tell.
    let rigid = "G00 X0 Z6.\nM29 S1000\nG84 Z-20. F1.5\nG80\n";
    assert_eq!(said(rigid, &["--control", "fanuc-0i-tf"]), [""; 0]);
}
