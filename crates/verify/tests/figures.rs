//! What is cut below the figure of a finishing cycle, and what is left above it: told where it is so, and never where
//! the cut is meant.

mod support;

use turnwright_canon::{Action, Command, CycleLabel, CycleOrigin, Origin, Phase, Shape};
use turnwright_control::Setup;
use turnwright_diagnostics::Severity;
use turnwright_stock::machining::RapidRates;
use turnwright_units::{Feed, FeedPerMinute, Length, Position, Radius};
use turnwright_verify::Inference;
use turnwright_verify::figures::{FIGURE_EDGES_MAX, FIGURES_MAX, FigureSearch, Figures, Material};
use turnwright_verify::part::{FIGURE_REST_MM, Part, PartRun};

const CONTROL: &str = "fanuc-0i-tf";
const RATES: RapidRates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };
const STOCK: &str = "[stock]\ndiameter_mm = 44\nlength_mm = 90\nface_mm = 0\n";

/// The part, and the figures it was cut beside, as the command line does it.
fn part(text: &str, setup: &str) -> (Part, Figures) {
    let given = Setup::parse(setup).expect("a setup");
    let run = support::run(text, CONTROL, &given);
    assert_eq!(run.alarm, None, "{text}");
    let mut inference = Inference::new(run.start);
    run.commands.iter().for_each(|command| inference.add(command));
    let inferred = inference.finish(&given);
    let mut figures = inferred.figures.clone();
    if figures.is_compensated {
        let sharp = support::run_sharp(text, CONTROL, &given);
        let mut search = FigureSearch::new(sharp.start);
        sharp.commands.iter().for_each(|command| search.add(command));
        figures = search.finish();
    }
    let run_part =
        PartRun::new(&inferred.setup, &given, run.start, RATES).expect("a setup").expect("a stock");
    let mut run_part = run_part.with_figures(&figures.found);
    for command in &run.commands {
        run_part.add(command);
    }
    (run_part.finish(), figures)
}

/// Severity, line and depth of what is told of figures.
fn told(text: &str, setup: &str, key: &str) -> Vec<(Severity, u32, f64)> {
    let (part, figures) = part(text, setup);
    assert!(!figures.found.is_empty(), "no figure: {figures:?}");
    let depth = |line| {
        let marks = part.marks.iter().filter(|mark| mark.key == key && mark.line.1 == line);
        marks.map(|mark| (mark.depth_mm * 1e4).round() / 1e4).next().expect("a mark")
    };
    let findings = part.findings.iter().filter(|finding| finding.key == key);
    let line = |finding: &turnwright_diagnostics::Diagnostic| finding.place.expect("a place").line;
    findings.map(|finding| (finding.severity, line(finding), depth(line(finding)))).collect()
}

fn gouges(text: &str, setup: &str) -> Vec<(Severity, u32, f64)> {
    told(text, setup, "figure-gouged")
}

fn rests(text: &str, setup: &str) -> Vec<(Severity, u32, f64)> {
    told(text, setup, "figure-not-reached")
}

/// A shaft with a taper between two shoulders; line 4 roughs, line 12 finishes.
fn shaft(allowance: &str, first: &str, last: &str, more: &str) -> String {
    format!(
        "O1\nT0101 G97 S800 M03\nG00 X46. Z2.\nG71 U2. R0.5\nG71 P10 Q20 {allowance} F0.2\n\
         N10 {first} X20.\nG01 Z-20. F0.1\nX30. Z-25.\nZ-40.\nX40.\nZ-50.\nN20 {last} X46.\nG70 P10 Q20\n{more}\
         G40 G00 X100. Z100.\nM30\n"
    )
}

fn tool(words: &str) -> String {
    format!("{STOCK}[tools.1]\n{words}\n")
}

