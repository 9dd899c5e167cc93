//! Drawings as targets: what is read from DXF, what is refused and where, and a part beside its drawing.

mod support;

use turnwright_control::Setup;
use turnwright_geometry::OUTLINE_MM_MAX;
use turnwright_stock::Section;
use turnwright_stock::machining::RapidRates;
use turnwright_verify::part::PartRun;
use turnwright_verify::target::drawing::{DRAWING_BYTES_MAX, Drawing, DrawingFault};
use turnwright_verify::target::{ContourFault, Judgement, SPOTS_MAX, Target, section};

/// A drawing with shapes in it, and a unit when one is given.
fn dxf(unit: Option<i32>, shapes: &str) -> String {
    let header = unit.map_or_else(String::new, |unit| {
        format!("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n")
    });
    format!("999\na comment\n{header}0\nSECTION\n2\nENTITIES\n{shapes}0\nENDSEC\n0\nEOF\n")
}

fn line(layer: &str, a: (f64, f64), b: (f64, f64)) -> String {
    format!("0\nLINE\n8\n{layer}\n10\n{}\n20\n{}\n30\n0\n11\n{}\n21\n{}\n31\n0\n", a.0, a.1, b.0, b.1)
}

/// A pin of ⌀20 and 30 long with a quarter of R5 at its front, as X and Y of a drawing.
const PIN: &str = "0\nLWPOLYLINE\n8\nturned\n90\n5\n70\n0\n10\n0\n20\n0\n10\n0\n20\n5\n42\n0.41421356237309503\n\
                   10\n-5\n20\n10\n10\n-30\n20\n10\n10\n-30\n20\n0\n";
const PIN_MM2: f64 = 300.0 - 25.0 + 25.0 * std::f64::consts::FRAC_PI_4;

fn drawn(text: &str) -> Result<Section, ContourFault> {
    section(&Drawing::read(text.as_bytes()).expect("a drawing").layer(None).expect("a layer").edges)
}

fn area(text: &str) -> f64 {
    drawn(text).expect("a section").area_mm2()
}

fn fault(text: &str) -> DrawingFault {
    Drawing::read(text.as_bytes()).expect_err("refused")
}

#[test]
fn lines_arcs_circles_and_both_kinds_of_polyline_are_read() {
    assert!((area(&dxf(None, PIN)) - PIN_MM2).abs() < 1e-9);
    // The same with a heavy polyline, whose corners are shapes.
    let corners =
        [(0., 0., 0.), (0., 5., 0.414_213_562_373_095), (-5., 10., 0.), (-30., 10., 0.), (-30., 0., 0.)];
    let heavy: String = corners
        .iter()
        .map(|(x, y, bulge)| format!("0\nVERTEX\n8\nturned\n10\n{x}\n20\n{y}\n42\n{bulge}\n"))
        .collect();
    let heavy = format!("0\nPOLYLINE\n8\nturned\n66\n1\n70\n0\n{heavy}0\nSEQEND\n");
    assert!((area(&dxf(None, &heavy)) - PIN_MM2).abs() < 1e-9);
    // With lines and an arc, in another order, with the axis beyond both ends.
    let arc = "0\nARC\n8\nturned\n10\n-5\n20\n5\n40\n5\n50\n0\n51\n90\n";
    let lines =
        [((-30., 0.), (-30., 10.)), ((-40., 0.), (10., 0.)), ((-5., 10.), (-30., 10.)), ((0., 5.), (0., 0.))];
    let loose: String = lines.iter().map(|(a, b)| line("turned", *a, *b)).collect();
    assert!((area(&dxf(None, &format!("{loose}{arc}"))) - PIN_MM2).abs() < 1e-9);
    // A ball, of which the upper half counts.
    let ball = area(&dxf(None, "0\nCIRCLE\n8\n0\n10\n-8\n20\n0\n40\n8\n"));
    assert!((ball - 32.0 * std::f64::consts::PI).abs() < 1e-9);
    // A closed polyline is a ring, and windows write carriage returns.
    let ring =
        "0\nLWPOLYLINE\n8\n0\n90\n4\n70\n1\n10\n0\n20\n5\n10\n0\n20\n8\n10\n-4\n20\n8\n10\n-4\n20\n5\n";
    assert!((area(&dxf(None, ring).replace('\n', "\r\n")) - 12.0).abs() < 1e-9);
}

