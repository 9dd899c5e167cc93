//! Tools: what a setup file says of them, and the shapes that follow.
//!
//! In: an entry `[tools.N]`. Out: a [`Tool`] with the outlines of what cuts and of what holds it, in millimetres from
//! the point that the program moves (X as a radius). A tool whose shape nothing tells is refused.

mod designation;
mod shape;

use serde::Deserialize;
use turnwright_geometry::{Outline, OutlineFault, Point, Vector};

use self::designation::{Holder, Insert, TurningInsert};
use self::shape::Stance;
use crate::OutlinePoint;
use crate::outline::through;

/// What a tool does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolKind {
    /// Turns, faces and bores with one nose.
    Turning,
    /// Cuts grooves with two corners.
    Grooving,
    /// Cuts the part off.
    CutOff,
    /// Cuts threads with a point.
    Threading,
    /// Drills on the spindle axis.
    Drilling,
    /// Taps on the spindle axis.
    Tapping,
}

impl ToolKind {
    /// All kinds, with the words of setup files.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Turning, "turning"),
        (Self::Grooving, "grooving"),
        (Self::CutOff, "cut-off"),
        (Self::Threading, "threading"),
        (Self::Drilling, "drilling"),
        (Self::Tapping, "tapping"),
    ];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, word)| word)
    }
}

/// Which surface a tool cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolSide {
    /// The outer one.
    #[default]
    Outside,
    /// A bore.
    Inside,
    /// The face: a face groove.
    Face,
}

impl ToolSide {
    /// All sides, with the words of setup files.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Outside, "outside"), (Self::Inside, "inside"), (Self::Face, "face")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(side, _)| *side == self).map_or("", |(_, word)| word)
    }
}

/// Which way a tool feeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hand {
    /// Towards the chuck.
    #[default]
    Right,
    /// Away from it.
    Left,
    /// Either way.
    Neutral,
}

impl Hand {
    /// All hands, with the words of setup files.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Right, "right"), (Self::Left, "left"), (Self::Neutral, "neutral")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(hand, _)| *hand == self).map_or("", |(_, word)| word)
    }
}

/// On which side of the spindle axis the turret stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolPost {
    /// Behind it, seen from the operator.
    #[default]
    Rear,
    /// In front of it.
    Front,
}

impl ToolPost {
    /// Both posts, with the words of setup files.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Rear, "rear"), (Self::Front, "front")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(post, _)| *post == self).map_or("", |(_, word)| word)
    }
}

/// Which way the rake face of an insert looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InsertFacing {
    /// Up.
    Up,
    /// Down.
    Down,
}

impl InsertFacing {
    /// Both, with the words of setup files.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Up, "up"), (Self::Down, "down")];

    /// The word of setup files.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(way, _)| *way == self).map_or("", |(_, word)| word)
    }
}

/// Which way the spindle must turn for a tool to cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CuttingTurn {
    /// Clockwise, seen from behind the spindle: the work comes down in front and goes up behind.
    Clockwise,
    /// The other way.
    CounterClockwise,
}

/// An entry `[tools.N]` of a setup file; `data/setup-keys.toml` explains each key. What is left out follows from the
/// designations, else from the kind.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(missing_docs, reason = "name and unit say it; data/setup-keys.toml has the words")]
pub struct ToolEntry {
    pub name: Option<String>,
    pub kind: Option<ToolKind>,
    pub side: Option<ToolSide>,
    pub insert: Option<String>,
    pub holder: Option<String>,
    pub entering_angle_deg: Option<f64>,
    pub hand: Option<Hand>,
    pub post: Option<ToolPost>,
    pub insert_faces: Option<InsertFacing>,
    pub nose_radius_mm: Option<f64>,
    pub tip: Option<u8>,
    pub width_mm: Option<f64>,
    pub reach_mm: Option<f64>,
    pub clearance_deg: Option<f64>,
    pub diameter_mm: Option<f64>,
    pub point_angle_deg: Option<f64>,
    pub thread_angle_deg: Option<f64>,
    pub length_mm: Option<f64>,
    pub shank_mm: Option<f64>,
    pub outline: Vec<OutlinePoint>,
    pub holder_outline: Vec<OutlinePoint>,
}

/// A tool with its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// What it does.
    pub kind: ToolKind,
    /// Which surface it cuts.
    pub side: ToolSide,
    /// Which way it feeds.
    pub hand: Hand,
    /// Where its turret stands.
    pub post: ToolPost,
    /// Radius of its nose, mm; 0 when sharp.
    pub nose_radius_mm: f64,
    /// Number of the imaginary tip, 0 to 9.
    pub tip: u8,
    /// Width of a blade, diameter of a drill, mm.
    pub width_mm: Option<f64>,
    /// Angle between the flanks of a threading insert, degrees.
    pub thread_angle_deg: Option<f64>,
    /// What cuts.
    pub cutting: Outline,
    /// What must not touch the work.
    pub body: Option<Outline>,
    /// The edges behind the nose of a turning insert; none where nobody says how it stands in its holder.
    pub flanks: Vec<Flank>,
    /// Which way the spindle must turn, when post and insert or the hand of the holder tell.
    pub turn: Option<CuttingTurn>,
}

