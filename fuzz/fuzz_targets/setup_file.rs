//! Any text as a setup file: it is refused with a line of the file, or a program runs with it.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};

/// A program that asks for offsets, work zeros, the reference point and the axes' limits.
const PROGRAM: &[u8] = b"O1\nT0101\nG54\nM3S500F.2\nG0X50.Z5.\nG1Z-10.\n#1=#5021\nG28U0W0\nG55\nG0X1.\nM30\n";

struct Program;

impl Environment for Program {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = PROGRAM.get(offset as usize..).unwrap_or(&[]);
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

fuzz_target!(|text: &str| {
    static CONTROL: OnceLock<Control> = OnceLock::new();
    let mut control =
        CONTROL.get_or_init(|| Control::load("fanuc-0i-tf").expect("a control of ours")).clone();
    let setup = match Setup::parse(text) {
        Ok(setup) => setup,
        Err(fault) => {
            assert!(fault.line as usize <= text.matches('\n').count() + 1, "{fault:?}");
            return;
        }
    };
    for (address, value) in setup.parameter_words() {
        let _ = control.parameters.set(&address, &value);
    }
    let Ok(mut interpreter) = Interpreter::new(control, &setup, SourceId(0), Options::default()) else { return };
    while !matches!(interpreter.step(&mut Program), Step::End | Step::Alarm(_)) {}
});
