//! Columns of text that line up, also where a character is two columns wide.

use unicode_width::UnicodeWidthStr;

/// Which side a column lines up on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A table of cells.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    sides: Vec<Side>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with a side for each column.
    pub(crate) fn new(sides: &[Side]) -> Self {
        Self { sides: sides.to_vec(), rows: Vec::new() }
    }

    /// Adds a row; missing cells are empty.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The rows, each indented and with a line end. The first row is the heading when `has_heading`.
    pub(crate) fn text(&self, indent: usize, has_heading: bool) -> String {
        let widths: Vec<usize> = (0..self.sides.len())
            .map(|column| {
                self.rows.iter().map(|row| row.get(column).map_or(0, |cell| cell.width())).max().unwrap_or(0)
            })
            .collect();
        let mut out = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            let mut line = " ".repeat(indent);
            for (column, side) in self.sides.iter().enumerate() {
                let cell = row.get(column).map_or("", String::as_str);
                let space = " ".repeat(widths[column] - cell.width());
                let parts = if *side == Side::Left { [cell, &space] } else { [space.as_str(), cell] };
                line.push_str(&parts.concat());
                line.push_str("  ");
            }
            let line = line.trim_end();
            out.push_str(&if index == 0 && has_heading { heading(line) } else { line.to_string() });
            out.push('\n');
        }
        out
    }
}

/// Text that stands out where colours are shown.
pub(crate) fn heading(text: &str) -> String {
    let bold = anstyle::Style::new().bold();
    format!("{bold}{text}{bold:#}")
}

/// Names and values, the values lined up; a value of several lines stays behind its name.
pub(crate) fn facts(rows: &[(String, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.width()).max().unwrap_or(0);
    let mut out = String::new();
    for (name, value) in rows {
        for (index, line) in value.lines().enumerate() {
            let shown = if index == 0 { name.as_str() } else { "" };
            let space = " ".repeat(width - shown.width());
            let shown = if shown.is_empty() { String::new() } else { heading(shown) };
            out.push_str(&format!("{shown}{space}  {line}\n"));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_characters_take_two_columns() {
        let mut table = Table::new(&[Side::Left, Side::Right]);
        table.row(["车刀", "1"]);
        table.row(["abcdef", "20"]);
        assert_eq!(table.text(1, false), " 车刀     1\n abcdef  20\n");
    }
}
