//! Threads in every half-plane: hand, lead, starts and volume by hand calculation, and the limits.

use turnwright_canon::{Action, Command, Origin, RapidPath, Shape, SpindleSpeed, SpindleState};
use turnwright_geometry::{Outline, Point};
use turnwright_stock::machining::{
    HalfPlanes, RapidRates, TooLong, ToolShape, WOUND_COMMANDS_MAX, WOUND_CUTS_MAX,
};
use turnwright_stock::{Machining, Section};
use turnwright_units::{Angle, Feed, FeedPerRevolution, Lead, Length, Position, Radius, Rpm, WorkTip};

const RATES: RapidRates = RapidRates { x_mm_per_min: 10_000.0, z_mm_per_min: 20_000.0 };
const QUARTERS: usize = 4;

fn length(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn place(diameter: f64, z: f64) -> Position<WorkTip> {
    Position::new(Radius(length(diameter / 2.0)), length(z))
}

fn rapid(diameter: f64, z: f64) -> Action {
    Action::Rapid { to: place(diameter, z), path: RapidPath::Straight, others: None }
}

fn feed(diameter: f64, z: f64) -> Action {
    let feed = Feed::PerRevolution(FeedPerRevolution(length(0.2)));
    Action::Feed { to: place(diameter, z), shape: Shape::Line, feed, others: None }
}

fn thread(to: (f64, f64), leads: (f64, f64), start_deg: i64) -> Action {
    Action::Thread {
        to: place(to.0, to.1),
        shape: Shape::Line,
        lead: Lead(length(leads.0)),
        lead_end: (leads.0 != leads.1).then(|| Box::new(Lead(length(leads.1)))),
        start_angle: Angle::from_millidegrees(start_deg * 1_000),
        is_chained: false,
    }
}

fn polygon(corners: &[(f64, f64)]) -> Outline {
    let points: Vec<Point> = corners.iter().map(|&(x, z)| Point::new(x, z)).collect();
    Outline::polygon(&points).expect("an outline")
}

/// A bar of 40 (or a tube of 40 with a bore of 20) from Z-60 to Z0; tool 3 cuts threads outside, 4 inside, 5 on the face,
/// 2 parts off. What is cut is kept for all half-planes.
struct Lathe {
    machining: Machining,
    half_planes: Option<HalfPlanes>,
}

impl Lathe {
    fn new(bore: f64, spindle: SpindleState) -> Self {
        let section = Section::tube(bore / 2.0, 20.0, -60.0, 0.0).expect("a tube");
        let mut machining = Machining::new(section, place(100.0, 50.0), RATES);
        let half_width = 5.0 / 3f64.sqrt();
        for (number, cutting) in [
            (2, polygon(&[(0., 0.), (0., 3.), (30., 3.), (30., 0.)])),
            (3, polygon(&[(0., 0.), (5., -half_width), (5., half_width)])),
            (4, polygon(&[(0., 0.), (-5., half_width), (-5., -half_width)])),
            (5, polygon(&[(0., 0.), (half_width, 5.), (-half_width, 5.)])),
        ] {
            machining.set_tool(number, &ToolShape { cutting, body: None });
        }
        let mut lathe = Self { machining, half_planes: None };
        lathe.run(&[Action::Spindle {
            state: spindle,
            speed: SpindleSpeed::Constant(Rpm(800)),
            rpm_max: None,
        }]);
        lathe
    }

    fn run(&mut self, actions: &[Action]) {
        for action in actions {
            let command = Command::new(action.clone(), Origin::line(1));
            if matches!(action, Action::Thread { .. }) && self.half_planes.is_none() {
                self.half_planes = Some(HalfPlanes::new(&self.machining));
            }
            if let Some(half_planes) = &mut self.half_planes {
                half_planes.add(&command, &self.machining);
            }
            let parted = self.machining.parted();
            self.machining.advance(&command, &mut |_| {});
            if let Some(half_planes) = self.half_planes.as_mut().filter(|_| self.machining.parted() != parted)
            {
                half_planes.end();
            }
        }
    }

    fn sections(self, count: usize) -> Vec<Section> {
        let half_planes = self.half_planes.and_then(|one| one.finish(&self.machining)).expect("a thread");
        half_planes.sections(count, self.machining.part()).expect("not too long").collect()
    }
}

fn tool(number: u32) -> Action {
    Action::Tool { tool: number, offset: number }
}

/// The places along Z where a groove of 1 mm has its ground, between two Z, in thousandths.
fn grounds(section: &Section, radius: f64, from: f64, to: f64) -> Vec<i64> {
    let edges = section.contours().into_iter().flat_map(|contour| contour.segments);
    let grounds = edges.map(|edge| edge.start).filter(|place| (place.x - radius).abs() < 1e-9);
    let mut grounds: Vec<i64> = grounds
        .filter(|place| from < place.z && place.z < to)
        .map(|place| (place.z * 1e3).round() as i64)
        .collect();
    grounds.sort_unstable();
    grounds.dedup();
    grounds
}

/// M40 x 2, 1 mm deep, from Z4 to Z-20.
fn outside(spindle: SpindleState) -> Vec<Section> {
    let mut lathe = Lathe::new(0.0, spindle);
    lathe.run(&[tool(3), rapid(38., 4.), thread((38., -20.), (2., 2.), 0), rapid(44., -20.)]);
    lathe.sections(QUARTERS)
}

#[test]
fn a_spindle_that_turns_clockwise_cuts_a_right_hand_thread_towards_the_chuck() {
    // At the start the insert is at Z4 over angle zero, so that there the grounds are at even Z. When the spindle has
    // turned a quarter, the insert is 0.5 mm further in, at Z3.5. The work has turned about Z from X towards Y by the
    // right hand (M03 is clockwise as the headstock sees it, and it looks along Z), so that what is under the insert now
    // was at minus 90 degrees, three quarters: there the grounds are at 3.5 - 2 n. By the angle, Z grows: with the thumb
    // along Z the fingers of the right hand go along the groove. It is a right-hand thread.
    let sections = outside(SpindleState::Clockwise);
    assert_eq!(grounds(&sections[0], 19.0, -7.0, -1.0), [-6000, -4000, -2000]);
    assert_eq!(grounds(&sections[1], 19.0, -7.0, -1.0), [-5500, -3500, -1500]);
    assert_eq!(grounds(&sections[2], 19.0, -7.0, -1.0), [-5000, -3000]);
    assert_eq!(grounds(&sections[3], 19.0, -7.0, -1.0), [-6500, -4500, -2500]);
    // The other way round the left hand does.
    let sections = outside(SpindleState::CounterClockwise);
    assert_eq!(grounds(&sections[0], 19.0, -7.0, -1.0), [-6000, -4000, -2000]);
    assert_eq!(grounds(&sections[1], 19.0, -7.0, -1.0), [-6500, -4500, -2500]);
    assert_eq!(grounds(&sections[3], 19.0, -7.0, -1.0), [-5500, -3500, -1500]);
}

#[test]
fn away_from_the_chuck_the_hand_changes_and_inside_it_does_not() {
    let hand = |tool_number: u32, ground: f64, way: [f64; 2]| {
        let mut lathe = Lathe::new(20.0, SpindleState::Clockwise);
        let diameter = 2.0 * ground;
        let aside = if tool_number == 4 { 16. } else { 44. };
        lathe.run(&[tool(tool_number), rapid(aside, 50.), rapid(aside, way[0]), rapid(diameter, way[0])]);
        lathe.run(&[thread((diameter, way[1]), (2., 2.), 0), rapid(aside, way[1])]);
        let sections = lathe.sections(QUARTERS);
        let [first, second] = [0, 1].map(|index| grounds(&sections[index], ground, -9.0, -1.0)[0]);
        (second - first).rem_euclid(2000)
    };
    // Half a millimetre up for each quarter is right, as much down left.
    assert_eq!(hand(3, 19.0, [4., -20.]), 500);
    assert_eq!(hand(3, 19.0, [-20., 4.]), 1500);
    assert_eq!(hand(4, 11.0, [4., -20.]), 500);
    assert_eq!(hand(4, 11.0, [-20., 4.]), 1500);
}

#[test]
fn two_starts_are_two_grooves_that_wind_together() {
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    for start in [0, 180] {
        lathe.run(&[tool(3), rapid(44., 4.), rapid(38., 4.), thread((38., -20.), (4., 4.), start)]);
        lathe.run(&[rapid(44., -20.)]);
    }
    let sections = lathe.sections(8);
    for (index, section) in sections.iter().enumerate() {
        // Half a millimetre an eighth; two grooves a lead.
        let first = -8000 + 500 * (index as i64 % 4);
        let shifted: Vec<i64> =
            (-2..4).map(|n| first + 2000 * n).filter(|z| (-6999..-1000).contains(z)).collect();
        assert_eq!(grounds(section, 19.0, -7.0, -1.0), shifted, "{index}");
    }
}

#[test]
fn what_a_thread_takes_is_the_same_all_round() {
    // From in front of the bar into a recess: the same groove shifted, whole where it is not cut by the ends.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(2), rapid(44., -25.), feed(34., -25.), feed(34., -21.), rapid(44., -21.), tool(3)]);
    lathe.run(&[rapid(44., 4.), rapid(38., 4.), thread((38., -21.5), (2., 2.), 0), rapid(44., -21.5)]);
    let before = Section::bar(20.0, -60.0, 0.0).expect("a bar").volume_mm3();
    let finished = lathe.machining.section().clone();
    let sections = lathe.sections(16);
    assert!((sections[0].volume_mm3() - finished.volume_mm3()).abs() < 1e-9 * before);
    let mean = sections.iter().map(Section::volume_mm3).sum::<f64>() / 16.0;
    for section in &sections {
        // What the ends cut off a groove is less than half of one: 34 mm3.
        assert!((section.volume_mm3() - mean).abs() < 34.0, "{} {mean}", section.volume_mm3());
        // Behind the recess nothing is new, to the last bit.
        assert_eq!(section.rings(-40.0), finished.rings(-40.0));
        assert_eq!(section.spans(18.0), finished.spans(18.0));
    }
}

#[test]
fn tapers_leads_that_grow_and_scrolls_wind_by_their_phase() {
    // Up 1 mm of radius in 20: at a quarter the ground is 0.5 mm up Z, 0.025 mm lower.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(3), rapid(36., 0.), thread((38., -20.), (2., 2.), 0), rapid(44., -20.)]);
    let sections = lathe.sections(QUARTERS);
    assert_eq!(grounds(&sections[0], 18.5, -19.0, -1.0), [-10000]);
    assert_eq!(grounds(&sections[1], 18.475, -19.0, -1.0), [-9500]);
    assert_eq!(grounds(&sections[3], 18.525, -19.0, -1.0), [-10500]);
    // From 1 to 3 mm over 20 mm, 10 turns: after n turns n + n²/10 mm.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(3), rapid(39., 0.), thread((39., -20.), (1., 3.), 0), rapid(44., -20.)]);
    let sections = lathe.sections(QUARTERS);
    let after = |turns: f64| (-1e3 * (turns + turns * turns / 10.0)).round() as i64;
    assert_eq!(grounds(&sections[0], 19.5, -6.0, -2.0), [after(4.0), after(3.0), after(2.0)]);
    // What has turned by -90 degrees to the tool is at three quarters.
    assert_eq!(grounds(&sections[3], 19.5, -6.0, -2.0), [after(3.25), after(2.25)]);
    // A scroll on the face from X44 in: 4 mm of radius a turn, the grounds at Z-1.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(5), rapid(44., -1.), thread((8., -1.), (4., 4.), 0), rapid(8., 5.)]);
    let sections = lathe.sections(QUARTERS);
    let radii = |section: &Section| {
        let edges = section.contours().into_iter().flat_map(|contour| contour.segments);
        let mut radii: Vec<i64> = edges
            .filter(|edge| (edge.start.z + 1.0).abs() < 1e-9)
            .map(|edge| (edge.start.x * 1e3).round() as i64)
            .collect();
        radii.sort_unstable();
        radii
    };
    assert_eq!(radii(&sections[0]), [6000, 10000, 14000, 18000]);
    assert_eq!(radii(&sections[3]), [5000, 9000, 13000, 17000]);
}

#[test]
fn moves_behind_the_thread_are_made_in_every_half_plane_and_the_part_that_came_off_is_meant() {
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(3), rapid(38., 4.), thread((38., -20.), (2., 2.), 0), rapid(44., -20.), tool(2)]);
    // A recess across the thread, then off at Z-30; what is cut then is another bar.
    lathe.run(&[rapid(44., -12.), feed(36., -12.), rapid(44., -12.), rapid(44., -33.), feed(-1., -33.)]);
    lathe.run(&[rapid(44., -33.), rapid(44., -40.), feed(30., -40.), rapid(44., -40.), feed(44., -5.)]);
    let part = lathe.machining.part().clone();
    let sections = lathe.sections(QUARTERS);
    assert!((sections[0].volume_mm3() - part.volume_mm3()).abs() < 1e-9 * part.volume_mm3());
    for section in &sections {
        assert_eq!(section.rings(-10.5), [(0.0, 18.0)]);
        assert_eq!(section.bounds().map(|bounds| (bounds.min.z, bounds.max.z)), Some((-30.0, 0.0)));
    }
    assert_eq!(grounds(&sections[1], 19.0, -7.0, -1.0), [-5500, -3500, -1500]);
    // Threads of the rest of the bar are none of the part's.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(2), rapid(44., -33.), feed(-1., -33.), rapid(44., -33.), tool(3)]);
    lathe.run(&[rapid(38., -30.), thread((38., -50.), (2., 2.), 0), rapid(44., -50.)]);
    assert!(lathe.half_planes.expect("a thread").finish(&lathe.machining).is_none());
}

#[test]
fn too_many_moves_and_too_many_cuts_are_told() {
    let long = |moves: usize| {
        let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
        lathe.run(&[tool(3), rapid(38., 4.), thread((38., -20.), (2., 2.), 0)]);
        lathe.run(&vec![rapid(90., 20.); moves - 1]);
        let part = lathe.machining.part().clone();
        lathe.half_planes.expect("a thread").sections(4, &part).map(Iterator::count)
    };
    assert_eq!(long(WOUND_COMMANDS_MAX), Ok(4));
    assert_eq!(long(WOUND_COMMANDS_MAX + 1), Err(TooLong));
    // The thread is 13 cuts, rapids in its reach are one each.
    let mut lathe = Lathe::new(0.0, SpindleState::Clockwise);
    lathe.run(&[tool(3), rapid(38., 4.), thread((38., -20.), (2., 2.), 0)]);
    let part = lathe.machining.part().clone();
    let half_planes = lathe.half_planes.expect("a thread");
    let most = (WOUND_CUTS_MAX / 13.0) as usize;
    assert!(half_planes.sections(most, &part).is_ok());
    assert!(half_planes.sections(most + 1, &part).is_err());
}
