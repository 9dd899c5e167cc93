//! Laws for programs that nobody would write: every word of the language in any order, and good programs with
//! bytes, lines and numbers changed.
//!
//! A run ends; it gives the same again; it does not matter in what pieces the text is read; every command is in
//! range; every place that is named lies in the text; blocks that are kept act as blocks that are read.
//! `TURNWRIGHT_ROUNDS` (programs a test) and `TURNWRIGHT_SEED` make the runs longer and other ones.
#![allow(clippy::disallowed_methods, reason = "tests read files and the environment")]

mod support;

use std::path::Path;
use std::{env, fs};

use support::{Conditions, Run, run};
use turnwright_canon::Action;
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

/// Blocks by themselves; `$` is any value, `@` a small count.
const MOVES: &[&str] = &[
    "G0X$Z$",
    "G1X$Z$F$",
    "X$",
    "Z$",
    "U$W$",
    "G1X$R$",
    "G1Z$C$",
    "G1X$,R$",
    "Z$,C$",
    "G2X$Z$R$",
    "G3X$Z$I$K$",
    "G1X$A$",
    "A$,R$",
    "X$Z$A$,C$",
    ",A$",
    "G4P$",
    "G4X$",
    "G28U$W$",
    "G30P@U0",
    "G31Z$F$",
    "G31P@X$",
    "G32Z$F$",
    "G32X$Z$F$Q$",
    "G34Z$F$K$",
    "G90X$Z$R$",
    "G92X$Z$F$",
    "G94X$Z$",
    "G50X$Z$",
    "G50S$",
    "G50U$",
    "G96S$",
    "G97S$",
    "G98F$",
    "G99F$",
    "G20",
    "G21",
    "G40",
    "G54",
    "G57",
    "G54.1P@",
    "G52X$Z$",
    "G53X$Z$",
    "G92.1X0Z0",
    "G50.3X0",
    "G10L2P@X$Z$",
    "G10L20P@X$",
    "G10P@X$Z$R$Q@",
    "G10P@U$W$",
    "G10P1000@X$",
    "G10L50\nN1320P$\nG11",
    "G10L52\nN1321.X P$\nN3401R@\nG11",
    "G10L3\nP@L$\nT@\nG11",
    "G10L11P@X$",
    "G12.1",
    "G13.1",
    "G7.1C$",
    "G7.1C0",
    "G68.1X$Z$R$",
    "G69.1",
    "G50.2",
    "G51.2P@Q@",
    "G51.2X$Z$",
    "G68",
    "G69",
    "G5Z$X$I$K$",
    "G5.1Q1",
    "G8P1",
    "G6.2X$Z$A$B$Q$",
    "G7.2X$Z$P$Q$",
    "G83Z$Q$F$",
    "G84Z$F$",
    "G85X$P@",
    "G80",
    "G22X$Z$I$K$",
    "G23",
    "G17",
    "G18",
    "G19",
    "G61",
    "G64",
    "G63",
    "G25",
    "G26",
    "G27X$",
    "G33Z$F$",
    "G36X$",
    "M3S$",
    "M4",
    "M5",
    "M8",
    "M0",
    "M1",
    "M@",
    "T@0@",
    "T$",
    "C$H$",
    "G1C$F$",
    "Y$",
    "G74R$\nG74X$Z$P$Q$",
    "G75R$\nG75X$Z$P$Q$",
    "G76P$Q$R$\nG76X$Z$R$P$Q$F$",
    "#$=$",
    "#1@=$",
    "#50@=[$+$]",
    "#[#[#1]]=$",
    "#1@=#[#1+@]",
    "#3006=@(STOP)",
    "#3003=@",
    "#300@=$",
    "#52@1=$",
    "#200@=$",
    "#250@=$",
    "#1@=#500@",
    "#1@=#41@@",
    "#1@=#301@",
    "IF[$EQ$]THEN#1@=$",
    "IF[[$LT$]AND[$GE$]]THEN#3=$",
    "DPRNT[X#1@[53]]",
    "SETVN50@[A,B]",
    "/G0X$",
    "/@Z$",
    "G0X$/@Z$",
    "(NOTE)",
    "#1@=#5021;#2=$",
    "G1X$Z$;Z$",
];

