//! What the moment of a finding looks like: the section that the tool met, what it hit, and its way.
//!
//! In: the machining around a command that something was told of. Out: a [`Scene`] for each of the first marks.
//!
//! Invariant: no more than [`SCENES_MAX`] are kept, a section each.

use turnwright_canon::{Action, Command};
use turnwright_geometry::{Bounds, Point, Segment};
use turnwright_stock::Section;
use turnwright_stock::machining::{RapidRates, edges, rapid_edges};
use turnwright_units::{Position, WorkTip};

use crate::part::Mark;

/// Findings of which it is kept what they look like.
pub const SCENES_MAX: usize = 20;

/// What is looked at round what is hit, mm.
const MARGIN_MM: f64 = 0.01;

/// The moment of a finding.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Which of the marks.
    pub mark: usize,
    /// What the tool met.
    pub section: Section,
    /// What of it is in the way, where a cut shows it.
    pub hit: Option<Section>,
    /// The lines and arcs of the move; none where it is not one move's doing.
    pub way: Vec<Segment>,
}

impl Scene {
    /// Notes the scene of a mark that is a crash or a gouge, unless there are enough; `before` is the section in front of a
    /// command that took something it should not.
    pub(crate) fn note(
        scenes: &mut Vec<Self>,
        (index, mark): (usize, &Mark),
        before: Option<Section>,
        after: &Section,
        way: impl FnOnce() -> Vec<Segment>,
    ) {
        if scenes.len() >= SCENES_MAX || !mark.is_collision() {
            return;
        }
        let hit =
            before.as_ref().zip(mark.bounds).and_then(|(before, bounds)| between(before, after, bounds));
        let section = before.unwrap_or_else(|| after.clone());
        scenes.push(Self { mark: index, section, hit, way: way() });
    }
}

/// The lines and arcs of a move.
pub(crate) fn way_of(
    command: &Command,
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    rates: RapidRates,
) -> Vec<Segment> {
    match &command.action {
        Action::Rapid { path, .. } => rapid_edges(from, to, *path, rates).collect(),
        Action::Feed { shape, .. } | Action::Thread { shape, .. } => edges(from, to, shape).collect(),
        _ => Vec::new(),
    }
}

/// What went from a section within a rectangle.
fn between(before: &Section, after: &Section, Bounds { min, max }: Bounds) -> Option<Section> {
    let (from, to) = (min.z - MARGIN_MM, max.z + MARGIN_MM);
    let mut gone = before.between(from, to);
    gone.cut_section(&after.between(from, to));
    let low = Point { x: (min.x - MARGIN_MM).max(0.0), z: from };
    gone.bounds().filter(|bounds| bounds.max.x > low.x).map(|_| gone)
}
