//! Variables: local ones by level, common ones, and the value that is none.
//!
//! Source: variables of custom macro; which numbers exist is a limit of the control.

/// The empty value: a quiet NaN of our own.
pub(crate) const NULL: f64 = f64::from_bits(NULL_BITS);
const NULL_BITS: u64 = 0x7ff8_0000_0000_0a11;

/// Whether a value is the empty one.
#[inline]
pub(crate) fn is_null(value: f64) -> bool {
    value.to_bits() == NULL_BITS
}

/// A value as a number: the empty one counts as zero.
#[inline]
pub(crate) fn number(value: f64) -> f64 {
    if is_null(value) { 0.0 } else { value }
}

/// Number of local variables.
pub(crate) const LOCALS: usize = 33;
/// First common variable that power-off forgets.
const COMMON_FIRST: u32 = 100;
/// First common variable that power-off keeps.
const RETAINED_FIRST: u32 = 500;

/// The local variables of one level.
pub(crate) type Locals = [f64; LOCALS];

/// Every variable that holds a value of its own.
#[derive(Clone, Debug)]
pub(crate) struct Variables {
    /// Locals of the level in work, then common, then retained variables.
    slots: Vec<f64>,
    common_count: u32,
    retained_count: u32,
}

impl Variables {
    /// All empty; the last numbers of the two common ranges are limits of the control.
    pub(crate) fn new(common_last: u32, retained_last: u32) -> Self {
        let common_count = (common_last + 1).saturating_sub(COMMON_FIRST).min(RETAINED_FIRST - COMMON_FIRST);
        let retained_count = (retained_last + 1).saturating_sub(RETAINED_FIRST).min(1_000);
        let count = LOCALS + common_count as usize + retained_count as usize;
        Self { slots: vec![NULL; count], common_count, retained_count }
    }

    #[inline]
    pub(crate) fn slots(&self) -> &[f64] {
        &self.slots
    }

    /// Where the variable of a number is held; `None` for `#0`, system variables and those that do not exist.
    pub(crate) fn slot(&self, variable: f64) -> Option<u16> {
        if variable.fract() != 0.0 || !(1.0..100_000.0).contains(&variable) {
            return None;
        }
        let variable = variable as u32;
        let place = if variable <= LOCALS as u32 {
            variable - 1
        } else if (COMMON_FIRST..COMMON_FIRST + self.common_count).contains(&variable) {
            LOCALS as u32 + variable - COMMON_FIRST
        } else if (RETAINED_FIRST..RETAINED_FIRST + self.retained_count).contains(&variable) {
            LOCALS as u32 + self.common_count + variable - RETAINED_FIRST
        } else {
            return None;
        };
        u16::try_from(place).ok()
    }

    #[inline]
    pub(crate) fn set(&mut self, slot: u16, value: f64) {
        self.slots[usize::from(slot)] = value;
    }

    #[inline]
    pub(crate) fn get(&self, slot: u16) -> f64 {
        self.slots[usize::from(slot)]
    }

    /// The local variables of the level in work.
    pub(crate) fn locals(&self) -> Locals {
        let mut locals = [NULL; LOCALS];
        locals.copy_from_slice(&self.slots[..LOCALS]);
        locals
    }

    /// Puts other local variables in their place.
    pub(crate) fn set_locals(&mut self, locals: &Locals) {
        self.slots[..LOCALS].copy_from_slice(locals);
    }

    /// Forgets the local ones, the common ones that reset clears, or both.
    pub(crate) fn reset(&mut self, clears_locals: bool, clears_common: bool) {
        let common = LOCALS + self.common_count as usize;
        if clears_locals {
            self.slots[..LOCALS].fill(NULL);
        }
        if clears_common {
            self.slots[LOCALS..common].fill(NULL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_the_ranges_have_no_slot() {
        let variables = Variables::new(149, 531);
        for (number, exists) in [
            (0.0, false),
            (1.0, true),
            (33.0, true),
            (34.0, false),
            (100.0, true),
            (149.0, true),
            (150.0, false),
            (500.0, true),
            (531.0, true),
            (532.0, false),
            (1.5, false),
            (-1.0, false),
            (f64::NAN, false),
        ] {
            assert_eq!(variables.slot(number).is_some(), exists, "{number}");
        }
    }

    #[test]
    fn null_is_one_value_and_counts_as_zero() {
        assert!(is_null(NULL) && !is_null(f64::NAN) && !is_null(0.0));
        assert_eq!(number(NULL), 0.0);
    }
}
