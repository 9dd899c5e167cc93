//! Threads in `part.stl`, `part.glb` and the report: winding, and why not.

mod support;

use std::path::Path;

use support::{Folder, Ran, turnwright};

fn program(stock: &str, thread: &str) -> String {
    format!(
        "O1\n(SETUP STOCK {stock})\n(SETUP TOOL 3 THREADING)\nT0303\nG97 S500 M3\nG0 X44. Z5.\n{thread}\nG0 X100. Z50.\nM30\n"
    )
}

/// Runs `part` for an STL file, and gives how many bytes it has.
fn stl(folder: &Folder, text: &str) -> (Ran, usize) {
    let (program, file) = (folder.file("thread.nc", text), folder.path("part.stl").display().to_string());
    let ran = turnwright(&["part", &program, "-o", &file]);
    let bytes = std::fs::metadata(Path::new(&file)).map_or(0, |data| data.len() as usize);
    (ran, bytes)
}

#[test]
fn threads_wind_in_triangles() {
    let folder = Folder::new();
    let text = program("D40 L60", "G92 X39. Z-15. F2.\nX38.");
    let (ran, bytes) = stl(&folder, &text);
    assert_eq!((ran.status, ran.err.as_str()), (0, ""));
    // Grooves are far more triangles than a cylinder, a face and a back, and a program without threads has no more.
    assert!(bytes > 200_000, "{bytes}");
    let (ran, bytes) = stl(&folder, &text.replace("G92 X39. Z-15. F2.\nX38.", ""));
    assert!(ran.status == 0 && bytes < 50_000, "{bytes}");
    // The page of a run has them too, and says in both languages when it shows them.
    let (program, out) = (folder.file("thread.nc", &text), folder.path("out").display().to_string());
    let page = |options: &[&str]| {
        let ran = turnwright(&[&["run", &program, "--out", &out], options].concat());
        assert_eq!((ran.status, ran.err.as_str()), (0, ""));
        std::fs::read_to_string(Path::new(&out).join("report.html")).expect("a page")
    };
    assert!(page(&[]).contains("\"wound\":{"));
    assert!(!page(&["--no-3d"]).contains("\"wound\":{"));
}

#[test]
fn threads_that_are_too_long_are_plain_and_it_is_told() {
    let folder = Folder::new();
    // 2,190 turns by a dozen passes by 144 half-planes are more than 3,000,000 cuts; a tenth of it is not.
    let cycle = |z: &str| format!("G76 P020060 Q50 R0.02\nG76 X39.386 Z{z} P307 Q100 F0.5");
    let (ran, bytes) = stl(&folder, &program("D40 L1200", &cycle("-1090.")));
    assert_eq!(ran.status, 0);
    assert!(ran.err.contains("T430") && bytes < 100_000, "{bytes} {}", ran.err);
    let (ran, bytes) = stl(&folder, &program("D40 L1200", &cycle("-90.")));
    assert!(!ran.err.contains("T430") && bytes > 1_000_000, "{bytes} {}", ran.err);
}

#[test]
fn threads_through_a_wall_are_plain_and_it_is_told() {
    let folder = Folder::new();
    for (bore, is_through) in [("38.5", true), ("36", false)] {
        let text = program(&format!("D40 L60 BORE{bore}"), "G92 X39. Z-15. F2.\nX38.");
        let (ran, bytes) = stl(&folder, &text);
        assert_eq!(ran.status, 0);
        assert_eq!(ran.err.contains("T431"), is_through, "{}", ran.err);
        assert!(bytes > 50_000, "there is a part either way: {bytes}");
    }
}
