//! Speed and memory, measured: reading, interpreting, listing, and the same motion in LinuxCNC's interpreter.
//!
//! `cargo run --release -p turnwright-benches -- compare` makes the programs, runs both sides in turn and prints
//! ratios (goals: P1 G1 blocks, P3 numbered blocks, P4 arcs, P5 and P6 macro loops, P7 cycles, P8 listing,
//! S1 memory, S2 growth, S3 jumps). `rs274` is run
//! as a separate program when it is installed; without it only our own figures are printed.
//! `table [BLOCKS]` does all of this and writes `docs/performance.md`: every goal beside what was measured.
//! `removal` takes material away beside a polyline library (R1, R3, R4).
//! `motion [TICKS]` plans paths and plays programs beside `rsruckig` (T1 to T5); `planner` does so beside LinuxCNC's own
//! planner, when its packages `linuxcnc-uspace` and `linuxcnc-uspace-dev` are installed (T2, T3, T6).
//! `work NAME COUNT` is what `cargo xtask guard` counts the instructions of.
//! `cycles` runs P7 and a figure of 100 pockets alone; `generate DIR [BLOCKS]`, `lex FILE`, `tree FILE`, `interpret FILE`, `listing FILE` do single
//! steps; `way FILE` tells how long the way is that a file makes, for whoever doubts that both sides did the same.

mod board;
mod compare;
mod cycles;
mod generate;
#[cfg(feature = "peers")]
mod job;
#[cfg(feature = "peers")]
mod linuxcnc;
#[cfg(feature = "peers")]
mod motion;
#[cfg(feature = "peers")]
mod removal;
#[cfg(feature = "peers")]
mod words;
mod work;

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::process::ExitCode;

use board::Board;
use turnwright_canon::{Action, Shape};
use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_export::formats::jsonl::CommandWriter;
use turnwright_geometry::{Point, sweep_rad};
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};
use turnwright_syntax::{Block, Tree, find_line_end, scan_block};
use turnwright_units::{Position, WorkTip};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["generate", folder] => generate::all(Path::new(folder), 1_000_000),
        ["generate", folder, blocks] => match blocks.parse() {
            Ok(blocks) => generate::all(Path::new(folder), blocks),
            Err(_) => Err(format!("{blocks} is no number of blocks")),
        },
        ["lex", file] => lex(Path::new(file)),
        ["tree", file] => tree(Path::new(file)),
        ["interpret", file] => interpret(Path::new(file)).map(drop),
        ["way", file] => way(Path::new(file)),
        ["listing", file] => listing(Path::new(file)),
        ["cycles"] => compare::cycles(3, &mut Board::default()),
        ["work", name, count] => match count.parse() {
            Ok(count) => work::run(name, count),
            Err(_) => Err(format!("{count} is no number")),
        },
        #[cfg(feature = "peers")]
        ["removal"] => removal::run(1_000, 10, &mut Board::default()).and_then(|()| removal::growth(10_000, 10, &mut Board::default())),
        #[cfg(feature = "peers")]
        ["planner"] => linuxcnc::run(&mut Board::default()),
        #[cfg(feature = "peers")]
        ["motion"] => motion::run(10_000_000, &mut Board::default()),
        #[cfg(feature = "peers")]
        ["motion", ticks] => motion::run(ticks.parse().unwrap_or(10_000_000), &mut Board::default()),
        ["compare"] => compare::run(1_000_000, 5, &mut Board::default()),
        ["compare", blocks] => compare::run(blocks.parse().unwrap_or(1_000_000), 5, &mut Board::default()),
        #[cfg(feature = "peers")]
        ["table"] => table(1_000_000),
        #[cfg(feature = "peers")]
        ["table", blocks] => table(blocks.parse().unwrap_or(1_000_000)),
        #[cfg(feature = "peers")]
        ["gcode", file] => words::read(Path::new(file)),
        _ => {
            Err("usage: table [BLOCKS] | compare [BLOCKS] | cycles | removal | motion [TICKS] | planner | generate DIR [BLOCKS] | lex|tree|interpret|way|listing FILE"
                .to_string())
        }
    };
    compare::note_peak();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Measures everything and writes the table of goals.
