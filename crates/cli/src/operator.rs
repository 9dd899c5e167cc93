//! The operator's panel on the command line: overrides, dry run, single block, and what is done when.

use std::str::FromStr;

use clap::Args;
use turnwright_control::policy::{HeldDwell, ThreadHold};
use turnwright_control::{Control, Parameters};
use turnwright_diagnostics::Diagnostic;
use turnwright_motion::{MachineRates, Panel, Player, RapidOverride};

use crate::finding::Finding;
use crate::speech::Speech;

/// Of a feed override: the switch of the panel counts in tens to 150 or 200, the control takes a byte.
const FEED_PERCENT_MAX: f64 = 254.0;

/// No axis is faster, mm/min.
const DRY_RUN_MAX: f64 = 240_000.0;

/// Later nobody does anything: a week.
const SECONDS_MAX: f64 = 604_800.0;

/// How the panel is set from the start.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Operator's panel")]
pub(crate) struct PanelOptions {
    /// Feed override, 0 to 254 %; threads, taps and dwells do not heed it
    #[arg(long, value_name = "PERCENT", value_parser = feed_part)]
    pub(crate) feed_override: Option<f64>,
    /// Rapid override: F0, whose speed is parameter 1421 (980: 032), or 1 to 100 %
    #[arg(long, value_name = "F0|PERCENT", value_parser = rapid_override)]
    pub(crate) rapid_override: Option<RapidOverride>,
    /// Dry run: cuts go at this speed whatever their feed; without one, at that of parameter 1410
    #[arg(long, value_name = "MM/MIN", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    pub(crate) dry_run: Option<DryRun>,
    /// Single block: the axes come to rest behind each block; how long the operator waits there is not counted
    #[arg(long)]
    pub(crate) single_block: bool,
}

/// What the operator does while the program runs.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Operator's panel")]
pub(crate) struct OperatorActions {
    /// Feed hold from one second to another, 12.5..15; without an end nobody lets go; may be repeated
    #[arg(long, value_name = "FROM..TO")]
    pub(crate) hold: Vec<Hold>,
    /// At a second: feed=150, rapid=25 or F0, dry-run=on, off or a speed, single-block=on or off, hold, start; several
    /// with commas between them; may be repeated
    #[arg(long, value_name = "SECOND:WHAT")]
    pub(crate) at: Vec<Moment>,
}

/// The dry-run switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DryRun {
    /// At the speed of the control's parameter.
    OfParameter,
    /// At a speed, mm/min.
    At(f64),
}

/// A feed hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold {
    from_s: f64,
    to_s: Option<f64>,
}

/// One switch set otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turned {
    Feed(f64),
    Rapid(RapidOverride),
    DryRun(Option<DryRun>),
    SingleBlock(bool),
    Held(bool),
}

/// What is done at one time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moment {
    at_s: f64,
    turned: Vec<Turned>,
}

impl FromStr for DryRun {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.eq_ignore_ascii_case("on") {
            return Ok(Self::OfParameter);
        }
        let speed = number(text).filter(|speed| *speed > 0.0 && *speed <= DRY_RUN_MAX);
        speed.map(Self::At).ok_or_else(|| {
            format!("expected a speed above 0 and up to {DRY_RUN_MAX} mm/min, for example 3000")
        })
    }
}

impl FromStr for Hold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let fault = || "expected two times in seconds, for example 12.5..15, or 12.5.. for ever".to_string();
        let (from, to) = text.split_once("..").ok_or_else(fault)?;
        let from_s = seconds(from)?;
        let to_s = if to.trim().is_empty() { None } else { Some(seconds(to)?) };
        if to_s.is_some_and(|to_s| to_s <= from_s) {
            return Err("the hold would end before it begins".to_string());
        }
        Ok(Self { from_s, to_s })
    }
}

impl FromStr for Moment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let fault = || "expected a time and what is done then, for example 3.2:feed=150".to_string();
        let (at, what) = text.split_once(':').ok_or_else(fault)?;
        let turned = what.split(',').map(turned).collect::<Result<_, _>>()?;
        Ok(Self { at_s: seconds(at)?, turned })
    }
}

