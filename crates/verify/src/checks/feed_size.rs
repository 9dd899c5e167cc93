//! **A feed that no turning tool is meant for.** More than 1.2 mm or less than 0.005 mm per revolution in a cutting
//! move. (Above 10 mm the interpreter says so at the word already.)
//!
//! Why it hurts: a number for the other feed mode, or a lost point, breaks the insert in the first revolution or lets
//! the part take hours.
//!
//! How to mend it: check the point of F, and whether G98 or G99 is in force. A tool that feeds so on purpose: allow
//! `feed-per-revolution-unusual`.

use turnwright_canon::{Action, Command};
use turnwright_diagnostics::Argument;
use turnwright_units::{Feed, Length};

use super::{Check, Report, State};

/// More is no feed of a turning tool.
const FEED_MAX: Length = Length::from_nm(1_200_000);

/// From here on the word itself is warned of.
const WORD_MAX: Length = Length::from_mm(10);

/// Less hardly moves.
const FEED_MIN: Length = Length::from_nm(5_000);

#[derive(Default)]
pub(super) struct FeedSize {
    /// Of the move before: a feed is told of where it begins.
    last: Option<Feed>,
}

impl Check for FeedSize {
    #[inline]
    fn on_move(&mut self, command: &Command, _: &State, report: &mut Report) {
        let Action::Feed { feed, .. } = &command.action else { return };
        if self.last.replace(*feed) == Some(*feed) {
            return;
        }
        let Feed::PerRevolution(feed) = feed else { return };
        let feed = feed.0;
        let is_large = feed > FEED_MAX && feed <= WORD_MAX;
        if is_large || (feed < FEED_MIN && !feed.is_zero()) {
            let arguments = vec![("value", Argument::from(feed))];
            report.warn("feed-per-revolution-unusual", &command.origin, arguments);
        }
    }
}
