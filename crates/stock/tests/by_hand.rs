//! Parts whose section can be worked out with a pencil.

use std::f64::consts::PI;

use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_stock::{Cutter, Section, Sweep};

fn point(x: f64, z: f64) -> Point {
    Point::new(x, z)
}

fn line(start: Point, end: Point) -> Segment {
    Segment { start, end, bend: None }
}

/// A right-angled insert with a round nose that touches X0 and Z0, 12 mm long, leaning back by a tenth.
fn insert(nose: f64) -> Cutter {
    let bend = Some(Bend { centre: point(nose, nose), clockwise: false });
    let outline = Outline::new(vec![
        Segment { start: point(nose, 0.), end: point(0., nose), bend },
        line(point(0., nose), point(1., 12.)),
        line(point(1., 12.), point(12., 12.)),
        line(point(12., 12.), point(12., 1.)),
        line(point(12., 1.), point(nose, 0.)),
    ]);
    Cutter::new(&outline.expect("an insert"))
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} instead of {expected}");
}

#[test]
fn a_turned_step_is_a_cylinder_and_a_fillet() {
    let mut bar = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    near(bar.volume_mm3(), PI * 625.0 * 60.0);
    let mut sweep = Sweep::new();
    let removed = bar.cut(sweep.line(&insert(0.8), point(20.0, 2.0), point(20.0, -30.0)));
    // Left standing: the corner that the nose rounds, and the wedge at the wall beside the leaning edge.
    let corner = 0.64 - 0.16 * PI + 4.2 * 4.2 / 11.2 / 2.0;
    near(removed.area_mm2, 30.0 * 5.0 - corner);
    near(bar.area_mm2(), 60.0 * 25.0 - 30.0 * 5.0 + corner);
    near(bar.area_mm2() + removed.area_mm2, 1500.0);
    near(bar.volume_mm3() + removed.volume_mm3, PI * 625.0 * 60.0);
    let bounds = removed.bounds.expect("cut");
    near(bounds.min.x, 20.0);
    near(bounds.max.x, 25.0);
    near(bounds.min.z, -30.0);
    assert_eq!(bar.rings(-10.0), vec![(0.0, 20.0)]);
    assert!(!removed.may_part);
}

#[test]
fn the_same_pass_again_takes_nothing() {
    let mut bar = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    let cutter = insert(0.8);
    let mut sweep = Sweep::new();
    let way = [point(19.0, 2.0), point(20.3, -7.7), point(20.3, -20.1), point(26.0, -24.9)];
    for pair in way.windows(2) {
        assert!(bar.cut(sweep.line(&cutter, pair[0], pair[1])).is_something());
    }
    let (area, slabs) = (bar.area_mm2(), bar.slab_count());
    for _ in 0..3 {
        for pair in way.windows(2) {
            let removed = bar.cut(sweep.line(&cutter, pair[1], pair[0]));
            assert!(!removed.is_something(), "{removed:?}");
            assert_eq!(bar.touches(&sweep), None);
        }
    }
    assert_eq!((bar.area_mm2(), bar.slab_count()), (area, slabs));
}

#[test]
fn a_face_is_cut_through_the_axis() {
    let mut bar = Section::bar(25.0, -60.0, 1.0).expect("a bar");
    let mut sweep = Sweep::new();
    let facing = insert(0.4);
    let removed = bar.cut(sweep.line(&facing, point(27.0, 0.0), point(-0.8, 0.0)));
    near(removed.area_mm2, 25.0);
    near(bar.volume_mm3(), PI * 625.0 * 60.0);
    assert_eq!(bar.bounds().map(|bounds| bounds.max.z), Some(0.0));
    assert_eq!(bar.slab_count(), 1);
    // Exactly on the face: nothing.
    assert!(!bar.cut(&sweep).is_something());
}

#[test]
fn a_face_that_stops_short_of_the_axis_leaves_a_pip() {
    let mut bar = Section::bar(25.0, -60.0, 1.0).expect("a bar");
    let mut sweep = Sweep::new();
    bar.cut(sweep.line(&insert(0.4), point(27.0, 0.0), point(1.0, 0.0)));
    let wedge = 0.6 * 0.6 / 11.6 / 2.0;
    near(bar.area_mm2(), 60.0 * 25.0 + 1.0 + 0.16 - 0.04 * PI + wedge);
}

