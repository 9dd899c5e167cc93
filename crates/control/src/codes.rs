//! The numbers of codes. The build script has this file as a module too.

/// The number of a code such as `G71` or `G50.3`, times ten. Leading zeros do not matter.
pub fn parse_code(text: &str) -> Option<u16> {
    let digits = text.trim().trim_start_matches(['G', 'g', 'M', 'm']);
    let (whole, tenth) = digits.split_once('.').unwrap_or((digits, "0"));
    let whole: u16 = whole.parse().ok()?;
    let tenth: u16 = tenth.parse().ok()?;
    (whole < 1000 && tenth < 10).then_some(whole * 10 + tenth)
}
