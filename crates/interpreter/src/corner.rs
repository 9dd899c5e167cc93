//! Automatic chamfer and corner radius between two lines parallel to the axes.
//!
//! The block with the corner word is kept until the next line is known; its end point is the virtual corner,
//! and increments of the next block count from there. Values are radius values for both axes; the sign is the
//! direction of the next line. Source: automatic chamfer and corner R of the linear move.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_diagnostics::{Argument, Diagnostic, Place};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Feed, Length, Position, Radius, WorkTip};

use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

/// The axis of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X,
    Z,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Chamfer,
    Fillet,
}

/// A corner whose second line is not known yet.
#[derive(Clone, Debug)]
pub(crate) struct PendingCorner {
    form: Form,
    /// Size, radius; with a sign it is that of the next line's direction.
    size: Length,
    /// The sign counts: the form without a comma, or a minus in the other.
    is_signed: bool,
    axis: Axis,
    /// Where the first line starts.
    start: Position<WorkTip>,
    /// The virtual corner.
    corner: Position<WorkTip>,
    feed: Feed,
    place: Place,
    quote: String,
    line: u32,
    sequence: Option<u32>,
    gap: u8,
    gap_max: u8,
}

impl PendingCorner {
    /// Counts a block without a move, in `line`; true when there were too many.
    pub(crate) fn waits_too_long(&mut self, line: u32) -> bool {
        // The block that asks for the corner is not one of them.
        self.gap += u8::from(line != self.line);
        self.gap > self.gap_max
    }
}

fn direction(axis: Axis, from: Position<WorkTip>, to: Position<WorkTip>) -> Length {
    match axis {
        Axis::X => (to.x - from.x).0,
        Axis::Z => to.z - from.z,
    }
}

/// The point `distance` (signed) from `from` along an axis.
fn along(axis: Axis, from: Position<WorkTip>, distance: Length) -> Position<WorkTip> {
    match axis {
        Axis::X => Position::new(from.x + Radius(distance), from.z),
        Axis::Z => Position::new(from.x, from.z + distance),
    }
}

impl Core {
    /// The corner word of a linear block, if it has one.
    fn corner_word(&self, block: &Block) -> Result<Option<(Form, Word)>, Alarm> {
        use turnwright_control::policy::CornerWords;
        if self.control.policies.corner_words == CornerWords::LengthAndFillet {
            return match block.word(b'L').or(block.word(b'D')) {
                Some(word) => Err(self.not_supported("corners-by-length-and-fillet", word)),
                None => Ok(None),
            };
        }
        let mut found = None;
        for word in &block.words {
            let form = match (word.address, word.comma) {
                (b'R', _) => Form::Fillet,
                (b'C', true) => Form::Chamfer,
                (b'C', false) if self.settings.plain_corner_letters => Form::Chamfer,
                (b'I' | b'K', false) => Form::Chamfer,
                (b'A', true) => {
                    return Err(self.not_supported("drawing-dimensions", word));
                }
                (_, true) => return Err(self.alarm("illegal-address", word)),
                _ => continue,
            };
            if found.is_some() {
                return Err(self.alarm("too-many-corner-words", word));
            }
            found = Some((form, *word));
        }
        Ok(found)
    }

    /// Something that a later version does, by its key in the table of functions: named, never passed over.
    pub(crate) fn not_supported(&self, function: &str, word: &Word) -> Alarm {
        let quote = self.quote(word.start, word.end);
        let diagnostic = Diagnostic::error("not-supported-yet").at(self.place(word));
        let diagnostic = diagnostic.with("code", quote.clone()).with("word", quote);
        self.finish(diagnostic.with("name", Argument::Function(function.into())))
    }

