//! [`Counters`]: what did not become part of a line.

/// What did not become part of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Edges refused because the row's buffer was full.
    pub dropped_points: u32,
    /// Edges that would have begun a line while the table was full. A line that is refused in each of its rows counts
    /// each time.
    pub dropped_lines: u32,
    /// Edges of tentative lines that were never confirmed: noise and texture.
    pub stray_points: u32,
}
