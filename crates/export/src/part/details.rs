//! What a drawing says of a part's edges beside diameters and lengths: radii, chamfers, tapers, and how wide a groove is.
//!
//! In: the loops of the part as drawn. Out: a [`Detail`] for each kind and size, outside and inside apart, the greatest of
//! those that are alike standing for all.

use turnwright_geometry::{Point, Segment};

use super::{LEAST_SHARE, LEVEL_MM, PartShape, thousandths};

/// A smaller radius or chamfer is a broken edge, mm.
const LEAST_MM: f64 = 0.1;

/// An inclined edge that is no longer than this share of the part's radius, or than a millimetre, is a chamfer.
const CHAMFER_SHARE: f64 = 0.25;
const CHAMFER_MM: f64 = 1.0;

/// An edge that leans more than this off the axis is a face that its tool left leaning, degrees.
const STEEP_DEG: f64 = 80.0;

/// A groove is no wider than it is deep, or than this share of the part, or than this, mm.
const GROOVE_SHARE: f64 = 0.15;
const GROOVE_MM: f64 = 8.0;

/// What a detail is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DetailKind {
    /// An arc.
    Radius(f64),
    /// A corner cut off: how long along Z, and how far it leans off the axis, degrees.
    Chamfer {
        /// Along Z, mm.
        length_mm: f64,
        /// Off the axis.
        angle_deg: f64,
    },
    /// A cone: between its sides, degrees.
    Taper(f64),
}

/// A detail of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// What, and how large.
    pub kind: DetailKind,
    /// The middle of one of them.
    pub place: Point,
    /// In a bore.
    pub is_inside: bool,
    /// How many are alike.
    pub count: usize,
    /// How long its edge is, mm: the greatest are shown first.
    pub length_mm: f64,
}

impl Detail {
    /// As a drawing writes it.
    pub fn text(&self) -> String {
        let one = match self.kind {
            DetailKind::Radius(radius) => format!("R{}", thousandths(radius)),
            DetailKind::Chamfer { length_mm, angle_deg } => {
                format!("{}×{}°", thousandths(length_mm), tenths(angle_deg))
            }
            DetailKind::Taper(angle_deg) => taper_text(angle_deg),
        };
        if self.count > 1 { format!("{one} ({}×)", self.count) } else { one }
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64, slack: f64| (a - b).abs() < slack;
        let is_alike = match (self.kind, other.kind) {
            (DetailKind::Radius(a), DetailKind::Radius(b)) => near(a, b, 1e-3),
            (
                DetailKind::Chamfer { length_mm: a, angle_deg: u },
                DetailKind::Chamfer { length_mm: b, angle_deg: v },
            ) => near(a, b, 1e-3) && near(u, v, 0.05),
            _ => false,
        };
        is_alike && self.is_inside == other.is_inside
    }
}

/// `▷ 1:5` for a taper of a whole number, else the angle between its sides.
pub fn taper_text(angle_deg: f64) -> String {
    let ratio = 0.5 / (angle_deg / 2.0).to_radians().tan();
    if (3.0..=100.0).contains(&ratio) && (ratio - ratio.round()).abs() < 2e-3 * ratio {
        format!("▷ 1:{}", ratio.round())
    } else {
        format!("∠ {}°", (angle_deg * 100.0).round() / 100.0)
    }
}

fn tenths(value: f64) -> String {
    ((value * 10.0).round() / 10.0 + 0.0).to_string()
}

