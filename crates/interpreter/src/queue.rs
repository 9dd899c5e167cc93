//! The commands that wait to be given out.
//!
//! In: commands in order. Out: the same. Nearly always one waits at most, so the first has a place of its own, and
//! only what waits behind it is in a ring. Not here: what the commands mean.

use std::collections::VecDeque;

use turnwright_canon::Command;

/// First in, first out.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    first: Option<Command>,
    /// Empty when there is no first.
    behind: VecDeque<Command>,
}

impl Queue {
    #[inline]
    pub(crate) const fn is_empty(&self) -> bool {
        self.first.is_none()
    }

    pub(crate) fn push_back(&mut self, command: Command) {
        if self.first.is_none() {
            self.first = Some(command);
        } else {
            self.behind.push_back(command);
        }
    }

    /// Makes a command in the place where it waits.
    #[inline]
    pub(crate) fn push_made(&mut self, make: impl Fn() -> Command) {
        if self.first.is_none() {
            self.first = Some(make());
        } else {
            self.push_back(make());
        }
    }

    #[inline]
    pub(crate) fn pop_front(&mut self) -> Option<Command> {
        self.first.as_ref()?;
        let first = self.first.take();
        if !self.behind.is_empty() {
            self.first = self.behind.pop_front();
        }
        first
    }

    pub(crate) const fn front(&self) -> Option<&Command> {
        self.first.as_ref()
    }

    pub(crate) const fn front_mut(&mut self) -> Option<&mut Command> {
        self.first.as_mut()
    }

    /// What follows the first.
    #[inline]
    pub(crate) fn second(&self) -> Option<&Command> {
        self.behind.front()
    }

    pub(crate) fn len(&self) -> usize {
        usize::from(self.first.is_some()) + self.behind.len()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Command> {
        self.first.iter().chain(&self.behind)
    }

    /// Takes back what stands behind the first `len`.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.behind.truncate(len.saturating_sub(1));
        if len == 0 {
            self.first = None;
        }
    }

    pub(crate) fn clear(&mut self) {
        self.truncate(0);
    }
}

#[cfg(test)]
mod tests {
    use turnwright_canon::{Action, Origin};

    use super::*;

    fn line(line: u32) -> Command {
        Command::new(Action::Stop, Origin::line(line))
    }

    fn lines(queue: &Queue) -> Vec<u32> {
        queue.iter().map(|command| command.origin.line).collect()
    }

    #[test]
    fn what_came_first_goes_first() {
        let mut queue = Queue::default();
        for number in 1..=3 {
            queue.push_back(line(number));
        }
        assert_eq!((lines(&queue), queue.len()), (vec![1, 2, 3], 3));
        assert_eq!(queue.pop_front(), Some(line(1)));
        queue.push_back(line(4));
        assert_eq!(lines(&queue), [2, 3, 4]);
        assert_eq!(queue.front(), Some(&line(2)));
        queue.truncate(1);
        assert_eq!(lines(&queue), [2]);
        queue.truncate(0);
        assert!(queue.is_empty() && queue.pop_front().is_none());
    }
}
