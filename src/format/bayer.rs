//! [`Bayer`]: a colour mosaic.

use core::ops::Range;

use super::pixels::{MosaicRow, Pixels};

/// A Bayer mosaic, as the sensor has it: `P` says how its samples are stored.
///
/// Nothing is interpolated. In each row two colours alternate; an edge has the same column in both, but levels of its
/// own in each. Both are read from the row, beside the edge, and all pixels tell where it is. Which of the colours are
/// red and blue, and where they begin, makes no difference.
///
/// *Limits*: an edge is seen in those rows in which its two colours together get brighter or darker as they do in the
/// first of its rows; beside a neighbour it needs two pixels of either level where grey needs one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bayer<P> {
    samples: P,
    row: MosaicRow,
}

impl<P: Pixels> Bayer<P> {
    /// Row `row` of the image.
    #[must_use]
    pub const fn new(samples: P, row: u16) -> Self {
        Self { samples, row: MosaicRow::of(row) }
    }
}

impl<P: Pixels> Pixels for Bayer<P> {
    const HAS_QUICK_WAYS: bool = P::HAS_QUICK_WAYS;

    fn columns(&self) -> usize {
        self.samples.columns()
    }

    fn level_q8(&self, column: usize) -> u16 {
        self.samples.level_q8(column)
    }

    fn levels_q8(&self, columns: Range<usize>) -> impl Iterator<Item = u16> + Clone {
        self.samples.levels_q8(columns)
    }

    fn grey(&self) -> Option<&[u8]> {
        self.samples.grey()
    }

    fn mosaic_row(&self) -> Option<MosaicRow> {
        Some(self.row)
    }
}
