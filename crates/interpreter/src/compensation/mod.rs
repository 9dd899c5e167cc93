//! Nose-radius compensation: the stage between the moves that a program asks for and the commands that are given out.
//!
//! In: moves of the programmed contour, one by one, and everything else that blocks ask for. Out: moves of the imaginary
//! tip, such that the round nose rolls along the contour, each with the place of the nose centre; everything else in
//! its order. The joint at the end of a move depends on the move behind it, so one move waits; with it waits what the
//! blocks between do besides moving. Controls go on without the next move when too many blocks hold none: the nose then
//! stands square to the end of the move. Because of that bound the stage holds one move and what
//! [`HELD_BLOCKS_MAX`] blocks ask for, whatever the program does.
//!
//! The programmed place, `Core::tip`, runs ahead on the contour; where the tip really is, in the same coordinates, is
//! [`Compensation::stands`]. At a corner P the nose centre is P + V with a vector V of the joint, and the tip is
//! P + V + v, where v leads from the nose centre to the imaginary tip. Without compensation the tip is on the contour
//! itself. Geometry computes in millimetres from the programmed points; each point given out is rounded once.
//!
//! **Start and end.** The first straight move behind G41 or G42 leads onto the path, the first behind G40 off it. Ways
//! to reference points and machine places let go of the vector: before them the nose stands square to the end of the path,
//! and they (or their way to the intermediate point) lead off it. Whatever moves the work zero lets go as well: the move
//! before it ends on the contour. The next move leads back to the path, or behind G40 none does. Cycles other than the
//! finishing cycle run without the vector; threads and the thread cutting cycle keep the one that they find.
//!
//! **Interference.** A move whose nose centre would run backwards loses the inner vectors of its joints one pair after
//! the other; if that does not help the control stops before the move.
//!
//! Source: tool nose radius compensation of both families.

mod element;
mod nose;
mod overcut;
mod settings;
mod single_cycle;

use std::collections::VecDeque;

use turnwright_canon::{Action, Command, Origin, Shape};
use turnwright_control::policy::{CompensationGap, RoughingCompensation};
use turnwright_diagnostics::Diagnostic;
use turnwright_geometry::{Joint, Offset, Segment, Side, Vector};
use turnwright_syntax::Word;
use turnwright_units::{Displacement, Position, WorkTip};

use self::element::{Element, Role};
pub(crate) use self::nose::Nose;
use self::overcut::Passed;
pub(crate) use self::settings::CompensationSettings;
use crate::functions::FunctionId;
use crate::machine::{BlockPlace, Core};
use crate::plane::point;
use crate::report::Alarm;

/// Blocks without a move whose commands may wait, on any control.
const HELD_BLOCKS_MAX: u8 = 8;

/// The modal group of nose compensation.
pub(crate) const COMPENSATION_GROUP: usize = 7;

/// Slack of places that are computed twice.
const SAME_MM: f64 = 1e-6;

/// What the nose does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The next straight move leads onto the path.
    Starting,
    /// It follows the path.
    Following,
    /// The vector was let go; the next move leads back to the path.
    Suspended,
}

/// How moves are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Taking {
    /// As parts of the contour.
    Contour,
    /// The next one ends on the contour, and those behind it run on it.
    LettingGo,
    /// As they are.
    Plain,
}

/// What waits behind a move.
#[derive(Debug)]
enum Held {
    Command(Box<Command>),
    /// The work zero moved; the tool has other coordinates by this.
    Relocation(Displacement<WorkTip>, Origin),
}

/// Nose compensation in force, or ending.
#[derive(Debug)]
pub(crate) struct Compensation {
    /// The side asked for; `None` behind G40.
    side: Option<Side>,
    state: State,
    taking: Taking,
    /// Where the tip is: of the move given out last.
    stands: Position<WorkTip>,
    /// The move whose end depends on the next one.
    waiting: Option<Element>,
    /// The nose at the end of the part given out last.
    nose: Nose,
    /// The joint at its start; the first vector is reached. `None` when the move begins anywhere else.
    start: Option<Joint>,
    held: Vec<Held>,
    /// How far the work zero has moved under the waiting move.
    moved: Vector,
    /// Blocks without a move since the last one.
    gap: u8,
    /// The block in work moved.
    is_new: bool,
    /// The direction of a wall at the end of the path.
    wall: Option<Vector>,
    /// The block in work gave it.
    has_wall_words: bool,
    /// The block in work has the code that asks for the side.
    is_code_block: bool,
    /// The elements passed last.
    passed: VecDeque<Passed>,
}

