//! Solids, meshes and drawings for CAD of seeded random turned parts: closed, exact, and as large as the section.
//!
//! Other programs read them back in `tests-browser/solids.test.mjs`.

#[path = "../examples/turned/mod.rs"]
mod turned;

use std::collections::HashMap;
use std::f64::consts::PI;

use turnwright_export::formats::dxf::write_part_dxf;
use turnwright_export::formats::stl::write_stl;
use turnwright_export::mesh::{CHORD_MM, Mesh, TRIANGLES_MAX};
use turnwright_export::part::PartShape;
use turnwright_export::solid::{EDGES_MAX, Surface, bodies, has_solid};
use turnwright_geometry::{Outline, Point, Segment};
use turnwright_stock::Section;

const SEEDS: u64 = 80;

fn shapes() -> impl Iterator<Item = (u64, Section, PartShape)> {
    (0..SEEDS).filter_map(|seed| {
        let section = turned::part(seed);
        let shape = PartShape::new(&section, &section, &[])?;
        Some((seed, section, shape))
    })
}

#[test]
fn solids_hold_what_the_section_holds() {
    let mut kinds: HashMap<String, usize> = HashMap::new();
    let (mut voids, mut pieces) = (0, 0);
    for (seed, section, shape) in shapes() {
        let bodies = bodies(&shape);
        let exact = section.volume_mm3();
        let volume: f64 = bodies.iter().flat_map(|body| body.shells()).map(|shell| shell.volume_mm3).sum();
        assert!((volume - exact).abs() < 1e-9 * exact, "{seed}: {volume} instead of {exact}");
        assert!((shape.plain_volume_mm3() - exact).abs() < 1e-9 * exact, "{seed}");
        assert_eq!(bodies.len(), section.pieces().len(), "{seed}");
        for shell in bodies.iter().flat_map(|body| body.shells()) {
            let (first, last) = (shell.profile[0], shell.profile[shell.profile.len() - 1]);
            assert!(shell.profile.windows(2).all(|two| two[0].end == two[1].start), "{seed}");
            if shell.is_ring() {
                assert_eq!(first.start, last.end, "{seed}");
            } else {
                assert_eq!((first.start.x, last.end.x), (0.0, 0.0), "{seed}");
            }
            for edge in &shell.profile {
                *kinds.entry(format!("{:?}", Surface::of(edge))).or_default() += 1;
            }
        }
        voids += bodies.iter().map(|body| body.voids.len()).sum::<usize>();
        pieces = pieces.max(bodies.len());
    }
    // The parts are not all of one kind.
    assert!(kinds.len() == 6 && voids > 5 && pieces > 1, "{kinds:?} {voids} {pieces}");
}

/// A triangle of an STL file: its normal and its corners, as bits and as numbers.
struct Triangle {
    normal: [f64; 3],
    bits: [[u32; 3]; 3],
    corners: [[f64; 3]; 3],
}

fn read_stl(bytes: &[u8]) -> Vec<Triangle> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    assert_eq!(bytes.len(), 84 + 50 * word(80) as usize);
    assert!(!bytes.starts_with(b"solid") && bytes.starts_with(b"turnwright, mm, within 0.01 mm"));
    let triples = |at: usize| [word(at), word(at + 4), word(at + 8)];
    let numbers = |bits: [u32; 3]| bits.map(|bits| f64::from(f32::from_bits(bits)));
    let triangle = |at: usize| {
        let bits = [12, 24, 36].map(|offset| triples(at + offset));
        Triangle { normal: numbers(triples(at)), bits, corners: bits.map(numbers) }
    };
    (84..bytes.len()).step_by(50).map(triangle).collect()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[test]
fn meshes_are_closed_and_stay_within_their_tolerance() {
    for (seed, section, shape) in shapes().step_by(4) {
        let mesh = Mesh::new(&shape, CHORD_MM).expect("a mesh");
        assert_eq!(mesh.chord_mm(), CHORD_MM);
        let triangles = read_stl(&write_stl(&mesh));
        assert_eq!(triangles.len(), mesh.triangle_count());
        let mut edges: HashMap<([u32; 3], [u32; 3]), i32> = HashMap::new();
        let (mut volume, mut area) = (0.0, 0.0);
        for triangle in &triangles {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (triangle.bits[a], triangle.bits[b]);
                assert_ne!(a, b, "{seed}: a corner");
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
            let [a, b, c] = triangle.corners;
            let across = cross(minus(b, a), minus(c, a));
            let twice = dot(across, across).sqrt();
            volume += dot(a, cross(b, c)) / 6.0;
            area += twice / 2.0;
            if twice > 1e-3 {
                assert!(dot(across, triangle.normal) > 0.999 * twice, "{seed}: {:?}", triangle.normal);
            }
            for (a, b) in [(a, b), (b, c), (c, a)] {
                for part in [0.0, 0.5] {
                    let place: Vec<f64> = (0..3).map(|axis| a[axis] + part * (b[axis] - a[axis])).collect();
                    let place = Point::new(place[0].hypot(place[1]), place[2]);
                    let off = shape.loops.iter().flatten().map(|edge| edge.distance(place));
                    let off = off.fold(f64::INFINITY, f64::min);
                    // On the axis, and on faces, no edge of the section is near the middle of a triangle.
                    let is_inner = section.contains(place) || place.x < 1e-3;
                    assert!(off < CHORD_MM + 1e-4 || is_inner, "{seed}: {off} at {place:?}");
                    assert!(part > 0.0 || off < 2e-4 || place.x < 1e-3, "{seed}: a corner {off} off");
                }
            }
        }
        // As often one way as the other.
        assert!(edges.values().all(|sum| *sum == 0), "{seed}: not closed");
        let exact = section.volume_mm3();
        assert!((volume - exact).abs() < CHORD_MM * area, "{seed}: {volume} instead of {exact}");
        assert!((volume - exact).abs() < 0.002 * exact, "{seed}: {volume} instead of {exact}");
    }
}

