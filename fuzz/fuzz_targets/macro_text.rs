//! Any text as a macro statement and as an expression: a tree, or a fault whose place lies in the line.
#![no_main]

use libfuzzer_sys::fuzz_target;
use turnwright_syntax::{parse_expression, parse_statement};

fuzz_target!(|line: &[u8]| {
    let all = 0..line.len() as u32;
    let faults = [parse_expression(line, all.clone()).err(), parse_statement(line, all.clone()).err()];
    for fault in faults.into_iter().flatten() {
        assert!(fault.place.start <= fault.place.end && fault.place.start <= all.end, "{fault:?}");
    }
});
