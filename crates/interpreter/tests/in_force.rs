//! The codes and values in force, as programs and displays read them.

mod support;

use support::Memory;
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_interpreter::{GROUPS, Interpreter, Options, Step};

fn interpreter(control: &str, parameters: &[(&str, &str)]) -> Interpreter {
    let mut control = Control::load(control).expect("a control");
    for (number, value) in parameters {
        control.parameters.set(number, value).expect("a parameter");
    }
    Interpreter::new(control, &Setup::default(), SourceId(0), Options::default()).expect("a setup")
}

fn run(interpreter: &mut Interpreter, text: &str) {
    let mut environment = Memory { text: text.as_bytes(), skips: &[], setup: None, bytes_at_once: 0 };
    loop {
        match interpreter.step(&mut environment) {
            Step::End => return,
            Step::Alarm(alarm) => panic!("{alarm:?}"),
            Step::Emit(_) | Step::NeedSync(_) => {}
        }
    }
}

/// Codes as a display shows them: `G00 G97 G99`.
fn shown(interpreter: &Interpreter) -> String {
    let code = |code: u16| match (code / 10, code % 10) {
        (whole, 0) => format!("G{whole:02}"),
        (whole, tenth) => format!("G{whole:02}.{tenth}"),
    };
    interpreter.modal_codes().into_iter().flatten().map(code).collect::<Vec<_>>().join(" ")
}

#[test]
fn codes_at_power_on_follow_control_and_parameters() {
    assert_eq!(GROUPS, interpreter("fanuc-0i-tf", &[]).modal_codes().len());
    for (control, parameters, expected) in [
        ("fanuc-0i-mate-tb", &[][..], "G00 G97 G99 G21 G40 G25 G22 G80 G67 G54 G18"),
        ("fanuc-0i-tf", &[][..], "G00 G97 G69 G99 G21 G40 G25 G22 G80 G67 G54 G64 G18 G69.1 G50.2 G13.1"),
        (
            "fanuc-0i-td",
            &[("3402#0", "1"), ("3402#4", "1"), ("3402#7", "1"), ("0000#2", "1")],
            "G01 G97 G69 G98 G20 G40 G25 G23 G80 G67 G54 G64 G18 G69.1 G50.2 G13.1",
        ),
        (
            "fanuc-0i-tc",
            &[("3401#6", "1"), ("3402#3", "1")],
            "G00 G97 G91 G69 G95 G21 G40 G25 G22 G80 G98 G67 G54 G64 G18 G50.2 G13.1",
        ),
        ("gsk-980tdi", &[], "G00 G97 G98 G21 G40 G25 G23 G80 G67 G54 G64 G18 G50.2 G13.1"),
        ("gsk-988ta", &[("3402#4", "0")], "G00 G97 G99 G21 G40 G25 G22 G80 G67 G54 G18 G69.1 G13.1"),
    ] {
        assert_eq!(shown(&interpreter(control, parameters)), expected, "{control} {parameters:?}");
    }
}

#[test]
fn words_in_force_are_those_that_the_program_wrote() {
    let mut machine = interpreter("fanuc-0i-tf", &[("3402#6", "0")]);
    assert_eq!(machine.modal_word('S'), None);
    run(&mut machine, "O1234\nG20 T0303 S800 M03\nN50 G98 G01 X2. F12.5\nM08\nG02 U.2 W-.1 R.1\nN60 M30\n");
    let words = "FMNOST".chars().map(|letter| machine.modal_word(letter));
    let expected = [12.5, 30.0, 60.0, 1234.0, 800.0, 303.0];
    assert_eq!(words.collect::<Vec<_>>(), expected.map(Some));
    assert_eq!(machine.modal_word('X'), None);
    let codes = machine.modal_codes();
    assert_eq!((codes[0], codes[3], codes[5], codes[6]), (None, None, Some(980), Some(200)));
}
