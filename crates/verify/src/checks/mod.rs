//! Checks of a whole program: what the control would run without a word, and a machinist would not.
//!
//! One file a check; its head comment is the manual entry: the pattern, why it hurts, how to mend it. The interpreter
//! warns of what one block shows by itself; a check follows the program, or needs the setup.

mod bar_whip;
mod chuck_speed;
mod cycle_leads_away;
mod drill_direction;
mod feed_mode;
mod feed_size;
mod grip_force;
mod groove_step;
mod intermediate_point;
mod offset_cancel;
mod offset_number;
mod overhang;
mod preset_with_limit;
mod spindle_turn;
mod stop_in_cut;
mod thread_speed;
mod tool_change;
mod turning_speeds;
mod unfinished_figure;
mod without_offset;

use std::collections::BTreeSet;

use turnwright_canon::{Action, Command, Origin, SpindleSpeed, SpindleState};
use turnwright_control::{Setup, Tool};
use turnwright_diagnostics::{Argument, Diagnostic, Place, Severity, SourceId};
use turnwright_geometry::Bounds;
use turnwright_units::{Position, Rpm, WorkTip};

use crate::{Inference, Inferred};

/// Findings of one check; more of the same say nothing new.
pub(crate) const FINDINGS_MAX: usize = 20;

/// Where things stand when a command comes.
#[derive(Clone, Copy, Debug)]
struct State {
    /// The tip.
    at: Position<WorkTip>,
    station: Option<u32>,
    offset: u32,
    spindle: SpindleState,
    speed: Option<SpindleSpeed>,
    rpm_max: Option<Rpm>,
    /// A part of the program has run.
    has_cut: bool,
}

/// What is known when the program has ended.
struct Scene<'a> {
    setup: &'a Setup,
    tools: std::collections::BTreeMap<u32, Tool>,
    /// Of the stock.
    stock: Option<Bounds>,
}

impl Scene<'_> {
    /// Whether the tip is nearer to the stock than this.
    fn is_near_stock(&self, tip: Position<WorkTip>, margin_mm: f64) -> bool {
        self.stock.is_some_and(|stock| {
            tip.x.to_mm() < stock.max.x + margin_mm && tip.z.to_mm() < stock.max.z + margin_mm
        })
    }
}

/// What a check has to say.
#[derive(Debug, Default)]
struct Report {
    findings: Vec<Diagnostic>,
    said: BTreeSet<(&'static str, u32, u32)>,
}

impl Report {
    /// A warning at the line of a command; once for each line.
    fn warn(&mut self, key: &'static str, origin: &Origin, arguments: Vec<(&'static str, Argument)>) {
        self.tell(Diagnostic::warning(key), origin, arguments);
    }

    /// A note likewise: nothing need be wrong.
    fn note(&mut self, key: &'static str, origin: &Origin) {
        self.tell(Diagnostic::new(Severity::Note, key), origin, Vec::new());
    }

    fn tell(&mut self, told: Diagnostic, origin: &Origin, arguments: Vec<(&'static str, Argument)>) {
        let key = told.key;
        let of_key = self.said.iter().filter(|(known, ..)| *known == key).count();
        if of_key >= FINDINGS_MAX || !self.said.insert((key, origin.source, origin.line)) {
            return;
        }
        let source = SourceId(origin.source);
        let place = Place { source, line: origin.line, line_offset: u64::MAX, column: 1, end_column: 1 };
        let mut diagnostic = told.at(place);
        diagnostic.arguments = arguments;
        self.findings.push(diagnostic);
    }

    /// A warning about the whole program.
    fn warn_program(&mut self, key: &'static str, arguments: Vec<(&'static str, Argument)>) {
        let mut diagnostic = Diagnostic::warning(key);
        diagnostic.arguments = arguments;
        self.findings.push(diagnostic);
    }
}

/// One check.
trait Check {
    /// A move; `state` is as before it.
    fn on_move(&mut self, command: &Command, state: &State, report: &mut Report) {
        let _ = (command, state, report);
    }

    /// Any other command.
    fn on_other(&mut self, command: &Command, state: &State, report: &mut Report) {
        let _ = (command, state, report);
    }