fn turned(text: &str) -> Result<Turned, String> {
    let (switch, value) = match text.split_once('=') {
        Some((switch, value)) => (switch.trim(), Some(value.trim())),
        None => (text.trim(), None),
    };
    let is_on = |value: &str| match value {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("expected on or off, not {value:?}")),
    };
    match (switch, value) {
        ("hold", None) => Ok(Turned::Held(true)),
        ("start", None) => Ok(Turned::Held(false)),
        ("feed", Some(value)) => feed_part(value).map(Turned::Feed),
        ("rapid", Some(value)) => rapid_override(value).map(Turned::Rapid),
        ("dry-run", Some("off")) => Ok(Turned::DryRun(None)),
        ("dry-run", Some(value)) => value.parse().map(|run| Turned::DryRun(Some(run))),
        ("single-block", Some(value)) => is_on(value).map(Turned::SingleBlock),
        _ => Err(format!(
            "{text:?} is no switch of the panel; expected feed=PERCENT, rapid=F0|PERCENT, dry-run=on|off|MM/MIN, \
             single-block=on|off, hold or start"
        )),
    }
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text).filter(|seconds| (0.0..=SECONDS_MAX).contains(seconds)).ok_or_else(|| {
        format!("{:?} is no time: expected seconds since the start, 0 to {SECONDS_MAX}", text.trim())
    })
}

fn percent(text: &str) -> Option<f64> {
    number(text.trim().strip_suffix('%').unwrap_or(text))
}

fn feed_part(text: &str) -> Result<f64, String> {
    let percent = percent(text).filter(|percent| (0.0..=FEED_PERCENT_MAX).contains(percent));
    percent.map(|percent| percent / 100.0).ok_or_else(|| {
        format!("expected a feed override of 0 to {FEED_PERCENT_MAX} % (most panels end at 150 or 200)")
    })
}

fn rapid_override(text: &str) -> Result<RapidOverride, String> {
    if text.trim().eq_ignore_ascii_case("f0") {
        return Ok(RapidOverride::Lowest);
    }
    match percent(text) {
        Some(0.0) => Err("a rapid override of 0 % does not exist; its lowest position is F0".to_string()),
        Some(percent) if percent > 0.0 && percent <= 100.0 => Ok(RapidOverride::Part(percent / 100.0)),
        _ => {
            Err("expected a rapid override of F0, or 1 to 100 % (panels have F0, 25, 50 and 100)".to_string())
        }
    }
}

impl PanelOptions {
    /// Rates with the panel set so.
    pub(crate) fn man(&self, rates: MachineRates, control: &Control) -> Result<MachineRates, Finding> {
        let rapid = self.rapid_override.map(Turned::Rapid);
        let feed = self.feed_override.map(Turned::Feed);
        let dry_run = self.dry_run.map(|run| Turned::DryRun(Some(run)));
        let mut panel = Panel { single_block: self.single_block, ..rates.panel };
        for turned in [rapid, feed, dry_run].into_iter().flatten() {
            turned.set(&mut panel, &control.parameters)?;
        }
        let mut rules = rates.panel_rules;
        rules.hold_stops_dwell = control.policies.held_dwell == HeldDwell::TimerStops;
        rules.thread_hold = match control.policies.thread_hold {
            ThreadHold::BehindNextBlock => turnwright_motion::ThreadHold::BehindNextBlock,
            ThreadHold::AtEnd => turnwright_motion::ThreadHold::AtEnd,
        };
        Ok(MachineRates { panel, panel_rules: rules, ..rates })
    }
}

impl OperatorActions {
    /// Tells a player what is done when.
    pub(crate) fn tell(&self, player: &mut Player, start: Panel, control: &Control) -> Result<(), Finding> {
        let held = |at_s: f64, is_held: bool| (at_s, vec![Turned::Held(is_held)]);
        let holds = self.hold.iter().flat_map(|hold| {
            [Some(held(hold.from_s, true)), hold.to_s.map(|to_s| held(to_s, false))].into_iter().flatten()
        });
        let moments = self.at.iter().map(|moment| (moment.at_s, moment.turned.clone()));
        let mut all: Vec<_> = holds.chain(moments).collect();
        // What is said later counts where times are the same.
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut panel = start;
        for (at_s, turned) in all {
            for one in turned {
                one.set(&mut panel, &control.parameters)?;
            }
            player.set_at(at_s, panel);
        }
        Ok(())
    }
}

