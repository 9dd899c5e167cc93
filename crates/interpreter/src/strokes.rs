//! Stored stroke checks: areas of the machine that the tool may not leave or enter.
//!
//! Check 1 keeps every axis between its limits. Checks 2 and 3 forbid the inside of an area (2 also the outside,
//! by parameter). Limits are machine coordinates; a place exactly on a limit is allowed. Lines are checked along
//! their whole way, rapid moves on the bent way of axes that each go at their own rate, arcs by their true extent.
//! The alarm comes in place of the move that would break the rule.
//!
//! Axes beyond X and Z have limits of their own. In the areas of checks 2 and 3 they count as inside when they come
//! inside at any time of the move.
//!
//! An area none of whose limits was ever set (all at ±99999) forbids nothing. A path that dips into an area by
//! less than [`TOUCH_MM`] only touches it.
//!
//! Deliberately not here: how far an arc across the turning plane bulges in Y between its ends, the second set of limits that a signal of the machine selects (1326, 1327), the release
//! signal of check 3, and how far the machine runs on before it stands.
//!
//! Source: stored stroke checks 1 to 3, both families.

use turnwright_canon::{Action, Shape, Turn};
use turnwright_control::{Axis, MachineAxes, Parameters};
use turnwright_diagnostics::{Diagnostic, Place};
use turnwright_geometry::{Point, sweep_rad};
use turnwright_syntax::{Block, scan_block};
use turnwright_units::{Diameter, Length, MachineTurret, Position, Radius, WorkTip};

use crate::axes::Places;
use crate::machine::Core;
use crate::report::Alarm;

/// A path that is this little inside an area only touches it, mm: rounding of computed points on arcs.
const TOUCH_MM: f64 = 1e-6;

/// Limits at and beyond this are none, mm.
const NO_LIMIT_MM: f64 = 99_999.0;

/// Limits of the axes: the smallest and the largest machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) minus: Position<MachineTurret>,
    pub(crate) plus: Position<MachineTurret>,
    /// Of the axes beyond X and Z.
    pub(crate) others_minus: Places,
    pub(crate) others_plus: Places,
}

impl Area {
    /// The area that two parameters with a value for each axis give.
    fn new(parameters: &Parameters, machine: &MachineAxes, plus: &str, minus: &str) -> Self {
        let mm = |name: &str, axis| Length::from_nm((parameters.axis_value(name, axis) * 1e6).round() as i64);
        let corner = |name: &str| Position::new(Diameter(mm(name, Axis::X)).to_radius(), mm(name, Axis::Z));
        let others = |name: &str, none: f64| {
            let mut places = Places::default();
            for axis in Axis::OTHERS {
                // An axis whose coordinate begins anew after a turn has no limits.
                let rolls_over = axis == Axis::C && machine.c.as_ref().is_some_and(|axis| axis.rolls_over);
                let is_there = machine.number(axis).is_some() && !rolls_over;
                let far = Length::from_nm((none * 1e6) as i64);
                places.put(axis, if is_there { mm(name, axis) } else { far });
            }
            places
        };
        Self {
            minus: corner(minus),
            plus: corner(plus),
            others_minus: others(minus, -NO_LIMIT_MM),
            others_plus: others(plus, NO_LIMIT_MM),
        }
    }

    /// None of its limits was ever set.
    fn is_unset(&self) -> bool {
        let is_far = |length: Length| length.to_mm().abs() >= NO_LIMIT_MM;
        is_far(self.minus.x.to_diameter().0)
            && is_far(self.plus.x.to_diameter().0)
            && is_far(self.minus.z)
            && is_far(self.plus.z)
            && Axis::OTHERS.iter().all(|axis| !self.is_limited(*axis))
    }

    /// Whether an axis beyond X and Z has limits.
    fn is_limited(&self, axis: Axis) -> bool {
        let is_far = |length: Length| length.to_mm().abs() >= NO_LIMIT_MM;
        !(is_far(self.others_minus.value(axis)) && is_far(self.others_plus.value(axis)))
    }

