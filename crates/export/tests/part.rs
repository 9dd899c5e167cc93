//! The drawing of a part: its sizes, its threads by convention, and a picture that XML readers take.

use turnwright_export::Language;
use turnwright_export::formats::part_svg::{PartDrawing, write_part_svg};
use turnwright_export::part::PartShape;
use turnwright_geometry::{Bounds, Outline, Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::{ThreadHand, ThreadMark};

/// A bar of 40 × 60 with a spigot of 20 × 25, a bore of 10 and four grooves of a thread of 2 mm.
fn part() -> (Section, Section, ThreadMark) {
    let rectangle = |x: (f64, f64), z: (f64, f64)| {
        Outline::rectangle(Point::new(x.0, z.0), Point::new(x.1, z.1)).expect("a rectangle")
    };
    let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
    section.cut_hole(&rectangle((10.0, 30.0), (-25.0, 1.0)));
    section.cut_hole(&rectangle((-1.0, 5.0), (-15.0, 1.0)));
    let plain = section.clone();
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
    (section, plain, mark)
}

#[test]
fn sizes_are_those_of_the_drawing() {
    let (section, plain, mark) = part();
    let shape = PartShape::new(&section, &plain, &[mark]).expect("a part");
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
    assert_eq!(PartShape::new(&Section::default(), &Section::default(), &[]), None);
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn polygon(places: &[(f64, f64)]) -> Outline {
    let places: Vec<Point> = places.iter().map(|(x, z)| Point::new(*x, *z)).collect();
    Outline::polygon(&places).expect("an outline")
}

fn thread_mark(lead_mm: f64, x: (f64, f64), z: (f64, f64)) -> ThreadMark {
    let (_, _, mark) = part();
    ThreadMark {
        lead_mm,
        from: Point::new(x.0, 5.0),
        to: Point::new(x.0, z.0),
        bounds: Bounds { min: Point::new(x.0.min(x.1), z.0), max: Point::new(x.0.max(x.1), z.1) },
        ..mark
    }
}

#[test]
fn a_thread_in_a_bore_with_steps_in_its_flanks_is_two_straight_lines() {
    let mut section = Section::tube(10.0, 20.0, -40.0, 0.0).expect("a tube");
    let plain = section.clone();
    for index in 0..10 {
        // Two passes, the second a little beside the first, leave a hill on a flank.
        let z = -1.5 * f64::from(index) - 1.0;
        section.cut_hole(&polygon(&[(9.9, z + 0.5), (9.9, z - 0.5), (10.6, z)]));
        section.cut_hole(&polygon(&[(9.9, z + 0.3), (9.9, z - 0.6), (10.9, z - 0.1)]));
    }
    let mark = thread_mark(1.5, (10.9, 10.0), (-15.2, -0.5));
    let shape = PartShape::new(&section, &plain, &[mark]).expect("a part");
    let [thread] = shape.threads.as_slice() else { panic!("{:?}", shape.threads) };
    assert!(thread.is_inside && near(thread.crest_mm, 20.0) && near(thread.root_mm, 21.8), "{thread:?}");
    // From the face, less than a lead away, to where the tool went.
    assert!(near(thread.z.1, 0.0) && near(thread.z.0, -15.2), "{thread:?}");
    assert!(thread.root.iter().all(|place| near(place.x, 10.9)), "{:?}", thread.root);
    let (first, last) = (thread.root[0], thread.root[thread.root.len() - 1]);
    assert!(near(first.z.min(last.z), -15.2) && first.z.max(last.z).abs() < 1e-6, "{:?}", thread.root);
    // The bore is whole, and parted where the thread ends.
    let is_bore = |edge: &&Segment| near(edge.start.x, 10.0) && near(edge.end.x, 10.0);
    let bore: Vec<_> = shape.loops.iter().flatten().filter(is_bore).collect();
    assert_eq!(bore.len(), 2);
    assert_eq!(bore.iter().filter(|edge| shape.thread_of(edge) == Some(thread)).count(), 1);
    assert!(near(shape.plain_volume_mm3(), plain.volume_mm3()) && shape.volume_mm3 < plain.volume_mm3());
    assert_eq!(thread.taper_deg(), None);
    // The thread is no cylinder beside itself.
    assert!(
        shape.cylinders.iter().all(|one| !one.is_inside || near(one.z.1, -15.2)),
        "{:?}",
        shape.cylinders
    );
}

#[test]
fn the_crest_of_a_taper_thread_cut_from_the_bar_is_what_its_grooves_left() {
    let mut section = Section::bar(12.0, -40.0, 0.0).expect("a bar");
    let plain = section.clone();
    for index in 0..12 {
        let (x, z) = (8.0 + 0.1 * f64::from(index), -2.0 * f64::from(index) - 0.5);
        // So wide that only peaks are left between them.
        section.cut_hole(&polygon(&[(x, z), (x + 6.0, z - 4.0), (x + 6.0, z + 4.0)]));
    }
    let mark = thread_mark(2.0, (8.0, 12.0), (-25.4, 0.0));
    let shape = PartShape::new(&section, &plain, &[mark]).expect("a part");
    let [thread] = shape.threads.as_slice() else { panic!("{:?}", shape.threads) };
    // The peaks stand 1.5 mm over the roots, half-way between two of them.
    let half_way = 8.0 + 0.05 * (12.7 - 0.5) + 1.5;
    assert!((thread.crest_mm - 2.0 * half_way).abs() < 0.1, "{thread:?}");
    // 0.1 mm in 2: 2 · atan 0.05 between its sides.
    assert!(thread.taper_deg().is_some_and(|angle| (angle - 5.725).abs() < 0.3), "{:?}", thread.taper_deg());
    let crest: Vec<_> = shape.loops.iter().flatten().filter(|edge| shape.thread_of(edge).is_some()).collect();
    assert!((1..=2).contains(&crest.len()), "{crest:?}");
    assert!(shape.plain_volume_mm3() < plain.volume_mm3() && shape.plain_volume_mm3() > section.volume_mm3());
}

#[test]
fn what_a_threading_tool_gouges_elsewhere_stays_in_the_drawing() {
    let mut section = Section::bar(20.0, -60.0, 0.0).expect("a bar");
    let plain = section.clone();
    section.cut_hole(&polygon(&[(15.0, -30.0), (25.0, -33.0), (25.0, -27.0)]));
    let mark = thread_mark(2.0, (15.0, 20.0), (-31.5, -28.5));
    let shape = PartShape::new(&section, &plain, &[mark]).expect("a part");
    assert_eq!(shape.threads, []);
    assert!(near(shape.plain_volume_mm3(), section.volume_mm3()));
}

#[test]
fn the_drawing_is_a_picture_by_itself() {
    let (section, plain, mark) = part();
    let shape = PartShape::new(&section, &plain, &[mark]).expect("a part");
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
        for text in ["⌀10", "⌀40"] {
            assert!(diameters.iter().any(|one| one == text), "{diameters:?}");
        }
        assert_eq!(of_class("length"), ["15", "25", "60"]);
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("href"));
    }
}

