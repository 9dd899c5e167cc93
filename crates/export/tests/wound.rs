//! Parts whose threads wind, as triangles: closed, as large as their sections, at their lead; and what has no such mesh.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use turnwright_canon::{Action, Command, Origin, RapidPath, Shape, SpindleSpeed, SpindleState};
use turnwright_export::formats::glb::write_glb;
use turnwright_export::formats::stl::write_stl;
use turnwright_export::mesh::{CHORD_MM, Mesh};
use turnwright_export::part::PartShape;
use turnwright_export::wound::{PAGE_CHORD_MM, Turns, Unwound, WOUND_EDGES_MAX, Wound, half_planes};
use turnwright_geometry::{Outline, Point};
use turnwright_stock::machining::{HalfPlanes, RapidRates, ToolShape};
use turnwright_stock::{Machining, Section};
use turnwright_units::{Angle, Lead, Length, Position, Radius, Rpm, WorkTip};

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn place(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(diameter / 2.0)), length(z))
}

fn rapid(diameter: f64, z: f64) -> Action {
    Action::Rapid { to: place(diameter, z), path: RapidPath::Straight, others: None }
}

fn thread(diameter: f64, z: f64, lead: f64, start_deg: i64) -> Action {
    Action::Thread {
        to: place(diameter, z),
        shape: Shape::Line,
        lead: Lead(length(lead)),
        lead_end: None,
        start_angle: Angle::from_millidegrees(start_deg * 1_000),
        is_chained: false,
    }
}

fn polygon(corners: &[(f64, f64)]) -> Outline {
    let points: Vec<Point> = corners.iter().map(|&(x, z)| Point::new(x, z)).collect();
    Outline::polygon(&points).expect("an outline")
}

/// A part with threads: how it is drawn, and in all half-planes.
struct Threaded {
    shape: PartShape,
    section: Section,
    turns: Turns,
}

/// A bar or tube of 40 with a recess at Z-25 to Z-20, from which threads of 60 degrees are cut. Tool 3 outside, 4 inside.
fn threaded(bore: f64, spindle: SpindleState, actions: &[Action]) -> Threaded {
    let mut blank = Section::tube(bore / 2.0, 20.0, -60.0, 0.0).expect("a tube");
    blank.cut_hole(&polygon(&[(17., -25.), (30., -25.), (30., -20.), (17., -20.)]));
    let rates = RapidRates { x_mm_per_min: 10_000.0, z_mm_per_min: 20_000.0 };
    let plain = blank.clone();
    let mut machining = Machining::new(blank, place(100.0, 50.0), rates);
    let half = 5.0 / 3f64.sqrt();
    for (number, cutting) in [
        (3, polygon(&[(0., 0.), (5., -half), (5., half)])),
        (4, polygon(&[(0., 0.), (-5., half), (-5., -half)])),
    ] {
        machining.set_tool(number, &ToolShape { cutting, body: None });
    }
    let speed = SpindleSpeed::Constant(Rpm(800));
    let spin = Action::Spindle { state: spindle, speed, rpm_max: None };
    let mut all = HalfPlanes::new(&machining);
    for action in [spin].iter().chain(actions) {
        let command = Command::new(action.clone(), Origin::line(1));
        all.add(&command, &machining);
        machining.advance(&command, &mut |_| {});
    }
    let section = machining.section().clone();
    let shape = PartShape::new(&section, &plain, machining.threads()).expect("a part");
    let count = half_planes(&shape, CHORD_MM);
    let turns = Turns::new(all.sections(count, &section).expect("not too long")).expect("not too fine");
    Threaded { shape, section, turns }
}

fn tool(number: u32) -> Action {
    Action::Tool { tool: number, offset: number }
}

fn outside(lead: f64, starts: i64) -> Vec<Action> {
    let pass = |start: i64| {
        [rapid(44., 6.), rapid(38., 6.), thread(38., -21., lead, 360 / starts * start), rapid(44., -21.)]
    };
    [tool(3)].into_iter().chain((0..starts).flat_map(pass)).collect()
}

