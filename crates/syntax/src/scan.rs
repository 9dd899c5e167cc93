//! The scanner: one block of a line at a time.

use crate::number::{DIGITS_MAX, Decimal};
use crate::{Block, Extent, ExtentKind, Fault, FaultKind, Value, Word};

/// Most words in one block; a control takes far fewer.
pub const BLOCK_WORDS_MAX: usize = 200;

/// Scans the block that begins at `from` in `line` (a line without its line end) into `block`, and returns
/// where the next block of the same line begins: `line.len()` when there is none.
pub fn scan_block(line: &[u8], from: usize, block: &mut Block) -> usize {
    block.clear();
    let mut scanner = Scanner { line, at: from, block, single: false };
    scanner.run();
    scanner.at
}

struct Scanner<'a> {
    line: &'a [u8],
    at: usize,
    block: &'a mut Block,
    /// Stop at the end of block without a look at what follows it.
    single: bool,
}

/// Longest program name in angle brackets, brackets included.
const NAME_BYTES_MAX: usize = 64;

/// Words that begin a macro statement.
const KEYWORDS: [&[u8]; 11] =
    [b"IF", b"WHILE", b"GOTO", b"DO", b"END", b"THEN", b"POPEN", b"PCLOS", b"DPRNT", b"BPRNT", b"SETVN"];