#[test]
fn what_is_drawn_from_behind_is_turned_over() {
    let behind = PIN
        .replace("70\n0\n", "70\n0\n210\n0\n220\n0\n230\n-1\n")
        .replace("10\n-", "10\n")
        .replace("0.414", "-0.414");
    assert!((area(&dxf(None, &behind)) - PIN_MM2).abs() < 1e-9);
    let section = drawn(&dxf(None, &behind)).expect("a section");
    assert_eq!(section.bounds().expect("material").min.z, -30.0);
    let arc = "0\nARC\n8\n0\n10\n5\n20\n5\n40\n5\n50\n90\n51\n180\n230\n-1\n";
    let rest = [((-30., 0.), (-30., 10.)), ((-5., 10.), (-30., 10.)), ((0., 5.), (0., 0.))];
    let rest: String = rest.iter().map(|(a, b)| line("0", *a, *b)).collect();
    assert!((area(&dxf(None, &format!("{arc}{rest}"))) - PIN_MM2).abs() < 1e-9);
    assert_eq!(fault(&dxf(None, &arc.replace("230\n-1", "210\n1\n230\n0"))), DrawingFault::Tilted(8));
}

#[test]
fn inches_become_millimetres_and_other_units_are_refused() {
    for (unit, factor) in [(0, 1.0), (4, 1.0), (1, 25.4)] {
        assert!((area(&dxf(Some(unit), PIN)) - PIN_MM2 * factor * factor).abs() < 1e-6, "{unit}");
    }
    assert_eq!(fault(&dxf(Some(6), PIN)), DrawingFault::Unit(6));
}

#[test]
fn the_layer_of_the_contour_is_found_or_asked_for() {
    let both = dxf(None, &format!("{PIN}{}", line("axis", (-40., 0.), (5., 0.))));
    let drawing = Drawing::read(both.as_bytes()).expect("a drawing");
    assert_eq!(drawing.layer(None).map(|_| ()), Err(vec!["axis", "turned"]));
    assert_eq!(drawing.layer(Some("TURNED")).expect("a layer").edges.len(), 4);
    assert_eq!(drawing.layer(Some("none")).map(|_| ()), Err(vec!["axis", "turned"]));
    let ours = Drawing::read(both.replace("turned", "PART").as_bytes()).expect("a drawing");
    assert_eq!(ours.layer(None).expect("our own").edges.len(), 4);
    let empty = Drawing::read(dxf(None, "0\nTEXT\n8\nnotes\n1\nM6\n").as_bytes()).expect("a drawing");
    assert_eq!(empty.layer(None).map(|_| ()), Err(Vec::new()));
    // What stands on the sheet is no part, and a curve that cannot be read is remembered.
    let sheet = PIN.replace("90\n5\n", "67\n1\n90\n5\n");
    assert!(Drawing::read(dxf(None, &sheet).as_bytes()).expect("a drawing").layers.is_empty());
    let spline = dxf(None, &format!("{PIN}0\nSPLINE\n8\nturned\n70\n8\n"));
    let layer = &Drawing::read(spline.as_bytes()).expect("a drawing").layers["turned"];
    assert_eq!(layer.unread, Some(("SPLINE".to_string(), 38)));
}