/// Looks whether the triangles of an STL file are closed, edge by edge, and gives what they hold.
fn closed_volume(bytes: &[u8]) -> f64 {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let mut edges: HashMap<([u32; 3], [u32; 3]), i32> = HashMap::new();
    let mut volume = 0.0;
    for at in (84..bytes.len()).step_by(50) {
        let bits = [12, 24, 36].map(|offset| [0, 4, 8].map(|axis| word(at + offset + axis)));
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (bits[a], bits[b]);
            assert_ne!(a, b, "two corners in one place");
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
        let [a, b, c] = bits.map(|corner| corner.map(|bits| f64::from(f32::from_bits(bits))));
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
            / 6.0;
    }
    assert!(edges.values().all(|sum| *sum == 0), "not closed");
    volume
}

fn wound(part: &Threaded, chord_mm: f64) -> Wound {
    Wound::new(&part.shape, &part.turns, chord_mm).expect("a mesh")
}

#[test]
fn meshes_are_closed_and_hold_what_all_half_planes_hold() {
    let clockwise = SpindleState::Clockwise;
    let inside = [tool(4), rapid(16., 6.), rapid(22., 6.), thread(22., -30., 2., 0), rapid(16., -30.)];
    let taper = [tool(3), rapid(44., 4.), rapid(37., 4.), thread(39.5, -21., 2., 0), rapid(44., -21.)];
    let blind = [tool(3), rapid(44., 4.), rapid(38., 4.), thread(38., -13.3, 2., 0), rapid(44., -13.3)];
    let face = [tool(3), rapid(44., 4.), rapid(38., 4.), thread(38., -21., 40., 0), rapid(44., -21.)];
    for (name, part) in [
        ("single", threaded(0., clockwise, &outside(2., 1))),
        ("left", threaded(0., SpindleState::CounterClockwise, &outside(2., 1))),
        ("tube", threaded(20., clockwise, &outside(2., 1))),
        ("inside", threaded(20., clockwise, &inside)),
        ("taper", threaded(0., clockwise, &taper)),
        ("ends in solid", threaded(0., clockwise, &blind)),
        ("three starts", threaded(0., clockwise, &outside(6., 3))),
        ("steep", threaded(20., clockwise, &face)),
    ] {
        for chord_mm in [CHORD_MM, PAGE_CHORD_MM] {
            let mesh = wound(&part, chord_mm);
            assert_eq!(mesh.directions.len() % 4, 0);
            let count = mesh.directions.len();
            let bytes = write_stl(&Mesh::Wound(mesh));
            let volume = closed_volume(&bytes);
            // A polygon is less than its circle by this share.
            let share = (TAU / count as f64).sin() * count as f64 / TAU;
            let exact = part.turns.volume_mm3() * share;
            assert!((volume - exact).abs() < 2e-4 * exact, "{name}: {volume} instead of {exact}");
        }
        // Of a whole number of turns the mean of all is what each holds; the ends make some difference.
        let section = part.section.volume_mm3();
        assert!((part.turns.volume_mm3() - section).abs() < 5e-3 * section, "{name}");
        let glb = write_glb(&Mesh::Wound(wound(&part, CHORD_MM)), "part");
        assert!(glb.starts_with(b"glTF"));
    }
}

/// Z of the roots in each half-plane, from Z-15 to Z-3.
fn roots(mesh: &Wound, radius: f64) -> Vec<Vec<f64>> {
    let of_side = |side: usize| {
        let here = mesh.corners.iter().filter(|corner| corner.side == side);
        let mut roots: Vec<f64> = here
            .filter(|corner| (corner.place.x - radius).abs() < 1e-9)
            .map(|corner| corner.place.z)
            .filter(|z| (-15.0..-3.0).contains(z))
            .collect();
        roots.sort_by(f64::total_cmp);
        roots
    };
    (0..mesh.directions.len()).map(of_side).collect()
}

