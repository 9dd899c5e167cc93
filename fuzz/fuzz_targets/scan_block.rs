//! Any line: reading gives blocks that go forward and words that lie in the line; the token table loses nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use turnwright_syntax::{Block, Tree, scan_block};

fuzz_target!(|line: &[u8]| {
    let mut block = Block::new();
    let mut from = 0;
    while from < line.len() {
        let next = scan_block(line, from, &mut block);
        assert!(next > from && next <= line.len());
        from = next;
    }
    assert_eq!(Tree::parse(line).print(), line);
});
