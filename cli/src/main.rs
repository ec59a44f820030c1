//! `shutter-range`: distance from the rolling-shutter effect, on recorded data.

mod input;
mod help;
mod argument_values;
mod setup_arguments;
mod calibrate_arguments;
mod arguments;
mod ranging;
mod inspection;
mod output;
mod command;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;

use crate::arguments::{Cli, Command, FrameArgs, PlanArgs};
use crate::calibrate_arguments::{CalibrateCommand, FlickerArgs, ImuArgs, ScaleArgs};
use crate::command::{
    calibrate_flicker, calibrate_imu, calibrate_scale, edges, figures, frame, inspect, plan, sensors, setup, simulate,
    table2,
};
use crate::output::frame_writer::{FrameFormat, FrameWriter};
use crate::output::outputs::{self, Output};
use crate::output::{overlay, range_table, safe_file, terminal, truth};
use crate::ranging::workers::STACK_BYTES;

fn main() -> ExitCode {
    let cli = Cli::parse();
    on_a_large_stack(move || run(&cli)).unwrap_or_else(|error| {
        terminal::error(&error);
        ExitCode::FAILURE
    })
}

fn run(cli: &Cli) -> Result<ExitCode> {
    let colours = terminal::colours();
    let text = match &cli.command {
        Command::Setup(arguments) => {
            let document = setup::document(arguments)?;
            if cli.json { terminal::json(&document)? } else { document.setup }
        }
        Command::Table2 => {
            let summary = table2::summary()?;
            if cli.json { terminal::json(&summary)? } else { table2::text(&summary, colours) }
        }
        Command::Edges { file, setup, motion } => {
            let setup = motion.load_setup(setup)?;
            let document = edges::ranges(file, &setup, motion)?;
            if cli.json { terminal::json(&document)? } else { range_table::text(&document, colours) }
        }
        Command::Frame(arguments) => return run_frame(arguments, cli.json),
        Command::Inspect(arguments) => {
            let inspection = inspect::inspection(arguments)?;
            if cli.json { terminal::json(&inspection)? } else { inspect::text(&inspection) }
        }
        Command::Simulate(arguments) => {
            simulate::check_inputs(arguments).unwrap_or_else(|message| arguments::refuse(&message));
            let truth = simulate::frames(arguments)?;
            if cli.json { terminal::json(&truth)? } else { truth::text(&truth, &arguments.out, colours) }
        }
        Command::Calibrate(CalibrateCommand::Flicker(arguments)) => return run_flicker(arguments, cli.json),
        Command::Calibrate(CalibrateCommand::Scale(arguments)) => return run_scale(arguments, cli.json),
        Command::Calibrate(CalibrateCommand::Imu(arguments)) => return run_imu(arguments, cli.json),
        Command::Plan(arguments) => run_plan(arguments, cli.json)?,
        Command::Figures { folder } => {
            let document = figures::draw(folder)?;
            if cli.json { terminal::json(&document)? } else { figures::text(&document) }
        }
        Command::Sensors => {
            let document = sensors::modes()?;
            if cli.json { terminal::json(&document)? } else { sensors::text(&document, colours) }
        }
    };
    terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn run_frame(arguments: &FrameArgs, json: bool) -> Result<ExitCode> {
    let refuse = |message: String| -> ! { arguments::refuse(&message) };
    let format = match (json, arguments.json_lines) {
        (true, true) => refuse("--json and --json-lines: give one of them".to_string()),
        (true, false) => FrameFormat::Json,
        (false, true) => FrameFormat::JsonLines,
        (false, false) => FrameFormat::Table { colours: terminal::colours() },
    };
    frame::check_inputs(arguments).unwrap_or_else(|message| refuse(message));
    let overlays = overlay::paths(&arguments.files, arguments.overlay.as_deref());
    frame::check_outputs(arguments, &overlays).unwrap_or_else(|message| refuse(message));
    let setup = arguments.motion.load_setup(&arguments.setup)?;
    let mut writer = FrameWriter::new(format);
    let outcome = frame::ranges(arguments, &overlays, &setup, &mut writer);
    // A document that was begun is ended, also before an error.
    writer.finish()?;
    Ok(if outcome?.0 == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Refuses a chart in place of what is read.
fn check_chart<'a>(svg: Option<&Path>, inputs: impl IntoIterator<Item = &'a Path>) {
    let checked = outputs::check(inputs, &Output::of_options(&[("--svg", svg)]));
    checked.unwrap_or_else(|message| arguments::refuse(&message));
}

fn paths(files: &[PathBuf]) -> impl Iterator<Item = &Path> {
    files.iter().map(PathBuf::as_path)
}

/// What cannot be told is no error of the program, but no success either.
fn exit_code(status: &str) -> ExitCode {
    if status == "ok" { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn run_flicker(arguments: &FlickerArgs, json: bool) -> Result<ExitCode> {
    check_chart(arguments.svg.as_deref(), paths(&arguments.files));
    let outcome = calibrate_flicker::measure(arguments)?;
    let document = &outcome.document;
    terminal::print(&if json { terminal::json(document)? } else { calibrate_flicker::text(document) })?;
    if let Some(path) = &arguments.svg {
        safe_file::write_text(path, &calibrate_flicker::chart(&outcome, path)?)?;
    }
    Ok(exit_code(document.status))
}

fn run_scale(arguments: &ScaleArgs, json: bool) -> Result<ExitCode> {
    check_chart(arguments.svg.as_deref(), [arguments.file.as_path()]);
    let document = calibrate_scale::measure(arguments)?;
    let text = if json { terminal::json(&document)? } else { calibrate_scale::text(&document, terminal::colours()) };
    terminal::print(&text)?;
    if let Some(path) = &arguments.svg {
        safe_file::write_text(path, &calibrate_scale::chart(&document, &arguments.file)?)?;
    }
    Ok(exit_code(document.status))
}

fn run_imu(arguments: &ImuArgs, json: bool) -> Result<ExitCode> {
    let is_sequence = arguments.motion.frame_interval_s.is_some() || arguments.motion.frame_times.is_some();
    if arguments.motion.trajectory.is_none() || !is_sequence {
        arguments::refuse("calibrate imu needs --trajectory, and --frame-interval-s or --frame-times");
    }
    let inputs = paths(&arguments.files).chain(arguments.setup.files()).chain(arguments.motion.files());
    check_chart(arguments.svg.as_deref(), inputs);
    let outcome = calibrate_imu::measure(arguments)?;
    let document = &outcome.document;
    terminal::print(&if json { terminal::json(document)? } else { calibrate_imu::text(document) })?;
    if let Some(path) = &arguments.svg {
        safe_file::write_text(path, &calibrate_imu::chart(&outcome, path)?)?;
    }
    Ok(exit_code(document.status))
}

fn run_plan(arguments: &PlanArgs, json: bool) -> Result<String> {
    plan::check(arguments).unwrap_or_else(|message| arguments::refuse(&message));
    check_chart(arguments.svg.as_deref(), paths(&arguments.setups));
    let document = plan::plan(arguments)?;
    if let Some(path) = &arguments.svg {
        safe_file::write_text(path, &plan::chart(&document)?)?;
    }
    if json { terminal::json(&document) } else { Ok(plan::text(&document, terminal::colours())) }
}

/// The tables of a ranger are built on the stack before they go to the heap: too much for the main thread of some
/// systems.
fn on_a_large_stack(work: impl FnOnce() -> Result<ExitCode> + Send + 'static) -> Result<ExitCode> {
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    match thread.context("starting a thread")?.join() {
        Ok(result) => result,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
