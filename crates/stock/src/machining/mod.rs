//! Commands applied to the stock: what is cut, and what is hit on the way.
//!
//! In: canonical commands in order of execution, the shapes of the tools by number, what stands around the work. Out: the
//! section that is left, what each command removed, and [`Event`]s as data, each with its command's origin, its place and
//! its depth.
//!
//! What is taken for granted:
//! * The stock stands where the program's numbers say: a change of work zero moves it along.
//! * The tool is the last one called; its outlines are relative to the programmed point, with nose compensation too.
//! * A cutting edge that hits the stock in a rapid move takes what it hits, so that one crash is told once; a holder that
//!   hits it takes nothing.
//! * A thread is cut in the half-plane that passes the tool when the spindle stands at zero: the insert at rest once a
//!   turn, in phase with its start angle, so that the section shows true grooves, several starts included, and their
//!   volume is that of the helix. Where a thread ends in solid, the insert stands in its own groove, whatever half-plane
//!   that end lies in: a rapid from there hits only what the insert did not fill when it stood still.
//! * What loses its hold of the chuck side falls and is gone.
//!
//! Invariant: memory does not grow with the number of commands, but only with the section's edges.

mod event;
mod guard;
mod half_planes;
mod threads;
mod ways;

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, Interpolation, Origin, SectionPlace, Shape, SpindleState};
use turnwright_geometry::{Outline, Point, Segment};
use turnwright_units::{Position, WorkTip};

pub use self::event::{Event, EventKind, Obstacle};
pub use self::guard::{Guard, LOSSES_MAX};
pub use self::half_planes::{HalfPlanes, TooLong, WOUND_COMMANDS_MAX, WOUND_CUTS_MAX};
pub use self::threads::{FACE_TURNS_MAX, THREADS_MAX, TURNS_MAX, ThreadHand, ThreadMark};
use self::threads::{Phase, ThreadCut, ThreadMarks};
pub use self::ways::{edges, rapid_edges};
use self::ways::{point, rapid_ways, ways};
use crate::removed::{Contact, Removed};
use crate::section::{Section, SectionFault};
use crate::{Cutter, Sweep};

/// A contact that is less deep rubs, and is no event: a micrometre, above all rounding of commands.
pub const GRAZE_MM: f64 = 1e-3;

/// What comes off with less than this share of the volume that is still held is a pip left by facing, not the part.
const PIP_SHARE: f64 = 0.005;

/// The outlines of a tool, relative to its programmed point.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolShape {
    /// What cuts.
    pub cutting: Outline,
    /// What must not touch anything.
    pub body: Option<Outline>,
}

/// How fast the slides position, mm of radius and mm a minute: it shapes rapids whose axes move each at its own rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidRates {
    /// Of X.
    pub x_mm_per_min: f64,
    /// Of Z.
    pub z_mm_per_min: f64,
}

#[derive(Clone, Debug)]
struct Tool {
    cutting: Cutter,
    body: Option<Cutter>,
}

/// The stock, the tools, and where they are.
#[derive(Clone, Debug)]
pub struct Machining {
    section: Section,
    /// What came off in front of all that is held.
    cut_off: Option<Section>,
    /// How often that changed.
    parted: u32,
    /// What came off last, until it is taken.
    fallen: Option<Section>,
    /// Z of the end that the chuck holds.
    held_z: f64,
    tools: BTreeMap<u32, Tool>,
    obstacles: Vec<(Obstacle, Section)>,
    guards: Vec<Guard>,
    rates: RapidRates,
    at: Position<WorkTip>,
    place: SectionPlace,
    is_turned: bool,
    tool: Option<u32>,
    /// The tool without a shape that was told of last.
    unknown: Option<u32>,
    spindle: SpindleState,
    /// Which half-plane the section is in: turns from X towards Y.
    turn: f64,
    phase: Phase,
    /// Where a thread has just ended, until the next move.
    thread_end: Option<Point>,
    threads: ThreadMarks,
    sweep: Sweep,
    /// Whether rapids that meet the stock take it away.
    cuts_at_rapid: bool,
    /// The section in front of the rapid that hit it last, as long as some are kept.
    struck: Option<Section>,
    strikes: u32,
}

