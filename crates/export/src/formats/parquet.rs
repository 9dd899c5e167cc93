//! Tables for data programs (Apache Parquet): columns of one form, row group by row group.
//!
//! In: cells, row by row, in the order of the columns. Out: bytes that may be written as they come; nothing is held back
//! but the rows of one group ([`GROUP_ROWS`]) and some hundred bytes for each group that is over.
//!
//! Written by hand: a table of numbers needs plain pages without compression, which is a small part of the format. Words
//! are a dictionary and runs; numbers are little-endian doubles; the description at the end is Thrift's compact protocol.

/// Rows of a group: what is held in memory.
pub const GROUP_ROWS: usize = 65_536;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Numbers.
    Number,
    /// Numbers, some of them missing.
    OptionalNumber,
    /// Whole numbers.
    Integer,
    /// One of these words.
    Word(&'static [&'static str]),
}

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: ColumnKind,
}

/// The cells of a column in the group that is being filled.
#[derive(Clone, Debug, Default)]
struct Cells {
    values: Vec<u8>,
    /// Runs of equal words, or of numbers that are there (1) or missing (0).
    runs: Vec<(u32, u32)>,
}

impl Cells {
    fn count_run(&mut self, value: u32) {
        match self.runs.last_mut() {
            Some((last, count)) if *last == value => *count += 1,
            _ => self.runs.push((value, 1)),
        }
    }
}

/// Where a column of a group lies in the file.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    dictionary_at: Option<u64>,
    data_at: u64,
    bytes: u64,
}

#[derive(Clone, Debug)]
struct Group {
    rows: usize,
    chunks: Vec<Chunk>,
}

/// Writes one table.
#[derive(Clone, Debug)]
pub struct ParquetTable {
    columns: Vec<Column>,
    cells: Vec<Cells>,
    /// The column of the next cell.
    next: usize,
    rows: usize,
    written: u64,
    groups: Vec<Group>,
}

// The numbers of the format.
const MAGIC: &[u8; 4] = b"PAR1";
const TYPE_INT32: i64 = 1;
const TYPE_DOUBLE: i64 = 5;
const TYPE_BYTES: i64 = 6;
const REQUIRED: i64 = 0;
const OPTIONAL: i64 = 1;
const CONVERTED_UTF8: i64 = 0;
const PLAIN: i64 = 0;
const RLE: i64 = 3;
const RLE_DICTIONARY: i64 = 8;
const UNCOMPRESSED: i64 = 0;
const DATA_PAGE: i64 = 0;
const DICTIONARY_PAGE: i64 = 2;

impl ParquetTable {
    /// An empty table; `out` gets its head.
    pub fn new(columns: &[Column], out: &mut Vec<u8>) -> Self {
        out.extend_from_slice(MAGIC);
        Self {
            columns: columns.to_vec(),
            cells: vec![Cells::default(); columns.len()],
            next: 0,
            rows: 0,
            written: MAGIC.len() as u64,
            groups: Vec::new(),
        }
    }

    /// The next cell is a number, or is missing.
    pub fn number(&mut self, value: Option<f64>) {
        let is_optional = self.columns[self.next].kind == ColumnKind::OptionalNumber;
        let cells = &mut self.cells[self.next];
        if is_optional {
            cells.count_run(u32::from(value.is_some()));
        }
        if let Some(value) = value.or((!is_optional).then_some(f64::NAN)) {
            cells.values.extend_from_slice(&value.to_le_bytes());
        }
        self.end_cell();
    }

    /// The next cell is a whole number.
    pub fn integer(&mut self, value: i32) {
        self.cells[self.next].values.extend_from_slice(&value.to_le_bytes());
        self.end_cell();
    }

    /// The next cell is a word of its column, by number.
    pub fn word(&mut self, index: u32) {
        self.cells[self.next].count_run(index);
        self.end_cell();
    }

    fn end_cell(&mut self) {
        self.next += 1;
        if self.next == self.columns.len() {
            (self.next, self.rows) = (0, self.rows + 1);
        }
    }

