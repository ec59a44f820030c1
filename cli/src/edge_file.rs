//! Edge points from CSV. Every error names the line of the file, the column, its value and what would be right.

use anyhow::{Error, Result, anyhow, bail};
use shutter_range::{Edge, Polarity};

use crate::bounds::Bounds;
use crate::nearest::nearest;
use crate::setup::{SIGMA_PX, SetupFile};

/// An edge, where it came from, and what it is said to belong to.
#[derive(Clone, Copy)]
pub(crate) struct EdgeRow {
    /// Line of the file, from 1.
    pub(crate) at: usize,
    pub(crate) frame: Option<i64>,
    pub(crate) line: Option<i64>,
    pub(crate) edge: Edge,
}

pub(crate) struct EdgeFile {
    pub(crate) rows: Vec<EdgeRow>,
    pub(crate) has_frames: bool,
}

const COLUMNS: [&str; 7] = ["row", "column", "time_s", "line", "frame", "polarity", "sigma_px"];

/// The library takes stamps within an hour of frame start.
const TIME: Bounds = Bounds::number(-3600.0, 3600.0, "seconds since frame start");

pub(crate) fn parse(text: &str, setup: &SetupFile) -> Result<EdgeFile> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !is_blank(line));
    let Some((at, first)) = lines.next() else {
        bail!("the file is empty: it must begin with a header such as `row,column`");
    };
    let header = Header::parse(first).map_err(|error| anyhow!("line {at}: {error}"))?;
    let parser = RowParser::new(&header, setup);
    let rows = lines.map(|(at, line)| parser.row(at, line)).collect::<Result<_>>()?;
    Ok(EdgeFile { rows, has_frames: header.place("frame").is_some() })
}

/// Spreadsheets write a blank line as separators alone.
fn is_blank(line: &str) -> bool {
    line.chars().all(|c| c == ',' || c.is_whitespace())
}

/// No value of ours contains a comma, so that quotes are mere decoration.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|cell| cell.trim().trim_matches('"').trim())
}

/// Which column is where.
struct Header {
    names: Vec<&'static str>,
}

impl Header {
    fn parse(line: &str) -> Result<Self> {
        let mut names = Vec::new();
        for name in cells(line) {
            let Some(known) = COLUMNS.into_iter().find(|column| *column == name) else {
                return Err(unknown_column(name, line));
            };
            if names.contains(&known) {
                bail!("column `{known}` appears twice: each must appear once");
            }
            names.push(known);
        }
        match ["row", "column"].into_iter().find(|name| !names.contains(name)) {
            Some(missing) => bail!("column `{missing}` is missing: the header must name `row` and `column`"),
            None => Ok(Self { names }),
        }
    }

    fn place(&self, column: &str) -> Option<usize> {
        self.names.iter().position(|name| *name == column)
    }
}

fn unknown_column(name: &str, line: &str) -> Error {
    if !line.contains(',') && line.contains([';', '\t']) {
        return anyhow!("the header is `{}`: columns must be separated by commas", line.trim());
    }
    if name.parse::<f64>().is_ok() {
        return anyhow!("the header begins with `{name}`: the first line must name the columns, such as `row,column`");
    }
    anyhow!("unknown column `{name}`; the nearest is `{}`", nearest(name, &COLUMNS).unwrap_or_default())
}

/// A line of the file, cut into cells.
struct Record<'a> {
    at: usize,
    header: &'a Header,
    cells: Vec<&'a str>,
}

impl<'a> Record<'a> {
    /// `None` where there is no such column or the cell is empty.
    fn cell(&self, column: &str) -> Option<&'a str> {
        let cell = self.cells.get(self.header.place(column)?)?;
        (!cell.is_empty()).then_some(cell)
    }

    fn refuse(&self, column: &str, expected: impl std::fmt::Display) -> Error {
        let at = self.at;
        match self.cell(column) {
            Some(cell) => anyhow!("line {at}: `{column}` is `{cell}`, but must be {expected}"),
            None => anyhow!("line {at}: `{column}` is empty, but must be {expected}"),
        }
    }

    fn number(&self, column: &str, bounds: Bounds) -> Result<Option<f64>> {
        let Some(cell) = self.cell(column) else { return Ok(None) };
        let number = cell.parse().ok().filter(|number| bounds.contain(*number));
        number.map(Some).ok_or_else(|| self.refuse(column, bounds))
    }

    fn required(&self, column: &str, bounds: Bounds) -> Result<f64> {
        self.number(column, bounds)?.ok_or_else(|| self.refuse(column, bounds))
    }

    /// A whole number; tables that went through floating point write `3.0`.
    fn integer(&self, column: &str) -> Result<Option<i64>> {
        const EXACT: f64 = (1_u64 << 53) as f64;
        let Some(cell) = self.cell(column) else { return Ok(None) };
        if let Ok(integer) = cell.parse() {
            return Ok(Some(integer));
        }
        let number: Option<f64> =
            cell.parse().ok().filter(|number: &f64| number.fract() == 0.0 && number.abs() <= EXACT);
        number.map(|number| Some(number as i64)).ok_or_else(|| self.refuse(column, "a whole number"))
    }

    fn polarity(&self) -> Result<Polarity> {
        match self.cell("polarity").map(str::to_ascii_lowercase).as_deref() {
            None | Some("unknown") => Ok(Polarity::Unknown),
            Some("rising" | "1" | "+1") => Ok(Polarity::Rising),
            Some("falling" | "-1") => Ok(Polarity::Falling),
            Some(_) => Err(self.refuse("polarity", "rising, falling or empty")),
        }
    }
}

/// From a line of the file to an edge.
struct RowParser<'a> {
    header: &'a Header,
    setup: &'a SetupFile,
    rows: Bounds,
    columns: Bounds,
}

impl<'a> RowParser<'a> {
    fn new(header: &'a Header, setup: &'a SetupFile) -> Self {
        let image = setup.setup.camera().intrinsics();
        let rows = Bounds::whole(0.0, f64::from(image.rows) - 1.0, "rows of the image");
        let columns = Bounds::number(-1.0, f64::from(image.columns), "columns of the image");
        Self { header, setup, rows, columns }
    }

    fn row(&self, at: usize, line: &str) -> Result<EdgeRow> {
        let record = Record { at, header: self.header, cells: cells(line).collect() };
        let (found, named) = (record.cells.len(), self.header.names.len());
        if found != named {
            bail!("line {at}: {found} values, but must be {named}, one for each column of the header");
        }
        let row = record.required("row", self.rows)? as u16;
        let column_px = record.required("column", self.columns)?;
        let time_ns = match record.number("time_s", TIME)? {
            Some(time_s) => (time_s * 1e9).round() as i64,
            None => self.setup.setup.readout().row_time_ns(row),
        };
        let sigma_px = record.number("sigma_px", SIGMA_PX)?.unwrap_or(self.setup.sigma_column_px);
        let edge = Edge::new(row, (column_px * 65536.0).round() as i32, time_ns)
            .with_polarity(record.polarity()?)
            // Whatever is finer than the grid of columns is as good as the grid.
            .with_sigma_q16(((sigma_px * 65536.0).round() as u32).max(1));
        Ok(EdgeRow { at, frame: record.integer("frame")?, line: record.integer("line")?, edge })
    }
}
