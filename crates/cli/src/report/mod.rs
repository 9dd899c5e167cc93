//! What a run was: gathered once, said in several forms.

pub(crate) mod cutting;
mod human;
mod json;
mod page;
pub(crate) mod sizes;
mod threads;
mod times;

use std::collections::VecDeque;

use turnwright_canon::{Action, Command};
use turnwright_control::{CodeSystem, Control, Language, Machine};
use turnwright_diagnostics::{Argument, Diagnostic, Place, SourceId};
use turnwright_export::formats::times_csv::{write_times_head, write_times_row};
use turnwright_export::part::PartShape;
use turnwright_export::passes::Cycle;
use turnwright_export::path::PathRecorder;
use turnwright_export::timeline::Timeline;
use turnwright_motion::{BlockTimes, Kind, MachineRates, Operation, OperationKind, Schedule, Summary};
use turnwright_stock::Removed;
use turnwright_units::{Length, Position, WorkTip, write_millimetres};
use turnwright_verify::Assumption;
use turnwright_verify::advice::{Advice, Advisor};
use turnwright_verify::cutting::{CuttingData, CuttingRun};
use turnwright_verify::measuring::Judged;
use turnwright_verify::part::Part;

pub(crate) use self::threads::Threads;
pub(crate) use self::times::totals_json;
use crate::finding::Finding;
use crate::operator::panel_sentences;
use crate::part::Meshed;
use crate::session::Session;
use crate::speech::Speech;

/// Time, sums and, when wanted, the path of a program.
#[derive(Debug)]
pub(crate) struct Measure {
    /// Seconds.
    pub(crate) schedule: Schedule,
    /// Operations and extents.
    pub(crate) summary: Summary,
    /// Seconds by block and line.
    pub(crate) blocks: BlockTimes,
    /// The path, for pictures.
    pub(crate) path: Option<PathRecorder>,
    /// Places and speeds over time, for pictures.
    pub(crate) timeline: Option<Timeline>,
    /// The table of times as far as it has not been written.
    pub(crate) table: Option<Vec<u8>>,
    /// What the threads need.
    pub(crate) threads: Threads,
    /// What the commands whose time is not known yet took away.
    removed: VecDeque<Option<Removed>>,
    /// Where time could be saved.
    pub(crate) advisor: Option<Advisor>,
    /// What is asked of tools and spindle.
    pub(crate) cutting: Option<CuttingRun>,
    /// What it found.
    pub(crate) advice: Vec<Advice>,
    rates: MachineRates,
}

/// What is kept of a program besides its sums.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Kept {
    /// The path.
    pub(crate) path: bool,
    /// The picture over time.
    pub(crate) timeline: bool,
    /// The table of times.
    pub(crate) table: bool,
}

impl Measure {
    /// Nothing yet, the tool at `start`.
    pub(crate) fn new(start: Position<WorkTip>, rates: MachineRates, kept: Kept) -> Self {
        let (rapid_x, rapid_z) = (rates.rapid_x_mm_per_min, rates.rapid_z_mm_per_min);
        let mut table = Vec::new();
        write_times_head(&mut table);
        Self {
            schedule: Schedule::new(start, rates),
            summary: Summary::new(),
            blocks: BlockTimes::default(),
            path: kept.path.then(|| PathRecorder::new(start, rapid_x, rapid_z)),
            timeline: kept.timeline.then(Timeline::default),
            table: kept.table.then_some(table),
            threads: Threads::default(),
            removed: VecDeque::new(),
            advisor: None,
            cutting: None,
            advice: Vec::new(),
            rates,
        }
    }

    /// Adds a command and what it took away, when anybody knows.
    #[inline]
    pub(crate) fn add(&mut self, command: Command, removed: Option<Removed>) {
        self.removed.push_back(removed);
        self.schedule.push(command);
        self.take();
    }

    /// No more commands come.
    pub(crate) fn finish(&mut self) {
        self.schedule.finish();
        self.take();
        if let (Some(block), Some(table)) = (self.blocks.finish(), &mut self.table) {
            write_times_row(table, &block);
        }
        self.advice = self.advisor.take().map_or(Vec::new(), Advisor::finish);
    }

    /// What was found about the commands.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = Diagnostic> {
        let place = |source: u32, line: u32| {
            let source = SourceId(source);
            Place { line, line_offset: u64::MAX, column: 1, end_column: 1, source }
        };
        self.threads.findings().into_iter().chain(self.schedule.stray().map(|stray| {
            Diagnostic::alarm("spindle-fluctuation")
                .at(place(stray.source, stray.line))
                .with("ordered", format!("{:.0}", stray.ordered_rpm))
                .with("real", format!("{:.0}", stray.real_rpm))
        }))
    }

    /// Takes the commands whose time is known.
    fn take(&mut self) {
        while let Some((command, timing)) = self.schedule.next_known() {
            let removed = self.removed.pop_front().flatten();
            if let Some(advisor) = &mut self.advisor {
                advisor.add(&command, &timing, removed.as_ref());
            }
            if let Some(cutting) = &mut self.cutting {
                cutting.add(&command, &timing, removed.as_ref());
            }
            if let Some(timeline) = &mut self.timeline {
                if let Action::Tool { tool, .. } = command.action {
                    timeline.call_tool(tool);
                }
                timeline.add(
                    &timing,
                    command.action.end_point().unwrap_or(timing.from),
                    removed.map(|removed| removed.volume_mm3),
                );
            }
            self.summary.add(&command, &timing);
            let operations = self.summary.operations();
            let tool = operations.last().and_then(|operation| operation.tool);
            if let (Some(block), Some(table)) =
                (self.blocks.add(&command, &timing, operations.len(), tool), &mut self.table)
            {
                write_times_row(table, &block);
            }
            self.threads.add(&command, &timing, &self.rates);
            if let Some(path) = &mut self.path {
                path.add(&command, timing.seconds);
            }
        }
    }
}

