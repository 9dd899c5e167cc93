//! Program text to words, without losing a byte and without knowing what a code means.
//!
//! In: any bytes. Out: [`Block`]s of [`Word`]s with the numbers as they were typed (`X100` is not `X100.`),
//! faults with their place, and the lossless token table [`Tree`], whose print is the text again.
//! Two readers use the same scanner: the interpreter takes one block at a time into a reused [`Block`], the
//! tree keeps every token for editors and formatters.
//!
//! Invariants: scanning never fails and never stops before the end; every byte belongs to exactly one token;
//! the tree takes at most three times the size of its source, the source included.
//!
//! Deliberately not here: the meaning of any code, units, decimal rules, alarm numbers.
//!
//! Source: program text of both families (tape format, address words, comments, block skip, custom macro
//! statements) and what files from real machines look like.

mod block;
mod expression;
mod lines;
mod number;
mod scan;
mod short;
mod tree;

pub use block::{Block, Extent, ExtentKind, Fault, FaultKind, Skip, Value, Word};
pub use expression::{
    BinaryOperator, Comparison, EXPRESSION_DEPTH_MAX, Expected, Expression, ExpressionFault, Function, Node,
    Statement, parse_expression, parse_statement,
};
pub use lines::{LineEnd, find_line_end};
pub use number::Decimal;
pub use scan::{BLOCK_WORDS_MAX, scan_block};
pub use short::ShortLine;
pub use tree::{Token, TokenKind, Tree};
