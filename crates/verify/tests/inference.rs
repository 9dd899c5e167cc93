//! What programs show of the setup that they were written for.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::path::Path;

use support::run;
use turnwright_control::{Setup, ToolKind, ToolSide, control_names};
use turnwright_verify::{Inference, Inferred};

const CONTROL: &str = "fanuc-0i-tf";

fn infer(text: &str, control: &str, setup: &Setup) -> Inferred {
    let run = run(text, control, setup);
    let mut inference = Inference::new(run.start);
    run.commands.iter().for_each(|command| inference.add(command));
    inference.finish(setup)
}

fn inferred(text: &str) -> Inferred {
    let given = Setup::default();
    let inferred = infer(text, CONTROL, &given);
    inferred.setup.check().unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
    inferred
}

/// Diameter, bore, length and face of the stock.
fn stock(inferred: &Inferred) -> (f64, Option<f64>, f64, f64) {
    let stock = inferred.setup.stock.as_ref().expect("stock");
    (stock.diameter_mm.expect("a bar"), stock.bore_mm, stock.length_mm.expect("a length"), stock.face_mm)
}

fn kinds(inferred: &Inferred) -> Vec<(u32, ToolKind, ToolSide)> {
    let tools = inferred.setup.tools().expect("tools");
    tools.into_iter().map(|(station, tool)| (station, tool.kind, tool.side)).collect()
}

#[test]
fn a_shaft_from_the_bar_has_its_stock_and_its_tools() {
    let shaft = inferred(
        "O1\nT0101\nG97 S800 M03\nG00 X52. Z0.\nG01 X-1.6 F0.2\nG00 X52. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.25\n\
         N10 G00 X20.\nG01 Z-20. F0.15\nX30. Z-30.\nZ-45.\nN20 X50.\nG70 P10 Q20\nG00 X100. Z100.\n\
         T0202\nG00 X32. Z-40.\nG01 X24. F0.08\nG00 X32.\nX100. Z100.\n\
         T0303\nG00 X24. Z4.\nG92 X19.2 Z-18. F1.5\nX18.4\nG00 X100. Z100.\n\
         T0404\nG00 X52. Z-50.\nG01 X-0.5 F0.06\nG00 X52.\nX100. Z100.\nM30\n",
    );
    // Cycle and facing start at X52. The face is cut to Z0 once: a millimetre is taken to stand in front of it.
    assert_eq!(stock(&shaft), (52.0, None, 76.0, 1.0));
    let outside = ToolSide::Outside;
    assert_eq!(
        kinds(&shaft),
        [
            (1, ToolKind::Turning, outside),
            (2, ToolKind::Grooving, outside),
            (3, ToolKind::Threading, outside),
            (4, ToolKind::CutOff, outside)
        ]
    );
    // Rising towards the chuck: the strongest insert will do.
    assert_eq!(shaft.setup.tools["1"].insert.as_deref(), Some("CNMG120404"));
    let of = |section: &str, key: &str| {
        shaft.assumptions.iter().any(|one| one.section == section && one.key == key)
    };
    for key in ["diameter_mm", "length_mm", "face_mm"] {
        assert!(of("stock", key), "{key}");
    }
    for (section, key) in
        [("chuck", ""), ("tools.1", "insert"), ("tools.2", "width_mm"), ("tools.3", "thread_angle_deg")]
    {
        assert!(of(section, key), "{section} {key}");
    }
}

#[test]
fn bores_are_told_from_the_way_the_tool_leaves_its_cuts() {
    let drilled = inferred(
        "O1\nT0505\nG97 S500 M03\nG00 X0. Z3.\nG74 R1.\nG74 Z-40. Q8000 F0.15\nG00 X100. Z100.\n\
         T0606\nG00 X18. Z2.\nG71 U1. R0.3\nG71 P10 Q20 U-0.4 W0.1 F0.2\nN10 G00 X30.\nG01 Z-10. F0.1\nX24.\nZ-35.\nN20 X18.\n\
         G70 P10 Q20\nG00 Z2.\nX100. Z100.\nM30\n",
    );
    assert_eq!(
        kinds(&drilled),
        [(5, ToolKind::Drilling, ToolSide::Outside), (6, ToolKind::Turning, ToolSide::Inside)]
    );
    // The bar begins at X18 less the allowance: the drill leaves that much. As there is a drill, the stock is solid.
    assert_eq!(drilled.setup.tools["5"].diameter_mm, Some(17.6));
    let (_, bore, _, _) = stock(&drilled);
    assert_eq!(bore, None);
    assert_eq!(drilled.setup.tools["6"].shank_mm, Some(12.0));
    let tube =
        inferred("O1\nT0606\nG97 S500 M03\nG00 X26. Z2.\nG90 X30. Z-35. F0.2\nX33.\nG00 X100. Z100.\nM30\n");
    assert_eq!(kinds(&tube), [(6, ToolKind::Turning, ToolSide::Inside)]);
    assert_eq!(stock(&tube).1, Some(26.0));
}