#[test]
fn broken_files_are_refused_where_they_break() {
    let good = dxf(Some(4), PIN);
    for text in ["", "0\n", "0\nSECTION\n", "\n\n\n"] {
        let fault = fault(text);
        assert!(matches!(fault, DrawingFault::Truncated | DrawingFault::NotGroup(1)), "{text:?}: {fault:?}");
    }
    assert_eq!(fault("%PDF-1.7\nsomething\n"), DrawingFault::NotGroup(1));
    assert_eq!(fault("AutoCAD Binary DXF\r\n"), DrawingFault::Binary);
    assert_eq!(fault(&good.replace("0\nEOF\n", "")), DrawingFault::Truncated);
    assert_eq!(fault(&good.replace("10\n-5\n", "10\nfive\n")), DrawingFault::NotNumber(40));
    assert_eq!(fault(&good.replace("10\n-5\n", "10\nnan\n")), DrawingFault::NotNumber(40));
    assert_eq!(fault(&good.replace("10\n-5\n", "10\n1e999\n")), DrawingFault::NotNumber(40));
    assert_eq!(fault(&dxf(None, "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1\n")), DrawingFault::NotNumber(8));
    assert_eq!(fault(&dxf(None, "0\nARC\n8\n0\n10\n0\n20\n0\n40\n1\n50\n0\n")), DrawingFault::NotNumber(8));
    let mesh = "0\nPOLYLINE\n8\n0\n66\n1\n70\n16\n0\nSEQEND\n";
    assert_eq!(fault(&dxf(None, mesh)), DrawingFault::Mesh(8));
    let broken_off = "0\nPOLYLINE\n8\n0\n66\n1\n70\n0\n0\nVERTEX\n8\n0\n10\n1\n20\n1\n";
    assert_eq!(fault(&dxf(None, broken_off)), DrawingFault::Truncated);
    // Cut anywhere, and with any byte changed, there is an answer.
    for end in 0..good.len() {
        assert!(Drawing::read(&good.as_bytes()[..end]).is_err() || end >= good.len() - 1, "{end}");
        for byte in [b'x', b'9', 0xFF, b'\n'] {
            let mut changed = good.clone().into_bytes();
            changed[end] = byte;
            if let Ok(drawing) = Drawing::read(&changed) {
                drawing.layers.values().for_each(|layer| drop(section(&layer.edges)));
            }
        }
    }
}

#[test]
fn lengths_and_files_have_limits() {
    let with = |mm: f64| dxf(None, &line("0", (0., 0.), (0., mm)));
    assert!(Drawing::read(with(OUTLINE_MM_MAX).as_bytes()).is_ok());
    assert_eq!(fault(&with(OUTLINE_MM_MAX * 1.001)), DrawingFault::TooLarge(20));
    // A kilometre in inches is beyond it.
    assert_eq!(fault(&dxf(Some(1), &line("0", (0., 0.), (0., 40_000.)))), DrawingFault::TooLarge(34));
    let padded = |bytes: usize| {
        let good = dxf(None, PIN);
        let comment = "9".repeat(bytes - good.len() - 5);
        format!("999\n{comment}\n{good}")
    };
    assert!(Drawing::read(padded(DRAWING_BYTES_MAX).as_bytes()).is_ok());
    assert_eq!(fault(&padded(DRAWING_BYTES_MAX + 1)), DrawingFault::TooLong);
}

#[test]
fn a_contour_must_close() {
    let open = PIN.replace("10\n-30\n20\n0\n", "").replace("90\n5", "90\n4");
    let place = turnwright_geometry::Point::new(10.0, -30.0);
    assert_eq!(drawn(&dxf(None, &open)).map(|_| ()), Err(ContourFault::Open(place)));
    let below = PIN.replace("20\n10\n", "20\n-10\n");
    assert!(matches!(drawn(&dxf(None, &below)), Err(ContourFault::BelowAxis(_))));
    assert_eq!(section(&[]).map(|_| ()), Err(ContourFault::Nothing));
}

const PROGRAM: &str =
    "O1\nT0101\nG97 S800 M03\nG00 X46. Z2.\nG90 X40. Z-20. F0.2\nX38.\nX30. Z-10.\nG00 X100. Z100.\nM30\n";
const SETUP: &str = "[stock]\ndiameter_mm = 44\nlength_mm = 60\nface_mm = 0\n[tools.1]\ninsert = \"CNMG120404\"\nnose_radius_mm = 0\n";

