//! What a program adds up to: its operations, how far it reaches, how long it takes.
//!
//! In: every command with its [`Timing`], in order of execution. Out: [`Operation`]s, [`Extents`], [`Totals`].
//!
//! An operation is what a machinist would call one: it begins where the tool number changes, where a move
//! belongs to another cycle than the move before, or where moves enter or leave cycles. Consecutive blocks of
//! the same modal cycle are one operation. Commands that do not move belong to the operation they stand in.
//!
//! Memory is bounded: operations past [`OPERATIONS_MAX`] are added to the last one.

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, CycleLabel, Origin, SectionPlace, Shape};
use turnwright_units::{Length, Position, Radius, WorkTip};

use crate::path::{length_from_mm, stretches};
use crate::{Kind, RpmRange, Timing, Totals};

/// Operations kept apart; later ones are added to the last.
pub const OPERATIONS_MAX: usize = 10_000;

/// How far moves reach, imaginary tool tip in the active work coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extents {
    /// Lowest X.
    pub x_min: Radius,
    /// Highest X.
    pub x_max: Radius,
    /// Lowest Z.
    pub z_min: Length,
    /// Highest Z.
    pub z_max: Length,
}

impl Extents {
    /// The extents of one place.
    fn of(x: Radius, z: Length) -> Self {
        Self { x_min: x, x_max: x, z_min: z, z_max: z }
    }

    /// The extents of both.
    fn with(self, other: Self) -> Self {
        Self {
            x_min: self.x_min.min(other.x_min),
            x_max: self.x_max.max(other.x_max),
            z_min: self.z_min.min(other.z_min),
            z_max: self.z_max.max(other.z_max),
        }
    }

    /// The extents of a move, with the points where an arc turns round (rounded to the nanometre).
    fn of_move(action: &Action, from: Position<WorkTip>, to: Position<WorkTip>) -> Self {
        let mut extents = Self::of(from.x, from.z).with(Self::of(to.x, to.z));
        if let Action::Feed { shape, .. } | Action::Thread { shape, .. } = action
            && *shape != Shape::Line
        {
            for arc in stretches(from, to, shape).filter_map(|stretch| stretch.arc) {
                for turn in arc.turning_points() {
                    extents = extents.with(Self::of(Radius(length_from_mm(turn.x)), length_from_mm(turn.z)));
                }
            }
        }
        extents
    }
}

/// Adds `new` to extents or speeds that may not have begun.
fn join<T: Copy>(known: &mut Option<T>, new: T, with: impl Fn(T, T) -> T) {
    *known = Some(known.map_or(new, |known| with(known, new)));
}

/// What kind of work an operation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperationKind {
    /// Nothing moves.
    Standing,
    /// Rapids only.
    Positioning,
    /// Cutting moves.
    Turning,
    /// Cutting moves on the spindle axis only.
    Drilling,
    /// Moves in step with the spindle.
    Threading,
}

/// A stretch of the program that a machinist would give one name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation {
    /// Turret station, when one has been called.
    pub tool: Option<u32>,
    /// Offset number: the first that is not 0.
    pub offset: u32,
    /// The cycle that made the moves.
    pub label: Option<CycleLabel>,
    /// What kind of work it is.
    pub kind: OperationKind,
    /// The program text that the lines count in.
    pub source: u32,
    /// Lowest line of `source` that took part; 0 when none did.
    pub first_line: u32,
    /// Highest line of `source` that took part.
    pub last_line: u32,
    /// Passes: those that a cycle numbered, else unbroken runs of cutting moves.
    pub passes: u32,
    /// Length of cutting and threading moves, mm.
    pub cutting_mm: f64,
    /// Length of rapids, mm.
    pub rapid_mm: f64,
    /// What its time is spent on.
    pub times: Totals,
}

impl Operation {
    fn new(tool: Option<u32>, offset: u32, label: Option<CycleLabel>, origin: &Origin) -> Self {
        Self {
            tool,
            offset,
            label,
            kind: OperationKind::Standing,
            source: origin.source,
            first_line: origin.line,
            last_line: origin.line,
            passes: 0,
            cutting_mm: 0.0,
            rapid_mm: 0.0,
            times: Totals::default(),
        }
    }

    fn add_line(&mut self, origin: &Origin) {
        if origin.source == self.source {
            self.first_line = self.first_line.min(origin.line);
            self.last_line = self.last_line.max(origin.line);
        }
    }
}