impl Machining {
    /// Stock that the chuck holds at its end of lowest Z, and a tool at `start` whose number is not known yet.
    pub fn new(section: Section, start: Position<WorkTip>, rates: RapidRates) -> Self {
        Self {
            held_z: section.bounds().map_or(0.0, |bounds| bounds.min.z),
            section,
            cut_off: None,
            parted: 0,
            fallen: None,
            tools: BTreeMap::new(),
            obstacles: Vec::new(),
            guards: Vec::new(),
            rates,
            at: start,
            place: SectionPlace::default(),
            is_turned: true,
            tool: None,
            unknown: None,
            spindle: SpindleState::Stop,
            turn: 0.0,
            phase: Phase::default(),
            thread_end: None,
            threads: ThreadMarks::default(),
            sweep: Sweep::new(),
            cuts_at_rapid: true,
            struck: None,
            strikes: 0,
        }
    }

    /// Keeps the section in front of so many rapids that hit it; each until it is taken.
    pub const fn keep_struck(&mut self, strikes: u32) {
        self.strikes = strikes;
    }

    /// The section in front of the last rapid that hit it.
    pub const fn take_struck(&mut self) -> Option<Section> {
        self.struck.take()
    }

    /// The same whose rapids leave the stock as it is, and only tell that they meet it.
    #[must_use]
    pub fn sparing_at_rapid(self) -> Self {
        Self { cuts_at_rapid: false, ..self }
    }

    /// The shape of a tool by number; in the place of the one before.
    pub fn set_tool(&mut self, number: u32, shape: &ToolShape) {
        let tool = Tool { cutting: Cutter::new(&shape.cutting), body: shape.body.as_ref().map(Cutter::new) };
        self.tools.insert(number, tool);
    }

    /// Something that no tool may touch, by its half-section.
    ///
    /// # Errors
    /// [`SectionFault`] when it reaches below the axis.
    pub fn add_obstacle(&mut self, obstacle: Obstacle, outline: &Outline) -> Result<(), SectionFault> {
        self.obstacles.push((obstacle, Section::new(outline)?));
        Ok(())
    }

    /// Where the tool's programmed point is.
    pub const fn at(&self) -> Position<WorkTip> {
        self.at
    }

    /// Material of which it is told what is lost.
    pub fn add_guard(&mut self, guard: Guard) {
        self.guards.push(guard);
    }

    /// The guards, in the order in which they were added.
    pub fn guards_mut(&mut self) -> &mut [Guard] {
        &mut self.guards
    }

    /// The same with nothing guarded, nothing in the way and tools that only cut: what is left of the stock comes out
    /// the same, and sooner.
    #[must_use]
    pub fn only_cutting(&self) -> Self {
        let (guards, obstacles) = (Vec::new(), Vec::new());
        let mut same = Self { guards, obstacles, strikes: 0, struck: None, ..self.clone() };
        same.tools.values_mut().for_each(|tool| tool.body = None);
        same
    }

    /// What is left.
    pub const fn section(&self) -> &Section {
        &self.section
    }

    /// The finished part: the greatest piece that was cut off in front of all that is still held; what is left where
    /// nothing was.
    pub fn part(&self) -> &Section {
        self.cut_off.as_ref().unwrap_or(&self.section)
    }

    /// How often a greater piece came off in front of all that is held.
    pub const fn parted(&self) -> u32 {
        self.parted
    }

    /// What came off since the last time this was asked, at the place where it was; a pip is not told.
    pub const fn take_fallen(&mut self) -> Option<Section> {
        self.fallen.take()
    }

    /// The threads cut so far.
    pub fn threads(&self) -> &[ThreadMark] {
        self.threads.marks()
    }

