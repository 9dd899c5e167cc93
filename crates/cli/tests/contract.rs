//! The promises of the command line: exit statuses, streams, fields.

mod support;

use serde_json::Value;
use support::{ALARMS, CLEAN, Folder, Ran, WARNS, json_lines, turnwright, turnwright_with_input};

#[test]
fn the_exit_status_says_what_was_found() {
    let folder = Folder::new();
    let (clean, warns, alarms) =
        (folder.file("clean.nc", CLEAN), folder.file("warns.nc", WARNS), folder.file("alarms.nc", ALARMS));
    for command in ["run", "check", "trace"] {
        assert_eq!(turnwright(&[command, &clean]).status, 0, "{command}");
        assert_eq!(turnwright(&[command, &warns]).status, 0, "{command}");
        assert_eq!(turnwright(&[command, &warns, "--deny", "warnings"]).status, 1, "{command}");
        assert_eq!(turnwright(&[command, &alarms]).status, 1, "{command}");
        assert_eq!(turnwright(&[command, "missing.nc"]).status, 2, "{command}");
        assert_eq!(turnwright(&[command]).status, 2, "{command}");
    }
    assert_eq!(turnwright(&["check", &clean, &alarms, "missing.nc"]).status, 2);
    assert_eq!(turnwright(&[]).status, 2);
}

#[test]
fn the_trace_names_the_file_of_a_line_that_another_file_holds() {
    let folder = Folder::new();
    let main = folder.file("main.nc", "O1\nM98 P2\nG00 X10. Z0\nM98 P2\nM30\n");
    let other = folder.file("O0002.nc", "O2\nG00 X20. Z1.\nIF[#100EQ1]GOTO99\n#100=1\nM99\n");
    let ran = turnwright(&["trace", &main, "--format", "jsonl"]);
    let lines = json_lines(&ran.out);
    let files: Vec<_> =
        lines[1..].iter().map(|line| (line["line"].as_u64(), line["file"].as_str())).collect();
    let other = Some(other.as_str());
    assert_eq!(files, [(Some(2), other), (Some(3), None), (Some(2), other), (Some(3), other)]);
    assert_eq!(lines[4]["key"], "jump-target-not-found");
}

#[test]
fn a_program_typed_in_at_the_panel_has_no_loops() {
    let folder = Folder::new();
    let file = folder.file("loop.nc", "WHILE[#1LT2]DO1\n#1=#1+1\nG00 X#1 Z0\nEND1\nM30\n");
    assert_eq!(turnwright(&["check", &file]).status, 0);
    let ran = turnwright(&["check", &file, "--mdi", "--format", "json"]);
    assert_eq!((ran.status, &json_lines(&ran.out)[0]["key"]), (1, &Value::from("macro-flow-in-mdi")));
}

#[test]
fn diagnostics_go_to_standard_error_for_people_and_to_standard_output_for_scripts() {
    let folder = Folder::new();
    let alarms = folder.file("alarms.nc", ALARMS);
    let human = turnwright(&["check", &alarms]);
    assert_eq!(human.out, "");
    assert!(human.err.contains("alarm[PS0062]: "), "{}", human.err);
    assert!(human.err.contains("alarms.nc:6:7"), "{}", human.err);
    assert!(human.err.contains("= cause: ") && human.err.contains("= cure: "), "{}", human.err);
    assert!(human.err.ends_with("1 file, 1 alarm, 0 warnings\n"), "{}", human.err);
    assert!(!human.err.contains('\u{1b}'), "no colours into a pipe");
    let json = turnwright(&["check", &alarms, "--format", "json"]);
    assert_eq!(json.err, "");
    assert_eq!(json.status, 1);
    let line = &json_lines(&json.out)[0];
    assert_eq!(line["severity"], "alarm");
    assert_eq!(line["id"], "PS0062");
    assert_eq!(line["key"], "cut-depth-illegal");
    assert_eq!((&line["line"], &line["column"], &line["end_column"]), (&6.into(), &7.into(), &10.into()));
    assert!(line["message"].is_string() && line["cause"].is_string() && line["remedy"].is_string());
    assert_eq!(line["trace"], Value::Array(Vec::new()));
    assert_eq!(line["file"], alarms.as_str());
    let fields: Vec<&str> = line.as_object().expect("an object").keys().map(String::as_str).collect();
    let mut promised = [
        "file",
        "severity",
        "id",
        "key",
        "line",
        "column",
        "end_column",
        "message",
        "cause",
        "remedy",
        "trace",
    ];
    promised.sort_unstable();
    assert_eq!(fields, promised);
    assert!(json.out.starts_with("{\"file\":"), "fields stand in the order of the contract");
}

#[test]
fn the_number_is_the_controls_own() {
    let folder = Folder::new();
    let alarms = folder.file("alarms.nc", ALARMS);
    for (control, id) in [("fanuc-0i-mate-tb", "062"), ("fanuc-0i-tc", "062"), ("fanuc-0i-td", "PS0062")] {
        let json = turnwright(&["check", &alarms, "--format", "json", "--control", control]);
        assert_eq!(json_lines(&json.out)[0]["id"], id, "{control}");
    }
}