#[test]
fn slopes_ask_for_slim_inserts_and_the_other_way_for_the_other_hand() {
    let insert = |cuts: &str| {
        let text =
            format!("O1\nT0101\nG97 S800 M03\nG00 X52. Z2.\nG01 Z-5. F0.2\n{cuts}G00 X100.\nZ100.\nM30\n");
        let setup = inferred(&text).setup;
        let tool = &setup.tools["1"];
        (tool.insert.clone().expect("an insert"), setup.tools().expect("tools")[&1].tip)
    };
    // Down 10 mm of radius over 20: 26.6 degrees. Over 10: 45. Over 5: 63.4.
    assert_eq!(insert("G01 X32. Z-25.\n"), ("DNMG150404".to_string(), 3));
    assert_eq!(insert("G01 X32. Z-15.\n"), ("VNMG160404".to_string(), 3));
    assert_eq!(insert("G01 X32. Z-10.\n").0, "VNMG160404");
    assert_eq!(insert("G00 X60.\nZ-60.\nX40.\nG01 Z-6.\n").1, 4);
}

#[test]
fn taps_and_face_grooves_are_known() {
    let tapped = inferred(
        "O1\nT0707\nG97 S200 M03\nG00 X0. Z5.\nG32 Z-20. F1.5\nG32 Z5. F1.5\nG00 X100. Z100.\nM30\n",
    );
    assert_eq!(kinds(&tapped), [(7, ToolKind::Tapping, ToolSide::Outside)]);
    let face = inferred(
        "O1\nT0808\nG97 S400 M03\nG00 X40. Z2.\nG01 Z-5. F0.08\nG00 Z2.\nX36.\nG01 Z-5.\nG00 Z2.\nX100. Z100.\nM30\n",
    );
    assert_eq!(kinds(&face), [(8, ToolKind::Grooving, ToolSide::Face)]);
}

#[test]
fn what_was_given_is_kept_and_nothing_is_assumed_of_it() {
    let given = Setup::parse(
        "[stock]\ndiameter_mm = 60\nlength_mm = 100\n[chuck]\ngrip_mm = 30\n[tools.1]\ninsert = \"VBMT160404\"\n\
         [offsets.2]\ntip = 4\ngeometry = { r = 0.2 }\n",
    )
    .expect("a setup");
    let text = "O1\nT0101\nS800 M03\nG00 X52. Z2.\nG90 X40. Z-20. F0.2\nG00 X100. Z100.\n\
                T0202\nG00 X52. Z-30.\nG01 X30. F0.1\nG00 X52.\nX100. Z100.\nM30\n";
    let inferred = infer(text, CONTROL, &given);
    assert_eq!((&inferred.setup.stock, &inferred.setup.chuck), (&given.stock, &given.chuck));
    assert_eq!(inferred.setup.tools["1"], given.tools["1"]);
    assert!(inferred.assumptions.iter().all(|one| one.section == "tools.2"), "{:?}", inferred.assumptions);
    // The offset knows the nose and the tip.
    let groover = &inferred.setup.tools().expect("tools")[&2];
    assert_eq!((groover.tip, groover.nose_radius_mm), (4, 0.2));
}

#[test]
fn a_program_without_tools_or_without_cuts_is_no_trouble() {
    let bare = inferred("O1\nG97 S800 M03\nG00 X52. Z2.\nG90 X40. Z-20. F0.2\nG00 X100. Z100.\nM30\n");
    assert_eq!(kinds(&bare), [(1, ToolKind::Turning, ToolSide::Outside)]);
    let idle = inferred("O1\nT0101\nG00 X52. Z2.\nM30\n");
    assert_eq!((idle.setup, idle.assumptions.len()), (Setup::default(), 0));
}

#[test]
fn the_setup_of_every_example_reads_back_and_asks_for_nothing_more() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for folder in std::fs::read_dir(examples).expect("examples").map(|entry| entry.expect("an entry").path())
    {
        let Some(control) = folder.file_name().and_then(|name| name.to_str()) else { continue };
        if !control_names().contains(&control) {
            continue;
        }
        for file in std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path())
        {
            if file.extension().is_none_or(|extension| extension != "nc") {
                continue;
            }
            let text = std::fs::read_to_string(&file).expect("a program");
            let beside = std::fs::read_to_string(file.with_extension("toml")).unwrap_or_default();
            let given = Setup::parse(&beside).expect("a setup");
            let first = infer(&text, control, &given);
            assert!(first.setup.stock.is_some() && !first.setup.tools.is_empty(), "{}", file.display());
            let written = first.setup.to_commented_toml(&|section, key| vec![format!("{section} {key}")]);
            let read = Setup::parse(&written)
                .unwrap_or_else(|fault| panic!("{}: {fault:?}\n{written}", file.display()));
            assert_eq!(read, first.setup, "{written}");
            let again = infer(&text, control, &read);
            assert_eq!((again.setup, again.assumptions), (read, Vec::new()), "{}", file.display());
            count += 1;
        }
    }
    assert!(count >= 15, "only {count} examples found");
}