    /// How the axes beyond X and Z leave the area at the end of a move. They come there on the straight way.
    fn left_by_others(&self, axes: [bool; 5], there: Places) -> Option<Breach> {
        let is_left = |axis: &Axis| {
            let place = there.value(*axis);
            let is_plus = place > self.others_plus.value(*axis);
            (is_plus || place < self.others_minus.value(*axis)).then_some(Breach { axis: *axis, is_plus })
        };
        let looked_at = |axis: &&Axis| axes[**axis as usize] && self.is_limited(**axis);
        Axis::OTHERS.iter().filter(looked_at).find_map(is_left)
    }

    /// How a move enters the inside: the axes beyond X and Z that are looked at come inside on their way `from` to
    /// `to`, and X and Z are there.
    fn entered(&self, stretch: Stretch, axes: [bool; 5], from: Places, to: Places) -> Option<Breach> {
        let looked_at = |axis: &&Axis| axes[**axis as usize] && self.is_limited(**axis);
        let mut others = Axis::OTHERS.iter().filter(looked_at);
        let comes_inside = |axis: &Axis| {
            let (a, b) = (from.value(*axis), to.value(*axis));
            a.max(b) > self.others_minus.value(*axis) && a.min(b) < self.others_plus.value(*axis)
        };
        if !others.clone().all(comes_inside) {
            return None;
        }
        let breach = stretch.enters(self, axes)?;
        let moving = others.find(|axis| from.value(**axis) != to.value(**axis));
        Some(match moving.filter(|_| stretch.from == stretch.to) {
            Some(axis) => Breach { axis: *axis, is_plus: to.value(*axis) > from.value(*axis) },
            None => breach,
        })
    }

    /// The limit of an axis on the side that a way towards plus meets first or last.
    fn limit(&self, axis: Axis, is_plus: bool) -> Length {
        let corner = if is_plus { self.plus } else { self.minus };
        match axis {
            Axis::X => corner.x.to_diameter().0,
            Axis::Z => corner.z,
            axis => if is_plus { self.others_plus } else { self.others_minus }.value(axis),
        }
    }
}

/// The stroke checks of a control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strokes {
    outer: Area,
    pub(crate) second: Area,
    /// Axes that check 2 looks at, in the order of [`Axis::ALL`].
    second_axes: [bool; 5],
    second_forbids_outside: bool,
    third: Area,
    third_axes: [bool; 5],
    /// Check 1 waits for the reference return; the others always do.
    outer_needs_reference: bool,
    before_move: bool,
    /// Switched off by parameter.
    pub(crate) is_off: bool,
}

/// Where a path breaks a rule: the axis, and whether it moves towards plus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Breach {
    axis: Axis,
    is_plus: bool,
}

/// A stretch of path in machine coordinates.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: Position<MachineTurret>,
    to: Position<MachineTurret>,
    arc: Option<(Turn, Position<MachineTurret>)>,
}

fn point(place: Position<MachineTurret>) -> Point {
    Point::new(place.x.to_mm(), place.z.to_mm())
}

impl Strokes {
    pub(crate) fn new(parameters: &Parameters, machine: &MachineAxes) -> Self {
        let axes = |name: &str| Axis::ALL.map(|axis| parameters.axis_value(name, axis) != 0.0);
        let area = |plus, minus| Area::new(parameters, machine, plus, minus);
        Self {
            outer: area("stroke-plus", "stroke-minus"),
            second: area("stroke-two-plus", "stroke-two-minus"),
            second_axes: axes("stroke-two-of-axis"),
            second_forbids_outside: parameters.bit("stroke-two-forbids-outside"),
            third: area("stroke-three-plus", "stroke-three-minus"),
            third_axes: axes("stroke-three-of-axis"),
            outer_needs_reference: parameters.bit("stroke-one-after-reference"),
            before_move: parameters.bit("stroke-check-before-move"),
            is_off: parameters.bit("stroke-check-off"),
        }
    }

    /// Whether any check can speak at all.
    pub(crate) fn is_armed(&self, second_is_on: bool) -> bool {
        let looks = |area: &Area, axes: [bool; 5]| !area.is_unset() && axes.contains(&true);
        !self.is_off
            && (!self.outer.is_unset()
                || (second_is_on && looks(&self.second, self.second_axes))
                || looks(&self.third, self.third_axes))
    }
}

