//! The setup that a program seems to be written for.
//!
//! In: every command of the program. Out: the given setup with stock, chuck and tools added where it says nothing, and
//! an [`Assumption`] for each thing that was added. Nothing that was given is changed.
//!
//! How it is read: the stock is as thick as the highest X that is fed to; its face is where facing cuts are, else Z0;
//! it is as long as the deepest cut and the jaws ask for. A tool that makes threads is a threading tool, one that
//! cuts on the spindle axis alone drills, one that plunges and comes straight back grooves, one that gets away from
//! its cuts towards the axis bores; the others turn, with the widest insert that reaches down the steepest falling
//! stretch. Noses that no offset gives are taken as sharp, so that the part shows the programmed contour.

mod observation;

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command};
use turnwright_control::{Chuck, Hand, Offset, Setup, Stock, ToolEntry, ToolKind, ToolSide};
use turnwright_diagnostics::Argument;
use turnwright_units::{Position, WorkTip};

use self::observation::Observation;
use crate::figures::{FigureSearch, Figures};

/// Tools that are told apart; turrets have fewer stations.
const TOOLS_MAX: usize = 100;

/// How much of the stock is in the jaws, mm.
const GRIP_MM: f64 = 20.0;

/// From the deepest cut to the jaws, mm.
const FREE_MM: f64 = 5.0;

/// Widths that blades have, mm.
const BLADES_MM: [f64; 9] = [1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// Diameters that boring bars have, mm.
const BARS_MM: [f64; 9] = [6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0];

/// Turning inserts from strong to slim, outside and inside: how steeply they can go down, degrees, and the entering
/// angle they are held at.
const INSERTS: [(f64, &str, &str, f64); 4] = [
    (4.0, "CNMG120404", "CCMT060204", 95.0),
    (31.0, "DNMG150404", "DCMT070204", 93.0),
    (51.0, "VNMG160404", "VCMT110304", 93.0),
    (90.0, "VNMG160404", "VCMT110304", 72.5),
];

/// Something that was taken from the program because the setup does not say it.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumption {
    /// Section of the setup file: `stock`, `chuck`, `tools.3`.
    pub section: String,
    /// Key in that section.
    pub key: &'static str,
    /// Name of the sentence that says what was assumed, and why.
    pub words: &'static str,
    /// Values for the sentence.
    pub arguments: Vec<(&'static str, Argument)>,
    /// The line of the program that shows it.
    pub line: Option<u32>,
}

/// A setup without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Inferred {
    /// What was given, and what was added.
    pub setup: Setup,
    /// What was added.
    pub assumptions: Vec<Assumption>,
    /// The figures that the program finishes.
    pub figures: Figures,
}

/// Looks at a program while it runs.
#[derive(Clone, Debug)]
pub struct Inference {
    /// By turret station; 0 before the first tool is called. The tool at work is not among them.
    tools: BTreeMap<u32, Observation>,
    station: u32,
    current: Observation,
    at: Position<WorkTip>,
    figures: FigureSearch,
}

impl Inference {
    /// Nothing seen yet, the tool at `start`.
    pub fn new(start: Position<WorkTip>) -> Self {
        let figures = FigureSearch::new(start);
        Self { tools: BTreeMap::new(), station: 0, current: Observation::default(), at: start, figures }
    }

    /// Looks at a command.
    #[inline]
    pub fn add(&mut self, command: &Command) {
        self.figures.add(command);
        match &command.action {
            Action::Tool { tool, .. } => self.change(*tool),
            Action::Relocate { to, .. } => self.at = *to,
            Action::Rapid { to, .. } | Action::Feed { to, .. } | Action::Thread { to, .. } => {
                self.current.add(command, self.at, *to);
                self.at = *to;
            }
            _ => {}
        }
    }

    #[cold]
    fn change(&mut self, station: u32) {
        let seen = std::mem::take(&mut self.current);
        if seen.cuts() && self.tools.len() < TOOLS_MAX {
            self.tools.insert(self.station, seen);
        }
        self.current = self.tools.remove(&station).unwrap_or_default();
        self.station = station;
    }