    /// The program is over.
    fn at_end(&mut self, scene: &Scene<'_>, report: &mut Report) {
        let _ = (scene, report);
    }
}

/// All checks over one program.
pub struct Checks {
    inference: Inference,
    state: State,
    report: Report,
    /// Those that look at moves; a program has many.
    of_moves: Vec<Box<dyn Check>>,
    of_others: Vec<Box<dyn Check>>,
}

impl std::fmt::Debug for Checks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Checks")
            .field("state", &self.state)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

/// What all checks found, and the setup they went by.
#[derive(Debug)]
pub struct Checked {
    /// In the order of their finding.
    pub findings: Vec<Diagnostic>,
    /// The setup with what the program shows.
    pub inferred: Inferred,
}

impl Checks {
    /// All checks, the tool at `start`.
    pub fn new(start: Position<WorkTip>) -> Self {
        let state = State {
            at: start,
            station: None,
            offset: 0,
            spindle: SpindleState::Stop,
            speed: None,
            rpm_max: None,
            has_cut: false,
        };
        let of_moves: Vec<Box<dyn Check>> = vec![
            Box::<bar_whip::BarWhip>::default(),
            Box::<cycle_leads_away::CycleLeadsAway>::default(),
            Box::<drill_direction::DrillDirection>::default(),
            Box::<feed_mode::FeedMode>::default(),
            Box::<feed_size::FeedSize>::default(),
            Box::<grip_force::GripForce>::default(),
            Box::<groove_step::GrooveStep>::default(),
            Box::<intermediate_point::IntermediatePoint>::default(),
            Box::<spindle_turn::SpindleTurn>::default(),
            Box::<stop_in_cut::StopInCut>::default(),
            Box::<thread_speed::ThreadSpeed>::default(),
            Box::<unfinished_figure::UnfinishedFigure>::default(),
            Box::<without_offset::WithoutOffset>::default(),
        ];
        let of_others: Vec<Box<dyn Check>> = vec![
            Box::<chuck_speed::ChuckSpeed>::default(),
            Box::<offset_cancel::OffsetCancel>::default(),
            Box::new(offset_number::OffsetNumber),
            Box::new(overhang::Overhang),
            Box::<preset_with_limit::PresetWithLimit>::default(),
            Box::<tool_change::ToolChange>::default(),
        ];
        let report = Report::default();
        Self { inference: Inference::new(start), state, report, of_moves, of_others }
    }

    /// Looks at a command.
    #[inline]
    pub fn add(&mut self, command: &Command) {
        self.inference.add(command);
        match &command.action {
            Action::Rapid { to, .. } | Action::Feed { to, .. } | Action::Thread { to, .. } => {
                for check in &mut self.of_moves {
                    check.on_move(command, &self.state, &mut self.report);
                }
                self.state.at = *to;
                self.state.has_cut |= !matches!(command.action, Action::Rapid { .. });
            }
            _ => self.other(command),
        }
    }

    #[cold]
    fn other(&mut self, command: &Command) {
        for check in self.of_moves.iter_mut().chain(&mut self.of_others) {
            check.on_other(command, &self.state, &mut self.report);
        }
        match &command.action {
            Action::Relocate { to, .. } => self.state.at = *to,
            Action::Tool { tool, offset } => {
                self.state.station = Some(*tool);
                self.state.offset = *offset;
            }
            Action::Spindle { state, speed, rpm_max } => {
                self.state.spindle = *state;
                self.state.speed = Some(*speed);
                self.state.rpm_max = *rpm_max;
            }
            _ => {}
        }
    }

    /// What was found, by the given setup and what the program shows beside it.
    pub fn finish(mut self, given: &Setup) -> Checked {
        let inferred = self.inference.finish(given);
        let scene = Scene {
            setup: &inferred.setup,
            tools: inferred.setup.tools().unwrap_or_default(),
            stock: inferred.setup.stock_outline().ok().flatten().map(|stock| stock.bounds()),
        };
        for check in self.of_moves.iter_mut().chain(&mut self.of_others) {
            check.at_end(&scene, &mut self.report);
        }
        drop(scene);
        Checked { findings: self.report.findings, inferred }
    }
}
