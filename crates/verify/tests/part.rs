//! The parts that programs leave, and what they hit: with a setup that says everything, and with one that was inferred.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::path::Path;

use turnwright_control::Setup;
use turnwright_diagnostics::Severity;
use turnwright_stock::machining::RapidRates;
use turnwright_verify::Inference;
use turnwright_verify::part::{COMMANDS_PER_LOOK, Part, PartLimits, PartRun};

const RATES: RapidRates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };

/// Runs a program twice, as the command line does: once for the setup, once for the part.
fn part(text: &str, control: &str, given: &Setup) -> Part {
    let run = support::run(text, control, given);
    assert_eq!(run.alarm, None);
    let mut inference = Inference::new(run.start);
    run.commands.iter().for_each(|command| inference.add(command));
    let setup = inference.finish(given).setup;
    let mut part = PartRun::new(&setup, given, run.start, RATES).expect("a setup").expect("a stock");
    for command in &run.commands {
        part.add(command);
    }
    assert!(!part.is_full());
    part.finish()
}

fn example(file: &str) -> Part {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
    let text = std::fs::read_to_string(&path).expect("an example");
    let setup = std::fs::read_to_string(path.with_extension("toml"))
        .map_or_else(|_| Setup::default(), |words| Setup::parse(&words).expect("a setup"));
    part(&text, file.split('/').next().expect("a folder"), &setup)
}

/// The outer diameters at some Z, and no crash.
fn drawing(file: &str, diameters: &[(f64, f64)]) {
    let part = example(file);
    assert!(part.findings.is_empty(), "{file}: {:?}", part.findings);
    for &(z, diameter) in diameters {
        let rings = part.section.rings(z);
        let found = rings.last().map_or(0.0, |ring| 2.0 * ring.1);
        assert!((found - diameter).abs() < 1e-5, "{file}: {found} instead of {diameter} at Z{z}");
    }
}

#[test]
fn without_a_setup_the_examples_leave_the_parts_of_their_drawings_and_hit_nothing() {
    drawing("fanuc-0i-mate-tb/O4001-corner-radius.nc", &[(-1.0, 16.0), (-5.0, 20.0), (-22.0, 20.0)]);
    drawing("fanuc-0i-mate-tb/O4002-corner-chamfer.nc", &[(-0.5, 17.0), (-2.0, 20.0), (-22.0, 20.0)]);
    drawing("fanuc-0i-mate-tb/O4003-turning-cycle.nc", &[(-0.5, 20.0), (-24.95, 20.0)]);
    drawing("fanuc-0i-mate-tb/O4004-taper-turning-cycle.nc", &[(-10.0, 17.0), (-24.999, 19.9998)]);
    drawing("fanuc-0i-mate-tb/O4007-facing-cycle.nc", &[(-5.0, 20.0), (-9.99, 20.0)]);
    let shaft = [(-1.0, 15.0), (-15.0, 15.0), (-22.5, 22.5), (-30.0, 30.0), (-42.0, 30.0)];
    drawing("fanuc-0i-mate-tb/O4008-rough-turning.nc", &shaft);
    drawing("fanuc-0i-mate-tb/O4009-rough-facing.nc", &[(-5.0, 30.0), (-7.0, 30.0), (-12.5, 35.0)]);
    let figure = [(-5.0, 50.0), (-12.5, 55.0), (-20.0, 60.0), (-31.0, 64.0)];
    for axes in ["x-and-z", "x", "z"] {
        drawing(&format!("fanuc-0i-mate-tb/O4010-from-bar-{axes}.nc"), &figure);
    }
    drawing("gsk-988ta/O0005-rough-facing.nc", &[(-10.0, 60.0), (-20.0, 80.0), (-34.0, 80.0)]);
    drawing("gsk-980tdi/O0008-radial-groove.nc", &[(-35.0, 40.0), (-49.9, 40.0)]);
    let thread = example("fanuc-0i-mate-tb/O4005-thread-cycle.nc");
    assert!(thread.findings.is_empty(), "{:?}", thread.findings);
    assert_eq!((thread.threads.len(), thread.threads[0].lead_mm), (1, 1.5));
    assert!((2.0 * thread.threads[0].bounds.min.x - 17.8).abs() < 1e-5);
}

const STOCK: &str = "[stock]\ndiameter_mm = 50\nlength_mm = 80\n[chuck]\ngrip_mm = 20\n";
const TOOL: &str = "[tools.1]\ninsert = \"CNMG120404\"\nholder = \"PCLNR2525M12\"\n";

/// Keys, severities and lines of what is found.
fn found(text: &str, setup: &str) -> Vec<(&'static str, Severity, u32)> {
    let part = part(text, "fanuc-0i-tf", &Setup::parse(setup).expect("a setup"));
    let findings = part.findings.iter();
    findings.map(|one| (one.key, one.severity, one.place.expect("a place").line)).collect()
}

