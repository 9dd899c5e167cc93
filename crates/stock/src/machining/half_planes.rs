//! The section in every half-plane through the axis: threads wind, so that each shows them elsewhere along Z.
//!
//! In: the machining in front of the first thread, and the commands from there on. Out: the section in the half-plane at
//! any angle. Only threads depend on it, so that the same commands are applied again to what stood in front of them, with
//! the spindle that much further round; moves that stay clear of all threads along Z are passed over, as what they leave
//! is the same all round. Hand, several starts, tapers, scrolls and leads that change follow from the spindle's phase.
//!
//! Angles count as the axes do: from X to Y, seen from the tailstock counter-clockwise. A spindle that turns clockwise
//! (seen from the headstock) turns the work that way, past a tool that stays where angle zero was at the beginning.
//!
//! Invariant: what is kept is bounded by [`WOUND_COMMANDS_MAX`], and what is done by [`WOUND_CUTS_MAX`].

use turnwright_canon::{Action, Command, Shape};

use super::{Machining, ways};
use crate::history::clip;
use crate::row::Run;
use crate::section::Section;

/// Moves behind the start of the first thread; of programs with more of them nothing is kept.
pub const WOUND_COMMANDS_MAX: usize = 100_000;

/// Cuts of all half-planes together, a microsecond or two each: every turn of every pass of a thread counts.
pub const WOUND_CUTS_MAX: f64 = 3e6;

/// Where a window along Z ends beside a step of the section, it ends at it, mm.
const STEP_MM: f64 = 1e-6;

/// What is needed for the section in any half-plane.
#[derive(Clone, Debug)]
pub struct HalfPlanes {
    start: Machining,
    moves: Vec<Move>,
    /// How many moves there were when the finished part came off.
    end: Option<usize>,
    is_too_long: bool,
}

/// A command, and what it may cut.
#[derive(Clone, Debug)]
struct Move {
    command: Command,
    /// From lower to higher Z.
    reach: Option<(f64, f64)>,
    /// How many cuts it is.
    cuts: f64,
    is_thread: bool,
}

/// There is too much to cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl HalfPlanes {
    /// Begins in front of the first thread.
    pub fn new(machining: &Machining) -> Self {
        Self {
            start: Machining { cut_off: None, ..machining.only_cutting() },
            moves: Vec::new(),
            end: None,
            is_too_long: false,
        }
    }

    /// Notes a command; `machining` is in front of it.
    pub fn add(&mut self, command: &Command, machining: &Machining) {
        let is_way = command.action.end_point().is_some();
        let counts = is_way
            || matches!(
                command.action,
                Action::Relocate { .. }
                    | Action::Tool { .. }
                    | Action::Spindle { .. }
                    | Action::Interpolation(_)
            );
        if !counts || self.is_too_long {
            return;
        }
        if self.moves.len() == WOUND_COMMANDS_MAX {
            (self.is_too_long, self.moves) = (true, Vec::new());
            return;
        }
        let is_thread = matches!(command.action, Action::Thread { .. });
        let reach = is_way.then(|| machining.reach_of(command)).flatten();
        self.moves.push(Move { command: command.clone(), reach, cuts: cuts(command, machining), is_thread });
    }

    /// With the command noted last the finished part came off.
    pub fn end(&mut self) {
        self.end = Some(self.moves.len());
    }

    /// The program is over; nothing when the finished part came off before its first thread.
    pub fn finish(self, machining: &Machining) -> Option<Self> {
        (machining.cut_off.is_none() || self.end.is_some()).then_some(self)
    }

    /// The sections in so many half-planes, evenly spaced, the first at zero: `finished` is that of the part at zero.
    ///
    /// # Errors
    /// [`TooLong`] when that were more than [`WOUND_COMMANDS_MAX`] or [`WOUND_CUTS_MAX`].
    pub fn sections(
        &self,
        count: usize,
        finished: &Section,
    ) -> Result<impl Iterator<Item = Section>, TooLong> {
        let moves = &self.moves[..self.end.unwrap_or(self.moves.len())];
        let windows = windows(moves, finished);
        let meets = |(from, to): (f64, f64)| windows.iter().any(|window| window.0 <= to && from <= window.1);
        let is_met: Vec<bool> = moves.iter().map(|one| one.reach.is_none_or(meets)).collect();
        let cuts: f64 =
            moves.iter().zip(&is_met).filter(|(_, is_met)| **is_met).map(|(one, _)| one.cuts).sum();
        if self.is_too_long || cuts * count as f64 > WOUND_CUTS_MAX {
            return Err(TooLong);
        }
        let finished = finished.clone();
        Ok((0..count).map(move |index| {
            let mut machining = Machining { turn: index as f64 / count as f64, ..self.start.clone() };
            for (one, is_met) in moves.iter().zip(&is_met) {
                if *is_met {
                    machining.advance(&one.command, &mut |_| {});
                } else {
                    machining.pass_over(&one.command);
                }
            }
            patched(&finished, &windows, machining.part())
        }))
    }
}

