//! [`Size`]: that of an image in pixels.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use anyhow::{Result, ensure};
use image::GrayImage;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
}

impl Size {
    pub(crate) fn of(pixels: &GrayImage) -> Self {
        let (columns, rows) = pixels.dimensions();
        Self { columns, rows }
    }

    pub(crate) fn pixels(self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once(['x', 'X', '×']);
        let size = parts.and_then(|(columns, rows)| Some(Self { columns: length(columns)?, rows: length(rows)? }));
        size.ok_or_else(|| format!("it must be two whole numbers of pixels from 1 to {LONGEST}, such as 640x480"))
    }
}

/// As many columns and rows as the library counts.
const LONGEST: u32 = 32_767;

fn length(text: &str) -> Option<u32> {
    text.parse().ok().filter(|pixels| (1..=LONGEST).contains(pixels))
}

impl Display for Size {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.columns, self.rows)
    }
}

/// Refuses a frame of another size than the first of those that are given together.
pub(crate) fn refuse_unlike((name, size): (&str, Size), (first_name, first): (&str, Size)) -> Result<()> {
    ensure!(size == first, "{name}: the frame is {size} pixels, but must be {first}, as {first_name} is");
    Ok(())
}
