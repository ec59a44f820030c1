//! The command line.

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};

use crate::input::size::Size;

/// Distance from the rolling-shutter effect: upright edges lean in the frames of a moving camera, the nearer the more.
#[derive(Parser)]
#[command(name = "shutter-range", version, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print one JSON document instead of tables
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// The paper's 40 field measurements: published and computed distance against GPS
    Table2,
    /// Ranges from edge points
    #[command(after_help = EDGES_HELP)]
    Edges {
        /// CSV with the header `row,column` and optionally time_s, line, frame, polarity, sigma_px; `-` reads standard
        /// input
        file: PathBuf,
        #[command(flatten)]
        setup: SetupArgs,
        #[command(flatten)]
        course: CourseArgs,
    },
    /// Ranges from whole frames
    #[command(after_help = FRAME_HELP)]
    Frame(FrameArgs),
    /// Frames of a simulated scene, with the truth about their edges
    #[command(after_help = SIMULATE_HELP)]
    Simulate(SimulateArgs),
    /// Image sensors and their modes: line time, frame readout, and how well that is known
    #[command(after_help = SENSORS_HELP)]
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
pub(crate) struct CourseArgs {
    /// The frames are one sequence: seconds from the start of one to the start of the next. The setup's motion is then
    /// that at the start of the first frame, and goes on; without it, that of each frame
    #[arg(long, value_name = "SECONDS", value_parser = interval_of_a_sequence, allow_negative_numbers = true)]
    pub(crate) frame_interval_s: Option<f64>,
    /// Replaces velocity and rotation rate of the setup: CSV with the header time_s,vx,vy,vz,wx,wy,wz and optionally
    /// gx,gy,gz
    #[arg(long, value_name = "FILE")]
    pub(crate) trajectory: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct FrameArgs {
    /// PNG, JPEG or PGM/PPM; frames are independent of each other unless --frame-interval-s says otherwise
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    #[command(flatten)]
    pub(crate) course: CourseArgs,
    /// Draw each edge with its distance and sigma over the frame; several frames give OUT-STEM.png, with the stem of each
    /// frame's name
    #[arg(long, value_name = "OUT.png", value_parser = png_path)]
    pub(crate) overlay: Option<PathBuf>,
    /// The files are plain dumps of 8-bit grey pixels, row by row from the top
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
    /// What stands before the camera (TOML); default: a street
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: u32,
    /// Picks the noise
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Seconds from the start of one frame to the start of the next, while the camera moves on; 0: the same instant with
    /// other noise; default: 1/30 s, or the readout of the frame if that is longer
    #[arg(long, value_name = "SECONDS", value_parser = interval, allow_negative_numbers = true)]
    pub(crate) frame_interval_s: Option<f64>,
}

fn png_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_png { Ok(path) } else { Err("it must end in .png".to_string()) }
}

fn interval(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "it must be a number from 0 to 3600 (seconds)".to_string())
}

/// Frames of the same instant are no sequence.
fn interval_of_a_sequence(text: &str) -> Result<f64, String> {
    let seconds = interval(text).ok().filter(|seconds| *seconds > 0.0);
    seconds.ok_or_else(|| "it must be a number above 0, at most 3600 (seconds)".to_string())
}

/// Ends the program as clap does for a wrong command line: for what shows only when arguments are seen together.
pub(crate) fn refuse(message: &str) -> ! {
    Cli::command().error(ErrorKind::ValueValidation, message).exit()
}

const EXAMPLES: &str = "\
Examples:
  shutter-range table2
  shutter-range edges edges.csv --setup camera.toml
  detect-edges video.mp4 | shutter-range edges - --setup camera.toml --json
  shutter-range frame frame.png --setup camera.toml --overlay seen.png
  shutter-range simulate --setup camera.toml --out simulated
  shutter-range sensors

Exit code: 0 done, 1 an input is wrong, 2 the command line is wrong.";

