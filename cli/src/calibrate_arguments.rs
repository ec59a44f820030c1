//! The command line of `calibrate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::argument_values::{above_zero, focal_length, frequency, frequency_sigma, readout, roll, svg_path};
use crate::help;
use crate::input::raw_frame::RawFrame;
use crate::setup_arguments::{MotionArgs, SetupArgs};

#[derive(Subcommand)]
pub(crate) enum CalibrateCommand {
    /// Line time and readout from frames of something that a flickering lamp lights, with the camera at rest
    #[command(after_help = help::FLICKER, allow_negative_numbers = true)]
    Flicker(FlickerArgs),
    /// Focal length times line time, and a constant tilt, from passes at known distance and speed
    #[command(after_help = help::SCALE, allow_negative_numbers = true)]
    Scale(ScaleArgs),
    /// Offset of the gyroscope's clock, and roll and pitch of the camera, from some seconds of turning before upright
    /// edges
    #[command(after_help = help::IMU)]
    Imu(ImuArgs),
}

#[derive(Args)]
pub(crate) struct ImuArgs {
    /// Frames of a camera that turns back and forth where it stands, with upright edges some metres away
    #[arg(required = true, value_name = "FRAME")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    #[command(flatten)]
    pub(crate) motion: MotionArgs,
    /// Draw the leans of the edges, before and after
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) svg: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct FlickerArgs {
    /// Two frames or more, in their order: bands must move from one to the next
    #[arg(required = true, value_name = "FRAME")]
    pub(crate) files: Vec<PathBuf>,
    /// How often the light flickers: 100 or 120 for lamps on mains of 50 or 60 Hz, else the frequency of its PWM or
    /// strobe
    #[arg(long, value_name = "HZ", value_parser = frequency)]
    pub(crate) frequency_hz: f64,
    /// How well that is known, one standard deviation; default: 0.04 % for 100 and 120 Hz, 100 ppm otherwise
    #[arg(long, value_name = "HZ", value_parser = frequency_sigma)]
    pub(crate) sigma_hz: Option<f64>,
    /// Exposure of a row, which may explain why there are no bands
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    pub(crate) exposure_s: Option<f64>,
    /// Frame rate of the camera, which bounds the readout where the lamp flickers faster than the rows
    #[arg(long, value_name = "HZ", value_parser = above_zero)]
    pub(crate) frame_rate_hz: Option<f64>,
    /// The files are dumps of pixels without a header, row by row from the top; their format is gray8 unless stated
    #[arg(long, value_name = "WIDTHxHEIGHT[:FORMAT]")]
    pub(crate) raw: Option<RawFrame>,
    /// Draw the bands of the first two frames
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) svg: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct ScaleArgs {
    /// CSV with the header speed_m_s,distance_m and one of slope, angle_deg and frame
    #[arg(value_name = "PASSES.csv")]
    pub(crate) file: PathBuf,
    /// Focal length in pixels, if it is known: gives the line time
    #[arg(long, value_name = "PIXELS", value_parser = focal_length)]
    pub(crate) focal_px: Option<f64>,
    /// Readout of the frame, if it is known: gives kappa, and with --rows the focal length
    #[arg(long, value_name = "SECONDS", value_parser = readout, conflicts_with = "focal_px")]
    pub(crate) readout_s: Option<f64>,
    /// Rows of the frame: with --readout-s, or the column readout_s, gives the focal length
    #[arg(long, value_name = "N", conflicts_with = "focal_px")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=32_767))]
    pub(crate) rows: Option<u16>,
    /// How well the camera's roll is known to be none, one standard deviation; 0: exactly. Default: it is fitted
    #[arg(long, value_name = "DEGREES", value_parser = roll)]
    pub(crate) sigma_roll_deg: Option<f64>,
    /// Draw the passes and the fit
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) svg: Option<PathBuf>,
}
