//! Laws of reset, restart and the part counter.

mod support;

use support::Memory;
use turnwright_canon::Command;
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_interpreter::{Interpreter, Options, Step};

fn interpreter(control: &str, parameters: &[(&str, &str)], setup: &str) -> Interpreter {
    let mut control = Control::load(control).expect("a control");
    for (number, value) in parameters {
        control.parameters.set(number, value).expect("a parameter");
    }
    let setup = Setup::parse(setup).expect("a setup");
    Interpreter::new(control, &setup, SourceId(0), Options::default()).expect("a setup")
}

/// At most `steps_max` steps; the commands given, and whether the program came to its end.
fn go(interpreter: &mut Interpreter, text: &str, steps_max: usize) -> (Vec<Command>, bool) {
    let mut environment = Memory { text: text.as_bytes(), skips: &[], setup: None, bytes_at_once: 0 };
    let mut commands = Vec::new();
    for _ in 0..steps_max {
        match interpreter.step(&mut environment) {
            Step::Emit(command) => commands.push(command),
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => panic!("{alarm:?}"),
            Step::End => return (commands, true),
        }
    }
    (commands, false)
}

const PART: &str = "O1\nN1 G50 S2500\nT0101 G97 S500 M03\nG00 X46. Z0.5\nG71 U2. R0.5\nG71 P5 Q9 U0.3 W0.1 F0.3\nN5 G00 X15.\n\
                    G01 Z-15. F0.1\nX30. Z-30.\nN9 G01 X46.\nG96 S150\nG98 G70 P5 Q9\nM98 P2\nG90 X40. Z-5. F100.\nX38.\nM01\nM30\n\
                    O2\nG54 G01 U-2. F80. M08\nM99\n";

#[test]
fn reset_at_any_moment_starts_the_program_anew() {
    let mut fresh = interpreter("fanuc-0i-tf", &[], "");
    let (expected, ends) = go(&mut fresh, PART, usize::MAX);
    assert!(ends && expected.len() > 40, "{}", expected.len());
    let modes = fresh.modal_codes();
    for steps in 0..expected.len() + 2 {
        let mut machine = interpreter("fanuc-0i-tf", &[], "");
        go(&mut machine, PART, steps);
        machine.reset();
        assert_eq!(machine.modal_codes(), interpreter("fanuc-0i-tf", &[], "").modal_codes(), "{steps} steps");
        let (commands, ends) = go(&mut machine, PART, usize::MAX);
        assert!(ends);
        // Before the cycle there is no news where limit or place are right already.
        let behind_start = &expected[4..];
        let start = commands.len().saturating_sub(behind_start.len());
        assert_eq!(&commands[start..], behind_start, "{steps} steps");
        assert!(commands[..start].contains(&expected[2]), "the spindle is started again");
        assert_eq!(machine.modal_codes(), modes);
    }
}

#[test]
fn an_alarm_is_over_with_a_reset() {
    let mut machine = interpreter("fanuc-0i-tf", &[], "");
    let mut broken =
        Memory { text: b"O1\nG00 X20. Z2.\nG01 X Z1.\nM30\n", skips: &[], setup: None, bytes_at_once: 0 };
    while !matches!(machine.step(&mut broken), Step::Alarm(_)) {}
    assert_eq!(machine.step(&mut broken), Step::End);
    machine.reset();
    let (commands, ends) = go(&mut machine, "O1\nG00 X10. Z1.\nM30\n", usize::MAX);
    assert_eq!((commands.len(), ends), (2, true));
}

#[test]
fn the_first_work_system_comes_back_with_the_modes() {
    let setup = "[work]\nG55 = { x = 10.0, z = 100.0 }\n";
    let text = "G00 X50. Z5.\nG55\nM30\n";
    let listing = |parameters: &[(&str, &str)]| {
        let mut machine = interpreter("fanuc-0i-tf", parameters, setup);
        go(&mut machine, text, usize::MAX);
        machine.start_again();
        let mut out = Vec::new();
        for command in go(&mut machine, text, usize::MAX).0 {
            turnwright_canon::write_listing(&mut out, &command, 3);
            out.push(b'\n');
        }
        String::from_utf8(out).expect("text")
    };
    let back = "relocate d50 z5\nrelocate d40 z-95\nend\n";
    assert_eq!(listing(&[]), back);
    assert_eq!(listing(&[("3402#6", "0"), ("1201#7", "1")]), back);
    assert_eq!(listing(&[("3402#6", "0")]), "rapid d50 z5\nend\n");
}

#[test]
fn parts_are_counted_at_the_end_and_by_their_code() {
    for (parameters, expected) in [
        (&[][..], 2),
        (&[("6711", "40")], 42),
        (&[("6710", "77")], 6),
        (&[("6710", "77"), ("6700#0", "1")], 4),
        (&[("6700#0", "1")], 0),
    ] {
        let mut machine = interpreter("fanuc-0i-tf", parameters, "");
        let text = "M77\nG00 X20. Z2.\nM77\nM30\n";
        go(&mut machine, text, usize::MAX);
        machine.start_again();
        go(&mut machine, text, usize::MAX);
        assert_eq!(machine.parts().made, expected, "{parameters:?}");
    }
    let machine = interpreter("gsk-988ta", &[("6713", "250")], "");
    assert_eq!(machine.parts().wanted, 250);
}

#[test]
fn the_end_forgets_the_record_of_a_thread_unless_its_parameter_keeps_it() {
    let record = "[thread-repair]\nz = 0\nangle_deg = 10\n";
    let runs = |kept: &str, end: &str| {
        let parameters = [("174#4", "1"), ("174#5", "1"), ("1290", kept)];
        let mut machine = interpreter("gsk-980tdi", &parameters, record);
        let text = format!("S500 M03\nG00 X30 Z5\nG92 X20 Z-20 F2 P1\nG00 X50\n{end}\n");
        let (first, ends) = go(&mut machine, &text, usize::MAX);
        assert!(ends && first.len() > 5);
        machine.reset();
        let mut again = Memory { text: text.as_bytes(), skips: &[], setup: None, bytes_at_once: 0 };
        loop {
            match machine.step(&mut again) {
                Step::Alarm(alarm) => return alarm.key,
                Step::End => return "none",
                Step::Emit(_) | Step::NeedSync(_) => {}
            }
        }
    };
    assert_eq!(runs("0", "M30"), "thread-record-missing");
    assert_eq!(runs("0", "M99"), "thread-record-missing");
    assert_eq!(runs("0", "M02"), "none");
    assert_eq!(runs("1", "M30"), "none");
    assert_eq!(runs("1", "M99"), "none");
}