/// An edge behind the nose of a turning insert: it must be clear of the work that stays. Neutral tools have two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flank {
    /// Where it leaves the nose, from the programmed point.
    pub near: Point,
    /// Where it ends.
    pub far: Point,
    /// Away from the insert, one long.
    pub outward: Vector,
}

impl Flank {
    /// The way along it, away from the nose, one long.
    pub fn way(&self) -> Vector {
        let way = Vector::between(self.near, self.far);
        way.times(1.0 / way.length())
    }

    /// How far it leans off the spindle axis, degrees: the steepest way in that it leaves clear.
    pub fn clear_deg(&self) -> f64 {
        let way = self.way();
        libm::atan2(way.x.abs(), way.z.abs()).to_degrees()
    }
}

/// What no tool can be: the key that is wrong, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ToolFault {
    pub(crate) key: &'static str,
    pub(crate) why: String,
}

fn fault(key: &'static str, why: impl Into<String>) -> ToolFault {
    ToolFault { key, why: why.into() }
}

/// A tip number and a hand that contradict each other, or a kind that has no such side.
fn no_outline(key: &'static str) -> impl Fn(OutlineFault) -> ToolFault {
    move |_| fault(key, "with these sizes the tool has no shape")
}

impl ToolEntry {
    /// Values that are out of their range.
    fn check(&self) -> Result<(), ToolFault> {
        let sizes = [
            ("width_mm", self.width_mm),
            ("reach_mm", self.reach_mm),
            ("diameter_mm", self.diameter_mm),
            ("length_mm", self.length_mm),
            ("shank_mm", self.shank_mm),
        ];
        for (key, size) in sizes {
            if size.is_some_and(|size| !(size.is_finite() && size > 0.0 && size <= 10_000.0)) {
                return Err(fault(key, "must be greater than zero"));
            }
        }
        if self
            .nose_radius_mm
            .is_some_and(|radius| !(radius.is_finite() && (0.0..=1_000.0).contains(&radius)))
        {
            return Err(fault("nose_radius_mm", "a radius is not negative"));
        }
        let angles = [
            ("entering_angle_deg", self.entering_angle_deg, 10.0, 170.0),
            ("point_angle_deg", self.point_angle_deg, 10.0, 180.0),
            ("thread_angle_deg", self.thread_angle_deg, 5.0, 120.0),
            ("clearance_deg", self.clearance_deg, 0.0, 30.0),
        ];
        for (key, angle, low, high) in angles {
            if angle.is_some_and(|angle| !(low..=high).contains(&angle)) {
                return Err(fault(key, format!("must be {low} to {high} degrees")));
            }
        }
        if self.tip.is_some_and(|tip| tip > 9) {
            return Err(fault("tip", "the number of the tip is 0 to 9"));
        }
        Ok(())
    }

