//! `shutter-range`: distance from the rolling-shutter effect, on recorded data.

mod input;
mod help;
mod arguments;
mod ranging;
mod output;
mod command;

use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;

use crate::arguments::{Cli, Command, FrameArgs};
use crate::command::{edges, frame, sensors, setup, simulate, table2};
use crate::output::{map, overlay, range_table, terminal, truth};

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
        Command::Setup { example } if cli.json => terminal::json(&setup::document(*example))?,
        Command::Setup { example } => setup::text(*example),
        Command::Table2 => {
            let summary = table2::summary()?;
            if cli.json { terminal::json(&summary)? } else { table2::text(&summary, colours) }
        }
        Command::Edges { file, setup, motion } => {
            let setup = motion.load_setup(&setup.path)?;
            let document = edges::ranges(file, &setup, motion)?;
            if cli.json { terminal::json(&document)? } else { range_table::text(&document, colours) }
        }
        Command::Frame(arguments) => return run_frame(arguments, cli.json),
        Command::Simulate(arguments) => {
            simulate::check_inputs(arguments).unwrap_or_else(|message| arguments::refuse(&message));
            let truth = simulate::frames(arguments)?;
            if cli.json { terminal::json(&truth)? } else { truth::text(&truth, &arguments.out, colours) }
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
    let overlays = overlay::paths(&arguments.files, arguments.overlay.as_deref());
    let overlays = overlays.unwrap_or_else(|message| arguments::refuse(&message));
    let checked = map::check(arguments.map.as_deref(), &arguments.files, &overlays);
    checked.unwrap_or_else(|message| arguments::refuse(&message));
    if arguments.map.is_some() && arguments.files.len() > 1 && !arguments.motion.is_sequence() {
        arguments::refuse("--map of several frames needs --frame-interval-s or --frame-times: how far apart are they?");
    }
    let checked = arguments.motion.check_frames(arguments.files.len());
    checked.unwrap_or_else(|message| arguments::refuse(&message));
    let setup = arguments.motion.load_setup(&arguments.setup.path)?;
    let frame::Outcome { document, failures } = frame::ranges(arguments, &overlays, &setup)?;
    // Without any frame there is nothing to print.
    if !document.frames.is_empty() {
        let text = if json { terminal::json(&document)? } else { range_table::text(&document, terminal::colours()) };
        terminal::print(&text)?;
    }
    Ok(if failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The tables of a ranger are built on the stack before they go to the heap: too much for the main thread of some systems.
fn on_a_large_stack(work: impl FnOnce() -> Result<ExitCode> + Send + 'static) -> Result<ExitCode> {
    const STACK_BYTES: usize = 32 << 20;
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    match thread.context("starting a thread")?.join() {
        Ok(result) => result,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
