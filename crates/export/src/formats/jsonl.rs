//! The trace: one JSON object a line, one line a command. The format is a promise to users' scripts.
//!
//! In: commands in order of execution. Out: bytes appended to a buffer that the caller empties.
//! Lengths are millimetres, X values and arc centres in X are diameters. Of the axes beyond X and Z a move has only
//! those that it takes along: `y` in millimetres, `c` and `b` in degrees that count on over full turns, and `v`, the
//! place on the virtual axis of polar or cylindrical interpolation (a line of `op` `interpolation` says which). Arcs
//! in a plane with `y` or `v` name it: `face` (X and the side axis), `flank` or `wall` (Z and the side axis, seen
//! from either side), with the centre as `cx` or `cz`, and `cs`. `coupling` is another rotation in step with the
//! spindle; 0 to 0 ends it. `rigid-tapping` says that threads lead the spindle from here on, or no longer, and
//! `spindle-watch` how its speed is watched (G26), in percent, rpm and milliseconds. While nose compensation is on,
//! moves also have `nx` and `nz`, the centre of the nose. Fields stand in a fixed order and numbers carry no trailing
//! zeros, so that equal runs give equal bytes. A line of another file than the program's own (a subprogram of the same
//! folder) ends with `file`, the name of that file. Writing a command allocates nothing but room in the buffer.

use turnwright_canon::{
    Action, Command, Coolant, Curve, CycleOrigin, Dwell, Interpolation, Origin, OtherAxes, PathMode, Shape,
    SidePlane, SpindleSpeed, SpindleState,
};
use turnwright_units::{
    Feed, LeastIncrement, Length, Position, WorkNose, WorkTip, write_degrees, write_fixed, write_millimetres,
    write_whole,
};

/// Decimal places of feeds, leads and seconds, which are finer than any least increment.
const FINE_DECIMALS: u8 = 6;

/// What the first line says.
#[derive(Clone, Copy, Debug)]
pub struct TraceHeader<'a> {
    /// Name of the control that the program ran on.
    pub control: &'a str,
}

/// The alarm that ended the run, in words already chosen.
#[derive(Clone, Copy, Debug)]
pub struct TraceAlarm<'a> {
    /// The control's own number, as it prints it.
    pub id: &'a str,
    /// Name of the diagnostic.
    pub key: &'a str,
    /// The control's own words.
    pub message: &'a str,
    /// Line, from 1.
    pub line: u32,
    /// Sequence number of the block.
    pub sequence: Option<u32>,
    /// Program number.
    pub program: Option<u32>,
    /// Call depth, 0 in the main program.
    pub depth: u8,
    /// The file of the line, when it is not that of the program.
    pub file: Option<&'a str>,
}

/// Writes the first line.
pub fn write_header(out: &mut Vec<u8>, header: &TraceHeader<'_>) {
    out.extend_from_slice(br#"{"turnwright":"trace","version":1,"control":"#);
    write_json_string(out, header.control);
    out.extend_from_slice(b",\"units\":\"mm\",\"x\":\"diameter\",\"frame\":\"work\"}\n");
}

/// Text that many lines have in common, made once for what it says.
#[derive(Clone, Debug)]
struct Common<K> {
    says: Option<K>,
    text: Vec<u8>,
}

impl<K: PartialEq> Common<K> {
    const fn new() -> Self {
        Self { says: None, text: Vec::new() }
    }

    #[inline]
    fn write(&mut self, out: &mut Vec<u8>, says: K, make: impl FnOnce(&mut Vec<u8>, &K)) {
        if self.says.as_ref() != Some(&says) {
            self.text.clear();
            make(&mut self.text, &says);
            self.says = Some(says);
        }
        out.extend_from_slice(&self.text);
    }
}

/// Where a command outside cycles stands, without its line and sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Surroundings {
    program: Option<u32>,
    depth: u8,
    runs_on: bool,
}

/// Writes commands, a line each.
#[derive(Clone, Debug)]
pub struct CommandWriter {
    decimals: u8,
    feed: Common<Feed>,
    surroundings: Common<Surroundings>,
}

impl CommandWriter {
    /// Lengths are rounded to so many decimal places.
    pub const fn new(decimals: u8) -> Self {
        Self { decimals, feed: Common::new(), surroundings: Common::new() }
    }

