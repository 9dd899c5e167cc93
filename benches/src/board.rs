//! The table of goals: what is wanted, what was measured, what is missed.

#![cfg_attr(not(feature = "peers"), expect(dead_code, reason = "nothing is measured beside others"))]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Whether a figure is good when it is high or when it is low.
#[derive(Clone, Copy)]
enum Sense {
    AtLeast,
    AtMost,
}

use Sense::{AtLeast, AtMost};

/// A goal: its name, what is compared, in which unit, and the figure that is wanted.
struct Goal(&'static str, &'static str, &'static str, Sense, f64);

/// In the order of the list of goals. `x` is so many times as fast as the other side in the same run.
const GOALS: [Goal; 39] = [
    Goal("P1", "a million G1 blocks; rs274 without its printing", "x", AtLeast, 40.0),
    Goal("P3", "the same with N and F in each; rs274 without its printing", "x", AtLeast, 80.0),
    Goal("P4", "arcs by centre; rs274 without its printing", "x", AtLeast, 30.0),
    Goal("P4 R", "arcs by radius; rs274 without its printing", "x", AtLeast, 20.0),
    Goal("P5", "loop of three assignments; rs274", "x", AtLeast, 120.0),
    Goal("P5 Lua", "the same loop in Lua 5.4, variables in a table", "x", AtLeast, 1.0),
    Goal("P6", "loop with a G1 in each round; rs274 without its printing", "x", AtLeast, 100.0),
    Goal("P7 G71", "moves a second of the roughing cycle; rs274", "x", AtLeast, 12.0),
    Goal("P7 G76", "moves a second of the thread cycle; rs274", "x", AtLeast, 12.0),
    Goal("P8", "trace of a million moves; rs274 with its printing", "x", AtLeast, 40.0),
    Goal("P9", "reading words with their places; the crate gcode, its visitor", "x", AtLeast, 5.0),
    Goal("P10", "tree in memory, in sizes of the source", "times", AtMost, 3.0),
    Goal("S1", "five million blocks; rs274 without its printing", "x", AtLeast, 27.0),
    Goal("S1 memory", "the most memory for them", "MiB", AtMost, 8.0),
    Goal("S2", "time a block at five million beside one million", "times", AtMost, 1.05),
    Goal("S3", "a million computed jumps in 100,000 lines", "s", AtMost, 0.2),
    Goal("X1", "start-up, a program of M30; rs274", "x", AtLeast, 15.0),
    Goal("T1", "rest to rest with limited jerk, 5 to 200 mm; the crate rsruckig", "x", AtLeast, 3.0),
    Goal("T1 short", "the same, 0.05 to 0.5 mm; the crate rsruckig", "x", AtLeast, 3.0),
    Goal(
        "T2",
        "short lines back and forth at F200, with look-ahead; LinuxCNC's tpAddLine",
        "x",
        AtLeast,
        5.0,
    ),
    Goal("T2 fast", "the same at F3000; LinuxCNC's tpAddLine", "x", AtLeast, 5.0),
    Goal("T2 smooth", "short lines along a wave at F3000; LinuxCNC's tpAddLine", "x", AtLeast, 5.0),
    Goal(
        "T3",
        "a tick with all it takes, planning too, back and forth at F3000; LinuxCNC's tpRunCycle alone",
        "x",
        AtLeast,
        2.0,
    ),
    Goal("T3 smooth", "the same along a wave at F3000; LinuxCNC's tpRunCycle alone", "x", AtLeast, 2.0),
    Goal("T3 path", "a tick of the path alone", "ns", AtMost, 102.0),
    Goal("T3 p99.9", "the tick that one in a thousand exceeds", "ns", AtMost, 1000.0),
    Goal("T4", "ticks beyond a limit of acceleration or jerk", "ticks", AtMost, 0.0),
    Goal(
        "T5",
        "a job read, interpreted, cut and played at 1 ms, beside the machine's own time",
        "times",
        AtLeast,
        5000.0,
    ),
    Goal("R1", "cuts out of a section; the crate cavalier_contours, true arcs", "x", AtLeast, 50.0),
    Goal("R2 geo", "the same; the crate geo, chords", "x", AtLeast, 150.0),
    Goal("R2 i_overlay", "the same; the crate i_overlay, chords", "x", AtLeast, 150.0),
    Goal("R3", "rate at 100,000 cuts beside that at 1,000", "times", AtLeast, 0.8),
    Goal("R4", "area of the section, off from cavalier_contours", "relative", AtMost, 1e-9),
    Goal("pockets", "G71 type II, 1,000 elements, 100 pockets", "ms", AtMost, 50.0),
    Goal("T1 time", "machine time of ways from 0.05 to 200 mm beside the optimum", "times", AtMost, 1.001),
    Goal(
        "T6",
        "machine time back and forth at F3000, jerk as free as there; LinuxCNC's planner, G64 P0.01",
        "times",
        AtMost,
        0.9,
    ),
    Goal(
        "T6 jerk",
        "the same with the jerk of a machine, which LinuxCNC's does not limit",
        "times",
        AtMost,
        0.9,
    ),
    Goal(
        "T6 smooth",
        "machine time along a wave at F3000, where both can have the feed; LinuxCNC's planner",
        "times",
        AtMost,
        1.01,
    ),
    Goal("T6 smooth jerk", "the same with the jerk of a machine", "times", AtMost, 1.01),
];

/// What was measured.
#[derive(Default)]
pub struct Board {
    figures: BTreeMap<&'static str, f64>,
    /// Why goals were not measured.
    excuses: BTreeMap<&'static str, &'static str>,
}

impl Board {
    /// A figure for a goal.
    pub fn note(&mut self, goal: &'static str, figure: f64) {
        self.figures.insert(goal, figure);
    }

    /// Why a goal is not measured.
    pub fn excuse(&mut self, goal: &'static str, reason: &'static str) {
        self.excuses.insert(goal, reason);
    }

    /// The table.
    fn text(&self) -> String {
        let mut out = String::from(
            "| goal | what, and beside what | unit | wanted | measured | |\n|---|---|---|---|---|---|\n",
        );
        for Goal(name, what, unit, sense, wanted) in &GOALS {
            let (sign, is_met): (_, fn(f64, f64) -> bool) = match sense {
                AtLeast => ("≥", |figure, wanted| figure >= wanted),
                AtMost => ("≤", |figure, wanted| figure <= wanted),
            };
            let (measured, mark) = match (self.figures.get(name), self.excuses.get(name)) {
                (Some(figure), _) if is_met(*figure, *wanted) => (number(*figure), String::new()),
                (Some(figure), _) => (number(*figure), "**missed**".to_string()),
                (None, Some(reason)) => ("–".to_string(), format!("not measured: {reason}")),
                (None, None) => ("–".to_string(), "not measured".to_string()),
            };
            let _ = writeln!(
                out,
                "| {name} | {what} | {unit} | {sign} {} | {measured} | {mark} |",
                number(*wanted)
            );
        }
        out
    }

    /// Writes the table with date and machine.
    pub fn write(&self, path: &Path, blocks: u64) -> Result<(), String> {
        let said = |program: &str, arguments: &[&str]| {
            let output = Command::new(program).args(arguments).output().ok()?;
            Some(String::from_utf8_lossy(&output.stdout).trim().to_string())
        };
        let of_processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model =
            of_processor.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or("unknown");
        let count = of_processor.lines().filter(|line| line.starts_with("processor")).count();
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        let text = format!(
            "# Speed, measured beside others\n\n\
             Written by `cargo run --release -p turnwright-benches -- table`; every figure is of one run on one machine, both\n\
             sides in turn, medians of processor time. Only ratios mean anything on another machine.\n\n\
             * {}, {} blocks a program\n* {} × {}, load {}\n* {}\n\n{}",
            said("date", &["-u", "+%F"]).unwrap_or_default(),
            blocks,
            count,
            model.trim_start_matches([':', ' ', '\t']),
            load.split(' ').next().unwrap_or_default(),
            said("rustc", &["--version"]).unwrap_or_default(),
            self.text()
        );
        print!("{text}");
        std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
    }
}

/// Three figures or so.
fn number(figure: f64) -> String {
    match figure.abs() {
        0.0 => "0".to_string(),
        size if size < 1e-3 => format!("{figure:.1e}"),
        size if size < 10.0 => format!("{figure:.2}"),
        size if size < 100.0 => format!("{figure:.1}"),
        _ => format!("{figure:.0}"),
    }
}
