//! The half-section of the part.

use turnwright_geometry::{Bounds, Outline, OutlineFault, Point};

use crate::WELD_MM;
use crate::curve::{Content, Curve};
use crate::cutter::Cutter;
use crate::decompose::slabs_of;
use crate::history::clip;
use crate::knife::{Knife, Stops};
use crate::removed::{Contact, Removed};
use crate::row::{Row, Run};
use crate::sweep::{Stencil, Sweep};

/// The material of a turned part in the half-plane above its axis.
#[derive(Clone, Debug, Default)]
pub struct Section {
    pub(crate) row: Row,
    /// Memory that every cut uses.
    left: Run,
    stops: Stops,
    mirrored: Stencil,
}

/// Why a blank is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SectionFault {
    /// Its outline is none.
    Outline(OutlineFault),
    /// It reaches below the axis, down to this X, mm.
    BelowAxis(f64),
}

impl Section {
    /// The section of a blank with this outline.
    ///
    /// # Errors
    /// [`SectionFault::BelowAxis`].
    pub fn new(outline: &Outline) -> Result<Self, SectionFault> {
        let lowest = outline.bounds().min.x;
        if lowest < -WELD_MM {
            return Err(SectionFault::BelowAxis(lowest));
        }
        let mut section = Self::default();
        for slab in slabs_of(outline) {
            slab.bands.iter().for_each(|band| section.left.push_band(*band));
            section.left.end_slab(slab.from, slab.to);
        }
        section.row.append(&mut section.left);
        Ok(section)
    }

    /// A solid bar between two Z.
    ///
    /// # Errors
    /// [`SectionFault::Outline`] when it has no size.
    pub fn bar(radius_mm: f64, from_z: f64, to_z: f64) -> Result<Self, SectionFault> {
        Self::tube(0.0, radius_mm, from_z, to_z)
    }

    /// A tube between two Z.
    ///
    /// # Errors
    /// [`SectionFault`] when it has no size, or a bore below the axis.
    pub fn tube(bore_radius_mm: f64, radius_mm: f64, from_z: f64, to_z: f64) -> Result<Self, SectionFault> {
        let corners = (Point::new(bore_radius_mm, from_z), Point::new(radius_mm, to_z));
        Self::new(&Outline::rectangle(corners.0, corners.1).map_err(SectionFault::Outline)?)
    }

    /// Takes all that a sweep passes over out of the section.
    ///
    /// What a tool passes over below the axis it takes from the other side, which is this one half a turn later.
    pub fn cut(&mut self, sweep: &Sweep) -> Removed {
        let mut removed = Removed::default();
        for stencil in sweep.stencils() {
            removed = removed.and(self.cut_stencil(stencil));
            if stencil.lower_least < -WELD_MM {
                let mut mirrored = std::mem::take(&mut self.mirrored);
                stencil.mirror_into(&mut mirrored);
                removed = removed.and(self.cut_stencil(&mirrored));
                self.mirrored = mirrored;
            }
        }
        removed
    }

    /// Takes a hole of this outline out of the section.
    pub fn cut_hole(&mut self, outline: &Outline) -> Removed {
        let mut sweep = Sweep::new();
        self.cut(sweep.rest(&Cutter::new(outline), Point::default()))
    }

    /// Takes all material of another section out of this one: what a part has too much when the other is its drawing,
    /// what it has too little when this one is.
    pub fn cut_section(&mut self, other: &Self) -> Removed {
        let (mut removed, mut stencil) = (Removed::default(), Stencil::default());
        for (slab, bands) in other.row.slabs() {
            for band in bands {
                stencil.set(band, slab.from, slab.to);
                removed = removed.and(self.cut_stencil(&stencil));
            }
        }
        removed
    }

    fn cut_stencil(&mut self, stencil: &Stencil) -> Removed {
        let mut knife = Knife::new(stencil, &mut self.stops);
        self.row.carve(&mut knife, &mut self.left);
        let mut removed = knife.taken.removed();
        let ends = self.stops.doubts.iter().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        removed.may_part = ends.is_some_and(|(from, to)| !self.row.holds_together(from, to));
        removed
    }

