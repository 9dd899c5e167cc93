//! What cannot be cut, one name per condition.
//!
//! In: nothing. Out: [`Misuse`], which the interpreter maps to the alarm number and text of the control.
//! Not here: numbers, texts, severities. Source: the table of misuse and alarms of the repetitive cycles.

use crate::MonotonyFault;

/// Why a cycle was refused before its first move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misuse {
    /// A length lies outside ±1000 km, where nothing can be computed to the nanometre.
    OutOfRange,
    /// The figure does not start where the tool stands.
    StartMismatch,
    /// The figure has nothing after its first approach that moves along the cut: there is no contour.
    NoContour,
    /// Depth of cut of a roughing cycle is zero or negative.
    DepthNotPositive,
    /// A depth of cut, peck or step is positive, but too small for the axis it lies on to move by it.
    BelowIncrement,
    /// Escape of a roughing cycle is negative.
    EscapeNegative,
    /// An axis of the figure turns back.
    NotMonotone(MonotonyFault),
    /// A pattern with no pass.
    PassesZero,
    /// Peck of a groove is negative.
    PeckNegative,
    /// Sideways step of a groove is negative.
    StepNegative,
    /// The end of a groove lies to the side, but there is no step to get there.
    StepZero,
    /// Return after a peck is negative.
    RetractNegative,
    /// Relief is negative where its direction is fixed already.
    ReliefNegative,
    /// A thread starts and ends at the same Z.
    NoThread,
    /// Lead is zero or negative.
    LeadNotPositive,
    /// Thread height is zero or negative.
    HeightNotPositive,
    /// Depth of the first thread pass is zero or negative.
    FirstDepthNotPositive,
    /// Least depth of a thread pass is negative.
    MinDepthNegative,
    /// Least depth of a thread pass is more than the height.
    MinDepthAboveHeight,
    /// Finishing allowance of a thread is negative.
    AllowanceNegative,
    /// Finishing allowance of a thread leaves nothing to rough: it is the height or more.
    AllowanceNotBelowHeight,
    /// A thread without a finishing pass.
    FinishingPassesZero,
    /// Nose angle of 180 degrees or more: no such nose (which angles a control allows is its own affair).
    NoseAngle,
    /// Moving the start along the flank would use up the whole thread.
    ThreadTooShort,
    /// Run-out of a thread is negative.
    RunOutNegative,
    /// Run-out angle of 90 degrees or more: the tool would never leave.
    RunOutAngle,
}
