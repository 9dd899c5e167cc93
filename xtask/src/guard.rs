//! `cargo xtask guard`: how many instructions small pieces of work take, beside what they took.
//!
//! Times on a shared machine move by a fifth; instructions, counted by valgrind's callgrind, hardly at all. Each piece
//! runs twice, with as many blocks as [`PIECES`] says and with none; the difference, by the block, is compared with the baseline in
//! `benches/instructions.txt`. More than [`MARGIN`] above is a failure; with another compiler than the baseline's
//! [`MARGIN_OTHER_COMPILER`]. `--bless` writes the baseline.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// Blocks, moves or cuts of a piece of work; of the dearest ticks there are fewer.
const COUNT: u32 = 10_000;
const TICKS: u32 = 500;

/// So much more than the baseline is let pass.
const MARGIN: f64 = 0.05;

/// The same where the compiler is another one.
const MARGIN_OTHER_COMPILER: f64 = 0.20;

const PIECES: [(&str, u32); 8] = [
    ("lines", COUNT),
    ("arcs", COUNT),
    ("loop", COUNT),
    ("roughing", COUNT),
    ("trace", COUNT),
    ("stock", COUNT),
    ("planner", COUNT),
    ("overrides", TICKS),
];

const BASELINE: &str = "benches/instructions.txt";

/// Counts, compares and prints; or writes the baseline.
pub fn run(root: &Path, blesses: bool) -> ExitCode {
    match counted(root).and_then(|counts| if blesses { bless(root, &counts) } else { compare(root, &counts) })
    {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(fault) => {
            eprintln!("guard: {fault}");
            ExitCode::FAILURE
        }
    }
}

/// Instructions a block, by piece.
fn counted(root: &Path) -> Result<BTreeMap<&'static str, f64>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--profile", "guard", "--package", "turnwright-benches"])
        .arg("--no-default-features")
        .current_dir(root)
        .status();
    if !built.is_ok_and(|status| status.success()) {
        return Err("the benchmarks do not build".to_string());
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), Into::into);
    let program = target.join("guard").join("turnwright-benches");
    let mut counts = BTreeMap::new();
    for (piece, count) in PIECES {
        let (idle, busy) = (instructions(&program, piece, 0)?, instructions(&program, piece, count)?);
        counts.insert(piece, busy.saturating_sub(idle) as f64 / f64::from(count));
    }
    Ok(counts)
}

/// Instructions of a run.
fn instructions(program: &Path, piece: &str, count: u32) -> Result<u64, String> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["work", piece, &count.to_string()])
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("valgrind (Debian: valgrind): {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("{piece}: {said}"));
    }
    let collected = said.lines().find_map(|line| line.split_once("Collected : "));
    let number = collected.and_then(|(_, number)| number.trim().parse().ok());
    number.ok_or_else(|| format!("{piece}: valgrind counted nothing: {said}"))
}

fn compiler() -> String {
    let output = Command::new("rustc").arg("--version").output();
    output.map_or_else(|_| String::new(), |output| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

fn bless(root: &Path, counts: &BTreeMap<&'static str, f64>) -> Result<bool, String> {
    let mut text = format!(
        "# Instructions a block: `cargo xtask guard --bless` writes this file, `cargo xtask guard` compares with it.\n\
         compiler {}\n",
        compiler()
    );
    for (piece, count) in counts {
        let _ = writeln!(text, "{piece} {count:.0}");
    }
    print!("{text}");
    fs::write(root.join(BASELINE), text).map_err(|error| format!("{BASELINE}: {error}"))?;
    Ok(true)
}

fn compare(root: &Path, counts: &BTreeMap<&'static str, f64>) -> Result<bool, String> {
    let text = fs::read_to_string(root.join(BASELINE)).map_err(|error| format!("{BASELINE}: {error}"))?;
    let (known, of_compiler) = baseline(&text);
    let is_same = of_compiler == compiler();
    let margin = if is_same { MARGIN } else { MARGIN_OTHER_COMPILER };
    if !is_same {
        println!("another compiler than the baseline's ({of_compiler}): the margin is wider");
    }
    let mut is_good = true;
    println!("instructions a block, the baseline beside them; {:.0} % more is a failure", margin * 100.0);
    for (piece, count) in counts {
        let Some(before) = known.get(piece) else {
            println!("{piece:10} {count:8.0}  is not in the baseline");
            is_good = false;
            continue;
        };
        let change = verdict(*count, *before, margin);
        is_good &= change.is_good;
        println!("{piece:10} {count:8.0} {before:8.0}  {:+6.1} %  {}", change.percent, change.words);
    }
    Ok(is_good)
}

/// Counts by piece, and the compiler.
fn baseline(text: &str) -> (BTreeMap<&str, f64>, &str) {
    let words = text.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(' '));
    let counts = words.clone().filter_map(|(name, value)| Some((name, value.parse().ok()?)));
    let compiler = words.clone().find(|(name, _)| *name == "compiler").map_or("", |(_, value)| value);
    (counts.collect(), compiler)
}

struct Verdict {
    percent: f64,
    is_good: bool,
    words: &'static str,
}

fn verdict(count: f64, before: f64, margin: f64) -> Verdict {
    let change = count / before - 1.0;
    let (is_good, words) = if change > margin {
        (false, "slower: find out why, or bless it and say why in the commit")
    } else if change < -margin {
        (true, "faster: bless the new baseline")
    } else {
        (true, "")
    };
    Verdict { percent: change * 100.0, is_good, words }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_margin_lets_pass_what_it_says() {
        assert!(verdict(104.9, 100.0, MARGIN).is_good);
        assert!(!verdict(105.1, 100.0, MARGIN).is_good);
        assert!(verdict(50.0, 100.0, MARGIN).words.starts_with("faster"));
    }

    #[test]
    fn the_baseline_has_every_piece() {
        let text = fs::read_to_string(crate::root().join(BASELINE)).expect("a baseline");
        let (counts, compiler) = baseline(&text);
        assert!(compiler.starts_with("rustc "), "{compiler}");
        for (piece, _) in PIECES {
            assert!(counts.get(piece).is_some_and(|count| *count > 10.0), "{piece}");
        }
    }
}
