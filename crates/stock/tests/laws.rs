//! Laws on seeded random tools and ways, many of them on a coarse grid, where edges lie on each other, touch and meet
//! in corners all the time.

mod random;

use random::{Random, Way, point};
use turnwright_geometry::{Outline, Point};
use turnwright_stock::{Cutter, Removed, Section, Sweep};

fn cut(section: &mut Section, sweep: &mut Sweep, tool: &Outline, way: &Way) -> Removed {
    section.cut(way.sweep(sweep, &Cutter::new(tool)))
}

/// Some tools and ways, and a blank.
fn job(random: &mut Random, count: usize) -> (Section, Vec<(Outline, Way)>) {
    let blank =
        if random.chance(2) { Section::bar(20.0, -40.0, 0.0) } else { Section::tube(6.0, 20.0, -40.0, 0.0) };
    let mut blank = blank.expect("a blank");
    if random.chance(5) {
        notch(&mut blank);
    }
    let cuts = (0..count).map(|_| (random.tool(), random.way())).collect();
    (blank, cuts)
}

/// Small notches all along the outside, so that the section is held in many chunks.
fn notch(blank: &mut Section) {
    let disc = Cutter::new(&Outline::circle(Point::default(), 0.15).expect("a disc"));
    let mut sweep = Sweep::new();
    for index in 0..130 {
        blank.cut(sweep.rest(&disc, point(20.0, -0.3 * f64::from(index) - 0.2)));
    }
    assert!(blank.slab_count() > 100);
}

#[test]
fn what_is_passed_over_is_gone_and_the_rest_is_still_there() {
    for seed in 1..=25 {
        let mut random = Random::new(seed);
        let (blank, cuts) = job(&mut random, 6);
        let (mut section, mut sweep) = (blank.clone(), Sweep::new());
        for (tool, way) in &cuts {
            cut(&mut section, &mut sweep, tool, way);
        }
        for _ in 0..25 {
            let place = point(random.between(0.0, 21.0), random.between(-41.0, 1.0));
            // The tool takes what it passes over on the other side of the axis, too.
            let mirror = Point { x: -place.x, ..place };
            let margin = |(tool, way): &(Outline, Way)| {
                random::clearance(tool, way, place).min(random::clearance(tool, way, mirror))
            };
            let clearance = cuts.iter().map(margin).fold(f64::INFINITY, f64::min);
            let expected = blank.contains(place) && clearance > 0.0;
            // Too near to an edge for places tried one by one.
            if clearance.abs() < 0.05 {
                continue;
            }
            assert_eq!(section.contains(place), expected, "seed {seed}, {place:?}, clearance {clearance}");
        }
    }
}

#[test]
fn cuts_may_come_in_any_order_and_twice() {
    for seed in 1..=800 {
        let mut random = Random::new(seed);
        let (blank, mut cuts) = job(&mut random, 8);
        let mut sweep = Sweep::new();
        let mut areas = Vec::new();
        for _ in 0..3 {
            let mut section = blank.clone();
            let (mut area, mut volume) = (section.area_mm2(), section.volume_mm3());
            for (tool, way) in &cuts {
                let removed = cut(&mut section, &mut sweep, tool, way);
                assert!(removed.area_mm2 >= -1e-12, "seed {seed}: {removed:?}");
                area -= removed.area_mm2;
                volume -= removed.volume_mm3;
            }
            // What was taken and what is left are the whole.
            assert!((section.area_mm2() - area).abs() < 1e-9, "seed {seed}: {}", section.area_mm2() - area);
            assert!((section.volume_mm3() - volume).abs() < 1e-6, "seed {seed}");
            areas.push(area);
            for (tool, way) in &cuts {
                way.sweep(&mut sweep, &Cutter::new(tool));
                let left = section.touches(&sweep).map_or(0.0, |contact| contact.area_mm2);
                let removed = section.cut(&sweep);
                assert!((left - removed.area_mm2).abs() < 1e-15, "seed {seed}");
                assert!(removed.area_mm2 < 1e-7, "seed {seed}: again {removed:?}");
            }
            random.shuffle(&mut cuts);
        }
        for area in &areas {
            assert!((area - areas[0]).abs() < 1e-7, "seed {seed}: {areas:?}");
        }
    }
}

