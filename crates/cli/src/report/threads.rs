//! What threads need of the way before and behind them, against what the program leaves, and how far a tap goes on while
//! the spindle stops.

use std::collections::BTreeMap;

use turnwright_canon::{Action, Command, SpindleState};
use turnwright_diagnostics::{Diagnostic, Place, Severity, SourceId};
use turnwright_motion::{Kind, MachineRates, ThreadNeed, Timing};
use turnwright_units::Radius;
use turnwright_verify::thread_ways::ThreadWay;

/// A line: program text and number.
type Line = (u32, u32);

/// Threads by line.
#[derive(Debug, Default)]
pub(crate) struct Threads {
    /// The most that the passes of a line need.
    needs: BTreeMap<Line, ThreadNeed>,
    /// The least that they have, where anybody knows the work.
    pub(crate) known: BTreeMap<Line, ThreadWay>,
    /// The stock is given.
    pub(crate) has_stock: bool,
    /// Taps whose spindle stops behind them, and how far they go on, mm.
    overruns: BTreeMap<Line, f64>,
    /// The line where the chain of moves began, its last lead when it is on the axis, and its speed.
    chain: Option<(Line, f64, f64)>,
    /// The spindle is led with a tap.
    is_led: bool,
}

impl Threads {
    /// The next command.
    pub(crate) fn add(&mut self, command: &Command, timing: &Timing, rates: &MachineRates) {
        let here = (command.origin.source, command.origin.line);
        match &command.action {
            Action::Thread { to, lead, is_chained, .. } => {
                let begun = self.chain.filter(|_| *is_chained).map_or(here, |(line, ..)| line);
                // A tap that leads the spindle needs no way to get into step.
                let dynamics = rates.dynamics.as_ref().filter(|_| !self.is_led);
                let Some(need) = dynamics.and_then(|dynamics| ThreadNeed::of(command, timing, dynamics))
                else {
                    return;
                };
                let rpm = timing.rpm.map_or(0.0, |rpm| rpm.max);
                // Off the axis nothing is tapped.
                let tap_mm = if to.x == Radius::ZERO { lead.0.to_mm().abs() } else { 0.0 };
                self.chain = Some((begun, tap_mm, rpm));
                let known = self.needs.entry(begun).or_insert(need);
                known.run_out_mm =
                    if *is_chained { need.run_out_mm } else { known.run_out_mm.max(need.run_out_mm) };
                if !is_chained {
                    known.lead_in_mm = known.lead_in_mm.max(need.lead_in_mm);
                }
            }
            // The spindle stops in the block of the tap itself.
            Action::Spindle { state: SpindleState::Stop, .. } => {
                if let Some((line, lead_mm, rpm)) = self.chain.take().filter(|(line, ..)| *line == here) {
                    let turns = rpm / 60.0 * timing.seconds / 2.0;
                    self.overruns.entry(line).or_insert(lead_mm * turns);
                }
            }
            Action::RigidTapping(is_led) => self.is_led = *is_led,
            _ if timing.kind == Kind::Cutting || timing.kind == Kind::Rapid => self.chain = None,
            _ => {}
        }
    }

    /// What was found. Lines with the same numbers, as the passes of one thread have them, are told once.
    pub(crate) fn findings(&self) -> Vec<Diagnostic> {
        let mut findings = Vec::new();
        let mut told = Vec::new();
        let mut tell = |key: &'static str, line: Line, needed_mm: f64, has_mm: f64| {
            let [needed, has] = [needed_mm, has_mm].map(|mm| format!("{mm:.1}"));
            // Tenths that look the same are.
            if has_mm >= needed_mm || needed == has || told.contains(&(key, needed.clone(), has.clone())) {
                return;
            }
            told.push((key, needed.clone(), has.clone()));
            findings.push(Diagnostic::warning(key).at(place(line)).with("needed", needed).with("has", has));
        };
        for (line, need) in &self.needs {
            let way = self.known.get(line);
            // A bar that was only inferred may be too long in front, where Z0 is known better, and so thick that the thread
            // seems to start in it.
            let lead_in = match way {
                Some(way) if self.has_stock => way.lead_in_mm,
                Some(way) if way.is_along_x => way.lead_in_mm.filter(|has_mm| *has_mm > 0.0),
                _ => need.before_zero_mm,
            };
            if let Some(has_mm) = lead_in {
                tell("thread-start-too-close", *line, need.lead_in_mm, has_mm);
            }
            if let Some(has_mm) = way.and_then(|way| way.run_out_mm) {
                tell("thread-end-too-close", *line, need.run_out_mm, has_mm);
            }
        }
        let overruns = self.overruns.iter().filter(|(_, mm)| **mm >= 0.05).map(|(line, mm)| {
            let note = Diagnostic::new(Severity::Note, "tap-overruns").at(place(*line));
            note.with("distance", format!("{mm:.1}"))
        });
        findings.extend(overruns);
        findings
    }
}

fn place((source, line): Line) -> Place {
    Place { line, line_offset: u64::MAX, column: 1, end_column: 1, source: SourceId(source) }
}
