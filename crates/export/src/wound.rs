//! The part as triangles with its threads as they wind.
//!
//! In: the [`Turns`] of a part, its edges in half-planes all round, and a tolerance. Out: a [`Wound`] surface: the
//! profile of each half-plane as chords, and between each two neighbours triangles from chord to corner, going along both
//! profiles at once, always where the diagonal is shorter. Along a thread, corners look for those that they wind on to.
//!
//! Invariants: strips of triangles share the corners of the profile between them, so that the surface is closed, edge by
//! edge; no triangle has two corners in one place; there are no more than [`TRIANGLES_MAX`]. Where the profiles are not
//! of the same pieces all round (a thread through a thin wall), there is no such surface.

use std::f64::consts::{PI, TAU};

use turnwright_geometry::{Point, Segment, Vector};
use turnwright_stock::Section;

use crate::mesh::{CHORD_MM, Strip, TRIANGLES_MAX, chords_of, sides};
use crate::part::PartShape;
use crate::solid::{EDGES_MAX, Shell, shells};

/// Edges of all half-planes together, some fifty bytes each.
pub const WOUND_EDGES_MAX: usize = 1_000_000;

/// Fewest and most half-planes; the most leave a hundredth of a millimetre at a diameter of a metre.
const HALF_PLANES_MIN: usize = 64;
const HALF_PLANES_MAX: usize = 512;

/// A turn of a start of a thread takes as many half-planes.
const HALF_PLANES_PER_START: usize = 16;

/// Pieces that hold less are specks between edges that nearly lie on each other, mm³.
const SPECK_MM3: f64 = 1e-3;

/// Corners nearer than this are one in two profiles, mm.
const SAME_MM: f64 = 1e-6;

/// The edges of a part in half-planes, evenly all round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turns {
    profiles: Vec<Vec<Shell>>,
}

/// Why there is no such surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unwound {
    /// The threads have more edges than [`WOUND_EDGES_MAX`], or there are more triangles than [`TRIANGLES_MAX`].
    TooFine,
    /// The part falls into pieces that are not the same all round.
    InPieces,
}

/// A closed surface of triangles that is not the same all round.
#[derive(Clone, Debug, PartialEq)]
pub struct Wound {
    /// Its corners, profile by profile.
    pub corners: Vec<WoundCorner>,
    /// Its triangles.
    pub facets: Vec<Facet>,
    /// Its profiles all round, shell by shell.
    pub rings: Vec<Vec<Profile>>,
    /// Cosine and sine of the directions round the axis.
    pub directions: Vec<(f64, f64)>,
    /// How far it may lie off the part, mm.
    pub chord_mm: f64,
}

/// A corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WoundCorner {
    /// Where in its half-plane.
    pub place: Point,
    /// The number of its direction.
    pub side: usize,
}

/// The corners of a shell in one half-plane, and how the triangles to the next one go.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// The first of its corners.
    pub first: usize,
    /// How many corners it has.
    pub count: usize,
    /// Behind its last corner comes its first again.
    pub is_ring: bool,
    /// For each triangle whether its base is here (else it is in the next half-plane).
    pub is_base_here: Vec<bool>,
}

/// A triangle, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Numbers of its corners.
    pub corners: [usize; 3],
    /// Out of the material at each, in the corner's half-plane, of length 1.
    pub normals: [Vector; 3],
    /// It belongs to a thread.
    pub is_thread: bool,
}

/// In how many half-planes a part is wanted, for triangles within `chord_mm` of it.
pub fn half_planes(shape: &PartShape, chord_mm: f64) -> usize {
    let starts = shape.threads.iter().map(|thread| thread.starts).max().unwrap_or(0);
    let least = HALF_PLANES_MIN.max(HALF_PLANES_PER_START * starts).min(HALF_PLANES_MAX);
    sides(shape.diameter_mm / 2.0, chord_mm / 2.0).clamp(least, HALF_PLANES_MAX).next_multiple_of(16)
}