    /// The given setup with what the program shows.
    pub fn finish(mut self, given: &Setup) -> Inferred {
        let figures = self.figures.finish();
        let mut inferred = Inferred { setup: given.clone(), assumptions: Vec::new(), figures };
        self.change(u32::MAX);
        // What moves before any tool is called is the first tool's doing.
        if let Some(unnamed) = self.tools.remove(&0)
            && unnamed.cuts()
        {
            let first = self.tools.keys().next().copied();
            self.tools.entry(first.unwrap_or(1)).or_default().join(unnamed);
        }
        self.tools.retain(|_, tool| tool.cuts());
        let kinds: BTreeMap<u32, (ToolKind, ToolSide)> = self
            .tools
            .iter()
            .map(|(station, tool)| {
                let entry = given.tools.iter().find(|(name, _)| name.parse() == Ok(*station));
                let (kind, side) = tool.kind();
                let side = tip_side(given, *station).filter(|_| !on_axis(kind)).unwrap_or(side);
                let known = entry.map(|(_, entry)| (entry.kind.unwrap_or(kind), entry.side.unwrap_or(side)));
                (*station, known.unwrap_or((kind, side)))
            })
            .collect();
        let scene = Scene { tools: &self.tools, kinds: &kinds };
        if given.stock.as_ref().is_none_or(Stock::is_shapeless) {
            scene.stock(&mut inferred);
        }
        if given.chuck.is_none() && inferred.setup.stock.is_some() {
            scene.chuck(&mut inferred);
        }
        let is_given = |station: &u32| given.tools.keys().any(|name| name.parse() == Ok(*station));
        for (station, tool) in self.tools.iter().filter(|(station, _)| !is_given(station)) {
            scene.tool(*station, tool, &mut inferred);
        }
        // What was made up must hold together; what does not is left out rather than shown wrong.
        if inferred.setup.chuck_outlines().is_err() && given.chuck.is_none() {
            inferred.setup.chuck = None;
            inferred.assumptions.retain(|assumption| assumption.section != "chuck");
        }
        inferred
    }
}

/// Whether a tool of this kind works on the spindle axis.
const fn on_axis(kind: ToolKind) -> bool {
    matches!(kind, ToolKind::Drilling | ToolKind::Tapping)
}

/// The offset that goes with a station.
fn offset_of(setup: &Setup, station: u32) -> Option<&Offset> {
    setup.offsets.iter().find(|(number, _)| number.parse() == Ok(station)).map(|(_, offset)| offset)
}

/// The side that the tip number of the offset stands for.
fn tip_side(setup: &Setup, station: u32) -> Option<ToolSide> {
    match offset_of(setup, station)?.tip {
        1 | 2 | 6 => Some(ToolSide::Inside),
        3 | 4 | 8 => Some(ToolSide::Outside),
        _ => None,
    }
}

/// Everything seen, and what each tool is.
struct Scene<'a> {
    tools: &'a BTreeMap<u32, Observation>,
    kinds: &'a BTreeMap<u32, (ToolKind, ToolSide)>,
}

/// Thousandths of a millimetre, as setup files have them.
fn rounded(mm: f64) -> f64 {
    (mm * 1e3).round() / 1e3
}

fn millimetres(mm: f64) -> Argument {
    Argument::from(rounded(mm).to_string())
}

impl Inferred {
    fn assume(
        &mut self,
        section: &str,
        key: &'static str,
        words: &'static str,
        arguments: Vec<(&'static str, Argument)>,
        line: Option<u32>,
    ) {
        self.assumptions.push(Assumption { section: section.to_string(), key, words, arguments, line });
    }
}

/// Where the front face of the stock is.
#[derive(Clone, Copy, Debug)]
enum Face {
    /// In front of a facing cut.
    Faced { z_mm: f64, allowance_mm: f64, line: u32 },
    /// At the work zero.
    Zero,
    /// Behind the highest start of a cut: the work zero is at the back.
    Highest { z_mm: f64, line: u32 },
}

impl Face {
    fn front_mm(self) -> f64 {
        match self {
            Self::Faced { z_mm, allowance_mm, .. } => rounded(z_mm + allowance_mm),
            Self::Zero => 0.0,
            Self::Highest { z_mm, .. } => z_mm,
        }
    }
}

impl Scene<'_> {
    fn of(&self, wanted: impl Fn(ToolKind, ToolSide) -> bool) -> impl Iterator<Item = &Observation> {
        let kinds = self.kinds;
        self.tools
            .iter()
            .filter(move |(station, _)| kinds.get(station).is_some_and(|(kind, side)| wanted(*kind, *side)))
            .map(|(_, tool)| tool)
    }

