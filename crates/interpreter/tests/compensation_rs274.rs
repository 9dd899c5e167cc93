//! Nose compensation beside LinuxCNC's interpreter: where both mean the same, their paths are the same.
//!
//! The common subset: lines and arcs with inside corners and tangent joints (LinuxCNC passes outside corners on arcs),
//! from the end of the first element on (it leads onto the path in a way of its own). LinuxCNC numbers tips as seen
//! with X downward.
//!
//! Needs `rs274` (Debian: `linuxcnc-uspace`) and fails without it; `TURNWRIGHT_WITHOUT_RS274=1` leaves it out.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "tests run programs and write files"
)]

mod support;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use support::{Conditions, run_on};
use turnwright_canon::{Action, Shape};
use turnwright_control::Control;
use turnwright_dice::Dice;

/// 0.03 inch: LinuxCNC reads its tool table in inches.
const RADIUS_MM: f64 = 0.762;
/// Tips of ours, as LinuxCNC numbers them.
const ORIENTATIONS: [u8; 10] = [9, 4, 3, 2, 1, 5, 8, 7, 6, 9];
/// LinuxCNC prints four places, ours are rounded to 0.001 in diameter.
const NEAR_MM: f64 = 0.001_1;

/// Where a move ends and, of an arc, its centre: X as a radius, Z.
type Move = ((f64, f64), Option<(f64, f64)>);

/// The end of an element, and of an arc the radius and whether it is clockwise.
type Cut = ((f64, f64), Option<(f64, bool)>);

/// A contour that turns only towards the nose.
struct Contour {
    left: bool,
    tip: u8,
    lead_in: (f64, f64),
    start: (f64, f64),
    elements: Vec<Cut>,
    lead_out: (f64, f64),
}

fn rounded(mm: f64) -> f64 {
    (mm * 1000.0).round() / 1000.0
}

fn contour(dice: &mut Dice) -> Contour {
    let left = dice.one_in(2);
    let to_nose = if left { 1.0 } else { -1.0 };
    let mut heading = dice.between(0.0, 360.0);
    let mut at = (rounded(dice.between(40.0, 60.0)), rounded(dice.between(-20.0, 20.0)));
    let ahead = |at: (f64, f64), heading: f64, way: f64| {
        let angle = heading.to_radians();
        (rounded(at.0 + way * angle.sin()), rounded(at.1 + way * angle.cos()))
    };
    let (start, lead_in) = (at, ahead(at, heading + to_nose * 90.0, 9.0));
    let mut elements = Vec::new();
    let mut turned = 0.0;
    while elements.len() < 6 && turned < 120.0 {
        let length = dice.between(5.0, 11.0);
        let turn = dice.between(15.0, 60.0);
        let is_first = elements.is_empty();
        if !is_first && dice.one_in(2) {
            // Towards the nose or away from it; tangent to what lies before.
            let sense = if dice.one_in(2) { to_nose } else { -to_nose };
            let radius = length / 2.0 / (turn / 2.0).to_radians().sin();
            at = ahead(at, heading + sense * turn / 2.0, length);
            elements.push((at, Some((rounded(radius), sense < 0.0))));
            heading += sense * turn;
            turned += turn;
        } else {
            at = ahead(at, heading, length);
            elements.push((at, None));
        }
        // What follows an arc is far enough from tangent, or a line: rounded ends turn an arc a little away.
        let corner = dice.between(8.0, 60.0);
        heading += to_nose * corner;
        turned += corner;
    }
    let lead_out = ahead(at, heading + to_nose * 60.0, 9.0);
    Contour { left, tip: (dice.roll() % 10) as u8, lead_in, start, elements, lead_out }
}

impl Contour {
    /// The contour in the words of either; `scale` makes X a diameter.
    fn text(&self, scale: f64, head: &str, end: &str) -> String {
        let word = |(x, z): (f64, f64)| format!("X{:.3} Z{z:.3}", x * scale);
        let side = if self.left { "G41" } else { "G42" };
        let mut text = format!("{head}\nG00 {}\n{side} G01 {}\n", word(self.lead_in), word(self.start));
        for (to, arc) in &self.elements {
            match arc {
                None => text.push_str(&format!("G01 {}\n", word(*to))),
                Some((radius, clockwise)) => {
                    let code = if *clockwise { 2 } else { 3 };
                    text.push_str(&format!("G0{code} {} R{radius:.3}\n", word(*to)));
                }
            }
        }
        text.push_str(&format!("G40 G01 {}\n{end}\n", word(self.lead_out)));
        text
    }