    /// Applies a command, tells of what happens, and gives what was removed.
    pub fn advance(&mut self, command: &Command, tell: &mut dyn FnMut(Event)) -> Removed {
        let from = self.at;
        if let Some(end) = self.place.end_of(&command.action) {
            self.at = end;
        }
        let mut teller = Teller { origin: &command.origin, tell, told: None };
        if !matches!(command.action, Action::Thread { .. }) {
            self.phase = Phase::default();
        }
        let is_move =
            command.action.end_point().is_some() || matches!(command.action, Action::Relocate { .. });
        let groove = if is_move { self.thread_end.take() } else { None };
        match &command.action {
            Action::Rapid { path, .. } => {
                let mut removed = Removed::default();
                for way in rapid_ways(point(from), point(self.at), *path, self.rates) {
                    removed = removed.and(self.rapid(&way, groove, &mut teller));
                }
                removed
            }
            Action::Feed { shape, others, .. } => {
                let is_turned = self.is_turned && others.is_none() && ways::is_in_section(shape);
                let mut removed = Removed::default();
                for way in ways(from, self.at, shape) {
                    removed = removed.and(if is_turned {
                        self.feed(&way, &mut teller)
                    } else {
                        self.feed_across(&way, &mut teller)
                    });
                }
                removed
            }
            Action::Thread { .. } => self.thread(from, &command.action, &mut teller),
            Action::Relocate { to, .. } => {
                self.at = *to;
                Removed::default()
            }
            action => {
                self.remember(action);
                Removed::default()
            }
        }
    }

    /// Follows a command without cutting or telling anything.
    pub fn pass_over(&mut self, command: &Command) {
        if let Some(end) = self.place.end_of(&command.action) {
            (self.at, self.thread_end) = (end, None);
        }
        if let Action::Relocate { to, .. } = command.action {
            self.at = to;
        }
        self.remember(&command.action);
    }

    /// What is no move, but changes what moves do.
    fn remember(&mut self, action: &Action) {
        match action {
            Action::Tool { tool, .. } => self.tool = Some(*tool),
            Action::Spindle { state, .. } => self.spindle = *state,
            Action::Interpolation(interpolation) => self.is_turned = *interpolation == Interpolation::Normal,
            Action::Rapid { .. }
            | Action::Feed { .. }
            | Action::Thread { .. }
            | Action::Relocate { .. }
            | Action::Coupling(_)
            | Action::RigidTapping(_)
            | Action::SpindleWatch(_)
            | Action::PanelLock(_)
            | Action::PathMode(_)
            | Action::Dwell(_)
            | Action::Coolant(_)
            | Action::Auxiliary { .. }
            | Action::SecondAuxiliary { .. }
            | Action::Stop
            | Action::OptionalStop
            | Action::End
            | Action::Message(_)
            | Action::Output(_) => {}
        }
    }

    /// A rapid, out of the groove of a thread that ended at a place when one did.
    fn rapid(&mut self, way: &Segment, groove: Option<Point>, teller: &mut Teller<'_>) -> Removed {
        let Some(tool) = shape(&self.tools, self.tool, &mut self.unknown, None) else {
            return Removed::default();
        };
        self.sweep.along(&tool.cutting, way);
        let mut removed = Removed::default();
        let mut contact = deep(self.section.touches(&self.sweep));
        let mut grooved = None;
        if let (Some(_), Some(end)) = (contact, groove) {
            let mut section = self.section.clone();
            section.cut(Sweep::new().rest(&tool.cutting, end));
            contact = deep(section.touches(&self.sweep));
            grooved = Some(section);
        }
        if let Some(contact) = contact {
            let place = || first_touch(grooved.as_ref().unwrap_or(&self.section), &tool.cutting, way);
            teller.tell(EventKind::RapidIntoStock, Some(contact), place);
            if self.cuts_at_rapid {
                if self.strikes > 0 {
                    self.strikes -= 1;
                    self.struck.get_or_insert_with(|| self.section.clone());
                }
                removed = take(&mut self.section, &mut self.guards, &self.sweep);
            }
        }
        self.look_around(way, teller);
        self.let_fall(&removed, way.end, teller);
        removed
    }

    fn feed(&mut self, way: &Segment, teller: &mut Teller<'_>) -> Removed {
        let Some(tool) = shape(&self.tools, self.tool, &mut self.unknown, Some((way, &mut *teller))) else {
            return Removed::default();
        };
        self.sweep.along(&tool.cutting, way);
        let removed = take(&mut self.section, &mut self.guards, &self.sweep);
        self.judge(&removed, way, teller);
        removed
    }