    fn stock(&self, inferred: &mut Inferred) {
        let outside = || self.of(|kind, side| side != ToolSide::Inside && !on_axis(kind));
        let inside = || self.of(|kind, side| side == ToolSide::Inside && !on_axis(kind));
        let highest = |tools: &mut dyn Iterator<Item = &Observation>| {
            tools.filter_map(|tool| tool.highest_x).max_by(|a, b| a.mm.total_cmp(&b.mm))
        };
        let thick = highest(&mut outside()).or_else(|| {
            // A bore alone: some wall around it.
            highest(&mut self.tools.values()).map(|seen| observation::Seen { mm: seen.mm + 10.0, ..seen })
        });
        let deepest =
            self.tools.values().filter_map(|tool| tool.lowest_z).min_by(|a, b| a.mm.total_cmp(&b.mm));
        let (Some(thick), Some(deepest)) = (thick, deepest) else { return };
        let diameter_mm = rounded(2.0 * thick.mm.max(1.0));
        let section = "stock";
        let value = |mm| vec![("value", millimetres(mm))];
        inferred.assume(
            section,
            "diameter_mm",
            "assumed-stock-diameter",
            value(diameter_mm),
            Some(thick.line),
        );
        let face = self.face();
        match face {
            Face::Faced { z_mm, allowance_mm, line } => {
                let arguments = vec![("value", millimetres(z_mm + allowance_mm)), ("z", millimetres(z_mm))];
                inferred.assume(section, "face_mm", "assumed-stock-faced", arguments, Some(line));
            }
            Face::Zero => inferred.assume(section, "face_mm", "assumed-stock-face-zero", Vec::new(), None),
            Face::Highest { z_mm, line } => {
                inferred.assume(section, "face_mm", "assumed-stock-face-highest", value(z_mm), Some(line));
            }
        }
        let face_mm = face.front_mm();
        let mut bore_mm = None;
        let drills = self.of(|kind, _| on_axis(kind)).next().is_some();
        let narrow = inside().filter_map(|tool| tool.lowest_x).min_by(|a, b| a.mm.total_cmp(&b.mm));
        if let (Some(narrow), false) = (narrow, drills)
            && narrow.mm > 0.0
            && 2.0 * narrow.mm < diameter_mm
        {
            let bore = rounded(2.0 * narrow.mm);
            inferred.assume(section, "bore_mm", "assumed-stock-bore", value(bore), Some(narrow.line));
            bore_mm = Some(bore);
        }
        let length_mm = rounded((face_mm - deepest.mm).max(1.0) + FREE_MM + GRIP_MM);
        let arguments = vec![
            ("value", millimetres(length_mm)),
            ("z", millimetres(deepest.mm)),
            ("grip", millimetres(GRIP_MM + FREE_MM)),
        ];
        inferred.assume(section, "length_mm", "assumed-stock-length", arguments, Some(deepest.line));
        let material = inferred.setup.stock.take().and_then(|stock| stock.material);
        inferred.setup.stock = Some(Stock {
            material,
            diameter_mm: Some(diameter_mm),
            bore_mm,
            length_mm: Some(length_mm),
            face_mm,
            profile: Vec::new(),
        });
    }

    /// Where the front face of the stock is.
    fn face(&self) -> Face {
        let facing = self.tools.values().filter_map(|tool| tool.facing);
        if let Some(facing) = facing.max_by(|a, b| a.mm.total_cmp(&b.mm)) {
            let steps = self.tools.values().map(|tool| tool.facing_step_mm).fold(0.0, f64::max);
            let allowance_mm = if steps > 0.0 { rounded(steps) } else { 1.0 };
            return Face::Faced { z_mm: facing.mm, allowance_mm, line: facing.line };
        }
        let highest = self.tools.values().filter_map(|tool| tool.highest_z);
        let highest = highest.max_by(|a, b| a.mm.total_cmp(&b.mm));
        let lowest =
            self.tools.values().filter_map(|tool| tool.lowest_z).map(|seen| seen.mm).reduce(f64::min);
        match (highest, lowest) {
            (Some(highest), Some(lowest)) if lowest > -1.0 && highest.mm > 5.0 => {
                Face::Highest { z_mm: rounded(highest.mm - 2.0), line: highest.line }
            }
            _ => Face::Zero,
        }
    }

    fn chuck(&self, inferred: &mut Inferred) {
        let diameter = inferred.setup.stock.as_ref().and_then(|stock| stock.diameter_mm).unwrap_or(50.0);
        let size = [160.0, 200.0, 250.0, 315.0, 400.0, 500.0, 630.0];
        let size = size.into_iter().find(|size| *size >= 2.5 * diameter).unwrap_or(rounded(3.0 * diameter));
        inferred.setup.chuck = Some(Chuck { grip_mm: GRIP_MM, diameter_mm: size, ..Chuck::default() });
        let arguments = vec![("value", millimetres(size)), ("grip", millimetres(GRIP_MM))];
        inferred.assume("chuck", "", "assumed-chuck", arguments, None);
    }