    /// The tool with its shape. `offset_nose` is radius and tip number of the offset that it is used with, which
    /// count where the entry says nothing.
    ///
    /// # Errors
    /// The key that is wrong, and why.
    pub(crate) fn resolve(&self, offset_nose: Option<(f64, u8)>) -> Result<Tool, ToolFault> {
        self.check()?;
        let insert = self.insert.as_deref().map(designation::insert).transpose();
        let insert = insert.map_err(|why| fault("insert", why))?;
        let holder = self.holder.as_deref().map(designation::holder).transpose();
        let holder = holder.map_err(|why| fault("holder", why))?;
        let kind = self.kind_by(insert.as_ref())?;
        let side = self.side.unwrap_or(match (&insert, &holder) {
            (Some(Insert::Threading { is_inside: true, .. }), _)
            | (_, Some(Holder { is_inside: true, .. })) => ToolSide::Inside,
            _ => ToolSide::Outside,
        });
        let hand = self.hand.or(match (&insert, &holder) {
            (_, Some(holder)) if holder.is_neutral => Some(Hand::Neutral),
            (_, Some(holder)) => Some(if holder.is_left { Hand::Left } else { Hand::Right }),
            (Some(Insert::Threading { is_left: true, .. }), _) => Some(Hand::Left),
            _ => None,
        });
        let named_nose_mm = match &insert {
            Some(Insert::Turning(insert)) => Some(insert.nose_radius_mm),
            Some(Insert::Grooving { nose_radius_mm, .. }) => Some(*nose_radius_mm),
            _ => None,
        };
        let offset_nose = offset_nose.filter(|(radius, tip)| *radius > 0.0 || *tip > 0);
        let of_offset = offset_nose.map(|(radius, _)| radius);
        let nose_mm = self.nose_radius_mm.or(named_nose_mm).or(of_offset).unwrap_or(0.0);
        let tip = self.tip.or(offset_nose.map(|(_, tip)| tip).filter(|tip| *tip > 0));
        let tip = tip.unwrap_or_else(|| usual_tip(kind, side, hand));
        let hand = hand.unwrap_or(if matches!(tip, 1 | 4) { Hand::Left } else { Hand::Right });
        let stance = match kind {
            // On the spindle axis there is no side to stand on.
            ToolKind::Drilling | ToolKind::Tapping => stance(7, ToolSide::Outside, Hand::Neutral)?,
            _ => stance(tip, side, hand)?,
        };
        let drawing = Drawing { entry: self, kind, side, nose_mm, stance, insert, holder };
        let (cutting, body) = drawing.outlines()?;
        let flanks = drawing.flanks();
        let turn = self.turn(kind, side, hand, drawing.holder.as_ref());
        let width_mm = match kind {
            ToolKind::Drilling | ToolKind::Tapping => self.diameter_mm,
            ToolKind::Grooving | ToolKind::CutOff => drawing.width_mm(),
            _ => None,
        };
        let thread_angle_deg = (kind == ToolKind::Threading).then(|| drawing.thread_angle_deg());
        let post = self.post.unwrap_or_default();
        Ok(Tool {
            kind,
            side,
            hand,
            post,
            nose_radius_mm: nose_mm,
            tip,
            width_mm,
            thread_angle_deg,
            cutting,
            body,
            flanks,
            turn,
        })
    }

    /// Which way the spindle must turn. In front the work comes down on an insert that looks up when the spindle turns
    /// clockwise, behind it goes up. A right-hand holder that feeds to the chuck sits so on either post, and so does a
    /// left-hand one that feeds away from it: each is the mirror of the other. A bar for back boring is not: of bars only
    /// those that feed to the chuck are judged.
    fn turn(
        &self,
        kind: ToolKind,
        side: ToolSide,
        hand: Hand,
        holder: Option<&Holder>,
    ) -> Option<CuttingTurn> {
        use CuttingTurn::{Clockwise, CounterClockwise};
        if let (Some(post), Some(facing)) = (self.post, self.insert_faces) {
            return Some(match (post, facing) {
                (ToolPost::Front, InsertFacing::Up) | (ToolPost::Rear, InsertFacing::Down) => Clockwise,
                (ToolPost::Front, InsertFacing::Down) | (ToolPost::Rear, InsertFacing::Up) => {
                    CounterClockwise
                }
            });
        }
        let is_judged = kind == ToolKind::Turning && (side == ToolSide::Outside || hand == Hand::Right);
        let holder = holder.filter(|holder| is_judged && !holder.is_neutral)?;
        match hand {
            Hand::Right => Some(if holder.is_left { CounterClockwise } else { Clockwise }),
            Hand::Left => Some(if holder.is_left { Clockwise } else { CounterClockwise }),
            Hand::Neutral => None,
        }
    }

    /// The kind that is named, else that of the insert.
    fn kind_by(&self, insert: Option<&Insert>) -> Result<ToolKind, ToolFault> {
        let of_insert = insert.map(|insert| match insert {
            Insert::Turning(_) => ToolKind::Turning,
            Insert::Threading { .. } => ToolKind::Threading,
            Insert::Grooving { .. } => ToolKind::Grooving,
        });
        let of_sizes = (self.diameter_mm.is_some() && self.side.is_none()).then_some(ToolKind::Drilling);
        let kind =
            self.kind.or(of_insert).or(of_sizes).or((!self.outline.is_empty()).then_some(ToolKind::Turning));
        let kind =
            kind.ok_or_else(|| fault("", "has no shape: give insert, outline, or kind with its sizes"))?;
        let fits = match insert {
            Some(Insert::Turning(_)) => kind == ToolKind::Turning,
            Some(Insert::Threading { .. }) => kind == ToolKind::Threading,
            Some(Insert::Grooving { .. }) => {
                matches!(kind, ToolKind::Grooving | ToolKind::CutOff | ToolKind::Turning)
            }
            None => true,
        };
        if fits { Ok(kind) } else { Err(fault("insert", format!("this insert is not for {}", kind.word()))) }
    }
}

