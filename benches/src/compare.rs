//! Ours and the peer in turn, medians of processor time, ratios.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::board::Board;
use crate::generate;

/// What one run took.
#[derive(Clone, Copy)]
pub struct Cost {
    pub cpu_s: f64,
    memory_mib: f64,
}

/// Generates, runs, prints.
pub fn run(blocks: u64, rounds: usize, board: &mut Board) -> Result<(), String> {
    let folder = std::env::temp_dir().join("turnwright-bench");
    // The programs of an earlier run serve again when they have the same size.
    let (note, size) = (folder.join("generated"), format!("5 {blocks}"));
    if std::fs::read_to_string(&note).is_ok_and(|noted| noted == size) {
        println!("the programs are those of an earlier run");
    } else {
        generate::all(&folder, blocks)?;
        std::fs::write(&note, size).map_err(|error| error.to_string())?;
    }
    let peer = Peer::find(&folder);
    if peer.is_none() {
        println!("rs274 is not installed (Debian: linuxcnc-uspace): own figures only");
    }
    reading(&folder, rounds, board)?;
    start(&folder, peer.as_ref(), board)?;
    let rows = [
        ("P1", "lines", "interpret", true, 1),
        ("P3", "numbered", "interpret", true, 1),
        ("P4", "arcs-centre", "interpret", true, 1),
        ("P4 R", "arcs-radius", "interpret", true, 1),
        ("P5", "loop", "interpret", true, 1),
        ("P6", "loop-moves", "interpret", true, 1),
        ("S3", "jumps", "interpret", true, 1),
        ("P8", "lines", "listing", false, 1),
        ("S1", "lines5", "interpret", true, 5),
    ];
    let mut once = 0.0;
    for (label, name, step, silent, times) in rows {
        // The other side takes long over loops and over five times the blocks, and knows no such jumps.
        let is_slow = times > 1 || name.starts_with("loop");
        let rounds = if is_slow { rounds.min(3) } else { rounds };
        let peer = peer.as_ref().filter(|_| name != "jumps");
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..rounds {
            // Ours takes so little that one look says little.
            for _ in 0..3 {
                ours.push(own(step, &folder.join(format!("{name}.nc")))?);
            }
            if let Some(peer) = peer {
                theirs.push(peer.run(&folder.join(format!("{name}.ngc")), silent)?);
            }
        }
        let mine = median(&ours);
        let count = match name {
            "loop" | "loop-moves" => generate::LOOP_ROUNDS,
            "jumps" => generate::JUMPS,
            _ => blocks * times,
        } as f64;
        print!(
            "{label:5} {name:11} {:8.3} s  {:6.1} M blocks/s  {:6.1} MiB",
            mine.cpu_s,
            count / mine.cpu_s / 1e6,
            mine.memory_mib
        );
        if !theirs.is_empty() {
            let peer = median(&theirs);
            board.note(label, peer.cpu_s / mine.cpu_s);
            print!(
                "   rs274 {:7.3} s  {:6.1} MiB   ratio {:.1}",
                peer.cpu_s,
                peer.memory_mib,
                peer.cpu_s / mine.cpu_s
            );
        }
        if name == "loop"
            && let Some(lua) = lua(generate::LOOP_ROUNDS, rounds)
        {
            board.note("P5 Lua", lua.cpu_s / mine.cpu_s);
            print!("   Lua {:.3} s  ratio {:.2}", lua.cpu_s, lua.cpu_s / mine.cpu_s);
        }
        println!();
        match (name, step) {
            ("lines", "interpret") => once = mine.cpu_s,
            ("jumps", _) => board.note("S3", mine.cpu_s),
            ("lines5", _) => {
                board.note("S1 memory", mine.memory_mib);
                board.note("S2", mine.cpu_s / 5.0 / once);
                println!("S2 growth {:8.2} (five times the blocks, time per block)", mine.cpu_s / 5.0 / once);
            }
            _ => {}
        }
    }
    crate::cycles::run(&folder, peer.as_ref(), rounds, board)
}

