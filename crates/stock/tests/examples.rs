//! The example programs on stock: the finished part has the dimensions of its drawing, and nothing is hit.
//!
//! The drawings are those of the seed documents that the programs were printed in. They know nothing of a nose radius,
//! and so the tools have none here.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::path::Path;

use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_geometry::{Outline, Point};
use turnwright_interpreter::{Environment, Interpreter, Options, ReadFault, Step};
use turnwright_stock::machining::{Event, RapidRates, ToolShape};
use turnwright_stock::{Machining, Section};

/// A text in memory.
struct Text(Vec<u8>);

impl Environment for Text {
    fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
        let rest = self.0.get(offset as usize..).unwrap_or(&[]);
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }

    fn skips(&self, _: u8) -> bool {
        false
    }
}

/// A pointed tool: its edges lie at these angles from +Z, counter-clockwise.
fn pointed(trailing_deg: f64, leading_deg: f64) -> Outline {
    const EDGE_MM: f64 = 60.0;
    let ray = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Point::new(EDGE_MM * sine, EDGE_MM * cosine)
    };
    Outline::polygon(&[Point::default(), ray(trailing_deg), ray(leading_deg)]).expect("a tool")
}

/// A right-hand tool with an entering angle of 93 degrees and a point of 55.
fn right_hand() -> Outline {
    pointed(32.0, 87.0)
}

/// A blade by its left corner.
fn blade(width_mm: f64) -> Outline {
    Outline::rectangle(Point::default(), Point::new(60.0, width_mm)).expect("a blade")
}

/// Runs an example with one tool for every number that the examples use.
fn machine(file: &str, bar_diameter: f64, tool: &Outline) -> (Section, Vec<Event>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
    let text = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut control = Control::load(file.split('/').next().expect("a folder")).expect("a control");
    let mut setup = Setup::default();
    if let Ok(words) = std::fs::read_to_string(path.with_extension("toml")) {
        setup = Setup::parse(&words).unwrap_or_else(|fault| panic!("{fault:?}"));
        for (number, value) in setup.parameter_words() {
            control.parameters.set(&number, &value).unwrap_or_else(|fault| panic!("{fault:?}"));
        }
    }
    let mut interpreter = Interpreter::new(control, &setup, SourceId(0), Options::default())
        .unwrap_or_else(|fault| panic!("{fault:?}"));
    let bar = Section::bar(bar_diameter / 2.0, -120.0, 0.0).expect("a bar");
    let rates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };
    let mut machining = Machining::new(bar, interpreter.position(), rates);
    let shape = ToolShape { cutting: tool.clone(), body: None };
    (0..=3).for_each(|number| machining.set_tool(number, &shape));
    let (mut environment, mut events) = (Text(text), Vec::new());
    loop {
        match interpreter.step(&mut environment) {
            Step::Emit(command) => {
                machining.advance(&command, &mut |event| events.push(event));
            }
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => panic!("{file}: {alarm:?}"),
            Step::End => return (machining.section().clone(), events),
        }
    }
}

/// The outer diameter at some Z, and no event.
fn drawing(file: &str, bar_diameter: f64, tool: &Outline, diameters: &[(f64, f64)]) {
    let (section, events) = machine(file, bar_diameter, tool);
    assert_eq!(events, [], "{file}");
    for &(z, diameter) in diameters {
        let rings = section.rings(z);
        assert_eq!(rings.len(), 1, "{file}: {rings:?} at Z{z}");
        let found = 2.0 * rings[0].1;
        assert!((found - diameter).abs() < 1e-5, "{file}: {found} instead of {diameter} at Z{z}");
    }
    assert_eq!(section.pieces().len(), 1, "{file}");
}

#[test]
fn corners_are_rounded_and_chamfered() {
    let inner = 2.0 * (13.0 - 5f64.sqrt());
    // R5 at X20 Z0, R3 between X20 and the face at Z-25.
    let rounded = [(-1.0, 16.0), (-5.0, 20.0), (-10.0, 20.0), (-22.0, 20.0), (-24.0, inner), (-26.0, 30.0)];
    drawing("fanuc-0i-mate-tb/O4001-corner-radius.nc", 30.0, &right_hand(), &rounded);
    let chamfered = [(-0.5, 17.0), (-2.0, 20.0), (-22.0, 20.0), (-24.0, inner), (-26.0, 30.0)];
    drawing("fanuc-0i-mate-tb/O4002-corner-chamfer.nc", 30.0, &right_hand(), &chamfered);
}

