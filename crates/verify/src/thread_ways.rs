//! The way that threads have before the work and behind their last full turn.
//!
//! In: thread moves on the section as it is without any grooves of threads. Out: for each line the least [`ThreadWay`],
//! along the long axis of the thread. A thread that leaves the work by itself in its last move (a chamfer, J and K) has
//! the way of that move behind it; one that stops inside has none.

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command};
use turnwright_geometry::{Bounds, Point};
use turnwright_stock::Section;

/// Places looked at along a move.
const STEPS: u32 = 512;

/// Halvings of a step in which the work begins or ends: to a thousandth of a millimetre on any way.
const HALVINGS: u32 = 12;

/// Of stock that is only inferred, the program itself must have cut so far behind the end of a thread, mm.
const BEHIND_MM: f64 = 1.0;

/// The ways of a thread, mm along its long axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadWay {
    /// From the start to the work; nothing when it never meets any.
    pub lead_in_mm: Option<f64>,
    /// From the end of the last full turn to the end of the motion; nothing when nobody knows what is there.
    pub run_out_mm: Option<f64>,
    /// X is the long axis.
    pub is_along_x: bool,
}

/// A line: program text and number.
type Line = (u32, u32);

/// Looks at thread moves.
#[derive(Clone, Debug, Default)]
pub(crate) struct ThreadWays {
    ways: BTreeMap<Line, (ThreadWay, Ending)>,
    chain: Option<Chain>,
    /// Round all that was cut by feeding.
    cut: Option<Bounds>,
}

/// Where a chain ended, and which way it went.
#[derive(Clone, Copy, Debug)]
struct Ending {
    at: Point,
    /// Sign of the way along the long axis.
    sign: f64,
}

/// The moves of a thread so far.
#[derive(Clone, Copy, Debug)]
struct Chain {
    line: Line,
    lead_in_mm: f64,
    has_met: bool,
    run_out_mm: f64,
    is_along_x: bool,
    ending: Ending,
}

impl ThreadWays {
    /// A cut by feeding took something.
    pub(crate) fn note_cut(&mut self, bounds: Bounds) {
        let cut = self.cut.get_or_insert(bounds);
        cut.min = Point { x: cut.min.x.min(bounds.min.x), z: cut.min.z.min(bounds.min.z) };
        cut.max = Point { x: cut.max.x.max(bounds.max.x), z: cut.max.z.max(bounds.max.z) };
    }

    /// A thread move, before it is cut.
    pub(crate) fn add(&mut self, command: &Command, from: Point, to: Point, section: &Section) {
        let Action::Thread { is_chained, .. } = &command.action else { return };
        // On the axis taps go into holes; floating holders and the hole give them their way.
        if from.x == 0.0 && to.x == 0.0 {
            return;
        }
        let (dx, dz) = (to.x - from.x, to.z - from.z);
        let is_along_x = dx.abs() > dz.abs();
        let long_mm = dx.abs().max(dz.abs());
        let sign = if is_along_x { dx } else { dz }.signum();
        let ending = Ending { at: to, sign };
        let is_inside = |part: f64| section.contains(Point { x: from.x + dx * part, z: from.z + dz * part });
        if !is_chained {
            self.finish_chain();
        }
        let is_first = self.chain.is_none();
        let chain = self.chain.get_or_insert(Chain {
            line: (command.origin.source, command.origin.line),
            lead_in_mm: 0.0,
            has_met: false,
            run_out_mm: 0.0,
            is_along_x,
            ending,
        });
        chain.ending = ending;
        let (start, end) = (is_inside(0.0), is_inside(1.0));
        if !is_first && start && !end {
            // It leaves the work by itself.
            chain.run_out_mm = long_mm;
            return;
        }
        let met = first_inside(&is_inside);
        if !chain.has_met {
            chain.lead_in_mm += met.unwrap_or(1.0) * long_mm;
            chain.has_met = met.is_some();
        }
        chain.run_out_mm = match met {
            Some(_) if end => 0.0,
            Some(_) => first_inside(&|part| is_inside(1.0 - part)).unwrap_or(0.0) * long_mm,
            None => chain.run_out_mm + long_mm,
        };
    }

    /// No move that goes on with the thread comes.
    pub(crate) fn finish_chain(&mut self) {
        let Some(chain) = self.chain.take() else { return };
        let way = ThreadWay {
            lead_in_mm: chain.has_met.then_some(chain.lead_in_mm),
            run_out_mm: chain.has_met.then_some(chain.run_out_mm),
            is_along_x: chain.is_along_x,
        };
        let least = |one: Option<f64>, other: Option<f64>| match (one, other) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        };
        let (known, ending) = self.ways.entry(chain.line).or_insert((way, chain.ending));
        known.lead_in_mm = least(known.lead_in_mm, way.lead_in_mm);
        known.run_out_mm = least(known.run_out_mm, way.run_out_mm);
        *ending = chain.ending;
    }

    /// The ways by line. Where the stock is only inferred, nobody knows what lies behind a thread unless the program
    /// itself has cut there.
    pub(crate) fn finish(mut self, has_stock: bool) -> BTreeMap<Line, ThreadWay> {
        self.finish_chain();
        let cut = self.cut;
        let reaches = |way: &ThreadWay, ending: &Ending| {
            cut.is_some_and(|cut| {
                let (low, high, at) = if way.is_along_x {
                    (cut.min.x, cut.max.x, ending.at.x)
                } else {
                    (cut.min.z, cut.max.z, ending.at.z)
                };
                if ending.sign < 0.0 { low < at - BEHIND_MM } else { high > at + BEHIND_MM }
            })
        };
        let ways = self.ways.into_iter().map(|(line, (way, ending))| {
            let is_known = has_stock || reaches(&way, &ending);
            (line, ThreadWay { run_out_mm: way.run_out_mm.filter(|_| is_known), ..way })
        });
        ways.collect()
    }
}