    /// What follows from a cut.
    fn judge(&mut self, removed: &Removed, way: &Segment, teller: &mut Teller<'_>) {
        if self.spindle == SpindleState::Stop
            && let Some(contact) = deep(removed.contact())
        {
            teller.tell(EventKind::SpindleStopped, Some(contact), || way.start);
        }
        self.look_around(way, teller);
        self.let_fall(removed, way.end, teller);
    }

    /// A cut that the turning of the spindle does not spread round the part: told, and not taken away.
    fn feed_across(&mut self, way: &Segment, teller: &mut Teller<'_>) -> Removed {
        if let Some(tool) = self.tool.and_then(|number| self.tools.get(&number))
            && let Some(contact) = deep(self.section.touches(self.sweep.along(&tool.cutting, way)))
        {
            teller.tell(EventKind::NotTurned, Some(contact), || way.start);
        }
        Removed::default()
    }

    fn thread(&mut self, from: Position<WorkTip>, action: &Action, teller: &mut Teller<'_>) -> Removed {
        let Action::Thread { shape: form, lead, lead_end, start_angle, is_chained, .. } = action else {
            return Removed::default();
        };
        let all = Segment { start: point(from), end: point(self.at), bend: None };
        let Some(tool) = shape(&self.tools, self.tool, &mut self.unknown, Some((&all, &mut *teller))) else {
            return Removed::default();
        };
        if !is_chained {
            // The half-plane comes round to the tool sooner by its angle, or later.
            let turn = if self.spindle == SpindleState::CounterClockwise { -self.turn } else { self.turn };
            self.phase = Phase::starting_at(*start_angle).further(turn);
        }
        let lead_mm = (lead.0.to_mm(), lead_end.as_deref().unwrap_or(lead).0.to_mm());
        let mut removed = Removed::default();
        for way in ways(from, self.at, form) {
            let Some(turns) = self.phase.turns(&way, lead_mm) else {
                // So fine that it is no thread: a plain cut.
                self.sweep.along(&tool.cutting, &way);
                removed = removed.and(take(&mut self.section, &mut self.guards, &self.sweep));
                continue;
            };
            for place in turns {
                self.sweep.rest(&tool.cutting, place);
                removed = removed.and(take(&mut self.section, &mut self.guards, &self.sweep));
            }
        }
        if let Some(bounds) = removed.bounds {
            let number = self.tool.unwrap_or_default();
            let hand = ThreadHand::of(self.spindle, &all);
            let cut = ThreadCut { tool: number, lead_mm: lead_mm.0, hand };
            self.threads.note(cut, *start_angle, &all, bounds);
        }
        self.thread_end = Some(all.end);
        self.judge(&removed, &all, teller);
        removed
    }

    /// Holder against stock, and all of the tool against what stands around.
    fn look_around(&mut self, way: &Segment, teller: &mut Teller<'_>) {
        let Some(tool) = self.tool.and_then(|number| self.tools.get(&number)) else { return };
        if let Some(body) = &tool.body
            && let Some(contact) = deep(self.section.touches(self.sweep.along(body, way)))
        {
            let place = || first_touch(&self.section, body, way);
            teller.tell(EventKind::BodyIntoStock, Some(contact), place);
        }
        if self.obstacles.is_empty() {
            return;
        }
        for part in [Some(&tool.cutting), tool.body.as_ref()].into_iter().flatten() {
            self.sweep.along(part, way);
            for (obstacle, section) in &self.obstacles {
                if let Some(contact) = deep(section.touches(&self.sweep)) {
                    let place = || first_touch(section, part, way);
                    teller.tell(EventKind::IntoObstacle(*obstacle), Some(contact), place);
                }
            }
        }
    }

