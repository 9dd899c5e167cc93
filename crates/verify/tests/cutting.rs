//! Cutting data beside what a machinist works out on paper.

mod support;

use turnwright_control::{Setup, material};
use turnwright_motion::{MachineRates, Schedule};
use turnwright_stock::machining::RapidRates;
use turnwright_verify::cutting::{CuttingData, CuttingRun, Quantity, ra_of, specific_force_n_per_mm2};
use turnwright_verify::part::PartRun;

const STOCK: &str = "[stock]\ndiameter_mm = 50\nlength_mm = 80\nmaterial = \"45\"\n";

fn data(text: &str, setup: &str) -> CuttingData {
    let setup = Setup::parse(setup).expect("a setup");
    let run = support::run(text, "fanuc-0i-tf", &setup);
    assert_eq!(run.alarm, None);
    let rates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };
    let mut part = PartRun::new(&setup, &setup, run.start, rates).expect("a setup").expect("a stock");
    let mut cutting = CuttingRun::new(setup.tools().expect("tools"), setup.material().expect("a material"));
    let mut schedule = Schedule::new(run.start, rates_of_machine());
    let mut removed = std::collections::VecDeque::new();
    for command in run.commands {
        removed.push_back(part.add(&command));
        schedule.push(command);
    }
    schedule.finish();
    while let Some((command, timing)) = schedule.next_known() {
        cutting.add(&command, &timing, removed.pop_front().flatten().as_ref());
    }
    cutting.finish()
}

/// Slides without mass: what is worked out on paper knows no acceleration.
fn rates_of_machine() -> MachineRates {
    let machine = Setup::default().machine().expect("a machine");
    MachineRates {
        rapid_x_mm_per_min: machine.rapid_x_mm_per_min,
        rapid_z_mm_per_min: machine.rapid_z_mm_per_min,
        cutting_max_mm_per_min: machine.cutting_max_mm_per_min,
        dynamics: None,
        ..MachineRates::default()
    }
}

fn peak(data: &CuttingData, quantity: Quantity) -> f64 {
    data.peak(quantity).unwrap_or_else(|| panic!("no {quantity:?}")).0
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} instead of {expected}");
}

const TURNING: &str = "O1\nT0101\nG97 S640 M03\nG00 X46. Z2.\nG01 Z-30. F0.2\nX52.\nG00 X100. Z50.\nM30\n";

/// A sharp tool whose edge stands at an angle to the feed.
fn tool(entering_deg: f64) -> String {
    let (sine, cosine) = (20.0 * entering_deg.to_radians().sin(), 20.0 * entering_deg.to_radians().cos());
    format!(
        "{STOCK}[tools.1]\nkind = \"turning\"\nnose_radius_mm = 0\noutline = [{{ x = 0, z = 0 }}, \
         {{ x = {sine}, z = {} }}, {{ x = 2, z = 20 }}]\n",
        cosine
    )
}

#[test]
fn a_straight_edge_is_kienzle_by_hand() {
    // 2 mm deep, 0.2 mm a turn, edge square to the feed: h = 0.2, kc = 1700 · 0.2^-0.25 = 2542 N/mm²,
    // Fc = 2542 · 2 · 0.2 = 1017 N. Mean diameter 48 mm: Q = 2 · 0.2 · π · 48 · 640 / 1000 = 38.6 cm³/min,
    // P = 2542 · 38.6 / 60,000 = 1.635 kW. On 50 mm the edge sees π · 50 · 640 / 1000 = 100.5 m/min.
    let cut = data(TURNING, &tool(90.0));
    near(peak(&cut, Quantity::Depth), 2.0);
    near(peak(&cut, Quantity::Chip), 0.2);
    near(peak(&cut, Quantity::Force), 1016.8);
    near(peak(&cut, Quantity::Removal), 38.6);
    near(peak(&cut, Quantity::Power), 1.635);
    near(peak(&cut, Quantity::Speed), 100.53);
    assert_eq!(cut.peak(Quantity::Power).expect("a peak").1.line, 5);
    let steel = material("45").expect("a material");
    near(specific_force_n_per_mm2(steel, 1.0), 1700.0);
    near(specific_force_n_per_mm2(steel, 0.2), 2542.1);
}

#[test]
fn the_lead_angle_thins_the_chip() {
    // sin 60° = 0.866: h = 0.1732.
    near(peak(&data(TURNING, &tool(60.0)), Quantity::Chip), 0.173_2);
    near(peak(&data(TURNING, &tool(45.0)), Quantity::Chip), 0.141_4);
}

