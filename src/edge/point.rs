//! [`EdgePoint`]: where a row crosses an edge.

use crate::scalar::{NS_PER_S, Scalar};

/// Which way the brightness changes from left to right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Polarity {
    /// Dark to bright.
    Rising,
    /// Bright to dark.
    Falling,
    /// Not known: such points make lines with each other only.
    #[default]
    Unknown,
}

/// The point where a row crosses an edge, in integers that are the same on every core. 24 bytes.
///
/// ```
/// use shutter_range::{EdgePoint, Polarity};
/// let point = EdgePoint::new(17, 320 << 16, 1_200_000).with_polarity(Polarity::Rising).with_sigma_q16(3277); // 0.05 px
/// assert_eq!(point.column_px::<f32>(), 320.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EdgePoint {
    /// Middle of the row's exposure in nanoseconds since frame start; see
    /// [`Readout::row_time_ns`](crate::Readout::row_time_ns).
    pub time_ns: i64,
    /// Column in 1/65536 px; pixel centres are at whole numbers.
    pub column_q16: i32,
    /// One standard deviation of the column's noise in 1/65536 px: 1 to [`EdgePoint::MAX_SIGMA_Q16`].
    pub sigma_q16: u32,
    /// Row of the image, 0 at the top.
    pub row: u16,
    /// Width of the edge here (one sigma of its blur) in 1/256 px; zero where it was not measured.
    pub width_q8: u16,
    /// Whether the edge goes from dark to bright or from bright to dark.
    pub polarity: Polarity,
}

impl EdgePoint {
    /// 0.1 px: the noise of a point that states none.
    pub const DEFAULT_SIGMA_Q16: u32 = 6_554;

    /// 256 px: the largest noise that is accepted.
    pub const MAX_SIGMA_Q16: u32 = 1 << 24;

    /// A point of unknown polarity and width, with [`EdgePoint::DEFAULT_SIGMA_Q16`] of noise.
    #[must_use]
    pub const fn new(row: u16, column_q16: i32, time_ns: i64) -> Self {
        let sigma_q16 = Self::DEFAULT_SIGMA_Q16;
        Self { time_ns, column_q16, sigma_q16, row, width_q8: 0, polarity: Polarity::Unknown }
    }

    /// The same with a polarity.
    #[must_use]
    pub const fn with_polarity(self, polarity: Polarity) -> Self {
        Self { polarity, ..self }
    }

    /// The same with a noise of its own, one standard deviation in 1/65536 px.
    #[must_use]
    pub const fn with_sigma_q16(self, sigma_q16: u32) -> Self {
        Self { sigma_q16, ..self }
    }

    /// The boundary between pixels next to it: boundary k lies between pixels k − 1 and k, whose centres are at whole
    /// numbers.
    pub(crate) const fn boundary(&self) -> i32 {
        (self.column_q16 >> 16) + 1
    }

    /// Column in pixels.
    #[must_use]
    pub fn column_px<S: Scalar>(&self) -> S {
        S::from_i32(self.column_q16) * S::ratio(1, 1 << 16)
    }

    /// Time since frame start in seconds.
    #[must_use]
    pub fn time_s<S: Scalar>(&self) -> S {
        S::from_ratio(self.time_ns, NS_PER_S)
    }
}
