//! [`FrameStarts`]: when each frame starts and what exposure it has, and whether frames are one sequence at all.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};

use crate::input::frame_times::{self, FrameName, FrameTime};
use crate::input::setup::SetupFile;
use crate::setup_arguments::MotionArgs;

/// Frames have numbers: those of a file of edges, or their places on the command line.
pub(crate) enum FrameStarts {
    /// No frame knows of another.
    Independent,
    /// So many seconds from one number to the next.
    Every(f64),
    At(BTreeMap<i64, FrameTime>),
}

impl FrameStarts {
    /// For these frames in their order.
    pub(crate) fn new(arguments: &MotionArgs, frames: Vec<(i64, FrameName)>) -> Result<Self> {
        let (numbers, names): (Vec<i64>, Vec<FrameName>) = frames.into_iter().unzip();
        Ok(match (arguments.frame_interval_s, &arguments.frame_times) {
            (Some(interval_s), _) => Self::Every(interval_s),
            (None, Some(path)) => Self::At(numbers.into_iter().zip(frame_times::load(path, &names)?).collect()),
            (None, None) => Self::Independent,
        })
    }

    pub(crate) fn is_sequence(&self) -> bool {
        !matches!(self, Self::Independent)
    }

    /// Seconds since the start of the first frame, or of that with number 0.
    pub(crate) fn start_s(&self, number: i64) -> f64 {
        match self {
            Self::Independent => 0.0,
            Self::Every(interval_s) => number as f64 * interval_s,
            Self::At(times) => times.get(&number).map_or(0.0, |time| time.start_s),
        }
    }

    /// Of a frame, where each has its own.
    pub(crate) fn exposure_s(&self, number: i64) -> Option<f64> {
        match self {
            Self::Independent | Self::Every(_) => None,
            Self::At(times) => times.get(&number).and_then(|time| time.exposure_s),
        }
    }

    /// The shortest time from one frame to the next.
    fn least_interval_s(&self) -> Option<f64> {
        match self {
            Self::Independent => None,
            Self::Every(interval_s) => Some(*interval_s),
            Self::At(times) => {
                let pairs = times.values().zip(times.values().skip(1));
                pairs.map(|(before, after)| after.start_s - before.start_s).reduce(f64::min)
            }
        }
    }

    /// Refuses frames that start before the one before them has been read, and exposures that last longer than a frame.
    pub(crate) fn check(&self, file: &SetupFile) -> Result<()> {
        let interval_s = self.least_interval_s();
        if let Some(interval_s) = interval_s {
            let readout_s = file.readout_s();
            let line_time_s = readout_s / f64::from(file.setup.readout().rows());
            ensure!(
                interval_s >= readout_s - line_time_s,
                "from one frame to the next it is {interval_s} s, but must be at least {readout_s} s, the readout of a \
                 frame in the setup"
            );
        }
        if let Self::At(times) = self {
            for (number, exposure_s) in times.iter().filter_map(|(number, time)| Some((number, time.exposure_s?))) {
                file.check_exposure_of(&format!("frame {number}"), "exposure_s", exposure_s, interval_s)?;
            }
        }
        file.check_exposure(interval_s)
    }
}