#[test]
fn a_nose_leaves_its_scallops() {
    // f² / 8 r = 0.04 / 6.4 mm = 6.25 µm; its mean deviation is a quarter and a little.
    let setup = format!("{STOCK}[tools.1]\ninsert = \"DNMG150408\"\n");
    let cut = data(TURNING, &setup);
    near(peak(&cut, Quantity::Roughness), 6.25);
    near(ra_of(6.25), 1.604);
    // A feed of more than twice the nose leaves threads, not scallops.
    let coarse = data(&TURNING.replace("F0.2", "F1.7"), &setup);
    assert!(coarse.peak(Quantity::Roughness).is_none());
    assert!(data(&TURNING.replace("F0.2", "F1.6"), &setup).peak(Quantity::Roughness).is_some());
}

#[test]
fn a_contour_of_short_ways_cuts_no_deeper_than_it_is_deep() {
    // A wave, a move every 0.02 mm, cut with a nose of 0.8 mm: what one move takes lies beside it, where the nose
    // touches. A flat wave leaves no more than 2.2 mm to be cut; of a steep one an edge takes slivers, no longer
    // than itself. At 0.2 mm a turn, 640 turns of a bar of 50 mm, 2.2 mm are no more than 45 cm³ a minute.
    // The wrong hand cuts with its back all the way.
    for (hand, wave_mm, depth_mm, removal_cm3_per_min) in [("R", 0.4, 2.5, 50.0), ("L", 2.0, 15.0, 400.0)] {
        let tool = format!(
            "{STOCK}[tools.1]\nkind = \"turning\"\ninsert = \"DNMG150608\"\nholder = \"PDJN{hand}2525M15\"\n"
        );
        let mut text = String::from("O1\nT0101\nG97 S640 M03\nG00 X48. Z2.\nG01 Z0. F0.2\n");
        for step in 1..1_500 {
            let angle = f64::from(step) * 0.04;
            text += &format!("X{:.3} Z-{:.3}\n", 46.0 + wave_mm * angle.cos(), f64::from(step) * 0.02);
        }
        text += "G00 X100.\nM30\n";
        let cut = data(&text, &tool);
        let (depth, place) = cut.peak(Quantity::Depth).expect("a depth");
        assert!(depth < depth_mm, "{depth} mm deep in line {}", place.line);
        let (removal, place) = cut.peak(Quantity::Removal).expect("a rate");
        assert!(removal < removal_cm3_per_min, "{removal} cm³/min in line {}", place.line);
    }
}

#[test]
fn a_blade_cuts_its_width_and_a_drill_has_two_lips() {
    let text = "O1\nT0101\nG97 S500 M03\nG00 X52. Z-20.\nG01 X40. F0.1\nG00 X60.\nM30\n";
    let blade = data(text, &format!("{STOCK}[tools.1]\nkind = \"grooving\"\nwidth_mm = 4\nreach_mm = 10\n"));
    near(peak(&blade, Quantity::Depth), 4.0);
    near(peak(&blade, Quantity::Chip), 0.1);
    let text = "O1\nT0101\nG97 S500 M03\nG00 X0 Z2.\nG01 Z-30. F0.2\nG00 Z5.\nM30\n";
    let setup = format!("{STOCK}[tools.1]\nkind = \"drilling\"\ndiameter_mm = 20\npoint_angle_deg = 120\n");
    let drill = data(text, &setup);
    // Half the feed a lip, at 60 degrees to the axis: h = 0.1 · sin 60°.
    near(peak(&drill, Quantity::Depth), 10.0);
    near(peak(&drill, Quantity::Chip), 0.086_6);
}

#[test]
fn without_a_material_there_is_no_force_and_air_is_no_cut() {
    let setup = tool(90.0).replace("material = \"45\"\n", "");
    let cut = data(TURNING, &setup);
    assert!(cut.peak(Quantity::Force).is_none() && cut.peak(Quantity::Power).is_none());
    near(peak(&cut, Quantity::Removal), 38.6);
    // The way out is in the air.
    assert_eq!(cut.lines.iter().map(|line| line.line).collect::<Vec<_>>(), [5]);
    let air = data("O1\nT0101\nG97 S640 M03\nG00 X56. Z2.\nG01 Z-30. F0.2\nM30\n", &setup);
    assert!(air.lines.is_empty() && air.course.is_empty());
}
