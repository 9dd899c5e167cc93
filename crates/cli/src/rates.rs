//! What the machine of a setup can do, for the motion crate.

use turnwright_control::{Machine, Parameters};
use turnwright_motion::{
    AccDec, AfterLaw, Arrival, AuxiliaryTimes, AxisDynamics, Dynamics, Fluctuation, Gear, GearSelection,
    Gears, MachineRates, Orientation, PanelRules, RapidSurfaceSpeed, SpeedWait,
};
use turnwright_units::Rpm;

/// Rates, times, acceleration and jerk.
pub(crate) fn rates(machine: &Machine, parameters: &Parameters, stops_optionally: bool) -> MachineRates {
    let axes = &machine.axes;
    let usual = MachineRates::default();
    let rapid_y = axes.y.as_ref().map(|axis| axis.rapid_mm_per_min);
    let rapid_b = axes.b.as_ref().map(|axis| axis.rapid_deg_per_min);
    let c = axes.c.as_ref();
    MachineRates {
        rapid_y_mm_per_min: rapid_y.unwrap_or(usual.rapid_y_mm_per_min),
        rapid_c_deg_per_min: c.map_or(usual.rapid_c_deg_per_min, |axis| axis.rapid_deg_per_min),
        rapid_b_deg_per_min: rapid_b.unwrap_or(usual.rapid_b_deg_per_min),
        cutting_max_c_deg_per_min: c
            .map_or(usual.cutting_max_c_deg_per_min, |axis| axis.cutting_max_deg_per_min),
        rapid_x_mm_per_min: machine.rapid_x_mm_per_min,
        rapid_z_mm_per_min: machine.rapid_z_mm_per_min,
        home_mm_per_min: parameters.value("reference-return-rate").max(0.0),
        cutting_max_mm_per_min: machine.cutting_max_mm_per_min,
        tool_change_s: machine.tool_change_s,
        spindle_ramp_rpm_per_s: machine.spindle_ramp_rpm_per_s,
        auxiliary_s: machine.auxiliary_s,
        auxiliary_times: AuxiliaryTimes::new(machine.auxiliary_times()),
        speed_wait: match machine.speed_wait {
            turnwright_control::SpeedWait::Order => SpeedWait::Order,
            turnwright_control::SpeedWait::Cut => SpeedWait::Cut,
            turnwright_control::SpeedWait::Thread => SpeedWait::Thread,
        },
        arrival: Arrival {
            before_cut: parameters.bit("wait-for-speed"),
            before_thread: parameters.bit("wait-for-speed-before-thread"),
            delay_s: parameters.value("speed-arrival-delay").max(0.0) / 1e3,
        },
        gears: gears(machine),
        holds_tapping: parameters.bit("rigid-tap-feed-hold"),
        fluctuation: Fluctuation { part: machine.fluctuation_percent / 100.0, hz: machine.fluctuation_hz },
        orientation: machine.orientation_m.map(|code| Orientation { code, seconds: machine.orientation_s }),
        stop_s: machine.stop_s,
        optional_stop_s: if stops_optionally { machine.stop_s } else { 0.0 },
        loading_s: machine.loading_s + machine.bar_feed_s,
        rpm_max: (machine.rpm_max > 0).then_some(Rpm(machine.rpm_max)),
        rpm_min_surface: machine.rpm_min_surface,
        rapid_surface_speed: if parameters.bit("rapid-surface-speed-at-current-point") {
            RapidSurfaceSpeed::AtPresentPoint
        } else {
            RapidSurfaceSpeed::AtEndPoint
        },
        dynamics: Some(dynamics(machine)),
        after: if machine.acc_dec == turnwright_control::AccDec::AfterExponential {
            AfterLaw::Exponential
        } else {
            AfterLaw::Even
        },
        panel_rules: PanelRules {
            rapid_lowest_per_min: parameters.value("rapid-rate-lowest"),
            rapids_heed_feed: parameters.bit("rapid-stops-with-feed-override"),
            dry_rapids: parameters.bit("dry-run-of-rapids"),
            dry_threads: !parameters.bit("dry-run-off-in-threads"),
            ..usual.panel_rules
        },
        ..usual
    }
}

fn gears(machine: &Machine) -> Gears {
    let gears = machine.gears.iter().zip(machine.gear_codes()).map(|(gear, code)| Gear {
        code,
        rpm_min: f64::from(gear.rpm_min),
        rpm_max: f64::from(gear.rpm_max),
        ramp_rpm_per_s: gear.ramp_rpm_per_s.unwrap_or(machine.spindle_ramp_rpm_per_s),
    });
    let mut gears = Gears::new(gears);
    gears.selection = match machine.gear_selection {
        turnwright_control::GearSelection::MCode => GearSelection::ByCode,
        turnwright_control::GearSelection::Speed => GearSelection::BySpeed,
    };
    (gears.change_s, gears.change_rpm) = (machine.gear_change_s, f64::from(machine.gear_change_rpm));
    gears
}

fn dynamics(machine: &Machine) -> Dynamics {
    let usual = Dynamics::default();
    let axis = |acceleration_per_s2, jerk_per_s3| AxisDynamics { acceleration_per_s2, jerk_per_s3 };
    let [_, _, usual_y, usual_c, usual_b, _] = usual.axes;
    let axes = &machine.axes;
    let x = axis(machine.acceleration_x_mm_per_s2, machine.jerk_x_mm_per_s3);
    let z = axis(machine.acceleration_z_mm_per_s2, machine.jerk_z_mm_per_s3);
    let y = axes.y.as_ref().map_or(usual_y, |y| axis(y.acceleration_mm_per_s2, y.jerk_mm_per_s3));
    let c = axes.c.as_ref().map_or(usual_c, |c| axis(c.acceleration_deg_per_s2, c.jerk_deg_per_s3));
    let b = axes.b.as_ref().map_or(usual_b, |b| axis(b.acceleration_deg_per_s2, b.jerk_deg_per_s3));
    // A virtual axis is made by X and the rotary axis: it is taken to be no quicker than X.
    let acc_dec = match machine.acc_dec {
        // What parameters leave open keeps the path.
        turnwright_control::AccDec::Before | turnwright_control::AccDec::ByParameter => AccDec::Before,
        turnwright_control::AccDec::After | turnwright_control::AccDec::AfterExponential => AccDec::After,
    };
    let (corner_s, in_position_s) = (machine.corner_s, machine.in_position_s);
    let cutting_mm_per_s2 = machine.acceleration_cutting_mm_per_s2.unwrap_or(f64::INFINITY);
    Dynamics { acc_dec, axes: [x, z, y, c, b, x], cutting_mm_per_s2, corner_s, in_position_s }
}
