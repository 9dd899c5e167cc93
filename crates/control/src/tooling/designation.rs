//! What the designations of inserts and holders mean, by the tables in `data/tools`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::nearest;

/// A turning insert: its form and size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TurningInsert {
    pub(super) form: Form,
    /// Angle of the cutting corner.
    pub(super) angle_deg: f64,
    /// Diameter of the inscribed circle.
    pub(super) inscribed_mm: f64,
    pub(super) nose_radius_mm: f64,
}

/// The form of a turning insert.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Form {
    Rhombus,
    Triangle,
    Trigon,
    Round,
}

/// What an insert's designation says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Insert {
    Turning(TurningInsert),
    Threading { angle_deg: f64, is_inside: bool, is_left: bool },
    Grooving { width_mm: f64, nose_radius_mm: f64 },
}

/// What a holder's designation says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Holder {
    pub(super) entering_angle_deg: f64,
    /// It feeds across the spindle axis.
    pub(super) faces: bool,
    pub(super) is_neutral: bool,
    pub(super) is_left: bool,
    /// A boring bar.
    pub(super) is_inside: bool,
    /// Width of the shank, or diameter of the bar.
    pub(super) shank_mm: f64,
    pub(super) length_mm: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeEntry {
    form: Form,
    angle_deg: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GrooveEntry {
    width_mm: f64,
    nose_radius_mm: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct InsertTable {
    inscribed_circles_mm: Vec<f64>,
    shapes: BTreeMap<String, ShapeEntry>,
    thread_profiles: BTreeMap<String, f64>,
    grooving: BTreeMap<String, GrooveEntry>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StyleEntry {
    angle_deg: f64,
    #[serde(default)]
    faces: bool,
    #[serde(default)]
    is_neutral: bool,
}

/// Of square shanks and of bars.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Both<T> {
    outside: T,
    inside: T,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HolderTable {
    styles: Both<BTreeMap<String, StyleEntry>>,
    lengths_mm: BTreeMap<String, f64>,
    reach_mm: Both<Vec<[f64; 2]>>,
}

static INSERTS: LazyLock<InsertTable> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../../data/tools/inserts.toml"))
        .unwrap_or_else(|error| unreachable!("data/tools/inserts.toml is read by a test: {error}"))
});

static HOLDERS: LazyLock<HolderTable> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../../data/tools/holders.toml"))
        .unwrap_or_else(|error| unreachable!("data/tools/holders.toml is read by a test: {error}"))
});

/// A designation as it counts: capitals, no blanks.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).map(|c| c.to_ascii_uppercase()).collect()
}

impl TurningInsert {
    /// Whether it is all nose.
    pub(super) fn is_round(&self) -> bool {
        self.form == Form::Round
    }

    /// Length of its cutting edge.
    pub(super) fn edge_mm(&self) -> f64 {
        let half = self.angle_deg.to_radians() / 2.0;
        let circle = self.inscribed_mm;
        match self.form {
            Form::Rhombus => circle / libm::sin(2.0 * half),
            Form::Triangle => circle * 3.0_f64.sqrt(),
            // Corners of the angle alternate with blunt ones, six in all.
            Form::Trigon => {
                let blunt = (240.0_f64.to_radians() - 2.0 * half) / 2.0;
                circle / 2.0 * (1.0 / libm::tan(half) + 1.0 / libm::tan(blunt))
            }
            Form::Round => circle,
        }
    }
}

/// Reads an insert's designation.
///
/// # Errors
/// What of it is not known.
pub(super) fn insert(text: &str) -> Result<Insert, String> {
    let code = plain(text);
    let body: &str = code.split(['-', '/']).next().unwrap_or_default();
    if let Some(groove) = INSERTS.grooving.get(body) {
        let GrooveEntry { width_mm, nose_radius_mm } = *groove;
        return Ok(Insert::Grooving { width_mm, nose_radius_mm });
    }
    if body.starts_with(|c: char| c.is_ascii_digit()) {
        return threading(body);
    }
    let near = || {
        let near =
            nearest(&code, INSERTS.grooving.keys().map(String::as_str)).filter(|_| code.starts_with('M'));
        let hint = near.map_or_else(
            || {
                "; a turning insert reads CNMG120408, one for threads 16ER1.5ISO, one for grooves MGMN300"
                    .to_string()
            },
            |name| format!("; did you mean {name}?"),
        );
        format!("{text:?} is no insert that is known{hint}")
    };
    let is_turning = body.len() >= 7
        && !(body.starts_with("MGMN") || body.starts_with("MRMN"))
        && body.is_ascii()
        && body[..4].bytes().all(|byte| byte.is_ascii_alphabetic())
        && body.as_bytes()[4].is_ascii_digit();
    if !is_turning {
        return Err(near());
    }
    let shape = INSERTS.shapes.get(&body[..1]).ok_or_else(|| {
        let known: Vec<&str> = INSERTS.shapes.keys().map(String::as_str).collect();
        format!("{text:?}: the form {} is not known; known are {}", &body[..1], known.join(" "))
    })?;
    let size = &body[4..];
    let digits = size.bytes().take_while(u8::is_ascii_digit).count();
    let (inscribed_mm, nose_radius_mm) = if digits == 3 && size.len() == 3 {
        inch_size(size)
    } else {
        metric_size(size, shape).ok_or_else(|| {
            format!("{text:?}: the size {size} is not known; expected edge, thickness and nose, as in 120408")
        })?
    };
    let nose_radius_mm = if shape.form == Form::Round { inscribed_mm / 2.0 } else { nose_radius_mm };
    let ShapeEntry { form, angle_deg } = *shape;
    Ok(Insert::Turning(TurningInsert { form, angle_deg, inscribed_mm, nose_radius_mm }))
}