/// Blocks that send execution elsewhere.
const FLOW: &[&str] = &[
    "N@",
    "N@G0X$",
    "N@G1Z$",
    "GOTO@",
    "GOTO$",
    "GOTO#1",
    "IF[$EQ$]GOTO@",
    "IF[#1LT$]GOTO@",
    "IF[#1@NE#0]GOTO@",
    "WHILE[#1LT@]DO1",
    "WHILE[#2LE$]DO2",
    "DO@",
    "END1",
    "END2",
    "END@",
    "#1=#1+1",
    "#2=#2+1",
    "M98P000@",
    "M98P@000@",
    "M98P@L@",
    "M98P$",
    "M97P@",
    "M96P@",
    "M97",
    "M198P@",
    "M99",
    "M99P@",
    "G65P@A$B$X$",
    "G65P@L@I$J$K$I$",
    "G66P@Z$",
    "G66.1P@X$",
    "G67",
    "O@",
    "O000@",
    "%",
    "M30",
    "M2",
    "G71U$R$\nG71P@Q@U$W$F$",
    "G72W$R$\nG72P@Q@U$W$",
    "G73U$W$R@\nG73P@Q@U$W$",
    "G70P@Q@",
    "G71U2.R1.\nG71P1Q2U$W$F.2\nN1G0X$\nG1Z$\nX$Z$\nN2X$\nG70P1Q2",
];

const VALUES: &[&str] = &[
    "0",
    "1",
    "2",
    "3",
    "7",
    "10",
    "-1",
    "-10.",
    "0.",
    "0.001",
    "5.",
    "50.",
    "-50.",
    "30.",
    "1.5",
    "100000",
    "99999999",
    "-99999.999",
    "999999999",
    "0.0001",
    "60",
    "020060",
    "#1",
    "#2",
    "#101",
    "-#1",
    "#0",
    "#[#[#1]]",
    "[#1+1]",
    "[1/0]",
    "[#1*#1]",
    "SQRT[#1]",
    "[SQRT[-1]]",
    "[ASIN[2]]",
    "[99999999*99999999]",
    "[2MOD0]",
    "[EXP[99]]",
    "[EXP[999]]",
    "[TAN[90]]",
    "ROUND[#101]",
    "[FIX[#1/3]]",
    "[ATAN[#1]/[#2]]",
    "[LN[0]]",
    "[BCD[#1]]",
    "[#1XOR7]",
    "[[[[[[1]]]]]]",
    "#5021",
    "#4001",
    "#3901",
    "[#1GT0]",
    "",
];

/// Chance from a seed, or from others with `TURNWRIGHT_SEED`.
fn dice_of(seed: u64) -> Dice {
    let other: u64 = env::var("TURNWRIGHT_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    Dice::new(seed ^ (other << 8))
}

/// Fills in a block and appends it.
fn push_block(dice: &mut Dice, out: &mut String, forms: &[&str], values: &[&str]) {
    for letter in dice.pick::<&str>(forms).chars() {
        match letter {
            '$' => out.push_str(dice.pick::<&str>(values)),
            '@' => out.push(char::from(b'0' + dice.below(6) as u8)),
            letter => out.push(letter),
        }
    }
    out.push('\n');
}

fn rounds(of_a_test: usize) -> usize {
    env::var("TURNWRIGHT_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(of_a_test)
}

/// A program of words that exist, two of its blocks in three moves.
fn soup(dice: &mut Dice) -> String {
    let mut text = String::from("O1\nM3S500F0.2\n");
    // Half of the programs have plain values only and so come further.
    let values = if dice.below(2) == 0 { VALUES } else { &VALUES[..20] };
    for _ in 0..dice.below(25) {
        let forms = if dice.below(3) == 0 { FLOW } else { MOVES };
        push_block(dice, &mut text, forms, values);
    }
    if dice.below(2) == 0 {
        text.push_str("M30\nO0002\n#101=#1\nG1U-#2Z#26\nM99\nO3\n#1=#1+1\nM99\n");
    }
    text
}

/// The programs of the examples and of the chapters, with the control of each.
fn good_programs() -> Vec<(String, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let files = |folder: &str| {
        let mut files: Vec<_> = fs::read_dir(root.join(folder))
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|kind| kind == "nc" || kind == "md"))
            .collect();
        files.sort();
        files
    };
    let mut programs = Vec::new();
    for control in ["fanuc-0i-mate-tb", "gsk-980tdi", "gsk-988ta"] {
        for file in files(&format!("examples/{control}")) {
            programs.push((control.to_string(), fs::read(file).expect("an example")));
        }
    }
    for file in files("fixtures/interpreter") {
        let text = fs::read_to_string(file).expect("a chapter");
        for part in text.split("\n```nc").skip(1) {
            let (head, rest) = part.split_once('\n').expect("a line");
            let control = CONTROLS.iter().find(|name| head.split_whitespace().any(|word| word == **name));
            let body = rest.split("\n```").next().unwrap_or_default();
            programs.push((control.unwrap_or(&"fanuc-0i-tf").to_string(), body.as_bytes().to_vec()));
        }
    }
    programs
}

