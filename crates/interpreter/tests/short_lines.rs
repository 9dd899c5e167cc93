//! Short lines and the long way: a line of a path, read straight from the text, does what the same line does as a
//! block of words. Text that comes byte by byte never shows the end of a line ahead, so nothing goes short there.

mod support;

use support::{Conditions, run};

/// xorshift64.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    fn one_of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.below(choices.len() as u64) as usize]
    }
}

const CONTROLS: [&str; 8] = [
    "fanuc-0i-mate-tb",
    "fanuc-0i-tc",
    "fanuc-0i-td",
    "fanuc-0i-tf",
    "gsk-980tdc",
    "gsk-980tdi",
    "gsk-988ta",
    "gsk-988tb",
];

/// A number as people type it, and now and then as nobody should.
fn number(dice: &mut Dice) -> String {
    let sign = if dice.below(3) == 0 { "-" } else { "" };
    let end = [10, 60, 1_000][dice.below(3) as usize];
    let whole = dice.below(end);
    match dice.below(12) {
        0 => format!("{sign}{whole}"),
        1 => format!("{sign}{whole}."),
        2 => format!("{sign}.{}", dice.below(1_000)),
        3 => format!("{sign}{whole}.{:06}", dice.below(1_000_000)),
        4 => format!("{sign}{}", dice.below(1_000_000_000_000)),
        5 => format!("{sign}0{whole}.0{}", dice.below(100)),
        _ => format!("{sign}{whole}.{:03}", dice.below(1_000)),
    }
}

/// A line of a path, mostly one that a control takes.
fn line(dice: &mut Dice) -> String {
    let mut words = Vec::new();
    if dice.below(3) == 0 {
        words.push(format!("N{}", dice.below(20_000)));
    }
    if dice.below(2) == 0 {
        let codes = ["0", "00", "1", "01", "1", "2", "03", "3", "1.", "98", "99", "21", "4"];
        words.push(format!("G{}", dice.one_of(&codes)));
    }
    for (usual, rare, sides) in
        [("X", "U", 5), ("Z", "W", 5), ("R", "I", 40), ("K", "F", 12), ("F", "X", 30), ("K", "Z", 20)]
    {
        if dice.below(sides) < 3 {
            let letter = if dice.below(4) == 0 { rare } else { usual };
            words.push(format!("{letter}{}", number(dice)));
        }
    }
    if dice.below(8) == 0 {
        words.reverse();
    }
    let mut line = String::new();
    for word in &words {
        line.push_str(dice.one_of(&["", " ", " ", " "]));
        line.push_str(word);
    }
    line.push_str(dice.one_of(&["", "", "", ";", " ", "; ", "(C)", " M8"]));
    line.push_str(dice.one_of(&["\n", "\n", "\r\n", "\r"]));
    line
}

#[test]
fn short_lines_do_what_blocks_do() {
    let mut dice = Dice(0x7a11_0c4e_0d1c_e5ed);
    for round in 0..3_000 {
        let control = CONTROLS[round % CONTROLS.len()];
        let head = dice.one_of(&["", "G98\n", "G98 F100.\n", "M3 S500\nG99 F.2\n", "G96 S120 M3\n"]);
        let mut program = format!("O1\n{head}G0 X50. Z2.\n");
        for _ in 0..dice.below(12) {
            program.push_str(&line(&mut dice));
        }
        program.push_str("M30\n");
        let mut conditions = Conditions::on(control);
        if control == "fanuc-0i-tf" && dice.below(3) != 0 {
            // Calculator numbers, X as a radius, the finer increment, rounds of an arc that must fit.
            let (number, value) =
                [("3401#0", "1"), ("1006#3", "0"), ("1013#1", "1"), ("3410", "0.5")][dice.below(4) as usize];
            conditions = conditions.with(number, value);
        }
        let short = run(program.as_bytes(), &conditions);
        let long = run(program.as_bytes(), &Conditions { bytes_at_once: 1, ..conditions });
        assert_eq!(short.listing(), long.listing(), "{control}\n{program}");
        assert_eq!(short.diagnostics(), long.diagnostics(), "{control}\n{program}");
    }
}
