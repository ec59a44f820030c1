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
    Every {
        interval_s: f64,
        /// The number of the first frame, from whose start all times are counted.
        first: i64,
    },
    At(BTreeMap<i64, FrameTime>),
}

/// As long as the library follows a camera from one frame to the next.
const MOST_S: f64 = 1e6;

impl FrameStarts {
    /// For these frames in their order. Refuses frames that start before the one before them has been read, or ages after
    /// it, and exposures that last longer than a frame.
    pub(crate) fn new(arguments: &MotionArgs, file: &SetupFile, frames: Vec<(i64, FrameName)>) -> Result<Self> {
        let (numbers, names): (Vec<i64>, Vec<FrameName>) = frames.into_iter().unzip();
        let starts = match (arguments.frame_interval_s, &arguments.frame_times) {
            (Some(interval_s), _) => Self::Every { interval_s, first: numbers.first().copied().unwrap_or(0) },
            (None, Some(path)) => Self::At(numbers.iter().copied().zip(frame_times::load(path, &names)?).collect()),
            (None, None) => Self::Independent,
        };
        let frames: Vec<(i64, &str)> = numbers.into_iter().zip(names.iter().map(|name| name.long.as_str())).collect();
        starts.check_intervals(file, &frames)?;
        starts.check_exposures(file, &frames)?;
        Ok(starts)
    }

    pub(crate) fn is_sequence(&self) -> bool {
        !matches!(self, Self::Independent)
    }

    /// Seconds since the start of the first frame.
    pub(crate) fn start_s(&self, number: i64) -> f64 {
        match self {
            Self::Independent => 0.0,
            // Numbers may lie farther apart than the largest of them is.
            Self::Every { interval_s, first } => (i128::from(number) - i128::from(*first)) as f64 * interval_s,
            Self::At(times) => times.get(&number).map_or(0.0, |time| time.start_s),
        }
    }

    /// Of a frame, where each has its own.
    pub(crate) fn exposure_s(&self, number: i64) -> Option<f64> {
        match self {
            Self::Independent | Self::Every { .. } => None,
            Self::At(times) => times.get(&number).and_then(|time| time.exposure_s),
        }
    }

    /// The shortest time from one frame to the next.
    fn least_interval_s(&self) -> Option<f64> {
        match self {
            Self::Independent => None,
            Self::Every { interval_s, .. } => Some(*interval_s),
            Self::At(times) => {
                let pairs = times.values().zip(times.values().skip(1));
                pairs.map(|(before, after)| after.start_s - before.start_s).reduce(f64::min)
            }
        }
    }

    fn check_intervals(&self, file: &SetupFile, frames: &[(i64, &str)]) -> Result<()> {
        if let Self::Every { interval_s, .. } = self {
            check_interval(file, *interval_s, ["one frame", "the next"])?;
        }
        if self.is_sequence() {
            for ((number, name), (next, next_name)) in frames.iter().zip(frames.iter().skip(1)) {
                check_interval(file, self.start_s(*next) - self.start_s(*number), [name, next_name])?;
            }
        }
        Ok(())
    }

    fn check_exposures(&self, file: &SetupFile, frames: &[(i64, &str)]) -> Result<()> {
        let interval_s = self.least_interval_s();
        for (number, name) in frames {
            if let Some(exposure_s) = self.exposure_s(*number) {
                file.check_exposure_of(name, "exposure_s", exposure_s, interval_s)?;
            }
        }
        file.check_exposure(interval_s)
    }
}

fn check_interval(file: &SetupFile, interval_s: f64, [from, to]: [&str; 2]) -> Result<()> {
    let readout_s = file.readout_s();
    // A difference of two times has more digits than the times.
    let told_s = (interval_s * 1e9).round() / 1e9;
    ensure!(
        interval_s >= file.least_interval_s(),
        "from {from} to {to} it is {told_s} s, but must be at least {readout_s} s, the readout of a frame in the setup"
    );
    ensure!(interval_s <= MOST_S, "from {from} to {to} it is {told_s} s, but must be at most {MOST_S} s");
    Ok(())
}