#[test]
fn a_way_in_pieces_is_the_whole_way() {
    for seed in 1..=600 {
        let mut random = Random::new(seed);
        let (blank, cuts) = job(&mut random, 1);
        let (tool, way) = &cuts[0];
        let mut sweep = Sweep::new();
        let (mut whole, mut parted) = (blank.clone(), blank);
        cut(&mut whole, &mut sweep, tool, way);
        for piece in way.pieces(1 + random.below(6)) {
            cut(&mut parted, &mut sweep, tool, &piece);
        }
        let difference = whole.area_mm2() - parted.area_mm2();
        assert!(difference.abs() < 1e-7, "seed {seed}: {difference}");
    }
}

#[test]
fn contours_enclose_what_the_section_covers() {
    for seed in 1..=1_500 {
        let mut random = Random::new(seed);
        let (mut section, cuts) = job(&mut random, 7);
        let mut sweep = Sweep::new();
        for (tool, way) in &cuts {
            cut(&mut section, &mut sweep, tool, way);
        }
        let contours = section.contours();
        let enclosed: f64 = contours.iter().map(|contour| contour.area_mm2()).sum();
        assert!(
            (enclosed - section.area_mm2()).abs() < 1e-5,
            "seed {seed}: {}",
            enclosed - section.area_mm2()
        );
        for contour in &contours {
            let next = contour.segments.iter().cycle().skip(1);
            assert!(
                contour.segments.iter().zip(next).all(|(one, next)| one.end == next.start),
                "seed {seed}"
            );
        }
        // Every piece has one loop round it; the other loops are cavities.
        let pieces = section.pieces();
        let round = contours.iter().filter(|contour| contour.area_mm2() > 1e-5).count();
        let solid = pieces.iter().filter(|piece| piece.area_mm2 > 1e-5).count();
        assert_eq!(round, solid, "seed {seed}");
        let of_pieces: f64 = pieces.iter().map(|piece| piece.area_mm2).sum();
        assert!((of_pieces - section.area_mm2()).abs() < 1e-9, "seed {seed}");
    }
}

#[test]
fn a_section_less_another_and_what_they_share_are_the_whole() {
    for seed in 1..=600 {
        let mut random = Random::new(seed);
        let (blank, cuts) = job(&mut random, 8);
        let mut sweep = Sweep::new();
        let (mut one, mut other) = (blank.clone(), blank);
        for (index, (tool, way)) in cuts.iter().enumerate() {
            cut(if index % 2 == 0 { &mut one } else { &mut other }, &mut sweep, tool, way);
        }
        let mut too_much = one.clone();
        let shared = too_much.cut_section(&other).area_mm2;
        let mut too_little = other.clone();
        let shared_too = too_little.cut_section(&one).area_mm2;
        assert!((shared - shared_too).abs() < 1e-7, "seed {seed}: {shared} {shared_too}");
        assert!((too_much.area_mm2() + shared - one.area_mm2()).abs() < 1e-9, "seed {seed}");
        let mut nothing = one.clone();
        nothing.cut_section(&one);
        assert!(nothing.area_mm2() < 1e-7, "seed {seed}: {}", nothing.area_mm2());
        assert_eq!(nothing.bounds(), None, "seed {seed}");
    }
}

#[test]
fn spans_and_rings_see_the_same_material() {
    for seed in 1..=300 {
        let mut random = Random::new(seed);
        let (mut section, cuts) = job(&mut random, 5);
        let mut sweep = Sweep::new();
        for (tool, way) in &cuts {
            cut(&mut section, &mut sweep, tool, way);
        }
        for _ in 0..20 {
            let place = point(random.between(0.0, 21.0), random.between(-41.0, 1.0));
            let in_ring = section.rings(place.z).iter().any(|ring| ring.0 <= place.x && place.x <= ring.1);
            let in_span = section.spans(place.x).iter().any(|span| span.0 <= place.z && place.z <= span.1);
            assert_eq!((in_ring, in_span), (section.contains(place), section.contains(place)), "seed {seed}");
        }
    }
}

#[test]
fn nothing_comes_apart_unsaid() {
    let mut parted = 0;
    for seed in 1..=500 {
        let mut random = Random::new(seed);
        let (mut section, cuts) = job(&mut random, 14);
        let mut sweep = Sweep::new();
        let mut pieces = section.pieces().len();
        for (tool, way) in &cuts {
            let removed = cut(&mut section, &mut sweep, tool, way);
            let now = section.pieces().len();
            assert!(removed.may_part || now <= pieces, "seed {seed}: {pieces} pieces became {now}");
            parted += usize::from(removed.may_part && now > pieces);
            pieces = now;
        }
    }
    assert!(parted > 50, "{parted}");
}
