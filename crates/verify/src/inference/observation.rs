//! What one tool does in a program.

use turnwright_canon::{Action, Command, Phase, Shape, Turn};
use turnwright_control::{ToolKind, ToolSide};
use turnwright_units::{Position, WorkTip};

/// Nearer to the spindle axis than this is on it, mm.
const ON_AXIS_MM: f64 = 0.01;

/// Facing ends nearer to the spindle axis than this, mm.
const FACED_MM: f64 = 2.0;

/// Steps between plunges that are further apart belong to two grooves, mm.
const GROOVE_STEP_MAX_MM: f64 = 10.0;

/// A value, and the line that shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) mm: f64,
    pub(super) line: u32,
}

fn keep(known: &mut Option<Seen>, new: Seen, is_better: impl Fn(f64, f64) -> bool) {
    if known.is_none_or(|known| is_better(new.mm, known.mm)) {
        *known = Some(new);
    }
}

/// A move that was straight and cut, not yet known whether it grooves or faces.
#[derive(Clone, Copy, Debug)]
struct Plunge {
    z_mm: f64,
    from_x_mm: f64,
    to_x_mm: f64,
    line: u32,
}

/// What is known of a tool from its moves. X are radii.
#[derive(Clone, Debug, Default)]
pub(super) struct Observation {
    pub(super) first_line: u32,
    /// Highest and lowest X that is fed to or from.
    pub(super) highest_x: Option<Seen>,
    pub(super) lowest_x: Option<Seen>,
    /// Highest and lowest Z that is cut to.
    pub(super) highest_z: Option<Seen>,
    pub(super) lowest_z: Option<Seen>,
    /// The highest Z at which a cut goes to the spindle axis.
    pub(super) facing: Option<Seen>,
    /// The largest step between such cuts, mm.
    pub(super) facing_step_mm: f64,
    /// How steeply cuts towards and away from the chuck fall towards the work, degrees.
    pub(super) falls_deg: f64,
    pub(super) falls_back_deg: f64,
    /// How far is cut along Z towards the chuck and away from it, mm.
    pub(super) forth_mm: f64,
    pub(super) back_mm: f64,
    /// The largest step between two plunges of a groove, mm.
    pub(super) step_mm: f64,
    pub(super) lead_mm: f64,
    cuts: u32,
    threads: u32,
    /// Moves on the spindle axis, and cuts off it.
    on_axis: u32,
    off_axis: u32,
    /// Cuts left outward, and inward.
    left_outward: u32,
    left_inward: u32,
    /// Plunges left straight back, and how far they cut.
    plunges: u32,
    plunged_mm: f64,
    /// Plunges into the face left straight back.
    face_plunges: u32,
    reaches_axis: bool,
    plunge: Option<Plunge>,
    last_plunge_z: Option<f64>,
    last_facing_z: Option<f64>,
    /// The move before was a cut.
    is_cutting: bool,
}

impl Observation {
    /// Whether it did anything that a tool is needed for.
    pub(super) const fn cuts(&self) -> bool {
        self.cuts > 0 || self.threads > 0
    }

    /// What it is, and where it works.
    pub(super) fn kind(&self) -> (ToolKind, ToolSide) {
        let side = if self.left_inward > self.left_outward { ToolSide::Inside } else { ToolSide::Outside };
        if self.threads > 0 {
            return if self.off_axis == 0 {
                (ToolKind::Tapping, ToolSide::Outside)
            } else {
                (ToolKind::Threading, side)
            };
        }
        if self.on_axis > 0 && self.off_axis == 0 {
            return (ToolKind::Drilling, ToolSide::Outside);
        }
        let along_mm = self.forth_mm + self.back_mm;
        if self.face_plunges > 0 && self.plunges == 0 && self.left_outward == 0 && self.left_inward == 0 {
            return (ToolKind::Grooving, ToolSide::Face);
        }
        if self.plunges > 0 && self.plunged_mm > along_mm {
            return if self.reaches_axis { (ToolKind::CutOff, side) } else { (ToolKind::Grooving, side) };
        }
        (ToolKind::Turning, side)
    }