const EDGES_HELP: &str = "\
Columns:
  row, column   pixels; pixel centres are at whole numbers, rows counted from the top of the image
  time_s        middle of the row's exposure since frame start; default: from row and readout
  line          a whole number that says which edges belong together; without it a tracker sorts them out
  frame         a whole number; frames are independent of each other, or start at so many --frame-interval-s
  polarity      rising (dark to bright from left to right) or falling
  sigma_px      noise of the column, one standard deviation; default: camera.sigma_column_px of the setup

Smallest setup:
  [camera]
  columns = 640
  rows = 480
  fx = 600            # pixels
  readout_s = 0.0333  # whole frame
  [motion]
  velocity_m_s = [1.5, 0, 0]  # x right, y down, z forward

Example:
  shutter-range edges edges.csv --setup camera.toml --json | jq '.frames[].ranges[].depth_m'";

const FRAME_HELP: &str = "\
Frames must be as the sensor read them: of the setup's size, neither cropped, scaled nor rotated (an orientation noted in a
JPEG is not applied). Colour becomes grey by its luma, 16 bits become 8. A file that cannot be read is told on standard
error, the others are ranged all the same, and the exit code is 1.

Trajectory: each line has the velocity (m/s) and rotation rate (rad/s) of one instant in the axes that the camera has then,
and time_s since the start of the first frame: the middle of the exposure of the row read first. gx,gy,gz is the direction
of down, also in those axes; without it, that of the setup's [attitude] is carried on from the first frame. Between the
lines values change linearly; they are held and bridged over three times the usual interval of the lines, not more.
Uncertainties stay those of the setup, whose [motion] may lack the velocity.

Overlay: green is an edge with its depth and one sigma, blue one that is farther than the distance beside it. Thin lines
have no distance: orange is inconsistent or bent, grey is short or slow.

Examples:
  shutter-range frame frame.png --setup camera.toml --overlay seen.png
  shutter-range frame *.jpg --setup camera.toml --overlay seen.png   # seen-0001.png, seen-0002.png, ...
  shutter-range frame *.png --setup camera.toml --frame-interval-s 0.0333 --trajectory drive.csv
  shutter-range frame dump.bin --raw 320x240 --setup camera.toml --json";

const SIMULATE_HELP: &str = "\
The camera is that of the setup, a pinhole without distortion, with its exposure_s (default 2 ms) and lens_blur_px (default
0.7); it moves on with the setup's motion from frame to frame. truth.json says where the edges of each frame are, and the
camera's motion in the axes of that frame's start: where the camera turns, the copied setup is right for the first frame
only, and for all of them with --frame-interval-s.

A scene:
  [background]
  level = 190         # grey, 0 to 255
  contrast = 10       # of a smooth random texture; default 0
  [[bar]]             # up to 64 bars and rails
  bearing = -0.2      # x/z of its middle
  depth_m = 3.0
  width_m = 0.1
  level = 40
  top_m = -2.0        # ends, downwards from the camera's height; default: beyond the image
  bottom_m = 1.2
  lean_deg = 0.0      # default; positive leans to the left at the top
  [[rail]]            # horizontal, endless
  depth_m = 6.0
  top_m = 0.9
  bottom_m = 1.0
  level = 230
  [sensor]            # noise: one sigma in grey levels, and variance per grey level
  read_noise = 1.0
  shot_gain = 0.05

Example:
  shutter-range simulate --setup camera.toml --out simulated --frames 10
  shutter-range frame simulated/frame-*.png --setup simulated/setup.toml --frame-interval-s 0.0333333333";

const SENSORS_HELP: &str = "\
The line time is that from one row of the image to the next, for camera.line_time_us of a setup: the sensor's own, times
the lines that it spends on a row. The readout is that of all rows, for camera.readout_s.

  measured    somebody measured a frame rate with these settings, and it agrees
  computed    it has the frame rate, or the clock, that a driver or a data sheet states
  documented  it follows from descriptions of the registers alone

Example:
  shutter-range sensors --json | jq -r '.modes[] | select(.sensor == \"OV2640\") | [.mode, .line_time_us] | @tsv'";
