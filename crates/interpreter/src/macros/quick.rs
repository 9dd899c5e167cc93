//! Statements of a loop that run one behind the other, without a stop at each.
//!
//! In: kept statements that need nothing but variables. Out: the first block that is more than that, or whose way on
//! is not known yet; it runs the long way, as each would ([`Core::run_statement`]). Nothing may be left half done: a
//! statement whose value or way is missing has done nothing here.

use super::code::{Code, Machine};
use super::statement::{Label, Statement, Target};
use super::variables::{Variables, number};
use crate::cache::{BlockId, Links};
use crate::flow::FrameKind;
use crate::machine::Core;

/// A kept block as this way sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Quick {
    Assign {
        slot: u16,
        value: Code,
    },
    /// On to the next block while the condition holds, else behind the loop.
    While(Code),
    /// On to the jump's target when the condition holds.
    JumpIf(Code),
    Jump,
    /// Nothing to do.
    Next,
    /// It needs the long way.
    Not,
}

impl Quick {
    pub(crate) fn of(statement: &Statement, machine: &Machine) -> Self {
        match *statement {
            Statement::Assign { target: Target::Slot(slot), value } if machine.stands_alone(value) => {
                Self::Assign { slot, value }
            }
            Statement::While { condition } if machine.stands_alone(condition) => Self::While(condition),
            Statement::IfGoto { condition, label: Label::Fixed(_) } if machine.stands_alone(condition) => {
                Self::JumpIf(condition)
            }
            Statement::Goto { label: Label::Fixed(_) } | Statement::End => Self::Jump,
            Statement::Do => Self::Next,
            _ => Self::Not,
        }
    }

    /// Does what the block says; gives the one that comes next.
    #[inline]
    fn run(&self, links: &Links, machine: &mut Machine, variables: &mut Variables) -> Option<BlockId> {
        match *self {
            Self::Assign { slot, value } => {
                let next = links.next?;
                let value = machine.value(value, variables)?;
                variables.set(slot, machine.arithmetic.stored(value));
                Some(next)
            }
            Self::While(condition) | Self::JumpIf(condition) => {
                let holds = number(machine.value(condition, variables)?) != 0.0;
                if holds == matches!(*self, Self::While(_)) { links.next } else { links.jump }
            }
            Self::Jump => links.jump,
            Self::Next => links.next,
            Self::Not => None,
        }
    }
}

impl Core {
    /// Runs statements from a kept block on; gives the block that has to go the long way.
    #[inline]
    pub(crate) fn run_quick(&mut self, id: BlockId) -> BlockId {
        // Who reads a figure, finishes one or waits for an interrupt looks at every block.
        let is_finishing =
            self.frames.last().is_some_and(|frame| matches!(frame.kind, FrameKind::Finish { .. }));
        if is_finishing || self.capture.is_some() || self.macros.interrupt.is_some() {
            return id;
        }
        let blocks = self.options.blocks_max.saturating_sub(self.blocks_run);
        let most = blocks.min(self.options.idle_blocks_max.saturating_sub(self.idle_blocks));
        let Self { cache, macros, .. } = self;
        let (mut id, mut run) = (id, 0);
        while run < most {
            let (quick, links) = cache.quick(id);
            let Some(next) = quick.run(links, &mut macros.machine, &mut macros.variables) else {
                break;
            };
            (id, run) = (next, run + 1);
        }
        self.blocks_run += run;
        self.idle_blocks += run;
        self.cache.go_to(id);
        id
    }
}
