//! Material that ought to stay: what a finished figure or a drawing encloses.
//!
//! In: a section, and every sweep that takes material away. Out: the pieces that watched moves took out of it. A sweep
//! that takes too little to matter is passed over quickly, so that a finishing cut along the edge costs little more than
//! without a guard.
//!
//! Invariant: what is kept is bounded by [`LOSSES_MAX`].

use turnwright_geometry::Bounds;

use crate::section::Section;
use crate::sweep::Sweep;

/// Sweeps into one guard that are looked at closely; those behind them are cut, and not told.
pub const LOSSES_MAX: u32 = 2_000;

/// What is looked at round a loss, mm.
const MARGIN_MM: f64 = 0.01;

/// Material that ought to stay, and what has gone of it.
#[derive(Clone, Debug)]
pub struct Guard {
    section: Section,
    is_watched: bool,
    least_mm: f64,
    lost: Vec<Section>,
    looks: u32,
}

impl Guard {
    /// Guards a section; what is shallower than `least_mm` is never told.
    pub fn new(section: Section, least_mm: f64) -> Self {
        Self { section, is_watched: false, least_mm, lost: Vec::new(), looks: 0 }
    }

    /// Whether what is lost from here on is told.
    pub const fn watch(&mut self, is_watched: bool) {
        self.is_watched = is_watched;
    }

    /// What was lost since the last call.
    pub fn take_lost(&mut self) -> Vec<Section> {
        std::mem::take(&mut self.lost)
    }

    /// What is left of it.
    pub const fn section(&self) -> &Section {
        &self.section
    }

    /// What there is in a rectangle: a part of the section is quicker to cut than all of it.
    fn around(&self, Bounds { min, max }: Bounds) -> Section {
        let (low, high) = ((min.x - MARGIN_MM).max(0.0), max.x + MARGIN_MM);
        let window = Section::tube(low, high, min.z - MARGIN_MM, max.z + MARGIN_MM);
        let Ok(mut around) = window else { return self.section.clone() };
        let mut lacks = around.clone();
        lacks.cut_section(&self.section);
        around.cut_section(&lacks);
        around
    }

    pub(super) fn cut(&mut self, sweep: &Sweep) {
        if !self.is_watched || self.looks >= LOSSES_MAX {
            self.section.cut(sweep);
            return;
        }
        let Some(contact) = self.section.touches(sweep) else { return };
        // A piece of this depth is at least a triangle of its half square; the rectangle is as deep or deeper.
        let is_deep = contact.depth_mm > self.least_mm && contact.area_mm2 > self.least_mm.powi(2) / 2.0;
        if !is_deep {
            self.section.cut(sweep);
            return;
        }
        self.looks += 1;
        let mut lost = self.around(contact.bounds);
        self.section.cut(sweep);
        lost.cut_section(&self.section);
        self.lost.push(lost);
    }
}

#[cfg(test)]
mod tests {
    use turnwright_geometry::{Outline, Point};

    use super::*;
    use crate::Cutter;

    const LEAST_MM: f64 = 0.001;

    /// A bar, and a blade of half a millimetre.
    fn bar(length_mm: f64) -> (Guard, Cutter) {
        let section = Section::bar(10.0, -length_mm, 0.0).expect("a bar");
        let blade = Outline::rectangle(Point::new(0.0, 0.0), Point::new(20.0, 0.5)).expect("a blade");
        (Guard::new(section, LEAST_MM), Cutter::new(&blade))
    }

    fn plunge(guard: &mut Guard, blade: &Cutter, place: Point) -> usize {
        let mut sweep = Sweep::new();
        guard.cut(sweep.rest(blade, place));
        guard.take_lost().len()
    }

    #[test]
    fn only_what_is_watched_and_deep_enough_is_told() {
        let (mut guard, blade) = bar(100.0);
        assert_eq!(plunge(&mut guard, &blade, Point::new(9.0, -10.0)), 0);
        guard.watch(true);
        assert_eq!(plunge(&mut guard, &blade, Point::new(9.0, -10.0)), 0);
        assert_eq!(plunge(&mut guard, &blade, Point::new(10.0 - LEAST_MM, -20.0)), 0);
        assert_eq!(plunge(&mut guard, &blade, Point::new(10.0 - 1.1 * LEAST_MM, -30.0)), 1);
        assert_eq!(plunge(&mut guard, &blade, Point::new(11.0, -40.0)), 0);
        // What is not told has gone nevertheless.
        assert!((guard.section().area_mm2() - 1000.0 + 0.5 + 0.5 * 2.1 * LEAST_MM).abs() < 1e-9);
    }

    #[test]
    fn losses_have_a_limit() {
        let (mut guard, blade) = bar(LOSSES_MAX as f64 + 10.0);
        guard.watch(true);
        let told: usize = (1..=LOSSES_MAX + 5)
            .map(|index| plunge(&mut guard, &blade, Point::new(9.0, -f64::from(index))))
            .sum();
        assert_eq!(told, LOSSES_MAX as usize);
        assert!((guard.section().spans(9.5).len()) > LOSSES_MAX as usize + 5);
    }
}
