//! The caliper: the examples' parts have the sizes of their drawings, and limits are judged at the limit and beyond.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

mod support;

use std::path::Path;

use turnwright_control::{SectionSpot, Setup};
use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::{RapidRates, ThreadHand};
use turnwright_verify::Inference;
use turnwright_verify::measuring::{self, Found, NotThere, Opening, Ring, Sizes};
use turnwright_verify::part::{Part, PartRun};

const RATES: RapidRates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };

fn part(text: &str, control: &str, given: &Setup) -> Part {
    let run = support::run(text, control, given);
    assert_eq!(run.alarm, None);
    let mut inference = Inference::new(run.start);
    run.commands.iter().for_each(|command| inference.add(command));
    let setup = inference.finish(given).setup;
    let mut part = PartRun::new(&setup, given, run.start, RATES).expect("a setup").expect("a stock");
    for command in &run.commands {
        part.add(command);
    }
    part.finish()
}

fn example(file: &str) -> (Part, Sizes) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
    let text = std::fs::read_to_string(&path).expect("an example");
    let setup = std::fs::read_to_string(path.with_extension("toml"))
        .map_or_else(|_| Setup::default(), |words| Setup::parse(&words).expect("a setup"));
    let part = part(&text, file.split('/').next().expect("a folder"), &setup);
    let sizes = Sizes::new(&part.section, &part.threads).expect("a part");
    (part, sizes)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-5
}

/// A cylinder: diameter, front and back end.
fn has_cylinder(sizes: &Sizes, diameter: f64, front: f64, back: f64) {
    let found = sizes.cylinders.iter().any(|one| {
        near(one.diameter_mm, diameter) && near(one.z_mm.0, front) && near(one.z_mm.1, back) && !one.is_inside
    });
    assert!(found, "no {diameter} from {front} to {back}: {:?}", sizes.cylinders);
}

#[test]
fn the_examples_have_the_sizes_of_their_drawings() {
    // R5 at the end, 20 mm, R3 to the face at Z-25.
    let (_, rounded) = example("fanuc-0i-mate-tb/O4001-corner-radius.nc");
    has_cylinder(&rounded, 20.0, -5.0, -22.0);
    let radii: Vec<(f64, bool)> =
        rounded.radii.iter().map(|one| ((one.radius_mm * 1e6).round() / 1e6, one.is_convex)).collect();
    assert_eq!(radii, [(5.0, true), (3.0, false)]);
    assert!(rounded.faces_mm.iter().any(|z| near(*z, -25.0)));
    // A chamfer of 2 mm at 45 degrees.
    let (_, chamfered) = example("fanuc-0i-mate-tb/O4002-corner-chamfer.nc");
    let chamfer = chamfered.tapers[0];
    assert!(near(chamfer.angle_deg(), 45.0) && near(chamfer.diameters_mm.1, 20.0), "{chamfer:?}");
    // A shaft of 15 and 30 mm with a cone between Z-15 and Z-30.
    let (_, shaft) = example("fanuc-0i-mate-tb/O4008-rough-turning.nc");
    has_cylinder(&shaft, 15.0, 0.0, -15.0);
    let cone = shaft.tapers.iter().find(|one| near(one.z_mm.1, -30.0)).expect("a cone");
    assert!(near(cone.diameters_mm.0, 15.0) && near(cone.diameters_mm.1, 30.0), "{cone:?}");
    // A groove from Z-21 to Z-50, 40 mm at its bottom, in a bar of 125 mm.
    let (_, grooved) = example("gsk-980tdi/O0008-radial-groove.nc");
    let groove = grooved.grooves[0];
    assert_eq!((grooved.grooves.len(), groove.opening), (1, Opening::Outside));
    assert!(near(groove.bottom_mm, 40.0) && near(groove.depth_mm, 42.5), "{groove:?}");
    assert!(near(groove.width_mm(), 29.0) && near(groove.bottom_width_mm, 29.0), "{groove:?}");
    assert!(near(groove.from_to_mm.0, -21.0) && near(groove.from_to_mm.1, -50.0), "{groove:?}");
}

