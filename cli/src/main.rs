//! `shutter-range`: distance from the rolling-shutter effect, on recorded data.

mod input;
mod arguments;
mod ranging;
mod output;
mod command;

use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;

use crate::arguments::{Cli, Command, FrameArgs};
use crate::command::{edges, frames, sensors, simulate, table2};
use crate::output::{overlay, range_table, terminal, truth};

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
        Command::Table2 => {
            let summary = table2::summary()?;
            if cli.json { terminal::json(&summary)? } else { table2::text(&summary, colours) }
        }
        Command::Edges { file, setup, course } => {
            let setup = course.load_setup(&setup.path)?;
            let document = edges::ranges(file, &setup, course)?;
            if cli.json { terminal::json(&document)? } else { range_table::text(&document, colours) }
        }
        Command::Frame(arguments) => return frame(arguments, cli.json),
        Command::Simulate(arguments) => {
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

fn frame(arguments: &FrameArgs, json: bool) -> Result<ExitCode> {
    let overlays = overlay::paths(&arguments.files, arguments.overlay.as_deref());
    let overlays = overlays.unwrap_or_else(|message| arguments::refuse(&message));
    let of_course = arguments.course.refuse_frames(arguments.files.len());
    of_course.unwrap_or_else(|message| arguments::refuse(&message));
    let setup = arguments.course.load_setup(&arguments.setup.path)?;
    let frames::Outcome { document, failures } = frames::ranges(arguments, &overlays, &setup)?;
    // Where nothing was read there is nothing to tell.
    if !document.frames.is_empty() {
        let text = if json { terminal::json(&document)? } else { range_table::text(&document, terminal::colours()) };
        terminal::print(&text)?;
    }
    Ok(if failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// A ranger's tables pass the stack on their way to the heap, which is more than the main thread of some systems has.
fn on_a_large_stack(work: impl FnOnce() -> Result<ExitCode> + Send + 'static) -> Result<ExitCode> {
    const STACK_BYTES: usize = 32 << 20;
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    match thread.context("starting a thread")?.join() {
        Ok(result) => result,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
