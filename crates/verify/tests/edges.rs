//! Tools that cut where they have no edge, and ribs between plunges: what is told, what is not, and at the limit.

mod support;

use turnwright_control::Setup;
use turnwright_stock::machining::RapidRates;
use turnwright_verify::Inference;
use turnwright_verify::part::{Part, PartRun};

const RATES: RapidRates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };
const STOCK: &str = "[stock]\ndiameter_mm = 50\nlength_mm = 80\n";
const WIDE: &str = "[tools.1]\ninsert = \"CNMG120404\"\nholder = \"PCLNR2525M12\"\n";
const SLIM: &str = "[tools.1]\ninsert = \"DNMG150604\"\nholder = \"PDJNR2525M15\"\n";
const SLIMMER: &str = "[tools.1]\ninsert = \"VBMT160404\"\nholder = \"SVJBR2525M16\"\n";

fn part(text: &str, setup: &str) -> Part {
    let given = Setup::parse(setup).expect("a setup");
    let run = support::run(text, "fanuc-0i-tf", &given);
    assert_eq!(run.alarm, None);
    let mut inference = Inference::new(run.start);
    run.commands.iter().for_each(|command| inference.add(command));
    let setup = inference.finish(&given).setup;
    let mut part = PartRun::new(&setup, &given, run.start, RATES).expect("a setup").expect("a stock");
    for command in &run.commands {
        part.add(command);
    }
    part.finish()
}