impl Turned {
    fn set(self, panel: &mut Panel, parameters: &Parameters) -> Result<(), Finding> {
        match self {
            Self::Feed(part) => panel.feed = part,
            Self::Rapid(RapidOverride::Lowest) if parameters.value("rapid-rate-lowest") <= 0.0 => {
                return Err(unset("rapid-lowest-unset", "rapid-rate-lowest", parameters));
            }
            Self::Rapid(rapid) => panel.rapid = rapid,
            Self::DryRun(None) => panel.dry_run_mm_per_min = None,
            Self::DryRun(Some(DryRun::At(speed))) => panel.dry_run_mm_per_min = Some(speed),
            Self::DryRun(Some(DryRun::OfParameter)) if parameters.number("dry-run-feed").is_none() => {
                return Err(Finding::new("", Diagnostic::error("dry-run-by-hand-feed")).failed());
            }
            Self::DryRun(Some(DryRun::OfParameter)) => {
                let speed = parameters.value("dry-run-feed");
                if speed <= 0.0 {
                    return Err(unset("dry-run-unset", "dry-run-feed", parameters));
                }
                panel.dry_run_mm_per_min = Some(speed);
            }
            Self::SingleBlock(is_on) => panel.single_block = is_on,
            Self::Held(is_held) => panel.is_held = is_held,
        }
        Ok(())
    }
}

/// A switch whose speed is a parameter that is 0.
fn unset(key: &'static str, parameter: &str, parameters: &Parameters) -> Finding {
    let number = parameters.number(parameter).unwrap_or("-");
    Finding::new("", Diagnostic::error(key).with("number", number)).failed()
}

/// How the panel is set, sentence by sentence, where it is not as usual.
pub(crate) fn panel_sentences(rates: &MachineRates, speech: Speech) -> Vec<(&'static str, String)> {
    let panel = &rates.panel;
    let percent = |part: f64| format!("{}", (part * 1e4).round() / 1e2);
    let speed = |per_min: f64| format!("{}", (per_min * 10.0).round() / 10.0);
    let said = |key: &'static str, value: String| {
        (key, speech.fill(&format!("estimate-{key}"), &[("value", &value)]))
    };
    let mut sentences = Vec::new();
    if let Some(dry) = panel.dry_run_mm_per_min {
        sentences.push(said("panel-dry-run", speed(dry)));
    } else if panel.feed != 1.0 {
        sentences.push(said("panel-feed-override", percent(panel.feed)));
    }
    match panel.rapid {
        RapidOverride::Lowest => {
            sentences.push(said("panel-rapid-lowest", speed(rates.panel_rules.rapid_lowest_per_min)));
        }
        RapidOverride::Part(1.0) => {}
        RapidOverride::Part(part) => {
            sentences.push(said("panel-rapid-override", percent(part)));
        }
    }
    if panel.single_block {
        sentences.push(said("panel-single-block", String::new()));
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(text: &str) -> Result<Moment, String> {
        text.parse()
    }

    #[test]
    fn times_and_switches_are_read_as_an_operator_says_them() {
        assert_eq!("12.5..15".parse(), Ok(Hold { from_s: 12.5, to_s: Some(15.0) }));
        assert_eq!("0..".parse(), Ok(Hold { from_s: 0.0, to_s: None }));
        let all = moment("3.2:feed=150%,rapid=f0,dry-run=on,single-block=off,hold,start").expect("switches");
        let expected = [
            Turned::Feed(1.5),
            Turned::Rapid(RapidOverride::Lowest),
            Turned::DryRun(Some(DryRun::OfParameter)),
            Turned::SingleBlock(false),
            Turned::Held(true),
            Turned::Held(false),
        ];
        assert_eq!((all.at_s, &all.turned[..]), (3.2, &expected[..]));
        assert_eq!(
            moment("1:dry-run=2500").expect("a speed").turned,
            [Turned::DryRun(Some(DryRun::At(2500.0)))]
        );
        assert_eq!(moment("1:dry-run=off").expect("off").turned, [Turned::DryRun(None)]);
    }

    #[test]
    fn what_no_panel_has_is_refused() {
        for text in ["15..12", "-1..2", "3", "..4", "1..nan", "1..inf", "a..b", "1e9..2e9", "4..4"] {
            assert!(text.parse::<Hold>().is_err(), "{text}");
        }
        for text in [
            "feed=50",
            "-1:feed=50",
            "1:",
            "1:feed",
            "1:feed=255",
            "1:feed=-1",
            "1:feed=nan",
            "1:rapid=0",
            "1:rapid=101",
            "1:rapid=F1",
            "1:hold=1",
            "1:dry-run=0",
            "1:dry-run=-5",
            "1:dry-run=250000",
            "1:single-block",
            "1:single-block=yes",
            "1:speed=50",
            "1:feed=50,",
            "nan:hold",
        ] {
            assert!(moment(text).is_err(), "{text}");
        }
        assert_eq!(moment("1:feed=254").map(|moment| moment.turned), Ok(vec![Turned::Feed(2.54)]));
        assert_eq!(moment("1:feed=0").map(|moment| moment.turned), Ok(vec![Turned::Feed(0.0)]));
    }
}
