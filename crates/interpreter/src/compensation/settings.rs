//! Parameters of nose compensation.

use turnwright_control::Parameters;
use turnwright_control::policy::{Policies, StartUpTypeC};
use turnwright_geometry::{Joints, StartUp};

/// Parameters of nose compensation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompensationSettings {
    /// G41 and G42 act.
    pub(crate) is_available: bool,
    /// G41 and G42 are refused in programs typed in at the panel.
    pub(crate) refused_in_mdi: bool,
    /// G40 to G42 may stand in the figure of a roughing cycle.
    pub(crate) allowed_in_figure: bool,
    /// Compensation of the figure acts in roughing.
    pub(crate) roughs_compensated: bool,
    /// How moves lead onto the path and off it.
    pub(crate) start_up: StartUp,
    /// A code alone moves the nose to the path or off it.
    pub(crate) shifts_without_move: bool,
    /// How corners are passed.
    pub(crate) joints: Joints,
    /// Interference is looked for.
    pub(crate) checks: bool,
    /// A nose centre that runs against its line is interference.
    pub(crate) checks_direction: bool,
    /// Lines shorter than the nose needs are no alarm.
    pub(crate) small_step_allowed: bool,
    /// Arcs smaller than the nose are no alarm.
    pub(crate) small_arc_allowed: bool,
}

impl CompensationSettings {
    pub(crate) fn new(parameters: &Parameters, policies: &Policies) -> Self {
        /// Shifted elements meet when they miss by no more than their numbers are rounded.
        const ROUNDING_MM: f64 = 1e-6;
        let bit = |name| parameters.bit(name);
        let value = |name| parameters.value(name).max(0.0);
        let (along, type_c) = (bit("compensation-start-b"), bit("compensation-start-c"));
        let both = type_c && policies.start_up_type_c == StartUpTypeC::BothSquare;
        Self {
            is_available: bit("compensation-available"),
            refused_in_mdi: bit("compensation-in-mdi-alarm"),
            allowed_in_figure: bit("compensation-codes-in-figure"),
            roughs_compensated: bit("roughing-with-compensation"),
            start_up: match (both, along) {
                (true, _) => StartUp::BothSquare,
                (false, true) => StartUp::AlongPath,
                (false, false) => StartUp::Direct,
            },
            shifts_without_move: type_c && !both,
            joints: Joints {
                straight_rad: value("compensation-angle-tolerance").min(10.0).to_radians(),
                gap_mm: value("compensation-joint-gap").max(ROUNDING_MM),
                ignored_mm: value("compensation-ignored-move"),
                round: bit("compensation-joins-by-arc"),
            },
            checks: !bit("compensation-check-off"),
            checks_direction: !bit("compensation-direction-check-off"),
            small_step_allowed: bit("compensation-small-step-allowed"),
            small_arc_allowed: bit("compensation-small-arc-allowed"),
        }
    }
}
