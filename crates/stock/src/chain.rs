//! Edges end to end along Z: one side of a stencil.

use crate::WELD_MM;
use crate::curve::{Curve, greater, lesser};

/// Edges that follow each other along Z without a gap; they need not meet in X.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chain {
    /// Where the first edge begins.
    pub(crate) from: f64,
    pub(crate) links: Vec<Link>,
}

/// An edge from the end of the one before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    /// Where it ends.
    pub(crate) to: f64,
    pub(crate) edge: Curve,
}

/// The side of a tool that is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Towards the axis.
    Lower,
    /// Away from it.
    Upper,
}

impl Side {
    /// 1 where leans grow along Z on a bulging edge, −1 where they fall.
    pub(crate) const fn turn(self) -> f64 {
        match self {
            Self::Lower => 1.0,
            Self::Upper => -1.0,
        }
    }
}

impl Chain {
    /// Begins again, keeping the memory.
    pub(crate) fn restart(&mut self, from: f64) {
        self.from = from;
        self.links.clear();
    }

    /// Where the last edge ends.
    pub(crate) fn to(&self) -> f64 {
        self.links.last().map_or(self.from, |link| link.to)
    }

    /// Adds an edge up to a Z. What would be shorter than the weld is left out; the next one takes its place.
    pub(crate) fn push(&mut self, to: f64, edge: Curve) {
        if to - self.to() > WELD_MM {
            self.links.push(Link { to, edge });
        }
    }

    /// As [`Chain::push`], going on with the last edge where the new one is the same.
    pub(crate) fn go_on(&mut self, to: f64, edge: Curve) {
        let from = self.to();
        match self.links.last_mut() {
            Some(last) if last.edge.is_one_with(&edge, from, to) => last.to = to,
            _ => self.push(to, edge),
        }
    }

    /// The edges with where each begins and ends.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (f64, f64, Curve)> + '_ {
        let starts = [self.from].into_iter().chain(self.links.iter().map(|link| link.to));
        starts.zip(&self.links).map(|(from, link)| (from, link.to, link.edge))
    }

    /// Lowest and highest X between two Z.
    pub(crate) fn range(&self, from: f64, to: f64) -> (f64, f64) {
        self.walk().range(from, to)
    }

    /// A walk from its start.
    pub(crate) fn walk(&self) -> Walk<'_> {
        Walk { from: self.from, links: &self.links }
    }

    /// The same on the other side of the axis, written over another chain.
    pub(crate) fn mirror_into(&self, other: &mut Self) {
        other.restart(self.from);
        other.links.extend(self.links.iter().map(|link| Link { to: link.to, edge: link.edge.mirrored() }));
    }
}

/// The edges of a chain that are still to come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walk<'a> {
    /// Where the first of them begins.
    from: f64,
    links: &'a [Link],
}

impl<'a> Walk<'a> {
    /// Goes on to the first edge that does not end at a Z or before it, or else to the last, and gives it.
    #[inline]
    pub(crate) fn at(&mut self, z: f64) -> Option<&'a Link> {
        while let [first, rest @ ..] = self.links
            && !rest.is_empty()
            && first.to <= z + WELD_MM
        {
            *self = Self { from: first.to, links: rest };
        }
        self.links.first()
    }

    /// Whether no edge lies lower than this X between two Z.
    #[inline]
    pub(crate) fn clears(&self, level: f64, from: f64, to: f64) -> bool {
        let mut start = self.from;
        for link in self.links {
            let (a, b) = (greater(from, start), lesser(to, link.to));
            if a < b && !link.edge.clears(level, a, b) {
                return false;
            }
            if link.to >= to {
                break;
            }
            start = link.to;
        }
        true
    }

    /// Lowest and highest X between two Z.
    #[inline]
    pub(crate) fn range(&self, from: f64, to: f64) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut start = self.from;
        for link in self.links {
            let (a, b) = (greater(from, start), lesser(to, link.to));
            if a < b {
                let (l, h) = link.edge.range(a, b);
                low = lesser(low, l);
                high = greater(high, h);
            }
            if link.to >= to {
                break;
            }
            start = link.to;
        }
        (low, high)
    }
}