/// The part of a way after which it is inside for the first time.
fn first_inside(is_inside: &dyn Fn(f64) -> bool) -> Option<f64> {
    let part = |step: u32| f64::from(step) / f64::from(STEPS);
    let step = (0..=STEPS).find(|step| is_inside(part(*step)))?;
    if step == 0 {
        return Some(0.0);
    }
    let (mut outside, mut inside) = (part(step - 1), part(step));
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(outside, inside);
        if is_inside(middle) { inside = middle } else { outside = middle }
    }
    Some(inside)
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{Origin, Shape};
    use turnwright_units::{Angle, Lead, Length, Position, Radius};

    use super::*;

    fn thread(line: u32, is_chained: bool) -> Command {
        let action = Action::Thread {
            to: Position::new(Radius::ZERO, Length::ZERO),
            shape: Shape::Line,
            lead: Lead(Length::from_mm(1)),
            lead_end: None,
            start_angle: Angle::ZERO,
            is_chained,
        };
        Command::new(action, Origin::line(line))
    }

    fn at(x: f64, z: f64) -> Point {
        Point { x, z }
    }

    /// The way of a chain of places on a bar of radius 20 from Z-50 to Z0.
    fn way(places: &[Point], has_stock: bool) -> ThreadWay {
        let bar = Section::bar(20.0, -50.0, 0.0).expect("a bar");
        let mut ways = ThreadWays::default();
        for (index, ends) in places.windows(2).enumerate() {
            ways.add(&thread(1, index > 0), ends[0], ends[1], &bar);
        }
        ways.finish(has_stock)[&(0, 1)]
    }

    fn is_near(one: Option<f64>, other: f64) -> bool {
        one.is_some_and(|one| (one - other).abs() < 1e-3)
    }

    #[test]
    fn along_z_and_along_x_the_way_to_the_work_is_that_of_the_long_axis() {
        let along_z = way(&[at(19.0, 3.0), at(19.0, -20.0)], true);
        assert!(is_near(along_z.lead_in_mm, 3.0) && along_z.run_out_mm == Some(0.0), "{along_z:?}");
        // A scroll from outside on the face, and one from the axis outwards over the edge.
        let inwards = way(&[at(22.0, -1.0), at(5.0, -1.0)], true);
        assert!(inwards.is_along_x && is_near(inwards.lead_in_mm, 2.0), "{inwards:?}");
        let over = way(&[at(5.0, -1.0), at(23.0, -1.0)], true);
        assert!(is_near(over.lead_in_mm, 0.0) && is_near(over.run_out_mm, 3.0), "{over:?}");
        // A taper: one long, three across.
        let taper = way(&[at(20.5, 6.0), at(18.5, 0.0), at(16.0, -30.0)], true);
        assert!(is_near(taper.lead_in_mm, 6.0), "{taper:?}");
    }

    #[test]
    fn a_chamfer_gives_its_own_way_and_a_free_end_what_is_left() {
        let chamfer = way(&[at(19.0, 3.0), at(19.0, -18.5), at(20.5, -20.0)], true);
        assert!(is_near(chamfer.run_out_mm, 1.5), "{chamfer:?}");
        let through = way(&[at(19.0, 3.0), at(19.0, -52.0)], true);
        assert!(is_near(through.run_out_mm, 2.0), "{through:?}");
        // It never meets the work.
        let beside = way(&[at(21.0, 3.0), at(21.0, -20.0)], true);
        assert_eq!((beside.lead_in_mm, beside.run_out_mm), (None, None));
    }

    #[test]
    fn of_inferred_stock_the_end_counts_only_where_the_program_has_cut_behind_it() {
        assert_eq!(way(&[at(19.0, 3.0), at(19.0, -20.0)], false).run_out_mm, None);
        let bar = Section::bar(20.0, -50.0, 0.0).expect("a bar");
        for (behind, known) in [(-20.5, None), (-25.0, Some(0.0))] {
            let mut ways = ThreadWays::default();
            ways.note_cut(Bounds { min: at(18.0, behind), max: at(20.0, 0.0) });
            ways.add(&thread(1, false), at(19.0, 3.0), at(19.0, -20.0), &bar);
            assert_eq!(ways.finish(false)[&(0, 1)].run_out_mm, known, "{behind}");
        }
    }
}
