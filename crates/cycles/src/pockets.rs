//! Rough turning and rough facing of a figure with pockets (type II).
//!
//! In: a [`Figure`] whose contour never turns back along the cut, and a [`PocketRequest`]. Out: for every level and
//! every stretch of the figure deeper than it: infeed or down the near wall, cut, up the far wall to the level
//! before, a little away; then back to the start, once along the figure, and home. A pocket is finished, all its
//! levels, before the next one begins, in the direction of the cut.
//!
//! The tool goes straight down only to where something was cut before: to the level before, or to the top of the
//! hump that the pass before has climbed. From there it follows the figure at feed.
//!
//! Decisions where the documents are silent: a first element at rapid, or one straight down, is the approach through
//! the open; one that is cut and slants belongs to the contour, and then nothing is open. A level that only touches
//! a bottom is left to the contour pass, and cut where there is none. Humps above the start point are passed over in the air.
//!
//! Not here: figures without pockets by the rules of type I, nose radius compensation, the finishing pass.
//! Source: type II of rough turning and facing, chapter 4 of the cycles, and rows 8, 9, 29, 32 and 33 of its
//! chapter 13.

use std::collections::VecDeque;

use turnwright_canon::{Action, Phase, Shape};
use turnwright_units::{Displacement, Length, Position, WorkTip};

use crate::figure::{LeadIn, Piece, cut_sign, pocket_lead_in, profile, straighten};
use crate::heights::Heights;
use crate::plane::Plane;
use crate::roughing::{allowance_shift, check_words, level_zero};
use crate::{
    Coincident, Context, CutAlong, CycleMove, EscapeSpeed, Figure, Misuse, RoughRequest, Tolerance, Tool,
    pass_number,
};

/// The flat top between two pockets, when it lies between two levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hump {
    /// It is cut along with the climb out of the first pocket.
    AlongContour,
    /// The first pocket is finished, then one cut at its height goes on to the far wall.
    ExtraLevel,
}

/// How a cut that ends on a bottom parallel to it is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BottomEscape {
    /// Along the figure, as everywhere.
    Follow,
    /// At 45 degrees.
    Diagonal,
}

/// The words of rough turning and facing with pockets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PocketRequest {
    /// What both types have; how its monotony is checked does not count.
    pub rough: RoughRequest,
    /// Turning back along the cut by no more than this is forgiven.
    pub tolerance: Tolerance,
    /// Distance to the next place to be cut at which a straight infeed changes from rapid to feed. Zero or less:
    /// the whole infeed into a pocket is fed.
    pub clearance: Length,
    /// Flat humps.
    pub hump: Hump,
    /// Bottoms.
    pub bottom_escape: BottomEscape,
    /// Speed of the small way off the figure at the end of a pass.
    pub lift_speed: EscapeSpeed,
}

/// The moves of roughing with pockets.
#[derive(Clone, Debug)]
pub struct PocketRoughing {
    figure: Figure,
    request: PocketRequest,
    plane: Plane,
    shift: Displacement<WorkTip>,
    lead: LeadIn,
    pieces: Vec<Piece>,
    heights: Heights,
    /// A′ as (u, v).
    origin: (i64, i64),
    /// Depth of the place that levels are counted from, below A′.
    level_zero: i64,
    /// −1 or 1: direction of the cut along v.
    forward: i64,
    /// Stretches in work, each inside the one before.
    regions: Vec<Region>,
    pass: u64,
    /// Where the plan has brought the tool: depth below A′, and v of the figure where it stands.
    at: (i64, f64),
    /// Corner of the figure behind which the tool stands.
    corner: usize,
    tool: Tool,
    planned: VecDeque<CycleMove>,
    next: Next,
}

/// A stretch of the figure whose deeper levels are being cut.
#[derive(Clone, Copy, Debug)]
struct Region {
    level: i64,
    /// Corner from which the next stretch is looked for, and the last corner.
    from: usize,
    to: usize,
    /// How far passes of this level have gone along the figure.
    cut_to: Option<Spot>,
    /// A flat top, from corner to corner, to be cut when the pocket before it is finished.
    hump: Option<(usize, usize)>,
}