/// Compensation in force around a figure that knows nothing of it.
#[derive(Debug)]
pub(crate) struct Outside {
    path: Option<Box<Compensation>>,
    /// The code in force.
    code: Option<u16>,
}

impl Compensation {
    fn new(stands: Position<WorkTip>, nose: Nose) -> Box<Self> {
        Box::new(Self {
            side: None,
            state: State::Starting,
            taking: Taking::Contour,
            stands,
            waiting: None,
            nose,
            start: None,
            held: Vec::new(),
            moved: Vector::default(),
            gap: 0,
            is_new: false,
            wall: None,
            has_wall_words: false,
            is_code_block: true,
            passed: VecDeque::new(),
        })
    }

    /// The block in work starts or ends the compensation, or changes its side.
    fn changes(&self) -> bool {
        self.state == State::Starting
            || self.side.is_none()
            || self.waiting.as_ref().is_some_and(|waiting| Some(waiting.asked) != self.side)
    }
}

impl Core {
    /// G41 or G42.
    pub(crate) fn compensate_on(&mut self, side: Side) {
        let (stands, nose) = (self.tip, self.nose());
        let path = self.compensation.get_or_insert_with(|| Compensation::new(stands, nose));
        path.side = Some(side);
        path.is_code_block = true;
        self.look_at_moves();
    }

    /// Before a figure is read: compensation in force before a roughing cycle shifts it on some controls.
    pub(crate) fn compensate_figure(&mut self, in_force: Option<&Compensation>) {
        let shifts = self.control.policies.roughing_compensation == RoughingCompensation::BeforeCycle;
        if let Some(side) = in_force.and_then(|path| path.side).filter(|_| shifts) {
            self.compensate_on(side);
        }
    }

    /// Before a figure is finished: where only its own first block can name compensation, that in force lets go.
    pub(crate) fn leave_outside(&mut self) -> Result<Option<Outside>, Alarm> {
        if self.control.policies.roughing_compensation != RoughingCompensation::InFirstBlock {
            return Ok(None);
        }
        self.suspend_compensation()?;
        let path = self.compensation.take();
        let off = self.dispatch.codes_at_power_on[COMPENSATION_GROUP];
        let code = std::mem::replace(&mut self.modal.in_force.codes[COMPENSATION_GROUP], off);
        self.look_at_moves();
        Ok(Some(Outside { path, code }))
    }

    /// Behind the figure: what was in force before it is so again.
    pub(crate) fn come_back_to(&mut self, outside: Outside) {
        self.compensation = outside.path;
        self.modal.in_force.codes[COMPENSATION_GROUP] = outside.code;
        let tip = self.tip;
        if let Some(path) = &mut self.compensation {
            path.stands = tip;
        }
        self.look_at_moves();
    }

    /// G40, perhaps with the direction of a wall.
    pub(crate) fn compensate_off(&mut self, wall: Option<Vector>) {
        let Some(path) = &mut self.compensation else { return };
        if path.state == State::Starting {
            self.compensation = None;
            self.look_at_moves();
        } else {
            path.side = None;
            path.wall = wall;
            path.has_wall_words = wall.is_some();
            path.is_code_block = true;
        }
    }

    /// I and K of the block in work give a wall.
    pub(crate) fn has_wall_words(&self) -> bool {
        self.compensation.as_ref().is_some_and(|path| path.has_wall_words)
    }

    /// The path runs on this side, or will.
    pub(crate) fn compensates_on(&self, side: Side) -> bool {
        self.compensation.as_ref().is_some_and(|path| path.side == Some(side))
    }

    /// The block in work starts or ends the compensation, or changes its side: no place for a corner.
    pub(crate) fn compensation_changes(&self) -> bool {
        self.compensation.as_ref().is_some_and(|path| path.changes())
    }

    /// Where the tip is, at the end of the moves given out.
    pub(crate) fn stands(&self) -> Position<WorkTip> {
        self.compensation.as_ref().map_or(self.tip, |path| path.stands)
    }

    /// A command that is no move: it follows the move that waits.
    pub(crate) fn pass_on(&mut self, command: Command) {
        match &mut self.compensation {
            Some(path) if path.waiting.is_some() => path.held.push(Held::Command(Box::new(command))),
            _ => self.out.push_back(command),
        }
    }

