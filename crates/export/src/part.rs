//! What a drawing says of a part: its outline with threads by convention, its cylinders, faces and threads.
//!
//! In: the finished section, the same without its threads, and what is remembered of them. Out: loops of lines and arcs
//! in which each thread is its crest, and the sizes that a drawing would have. X is a radius unless a name says diameter.

mod details;
mod metric;
mod thread;

use turnwright_geometry::Segment;
use turnwright_stock::Section;
use turnwright_stock::machining::ThreadMark;

pub use self::details::{Detail, DetailKind, taper_text};
pub use self::thread::Thread;

/// Cylinders, faces and threads that are told; the longest and widest first.
pub const SIZES_MAX: usize = 12;

/// Edges that are less inclined than this are level or upright, mm.
const LEVEL_MM: f64 = 1e-6;

/// Of faces nearer to each other than this, only the highest has a size.
const SAME_FACE_MM: f64 = 0.02;

/// A shorter cylinder or a lower face is no size of its own: this share of the part's length or radius.
const LEAST_SHARE: f64 = 0.01;

/// A finished part as a drawing has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartShape {
    /// The edges of the half-section; the material lies to the left.
    pub loops: Vec<Vec<Segment>>,
    /// Outside and inside, along Z from the front.
    pub cylinders: Vec<Cylinder>,
    /// Z of the plane faces, from the front.
    pub faces: Vec<f64>,
    /// Its threads, from the front.
    pub threads: Vec<Thread>,
    /// Radii, chamfers and tapers, the longest edges first.
    pub details: Vec<Detail>,
    /// Greatest diameter, mm.
    pub diameter_mm: f64,
    /// From the back to the front, mm.
    pub z: (f64, f64),
    /// What it holds, mm³.
    pub volume_mm3: f64,
}

/// A stretch of one diameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Its diameter, mm.
    pub diameter_mm: f64,
    /// From lower to higher Z.
    pub z: (f64, f64),
    /// A bore.
    pub is_inside: bool,
    /// It is the bottom of a groove, so wide at its mouth.
    pub groove_mm: Option<f64>,
}

/// Thousandths of a millimetre, without zeros that say nothing.
pub fn thousandths(value: f64) -> String {
    ((value * 1e3).round() / 1e3 + 0.0).to_string()
}

/// What the tool of a thread cut where no thread is to be seen, into a shoulder perhaps, is no matter of convention.
fn take_gouge(section: &Section, plain: &mut Section, mark: &ThreadMark) {
    let (min, max, around) = (mark.bounds.min, mark.bounds.max, mark.lead_mm);
    let from_x = (min.x - around).max(0.0);
    if let Ok(mut gouge) = Section::tube(from_x, max.x + around, min.z - around, max.z + around) {
        gouge.cut_section(section);
        plain.cut_section(&gouge);
    }
}

impl PartShape {
    /// The drawing of a section; nothing when there is no material. `plain` is the same section without its threads.
    pub fn new(section: &Section, plain: &Section, marks: &[ThreadMark]) -> Option<Self> {
        let bounds = section.bounds()?;
        let z = (bounds.min.z, bounds.max.z);
        let mut shape =
            Self { diameter_mm: 2.0 * bounds.max.x, z, volume_mm3: section.volume_mm3(), ..Self::default() };
        let edges = |section: &Section| -> Vec<Vec<Segment>> {
            section.contours().into_iter().map(|contour| contour.segments).collect()
        };
        let (grooved, mut plain) = (edges(section), plain.clone());
        for mark in marks {
            match Thread::new(&grooved, &mut plain, mark) {
                Some(thread) => shape.threads.push(thread),
                None => take_gouge(section, &mut plain, mark),
            }
        }
        shape.loops = edges(&plain);
        for thread in &shape.threads {
            shape.loops.iter_mut().for_each(|edges| thread.part(edges));
        }
        shape.threads.sort_by(|a, b| b.z.1.total_cmp(&a.z.1));
        shape.find_sizes();
        shape.find_grooves();
        shape.find_details();
        Some(shape)
    }

    /// What the part holds with its threads drawn as plain surfaces, mm³.
    pub fn plain_volume_mm3(&self) -> f64 {
        self.loops.iter().flatten().map(Segment::volume_round_axis_mm3).sum()
    }

    /// The thread that an edge of [`Self::loops`] is the crest of.
    pub fn thread_of(&self, edge: &Segment) -> Option<&Thread> {
        self.threads.iter().find(|thread| thread.holds(edge))
    }

    fn find_sizes(&mut self) {
        let least_length = LEAST_SHARE * (self.z.1 - self.z.0);
        let least_step = LEAST_SHARE * self.diameter_mm / 2.0;
        let mut faces: Vec<(f64, f64)> = Vec::new();
        let is_plain =
            |edge: &&Segment| edge.bend.is_none() && !self.threads.iter().any(|one| one.holds(edge));
        for edge in self.loops.iter().flatten().filter(is_plain) {
            let (dx, dz) = (edge.end.x - edge.start.x, edge.end.z - edge.start.z);
            if dx.abs() <= LEVEL_MM && dz.abs() >= least_length && edge.start.x > LEVEL_MM {
                let z = (edge.start.z.min(edge.end.z), edge.start.z.max(edge.end.z));
                let diameter_mm = edge.start.x + edge.end.x;
                self.cylinders.push(Cylinder { diameter_mm, z, is_inside: dz > 0.0, groove_mm: None });
            } else if dz.abs() <= LEVEL_MM && dx.abs() >= least_step {
                faces.push((edge.start.z, dx.abs()));
            }
        }
        self.cylinders.sort_by(|a, b| (b.z.1 - b.z.0).total_cmp(&(a.z.1 - a.z.0)));
        self.cylinders.truncate(SIZES_MAX);
        self.cylinders.sort_by(|a, b| b.z.1.total_cmp(&a.z.1));
        faces.sort_by(|a, b| b.0.total_cmp(&a.0));
        faces.dedup_by(|next, face| {
            let is_near = (face.0 - next.0).abs() < SAME_FACE_MM;
            if is_near && next.1 > face.1 {
                *face = *next;
            }
            is_near
        });
        self.faces = faces.into_iter().map(|face| face.0).collect();
        self.faces.truncate(SIZES_MAX);
    }
}