impl Turns {
    /// The edges of sections all round.
    ///
    /// # Errors
    /// [`Unwound::TooFine`].
    pub fn new(sections: impl Iterator<Item = Section>) -> Result<Self, Unwound> {
        let mut profiles = Vec::new();
        let mut edges = 0;
        for section in sections {
            let loops: Vec<Vec<Segment>> =
                section.contours().into_iter().map(|contour| contour.segments).collect();
            let count = loops.iter().map(Vec::len).sum::<usize>();
            edges += count;
            if count > EDGES_MAX || edges > WOUND_EDGES_MAX {
                return Err(Unwound::TooFine);
            }
            let whole = shells(&loops).filter(|shell| shell.volume_mm3.abs() > SPECK_MM3);
            profiles.push(whole.collect());
        }
        Ok(Self { profiles })
    }

    /// What the part holds by them, mm³: the mean of all half-planes.
    pub fn volume_mm3(&self) -> f64 {
        let all: f64 = self.profiles.iter().flatten().map(|shell| shell.volume_mm3).sum();
        all / self.profiles.len().max(1) as f64
    }

    /// The shells of each half-plane in the same order everywhere.
    fn in_order(&self, stride: usize) -> Result<Vec<Vec<&Shell>>, Unwound> {
        let mut rows: Vec<Vec<&Shell>> = Vec::new();
        for profiles in self.profiles.iter().step_by(stride) {
            let mut left: Vec<&Shell> = profiles.iter().collect();
            let Some(before) = rows.last() else {
                rows.push(left);
                continue;
            };
            if left.len() != before.len() {
                return Err(Unwound::InPieces);
            }
            let mut row = Vec::with_capacity(left.len());
            for known in before {
                let alike = left.iter().enumerate().filter(|(_, shell)| is_alike(shell, known));
                let off = |shell: &Shell| (shell.volume_mm3 - known.volume_mm3).abs();
                let nearest = alike.min_by(|a, b| off(a.1).total_cmp(&off(b.1))).map(|(index, _)| index);
                row.push(left.swap_remove(nearest.ok_or(Unwound::InPieces)?));
            }
            rows.push(row);
        }
        Ok(rows)
    }
}

/// Whether two profiles may be one in neighbouring half-planes: the same kind, and the one's rectangle meets the other's.
fn is_alike(one: &Shell, other: &Shell) -> bool {
    let ends = |shell: &Shell| {
        let z = shell.profile.iter().map(|edge| edge.start.z);
        z.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
    };
    let (a, b) = (ends(one), ends(other));
    let (volumes, rings) = ((one.volume_mm3, other.volume_mm3), (one.is_ring(), other.is_ring()));
    (volumes.0 > 0.0) == (volumes.1 > 0.0) && rings.0 == rings.1 && a.0 <= b.1 && b.0 <= a.1
}

impl Wound {
    /// The surface of a part, no farther from it than `chord_mm` unless it had too many triangles; of the half-planes
    /// only as many as that needs.
    ///
    /// # Errors
    /// [`Unwound`].
    pub fn new(shape: &PartShape, turns: &Turns, chord_mm: f64) -> Result<Self, Unwound> {
        const DOUBLINGS: u32 = 10;
        for doublings in 0..DOUBLINGS {
            let chord_mm = chord_mm * f64::from(1 << doublings);
            let wound = Self::within(shape, turns, chord_mm)?;
            if wound.facets.len() <= TRIANGLES_MAX {
                return Ok(wound);
            }
        }
        Err(Unwound::TooFine)
    }