    /// What a sweep would take away, without taking it.
    pub fn touches(&self, sweep: &Sweep) -> Option<Contact> {
        let (mut left, mut stops, mut mirrored) = (Run::default(), Stops::default(), Stencil::default());
        let mut removed = Removed::default();
        for stencil in sweep.stencils() {
            removed = removed.and(self.row.probe(&mut Knife::new(stencil, &mut stops), &mut left));
            if stencil.lower_least < -WELD_MM {
                stencil.mirror_into(&mut mirrored);
                removed = removed.and(self.row.probe(&mut Knife::new(&mirrored, &mut stops), &mut left));
            }
        }
        removed.contact()
    }

    /// What there is between two Z.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Self {
        let mut between = Self::default();
        clip(self.row.slabs_between(from, to), from, to, &mut between.left);
        between.row.append(&mut between.left);
        between
    }

    /// What the half-section covers, mm².
    pub fn area_mm2(&self) -> f64 {
        self.content().area_mm2
    }

    /// What the part holds, mm³.
    pub fn volume_mm3(&self) -> f64 {
        self.content().volume_mm3
    }

    fn content(&self) -> Content {
        let mut content = Content::default();
        for (slab, bands) in self.row.slabs() {
            bands.iter().for_each(|band| content += band.content(slab.from, slab.to));
        }
        content
    }

    /// The rectangle round the material; nothing when there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        let corners = self
            .row
            .slabs()
            .flat_map(|(slab, _)| [Point::new(slab.low, slab.from), Point::new(slab.high, slab.to)]);
        corners.fold(None, |bounds: Option<Bounds>, corner| {
            Some(bounds.map_or(Bounds { min: corner, max: corner }, |bounds| bounds.with(corner)))
        })
    }

    /// Whether there is material at a place; on an edge either answer may come.
    pub fn contains(&self, place: Point) -> bool {
        self.row.slabs_between(place.z, place.z).any(|(_, bands)| {
            bands.iter().any(|band| band.floor.at(place.z) <= place.x && place.x <= band.roof.at(place.z))
        })
    }

    /// The material at a Z, from the axis outwards: inner and outer radius of each ring, mm. Where an upright face
    /// stands, the larger of its two sides counts.
    pub fn rings(&self, z: f64) -> Vec<(f64, f64)> {
        let at_z = self.row.slabs_between(z, z);
        joined(
            at_z.flat_map(|(_, bands)| bands.iter().map(|band| (band.floor.at(z), band.roof.at(z))))
                .collect(),
        )
    }

    /// The material at an X, along Z: begin and end of each stretch, mm. Where a level face lies, the larger of its two
    /// sides counts.
    pub fn spans(&self, x: f64) -> Vec<(f64, f64)> {
        let level = Curve::level(x);
        let mut spans: Vec<(f64, f64)> = Vec::new();
        for (slab, bands) in self.row.slabs().filter(|(slab, _)| slab.low <= x && x <= slab.high) {
            for band in bands {
                let crossings = [band.floor, band.roof].map(|edge| edge.crossings(&level));
                let mut stops: Vec<f64> = crossings.concat();
                stops.retain(|stop| slab.from < *stop && *stop < slab.to);
                stops.push(slab.to);
                stops.sort_by(f64::total_cmp);
                let mut from = slab.from;
                for to in stops {
                    let middle = (from + to) / 2.0;
                    if band.floor.at(middle) <= x + WELD_MM && x - WELD_MM <= band.roof.at(middle) {
                        spans.push((from, to));
                    }
                    from = to;
                }
            }
        }
        joined(spans)
    }

    /// How many slabs hold it: what memory it needs.
    pub fn slab_count(&self) -> usize {
        self.row.len()
    }
}

/// Stretches in order, those that meet as one.
pub(crate) fn joined(mut stretches: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    stretches.sort_by(|a, b| a.0.total_cmp(&b.0));
    stretches.dedup_by(|next, stretch| {
        let meets = next.0 <= stretch.1 + WELD_MM;
        if meets {
            stretch.1 = stretch.1.max(next.1);
        }
        meets
    });
    stretches
}
