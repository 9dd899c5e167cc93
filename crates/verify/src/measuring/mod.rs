//! The part under the caliper: what it measures at a place, all its sizes, and whether they are what the drawing asks for.
//!
//! In: the finished [`Section`] and its threads. Out: sizes as data, X as diameters, and a [`Diagnostic`] for each size
//! that is out of tolerance or not there.
//!
//! Invariant: at a face nothing is guessed: both sides are given, and a tolerance there is not judged.

mod sizes;
mod tolerance;

use turnwright_control::SectionSpot;
use turnwright_stock::Section;
use turnwright_stock::machining::{ThreadHand, ThreadMark};

pub use sizes::{Cylinder, Groove, Opening, Radius, Sizes, Taper};
pub use tolerance::{Judged, NotThere, judge, nominal_text};

/// A ring of material at a Z, as diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Of its hole, mm; 0 when it is solid.
    pub bore_mm: f64,
    /// Outside, mm.
    pub diameter_mm: f64,
}

impl Ring {
    fn of((inner, outer): (f64, f64)) -> Self {
        Self { bore_mm: 2.0 * inner, diameter_mm: 2.0 * outer }
    }

    /// From its hole to its outside, mm.
    pub fn wall_mm(&self) -> f64 {
        (self.diameter_mm - self.bore_mm) / 2.0
    }
}

/// What is found at a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// At a Z: the rings towards the chuck and towards the front, equal where no face stands, and a thread there.
    AtZ {
        /// Where.
        z_mm: f64,
        /// Rings towards the chuck, from the axis outwards.
        behind: Vec<Ring>,
        /// Rings towards the front.
        in_front: Vec<Ring>,
        /// The thread there.
        thread: Option<Thread>,
    },
    /// At a diameter: material and air along Z, from the front.
    AtDiameter {
        /// Where.
        diameter_mm: f64,
        /// Higher and lower Z of each stretch of material.
        material: Vec<(f64, f64)>,
        /// Higher and lower Z of each gap between them.
        gaps: Vec<(f64, f64)>,
    },
}

/// A thread as it is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// In a bore.
    pub is_inside: bool,
    /// Greatest diameter, mm: of the crest outside, of the root inside.
    pub major_mm: f64,
    /// Smallest diameter, mm.
    pub minor_mm: f64,
    /// Its lead, mm.
    pub lead_mm: f64,
    /// How many starts it has.
    pub starts: usize,
    /// Which way it winds.
    pub hand: ThreadHand,
    /// Higher and lower Z of all that was cut.
    pub z_mm: (f64, f64),
}

impl Thread {
    /// Its length along Z, mm.
    pub fn length_mm(&self) -> f64 {
        self.z_mm.0 - self.z_mm.1
    }

    /// The thread of a mark, its diameters taken within a lead of a Z; nothing where nothing of it is left.
    fn near(section: &Section, mark: &ThreadMark, z: f64) -> Option<Self> {
        let bounds = &mark.bounds;
        let half = (mark.lead_mm / 2.0).min((bounds.max.z - bounds.min.z) / 2.0);
        let middle = z.clamp(bounds.min.z + half, bounds.max.z - half);
        let window = (middle - half, middle + half);
        let (low, high) = section.outer_reach(window.0, window.1)?;
        let slack = 1e-6;
        let is_outside = bounds.min.x - slack <= low && low <= bounds.max.x + slack;
        let (minor, major) =
            if is_outside { (low, high) } else { section.inner_reach(window.0, window.1)? };
        Some(Self {
            is_inside: !is_outside,
            major_mm: 2.0 * major,
            minor_mm: 2.0 * minor,
            lead_mm: mark.lead_mm,
            starts: mark.starts.len().max(1),
            hand: mark.hand,
            z_mm: (bounds.max.z, bounds.min.z),
        })
    }
}

/// All threads, from the front, measured half-way along them.
pub fn threads(section: &Section, marks: &[ThreadMark]) -> Vec<Thread> {
    let middle = |mark: &ThreadMark| (mark.bounds.min.z + mark.bounds.max.z) / 2.0;
    let mut threads: Vec<Thread> =
        marks.iter().filter_map(|mark| Thread::near(section, mark, middle(mark))).collect();
    threads.sort_by(|a, b| b.z_mm.0.total_cmp(&a.z_mm.0));
    threads
}

/// The thread at a Z.
pub fn thread_at(section: &Section, marks: &[ThreadMark], z: f64) -> Option<Thread> {
    let mark = marks.iter().find(|mark| mark.bounds.min.z <= z && z <= mark.bounds.max.z)?;
    Thread::near(section, mark, z)
}

/// Puts the caliper to a place; both a diameter and a Z give what is found at the Z and, as a second one, at the
/// diameter.
pub fn at(section: &Section, marks: &[ThreadMark], spot: &SectionSpot) -> Vec<Found> {
    let at_z = spot.z_mm.map(|z_mm| {
        let beside = section.rings_beside(z_mm);
        let rings = |rings: Vec<(f64, f64)>| rings.into_iter().map(Ring::of).collect();
        Found::AtZ {
            z_mm,
            behind: rings(beside.behind),
            in_front: rings(beside.in_front),
            thread: thread_at(section, marks, z_mm),
        }
    });
    let at_diameter = spot.diameter_mm.map(|diameter_mm| {
        let from_front = |stretches: Vec<(f64, f64)>| {
            stretches.into_iter().rev().map(|(from, to)| (to, from)).collect::<Vec<_>>()
        };
        let radius = diameter_mm / 2.0;
        Found::AtDiameter {
            diameter_mm,
            material: from_front(section.spans(radius)),
            gaps: from_front(section.gaps(radius)),
        }
    });
    at_z.into_iter().chain(at_diameter).collect()
}
