//! What a tool passes over on its way: the shape that is taken away.
//!
//! A sweep is one [`Stencil`] for each convex part of the tool and each quarter of an arc. A stencil is all between
//! a lower and an upper chain of edges; both are exact, lines and arcs again ([`crate::slide`], [`crate::swing`]).
//! A sweep is made to be used again: `line` and `arc` write over the last one in the memory that is there.

use turnwright_geometry::{Bend, Bounds, Point, Segment};

use crate::WELD_MM;
use crate::band::Band;
use crate::chain::{Chain, Side};
use crate::curve::Curve;
use crate::cutter::{Convex, Cutter};
use crate::decompose::half_circles;
use crate::slide::slide;
use crate::swing::Swing;

/// What a tool passes over on its way.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    stencils: Vec<Stencil>,
    /// How many of them belong to this sweep; the others keep their memory for the next.
    used: usize,
    swing: Swing,
}

/// All between two chains over the same Z.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stencil {
    pub(crate) lower: Chain,
    pub(crate) upper: Chain,
    /// The lowest X of the lower chain.
    pub(crate) lower_least: f64,
    /// The lowest X of the upper chain, or less.
    pub(crate) upper_least: f64,
}

impl Sweep {
    /// An empty sweep; it passes over nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// A tool at rest.
    pub fn rest(&mut self, cutter: &Cutter, at: Point) -> &mut Self {
        self.line(cutter, at, at)
    }

    /// A tool whose programmed point moves along a line.
    pub fn line(&mut self, cutter: &Cutter, from: Point, to: Point) -> &mut Self {
        self.used = 0;
        if !is_sound(from) || !is_sound(to) {
            return self;
        }
        let (left, right) = if from.z <= to.z { (from, to) } else { (to, from) };
        for part in &cutter.parts {
            let stencil = self.add();
            stencil.slide(part, left, right);
        }
        self
    }

    /// A tool whose programmed point moves along an arc; start and end the same make a full circle.
    ///
    /// Where start and end lie at different distances from the centre, the circle with the nearest centre through
    /// both is taken.
    pub fn arc(&mut self, cutter: &Cutter, from: Point, to: Point, bend: Bend) -> &mut Self {
        self.used = 0;
        if !is_sound(from) || !is_sound(to) || !is_sound(bend.centre) {
            return self;
        }
        if from.distance(to) > WELD_MM && from.distance(bend.centre).min(to.distance(bend.centre)) <= WELD_MM
        {
            return self.line(cutter, from, to);
        }
        let bend = bend.evened(from, to);
        half_circles(from, to, bend, |start, end, path| {
            for part in &cutter.parts {
                let (mut swing, stencil) = (std::mem::take(&mut self.swing), self.add());
                stencil.swing(part, &path, start.min(end), start.max(end), &mut swing);
                self.swing = swing;
            }
        });
        self
    }

    /// A tool along a line or an arc.
    pub fn along(&mut self, cutter: &Cutter, way: &Segment) -> &mut Self {
        match way.bend {
            None => self.line(cutter, way.start, way.end),
            Some(bend) => self.arc(cutter, way.start, way.end, bend),
        }
    }

    /// The next stencil, with what an earlier sweep left in it.
    fn add(&mut self) -> &mut Stencil {
        if self.used == self.stencils.len() {
            self.stencils.push(Stencil::default());
        }
        self.used += 1;
        &mut self.stencils[self.used - 1]
    }

    pub(crate) fn stencils(&self) -> &[Stencil] {
        &self.stencils[..self.used]
    }

    /// The upright rectangle round all that is passed over; nothing when nothing is.
    pub fn bounds(&self) -> Option<Bounds> {
        let corners = self.stencils().iter().flat_map(|stencil| {
            let (from, to) = (stencil.lower.from, stencil.lower.to());
            let (low, high) = (stencil.lower.range(from, to).0, stencil.upper.range(from, to).1);
            [Point::new(low, from), Point::new(high, to)]
        });
        corners.fold(None, |bounds, corner| {
            Some(bounds.map_or(Bounds { min: corner, max: corner }, |bounds: Bounds| bounds.with(corner)))
        })
    }
}

impl Stencil {
    fn slide(&mut self, part: &Convex, left: Point, right: Point) {
        for (side, chain) in [(Side::Lower, &mut self.lower), (Side::Upper, &mut self.upper)] {
            slide(chain, part, side, left, right);
        }
        self.place(part, if left.x < right.x { left.x } else { right.x });
    }

    fn swing(&mut self, part: &Convex, path: &Curve, from: f64, to: f64, swing: &mut Swing) {
        for (side, chain) in [(Side::Lower, &mut self.lower), (Side::Upper, &mut self.upper)] {
            swing.write(chain, part, side, path, from, to);
        }
        self.place(part, path.range(from, to).0);
    }

    /// The shape of a band.
    pub(crate) fn set(&mut self, band: &Band, from: f64, to: f64) {
        for (chain, edge) in [(&mut self.lower, band.floor), (&mut self.upper, band.roof)] {
            chain.restart(from);
            chain.push(to, edge);
        }
        self.measure();
    }

    /// The same on the other side of the axis.
    pub(crate) fn mirror_into(&self, other: &mut Self) {
        self.lower.mirror_into(&mut other.upper);
        self.upper.mirror_into(&mut other.lower);
        other.measure();
    }

    fn measure(&mut self) {
        let least = |chain: &Chain| chain.range(chain.from, chain.to()).0;
        (self.lower_least, self.upper_least) = (least(&self.lower), least(&self.upper));
    }

    /// A part whose way has its lowest X here.
    fn place(&mut self, part: &Convex, x: f64) {
        self.lower_least = x + part.lower_least;
        self.upper_least = x + part.upper_least;
    }
}

/// A place that a lathe can reach: places that are not numbers pass over nothing.
fn is_sound(place: Point) -> bool {
    use turnwright_geometry::OUTLINE_MM_MAX as MAX;
    place.x.abs() <= MAX && place.z.abs() <= MAX
}