#[test]
fn a_sound_program_is_told_of_nothing() {
    for setup in [String::new(), STOCK.to_string(), tool("insert = \"CNMG120400\"\nnose_radius_mm = 0")] {
        let text = shaft("U0.4 W0.1", "G00", "", "");
        assert_eq!(gouges(&text, &setup), [], "{setup}");
        assert_eq!(rests(&text, &setup), [], "{setup}");
    }
}

#[test]
fn an_allowance_of_the_wrong_sign_cuts_below_the_figure() {
    // Half of U is left on the radius, here below zero.
    let below = shaft("U-0.4 W0.1", "G00", "", "");
    assert_eq!(gouges(&below, ""), [(Severity::Warning, 5, 0.2)]);
    let known = tool("insert = \"CNMG120404\"\nnose_radius_mm = 0");
    assert_eq!(gouges(&below, &known), [(Severity::Error, 5, 0.2)]);
    // At the limit nothing is told, a micrometre beyond it is.
    assert_eq!(gouges(&shaft("U-0.02 W0.", "G00", "", ""), ""), []);
    assert_eq!(gouges(&shaft("U-0.022 W0.", "G00", "", ""), ""), [(Severity::Warning, 5, 0.011)]);
}

#[test]
fn what_is_cut_below_the_figure_on_purpose_is_not_told() {
    let more = [
        // A relief groove, with the finishing tool and with a grooving tool.
        "G00 X32. Z-40.\nG01 X28. F0.05\nX32.\nG00 X46.\n",
        "G00 X100. Z50.\nT0202\nG00 X24. Z-20.\nG01 X17. F0.05\nG04 X0.5\nG01 X24.\nG00 X100.\n",
        // A thread on the finished diameter.
        "G00 X100. Z50.\nT0303\nG00 X24. Z5.\nG92 X19.2 Z-16. F1.5\nX18.4\nX18.2\nG00 X100.\n",
        // A drill, and cutting off.
        "G00 X100. Z50.\nT0505\nG00 X0. Z3.\nG01 Z-30. F0.1\nG00 Z3.\nG00 X100.\n",
        "G00 X100. Z50.\nT0404\nG00 X46. Z-48.\nG01 X-1. F0.05\nG00 X100.\n",
        // A cycle that grooves.
        "G00 X100. Z50.\nT0202\nG00 X32. Z-30.\nG75 R0.5\nG75 X26. Z-34. P1000 Q1500 F0.05\nG00 X100.\n",
    ];
    for more in more {
        let text = shaft("U0.4 W0.1", "G00", "", more);
        assert_eq!(gouges(&text, STOCK), [], "{more}");
    }
    // A bore drilled before, and a face turned between roughing and finishing.
    let text = shaft("U0.4 W0.1", "G00", "", "");
    let drilled = text.replace(
        "T0101 G97",
        "T0505 G97 S500 M03\nG00 X0. Z3.\nG01 Z-30. F0.1\nG00 Z3.\nG00 X100. Z50.\nT0101 G97",
    );
    assert_eq!(gouges(&drilled, STOCK), []);
    let faced = text.replace("G70", "G00 Z-0.5\nG01 X-1. F0.1\nG00 Z2.\nX46.\nG70");
    assert_eq!(gouges(&faced, STOCK), []);
}

/// A shaft with a neck that is turned down at 30 degrees.
fn neck(first: &str) -> String {
    format!(
        "O1\nT0101 G97 S800 M03\nG00 X46. Z2.\nG71 U1.5 R0.5\nG71 P10 Q20 U0.8 W0. F0.2\n\
         N10 {first} X30. Z2.\nG01 Z-10. F0.1\nX24. Z-15.196\nZ-25.\nX40. Z-33.\nN20 X46.\nG70 P10 Q20\n\
         G40 G00 X100. Z100.\nM30\n"
    )
}