/// A program on its stock beside a drawing.
fn beside(program: &str, target: Section) -> Judgement {
    let given = Setup::parse(SETUP).expect("a setup");
    let run = support::run(program, "fanuc-0i-tf", &given);
    let rates = RapidRates { x_mm_per_min: 12_000.0, z_mm_per_min: 16_000.0 };
    let part = PartRun::new(&given, &given, run.start, rates).expect("a setup").expect("a stock");
    let mut part = part.with_target(Target::Drawing(Box::new(target)));
    for command in &run.commands {
        part.add(command);
    }
    let part = part.finish();
    part.aimed.expect("a target").judge(&part.plain)
}

/// The part of the program beside a shaft with these radii to Z-10 and Z-20, 30 long.
fn judged(front: f64, back: f64) -> Judgement {
    let corners = [
        (0., 0.),
        (0., front),
        (-10., front),
        (-10., back),
        (-20., back),
        (-20., 22.),
        (-30., 22.),
        (-30., 0.),
    ];
    let shapes: String = corners.windows(2).map(|pair| line("0", pair[0], pair[1])).collect();
    beside(PROGRAM, drawn(&dxf(None, &shapes)).expect("a section"))
}

#[test]
fn places_have_a_limit() {
    let plunges: String = (1..=SPOTS_MAX + 10)
        .map(|index| format!("G00 Z-{}\nG01 X43. F0.1\nX44.2\n", 0.28 * index as f64))
        .collect();
    let program = format!("O1\nT0101\nG97 S800 M03\nG00 X44.2 Z2.\n{plunges}G00 X100. Z100.\nM30\n");
    let bar = Section::bar(22.0, -60.0, 0.0).expect("a bar");
    // The back of the insert takes more than the tip: what is left between are peaks.
    let judged = beside(&program, bar);
    assert!((1..=SPOTS_MAX).contains(&judged.gouges.len()), "{}", judged.gouges.len());
    assert!(judged.gouges.iter().all(|spot| spot.line.is_some()));
}

#[test]
fn a_part_is_its_drawing_or_the_places_are_told() {
    let good = judged(15.0, 19.0);
    assert_eq!((good.gouges.len(), good.rests.len()), (0, 0), "{good:?}");
    assert!(good.strokes().iter().all(|stroke| stroke.deviation_mm == 0.0));
    // What the chuck still holds behind the drawing is no rest, and its back is no edge of it.
    assert!(good.contour.iter().all(|way| way.start.z.max(way.end.z) > -30.0));
    let deep = judged(15.2, 19.0);
    let gouge = &deep.gouges[0];
    assert_eq!((deep.gouges.len(), deep.rests.len(), gouge.line, gouge.tool), (1, 0, Some((0, 7)), 1));
    assert!((gouge.piece.deviation_mm - 0.2).abs() < 1e-9 && (gouge.piece.area_mm2 - 2.0).abs() < 1e-9);
    let strokes = deep.strokes();
    let deepest = strokes.iter().map(|stroke| stroke.deviation_mm).fold(0.0, f64::min);
    assert!((deepest + 0.2).abs() < 1e-9, "{strokes:?}");
    let high = judged(15.0, 18.7);
    assert_eq!((high.gouges.len(), high.rests.len(), high.rests[0].line), (0, 1, None));
    assert!((high.rests[0].piece.deviation_mm - 0.3).abs() < 1e-9);
    // At the tolerance it is within, beyond it is not.
    assert_eq!((high.rests_beyond(0.3).count(), high.rests_beyond(0.299).count()), (0, 1));
    assert_eq!((deep.gouges_beyond(0.2).count(), deep.gouges_beyond(0.199).count()), (0, 1));
    // Stock that was never there is missing, and no line cut it.
    let thick = judged(15.0, 30.0);
    assert!(
        thick.gouges.iter().any(|spot| (spot.piece.deviation_mm - 11.0).abs() < 1e-6),
        "{:?}",
        thick.gouges
    );
}
