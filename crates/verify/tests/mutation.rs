//! How much is caught: clean programs get the slips that people make, one at a time, and something must be said.
//!
//! What counts is everything that `check` tells: alarms and warnings of the control as well as the checks here. A slip
//! that changes nothing of what is told is a miss. `docs/mutation-score.md` has the measured score; this test writes it
//! with `TURNWRIGHT_BLESS=1` and fails when it is stale, below 95 % caught, or when a clean program is told of anything.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros, reason = "tests read files")]

mod support;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use support::{checked_keys, run};
use turnwright_control::Setup;

const CONTROL: &str = "fanuc-0i-tf";

/// Clean programs: each as a shop would write it, in sizes that differ.
fn clean_programs() -> Vec<(String, String)> {
    let mut programs = Vec::new();
    for size in 0..10 {
        let (bar, step) = (40 + 4 * size, 20 + 2 * size);
        let (shoulder, length) = (bar - 6, 30 + 3 * size);
        let head = format!("O{:04}\nG21 G40 G97 G99\nG28 U0. W0.\n", 100 + size);
        let end = "G00 X200. Z150. T0100\nM05\nM30\n";
        let rough = format!(
            "T0101\nG50 S2500\nG96 S180 M03\nG00 X{s}. Z2. M08\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.25\n\
             N10 G00 X{step}.\nG01 Z-20. F0.15\nX{shoulder}. Z-25.\nZ-{length}.\nN20 X{s}.\nG70 P10 Q20\nG00 X200. Z150. M09\n",
            s = bar + 2
        );
        programs.push((format!("shaft {bar}"), format!("{head}{rough}{end}")));
        let thread = format!(
            "T0303\nG97 S600 M03\nG00 X{x}. Z8.\nG92 X{a}.2 Z-16. F2.\nX{b}.8\nX{b}.4\nG00 X200. Z150.\n",
            x = step + 4,
            a = step - 1,
            b = step - 2
        );
        let end_of_thread = end.replace("T0100", "T0300");
        programs.push((format!("thread {step}"), format!("{head}{rough}{thread}{end_of_thread}")));
        let groove = format!(
            "T0202\nG97 S500 M03\nG00 X{x}. Z-15.\nG01 X{g}. F0.08\nG04 X0.5\nG00 X{x}.\nG00 X200. Z150.\n",
            x = bar + 4,
            g = bar - 10
        );
        let end_of_groove = end.replace("T0100", "T0200");
        programs.push((format!("groove {bar}"), format!("{head}{groove}{end_of_groove}")));
        let bore = format!(
            "T0505\nG97 S500 M03\nG00 X0. Z3.\nG01 Z-{deep}. F0.1\nG00 Z3.\nG00 X200. Z150.\n\
             T0606\nG50 S2000\nG96 S120 M03\nG00 X18. Z2.\nG71 U1. R0.3\nG71 P30 Q40 U-0.4 W0.1 F0.2\nN30 G00 X{w}.\nG01 Z-10. F0.1\n\
             X22.\nZ-{z}.\nN40 X18.\nG70 P30 Q40\nG00 Z2.\nG00 X200. Z150.\n",
            deep = length + 5,
            w = step + 8,
            z = length
        );
        let end_of_bore = end.replace("T0100", "T0600");
        programs.push((format!("bore {step}"), format!("{head}{bore}{end_of_bore}")));
        let ball = format!(
            "T0404\nG97 S900 M03\nG00 X{x}. Z5.\nG42 G00 X0. Z2.\nG01 Z0. F0.1\nG03 X{d}. Z-{r}. R{r}.\nG01 Z-{length}.\nX{x}.\n\
             G40 G00 X{y}. Z5.\nG00 X200. Z150.\n",
            x = bar + 2,
            y = bar + 6,
            d = step,
            r = step / 2
        );
        let end_of_ball = end.replace("T0100", "T0400");
        programs.push((format!("ball {step}"), format!("{head}{ball}{end_of_ball}")));
    }
    programs
}