#[test]
fn sarif_is_one_document_with_rules() {
    let folder = Folder::new();
    let (warns, alarms) = (folder.file("warns.nc", WARNS), folder.file("a b#c.nc", ALARMS));
    let ran = turnwright(&["check", &warns, &alarms, "--format", "sarif"]);
    assert_eq!(ran.status, 1);
    let document: Value = serde_json::from_str(&ran.out).expect("one document");
    assert_eq!(document["version"], "2.1.0");
    let run = &document["runs"][0];
    let results = run["results"].as_array().expect("results");
    assert_eq!(results.len(), 2);
    let rules: Vec<_> =
        run["tool"]["driver"]["rules"].as_array().expect("rules").iter().map(|r| &r["id"]).collect();
    for result in results {
        assert!(rules.contains(&&result["ruleId"]), "{result}");
    }
    let place = &results[1]["locations"][0]["physicalLocation"];
    assert_eq!(place["region"]["startLine"], 6);
    assert!(place["artifactLocation"]["uri"].as_str().expect("a uri").ends_with("/a%20b%23c.nc"));
}

#[test]
fn a_trace_is_json_lines_into_a_pipe_and_ends_with_its_alarm() {
    let folder = Folder::new();
    let ran = turnwright(&["trace", &folder.file("clean.nc", CLEAN)]);
    assert_eq!(
        ran.out.lines().next(),
        Some(
            r#"{"turnwright":"trace","version":1,"control":"fanuc-0i-tf","units":"mm","x":"diameter","frame":"work"}"#
        )
    );
    let lines = json_lines(&ran.out);
    let feed = lines.iter().find(|line| line["op"] == "feed").expect("a feed");
    assert_eq!((&feed["x"], &feed["z"], &feed["line"]), (&50.into(), &(-10).into(), &5.into()));
    assert_eq!(lines.last().expect("a line")["op"], "end");
    assert_eq!(ran.err, "");

    let ran = turnwright(&["trace", &folder.file("alarms.nc", ALARMS)]);
    let lines = json_lines(&ran.out);
    let last = lines.last().expect("a line");
    assert_eq!((&last["op"], &last["id"], &last["line"]), (&"alarm".into(), &"PS0062".into(), &6.into()));
    assert_eq!(last["o"], 1);
    assert!(ran.err.contains("alarm[PS0062]"), "{}", ran.err);

    let text = turnwright(&["trace", &folder.file("clean.nc", CLEAN), "--format", "text"]);
    assert!(text.out.contains("\nfeed d50 z-10 f0.2/rev\n"), "{}", text.out);
}

#[test]
fn a_section_of_too_many_edges_has_its_drawing_but_no_solid() {
    // A point without a radius goes along a wave of short straight lines: each is an edge of the section.
    let wave = |rounds: u32| {
        format!(
            "O1\nT0101\nG97 S500 M3\nG0 X48. Z6.\nG1 Z0 F0.1\n#1=0\nWHILE[#1LT{rounds}]DO1\nG1 U0.004 W-0.005\n\
             U-0.004 W-0.005\n#1=#1+1\nEND1\nG0 X60.\nZ5.\nM30\n"
        )
    };
    let setup = "[stock]\ndiameter_mm = 50\nlength_mm = 120\n[tools.1]\nkind = \"turning\"\nnose_radius_mm = 0\n\
        outline = [{ x = 0, z = 0 }, { x = 4, z = -4 }, { x = 4, z = 4 }]\n";
    let folder = Folder::new();
    let files = |rounds| {
        let (name, out) = (format!("wave{rounds}.nc"), folder.path(&format!("out{rounds}")));
        folder.file(&format!("wave{rounds}.toml"), setup);
        let program = folder.file(&name, wave(rounds));
        let ran = turnwright(&["run", &program, "--out", &out.display().to_string(), "--no-3d"]);
        assert_eq!(ran.status, 0, "{}", ran.err);
        (ran.err.contains("T360"), support::names(&out))
    };
    let (is_told, names) = files(9_990);
    assert!(!is_told && names.iter().any(|name| name == "part.step"), "{names:?}");
    let (is_told, names) = files(10_010);
    assert!(is_told && names.iter().any(|name| name == "part.dxf"), "{names:?}");
    for solid in ["part.step", "part.stl", "part.glb"] {
        assert!(names.iter().all(|name| name != solid), "{names:?}");
    }
}

#[test]
fn run_reports_and_writes_its_folder() {
    let folder = Folder::new();
    let program = folder.file("part.nc", ALARMS);
    let out = folder.path("new/report");
    let ran = turnwright(&["run", &program, "--out", &out.display().to_string()]);
    assert_eq!(ran.status, 1, "{}", ran.err);
    assert_eq!(
        support::names(&out),
        [
            "part.dxf",
            "part.glb",
            "part.step",
            "part.stl",
            "part.svg",
            "path.dxf",
            "path.png",
            "path.svg",
            "report.html",
            "time.svg",
            "times.csv",
            "trace.jsonl"
        ]
    );
    assert!(ran.out.contains("fanuc-0i-tf, the default"), "{}", ran.out);
    assert!(ran.out.contains("stopped the program at line 6"), "{}", ran.out);
    let read = |name: &str| std::fs::read(out.join(name)).expect(name);
    assert!(read("path.png").starts_with(b"\x89PNG"));
    assert!(
        String::from_utf8_lossy(&read("path.svg")).starts_with("<svg")
            || read("path.svg").starts_with(b"<?xml")
    );
    let page = String::from_utf8(read("report.html")).expect("UTF-8");
    assert!(page.trim_end().ends_with("</html>") && page.contains("PS0062"));
    let trace = String::from_utf8(read("trace.jsonl")).expect("UTF-8");
    assert_eq!(trace, turnwright(&["trace", &program]).out);

    let json = turnwright(&["run", &program, "--format", "json"]);
    let report: Value = serde_json::from_str(&json.out).expect("one object");
    assert_eq!(report["control"], "fanuc-0i-tf");
    assert_eq!(report["control_reason"]["key"], "default");
    assert_eq!(report["diagnostics"][0]["id"], "PS0062");
    assert!(report["time"]["total_s"].as_f64().expect("a time") > 0.0);
    assert!(report["operations"][0]["seconds"].is_number());
    assert_eq!(json.err, "");
}

