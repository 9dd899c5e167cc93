//! Giving out commands: moves, and the moves of cycles one by one.

use turnwright_canon::{Action, Command, Curve, CycleLabel, CycleOrigin, Origin, RapidPath, Shape, Turn};
use turnwright_cycles::{
    BoxCycle, CycleMove, Element, FigureMotion, Groove, Hole, Pattern, PocketRoughing, Roughing,
    SemiFinished, ThreadOnce, Threading,
};
use turnwright_diagnostics::Diagnostic;
use turnwright_units::{Feed, FeedPerMinute, FeedPerRevolution, Position, WorkTip};

use crate::flow::FrameKind;
use crate::limits;
use crate::machine::{BlockPlace, Core};
use crate::modal::FeedMode;
use crate::plane::place;
use crate::report::Alarm;

/// A cycle whose moves are given out one by one.
#[derive(Debug)]
pub(crate) struct ActiveCycle {
    pub(crate) moves: CycleMoves,
    pub(crate) code: u16,
    /// The block that runs the cycle.
    pub(crate) at: BlockPlace,
    /// Lines of the figure's elements.
    pub(crate) lines: Vec<u32>,
    /// Passes of the same modal cycle made before.
    pub(crate) passes_before: u32,
    pub(crate) moves_made: u64,
}

/// The cycles that give moves.
#[derive(Debug)]
pub(crate) enum CycleMoves {
    Roughing(Box<Roughing>),
    Pockets(Box<PocketRoughing>),
    SemiFinished(Box<SemiFinished<Roughing>>),
    SemiFinishedPockets(Box<SemiFinished<PocketRoughing>>),
    Pattern(Box<Pattern>),
    Groove(Box<Groove>),
    Hole(Box<Hole>),
    Threading(Box<Threading>),
    Box(Box<BoxCycle>),
    ThreadOnce(Box<ThreadOnce>),
}

impl CycleMoves {
    fn next(&mut self) -> Option<CycleMove> {
        match self {
            Self::Roughing(cycle) => cycle.next(),
            Self::Pockets(cycle) => cycle.next(),
            Self::SemiFinished(cycle) => cycle.next(),
            Self::SemiFinishedPockets(cycle) => cycle.next(),
            Self::Pattern(cycle) => cycle.next(),
            Self::Groove(cycle) => cycle.next(),
            Self::Hole(cycle) => cycle.next(),
            Self::Threading(cycle) => cycle.next(),
            Self::Box(cycle) => cycle.next(),
            Self::ThreadOnce(cycle) => cycle.next(),
        }
    }

    fn estimate(&self) -> u64 {
        match self {
            Self::Roughing(cycle) => cycle.move_estimate(),
            Self::Pockets(cycle) => cycle.move_estimate(),
            Self::SemiFinished(cycle) => cycle.move_estimate(),
            Self::SemiFinishedPockets(cycle) => cycle.move_estimate(),
            Self::Pattern(cycle) => cycle.move_estimate(),
            Self::Groove(cycle) => cycle.move_estimate(),
            Self::Hole(cycle) => cycle.move_estimate(),
            Self::Threading(cycle) => cycle.move_estimate(),
            Self::Box(cycle) => cycle.move_estimate(),
            Self::ThreadOnce(cycle) => cycle.move_estimate(),
        }
    }
}

/// A move that goes somewhere although X and Z end where they were: an arc, or one of another axis.
fn is_move_of_its_own(action: &Action) -> bool {
    match action {
        Action::Rapid { others, .. } | Action::Feed { shape: Shape::Line, others, .. } => others.is_some(),
        Action::Feed { .. } => true,
        _ => false,
    }
}

impl Core {
    pub(crate) fn is_capturing(&self) -> bool {
        self.capture.is_some()
    }

    /// How rapid moves share their way.
    pub(crate) fn rapid_path(&self) -> RapidPath {
        if self.settings.linear_rapid { RapidPath::Straight } else { RapidPath::EachAxis }
    }

