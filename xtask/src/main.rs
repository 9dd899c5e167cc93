//! `cargo xtask test` and `cargo xtask tidy`: see the library for what they do.

use std::process::ExitCode;

use xtask::{green, guard, root, tidy};

const HELP: &str = "\
cargo xtask test   every test there is: Rust, then the browser; ends with the sums
cargo xtask tidy   the rules of the house, also a test of its own
cargo xtask guard  instructions of small pieces of work, beside the baseline; --bless writes it

Environment of `test`:
  TURNWRIGHT_TEST_ARGS        arguments for `cargo test` instead of --workspace; `none` leaves it out
  TURNWRIGHT_REQUIRE_BROWSER  1: a missing browser is a failure, not a skip
  TURNWRIGHT_WITHOUT_RS274    1: leaves out what is compared with LinuxCNC's interpreter";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["test"] => green::run(&root()),
        ["guard"] => guard::run(&root(), false),
        ["guard", "--bless"] => guard::run(&root(), true),
        ["tidy"] => {
            let faults = tidy::faults(&root());
            for fault in &faults {
                eprintln!("{fault}");
            }
            println!("tidy: {} faults", faults.len());
            if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        [] | ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            ExitCode::SUCCESS
        }
        other => {
            eprintln!("no chore is called `{}`\n\n{HELP}", other.join(" "));
            ExitCode::from(2)
        }
    }
}