    /// Gives out the group when it is full.
    pub fn flush_full(&mut self, out: &mut Vec<u8>) {
        if self.rows >= GROUP_ROWS {
            self.flush(out);
        }
    }

    /// Ends the table.
    pub fn finish(mut self, out: &mut Vec<u8>) {
        self.flush(out);
        let before = out.len();
        self.describe(out);
        let length = (out.len() - before) as u32;
        out.extend_from_slice(&length.to_le_bytes());
        out.extend_from_slice(MAGIC);
    }

    fn flush(&mut self, out: &mut Vec<u8>) {
        if self.rows == 0 {
            return;
        }
        let begin = out.len();
        let start = self.written;
        let at = |out: &Vec<u8>| start + (out.len() - begin) as u64;
        let mut chunks = Vec::with_capacity(self.columns.len());
        for (column, cells) in self.columns.iter().zip(&mut self.cells) {
            let chunk_at = at(out);
            let mut dictionary_at = None;
            let mut page = Vec::new();
            match column.kind {
                ColumnKind::Number | ColumnKind::Integer => page.append(&mut cells.values),
                ColumnKind::OptionalNumber => {
                    let levels = runs(&cells.runs, 1);
                    page.extend_from_slice(&(levels.len() as u32).to_le_bytes());
                    page.extend_from_slice(&levels);
                    page.append(&mut cells.values);
                }
                ColumnKind::Word(words) => {
                    dictionary_at = Some(chunk_at);
                    let plain: Vec<u8> = words
                        .iter()
                        .flat_map(|word| (word.len() as u32).to_le_bytes().into_iter().chain(word.bytes()))
                        .collect();
                    page_head(out, DICTIONARY_PAGE, plain.len(), words.len(), PLAIN);
                    out.extend_from_slice(&plain);
                    let bits = usize::BITS - words.len().saturating_sub(1).leading_zeros();
                    page.push(bits as u8);
                    page.extend_from_slice(&runs(&cells.runs, bits));
                }
            }
            cells.values.clear();
            cells.runs.clear();
            let data_at = at(out);
            page_head(out, DATA_PAGE, page.len(), self.rows, column.encoding());
            out.extend_from_slice(&page);
            chunks.push(Chunk { dictionary_at, data_at, bytes: at(out) - chunk_at });
        }
        self.written = at(out);
        self.groups.push(Group { rows: self.rows, chunks });
        self.rows = 0;
    }

    /// The description of all columns and groups.
    fn describe(&self, out: &mut Vec<u8>) {
        let rows: usize = self.groups.iter().map(|group| group.rows).sum();
        let mut file = Struct::begin(out);
        file.integer(1, I32, 1);
        file.list(2, STRUCT, self.columns.len() + 1);
        let mut root = Struct::begin(file.out);
        root.text(4, "table");
        root.integer(5, I32, self.columns.len() as i64);
        root.end();
        for column in &self.columns {
            let mut element = Struct::begin(file.out);
            element.integer(1, I32, column.type_number());
            element.integer(
                3,
                I32,
                if column.kind == ColumnKind::OptionalNumber { OPTIONAL } else { REQUIRED },
            );
            element.text(4, column.name);
            if matches!(column.kind, ColumnKind::Word(_)) {
                element.integer(6, I32, CONVERTED_UTF8);
            }
            element.end();
        }
        file.integer(3, I64, rows as i64);
        file.list(4, STRUCT, self.groups.len());
        for group in &self.groups {
            let mut of_group = Struct::begin(file.out);
            of_group.list(1, STRUCT, self.columns.len());
            for (column, chunk) in self.columns.iter().zip(&group.chunks) {
                let mut of_chunk = Struct::begin(of_group.out);
                of_chunk.integer(2, I64, chunk.dictionary_at.unwrap_or(chunk.data_at) as i64);
                of_chunk.field(3, STRUCT);
                let mut meta = Struct::begin(of_chunk.out);
                meta.integer(1, I32, column.type_number());
                meta.list(2, I32, 2);
                write_zigzag(meta.out, column.encoding());
                write_zigzag(meta.out, if chunk.dictionary_at.is_some() { PLAIN } else { RLE });
                meta.list(3, BINARY, 1);
                write_text(meta.out, column.name);
                meta.integer(4, I32, UNCOMPRESSED);
                meta.integer(5, I64, group.rows as i64);
                meta.integer(6, I64, chunk.bytes as i64);
                meta.integer(7, I64, chunk.bytes as i64);
                meta.integer(9, I64, chunk.data_at as i64);
                if let Some(at) = chunk.dictionary_at {
                    meta.integer(11, I64, at as i64);
                }
                meta.end();
                of_chunk.end();
            }
            of_group.integer(2, I64, group.chunks.iter().map(|chunk| chunk.bytes as i64).sum());
            of_group.integer(3, I64, group.rows as i64);
            of_group.end();
        }
        file.text(6, "turnwright");
        file.end();
    }
}

