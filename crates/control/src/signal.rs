//! Signals that a setup lets come while an axis moves: probes and skip inputs.

use serde::Deserialize;

use crate::AxisPair;

/// A signal: how far along a move it comes, or at which place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// The line whose move it stops; left out: any.
    pub line: Option<u32>,
    /// The input, as the program names it with P; left out: any.
    pub input: Option<u8>,
    /// The part of the way after which it comes, 0 to 1.
    pub at: Option<f64>,
    /// The X (diameter, work coordinates) at which it comes.
    pub x: Option<f64>,
    /// The Z (work coordinates) at which it comes.
    pub z: Option<f64>,
}

impl Signal {
    /// The part of a move from one place to another after which the signal comes.
    pub fn part(&self, line: u32, input: Option<u8>, from: AxisPair, to: AxisPair) -> Option<f64> {
        if self.line.is_some_and(|wanted| wanted != line) || self.input.is_some_and(|own| Some(own) != input)
        {
            return None;
        }
        let across = |place: f64, from: f64, to: f64| (place - from) / (to - from);
        let part = match (self.at, self.x, self.z) {
            (Some(part), _, _) => part,
            (None, Some(x), _) => across(x, from.x, to.x),
            (None, None, Some(z)) => across(z, from.z, to.z),
            (None, None, None) => 0.0,
        };
        (0.0..=1.0).contains(&part).then_some(part)
    }

    /// What is wrong with it.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let places = [self.at, self.x, self.z].into_iter().flatten().count();
        let is_part = self.at.is_none_or(|part| (0.0..=1.0).contains(&part));
        if places != 1 {
            Some("[[skip]] has one of at, x and z")
        } else if is_part {
            None
        } else {
            Some("[[skip]] at is a part of the way, 0 to 1")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_comes_after_a_part_of_the_way_or_at_a_place() {
        let (from, to) = (AxisPair { x: 50.0, z: 10.0 }, AxisPair { x: 50.0, z: -10.0 });
        let half = Signal { at: Some(0.5), line: Some(3), ..Signal::default() };
        assert_eq!(half.part(3, None, from, to), Some(0.5));
        assert_eq!(half.part(4, None, from, to), None);
        let face = Signal { z: Some(5.0), input: Some(2), ..Signal::default() };
        assert_eq!(face.part(1, Some(2), from, to), Some(0.25));
        assert_eq!(face.part(1, Some(1), from, to), None);
        assert_eq!(Signal { z: Some(11.0), ..face }.part(1, Some(2), from, to), None);
        assert_eq!(Signal { x: Some(60.0), ..Signal::default() }.part(1, None, from, to), None);
        assert!(Signal::default().fault().is_some());
        assert!(Signal { at: Some(2.0), ..Signal::default() }.fault().is_some());
    }
}
