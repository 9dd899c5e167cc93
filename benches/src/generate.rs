//! The programs that are timed: the same motion for a lathe control (`.nc`, X as a diameter) and for LinuxCNC
//! (`.ngc`, X as a radius). Deterministic.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use turnwright_dice::Dice;

/// A value in ten-thousandths as a word with four decimals.
struct Word(i64);

impl std::fmt::Display for Word {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let magnitude = self.0.unsigned_abs();
        write!(f, "{sign}{}.{:04}", magnitude / 10_000, magnitude % 10_000)
    }
}

/// Both dialects of one program.
struct Pair {
    nc: BufWriter<File>,
    ngc: BufWriter<File>,
}

impl Pair {
    fn create(folder: &Path, name: &str) -> Result<Self, String> {
        let open = |extension: &str| {
            let path = folder.join(format!("{name}.{extension}"));
            File::create(&path).map(BufWriter::new).map_err(|error| format!("{}: {error}", path.display()))
        };
        let mut pair = Self { nc: open("nc")?, ngc: open("ngc")? };
        pair.line(
            "%\nO1000\nG18 G21 G40 G98 M3 S1000\nG0 X100. Z2.\nF200.\n",
            "G18 G21 G90 G94 G40 G8\nG0 X50. Z2.\nF200.\n",
        )?;
        Ok(pair)
    }

    fn line(&mut self, nc: &str, ngc: &str) -> Result<(), String> {
        let write = |file: &mut BufWriter<File>, text: &str| file.write_all(text.as_bytes());
        write(&mut self.nc, nc).and_then(|()| write(&mut self.ngc, ngc)).map_err(|error| error.to_string())
    }

    fn end(mut self) -> Result<(), String> {
        self.line("M30\n%\n", "M2\n")?;
        self.nc.flush().and_then(|()| self.ngc.flush()).map_err(|error| error.to_string())
    }
}

/// Writes every program.
pub fn all(folder: &Path, blocks: u64) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    lines(folder, "lines", blocks, false)?;
    lines(folder, "numbered", blocks, true)?;
    lines(folder, "lines5", blocks * 5, false)?;
    arcs(folder, "arcs-centre", blocks, false)?;
    arcs(folder, "arcs-radius", blocks, true)?;
    loops(folder, LOOP_ROUNDS)?;
    jumps(folder)
}

/// Rounds of the loops, as the goals have them, however short the other programs are.
pub const LOOP_ROUNDS: u64 = 1_000_000;

/// A loop that only computes, and one that moves in every round.
fn loops(folder: &Path, rounds: u64) -> Result<(), String> {
    let mut computing = Pair::create(folder, "loop")?;
    computing.line(
        &format!(
            "#1=0\n#2=0\n#3=0.5\nWHILE[#1 LT {rounds}]DO1\n#2=#2+#3*2.0-0.25\n#3=SIN[#1*0.1]+1.5\n#1=#1+1\nEND1\n"
        ),
        &format!(
            "#1=0\n#2=0\n#3=0.5\no100 while [#1 LT {rounds}]\n#2=[#2 + #3*2.0 - 0.25]\n#3=[SIN[#1*0.1]+1.5]\n#1=[#1+1]\no100 endwhile\n"
        ),
    )?;
    computing.end()?;
    let mut moving = Pair::create(folder, "loop-moves")?;
    moving.line(
        &format!(
            "#1=0\nWHILE[#1 LT {rounds}]DO1\n#2=20+SIN[#1*0.36]\nG1 X[#2*2] Z[0-#1*0.0001]\n#1=#1+1\nEND1\n"
        ),
        &format!(
            "#1=0\no100 while [#1 LT {rounds}]\n#2=[20+SIN[#1*0.36]]\nG1 X#2 Z[0-#1*0.0001]\n#1=[#1+1]\no100 endwhile\n"
        ),
    )?;
    moving.end()
}

/// Lines of the program that jumps about.
const JUMP_LINES: u64 = 100_000;

/// Jumps to computed places all over it, as the goal has them.
pub const JUMPS: u64 = 1_000_000;

/// That program; only ours, the other dialect has no such jump.
fn jumps(folder: &Path) -> Result<(), String> {
    let path = folder.join("jumps.nc");
    let fault = |error: std::io::Error| format!("{}: {error}", path.display());
    let mut file = BufWriter::new(File::create(&path).map_err(fault)?);
    let head = format!(
        "%\nO3000\n#1=0\n#2=7\nN1 #1=#1+1\nIF[#1 GT {}]GOTO99999\n#2=#2*7919+13\n#2=#2-FIX[#2/99000]*99000\nGOTO[#2+10]\n",
        JUMPS / 2
    );
    file.write_all(head.as_bytes()).map_err(fault)?;
    for line in 10..JUMP_LINES - 5 {
        writeln!(file, "N{line} GOTO1").map_err(fault)?;
    }
    file.write_all(b"N99999 M30\n%\n").and_then(|()| file.flush()).map_err(fault)
}

/// A long straight-line program; `numbered` adds N and F to every block.
fn lines(folder: &Path, name: &str, blocks: u64, numbered: bool) -> Result<(), String> {
    let mut pair = Pair::create(folder, name)?;
    let mut dice = Dice::new(88_172_645_463_325_252);
    let (mut x, mut z) = (400_000i64, 0i64);
    for block in 0..blocks {
        x = (x + ((dice.part() - 0.5) * 5_000.0) as i64).clamp(50_000, 600_000);
        z -= (dice.part() * 200.0) as i64;
        if z < -2_000_000 {
            z = 0;
        }
        let (head, tail) = if numbered {
            (format!("N{} ", (block % 9_999) * 10 + 10), format!(" F{}.", 100 + block % 200))
        } else {
            (String::new(), String::new())
        };
        pair.line(
            &format!("{head}G1 X{} Z{}{tail}\n", Word(x * 2), Word(z)),
            &format!("{head}G1 X{} Z{}{tail}\n", Word(x), Word(z)),
        )?;
    }
    pair.end()
}

/// Quarter arcs, up and down in turn, by centre or by radius.
fn arcs(folder: &Path, name: &str, blocks: u64, by_radius: bool) -> Result<(), String> {
    let mut pair = Pair::create(folder, name)?;
    let mut dice = Dice::new(1_234_567_890_123);
    let (mut x, mut z) = (400_000i64, 0i64);
    let start = |pair: &mut Pair, x: i64, z: i64| {
        pair.line(&format!("G1 X{} Z{}\n", Word(x * 2), Word(z)), &format!("G1 X{} Z{}\n", Word(x), Word(z)))
    };
    start(&mut pair, x, z)?;
    for block in 0..blocks {
        let radius = 500 + (dice.part() * 4_000.0) as i64;
        let up = block % 2 == 0;
        let way = if up { radius } else { -radius };
        let (code, to) = (if up { 2 } else { 3 }, (x + way, z - radius));
        // The centre lies on the line of the end that is further out, so that each is a quarter circle.
        let centre = if by_radius { format!("R{}", Word(radius)) } else { format!("I{} K0.", Word(way)) };
        let word = |x: i64| format!("G{code} X{} Z{} {centre}\n", Word(x), Word(to.1));
        pair.line(&word(to.0 * 2), &word(to.0))?;
        (x, z) = to;
        if z < -2_000_000 || !(50_000..=600_000).contains(&x) {
            (x, z) = (400_000, 0);
            start(&mut pair, x, z)?;
        }
    }
    pair.end()
}