impl Column {
    fn type_number(&self) -> i64 {
        match self.kind {
            ColumnKind::Number | ColumnKind::OptionalNumber => TYPE_DOUBLE,
            ColumnKind::Integer => TYPE_INT32,
            ColumnKind::Word(_) => TYPE_BYTES,
        }
    }

    fn encoding(&self) -> i64 {
        if matches!(self.kind, ColumnKind::Word(_)) { RLE_DICTIONARY } else { PLAIN }
    }
}

/// Runs of small numbers of so many bits each.
fn runs(runs: &[(u32, u32)], bits: u32) -> Vec<u8> {
    let mut out = Vec::new();
    for (value, count) in runs {
        write_varint(&mut out, u64::from(*count) << 1);
        out.extend_from_slice(&value.to_le_bytes()[..bits.div_ceil(8) as usize]);
    }
    out
}

fn page_head(out: &mut Vec<u8>, kind: i64, bytes: usize, values: usize, encoding: i64) {
    let mut page = Struct::begin(out);
    page.integer(1, I32, kind);
    page.integer(2, I32, bytes as i64);
    page.integer(3, I32, bytes as i64);
    page.field(if kind == DATA_PAGE { 5 } else { 7 }, STRUCT);
    let mut head = Struct::begin(page.out);
    head.integer(1, I32, values as i64);
    head.integer(2, I32, encoding);
    if kind == DATA_PAGE {
        head.integer(3, I32, RLE);
        head.integer(4, I32, RLE);
    }
    head.end();
    page.end();
}

// Types of Thrift's compact protocol.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A Thrift structure being written: its fields in rising order.
struct Struct<'a> {
    out: &'a mut Vec<u8>,
    last: u8,
}

impl<'a> Struct<'a> {
    fn begin(out: &'a mut Vec<u8>) -> Self {
        Self { out, last: 0 }
    }

    fn field(&mut self, number: u8, kind: u8) {
        self.out.push((number - self.last) << 4 | kind);
        self.last = number;
    }

    fn integer(&mut self, number: u8, kind: u8, value: i64) {
        self.field(number, kind);
        write_zigzag(self.out, value);
    }

    fn text(&mut self, number: u8, text: &str) {
        self.field(number, BINARY);
        write_text(self.out, text);
    }

    /// The head of a list; its elements follow.
    fn list(&mut self, number: u8, kind: u8, count: usize) {
        self.field(number, LIST);
        if count < 15 {
            self.out.push((count as u8) << 4 | kind);
        } else {
            self.out.push(0xF0 | kind);
            write_varint(self.out, count as u64);
        }
    }

    fn end(self) {
        self.out.push(0);
    }
}

fn write_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn write_zigzag(out: &mut Vec<u8>, value: i64) {
    write_varint(out, (value << 1 ^ value >> 63) as u64);
}

fn write_text(out: &mut Vec<u8>, text: &str) {
    write_varint(out, text.len() as u64);
    out.extend_from_slice(text.as_bytes());
}
