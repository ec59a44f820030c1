//! [`Prediction`]: what will be measured of an edge.

use core::fmt::{self, Display, Formatter};

use crate::range::{Range, RangeStatus};
use crate::scalar::Scalar;

/// What will be measured of a target's edge at a depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Prediction<S> {
    /// As it would be told but for the noise: status, sigma and budget.
    pub range: Range<S>,
    /// Path of the edge in the image during the exposure, in pixels along the row.
    pub path_px: S,
    /// Change of its column from the first to the last of its rows, in pixels.
    pub skew_px: S,
    /// Sigma of the column in one row, in pixels.
    pub sigma_column_px: S,
    /// Why there would be no distance.
    pub obstacle: Option<Obstacle>,
}

/// Why an edge has no distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Obstacle {
    /// Less than half of the rows that it covers show it: it leaves the image.
    LeavesImage,
    /// Contrast, blur and noise are such that a row does not show it.
    Unseen,
    /// It slopes by more than the limits of the setup allow.
    Steep,
    /// The range would have this status.
    Status(RangeStatus),
}

impl Display for Obstacle {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeavesImage => formatter.pad("leaves the image"),
            Self::Unseen => formatter.pad("too blurred or too faint"),
            Self::Steep => formatter.pad("slopes too much"),
            Self::Status(status) => status.fmt(formatter),
        }
    }
}

impl<S: Scalar> Prediction<S> {
    /// Sigma of the inverse depth, relative, and of the depth as long as it is small; [`Scalar::UNKNOWN`] where nothing
    /// is known.
    #[must_use]
    pub fn relative_sigma(&self) -> S {
        let estimate = &self.range.estimate;
        let relative = (estimate.sigma_inverse_depth_per_m / estimate.inverse_depth_per_m).abs();
        if relative < S::UNKNOWN { relative } else { S::UNKNOWN }
    }

    /// Whether there would be a distance, known to this relative sigma.
    pub(super) fn is_good(&self, relative_sigma: S) -> bool {
        self.obstacle.is_none() && self.relative_sigma() <= relative_sigma
    }
}
