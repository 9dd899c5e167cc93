//! Where the material is, as a caliper finds it: at a Z, at an X, between two Z.

use crate::WELD_MM;
use crate::section::{Section, joined};

/// The lowest and highest X of a surface, mm.
pub type Reach = (f64, f64);

/// Both sides of a place along Z; where no face stands they are equal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// Rings towards lower Z, the chuck.
    pub behind: Vec<(f64, f64)>,
    /// Rings towards higher Z, the front.
    pub in_front: Vec<(f64, f64)>,
}

impl Section {
    /// The material on both sides of a Z: inner and outer radius of each ring, from the axis outwards, mm.
    pub fn rings_beside(&self, z: f64) -> Beside {
        let mut beside = Beside::default();
        for (slab, bands) in self.row.slabs_between(z - WELD_MM, z + WELD_MM) {
            let rings = || bands.iter().map(|band| (band.floor.at(z), band.roof.at(z)));
            if slab.from < z - WELD_MM {
                beside.behind.extend(rings());
            }
            if slab.to > z + WELD_MM {
                beside.in_front.extend(rings());
            }
        }
        Beside { behind: joined(beside.behind), in_front: joined(beside.in_front) }
    }

    /// Air between material at an X, along Z: begin and end of each gap, mm.
    pub fn gaps(&self, x: f64) -> Vec<(f64, f64)> {
        self.spans(x).windows(2).map(|two| (two[0].1, two[1].0)).collect()
    }

    /// How far the outermost surface reaches between two Z; nothing where there is no material.
    pub fn outer_reach(&self, from: f64, to: f64) -> Option<Reach> {
        let roofs = self.row.slabs_between(from, to).filter_map(|(slab, bands)| {
            let (from, to) = (slab.from.max(from), slab.to.min(to));
            bands.last().filter(|_| from < to).map(|band| band.roof.range(from, to))
        });
        roofs.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// How far the innermost surface reaches between two Z; nothing where there is no material.
    pub fn inner_reach(&self, from: f64, to: f64) -> Option<Reach> {
        let floors = self.row.slabs_between(from, to).filter_map(|(slab, bands)| {
            let (from, to) = (slab.from.max(from), slab.to.min(to));
            bands.first().filter(|_| from < to).map(|band| band.floor.range(from, to))
        });
        floors.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

#[cfg(test)]
mod tests {
    use turnwright_geometry::{Outline, Point};

    use super::*;

    /// A tube of 20 to 60 mm with a step to 40 mm in front of Z-10 and a groove of 50 mm from Z-30 to Z-26.
    fn stepped() -> Section {
        let mut section = Section::tube(10.0, 30.0, -50.0, 0.0).expect("a tube");
        for (low, high) in [((20.0, -10.0), (40.0, 1.0)), ((25.0, -30.0), (40.0, -26.0))] {
            let cut = Outline::rectangle(Point::new(low.0, low.1), Point::new(high.0, high.1));
            section.cut_hole(&cut.expect("a rectangle"));
        }
        section
    }

    #[test]
    fn a_face_has_two_sides() {
        let section = stepped();
        let at_face = section.rings_beside(-10.0);
        assert_eq!((at_face.behind, at_face.in_front), (vec![(10.0, 30.0)], vec![(10.0, 20.0)]));
        let beside = section.rings_beside(-5.0);
        assert_eq!(beside.behind, beside.in_front);
        let front = section.rings_beside(0.0);
        assert_eq!((front.behind, front.in_front), (vec![(10.0, 20.0)], vec![]));
        assert_eq!(section.rings_beside(7.0), Beside::default());
    }

    #[test]
    fn grooves_are_gaps_and_surfaces_have_a_reach() {
        let section = stepped();
        assert_eq!(section.gaps(28.0), [(-30.0, -26.0)]);
        assert_eq!(section.gaps(15.0), []);
        assert_eq!(section.outer_reach(-31.0, -25.0), Some((25.0, 30.0)));
        assert_eq!(section.inner_reach(-31.0, -25.0), Some((10.0, 10.0)));
        assert_eq!(section.outer_reach(5.0, 6.0), None);
    }
}
