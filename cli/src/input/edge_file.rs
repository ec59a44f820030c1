//! Edge points from CSV.

use anyhow::Result;
use shutter_range::{EdgePoint, Polarity};

use super::bounded_read::{Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::setup::{SIGMA_PX, SetupFile};
use super::table_file::{Columns, Record, TableFile};

/// Some ten million edge points, which take more than a gigabyte of memory.
pub(crate) const LIMIT: Limit<'_> = Limit { bytes: 256 * MEBIBYTE, rule: "a file of edge points must have at most" };

/// An edge point, where it came from, and what it is said to belong to.
#[derive(Clone, Copy)]
pub(crate) struct FilePoint {
    /// Line of the file, from 1.
    pub(crate) at: usize,
    pub(crate) frame: Option<i64>,
    pub(crate) line: Option<i64>,
    pub(crate) point: EdgePoint,
}

pub(crate) struct EdgeFile {
    pub(crate) points: Vec<FilePoint>,
    pub(crate) has_frames: bool,
}

const COLUMNS: Columns = Columns {
    known: &["row", "column", "time_s", "line", "frame", "polarity", "sigma_px", "width_px"],
    required: &["row", "column"],
};

/// Differences of two can be counted in nanoseconds; what the readout allows is far less.
const TIME: Bounds = Bounds::number(-4e9, 4e9, "seconds since frame start");
/// An edge point cannot store more than that.
const WIDTH: Bounds = Bounds::number(0.0, 255.0, "pixels, one sigma of the edge's blur; 0 where it was not measured");

pub(crate) fn parse(text: &str, setup: &SetupFile) -> Result<EdgeFile> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let parser = PointParser::new(setup);
    let points = table.records().map(|record| parser.point(&record?)).collect::<Result<_>>()?;
    Ok(EdgeFile { points, has_frames: table.has("frame") })
}

fn polarity(record: &Record<'_>) -> Result<Polarity> {
    match record.cell("polarity").map(str::to_ascii_lowercase).as_deref() {
        None | Some("unknown") => Ok(Polarity::Unknown),
        Some("rising" | "1" | "+1") => Ok(Polarity::Rising),
        Some("falling" | "-1") => Ok(Polarity::Falling),
        Some(_) => Err(record.refuse("polarity", "rising, falling or empty")),
    }
}

/// In 1/256 px; zero where it was not measured. A width below the resolution was measured all the same.
fn width_q8(record: &Record<'_>) -> Result<u16> {
    let measured = record.number("width_px", WIDTH)?.filter(|width_px| *width_px > 0.0);
    Ok(measured.map_or(0, |width_px| ((width_px * 256.0).round() as u16).max(1)))
}

/// From a line of the file to an edge point.
struct PointParser<'a> {
    setup: &'a SetupFile,
    rows: Bounds,
    columns: Bounds,
}

impl<'a> PointParser<'a> {
    fn new(setup: &'a SetupFile) -> Self {
        let image = setup.setup.camera().intrinsics();
        let rows = Bounds::whole(0.0, f64::from(image.rows) - 1.0, "rows of the image");
        let columns = Bounds::number(-1.0, f64::from(image.columns), "columns of the image");
        Self { setup, rows, columns }
    }

    fn point(&self, record: &Record<'_>) -> Result<FilePoint> {
        let row = record.required("row", self.rows)? as u16;
        let column_px = record.required("column", self.columns)?;
        let time_ns = match record.number("time_s", TIME)? {
            Some(time_s) => (time_s * 1e9).round() as i64,
            None => self.setup.setup.readout().row_time_ns(row),
        };
        let sigma_px = record.number("sigma_px", SIGMA_PX)?.unwrap_or(self.setup.sigma_column_px);
        let point = EdgePoint::new(row, (column_px * 65536.0).round() as i32, time_ns)
            .with_polarity(polarity(record)?)
            // A column is stored in 1/65536 px: it cannot be better than that.
            .with_sigma_q16(((sigma_px * 65536.0).round() as u32).max(1));
        let point = EdgePoint { width_q8: width_q8(record)?, ..point };
        Ok(FilePoint { at: record.at, frame: record.integer("frame")?, line: record.integer("line")?, point })
    }
}
