//! Arcs in planes that hold the side axis: X-Y and Y-Z with a Y axis, and the planes of polar and cylindrical
//! interpolation.
//!
//! The words are those of the plane: in X-Y the end `X Y` and the centre `I J`, in Y-Z `Y Z` and `J K`; in polar
//! interpolation X and C with `I J`; on a cylinder Z and C, by R alone. Seen with the plane's first axis to the
//! right and its second up (X-Y, Y-Z, Z-X), G02 turns clockwise. A word of an axis outside the plane is an
//! alarm. R, tolerance and a centre left out follow the rules of `arc.rs`; an end point off the circle by less
//! than the tolerance is met by a radius that changes along the arc.
//!
//! Source: circular interpolation, polar and cylindrical interpolation of both families.

use turnwright_canon::{Interpolation, Shape, SidePlane, SidePoint, Turn};
use turnwright_control::policy::NegativeArcRadius;
use turnwright_geometry::{ArcFault, Point, centre_from_radius};
use turnwright_syntax::Word;
use turnwright_units::Length;

use crate::axes::Plane;
use crate::block::Call;
use crate::machine::Core;
use crate::report::Alarm;
use crate::words::Role;

/// A place of the plane, X up and Z right as geometry has them.
fn point(plane: SidePlane, place: SidePoint) -> Point {
    let (right, up) = plane.right_and_up(place);
    Point::new(up, right)
}

/// A computed centre, to the nanometre.
fn centre_at(plane: SidePlane, centre: Point) -> Option<SidePoint> {
    let nm = |mm: f64| (mm.abs() < 1e9).then(|| Length::from_nm((mm * 1e6).round() as i64));
    let (right, up) = (nm(centre.z)?, nm(centre.x)?);
    Some(match plane {
        SidePlane::Face | SidePlane::Wall => SidePoint { along: right, side: up },
        SidePlane::Flank => SidePoint { along: up, side: right },
    })
}

#[cold]
pub(super) fn plane_arc(core: &mut Core, call: &mut Call<'_>, turn: Turn) -> Result<(), Alarm> {
    let plane = core.arc_plane(call)?;
    core.refuse_words_outside(plane, call)?;
    if core.untaken.is_some() {
        // The way of the offset is no part of the arc.
        core.warn_block("offset-moves-in-arc");
        core.make_movement(call.word)?;
    }
    let is_virtual = core.axes.is_virtual();
    let side = |core: &Core| if is_virtual { core.axes.v } else { core.axes.at.y };
    let from = plane.point(core.modal.position, side(core));
    let (to, mut ends) = core.end_point(call.block)?;
    let end_side = ends.side().unwrap_or(side(core));
    if is_virtual {
        ends.v = Some(end_side);
    } else {
        ends.y = Some(end_side);
    }
    let end = plane.point(to, end_side);
    let Some(feed) = core.feed_in_force() else {
        return Err(core.alarm_at("feed-missing", call.word));
    };
    core.check_spindle();
    let centre = if let Some(word) = call.block.word(b'R') {
        core.plane_centre_by_radius(plane, from, end, turn, word)?
    } else if let Some(word) = [b'I', b'J', b'K'].into_iter().find_map(|letter| call.block.word(letter)) {
        Some(core.plane_centre_by_words(plane, from, end, call, word)?)
    } else if core.settings.arc_without_radius_alarm {
        return Err(core.alarm_at("arc-without-radius", call.word));
    } else {
        core.warn_block("arc-as-line");
        return core.cut_with_axes(to, Shape::Line, feed, ends);
    };
    match centre {
        Some(centre) => core.cut_with_axes(to, Shape::SideArc { plane, turn, centre }, feed, ends),
        None => Ok(()),
    }
}

