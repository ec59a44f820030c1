//! The command line.

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use shutter_range::format::PixelFormat;
use shutter_range::sim::Swing;

use crate::argument_values::{
    bearing, clock_offset, contrast, depth, height, html_path, interval, megahertz, pixel_noise, png_path, speed,
    svg_path, swing_angle, swing_frequency, wanted_sigma, width,
};
use crate::calibrate_arguments::CalibrateCommand;
use crate::help;
use crate::input::raw_frame::RawFrame;
use crate::setup_arguments::{CameraArgs, MotionArgs, SetupArgs};

/// Distance from the rolling-shutter effect: upright edges lean in the frames of a moving camera, near ones more than
/// far ones.
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
    Setup(SetupFileArgs),
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
    /// What a camera does to its pixels: noise, clipping, sharpening, denoising, compression, offsets, bands, blur, and
    /// which keys of a setup follow. The first thing to run on a new camera
    #[command(after_help = help::INSPECT)]
    Inspect(InspectArgs),
    /// Frames of a simulated scene, with the truth about their edges
    #[command(after_help = help::SIMULATE, allow_negative_numbers = true)]
    Simulate(SimulateArgs),
    /// What a data sheet does not say of a camera, measured
    #[command(subcommand)]
    Calibrate(CalibrateCommand),
    /// What cameras will measure, before they drive; with several setups, which of them is the best
    #[command(after_help = help::PLAN, allow_negative_numbers = true)]
    Plan(PlanArgs),
    /// The figures of the paper from the library's own functions, with the measured points, and some that it lacks
    Figures {
        /// Folder for the files; made if there is none. Files of the same names are replaced
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Image sensors and their modes: line time, frame readout, and how well that is known
    #[command(after_help = help::SENSORS)]
    Sensors,
}

#[derive(Args)]
pub(crate) struct PlanArgs {
    /// Camera, motion and attitude (TOML); several are compared, all at the first one's motion and gravity
    #[arg(long = "setup", value_name = "FILE", required = true)]
    pub(crate) setups: Vec<PathBuf>,
    /// Nearest depth in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.5, value_parser = depth)]
    pub(crate) from: f64,
    /// Farthest depth in metres
    #[arg(long, value_name = "METRES", default_value_t = 10.0, value_parser = depth)]
    pub(crate) to: f64,
    /// Depths between the two
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) steps: u32,
    /// Wanted sigma, relative
    #[arg(long, value_name = "SIGMA", default_value_t = 0.1, value_parser = wanted_sigma)]
    pub(crate) sigma: f64,
    /// Lowest speed; default: the setup's
    #[arg(long, value_name = "SPEED", value_parser = speed)]
    pub(crate) slowest_m_s: Option<f64>,
    /// Highest speed; default: the setup's
    #[arg(long, value_name = "SPEED", value_parser = speed)]
    pub(crate) fastest_m_s: Option<f64>,
    /// Height of the post, half of it above the camera
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = height)]
    pub(crate) height_m: f64,
    /// Width of the post
    #[arg(long, value_name = "METRES", default_value_t = 0.12, value_parser = width)]
    pub(crate) width_m: f64,
    /// Grey levels between the post and what is behind it
    #[arg(long, value_name = "LEVELS", default_value_t = 110.0, value_parser = contrast)]
    pub(crate) contrast: f64,
    /// x/z of the post at frame start
    #[arg(long, value_name = "BEARING", default_value_t = 0.0, value_parser = bearing)]
    pub(crate) bearing: f64,
    /// Read noise, one sigma in grey levels
    #[arg(long, value_name = "LEVELS", default_value_t = 2.5, value_parser = pixel_noise)]
    pub(crate) read_noise: f64,
    /// Variance of shot noise per grey level
    #[arg(long, value_name = "GAIN", default_value_t = 0.03, value_parser = pixel_noise)]
    pub(crate) shot_gain: f64,
    /// Draw sigma against depth
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) svg: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct SetupFileArgs {
    /// Set the optional keys, too
    #[arg(long)]
    pub(crate) example: bool,
    /// Fill in what the table of `shutter-range sensors` knows of a mode, such as ov7725-qvga
    #[arg(long, value_name = "NAME")]
    pub(crate) sensor: Option<String>,
    /// Clock that the board gives the sensor, where it is not that of the table
    #[arg(long, value_name = "MHZ", requires = "sensor", value_parser = megahertz, allow_negative_numbers = true)]
    pub(crate) clock_mhz: Option<f64>,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
}

