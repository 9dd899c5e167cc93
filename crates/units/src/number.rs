//! An own fixed-point number writer: listings and traces are numbers, and `format!` is too slow for them.

use crate::{Angle, Length};

/// Writes `value` / 10^`decimals` without trailing zeros (`12.5`, `-0.001`, `40`).
///
/// `decimals` is at most 18.
pub fn write_fixed(out: &mut Vec<u8>, value: i64, decimals: u8) {
    let magnitude = value.unsigned_abs();
    // The usual places by themselves: a division by a known number costs little.
    let (whole, fraction) = match decimals {
        0 => (magnitude, 0),
        3 => (magnitude / 1_000, magnitude % 1_000),
        4 => (magnitude / 10_000, magnitude % 10_000),
        6 => (magnitude / 1_000_000, magnitude % 1_000_000),
        _ => {
            let unit = 10u64.pow(u32::from(decimals.min(18)));
            (magnitude / unit, magnitude % unit)
        }
    };
    let mut text = [b'0'; NUMBER_BYTES * 2];
    // Where the point stands, when there is one: the digits behind it keep their leading zeros.
    let point = WHOLE_BYTES;
    let mut end = point;
    if fraction > 0 {
        text[point] = b'.';
        end = point + 1 + usize::from(decimals.min(18));
        write_digits(&mut text, end, fraction);
        while text[end - 1] == b'0' {
            end -= 1;
        }
    }
    let mut start = write_digits(&mut text, point, whole);
    if value < 0 {
        start -= 1;
        text[start] = b'-';
    }
    append(out, &text, start..end);
}

/// Writes a whole number.
pub fn write_whole(out: &mut Vec<u8>, number: u32) {
    let mut text = [b'0'; NUMBER_BYTES * 2];
    let start = write_digits(&mut text, WHOLE_BYTES, number.into());
    append(out, &text, start..WHOLE_BYTES);
}

/// A sign and the digits of a whole number of 64 bits.
const WHOLE_BYTES: usize = 21;
/// The same with a point and eighteen places.
const NUMBER_BYTES: usize = WHOLE_BYTES + 1 + 18;

/// Every number below a hundred, two digits each.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut number = 0;
    while number < pairs.len() {
        pairs[number] = [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8];
        number += 1;
    }
    pairs
};

/// Writes the digits of a number so that they end in front of `end`; where they start.
#[inline]
fn write_digits(text: &mut [u8; NUMBER_BYTES * 2], end: usize, number: u64) -> usize {
    let (mut at, mut rest) = (end, number);
    while rest >= 100 {
        at -= 2;
        text[at..at + 2].copy_from_slice(&PAIRS[(rest % 100) as usize]);
        rest /= 100;
    }
    if rest >= 10 {
        at -= 2;
        text[at..at + 2].copy_from_slice(&PAIRS[rest as usize]);
    } else {
        at -= 1;
        text[at] = b'0' + rest as u8;
    }
    at
}

/// Appends a part of `text`. A copy of known length is a few moves, one of any length is a call.
#[inline]
fn append(out: &mut Vec<u8>, text: &[u8; NUMBER_BYTES * 2], part: std::ops::Range<usize>) {
    let length = out.len() + part.len();
    out.extend_from_slice(&text[part.start..part.start + NUMBER_BYTES]);
    out.truncate(length);
}

/// Writes a length in millimetres, rounded to `decimals` (at most 6) places, halves away from zero,
/// without trailing zeros.
pub fn write_millimetres(out: &mut Vec<u8>, length: Length, decimals: u8) {
    const STEP_NM: [i64; 7] = [1_000_000, 100_000, 10_000, 1_000, 100, 10, 1];
    let decimals = decimals.min(6);
    let step = STEP_NM[decimals as usize];
    let half = if length.nm() < 0 { -(step / 2) } else { step / 2 };
    write_fixed(out, length.nm().saturating_add(half) / step, decimals);
}

/// Writes an angle in degrees, as [`write_millimetres`] writes a length.
pub fn write_degrees(out: &mut Vec<u8>, angle: Angle, decimals: u8) {
    write_millimetres(out, Length::from_nm(angle.nanodegrees() / 1_000), decimals);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(value: i64, decimals: u8) -> String {
        let mut out = Vec::new();
        write_fixed(&mut out, value, decimals);
        String::from_utf8(out).expect("digits")
    }

    #[test]
    fn numbers_carry_no_trailing_zeros() {
        assert_eq!(fixed(0, 3), "0");
        assert_eq!(fixed(12_500, 3), "12.5");
        assert_eq!(fixed(-1, 3), "-0.001");
        assert_eq!(fixed(40_000, 3), "40");
        assert_eq!(fixed(7, 0), "7");
        assert_eq!(fixed(i64::MIN, 6), "-9223372036854.775808");
        assert_eq!(fixed(1, 18), "0.000000000000000001");
        assert_eq!(fixed(i64::MIN, 18), "-9.223372036854775808");
        assert_eq!(fixed(i64::MIN, 0), "-9223372036854775808");
    }

    #[test]
    fn agrees_with_the_standard_library_on_random_values() {
        let mut seed = 88_172_645_463_325_252u64;
        for _ in 0..20_000 {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            let value = (seed as i64) >> (seed % 50);
            let decimals = (seed % 7) as u8;
            let text = fixed(value, decimals);
            let scaled: f64 = text.parse().expect("a number");
            let expected = value as f64 / 10f64.powi(decimals.into());
            assert!((scaled - expected).abs() <= expected.abs() * 1e-15, "{value} {decimals} {text}");
        }
    }

    #[test]
    fn whole_numbers_are_written_as_they_are() {
        for number in [0, 7, 10, 99, 100, 12_345, u32::MAX] {
            let mut out = b"n".to_vec();
            write_whole(&mut out, number);
            assert_eq!(String::from_utf8(out).expect("digits"), format!("n{number}"));
        }
    }

    #[test]
    fn lengths_are_rounded_to_the_places_shown() {
        let mut out = Vec::new();
        write_millimetres(&mut out, Length::from_nm(27_241_421), 3);
        out.push(b' ');
        write_millimetres(&mut out, Length::from_nm(-2_540), 3);
        assert_eq!(out, b"27.241 -0.003");
    }
}
