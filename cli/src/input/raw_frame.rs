//! [`RawFrame`]: size and pixel format of a dump without a header.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use shutter_range::format::{PixelFormat, Pixels};

use super::size::Size;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RawFrame {
    pub(crate) size: Size,
    pub(crate) format: PixelFormat,
    row_bytes: usize,
}

impl RawFrame {
    pub(crate) fn bytes(&self) -> u64 {
        self.row_bytes as u64 * u64::from(self.size.rows)
    }

    /// The bytes of a row of a dump, if it has them.
    pub(crate) fn row<'d>(&self, dump: &'d [u8], row: u16) -> Option<&'d [u8]> {
        let start = usize::from(row) * self.row_bytes;
        dump.get(start..start + self.row_bytes)
    }

    /// The pixels of a dump as whole grey levels, to look at.
    pub(crate) fn grey(&self, dump: &[u8]) -> Vec<u8> {
        let rows = (0..).zip(dump.chunks_exact(self.row_bytes));
        let pixels = rows.flat_map(|(row, bytes)| {
            let pixels = self.format.row(bytes, row);
            (0..pixels.columns()).map(move |column| pixels.level_q8(column))
        });
        pixels.map(|level_q8| (level_q8.saturating_add(128) >> 8) as u8).collect()
    }
}

impl FromStr for RawFrame {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (size, format) = text.split_once(':').map_or((text, None), |(size, format)| (size, Some(format)));
        let size: Size = size.parse()?;
        let format = format.map_or(Ok(PixelFormat::default()), str::parse);
        let format = format.map_err(|error| error.to_string())?;
        let row_bytes = u16::try_from(size.columns).ok().and_then(|columns| format.row_bytes(columns));
        let row_bytes = row_bytes.ok_or_else(|| format!("rows of {format} must have a multiple of four pixels"))?;
        Ok(Self { size, format, row_bytes })
    }
}

impl Display for RawFrame {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.size.fmt(f)?;
        if self.format == PixelFormat::default() { Ok(()) } else { write!(f, ":{}", self.format) }
    }
}
