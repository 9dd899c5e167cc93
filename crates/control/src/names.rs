//! Names found by their hash: a start asks for hundreds of parameters and functions by name.
//!
//! In: a table of `data/` and the slots that the build script wrote for its names. Out: the place of a name. The build
//! script has this file as a module too, so that both hash alike.

/// What a slot holds that no name has.
pub(crate) const EMPTY: u16 = u16::MAX;

/// Where a name stands in a table. A name whose slot was taken has the next free one.
pub(crate) fn place<T>(slots: &[u16], table: &[(&str, T)], name: &str) -> Option<usize> {
    let mut slot = hash(name);
    loop {
        // The length is a power of two.
        let place = slots[slot & (slots.len() - 1)];
        if place == EMPTY {
            return None;
        }
        if table[usize::from(place)].0 == name {
            return Some(usize::from(place));
        }
        slot += 1;
    }
}

/// Where to begin looking; below 2²⁴, so that looking on never overflows.
pub(crate) fn hash(name: &str) -> usize {
    let bytes = name.as_bytes();
    // Eight bytes at a time; the last eight may overlap those before them.
    let tail = match bytes.last_chunk() {
        Some(last) => u64::from_le_bytes(*last),
        None => bytes.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte)),
    };
    let mut mixed = tail ^ bytes.len() as u64;
    for eight in bytes.as_chunks().0 {
        // The factor is the golden ratio's, with which small differences reach the upper bits.
        mixed = (mixed.rotate_left(25) ^ u64::from_le_bytes(*eight)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    mixed = mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed >> 40) as usize
}