    /// Writes one command and its line end.
    pub fn write(&mut self, out: &mut Vec<u8>, command: &Command) {
        let decimals = self.decimals;
        match &command.action {
            // No line of its own: each move says where it ends in the coordinates in force.
            Action::Relocate { .. } => return,
            Action::Feed { to, shape, feed, others } => {
                out.extend_from_slice(br#"{"op":"feed""#);
                write_end_point(out, *to, decimals);
                match shape {
                    Shape::Line => out.extend_from_slice(br#","shape":"line""#),
                    shape => write_shape(out, *to, shape, others.as_deref(), decimals),
                }
                self.feed.write(out, *feed, write_feed);
                if let Some(others) = others {
                    write_others(out, others, decimals);
                }
            }
            action => write_action(out, action, decimals),
        }
        if let Some(nose) = &command.nose {
            write_nose(out, **nose, decimals);
        }
        let Origin { line, sequence, program, depth, cycle, runs_on, .. } = command.origin;
        write_number(out, br#","line":"#, line);
        if let Some(sequence) = sequence {
            write_number(out, br#","n":"#, sequence);
        }
        match cycle {
            None => {
                self.surroundings.write(out, Surroundings { program, depth, runs_on }, write_surroundings)
            }
            Some(cycle) => {
                write_program(out, program, depth);
                write_cycle(out, &cycle);
                write_end(out, runs_on);
            }
        }
    }

    /// The same for a line of another file than that of the program: the object ends with `file`.
    #[cold]
    pub fn write_of_file(&mut self, out: &mut Vec<u8>, command: &Command, file: &str) {
        let before = out.len();
        self.write(out, command);
        if out.len() > before {
            write_file(out, file);
        }
    }
}

/// What is no feed, without the fields that every command has.
fn write_action(out: &mut Vec<u8>, action: &Action, decimals: u8) {
    match action {
        Action::Rapid { to, path: _, others } => {
            out.extend_from_slice(br#"{"op":"rapid""#);
            write_end_point(out, *to, decimals);
            if let Some(others) = others {
                write_others(out, others, decimals);
            }
        }
        Action::Feed { .. } | Action::Relocate { .. } => {}
        Action::Thread { to, shape, lead, lead_end, start_angle, is_chained } => {
            out.extend_from_slice(br#"{"op":"thread""#);
            write_end_point(out, *to, decimals);
            if *shape != Shape::Line {
                write_shape(out, *to, shape, None, decimals);
            }
            write_length(out, br#","lead":"#, lead.0, FINE_DECIMALS);
            out.extend_from_slice(br#","q":"#);
            write_fixed(out, start_angle.millidegrees(), 3);
            if let Some(end) = lead_end {
                write_length(out, br#","lead_end":"#, end.0, FINE_DECIMALS);
            }
            if *is_chained {
                out.extend_from_slice(br#","chained":true"#);
            }
        }
        Action::PathMode(mode) => out.extend_from_slice(match mode {
            PathMode::Continuous => br#"{"op":"path-mode","mode":"continuous""#.as_slice(),
            PathMode::ExactStop => br#"{"op":"path-mode","mode":"exact-stop""#,
            PathMode::Tapping => br#"{"op":"path-mode","mode":"tapping""#,
        }),
        Action::Dwell(Dwell::Time(time)) => {
            out.extend_from_slice(br#"{"op":"dwell","seconds":"#);
            write_float(out, time.0);
        }
        Action::Dwell(Dwell::Turns(turns)) => {
            out.extend_from_slice(br#"{"op":"dwell","revolutions":"#);
            write_float(out, turns.0);
        }
        Action::Spindle { state, speed, rpm_max } => {
            out.extend_from_slice(match state {
                SpindleState::Clockwise => br#"{"op":"spindle","state":"cw""#.as_slice(),
                SpindleState::CounterClockwise => br#"{"op":"spindle","state":"ccw""#,
                SpindleState::Stop => br#"{"op":"spindle","state":"stop""#,
            });
            match speed {
                SpindleSpeed::Constant(rpm) => write_number(out, br#","mode":"rpm","s":"#, rpm.0),
                SpindleSpeed::Surface(speed) => {
                    out.extend_from_slice(br#","mode":"css","s":"#);
                    // Whole nanometres are ninth decimals of a metre.
                    write_fixed(out, speed.0.nm(), 9);
                }
            }
            if let Some(rpm) = rpm_max {
                write_number(out, br#","max_rpm":"#, rpm.0);
            }
        }
        Action::Interpolation(interpolation) => write_interpolation(out, *interpolation, decimals),
        Action::Coupling(ratio) => {
            write_number(out, br#"{"op":"coupling","spindle":"#, ratio.map_or(0, |ratio| ratio.spindle));
            out.extend_from_slice(br#","other":"#);
            write_fixed(out, ratio.map_or(0, |ratio| ratio.other).into(), 0);
        }
        Action::RigidTapping(true) => out.extend_from_slice(br#"{"op":"rigid-tapping","on":true"#),
        Action::RigidTapping(false) => out.extend_from_slice(br#"{"op":"rigid-tapping","on":false"#),
        Action::SpindleWatch(Some(watch)) => {
            write_number(out, br#"{"op":"spindle-watch","on":true,"delay_ms":"#, watch.delay_ms);
            out.extend_from_slice(br#","reached_percent":"#);
            write_fixed(out, watch.reached_permille.into(), 1);
            out.extend_from_slice(br#","allowed_percent":"#);
            write_fixed(out, watch.allowed_permille.into(), 1);
            write_number(out, br#","band_rpm":"#, watch.band.0);
        }
        Action::PanelLock(lock) => {
            let turnwright_canon::PanelLock { hold, feed_override, dry_run } = lock;
            let text = format!(
                r#"{{"op":"panel-lock","hold":{hold},"override":{feed_override},"dry_run":{dry_run}"#
            );
            out.extend_from_slice(text.as_bytes());
        }
        Action::SpindleWatch(None) => out.extend_from_slice(br#"{"op":"spindle-watch","on":false"#),
        Action::Tool { tool, offset } => {
            write_number(out, br#"{"op":"tool","tool":"#, *tool);
            write_number(out, br#","offset":"#, *offset);
        }
        Action::Coolant(Coolant::On) => out.extend_from_slice(br#"{"op":"coolant","on":true"#),
        Action::Coolant(Coolant::Off) => out.extend_from_slice(br#"{"op":"coolant","on":false"#),
        Action::Auxiliary { code } => write_number(out, br#"{"op":"m","code":"#, *code),
        Action::SecondAuxiliary { letter, code } => {
            out.extend_from_slice(br#"{"op":"second-auxiliary","letter":"#);
            write_json_string(out, char::from(*letter).encode_utf8(&mut [0; 4]));
            write_number(out, br#","code":"#, *code);
        }
        Action::Stop => out.extend_from_slice(br#"{"op":"stop""#),
        Action::OptionalStop => out.extend_from_slice(br#"{"op":"optional-stop""#),
        Action::End => out.extend_from_slice(br#"{"op":"end""#),
        Action::Message(text) => {
            out.extend_from_slice(br#"{"op":"message","text":"#);
            write_json_string(out, text);
        }
        Action::Output(text) => {
            out.extend_from_slice(br#"{"op":"output","text":"#);
            write_json_string(out, text);
        }
    }
}

/// The centre of the nose at the end of a move.
#[cold]
fn write_nose(out: &mut Vec<u8>, nose: Position<WorkNose>, decimals: u8) {
    write_length(out, br#","nx":"#, nose.x.to_diameter().0, decimals);
    write_length(out, br#","nz":"#, nose.z, decimals);
}

/// Adds the file to the object just written.
fn write_file(out: &mut Vec<u8>, file: &str) {
    out.truncate(out.len() - b"}\n".len());
    out.extend_from_slice(br#","file":"#);
    write_json_string(out, file);
    out.extend_from_slice(b"}\n");
}

/// Writes the alarm that ended the run: the last line.
pub fn write_alarm(out: &mut Vec<u8>, alarm: &TraceAlarm<'_>) {
    out.extend_from_slice(br#"{"op":"alarm","id":"#);
    write_json_string(out, alarm.id);
    out.extend_from_slice(br#","key":"#);
    write_json_string(out, alarm.key);
    out.extend_from_slice(br#","message":"#);
    write_json_string(out, alarm.message);
    write_number(out, br#","line":"#, alarm.line);
    if let Some(sequence) = alarm.sequence {
        write_number(out, br#","n":"#, sequence);
    }
    write_program(out, alarm.program, alarm.depth);
    write_end(out, false);
    if let Some(file) = alarm.file {
        write_file(out, file);
    }
}

fn write_feed(out: &mut Vec<u8>, feed: &Feed) {
    write_length(out, br#","f":"#, feed.length(), FINE_DECIMALS);
    out.extend_from_slice(match feed {
        Feed::PerRevolution(_) => br#","fu":"mm/rev""#.as_slice(),
        Feed::PerMinute(_) => br#","fu":"mm/min""#,
    });
}

/// Ends of the axes beyond X and Z: only of those that the move takes along.
#[cold]
fn write_others(out: &mut Vec<u8>, others: &OtherAxes, decimals: u8) {
    if let Some(y) = others.y {
        write_length(out, br#","y":"#, y, decimals);
    }
    if let Some(v) = others.v {
        write_length(out, br#","v":"#, v, decimals);
    }
    for (name, angle) in [(br#","c":"#, others.c), (br#","b":"#, others.b)] {
        if let Some(angle) = angle {
            out.extend_from_slice(name);
            write_degrees(out, angle, decimals);
        }
    }
}

#[cold]
fn write_interpolation(out: &mut Vec<u8>, interpolation: Interpolation, decimals: u8) {
    match interpolation {
        Interpolation::Normal => out.extend_from_slice(br#"{"op":"interpolation","mode":"normal""#),
        Interpolation::Polar { zero, .. } => {
            out.extend_from_slice(br#"{"op":"interpolation","mode":"polar","c_zero":"#);
            write_degrees(out, zero, decimals);
        }
        Interpolation::Cylindrical { radius } => {
            write_length(out, br#"{"op":"interpolation","mode":"cylindrical","r":"#, radius.0, decimals);
        }
    }
}

/// The shape's word and what it is shaped by: centres and vertices with X as a diameter, everything else as it is
/// measured in the half-section.
fn write_shape(
    out: &mut Vec<u8>,
    to: Position<WorkTip>,
    shape: &Shape,
    others: Option<&OtherAxes>,
    decimals: u8,
) {
    out.extend_from_slice(br#","shape":""#);
    out.extend_from_slice(shape.word().as_bytes());
    out.push(b'"');
    let centre = |out: &mut Vec<u8>, centre: &Position<WorkTip>| {
        write_length(out, br#","cx":"#, centre.x.to_diameter().0, decimals);
        write_length(out, br#","cz":"#, centre.z, decimals);
    };
    let tilt = match shape {
        Shape::Line => return,
        Shape::Arc { centre: middle, .. } => {
            centre(out, middle);
            return write_length(out, br#","r":"#, distance(to, *middle), decimals);
        }
        // The side axis is `cs`: the axis whose place the move gives, `y` or `v`.
        Shape::SideArc { plane, centre, .. } => {
            out.extend_from_slice(match plane {
                SidePlane::Face => br#","plane":"face""#.as_slice(),
                SidePlane::Flank => br#","plane":"flank""#,
                SidePlane::Wall => br#","plane":"wall""#,
            });
            match plane {
                SidePlane::Face => write_length(out, br#","cx":"#, centre.along + centre.along, decimals),
                SidePlane::Flank | SidePlane::Wall => write_length(out, br#","cz":"#, centre.along, decimals),
            }
            write_length(out, br#","cs":"#, centre.side, decimals);
            let end = plane.point(to, others.and_then(OtherAxes::side).unwrap_or_default());
            let mm = (end.along - centre.along).to_mm().hypot((end.side - centre.side).to_mm());
            let radius = Length::from_mm_rounded(mm, LeastIncrement::METRIC_C).unwrap_or(Length::ZERO);
            return write_length(out, br#","r":"#, radius, decimals);
        }
        Shape::Curve(curve) => match &**curve {
            Curve::Ellipse { centre: middle, half_along, half_across, tilt, .. } => {
                centre(out, middle);
                write_length(out, br#","a":"#, *half_along, decimals);
                write_length(out, br#","b":"#, *half_across, decimals);
                tilt
            }
            Curve::Parabola { vertex, focal_parameter, tilt, .. } => {
                write_length(out, br#","vx":"#, vertex.x.to_diameter().0, decimals);
                write_length(out, br#","vz":"#, vertex.z, decimals);
                write_length(out, br#","p":"#, *focal_parameter, decimals);
                tilt
            }
        },
    };
    out.extend_from_slice(br#","tilt":"#);
    write_fixed(out, tilt.millidegrees(), 3);
}

fn write_surroundings(out: &mut Vec<u8>, &Surroundings { program, depth, runs_on }: &Surroundings) {
    write_program(out, program, depth);
    write_end(out, runs_on);
}

fn write_program(out: &mut Vec<u8>, program: Option<u32>, depth: u8) {
    if let Some(program) = program {
        write_number(out, br#","o":"#, program);
    }
    write_number(out, br#","depth":"#, depth.into());
}

fn write_cycle(out: &mut Vec<u8>, cycle: &CycleOrigin) {
    // The label as a person writes it: two digits at least, a tenth only when there is one.
    out.extend_from_slice(br#","cycle":"G"#);
    let (whole, tenth) = (cycle.label.0 / 10, cycle.label.0 % 10);
    if whole < 10 {
        out.push(b'0');
    }
    write_whole(out, whole.into());
    if tenth != 0 {
        out.extend_from_slice(&[b'.', b'0' + tenth as u8]);
    }
    out.push(b'"');
    if cycle.pass > 0 {
        write_number(out, br#","pass":"#, cycle.pass);
    }
    out.extend_from_slice(br#","phase":""#);
    out.extend_from_slice(cycle.phase.word().as_bytes());
    out.push(b'"');
}

fn write_end(out: &mut Vec<u8>, runs_on: bool) {
    if runs_on {
        out.extend_from_slice(br#","runs_on":true"#);
    }
    out.extend_from_slice(b"}\n");
}

#[inline(always)]
fn write_end_point(out: &mut Vec<u8>, to: Position<WorkTip>, decimals: u8) {
    write_length(out, br#","x":"#, to.x.to_diameter().0, decimals);
    write_length(out, br#","z":"#, to.z, decimals);
}

/// Distance of two places, computed, so rounded to the finest increment; no distance fits when the centre is
/// farther away than any machine is long.
fn distance(a: Position<WorkTip>, b: Position<WorkTip>) -> Length {
    let way = a - b;
    let mm = way.x.to_mm().hypot(way.z.to_mm());
    Length::from_mm_rounded(mm, LeastIncrement::METRIC_C).unwrap_or(Length::ZERO)
}

// The names are constants: copied in line they cost a few stores, as calls a fifth of the time of a command.
#[inline(always)]
fn write_length(out: &mut Vec<u8>, name: &[u8], length: Length, decimals: u8) {
    out.extend_from_slice(name);
    write_millimetres(out, length, decimals);
}

#[inline(always)]
fn write_number(out: &mut Vec<u8>, name: &[u8], number: u32) {
    out.extend_from_slice(name);
    if number < 10 {
        out.push(b'0' + number as u8);
    } else {
        write_whole(out, number);
    }
}

/// A time or a number of turns. What is no number is written as JSON's `null`.
fn write_float(out: &mut Vec<u8>, number: f64) {
    let millionths = (number * 1e6).round();
    if millionths.is_finite() {
        write_fixed(out, millionths as i64, FINE_DECIMALS);
    } else {
        out.extend_from_slice(b"null");
    }
}

/// Writes any text as a JSON string with its quotation marks.
fn write_json_string(out: &mut Vec<u8>, text: &str) {
    const HEX: &[u8; 16] = b"0123456789abcdef";
    out.push(b'"');
    for &byte in text.as_bytes() {
        match byte {
            b'"' => out.extend_from_slice(b"\\\""),
            b'\\' => out.extend_from_slice(b"\\\\"),
            b'\n' => out.extend_from_slice(b"\\n"),
            b'\r' => out.extend_from_slice(b"\\r"),
            b'\t' => out.extend_from_slice(b"\\t"),
            0..0x20 | 0x7f => {
                out.extend_from_slice(b"\\u00");
                out.extend_from_slice(&[HEX[usize::from(byte >> 4)], HEX[usize::from(byte & 15)]]);
            }
            _ => out.push(byte),
        }
    }
    out.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use turnwright_canon::{CycleLabel, Phase, RapidPath, Turn};
    use turnwright_units::{
        Angle, FeedPerMinute, FeedPerRevolution, Lead, Radius, Revolutions, Rpm, Seconds, SurfaceSpeed,
    };

    /// A place from whole micrometres of diameter and Z.
    fn at(diameter_um: i64, z_um: i64) -> Position<WorkTip> {
        Position::new(Radius(Length::from_nm(diameter_um * 500)), Length::from_nm(z_um * 1000))
    }

    fn line_of(action: Action, origin: Origin) -> String {
        let mut out = Vec::new();
        CommandWriter::new(3).write(&mut out, &Command::new(action, origin));
        String::from_utf8(out).expect("JSON is UTF-8")
    }

    fn at_line_seven(action: Action) -> String {
        line_of(action, Origin::line(7))
    }

    #[test]
    fn other_axes_stand_behind_the_move_that_takes_them_along() {
        let others = OtherAxes {
            c: Some(Angle::from_millidegrees(90_500)),
            v: Some(Length::from_mm(20)),
            ..OtherAxes::default()
        };
        let to = Position::new(Radius(Length::ZERO), Length::from_mm(1));
        let rapid = Action::Rapid { to, path: RapidPath::Straight, others: Some(Box::new(others)) };
        let line = line_of(rapid, Origin::line(3));
        assert_eq!(line, "{\"op\":\"rapid\",\"x\":0,\"z\":1,\"v\":20,\"c\":90.5,\"line\":3,\"depth\":0}\n");
        let shape = Shape::SideArc {
            plane: SidePlane::Face,
            turn: Turn::Clockwise,
            centre: turnwright_canon::SidePoint { along: Length::from_mm(10), side: Length::ZERO },
        };
        let feed = Feed::PerMinute(FeedPerMinute(Length::from_mm(100)));
        let arc = Action::Feed { to, shape, feed, others: Some(Box::new(OtherAxes { c: None, ..others })) };
        let line = line_of(arc, Origin::line(3));
        assert!(line.contains(r#""shape":"cw","plane":"face","cx":20,"cs":0,"r":22.361,"#), "{line}");
        let polar = Interpolation::Polar { zero: Angle::ZERO, is_below: false };
        let line = line_of(Action::Interpolation(polar), Origin::line(3));
        assert!(line.starts_with(r#"{"op":"interpolation","mode":"polar","c_zero":0,"#), "{line}");
        let ratio = turnwright_canon::SpeedRatio { spindle: 1, other: -2 };
        let line = line_of(Action::Coupling(Some(ratio)), Origin::line(3));
        assert!(line.starts_with(r#"{"op":"coupling","spindle":1,"other":-2,"#), "{line}");
        let watch = turnwright_canon::SpindleWatch {
            delay_ms: 500,
            reached_permille: 50,
            allowed_permille: 125,
            band: Rpm(50),
        };
        let line = line_of(Action::SpindleWatch(Some(watch)), Origin::line(3));
        let expected =
            r#"{"op":"spindle-watch","on":true,"delay_ms":500,"reached_percent":5,"allowed_percent":12.5,"#;
        assert!(line.starts_with(expected) && line.contains(r#""band_rpm":50,"#), "{line}");
        let lock = turnwright_canon::PanelLock { hold: true, feed_override: false, dry_run: false };
        let line = line_of(Action::PanelLock(lock), Origin::line(3));
        assert!(
            line.starts_with(r#"{"op":"panel-lock","hold":true,"override":false,"dry_run":false,"#),
            "{line}"
        );
        let line = line_of(Action::RigidTapping(true), Origin::line(3));
        assert!(line.starts_with(r#"{"op":"rigid-tapping","on":true,"#), "{line}");
    }

    #[test]
    fn the_header_is_the_one_of_the_contract() {
        let mut out = Vec::new();
        write_header(&mut out, &TraceHeader { control: "some-control" });
        assert_eq!(
            String::from_utf8_lossy(&out),
            "{\"turnwright\":\"trace\",\"version\":1,\"control\":\"some-control\",\"units\":\"mm\",\
             \"x\":\"diameter\",\"frame\":\"work\"}\n"
        );
    }

    #[test]
    fn a_rapid_has_its_end_point_and_origin() {
        let origin = Origin { sequence: Some(10), program: Some(1), ..Origin::line(4) };
        assert_eq!(
            line_of(Action::Rapid { to: at(46_000, 2_500), path: RapidPath::EachAxis, others: None }, origin),
            "{\"op\":\"rapid\",\"x\":46,\"z\":2.5,\"line\":4,\"n\":10,\"o\":1,\"depth\":0}\n"
        );
    }

    #[test]
    fn feeds_have_shape_centre_radius_and_the_unit_of_the_feed() {
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000)));
        assert_eq!(
            at_line_seven(Action::Feed { to: at(-1_600, -15_000), shape: Shape::Line, feed, others: None }),
            "{\"op\":\"feed\",\"x\":-1.6,\"z\":-15,\"shape\":\"line\",\"f\":0.3,\"fu\":\"mm/rev\",\"line\":7,\
             \"depth\":0}\n"
        );
        // From d30 z-42 to d36 z-45 about d36 z-42: radius 3.
        let feed = Feed::PerMinute(FeedPerMinute(Length::from_mm(120)));
        let shape = Shape::Arc { turn: Turn::Clockwise, centre: at(36_000, -42_000) };
        assert_eq!(
            at_line_seven(Action::Feed { to: at(36_000, -45_000), shape, feed, others: None }),
            "{\"op\":\"feed\",\"x\":36,\"z\":-45,\"shape\":\"cw\",\"cx\":36,\"cz\":-42,\"r\":3,\"f\":120,\
             \"fu\":\"mm/min\",\"line\":7,\"depth\":0}\n"
        );
        let shape = Shape::Arc { turn: Turn::CounterClockwise, centre: at(30_000, -42_000) };
        assert!(
            at_line_seven(Action::Feed { to: at(36_000, -46_000), shape, feed, others: None })
                .contains(r#""shape":"ccw","cx":30,"cz":-42,"r":5,"f":120"#)
        );
    }

    #[test]
    fn threads_have_lead_angle_and_the_last_lead_when_it_varies() {
        let thread = |lead_end: Option<Lead>| Action::Thread {
            to: at(27_400, -32_000),
            lead: Lead(Length::from_nm(1_814_286)),
            lead_end: lead_end.map(Box::new),
            start_angle: Angle::from_millidegrees(180_500),
            shape: Shape::Line,
            is_chained: false,
        };
        assert_eq!(
            at_line_seven(thread(None)),
            "{\"op\":\"thread\",\"x\":27.4,\"z\":-32,\"lead\":1.814286,\"q\":180.5,\"line\":7,\"depth\":0}\n"
        );
        assert!(
            at_line_seven(thread(Some(Lead(Length::from_mm(2)))))
                .contains(r#""lead":1.814286,"q":180.5,"lead_end":2,"line""#)
        );
    }

    #[test]
    fn curves_have_the_data_of_their_equation() {
        let feed = Feed::PerMinute(FeedPerMinute(Length::from_mm(100)));
        let line = |curve| {
            at_line_seven(Action::Feed {
                to: at(20_000, -20_000),
                shape: Shape::Curve(Box::new(curve)),
                others: None,
                feed,
            })
        };
        let (turn, tilt) = (Turn::Clockwise, Angle::from_millidegrees(12_500));
        let (half_along, half_across) = (Length::from_mm(20), Length::from_mm(10));
        assert!(
            line(Curve::Ellipse { turn, centre: at(20_000, 0), half_along, half_across, tilt }).contains(
                r#""x":20,"z":-20,"shape":"ellipse-cw","cx":20,"cz":0,"a":20,"b":10,"tilt":12.5,"f":100,"#
            )
        );
        let turn = Turn::CounterClockwise;
        assert!(
            line(Curve::Parabola { turn, vertex: at(1_000, -500), focal_parameter: half_across, tilt })
                .contains(r#""shape":"parabola-ccw","vx":1,"vz":-0.5,"p":10,"tilt":12.5,"f":100,"#)
        );
    }

    #[test]
    fn a_thread_that_goes_on_says_so_and_an_arc_has_its_centre() {
        let thread = |shape, is_chained| Action::Thread {
            to: at(17_320, -5_000),
            shape,
            lead: Lead(Length::from_mm(2)),
            lead_end: None,
            start_angle: Angle::from_millidegrees(90_000),
            is_chained,
        };
        assert!(
            at_line_seven(thread(Shape::Line, true)).contains(r#""lead":2,"q":90,"chained":true,"line""#)
        );
        let arc = Shape::Arc { turn: Turn::Clockwise, centre: at(17_320, 5_000) };
        assert!(
            at_line_seven(thread(arc, false))
                .contains(r#""z":-5,"shape":"cw","cx":17.32,"cz":5,"r":10,"lead":2,"q":90,"line""#)
        );
    }

    #[test]
    fn everything_that_is_no_move() {
        let cases = [
            (Action::Dwell(Dwell::Time(Seconds(0.5))), r#"{"op":"dwell","seconds":0.5,"#),
            (Action::Dwell(Dwell::Turns(Revolutions(2.0))), r#"{"op":"dwell","revolutions":2,"#),
            (Action::Dwell(Dwell::Time(Seconds(f64::NAN))), r#"{"op":"dwell","seconds":null,"#),
            (Action::Tool { tool: 1, offset: 11 }, r#"{"op":"tool","tool":1,"offset":11,"#),
            (Action::Coolant(Coolant::On), r#"{"op":"coolant","on":true,"#),
            (Action::Coolant(Coolant::Off), r#"{"op":"coolant","on":false,"#),
            (
                Action::SecondAuxiliary { letter: b'B', code: 12 },
                r#"{"op":"second-auxiliary","letter":"B","code":12,"#,
            ),
            (Action::Auxiliary { code: 23 }, r#"{"op":"m","code":23,"#),
            (Action::Stop, r#"{"op":"stop","#),
            (Action::OptionalStop, r#"{"op":"optional-stop","#),
            (Action::End, r#"{"op":"end","#),
            (Action::Message("hi".into()), r#"{"op":"message","text":"hi","#),
        ];
        for (action, start) in cases {
            assert_eq!(at_line_seven(action), format!("{start}\"line\":7,\"depth\":0}}\n"));
        }
    }

    #[test]
    fn the_spindle_says_how_its_speed_is_held() {
        let spindle = |state, speed, rpm_max| at_line_seven(Action::Spindle { state, speed, rpm_max });
        assert_eq!(
            spindle(SpindleState::Clockwise, SpindleSpeed::Constant(Rpm(800)), None),
            "{\"op\":\"spindle\",\"state\":\"cw\",\"mode\":\"rpm\",\"s\":800,\"line\":7,\"depth\":0}\n"
        );
        let surface = SpindleSpeed::Surface(SurfaceSpeed::from_m_per_min(180));
        assert_eq!(
            spindle(SpindleState::CounterClockwise, surface, Some(Rpm(2500))),
            "{\"op\":\"spindle\",\"state\":\"ccw\",\"mode\":\"css\",\"s\":180,\"max_rpm\":2500,\"line\":7,\
             \"depth\":0}\n"
        );
        let surface = SpindleSpeed::Surface(SurfaceSpeed::from_ft_per_min(500));
        assert!(
            spindle(SpindleState::Stop, surface, None)
                .starts_with(r#"{"op":"spindle","state":"stop","mode":"css","s":152.4,"line""#)
        );
    }

    #[test]
    fn a_cycle_adds_label_pass_and_phase() {
        let cycle = |label, pass, phase| Origin {
            depth: 2,
            cycle: Some(CycleOrigin { label: CycleLabel(label), pass, phase }),
            ..Origin::line(9)
        };
        assert_eq!(
            line_of(Action::Stop, cycle(710, 3, Phase::Cut)),
            "{\"op\":\"stop\",\"line\":9,\"depth\":2,\"cycle\":\"G71\",\"pass\":3,\"phase\":\"cut\"}\n"
        );
        assert_eq!(
            line_of(Action::Stop, cycle(711, 0, Phase::Approach)),
            "{\"op\":\"stop\",\"line\":9,\"depth\":2,\"cycle\":\"G71.1\",\"phase\":\"approach\"}\n"
        );
        assert!(line_of(Action::Stop, cycle(40, 1, Phase::Home)).contains(r#""cycle":"G04","#));
    }

    #[test]
    fn the_alarm_is_a_line_like_the_others() {
        let mut out = Vec::new();
        let alarm = TraceAlarm {
            id: "062",
            key: "cut-depth-illegal",
            message: "ILLEGAL \"U\"",
            line: 4,
            sequence: Some(20),
            program: Some(1),
            depth: 0,
            file: None,
        };
        write_alarm(&mut out, &alarm);
        assert_eq!(
            String::from_utf8_lossy(&out),
            "{\"op\":\"alarm\",\"id\":\"062\",\"key\":\"cut-depth-illegal\",\"message\":\"ILLEGAL \\\"U\\\"\",\
             \"line\":4,\"n\":20,\"o\":1,\"depth\":0}\n"
        );
    }

    #[test]
    fn a_line_of_another_file_names_it_last() {
        let mut out = Vec::new();
        let command = Command::new(Action::Stop, Origin::line(3));
        CommandWriter::new(3).write_of_file(&mut out, &command, "O2.nc");
        let nowhere = Action::Relocate { to: at(0, 0), others: None };
        CommandWriter::new(3).write_of_file(&mut out, &Command::new(nowhere, Origin::line(4)), "O2.nc");
        assert_eq!(
            String::from_utf8_lossy(&out),
            "{\"op\":\"stop\",\"line\":3,\"depth\":0,\"file\":\"O2.nc\"}\n"
        );
    }

    #[test]
    fn any_text_survives_as_json() {
        for text in ["\u{0}\u{1}\u{1f}\u{7f}", "a\"b\\c/d\r\n\t", "车刀 ⌀40 \u{fffd}", "</script>\u{2028}"]
        {
            let line = at_line_seven(Action::Message(text.into()));
            let value: serde_json::Value = serde_json::from_str(&line).expect("JSON");
            assert_eq!(value["text"], text);
        }
    }

    #[test]
    fn whole_numbers_are_written_as_the_standard_library_does() {
        for number in [0, 1, 9, 10, 99, 100, 12_345, u32::MAX] {
            let mut out = Vec::new();
            write_number(&mut out, b"", number);
            write_whole(&mut out, number);
            assert_eq!(String::from_utf8_lossy(&out), format!("{number}{number}"));
        }
    }

    #[test]
    fn what_lines_have_in_common_is_made_anew_when_it_changes() {
        let feeds = [
            Feed::PerMinute(FeedPerMinute(Length::from_mm(200))),
            Feed::PerRevolution(FeedPerRevolution(Length::from_mm(200))),
            Feed::PerMinute(FeedPerMinute(Length::from_mm(250))),
        ];
        let places = [(None, 0, false), (Some(7), 0, false), (Some(7), 1, false), (Some(7), 1, true)];
        let cycle = CycleOrigin { label: CycleLabel(760), pass: 1, phase: Phase::Cut };
        let mut writer = CommandWriter::new(3);
        for index in 0..200usize {
            let (feed, place) = (feeds[index * 7 % 5 % 3], places[index * 3 % 7 % 4]);
            let action = Action::Feed { to: at(1_000, 0), shape: Shape::Line, feed, others: None };
            let (program, depth, runs_on) = place;
            let cycle = index.is_multiple_of(6).then_some(cycle);
            let origin = Origin { program, depth, runs_on, cycle, ..Origin::line(index as u32) };
            let command = Command::new(action, origin);
            let (mut mine, mut fresh) = (Vec::new(), Vec::new());
            writer.write(&mut mine, &command);
            CommandWriter::new(3).write(&mut fresh, &command);
            assert_eq!(mine, fresh, "{}", fresh.escape_ascii());
        }
    }

    #[test]
    fn lengths_are_rounded_to_the_increment() {
        let mut out = Vec::new();
        let to = Position::<WorkTip>::new(Radius(Length::from_nm(13_620_710)), Length::from_nm(-2_540));
        let action = Action::Rapid { to, path: RapidPath::Straight, others: None };
        CommandWriter::new(3).write(&mut out, &Command::new(action, Origin::line(1)));
        assert!(out.starts_with(br#"{"op":"rapid","x":27.241,"z":-0.003,"#));
        // Both rounded to a hundredth, as the coarsest increment asks for; never "-0".
        out.clear();
        let to = Position::<WorkTip>::new(Radius::ZERO, Length::from_nm(-LeastIncrement::METRIC_C.nm()));
        let action = Action::Rapid { to, path: RapidPath::Straight, others: None };
        CommandWriter::new(2).write(&mut out, &Command::new(action, Origin::line(1)));
        assert!(out.starts_with(br#"{"op":"rapid","x":0,"z":0,"#));
    }
}