#[test]
fn plot_writes_the_picture_that_its_name_asks_for() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    for (name, head) in [("a.svg", b"<svg".as_slice()), ("b.PNG", b"\x89PNG"), ("c.dxf", b"AC1009")] {
        let picture = folder.path(name);
        let ran = turnwright(&["plot", &program, "-o", &picture.display().to_string()]);
        assert_eq!(ran.status, 0, "{}", ran.err);
        let bytes = std::fs::read(&picture).expect("the picture");
        assert!(bytes.windows(head.len()).take(200).any(|part| part == head), "{name}");
    }
    assert_eq!(turnwright(&["plot", &program, "-o", "c.jpg"]).status, 2);
    assert_eq!(turnwright(&["plot", &program]).status, 2);
}

#[test]
fn a_part_is_written_in_the_form_that_its_name_asks_for() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    let written = |name: &str, more: &[&str]| {
        let target = folder.path(name).display().to_string();
        let ran = turnwright(&[&["part", &program, "-o", &target], more].concat());
        assert_eq!(ran.status, 0, "{}", ran.err);
        std::fs::read(&target).expect(name)
    };
    for (name, head) in [
        ("a.svg", b"<svg".as_slice()),
        ("a.PNG", b"\x89PNG"),
        ("a.step", b"ISO-10303-21;"),
        ("a.STP", b"ISO-10303-21;"),
        ("a.stl", b"turnwright, mm, within 0.01 mm"),
        ("a.glb", b"glTF"),
        ("a.dxf", b"999\nturnwright: half-section"),
    ] {
        assert!(written(name, &[]).starts_with(head), "{name}");
    }
    let [coarse, usual, fine] =
        ["1", "0.01", "0.0001"].map(|chord| written("b.stl", &["--chord", chord]).len());
    assert!(coarse < usual && usual < fine && usual == written("b.stl", &[]).len());
    // The same program gives the same bytes.
    assert_eq!(written("a.step", &[]), written("a.step", &[]));
    for (name, chord) in [("a.obj", "0.01"), ("a", "0.01"), ("a.stl", "0"), ("a.stl", "10.1"), ("a.stl", "x")]
    {
        assert_eq!(turnwright(&["part", &program, "-o", name, "--chord", chord]).status, 2, "{name} {chord}");
    }
    assert_eq!(turnwright(&["part", &program]).status, 2);
}

#[test]
fn no_part_is_an_error_with_its_reason() {
    let folder = Folder::new();
    let program = folder.file("air.nc", "O1\nG0 X50. Z2.\nM30\n");
    let target = folder.path("a.step");
    let ran = turnwright(&["part", &program, "-o", &target.display().to_string()]);
    assert_eq!(ran.status, 1, "{}", ran.err);
    assert!(ran.err.contains("error[T361]") && !target.exists(), "{}", ran.err);
}

