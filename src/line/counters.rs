//! [`Counters`]: what came in, and what did not become part of a line.

/// What has become of the edge points: nothing is lost uncounted.
///
/// Once a frame has ended and its lines have been taken, `points` is the sum of the points of those lines,
/// `stray_points` and `dropped_points`. All counts run from the making of the ranger and stay at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Counters {
    /// Edge points that were taken: those handed over, once their row is complete, or those found in rows of pixels.
    pub points: u32,
    /// Edge points of no line: of tentative lines that were never confirmed (noise and texture), of a torn frame, of
    /// what frays where a line was split, and those that could be of either of two edges that are too near to each
    /// other.
    pub stray_points: u32,
    /// Edge points for which there was no room: in the buffer of their row, or in the table of lines.
    pub dropped_points: u32,
    /// Lines that were refused because the table was full. A line that is refused in each of its rows counts each time.
    pub dropped_lines: u32,
    /// Rows of pixels that could not be read whole: with no place free for another line, so that only the lines under
    /// way were looked for, with more points than the row's buffer holds, or with texture or noise everywhere that
    /// hides edges of a contrast of 64 grey levels. What else they show is not known.
    pub crowded_rows: u32,
}

impl Counters {
    pub(super) const ZERO: Self =
        Self { points: 0, stray_points: 0, dropped_points: 0, dropped_lines: 0, crowded_rows: 0 };

    /// Counts points that were taken.
    pub(crate) fn count_points(&mut self, points: u32) {
        self.points = self.points.saturating_add(points);
    }

    /// Counts points that belong to no line.
    pub(crate) fn count_stray(&mut self, points: u32) {
        self.stray_points = self.stray_points.saturating_add(points);
    }

    /// Counts a row that could not be read whole.
    pub(crate) fn count_crowded_row(&mut self) {
        self.crowded_rows = self.crowded_rows.saturating_add(1);
    }

    /// Counts a point for which there was no room.
    pub(crate) fn count_dropped_point(&mut self) {
        self.dropped_points = self.dropped_points.saturating_add(1);
    }

    /// Counts a line for which there was no room, and its point.
    pub(super) fn count_dropped_line(&mut self) {
        self.dropped_lines = self.dropped_lines.saturating_add(1);
        self.count_dropped_point();
    }
}
