//! Slabs in a row along Z, in chunks, so that a cut costs what it changes and not what the whole section holds.
//!
//! Invariants: slabs are in order, do not overlap, are wider than the weld and hold at least one band; the bands of a
//! slab are in order from the axis outwards and do not overlap; no chunk is empty. Two slabs that touch share the
//! very same number. Where nothing is, no slab is.

use std::ops::Range;

use crate::WELD_MM;
use crate::band::Band;
use crate::curve::{Curve, greater, lesser};
use crate::knife::Knife;
use crate::pieces::{hangs_together, is_strand};
use crate::removed::Removed;

/// A chunk with more slabs is parted. Below a few dozen, moving slabs about costs no more than looking at them.
const CHUNK_SLABS_MAX: usize = 48;

/// A slab narrower than this, mm, with more bands is a comb: what a round nose leaves of an upright face that thousands
/// of passes end at. Nobody sees its teeth, and every later cut would look at each of them.
const COMB_MM: f64 = 1e-4;
const COMB_BANDS_MAX: usize = 24;

/// Gaps of a comb up to this are filled.
const COMB_GAP_MM: f64 = 0.1;

/// Between two Z: a stack of bands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slab {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Lowest X of its bands.
    pub(crate) low: f64,
    /// Highest X of its bands.
    pub(crate) high: f64,
    /// Where its bands end in the list of the chunk; they begin where those of the slab before end.
    end: u32,
}

/// A run of slabs with their bands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Run {
    slabs: Vec<Slab>,
    bands: Vec<Band>,
}

/// A run that is not empty, and the rectangle round it.
#[derive(Clone, Debug)]
struct Chunk {
    from: f64,
    to: f64,
    low: f64,
    high: f64,
    run: Run,
    /// The first slab that the last cut looked at.
    recent: usize,
}

/// Whether a change reached the first and the last slab of a chunk.
#[derive(Clone, Copy, Debug, Default)]
struct Touched {
    start: bool,
    end: bool,
}

/// All slabs of a section.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    chunks: Vec<Chunk>,
    /// The first chunk that the last cut looked at.
    recent: usize,
    /// Runs that were emptied, with their memory.
    spare: Vec<Run>,
}

impl Run {
    pub(crate) fn clear(&mut self) {
        self.slabs.clear();
        self.bands.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.slabs.len()
    }

    /// How many edges it holds.
    pub(crate) fn edges(&self) -> usize {
        2 * self.bands.len()
    }

    /// Where the first slab begins and the last ends.
    fn ends(&self) -> Option<(f64, f64)> {
        Some((self.slabs.first()?.from, self.slabs.last()?.to))
    }

    fn first_band(&self, slab: usize) -> usize {
        if slab == 0 { 0 } else { self.slabs[slab - 1].end as usize }
    }

    pub(crate) fn slab(&self, index: usize) -> (&Slab, &[Band]) {
        let slab = &self.slabs[index];
        (slab, &self.bands[self.first_band(index)..slab.end as usize])
    }

    pub(crate) fn slabs(&self) -> impl Iterator<Item = (&Slab, &[Band])> {
        (0..self.len()).map(|index| self.slab(index))
    }

    /// Adds a band to the slab that [`Run::end_slab`] will close.
    #[inline]
    pub(crate) fn push_band(&mut self, band: Band) {
        self.bands.push(band);
    }

    /// Closes a slab with the bands pushed since the last; without any there is no slab.
    #[inline]
    pub(crate) fn end_slab(&mut self, from: f64, to: f64) {
        if to - from < COMB_MM {
            self.fill_comb(from, to);
        }
        let bands = &self.bands[self.first_band(self.len())..];
        let (Some(lowest), Some(highest)) = (bands.first(), bands.last()) else { return };
        let (low, high) = (lowest.floor.lowest(from, to), highest.roof.highest(from, to));
        self.push_slab(Slab { from, to, low, high, end: 0 });
    }

    /// Makes the teeth of a comb one band. The slab is far too narrow for that to matter to any size.
    fn fill_comb(&mut self, from: f64, to: f64) {
        let first = self.first_band(self.len());
        if self.bands.len() - first <= COMB_BANDS_MAX {
            return;
        }
        let mut kept = first;
        for index in first + 1..self.bands.len() {
            let band = self.bands[index];
            if band.floor.lowest(from, to) - self.bands[kept].roof.highest(from, to) <= COMB_GAP_MM {
                self.bands[kept].roof = band.roof;
            } else {
                kept += 1;
                self.bands[kept] = band;
            }
        }
        self.bands.truncate(kept + 1);
    }