#[test]
fn motion_is_a_table_that_ends_where_the_program_does() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    let ran = turnwright(&["motion", &program, "--rate", "200"]);
    assert_eq!(ran.status, 0, "{}", ran.err);
    let mut lines = ran.out.lines();
    assert_eq!(lines.next(), Some("time_s,x_mm,z_mm,path_mm_per_s,rpm,turns,kind,line"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    // Five milliseconds apart, and at the end on X60 Z5 with 500 rpm, the rapid of line 6.
    assert_eq!((rows[1][0], rows[2][0]), ("0.005", "0.01"));
    let last = rows.iter().rev().find(|row| row[6] == "rapid").expect("a rapid");
    assert_eq!((last[1], last[2], last[4], last[7]), ("60", "5", "500", "6"));
    let table = folder.path("samples.csv");
    let ran = turnwright(&["motion", &program, "--rate", "200", "-o", &table.display().to_string()]);
    assert_eq!((ran.status, ran.out.as_str()), (0, ""));
    assert_eq!(std::fs::read_to_string(&table).expect("the table").lines().count(), rows.len() + 1);
    assert_eq!(turnwright(&["motion", &program, "--rate", "0"]).status, 2);
    // For data programs; its cells are compared with these in tests-browser/samples.test.mjs.
    let table = folder.path("samples.parquet");
    let ran = turnwright(&["motion", &program, "--rate", "200", "-o", &table.display().to_string()]);
    assert_eq!((ran.status, ran.out.as_str()), (0, ""));
    let bytes = std::fs::read(&table).expect("the table");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    let ran = turnwright(&["motion", &program, "-o", &folder.path("samples.xls").display().to_string()]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains(".csv or .parquet"), "{}", ran.err);
}

/// Seconds with nine decimals as whole nanoseconds.
fn nanoseconds(text: &str) -> u128 {
    let (seconds, rest) = text.split_once('.').expect("a point");
    assert_eq!(rest.len(), 9, "{text}");
    seconds.parse::<u128>().expect("seconds") * 1_000_000_000 + rest.parse::<u128>().expect("nanoseconds")
}

#[test]
fn the_times_of_every_example_add_up_by_block_and_by_cause() {
    let folder = Folder::new();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let all = folder.path("all.csv").display().to_string();
    let ran = turnwright(&["time", examples, "-o", &all, "--format", "json"]);
    let document: Value = serde_json::from_str(&ran.out).expect("JSON");
    let programs = std::fs::read_to_string(&all).expect("a table");
    let mut sum = 0;
    for (row, program) in programs.lines().skip(1).zip(document["programs"].as_array().expect("programs")) {
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!(cells[0], program["file"]);
        let total = nanoseconds(cells[1]);
        assert_eq!(cells[2..12].iter().map(|cell| nanoseconds(cell)).sum::<u128>(), total, "{row}");
        let table = folder.path("one.csv").display().to_string();
        turnwright(&["time", cells[0], "-o", &table]);
        let blocks = std::fs::read_to_string(&table).expect("a table");
        let mut of_blocks = 0;
        for block in blocks.lines().skip(1) {
            let cells: Vec<&str> = block.split(',').collect();
            assert_eq!(nanoseconds(cells[0]), of_blocks, "{block}");
            let causes: u128 = cells[2..12].iter().map(|cell| nanoseconds(cell)).sum();
            assert_eq!(nanoseconds(cells[1]), causes, "{block}");
            of_blocks += causes;
        }
        assert_eq!(of_blocks, total, "{row}");
        sum += total;
    }
    assert!((document["time"]["total_s"].as_f64().expect("seconds") - sum as f64 / 1e9).abs() < 1e-6);
    assert!(document["programs"].as_array().expect("programs").len() > 20 && ran.status == 1);
}

#[test]
fn time_counts_what_the_shop_knows_and_tells_of_alarms() {
    let folder = Folder::new();
    let setup = folder.file(
        "shop.toml",
        "[rates]\ntool_change_s = 3\nstop_s = 20\nbar_feed_s = 8\nauxiliary_m_s = { 10 = 2.5 }\n",
    );
    let file = folder.file("part.nc", "T0101\nM10\nM11\nM01\nM00\nM30\n");
    let time = |more: &[&str]| -> Value {
        let ran = turnwright(&[&["time", &file, "--setup", &setup, "--format", "json"], more].concat());
        serde_json::from_str::<Value>(&ran.out).expect("JSON")["time"].clone()
    };
    let seconds = |time: &Value, name: &str| time[name].as_f64().expect("seconds");
    let plain = time(&[]);
    assert_eq!(seconds(&plain, "tool_change_s"), 3.0);
    assert_eq!((seconds(&plain, "stop_s"), seconds(&plain, "loading_s")), (20.0, 8.0));
    assert!((seconds(&plain, "other_s") - 2.7).abs() < 1e-9);
    assert_eq!(seconds(&time(&["--optional-stop"]), "stop_s"), 40.0);
    let alarms = folder.file("alarms.nc", ALARMS);
    let ran = turnwright(&["time", &file, &alarms, "--lang", "en"]);
    assert_eq!(ran.status, 1);
    assert!(ran.err.contains("alarm[PS0062]"), "{}", ran.err);
    assert!(ran.out.contains("until the alarm in line 6") && ran.out.contains("all 2"), "{}", ran.out);
    assert_eq!(turnwright(&["time", &file, &alarms, "-o", "x.svg"]).status, 2);
    assert_eq!(turnwright(&["time", "missing.nc"]).status, 2);
}

#[test]
fn advice_is_a_section_of_its_own_and_no_warning() {
    let folder = Folder::new();
    let setup = folder
        .file("a.toml", "[stock]\ndiameter_mm = 50\nlength_mm = 80\n[tools.1]\ninsert = \"CNMG120408\"\n");
    let program =
        "T0101\nG97 S1000 M03\nG99 G00 X46. Z20.\nG01 Z-30. F0.2\nX52.\nG00 X80. Z50.\nM05\nT0100\nM30\n";
    let file = folder.file("a.nc", program);
    for command in ["run", "time"] {
        let ran = turnwright(&[command, &file, "--setup", &setup, "--lang", "en", "--deny", "warnings"]);
        assert_eq!(ran.status, 0, "{}", ran.err);
        assert!(ran.out.contains("time that could be saved") && ran.out.contains("T391"), "{}", ran.out);
        let ran = turnwright(&[command, &file, "--setup", &setup, "--format", "json"]);
        let document: Value = serde_json::from_str(&ran.out).expect("JSON");
        let advice = if command == "run" { &document["advice"] } else { &document["programs"][0]["advice"] };
        assert_eq!((&advice[0]["id"], &advice[0]["line"]), (&Value::from("T391"), &Value::from(4)));
        assert!((advice[0]["seconds"].as_f64().expect("seconds") - 5.4).abs() < 0.5);
    }
}

#[test]
fn a_thread_with_a_short_lead_in_is_told_what_it_needs() {
    // Lead 1.5 at 1200 rpm: 3.6 mm for a lead that is right to a hundredth.
    let folder = Folder::new();
    let thread = |z: &str, rpm: &str| {
        format!("O0001\nT0101\nG97 S{rpm} M03\nG00 X20. Z{z}\nG32 Z-20. F1.5\nG00 X30.\nM30\n")
    };
    let short = turnwright(&["run", &folder.file("a.nc", thread("2.", "1200")), "--format", "json"]);
    assert!(short.out.contains("it needs 3.6 mm of lead-in and has 2.0 mm"), "{}", short.out);
    for (z, rpm) in [("4.", "1200"), ("2.", "600")] {
        let fine = turnwright(&["run", &folder.file("b.nc", thread(z, rpm)), "--format", "json"]);
        assert!(!fine.out.contains("of lead-in"), "{}", fine.out);
    }
}

#[test]
fn standard_input_is_a_program() {
    let ran = turnwright_with_input(&["check", "-", "--format", "json"], ALARMS.as_bytes());
    assert_eq!(ran.status, 1);
    assert_eq!(json_lines(&ran.out)[0]["file"], "-");
    let ran = turnwright_with_input(&["trace", "-"], CLEAN.as_bytes());
    assert_eq!((ran.status, json_lines(&ran.out).last().expect("a line")["op"].clone()), (0, "end".into()));
}

#[test]
fn the_control_is_chosen_in_the_promised_order() {
    let folder = Folder::new();
    let control = |ran: &Ran| {
        let report: Value = serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{ran:?}"));
        (report["control"].as_str().unwrap_or("").to_string(), report["control_reason"]["key"].clone())
    };
    let plain = folder.file("plain.nc", CLEAN);
    let run = |file: &str, more: &[&str]| {
        control(&turnwright(&[&["run", file, "--format", "json"], more].concat()))
    };
    assert_eq!(run(&plain, &[]), ("fanuc-0i-tf".to_string(), "default".into()));
    // A file of the same stem is found by itself.
    folder.file("plain.toml", "control = \"gsk-988ta\"\n");
    assert_eq!(run(&plain, &[]), ("gsk-988ta".to_string(), "setup".into()));
    let named = folder.file("named.nc", format!("O0001 (Control GSK_980TDi)\n{CLEAN}"));
    folder.file("named.toml", "control = \"gsk-988ta\"\n");
    assert_eq!(run(&named, &[]), ("gsk-980tdi".to_string(), "directive".into()));
    assert_eq!(run(&named, &["--control", "fanuc-0i-td"]), ("fanuc-0i-td".to_string(), "option".into()));
    let other = folder.file("shop.toml", "control = \"fanuc-0i-tc\"\n");
    assert_eq!(run(&plain, &["--setup", &other]), ("fanuc-0i-tc".to_string(), "setup".into()));
    // A remark is no directive.
    let remark = folder.file("remark.nc", format!("(PROFILE TURNING)\n{CLEAN}"));
    assert_eq!(run(&remark, &[]), ("fanuc-0i-tf".to_string(), "default".into()));
}

#[test]
fn wrong_names_are_answered_with_the_nearest() {
    let folder = Folder::new();
    let program = folder.file("part.nc", CLEAN);
    let ran = turnwright(&["run", &program, "--control", "fanuc-0i-tff"]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("did you mean fanuc-0i-tf?"), "{}", ran.err);
    let ran = turnwright(&["check", &program, "--param", "3401#9=1"]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("did you mean 3401#"), "{}", ran.err);
    assert_eq!(turnwright(&["check", &program, "--param", "3401#0=2"]).status, 2);
    assert_eq!(turnwright(&["check", &program, "--param", "3401"]).status, 2);
    assert_eq!(turnwright(&["check", &program, "--skip", "10"]).status, 2);
    let directive = folder.file("odd.nc", format!("(CONTROL fanuc-0i-tff)\n{CLEAN}"));
    let ran = turnwright(&["check", &directive]);
    assert_eq!(ran.status, 1);
    assert!(ran.err.contains("odd.nc:1:1") && ran.err.contains("fanuc-0i-tf"), "{}", ran.err);
    let ran = turnwright(&["explain", "cut-depth-ilegal"]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("cut-depth-illegal"), "{}", ran.err);
    assert_eq!(turnwright(&["controls", "fanuk"]).status, 2);
}

#[test]
fn parameters_come_from_the_setup_and_then_from_the_options() {
    let folder = Folder::new();
    let program = folder.file("part.nc", "O1\nG00 X100 Z1.\nM30\n");
    let x = |more: &[&str]| {
        let ran = turnwright(&[&["trace", program.as_str()], more].concat());
        json_lines(&ran.out).iter().find(|line| line["op"] == "rapid").map(|line| line["x"].clone())
    };
    assert_eq!(x(&[]), Some(0.1.into()));
    assert_eq!(x(&["--param", "3401#0=1"]), Some(100.into()));
    folder.file("part.toml", "[parameters]\n\"3401#0\" = 1\n");
    assert_eq!(x(&[]), Some(100.into()));
    assert_eq!(x(&["--param", "3401#0=0"]), Some(0.1.into()));
}

#[test]
fn switches_of_the_machine_are_heeded() {
    let program = b"O1\n/G00 X1. Z1.\n/2 G00 X2. Z2.\nM01\nM30\n";
    let ops = |more: &[&str]| -> Vec<String> {
        let ran = turnwright_with_input(&[&["trace", "-"], more].concat(), program);
        json_lines(&ran.out)
            .iter()
            .skip(1)
            .map(|line| line["op"].as_str().unwrap_or("").to_string())
            .collect()
    };
    assert_eq!(ops(&[]).iter().filter(|op| *op == "rapid").count(), 2);
    assert_eq!(ops(&["--skip", "2"]).iter().filter(|op| *op == "rapid").count(), 1);
    assert_eq!(ops(&["--skip", "1,2"]).iter().filter(|op| *op == "rapid").count(), 0);
}

#[test]
fn folders_are_checked_in_the_order_of_their_names() {
    let folder = Folder::new();
    for name in ["b.nc", "a/z.CNC", "a/O0002", "c.txt", "O0001"] {
        folder.file(name, ALARMS);
    }
    for name in ["a/notes.md", "c.toml", ".hidden.nc", ".git/x.nc"] {
        folder.file(name, "");
    }
    let root = folder.0.display().to_string();
    let ran = turnwright(&["check", &root, "--format", "json", "--control", "fanuc-0i-td"]);
    let files: Vec<String> = json_lines(&ran.out)
        .iter()
        .map(|line| line["file"].as_str().expect("a name").trim_start_matches(&root).to_string())
        .collect();
    assert_eq!(files, ["/O0001", "/a/O0002", "/a/z.CNC", "/b.nc", "/c.txt"]);
    let again = turnwright(&["check", &root, "--format", "json", "--control", "fanuc-0i-td"]);
    assert_eq!(ran.out, again.out);
}

#[test]
fn alarms_only_says_nothing_else() {
    let folder = Folder::new();
    let ran = turnwright(&["check", &folder.file("warns.nc", WARNS), "--alarms-only", "--format", "json"]);
    assert_eq!((ran.status, ran.out.as_str()), (0, ""));
}

#[test]
fn chinese_is_chinese_throughout() {
    let folder = Folder::new();
    let program = folder.file("part.nc", ALARMS);
    let warns = folder.file("warns.nc", WARNS);
    for arguments in [
        vec!["check", &program, &warns, "missing.nc", "--lang", "zh"],
        vec!["run", &program, "--lang", "zh"],
        vec!["run", &warns, "--lang", "zh"],
        vec!["explain", "G71", "--lang", "zh"],
        vec!["explain", "PS0062", "--lang", "zh"],
        vec!["explain", "3401#0", "--lang", "zh"],
        vec!["explain", "G777", "--lang", "zh"],
        vec!["check", &warns, "--param", "3401#9=1", "--lang", "zh"],
    ] {
        let ran = turnwright(&arguments);
        let said = format!("{}{}", ran.out, ran.err);
        for english in [
            "alarm", "warning", "error", "note", "cause", "cure", "help", "mean", "file", "program", "time",
            "the ",
        ] {
            // File names and options are the user's own words.
            let words = said.replace("alarms.nc", "").replace("warns.nc", "");
            assert!(!words.contains(english), "{arguments:?} says {english:?}: {said}");
        }
    }
    let ran = turnwright(&["check", &program, "--lang", "zh"]);
    for word in ["报警[PS0062]", "原因: ", "处理: ", "1 个文件，1 个报警"] {
        assert!(ran.err.contains(word), "{word}: {}", ran.err);
    }
    let by_environment =
        support::command(&["check", &program]).env("LANG", "zh_CN.UTF-8").output().expect("it starts");
    assert_eq!(String::from_utf8_lossy(&by_environment.stderr), ran.err);
}

#[test]
fn explain_answers_every_kind_of_question() {
    for (code, says) in [
        ("G71", "rough turning"),
        ("g01", "straight cut"),
        ("M03", "spindle forward"),
        ("PS0062", "depth"),
        ("062", "depth"),
        ("62", "depth"),
        ("cut-depth-illegal", "PS0062"),
        ("5130", "run-out"),
        ("3401#0", "point"),
        ("T043", "semicolon"),
        ("rough-turning", "G71"),
    ] {
        let ran = turnwright(&["explain", code]);
        assert_eq!(ran.status, 0, "{code}: {}", ran.err);
        assert!(ran.out.contains(says), "{code}: {}", ran.out);
        let json = turnwright(&["explain", code, "--format", "json"]);
        assert!(serde_json::from_str::<Value>(&json.out).expect("JSON").is_array(), "{code}");
    }
}

#[test]
fn controls_are_listed_shown_and_compared() {
    let names: Value =
        serde_json::from_str(&turnwright(&["controls", "--format", "json"]).out).expect("JSON");
    assert_eq!(names.as_array().map(Vec::len), Some(8));
    let list = turnwright(&["controls"]);
    assert!(list.out.contains("gsk-980tdc") && list.out.contains("(default)"), "{}", list.out);
    let one = turnwright(&["controls", "gsk-980tdi"]);
    assert!(one.out.contains("decimal-rule") && one.out.contains("always-calculator"), "{}", one.out);
    let same = turnwright(&["controls", "--diff", "fanuc-0i-tf", "fanuc-0i-tf"]);
    assert_eq!(same.out, "no difference is known\n");
    let ran = turnwright(&["controls", "--diff", "fanuc-0i-tf", "gsk-980tdi", "--format", "json"]);
    let differences: Value = serde_json::from_str(&ran.out).expect("JSON");
    let of_section = |section: &str| -> Vec<&Value> {
        let list = differences["differences"].as_array().expect("a list").iter();
        list.filter(|one| one["section"] == section).collect()
    };
    for section in ["policies", "limits", "codes", "parameters", "parameter-numbers", "alarm-numbers"] {
        assert!(!of_section(section).is_empty(), "{section}");
    }
    let names_the_alarm = |list: Vec<&Value>| list.iter().any(|one| one["name"] == "cut-depth-illegal");
    assert!(names_the_alarm(of_section("alarm-numbers")));
    // 062 and PS0062 are one number in two spellings.
    let ran = turnwright(&["controls", "--diff", "fanuc-0i-mate-tb", "fanuc-0i-tf"]);
    assert!(!ran.out.contains("cut-depth-illegal"), "{}", ran.out);
    assert!(ran.out.contains("alarm-ids"), "{}", ran.out);
    assert!(ran.out.contains("arc-end-error") && ran.out.contains("spiral"), "{}", ran.out);
    let chinese = turnwright(&["controls", "--diff", "fanuc-0i-tf", "gsk-980tdi", "--lang", "zh"]);
    assert!(chinese.out.contains("编号不同的参数"), "{}", chinese.out);
}

#[test]
fn every_command_has_help_with_an_example() {
    for command in [
        "run",
        "check",
        "trace",
        "plot",
        "part",
        "measure",
        "diff",
        "explain",
        "controls",
        "data",
        "completions",
        "man",
    ] {
        let ran = turnwright(&[command, "--help"]);
        assert_eq!(ran.status, 0, "{command}");
        assert!(ran.out.contains(&format!("  turnwright {command}")), "{command}: {}", ran.out);
    }
    assert!(turnwright(&["--help"]).out.contains("Exit status:"));
    assert!(turnwright(&["completions", "bash"]).out.contains("turnwright"));
    assert!(turnwright(&["man"]).out.contains(".TH turnwright"));
    assert!(turnwright(&["man", "check"]).out.contains("check"));
}

#[test]
fn gears_of_a_setup_change_the_speed_the_ramp_and_the_time_of_the_spindle() {
    let folder = Folder::new();
    let program = folder.file("gears.nc", "O1\nG97 S2000 M03\nM42\nM05\nM30\n");
    let setup = folder.file(
        "gears.toml",
        "control = \"fanuc-0i-tf\"\n[rates]\nauxiliary_s = 0\ngear_change_s = 1.5\n\
         gears = [{ rpm_max = 800, ramp_rpm_per_s = 500 }, { rpm_min = 600, rpm_max = 4000 }]\n",
    );
    let spindle_s = |arguments: &[&str]| {
        let ran =
            turnwright(&[&["time", &program, "--format", "json", "--setup", &setup], arguments].concat());
        let document: Value = serde_json::from_str(&ran.out).expect("JSON");
        document["programs"][0]["time"]["spindle_s"].as_f64().expect("seconds")
    };
    // Up to 800 at 500 rpm/s 1.6; down 1.6, change 1.5, up to 2000 at 1000 rpm/s 2; to standstill 2.
    let seconds = spindle_s(&[]);
    assert!((seconds - 8.7).abs() < 1e-9, "{seconds}");
    let ran = turnwright(&["check", &program, "--setup", &setup]);
    assert!(ran.err.contains("T088"), "{}", ran.err);
    // 3742 holds gear 2 at 1500: 1.6 + 1.6 + 1.5 + 1.5 + 1.5.
    assert!((spindle_s(&["--param", "3742=1500"]) - 7.7).abs() < 1e-9);
    let wrong =
        folder.file("wrong.toml", "[rates]\ngears = [{ rpm_max = 800 }, { m = 41, rpm_max = 900 }]\n");
    let ran = turnwright(&["time", &program, "--setup", &wrong]);
    assert_eq!(ran.status, 2);
    assert!(ran.err.contains("gears, number 1: each gear has an M code of its own"), "{}", ran.err);
}

#[test]
fn cuts_wait_for_the_speed_where_the_parameter_says_so() {
    let folder = Folder::new();
    let program = folder.file("wait.nc", "O1\nG97 S1000 M03\nG00 X50. Z2.\nG01 Z-10. F0.2\nG00 X60.\nM30\n");
    let setup = folder.file("wait.toml", "control = \"fanuc-0i-tf\"\n[rates]\nspeed_wait = \"thread\"\n");
    let waited_s = |arguments: &[&str]| {
        let arguments = [&["time", &program, "--format", "json", "--setup", &setup], arguments].concat();
        let document: Value = serde_json::from_str(&turnwright(&arguments).out).expect("JSON");
        document["programs"][0]["time"]["spindle_wait_s"].as_f64().expect("seconds")
    };
    assert_eq!(waited_s(&[]), 0.0);
    // The rapid takes 1.6214 s, more than the ramp: the control sees the speed at once, or when 3740 is over.
    assert_eq!(waited_s(&["--param", "3708#0=1"]), 0.0);
    let late = waited_s(&["--param", "3708#0=1", "--param", "3740=5000"]);
    assert!((late - (5.0 - 1.621_388_889)).abs() < 1e-6, "{late}");
}

#[test]
fn a_rigid_tap_is_timed_with_the_ramps_of_the_spindle() {
    let folder = Folder::new();
    let program = folder.file("tap.nc", "O1\nG99 G00 X0 Z10.\nM29 S300\nG84 Z-15. R-5. F1.5\nG80\nM30\n");
    let setup = folder.file("tap.toml", "control = \"fanuc-0i-tf\"\n");
    let ran = turnwright(&["time", &program, "--format", "json", "--setup", &setup]);
    let document: Value = serde_json::from_str(&ran.out).expect("JSON");
    let time = |key: &str| document["programs"][0]["time"][key].as_f64().expect("seconds");
    // Twice 13.33 turns at 5 a second, and twice half of the two ramps of 0.3 s.
    assert!((time("threading_s") - 16.0 / 3.0).abs() < 1e-6, "{document}");
    assert!((time("spindle_wait_s") - 0.6).abs() < 1e-3 && time("spindle_s") == 0.0, "{document}");
    // It needs no way to get into step: 5 mm in front of Z0 are enough at any lead.
    let steep = folder.file("steep.nc", "O1\nG99 G00 X0 Z10.\nM29 S2000\nG84 Z-40. R-8. F3.\nG80\nM30\n");
    let ran = turnwright(&["run", &steep, "--setup", &setup]);
    assert!(!ran.err.contains("T081"), "{}", ran.err);
}

#[test]
fn a_spindle_that_cannot_have_its_speed_in_the_time_of_g26_is_an_alarm() {
    let folder = Folder::new();
    let setup = folder.file("watch.toml", "control = \"fanuc-0i-tf\"\n");
    let run = |delay: u32| {
        let text = format!("O1\nG26 P{delay} Q5 R10 I50\nG97 S2000 M03\nM05\nM30\n");
        turnwright(&["run", &folder.file("watch.nc", &text), "--setup", &setup])
    };
    // 1000 rpm/s: 500 rpm behind half a second; within 10 % of 2000 behind 1.8.
    let ran = run(500);
    assert_eq!(ran.status, 1, "{}", ran.err);
    assert!(ran.err.contains("alarm[OH0704]: The spindle turns 500 rpm where 2000"), "{}", ran.err);
    assert!(ran.err.contains("watch.nc:3:1"), "{}", ran.err);
    assert_eq!(run(1799).status, 1);
    let ran = run(1800);
    assert!(ran.status == 0 && !ran.err.contains("OH0704"), "{}", ran.err);
}

#[test]
fn the_watch_judges_a_spindle_that_wobbles() {
    let folder = Folder::new();
    // Q 15 % counts as reached, R 5 % is permitted from then on, 50 rpm at least.
    let text = "O1\nG97 S2000 M03\nG04 X3.\nG26 P3000 Q15 R5 I50\nS1000\nS500\nM05\nM30\n";
    let program = folder.file("wobble.nc", text);
    let run = |percent: &str| {
        let text = format!("control = \"fanuc-0i-tf\"\n[rates]\nfluctuation_percent = {percent}\n");
        turnwright(&["run", &program, "--setup", &folder.file("wobble.toml", text)])
    };
    // 5 % of 2000 are 100 rpm; of 500 the band of 50 rpm counts.
    let fine = run("5.0");
    assert!(fine.status == 0 && !fine.err.contains("OH0704"), "{}", fine.err);
    let ran = run("5.1");
    assert!(ran.status == 1 && ran.err.contains("The spindle turns 1898 rpm where 2000"), "{}", ran.err);
    assert!(ran.err.contains("wobble.nc:4:1"), "{}", ran.err);
    let wrong = run("60");
    assert!(wrong.status == 2 && wrong.err.contains("fluctuation_percent"), "{}", wrong.err);
}

#[test]
fn check_and_time_tell_what_the_clock_shows_as_run_does() {
    let folder = Folder::new();
    let setup = folder.file("clock.toml", "control = \"fanuc-0i-tf\"\n");
    let text = "O1\nG26 P500 Q5 R10 I50\nG97 S2000 M03\nG00 X20. Z0.5\nG32 Z-10. F2.\nG00 X40.\nM30\n";
    let program = folder.file("clock.nc", text);
    for command in ["run", "check", "time"] {
        let ran = turnwright(&[command, &program, "--setup", &setup]);
        assert_eq!(ran.status, 1, "{command}: {}", ran.err);
        assert!(ran.err.contains("alarm[OH0704]"), "{command}: {}", ran.err);
        assert_eq!(ran.err.contains("T081"), command != "time", "{command}: {}", ran.err);
    }
    let ran = turnwright(&["check", "--alarms-only", &program, "--setup", &setup]);
    assert!(ran.status == 0 && !ran.err.contains("OH0704"), "{}", ran.err);
}
