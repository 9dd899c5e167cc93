//! Sizes against the limits of the drawing.

use turnwright_control::{Measure, Quantity};
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_stock::Section;
use turnwright_stock::machining::ThreadMark;

use super::{Ring, Sizes, thread_at};

/// Sizes that miss a limit by less are on it: a nanometre, the grain of exact lengths.
const GRAIN_MM: f64 = 1e-6;

/// A face that a length begins or ends at is no farther from its nominal place, mm.
const FACE_MM: f64 = 1.0;

/// Both sides of a place differ by no more where it is no face, mm.
const FACE_STEP_MM: f64 = 1e-3;

/// Why a size cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotThere {
    /// No material at the place.
    NoMaterial,
    /// Solid where a bore should be.
    Solid,
    /// A face stands at the place: it has two diameters.
    Face,
    /// No gap at the diameter, or more than one and no Z that says which.
    NoGap,
    /// No face near the place.
    NoFace,
    /// No thread at the place.
    NoThread,
}

impl NotThere {
    /// The word of reports; `size-…` are its sentences.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoMaterial => "no-material",
            Self::Solid => "solid",
            Self::Face => "face",
            Self::NoGap => "no-gap",
            Self::NoFace => "no-face",
            Self::NoThread => "no-thread",
        }
    }
}

/// A size of the drawing beside that of the part.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What the drawing asks for.
    pub measure: Measure,
    /// What the part has, mm.
    pub found: Result<f64, NotThere>,
}

impl Judged {
    /// How far the size is off its nominal one, mm.
    pub fn deviation_mm(&self) -> Option<f64> {
        self.found.ok().map(|found| found - self.measure.nominal_mm)
    }

    /// Whether the size is within its limits; nothing when it has none and is only shown.
    pub fn passes(&self) -> Option<bool> {
        let Some((upper, lower)) = self.measure.deviations_mm else {
            return self.found.is_err().then_some(false);
        };
        let within = |deviation: f64| deviation <= upper + GRAIN_MM && deviation >= lower - GRAIN_MM;
        Some(self.deviation_mm().is_some_and(within))
    }

    /// What is to be told of a size that does not pass; `number` is that of its `[[measure]]`, from 1.
    pub fn finding(&self, number: usize) -> Option<Diagnostic> {
        if self.passes() != Some(false) {
            return None;
        }
        let measure = &self.measure;
        let what = measure.name.clone().unwrap_or_else(|| format!("[[measure]] {number}"));
        let nominal = nominal_text(measure);
        Some(match self.found {
            Ok(found) => {
                let (upper, lower) = measure.deviations_mm.unwrap_or_default();
                let deviation = found - measure.nominal_mm;
                let over = if deviation > upper { deviation - upper } else { deviation - lower };
                Diagnostic::new(Severity::Error, "size-out-of-tolerance")
                    .with("name", what)
                    .with("value", tenths_of_micrometres(found))
                    .with("expected", nominal)
                    .with("difference", signed(over))
            }
            Err(why) => {
                Diagnostic::new(Severity::Error, why.key()).with("name", what).with("expected", nominal)
            }
        })
    }
}

impl NotThere {
    const fn key(self) -> &'static str {
        match self {
            Self::Face => "size-at-face",
            _ => "size-not-there",
        }
    }
}

/// The nominal size with its limits and place: `⌀30 +0/-0.021 (Z-32)`.
pub fn nominal_text(measure: &Measure) -> String {
    let limits = measure
        .deviations_mm
        .map_or_else(String::new, |(upper, lower)| format!(" {}/{}", signed(upper), signed(lower)));
    let place = match measure.quantity {
        Quantity::Width { diameter_mm, near_z: Some(z) } => format!("X{diameter_mm} Z{z}"),
        Quantity::Width { diameter_mm, near_z: None } => format!("X{diameter_mm}"),
        Quantity::Length { from, to } => format!("Z{from} … Z{to}"),
        Quantity::Diameter(z)
        | Quantity::Bore(z)
        | Quantity::Wall(z)
        | Quantity::Major(z)
        | Quantity::Minor(z)
        | Quantity::Lead(z) => format!("Z{z}"),
    };
    let sign = match measure.quantity {
        Quantity::Diameter(_) | Quantity::Bore(_) | Quantity::Major(_) | Quantity::Minor(_) => "⌀",
        _ => "",
    };
    format!("{sign}{}{limits} ({place})", measure.nominal_mm)
}

