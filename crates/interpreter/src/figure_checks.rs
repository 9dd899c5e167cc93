//! What controls ask of a figure before they rough it: the type of roughing that its first block calls for, whether
//! it turns back, whether it reaches beyond the start point, where its allowances point.
//!
//! In: a [`Captured`] figure and the words of the cycle block. Out: alarms where the control refuses, warnings where
//! it goes on although a machinist would not mean it. Source: rules of the figure, chapters 1.5, 1.6, 3, 4 and 11 of
//! the cycles.

use turnwright_canon::Turn;
use turnwright_control::policy::{CycleType, MonotonyCheck, PatternMonotony, RoughingCompensation, TypeTwo};
use turnwright_cycles::{self as cycles, CutAlong};
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_geometry::{Side, sweep_rad};
use turnwright_syntax::{Block, Value};
use turnwright_units::{Length, Position, Radius, WorkTip};

use crate::block::Call;
use crate::figure::Captured;
use crate::machine::Core;
use crate::plane::point;
use crate::report::Alarm;

/// How a figure is roughed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RoughType {
    /// Without pockets.
    One,
    /// With pockets.
    Two,
}

/// What rounding adds to half a circle at most.
const HALF_TURN_SLACK_RAD: f64 = 1e-3;

/// Whether a word that switches something on is there and not zero.
pub(crate) fn switches_on(block: &Block, letter: u8) -> bool {
    block.word(letter).is_some_and(|word| matches!(word.value, Value::Number(number) if number.digits != 0))
}

/// Which way along X and along Z the part lies: where the infeed goes, or on an axis without infeed towards the
/// furthest point of the figure.
fn ways_into_work(figure: &cycles::Figure, along: Option<CutAlong>) -> (Length, Length) {
    let start = figure.start;
    let way = |is_infeed: bool, way: fn(&cycles::Element, Position<WorkTip>) -> Length| {
        let furthest = || {
            let ways = figure.elements.iter().map(|element| way(element, start));
            ways.max_by_key(|way| way.abs()).unwrap_or_default()
        };
        let first = figure.elements.first().map(|element| way(element, start));
        first.filter(|first| is_infeed && !first.is_zero()).unwrap_or_else(furthest)
    };
    let x = way(along == Some(CutAlong::Z), |element, start| (element.to.x - start.x).0);
    let z = way(along == Some(CutAlong::X), |element, start| element.to.z - start.z);
    (x, z)
}

impl Core {
    /// The axes in the figure's first block choose the type, or the figure itself does.
    pub(crate) fn rough_type(&self, captured: &Captured, along: CutAlong) -> Result<RoughType, Alarm> {
        let (depth, other, expected) = match along {
            CutAlong::Z => (captured.first_has_x, captured.first_has_z, "X"),
            CutAlong::X => (captured.first_has_z, captured.first_has_x, "Z"),
        };
        let policies = &self.control.policies;
        // A first block that moves along the cut is a wall, which only type II follows.
        let begins_with_wall = || {
            let start = captured.figure.start;
            captured.figure.elements.first().is_some_and(|first| {
                let is_arc = matches!(first.motion, cycles::FigureMotion::Arc { .. });
                let moves = match along {
                    CutAlong::Z => first.to.z != start.z,
                    CutAlong::X => first.to.x != start.x,
                };
                is_arc || (other && moves)
            })
        };
        let is_two = match policies.cycle_type {
            CycleType::ByTypeParameter if !self.settings.type_by_first_block => {
                self.has_pockets(captured, along) || begins_with_wall()
            }
            _ => other,
        };
        let has_type_two = match policies.type_two {
            TypeTwo::Available => true,
            TypeTwo::TurningOnly => along == CutAlong::Z,
            TypeTwo::Alarm => false,
        };
        match (depth, is_two) {
            (true, false) => Ok(RoughType::One),
            (true, true) if has_type_two => Ok(RoughType::Two),
            _ => {
                let diagnostic = Diagnostic::alarm("figure-start-axis").at(captured.first_place);
                Err(self.finish(
                    diagnostic
                        .with("word", format!("N{}", captured.range.first))
                        .with("expected", expected)
                        .near(captured.range.first_place, "figure-range-here"),
                ))
            }
        }
    }

    /// Whether the contour goes down again behind the place where it has come up.
    fn has_pockets(&self, captured: &Captured, along: CutAlong) -> bool {
        cycles::monotony_fault(&captured.figure, along, self.monotony_tolerance())
            .is_some_and(|fault| (fault.axis == cycles::PlaneAxis::Second) == (along == CutAlong::Z))
    }

