//! [`ScannedPoint`]: where a single row shows an edge.

use super::point::{EdgePoint, Polarity};

/// A point of an edge as a single row of pixels shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScannedPoint {
    /// Column in 1/65536 px; pixel centres are at whole numbers.
    pub column_q16: i32,
    /// One standard deviation of the column's noise in 1/65536 px.
    pub sigma_q16: u32,
    /// Width of the edge here (one sigma of its blur, the pixel's own included) in 1/256 px.
    pub width_q8: u16,
    /// Brightness on the right minus that on the left, in grey levels.
    pub contrast: i16,
}

impl ScannedPoint {
    /// Whether the edge goes from dark to bright or from bright to dark.
    #[must_use]
    pub const fn polarity(&self) -> Polarity {
        if self.contrast < 0 { Polarity::Falling } else { Polarity::Rising }
    }

    /// The point of `row`, whose exposure has its middle at `time_ns` since frame start.
    #[must_use]
    pub const fn at(&self, row: u16, time_ns: i64) -> EdgePoint {
        EdgePoint {
            time_ns,
            column_q16: self.column_q16,
            sigma_q16: self.sigma_q16,
            row,
            width_q8: self.width_q8,
            polarity: self.polarity(),
        }
    }
}
