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
        _ => return write_any(out, value, decimals),
    };
    if whole >= EIGHT_DIGITS {
        return write_any(out, value, decimals);
    }
    if value < 0 {
        out.push(b'-');
    }
    write_short(out, whole);
    if fraction > 0 {
        let digits = eight_digits(fraction);
        // What stands before the places is zeros, and so may be what stands last.
        let shift = 8 * (8 - u32::from(decimals));
        let kept = usize::from(decimals) - (digits.leading_zeros() / 8) as usize;
        let text = (((digits + ZEROS) >> shift) << 8) | u64::from(b'.');
        append(out, text, 1 + kept);
    }
}

/// Writes a whole number.
#[inline]
pub fn write_whole(out: &mut Vec<u8>, number: u32) {
    if u64::from(number) < EIGHT_DIGITS {
        write_short(out, number.into());
    } else {
        write_any(out, number.into(), 0);
    }
}

/// The first number of nine digits.
const EIGHT_DIGITS: u64 = 100_000_000;
/// Eight zeros as text.
const ZEROS: u64 = u64::from_ne_bytes([b'0'; 8]);

/// Writes a number of at most eight digits.
#[inline]
fn write_short(out: &mut Vec<u8>, number: u64) {
    let digits = eight_digits(number);
    let skipped = (digits.trailing_zeros() / 8).min(7);
    append(out, (digits + ZEROS) >> (8 * skipped), (8 - skipped) as usize);
}

/// The eight digits of a number, one a byte, the first in the lowest: by fours, by pairs, one by one.
#[inline]
const fn eight_digits(number: u64) -> u64 {
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = ((fours * 5_243) >> 19) & 0x0000_007f_0000_007f;
    let pairs = hundreds | ((fours - 100 * hundreds) << 16);
    let tens = ((pairs * 103) >> 10) & 0x000f_000f_000f_000f;
    tens | ((pairs - 10 * tens) << 8)
}

/// Appends the first bytes of eight, the lowest first. They are never in memory one by one: whoever reads as a whole
/// what was written in pieces waits for the pieces.
#[inline]
fn append(out: &mut Vec<u8>, text: u64, length: usize) {
    let end = out.len() + length;
    out.extend_from_slice(&text.to_le_bytes());
    out.truncate(end);
}

/// Any number, digit by digit.
#[cold]
fn write_any(out: &mut Vec<u8>, value: i64, decimals: u8) {
    let mut magnitude = value.unsigned_abs();
    let mut places = decimals.min(18);
    while places > 0 && magnitude.is_multiple_of(10) {
        magnitude /= 10;
        places -= 1;
    }
    // 20 digits of a u64, a point, a sign, and a zero before the point.
    let mut text = [0u8; 24];
    let mut at = text.len();
    let mut written = 0u8;
    while magnitude > 0 || written <= places {
        if written == places && places > 0 {
            at -= 1;
            text[at] = b'.';
        }
        at -= 1;
        text[at] = b'0' + (magnitude % 10) as u8;
        magnitude /= 10;
        written += 1;
    }
    if value < 0 {
        at -= 1;
        text[at] = b'-';
    }
    out.extend_from_slice(&text[at..]);
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
    fn short_numbers_are_written_as_any_are() {
        let mut seed = 0x5eed_0f5e_ed00u64;
        for round in 0..20_000 {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            let end = 10i64.pow(round % 16);
            let value = (seed as i64) % end * [1, 10, 1_000][round as usize % 3];
            for decimals in 0..10 {
                let mut any = Vec::new();
                write_any(&mut any, value, decimals);
                assert_eq!(fixed(value, decimals).as_bytes(), any, "{value} {decimals}");
            }
        }
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
