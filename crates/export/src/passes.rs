//! The passes of cycles, as a table: number, depth, begin, end, and which word or parameter caused each.
//!
//! In: commands in order of execution, and for each block that runs a cycle what the caller knows of it
//! ([`BlockFacts`]). Out: one [`Cycle`] for each time that a cycle ran.
//!
//! A pass goes from where its first cut begins to where its last one ends. Its depth is counted along X as a radius
//! (along Z when facing) from the start point of the cycle; that of a thread in many passes from the thread's crest.
//!
//! Invariants: memory is bounded by [`PASSES_MAX`]; what lies beyond is counted. Deliberately not here: sentences. A
//! cause is data, and who shows it finds the words.

use std::ops::Range;

use turnwright_canon::{Action, Command, CycleLabel, CycleOrigin, Phase};
use turnwright_units::{Length, Position, Radius, WorkTip};

/// Passes kept in one run of a program.
pub const PASSES_MAX: usize = 20_000;

/// Differences of depths up to this are no differences.
const DEPTH_TOLERANCE_NM: i64 = 1_000;

/// The parameters that a cycle takes what its block does not say from; the name is that of the function.
pub fn parameters_of(function: &str) -> &'static [&'static str] {
    match function {
        "rough-turning" | "rough-facing" => &["cycle-depth-of-cut", "cycle-escape", "cycle-clearance"],
        "pattern-repeating" => &["pattern-relief-x", "pattern-relief-z", "pattern-passes"],
        "face-groove" | "radial-groove" => &["groove-return"],
        "multi-thread" => &[
            "thread-minimum-depth",
            "thread-finishing-allowance",
            "thread-finishing-passes",
            "thread-nose-angle",
        ],
        _ => &[],
    }
}

/// A word of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenWord {
    /// As it was written.
    pub text: String,
    /// The line that holds it, from 1.
    pub line: u32,
}

/// A parameter as a cycle met it.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Its name.
    pub name: &'static str,
    /// Its number on the control.
    pub number: String,
    /// Its value.
    pub value: f64,
    /// The word that wrote it, if one did.
    pub given: Option<GivenWord>,
}

/// What the caller knows of a block that runs a cycle.
#[derive(Clone, Debug, Default)]
pub struct BlockFacts {
    /// Name of the function.
    pub function: String,
    /// Its words: letter and text.
    pub words: Vec<(u8, String)>,
    /// The parameters of [`parameters_of`] that the control has.
    pub settings: Vec<Setting>,
    /// Crest of the thread at its start, of a thread in many passes.
    pub crest: Option<Radius>,
}

/// One run of a cycle. Single cycles that repeat block by block are one run.
#[derive(Clone, Debug)]
pub struct Cycle {
    /// The code as written.
    pub label: CycleLabel,
    /// Name of the function.
    pub function: String,
    /// Which program text.
    pub source: u32,
    /// Line of its first block, from 1.
    pub line: u32,
    /// Where the tool stood before it.
    pub start: Position<WorkTip>,
    /// What its block did not say.
    pub settings: Vec<Setting>,
    /// Its passes, never none.
    pub passes: Vec<Pass>,
    /// Its commands, counted from 0 through the whole program.
    pub commands: Range<u32>,
}

/// One pass.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Its number, from 1, as the commands carry it.
    pub number: u32,
    /// Line of the block that ran it.
    pub line: u32,
    /// What its first cut does.
    pub phase: Phase,
    /// How deep it goes.
    pub depth: Length,
    /// Where its first cut begins.
    pub from: Position<WorkTip>,
    /// Where its last cut ends.
    pub to: Position<WorkTip>,
    /// What made it so.
    pub causes: Vec<Cause>,
}

/// Why a pass is as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A word.
    Word(GivenWord),
    /// A parameter that no word has written, by its number.
    Parameter(String),
    /// Lines of the figure that gave it its shape or ended it, first and last.
    Figure(u32, u32),
}

/// Collects the passes of a run.
#[derive(Clone, Debug)]
pub struct PassRecorder {
    at: Position<WorkTip>,
    commands: u32,
    open: Option<OpenCycle>,
    cycles: Vec<Cycle>,
    kept: usize,
    dropped: u64,
}

/// The cycle in work.
#[derive(Clone, Debug)]
struct OpenCycle {
    cycle: Cycle,
    facts: BlockFacts,
    /// Line that the facts are of.
    line: u32,
    /// Greatest number of a pass so far.
    pass: u32,
    /// The tool is on its way home.
    is_home: bool,
}