/// `432`: inscribed circle in eighths of an inch, thickness in sixteenths, nose in sixty-fourths.
fn inch_size(size: &str) -> (f64, f64) {
    let digit = |at: usize| f64::from(size.as_bytes()[at] - b'0');
    (digit(0) * 25.4 / 8.0, digit(2) * 25.4 / 64.0)
}

/// `120408`, `11T304`, `10T3M0`: edge, thickness, nose in tenths.
fn metric_size(size: &str, shape: &ShapeEntry) -> Option<(f64, f64)> {
    let (edge, rest) = size.split_at_checked(2)?;
    let (_, nose) = rest.split_at_checked(2)?;
    let edge: u32 = edge.parse().ok()?;
    let nose = nose.get(..2)?;
    let is_metric_round = shape.form == Form::Round && nose.starts_with('M');
    let nose_mm = if nose.starts_with('M') && shape.form == Form::Round {
        0.0
    } else {
        f64::from(nose.parse::<u32>().ok()?) / 10.0
    };
    if is_metric_round {
        return Some((f64::from(edge), nose_mm));
    }
    let inscribed = INSERTS.inscribed_circles_mm.iter().copied().find(|circle| {
        let ShapeEntry { form, angle_deg } = *shape;
        let insert = TurningInsert { form, angle_deg, inscribed_mm: *circle, nose_radius_mm: 0.0 };
        // Some edges are a hair below the whole millimetre that names them: 21.997 is 22.
        (insert.edge_mm() + 0.01).floor() == f64::from(edge)
    })?;
    Some((inscribed, nose_mm))
}

/// `16ER1.5ISO`: size, outside or inside, hand, pitch, profile.
fn threading(code: &str) -> Result<Insert, String> {
    let fault = || {
        let known: Vec<&str> = INSERTS.thread_profiles.keys().map(String::as_str).collect();
        let known = known.join(" ");
        format!("{code:?} is no threading insert that is known; expected as 16ER1.5ISO, with one of {known}")
    };
    let letters = code.trim_start_matches(|c: char| c.is_ascii_digit());
    let (side, rest) = letters.split_at_checked(2).ok_or_else(fault)?;
    let (is_inside, is_left) = match side {
        "ER" => (false, false),
        "EL" => (false, true),
        "IR" | "NR" => (true, false),
        "IL" | "NL" => (true, true),
        _ => return Err(fault()),
    };
    let profile = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let angle_deg = *INSERTS.thread_profiles.get(profile).ok_or_else(fault)?;
    Ok(Insert::Threading { angle_deg, is_inside, is_left })
}

/// Reads a holder's designation.
///
/// # Errors
/// What of it is not known.
pub(super) fn holder(text: &str) -> Result<Holder, String> {
    let code = plain(text);
    let fault = |what: &str| format!("{text:?}: {what}; expected as PCLNR2525M12 or S20R-SCLCR09");
    if !code.is_ascii() {
        return Err(fault("a letter is not known"));
    }
    let bar = code.split_once('-').filter(|(bar, _)| bar.len() == 4);
    let (head, is_inside) = match bar {
        Some((_, head)) => (head, true),
        None => (code.as_str(), false),
    };
    let letters: Vec<char> = head.chars().take(5).collect();
    let [_, _, style, _, hand] = letters[..] else { return Err(fault("it is too short")) };
    let styles = if is_inside { &HOLDERS.styles.inside } else { &HOLDERS.styles.outside };
    let style = styles.get(style.to_string().as_str()).ok_or_else(|| fault("its style is not known"))?;
    let (is_left, is_neutral) = match hand {
        'R' => (false, style.is_neutral),
        'L' => (true, style.is_neutral),
        'N' => (false, true),
        _ => return Err(fault("its hand is none of R, L, N")),
    };
    let number = |digits: Option<&str>| digits.and_then(|digits| digits.parse::<f64>().ok());
    let (shank_mm, letter) = match bar {
        Some((bar, _)) => (number(bar.get(1..3)), bar.get(3..4)),
        // Height, then width.
        None => (number(head.get(5..7)).and(number(head.get(7..9))), head.get(9..10)),
    };
    let shank_mm = shank_mm.filter(|shank| *shank > 0.0).ok_or_else(|| fault("its size is no number"))?;
    let length_mm = match letter {
        None => 150.0,
        Some(letter) => {
            *HOLDERS.lengths_mm.get(letter).ok_or_else(|| fault("the letter of its length is not known"))?
        }
    };
    let StyleEntry { angle_deg, faces, .. } = *style;
    Ok(Holder { entering_angle_deg: angle_deg, faces, is_neutral, is_left, is_inside, shank_mm, length_mm })
}

