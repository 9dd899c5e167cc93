//! What a drawing says of a part: its outline with threads by convention, its cylinders, faces and threads.
//!
//! In: the finished section and what is remembered of its threads. Out: loops of lines and arcs in which each thread
//! is its crest, and the sizes that a drawing would have. X is a radius unless a name says diameter.

use turnwright_geometry::{Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::ThreadMark;

/// Cylinders, faces and threads that are told; the longest and widest first.
pub const SIZES_MAX: usize = 12;

/// Edges that are less inclined than this are level or upright, mm.
const LEVEL_MM: f64 = 1e-6;

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
}

/// A thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// Diameter of its crest half-way, mm: outside it is the greater one.
    pub crest_mm: f64,
    /// Diameter of its deepest root, mm.
    pub root_mm: f64,
    /// Its lead, mm.
    pub lead_mm: f64,
    /// How many starts it has.
    pub starts: usize,
    /// From lower to higher Z.
    pub z: (f64, f64),
    /// The line through its roots.
    pub root: Vec<Point>,
    /// In a bore.
    pub is_inside: bool,
}

impl PartShape {
    /// The drawing of a section; nothing when there is no material.
    pub fn new(section: &Section, marks: &[ThreadMark]) -> Option<Self> {
        let bounds = section.bounds()?;
        let z = (bounds.min.z, bounds.max.z);
        let mut shape =
            Self { diameter_mm: 2.0 * bounds.max.x, z, volume_mm3: section.volume_mm3(), ..Self::default() };
        shape.loops = section.contours().into_iter().map(|contour| contour.segments).collect();
        for mark in marks {
            let drawn = shape.loops.iter_mut().filter_map(|edges| smoothed(edges, mark));
            // The edge that is smoothed first is the thread; what else lies in its rectangle is cut through.
            shape.threads.extend(drawn.reduce(|first, _| first));
        }
        shape.threads.sort_by(|a, b| b.z.1.total_cmp(&a.z.1));
        shape.find_sizes();
        Some(shape)
    }

    fn find_sizes(&mut self) {
        let least_length = LEAST_SHARE * (self.z.1 - self.z.0);
        let least_step = LEAST_SHARE * self.diameter_mm / 2.0;
        for edge in self.loops.iter().flatten().filter(|edge| edge.bend.is_none()) {
            let (dx, dz) = (edge.end.x - edge.start.x, edge.end.z - edge.start.z);
            if dx.abs() <= LEVEL_MM && dz.abs() >= least_length && edge.start.x > LEVEL_MM {
                let z = (edge.start.z.min(edge.end.z), edge.start.z.max(edge.end.z));
                let diameter_mm = edge.start.x + edge.end.x;
                self.cylinders.push(Cylinder { diameter_mm, z, is_inside: dz > 0.0 });
            } else if dz.abs() <= LEVEL_MM && dx.abs() >= least_step {
                self.faces.push(edge.start.z);
            }
        }
        let is_thread = |cylinder: &Cylinder| {
            self.threads.iter().any(|thread| {
                thread.is_inside == cylinder.is_inside
                    && (thread.crest_mm - cylinder.diameter_mm).abs() < 1e-3
                    && thread.z.0 < cylinder.z.1
                    && cylinder.z.0 < thread.z.1
            })
        };
        let threaded: Vec<bool> = self.cylinders.iter().map(is_thread).collect();
        let mut threaded = threaded.into_iter();
        self.cylinders.retain(|_| !threaded.next().unwrap_or_default());
        self.cylinders.sort_by(|a, b| (b.z.1 - b.z.0).total_cmp(&(a.z.1 - a.z.0)));
        self.cylinders.truncate(SIZES_MAX);
        self.cylinders.sort_by(|a, b| b.z.1.total_cmp(&a.z.1));
        self.faces.sort_by(|a, b| b.total_cmp(a));
        self.faces.dedup_by(|next, face| (*face - *next).abs() < LEVEL_MM);
        self.faces.truncate(SIZES_MAX);
    }
}

/// Draws the crest of a thread instead of its grooves.
fn smoothed(edges: &mut Vec<Segment>, mark: &ThreadMark) -> Option<Thread> {
    const SLACK_MM: f64 = 1e-6;
    let bounds = &mark.bounds;
    let is_in = |place: Point| {
        (bounds.min.z - SLACK_MM..=bounds.max.z + SLACK_MM).contains(&place.z)
            && (bounds.min.x - SLACK_MM..=bounds.max.x + SLACK_MM).contains(&place.x)
    };
    // The loop from the first edge outside the thread on, so that no run of grooves is parted.
    let first = edges.iter().position(|edge| !(is_in(edge.start) && is_in(edge.end)))?;
    edges.rotate_left(first);
    let mut drawn: Vec<Segment> = Vec::with_capacity(edges.len());
    let mut found: Option<Thread> = None;
    let mut rest = edges.as_slice();
    while let Some(edge) = rest.first() {
        let run = rest.iter().take_while(|edge| is_in(edge.start) && is_in(edge.end)).count();
        if run == 0 {
            drawn.push(*edge);
            rest = &rest[1..];
            continue;
        }
        let (grooves, behind) = rest.split_at(run);
        rest = behind;
        let (start, end) = (grooves[0].start, grooves[run - 1].end);
        if run < 3 {
            drawn.extend_from_slice(grooves);
            continue;
        }
        // Roofs run against Z. What stands out to the side of the air is crest, what lies between is root.
        let is_inside = end.z > start.z;
        let out = |place: &Point| if is_inside { -place.x } else { place.x };
        let places: Vec<Point> = grooves.iter().map(|edge| edge.start).chain([end]).collect();
        let inner = |wanted: fn(f64, f64) -> bool| {
            let hills = places.windows(3).filter(move |three| {
                let [before, at, after] = [out(&three[0]), out(&three[1]), out(&three[2])];
                wanted(at, before) && wanted(at, after)
            });
            hills.map(|three| three[1]).collect::<Vec<Point>>()
        };
        let hills = inner(|a, b| a >= b - SLACK_MM);
        let crest: Vec<Point> = [start].into_iter().chain(hills).chain([end]).collect();
        drawn.extend(crest.windows(2).map(|two| Segment { start: two[0], end: two[1], bend: None }));
        if found.is_none() {
            let root = inner(|a, b| a <= b + SLACK_MM);
            found = Some(Thread {
                crest_mm: 2.0 * crest[crest.len() / 2].x,
                root_mm: 2.0 * if is_inside { bounds.max.x } else { bounds.min.x },
                lead_mm: mark.lead_mm,
                starts: mark.starts.len().max(1),
                z: (bounds.min.z, bounds.max.z),
                root,
                is_inside,
            });
        }
    }
    *edges = drawn;
    found
}