    /// How far an axis may turn back: what the parameters forgive, and half an increment in any case.
    pub(crate) fn monotony_tolerance(&self) -> cycles::Tolerance {
        let half = Length::from_nm(self.modal.increment(&self.settings).nm() / 2);
        let [first, second] = self.settings.monotony_tolerances;
        cycles::Tolerance { x: Radius(second.max(half)), z: first.max(half) }
    }

    /// Whether this control refuses a figure that turns back.
    fn checks_monotony(&self, block: &Block) -> bool {
        match self.control.policies.monotony_check {
            MonotonyCheck::ByFigureCheck => self.settings.figure_check,
            MonotonyCheck::ByMonotonyBit => self.settings.monotony_check,
            MonotonyCheck::ByMonotonyBits => {
                self.settings.monotony_check && self.settings.type_by_first_block
            }
            MonotonyCheck::ByWord => switches_on(block, b'K'),
        }
    }

    /// Figures that turn back or reach beyond the start point, and allowances that cut into them.
    pub(crate) fn check_figure(
        &mut self,
        captured: &Captured,
        kind: RoughType,
        along: CutAlong,
        allowances: (Radius, Length),
        call: &Call<'_>,
    ) -> Result<(), Alarm> {
        self.check_monotony(captured, kind, along, call.block)?;
        if kind == RoughType::Two {
            self.check_pockets(captured, along, call)?;
        }
        let warned = self.warn_allowance_signs(call, &captured.figure, Some(along), allowances);
        if let Some(fault) = cycles::start_inside_fault(&captured.figure, along, allowances.0, allowances.1) {
            let place = self.element_place(captured, fault.element);
            if self.settings.figure_check {
                return Err(self.finish(Diagnostic::alarm("figure-beyond-start").at(place)));
            }
            if !warned {
                self.warn_element("figure-beyond-start-warning", place, None);
            }
        }
        if let Some(element) = cycles::hump_before_end(&captured.figure, along, self.monotony_tolerance()) {
            let place = self.element_place(captured, captured.figure.elements.len() as u32 - 1);
            self.warn_element("return-through-figure", place, Some(self.element_place(captured, element)));
        }
        let sideways = match along {
            CutAlong::Z => call.block.word(b'W').filter(|_| !allowances.1.is_zero()),
            CutAlong::X => call.block.word(b'U').filter(|_| !allowances.0.0.is_zero()),
        };
        if let (RoughType::Two, Some(word)) = (kind, sideways)
            && self.has_pockets(captured, along)
        {
            self.warn("allowance-into-pocket-wall", word);
        }
        Ok(())
    }

    /// Compensation that shifts the figure keeps the nose on the side of the blank, which is that of the start point.
    pub(crate) fn check_blank_side(
        &self,
        figure: &cycles::Figure,
        along: CutAlong,
        call: &Call<'_>,
    ) -> Result<(), Alarm> {
        let shifts = self.control.policies.roughing_compensation == RoughingCompensation::BeforeCycle;
        let (Some(first), Some(last)) = (figure.elements.first(), figure.elements.last()) else {
            return Ok(());
        };
        let (into, forward) = (first.to - figure.start, last.to - first.to);
        // Seen with Z to the right and X up, +X lies left of the way to +Z, and -Z left of that to +X.
        let wrong = match along {
            CutAlong::Z => into.x.0.signum() * forward.z.signum(),
            CutAlong::X => -into.z.signum() * forward.x.0.signum(),
        };
        let wrong = match wrong {
            1 => Side::Left,
            -1 => Side::Right,
            _ => return Ok(()),
        };
        if shifts && self.compensates_on(wrong) {
            return Err(self.alarm_at("cycle-compensation-side", call.word));
        }
        Ok(())
    }

    /// More pockets than the control keeps.
    fn check_pockets(&self, captured: &Captured, along: CutAlong, call: &Call<'_>) -> Result<(), Alarm> {
        let limit = self.control.limits.pockets_max;
        if limit == 0 || cycles::pocket_count(&captured.figure, along, self.monotony_tolerance()) <= limit {
            return Ok(());
        }
        let place = call.word.map_or_else(|| self.block_place(), |word| self.place(word));
        let diagnostic = Diagnostic::alarm("too-many-pockets").at(place);
        Err(self.finish(diagnostic.with("limit", i64::from(limit))))
    }

