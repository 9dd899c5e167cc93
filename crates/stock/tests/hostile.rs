//! Numbers that no drawing has: nothing panics, nothing loops, nothing that is no number gets in.

mod random;

use random::{Random, point};
use turnwright_geometry::{Bend, Outline, OutlineFault, Point, Segment};
use turnwright_stock::{Cutter, Section, SectionFault, Sweep};

fn strange(random: &mut Random) -> f64 {
    const NUMBERS: [f64; 18] = [
        0.0,
        -0.0,
        1e-300,
        1e-12,
        1e-9,
        2e-9,
        1e-6,
        -1e-6,
        0.1,
        20.0,
        20.0 + 1e-9,
        -19.999_999_999,
        1e6,
        -1e6,
        1e9,
        f64::MAX,
        f64::INFINITY,
        f64::NAN,
    ];
    NUMBERS[random.below(NUMBERS.len())]
}

fn place(random: &mut Random) -> Point {
    point(strange(random), strange(random))
}

#[test]
fn places_of_any_kind_leave_a_section_of_numbers() {
    for seed in 1..=4_000 {
        let mut random = Random::new(seed);
        let mut section = Section::tube(5.0, 20.0, -40.0, 0.0).expect("a tube");
        let mut sweep = Sweep::new();
        for _ in 0..6 {
            let cutter = Cutter::new(&random.tool());
            let (from, to, centre) = (place(&mut random), place(&mut random), place(&mut random));
            let bend = random.chance(2).then_some(Bend { centre, clockwise: random.chance(2) });
            let way = Segment { start: from, end: to, bend };
            let touched = section.touches(sweep.along(&cutter, &way));
            let removed = section.cut(sweep.along(&cutter, &way));
            assert_eq!(touched.is_some(), removed.bounds.is_some(), "seed {seed}");
            assert!(removed.area_mm2.is_finite() && removed.volume_mm3.is_finite(), "seed {seed}");
        }
        let (area, volume) = (section.area_mm2(), section.volume_mm3());
        assert!((-1e-6..600.0 + 1e-6).contains(&area), "seed {seed}: {area}");
        assert!(volume.is_finite() && volume > -1e-3, "seed {seed}: {volume}");
        let enclosed: f64 = section.contours().iter().map(|contour| contour.area_mm2()).sum();
        assert!((enclosed - area).abs() < 1e-3, "seed {seed}: {enclosed} {area}");
        section.pieces();
    }
}

#[test]
fn outlines_of_any_kind_are_refused_or_work() {
    let mut accepted = 0;
    for seed in 1..=20_000 {
        let mut random = Random::new(seed);
        let mut corners: Vec<Point> = (0..3 + random.below(4)).map(|_| place(&mut random)).collect();
        if random.chance(2) {
            corners
                .iter_mut()
                .for_each(|corner| *corner = point(random.between(-3.0, 3.0), random.between(-3.0, 3.0)));
        }
        let segments = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&start, &end)| {
            let bend =
                random.chance(4).then(|| Bend { centre: place(&mut random), clockwise: random.chance(2) });
            Segment { start, end, bend }
        });
        let Ok(outline) = Outline::new(segments.collect()) else { continue };
        accepted += 1;
        let mut section = Section::bar(30.0, -40.0, 40.0).expect("a bar");
        let mut sweep = Sweep::new();
        section.cut(sweep.line(&Cutter::new(&outline), point(10.0, -3.0), point(12.0, 5.0)));
        assert!(section.area_mm2().is_finite(), "seed {seed}");
    }
    assert!(accepted > 100, "{accepted}");
}

#[test]
fn blanks_that_cannot_be_are_refused() {
    let nowhere = Section::bar(f64::NAN, 0.0, 1.0).err();
    assert!(matches!(nowhere, Some(SectionFault::Outline(OutlineFault::Size(_)))));
    assert!(matches!(Section::bar(0.0, 0.0, 1.0).err(), Some(SectionFault::Outline(_))));
    assert!(matches!(Section::bar(5.0, 1.0, 1.0).err(), Some(SectionFault::Outline(_))));
    assert!(matches!(Section::tube(-1.0, 5.0, 0.0, 9.0).err(), Some(SectionFault::BelowAxis(_))));
    // Given from right to left it is a bar as well.
    assert!(Section::bar(5.0, 0.0, -9.0).is_ok());
}

/// Passes of two micrometres that end at the same shoulder leave a tooth each, a nanometre high: no later cut looks at
/// thousands of them, and the part is what it would be without.
#[test]
fn thousands_of_passes_to_one_shoulder_leave_no_comb() {
    const PASSES: u32 = 3_000;
    let mut section = Section::bar(20.0, -20.0, 0.0).expect("a bar");
    let nose = Cutter::new(&Outline::circle(point(0.0, 0.0), 0.4).expect("a disc"));
    let mut sweep = Sweep::new();
    for pass in 1..=PASSES {
        let height = 20.4 - 0.002 * f64::from(pass);
        section.cut(
            sweep.along(&nose, &Segment { start: point(height, 2.0), end: point(height, -10.0), bend: None }),
        );
    }
    let edges: usize = section.contours().iter().map(|contour| contour.segments.len()).sum();
    assert!(edges < 100, "{edges}");
    // The bar, less the ring down to the last pass; the nose leaves its round in the corner.
    let (depth, left) = (0.002 * f64::from(PASSES), 0.4_f64.powi(2) * (1.0 - std::f64::consts::FRAC_PI_4));
    let area = 20.0 * 20.0 - depth * 10.4 + left;
    assert!((section.area_mm2() - area).abs() < 1e-4, "{} {area}", section.area_mm2());
}
