//! [`TableFile`]: a CSV file with named columns. Every error names the line of the file, the column, its value and what
//! would be right.

use anyhow::{Error, Result, anyhow, bail};

use super::bounds::Bounds;
use super::nearest::{list, nearest};

/// The columns that a header may name, and those that it must.
pub(crate) struct Columns {
    pub(crate) known: &'static [&'static str],
    pub(crate) required: &'static [&'static str],
}

pub(crate) struct TableFile<'a> {
    text: &'a str,
    /// Line of the header, from 1.
    header_at: usize,
    header: Header,
}

impl<'a> TableFile<'a> {
    pub(crate) fn parse(text: &'a str, columns: &Columns) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let Some((header_at, line)) = lines(text).next() else {
            bail!("the file is empty: it must begin with a header such as `{}`", columns.required.join(","));
        };
        let header = Header::parse(line, columns).map_err(|error| anyhow!("line {header_at}: {error}"))?;
        Ok(Self { text, header_at, header })
    }

    pub(crate) fn has(&self, column: &str) -> bool {
        self.header.position(column).is_some()
    }

    pub(crate) fn records(&self) -> impl Iterator<Item = Result<Record<'_>>> {
        let records = lines(self.text).skip_while(|(at, _)| *at <= self.header_at);
        records.map(|(at, line)| Record::split(at, line, &self.header))
    }
}

/// The lines of a text that are not blank, with their numbers from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter(|(_, line)| !is_blank(line))
}

/// Spreadsheets write a blank line as separators alone.
fn is_blank(line: &str) -> bool {
    line.chars().all(|c| c == ',' || c.is_whitespace())
}

/// No value may contain a comma, so that quotes have no meaning.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|cell| cell.trim().trim_matches('"').trim())
}

/// The columns in their order.
struct Header {
    names: Vec<&'static str>,
}

impl Header {
    fn parse(line: &str, columns: &Columns) -> Result<Self> {
        let mut names = Vec::new();
        for name in cells(line) {
            let Some(known) = columns.known.iter().copied().find(|column| *column == name) else {
                return Err(unknown_column(name, line, columns));
            };
            if names.contains(&known) {
                bail!("column `{known}` appears twice: each must appear once");
            }
            names.push(known);
        }
        match columns.required.iter().find(|name| !names.contains(name)) {
            Some(missing) => bail!("column `{missing}` is missing: the header must name {}", list(columns.required)),
            None => Ok(Self { names }),
        }
    }

    fn position(&self, column: &str) -> Option<usize> {
        self.names.iter().position(|name| *name == column)
    }
}

fn unknown_column(name: &str, line: &str, columns: &Columns) -> Error {
    if !line.contains(',') && line.contains([';', '\t']) {
        return anyhow!("the header is `{}`: columns must be separated by commas", line.trim());
    }
    if name.parse::<f64>().is_ok() {
        let example = columns.required.join(",");
        return anyhow!("the header begins with `{name}`: the first line must name the columns, such as `{example}`");
    }
    match nearest(name, columns.known) {
        Some(nearest) => anyhow!("unknown column `{name}`; the nearest is `{nearest}`"),
        None => anyhow!("unknown column `{name}`; the columns are {}", list(columns.known)),
    }
}

/// A line of the file, split into cells.
pub(crate) struct Record<'a> {
    /// Its number, from 1.
    pub(crate) at: usize,
    header: &'a Header,
    cells: Vec<&'a str>,
}

impl<'a> Record<'a> {
    fn split(at: usize, line: &'a str, header: &'a Header) -> Result<Self> {
        let cells: Vec<_> = cells(line).collect();
        let (found, named) = (cells.len(), header.names.len());
        if found != named {
            bail!("line {at}: {found} values, but must be {named}, one for each column of the header");
        }
        Ok(Self { at, header, cells })
    }

    /// `None` where there is no such column or the cell is empty.
    pub(crate) fn cell(&self, column: &str) -> Option<&'a str> {
        let cell = self.cells.get(self.header.position(column)?)?;
        (!cell.is_empty()).then_some(cell)
    }

    pub(crate) fn refuse(&self, column: &str, expected: impl std::fmt::Display) -> Error {
        let at = self.at;
        match self.cell(column) {
            Some(cell) => anyhow!("line {at}: `{column}` is `{cell}`, but must be {expected}"),
            None => anyhow!("line {at}: `{column}` is empty, but must be {expected}"),
        }
    }

    pub(crate) fn number(&self, column: &str, bounds: Bounds) -> Result<Option<f64>> {
        let Some(cell) = self.cell(column) else { return Ok(None) };
        let number = cell.parse().ok().filter(|number| bounds.contain(*number));
        number.map(Some).ok_or_else(|| self.refuse(column, bounds))
    }

    pub(crate) fn required(&self, column: &str, bounds: Bounds) -> Result<f64> {
        self.number(column, bounds)?.ok_or_else(|| self.refuse(column, bounds))
    }

    /// A whole number; tables that went through floating point write `3.0`.
    pub(crate) fn integer(&self, column: &str) -> Result<Option<i64>> {
        const EXACT: f64 = (1_u64 << 53) as f64;
        let Some(cell) = self.cell(column) else { return Ok(None) };
        if let Ok(integer) = cell.parse() {
            return Ok(Some(integer));
        }
        let number: Option<f64> =
            cell.parse().ok().filter(|number: &f64| number.fract() == 0.0 && number.abs() <= EXACT);
        number.map(|number| Some(number as i64)).ok_or_else(|| self.refuse(column, "a whole number"))
    }
}