#[test]
fn single_cycles_turn_taper_and_face() {
    let steps = [(-0.5, 20.0), (-24.95, 20.0), (-25.05, 30.0)];
    drawing("fanuc-0i-mate-tb/O4003-turning-cycle.nc", 30.0, &right_hand(), &steps);
    let taper = [(-0.001, 15.0002), (-10.0, 17.0), (-24.999, 19.9998), (-25.01, 30.0)];
    drawing("fanuc-0i-mate-tb/O4004-taper-turning-cycle.nc", 30.0, &right_hand(), &taper);
    drawing(
        "fanuc-0i-mate-tb/O4007-facing-cycle.nc",
        50.0,
        &right_hand(),
        &[(-5.0, 20.0), (-9.99, 20.0), (-10.01, 50.0)],
    );
}

#[test]
fn threads_are_cut_at_their_lead() {
    // 1.5 mm, started at Z5: grooves at Z-1, Z-2.5, Z-4 and so on, 17.8 mm at the root; at Z-22 the tool is half a
    // millimetre up on its way out, at Z-23.5 the thread is over.
    let point = pointed(60.0, 120.0);
    let crest = 17.8 + 1.5 * 3f64.sqrt();
    let thread = [(-1.0, 17.8), (-2.5, 17.8), (-20.5, 17.8), (-22.0, 18.8), (-1.75, crest), (-30.0, 20.4)];
    drawing("fanuc-0i-mate-tb/O4005-thread-cycle.nc", 20.4, &point, &thread);
}

#[test]
fn roughing_and_finishing_leave_the_figure() {
    let arc = 2.0 * (18.0 - 8f64.sqrt());
    let shaft = [
        (-1.0, 15.0),
        (-15.0, 15.0),
        (-22.5, 22.5),
        (-30.0, 30.0),
        (-42.0, 30.0),
        (-43.0, arc),
        (-45.1, 45.0),
    ];
    drawing("fanuc-0i-mate-tb/O4008-rough-turning.nc", 45.0, &right_hand(), &shaft);
    let disc = [(-2.0, 28.0), (-5.0, 30.0), (-7.0, 30.0), (-12.5, 35.0), (-14.99, 39.98), (-15.01, 60.0)];
    drawing("fanuc-0i-mate-tb/O4009-rough-facing.nc", 60.0, &right_hand(), &disc);
    let cone = [(-0.01, 40.02), (-10.0, 60.0), (-20.0, 80.0), (-34.0, 80.0), (-45.0, 120.0), (-54.9, 159.6)];
    drawing("gsk-988ta/O0005-rough-facing.nc", 160.0, &right_hand(), &cone);
}

#[test]
fn patterns_from_a_bar_leave_the_figure() {
    let figure = [(-5.0, 50.0), (-12.5, 55.0), (-20.0, 60.0), (-31.0, 64.0), (-37.5, 85.0)];
    for (file, bar) in [("x-and-z", 100.0), ("x", 100.0), ("z", 90.0)] {
        drawing(&format!("fanuc-0i-mate-tb/O4010-from-bar-{file}.nc"), bar, &right_hand(), &figure);
    }
}

#[test]
fn a_groove_wider_than_the_blade_is_cleared() {
    // A blade of 4 mm, steps of 3 mm: from Z-20 to Z-50, down to 40.
    let groove = [(-19.9, 120.0), (-20.1, 40.0), (-35.0, 40.0), (-49.9, 40.0), (-50.1, 120.0)];
    drawing("gsk-980tdi/O0008-radial-groove.nc", 120.0, &blade(4.0), &groove);
    // A blade narrower than the step leaves ribs.
    let (section, _) = machine("gsk-980tdi/O0008-radial-groove.nc", 120.0, &blade(2.0));
    assert!(section.spans(50.0).len() > 5, "{:?}", section.spans(50.0));
}

#[test]
fn a_recess_needs_a_pointed_tool() {
    let file = "fanuc-0i-mate-tb/example-4-11-recess.nc";
    let middle = 15.0 + 125f64.sqrt() - 15.0;
    let (right, events) = machine(file, 30.0, &pointed(60.0, 120.0));
    assert_eq!(events, []);
    let found = right.rings(-20.0)[0].1;
    assert!((found - middle).abs() < 1e-5, "{found} instead of {middle}");
    // The back of a tool of 55 degrees goes into the slope that it has just cut: a gouge of a tenth of a millimetre
    // and more.
    let (wrong, _) = machine(file, 30.0, &right_hand());
    let mut gouged = right.clone();
    let gouge = gouged.cut_section(&wrong);
    assert!(gouge.area_mm2 > 0.0 && gouged.area_mm2() > 0.1, "{}", gouged.area_mm2());
    assert!(gouged.pieces().iter().all(|piece| piece.bounds.min.z > -20.0));
}