#[test]
fn a_thread_is_measured_at_its_crest_and_its_root() {
    let (part, sizes) = example("fanuc-0i-mate-tb/O4005-thread-cycle.nc");
    let thread = &sizes.threads[0];
    // 60 degrees in 1.5 mm: a sharp crest stands 1.5 · √3 / 2 above its root; here the bar is a little thicker.
    assert_eq!((sizes.threads.len(), thread.lead_mm, thread.starts), (1, 1.5, 1));
    assert!(near(thread.minor_mm, 17.8) && near(thread.major_mm, 17.8 + 1.5 * 3f64.sqrt()), "{thread:?}");
    assert_eq!((thread.hand, thread.is_inside), (ThreadHand::Right, false));
    let spot = SectionSpot::parse("Z-10").expect("a place");
    let found = measuring::at(&part.section, &part.threads, &spot);
    assert!(matches!(&found[..], [Found::AtZ { thread: Some(_), .. }]), "{found:?}");
    // The spindle the other way round, or from the chuck outwards, makes it left-hand.
    let threading = "T0101\nG97 S300 M03\nG00 X22. Z5.\nG92 X19. Z-20. F2.\nG00 X60. Z60.\nM30\n";
    let hand = |text: &str| {
        let made = self::part(text, "fanuc-0i-tf", &Setup::default());
        Sizes::new(&made.section, &made.threads).expect("a part").threads[0].hand
    };
    assert_eq!(hand(&format!("O1\n{threading}")), ThreadHand::Right);
    assert_eq!(hand(&format!("O1\n{}", threading.replace("M03", "M04"))), ThreadHand::Left);
    assert_eq!(
        hand(&format!("O1\n{}", threading.replace("Z5.", "Z-25.").replace("Z-20. F", "Z2. F"))),
        ThreadHand::Left
    );
}

/// Tube 20 / 60 mm, 50 long; groove 4 wide at Z-30, recess 2 wide at Z-40, face groove 3 wide with a round bottom.
fn blank() -> Section {
    let mut section = Section::tube(10.0, 30.0, -50.0, 0.0).expect("a tube");
    for (low, high) in [((25.0, -34.0), (31.0, -30.0)), ((9.0, -42.0), (11.5, -40.0))] {
        let hole = Outline::rectangle(Point::new(low.0, low.1), Point::new(high.0, high.1));
        section.cut_hole(&hole.expect("a rectangle"));
    }
    let (a, b) = (Point::new(20.0, -1.5), Point::new(17.0, -1.5));
    let corner = |x: f64| Point::new(x, 1.0);
    let line = |start, end| Segment { start, end, bend: None };
    let bend = Some(Bend { centre: Point::new(18.5, -1.5), clockwise: false });
    let round = Outline::new(vec![
        line(corner(20.0), a),
        Segment { start: a, end: b, bend },
        line(b, corner(17.0)),
        line(corner(17.0), corner(20.0)),
    ]);
    section.cut_hole(&round.expect("a groove with a round bottom"));
    section
}

#[test]
fn grooves_are_found_on_every_side() {
    let sizes = Sizes::new(&blank(), &[]).expect("a part");
    let mut found: Vec<_> = sizes.grooves.clone();
    assert_eq!(found.len(), 3, "{found:?}");
    found.sort_by_key(|groove| groove.opening as u8);
    let [outside, inside, front] = found[..] else { panic!("{found:?}") };
    assert_eq!((outside.opening, outside.bottom_mm, outside.depth_mm), (Opening::Outside, 50.0, 5.0));
    assert_eq!((inside.opening, inside.bottom_mm, inside.depth_mm), (Opening::Inside, 23.0, 1.5));
    assert_eq!((inside.width_mm(), inside.bottom_width_mm), (2.0, 2.0));
    assert_eq!((front.opening, front.bottom_mm, front.depth_mm), (Opening::Front, -3.0, 3.0));
    assert_eq!((front.width_mm(), front.bottom_width_mm), (3.0, 0.0));
    // A plain tube and a shaft with steps have none.
    for section in [Section::tube(10.0, 30.0, -50.0, 0.0), Section::bar(30.0, -50.0, 0.0)] {
        let mut section = section.expect("a blank");
        let step = Outline::rectangle(Point::new(20.0, -10.0), Point::new(31.0, 1.0)).expect("a step");
        section.cut_hole(&step);
        assert_eq!(Sizes::new(&section, &[]).expect("a part").grooves, []);
    }
}

