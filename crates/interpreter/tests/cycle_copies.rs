//! A cycle written in another way is the same cycle: shifted, mirrored, in inches, with increments, in one block.
//!
//! Random, but seeded. Lengths are multiples of 0.127 mm, which is 0.005 inch, so that both are exact.

mod support;

use support::{Conditions, run};
use turnwright_canon::Action;
use turnwright_dice::Dice;

const UNIT_NM: i64 = 127_000;

/// How a cycle is written.
#[derive(Clone, Copy, Default)]
struct Style {
    is_inch: bool,
    is_incremental: bool,
    is_one_block: bool,
    is_mirrored: bool,
    /// Along X (radius) and Z.
    shift: (i64, i64),
}

impl Style {
    /// A length with a point.
    fn length(self, units: i64) -> String {
        let (count, decimals) = if self.is_inch { (units * 50, 4) } else { (units * 127, 3) };
        let scale = 10i64.pow(decimals);
        let sign = if count < 0 { "-" } else { "" };
        format!("{sign}{}.{:0width$}", count.abs() / scale, count.abs() % scale, width = decimals as usize)
    }

    /// A length in least increments.
    fn count(self, units: i64) -> i64 {
        if self.is_inch { units * 50 } else { units * 127 }
    }

    fn mirror(self) -> i64 {
        if self.is_mirrored { -1 } else { 1 }
    }

    /// X and Z of a place, a radius and a length; as increments where the style has them.
    fn place(self, (x, z): (i64, i64), from: (i64, i64)) -> String {
        let mirror = self.mirror();
        if self.is_incremental {
            let (u, w) = (2 * mirror * (x - from.0), z - from.1);
            return format!("U{} W{}", self.length(u), self.length(w));
        }
        let (x, z) = (2 * mirror * (x + self.shift.0), z + self.shift.1);
        format!("X{} Z{}", self.length(x), self.length(z))
    }

    fn program(self, start: (i64, i64), cycle: &str) -> String {
        let units = if self.is_inch { "G20" } else { "G21" };
        let absolute = Self { is_incremental: false, ..self };
        format!(
            "{units} G99 S500 M03\nG00 {}\nF{}\n{cycle}\nM30\n",
            absolute.place(start, start),
            self.length(4)
        )
    }

    /// What a move of the plain program is in this one.
    fn carried(self, (x, z): (i64, i64)) -> (i64, i64) {
        (self.mirror() * (x + self.shift.0 * UNIT_NM), z + self.shift.1 * UNIT_NM)
    }
}

/// Kind and end of the moves behind the positioning, nanometres.
fn moves(text: &str, conditions: &Conditions) -> Vec<(&'static str, (i64, i64))> {
    let run = run(text.as_bytes(), conditions);
    assert!(run.alarm.is_none(), "{:?}\n{text}", run.alarm);
    run.commands
        .iter()
        .filter_map(|command| {
            let kind = match command.action {
                Action::Rapid { .. } => "rapid",
                Action::Feed { .. } => "feed",
                _ => "thread",
            };
            let to = command.action.end_point()?;
            Some((kind, (to.x.0.nm(), to.z.nm())))
        })
        .skip(1)
        .collect()
}

fn styles(dice: &mut Dice) -> [Style; 5] {
    let plain = Style::default();
    [
        Style { shift: (dice.whole(-20, 80), dice.whole(-300, 300)), ..plain },
        Style { is_mirrored: true, ..plain },
        Style { is_inch: true, ..plain },
        Style { is_incremental: true, ..plain },
        Style { is_one_block: true, ..plain },
    ]
}

/// Writes one cycle in all styles; computed points may differ by `tolerance_nm` where the increment is another.
fn assert_copies(
    dice: &mut Dice,
    conditions: &Conditions,
    one_block: Option<&Conditions>,
    tolerance_nm: i64,
    start: (i64, i64),
    cycle: impl Fn(Style) -> String,
) {
    let plain = Style::default();
    let expected = moves(&plain.program(start, &cycle(plain)), conditions);
    assert!(!expected.is_empty());
    for style in styles(dice) {
        let conditions = match (style.is_one_block, one_block) {
            (true, None) => continue,
            (true, Some(conditions)) => conditions,
            (false, _) => conditions,
        };
        let text = style.program(start, &cycle(style));
        let copy = moves(&text, conditions);
        assert_eq!(copy.len(), expected.len(), "{text}");
        for ((kind, to), (copied_kind, copied)) in expected.iter().zip(&copy) {
            let to = style.carried(*to);
            let off = (to.0 - copied.0).abs().max((to.1 - copied.1).abs());
            let tolerance = if style.is_inch { tolerance_nm } else { 0 };
            assert!(kind == copied_kind && off <= tolerance, "{to:?} {copied:?}\n{text}");
        }
    }
}

