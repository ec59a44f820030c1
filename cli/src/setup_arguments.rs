//! What several commands ask for: a setup, a camera file, and how the camera moves.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::argument_values::interval_of_a_sequence;
use crate::input::camera_file::CameraSource;
use crate::input::setup::SetupSource;

#[derive(Args)]
pub(crate) struct SetupArgs {
    /// Camera, motion and attitude (TOML)
    #[arg(long = "setup", value_name = "FILE")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
}

#[derive(Args)]
pub(crate) struct CameraArgs {
    /// A camera calibrated by another program, for keys of [camera]: ROS camera_info, OpenCV's YAML or XML, Kalibr's
    /// camchain, a lens profile of Gyroflow
    #[arg(id = "camera", long = "camera", value_name = "FILE")]
    pub(crate) path: Option<PathBuf>,
    /// Which camera of the file, such as cam1
    #[arg(long = "camera-name", value_name = "NAME", requires = "camera")]
    pub(crate) name: Option<String>,
}

impl CameraArgs {
    pub(crate) fn source(&self) -> Option<CameraSource<'_>> {
        self.path.as_deref().map(|path| CameraSource { path, name: self.name.as_deref() })
    }
}

impl SetupArgs {
    /// All that is read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [self.path.as_path()].into_iter().chain(self.camera.path.as_deref())
    }

    pub(crate) fn source(&self) -> SetupSource<'_> {
        SetupSource { path: &self.path, camera: self.camera.source(), has_trajectory: false }
    }
}

/// How the camera moves from frame to frame.
#[derive(Args)]
pub(crate) struct MotionArgs {
    /// Makes one sequence of the frames: seconds from the start of one to the start of the next. The setup's motion is
    /// then that at the start of the first frame, and continues; otherwise it is that of every frame
    #[arg(long, value_name = "SECONDS", value_parser = interval_of_a_sequence, allow_negative_numbers = true)]
    pub(crate) frame_interval_s: Option<f64>,
    /// The same for frames that do not come at regular intervals: CSV with the header `time_s`, one line for each frame
    /// in their order, or `name,time_s`; only differences count. A column `exposure_s` has the exposure of each frame
    #[arg(long, value_name = "FILE", conflicts_with = "frame_interval_s")]
    pub(crate) frame_times: Option<PathBuf>,
    /// Measured motion instead of the setup's velocity and rotation rate: CSV with the header time_s,vx,vy,vz,wx,wy,wz
    /// and optionally gx,gy,gz, of which columns may be missing
    #[arg(long, value_name = "FILE")]
    pub(crate) trajectory: Option<PathBuf>,
    /// Also tell the lines of a sequence that too few frames agree on so far: status `tentative`
    #[arg(long)]
    pub(crate) all: bool,
}

impl MotionArgs {
    /// All that is read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.frame_times, &self.trajectory].into_iter().flatten().map(PathBuf::as_path)
    }
}