/// Everything there is to say about a run.
#[derive(Debug)]
pub(crate) struct RunReport {
    /// Name of the program's file.
    pub(crate) file: String,
    /// Control and setup.
    pub(crate) session: Session,
    /// The machine's rates.
    pub(crate) machine: Machine,
    /// Everything found.
    pub(crate) findings: Vec<Finding>,
    /// Time, sums, path.
    pub(crate) measure: Measure,
    /// The cycles that ran, and how many of their passes were too many to keep.
    pub(crate) passes: (Vec<Cycle>, u64),
    /// Decimal places of the least increment.
    pub(crate) decimals: u8,
    /// What was assumed of stock and tools.
    pub(crate) assumptions: Vec<Assumption>,
    /// The part, and how it is drawn; nothing when there is no stock.
    pub(crate) part: Option<(Part, PartShape)>,
    /// It as triangles, when files are written.
    pub(crate) meshed: Meshed,
    /// What is asked of tools and spindle.
    pub(crate) cutting: CuttingData,
    /// The sizes that the setup file asks for, measured.
    pub(crate) judged: Vec<Judged>,
    /// Blocks executed.
    pub(crate) blocks: u64,
    /// The line of the alarm that ended the program.
    pub(crate) stopped_at: Option<u32>,
    /// Files written.
    pub(crate) written: Vec<String>,
    /// Crashes without a picture of their own, when pictures are written.
    pub(crate) not_drawn: usize,
}

/// The parts that the time is split into, and the keys of their names.
pub(crate) const TIME_PARTS: [(Kind, &str); Kind::ALL.len()] = [
    (Kind::Cutting, "cutting"),
    (Kind::Threading, "threading"),
    (Kind::Rapid, "rapid"),
    (Kind::Dwell, "dwell"),
    (Kind::ToolChange, "tool_change"),
    (Kind::Spindle, "spindle"),
    (Kind::SpindleWait, "spindle_wait"),
    (Kind::Stop, "stop"),
    (Kind::Loading, "loading"),
    (Kind::Other, "other"),
];

impl RunReport {
    fn millimetres(&self, length: Length) -> String {
        let mut out = Vec::new();
        write_millimetres(&mut out, length, self.decimals);
        String::from_utf8_lossy(&out).into_owned()
    }

    /// X (as a diameter) and Z of the cutting moves: from, to.
    fn cutting_extents(&self) -> Option<[[String; 2]; 2]> {
        let extents = self.measure.summary.cutting_extents()?;
        let mm = |length| self.millimetres(length);
        Some([
            [mm(extents.x_min.to_diameter().0), mm(extents.x_max.to_diameter().0)],
            [mm(extents.z_min), mm(extents.z_max)],
        ])
    }

    fn setup_name(&self) -> Option<String> {
        self.session.setup_path.as_ref().map(|path| path.display().to_string())
    }
}

/// What a machinist would call an operation.
pub(crate) fn operation_name(operation: &Operation, control: &Control, speech: Speech) -> String {
    let label = operation.label.map(|label| label.0);
    let of_code =
        label.and_then(|code| speech.functions().by_code(code, code_system(control), control.code_table));
    match (of_code, operation.kind) {
        (Some((_, entry)), _) => entry.name(speech.language).to_string(),
        (None, OperationKind::Standing) => speech.get("operation-standing").to_string(),
        (None, OperationKind::Positioning) => speech.get("operation-positioning").to_string(),
        (None, OperationKind::Turning) => speech.get("operation-turning").to_string(),
        (None, OperationKind::Drilling) => speech.get("operation-drilling").to_string(),
        (None, OperationKind::Threading) => speech.get("operation-threading").to_string(),
    }
}

/// The code table that a control uses with its present parameters.
pub(crate) fn code_system(control: &Control) -> CodeSystem {
    if control.parameters.bit("g-code-system-c") {
        CodeSystem::C
    } else if control.parameters.bit("g-code-system-b") {
        CodeSystem::B
    } else {
        CodeSystem::A
    }
}

/// The language of pictures and reports.
pub(crate) const fn picture_language(language: Language) -> turnwright_export::Language {
    match language {
        Language::English => turnwright_export::Language::English,
        Language::Chinese => turnwright_export::Language::Chinese,
    }
}

/// What was assumed, in a sentence.
pub(crate) fn assumption_text(assumption: &Assumption, speech: Speech) -> String {
    let values: Vec<(&str, String)> = assumption
        .arguments
        .iter()
        .map(|(name, value)| {
            let value = match value {
                Argument::Text(text) => text.to_string(),
                Argument::Integer(number) => number.to_string(),
                Argument::Length(length) => length.to_string(),
                Argument::Function(key) => key.to_string(),
            };
            (*name, value)
        })
        .collect();
    let values: Vec<(&str, &str)> = values.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let text = speech.fill(assumption.words, &values);
    match assumption.line {
        Some(line) => speech.fill("assumed-at-line", &[("text", &text), ("line", &line.to_string())]),
        None => text,
    }
}

/// What the times rest on, sentence by sentence.
fn estimates(measure: &Measure, speech: Speech) -> impl Iterator<Item = (&'static str, String)> {
    let always = measure
        .schedule
        .estimates()
        .iter()
        .map(move |key| (*key, speech.fill(&format!("estimate-{key}"), &[])));
    panel_sentences(&measure.rates, speech).into_iter().chain(always)
}
