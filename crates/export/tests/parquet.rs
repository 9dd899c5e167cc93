//! Tables in Parquet, read back by a reader written from the format's description. pyarrow and hyparquet, which know
//! nothing of this program, read them too: the second in `tests-browser/`.

use std::collections::BTreeMap;

use turnwright_export::formats::parquet::{Column, ColumnKind, GROUP_ROWS, ParquetTable};

/// A value of Thrift's compact protocol.
#[derive(Debug)]
enum Value {
    Integer(i64),
    Text(String),
    List(Vec<Value>),
    Struct(BTreeMap<u8, Value>),
}

impl Value {
    fn get(&self, field: u8) -> &Self {
        match self {
            Self::Struct(fields) => &fields[&field],
            other => panic!("{other:?} has no fields"),
        }
    }

    fn has(&self, field: u8) -> bool {
        matches!(self, Self::Struct(fields) if fields.contains_key(&field))
    }

    fn integer(&self) -> i64 {
        match self {
            Self::Integer(value) => *value,
            other => panic!("{other:?} is no integer"),
        }
    }

    fn list(&self) -> &[Self] {
        match self {
            Self::List(values) => values,
            other => panic!("{other:?} is no list"),
        }
    }
}

#[derive(Debug)]
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn byte(&mut self) -> u8 {
        self.at += 1;
        self.bytes[self.at - 1]
    }

    fn varint(&mut self) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let byte = self.byte();
            value |= u64::from(byte & 0x7F) << shift;
            shift += 7;
            if byte < 0x80 {
                return value;
            }
        }
    }

    fn value(&mut self, kind: u8) -> Value {
        match kind {
            5 | 6 => {
                let value = self.varint();
                Value::Integer((value >> 1) as i64 ^ -((value & 1) as i64))
            }
            8 => {
                let length = self.varint() as usize;
                self.at += length;
                let bytes = &self.bytes[self.at - length..self.at];
                Value::Text(String::from_utf8(bytes.to_vec()).expect("UTF-8"))
            }
            9 => {
                let head = self.byte();
                let count = if head >> 4 == 15 { self.varint() } else { u64::from(head >> 4) };
                Value::List((0..count).map(|_| self.value(head & 15)).collect())
            }
            12 => {
                let (mut fields, mut number) = (BTreeMap::new(), 0);
                loop {
                    let head = self.byte();
                    if head == 0 {
                        return Value::Struct(fields);
                    }
                    number += head >> 4;
                    fields.insert(number, self.value(head & 15));
                }
            }
            kind => panic!("type {kind}"),
        }
    }

    /// A page: its values and its bytes.
    fn page(&mut self) -> (Value, Reader<'_>) {
        let head = self.value(12);
        let length = head.get(3).integer() as usize;
        assert_eq!(head.get(2).integer(), length as i64);
        let bytes = &self.bytes[self.at..self.at + length];
        (head, Reader { bytes, at: 0 })
    }

    fn word(&mut self) -> u32 {
        self.at += 4;
        u32::from_le_bytes(self.bytes[self.at - 4..self.at].try_into().expect("four"))
    }

    fn double(&mut self) -> f64 {
        self.at += 8;
        f64::from_le_bytes(self.bytes[self.at - 8..self.at].try_into().expect("eight"))
    }

    /// So many small numbers in runs of a byte.
    fn runs(&mut self, count: usize) -> Vec<u8> {
        let mut values = Vec::new();
        while values.len() < count {
            let head = self.varint();
            assert_eq!(head & 1, 0, "a run");
            let value = self.byte();
            values.extend((0..head >> 1).map(|_| value));
        }
        values
    }
}

const WORDS: [&str; 3] = ["cutting", "rapid", "tool-change"];
const COLUMNS: [Column; 4] = [
    Column { name: "time_s", kind: ColumnKind::Number },
    Column { name: "c_deg", kind: ColumnKind::OptionalNumber },
    Column { name: "kind", kind: ColumnKind::Word(&WORDS) },
    Column { name: "line", kind: ColumnKind::Integer },
];

