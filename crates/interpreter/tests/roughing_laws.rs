//! The same roughing written in other words makes the same passes: absolute or incremental, inch or metric, before or
//! behind its figure. Random figures with and without pockets, but seeded: every run sees the same.

mod support;

use support::{Conditions, Run, run};
use turnwright_canon::Command;
use turnwright_dice::Dice;

/// Lengths are whole hundredths of an inch, so that both systems can say them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writing {
    Metric,
    Inch,
    Incremental,
}

impl Writing {
    fn length(self, hundredths: i64) -> String {
        let sign = if hundredths < 0 { "-" } else { "" };
        let magnitude = hundredths.unsigned_abs();
        if self == Self::Inch {
            return format!("{sign}{}.{:02}", magnitude / 100, magnitude % 100);
        }
        let thousandths = magnitude * 254;
        format!("{sign}{}.{:03}", thousandths / 1_000, thousandths % 1_000)
    }

    /// X (diameter) and Z of an end point.
    fn place(self, from: (i64, i64), to: (i64, i64)) -> String {
        if self == Self::Incremental {
            format!("U{} W{}", self.length(to.0 - from.0), self.length(to.1 - from.1))
        } else {
            format!("X{} Z{}", self.length(to.0), self.length(to.1))
        }
    }
}

/// A shaft with or without grooves.
struct Figure {
    start: (i64, i64),
    bottom: i64,
    depth: i64,
    has_pockets: bool,
    /// Code, radius of an arc, end point.
    blocks: Vec<(u8, i64, (i64, i64))>,
}

impl Figure {
    fn new(dice: &mut Dice) -> Self {
        let has_pockets = dice.whole(0, 2) > 0;
        let bottom = 2 * dice.whole(30, 100);
        let (mut at, mut blocks) = ((bottom, 10), Vec::new());
        for _ in 0..dice.whole(2, 9) {
            let (size, length) = (dice.whole(1, 40), dice.whole(1, 60));
            let down = has_pockets && dice.whole(0, 2) == 0 && at.0 > 2 * size + 20;
            let x = if down { at.0 - 2 * size } else { at.0 + 2 * size };
            let block = match dice.whole(0, 5) {
                0 => (1, 0, (at.0, at.1 - length)),
                1 => (2, size, (x, at.1 - size)),
                2 => (3, size, (x, at.1 - size)),
                _ => (1, 0, (x, at.1 - length)),
            };
            at = block.2;
            blocks.push(block);
        }
        let highest = blocks.iter().map(|block| block.2.0).max().unwrap_or(bottom);
        let start = (highest.max(bottom) + 40, 10);
        blocks.push((1, 0, (start.0, at.1)));
        Self { start, bottom, depth: dice.whole(4, 40), has_pockets, blocks }
    }

    /// The cycle block, and the figure.
    fn text(&self, writing: Writing, cycle_first: bool) -> String {
        let unit = if writing == Writing::Inch { "G20" } else { "G21" };
        let length = |hundredths| writing.length(hundredths);
        let first = match (writing, self.has_pockets) {
            (Writing::Incremental, true) => format!("U{} W0", length(self.bottom - self.start.0)),
            (Writing::Incremental, false) => format!("U{}", length(self.bottom - self.start.0)),
            (_, true) => format!("X{} Z{}", length(self.bottom), length(10)),
            (_, false) => format!("X{}", length(self.bottom)),
        };
        let mut figure = format!("N10 G00 {first}\n");
        let mut from = (self.bottom, 10);
        for (index, (code, radius, to)) in self.blocks.iter().enumerate() {
            let head = if index + 1 == self.blocks.len() { "N20 " } else { "" };
            let arc = if *radius > 0 { format!(" R{}", length(*radius)) } else { String::new() };
            figure += &format!("{head}G0{code} {}{arc}\n", writing.place(from, *to));
            from = *to;
        }
        let start = format!("G00 X{} Z{}", length(self.start.0), length(self.start.1));
        let cycle = format!(
            "{start}\nG71 U{} R{}\nG71 P10 Q20 U{} W0 F{}\n",
            length(self.depth),
            length(4),
            length(2),
            length(1)
        );
        if cycle_first {
            format!("{unit} S800 M03\n{cycle}{figure}G70 P10 Q20\nM30\n")
        } else {
            format!("{unit} S800 M03\n{start}\nGOTO50\n{figure}N50 {cycle}G70 P10 Q20\nM30\n")
        }
    }
}

fn made(figure: &Figure, writing: Writing, cycle_first: bool) -> Run {
    let text = figure.text(writing, cycle_first);
    let run = run(text.as_bytes(), &Conditions::on("fanuc-0i-td"));
    assert!(run.alarm.is_none(), "{:?}\n{text}", run.alarm);
    run
}

/// Code, pass and end point of the moves of cycles.
fn moves(run: &Run) -> Vec<(String, f64, f64)> {
    let told = |command: &Command| {
        let (cycle, to) = (command.origin.cycle?, command.action.end_point()?);
        let kind = std::mem::discriminant(&command.action);
        Some((
            format!("{kind:?} {} {} {}", cycle.label, cycle.phase.word(), cycle.pass),
            to.x.to_diameter().0.to_mm(),
            to.z.to_mm(),
        ))
    };
    run.commands.iter().filter_map(told).collect()
}

#[test]
fn the_same_roughing_in_other_words_makes_the_same_passes() {
    let mut dice = Dice::new(0x5EED_0F71);
    let (mut with_pockets, mut count) = (0, 0);
    for _ in 0..700 {
        let figure = Figure::new(&mut dice);
        let metric = moves(&made(&figure, Writing::Metric, true));
        assert_eq!(metric, moves(&made(&figure, Writing::Incremental, true)));
        let behind = moves(&made(&figure, Writing::Metric, false));
        assert_eq!(metric, behind, "{}", figure.text(Writing::Metric, false));
        let inch = moves(&made(&figure, Writing::Inch, true));
        assert_eq!(metric.len(), inch.len(), "{}", figure.text(Writing::Metric, true));
        for (metric, inch) in metric.iter().zip(&inch) {
            assert_eq!(metric.0, inch.0);
            // A ten-thousandth of an inch is 2.54 thousandths of a millimetre.
            assert!(
                (metric.1 - inch.1).abs() < 0.004 && (metric.2 - inch.2).abs() < 0.004,
                "{metric:?} {inch:?}"
            );
        }
        with_pockets += i32::from(figure.has_pockets);
        count += metric.len();
    }
    assert!(with_pockets > 300 && count > 20_000, "{with_pockets} {count}");
}