/// A stretch of the figure deeper than a level.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// Where the figure goes below the level; `None` when it is open to the start.
    begin: Option<Spot>,
    /// Where it comes above it again: past the last piece when it never does.
    end: Spot,
}

/// A place on the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spot {
    /// Index of the piece, or one more than the last for the end of the figure.
    piece: usize,
    depth: i64,
    v: f64,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Approach,
    Level,
    LastInfeed,
    Contour(usize),
    Home,
    Done,
}

/// Plans the roughing of a `figure` with pockets.
///
/// # Errors
/// [`Misuse::DepthNotPositive`], [`Misuse::BelowIncrement`], [`Misuse::EscapeNegative`], [`Misuse::NoContour`],
/// [`Misuse::NotMonotone`] when it turns back along the cut, [`Misuse::StartMismatch`], [`Misuse::OutOfRange`].
pub fn rough_pockets(figure: Figure, request: PocketRequest) -> Result<PocketRoughing, Misuse> {
    let rough = &request.rough;
    let plane = Plane::new(rough.along == CutAlong::Z, rough.context.increment);
    check_words(rough, &plane)?;
    crate::plane::in_range(&[request.clearance])?;
    let figure = figure.prepare(&rough.context)?;
    let lead = pocket_lead_in(&figure, &plane).ok_or(Misuse::NoContour)?;
    let mut pieces = profile(&figure, &plane, &lead);
    let forward = cut_sign(&pieces).ok_or(Misuse::NoContour)?;
    straighten(&mut pieces, forward, request.tolerance, rough.along).map_err(Misuse::NotMonotone)?;
    let first = pieces.first().ok_or(Misuse::NoContour)?.h0;
    let corners: Vec<i64> = std::iter::once(first).chain(pieces.iter().map(|piece| piece.h1)).collect();
    let heights = Heights::new(corners.into_iter());
    let shift = allowance_shift(rough);
    let origin = plane.split(figure.start + shift);
    let root = Region { level: 1, from: 0, to: heights.last(), cut_to: None, hump: None };
    Ok(PocketRoughing {
        level_zero: level_zero(rough, &plane, &lead, &figure, shift),
        at: (0, plane.split(figure.start).1 as f64),
        corner: 0,
        tool: Tool::new(rough.context.start),
        figure,
        request,
        plane,
        shift,
        lead,
        pieces,
        heights,
        origin,
        forward,
        regions: vec![root],
        pass: 0,
        planned: VecDeque::new(),
        next: Next::Approach,
    })
}

