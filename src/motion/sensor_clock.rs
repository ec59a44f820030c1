//! [`SensorClock`] and [`StampConvention`]: which instant of the camera's clock a stamp means.

/// The clock of a stream of samples, and for how long its values are trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SensorClock {
    /// Nanoseconds to add to a stamp for the camera's time: positive where the stream's clock is behind. Subtract the
    /// delay of the sensor's filter from it.
    pub offset_ns: i64,
    /// Longest time in nanoseconds without a sample over which values are trusted: between two samples, before the
    /// first and after the last. More is a [`TrajectoryGap`](crate::TrajectoryGap). With three periods of the sensor,
    /// two samples in succession may be lost.
    pub max_gap_ns: u64,
}

/// Which instant a stamp means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StampConvention {
    /// The value is that of the stamped instant, and changes linearly between samples: a gyroscope that is stamped when
    /// it is read.
    Instant(SensorClock),
    /// The value is the mean since the previous stamp, and is taken to be constant over that time: ticks of a wheel
    /// divided by the time in which they were counted, or an integrating gyroscope. Such values declared as
    /// [`Instant`](Self::Instant) would lag by half a period.
    MeanSincePrevious(SensorClock),
}

impl StampConvention {
    pub(super) const fn clock(&self) -> &SensorClock {
        match self {
            Self::Instant(clock) | Self::MeanSincePrevious(clock) => clock,
        }
    }
}
