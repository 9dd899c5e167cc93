//! The part that comes out: a program's commands on the stock, in the tools' shapes, beside what holds the work.
//!
//! In: the whole setup (given, or inferred in a run before this one) and the commands. Out: the finished section, its
//! threads, and what was hit on the way, as diagnostics. A crash is an error where the setup names the stock (and the
//! obstacle) and the tool; a warning where tool or obstacle were inferred, for the fault may lie in the guess.
//! A rapid that only drags along the wall that was just cut is a warning. Where the stock itself was inferred, rapids
//! leave it as it is (a bar that is assumed too thick is met by sound programs), and those that pass through the finished
//! part are told at the end.
//! Of tools that were inferred only what cuts is looked at: nobody said which holder it is. Edges that cut where they should
//! not (`edges.rs`) are looked at where stock and tool are given.
//!
//! Invariant: what is kept is bounded; a program that is too long for [`PART_MOVES_MAX`] or a section that is too fine
//! for [`SLABS_MAX`] ends the machining, never the run, and says so.

use std::collections::{BTreeMap, BTreeSet};

use crate::edges::{Edges, Fault};
use turnwright_canon::{Action, Command, Origin};
use turnwright_control::{Setup, SetupFault};
use turnwright_diagnostics::{Diagnostic, Place, Severity, SourceId};
use turnwright_geometry::{Bounds, Outline, Point};
use turnwright_stock::machining::{
    Event, EventKind, HalfPlanes, Obstacle, RapidRates, ThreadMark, ToolShape,
};
use turnwright_stock::{History, Machining, Removed, Section};
use turnwright_units::{Position, WorkTip};

use crate::figures::{BlockLine, Figure};
use crate::scene::{Scene, way_of};
use crate::target::{Aimed, Loss, Target, Watch, deepest_in_reach, rest_of_figure};
use crate::thread_ways::{ThreadWay, ThreadWays};

/// Moves that are cut out of the stock.
pub const PART_MOVES_MAX: u64 = 5_000_000;

/// Slabs of a section, some hundred bytes each.
pub const SLABS_MAX: usize = 200_000;

/// What a program may ask of the machining.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartLimits {
    /// Moves that are cut.
    pub moves: u64,
    /// Slabs of the section; looked at every [`COMMANDS_PER_LOOK`] commands.
    pub slabs: usize,
}

impl Default for PartLimits {
    fn default() -> Self {
        Self { moves: PART_MOVES_MAX, slabs: SLABS_MAX }
    }
}

/// Findings of one kind; more of the same say nothing new.
const FINDINGS_MAX: usize = 10;

/// A rapid that overlaps the stock less than this drags along what the tool has just cut: it mars, it does not crash.
const DRAG_MM: f64 = 0.5;

/// So deep in the finished part a rapid is told although the stock is assumed, mm: no guess of an insert's shape
/// explains it.
pub const CERTAIN_MM: f64 = 1.0;

/// Rapids through an assumed stock that are held against the finished part.
const DOUBTS_MAX: usize = 100_000;

/// What is cut below a figure that is finished is told from here on, mm: above all rounding of its corners.
pub const FIGURE_GOUGE_MM: f64 = 0.01;

/// What is left above it is told from here on, mm.
pub const FIGURE_REST_MM: f64 = 0.05;

/// At a limit a depth is within it, however numbers were rounded, mm.
const ROUNDING_MM: f64 = 1e-6;

/// Rapids into the stock that are looked at closely: of some it was told already.
const STRUCK_MAX: u32 = 200;

/// Commands between two looks at the size of the section.
pub const COMMANDS_PER_LOOK: u64 = 1024;