#[test]
fn an_arc_leaves_an_arc_of_radius_less_nose_or_more() {
    // A full round tool of R1 rolls a ball of R10 out of a bar, a quarter from the pole outwards.
    let disc = Cutter::new(&Outline::circle(point(0., 0.), 1.0).expect("a disc"));
    let mut bar = Section::bar(10.0, -30.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    let bend = Bend { centre: point(0., -10.), clockwise: false };
    bar.cut(sweep.arc(&disc, point(0., 1.), point(11., -10.), bend));
    // The corner that the disc does not reach stays.
    bar.cut(sweep.line(&disc, point(11.0, 1.0), point(0.0, 1.0)));
    let ring = |x: f64, z: f64| (x * x + (z + 10.0) * (z + 10.0)).sqrt();
    assert!(bar.contains(point(9.9 / 2f64.sqrt(), -10.0 + 9.9 / 2f64.sqrt())));
    assert!(!bar.contains(point(10.1 / 2f64.sqrt(), -10.0 + 10.1 / 2f64.sqrt())));
    for z in [-9.0, -7.0, -5.0, -2.0, -0.5] {
        near(ring(bar.rings(z)[0].1, z), 10.0);
    }
    // A hollow: R6 path of an R1 nose gives R7.
    let mut bar = Section::bar(20.0, -30.0, 0.0).expect("a bar");
    let hollow = Bend { centre: point(20., -15.), clockwise: false };
    let removed = bar.cut(sweep.arc(&disc, point(20., -21.), point(20., -9.), hollow));
    // The half disc of R7 less the half disc of R5 that the tool leaves standing in the middle.
    near(removed.area_mm2, (49.0 - 25.0) * PI / 2.0);
    assert!(removed.may_part);
    let removed = bar.cut(sweep.rest(&disc, point(20., -15.)));
    near(removed.area_mm2, PI / 2.0);
}

#[test]
fn a_full_circle_is_all_round() {
    let disc = Cutter::new(&Outline::circle(point(0., 0.), 1.0).expect("a disc"));
    let mut bar = Section::bar(40.0, -40.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    let centre = point(20., -20.);
    let removed =
        bar.cut(sweep.arc(&disc, point(25., -20.), point(25., -20.), Bend { centre, clockwise: true }));
    near(removed.area_mm2, (36.0 - 16.0) * PI);
    near(removed.volume_mm3, (36.0 - 16.0) * PI * 2.0 * PI * 20.0);
}

#[test]
fn an_undercut_and_a_face_groove_are_kept() {
    let blade = Cutter::new(&Outline::rectangle(point(0., 0.), point(15., 3.)).expect("a blade"));
    let mut bar = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    // A groove, then sideways under the shoulder on both sides.
    bar.cut(sweep.line(&blade, point(26., -30.), point(15., -30.)));
    near(bar.area_mm2(), 1500.0 - 30.0);
    let hook = Outline::polygon(&[
        point(0., -2.),
        point(0., 5.),
        point(2., 5.),
        point(2., 2.),
        point(14., 2.),
        point(14., 1.),
        point(2., 1.),
        point(2., -2.),
    ]);
    let hook = Cutter::new(&hook.expect("a hook"));
    let removed = bar.cut(sweep.rest(&hook, point(15., -30.)));
    near(removed.area_mm2, 8.0);
    assert_eq!(bar.rings(-31.0), vec![(0.0, 15.0), (17.0, 25.0)]);
    assert_eq!(bar.rings(-26.0), vec![(0.0, 15.0), (17.0, 25.0)]);
    assert_eq!(bar.rings(-28.5), vec![(0.0, 15.0)]);
    // A groove in the face.
    let trepan = Cutter::new(&Outline::rectangle(point(0., 0.), point(3., 15.)).expect("a blade"));
    let removed = bar.cut(sweep.line(&trepan, point(10., 1.), point(10., -5.)));
    near(removed.area_mm2, 15.0);
    assert_eq!(bar.rings(-2.0), vec![(0.0, 10.0), (13.0, 25.0)]);
}

#[test]
fn a_drill_leaves_its_cone() {
    let tip = 5.0 / (59f64.to_radians()).tan();
    let drill =
        Outline::polygon(&[point(0., 0.), point(5., tip), point(5., 60.), point(-5., 60.), point(-5., tip)]);
    let drill = Cutter::new(&drill.expect("a drill"));
    let mut bar = Section::bar(20.0, -60.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    let removed = bar.cut(sweep.line(&drill, point(0., 2.), point(0., -30.)));
    near(removed.volume_mm3, PI * 25.0 * (30.0 - tip) + PI * 25.0 * tip / 3.0);
    assert_eq!(bar.rings(-20.0), vec![(5.0, 20.0)]);
}

#[test]
fn a_hollow_form_tool_cuts_a_bead_within_its_tolerance() {
    // A tool 10 wide with a hollow of R4 in its edge.
    let bend = Some(Bend { centre: point(0., 5.), clockwise: true });
    let outline = Outline::new(vec![
        line(point(0., 0.), point(0., 1.)),
        Segment {
            start: point(0., 1.),
            end: point(0., 9.),
            bend: bend.map(|bend| Bend { clockwise: true, ..bend }),
        },
        line(point(0., 9.), point(0., 10.)),
        line(point(0., 10.), point(15., 10.)),
        line(point(15., 10.), point(15., 0.)),
        line(point(15., 0.), point(0., 0.)),
    ])
    .expect("a form tool");
    let cutter = Cutter::new(&outline);
    let mut bar = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    let removed = bar.cut(sweep.line(&cutter, point(26., -30.), point(20., -30.)));
    let exact = 50.0 - 8.0 * PI;
    assert!(
        removed.area_mm2 >= exact - 1e-9 && removed.area_mm2 < exact + 8.0 * PI * 1e-4,
        "{}",
        removed.area_mm2
    );
}

#[test]
fn contours_are_few_and_keep_arcs_whole() {
    let mut bar = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    let outline = |bar: &Section| {
        let contours = bar.contours();
        contours.iter().map(|contour| contour.segments.len()).collect::<Vec<_>>()
    };
    assert_eq!(outline(&bar), [4]);
    let disc = Outline::circle(point(12., -20.), 4.0).expect("a disc");
    bar.cut_hole(&disc);
    // A bar with a cavity all round: two half circles, clockwise.
    assert_eq!(outline(&bar), [4, 2]);
    let cavity = &bar.contours()[1];
    near(cavity.area_mm2(), -16.0 * PI);
    assert!(cavity.segments.iter().all(|arc| arc.bend.is_some_and(|bend| bend.clockwise)));
    // A step with a nose: face, cylinder, fillet, shoulder, cylinder, end, axis.
    let mut step = Section::bar(25.0, -60.0, 0.0).expect("a bar");
    let mut sweep = Sweep::new();
    let square = Outline::rectangle(point(0., 0.), point(12., 12.)).expect("a square");
    step.cut(sweep.line(&Cutter::new(&square), point(20., 2.), point(20., -30.)));
    assert_eq!(outline(&step), [6]);
    let first = step.contours()[0].segments[0];
    assert_eq!((first.start, first.end), (point(0., -60.), point(0., 0.)));
}

#[test]
fn a_groove_under_a_bore_lets_go_of_what_hung_on_a_neck() {
    // A cup with walls from 15 to 20 and a bottom from Z-30 to Z-20. A groove from outside takes the bottom down to 14,
    // and ends exactly where the bore does: nothing but the line at Z-20 was left between wall and bottom.
    let mut bar = Section::bar(20.0, -60.0, 0.0).expect("a bar");
    bar.cut_hole(&Outline::rectangle(point(0., -20.), point(15., 0.)).expect("a bore"));
    let mut groove = |from: f64, depth: f64| {
        bar.cut_hole(&Outline::rectangle(point(depth, from), point(21., -20.)).expect("a groove")).may_part
    };
    assert!(!groove(-24.0, 15.5));
    assert!(groove(-24.0, 14.0));
    let fallen = bar.drop_pieces(|piece| piece.bounds.min.z > -21.0);
    assert_eq!(fallen.len(), 1);
    near(fallen[0].area_mm2, 100.0);
}
