//! The axes beyond X and Z: which the machine has, their words, places and moves.
//!
//! C and B turn and count degrees, Y is a length. Absolute words are C, Y and B, increments H and V, where U and
//! W are increments too. A degree is written by the decimal rule of lengths, in thousandths without a point, and
//! is no inch in inch input. Feed counts a degree as a millimetre, or as an inch in inch input, along the root of
//! all squares: `G98 G01 C90. F360.` turns 90 degrees in a quarter of a minute. A word of an axis that the machine does not have is refused like any foreign letter.
//!
//! Moves without such words never come here: one bit test in the motion functions decides.
//!
//! Source: axis names and roles, rotary axes, feed of rotary axes, both families.

use turnwright_canon::{Action, Interpolation, OtherAxes, RapidPath, Shape, SpeedRatio};
use turnwright_control::MachineAxes;
use turnwright_control::policy::{FineDigits, PolarOverspeed};
use turnwright_syntax::{Block, Word};
use turnwright_units::{Angle, Feed, FeedPerMinute, Length, Position, Radius, WorkTip};

use crate::block::Call;
use crate::corner::LETTERS;
use crate::machine::Core;
use crate::report::Alarm;

/// The working plane: arcs lie in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Plane {
    Xy,
    #[default]
    Zx,
    Yz,
}

/// Places of the axes beyond X and Z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Places {
    pub(crate) c: Angle,
    pub(crate) y: Length,
    pub(crate) b: Angle,
}

/// The axes beyond X and Z, and the modes that concern them.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    pub(crate) machine: MachineAxes,
    pub(crate) has_live_tools: bool,
    /// The letters that name such an axis, or a centre on one.
    pub(crate) letters: u32,
    /// Blocks with any of these letters are more than a move of X and Z.
    pub(crate) rare: u32,
    pub(crate) plane: Plane,
    /// Where they stand, in the coordinates of the program.
    pub(crate) at: Places,
    /// Program zero in machine coordinates: all zeros and shifts in force.
    pub(crate) preset: Places,
    /// Where they stood before the last move that took them along.
    pub(crate) came_from: Places,
    pub(crate) interpolation: Interpolation,
    /// Movement of the tool offset in Y that is still to be made.
    pub(crate) untaken_y: Length,
    /// Place on the virtual axis.
    pub(crate) v: Length,
    /// On the cylinder, words of the rotary axis are lengths.
    pub(crate) unrolled_words: bool,
    /// In polar interpolation, points are given by radius and angle.
    pub(crate) polar_words: bool,
    pub(crate) coupling: Option<SpeedRatio>,
    /// The spindle turns as a spindle: it is no axis.
    pub(crate) is_spindle: bool,
    has_untold_interpolation: bool,
    has_untold_coupling: bool,
}

const TURNING: u32 = Block::bit(b'C') | Block::bit(b'H');
const ACROSS: u32 = Block::bit(b'Y') | Block::bit(b'V');
const SWIVEL: u32 = Block::bit(b'B');
/// In a virtual plane every move is rare.
const VIRTUAL: u32 = u32::MAX;

impl Axes {
    /// At the reference point, with the spindle as a spindle where M codes change it.
    pub(crate) fn new(machine: MachineAxes, has_live_tools: bool, has_incremental_words: bool) -> Self {
        let words = |has: bool, absolute: u32, both: u32| match (has, has_incremental_words) {
            (false, _) => 0,
            (true, true) => both,
            (true, false) => absolute,
        };
        let letters = words(machine.c.is_some(), Block::bit(b'C'), TURNING)
            | words(machine.y.is_some(), Block::bit(b'Y'), ACROSS)
            | words(machine.b.is_some(), SWIVEL, SWIVEL);
        let has_planes = machine.c.is_some() || machine.y.is_some();
        let letters = letters | if has_planes { Block::bit(b'J') } else { 0 };
        let reference = |axis: &Option<turnwright_control::RotaryAxis>| {
            let degrees = axis.as_ref().map_or(0.0, |axis| axis.reference_deg);
            Angle::from_nanodegrees((degrees * 1e9).round() as i64)
        };
        let y = machine.y.as_ref().map_or(0.0, |axis| axis.reference_mm);
        let at = Places {
            c: reference(&machine.c),
            y: Length::from_nm((y * 1e6).round() as i64),
            b: reference(&machine.b),
        };
        Self {
            is_spindle: machine.c.as_ref().is_some_and(|axis| !axis.on_m.is_empty()),
            machine,
            has_live_tools,
            letters,
            rare: letters,
            plane: Plane::default(),
            at,
            preset: Places::default(),
            came_from: Places::default(),
            interpolation: Interpolation::Normal,
            untaken_y: Length::ZERO,
            v: Length::ZERO,
            unrolled_words: false,
            polar_words: false,
            coupling: None,
            has_untold_interpolation: false,
            has_untold_coupling: false,
        }
    }

