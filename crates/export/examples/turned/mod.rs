//! Seeded random turned parts, for tests and for the example that writes them.

use turnwright_dice::Dice;
use turnwright_geometry::{Bend, Outline, Point, Segment};
use turnwright_stock::Section;

/// In steps of a quarter of a millimetre three times out of four.
fn between(dice: &mut Dice, low: f64, high: f64) -> f64 {
    let value = dice.between(low, high);
    if dice.one_in(4) { value } else { (value * 4.0).round() / 4.0 }
}

fn polygon(places: &[(f64, f64)]) -> Option<Outline> {
    let places: Vec<Point> = places.iter().map(|(x, z)| Point::new(*x, *z)).collect();
    Outline::polygon(&places).ok()
}

/// A bar or a tube of 20 mm radius and 60 mm with steps, cones, fillets, undercuts, bores and cavities in it.
pub fn part(seed: u64) -> Section {
    let dice = &mut Dice::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let bore = if dice.below(3) == 0 { between(dice, 2.0, 8.0) } else { 0.0 };
    let mut section = Section::tube(bore, 20.0, -60.0, 0.0).expect("a blank");
    for _ in 0..2 + dice.below(8) {
        let z = between(dice, -58.0, 0.0);
        let x = between(dice, 4.0, 20.0);
        let (width, depth) = (between(dice, 1.0, 8.0), between(dice, 1.0, 12.0));
        let hole = match dice.below(9) {
            // Down to a diameter from the front, with a cone at the end.
            0 => polygon(&[(x, 1.0), (30.0, 1.0), (30.0, z - depth), (x, z)]),
            // A groove.
            1 => polygon(&[(x, z), (30.0, z), (30.0, z + width), (x, z + width)]),
            // A round groove, an undercut, a bubble in the material or on the axis.
            2 => Outline::circle(Point::new(x, z), width).ok(),
            3 => Outline::circle(Point::new(20.0, z), width).ok(),
            4 if z - width > -59.0 && z + width < -1.0 => {
                let centre = Point::new(0.0, z);
                let ends = (Point::new(0.0, z + width), Point::new(0.0, z - width));
                let bend = Some(Bend { centre, clockwise: false });
                Outline::new(vec![
                    Segment { start: ends.1, end: ends.0, bend: None },
                    Segment { start: ends.0, end: ends.1, bend },
                ])
                .ok()
            }
            // A drill with its cone, from the front or through.
            5 => polygon(&[(0.0, 1.0), (x / 2.0, 1.0), (x / 2.0, z), (0.0, z - x / 6.0)]),
            6 => polygon(&[(0.0, -61.0), (x / 3.0, -61.0), (x / 3.0, 1.0), (0.0, 1.0)]),
            // A point in front, a ball or a cone to the centre.
            7 => polygon(&[(0.0, 0.0), (25.0, -depth), (25.0, 1.0), (0.0, 1.0)]),
            // A face groove.
            _ => polygon(&[(x, 1.0), (x + width, 1.0), (x + width, -depth), (x, -depth)]),
        };
        if let Some(hole) = hole {
            section.cut_hole(&hole);
        }
    }
    if dice.below(4) == 0 {
        // A round end, of a sphere on the axis or of an arc beside it.
        let radius = between(dice, 14.0, 30.0);
        let centre = Point::new([0.0, 3.0, -5.0][dice.below(3) as usize], -radius);
        if let (Ok(disc), Ok(mut end)) =
            (Outline::circle(centre, radius), Section::tube(0.0, 25.0, -10.0, 5.0))
        {
            end.cut_hole(&disc);
            section.cut_section(&end);
        }
    }
    section
}