    /// Adds a slab of one band.
    pub(crate) fn push_slab_of(&mut self, floor: &Curve, roof: &Curve, from: f64, to: f64) {
        let (low, high) = (floor.lowest(from, to), roof.highest(from, to));
        let first = if let [.., before, _] = self.slabs.as_slice() { before.end } else { 0 };
        if let (Some(last), Some(before)) = (self.slabs.last_mut(), self.bands.last())
            && last.to == from
            && last.end == first + 1
            && before.roof.is_one_with(roof, from, to)
            && before.floor.is_one_with(floor, from, to)
        {
            last.to = to;
            last.low = lesser(last.low, low);
            last.high = greater(last.high, high);
            return;
        }
        self.bands.push(Band { floor: *floor, roof: *roof });
        self.slabs.push(Slab { from, to, low, high, end: self.bands.len() as u32 });
    }

    /// Adds a slab as it is.
    fn copy(&mut self, slab: &Slab, bands: &[Band]) {
        bands.iter().for_each(|band| self.bands.push(*band));
        self.push_slab(*slab);
    }

    /// A slab that goes on as the one before is put to it.
    #[inline]
    fn push_slab(&mut self, slab: Slab) {
        let end = self.bands.len() as u32;
        if let Some(last) = self.slabs.last()
            && last.to == slab.from
            && self.goes_on(slab.from, slab.to)
        {
            self.bands.truncate(last.end as usize);
            if let Some(last) = self.slabs.last_mut() {
                last.to = slab.to;
                last.low = lesser(last.low, slab.low);
                last.high = greater(last.high, slab.high);
            }
        } else {
            self.slabs.push(Slab { end, ..slab });
        }
    }

    /// Whether the bands pushed since the last slab are those of it.
    fn goes_on(&self, from: f64, to: f64) -> bool {
        let first = self.first_band(self.len());
        let (before, bands) = self.bands.split_at(first);
        let before = &before[self.first_band(self.len() - 1)..];
        before.len() == bands.len() && before.iter().zip(bands).all(|(a, b)| a.is_one_with(b, from, to))
    }

    fn truncate(&mut self, slabs: usize) {
        self.slabs.truncate(slabs);
        self.bands.truncate(self.first_band(slabs));
    }

    /// Puts another run in the place of some slabs.
    fn replace(&mut self, slabs: Range<usize>, with: &Self) {
        let bands = self.first_band(slabs.start)..self.first_band(slabs.end);
        let (start, behind) = (bands.start, slabs.start + with.len());
        let grown = with.bands.len() as i64 - bands.len() as i64;
        put(&mut self.bands, bands, &with.bands);
        put(&mut self.slabs, slabs.clone(), &with.slabs);
        self.slabs[slabs.start..behind].iter_mut().for_each(|slab| slab.end += start as u32);
        if grown != 0 {
            self.slabs[behind..].iter_mut().for_each(|slab| slab.end = (i64::from(slab.end) + grown) as u32);
        }
    }

    /// Moves the slabs from an index on to the end of another run.
    fn part(&mut self, from: usize, other: &mut Self) {
        let first = self.first_band(from);
        let shift = other.bands.len() as u32;
        other.bands.extend_from_slice(&self.bands[first..]);
        let moved = self.slabs[from..].iter();
        other.slabs.extend(moved.map(|slab| Slab { end: slab.end - first as u32 + shift, ..*slab }));
        self.truncate(from);
    }
}

/// Puts items in the place of others; quicker than `Vec::splice` for a few that are copied.
fn put<T: Copy>(list: &mut Vec<T>, range: Range<usize>, items: &[T]) {
    let (tail, length) = (list.len() - range.end, list.len() - range.len() + items.len());
    if let Some(&filler) = items.first()
        && length > list.len()
    {
        list.resize(length, filler);
    }
    if items.len() != range.len() {
        list.copy_within(range.end..range.end + tail, range.start + items.len());
    }
    list.truncate(length);
    list[range.start..range.start + items.len()].copy_from_slice(items);
}

