//! A table of times for scripts and spreadsheets (CSV): one line for each block, in order of execution.
//!
//! Seconds have nine decimals, which is all there is: the columns add up exactly to `seconds`, and the lines to the
//! time of the program. A block that runs again at once, without another between, is one line.

use std::io::Write;
use std::time::Duration;

use turnwright_motion::{BlockTime, Kind};

/// Writes the names of the columns.
pub fn write_times_head(out: &mut Vec<u8>) {
    out.extend_from_slice(b"start_s,seconds");
    for kind in Kind::ALL {
        out.push(b',');
        out.extend(kind.word().bytes().map(|byte| if byte == b'-' { b'_' } else { byte }));
        out.extend_from_slice(b"_s");
    }
    out.extend_from_slice(b",cutting_mm,rapid_mm,operation,tool,cycle,program,source,line,n\n");
}

/// Writes the line of a block.
pub fn write_times_row(out: &mut Vec<u8>, block: &BlockTime) {
    let times = &block.times;
    write_seconds(out, block.start);
    out.push(b',');
    write_seconds(out, times.total());
    for kind in Kind::ALL {
        out.push(b',');
        write_seconds(out, times.time(kind));
    }
    let cutting_mm = times.length_mm(Kind::Cutting) + times.length_mm(Kind::Threading);
    let origin = &block.origin;
    let or_nothing = |number: Option<u32>| number.map_or(String::new(), |number| number.to_string());
    // Writing to memory does not fail.
    let _ = writeln!(
        out,
        ",{cutting_mm:.6},{:.6},{},{},{},{},{},{},{}",
        times.length_mm(Kind::Rapid),
        block.operation,
        or_nothing(block.tool),
        origin.cycle.map_or(String::new(), |cycle| cycle.label.to_string()),
        or_nothing(origin.program),
        origin.source,
        origin.line,
        or_nothing(origin.sequence),
    );
}

fn write_seconds(out: &mut Vec<u8>, time: Duration) {
    let _ = write!(out, "{}.{:09}", time.as_secs(), time.subsec_nanos());
}