impl PassRecorder {
    /// Nothing yet, the tool at `start`.
    pub fn new(start: Position<WorkTip>) -> Self {
        Self { at: start, commands: 0, open: None, cycles: Vec::new(), kept: 0, dropped: 0 }
    }

    /// The next command. `facts` is asked for each block that runs a cycle.
    #[inline]
    pub fn add(&mut self, command: &Command, facts: impl FnOnce(&Command) -> BlockFacts) {
        if command.origin.cycle.is_some() || self.open.is_some() {
            self.add_to_cycle(command, facts);
        }
        self.at = match &command.action {
            Action::Relocate { to, .. } => *to,
            action => action.end_point().unwrap_or(self.at),
        };
        self.commands = self.commands.saturating_add(1);
    }

    /// The cycles that ran, in order, and the number of passes that were too many to keep.
    pub fn finish(mut self) -> (Vec<Cycle>, u64) {
        self.close();
        (self.cycles, self.dropped)
    }

    /// The cycles that have ended so far.
    pub fn cycles(&self) -> &[Cycle] {
        &self.cycles
    }

    #[cold]
    fn add_to_cycle(&mut self, command: &Command, facts: impl FnOnce(&Command) -> BlockFacts) {
        let Some(made) = command.origin.cycle else { return self.close() };
        if self.open.as_ref().is_some_and(|open| !open.goes_on(command, made)) {
            self.close();
        }
        let line = command.origin.line;
        let open = match &mut self.open {
            Some(open) => {
                if open.line != line {
                    (open.facts, open.line) = (facts(command), line);
                }
                open
            }
            None => {
                let facts = facts(command);
                let cycle = Cycle {
                    label: made.label,
                    function: facts.function.clone(),
                    source: command.origin.source,
                    line,
                    start: self.at,
                    settings: facts.settings.clone(),
                    passes: Vec::new(),
                    commands: self.commands..self.commands,
                };
                self.open.insert(OpenCycle { cycle, facts, line, pass: 0, is_home: false })
            }
        };
        open.pass = open.pass.max(made.pass);
        open.is_home = made.phase == Phase::Home;
        open.cycle.commands.end = self.commands.saturating_add(1);
        if !cuts(made.phase) {
            return;
        }
        let Some(to) = command.action.end_point() else { return };
        if open.cycle.passes.last().is_none_or(|last| last.number != made.pass) {
            if self.kept == PASSES_MAX {
                self.dropped += 1;
                return;
            }
            self.kept += 1;
        }
        open.add(command, made, self.at, to);
    }

    fn close(&mut self) {
        let Some(mut open) = self.open.take() else { return };
        if !open.cycle.passes.is_empty() {
            open.cycle.explain_thread(&open.facts);
            self.cycles.push(open.cycle);
        }
    }
}

/// Whether a move of this phase cuts what the pass is for.
const fn cuts(phase: Phase) -> bool {
    matches!(
        phase,
        Phase::Cut | Phase::Contour | Phase::Finish | Phase::Peck | Phase::Thread | Phase::Chamfer
    )
}

impl OpenCycle {
    /// Whether a command belongs to the same run of the cycle: its passes are counted on.
    fn goes_on(&self, command: &Command, made: CycleOrigin) -> bool {
        let is_counted_on = if self.is_home && made.phase != Phase::Home || command.origin.line != self.line {
            made.pass > self.pass
        } else {
            made.pass >= self.pass || made.phase == Phase::Home
        };
        is_counted_on && made.label == self.cycle.label && command.origin.source == self.cycle.source
    }

    fn add(&mut self, command: &Command, made: CycleOrigin, from: Position<WorkTip>, to: Position<WorkTip>) {
        let figure = command.origin.figure_line;
        let at_end = depth_at(&self.cycle.function, made.phase) == DepthAt::End;
        let depth = match self.facts.crest {
            Some(crest) => (crest - from.x).0.abs(),
            None => self.cycle.depth(if at_end { to } else { from }),
        };
        if let Some(last) = self.cycle.passes.last_mut().filter(|last| last.number == made.pass) {
            last.to = to;
            if at_end {
                last.depth = last.depth.max(depth);
            }
            if let Some(line) = figure {
                last.reaches(line);
            }
            return;
        }
        let mut causes: Vec<Cause> = self.cause(made.phase).into_iter().collect();
        causes.extend(figure.map(|line| Cause::Figure(line, line)));
        self.cycle.passes.push(Pass {
            number: made.pass,
            line: command.origin.line,
            phase: made.phase,
            depth,
            from,
            to,
            causes,
        });
    }