#[test]
fn grooves() {
    let mut dice = Dice::new(4_711);
    for _ in 0..300 {
        let is_face = dice.percent(50);
        let start = (dice.whole(100, 300), dice.whole(-200, 50));
        let sign = |dice: &mut Dice| if dice.percent(50) { 1 } else { -1 };
        let (x_way, z_way) = (sign(&mut dice) * dice.whole(8, 80), sign(&mut dice) * dice.whole(8, 80));
        let end = (start.0 + x_way, start.1 + z_way);
        let (cross, lengthwise) = (dice.whole(2, 40), dice.whole(2, 40));
        let (back, relief) = (dice.whole(0, 3), if dice.percent(30) { dice.whole(1, 3) } else { 0 });
        let code = if is_face { "G74" } else { "G75" };
        let conditions = Conditions::on("fanuc-0i-tf");
        let back_mm = Style::default().length(back);
        let one_block = conditions.clone().with("0001#1", "1").with("5139", &back_mm);
        assert_copies(&mut dice, &conditions, Some(&one_block), 0, start, |style| {
            let place = style.place(end, start);
            // The sign of a relief across X is that of the groove: nothing to mirror.
            if style.is_one_block {
                let (i, k, d) = (style.length(cross), style.length(lengthwise), style.count(relief));
                return format!("{code} {place} I{i} K{k} D{d}");
            }
            let (e, r) = (style.length(back), style.length(relief));
            let (p, q) = (style.count(cross), style.count(lengthwise));
            format!("{code} R{e}\n{code} {place} P{p} Q{q} R{r}")
        });
    }
}

#[test]
fn threads() {
    let mut dice = Dice::new(1_234_567);
    for _ in 0..200 {
        let is_inside = dice.percent(40);
        let start = (dice.whole(100, 300), dice.whole(30, 60));
        let out = dice.whole(20, 30);
        let end = (start.0 + if is_inside { out } else { -out }, dice.whole(-200, -40));
        let (height, first, least) = (dice.whole(6, 12), dice.whole(2, 4), dice.whole(0, 2));
        let (allowance, taper) = (dice.whole(0, 1), dice.whole(-3, 3));
        let (run_out, angle) = (dice.whole(0, 15), [0, 29, 60][dice.whole(0, 2) as usize]);
        let conditions = Conditions::on("fanuc-0i-tf");
        let plain = Style::default();
        let one_block = conditions
            .clone()
            .with("0001#1", "1")
            .with("5130", &run_out.to_string())
            .with("5140", &plain.length(least))
            .with("5141", &plain.length(allowance))
            .with("5142", "2");
        // An increment of an inch is 2.54 thousandths of a millimetre; X has half of it as a radius.
        assert_copies(&mut dice, &conditions, Some(&one_block), 2_600, start, |style| {
            let place = style.place(end, start);
            let (i, lead) = (style.length(style.mirror() * taper), style.length(12));
            if style.is_one_block {
                let (k, d) = (style.length(height), style.count(first));
                return format!("G76 {place} I{i} K{k} D{d} A{angle} F{lead}");
            }
            let (q, r) = (style.count(least), style.length(allowance));
            let (k, d) = (style.count(height), style.count(first));
            format!("G76 P02{run_out:02}{angle:02} Q{q} R{r}\nG76 {place} R{i} P{k} Q{d} F{lead}")
        });
    }
}

#[test]
fn holes() {
    let mut dice = Dice::new(99_991);
    for _ in 0..300 {
        let is_face = dice.percent(50);
        let start = (dice.whole(100, 300), dice.whole(-200, 50));
        let (r, depth) = (dice.whole(0, 20), dice.whole(10, 120));
        let across = dice.whole(-60, 60);
        let (peck, repeats) = (dice.whole(2, 60), dice.whole(1, 3));
        let conditions = Conditions::on("fanuc-0i-tf")
            .with("5101#2", if dice.percent(50) { "1" } else { "0" })
            .with("5114", "0.254")
            .with("5115", "0.127");
        let code = ["G83", "G85", "G84"][dice.whole(0, 2) as usize];
        let code = match (is_face, code) {
            (true, code) => code,
            (false, "G83") => "G87",
            (false, "G84") => "G88",
            (false, _) => "G89",
        };
        let pecks = matches!(code, "G83" | "G87");
        assert_copies(&mut dice, &conditions, None, 0, start, |style| {
            // The hole leads towards −Z, or towards the spindle axis: increments count the bottom from the R point.
            let (place, bottom, sign) = if is_face {
                ((start.0 + across, start.1 - r - depth), (start.0 + across, start.1 - depth), 1)
            } else {
                ((start.0 - r - depth, start.1 + across), (start.0 - depth, start.1 + across), style.mirror())
            };
            let place = style.place(if style.is_incremental { bottom } else { place }, start);
            let (r, q) = (style.length(-sign * r), style.count(peck));
            let q = if pecks { format!("Q{q}") } else { String::new() };
            // Repeats at absolute places drill one hole again and again; with increments they go on.
            let k = if style.is_incremental || repeats == 1 { String::new() } else { format!("K{repeats}") };
            if style.is_incremental {
                let again = vec![format!("{code} {place} R{r} {q}")];
                let zero = if is_face { "U0" } else { "W0" };
                let mut blocks = again;
                blocks.extend((1..repeats).map(|_| zero.to_string()));
                return blocks.join("\n");
            }
            format!("{code} {place} R{r} {q} {k}")
        });
    }
}
