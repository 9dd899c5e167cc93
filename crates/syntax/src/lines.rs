//! Where lines end: LF, CR LF, or CR alone, mixed as files from shop floors are.

/// The end of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineEnd {
    /// First byte of the line end.
    pub start: usize,
    /// First byte of the next line.
    pub next: usize,
}

/// The first line end in `text`. A CR as the very last byte may be half of a CR LF: it is given as a line end
/// only when `is_last` says that nothing follows.
#[inline]
pub fn find_line_end(text: &[u8], is_last: bool) -> Option<LineEnd> {
    let start = memchr::memchr2(b'\n', b'\r', text)?;
    if text[start] == b'\n' {
        return Some(LineEnd { start, next: start + 1 });
    }
    match text.get(start + 1) {
        Some(b'\n') => Some(LineEnd { start, next: start + 2 }),
        Some(_) => Some(LineEnd { start, next: start + 1 }),
        None if is_last => Some(LineEnd { start, next: start + 1 }),
        None => None,
    }
}
