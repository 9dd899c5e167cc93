//! Files, streams and folders as they should not be: the program ends, says why and leaves nothing half done.

mod support;

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use support::{ALARMS, CLEAN, Folder, command, turnwright};

#[test]
fn what_is_no_file_is_said_so() {
    let folder = Folder::new();
    let root = folder.0.display().to_string();
    for command in ["run", "trace"] {
        let ran = turnwright(&[command, &root]);
        assert_eq!(ran.status, 2, "{command}");
        assert!(ran.err.contains("This is a folder"), "{}", ran.err);
        let ran = turnwright(&[command, "no such file.nc"]);
        assert_eq!(ran.status, 2);
        assert!(ran.err.contains("no such file.nc") && ran.err.contains("does not exist"), "{}", ran.err);
    }
    let good = folder.file("good.nc", ALARMS);
    let ran = turnwright(&["check", "missing.nc", &good]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("alarm[PS0062]"), "the others are checked all the same: {}", ran.err);
    let ran = turnwright(&["check", "missing.nc", "--format", "json"]);
    let line: serde_json::Value = serde_json::from_str(ran.out.trim()).expect("one object");
    assert_eq!((&line["key"], &line["line"]), (&"file-unreadable".into(), &0.into()));
}

#[test]
fn setup_files_that_cannot_be_used_are_named_with_their_line() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    folder.file("part.toml", "control = \"fanuc-0i-tf\"\nmachin = \"x\"\n");
    let ran = turnwright(&["run", &program]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("part.toml:2") && ran.err.contains("machin"), "{}", ran.err);
    let ran = turnwright(&["run", &program, "--setup", "nowhere.toml"]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("nowhere.toml does not exist"), "{}", ran.err);
    folder.file("part.toml", "machine = \"generic-lath\"\n");
    let ran = turnwright(&["run", &program]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("generic-lathe"), "{}", ran.err);
}

#[test]
fn texts_that_are_no_programs_end_with_a_status_and_no_panic() {
    let folder = Folder::new();
    let mut noise = Vec::new();
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    for _ in 0..200_000 {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        noise.push(state as u8);
    }
    let texts: [(&str, Vec<u8>); 9] = [
        ("empty.nc", Vec::new()),
        ("blank.nc", b"\r\n\n \r\n".to_vec()),
        ("percent.nc", b"%".to_vec()),
        ("noise.nc", noise),
        ("zeros.nc", vec![0; 100_000]),
        ("truncated.nc", ALARMS.as_bytes()[..ALARMS.len() / 2].to_vec()),
        ("truncated-word.nc", b"O1\nG01 X".to_vec()),
        ("escape.nc", b"O1\nG01 X\x1b[31mRED\x07 F1\n".to_vec()),
        ("gbk.nc", b"O1 (\xb3\xb5\xb5\xb6)\nG01 X1. (\xb3\xb5\nM30\n".to_vec()),
    ];
    for (name, bytes) in texts {
        let file = folder.file(name, bytes);
        for arguments in [
            vec!["run", &file],
            vec!["check", &file],
            vec!["check", &file, "--format", "json"],
            vec!["check", &file, "--format", "sarif"],
            vec!["trace", &file],
        ] {
            let ran = turnwright(&arguments);
            assert!((0..=2).contains(&ran.status), "{arguments:?}: {}", ran.status);
            let said = format!("{}{}", ran.out, ran.err);
            assert!(!said.contains("internal-error") && !said.contains("T032"), "{arguments:?}: {said}");
            assert!(!said.contains('\u{1b}') && !said.contains('\u{7}'), "{arguments:?} steers the terminal");
        }
    }
}

#[test]
fn a_line_of_forty_megabytes_is_refused_in_bounded_memory() {
    let folder = Folder::new();
    let file = folder.path("long.nc");
    {
        let mut out = std::io::BufWriter::new(std::fs::File::create(&file).expect("a file"));
        out.write_all(b"O1 G01 ").expect("written");
        for _ in 0..10_000_000 {
            out.write_all(b"X1. ").expect("written");
        }
    }
    let file = file.display().to_string();
    for command in ["check", "run", "trace"] {
        let ran = turnwright(&[command, &file]);
        assert_eq!(ran.status, 1, "{command}: {}", ran.err);
        assert!(ran.err.len() < 4_000, "the line is shown in part: {}", ran.err.len());
    }
}