    /// The word or parameter that decides how deep a pass goes. What decides it of a thread shows at its end.
    fn cause(&self, phase: Phase) -> Option<Cause> {
        let word = |letters: &[u8]| letters.iter().find_map(|letter| self.facts.word(*letter, self.line));
        match (self.cycle.function.as_str(), phase) {
            ("rough-turning" | "rough-facing", Phase::Cut) => {
                word(b"D").or_else(|| self.facts.setting("cycle-depth-of-cut"))
            }
            ("pattern-repeating", _) => word(b"D").or_else(|| self.facts.setting("pattern-passes")),
            ("face-groove", _) => word(b"QK"),
            ("radial-groove", _) => word(b"PI"),
            ("turning-cycle" | "thread-cycle", _) => word(b"XU"),
            ("facing-cycle", _) => word(b"ZW"),
            (function, Phase::Peck) if function.ends_with("-with-retract") => word(b"R"),
            (_, Phase::Peck) => word(b"Q"),
            _ => None,
        }
    }
}

/// Where the depth of a pass is measured.
#[derive(PartialEq, Eq)]
enum DepthAt {
    Begin,
    End,
}

/// Passes along the work have their depth from their first cut on; those into the work reach it at their end.
fn depth_at(function: &str, phase: Phase) -> DepthAt {
    let is_hole = ["-drilling", "-tapping", "-boring"].iter().any(|end| function.contains(end));
    if is_hole || phase == Phase::Peck || function.ends_with("-groove") {
        DepthAt::End
    } else {
        DepthAt::Begin
    }
}

impl BlockFacts {
    fn word(&self, letter: u8, line: u32) -> Option<Cause> {
        let (_, text) = self.words.iter().find(|(address, _)| *address == letter)?;
        Some(Cause::Word(GivenWord { text: text.clone(), line }))
    }

    fn setting(&self, name: &str) -> Option<Cause> {
        let setting = self.settings.iter().find(|setting| setting.name == name)?;
        Some(setting.given.clone().map_or_else(|| Cause::Parameter(setting.number.clone()), Cause::Word))
    }

    fn value(&self, name: &str) -> Length {
        let setting = self.settings.iter().find(|setting| setting.name == name);
        Length::from_nm((setting.map_or(0.0, |setting| setting.value) * 1e6).round() as i64)
    }
}

impl Pass {
    /// Takes a figure line into its range.
    fn reaches(&mut self, line: u32) {
        for cause in &mut self.causes {
            if let Cause::Figure(_, last) = cause {
                *last = line;
                return;
            }
        }
        self.causes.push(Cause::Figure(line, line));
    }
}

impl Cycle {
    /// The part of the run that blocks of this line made; `None` when they made none.
    pub fn of_line(&self, line: u32) -> Option<Self> {
        let passes: Vec<Pass> = self.passes.iter().filter(|pass| pass.line == line).cloned().collect();
        (!passes.is_empty()).then(|| Self { passes, line, ..self.clone() })
    }

    /// How far a place is from the start point in the direction that the cycle works in.
    fn depth(&self, place: Position<WorkTip>) -> Length {
        let way = place - self.start;
        let is_along_z = self.function.contains("facing") || self.function.starts_with("face-");
        if is_along_z { way.z.abs() } else { way.x.0.abs() }
    }

