//! `cargo run --release -p shutter-range-bench -- accuracy`: how well the library measures in simulated frames.

use std::error::Error;

use clap::{Parser, Subcommand};
use shutter_range_bench::{SCENARIOS, Score, Settings, measure};

/// How well shutter-range measures. (How fast: cargo bench -p shutter-range-bench)
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Ranges simulated frames and compares them with the truth and the Cramér–Rao bound
    Accuracy(Accuracy),
}

#[derive(clap::Args)]
struct Accuracy {
    /// Frames of each scenario
    #[arg(long, default_value_t = 20)]
    frames: u32,
    /// Picks bearings, depths, speeds and noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only scenarios whose names contain this
    #[arg(long, default_value = "")]
    only: String,
    /// Lists missed edges, errors of more than five bounds and false distances
    #[arg(long)]
    list: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Command::Accuracy(arguments) = Arguments::parse().command;
    accuracy(&arguments)
}

fn accuracy(arguments: &Accuracy) -> Result<(), Box<dyn Error>> {
    let Accuracy { frames, seed, ref only, list } = *arguments;
    println!("accuracy --frames {frames} --seed {seed}: Ranger::row, f64, tilt 0, exposure and lens known");
    println!("found: status ok, of edges that at least 12 rows show; RMS: of inverse depth; bound: Cramér–Rao");
    println!("{}", Score::title());
    for scenario in SCENARIOS.iter().filter(|scenario| scenario.name.contains(only.as_str())) {
        let mut findings = Vec::new();
        let score = measure(scenario, Settings { frames, seed }, |finding| findings.push(finding))?;
        println!("{}", score.line(scenario.name));
        for finding in findings.iter().filter(|_| list) {
            println!("    frame {}: {}", finding.frame, finding.what);
        }
    }
    Ok(())
}
