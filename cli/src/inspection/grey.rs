//! [`Grey`]: the grey levels of a frame.

use image::GrayImage;

pub(crate) struct Grey<'a> {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    levels: &'a [u8],
}

impl<'a> Grey<'a> {
    pub(crate) fn of(picture: &'a GrayImage) -> Self {
        Self { columns: picture.width() as usize, rows: picture.height() as usize, levels: picture.as_raw() }
    }

    pub(crate) fn levels(&self) -> &'a [u8] {
        self.levels
    }

    /// Beyond the picture, 0.
    pub(crate) fn at(&self, column: usize, row: usize) -> i32 {
        self.levels.get(row * self.columns + column).copied().unwrap_or(0).into()
    }

    pub(crate) fn row(&self, row: usize) -> &'a [u8] {
        self.levels.get(row * self.columns..(row + 1) * self.columns).unwrap_or_default()
    }

    /// Of three columns by three rows around a pixel, what no plane and no upright or level structure has: the second
    /// difference both ways. Of white noise it has six times the sigma.
    pub(crate) fn roughness(&self, column: usize, row: usize) -> i32 {
        self.roughness_over(column, row, 1)
    }

    /// The same of every second column and row.
    pub(crate) fn wide_roughness(&self, column: usize, row: usize) -> i32 {
        self.roughness_over(column, row, 2)
    }

    fn roughness_over(&self, column: usize, row: usize, step: usize) -> i32 {
        let second = |row| self.at(column - step, row) - 2 * self.at(column, row) + self.at(column + step, row);
        second(row - step) - 2 * second(row) + second(row + step)
    }
}