    /// Depths of a thread fall by the first one, not below the least one, and end at the height.
    fn explain_thread(&mut self, facts: &BlockFacts) {
        if !matches!(self.function.as_str(), "multi-thread" | "enhanced-thread" | "enhanced-thread-980") {
            return;
        }
        let near = |a: Length, b: Length| (a - b).nm().abs() <= DEPTH_TOLERANCE_NM;
        let Some(full) = self.passes.last().map(|last| last.depth) else { return };
        let (least, line) = (facts.value("thread-minimum-depth"), self.line);
        let allowance = facts.value("thread-finishing-allowance");
        let word = |letters: &[u8]| letters.iter().find_map(|letter| facts.word(*letter, line));
        let mut before = Length::ZERO;
        for (index, pass) in self.passes.iter_mut().enumerate() {
            let cause = if index == 0 {
                word(b"DQ")
            } else if near(pass.depth, before) {
                facts.setting("thread-finishing-passes")
            } else if near(pass.depth, full) {
                word(b"KP")
            } else if near(pass.depth + allowance, full) {
                facts.setting("thread-finishing-allowance")
            } else if near(pass.depth - before, least) {
                facts.setting("thread-minimum-depth")
            } else {
                word(b"DQ")
            };
            pass.causes.extend(cause);
            before = pass.depth;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turnwright_canon::{Origin, RapidPath, Shape};
    use turnwright_units::{Feed, FeedPerRevolution};

    fn at(diameter_mm: i32, z_mm: i32) -> Position<WorkTip> {
        Position::new(Radius(Length::from_mm(diameter_mm).half()), Length::from_mm(z_mm))
    }

    fn command(cut: bool, to: Position<WorkTip>, line: u32, pass: u32, phase: Phase) -> Command {
        let cycle = Some(CycleOrigin { label: CycleLabel(900), pass, phase });
        let action = if cut {
            let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(200_000)));
            Action::Feed { to, shape: Shape::Line, feed, others: None }
        } else {
            Action::Rapid { to, path: RapidPath::EachAxis, others: None }
        };
        Command::new(action, Origin { cycle, ..Origin::line(line) })
    }

    fn facts(command: &Command) -> BlockFacts {
        BlockFacts {
            function: "turning-cycle".to_string(),
            words: vec![(b'X', format!("X{}.", 50 - 10 * command.origin.line))],
            ..BlockFacts::default()
        }
    }

    fn single_cycle(recorder: &mut PassRecorder, line: u32, pass: u32) {
        let diameter_mm = 50 - 10 * line as i32;
        recorder.add(&command(false, at(diameter_mm, 2), line, pass, Phase::Infeed), facts);
        recorder.add(&command(true, at(diameter_mm, -20), line, pass, Phase::Cut), facts);
        recorder.add(&command(true, at(50, -20), line, pass, Phase::Out), facts);
        recorder.add(&command(false, at(50, 2), line, pass, Phase::Home), facts);
    }

    #[test]
    fn single_cycles_that_follow_each_other_are_one_table_with_a_word_for_each() {
        let mut recorder = PassRecorder::new(at(50, 2));
        single_cycle(&mut recorder, 1, 1);
        single_cycle(&mut recorder, 2, 2);
        let (cycles, dropped) = recorder.finish();
        assert_eq!((cycles.len(), dropped), (1, 0));
        let cycle = &cycles[0];
        assert_eq!((cycle.line, cycle.commands.clone()), (1, 0..8));
        let depths: Vec<_> = cycle.passes.iter().map(|pass| (pass.number, pass.depth)).collect();
        assert_eq!(depths, [(1, Length::from_mm(5)), (2, Length::from_mm(10))]);
        let word = |text: &str, line| vec![Cause::Word(GivenWord { text: text.to_string(), line })];
        assert_eq!(cycle.passes[0].causes, word("X40.", 1));
        assert_eq!(cycle.passes[1].causes, word("X30.", 2));
        assert_eq!((cycle.passes[1].from, cycle.passes[1].to), (at(30, 2), at(30, -20)));
        let second = cycle.of_line(2).expect("a pass");
        assert_eq!((second.passes.len(), second.line), (1, 2));
        assert!(cycle.of_line(3).is_none());
    }

    #[test]
    fn a_cycle_that_runs_again_has_a_table_of_its_own() {
        let mut recorder = PassRecorder::new(at(50, 2));
        for _ in 0..3 {
            single_cycle(&mut recorder, 1, 1);
        }
        let (cycles, _) = recorder.finish();
        let commands: Vec<_> = cycles.iter().map(|cycle| cycle.commands.clone()).collect();
        assert_eq!(commands, [0..4, 4..8, 8..12]);
    }

    #[test]
    fn passes_beyond_the_limit_are_counted() {
        let mut recorder = PassRecorder::new(at(50, 2));
        for _ in 0..PASSES_MAX + 3 {
            single_cycle(&mut recorder, 1, 1);
        }
        let (cycles, dropped) = recorder.finish();
        assert_eq!((cycles.len(), dropped), (PASSES_MAX, 3));
    }
}