    /// The work zero moved by itself: the tool has other coordinates.
    pub(crate) fn relocate_compensated(&mut self, way: Displacement<WorkTip>) {
        let origin = self.origin();
        let Some(path) = &mut self.compensation else { return };
        if path.waiting.is_some() {
            path.moved = path.moved.plus(element::vector_of(way));
            path.held.push(Held::Relocation(way, origin));
        } else {
            path.stands = path.stands + way;
            let to = self.in_work(self.stands());
            self.pass_on(Command::new(Action::Relocate { to, others: None }, origin));
        }
    }

    /// A move of a cycle, which knows nothing of compensation, from `from`; a thread keeps the vector. Gives where it
    /// really begins.
    pub(crate) fn follow_cycle(
        &mut self,
        from: Position<WorkTip>,
        action: &mut Action,
        keeps_vector: bool,
    ) -> Position<WorkTip> {
        let (Some(path), Some(to)) = (&mut self.compensation, action.end_point()) else { return from };
        let from = if keeps_vector { from } else { path.stands };
        let to = to + (path.stands - from);
        element::move_end(action, to);
        std::mem::replace(&mut path.stands, to)
    }

    /// Takes a move from `from`, the end of the one before, to the programmed place.
    #[cold]
    pub(crate) fn compensate(&mut self, from: Position<WorkTip>, action: Action) -> Result<(), Alarm> {
        let Some(mut path) = self.compensation.take() else { return Ok(()) };
        path.is_new = true;
        let result = self.take_move(&mut path, from, action);
        let is_over = path.side.is_none() && path.state == State::Starting;
        if is_over && result.is_ok() {
            self.look_at_moves();
        } else {
            self.compensation = Some(path);
        }
        result
    }

    fn take_move(
        &mut self,
        path: &mut Compensation,
        from: Position<WorkTip>,
        action: Action,
    ) -> Result<(), Alarm> {
        let Some(to) = action.end_point() else { return Ok(()) };
        if path.taking == Taking::Plain {
            return self.give_beside(path, from, to, action);
        }
        match &action {
            Action::Feed { shape: Shape::Curve(curve), feed, .. } => {
                // Beside an ellipse or a parabola lies neither: both are followed as arcs near them.
                let (curve, feed) = (curve.path(from, to), *feed);
                let tolerance_mm = self.modal.increment(&self.settings).to_mm() / 10.0;
                let mut start = point(from);
                for arc in curve.arcs(tolerance_mm) {
                    let segment = Segment { start, end: arc.end, bend: arc.bend };
                    let end = self.snapped(arc.end)?;
                    start = arc.end;
                    let action = Action::Feed { to: end, shape: Shape::Line, feed, others: None };
                    let element = self.contour_element(path, segment, action);
                    self.add(path, element)?;
                }
                Ok(())
            }
            Action::Rapid { .. } | Action::Feed { shape: Shape::Line | Shape::Arc { .. }, .. }
                if to != from || matches!(action, Action::Feed { shape: Shape::Arc { .. }, .. }) =>
            {
                let element = self.contour_element(path, element::segment(from, to, &action), action);
                self.add(path, element)
            }
            // Other axes alone, or a thread.
            _ => {
                if matches!(action, Action::Thread { .. }) {
                    self.warn_block("thread-in-compensation");
                    self.square_off(path, Some(&element::segment(from, to, &action)))?;
                } else {
                    path.is_new = false;
                }
                self.give_beside(path, from, to, action)
            }
        }
    }

    /// A move that is no part of the contour: the tip stays beside it as it is.
    fn give_beside(
        &mut self,
        path: &mut Compensation,
        from: Position<WorkTip>,
        to: Position<WorkTip>,
        mut action: Action,
    ) -> Result<(), Alarm> {
        if path.waiting.is_some() {
            let command = Command::new(action, self.origin());
            path.held.push(Held::Command(Box::new(command)));
            return Ok(());
        }
        let to = to + (path.stands - from);
        element::move_end(&mut action, to);
        if to != path.stands || action.others().is_some() {
            self.give(path.stands, action, self.origin(), Some(self.nose()))?;
        }
        path.stands = to;
        Ok(())
    }

