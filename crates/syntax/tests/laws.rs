//! Laws of the reader: it never fails, forgets nothing, and stays small.

use turnwright_dice::Dice;
use turnwright_syntax::{Block, Tree, scan_block};

const SOUP: [&[u8]; 34] = [
    b"G",
    b"X",
    b"O",
    b"N",
    b"1",
    b"0",
    b".",
    b"-",
    b"#",
    b"[",
    b"]",
    b"(",
    b")",
    b";",
    b"/",
    b"/2",
    b",",
    b"%",
    b"<",
    b">",
    b"\n",
    b"\r",
    b"\r\n",
    b" ",
    b"IF",
    b"GOTO",
    b"\x1a",
    b"\xef\xbb\xbf",
    "；".as_bytes(),
    "（".as_bytes(),
    b"\xa3\xbb",
    b"\xa3\xa8",
    b"\xff",
    b"G71U2.R.5",
];

#[test]
fn print_of_parse_is_the_text_for_random_bytes_and_token_soup() {
    let mut dice = Dice::new(0x5eed_0001);
    for round in 0..4_000 {
        let mut text = Vec::new();
        for _ in 0..dice.roll() % 60 {
            if round % 2 == 0 {
                text.push(dice.roll() as u8);
            } else {
                text.extend_from_slice(SOUP[(dice.roll() % SOUP.len() as u64) as usize]);
            }
        }
        let tree = Tree::parse(text.clone());
        assert_eq!(tree.print(), text, "round {round}: {:?}", String::from_utf8_lossy(&text));
    }
}

#[test]
fn the_tree_takes_at_most_four_times_the_source() {
    let dense = b"G1X1Z2F3\n".repeat(20_000);
    let worst = b"(\n".repeat(50_000);
    let marks = b";".repeat(60_000);
    for text in [dense, worst, marks] {
        let tree = Tree::parse(text.clone());
        assert!(tree.memory_bytes() <= 4 * text.len(), "{} for {}", tree.memory_bytes(), text.len());
    }
}

#[test]
fn every_word_lies_inside_its_line_and_in_order() {
    let mut dice = Dice::new(0x5eed_0002);
    let mut block = Block::new();
    for _ in 0..4_000 {
        let mut line = Vec::new();
        for _ in 0..dice.roll() % 40 {
            let part = SOUP[(dice.roll() % SOUP.len() as u64) as usize];
            if !part.contains(&b'\n') && !part.contains(&b'\r') {
                line.extend_from_slice(part);
            }
        }
        let mut from = 0;
        while from < line.len() {
            let next = scan_block(&line, from, &mut block);
            assert!(next > from, "no progress in {:?}", String::from_utf8_lossy(&line));
            let mut end = from as u32;
            for word in &block.words {
                assert!(word.start >= end && word.end > word.start && word.end as usize <= next);
                end = word.end;
            }
            from = next;
        }
    }
}

#[test]
fn very_long_lines_are_read_once() {
    // Each of these made a scanner quadratic, or its stack deep, while it was written.
    for part in [";", "；", "；X1", "<", "[", "(", "X1;", "()%", "X1", "X#", "\u{ffff}", "/", ",R1"] {
        let text = part.repeat(200_000 / part.len());
        assert_eq!(Tree::parse(text.as_bytes()).print(), text.as_bytes(), "{part}");
    }
}
