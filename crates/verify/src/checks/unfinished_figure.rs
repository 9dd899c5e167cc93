//! **A figure is roughed and never finished.** A roughing cycle leaves an allowance, and no finishing cycle runs along
//! the same figure before the program ends. A note: the finish may be made block by block.
//!
//! Why it hurts: the part keeps the allowance.
//!
//! How to mend it: G70 with the same P and Q, or no allowance.

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, Origin, Phase};

use super::{Check, Report, Scene, State};

/// Figures that are kept in mind.
const FIGURES_MAX: usize = 1_000;

#[derive(Default)]
pub(super) struct UnfinishedFigure {
    /// The last roughing block that went to a start moved by its allowance.
    approached: Option<(u32, u32)>,
    /// Blocks of figures that have been roughed and not finished: text and line, and who roughed them.
    rough: BTreeMap<(u32, u32), Origin>,
    /// Text, line and block of the figure noted last: passes come in rows.
    last: Option<(u32, u32, u32)>,
    has_ended: bool,
}

impl Check for UnfinishedFigure {
    #[inline]
    fn on_move(&mut self, command: &Command, _: &State, _: &mut Report) {
        let origin = command.origin;
        let Some(cycle) = origin.cycle else { return };
        match (cycle.phase, origin.figure_line) {
            (Phase::Approach, _) => self.approached = Some((origin.source, origin.line)),
            (Phase::Cut | Phase::Contour, Some(line)) => {
                let this = Some((origin.source, origin.line, line));
                let has_allowance = self.approached == Some((origin.source, origin.line));
                if has_allowance && self.last != this && self.rough.len() < FIGURES_MAX {
                    self.rough.insert((origin.source, line), origin);
                    self.last = this;
                }
            }
            (Phase::Finish, Some(line)) => {
                self.last = None;
                if let Some(by) = self.rough.get(&(origin.source, line)).copied() {
                    self.rough.retain(|_, other| (other.source, other.line) != (by.source, by.line));
                }
            }
            _ => {}
        }
    }

    fn on_other(&mut self, command: &Command, _: &State, _: &mut Report) {
        self.has_ended |= matches!(command.action, Action::End);
    }

    fn at_end(&mut self, _: &Scene<'_>, report: &mut Report) {
        // A program that an alarm stopped would perhaps have finished it.
        for origin in self.rough.values().filter(|_| self.has_ended) {
            report.note("roughing-without-finishing", origin);
        }
    }
}