/// A text of the drawing: its middle, its baseline, half its width.
fn boxes(svg: &str) -> Vec<(f64, f64, f64, String)> {
    let tree = roxmltree::Document::parse(svg).expect("XML");
    let texts = tree.descendants().filter(|node| node.attribute("class") == Some("diameter"));
    let number = |node: &roxmltree::Node<'_, '_>, name: &str| {
        node.attribute(name).and_then(|text| text.parse::<f64>().ok())
    };
    texts
        .map(|node| {
            let text = node.text().unwrap_or_default().to_string();
            let half = text.chars().count() as f64 * 14.0 * 0.31;
            (number(&node, "x").expect("x"), number(&node, "y").expect("y"), half, text)
        })
        .collect()
}

#[test]
fn labels_are_beside_each_other_and_off_the_part() {
    // Shafts of ever more steps with chamfers, until there is no room for all.
    for steps in [1, 3, 8, 20, 40] {
        let mut corners = vec![(8.0, 0.0)];
        for step in 0..steps {
            let (x, z) = (10.0 + 2.0 * f64::from(step), -7.0 * f64::from(step));
            corners.extend([(x - 1.0, z), (x, z - 1.0), (x, z - 7.0)]);
        }
        corners.extend([(8.0, -7.0 * f64::from(steps))]);
        let section = Section::new(&polygon(&corners)).expect("a section");
        let shape = PartShape::new(&section, &section, &[]).expect("a part");
        let drawing =
            PartDrawing { shape: &shape, stock: None, title: String::new(), language: Language::English };
        let svg = write_part_svg(&drawing);
        let boxes = boxes(&svg);
        assert!(boxes.len() >= 2, "{boxes:?}");
        for (index, one) in boxes.iter().enumerate() {
            assert!(one.0 - one.2 >= -1e-6 && one.0 + one.2 <= 1200.0 + 1e-6, "{one:?}");
            // The part and the stock begin at 156 px; bores have their rows below.
            assert!(one.1 < 156.0 - 30.0 || one.1 > 300.0, "{one:?}");
            for other in &boxes[..index] {
                let is_beside = (one.0 - other.0).abs() >= one.2 + other.2 - 1e-6;
                assert!(is_beside || (one.1 - other.1).abs() >= 20.0, "{one:?} {other:?}");
            }
        }
        // What a drawing is made by is there: the smallest and the greatest diameter, and the chamfers.
        let all = boxes.iter().map(|one| one.3.as_str()).collect::<Vec<_>>();
        assert!(all.contains(&"⌀16"), "{all:?}");
        if steps > 1 && steps < 20 {
            assert!(all.contains(&format!("1×45° ({steps}×)").as_str()), "{all:?}");
        }
    }
}