/// The setup of all of them: noses for the tools that are compensated.
const SETUP: &str =
    "[offsets.1]\ntip = 3\ngeometry = { r = 0.8 }\n[offsets.4]\ntip = 3\ngeometry = { r = 0.4 }\n";

/// A slip, and how it changes a program; `None` where there is nothing to change.
type Slip = (&'static str, fn(&str) -> Option<String>);

fn replaced(text: &str, from: &str, to: &str) -> Option<String> {
    text.contains(from).then(|| text.replacen(from, to, 1))
}

/// The first line that holds `part`, changed.
fn line_with(text: &str, part: &str, change: impl Fn(&str) -> String) -> Option<String> {
    let line = text.lines().find(|line| line.contains(part))?;
    Some(text.replacen(line, &change(line), 1).replace("\n\n", "\n"))
}

/// The first word of this kind behind a mark loses its point; zero without a point is still zero.
fn without_point(text: &str, address: char, behind: &str) -> Option<String> {
    let from = text.find(behind)? + behind.len();
    let words = text[from..].match_indices(address).map(|(at, _)| from + at + 1);
    let number = |at: usize| text[at..].split(|c: char| c != '-' && c != '.' && !c.is_ascii_digit()).next();
    let mut points = words.filter_map(|at| {
        let number = number(at)?;
        let is_zero = number.parse::<f64>().ok()? == 0.0;
        (!is_zero && number.ends_with('.')).then_some(at + number.len() - 1)
    });
    let point = points.next()?;
    let mut changed = text.to_string();
    changed.remove(point);
    Some(changed)
}

const SLIPS: [Slip; 37] = [
    ("X loses its decimal point", |text| without_point(text, 'X', "G00 ")),
    ("Z loses its decimal point", |text| without_point(text, 'Z', "G01 ")),
    ("the point of F moves: F0.1 becomes F10.", |text| replaced(text, "F0.1\n", "F10.\n")),
    ("the point of F moves: F0.15 becomes F1.5", |text| replaced(text, "F0.15", "F1.5")),
    ("F as for a mill: F0.25 becomes F250.", |text| replaced(text, "F0.25", "F250.")),
    ("G99 becomes G98", |text| replaced(text, "G99", "G98")),
    ("G50 S deleted", |text| line_with(text, "G50 S", |_| String::new())),
    ("M03 deleted", |text| replaced(text, " M03", "")),
    ("S deleted where the spindle starts", |text| replaced(text, "G97 S500 M03", "G97 M03")),
    ("M03 becomes M04 for the drill", |text| {
        text.contains("T0505").then(|| text.replacen("S500 M03", "S500 M04", 1))
    }),
    ("offset of another tool", |text| line_with(text, "T0", |line| line.replace("T0", "T1"))),
    ("offset left out: T0101 becomes T0100", |text| replaced(text, "T0101", "T0100")),
    ("retract before the tool change deleted", |text| {
        let (before, after) = text.split_once("\nT0303")?;
        let kept = before.rsplit_once('\n')?.0;
        Some(format!("{kept}\nT0303{after}"))
    }),
    ("offset cancelled in the groove", |text| replaced(text, "G04 X0.5", "T0200")),
    ("G70 with another Q", |text| replaced(text, "G70 P10 Q20", "G70 P10 Q10")),
    ("first block of the figure lost", |text| replaced(text, "N10 ", "")),
    ("last block of the figure lost", |text| replaced(text, "N20 ", "")),
    ("sign of U of the allowance", |text| replaced(text, "U0.4", "U-0.4")),
    ("sign of U of the allowance in the bore", |text| replaced(text, "U-0.4", "U0.4")),
    ("sign of W of the allowance", |text| replaced(text, "W0.1", "W-0.1")),
    ("a minus lost in the figure", |text| replaced(text, "Z-25.", "Z25.")),
    ("a digit lost in the figure: Z-25. becomes Z-2.", |text| replaced(text, "Z-25.", "Z-2.")),
    ("a digit too many in the figure: Z-25. becomes Z-255.", |text| replaced(text, "Z-25.", "Z-255.")),
    ("depth of cut 0", |text| replaced(text, "G71 U2.", "G71 U0.")),
    ("thread under G96", |text| replaced(text, "G97 S600", "G96 S120")),
    ("lead-in of the thread shortened", |text| text.contains("G92").then(|| replaced(text, "Z8.", "Z2."))?),
    ("speed changed between passes of the thread", |text| {
        line_with(text, "F2.", |line| format!("{line}\nS400"))
    }),
    ("G00 left out behind the thread cycle", |text| {
        let (before, after) = text.split_once("G92")?;
        Some(format!("{before}G92{}", after.replacen("G00 X200.", "X200.", 1)))
    }),
    ("M00 in the groove", |text| replaced(text, "G04 X0.5", "M00")),
    ("radius of the arc too small", |text| {
        line_with(text, "G03", |line| {
            format!("{}1.", line.split('R').next().unwrap_or_default().to_string() + "R")
        })
    }),
    ("G40 deleted", |text| replaced(text, "G40 G00", "G00")),
    ("M30 deleted", |text| replaced(text, "M30\n", "")),
    ("M30 left in the middle", |text| replaced(text, "G00 X200.", "M30\nG00 X200.")),
    ("an old copy pasted behind", |text| Some(format!("{text}{text}"))),
    ("speed limit in the block of a position", |text| {
        line_with(text, "G50 S", |line| format!("{line} X200. Z150."))
    }),
    ("G28 through the work", |text| {
        text.contains("T0202").then(|| replaced(text, "G00 X200. Z150.", "G28 X20. Z-20."))?
    }),
    ("letter O for a zero", |text| replaced(text, "Z-20.", "Z-2O.")),
];

#[test]
fn slips_are_caught_and_clean_programs_are_left_alone() {
    let setup = Setup::parse(SETUP).expect("a setup");
    let programs = clean_programs();
    let (mut caught, mut tried, mut misses) = (0, 0, Vec::new());
    let mut noise = Vec::new();
    let mut scores: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    for (name, text) in &programs {
        let clean = checked_keys(&run(text, CONTROL, &setup), &setup);
        if !clean.is_empty() {
            noise.push(format!("{name}: {clean:?}"));
        }
        for (slip, change) in SLIPS {
            let Some(changed) = change(text).filter(|changed| changed != text) else { continue };
            let told = checked_keys(&run(&changed, CONTROL, &setup), &setup);
            let is_caught = told != clean && !told.is_empty();
            let score = scores.entry(slip).or_default();
            score.1 += 1;
            tried += 1;
            if is_caught {
                score.0 += 1;
                caught += 1;
            } else {
                misses.push(format!("{name}: {slip}"));
            }
        }
    }
    let mut page = format!(
        "# Slips that are caught\n\nMeasured by `crates/verify/tests/mutation.rs`: {} clean programs get the slips that people \
         make, one at a time.\nCaught is what `check` tells of, by the control's alarm, a warning or a check. The slips are a list made by hand, \
         not a sample\nof all: a wrong but sensible dimension is not among them, as nothing but a drawing shows it.\n\n\
         * {caught} of {tried} caught: {:.1} %\n* {} of {} clean programs told of anything\n\n| slip | programs | caught |\n|---|--:|--:|\n",
        programs.len(),
        100.0 * f64::from(caught) / f64::from(tried),
        noise.len(),
        programs.len(),
    );
    for (slip, _) in SLIPS {
        let (caught, tried) = scores.get(slip).copied().unwrap_or_default();
        assert!(tried > 0, "{slip}: no program has it");
        let _ = writeln!(page, "| {slip} | {tried} | {caught} |");
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/mutation-score.md");
    if std::env::var_os("TURNWRIGHT_BLESS").is_some() {
        std::fs::write(&file, &page).expect("writable");
    }
    assert!(noise.is_empty(), "clean programs are told of:\n{}", noise.join("\n"));
    let part = f64::from(caught) / f64::from(tried);
    assert!(part >= 0.95, "{caught} of {tried} caught; missed:\n{}", misses.join("\n"));
    assert_eq!(std::fs::read_to_string(&file).unwrap_or_default(), page, "docs/mutation-score.md is stale");
}