    /// Looks at a move.
    pub(super) fn add(&mut self, command: &Command, from: Position<WorkTip>, to: Position<WorkTip>) {
        if !self.cuts() {
            self.first_line = command.origin.line;
        }
        let phase = command.origin.cycle.map(|cycle| cycle.phase);
        match &command.action {
            Action::Thread { lead, .. } => self.thread(lead.0.to_mm(), from, to, command.origin.line),
            Action::Feed { shape, .. } if is_cut(phase) => self.cut(shape, from, to, command.origin.line),
            Action::Feed { .. } => {
                self.extend(from, to, command.origin.line);
                self.leave(from, to);
            }
            _ => self.leave(from, to),
        }
    }

    /// Takes in what was seen before the tool had a name.
    pub(super) fn join(&mut self, other: Self) {
        if !self.cuts() {
            *self = other;
            return;
        }
        self.first_line = self.first_line.min(other.first_line);
        let joined = [
            (&mut self.highest_x, other.highest_x, true),
            (&mut self.lowest_x, other.lowest_x, false),
            (&mut self.highest_z, other.highest_z, true),
            (&mut self.lowest_z, other.lowest_z, false),
            (&mut self.facing, other.facing, true),
        ];
        for (known, new, wants_high) in joined {
            if let Some(new) = new {
                keep(known, new, |a, b| if wants_high { a > b } else { a < b });
            }
        }
        self.cuts += other.cuts;
        self.threads += other.threads;
        self.on_axis += other.on_axis;
        self.off_axis += other.off_axis;
    }

    /// The ends of a move that is fed.
    fn extend(&mut self, from: Position<WorkTip>, to: Position<WorkTip>, line: u32) {
        for x in [from.x.to_mm(), to.x.to_mm()] {
            keep(&mut self.highest_x, Seen { mm: x, line }, |new, known| new > known);
            keep(&mut self.lowest_x, Seen { mm: x, line }, |new, known| new < known);
        }
    }

    fn thread(&mut self, lead_mm: f64, from: Position<WorkTip>, to: Position<WorkTip>, line: u32) {
        self.threads += 1;
        self.lead_mm = self.lead_mm.max(lead_mm);
        let x = from.x.to_mm();
        if x.abs() <= ON_AXIS_MM && to.x.to_mm().abs() <= ON_AXIS_MM {
            self.on_axis += 1;
        } else {
            self.off_axis += 1;
            self.extend(from, to, line);
        }
        keep(&mut self.lowest_z, Seen { mm: to.z.to_mm().min(from.z.to_mm()), line }, |new, known| {
            new < known
        });
        self.is_cutting = true;
    }

    fn cut(&mut self, shape: &Shape, from: Position<WorkTip>, to: Position<WorkTip>, line: u32) {
        let (x0, z0, x1, z1) = (from.x.to_mm(), from.z.to_mm(), to.x.to_mm(), to.z.to_mm());
        let (dx, dz) = (x1 - x0, z1 - z0);
        self.cuts += 1;
        if x0.abs() <= ON_AXIS_MM && x1.abs() <= ON_AXIS_MM {
            self.on_axis += 1;
        } else {
            self.off_axis += 1;
        }
        self.extend(from, to, line);
        keep(&mut self.highest_z, Seen { mm: z0.max(z1), line }, |new, known| new > known);
        keep(&mut self.lowest_z, Seen { mm: z0.min(z1), line }, |new, known| new < known);
        self.settle(None);
        if *shape == Shape::Line {
            if dz.abs() < 1e-9 {
                self.plunge = Some(Plunge { z_mm: z0, from_x_mm: x0, to_x_mm: x1, line });
            } else if dx.abs() < 1e-9 {
                if !self.is_cutting {
                    self.plunge = Some(Plunge { z_mm: z1, from_x_mm: x0, to_x_mm: x0, line });
                }
                let along = if dz < 0.0 { &mut self.forth_mm } else { &mut self.back_mm };
                *along += dz.abs();
            }
        }
        // The way from a rapid into the work may fall as it likes.
        if self.is_cutting {
            self.slope(shape, from, to);
        }
        self.is_cutting = true;
    }