impl Stretch {
    /// Centre, radius and sweep of an arc.
    fn circle(&self) -> Option<(Point, f64, f64)> {
        let (turn, centre) = self.arc?;
        let centre = point(centre);
        let sweep = sweep_rad(point(self.from), point(self.to), centre, turn == Turn::Clockwise);
        Some((centre, centre.distance(point(self.from)), sweep))
    }

    /// The place after a part of the way.
    fn at(&self, part: f64) -> Point {
        let (from, to) = (point(self.from), point(self.to));
        match self.circle() {
            None => Point::new(from.x + (to.x - from.x) * part, from.z + (to.z - from.z) * part),
            Some((centre, radius, sweep)) => {
                let angle = libm::atan2(from.x - centre.x, from.z - centre.z) + sweep * part;
                Point::new(centre.x + radius * libm::sin(angle), centre.z + radius * libm::cos(angle))
            }
        }
    }

    /// Parts of the way at which an axis passes a place.
    fn passes(&self, axis: Axis, place_mm: f64, found: &mut Vec<f64>) {
        let of = |point: Point| if axis == Axis::X { point.x } else { point.z };
        let (from, to) = (point(self.from), point(self.to));
        let mut keep = |part: f64| {
            if part > 0.0 && part < 1.0 {
                found.push(part);
            }
        };
        match self.circle() {
            None => keep((place_mm - of(from)) / (of(to) - of(from))),
            Some((centre, radius, sweep)) => {
                let rise = (place_mm - of(centre)) / radius;
                if rise.abs() > 1.0 {
                    return;
                }
                let start = libm::atan2(from.x - centre.x, from.z - centre.z);
                let angles = if axis == Axis::X {
                    [libm::asin(rise), std::f64::consts::PI - libm::asin(rise)]
                } else {
                    [libm::acos(rise), -libm::acos(rise)]
                };
                for angle in angles {
                    let way = (angle - start) * sweep.signum();
                    keep(way.rem_euclid(std::f64::consts::TAU) / sweep.abs());
                }
            }
        }
    }

    /// The largest way of an axis beyond the limits of an area that it must stay in.
    fn leaves(&self, area: &Area) -> Option<Breach> {
        let (mut low, mut high) = ([self.to.x.0, self.to.z], [self.to.x.0, self.to.z]);
        if let Some((centre, radius, _)) = self.circle() {
            // The arc goes furthest where it passes the centre's height, if it does.
            for (place, axis, across) in [(0, Axis::X, Axis::Z), (1, Axis::Z, Axis::X)] {
                let of = |point: Point| if across == Axis::X { point.x } else { point.z };
                let mut parts = Vec::new();
                self.passes(across, of(centre), &mut parts);
                for part in parts {
                    let there = self.at(part);
                    let (mm, centre_mm) =
                        if axis == Axis::X { (there.x, centre.x) } else { (there.z, centre.z) };
                    let reach =
                        centre_mm + if mm > centre_mm { radius - TOUCH_MM } else { TOUCH_MM - radius };
                    let reach = Length::from_nm((reach * 1e6).round() as i64);
                    low[place] = low[place].min(reach);
                    high[place] = high[place].max(reach);
                }
            }
        }
        let rows = [(Axis::X, 0, area.minus.x.0, area.plus.x.0), (Axis::Z, 1, area.minus.z, area.plus.z)];
        rows.into_iter().find_map(|(axis, place, minus, plus)| {
            if high[place] > plus {
                Some(Breach { axis, is_plus: true })
            } else if low[place] < minus {
                Some(Breach { axis, is_plus: false })
            } else {
                None
            }
        })
    }