    fn contour_element(&self, path: &Compensation, segment: Segment, action: Action) -> Element {
        let role = match (path.taking, path.side, path.state) {
            (Taking::LettingGo, ..) => Role::LettingGo,
            (_, None, _) => Role::End,
            (_, Some(_), State::Starting) => Role::Start,
            (_, Some(_), State::Following | State::Suspended) => Role::Contour,
        };
        let nose = self.nose();
        let asked = path.side.or_else(|| path.waiting.as_ref().map(|waiting| waiting.asked));
        let asked = asked.unwrap_or(Side::Left);
        let (origin, at) = (self.origin(), self.at);
        Element { role, segment, action, asked, nose, is_muted: false, origin, at }
    }

    /// Takes a part of the contour in, and gives out the one before it.
    fn add(&mut self, path: &mut Compensation, mut new: Element) -> Result<(), Alarm> {
        if new.role == Role::Start && new.nose.is_unset() {
            self.warn_block("compensation-without-radius");
        }
        let has_vector = path.state == State::Following;
        self.shift_to(path, &mut new)?;
        self.check_element(&mut new)?;
        if let Some(before) = path.waiting.take() {
            let joint = self.joint(path, &before, &new)?;
            self.settle(path, before, Some(joint))?;
        } else {
            path.start = None;
            if new.segment.bend.is_some() && new.role == Role::Contour {
                // The arc begins where the nose touches it.
                let here = element::vector(point(path.stands), new.segment.start, path.nose);
                path.start = Some(Joint::two(here, new.offset().at_start(&new.segment)));
            }
        }
        match new.role {
            Role::Start | Role::Contour => {
                path.state = State::Following;
                path.waiting = Some(new);
                Ok(())
            }
            Role::End | Role::LettingGo => {
                let role = new.role;
                self.settle(path, new, None)?;
                path.start = None;
                (path.state, path.taking) = match role {
                    Role::End => (State::Starting, path.taking),
                    _ if path.side.is_none() => (State::Starting, Taking::Plain),
                    _ if has_vector => (State::Suspended, Taking::Plain),
                    _ => (path.state, Taking::Plain),
                };
                path.wall = None;
                Ok(())
            }
        }
    }

    /// Where a code alone moves the nose to the path, it does so before the first move behind it.
    fn shift_to(&mut self, path: &mut Compensation, new: &mut Element) -> Result<(), Alarm> {
        let shifts = self.settings.compensation.shifts_without_move && !path.is_code_block;
        if new.role == Role::Start && shifts {
            let square = new.offset().at_start(&new.segment);
            self.give_shift(path, new, square)?;
            new.role = Role::Contour;
            path.state = State::Following;
        }
        Ok(())
    }

    /// Where G40 alone moves the nose off the path.
    fn shift_back(&mut self) -> Result<(), Alarm> {
        let Some(mut path) = self.compensation.take() else { return Ok(()) };
        let result = self.square_off(&mut path, None).and_then(|()| {
            let (to, motion) = (self.tip, self.modal.motion);
            let action = match self.feed_in_force().filter(|_| motion != FunctionId::RAPID) {
                Some(feed) => Action::Feed { to, shape: Shape::Line, feed, others: None },
                None => Action::Rapid { to, path: self.rapid_path(), others: None },
            };
            if path.stands == to {
                Ok(())
            } else {
                self.give(path.stands, action, self.origin(), Some(path.nose))
            }
        });
        self.look_at_moves();
        result
    }

    /// What no part of a compensated contour may be.
    fn check_element(&self, new: &mut Element) -> Result<(), Alarm> {
        let Some(bend) = new.segment.bend else { return Ok(()) };
        match new.role {
            Role::Start | Role::End => return Err(self.fault("arc-in-compensation-start", new.at)),
            Role::LettingGo => return Ok(()),
            Role::Contour => {}
        }
        let touches = |at| bend.centre.distance(at) <= SAME_MM;
        if touches(new.segment.start) || touches(new.segment.end) {
            return Err(self.fault("compensated-arc-interferes", new.at));
        }
        let settings = &self.settings.compensation;
        if new.offset().is_too_large_for(&new.segment, SAME_MM) {
            if settings.checks && !settings.small_arc_allowed {
                return Err(self.fault("compensation-interference", new.at));
            }
            // Beside it there is no arc; the nose passes it straight.
            (new.segment.bend, new.is_muted) = (None, true);
        }
        Ok(())
    }