impl Machining {
    /// Where along Z the tool is on the way of a command.
    fn reach_of(&self, command: &Command) -> Option<(f64, f64)> {
        let tool = self.tools.get(&self.tool.unwrap_or_default())?.cutting.bounds();
        let end = self.place.clone().end_of(&command.action)?;
        let (from, to) = (ways::point(self.at).z, ways::point(end).z);
        let (low, high) = match &command.action {
            Action::Feed { shape, .. } | Action::Thread { shape, .. } => match shape {
                Shape::Line => (from.min(to), from.max(to)),
                Shape::Arc { centre, .. } => {
                    let centre = ways::point(*centre);
                    let radius = centre.distance(ways::point(self.at));
                    (centre.z - radius, centre.z + radius)
                }
                Shape::Curve(_) | Shape::SideArc { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            },
            _ => (from.min(to), from.max(to)),
        };
        Some((low + tool.min.z, high + tool.max.z))
    }
}

/// How often a command cuts: a thread once a turn.
fn cuts(command: &Command, machining: &Machining) -> f64 {
    let Action::Thread { to, lead, lead_end, .. } = &command.action else { return 1.0 };
    let (from, to) = (ways::point(machining.at), ways::point(*to));
    let leads = lead.0.to_mm() + lead_end.as_deref().unwrap_or(lead).0.to_mm();
    let length = (to.z - from.z).abs().max((to.x - from.x).abs());
    if leads > 0.0 { 1.0 + 2.0 * length / leads } else { 1.0 }
}

/// Where along Z threads are cut, in order and apart; they end where the section has steps, if there are any beside them.
fn windows(moves: &[Move], finished: &Section) -> Vec<(f64, f64)> {
    let threads = moves.iter().filter(|one| one.is_thread);
    let mut windows: Vec<(f64, f64)> = threads.filter_map(|one| one.reach).collect();
    windows.sort_by(|a, b| a.0.total_cmp(&b.0));
    windows.dedup_by(|next, window| {
        let meets = next.0 <= window.1 + STEP_MM;
        if meets {
            window.1 = window.1.max(next.1);
        }
        meets
    });
    let snapped = |z: f64| {
        let near = finished.row.slabs_between(z - STEP_MM, z + STEP_MM);
        let steps = near.flat_map(|(slab, _)| [slab.from, slab.to]);
        steps.filter(|step| (step - z).abs() <= STEP_MM).last().unwrap_or(z)
    };
    windows.into_iter().map(|(from, to)| (snapped(from), snapped(to))).collect()
}

/// A section with what another shows in some windows.
fn patched(section: &Section, windows: &[(f64, f64)], other: &Section) -> Section {
    let mut run = Run::default();
    let mut at = f64::NEG_INFINITY;
    for &(from, to) in windows {
        clip(section.row.slabs_between(at, from), at, from, &mut run);
        clip(other.row.slabs_between(from, to), from, to, &mut run);
        at = to;
    }
    clip(section.row.slabs_between(at, f64::INFINITY), at, f64::INFINITY, &mut run);
    let mut patched = Section::default();
    patched.row.append(&mut run);
    patched
}