/// Adds up a program.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    operations: Vec<Operation>,
    merged_operations: u64,
    cutting: Option<Extents>,
    all: Option<Extents>,
    rpm: Option<RpmRange>,
    totals: Totals,
    tools: BTreeMap<Option<u32>, Totals>,
    tool: Option<u32>,
    offset: u32,
    /// Cycle of the last move.
    label: Option<CycleLabel>,
    /// The operation that runs has moved.
    moved: bool,
    /// Line and pass of the last numbered pass.
    pass: Option<(u32, u32)>,
    /// The last move was a cutting one.
    cutting_now: bool,
    section: SectionPlace,
    /// End of the last move in the section.
    at: Option<Position<WorkTip>>,
}

impl Summary {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The operations in order.
    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    /// Operations that were added to the last one because [`OPERATIONS_MAX`] was reached.
    pub const fn merged_operations(&self) -> u64 {
        self.merged_operations
    }

    /// How far cutting and threading moves reach, `None` when there are none.
    pub const fn cutting_extents(&self) -> Option<Extents> {
        self.cutting
    }

    /// How far all moves reach, `None` when there are none.
    pub const fn all_extents(&self) -> Option<Extents> {
        self.all
    }

    /// Spindle speeds of cutting and threading moves, `None` when the spindle never turned in one.
    pub const fn rpm(&self) -> Option<RpmRange> {
        self.rpm
    }

    /// Seconds and lengths by kind.
    pub const fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Seconds and lengths by tool, in the order of the turret; nothing is named before the first call when only
    /// rapids or cuts stand there.
    pub fn tools(&self) -> impl Iterator<Item = (Option<u32>, &Totals)> {
        self.tools.iter().map(|(tool, totals)| (*tool, totals))
    }

    /// Adds one command.
    pub fn add(&mut self, command: &Command, timing: &Timing) {
        self.totals.add(timing);
        let origin = &command.origin;
        if let Action::Tool { tool, offset } = command.action {
            self.call_tool(tool, offset, origin);
        }
        let end = self.section.end_of(&command.action);
        let label = origin.cycle.map(|cycle| cycle.label);
        let enters = end.is_some() && self.moved && self.label != label;
        if enters || self.operations.is_empty() {
            self.begin(label, origin);
        }
        let Some(operation) = self.operations.last_mut() else { return };
        operation.add_line(origin);
        operation.times.add(timing);
        self.tools.entry(operation.tool).or_default().add(timing);
        if let Some(to) = end {
            // The first move names an operation that has only stood so far.
            if operation.kind == OperationKind::Standing {
                operation.label = label;
            }
            (self.label, self.moved) = (label, true);
            self.add_move(command, timing, to);
        }
    }

    fn call_tool(&mut self, tool: u32, offset: u32, origin: &Origin) {
        self.offset = offset;
        if tool != 0 && self.tool != Some(tool) {
            self.tool = Some(tool);
            // What only stood before the first tool belongs to it.
            match self.operations.last_mut() {
                Some(last) if last.kind == OperationKind::Standing && last.tool.is_none() => {
                    (last.tool, last.offset) = (Some(tool), offset);
                    if let Some(before) = self.tools.remove(&None) {
                        self.tools.entry(Some(tool)).or_default().add_all(&before);
                    }
                }
                _ => self.begin(None, origin),
            }
        } else if let Some(last) = self.operations.last_mut()
            && last.offset == 0
        {
            last.offset = offset;
        }
    }

    fn begin(&mut self, label: Option<CycleLabel>, origin: &Origin) {
        (self.pass, self.cutting_now, self.moved) = (None, false, false);
        if self.operations.len() < OPERATIONS_MAX {
            self.operations.push(Operation::new(self.tool, self.offset, label, origin));
        } else {
            self.merged_operations += 1;
        }
    }