/// A program that is being cut out of its stock.
#[derive(Clone, Debug)]
pub struct PartRun {
    machining: Machining,
    /// The same without its threads, from the first of them on.
    plain: Option<Box<Machining>>,
    /// The same in any half-plane, from the first thread on.
    half_planes: Option<Box<HalfPlanes>>,
    /// The command with which the finished part came off.
    parted: Option<u64>,
    stock: Outline,
    limits: PartLimits,
    moves: u64,
    commands: u64,
    is_full: bool,
    notebook: Notebook,
    edges: Edges,
    history: Option<History>,
    /// What the moments of findings look like, when that is wanted.
    scenes: Option<Vec<Scene>>,
    tools: BTreeMap<u32, ToolShape>,
    /// Nose radii of the stations, mm.
    noses: BTreeMap<u32, f64>,
    obstacles: Vec<(Obstacle, Outline)>,
    /// Who looks through the guards of the machining, one each.
    watches: Vec<Watch>,
    /// What the part is held against, and the first of its watches.
    target: Option<(Target, usize)>,
    rates: RapidRates,
    doubts: Vec<Doubt>,
    /// Nothing of the stock is confirmed before the first cut.
    has_cut: bool,
    is_behind_thread: bool,
    thread_ways: ThreadWays,
}

/// A rapid that meets a stock that is only assumed.
#[derive(Clone, Debug)]
struct Doubt {
    from: Position<WorkTip>,
    command: Command,
    number: u64,
    tool: u32,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Part {
    /// The finished part: what was cut off last, else what the chuck still holds.
    pub section: Section,
    /// The same as drawings show it: with the surfaces that its threads lie in.
    pub plain: Section,
    /// What it was before.
    pub stock: Outline,
    /// Its threads.
    pub threads: Vec<ThreadMark>,
    /// Its section in any half-plane, when there are threads.
    pub half_planes: Option<Box<HalfPlanes>>,
    /// The number of the command with which it came off, when it did.
    pub parted: Option<u64>,
    /// The ways before and behind the threads, by program text and line.
    pub thread_ways: BTreeMap<(u32, u32), ThreadWay>,
    /// The stock is that of the setup, not inferred.
    pub has_stock: bool,
    /// What was hit, and what is not shown.
    pub findings: Vec<Diagnostic>,
    /// Where and when, for each of the findings that have a place.
    pub marks: Vec<Mark>,
    /// What the first of these moments look like, when it was asked for.
    pub scenes: Vec<Scene>,
    /// The section along the program, when it was asked for.
    pub history: Option<History>,
    /// The tools by station, as far as they were looked at; 0 is what moves before any is called.
    pub tools: BTreeMap<u32, ToolShape>,
    /// What stands around the work.
    pub obstacles: Vec<(Obstacle, Outline)>,
    /// What the part is to be held against, unless not all of it was cut.
    pub aimed: Option<Aimed>,
}

/// Where a finding is in the section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Key of the finding.
    pub key: &'static str,
    /// Line of its block.
    pub line: (SourceId, u32),
    /// Number of the command, from 0.
    pub command: u64,
    /// The tool's station.
    pub tool: u32,
    /// The programmed point when it happens.
    pub place: Point,
    /// How deep, mm; 0 when nothing is hit.
    pub depth_mm: f64,
    /// Round what is hit.
    pub bounds: Option<Bounds>,
}

impl Mark {
    /// Whether it says that a tool went, or left material, where it should not.
    pub fn is_collision(&self) -> bool {
        self.depth_mm > 0.0 && !matches!(self.key, "part-cut-off" | "part-not-turned")
    }

    /// Whether the tool's programmed point was at its place; else that is a place of the part.
    pub fn is_of_tool(&self) -> bool {
        !matches!(self.key, "figure-gouged" | "figure-not-reached" | "rib-left-standing")
    }
}

/// What the setup names itself, and what is told already.
#[derive(Clone, Debug, Default)]
struct Notebook {
    has_stock: bool,
    has_chuck: bool,
    has_tailstock: bool,
    /// The stations that the setup names.
    tools: BTreeSet<u32>,
    tool: u32,
    told: BTreeMap<&'static str, BTreeSet<(u32, u32)>>,
    findings: Vec<Diagnostic>,
    marks: Vec<Mark>,
}

