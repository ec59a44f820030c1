//! [`Compact`]: any rows, for a program that is to be small.

use core::ops::Range;

use super::pixels::{MosaicRow, Pixels};

/// The same rows, for a program that is to be small: their edges are located in the one way that all formats have.
///
/// A program whose rows are all of this kind takes less flash, and half as many instructions again where rows show edges
/// (docs/budget.md has both); what it finds is the same to a third of what noise does to it (`cargo
/// test compact`).
///
/// ```
/// # use shutter_range::{Ranger, RowError, Setup};
/// # fn take(ranger: &mut Ranger<8, 8, 16>, setup: &Setup<f32>, row: u16, pixels: &[u8]) -> Result<(), RowError> {
/// use shutter_range::format::Compact;
/// ranger.row(setup, row, Compact(pixels))
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compact<P>(pub P);

impl<P: Pixels> Pixels for Compact<P> {
    const HAS_QUICK_WAYS: bool = false;

    fn columns(&self) -> usize {
        self.0.columns()
    }

    fn level_q8(&self, column: usize) -> u16 {
        self.0.level_q8(column)
    }

    fn levels_q8(&self, columns: Range<usize>) -> impl Iterator<Item = u16> + Clone {
        self.0.levels_q8(columns)
    }

    fn grey(&self) -> Option<&[u8]> {
        self.0.grey()
    }

    fn mosaic_row(&self) -> Option<MosaicRow> {
        self.0.mosaic_row()
    }
}