/// The tip number that a tool usually has.
fn usual_tip(kind: ToolKind, side: ToolSide, hand: Option<Hand>) -> u8 {
    let is_left = hand == Some(Hand::Left);
    match (kind, side) {
        (ToolKind::Drilling | ToolKind::Tapping, _) => 7,
        (ToolKind::Threading, ToolSide::Inside) => 6,
        (ToolKind::Threading, _) => 8,
        (_, ToolSide::Face) => 3,
        (_, ToolSide::Outside) if hand == Some(Hand::Neutral) => 8,
        (_, ToolSide::Inside) if hand == Some(Hand::Neutral) => 6,
        (_, ToolSide::Inside) if is_left => 1,
        (_, ToolSide::Inside) => 2,
        (_, ToolSide::Outside) if is_left => 4,
        (_, ToolSide::Outside) => 3,
    }
}

/// Where the tool stands by its tip number, and by its side and hand where the tip leaves them open.
fn stance(tip: u8, side: ToolSide, hand: Hand) -> Result<Stance, ToolFault> {
    let (x, z) = shape::tip_direction(tip);
    let wrong = |what: &str| Err(fault("tip", format!("{tip} is no tip of a tool that {what}")));
    if side == ToolSide::Face {
        return if z > 0 {
            wrong("feeds into the face")
        } else {
            Ok(Stance { is_above: false, is_left: x > 0, is_face: true, tip: (x, z) })
        };
    }
    match side {
        ToolSide::Outside if x > 0 => return wrong("cuts outside"),
        ToolSide::Inside if x < 0 => return wrong("cuts inside"),
        _ => {}
    }
    match hand {
        Hand::Right if z > 0 => return wrong("feeds to the chuck (hand = \"right\")"),
        Hand::Left if z < 0 => return wrong("feeds away from the chuck (hand = \"left\")"),
        _ => {}
    }
    let is_left = z > 0 || (z == 0 && hand == Hand::Left);
    Ok(Stance { is_above: side == ToolSide::Inside, is_left, is_face: false, tip: (x, z) })
}

/// Everything that the outlines follow from.
struct Drawing<'a> {
    entry: &'a ToolEntry,
    kind: ToolKind,
    side: ToolSide,
    nose_mm: f64,
    stance: Stance,
    insert: Option<Insert>,
    holder: Option<Holder>,
}