/// From the tip to the far side of a square shank, or to the middle of a bar.
pub(super) fn reach_mm(shank_mm: f64, is_inside: bool) -> f64 {
    let table = if is_inside { &HOLDERS.reach_mm.inside } else { &HOLDERS.reach_mm.outside };
    let exact = table.iter().find(|row| row[0] >= shank_mm).map(|row| row[1] - row[0]);
    let usual = if is_inside { -0.3 * shank_mm } else { 0.25 * shank_mm };
    shank_mm + exact.unwrap_or(usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(code: &str) -> TurningInsert {
        match insert(code) {
            Ok(Insert::Turning(insert)) => insert,
            other => panic!("{code}: {other:?}"),
        }
    }

    #[test]
    fn designations_of_turning_inserts_give_circle_and_nose() {
        for (code, circle, nose, angle) in [
            ("CNMG120408", 12.7, 0.8, 80.0),
            ("DNMG 15 06 04-PM", 12.7, 0.4, 55.0),
            ("VBMT160404", 9.525, 0.4, 35.0),
            ("TNMG160408", 9.525, 0.8, 60.0),
            ("TNMG220412", 12.7, 1.2, 60.0),
            ("WNMG080408", 12.7, 0.8, 80.0),
            ("DCMT11T304", 9.525, 0.4, 55.0),
            ("SNMG120408", 12.7, 0.8, 90.0),
            ("CCMT060202", 6.35, 0.2, 80.0),
        ] {
            let insert = turning(code);
            assert_eq!(
                (insert.inscribed_mm, insert.nose_radius_mm, insert.angle_deg),
                (circle, nose, angle),
                "{code}"
            );
        }
        assert_eq!(turning("RCMT1204M0").nose_radius_mm, 6.0);
        assert_eq!(turning("CNMG432").inscribed_mm, 12.7);
        assert!((turning("CNMG432").nose_radius_mm - 0.79375).abs() < 1e-12);
        // The trigon's edge of 8.69 mm is what names it 08.
        assert!((turning("WNMG080408").edge_mm() - 8.69).abs() < 5e-3);
    }

    #[test]
    fn threading_and_grooving_inserts_have_their_names() {
        assert_eq!(
            insert("16ER1.5ISO"),
            Ok(Insert::Threading { angle_deg: 60.0, is_inside: false, is_left: false })
        );
        assert_eq!(
            insert("16irag55"),
            Ok(Insert::Threading { angle_deg: 55.0, is_inside: true, is_left: false })
        );
        assert_eq!(insert("MGMN300-M"), Ok(Insert::Grooving { width_mm: 3.0, nose_radius_mm: 0.4 }));
    }

    #[test]
    fn holders_give_angle_hand_and_size() {
        let holder_of = |code| holder(code).unwrap_or_else(|fault| panic!("{fault}"));
        let one = holder_of("PCLNR2525M12");
        assert_eq!(
            (one.entering_angle_deg, one.is_left, one.shank_mm, one.length_mm),
            (95.0, false, 25.0, 150.0)
        );
        let bar = holder_of("S20R-SCLCR09");
        assert_eq!(
            (bar.entering_angle_deg, bar.is_inside, bar.shank_mm, bar.length_mm),
            (95.0, true, 20.0, 200.0)
        );
        assert!(holder_of("SVVBN2020K16").is_neutral);
        assert!(holder_of("MDJNL2020K15").is_left);
        assert_eq!((reach_mm(25.0, false), reach_mm(16.0, true)), (32.0, 11.0));
    }

    #[test]
    fn what_is_not_known_is_refused_with_a_pattern() {
        for code in ["CNMG", "XNMG120408", "CNMG990408", "16ER", "16ERFOO", "MGMN350", "", "CNMGé20408"] {
            assert!(insert(code).is_err(), "{code}");
        }
        assert!(insert("MGMN30").expect_err("refused").contains("did you mean MGMN300?"));
        for code in ["PCLN", "PCXNR2525M12", "PCLNX2525M12", "PCLNRaa25M12", "PCLNR2525I12", "S20R-SC"] {
            assert!(holder(code).is_err(), "{code}");
        }
    }
}