    /// Whether moves run in a virtual plane.
    pub(crate) fn is_virtual(&self) -> bool {
        self.rare == VIRTUAL
    }

    /// Moves from here on run in this kind of plane.
    pub(crate) fn interpolate(&mut self, interpolation: Interpolation) {
        self.interpolation = interpolation;
        self.rare = if interpolation == Interpolation::Normal { self.letters } else { VIRTUAL };
        self.unrolled_words = false;
        self.polar_words = false;
        self.v = match interpolation {
            Interpolation::Cylindrical { radius } => Interpolation::unrolled(radius, self.at.c),
            Interpolation::Normal | Interpolation::Polar { .. } => Length::ZERO,
        };
    }

    /// Where they stand in machine coordinates.
    pub(crate) fn in_machine(&self) -> Places {
        self.at.plus(self.preset)
    }

    /// An M code was given out: it may make the spindle an axis, or a spindle again.
    #[cold]
    pub(crate) fn machine_code(&mut self, code: u32) {
        if let Some(axis) = &self.machine.c {
            if axis.on_m.contains(&code) {
                self.is_spindle = false;
            } else if axis.off_m.contains(&code) {
                self.is_spindle = true;
            }
        }
    }

    /// Whether none of these ends is another place.
    fn stay(&self, ends: &OtherAxes) -> bool {
        ends.c.is_none_or(|c| c == self.at.c)
            && ends.y.is_none_or(|y| y == self.at.y)
            && ends.b.is_none_or(|b| b == self.at.b)
            && ends.v.is_none_or(|v| v == self.v)
    }
}

