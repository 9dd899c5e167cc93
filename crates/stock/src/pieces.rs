//! Which material hangs together.
//!
//! Two bands of neighbouring slabs are one piece when they share more of the upright line between them than
//! [`BOND_MM`]: what touches in a point falls apart.

use turnwright_geometry::{Bounds, Point};

use crate::band::Band;
use crate::curve::{Content, greater, lesser};
use crate::row::{Row, Run, Slab};
use crate::section::Section;

/// What holds together at less than a nanometre is apart.
const BOND_MM: f64 = 1e-6;

/// A piece of material that is connected in itself and with nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The rectangle round it.
    pub bounds: Bounds,
    /// In the half-section, mm².
    pub area_mm2: f64,
    /// Of the part, mm³.
    pub volume_mm3: f64,
}

/// For each band, in order, a band of the same piece that came before it, or itself; the first of a piece is its root.
#[derive(Debug, Default)]
struct Bonds(Vec<usize>);

impl Bonds {
    fn of<'a>(slabs: impl Iterator<Item = (&'a Slab, &'a [Band])>) -> Self {
        let mut bonds = Self::default();
        let mut before: Option<(&Slab, &[Band])> = None;
        for (slab, bands) in slabs {
            let first = bonds.0.len();
            bonds.0.extend(first..first + bands.len());
            if let Some((last, others)) = before.filter(|(last, _)| last.to == slab.from) {
                for (other, a) in others.iter().enumerate() {
                    for (index, b) in bands.iter().enumerate() {
                        if bond(a, b, last.to) > BOND_MM {
                            bonds.unite(first - others.len() + other, first + index);
                        }
                    }
                }
            }
            before = Some((slab, bands));
        }
        bonds
    }

    fn root(&mut self, mut index: usize) -> usize {
        while self.0[index] != index {
            self.0[index] = self.0[self.0[index]];
            index = self.0[index];
        }
        index
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// Whether all the chosen bands are of one piece.
    fn join(&mut self, chosen: impl Iterator<Item = bool>) -> bool {
        let mut chosen = chosen.enumerate().filter(|(_, is_chosen)| *is_chosen).map(|(index, _)| index);
        let Some(first) = chosen.next() else { return true };
        let root = self.root(first);
        chosen.all(|index| self.root(index) == root)
    }
}

/// How much of the upright line at a Z two bands share.
#[inline]
fn bond(a: &Band, b: &Band, z: f64) -> f64 {
    lesser(a.roof.at(z), b.roof.at(z)) - greater(a.floor.at(z), b.floor.at(z))
}

/// Whether slabs of one band each hold to one another: so does what most cuts leave.
pub(crate) fn is_strand(slabs: &[Slab], bands: &[Band]) -> bool {
    bands.len() == slabs.len()
        && slabs.windows(2).zip(bands.windows(2)).all(|(slabs, bands)| {
            let z = slabs[0].to;
            z == slabs[1].from && bond(&bands[0], &bands[1], z) > BOND_MM
        })
}

/// Whether slabs hang together as far as they go; of slabs with many bands it is not found out.
pub(crate) fn hangs_together<'a>(slabs: impl Iterator<Item = (&'a Slab, &'a [Band])>) -> bool {
    const BANDS_MAX: usize = 6;
    let mut before: Option<(&Slab, &[Band])> = None;
    let mut pieces = [0; BANDS_MAX];
    let (mut count, mut next) = (0, 0);
    for (slab, bands) in slabs {
        if bands.len() > BANDS_MAX {
            return false;
        }
        let (last, others) = before.filter(|(last, _)| last.to == slab.from).unwrap_or((slab, &[]));
        if let ([other], [band]) = (others, bands)
            && bond(other, band, last.to) > BOND_MM
        {
            before = Some((slab, bands));
            continue;
        }
        let mut now = [0; BANDS_MAX];
        for (index, band) in bands.iter().enumerate() {
            next += 1;
            count += 1;
            now[index] = next;
            for (other, _) in
                others.iter().enumerate().filter(|(_, other)| bond(other, band, last.to) > BOND_MM)
            {
                let (piece, joined) = (pieces[other], now[index]);
                if piece != joined {
                    count -= 1;
                    pieces.iter_mut().chain(&mut now).filter(|of| **of == joined).for_each(|of| *of = piece);
                }
            }
        }
        pieces = now;
        before = Some((slab, bands));
    }
    count <= 1
}

