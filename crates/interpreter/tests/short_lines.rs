//! Short lines and the long way: a line of a path, read straight from the text or kept in a loop, does what the same
//! line does as a block of words. Text that comes byte by byte never shows the end of a line ahead, and a block that a
//! switch might skip is looked at each time, so nothing goes short there.

mod support;

use support::{Conditions, run};
use turnwright_dice::Dice;

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
        words.push(format!("G{}", dice.pick(&codes)));
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
        line.push_str(dice.pick::<&str>(&["", " ", " ", " "]));
        line.push_str(word);
    }
    line.push_str(dice.pick::<&str>(&["", "", "", ";", " ", "; ", "(C)", " M8"]));
    line.push_str(dice.pick::<&str>(&["\n", "\n", "\r\n", "\r"]));
    line
}

#[test]
fn short_lines_do_what_blocks_do() {
    let mut dice = Dice::new(0x7a11_0c4e_0d1c_e5ed);
    for round in 0..3_000 {
        let control = CONTROLS[round % CONTROLS.len()];
        let head = dice.pick(&["", "G98\n", "G98 F100.\n", "M3 S500\nG99 F.2\n", "G96 S120 M3\n"]);
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
        assert_eq!(short.commands, long.commands, "{control}\n{program}");
        assert_eq!(short.diagnostics(), long.diagnostics(), "{control}\n{program}");
    }
}

/// A value in a loop whose counter is `#1`: typed, computed, empty now and then, or none at all.
fn computed(dice: &mut Dice) -> String {
    match dice.below(16) {
        0 => number(dice),
        1..=4 | 14 | 15 => format!("{}.{:03}", dice.below(60), dice.below(1_000)),
        5 => "#1".to_string(),
        6 => "-#1".to_string(),
        7 => "#2".to_string(),
        8 => format!("[#1*.{:03}]", dice.below(1_000)),
        9 => format!("[#1*{}]", number(dice)),
        10 => "[10.+SIN[#1*7.]]".to_string(),
        11 => "[50.-SQRT[#1]/3.]".to_string(),
        12 => "[ROUND[#1/3.]]".to_string(),
        _ => "#4".to_string(),
    }
}

/// The body of a loop: lines of a path and statements, `lead` before each of the lines.
fn body(dice: &mut Dice, lead: &str) -> String {
    let mut body = String::new();
    for _ in 0..1 + dice.below(5) {
        if dice.below(4) == 0 {
            let statement = ["#2=#1*.1", "#4=#0", "#4=#1+1.", "IF[#1 LT 3]THEN #2=5.", "#3=SIN[#1]"];
            body.push_str(&format!("{}\n", dice.pick(&statement)));
            continue;
        }
        let mut words = Vec::new();
        if dice.below(5) == 0 {
            words.push(format!("N{}", dice.below(9_000)));
        }
        if dice.below(2) == 0 {
            words.push(format!("G{}", dice.pick(&["0", "1", "01", "1", "0", "1", "2", "4"])));
        }
        for (usual, rare, sides) in [("X", "U", 4), ("Z", "W", 4), ("R", "K", 90), ("F", "F", 15)] {
            if dice.below(sides) < 3 {
                let letter = if dice.below(4) == 0 { rare } else { usual };
                words.push(format!("{letter}{}", computed(dice)));
            }
        }
        if words.is_empty() {
            continue;
        }
        body.push_str(&format!("{lead}{}\n", words.join(" ")));
    }
    body
}

#[test]
fn short_lines_of_loops_do_what_blocks_do() {
    let seed = 0x100b_5a11_de5c_0de5;
    let (mut dice, mut moves) = (Dice::new(seed), 0);
    for round in 0..2_000 {
        let control = CONTROLS[round % CONTROLS.len()];
        let head = dice.pick(&["", "G98\n", "G98 F100.\n", "M3 S500\nG99 F.2\n", "G98 F80.\n"]);
        let rounds = 1 + dice.below(20);
        let before = dice.clone();
        let mut program = |lead: &str| {
            dice = before.clone();
            let body = body(&mut dice, lead);
            if dice.below(3) == 0 {
                // The same as a subprogram that is called again and again.
                let body = body.replace("#1", "#101");
                format!("O1\n{head}#101=0\nG0 X50. Z2.\nM98 P2 L{rounds}\nM30\nO2\n#101=#101+1\n{body}M99\n")
            } else {
                format!("O1\n{head}#1=0\nG0 X50. Z2.\nWHILE[#1 LT {rounds}]DO1\n#1=#1+1\n{body}END1\nM30\n")
            }
        };
        let (short_text, long_text) = (program(" "), program("/"));
        let mut conditions = Conditions::on(control);
        if control == "fanuc-0i-tf" && dice.below(3) != 0 {
            let (number, value) =
                [("3401#0", "1"), ("1006#3", "0"), ("1013#1", "1"), ("3410", "0.5")][dice.below(4) as usize];
            conditions = conditions.with(number, value);
        }
        if dice.below(5) == 0 {
            conditions.blocks_max = 5 + dice.below(100);
        }
        let (short, long) = (run(short_text.as_bytes(), &conditions), run(long_text.as_bytes(), &conditions));
        assert_eq!(short.commands, long.commands, "{control}\n{short_text}");
        assert_eq!(short.diagnostics(), long.diagnostics(), "{control}\n{short_text}");
        moves += short.commands.len();
    }
    assert!(moves > 10_000, "only {moves} commands");
}

#[test]
fn a_loop_of_short_lines_that_goes_nowhere_ends() {
    let program = b"O1\nG98 F100. M3 S500\n#1=0\nG0 X50. Z2.\nWHILE[#1 GE 0]DO1\n#1=#1+1\nG1 X[FIX[9/#1]] Z2.\nEND1\nM30\n";
    for control in ["fanuc-0i-tf", "gsk-988ta"] {
        let run = run(program, &Conditions::on(control));
        assert_eq!(run.alarm.map(|alarm| alarm.key), Some("loop-without-motion"), "{control}");
    }
}

#[test]
fn a_text_that_ends_behind_short_lines_is_told_of_at_the_last() {
    for (last, end) in [("N7 Z3. X40.5", "\n"), (" X40.5 ", "\r\n"), ("X40.5;", "\n")] {
        let program = format!("O1\nG98 F100. M3 S500\nG0 X50. Z2.\nG1 X48.\nX44.25 Z1.\n{last}{end}");
        let run = run(program.as_bytes(), &Conditions::on("fanuc-0i-tf"));
        let alarm = run.alarm.expect("there is no M30");
        assert_eq!(alarm.key, "end-of-record-without-end", "{last}");
        let place = alarm.place.expect("it has a place");
        let word = last.trim().trim_end_matches(';');
        assert_eq!(place.line, 6, "{last}");
        assert_eq!(place.column as usize, 1 + last.find(word).expect("is in it"), "{last}");
    }
}