/// Changes bytes, numbers and lines.
fn mutate(dice: &mut Dice, text: &mut Vec<u8>, other: &[u8]) {
    for _ in 0..1 + dice.below(4) {
        let at = dice.index(text.len());
        if text.is_empty() {
            return;
        }
        match dice.below(8) {
            0 => text[at] = dice.roll() as u8,
            1 => drop(text.remove(at)),
            2 => text.insert(at, *dice.pick::<u8>(b"0123456789.-GXZRCA#[]()/,;%=\n\r")),
            3 => text.truncate(at.max(1)),
            4 => {
                let lines: Vec<&[u8]> = other.split(|byte| *byte == b'\n').collect();
                let line = *dice.pick(&lines);
                let from = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
                text.splice(from..from, [line, b"\n"].concat());
            }
            5 => {
                let from = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
                let end =
                    text[at..].iter().position(|byte| *byte == b'\n').map_or(text.len(), |end| at + end + 1);
                text.drain(from..end);
            }
            _ => {
                let is_number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-');
                if let Some(start) = text[at..].iter().position(is_number).map(|start| at + start) {
                    let length = text[start..].iter().take_while(|byte| is_number(byte)).count();
                    text.splice(start..start + length, dice.pick::<&str>(VALUES).bytes());
                }
            }
        }
    }
}

fn said(run: &Run) -> impl Iterator<Item = &turnwright_diagnostics::Diagnostic> {
    run.warnings.iter().chain(&run.alarm)
}

/// Everything that holds for any text.
fn check(dice: &mut Dice, control: &str, text: &[u8]) {
    let conditions = Conditions { blocks_max: 2_000, ..Conditions::on(control) };
    let shown = || format!("{control}\n{}", String::from_utf8_lossy(text));
    let first = run(text, &conditions);
    let lines: Vec<&[u8]> = lines(text);
    for diagnostic in said(&first) {
        assert_ne!(diagnostic.key, "internal-error", "{}", shown());
        let Some(place) = diagnostic.place else { continue };
        let line = lines.get(place.line as usize - 1).map_or(0, |line| line.len());
        assert!(
            place.line as usize <= lines.len() + 1
                && (1..=place.end_column).contains(&place.column)
                && place.end_column as usize <= line + 2,
            "{}: {place:?} is not in the text\n{}",
            diagnostic.key,
            shown()
        );
    }
    // Every message has its words.
    first.diagnostics();
    for command in &first.commands {
        let place = match &command.action {
            Action::Relocate { to, .. } => Some(*to),
            action => action.end_point(),
        };
        // Far beyond every number that can be written, and far within what a length can hold.
        let in_range = |nm: i64| nm.unsigned_abs() < 1_000_000_000_000_000_000;
        if let Some(place) = place {
            assert!(in_range(place.x.0.nm()) && in_range(place.z.nm()), "{command:?}\n{}", shown());
        }
        let debug = format!("{:?}", command.action);
        assert!(!debug.contains("NaN") && !debug.contains("inf"), "{debug}\n{}", shown());
    }
    first.listing();
    let pieces = Conditions { bytes_at_once: 1 + dice.index(7), ..conditions.clone() };
    for again in [run(text, &conditions), run(text, &pieces)] {
        assert_eq!(first.diagnostics(), again.diagnostics(), "{}", shown());
        assert!(
            first.commands == again.commands,
            "{}\nfirst\n{}again\n{}",
            shown(),
            first.listing(),
            again.listing()
        );
    }
}