/// What a row holds.
fn row(number: usize) -> (f64, Option<f64>, &'static str, i32) {
    let time = number as f64 / 1000.0;
    let c = (number % 1000 < 700).then_some(number as f64 * 0.25 - 90.0);
    (time, c, WORDS[number / 300 % 3], number as i32 / 7)
}

fn table(rows: usize) -> Vec<u8> {
    let mut out = Vec::new();
    let mut table = ParquetTable::new(&COLUMNS, &mut out);
    for number in 0..rows {
        let (time, c, kind, line) = row(number);
        table.number(Some(time));
        table.number(c);
        table.word(WORDS.iter().position(|word| *word == kind).expect("a word") as u32);
        table.integer(line);
        table.flush_full(&mut out);
    }
    table.finish(&mut out);
    out
}

/// The description at the end.
fn description(file: &[u8]) -> Value {
    assert!(file.starts_with(b"PAR1") && file.ends_with(b"PAR1"));
    let tail = file.len() - 8;
    let length = u32::from_le_bytes(file[tail..tail + 4].try_into().expect("four")) as usize;
    let mut reader = Reader { bytes: &file[tail - length..tail], at: 0 };
    let value = reader.value(12);
    assert_eq!(reader.at, length);
    value
}

#[test]
fn every_cell_comes_back_from_every_group() {
    // A group that is full to the last row, another, and a third of one row.
    for rows in [1, GROUP_ROWS, 2 * GROUP_ROWS + 1] {
        let file = table(rows);
        let description = description(&file);
        assert_eq!(description.get(3).integer(), rows as i64);
        let schema = description.get(2).list();
        assert_eq!((schema.len(), schema[0].get(5).integer()), (5, 4));
        for (element, column) in schema[1..].iter().zip(&COLUMNS) {
            assert!(matches!(element.get(4), Value::Text(name) if name == column.name));
        }
        let mut number = 0;
        for group in description.get(4).list() {
            let count = group.get(3).integer() as usize;
            let chunks: Vec<&Value> = group.get(1).list().iter().map(|chunk| chunk.get(3)).collect();
            let page_at = |chunk: &Value| chunk.get(9).integer() as usize;
            let mut readers: Vec<Reader<'_>> =
                chunks.iter().map(|chunk| Reader { bytes: &file, at: page_at(chunk) }).collect();
            let pages: Vec<(Value, Reader<'_>)> = readers.iter_mut().map(Reader::page).collect();
            let [(_, mut times), (_, mut angles), (_, mut kinds), (_, mut lines)]: [(Value, Reader<'_>); 4] =
                pages.try_into().expect("four pages");
            let levels_length = angles.word() as usize;
            let there = angles.runs(count);
            assert_eq!(angles.at, 4 + levels_length);
            assert!(chunks[2].has(11), "words have a dictionary");
            let mut dictionary = Reader { bytes: &file, at: chunks[2].get(11).integer() as usize };
            let (head, mut dictionary) = dictionary.page();
            let words: Vec<String> = (0..head.get(7).get(1).integer())
                .map(|_| {
                    let length = dictionary.word() as usize;
                    dictionary.at += length;
                    String::from_utf8(dictionary.bytes[dictionary.at - length..dictionary.at].to_vec())
                        .expect("UTF-8")
                })
                .collect();
            assert_eq!(kinds.byte(), 2, "bits for three words");
            let kinds = kinds.runs(count);
            for index in 0..count {
                let (time, c, kind, line) = row(number);
                assert_eq!(times.double(), time);
                assert_eq!((there[index] == 1).then(|| angles.double()), c);
                assert_eq!(words[usize::from(kinds[index])], kind);
                assert_eq!(lines.word() as i32, line);
                number += 1;
            }
            assert_eq!(angles.at, angles.bytes.len());
        }
        assert_eq!(number, rows);
    }
}

#[test]
fn a_table_without_rows_has_its_columns() {
    let description = description(&table(0));
    assert_eq!((description.get(3).integer(), description.get(4).list().len()), (0, 0));
    assert_eq!(description.get(2).list().len(), 5);
}
