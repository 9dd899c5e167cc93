//! Cycles: moves a second, and a figure with very many pockets.
//!
//! P7 runs G71 on a figure of 40 elements and 400 levels, and G76 with 100 passes, again and again, the peer its own G71 and G76.
//! Both make moves of their own, so moves a second are compared. The figure of 1,000 elements and 100 pockets is
//! timed alone: the goal is 50 ms, from the text to the last move.

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use crate::board::Board;
use crate::compare::{Cost, Peer, median, own};
use crate::interpret;

const ROUNDS: u32 = 3_000;

/// A program of both sides.
struct Pair {
    name: &'static str,
    nc: String,
    ngc: String,
}

/// Writes the programs into `folder`, runs them, prints.
pub fn run(folder: &Path, peer: Option<&Peer>, rounds: usize, board: &mut Board) -> Result<(), String> {
    for pair in [roughing(), threading()] {
        let (nc, ngc) = (folder.join(format!("{}.nc", pair.name)), folder.join(format!("{}.ngc", pair.name)));
        write(&nc, &pair.nc)?;
        write(&ngc, &pair.ngc)?;
        let (mut ours, mut theirs): (Vec<Cost>, Vec<Cost>) = Default::default();
        for _ in 0..rounds {
            ours.push(own("interpret", &nc)?);
            if let Some(peer) = peer {
                theirs.push(peer.run(&ngc, true)?);
            }
        }
        let mine = interpret(&nc)? as f64 / median(&ours).cpu_s;
        print!("P7 {:12} {:6.2} M moves/s", pair.name, mine / 1e6);
        if let Some(peer) = peer {
            let other = peer.moves(&ngc)? as f64 / median(&theirs).cpu_s;
            board.note(if pair.name == "G71" { "P7 G71" } else { "P7 G76" }, mine / other);
            print!("   rs274 {:6.2} M moves/s   ratio {:.1}", other / 1e6, mine / other);
        }
        println!();
    }
    let path = folder.join("pockets.nc");
    write(&path, &pockets())?;
    let mut times = Vec::new();
    let mut moves = 0;
    for _ in 0..rounds.max(3) {
        let start = Instant::now();
        moves = interpret(&path)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    board.note("pockets", times[times.len() / 2]);
    println!(
        "type II, 1000 elements, 100 pockets: {:.1} ms, {moves} moves (goal 50 ms)",
        times[times.len() / 2]
    );
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// Twenty cylinders and twenty cones from diameter 20 to 100, in some 400 levels.
fn roughing() -> Pair {
    let (mut nc, mut ngc) = (String::new(), String::new());
    for step in 0..20 {
        let (x, z) = (20 + 4 * step, -2 * step);
        for (x, z) in [(x, z - 1), (x + 4, z - 2)] {
            let _ = writeln!(nc, "G1 X{x}. Z{z}.");
            let _ = writeln!(ngc, "G1 X{}. Z{z}.", x / 2);
        }
    }
    Pair {
        name: "G71",
        nc: format!(
            "G98 M3 S1000\nF200.\nG0 X100. Z2.\n#1=0\nWHILE[#1 LT {ROUNDS}]DO1\nG71 U0.1 R0.1\n\
             G71 P100 Q200 U0.4 W0.1\nN100 G0 X20.\n{nc}N200 G1 X100.\n#1=#1+1\nEND1\nM30\n"
        ),
        ngc: format!(
            "G18 G21 G90 G94 G40 G8\nF200.\nG0 X50. Z2.\no200 sub\nG1 X10. Z2.\n{ngc}o200 endsub\n#1=0\n\
             o100 while [#1 LT {ROUNDS}]\nG0 X50. Z2.\nG71 Q200 X50. Z2. D.1 I.1 R.5\n#1=[#1+1]\no100 endwhile\nM2\n"
        ),
    }
}

/// A thread of 100 passes.
fn threading() -> Pair {
    Pair {
        name: "G76",
        nc: format!(
            "G98 G97 M3 S1000\nG0 X25. Z5.\n#1=0\nWHILE[#1 LT {ROUNDS}]DO1\nG76 P010060 Q10 R0\n\
             G76 X17.4 Z-20. P1300 Q130 F2.\n#1=#1+1\nEND1\nM30\n"
        ),
        ngc: format!(
            "G18 G21 G90 G94 G40 G8\nF200. M3 S1000\nG0 X12.5 Z5.\n#1=0\no100 while [#1 LT {ROUNDS}]\n\
             G76 P2. Z-20. I-2. J.13 K1.3 R2. Q29.5\n#1=[#1+1]\no100 endwhile\nM2\n"
        ),
    }
}

/// A thousand elements: a hundred V grooves, each wall in five pieces.
fn pockets() -> String {
    let mut text = String::from("G98 M3 S1000\nF200.\nG0 X200. Z2.\nG71 U1. R0.5\nG71 P100 Q200 U0.4 W0\n");
    text.push_str("N100 G0 X190. W0\n");
    let mut number = 0;
    for pocket in 0..100 {
        let middle = -10 * pocket - 5;
        for part in 0..10_i32 {
            // Down to diameter 90 and up again, a little steeper at the bottom.
            let depth = 5 - (part - 4).abs();
            let x = 190 - 20 * depth;
            let z = f64::from(middle) + 4.5 - f64::from(part + 1) * 0.9 + 0.01 * f64::from(depth);
            number += 1;
            let head = if number == 1000 { "N200 " } else { "" };
            let _ = writeln!(text, "{head}G1 X{x}. Z{z:.3}");
        }
    }
    text + "M30\n"
}