/// Lines as the reader counts them: ended by LF, CR LF or CR.
fn lines(text: &[u8]) -> Vec<&[u8]> {
    let mut lines = Vec::new();
    let mut rest = text;
    while let Some(end) = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')) {
        lines.push(&rest[..end]);
        let next = end + 1 + usize::from(rest[end..].starts_with(b"\r\n"));
        rest = &rest[next..];
    }
    lines.push(rest);
    lines
}

#[test]
fn soup_of_the_whole_language() {
    let mut dice = dice_of(0x5eed_0011);
    for round in 0..rounds(400) {
        let text = soup(&mut dice);
        check(&mut dice, CONTROLS[round % CONTROLS.len()], text.as_bytes());
    }
}

#[test]
fn changed_programs_of_the_manual() {
    let mut dice = dice_of(0x5eed_0012);
    let programs = good_programs();
    for _ in 0..rounds(400) {
        let (control, text) = dice.pick(&programs);
        let mut text = text.clone();
        let other = &dice.pick(&programs).1;
        mutate(&mut dice, &mut text, other);
        check(&mut dice, control, &text);
    }
}

#[test]
fn a_loop_gives_what_its_blocks_give_written_out() {
    let mut dice = dice_of(0x5eed_0013);
    // Plain values and values that change from turn to turn.
    let values = ["1", "2.", "10.", "-5.", "0.5", "#149", "[#149*2.5]", "-#149", "30."];
    let mut compared = 0;
    for round in 0..rounds(400) {
        let mut body = String::new();
        for _ in 0..1 + dice.below(5) {
            push_block(&mut dice, &mut body, MOVES, &values);
        }
        let control = CONTROLS[round % CONTROLS.len()];
        let head = "O1\nM3S500F0.2\nG0X50.Z5.\n#149=0\n";
        let step = "#149=#149+1\n";
        let looped = format!("{head}WHILE[#149LT3]DO1\n{body}{step}END1\nM30\n");
        let called = format!("{head}M98P0002\nM98P0002\nM98P0002\nM30\nO2\n{body}{step}M99\n");
        let plain = format!("{head}{0}{0}{0}M30\n", format!("{body}{step}"));
        let conditions = Conditions { blocks_max: 2_000, ..Conditions::on(control) };
        let plain_run = run(plain.as_bytes(), &conditions);
        // A corner waits for the move behind it, which has to stand in the same program.
        let waits = body.contains([',', 'R', 'C', 'A']);
        // A call between two threads ends their chain: the second waits for the spindle again.
        let chains = ["G32", "G33", "G34", "G35", "G36"].iter().any(|code| body.contains(code));
        for text in [Some(looped), (!waits && !chains).then_some(called)].into_iter().flatten() {
            let other = run(text.as_bytes(), &conditions);
            let key = |run: &Run| run.alarm.as_ref().map(|alarm| alarm.key);
            assert_eq!(key(&plain_run), key(&other), "{control}\n{text}\n{plain}");
            let actions =
                |run: &Run| run.commands.iter().map(|command| command.action.clone()).collect::<Vec<_>>();
            assert!(
                actions(&plain_run) == actions(&other),
                "{control}\n{text}\nplain\n{}other\n{}",
                plain_run.listing(),
                other.listing()
            );
        }
        compared += usize::from(plain_run.alarm.is_none());
    }
    assert!(compared > rounds(400) / 10, "only {compared} programs ran to their end");
}