#[test]
fn an_insert_that_cannot_go_down_the_neck_cuts_below_the_figure() {
    let offset = "[offsets.1]\ntip = 3\ngeometry = { r = 0.4 }\n";
    let compensated = neck("G42 G00");
    // 80 degrees at 95 go down five degrees, 35 degrees at 93 go down 52.
    let wide = format!("{}{offset}", tool("insert = \"CNMG120404\""));
    let told = gouges(&compensated, &wide);
    assert!(
        told.iter().any(|(severity, line, depth)| {
            *severity == Severity::Error && [8, 9].contains(line) && *depth > 1.0
        }),
        "{told:?}"
    );
    let slim = format!("{}{offset}", tool("insert = \"VNMG160404\"\nentering_angle_deg = 93"));
    assert_eq!(gouges(&compensated, &slim), []);
    // Nobody knows the insert: one that can do it is taken.
    assert_eq!(gouges(&compensated, &format!("{STOCK}{offset}")), []);
    // Without compensation the round nose cuts r (1 - cos + sin) into a wall that falls.
    let told = gouges(&neck("G00"), &slim);
    let depth = told.iter().map(|one| one.2).fold(0.0, f64::max);
    let angle = 30.0_f64.to_radians();
    assert!((depth - 0.4 * (1.0 - angle.cos() + angle.sin())).abs() < 2e-3, "{told:?}");
}

#[test]
fn a_taper_that_is_finished_without_compensation_keeps_material() {
    let setup = tool("insert = \"CNMG120408\"");
    // 45 degrees: (sqrt 2 - 1) of the nose. The inner corner in front of the shoulder is nobody's fault.
    let rest = (2.0_f64.sqrt() - 1.0) * 0.8;
    let told = rests(&shaft("U0.4 W0.1", "G00", "", ""), &setup);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0 == Severity::Warning && told[0].1 == 8 && (told[0].2 - rest).abs() < 1e-3, "{told:?}");
    let offset = "[offsets.1]\ntip = 3\ngeometry = { r = 0.8 }\n";
    let compensated = shaft("U0.4 W0.1", "G42 G00", "", "");
    assert_eq!(rests(&compensated, &format!("{setup}{offset}")), []);
    assert_eq!(gouges(&compensated, &format!("{setup}{offset}")), []);
    // Behind G40 in the last block the nose stands square to the end of the cylinder, a radius into the shoulder.
    let early = shaft("U0.4 W0.1", "G42 G00", "G40", "");
    let told = gouges(&early, &format!("{setup}{offset}"));
    assert!(told.len() == 1 && told[0].1 == 11 && (told[0].2 - 0.8).abs() < 2e-3, "{told:?}");
    // Nothing is said of a nose or a stock that nobody gave.
    assert_eq!(rests(&shaft("U0.4 W0.1", "G00", "", ""), &format!("{STOCK}{offset}")), []);
    let without_stock = setup.replace(STOCK, "");
    assert_eq!(rests(&shaft("U0.4 W0.1", "G00", "", ""), &without_stock), []);
    // At the limit, and beyond it.
    for (nose, is_told) in [(FIGURE_REST_MM * 0.998, false), (FIGURE_REST_MM * 1.002, true)] {
        let nose = nose / (2.0_f64.sqrt() - 1.0);
        let setup = tool(&format!("insert = \"CNMG120404\"\nnose_radius_mm = {nose}"));
        assert_eq!(!rests(&shaft("U0.4 W0.1", "G00", "", ""), &setup).is_empty(), is_told, "{nose}");
    }
}