impl Core {
    /// The first word of a block that names an axis beyond X and Z.
    pub(crate) fn other_axis_word<'b>(&self, block: &'b Block) -> Option<&'b Word> {
        block.words.iter().find(|word| !word.comma && self.axes.letters & Block::bit(word.address) != 0)
    }

    /// An angle by the decimal rule of the control; degrees know no inch.
    pub(crate) fn angle(&self, word: &Word) -> Result<Angle, Alarm> {
        let number = self.number(word)?;
        let step = i128::from(self.settings.metric_increment.nm()) * 1_000;
        let count = if number.has_point || self.settings.is_calculator {
            if number.scale > 9 {
                return Err(self.alarm("number-too-long", word));
            }
            let nanodegrees = i128::from(number.digits) * 10i128.pow(9 - u32::from(number.scale));
            let half = match self.control.policies.fine_digits {
                FineDigits::Cut if !number.is_computed() => 0,
                FineDigits::Cut | FineDigits::Round => step / 2 * nanodegrees.signum(),
            };
            (nanodegrees + half) / step
        } else {
            i128::from(number.digits)
        };
        if count.abs() >= 10i128.pow(u32::from(self.control.limits.number_digits.min(9))) {
            return Err(self.alarm("number-too-long", word));
        }
        Ok(Angle::from_nanodegrees((count * step) as i64))
    }

    /// Where the words of a block send the axes beyond X and Z.
    pub(crate) fn other_targets(&mut self, block: &Block) -> Result<OtherAxes, Alarm> {
        let mut ends = OtherAxes::default();
        let present = block.present() & self.axes.letters;
        if present & TURNING != 0 {
            let (word, is_increment) = self.axis_word(block, b'C', b'H')?;
            if self.axes.is_spindle {
                return Err(self.alarm("axis-is-spindle", word));
            }
            self.rotary_target(word, is_increment, &mut ends)?;
        }
        if present & ACROSS != 0 {
            let (word, is_increment) = self.axis_word(block, b'Y', b'V')?;
            let length = self.length(word)?;
            let from = self.axes.at.y + std::mem::take(&mut self.axes.untaken_y);
            ends.y = Some(if is_increment { from + length } else { length });
            self.missing_point(word);
        }
        if let Some(word) = block.word(b'B').filter(|_| present & SWIVEL != 0) {
            let angle = self.angle(word)?;
            ends.b = Some(if self.modal.is_incremental { self.axes.at.b + angle } else { angle });
        }
        Ok(ends)
    }

    fn rotary_target(&mut self, word: &Word, is_increment: bool, ends: &mut OtherAxes) -> Result<(), Alarm> {
        let from = self.axes.at.c;
        match self.axes.interpolation {
            Interpolation::Normal => {
                let angle = self.angle(word)?;
                let axis = self.axes.machine.c.as_ref().filter(|axis| axis.rolls_over && !is_increment);
                ends.c = Some(match axis {
                    Some(axis) => {
                        let turn = Angle::from_nanodegrees((axis.turn_deg * 1e9).round() as i64);
                        angle.nearest_to(from, turn)
                    }
                    None if is_increment => from + angle,
                    None => angle,
                });
            }
            Interpolation::Cylindrical { radius } if !self.axes.unrolled_words => {
                let angle = self.angle(word)?;
                let angle = if is_increment { from + angle } else { angle };
                ends.c = Some(angle);
                ends.v = Some(Interpolation::unrolled(radius, angle));
            }
            Interpolation::Cylindrical { .. } | Interpolation::Polar { .. } => {
                let length = self.length(word)?;
                ends.v = Some(if is_increment { self.axes.v + length } else { length });
                self.missing_point(word);
            }
        }
        Ok(())
    }

    /// The end point of a move with all its axes.
    pub(crate) fn end_point(&mut self, block: &Block) -> Result<(Position<WorkTip>, OtherAxes), Alarm> {
        if let Some(word) = self.other_axis_word(block)
            && self.is_capturing()
        {
            return Err(self.alarm("axis-not-in-plane", word));
        }
        if self.axes.polar_words {
            return self.polar_point(block);
        }
        let mut to = self.target(block)?;
        if let Some(roughing) = &self.cylinder_roughing
            && block.has(b'X')
            && !self.modal.is_incremental
        {
            to.x = to.x + roughing.shift();
        }
        let ends = self.other_targets(block)?;
        Ok((to, ends))
    }

    /// A point by radius (the word of X) and angle (the word of C) about the zero of the polar plane, rounded
    /// once to the least increment. A word left out keeps the radius or direction of the present point.
    fn polar_point(&mut self, block: &Block) -> Result<(Position<WorkTip>, OtherAxes), Alarm> {
        if let Some(word) = block.word(b'U').or(block.word(b'H')) {
            return Err(self.alarm("illegal-address", word));
        }
        let from = self.modal.position;
        let (x_mm, v_mm) = (from.x.to_mm(), self.axes.v.to_mm());
        let to = self.target(block)?;
        let radius_mm = if block.has(b'X') { to.x.to_mm() } else { libm::hypot(x_mm, v_mm) };
        let direction = match block.word(b'C') {
            Some(word) => self.angle(word)?.to_radians(),
            None => libm::atan2(v_mm, x_mm),
        };
        let increment = self.modal.increment(&self.settings);
        let rounded = |mm: f64, word: Option<&Word>| {
            Length::from_mm_rounded(mm, increment).ok_or_else(|| self.alarm_at("position-out-of-range", word))
        };
        let diameter = rounded(radius_mm * libm::cos(direction) * 2.0, block.word(b'X'))?;
        let v = rounded(radius_mm * libm::sin(direction), block.word(b'C'))?;
        let mut ends = OtherAxes { v: Some(v), ..OtherAxes::default() };
        let b = block.word(b'B').filter(|_| self.axes.machine.b.is_some());
        ends.b = b.map(|word| self.angle(word)).transpose()?;
        Ok((Position::new(turnwright_units::Diameter(diameter).to_radius(), to.z), ends))
    }

    /// A straight cut with other axes, or in a virtual plane.
    #[cold]
    pub(crate) fn linear_with_axes(&mut self, call: &Call<'_>) -> Result<(), Alarm> {
        self.refuse_words_of_corners(call.block)?;
        let (to, ends) = self.end_point(call.block)?;
        // Words that name a plane are zero and move nothing.
        if to == self.modal.position && self.axes.stay(&ends) {
            return Ok(());
        }
        self.refuse_too_many_axes(call.block, to, &ends)?;
        let Some(feed) = self.feed_in_force() else {
            return Err(self.alarm_at("feed-missing", call.word));
        };
        self.check_spindle();
        self.cut_with_axes(to, Shape::Line, feed, ends)
    }

    /// Positioning with other axes, or in a virtual plane.
    #[cold]
    pub(crate) fn rapid_with_axes(&mut self, call: &Call<'_>) -> Result<(), Alarm> {
        self.refuse_words_of_corners(call.block)?;
        let (to, ends) = self.end_point(call.block)?;
        let path = if self.axes.is_virtual() { RapidPath::Straight } else { self.rapid_path() };
        self.modal.position = to;
        let others = self.take_along(to, &Shape::Line, ends);
        self.emit_move(to, Action::Rapid { to, path, others })
    }

    /// A cut leads only so many axes together.
    fn refuse_too_many_axes(
        &self,
        block: &Block,
        to: Position<WorkTip>,
        ends: &OtherAxes,
    ) -> Result<(), Alarm> {
        let from = self.modal.position;
        let moving = [
            to.x != from.x,
            to.z != from.z,
            ends.c.is_some() || ends.v.is_some(),
            ends.y.is_some(),
            ends.b.is_some(),
        ];
        let count = moving.into_iter().filter(|moves| *moves).count();
        if count <= usize::from(self.control.limits.simultaneous_axes_max) {
            return Ok(());
        }
        let last = block.words.iter().rfind(|word| b"XZUWCHYVB".contains(&word.address));
        Err(self.alarm_at("too-many-axes", last))
    }

    fn refuse_words_of_corners(&mut self, block: &Block) -> Result<(), Alarm> {
        if self.corner.is_some() {
            return Err(self.corner_interrupted());
        }
        let letter = |word: &&Word| {
            let is_axis = self.axes.letters & Block::bit(word.address) != 0 && word.address != b'J';
            word.comma || word.address == b'J' || (LETTERS.contains(&word.address) && !is_axis)
        };
        match block.words.iter().find(letter) {
            Some(word) => Err(self.alarm("illegal-address", word)),
            None => Ok(()),
        }
    }

    /// Gives out a cutting move with other axes.
    pub(crate) fn cut_with_axes(
        &mut self,
        to: Position<WorkTip>,
        shape: Shape,
        feed: Feed,
        ends: OtherAxes,
    ) -> Result<(), Alarm> {
        let feed = match self.axes.interpolation {
            Interpolation::Polar { .. } => self.polar_feed(to, &shape, feed, &ends)?,
            _ => feed,
        };
        self.modal.position = to;
        let others = self.take_along(to, &shape, ends);
        self.emit_move(to, Action::Feed { to, shape, feed, others })
    }

    /// The feed in polar interpolation: no more than its parameter allows, and not so near the spindle axis that
    /// the rotary axis cannot follow.
    fn polar_feed(
        &mut self,
        to: Position<WorkTip>,
        shape: &Shape,
        feed: Feed,
        ends: &OtherAxes,
    ) -> Result<Feed, Alarm> {
        let Feed::PerMinute(FeedPerMinute(mut length)) = feed else { return Ok(feed) };
        let limit = self.settings.polar_feed_max;
        if !limit.is_zero() {
            length = length.min(limit);
        }
        let from = (self.modal.position.x.to_mm(), self.axes.v.to_mm());
        let end = (to.x.to_mm(), ends.v.unwrap_or(self.axes.v).to_mm());
        let nearest_mm = match shape {
            Shape::Line => nearest_to_axis_mm(from, end),
            _ => libm::hypot(from.0, from.1).min(libm::hypot(end.0, end.1)),
        };
        let fastest = self.axes.machine.c.as_ref().map_or(f64::INFINITY, |axis| axis.cutting_max_deg_per_min);
        let turns_mm = (end.0 * from.1 - end.1 * from.0).abs();
        let degrees_per_minute = (length.to_mm() / nearest_mm.max(1e-6)).to_degrees();
        if turns_mm > 1e-6 && degrees_per_minute > fastest && !self.settings.polar_automatic_override {
            match self.control.policies.polar_overspeed {
                PolarOverspeed::Alarm => return Err(self.alarm_block("polar-axis-too-fast")),
                PolarOverspeed::Warn => self.warn_block("polar-axis-too-fast"),
            }
        }
        Ok(Feed::PerMinute(FeedPerMinute(length)))
    }

    /// Takes the ends of a move as the places of the other axes; gives those that the move changes.
    pub(crate) fn take_along(
        &mut self,
        to: Position<WorkTip>,
        shape: &Shape,
        mut ends: OtherAxes,
    ) -> Option<Box<OtherAxes>> {
        let is_inch = self.modal.is_inch;
        let axes = &mut self.axes;
        axes.came_from = axes.at;
        if axes.is_virtual() {
            let v = ends.v.unwrap_or(axes.v);
            let (_, angle) = axes.interpolation.axes_at(to, v, shape, axes.at.c);
            ends.v = Some(v);
            ends.c = Some(ends.c.unwrap_or(angle));
        }
        let is_side_arc = matches!(shape, Shape::SideArc { .. });
        if axes.stay(&ends) && !is_side_arc {
            return None;
        }
        axes.v = ends.v.unwrap_or(axes.v);
        axes.at = Places {
            c: ends.c.unwrap_or(axes.at.c),
            y: ends.y.unwrap_or(axes.at.y),
            b: ends.b.unwrap_or(axes.at.b),
        };
        ends.per_degree = if is_inch { Length::from_nm(25_400_000) } else { Length::from_mm(1) };
        Some(Box::new(ends))
    }

    /// Where a block that acts once sends the axes beyond X and Z.
    pub(crate) fn other_ends(&mut self, block: &Block) -> Result<OtherAxes, Alarm> {
        if block.present() & self.axes.letters == 0 {
            return Ok(OtherAxes::default());
        }
        self.refuse_words_of_corners(block)?;
        self.other_targets(block)
    }

    /// The same for words that are machine coordinates; increments do not count and are named.
    pub(crate) fn other_ends_of_machine(&mut self, block: &Block) -> Result<OtherAxes, Alarm> {
        let mut ends = OtherAxes::default();
        if block.present() & self.axes.letters == 0 {
            return Ok(ends);
        }
        self.refuse_words_of_corners(block)?;
        let are_increments = self.modal.is_incremental;
        let letters = self.axes.letters;
        for word in block.words.iter().filter(|word| letters & Block::bit(word.address) != 0) {
            let preset = self.axes.preset;
            match word.address {
                b'C' if self.axes.is_spindle => return Err(self.alarm("axis-is-spindle", word)),
                b'C' | b'Y' | b'B' if are_increments => self.warn("machine-move-increment-ignored", word),
                b'C' => ends.c = Some(self.angle(word)? - preset.c),
                b'B' => ends.b = Some(self.angle(word)? - preset.b),
                b'Y' => {
                    ends.y = Some(self.length(word)? - preset.y);
                    self.missing_point(word);
                }
                _ => self.warn("machine-move-increment-ignored", word),
            }
        }
        Ok(ends)
    }

    /// A reference point, 0 to 3, in the coordinates of the program.
    fn reference_of_others(&self, number: usize) -> Places {
        self.zeros.others.reference[number].minus(self.axes.preset)
    }

    /// A reference point, 0 to 3, of those axes beyond X and Z that go somewhere.
    pub(crate) fn other_reference(&self, number: usize, ends: &OtherAxes) -> OtherAxes {
        let places = self.reference_of_others(number);
        OtherAxes {
            c: ends.c.map(|_| places.c),
            y: ends.y.map(|_| places.y),
            b: ends.b.map(|_| places.b),
            ..OtherAxes::default()
        }
    }

    /// The first word of a block whose axis does not stand at its first reference point. A rotary axis stands there
    /// again after every full turn.
    pub(crate) fn other_axis_not_at_home<'b>(&self, block: &'b Block) -> Option<&'b Word> {
        let (home, at, machine) = (self.reference_of_others(0), self.axes.at, &self.axes.machine);
        let turns = |from: Angle, to: Angle, turn_deg: f64| {
            let turn = ((turn_deg * 1e9).round() as i64).max(1);
            (to - from).nanodegrees() % turn == 0
        };
        block.words.iter().find(|word| match word.address {
            b'C' | b'H' => machine.c.as_ref().is_some_and(|axis| !turns(home.c, at.c, axis.turn_deg)),
            b'Y' | b'V' => machine.y.is_some() && at.y != home.y,
            b'B' => machine.b.is_some() && !turns(home.b, at.b, 360.0),
            _ => false,
        })
    }

    /// The zeros have moved this way, and the offset of the tool in Y has changed, as a shift or as a movement. The
    /// axes stay where they are and have new coordinates.
    pub(crate) fn move_other_zeros(&mut self, mut way: Places, shift_y: Length, movement_y: Length) {
        if self.axes.machine.y.is_some() {
            way.y += shift_y + movement_y;
            self.axes.untaken_y += movement_y;
        }
        if way == Places::default() {
            return;
        }
        let axes = &mut self.axes;
        (axes.preset, axes.at) = (axes.preset.plus(way), axes.at.minus(way));
        let at = axes.at;
        let others = OtherAxes {
            c: (way.c != Angle::ZERO).then_some(at.c),
            y: (!way.y.is_zero()).then_some(at.y),
            b: (way.b != Angle::ZERO).then_some(at.b),
            ..OtherAxes::default()
        };
        self.emit(Action::Relocate { to: self.tip, others: Some(Box::new(others)) });
    }

    /// The movement of the offset in Y that is still to be made, as the axes of a move.
    pub(crate) fn take_movement_y(&mut self) -> Option<Box<OtherAxes>> {
        let way = std::mem::take(&mut self.axes.untaken_y);
        if way.is_zero() {
            return None;
        }
        let ends = OtherAxes { y: Some(self.axes.at.y + way), ..OtherAxes::default() };
        self.take_along(self.modal.position, &Shape::Line, ends)
    }

    /// Gives the places where the other axes stand new coordinates.
    pub(crate) fn preset_other_axes(&mut self, block: &Block) -> Result<(), Alarm> {
        if block.present() & self.axes.letters == 0 {
            return Ok(());
        }
        self.refuse_words_of_corners(block)?;
        let ends = self.other_targets(block)?;
        let here = self.axes.at;
        let there =
            Places { c: ends.c.unwrap_or(here.c), y: ends.y.unwrap_or(here.y), b: ends.b.unwrap_or(here.b) };
        let named = self.others_named(block);
        self.with_new_zero(|core| {
            let zeros = &mut core.zeros.others;
            let local = zeros.local.clear(named);
            zeros.preset = zeros.preset.plus(local).plus(here).minus(there);
        });
        Ok(())
    }

    /// Leaves polar or cylindrical interpolation: X and C are themselves again.
    pub(crate) fn leave_virtual_plane(&mut self) {
        if !self.axes.is_virtual() {
            return;
        }
        let place = self.modal.position;
        let (real, _) = self.axes.interpolation.axes_at(place, self.axes.v, &Shape::Line, self.axes.at.c);
        self.axes.interpolate(Interpolation::Normal);
        self.settings.x_is_radius = !self.control.parameters.bit("diameter-programming");
        self.emit(Action::Interpolation(Interpolation::Normal));
        if real != place {
            let increment = self.modal.increment(&self.settings);
            let x = real.x.to_diameter().rounded(increment).to_radius();
            self.modal.position = Position::new(x, place.z);
            self.tip = self.modal.position;
            self.emit(Action::Relocate { to: self.tip, others: None });
        }
    }

    /// Tells at a new start what the reset before it has ended.
    pub(crate) fn tell_axes(&mut self) {
        if std::mem::take(&mut self.axes.has_untold_interpolation) {
            self.emit(Action::Interpolation(Interpolation::Normal));
        }
        if std::mem::take(&mut self.axes.has_untold_coupling) {
            self.emit(Action::Coupling(None));
        }
    }

    /// What a reset does to planes and couplings: virtual planes and couplings always end. It is told at the next
    /// start ([`Core::tell_axes`]).
    pub(crate) fn reset_axes(&mut self, clears: bool) {
        self.axes.has_untold_interpolation |= self.axes.is_virtual();
        self.axes.has_untold_coupling |= self.axes.coupling.take().is_some();
        self.leave_virtual_plane();
        if clears {
            self.axes.plane = self.settings.plane_at_power_on;
        }
    }
}

/// How near a straight line comes to the zero of its plane.
fn nearest_to_axis_mm(from: (f64, f64), to: (f64, f64)) -> f64 {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let square = x * x + y * y;
    let share = if square > 0.0 { (-(from.0 * x + from.1 * y) / square).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(from.0 + x * share, from.1 + y * share)
}

/// X stays below the spindle axis.
pub(crate) fn is_below(x: Radius) -> bool {
    x.0.signum() < 0
}