#[test]
fn a_place_has_rings_and_stretches() {
    let found = measuring::at(&blank(), &[], &SectionSpot::parse("X52 Z-35").expect("a place"));
    let ring = Ring { bore_mm: 20.0, diameter_mm: 60.0 };
    let at_z = Found::AtZ { z_mm: -35.0, behind: vec![ring], in_front: vec![ring], thread: None };
    let material = vec![(0.0, -30.0), (-34.0, -50.0)];
    assert_eq!(found, [at_z, Found::AtDiameter { diameter_mm: 52.0, material, gaps: vec![(-30.0, -34.0)] }]);
    assert_eq!(ring.wall_mm(), 20.0);
}

/// What a `[[measure]]` finds on the blank, and whether it passes.
fn judged(entry: &str) -> (Result<f64, NotThere>, Option<bool>, Option<&'static str>) {
    let setup = Setup::parse(&format!("[[measure]]\n{entry}")).expect("a setup");
    let judged = measuring::judge(&blank(), &[], &setup.measures().expect("sizes"));
    (judged[0].found, judged[0].passes(), judged[0].finding(1).map(|finding| finding.key))
}

#[test]
fn limits_are_judged_at_the_limit_and_beyond() {
    let out = Some("size-out-of-tolerance");
    // 60 mm stands exactly on a limit of each of these.
    for tolerance in ["[0, -0.021]", "[0.021, 0]", "0.000001"] {
        let text = format!("at = \"Z-20\"\ndiameter_mm = 60\ntolerance_mm = {tolerance}");
        assert_eq!(judged(&text), (Ok(60.0), Some(true), None), "{tolerance}");
    }
    let text = |nominal: &str, tolerance: &str| {
        format!("at = \"Z-20\"\ndiameter_mm = {nominal}\ntolerance_mm = {tolerance}")
    };
    assert_eq!(judged(&text("60.021", "[0, -0.021]")).1, Some(true));
    assert_eq!(judged(&text("60.0211", "[0, -0.021]")), (Ok(60.0), Some(false), out));
    assert_eq!(judged(&text("59.979", "[0.021, 0]")).1, Some(true));
    assert_eq!(judged(&text("59.9789", "[0.021, 0]")), (Ok(60.0), Some(false), out));
    // Without limits nothing is judged.
    assert_eq!(judged("at = \"Z-20\"\ndiameter_mm = 3"), (Ok(60.0), None, None));
}

#[test]
fn every_quantity_is_found_or_said_not_to_be_there() {
    let none = |why| (Err(why), Some(false), Some("size-not-there"));
    assert_eq!(judged("at = \"Z-20\"\nbore_mm = 20").0, Ok(20.0));
    assert_eq!(judged("at = \"Z-32\"\nwall_mm = 15").0, Ok(15.0));
    assert_eq!(judged("at = \"X52\"\nwidth_mm = 4").0, Ok(4.0));
    assert_eq!(judged("at = \"X22 Z-41\"\nwidth_mm = 2").0, Ok(2.0));
    assert_eq!(judged("from = \"Z0\"\nto = \"Z-30.4\"\nlength_mm = 30").0, Ok(30.0));
    assert_eq!(judged("at = \"Z5\"\ndiameter_mm = 20"), none(NotThere::NoMaterial));
    assert_eq!(judged("at = \"X15\"\nwidth_mm = 4"), none(NotThere::NoGap));
    assert_eq!(judged("from = \"Z0\"\nto = \"Z-25\"\nlength_mm = 30"), none(NotThere::NoFace));
    assert_eq!(judged("at = \"Z-20\"\nlead_mm = 2"), none(NotThere::NoThread));
    let face = judged("at = \"Z-30\"\ndiameter_mm = 60");
    assert_eq!(face, (Err(NotThere::Face), Some(false), Some("size-at-face")));
    // At its end a part has one side only.
    assert_eq!(judged("at = \"Z-50\"\ndiameter_mm = 60").0, Ok(60.0));
    let solid = measuring::judge(
        &Section::bar(10.0, -20.0, 0.0).expect("a bar"),
        &[],
        &Setup::parse("[[measure]]\nat = \"Z-9\"\nbore_mm = 5").expect("a setup").measures().expect("sizes"),
    );
    assert_eq!(solid[0].found, Err(NotThere::Solid));
}
