//! [`Pixels`]: a row of pixels, whatever its format.

use core::ops::Range;

/// A row of pixels in the format in which the sensor delivers it.
///
/// Two methods make a format; the others are for formats that are plain grey bytes or a colour mosaic. A view is `Copy`
/// and is looked at in any order, most pixels once and those near an edge several times.
pub trait Pixels: Copy {
    /// Whether edges in grey bytes are located in ways that are made for these, which take fewer instructions and more
    /// flash than the one for all formats; [`Compact`](super::Compact) rows do without.
    const HAS_QUICK_WAYS: bool = true;

    /// Number of pixels.
    fn columns(&self) -> usize;

    /// Brightness of a pixel in 1/256 grey level: 0 is dark and 65280 (255 levels) bright, up to 65535 where the format
    /// has steps finer than one. Zero beyond the last column.
    fn level_q8(&self, column: usize) -> u16;

    /// The levels of some columns, from left to right.
    fn levels_q8(&self, columns: Range<usize>) -> impl Iterator<Item = u16> + Clone {
        let row = *self;
        columns.map(move |column| row.level_q8(column))
    }

    /// The row as grey bytes, one a pixel, if that is what it is: then nothing is converted.
    fn grey(&self) -> Option<&[u8]> {
        None
    }

    /// Which kind of row of a colour mosaic this is; `None` where all pixels see the same colour.
    fn mosaic_row(&self) -> Option<MosaicRow> {
        None
    }
}

/// The two kinds of rows of a mosaic in which two colours alternate along each row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MosaicRow {
    /// Rows 0, 2, 4 … of the image.
    Even,
    /// Rows 1, 3, 5 …
    Odd,
}

impl MosaicRow {
    pub(super) const fn of(row: u16) -> Self {
        if row.is_multiple_of(2) { Self::Even } else { Self::Odd }
    }
}

/// 8-bit grey, one byte a pixel: slices, arrays, and whatever else is a row of bytes.
impl<T: AsRef<[u8]> + ?Sized> Pixels for &T {
    fn columns(&self) -> usize {
        self.as_ref().len()
    }

    fn level_q8(&self, column: usize) -> u16 {
        self.as_ref().get(column).map_or(0, |level| u16::from(*level) << 8)
    }

    fn levels_q8(&self, columns: Range<usize>) -> impl Iterator<Item = u16> + Clone {
        self.as_ref().get(columns).unwrap_or_default().iter().map(|level| u16::from(*level) << 8)
    }

    fn grey(&self) -> Option<&[u8]> {
        Some(self.as_ref())
    }
}