impl PartRun {
    /// The stock of a setup, the tool at `start`; nothing when nobody knows the stock. `given` is the part of the setup
    /// that was not inferred.
    ///
    /// # Errors
    /// The key of the setup that is wrong, and the reason.
    pub fn new(
        setup: &Setup,
        given: &Setup,
        start: Position<WorkTip>,
        rates: RapidRates,
    ) -> Result<Option<Self>, SetupFault> {
        let Some(stock) = setup.stock_outline()? else { return Ok(None) };
        let no_section =
            |_| SetupFault { message: "stock: reaches below the spindle axis".to_string(), line: 0 };
        let section = Section::new(&stock).map_err(no_section)?;
        let mut machining = Machining::new(section, start, rates);
        let notebook = Notebook {
            has_stock: given.stock.as_ref().is_some_and(|stock| !stock.is_shapeless()),
            has_chuck: given.chuck.is_some(),
            has_tailstock: given.tailstock.is_some(),
            tools: given.tools.keys().filter_map(|name| name.parse().ok()).collect(),
            ..Notebook::default()
        };
        if !notebook.has_stock {
            machining = machining.sparing_at_rapid();
        }
        let (mut tools, mut noses, mut edges) = (BTreeMap::new(), BTreeMap::new(), Edges::default());
        for (station, tool) in setup.tools()? {
            noses.insert(station, tool.nose_radius_mm);
            if notebook.has_stock && notebook.tools.contains(&station) {
                edges.watch(station, &tool);
            }
            let body = tool.body.filter(|_| notebook.tools.contains(&station));
            tools.insert(station, ToolShape { cutting: tool.cutting, body });
        }
        // What moves before any tool is called is the first tool's doing, as it was when the setup was inferred.
        if let Some((_, tool)) = tools.first_key_value() {
            tools.insert(0, ToolShape { cutting: tool.cutting.clone(), body: None });
        }
        tools.iter().for_each(|(station, tool)| machining.set_tool(*station, tool));
        let mut obstacles = Vec::new();
        if let Some(chuck) = setup.chuck_outlines()? {
            obstacles.extend([(Obstacle::Jaws, chuck.jaw), (Obstacle::Chuck, chuck.body)]);
        }
        obstacles.extend(setup.tailstock_outline()?.map(|outline| (Obstacle::Tailstock, outline)));
        for (obstacle, outline) in &obstacles {
            machining.add_obstacle(*obstacle, outline).map_err(no_section)?;
        }
        Ok(Some(Self {
            machining,
            plain: None,
            half_planes: None,
            parted: None,
            stock,
            limits: PartLimits::default(),
            moves: 0,
            commands: 0,
            is_full: false,
            notebook,
            edges,
            history: None,
            scenes: None,
            tools,
            noses,
            obstacles,
            watches: Vec::new(),
            target: None,
            rates,
            doubts: Vec::new(),
            has_cut: false,
            is_behind_thread: false,
            thread_ways: ThreadWays::default(),
        }))
    }

    /// Ends the machining elsewhere than at [`PART_MOVES_MAX`] and [`SLABS_MAX`].
    #[must_use]
    pub fn with_limits(self, limits: PartLimits) -> Self {
        Self { limits, ..self }
    }

    /// Looks whether the figures that the program finishes are cut too deep, or keep material.
    #[must_use]
    pub fn with_figures(mut self, figures: &[Figure]) -> Self {
        for figure in figures {
            let Some((watch, guard)) = Watch::of_figure(figure, self.machining.section()) else { continue };
            self.watches.push(watch);
            self.machining.add_guard(guard);
        }
        self
    }