    fn joint(&self, path: &Compensation, before: &Element, new: &Element) -> Result<Joint, Alarm> {
        let (rules, offset) = (self.settings.compensation.joints, before.offset());
        let start_up = self.settings.compensation.start_up;
        let (one, other) = (&before.segment.moved(path.moved), &new.segment);
        Ok(match (before.role, new.role) {
            (Role::Start, Role::Contour) if before.asked == new.asked => {
                offset.start_joint(one, other, start_up, &rules)
            }
            (Role::Start, Role::End) | (_, Role::LettingGo) => Joint::single(offset.at_end(one)),
            (_, Role::End) => match path.wall {
                Some(wall) => offset.wall_joint(one, wall, &rules),
                None => offset.end_joint(one, other, start_up, &rules),
            },
            _ if before.asked != new.asked => {
                offset.side_change(one, Offset { radius_mm: offset.radius_mm, ..new.offset() }, other)
            }
            _ => match offset.joint(one, other, &rules) {
                Ok(joint) => joint,
                Err(_) => {
                    let diagnostic = Diagnostic::alarm("no-compensated-intersection").at(before.place());
                    return Err(self.finish(diagnostic.near(new.place(), "next-block")));
                }
            },
        })
    }

    /// Gives out a part of the contour: what is left of the joint at its start, then itself up to the first vector
    /// of the joint at its end, or to the programmed place when there is none.
    fn settle(&mut self, path: &mut Compensation, element: Element, end: Option<Joint>) -> Result<(), Alarm> {
        let mut end = end;
        let mut start = path.start.take();
        let mut is_cut_short = false;
        if let (Some(start), Some(end), Role::Contour) = (&mut start, &mut end, element.role) {
            is_cut_short = self.untangle(&element, start, end)?;
        }
        self.look_for_overcut(path, &element, start, end.as_ref());
        let here = std::mem::replace(&mut self.at, element.at);
        let given = self.give_element(path, &element, start, end.as_ref(), is_cut_short);
        self.at = here;
        given?;
        path.start = end;
        path.moved = Vector::default();
        for held in std::mem::take(&mut path.held) {
            match held {
                Held::Command(mut command) => {
                    element::move_end(&mut command.action, path.stands);
                    self.out.push_back(*command);
                }
                Held::Relocation(way, origin) => {
                    path.stands = path.stands + way;
                    let to = self.in_work(path.stands);
                    self.out.push_back(Command::new(Action::Relocate { to, others: None }, origin));
                }
            }
        }
        Ok(())
    }

    /// Leaves out the inner vectors of two joints while the nose centre would run backwards between them; true when
    /// any was.
    fn untangle(&self, element: &Element, start: &mut Joint, end: &mut Joint) -> Result<bool, Alarm> {
        let settings = &self.settings.compensation;
        let mut is_cut_short = false;
        if !settings.checks {
            return Ok(false);
        }
        while element.segment.runs_back(start.last(), end.first(), settings.checks_direction) {
            let dropped = (start.drop_last(), end.drop_first());
            if dropped == (false, false) {
                if settings.small_step_allowed || element.is_muted {
                    return Ok(true);
                }
                return Err(self.fault("compensation-interference", element.at));
            }
            is_cut_short = true;
        }
        Ok(is_cut_short)
    }

    /// An alarm at a block that was read before.
    fn fault(&self, key: &'static str, at: BlockPlace) -> Alarm {
        self.finish(Diagnostic::alarm(key).at(at.span(at.first_byte, at.last_byte)))
    }

    /// Without waiting for the next move: the nose stands square to the end of the one that waits, or, where that
    /// leads onto the path, to what follows beside the contour.
    fn square_off(&mut self, path: &mut Compensation, beside: Option<&Segment>) -> Result<(), Alarm> {
        let Some(before) = path.waiting.take() else { return Ok(()) };
        let offset = before.offset();
        let joint = Joint::single(match beside {
            Some(beside) if before.role == Role::Start => offset.at_start(beside),
            _ => offset.at_end(&before.segment),
        });
        self.settle(path, before, Some(joint))?;
        path.start = None;
        Ok(())
    }

    /// A move waits for the one behind it.
    pub(crate) fn has_waiting_move(&self) -> bool {
        self.compensation.as_ref().is_some_and(|path| path.waiting.is_some())
    }

    /// Gives out the move that waits, as if no other followed it: the control does not read on.
    pub(crate) fn stop_reading_ahead(&mut self) -> Result<(), Alarm> {
        let Some(mut path) = self.compensation.take() else { return Ok(()) };
        let result = self.square_off(&mut path, None);
        self.compensation = Some(path);
        result
    }