/// A finding of these: its name, its line, its depth.
type Told = (&'static str, u32, f64);

const KEYS: [&str; 3] = ["insert-back-cuts", "feed-without-edge", "rib-left-standing"];

fn told(moves: &str, setup: &str) -> Vec<Told> {
    let part = part(&format!("O1\nT0101\nG97 S500 M03\n{moves}M30\n"), setup);
    let mut told: Vec<Told> = Vec::new();
    for mark in part.marks.iter().filter(|mark| KEYS.contains(&mark.key)) {
        let Some(finding) = part.findings.iter().find(|one| one.key == mark.key) else {
            panic!("{} has no finding", mark.key)
        };
        assert!(finding.arguments.iter().any(|(name, _)| *name == "depth"));
        told.push((mark.key, mark.line.1, (mark.depth_mm * 1e2).round() / 1e2));
    }
    told
}

/// A neck that begins at Z-15 and falls to a diameter of 38 within a length.
fn neck(length: f64) -> String {
    let end = -15.0 - length;
    format!("G00 X46. Z2.\nG01 Z-15. F0.2\nX38. Z{end:.3}\nZ-30.\nX52.\nG00 X60.\n")
}

#[test]
fn an_undercut_with_the_wrong_insert_is_told() {
    // Behind the nose 180 - 93 - 55 = 32 degrees are clear; 4 mm down in 5 are 38.7.
    let wrong = told(&neck(5.0), &format!("{STOCK}{SLIM}"));
    let [("insert-back-cuts", 6, depth)] = wrong[..] else { panic!("{wrong:?}") };
    // The wall of 4 / sin 32 leans off the way by 6.7 degrees.
    assert!((depth - 0.85).abs() < 0.1, "{depth}");
    // At the limit: 31.6 degrees and 33.7; and an insert that leaves 52.
    assert_eq!(told(&neck(6.5), &format!("{STOCK}{SLIM}")), []);
    assert_eq!(told(&neck(6.0), &format!("{STOCK}{SLIM}")).len(), 1);
    assert_eq!(told(&neck(5.0), &format!("{STOCK}{SLIMMER}")), []);
    assert_eq!(told(&neck(2.0), &format!("{STOCK}{SLIMMER}")).len(), 1);
}

#[test]
fn nothing_is_told_of_what_nobody_said() {
    // No stock; no holder, so that nobody knows how the insert stands; no tool at all.
    assert_eq!(told(&neck(5.0), SLIM), []);
    assert_eq!(told(&neck(5.0), &format!("{STOCK}[tools.1]\ninsert = \"DNMG150604\"\n")), []);
    assert_eq!(told(&neck(5.0), STOCK), []);
}

#[test]
fn an_arc_that_falls_away_is_followed_to_its_steepest() {
    // A ball of 20 behind its equator: with 52 degrees the neck of 14 is clear (44 degrees), with 32 it is not.
    let ball = "G00 X0. Z2.\nG01 Z0. F0.2\nG03 X14. Z-17.141 R10.\nG01 Z-25.\nX52.\nG00 X60.\n";
    let roughing = "G00 X24. Z2.\nG01 Z-30. F0.2\nX52.\nG00 Z2.\n";
    let moves = format!("{roughing}{ball}");
    let wrong = told(&moves, &format!("{STOCK}{SLIM}"));
    let gouges: Vec<u32> = wrong.iter().filter(|one| one.0 == "insert-back-cuts").map(|one| one.1).collect();
    assert_eq!(gouges, [10], "{wrong:?}");
    assert_eq!(told(&moves, &format!("{STOCK}{SLIMMER}")), []);
}

#[test]
fn straight_into_the_work_with_the_bottom_of_an_insert() {
    let plunge = "G00 X52. Z-20.\nG01 X40. F0.1\nX52.\nG00 X60.\n";
    let wrong = told(plunge, &format!("{STOCK}{WIDE}"));
    assert!(matches!(wrong[..], [("insert-back-cuts", 5, _)]), "{wrong:?}");
    // Facing is the same move in front of the work, and leaves its lean on the boss.
    let facing = "G00 X52. Z-2.\nG01 X20. F0.1\nU2. W2.\nG00 Z5.\n";
    assert_eq!(told(facing, &format!("{STOCK}{WIDE}")), []);
    // What the back edge left is taken away behind it.
    let turned = "G00 X52. Z-20.\nG01 X40. F0.1\nX52.\nG00 Z2.\nX40.\nG01 Z-24.\nX52.\nG00 X60.\n";
    assert_eq!(told(turned, &format!("{STOCK}{WIDE}")), []);
}

#[test]
fn the_other_hand_and_the_bore_are_the_same_in_a_mirror() {
    // A left-hand tool feeds to the front: it falls off behind a collar.
    let left = SLIM.replace("PDJNR", "PDJNL");
    let mirrored = |length: f64| {
        format!("G00 X52. Z-40.\nG01 X46. F0.2\nZ-25.\nX38. Z{:.3}\nZ2.\nG00 X60.\n", -25.0 + length)
    };
    let wrong = told(&mirrored(5.0), &format!("{STOCK}{left}"));
    assert!(wrong.iter().any(|one| one.0 == "insert-back-cuts" && one.1 == 7), "{wrong:?}");
    let sound = told(&mirrored(6.5), &format!("{STOCK}{left}"));
    assert!(sound.iter().all(|one| one.0 != "insert-back-cuts" || one.1 != 7), "{sound:?}");
    // A recess in a bore of 30: the bar of 12 fits.
    let tube = "[stock]\ndiameter_mm = 60\nbore_mm = 28\nlength_mm = 80\n";
    let bar = "[tools.1]\ninsert = \"DCMT070204\"\nholder = \"S12K-SDUCR07\"\n";
    let recess = |length: f64| {
        format!("G00 X30. Z2.\nG01 Z-15. F0.1\nX33. Z{:.3}\nZ-25.\nX26.\nG00 Z5.\n", -15.0 - length)
    };
    let wrong = told(&recess(1.8), &format!("{tube}{bar}"));
    assert!(matches!(wrong[..], [("insert-back-cuts", 6, _)]), "{wrong:?}");
    assert_eq!(told(&recess(2.5), &format!("{tube}{bar}")), []);
}

#[test]
fn a_feed_in_the_direction_without_an_edge_is_told() {
    let to_the_right = "G00 X52. Z-30.\nG01 X44. F0.1\nZ2. F0.2\nG00 X60.\n";
    let wrong = told(to_the_right, &format!("{STOCK}{WIDE}"));
    assert_eq!(wrong, [("feed-without-edge", 6, 3.0)]);
    // 32 degrees are an edge; so is the nose for a thin finishing cut.
    assert_eq!(told(to_the_right, &format!("{STOCK}{SLIM}")), []);
    assert_eq!(told(&to_the_right.replace("X44.", "X48.4"), &format!("{STOCK}{WIDE}")), []);
    let drill = "[tools.1]\nkind = \"drilling\"\ndiameter_mm = 10\n";
    let sideways = "G00 X0. Z2.\nG01 Z-10. F0.1\nX4.\nX0.\nZ2.\n";
    assert!(matches!(told(sideways, &format!("{STOCK}{drill}"))[..], [("feed-without-edge", 6, _)]));
    assert_eq!(told(&sideways.replace("X4.\nX0.\n", ""), &format!("{STOCK}{drill}")), []);
}

const BLADE: &str = "[tools.1]\nkind = \"grooving\"\nwidth_mm = 3\n";

#[test]
fn ribs_between_plunges_are_told() {
    let grooves = |second: f64| {
        format!("G00 X54. Z-10.\nG01 X40. F0.1\nG00 X54.\nZ{second}\nG01 X40. F0.1\nG00 X54.\n")
    };
    let setup = format!("{STOCK}{BLADE}");
    assert_eq!(told(&grooves(-13.5), &setup), [("rib-left-standing", 8, 0.5)]);
    assert_eq!(told(&grooves(-12.99), &setup), []);
    // A millimetre or more of three is a land that somebody may want.
    assert_eq!(told(&grooves(-14.0), &setup), []);
    assert_eq!(told(&grooves(-20.0), &setup), []);
    // Widened at the bottom, nothing is left of it.
    let widened = grooves(-13.5).replacen("G00 X54.\nZ", "Z-13.5 F0.05\nG00 X54.\nZ", 1);
    assert_eq!(told(&widened, &setup), []);
    // In a cycle with pecks, in a bore, in the face.
    let cycle = "G00 X54. Z-10.\nG75 R0.3\nG75 X40. Z-17. P2000 Q3500 F0.08\nG00 X100.\n";
    let ribs = told(cycle, &setup);
    assert_eq!(ribs, [("rib-left-standing", 6, 0.5)], "{ribs:?}");
    let bore = "G00 X26. Z2.\nZ-10.\nG01 X34. F0.1\nG00 X26.\nZ-13.4\nG01 X34. F0.1\nG00 X26.\nZ5.\n";
    let tube = "[stock]\ndiameter_mm = 60\nbore_mm = 30\nlength_mm = 80\n";
    let inside = format!("{tube}{BLADE}side = \"inside\"\nshank_mm = 10\nreach_mm = 5\n");
    assert_eq!(told(bore, &inside), [("rib-left-standing", 9, 0.4)]);
    let face = "G00 X20. Z2.\nG01 Z-4. F0.1\nG00 Z2.\nX27.\nG01 Z-4. F0.1\nG00 Z2.\n";
    assert_eq!(told(face, &format!("{STOCK}{BLADE}side = \"face\"\n")), [("rib-left-standing", 8, 0.5)]);
    assert_eq!(told(cycle, BLADE), []);
}