    /// The moves of the contour here: from the end of the first element to that of the last.
    fn ours(&self) -> Result<Vec<Move>, String> {
        static CONTROL: OnceLock<Control> = OnceLock::new();
        let control = CONTROL.get_or_init(|| Control::load("fanuc-0i-tf").expect("a control"));
        let mut conditions = Conditions::default().with("3410", "0");
        conditions.setup = format!("[offsets.1]\ngeometry = {{ r = {RADIUS_MM} }}\ntip = {}\n", self.tip);
        let run = run_on(control.clone(), self.text(2.0, "G98 F100. T0101", "M30").as_bytes(), &conditions);
        if let Some(alarm) = &run.alarm {
            return Err(alarm.key.to_string());
        }
        let moves = run.commands.iter().filter(|command| command.nose.is_some() && command.origin.line >= 4);
        let seen = moves.filter_map(|command| {
            let to = command.action.end_point()?;
            let centre = match &command.action {
                Action::Feed { shape: Shape::Arc { centre, .. }, .. } => {
                    Some((centre.x.to_mm(), centre.z.to_mm()))
                }
                _ => None,
            };
            Some(((to.x.to_mm(), to.z.to_mm()), centre))
        });
        Ok(seen.collect())
    }

    /// The same moves as LinuxCNC gives them.
    fn theirs(&self, folder: &Path) -> Result<Vec<Move>, String> {
        let orientation = ORIENTATIONS[usize::from(self.tip)];
        let table = format!("T1 P1 D{} Q{orientation} ;\n", 2.0 * RADIUS_MM / 25.4);
        fs::write(folder.join("tools.tbl"), table).expect("writable");
        let head = "G21 G18 G8 G40 G90 F100\nT1 M6";
        fs::write(folder.join("contour.ngc"), self.text(1.0, head, "M2")).expect("writable");
        let output = Command::new("rs274")
            .args(["-g", "-t", "tools.tbl", "contour.ngc"])
            .current_dir(folder)
            .env("HOME", folder)
            .output()
            .expect("rs274 runs");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        let numbers = |line: &str| -> Vec<f64> {
            let inside = line.split_once('(').map_or("", |(_, rest)| rest.trim_end_matches(')'));
            inside.split(',').map(|number| number.trim().parse().expect("a number")).collect()
        };
        Ok(text
            .lines()
            .filter_map(|line| {
                if line.contains("STRAIGHT_FEED(") {
                    let place = numbers(line);
                    Some(((place[0], place[2]), None))
                } else if line.contains("ARC_FEED(") {
                    let place = numbers(line);
                    Some(((place[1], place[0]), Some((place[3], place[2]))))
                } else {
                    None
                }
            })
            .collect())
    }
}

#[test]
fn inside_corners_and_tangent_joints_are_those_of_linuxcnc() {
    if std::env::var_os("TURNWRIGHT_WITHOUT_RS274").is_some_and(|value| value == "1") {
        eprintln!("left out: TURNWRIGHT_WITHOUT_RS274=1");
        return;
    }
    assert!(
        Command::new("rs274").arg("-h").output().is_ok(),
        "rs274 is not installed (Debian: linuxcnc-uspace); TURNWRIGHT_WITHOUT_RS274=1 leaves this test out"
    );
    let folder = std::env::temp_dir().join(format!("turnwright-rs274-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("writable");
    let mut dice = Dice::new(274);
    let (mut compared, mut refused) = (0, 0);
    for round in 0..200 {
        let contour = contour(&mut dice);
        let told = || format!("round {round} tip {}\n{}", contour.tip, contour.text(2.0, "", "M30"));
        let (ours, theirs) = match (contour.ours(), contour.theirs(&folder)) {
            (Ok(ours), Ok(theirs)) => (ours, theirs),
            // Each looks for overcuts in its own way.
            _ => {
                refused += 1;
                continue;
            }
        };
        // The way onto the path, the first element up to its end, …
        assert!(theirs.len() >= ours.len(), "{ours:?}\n{theirs:?}\n{}", told());
        let theirs = &theirs[theirs.len() - ours.len()..];
        assert!(ours.len() > contour.elements.len(), "{ours:?}\n{}", told());
        for (own, peer) in ours.iter().zip(theirs) {
            let near = |(x, z): (f64, f64), (other_x, other_z): (f64, f64)| {
                (x - other_x).abs() <= NEAR_MM && (z - other_z).abs() <= NEAR_MM
            };
            assert!(near(own.0, peer.0), "{own:?} {peer:?}\n{ours:?}\n{theirs:?}\n{}", told());
            // A centre is as sharp as the arc is long.
            if let (Some(centre), Some(other)) = (own.1, peer.1) {
                assert!(
                    (centre.0 - other.0).hypot(centre.1 - other.1) < 0.02,
                    "{own:?} {peer:?}\n{}",
                    told()
                );
            }
            assert_eq!(own.1.is_some(), peer.1.is_some(), "{own:?} {peer:?}\n{}", told());
        }
        compared += 1;
    }
    fs::remove_dir_all(&folder).expect("removable");
    assert!(compared > 100, "{compared} compared, {refused} refused");
}