impl Core {
    /// The plane of an arc that is not the turning plane's.
    fn arc_plane(&self, call: &Call<'_>) -> Result<SidePlane, Alarm> {
        let refused = |word: Option<&Word>| Err(self.alarm_at("axis-not-in-plane", word));
        let parallel = self.axes.machine.c.as_ref().and_then(|axis| axis.parallel);
        let has_y = self.axes.machine.y.is_some();
        match (self.axes.interpolation, self.axes.plane) {
            (Interpolation::Polar { .. }, _) => Ok(SidePlane::Face),
            (Interpolation::Cylindrical { .. }, Plane::Zx) if parallel != Some(6) => Ok(SidePlane::Wall),
            (Interpolation::Cylindrical { .. }, Plane::Yz) if parallel != Some(5) => Ok(SidePlane::Flank),
            (Interpolation::Cylindrical { .. }, _) => refused(call.word),
            (Interpolation::Normal, Plane::Xy) if has_y => Ok(SidePlane::Face),
            (Interpolation::Normal, Plane::Yz) if has_y => Ok(SidePlane::Flank),
            // In the turning plane a word of another axis brought the arc here.
            (Interpolation::Normal, Plane::Zx) => refused(self.other_axis_word(call.block)),
            (Interpolation::Normal, _) => refused(call.word),
        }
    }

    fn refuse_words_outside(&self, plane: SidePlane, call: &Call<'_>) -> Result<(), Alarm> {
        self.refuse_comma_on_arc(call)?;
        let is_cylinder = matches!(self.axes.interpolation, Interpolation::Cylindrical { .. });
        if is_cylinder
            && let Some(word) = [b'I', b'J', b'K'].into_iter().find_map(|letter| call.block.word(letter))
        {
            return Err(self.alarm("arc-centre-on-cylinder", word));
        }
        let outside: &[u8] = match (plane, self.axes.is_virtual()) {
            (SidePlane::Face, true) => b"ZWKYVB",
            (SidePlane::Face, false) => b"ZWKCHB",
            (_, true) => b"XUYVB",
            (_, false) => b"XUICHB",
        };
        match outside.iter().find_map(|letter| call.block.word(*letter)) {
            Some(word) => Err(self.alarm("axis-not-in-plane", word)),
            None => Ok(()),
        }
    }

    fn refuse_comma_on_arc(&self, call: &Call<'_>) -> Result<(), Alarm> {
        match call.block.words.iter().find(|word| word.comma) {
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }

    /// `None`: an arc of no degrees.
    fn plane_centre_by_radius(
        &mut self,
        plane: SidePlane,
        from: SidePoint,
        to: SidePoint,
        turn: Turn,
        word: &Word,
    ) -> Result<Option<SidePoint>, Alarm> {
        let radius = self.radius(word, Role::ArcOffset)?;
        self.missing_point(word);
        if radius.0.signum() < 0 && self.control.policies.negative_arc_radius == NegativeArcRadius::Alarm {
            return Err(self.alarm("negative-radius", word));
        }
        if radius.0.is_zero() {
            return Err(self.arc_alarm(word, 0.0));
        }
        let tolerance = self.settings.arc_tolerance_mm.max(0.0);
        let (start, end) = (point(plane, from), point(plane, to));
        match centre_from_radius(start, end, radius.to_mm(), turn == Turn::Clockwise, tolerance) {
            Ok(centre) => match centre_at(plane, centre) {
                Some(centre) => Ok(Some(centre)),
                None => Err(self.alarm("number-too-long", word)),
            },
            Err(ArcFault::RadiusTooSmall { missing_mm }) => Err(self.arc_alarm(word, missing_mm)),
            Err(ArcFault::NoChord) => Ok(None),
        }
    }

    fn plane_centre_by_words(
        &mut self,
        plane: SidePlane,
        from: SidePoint,
        to: SidePoint,
        call: &Call<'_>,
        first: &Word,
    ) -> Result<SidePoint, Alarm> {
        let along = match plane {
            SidePlane::Face => {
                self.optional_radius(call.block, b'I', Role::ArcOffset)?.map(|radius| radius.0)
            }
            SidePlane::Flank | SidePlane::Wall => {
                call.block.word(b'K').map(|word| self.length(word)).transpose()?
            }
        };
        let side = call.block.word(b'J').map(|word| self.length(word)).transpose()?;
        let (along, side) = (along.unwrap_or(Length::ZERO), side.unwrap_or(Length::ZERO));
        if along.is_zero() && side.is_zero() {
            return Err(self.arc_alarm(first, 0.0));
        }
        let centre = SidePoint { along: from.along + along, side: from.side + side };
        let middle = point(plane, centre);
        let error = (middle.distance(point(plane, from)) - middle.distance(point(plane, to))).abs();
        let tolerance = self.settings.arc_tolerance_mm;
        if tolerance > 0.0 && error > tolerance { Err(self.arc_alarm(first, error)) } else { Ok(centre) }
    }
}
