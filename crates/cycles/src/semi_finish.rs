//! Roughing that leaves more than the finishing allowance, and a pass along the figure that takes it off.
//!
//! In: a [`RoughRequest`] and what the rough passes leave beyond its allowance. Out: the rough passes without a
//! contour pass, home, then the approach and the contour pass of the request, home.
//!
//! Not here: which words ask for it. Source: roughing in one block, chapter 1.2 of the cycles.

use turnwright_units::{Length, Radius};

use crate::{
    CycleMove, Figure, Misuse, PocketRequest, PocketRoughing, RoughRequest, Roughing, rough, rough_pockets,
};

/// Deeper than any figure: no level lies above the contour.
const NO_LEVELS: Length = Length::from_mm(1_000_000_000);

/// The moves of roughing and of the pass that follows it.
#[derive(Clone, Debug)]
pub struct SemiFinished<R> {
    rough: R,
    contour: R,
    passes: u32,
}

/// Plans roughing that leaves `leave_x` (radius) and `leave_z` for a pass along the figure.
///
/// # Errors
/// Those of [`rough`].
pub fn rough_and_semi_finish(
    figure: Figure,
    request: RoughRequest,
    leave_x: Radius,
    leave_z: Length,
) -> Result<SemiFinished<Roughing>, Misuse> {
    let (levels, contour) = split(request, leave_x, leave_z);
    Ok(SemiFinished { rough: rough(figure.clone(), levels)?, contour: rough(figure, contour)?, passes: 0 })
}

/// The same for a figure with pockets.
///
/// # Errors
/// Those of [`rough_pockets`].
pub fn rough_pockets_and_semi_finish(
    figure: Figure,
    request: PocketRequest,
    leave_x: Radius,
    leave_z: Length,
) -> Result<SemiFinished<PocketRoughing>, Misuse> {
    let (levels, contour) = split(request.rough, leave_x, leave_z);
    let with = |rough| PocketRequest { rough, ..request };
    Ok(SemiFinished {
        rough: rough_pockets(figure.clone(), with(levels))?,
        contour: rough_pockets(figure, with(contour))?,
        passes: 0,
    })
}

/// The requests of the rough passes and of the pass along the figure.
fn split(request: RoughRequest, leave_x: Radius, leave_z: Length) -> (RoughRequest, RoughRequest) {
    let levels = RoughRequest {
        allowance_x: request.allowance_x + leave_x,
        allowance_z: request.allowance_z + leave_z,
        semi_finish: false,
        ..request
    };
    (levels, RoughRequest { depth: NO_LEVELS, semi_finish: true, ..request })
}

impl SemiFinished<Roughing> {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        self.rough.move_estimate().saturating_add(self.contour.move_estimate())
    }
}

impl SemiFinished<PocketRoughing> {
    /// No more moves than this.
    pub fn move_estimate(&self) -> u64 {
        self.rough.move_estimate().saturating_add(self.contour.move_estimate())
    }
}

impl<R: Iterator<Item = CycleMove>> Iterator for SemiFinished<R> {
    type Item = CycleMove;

    fn next(&mut self) -> Option<CycleMove> {
        if let Some(step) = self.rough.next() {
            self.passes = step.pass;
            return Some(step);
        }
        let mut step = self.contour.next()?;
        step.pass = step.pass.saturating_add(self.passes);
        Some(step)
    }
}