    /// Holds the part against a target when it is finished; before the first command.
    #[must_use]
    pub fn with_target(mut self, target: Target) -> Self {
        let first = self.watches.len();
        if let Target::Drawing(drawing) = &target {
            let (watch, guard) = Watch::of_drawing(drawing, self.machining.section());
            self.watches.push(watch);
            self.machining.add_guard(guard);
        }
        self.target = Some((target, first));
        self
    }

    /// Keeps what the moments of findings look like.
    #[must_use]
    pub fn with_scenes(mut self) -> Self {
        self.machining.keep_struck(STRUCK_MAX);
        Self { scenes: Some(Vec::new()), ..self }
    }

    /// Keeps the section along the program.
    #[must_use]
    pub fn with_history(mut self) -> Self {
        self.history = Some(History::new(self.machining.section()));
        self
    }

    /// Cuts a command out of the stock; what it took away, unless nothing more is cut.
    pub fn add(&mut self, command: &Command) -> Option<Removed> {
        if self.is_full {
            return None;
        }
        let is_move =
            matches!(command.action, Action::Rapid { .. } | Action::Feed { .. } | Action::Thread { .. });
        if is_move && self.moves == self.limits.moves {
            self.end_at(command);
            return None;
        }
        if matches!(command.action, Action::Thread { .. }) && self.plain.is_none() {
            self.plain = Some(Box::new(self.machining.only_cutting()));
            self.half_planes = Some(Box::new(HalfPlanes::new(&self.machining)));
        }
        if let Some(half_planes) = &mut self.half_planes {
            half_planes.add(command, &self.machining);
        }
        self.moves += u64::from(is_move);
        if let Action::Tool { tool, .. } = command.action {
            self.notebook.tool = tool;
        }
        let may_doubt = self.has_cut && !self.is_behind_thread && self.doubts.len() < DOUBTS_MAX;
        self.is_behind_thread = matches!(command.action, Action::Thread { .. });
        let Self { machining, notebook, edges, history, commands, watches, doubts, .. } = self;
        for (watch, guard) in watches.iter().zip(machining.guards_mut()) {
            guard.watch(watch.counts(command));
        }
        let from = machining.at();
        let (parted, told) = (machining.parted(), notebook.marks.len());
        match (&command.action, &self.plain) {
            (Action::Thread { to, .. }, Some(plain)) => {
                self.thread_ways.add(command, middle(plain.at()), middle(*to), plain.section());
            }
            _ if is_move => self.thread_ways.finish_chain(),
            _ => {}
        }
        let removed = machining.advance(command, &mut |event| {
            if notebook.has_stock || event.kind != EventKind::RapidIntoStock {
                notebook.tell(&event, *commands);
            } else if may_doubt {
                let tool = notebook.tool;
                doubts.push(Doubt { from, command: command.clone(), number: *commands, tool });
            }
        });
        self.has_cut |= removed.bounds.is_some();
        if let Some(scenes) = &mut self.scenes {
            let before = machining.take_struck();
            for (index, mark) in notebook.marks.iter().enumerate().skip(told) {
                let before = before.clone().filter(|_| mark.key == "rapid-into-stock");
                let way = || way_of(command, from, machining.at(), self.rates);
                Scene::note(scenes, (index, mark), before, machining.section(), way);
            }
        }
        if machining.parted() != parted {
            self.parted = Some(*commands);
            if let Some(half_planes) = &mut self.half_planes {
                half_planes.end();
            }
        }
        for (watch, guard) in watches.iter_mut().zip(machining.guards_mut()) {
            watch.note(guard, from, command, (*commands, notebook.tool));
        }
        if !edges.is_idle() {
            let ends = (from, machining.at());
            edges.add((command, *commands), notebook.tool, ends, &removed, machining.section());
        }
        if let (Action::Feed { .. }, Some(bounds)) = (&command.action, removed.bounds) {
            self.thread_ways.note_cut(bounds);
        }
        if let Some(history) = history {
            history.add(*commands, &removed, machining.section());
            if let Some(piece) = machining.take_fallen() {
                history.add_fallen(*commands, &piece);
            }
        }
        if let Some(plain) = &mut self.plain {
            // Where the grooves are not cut, a rapid out of one would cut it.
            let is_in_thread = |mark: &ThreadMark| {
                let (from, to) = (mark.bounds.min.z - mark.lead_mm, mark.bounds.max.z + mark.lead_mm);
                removed.bounds.is_none_or(|bounds| from < bounds.min.z && bounds.max.z < to)
            };
            match command.action {
                Action::Thread { .. } => plain.pass_over(command),
                Action::Rapid { .. } if machining.threads().iter().any(is_in_thread) => {
                    plain.pass_over(command);
                }
                _ => drop(plain.advance(command, &mut |_| {})),
            }
        }
        self.commands += 1;
        if self.commands.is_multiple_of(COMMANDS_PER_LOOK)
            && self.machining.section().slab_count() > self.limits.slabs
        {
            self.end_at(command);
        }
        Some(removed)
    }

