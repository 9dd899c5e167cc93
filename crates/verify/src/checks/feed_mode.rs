//! **The feed mode changed and F did not.** A cutting move goes on with the same number of F under the other feed mode:
//! 0.2 mm per revolution becomes 0.2 mm per minute, 200 mm per minute becomes 200 mm per revolution.
//!
//! Why it hurts: the tool stands rubbing in one place, or runs into the work a thousand times too fast.
//!
//! How to mend it: give F in the block of G98 or G99, or right behind it.

use turnwright_canon::{Action, Command};
use turnwright_units::Feed;

use super::{Check, Report, State};

#[derive(Default)]
pub(super) struct FeedMode {
    last: Option<Feed>,
}

impl Check for FeedMode {
    #[inline]
    fn on_move(&mut self, command: &Command, _: &State, report: &mut Report) {
        let Action::Feed { feed, .. } = &command.action else { return };
        if self.last == Some(*feed) {
            return;
        }
        if let Some(last) = self.last.replace(*feed)
            && last.length() == feed.length()
            && !feed.length().is_zero()
        {
            report.warn("feed-mode-changed", &command.origin, Vec::new());
        }
    }
}
