//! [`Window`]: five rows around one.

/// How many rows above and below the middle one a window shows.
pub(super) const REACH: usize = 2;

const ROWS: usize = 2 * REACH + 1;

/// The rows around one, from the upper to the lower.
pub(super) type Rows<'a, const COLUMNS: usize> = [&'a [u16; COLUMNS]; ROWS];

/// The last five rows of a stream. Beyond its first and its last row these repeat.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Window<const COLUMNS: usize> {
    rows: [[u16; COLUMNS]; ROWS],
    /// The place of the next row.
    next: usize,
    /// How many rows have come; 0 at the start of a frame.
    come: usize,
}

impl<const COLUMNS: usize> Window<COLUMNS> {
    pub(super) const fn new() -> Self {
        Self { rows: [[0; COLUMNS]; ROWS], next: 0, come: 0 }
    }

    /// Takes a row. The window is then around that which came `REACH` rows before: its number in the frame and the
    /// rows; `None` where no such row has come.
    pub(super) fn push(&mut self, row: &[u16; COLUMNS]) -> Option<(usize, Rows<'_, COLUMNS>)> {
        if self.come == 0 {
            self.rows = [*row; ROWS];
        } else if let Some(place) = self.rows.get_mut(self.next) {
            *place = *row;
        }
        self.next = (self.next + 1) % ROWS;
        self.come += 1;
        let middle = self.come.checked_sub(REACH + 1)?;
        let [a, b, c, d, e] = &self.rows;
        let rows = match self.next {
            0 => [a, b, c, d, e],
            1 => [b, c, d, e, a],
            2 => [c, d, e, a, b],
            3 => [d, e, a, b, c],
            _ => [e, a, b, c, d],
        };
        Some((middle, rows))
    }

    /// The last row once more, to see those that are left; `None` where none has come.
    pub(super) fn last(&self) -> Option<[u16; COLUMNS]> {
        let place = (self.next + ROWS - 1) % ROWS;
        if self.come > 0 { self.rows.get(place).copied() } else { None }
    }

    /// Ends the frame.
    pub(super) const fn clear(&mut self) {
        (self.next, self.come) = (0, 0);
    }
}