    /// Cuts nothing more, and says so.
    fn end_at(&mut self, command: &Command) {
        self.is_full = true;
        let note = Diagnostic::new(Severity::Note, "part-incomplete");
        self.notebook.findings.push(note.at(place_of(&command.origin)));
    }

    /// Tells of rapids that pass through the finished part: that was there all the time, whatever the stock was.
    fn settle_doubts(&mut self) {
        let Some(first) = self.doubts.first() else { return };
        let part = self.machining.part().clone();
        let mut again = Machining::new(part, first.from, self.rates).sparing_at_rapid();
        self.tools.iter().for_each(|(station, tool)| again.set_tool(*station, tool));
        let notebook = &mut self.notebook;
        for Doubt { from, command, number, tool } in self.doubts.drain(..) {
            for ahead in [Action::Tool { tool, offset: 0 }, Action::Relocate { to: from, others: None }] {
                again.pass_over(&Command::new(ahead, command.origin));
            }
            notebook.tool = tool;
            again.advance(&command, &mut |event| {
                let is_deep =
                    event.contact.is_some_and(|contact| contact.depth_mm >= CERTAIN_MM - ROUNDING_MM);
                if event.kind == EventKind::RapidIntoStock && is_deep {
                    notebook.tell(&event, number);
                }
            });
        }
    }

    /// Whether nothing more is cut, because there was too much of it.
    pub const fn is_full(&self) -> bool {
        self.is_full
    }

    /// The program is over.
    pub fn finish(mut self) -> Part {
        if let Some(history) = &mut self.history {
            history.finish(self.machining.section());
        }
        self.settle_doubts();
        let faults = self.edges.finish(self.machining.section(), self.machining.part());
        faults.iter().for_each(|fault| self.notebook.tell_fault(fault));
        let plain = self.plain.as_deref().unwrap_or(&self.machining);
        for watch in &self.watches {
            let Some(figure) = watch.figure() else { continue };
            self.notebook.gouged(&watch.losses);
            let nose_mm = self.noses.get(&figure.tool).copied().unwrap_or(0.0);
            if !self.is_full && self.notebook.knows(figure.tool) {
                self.notebook.not_reached(figure, plain.part(), nose_mm, self.commands);
            }
        }
        // What is told at the end the finished part shows.
        let mut scenes = self.scenes.take();
        if let Some(scenes) = &mut scenes {
            for (index, mark) in self.notebook.marks.iter().enumerate() {
                if !scenes.iter().any(|scene| scene.mark == index) {
                    Scene::note(scenes, (index, mark), None, self.machining.part(), Vec::new);
                }
            }
            scenes.sort_by_key(|scene| self.notebook.marks[scene.mark].command);
        }
        let aimed = self.target.filter(|_| !self.is_full).map(|(target, first)| {
            let watches = match target {
                Target::Drawing(_) => self.watches.split_off(first),
                Target::Figures(_) => self.watches,
            };
            Aimed { target, watches }
        });
        Part {
            section: self.machining.part().clone(),
            plain: plain.part().clone(),
            aimed,
            stock: self.stock,
            threads: self.machining.threads().to_vec(),
            parted: self.parted,
            half_planes: self.half_planes.and_then(|one| one.finish(&self.machining)).map(Box::new),
            thread_ways: self.thread_ways.finish(self.notebook.has_stock),
            has_stock: self.notebook.has_stock,
            findings: self.notebook.findings,
            marks: self.notebook.marks,
            scenes: scenes.unwrap_or_default(),
            history: self.history,
            tools: self.tools,
            obstacles: self.obstacles,
        }
    }
}