impl Scanner<'_> {
    fn run(&mut self) {
        self.plain_words();
        while let Some(&byte) = self.line.get(self.at) {
            match byte {
                b'A'..=b'Z' | b'a'..=b'z' => {
                    if !self.word(false) {
                        return;
                    }
                }
                b' ' | b'\t' => self.at += 1,
                b'(' => self.comment(1, b"(", b")"),
                b';' => return self.semicolon(1),
                b'/' => self.skip(),
                b'#' => return self.macro_statement(),
                b'[' if self.line[self.at..].starts_with(b"[#_") => return self.macro_statement(),
                b',' => self.comma(),
                b'%' if self.nothing_yet() => return self.percent(),
                b':' if self.nothing_yet() => self.colon(),
                b'<' if self.names_may_stand_here() => self.name(),
                0x1a => return self.end_of_text(),
                0..=0x1f | 0x7f => self.at += 1,
                0x80.. => {
                    if self.full_width() {
                        return;
                    }
                }
                b'[' | b']' => self.junk(1, FaultKind::StrayBracket),
                _ => self.junk(1, FaultKind::NotAWord),
            }
        }
    }

    /// The words that nearly every block begins with, and most consist of: an upper-case letter, a number, a
    /// blank or the next letter. Stops in front of anything else, which [`Scanner::run`] then looks at in full.
    #[inline]
    fn plain_words(&mut self) {
        let length = self.line.len();
        let mut rest = &self.line[self.at..];
        while let [letter, behind @ ..] = rest {
            if *letter == b' ' {
                rest = behind;
                continue;
            }
            if !letter.is_ascii_uppercase() || self.block.words.len() >= BLOCK_WORDS_MAX {
                break;
            }
            let (is_negative, number) = match behind {
                [b'-', number @ ..] => (true, number),
                _ => (false, behind),
            };
            let (value, after) = run_of_digits(0, number);
            let (digits, has_point, scale, after) = match after {
                [b'.', fraction @ ..] => {
                    let (value, after) = run_of_digits(value, fraction);
                    (value, true, fraction.len() - after.len(), after)
                }
                _ => (value, false, 0, after),
            };
            let typed = number.len() - after.len() - usize::from(has_point);
            let ends = match after {
                [] | [b' ', ..] => true,
                [next, ..] => next.is_ascii_uppercase() && *next != b'O',
            };
            if !ends || typed == 0 || typed > usize::from(DIGITS_MAX) {
                break;
            }
            let digits = if is_negative { -(digits as i64) } else { digits as i64 };
            let number =
                Decimal { digits, scale: scale as u8, typed_digits: typed as u8, has_point, is_negative };
            let (start, end) = ((length - rest.len()) as u32, (length - after.len()) as u32);
            self.block.push(Word {
                address: *letter,
                comma: false,
                start,
                end,
                value: Value::Number(number),
            });
            rest = after;
        }
        self.at = length - rest.len();
    }

    fn nothing_yet(&self) -> bool {
        self.block.words.is_empty() && !self.block.extents.iter().any(|e| e.kind != ExtentKind::Comment)
    }

    fn names_may_stand_here(&self) -> bool {
        let reach = self.line.len().min(self.at + NAME_BYTES_MAX);
        self.line[self.at..reach].contains(&b'>')
            && match self.block.words.last() {
                None => true,
                // `O<NAME>`, or a call of a program by its name.
                Some(word) => {
                    (word.address == b'O' && word.value == Value::Missing)
                        || matches!(word.address, b'M' | b'G')
                }
            }
    }

    fn extent(&mut self, kind: ExtentKind, start: usize, end: usize) {
        // Neighbouring junk is one stretch, so that a line of rubbish is one message.
        if kind == ExtentKind::Junk
            && let Some(last) = self.block.extents.last_mut()
            && last.kind == kind
            && last.end == start as u32
        {
            last.end = end as u32;
            return;
        }
        self.block.extents.push(Extent { kind, start: start as u32, end: end as u32 });
    }

    fn fault(&mut self, kind: FaultKind, start: usize, end: usize) {
        if let Some(last) = self.block.faults.last_mut()
            && last.kind == kind
            && last.end == start as u32
        {
            last.end = end as u32;
            return;
        }
        if self.block.faults.len() < BLOCK_WORDS_MAX {
            self.block.faults.push(Fault { kind, start: start as u32, end: end as u32 });
        }
    }

    fn junk(&mut self, length: usize, kind: FaultKind) {
        let end = (self.at + length).min(self.line.len());
        self.extent(ExtentKind::Junk, self.at, end);
        self.fault(kind, self.at, end);
        self.at = end;
    }

    /// A letter and what follows it. False when the rest of the block was consumed as a macro statement.
    #[inline]
    fn word(&mut self, comma: bool) -> bool {
        let start = self.at - usize::from(comma);
        let address = self.line[self.at] & 0xdf;
        let mut at = self.at + 1;
        while let Some(b' ' | b'\t') = self.line.get(at) {
            at += 1;
        }
        match self.line.get(at) {
            Some(b'0'..=b'9' | b'.' | b'-' | b'+') => self.number(address, comma, start, at),
            Some(b'#' | b'[') => self.expression_value(address, comma, start, at, at),
            Some(next @ (b'A'..=b'Z' | b'a'..=b'z')) => {
                if !comma && self.block.words.iter().all(|w| w.address == b'N') && self.keyword() {
                    self.macro_statement();
                    return false;
                }
                if address == b'A' && !comma && self.indirect_axis() {
                    return true;
                }
                let letter_o = matches!(next, b'O' | b'o') && address != b'O' && address != b'N';
                self.missing(address, comma, start, letter_o);
            }
            Some(b'<') if address == b'O' => {
                self.push(address, comma, start, self.at + 1, Value::Missing);
                self.at += 1;
            }
            Some(b',') if matches!(self.line.get(at + 1), Some(b'0'..=b'9')) => {
                self.decimal_comma(address, comma, start, at);
            }
            _ => self.missing(address, comma, start, false),
        }
        true
    }

    fn push(&mut self, address: u8, comma: bool, start: usize, end: usize, value: Value) {
        if self.block.words.len() >= BLOCK_WORDS_MAX {
            self.extent(ExtentKind::Junk, start, end);
            self.fault(FaultKind::TooManyWords, start, end);
            return;
        }
        let (start, end) = (start as u32, end as u32);
        self.block.push(Word { address, comma, start, end, value });
    }

    fn missing(&mut self, address: u8, comma: bool, start: usize, letter_o: bool) {
        let end = self.at + 1;
        let kind = if letter_o { FaultKind::LetterO } else { FaultKind::AddressWithoutValue };
        self.fault(kind, start, if letter_o { (end + 1).min(self.line.len()) } else { end });
        self.push(address, comma, start, end, Value::Missing);
        self.at = end;
    }

    fn decimal_comma(&mut self, address: u8, comma: bool, start: usize, at: usize) {
        let mut end = at + 1;
        while let Some(b'0'..=b'9') = self.line.get(end) {
            end += 1;
        }
        self.fault(FaultKind::DecimalComma, start, end);
        self.push(address, comma, start, end, Value::Missing);
        self.at = end;
    }

    #[inline]
    fn number(&mut self, address: u8, comma: bool, start: usize, from: usize) {
        let line = self.line;
        let mut at = from;
        let mut negative = false;
        let mut signs = 0;
        while let Some(sign @ (b'-' | b'+')) = line.get(at) {
            negative ^= *sign == b'-';
            signs += 1;
            at += 1;
        }
        if let Some(b'#' | b'[') = line.get(at) {
            return self.expression_value(address, comma, start, from, at);
        }
        let (mut digits, mut typed, mut scale) = (0i64, 0u8, 0u8);
        let mut has_point = false;
        loop {
            match line.get(at) {
                Some(digit @ b'0'..=b'9') => {
                    if typed < DIGITS_MAX {
                        digits = digits * 10 + i64::from(digit - b'0');
                        scale += u8::from(has_point);
                    }
                    typed = typed.saturating_add(1);
                }
                Some(b'.') if !has_point => has_point = true,
                _ => break,
            }
            at += 1;
        }
        match line.get(at) {
            Some(b'.') => {
                while let Some(b'0'..=b'9' | b'.') = line.get(at) {
                    at += 1;
                }
                self.fault(FaultKind::TwoPoints, start, at);
                typed = 0;
            }
            Some(b',') if matches!(line.get(at + 1), Some(b'0'..=b'9')) && typed > 0 => {
                return self.decimal_comma(address, comma, start, at);
            }
            Some(b'O' | b'o') if typed > 0 && self.zero_typed_as_letter(address, digits, at) => {
                let mut end = at + 1;
                while let Some(b'0'..=b'9' | b'.') = line.get(end) {
                    end += 1;
                }
                self.fault(FaultKind::LetterO, start, end);
                self.push(address, comma, start, end, Value::Missing);
                self.at = end;
                return;
            }
            _ if typed == 0 => self.fault(FaultKind::AddressWithoutValue, start, at),
            _ if signs > 1 => self.fault(FaultKind::TwoSigns, start, at),
            _ if typed > DIGITS_MAX => self.fault(FaultKind::NumberTooLong, start, at),
            _ => {}
        }
        let value = if typed == 0 || typed > DIGITS_MAX || signs > 1 {
            Value::Missing
        } else {
            if negative {
                digits = -digits;
            }
            Value::Number(Decimal { digits, scale, typed_digits: typed, has_point, is_negative: negative })
        };
        self.push(address, comma, start, at, value);
        self.at = at;
    }

    /// `X1O.`, `S8O0`: the letter begins no program number here. Behind `N10` or `M99` it may.
    fn zero_typed_as_letter(&self, address: u8, digits: i64, at: usize) -> bool {
        let may_begin_a_program = address == b'N' || (address == b'M' && digits == 99);
        !may_begin_a_program && !matches!(self.line.get(at + 1), Some(b'<' | b' '))
    }

    fn expression_value(&mut self, address: u8, comma: bool, start: usize, from: usize, at: usize) {
        let end = self.expression_end(at);
        self.block.computes = true;
        self.push(address, comma, start, end, Value::Expression { start: from as u32, end: end as u32 });
        self.at = end;
    }

    /// Where the variable or bracket that begins at `at` ends.
    fn expression_end(&mut self, at: usize) -> usize {
        let line = self.line;
        let mut end = at;
        while let Some(b'#') = line.get(end) {
            end += 1;
        }
        match line.get(end) {
            Some(b'[') => {
                let opened = end;
                let mut depth = 0usize;
                while let Some(&byte) = line.get(end) {
                    match byte {
                        b'[' => depth += 1,
                        b']' => depth -= 1,
                        b'(' | b';' => break,
                        _ => {}
                    }
                    end += 1;
                    if depth == 0 {
                        return end;
                    }
                }
                self.fault(FaultKind::StrayBracket, opened, end);
                end
            }
            _ => {
                while let Some(b'0'..=b'9') = line.get(end) {
                    end += 1;
                }
                end
            }
        }
    }

    /// `AX[n]=value`: an axis by its number. Until the number is known it is a word of A, and a fault that says so.
    #[cold]
    fn indirect_axis(&mut self) -> bool {
        const HEAD: &[u8] = b"AX[";
        let (line, start) = (self.line, self.at);
        let is_named = line[start..].get(..HEAD.len()).is_some_and(|head| head.eq_ignore_ascii_case(HEAD));
        let Some(closed) = is_named.then(|| closing_bracket(line, start + HEAD.len() - 1)).flatten() else {
            return false;
        };
        let skip_blanks = |mut at: usize| {
            while let Some(b' ' | b'\t') = line.get(at) {
                at += 1;
            }
            at
        };
        let equals = skip_blanks(closed + 1);
        if line.get(equals) != Some(&b'=') {
            return false;
        }
        let from = skip_blanks(equals + 1);
        match line.get(from) {
            Some(b'0'..=b'9' | b'.' | b'-' | b'+') => self.number(b'A', false, start, from),
            Some(b'#' | b'[') => self.expression_value(b'A', false, start, from, from),
            _ => {
                self.fault(FaultKind::AddressWithoutValue, start, equals + 1);
                self.push(b'A', false, start, equals + 1, Value::Missing);
                self.at = equals + 1;
            }
        }
        self.fault(FaultKind::IndirectAxis, start, self.at);
        self.block.computes = true;
        true
    }

    fn keyword(&self) -> bool {
        let rest = &self.line[self.at..];
        KEYWORDS.iter().any(|word| rest.len() >= word.len() && rest[..word.len()].eq_ignore_ascii_case(word))
    }

    /// From here to the end of the block is one macro statement; comments stay apart.
    fn macro_statement(&mut self) {
        let start = self.at;
        let mut end = start;
        while let Some(&byte) = self.line.get(self.at) {
            match byte {
                b'(' | b';' | 0x1a => break,
                0x80.. if full_width_at(&self.line[self.at..]).is_some() => break,
                b' ' | b'\t' => self.at += 1,
                _ => {
                    self.at += 1;
                    end = self.at;
                }
            }
        }
        self.extent(ExtentKind::Macro, start, end);
        self.block.macro_statement = Some((start as u32, end as u32));
        self.at = end;
        // What may still follow is comments and the end of block.
        while let Some(&byte) = self.line.get(self.at) {
            match byte {
                b' ' | b'\t' | 0..=0x19 => self.at += 1,
                b'(' => self.comment(1, b"(", b")"),
                b';' => return self.semicolon(1),
                0x1a => return self.end_of_text(),
                0x80.. => {
                    if self.full_width() {
                        return;
                    }
                }
                _ => self.junk(1, FaultKind::NotAWord),
            }
        }
    }

    fn comment(&mut self, opener: usize, open: &[u8], close: &[u8]) {
        let start = self.at;
        let mut at = start + opener;
        let mut depth = 1;
        let mut nested = false;
        while at < self.line.len() {
            let rest = &self.line[at..];
            if rest.starts_with(close) || rest[0] == b')' {
                at += if rest[0] == b')' { 1 } else { close.len() };
                depth -= 1;
                if depth == 0 {
                    break;
                }
            } else if rest.starts_with(open) {
                at += open.len();
                depth += 1;
                nested = true;
            } else {
                at += 1;
            }
        }
        if depth > 0 {
            self.fault(FaultKind::UnclosedComment, start, at);
        } else if nested {
            self.fault(FaultKind::NestedComment, start, at);
        }
        self.extent(ExtentKind::Comment, start, at);
        self.at = at;
    }

    /// The end of block. What follows on the line is the next block when it reads like one, else a remark.
    fn semicolon(&mut self, length: usize) {
        self.extent(ExtentKind::Semicolon, self.at, self.at + length);
        self.at += length;
        if self.single {
            return;
        }
        let rest = self.at;
        let text = self.line[rest..].trim_ascii();
        if text.is_empty() {
            self.at = self.line.len();
        } else if !reads_like_a_block(text) {
            self.extent(ExtentKind::IgnoredText, rest, self.line.len());
            // A comment in brackets behind the end of block is what it says it is.
            if text[0] != b'(' {
                self.fault(FaultKind::TextAfterSemicolon, rest, self.line.len());
            }
            self.at = self.line.len();
        }
    }

    fn skip(&mut self) {
        let start = self.at;
        self.at += 1;
        let number = match self.line.get(self.at) {
            Some(digit @ b'1'..=b'9') => {
                self.at += 1;
                digit - b'0'
            }
            _ => 1,
        };
        let head = self.block.words.iter().all(|word| word.address == b'N');
        if head {
            self.block.skip.whole |= 1 << number;
        } else if self.block.skip.rest == 0 {
            self.block.skip.rest = 1 << number;
            self.block.skip.words_kept = self.block.words.len() as u8;
        }
        self.extent(ExtentKind::Skip, start, self.at);
    }

    fn comma(&mut self) {
        match self.line.get(self.at + 1) {
            Some(b'A'..=b'Z' | b'a'..=b'z') => {
                self.at += 1;
                self.word(true);
            }
            _ => self.junk(1, FaultKind::NotAWord),
        }
    }

    fn percent(&mut self) {
        self.block.is_percent = true;
        self.extent(ExtentKind::Percent, self.at, self.line.len());
        self.at = self.line.len();
    }

    /// `:1234` is the ISO way to write a program number.
    fn colon(&mut self) {
        match self.line.get(self.at + 1) {
            Some(b'0'..=b'9') => self.number(b'O', false, self.at, self.at + 1),
            _ => self.junk(1, FaultKind::NotAWord),
        }
    }

    fn name(&mut self) {
        let start = self.at;
        while let Some(&byte) = self.line.get(self.at) {
            self.at += 1;
            if byte == b'>' {
                break;
            }
        }
        self.extent(ExtentKind::Name, start, self.at);
        self.fault(FaultKind::ProgramName, start, self.at);
    }

    fn end_of_text(&mut self) {
        self.block.is_end_of_text = true;
        self.extent(ExtentKind::EndOfText, self.at, self.line.len());
        self.at = self.line.len();
    }

    /// A byte above ASCII: a full-width form of a mark that counts, or junk. True when it ended the block.
    fn full_width(&mut self) -> bool {
        let (at, rest) = (self.at, &self.line[self.at..]);
        match full_width_at(rest) {
            Some((mark, length)) => {
                self.fault(FaultKind::FullWidth, at, at + length);
                match mark {
                    b';' => {
                        self.semicolon(length);
                        return true;
                    }
                    b'(' => {
                        // The closing mark of the same encoding has the code after the opening one.
                        let mut close = rest[..length].to_vec();
                        close[length - 1] += 1;
                        let open = rest[..length].to_vec();
                        self.comment(length, &open, &close);
                    }
                    _ => self.junk(length, FaultKind::NotAWord),
                }
            }
            None if rest.starts_with(b"\xef\xbb\xbf") || rest.starts_with("\u{a0}".as_bytes()) => {
                self.at += if rest[0] == 0xef { 3 } else { 2 };
            }
            None => self.junk(character_length(rest), FaultKind::NotAWord),
        }
        false
    }
}

