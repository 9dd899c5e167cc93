//! Any program, on the control that its first byte names: it ends, and reading it in small pieces changes nothing.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use turnwright_control::{Control, Setup, control_names};
use turnwright_diagnostics::SourceId;
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};

/// A text in memory that is given a few bytes at a time.
struct Pieces<'a> {
    text: &'a [u8],
    bytes_at_once: usize,
}

impl Environment for Pieces<'_> {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = self.text.get(offset as usize..).unwrap_or(&[]);
        let length = rest.len().min(buffer.len()).min(self.bytes_at_once);
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, switch: u8) -> bool {
        switch == 2
    }
}

/// Commands that are compared; a cycle of millions of moves is legal.
const COMMANDS_MAX: usize = 50_000;

fn told(control: &Control, text: &[u8], bytes_at_once: usize) -> Vec<String> {
    let options = Options { blocks_max: 2_000, idle_blocks_max: 2_000 };
    let interpreter = Interpreter::new(control.clone(), &Setup::default(), SourceId(0), options);
    let mut interpreter = interpreter.expect("an empty setup makes sense");
    let mut environment = Pieces { text, bytes_at_once };
    let mut told = Vec::new();
    while told.len() < COMMANDS_MAX {
        match interpreter.step(&mut environment) {
            Step::Emit(command) => told.push(format!("{command:?}")),
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => {
                assert_ne!(alarm.key, "internal-error");
                told.push(format!("{alarm:?}"));
                break;
            }
            Step::End => break,
        }
    }
    told
}

fuzz_target!(|bytes: &[u8]| {
    static CONTROLS: OnceLock<Vec<Control>> = OnceLock::new();
    let controls = CONTROLS.get_or_init(|| {
        control_names().into_iter().map(|name| Control::load(name).expect("a control of ours")).collect()
    });
    let Some((first, text)) = bytes.split_first() else { return };
    let control = &controls[usize::from(*first) % controls.len()];
    let pieces = 1 + usize::from(*first) / 37;
    assert_eq!(told(control, text, usize::MAX), told(control, text, pieces));
});
