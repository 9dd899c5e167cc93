//! Laws for any input: no panic, no hang, bounded output, places inside the text.

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

const CODES: [&str; 34] = [
    "G0", "G1", "G2", "G3", "G4", "G20", "G21", "G28", "G32", "G40", "G50", "G54", "G55", "G70", "G71",
    "G72", "G73", "G74", "G75", "G76", "G90", "G92", "G94", "G96", "G97", "G98", "G99", "M3", "M98", "M99",
    "M30", "M1", "G18", "G99",
];

const WORDS: [&str; 20] =
    ["X", "Z", "U", "W", "R", "F", "S", "T", "P", "Q", "I", "K", "N", "C", ",R", "L", "D", ",A", ",C", "A"];

const NUMBERS: [&str; 24] = [
    "0",
    "1",
    "2",
    "3",
    "10",
    "20",
    "-1",
    "-10.",
    "0.",
    "0.001",
    "5.",
    "50.",
    "-50.",
    "100000",
    "99999999",
    "-99999.999",
    "999999999",
    "0.0001",
    "1.5",
    "30.",
    "60",
    "020060",
    "101",
    "0",
];

/// A program of words that exist, in an order that nobody would write.
fn soup(dice: &mut Dice) -> String {
    let mut text = String::from("O1\n");
    for _ in 0..dice.roll() % 30 {
        if dice.roll().is_multiple_of(3) {
            text.push_str(&format!("N{} ", dice.roll() % 5));
        }
        if !dice.roll().is_multiple_of(3) {
            text.push_str(dice.pick::<&str>(&CODES));
        }
        for _ in 0..dice.roll() % 5 {
            text.push_str(dice.pick::<&str>(&WORDS));
            text.push_str(dice.pick::<&str>(&NUMBERS));
        }
        text.push('\n');
    }
    text
}

fn check(text: &[u8], control: &str) {
    let lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).count() as u32;
    let run = run(text, &Conditions::on(control));
    for diagnostic in run.warnings.iter().chain(&run.alarm) {
        assert_ne!(diagnostic.key, "internal-error", "{:?}", String::from_utf8_lossy(text));
        if let Some(place) = diagnostic.place {
            assert!(place.line <= lines + 1 && place.end_column >= place.column, "{place:?}");
        }
    }
    // Every message has its words.
    run.diagnostics();
}

#[test]
fn soup_of_words_ends_with_a_diagnostic_or_the_end() {
    let mut dice = Dice::new(0x5eed_0003);
    for round in 0..3_000 {
        let text = soup(&mut dice);
        check(text.as_bytes(), CONTROLS[round % CONTROLS.len()]);
    }
}

#[test]
fn mutated_programs_end_too() {
    let good = "O1\n(SHAFT)\nN1 G99 M3 S500 T0101\nG0 X46. Z0.5\nG71 U2. R0.5\nG71 P5 Q9 U0.3 W0.1 F0.3\nN5 G1 X15.\n\
                Z-15. F0.1\nX30. Z-30. R3.\nG2 X36. Z-45. R15.\nN9 G1 X46.\nG70 P5 Q9\nG76 P020060 Q100 R0.05\n\
                G76 X17.4 Z-20. P1300 Q400 F2.\nG75 R0.5\nG75 X40. Z-50. P2000 Q3000\nG92 X20. Z-10. F1.5\nX19.\n\
                G28 U0 W0\nM30\n";
    let mut dice = Dice::new(0x5eed_0004);
    for round in 0..3_000 {
        let mut text = good.as_bytes().to_vec();
        for _ in 0..1 + dice.roll() % 4 {
            let at = (dice.roll() % text.len().max(1) as u64) as usize;
            if text.is_empty() {
                break;
            }
            match dice.roll() % 4 {
                0 => text[at] = dice.roll() as u8,
                1 => drop(text.remove(at)),
                2 => text.insert(at, b"0123456789.-GXZ#[(;%\n"[(dice.roll() % 21) as usize]),
                _ => text.truncate(at.max(1)),
            }
        }
        check(&text, CONTROLS[round % CONTROLS.len()]);
    }
}

#[test]
fn loops_without_end_end() {
    for text in [
        "O1\nM98 P1\nM30\n",
        "O1\nM98 P99990002\nM30\nO2\nM98 P99990003\nM99\nO3\nM98 P99990004\nM99\nO4\nM99\n",
        "O1\nN1 G0 X1.\nM99 P1\n",
        "O1\nM99\n",
        "O1\nN1 GOTO 1\nM30\n",
        "O1\nWHILE[1EQ1]DO1\nEND1\nM30\n",
        "O1\nDO1\nDO2\n#1=#1+1\nEND2\nEND1\nM30\n",
        "O1\nG65 P1\nM30\n",
        "O1\n#1=5\nN5 GOTO#1\nM30\n",
    ] {
        let run = run(text.as_bytes(), &Conditions::on("fanuc-0i-tf"));
        let said = run.alarm.map(|alarm| alarm.key).or(run.warnings.first().map(|warning| warning.key));
        assert!(
            matches!(
                said,
                Some(
                    "calls-too-deep"
                        | "block-limit-reached"
                        | "loop-without-motion"
                        | "main-program-repeats"
                        | "macro-calls-too-deep"
                )
            ),
            "{text}: {said:?}"
        );
    }
}

#[test]
fn lines_at_and_beyond_the_limit() {
    let limit = turnwright_interpreter::LINE_BYTES_MAX;
    let fits = format!("O1\n({})\nM30\n", "x".repeat(limit - 2));
    assert!(run(fits.as_bytes(), &Conditions::on("fanuc-0i-tf")).alarm.is_none());
    for length in [limit + 1, 10 * limit] {
        let text = format!("O1\nG0 X1.\n({}\nM30\n", "x".repeat(length));
        let alarm = run(text.as_bytes(), &Conditions::on("fanuc-0i-tf")).alarm.expect("too long");
        assert_eq!((alarm.key, alarm.place.map(|place| place.line)), ("line-too-long", Some(3)));
    }
}