    /// The feed in force, `None` when there is none or it is zero.
    #[inline]
    pub(crate) fn feed_in_force(&self) -> Option<Feed> {
        let length = self.modal.feed.filter(|feed| !feed.is_zero())?;
        Some(match self.modal.feed_mode {
            FeedMode::PerMinute => Feed::PerMinute(FeedPerMinute(length)),
            FeedMode::PerRevolution => Feed::PerRevolution(FeedPerRevolution(length)),
        })
    }

    /// Where commands of the block in work come from.
    #[inline]
    pub(crate) fn origin(&self) -> Origin {
        let finishing = self.in_cycle.is_some();
        if finishing
            && let Some(frame) = self.frames.last()
            && let FrameKind::Finish { at, .. } = &frame.kind
        {
            return Origin {
                source: at.source.0,
                line: at.line,
                figure_line: Some(self.at.line),
                sequence: at.sequence,
                program: self.program,
                depth: self.depth(),
                cycle: self.in_cycle,
            };
        }
        Origin {
            source: self.at.source.0,
            line: self.at.line,
            figure_line: None,
            sequence: self.at.sequence,
            program: self.program,
            depth: self.depth(),
            cycle: None,
        }
    }

    /// Gives out a command that is no move.
    pub(crate) fn emit(&mut self, action: Action) {
        if !self.is_capturing() {
            let origin = self.origin();
            match &mut self.corner {
                None => self.pass_on(Command::new(action, origin)),
                Some(path) => path.hold(Command::new(action, origin)),
            }
        }
    }

    /// Gives out a move of the block in work and takes its end as the tool's place.
    #[inline]
    pub(crate) fn emit_move(&mut self, to: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        if self.capture.is_some() {
            return self.capture_any(to, action);
        }
        if self.untaken.is_some() {
            return self.emit_move_short(to, action);
        }
        let goes = to != self.tip || is_move_of_its_own(&action);
        let from = std::mem::replace(&mut self.tip, to);
        if goes {
            if self.looks_at_moves {
                return self.emit_looked_at(from, action);
            }
            let origin = self.origin();
            self.out.push_back(Command::new(action, origin));
        }
        Ok(())
    }

    #[cold]
    fn emit_looked_at(&mut self, from: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        if self.compensation.is_some() {
            self.compensate(from, action)
        } else {
            self.give(from, action, self.origin(), None)
        }
    }

    /// A move of the figure, shifted by nose compensation where that acts in roughing.
    fn capture_any(&mut self, to: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        if self.compensation.is_none() {
            return self.capture_move(to, &action);
        }
        let goes = to != self.tip || is_move_of_its_own(&action);
        let from = std::mem::replace(&mut self.tip, to);
        if goes { self.compensate(from, action) } else { Ok(()) }
    }

    pub(crate) fn capture_move(&mut self, to: Position<WorkTip>, action: &Action) -> Result<(), Alarm> {
        let motion = match action {
            Action::Rapid { .. } => FigureMotion::Rapid,
            Action::Feed { shape: Shape::Line, .. } => FigureMotion::Line,
            Action::Feed { shape: Shape::Arc { turn, centre }, .. } => {
                FigureMotion::Arc { turn: *turn, centre: *centre }
            }
            Action::Feed { shape: Shape::Curve(curve), .. } => return self.capture_curve(to, curve),
            _ => return Err(self.alarm_block("figure-code-illegal")),
        };
        self.capture_element(to, motion)
    }

    fn capture_element(&mut self, to: Position<WorkTip>, motion: FigureMotion) -> Result<(), Alarm> {
        let line = self.at.line;
        let limit = self.control.limits.figure_blocks_max as usize;
        if let Some(capture) = &mut self.capture {
            if capture.elements.len() - capture.curve_pieces >= limit {
                let diagnostic = Diagnostic::alarm("figure-too-many-blocks").at(self.block_place());
                return Err(self.finish(diagnostic.with("limit", limit as i64)));
            }
            capture.elements.push(Element { to, motion, line });
        }
        self.tip = to;
        Ok(())
    }