#[test]
fn a_rapid_into_stock_is_an_error_when_stock_and_tool_are_given() {
    let text = "O1\nT0101\nG97 S500 M03\nG00 X60. Z5.\nG00 X44. Z-10.\nG01 Z-20. F0.2\nX52.\nG00 X60.\nM30\n";
    let both = found(text, &format!("{STOCK}{TOOL}"));
    assert!(both.contains(&("rapid-into-stock", Severity::Error, 5)), "{both:?}");
    assert!(found(text, STOCK).contains(&("rapid-into-stock", Severity::Warning, 5)));
    // Nobody knows the bar: it may be thinner.
    assert_eq!(found(text, TOOL), []);
    let sound = text.replace("G00 X44. Z-10.", "G00 X44. Z2.");
    assert_eq!(found(&sound, &format!("{STOCK}{TOOL}")), []);
    // Straight out at rapid drags the nose over the shoulder, which leans by five degrees as its edge does.
    let drags = found(&sound.replace("X52.\n", ""), &format!("{STOCK}{TOOL}"));
    assert_eq!(drags, [("rapid-into-stock", Severity::Warning, 7)]);
}

#[test]
fn a_rapid_through_the_finished_part_is_told_whatever_the_stock_was() {
    let turning = "O1\nT0101\nG97 S500 M03\nG00 X60. Z2.\nX30.\nG01 Z-20. F0.2\nX50.\nG00 X60. Z2.\n";
    let rapid_to = |end: &str| found(&format!("{turning}G00 Z-10.\n{end}\nX60.\nM30\n"), "");
    let warning = ("rapid-into-stock", Severity::Warning, 10);
    assert_eq!(rapid_to("X26."), [warning, (warning.0, warning.1, 11)]);
    assert_eq!(rapid_to("X30."), []);
    // Less than a millimetre may be the guessed insert's doing.
    assert_eq!(rapid_to("X28.1"), []);
    assert_eq!(rapid_to("X28."), [warning, (warning.0, warning.1, 11)]);
    // Before the first cut nothing says how thick the bar is.
    let first = turning.replace("G00 X60. Z2.\nX30.", "G00 X60. Z-10.\nX26.\nX60.\nZ2.\nX30.");
    assert_eq!(found(&format!("{first}M30\n"), ""), []);
    // What a later cut takes away may have been thinner; and no rapid takes any of it away.
    let later = format!("{turning}G00 Z-10.\nX26.\nX60.\nZ2.\nX20.\nG01 Z-20. F0.2\nX50.\nG00 X60.\nM30\n");
    assert_eq!(found(&later, ""), []);
    let control = "fanuc-0i-tf";
    let met = part(&format!("{turning}G00 Z-10.\nX26.\nX60.\nM30\n"), control, &Setup::default());
    let sound = part(&format!("{turning}M30\n"), control, &Setup::default());
    assert_eq!(met.section.volume_mm3(), sound.section.volume_mm3());
}

#[test]
fn many_rapids_through_an_assumed_stock_hide_none_through_the_part() {
    let mut text = String::from("O1\nT0101\nG97 S500 M03\nG00 X60. Z2.\nX30.\nG01 Z-20. F0.2\nX50.\n");
    // A bar that is guessed too thick: what these meet is cut later.
    for _ in 0..500 {
        text.push_str("G00 Z-10.\nX28.\nX60.\n");
    }
    text.push_str("G00 Z2.\nX20.\nG01 Z-20. F0.2\nX50.\nG00 X60.\nZ-10.\nX10.\nX60.\nM30\n");
    let told = found(&text, "");
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told.iter().all(|one| one.0 == "rapid-into-stock" && one.2 > 1_500), "{told:?}");
}

#[test]
fn the_chuck_is_told() {
    // The jaws begin at Z-60.
    let text = "O1\nT0101\nG97 S500 M03\nG00 X46. Z2.\nG01 Z-65. F0.2\nX52.\nG00 X160.\nZ5.\nM30\n";
    let told = found(text, &format!("{STOCK}{TOOL}"));
    assert!(told.contains(&("tool-into-jaws", Severity::Error, 5)), "{told:?}");
    let sound = found(&text.replace("Z-65.", "Z-50."), &format!("{STOCK}{TOOL}"));
    assert_eq!(sound, []);
}

#[test]
fn what_is_cut_off_is_the_part_and_a_pip_is_not() {
    let text = "O1\nT0202\nG97 S500 M03\nG00 X52. Z-33.\nG01 X-1. F0.1\nG00 X60.\nM30\n";
    let setup = format!("{STOCK}[tools.2]\nkind = \"cut-off\"\nwidth_mm = 3\nreach_mm = 30\ntip = 3\n");
    let cut = part(text, "fanuc-0i-tf", &Setup::parse(&setup).expect("a setup"));
    assert!(cut.findings.iter().any(|one| one.key == "part-cut-off"), "{:?}", cut.findings);
    let bounds = cut.section.bounds().expect("a part");
    assert!((bounds.min.z + 30.0).abs() < 1e-9 && bounds.max.z == 0.0, "{bounds:?}");
    // Facing in two steps leaves a thin pip in front that falls; the part is what is held.
    let text = "O1\nT0202\nG97 S500 M03\nG00 X52. Z-3.5\nG01 X2. F0.1\nG00 X60.\nZ-5.\nG01 X-1. F0.1\nG00 X60.\nM30\n";
    let faced = part(
        &text.replace("Z-3.5\nG01 X2.", "Z-3.\nG01 X2."),
        "fanuc-0i-tf",
        &Setup::parse(&setup).expect("a setup"),
    );
    assert!(faced.section.bounds().expect("a part").min.z < -70.0);
}