#[test]
fn bores_and_faces_have_their_own_side() {
    let bore = |allowance: &str| {
        format!(
            "O1\nT0505 G97 S500 M03\nG00 X0. Z3.\nG01 Z-40. F0.1\nG00 Z3.\nG00 X100. Z50.\nT0606 G97 S800 M03\n\
             G00 X18. Z2.\nG71 U1. R0.3\nG71 P30 Q40 {allowance} W0.1 F0.2\nN30 G00 X28.\nG01 Z-10. F0.1\nX22.\nZ-32.\n\
             N40 X18.\nG70 P30 Q40\nG00 Z2.\nG00 X100. Z50.\nM30\n"
        )
    };
    assert_eq!(part(&bore("U-0.4"), STOCK).1.found[0].material, Material::Above);
    assert_eq!(gouges(&bore("U-0.4"), STOCK), []);
    assert_eq!(gouges(&bore("U0.4"), STOCK), [(Severity::Warning, 10, 0.2)]);
    let face = |allowance: &str| {
        format!(
            "O1\nT0101 G97 S800 M03\nG00 X48. Z1.\nG72 W1. R0.5\nG72 P10 Q20 U0. {allowance} F0.2\nN10 G00 Z-6.\n\
             G01 X30. F0.1\nX20. Z-3.\nN20 Z1.\nG70 P10 Q20\nG00 X100. Z100.\nM30\n"
        )
    };
    assert_eq!(gouges(&face("W0.1"), STOCK), []);
    assert_eq!(gouges(&face("W-0.1"), STOCK), [(Severity::Warning, 5, 0.1)]);
}

#[test]
fn a_figure_that_turns_back_is_left_alone() {
    let text = "O1\nT0101 G97 S800 M03\nG00 X46. Z2.\nG73 U5. W1. R3\nG73 P10 Q20 U0.4 W0.1 F0.2\nN10 G00 X20. Z1.\n\
                G01 Z-20. F0.1\nX30. Z-10.\nX20.\nZ-30.\nN20 X46.\nG70 P10 Q20\nG00 X100. Z100.\nM30\n";
    let (part, figures) = part(text, STOCK);
    assert_eq!((figures.found.len(), figures.unclear.as_slice()), (0, &[(0, 12)][..]));
    assert!(part.findings.iter().all(|finding| !finding.key.starts_with("figure")), "{:?}", part.findings);
}

/// The commands of a finishing cycle with so many edges, in the block of a line.
fn finishing(line: u32, edges: usize) -> Vec<Command> {
    let mut origin = Origin::line(line);
    let cycle = CycleOrigin { label: CycleLabel(700), pass: 1, phase: Phase::Finish };
    (origin.cycle, origin.figure_line) = (Some(cycle), Some(line - 1));
    let place = |index: usize| {
        let (x, z) = (10_000_000 + 1_000_000 * (index as i64 % 2), -1_000_000 * (index as i64 / 2));
        Position::new(Radius(Length::from_nm(x)), Length::from_nm(z))
    };
    let feed = |index| Action::Feed {
        to: place(index),
        shape: Shape::Line,
        feed: Feed::PerMinute(FeedPerMinute(Length::from_nm(1_000_000))),
        others: None,
    };
    (0..=edges).map(|index| Command::new(feed(index), origin)).collect()
}

fn searched(commands: &[Command]) -> Figures {
    let start = Position::new(Radius(Length::from_nm(30_000_000)), Length::from_nm(2_000_000));
    let mut search = FigureSearch::new(start);
    for command in commands {
        search.add(command);
    }
    search.finish()
}

#[test]
fn figures_have_limits() {
    // The first move only leads to the figure.
    assert_eq!(searched(&finishing(9, FIGURE_EDGES_MAX)).found[0].edges.len(), FIGURE_EDGES_MAX);
    let beyond = searched(&finishing(9, FIGURE_EDGES_MAX + 1));
    assert_eq!((beyond.found.len(), beyond.unclear.len()), (0, 1));
    let many =
        |count: u32| searched(&(0..count).flat_map(|one| finishing(10 + 2 * one, 3)).collect::<Vec<_>>());
    assert_eq!(many(FIGURES_MAX as u32).found.len(), FIGURES_MAX);
    assert_eq!(many(FIGURES_MAX as u32 + 1).found.len(), FIGURES_MAX);
}
