//! Overcuts that no control looks for: several short elements in a row, between which the nose does not fit.
//!
//! The checks of the controls look at one element at a time. A step or notch of several elements, each shorter than the
//! nose is wide, passes them, and the nose cuts into the contour beyond. Here the last few elements are kept, with the way
//! of the nose centre beside them; when the nose comes nearer than its radius to an element that is not the next one,
//! the machinist is told. It changes no move.
//!
//! Places on the way of the centre are looked at one by one ([`PLACES`] on each element): this finds what matters, not
//! every hundredth.

use std::collections::VecDeque;

use turnwright_canon::Action;
use turnwright_geometry::{Joint, Segment};

use super::element::{Element, Role};
use super::{Compensation, SAME_MM};
use crate::machine::Core;

/// Elements that are kept.
const KEPT: usize = 12;

/// Places that are looked at on the way beside an element.
const PLACES: u32 = 8;

/// Overcuts up to this are rounding.
const SLACK_MM: f64 = 0.001;

/// An element that the nose has passed.
#[derive(Debug)]
pub(super) struct Passed {
    contour: Segment,
    centre: Segment,
    radius_mm: f64,
}

impl Passed {
    /// How far the nose, passing this, cuts into a part of the contour.
    fn cuts_into(&self, contour: &Segment) -> f64 {
        let places = (0..=PLACES).map(|place| self.centre.at(f64::from(place) / f64::from(PLACES)));
        places.map(|centre| self.radius_mm - contour.distance(centre)).fold(0.0, f64::max)
    }

    /// It is shorter than the nose is wide.
    fn is_short(&self) -> bool {
        self.contour.start.distance(self.contour.end) < 2.0 * self.radius_mm
    }
}

impl Core {
    /// Takes an element in whose joints are known.
    pub(super) fn look_for_overcut(
        &mut self,
        path: &mut Compensation,
        element: &Element,
        start: Option<Joint>,
        end: Option<&Joint>,
    ) {
        let radius_mm = element.offset().radius_mm;
        let is_contour = element.role == Role::Contour && matches!(element.action, Action::Feed { .. });
        let (true, Some(start), Some(end)) = (is_contour && radius_mm > SAME_MM, start, end) else {
            path.passed.clear();
            return;
        };
        let contour = element.segment;
        let ends = (start.last().from(contour.start), end.first().from(contour.end));
        // Where the centre has no arc to run on it goes straight.
        let bend = contour.bend.filter(|bend| bend.centre.distance(ends.0) > SAME_MM && !element.is_muted);
        let centre = Segment { start: ends.0, end: ends.1, bend };
        let new = Passed { contour, centre, radius_mm };
        let mut between = path.passed.iter().rev();
        // The element before has a joint with this one.
        let mut is_near = between.next().is_some_and(Passed::is_short);
        let mut depth_mm = 0.0_f64;
        while let Some(old) = between.next().filter(|_| is_near) {
            depth_mm = depth_mm.max(old.cuts_into(&new.contour)).max(new.cuts_into(&old.contour));
            is_near = old.is_short();
        }
        if depth_mm > SLACK_MM {
            // It is said once for each place.
            path.passed.clear();
            let here = std::mem::replace(&mut self.at, element.at);
            self.warn_block("compensation-overcut");
            self.at = here;
        }
        remember(&mut path.passed, new);
    }
}

fn remember(passed: &mut VecDeque<Passed>, new: Passed) {
    if passed.len() == KEPT {
        passed.pop_front();
    }
    passed.push_back(new);
}
