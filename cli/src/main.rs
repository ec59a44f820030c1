//! `shutter-range`: distance from the rolling-shutter effect, on recorded data.

mod bounds;
mod edge_file;
mod edges;
mod keys;
mod nearest;
mod output;
mod range_table;
mod report;
mod setup;
mod table2;
mod text_table;
mod tracking;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand};

/// Distance from the rolling-shutter effect: upright edges lean in the frames of a moving camera, the nearer the more.
#[derive(Parser)]
#[command(name = "shutter-range", version, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Print one JSON document instead of tables
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Command {
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
    },
}

#[derive(Args)]
struct SetupArgs {
    /// Camera, motion and attitude (TOML)
    #[arg(long = "setup", value_name = "FILE")]
    path: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  shutter-range table2
  shutter-range edges edges.csv --setup camera.toml
  detect-edges video.mp4 | shutter-range edges - --setup camera.toml --json

Exit code: 0 done, 1 an input is wrong, 2 the command line is wrong.";

const EDGES_HELP: &str = "\
Columns:
  row, column   pixels; pixel centres are at whole numbers, rows counted from the top of the image
  time_s        middle of the row's exposure since frame start; default: from row and readout
  line          a whole number that says which edges belong together; without it a tracker sorts them out
  frame         a whole number; frames are independent of each other
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

fn main() -> ExitCode {
    let cli = Cli::parse();
    match on_a_large_stack(move || run(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let message = format!("{error:#}").replace('\n', " ");
            // Nothing is left to tell, should standard error be closed.
            let _ = writeln!(std::io::stderr(), "error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: &Cli) -> Result<()> {
    let colours = output::colours();
    let text = match &cli.command {
        Command::Table2 => {
            let summary = table2::summary()?;
            if cli.json { output::json(&summary)? } else { table2::text(&summary, colours) }
        }
        Command::Edges { file, setup } => {
            let setup = setup::load(&setup.path)?;
            let document = edges::ranges(file, &setup)?;
            if cli.json { output::json(&document)? } else { range_table::text(&document, colours) }
        }
    };
    output::print(&text)
}

/// A ranger's tables pass the stack on their way to the heap, which is more than the main thread of some systems has.
fn on_a_large_stack(work: impl FnOnce() -> Result<()> + Send + 'static) -> Result<()> {
    const STACK_BYTES: usize = 32 << 20;
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    match thread.context("starting a thread")?.join() {
        Ok(result) => result,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