/// The cycles alone.
pub fn cycles(rounds: usize, board: &mut Board) -> Result<(), String> {
    let folder = std::env::temp_dir().join("turnwright-bench");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    crate::cycles::run(&folder, Peer::find(&folder).as_ref(), rounds, board)
}

/// The loop of P5 in Lua 5.4 with its variables in a table, when that is installed.
fn lua(loops: u64, rounds: usize) -> Option<Cost> {
    let script = format!(
        "local v, sin, rad = {{0, 0, 0.5}}, math.sin, math.rad\n\
         while v[1] < {loops} do\n\
         v[2] = v[2] + v[3] * 2.0 - 0.25\n\
         v[3] = sin(rad(v[1] * 0.1)) + 1.5\n\
         v[1] = v[1] + 1\n\
         end"
    );
    let costs: Result<Vec<_>, _> = (0..rounds)
        .map(|_| {
            let mut command = Command::new("lua5.4");
            command.args(["-e", &script]);
            measure(command)
        })
        .collect();
    costs.ok().map(|costs| median(&costs))
}

/// A program of nothing but its end: the command line beside the other side, both a few times in a run.
fn start(folder: &Path, peer: Option<&Peer>, board: &mut Board) -> Result<(), String> {
    const TIMES: usize = 20;
    let beside = std::env::current_exe().map_err(|error| error.to_string())?.with_file_name("turnwright");
    if !beside.exists() {
        println!("X1: build the command line first (cargo build --release)");
        return Ok(());
    }
    let (nc, ngc) = (folder.join("end.nc"), folder.join("end.ngc"));
    for (path, text) in [(&nc, "O1\nM30\n"), (&ngc, "M2\n")] {
        std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..TIMES {
        let mut command = Command::new(&beside);
        command.args(["check", "--alarms-only"]).arg(&nc);
        ours.push(measure(command)?);
        if let Some(peer) = peer {
            theirs.push(peer.run(&ngc, true)?);
        }
    }
    let mine = median(&ours).cpu_s;
    println!("X1 start-up {:.2} ms", mine * 1e3);
    if !theirs.is_empty() {
        board.note("X1", median(&theirs).cpu_s / mine);
    }
    Ok(())
}

fn reading(folder: &Path, rounds: usize, board: &mut Board) -> Result<(), String> {
    let path = folder.join("lines.nc");
    let bytes = std::fs::metadata(&path).map_err(|error| error.to_string())?.len() as f64;
    for (label, step) in [("P9 words", "lex"), ("P10 tree", "tree")] {
        let costs: Result<Vec<_>, _> = (0..rounds).map(|_| own(step, &path)).collect();
        let cost = median(&costs?);
        let share = (cost.memory_mib * 1_048_576.0) / bytes;
        match step {
            "tree" => board.note("P10", share),
            _ if cfg!(feature = "peers") => {
                let costs: Result<Vec<_>, _> = (0..rounds).map(|_| own("gcode", &path)).collect();
                board.note("P9", median(&costs?).cpu_s / cost.cpu_s);
            }
            _ => {}
        }
        println!(
            "{label:16} {:8.3} s  {:6.0} MB/s  {share:5.2} x the source in memory",
            cost.cpu_s,
            if step == "lex" { crate::LEX_TIMES as f64 } else { 1.0 } * bytes / cost.cpu_s / 1e6
        );
    }
    Ok(())
}

pub fn median(costs: &[Cost]) -> Cost {
    let mut sorted = costs.to_vec();
    sorted.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    let memory_mib = costs.iter().map(|cost| cost.memory_mib).fold(0.0, f64::max);
    Cost { memory_mib, ..sorted[sorted.len() / 2] }
}

pub fn own(step: &str, file: &Path) -> Result<Cost, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(program);
    let peak = std::env::temp_dir().join("turnwright-bench").join("peak");
    command.arg(step).arg(file).env(PEAK_FILE, &peak);
    let cost = measure(command)?;
    // A child's peak as its parent sees it includes the parent's own: ours is noted by itself.
    let text = std::fs::read_to_string(&peak).map_err(|error| format!("{}: {error}", peak.display()))?;
    let kib: f64 = text.trim().parse().map_err(|_| format!("{}: {text}", peak.display()))?;
    Ok(Cost { memory_mib: kib / 1024.0, ..cost })
}

