//! [`TextTable`]: columns under their headings.

use std::fmt::Write;

/// The 8-colour codes that every terminal knows.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Colour {
    Plain,
    Green,
    Yellow,
    Red,
    Grey,
}

impl Colour {
    fn code(self) -> &'static str {
        match self {
            Self::Plain => "0",
            Self::Green => "32",
            Self::Yellow => "33",
            Self::Red => "31",
            Self::Grey => "90",
        }
    }
}

/// Right-aligned columns of numbers, and a last column of words, left-aligned.
pub(crate) struct TextTable {
    colours: bool,
    rows: Vec<(Vec<String>, Colour)>,
}

impl TextTable {
    pub(crate) fn new<const N: usize>(headings: [&str; N], colours: bool) -> Self {
        Self { colours, rows: vec![(headings.map(String::from).into(), Colour::Plain)] }
    }

    /// Adds a row. The colour is that of its last cell.
    pub(crate) fn row<const N: usize>(&mut self, cells: [String; N], colour: Colour) {
        self.rows.push((cells.into(), colour));
    }

    pub(crate) fn write_to(&self, text: &mut String) {
        let widths = self.widths();
        for (cells, colour) in &self.rows {
            let mut line = String::new();
            let Some((last, others)) = cells.split_last() else { continue };
            for (cell, width) in others.iter().zip(&widths) {
                let _ = write!(line, "{cell:>width$}  ");
            }
            if self.colours && *colour != Colour::Plain {
                let _ = write!(line, "\x1b[{}m{last}\x1b[0m", colour.code());
            } else {
                line.push_str(last);
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
    }

    /// Counts characters, not bytes, since cells contain ± and ∞.
    fn widths(&self) -> Vec<usize> {
        let columns = self.rows.first().map_or(0, |(cells, _)| cells.len());
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|(cells, _)| cells.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        (0..columns).map(width).collect()
    }
}