impl PartShape {
    /// Radii, chamfers and tapers, the longest edges first.
    pub(super) fn find_details(&mut self) {
        let mut details: Vec<Detail> = Vec::new();
        for edges in &self.loops {
            for edge in joined_arcs(edges) {
                let Some(found) = self.detail(&edge) else { continue };
                match details.iter_mut().find(|known| known.is_like(&found)) {
                    Some(known) => {
                        known.count += 1;
                        if found.length_mm > known.length_mm {
                            (known.length_mm, known.place) = (found.length_mm, found.place);
                        }
                    }
                    None => details.push(found),
                }
            }
        }
        details.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm));
        details.truncate(super::SIZES_MAX);
        self.details = details;
    }

    fn detail(&self, edge: &Segment) -> Option<Detail> {
        let (dx, dz) = (edge.end.x - edge.start.x, edge.end.z - edge.start.z);
        let place = edge.at(0.5);
        let is_thread = self.threads.iter().any(|thread| thread.holds(edge));
        if is_thread || place.x <= LEVEL_MM {
            return None;
        }
        let (high, wide) = (dx.abs(), dz.abs());
        let (kind, length_mm) = if let Some(bend) = edge.bend {
            let radius = bend.centre.distance(edge.start);
            (DetailKind::Radius(radius), radius * edge.sweep_rad().abs())
        } else {
            if high <= LEVEL_MM || wide <= LEVEL_MM {
                return None;
            }
            let angle_deg = high.atan2(wide).to_degrees();
            let chamfer_max = (CHAMFER_SHARE * self.diameter_mm / 2.0).max(CHAMFER_MM);
            if high.max(wide) <= chamfer_max && (90.0 - STEEP_DEG..=STEEP_DEG).contains(&angle_deg) {
                (DetailKind::Chamfer { length_mm: wide, angle_deg }, high.hypot(wide))
            } else if angle_deg <= STEEP_DEG {
                (DetailKind::Taper(2.0 * angle_deg), high.hypot(wide))
            } else {
                return None;
            }
        };
        let least = LEAST_MM.max(LEAST_SHARE * self.diameter_mm / 2.0);
        (length_mm >= least).then_some(Detail { kind, place, is_inside: dz > 0.0, count: 1, length_mm })
    }

    /// How wide the grooves are whose bottoms are among the cylinders: where the work stands higher on both sides.
    pub(super) fn find_grooves(&mut self) {
        let widest = (GROOVE_SHARE * (self.z.1 - self.z.0)).max(GROOVE_MM);
        for cylinder in &mut self.cylinders {
            let sign = if cylinder.is_inside { -1.0 } else { 1.0 };
            let bottom = cylinder.diameter_mm / 2.0;
            let is_bottom = |edge: &Segment| {
                let z = (edge.start.z.min(edge.end.z), edge.start.z.max(edge.end.z));
                edge.bend.is_none()
                    && (edge.start.x - bottom).abs() + (edge.end.x - bottom).abs() < 1e-6
                    && (edge.end.z > edge.start.z) == cylinder.is_inside
                    && (z.0 - cylinder.z.0).abs() + (z.1 - cylinder.z.1).abs() < 1e-6
            };
            let found =
                self.loops.iter().find_map(|edges| edges.iter().position(is_bottom).map(|at| (edges, at)));
            let Some((edges, at)) = found else { continue };
            // Up its rounded corners and its walls, to both sides.
            let count = edges.len();
            let climb = |step: usize| {
                let mut top = if step == 1 { edges[at].end } else { edges[at].start };
                let mut index = at;
                for _ in 0..count {
                    index = (index + step) % count;
                    let edge = &edges[index];
                    let next = if step == 1 { edge.end } else { edge.start };
                    if (next.x - top.x) * sign <= 1e-6 {
                        break;
                    }
                    top = next;
                    // Behind its wall a groove has no more width, only a broken corner.
                    if edge.bend.is_none() {
                        break;
                    }
                }
                top
            };
            let (one, other) = (climb(1), climb(count - 1));
            let depth = ((one.x - bottom) * sign).min((other.x - bottom) * sign);
            let width = (one.z - other.z).abs();
            let is_narrow = width <= widest.max(depth);
            cylinder.groove_mm = (depth > 1e-3 && is_narrow && width < 40.0 * depth).then_some(width);
        }
    }
}

/// The edges with arcs that go on into each other as one.
fn joined_arcs(edges: &[Segment]) -> Vec<Segment> {
    let mut joined: Vec<Segment> = Vec::with_capacity(edges.len());
    for edge in edges {
        if let (Some(last), Some(bend)) = (joined.last_mut(), edge.bend)
            && let Some(before) = last.bend
            && before.clockwise == bend.clockwise
            && before.centre.distance(bend.centre) < 1e-6
            && last.end.distance(edge.start) < 1e-9
        {
            last.end = edge.end;
        } else {
            joined.push(*edge);
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(shape: &PartShape, is_inside: bool) -> Vec<String> {
        let of_side = shape.details.iter().filter(|one| one.is_inside == is_inside);
        let mut texts: Vec<String> = of_side.map(Detail::text).collect();
        texts.sort();
        texts
    }

    fn shape(corners: &[(f64, f64)]) -> PartShape {
        let points: Vec<Point> = corners.iter().map(|(x, z)| Point::new(*x, *z)).collect();
        let outline = turnwright_geometry::Outline::polygon(&points).expect("an outline");
        let section = turnwright_stock::Section::new(&outline).expect("a section");
        PartShape::new(&section, &section, &[]).expect("a part")
    }

    #[test]
    fn chamfers_tapers_and_grooves_have_their_words() {
        // 2×45° in front, a groove of 4 at ⌀30, a taper of 1:5, a chamfer of 1×30° behind.
        let part = shape(&[
            (0., 0.),
            (18., 0.),
            (20., -2.),
            (20., -10.),
            (15., -10.),
            (15., -14.),
            (20., -14.),
            (20., -30.),
            (24., -70.),
            (24., -79.),
            (24. - 30_f64.to_radians().tan(), -80.),
            (0., -80.),
        ]);
        assert_eq!(texts(&part, false), ["1×30°", "2×45°", "▷ 1:5"]);
        let groove: Vec<_> =
            part.cylinders.iter().filter_map(|one| Some((one.diameter_mm, one.groove_mm?))).collect();
        assert_eq!(groove, [(30.0, 4.0)]);
        // A stretch that is open to one side is none, nor is one that is wider than a groove.
        let neck = shape(&[
            (0., 0.),
            (20., 0.),
            (20., -10.),
            (15., -10.),
            (15., -40.),
            (20., -40.),
            (20., -50.),
            (0., -50.),
        ]);
        assert!(neck.cylinders.iter().all(|one| one.groove_mm.is_none()));
    }

    #[test]
    fn what_is_alike_is_told_once_and_bores_apart() {
        let part = shape(&[
            (10., 0.),
            (19., 0.),
            (20., -1.),
            (20., -39.),
            (19., -40.),
            (10., -40.),
            (10., -22.),
            (13., -22.),
            (13., -19.),
            (10., -19.),
        ]);
        assert_eq!(texts(&part, false), ["1×45° (2×)"]);
        assert_eq!(texts(&part, true), Vec::<String>::new());
        let groove: Vec<_> =
            part.cylinders.iter().filter_map(|one| Some((one.diameter_mm, one.groove_mm?))).collect();
        assert_eq!(groove, [(26.0, 3.0)]);
    }
}