    fn within(shape: &PartShape, turns: &Turns, chord_mm: f64) -> Result<Self, Unwound> {
        let (all, wanted) = (turns.profiles.len(), half_planes(shape, chord_mm));
        let mut stride = 1;
        while all.is_multiple_of(8 * stride) && all / (2 * stride) >= wanted {
            stride *= 2;
        }
        let rows = turns.in_order(stride)?;
        let count = rows.len();
        let is_thread = |edge: &Segment| shape.threads.iter().any(|thread| thread.surrounds(edge.at(0.5)));
        let left_mm = shape.diameter_mm * (1.0 - (PI / count.max(1) as f64).cos());
        let mut wound = Self {
            corners: Vec::new(),
            facets: Vec::new(),
            rings: Vec::new(),
            directions: (0..count)
                .map(|side| (TAU * side as f64 / count as f64).sin_cos())
                .map(|(s, c)| (c, s))
                .collect(),
            chord_mm: chord_mm.max(left_mm),
        };
        let steps: Vec<Vector> = shape.threads.iter().flat_map(|thread| thread.steps(count)).collect();
        for shell in 0..rows.first().map_or(0, Vec::len) {
            let mut strips: Vec<Vec<Strip>> =
                rows.iter().map(|row| chords_of(&row[shell].profile, chord_mm / 2.0, is_thread)).collect();
            if strips.iter().any(Vec::is_empty) {
                return Err(Unwound::InPieces);
            }
            let is_ring = rows[0][shell].is_ring();
            if is_ring {
                begin_together(&mut strips);
            } else {
                end_together(&mut strips)?;
            }
            wound.add(&strips, is_ring, &steps);
        }
        Ok(wound)
    }

    /// The corners and triangles of a shell.
    fn add(&mut self, rows: &[Vec<Strip>], is_ring: bool, steps: &[Vector]) {
        let mut ring: Vec<Profile> = Vec::with_capacity(rows.len());
        for (side, row) in rows.iter().enumerate() {
            let first = self.corners.len();
            let ends = row.iter().take(row.len() - usize::from(is_ring)).map(|strip| strip.end.place);
            let places = [row[0].start.place].into_iter().chain(ends);
            self.corners.extend(places.map(|place| WoundCorner { place, side }));
            let count = self.corners.len() - first;
            ring.push(Profile { first, count, is_ring, is_base_here: Vec::new() });
        }
        for side in 0..rows.len() {
            let next = (side + 1) % rows.len();
            let (here, there) = (&rows[side], &rows[next]);
            let is_base_here = zipped(here, there, steps);
            let index = |side: usize, corner: usize| {
                let Profile { first, count, .. } = ring[side];
                first + if corner == count { 0 } else { corner }
            };
            let (mut i, mut j) = (0, 0);
            for is_here in &is_base_here {
                let (corners, normals, is_thread) = if *is_here {
                    let base = &here[i];
                    let corners = [index(side, i), index(side, i + 1), index(next, j)];
                    let tip = tip_normal(there, j, base, is_ring);
                    (corners, [base.start.normal, base.end.normal, tip], base.is_thread)
                } else {
                    let base = &there[j];
                    let corners = [index(side, i), index(next, j + 1), index(next, j)];
                    let tip = tip_normal(here, i, base, is_ring);
                    (corners, [tip, base.end.normal, base.start.normal], base.is_thread)
                };
                (i, j) = if *is_here { (i + 1, j) } else { (i, j + 1) };
                let is_one = |a: usize, b: usize| {
                    let (a, b) = (&self.corners[corners[a]], &self.corners[corners[b]]);
                    a.place == b.place && a.place.x == 0.0
                };
                if !(is_one(0, 1) || is_one(1, 2) || is_one(2, 0)) {
                    self.facets.push(Facet { corners, normals, is_thread });
                }
            }
            ring[side].is_base_here = is_base_here;
        }
        self.rings.push(ring);
    }

    /// Where a corner is in space: along the machine's X, across it, along Z.
    pub fn place(&self, corner: usize) -> [f64; 3] {
        let WoundCorner { place: Point { x, z }, side } = self.corners[corner];
        let (cosine, sine) = self.directions[side];
        [x * cosine, x * sine, z]
    }
}