fn middle(at: Position<WorkTip>) -> Point {
    Point { x: at.x.to_mm(), z: at.z.to_mm() }
}

fn place_of(origin: &Origin) -> Place {
    let source = SourceId(origin.source);
    Place { source, line: origin.line, line_offset: u64::MAX, column: 1, end_column: 1 }
}

impl Notebook {
    /// Whether the setup names both the stock and a tool.
    fn knows(&self, tool: u32) -> bool {
        self.has_stock && self.tools.contains(&tool)
    }

    /// Cuts below a figure: of each line the deepest, unless it is told as a crash. Of a tool whose shape is a guess only
    /// the programmed point counts.
    fn gouged(&mut self, losses: &[Loss]) {
        let mut deepest: BTreeMap<BlockLine, (f64, &Loss)> = BTreeMap::new();
        for loss in losses {
            let is_known = self.tools.contains(&loss.tool);
            let depth_mm = if is_known { loss.piece.deviation_mm } else { loss.tip_mm };
            let known = deepest.entry(loss.line).or_insert((0.0, loss));
            if depth_mm > known.0 {
                *known = (depth_mm, loss);
            }
        }
        for (line, (depth_mm, loss)) in deepest {
            let is_crash = self.told.get("rapid-into-stock").is_some_and(|told| told.contains(&line));
            if is_crash || depth_mm <= FIGURE_GOUGE_MM + ROUNDING_MM {
                continue;
            }
            let severity = if self.knows(loss.tool) { Severity::Error } else { Severity::Warning };
            let mark = Mark {
                key: "figure-gouged",
                line: (SourceId(line.0), line.1),
                command: loss.command,
                tool: loss.tool,
                place: loss.piece.place,
                depth_mm,
                bounds: Some(loss.piece.bounds),
            };
            self.note_depth(severity, mark, loss.tool);
        }
    }

    /// What a finished figure keeps although the nose could have reached it.
    fn not_reached(&mut self, figure: &Figure, part: &Section, nose_mm: f64, command: u64) {
        let rests = rest_of_figure(figure, part);
        let Some((depth_mm, place, line)) = deepest_in_reach(figure, &rests, nose_mm) else { return };
        if depth_mm > FIGURE_REST_MM + ROUNDING_MM {
            let line = (SourceId(figure.finishing.0), line);
            let (key, tool) = ("figure-not-reached", figure.tool);
            let mark = Mark { key, line, command, tool, place, depth_mm, bounds: None };
            self.note_depth(Severity::Warning, mark, figure.tool);
        }
    }

    /// A finding at a line, with how deep it is.
    fn note_depth(&mut self, severity: Severity, mark: Mark, tool: u32) {
        let origin = Origin { source: mark.line.0.0, ..Origin::line(mark.line.1) };
        if let Some(finding) = self.note(severity, mark, tool, &origin) {
            *finding = finding.clone().with("depth", millimetres(mark.depth_mm));
        }
    }