    /// A linear block that has a corner word, or follows one that has.
    #[cold]
    pub(crate) fn linear_with_corner(
        &mut self,
        block: &Block,
        to: Position<WorkTip>,
        feed: Feed,
    ) -> Result<(), Alarm> {
        let word = self.corner_word(block)?;
        let mut start = self.tip;
        if let Some(corner) = self.corner.take() {
            start = self.resolve_corner(&corner, to)?;
        }
        let Some((form, word)) = word else {
            self.modal.position = to;
            return self.emit_move(to, Action::Feed { to, shape: Shape::Line, feed, others: None });
        };
        let size = self.radius(&word, Role::CornerSize)?.0;
        if size.is_zero() {
            // A corner of no size is the plain corner of two lines.
            self.modal.position = to;
            return self.emit_move(to, Action::Feed { to, shape: Shape::Line, feed, others: None });
        }
        let corner_point = self.modal.position;
        let moves_x = to.x != corner_point.x;
        let moves_z = to.z != corner_point.z;
        let axis = match (moves_x, moves_z) {
            (true, false) => Axis::X,
            (false, true) => Axis::Z,
            (true, true) if word.comma => {
                return Err(self.not_supported("drawing-dimensions", &word));
            }
            (true, true) => return Err(self.alarm("taper-in-corner-block", &word)),
            (false, false) => return Err(self.alarm("corner-longer-than-move", &word)),
        };
        // I leads off in X and so belongs to a line along Z; K the other way round.
        let fits = match word.address {
            b'I' if !word.comma => axis == Axis::Z,
            b'K' if !word.comma => axis == Axis::X,
            _ => true,
        };
        if !fits {
            return Err(self.alarm("corner-axis-mismatch", &word));
        }
        self.missing_point(&word);
        if direction(axis, start, to).abs() < size.abs() {
            return Err(self.alarm("corner-longer-than-move", &word));
        }
        let gap_max = self.control.limits.corner_gap_max;
        self.corner = Some(PendingCorner {
            form,
            size,
            is_signed: !word.comma || size.signum() < 0,
            axis,
            start,
            corner: to,
            feed,
            place: self.place(&word),
            quote: self.quote(word.start, word.end),
            line: self.at.line,
            sequence: self.at.sequence,
            gap: 0,
            gap_max,
        });
        self.modal.position = to;
        Ok(())
    }

    /// Gives out the first line up to the corner and the corner itself, now that the second line is known;
    /// gives the end of the corner.
    fn resolve_corner(
        &mut self,
        corner: &PendingCorner,
        to: Position<WorkTip>,
    ) -> Result<Position<WorkTip>, Alarm> {
        let next = match corner.axis {
            Axis::X => Axis::Z,
            Axis::Z => Axis::X,
        };
        let ahead = direction(next, corner.corner, to);
        if !direction(corner.axis, corner.corner, to).is_zero() {
            if !corner.is_signed {
                let diagnostic = Diagnostic::error("not-supported-yet").at(corner.place);
                let diagnostic =
                    diagnostic.with("code", corner.quote.clone()).with("word", corner.quote.clone());
                let diagnostic = diagnostic.with("name", Argument::Function("drawing-dimensions".into()));
                return Err(self.finish(diagnostic.near(self.block_place(), "next-block")));
            }
            return Err(self.corner_alarm("no-perpendicular-after-corner", corner));
        }
        let against = corner.is_signed && ahead.signum() != corner.size.signum();
        if ahead.abs() < corner.size.abs() || against {
            return Err(self.corner_alarm("bad-move-after-corner", corner));
        }
        let size = corner.size.abs();
        let way = direction(corner.axis, corner.start, corner.corner);
        let before = along(corner.axis, corner.corner, size.times(-way.signum()));
        let after = along(next, corner.corner, size.times(ahead.signum()));
        let line = Action::Feed { to: before, shape: Shape::Line, feed: corner.feed, others: None };
        // Both elements belong to the block that asked for them.
        let (here, sequence) = (self.at.line, self.at.sequence);
        (self.at.line, self.at.sequence) = (corner.line, corner.sequence);
        self.emit_move(before, line)?;
        if !size.is_zero() {
            let shape = match corner.form {
                Form::Chamfer => Shape::Line,
                Form::Fillet => {
                    let centre = along(next, before, size.times(ahead.signum()));
                    Shape::Arc { turn: turn(corner.axis, way, ahead), centre }
                }
            };
            self.emit_move(after, Action::Feed { to: after, shape, feed: corner.feed, others: None })?;
        }
        (self.at.line, self.at.sequence) = (here, sequence);
        Ok(after)
    }

    fn corner_alarm(&self, key: &'static str, corner: &PendingCorner) -> Alarm {
        let diagnostic = Diagnostic::alarm(key).at(corner.place).with("word", corner.quote.clone());
        self.finish(diagnostic.near(self.block_place(), "next-block"))
    }

    /// The block in work cannot follow a corner.
    pub(crate) fn corner_without_next(&mut self) -> Alarm {
        match self.corner.take() {
            Some(corner) if self.is_in_figure() => self.corner_alarm("figure-ends-in-corner", &corner),
            Some(corner) if corner.gap > corner.gap_max => {
                self.corner_alarm("bad-move-after-corner", &corner)
            }
            Some(corner) => self.corner_alarm("no-perpendicular-after-corner", &corner),
            None => self.alarm_block("no-perpendicular-after-corner"),
        }
    }
}

/// Which way the fillet turns, seen with Z to the right and X up.
fn turn(first: Axis, way: Length, ahead: Length) -> Turn {
    let same = way.signum() == ahead.signum();
    // From +Z to +X is counter-clockwise, from +X to +Z clockwise.
    match (first, same) {
        (Axis::Z, true) | (Axis::X, false) => Turn::CounterClockwise,
        (Axis::Z, false) | (Axis::X, true) => Turn::Clockwise,
    }
}
