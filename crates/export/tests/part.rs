//! The drawing of a part: its sizes, its threads by convention, and a picture that XML readers take.

use turnwright_export::Language;
use turnwright_export::formats::part_svg::{PartDrawing, write_part_svg};
use turnwright_export::part::PartShape;
use turnwright_geometry::{Bounds, Outline, Point};
use turnwright_stock::Section;
use turnwright_stock::machining::{ThreadHand, ThreadMark};

/// A bar of 40 × 60 with a spigot of 20 × 25, a bore of 10 and four grooves of a thread of 2 mm.
fn part() -> (Section, ThreadMark) {
    let rectangle = |x: (f64, f64), z: (f64, f64)| {
        Outline::rectangle(Point::new(x.0, z.0), Point::new(x.1, z.1)).expect("a rectangle")
    };
    let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
    section.cut_hole(&rectangle((10.0, 30.0), (-25.0, 1.0)));
    section.cut_hole(&rectangle((-1.0, 5.0), (-15.0, 1.0)));
    for index in 0..4 {
        let z = -3.0 - 2.0 * f64::from(index);
        let groove = [(9.0, z), (10.5, z - 0.9), (10.5, z + 0.9)].map(|(x, z)| Point::new(x, z));
        section.cut_hole(&Outline::polygon(&groove).expect("a groove"));
    }
    let mark = ThreadMark {
        tool: 3,
        lead_mm: 2.0,
        hand: ThreadHand::Right,
        from: Point::new(9.0, 0.0),
        to: Point::new(9.0, -9.0),
        bounds: Bounds { min: Point::new(9.0, -9.6), max: Point::new(10.0, -2.4) },
        starts: Vec::new(),
        passes: 1,
    };
    (section, mark)
}

#[test]
fn sizes_are_those_of_the_drawing() {
    let (section, mark) = part();
    let shape = PartShape::new(&section, &[mark]).expect("a part");
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(shape.diameter_mm, 40.0) && near(shape.z.0, -60.0) && near(shape.z.1, 0.0));
    let has = |diameter: f64, z: (f64, f64), is_inside: bool| {
        shape.cylinders.iter().any(|one| {
            near(one.diameter_mm, diameter)
                && near(one.z.0, z.0)
                && near(one.z.1, z.1)
                && one.is_inside == is_inside
        })
    };
    assert!(has(10.0, (-15.0, 0.0), true) && has(40.0, (-60.0, -25.0), false), "{:?}", shape.cylinders);
    let thread = &shape.threads[0];
    assert_eq!(shape.threads.len(), 1);
    assert!(near(thread.crest_mm, 20.0) && near(thread.root_mm, 18.0) && near(thread.lead_mm, 2.0));
    assert!(!thread.is_inside && thread.root.len() == 4, "{thread:?}");
    // No groove is left in the edges, and the section itself keeps them.
    assert!(shape.loops.iter().flatten().all(|edge| !near(edge.start.x, 9.0)));
    assert!(section.contours().iter().map(|one| one.segments.len()).sum::<usize>() > 14);
    for face in [0.0, -15.0, -25.0, -60.0] {
        assert!(shape.faces.iter().any(|z| near(*z, face)), "{:?}", shape.faces);
    }
    assert!(near(shape.volume_mm3, section.volume_mm3()));
    assert_eq!(PartShape::new(&Section::default(), &[]), None);
}

#[test]
fn the_drawing_is_a_picture_by_itself() {
    let (section, mark) = part();
    let shape = PartShape::new(&section, &[mark]).expect("a part");
    let stock = Outline::rectangle(Point::new(0.0, -60.0), Point::new(22.0, 1.0)).expect("a bar");
    for language in [Language::English, Language::Chinese] {
        let title = "<evil> & \"part\"".to_string();
        let svg = write_part_svg(&PartDrawing { shape: &shape, stock: Some(&stock), title, language });
        let tree = roxmltree::Document::parse(&svg).expect("XML");
        let of_class = |class: &str| -> Vec<String> {
            let nodes = tree.descendants().filter(|node| node.attribute("class") == Some(class));
            nodes.map(|node| node.text().unwrap_or_default().to_string()).collect()
        };
        for class in ["section", "edges", "stock", "centre-line", "thread", "size"] {
            assert_eq!(of_class(class).len(), 1, "{class}");
        }
        let diameters = of_class("diameter");
        for text in ["⌀10", "⌀20 × 2", "⌀40"] {
            assert!(diameters.iter().any(|one| one == text), "{diameters:?}");
        }
        assert_eq!(of_class("length"), ["15", "25", "60"]);
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("href"));
    }
}