    /// How the way enters the inside of an area; an axis that is not looked at is always inside.
    fn enters(&self, area: &Area, axes: [bool; 5]) -> Option<Breach> {
        let rows = [
            (Axis::X, axes[0], area.minus.x.to_mm(), area.plus.x.to_mm()),
            (Axis::Z, axes[1], area.minus.z.to_mm(), area.plus.z.to_mm()),
        ];
        let is_inside = |there: Point| {
            rows.iter().all(|(axis, is_looked_at, minus, plus)| {
                let place = if *axis == Axis::X { there.x } else { there.z };
                !is_looked_at || (place > minus + TOUCH_MM && place < plus - TOUCH_MM)
            })
        };
        let mut parts = vec![0.0, 1.0];
        for (axis, is_looked_at, minus, plus) in rows {
            if is_looked_at {
                self.passes(axis, minus, &mut parts);
                self.passes(axis, plus, &mut parts);
            }
        }
        parts.sort_by(f64::total_cmp);
        // Between two passes the path is inside or outside as a whole.
        let entered = parts.windows(2).find(|pair| is_inside(self.at(f64::midpoint(pair[0], pair[1]))))?;
        let (gate, inside) = (self.at(entered[0]), self.at(f64::midpoint(entered[0], entered[1])));
        // The axis whose limit the gate lies on; inside from the start, the one that moves more.
        let on_limit = rows.iter().find(|(axis, is_looked_at, minus, plus)| {
            let place = if *axis == Axis::X { gate.x } else { gate.z };
            *is_looked_at
                && ((place - minus).abs() <= TOUCH_MM * 10.0 || (place - plus).abs() <= TOUCH_MM * 10.0)
        });
        let (dx, dz) = (inside.x - gate.x, inside.z - gate.z);
        let axis = on_limit.map_or(if dx.abs() > dz.abs() { Axis::X } else { Axis::Z }, |row| row.0);
        Some(Breach { axis, is_plus: if axis == Axis::X { dx > 0.0 } else { dz > 0.0 } })
    }
}

impl Core {
    /// Checks a move in work coordinates, from where the tool is.
    pub(crate) fn check_strokes(&self, from: Position<WorkTip>, action: &Action) -> Result<(), Alarm> {
        let Some(to) = action.end_point() else { return Ok(()) };
        let zero = self.tip_zero();
        let machine =
            |place: Position<WorkTip>| Position::<MachineTurret>::new(place.x + zero.x, place.z + zero.z);
        if self.axes.is_virtual() {
            // The end in the section. In polar interpolation X is never farther out between the ends; where it comes
            // nearer to the axis on the way is not looked at.
            let (real, _) = self.axes.interpolation.axes_at(to, self.axes.v, &Shape::Line, self.axes.at.c);
            let end = machine(real);
            return self.check_stretch(
                Stretch { from: end, to: end, arc: None },
                end,
                self.others_way(action),
            );
        }
        let others = self.others_way(action);
        let (from, to) = (machine(from), machine(to));
        let whole = Stretch { from, to, arc: None };
        match action {
            Action::Rapid { path, .. } if !path.is_straight() => {
                let bend = self.bend(from, to);
                self.check_stretch(Stretch { from, to: bend, arc: None }, to, others)?;
                self.check_stretch(Stretch { from: bend, to, arc: None }, to, others)
            }
            Action::Feed { shape: Shape::Arc { turn, centre }, .. } => {
                self.check_stretch(Stretch { arc: Some((*turn, machine(*centre))), ..whole }, to, others)
            }
            _ => self.check_stretch(whole, to, others),
        }
    }

    /// Where the axes beyond X and Z come from and where a move ends for them, in machine coordinates.
    fn others_way(&self, action: &Action) -> [Places; 2] {
        let (axes, mut to) = (&self.axes, self.axes.at);
        let from = match action.others() {
            None => to,
            Some(ends) => {
                to = Places {
                    c: ends.c.unwrap_or(to.c),
                    y: ends.y.unwrap_or(to.y),
                    b: ends.b.unwrap_or(to.b),
                };
                axes.came_from
            }
        };
        [from.plus(axes.preset), to.plus(axes.preset)]
    }

    /// Where the shorter way of a rapid move on which each axis goes at its own rate ends.
    fn bend(&self, from: Position<MachineTurret>, to: Position<MachineTurret>) -> Position<MachineTurret> {
        let (x, z) = ((to.x - from.x).to_mm(), (to.z - from.z).to_mm());
        let [rate_x, rate_z] = self.rapid_rates_mm_per_min;
        let (minutes_x, minutes_z) = (x.abs() / rate_x, z.abs() / rate_z);
        let nm = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
        if minutes_x < minutes_z {
            Position::new(to.x, from.z + nm(z * minutes_x / minutes_z))
        } else if minutes_z < minutes_x {
            Position::new(from.x + Radius(nm(x * minutes_z / minutes_x)), to.z)
        } else {
            to
        }
    }

