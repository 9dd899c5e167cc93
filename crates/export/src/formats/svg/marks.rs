//! Places in a picture with a short text beside them: the numbers of passes where they begin.

use std::collections::HashSet;
use std::fmt::Write;

use turnwright_units::{Position, WorkTip};

use super::{Frame, escape_xml, hundredths, text_width_px};
use crate::path::Point;

/// A place with a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    at: Point,
    text: String,
}

impl Mark {
    /// The text at a place.
    pub fn new(at: Position<WorkTip>, text: impl Into<String>) -> Self {
        Self { at: Point { radius_mm: at.x.to_mm() as f32, z_mm: at.z.to_mm() as f32 }, text: text.into() }
    }
}

/// Texts in one picture at most.
const MARK_TEXTS_MAX: usize = 1_000;

/// A rectangle on the screen.
#[derive(Clone, Copy)]
struct Patch {
    left_px: f64,
    top_px: f64,
    right_px: f64,
    bottom_px: f64,
}

impl Patch {
    fn overlaps(&self, other: &Self) -> bool {
        self.left_px < other.right_px
            && other.left_px < self.right_px
            && self.top_px < other.bottom_px
            && other.top_px < self.bottom_px
    }

    fn is_in(&self, frame: &Frame) -> bool {
        self.left_px > frame.left_px
            && self.right_px < frame.right_px
            && self.top_px > frame.top_px
            && self.bottom_px < frame.bottom_px
    }
}

/// Dots, and beside each its text: right of it, left, above or below, wherever there is room.
pub(super) fn write(svg: &mut String, frame: &Frame, marks: &[Mark]) {
    const TEXT_PX: f64 = 11.0;
    const GAP_PX: f64 = 5.0;
    if marks.is_empty() {
        return;
    }
    svg.push_str("<g class=\"marks\" font-size=\"11\" font-weight=\"bold\" fill=\"#7a3b00\">\n");
    let dot = |mark: &Mark| {
        let (x, y) = frame.place(mark.at);
        Patch { left_px: x - 2.5, top_px: y - 2.5, right_px: x + 2.5, bottom_px: y + 2.5 }
    };
    let mut taken: Vec<Patch> = Vec::new();
    let mut spots = HashSet::new();
    for mark in marks {
        let dot = dot(mark);
        if !dot.is_in(frame) || !spots.insert(hundredths((dot.left_px, dot.top_px))) {
            continue;
        }
        let (x, y) = (dot.left_px + 2.5, dot.top_px + 2.5);
        let _ = write!(svg, r#"<circle cx="{x:.2}" cy="{y:.2}" r="2.5"/>"#);
        if taken.len() >= MARK_TEXTS_MAX {
            continue;
        }
        let (width_px, half_px) = (text_width_px(&mark.text, TEXT_PX), TEXT_PX / 2.0);
        let middles = [
            (x + GAP_PX + width_px / 2.0, y),
            (x - GAP_PX - width_px / 2.0, y),
            (x, y - GAP_PX - half_px),
            (x, y + GAP_PX + half_px),
        ];
        let room = middles.into_iter().map(|(x, y)| Patch {
            left_px: x - width_px / 2.0,
            top_px: y - half_px,
            right_px: x + width_px / 2.0,
            bottom_px: y + half_px,
        });
        let free = room
            .into_iter()
            .find(|room| room.is_in(frame) && !taken.iter().any(|other| other.overlaps(room)));
        if let Some(room) = free {
            taken.push(room);
            let _ = write!(
                svg,
                r##"<text x="{:.2}" y="{:.2}" text-anchor="middle" stroke="#fff" stroke-width="3" paint-order="stroke">{}</text>"##,
                f64::midpoint(room.left_px, room.right_px),
                room.bottom_px - 1.5,
                escape_xml(&mark.text)
            );
        }
        svg.push('\n');
    }
    svg.push_str("</g>\n");
}