impl PocketRoughing {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        let number =
            |depth: i64| (depth - self.level_zero).max(0).unsigned_abs() / self.depth().unsigned_abs();
        // Every pass but the open ones, one a level above the begin of the figure, goes down through its level once.
        let open = number(self.heights.depth(0)) + 1;
        let crossings = self.pieces.iter().map(|piece| number(piece.h0).abs_diff(number(piece.h1)) + 1);
        let passes = crossings.fold(open, u64::saturating_add);
        passes.saturating_mul(20).saturating_add(self.figure.elements.len() as u64 + 8)
    }

    const fn depth(&self) -> i64 {
        self.request.rough.depth.nm()
    }

    const fn escape(&self) -> i64 {
        self.request.rough.escape.nm()
    }

    const fn context(&self) -> &Context {
        &self.request.rough.context
    }

    const fn level(&self, number: i64) -> i64 {
        self.level_zero.saturating_add(number.saturating_mul(self.depth()))
    }

    /// Half of the least increment along the depth axis: nearer than this is the same.
    const fn touch(&self) -> i64 {
        self.plane.grid_u() / 2
    }

    /// A corner no deeper than this ends a stretch deeper than `level`.
    const fn edge(&self, level: i64) -> i64 {
        match self.request.rough.coincident {
            Coincident::Through => level - self.touch() - 1,
            Coincident::Stop => level + self.touch(),
        }
    }

    /// A corner of a pocket deeper than this is worth a pass at `level`. Where no pass along the figure follows, a bottom
    /// that the level touches is cut too: nothing else would.
    const fn bottom(&self, level: i64) -> i64 {
        if self.request.rough.semi_finish { level + self.touch() } else { self.edge(level) }
    }

    /// Plans until there is a move, or nothing more to plan.
    fn plan(&mut self) {
        while self.planned.is_empty() {
            match self.next {
                Next::Approach => {
                    self.next = Next::Level;
                    let to = self.plane.place(self.origin.0, self.origin.1);
                    self.push(self.context().rapid(to), Phase::Approach, None);
                }
                Next::Level => self.plan_level(),
                Next::LastInfeed => self.plan_last_infeed(),
                Next::Contour(index) => self.plan_contour(index),
                Next::Home => {
                    self.next = Next::Done;
                    self.push(self.context().rapid(self.context().start), Phase::Home, None);
                }
                Next::Done => return,
            }
        }
    }

    /// The next stretch of the innermost region, or what follows when all are cut.
    fn plan_level(&mut self) {
        let Some(&region) = self.regions.last() else {
            return self.plan_way_back();
        };
        if let Some(top) = region.hump {
            return self.cut_hump(region, top);
        }
        let Some(stretch) = self.stretch(&region) else {
            self.regions.pop();
            return;
        };
        self.pass += 1;
        let (cut_to, hump) = self.cut_stretch(&region, &stretch);
        if let Some(region) = self.regions.last_mut() {
            (region.cut_to, region.hump) = (Some(cut_to), hump);
            region.from = stretch.end.piece + 1;
        }
        let from = stretch.begin.map_or(0, |spot| spot.piece);
        let to = stretch.end.piece.min(region.to);
        self.regions.push(Region { level: region.level + 1, from, to, cut_to: None, hump: None });
    }

    /// The next stretch of `region` that is deeper than its level somewhere.
    fn stretch(&self, region: &Region) -> Option<Stretch> {
        let level = self.level(region.level);
        let mut deep = self.heights.next_deeper(region.from, self.bottom(level))?;
        if self.heights.last_up_to(deep, self.edge(level)).is_none() {
            // Open to the start it is no pocket: the rule of figures without pockets holds.
            deep = self.heights.next_deeper(region.from, level + self.touch())?;
        }
        if deep > region.to {
            return None;
        }
        let begin = self.heights.last_up_to(deep, self.edge(level)).map(|corner| {
            let piece = &self.pieces[corner];
            let v = if piece.h0 > level {
                piece.v0 as f64
            } else if piece.h1 >= level {
                piece.crossing(level)
            } else {
                piece.v1 as f64
            };
            Spot { piece: corner, depth: level, v }
        });
        Some(Stretch { begin, end: self.end_of_cut(deep, level) })
    }

    /// Where a cut at `level` from corner `from` on ends: where the figure comes above it.
    fn end_of_cut(&self, from: usize, level: i64) -> Spot {
        match self.heights.next_up_to(from, self.edge(level)) {
            Some(corner) => {
                let piece = &self.pieces[corner - 1];
                let v = if piece.h0 <= level {
                    piece.v0 as f64
                } else if piece.h1 <= level {
                    piece.crossing(level)
                } else {
                    piece.v1 as f64
                };
                Spot { piece: corner - 1, depth: level, v }
            }
            None => Spot { depth: level, ..self.spot_at(self.heights.last()) },
        }
    }

    /// One pass. Gives how far along the figure it went, and the flat top that it left for later.
    fn cut_stretch(&mut self, region: &Region, stretch: &Stretch) -> (Spot, Option<(usize, usize)>) {
        let (level, above) = (self.level(region.level), self.level(region.level - 1));
        match stretch.begin {
            None => {
                if self.at.1 != self.start_v() {
                    self.go_along(above, self.start_v(), 0, Phase::Return);
                }
                self.infeed(level);
            }
            Some(begin) => self.go_down(region, begin, above),
        }
        let end = match stretch.begin {
            None if self.is_behind_start(stretch.end.v) => Spot { v: self.start_v(), ..stretch.end },
            _ => stretch.end,
        };
        self.feed_to(end.depth, end.v, Phase::Cut, self.element(end.piece));
        self.corner = end.piece;
        let room = stretch.begin.map_or(f64::INFINITY, |begin| (end.v - begin.v).abs());
        if self.request.bottom_escape == BottomEscape::Diagonal
            && self.is_at_bottom(end)
            && room >= self.escape() as f64
        {
            self.escape_diagonally(end);
            return (end, None);
        }
        let (top, hump) = self.climb(end, above);
        self.lift_off(above);
        (top, hump)
    }

    /// Into a pocket: over its near wall, straight in to what is cut already, and down along the figure.
    fn go_down(&mut self, region: &Region, begin: Spot, above: i64) {
        let from = self.near_wall(begin.piece, above, region.cut_to);
        let is_open = from.piece == 0 && from.depth > above && self.lead.elements > 0;
        if is_open && region.cut_to.is_none() {
            // The figure begins below the level before: down beside it, where there is nothing to cut.
            if self.at.1 != self.start_v() {
                self.go_along(above, self.start_v(), 0, Phase::Return);
            }
            self.infeed(from.depth);
            self.feed_to(from.depth, from.v, Phase::Infeed, None);
        } else if self.at != (from.depth, from.v) {
            self.go_along(above, from.v, from.piece, Phase::Return);
            let near = from.depth - self.request.clearance.nm();
            if self.request.clearance.nm() > 0 && self.at.0 < near {
                self.rapid_to(near, from.v, Phase::Return);
            }
            self.feed_to(from.depth, from.v, Phase::Infeed, None);
        }
        self.follow(from, begin);
    }

    /// Where the way down along the figure to a stretch that begins on `piece` starts: at the level before, or where
    /// something was cut already, or at the begin of the figure.
    fn near_wall(&self, piece: usize, above: i64, cut_to: Option<Spot>) -> Spot {
        let mut at = piece;
        loop {
            if let Some(cut) = cut_to.filter(|cut| cut.piece >= at) {
                return cut;
            }
            let wall = &self.pieces[at];
            if wall.h0 <= above {
                return Spot { piece: at, depth: above, v: wall.crossing(above) };
            }
            if at == 0 {
                return self.spot_at(0);
            }
            at -= 1;
        }
    }

    /// Feeds along the figure from one place to a later one.
    fn follow(&mut self, from: Spot, to: Spot) {
        for piece in from.piece..to.piece {
            self.along_piece(piece, self.spot_at(piece + 1), Phase::Infeed);
        }
        self.along_piece(to.piece, to, Phase::Infeed);
    }

    /// Up the far wall from `end` to depth `above`, or to the local summit when that lies lower. Gives where it
    /// arrived, and a flat top that was left for later.
    fn climb(&mut self, end: Spot, above: i64) -> (Spot, Option<(usize, usize)>) {
        let last = self.pieces.len();
        let mut piece = end.piece;
        if piece == last {
            return (end, None);
        }
        loop {
            let wall = &self.pieces[piece];
            if wall.h1 <= above {
                let top = Spot { piece, depth: above, v: wall.crossing(above) };
                self.along_piece(piece, top, Phase::Escape);
                return (top, None);
            }
            let near = self.spot_at(piece + 1);
            self.along_piece(piece, near, Phase::Escape);
            let is_flat = |piece: &Piece| piece.h0 == piece.h1;
            let far = (near.piece..last).find(|&at| !is_flat(&self.pieces[at])).unwrap_or(last);
            let descends = far < last && self.pieces[far].h1 > self.pieces[far].h0;
            if far == last || (descends && far == near.piece) {
                return (near, None);
            }
            if descends && self.request.hump == Hump::ExtraLevel {
                return (near, Some((near.piece, far)));
            }
            for flat in near.piece..far {
                self.along_piece(flat, self.spot_at(flat + 1), Phase::Escape);
            }
            if descends {
                return (self.spot_at(far), None);
            }
            piece = far;
        }
    }

    /// The flat top behind a finished pocket: across it and on to the next wall.
    fn cut_hump(&mut self, region: Region, (near, far): (usize, usize)) {
        self.pass += 1;
        let above = self.level(region.level - 1);
        let (from, to) = (self.spot_at(near), self.spot_at(far));
        if self.at.0 > from.depth {
            self.rapid_to(from.depth, self.at.1, Phase::Return);
        }
        self.rapid_to(self.at.0, from.v, Phase::Return);
        self.feed_to(from.depth, from.v, Phase::Infeed, None);
        let end = self.end_of_cut(far, from.depth);
        self.feed_to(end.depth, end.v, Phase::Cut, self.element(end.piece));
        self.corner = end.piece;
        self.climb(end, above);
        self.lift_off(above);
        if let Some(region) = self.regions.last_mut() {
            (region.cut_to, region.hump) = (Some(to), None);
        }
    }

    /// Whether a cut has come along, or meets, a stretch of the figure at its own depth.
    fn is_at_bottom(&self, end: Spot) -> bool {
        let is_bottom = |piece: &Piece| {
            piece.h0 == piece.h1 && (piece.h0 - end.depth).abs() <= self.touch() && piece.v0 != piece.v1
        };
        let before = end.piece.checked_sub(1).and_then(|piece| self.pieces.get(piece));
        let behind = self.pieces.get(end.piece + 1);
        match self.request.rough.coincident {
            Coincident::Through => before.is_some_and(is_bottom),
            Coincident::Stop => behind.is_some_and(is_bottom),
        }
    }

    fn escape_diagonally(&mut self, end: Spot) {
        let v = end.v - (self.forward * self.escape()) as f64;
        let depth = end.depth - self.escape();
        match self.request.rough.escape_speed {
            EscapeSpeed::Feed => self.feed_to(depth, v, Phase::Escape, None),
            EscapeSpeed::Rapid => self.rapid_to(depth, v, Phase::Escape),
        }
    }

    /// Off the figure, to the escape above the level before.
    fn lift_off(&mut self, above: i64) {
        let depth = above - self.escape();
        match self.request.lift_speed {
            EscapeSpeed::Feed => self.feed_to(depth, self.at.1, Phase::Escape, None),
            EscapeSpeed::Rapid => self.rapid_to(depth, self.at.1, Phase::Escape),
        }
    }

    /// At rapid to `v`, near corner `corner`, at least the escape above depth `above` and above all humps.
    fn go_along(&mut self, above: i64, v: f64, corner: usize, phase: Phase) {
        let (first, last) = (self.corner.min(corner) + 1, self.corner.max(corner));
        let hump = if first <= last { self.heights.least_between(first, last) } else { above };
        let height = above.min(hump) - self.escape();
        if self.at.0 > height {
            self.rapid_to(height, self.at.1, phase);
        }
        self.rapid_to(self.at.0, v, phase);
        self.corner = corner;
    }

    /// All levels are cut: back to A′.
    fn plan_way_back(&mut self) {
        if self.pass > 0 || self.request.rough.semi_finish {
            self.pass += u64::from(self.request.rough.semi_finish);
            let hump = self.heights.least_between(0, self.corner);
            let height = if hump < 0 { hump - self.escape() } else { 0 };
            if self.at.0 > height {
                self.rapid_to(height, self.at.1, Phase::Return);
            }
            self.rapid_to(self.at.0.min(height), self.start_v(), Phase::Return);
            self.rapid_to(0, self.start_v(), Phase::Return);
        }
        self.next = if self.request.rough.semi_finish { Next::LastInfeed } else { Next::Home };
    }

    fn plan_last_infeed(&mut self) {
        self.next = Next::Contour(self.lead.elements);
        if let Some(last) = self.lead.elements.checked_sub(1) {
            let action = self.down(self.figure.end(last, self.shift));
            self.push(action, Phase::Infeed, Some(pass_number(last as u64)));
        }
    }

    fn plan_contour(&mut self, index: usize) {
        let last = index + 1 >= self.figure.elements.len();
        self.next = if last { Next::Home } else { Next::Contour(index + 1) };
        let action = self.figure.cut(index, self.shift, self.context());
        self.push(action, Phase::Contour, Some(pass_number(index as u64)));
    }

    /// v of A, as the figure has it.
    fn start_v(&self) -> f64 {
        self.plane.split(self.figure.start).1 as f64
    }

    fn is_behind_start(&self, v: f64) -> bool {
        (v - self.start_v()) * (self.forward as f64) < 0.0
    }

    fn spot_at(&self, corner: usize) -> Spot {
        let v = match self.pieces.get(corner) {
            Some(piece) => piece.v0,
            None => self.pieces.last().map_or(0, |last| last.v1),
        };
        Spot { piece: corner, depth: self.heights.depth(corner), v: v as f64 }
    }

    fn element(&self, piece: usize) -> Option<u32> {
        self.pieces.get(piece).map(|piece| piece.element)
    }

    fn place(&self, depth: i64, v: f64) -> Position<WorkTip> {
        let u = self.origin.0.saturating_add(self.lead.depth_sign * depth);
        self.plane.place_computed(u, v + self.plane.split_lengths(self.shift.x, self.shift.z).1 as f64)
    }

    fn rapid_to(&mut self, depth: i64, v: f64, phase: Phase) {
        self.at = (depth, v);
        let to = self.place(depth, v);
        self.push(self.context().rapid(to), phase, None);
    }

    fn feed_to(&mut self, depth: i64, v: f64, phase: Phase, element: Option<u32>) {
        self.at = (depth, v);
        let to = self.place(depth, v);
        self.push(self.context().line(to), phase, element);
    }

    /// Beside the figure down to a depth, the way its approach goes down.
    fn infeed(&mut self, depth: i64) {
        self.at = (depth, self.start_v());
        let to = self.place(depth, self.start_v());
        self.push(self.down(to), Phase::Infeed, None);
    }

    fn down(&self, to: Position<WorkTip>) -> Action {
        if self.lead.rapid { self.context().rapid(to) } else { self.context().line(to) }
    }

    /// Feeds along a piece of the figure to a place on it.
    fn along_piece(&mut self, piece: usize, to: Spot, phase: Phase) {
        let from = self.tool.at;
        self.at = (to.depth, to.v);
        self.corner = piece;
        let end = self.place(to.depth, to.v);
        let Some(element) = self.element(piece) else { return };
        let whole = &self.figure.cut(element as usize, self.shift, self.context());
        let shape = match whole {
            Action::Feed { shape, .. } => part_of_arc(shape, from, end, self.context().increment.to_mm()),
            _ => Shape::Line,
        };
        let action = Action::Feed { to: end, shape, feed: self.context().feed, others: None };
        self.push(action, phase, Some(element));
    }

    fn push(&mut self, action: Action, phase: Phase, element: Option<u32>) {
        let step = CycleMove { action, phase, pass: pass_number(self.pass), element };
        if self.tool.goes(&step) {
            self.planned.push_back(step);
        }
    }
}