impl Drawing<'_> {
    fn outlines(&self) -> Result<(Outline, Option<Outline>), ToolFault> {
        let own = |points: &[OutlinePoint], key: &'static str| {
            (!points.is_empty()).then(|| through(points, 1.0).map_err(|why| fault(key, why))).transpose()
        };
        let cutting = own(&self.entry.outline, "outline")?;
        let body = own(&self.entry.holder_outline, "holder_outline")?;
        if let Some(cutting) = cutting {
            return Ok((cutting, body));
        }
        let (cutting, usual) = self.usual()?;
        Ok((cutting, body.or(usual)))
    }

    /// The outlines that designations and sizes give.
    fn usual(&self) -> Result<(Outline, Option<Outline>), ToolFault> {
        match (self.kind, &self.insert) {
            (ToolKind::Turning, Some(Insert::Turning(insert))) => self.turning(insert),
            (ToolKind::Turning, None) => Err(fault("insert", "a turning tool needs an insert or an outline")),
            (ToolKind::Grooving | ToolKind::CutOff | ToolKind::Turning, _) => self.blade(),
            (ToolKind::Threading, _) => self.threading(),
            (ToolKind::Drilling, _) => self.drill(118.0),
            (ToolKind::Tapping, _) => self.drill(180.0),
        }
    }

    /// Shank and length of the holder that is named, else of a usual one.
    fn shank(&self) -> (f64, f64) {
        let is_inside = self.side == ToolSide::Inside;
        let (shank, length) = match &self.holder {
            Some(holder) => (holder.shank_mm, holder.length_mm),
            None if is_inside => (16.0, 150.0),
            None => (25.0, 150.0),
        };
        (self.entry.shank_mm.unwrap_or(shank), self.entry.length_mm.unwrap_or(length))
    }

    /// The entering angle that the entry or the holder gives.
    fn given_entering_angle_deg(&self, insert: &TurningInsert) -> Option<f64> {
        let of_holder = self.holder.as_ref().map(|holder| {
            // The edge that leads when feeding across is the one that trails along Z.
            if holder.faces {
                270.0 - holder.entering_angle_deg - insert.angle_deg
            } else {
                holder.entering_angle_deg
            }
        });
        self.entry.entering_angle_deg.or(of_holder)
    }

    /// Whether it feeds both ways along Z.
    fn is_neutral(&self) -> bool {
        self.holder.as_ref().map_or(self.stance.tip.1 == 0, |holder| holder.is_neutral)
    }

    /// The edges behind the nose, where a designation and an angle say where they are.
    fn flanks(&self) -> Vec<Flank> {
        let is_drawn = self.entry.outline.is_empty() && self.side != ToolSide::Face;
        let (Some(Insert::Turning(insert)), true) = (&self.insert, is_drawn) else { return Vec::new() };
        let Some(entering_angle_deg) = self.given_entering_angle_deg(insert) else { return Vec::new() };
        if insert.is_round() {
            return Vec::new();
        }
        let flank = |trails| shape::flank(insert, entering_angle_deg, self.nose_mm, self.stance, trails);
        if self.is_neutral() { vec![flank(true), flank(false)] } else { vec![flank(true)] }
    }

    fn turning(&self, insert: &TurningInsert) -> Result<(Outline, Option<Outline>), ToolFault> {
        let angle_deg = insert.angle_deg;
        let usual = if angle_deg > 85.0 {
            75.0
        } else if angle_deg > 60.0 {
            95.0
        } else {
            93.0
        };
        let entering_angle_deg = self.given_entering_angle_deg(insert).unwrap_or(usual);
        if entering_angle_deg + angle_deg > 180.0 + 1e-9 {
            let why = format!(
                "an edge at {entering_angle_deg} degrees and a corner of {angle_deg} leave nothing behind the nose"
            );
            return Err(fault("entering_angle_deg", why));
        }
        let edge = insert.edge_mm() / 2.0;
        if self.nose_mm > edge && !insert.is_round() {
            return Err(fault("nose_radius_mm", "the nose is larger than the insert"));
        }
        let cutting = shape::insert(insert, entering_angle_deg, self.nose_mm, self.stance);
        let cutting = cutting.map_err(no_outline("insert"))?;
        let (shank_mm, length_mm) = self.shank();
        let holder = Holder {
            entering_angle_deg,
            faces: false,
            is_neutral: self.is_neutral(),
            is_left: self.stance.is_left,
            is_inside: self.side == ToolSide::Inside,
            shank_mm,
            length_mm,
        };
        let body = shape::turning_holder(insert, &holder, self.nose_mm, self.stance);
        let body = body.map_err(no_outline("holder"))?;
        Ok((cutting, Some(body)))
    }

    fn width_mm(&self) -> Option<f64> {
        self.entry.width_mm.or(match &self.insert {
            Some(Insert::Grooving { width_mm, .. }) => Some(*width_mm),
            _ => None,
        })
    }

    fn blade(&self) -> Result<(Outline, Option<Outline>), ToolFault> {
        let width = self.width_mm().ok_or_else(|| fault("width_mm", "a grooving tool needs its width"))?;
        if self.nose_mm > width / 2.0 + 1e-9 {
            return Err(fault("nose_radius_mm", "the corners are rounder than the blade is wide"));
        }
        let is_cut_off = self.kind == ToolKind::CutOff;
        let reach = self.entry.reach_mm.unwrap_or(if is_cut_off { 35.0 } else { (5.0 * width).max(15.0) });
        let clearance = self.entry.clearance_deg.unwrap_or(0.5).min(45.0);
        if 2.0 * reach * libm::tan(clearance.to_radians()) > 0.9 * width {
            return Err(fault("clearance_deg", "sides that lean so much leave nothing of the blade"));
        }
        let cutting = shape::blade(width, reach, clearance, self.nose_mm, self.stance);
        let cutting = cutting.map_err(no_outline("width_mm"))?;
        let left = shape::block_left(width, self.nose_mm, self.stance);
        let body = self.block(left, reach)?;
        Ok((cutting, Some(body)))
    }

    fn block(&self, left_mm: f64, from_mm: f64) -> Result<Outline, ToolFault> {
        let (shank_mm, length_mm) = self.shank();
        let is_bar = self.side == ToolSide::Inside;
        shape::block(left_mm, from_mm, shank_mm, length_mm, is_bar, self.stance)
            .map_err(no_outline("shank_mm"))
    }

    fn thread_angle_deg(&self) -> f64 {
        self.entry.thread_angle_deg.unwrap_or(match &self.insert {
            Some(Insert::Threading { angle_deg, .. }) => *angle_deg,
            _ => 60.0,
        })
    }

    fn threading(&self) -> Result<(Outline, Option<Outline>), ToolFault> {
        let width = self.entry.width_mm.unwrap_or(6.0);
        let angle = self.thread_angle_deg();
        let cutting =
            shape::pointed(angle, width, self.nose_mm, self.stance).map_err(no_outline("width_mm"))?;
        let height = width / 2.0 / libm::tan((angle / 2.0).to_radians());
        let body = self.block(-width / 2.0, 0.8 * height)?;
        Ok((cutting, Some(body)))
    }

    fn drill(&self, point_angle_deg: f64) -> Result<(Outline, Option<Outline>), ToolFault> {
        let diameter =
            self.entry.diameter_mm.ok_or_else(|| fault("diameter_mm", "a drill needs its diameter"))?;
        let length = self.entry.length_mm.unwrap_or(6.0 * diameter + 20.0);
        let angle = self.entry.point_angle_deg.unwrap_or(point_angle_deg);
        let cutting = shape::drill(diameter, angle, length).map_err(no_outline("diameter_mm"))?;
        let body = shape::sleeve(diameter, length).map_err(no_outline("length_mm"))?;
        Ok((cutting, Some(body)))
    }
}