fn tenths_of_micrometres(mm: f64) -> String {
    ((mm * 1e4).round() / 1e4 + 0.0).to_string()
}

fn signed(mm: f64) -> String {
    let text = tenths_of_micrometres(mm);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// Measures what the drawing asks for, in its order.
pub fn judge(section: &Section, marks: &[ThreadMark], measures: &[Measure]) -> Vec<Judged> {
    let sizes = Sizes::new(section, marks);
    let faces = sizes.map_or_else(Vec::new, |sizes| sizes.faces_mm);
    let found = |quantity: &Quantity| find(section, marks, &faces, quantity);
    measures
        .iter()
        .map(|measure| Judged { measure: measure.clone(), found: found(&measure.quantity) })
        .collect()
}

fn find(
    section: &Section,
    marks: &[ThreadMark],
    faces: &[f64],
    quantity: &Quantity,
) -> Result<f64, NotThere> {
    let thread = |z| thread_at(section, marks, z).ok_or(NotThere::NoThread);
    match *quantity {
        Quantity::Diameter(z) => {
            both_sides(section, z, |rings| Ok(rings.last().ok_or(NotThere::NoMaterial)?.diameter_mm))
        }
        Quantity::Bore(z) => both_sides(section, z, |rings| match rings.first() {
            None => Err(NotThere::NoMaterial),
            Some(ring) if ring.bore_mm <= 0.0 => Err(NotThere::Solid),
            Some(ring) => Ok(ring.bore_mm),
        }),
        Quantity::Wall(z) => both_sides(section, z, |rings| match rings.last() {
            None => Err(NotThere::NoMaterial),
            Some(ring) if ring.bore_mm <= 0.0 => Err(NotThere::Solid),
            Some(ring) => Ok(ring.wall_mm()),
        }),
        Quantity::Width { diameter_mm, near_z } => {
            let gaps = section.gaps(diameter_mm / 2.0);
            let off = |gap: &(f64, f64), z: f64| (gap.0 - z).max(z - gap.1).max(0.0);
            let gap = match (near_z, gaps.as_slice()) {
                (None, [gap]) => Some(gap),
                (None, _) => None,
                (Some(z), _) => gaps.iter().min_by(|a, b| off(a, z).total_cmp(&off(b, z))),
            };
            gap.map(|gap| gap.1 - gap.0).ok_or(NotThere::NoGap)
        }
        Quantity::Length { from, to } => {
            let face = |z: f64| {
                let nearest = faces.iter().min_by(|a, b| (*a - z).abs().total_cmp(&(*b - z).abs()));
                nearest.copied().filter(|face| (face - z).abs() <= FACE_MM).ok_or(NotThere::NoFace)
            };
            let (from, to) = (face(from)?, face(to)?);
            if from == to { Err(NotThere::NoFace) } else { Ok((from - to).abs()) }
        }
        Quantity::Major(z) => Ok(thread(z)?.major_mm),
        Quantity::Minor(z) => Ok(thread(z)?.minor_mm),
        Quantity::Lead(z) => Ok(thread(z)?.lead_mm),
    }
}

/// A size at a Z that is the same on both sides of it. At an end of the part the side that has material counts.
fn both_sides(
    section: &Section,
    z: f64,
    size: impl Fn(&[Ring]) -> Result<f64, NotThere>,
) -> Result<f64, NotThere> {
    let beside = section.rings_beside(z);
    let rings = |rings: Vec<(f64, f64)>| rings.into_iter().map(Ring::of).collect::<Vec<_>>();
    let (behind, in_front) = (rings(beside.behind), rings(beside.in_front));
    match (behind.is_empty(), in_front.is_empty()) {
        (true, true) => Err(NotThere::NoMaterial),
        (false, true) => size(&behind),
        (true, false) => size(&in_front),
        (false, false) => match (size(&behind), size(&in_front)) {
            (Ok(a), Ok(b)) if (a - b).abs() <= FACE_STEP_MM => Ok((a + b) / 2.0),
            (Err(a), Err(b)) if a == b => Err(a),
            _ => Err(NotThere::Face),
        },
    }
}