    /// Cycles rough an ellipse or a parabola as arcs near it; finishing cuts the curve itself.
    #[cold]
    fn capture_curve(&mut self, to: Position<WorkTip>, curve: &Curve) -> Result<(), Alarm> {
        let increment = self.modal.increment(&self.settings);
        // Well below what rounding to the increment leaves anyway.
        for arc in curve.path(self.tip, to).arcs(increment.to_mm() / 10.0) {
            let end = place(arc.end).map_or(to, |end| {
                Position::new(end.x.to_diameter().rounded(increment).to_radius(), end.z.rounded(increment))
            });
            let centre = arc.bend.and_then(|bend| Some((place(bend.centre)?, bend.clockwise)));
            if end == self.tip {
                continue;
            }
            self.capture_element(
                end,
                centre.map_or(FigureMotion::Line, |(centre, clockwise)| FigureMotion::Arc {
                    turn: Turn::clockwise_if(clockwise),
                    centre,
                }),
            )?;
            if let Some(capture) = &mut self.capture {
                capture.curve_pieces += 1;
            }
        }
        if let Some(capture) = &mut self.capture {
            // The block itself counts.
            capture.curve_pieces = capture.curve_pieces.saturating_sub(1);
        }
        Ok(())
    }

    /// Starts to give out the moves of a cycle.
    pub(crate) fn start_cycle(
        &mut self,
        moves: CycleMoves,
        code: u16,
        lines: Vec<u32>,
        passes_before: u32,
    ) -> Result<(), Alarm> {
        let estimate = moves.estimate();
        if estimate > limits::CYCLE_MOVES_MAX {
            let diagnostic = Diagnostic::error("cycle-move-limit").at(self.block_place());
            return Err(self.finish(diagnostic.with("limit", limits::CYCLE_MOVES_MAX as i64)));
        }
        // The first move of the cycle takes the whole movement of the offset along.
        self.untaken = None;
        self.suspend_compensation()?;
        self.active = Some(ActiveCycle { moves, code, at: self.at, lines, passes_before, moves_made: 0 });
        Ok(())
    }

    /// Gives out the next move of the active cycle, or ends it.
    pub(crate) fn next_cycle_move(&mut self) -> Result<(), Alarm> {
        let depth = self.depth();
        let Some(cycle) = &mut self.active else { return Ok(()) };
        let Some(step) = cycle.moves.next() else {
            self.active = None;
            return Ok(());
        };
        cycle.moves_made += 1;
        self.cycle_moves += 1;
        if cycle.moves_made > limits::CYCLE_MOVES_MAX || self.cycle_moves > limits::RUN_MOVES_MAX {
            let diagnostic = Diagnostic::error("cycle-move-limit").at(self.block_place());
            return Err(self.finish(diagnostic.with("limit", limits::CYCLE_MOVES_MAX as i64)));
        }
        let at = &cycle.at;
        let pass = if step.pass == 0 { 0 } else { step.pass.saturating_add(cycle.passes_before) };
        let origin = Origin {
            source: at.source.0,
            line: at.line,
            figure_line: step.element.and_then(|element| cycle.lines.get(element as usize).copied()),
            sequence: at.sequence,
            program: self.program,
            depth,
            cycle: Some(CycleOrigin { label: CycleLabel(cycle.code), pass, phase: step.phase }),
        };
        let action = step.action;
        if let Some(to) = action.end_point() {
            let from = std::mem::replace(&mut self.tip, to);
            self.modal.position = to;
            if self.looks_at_moves {
                self.follow_plain(to);
                let nose = self.compensation.is_some().then(|| self.nose());
                return self.give(from, action, origin, nose);
            }
        }
        self.out.push_back(Command::new(action, origin));
        Ok(())
    }
}
