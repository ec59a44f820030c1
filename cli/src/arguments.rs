//! The command line.

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};

use crate::help;
use crate::input::size::Size;

/// Distance from the rolling-shutter effect: upright edges lean in the frames of a moving camera, near ones more than far
/// ones.
#[derive(Parser)]
#[command(name = "shutter-range", version, after_help = help::EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print one JSON document instead of tables
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// A setup file to start from: every key with its unit, its default and where to find its value
    #[command(after_help = help::SETUP)]
    Setup {
        /// Set the optional keys, too
        #[arg(long)]
        example: bool,
    },
    /// The paper's 40 field measurements: published and computed distance against GPS
    Table2,
    /// Ranges from edge points
    #[command(after_help = help::edges())]
    Edges {
        /// CSV with the header `row,column` and optionally time_s, line, frame, polarity, sigma_px, width_px; `-` reads
        /// standard input
        file: PathBuf,
        #[command(flatten)]
        setup: SetupArgs,
        #[command(flatten)]
        motion: MotionArgs,
    },
    /// Ranges from whole frames
    #[command(after_help = help::frame())]
    Frame(FrameArgs),
    /// Frames of a simulated scene, with the truth about their edges
    #[command(after_help = help::SIMULATE)]
    Simulate(SimulateArgs),
    /// Image sensors and their modes: line time, frame readout, and how well that is known
    #[command(after_help = help::SENSORS)]
    Sensors,
}

#[derive(Args)]
pub(crate) struct SetupArgs {
    /// Camera, motion and attitude (TOML)
    #[arg(long = "setup", value_name = "FILE")]
    pub(crate) path: PathBuf,
}

/// How the camera moves from frame to frame.
#[derive(Args)]
pub(crate) struct MotionArgs {
    /// Makes one sequence of the frames: seconds from the start of one to the start of the next. The setup's motion is
    /// then that at the start of the first frame, and continues; otherwise it is that of every frame
    #[arg(long, value_name = "SECONDS", value_parser = interval_of_a_sequence, allow_negative_numbers = true)]
    pub(crate) frame_interval_s: Option<f64>,
    /// The same for frames that do not come at regular intervals: CSV with the header `time_s`, one line for each frame in
    /// their order, or `name,time_s`; only differences count
    #[arg(long, value_name = "FILE", conflicts_with = "frame_interval_s")]
    pub(crate) frame_times: Option<PathBuf>,
    /// Measured motion instead of the setup's velocity and rotation rate: CSV with the header time_s,vx,vy,vz,wx,wy,wz
    /// and optionally gx,gy,gz
    #[arg(long, value_name = "FILE")]
    pub(crate) trajectory: Option<PathBuf>,
    /// Also tell the lines of a sequence that too few frames agree on so far: status `tentative`
    #[arg(long)]
    pub(crate) all: bool,
}

#[derive(Args)]
pub(crate) struct FrameArgs {
    /// PNG, JPEG or PGM/PPM; frames are independent of each other unless --frame-interval-s or --frame-times
    /// makes them one sequence
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    #[command(flatten)]
    pub(crate) motion: MotionArgs,
    /// Draw each edge with its depth and sigma over the frame. Several frames give OUT-NAME.png, with each frame's name
    #[arg(long, value_name = "OUT.png", value_parser = png_path)]
    pub(crate) overlay: Option<PathBuf>,
    /// Draw the edges of the whole sequence from above, with two-sigma bars and the camera's path
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) map: Option<PathBuf>,
    /// The files are dumps of 8-bit grey pixels without a header, row by row from the top
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(crate) raw: Option<Size>,
}

#[derive(Args)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    /// Folder for the frames, truth.json, setup.toml and scene.toml; made if there is none
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Replace an earlier simulation in the folder: its frame-*.png, truth.json, setup.toml and scene.toml are removed
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// What the camera sees (TOML); default: a street with posts
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,
    /// Number of frames
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: u32,
    /// Seed of the noise: the same one gives the same frames
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Seconds from the start of one frame to the start of the next; 0: the same instant with other noise; default: 1/30
    /// s, or the readout time of the frame if that is longer
    #[arg(long, value_name = "SECONDS", value_parser = interval, allow_negative_numbers = true)]
    pub(crate) frame_interval_s: Option<f64>,
}

fn png_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_png { Ok(path) } else { Err("it must end in .png".to_string()) }
}

fn svg_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_svg = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if is_svg { Ok(path) } else { Err("it must end in .svg".to_string()) }
}

fn interval(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "it must be a number from 0 to 3600 (seconds)".to_string())
}

/// Unlike simulated frames, those of a sequence cannot be of the same instant.
fn interval_of_a_sequence(text: &str) -> Result<f64, String> {
    let seconds = interval(text).ok().filter(|seconds| *seconds > 0.0);
    seconds.ok_or_else(|| "it must be a number above 0, at most 3600 (seconds)".to_string())
}

/// Ends the program as clap does for a wrong command line: for arguments that are wrong only together.
pub(crate) fn refuse(message: &str) -> ! {
    Cli::command().error(ErrorKind::ValueValidation, message).exit()
}