    fn tool(&self, station: u32, tool: &Observation, inferred: &mut Inferred) {
        let (kind, side) = self.kinds[&station];
        let section = format!("tools.{station}");
        let offset = offset_of(&inferred.setup, station);
        let has_nose = offset.is_some_and(|offset| offset.geometry.r + offset.wear.r > 0.0);
        let has_tip = offset.is_some_and(|offset| offset.tip > 0);
        let mut entry = ToolEntry { kind: Some(kind), side: Some(side), ..ToolEntry::default() };
        let line = Some(tool.first_line);
        let why = match (kind, side) {
            (ToolKind::Threading, _) => "assumed-tool-threading",
            (ToolKind::Drilling, _) => "assumed-tool-drilling",
            (ToolKind::Tapping, _) => "assumed-tool-tapping",
            (ToolKind::CutOff, _) => "assumed-tool-cut-off",
            (ToolKind::Grooving, ToolSide::Face) => "assumed-tool-face-grooving",
            (ToolKind::Grooving, _) => "assumed-tool-grooving",
            (ToolKind::Turning, ToolSide::Inside) => "assumed-tool-boring",
            (ToolKind::Turning, _) => "assumed-tool-turning",
        };
        let tool_number = || ("tool", Argument::from(station));
        inferred.assume(&section, "kind", why, vec![tool_number()], line);
        match kind {
            ToolKind::Turning => {
                let is_left = tool.back_mm > tool.forth_mm;
                entry.hand = Some(if is_left { Hand::Left } else { Hand::Right });
                let steepest = if is_left { tool.falls_back_deg } else { tool.falls_deg };
                let choice = INSERTS.iter().find(|insert| insert.0 >= steepest).unwrap_or(&INSERTS[3]);
                let (_, outside, inside, angle) = *choice;
                let insert = if side == ToolSide::Inside { inside } else { outside };
                entry.insert = Some(insert.to_string());
                entry.entering_angle_deg = Some(angle);
                let arguments = vec![
                    tool_number(),
                    ("insert", Argument::from(insert)),
                    ("angle", Argument::from(format!("{steepest:.0}"))),
                ];
                inferred.assume(&section, "insert", "assumed-tool-insert", arguments, line);
                if side == ToolSide::Inside {
                    let bore = tool.lowest_x.map_or(10.0, |seen| 2.0 * seen.mm.max(0.0));
                    let bar = BARS_MM.iter().rev().find(|bar| **bar <= 0.7 * bore).unwrap_or(&BARS_MM[0]);
                    entry.shank_mm = Some(*bar);
                    let depth = tool.lowest_z.map_or(50.0, |seen| -seen.mm).max(30.0);
                    entry.length_mm = Some(rounded((depth + 50.0).ceil()));
                }
            }
            ToolKind::Grooving | ToolKind::CutOff => {
                let usual = if tool.step_mm > 3.0 { tool.step_mm } else { 3.0 };
                let width =
                    BLADES_MM.into_iter().find(|width| *width >= usual - 1e-9).unwrap_or(usual.ceil());
                entry.width_mm = Some(width);
                let depth = match (tool.highest_x, tool.lowest_x) {
                    (Some(high), Some(low)) => high.mm - low.mm,
                    _ => 0.0,
                };
                entry.reach_mm = Some((depth + 5.0).max(15.0).ceil());
                let arguments = vec![tool_number(), ("value", millimetres(width))];
                inferred.assume(&section, "width_mm", "assumed-tool-width", arguments, line);
            }
            ToolKind::Drilling | ToolKind::Tapping => {
                let bored = self.of(|kind, side| side == ToolSide::Inside && kind == ToolKind::Turning);
                let bored = bored.filter_map(|tool| tool.lowest_x).map(|seen| 2.0 * seen.mm).reduce(f64::min);
                let bored = bored.filter(|bore| *bore >= 1.0);
                let diameter = rounded(bored.unwrap_or(10.0));
                entry.diameter_mm = Some(diameter);
                let depth = tool.lowest_z.map_or(50.0, |seen| -seen.mm).max(10.0);
                entry.length_mm = Some((depth + diameter + 10.0).ceil());
                let words = if bored.is_some() { "assumed-drill-of-bore" } else { "assumed-drill" };
                let arguments = vec![tool_number(), ("value", millimetres(diameter))];
                inferred.assume(&section, "diameter_mm", words, arguments, line);
            }
            ToolKind::Threading => {
                entry.thread_angle_deg = Some(60.0);
                // Room for two turns of the thread between the sides of the insert.
                entry.width_mm = Some(rounded((2.0 * tool.lead_mm).max(4.0)));
                inferred.assume(
                    &section,
                    "thread_angle_deg",
                    "assumed-tool-angle",
                    vec![tool_number()],
                    line,
                );
            }
        }
        if !has_nose && !on_axis(kind) {
            entry.nose_radius_mm = Some(0.0);
            inferred.assume(&section, "nose_radius_mm", "assumed-tool-sharp", vec![tool_number()], line);
        }
        if matches!(kind, ToolKind::Grooving | ToolKind::CutOff) && !has_tip {
            inferred.assume(&section, "tip", "assumed-tool-corner", vec![tool_number()], line);
        }
        if has_tip {
            // The number of the tip says which way the tool looks.
            entry.hand = None;
        }
        inferred.setup.tools.insert(station.to_string(), entry);
    }
}