    /// Lets go of the vector where the contour stands: the move that waits ends on it, the next one leads back.
    pub(crate) fn suspend_compensation(&mut self) -> Result<(), Alarm> {
        let Some(mut path) = self.compensation.take() else { return Ok(()) };
        let mut result = Ok(());
        if let Some(before) = path.waiting.take() {
            result = self.settle(&mut path, before, None);
        }
        let ends = path.side.is_none() && result.is_ok();
        if path.state == State::Following {
            path.state = State::Suspended;
        }
        path.start = None;
        self.compensation = Some(path).filter(|_| !ends);
        self.look_at_moves();
        result
    }

    /// The vector was let go; the next straight move leads onto the path as if compensation began.
    pub(crate) fn start_up_again(&mut self) {
        if let Some(path) = self.compensation.as_mut().filter(|path| path.state == State::Suspended) {
            path.state = State::Starting;
        }
    }

    /// The program leaves the path while compensation is on.
    pub(crate) fn warn_of_compensation(&mut self, word: Option<&Word>) {
        if self.compensation.as_ref().is_none_or(|path| path.side.is_none()) {
            return;
        }
        match word {
            Some(word) => self.warn("compensation-left-on", word),
            None => self.warn_block("compensation-left-on"),
        }
    }

    /// A move in work is part of the compensated contour.
    pub(crate) fn follows_compensated(&self) -> bool {
        self.compensation.as_ref().is_some_and(|path| path.side.is_some() && path.state != State::Starting)
    }

    /// Runs moves without compensation: the first of them lets go of the vector.
    pub(crate) fn without_vector(
        &mut self,
        moves: impl FnOnce(&mut Self) -> Result<(), Alarm>,
    ) -> Result<(), Alarm> {
        if let Some(path) = &mut self.compensation {
            path.taking = Taking::LettingGo;
        }
        let result = moves(self);
        if let Some(path) = &mut self.compensation {
            path.taking = Taking::Contour;
        }
        result
    }

    /// Runs moves that are no part of the contour: the tip stays beside it as it is.
    pub(crate) fn beside_contour(
        &mut self,
        moves: impl FnOnce(&mut Self) -> Result<(), Alarm>,
    ) -> Result<(), Alarm> {
        if let Some(path) = &mut self.compensation {
            path.taking = Taking::Plain;
        }
        let result = moves(self);
        if let Some(path) = &mut self.compensation {
            path.taking = Taking::Contour;
        }
        result
    }

    /// The program ends, or is broken off: compensation is over and nothing moves.
    pub(crate) fn end_compensation(&mut self) -> Result<(), Alarm> {
        let result = self.stop_reading_ahead();
        self.abandon_compensation();
        result
    }

    /// Forgets compensation; the tool is where the moves given out have led it.
    pub(crate) fn abandon_compensation(&mut self) {
        if let Some(path) = self.compensation.take() {
            self.modal.position = self.modal.position + (path.stands - self.tip);
            self.tip = path.stands;
            self.look_at_moves();
        }
    }

    /// After a block: counts those without a move while one waits.
    #[cold]
    pub(crate) fn check_compensation(&mut self, is_counted: bool) -> Result<(), Alarm> {
        if self.sync.is_some() {
            // The control does not read on.
            self.stop_reading_ahead()?;
        }
        let gap_max = self.control.limits.compensation_gap_max.min(HELD_BLOCKS_MAX);
        let Some(path) = &mut self.compensation else { return Ok(()) };
        path.has_wall_words = false;
        let ends_alone = std::mem::take(&mut path.is_code_block) && path.side.is_none() && !path.is_new;
        if ends_alone && self.settings.compensation.shifts_without_move {
            return self.shift_back();
        }
        if std::mem::take(&mut path.is_new) {
            path.gap = 0;
            return Ok(());
        }
        if !is_counted || path.state != State::Following {
            return Ok(());
        }
        path.gap = path.gap.saturating_add(1);
        if path.gap <= gap_max {
            return Ok(());
        }
        match self.control.policies.compensation_gap {
            CompensationGap::Square => {
                if path.waiting.is_some() {
                    self.warn_block("compensation-read-ahead-ends");
                }
                self.stop_reading_ahead()
            }
            CompensationGap::Alarm => Err(self.alarm_block("too-many-blocks-without-move")),
        }
    }
}