impl Row {
    /// Whether all material that lies between two Z, or touches them, hangs together. It is looked at in ever wider
    /// neighbourhoods, so that a joint round the next corner costs no look at the whole.
    pub(crate) fn holds_together(&self, from: f64, to: f64) -> bool {
        let Some((start, end)) = self.ends() else { return true };
        if hangs_together(self.slabs_between(from, to)) {
            return true;
        }
        let mut margin = to - from;
        loop {
            let (low, high) = (from - margin, to + margin);
            let mut bonds = Bonds::of(self.slabs_between(low, high));
            let near = self.slabs_between(low, high).flat_map(|(slab, bands)| {
                let is_near = slab.to >= from && slab.from <= to;
                bands.iter().map(move |_| is_near)
            });
            if bonds.join(near) {
                return true;
            }
            if low <= start && end <= high {
                return false;
            }
            margin *= 4.0;
        }
    }
}

impl Section {
    /// The pieces that the material is in, along Z.
    pub fn pieces(&self) -> Vec<Piece> {
        self.bonded().0
    }

    /// Lets go of pieces: the part that was cut off. Those that went are returned.
    pub fn drop_pieces(&mut self, mut falls: impl FnMut(&Piece) -> bool) -> Vec<Piece> {
        let (pieces, owners) = self.bonded();
        let falling: Vec<bool> = pieces.iter().map(&mut falls).collect();
        if !falling.contains(&true) {
            return Vec::new();
        }
        let mut owners = owners.into_iter();
        let mut left = Run::default();
        for (slab, bands) in self.row.slabs() {
            for (band, owner) in bands.iter().zip(&mut owners) {
                if !falling[owner] {
                    left.push_band(*band);
                }
            }
            left.end_slab(slab.from, slab.to);
        }
        self.row = Row::default();
        self.row.append(&mut left);
        pieces.into_iter().zip(falling).filter(|(_, falls)| *falls).map(|(piece, _)| piece).collect()
    }

    /// The pieces, and for each band the number of its piece.
    pub(crate) fn bonded(&self) -> (Vec<Piece>, Vec<usize>) {
        let mut bonds = Bonds::of(self.row.slabs());
        let mut numbers = vec![usize::MAX; bonds.0.len()];
        let mut pieces: Vec<Piece> = Vec::new();
        let mut owners = Vec::with_capacity(numbers.len());
        for (slab, bands) in self.row.slabs() {
            for band in bands {
                let root = bonds.root(owners.len());
                if numbers[root] == usize::MAX {
                    numbers[root] = pieces.len();
                    pieces.push(Piece::nothing(slab.from));
                }
                pieces[numbers[root]].take(band, slab);
                owners.push(numbers[root]);
            }
        }
        (pieces, owners)
    }
}

impl Piece {
    fn nothing(z: f64) -> Self {
        let bounds = Bounds { min: Point::new(f64::INFINITY, z), max: Point::new(f64::NEG_INFINITY, z) };
        Self { bounds, area_mm2: 0.0, volume_mm3: 0.0 }
    }

    fn take(&mut self, band: &Band, slab: &Slab) {
        let (low, high) = band.range(slab.from, slab.to);
        self.bounds = self.bounds.with(Point::new(low, slab.from)).with(Point::new(high, slab.to));
        let Content { area_mm2, volume_mm3 } = band.content(slab.from, slab.to);
        self.area_mm2 += area_mm2;
        self.volume_mm3 += volume_mm3;
    }
}