    fn add_move(&mut self, command: &Command, timing: &Timing, to: Position<WorkTip>) {
        let from = if self.section.is_polar() { self.at.unwrap_or(timing.from) } else { timing.from };
        self.at = Some(to);
        let extents = Extents::of_move(&command.action, from, to);
        join(&mut self.all, extents, Extents::with);
        let cuts = matches!(timing.kind, Kind::Cutting | Kind::Threading);
        if cuts {
            join(&mut self.cutting, extents, Extents::with);
            if let Some(rpm) = timing.rpm {
                join(&mut self.rpm, rpm, RpmRange::with);
            }
        }
        let Some(operation) = self.operations.last_mut() else { return };
        if cuts {
            operation.cutting_mm += timing.length_mm;
            let on_axis = extents.x_min == Radius::ZERO && extents.x_max == Radius::ZERO;
            operation.kind = kind_with(operation.kind, timing.kind, on_axis);
        } else {
            operation.rapid_mm += timing.length_mm;
            if operation.kind == OperationKind::Standing {
                operation.kind = OperationKind::Positioning;
            }
        }
        match command.origin.cycle {
            Some(cycle) => {
                let pass = (command.origin.line, cycle.pass);
                if cycle.pass > 0 && self.pass != Some(pass) {
                    self.pass = Some(pass);
                    operation.passes += 1;
                }
            }
            None if cuts && !self.cutting_now => operation.passes += 1,
            None => {}
        }
        self.cutting_now = cuts;
    }
}