    fn check_stretch(
        &self,
        stretch: Stretch,
        end: Position<MachineTurret>,
        [others_from, others_to]: [Places; 2],
    ) -> Result<(), Alarm> {
        let strokes = &self.strokes;
        let left_by_others = |area: &Area, axes| area.left_by_others(axes, others_to);
        if !strokes.outer.is_unset() && (self.homing.is_made || !strokes.outer_needs_reference) {
            let end = Stretch { from: end, to: end, arc: None };
            if strokes.before_move
                && let Some(breach) =
                    end.leaves(&strokes.outer).or_else(|| left_by_others(&strokes.outer, [true; 5]))
            {
                let key = if breach.is_plus { "stroke-before-move-plus" } else { "stroke-before-move-minus" };
                return Err(self.stroke_alarm(key, breach, &strokes.outer, true));
            }
            let breach = stretch.leaves(&strokes.outer);
            if let Some(breach) = breach.or_else(|| left_by_others(&strokes.outer, [true; 5])) {
                let key = if breach.is_plus { "stroke-one-plus" } else { "stroke-one-minus" };
                return Err(self.stroke_alarm(key, breach, &strokes.outer, true));
            }
        }
        if !self.homing.is_made {
            return Ok(());
        }
        if self.modal.stroke_two_is_on && !strokes.second.is_unset() && strokes.second_axes.contains(&true) {
            let breach = if strokes.second_forbids_outside {
                let mut area = strokes.second;
                let far = Length::from_nm(i64::MAX / 4);
                if !strokes.second_axes[0] {
                    (area.minus.x, area.plus.x) = (Radius(-far), Radius(far));
                }
                if !strokes.second_axes[1] {
                    (area.minus.z, area.plus.z) = (-far, far);
                }
                stretch.leaves(&area).or_else(|| left_by_others(&area, strokes.second_axes))
            } else {
                strokes.second.entered(stretch, strokes.second_axes, others_from, others_to)
            };
            if let Some(breach) = breach {
                let key = if breach.is_plus { "stroke-two-plus-reached" } else { "stroke-two-minus-reached" };
                return Err(self.stroke_alarm(key, breach, &strokes.second, strokes.second_forbids_outside));
            }
        }
        if !strokes.third.is_unset()
            && strokes.third_axes.contains(&true)
            && let Some(breach) = strokes.third.entered(stretch, strokes.third_axes, others_from, others_to)
        {
            let key = if breach.is_plus { "stroke-three-plus-reached" } else { "stroke-three-minus-reached" };
            return Err(self.stroke_alarm(key, breach, &strokes.third, false));
        }
        Ok(())
    }

    /// `leaves`: the limit that is passed lies on the side to which the axis moves, else on the other.
    fn stroke_alarm(&self, key: &'static str, breach: Breach, area: &Area, leaves: bool) -> Alarm {
        let limit = area.limit(breach.axis, breach.is_plus == leaves);
        let place = self.place_of_axis(breach.axis).unwrap_or_else(|| self.block_place());
        let diagnostic = Diagnostic::alarm(key).at(place).with("axis", breach.axis.letter());
        self.finish(diagnostic.with("limit", limit))
    }

    /// The word of the block in work that sends an axis somewhere; `None` for a move of an earlier line, which is no
    /// longer at hand.
    fn place_of_axis(&self, axis: Axis) -> Option<Place> {
        let line = match self.cache.current {
            Some(id) => (self.cache.place(id).source, self.cache.place(id).line_offset),
            None => (self.text.source(), self.line.offset),
        };
        if line != (self.at.source, self.at.line_offset) {
            return None;
        }
        let letters = match axis {
            Axis::X => [b'X', b'U'],
            Axis::Z => [b'Z', b'W'],
            Axis::C => [b'C', b'H'],
            Axis::Y => [b'Y', b'V'],
            Axis::B => [b'B', b'B'],
        };
        let mut block = Block::new();
        scan_block(self.line_bytes(), self.at.first_byte as usize, &mut block);
        let word = block.words.iter().rfind(|word| !word.comma && letters.contains(&word.address))?;
        Some(self.place(word))
    }
}