#[test]
fn findings_are_bounded() {
    let mut text = String::from("O1\nT0101\nG97 S500 M03\nG00 X60. Z5.\n");
    for index in 1..60 {
        text.push_str(&format!("G00 X{}. Z-{index}.\nX60.\n", 48 - index % 20));
    }
    text.push_str("M30\n");
    let told = found(&text, &format!("{STOCK}{TOOL}"));
    let rapids = told.iter().filter(|one| one.0 == "rapid-into-stock").count();
    assert_eq!(rapids, 10);
}

#[test]
fn a_thread_leaves_the_surface_that_it_lies_in() {
    let given = Setup::parse("[stock]\ndiameter_mm = 40\nlength_mm = 60\n").expect("a setup");
    let turning = "O1\nT0101 G97 S800 M3\nG0 X30. Z2.\nG1 Z-20. F0.2\nX42.\nG0 X100. Z50.\n";
    let threading = "T0303\nG0 X34. Z5.\nG92 X29. Z-12. F1.5\nX28.2\nG0 X100. Z50.\n";
    let control = "fanuc-0i-tf";
    let threaded = part(&format!("{turning}{threading}M30\n"), control, &given);
    // In the middle of the spigot: what the rapid takes on its way out of the groove is no part of the drawing.
    assert_eq!(threaded.threads.len(), 1);
    assert_eq!(threaded.plain.spans(14.9), [(-60.0, 0.0)]);
    assert!(threaded.section.spans(14.9).len() > 5);
    // Without a thread both are one, and it is the same.
    let plain = part(&format!("{turning}M30\n"), control, &given);
    assert_eq!(plain.plain.volume_mm3(), plain.section.volume_mm3());
    assert!((plain.plain.volume_mm3() - threaded.plain.volume_mm3()).abs() < 1e-6);
}

/// The part of a program that is no longer cut at these limits.
fn limited(text: &str, limits: PartLimits) -> Part {
    let words = "[stock]\ndiameter_mm = 50\nlength_mm = 60\n[tools.1]\nkind = \"turning\"\nnose_radius_mm = 0\n\
        outline = [{ x = 0, z = 0 }, { x = 5, z = 0 }, { x = 5, z = 0.01 }, { x = 0, z = 0.01 }]\n";
    let setup = Setup::parse(words).expect("a setup");
    let run = support::run(text, "fanuc-0i-tf", &setup);
    assert_eq!(run.alarm, None);
    let part = PartRun::new(&setup, &setup, run.start, RATES).expect("a setup").expect("a stock");
    let mut part = part.with_limits(limits);
    for command in &run.commands {
        part.add(command);
    }
    part.finish()
}

fn ends(part: &Part) -> Vec<u32> {
    let ends = part.findings.iter().filter(|finding| finding.key == "part-incomplete");
    ends.map(|finding| finding.place.expect("a place").line).collect()
}

#[test]
fn as_many_moves_as_allowed_are_cut_and_one_more_is_not() {
    // Four moves; the last, in line 6, cuts off the axis.
    let text = "O1\nT0101\nG97 S500 M3\nG0 X52. Z-1.\nG1 X50. F0.1\nX46.\nG0 X52.\nM30\n";
    let at = |moves| limited(text, PartLimits { moves, ..PartLimits::default() });
    let whole = at(4);
    assert_eq!(ends(&whole), []);
    let short = at(3);
    assert_eq!(ends(&short), [7]);
    assert_eq!(short.section.volume_mm3(), whole.section.volume_mm3());
    let shorter = at(2);
    assert_eq!(ends(&shorter), [6]);
    assert_eq!(shorter.section.area_mm2(), 25.0 * 60.0);
}

#[test]
fn a_section_may_have_as_many_slabs_as_allowed_and_not_one_more() {
    // As many grooves as make the look at the section fall behind the last of them.
    let grooves = COMMANDS_PER_LOOK / 3;
    let text = format!(
        "O1\nT0101\nG97 S500 M3\nG0 X52. Z-1.\n#1=0\nWHILE[#1LT{grooves}]DO1\nG0 Z[-1.-#1*0.1]\nG1 X48. F0.1\n\
         X50.2\n#1=#1+1\nEND1\nG4 X1.\nG4 X1.\nG4 X1.\nG4 X1.\nG4 X1.\nG4 X1.\nM30\n"
    );
    let slabs = limited(&text, PartLimits::default()).section.slab_count();
    assert!(slabs > 2 * grooves as usize, "{slabs}");
    let at = |slabs| ends(&limited(&text, PartLimits { slabs, ..PartLimits::default() })).len();
    assert_eq!((at(slabs), at(slabs - 1)), (0, 1));
}