    fn tell(&mut self, event: &Event, command: u64) {
        let has_tool = self.tools.contains(&self.tool);
        let judged = |is_known: bool| if is_known { Severity::Error } else { Severity::Warning };
        let is_drag = event.contact.as_ref().is_some_and(|contact| contact.depth_mm < DRAG_MM);
        let (key, severity) = match event.kind {
            EventKind::RapidIntoStock => ("rapid-into-stock", judged(self.has_stock && has_tool && !is_drag)),
            EventKind::BodyIntoStock => ("holder-into-stock", judged(has_tool)),
            EventKind::IntoObstacle(Obstacle::Chuck) => {
                ("tool-into-chuck", judged(self.has_chuck && has_tool))
            }
            EventKind::IntoObstacle(Obstacle::Jaws) => ("tool-into-jaws", judged(self.has_chuck && has_tool)),
            EventKind::IntoObstacle(Obstacle::Tailstock) => {
                ("tool-into-tailstock", judged(self.has_tailstock && has_tool))
            }
            EventKind::SpindleStopped => ("cut-without-spindle", Severity::Warning),
            EventKind::NotTurned => ("part-not-turned", Severity::Note),
            EventKind::CutOff => ("part-cut-off", Severity::Note),
            EventKind::NoShape { .. } => ("tool-without-shape", Severity::Note),
        };
        // A rapid through an assumed stock comes here when it is certain.
        let needs_stock = !matches!(
            event.kind,
            EventKind::RapidIntoStock | EventKind::NotTurned | EventKind::NoShape { .. }
        );
        if needs_stock && !self.has_stock {
            return;
        }
        let contact = event.contact.as_ref();
        let mark = Mark {
            key,
            line: (SourceId(event.origin.source), event.origin.line),
            command,
            tool: self.tool,
            place: event.place,
            depth_mm: contact.map_or(0.0, |contact| contact.depth_mm),
            bounds: contact.map(|contact| contact.bounds),
        };
        let depth = contact.map_or_else(String::new, |contact| millimetres(contact.depth_mm));
        if let Some(finding) = self.note(severity, mark, self.tool, &event.origin) {
            let value = contact.map_or_else(String::new, |contact| size(contact.bounds));
            *finding = finding.clone().with("depth", depth).with("value", value);
        }
    }

    /// What an edge did that it should not.
    fn tell_fault(&mut self, fault: &Fault) {
        let Fault { key, tool, origin, command, place, depth_mm, bounds, angles_deg } = *fault;
        let line = (SourceId(origin.source), origin.line);
        let mark = Mark { key, line, command, tool, place, depth_mm, bounds: Some(bounds) };
        if let Some(finding) = self.note(Severity::Warning, mark, tool, &origin) {
            let (angle, limit) = angles_deg.unwrap_or_default();
            let degrees = |angle: f64| ((angle * 10.0).round() / 10.0).to_string();
            *finding = finding
                .clone()
                .with("depth", millimetres(depth_mm))
                .with("angle", degrees(angle))
                .with("limit", degrees(limit));
        }
    }

    /// A finding with its mark; nothing when it was told of this line, or often enough.
    fn note(
        &mut self,
        severity: Severity,
        mark: Mark,
        tool: u32,
        origin: &Origin,
    ) -> Option<&mut Diagnostic> {
        let told = self.told.entry(mark.key).or_default();
        if told.len() >= FINDINGS_MAX || !told.insert((origin.source, origin.line)) {
            return None;
        }
        let Point { x, z } = mark.place;
        self.marks.push(mark);
        self.findings.push(
            Diagnostic::new(severity, mark.key)
                .at(place_of(origin))
                .with("tool", i64::from(tool))
                .with("x", millimetres(2.0 * x))
                .with("z", millimetres(z)),
        );
        self.findings.last_mut()
    }
}

/// Thousandths of a millimetre.
fn millimetres(mm: f64) -> String {
    // Adding nothing makes minus zero plain.
    ((mm * 1e3).round() / 1e3 + 0.0).to_string()
}

/// Greatest diameter and length.
fn size(bounds: Bounds) -> String {
    format!("⌀{} × {} mm", millimetres(2.0 * bounds.max.x), millimetres(bounds.max.z - bounds.min.z))
}