    /// Drops what the chuck no longer holds.
    fn let_fall(&mut self, removed: &Removed, at: Point, teller: &mut Teller<'_>) {
        if !removed.may_part {
            return;
        }
        let held_z = self.held_z;
        let is_held = |min_z: f64| min_z <= held_z + GRAZE_MM;
        let pieces = self.section.pieces();
        if pieces.len() < 2 || !pieces.iter().any(|piece| is_held(piece.bounds.min.z)) {
            return;
        }
        let mut fallen = self.section.clone();
        fallen.drop_pieces(|piece| is_held(piece.bounds.min.z));
        for piece in self.section.drop_pieces(|piece| !is_held(piece.bounds.min.z)) {
            // A speck between edges that nearly lie on each other is no part.
            if let Some(contact) = deep(Some(Contact::around(piece.bounds, piece.area_mm2, piece.volume_mm3)))
            {
                teller.tell(EventKind::CutOff, Some(contact), || at);
            }
        }
        let is_in_front = match (fallen.bounds(), self.section.bounds()) {
            (Some(fallen), Some(held)) => fallen.min.z >= held.max.z - GRAZE_MM,
            _ => false,
        };
        let least_mm3 = PIP_SHARE * self.section.volume_mm3();
        let most_mm3 = self.cut_off.as_ref().map_or(least_mm3, Section::volume_mm3);
        if is_in_front && fallen.volume_mm3() > most_mm3 {
            self.cut_off = Some(fallen.clone());
            self.parted += 1;
        }
        if fallen.volume_mm3() > least_mm3 {
            self.fallen = Some(fallen);
        }
    }
}

/// The lines and arcs of a cutting move in the half-section; nothing for what is no turning.
pub fn cutting_ways(
    from: Position<WorkTip>,
    to: Position<WorkTip>,
    shape: &Shape,
) -> impl Iterator<Item = Segment> {
    ways::is_in_section(shape).then(|| ways(from, to, shape)).into_iter().flatten()
}

/// Puts the origin to events, and tells of each kind once in a row: where on the ways of a command it begins.
struct Teller<'a> {
    origin: &'a Origin,
    tell: &'a mut dyn FnMut(Event),
    told: Option<EventKind>,
}

impl Teller<'_> {
    fn tell(&mut self, kind: EventKind, contact: Option<Contact>, place: impl FnOnce() -> Point) {
        if self.told != Some(kind) || kind == EventKind::CutOff {
            (self.tell)(Event { kind, origin: *self.origin, place: place(), contact });
        }
        self.told = Some(kind);
    }
}

/// The shape of the tool in use; a cut with a tool without one is told once in a row.
fn shape<'a>(
    tools: &'a BTreeMap<u32, Tool>,
    number: Option<u32>,
    unknown: &mut Option<u32>,
    cut: Option<(&Segment, &mut Teller<'_>)>,
) -> Option<&'a Tool> {
    let number = number.unwrap_or(0);
    let tool = tools.get(&number);
    if let (None, Some((way, teller))) = (tool, cut)
        && *unknown != Some(number)
    {
        *unknown = Some(number);
        teller.tell(EventKind::NoShape { tool: number }, None, || way.start);
    }
    tool
}

/// Takes what a sweep passes over away. What is guarded was part of the stock, so that it loses nothing where the stock
/// does not.
fn take(section: &mut Section, guards: &mut [Guard], sweep: &Sweep) -> Removed {
    let removed = section.cut(sweep);
    if removed.is_something() {
        guards.iter_mut().for_each(|guard| guard.cut(sweep));
    }
    removed
}

/// A contact that counts.
fn deep(contact: Option<Contact>) -> Option<Contact> {
    contact.filter(|contact| contact.depth_mm > GRAZE_MM)
}

/// The programmed point when the tool first goes in, on a way on which it does.
fn first_touch(section: &Section, cutter: &Cutter, way: &Segment) -> Point {
    // Below a micrometre for any way on a lathe.
    const HALVINGS: u32 = 24;
    let mut sweep = Sweep::new();
    let (mut clear, mut hit) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = (clear + hit) / 2.0;
        let part = Segment { end: ways::at(way, middle), ..*way };
        if deep(section.touches(sweep.along(cutter, &part))).is_some() {
            hit = middle
        } else {
            clear = middle
        }
    }
    ways::at(way, clear)
}