/// Whether a word is the designation of an insert.
pub(crate) fn is_insert(word: &str) -> bool {
    designation::insert(word).is_ok()
}

/// Whether a word is the designation of a holder.
pub(crate) fn is_holder(word: &str) -> bool {
    designation::holder(word).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(text: &str) -> ToolEntry {
        toml::from_str(text).unwrap_or_else(|fault| panic!("{text}: {fault}"))
    }

    fn tool(text: &str) -> Tool {
        entry(text).resolve(None).unwrap_or_else(|fault| panic!("{text}: {fault:?}"))
    }

    fn refused(text: &str) -> (&'static str, String) {
        let fault = entry(text).resolve(None).expect_err(text);
        (fault.key, fault.why)
    }

    /// Lowest and highest X and Z of what cuts, rounded to a micrometre.
    fn reach(tool: &Tool) -> [f64; 4] {
        let bounds = tool.cutting.bounds();
        [bounds.min.x, bounds.max.x, bounds.min.z, bounds.max.z].map(|n| (n * 1e3).round() / 1e3)
    }

    #[test]
    fn the_tip_of_a_turning_tool_is_the_programmed_point() {
        // Tip 3: the nose touches X = 0 and Z = 0 of the programmed point from above and from the right.
        let right = tool("insert = \"CNMG120408\"\nholder = \"PCLNR2525M12\"\n");
        let [low_x, _, low_z, _] = reach(&right);
        assert_eq!((low_x, low_z), (0.0, 0.0));
        assert_eq!((right.tip, right.nose_radius_mm, right.hand), (3, 0.8, Hand::Right));
        // A side of 12.896 and corners of 80 degrees, less what the noses take off.
        let rhombus = 12.7 * 12.7 / libm::sin(80_f64.to_radians());
        assert!(right.cutting.area_mm2() < rhombus && right.cutting.area_mm2() > rhombus - 1.5);
        let left = tool("insert = \"CNMG120408\"\nhand = \"left\"\n");
        assert_eq!((left.tip, reach(&left)[3]), (4, 0.0));
        let bar = tool("insert = \"CCMT060204\"\nholder = \"S16Q-SCLCR06\"\n");
        assert_eq!((bar.tip, bar.side), (2, ToolSide::Inside));
        assert_eq!((reach(&bar)[1], reach(&bar)[2]), (0.0, 0.0));
        let back = tool("insert = \"DCMT070204\"\nside = \"inside\"\nhand = \"left\"\n");
        assert_eq!((back.tip, reach(&back)[1], reach(&back)[3]), (1, 0.0, 0.0));
    }

    #[test]
    fn the_body_stays_behind_the_edges_of_the_insert() {
        for text in [
            "insert = \"CNMG120408\"",
            "insert = \"DNMG150608\"",
            "insert = \"VBMT160404\"",
            "insert = \"TNMG160408\"",
            "insert = \"WNMG080408\"",
            "insert = \"SNMG120408\"\nentering_angle_deg = 45",
            "insert = \"RCMT1204M0\"",
            "insert = \"VBMT160404\"\nholder = \"SVVBN2525M16\"",
            "insert = \"TNMG160408\"\nholder = \"PTFNR2525M16\"",
            "insert = \"CCMT09T308\"\nside = \"inside\"",
            "insert = \"DCMT11T304\"\nholder = \"S20R-SDUCR11\"",
            "kind = \"grooving\"\nwidth_mm = 3",
            "kind = \"grooving\"\nwidth_mm = 3\nside = \"inside\"",
            "kind = \"grooving\"\nwidth_mm = 3\nside = \"face\"",
            "insert = \"16ER1.5ISO\"",
            "insert = \"16IR1.5ISO\"",
        ] {
            let tool = tool(text);
            let body = tool.body.as_ref().expect("a body");
            // The edge that leads to the tip is free of it.
            let (x, z) = shape::tip_direction(tool.tip);
            let (cutting, body) = (tool.cutting.bounds(), body.bounds());
            let inner = |low: f64, high: f64, way: i8| if way < 0 { low } else { -high };
            if x != 0 && tool.side != ToolSide::Face {
                assert!(inner(cutting.min.x, cutting.max.x, x) < inner(body.min.x, body.max.x, x), "{text}");
            }
            if z != 0 && tool.side != ToolSide::Inside {
                assert!(inner(cutting.min.z, cutting.max.z, z) < inner(body.min.z, body.max.z, z), "{text}");
            }
        }
    }

    #[test]
    fn a_sharp_square_shoulder_is_cut_by_a_tool_that_leans_back() {
        // 95 degrees: the edge leans back by 5 from the square shoulder, the other by 5 from the turned surface.
        let cutting = tool("insert = \"CNMG120400\"\n").cutting;
        let at = |x: f64, z: f64| cutting.contains(Point::new(x, z));
        let lean = libm::tan(5_f64.to_radians());
        assert!(!at(10.0, 10.0 * lean - 0.01) && at(10.0, 10.0 * lean + 0.01));
        assert!(!at(10.0 * lean - 0.01, 10.0) && at(10.0 * lean + 0.01, 10.0));
    }

    #[test]
    fn the_edge_behind_the_nose_is_known_when_the_holder_is() {
        // 95 + 80 degrees leave 5, 93 + 55 leave 32; outside, inside and towards the other end.
        for (text, clear_deg, way) in [
            ("insert = \"CNMG120408\"\nholder = \"PCLNR2525M12\"\n", 5.0, (1, 1)),
            ("insert = \"DNMG150608\"\nholder = \"PDJNR2525M15\"\n", 32.0, (1, 1)),
            ("insert = \"DNMG150608\"\nholder = \"PDJNL2525M15\"\n", 32.0, (1, -1)),
            ("insert = \"DCMT11T304\"\nholder = \"S20R-SDUCR11\"\n", 32.0, (-1, 1)),
            ("insert = \"VBMT160404\"\nentering_angle_deg = 93\n", 52.0, (1, 1)),
        ] {
            let tool = tool(text);
            let [flank] = tool.flanks[..] else { panic!("{text}: {:?}", tool.flanks) };
            assert!((flank.clear_deg() - clear_deg).abs() < 1e-9, "{text}: {}", flank.clear_deg());
            let along = flank.way();
            assert_eq!((along.x.signum(), along.z.signum()), (f64::from(way.0), f64::from(way.1)), "{text}");
            // On the outline: just inside is the insert, just outside is not, half way along it.
            let middle = along.times(0.5 * flank.near.distance(flank.far)).from(flank.near);
            assert!(tool.cutting.contains(flank.outward.times(-1e-6).from(middle)), "{text}");
            assert!(!tool.cutting.contains(flank.outward.times(1e-6).from(middle)), "{text}");
        }
        assert_eq!(tool("insert = \"VBMT160404\"\nholder = \"SVVBN2525M16\"").flanks.len(), 2);
        for text in [
            "insert = \"CNMG120408\"\n",
            "insert = \"RCMT1204M0\"\nentering_angle_deg = 75\n",
            "kind = \"grooving\"\nwidth_mm = 3\n",
        ] {
            assert_eq!(tool(text).flanks, [], "{text}");
        }
    }

    #[test]
    fn the_spindle_turns_for_the_insert() {
        use CuttingTurn::{Clockwise, CounterClockwise};
        for (text, turn) in [
            ("insert = \"CNMG120408\"\nholder = \"PCLNR2525M12\"\n", Some(Clockwise)),
            ("insert = \"CNMG120408\"\nholder = \"PCLNL2525M12\"\n", Some(Clockwise)),
            (
                "insert = \"CNMG120408\"\nholder = \"PCLNL2525M12\"\nhand = \"right\"\n",
                Some(CounterClockwise),
            ),
            ("insert = \"CCMT060204\"\nholder = \"S16Q-SCLCR06\"\n", Some(Clockwise)),
            ("insert = \"CCMT060204\"\nholder = \"S16Q-SCLCR06\"\nhand = \"left\"\n", None),
            ("insert = \"VBMT160404\"\nholder = \"SVVBN2525M16\"\n", None),
            ("insert = \"CNMG120408\"\n", None),
            ("insert = \"CNMG120408\"\ninsert_faces = \"up\"\n", None),
            ("insert = \"CNMG120408\"\ninsert_faces = \"up\"\npost = \"front\"\n", Some(Clockwise)),
            (
                "kind = \"cut-off\"\nwidth_mm = 3\ninsert_faces = \"up\"\npost = \"rear\"\n",
                Some(CounterClockwise),
            ),
            ("insert = \"16ER1.5ISO\"\ninsert_faces = \"down\"\npost = \"rear\"\n", Some(Clockwise)),
            ("insert = \"16ER1.5ISO\"\ninsert_faces = \"down\"\npost = \"front\"\n", Some(CounterClockwise)),
        ] {
            assert_eq!(tool(text).turn, turn, "{text}");
        }
    }

    #[test]
    fn blades_stand_on_the_corner_that_is_programmed() {
        let left = tool("kind = \"grooving\"\nwidth_mm = 3\n");
        assert_eq!((left.tip, reach(&left)), (3, [0.0, 15.0, 0.0, 3.0]));
        let right = tool("kind = \"grooving\"\nwidth_mm = 3\ntip = 4\nreach_mm = 20\n");
        assert_eq!(reach(&right), [0.0, 20.0, -3.0, 0.0]);
        let middle = tool("kind = \"cut-off\"\nwidth_mm = 4\ntip = 8\n");
        assert_eq!(reach(&middle), [0.0, 35.0, -2.0, 2.0]);
        let inside = tool("kind = \"grooving\"\nwidth_mm = 3\nside = \"inside\"\n");
        assert_eq!((inside.tip, reach(&inside)), (2, [-15.0, 0.0, 0.0, 3.0]));
        let face = tool("kind = \"grooving\"\nwidth_mm = 3\nside = \"face\"\n");
        assert_eq!(reach(&face), [0.0, 3.0, 0.0, 15.0]);
        let face = tool("kind = \"grooving\"\nwidth_mm = 3\nside = \"face\"\ntip = 2\n");
        assert_eq!(reach(&face), [-3.0, 0.0, 0.0, 15.0]);
        assert_eq!(tool("insert = \"MGMN300\"\n").width_mm, Some(3.0));
    }

    #[test]
    fn drills_have_their_cone_and_threads_their_flanks() {
        // tan 59° · cone = radius.
        let drill = tool("kind = \"drilling\"\ndiameter_mm = 20\n");
        let cone = 10.0 / libm::tan(59_f64.to_radians());
        assert!((drill.cutting.area_mm2() - (20.0 * 140.0 - 10.0 * cone)).abs() < 1e-9);
        assert_eq!(tool("diameter_mm = 8\n").kind, ToolKind::Drilling);
        let thread = tool("insert = \"16ER1.5ISO\"\nnose_radius_mm = 0.2\n");
        let [low, _, left, right] = reach(&thread);
        assert_eq!((low, left, right, thread.thread_angle_deg), (0.0, -3.0, 3.0, Some(60.0)));
        let inside = tool("insert = \"16IR1.5ISO\"\n");
        assert_eq!((inside.tip, reach(&inside)[1]), (6, 0.0));
    }

    #[test]
    fn what_the_entry_leaves_open_the_offset_says() {
        let entry = entry("insert = \"16ER1.5ISO\"\n");
        assert_eq!(entry.resolve(Some((0.2, 8))).expect("a tool").nose_radius_mm, 0.2);
        let entry = super::tests::entry("insert = \"CNMG120408\"\n");
        let tool = entry.resolve(Some((0.4, 4))).expect("a tool");
        assert_eq!((tool.nose_radius_mm, tool.tip, tool.hand), (0.8, 4, Hand::Left));
    }

    #[test]
    fn tools_that_cannot_be_are_refused_with_the_key() {
        for (text, key) in [
            ("name = \"rough\"\n", ""),
            ("kind = \"turning\"\n", "insert"),
            ("insert = \"CNMG990408\"\n", "insert"),
            ("insert = \"CNMG120408\"\nkind = \"threading\"\n", "insert"),
            ("insert = \"CNMG120408\"\nnose_radius_mm = -0.8\n", "nose_radius_mm"),
            ("insert = \"CNMG120408\"\nnose_radius_mm = 50\n", "nose_radius_mm"),
            ("insert = \"CNMG120408\"\ntip = 10\n", "tip"),
            ("insert = \"CNMG120408\"\ntip = 4\nhand = \"right\"\n", "tip"),
            ("insert = \"CNMG120408\"\ntip = 2\n", "tip"),
            ("insert = \"CNMG120408\"\nentering_angle_deg = 120\n", "entering_angle_deg"),
            ("insert = \"CNMG120408\"\nholder = \"PC\"\n", "holder"),
            ("kind = \"grooving\"\n", "width_mm"),
            ("kind = \"grooving\"\nwidth_mm = 0\n", "width_mm"),
            ("kind = \"grooving\"\nwidth_mm = 1\nreach_mm = 60\n", "clearance_deg"),
            ("kind = \"grooving\"\nwidth_mm = 1\nnose_radius_mm = 2\n", "nose_radius_mm"),
            ("kind = \"drilling\"\n", "diameter_mm"),
            ("kind = \"drilling\"\ndiameter_mm = 8\npoint_angle_deg = 200\n", "point_angle_deg"),
            ("outline = [{ x = 0, z = 0 }, { x = 1, z = 1 }]\n", "outline"),
        ] {
            let (found, why) = refused(text);
            assert_eq!((found, why.is_empty()), (key, false), "{text}: {why}");
        }
    }
}