/// The kind of an operation with one more cutting move.
const fn kind_with(kind: OperationKind, of_move: Kind, on_axis: bool) -> OperationKind {
    use OperationKind::{Drilling, Positioning, Standing, Threading, Turning};
    match (kind, of_move) {
        (Threading, _) | (_, Kind::Threading) => Threading,
        (Standing | Positioning | Drilling, _) if on_axis => Drilling,
        _ => Turning,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use turnwright_canon::{CycleOrigin, Phase, RapidPath, Turn};
    use turnwright_units::{Angle, Feed, FeedPerMinute, Lead};

    use super::*;
    use crate::{Clock, MachineRates};

    /// Diameter and Z in mm.
    fn at(diameter: i32, z: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_mm(diameter).half()), Length::from_mm(z))
    }

    fn rapid(diameter: i32, z: i32) -> Action {
        Action::Rapid { to: at(diameter, z), path: RapidPath::EachAxis, others: None }
    }

    fn feed(diameter: i32, z: i32) -> Action {
        let feed = Feed::PerMinute(FeedPerMinute(Length::from_mm(100)));
        Action::Feed { to: at(diameter, z), shape: Shape::Line, feed, others: None }
    }

    /// Line, cycle label and pass (0: no cycle), action.
    fn summed(program: &[(u32, u16, u32, Action)]) -> Summary {
        let mut clock = Clock::new(at(100, 100), MachineRates::default());
        let mut summary = Summary::new();
        for (line, label, pass, action) in program {
            let mut origin = Origin::line(*line);
            if *label > 0 {
                origin.cycle =
                    Some(CycleOrigin { label: CycleLabel(*label), pass: *pass, phase: Phase::Cut });
            }
            let command = Command::new(action.clone(), origin);
            let timing = clock.advance(&command);
            summary.add(&command, &timing);
        }
        assert_eq!(summary.totals(), clock.totals());
        summary
    }

    #[test]
    fn tools_and_cycles_part_a_program_into_operations() {
        let thread = Action::Thread {
            to: at(20, -20),
            lead: Lead(Length::from_mm(1)),
            lead_end: None,
            start_angle: Angle::ZERO,
            shape: Shape::Line,
            is_chained: false,
        };
        let summary = summed(&[
            (1, 0, 0, Action::Coolant(turnwright_canon::Coolant::On)),
            (2, 0, 0, Action::Tool { tool: 1, offset: 0 }),
            (3, 0, 0, Action::Tool { tool: 1, offset: 11 }),
            (4, 0, 0, rapid(50, 2)),
            // Two blocks of one modal cycle, three passes.
            (5, 900, 1, feed(46, -30)),
            (5, 900, 1, rapid(50, 2)),
            (6, 900, 1, feed(42, -30)),
            (6, 900, 2, feed(40, -30)),
            // Out of the cycle: two cuts in one run, then another run.
            (7, 0, 0, feed(40, -32)),
            (8, 0, 0, feed(44, -32)),
            (9, 0, 0, rapid(44, 2)),
            (10, 0, 0, feed(30, 2)),
            (11, 0, 0, Action::Tool { tool: 1, offset: 0 }),
            (12, 0, 0, Action::Tool { tool: 2, offset: 2 }),
            (13, 760, 1, thread),
            (14, 0, 0, Action::Tool { tool: 3, offset: 3 }),
            (15, 0, 0, rapid(0, 2)),
            (16, 0, 0, feed(0, -10)),
        ]);
        let seen: Vec<_> = summary
            .operations()
            .iter()
            .map(|o| (o.tool, o.offset, o.label.map(|l| l.0), o.kind, (o.first_line, o.last_line), o.passes))
            .collect();
        assert_eq!(
            seen,
            [
                (Some(1), 11, None, OperationKind::Positioning, (1, 4), 0),
                (Some(1), 11, Some(900), OperationKind::Turning, (5, 6), 3),
                (Some(1), 11, None, OperationKind::Turning, (7, 11), 2),
                (Some(2), 2, Some(760), OperationKind::Threading, (12, 13), 1),
                (Some(3), 3, None, OperationKind::Drilling, (14, 16), 1),
            ]
        );
        let total = summary.totals().total();
        assert_eq!(
            summary.operations().iter().map(|operation| operation.times.total()).sum::<Duration>(),
            total
        );
        assert_eq!(summary.tools().map(|(_, times)| times.total()).sum::<Duration>(), total);
        // What stood before the first call is the first tool's.
        let tools: Vec<_> = summary.tools().map(|(tool, _)| tool).collect();
        assert_eq!(tools, [Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn extents_hold_the_belly_of_an_arc() {
        // Half a circle of radius 5 about d20 z0, from z5 to z-5 over the top: it reaches d30.
        let arc = Action::Feed {
            to: at(20, -5),
            shape: Shape::Arc { turn: Turn::CounterClockwise, centre: at(20, 0) },
            feed: Feed::PerMinute(FeedPerMinute(Length::from_mm(100))),
            others: None,
        };
        let summary = summed(&[(1, 0, 0, rapid(20, 5)), (2, 0, 0, arc)]);
        let mm = |mm: i32| Length::from_mm(mm);
        let belly = Extents { x_min: Radius(mm(10)), x_max: Radius(mm(15)), z_min: mm(-5), z_max: mm(5) };
        assert_eq!(summary.cutting_extents(), Some(belly));
        let all = Extents { x_max: Radius(mm(50)), z_max: mm(100), ..belly };
        assert_eq!(summary.all_extents(), Some(all));
    }

    #[test]
    fn extents_hold_the_belly_of_a_tilted_ellipse() {
        // Half axes 20 and 10, the longer one at 30 degrees, from one end of it to the other: the highest place is
        // √(20²·sin² 30 + 10²·cos² 30) = √175 above the centre.
        let (along_z, along_x) = (17.320_508_f64, 10.0);
        let mm = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
        let place = |x: f64, z: f64| Position::new(Radius(mm(x)), mm(z));
        let shape = Shape::Curve(Box::new(turnwright_canon::Curve::Ellipse {
            turn: Turn::CounterClockwise,
            centre: place(50.0, 0.0),
            half_along: mm(20.0),
            half_across: mm(10.0),
            tilt: turnwright_units::Angle::from_millidegrees(30_000),
        }));
        let feed = Feed::PerMinute(FeedPerMinute(Length::from_mm(100)));
        let cut = Action::Feed { to: place(50.0 - along_x, -along_z), shape, feed, others: None };
        let rapid = Action::Rapid {
            to: place(50.0 + along_x, along_z),
            path: turnwright_canon::RapidPath::Straight,
            others: None,
        };
        let summary = summed(&[(1, 0, 0, rapid), (2, 0, 0, cut)]);
        let highest = summary.cutting_extents().expect("a cut").x_max.to_mm();
        assert!((highest - 50.0 - 175.0f64.sqrt()).abs() < 2e-5, "{highest}");
    }

    #[test]
    fn operations_are_bounded_and_none_is_lost() {
        let extra = 25;
        let program: Vec<_> = (0..OPERATIONS_MAX as u32 + extra)
            .map(|index| (index + 1, 700 + (index % 2) as u16 * 10, 1, feed(10 + (index % 2) as i32, 0)))
            .collect();
        let summary = summed(&program);
        assert_eq!(summary.operations().len(), OPERATIONS_MAX);
        assert_eq!(summary.merged_operations(), u64::from(extra));
        let length: f64 = summary.operations().iter().map(|operation| operation.cutting_mm).sum();
        assert!((length - summary.totals().length_mm(Kind::Cutting)).abs() < 1e-9);
    }

    #[test]
    fn a_program_without_moves_has_no_extents() {
        let summary = summed(&[(1, 0, 0, Action::Stop), (2, 0, 0, Action::End)]);
        assert_eq!((summary.all_extents(), summary.cutting_extents(), summary.rpm()), (None, None, None));
        assert_eq!(summary.operations()[0].kind, OperationKind::Standing);
    }
}
