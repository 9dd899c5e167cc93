//! Mirror image and rotation: from the coordinates that a program writes to those of the work.
//!
//! The double turret mirror turns X around for a tool on the turret at the other side, whose place is
//! that of the first turret shifted by a parameter; the rotation turns moves about a point of the plane. Everything
//! before this stage (cycles, corners, compensation) works in program coordinates; commands are given out in work
//! coordinates, each computed point rounded once to the least increment.
//!
//! Source: mirror image for double turret; coordinate system rotation of the 988 series.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_units::{LeastIncrement, Length, Position, Radius, WorkTip};

use crate::machine::Core;

/// A rotation in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotation {
    centre: Position<WorkTip>,
    sin: f64,
    cos: f64,
}

impl Rotation {
    /// About `centre` by `angle_deg`, counter-clockwise with Z to the right and X up. Multiples of 90 degrees are
    /// exact.
    pub(crate) fn new(centre: Position<WorkTip>, angle_deg: f64) -> Self {
        let angle_deg = angle_deg % 360.0;
        let (sin, cos) = match (angle_deg / 90.0, (angle_deg / 90.0).fract() == 0.0) {
            (quarters, true) => match (quarters as i8).rem_euclid(4) {
                0 => (0.0, 1.0),
                1 => (1.0, 0.0),
                2 => (0.0, -1.0),
                _ => (-1.0, 0.0),
            },
            _ => (libm::sin(angle_deg.to_radians()), libm::cos(angle_deg.to_radians())),
        };
        Self { centre, sin, cos }
    }

    /// To the nanometre.
    fn turned(&self, place: Position<WorkTip>, sin: f64) -> Position<WorkTip> {
        let (x, z) = (place.x - self.centre.x, place.z - self.centre.z);
        let (x_mm, z_mm) = (x.to_mm(), z.to_mm());
        let nm = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
        Position::new(
            self.centre.x + Radius(nm(z_mm * sin + x_mm * self.cos)),
            self.centre.z + nm(z_mm * self.cos - x_mm * sin),
        )
    }
}

/// What lies between program and work coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Transform {
    pub(crate) is_mirrored: bool,
    pub(crate) rotation: Option<Rotation>,
}

impl Transform {
    /// Whether program and work coordinates differ.
    pub(crate) fn is_on(&self) -> bool {
        self.is_mirrored || self.rotation.is_some()
    }

    fn exact(&self, place: Position<WorkTip>) -> Position<WorkTip> {
        let place = self.rotation.map_or(place, |rotation| rotation.turned(place, rotation.sin));
        if self.is_mirrored { Position::new(-place.x, place.z) } else { place }
    }

    /// A place that the program writes, in work coordinates.
    pub(crate) fn to_work(self, place: Position<WorkTip>, increment: LeastIncrement) -> Position<WorkTip> {
        let place = self.exact(place);
        if self.rotation.is_none() {
            return place;
        }
        let x = place.x.to_diameter().rounded(increment).to_radius();
        Position::new(x, place.z.rounded(increment))
    }

    /// A place in work coordinates as the program would write it.
    pub(crate) fn to_program(self, place: Position<WorkTip>) -> Position<WorkTip> {
        let place = if self.is_mirrored { Position::new(-place.x, place.z) } else { place };
        self.rotation.map_or(place, |rotation| rotation.turned(place, -rotation.sin))
    }

    /// A move in work coordinates.
    pub(crate) fn action(self, mut action: Action, increment: LeastIncrement) -> Action {
        match &mut action {
            Action::Rapid { to, .. } | Action::Feed { to, .. } | Action::Thread { to, .. } => {
                *to = self.to_work(*to, increment);
            }
            _ => {}
        }
        if let Action::Feed { shape: Shape::Arc { turn, centre }, .. } = &mut action {
            *centre = self.exact(*centre);
            if self.is_mirrored {
                *turn = match turn {
                    Turn::Clockwise => Turn::CounterClockwise,
                    Turn::CounterClockwise => Turn::Clockwise,
                };
            }
        }
        action
    }
}

impl Core {
    /// A place of the program, mirror and rotation carried out.
    pub(crate) fn in_work(&self, place: Position<WorkTip>) -> Position<WorkTip> {
        if self.transform.is_on() {
            self.transform.to_work(place, self.modal.increment(&self.settings))
        } else {
            place
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(diameter_mm: i32, z_mm: i32) -> Position<WorkTip> {
        Position::new(
            turnwright_units::Diameter(Length::from_mm(diameter_mm)).to_radius(),
            Length::from_mm(z_mm),
        )
    }

    #[test]
    fn quarters_are_exact_and_turn_counter_clockwise() {
        // Seen with Z to the right and X up, 10 along Z turned by 90 degrees is a radius of 10.
        let quarter = Transform { rotation: Some(Rotation::new(at(0, 0), 90.0)), ..Transform::default() };
        assert_eq!(quarter.to_work(at(0, 10), LeastIncrement::METRIC_B), at(20, 0));
        assert_eq!(quarter.to_program(at(20, 0)), at(0, 10));
        let back = Transform { rotation: Some(Rotation::new(at(0, 0), -450.0)), ..Transform::default() };
        assert_eq!(back.to_work(at(20, 0), LeastIncrement::METRIC_B), at(0, 10));
    }

    #[test]
    fn there_and_back_is_the_same_place() {
        for angle_deg in [0.0, 1.0, 33.3, 90.0, 179.999, -12.5] {
            for is_mirrored in [false, true] {
                let transform =
                    Transform { is_mirrored, rotation: Some(Rotation::new(at(30, -5), angle_deg)) };
                let place = at(84, -77);
                let back = transform.to_program(transform.to_work(place, LeastIncrement::METRIC_C));
                let off = (back.x.0 - place.x.0).abs().nm().max((back.z - place.z).abs().nm());
                assert!(off <= 100, "{angle_deg}: {off} nm");
            }
        }
    }
}