/// Lowest and highest X of some slabs.
fn range(slabs: &[Slab]) -> (f64, f64) {
    slabs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), slab| {
        (lesser(low, slab.low), greater(high, slab.high))
    })
}

/// How many items, the first ones, come before a place; it is looked for where the last cut was, as the next one most
/// often is beside it.
fn count_before<T>(items: &[T], recent: usize, is_before: impl Fn(&T) -> bool) -> usize {
    const STEPS_MAX: usize = 4;
    let mut count = recent.min(items.len());
    for _ in 0..STEPS_MAX {
        if count > 0 && !is_before(&items[count - 1]) {
            count -= 1;
        } else if items.get(count).is_some_and(&is_before) {
            count += 1;
        } else {
            return count;
        }
    }
    items.partition_point(is_before)
}

impl Chunk {
    fn new(run: Run) -> Self {
        let mut chunk = Self { from: 0.0, to: 0.0, low: 0.0, high: 0.0, run, recent: 0 };
        chunk.measure();
        chunk
    }

    /// See [`Row::carve`]. Slabs beside changed ones are written anew too, so that what is now the same becomes one;
    /// those further off are not touched.
    fn carve(&mut self, knife: &mut Knife<'_>, left: &mut Run) -> Option<Touched> {
        let run = &self.run;
        let first = count_before(&run.slabs, self.recent, |slab| slab.to <= knife.from + WELD_MM);
        self.recent = first;
        let (mut written, mut is_changed) = (0..0, false);
        let mut end = run.first_band(first);
        for (index, slab) in run.slabs.iter().enumerate().skip(first) {
            if slab.from >= knife.to - WELD_MM {
                break;
            }
            let begin = std::mem::replace(&mut end, slab.end as usize);
            let Some(reach) = knife.reach(slab.from, slab.to, slab.low, slab.high) else { continue };
            let bands = &run.bands[begin..end];
            if !is_changed {
                left.clear();
                written = index.saturating_sub(1)..index.saturating_sub(1);
            }
            (written.end..index)
                .map(|index| run.slab(index))
                .for_each(|(slab, bands)| left.copy(slab, bands));
            // A slab of which nothing is taken is written as it was.
            is_changed |= knife.carve(slab, bands, reach, left);
            written.end = index + 1;
        }
        if !is_changed {
            return None;
        }
        let touched = Touched { start: written.start == 0, end: written.end == run.len() };
        if !touched.end {
            let (slab, bands) = run.slab(written.end);
            left.copy(slab, bands);
            written.end += 1;
        }
        let (old, new) = (range(&run.slabs[written.clone()]), range(&left.slabs));
        self.run.replace(written, left);
        if old.0 <= self.low && new.0 > self.low || old.1 >= self.high && new.1 < self.high {
            (self.low, self.high) = range(&self.run.slabs);
        }
        self.find_ends();
        Some(touched)
    }

    fn measure(&mut self) {
        (self.low, self.high) = range(&self.run.slabs);
        self.find_ends();
    }

    fn find_ends(&mut self) {
        if let Some((from, to)) = self.run.ends() {
            (self.from, self.to) = (from, to);
        }
    }
}

impl Row {
    /// The slabs with their bands, along Z.
    pub(crate) fn slabs(&self) -> impl Iterator<Item = (&Slab, &[Band])> {
        self.chunks.iter().flat_map(|chunk| chunk.run.slabs())
    }

    /// Those that reach between two Z, or touch them.
    pub(crate) fn slabs_between(&self, from: f64, to: f64) -> impl Iterator<Item = (&Slab, &[Band])> {
        let first = self.chunks.partition_point(|chunk| chunk.to < from);
        let chunks = self.chunks[first..].iter().take_while(move |chunk| chunk.from <= to);
        chunks
            .flat_map(move |chunk| {
                let first = chunk.run.slabs.partition_point(|slab| slab.to < from);
                (first..chunk.run.len()).map(|index| chunk.run.slab(index))
            })
            .take_while(move |(slab, _)| slab.from <= to)
    }

    /// Where the first slab begins and the last ends.
    pub(crate) fn ends(&self) -> Option<(f64, f64)> {
        Some((self.chunks.first()?.from, self.chunks.last()?.to))
    }

