//! The text listing of commands: what fixtures and people read.
//!
//! One command a line, lengths in millimetres, X as `d` (diameter):
//! `feed d40 z-15 f0.3/rev` · `cw d36 z-45 c(d36 z-42) f0.3/rev` · `rapid d46 z0.5`.
//!
//! Ellipses have centre, half axes and tilt (`ellipse-cw d40 z-20 c(d0 z-20) a20 b20 tilt0 …`), parabolas vertex, focal
//! parameter and tilt; a thread that goes on from the move before is `chained`.
//!
//! Other axes follow the position: `c90` and `b30` in degrees, `y5` in millimetres, `v` the place on the virtual
//! axis; the centre of an arc across the section names its two axes, `c(d40 y0)`.
//!
//! With nose compensation the place of the nose centre follows: `nose(d41.6 z-15)`.

use turnwright_units::{Feed, Position, WorkTip, write_degrees, write_fixed, write_millimetres};

use crate::{
    Action, Command, Coolant, Curve, Dwell, Interpolation, OtherAxes, PathMode, Shape, SidePlane,
    SpindleSpeed, SpindleState,
};

/// Writes one command, without a line end, its lengths rounded to `decimals` places.
pub fn write_listing(out: &mut Vec<u8>, command: &Command, decimals: u8) {
    match &command.action {
        Action::Rapid { to, others, .. } => {
            out.extend_from_slice(b"rapid");
            write_position(out, *to, decimals);
            write_others(out, others.as_deref(), decimals);
        }
        Action::Feed { to, shape, feed, others } => {
            match shape {
                Shape::Line => out.extend_from_slice(b"feed"),
                shape => out.extend_from_slice(shape.word().as_bytes()),
            }
            write_position(out, *to, decimals);
            write_others(out, others.as_deref(), decimals);
            let side = if others.as_deref().is_some_and(|others| others.v.is_some()) { b'v' } else { b'y' };
            write_shape(out, shape, side, decimals);
            out.extend_from_slice(b" f");
            write_millimetres(out, feed.length(), 6);
            out.extend_from_slice(match feed {
                Feed::PerMinute(_) => b"/min",
                Feed::PerRevolution(_) => b"/rev",
            });
        }
        Action::Thread { to, shape, lead, lead_end, start_angle, is_chained } => {
            out.extend_from_slice(b"thread");
            if *shape != Shape::Line {
                out.push(b' ');
                out.extend_from_slice(shape.word().as_bytes());
            }
            write_position(out, *to, decimals);
            write_shape(out, shape, b'y', decimals);
            out.extend_from_slice(b" lead");
            write_millimetres(out, lead.0, 6);
            if let Some(end) = lead_end {
                out.extend_from_slice(b"..");
                write_millimetres(out, end.0, 6);
            }
            if *is_chained {
                out.extend_from_slice(b" chained");
            } else if start_angle.millidegrees() != 0 {
                out.extend_from_slice(b" q");
                write_fixed(out, start_angle.millidegrees(), 3);
            }
        }
        Action::Relocate { to, others } => {
            out.extend_from_slice(b"relocate");
            write_position(out, *to, decimals);
            write_others(out, others.as_deref(), decimals);
        }
        Action::Interpolation(Interpolation::Normal) => out.extend_from_slice(b"interpolation normal"),
        Action::Interpolation(Interpolation::Polar { zero, .. }) => {
            out.extend_from_slice(b"interpolation polar c");
            write_degrees(out, *zero, decimals);
        }
        Action::Interpolation(Interpolation::Cylindrical { radius }) => {
            out.extend_from_slice(b"interpolation cylindrical r");
            write_millimetres(out, radius.0, decimals);
        }
        Action::Coupling(Some(ratio)) => {
            out.extend_from_slice(format!("coupling {}:{}", ratio.spindle, ratio.other).as_bytes());
        }
        Action::Coupling(None) => out.extend_from_slice(b"coupling off"),
        Action::RigidTapping(true) => out.extend_from_slice(b"rigid-tapping on"),
        Action::SpindleWatch(Some(watch)) => {
            let [reached, allowed] =
                [watch.reached_permille, watch.allowed_permille].map(|permille| f64::from(permille) / 10.0);
            let (delay, band) = (watch.delay_ms, watch.band.0);
            let text = format!("spindle-watch {delay}ms reached{reached}% allowed{allowed}% band{band}rpm");
            out.extend_from_slice(text.as_bytes());
        }
        Action::PanelLock(lock) => {
            out.extend_from_slice(b"panel-lock");
            let switches = [
                (*lock == crate::PanelLock::default(), b" off".as_slice()),
                (lock.hold, b" hold"),
                (lock.feed_override, b" override"),
                (lock.dry_run, b" dry-run"),
            ];
            switches
                .into_iter()
                .filter(|(is_locked, _)| *is_locked)
                .for_each(|(_, word)| out.extend_from_slice(word));
        }
        Action::SpindleWatch(None) => out.extend_from_slice(b"spindle-watch off"),
        Action::RigidTapping(false) => out.extend_from_slice(b"rigid-tapping off"),
        Action::PathMode(mode) => out.extend_from_slice(match mode {
            PathMode::Continuous => b"path continuous",
            PathMode::ExactStop => b"path exact-stop",
            PathMode::Tapping => b"path tapping",
        }),
        Action::Dwell(Dwell::Time(seconds)) => {
            out.extend_from_slice(format!("dwell {}s", seconds.0).as_bytes());
        }
        Action::Dwell(Dwell::Turns(turns)) => {
            out.extend_from_slice(format!("dwell {}rev", turns.0).as_bytes());
        }
        Action::Spindle { state, speed, rpm_max } => {
            out.extend_from_slice(match state {
                SpindleState::Clockwise => b"spindle cw",
                SpindleState::CounterClockwise => b"spindle ccw",
                SpindleState::Stop => b"spindle stop",
            });
            match speed {
                SpindleSpeed::Constant(rpm) => out.extend_from_slice(format!(" {}rpm", rpm.0).as_bytes()),
                SpindleSpeed::Surface(speed) => {
                    out.extend_from_slice(format!(" {}m/min", speed.to_m_per_min()).as_bytes());
                }
            }
            if let Some(rpm) = rpm_max {
                out.extend_from_slice(format!(" max{}", rpm.0).as_bytes());
            }
        }
        Action::Tool { tool, offset } => {
            out.extend_from_slice(format!("tool {tool} offset {offset}").as_bytes());
        }
        Action::Coolant(Coolant::On) => out.extend_from_slice(b"coolant on"),
        Action::Coolant(Coolant::Off) => out.extend_from_slice(b"coolant off"),
        Action::Auxiliary { code } => out.extend_from_slice(format!("auxiliary {code}").as_bytes()),
        Action::SecondAuxiliary { letter, code } => {
            out.extend_from_slice(format!("auxiliary {}{code}", char::from(*letter)).as_bytes());
        }
        Action::Stop => out.extend_from_slice(b"stop"),
        Action::OptionalStop => out.extend_from_slice(b"optional-stop"),
        Action::End => out.extend_from_slice(b"end"),
        Action::Message(text) => {
            out.extend_from_slice(b"message ");
            out.extend_from_slice(text.as_bytes());
        }
        Action::Output(text) => {
            out.extend_from_slice(b"output ");
            out.extend_from_slice(text.as_bytes());
        }
    }
    if let Some(nose) = &command.nose {
        out.extend_from_slice(b" nose(d");
        write_millimetres(out, nose.x.to_diameter().0, decimals);
        out.extend_from_slice(b" z");
        write_millimetres(out, nose.z, decimals);
        out.push(b')');
    }
    if let Some(cycle) = &command.origin.cycle {
        out.extend_from_slice(format!("  {} {}", cycle.label, cycle.phase.word()).as_bytes());
        if cycle.pass > 0 {
            out.extend_from_slice(format!(" {}", cycle.pass).as_bytes());
        }
    }
}