#[test]
fn along_a_line_the_pitch_is_the_lead_and_round_the_part_the_groove_climbs_by_it() {
    for (spindle, sense, starts) in [
        (SpindleState::Clockwise, 1.0, 1),
        (SpindleState::CounterClockwise, -1.0, 1),
        (SpindleState::Clockwise, 1.0, 2),
    ] {
        let lead = 2.0 * starts as f64;
        let mesh = wound(&threaded(0., spindle, &outside(lead, starts)), CHORD_MM);
        let roots = roots(&mesh, 19.0);
        for (side, roots) in roots.iter().enumerate() {
            // One groove every 2 mm, whatever the number of starts.
            assert!(roots.windows(2).all(|two| (two[1] - two[0] - 2.0).abs() < 1e-9), "{roots:?}");
            // The first start is at Z6 over angle zero, and lead · angle / 360° further there.
            let climbed = sense * lead * side as f64 / mesh.directions.len() as f64;
            let off = (roots[0] - 6.0 - climbed).rem_euclid(2.0);
            assert!(off.min(2.0 - off) < 1e-9, "{side}: {roots:?}");
        }
        // A groove that is followed all round has gone on by its lead: past all of the other starts.
        let step = lead / mesh.directions.len() as f64;
        let mut at = roots[0][1];
        for row in roots.iter().skip(1).chain([&roots[0]]) {
            let on = at + sense * step;
            at = *row.iter().min_by(|a, b| (*a - on).abs().total_cmp(&(*b - on).abs())).expect("a root");
            if !(-14.0..-4.0).contains(&at) {
                at -= sense * lead;
            }
        }
        assert!((at - roots[0][1]).rem_euclid(lead).min(lead - (at - roots[0][1]).rem_euclid(lead)) < 1e-6);
    }
}

#[test]
fn flanks_lie_on_the_helicoid() {
    // Between two corners of neighbouring half-planes the middle of a long edge is near the true flank.
    let part = threaded(0., SpindleState::Clockwise, &outside(2., 1));
    let mesh = wound(&part, CHORD_MM);
    let (mut off_most, mut seen) = (0f64, 0);
    for facet in mesh.facets.iter().filter(|facet| facet.is_thread) {
        let corners = facet.corners.map(|corner| mesh.place(corner));
        let middle = [0, 1, 2].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
        let (radius, angle, z) = (middle[0].hypot(middle[1]), middle[1].atan2(middle[0]), middle[2]);
        if !(-17.0..-3.0).contains(&z) {
            continue;
        }
        // Wound back to angle zero, where the roots are at even Z: a V of 60 degrees from radius 19 up to 20.
        let aside = (z - 2.0 * angle / TAU).rem_euclid(2.0);
        let true_radius = (19.0 + aside.min(2.0 - aside) * 3f64.sqrt()).min(20.0);
        off_most = off_most.max((radius - true_radius).abs());
        seen += 1;
    }
    assert!(seen > 1_000 && off_most < 2.5 * CHORD_MM, "{seen} {off_most}");
}

#[test]
fn what_cannot_wind_says_why() {
    // A ring that is there only in some half-planes: a wall that the thread goes through.
    let thin = |gap: bool| {
        let mut section = Section::tube(10.0, 12.0, -20.0, 0.0).expect("a tube");
        if gap {
            section.cut_hole(&polygon(&[(5., -11.), (15., -11.), (15., -10.), (5., -10.)]));
        }
        section
    };
    let part = threaded(0., SpindleState::Clockwise, &outside(2., 1));
    let turns = Turns::new((0..64).map(|side| thin(side % 2 == 0))).expect("not too fine");
    assert_eq!(Wound::new(&part.shape, &turns, CHORD_MM), Err(Unwound::InPieces));
    let turns = Turns::new((0..64).map(|_| thin(false))).expect("not too fine");
    let mesh = Wound::new(&part.shape, &turns, CHORD_MM).expect("a mesh");
    let exact = PI * (144.0 - 100.0) * 20.0;
    assert!((closed_volume(&write_stl(&Mesh::Wound(mesh))) - exact).abs() < 0.01 * exact);
    // Four edges for each half-plane: a quarter of the limit fits, one more does not.
    let most = WOUND_EDGES_MAX / 4;
    assert!(Turns::new((0..most).map(|_| thin(false))).is_ok());
    assert_eq!(Turns::new((0..=most).map(|_| thin(false))), Err(Unwound::TooFine));
}
