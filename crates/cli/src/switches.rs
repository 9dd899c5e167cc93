//! Which warnings are told, and which count as errors: `[checks]` of the setup, then `--allow` and `--deny`.

use std::collections::BTreeSet;

use turnwright_control::{Messages, nearest};
use turnwright_diagnostics::{Diagnostic, Severity};

use crate::arguments::Machine;
use crate::finding::Finding;
use crate::session::Session;

/// The word of `--deny` for all warnings.
const ALL: &str = "warnings";

/// Switches of warnings. Alarms are the control's and cannot be switched.
#[derive(Clone, Debug, Default)]
pub(crate) struct Switches {
    allowed: BTreeSet<String>,
    denied: BTreeSet<String>,
    denies_all: bool,
}

impl Switches {
    /// Those of a setup and of the command line.
    pub(crate) fn new(session: &Session, machine: &Machine) -> Result<Self, Finding> {
        let checks = &session.setup.checks;
        let mut switches = Self::default();
        let lists = [&checks.allow, &checks.deny, &machine.allow, &machine.deny];
        if lists.iter().all(|list| list.is_empty()) {
            return Ok(switches);
        }
        let file = session.setup_path.as_ref().map_or(String::new(), |path| path.display().to_string());
        let keys = |name: &str, file: &str| {
            let known = Messages.keys().find(|key| *key == name);
            let numbered = || Messages.by_id(name, session.control.alarm_ids);
            let found = known.map_or_else(numbered, |key| vec![key]);
            let found: Vec<String> = found.into_iter().map(str::to_string).collect();
            if found.is_empty() { Err(unknown(name, file)) } else { Ok(found) }
        };
        for (allowed, denied, file) in
            [(&checks.allow, &checks.deny, file.as_str()), (&machine.allow, &machine.deny, "")]
        {
            // What is said later counts.
            for name in allowed {
                let keys = keys(name, file)?;
                switches.denied.retain(|key| !keys.contains(key));
                switches.allowed.extend(keys);
            }
            for name in denied {
                if name == ALL {
                    switches.denies_all = true;
                    continue;
                }
                let keys = keys(name, file)?;
                switches.allowed.retain(|key| !keys.contains(key));
                switches.denied.extend(keys);
            }
        }
        Ok(switches)
    }

    /// Whether it is not told.
    pub(crate) fn allows(&self, diagnostic: &Diagnostic) -> bool {
        diagnostic.severity <= Severity::Warning && self.allowed.contains(diagnostic.key)
    }

    /// Makes an error of what is denied.
    pub(crate) fn judge(&self, diagnostic: &mut Diagnostic) {
        let is_denied = self.denies_all && diagnostic.severity == Severity::Warning;
        if is_denied || (diagnostic.severity <= Severity::Warning && self.denied.contains(diagnostic.key)) {
            diagnostic.severity = Severity::Error;
        }
    }
}

fn unknown(name: &str, file: &str) -> Finding {
    let finding = Finding::new(file, Diagnostic::error("unknown-check").with("name", name)).failed();
    match nearest(name, Messages.keys().chain([ALL])) {
        Some(near) => finding.with_hint(format!("{near}?")),
        None => finding,
    }
}