/// The data of a shape that is no line; `side` names the axis across the section.
fn write_shape(out: &mut Vec<u8>, shape: &Shape, side: u8, decimals: u8) {
    let place = |out: &mut Vec<u8>, name: &[u8], place| {
        out.extend_from_slice(name);
        let before = out.len();
        write_position(out, place, decimals);
        out.remove(before);
        out.push(b')');
    };
    let length = |out: &mut Vec<u8>, name: &[u8], length| {
        out.extend_from_slice(name);
        write_millimetres(out, length, decimals);
    };
    let tilt = match shape {
        Shape::Line => return,
        Shape::Arc { centre, .. } => return place(out, b" c(", *centre),
        Shape::SideArc { plane, centre, .. } => {
            match plane {
                SidePlane::Face => length(out, b" c(d", centre.along + centre.along),
                SidePlane::Flank | SidePlane::Wall => length(out, b" c(z", centre.along),
            }
            length(out, &[b' ', side], centre.side);
            return out.push(b')');
        }
        Shape::Curve(curve) => match &**curve {
            Curve::Ellipse { centre, half_along, half_across, tilt, .. } => {
                place(out, b" c(", *centre);
                length(out, b" a", *half_along);
                length(out, b" b", *half_across);
                tilt
            }
            Curve::Parabola { vertex, focal_parameter, tilt, .. } => {
                place(out, b" v(", *vertex);
                length(out, b" p", *focal_parameter);
                tilt
            }
        },
    };
    out.extend_from_slice(b" tilt");
    write_fixed(out, tilt.millidegrees(), 3);
}

fn write_others(out: &mut Vec<u8>, others: Option<&OtherAxes>, decimals: u8) {
    let Some(others) = others else { return };
    for (name, length) in [(b" y", others.y), (b" v", others.v)] {
        if let Some(length) = length {
            out.extend_from_slice(name);
            write_millimetres(out, length, decimals);
        }
    }
    for (name, angle) in [(b" c", others.c), (b" b", others.b)] {
        if let Some(angle) = angle {
            out.extend_from_slice(name);
            write_degrees(out, angle, decimals);
        }
    }
}

fn write_position(out: &mut Vec<u8>, to: Position<WorkTip>, decimals: u8) {
    out.extend_from_slice(b" d");
    write_millimetres(out, to.x.to_diameter().0, decimals);
    out.extend_from_slice(b" z");
    write_millimetres(out, to.z, decimals);
}