/// Names the file that a timed step notes its peak memory in.
const PEAK_FILE: &str = "TURNWRIGHT_BENCH_PEAK";

/// Notes the peak memory of this process when the comparison asked for it.
pub fn note_peak() {
    let Some(file) = std::env::var_os(PEAK_FILE) else { return };
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = peak.and_then(|peak| peak.split_whitespace().next()).unwrap_or("0");
    if let Err(error) = std::fs::write(&file, kib) {
        eprintln!("{}: {error}", file.display());
    }
}

/// LinuxCNC's stand-alone interpreter.
pub struct Peer {
    silence: Option<PathBuf>,
    home: PathBuf,
}

impl Peer {
    pub fn find(folder: &Path) -> Option<Self> {
        Command::new("rs274").arg("-h").stdout(Stdio::null()).stderr(Stdio::null()).status().ok()?;
        let library = folder.join("silence.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("silence.c");
        let built = Command::new("cc")
            .args(["-O2", "-w", "-shared", "-fPIC"])
            .arg(&source)
            .arg("-o")
            .arg(&library)
            .status();
        let silence = built.is_ok_and(|status| status.success()).then_some(library);
        Some(Self { silence, home: folder.to_path_buf() })
    }

    pub fn run(&self, file: &Path, silent: bool) -> Result<Cost, String> {
        let mut command = Command::new("rs274");
        command.arg("-g").arg(file).env("HOME", &self.home);
        if let Some(library) = self.silence.as_ref().filter(|_| silent) {
            command.env("LD_PRELOAD", library);
        }
        measure(command)
    }
}

impl Peer {
    /// How many moves a program makes there.
    pub fn moves(&self, file: &Path) -> Result<u64, String> {
        let output = Command::new("rs274").arg("-g").arg(file).env("HOME", &self.home).output();
        let output = output.map_err(|error| format!("rs274: {error}"))?;
        let text = String::from_utf8_lossy(&output.stdout);
        Ok(text.lines().filter(|line| line.contains(" STRAIGHT_") || line.contains(" ARC_FEED")).count()
            as u64)
    }
}

/// Runs a command and takes its processor time and peak memory from `wait4`, which only Python offers without
/// unsafe code or a library. The library to preload goes to the child alone.
fn measure(command: Command) -> Result<Cost, String> {
    const SCRIPT: &str = "import os,sys,subprocess\n\
        env=dict(os.environ)\n\
        if sys.argv[1]: env['LD_PRELOAD']=sys.argv[1]\n\
        n=subprocess.DEVNULL\n\
        p=subprocess.Popen(sys.argv[2:],stdout=n,stderr=n,stdin=n,env=env)\n\
        _,code,u=os.wait4(p.pid,0)\n\
        print(u.ru_utime+u.ru_stime,u.ru_maxrss,code)";
    let mut wrapped = Command::new("python3");
    let mut library = std::ffi::OsString::new();
    for (name, value) in command.get_envs() {
        match (name.to_str(), value) {
            (Some("LD_PRELOAD"), Some(value)) => library = value.to_os_string(),
            (_, Some(value)) => drop(wrapped.env(name, value)),
            _ => {}
        }
    }
    wrapped.arg("-c").arg(SCRIPT).arg(library).arg(command.get_program()).args(command.get_args());
    let output = wrapped.output().map_err(|error| format!("python3: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers.as_slice() {
        [cpu_s, kib, code] if *code == 0.0 || command.get_program() == "rs274" => {
            Ok(Cost { cpu_s: *cpu_s, memory_mib: kib / 1024.0 })
        }
        _ => Err(format!("{command:?} failed: {text} {}", String::from_utf8_lossy(&output.stderr))),
    }
}