/// The arc between two rounded places on it: the same radius, the centre moved so that both lie on the circle.
/// A line where the arc leaves it by less than a tenth of the increment.
fn part_of_arc(whole: &Shape, from: Position<WorkTip>, to: Position<WorkTip>, increment_mm: f64) -> Shape {
    let Shape::Arc { turn, centre } = whole else { return Shape::Line };
    let from_start = |place: Position<WorkTip>| {
        let way = place - from;
        (way.x.0.to_mm(), way.z.to_mm())
    };
    let ((centre_x, centre_z), (x, z)) = (from_start(*centre), from_start(to));
    let radius = (centre_x.hypot(centre_z) + (centre_x - x).hypot(centre_z - z)) / 2.0;
    let half_chord = x.hypot(z) / 2.0;
    let reach = ((radius - half_chord) * (radius + half_chord)).max(0.0).sqrt();
    if radius - reach < increment_mm / 10.0 {
        return Shape::Line;
    }
    // The centre lies on the bisector of the chord, on the side where it was.
    let side = if x * centre_z - z * centre_x < 0.0 { -1.0 } else { 1.0 };
    let across = side * reach / (2.0 * half_chord);
    let nm = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
    let centre = from
        + Displacement::new(turnwright_units::Radius(nm(x / 2.0 - z * across)), nm(z / 2.0 + x * across));
    Shape::Arc { turn: *turn, centre }
}

impl Iterator for PocketRoughing {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        self.plan();
        self.planned.pop_front()
    }
}