#[derive(Args)]
pub(crate) struct FrameArgs {
    /// PNG, JPEG, BMP or PGM/PPM, or videos: .y4m, or - for y4m on standard input. Frames are independent of each other
    /// unless --frame-interval-s or --frame-times makes them one sequence
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    #[command(flatten)]
    pub(crate) motion: MotionArgs,
    /// Draw each edge with its distance and sigma over the frame. Several frames give OUT-NAME.png, with each frame's name
    #[arg(long, value_name = "OUT.png", value_parser = png_path)]
    pub(crate) overlay: Option<PathBuf>,
    /// Write a page to look at: each frame with its edges, a bird's-eye view in metres, a table with the error budgets,
    /// hints
    #[arg(long, value_name = "OUT.html", value_parser = html_path)]
    pub(crate) report: Option<PathBuf>,
    /// Draw the edges of the whole sequence from above, with two-sigma bars and the camera's path
    #[arg(long, value_name = "OUT.svg", value_parser = svg_path)]
    pub(crate) map: Option<PathBuf>,
    /// The files are dumps of pixels without a header, row by row from the top. FORMAT is gray8 (default), yuyv, yvyu,
    /// uyvy, vyuy, rgb565le, rgb565be, gray10p (RAW10 as MIPI packs it), gray10le, gray12le, bayer8, bayer10p,
    /// bayer10le or bayer12le
    #[arg(long, value_name = "WIDTHxHEIGHT[:FORMAT]")]
    pub(crate) raw: Option<RawFrame>,
    /// Search so many frames at a time for edges; default: one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) jobs: Option<u16>,
    /// Print a JSON document for each frame, on a line of its own
    #[arg(long)]
    pub(crate) json_lines: bool,
}

#[derive(Args)]
pub(crate) struct InspectArgs {
    /// PNG, JPEG, BMP or PGM/PPM, as the camera delivers them
    #[arg(required = true, value_name = "FRAME")]
    pub(crate) files: Vec<PathBuf>,
    /// The files are dumps of pixels without a header, row by row from the top; their format is gray8 unless stated
    #[arg(long, value_name = "WIDTHxHEIGHT[:FORMAT]")]
    pub(crate) raw: Option<RawFrame>,
}

#[derive(Args)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pub(crate) setup: SetupArgs,
    /// Folder for the frames, truth.json, trajectory.csv, setup.toml and scene.toml; made if there is none
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Replace an earlier simulation in the folder: its frame-*.png, truth.json, trajectory.csv, setup.toml and
    /// scene.toml are removed. A folder without truth.json, scene.toml and setup.toml is none
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Write the frames as dumps without a header, frame-0000.raw and so on, in a format of `frame --raw`
    #[arg(long, value_name = "FORMAT")]
    pub(crate) raw: Option<PixelFormat>,
    /// What the camera sees (TOML); default: a street with posts
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,
    /// Number of frames
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: u32,
    /// Seed of the noise: the same one gives the same frames
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Seconds from the start of one frame to the start of the next, at least the readout time of the frame; 0: the
    /// same instant with other noise; default: 1/30 s, or the readout time if that is longer
    #[arg(long, value_name = "SECONDS", value_parser = interval)]
    pub(crate) frame_interval_s: Option<f64>,
    /// The camera also turns back and forth about the vertical, by this angle to either side
    #[arg(long, value_name = "DEGREES", value_parser = swing_angle)]
    pub(crate) swing_deg: Option<f64>,
    /// Swings in a second
    #[arg(long, value_name = "HZ", default_value_t = 1.0, requires = "swing_deg", value_parser = swing_frequency)]
    pub(crate) swing_hz: f64,
    /// The clock of trajectory.csv is behind that of the frames by so much
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = clock_offset)]
    pub(crate) clock_offset_s: f64,
}

impl SimulateArgs {
    pub(crate) fn swing(&self) -> Option<Swing> {
        let swing = |degrees: f64| Swing { angle_rad: degrees.to_radians() as f32, frequency_hz: self.swing_hz as f32 };
        self.swing_deg.map(swing)
    }
}

/// Ends the program as clap does for a wrong command line: for arguments that are wrong only together.
pub(crate) fn refuse(message: &str) -> ! {
    Cli::command().error(ErrorKind::ValueValidation, message).exit()
}