/// Reads on from `value` through the digits at the start of `text`; gives the new value (wrapping: the caller
/// counts the digits) and what follows them.
#[inline]
fn run_of_digits(mut value: u64, mut text: &[u8]) -> (u64, &[u8]) {
    while let [byte, rest @ ..] = text {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        text = rest;
    }
    (value, text)
}

/// Where the bracket that opens at `open` closes.
fn closing_bracket(line: &[u8], open: usize) -> Option<usize> {
    let mut depth = 0usize;
    for (at, byte) in line.iter().enumerate().skip(open) {
        match byte {
            b'[' => depth += 1,
            b']' => depth -= 1,
            b'(' | b';' => return None,
            _ => {}
        }
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// The ASCII mark that a full-width character (UTF-8 or GBK) stands for, and its length in bytes.
fn full_width_at(text: &[u8]) -> Option<(u8, usize)> {
    match text {
        [0xef, 0xbc, code @ (0x81..=0xbf), ..] => Some((code - 0x80 + 0x20, 3)),
        [0xa3, code @ (0xa1..=0xfe), ..] => Some((code - 0xa0 + 0x20, 2)),
        _ => None,
    }
}

/// Bytes of the character at the start of `text`: UTF-8 if it is valid, else a GBK pair, else one byte.
fn character_length(text: &[u8]) -> usize {
    for length in 2..=4.min(text.len()) {
        if std::str::from_utf8(&text[..length]).is_ok_and(|s| s.chars().count() == 1) {
            return length;
        }
    }
    if text[0] >= 0x81 && text.get(1).is_some_and(|&byte| byte >= 0x40) { 2 } else { 1 }
}

/// Whether text behind an end of block is another block: nothing but words, marks and comments.
fn reads_like_a_block(text: &[u8]) -> bool {
    match text[0] {
        b'%' => return true,
        b'(' | 0x80.. => return false,
        _ => {}
    }
    let mut block = Block::new();
    let mut scanner = Scanner { line: text, at: 0, block: &mut block, single: true };
    scanner.run();
    !block.is_empty()
        && block.macro_statement.is_none_or(|(start, end)| crate::parse_statement(text, start..end).is_ok())
        && block.faults.iter().all(|fault| fault.kind.is_harmless() || fault.kind == FaultKind::IndirectAxis)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> String {
        let mut block = Block::new();
        scan_block(text.as_bytes(), 0, &mut block);
        let mut shown = Vec::new();
        for word in &block.words {
            let value = match word.value {
                Value::Number(n) => {
                    format!("{}e-{}{}", n.digits, n.scale, if n.has_point { "." } else { "" })
                }
                Value::Expression { start, end } => text[start as usize..end as usize].to_string(),
                Value::Missing => "?".to_string(),
            };
            shown.push(format!("{}{}{value}", if word.comma { "," } else { "" }, word.address as char));
        }
        for fault in &block.faults {
            shown.push(format!("!{:?}@{}..{}", fault.kind, fault.start, fault.end));
        }
        shown.join(" ")
    }

    #[test]
    fn dense_words_need_no_blanks() {
        assert_eq!(words("G00X1.5Z.05M08"), "G0e-0 X15e-1. Z5e-2. M8e-0");
        assert_eq!(words("n10 g 71 u2. r0.5"), "N10e-0 G71e-0 U2e-0. R5e-1.");
        assert_eq!(words("X5.F.01,R-2."), "X5e-0. F1e-2. ,R-2e-0.");
    }

    #[test]
    fn what_was_typed_is_kept() {
        assert_eq!(words("X100"), "X100e-0");
        assert_eq!(words("X100."), "X100e-0.");
        assert_eq!(words("X-0 Z+1.500"), "X0e-0 Z1500e-3.");
    }

    #[test]
    fn comments_stand_anywhere_and_may_lack_their_end() {
        assert_eq!(words("G1(FEED)X1.(TO)Z2."), "G1e-0 X1e-0. Z2e-0.");
        assert_eq!(words("X1. (no end"), "X1e-0. !UnclosedComment@4..11");
        assert_eq!(words("(a (b) c) X1."), "X1e-0. !NestedComment@0..9");
    }

    #[test]
    fn behind_the_end_of_block_is_a_block_or_a_remark() {
        let mut block = Block::new();
        let line = b"G0 X1.;Z2.;quickly now";
        let next = scan_block(line, 0, &mut block);
        assert_eq!((next, block.words.len()), (7, 2));
        let next = scan_block(line, next, &mut block);
        assert_eq!(next, line.len());
        assert_eq!(block.faults[0].kind, FaultKind::TextAfterSemicolon);
        assert_eq!(words("G0 X1.；快速"), "G0e-0 X1e-0. !FullWidth@6..9 !TextAfterSemicolon@9..15");
    }

    #[test]
    fn full_width_brackets_are_read_as_comments() {
        assert_eq!(words("G0（定位）X2."), "G0e-0 X2e-0. !FullWidth@2..5");
        let mut block = Block::new();
        // The same in GBK: A3 A8 … A3 A9.
        scan_block(b"G0\xa3\xa8\xb6\xa8\xa3\xa9X2.", 0, &mut block);
        assert_eq!(block.words.len(), 2);
    }

    #[test]
    fn mistakes_have_a_place_and_never_stop_the_reader() {
        assert_eq!(words("GO X1."), "G? O? X1e-0. !LetterO@0..2 !AddressWithoutValue@1..2");
        assert_eq!(words("X1.2.3 Z1"), "X? Z1e-0 !TwoPoints@0..6");
        assert_eq!(words("S8O0 M3"), "S? M3e-0 !LetterO@0..4");
        assert_eq!(words("M99O0810"), "M99e-0 O810e-0");
        assert_eq!(words("X12,5"), "X? !DecimalComma@0..5");
        assert_eq!(words("X--1"), "X? !TwoSigns@0..4");
        assert_eq!(words("X Z1."), "X? Z1e-0. !AddressWithoutValue@0..1");
        assert_eq!(words("G1 $$ X1."), "G1e-0 X1e-0. !NotAWord@3..5");
        assert_eq!(words("X1234567890123456789."), "X? !NumberTooLong@0..21");
    }

    #[test]
    fn skip_marks_at_the_head_and_inside() {
        let mut block = Block::new();
        scan_block(b"/2/3 N5 G1 X1.", 0, &mut block);
        assert_eq!(block.skip.whole, 0b1100);
        scan_block(b"Z-1.0/M08", 0, &mut block);
        assert_eq!((block.skip.whole, block.skip.rest, block.skip.words_kept), (0, 0b10, 1));
        block.truncate(1);
        assert!(block.has(b'Z') && !block.has(b'M'));
    }

    #[test]
    fn macro_statements_and_expressions_are_found() {
        let mut block = Block::new();
        let line = b"N5 IF[#103GT0]GOTO80 (jump)";
        scan_block(line, 0, &mut block);
        assert_eq!(block.macro_statement, Some((3, 20)));
        scan_block(b"#100=34(AXIS max#)", 0, &mut block);
        assert_eq!(block.macro_statement, Some((0, 7)));
        assert_eq!(words("X-#1 Z[#2+1] F##3"), "X-#1 Z[#2+1] F##3");
        assert_eq!(words("X[#2"), "X[#2 !StrayBracket@1..4");
    }

    #[test]
    fn an_axis_by_its_number_is_one_word() {
        assert_eq!(words("G0 AX[#1]=-5. Z2."), "G0e-0 A-5e-0. Z2e-0. !IndirectAxis@3..13");
        assert_eq!(words("ax[1] = [#2+1]"), "A[#2+1] !IndirectAxis@0..14");
        assert_eq!(words("AX[1]= F1"), "A? F1e-0 !AddressWithoutValue@0..6 !IndirectAxis@0..6");
        assert_eq!(words("AX[1] F1"), "A? X[1] F1e-0 !AddressWithoutValue@0..1");
    }

    #[test]
    fn program_numbers_names_and_tape_marks() {
        assert_eq!(words(":0100"), "O100e-0");
        let mut block = Block::new();
        scan_block(b"O<SHAFT-2>", 0, &mut block);
        assert_eq!(block.extents[0].kind, ExtentKind::Name);
        scan_block(b"% leader text", 0, &mut block);
        assert!(block.is_percent);
        scan_block(b"\x1aG0", 0, &mut block);
        assert!(block.is_end_of_text && block.words.is_empty());
    }
}