#[cfg(feature = "peers")]
fn table(blocks: u64) -> Result<(), String> {
    let mut board = Board::default();
    compare::run(blocks, 5, &mut board)?;
    removal::run(1_000, 10, &mut board)?;
    removal::growth(10_000, 10, &mut board)?;
    motion::run(10 * blocks, &mut board)?;
    board.write(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/performance.md"), blocks)
}

struct Texts(File);

impl Environment for Texts {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        self.0.read_at(buffer, offset).map_err(|_| ReadFault)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

/// How often the words of a text are read, so that getting the text itself hardly counts.
const LEX_TIMES: usize = 10;

fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Scans every block of a file into one reused block.
fn lex(path: &Path) -> Result<(), String> {
    let text = read(path)?;
    let mut block = Block::new();
    let (mut words, mut sum) = (0u64, 0i64);
    for _ in 0..LEX_TIMES {
        let mut at = 0;
        while at < text.len() {
            let rest = &text[at..];
            let (end, next) =
                find_line_end(rest, true).map_or((rest.len(), rest.len()), |end| (end.start, end.next));
            scan_block(&rest[..end], 0, &mut block);
            words += block.words.len() as u64;
            for word in &block.words {
                if let turnwright_syntax::Value::Number(number) = word.value {
                    sum = sum.wrapping_add(number.digits);
                }
            }
            at += next;
        }
    }
    println!("{words} words, check sum {sum}");
    Ok(())
}

/// Builds the lossless tree of a file.
fn tree(path: &Path) -> Result<(), String> {
    let text = read(path)?;
    let bytes = text.len();
    let tree = Tree::parse(text);
    println!(
        "{} tokens, {:.2} x the source",
        tree.tokens().count(),
        tree.memory_bytes() as f64 / bytes as f64
    );
    Ok(())
}

/// Radius programming is not a lathe control's way: the generated programs have doubled X words.
fn interpreter(path: &Path) -> Result<(Interpreter, Texts), String> {
    let mut control = Control::load("fanuc-0i-tf").map_err(|fault| format!("{fault:?}"))?;
    // Four decimals are typed: IS-C keeps them.
    control.parameters.set("1013#1", "1").map_err(|fault| format!("{fault:?}"))?;
    let options = Options::default();
    let interpreter =
        Interpreter::new(control, &Setup::default(), SourceId(0), options).map_err(|fault| fault.message)?;
    let file = File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok((interpreter, Texts(file)))
}

/// Interprets a file; the number of moves. Their end points are added up, so that nothing of them can be left out.
fn interpret(path: &Path) -> Result<u64, String> {
    let (mut moves, mut sum_nm) = (0u64, 0i64);
    each_move(path, |to, _| {
        moves += 1;
        sum_nm = sum_nm.wrapping_add(to.x.0.nm()).wrapping_add(to.z.nm());
    })?;
    println!("{moves} moves, check sum {sum_nm}");
    Ok(moves)
}

/// Interprets a file and tells the length of the way, which shows that both sides made the same moves.
fn way(path: &Path) -> Result<(), String> {
    let in_nm = |place: Position<WorkTip>| Point::new(place.x.0.to_nm_float(), place.z.to_nm_float());
    let (mut moves, mut length_nm, mut from) = (0u64, 0.0f64, None);
    each_move(path, |to, action| {
        let to = in_nm(to);
        if let Some(from) = from.replace(to) {
            length_nm += match action {
                Action::Feed { shape: Shape::Arc { turn, centre }, .. } => {
                    let centre = in_nm(*centre);
                    let clockwise = *turn == turnwright_canon::Turn::Clockwise;
                    sweep_rad(from, to, centre, clockwise).abs() * centre.distance(from)
                }
                _ => from.distance(to),
            };
        }
        moves += 1;
    })?;
    println!("{moves} moves, {:.4} mm", length_nm / 1e6);
    Ok(())
}

/// Interprets a file and shows every move with its end.
#[inline(always)]
fn each_move(path: &Path, mut show: impl FnMut(Position<WorkTip>, &Action)) -> Result<(), String> {
    let (mut interpreter, mut texts) = interpreter(path)?;
    loop {
        match interpreter.step(&mut texts) {
            Step::Emit(command) => {
                if let Some(to) = command.action.end_point() {
                    show(to, &command.action);
                }
            }
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => return Err(format!("alarm {} at {:?}", alarm.key, alarm.place)),
            Step::End => return Ok(()),
        }
    }
}

/// Interprets a file and writes the trace to nowhere.
fn listing(path: &Path) -> Result<(), String> {
    use std::io::Write;
    let (mut interpreter, mut texts) = interpreter(path)?;
    let mut writer = CommandWriter::new(interpreter.decimals());
    let mut out = Vec::with_capacity(1 << 17);
    let mut sink = File::create("/dev/null").map_err(|error| error.to_string())?;
    loop {
        match interpreter.step(&mut texts) {
            Step::Emit(command) => {
                writer.write(&mut out, &command);
                if out.len() > 1 << 16 {
                    sink.write_all(&out).map_err(|error| error.to_string())?;
                    out.clear();
                }
            }
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => return Err(format!("alarm {} at {:?}", alarm.key, alarm.place)),
            Step::End => break,
        }
    }
    Ok(())
}
