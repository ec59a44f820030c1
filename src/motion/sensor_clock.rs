//! [`SensorClock`] and [`StampConvention`]: when a stamped sample was taken.

/// The clock of a stream of samples, and how long its values may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SensorClock {
    /// Nanoseconds to add to a stamp for the camera's time: positive where the stream's clock is behind. The delay of a
    /// filter is subtracted here.
    pub offset_ns: i64,
    /// Longest time in nanoseconds between two samples, from the last sample on and up to the first, over which values
    /// are trusted. Three periods of the sensor, say: then two samples may be lost. Beyond it there is a [`TrajectoryGap`](crate::TrajectoryGap).
    pub max_gap_ns: u64,
}

/// Which instant a stamp means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StampConvention {
    /// The value is that of the stamped instant, and changes linearly between samples: a gyroscope read at once.
    Instant(SensorClock),
    /// The value is the mean since the stamp before, and constant over that time: ticks of a wheel, divided by the time
    /// in which they were counted; an integrating gyroscope. Taken for [`StampConvention::Instant`] it is late by half a period.
    MeanSincePrevious(SensorClock),
}

impl StampConvention {
    pub(super) const fn clock(&self) -> &SensorClock {
        match self {
            Self::Instant(clock) | Self::MeanSincePrevious(clock) => clock,
        }
    }
}
