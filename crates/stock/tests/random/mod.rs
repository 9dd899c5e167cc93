//! Seeded tools and ways for tests, and how far a tool on its way stays from a place.

#![allow(dead_code)]

use turnwright_dice::Dice;
use turnwright_geometry::{Bend, Outline, Point, Segment, Vector, sweep_rad};
use turnwright_stock::{Cutter, Sweep};

/// Chance from a seed: a failure names its case.
pub struct Random(Dice);

pub fn point(x: f64, z: f64) -> Point {
    Point::new(x, z)
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Dice::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0.index(count)
    }

    pub fn chance(&mut self, one_in: u64) -> bool {
        self.0.one_in(one_in)
    }

    pub fn shuffle<T>(&mut self, things: &mut [T]) {
        for last in (1..things.len()).rev() {
            let other = self.below(last + 1);
            things.swap(last, other);
        }
    }

    /// On a grid of half millimetres, or anywhere.
    fn coordinate(&mut self, low: f64, high: f64) -> f64 {
        let anywhere = self.between(low, high);
        if self.chance(4) { anywhere } else { (anywhere * 2.0).round() / 2.0 }
    }

    pub fn place(&mut self) -> Point {
        point(self.coordinate(-2.0, 24.0), self.coordinate(-42.0, 4.0))
    }

    /// A disc, a blade, an insert with a round nose in one of four positions, a drill or a hook.
    pub fn tool(&mut self) -> Outline {
        let line = |start: Point, end: Point| Segment { start, end, bend: None };
        let outline = match self.below(6) {
            0 => Outline::circle(point(0., 0.), [0.5, 1.0, 2.0, 6.0][self.below(4)]),
            1 => Outline::rectangle(point(0., 0.), point(12., [2.0, 3.0][self.below(2)])),
            2 | 3 => {
                let (nose, lean) = ([0.4, 0.5, 1.0][self.below(3)], [0.0, 0.5, 3.0][self.below(3)]);
                let bend = Some(Bend { centre: point(nose, nose), clockwise: false });
                let corners = [point(lean, 9.), point(9., 9.), point(9., lean)];
                let insert = Outline::new(vec![
                    Segment { start: point(nose, 0.), end: point(0., nose), bend },
                    line(point(0., nose), corners[0]),
                    line(corners[0], corners[1]),
                    line(corners[1], corners[2]),
                    line(corners[2], point(nose, 0.)),
                ]);
                insert.map(|insert| {
                    let insert = if self.chance(2) { insert.mirrored_in_z() } else { insert };
                    if self.chance(3) { insert.mirrored_in_x() } else { insert }
                })
            }
            4 => Outline::polygon(&[
                point(0., 0.),
                point(3., 2.),
                point(3., 30.),
                point(-3., 30.),
                point(-3., 2.),
            ]),
            _ => Outline::polygon(&[
                point(0., -2.),
                point(0., 5.),
                point(2., 5.),
                point(2., 2.),
                point(14., 2.),
                point(14., 0.),
                point(2., 0.),
                point(2., -2.),
            ]),
        };
        outline.expect("a tool")
    }

    pub fn way(&mut self) -> Way {
        let start = self.place();
        if self.chance(3) {
            let (centre, clockwise) = (self.place(), self.chance(2));
            let arm = Vector::between(centre, start);
            if arm.length() > 0.4 && arm.length() < 30.0 {
                let quarters = Vector { x: arm.z, z: -arm.x };
                let end = match self.below(5) {
                    0 => start,
                    1 => quarters.from(centre),
                    2 => arm.times(-1.0).from(centre),
                    _ => {
                        let angle = self.between(0.0, 6.2);
                        let (sine, cosine) = angle.sin_cos();
                        Vector { x: arm.x * cosine + arm.z * sine, z: arm.z * cosine - arm.x * sine }
                            .from(centre)
                    }
                };
                return Way { start, end, bend: Some(Bend { centre, clockwise }) };
            }
        }
        let end = match self.below(5) {
            0 => start,
            1 => Point { x: self.coordinate(-2.0, 24.0), ..start },
            2 => Point { z: self.coordinate(-42.0, 4.0), ..start },
            _ => self.place(),
        };
        Way { start, end, bend: None }
    }
}

/// The way of a tool.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub start: Point,
    pub end: Point,
    pub bend: Option<Bend>,
}

impl Way {
    pub fn sweep<'a>(&self, sweep: &'a mut Sweep, cutter: &Cutter) -> &'a Sweep {
        match self.bend {
            None => sweep.line(cutter, self.start, self.end),
            Some(bend) => sweep.arc(cutter, self.start, self.end, bend),
        }
    }

    /// The place at a share of the way.
    pub fn at(&self, share: f64) -> Point {
        let Some(bend) = self.bend else {
            return Vector::between(self.start, self.end).times(share).from(self.start);
        };
        let angle = sweep_rad(self.start, self.end, bend.centre, bend.clockwise) * share;
        let (sine, cosine) = angle.sin_cos();
        let arm = Vector::between(bend.centre, self.start);
        Vector { x: arm.x * cosine + arm.z * sine, z: arm.z * cosine - arm.x * sine }.from(bend.centre)
    }

    pub fn pieces(&self, count: usize) -> Vec<Way> {
        let at = |index: usize| match index {
            0 => self.start,
            index if index == count => self.end,
            index => self.at(index as f64 / count as f64),
        };
        (0..count).map(|index| Way { start: at(index), end: at(index + 1), bend: self.bend }).collect()
    }
}

/// How near a tool comes to a place on its way, by trying; below zero when the place is inside it.
pub fn clearance(tool: &Outline, way: &Way, place: Point) -> f64 {
    const STEPS: u32 = 1_500;
    let at = |step: u32| way.at(f64::from(step) / f64::from(STEPS));
    (0..=STEPS)
        .map(|step| {
            let tip = at(step);
            let seen = point(place.x - tip.x, place.z - tip.z);
            let off =
                tool.segments().iter().map(|segment| distance(segment, seen)).fold(f64::INFINITY, f64::min);
            if tool.contains(seen) { -off } else { off }
        })
        .fold(f64::INFINITY, f64::min)
}

fn distance(segment: &Segment, place: Point) -> f64 {
    let ends = segment.start.distance(place).min(segment.end.distance(place));
    match segment.bend {
        None => {
            let way = Vector::between(segment.start, segment.end);
            let to = Vector::between(segment.start, place);
            let share = (to.x * way.x + to.z * way.z) / (way.length() * way.length());
            if (0.0..=1.0).contains(&share) {
                way.times(share).from(segment.start).distance(place)
            } else {
                ends
            }
        }
        Some(bend) => {
            let radius = bend.centre.distance(segment.start);
            let way = Vector::between(bend.centre, place);
            let foot = way.times(radius / way.length()).from(bend.centre);
            let whole = sweep_rad(segment.start, segment.end, bend.centre, bend.clockwise);
            let part = sweep_rad(segment.start, foot, bend.centre, bend.clockwise);
            if part.abs() <= whole.abs() { foot.distance(place) } else { ends }
        }
    }
}
