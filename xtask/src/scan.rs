//! Rust source as the rules see it: without comments, without strings, without its tests.
//!
//! Nothing is cut out: what does not count becomes spaces, so that line numbers stay.

/// What a byte of source belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Code,
    Text,
    Comment,
}

/// A source file, three ways.
pub(crate) struct Source {
    /// Without comments.
    pub(crate) code: String,
    /// Without comments and the insides of strings.
    pub(crate) bare: String,
}

impl Source {
    pub(crate) fn new(text: &str) -> Self {
        let parts = parts(text.as_bytes());
        let keep = |wanted: &dyn Fn(Part) -> bool| {
            let bytes = text.bytes().zip(&parts);
            let kept = bytes.map(|(byte, part)| if byte == b'\n' || wanted(*part) { byte } else { b' ' });
            String::from_utf8_lossy(&kept.collect::<Vec<_>>()).into_owned()
        };
        Self { code: keep(&|part| part != Part::Comment), bare: keep(&|part| part == Part::Code) }
    }

    /// The same without the items that are compiled for tests only.
    pub(crate) fn without_tests(mut self) -> Self {
        const MARK: &str = "#[cfg(test)]";
        while let Some(start) = self.bare.find(MARK) {
            let end = item_end(&self.bare, start + MARK.len());
            for text in [&mut self.code, &mut self.bare] {
                let blank: String =
                    text[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
                // Bytes for bytes: both texts keep the same places.
                let blank = format!("{blank}{}", " ".repeat(end - start - blank.len()));
                text.replace_range(start..end, &blank);
            }
        }
        self
    }
}

/// Where the item that starts at `from` ends: behind its first `;`, or behind the brace that closes its first.
fn item_end(bare: &str, from: usize) -> usize {
    let mut depth = 0u32;
    for (at, byte) in bare.bytes().enumerate().skip(from) {
        match byte {
            b'{' => depth += 1,
            b'}' if depth <= 1 => return at + 1,
            b'}' => depth -= 1,
            b';' if depth == 0 => return at + 1,
            _ => {}
        }
    }
    bare.len()
}

/// Which part every byte belongs to. Quotes count as code.
fn parts(text: &[u8]) -> Vec<Part> {
    let mut parts = vec![Part::Code; text.len()];
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let (part, length) = if rest.starts_with(b"//") {
            (Part::Comment, rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len()))
        } else if rest.starts_with(b"/*") {
            (Part::Comment, block_comment(rest))
        } else if let Some(length) = raw_string(rest, at.checked_sub(1).map(|before| text[before])) {
            (Part::Text, length)
        } else if rest[0] == b'"' {
            (Part::Text, quoted(rest, b'"'))
        } else if rest[0] == b'\'' && (rest.get(1) == Some(&b'\\') || rest.get(2) == Some(&b'\'')) {
            (Part::Text, quoted(rest, b'\''))
        } else {
            (Part::Code, 1)
        };
        let last = at + length - 1;
        parts[at..=last].fill(part);
        if part == Part::Text {
            (parts[at], parts[last]) = (Part::Code, Part::Code);
        }
        at += length;
    }
    parts
}

fn block_comment(rest: &[u8]) -> usize {
    let (mut depth, mut at) = (0u32, 0);
    while at < rest.len() {
        if rest[at..].starts_with(b"/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest[at..].starts_with(b"*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    rest.len()
}

/// Length of a raw string such as `r#"…"#` that starts here.
fn raw_string(rest: &[u8], before: Option<u8>) -> Option<usize> {
    let in_word = before.is_some_and(|byte| (byte.is_ascii_alphanumeric() && byte != b'b') || byte == b'_');
    if in_word || rest[0] != b'r' {
        return None;
    }
    let hashes = rest[1..].iter().take_while(|byte| **byte == b'#').count();
    if rest.get(1 + hashes) != Some(&b'"') {
        return None;
    }
    let close: Vec<u8> = std::iter::once(b'"').chain(std::iter::repeat_n(b'#', hashes)).collect();
    let inside = &rest[hashes + 2..];
    let end = inside.windows(close.len()).position(|window| window == close).unwrap_or(inside.len());
    Some((hashes + 2 + end + close.len()).min(rest.len()))
}

fn quoted(rest: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < rest.len() {
        match rest[at] {
            b'\\' => at += 2,
            byte if byte == quote => return at + 1,
            _ => at += 1,
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_strings_are_told_apart() {
        let source =
            Source::new("a \"b // c\" /* d /* e */ f */ 'g' h'i \"\\\"j\" r#\"k \" l\"# // m\nn '\\'' o");
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>().join(" ");
        assert_eq!(words(&source.code), r##"a "b // c" 'g' h'i "\"j" r#"k " l"# n '\'' o"##);
        assert_eq!(words(&source.bare), "a \" \" ' ' h'i \" \" r # n ' ' o");
    }

    #[test]
    fn tests_are_left_out_and_lines_stay() {
        let text = "a\n#[cfg(test)]\nmod tests {\n  fn b() { \"}\" }\n}\nc\n#[cfg(test)]\nmod more;\nd é\n";
        let source = Source::new(text).without_tests();
        let seen: Vec<_> =
            source.bare.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).collect();
        assert_eq!(seen, [(0, "a"), (5, "c"), (8, "d é")]);
    }
}
