//! Commands of this repository; `cargo xtask budget --help` and `cargo xtask same-bits --help` say more.

mod board;
mod budget;
mod document;
mod figure;
mod firmware;
mod job;
mod microbit;
mod points;
mod same_bits;
mod scenes;
mod uses;
mod worst;

use anyhow::Result;
use clap::Parser;

#[derive(Parser)]
#[command(about = "Commands of this repository")]
enum Command {
    Budget(budget::Arguments),
    /// QVGA rows to lines and ranges on an M0 with 16 KiB of RAM, within stated limits
    Microbit,
    SameBits(same_bits::Arguments),
}

fn main() -> Result<()> {
    match Command::parse() {
        Command::Budget(arguments) => budget::run(&arguments),
        Command::Microbit => microbit::run(),
        Command::SameBits(arguments) => same_bits::run(&arguments),
    }
}
