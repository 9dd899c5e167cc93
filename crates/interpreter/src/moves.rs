//! Giving out commands: moves, and the moves of cycles one by one.

use turnwright_canon::{
    Action, Command, Curve, CycleLabel, CycleOrigin, Origin, Phase, RapidPath, Shape, Turn,
};
use turnwright_cycles::{
    BoxCycle, CycleMove, Element, FigureMotion, Groove, Hole, Pattern, PocketRoughing, Roughing,
    SemiFinished, ThreadOnce, Threading,
};
use turnwright_diagnostics::Diagnostic;
use turnwright_units::{Feed, FeedPerMinute, FeedPerRevolution, Length, Position, WorkTip};

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
    code: u16,
    /// The block that runs the cycle.
    origin: Origin,
    /// Lines of the figure's elements.
    lines: Vec<u32>,
    /// Passes of the same modal cycle made before.
    passes_before: u32,
    /// What single-block operation stops behind.
    stops_behind: StopUnit,
    /// The next move: it decides about a stop behind the one before.
    ahead: Option<CycleMove>,
}

/// Single-block operation is switched off by the program: the bit of `#3003`.
const SINGLE_BLOCK_OFF: u8 = 1;

/// What single-block operation stops behind in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StopUnit {
    /// Every move that is no thread.
    Move,
    /// Every pass that brought the tool back.
    Pass,
    /// The way to a hole, the way down to the point R, and the end of the hole.
    Hole,
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
        self.modal.feed.and_then(|feed| self.feed_of(feed))
    }

    /// The feed of an F word by the feed mode, `None` when it is zero.
    #[inline]
    pub(crate) fn feed_of(&self, length: Length) -> Option<Feed> {
        if length.is_zero() {
            return None;
        }
        Some(match self.modal.feed_mode {
            FeedMode::PerMinute => Feed::PerMinute(FeedPerMinute(length)),
            FeedMode::PerRevolution => Feed::PerRevolution(FeedPerRevolution(length)),
        })
    }

    /// Where commands of the block in work come from.
    #[inline]
    pub(crate) fn origin(&self) -> Origin {
        let finishing = self.in_cycle.is_some();
        if finishing && let Some(roughing) = &self.cylinder_roughing {
            let is_figure =
                self.in_cycle.is_some_and(|cycle| matches!(cycle.phase, Phase::Cut | Phase::Finish));
            return Origin {
                source: roughing.at.source.0,
                figure_line: is_figure.then_some(self.at.line),
                sequence: roughing.at.sequence,
                program: self.program,
                depth: self.depth(),
                cycle: self.in_cycle,
                ..Origin::line(roughing.at.line)
            };
        }
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
                runs_on: false,
            };
        }
        self.origin_outside_cycles(self.at)
    }

    /// The same where no cycle runs, for the place of the block in work.
    ///
    /// Always inline: what is made of it in one place is not carried there.
    #[inline(always)]
    pub(crate) fn origin_outside_cycles(&self, at: BlockPlace) -> Origin {
        Origin {
            source: at.source.0,
            line: at.line,
            figure_line: None,
            sequence: at.sequence,
            program: self.program,
            depth: self.depth(),
            cycle: None,
            runs_on: false,
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

    /// As [`Core::emit_move`], for the moves of every day: they are made where they wait to be given out, and not
    /// carried there.
    #[inline]
    pub(crate) fn emit_made(
        &mut self,
        to: Position<WorkTip>,
        make: impl Fn() -> Action,
    ) -> Result<(), Alarm> {
        if self.looks_at_moves || self.untaken.is_some() || self.capture.is_some() {
            return self.emit_looked_at(to, make());
        }
        if to != self.tip || is_move_of_its_own(&make()) {
            self.tip = to;
            let origin = self.origin();
            self.out.push_made(|| Command::new(make(), origin));
        }
        Ok(())
    }

    /// Gives out a move of the block in work and takes its end as the tool's place.
    pub(crate) fn emit_move(&mut self, to: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        if self.looks_at_moves || self.untaken.is_some() || self.capture.is_some() {
            return self.emit_looked_at(to, action);
        }
        if to != self.tip || is_move_of_its_own(&action) {
            self.tip = to;
            let runs_on = matches!(action, Action::Thread { .. });
            self.out.push_back(Command::new(action, Origin { runs_on, ..self.origin() }));
        }
        Ok(())
    }

    #[cold]
    fn emit_looked_at(&mut self, to: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        if self.capture.is_some() {
            return self.capture_any(to, action);
        }
        if self.untaken.is_some() {
            return self.emit_move_short(to, action);
        }
        let goes = to != self.tip || is_move_of_its_own(&action);
        let from = std::mem::replace(&mut self.tip, to);
        if !goes {
            Ok(())
        } else if self.compensation.is_some() {
            self.compensate(from, action)
        } else {
            let mut origin = self.origin();
            origin.runs_on = matches!(action, Action::Thread { .. });
            self.give(from, action, origin, None)
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
        mut moves: CycleMoves,
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
        if !matches!(moves, CycleMoves::ThreadOnce(_)) {
            self.suspend_compensation()?;
        }
        let stops_behind = self.stop_unit(&moves);
        let origin = Origin {
            source: self.at.source.0,
            sequence: self.at.sequence,
            program: self.program,
            depth: self.depth(),
            ..Origin::line(self.at.line)
        };
        let ahead = moves.next();
        self.cycle_moves_end =
            self.cycle_moves.saturating_add(limits::CYCLE_MOVES_MAX).min(limits::RUN_MOVES_MAX);
        self.active = Some(ActiveCycle { moves, code, origin, lines, passes_before, stops_behind, ahead });
        Ok(())
    }

    fn stop_unit(&self, moves: &CycleMoves) -> StopUnit {
        use turnwright_control::policy::CycleSingleBlock;
        match moves {
            CycleMoves::Hole(_) => StopUnit::Hole,
            CycleMoves::Threading(_) | CycleMoves::Box(_) | CycleMoves::ThreadOnce(_) => StopUnit::Pass,
            _ => match self.control.policies.cycle_single_block {
                CycleSingleBlock::ByParameter if !self.settings.cycle_stops_behind_moves => StopUnit::Pass,
                CycleSingleBlock::EveryMove | CycleSingleBlock::ByParameter => StopUnit::Move,
            },
        }
    }

    /// Marks the command that is given out next when single-block operation goes on behind it for what follows.
    #[cold]
    pub(crate) fn mark_running_on(&mut self) {
        let runs_on = self.out.front().is_some_and(|command| self.runs_on_behind(command));
        if let Some(command) = self.out.front_mut() {
            command.origin.runs_on |= runs_on;
        }
    }

    fn runs_on_behind(&self, command: &Command) -> bool {
        if self.macros.state.single_block & SINGLE_BLOCK_OFF != 0 {
            return true;
        }
        // The way home of the finishing cycle is not part of the figure's last block.
        let block = |origin: &Origin| {
            (
                origin.source,
                origin.line,
                origin.figure_line,
                origin.depth,
                origin.cycle.map(|cycle| cycle.phase),
            )
        };
        let is_cut = |command: &Command| matches!(command.action, Action::Feed { .. });
        match self.out.second() {
            // The line and its corner.
            Some(next) if is_cut(command) && is_cut(next) && self.settings.corner_stops_single_block => false,
            Some(next) => block(&command.origin) == block(&next.origin),
            None => false,
        }
    }

    /// The next move of the active cycle; `None` when the cycle has ended, or when the move must be looked at first
    /// ([`look_at_cycle_move`](Core::look_at_cycle_move)).
    #[inline]
    pub(crate) fn next_cycle_move(&mut self) -> Option<Command> {
        let cycle = self.active.as_mut()?;
        if self.looks_at_moves || self.cycle_moves >= self.cycle_moves_end {
            return None;
        }
        let step = cycle.ahead.take()?;
        let next = cycle.moves.next();
        let origin = self.cycle_origin(&step, next.as_ref());
        if let Some(to) = step.action.end_point() {
            self.tip = to;
            self.modal.position = to;
        }
        let command = Command::new(step.action, origin);
        if let Some(cycle) = &mut self.active {
            cycle.ahead = next;
        }
        Some(command)
    }

    /// Gives out the next move of the active cycle by way of what looks at moves; ends the cycle behind the last.
    #[cold]
    pub(crate) fn look_at_cycle_move(&mut self) -> Result<(), Alarm> {
        let Some(cycle) = &mut self.active else { return Ok(()) };
        let Some(step) = cycle.ahead.take() else {
            self.active = None;
            return Ok(());
        };
        let next = cycle.moves.next();
        let keeps_vector = matches!(cycle.moves, CycleMoves::ThreadOnce(_));
        if self.cycle_moves >= self.cycle_moves_end {
            let diagnostic = Diagnostic::error("cycle-move-limit").at(self.block_place());
            let is_of_all = self.cycle_moves >= limits::RUN_MOVES_MAX;
            let limit = if is_of_all { limits::RUN_MOVES_MAX } else { limits::CYCLE_MOVES_MAX };
            return Err(self.finish(diagnostic.with("limit", limit as i64)));
        }
        let origin = self.cycle_origin(&step, next.as_ref());
        if let Some(cycle) = &mut self.active {
            cycle.ahead = next;
        }
        let mut action = step.action;
        let Some(to) = action.end_point() else {
            self.out.push_back(Command::new(action, origin));
            return Ok(());
        };
        let from = std::mem::replace(&mut self.tip, to);
        self.modal.position = to;
        let from = self.follow_cycle(from, &mut action, keeps_vector);
        let nose = self.compensation.is_some().then(|| self.nose());
        self.give(from, action, origin, nose)
    }

    /// Counts a move of the active cycle, and tells where it comes from.
    #[inline]
    fn cycle_origin(&mut self, step: &CycleMove, next: Option<&CycleMove>) -> Origin {
        self.cycle_moves += 1;
        let is_off = self.macros.state.single_block & SINGLE_BLOCK_OFF != 0;
        let Some(cycle) = &self.active else { return self.origin() };
        let pass = if step.pass == 0 { 0 } else { step.pass.saturating_add(cycle.passes_before) };
        Origin {
            figure_line: step.element.and_then(|element| cycle.lines.get(element as usize).copied()),
            cycle: Some(CycleOrigin { label: CycleLabel(cycle.code), pass, phase: step.phase }),
            runs_on: is_off || cycle.runs_on_behind(step, next, self.waiting.is_some()),
            ..cycle.origin
        }
    }
}

impl ActiveCycle {
    /// Whether single-block operation goes on behind a move. The block may have more to do behind the cycle.
    #[inline]
    fn runs_on_behind(&self, step: &CycleMove, next: Option<&CycleMove>, has_more_to_do: bool) -> bool {
        match (next, self.stops_behind) {
            (None, _) if has_more_to_do => true,
            (_, StopUnit::Move) => matches!(step.action, Action::Thread { .. }),
            (Some(next), StopUnit::Pass) => step.pass == 0 || next.pass == step.pass,
            (Some(next), StopUnit::Hole) => {
                let comes_to_rest = matches!(step.phase, Phase::Shift | Phase::Approach);
                let is_move = step.action.end_point().is_some();
                next.pass == step.pass && !(comes_to_rest && is_move)
            }
            (None, StopUnit::Pass | StopUnit::Hole) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use turnwright_control::{Control, DEFAULT_CONTROL, Setup};
    use turnwright_diagnostics::{Argument, SourceId};

    use crate::limits::RUN_MOVES_MAX;
    use crate::{Environment, Interpreter, Options, ReadFault, Step};

    struct Text(&'static [u8]);

    impl Environment for Text {
        fn read(&mut self, _: SourceId, offset: u64, buffer: &mut [u8]) -> Result<usize, ReadFault> {
            let rest = self.0.get(offset as usize..).unwrap_or_default();
            let count = rest.len().min(buffer.len());
            buffer[..count].copy_from_slice(&rest[..count]);
            Ok(count)
        }

        fn skips(&self, _: u8) -> bool {
            false
        }
    }

    #[test]
    fn all_cycles_together_make_as_many_moves_as_allowed_and_not_one_more() {
        // A turning cycle makes four moves.
        let alarm = |made_before: u64| {
            let mut text = Text(b"O1\nG97 S500 M3\nG0 X50. Z2.\nG90 X40. Z-20. F0.2\nM30\n");
            let control = Control::load(DEFAULT_CONTROL).expect("a control");
            let mut interpreter =
                Interpreter::new(control, &Setup::default(), SourceId(0), Options::default())
                    .expect("a start");
            interpreter.core.cycle_moves = made_before;
            loop {
                match interpreter.step(&mut text) {
                    Step::Alarm(alarm) => return Some(alarm),
                    Step::End => return None,
                    Step::Emit(_) | Step::NeedSync(_) => {}
                }
            }
        };
        assert_eq!(alarm(RUN_MOVES_MAX - 4), None);
        let alarm = alarm(RUN_MOVES_MAX - 3).expect("an alarm");
        assert_eq!(alarm.key, "cycle-move-limit");
        assert_eq!(alarm.arguments, [("limit", Argument::from(RUN_MOVES_MAX as i64))]);
    }
}