    /// An axis that turns back. Along the cut no pocket can be roughed; along the depth axis controls look at it only
    /// without pockets, and most only when a parameter or word says so.
    fn check_monotony(
        &mut self,
        captured: &Captured,
        kind: RoughType,
        along: CutAlong,
        block: &Block,
    ) -> Result<(), Alarm> {
        let tolerance = self.monotony_tolerance();
        let fault = match kind {
            RoughType::One => cycles::monotony_fault(&captured.figure, along, tolerance),
            RoughType::Two => cycles::turn_back_fault(&captured.figure, along, tolerance),
        };
        if kind == RoughType::One && self.control.policies.monotony_check == MonotonyCheck::ByWord {
            self.refuse_round_arcs(captured, along)?;
        }
        let Some(fault) = fault else { return Ok(()) };
        let place = self.element_place(captured, fault.element);
        let (key, axis) = match fault.axis {
            cycles::PlaneAxis::First => ("figure-not-monotone-z", "Z"),
            cycles::PlaneAxis::Second => ("figure-not-monotone-x", "X"),
        };
        if kind == RoughType::Two || self.checks_monotony(block) {
            return Err(self.finish(Diagnostic::alarm(key).at(place)));
        }
        if !self.already_said("figure-not-monotone-warning", place.line) {
            self.say(Diagnostic::warning("figure-not-monotone-warning").at(place).with("name", axis));
        }
        Ok(())
    }

    /// Arcs that must turn back, seen without the check: those of more than half a circle, and those that end where
    /// they began along the cut.
    fn refuse_round_arcs(&self, captured: &Captured, along: CutAlong) -> Result<(), Alarm> {
        let mut from = captured.figure.start;
        for (place, element) in captured.figure.elements.iter().enumerate() {
            if let cycles::FigureMotion::Arc { turn, centre } = element.motion {
                let sweep = sweep_rad(point(from), point(element.to), point(centre), turn == Turn::Clockwise);
                let returns = match along {
                    CutAlong::Z => from.z == element.to.z,
                    CutAlong::X => from.x == element.to.x,
                };
                if returns || sweep.abs() > std::f64::consts::PI + HALF_TURN_SLACK_RAD {
                    let key = match along {
                        CutAlong::Z => "figure-not-monotone-z",
                        CutAlong::X => "figure-not-monotone-x",
                    };
                    return Err(
                        self.finish(Diagnostic::alarm(key).at(self.element_place(captured, place as u32)))
                    );
                }
            }
            from = element.to;
        }
        Ok(())
    }

    fn warn_element(&mut self, key: &'static str, place: Place, near: Option<Place>) {
        if !self.already_said(key, place.line) {
            let diagnostic = Diagnostic::warning(key).at(place);
            self.say(match near {
                Some(near) => diagnostic.near(near, key),
                None => diagnostic,
            });
        }
    }

    /// Warns about allowances that lead into the part; true when it did.
    pub(crate) fn warn_allowance_signs(
        &mut self,
        call: &Call<'_>,
        figure: &cycles::Figure,
        along: Option<CutAlong>,
        (allowance_x, allowance_z): (Radius, Length),
    ) -> bool {
        let (x, z) = ways_into_work(figure, along);
        let mut warned = false;
        for (allowance, way, letter) in [(allowance_x.0, x, b'U'), (allowance_z, z, b'W')] {
            if allowance.signum() * way.signum() > 0
                && let Some(word) = call.block.word(letter)
            {
                self.warn("allowance-sign", word);
                warned = true;
            }
        }
        warned
    }

    /// What a machinist would not mean in pattern repeating: a relief that leads into the part, and an end from which
    /// the way to the next pass does. A control that asks for Z to run one way says so.
    pub(crate) fn check_pattern(
        &mut self,
        captured: &Captured,
        (relief_x, relief_z): (Radius, Length),
        call: &Call<'_>,
    ) {
        let figure = &captured.figure;
        let (x, z) = ways_into_work(figure, None);
        if relief_x.0.signum() * x.signum() > 0 || relief_z.signum() * z.signum() > 0 {
            self.warn_block("relief-sign");
        }
        let Some(last) = figure.elements.last() else { return };
        let tolerance = self.monotony_tolerance();
        if last.to != figure.start
            && let Some(hump) = cycles::hump_before_end(figure, CutAlong::Z, tolerance)
        {
            let place = self.element_place(captured, figure.elements.len() as u32 - 1);
            self.warn_element("figure-not-closed", place, Some(self.element_place(captured, hump)));
        }
        if self.control.policies.pattern_monotony == PatternMonotony::Required
            && let Some(fault) = cycles::turn_back_fault(figure, CutAlong::Z, tolerance)
        {
            let near = call.word.map(|word| self.place(word));
            self.warn_element("pattern-turns-back", self.element_place(captured, fault.element), near);
        }
    }

    /// The line of a figure's element; its bytes are not at hand any more, so the whole line is meant.
    fn element_place(&self, captured: &Captured, element: u32) -> Place {
        let line =
            captured.figure.elements.get(element as usize).map_or(self.at.line, |element| element.line);
        Place { source: self.at.source, line, line_offset: u64::MAX, column: 1, end_column: 1 }
    }
}