    /// How steeply a cut falls towards the axis and, for a bore, away from it: both count, the side is known later.
    fn slope(&mut self, shape: &Shape, from: Position<WorkTip>, to: Position<WorkTip>) {
        let (dx, dz) = (to.x.to_mm() - from.x.to_mm(), to.z.to_mm() - from.z.to_mm());
        let ways = match shape {
            Shape::Arc { turn, centre } => {
                let sense = if *turn == Turn::Clockwise { -1.0 } else { 1.0 };
                [from, to].map(|end| {
                    let (arm_x, arm_z) = (end.x.to_mm() - centre.x.to_mm(), end.z.to_mm() - centre.z.to_mm());
                    (arm_z * sense, -arm_x * sense)
                })
            }
            _ => [(dx, dz); 2],
        };
        for (dx, dz) in ways {
            if dz == 0.0 || dx >= 0.0 {
                continue;
            }
            let angle = libm::atan2(dx.abs(), dz.abs()).to_degrees();
            // Straight down is a shoulder that no turning tool goes down: a plunge or a face.
            if angle < 80.0 {
                let steepest = if dz < 0.0 { &mut self.falls_deg } else { &mut self.falls_back_deg };
                *steepest = steepest.max(angle);
            }
        }
    }

    /// A move away from a cut.
    fn leave(&mut self, from: Position<WorkTip>, to: Position<WorkTip>) {
        let (dx, dz) = (to.x.to_mm() - from.x.to_mm(), to.z.to_mm() - from.z.to_mm());
        self.settle(Some((dx, dz)));
        if self.is_cutting && dx.abs() > 1e-9 {
            *(if dx > 0.0 { &mut self.left_outward } else { &mut self.left_inward }) += 1;
        }
        // Straight back along Z says nothing of the side.
        if dx.abs() > 1e-9 || dz > 0.0 {
            self.is_cutting = false;
        }
    }

    /// What the plunge before was, by the way that the tool left it.
    fn settle(&mut self, left: Option<(f64, f64)>) {
        let Some(plunge) = self.plunge.take() else { return };
        let depth = plunge.to_x_mm - plunge.from_x_mm;
        let Some((dx, dz)) = left else {
            self.face(plunge, depth);
            return;
        };
        if depth.abs() > 1e-9 && dz.abs() < 1e-9 && dx * depth < 0.0 {
            self.plunges += 1;
            self.plunged_mm += depth.abs();
            self.reaches_axis |= plunge.to_x_mm <= 0.5;
            if let Some(last) = self.last_plunge_z {
                let step = (plunge.z_mm - last).abs();
                if step > 1e-9 && step <= GROOVE_STEP_MAX_MM {
                    self.step_mm = self.step_mm.max(step);
                }
            }
            self.last_plunge_z = Some(plunge.z_mm);
        } else if depth.abs() < 1e-9 && dx.abs() < 1e-9 && dz > 0.0 {
            self.face_plunges += 1;
        } else {
            self.face(plunge, depth);
        }
    }

    /// A cut towards the axis that is left along Z: facing.
    fn face(&mut self, plunge: Plunge, depth: f64) {
        if depth >= 0.0 || plunge.to_x_mm > FACED_MM {
            return;
        }
        if let Some(last) = self.last_facing_z {
            let step = (plunge.z_mm - last).abs();
            if step <= GROOVE_STEP_MAX_MM {
                self.facing_step_mm = self.facing_step_mm.max(step);
            }
        }
        self.last_facing_z = Some(plunge.z_mm);
        keep(&mut self.facing, Seen { mm: plunge.z_mm, line: plunge.line }, |new, known| new > known);
    }
}

/// Whether a move of a cycle cuts; outside of cycles every feed does.
const fn is_cut(phase: Option<Phase>) -> bool {
    !matches!(
        phase,
        Some(
            Phase::Approach
                | Phase::Infeed
                | Phase::Escape
                | Phase::Return
                | Phase::Back
                | Phase::Shift
                | Phase::Out
                | Phase::Home
        )
    )
}