#[test]
fn a_finer_tolerance_comes_nearer_and_a_fine_part_gets_a_coarse_mesh() {
    let ball = Outline::circle(Point::new(30.0, -30.0), 20.0).expect("a circle");
    let mut section = Section::bar(40.0, -60.0, 0.0).expect("a bar");
    section.cut_hole(&ball);
    let shape = PartShape::new(&section, &section, &[]).expect("a part");
    let error = |chord_mm: f64| {
        let triangles = read_any_stl(&write_stl(&Mesh::new(&shape, chord_mm).expect("a mesh")));
        (triangles - section.volume_mm3()).abs()
    };
    assert!(error(0.001) < error(0.01) / 5.0 && error(0.01) < error(0.1) / 5.0);
    // Ten thousand grooves are too much for a hundredth, and twice as many edges as a solid may have for any.
    let grooved = |count: u32| {
        let mut section = Section::bar(40.0, -f64::from(count), 0.0).expect("a bar");
        for index in 0..count {
            let z = -f64::from(index) - 0.75;
            section.cut_hole(
                &Outline::rectangle(Point::new(39.0, z), Point::new(50.0, z + 0.5)).expect("a groove"),
            );
        }
        PartShape::new(&section, &section, &[]).expect("a part")
    };
    let mesh = Mesh::new(&grooved(4_000), CHORD_MM).expect("a mesh");
    assert!(mesh.chord_mm() > CHORD_MM && mesh.triangle_count() <= TRIANGLES_MAX);
    let fine = grooved(EDGES_MAX as u32 / 4 + 10);
    assert!(!has_solid(&fine) && bodies(&fine).is_empty() && Mesh::new(&fine, CHORD_MM).is_none());
}

fn read_any_stl(bytes: &[u8]) -> f64 {
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")));
    let corner = |at: usize| [number(at), number(at + 4), number(at + 8)];
    let volume = |at: usize| dot(corner(at + 12), cross(corner(at + 24), corner(at + 36))) / 6.0;
    (84..bytes.len()).step_by(50).map(volume).sum()
}

/// The lines and arcs on a layer of a DXF file, by their ends and their length.
fn read_dxf(text: &str, layer: &str) -> Vec<([f64; 2], [f64; 2], f64)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut entities: Vec<HashMap<&str, &str>> = Vec::new();
    for pair in lines.chunks(2) {
        if pair[0] == "0" {
            entities.push(HashMap::new());
        }
        if let Some(entity) = entities.last_mut() {
            entity.entry(pair[0]).or_insert(pair[1]);
        }
    }
    let on_layer = entities.iter().filter(|entity| entity.get("8") == Some(&layer));
    on_layer
        .map(|entity| {
            let number = |code: &str| entity[code].parse::<f64>().expect("a number");
            let place = [number("10"), number("20")];
            if entity["0"] == "LINE" {
                let end = [number("11"), number("21")];
                return (place, end, (end[0] - place[0]).hypot(end[1] - place[1]));
            }
            let (radius, from, to) = (number("40"), number("50").to_radians(), number("51").to_radians());
            let at = |angle: f64| [place[0] + radius * angle.cos(), place[1] + radius * angle.sin()];
            (at(from), at(to), radius * (to - from).rem_euclid(2.0 * PI))
        })
        .collect()
}

#[test]
fn a_drawing_for_cad_has_the_edges_of_the_section_end_to_end() {
    for (seed, _, shape) in shapes() {
        let strokes = read_dxf(&write_part_dxf(&shape, None), "PART");
        let off_axis = |edge: &&Segment| edge.start.x.max(edge.end.x) > 1e-6 || edge.bend.is_some();
        let edges: Vec<&Segment> = shape.loops.iter().flatten().filter(off_axis).collect();
        assert_eq!(strokes.len(), edges.len(), "{seed}");
        let length = |edge: &&Segment| match edge.bend {
            None => edge.start.distance(edge.end),
            Some(bend) => bend.centre.distance(edge.start) * edge.sweep_rad().abs(),
        };
        let (exact, written) =
            (edges.iter().map(length).sum::<f64>(), strokes.iter().map(|one| one.2).sum::<f64>());
        assert!((exact - written).abs() < 1e-4, "{seed}: {written} instead of {exact}");
        let ends: Vec<[f64; 2]> = strokes.iter().flat_map(|one| [one.0, one.1]).collect();
        for end in &ends {
            let near = |other: &&[f64; 2]| (other[0] - end[0]).hypot(other[1] - end[1]) < 5e-6;
            let count = ends.iter().filter(near).count();
            assert!(count % 2 == 0 || end[1].abs() < 1e-5, "{seed}: a loose end at {end:?}");
        }
    }
}