#[test]
fn a_long_line_is_shown_around_its_place() {
    let folder = Folder::new();
    let remark = "(车刀 remark) ".repeat(30);
    let file = folder.file("long.nc", format!("O1\n{remark}G01 X1.2.3 F1. {remark}\nM30\n"));
    let ran = turnwright(&["check", &file]);
    let column = remark.chars().count() + 5;
    assert!(ran.err.contains(&format!("long.nc:2:{column}")), "{}", ran.err);
    let shown =
        ran.err.lines().find(|line| line.contains(" | ") && line.contains("X1.2.3")).expect("the place");
    assert!(shown.contains("...") && shown.chars().count() < 150, "{shown}");
}

#[test]
fn a_folder_that_cannot_be_written_leaves_nothing_behind() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    // A file stands where the folder should be.
    let blocked = folder.file("blocked", "x");
    let ran = turnwright(&["run", &program, "--out", &blocked]);
    assert_eq!(ran.status, 2, "{}", ran.err);
    let ran = turnwright(&["run", &program, "--out", &format!("{blocked}/in")]);
    assert_eq!(ran.status, 2, "{}", ran.err);
    assert!(ran.err.contains("cannot be written"), "{}", ran.err);
    let ran = turnwright(&["plot", &program, "-o", &folder.path("no/such/a.svg").display().to_string()]);
    assert_eq!(ran.status, 2);
    // A folder stands where a file should be: the trace is not left half done.
    let out = folder.path("out");
    std::fs::create_dir_all(out.join("report.html")).expect("a folder");
    let ran = turnwright(&["run", &program, "--out", &out.display().to_string()]);
    assert_eq!(ran.status, 2);
    assert_eq!(support::names(&out), ["report.html"], "{}", ran.err);
    assert_eq!(folder.names(), ["blocked", "out", "part.nc"]);
}

#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let folder = Folder::new();
    let mut program = String::from("O1\nG98 F100.\n");
    for index in 0..50_000 {
        program.push_str(&format!("G01 X{}. Z-1.\n", index % 50 + 1));
    }
    program.push_str("M30\n");
    let file = folder.file("many.nc", program);
    for arguments in [vec!["trace", &file], vec!["trace", &file, "--format", "text"]] {
        let mut child = command(&arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut first = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut first).expect("a line");
        assert!(!first.is_empty());
        let ended = child.wait_with_output().expect("it ends");
        assert_eq!(ended.status.code(), Some(0), "{arguments:?}");
        assert!(ended.stderr.is_empty(), "{}", String::from_utf8_lossy(&ended.stderr));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    let full = std::fs::File::options().write(true).open("/dev/full").expect("the device");
    let ended = command(&["trace", &program]).stdout(full).output().expect("it ends");
    assert_eq!(ended.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&ended.stderr).contains("the disk is full"));
}

#[cfg(unix)]
#[test]
fn a_folder_that_links_to_itself_is_searched_once() {
    let folder = Folder::new();
    folder.file("a/part.nc", ALARMS);
    std::os::unix::fs::symlink(&folder.0, folder.path("a/loop")).expect("a link");
    let ran = turnwright(&["check", &folder.0.display().to_string()]);
    assert!(ran.err.ends_with("1 file, 1 alarm, 0 warnings\n"), "{}", ran.err);
}

#[test]
fn endless_programs_are_stopped() {
    let folder = Folder::new();
    let file = folder.file("endless.nc", "O1\nM98 P1\nM30\n");
    let ran = turnwright(&["check", &file, "--max-blocks", "1000"]);
    assert_eq!(ran.status, 1, "{}", ran.err);
    let file = folder.file("again.nc", "O1\nG00 X1. Z1.\nG00 X2.\nM99\n");
    let ran = turnwright(&["check", &file, "--max-blocks", "1000"]);
    assert!((0..=1).contains(&ran.status), "{}", ran.err);
}
