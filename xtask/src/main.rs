//! Commands of this repository. `cargo xtask budget --help` says more.

mod board;
mod budget;
mod figure;
mod firmware;
mod job;
mod points;
mod scenes;
mod uses;
mod worst;

use anyhow::Result;
use clap::Parser;

#[derive(Parser)]
#[command(about = "Commands of this repository")]
enum Command {
    Budget(budget::Arguments),
}

fn main() -> Result<()> {
    match Command::parse() {
        Command::Budget(arguments) => budget::run(&arguments),
    }
}