/// The normal of the strip at a corner of a profile that goes with another strip's.
fn tip_normal(row: &[Strip], corner: usize, base: &Strip, is_ring: bool) -> Vector {
    let (count, likeness) = (row.len(), |normal: Vector| {
        let (a, b) = (base.start.normal, base.end.normal);
        normal.x * (a.x + b.x) + normal.z * (a.z + b.z)
    });
    let before = if corner > 0 { Some(corner - 1) } else { is_ring.then_some(count - 1) };
    let behind = if corner < count { Some(corner) } else { is_ring.then_some(0) };
    let normals = [before.map(|at| row[at].end.normal), behind.map(|at| row[at].start.normal)];
    let best = normals.into_iter().flatten().max_by(|a, b| likeness(*a).total_cmp(&likeness(*b)));
    best.unwrap_or(base.start.normal)
}

/// How two neighbouring profiles are joined: for each triangle whether its base is in the first.
fn zipped(here: &[Strip], there: &[Strip], steps: &[Vector]) -> Vec<bool> {
    let corner = |row: &[Strip], at: usize| {
        row.get(at).map_or_else(|| row[at - 1].end.place, |strip| strip.start.place)
    };
    let apart = |a: Point, b: Point| {
        let way = Vector::between(a, b);
        let square = |step: &Vector| (way.x - step.x).powi(2) + (way.z - step.z).powi(2);
        steps.iter().map(square).fold(way.x * way.x + way.z * way.z, f64::min)
    };
    let (count, others) = (here.len(), there.len());
    let mut order = Vec::with_capacity(count + others);
    let (mut i, mut j) = (0, 0);
    while i < count || j < others {
        let is_here = if i == count || j == others {
            j == others
        } else {
            let (on_here, on_there) =
                (apart(corner(here, i + 1), corner(there, j)), apart(corner(here, i), corner(there, j + 1)));
            // As good as the same: whoever lags behind.
            let is_same = (on_here - on_there).abs() <= 1e-9 * (on_here + on_there);
            if is_same { i * others <= j * count } else { on_here < on_there }
        };
        order.push(is_here);
        (i, j) = if is_here { (i + 1, j) } else { (i, j + 1) };
    }
    order
}

/// Lets the profiles of a ring begin at a corner that all have, or else each where the one before does, as near as may be.
fn begin_together(rows: &mut [Vec<Strip>]) {
    let near = |row: &[Strip], place: Point| {
        let off = |strip: &Strip| strip.start.place.distance(place);
        (0..row.len()).min_by(|a, b| off(&row[*a]).total_cmp(&off(&row[*b]))).unwrap_or(0)
    };
    let has =
        |row: &[Strip], place: Point| row.iter().any(|strip| strip.start.place.distance(place) <= SAME_MM);
    let everywhere = rows[0]
        .iter()
        .map(|strip| strip.start.place)
        // Half a turn on most is different.
        .filter(|place| has(&rows[rows.len() / 2], *place))
        .find(|place| rows.iter().all(|row| has(row, *place)));
    let mut begin = everywhere.unwrap_or(rows[0][0].start.place);
    for row in rows {
        let first = near(row, begin);
        row.rotate_left(first);
        if everywhere.is_none() {
            begin = row[0].start.place;
        }
    }
}

/// Makes the ends on the axis the very same.
fn end_together(rows: &mut [Vec<Strip>]) -> Result<(), Unwound> {
    let (first, last) = (rows[0][0].start.place, rows[0][rows[0].len() - 1].end.place);
    for row in rows {
        let count = row.len();
        let (start, end) = (row[0].start.place, row[count - 1].end.place);
        if start.distance(first) > SAME_MM || end.distance(last) > SAME_MM {
            return Err(Unwound::InPieces);
        }
        (row[0].start.place, row[count - 1].end.place) = (first, last);
    }
    Ok(())
}

/// What the report's page shows may be off by this much, mm.
pub const PAGE_CHORD_MM: f64 = 4.0 * CHORD_MM;