    /// How many slabs there are.
    pub(crate) fn len(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.run.len()).sum()
    }

    /// Adds a run behind all others; it begins no earlier than they end.
    pub(crate) fn append(&mut self, run: &mut Run) {
        let mut part = Run::default();
        for (slab, bands) in run.slabs() {
            part.copy(slab, bands);
            if part.len() == CHUNK_SLABS_MAX / 2 {
                self.chunks.push(Chunk::new(std::mem::take(&mut part)));
            }
        }
        if part.len() > 0 {
            self.chunks.push(Chunk::new(part));
        }
        run.clear();
    }

    /// What a knife would take, without taking it; `left` is memory for what would be left.
    pub(crate) fn probe(&self, knife: &mut Knife<'_>, left: &mut Run) -> Removed {
        let (from, to) = (knife.from, knife.to);
        let first = self.chunks.partition_point(|chunk| chunk.to <= from + WELD_MM);
        let reached = self.chunks[first..].iter().take_while(|chunk| chunk.from < to - WELD_MM);
        for chunk in reached {
            if knife.reach(chunk.from, chunk.to, chunk.low, chunk.high).is_none() {
                continue;
            }
            for (slab, bands) in chunk.run.slabs() {
                if let Some(reach) = knife.reach(slab.from, slab.to, slab.low, slab.high) {
                    left.clear();
                    knife.carve(slab, bands, reach, left);
                }
            }
        }
        knife.taken.removed()
    }

    /// Puts in the place of each slab what a knife leaves of it; `left` is memory for that. Where what is left is not
    /// seen to hang together, the knife is told.
    pub(crate) fn carve(&mut self, knife: &mut Knife<'_>, left: &mut Run) {
        let (from, to) = (knife.from, knife.to);
        let mut index = count_before(&self.chunks, self.recent, |chunk| chunk.to <= from + WELD_MM);
        self.recent = index;
        let mut emptied: Option<usize> = None;
        while let Some(chunk) = self.chunks.get_mut(index).filter(|chunk| chunk.from < to - WELD_MM) {
            if knife.reach(chunk.from, chunk.to, chunk.low, chunk.high).is_some()
                && let Some(touched) = chunk.carve(knife, left)
            {
                let is_empty = chunk.run.len() == 0;
                self.look_round(index, touched, left, knife);
                if is_empty {
                    emptied.get_or_insert(index);
                } else if self.chunks[index].run.len() > CHUNK_SLABS_MAX {
                    self.part(index);
                    index += 1;
                }
            }
            index += 1;
        }
        if let Some(first) = emptied {
            self.drop_empty(first..index);
        }
    }

    /// Sees whether what was written to a chunk hangs together with what lies beside it in the chunks on both sides.
    fn look_round(&self, index: usize, touched: Touched, left: &Run, knife: &mut Knife<'_>) {
        let runs = |range: Range<usize>| {
            self.chunks[range].iter().map(|chunk| &chunk.run).filter(|run| run.len() > 0)
        };
        let before = runs(0..index).next_back().filter(|_| touched.start).map(|run| run.slab(run.len() - 1));
        let behind = runs(index + 1..self.chunks.len()).next().filter(|_| touched.end).map(|run| run.slab(0));
        if before.is_none() && behind.is_none() && is_strand(&left.slabs, &left.bands) {
            return;
        }
        if !hangs_together(before.into_iter().chain(left.slabs()).chain(behind)) {
            let chunk = &self.chunks[index];
            let (from, to) = left.ends().unwrap_or((chunk.from, chunk.to));
            knife.doubt((before.map_or(from, |(slab, _)| slab.to), behind.map_or(to, |(slab, _)| slab.from)));
        }
    }

    /// Drops the empty chunks of a range, but keeps their memory.
    fn drop_empty(&mut self, range: Range<usize>) {
        let mut kept = range.start;
        for index in range.clone() {
            if self.chunks[index].run.len() > 0 {
                self.chunks.swap(kept, index);
                kept += 1;
            }
        }
        self.spare.extend(self.chunks.drain(kept..range.end).map(|chunk| chunk.run));
    }

    fn part(&mut self, index: usize) {
        let mut second = self.spare.pop().unwrap_or_default();
        let chunk = &mut self.chunks[index];
        chunk.run.part(chunk.run.len() / 2, &mut second);
        chunk.measure();
        self.chunks.insert(index + 1, Chunk::new(second));
    }
}
