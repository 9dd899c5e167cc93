//! What an edit changed in what a program does: its passes, its rapids, its other commands.
//!
//! In: the commands of two programs. Out: what was added, removed, or is otherwise now, with the lines in both. Line
//! numbers, sequence numbers, comments and the way a move is written make no difference.
//!
//! A pass is what a cycle numbers, else an unbroken run of cuts. In a stretch of both programs that differs, passes of the
//! same tool stand for each other in order.
//!
//! Invariant: comparing the other way round gives the same changes with old and new exchanged; memory is bounded by
//! [`COMMANDS_MAX`].

use std::collections::HashMap;

use turnwright_canon::{Action, Command, CycleLabel, SectionPlace};
use turnwright_units::{Position, WorkTip};

use crate::alignment::hunks;

/// Commands that are compared; of longer programs the rest is not looked at.
pub const COMMANDS_MAX: usize = 1_000_000;

/// What a step of a program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StepKind {
    /// Cuts.
    Pass,
    /// One rapid.
    Rapid,
    /// Anything else: tool, spindle, dwell, coolant, M code.
    Other,
}

/// A pass, a rapid, or another command.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Which.
    pub kind: StepKind,
    /// The line of its first command, from 1.
    pub line: u32,
    /// The tool.
    pub tool: Option<u32>,
    /// The cycle, and the number of the pass in it.
    pub cycle: Option<(CycleLabel, u32)>,
    /// Where it begins.
    pub from: Position<WorkTip>,
    /// What is done, in order.
    pub actions: Vec<Action>,
}

impl Step {
    /// Where it leads.
    fn ends(&self) -> impl Iterator<Item = Position<WorkTip>> + '_ {
        self.actions.iter().filter_map(Action::end_point)
    }
}

/// The steps of a program.
#[derive(Clone, Debug)]
pub struct Steps {
    steps: Vec<Step>,
    at: Position<WorkTip>,
    place: SectionPlace,
    tool: Option<u32>,
    commands: usize,
}

impl Steps {
    /// None yet, the tool at `start`.
    pub fn new(start: Position<WorkTip>) -> Self {
        Self { steps: Vec::new(), at: start, place: SectionPlace::default(), tool: None, commands: 0 }
    }

    /// The next command.
    pub fn add(&mut self, command: &Command) {
        self.commands += 1;
        if self.commands > COMMANDS_MAX {
            return;
        }
        let from = self.at;
        if let Some(end) = self.place.end_of(&command.action) {
            self.at = end;
        }
        if let Action::Relocate { to, .. } = &command.action {
            self.at = *to;
        }
        if let Action::Tool { tool, .. } = &command.action {
            self.tool = Some(*tool);
        }
        let kind = match &command.action {
            Action::Feed { .. } | Action::Thread { .. } => StepKind::Pass,
            Action::Rapid { .. } => StepKind::Rapid,
            _ => StepKind::Other,
        };
        let cycle = command.origin.cycle.map(|cycle| (cycle.label, cycle.pass));
        if let Some(step) = self.steps.last_mut()
            && kind == StepKind::Pass
            && step.kind == StepKind::Pass
            && step.cycle == cycle
        {
            step.actions.push(command.action.clone());
            return;
        }
        let actions = vec![command.action.clone()];
        let line = command.origin.line;
        self.steps.push(Step { kind, line, tool: self.tool, cycle, from, actions });
    }

    /// Whether the program is longer than what is compared.
    pub const fn is_cut_short(&self) -> bool {
        self.commands > COMMANDS_MAX
    }
}

/// How a step changed; of one that was only added or removed there is one side.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// As it was.
    pub old: Option<Step>,
    /// As it is now.
    pub new: Option<Step>,
}

/// By how much the ends of a step moved, mm: X as a diameter, and where in the new one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// The greatest change of a diameter.
    pub x_mm: f64,
    /// The Z at which that is.
    pub at_z_mm: f64,
    /// The greatest change along Z.
    pub z_mm: f64,
    /// The diameter at which that is.
    pub at_x_mm: f64,
}

impl Change {
    /// What kind of step it is.
    pub fn kind(&self) -> StepKind {
        self.old.as_ref().or(self.new.as_ref()).map_or(StepKind::Other, |step| step.kind)
    }

    /// How far it moved; nothing when its moves do not stand for each other one by one.
    pub fn moved(&self) -> Option<Moved> {
        let (old, new) = (self.old.as_ref()?, self.new.as_ref()?);
        if old.actions.len() != new.actions.len() {
            return None;
        }
        let mut moved = Moved::default();
        let starts = std::iter::once((old.from, new.from));
        for (a, b) in starts.chain(old.ends().zip(new.ends())) {
            let x = b.x.to_diameter().0.to_mm() - a.x.to_diameter().0.to_mm();
            let z = b.z.to_mm() - a.z.to_mm();
            if x.abs() > moved.x_mm.abs() {
                (moved.x_mm, moved.at_z_mm) = (x, b.z.to_mm());
            }
            if z.abs() > moved.z_mm.abs() {
                (moved.z_mm, moved.at_x_mm) = (z, b.x.to_diameter().0.to_mm());
            }
        }
        Some(moved)
    }
}

/// What changed from one program to another, in order.
pub fn changes(old: &Steps, new: &Steps) -> Vec<Change> {
    let mut names: HashMap<String, u32> = HashMap::new();
    let mut number = |step: &Step| {
        let next = names.len() as u32;
        // Numbers print exactly, so that equal texts are equal steps.
        *names.entry(format!("{:?} {:?} {:?}", step.tool, step.from, step.actions)).or_insert(next)
    };
    let numbers = [old, new].map(|steps| steps.steps.iter().map(&mut number).collect::<Vec<u32>>());
    // The numbers count by first appearance, so that they are the same whichever comes first only after sorting.
    let mut sorted: Vec<(String, u32)> = names.into_iter().collect();
    sorted.sort();
    let mut rank = vec![0; sorted.len()];
    for (index, (_, number)) in sorted.iter().enumerate() {
        rank[*number as usize] = index as u32;
    }
    let [old_ranks, new_ranks] =
        numbers.map(|numbers| numbers.into_iter().map(|number| rank[number as usize]).collect::<Vec<u32>>());
    let mut found = Vec::new();
    for hunk in hunks(&old_ranks, &new_ranks) {
        pair(&old.steps[hunk.first], &new.steps[hunk.second], &mut found);
    }
    found
}

/// Steps of the same kind and tool stand for each other in order; what is left was removed or added.
fn pair(old: &[Step], new: &[Step], found: &mut Vec<Change>) {
    let place = |step: &Step| (step.kind, step.tool);
    let mut taken = vec![false; new.len()];
    let mut partners: HashMap<(StepKind, Option<u32>), std::collections::VecDeque<usize>> = HashMap::new();
    for (index, step) in new.iter().enumerate() {
        partners.entry(place(step)).or_default().push_back(index);
    }
    for step in old {
        let partner = partners.get_mut(&place(step)).and_then(std::collections::VecDeque::pop_front);
        if let Some(index) = partner {
            taken[index] = true;
        }
        found.push(Change { old: Some(step.clone()), new: partner.map(|index| new[index].clone()) });
    }
    let added = new.iter().zip(&taken).filter(|(_, taken)| !**taken);
    found.extend(added.map(|(step, _)| Change { old: None, new: Some(step.clone()) }));
}
